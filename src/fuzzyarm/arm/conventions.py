"""How a run counts: precision, the constant for π, timing, the load, the maximum.

``PLAIN`` is what one would choose today. The three study conventions are those that
the published figures prove (one for the conventional and adaptive controllers, one
for the lookup tables, one for the fuzzy controllers without tables).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

STUDY_PI = 3.142857
"""The constant that the study's single-precision programs used for π."""

SET_POINT_PERIOD = 0.003
"""Time between two set points, s."""

ITERATIONS = 5
"""Control iterations per set point."""

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

    @property
    def single(self) -> bool:
        """Whether stored values are rounded to single precision."""
        return self.precision == "float32"


PLAIN = Conventions("plain", "float64", math.pi, True, True, "magnitude")
STUDY_CONVENTIONAL = Conventions("study", "float32", STUDY_PI, False, True, "positive")
STUDY_TABLES = Conventions("study", "float32", STUDY_PI, False, True, "magnitude")
STUDY_DIRECT = Conventions("study", "float64", math.pi, False, False, "magnitude")
