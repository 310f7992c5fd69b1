"""Adaptive critically damped inverse dynamics (section 5.4)."""

from __future__ import annotations

from fuzzyarm.arm.dynamics import model_torque
from fuzzyarm.arm.parameters import ESTIMATE, constants
from fuzzyarm.arm.signals import Clock, Pair, Pose, Reference, State, stored
from fuzzyarm.control import kinds
from fuzzyarm.control.critically_damped import BANDWIDTH, SLIDING, sliding_reference
from fuzzyarm.control.gains import Gain, Gains
from fuzzyarm.control.law import Arithmetic, Law, model_gains, model_of
from fuzzyarm.kernels import kernel

ADAPTATION = Gain("Gamma", (100.0,) * 7, "1/s", "adaptation of P1 … P7")
SLIP = Gain(
    "velocity_in_W22",
    (1.0,),
    "1",
    "1: W22 with reference velocity, as the figures have it; 0: with acceleration, as in theory",
    "identified",
)


@kernel
def adaptive_critically_damped_torque(
    reference: Reference,
    state: State,
    pose: Pose,
    clock: Clock,
    numbers: list[float],
    at: int,
    memory: list[float],
    cell: int,
) -> Pair:
    """Return ``Ŵ P̂ + K_D (θ̇r − θ̇)`` and adapt ``P̂ ← P̂ − dt Γ Wᵀ (θ̇ − θ̇r)``.

    Constants: Λ (2), K_D (2), Γ (7), velocity in W22; memory: P̂ (7), motor inertias (2).
    """
    motion = sliding_reference(reference, state, numbers, at, clock.single)
    v_1, v_2 = state.velocity
    r_1, r_2 = motion.velocity
    a_1, a_2 = motion.acceleration
    e_1 = stored(v_1 - r_1, clock.single)
    e_2 = stored(v_2 - r_2, clock.single)
    model = model_torque(motion, state.velocity, pose, memory, cell)
    torque = (model[0] - numbers[at + 2] * e_1, model[1] - numbers[at + 3] * e_2)

    w_12 = (
        pose.cos_2 * (a_1 + 0.5 * a_2)
        - 0.5 * pose.sin_2 * v_2 * (r_1 + r_2)
        - 0.5 * pose.sin_2 * v_1 * r_2
    )
    driven = r_1 if numbers[at + 11] != 0.0 else a_1
    w_22 = 0.5 * (pose.cos_2 * driven + pose.sin_2 * v_1 * r_1)
    adapt(memory, cell, numbers[at + 4] * a_1 * e_1, clock)
    adapt(memory, cell + 1, numbers[at + 5] * (w_12 * e_1 + w_22 * e_2), clock)
    adapt(memory, cell + 2, numbers[at + 6] * (a_2 * e_1 + (a_1 + a_2) * e_2), clock)
    adapt(memory, cell + 3, numbers[at + 7] * r_1 * e_1, clock)
    adapt(memory, cell + 4, numbers[at + 8] * r_2 * e_2, clock)
    adapt(memory, cell + 5, numbers[at + 9] * pose.cos_1 * e_1, clock)
    adapt(memory, cell + 6, numbers[at + 10] * pose.cos_12 * (e_1 + e_2), clock)
    return torque


@kernel
def adapt(memory: list[float], cell: int, rate: float, clock: Clock) -> None:
    """Subtract ``rate · dt`` from a remembered number."""
    memory[cell] = stored(memory[cell] - clock.step * stored(rate, clock.single), clock.single)


def _pack(gains: Gains, arithmetic: Arithmetic) -> list[float]:
    names = ("Lambda", "K_D", "Gamma", "velocity_in_W22")
    return [arithmetic.hold(value) for name in names for value in gains[name].value]


def remember_estimate(gains: Gains, arithmetic: Arithmetic) -> list[float]:
    """Start from the model among the gains: P̂ (7) and motor inertias (2)."""
    return [float(value) for value in constants(model_of(gains), single=arithmetic.single)]


LAW = Law(
    "acdid",
    kinds.ADAPTIVE_CRITICALLY_DAMPED,
    "adaptive critically damped inverse dynamics: seven parameters learned on the way",
    (BANDWIDTH, SLIDING, ADAPTATION, SLIP, *model_gains(ESTIMATE)),
    pack=_pack,
    remember=remember_estimate,
)
