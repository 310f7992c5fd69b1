"""Numbers of the checker: exact rationals, else Arb's balls (python-flint).

A number is an ``fmpq``, exact, or an ``arb``, a ball that holds the true value; or many intervals
at once (:class:`~fuzzyarm.proof.check.spans.Spans`). All mix: whatever
a ball enters is a ball, rounded outward. A comparison holds only where it is certain, so that
``not x < y`` says nothing; and a ball has no truth value: compare it with 0.

Source: F. Johansson, "Arb: efficient arbitrary-precision midpoint-radius interval arithmetic",
*IEEE Transactions on Computers* 66, 2017.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import wraps
from numbers import Rational
from operator import mul
from typing import Any, ParamSpec, TypeVar

import numpy as np
from flint import arb, ctx, fmpq

from fuzzyarm.proof.check import spans
from fuzzyarm.proof.check.spans import Matrices, Spans
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.stop import check_time

Number = Any
"""An ``fmpq``, an ``arb`` or ``Spans``."""

Matrix = list[list[Number]]

ZERO, ONE = fmpq(0), fmpq(1)

P = ParamSpec("P")
R = TypeVar("R")

BITS = 160
"""Precision of a ball's midpoint. Fewer bits widen balls, and make no statement wrong."""


def precisely(work: Callable[P, R]) -> Callable[P, R]:
    """Run a function with balls of :data:`BITS` bits, and without warnings for NaN."""

    @wraps(work)
    def with_bits(*arguments: P.args, **keywords: P.kwargs) -> R:
        with ctx.workprec(BITS), np.errstate(all="ignore"):
            return work(*arguments, **keywords)

    return with_bits


class SpanError(LoopProofError):
    """An expression has no value, or no bound, over its numbers."""


def exact(value: float | Rational) -> fmpq:
    """Return a float or a rational as an exact rational."""
    if isinstance(value, float) and not math.isfinite(value):
        raise SpanError(f"{value} is not a number")
    return spans.exact(Fraction(value))


def ball(x: Number) -> Number:
    """Return a ball, or balls, around a number."""
    return x if isinstance(x, Spans) else arb(x)


def between(low: Number, high: Number) -> Number:
    """Return a number that contains [low, high]."""
    if isinstance(low, Spans) or isinstance(high, Spans):
        return Spans.of(low).union(high)
    return low if isinstance(low, fmpq) and low == high else arb(low).union(arb(high))


def around(centre: Number, far: Number) -> Number:
    """Return a number that contains all values up to `far` from a centre."""
    return ball(centre) + arb(0, 1) * ball(far)


def least(x: Number) -> Number:
    """Return the lower end, exact."""
    return x if isinstance(x, fmpq) else x.lower()


def greatest(x: Number) -> Number:
    """Return the upper end, exact."""
    return x if isinstance(x, fmpq) else x.upper()


def ends(x: Number) -> tuple[Fraction, Fraction]:
    """Return both ends."""
    return _fraction(least(x)), _fraction(greatest(x))


def _fraction(x: Number) -> Fraction:
    if isinstance(x, fmpq):
        return Fraction(int(x.p), int(x.q))
    if not x.is_finite():
        raise SpanError("a number without a bound")
    mantissa, exponent = (int(part) for part in x.man_exp())
    return Fraction(mantissa) * Fraction(2) ** exponent


def float_below(x: Number) -> float:
    """Return a float not above a number, or not above any of many."""
    if isinstance(x, Spans):
        return float(np.min(x.low))
    low = least(x)
    near = float(low) if not isinstance(low, arb) or low.is_finite() else -math.inf
    return near if near == -math.inf or exact(near) <= low else math.nextafter(near, -math.inf)


def float_above(x: Number) -> float:
    """Return a float not below a number."""
    return -float_below(-x)


def middle(x: Number) -> Number:
    """Return the middle, exact."""
    return x if isinstance(x, fmpq) else x.mid()


def radius(x: Number) -> Number:
    """Return the largest distance of a number from its midpoint."""
    return ZERO if isinstance(x, fmpq) else x.rad()


def is_zero(x: Number) -> bool:
    """Return whether a number is certainly 0; ``x != 0`` of a ball means certainly not 0."""
    return bool(x == 0)


def is_point(x: Number) -> bool:
    """Return whether a number is exact."""
    return isinstance(x, fmpq) or x.is_exact()


def magnitude(x: Number) -> Number:
    """Return the largest magnitude of a number, exact."""
    return abs(x) if isinstance(x, fmpq) else x.abs_upper()


def holds(outer: Number, inner: Number) -> bool:
    """Return whether one number contains another."""
    return bool(least(outer) <= least(inner) and greatest(inner) <= greatest(outer))


def is_same(a: Any, b: Any) -> bool:
    """Return whether two structures are equal; balls by midpoint and radius."""
    if isinstance(a, Mapping):
        return a.keys() == b.keys() and all(is_same(x, b[name]) for name, x in a.items())
    if isinstance(a, list | tuple):
        return len(a) == len(b) and all(map(is_same, a, b))
    if isinstance(a, arb) and isinstance(b, arb):
        return bool(middle(a) == middle(b) and radius(a) == radius(b)) or (
            holds(a, b) and holds(b, a)
        )
    return bool(a == b)


