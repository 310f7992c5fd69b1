"""Close the loop: controller, trajectory and arm give errors over time."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.arm import norms
from fuzzyarm.arm.conventions import ITERATIONS, PLAIN, Conventions
from fuzzyarm.arm.faults import ArmError
from fuzzyarm.arm.payload import Schedule, schedule
from fuzzyarm.arm.signals import Pair
from fuzzyarm.arm.trajectory import Trajectory
from fuzzyarm.control.controller import Controller
from fuzzyarm.control.law import Arithmetic
from fuzzyarm.control.program import Course, Program, Record, flat
from fuzzyarm.kernels import jit_wanted

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
    arms = checked_arms(trajectory, arms, payload=payload, conventions=conventions)
    arithmetic = Arithmetic(conventions.single, conventions.pi)
    program = Program(controller, arithmetic)
    wanted = jit_wanted() if options.compiled is None else options.compiled
    compiled = wanted and program.compilable
    loop = program.loop(compiled)
    course = Course(trajectory, arms, conventions, options, as_array=compiled)
    record = Record(course, program.memory)
    constants = [flat(program.program, np.int64, as_array=compiled)]
    constants.append(flat(program.numbers, as_array=compiled))
    controller.prepare(arithmetic)
    begin = time.perf_counter()
    with np.errstate(all="ignore"):
        loop(*course.inputs, course.setting, *constants, *record.outputs)
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
        [float(each) for each in record.memory],
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
