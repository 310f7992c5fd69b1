"""Critically damped inverse dynamics (equations 4.2.3.1 to 4.2.3.4)."""

from __future__ import annotations

from fuzzyarm.arm.dynamics import model_torque
from fuzzyarm.arm.signals import Pair, Pose, Reference, State, stored
from fuzzyarm.control import kinds
from fuzzyarm.control.computed_torque import MODEL
from fuzzyarm.control.gains import Gain
from fuzzyarm.control.law import Law, model_gains, pack_with_model
from fuzzyarm.kernels import kernel

BANDWIDTH = Gain("Lambda", (100.0, 100.0), "1/s", "position error in the reference velocity")
SLIDING = Gain("K_D", (50.0, 50.0), "N m s/rad", "reference velocity minus velocity")


@kernel
def sliding_reference(
    reference: Reference, state: State, numbers: list[float], at: int, single: bool
) -> Reference:
    """Return the motion ``θ̇r = θ̇d + Λ e, θ̈r = θ̈d + Λ ė``; constants: Λ (2)."""
    return Reference(
        reference.position,
        (
            stored(
                reference.velocity[0] + numbers[at] * (reference.position[0] - state.position[0]),
                single,
            ),
            stored(
                reference.velocity[1]
                + numbers[at + 1] * (reference.position[1] - state.position[1]),
                single,
            ),
        ),
        (
            stored(
                reference.acceleration[0]
                + numbers[at] * (reference.velocity[0] - state.velocity[0]),
                single,
            ),
            stored(
                reference.acceleration[1]
                + numbers[at + 1] * (reference.velocity[1] - state.velocity[1]),
                single,
            ),
        ),
    )


@kernel
def critically_damped_torque(
    reference: Reference,
    state: State,
    pose: Pose,
    single: bool,
    numbers: list[float],
    at: int,
) -> Pair:
    """Return ``W(θ, θ̇, θ̇r, θ̈r) P + K_D (θ̇r − θ̇)``; constants: Λ (2), K_D (2), model (9)."""
    motion = sliding_reference(reference, state, numbers, at, single)
    model = model_torque(motion, state.velocity, pose, numbers, at + 4)
    return (
        model[0] + numbers[at + 2] * (motion.velocity[0] - state.velocity[0]),
        model[1] + numbers[at + 3] * (motion.velocity[1] - state.velocity[1]),
    )


LAW = Law(
    "cdid",
    kinds.CRITICALLY_DAMPED,
    "critically damped inverse dynamics: a model of a reference motion plus damping",
    (BANDWIDTH, SLIDING, *model_gains(MODEL)),
    pack=pack_with_model(("Lambda", "K_D")),
)
