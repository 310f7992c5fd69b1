"""All controllers under the same conditions: how near, how calmly, at what cost.

The study compares errors alone, with set points that are held, motors without inductance and as
much torque as is asked for, and it did not count alike for all. Here any of that can change, for
all of them alike: nothing depends on what a controller, or its file, is called.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.controller import Controller
from fuzzyarm.controller.on_plant import driven_by, site_of, text_law_of, timing_of
from fuzzyarm.controller.own import find_controller, find_controllers
from fuzzyarm.export.cost import step_cost
from fuzzyarm.export.numbers import ExportError
from fuzzyarm.loop.course import Course, Options, arm_motion
from fuzzyarm.loop.loop import HELD, LED, MAGNITUDES, rms
from fuzzyarm.loop.program import (
    Program,
    Record,
    error_taps,
    loop_for,
    shown_errors,
    shown_means,
)
from fuzzyarm.loop.run import checked_arms
from fuzzyarm.plant.setting import PLAIN, Conventions
from fuzzyarm.plant.trajectory import Trajectory, pick_and_place, reach_return
from fuzzyarm.study.beyond import NAMES as BEYOND
from fuzzyarm.study.beyond import SUMMARY_TABLE
from fuzzyarm.study.cost import CostError, Operations, count_operations, measure_time
from fuzzyarm.study.published import published_rows

Four = tuple[float, float, float, float]
"""Of links 1 and 2 on the first trajectory, then on the second."""

TRAJECTORIES: tuple[Callable[..., Trajectory], ...] = (reach_return, pick_and_place)
"""Those of the summary table."""


def compared_names() -> list[str]:
    """Return the controllers of the summary table and those that the study does not have."""
    rows = [row.controller for row in published_rows() if row.table == SUMMARY_TABLE]
    return [*rows, *BEYOND]


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


# --- Errors, and how much the torque changes ---


@dataclass(frozen=True)
class Compared:
    """A controller under some conditions.

    Attributes
    ----------
    name : str
        Of the controller.
    rms : tuple of float
        RMS errors at the set points, degrees; where a run diverged, until then.
    rms_periods : tuple of float
        The same of all control periods, from the set point that is held in each.
    rms_path : tuple of float
        The same from the trajectory itself, which moves on while a set point stands.
    variation : tuple of float
        Mean magnitude of the change of a joint's torque from one control period to the next, N m:
        chatter.
    diverged : tuple of (float or None)
        When the run on each trajectory was stopped, s.
    """

    name: str
    rms: Four
    rms_periods: Four
    rms_path: Four
    variation: Four
    diverged: tuple[float | None, float | None]

    @property
    def error(self) -> float:
        """Geometric mean of the RMS errors at the set points, degrees."""
        return geometric_mean(self.rms)

    @property
    def path_error(self) -> float:
        """Geometric mean of the RMS errors from the trajectory, degrees."""
        return geometric_mean(self.rms_path)


def geometric_mean(values: Sequence[float]) -> float:
    """Return the geometric mean of numbers that are not negative."""
    with np.errstate(divide="ignore"):
        return float(np.exp(np.mean(np.log(values))))


def compare(
    names: Sequence[str],
    options: Options | None = None,
    *,
    trajectories: Sequence[Callable[[], Trajectory]] = TRAJECTORIES,
    conventions: Conventions = PLAIN,
    payload: bool = True,
) -> Iterator[Compared]:
    """Run controllers along two trajectories, all under the same conditions.

    Parameters
    ----------
    names : sequence of str
        Of the catalogue, sums or files.
    options : Options, optional
        The conditions; see :data:`CONDITIONS`.
    trajectories : sequence of callable, optional
        Those of the summary table by default.
    conventions : Conventions, optional
        Of all of them.
    payload : bool, optional
        Whether the arm carries its load where the trajectory says.
    """
    for made in find_controllers(names):
        runs = [
            watched_run(made, trajectory(), conventions, options or Options(), payload=payload)
            for trajectory in trajectories
        ]
        first, second = runs
        yield Compared(
            made.name,
            (*first.rms, *second.rms),
            (*first.rms_periods, *second.rms_periods),
            (*first.rms_path, *second.rms_path),
            (*first.variation, *second.variation),
            (first.diverged, second.diverged),
        )


Two = tuple[float, float]
"""Of both links."""


@dataclass(frozen=True)
class Watched:
    """What is compared of one run: see :class:`Compared`."""

    rms: Two
    rms_periods: Two
    rms_path: Two
    variation: Two
    diverged: float | None


def watched_run(
    controller: Controller,
    trajectory: Trajectory,
    conventions: Conventions,
    options: Options,
    *,
    payload: bool = True,
) -> Watched:
    """Run a controller of compiled laws on the arm; what :func:`simulate` gives, and chatter."""
    arms = checked_arms(trajectory, None, payload=payload, conventions=conventions)
    motion = arm_motion(trajectory, arms, conventions, options, timing_of(controller))
    arithmetic = options.arithmetic(conventions)
    program = Program(controller, arithmetic)
    if not program.compilable:
        raise CostError(controller.name)
    driven = driven_by(controller, site_of(motion.plants[0]))
    course = Course(motion, conventions, options, driven=driven, as_array=arithmetic.compiled)
    record = Record(course, program.memory, error_taps(course))
    own = program.inputs(as_array=arithmetic.compiled)
    with np.errstate(all="ignore"):
        loop_for(program, course, record)(*course.inputs(), *own, *record.outputs)

    def two(values: NDArray[np.float64]) -> Two:
        return float(values[0]), float(values[1])

    return Watched(
        two(rms(shown_errors(course, record.rows))),
        two(shown_means(course, record, HELD)),
        two(shown_means(course, record, LED)),
        two(record.changes(MAGNITUDES)),
        record.diverged(),
    )


# --- Cost ---


@dataclass(frozen=True)
class Cost:
    """What a control step of a controller costs, both joints.

    Attributes
    ----------
    name : str
        Of the controller.
    operations : Operations
        Counted in the loop along a move, in the mean.
    exported : int or None
        What a step of the exported program takes at most; None of what cannot be exported.
    seconds : float or None
        Measured in the loop, as machine code; None where it was not.
    """

    name: str
    operations: Operations
    exported: int | None
    seconds: float | None


def cost_of(name: str, *, conventions: Conventions = PLAIN, timed: bool = True) -> Cost:
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
    Cost
        Operations of a control step, and its time in s.
    """
    made = find_controller(name)
    seconds = measure_time(made, conventions=conventions) if timed else None
    return Cost(made.name, count_operations(made), exported_operations(made), seconds)


def exported_operations(controller: Controller) -> int | None:
    """Return what a step of the program exported from a text takes at most, None of others."""
    law = text_law_of(controller)
    if law is None:
        return None
    try:
        return step_cost(law.text).exported.total()
    except ExportError:
        return None
