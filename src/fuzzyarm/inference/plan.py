"""A rule base prepared for evaluation: dependencies and order.

A plan is data in plain Python, shared by the kernel's layout, explanations and proofs. Making it
also finds errors that a model may have: unknown names, cycles, ranges unfit for an integral.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING, Any, NamedTuple

from fuzzyarm.inference import firing_intervals
from fuzzyarm.inference.errors import CyclicRulesError, InferenceError, UnknownNameError
from fuzzyarm.inference.firing_intervals import Doubled, is_value
from fuzzyarm.inference.overlap import ClosedForm, Layers, Overlap, closed_form
from fuzzyarm.inference.prepared import remembered
from fuzzyarm.inference.sets import (
    Piece,
    Stretch,
    formula_of,
    middle_of_core,
    profile,
    stretches,
    term_function,
)
from fuzzyarm.language.model.rulebase import (
    POSITION,
    Consequent,
    Hedge,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
    last_conclusions,
    propositions,
)
from fuzzyarm.symbolic.defuzzifiers import DefuzzifierKind

if TYPE_CHECKING:
    from fuzzyarm.symbolic.formulas import Formula


class Member(NamedTuple):
    """A consequent of an output, one for all the rules that share it."""

    term: Term
    hedges: tuple[Hedge, ...]  # on the term
    implication: str  # how a firing strength cuts the set
    # The set, hedges included, at one position. Not for values.
    membership: Callable[[float], float]
    pieces: tuple[Piece, ...] = ()  # the set over the range of the output; empty for values
    # The representative number of the consequent: the position of a singleton, or the middle of the
    # core under a weighted defuzzifier. None for a function of the inputs, and for integrated sets.
    value: float | None = None
    formula: Formula | None = None  # of a ``formula`` consequent


class OutputPlan(NamedTuple):
    """An output with its members and the rules that assert them."""

    output: Output
    record: DefuzzifierKind
    members: tuple[Member, ...]  # its distinct consequents
    # (index of a member, index of a rule), in the order of the rules.
    contributions: tuple[tuple[int, int], ...]
    discrete: bool  # whether all members are numbers, without sets to integrate
    closed: ClosedForm | None = None  # closed form of the exact centroid, if there is one
    # Stretches where sets may cross, for integration piece by piece.
    stretches: tuple[Stretch, ...] = ()
    # The side of each member, ``UPPER`` or ``LOWER`` of :mod:`.firing_intervals`; empty for a set
    # of type 1.
    sides: tuple[int, ...] = ()
    pairs: tuple[tuple[int, int], ...] = ()  # the upper and the lower member of each consequent
    enveloped: bool = False  # whether its value is found from the upper envelope of straight sets

    @property
    def integrated(self) -> bool:
        """Whether its value is found by quadrature."""
        record = self.record
        if self.discrete or self.output.defuzzifier.resolution is not None:
            return False
        if not record.aspect.integrates:
            return False
        return record.of == "area" or (self.closed is None and not self.enveloped)

    @property
    def in_order(self) -> bool:
        """Whether the order of its rules determines bits: strengths are added, not united."""
        return self.output.aggregation != "max"


class PlannedRule(NamedTuple):
    """A rule with the norms of its block and the outputs whose sets its antecedent reads."""

    rule: Rule
    conjunction: str
    disjunction: str
    degrees: frozenset[str]
    threshold: float = 0.0


class Plan(NamedTuple):
    """A rule base in order of evaluation."""

    rulebase: RuleBase  # as given; of interval type 2 with both ends of every interval
    rules: tuple[PlannedRule, ...]  # in the order of the model
    outputs: dict[str, OutputPlan]  # by name, in the order of the model
    steps: tuple[int | str, ...]  # an index means a rule, a name the defuzzification of an output
    # For each rule as given the indices of its upper and lower reading; of type 1 its own.
    readings: tuple[tuple[int, ...], ...] = ()


@remembered
def plan(rulebase: RuleBase) -> Plan:
    """Prepare a rule base; the last few are cached and shared: do not change them.

    An InferenceError about a model that cannot be evaluated names the position.
    """
    if rulebase.is_type2:
        _check_variables(rulebase)
        return _plan_type_2(firing_intervals.doubled(rulebase))
    steps, rules = _order_once(rulebase)
    outputs = {output.name: _plan_output(rulebase, output) for output in rulebase.outputs}
    return Plan(rulebase, rules, outputs, steps, tuple((i,) for i in range(len(rules))))


def _plan_type_2(doubled: Doubled) -> Plan:
    rulebase = doubled.rulebase
    steps, rules = _order(rulebase)
    outputs = {
        output.name: _both_sides(_plan_output(rulebase, output, doubled), doubled)
        if output.defuzzifier.record.type2
        else _plan_output(rulebase, output)
        for output in rulebase.outputs
    }
    return Plan(rulebase, rules, outputs, steps, doubled.readings)


def _check_variables(rulebase: RuleBase) -> None:
    variables = [*rulebase.inputs, *rulebase.outputs]
    declared = [variable.name for variable in variables]
    if len(set(declared)) < len(declared):
        twice = next(name for name in declared if declared.count(name) > 1)
        raise InferenceError(f"there are two variables called '{twice}'")
    for rule in rulebase.rules:
        parts: list[Is | Consequent] = [*propositions(rule.antecedent), *rule.consequents]
        for part in parts:
            _check_reference(rulebase, part, declared)


def _check_reference(rulebase: RuleBase, part: Is | Consequent, names: list[str]) -> None:
    if part.variable not in names:
        raise UnknownNameError(part.variable, names, what="variable")
    variable = rulebase.variable(part.variable)
    if isinstance(part, Consequent) and isinstance(variable, Input):
        raise InferenceError(f"a rule concludes '{part.variable}', which is an input")
    terms = [term.name for term in variable.terms]
    if part.term not in terms:
        raise UnknownNameError(part.term, terms, what=f"term of '{part.variable}'")
    shape = variable.term(part.term).shape
    if isinstance(part, Is) and isinstance(variable, Input) and shape.kind == "linear":
        raise InferenceError(f"'{part.variable} is {part.term}' has no membership: it is linear")


# ── order ────────────────────────────────────────────────────────────────────────────


class _Ordered(NamedTuple):
    """Rules in order, their sources, and all that they depend on."""

    blocks: tuple[RuleBlock, ...]
    names: tuple[Any, ...]
    steps: tuple[int | str, ...]
    rules: tuple[PlannedRule, ...]


_last_ordered: list[_Ordered] = []
"""Those of the last few rule bases, the newest first."""


def _order_once(rulebase: RuleBase) -> tuple[tuple[int | str, ...], tuple[PlannedRule, ...]]:
    """Check and order the rules; cached.

    In tuning terms move, and everything else is the same object in one rule base after another.
    """
    names = tuple(
        (variable.name, isinstance(variable, Input), *map(_name_of, variable.terms))
        for variable in (*rulebase.inputs, *rulebase.outputs)
    )
    for ordered in _last_ordered:
        if ordered.blocks is rulebase.blocks and ordered.names == names:
            return ordered.steps, ordered.rules
    _check_variables(rulebase)
    steps, rules = _order(rulebase)
    _last_ordered[:] = [_Ordered(rulebase.blocks, names, steps, rules), *_last_ordered[:3]]
    return steps, rules


def _name_of(term: Term) -> tuple[str, str | Shape]:
    """Return the part of a term that rules depend on: name and kind, or the whole of a formula."""
    return term.name, term.shape if term.shape.kind == "formula" else term.shape.kind


def _order(rulebase: RuleBase) -> tuple[tuple[int | str, ...], tuple[PlannedRule, ...]]:
    last = last_conclusions(rulebase)
    steps: list[int | str] = []
    rules: list[PlannedRule] = []
    complete: set[str] = set()
    for number, block in enumerate(rulebase.blocks):
        names = _outputs_used(rulebase, block)
        for name in names:
            if last.get(name, -1) > number:
                raise CyclicRulesError(
                    f"a rule uses '{name}' before all rules that conclude it are evaluated", (name,)
                )
            # Concluded by earlier blocks alone: its value is computed once, before this block.
            if last.get(name, -1) < number and name not in complete:
                complete.add(name)
                steps.append(name)
        # Concluded by this block too: its rules read degrees of terms, not a value.
        open_outputs = frozenset(name for name in names if last.get(name, -1) == number)
        start = len(rules)
        rules += [
            PlannedRule(
                rule,
                block.conjunction,
                block.disjunction,
                _reads(rule, open_outputs),
                block.threshold,
            )
            for rule in block.rules
        ]
        steps += [start + i for i in _sorted_rules(block, open_outputs)]
    steps += [output.name for output in rulebase.outputs if output.name not in complete]
    return tuple(steps), tuple(rules)


def _outputs_used(rulebase: RuleBase, block: RuleBlock) -> list[str]:
    """Return the outputs that a block reads, in antecedents or in formulas of consequents."""
    outputs = {output.name: output for output in rulebase.outputs}
    names = [part.variable for rule in block.rules for part in propositions(rule.antecedent)]
    for rule in block.rules:
        for consequent in rule.consequents:
            shape = outputs[consequent.variable].term(consequent.term).shape
            if shape.kind == "formula":
                names += [n for n in formula_of(shape).names if n != consequent.variable]
    return [name for name in dict.fromkeys(names) if name in outputs]


def _reads(rule: Rule, outputs: Iterable[str]) -> frozenset[str]:
    return frozenset(part.variable for part in propositions(rule.antecedent)) & frozenset(outputs)


def _sorted_rules(block: RuleBlock, outputs: frozenset[str]) -> list[int]:
    """Order the rules of a block so that outputs of its own are complete before they are read."""
    waiting = list(range(len(block.rules)))
    if not outputs:
        return waiting
    ordered: list[int] = []
    while waiting:
        # Kahn's algorithm in whole rounds, so that rules keep their order.
        unfinished = {c.variable for i in waiting for c in block.rules[i].consequents}
        ready = [i for i in waiting if not _reads(block.rules[i], outputs) & unfinished]
        if not ready:
            circle = sorted(unfinished & outputs)
            raise CyclicRulesError(f"the rules go in a circle: {' → '.join(circle)} → …", circle)
        ordered += ready
        waiting = [i for i in waiting if i not in set(ready)]
    return ordered


# ── outputs ──────────────────────────────────────────────────────────────────────────


def _plan_output(rulebase: RuleBase, output: Output, doubled: Doubled | None = None) -> OutputPlan:
    keys: dict[tuple[str, tuple[Hedge, ...], str], int] = {}
    implications: list[str] = []
    record = output.defuzzifier.record
    # A number is weighted, not cut: blocks with different implications share its strength.
    weighs = record.weighs
    if doubled is not None:
        asserted = {
            conclusion.term
            for rule in rulebase.rules
            for conclusion in rule.consequents
            if conclusion.variable == output.name
        }
        weighs = all(is_value(output.term(name).shape) for name in asserted)
    contributions = []
    rule_index = 0
    for block in rulebase.blocks:
        for rule in block.rules:
            for consequent in rule.consequents:
                if consequent.variable == output.name:
                    cut = "" if weighs else block.implication
                    # Rules with one key share a set: their strengths are folded before it is cut.
                    key = (consequent.term, consequent.hedges, cut)
                    if key not in keys:
                        implications.append(block.implication)
                    contributions.append((keys.setdefault(key, len(keys)), rule_index))
            rule_index += 1
    terms = {output.term(name) for name, _, _ in keys}
    discrete = _is_discrete(output, terms)
    members = tuple(
        _member(rulebase, output, output.term(name), hedges, implication, discrete=discrete)
        for (name, hedges, _), implication in zip(keys, implications, strict=True)
    )
    if discrete and not weighs:
        first = _first_of_each_value(members)
        contributions = [(first[member], rule) for member, rule in contributions]
    closed = None if discrete or doubled is not None else _closed(output, members)
    enveloped = _is_enveloped(output, members) and not discrete and closed is None
    output_plan = OutputPlan(
        output, record, members, tuple(contributions), discrete, closed, enveloped=enveloped
    )
    if output.aggregation == "max" and output_plan.integrated and doubled is None:
        return output_plan._replace(stretches=stretches([member.pieces for member in members]))
    return output_plan


def _both_sides(output_plan: OutputPlan, doubled: Doubled) -> OutputPlan:
    """Assign the members to the upper and the lower set, and pair them."""
    output, members = output_plan.output, output_plan.members
    parts = [Consequent(output.name, member.term.name, member.hedges) for member in members]
    sides = tuple(map(doubled.side, parts))
    pairs = _pairs(output, members, sides, doubled)
    if output_plan.discrete:
        return output_plan._replace(sides=sides, pairs=pairs)
    members_by_side = [[i for i in range(len(sides)) if sides[i] == side] for side in (0, 1)]
    closed = _closed_sides(output, members, members_by_side) if output_plan.record.both else None
    output_plan = output_plan._replace(
        sides=sides, pairs=pairs, closed=closed, enveloped=output_plan.enveloped and closed is None
    )
    if output.aggregation == "max" and output_plan.integrated:
        all_stretches = [
            stretch._replace(first=indices[stretch.first], second=indices[stretch.second])
            for indices in members_by_side
            for stretch in stretches([members[i].pieces for i in indices])
        ]
        return output_plan._replace(stretches=tuple(all_stretches))
    return output_plan


def _pairs(
    output: Output, members: tuple[Member, ...], sides: tuple[int, ...], doubled: Doubled
) -> tuple[tuple[int, int], ...]:
    """Return the upper and the lower member of each consequent: both come from one rule."""
    # A lower term is found by the name of its upper one.
    names = {lower: name for (of, name), lower in doubled.lower_names.items() if of == output.name}
    keys = [
        (names.get(entry.term.name, entry.term.name), entry.hedges, entry.implication)
        for entry in members
    ]
    if all(member.pieces == () for member in members):  # values, never cut
        keys = [(name, hedges, "") for name, hedges, _ in keys]
    lower = {key: i for i, key in enumerate(keys) if sides[i] == firing_intervals.LOWER}
    upper = [i for i in range(len(members)) if sides[i] == firing_intervals.UPPER]
    return tuple((i, lower[keys[i]]) for i in upper)


def _closed_sides(
    output: Output, members: tuple[Member, ...], members_by_side: list[list[int]]
) -> ClosedForm | None:
    """Return the closed form of the upper and the lower set together: Nie and Tan's centroid.

    Sets overlap those of their own side only, and areas and moments of both add up.
    """
    forms = [_closed(output, tuple(members[i] for i in indices)) for indices in members_by_side]
    layers: dict[int, Layers] = {}
    overlaps: list[Overlap] = []
    for indices, form in zip(members_by_side, forms, strict=True):
        if form is None:
            return None
        layers |= dict(zip(indices, form.set_layers, strict=True))
        overlaps += [
            Overlap(
                indices[overlap.member], tuple(indices[i] for i in overlap.others), overlap.layers
            )
            for overlap in form.overlaps
        ]
    own_layers = tuple(layers[i] for i in range(len(members)))
    return ClosedForm(0.5 * (output.low + output.high), own_layers, tuple(overlaps))


def _first_of_each_value(members: tuple[Member, ...]) -> list[int]:
    """Return the first member at each position: singletons at one position are one set."""
    first_index: dict[float, int] = {}
    return [
        i if member.value is None else first_index.setdefault(member.value, i)
        for i, member in enumerate(members)
    ]


def _is_discrete(output: Output, terms: Iterable[Term]) -> bool:
    if output.defuzzifier.record.weighs:
        return True
    values = {term.name: is_value(term.shape) for term in terms}
    if any(values.values()) and not all(values.values()):
        value = next(name for name, is_value in values.items() if is_value)
        raise InferenceError(
            f"'{output.name}' mixes values such as '{value}' with sets;"
            f" {output.defuzzifier.method} cannot weigh them together",
            hint="use weighted-average, or make all its terms of one kind",
        )
    return bool(values) and all(values.values())


def _member(
    rulebase: RuleBase,
    output: Output,
    term: Term,
    hedges: tuple[Hedge, ...],
    implication: str,
    *,
    discrete: bool,
) -> Member:
    shape, formula, holds_value = term.shape, None, is_value(term.shape)
    if shape.kind == "formula":
        formula = formula_of(shape)
        # A weighted consequent is a value: its `x` is a variable of that name, not the position.
        holds_value |= output.defuzzifier.record.weighs
        _check_formula(rulebase, output, term, formula, discrete=discrete, is_set=not holds_value)
    if shape.kind == "linear" and len(shape.parameters) != len(rulebase.inputs) + 1:
        raise InferenceError(
            f"'{output.name} is {term.name}' needs {len(rulebase.inputs) + 1} numbers"
            f" (one for each input and the constant), not {len(shape.parameters)}"
        )
    function = term_function(shape, hedges)
    if holds_value and discrete:
        if hedges:
            raise InferenceError(
                f"'{output.name} is {term.name}' is a value, and hedges modify sets only"
            )
        value = shape.parameters[0] if shape.kind == "singleton" else None
        return Member(term, hedges, implication, function, value=value, formula=formula)
    pieces = _pieces(output, term, hedges, function, formula)
    if output.defuzzifier.record.weighs and not output.defuzzifier.record.inverts:
        value = middle_of_core(pieces, function)
        return Member(term, hedges, implication, function, pieces, value)
    return Member(term, hedges, implication, function, pieces, formula=formula)


def _check_formula(
    rulebase: RuleBase,
    output: Output,
    term: Term,
    formula: Formula,
    *,
    discrete: bool,
    is_set: bool,
) -> None:
    from fuzzyarm.symbolic.formulas import CONSTANTS

    declared = [variable.name for variable in (*rulebase.inputs, *rulebase.outputs)]
    for name in formula.names:
        if name == POSITION and name not in declared and not discrete:
            continue
        if name not in declared and name not in CONSTANTS:
            raise UnknownNameError(name, declared, what="variable")
        if name in declared and is_set:
            raise InferenceError(
                f"'{output.name} is {term.name}' is a set: its formula may use {POSITION} only"
            )


def _pieces(
    output: Output,
    term: Term,
    hedges: tuple[Hedge, ...],
    function: Callable[[float], float],
    formula: Formula | None,
) -> tuple[Piece, ...]:
    if not (math.isfinite(output.low) and math.isfinite(output.high)):
        raise InferenceError(
            f"{output.defuzzifier.method} needs a finite range, and that of '{output.name}'"
            f" is {output.low:g} .. {output.high:g}"
        )
    if formula is not None:  # a formula bends anywhere: cut like a sigmoid of unknown position
        framed = Shape("arc", (output.low, output.high))
        return profile(framed, (), function, output.low, output.high)
    return profile(term.shape, hedges, function, output.low, output.high)


def _closed(output: Output, members: tuple[Member, ...]) -> ClosedForm | None:
    """Return the closed form of the exact centroid, if it exists."""
    defuzzifier = output.defuzzifier
    if defuzzifier.record.of != "gravity" or defuzzifier.resolution is not None:
        return None
    if output.aggregation not in {"max", "sum"}:
        return None
    if any(member.implication != "min" for member in members):
        return None
    profiles = [member.pieces for member in members]
    return closed_form(profiles, output.low, output.high, united=output.aggregation == "max")


def _is_enveloped(output: Output, members: Sequence[Member]) -> bool:
    defuzzifier = output.defuzzifier
    of_area = defuzzifier.record.of in ("gravity", "ends")
    exact = of_area and defuzzifier.resolution is None
    return exact and bool(members) and has_envelope(output, members)


def has_envelope(output: Output, members: Sequence[Member]) -> bool:
    """Whether all sets are straight, cut by min or scaled by product, and united by max."""
    return (
        output.aggregation == "max"
        and all(member.implication in {"min", "product"} for member in members)
        and all(piece.straight for member in members for piece in member.pieces)
    )


# ── a part of a rule base ────────────────────────────────────────────────────────────


def needed(plan: Plan, names: Iterable[str]) -> tuple[set[str], set[int]]:
    """Return the outputs and the rules that some outputs depend on, these outputs included."""
    outputs, rules = set(names), set[int]()
    while True:
        more = {
            rule
            for name in outputs
            for _, rule in plan.outputs[name].contributions
            if plan.rules[rule].rule.weight != 0.0
        }
        # To a fixed point: outputs read by a needed one are needed as well.
        further = _read(plan, outputs, more) & plan.outputs.keys()
        if more == rules and further <= outputs:
            return outputs, rules
        outputs, rules = outputs | further, more


def read_by(plan: Plan, output: str) -> set[str]:
    """Return the outputs that one output depends on directly."""
    rules = [
        rule
        for _, rule in plan.outputs[output].contributions
        if plan.rules[rule].rule.weight != 0.0
    ]
    return _read(plan, [output], rules) & plan.outputs.keys()


def _read(plan: Plan, outputs: Iterable[str], rules: Iterable[int]) -> set[str]:
    """Return the variables read by rules, and those in formulas of consequents."""
    antecedents = [plan.rules[rule].rule.antecedent for rule in rules]
    names = {part.variable for antecedent in antecedents for part in propositions(antecedent)}
    members = [member for name in outputs for member in plan.outputs[name].members]
    return names | {name for member in members if member.formula for name in member.formula.names}


@remembered
def _parts(rulebase: RuleBase) -> dict[tuple[str, ...], RuleBase]:
    return {}


def part_for(rulebase: RuleBase, outputs: Iterable[str]) -> RuleBase:
    """Return the part of a rule base that some outputs depend on; the last few are cached.

    It has the necessary rules, inputs and other outputs, the first input if the outputs depend on
    none, and is the rule base itself if that is all of it.
    """
    names = tuple(outputs)
    parts = _parts(rulebase)
    if names not in parts:
        parts[names] = _part_for(rulebase, names)
    return parts[names]


def _part_for(rulebase: RuleBase, outputs: tuple[str, ...]) -> RuleBase:
    full_plan = plan(rulebase)
    for name in outputs:
        if name not in full_plan.outputs:
            raise UnknownNameError(name, full_plan.outputs, what="output")
    names, needed_readings = needed(full_plan, outputs)
    rules = {
        i
        for i, readings_here in enumerate(full_plan.readings)
        if needed_readings & set(readings_here)
    }
    names_read = _read(full_plan, names, needed_readings)
    # A linear consequent names no inputs: it has a coefficient for each.
    linear = [
        shape.parameters
        for output in rulebase.outputs
        for term in output.terms
        for shape in (term.shape, term.lower)
        if output.name in names and shape is not None and shape.kind == "linear"
    ]
    inputs = [
        i
        for i, variable in enumerate(rulebase.inputs)
        if variable.name in names_read or any(parameters[i] != 0.0 for parameters in linear)
    ] or list(range(len(rulebase.inputs)))[:1]
    if len(inputs) == len(rulebase.inputs) and len(names) == len(rulebase.outputs):
        return rulebase
    number = count()
    return replace(
        rulebase,
        inputs=tuple(rulebase.inputs[i] for i in inputs),
        outputs=tuple(
            with_coefficients(output, lambda coefficients: (coefficients[i] for i in inputs))
            for output in rulebase.outputs
            if output.name in names
        ),
        blocks=tuple(
            replace(
                block,
                rules=tuple(
                    replace(
                        rule,
                        consequents=tuple(c for c in rule.consequents if c.variable in names),
                    )
                    for rule in block.rules
                    if next(number) in rules
                ),
            )
            for block in rulebase.blocks
        ),
        lookup=None,
        expectations=(),
        properties=(),
    )


def with_coefficients(
    output: Output, change: Callable[[Sequence[float]], Iterable[float]]
) -> Output:
    """Return an output whose linear terms have other coefficients of the inputs."""

    def changed(shape: Shape) -> Shape:
        if shape.kind != "linear":
            return shape
        *coefficients, constant = shape.parameters
        return replace(shape, parameters=(*change(coefficients), constant))

    return replace(
        output,
        terms=tuple(
            replace(term, shape=changed(term.shape), lower=term.lower and changed(term.lower))
            for term in output.terms
        ),
    )
