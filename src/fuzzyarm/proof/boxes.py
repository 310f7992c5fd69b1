"""Bounds over boxes of the inputs: for every rule base that is not made of straight pieces.

Over a box every membership lies in an interval (of the polyline, or of the expression of its
shape), so does every firing strength (norms and hedges are monotone), and the centroid lies
between the two that Karnik and Mendel give for the lower and the upper aggregate. Boxes are
halved until what cannot be decided is gone. The bounds are first order in the size of a box:
sound, and slow where the output has a plateau.

Source: R. E. Moore, *Interval Analysis*, 1966.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise, product
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.expression.evaluation import bounds, specialise
from fuzzyarm.expression.kinds import HEDGES, SHAPES, SNORMS, TNORMS, Norm
from fuzzyarm.inference.aggregate import sample_positions, sampled_set, weights
from fuzzyarm.inference.centroid_bounds import average_bounds, centroid_bounds
from fuzzyarm.inference.plan import Member, OutputPlan, Plan, PlannedRule, needed, plan
from fuzzyarm.inference.sets import formula_of
from fuzzyarm.model.rulebase import And, Expression, Hedge, Hedged, Is, RuleBase, Shape
from fuzzyarm.model.shapes import corners as corners_of_variable
from fuzzyarm.model.shapes import polyline
from fuzzyarm.proof.arithmetic import Array, Stop
from fuzzyarm.proof.bounds import WIDENED, Bounds, UnprovableError

__all__ = ["Boxes"]

COARSE = 1e-3
"""Share of the range of the output to which boxes are refined where nothing else is said."""

PANELS = 160
"""Stretches of an output on which its aggregate lies between two straight lines."""

LEVEL_PANELS = 800
"""The same where the lines are level."""

SLACK = 4e-15
"""Share by which degrees are widened for the rounding of norms."""

MOST = 3_000_000
"""Boxes looked at before the search is given up."""

AT_ONCE = 200_000
"""Numbers of the aggregates of the boxes that are looked at together: they fit into the cache."""

PARTS = 4
"""Parts of a stretch over which a curved membership is bounded."""

Interval = tuple[Array, Array]

Valued = tuple[Array, Array, Array]
"""Bounds of a value, NaN where there is none in a box, and where there may be none."""


class _Found(NamedTuple):
    """What a search over boxes found: bound, what was reached and where."""

    bound: float
    reached: float
    at: dict[str, float]
    boxes: int
    complete: bool


class Boxes:
    """Proves bounds of one output over a box of the inputs.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    output : str
        Which output.
    ends : sequence of (float, float)
        The box.
    stop : Stop
        When to give up.

    Raises
    ------
    UnprovableError
        If something in the rule base has no bounds over boxes; the message names it.
    """

    def __init__(
        self, rulebase: RuleBase, output: str, ends: Sequence[tuple[float, float]], stop: Stop
    ) -> None:
        self.rulebase = rulebase
        self.plan: Plan = plan(rulebase)
        self.output: OutputPlan = self.plan.outputs[output]
        self.ends = ends
        self.stop = stop
        self.names = [variable.name for variable in rulebase.inputs]
        self._demand_covered()
        self._bare = replace(
            rulebase,
            outputs=tuple(
                replace(
                    each,
                    no_rule=each.no_rule if isinstance(each.no_rule, float | int) else math.nan,
                    outside="extend" if each.outside == "error" else each.outside,
                )
                for each in rulebase.outputs
            ),
        )
        self._degrees = _Degrees(rulebase, self.names)
        self._bounds_of = self._chosen_bounds()
        width = getattr(self._bounds_of, "width", len(self.output.members))
        self.chunk = max(16, AT_ONCE // width)
        self.tried = 16 if self.output.integrated else 256  # boxes at whose corners it is evaluated
        low, high = self.output.output.low, self.output.output.high
        self.range = high - low if math.isfinite(high - low) else 1.0

    def over(self, ends: Sequence[tuple[float, float]], stop: Stop) -> Boxes:
        """Return the same over another box: what is known of sets and terms stays known."""
        other = copy(self)
        other.ends, other.stop = ends, stop
        return other

    # ── questions ────────────────────────────────────────────────────────────────────

    def value(self, gap: float) -> Bounds:
        """Return bounds of the output."""
        return self._both(self._value_bounds, self._values, gap, [[] for _ in self.names])

    def at_most(self, bound: float, *, negated: bool) -> tuple[bool, int]:
        """Tell whether the output (or minus the output) is at most a bound; False: unknown."""

        def over(low: Array, high: Array) -> Interval:
            a, b = self._value_bounds(low, high)
            return (-b, -a) if negated else (a, b)

        found = self._search(over, None, 0.0, [[] for _ in self.names], least=bound)
        return found.complete, found.boxes

    def table(self, table: Any, mode: str, gap: float) -> Bounds:
        """Return bounds of what a table is above the output, with the sign of the output's."""
        axes = {axis.name: axis for axis in table.axes}
        positions = [
            list(axes[name].levels if mode == "linear" else axes[name].thresholds(mode))
            for name in self.names
        ]
        order = [self.names.index(axis.name) for axis in table.axes]

        def over(low: Array, high: Array) -> Interval:
            least, most = self._value_bounds(low, high)
            if mode == "linear":  # multilinear between levels: extremes at corners
                corners = [
                    table.lookup(
                        *(np.where(side[i], high[:, i], low[:, i]) for i in order), mode=mode
                    )
                    for side in product((False, True), repeat=len(self.names))
                ]
            else:
                middle = 0.5 * (low + high)
                corners = [table.lookup(*(middle[:, i] for i in order), mode=mode)]
            there = np.stack(corners)
            return least - there.max(axis=0), most - there.min(axis=0)

        def at(points: Array) -> Array:
            there = table.lookup(*(points[:, i] for i in order), mode=mode)
            return np.asarray(self._values(points) - there)

        return self._both(over, at, gap, positions)

    def silent(self, *, valued: bool) -> dict[str, Fraction] | None:
        """Return a point at which no rule fires; None if some rule fires everywhere.

        `valued`: at which there is no value, for what fires leaves no area either.

        Raises
        ------
        UnprovableError
            If it is still open when the search stops.
        """
        low, high = self._first([[] for _ in self.names])
        seen = 0
        while len(low):
            seen += len(low)
            if seen > MOST:
                raise UnprovableError("whether some rule fires everywhere is open: too many boxes")
            judged = []
            for start in range(0, len(low), self.chunk):
                self.stop.check()
                part = slice(start, start + self.chunk)
                judged.append(self._judge(low[part], high[part], valued=valued))
            fires, none = (np.concatenate(column) for column in zip(*judged, strict=True))
            nothing = np.flatnonzero(none)
            if nothing.size:
                sizes = (high[nothing] - low[nothing]).prod(axis=1)
                k = nothing[sizes.argmax()]
                middle = (0.5 * (low[k] + high[k])).tolist()
                return dict(zip(self.names, map(Fraction, middle), strict=True))
            size = (high - low).max(axis=1)
            if (size[~fires] < 1e-9).any():
                raise UnprovableError("whether some rule fires everywhere is open")
            self.stop.say(int((~fires).sum()))
            low, high = self._halved(low[~fires], high[~fires])
        return None

    def _judge(self, low: Array, high: Array, *, valued: bool) -> tuple[Array, Array]:
        """Tell where a rule fires all over a box, and where none does anywhere in it."""
        strengths = self._strengths(low, high)
        if not valued:
            return _most(strengths, 0) > 0.0, _most(strengths, 1) == 0.0
        least, _, may_lack = self._bounds_of(strengths, low, high)
        return ~may_lack, np.isnan(least)

    # ── the search ───────────────────────────────────────────────────────────────────

    def _both(
        self,
        over: Callable[[Array, Array], Interval],
        at: Callable[[Array], Array],
        gap: float,
        positions: Sequence[Sequence[float]],
    ) -> Bounds:
        def below(low: Array, high: Array) -> Interval:
            a, b = over(low, high)
            return -b, -a

        wanted = gap if gap >= 1e-7 * self.range else COARSE * self.range
        high = self._search(over, at, wanted, positions)
        low = self._search(below, lambda points: -at(points), wanted, positions)
        widen = WIDENED * self.range
        return Bounds(
            -low.bound - widen,
            high.bound + widen,
            -low.reached,
            high.reached,
            low.at,
            high.at,
            low.boxes + high.boxes,
            "boxes",
            low.complete and high.complete,
        )

    def _search(
        self,
        over: Callable[[Array, Array], Interval],
        at: Callable[[Array], Array] | None,
        gap: float,
        positions: Sequence[Sequence[float]],
        *,
        least: float | None = None,
    ) -> _Found:
        """Return the supremum over the box; with `least` only whether it is above that."""
        low, high = self._first(positions)
        best, where = -math.inf if least is None else least, {}
        done, seen = best, 0
        tops = np.full(len(low), math.inf)  # what is not reached in time keeps that of its parent
        while len(low):
            seen += len(low)
            for start in range(0, len(low), self.chunk):
                if self.stop.now:
                    break
                part = slice(start, start + self.chunk)
                tops[part] = np.minimum(tops[part], over(low[part], high[part])[1])
            if at is not None:
                middles = 0.5 * (low + high)
                promising = np.argsort(-tops)[: self.tried]
                points = np.concatenate([middles[promising], low[promising], high[promising]])
                found = at(points)
                if np.isfinite(found).any() and np.nanmax(found) > best:
                    k = int(np.nanargmax(found))
                    best = float(found[k])
                    where = dict(zip(self.names, map(float, points[k]), strict=True))
            limit = best + gap
            open_ = ~(tops <= limit)
            if (~open_).any():
                done = max(done, float(tops[~open_].max()))
            low, high, tops = low[open_], high[open_], tops[open_]
            if len(low):
                self.stop.say(len(low), float(tops.max()) - best)
            tiny = len(low) and float((high - low).max()) < 1e-10 * self.range
            if self.stop.now or seen > MOST or tiny:
                return _Found(
                    max(done, float(tops.max(initial=done))), best, where, seen, not len(low)
                )
            if len(low):
                low, high = self._halved(low, high)
                tops = np.concatenate([tops, tops])
        return _Found(max(done, best), best, where, seen, complete=True)

    def _first(self, positions: Sequence[Sequence[float]]) -> tuple[Array, Array]:
        """Return the box cut at corners of terms (where they are few) and where asked for."""
        cuts: list[list[float]] = []
        for variable, (low, high), extra in zip(
            self.rulebase.inputs, self.ends, positions, strict=True
        ):
            straight = all(SHAPES[term.shape.kind].straight for term in variable.terms)
            turns = corners_of_variable(variable) if straight else []
            inner = {float(x) for x in (*extra, *turns) if low < x < high}
            cuts.append(sorted({low, high, *inner}))
        if math.prod(len(each) for each in cuts) > 100_000:
            wanted = [sorted({low, high, *(x for x in extra if low < x < high)})
                      for (low, high), extra in zip(self.ends, positions, strict=True)]  # fmt: skip
            cuts = wanted
        stretches = [list(pairwise(each)) or [(each[0], each[0])] for each in cuts]
        boxes = np.array(list(product(*stretches)), dtype=float)
        return boxes[:, :, 0].copy(), boxes[:, :, 1].copy()

    def _halved(self, low: Array, high: Array) -> tuple[Array, Array]:
        """Cut every box across its longest side, in shares of the range."""
        spans = np.array([max(b - a, 1e-300) for a, b in self.ends])
        axis = ((high - low) / spans).argmax(axis=1)
        rows = np.arange(len(low))
        middle = 0.5 * (low[rows, axis] + high[rows, axis])
        first_high, second_low = high.copy(), low.copy()
        first_high[rows, axis] = middle
        second_low[rows, axis] = middle
        return np.concatenate([low, second_low]), np.concatenate([first_high, high])

    def _values(self, points: Array) -> Array:
        """Return the output at points; NaN where it has none."""
        from fuzzyarm.inference import infer

        inputs = {name: points[:, i] for i, name in enumerate(self.names)}
        found = infer(self._bare, inputs)[self.output.output.name]
        return np.asarray(found, dtype=float)

    # ── one step: from a box to bounds of the output ─────────────────────────────────

    def _value_bounds(self, low: Array, high: Array) -> Interval:
        strengths = self._strengths(low, high)
        least, most, may_lack = self._bounds_of(strengths, low, high)
        output = self.output.output
        nothing = np.isnan(least)
        if output.outside == "clamp":
            least = np.clip(least, output.low, output.high)
            most = np.clip(most, output.low, output.high)
        least, most = np.where(nothing, np.inf, least), np.where(nothing, -np.inf, most)
        if isinstance(output.no_rule, int | float) and may_lack.any():
            value = float(output.no_rule)  # which is not brought into the range
            least = np.where(may_lack, np.fmin(least, value), least)
            most = np.where(may_lack, np.fmax(most, value), most)
        return least, most

    def _strengths(self, low: Array, high: Array) -> list[tuple[int, Interval]]:
        """Return (member, bounds of its firing strength), rule by rule."""
        degrees = self._degrees.over(low, high)
        found: dict[int, Interval] = {}
        made = []
        for member, rule in self.output.contributions:
            planned = self.plan.rules[rule]
            if rule not in found:
                least, most = self._truth(planned.rule.antecedent, planned, degrees)
                weight = planned.rule.weight
                least, most = _widened(least * weight, most * weight)
                found[rule] = (
                    np.where(least > planned.threshold, least, 0.0),
                    np.where(most > planned.threshold, most, 0.0),
                )
            made.append((member, found[rule]))
        return made

    def _truth(
        self, expression: Expression, planned: PlannedRule, degrees: Callable[[Is], Interval]
    ) -> Interval:
        if isinstance(expression, Is):
            return _hedged(expression.hedges, degrees(expression))
        if isinstance(expression, Hedged):
            inner = self._truth(expression.operand, planned, degrees)
            return _hedged(expression.hedges, inner)
        conjunction = isinstance(expression, And)
        norm = TNORMS[planned.conjunction] if conjunction else SNORMS[planned.disjunction]
        (least, most), *rest = (
            self._truth(operand, planned, degrees) for operand in expression.operands
        )
        for other_least, other_most in rest:
            least, most = _joined(norm, (least, most), (other_least, other_most))
        return least, most

    def _folded(self, strengths: list[tuple[int, Interval]]) -> dict[int, Interval]:
        """Return bounds of one strength for each member, folded by the aggregation."""
        norm = SNORMS[self.output.output.aggregation]
        folded: dict[int, Interval] = {}
        for member, (least, most) in strengths:
            if member not in folded:
                folded[member] = least, most
                continue
            folded[member] = _joined(norm, folded[member], (least, most))
        return folded

    # ── the ways to a number ─────────────────────────────────────────────────────────

    def _chosen_bounds(self) -> Callable[[list[tuple[int, Interval]], Array, Array], Valued]:
        if self.output.discrete:
            return self._of_numbers
        if self.output.output.defuzzifier.resolution is not None:
            return _OfSamples(self.output)
        return _OfSets(self.output, self.stop)

    def _of_numbers(self, strengths: list[tuple[int, Interval]], low: Array, high: Array) -> Valued:
        folded = self._folded(strengths)
        numbers = [self._number(self.output.members[m], low, high) for m in folded]
        least = np.stack([a for a, _ in numbers], axis=1)
        most = np.stack([b for _, b in numbers], axis=1)
        lower = np.stack([a for a, _ in folded.values()], axis=1)
        upper = np.stack([b for _, b in folded.values()], axis=1)
        may_lack: Array = ~np.any(lower > 0.0, axis=1)
        if self.output.output.defuzzifier.method == "weighted-sum":
            tops = np.maximum(most * lower, most * upper).sum(axis=1)
            bottoms = np.minimum(least * lower, least * upper).sum(axis=1)
            slack = 1e-13 * np.maximum(np.abs(most), np.abs(least)).sum(axis=1)
            nothing = ~(upper > 0.0).any(axis=1)
            bottoms = np.where(nothing, np.nan, bottoms - slack)
            return bottoms, np.where(nothing, np.nan, tops + slack), may_lack
        return *average_bounds(least, most, lower, upper), may_lack

    def _number(self, member: Member, low: Array, high: Array) -> Interval:
        """Return bounds of the number of a consequent over boxes."""
        if member.value is not None:
            constant = np.full(len(low), member.value)
            return constant, constant
        if member.formula is not None:
            root = member.formula.with_constants(self.names)
            height = member.term.shape.height
            found = [
                bounds(root, dict(zip(self.names, zip(a, b, strict=True), strict=True)))
                for a, b in zip(low.tolist(), high.tolist(), strict=True)
            ]
            ends = height * np.array(found, dtype=float)
            return ends[:, 0], ends[:, 1]
        *coefficients, constant_ = member.term.shape.parameters
        least = np.full(len(low), float(constant_))
        most = least.copy()
        size = np.abs(least)
        for i, coefficient in enumerate(coefficients):
            a, b = coefficient * low[:, i], coefficient * high[:, i]
            least, most = least + np.minimum(a, b), most + np.maximum(a, b)
            size = size + np.maximum(np.abs(a), np.abs(b))
        return least - 1e-14 * size, most + 1e-14 * size

    # ── what is refused ──────────────────────────────────────────────────────────────

    def _demand_covered(self) -> None:
        output = self.output.output
        way = output.defuzzifier.method
        outputs, _ = needed(self.plan, [output.name])
        if len(outputs) > 1:
            chain = ", ".join(sorted(outputs - {output.name}))
            raise UnprovableError(f"'{output.name}' depends on another output ({chain})")
        if not self.output.contributions:
            raise UnprovableError(f"no rule concludes '{output.name}'")
        if way not in {"centroid", "weighted-average", "weighted-sum"}:
            raise UnprovableError(f"nothing is proved of the defuzzifier {way}")
        if output.defuzzifier.joined and not self.output.discrete:
            raise UnprovableError(f"nothing is proved of joined samples ('{output.name}')")
        kinds: list[Any] = [SNORMS[output.aggregation]]
        for _, index in self.output.contributions:
            planned = self.plan.rules[index]
            kinds += [TNORMS[planned.conjunction], SNORMS[planned.disjunction]]
            kinds += [HEDGES[hedge.name] for hedge in _hedges_in(planned.rule.antecedent)]
        for member in self.output.members:
            kinds += [TNORMS[member.implication], *(HEDGES[hedge.name] for hedge in member.hedges)]
        for kind in kinds:
            if kind.own:
                raise UnprovableError(f"'{kind.name}' is registered, not known to be monotone")


