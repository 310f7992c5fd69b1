"""The checks by name, and the run of all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

from fuzzyarm.rulebase.check import (
    completeness,
    conflicts,
    coverage,
    firing,
    fits,
    jumps,
    symmetry,
    unused,
)
from fuzzyarm.rulebase.check.allowances import apply_allowances
from fuzzyarm.rulebase.check.subject import Subject
from fuzzyarm.rulebase.diagnostic import Diagnostic, Severity
from fuzzyarm.rulebase.model import RuleBase
from fuzzyarm.rulebase.syntax.nodes import Document


@dataclass(frozen=True, slots=True)
class Check:
    """One thing that can be found.

    Attributes
    ----------
    severity : Severity
        An error fails ``fuzzyarm check``; a warning does with ``--strict``.
    summary : str
        One line.
    """

    severity: Severity
    summary: str


CHECKS: dict[str, Check] = {
    "contradictory-rules": Check(
        Severity.ERROR, "two rules with the same antecedent say different things"
    ),
    "failed-expectation": Check(Severity.ERROR, "an `expect` line does not hold"),
    "defuzzifier-does-not-fit": Check(
        Severity.ERROR, "the defuzzifier cannot work on the terms of the output"
    ),
    "mixed-output-terms": Check(
        Severity.ERROR, "singletons beside sets with an area in one output"
    ),
    "duplicate-rule": Check(Severity.WARNING, "a rule is said twice"),
    "missing-rule": Check(Severity.WARNING, "a combination of terms has no rule"),
    "no-rule-fires": Check(Severity.WARNING, "there is an input at which no rule fires"),
    "coverage-gap": Check(Severity.WARNING, "no term covers a stretch of an input"),
    "unused-variable": Check(Severity.WARNING, "no rule uses a variable"),
    "unused-term": Check(Severity.WARNING, "no rule uses a term"),
    "jump": Check(Severity.WARNING, "neighbouring grid cells lie more than two terms apart"),
    "broken-antisymmetry": Check(Severity.WARNING, "a grid is antisymmetric but for a few cells"),
    "broken-symmetry": Check(Severity.WARNING, "a grid is symmetric but for a few cells"),
    "unknown-allow": Check(Severity.WARNING, "an `allow` comment names no check"),
    "useless-allow": Check(Severity.INFO, "an `allow` comment silences nothing"),
}
"""Every check by its name."""

_FINDERS: tuple[Callable[[Subject], Iterator[Diagnostic]], ...] = (
    conflicts.find,
    completeness.find,
    unused.find,
    coverage.find,
    firing.find,
    jumps.find,
    symmetry.find,
    fits.find,
)


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
    findings = [finding for find in _FINDERS for finding in find(subject)] + list(more)
    judged = [replace(finding, severity=_severity(finding), path=path) for finding in findings]
    kept = apply_allowances(judged, tree, CHECKS)
    return sorted((replace(d, path=path) for d in kept), key=lambda d: (d.span, d.name))


def _severity(finding: Diagnostic) -> Severity:
    # A finder may judge a single case milder than its kind, never graver.
    if finding.severity is Severity.INFO or finding.name not in CHECKS:
        return finding.severity
    return CHECKS[finding.name].severity
