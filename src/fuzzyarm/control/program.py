"""What the loop is called with: arrays of a trajectory, a controller and a setting."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.arm.conventions import ITERATIONS, SET_POINT_PERIOD, Conventions
from fuzzyarm.arm.loop import Setting, run_loop
from fuzzyarm.arm.parameters import constants
from fuzzyarm.arm.payload import Schedule
from fuzzyarm.arm.signals import Clock, Pair, Pose, Reference, State, kept, rounded
from fuzzyarm.arm.trajectory import Trajectory, sample
from fuzzyarm.control.controller import CompiledController, Controller
from fuzzyarm.control.dispatch import summed_torque
from fuzzyarm.control.law import Arithmetic
from fuzzyarm.kernels import build

if TYPE_CHECKING:
    from fuzzyarm.control.run import Options

ERROR_BOUND = 20.0 * math.pi
"""A tracking error beyond ten turns has diverged, rad."""

SPEED_BOUND = 1e5
"""So has a joint faster than this, rad/s."""


@cache
def loop_of_laws(compiled: bool, single: bool) -> Callable[..., Any]:
    """Return the loop around the compiled laws, as machine code or as plain Python.

    Each precision has its own: what is stored need not be asked whether to be rounded.
    """
    storing = rounded if single else kept
    return build(run_loop, {"control": summed_torque, "stored": storing}, compiled=compiled)


def flat(values: Any, kind: type = np.float64, *, as_array: bool = True) -> Any:
    """Return numbers in one row, as an array or, for an interpreter, as a list."""
    row: NDArray[Any] = np.ascontiguousarray(np.array(values, kind).ravel())
    return row if as_array else row.tolist()


class Program:
    """A controller as the loop takes it: integers, constants and memory in three lists.

    Attributes
    ----------
    program, numbers, memory : list
        See :func:`fuzzyarm.arm.loop.run_loop`.
    compilable : bool
        Whether every addend is a compiled law.
    """

    def __init__(self, controller: Controller, arithmetic: Arithmetic) -> None:
        self.controller = controller
        self.arithmetic = arithmetic
        self.program: list[int] = []
        self.numbers: list[float] = []
        self.memory: list[float] = []
        parts = list(controller.parts())
        self.compilable = all(isinstance(part, CompiledController) for part in parts)
        if self.compilable:
            for part in parts:
                assert isinstance(part, CompiledController)
                block = part.block(arithmetic)
                self.program += [block.kind, len(self.numbers), len(self.memory)]
                self.numbers += block.numbers
                self.memory += block.memory

    def loop(self, compiled: bool) -> Callable[..., Any]:
        """Return the loop that runs it; `compiled` only where that is possible."""
        if self.compilable:
            return loop_of_laws(compiled, self.arithmetic.single)
        torque = self.controller.torque

        def control(
            reference: Reference, state: State, _pose: Pose, clock: Clock, *_arrays: object
        ) -> Pair:
            first, second = torque(reference, state, clock)
            return float(first), float(second)

        return build(run_loop, {"control": control}, compiled=False)


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
        Arrays, or lists for the interpreter.
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
        kinds = list(dict.fromkeys(arms))
        which = np.array([kinds.index(arm) for arm in arms])[self.points.segment]
        plants = [constants(arm, single=conventions.single) for arm in kinds]
        self.inputs = (
            self._flat(self.points.position),
            self._flat(self.points.velocity),
            self._flat(self.points.acceleration),
            self._flat(self.points.iterations, np.int64),
            self._flat(which, np.int64),
            self._flat(plants),
        )
        step = SET_POINT_PERIOD / ITERATIONS
        if conventions.single:
            step = float(np.float32(np.float64(np.float32(SET_POINT_PERIOD)) / ITERATIONS))
        self.setting = Setting(
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

    def _flat(self, values: Any, kind: type = np.float64) -> Any:
        return flat(values, kind, as_array=self.as_array)

    def stretch(self, begin: int, end: int) -> tuple[Any, ...]:
        """Return the inputs of set points `begin` to `end` alone."""
        return (
            *(each[2 * begin : 2 * end] for each in self.inputs[:3]),
            *(each[begin:end] for each in self.inputs[3:5]),
            self.inputs[5],
        )


class Record:
    """What a call of the loop writes, and what it starts from."""

    def __init__(self, course: Course, memory: Any) -> None:
        count = len(course.points.time)

        def new(values: Any, kind: type = np.float64) -> Any:
            return flat(values, kind, as_array=course.as_array)

        self.memory = new(memory)
        self.state = new(np.zeros(4))
        self.errors = new(np.zeros(2 * count))
        self.torques = new(np.zeros(2 * count))
        self.progress = new([0, -1, -1], np.int64)

    @property
    def outputs(self) -> tuple[Any, ...]:
        """The last arguments of the loop, from the memory on."""
        return self.memory, self.state, self.errors, self.torques, self.progress

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
