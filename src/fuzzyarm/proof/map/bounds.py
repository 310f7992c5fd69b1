"""Results of a proof, and the widening of bounds, for pieces and boxes alike."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties

WIDENED = 1e-12
"""Outward widening of bounds from floats, as a share of the output's range."""

GAP = 1e-8
"""Default tolerance of bounds, as a share of the output's range."""

LIKE_EXPECT = 1e-9
"""Tolerance of ``=``, ``odd`` and sectors, as of ``expect`` lines: a share of the range."""

Point = dict[str, float]

TABLE_ERROR = "worst reached at=at_worst pieces way"
"""JSON properties of the bounds of a table's error."""


class UnprovableError(FuzzyarmError, ValueError):
    """Nothing can be proved about a rule base or a statement; the message has the reason."""


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
        Points of the attained values, as nearest floats.
    pieces : int
        Number of simplices or boxes examined.
    way : str
        ``exact`` (rationals), ``widened`` (floats, widened outward) or ``boxes``.
    complete : bool
        Whether the bounds are within the tolerance of attained values.
    hole : str
        Where the output has no value, or why that is open; empty if it has one everywhere.
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
        """Upper bound of the error's magnitude."""
        return max(self.high, -self.low)

    @property
    def reached(self) -> float:
        """Largest attained magnitude of the error."""
        return max(self.reached_high, -self.reached_low)

    @property
    def at_worst(self) -> Point:
        """Point of the largest attained error."""
        return self.at_high if self.reached_high >= -self.reached_low else self.at_low


class Missing(NamedTuple):
    """A point at which an output has no value of its own.

    `no_rule`: whether no rule fires there; else the output leaves its range. `held`: it then keeps
    its last value.
    """

    at: dict[str, Fraction]
    reason: str
    no_rule: bool
    held: bool = False


class Claim(NamedTuple):
    """Whether a supremum is at most a bound.

    `holds` is None if undecided; `at` is a point of failure, as exact numbers.
    """

    holds: bool | None
    at: dict[str, Fraction]
    pieces: int
    exact: bool
