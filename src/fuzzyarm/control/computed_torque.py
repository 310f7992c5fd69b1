"""Computed torque: the model in the feedback path (equation 4.2.1.1)."""

from __future__ import annotations

from fuzzyarm.arm.dynamics import model_torque
from fuzzyarm.arm.parameters import UNLOADED
from fuzzyarm.arm.signals import Pair, Pose, Reference, State
from fuzzyarm.control import kinds
from fuzzyarm.control.gains import Gain
from fuzzyarm.control.law import Law, model_gains, pack_with_model
from fuzzyarm.kernels import kernel

MODEL = UNLOADED.with_values(J_1=0.0, J_2=0.0)
"""What the controllers of chapter 4 know: the unloaded arm without its motors."""

PROPORTIONAL = Gain("K_P", (100.0, 100.0), "1/s²", "position error")
DERIVATIVE = Gain("K_D", (50.0, 50.0), "1/s", "velocity error")


@kernel
def computed_torque(
    reference: Reference, state: State, pose: Pose, numbers: list[float], at: int
) -> Pair:
    """Return ``M(θ)(θ̈d + K_D ė + K_P e) + V(θ, θ̇) θ̇ + F θ̇ + G(θ)``.

    Constants: K_P (2), K_D (2), model (9). The friction term, with the actual
    velocity, is not in the printed law; the published figures need it.
    """
    first = (
        reference.acceleration[0]
        + numbers[at + 2] * (reference.velocity[0] - state.velocity[0])
        + numbers[at] * (reference.position[0] - state.position[0])
    )
    second = (
        reference.acceleration[1]
        + numbers[at + 3] * (reference.velocity[1] - state.velocity[1])
        + numbers[at + 1] * (reference.position[1] - state.position[1])
    )
    motion = Reference(state.position, state.velocity, (first, second))
    return model_torque(motion, state.velocity, pose, numbers, at + 4)


LAW = Law(
    "ct",
    kinds.COMPUTED_TORQUE,
    "computed torque: a model in the feedback path",
    (PROPORTIONAL, DERIVATIVE, *model_gains(MODEL)),
    pack=pack_with_model(("K_P", "K_D")),
)
