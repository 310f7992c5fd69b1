"""The two-rate loop: a set point every 3 ms, control and arm every 0.6 ms; and its error norms."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.kernels import kernel
from fuzzyarm.plant.arm import PLANT_SIZE, runge_kutta, semi_implicit
from fuzzyarm.plant.setting import (
    ITERATIONS,
    Clock,
    Moment,
    Pair,
    Pose,
    Reference,
    State,
    pose_of,
    stored,
)

# --- The two-rate loop: a set point every 3 ms, control and arm every 0.6 ms ---

LAST = ITERATIONS - 1
"""The iteration of a set point in which its sample is taken."""


class Setting(NamedTuple):
    """What does not change during a run; the loop takes it as an array in this order.

    Attributes
    ----------
    step : float
        Control period, s.
    single : bool
        Whether stored values are rounded to single precision.
    parts : int
        Runge-Kutta steps in a control period; 0 for the study's integrator.
    limit_1, limit_2 : float
        Largest torques, N m; infinite for none.
    error_bound : float
        Largest tracking error, rad; beyond it the run has diverged.
    speed_bound : float
        Largest joint velocity, rad/s.
    disturbance : float
        Largest relative disturbance of each state at each step; 0 for none.
    seed : int
        Of the disturbance, below 2³¹.
    """

    step: float
    single: bool
    parts: int
    limit_1: float
    limit_2: float
    error_bound: float
    speed_bound: float
    disturbance: float
    seed: int


@kernel
def control(
    now: Moment,
    laws: list[int],
    numbers: list[float],
    memory: list[float],
    signals: list[float],
) -> Pair:
    """Leave the arm alone; whoever builds the loop binds a controller to this name."""
    return 0.0, 0.0


@kernel
def advance(
    state: State, torque: Pair, pose: Pose, plants: list[float], plant: int, setting: Setting
) -> State:
    """Advance the arm by a control period, as the study's programs do."""
    return semi_implicit(state, torque, pose, plants, plant, setting.step, setting.single)


@kernel
def advance_exactly(
    state: State, torque: Pair, pose: Pose, plants: list[float], plant: int, setting: Setting
) -> State:
    """Advance by Runge-Kutta steps; bound to ``advance`` where the setting asks for some."""
    return runge_kutta(state, torque, plants, plant, setting.step, setting.parts, setting.single)


@kernel
def run_loop(
    motion: list[float],
    iterations: list[int],
    plant_of: list[int],
    plants: list[float],
    setting_numbers: list[float],
    laws: list[int],
    numbers: list[float],
    memory: list[float],
    signals: list[float],
    state: list[float],
    errors: list[float],
    torques: list[float],
    progress: list[int],
) -> None:
    """Follow the set points from `state` on; all arrays are flat.

    Parameters
    ----------
    motion : float, length 6 n
        Set points: desired position (rad), velocity (rad/s) and acceleration (rad/s²), of
        joint 1 and joint 2 each.
    iterations, plant_of : int, length n
        Control iterations of each set point, and which arm it meets.
    plants : float
        Nine constants for each arm.
    setting_numbers : float
        A :class:`Setting`.
    laws, numbers, memory, signals
        Passed on to the controller: its laws, its constants, what it remembers, and room
        for what it is told, see :func:`fuzzyarm.controller.law.summed_torque`.
    state : float, length 4
        Position and velocity at the start; holds those at the end afterwards.
    errors, torques : float, length 2 n
        Filled with the tracking error (rad) and the torque (N m) in the last full
        iteration of each set point.
    progress : int, length 3
        Filled with the number of samples, and, where the run diverged, the set point
        and the iteration in which it did (-1 otherwise).
    """
    # Read once: as scalars of a tuple they stay in registers over the whole run.
    s = setting_numbers
    setting = Setting(s[0], s[1] != 0.0, int(s[2]), s[3], s[4], s[5], s[6], s[7], int(s[8]))
    single = setting.single
    now = State((state[0], state[1]), (state[2], state[3]))
    random = setting.seed
    samples = 0
    progress[1] = -1
    progress[2] = -1
    for point in range(len(iterations)):
        j = 6 * point
        reference = Reference(
            (motion[j], motion[j + 1]),
            (motion[j + 2], motion[j + 3]),
            (motion[j + 4], motion[j + 5]),
        )
        plant = plant_of[point] * PLANT_SIZE
        # The set point is held for its iterations. Where a segment ends with one iteration
        # only (the study's clock does that) LAST is not reached, and there is no sample.
        for iteration in range(iterations[point]):
            last = iteration == LAST
            pose = pose_of(now.position)
            moment = Moment(reference, now, pose, Clock(setting.step, last, single))
            # Errors, then control, then the arm: a law never sees the state that it causes.
            wanted = control(moment, laws, numbers, memory, signals)
            torque = (
                clipped(stored(wanted[0], single), setting.limit_1),
                clipped(stored(wanted[1], single), setting.limit_2),
            )
            if last:  # before the arm moves: the error that this torque answers
                errors[2 * samples] = reference.position[0] - now.position[0]
                errors[2 * samples + 1] = reference.position[1] - now.position[1]
                torques[2 * samples] = torque[0]
                torques[2 * samples + 1] = torque[1]
                samples += 1
            now = advance(now, torque, pose, plants, plant, setting)
            if setting.disturbance > 0.0:
                now, random = disturbed(now, random, setting.disturbance, single)
            # Asked after every step: a lost arm reaches infinity within a few set points.
            if not within(now, reference, setting):
                progress[1] = point
                progress[2] = iteration
                break
        if progress[1] >= 0:
            break
    progress[0] = samples
    state[0], state[1] = now.position
    state[2], state[3] = now.velocity


