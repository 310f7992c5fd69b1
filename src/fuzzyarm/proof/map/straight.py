"""Piecewise linear rule bases, in exact numbers.

Let every membership be piecewise linear and every antecedent consist of minima, maxima and
complements. Then the inputs fall into simplices on which all heights are affine, and an output is
the quotient of two polynomials there (:mod:`fuzzyarm.proof.map.pieces`). Other rule bases are
refused here with the reason, and bounded over boxes (:mod:`fuzzyarm.proof.map.boxes`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Literal, NamedTuple

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference.aggregate import sample_positions, weights
from fuzzyarm.inference.overlap import ClosedForm, closed_form
from fuzzyarm.inference.plan import OutputPlan, Plan, PlannedRule, needed, plan
from fuzzyarm.inference.sets import Piece, straight_pieces
from fuzzyarm.language.model.rulebase import (
    And,
    Defuzzifier,
    Expression,
    Hedge,
    Hedged,
    Is,
    RuleBase,
)
from fuzzyarm.language.model.shapes import polyline
from fuzzyarm.symbolic.kinds import SHAPES

Corners = tuple[tuple[Fraction, Fraction], ...]


class NotStraightError(FuzzyarmError, ValueError):
    """Part of a rule base has no exact pieces; the message names it."""


class Proposition(NamedTuple):
    """A term of an input: the index of the input, and the corners of the term."""

    input: int
    corners: Corners


class StraightAntecedent(NamedTuple):
    """An antecedent: ``is`` (a proposition), ``not``, ``one``, or a norm from the left."""

    kind: Literal["is", "not", "one", "min", "max", "bounded and", "bounded or", "product"]
    operands: tuple[StraightAntecedent, ...] = ()
    proposition: int = -1


class StraightRule(NamedTuple):
    """A rule: its antecedent, its weight, and the columns of heights that it raises."""

    antecedent: StraightAntecedent
    weight: Fraction
    columns: tuple[int, ...]


class LinearConsequent(NamedTuple):
    """A consequent as a number: a constant and a coefficient for each input."""

    constant: Fraction
    coefficients: tuple[Fraction, ...]


@dataclass(frozen=True)
class Straight:
    """One output of a piecewise linear rule base, in exact numbers.

    A *column* is one height: of a consequent, folded over its rules, or of each rule by itself if
    the aggregation adds.
    """

    names: tuple[str, ...]  # the inputs
    # Ranges of the inputs; infinite ends are floats
    ranges: tuple[tuple[Fraction | float, Fraction | float], ...]
    propositions: tuple[Proposition, ...]  # the terms in antecedents
    rules: tuple[StraightRule, ...]  # in order
    columns: int  # number of heights
    adds: bool  # whether rules of one column add up; else the highest counts
    multiplies: bool  # whether antecedents are products of memberships rather than minima
    form: ClosedForm | None  # area and moment of the clipped sets, for the centroid of sets
    # Numbers of the columns, for an average
    values: tuple[LinearConsequent, ...]
    # Weights of the columns in the average: 1, or the areas of scaled sets
    areas: tuple[Fraction, ...]
    is_sum: bool  # whether the values are summed without division
    # low, high: bounds of a centroid or an average, if known; else infinite floats
    low: Fraction | float
    high: Fraction | float
    no_rule: float | None  # the value where no rule fires; None without one

    @property
    def counts(self) -> tuple[bool, ...]:
        """For each column, whether its set has an area in the range; others give no value."""
        if self.form is not None:
            return tuple(
                any(layer.a1 or layer.a2 for layer in layers) for layers in self.form.set_layers
            )
        return tuple(area > 0 for area in self.areas)


def straight(rulebase: RuleBase, output: str, *, sampled: bool = False) -> Straight:
    """Return one output of a rule base in exact numbers: its doubles are taken exactly.

    A centroid of samples may be cut as the centroid of steps: exactly equal, with many pieces.
    NotStraightError names a part that is not piecewise linear; InferenceError: no evaluation.
    """
    return _Reading(plan(rulebase), output, sampled=sampled).result()


def with_fixed(model: Straight, fixed: Mapping[int, Fraction]) -> Straight:
    """Return a model over the other inputs, with some inputs (not all) fixed.

    A membership of a fixed input becomes a level line over the first remaining input.
    """
    free = [axis for axis in range(len(model.names)) if axis not in fixed]
    numbers = {axis: number for number, axis in enumerate(free)}

    def proposition(item: Proposition) -> Proposition:
        if item.input in numbers:
            return Proposition(numbers[item.input], item.corners)
        x = fixed[item.input]
        return Proposition(0, ((Fraction(0), height_at(item.corners, x)),))

    def value(item: LinearConsequent) -> LinearConsequent:
        shift = sum((item.coefficients[axis] * x for axis, x in fixed.items()), start=Fraction(0))
        return LinearConsequent(
            item.constant + shift, tuple(item.coefficients[axis] for axis in free)
        )

    return replace(
        model,
        names=tuple(model.names[axis] for axis in free),
        ranges=tuple(model.ranges[axis] for axis in free),
        propositions=tuple(map(proposition, model.propositions)),
        values=tuple(map(value, model.values)),
    )


def height_at(corners: Corners, x: Fraction) -> Fraction:
    """Return the height of a line at a point, the greatest on a vertical edge."""
    at = [y for position, y in corners if position == x]
    if at:
        return max(at)
    if x < corners[0][0]:
        return corners[0][1]
    if x > corners[-1][0]:
        return corners[-1][1]
    (x0, y0), (x1, y1) = next(pair for pair in pairwise(corners) if pair[0][0] < x < pair[1][0])
    return y0 + (y1 - y0) / (x1 - x0) * (x - x0)


class _Reading:
    """The reader of a rule base, which collects the propositions."""

    def __init__(self, plan: Plan, output: str, *, sampled: bool) -> None:
        self.plan, self.sampled = plan, sampled
        self.output: OutputPlan = plan.outputs[output]
        self.inputs = {variable.name: i for i, variable in enumerate(plan.rulebase.inputs)}
        self.numbers: dict[tuple[str, str], int] = {}
        self.propositions: list[Proposition] = []

    def result(self) -> Straight:
        self._demand_method()
        columns, adds = self._columns()
        rules = tuple(
            StraightRule(self._antecedent(planned), Fraction(planned.rule.weight), columns[index])
            for index, planned in enumerate(self.plan.rules)
            if columns[index]
        )
        multiplies = any(_has_product(rule.antecedent) for rule in rules)
        count = 1 + max(column for rule_columns in columns for column in rule_columns)
        if multiplies:
            self._demand_products(rules, adds=adds)
        form, values, areas = self._consequents(count)
        inputs = self.plan.rulebase.inputs
        output = self.output.output
        bounded = form is not None or self._is_between_values()
        no_rule = output.no_rule
        return Straight(
            tuple(self.inputs),
            tuple((_exact(variable.low), _exact(variable.high)) for variable in inputs),
            tuple(self.propositions),
            rules,
            count,
            adds,
            multiplies,
            form,
            values,
            areas,
            self.output.record.of == "sum",
            _exact(output.low) if bounded else -math.inf,
            _exact(output.high) if bounded else math.inf,
            float(no_rule) if isinstance(no_rule, int | float) else None,
        )

    # ── refusals ─────────────────────────────────────────────────────────────────────────

    def _demand_method(self) -> None:
        output = self.output.output
        way, record, name = output.defuzzifier, self.output.record, output.name
        outputs, _ = needed(self.plan, [name])
        if len(outputs) > 1:
            chain = ", ".join(sorted(outputs - {name}))
            raise NotStraightError(f"'{name}' depends on another output ({chain})")
        if not self.output.contributions:
            raise NotStraightError(f"no rule concludes '{name}'")
        is_average = record.figure in _AVERAGES and not record.inverts
        if not is_average or (record.both and not self.output.discrete):
            raise NotStraightError(f"defuzzifier {way.method} is not in straight pieces")
        stairs = self.sampled and not way.joined
        if way.resolution is not None and not self.output.discrete and not stairs:
            raise NotStraightError(f"defuzzifier {way} is sampled")
        if any(planned.threshold for planned in self.plan.rules):
            raise NotStraightError("a threshold of firing strengths makes jumps")

    def _columns(self) -> tuple[list[tuple[int, ...]], bool]:
        """Return the columns of each rule, and whether rules add up in a column."""
        aggregation = self.output.output.aggregation
        if aggregation not in {"max", "sum"}:
            raise NotStraightError(f"aggregation {aggregation} is not in straight pieces")
        columns: list[tuple[int, ...]] = [() for _ in self.plan.rules]
        # Clipped sets are not linear in the strength: each adding rule has its own column.
        apart = aggregation == "sum" and self._is_clipped()
        for number, (member, rule) in enumerate(self.output.contributions):
            if self.plan.rules[rule].rule.weight != 0.0:
                columns[rule] = (*columns[rule], number if apart else member)
        if not any(columns):
            raise NotStraightError(f"no rule concludes '{self.output.output.name}'")
        return columns, aggregation == "sum"

    def _is_clipped(self) -> bool:
        if self.output.discrete:
            return False
        return any(member.implication != "product" for member in self.output.members)

    def _demand_products(self, rules: Sequence[StraightRule], *, adds: bool) -> None:
        """Refuse maxima of products: their heights must enter the output linearly."""
        if any(not _is_plain_product(rule.antecedent) for rule in rules):
            raise NotStraightError("products of memberships beside other norms")
        if self.output.discrete and not adds:
            columns = [column for rule in rules for column in rule.columns]
            if len(set(columns)) < len(columns):
                raise NotStraightError("the maximum of products of memberships")
        if not self.output.discrete and self._is_clipped():
            raise NotStraightError("sets that are clipped at products of memberships")

    # ── antecedents ──────────────────────────────────────────────────────────────────

    def _antecedent(self, planned: PlannedRule) -> StraightAntecedent:
        return self._node(planned.rule.antecedent, planned)

    def _node(self, expression: Expression, planned: PlannedRule) -> StraightAntecedent:
        if isinstance(expression, Is):
            number = self._proposition(expression)
            return self._hedged(StraightAntecedent("is", (), number), expression.hedges)
        if isinstance(expression, Hedged):
            return self._hedged(self._node(expression.operand, planned), expression.hedges)
        conjunction = isinstance(expression, And)
        name = planned.conjunction if conjunction else planned.disjunction
        kinds = _CONJUNCTIONS if conjunction else _DISJUNCTIONS
        if name not in kinds:
            raise NotStraightError(f"{'and' if conjunction else 'or'} {name} bends straight lines")
        operands = tuple(self._node(operand, planned) for operand in expression.operands)
        return operands[0] if len(operands) == 1 else StraightAntecedent(kinds[name], operands)

    @staticmethod
    def _hedged(node: StraightAntecedent, hedges: Sequence[Hedge]) -> StraightAntecedent:
        for hedge in reversed(hedges):
            if hedge.name == "not":
                node = StraightAntecedent("not", (node,))
            elif hedge.name == "any":
                node = StraightAntecedent("one")
            else:
                raise NotStraightError(f"the hedge '{hedge.name}' bends straight lines")
        return node

    def _proposition(self, part: Is) -> int:
        key = part.variable, part.term
        if key not in self.numbers:
            shape = self.plan.rulebase.variable(part.variable).term(part.term).shape
            if shape.kind == "formula" or not SHAPES[shape.kind].straight:
                where = f"'{part.variable} is {part.term}'"
                raise NotStraightError(f"{where} is a {shape.kind}, which is curved")
            self.numbers[key] = len(self.propositions)
            self.propositions.append(Proposition(self.inputs[part.variable], _corners(shape)))
        return self.numbers[key]

    # ── consequents ──────────────────────────────────────────────────────────────────

    def _consequents(
        self, count: int
    ) -> tuple[ClosedForm | None, tuple[LinearConsequent, ...], tuple[Fraction, ...]]:
        if self.output.discrete:
            values = tuple(map(self._value, range(count)))
            return None, values, (Fraction(1),) * count
        profiles = [self._profile(member) for member in range(len(self.output.members))]
        low, high = Fraction(self.output.output.low), Fraction(self.output.output.high)
        if not self._is_clipped():
            if self.output.output.aggregation != "sum":
                raise NotStraightError("the union of scaled sets is not in straight pieces")
            return None, *_averages(profiles, len(self.inputs))
        if any(member.implication != "min" for member in self.output.members):
            names = sorted({member.implication for member in self.output.members} - {"min"})
            raise NotStraightError(f"implication {names[0]} is not in straight pieces")
        united = self.output.output.aggregation == "max"
        form = closed_form(profiles, low, high, united=united, same_level=0)  # type: ignore[arg-type]
        if form is None:
            raise NotStraightError("too many sets of the output overlap")
        if not united:  # a column for each rule
            members = [member for member, _ in self.output.contributions]
            form = ClosedForm(form.centre, tuple(form.set_layers[member] for member in members), ())
        return form, (), ()

    def _profile(self, number: int) -> list[Piece]:
        member, output = self.output.members[number], self.output.output
        shape = member.term.shape
        if shape.kind == "formula" or not SHAPES[shape.kind].straight:
            where = f"'{output.name} is {member.term.name}'"
            raise NotStraightError(f"{where} is a {shape.kind}, which is curved")
        if member.hedges:
            raise NotStraightError(f"a hedge on '{output.name} is {member.term.name}'")
        low, high = Fraction(output.low), Fraction(output.high)
        if output.defuzzifier.resolution is not None:
            return _stairs(_corners(shape), low, high, output.defuzzifier)
        return straight_pieces(_corners(shape), low, high)  # type: ignore[arg-type]

    def _value(self, column: int) -> LinearConsequent:
        member = self.output.members[column]
        none = (Fraction(0),) * len(self.inputs)
        if member.value is not None:
            return LinearConsequent(Fraction(member.value), none)
        if member.term.shape.kind == "linear":
            *coefficients, constant = map(Fraction, member.term.shape.parameters)
            return LinearConsequent(constant, tuple(coefficients))
        where = f"'{self.output.output.name} is {member.term.name}'"
        raise NotStraightError(f"{where} is a formula of the inputs")

    def _is_between_values(self) -> bool:
        output = self.output.output
        numbers = [member.value for member in self.output.members]
        return self.output.record.of != "sum" and all(
            number is not None and output.low <= number <= output.high for number in numbers
        )


_AVERAGES = frozenset({"centroid", "average", "weighted"})
"""Defuzzifiers that average or add numbers."""

_CONJUNCTIONS: dict[
    str, Literal["min", "bounded and", "product"]
] = {"min": "min", "bounded": "bounded and", "product": "product"}  # fmt: skip
_DISJUNCTIONS: dict[str, Literal["max", "bounded or"]] = {"max": "max", "bounded": "bounded or"}


def _exact(number: float) -> Fraction | float:
    return Fraction(number) if math.isfinite(number) else number


def _corners(shape: object) -> Corners:
    return tuple((Fraction(x), Fraction(y)) for x, y in polyline(shape))  # type: ignore[arg-type]


def _stairs(corners: Corners, low: Fraction, high: Fraction, way: Defuzzifier) -> list[Piece]:
    """Return a step around each sample of a set: integrals equal the sums over samples."""
    assert way.resolution is not None
    count = way.resolution
    step = (high - low) / (count if way.sampling in ("midpoints", "left") else count - 1)
    first = low + step / 2 if way.sampling == "midpoints" else low
    pieces = []
    # Beside a vertical edge the last bit of a position decides, so heights are taken there.
    rounded = sample_positions(float(low), float(high), way)
    for k, (at, weight) in enumerate(zip(rounded, weights(count, way.sampling), strict=True)):
        x, half = first + k * step, step * Fraction(weight) / 2
        y = height_at(corners, Fraction(at))
        pieces.append(Piece(x - half, y, x + half, y, straight=True))  # type: ignore[arg-type]
    return pieces


def _has_product(node: StraightAntecedent) -> bool:
    return node.kind == "product" or any(map(_has_product, node.operands))


def _is_plain_product(node: StraightAntecedent) -> bool:
    if node.kind in {"product", "not"}:
        return all(map(_is_plain_product, node.operands))
    return node.kind in {"is", "one"}


def _averages(
    profiles: Sequence[Sequence[Piece]], inputs: int
) -> tuple[tuple[LinearConsequent, ...], tuple[Fraction, ...]]:
    """Return centroids and areas of whole sets: added scaled sets are their averages."""
    values, areas = [], []
    for pieces in profiles:
        area = moment = Fraction(0)
        for piece in pieces:
            x0, y0, x1, y1 = map(Fraction, piece[:4])
            # ∫ y dx and ∫ x y dx of a straight piece (trapezium).
            area += (x1 - x0) * (y0 + y1) / 2
            moment += (x1 - x0) * (x0 * (2 * y0 + y1) + x1 * (y0 + 2 * y1)) / 6
        values.append(
            LinearConsequent(moment / area if area else Fraction(0), (Fraction(0),) * inputs)
        )
        areas.append(area)
    return tuple(values), tuple(areas)
