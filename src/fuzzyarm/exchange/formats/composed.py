"""Sets composed of other sets by norms: as one shape, or as straight lines.

IEEE 1855 defines such terms (``circularDefinition``). min, max and the bounded norms of
piecewise-linear sets are piecewise linear, with exact corners; all others are sampled.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from fuzzyarm.exchange.formats.recovery import joined, shape_of, straight_shape
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.language.model.shapes import bends, membership_function
from fuzzyarm.symbolic.kinds import SHAPES, SNORMS, TNORMS

Degree = Callable[[float], float]

POINTS = 1001
"""Samples of a composed set without a matching shape."""

_STRAIGHT = frozenset({"min", "max", "bounded"})
"""Norms under which piecewise-linear sets stay piecewise linear."""


def norm_of(name: str, sets: Sequence[Degree]) -> Degree:
    """Return the degree of sets, joined in order, under the norm ``t:NAME`` or ``s:NAME``."""
    kinds, _, word = name.partition(":")
    norm = (TNORMS if kinds == "t" else SNORMS)[word].scalar

    def joint(x: float) -> float:
        first, *others = (degree(x) for degree in sets)
        for other in others:
            first = min(1.0, max(0.0, norm(first, other)))
        return first

    return joint


def composed(
    degree: Degree, parts: Sequence[Shape], norms: Sequence[str], low: float, high: float
) -> tuple[Shape, bool]:
    """Return the shape of a composed set, and whether it is exact."""
    straight = all(SHAPES[part.kind].straight for part in parts)
    recovered = shape_of(degree, low, high)
    if recovered is not None:
        # Recovered from even samples, which may straddle a narrow part of the set.
        xs = _samples(_ends(parts, low, high)) if straight else []
        if all(abs(_degree(recovered, x) - degree(x)) <= 1e-9 for x in xs):
            return recovered, True
    if straight and {norm.partition(":")[2] for norm in norms} <= _STRAIGHT:
        xs = _corners(degree, parts, low, high)
        lines = straight_shape(joined(xs, [degree(x) for x in xs]))
        positions = _samples([low - (high - low), *xs, high + (high - low)])
        for shape in (lines, *_closed(lines, low, high)):
            if all(abs(_degree(shape, x) - degree(x)) <= 1e-9 for x in positions):
                return shape, True
    xs = [low + (high - low) * i / (POINTS - 1) for i in range(POINTS)]
    return joined(xs, [degree(x) for x in xs]), False


def _corners(degree: Degree, parts: Sequence[Shape], low: float, high: float) -> list[float]:
    """Return the corners of a composed set: those of its parts and the crossings in between."""
    xs = _ends(parts, low, high)
    values = set(xs)
    for a, b in pairwise(xs):
        values |= set(_bends_between(degree, a, b, 4))
    return sorted(values)


def _ends(parts: Sequence[Shape], low: float, high: float) -> list[float]:
    return sorted({low, high, *(x for part in parts for x in bends(part) if low < x < high)})


def _bends_between(degree: Degree, a: float, b: float, most: int) -> list[float]:
    """Return the corners inside an interval: the crossing of its end lines, then recursively."""
    step = 1e-6 * (b - a)
    if not a < a + step < b - step < b:  # no floats to spare inside
        return []
    first, last = degree(a + step), degree(b - step)
    rise = (degree(a + 2.0 * step) - first) / step
    fall = (last - degree(b - 2.0 * step)) / step
    if most == 0 or abs(rise - fall) * (b - a) <= 1e-9:
        return []
    # first + rise (x - a - step) = last + fall (x - b + step)
    x = (last - first + rise * (a + step) - fall * (b - step)) / (rise - fall)
    if not a + step < x < b - step:
        return []
    left, right = _bends_between(degree, a, x, most - 1), _bends_between(degree, x, b, most - 1)
    return [*left, x, *right]


def _samples(xs: Sequence[float]) -> list[float]:
    return [a + share * (b - a) for a, b in pairwise(xs) for share in (0.2, 0.5, 0.8)]


def _closed(shape: Shape, low: float, high: float) -> list[Shape]:
    """Extend a ramp by the ends of the range."""
    if shape.kind != "ramp":
        return []
    foot, top = shape.parameters
    corners = (foot, top, high, high) if foot < top else (low, low, top, foot)
    return [Shape("trapezoid", corners, shape.height)]


def _degree(shape: Shape, x: float) -> float:
    return membership_function(shape)(x)