def hull(*numbers: Number) -> Number:
    """Return a number that contains all of these."""
    total = numbers[0]
    for x in numbers[1:]:
        total = total if isinstance(total, fmpq) and is_point(x) and total == x else between(
            total, x)  # fmt: skip
    return total


def square(x: Number) -> Number:
    """Return x², never below 0."""
    if isinstance(x, fmpq):
        return x * x
    low, high = x.abs_lower(), x.abs_upper()
    return between(low * low, high * high)


# ── functions ────────────────────────────────────────────────────────────────────────

LARGE = 64
"""Largest magnitude of an exponent."""

AT_ZERO = {
    **dict.fromkeys(("sin", "tan", "asin", "atan", "sinh", "tanh", "sqrt"), ZERO),
    **dict.fromkeys(("cos", "exp", "cosh"), ONE),
}
"""Values at 0, exact, so that a loop may rest there."""

GROWING = frozenset({"exp", "sinh", "cosh"})

RISING = frozenset({"sqrt", "exp", "log", "asin", "atan", "sinh", "tanh"})
"""Monotone functions, bounded by their values at both ends: tighter than one ball."""

FUNCTIONS = (*RISING, "cosh", "sin", "cos", "tan", "acos", "absolute")
"""Operations of one argument, by the name of the ball's method."""


def function(name: str, x: Number) -> Number:
    """Return one of :data:`FUNCTIONS`; SpanError (NaN for many) without a value or bound."""
    if name == "absolute":
        return abs(x) if isinstance(x, fmpq) else between(x.abs_lower(), x.abs_upper())
    if isinstance(x, Spans):
        value = _function(name, x)
        at_zero = (x.low == 0.0) & (x.high == 0.0)
        return value.chosen(~at_zero, AT_ZERO[name]) if name in AT_ZERO and at_zero.any() else value
    return AT_ZERO[name] if name in AT_ZERO and x == 0 else _function(name, x)


def _function(name: str, x: Number) -> Number:
    """Return a function evaluated by Arb."""
    if name in GROWING and not magnitude(x) < LARGE:
        raise SpanError("the exponential of a large number")
    at = (least(x), greatest(x)) if name in RISING and not is_point(x) else (x,)
    values = [getattr(ball(end), name)() for end in at]
    if not all(isinstance(value, Spans) or value.is_finite() for value in values):
        raise SpanError(f"'{name}' has no value, or no bound, in an interval")
    value = hull(*values)
    if name in ("sin", "cos") and not magnitude(value) <= 1:
        value = between(_clipped(least(value)), _clipped(greatest(value)))
    return value


def _clipped(x: Number) -> Number:
    if isinstance(x, Spans):
        return x.min(1).max(-1)
    return ONE if x > 1 else -ONE if x < -1 else x


# ── matrices ─────────────────────────────────────────────────────────────────────────


def identity(size: int) -> Matrix:
    """Return the unit matrix."""
    return [[fmpq(int(i == j)) for j in range(size)] for i in range(size)]


def transposed(a: Sequence[Sequence[Number]]) -> Matrix:
    """Return the transpose."""
    return [list(row) for row in zip(*a, strict=True)]


def product(a: Sequence[Sequence[Number]], b: Sequence[Sequence[Number]]) -> Matrix:
    """Return a matrix product, in balls."""
    check_time()
    if any(isinstance(x, Spans) for row in (*a, *b) for x in row):
        return (Matrices.of(a) @ Matrices.of(b)).rows
    columns = [[ball(x) for x in column] for column in zip(*b, strict=True)]
    rows = [[ball(x) for x in row] for row in a]
    return [[sum(map(mul, row, column), arb(0)) for column in columns] for row in rows]


def is_positive_definite(matrix: Sequence[Sequence[Number]]) -> bool:
    """Return whether every symmetric matrix within a matrix of balls is positive definite.

    Radii of entries are subtracted from the diagonal: a symmetric E with |Eᵢⱼ| ≤ Sᵢⱼ is at most the
    diagonal matrix of the row sums of S (diagonal dominance). The rest is Cholesky's elimination.
    """
    with ctx.workprec(400):
        return _is_positive_definite([[arb(x) for x in row] for row in matrix])


def _is_positive_definite(balls: Matrix) -> bool:
    size = range(len(balls))
    if not all(balls[i][i] > 0 for i in size):
        return False
    # Rows and columns are scaled by powers of 2 for a diagonal near 1: the signs stay.
    scale = [arb(2) ** (-_exponent(balls[i][i]) // 2) for i in size]
    work = [[balls[i][j].mid() * scale[i] * scale[j] for j in size] for i in size]
    for i in size:
        work[i][i] -= sum((balls[i][j].rad() * scale[i] * scale[j] for j in size), arb(0))
    for k in size:
        check_time()
        if not work[k][k] > 0:
            return False
        for i in range(k + 1, len(balls)):
            factor = work[i][k] / work[k][k]
            for j in range(k + 1, len(balls)):
                work[i][j] -= factor * work[k][j]
    return True


def _exponent(x: Number) -> int:
    mantissa, exponent = x.mid().man_exp()
    return int(mantissa).bit_length() + int(exponent)
