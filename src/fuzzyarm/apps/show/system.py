"""A rule base as a block diagram: its inputs, the rules of each output, its outputs."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain

from fuzzyarm.apps.show.diagram import Diagram, DiagramBlock, DiagramWire, laid_out
from fuzzyarm.base.numbers import counted, number_text
from fuzzyarm.inference.sets import formula_of
from fuzzyarm.language.model.rulebase import Input, Output, Rule, RuleBase, propositions


def system_diagram(rulebase: RuleBase) -> Diagram:
    """Return the block diagram of a rule base."""
    rules = {output.name: _rules_of(rulebase, output) for output in rulebase.outputs}
    read = {output.name: _variables_read(rulebase, output, rules) for output in rulebase.outputs}
    blocks = [_variable_block("input", each) for each in rulebase.inputs]
    sources = {each.name: index for index, each in enumerate(rulebase.inputs)}
    wires: list[DiagramWire] = []
    for output in _in_order(rulebase.outputs, read):
        # Rules that read an activation (of a term so far) are left out: no wire of
        # the diagram goes back.
        names = [name for name in read[output.name] if name in sources]
        blocks.append(_rules_block(rulebase, output, rules[output.name], len(names)))
        here = len(blocks) - 1
        wires += (DiagramWire(sources[name], 0, here, at, "") for at, name in enumerate(names))
        blocks.append(_variable_block("output", output))
        wires.append(DiagramWire(here, 0, here + 1, 0, ""))
        sources[output.name] = here
    (placed, routed), layout = laid_out(blocks, wires)
    count = len(rulebase.rules)
    return Diagram(
        rulebase.name,
        rulebase.description,
        counted(count, "rule"),
        tuple(placed),
        tuple(routed),
        (),
        tuple(layout.tracks),
        layout.height,
    )


def _rules_of(rulebase: RuleBase, output: Output) -> list[Rule]:
    return [
        rule
        for rule in rulebase.rules
        if any(consequent.variable == output.name for consequent in rule.consequents)
    ]


def _variables_read(rulebase: RuleBase, output: Output, rules: dict[str, list[Rule]]) -> list[str]:
    """Return the variables in the rules and formulas of an output, in the order of the file."""
    own = rules[output.name]
    read = {part.variable for rule in own for part in propositions(rule.antecedent)}
    concluded = {
        consequent.term
        for rule in own
        for consequent in rule.consequents
        if consequent.variable == output.name
    }
    for term in output.terms:
        if term.name not in concluded:
            continue
        if term.shape.kind == "formula":
            read.update(formula_of(term.shape).names)
        elif term.shape.kind == "linear":
            pairs = zip(rulebase.inputs, term.shape.parameters, strict=False)
            read.update(variable.name for variable, factor in pairs if factor)
    variables: Iterable[Input | Output] = chain(rulebase.inputs, rulebase.outputs)
    return [each.name for each in variables if each.name in read and each.name != output.name]


def _in_order(outputs: Iterable[Output], read: dict[str, list[str]]) -> list[Output]:
    """Return outputs after those that they read, otherwise in the order of the file."""
    waiting, ordered = list(outputs), list[Output]()
    while waiting:
        names = {each.name for each in waiting}
        ready = (each for each in waiting if names.isdisjoint(read[each.name]))
        ordered.append(next(ready, waiting[0]))
        waiting.remove(ordered[-1])
    return ordered


def _variable_block(kind: str, variable: Input | Output) -> DiagramBlock:
    details = [f"{number_text(variable.low)} .. {number_text(variable.high)}"]
    if variable.terms:
        details.append(counted(len(variable.terms), "term"))
    if isinstance(variable, Output):
        details.append(str(variable.defuzzifier))
    inputs, outputs = (("",), ()) if kind == "output" else ((), ("",))
    return DiagramBlock(kind, variable.name, tuple(details), (), inputs, outputs, variable.span)


def _rules_block(
    rulebase: RuleBase, output: Output, rules: list[Rule], inputs: int
) -> DiagramBlock:
    label = rulebase.name if len(rulebase.outputs) == 1 else f"rules for {output.name}"
    norms = [
        f"and {block.conjunction}, or {block.disjunction}"
        for block in rulebase.blocks
        if any(rule in block.rules for rule in rules)
    ]
    details = (counted(len(rules), "rule"), *dict.fromkeys(norms))
    span = rules[0].span if rules else output.span
    return DiagramBlock("rules", label, details, (), ("",) * inputs, ("",), span)
