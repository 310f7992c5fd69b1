"""The checks, a record each; the run of all of them; the comments that silence them.

To add a check: write its function in :mod:`.terms` or :mod:`.rules`, and its record here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

from fuzzyarm.language.check.rules import (
    broken_symmetries,
    conflicting_rules,
    jumps,
    missing_rules,
    points_without_rule,
)
from fuzzyarm.language.check.terms import Subject, coverage_gaps, unfit_defuzzifiers, unused_names
from fuzzyarm.language.document import Document
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.text.diagnostic import Diagnostic, Severity, Span
from fuzzyarm.text.names import near_hint


class Check(NamedTuple):
    """A record: one thing that can be found.

    Attributes
    ----------
    name : str
        What ``# allow`` silences.
    severity : Severity
        An error fails ``fuzzyarm check``; a warning does with ``--strict``.
    doc : str
        What it means, as in the reference.
    find : callable or None
        Yields the findings, maybe of several names; None for what is found elsewhere.
    """

    name: str
    severity: Severity
    doc: str
    find: Callable[[Subject], Iterator[Diagnostic]] | None = None


CHECKS: dict[str, Check] = {
    check.name: check
    for check in (
        Check(
            "contradictory-rules",
            Severity.ERROR,
            "Two rules of a block have the same antecedent and say different things of one output.",
            conflicting_rules,
        ),
        Check(
            "failed-expectation",
            Severity.ERROR,
            "An `expect` line does not hold; the message has the value that came out.",
        ),
        Check(
            "defuzzifier-does-not-fit",
            Severity.ERROR,
            "The defuzzifier cannot work on the terms of its output: a centroid of plain values, "
            "Tsukamoto's method on terms that rise and fall.",
            unfit_defuzzifiers,
        ),
        Check(
            "mixed-output-terms",
            Severity.ERROR,
            "An output has singletons beside sets with an area; the singletons would carry no "
            "weight in an integral.",
            unfit_defuzzifiers,
        ),
        Check(
            "duplicate-rule",
            Severity.WARNING,
            "A rule is said twice.",
            conflicting_rules,
        ),
        Check(
            "missing-rule",
            Severity.WARNING,
            "A combination of terms has no rule: an empty cell, an absent row or column, an "
            "uncovered combination.",
            missing_rules,
        ),
        Check(
            "no-rule-fires",
            Severity.WARNING,
            "There is an input (it is given) at which no rule of an output fires. Only an info "
            "where `no-rule` says what happens then.",
            points_without_rule,
        ),
        Check(
            "coverage-gap",
            Severity.WARNING,
            "No term of an input covers a stretch of its range.",
            coverage_gaps,
        ),
        Check(
            "unused-variable",
            Severity.WARNING,
            "No rule uses a variable.",
            unused_names,
        ),
        Check(
            "unused-term",
            Severity.WARNING,
            "No rule uses a term of a variable.",
            unused_names,
        ),
        Check(
            "jump",
            Severity.WARNING,
            "Two neighbouring cells of a grid are more than two terms apart: the control surface "
            "has a cliff.",
            jumps,
        ),
        Check(
            "broken-antisymmetry",
            Severity.WARNING,
            "A grid is antisymmetric (opposite inputs give opposite outputs) but for a few cells.",
            broken_symmetries,
        ),
        Check(
            "broken-symmetry",
            Severity.WARNING,
            "A grid is symmetric (opposite inputs give equal outputs) but for a few cells.",
            broken_symmetries,
        ),
        Check(
            "unknown-allow",
            Severity.WARNING,
            "An `allow` comment names no check.",
        ),
        Check(
            "useless-allow",
            Severity.INFO,
            "An `allow` comment silences nothing on its line.",
        ),
    )
}
"""Every check by its name, the gravest first."""


def check(
    rulebase: RuleBase,
    document: Document | None = None,
    *,
    path: str = "",
    more: Iterable[Diagnostic] = (),
) -> list[Diagnostic]:
    """Return what is probably not meant in a sound rule base.

    Parameters
    ----------
    rulebase : RuleBase
        Free of errors.
    document : Document, optional
        Its syntax tree; without it, what concerns grids and comments is not checked.
    path : str
        Name of the file, for the diagnostics.
    more : iterable of Diagnostic
        Findings of other floors (failed expectations) to be sorted in and silenced alike.

    Returns
    -------
    list of Diagnostic
        In the order of the text, without what ``# allow`` comments silence.
    """
    tree = document or Document(())
    subject = Subject(rulebase, tree)
    finders = dict.fromkeys(record.find for record in CHECKS.values() if record.find)
    findings = [finding for find in finders for finding in find(subject)] + list(more)
    judged = [replace(finding, severity=_severity(finding)) for finding in findings]
    return sorted(
        (replace(finding, path=path) for finding in _without_allowed(judged, tree)),
        key=lambda finding: (finding.span, finding.name),
    )


def _severity(finding: Diagnostic) -> Severity:
    # A finder may judge a single case milder than its kind, never graver.
    if finding.severity is Severity.INFO or finding.name not in CHECKS:
        return finding.severity
    return CHECKS[finding.name].severity


def _without_allowed(findings: list[Diagnostic], document: Document) -> Iterator[Diagnostic]:
    """Yield what no ``# allow`` comment silences, and what is wrong with the comments."""
    used: set[tuple[int, str]] = set()
    for finding in findings:
        if finding.name in document.allowed.get(finding.line, ()):
            used.add((finding.line, finding.name))
        else:
            yield finding
    for line, allowed in document.allowed.items():
        span = Span(line, 1, line, 2)
        for name in sorted(allowed):
            if name not in CHECKS:
                hint, _ = near_hint(name, CHECKS)
                message = f"no check is called '{name}'"
                yield Diagnostic("unknown-allow", message, span, Severity.WARNING, hint=hint)
            elif (line, name) not in used:
                message = f"there is no {name} on this line to allow"
                yield Diagnostic("useless-allow", message, span, Severity.INFO)
