"""Equations of motion: mass matrix, Coriolis, friction, gravity (equation 3.2.20).

``τ = (M(θ) + J) θ̈ + V(θ, θ̇) θ̇ + F θ̇ + G(θ)``, all in SI units. The matrix
functions take arrays and are for reading and checking; the kernels are what the
closed loop runs.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyarm.arm.parameters import ArmParameters, constants
from fuzzyarm.arm.signals import Pair, Pose, Reference, State, stored
from fuzzyarm.kernels import kernel

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
        Velocity that Coriolis and friction terms multiply, and acceleration.
    velocity : pair of float
        Velocity inside the Coriolis matrix, rad/s.
    pose : Pose
        Where the model is evaluated.
    numbers : sequence of float
        Holds the nine constants of the model from index `at` on.
    at : int
        See `numbers`.

    Returns
    -------
    pair of float
        Joint torques, N m.
    """
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
    """Evaluate the forward dynamics of an arm whose constants start at `at`; rad/s²."""
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
    """Return the torque that moves the arm so; arrays of shape (..., 2), N m."""
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
    """Return the energy of height over the base, J."""
    p = constants(arm)
    first, second = state.position
    return float(p[5] * np.sin(first) + p[6] * np.sin(first + second))
