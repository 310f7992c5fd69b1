"""Write FLL for fuzzylite 7 and 8."""

from __future__ import annotations

import math

from fuzzyarm.formats.findings import VALUES, Exported, Findings, written
from fuzzyarm.formats.fll.reader import DEFAULT_RESOLUTION, INTEGRAL, term_text
from fuzzyarm.formats.shapes import FLL_CONJUNCTIONS, FLL_DISJUNCTIONS, fuzzylite_shape, reverse
from fuzzyarm.formats.writing import (
    FUZZYLITE_WORDS,
    HEADER,
    Names,
    identifiers,
    note_chaining,
    note_left_out,
    one_line,
    rule_text,
    said_rules,
)
from fuzzyarm.model.rulebase import Input, Output, RuleBase, RuleBlock, Term

_CONJUNCTIONS = reverse(FLL_CONJUNCTIONS)
_DISJUNCTIONS = reverse(FLL_DISJUNCTIONS)
_INTEGRAL = reverse(INTEGRAL)


def write_fll(rulebase: RuleBase, *, lossy: bool = False) -> Exported:
    """Write a rule base as an engine of fuzzylite.

    Parameters
    ----------
    rulebase : RuleBase
        Any.
    lossy : bool
        Whether to write even where fuzzylite would give other numbers.

    Returns
    -------
    Exported
        The text, unless something cannot be expressed and `lossy` is not set.
    """
    findings = Findings(lossy=lossy)
    note_left_out(rulebase, findings, descriptions=True)
    note_chaining(rulebase, findings, "fuzzylite", own=True)
    names = identifiers(rulebase, findings, FUZZYLITE_WORDS)
    lines = [f"# {HEADER}.", f"Engine: {one_line(rulebase.name, '#', findings)}"]
    if rulebase.description:
        lines.append(f"description: {one_line(rulebase.description, '#', findings)}")
    for variable in rulebase.inputs:
        lines += _variable(variable, names, findings)
    for output in rulebase.outputs:
        lines += _variable(output, names, findings)
    for block in rulebase.blocks:
        lines += _block(block, names, findings)
    text = None if findings.failed else "\n".join(lines) + "\n"
    return Exported(text, findings.all())


def _variable(variable: Input | Output, names: Names, findings: Findings) -> list[str]:
    kind = "OutputVariable" if isinstance(variable, Output) else "InputVariable"
    lines = [f"{kind}: {names.variable(variable.name)}"]
    if variable.description:
        lines.append(f"  description: {one_line(variable.description, '#', findings)}")
    lines += [
        "  enabled: true",
        f"  range: {written(variable.low)} {written(variable.high)}",
        f"  lock-range: {'false' if variable.outside == 'extend' else 'true'}",
    ]
    if isinstance(variable, Output):
        lines += _output(variable, findings)
    for term in variable.terms:
        lines.append(f"  term: {_term(variable, term, names, findings)}")
    return lines


def _term(variable: Input | Output, term: Term, names: Names, findings: Findings) -> str:
    text = term_text(fuzzylite_shape(term.shape), names.variables)
    if text is None:
        message = f"the height of '{term.name}' of '{variable.name}' has no place in fuzzylite"
        findings.loss("unsupported-height", message, term.span)
        text = f"Constant {written(term.shape.parameters[-1])}"
    return f"{names.term(variable.name, term.name)} {text}"


def _output(output: Output, findings: Findings) -> list[str]:
    weighted = output.defuzzifier.method not in _INTEGRAL
    plain = weighted and output.aggregation == "sum"
    aggregation = "none" if plain else _DISJUNCTIONS[output.aggregation]
    if output.no_rule == "error":
        message = f"'{output.name}' is an error where no rule fires; fuzzylite gives nan"
        findings.warn("no-rule", message)
    no_rule = output.no_rule if isinstance(output.no_rule, float | int) else math.nan
    return [
        f"  aggregation: {aggregation}",
        f"  defuzzifier: {_defuzzifier(output, findings)}",
        f"  default: {written(no_rule)}",
        f"  lock-previous: {'true' if output.no_rule == 'hold' else 'false'}",
    ]


def _defuzzifier(output: Output, findings: Findings) -> str:
    defuzzifier = output.defuzzifier
    kinds = {term.shape.kind for term in output.terms}
    if defuzzifier.method == "tsukamoto":
        return "WeightedAverage Tsukamoto"
    if defuzzifier.method in ("weighted-average", "weighted-sum"):
        if not kinds <= VALUES:
            message = f"'{output.name}' has sets where fuzzylite needs values"
            findings.loss("set-as-value", message)
        word = "Average" if defuzzifier.method == "weighted-average" else "Sum"
        return f"Weighted{word} TakagiSugeno"
    if kinds & VALUES:
        message = f"'{output.name}' has values among its terms, which fuzzylite takes for sets"
        findings.loss("value-as-set", message)
    if defuzzifier.resolution is None or defuzzifier.sampling != "midpoints":
        message = f"'{output.name}' is not defuzzified at midpoints, as fuzzylite does"
        findings.loss("sampling", message)
    return f"{_INTEGRAL[defuzzifier.method]} {defuzzifier.resolution or DEFAULT_RESOLUTION}"


def _block(block: RuleBlock, names: Names, findings: Findings) -> list[str]:
    return [
        f"RuleBlock: {one_line(block.name, '#', findings)}",
        "  enabled: true",
        f"  conjunction: {_CONJUNCTIONS[block.conjunction]}",
        f"  disjunction: {_DISJUNCTIONS[block.disjunction]}",
        f"  implication: {_CONJUNCTIONS[block.implication]}",
        f"  activation: {_activation(block)}",
        *(f"  rule: {rule_text(said, block, names, findings)}" for said in said_rules(block)),
    ]


def _activation(block: RuleBlock) -> str:
    return "General" if block.threshold == 0.0 else f"Threshold > {written(block.threshold)}"
