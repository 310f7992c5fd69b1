"""Functions that are polynomials between breaks, with rational coefficients.

Straight sets, cut and united by the common norms, are such functions; their areas, moments, halves
and greatest stretches are then rational, or roots that are taken to 60 digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise, zip_longest
from math import isqrt

DIGITS = 60

Polynomial = tuple[Fraction, ...]
"""Coefficients, the constant first."""


class NotStraightError(ValueError):
    """A function is not a polynomial between breaks, so that its integral is not rational."""


def root(square: Fraction) -> Fraction:
    """Return a square root: itself where it is rational, else to `DIGITS` digits."""
    above, below = isqrt(square.numerator), isqrt(square.denominator)
    if above**2 == square.numerator and below**2 == square.denominator:
        return Fraction(above, below)
    scale = 10**DIGITS
    return Fraction(isqrt(square.numerator * scale**2 // square.denominator), scale)


def value(polynomial: Polynomial, x: Fraction) -> Fraction:
    """Return a polynomial at x, by Horner's rule."""
    total = Fraction(0)
    for coefficient in reversed(polynomial):
        total = total * x + coefficient
    return total


def plus(a: Polynomial, b: Polynomial) -> Polynomial:
    """Return the sum of two polynomials."""
    return trimmed(x + y for x, y in zip_longest(a, b, fillvalue=Fraction(0)))


def times(a: Polynomial, b: Polynomial) -> Polynomial:
    """Return the product of two polynomials."""
    terms = [Fraction(0)] * (len(a) + len(b))
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            terms[i + j] += x * y
    return trimmed(terms)


def trimmed(coefficients: Iterable[Fraction]) -> Polynomial:
    """Return coefficients without the zeros of the highest powers."""
    listed = list(coefficients)
    while listed and listed[-1] == 0:
        listed.pop()
    return tuple(listed)


def integral(polynomial: Polynomial, low: Fraction, high: Fraction) -> Fraction:
    """Return the integral of a polynomial from low to high."""
    whole = (Fraction(0), *(c / (k + 1) for k, c in enumerate(polynomial)))
    return value(whole, high) - value(whole, low)


def line(x0: Fraction, y0: Fraction, x1: Fraction, y1: Fraction) -> Polynomial:
    """Return the straight line through two points."""
    slope = (y1 - y0) / (x1 - x0)
    return trimmed((y0 - slope * x0, slope))


@dataclass(frozen=True)
class Piece:
    """A polynomial on one stretch."""

    low: Fraction
    high: Fraction
    polynomial: Polynomial

    def ends(self) -> tuple[Fraction, Fraction]:
        """Return the values at both ends, as seen from within."""
        return value(self.polynomial, self.low), value(self.polynomial, self.high)


Pieces = tuple[Piece, ...]


def through(corners: Sequence[tuple[Fraction, Fraction]], low: Fraction, high: Fraction) -> Pieces:
    """Return what joins corners by straight lines, level beyond the first and the last."""
    (first, before), (last, behind) = corners[0], corners[-1]
    padded = [(min(low, first) - 1, before), *corners, (max(high, last) + 1, behind)]
    pieces = []
    for (x0, y0), (x1, y1) in pairwise(padded):
        start, end = max(x0, low), min(x1, high)
        if start < end:
            pieces.append(Piece(start, end, line(x0, y0, x1, y1)))
    return tuple(pieces)


def level(height: Fraction, low: Fraction, high: Fraction) -> Pieces:
    """Return a constant."""
    return (Piece(low, high, trimmed((height,))),)


def common(f: Pieces, g: Pieces) -> Iterable[tuple[Fraction, Fraction, Polynomial, Polynomial]]:
    """Yield the stretches on which both functions are one polynomial each."""
    breaks = sorted({p.low for p in (*f, *g)} | {p.high for p in (*f, *g)})
    at_f, at_g = iter(f), iter(g)
    one, other = next(at_f), next(at_g)
    for start, end in pairwise(breaks):
        while one.high <= start:
            one = next(at_f)
        while other.high <= start:
            other = next(at_g)
        yield start, end, one.polynomial, other.polynomial