def _hedges_in(expression: Expression) -> list[Hedge]:
    if isinstance(expression, Is):
        return list(expression.hedges)
    if isinstance(expression, Hedged):
        return [*expression.hedges, *_hedges_in(expression.operand)]
    return [hedge for operand in expression.operands for hedge in _hedges_in(operand)]


def _most(strengths: list[tuple[int, Interval]], side: int) -> Array:
    return np.asarray(np.max([interval[side] for _, interval in strengths], axis=0))


def _widened(least: Array, most: Array) -> Interval:
    """Widen degrees for rounding; 0 stays 0."""
    return np.maximum(least * (1.0 - SLACK), 0.0), most * (1.0 + SLACK)


def _joined(norm: Norm, one: Interval, other: Interval) -> Interval:
    """Return bounds of the norm of two degrees, which rises with both."""
    least, most = norm.array(one[0], other[0]), norm.array(one[1], other[1])
    if norm is TNORMS["bounded"]:  # the sum loses what is smaller than its last bit
        least = np.maximum(least - SLACK, 0.0)
        most = np.maximum(one[1] + other[1] - 1.0 + SLACK, 0.0)
    return _widened(least, most)


def _hedged(hedges: Sequence[Hedge], degree: Interval) -> Interval:
    """Return bounds of hedged degrees: every built-in hedge rises or falls."""
    for hedge in reversed(hedges):
        numbers = () if hedge.exponent is None else (hedge.exponent,)
        ends = [
            np.broadcast_to(HEDGES[hedge.name].array(np.clip(end, 0.0, 1.0), *numbers), end.shape)
            for end in degree
        ]
        least, most = np.minimum(*ends), np.maximum(*ends)
        degree = np.maximum(least - SLACK, 0.0), np.minimum(most + SLACK, 1.0)
    return degree


