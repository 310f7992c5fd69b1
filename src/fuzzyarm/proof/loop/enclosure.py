r"""Intervals over arrays of floats, rounded outward; functions and matrix exponential of them.

An operation of IEEE 754 returns the float nearest to the true result, so the next float outward
bounds the true result. Functions of a C library promise no such thing. Here sine, cosine and the
exponential are Taylor polynomials of a reduced argument, with remainder and rounding bounded by
constants below; the others follow from these three. NumPy's own functions only provide guesses,
which the enclosed ones correct.

The matrix exponential uses scaling and squaring, with a Taylor series whose tail is bounded by a
geometric one, all in intervals.

Sources: R. E. Moore, R. B. Kearfott and M. J. Cloud, *Introduction to Interval Analysis*, SIAM
2009; N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd edition, SIAM 2002,
section 5.1 (Horner's rule) and *Functions of Matrices*, SIAM 2008, section 10.3.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError

Vector: TypeAlias = NDArray[np.float64]


class EnclosureError(FuzzyarmError, ArithmeticError):
    """A function has no value, or no bound, somewhere in an interval."""


def _down(values: Vector) -> Vector:
    return np.asarray(np.nextafter(values, -np.inf))


def _up(values: Vector) -> Vector:
    return np.asarray(np.nextafter(values, np.inf))


def outward(low: Any, high: Any) -> Intervals:
    """Return intervals with the next floats outward as ends."""
    return Intervals(_down(np.asarray(low, float)), _up(np.asarray(high, float)))


@dataclass(frozen=True, eq=False)
class Intervals:
    """An array of intervals. The results of operations contain all true results.

    Examples
    --------
    >>> tenth = outward(0.1, 0.1)
    >>> found = tenth + tenth + tenth
    >>> bool(found.low < 0.3 < found.high)
    True
    """

    low: Vector  # low, high: of the same shape, `low` nowhere above `high`
    high: Vector

    @classmethod
    def at(cls, values: Any) -> Intervals:
        """Return point intervals."""
        values = np.asarray(values, float)
        return cls(values, values)

    @classmethod
    def between(cls, low: Any, high: Any) -> Intervals:
        """Return intervals from their ends; EnclosureError if two ends are out of order or NaN."""
        low, high = np.broadcast_arrays(np.asarray(low, float), np.asarray(high, float))
        if not np.all(low <= high):
            raise EnclosureError("an interval ends before it begins, or is not a number")
        return cls(low, high)

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the array."""
        return self.low.shape

    @property
    def middle(self) -> Vector:
        """A float inside each."""
        return np.asarray(np.clip(0.5 * self.low + 0.5 * self.high, self.low, self.high))

    @property
    def radius(self) -> Vector:
        """The largest distance of the ends from :attr:`middle`, rounded up."""
        middle = self.middle
        values = np.maximum(self.high - middle, middle - self.low)
        return np.asarray(np.where(self.low == self.high, 0.0, _up(values)))

    @property
    def size(self) -> Vector:
        """The largest magnitude in each."""
        return np.asarray(np.maximum(np.abs(self.low), np.abs(self.high)))

    def __getitem__(self, index: Any) -> Intervals:
        return Intervals(np.asarray(self.low[index]), np.asarray(self.high[index]))

    def reshape(self, *shape: int) -> Intervals:
        """Return the same intervals in another shape."""
        return Intervals(self.low.reshape(*shape), self.high.reshape(*shape))

    def holds(self, values: Any) -> NDArray[np.bool_]:
        """Return which intervals contain a float, or the whole of another interval."""
        other = values if isinstance(values, Intervals) else Intervals.at(values)
        return np.asarray((self.low <= other.low) & (other.high <= self.high))

    def hull(self, other: Intervals) -> Intervals:
        """Return the smallest intervals that contain both."""
        return Intervals(np.minimum(self.low, other.low), np.maximum(self.high, other.high))

    def meet(self, other: Intervals) -> Intervals:
        """Return the intersection; EnclosureError if it is empty."""
        return Intervals.between(np.maximum(self.low, other.low), np.minimum(self.high, other.high))

    def __neg__(self) -> Intervals:
        return Intervals(-self.high, -self.low)

    def __add__(self, other: Intervals | float) -> Intervals:
        other = _intervals(other)
        return outward(self.low + other.low, self.high + other.high)

    __radd__ = __add__

    def __sub__(self, other: Intervals | float) -> Intervals:
        other = _intervals(other)
        return outward(self.low - other.high, self.high - other.low)

    def __rsub__(self, other: Intervals | float) -> Intervals:
        return _intervals(other) - self

    def __mul__(self, other: Intervals | float) -> Intervals:
        other = _intervals(other)
        ends = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        return outward(np.minimum.reduce(ends), np.maximum.reduce(ends))

    __rmul__ = __mul__

    def __truediv__(self, other: Intervals | float) -> Intervals:
        other = _intervals(other)
        if np.any((other.low <= 0.0) & (other.high >= 0.0)):
            raise EnclosureError("a division by an interval that contains 0")
        ends = [a / b for a in (self.low, self.high) for b in (other.low, other.high)]
        return outward(np.minimum.reduce(ends), np.maximum.reduce(ends))

    def __rtruediv__(self, other: Intervals | float) -> Intervals:
        return _intervals(other) / self

    def squared(self) -> Intervals:
        """Return the squares, never negative."""
        low, high = absolute(self).low, absolute(self).high
        return Intervals(np.maximum(_down(low * low), 0.0), _up(high * high))


