"""Bounds over boxes of the inputs, for rule bases that are not piecewise linear.

Over a box every membership lies in an interval (of its polyline, or of its shape's expression), so
does every firing strength (norms and hedges are monotone), and the value has the bounds of
:mod:`fuzzyarm.proof.map.crisp` for the lower and the upper aggregate. Boxes are halved until none
is undecided. The bounds are first order in the size of a box: sound, and slow to converge on a
plateau of the output. At a jump they contain both sides.

An output that other rules read (a chain) is bounded over the same boxes, as an interval of their
input. The common dependence on the inputs is lost within a box, and recovered as boxes get small.

Source: R. E. Moore, *Interval Analysis*, 1966.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.inference.plan import OutputPlan, Plan, PlannedRule, plan, read_by
from fuzzyarm.language.model.rulebase import And, Expression, Hedge, Hedged, Is, RuleBase
from fuzzyarm.language.model.shapes import corners as corners_of_variable
from fuzzyarm.proof.map.arithmetic import Array
from fuzzyarm.proof.map.bounds import WIDENED, Bounds, UnprovableError
from fuzzyarm.proof.map.crisp import Crisp, crisp
from fuzzyarm.proof.map.memberships import Degrees, Interval, hedged, joined
from fuzzyarm.proof.stop import Stop
from fuzzyarm.symbolic.kinds import HEDGES, SHAPES, SNORMS, TNORMS

COARSE = 1e-3
"""Default tolerance of the refinement, as a share of the output's range."""

FINEST = 2.0**-12
"""Smallest box at a jump of the output, as a share of the region."""

MOST = 3_000_000
"""Most boxes of a search."""

MOST_CHAINED = 100_000
"""The same for rules that read other outputs, which are bounded anew for each box."""

MOST_TABLE_CORNERS = 4_096
"""Most corners of a table's cell, each looked up for every box."""

AT_ONCE = 200_000
"""Numbers in the aggregates of the boxes of one batch: they fit into the cache."""


