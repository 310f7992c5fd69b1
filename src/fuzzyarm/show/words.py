"""Rules, shapes and numbers in the words of the language."""

from __future__ import annotations

from functools import partial

from fuzzyarm.rulebase.model import Expression, Hedge, Hedged, Is, Or, Rule, RuleBase, Shape
from fuzzyarm.rulebase.printing.words import name_text, number_text


def name_words(name: str) -> str:
    """Return `name` as it stands in a file."""
    return name_text(name)


def number_words(x: float, digits: int = 6) -> str:
    """Return `x` to at most `digits` significant digits, for reading."""
    rounded = float(f"{x:.{digits}g}") + 0.0
    return number_text(rounded)


def expression_words(expression: Expression) -> str:
    """Return an antecedent as it would be written."""
    if isinstance(expression, Is):
        hedges = hedge_words(expression.hedges)
        return f"{name_text(expression.variable)} is {hedges}{name_text(expression.term)}"
    if isinstance(expression, Hedged):
        return f"{hedge_words(expression.hedges)}({expression_words(expression.operand)})"
    word = " or " if isinstance(expression, Or) else " and "
    return word.join(_operand(operand, expression) for operand in expression.operands)


def _operand(operand: Expression, parent: Expression) -> str:
    text = expression_words(operand)
    if isinstance(operand, (Is, Hedged)) or (
        isinstance(parent, Or) and not isinstance(operand, Or)
    ):
        return text
    return f"({text})"


def hedge_words(hedges: tuple[Hedge, ...]) -> str:
    """Return hedges, each with a space behind it."""
    return "".join(
        f"{h.name}({number_text(h.exponent)}) " if h.exponent is not None else f"{h.name} "
        for h in hedges
    )


def rule_words(rule: Rule) -> str:
    """Return a rule as one ``if … then …`` sentence."""
    results = " and ".join(
        f"{name_text(c.variable)} is {hedge_words(c.hedges)}{name_text(c.term)}"
        for c in rule.consequents
    )
    weight = "" if rule.weight == 1.0 else f" with {number_text(rule.weight)}"
    return f"if {expression_words(rule.antecedent)} then {results}{weight}"


def consequent_words(rule: Rule, term: str) -> str:
    """Return the content of a grid cell: the term and the weight, if it is not 1."""
    return term if rule.weight == 1.0 else f"{term}*{number_text(rule.weight)}"


def shape_words(
    shape: Shape, rulebase: RuleBase | None = None, *, digits: int | None = None
) -> str:
    """Return a shape with its numbers, in full or to a few `digits` for reading."""
    if shape.kind == "formula":
        return f"formula {shape.formula}"
    if shape.kind == "linear":
        return _linear_words(shape, rulebase)
    spell = number_text if digits is None else partial(number_words, digits=digits)
    numbers = " ".join(spell(x) for x in shape.parameters)
    height = "" if shape.height == 1.0 else f" height {number_text(shape.height)}"
    return f"{shape.kind} {numbers}{height}"


def _linear_words(shape: Shape, rulebase: RuleBase | None) -> str:
    *factors, constant = shape.parameters
    names = (
        [v.name for v in rulebase.inputs] if rulebase else [f"x{k}" for k in range(len(factors))]
    )
    parts = [
        f"{number_text(factor)}*{name_text(name)}"
        for factor, name in zip(factors, names, strict=False)
        if factor
    ]
    if constant or not parts:
        parts.append(number_text(constant))
    return "linear " + " + ".join(parts)