def _intervals(value: Intervals | float) -> Intervals:
    return value if isinstance(value, Intervals) else Intervals.at(value)


def _widened(values: Vector, error: Vector | float) -> Intervals:
    """Return the intervals of a given radius around floats."""
    return outward(values - error, values + error)


def absolute(x: Intervals) -> Intervals:
    """Return the magnitudes."""
    across = (x.low < 0.0) & (x.high > 0.0)
    low = np.where(across, 0.0, np.minimum(np.abs(x.low), np.abs(x.high)))
    return Intervals(np.asarray(low), x.size)


def square_root(x: Intervals) -> Intervals:
    """Return the roots; EnclosureError if an interval has negative values."""
    if np.any(x.low < 0.0):
        raise EnclosureError("the root of an interval that contains negative numbers")
    return Intervals(np.maximum(_down(np.sqrt(x.low)), 0.0), _up(np.sqrt(x.high)))


# ── sine, cosine, exponential at floats ──────────────────────────────────────────────

# π/2 and ln 2 as a float of few bits, with exact integer multiples, and the remainder.
HALF_PI = 1.57079632673412561417e00, 6.07710050650619224932e-11
LOG_2 = 6.93147180369123816490e-01, 1.90821492927058770002e-10

MOST_TURNS = 2.0**19
"""Most quarter turns of a reduced argument; beyond, sine and cosine are [-1, 1]."""

OF_SINE = 6e-15
r"""Largest error of sine and cosine.

The reduced argument r is within 0.786 and within 3e-16 of the true one: two roundings of numbers
below 1, one of the product with the remainder of π/2, and that remainder itself to 7e-27 of each
quarter turn. The Taylor polynomials end with r¹⁷ and r¹⁶; the tail is below 0.79¹⁸/18! < 3e-18.
Horner's rule over nine coefficients takes 3 roundings for each (r² is rounded too), an error of
less than 28 · 2⁻⁵³/(1 − 28 · 2⁻⁵³) · sinh or cosh 0.79 < 4.2e-15 (Higham, (5.3)).
"""

OF_EXPONENTIAL = 1.1e-14
r"""Largest relative error of the exponential.

|r| ≤ 0.348, to 2e-16; the tail from r¹⁴ on is below 1e-17; fourteen coefficients with two
roundings each: 29 · 2⁻⁵³ · e^0.35 < 4.6e-15, over e^-0.35 < 0.71: 6.6e-15.
"""


