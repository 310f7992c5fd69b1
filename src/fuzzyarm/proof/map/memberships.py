"""Interval degrees: memberships over intervals, and norms and hedges of bounded degrees.

Norms rise with both operands and every built-in hedge is monotone, so ends of intervals map to
ends. All results are rounded outward by :data:`SLACK`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from fuzzyarm.inference.sets import formula_of
from fuzzyarm.language.model.rulebase import POSITION, Hedge, Is, RuleBase, Shape
from fuzzyarm.language.model.shapes import polyline
from fuzzyarm.proof.map.arithmetic import Array
from fuzzyarm.symbolic.evaluation import bounds, has_value, specialise
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES, TNORMS, Norm

SLACK = 4e-15
"""Relative widening of degrees for the rounding of norms."""

FAINT = 1e-90
"""Degrees below have no digits to spare once multiplied: bounds of them are 0 and this."""

PARTS = 4
"""Parts of an interval over which a curved membership is bounded."""

Interval = tuple[Array, Array]
"""Lower and upper bounds, one for each box."""

# ── norms and hedges ─────────────────────────────────────────────────────────────────


def widened(least: Array, most: Array) -> Interval:
    """Widen degrees for rounding; 0 stays 0."""
    least = np.where(least < FAINT, 0.0, least * (1.0 - SLACK))
    return least, np.where(most > 0.0, np.maximum(most * (1.0 + SLACK), FAINT), 0.0)


def joined(norm: Norm, one: Interval, other: Interval) -> Interval:
    """Return bounds of a norm of two degrees, which rises with both."""
    least, most = norm.array(one[0], other[0]), norm.array(one[1], other[1])
    if norm is TNORMS["bounded"]:  # the sum loses operands below its last bit
        least = np.maximum(least - SLACK, 0.0)
        most = np.maximum(one[1] + other[1] - 1.0 + SLACK, 0.0)
    if norm.positive:  # also where a product of floats is 0
        most = np.where((one[1] > 0.0) & (other[1] > 0.0), np.maximum(most, FAINT), most)
    return widened(least, most)


def hedged(hedges: Sequence[Hedge], degree: Interval) -> Interval:
    """Return bounds of hedged degrees: every built-in hedge is monotone."""
    for hedge in reversed(hedges):
        numbers = () if hedge.exponent is None else (hedge.exponent,)
        ends = [
            np.broadcast_to(HEDGES[hedge.name].array(np.clip(end, 0.0, 1.0), *numbers), end.shape)
            for end in degree
        ]
        least, most = np.minimum(*ends), np.maximum(*ends)
        degree = np.maximum(least - SLACK, 0.0), np.minimum(most + SLACK, 1.0)
    return degree


# ── memberships over intervals ───────────────────────────────────────────────────────


class Degrees:
    """Bounds of memberships over intervals, each computed once.

    The intervals of `others`, after those of `names`, differ from box to box and are not cached.
    """

    def __init__(
        self, rulebase: RuleBase, names: Sequence[str], others: Sequence[str] = ()
    ) -> None:
        self.rulebase = rulebase
        self.names = [*names, *others]
        self._others = set(others)
        self._bounds_by_term: dict[
            tuple[str, str], dict[tuple[float, float], tuple[float, float]]
        ] = {}

    def over(self, low: Array, high: Array) -> Callable[[Is], Interval]:
        """Return the function that bounds a proposition over boxes."""
        stretches: dict[int, tuple[list[tuple[float, float]], Array]] = {}
        bounds: dict[tuple[str, str], Interval] = {}
        columns = {name: i for i, name in enumerate(self.names)}
        for i in range(len(self.names) - len(self._others)):
            both = np.stack([low[:, i], high[:, i]], axis=1)
            distinct, back = np.unique(both, axis=0, return_inverse=True)
            pairs = [(float(a), float(b)) for a, b in distinct]
            stretches[i] = pairs, back.reshape(-1)

        def degree(part: Is) -> Interval:
            key = part.variable, part.term
            if key not in bounds:
                i = columns[part.variable]
                shape = self.rulebase.variable(part.variable).term(part.term).shape
                if part.variable in self._others:
                    bounds[key] = membership_over(shape, low[:, i], high[:, i])
                    return bounds[key]
                pairs, back = stretches[i]
                bounds_of_pairs = self._bounds_by_term.setdefault(key, {})
                of_stretch = membership_bounder(shape)
                for pair in pairs:
                    if pair not in bounds_of_pairs:
                        bounds_of_pairs[pair] = of_stretch(*pair)
                ends = np.array([bounds_of_pairs[pair] for pair in pairs])[back]
                bounds[key] = ends[:, 0], ends[:, 1]
            return bounds[key]

        return degree


def membership_bounder(shape: Shape) -> Callable[[float, float], tuple[float, float]]:
    """Return the function that bounds a membership over intervals."""
    if shape.kind != "formula" and SHAPES[shape.kind].straight:
        return _straight_bounder(shape)
    if shape.kind == "formula":
        expression, parts = formula_of(shape).with_constants((POSITION,)), 1
    else:
        record = SHAPES[shape.kind]
        numbers = dict(zip(record.symbols[1:], shape.parameters, strict=True))
        # Parts: an expression with x twice has wide bounds over a long interval.
        expression, parts = specialise(record.expression, numbers), PARTS

    def of_stretch(low: float, high: float) -> tuple[float, float]:
        cuts = [low + (high - low) * i / parts for i in range(parts)] + [high]
        intervals = [bounds(expression, {"x": pair}) for pair in pairwise(cuts)]
        least = shape.height * min(part.low for part in intervals)
        most = shape.height * max(part.high for part in intervals)
        if math.isnan(least + most):
            return 0.0, shape.height
        if shape.kind == "formula" and not has_value(expression, {"x": (low, high)}):
            least = min(0.0, least)  # its degree where undefined
        return max(0.0, least - SLACK), min(shape.height, most + SLACK)

    return of_stretch


def membership_over(shape: Shape, low: Array, high: Array) -> Interval:
    """Return the bounds of a membership over one interval per box."""
    if shape.kind == "formula" or not SHAPES[shape.kind].straight:
        of_stretch = membership_bounder(shape)
        ends = np.array([of_stretch(float(a), float(b)) for a, b in zip(low, high, strict=True)])
        return ends[:, 0], ends[:, 1]
    lines = SHAPES[shape.kind].lines(*shape.parameters, height=shape.height)
    least, most = (end(lines.over(low), lines.over(high)) for end in (np.minimum, np.maximum))
    for x, y in polyline(shape):
        inside = (low <= x) & (x <= high)
        least = np.where(inside, np.minimum(least, y), least)
        most = np.where(inside, np.maximum(most, y), most)
    return np.maximum(least - SLACK, 0.0), np.where(most > 0.0, most + SLACK, 0.0)


def _straight_bounder(shape: Shape) -> Callable[[float, float], tuple[float, float]]:
    lines = SHAPES[shape.kind].lines(*shape.parameters, height=shape.height)
    corners = polyline(shape)

    def of_stretch(low: float, high: float) -> tuple[float, float]:
        inside = [y for x, y in corners if low <= x <= high]
        values = [lines.at(low), lines.at(high), *inside]
        least, most = min(values), max(values)
        return max(0.0, least - SLACK), (most and most + SLACK)

    return of_stretch
