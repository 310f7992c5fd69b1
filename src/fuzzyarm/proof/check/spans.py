"""Many intervals at once: arrays of floats, rounded outward, with the methods of a ball.

So the slopes of a plant (:mod:`.slopes`) and its motion over a period (:mod:`.motion`) serve one
box or thousands. A result of IEEE 754 is off by less than the distance to the next float, to which
an end is rounded. Functions are Arb's, end by end. A comparison holds if it certainly holds for all
intervals.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from numbers import Rational
from typing import Any

import numpy as np
from flint import arb, fmpq
from numpy.typing import NDArray

Vector = NDArray[np.float64]


# Ends move outward by at least one float, in 40 % of the time of `nextafter`; an end that has
# overflowed inward becomes NaN.


def _below(x: Any) -> Vector:
    return np.asarray(x - (np.abs(x) * 2.0**-52 + 1e-300))


def _above(x: Any) -> Vector:
    return np.asarray(x + (np.abs(x) * 2.0**-52 + 1e-300))


@lru_cache(maxsize=4096)
def exact(value: float | Rational) -> fmpq:
    """Return a float or a rational as an exact rational."""
    number = Fraction(value)
    return fmpq(number.numerator, number.denominator)


def _ends(x: Any) -> tuple[float, float]:
    """Return floats on both sides of a ball or a rational; the same float twice if it is one."""
    if not isinstance(x, arb):
        return _float_of(fmpq(x), -math.inf), _float_of(fmpq(x), math.inf)
    if not x.is_finite():
        return -math.inf, math.inf
    return _float_of(x.lower(), -math.inf), _float_of(x.upper(), math.inf)


@lru_cache(maxsize=4096)
def _of_rational(x: fmpq) -> Spans:
    return Spans(*_ends(x))


def _float_of(x: Any, way: float) -> float:
    """Return the float equal to a number, or its neighbour on one side."""
    near = float(x)
    if not math.isfinite(near):
        return way
    same = x == near if isinstance(x, arb) else exact(near) == x
    return near if same else math.nextafter(near, way)


class Spans:
    """An array of intervals, with the methods of a ball.

    Parameters
    ----------
    low, high : ndarray
        Of one shape.
    """

    __slots__ = ("high", "low")
    __array_ufunc__ = None

    def __init__(self, low: Any, high: Any) -> None:
        self.low, self.high = np.asarray(low, float), np.asarray(high, float)

    @classmethod
    def of(cls, x: Any) -> Spans:
        """Return a number of any kind as intervals."""
        if isinstance(x, Spans):
            return x
        if isinstance(x, float) or (isinstance(x, int) and abs(x) < 2**53):
            return cls(float(x), float(x))
        return _of_rational(x) if isinstance(x, fmpq) else cls(*_ends(x))

    def __getitem__(self, index: Any) -> Spans:
        if self.low.ndim == 0:
            return self
        return Spans(self.low[index], self.high[index])

    def __neg__(self) -> Spans:
        return Spans(-self.high, -self.low)

    def __add__(self, other: Any) -> Spans:
        other = Spans.of(other)
        return Spans(_below(self.low + other.low), _above(self.high + other.high))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Spans:
        return self + -Spans.of(other)

    def __rsub__(self, other: Any) -> Spans:
        found: Spans = -self + other
        return found

    def __mul__(self, other: Any) -> Spans:
        other = Spans.of(other)
        for x, number in ((self, other), (other, self)):
            if number.low.ndim == 0 and number.low == number.high:
                ends = (x.low, x.high) if number.low >= 0.0 else (x.high, x.low)
                return Spans(_below(ends[0] * number.low), _above(ends[1] * number.low))
        return self._by_ends(operator.mul, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Spans:
        other = Spans.of(other)
        around = (other.low <= 0.0) & (other.high >= 0.0)
        if np.any(around):  # unbounded
            other = Spans(*(np.where(around, np.nan, end) for end in (other.low, other.high)))
        return self._by_ends(operator.truediv, other)

    def __rtruediv__(self, other: Any) -> Spans:
        found: Spans = Spans.of(other) / self
        return found

    def _by_ends(self, how: Callable[[Any, Any], Any], other: Spans) -> Spans:
        """Return the range of a function monotone in each argument: its extremes are at ends."""
        a, b, c, d = (how(x, y) for x in (self.low, self.high) for y in (other.low, other.high))
        low = np.minimum(np.minimum(a, b), np.minimum(c, d))
        return Spans(_below(low), _above(np.maximum(np.maximum(a, b), np.maximum(c, d))))

    # --- comparisons: of all ---

    def __lt__(self, other: Any) -> bool:
        return bool(np.all(self.high < Spans.of(other).low))

    def __le__(self, other: Any) -> bool:
        return bool(np.all(self.high <= Spans.of(other).low))

    def __gt__(self, other: Any) -> bool:
        return bool(np.all(self.low > Spans.of(other).high))

    def __ge__(self, other: Any) -> bool:
        return bool(np.all(self.low >= Spans.of(other).high))

    def __eq__(self, other: object) -> bool:
        second = Spans.of(other)
        return bool(np.all((self.low == self.high) & (second.low == second.high)
                           & (self.low == second.low)))  # fmt: skip

    __hash__ = None  # type: ignore[assignment]

    # --- as a ball ---

    def lower(self) -> Spans:
        """Return the lower ends."""
        return Spans(self.low, self.low)

    def upper(self) -> Spans:
        """Return the upper ends."""
        return Spans(self.high, self.high)

    def mid(self) -> Spans:
        """Return a number inside each."""
        middle = np.clip(0.5 * self.low + 0.5 * self.high, self.low, self.high)
        return Spans(middle, middle)

    def rad(self) -> Spans:
        """Return the largest distance of the ends from :meth:`mid`."""
        middle = self.mid().low
        far = _above(np.maximum(self.high - middle, middle - self.low))
        far = np.where(self.low == self.high, 0.0, far)
        return Spans(far, far)

    def abs_upper(self) -> Spans:
        """Return the largest magnitudes."""
        far = np.maximum(np.abs(self.low), np.abs(self.high))
        return Spans(far, far)

    def abs_lower(self) -> Spans:
        """Return the smallest magnitudes."""
        near = np.minimum(np.abs(self.low), np.abs(self.high))
        near = np.where((self.low <= 0.0) & (self.high >= 0.0), 0.0, near)
        return Spans(near, near)

    def side(self) -> Spans:
        """Return their signs, -1 .. 1 if they contain 0: the slopes of their magnitudes."""
        return Spans(np.where(self.low > 0.0, 1.0, -1.0), np.where(self.high <= 0.0, -1.0, 1.0))

    def is_exact(self) -> bool:
        """Return whether all are points."""
        return bool(np.all(self.low == self.high))

    def is_finite(self) -> bool:
        """Return whether all are bounded."""
        return bool(np.all(np.isfinite(self.low) & np.isfinite(self.high)))

    def union(self, other: Any) -> Spans:
        """Return the hull of both."""
        other = Spans.of(other)
        return Spans(np.minimum(self.low, other.low), np.maximum(self.high, other.high))

    def min(self, other: Any) -> Spans:
        """Return the smaller of two."""
        other = Spans.of(other)
        return Spans(np.minimum(self.low, other.low), np.minimum(self.high, other.high))

    def max(self, other: Any) -> Spans:
        """Return the larger of two."""
        other = Spans.of(other)
        return Spans(np.maximum(self.low, other.low), np.maximum(self.high, other.high))

    def chosen(self, which: Any, other: Any) -> Spans:
        """Return these for some sets, and another number for the others."""
        other = Spans.of(other)
        return Spans(np.where(which, self.low, other.low), np.where(which, self.high, other.high))

    def __getattr__(self, name: str) -> Callable[[], Spans]:
        if name not in FUNCTIONS:
            raise AttributeError(name)
        return lambda: self._function(name)

    def _function(self, name: str) -> Spans:
        """Return a function: roots by IEEE 754, sine and cosine of small arguments by Taylor.

        Others are Arb's, interval by interval; NaN without a value.
        """
        if name == "sqrt":
            low, high = np.sqrt(self.low), np.sqrt(self.high)
            return Spans(np.maximum(_below(low), 0.0), _above(high))
        if name in WAVES:
            small = self.abs_upper().low <= WIDE
            if small.all():
                return self._wave(name)
            if small.any():
                nothing = Spans(np.zeros_like(self.low), np.zeros_like(self.high))
                others = Spans(self.low[~small], self.high[~small])._by_arb(name)
                found = self.chosen(small, nothing)._wave(name)
                found.low[~small], found.high[~small] = others.low, others.high
                return found
        return self._by_arb(name)

    def _by_arb(self, name: str) -> Spans:
        """Return a function by Arb, once for each distinct interval."""
        pairs, where = np.unique(
            np.stack([self.low.ravel(), self.high.ravel()], axis=1), axis=0, return_inverse=True
        )
        found = np.full_like(pairs, np.nan)
        for row, (low, high) in enumerate(pairs):
            if math.isfinite(high - low):
                value = getattr(arb(low).union(arb(high)), name)()
                found[row] = _ends(value) if value.is_finite() else np.nan
        ends = found[where.ravel()].reshape(*self.low.shape, 2)
        return Spans(ends[..., 0], ends[..., 1])

    def _wave(self, name: str) -> Spans:
        """Return sine or cosine: between the values at the ends, or to a maximum or minimum."""
        first, last = (_taylor(name, end) for end in (self.low, self.high))
        low, high = np.minimum(first, last) - OFF, np.maximum(first, last) + OFF
        for position, value in WAVES[name]:  # rounded by less than 1e-15
            there = (self.low <= position + 1e-15) & (self.high >= position - 1e-15)
            low = np.where(there & (value < 0), -1.0, low)
            high = np.where(there & (value > 0), 1.0, high)
        return Spans(np.maximum(low, -1.0), np.minimum(high, 1.0))


FUNCTIONS = frozenset({
    "sqrt", "exp", "log", "asin", "acos", "atan", "sinh", "cosh", "tanh", "sin", "cos", "tan",
})  # fmt: skip
"""Functions of one argument, by Arb's name."""

