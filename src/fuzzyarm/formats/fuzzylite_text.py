"""Write rules as fuzzylite reads them, in FLL and in its dialect of FCL."""

from __future__ import annotations

import math

from fuzzyarm.formats.export import Names, without_any
from fuzzyarm.formats.fuzzylite_rules import hedged_weight
from fuzzyarm.formats.imported import Findings
from fuzzyarm.formats.numerals import written
from fuzzyarm.formats.propositions import NOT, hedged
from fuzzyarm.rulebase.model import And, Expression, Hedge, Hedged, Is, Or, Rule, RuleBlock

_HEDGES = {
    "any": "any",
    "intensify": "extremely",
    "not": "not",
    "seldom": "seldom",
    "somewhat": "somewhat",
    "very": "very",
}
DUALS = {
    "min": "max",
    "product": "probor",
    "bounded": "bounded",
    "drastic": "drastic",
    "hamacher": "hamacher",
    "einstein": "einstein",
    "nilpotent": "nilpotent",
}
"""T-norm → S-norm with not (a and b) = not a or not b."""


def rule_text(rule: Rule, block: RuleBlock, names: Names, findings: Findings) -> str:
    """Return ``if … then …``; report hedges that cannot be said."""
    antecedent, hedges, weight = _split(rule)
    condition = _condition(antecedent, block, names, findings)
    outer = _hedge_words(hedges, findings)
    conclusions = []
    for index, consequent in enumerate(rule.consequents):
        if consequent.hedges:
            message = "hedges on the set of a conclusion have another meaning to fuzzylite"
            findings.loss("set-hedge", message, rule.span)
        term = names.term(consequent.variable, consequent.term)
        words = outer if index == 0 else []  # they carry on to the conclusions after it
        conclusions.append(" ".join([names.variable(consequent.variable), "is", *words, term]))
    ending = "" if weight == 1.0 else f" with {written(weight)}"
    return f"if {condition} then {' and '.join(conclusions)}{ending}"


def _split(rule: Rule) -> tuple[Expression, tuple[Hedge, ...], float]:
    """Take the hedges around a whole antecedent off, with the weight they then need."""
    if not isinstance(rule.antecedent, Hedged):
        return rule.antecedent, (), rule.weight
    hedges, operand = rule.antecedent.hedges, rule.antecedent.operand
    weight = _weight_before(rule.weight, hedges)
    if weight is None:
        return rule.antecedent, (), rule.weight
    return operand, hedges, weight


def _weight_before(weight: float, hedges: tuple[Hedge, ...]) -> float | None:
    """Return w with ``hedged_weight(w, hedges) == weight`` to the last bit, or None."""
    if weight == 1.0:
        return 1.0
    guess = weight
    for hedge in hedges:
        if hedge.name == "very" and guess >= 0.0:
            guess = math.sqrt(guess)
        elif hedge.name == "somewhat":
            guess = guess * guess
        else:
            return None
    for candidate in (guess, math.nextafter(guess, math.inf), math.nextafter(guess, 0.0)):
        if hedged_weight(candidate, hedges) == weight:
            return candidate
    return None


def _hedge_words(hedges: tuple[Hedge, ...], findings: Findings) -> list[str]:
    words = []
    for hedge in hedges:
        if hedge.name not in _HEDGES:
            said = hedge.name if hedge.exponent is None else f"power({hedge.exponent})"
            findings.loss("unsupported-hedge", f"fuzzylite has no hedge '{said}'")
            continue
        words.append(_HEDGES[hedge.name])
    return words


def _condition(expression: Expression, block: RuleBlock, names: Names, findings: Findings) -> str:
    if isinstance(expression, Is):
        return _proposition(expression, names, findings)
    if isinstance(expression, Hedged):
        return _condition(_pushed_in(expression, block, findings), block, names, findings)
    word = " and " if isinstance(expression, And) else " or "
    parts = []
    for operand in expression.operands:
        inner = _pushed_in(operand, block, findings) if isinstance(operand, Hedged) else operand
        text = _condition(inner, block, names, findings)
        closed = isinstance(inner, Or) or type(inner) is type(expression)
        parts.append(f"( {text} )" if closed else text)
    return word.join(parts)


def _pushed_in(expression: Hedged, block: RuleBlock, findings: Findings) -> Expression:
    """Return the same without hedges on an ``and`` or ``or``, where that can be."""
    operand = expression.operand
    if isinstance(operand, Is | Hedged):
        return hedged(expression.hedges, operand)
    negations = len(expression.hedges)
    dual = DUALS.get(block.conjunction) == block.disjunction
    if all(hedge == NOT for hedge in expression.hedges):
        if negations % 2 == 0:
            return operand
        if dual:
            kind = Or if isinstance(operand, And) else And
            return kind(tuple(hedged((NOT,), inner) for inner in operand.operands))
    message = "fuzzylite has no hedges on expressions in parentheses"
    findings.loss("hedged-expression", message)
    return operand


def _proposition(proposition: Is, names: Names, findings: Findings) -> str:
    hedges, any_term = without_any(proposition.hedges)
    words = [names.variable(proposition.variable), "is", *_hedge_words(hedges, findings)]
    if not any_term:
        words.append(names.term(proposition.variable, proposition.term))
    return " ".join(words)
