"""The parameters of the two-link arm, with and without its load.

Symbols, units and values: Tables 3.2.1, 4.3.1.2 and 5.2.2 of the study.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.arm.faults import ArmError

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
        for field in fields(self):
            value = getattr(self, field.name)
            if not math.isfinite(value) or (value < 0 and field.name != "g"):
                raise ArmError(
                    f"arm parameter {field.name} = {value} is out of sense",
                    name=field.name,
                    value=value,
                )

    def with_values(self, **values: float) -> ArmParameters:
        """Return the arm with some parameters replaced."""
        return replace(self, **values)


UNLOADED = ArmParameters()
"""The arm as it is (Table 3.2.1)."""

LOADED = ArmParameters(m_1=3.0, m_2=3.0, x_1=0.15, x_2=0.16, I_1=1.5)
"""The arm that has picked up its load (Table 4.3.1.2)."""

ESTIMATE = ArmParameters(m_1=1.0, m_2=1.0, x_1=0.11, x_2=0.12, I_1=0.05, I_2=0.05, F_1=2.0, F_2=2.0)
"""What adaptive controllers believe at a warm start (Table 5.2.2)."""

INEXACT = ArmParameters(m_1=1.8, m_2=1.8)
"""The slightly wrong model of Table 4.2.5.2."""


def constants(arm: ArmParameters, *, single: bool = False) -> NDArray[np.float64]:
    """Reduce the arm to the numbers its equations of motion need.

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
    # The programs wrote the motor inertia as a double literal into their expressions.
    return np.array([*map(hold, values), arm.J_1, arm.J_2])