WIDE = 4.0
"""Largest argument of the Taylor polynomials of sine and cosine."""

TERMS = 14

WAVES = {
    "sin": ((-0.5 * math.pi, -1), (0.5 * math.pi, 1)),
    "cos": ((-math.pi, -1), (0.0, 1), (math.pi, -1)),
}
"""Positions of the extremes up to there, with their signs."""

OFF = 2.0**-41
"""Largest error of a polynomial: the magnitudes of terms add up to cosh 4 < 28, each has fewer than
60 roundings of 2⁻⁵³, and the remainder is below 4²⁸/28! < 2.4e-13."""


def _taylor(name: str, x: Vector) -> Vector:
    """Return the Taylor polynomial of sine or cosine, with 14 terms."""
    square, first = x * x, int(name == "sin")
    total = np.zeros_like(x)
    for k in reversed(range(TERMS)):
        total = 1.0 / math.factorial(2 * k + first) - square * total
    return np.asarray(total * x if first else total)


class Matrices:
    """A matrix of intervals for each set, by midpoints and radii.

    Parameters
    ----------
    near, far : ndarray, shape (..., rows, columns)
        Midpoints and radii.
    """

    def __init__(self, near: Vector, far: Vector) -> None:
        self.near, self.far = near, far

    @classmethod
    def of(cls, rows: Sequence[Sequence[Any]]) -> Matrices:
        """Return matrices with the given entries."""
        entries = [[Spans.of(x) for x in row] for row in rows]
        shape = np.broadcast_shapes(*(x.low.shape for row in entries for x in row))
        low, high = np.empty((2, *shape, len(rows), len(rows[0])))
        for i, row in enumerate(entries):
            for j, x in enumerate(row):
                low[..., i, j], high[..., i, j] = x.low, x.high
        spans = Spans(low, high)
        return cls(spans.mid().low, spans.rad().low)

    @property
    def rows(self) -> list[list[Spans]]:
        """The entries."""
        low, high = _below(self.near - self.far), _above(self.near + self.far)
        return [[Spans(low[..., i, j], high[..., i, j]) for j in range(low.shape[-1])]
                for i in range(low.shape[-2])]  # fmt: skip

    def _rounded(self, near: Vector, far: Vector, size: Vector, count: int) -> Matrices:
        """Add the error of `count` roundings, relative to a sum of magnitudes."""
        off = count * 2.0**-52 * size + np.where(size > 0.0, 1e-300, 0.0)
        return Matrices(near, (far + off) * (1.0 + 2.0**-40))

    def __matmul__(self, other: Matrices) -> Matrices:
        size, more = np.abs(self.near) + self.far, np.abs(other.near) + other.far
        far = np.abs(self.near) @ other.far + self.far @ more
        count = other.near.shape[-2] + 4
        return self._rounded(self.near @ other.near, far, size @ more, count)

    def __add__(self, other: Matrices) -> Matrices:
        near = self.near + other.near
        return self._rounded(near, self.far + other.far, np.abs(near), 2)

    def divided(self, number: int) -> Matrices:
        """Return the quotient by a number."""
        near = self.near / number
        return self._rounded(near, self.far / number, np.abs(near) + self.far, 3)
