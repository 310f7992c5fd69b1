"""Terms and variables that no rule uses."""

from __future__ import annotations

from collections.abc import Iterator

from fuzzyarm.rulebase.check.subject import Subject
from fuzzyarm.rulebase.diagnostic import Diagnostic, Span
from fuzzyarm.rulebase.formula import FormulaError, names, parse
from fuzzyarm.rulebase.model import RuleBase, Variable, propositions
from fuzzyarm.rulebase.syntax.nodes import EvenTermsNode


def find(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``unused-variable`` and, for variables that are used, ``unused-term``."""
    rulebase = subject.rulebase
    used = _used_terms(rulebase)
    in_values = _used_in_values(rulebase)
    shared = _shared_spans(subject)
    reported: set[Span] = set()
    for variable in (*rulebase.inputs, *rulebase.outputs):
        terms = used.get(variable.name, set())
        if not terms and variable.name not in in_values:
            yield Diagnostic("unused-variable", f"no rule uses '{variable.name}'", variable.span)
            continue
        for term in variable.terms:
            # A name in a shared `terms` line is unused only if no variable uses it.
            owners = shared.get(term.span, (variable.name,))
            if any(term.name in used.get(owner, ()) for owner in owners) or not terms:
                continue
            if term.span not in reported:
                reported.add(term.span)
                yield _unused_term(variable, term.name, term.span)


def _unused_term(variable: Variable, name: str, span: Span) -> Diagnostic:
    return Diagnostic("unused-term", f"no rule uses the term '{name}' of '{variable.name}'", span)


def _used_terms(rulebase: RuleBase) -> dict[str, set[str]]:
    used: dict[str, set[str]] = {}
    for rule in rulebase.rules:
        for proposition in propositions(rule.antecedent):
            used.setdefault(proposition.variable, set()).add(proposition.term)
        for consequent in rule.consequents:
            used.setdefault(consequent.variable, set()).add(consequent.term)
    return used


def _used_in_values(rulebase: RuleBase) -> set[str]:
    """Return the inputs that a linear consequent or a formula refers to."""
    found: set[str] = set()
    for output in rulebase.outputs:
        for term in output.terms:
            shape = term.shape
            if shape.kind == "linear":
                pairs = zip(rulebase.inputs, shape.parameters, strict=False)
                found |= {variable.name for variable, factor in pairs if factor != 0.0}
            elif shape.kind == "formula":
                try:
                    found |= set(names(parse(shape.formula)))
                except FormulaError:
                    continue
    return found


def _shared_spans(subject: Subject) -> dict[Span, tuple[str, ...]]:
    shared: dict[Span, tuple[str, ...]] = {}
    for statement in subject.document.statements:
        node = statement.node
        if isinstance(node, EvenTermsNode):
            owners = tuple(word.text for word in node.variables)
            shared.update((name.span, owners) for name in node.names)
    return shared
