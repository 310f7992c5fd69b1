"""Checks of terms and variables: gaps, unused names, defuzzifiers that do not fit.

Each check is a function from a :class:`Subject`, which is defined here, to its findings.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.language.document import Document
from fuzzyarm.language.statements import EvenTermsNode, GridNode
from fuzzyarm.model.rulebase import WEIGHTED, Input, Output, RuleBase, Variable, propositions
from fuzzyarm.model.shapes import corners, membership, probe_points
from fuzzyarm.text.diagnostic import Diagnostic, Span

# --- What a check looks at ---


class Subject(NamedTuple):
    """A rule base and, where it came from a text, its syntax tree."""

    rulebase: RuleBase
    document: Document

    @property
    def grids(self) -> list[GridNode]:
        """The rule grids of the file."""
        nodes = (statement.node for statement in self.document.statements)
        return [part for node in nodes if isinstance(node, GridNode) for part in node.parts]


# --- Stretches of an input's range that no term covers ---

FAINT = 1e-6
"""A membership below this covers nothing."""


def coverage_gaps(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``coverage-gap`` once for each gap."""
    for variable in subject.rulebase.inputs:
        if variable.terms:
            yield from gaps_of(variable)


def gaps_of(variable: Input) -> Iterator[Diagnostic]:
    """Yield a ``coverage-gap`` for each stretch of `variable` that no term covers."""
    points = probe_points(variable)
    bare = [all(membership(term.shape, x) < FAINT for term in variable.terms) for x in points]
    i = 0
    while i < len(points):
        if not bare[i]:
            i += 1
            continue
        end = i
        while end + 1 < len(points) and bare[end + 1]:
            end += 1
        yield _gap(variable, points, i, end)
        i = end + 1


def _gap(variable: Input, points: list[float], start: int, end: int) -> Diagnostic:
    # A gap begins at a corner: at a bare one, or just behind a covered one.
    turns = set(corners(variable))
    low = points[start] if points[start] in turns else points[start - 1]
    high = points[end] if points[end] in turns else points[end + 1]
    where = f"{low:g}" if low == high else f"{low:g} .. {high:g}"
    return Diagnostic("coverage-gap", f"no term of '{variable.name}' covers {where}", variable.span)


# --- Outputs whose defuzzifier cannot work on their terms ---


def unfit_defuzzifiers(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``defuzzifier-does-not-fit`` and ``mixed-output-terms``."""
    for output in subject.rulebase.outputs:
        yield from _values(output)
        yield from _mixture(output)
        if output.defuzzifier.method == "tsukamoto":
            yield from _monotonic(output)


def _values(output: Output) -> Iterator[Diagnostic]:
    values = [term for term in output.terms if not SHAPES[term.shape.kind].fuzzy]
    method = output.defuzzifier.method
    if values and method not in WEIGHTED:
        yield Diagnostic(
            "defuzzifier-does-not-fit",
            f"'{values[0].name}' of '{output.name}' is a value, not a set; {method} needs sets",
            values[0].span,
            hint="use weighted-average or weighted-sum",
        )


def _mixture(output: Output) -> Iterator[Diagnostic]:
    if output.defuzzifier.method in WEIGHTED:
        return
    spikes = [term for term in output.terms if term.shape.kind == "singleton"]
    if spikes and len(spikes) < len(output.terms):
        yield Diagnostic(
            "mixed-output-terms",
            f"'{output.name}' mixes singletons with sets that have an area;"
            f" '{spikes[0].name}' would carry no weight in the {output.defuzzifier.method}",
            spikes[0].span,
        )


def _monotonic(output: Output) -> Iterator[Diagnostic]:
    for term in output.terms:
        record = SHAPES[term.shape.kind]
        if record.fuzzy and record.inverse is None and term.shape.kind != "singleton":
            yield Diagnostic(
                "defuzzifier-does-not-fit",
                f"tsukamoto needs monotonic terms; '{term.name}' of '{output.name}' is a"
                f" {term.shape.kind}",
                term.span,
            )
            return


# --- Terms and variables that no rule uses ---


def unused_names(subject: Subject) -> Iterator[Diagnostic]:
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
                from fuzzyarm.expression.formulas import FormulaError, read_formula

                try:
                    found |= set(read_formula(shape.formula).names)
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
