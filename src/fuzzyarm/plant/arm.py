"""The two-link arm: parameters, equations of motion, integration over a control period, motors."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyarm.plant.setting import ArmError, Pair, Pose, Reference, State, pose_of, stored
from fuzzyarm.symbolic.kernels import kernel

# --- Parameters of the two-link arm, with and without its load ---
#
# Symbols, units and values: Tables 3.2.1, 4.3.1.2 and 5.2.2 of the study.

GRAVITY = 9.8
"""m/s², as in the study."""

MOTOR_INERTIA = 0.1498
"""Inertia of each motor, kg m²."""

UNITS = {
    "m_1": "kg",
    "m_2": "kg",
    "l_1": "m",
    "x_1": "m",
    "x_2": "m",
    "I_1": "kg m²",
    "I_2": "kg m²",
    "F_1": "N m s/rad",
    "F_2": "N m s/rad",
    "J_1": "kg m²",
    "J_2": "kg m²",
    "g": "m/s²",
}
"""Unit of each field of :class:`ArmParameters`."""


@dataclass(frozen=True)
class ArmParameters:
    """A two-link arm in the vertical plane, angles from the horizontal.

    Parameters
    ----------
    m_1, m_2 : float
        Masses of the links, kg.
    l_1 : float
        Length of the first link, m.
    x_1, x_2 : float
        Distance of each centre of mass from its joint, m.
    I_1, I_2 : float
        Inertia of each link about its centre of mass, kg m².
    F_1, F_2 : float
        Viscous friction of the joints, N m s/rad.
    J_1, J_2 : float
        Inertia of the motors, kg m².
    g : float
        Acceleration of gravity, m/s².

    Raises
    ------
    ArmError
        If a parameter is not finite or, gravity aside, negative.
    """

    m_1: float = 2.0
    m_2: float = 2.0
    l_1: float = 0.26
    x_1: float = 0.13
    x_2: float = 0.14
    I_1: float = 0.09
    I_2: float = 0.09
    F_1: float = 2.5
    F_2: float = 2.5
    J_1: float = MOTOR_INERTIA
    J_2: float = MOTOR_INERTIA
    g: float = GRAVITY

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not math.isfinite(value) or (value < 0 and name != "g"):
                message = f"arm parameter {name} = {value} is out of range"
                raise ArmError(message, name=name, value=value)

    def with_values(self, **values: float) -> ArmParameters:
        """Return the arm with some parameters replaced."""
        return replace(self, **values)


UNLOADED = ArmParameters()
"""The arm without a load (Table 3.2.1)."""

LOADED = ArmParameters(m_1=3.0, m_2=3.0, x_1=0.15, x_2=0.16, I_1=1.5)
"""The arm with its load (Table 4.3.1.2)."""


ESTIMATE = ArmParameters(m_1=1.0, m_2=1.0, x_1=0.11, x_2=0.12, I_1=0.05, I_2=0.05, F_1=2.0, F_2=2.0)
"""The initial model of adaptive controllers at a warm start (Table 5.2.2)."""

INEXACT = ArmParameters(m_1=1.8, m_2=1.8)
"""The slightly wrong model of Table 4.2.5.2."""


def constants(arm: ArmParameters, *, single: bool = False) -> NDArray[np.float64]:
    """Return the constants of the equations of motion.

    Parameters
    ----------
    arm : ArmParameters
        The arm.
    single : bool, optional
        Round the parameters and then the constants to single precision.

    Returns
    -------
    ndarray of float64, shape (9,)
        P1 … P7 (equations 3.2.21 to 3.2.27), then the two motor inertias.
    """

    def hold(value: float) -> float:
        return float(np.float32(value)) if single else value

    m_1, m_2, l_1, x_1, x_2, i_1, i_2, f_1, f_2, _, _, g = (
        hold(getattr(arm, field.name)) for field in fields(arm)
    )
    values = (
        i_1 + i_2 + m_2 * (x_2 * x_2 + l_1 * l_1) + m_1 * x_1 * x_1,
        2.0 * m_2 * l_1 * x_2,
        m_2 * x_2 * x_2 + i_2,
        f_1,
        f_2,
        g * (m_1 * x_1 + m_2 * l_1),
        m_2 * x_2 * g,
    )
    # The programs had the motor inertia as a double literal: it is not rounded.
    return np.array([*map(hold, values), arm.J_1, arm.J_2])


# --- Equations of motion: mass matrix, Coriolis, friction, gravity (equation 3.2.20) ---
#
# `τ = (M(θ) + J) θ̈ + V(θ, θ̇) θ̇ + F θ̇ + G(θ)`, all in SI units. The matrix functions over
# arrays are for reading and checking; the closed loop runs the kernels.

Vector = NDArray[np.float64]

PLANT_SIZE = 9
"""Numbers per arm in the arrays of the loop: P1 … P7 and two motor inertias."""


@kernel
def model_torque(
    motion: Reference, velocity: Pair, pose: Pose, numbers: list[float], at: int
) -> Pair:
    """Evaluate the inverse dynamics of a model.

    Parameters
    ----------
    motion : Reference
        Acceleration, and the velocity that multiplies Coriolis and friction terms.
    velocity : pair of float
        Velocity in the Coriolis matrix, rad/s.
    pose : Pose
        Trigonometric values of the position.
    numbers : sequence of float
        Constants, the model's nine starting at index `at`.
    at : int
        Index of the first one.

    Returns
    -------
    pair of float
        Joint torques, N m.
    """
    # (3.2.20) with P1 … P7 and both motor inertias at numbers[at] and following; half of P2 is
    # m₂ l₁ x₂, the coupling of the joints. Coriolis terms are products of two velocities, and laws
    # differ in their choice: computed torque takes the actual one twice, FFID actual and desired,
    # CDID actual and reference.
    half = 0.5 * numbers[at + 1]
    coupling = numbers[at + 2] + half * pose.cos_2
    a_1, a_2 = motion.acceleration
    v_1, v_2 = motion.velocity
    first = (
        (numbers[at] + numbers[at + 1] * pose.cos_2 + numbers[at + 7]) * a_1
        + coupling * a_2
        + (numbers[at + 3] - numbers[at + 1] * pose.sin_2 * velocity[1]) * v_1
        - half * pose.sin_2 * velocity[1] * v_2
        + numbers[at + 5] * pose.cos_1
        + numbers[at + 6] * pose.cos_12
    )
    second = (
        coupling * a_1
        + (numbers[at + 2] + numbers[at + 8]) * a_2
        + half * pose.sin_2 * velocity[0] * v_1
        + numbers[at + 4] * v_2
        + numbers[at + 6] * pose.cos_12
    )
    return first, second


@kernel
def joint_acceleration(
    velocity: Pair, torque: Pair, pose: Pose, numbers: list[float], at: int, single: bool
) -> Pair:
    """Evaluate the forward dynamics with the arm's constants at index `at`; rad/s²."""
    # (3.2.20) solved for θ̈. First the torques at zero acceleration; each sum is rounded as a
    # whole, where the study's programs stored it in a variable.
    half = 0.5 * numbers[at + 1]
    rest_1 = stored(
        (numbers[at + 3] - numbers[at + 1] * pose.sin_2 * velocity[1]) * velocity[0]
        - half * pose.sin_2 * velocity[1] * velocity[1]
        + numbers[at + 5] * pose.cos_1
        + numbers[at + 6] * pose.cos_12,
        single,
    )
    rest_2 = stored(
        half * pose.sin_2 * velocity[0] * velocity[0]
        + numbers[at + 4] * velocity[1]
        + numbers[at + 6] * pose.cos_12,
        single,
    )
    m_11 = stored(numbers[at] + numbers[at + 1] * pose.cos_2 + numbers[at + 7], single)
    m_12 = stored(numbers[at + 2] + half * pose.cos_2, single)
    m_22 = stored(numbers[at + 2] + numbers[at + 8], single)
    first = torque[0] - rest_1
    second = torque[1] - rest_2
    # Cramer's rule; the mass matrix is positive definite, so its determinant is positive.
    determinant = m_11 * m_22 - m_12 * m_12
    return (
        stored((first * m_22 - second * m_12) / determinant, single),
        stored((second * m_11 - first * m_12) / determinant, single),
    )


