"""A set over a finite range, cut into pieces on which it is monotone, and where two sets cross.

Straight shapes give straight pieces, exactly; vertical edges are jumps between pieces.
Everything that needs more of a set than its value at a point builds on this: the closed
form of the centroid, level cuts, and the panels of the quadrature.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from fuzzyarm.model.membership import apply_hedge, membership
from fuzzyarm.model.rulebase import Hedge, Shape
from fuzzyarm.model.shapes import SHAPES

# --- A set over a finite range, cut into pieces on which it is monotone ---

LINEAR_HEDGES = frozenset({"not", "any"})
"""Hedges that keep straight pieces straight."""


class Piece(NamedTuple):
    """A monotone stretch of a set: its ends with the one-sided values there."""

    x0: float
    y0: float
    x1: float
    y1: float
    straight: bool


Membership = Callable[[float], float]


def polyline(shape: Shape) -> list[tuple[float, float]]:
    """Return the corners of a straight shape, left to right.

    Parameters
    ----------
    shape : Shape
        Of a piecewise-linear kind other than a singleton.

    Returns
    -------
    list of (float, float)
        A vertical edge is two corners at one x; the first and the last value go on to
        infinity. Values include the height.
    """
    p = shape.parameters
    if shape.kind == "triangle":
        corners = [(p[0], 0.0), (p[1], 1.0), (p[2], 0.0)]
    elif shape.kind == "trapezoid":
        corners = [(p[0], 0.0), (p[1], 1.0), (p[2], 1.0), (p[3], 0.0)]
        corners = [corner for corner in corners if math.isfinite(corner[0])]
    elif shape.kind == "rectangle":
        corners = [(p[0], 0.0), (p[0], 1.0), (p[1], 1.0), (p[1], 0.0)]
    elif shape.kind == "ramp":
        corners = sorted([(p[0], 0.0), (p[1], 1.0)])
    elif shape.kind == "binary":
        rises = p[1] > p[0]
        corners = [(p[0], 0.0 if rises else 1.0), (p[0], 1.0 if rises else 0.0)]
    else:
        corners = list(zip(p[0::2], p[1::2], strict=True))
    return [(x, shape.height * y) for x, y in corners]


def profile(
    shape: Shape, hedges: Sequence[Hedge], membership: Membership, low: float, high: float
) -> tuple[Piece, ...]:
    """Cut a set into monotone pieces from `low` to `high`, without gaps.

    Parameters
    ----------
    shape, hedges
        What the set is made of; the last hedge acts first.
    membership : callable
        The set, hedges included.
    low, high : float
        A finite range.

    Returns
    -------
    tuple of Piece
        In order; each has a positive width.
    """
    if not SHAPES[shape.kind].piecewise_linear:
        return _smooth(shape, hedges, membership, low, high)
    straight = _clip(polyline(shape), low, high)
    for hedge in reversed(hedges):
        straight = _apply(hedge, straight)
    return tuple(straight)


def _clip(corners: list[tuple[float, float]], low: float, high: float) -> list[Piece]:
    first, last = corners[0], corners[-1]
    ends = [(min(low, first[0]), first[1]), *corners, (max(high, last[0]), last[1])]
    pieces = []
    for (x0, y0), (x1, y1) in pairwise(ends):
        a, b = max(x0, low), min(x1, high)
        if not b > a:
            continue
        slope = (y1 - y0) / (x1 - x0)
        ya = y0 if a == x0 else y0 + slope * (a - x0)
        yb = y1 if b == x1 else y0 + slope * (b - x0)
        pieces.append(Piece(a, ya, b, yb, straight=True))
    return pieces


def _apply(hedge: Hedge, pieces: list[Piece]) -> list[Piece]:
    if hedge.name in {"intensify", "seldom"}:  # these have a bend where the degree is ½
        pieces = [half for piece in pieces for half in _split_at_level(piece, 0.5)]
    return [
        Piece(
            piece.x0,
            apply_hedge(hedge, piece.y0),
            piece.x1,
            apply_hedge(hedge, piece.y1),
            straight=piece.straight and (hedge.name in LINEAR_HEDGES or piece.y0 == piece.y1),
        )
        for piece in pieces
    ]


def _split_at_level(piece: Piece, level: float) -> list[Piece]:
    if (piece.y0 - level) * (piece.y1 - level) >= 0.0 or not piece.straight:
        return [piece]
    x = piece.x0 + (level - piece.y0) / (piece.y1 - piece.y0) * (piece.x1 - piece.x0)
    if not piece.x0 < x < piece.x1:
        return [piece]
    return [piece._replace(x1=x, y1=level), piece._replace(x0=x, y0=level)]


def _features(shape: Shape) -> list[float]:
    """Return the places where a smooth shape bends, and a few that frame its flanks."""
    p, kind = shape.parameters, shape.kind
    if kind in _FLANKS:
        return [x for i, j in _FLANKS[kind] for x in _around(p[i], p[j])]
    if "sigmoid" in kind:
        inverse = [1.0 / slope if slope else 0.0 for slope in p[1::2]]
        return [x for centre, w in zip(p[0::2], inverse, strict=True) for x in _around(centre, w)]
    if kind == "cosine":
        return [p[0] - 0.5 * p[1], p[0], p[0] + 0.5 * p[1]]
    if kind == "spike":
        return _around(p[0], 0.1 * p[1])
    return [*p, *(0.5 * (a + b) for a, b in pairwise(p))]  # s, z, pi, concave, arc, semi-ellipse


_FLANKS = {
    "gaussian": ((0, 1),),
    "two-sided-gaussian": ((0, 1), (2, 3)),
    "bell": ((0, 1),),
}
"""Indexes of (centre, width) among the parameters."""


def _around(centre: float, width: float) -> list[float]:
    return [centre, *(centre + sign * k * width for k in (0.5, 1, 2, 4, 8, 16) for sign in (-1, 1))]


def _smooth(
    shape: Shape, hedges: Sequence[Hedge], membership: Membership, low: float, high: float
) -> tuple[Piece, ...]:
    features = [x for x in _features(shape) if low < x < high]
    grid = [low + (high - low) * i / 16 for i in range(1, 16)]
    edges = sorted({low, high, *features, *grid})
    edges = sorted({*edges, *_turns(edges, membership)})
    if any(hedge.name in {"intensify", "seldom"} for hedge in hedges):
        edges = sorted({*edges, *_halves(shape, hedges, edges, low, high)})
    pieces = []
    for x0, x1 in pairwise(edges):
        y0, y1 = membership(math.nextafter(x0, x1)), membership(math.nextafter(x1, x0))
        pieces.append(Piece(x0, y0, x1, y1, straight=y0 == y1 == membership(0.5 * (x0 + x1))))
    return tuple(pieces)


def _turns(edges: list[float], membership: Membership) -> list[float]:
    """Find maxima and minima between the edges (golden section where samples show one)."""
    xs = sorted({a + (b - a) * i / 8 for a, b in pairwise(edges) for i in range(8)} | {edges[-1]})
    ys = [membership(x) for x in xs]
    turns = []
    for i in range(1, len(xs) - 1):
        sign = 1.0 if ys[i] > ys[i - 1] and ys[i] > ys[i + 1] else 0.0
        sign = -1.0 if ys[i] < ys[i - 1] and ys[i] < ys[i + 1] else sign
        if sign:
            turns.append(_golden(membership, xs[i - 1], xs[i + 1], sign, xs[i]))
    return turns


def _golden(function: Membership, a: float, b: float, sign: float, best: float) -> float:
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    c, d = b - ratio * (b - a), a + ratio * (b - a)
    fc, fd = sign * function(c), sign * function(d)
    for _ in range(80):
        if fc > fd:
            b, d, fd = d, c, fc
            c = b - ratio * (b - a)
            fc = sign * function(c)
        else:
            a, c, fc = c, d, fd
            d = a + ratio * (b - a)
            fd = sign * function(d)
    found = 0.5 * (a + b)
    return best if sign * function(best) >= sign * function(found) else found


def _halves(
    shape: Shape, hedges: Sequence[Hedge], edges: list[float], low: float, high: float
) -> list[float]:
    """Find where the degree below an ``intensify`` or ``seldom`` passes one half."""
    found = []
    for depth, hedge in enumerate(hedges):
        if hedge.name not in {"intensify", "seldom"}:
            continue

        def below(x: float, inner: Sequence[Hedge] = hedges[depth + 1 :]) -> float:
            degree = membership(shape, x)
            for each in reversed(inner):
                degree = apply_hedge(each, degree)
            return degree

        for a, b in pairwise(edges):
            if (below(a) - 0.5) * (below(b) - 0.5) < 0.0:
                found.append(bisect(below, a, b, 0.5))
    return [x for x in found if low < x < high]


def bisect(function: Membership, a: float, b: float, level: float) -> float:
    """Return where a monotone function passes `level` between `a` and `b`."""
    rising = function(b) > function(a)
    for _ in range(80):
        middle = 0.5 * (a + b)
        if middle in {a, b}:
            break
        if (function(middle) < level) == rising:
            a = middle
        else:
            b = middle
    return 0.5 * (a + b)


def peak(pieces: Sequence[Piece]) -> float:
    """Return the greatest value of a set over its range."""
    return max(max(piece.y0, piece.y1) for piece in pieces)


def cut(pieces: Sequence[Piece], membership: Membership, level: float) -> list[tuple[float, float]]:
    """Return the intervals where a set is at least `level`, in order, maybe touching."""
    intervals = []
    for piece in pieces:
        left, right = piece.y0 >= level, piece.y1 >= level
        if left and right:
            intervals.append((piece.x0, piece.x1))
        elif left or right:
            x = crossing(piece, membership, level)
            intervals.append((piece.x0, x) if left else (x, piece.x1))
    return intervals


def crossing(piece: Piece, membership: Membership, level: float) -> float:
    """Return where a piece passes `level`, which lies between its ends."""
    if piece.straight:
        share = (level - piece.y0) / (piece.y1 - piece.y0)
        return piece.x0 + share * (piece.x1 - piece.x0)
    return bisect(
        membership, math.nextafter(piece.x0, piece.x1), math.nextafter(piece.x1, piece.x0), level
    )


def middle_of_core(pieces: Sequence[Piece], membership: Membership) -> float:
    """Return the middle of the stretch where a set is greatest (its peak, equation 6.4).

    Where several stretches are equally high, the middle from the first to the last.
    """
    intervals = cut(pieces, membership, peak(pieces))
    return 0.5 * (intervals[0][0] + intervals[-1][1])


# --- Where two clipped sets may cross ---
#
# Panels cut there leave the quadrature nothing to seek.
#
# Over a straight piece a set cut at the strength w is one of a few straight lines
# α + β μ(y): under min it is μ or w, under product w μ, under bounded μ + w − 1. Two sets
# cross where two of these lines do.

Forms = tuple[tuple[Any, Any], ...]
"""(α, β) for each line, floats or arrays."""

FORMS: dict[str, Callable[[Any], Forms]] = {
    "min": lambda w: ((0.0, 1.0), (w, 0.0)),
    "product": lambda w: ((0.0, w),),
    "bounded": lambda w: ((w - 1.0, 1.0),),
}
"""The lines of a set cut at a strength, by implication."""


class Stretch(NamedTuple):
    """Two members that are straight and not both zero from `start` to `end`.

    Attributes
    ----------
    first, second : int
        The members.
    start, end : float
        The stretch.
    first_start, first_end, second_start, second_end : float
        Their memberships at its ends.
    """

    first: int
    second: int
    start: float
    end: float
    first_start: float
    first_end: float
    second_start: float
    second_end: float


def stretches(profiles: Sequence[Sequence[Piece]]) -> tuple[Stretch, ...]:
    """Return the stretches over which two straight sets overlap."""
    found = []
    for i, pieces in enumerate(profiles):
        for j in range(i + 1, len(profiles)):
            for one in pieces:
                for other in profiles[j]:
                    start, end = max(one.x0, other.x0), min(one.x1, other.x1)
                    if start < end and _matters(one) and _matters(other):
                        ends = (*_between(one, start, end), *_between(other, start, end))
                        found.append(Stretch(i, j, start, end, *ends))
    return tuple(found)


def _matters(piece: Piece) -> bool:
    return piece.straight and (piece.y0 > 0.0 or piece.y1 > 0.0)


def _between(piece: Piece, start: float, end: float) -> tuple[float, float]:
    slope = (piece.y1 - piece.y0) / (piece.x1 - piece.x0)
    return piece.y0 + slope * (start - piece.x0), piece.y0 + slope * (end - piece.x0)


def gaps(stretch: Stretch, first: Forms, second: Forms) -> list[tuple[Any, Any]]:
    """Return by how much the first set is above the second at both ends, line by line.

    They cross where the two signs differ, at the share gap₀ / (gap₀ − gap₁) of the way.
    """
    _, _, _, _, a0, a1, b0, b1 = stretch
    return [
        (alpha + beta * a0 - gamma - delta * b0, alpha + beta * a1 - gamma - delta * b1)
        for alpha, beta in first
        for gamma, delta in second
    ]
