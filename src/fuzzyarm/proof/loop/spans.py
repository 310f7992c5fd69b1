"""Intervals of rationals, in which the checker counts: no floats, nothing of the search.

Ends are exact until their denominators grow long; then they are rounded outward to
:data:`BITS` significant bits. Functions are those of Arb's balls (python-flint).

Source: F. Johansson, "Arb: efficient arbitrary-precision midpoint-radius interval arithmetic",
*IEEE Transactions on Computers* 66, 2017.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import NamedTuple

from flint import arb, ctx, fmpq

from fuzzyarm.proof.claim.problem import LoopProofError

__all__ = [
    "FUNCTIONS",
    "RationalInterval",
    "SpanError",
    "ball",
    "exactly",
    "function",
    "hull",
]

BITS = 160
"""Significant bits that are left of an end that is rounded."""

LONG = 320
"""Bits of a denominator above which an end is rounded."""


class SpanError(LoopProofError):
    """Something has no value, or no bound, in an interval."""


class RationalInterval(NamedTuple):
    """All numbers from `low` to `high`."""

    low: Fraction
    high: Fraction

    @property
    def is_point(self) -> bool:
        """Whether it is one number."""
        return self.low == self.high

    @property
    def middle(self) -> Fraction:
        """Its middle."""
        return (self.low + self.high) / 2

    @property
    def radius(self) -> Fraction:
        """How far its ends are from the middle."""
        return (self.high - self.low) / 2

    @property
    def size(self) -> Fraction:
        """The largest magnitude in it."""
        return max(abs(self.low), abs(self.high))

    def plus(self, other: RationalInterval) -> RationalInterval:
        """Return all sums."""
        return _outward(self.low + other.low, self.high + other.high)

    def minus(self, other: RationalInterval) -> RationalInterval:
        """Return all differences."""
        return _outward(self.low - other.high, self.high - other.low)

    def times(self, other: RationalInterval) -> RationalInterval:
        """Return all products."""
        if self.is_point and other.is_point:
            product = self.low * other.low
            return _outward(product, product)
        ends = [a * b for a in self for b in other]
        return _outward(min(ends), max(ends))

    def over(self, other: RationalInterval) -> RationalInterval:
        """Return all quotients."""
        if other.low <= 0 <= other.high:
            raise SpanError("a division by an interval that contains 0")
        return self.times(_outward(1 / other.high, 1 / other.low))

    def holds(self, other: RationalInterval) -> bool:
        """Tell whether all of another one is in it."""
        return self.low <= other.low and other.high <= self.high


def exactly(value: float | Fraction) -> RationalInterval:
    """Return the interval of one number."""
    if isinstance(value, float) and not math.isfinite(value):
        raise SpanError(f"{value} is not a number")
    number = Fraction(value)
    return RationalInterval(number, number)


def hull(*spans: RationalInterval) -> RationalInterval:
    """Return the smallest interval that holds some."""
    return RationalInterval(min(span.low for span in spans), max(span.high for span in spans))


def _outward(low: Fraction, high: Fraction) -> RationalInterval:
    return RationalInterval(-_up(-low), _up(high))


def _up(x: Fraction) -> Fraction:
    """Return a number that is not less, with a short denominator."""
    if x.denominator.bit_length() <= LONG:
        return x
    shift = BITS + x.denominator.bit_length() - x.numerator.bit_length()
    return Fraction(-((-x.numerator << shift) // x.denominator), 1 << shift) if shift > 0 else x


# ── functions ────────────────────────────────────────────────────────────────────────

LARGE = 64
"""Magnitude of an exponent above which no rational is written down."""

GROWING = frozenset({"exp", "sinh", "cosh"})

RISING = frozenset({"sqrt", "exp", "log", "asin", "atan", "sinh", "tanh"})
"""Functions that lie between their values at the ends, which one ball around both would widen."""

FUNCTIONS = (*RISING, "cosh", "sin", "cos", "tan", "acos", "absolute")
"""Operations of one argument, named as the methods of a ball are."""


def function(name: str, x: RationalInterval) -> RationalInterval:
    """Return bounds of one of :data:`FUNCTIONS`, by Arb's balls; SpanError where it has none."""
    if name == "absolute":
        least = Fraction(0) if x.low <= 0 <= x.high else min(abs(x.low), abs(x.high))
        return RationalInterval(least, x.size)
    if name in GROWING and x.size > LARGE:
        raise SpanError("the exponential of a large number")
    if name in RISING and not x.is_point:
        return RationalInterval(function(name, exactly(x.low)).low,
                                function(name, exactly(x.high)).high)  # fmt: skip
    with ctx.workprec(BITS):
        whole = ball(x.low) if x.is_point else ball(x.low).union(ball(x.high))
        value = getattr(whole, name)()
        if not value.is_finite():
            raise SpanError(f"'{name}' has no value, or no bound, in an interval")
        low, high = (_end(end) for end in (value.lower(), value.upper()))
    if name in ("sin", "cos"):
        low, high = max(low, Fraction(-1)), min(high, Fraction(1))
    return RationalInterval(low, high)


def ball(x: Fraction) -> arb:
    """Return a ball that holds a number."""
    return arb(fmpq(x.numerator, x.denominator))


def _end(x: arb) -> Fraction:
    mantissa, exponent = (int(part) for part in x.man_exp())
    return Fraction(mantissa) * Fraction(2) ** exponent