def mass_matrix(arm: ArmParameters, position: ArrayLike) -> Vector:
    """Return M(θ) + J.

    Parameters
    ----------
    arm : ArmParameters
        The arm.
    position : array_like, shape (..., 2)
        Joint angles, rad.

    Returns
    -------
    ndarray, shape (..., 2, 2)
        kg m²; symmetric and positive definite.
    """
    p = constants(arm)
    cosine = np.cos(np.asarray(position, float)[..., 1])
    coupling = p[2] + 0.5 * p[1] * cosine
    first = np.stack([p[0] + p[1] * cosine + p[7], coupling], axis=-1)
    second = np.stack([coupling, np.broadcast_to(p[2] + p[8], coupling.shape)], axis=-1)
    return np.stack([first, second], axis=-2)


def coriolis_matrix(arm: ArmParameters, position: ArrayLike, velocity: ArrayLike) -> Vector:
    """Return V(θ, θ̇) of equation 3.2.20, shape (..., 2, 2), N m s/rad."""
    sine = 0.5 * constants(arm)[1] * np.sin(np.asarray(position, float)[..., 1])
    speed = np.asarray(velocity, float)
    zero = np.zeros(np.broadcast_shapes(sine.shape, speed.shape[:-1]))
    first = np.stack([zero - 2.0 * sine * speed[..., 1], zero - sine * speed[..., 1]], axis=-1)
    second = np.stack([zero + sine * speed[..., 0], zero], axis=-1)
    return np.stack([first, second], axis=-2)