# ── memberships over stretches of an input ───────────────────────────────────────────


class _Degrees:
    """Bounds of memberships over stretches, each found once."""

    def __init__(self, rulebase: RuleBase, names: Sequence[str]) -> None:
        self.rulebase = rulebase
        self.names = list(names)
        self._known: dict[tuple[str, str], dict[tuple[float, float], tuple[float, float]]] = {}

    def over(self, low: Array, high: Array) -> Callable[[Is], Interval]:
        """Return what gives the bounds of a proposition over boxes."""
        stretches: dict[int, tuple[list[tuple[float, float]], Array]] = {}
        for i in range(len(self.names)):
            both = np.stack([low[:, i], high[:, i]], axis=1)
            distinct, back = np.unique(both, axis=0, return_inverse=True)
            pairs = [(float(a), float(b)) for a, b in distinct]
            stretches[i] = pairs, back.reshape(-1)
        made: dict[tuple[str, str], Interval] = {}

        def degree(part: Is) -> Interval:
            key = part.variable, part.term
            if key not in made:
                pairs, back = stretches[self.names.index(part.variable)]
                known = self._known.setdefault(key, {})
                shape = self.rulebase.variable(part.variable).term(part.term).shape
                of_stretch = membership_bounder(shape)
                for pair in pairs:
                    if pair not in known:
                        known[pair] = of_stretch(*pair)
                ends = np.array([known[pair] for pair in pairs])[back]
                made[key] = ends[:, 0], ends[:, 1]
            return made[key]

        return degree


