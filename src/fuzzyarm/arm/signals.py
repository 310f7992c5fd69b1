"""What goes over the wires between reference, controller and arm.

Named tuples of pairs, one number per joint: kernels take them in registers, and a
controller in plain Python reads ``reference.position[0]``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fuzzyarm.kernels import kernel

Pair = tuple[float, float]
"""One number per joint."""


class Reference(NamedTuple):
    """A set point: desired position (rad), velocity (rad/s), acceleration (rad/s²)."""

    position: Pair
    velocity: Pair
    acceleration: Pair


class State(NamedTuple):
    """The arm: position (rad) and velocity (rad/s) of its joints."""

    position: Pair
    velocity: Pair


class Pose(NamedTuple):
    """Cosine of θ1, sine and cosine of θ2, cosine of θ1 + θ2: each is needed many times."""

    cos_1: float
    sin_2: float
    cos_2: float
    cos_12: float


class Clock(NamedTuple):
    """When a controller is called.

    Attributes
    ----------
    step : float
        Time between two calls, s.
    last : bool
        Whether this is the last iteration of the set point.
    single : bool
        Whether stored values are rounded to single precision.
    """

    step: float
    last: bool
    single: bool


@kernel
def stored(value: float, single: bool) -> float:
    """Return `value` as a variable of the run's precision would hold it."""
    if single:
        return float(np.float32(value))
    return value


@kernel
def rounded(value: float, single: bool) -> float:
    """Return `value` in single precision; bound to ``stored`` where all runs are single."""
    # Machine code would go on in single precision without the way back.
    return float(np.float64(np.float32(value)))


@kernel
def kept(value: float, single: bool) -> float:
    """Return `value`; bound to ``stored`` where all runs are double."""
    return value


@kernel
def pose_of(position: Pair) -> Pose:
    """Evaluate the four trigonometric values of a position."""
    return Pose(
        math.cos(position[0]),
        math.sin(position[1]),
        math.cos(position[1]),
        math.cos(position[0] + position[1]),
    )
