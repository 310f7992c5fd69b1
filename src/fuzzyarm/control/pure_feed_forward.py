"""Pure feed-forward with a stabilising term (equation 4.2.4.1)."""

from __future__ import annotations

from fuzzyarm.arm.dynamics import model_torque
from fuzzyarm.arm.signals import Pair, Reference, State, pose_of
from fuzzyarm.control import kinds
from fuzzyarm.control.computed_torque import MODEL
from fuzzyarm.control.gains import Gain
from fuzzyarm.control.law import Law, model_gains, pack_with_model
from fuzzyarm.control.pd import DERIVATIVE, PROPORTIONAL, pd_torque
from fuzzyarm.kernels import kernel

STABILISING = Gain(
    "sigma", (100.0, 100.0), "N m/rad³", "error times its squared norm; σ K₂⁻¹ K in one", "own"
)


@kernel
def pure_feed_forward_torque(
    reference: Reference, state: State, numbers: list[float], at: int
) -> Pair:
    """Return ``W(θd, θ̇d, θ̈d) P + K_D ė + K_P e + σ ‖e‖² e``.

    Constants: K_P (2), K_D (2), σ (2), model (9).
    """
    model = model_torque(
        reference, reference.velocity, pose_of(reference.position), numbers, at + 6
    )
    feedback = pd_torque(reference, state, numbers, at)
    first = reference.position[0] - state.position[0]
    second = reference.position[1] - state.position[1]
    square = first * first + second * second
    return (
        model[0] + feedback[0] + numbers[at + 4] * square * first,
        model[1] + feedback[1] + numbers[at + 5] * square * second,
    )


LAW = Law(
    "feedforward",
    kinds.PURE_FEED_FORWARD,
    "pure feed-forward: a model of the desired trajectory plus PD and a stabilising term",
    (PROPORTIONAL, DERIVATIVE, STABILISING, *model_gains(MODEL)),
    pack=pack_with_model(("K_P", "K_D", "sigma")),
)
