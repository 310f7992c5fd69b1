"""Membership, norms and the exact centroid of straight sets as straight-line arithmetic."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, groupby, pairwise

from fuzzyarm.export.expression import (
    ONE,
    ZERO,
    Assign,
    Call,
    Expression,
    Function,
    Local,
    Number,
    Select,
    add,
    divide,
    greatest,
    least,
    subtract,
    times,
)
from fuzzyarm.export.numbers import ExportError
from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.inference.overlap import Layers
from fuzzyarm.inference.plan import OutputPlan
from fuzzyarm.inference.sets import Piece
from fuzzyarm.model.rulebase import Hedge, Term
from fuzzyarm.model.shapes import polyline

# --- Membership in straight terms, hedges and norms as straight-line arithmetic ---

Corner = tuple[float, float]

MOST_CORNERS = 100
"""Corners of a term: each is a comparison inside the one before (C compilers take 127)."""


def degree_of(term: Term, variable: str, x: Expression) -> Expression:
    """Return the membership of `x` in a straight term.

    Raises
    ------
    ExportError
        If the shape is not straight or not finite.
    """
    shape = term.shape
    if shape.kind == "singleton":
        return Select("==", x, Number(shape.parameters[0]), Number(shape.height), ZERO)
    if not SHAPES[shape.kind].straight:
        raise ExportError(
            f"the direct inference cannot be exported: term '{term.name}' of '{variable}' is"
            f" {shape.kind}, and only straight shapes do without a mathematical library",
            hint="leave out --direct to export a table",
        )
    corners = polyline(shape)
    if not all(math.isfinite(number) for corner in corners for number in corner):
        raise ExportError(
            f"the direct inference cannot be exported: term '{term.name}' of '{variable}' has a"
            " corner at infinity"
        )
    if len(corners) > MOST_CORNERS:
        raise ExportError(
            f"the direct inference cannot be exported: term '{term.name}' of '{variable}' has"
            f" {len(corners)} corners, and {MOST_CORNERS} are the most",
            hint="leave out --direct to export a table",
        )
    return _through(corners, x)


def _through(corners: Sequence[Corner], x: Expression) -> Expression:
    """Return lines through corners; on a vertical edge the greatest value holds."""
    places = [(place, [y for _, y in group]) for place, group in groupby(corners, lambda c: c[0])]
    expression: Expression = Number(places[-1][1][-1])
    for k in range(len(places) - 1, -1, -1):
        place, heights = places[k]
        left_end = heights[0]
        if k == 0:
            before: Expression = Number(left_end)
        else:
            x0, y0 = places[k - 1][0], places[k - 1][1][-1]
            before = _line(x, x0, y0, place, left_end)
        at = max(heights)
        # The corner itself belongs to the side that is as high as its highest point.
        if at in {left_end, heights[-1]}:
            closed = left_end == at and heights[-1] != at
            expression = Select("<=" if closed else "<", x, Number(place), before, expression)
        else:
            after = Select("==", x, Number(place), Number(at), expression)
            expression = Select("<", x, Number(place), before, after)
    return expression


def _line(x: Expression, x0: float, y0: float, x1: float, y1: float) -> Expression:
    if y0 == y1:
        return Number(y0)
    rise = abs(y1 - y0)
    # From the foot upwards, so that nothing is left of it at the foot and all at the top.
    foot = subtract(x, Number(x0)) if y1 > y0 else subtract(Number(x1), x)
    share = divide(foot, Number(x1 - x0))
    return add(Number(min(y0, y1)), times(share, Number(rise)))


# ── hedges ───────────────────────────────────────────────────────────────────────────

HALF, TWO = Number(0.5), Number(2.0)


def _intensified(d: Expression) -> Expression:
    rest = subtract(ONE, d)
    high = subtract(ONE, times(TWO, times(rest, rest)))
    return Select("<=", d, HALF, times(TWO, times(d, d)), high)


_HEDGES: dict[str, Callable[[Expression], Expression]] = {
    "not": lambda d: subtract(ONE, d),
    "very": lambda d: times(d, d),
    "extremely": lambda d: times(times(d, d), d),
    "any": lambda _: ONE,
    "intensify": _intensified,
}


def hedged(hedges: Sequence[Hedge], degree: Expression) -> Expression:
    """Return a degree under hedges, the last one acting first; it is best a variable.

    Raises
    ------
    ExportError
        For a hedge that takes a root or a power.
    """
    for hedge in reversed(hedges):
        if hedge.name not in _HEDGES:
            raise ExportError(
                f"the direct inference cannot be exported: hedge '{hedge.name}' needs a"
                " mathematical library",
                hint="leave out --direct to export a table",
            )
        degree = _HEDGES[hedge.name](degree)
    return degree


# ── norms ────────────────────────────────────────────────────────────────────────────


def _hamacher_t(a: Expression, b: Expression) -> Expression:
    product = times(a, b)
    value = divide(product, subtract(add(a, b), product))
    return Select(">", least(a, b), ZERO, value, ZERO)


def _hamacher_s(a: Expression, b: Expression) -> Expression:
    product = times(a, b)
    top = subtract(add(a, b), times(TWO, product))
    return Select(">=", product, ONE, ONE, divide(top, subtract(ONE, product)))


CONJUNCTIONS: dict[str, Callable[[Expression, Expression], Expression]] = {
    "min": least,
    "product": times,
    "bounded": lambda a, b: greatest(ZERO, subtract(add(a, b), ONE)),
    "drastic": lambda a, b: Select(">=", greatest(a, b), ONE, least(a, b), ZERO),
    "hamacher": _hamacher_t,
    "einstein": lambda a, b: divide(times(a, b), subtract(TWO, subtract(add(a, b), times(a, b)))),
    "nilpotent": lambda a, b: Select(">", add(a, b), ONE, least(a, b), ZERO),
}
"""T-norms by name."""

DISJUNCTIONS: dict[str, Callable[[Expression, Expression], Expression]] = {
    "max": greatest,
    "probor": lambda a, b: subtract(add(a, b), times(a, b)),
    "bounded": lambda a, b: least(ONE, add(a, b)),
    "drastic": lambda a, b: Select("<=", least(a, b), ZERO, greatest(a, b), ONE),
    "hamacher": _hamacher_s,
    "einstein": lambda a, b: divide(add(a, b), add(ONE, times(a, b))),
    "nilpotent": lambda a, b: Select("<", add(a, b), ONE, greatest(a, b), ONE),
    "sum": add,
    "normalized": lambda a, b: divide(add(a, b), greatest(ONE, add(a, b))),
}
"""S-norms and aggregations by name."""


# --- The exact centroid of clipped or scaled straight sets as straight-line arithmetic ---
#
# Clipped sets (implication min) have the closed form of `inference.overlap`:
# polynomials of the heights. Scaled sets (product) keep their shape: the area is the height
# times a constant, and where two of them overlap under `max` the integral of the smaller
# one is taken off, in two straight pieces that meet where the lines cross.

Fresh = Callable[[Expression, str], Expression]
"""Puts an expression into a new variable of that name and returns the variable."""

Part = tuple[Expression, Expression]
"""An area and a moment about the middle of the range."""

_HEIGHT = Local("h")


def layered(layers: Layers, height: Expression) -> Part:
    """Return area and moment of the polynomials at a height, as calls of shared functions."""
    area = [(each.start, each.depth, (each.a1, each.a2)) for each in layers]
    moment = [(each.start, each.depth, (each.b1, each.b2, each.b3)) for each in layers]
    return _polynomial("area", area, height), _polynomial("moment", moment, height)


def _polynomial(
    wanted: str,
    stretches: Sequence[tuple[float, float, tuple[float, ...]]],
    height: Expression,
) -> Expression:
    statements = []
    total: Expression = ZERO
    for k, (start, depth, coefficients) in enumerate(stretches):
        if not any(coefficients):
            continue
        name = f"x{k}"
        above = subtract(_HEIGHT, Number(start))
        # A height is never negative, so the first stretch needs no lower bound.
        inside = least(above, Number(depth))
        statements.append(Assign(name, inside if start == 0.0 else greatest(inside, ZERO)))
        value: Expression = Number(coefficients[-1])
        for coefficient in reversed(coefficients[:-1]):
            value = add(Number(coefficient), times(Local(name), value))
        total = add(total, times(Local(name), value))
    if total == ZERO:
        return ZERO
    return Call(Function(wanted, "h", tuple(statements), total), height)


def clipped_union(plan: OutputPlan, heights: dict[int, Expression]) -> Iterator[tuple[int, Part]]:
    """Yield (sign, part) of the union of sets clipped at `heights`."""
    form = plan.closed
    assert form is not None
    for member, height in heights.items():
        yield 1, layered(form.own[member], height)
    for member, others, layers in form.overlaps:
        above = [heights[other] for other in others if other in heights]
        if member in heights and above:
            highest = above[0]
            for other in above[1:]:
                highest = greatest(highest, other)
            yield -1, layered(layers, least(heights[member], highest))


def scaled(plan: OutputPlan, member: int, height: Expression) -> Part:
    """Return area and moment of one set scaled by `height`."""
    centre = _centre(plan)
    area = moment = 0.0
    for piece in plan.members[member].pieces:
        width, start = piece.x1 - piece.x0, piece.x0 - centre
        area += 0.5 * width * (piece.y0 + piece.y1)
        moment += width * (
            0.5 * start * (piece.y0 + piece.y1) + width * (piece.y0 / 6.0 + piece.y1 / 3.0)
        )
    return times(height, Number(area)), times(height, Number(moment))


def scaled_union(
    plan: OutputPlan, heights: dict[int, Expression], fresh: Fresh
) -> Iterator[tuple[int, Part]]:
    """Yield (sign, part) of the union of sets scaled by `heights`.

    Raises
    ------
    ExportError
        If more than two sets overlap anywhere.
    """
    for member, height in heights.items():
        yield 1, scaled(plan, member, height)
    edges = sorted({x for m in heights for p in plan.members[m].pieces for x in (p.x0, p.x1)})
    for x0, x1 in pairwise(edges):
        present = {}
        for member in heights:
            ends = _ends(plan.members[member].pieces, x0, x1)
            if max(ends) > 0.0:
                present[member] = ends
        if len(present) > 2:
            raise ExportError(
                f"the direct inference cannot be exported: three sets of '{plan.output.name}'"
                f" overlap at {0.5 * (x0 + x1):g} under implication product and aggregation max",
                hint="leave out --direct to export a table",
            )
        for first, second in combinations(present, 2):
            lines = (heights[first], present[first], heights[second], present[second])
            yield -1, _smaller_of_two(*lines, x0 - _centre(plan), x1 - x0, fresh)


def _centre(plan: OutputPlan) -> float:
    return 0.5 * (plan.output.low + plan.output.high)


def _ends(pieces: Sequence[Piece], x0: float, x1: float) -> tuple[float, float]:
    for piece in pieces:
        if piece.x0 <= x0 and x1 <= piece.x1:
            slope = (piece.y1 - piece.y0) / (piece.x1 - piece.x0)
            left = piece.y0 if x0 == piece.x0 else piece.y0 + slope * (x0 - piece.x0)
            right = piece.y1 if x1 == piece.x1 else piece.y0 + slope * (x1 - piece.x0)
            return left, right
    return 0.0, 0.0


def _smaller_of_two(
    first: Expression,
    first_ends: tuple[float, float],
    second: Expression,
    second_ends: tuple[float, float],
    start: float,
    width: float,
    fresh: Fresh,
) -> Part:
    p0, p1 = (fresh(times(first, Number(y)), "p") for y in first_ends)
    q0, q1 = (fresh(times(second, Number(y)), "q") for y in second_ends)
    d0, d1 = fresh(subtract(p0, q0), "d"), fresh(subtract(p1, q1), "d")
    crossing = divide(d0, subtract(d0, d1))
    s = fresh(Select("<", times(d0, d1), ZERO, crossing, ONE), "s")
    at_p = add(p0, times(s, subtract(p1, p0)))
    at_q = add(q0, times(s, subtract(q1, q0)))
    middle = fresh(least(at_p, at_q), "y")
    left, right = fresh(least(p0, q0), "y"), fresh(least(p1, q1), "y")
    near = fresh(times(Number(width), s), "w")
    far = fresh(subtract(Number(width), near), "w")
    place = add(Number(start), near)
    one = _trapezoid(Number(start), near, left, middle, fresh)
    two = _trapezoid(fresh(place, "x"), far, middle, right, fresh)
    return add(one[0], two[0]), add(one[1], two[1])


def _trapezoid(
    start: Expression, width: Expression, left: Expression, right: Expression, fresh: Fresh
) -> Part:
    mean = fresh(times(Number(0.5), add(left, right)), "m")
    lean = add(times(Number(1.0 / 6.0), left), times(Number(1.0 / 3.0), right))
    area = times(width, mean)
    moment = times(width, add(times(start, mean), times(width, lean)))
    return fresh(area, "a"), fresh(moment, "b")
