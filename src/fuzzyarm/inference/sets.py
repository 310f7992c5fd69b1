"""A set of a term: its degrees at points and over arrays, its pieces, crossings of two sets.

A set is a shape under hedges. Its monotone pieces over a finite range serve all uses beyond
degrees: the closed form of the centroid, level cuts, and the panels of the quadrature. Straight
shapes give straight pieces, exactly; vertical edges are jumps between pieces.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.language.model.rulebase import POSITION, Hedge, Shape
from fuzzyarm.language.model.shapes import (
    apply_hedge,
    apply_hedges,
    bends,
    membership_function,
    polyline,
)
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.evaluation import evaluate_arrays, may_lack_values
from fuzzyarm.symbolic.functions import python_function
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES, TNORMS
from fuzzyarm.symbolic.nodes import Node

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.symbolic.formulas import Formula

SetFunction = Callable[[float], float]
"""The degree at one point."""


# ── degrees ──────────────────────────────────────────────────────────────────────────


@lru_cache(maxsize=512)
def formula_of(shape: Shape) -> Formula:
    """Return the formula of a shape, read once."""
    from fuzzyarm.symbolic.formulas import read_formula

    return read_formula(shape.formula)


@lru_cache(maxsize=512)
def degree_formula(shape: Shape) -> Node:
    """Return the degree of a formula in `x`: 0 where undefined, like the root of -1."""
    root = formula_of(shape).with_constants((POSITION,))
    return op.where(op.equal(root, root), root, 0.0) if may_lack_values(root) else root


def term_function(shape: Shape, hedges: tuple[Hedge, ...] = ()) -> SetFunction:
    """Return the degree in a set as a function of a float; the last hedge acts first.

    Of a ``linear`` consequent it raises InferenceError.
    """
    if shape.kind == "formula":
        names = formula_of(shape).names
        if names not in {(), (POSITION,)}:  # a value, which has no degrees: a mistake of the caller
            return _not_a_set(shape)
        height, computed = shape.height, python_function(degree_formula(shape), (POSITION,))
        degree: SetFunction = lambda x: height * computed(x)  # noqa: E731
    elif not SHAPES[shape.kind].fuzzy:
        return _not_a_set(shape)
    else:
        degree = membership_function(shape)
    return (lambda x: apply_hedges(hedges, degree(x))) if hedges else degree


def _not_a_set(shape: Shape) -> SetFunction:
    def refuse(x: float) -> float:
        raise InferenceError(f"a {shape.kind} consequent is not a set")

    return refuse


def degrees(
    shape: Shape, x: NDArray[np.float64], hedges: Sequence[Hedge] = ()
) -> NDArray[np.float64]:
    """Return the degree of every element of `x` in a set; the last hedge acts first."""
    import numpy as np

    if shape.kind == "formula":
        values = evaluate_arrays(degree_formula(shape), {POSITION: x}, as_floats=True)
    elif SHAPES[shape.kind].straight:
        values = SHAPES[shape.kind].lines(*shape.parameters, height=shape.height).over(x)
        return hedged(hedges, values) if hedges else values
    else:
        values = SHAPES[shape.kind].array(x, *shape.parameters)
    values = np.broadcast_to(values, np.broadcast_shapes(np.shape(values), x.shape))
    if shape.height != 1.0:
        values = values * shape.height
    return hedged(hedges, values) if hedges else values


def hedged(hedges: Sequence[Hedge], degree: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return degrees modified by hedges; the last acts first."""
    import numpy as np

    for hedge in reversed(hedges):
        numbers = () if hedge.exponent is None else (hedge.exponent,)
        result = HEDGES[hedge.name].array(degree, *numbers)
        degree = np.broadcast_to(result, np.shape(degree)).astype(float, copy=False)
    return degree


# ── pieces ───────────────────────────────────────────────────────────────────────────