def membership_bounds(shape: Shape, low: float, high: float) -> tuple[float, float]:
    """Return bounds of a membership over a stretch."""
    return membership_bounder(shape)(low, high)


def membership_bounder(shape: Shape) -> Callable[[float, float], tuple[float, float]]:
    """Return what gives the bounds of a membership over stretches."""
    if shape.kind != "formula" and SHAPES[shape.kind].straight:
        return _straight_bounder(shape)
    if shape.kind == "formula":
        expression, parts = formula_of(shape).with_constants(()), 1
    else:
        record = SHAPES[shape.kind]
        numbers = dict(zip(record.symbols[1:], shape.parameters, strict=True))
        # A few parts: an expression in which x stands twice has wide bounds over a long stretch.
        expression, parts = specialise(record.expression, numbers), PARTS

    def of_stretch(low: float, high: float) -> tuple[float, float]:
        cuts = [low + (high - low) * i / parts for i in range(parts)] + [high]
        found = [bounds(expression, {"x": pair}) for pair in pairwise(cuts)]
        least = shape.height * min(part.low for part in found)
        most = shape.height * max(part.high for part in found)
        return max(0.0, least - SLACK), min(shape.height, most + SLACK)

    return of_stretch


def _straight_bounder(shape: Shape) -> Callable[[float, float], tuple[float, float]]:
    lines = SHAPES[shape.kind].lines(*shape.parameters, height=shape.height)
    corners = polyline(shape)

    def of_stretch(low: float, high: float) -> tuple[float, float]:
        inside = [y for x, y in corners if low <= x <= high]
        values = [lines.at(low), lines.at(high), *inside]
        least, most = min(values), max(values)
        return (least if least == 0.0 else max(0.0, least - SLACK)), (most and most + SLACK)

    return of_stretch


