"""All controllers under the same conditions: how near, how calmly, at what cost.

The study compares errors alone, with set points that are held, motors without inductance and as
much torque as is asked for. Here any of that can change, for all of them alike.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fuzzyarm.controller.catalogue import study_conventions
from fuzzyarm.controller.controller import Controller
from fuzzyarm.controller.on_plant import driven_by, site_of
from fuzzyarm.controller.own import find_controller, find_controllers
from fuzzyarm.loop.course import Course, Options, arm_motion
from fuzzyarm.loop.loop import MAGNITUDES, rms
from fuzzyarm.loop.program import Program, Record, error_taps, loop_for, shown_errors
from fuzzyarm.loop.run import checked_arms
from fuzzyarm.plant.setting import Conventions
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
        RMS errors, degrees; where a run diverged, until then.
    variation : tuple of float
        Mean magnitude of the change of a joint's torque from one control period to the next, N m:
        chatter.
    diverged : tuple of (float or None)
        When the run on each trajectory was stopped, s.
    """

    name: str
    rms: Four
    variation: Four
    diverged: tuple[float | None, float | None]

    @property
    def error(self) -> float:
        """Geometric mean of the RMS errors, degrees."""
        with np.errstate(divide="ignore"):
            return float(np.exp(np.mean(np.log(self.rms))))


def compare(
    names: Sequence[str],
    options: Options | None = None,
    *,
    trajectories: Sequence[Callable[[], Trajectory]] = TRAJECTORIES,
    conventions: Conventions | None = None,
) -> Iterator[Compared]:
    """Run controllers with payload along two trajectories.

    Parameters
    ----------
    names : sequence of str
        Of the catalogue, sums or files.
    options : Options, optional
        The conditions; see :data:`CONDITIONS`.
    trajectories : sequence of callable, optional
        Those of the summary table by default.
    conventions : Conventions, optional
        By default those that the study had for each controller.
    """
    for name, made in zip(names, find_controllers(names), strict=True):
        counted = conventions or study_conventions(name)
        runs = [
            watched_run(made, trajectory(), counted, options or Options())
            for trajectory in trajectories
        ]
        yield Compared(
            made.name,
            tuple(value for run in runs for value in run.rms),  # type: ignore[arg-type]
            tuple(value for run in runs for value in run.variation),  # type: ignore[arg-type]
            tuple(run.diverged for run in runs),  # type: ignore[arg-type]
        )


@dataclass(frozen=True)
class Watched:
    """What is compared of one run: see :class:`Compared`."""

    rms: tuple[float, float]
    variation: tuple[float, float]
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
    motion = arm_motion(trajectory, arms, conventions, options)
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
    errors = rms(shown_errors(course, record.rows))
    first, second, *_ = record.changes(MAGNITUDES).tolist()
    return Watched((float(errors[0]), float(errors[1])), (first, second), record.diverged())


# --- Cost ---


@dataclass(frozen=True)
class Cost:
    """What a control step of a controller costs, both joints.

    Attributes
    ----------
    name : str
        Of the controller.
    operations : Operations
        Counted.
    seconds : float
        Measured in the loop, as machine code.
    """

    name: str
    operations: Operations
    seconds: float


def cost_of(name: str) -> Cost:
    """Count the operations of a controller and measure its time.

    Parameters
    ----------
    name : str
        Of the catalogue.

    Returns
    -------
    Cost
        Operations of a control step, and its time in s.
    """
    made = find_controller(name)
    seconds = measure_time(made, conventions=study_conventions(name))
    return Cost(made.name, count_operations(made), seconds)
