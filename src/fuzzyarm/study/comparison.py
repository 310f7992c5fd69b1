"""All controllers under the same conditions: how near, how calmly, at what cost.

The study compares errors alone, with set points that are held, motors without inductance and as
much torque as is asked for. Here any of that can change, for all of them alike.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from fuzzyarm.controller import find_controller
from fuzzyarm.controller.catalogue import study_conventions
from fuzzyarm.controller.controller import Controller
from fuzzyarm.controller.law import view
from fuzzyarm.controller.on_plant import driven_by, site_of
from fuzzyarm.kernels import call, kernel, routine
from fuzzyarm.loop.course import Course, Options, arm_motion
from fuzzyarm.loop.loop import LOOP_ARRAYS, rms, run_loop
from fuzzyarm.loop.program import Program, Record, error_taps, shown_errors
from fuzzyarm.loop.run import checked_arms
from fuzzyarm.plant.plant import ACTUATE, CLOCK_SIZE
from fuzzyarm.plant.setting import Conventions, stored_double, stored_single
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
    for name in names:
        made = find_controller(name)
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


LAST, SUMS = CLOCK_SIZE, CLOCK_SIZE + 2
"""Behind the clock: the torques of the last control period, and the sums of their changes."""


@kernel
def ask_watched(
    task: int,
    links: list[int],
    x: list[float],
    y: list[float],
    u: list[float],
    p: list[float],
    clock: list[float],
) -> None:
    """Do what `ask_plant` does, and add up by how much the torques of the arm change."""
    # Its first two lines stand here again: bound to that name, this would call itself.
    clock[4] = task
    call(links[0], x, y, u, p, clock)
    if task == ACTUATE:
        for joint in range(2):
            clock[SUMS + joint] += abs(u[joint] - clock[LAST + joint])
            clock[LAST + joint] = u[joint]


@cache
def _watched_loop(compiled: bool, single: bool) -> Callable[..., None]:
    bindings: dict[str, Callable[..., Any]] = {
        "stored": stored_single if single else stored_double,
        "ask_plant": ask_watched,
    }
    return routine(run_loop, LOOP_ARRAYS, bindings, compiled=compiled)


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
    compiled = arithmetic.compiled
    driven = driven_by(controller, site_of(motion.plants[0]))
    course = Course(motion, conventions, options, driven=driven, as_array=compiled)
    record = Record(course, program.memory, error_taps(course))
    clock = np.zeros(SUMS + 2)
    clock[:CLOCK_SIZE] = record.clock
    record.clock = clock if compiled else view(clock)
    own = program.inputs(as_array=compiled)
    with np.errstate(all="ignore"):
        _watched_loop(compiled, conventions.single)(*course.inputs(), *own, *record.outputs)
    steps = max(int(record.progress[3]), 1)
    errors = rms(shown_errors(course, record.samples))
    return Watched(
        (float(errors[0]), float(errors[1])),
        (float(clock[SUMS]) / steps, float(clock[SUMS + 1]) / steps),
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
