"""The adaptive laws of the study: adapted quantities, adaptation, torque (sections 5.4 to 5.6).

Each law has its gains, its kernel and its ``LAW`` record. Adapted quantities are in the memory
argument of the kernel, in the order of its docstring.
"""

from __future__ import annotations

from fuzzyarm.control.controllers.conventional import BANDWIDTH, SLIDING, sliding_reference
from fuzzyarm.control.controllers.law import (
    Gain,
    Gains,
    Law,
    model_constants,
    model_gains,
    pack_gains,
    zeros,
)
from fuzzyarm.plant.arm import ESTIMATE, model_torque
from fuzzyarm.plant.setting import Clock, Observation, Pair, RunArithmetic, stored
from fuzzyarm.symbolic.kernels import kernel

# --- Adaptive critically damped inverse dynamics (section 5.4) ---

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
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return ``Ŵ P̂ + K_D (θ̇r − θ̇)`` and adapt ``P̂ ← P̂ − dt Γ Wᵀ (θ̇ − θ̇r)``.

    Constants: Λ (2), K_D (2), Γ (7), velocity in W22; memory: P̂ (7), motor inertias (2).
    """
    # (5.4.3): CDID with the estimate in place of the model. It damps, and adapts by, θ̇ − θ̇r in
    # rad/s.
    reference, state, pose, clock = now
    motion = sliding_reference(reference, state, numbers, clock.single)
    v_1, v_2 = state.velocity
    r_1, r_2 = motion.velocity
    a_1, a_2 = motion.acceleration
    e_1 = stored(v_1 - r_1, clock.single)
    e_2 = stored(v_2 - r_2, clock.single)
    model = model_torque(motion, state.velocity, pose, memory, 0)
    torque = (model[0] - numbers[2] * e_1, model[1] - numbers[3] * e_2)

    # (5.4.7), after the torque: the new estimate holds from the next step on. Each parameter
    # integrates its column of W times θ̇ − θ̇r; that of P2 is long enough for names.
    w_12 = (
        pose.cos_2 * (a_1 + 0.5 * a_2)
        - 0.5 * pose.sin_2 * v_2 * (r_1 + r_2)
        - 0.5 * pose.sin_2 * v_1 * r_2
    )
    # The published figures have the reference velocity in W22, the theory has the acceleration.
    moved = r_1 if numbers[11] != 0.0 else a_1
    w_22 = 0.5 * (pose.cos_2 * moved + pose.sin_2 * v_1 * r_1)
    adapt(memory, 0, numbers[4] * a_1 * e_1, clock)
    adapt(memory, 1, numbers[5] * (w_12 * e_1 + w_22 * e_2), clock)
    adapt(memory, 2, numbers[6] * (a_2 * e_1 + (a_1 + a_2) * e_2), clock)
    adapt(memory, 3, numbers[7] * r_1 * e_1, clock)
    adapt(memory, 4, numbers[8] * r_2 * e_2, clock)
    adapt(memory, 5, numbers[9] * pose.cos_1 * e_1, clock)
    adapt(memory, 6, numbers[10] * pose.cos_12 * (e_1 + e_2), clock)
    return torque


@kernel
def adapt(memory: list[float], cell: int, rate: float, clock: Clock) -> None:
    """Subtract ``rate · dt`` from a remembered number."""
    # The rate is a stored value, as the parameter is: in single precision both are rounded.
    memory[cell] = stored(memory[cell] - clock.step * stored(rate, clock.single), clock.single)


ADAPTIVE_CRITICALLY_DAMPED_LAW = Law(
    "acdid",
    adaptive_critically_damped_torque,
    "adaptive critically damped inverse dynamics: seven parameters learned on the way",
    (BANDWIDTH, SLIDING, ADAPTATION, SLIP, *model_gains(ESTIMATE)),
    pack=pack_gains("Lambda", "K_D", "Gamma", "velocity_in_W22"),
    remember=model_constants,
)


# --- Decentralised adaptive control: an adaptive PID for each joint alone (section 5.6) ---

POSITION = Gain("p_2", (1650.0, 1650.0), "1/rad", "position error in r", "identified")
VELOCITY = Gain("p_3", (50.0, 50.0), "s/rad", "velocity error in r", "identified")
INTEGRAL_PART = Gain("C", (1.1, 1.6), "1/s", "integral part of the four gains", "identified")
DIRECT_PART = Gain("k", (1.0, 1.0), "1", "direct part of the four gains, times |r|", "identified")


@kernel
def decentralised_torque(
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return ``K_i + K_p e + K_d ė + K_f θ̈d`` with the gains of equation 5.6.10.

    Constants: p₂ (2), p₃ (2), C (2), k (2); memory: four integrals for each joint.
    """
    # No term of one joint in the torque of the other: coupling counts as a disturbance.
    return (
        joint_torque(0, now, numbers, memory),
        joint_torque(1, now, numbers, memory),
    )


