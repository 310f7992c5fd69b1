"""Rule bases in stages: an output read by later rules is an input of the next stage.

The kernel goes from inputs to outputs once. Where rules, or formulas of consequents, read the value
of an output, its rules form a rule base of their own, and its readers another one. A rule that
reads the degrees of an output of its own block needs no stage.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Set
from dataclasses import replace

from fuzzyarm.inference.block import NotCoveredError
from fuzzyarm.inference.plan import Plan, plan, with_coefficients
from fuzzyarm.inference.sets import formula_of
from fuzzyarm.language.model.rulebase import (
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    Shape,
    Term,
    propositions,
    with_propositions,
)


def stages(rulebase: RuleBase) -> tuple[RuleBase, ...]:
    """Return the stages of a rule base, each a function of its inputs and earlier outputs.

    NotCoveredError if formulas read each other's values.
    """
    full = plan(rulebase)
    chained = any(isinstance(step, str) for step in full.steps[: len(full.rules)])
    members = (member for output in full.outputs.values() for member in output.members)
    if not chained and not any(member.formula is not None for member in members):
        return (rulebase,)  # the usual case
    levels = _levels(full)
    count = max(levels.values(), default=1)
    if count == 1:
        return (rulebase,)
    return tuple(_stage(rulebase, full, levels, level) for level in range(1, count + 1))


def _values_read(full: Plan, name: str) -> set[str]:
    """Return the outputs whose values an output depends on."""
    output = full.outputs[name]
    read = {
        part.variable
        for _, rule in output.contributions
        for part in propositions(full.rules[rule].rule.antecedent)
        if part.variable not in full.rules[rule].degrees
    }
    formulas = (member.formula for member in output.members if member.formula is not None)
    read.update(name for formula in formulas for name in formula.names)
    return read & full.outputs.keys()


def _sets_read(full: Plan, names: Iterable[str]) -> set[str]:
    """Return outputs, and all outputs whose degrees they read."""
    reached, new = set[str](), set(names)
    while new:
        reached |= new
        rules = {rule for name in new for _, rule in full.outputs[name].contributions}
        new = {name for rule in rules for name in full.rules[rule].degrees} - reached
    return reached


def _levels(full: Plan) -> dict[str, int]:
    """Return the stage of each output, from 1."""
    levels: dict[str, int] = {}

    def level(name: str, waiting: tuple[str, ...]) -> int:
        if name in waiting:
            raise NotCoveredError(f"the formulas of '{name}' read each other's values")
        if name not in levels:
            sets = _sets_read(full, [name])
            behind = {each for part in sets for each in _values_read(full, part)}
            levels[name] = 1 + max((level(each, (*waiting, name)) for each in behind), default=0)
        return levels[name]

    for name in full.outputs:
        level(name, ())
    return levels


def _stage(rulebase: RuleBase, full: Plan, levels: Mapping[str, int], level: int) -> RuleBase:
    names = _sets_read(full, (name for name in levels if levels[name] == level))
    read = {each for name in names for each in _values_read(full, name)}
    # The value of an output that is read both ways is an input; its set gets another name.
    sets = {name: f"{name} as a set" for name in names & read}
    more = [output for output in rulebase.outputs if output.name in read]

    def wider(output: Output) -> Output:
        return with_coefficients(output, lambda coefficients: (*coefficients, *[0.0] * len(more)))

    upper = iter(full.readings)
    blocks = [
        replace(block, rules=tuple(
            _rule_of_stage(rule, full.rules[next(upper)[0]].degrees, names, sets)
            for rule in block.rules
        ))
        for block in rulebase.blocks
    ]  # fmt: skip
    blocks = [
        replace(block, rules=tuple(rule for rule in block.rules if rule.consequents))
        for block in blocks
    ]
    return replace(
        rulebase,
        # A stated value for no rule may lie outside the range on purpose.
        inputs=(*rulebase.inputs, *(
            Input(each.name, each.low, each.high, each.terms, outside="extend") for each in more
        )),
        outputs=tuple(
            wider(each)
            if each.name not in sets
            else replace(wider(each), name=sets[each.name], no_rule=0.0)
            for each in rulebase.outputs
            if each.name in names
        ),
        blocks=tuple(blocks),
        lookup=None,
        expectations=(),
        properties=(),
    )  # fmt: skip


def _rule_of_stage(rule: Rule, degrees: Set[str], names: Set[str], sets: Mapping[str, str]) -> Rule:
    """Return a rule of a stage: its consequents there, sets under their names there."""

    def renamed(part: Is) -> Is:
        reads_set = part.variable in degrees
        return replace(part, variable=sets.get(part.variable, part.variable)) if reads_set else part

    return replace(
        rule,
        antecedent=with_propositions(rule.antecedent, renamed),
        consequents=tuple(
            replace(c, variable=sets.get(c.variable, c.variable))
            for c in rule.consequents
            if c.variable in names
        ),
    )


def without_values(stage: RuleBase, missing: tuple[str, ...]) -> RuleBase:
    """Return a stage in which earlier outputs have no value: propositions about them are false.

    Their degrees are 0, hedged or not, and a formula of them is NaN.
    """

    def unhedged(part: Is) -> Is:
        return replace(part, hedges=()) if part.variable in missing else part

    def nothing(variable: Input) -> Input:
        terms = (replace(term, shape=_NEVER, lower=None) for term in variable.terms)
        return replace(variable, terms=tuple(terms)) if variable.name in missing else variable

    nan = Shape("linear", (*[0.0] * len(stage.inputs), math.nan))

    def number(term: Term) -> Term:
        shapes = [shape for shape in (term.shape, term.lower) if shape is not None]
        formulas = [formula_of(shape) for shape in shapes if shape.kind == "formula"]
        reads = any({*formula.names} & {*missing} for formula in formulas)
        return replace(term, shape=nan, lower=None) if reads else term

    blocks = (
        replace(block, rules=tuple(
            replace(rule, antecedent=with_propositions(rule.antecedent, unhedged))
            for rule in block.rules
        ))
        for block in stage.blocks
    )  # fmt: skip
    return replace(
        stage,
        inputs=tuple(map(nothing, stage.inputs)),
        outputs=tuple(
            replace(output, terms=tuple(map(number, output.terms))) for output in stage.outputs
        ),
        blocks=tuple(blocks),
    )


_NEVER = Shape("formula", formula="0")
