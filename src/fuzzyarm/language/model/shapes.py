"""Terms as sets: membership, hedges, corners, centre; the truth of an antecedent.

The computation and the properties of each kind are in its record (:mod:`fuzzyarm.symbolic.kinds`);
here the records meet the numbers of a model. One point at a time, in plain Python: checks,
expectations and traces would wait longer for an array library than for the answer.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from fuzzyarm.language.model.rulebase import (
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    RuleBlock,
    Shape,
    Variable,
)
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES, SNORMS, TNORMS
from fuzzyarm.symbolic.lines import StraightLine, StraightShape
from fuzzyarm.symbolic.shapes import parameters_and_middles

if TYPE_CHECKING:
    from fractions import Fraction

EVEN_SHAPES: dict[str, str] = {
    "triangles": "each foot under its neighbour's peak",
    "gaussians": "neighbours cross at one half",
    "singletons": "evenly spaced values of an output",
}
"""The families that ``terms`` can spread evenly over a range."""


# ── membership ───────────────────────────────────────────────────────────────────────


def membership(shape: Shape, x: float) -> float:
    """Return the membership of `x` in `shape`.

    Parameters
    ----------
    shape : Shape
        A fuzzy shape; ``linear`` and ``formula`` have no membership.
    x : float
        Any number.

    Returns
    -------
    float
        Between 0 and the height of the shape.
    """
    return membership_function(shape)(x)


def membership_function(shape: Shape) -> Callable[[float], float]:
    """Return :func:`membership` of `shape` as a function of x, for many calls."""
    kind, height = SHAPES[shape.kind], shape.height
    if kind.straight:
        return kind.lines(*shape.parameters, height=height).at
    degree = kind.at(*shape.parameters)
    return lambda x: height * degree(x)


def apply_hedge(hedge: Hedge, degree: float) -> float:
    """Return `degree` as modified by `hedge`."""
    numbers = () if hedge.exponent is None else (hedge.exponent,)
    return HEDGES[hedge.name].scalar(degree, *numbers)


def apply_hedges(hedges: Sequence[Hedge], degree: float) -> float:
    """Return `degree` as modified by `hedges`, applied from last to first."""
    for hedge in reversed(hedges):
        degree = apply_hedge(hedge, degree)
    return degree


Degree = Callable[[str, str], float]
"""Membership of the present value of a variable in one of its terms, by their names."""


def truth(expression: Expression, degree: Degree, block: RuleBlock) -> float:
    """Return the truth of `expression`, 0 to 1, by the norms of `block`.

    Parameters
    ----------
    expression : Expression
        An antecedent.
    degree : callable
        ``degree(variable, term)`` returns the membership.
    block : RuleBlock
        Names the conjunction and the disjunction.
    """
    if isinstance(expression, Is):
        return apply_hedges(expression.hedges, degree(expression.variable, expression.term))
    if isinstance(expression, Hedged):
        return apply_hedges(expression.hedges, truth(expression.operand, degree, block))
    norms = SNORMS[block.disjunction] if isinstance(expression, Or) else TNORMS[block.conjunction]
    result, *rest = (truth(operand, degree, block) for operand in expression.operands)
    for value in rest:
        result = norms.scalar(result, value)
    return result


# ── where a shape changes, and where its middle is ───────────────────────────────────


def polyline(shape: Shape) -> list[tuple[float, float]]:
    """Return the corners of a straight shape, left to right.

    Parameters
    ----------
    shape : Shape
        Of a piecewise linear kind.

    Returns
    -------
    list of (float, float)
        A vertical edge is two corners at one x; the first and the last value go on to
        infinity. Values include the height.
    """
    corners_of = SHAPES[shape.kind].corners
    assert corners_of is not None
    return [(x, shape.height * y) for x, y in corners_of(*shape.parameters)]


def straight_lines(shape: Shape, hedges: Sequence[Hedge] = ()) -> StraightShape | None:
    """Return a term under hedges as lines with bitwise equal degrees; None without such lines.

    A level line stays level under any hedge. ``not`` reverses a line from its foot, because 1 − (0
    + d) and (1 − 0) − d round alike; other slopes are bent, or rounded twice.

    Parameters
    ----------
    shape : Shape
        Of any kind.
    hedges : sequence of Hedge
        The last acts first.
    """
    kind = SHAPES[shape.kind]
    if not kind.straight:
        return None
    lines = kind.lines(*shape.parameters, height=shape.height)
    for hedge in reversed(hedges):
        between = [_hedged_line(hedge, line) for line in lines.between]
        if None in between:
            return None
        heights = tuple(apply_hedge(hedge, height) for height in lines.heights)
        lines = StraightShape(lines.edges, heights, tuple(line for line in between if line))
    return lines


def _hedged_line(hedge: Hedge, line: StraightLine) -> StraightLine | None:
    if hedge.name == "any" or line.slope == 0.0:
        return StraightLine(apply_hedge(hedge, line.height), 0.0, 0.0)
    if hedge.name == "not" and line.height == 0.0:
        return StraightLine(1.0, line.x_0, -line.slope)
    return None


def bends(shape: Shape) -> Sequence[float]:
    """Return the positions between which a curved shape is smooth, and some on its flanks."""
    bends_of = SHAPES[shape.kind].bends or parameters_and_middles
    return bends_of(*shape.parameters)


def corner_points(shape: Shape) -> tuple[float, ...]:
    """Return the finite numbers on the axis at which `shape` may start, end or turn."""
    turns = SHAPES[shape.kind].turns
    positions = shape.parameters if turns is None else turns(*shape.parameters)
    return tuple(x for x in positions if math.isfinite(x))


def centre(shape: Shape, low: float, high: float) -> float | None:
    """Return the middle of a fuzzy shape within `low` … `high`; None for values.

    For a shape without its own middle (ramps, sigmoids, …) it is the middle of the
    stretch where the membership is largest.
    """
    kind = SHAPES[shape.kind]
    if not kind.fuzzy:
        return None
    if kind.centre is not None:
        middle = float(kind.centre(*shape.parameters))
        if math.isfinite(middle):
            return min(high, max(low, middle))
    if not (math.isfinite(low) and math.isfinite(high)):
        return None
    samples = [low + (high - low) * i / 200 for i in range(201)]
    degrees = list(map(membership_function(shape), samples))
    top = max(degrees)
    best = [x for x, degree in zip(samples, degrees, strict=True) if degree >= top - 1e-9]
    return 0.5 * (best[0] + best[-1])


def corners(variable: Variable) -> list[float]:
    """Return, in increasing order, the ends of the range and where terms start, end or turn."""
    values = {x for term in variable.terms for x in corner_points(term.shape)}
    low = variable.low if math.isfinite(variable.low) else min(values, default=0.0) - 1.0
    high = variable.high if math.isfinite(variable.high) else max(values, default=0.0) + 1.0
    # A curved term has no corners.
    if any(not SHAPES[term.shape.kind].straight for term in variable.terms):
        values |= {low + (high - low) * i / 64 for i in range(65)}
    return sorted({low, high} | {x for x in values if low < x < high})


CLOSE = 1e-12
"""Degrees closer than this are the same: decimals of a file are rounded."""

CURVED_SAMPLES = 1_001
"""Positions at which curved shapes are compared."""


def first_above(lower: Shape, upper: Shape, low: float, high: float) -> float | None:
    """Return a position from `low` to `high` where `lower` is above `upper`; None if nowhere.

    Piecewise linear shapes are compared at all their corners, from both sides, in rational numbers:
    a proof. Curved ones are compared as in :func:`first_sample_above`.
    """
    features = {x for shape in (lower, upper) for x in corner_points(shape)}
    one, other = membership_function(lower), membership_function(upper)
    if not (SHAPES[lower.kind].straight and SHAPES[upper.kind].straight):
        features |= {x for curve in (lower, upper) for x in bends(curve) if math.isfinite(x)}
        return first_sample_above(one, other, low, high, features)
    start, end = _finite(low, high, features)
    from fractions import Fraction

    bottom, top, allowed = polyline(lower), polyline(upper), Fraction(CLOSE)
    # Both are linear between two corners, so the largest gap is at one of them.
    for x in sorted({x for x in features if start < x < end} | {start, end}):
        sides = [side for side in (-1, 1) if (x > start if side < 0 else x < end)]
        if any(_beside(bottom, x, s) > _beside(top, x, s) + allowed for s in sides):
            return x
        if one(x) > other(x) + CLOSE:
            return x
    return None


def first_sample_above(
    one: Callable[[float], float],
    other: Callable[[float], float],
    low: float,
    high: float,
    features: Collection[float] = (),
) -> float | None:
    """Return a position where `one` is above `other`: of :data:`CURVED_SAMPLES`, and `features`."""
    start, end = _finite(low, high, features)
    step = (end - start) / (CURVED_SAMPLES - 1)
    positions = {start + i * step for i in range(CURVED_SAMPLES)}
    positions |= {x for x in features if start < x < end}
    return next((x for x in sorted(positions) if one(x) > other(x) + CLOSE), None)


def _finite(low: float, high: float, features: Collection[float]) -> tuple[float, float]:
    """Return a range; an infinite end is replaced by a value beyond all features."""
    positions = [x for x in (low, high, *features) if math.isfinite(x)] or [0.0]
    width = 1.0 + max(positions) - min(positions)
    start = low if math.isfinite(low) else min(positions) - width
    return start, high if math.isfinite(high) else max(positions) + width


def _beside(line: Sequence[tuple[float, float]], x: float, side: int) -> Fraction:
    """Return the height of a line through corners just left (side -1) or right of `x`, exactly."""
    from fractions import Fraction

    before = [c for c in line if (c[0] < x if side < 0 else c[0] <= x)]
    after = [c for c in line if (c[0] >= x if side < 0 else c[0] > x)]
    if not before or not after:
        return Fraction((before[-1] if before else after[0])[1])
    (x0, y0), (x1, y1) = before[-1], after[0]
    if y0 == y1 or math.isinf(x0) or math.isinf(x1):
        return Fraction(y1 if math.isinf(x0) else y0)
    run = Fraction(x1) - Fraction(x0)
    return Fraction(y0) + (Fraction(y1) - Fraction(y0)) * (Fraction(x) - Fraction(x0)) / run


def probe_points(variable: Variable) -> list[float]:
    """Return the corners and the middles between them, in increasing order.

    Between two corners no bounded term starts or ends, so the midpoint represents the interval.
    """
    values = corners(variable)
    return sorted({*values, *(0.5 * (a + b) for a, b in pairwise(values))})