def friction_matrix(arm: ArmParameters) -> Vector:
    """Return F, the viscous friction of the joints, shape (2, 2), N m s/rad."""
    return np.diag([arm.F_1, arm.F_2])


def gravity_torque(arm: ArmParameters, position: ArrayLike) -> Vector:
    """Return G(θ), shape (..., 2), N m."""
    p = constants(arm)
    angle = np.asarray(position, float)
    second = p[6] * np.cos(angle[..., 0] + angle[..., 1])
    return np.stack([p[5] * np.cos(angle[..., 0]) + second, second], axis=-1)


def inverse_dynamics(
    arm: ArmParameters, position: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Vector:
    """Return the torque for a motion; arrays of shape (..., 2), N m."""
    speed = np.asarray(velocity, float)[..., None]
    inertia = mass_matrix(arm, position) @ np.asarray(acceleration, float)[..., None]
    other = (coriolis_matrix(arm, position, velocity) + friction_matrix(arm)) @ speed
    return np.asarray((inertia + other)[..., 0] + gravity_torque(arm, position))


def forward_dynamics(
    arm: ArmParameters, position: ArrayLike, velocity: ArrayLike, torque: ArrayLike
) -> Vector:
    """Return the acceleration under a torque; arrays of shape (..., 2), rad/s²."""
    rest = inverse_dynamics(arm, position, velocity, np.zeros(2))
    free = np.asarray(torque, float) - rest
    return np.asarray(np.linalg.solve(mass_matrix(arm, position), free[..., None])[..., 0])


def kinetic_energy(arm: ArmParameters, state: State) -> float:
    """Return the kinetic energy of links and motors, J."""
    speed = np.array(state.velocity)
    return float(0.5 * speed @ mass_matrix(arm, state.position) @ speed)


def potential_energy(arm: ArmParameters, state: State) -> float:
    """Return the potential energy relative to the base, J."""
    p = constants(arm)
    first, second = state.position
    return float(p[5] * np.sin(first) + p[6] * np.sin(first + second))


# --- The equations of motion, linear in seven parameters (equation 3.2.28) ---


def parameter_vector(arm: ArmParameters) -> NDArray[np.float64]:
    """Return P1 … P7, shape (7,), without the motor inertias."""
    return constants(arm)[:7]


def regressor(
    position: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> NDArray[np.float64]:
    """Return W(θ, θ̇, θ̈), so that ``τ = W P + J θ̈``.

    Parameters
    ----------
    position, velocity, acceleration : array_like, shape (..., 2)
        rad, rad/s, rad/s².

    Returns
    -------
    ndarray, shape (..., 2, 7)
        Equation 3.2.28; its W12 is derived from the matrix form (3.2.20), because the printed one
        has wrong signs and factors in a velocity product.
    """
    q, v, a = np.broadcast_arrays(
        np.asarray(position, float), np.asarray(velocity, float), np.asarray(acceleration, float)
    )
    cos_1, cos_12 = np.cos(q[..., 0]), np.cos(q[..., 0] + q[..., 1])
    sin_2, cos_2 = np.sin(q[..., 1]), np.cos(q[..., 1])
    v_1, v_2 = v[..., 0], v[..., 1]
    a_1, a_2 = a[..., 0], a[..., 1]
    zero = np.zeros_like(a_1)
    coupled = cos_2 * (a_1 + 0.5 * a_2) - sin_2 * v_2 * (v_1 + 0.5 * v_2)
    first = [a_1, coupled, a_2, v_1, zero, cos_1, cos_12]
    second = [zero, 0.5 * (cos_2 * a_1 + sin_2 * v_1 * v_1), a_1 + a_2, zero, v_2, zero, cos_12]
    return np.stack([np.stack(first, axis=-1), np.stack(second, axis=-1)], axis=-2)


# --- One control period of the arm under constant torque ---
#
# `semi_implicit` is the study's integrator; `runge_kutta` checks it.


@kernel
def semi_implicit(
    state: State,
    torque: Pair,
    pose: Pose,
    numbers: list[float],
    at: int,
    step: float,
    single: bool,
) -> State:
    """Advance by ``v ← v + a·dt``, then ``q ← q + v·dt + ½·a·dt²`` with the new v.

    Parameters
    ----------
    state : State
        Before the step.
    torque : pair of float
        N m, constant over the step.
    pose : Pose
        Sines and cosines of the position in `state`.
    numbers, at
        The constants of the arm, see :func:`joint_acceleration`.
    step : float
        dt, s.
    single : bool
        Round velocity and position to single precision.

    Returns
    -------
    State
        After the step.
    """
    acceleration = joint_acceleration(state.velocity, torque, pose, numbers, at, single)
    # The study's order: first the velocity, then the position with the new velocity. A joint moves
    # by v dt + 3/2 a dt², where exact integration gives 1/2. In single precision a position does
    # not move while the increment is below its last bit.
    v_1 = stored(acceleration[0] * step + state.velocity[0], single)
    v_2 = stored(acceleration[1] * step + state.velocity[1], single)
    q_1 = stored(state.position[0] + v_1 * step + 0.5 * acceleration[0] * step * step, single)
    q_2 = stored(state.position[1] + v_2 * step + 0.5 * acceleration[1] * step * step, single)
    return State((q_1, q_2), (v_1, v_2))


@kernel
def runge_kutta(
    state: State,
    torque: Pair,
    numbers: list[float],
    at: int,
    step: float,
    parts: int,
    single: bool,
) -> State:
    """Advance by `parts` classical fourth-order steps; arguments as above."""
    # Slopes (v, a) at the start, twice at the midpoint and at the end of each step, with constant
    # torque and without intermediate rounding: the reference for the integrator above.
    h = step / parts
    now = state
    for _ in range(parts):
        a = joint_acceleration(now.velocity, torque, pose_of(now.position), numbers, at, False)
        second = _moved(now, now.velocity, a, 0.5 * h)
        b = joint_acceleration(
            second.velocity, torque, pose_of(second.position), numbers, at, False
        )
        third = _moved(now, second.velocity, b, 0.5 * h)
        c = joint_acceleration(third.velocity, torque, pose_of(third.position), numbers, at, False)
        fourth = _moved(now, third.velocity, c, h)
        d = joint_acceleration(
            fourth.velocity, torque, pose_of(fourth.position), numbers, at, False
        )
        speed = _weighted(now.velocity, second.velocity, third.velocity, fourth.velocity)
        now = _moved(now, speed, _weighted(a, b, c, d), h)
    return State(
        (stored(now.position[0], single), stored(now.position[1], single)),
        (stored(now.velocity[0], single), stored(now.velocity[1], single)),
    )


@kernel
def _moved(state: State, speed: Pair, acceleration: Pair, h: float) -> State:
    return State(
        (state.position[0] + h * speed[0], state.position[1] + h * speed[1]),
        (state.velocity[0] + h * acceleration[0], state.velocity[1] + h * acceleration[1]),
    )


@kernel
def _weighted(a: Pair, b: Pair, c: Pair, d: Pair) -> Pair:
    # Simpson weights of the classical method.
    return (
        (a[0] + 2.0 * b[0] + 2.0 * c[0] + d[0]) / 6.0,
        (a[1] + 2.0 * b[1] + 2.0 * c[1] + d[1]) / 6.0,
    )


# --- Direct-current motor with back-EMF: from voltage to joint torque (chapter 6) ---

TORQUE_CONSTANT = 0.066
"""Torque constant of both motors, N m/A; equal to their back-EMF constant, V s/rad."""

RESISTANCE = 2.32
"""Armature resistance, Ω."""

RATIOS = (80.0, 70.0)
"""Gear ratio N of each joint."""

TORQUE_LIMITS = (55.44, 48.51)
"""Torque limits named but not applied in the study's programs, N m."""


@kernel
def motor_torque(voltage: float, velocity: float, ratio: float) -> float:
    """Return ``(V − k·ω·N)·k/R·N``.

    Parameters
    ----------
    voltage : float
        Armature voltage, V.
    velocity : float
        Joint velocity, rad/s.
    ratio : float
        N, turns of the motor per turn of the joint.

    Returns
    -------
    float
        Joint torque, N m.
    """
    # The motor turns `ratio` times as fast as the joint; the voltage minus the back-EMF drives the
    # current (armature inductance neglected), and the gears multiply its torque.
    back_emf = TORQUE_CONSTANT * (velocity * ratio)
    return (voltage - back_emf) * TORQUE_CONSTANT / RESISTANCE * ratio
