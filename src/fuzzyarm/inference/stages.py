"""Rule bases in stages: an output that later rules read is an input of the stage behind it.

The kernel goes from inputs to outputs once. Where rules, or formulas of consequents, read the
value of an output, those that conclude it are a rule base of their own, and what reads it is
another one. A rule that reads how far an output of its own block is asserted needs no stage.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from fuzzyarm.inference.block import NotCoveredError
from fuzzyarm.inference.plan import Plan, plan
from fuzzyarm.language.model.rulebase import Input, Output, RuleBase, Shape, propositions


def stages(rulebase: RuleBase) -> tuple[RuleBase, ...]:
    """Return rule bases that give the outputs of one, each from its inputs and earlier outputs.

    Raises
    ------
    NotCoveredError
        If rules read an output as a value and, at the same time, how far it is asserted.
    """
    full = plan(rulebase)
    chained = any(isinstance(step, str) for step in full.steps[: len(full.rules)])
    members = (member for output in full.outputs.values() for member in output.members)
    if not chained and not any(member.formula is not None for member in members):
        return (rulebase,)  # as nearly all
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
    """Return outputs, and all of which they read how far these are asserted."""
    found, new = set[str](), set(names)
    while new:
        found |= new
        rules = {rule for name in new for _, rule in full.outputs[name].contributions}
        new = {name for rule in rules for name in full.rules[rule].degrees} - found
    return found


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
    both = names & read
    if both:
        raise NotCoveredError(f"'{min(both)}' is read as a value and as a set")
    more = [output for output in rulebase.outputs if output.name in read]
    blocks = [
        replace(block, rules=tuple(
            replace(rule, consequents=tuple(c for c in rule.consequents if c.variable in names))
            for rule in block.rules
            if any(c.variable in names for c in rule.consequents)
        ))
        for block in rulebase.blocks
    ]  # fmt: skip
    return replace(
        rulebase,
        # What was stated for silence may lie outside the range on purpose.
        inputs=(*rulebase.inputs, *(
            Input(each.name, each.low, each.high, each.terms, outside="extend") for each in more
        )),
        outputs=tuple(
            _over_more(each, len(more)) for each in rulebase.outputs if each.name in names
        ),
        blocks=tuple(blocks),
        lookup=None,
        expectations=(),
        properties=(),
    )  # fmt: skip


def _over_more(output: Output, more: int) -> Output:
    """Return an output whose linear terms have so many more coefficients, of nothing."""

    def over(shape: Shape) -> Shape:
        if shape.kind != "linear":
            return shape
        *coefficients, constant = shape.parameters
        return replace(shape, parameters=(*coefficients, *[0.0] * more, constant))

    return replace(
        output,
        terms=tuple(
            replace(term, shape=over(term.shape), lower=term.lower and over(term.lower))
            for term in output.terms
        ),
    )
