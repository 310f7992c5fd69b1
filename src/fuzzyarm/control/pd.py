"""Proportional plus derivative control (equation 4.1.1)."""

from __future__ import annotations

from fuzzyarm.arm.signals import Pair, Reference, State
from fuzzyarm.control import kinds
from fuzzyarm.control.gains import Gain
from fuzzyarm.control.law import Law
from fuzzyarm.kernels import kernel

PROPORTIONAL = Gain("K_P", (100.0, 100.0), "N m/rad", "position error")
DERIVATIVE = Gain("K_D", (50.0, 50.0), "N m s/rad", "velocity error")


@kernel
def pd_torque(reference: Reference, state: State, numbers: list[float], at: int) -> Pair:
    """Return ``K_P e + K_D ė``; constants: K_P (2), K_D (2)."""
    return (
        numbers[at + 2] * (reference.velocity[0] - state.velocity[0])
        + numbers[at] * (reference.position[0] - state.position[0]),
        numbers[at + 3] * (reference.velocity[1] - state.velocity[1])
        + numbers[at + 1] * (reference.position[1] - state.position[1]),
    )


LAW = Law("pd", kinds.PD, "proportional plus derivative", (PROPORTIONAL, DERIVATIVE))
