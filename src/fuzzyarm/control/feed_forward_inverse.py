"""Feed-forward inverse dynamics: the model in the forward path (equation 4.2.2.1)."""

from __future__ import annotations

from fuzzyarm.arm.dynamics import model_torque
from fuzzyarm.arm.signals import Pair, Pose, Reference, State
from fuzzyarm.control import kinds
from fuzzyarm.control.computed_torque import MODEL
from fuzzyarm.control.law import Law, model_gains, pack_with_model
from fuzzyarm.control.pd import DERIVATIVE, PROPORTIONAL, pd_torque
from fuzzyarm.kernels import kernel


@kernel
def feed_forward_inverse_torque(
    reference: Reference, state: State, pose: Pose, numbers: list[float], at: int
) -> Pair:
    """Return ``M(θ) θ̈d + V(θ, θ̇) θ̇d + F θ̇d + G(θ) + K_D ė + K_P e``.

    Constants: K_P (2), K_D (2), model (9).
    """
    model = model_torque(reference, state.velocity, pose, numbers, at + 4)
    feedback = pd_torque(reference, state, numbers, at)
    return model[0] + feedback[0], model[1] + feedback[1]


LAW = Law(
    "ffid",
    kinds.FEED_FORWARD_INVERSE,
    "feed-forward inverse dynamics: a model of the desired motion plus PD",
    (PROPORTIONAL, DERIVATIVE, *model_gains(MODEL)),
    pack=pack_with_model(("K_P", "K_D")),
)
