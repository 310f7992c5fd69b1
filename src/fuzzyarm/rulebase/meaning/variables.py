"""Give variables and terms their meaning."""

from __future__ import annotations

import math

from fuzzyarm.rulebase.diagnostic import Related
from fuzzyarm.rulebase.limits import (
    MAX_INPUTS,
    MAX_MAGNITUDE,
    MAX_OUTPUTS,
    MAX_TERMS,
    MIN_WIDTH,
)
from fuzzyarm.rulebase.meaning.scope import Draft, Scope
from fuzzyarm.rulebase.meaning.shapes import elaborate_shape
from fuzzyarm.rulebase.model import Shape, Term
from fuzzyarm.rulebase.syntax.nodes import EvenTermsNode, TermNode, VariableNode, Word

_LIMITS = {"input": MAX_INPUTS, "output": MAX_OUTPUTS}


def declare_variable(node: VariableNode, scope: Scope) -> None:
    """Add the variable of `node` to `scope`."""
    known = scope.drafts.get(node.name.text)
    if known is not None:
        scope.report(
            "duplicate-variable",
            f"'{node.name.text}' is declared twice",
            node.name.span,
            related=(Related("first here", known.node.name.span),),
        )
        return
    if len(scope.names(node.role)) == _LIMITS[node.role]:
        if node.role not in scope.full:
            scope.report(
                "too-many-variables",
                f"more than {_LIMITS[node.role]} {node.role}s",
                node.name.span,
            )
        scope.full.add(node.role)
        scope.broken_variables = True
        return
    low, high = range_of(node)
    if node.low is not None and node.high is not None and not low < high:
        scope.report(
            "bad-range",
            f"the range of '{node.name.text}' must go from a lower to a higher number",
            node.low.span.to(node.high.span),
        )
    elif node.low is not None and node.high is not None:
        fault = range_fault(node.low.value, node.high.value)
        if fault is not None:
            span = node.low.span.to(node.high.span)
            scope.report("bad-range", f"the range of '{node.name.text}' {fault}", span)
    scope.drafts[node.name.text] = Draft(node)


def range_fault(low: float, high: float) -> str | None:
    """Return what makes the range from `low` to `high` absurd, or None."""
    if any(MAX_MAGNITUDE < abs(end) < math.inf for end in (low, high)):
        return f"goes beyond {MAX_MAGNITUDE:g}"
    if high - low < MIN_WIDTH:
        return f"is narrower than {MIN_WIDTH:g}"
    return None


def range_of(node: VariableNode) -> tuple[float, float]:
    """Return the range of a variable; 0 to 1 where the file's could not be read."""
    if node.low is None or node.high is None:
        return 0.0, 1.0
    return node.low.value, node.high.value


def add_term(node: TermNode, scope: Scope) -> None:
    """Add the explicit term of `node` to its variable."""
    draft = scope.variable(node.variable)
    shape = None if node.shape is None else elaborate_shape(node.shape, draft, scope)
    if draft is not None:
        # A term with a bad shape keeps its place, so that its uses are no mistakes too.
        _add(draft, node.name, shape or Shape("singleton", (range_of(draft.node)[0],)), scope)


def add_even_terms(node: EvenTermsNode, scope: Scope) -> None:
    """Spread the terms of `node` evenly over the range of each of its variables."""
    for word in node.variables:
        draft = scope.variable(word)
        if draft is None:
            continue
        low, high = range_of(draft.node)
        if not (math.isfinite(low) and math.isfinite(high)):
            scope.report(
                "bad-range", f"'{draft.name}' has no finite range to spread over", word.span
            )
            continue
        if len(node.names) < 2 and node.family.text != "singletons":
            scope.report(
                "too-few-terms", "evenly spaced terms need two names at least", node.names[0].span
            )
            continue
        if node.family.text == "singletons" and draft.is_input:
            scope.report(
                "singleton-input",
                f"singletons would leave the input '{draft.name}' uncovered between them",
                node.family.span,
            )
        for name, shape in zip(node.names, _even_shapes(node, low, high), strict=True):
            _add(draft, name, shape, scope, spread=True)


def even_shapes(family: str, count: int, low: float, high: float) -> list[Shape]:
    """Return `count` shapes of `family` with peaks spread evenly from `low` to `high`.

    Triangles have their feet under the neighbouring peaks, gaussians cross their
    neighbours at one half, singletons stand at the peaks. A single shape stands in the middle.
    """
    if count == 1:
        return [Shape("singleton", (0.5 * (low + high),))]
    step = (high - low) / (count - 1)
    peaks = [low + (high - low) * i / (count - 1) for i in range(count)]
    if family == "singletons":
        return [Shape("singleton", (peak,)) for peak in peaks]
    if family == "gaussians":
        deviation = step / (2.0 * math.sqrt(2.0 * math.log(2.0)))
        return [Shape("gaussian", (peak, deviation)) for peak in peaks]
    # Feet are the neighbours' peaks to the last bit, so that memberships add up to one.
    feet = [low - step, *peaks, high + step]
    return [Shape("triangle", (feet[i], feet[i + 1], feet[i + 2])) for i in range(count)]


def _even_shapes(node: EvenTermsNode, low: float, high: float) -> list[Shape]:
    return even_shapes(node.family.text, len(node.names), low, high)


def _add(draft: Draft, name: Word, shape: Shape, scope: Scope, *, spread: bool = False) -> None:
    known = draft.terms.get(name.text)
    if known is not None and (name.text in draft.spread) != spread:
        # A `term` line replaces the shape that `terms` spread, whichever comes first.
        if not spread:
            draft.terms[name.text] = Term(name.text, shape, name.span)
            draft.spread.discard(name.text)
        return
    if known is not None:
        scope.report(
            "duplicate-term",
            f"'{draft.name}' has two terms called '{name.text}'",
            name.span,
            related=(Related("first here", known.span),),
        )
        return
    if len(draft.terms) > MAX_TERMS:
        return
    if len(draft.terms) == MAX_TERMS:
        scope.report("too-many-terms", f"'{draft.name}' has more than {MAX_TERMS} terms", name.span)
    draft.terms[name.text] = Term(name.text, shape, name.span)
    if spread:
        draft.spread.add(name.text)
