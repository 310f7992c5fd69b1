"""All controllers under the same conditions: errors, chatter and cost.

The study compares errors alone, with held set points, motors without inductance and unlimited
torque, and it counted differently for different controllers. Here any of that can change, equally
for all: nothing depends on the name of a controller or its file. Comparisons on another plant with
trajectories are the same; costs are counted on the arm.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.apps.study.cost import RESOLUTION, Operations, count_operations, measure_time
from fuzzyarm.apps.study.published import published_rows
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.keywords import demand_arguments
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.on_plant import text_law_of
from fuzzyarm.control.controllers.own import find_controller, find_controllers
from fuzzyarm.control.loop.along import equipped, trajectory_motion
from fuzzyarm.control.loop.course import Motion, Options
from fuzzyarm.control.loop.experiments import follows, with_drives, with_plant, with_settings
from fuzzyarm.control.loop.loop import ALONG_PATH, HELD, MAGNITUDES, rms
from fuzzyarm.control.loop.program import shown_errors, shown_means, shown_units
from fuzzyarm.control.loop.run import ClosedLoop
from fuzzyarm.control.loop.words import (
    connections,
    conventions_of,
    motion_of,
    options_of,
    times_and_angles,
)
from fuzzyarm.exchange.export.cost import step_cost
from fuzzyarm.exchange.export.numbers import ExportError
from fuzzyarm.plant.driven_arm import Arm
from fuzzyarm.plant.following import carries, compared_trajectories
from fuzzyarm.plant.plant import Plant
from fuzzyarm.plant.setting import PLAIN, Conventions
from fuzzyarm.plant.trajectory import Trajectory
from fuzzyarm.requests.runs import CompareRequest

Numbers = tuple[float, ...]
"""Of each output that follows on the first trajectory, then on the second, and so on."""


SUMMARY_TABLE = "7.1.1"
"""The table of all controllers with payload."""

OWN = ("fuzzy-fine", "fuzzy-smooth", "pd-motor", "pd-motor-tuned", "pid-smooth")
"""Controllers that the study does not have: rule bases, then straight lines on the same motors."""


def compared_names() -> list[str]:
    """Return the controllers of the summary table and those missing from the study."""
    rows = [row.controller for row in published_rows() if row.table == SUMMARY_TABLE]
    return [*rows, *OWN]


# --- Conditions ---

INDUCTANCE = 0.002
"""Of each armature, H. The study prints none: with its 2.32 Ω this makes a time constant of 0.9 ms,
one and a half control periods, as brushed servo motors of some hundred watts have it."""

SUPPLY = 24.0
"""The larger one of the study's, V."""

TORQUE_LIMITS = (55.44, 48.51)
"""Named in the study's programs and not applied there, N m: 10.5 A in either motor."""

CONDITIONS = {
    "held": Options(),
    "interpolated": Options(interpolate=True),
    "inductance": Options(inductance=INDUCTANCE),
    "saturation": Options(supply=SUPPLY, torque_limits=TORQUE_LIMITS),
    "both": Options(inductance=INDUCTANCE, supply=SUPPLY, torque_limits=TORQUE_LIMITS),
}
"""Those of the tables: set points held, as the study has it, and one thing changed at a time."""


# --- Errors, and changes of the torque ---


@json_properties("controller=name rms rms_periods rms_path variation diverged")
@dataclass(frozen=True, kw_only=True)
class Compared:
    """A controller under some conditions.

    Attributes
    ----------
    name : str
        Of the controller.
    units : tuple of str
        Of the errors, which of the arm are degrees.
    rms : tuple of float
        RMS errors at the set points; for a diverged run until then.
    rms_periods : tuple of float
        The same over all control periods, from the held set point.
    rms_path : tuple of float
        The same from the trajectory itself, which moves on while a set point is held.
    variation : tuple of float
        Mean magnitude of the change of the first drive of each axis, on the arm of the torque of a
        joint in N m, from one control period to the next: chatter.
    diverged : tuple of (float or None)
        When the run on each trajectory was stopped, s.
    notes : tuple of str
        Notes on adjusted settings.
    """

    name: str
    units: tuple[str, ...]
    rms: Numbers
    rms_periods: Numbers
    rms_path: Numbers
    variation: Numbers
    diverged: tuple[float | None, ...]
    notes: tuple[str, ...] = ()

    @property
    def error(self) -> float:
        """Geometric mean of the RMS errors at the set points."""
        return geometric_mean(self.rms)

    @property
    def path_error(self) -> float:
        """Geometric mean of the RMS errors from the trajectory."""
        return geometric_mean(self.rms_path)