# ── from strengths to a centroid ─────────────────────────────────────────────────────


class _OfSamples:
    """The centroid of samples: sums of the aggregate at fixed positions."""

    def __init__(self, output: OutputPlan) -> None:
        way = output.output.defuzzifier
        assert way.resolution is not None
        self.output = output
        places = sample_positions(output.output.low, output.output.high, way)
        self.positions, self.width = np.array(places), len(places)
        self.weights = np.array(weights(way.resolution, way.sampling))
        model = output.output
        self.sets = [
            np.array(
                sampled_set(m.term.shape, m.hedges, model.low, model.high, way).over(len(places))
            )
            for m in output.members
        ]

    def __call__(self, strengths: list[tuple[int, Interval]], low: Array, high: Array) -> Valued:
        lower, upper = _aggregate(self.output, strengths, self.sets, self.sets)
        lower, upper = lower * self.weights, upper * self.weights
        bounds = average_bounds(self.positions, self.positions, lower, upper)
        return *bounds, ~(lower > 0.0).any(axis=1)


def _aggregate(
    output: OutputPlan,
    strengths: list[tuple[int, Interval]],
    least: Sequence[Array],
    most: Sequence[Array],
) -> Interval:
    """Return bounds of the aggregate where every set has bounds."""
    norm = SNORMS[output.output.aggregation]
    count, places = len(strengths[0][1][0]), len(least[0])
    lower, upper = np.zeros((count, places)), np.zeros((count, places))
    folded = _folded_where_max(output, strengths)
    for member, (a, b) in folded:
        cut = TNORMS[output.members[member].implication]
        active = np.flatnonzero(b > 0.0)
        some = np.flatnonzero(most[member] > 0.0)
        where = np.ix_(active, some)
        cuts = (a[active, None], b[active, None])
        part = _joined(cut, cuts, (least[member][None, some], most[member][None, some]))
        lower[where], upper[where] = _joined(norm, (lower[where], upper[where]), part)
    return lower, upper