class Piece(NamedTuple):
    """A monotone stretch of a set: its ends with the one-sided values there."""

    x0: float
    y0: float
    x1: float
    y1: float
    straight: bool

    def between(self, a: float, b: float) -> Piece:
        """Return the part of a straight piece between two positions; exact for exact numbers."""
        slope = (self.y1 - self.y0) / (self.x1 - self.x0)
        ya = self.y0 if a == self.x0 else self.y0 + slope * (a - self.x0)
        yb = self.y1 if b == self.x1 else self.y0 + slope * (b - self.x0)
        return Piece(a, ya, b, yb, self.straight)


def profile(
    shape: Shape, hedges: Sequence[Hedge], membership: SetFunction, low: float, high: float
) -> tuple[Piece, ...]:
    """Cut a set into monotone pieces of positive width over a finite range, without gaps."""
    if not SHAPES[shape.kind].straight:
        return _smooth(shape, hedges, membership, low, high)
    straight = straight_pieces(polyline(shape), low, high)
    for hedge in reversed(hedges):
        straight = _apply(hedge, straight)
    return tuple(straight)


def straight_pieces(corners: Sequence[tuple[float, float]], low: float, high: float) -> list[Piece]:
    """Cut a line through corners at the ends of a range; exact for exact numbers."""
    first, last = corners[0], corners[-1]
    ends = [(min(low, first[0]), first[1]), *corners, (max(high, last[0]), last[1])]
    pieces = []
    for (x0, y0), (x1, y1) in pairwise(ends):
        a, b = max(x0, low), min(x1, high)
        if b > a:
            pieces.append(Piece(x0, y0, x1, y1, straight=True).between(a, b))
    return pieces