LOOP_ARRAYS = "fiiffiffffffi"
"""Of floats and of integers, see :func:`fuzzyarm.kernels.routine`."""


@kernel
def clipped(torque: float, limit: float) -> float:
    """Bound a torque, N m; not a number passes."""
    # It fails both comparisons; so does the state that it leads to, and `within` ends the run.
    if torque > limit:
        return limit
    if torque < -limit:
        return -limit
    return torque


@kernel
def within(state: State, reference: Reference, setting: Setting) -> bool:
    """Tell whether the arm is near enough and slow enough; not a number is neither."""
    # Written as what has to be true, for a comparison with not a number is false.
    return (
        abs(reference.position[0] - state.position[0]) <= setting.error_bound
        and abs(reference.position[1] - state.position[1]) <= setting.error_bound
        and abs(state.velocity[0]) <= setting.speed_bound
        and abs(state.velocity[1]) <= setting.speed_bound
    )


@kernel
def drawn(random: int) -> int:
    """Advance a 31-bit linear congruential generator; no product overflows 64 bits."""
    # Factor and summand of the example in the C standard: all 2³¹ numbers in turn.
    return (random * 1103515245 + 12345) % 2147483648


@kernel
def disturbed(state: State, random: int, size: float, single: bool) -> tuple[State, int]:
    """Multiply each state by 1 + `size` times a random number in [-1, 1)."""
    # Always four draws in the order q₁, q₂, q̇₁, q̇₂: a seed says all, on any machine and with any
    # number of threads. 2³⁰ is the middle of the generator's range.
    first = drawn(random)
    second = drawn(first)
    third = drawn(second)
    fourth = drawn(third)
    scale = size / 1073741824.0
    return State(
        (
            stored(state.position[0] * (1.0 + scale * (first - 1073741824)), single),
            stored(state.position[1] * (1.0 + scale * (second - 1073741824)), single),
        ),
        (
            stored(state.velocity[0] * (1.0 + scale * (third - 1073741824)), single),
            stored(state.velocity[1] * (1.0 + scale * (fourth - 1073741824)), single),
        ),
    ), fourth


# --- Error norms of a run (section 3.4) ---

Vector = NDArray[np.float64]


def rms(errors: Vector) -> Vector:
    """Return the root of the mean square of each column.

    Parameters
    ----------
    errors : ndarray, shape (n, 2)
        Samples of the tracking error; no samples give not a number.
    """
    if not len(errors):
        return _none(errors)
    # The last running sum is the sum that np.mean takes, in a third of the time.
    squares = np.add.accumulate(np.square(errors), axis=0)[-1]
    return np.asarray(np.sqrt(squares / len(errors)))


def final(errors: Vector) -> Vector:
    """Return the last error of each column; without samples not a number."""
    return np.asarray(errors[-1]) if len(errors) else _none(errors)


def signed_maximum(errors: Vector, kind: Literal["magnitude", "positive"] = "magnitude") -> Vector:
    """Return the largest error of each column.

    Parameters
    ----------
    errors : ndarray, shape (n, 2)
        Samples of the tracking error; no samples give not a number.
    kind : {"magnitude", "positive"}
        The error of largest magnitude with its sign, or the most positive one.
    """
    if not len(errors):
        return _none(errors)
    if kind == "positive":
        return np.asarray(errors.max(axis=0))
    rows = np.abs(errors).argmax(axis=0)
    return np.asarray(errors[rows, np.arange(errors.shape[1])])


def _none(errors: Vector) -> Vector:
    return np.full(errors.shape[1], np.nan)