def _horner(coefficients: list[float], x: Vector) -> Vector:
    total = np.full_like(x, coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        total = total * x + coefficient
    return total


_OF_SINE = [(-1.0) ** k / math.factorial(2 * k + 1) for k in range(9)]
_OF_COSINE = [(-1.0) ** k / math.factorial(2 * k) for k in range(9)]
_OF_EXPONENTIAL = [1.0 / math.factorial(k) for k in range(14)]


def _waves(x: Vector) -> tuple[Vector, Vector]:
    """Return sine and cosine of floats, to :data:`OF_SINE`; 0 beyond the most turns."""
    turns = np.rint(x * (2.0 / math.pi))
    small = np.abs(turns) <= MOST_TURNS
    turns = np.where(small, turns, 0.0)
    r = np.where(small, (x - turns * HALF_PI[0]) - turns * HALF_PI[1], 0.0)
    square = r * r
    s, c = r * _horner(_OF_SINE, square), _horner(_OF_COSINE, square)
    quarter = turns.astype(np.int64) % 4
    quarters = [(s, c), (c, -s), (-s, -c), (-c, s)]
    sines = np.select([quarter == k for k in range(4)], [pair[0] for pair in quarters])
    cosines = np.select([quarter == k for k in range(4)], [pair[1] for pair in quarters])
    return sines, cosines


def _is_far(x: Vector) -> NDArray[np.bool_]:
    return np.asarray(~(np.abs(x) < MOST_TURNS * 1.5))


def _exponentials(x: Vector) -> tuple[Vector, Vector]:
    """Return the exponentials of floats and their errors."""
    clipped = np.clip(x, -740.0, 700.0)
    powers = np.rint(clipped / (LOG_2[0] + LOG_2[1]))
    r = (clipped - powers * LOG_2[0]) - powers * LOG_2[1]
    # In two steps: a single one may leave the range of a float though the result does not.
    first = np.floor(0.5 * powers).astype(np.int64)
    power = np.ldexp(np.ldexp(_horner(_OF_EXPONENTIAL, r), first), powers.astype(np.int64) - first)
    return power, OF_EXPONENTIAL * power + 1e-300


def exponential(x: Intervals) -> Intervals:
    """Return e to the power of intervals; infinite above 700."""
    low, low_error = _exponentials(x.low)
    high, high_error = _exponentials(x.high)
    ends = _widened(low, low_error).low, _widened(high, high_error).high
    low = np.where(x.low < -740.0, 0.0, np.maximum(ends[0], 0.0))
    return Intervals(low, np.where(x.high > 700.0, np.inf, ends[1]))


def waves(x: Intervals) -> tuple[Intervals, Intervals]:
    """Return the sines and the cosines."""
    low = _waves(x.low)
    high = low if x.low is x.high else _waves(x.high)
    return _wave(x, low[0], high[0], 0.5 * math.pi), _wave(x, low[1], high[1], 0.0)


def _wave(x: Intervals, at_low: Vector, at_high: Vector, top: float) -> Intervals:
    """Return a wave from its values at both ends: 1 at `top` and at each full turn from it."""
    low = _down(np.minimum(at_low, at_high) - OF_SINE)
    high = _up(np.maximum(at_low, at_high) + OF_SINE)
    if x.low is not x.high:
        # The interval is slightly widened, to include a turning point at its very edge.
        slack = 1e-9 * (1.0 + x.size)
        for turn, is_top in ((top, True), (top + math.pi, False)):
            nearest = np.ceil((x.low - slack - turn) / (2.0 * math.pi))
            inside = turn + 2.0 * math.pi * nearest <= x.high + slack
            if is_top:
                high = np.where(inside, 1.0, high)
            else:
                low = np.where(inside, -1.0, low)
    everywhere = _is_far(x.low) | _is_far(x.high)
    return Intervals(
        np.where(everywhere, -1.0, np.maximum(low, -1.0)),
        np.where(everywhere, 1.0, np.minimum(high, 1.0)),
    )


def sine(x: Intervals) -> Intervals:
    """Return the sines."""
    return waves(x)[0]


def cosine(x: Intervals) -> Intervals:
    """Return the cosines."""
    return waves(x)[1]


def tangent(x: Intervals) -> Intervals:
    """Return the tangents; EnclosureError where a pole may lie in an interval."""
    if np.any(x.high - x.low > 3.0) or np.any(absolute(cosine(x)).low <= 0.0):
        raise EnclosureError("the tangent of an interval that contains a pole")
    ends = [sine(end) / cosine(end) for end in (Intervals.at(x.low), Intervals.at(x.high))]
    return Intervals(ends[0].low, ends[1].high)


# ── derived functions ────────────────────────────────────────────────────────────────


def _rising(at: Callable[[Vector], Intervals], x: Intervals) -> Intervals:
    """Return the values of a rising function, from its enclosures at floats."""
    return Intervals(at(x.low).low, at(x.high).high)


def logarithm(x: Intervals) -> Intervals:
    """Return the natural logarithms; EnclosureError unless positive."""
    if np.any(x.low <= 0.0):
        raise EnclosureError("the logarithm of an interval that contains 0 or negative numbers")

    def at(values: Vector) -> Intervals:
        # For a guess y: log x = y + log(1 + w), w = x e^-y - 1, and w / (1 + w) ≤ log(1 + w) ≤ w.
        guess = Intervals.at(np.log(values))
        w = exponential(-guess) * Intervals.at(values) - 1.0
        if not np.all(w.low > -0.5):
            raise EnclosureError("a logarithm beyond the range of floats")
        return guess + Intervals((w / (w + 1.0)).low, w.high)

    return _rising(at, x)


def arctangent(x: Intervals) -> Intervals:
    """Return the arc tangents."""

    def small(values: Vector) -> Intervals:
        # For a guess y: atan x = y + atan d, d = (x - tan y) / (1 + x tan y), and |atan d| ≤ |d|.
        # Both are within a quarter turn if 1 + x tan y is positive.
        guess = Intervals.at(np.arctan(values))
        tan, point = tangent(guess), Intervals.at(values)
        below = point * tan + 1.0
        if not np.all(below.low > 0.0):
            raise EnclosureError("an arc tangent that is not known")
        return _widened(guess.low, ((point - tan) / below).size)

    def at(values: Vector) -> Intervals:
        large = np.abs(values) > 1.0
        inside = small(np.where(large, 0.0, values))
        turned = Intervals.at(np.ones_like(values)) / Intervals.at(np.where(large, values, 1.0))
        low, high = small(turned.low), small(turned.high)
        quarter = half_pi() * Intervals.at(np.where(values < 0.0, -1.0, 1.0))
        outside = quarter - Intervals(low.low, high.high)
        return Intervals(
            np.where(large, outside.low, inside.low), np.where(large, outside.high, inside.high)
        )

    return _rising(at, x)


def hyperbolic_tangent(x: Intervals) -> Intervals:
    """Return the hyperbolic tangents: 1 - 2 / (e^2x + 1) of the magnitude, with the sign."""

    def at(values: Vector) -> Intervals:
        size = Intervals.at(np.minimum(np.abs(values), 300.0))
        intervals = 1.0 - 2.0 / (exponential(size * 2.0) + 1.0)
        low, high = np.maximum(intervals.low, 0.0), np.minimum(intervals.high, 1.0)
        high = np.where(np.abs(values) > 300.0, 1.0, high)
        negative = values < 0.0
        return Intervals(np.where(negative, -high, low), np.where(negative, -low, high))

    return _rising(at, x)


def hyperbolics(x: Intervals) -> tuple[Intervals, Intervals]:
    """Return the hyperbolic sines and cosines: (e^x ∓ e^-x) / 2."""
    low, high = (_hyperbolics(Intervals.at(end)) for end in (x.low, x.high))
    across = (x.low < 0.0) & (x.high > 0.0)
    least = np.where(across, 1.0, np.minimum(low[1].low, high[1].low))
    cosines = Intervals(least, np.maximum(low[1].high, high[1].high))
    return Intervals(low[0].low, high[0].high), cosines


def _hyperbolics(x: Intervals) -> tuple[Intervals, Intervals]:
    if np.any(x.size > 700.0):
        raise EnclosureError("a hyperbolic function of a large number")
    powers = exponential(x)
    inverse = 1.0 / powers
    return (powers - inverse) * 0.5, (powers + inverse) * 0.5


def arcsine(x: Intervals) -> Intervals:
    """Return the arc sines; EnclosureError outside [-1, 1]."""
    if np.any(x.size >= 1.0):
        raise EnclosureError("the arc sine of an interval that goes to 1 or -1")

    def at(values: Vector) -> Intervals:
        point = Intervals.at(values)
        return arctangent(point / square_root(1.0 - point.squared()))

    return _rising(at, x)


def arccosine(x: Intervals) -> Intervals:
    """Return the arc cosines, π/2 minus the arc sines."""
    return half_pi() - arcsine(x)


@cache
def half_pi() -> Intervals:
    """Return a quarter turn."""
    return outward(0.5 * math.pi, 0.5 * math.pi)  # π is irrational: between these floats


def power(x: Intervals, exponent: float) -> Intervals:
    """Return powers: an integer exponent, or positive bases."""
    if exponent == 0.0:
        return Intervals.at(np.ones_like(x.low))
    if exponent < 0.0:
        return 1.0 / power(x, -exponent)
    if exponent % 1.0 != 0.0 or exponent > 64.0:
        if exponent == 0.5:
            return square_root(x)
        return exponential(logarithm(x) * exponent)
    if exponent % 2.0 == 0.0:
        return _whole_power(absolute(x), int(exponent))
    low, high = Intervals.at(x.low), Intervals.at(x.high)
    return Intervals(_whole_power(low, int(exponent)).low, _whole_power(high, int(exponent)).high)


def _whole_power(x: Intervals, exponent: int) -> Intervals:
    result = x
    for _ in range(exponent - 1):
        result = result * x
    return result


FUNCTIONS: dict[str, Callable[[Intervals], Intervals]] = {
    "sqrt": square_root,
    "exp": exponential,
    "log": logarithm,
    "sin": sine,
    "cos": cosine,
    "tan": tangent,
    "asin": arcsine,
    "acos": arccosine,
    "atan": arctangent,
    "sinh": lambda x: hyperbolics(x)[0],
    "cosh": lambda x: hyperbolics(x)[1],
    "tanh": hyperbolic_tangent,
}
"""Smooth operations by name; their slopes follow from their records."""


# ── matrices ─────────────────────────────────────────────────────────────────────────

TERMS = 18
"""Last power in the series of the matrix exponential."""


def matrix_product(a: Intervals, b: Intervals) -> Intervals:
    """Return the product of matrices of intervals: shapes (n, k) and (k, m)."""
    total = a[:, :1] * b[:1, :]
    for column in range(1, a.shape[1]):
        total = total + a[:, column : column + 1] * b[column : column + 1, :]
    return total


def matrix_exponential(matrix: Intervals | Any, time: float = 1.0) -> Intervals:
    """Enclose exp(A t).

    Parameters
    ----------
    matrix : Intervals or array_like, shape (n, n)
        A: numbers, or independent intervals.
    time : float
        t.

    Returns
    -------
    Intervals
        Shape (n, n). The sampled matrices of a linear plant with held inputs are the upper rows of
        the exponential of ``[[A, B], [0, 0]]`` (Van Loan).

    Examples
    --------
    >>> found = matrix_exponential([[0.0, 1.0], [-1.0, 0.0]], 0.5)
    >>> bool(found.holds([[math.cos(0.5), math.sin(0.5)], [-math.sin(0.5), math.cos(0.5)]]).all())
    True
    >>> bool(found.radius.max() < 1e-14)
    True
    """
    intervals = matrix if isinstance(matrix, Intervals) else Intervals.at(matrix)
    whole = intervals * time
    size = float(_up(whole.size.sum(axis=1) * (1.0 + 1e-12)).max(initial=0.0))
    if not math.isfinite(size):
        raise EnclosureError("the exponential of a matrix that is not finite")
    halvings = max(0, math.frexp(size)[1] + 1)  # for a norm of at most 1/2
    small = outward(np.ldexp(whole.low, -halvings), np.ldexp(whole.high, -halvings))
    unit = Intervals.at(np.eye(len(whole.low)))
    # I + A (I + A/2 (I + A/3 (…))); the tail is at most twice the first omitted term.
    total = unit
    for k in range(TERMS, 0, -1):
        total = unit + matrix_product(small, total) / float(k)
    tail = 2.0 * 0.5 ** (TERMS + 1) / math.factorial(TERMS + 1)
    total = total + Intervals.between(np.full(unit.shape, -tail), np.full(unit.shape, tail))
    for _ in range(halvings):
        total = matrix_product(total, total)
    return total