@kernel
def joint_torque(joint: int, now: Observation, numbers: list[float], memory: list[float]) -> float:
    """Return the torque of one joint; its constants are two apart."""
    # (5.6.10): each of the four gains is C ∫ r s dt + k |r| r s, with s = 1, e, ė and θ̈d, and r
    # a weighted error. The direct part is the same for all four and is computed once.
    reference, state, _, clock = now
    cell = 4 * joint
    error = reference.position[joint] - state.position[joint]
    rate = reference.velocity[joint] - state.velocity[joint]
    wanted = reference.acceleration[joint]
    r = numbers[joint] * error + numbers[joint + 2] * rate
    direct = numbers[joint + 6] * abs(r) * r
    slow = numbers[joint + 4]
    offset = slow * accumulated(memory, cell, r, clock) + direct
    stiffness = slow * accumulated(memory, cell + 1, r * error, clock) + direct * error
    damping = slow * accumulated(memory, cell + 2, r * rate, clock) + direct * rate
    inertia = slow * accumulated(memory, cell + 3, r * wanted, clock) + direct * wanted
    return offset + stiffness * error + damping * rate + inertia * wanted


@kernel
def accumulated(memory: list[float], cell: int, rate: float, clock: Clock) -> float:
    """Add ``rate · dt`` to a remembered integral and return it."""
    # The torque of this step uses the new value.
    memory[cell] = stored(memory[cell] + rate * clock.step, clock.single)
    return memory[cell]


DECENTRALISED_LAW = Law(
    "dac",
    decentralised_torque,
    "decentralised adaptive control: a PID of learned gains for each joint alone",
    (POSITION, VELOCITY, INTEGRAL_PART, DIRECT_PART),
    remember=zeros(8),
)


# --- Model reference adaptive control (section 5.5) ---

STIFFNESS = Gain(
    "K_1", (500.0, 500.0), "1/s²", "position in the reference model", "identified", True
)
DAMPING = Gain("K_2", (100.0, 100.0), "1/s", "velocity in the reference model", "identified", True)
ADAPT_STATE = Gain(
    "a", (100.0,), "1", "adaptation of the gains on position and velocity", "identified"
)
ADAPT_INPUT = Gain("b", (2.0,), "1", "adaptation of the gain on the input", "identified")
UNIT_MASS = Gain("unit_mass", (1.0,), "kg m²", "multiplies u: 1 as in the figures", "identified")
GRAVITY = Gain(
    "gravity", (1.0,), "1", "1: with the estimate's gravity term; 0: without", "identified"
)
ACCELERATION = Gain(
    "acceleration_in_v",
    (1.0,),
    "1",
    "1: with the desired acceleration in v; 0: without",
    "identified",
)
INERTIA = Gain(
    "inertia_times_u",
    (0.0,),
    "1",
    "0: unit mass times u, desired motion in the model, as the figures have it; 1: as the text",
    "identified",
)