class _Found(NamedTuple):
    """The result of a search over boxes: bound, attained value and its point."""

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
        Name of the output.
    ends : sequence of (float, float)
        The box.
    stop : Stop
        The time budget.

    Raises
    ------
    UnprovableError
        If part of the rule base has no bounds over boxes; the message names it.
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
                    target,
                    no_rule=target.no_rule if isinstance(target.no_rule, float | int) else math.nan,
                    outside="extend" if target.outside == "error" else target.outside,
                )
                for target in rulebase.outputs
            ),
        )
        # Outputs read by the rules or values of this one; there are no cycles.
        self._chained = {
            name: Boxes(rulebase, name, ends, stop) for name in sorted(read_by(self.plan, output))
        }
        self._degrees = Degrees(self.plan.rulebase, self.names, list(self._chained))
        self._bounds_of: Crisp = crisp(self.output, [*self.names, *self._chained], stop)
        self.most = MOST_CHAINED if self._chained else MOST
        self.chunk = max(16, AT_ONCE // self._bounds_of.width)
        self.tried = 16 if self.output.integrated else 256  # boxes evaluated at their corners
        low, high = self.output.output.low, self.output.output.high
        self.range = high - low if math.isfinite(high - low) else 1.0

    @property
    def says_no_rule(self) -> bool:
        """Whether the output is a number where no rule fires."""
        no_rule = self.output.output.no_rule
        return isinstance(no_rule, int | float) and not math.isnan(no_rule)

    def over(self, ends: Sequence[tuple[float, float]], stop: Stop) -> Boxes:
        """Return the same for another box; cached bounds of sets and terms stay valid."""
        other = copy(self)
        other.ends, other.stop = ends, stop
        other._chained = {name: boxes.over(ends, stop) for name, boxes in self._chained.items()}
        return other

    # ── questions ────────────────────────────────────────────────────────────────────

    def value(self, gap: float) -> Bounds:
        """Return bounds of the output."""
        return self._both(self._value_bounds, self._values, gap, [[] for _ in self.names])

    def at_most(self, bound: float, *, negated: bool) -> tuple[bool, int]:
        """Return whether the output (or its negative) is proved at most a bound, and the boxes."""

        def over(low: Array, high: Array) -> Interval:
            a, b = self._value_bounds(low, high)
            return (-b, -a) if negated else (a, b)

        search = self._search(over, None, 0.0, [[] for _ in self.names], least=bound)
        return search.complete, search.boxes

    def table(self, table: Any, mode: str, gap: float) -> Bounds:
        """Return bounds of table minus output."""
        if mode == "linear" and 1 << len(self.names) > MOST_TABLE_CORNERS:
            raise UnprovableError(f"a cell of the table has 2^{len(self.names)} corners")
        axes = {axis.name: axis for axis in table.axes}
        positions = [
            list(axes[name].levels if mode == "linear" else axes[name].thresholds(mode))
            for name in self.names
        ]
        order = [self.names.index(axis.name) for axis in table.axes]
        # Of an interpolation, beside a level with a large value.
        rounding = 1e-14 * float(np.abs(table.values).max())

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
            return least - there.max(axis=0) - rounding, most - there.min(axis=0) + rounding

        def at(points: Array) -> Array:
            there = table.lookup(*(points[:, i] for i in order), mode=mode)
            return np.asarray(self._values(points) - there)

        return self._both(over, at, gap, positions)

    def point_without_rule(self, *, valued: bool) -> dict[str, Fraction] | None:
        """Return a point at which no rule fires; None if some rule fires everywhere.

        `valued`: a point without a value, which includes firing rules without area.
        """
        low, high = self._first([[] for _ in self.names])
        count = 0
        while len(low):
            count += len(low)
            if count > self.most:
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
            if valued and (at := self._without_value(low[~fires], high[~fires])) is not None:
                return dict(zip(self.names, map(Fraction, at), strict=True))
            size = (high - low).max(axis=1)
            if (size[~fires] < 1e-9).any():
                raise UnprovableError("whether some rule fires everywhere is open")
            self.stop.say(int((~fires).sum()))
            low, high = self._halved(low[~fires], high[~fires])
        return None

    def _without_value(self, low: Array, high: Array) -> list[float] | None:
        """Return the midpoint of a box among the largest at which inference has no value."""
        if self.says_no_rule or not len(low):
            return None
        largest = np.argsort((high - low).prod(axis=1))[-self.tried :]
        points = 0.5 * (low[largest] + high[largest])
        undefined = np.flatnonzero(np.isnan(self._values(points)))
        return points[undefined[-1]].tolist() if undefined.size else None

    def _judge(self, low: Array, high: Array, *, valued: bool) -> tuple[Array, Array]:
        """Return in which boxes a rule fires everywhere, and in which none fires anywhere."""
        low, high, undecided = self._with_chained(low, high)
        strengths = self._strengths(low, high, undecided)
        if not valued:
            return _most(strengths, 0) > 0.0, _most(strengths, 1) == 0.0
        least, _, may_lack = self._bounds_of(strengths, low, high)
        return ~(may_lack | undecided), np.isnan(least)

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

        tolerance = gap if gap >= 1e-7 * self.range else COARSE * self.range
        # Both ends have a bound even if time runs out.
        high = self.over(self.ends, self.stop.half())._search(over, at, tolerance, positions)
        low = self._search(below, lambda points: -at(points), tolerance, positions)
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
        closed_top, count = best, 0
        tops = np.full(len(low), math.inf)  # in time or of the parent
        while len(low):
            count += len(low)
            for start in range(0, len(low), self.chunk):
                if self.stop.now:
                    break
                part = slice(start, start + self.chunk)
                tops[part] = np.minimum(tops[part], over(low[part], high[part])[1])
            if at is not None:
                middles = 0.5 * (low + high)
                promising = np.argsort(-tops)[: self.tried]
                points = np.concatenate([middles[promising], low[promising], high[promising]])
                values = at(points)
                if np.isfinite(values).any() and np.nanmax(values) > best:
                    k = int(np.nanargmax(values))
                    best = float(values[k])
                    where = dict(zip(self.names, map(float, points[k]), strict=True))
            limit = best + gap
            undecided = ~(tops <= limit)
            if (~undecided).any():
                closed_top = max(closed_top, float(tops[~undecided].max()))
            low, high, tops = low[undecided], high[undecided], tops[undecided]
            if len(low):
                self.stop.say(len(low), float(tops.max()) - best)
            if self.stop.now or count > self.most or (len(low) and self._is_fine(low, high)):
                return _Found(
                    max(closed_top, float(tops.max(initial=closed_top))),
                    best,
                    where,
                    count,
                    not len(low),
                )
            if len(low):
                low, high = self._halved(low, high)
                tops = np.concatenate([tops, tops])
        return _Found(max(closed_top, best), best, where, count, complete=True)

    def _first(self, positions: Sequence[Sequence[float]]) -> tuple[Array, Array]:
        """Return the box cut at corners of terms (if few) and at given points."""
        cuts: list[list[float]] = []
        for variable, (low, high), extra in zip(
            self.plan.rulebase.inputs, self.ends, positions, strict=True
        ):
            straight = all(SHAPES[term.shape.kind].straight for term in variable.terms)
            turns = corners_of_variable(variable) if straight else []
            inner = {float(x) for x in (*extra, *turns) if low < x < high}
            cuts.append(sorted({low, high, *inner}))
        if math.prod(len(cut) for cut in cuts) > 100_000:
            cuts_by_input = [sorted({low, high, *(x for x in extra if low < x < high)})
                      for (low, high), extra in zip(self.ends, positions, strict=True)]  # fmt: skip
            cuts = cuts_by_input
        cuts = [cut if len(cut) > 1 else 2 * cut for cut in cuts]
        sizes = [len(cut) - 1 for cut in cuts]
        count = math.prod(sizes)
        if count > self.most:
            raise UnprovableError(f"more than {self.most:,} boxes ({count:,} cells of the table)")
        index = np.unravel_index(np.arange(count), sizes)
        lows, highs = (
            np.stack([np.array(cut[part])[i] for cut, i in zip(cuts, index, strict=True)], axis=1)
            for part in (slice(0, -1), slice(1, None))
        )
        return lows, highs

    def _is_fine(self, low: Array, high: Array) -> bool:
        """Return which boxes are too small to gain from cutting."""
        if self._bounds_of.jumps and float(((high - low) / self._spans).max()) < FINEST:
            return True
        return float((high - low).max()) < 1e-10 * self.range

    @property
    def _spans(self) -> Array:
        return np.array([max(b - a, 1e-300) for a, b in self.ends])

    def _halved(self, low: Array, high: Array) -> tuple[Array, Array]:
        """Cut every box across its longest side, in shares of the range."""
        axis = ((high - low) / self._spans).argmax(axis=1)
        rows = np.arange(len(low))
        middle = 0.5 * (low[rows, axis] + high[rows, axis])
        first_high, second_low = high.copy(), low.copy()
        first_high[rows, axis] = middle
        second_low[rows, axis] = middle
        return np.concatenate([low, second_low]), np.concatenate([first_high, high])

    def _values(self, points: Array) -> Array:
        """Return the output at points; NaN without a value."""
        from fuzzyarm.inference import infer

        inputs = {name: points[:, i] for i, name in enumerate(self.names)}
        values = infer(self._bare, inputs)[self.output.output.name]
        return np.asarray(values, dtype=float)

    # ── one step: from a box to bounds of the output ─────────────────────────────────

    def _value_bounds(self, low: Array, high: Array) -> Interval:
        low, high, undecided = self._with_chained(low, high)
        strengths = self._strengths(low, high, undecided)
        least, most, may_lack = self._bounds_of(strengths, low, high)
        output = self.output.output
        nothing = np.isnan(least)
        if output.outside == "clamp":
            least = np.clip(least, output.low, output.high)
            most = np.clip(most, output.low, output.high)
        least, most = np.where(nothing, np.inf, least), np.where(nothing, -np.inf, most)
        if isinstance(output.no_rule, int | float) and may_lack.any():
            value = float(output.no_rule)  # not clamped to the range
            least = np.where(may_lack, np.fmin(least, value), least)
            most = np.where(may_lack, np.fmax(most, value), most)
        return np.where(undecided, -np.inf, least), np.where(undecided, np.inf, most)

    def _with_chained(self, low: Array, high: Array) -> tuple[Array, Array, Array]:
        """Return boxes with bounds of the outputs read, and which may have none (to be cut)."""
        undecided = np.zeros(len(low), dtype=bool)
        columns: list[Interval] = []
        for boxes in self._chained.values():
            least, most = boxes._value_bounds(low, high)
            if not boxes.says_no_rule:
                undecided |= ~boxes._judge(low, high, valued=True)[0]
            unbounded = ~np.isfinite(least) | ~np.isfinite(most)
            undecided |= unbounded
            widen = WIDENED * boxes.range
            columns.append(
                (np.where(unbounded, 0.0, least - widen), np.where(unbounded, 0.0, most + widen))
            )
        if not columns:
            return low, high, undecided
        return (
            np.column_stack([low, *(least for least, _ in columns)]),
            np.column_stack([high, *(most for _, most in columns)]),
            undecided,
        )

    def _strengths(self, low: Array, high: Array, undecided: Array) -> list[tuple[int, Interval]]:
        """Return (member, bounds of its firing strength) for each rule: [0, 1] in open boxes."""
        degrees = self._degrees.over(low, high)
        intervals: dict[int, Interval] = {}
        intervals_of_members = []
        for member, rule in self.output.contributions:
            planned = self.plan.rules[rule]
            if rule not in intervals:
                least, most = self._truth(planned.rule.antecedent, planned, degrees)
                weight = planned.rule.weight
                weights = np.full(len(low), weight)
                least, most = joined(TNORMS["product"], (least, most), (weights, weights))
                least, most = (
                    np.where(undecided, 0.0, least),
                    np.where(undecided, abs(weight), most),
                )
                intervals[rule] = (
                    np.where(least > planned.threshold, least, 0.0),
                    np.where(most > planned.threshold, most, 0.0),
                )
            intervals_of_members.append((member, intervals[rule]))
        return intervals_of_members

    def _truth(
        self, expression: Expression, planned: PlannedRule, degrees: Callable[[Is], Interval]
    ) -> Interval:
        if isinstance(expression, Is):
            return hedged(expression.hedges, degrees(expression))
        if isinstance(expression, Hedged):
            inner = self._truth(expression.operand, planned, degrees)
            return hedged(expression.hedges, inner)
        conjunction = isinstance(expression, And)
        norm = TNORMS[planned.conjunction] if conjunction else SNORMS[planned.disjunction]
        (least, most), *rest = (
            self._truth(operand, planned, degrees) for operand in expression.operands
        )
        for other_least, other_most in rest:
            least, most = joined(norm, (least, most), (other_least, other_most))
        return least, most

    # ── refusals ─────────────────────────────────────────────────────────────────────────

    def _demand_covered(self) -> None:
        output = self.output.output
        if not self.output.contributions:
            raise UnprovableError(f"no rule concludes '{output.name}'")
        way = output.defuzzifier
        if way.joined and not self.output.discrete and not self.output.record.joins:
            raise UnprovableError(f"the {way.method} of '{output.name}' knows no joined samples")
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
