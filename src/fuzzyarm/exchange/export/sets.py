"""The terms and sets of a rule base as expressions: degrees, and exact areas of straight sets.

Straight terms are the lines of :mod:`fuzzyarm.symbolic.lines`, curved ones and formulas the
expressions of their records with the numbers of the term in place. Products with zero and one are
folded here: many coefficients are zero or one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations, pairwise

from fuzzyarm.base.diagnostic import NOWHERE, Span
from fuzzyarm.exchange.export.numbers import ExportError
from fuzzyarm.inference.overlap import Layers
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.sets import degree_formula
from fuzzyarm.language.model.rulebase import POSITION, Hedge, Term
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.evaluation import specialise
from fuzzyarm.symbolic.formulas import FormulaError
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES
from fuzzyarm.symbolic.lines import StraightLine, StraightShape
from fuzzyarm.symbolic.nodes import (
    Constant,
    Node,
    Number,
    apply,
    constant,
    rebuilt,
    replace,
    symbol,
)

ZERO, ONE = constant(0.0), constant(1.0)

TABLE_HINT = "--table makes a table of it"


def refuse(obstacle: str, at: Span = NOWHERE, instead: str = "") -> ExportError:
    """Return the error about an obstacle to export, with its position and an alternative."""
    hint = f"{instead}, or {TABLE_HINT}" if instead else TABLE_HINT
    return ExportError(f"the direct inference cannot be exported: {obstacle}", hint=hint, span=at)


# ── arithmetic that folds zero and one ───────────────────────────────────────────────


def is_number(node: Node, value: float) -> bool:
    """Return whether an expression is this very number."""
    return isinstance(node, Constant) and node.value == value


def plus(a: Node, b: Node) -> Node:
    """Return a + b."""
    return b if is_number(a, 0.0) else a if is_number(b, 0.0) else a + b


def minus(a: Node, b: Node) -> Node:
    """Return a − b."""
    return a if is_number(b, 0.0) else a - b


def times(a: Node, b: Number) -> Node:
    """Return a b."""
    b = b if isinstance(b, Node) else constant(b)
    if is_number(a, 0.0) or is_number(b, 0.0):
        return ZERO
    return b if is_number(a, 1.0) else a if is_number(b, 1.0) else a * b


def with_ends(root: Node, low: float, high: float) -> Node:
    """Return an expression with two numbers in place of the infinite ones."""

    def finite(node: Node, new: Node) -> Node:
        if isinstance(node, Constant) and math.isinf(node.value):
            return constant(high if node.value > 0.0 else low)
        return new

    return rebuilt(root, finite)


def where(condition: Node, then: Number, otherwise: Number) -> Node:
    """Return the choice between two values."""
    return apply("where", condition, then, otherwise)


# ── degrees ──────────────────────────────────────────────────────────────────────────

MOST_CORNERS = 100
"""Corners of a term: each is a comparison inside the one before (C compilers take 127)."""


def degree_of(term: Term, variable: str, x: Node) -> Node:
    """Return the degree of `x` in a term of an input, or of an output that rules read."""
    shape = term.shape
    if shape.kind == "formula":
        return times(_formula_of_x(term, variable, x), shape.height)
    kind = SHAPES[shape.kind]
    if kind.straight:
        lines = kind.lines(*shape.parameters, height=shape.height)
        if len(lines.edges) > MOST_CORNERS:
            raise refuse(
                f"term '{term.name}' of '{variable}' has {len(lines.edges)} corners, and"
                f" {MOST_CORNERS} are the most",
                term.span,
                "give it fewer corners",
            )
        return _on_lines(lines, x)
    if kind.function is None:
        obstacle = f"term '{term.name}' of '{variable}' has no degrees that C could compute"
        raise refuse(obstacle, term.span)
    numbers = dict(zip(kind.symbols[1:], shape.parameters, strict=True))
    degree = replace(specialise(kind.expression, numbers), {kind.symbols[0]: x})
    return times(degree, shape.height)


def _formula_of_x(term: Term, variable: str, x: Node) -> Node:
    try:
        return replace(degree_formula(term.shape), {POSITION: x})
    except FormulaError:
        obstacle = f"term '{term.name}' of '{variable}' is a formula of several"
        raise refuse(obstacle, term.span) from None


def _on_lines(lines: StraightShape, x: Node) -> Node:
    """Return the degree on lines through corners, each rounding as in every engine."""
    degree = _on_line(lines.between[-1], x)
    for i in range(len(lines.edges) - 1, -1, -1):
        edge, height = constant(lines.edges[i]), lines.heights[i]
        before = _on_line(lines.between[i], x)
        # A corner belongs to the side with its degree; if neither has it, it is separate.
        if lines.between[i + 1].at(lines.edges[i]) == height:
            degree = degree if before is degree else where(x < edge, before, degree)
        elif lines.between[i].at(lines.edges[i]) == height:
            degree = where(x <= edge, before, degree)
        else:
            degree = where(x < edge, before, where(op.equal(x, edge), height, degree))
    return degree


def _on_line(line: StraightLine, x: Node) -> Node:
    """Return a line; from its foot it cannot fall below 0, elsewhere rounding may."""
    if line.slope == 0.0:
        return constant(line.height)
    value = plus(constant(line.height), times(minus(x, constant(line.x_0)), line.slope))
    return value if line.height == 0.0 else op.maximum(0.0, value)


def hedged(hedges: Sequence[Hedge], degree: Node) -> Node:
    """Return a degree under hedges, the last one acting first."""
    for hedge in reversed(hedges):
        kind = HEDGES[hedge.name]
        numbers = () if hedge.exponent is None else (hedge.exponent,)
        values: dict[str, Number] = dict(zip(kind.symbols, (degree, *numbers), strict=True))
        degree = replace(kind.expression, values)
    return degree


# ── the exact area and moment of clipped or scaled straight sets ─────────────────────
#
# Clipped sets (implication min) have the closed form of `inference.overlap`: polynomials of
# the heights. Scaled sets (product) keep their shape: the area is the height times a
# constant, and where two of them overlap under `max` the integral of the smaller one is
# taken off, in two straight pieces that meet where the lines cross.

Fresh = Callable[[Node, str], Node]
"""Names an expression, so that it is computed once, into a variable."""

Call = Callable[[str, Node, Node], Node]
"""Applies a function of ``h``, given as an expression, to a height; the name is for C."""

Part = tuple[Node, Node]
"""An area, and a moment about the middle of the range."""

Heights = Mapping[int, Node]
"""The firing strength of each member."""


def clipped(layers: Layers, height: Node, call: Call) -> Iterator[Part]:
    """Yield area and moment of each layer of the closed form at a height."""
    for start, depth, a1, a2, *b in layers:
        x = op.minimum(minus(symbol("h"), constant(start)), depth)
        if start != 0.0:  # a height is never negative: the first layer needs no lower bound
            x = op.maximum(x, 0.0)
        yield (
            call("area", _polynomial(x, (a1, a2)), height),
            call("moment", _polynomial(x, b), height),
        )


def _polynomial(x: Node, coefficients: Sequence[float]) -> Node:
    """Return c1 x + c2 x² + …."""
    if not any(coefficients):
        return ZERO
    value: Node = constant(coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        value = plus(constant(coefficient), times(x, value))
    return times(x, value)


def clipped_union(plan: OutputPlan, heights: Heights, call: Call) -> Iterator[tuple[int, Part]]:
    """Yield (sign, part) of the union of sets clipped at `heights`, layer by layer."""
    form = plan.closed
    assert form is not None
    for member, height in heights.items():
        for part in clipped(form.set_layers[member], height, call):
            yield 1, part
    for member, others, layers in form.overlaps:
        above = [heights[other] for other in others if other in heights]
        if member in heights and above:
            highest = above[0]
            for other in above[1:]:
                highest = op.maximum(highest, other)
            for part in clipped(layers, op.minimum(heights[member], highest), call):
                yield -1, part


def scaled(plan: OutputPlan, member: int, height: Node) -> Part:
    """Return area and moment of one set scaled by `height`."""
    centre = _centre(plan)
    area = moment = 0.0
    for piece in plan.members[member].pieces:
        width, start = piece.x1 - piece.x0, piece.x0 - centre
        area += 0.5 * width * (piece.y0 + piece.y1)
        moment += width * (
            0.5 * start * (piece.y0 + piece.y1) + width * (piece.y0 / 6.0 + piece.y1 / 3.0)
        )
    return times(height, area), times(height, moment)


def scaled_union(plan: OutputPlan, heights: Heights, fresh: Fresh) -> Iterator[tuple[int, Part]]:
    """Yield (sign, part) of the union of sets scaled by `heights`; at most two may overlap."""
    for member, height in heights.items():
        yield 1, scaled(plan, member, height)
    edges = sorted({x for m in heights for p in plan.members[m].pieces for x in (p.x0, p.x1)})
    for x0, x1 in pairwise(edges):
        present = {}
        for member in heights:
            ends = _ends(plan.members[member], x0, x1)
            if max(ends) > 0.0:
                present[member] = ends
        for first, second in combinations(present, 2):
            lines = (heights[first], present[first], heights[second], present[second])
            yield -1, _smaller_of_two(*lines, x0 - _centre(plan), x1 - x0, fresh)


def most_overlapping(plan: OutputPlan) -> int:
    """Return the greatest number of overlapping sets of one side."""
    most = 0
    sides = plan.sides or (0,) * len(plan.members)
    for side in {*sides}:
        members = [i for i, side_of_member in enumerate(sides) if side_of_member == side]
        edges = sorted({x for m in members for p in plan.members[m].pieces for x in (p.x0, p.x1)})
        for x0, x1 in pairwise(edges):
            present = [m for m in members if max(_ends(plan.members[m], x0, x1)) > 0.0]
            most = max(most, len(present))
    return most


def _centre(plan: OutputPlan) -> float:
    return 0.5 * (plan.output.low + plan.output.high)


def _ends(member: Member, x0: float, x1: float) -> tuple[float, float]:
    """Return the degrees of a set at the ends of a stretch within one of its pieces."""
    for piece in member.pieces:
        if piece.x0 <= x0 and x1 <= piece.x1:
            part = piece.between(x0, x1)
            return part.y0, part.y1
    return 0.0, 0.0


def _smaller_of_two(
    first: Node,
    first_ends: tuple[float, float],
    second: Node,
    second_ends: tuple[float, float],
    start: float,
    width: float,
    fresh: Fresh,
) -> Part:
    """Return the integral of the smaller of two scaled lines over a stretch."""
    p0, p1 = (fresh(times(first, y), "p") for y in first_ends)
    q0, q1 = (fresh(times(second, y), "q") for y in second_ends)
    d0, d1 = fresh(minus(p0, q0), "d"), fresh(minus(p1, q1), "d")
    # The share of the width up to the crossing; 1 without one.
    s = fresh(where(times(d0, d1) < 0.0, d0 / minus(d0, d1), 1.0), "s")
    at_p = plus(p0, times(s, minus(p1, p0)))
    at_q = plus(q0, times(s, minus(q1, q0)))
    middle = fresh(op.minimum(at_p, at_q), "y")
    left, right = fresh(op.minimum(p0, q0), "y"), fresh(op.minimum(p1, q1), "y")
    near = fresh(times(constant(width), s), "w")
    far = fresh(constant(width) - near, "w")
    crossing = fresh(plus(constant(start), near), "x")
    one = _trapezoid(constant(start), near, left, middle, fresh)
    two = _trapezoid(crossing, far, middle, right, fresh)
    return plus(one[0], two[0]), plus(one[1], two[1])


def _trapezoid(start: Node, width: Node, left: Node, right: Node, fresh: Fresh) -> Part:
    mean = fresh(times(constant(0.5), plus(left, right)), "m")
    lean = plus(times(constant(1.0 / 6.0), left), times(constant(1.0 / 3.0), right))
    area = times(width, mean)
    moment = times(width, plus(times(start, mean), times(width, lean)))
    return fresh(area, "a"), fresh(moment, "b")
