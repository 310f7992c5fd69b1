"""Shared definitions of experiments on the arm: signals, conventions, errors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.symbolic.kernels import kernel

# --- Conventions of a run: precision, the constant for π, timing, the load, the maximum ---
#
# `PLAIN` is today's choice, `STUDY` that of most programs of the study. Either runs all controllers
# alike. The published figures prove that the study used three conventions (for the conventional and
# adaptive controllers, for the lookup tables, and for the fuzzy controllers without tables); a
# reproduced row uses its own.

STUDY_PI = 3.142857
"""The constant for π in the study's single-precision programs."""

SET_POINT_PERIOD = 0.003
"""Time between two set points in the study, s."""

ITERATIONS = 5
"""Control iterations per set point in the study."""


class Timing(NamedTuple):
    """The control period, and the duration of a set point.

    Attributes
    ----------
    set_point : float
        Time between two set points, s.
    every : int
        Control periods in it.
    """

    set_point: float = SET_POINT_PERIOD
    every: int = ITERATIONS

    @property
    def period(self) -> float:
        """Control period, s."""
        return self.set_point / self.every


STUDY_TIMING = Timing()
"""Default for laws, which have no timing."""

Precision = Literal["float32", "float64"]


@dataclass(frozen=True)
class Conventions:
    """The conventions of a run.

    Parameters
    ----------
    name : str
        ``plain`` or ``study``.
    precision : {"float64", "float32"}
        Precision of stored states, references and gains; expressions are evaluated in double
        precision and rounded when stored.
    pi : float
        For conversions between degrees and radians.
    whole_set_points : bool
        Whether the last set point of a segment gets all its iterations. In the study it gets one
        and no sample, because time advances when a set point is produced.
    load_in_hold : bool
        Whether a load present at the start of a hold stays on.
    maximum : {"magnitude", "positive"}
        Error of largest magnitude, with its sign; or the most positive error.
    """

    name: str
    precision: Precision
    pi: float
    whole_set_points: bool
    load_in_hold: bool
    maximum: Literal["magnitude", "positive"]

    def __post_init__(self) -> None:
        if not 3.0 <= self.pi <= 3.5:
            raise ArmError(f"{self.pi} for π is out of range", name="pi", value=self.pi)

    @property
    def single(self) -> bool:
        """Whether stored values are rounded to single precision."""
        return self.precision == "float32"


PLAIN = Conventions("plain", "float64", math.pi, True, True, "magnitude")
STUDY_CONVENTIONAL = Conventions("study", "float32", STUDY_PI, False, True, "positive")
STUDY_TABLES = Conventions("study", "float32", STUDY_PI, False, True, "magnitude")
STUDY_DIRECT = Conventions("study", "float64", math.pi, False, False, "magnitude")
STUDY = STUDY_TABLES
"""Common to all controllers: single precision, 3.142857 for π, the load on during the hold."""


class RunArithmetic(NamedTuple):
    """The arithmetic of the programs of a run.

    Attributes
    ----------
    single : bool
        Whether stored values are rounded to single precision.
    pi : float
        The constant for π; some gains are fractions of it.
    compiled : bool
        Whether they run as machine code; addresses of callees differ then.
    """

    single: bool = False
    pi: float = math.pi
    compiled: bool = False

    def hold(self, value: float) -> float:
        """Round a gain for storage."""
        return float(np.float32(value)) if self.single else float(value)


# --- Errors of an experiment on the arm ---


class ArmError(FuzzyarmError, ValueError):
    """An angle, a time, a schedule or a parameter is out of range.

    Parameters
    ----------
    message : str
        One sentence with the offending value in it.
    name : str, optional
        The quantity at fault.
    value : object, optional
        Its value.
    hint : str, optional
        A valid alternative.
    """

    def __init__(
        self, message: str, *, name: str = "", value: object = None, hint: str = ""
    ) -> None:
        super().__init__(message, hint=hint)
        self.name = name
        self.value = value


# --- Signals between reference, controller and arm ---
#
# Named tuples of pairs, one number per joint: kernels hold them in registers, and a controller in
# plain Python reads `reference.position[0]`.

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
    """Cosine of θ1, sine and cosine of θ2, cosine of θ1 + θ2: shared by many expressions."""

    cos_1: float
    sin_2: float
    cos_2: float
    cos_12: float


class Clock(NamedTuple):
    """The time base of a controller's call.

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


class Observation(NamedTuple):
    """The observation of a control law in one control step."""

    reference: Reference
    state: State
    pose: Pose
    clock: Clock


# The head of the observation of a law or a controller as text.
PERIOD, LAST, SINGLE = range(3)
CLOCK = 3
"""Control period, s; 1 in the last period of a set point; 1 if stored values are rounded to single
precision."""


@kernel
def stored(value: float, single: bool) -> float:
    """Round `value` as a variable in the run's precision."""
    # Values inside an expression stay double, as in the study's programs; kernels call this where
    # those stored a variable.
    if single:
        return float(np.float32(value))
    return value


@kernel
def stored_single(value: float, single: bool) -> float:
    """Return `value` in single precision; bound to ``stored`` if all runs are single."""
    # The cast back forces the rounding: machine code would otherwise continue in single precision.
    return float(np.float64(np.float32(value)))


@kernel
def stored_double(value: float, single: bool) -> float:
    """Return `value`; bound to ``stored`` if all runs are double."""
    return value


@kernel
def pose_of(position: Pair) -> Pose:
    """Evaluate the four trigonometric values of a position."""
    # Once in a control step, shared by plant, model and regressor: the rest is arithmetic. Gravity
    # takes cosines, because angles are measured from the horizontal.
    return Pose(
        math.cos(position[0]),
        math.sin(position[1]),
        math.cos(position[1]),
        math.cos(position[0] + position[1]),
    )