def combined(
    f: Pieces, g: Pieces, norm: Callable[[Fraction, Fraction], Fraction], polynomial: str = ""
) -> Pieces:
    """Return a norm of two functions.

    Parameters
    ----------
    f, g : Pieces
        Both over the same range.
    norm : callable
        Of two degrees; straight but where they are equal or add up to 1.
    polynomial : {"", "product", "probabilistic sum", "sum"}
        Of norms that are polynomials themselves: then any f and g will do.
    """
    pieces = []
    for start, end, p, q in common(f, g):
        if polynomial:
            both, product = plus(p, q), times(p, q)
            negative = times((Fraction(-1),), product)
            made = {"product": product, "sum": both, "probabilistic sum": plus(both, negative)}
            pieces.append(Piece(start, end, made[polynomial]))
            continue
        if len(p) > 2 or len(q) > 2:
            raise NotStraightError("this norm meets a set that is not straight")
        less = plus(p, times((Fraction(-1),), q))
        breaks = {start, end}
        for crossing in (less, plus(plus(p, q), (Fraction(-1),))):
            if len(crossing) == 2 and start < (x := -crossing[0] / crossing[1]) < end:
                breaks.add(x)
        for a, b in pairwise(sorted(breaks)):
            places = [a + (b - a) * k / 4 for k in (1, 2, 3)]
            heights = [norm(value(p, x), value(q, x)) for x in places]
            if heights[0] + heights[2] != 2 * heights[1]:
                raise NotStraightError("this norm bends straight sets")
            pieces.append(Piece(a, b, line(places[0], heights[0], places[2], heights[2])))
    return tuple(pieces)


def area(f: Pieces) -> Fraction:
    """Return the area under a function."""
    return sum((integral(p.polynomial, p.low, p.high) for p in f), Fraction(0))


def moment(f: Pieces) -> Fraction:
    """Return the integral of x times the function."""
    x = (Fraction(0), Fraction(1))
    return sum((integral(times(x, p.polynomial), p.low, p.high) for p in f), Fraction(0))


def half(f: Pieces, first: bool = False) -> Fraction:
    """Return where half of the area is reached; of a whole gap its middle, or its start."""
    wanted, so_far = area(f) / 2, Fraction(0)
    for index, piece in enumerate(f):
        part = integral(piece.polynomial, piece.low, piece.high)
        if so_far + part < wanted:
            so_far += part
            continue
        if so_far + part == wanted and not first:
            behind = (p.low for p in f[index + 1 :] if p.polynomial)
            return (piece.high + next(behind, piece.high)) / 2
        return _reached(piece, wanted - so_far)
    raise NotStraightError("there is no area to be halved")


def _reached(piece: Piece, rest: Fraction) -> Fraction:
    """Return where the area of a straight piece, from its low end on, is `rest`."""
    if len(piece.polynomial) > 2:
        raise NotStraightError("half of the area lies under a curve")
    start, end = piece.ends()
    slope = (end - start) / (piece.high - piece.low)
    if slope == 0:
        return piece.low + rest / start
    # start·t + slope·t²/2 = rest, for the lesser t ≥ 0.
    return piece.low + (root(start**2 + 2 * slope * rest) - start) / slope


def greatest(f: Pieces) -> list[tuple[Fraction, Fraction]]:
    """Return the stretches, from low to high, on which a straight function is greatest."""
    if any(len(p.polynomial) > 2 for p in f):
        raise NotStraightError("the greatest of a curve is not sought")
    height = max(max(p.ends()) for p in f)
    stretches: list[tuple[Fraction, Fraction]] = []
    for piece in f:
        start, end = piece.ends()
        for low, high in (
            [(piece.low, piece.high)]
            if start == end == height
            else [(x, x) for x, y in ((piece.low, start), (piece.high, end)) if y == height]
        ):
            if stretches and stretches[-1][1] == low:
                stretches[-1] = (stretches[-1][0], high)
            else:
                stretches.append((low, high))
    return stretches