def geometric_mean(values: Sequence[float]) -> float:
    """Return the geometric mean of non-negative numbers."""
    # A 0 among the numbers gives log 0 = -inf and correctly a mean of 0.
    with np.errstate(divide="ignore"):
        return float(np.exp(np.mean(np.log(values))))


def compare(
    controllers: Sequence[str | Controller] | CompareRequest,
    options: Options | None = None,
    *,
    plant: Plant | None = None,
    trajectories: Sequence[Trajectory] | None = None,
    conventions: Conventions = PLAIN,
    payload: bool = True,
    connect: Mapping[str, str] | None = None,
) -> Iterator[Compared]:
    """Run controllers along the same trajectories, all under the same conditions.

    Parameters
    ----------
    controllers : sequence of str or Controller, or CompareRequest
        Of the catalogue, sums or files. A request alone holds every setting of ``fuzzyarm
        compare``, references too.
    options : Options, optional
        The conditions; see :data:`CONDITIONS`.
    plant : Plant, optional
        Where; the arm by default.
    trajectories : sequence of Trajectory, optional
        Those by which the plant has controllers compared by default: of the arm those of the
        summary table.
    conventions : Conventions, optional
        Of all of them.
    payload : bool, optional
        Whether the plant carries the load of the trajectory.
    connect : mapping of str to str, optional
        From names of the controllers to ports of the plant, if they differ.
    """
    wishes = {
        "controllers": controllers,
        "options": options,
        "plant": plant,
        "trajectories": trajectories,
        "conventions": conventions,
        "connect": connect,
    }
    demand_arguments("compare", wishes, compare)
    if isinstance(controllers, CompareRequest):
        yield from _compared_by(controllers)
        return
    home = plant or Arm()
    ways = compared_trajectories(home) if trajectories is None else trajectories
    catalogue = iter(
        find_controllers([controller for controller in controllers if isinstance(controller, str)])
    )
    for controller in controllers:
        law = controller if isinstance(controller, Controller) else next(catalogue)
        runs = [
            watched_run(
                law,
                way,
                conventions,
                options or Options(),
                plant=home,
                payload=payload,
                connect=connect,
            )
            for way in ways
        ]
        yield _compared(law, runs)


def _compared(law: Controller, runs: Sequence[Watched]) -> Compared:
    return Compared(
        name=law.name,
        units=tuple(unit for run in runs for unit in run.units),
        rms=tuple(error for run in runs for error in run.rms),
        rms_periods=tuple(error for run in runs for error in run.rms_periods),
        rms_path=tuple(error for run in runs for error in run.rms_path),
        variation=tuple(change for run in runs for change in run.variation),
        diverged=tuple(run.diverged for run in runs),
        notes=tuple(dict.fromkeys(note for run in runs for note in run.notes)),
    )


def _compared_by(request: CompareRequest) -> Iterator[Compared]:
    """Carry out a request along the trajectories of its plant, or along references."""
    controllers = find_controllers(request.controllers or compared_names())
    request, plant = with_plant(request, controllers)
    controllers, plant = with_settings(request, controllers, plant)
    conventions, connect = conventions_of(request), connections(request)
    if not follows(request, plant):
        plant, options = with_drives(request, plant)
        for law in controllers:
            motion = motion_of(request, law, plant)
            yield _compared(law, [_watched(law, motion, conventions, options, connect)])
        return
    yield from compare(
        controllers,
        options_of(request, plant),
        plant=plant,
        trajectories=compared_along(request, plant),
        conventions=conventions,
        payload=bool(request.payload),
        connect=connect,
    )


