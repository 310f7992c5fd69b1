"""The conventional laws of the study: gains, kernel and record of each (sections 4.1 and 4.2)."""

from __future__ import annotations

from fuzzyarm.controller.law import (
    COMPUTED_TORQUE,
    CRITICALLY_DAMPED,
    FEED_FORWARD_INVERSE,
    INTEGRAL,
    PD,
    PURE_FEED_FORWARD,
    Arithmetic,
    Gain,
    Gains,
    Law,
    model_gains,
    pack_with_model,
)
from fuzzyarm.kernels import kernel
from fuzzyarm.plant.arm import UNLOADED, model_torque
from fuzzyarm.plant.setting import Clock, Pair, Pose, Reference, State, pose_of, stored

# --- Proportional plus derivative control (equation 4.1.1) ---

PD_PROPORTIONAL = Gain("K_P", (100.0, 100.0), "N m/rad", "position error")
PD_DERIVATIVE = Gain("K_D", (50.0, 50.0), "N m s/rad", "velocity error")


@kernel
def pd_torque(reference: Reference, state: State, numbers: list[float], at: int) -> Pair:
    """Return ``K_P e + K_D ė``; constants: K_P (2), K_D (2)."""
    return (
        numbers[at + 2] * (reference.velocity[0] - state.velocity[0])
        + numbers[at] * (reference.position[0] - state.position[0]),
        numbers[at + 3] * (reference.velocity[1] - state.velocity[1])
        + numbers[at + 1] * (reference.position[1] - state.position[1]),
    )


PD_LAW = Law("pd", PD, "proportional plus derivative", (PD_PROPORTIONAL, PD_DERIVATIVE))


# --- Computed torque: the model in the feedback path (equation 4.2.1.1) ---

MODEL = UNLOADED.with_values(J_1=0.0, J_2=0.0)
"""What the controllers of chapter 4 know: the unloaded arm without its motors."""

COMPUTED_TORQUE_PROPORTIONAL = Gain("K_P", (100.0, 100.0), "1/s²", "position error")
COMPUTED_TORQUE_DERIVATIVE = Gain("K_D", (50.0, 50.0), "1/s", "velocity error")


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


COMPUTED_TORQUE_LAW = Law(
    "ct",
    COMPUTED_TORQUE,
    "computed torque: a model in the feedback path",
    (COMPUTED_TORQUE_PROPORTIONAL, COMPUTED_TORQUE_DERIVATIVE, *model_gains(MODEL)),
    pack=pack_with_model(("K_P", "K_D")),
)


# --- Critically damped inverse dynamics (equations 4.2.3.1 to 4.2.3.4) ---

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


CRITICALLY_DAMPED_LAW = Law(
    "cdid",
    CRITICALLY_DAMPED,
    "critically damped inverse dynamics: a model of a reference motion plus damping",
    (BANDWIDTH, SLIDING, *model_gains(MODEL)),
    pack=pack_with_model(("Lambda", "K_D")),
)


# --- Feed-forward inverse dynamics: the model in the forward path (equation 4.2.2.1) ---


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


FEED_FORWARD_INVERSE_LAW = Law(
    "ffid",
    FEED_FORWARD_INVERSE,
    "feed-forward inverse dynamics: a model of the desired motion plus PD",
    (PD_PROPORTIONAL, PD_DERIVATIVE, *model_gains(MODEL)),
    pack=pack_with_model(("K_P", "K_D")),
)


# --- Pure feed-forward with a stabilising term (equation 4.2.4.1) ---

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


PURE_FEED_FORWARD_LAW = Law(
    "feedforward",
    PURE_FEED_FORWARD,
    "pure feed-forward: a model of the desired trajectory plus PD and a stabilising term",
    (PD_PROPORTIONAL, PD_DERIVATIVE, STABILISING, *model_gains(MODEL)),
    pack=pack_with_model(("K_P", "K_D", "sigma")),
)


# --- Integral action over the five iterations of a set point or over the whole run ---

INTEGRAL_GAIN = Gain("K_I", (50.0, 50.0), "N m/rad", "sum of the position errors (no dt)")
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


INTEGRAL_LAW = Law(
    "ie",
    INTEGRAL,
    "integral of the error over the iterations of a set point",
    (INTEGRAL_GAIN, WHOLE_RUN),
    remember=_sums,
)
