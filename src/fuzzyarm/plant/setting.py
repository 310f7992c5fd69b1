"""What an experiment on the arm agrees on: signals, conventions, faults."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.symbolic.kernels import kernel

# --- How a run counts: precision, the constant for π, timing, the load, the maximum ---
#
# `PLAIN` is what one would choose today, and `STUDY` what most of the study's programs did. With
# either all controllers run alike. The published figures prove that the study counted in three
# ways (one for the conventional and adaptive controllers, one for the lookup tables, one for the
# fuzzy controllers without tables); a row that is reproduced runs as it did.

STUDY_PI = 3.142857
"""The constant that the study's single-precision programs used for π."""

SET_POINT_PERIOD = 0.003
"""Time between two set points in the study, s."""

ITERATIONS = 5
"""Control iterations per set point in the study."""


class Timing(NamedTuple):
    """How often a controller runs, and how long a set point lasts.

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
"""Of laws, which have none of their own."""

Precision = Literal["float32", "float64"]


@dataclass(frozen=True)
class Conventions:
    """How a run counts.

    Parameters
    ----------
    name : str
        ``plain`` or ``study``.
    precision : {"float64", "float32"}
        In which state, references and gains are kept; expressions are evaluated in
        double precision and rounded when stored.
    pi : float
        For degrees to radians and back.
    whole_set_points : bool
        Whether the last set point of a segment gets all its iterations. In the study
        it gets one and no sample, because time is advanced when a set point is made.
    load_in_hold : bool
        Whether a load that is on when a hold begins stays on.
    maximum : {"magnitude", "positive"}
        Error of largest magnitude, sign kept; or the most positive error.
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
"""The same for all controllers: single precision, 3.142857 for π, the load on in the hold."""


class RunArithmetic(NamedTuple):
    """How the programs of a run count.

    Attributes
    ----------
    single : bool
        Whether stored values are rounded to single precision.
    pi : float
        The constant for π, of which some gains are fractions.
    compiled : bool
        Whether they run as machine code; addresses of what they call are different then.
    """

    single: bool = False
    pi: float = math.pi
    compiled: bool = False

    def hold(self, value: float) -> float:
        """Round as a stored gain is rounded."""
        return float(np.float32(value)) if self.single else float(value)


# --- What can be wrong with an experiment on the arm ---


class ArmError(FuzzyarmError, ValueError):
    """An angle, a time, a schedule or a parameter is out of range.

    Parameters
    ----------
    message : str
        One sentence with the offending value in it.
    name : str, optional
        The quantity at fault.
    value : object, optional
        What was given for it.
    hint : str, optional
        What would be right.
    """

    def __init__(
        self, message: str, *, name: str = "", value: object = None, hint: str = ""
    ) -> None:
        super().__init__(message, hint=hint)
        self.name = name
        self.value = value


# --- What goes over the wires between reference, controller and arm ---
#
# Named tuples of pairs, one number per joint: kernels take them in registers, and a
# controller in plain Python reads `reference.position[0]`.

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


class Moment(NamedTuple):
    """What a control law is told at each control step."""

    reference: Reference
    state: State
    pose: Pose
    clock: Clock


# What a law and a controller as text find first in their array.
PERIOD, LAST, SINGLE = range(3)
CLOCK = 3
"""Control period, s; whether this is the last period of a set point; whether what is stored is
rounded to single precision."""


@kernel
def stored(value: float, single: bool) -> float:
    """Return `value` as a variable of the run's precision would hold it."""
    # What stands inside one expression stays double, as in the study's programs; kernels call
    # this where a variable of those held a value.
    if single:
        return float(np.float32(value))
    return value


@kernel
def stored_single(value: float, single: bool) -> float:
    """Return `value` in single precision; bound to ``stored`` where all runs are single."""
    # Machine code would go on in single precision without the way back.
    return float(np.float64(np.float32(value)))


@kernel
def stored_double(value: float, single: bool) -> float:
    """Return `value`; bound to ``stored`` where all runs are double."""
    return value


@kernel
def pose_of(position: Pair) -> Pose:
    """Evaluate the four trigonometric values of a position."""
    # Once a control step, for plant, model and regressor alike: all else in them is arithmetic.
    # Gravity takes cosines, for angles are from the horizontal.
    return Pose(
        math.cos(position[0]),
        math.sin(position[1]),
        math.cos(position[1]),
        math.cos(position[0] + position[1]),
    )
