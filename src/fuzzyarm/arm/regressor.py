"""The equations of motion, linear in seven parameters (equation 3.2.28)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyarm.arm.parameters import ArmParameters, constants


def parameter_vector(arm: ArmParameters) -> NDArray[np.float64]:
    """Return P1 … P7, shape (7,); motor inertia is not among them."""
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
        Equation 3.2.28; its W12 is taken from the matrix form (3.2.20), because the
        printed one has the signs and factors of a velocity product wrong.
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
