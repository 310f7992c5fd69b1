"""Decentralised adaptive control: an adaptive PID for each joint alone (section 5.6)."""

from __future__ import annotations

from fuzzyarm.arm.signals import Clock, Pair, Reference, State, stored
from fuzzyarm.control import kinds
from fuzzyarm.control.gains import Gain, Gains
from fuzzyarm.control.law import Arithmetic, Law
from fuzzyarm.kernels import kernel

POSITION = Gain("p_2", (1650.0, 1650.0), "1/rad", "position error in r", "identified")
VELOCITY = Gain("p_3", (50.0, 50.0), "s/rad", "velocity error in r", "identified")
INTEGRAL_PART = Gain("C", (1.1, 1.6), "1/s", "integral part of the four gains", "identified")
DIRECT_PART = Gain("k", (1.0, 1.0), "1", "direct part of the four gains, times |r|", "identified")


@kernel
def decentralised_torque(
    reference: Reference,
    state: State,
    clock: Clock,
    numbers: list[float],
    at: int,
    memory: list[float],
    cell: int,
) -> Pair:
    """Return ``K_i + K_p e + K_d ė + K_f θ̈d`` with the gains of equation 5.6.10.

    Constants: p₂ (2), p₃ (2), C (2), k (2); memory: four integrals for each joint.
    """
    return (
        joint_torque(0, reference, state, clock, numbers, at, memory, cell),
        joint_torque(1, reference, state, clock, numbers, at + 1, memory, cell + 4),
    )


@kernel
def joint_torque(
    joint: int,
    reference: Reference,
    state: State,
    clock: Clock,
    numbers: list[float],
    at: int,
    memory: list[float],
    cell: int,
) -> float:
    """Return the torque of one joint; its constants are two apart."""
    error = reference.position[joint] - state.position[joint]
    rate = reference.velocity[joint] - state.velocity[joint]
    wanted = reference.acceleration[joint]
    r = numbers[at] * error + numbers[at + 2] * rate
    direct = numbers[at + 6] * abs(r) * r
    slow = numbers[at + 4]
    offset = slow * accumulated(memory, cell, r, clock) + direct
    stiffness = slow * accumulated(memory, cell + 1, r * error, clock) + direct * error
    damping = slow * accumulated(memory, cell + 2, r * rate, clock) + direct * rate
    inertia = slow * accumulated(memory, cell + 3, r * wanted, clock) + direct * wanted
    return offset + stiffness * error + damping * rate + inertia * wanted


@kernel
def accumulated(memory: list[float], cell: int, rate: float, clock: Clock) -> float:
    """Add ``rate · dt`` to a remembered integral and return it."""
    memory[cell] = stored(memory[cell] + rate * clock.step, clock.single)
    return memory[cell]


def _integrals(_gains: Gains, _arithmetic: Arithmetic) -> list[float]:
    return [0.0] * 8


LAW = Law(
    "dac",
    kinds.DECENTRALISED,
    "decentralised adaptive control: a PID of learned gains for each joint alone",
    (POSITION, VELOCITY, INTEGRAL_PART, DIRECT_PART),
    remember=_integrals,
)