def compared_along(request: CompareRequest, plant: Plant) -> Sequence[Trajectory]:
    """Return the trajectories of a plant for comparisons, with other angles and times."""
    arguments: dict[str, Any] = {}
    if request.angles is not None:
        arguments["angles"] = request.angles
    if request.segment is not None:
        arguments["segment"] = request.segment
    with times_and_angles():
        return compared_trajectories(plant, **arguments)


@dataclass(frozen=True, kw_only=True)
class Watched:
    """Compared values of one run: see :class:`Compared`."""

    units: tuple[str, ...]
    rms: Numbers
    rms_periods: Numbers
    rms_path: Numbers
    variation: Numbers
    diverged: float | None
    notes: tuple[str, ...] = ()


def watched_run(
    controller: Controller,
    trajectory: Trajectory,
    conventions: Conventions,
    options: Options,
    *,
    plant: Plant | None = None,
    payload: bool = True,
    connect: Mapping[str, str] | None = None,
) -> Watched:
    """Run a controller on a plant, the arm by default; return the run and its chatter."""
    home = equipped(plant or Arm(), options)
    motion = trajectory_motion(
        home,
        trajectory,
        controller,
        conventions,
        payload=payload and carries(home),
        connect=connect,
    )
    return _watched(controller, motion, conventions, options, connect)


def _watched(
    controller: Controller,
    motion: Motion,
    conventions: Conventions,
    options: Options,
    connect: Mapping[str, str] | None,
) -> Watched:
    loop = ClosedLoop(controller, motion, conventions, options, connect)
    course, run = loop.course, loop.open()
    run.advance()
    record = run.record
    inputs = [axis for axis, _ in loop.site.interface.inputs]
    first = [inputs.index(axis) for axis, _ in motion.tracked if axis in inputs]

    def plainly(values: NDArray[np.float64]) -> Numbers:
        return tuple(float(value) for value in values)

    return Watched(
        units=shown_units(course),
        rms=plainly(rms(shown_errors(course, record.rows))),
        rms_periods=plainly(shown_means(course, record, HELD)),
        rms_path=plainly(shown_means(course, record, ALONG_PATH)),
        variation=plainly(record.changes(MAGNITUDES)[first]),
        diverged=record.diverged(),
        notes=loop.notes(),
    )


# --- Cost ---


@json_properties("operations exported_operations=exported seconds?")
@dataclass(frozen=True, kw_only=True)
class ControlStepCost:
    """The cost of a control step of a controller, both joints.

    Attributes
    ----------
    name : str
        Of the controller.
    operations : Operations
        Counted in the loop along a move, in the mean.
    exported : int or None
        Largest cost of a step of the exported program; None without an export.
    seconds : float or None
        Measured in the loop, as machine code; None without a measurement.
        :data:`~fuzzyarm.apps.study.cost.RESOLUTION` replaces less.
    """

    name: str
    operations: Operations
    exported: int | None
    seconds: float | None

    @property
    def nanoseconds(self) -> str:
        """The time as text."""
        if self.seconds is None:
            return "-"
        figure = f"{1e9 * self.seconds:.0f}"
        return figure if self.seconds > RESOLUTION else f"< {figure}"


def is_counted(plant: Plant) -> bool:
    """Whether costs are counted on a plant: only on the arm."""
    return isinstance(plant, Arm)


def cost_of(name: str, *, conventions: Conventions = PLAIN, timed: bool = True) -> ControlStepCost:
    """Count the operations of a controller and measure its time.

    Parameters
    ----------
    name : str
        Of the catalogue, a sum or a file.
    conventions : Conventions, optional
        In which the time is measured.
    timed : bool, optional
        Whether it is.

    Returns
    -------
    ControlStepCost
        Operations of a control step, and its time in s.
    """
    controller = find_controller(name)
    seconds = measure_time(controller, conventions=conventions) if timed else None
    return ControlStepCost(
        name=controller.name,
        operations=count_operations(controller),
        exported=exported_operations(controller),
        seconds=seconds,
    )


def exported_operations(controller: Controller) -> int | None:
    """Return the most operations of a step of an exported text; None if unknown, or no text."""
    law = text_law_of(controller)
    if law is None:
        return None
    try:
        exported = step_cost(law.text).exported
    except ExportError:
        return None
    return None if exported is None else exported.total()
