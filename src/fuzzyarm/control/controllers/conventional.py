"""The conventional laws of the study: gains, kernel and record of each (sections 4.1 and 4.2)."""

from __future__ import annotations

from fuzzyarm.control.controllers.law import Gain, Law, model_gains, pack_gains, zeros
from fuzzyarm.plant.arm import UNLOADED, model_torque
from fuzzyarm.plant.setting import Observation, Pair, Reference, State, pose_of, stored
from fuzzyarm.symbolic.kernels import kernel

# --- Proportional plus derivative control (equation 4.1.1) ---

PD_PROPORTIONAL = Gain("K_P", (100.0, 100.0), "N m/rad", "position error")
PD_DERIVATIVE = Gain("K_D", (50.0, 50.0), "N m s/rad", "velocity error")


@kernel
def pd_torque(
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return ``K_P e + K_D ė``; constants: K_P (2), K_D (2)."""
    # In double precision throughout: a torque is rounded where the loop stores it.
    reference, state, _, _ = now
    return (
        numbers[2] * (reference.velocity[0] - state.velocity[0])
        + numbers[0] * (reference.position[0] - state.position[0]),
        numbers[3] * (reference.velocity[1] - state.velocity[1])
        + numbers[1] * (reference.position[1] - state.position[1]),
    )


PD_LAW = Law("pd", pd_torque, "proportional plus derivative", (PD_PROPORTIONAL, PD_DERIVATIVE))


# --- Computed torque: the model in the feedback path (equation 4.2.1.1) ---

MODEL = UNLOADED.with_values(J_1=0.0, J_2=0.0)
"""The model of the controllers of chapter 4: the unloaded arm without its motors."""

COMPUTED_TORQUE_PROPORTIONAL = Gain("K_P", (100.0, 100.0), "1/s²", "position error")
COMPUTED_TORQUE_DERIVATIVE = Gain("K_D", (50.0, 50.0), "1/s", "velocity error")


@kernel
def computed_torque(
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return ``M(θ)(θ̈d + K_D ė + K_P e) + V(θ, θ̇) θ̇ + F θ̇ + G(θ)``.

    Constants: K_P (2), K_D (2), model (9). The friction term, with the actual
    velocity, is not in the printed law; the published figures need it.
    """
    # The feedback is an acceleration, in rad/s², and the model turns it into a torque: with an
    # exact model the error obeys ë + K_D ė + K_P e = 0 in any pose.
    reference, state, pose, _ = now
    first = (
        reference.acceleration[0]
        + numbers[2] * (reference.velocity[0] - state.velocity[0])
        + numbers[0] * (reference.position[0] - state.position[0])
    )
    second = (
        reference.acceleration[1]
        + numbers[3] * (reference.velocity[1] - state.velocity[1])
        + numbers[1] * (reference.position[1] - state.position[1])
    )
    motion = Reference(state.position, state.velocity, (first, second))
    return model_torque(motion, state.velocity, pose, numbers, 4)


COMPUTED_TORQUE_LAW = Law(
    "ct",
    computed_torque,
    "computed torque: a model in the feedback path",
    (COMPUTED_TORQUE_PROPORTIONAL, COMPUTED_TORQUE_DERIVATIVE, *model_gains(MODEL)),
    pack=pack_gains("K_P", "K_D", model=True),
)


# --- Critically damped inverse dynamics (equations 4.2.3.1 to 4.2.3.4) ---

BANDWIDTH = Gain("Lambda", (100.0, 100.0), "1/s", "position error in the reference velocity")
SLIDING = Gain("K_D", (50.0, 50.0), "N m s/rad", "reference velocity minus velocity")


@kernel
def sliding_reference(
    reference: Reference, state: State, numbers: list[float], single: bool
) -> Reference:
    """Return the motion ``θ̇r = θ̇d + Λ e, θ̈r = θ̈d + Λ ė``; constants: Λ (2)."""
    # (4.2.3.1) and (4.2.3.2). If the arm moves with θ̇r, its error decays at the rate Λ, so a law
    # for θ̇ = θ̇r needs no term of the position.
    return Reference(
        reference.position,
        (
            stored(
                reference.velocity[0] + numbers[0] * (reference.position[0] - state.position[0]),
                single,
            ),
            stored(
                reference.velocity[1] + numbers[1] * (reference.position[1] - state.position[1]),
                single,
            ),
        ),
        (
            stored(
                reference.acceleration[0]
                + numbers[0] * (reference.velocity[0] - state.velocity[0]),
                single,
            ),
            stored(
                reference.acceleration[1]
                + numbers[1] * (reference.velocity[1] - state.velocity[1]),
                single,
            ),
        ),
    )


@kernel
def critically_damped_torque(
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return ``W(θ, θ̇, θ̇r, θ̈r) P + K_D (θ̇r − θ̇)``; constants: Λ (2), K_D (2), model (9)."""
    # (4.2.3.6). Against FFID the damping acts on Λ e too: as a proportional gain of K_D Λ.
    reference, state, pose, clock = now
    motion = sliding_reference(reference, state, numbers, clock.single)
    model = model_torque(motion, state.velocity, pose, numbers, 4)
    return (
        model[0] + numbers[2] * (motion.velocity[0] - state.velocity[0]),
        model[1] + numbers[3] * (motion.velocity[1] - state.velocity[1]),
    )


CRITICALLY_DAMPED_LAW = Law(
    "cdid",
    critically_damped_torque,
    "critically damped inverse dynamics: a model of a reference motion plus damping",
    (BANDWIDTH, SLIDING, *model_gains(MODEL)),
    pack=pack_gains("Lambda", "K_D", model=True),
)


# --- Feed-forward inverse dynamics: the model in the forward path (equation 4.2.2.1) ---


@kernel
def feed_forward_inverse_torque(
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return ``M(θ) θ̈d + V(θ, θ̇) θ̇d + F θ̇d + G(θ) + K_D ė + K_P e``.

    Constants: K_P (2), K_D (2), model (9).
    """
    # Feedback in N m is added after the model, not multiplied by it as in computed torque: a wrong
    # mass affects only the model's part.
    reference, state, pose, _ = now
    model = model_torque(reference, state.velocity, pose, numbers, 4)
    feedback = pd_torque(now, numbers, memory, links)
    return model[0] + feedback[0], model[1] + feedback[1]


FEED_FORWARD_INVERSE_LAW = Law(
    "ffid",
    feed_forward_inverse_torque,
    "feed-forward inverse dynamics: a model of the desired motion plus PD",
    (PD_PROPORTIONAL, PD_DERIVATIVE, *model_gains(MODEL)),
    pack=pack_gains("K_P", "K_D", model=True),
)


# --- Pure feed-forward with a stabilising term (equation 4.2.4.1) ---

STABILISING = Gain(
    "sigma", (100.0, 100.0), "N m/rad³", "error times its squared norm; σ K₂⁻¹ K in one", "own"
)


@kernel
def pure_feed_forward_torque(
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return ``W(θd, θ̇d, θ̈d) P + K_D ė + K_P e + σ ‖e‖² e``.

    Constants: K_P (2), K_D (2), σ (2), model (9).
    """
    # The model depends on the trajectory alone, so its pose is that of the set point and could be
    # computed before the run. The cubic term holds an arm far off the set point.
    reference, state, _, _ = now
    model = model_torque(reference, reference.velocity, pose_of(reference.position), numbers, 6)
    feedback = pd_torque(now, numbers, memory, links)
    first = reference.position[0] - state.position[0]
    second = reference.position[1] - state.position[1]
    square = first * first + second * second
    return (
        model[0] + feedback[0] + numbers[4] * square * first,
        model[1] + feedback[1] + numbers[5] * square * second,
    )


PURE_FEED_FORWARD_LAW = Law(
    "feedforward",
    pure_feed_forward_torque,
    "pure feed-forward: a model of the desired trajectory plus PD and a stabilising term",
    (PD_PROPORTIONAL, PD_DERIVATIVE, STABILISING, *model_gains(MODEL)),
    pack=pack_gains("K_P", "K_D", "sigma", model=True),
)


# --- Integral action over the five iterations of a set point or over the whole run ---

INTEGRAL_GAIN = Gain("K_I", (50.0, 50.0), "N m/rad", "sum of the position errors (no dt)")
WHOLE_RUN = Gain("whole_run", (0.0,), "1", "0: the sum is cleared after each set point; 1: never")


@kernel
def integral_torque(
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return ``K_I Σe``; constants: K_I (2), whole run; memory: the two sums."""
    # Raw errors, without dt. In the last iteration of a set point the whole sum still counts; it is
    # cleared for the next one.
    reference, state, _, clock = now
    first = stored(memory[0] + (reference.position[0] - state.position[0]), clock.single)
    second = stored(memory[1] + (reference.position[1] - state.position[1]), clock.single)
    if clock.last and numbers[2] == 0.0:
        memory[0] = 0.0
        memory[1] = 0.0
    else:
        memory[0] = first
        memory[1] = second
    return numbers[0] * first, numbers[1] * second


INTEGRAL_LAW = Law(
    "ie",
    integral_torque,
    "integral of the error over the iterations of a set point",
    (INTEGRAL_GAIN, WHOLE_RUN),
    remember=zeros(2),
)
