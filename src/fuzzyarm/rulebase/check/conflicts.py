"""Rules with the same antecedent: contradictory, or said twice."""

from __future__ import annotations

from collections.abc import Hashable, Iterator

from fuzzyarm.rulebase.check.subject import Subject
from fuzzyarm.rulebase.diagnostic import Diagnostic, Related
from fuzzyarm.rulebase.model import And, Consequent, Expression, Hedged, Is, Or, Rule


def find(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``contradictory-rules`` and ``duplicate-rule``."""
    for block in subject.rulebase.blocks:
        first: dict[Hashable, dict[str, tuple[Rule, Consequent]]] = {}
        for rule in block.rules:
            known = first.setdefault(_key(rule.antecedent), {})
            for consequent in rule.consequents:
                if consequent.variable not in known:
                    known[consequent.variable] = (rule, consequent)
                    continue
                yield _finding(rule, consequent, *known[consequent.variable])


def _finding(rule: Rule, consequent: Consequent, other: Rule, earlier: Consequent) -> Diagnostic:
    related = (Related(f"the other rule, on line {other.span.line}", other.span),)
    if (consequent.term, consequent.hedges) == (earlier.term, earlier.hedges):
        return Diagnostic(
            "duplicate-rule",
            f"the rule {_words(rule)} already stands on line {other.span.line}",
            rule.span,
            related=related,
        )
    return Diagnostic(
        "contradictory-rules",
        f"the rule {_words(rule)} says {consequent.variable} is {consequent.term}, but line"
        f" {other.span.line} says {earlier.term}",
        rule.span,
        related=related,
    )


def _words(rule: Rule) -> str:
    antecedent = rule.antecedent
    parts = antecedent.operands if isinstance(antecedent, And) else (antecedent,)
    if all(isinstance(part, Is) and not part.hedges for part in parts):
        pairs = (f"{p.variable} is {p.term}" for p in parts if isinstance(p, Is))
        return f"'{' and '.join(pairs)}'"
    return "with this antecedent"


def _key(expression: Expression) -> Hashable:
    """Return what is equal for antecedents that differ in the order of operands only."""
    if isinstance(expression, Is):
        return (expression.variable, expression.term, expression.hedges)
    if isinstance(expression, Hedged):
        return ("hedged", expression.hedges, _key(expression.operand))
    word = "or" if isinstance(expression, Or) else "and"
    return (word, frozenset(map(_key, expression.operands)))
