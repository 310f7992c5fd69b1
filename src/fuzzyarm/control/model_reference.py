"""Model reference adaptive control (section 5.5)."""

from __future__ import annotations

from fuzzyarm.arm.parameters import ESTIMATE
from fuzzyarm.arm.signals import Clock, Pair, Pose, Reference, State, stored
from fuzzyarm.control import kinds
from fuzzyarm.control.gains import Gain, Gains
from fuzzyarm.control.law import Arithmetic, Law, model_gains, pack_with_model
from fuzzyarm.kernels import kernel

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
    reference: Reference,
    state: State,
    pose: Pose,
    clock: Clock,
    numbers: list[float],
    at: int,
    memory: list[float],
    cell: int,
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
    q_1, q_2 = state.position
    v_1, v_2 = state.velocity
    a_1, a_2 = reference.acceleration
    e_1 = reference.position[0] - q_1
    e_2 = reference.position[1] - q_2
    d_1 = reference.velocity[0] - v_1
    d_2 = reference.velocity[1] - v_2
    into = numbers[at + 13]
    in_1 = (
        into * a_1 + numbers[at + 2] * reference.velocity[0] + numbers[at] * reference.position[0]
    )
    in_2 = (
        into * a_2
        + numbers[at + 3] * reference.velocity[1]
        + numbers[at + 1] * reference.position[1]
    )
    u_1 = in_1 - numbers[at] * q_1 - numbers[at + 2] * v_1
    u_2 = in_2 - numbers[at + 1] * q_2 - numbers[at + 3] * v_2
    u_1 += times(memory, cell + 8, in_1, in_2)
    u_1 -= times(memory, cell, q_1, q_2) + times(memory, cell + 4, v_1, v_2)
    u_2 += times(memory, cell + 10, in_1, in_2)
    u_2 -= times(memory, cell + 2, q_1, q_2) + times(memory, cell + 6, v_1, v_2)

    model = at + 14
    mass = numbers[at + 10]
    weight = numbers[at + 11]
    rubbed = reference.velocity
    moved = reference.acceleration
    if numbers[at + 12] != 0.0:
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

    w_1 = numbers[at + 4] * e_1 + numbers[at + 6] * d_1
    w_2 = numbers[at + 5] * e_2 + numbers[at + 7] * d_2
    slow = numbers[at + 8] * clock.step
    fast = numbers[at + 9] * clock.step
    grow(memory, cell, slow * w_1, slow * w_2, q_1, q_2, clock.single)
    grow(memory, cell + 4, slow * w_1, slow * w_2, v_1, v_2, clock.single)
    grow(memory, cell + 8, fast * w_1, fast * w_2, in_1, in_2, clock.single)
    return torque_1, torque_2


@kernel
def times(memory: list[float], cell: int, first: float, second: float) -> float:
    """Multiply one row of a 2 × 2 matrix with a vector."""
    return memory[cell] * first + memory[cell + 1] * second


@kernel
def grow(
    memory: list[float],
    cell: int,
    left_1: float,
    left_2: float,
    right_1: float,
    right_2: float,
    single: bool,
) -> None:
    """Add the outer product of two vectors to a 2 × 2 matrix."""
    memory[cell] = stored(memory[cell] + left_1 * right_1, single)
    memory[cell + 1] = stored(memory[cell + 1] + left_1 * right_2, single)
    memory[cell + 2] = stored(memory[cell + 2] + left_2 * right_1, single)
    memory[cell + 3] = stored(memory[cell + 3] + left_2 * right_2, single)


SWITCHES = ("a", "b", "unit_mass", "gravity", "inertia_times_u", "acceleration_in_v")


def _pack(gains: Gains, arithmetic: Arithmetic) -> list[float]:
    # Q = I in the Lyapunov equation gives P2 = 1/(2 K1) and P3 = (1 + 2 P2)/(2 K2).
    second = [0.5 / value for value in gains["K_1"].value]
    third = [
        (1.0 + 2.0 * each) / (2.0 * value)
        for each, value in zip(second, gains["K_2"].value, strict=True)
    ]
    front = [*gains["K_1"].value, *gains["K_2"].value, *second, *third]
    switches = [gains[name].value[0] for name in SWITCHES]
    model = pack_with_model(())(gains, arithmetic)
    # Δ₁ and Δ₂ grow with −a w; the kernel adds.
    switches[0] = -switches[0]
    return [*(arithmetic.hold(value) for value in (*front, *switches)), *model]


def _nothing_learned(_gains: Gains, _arithmetic: Arithmetic) -> list[float]:
    return [0.0] * 12


LAW = Law(
    "mrac",
    kinds.MODEL_REFERENCE,
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
    pack=_pack,
    remember=_nothing_learned,
)
