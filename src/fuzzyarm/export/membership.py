"""Membership in straight terms, hedges and norms as straight-line arithmetic."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import groupby

from fuzzyarm.export.errors import ExportError
from fuzzyarm.export.expression import (
    ONE,
    ZERO,
    Expression,
    Number,
    Select,
    add,
    divide,
    greatest,
    least,
    subtract,
    times,
)
from fuzzyarm.inference.profile import polyline
from fuzzyarm.rulebase.model import Hedge, Term
from fuzzyarm.rulebase.shapes import SHAPES

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
    if not SHAPES[shape.kind].piecewise_linear:
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
