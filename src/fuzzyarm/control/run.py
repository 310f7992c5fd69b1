"""Close the loop: controller, trajectory and arm give errors over time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.arm import norms
from fuzzyarm.arm.conventions import ITERATIONS, PLAIN, SET_POINT_PERIOD, Conventions
from fuzzyarm.arm.faults import ArmError
from fuzzyarm.arm.loop import Setting, run_loop
from fuzzyarm.arm.parameters import ArmParameters, constants
from fuzzyarm.arm.payload import Schedule, schedule
from fuzzyarm.arm.signals import Clock, Pair, Pose, Reference, State
from fuzzyarm.arm.trajectory import SetPoints, Trajectory, sample
from fuzzyarm.control.controller import CompiledController, Controller
from fuzzyarm.control.dispatch import summed_torque
from fuzzyarm.control.law import Arithmetic
from fuzzyarm.kernels import build, jit_wanted

Vector = NDArray[np.float64]

ERROR_BOUND = 20.0 * math.pi
"""A tracking error beyond ten turns has diverged, rad."""

SPEED_BOUND = 1e5
"""So has a joint faster than this, rad/s."""


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
                raise ArmError(f"a torque limit of {limit} N m is out of sense", value=limit)
        if not 0 <= self.runge_kutta <= 1000:
            raise ArmError(
                f"{self.runge_kutta} Runge-Kutta steps in a control period are out of sense",
                value=self.runge_kutta,
                hint="0 to 1000",
            )


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
        return norms.rms(self.errors)

    @property
    def final(self) -> Vector:
        """Last error of each joint, degrees."""
        return norms.final(self.errors)

    @property
    def maximum(self) -> Vector:
        """Largest error of each joint, as the conventions count it, degrees."""
        return norms.signed_maximum(self.errors, self.conventions.maximum)


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
    if arms is None:
        arms = schedule(trajectory, payload=payload, conventions=conventions)
    if len(arms) != len(trajectory.segments):
        raise ArmError(
            f"a payload schedule of {len(arms)} arms does not fit the "
            f"{len(trajectory.segments)} segments of '{trajectory.name}'",
            name="arms",
            value=len(arms),
        )
    points = sample(trajectory, conventions)
    arithmetic = Arithmetic(conventions.single, conventions.pi)
    program = _Program(controller, arithmetic)
    wanted = jit_wanted() if options.compiled is None else options.compiled
    compiled = wanted and program.compilable
    loop = _loop(compiled) if program.compilable else program.interpreted_loop()
    outcome = _Outcome(points, arms, conventions, options, program, as_arrays=compiled)
    controller.prepare(arithmetic)
    begin = time.perf_counter()
    with np.errstate(all="ignore"):
        loop(*outcome.arguments)
    seconds = time.perf_counter() - begin
    return outcome.run(controller.name, trajectory.name, seconds, compiled)


@cache
def _loop(compiled: bool) -> Callable[..., Any]:
    return build(run_loop, {"control": summed_torque}, compiled=compiled)


class _Program:
    """A controller as the loop takes it: integers, constants and memory in three lists."""

    def __init__(self, controller: Controller, arithmetic: Arithmetic) -> None:
        self.controller = controller
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

    def interpreted_loop(self) -> Callable[..., Any]:
        """Build the loop around the controller's own Python."""
        torque = self.controller.torque

        def control(
            reference: Reference, state: State, _pose: Pose, clock: Clock, *_arrays: object
        ) -> Pair:
            first, second = torque(reference, state, clock)
            return float(first), float(second)

        return build(run_loop, {"control": control}, compiled=False)


class _Outcome:
    """The arguments of one call of the loop and what they hold afterwards."""

    def __init__(
        self,
        points: SetPoints,
        arms: tuple[ArmParameters, ...],
        conventions: Conventions,
        options: Options,
        program: _Program,
        *,
        as_arrays: bool,
    ) -> None:
        def numbers(values: Any, kind: type = np.float64) -> Any:
            flat: NDArray[Any] = np.ascontiguousarray(np.array(values, kind).ravel())
            # Lists of Python numbers are what an interpreter is fast with.
            return flat if as_arrays else flat.tolist()

        step = SET_POINT_PERIOD / ITERATIONS
        if conventions.single:
            step = float(np.float32(np.float64(np.float32(SET_POINT_PERIOD)) / ITERATIONS))
        count = len(points.time)
        kinds = list(dict.fromkeys(arms))
        which = np.array([kinds.index(arm) for arm in arms])[points.segment]
        plants = [constants(arm, single=conventions.single) for arm in kinds]
        self.points = points
        self.conventions = conventions
        self.memory = numbers(program.memory)
        self.errors = numbers(np.zeros(2 * count))
        self.torques = numbers(np.zeros(2 * count))
        self.progress = numbers([0, -1, -1], np.int64)
        setting = Setting(
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
        self.arguments = (
            numbers(points.position),
            numbers(points.velocity),
            numbers(points.acceleration),
            numbers(points.iterations, np.int64),
            numbers(which, np.int64),
            numbers(plants),
            setting,
            numbers(program.program, np.int64),
            numbers(program.numbers),
            self.memory,
            numbers(np.zeros(4)),
            self.errors,
            self.torques,
            self.progress,
        )

    def run(self, controller: str, trajectory: str, seconds: float, compiled: bool) -> Run:
        samples, point, iteration = (int(each) for each in self.progress)
        taken = np.flatnonzero(self.points.iterations == ITERATIONS)[:samples]
        degrees = 180.0 / self.conventions.pi
        errors = np.array(self.errors[: 2 * samples]).reshape(-1, 2)
        diverged = None
        if point >= 0:
            diverged = float(self.points.time[point]) + (iteration + 1) * (
                SET_POINT_PERIOD / ITERATIONS
            )
        return Run(
            controller,
            trajectory,
            self.conventions,
            self.points.time[taken],
            self.points.position[taken] * degrees,
            errors * degrees,
            np.array(self.torques[: 2 * samples]).reshape(-1, 2),
            diverged,
            seconds,
            compiled,
            [float(each) for each in self.memory],
        )