@kernel
def model_reference_torque(
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return the torque of equations 5.5.11 to 5.5.14 and adapt its gain matrices.

    ``v = θ̈d + K₂ θ̇d + K₁ θd``, ``u = v − K₁ θ − K₂ θ̇ − Δ₁ θ − Δ₂ θ̇ + Δv v``, and the
    torque is u (unit mass) plus, from the estimate, gravity at the actual position,
    friction at the desired velocity and ``(M̂ + J) θ̈d``. The gains follow
    ``Δ̇₁ = −a w θᵀ``, ``Δ̇₂ = −a w θ̇ᵀ``, ``Δ̇v = b w vᵀ`` with ``w = P₂ e + P₃ ė``.

    Constants: K₁ (2), K₂ (2), P₂ (2), P₃ (2), −a, b, unit mass, gravity, form, whether
    θ̈d is in v, model (9);
    memory: Δ₁, Δ₂, Δv, each 2 × 2 by rows.
    """
    reference, state, pose, clock = now
    q_1, q_2 = state.position
    v_1, v_2 = state.velocity
    a_1, a_2 = reference.acceleration
    e_1 = reference.position[0] - q_1
    e_2 = reference.position[1] - q_2
    d_1 = reference.velocity[0] - v_1
    d_2 = reference.velocity[1] - v_2
    # v drives the reference model and, by Δv, the arm.
    into = numbers[13]
    in_1 = into * a_1 + numbers[2] * reference.velocity[0] + numbers[0] * reference.position[0]
    in_2 = into * a_2 + numbers[3] * reference.velocity[1] + numbers[1] * reference.position[1]
    # (5.5.12) fixed feedback towards the reference model, then (5.5.13) the learned part.
    u_1 = in_1 - numbers[0] * q_1 - numbers[2] * v_1
    u_2 = in_2 - numbers[1] * q_2 - numbers[3] * v_2
    u_1 += row_times(memory, 8, in_1, in_2)
    u_1 -= row_times(memory, 0, q_1, q_2) + row_times(memory, 4, v_1, v_2)
    u_2 += row_times(memory, 10, in_1, in_2)
    u_2 -= row_times(memory, 2, q_1, q_2) + row_times(memory, 6, v_1, v_2)

    # The torque from u, and the contribution of the estimate. Figures: u times a unit mass, gravity
    # at the actual position, friction and inertia of the desired motion. Text: the estimate's
    # inertia times u, friction of the actual motion.
    model = 14
    mass = numbers[10]
    weight = numbers[11]
    rubbed = reference.velocity
    moved = reference.acceleration
    if numbers[12] != 0.0:
        mass = 0.0
        rubbed = state.velocity
        moved = (u_1, u_2)
    coupling = numbers[model + 2] + 0.5 * numbers[model + 1] * pose.cos_2
    torque_1 = (
        mass * u_1
        + weight * (numbers[model + 5] * pose.cos_1 + numbers[model + 6] * pose.cos_12)
        + numbers[model + 3] * rubbed[0]
        + (numbers[model] + numbers[model + 1] * pose.cos_2 + numbers[model + 7]) * moved[0]
        + coupling * moved[1]
    )
    torque_2 = (
        mass * u_2
        + weight * numbers[model + 6] * pose.cos_12
        + numbers[model + 4] * rubbed[1]
        + coupling * moved[0]
        + (numbers[model + 2] + numbers[model + 8]) * moved[1]
    )

    # (5.5.14) and (5.5.15): the gains move along the outer product of w with the gained signals.
    w_1 = numbers[4] * e_1 + numbers[6] * d_1
    w_2 = numbers[5] * e_2 + numbers[7] * d_2
    slow = numbers[8] * clock.step
    fast = numbers[9] * clock.step
    add_outer_product(memory, 0, slow * w_1, slow * w_2, q_1, q_2, clock.single)
    add_outer_product(memory, 4, slow * w_1, slow * w_2, v_1, v_2, clock.single)
    add_outer_product(memory, 8, fast * w_1, fast * w_2, in_1, in_2, clock.single)
    return torque_1, torque_2


@kernel
def row_times(memory: list[float], cell: int, first: float, second: float) -> float:
    """Multiply one row of a 2 × 2 matrix with a vector."""
    # `cell` is where the row begins: a matrix lies by rows.
    return memory[cell] * first + memory[cell + 1] * second


@kernel
def add_outer_product(
    memory: list[float],
    cell: int,
    left_1: float,
    left_2: float,
    right_1: float,
    right_2: float,
    single: bool,
) -> None:
    """Add the outer product of two vectors to a 2 × 2 matrix."""
    # Full matrices, as in the study: a joint learns from the other's motion, too.
    memory[cell] = stored(memory[cell] + left_1 * right_1, single)
    memory[cell + 1] = stored(memory[cell + 1] + left_1 * right_2, single)
    memory[cell + 2] = stored(memory[cell + 2] + left_2 * right_1, single)
    memory[cell + 3] = stored(memory[cell + 3] + left_2 * right_2, single)


SWITCHES = ("a", "b", "unit_mass", "gravity", "inertia_times_u", "acceleration_in_v")


def _pack_model_reference(gains: Gains, arithmetic: RunArithmetic) -> list[float]:
    # Q = I in the Lyapunov equation gives P2 = 1/(2 K1) and P3 = (1 + 2 P2)/(2 K2).
    second = [0.5 / value for value in gains["K_1"].value]
    third = [
        (1.0 + 2.0 * inertia) / (2.0 * value)
        for inertia, value in zip(second, gains["K_2"].value, strict=True)
    ]
    front = [*gains["K_1"].value, *gains["K_2"].value, *second, *third]
    switches = [gains[name].value[0] for name in SWITCHES]
    model = model_constants(gains, arithmetic)
    # Δ₁ and Δ₂ grow with −a w; the kernel adds.
    switches[0] = -switches[0]
    return [*(arithmetic.hold(value) for value in (*front, *switches)), *model]


MODEL_REFERENCE_LAW = Law(
    "mrac",
    model_reference_torque,
    "model reference adaptive control: feedback gains learned on the way",
    (
        STIFFNESS,
        DAMPING,
        ADAPT_STATE,
        ADAPT_INPUT,
        UNIT_MASS,
        GRAVITY,
        INERTIA,
        ACCELERATION,
        *model_gains(ESTIMATE),
    ),
    pack=_pack_model_reference,
    remember=zeros(12),
)