def _apply(hedge: Hedge, pieces: list[Piece]) -> list[Piece]:
    for level in HEDGES[hedge.name].bends:
        pieces = [half for piece in pieces for half in _split_at_level(piece, level)]
    return [
        Piece(
            piece.x0,
            apply_hedge(hedge, piece.y0),
            piece.x1,
            apply_hedge(hedge, piece.y1),
            straight=piece.straight and (HEDGES[hedge.name].straight or piece.y0 == piece.y1),
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


def _smooth(
    shape: Shape, hedges: Sequence[Hedge], membership: SetFunction, low: float, high: float
) -> tuple[Piece, ...]:
    features = [x for x in bends(shape) if low < x < high]
    grid = [low + (high - low) * i / 16 for i in range(1, 16)]
    edges = sorted({low, high, *features, *grid})
    edges = sorted({*edges, *_turns(edges, membership)})
    if any(HEDGES[hedge.name].bends for hedge in hedges):
        edges = sorted({*edges, *_bent_by_hedges(shape, tuple(hedges), edges, low, high)})
    pieces = []
    for x0, x1 in pairwise(edges):
        y0, y1 = membership(math.nextafter(x0, x1)), membership(math.nextafter(x1, x0))
        pieces.append(Piece(x0, y0, x1, y1, straight=y0 == y1 == membership(0.5 * (x0 + x1))))
    return tuple(pieces)


def _turns(edges: list[float], membership: SetFunction) -> list[float]:
    """Find maxima and minima between the edges (golden section where samples show one)."""
    xs = sorted({a + (b - a) * i / 8 for a, b in pairwise(edges) for i in range(8)} | {edges[-1]})
    ys = [membership(x) for x in xs]
    turns = []
    for i in range(1, len(xs) - 1):
        sign = 1.0 if ys[i] > ys[i - 1] and ys[i] > ys[i + 1] else 0.0
        sign = -1.0 if ys[i] < ys[i - 1] and ys[i] < ys[i + 1] else sign
        if sign:
            turns.append(golden(membership, xs[i - 1], xs[i + 1], sign, xs[i]))
    return turns


def golden(function: SetFunction, a: float, b: float, sign: float, best: float) -> float:
    """Return the position of a function's maximum (sign 1) or minimum (-1), by golden section."""
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
    value = 0.5 * (a + b)
    return best if sign * function(best) >= sign * function(value) else value


def _bent_by_hedges(
    shape: Shape, hedges: tuple[Hedge, ...], edges: list[float], low: float, high: float
) -> list[float]:
    """Return the positions where the degree below a hedge passes a bend of the hedge."""
    values = []
    for depth, hedge in enumerate(hedges):
        for level in HEDGES[hedge.name].bends:
            below = term_function(shape, hedges[depth + 1 :])
            for a, b in pairwise(edges):
                if (below(a) - level) * (below(b) - level) < 0.0:
                    values.append(bisect(below, a, b, level))
    return [x for x in values if low < x < high]


def bisect(function: SetFunction, a: float, b: float, level: float) -> float:
    """Return the position where a monotone function passes `level` between `a` and `b`."""
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


def cut(
    pieces: Sequence[Piece], membership: SetFunction, level: float
) -> list[tuple[float, float]]:
    """Return the intervals where a set is at least `level`, in order, maybe adjacent."""
    intervals = []
    for piece in pieces:
        left, right = piece.y0 >= level, piece.y1 >= level
        if left and right:
            intervals.append((piece.x0, piece.x1))
        elif left or right:
            x = crossing(piece, membership, level)
            intervals.append((piece.x0, x) if left else (x, piece.x1))
    return intervals


def crossing(piece: Piece, membership: SetFunction, level: float) -> float:
    """Return the position where a piece passes `level`, a degree between its ends or at one.

    A curve has its peak at one point, even if neighbours round to the same degree.
    """
    if level in (piece.y0, piece.y1):
        return piece.x0 if level == piece.y0 else piece.x1
    if piece.straight:
        share = (level - piece.y0) / (piece.y1 - piece.y0)
        return piece.x0 + share * (piece.x1 - piece.x0)
    return bisect(
        membership, math.nextafter(piece.x0, piece.x1), math.nextafter(piece.x1, piece.x0), level
    )


BELOW_ONE = 1.0 - 2.0**-53


def plateaus(pieces: Sequence[Piece]) -> list[tuple[float, float]]:
    """Return the stretches over which a set is 1, without peaks that are so by rounding."""
    return [
        (piece.x0, piece.x1) for piece in pieces if piece.straight and piece.y0 == piece.y1 == 1.0
    ]


def middle_of_core(pieces: Sequence[Piece], membership: SetFunction) -> float:
    """Return the middle of the stretch where a set is greatest (its peak, equation 6.4).

    Of several equally high stretches, the middle from the first to the last.
    """
    intervals = cut(pieces, membership, peak(pieces))
    return 0.5 * (intervals[0][0] + intervals[-1][1])


# --- Where two clipped sets may cross ---
#
# Panels cut there leave nothing for the quadrature to search.
#
# Over a straight piece a set cut at the strength w is one of a few straight lines
# α + β μ(y): under min it is μ or w, under product w μ, under bounded μ + w − 1. Two sets
# cross where two of these lines do.

Forms = tuple[tuple[Any, Any], ...]
"""(α, β) for each line, floats or arrays."""


def cut_lines(implication: str, strength: Any) -> Forms | None:
    """Return the lines of a set cut at a strength; None if the implication may bend them."""
    lines = TNORMS[implication].lines
    return None if lines is None else lines(strength)


class Stretch(NamedTuple):
    """Two members, straight and not both zero, from `start` to `end`."""

    first: int
    second: int
    start: float
    end: float
    # Their memberships at its ends.
    first_start: float
    first_end: float
    second_start: float
    second_end: float


def stretches(profiles: Sequence[Sequence[Piece]]) -> tuple[Stretch, ...]:
    """Return the stretches over which two straight sets overlap."""
    result = []
    for i, pieces in enumerate(profiles):
        for j in range(i + 1, len(profiles)):
            for one in pieces:
                for other in profiles[j]:
                    start, end = max(one.x0, other.x0), min(one.x1, other.x1)
                    if start < end and _matters(one) and _matters(other):
                        ends = (*_between(one, start, end), *_between(other, start, end))
                        result.append(Stretch(i, j, start, end, *ends))
    return tuple(result)


def _matters(piece: Piece) -> bool:
    return piece.straight and (piece.y0 > 0.0 or piece.y1 > 0.0)


def _between(piece: Piece, start: float, end: float) -> tuple[float, float]:
    slope = (piece.y1 - piece.y0) / (piece.x1 - piece.x0)
    return piece.y0 + slope * (start - piece.x0), piece.y0 + slope * (end - piece.x0)
