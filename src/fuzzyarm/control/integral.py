"""Integral action over the five iterations of a set point or over the whole run."""

from __future__ import annotations

from fuzzyarm.arm.signals import Clock, Pair, Reference, State, stored
from fuzzyarm.control import kinds
from fuzzyarm.control.gains import Gain, Gains
from fuzzyarm.control.law import Arithmetic, Law
from fuzzyarm.kernels import kernel

INTEGRAL = Gain("K_I", (50.0, 50.0), "N m/rad", "sum of the position errors (no dt)")
WHOLE_RUN = Gain("whole_run", (0.0,), "1", "0: the sum is cleared after each set point; 1: never")


@kernel
def integral_torque(
    reference: Reference,
    state: State,
    clock: Clock,
    numbers: list[float],
    at: int,
    memory: list[float],
    cell: int,
) -> Pair:
    """Return ``K_I Σe``; constants: K_I (2), whole run; memory: the two sums."""
    first = stored(memory[cell] + (reference.position[0] - state.position[0]), clock.single)
    second = stored(memory[cell + 1] + (reference.position[1] - state.position[1]), clock.single)
    if clock.last and numbers[at + 2] == 0.0:
        memory[cell] = 0.0
        memory[cell + 1] = 0.0
    else:
        memory[cell] = first
        memory[cell + 1] = second
    return numbers[at] * first, numbers[at + 1] * second


def _sums(_gains: Gains, _arithmetic: Arithmetic) -> list[float]:
    return [0.0, 0.0]


LAW = Law(
    "ie",
    kinds.INTEGRAL,
    "integral of the error over the iterations of a set point",
    (INTEGRAL, WHOLE_RUN),
    remember=_sums,
)
