"""Results of a proof, and the widening of bounds: shared by pieces and boxes."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties

WIDENED = 1e-12
"""Share of an output's range by which bounds that floats found are widened outward."""

GAP = 1e-8
"""Default share of an output's range to which bounds are sought."""

LIKE_EXPECT = 1e-9
"""Share of an output's range to which ``=``, ``odd`` and sectors hold, as ``expect`` lines do."""

Point = dict[str, float]

TABLE_ERROR = "worst reached at=at_worst pieces way"
"""Properties in JSON of the bounds of a table's error."""


class UnprovableError(FuzzyarmError, ValueError):
    """Nothing can be proved of a rule base or of one statement; the message names why."""


class NothingFiresError(UnprovableError):
    """No rule of the output fires anywhere in the region."""


@json_properties("low high at_low at_high hole pieces way")
class Bounds(NamedTuple):
    """Bounds of an output, its slope or the error of a table.

    Attributes
    ----------
    low, high : float
        The bounds, rounded outward.
    reached_low, reached_high : float
        Attained values, or limits; NaN where nothing was evaluated.
    at_low, at_high : dict of str to float
        Where, to the nearest floats.
    pieces : int
        How many simplices or boxes were looked at.
    way : str
        ``exact`` (rationals), ``widened`` (floats, widened outward) or ``boxes``.
    complete : bool
        Whether the bounds are within the tolerance of what is attained.
    hole : str
        Where the output has no value, or why that is open; empty where it has one everywhere.
    """

    low: float
    high: float
    reached_low: float
    reached_high: float
    at_low: Point
    at_high: Point
    pieces: int
    way: str
    complete: bool
    hole: str = ""

    @property
    def worst(self) -> float:
        """No error of a table is larger."""
        return max(self.high, -self.low)

    @property
    def reached(self) -> float:
        """An error that is reached."""
        return max(self.reached_high, -self.reached_low)

    @property
    def at_worst(self) -> Point:
        """Where an error is farthest from zero."""
        return self.at_high if self.reached_high >= -self.reached_low else self.at_low


class Missing(NamedTuple):
    """A point at which an output has no value of its own.

    `silent` is whether no rule fires there, else it leaves its range; `held` whether it then keeps
    its last value.
    """

    at: dict[str, Fraction]
    reason: str
    silent: bool
    held: bool = False


class Claim(NamedTuple):
    """The answer to whether a supremum is at most a bound.

    `holds` is None where it stays open; `at` is where it fails, as exact numbers.
    """

    holds: bool | None
    at: dict[str, Fraction]
    pieces: int
    exact: bool
