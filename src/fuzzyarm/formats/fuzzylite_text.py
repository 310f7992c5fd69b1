"""Write rules as fuzzylite reads them, in FLL and in its dialect of FCL."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fuzzyarm.formats.export import Names, without_any
from fuzzyarm.formats.fuzzylite_rules import POWERS, hedged_weight
from fuzzyarm.formats.imported import Findings
from fuzzyarm.formats.numerals import written
from fuzzyarm.formats.rule_text import NOT, hedged
from fuzzyarm.rulebase.model import (
    And,
    Consequent,
    Expression,
    Hedge,
    Hedged,
    Is,
    Or,
    Rule,
    RuleBlock,
)

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


@dataclass(frozen=True, slots=True)
class Said:
    """A rule as fuzzylite says it: each conclusion with the hedges that stand before it."""

    antecedent: Expression
    conclusions: tuple[tuple[Consequent, tuple[Hedge, ...]], ...]
    weight: float
    rule: Rule
    hedges: tuple[Hedge, ...]


def said_rules(block: RuleBlock, order: dict[str, int] | None = None) -> list[Said]:
    """Return the rules of a block; those that differ in outer hedges alone become one again.

    Hedges of a conclusion carry on to the conclusions after it, so that rules over one
    antecedent whose hedges grow can be said as one. With `order`, the place of every
    output, only where the conclusions then stand in that order.
    """
    found: list[Said] = []
    for rule in block.rules:
        antecedent, hedges, weight = split_hedges(rule)
        conclusions = tuple((c, hedges if i == 0 else ()) for i, c in enumerate(rule.consequents))
        last = found[-1] if found else None
        if last is not None and _grows(last, antecedent, hedges, weight, rule, order):
            new = hedges[: len(hedges) - len(last.hedges)]
            conclusions = ((conclusions[0][0], new), *conclusions[1:])
            conclusions = (*last.conclusions, *conclusions)
            found[-1] = Said(antecedent, conclusions, weight, last.rule, hedges)
        else:
            found.append(Said(antecedent, conclusions, weight, rule, hedges))
    return found


def _grows(
    last: Said,
    antecedent: Expression,
    hedges: tuple[Hedge, ...],
    weight: float,
    rule: Rule,
    order: dict[str, int] | None,
) -> bool:
    count = len(last.hedges)
    suffix = hedges[len(hedges) - count :] if count else ()
    if len(hedges) <= count or suffix != last.hedges or last.antecedent != antecedent:
        return False
    if order is not None:
        before = order[last.conclusions[-1][0].variable]
        if order[rule.consequents[0].variable] <= before:
            return False
    return last.weight == weight


def rule_text(said: Said, block: RuleBlock, names: Names, findings: Findings) -> str:
    """Return ``if … then …``; report hedges that cannot be said."""
    condition = _condition(said.antecedent, block, names, findings)
    conclusions = []
    for consequent, hedges in said.conclusions:
        if consequent.hedges:
            message = "hedges on the set of a conclusion have another meaning to fuzzylite"
            findings.loss("set-hedge", message, said.rule.span)
        term = names.term(consequent.variable, consequent.term)
        words = _hedge_words(hedges, findings)
        conclusions.append(" ".join([names.variable(consequent.variable), "is", *words, term]))
    ending = "" if said.weight == 1.0 else f" with {written(said.weight)}"
    return f"if {condition} then {' and '.join(conclusions)}{ending}"


def split_hedges(rule: Rule) -> tuple[Expression, tuple[Hedge, ...], float]:
    """Take the hedges around a whole antecedent off, with the weight they then need."""
    if not isinstance(rule.antecedent, Hedged):
        return rule.antecedent, (), rule.weight
    hedges, operand = rule.antecedent.hedges, rule.antecedent.operand
    weight = weight_before(rule.weight, hedges)
    if weight is None:
        return rule.antecedent, (), rule.weight
    return operand, hedges, weight


def weight_before(weight: float, hedges: tuple[Hedge, ...]) -> float | None:
    """Return w with ``hedged_weight(w, hedges) == weight`` to the last bit, or None."""
    if weight == 1.0:
        return 1.0
    guess = weight
    for hedge in hedges:
        if hedge.name not in POWERS or guess <= 0.0:
            return None
        guess = guess ** (1.0 / (hedge.exponent or POWERS[hedge.name]))
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
