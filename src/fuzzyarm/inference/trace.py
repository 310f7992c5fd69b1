"""The trace of one inference: every number between the inputs and the outputs, as data."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple

from fuzzyarm.base.jsonable import JsonRecord, json_properties
from fuzzyarm.base.shown import Drawn, one_line
from fuzzyarm.inference.aggregate import Fired, aggregate, folded_strengths
from fuzzyarm.inference.engine import Outcome, cached_engine
from fuzzyarm.inference.firing_intervals import LOWER, UPPER
from fuzzyarm.inference.infer import infer_interval
from fuzzyarm.inference.inputs import bring_into_range
from fuzzyarm.inference.labelled import by_name
from fuzzyarm.inference.plan import Member, OutputPlan, Plan, plan
from fuzzyarm.inference.sets import Piece, crossing, term_function
from fuzzyarm.inference.strengths import rule_strengths
from fuzzyarm.inference.weighted import tsukamoto_position
from fuzzyarm.language.model.rulebase import (
    And,
    AnyRuleBase,
    Expression,
    Hedge,
    Hedged,
    Is,
    Rule,
    RuleBase,
    RuleBlock,
    Variable,
    model_of,
    propositions,
)
from fuzzyarm.language.model.shapes import apply_hedges
from fuzzyarm.symbolic.kinds import TNORMS

SAMPLES = 201
"""Points that a smooth curve is drawn through."""

Curve = tuple[tuple[float, float], ...]


@json_properties("* lower?")
@dataclass(frozen=True, slots=True)
class FuzzyValue:
    """An input (or an output that later rules use) and its membership in each of its terms.

    Attributes
    ----------
    name : str
        The variable.
    given : float
        The value passed by the caller.
    value : float
        The value used, clamped to the range if necessary.
    degrees : tuple of (str, float)
        (term, membership) for every term, without hedges. Of an interval type-2 term the upper one.
    lower : tuple of (str, float)
        The lower membership of every term; empty if none is of interval type 2.
    """

    name: str
    given: float
    value: float
    degrees: tuple[tuple[str, float], ...]
    lower: tuple[tuple[str, float], ...] = ()


@json_properties("* lower?")
@dataclass(frozen=True, slots=True)
class RuleTrace:
    """A rule and its firing strength.

    Attributes
    ----------
    number : int
        Position among all rules, from 1.
    block : str
        Name of its block, maybe empty.
    line, column : int
        Position in the file, from 1; of a grid its cell.
    text : str
        The rule in words.
    weight : float
        Of the rule.
    strength : float
        The truth of its antecedent times its weight.
    consequents : tuple of (str, str)
        (output, term with hedges).
    lower : float or None
        The lower strength of an interval type-2 rule; `strength` is the upper one.
    """

    number: int
    block: str
    line: int
    column: int
    text: str
    weight: float
    strength: float
    consequents: tuple[tuple[str, str], ...]
    lower: float | None = None

    @property
    def place(self) -> str:
        """Name of the rule: its position in the text."""
        return place_of(self.number, self.line, self.column)


def place_of(number: int, line: int, column: int) -> str:
    """Return the name of a rule: line and column, or its number without a text."""
    # No rule begins at the first character of a file: that position marks one made in Python.
    return f"rule {number}" if (line, column) == (1, 1) else f"line {line}:{column}"


@json_properties("* lower? lower_value? lower_curve?")
@dataclass(frozen=True, slots=True)
class ConsequentTrace:
    """The assertion of one term of an output by all its rules together.

    Attributes
    ----------
    term : str
        The term, with hedges.
    strength : float
        Of its rules under the aggregation.
    value : float or None
        Its representative number, under a weighted defuzzifier and for singletons.
    curve : tuple of (float, float)
        The set cut at `strength`, as corners to be joined by straight lines (two at one
        position for a vertical edge); empty for a value.
    lower, lower_value, lower_curve
        The same of the lower reading, where an output is of interval type 2.
    """

    term: str
    strength: float
    value: float | None
    curve: Curve
    lower: float | None = None
    lower_value: float | None = None
    lower_curve: Curve = ()


@json_properties("* lower_aggregate? left? right?")
@dataclass(frozen=True, slots=True)
class OutputTrace:
    """An output: the sets that were asserted, their union and the value.

    Attributes
    ----------
    name : str
        The output.
    low, high : float
        Its range; an end may be infinite.
    method : str
        The defuzzifier, as written in a file.
    fired : bool
        Whether any rule fired; otherwise `value` is the stated default or the held value.
    consequents : tuple of ConsequentTrace
        The asserted ones.
    aggregate : tuple of (float, float)
        The aggregated set as a curve; empty for values.
    value : float
        The result; NaN without one.
    lower_aggregate : tuple of (float, float)
        The lower set of an interval type-2 output; `aggregate` is the upper one.
    left : float or None
        The left end of its centroid, by Karnik and Mendel. It is its own switch point: the centroid
        of the set that is upper on its left and lower on its right.
    right : float or None
        The right end, with the sides exchanged.
    """

    name: str
    low: float
    high: float
    method: str
    fired: bool
    consequents: tuple[ConsequentTrace, ...]
    aggregate: Curve
    value: float
    lower_aggregate: Curve = ()
    left: float | None = None
    right: float | None = None


@dataclass(frozen=True, slots=True, repr=False)
class Trace(Drawn, JsonRecord):
    """Every step of one inference; ``print`` and notebooks draw it.

    Attributes
    ----------
    rulebase : str
        Its name.
    inputs : tuple of FuzzyValue
        With the outputs that later rules use.
    rules : tuple of RuleTrace
        All of them, in the order of the file.
    outputs : tuple of OutputTrace
        In the order of the file.
    """

    rulebase: str
    inputs: tuple[FuzzyValue, ...]
    rules: tuple[RuleTrace, ...]
    outputs: tuple[OutputTrace, ...]

    def __repr__(self) -> str:
        inputs = ", ".join(f"{variable.name} = {variable.given:.6g}" for variable in self.inputs)
        outputs = ", ".join(f"{output.name} = {output.value:.6g}" for output in self.outputs)
        fired = f"{len(self.fired)} of {len(self.rules)} rules fire"
        return one_line(self, f"{self.rulebase}: {inputs} → {outputs}, {fired}")

    @property
    def is_type2(self) -> bool:
        """Whether some strength or value in it is an interval."""
        return any(rule.lower is not None for rule in self.rules)

    @property
    def fired(self) -> tuple[RuleTrace, ...]:
        """The rules that fire, the strongest first."""
        firing = [rule for rule in self.rules if rule.strength > 0.0]
        return tuple(sorted(firing, key=lambda rule: -rule.strength))


def explain(
    rulebase: AnyRuleBase,
    inputs: Mapping[str, float] | None = None,
    /,
    *,
    held: Mapping[str, float] | None = None,
    **named: float,
) -> Trace:
    """Evaluate one point and show the work.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    inputs : mapping of str to float, optional
        Inputs by name; for names that are not identifiers.
    held : mapping of str to float, optional
        Last values of outputs that hold where no rule fires.
    **named : float
        Inputs by name.

    Returns
    -------
    Trace
        Plain data; the value of each output is that of :func:`fuzzyarm.inference.infer`.

    Raises
    ------
    InferenceError, NoRuleFiredError
        As :func:`fuzzyarm.inference.infer`.
    """
    rulebase = model_of(rulebase)
    values_by_name = by_name(inputs, named, rulebase.inputs)
    point = cached_engine(rulebase).outcome(values_by_name, held)
    steps = plan(rulebase)
    strengths = rule_strengths(steps, point.values)
    names = dict.fromkeys([*(v.name for v in rulebase.inputs), *_outputs_read(steps)])
    ends: dict[str, tuple[float, float]] = {}
    if any(output.sides and output.record.of == "ends" for output in steps.outputs.values()):
        ends = infer_interval(rulebase, values_by_name, held=held)
    return Trace(
        rulebase.name,
        tuple(_fuzzy_value(rulebase.variable(n), values_by_name, point.values[n]) for n in names),
        _rules(rulebase, steps, strengths),
        tuple(
            _output(_Asserted(output, rulebase, point, _fired(output, strengths)), ends)
            for output in steps.outputs.values()
        ),
    )


def _outputs_read(steps: Plan) -> list[str]:
    """Return the outputs whose values rules read, in their order."""
    read = {
        part.variable
        for planned in steps.rules
        for part in propositions(planned.rule.antecedent)
        if part.variable not in planned.degrees
    }
    return [name for name in steps.outputs if name in read]


def _fired(output: OutputPlan, strengths: Sequence[float]) -> Fired:
    """Return member and strength of the assertions about an output, in the order of the rules."""
    return [
        (member, strengths[rule]) for member, rule in output.contributions if strengths[rule] > 0.0
    ]


@dataclass(frozen=True, slots=True)
class NearRule:
    """A rule that does not fire, with the degrees of its conditions."""

    rule: RuleTrace
    # Its propositions in words, each with its degree; those about inputs.
    propositions: tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True)
class Silence:
    """The reason why no rule fires for an output: the degrees, and the rules nearest to firing."""

    output: str
    inputs: tuple[FuzzyValue, ...]
    nearest: tuple[NearRule, ...]


def explain_silence(
    rulebase: RuleBase, inputs: Mapping[str, float], output: str, *, most: int = 3
) -> Silence:
    """Explain a point at which no rule fires for an output, with the `most` nearest rules.

    Those have the fewest false propositions.
    """
    values = {v.name: bring_into_range(v, float(inputs[v.name])) for v in rulebase.inputs}
    fuzzy = tuple(_fuzzy_value(v, inputs, values[v.name]) for v in rulebase.inputs)
    degrees = {(value.name, term): degree for value in fuzzy for term, degree in value.degrees}
    near: list[NearRule] = []
    numbered = enumerate(((block, rule) for block in rulebase.blocks for rule in block.rules), 1)
    for number, (block, rule) in numbered:
        if not any(consequent.variable == output for consequent in rule.consequents):
            continue
        parts = tuple(
            (_words(part), apply_hedges(part.hedges, degrees[part.variable, part.term]))
            for part in propositions(rule.antecedent)
            if (part.variable, part.term) in degrees
        )
        near.append(NearRule(_rule_trace(number, block, rule, 0.0), parts))
    near.sort(key=_distance)
    return Silence(output, fuzzy, tuple(near[:most]))


def _distance(near: NearRule) -> tuple[int, float]:
    degrees = [degree for _, degree in near.propositions]
    # Fewest false propositions; then the strongest of the weakest other proposition.
    holding = [degree for degree in degrees if degree > 0.0]
    return len(degrees) - len(holding), -min(holding, default=0.0)


def _fuzzy_value(variable: Variable, inputs: Mapping[str, float], value: float) -> FuzzyValue:
    degrees = tuple(
        (term.name, term_function(term.shape)(value))
        for term in variable.terms
        if term.shape.kind != "linear"
    )
    lower: tuple[tuple[str, float], ...] = ()
    if any(term.lower is not None for term in variable.terms):
        lower = tuple(
            (term.name, term_function(term.lower or term.shape)(value))
            for term in variable.terms
            if term.shape.kind != "linear"
        )
    given_value = float(inputs.get(variable.name, value))
    return FuzzyValue(variable.name, given_value, value, degrees, lower)


def _rules(rulebase: RuleBase, steps: Plan, strengths: Sequence[float]) -> tuple[RuleTrace, ...]:
    traces: list[RuleTrace] = []
    for block in rulebase.blocks:
        for rule in block.rules:
            # A rule of type 2 is two in the plan: its upper reading, then its lower one.
            readings = [strengths[i] for i in steps.readings[len(traces)]]
            trace = _rule_trace(len(traces) + 1, block, rule, readings[0])
            traces.append(trace if len(readings) == 1 else replace(trace, lower=readings[1]))
    return tuple(traces)


def _rule_trace(number: int, block: RuleBlock, rule: Rule, strength: float) -> RuleTrace:
    return RuleTrace(
        number,
        block.name,
        rule.span.line,
        rule.span.column,
        sentence(rule),
        rule.weight,
        strength,
        tuple((c.variable, _worded(c.term, c.hedges)) for c in rule.consequents),
    )


class _Asserted(NamedTuple):
    """An output and the assertions about it at a point."""

    plan: OutputPlan
    rulebase: RuleBase
    point: Outcome
    fired: Fired


def _output(asserted: _Asserted, ends: Mapping[str, tuple[float, float]]) -> OutputTrace:
    plan, fired = asserted.plan, asserted.fired
    if plan.sides:
        return _output_of_type_2(asserted, ends)
    output = plan.output
    consequents = tuple(
        _consequent(asserted, plan.members[member], strength)
        for member, strength in folded_strengths(plan, fired).items()
    )
    union: Curve = ()
    if fired and not plan.discrete:
        corners = {x for consequent in consequents for x, _ in consequent.curve}
        union = _union(aggregate(plan, fired), corners, output.low, output.high)
    return _output_trace(asserted, consequents, union)


def _output_trace(
    asserted: _Asserted, consequents: tuple[ConsequentTrace, ...], union: Curve
) -> OutputTrace:
    output = asserted.plan.output
    defuzzifier = output.defuzzifier
    method = defuzzifier.method
    if defuzzifier.resolution is not None:
        method += f"({defuzzifier.resolution}, {defuzzifier.sampling})"
    return OutputTrace(
        output.name,
        output.low,
        output.high,
        method,
        output.name not in asserted.point.without_value,
        consequents,
        union,
        asserted.point.values[output.name],
    )


def _output_of_type_2(asserted: _Asserted, ends: Mapping[str, tuple[float, float]]) -> OutputTrace:
    """Return an output between two sets: each consequent with both of its readings."""
    plan, rulebase, _, fired = asserted
    name = plan.output.name
    folded = folded_strengths(plan, fired)
    names = {term.name for term in rulebase.output(name).terms}
    consequents = []
    # Each pair is a term of the file: the member of its upper set and that of its lower one.
    for pair in plan.pairs:
        if folded.get(pair[0], 0.0) <= 0.0:
            continue
        upper, lower = (_consequent(asserted, plan.members[i], folded.get(i, 0.0)) for i in pair)
        # One of the two has its name in the file, the other a generated one.
        member = next(plan.members[i] for i in pair if plan.members[i].term.name in names)
        consequents.append(
            replace(
                upper,
                term=_worded(member.term.name, member.hedges),
                lower=lower.strength,
                lower_value=lower.value,
                lower_curve=lower.curve,
            )
        )
    unions: list[Curve] = [(), ()]
    if fired and not plan.discrete:
        for side in (UPPER, LOWER):
            curves = (
                consequent.lower_curve if side else consequent.curve for consequent in consequents
            )
            corners = {x for curve in curves for x, _ in curve}
            here = [(member, strength) for member, strength in fired if plan.sides[member] == side]
            function = aggregate(plan, here)
            unions[side] = _union(function, corners, plan.output.low, plan.output.high)
    trace = _output_trace(asserted, tuple(consequents), unions[0])
    has_ends = plan.record.of == "ends" and trace.fired
    left, right = ends[name] if has_ends else (None, None)
    return replace(trace, lower_aggregate=unions[1], left=left, right=right)


def _consequent(asserted: _Asserted, member: Member, strength: float) -> ConsequentTrace:
    plan = asserted.plan
    value = member.value
    if plan.discrete and value is None:
        if plan.record.inverts and member.pieces:
            value = tsukamoto_position(plan, member, strength)
        else:
            value = _consequent_value(asserted, member)
    curve = () if plan.discrete else _clipped(member, strength)
    return ConsequentTrace(_worded(member.term.name, member.hedges), strength, value, curve)


def _consequent_value(asserted: _Asserted, member: Member) -> float:
    """Return the number of a linear or formula consequent."""
    values = asserted.point.values
    if member.formula is not None:
        return member.term.shape.height * member.formula.evaluate(values)
    *coefficients, constant = member.term.shape.parameters
    for coefficient, variable in zip(coefficients, asserted.rulebase.inputs, strict=True):
        constant += coefficient * values[variable.name]
    return constant


def _clipped(member: Member, strength: float) -> Curve:
    implication = TNORMS[member.implication].scalar
    corners: list[tuple[float, float]] = []
    for piece in member.pieces:
        for x, y in _along(piece, member, strength):
            corner = (x, implication(strength, y))
            if not corners or corners[-1] != corner:
                corners.append(corner)
    return tuple(corners)


def _along(piece: Piece, member: Member, strength: float) -> list[tuple[float, float]]:
    """Return the corners of a piece, with the bend at its clipping level."""
    stops = [(piece.x0, piece.y0), (piece.x1, piece.y1)]
    # Bends of a cut set: `bounded` leaves max(0, y + strength − 1), `nilpotent` the smaller of both
    # where their sum exceeds 1.
    levels = {"min": [strength], "bounded": [1.0 - strength], "nilpotent": [strength, 1 - strength]}
    inside = [
        (crossing(piece, member.membership, level), level)
        for level in levels.get(member.implication, [])
        if (piece.y0 - level) * (piece.y1 - level) < 0.0
    ]
    straight = piece.straight and member.implication in {"min", "product", "bounded"}
    if not straight:
        count = max(4, round(SAMPLES / len(member.pieces)))
        xs = [piece.x0 + (piece.x1 - piece.x0) * i / count for i in range(1, count)]
        inside += [(x, member.membership(x)) for x in xs]
    return [stops[0], *sorted(inside), stops[1]]


def _union(function: Any, corners: set[float], low: float, high: float) -> Curve:
    """Sample the aggregate at its corners, on both sides of vertical edges, and between."""
    even = {low + (high - low) * i / (SAMPLES - 1) for i in range(SAMPLES)} | {high}
    xs = sorted(corners | even)
    curve = [(xs[0], function(xs[0]))]
    for a, b in pairwise(xs):
        # At a vertical edge the higher side counts; a picture shows both.
        start, end = function(math.nextafter(a, b)), function(math.nextafter(b, a))
        if not math.isclose(start, curve[-1][1], abs_tol=1e-9):
            curve.append((a, start))
        curve.append((b, end))
    return tuple(curve)


# ── words ────────────────────────────────────────────────────────────────────────────


def sentence(rule: Rule) -> str:
    """Return a rule in words, for people; names are not quoted."""
    then = " and ".join(f"{c.variable} is {_worded(c.term, c.hedges)}" for c in rule.consequents)
    weight = f" with {rule.weight:g}" if rule.weight != 1.0 else ""
    return f"if {_words(rule.antecedent)} then {then}{weight}"


def _words(expression: Expression, *, inner: bool = False) -> str:
    if isinstance(expression, Is):
        return f"{expression.variable} is {_worded(expression.term, expression.hedges)}"
    if isinstance(expression, Hedged):
        return _worded(f"({_words(expression.operand)})", expression.hedges)
    word = " and " if isinstance(expression, And) else " or "
    text = word.join(_words(operand, inner=True) for operand in expression.operands)
    return f"({text})" if inner else text


def _worded(name: str, hedges: tuple[Hedge, ...]) -> str:
    words = [
        hedge.name if hedge.exponent is None else f"{hedge.name}({hedge.exponent:g})"
        for hedge in hedges
    ]
    return " ".join([*words, name])