def _folded_where_max(
    output: OutputPlan, strengths: list[tuple[int, Interval]]
) -> list[tuple[int, Interval]]:
    if output.output.aggregation != "max":
        return strengths
    folded: dict[int, Interval] = {}
    for member, (least, most) in strengths:
        known = folded.get(member)
        folded[member] = (
            (least, most)
            if known is None
            else (np.maximum(known[0], least), np.maximum(known[1], most))
        )
    return list(folded.items())


class _OfSets:
    """The exact centroid of cut sets: on each panel the aggregate lies between two lines.

    Where sets are straight and the aggregation is max, the lines of a member are its chord
    from below and the least of its lines (of which the cut set is the smallest) from above;
    the largest of several is above the one that is largest in the middle, and below the
    chord of the largest at the ends. Elsewhere the lines are level.
    """

    def __init__(self, output: OutputPlan, stop: Stop) -> None:
        self.output = output
        low, high = output.output.low, output.output.high
        ends = {x for member in output.members for piece in member.pieces for x in piece[:3:2]}
        self.lined = output.output.aggregation == "max" and all(
            all(piece.straight for piece in member.pieces)
            and TNORMS[member.implication].lines is not None
            and member.implication in {"min", "product"}
            for member in output.members
        )
        panels = PANELS if self.lined else LEVEL_PANELS
        even = {low + (high - low) * i / panels for i in range(panels + 1)}
        self.edges = np.array(sorted({low, high, *ends, *even}))
        self.width = 2 * len(self.edges)
        pairs = list(pairwise(self.edges.tolist()))
        if self.lined:
            self.lines = [self._lines(member, pairs) for member in output.members]
            return
        found = [_set_bounds(member, pairs, stop) for member in output.members]
        self.least = [np.array([a for a, _ in each]) for each in found]
        self.most = [np.array([b for _, b in each]) for each in found]

    @staticmethod
    def _lines(member: Member, pairs: list[tuple[float, float]]) -> Array:
        """Return a straight set at both ends of every panel, from within."""
        made = np.zeros((len(pairs), 2))
        for i, (a, b) in enumerate(pairs):
            middle = 0.5 * (a + b)
            piece = next(p for p in member.pieces if p.x0 <= middle <= p.x1)
            slope = (piece.y1 - piece.y0) / (piece.x1 - piece.x0)
            made[i] = piece.y0 + slope * (a - piece.x0), piece.y0 + slope * (b - piece.x0)
        return np.clip(made, 0.0, 1.0)

    def __call__(self, strengths: list[tuple[int, Interval]], low: Array, high: Array) -> Valued:
        if not self.lined:
            level = _aggregate(self.output, strengths, self.least, self.most)
            lower, upper = (np.stack([each, each], -1) for each in level)
            may_lack: Array = ~np.any(lower > 0.0, axis=(1, 2))
            return *centroid_bounds(self.edges, lower, upper), may_lack
        count, panels = len(low), len(self.edges) - 1
        lower = np.zeros((count, panels, 2))
        upper = np.zeros((count, panels, 2))
        for member, (a, b) in _folded_where_max(self.output, strengths):
            some = np.flatnonzero(self.lines[member].max(axis=1) > 0.0)
            line = self.lines[member][None, some]
            if self.output.members[member].implication == "product":
                under, over = a[:, None, None] * line, b[:, None, None] * line
            else:
                under = np.minimum(a[:, None, None], line)
                middle = 0.5 * line.sum(axis=2, keepdims=True)
                over = np.where(middle < b[:, None, None], line, b[:, None, None])
            own, known = under.sum(axis=2), lower[:, some].sum(axis=2)
            lower[:, some] = np.where((own > known)[:, :, None], under, lower[:, some])
            upper[:, some] = np.maximum(upper[:, some], over)
        may_lack = ~np.any(lower > 0.0, axis=(1, 2))
        bounds = centroid_bounds(self.edges, lower * (1.0 - SLACK), upper * (1.0 + SLACK))
        return *bounds, may_lack


def _set_bounds(
    member: Member, panels: Sequence[tuple[float, float]], stop: Stop
) -> list[tuple[float, float]]:
    """Return bounds of a set, hedges included, over each of the panels."""
    of_stretch = membership_bounder(member.term.shape)
    made = []
    for low, high in panels:
        stop.check()
        least, most = of_stretch(low, high)
        found = _hedged(member.hedges, (np.array([least]), np.array([most])))
        made.append((float(found[0][0]), float(found[1][0])))
    return made
