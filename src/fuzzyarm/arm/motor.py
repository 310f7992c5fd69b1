"""Direct-current motor with back-EMF: from voltage to joint torque (chapter 6)."""

from __future__ import annotations

from fuzzyarm.kernels import kernel

TORQUE_CONSTANT = 0.066
"""Of both motors, N m/A, and, in V s/rad, their back-EMF constant."""

RESISTANCE = 2.32
"""Of the armatures, Ω."""

RATIOS = (80.0, 70.0)
"""Gear ratio N of each joint."""

TORQUE_LIMITS = (55.44, 48.51)
"""Largest torques that the study's programs name and do not apply, N m."""


@kernel
def motor_torque(voltage: float, velocity: float, ratio: float) -> float:
    """Return ``(V − k·ω·N)·k/R·N``.

    Parameters
    ----------
    voltage : float
        At the armature, V.
    velocity : float
        Of the joint, rad/s.
    ratio : float
        N, turns of the motor per turn of the joint.

    Returns
    -------
    float
        At the joint, N m.
    """
    return (voltage - 0.066 * (velocity * ratio)) * 0.066 / 2.32 * ratio
