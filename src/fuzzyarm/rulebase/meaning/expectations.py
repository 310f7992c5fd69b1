"""Give ``expect`` lines their meaning."""

from __future__ import annotations

from fuzzyarm.rulebase.meaning.scope import Scope
from fuzzyarm.rulebase.model import Expectation, Outcome
from fuzzyarm.rulebase.syntax.nodes import ExpectNode, OutcomeNode


def elaborate_expectation(node: ExpectNode, scope: Scope) -> Expectation | None:
    """Return the expectation of `node`, or None after a report."""
    before = len(scope.diagnostics)
    given: dict[str, float] = {}
    for word, figure in node.inputs:
        if scope.variable(word, "input") is None:
            continue
        if word.text in given:
            scope.report("duplicate-setting", f"'{word.text}' is given twice", word.span)
        given[word.text] = figure.value
    missing = [name for name in scope.names("input") if name not in given]
    if missing and len(scope.diagnostics) == before and not scope.broken_variables:
        scope.report(
            "incomplete-expectation",
            f"an expectation names every input; missing: {', '.join(missing)}",
            node.span,
        )
    outcomes = tuple(_outcome(outcome, scope) for outcome in node.outcomes)
    if len(scope.diagnostics) > before:
        return None
    order = {name: i for i, name in enumerate(scope.names("input"))}
    inputs = tuple(sorted(given.items(), key=lambda item: order[item[0]]))
    return Expectation(inputs, outcomes, node.span)


def _outcome(node: OutcomeNode, scope: Scope) -> Outcome:
    scope.variable(node.variable, "output")
    other = node.other
    if node.relation == "=" and other is not None and other.value < 0.0:
        scope.report("bad-tolerance", "a tolerance must not be negative", other.span)
    if node.relation == "in" and other is not None and other.value < node.value.value:
        scope.report(
            "bad-range", "the interval must go from a lower to a higher number", other.span
        )
    return Outcome(
        node.variable.text, node.relation, node.value.value, other.value if other else None
    )
