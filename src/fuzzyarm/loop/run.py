"""Close the loop: controller, trajectory and arm give errors over time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.controller import CompiledController, Controller
from fuzzyarm.controller.law import SIGNALS, Arithmetic, law_integers, summed_torque, view
from fuzzyarm.kernels import build, jit_wanted, routine
from fuzzyarm.loop.loop import (
    LOOP_ARRAYS,
    Setting,
    advance,
    advance_exactly,
    final,
    rms,
    run_loop,
    signed_maximum,
)
from fuzzyarm.plant.arm import constants
from fuzzyarm.plant.setting import (
    ITERATIONS,
    PLAIN,
    SET_POINT_PERIOD,
    ArmError,
    Conventions,
    Moment,
    Pair,
    stored_double,
    stored_single,
)
from fuzzyarm.plant.trajectory import Schedule, Trajectory, sample, schedule

# --- What the loop is called with: arrays of a trajectory, a controller and a setting ---

ERROR_BOUND = 20.0 * math.pi
"""A tracking error beyond ten turns has diverged, rad."""

SPEED_BOUND = 1e5
"""So has a joint faster than this, rad/s."""


@cache
def loop_of_laws(compiled: bool, single: bool, exact: bool = False) -> Callable[..., None]:
    """Return the loop around the compiled laws, as machine code or as plain Python.

    Each precision has its own: what is stored need not be asked whether to be rounded. So has
    each integrator (`exact`: Runge-Kutta): what is not used need not be compiled.
    """
    bindings: dict[str, Callable[..., Any]] = {
        "control": summed_torque,
        "stored": stored_single if single else stored_double,
        "advance": advance_exactly if exact else advance,
    }
    return routine(run_loop, LOOP_ARRAYS, bindings, compiled=compiled)


def flat(values: Any, kind: type = np.float64, *, as_array: bool = True) -> Any:
    """Return numbers in one row, as an array or, for an interpreter, as a view on one."""
    row: NDArray[Any] = np.ascontiguousarray(np.array(values, kind).ravel())
    return row if as_array else view(row)


class Program:
    """A controller as the loop takes it: laws, constants and memory.

    Attributes
    ----------
    numbers, memory : ndarray
        See :func:`fuzzyarm.loop.loop.run_loop`.
    compilable : bool
        Whether every addend is a compiled law.
    """

    def __init__(self, controller: Controller, arithmetic: Arithmetic) -> None:
        self.controller = controller
        self.arithmetic = arithmetic
        parts = list(controller.parts())
        own = [part for part in parts if isinstance(part, CompiledController)]
        self.compilable = len(own) == len(parts)
        self._laws = [part.law for part in own] if self.compilable else []
        self._blocks = [part.block(arithmetic) for part in own] if self.compilable else []
        self.numbers = np.concatenate([[], *(block.numbers for block in self._blocks)])
        self.memory = np.concatenate([[], *(block.memory for block in self._blocks)])

    @property
    def compiled(self) -> bool:
        """Whether it runs as machine code: wanted, and possible."""
        return self.arithmetic.compiled and self.compilable

    def inputs(self) -> tuple[Any, Any]:
        """Return laws and constants as the loop takes them."""
        laws = law_integers(self._laws, self._blocks, self.arithmetic)
        as_array = self.compiled
        return flat(laws, np.int64, as_array=as_array), flat(self.numbers, as_array=as_array)

    def remembered(self, memory: Any) -> list[float]:
        """Return what the laws remember, of the memory after a run."""
        found: list[float] = []
        begin = 0
        for law, block in zip(self._laws, self._blocks, strict=True):
            end = begin + len(block.memory)
            if law.remembers:
                found += map(float, memory[begin:end])
            begin = end
        return found

    def loop(self, options: Options) -> Callable[..., None]:
        """Return the loop that runs it."""
        exact = options.runge_kutta > 0
        if self.compilable:
            return loop_of_laws(self.compiled, self.arithmetic.single, exact)
        torque = self.controller.torque

        def control(now: Moment, *_arrays: object) -> Pair:
            first, second = torque(now.reference, now.state, now.clock)
            return float(first), float(second)

        integrator = advance_exactly if exact else advance
        return build(run_loop, {"control": control, "advance": integrator}, compiled=False)


class Course:
    """A trajectory with the arm that each set point meets: the inputs of the loop.

    Parameters
    ----------
    trajectory : Trajectory
        What to follow.
    arms : tuple of ArmParameters
        One for each segment.
    conventions : Conventions
        Precision, π, timing.
    options : Options
        The rest of the setting.
    as_array : bool
        Arrays, or views for the interpreter.
    """

    def __init__(
        self,
        trajectory: Trajectory,
        arms: Schedule,
        conventions: Conventions,
        options: Options,
        *,
        as_array: bool,
    ) -> None:
        self.points = sample(trajectory, conventions)
        self.conventions = conventions
        self.as_array = as_array
        points = self.points
        self._motion = (
            self._flat(np.hstack([points.position, points.velocity, points.acceleration])),
            self._flat(points.iterations, np.int64),
        )
        self.inputs = (*self._motion, *self._plants(arms))
        step = SET_POINT_PERIOD / ITERATIONS
        if conventions.single:
            step = float(np.float32(np.float64(np.float32(SET_POINT_PERIOD)) / ITERATIONS))
        self._setting = Setting(
            step,
            conventions.single,
            options.runge_kutta,
            float(options.torque_limits[0]),
            float(options.torque_limits[1]),
            ERROR_BOUND,
            SPEED_BOUND,
            float(options.disturbance),
            options.seed,
        )

    def _plants(self, arms: Schedule) -> tuple[Any, Any]:
        """Return which arm each set point meets, and the constants of each."""
        kinds = list(dict.fromkeys(arms))
        which = np.array([kinds.index(arm) for arm in arms])[self.points.segment]
        plants = [constants(arm, single=self.conventions.single) for arm in kinds]
        return self._flat(which, np.int64), self._flat(plants)

    def with_arms(self, arms: Schedule) -> Course:
        """Return the same trajectory with other arms."""
        other = copy(self)
        other.inputs = (*self._motion, *self._plants(arms))
        return other

    def setting(self, seed: int | None = None) -> Any:
        """Return the rest of the setting, for a seed other than that of the options."""
        chosen = self._setting.seed if seed is None else seed
        # The generator works with 31 bits; more would not fit into a float.
        return self._flat(self._setting._replace(seed=chosen % 2**31))

    def _flat(self, values: Any, kind: type = np.float64) -> Any:
        return flat(values, kind, as_array=self.as_array)

    def stretch(self, begin: int, end: int) -> tuple[Any, ...]:
        """Return the inputs of set points `begin` to `end` alone."""
        return (
            self.inputs[0][6 * begin : 6 * end],
            *(each[begin:end] for each in self.inputs[1:3]),
            self.inputs[3],
        )


class Record:
    """What a call of the loop writes, and what it starts from."""

    def __init__(self, course: Course, memory: Any) -> None:
        count = len(course.points.time)

        def new(values: Any, kind: type = np.float64) -> Any:
            return flat(values, kind, as_array=course.as_array)

        self.memory = new(memory)
        self.signals = new(np.zeros(SIGNALS))
        self.state = new(np.zeros(4))
        self.errors = new(np.zeros(2 * count))
        self.torques = new(np.zeros(2 * count))
        self.progress = new([0, -1, -1], np.int64)

    @property
    def outputs(self) -> tuple[Any, ...]:
        """The last arguments of the loop, from the memory on."""
        return self.memory, self.signals, self.state, self.errors, self.torques, self.progress

    def diverged(self, course: Course) -> float | None:
        """Return when the run was stopped because it had diverged, s."""
        _, point, iteration = (int(each) for each in self.progress)
        if point < 0:
            return None
        period = SET_POINT_PERIOD / ITERATIONS
        return float(course.points.time[point]) + (iteration + 1) * period

    def degrees(self, course: Course) -> NDArray[np.float64]:
        """Return the errors, shape (samples, 2), degrees."""
        samples = int(self.progress[0])
        errors = np.array(self.errors[: 2 * samples]).reshape(-1, 2)
        return np.asarray(errors * (180.0 / course.conventions.pi))


# --- Close the loop: controller, trajectory and arm give errors over time ---

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Options:
    """How to run, beyond conventions.

    Parameters
    ----------
    torque_limits : pair of float, optional
        N m; infinite by default.
    runge_kutta : int, optional
        Runge-Kutta steps in each control period; 0 for the study's integrator.
    disturbance : float, optional
        Largest relative disturbance of each state at each step.
    seed : int, optional
        Of the disturbance.
    compiled : bool, optional
        Whether to run machine code; by default as the environment wants it.
    """

    torque_limits: Pair = (math.inf, math.inf)
    runge_kutta: int = 0
    disturbance: float = 0.0
    seed: int = 1
    compiled: bool | None = None

    def __post_init__(self) -> None:
        for limit in self.torque_limits:
            if not limit > 0:
                raise ArmError(f"a torque limit of {limit} N m is out of range", value=limit)
        if not 0 <= self.runge_kutta <= 1000:
            raise ArmError(
                f"{self.runge_kutta} Runge-Kutta steps in a control period are out of range",
                value=self.runge_kutta,
                hint="0 to 1000",
            )

    def arithmetic(self, conventions: Conventions) -> Arithmetic:
        """Return how the laws count under some conventions."""
        compiled = jit_wanted() if self.compiled is None else self.compiled
        return Arithmetic(conventions.single, conventions.pi, compiled)


@dataclass(frozen=True)
class Run:
    """What came of it.

    Attributes
    ----------
    controller, trajectory : str
        Names.
    conventions : Conventions
        As run.
    time : ndarray, shape (n,)
        Of the samples, s.
    reference : ndarray, shape (n, 2)
        Set points, degrees.
    errors : ndarray, shape (n, 2)
        Set point minus position, degrees.
    torques : ndarray, shape (n, 2)
        N m.
    diverged : float or None
        When the run was stopped because it had diverged, s.
    seconds : float
        Wall time of the loop.
    compiled : bool
        Whether it ran as machine code.
    memory : list of float
        What the laws remember at the end.
    """

    controller: str
    trajectory: str
    conventions: Conventions
    time: Vector
    reference: Vector
    errors: Vector
    torques: Vector
    diverged: float | None
    seconds: float
    compiled: bool
    memory: list[float]

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.errors)

    @property
    def rms(self) -> Vector:
        """Root mean square error of each joint, degrees."""
        return rms(self.errors)

    @property
    def final(self) -> Vector:
        """Last error of each joint, degrees."""
        return final(self.errors)

    @property
    def maximum(self) -> Vector:
        """Largest error of each joint, as the conventions count it, degrees."""
        return signed_maximum(self.errors, self.conventions.maximum)


def simulate(
    controller: Controller,
    trajectory: Trajectory,
    *,
    payload: bool = False,
    arms: Schedule | None = None,
    conventions: Conventions = PLAIN,
    options: Options | None = None,
) -> Run:
    """Run a controller along a trajectory.

    Parameters
    ----------
    controller : Controller
        Any; sums of compiled ones run as machine code.
    trajectory : Trajectory
        What to follow.
    payload : bool, optional
        Whether the arm carries its load where the trajectory says.
    arms : tuple of ArmParameters, optional
        One arm for each segment, instead.
    conventions : Conventions, optional
        Precision, π, timing.
    options : Options, optional
        Torque limits, integrator, disturbance.

    Returns
    -------
    Run
        Diverged or not.

    Raises
    ------
    ArmError
        If `arms` does not fit the segments.
    """
    options = options or Options()
    arms = checked_arms(trajectory, arms, payload=payload, conventions=conventions)
    arithmetic = options.arithmetic(conventions)
    program = Program(controller, arithmetic)
    compiled = program.compiled
    loop = program.loop(options)
    course = Course(trajectory, arms, conventions, options, as_array=compiled)
    record = Record(course, program.memory)
    own = program.inputs()
    controller.prepare(arithmetic)
    begin = time.perf_counter()
    with np.errstate(all="ignore"):
        loop(*course.inputs, course.setting(), *own, *record.outputs)
    seconds = time.perf_counter() - begin
    errors = record.degrees(course)
    taken = np.flatnonzero(course.points.iterations == ITERATIONS)[: len(errors)]
    return Run(
        controller.name,
        trajectory.name,
        conventions,
        course.points.time[taken],
        course.points.position[taken] * (180.0 / conventions.pi),
        errors,
        np.array(record.torques[: 2 * len(errors)]).reshape(-1, 2),
        record.diverged(course),
        seconds,
        compiled,
        program.remembered(record.memory),
    )


def checked_arms(
    trajectory: Trajectory,
    arms: Schedule | None,
    *,
    payload: bool,
    conventions: Conventions,
) -> Schedule:
    """Return `arms`, or by default those of the trajectory; one for each segment.

    Raises
    ------
    ArmError
        If `arms` does not fit the segments.
    """
    if arms is None:
        arms = schedule(trajectory, payload=payload, conventions=conventions)
    if len(arms) != len(trajectory.segments):
        raise ArmError(
            f"a payload schedule of {len(arms)} arms does not fit the "
            f"{len(trajectory.segments)} segments of '{trajectory.name}'",
            name="arms",
            value=len(arms),
        )
    return arms
