"""Terms and rules in the words of jFuzzyLogic."""

from __future__ import annotations

import math
from dataclasses import replace

from fuzzyarm.formats.export import Names
from fuzzyarm.formats.formula import JFUZZYLOGIC_NAMES, Node, read_formula, write_formula
from fuzzyarm.formats.imported import Findings
from fuzzyarm.formats.numerals import all_written, written
from fuzzyarm.formats.rule_text import NOT
from fuzzyarm.rulebase.model import (
    And,
    Expression,
    Hedge,
    Hedged,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    Shape,
    Term,
)

# Kind of shape → word and the order of the numbers in the text.
_WORDS: dict[str, tuple[str, tuple[int, ...]]] = {
    "triangle": ("TRIAN", (0, 1, 2)),
    "trapezoid": ("TRAPE", (0, 1, 2, 3)),
    "gaussian": ("GAUSS", (0, 1)),
    "two-sided-gaussian": ("GAUSS2", (0, 1, 2, 3)),
    "bell": ("GBELL", (1, 2, 0)),
    "sigmoid": ("SIGM", (1, 0)),
    "sigmoid-difference": ("DSIGM", (1, 0, 3, 2)),
}


def plain_term(
    variable: Input | Output, term: Term, rulebase: RuleBase, names: Names, findings: Findings
) -> str:
    """Return the function of a term; report what jFuzzyLogic has nothing for."""
    shape, p = term.shape, term.shape.parameters
    if shape.height != 1.0:
        message = f"the height of '{term.name}' of '{variable.name}' has no place in FCL"
        findings.loss("unsupported-height", message, term.span)
    text = _value(shape, rulebase, names, findings) or _straight(shape) or _curve(shape)
    if text is None:
        message = f"jFuzzyLogic has nothing like '{term.name}' of '{variable.name}' ({shape.kind})"
        findings.loss("unsupported-shape", message, term.span)
        return "0"
    if shape.kind == "sigmoid-difference" and (p[1] <= 0.0 or p[1] != p[3] or p[0] > p[2]):
        message = f"'{term.name}' is a difference that jFuzzyLogic cuts at 0"
        findings.loss("negative-difference", message, term.span)
    return text


def _value(shape: Shape, rulebase: RuleBase, names: Names, findings: Findings) -> str | None:
    p = shape.parameters
    if shape.kind == "singleton":
        return written(p[0])
    if shape.kind == "linear":
        inputs = [names.variable(variable.name) for variable in rulebase.inputs]
        factors = [f"{written(a)} * {name}" for a, name in zip(p, inputs, strict=False)]
        return "FUNCTION " + " + ".join([*factors, written(p[-1])])
    if shape.kind == "formula":
        return f"FUNCTION {_formula(shape.formula, names, findings)}"
    return None


def _straight(shape: Shape) -> str | None:
    p = shape.parameters
    if shape.kind == "points":
        return _pairs(_first_wins(p))
    if not all(map(math.isfinite, p)):
        return None
    if shape.kind == "rectangle":
        return f"TRAPE {all_written((p[0], p[0], p[1], p[1]))}"
    if shape.kind == "ramp" and p[0] != p[1]:
        return _pairs((p[0], 0.0, p[1], 1.0) if p[0] < p[1] else (p[1], 1.0, p[0], 0.0))
    return None


def _curve(shape: Shape) -> str | None:
    p = shape.parameters
    if shape.kind == "cosine":
        return f"COSINE {written(0.5 * p[1])} {written(p[0])}"
    if shape.kind not in _WORDS or not all(map(math.isfinite, p)):
        return None
    word, order = _WORDS[shape.kind]
    return f"{word} {all_written(tuple(p[index] for index in order))}"


def _pairs(values: tuple[float, ...]) -> str:
    pairs = zip(values[0::2], values[1::2], strict=True)
    return " ".join(f"({written(x)}, {written(y)})" for x, y in pairs)


def _first_wins(parameters: tuple[float, ...]) -> tuple[float, ...]:
    """Move points so that the first of two at one x is the larger, as the model takes it."""
    values = list(parameters)
    for i in range(2, len(values), 2):
        if values[i] == values[i - 2] and values[i - 1] < values[i + 1]:
            values[i - 2] = math.nextafter(values[i - 2], -math.inf)
    return tuple(values)


def _formula(text: str, names: Names, findings: Findings) -> str:
    tree = read_formula(text, "fuzzyarm")
    for function in _calls(tree):
        if function not in JFUZZYLOGIC_NAMES:
            message = f"jFuzzyLogic has no function '{function}'"
            findings.loss("unsupported-function", message)
    return write_formula(_without_signs(tree), names.variables, JFUZZYLOGIC_NAMES)


def _without_signs(node: Node) -> Node:
    """Write -(a) as 0 - (a): jFuzzyLogic knows signs of numbers only."""
    arguments = tuple(map(_without_signs, node.arguments))
    if len(arguments) == 1 and not node.is_call:
        arguments = (Node("0"), *arguments)
    return replace(node, arguments=arguments)


def _calls(node: Node) -> list[str]:
    inner = [name for argument in node.arguments for name in _calls(argument)]
    return [node.symbol, *inner] if node.is_call else inner


def plain_rule(rule: Rule, names: Names, findings: Findings) -> str:
    """Return ``IF … THEN …``; jFuzzyLogic has no hedge but NOT."""
    condition = _condition(rule.antecedent, names, findings, rule)
    conclusions = []
    for consequent in rule.consequents:
        if consequent.hedges:
            message = "jFuzzyLogic has no hedges in conclusions"
            findings.loss("set-hedge", message, rule.span)
        term = names.term(consequent.variable, consequent.term)
        conclusions.append(f"{names.variable(consequent.variable)} IS {term}")
    ending = "" if rule.weight == 1.0 else f" WITH {written(rule.weight)}"
    return f"IF {condition} THEN {', '.join(conclusions)}{ending}"


def _condition(expression: Expression, names: Names, findings: Findings, rule: Rule) -> str:
    if isinstance(expression, Is):
        words = _nots(expression.hedges, findings, rule)
        term = names.term(expression.variable, expression.term)
        return " ".join([*words, names.variable(expression.variable), "IS", term])
    if isinstance(expression, Hedged):
        inner = _condition(expression.operand, names, findings, rule)
        return " ".join([*_nots(expression.hedges, findings, rule), f"({inner})"])
    word = " AND " if isinstance(expression, And) else " OR "
    return word.join(
        f"({_condition(operand, names, findings, rule)})"
        if isinstance(operand, And | Or)
        else _condition(operand, names, findings, rule)
        for operand in expression.operands
    )


def _nots(hedges: tuple[Hedge, ...], findings: Findings, rule: Rule) -> list[str]:
    for hedge in hedges:
        if hedge != NOT:
            message = f"jFuzzyLogic has no hedge '{hedge.name}'"
            findings.loss("unsupported-hedge", message, rule.span)
    return ["NOT"] * (sum(hedge == NOT for hedge in hedges) % 2)
