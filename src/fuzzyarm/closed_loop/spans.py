"""Intervals of rationals, in which the checker counts: no floats, nothing of the search.

Ends are exact until their denominators grow long; then they are rounded outward to
:data:`BITS` significant bits. Functions are Taylor polynomials with Lagrange's remainder.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import NamedTuple

from fuzzyarm.closed_loop.problem import LoopProofError

__all__ = ["FUNCTIONS", "RationalInterval", "SpanError", "exactly", "hull"]

BITS = 160
"""Significant bits that are left of an end that is rounded."""

LONG = 320
"""Bits of a denominator above which an end is rounded."""

QUARTER = Fraction(15707963267948966, 10**16)
"""Less than π/2, by less than 1e-16."""


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


def _root(x: RationalInterval) -> RationalInterval:
    if x.low < 0:
        raise SpanError("the root of something negative")
    ends = []
    for end in x:
        whole = (end.numerator << (2 * BITS)) // end.denominator
        ends.append(Fraction(math.isqrt(whole), 1 << BITS))
    high = ends[1] + Fraction(2, 1 << BITS) if ends[1] ** 2 != x.high else ends[1]
    return RationalInterval(ends[0], high)


def _series(x: Fraction, first: int, step: int, sign: int) -> RationalInterval:
    """Return Σ signᵏ xⁿ/n!, n = first + k step, with its tail; in parts of 2⁻ᴮᴵᵀˢ."""
    scaled = (x.numerator << BITS) // x.denominator
    total, n = 0, first
    term = scaled if first else 1 << BITS
    # The tail is below twice the first term left out, once |x| is less than half of n.
    while abs(term) > 1 or n < 2 * abs(x):
        total += term
        for k in range(n + 1, n + step + 1):
            term = ((term * scaled) >> BITS) // k
        term, n = term * sign, n + step
    # Each term is off by less than 2 (n + 1) parts that later ones multiply: by e^|x| in all.
    off = 2 * abs(term) + 2 * (n + 2) ** 2 * 3 ** math.ceil(abs(x))
    return RationalInterval(Fraction(total - off, 1 << BITS), Fraction(total + off, 1 << BITS))


def _short(x: Fraction, *, up: bool) -> Fraction:
    """Return a number near by, whose powers stay short."""
    whole = (x.numerator << 80) // x.denominator
    near = Fraction(whole, 1 << 80)
    return near + Fraction(int(up and near != x), 1 << 80)


def _waves(x: RationalInterval, *, is_cosine: bool) -> RationalInterval:
    unit = RationalInterval(Fraction(-1), Fraction(1))
    if x.low == x.high == 0:
        return exactly(Fraction(int(is_cosine)))
    # Beyond ± π the ends say nothing of what is between them.
    if x.size > 2 * QUARTER:
        return unit
    first, turn = (0, (Fraction(0),)) if is_cosine else (1, (QUARTER, -QUARTER))
    ends = [_series(_short(end, up=k == 1), first, 2, -1) for k, end in enumerate(x)]
    whole = hull(*ends)
    low, high = whole
    for top in turn:
        near = Fraction(1, 10**15)
        if x.low - near <= top <= x.high + near:
            low, high = (low, Fraction(1)) if top >= 0 else (Fraction(-1), high)
    slack = Fraction(1, 1 << 78)  # the ends were moved by less than 2⁻⁸⁰, and slopes are at most 1
    return RationalInterval(max(low - slack, unit.low), min(high + slack, unit.high))


def _exponential(x: RationalInterval) -> RationalInterval:
    if x.low == x.high == 0:
        return exactly(Fraction(1))
    if x.size > 64:
        raise SpanError("the exponential of a large number")
    low = _series(_short(x.low, up=False), 0, 1, 1).low
    return RationalInterval(max(low, Fraction(0)), _series(_short(x.high, up=True), 0, 1, 1).high)


def _tanh(x: RationalInterval) -> RationalInterval:
    ends = []
    for end in x:
        if end == 0:
            ends.append(exactly(Fraction(0)))
            continue
        if abs(end) > 30:
            ends.append(RationalInterval(Fraction(-1), Fraction(1)))
            continue
        power = _exponential(exactly(2 * end))
        ends.append(exactly(1).minus(exactly(2).over(power.plus(exactly(1)))))
    return hull(*ends)


def _absolute(x: RationalInterval) -> RationalInterval:
    low = Fraction(0) if x.low <= 0 <= x.high else min(abs(x.low), abs(x.high))
    return RationalInterval(low, x.size)


FUNCTIONS = {
    "sqrt": _root,
    "sin": lambda x: _waves(x, is_cosine=False),
    "cos": lambda x: _waves(x, is_cosine=True),
    "exp": _exponential,
    "tanh": _tanh,
    "absolute": _absolute,
}
"""Of one argument, by the name of the operation."""
