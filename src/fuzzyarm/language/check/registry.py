"""The checks by name, the run of all of them, and the comments that silence them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

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

# --- `# allow NAME` comments: what they silence, and those that silence nothing ---


def apply_allowances(
    findings: Iterable[Diagnostic], document: Document, known: Iterable[str]
) -> list[Diagnostic]:
    """Return `findings` without the allowed ones, and with what is wrong with the comments.

    Parameters
    ----------
    findings : iterable of Diagnostic
        What the checks found.
    document : Document
        Has the comments.
    known : iterable of str
        Names of all checks.
    """
    used: set[tuple[int, str]] = set()
    kept = []
    for finding in findings:
        if finding.name in document.allowed.get(finding.line, ()):
            used.add((finding.line, finding.name))
        else:
            kept.append(finding)
    names = list(known)
    for line, allowed in document.allowed.items():
        for name in sorted(allowed):
            if name not in names:
                kept.append(_unknown(name, line, names))
            elif (line, name) not in used:
                kept.append(
                    Diagnostic(
                        "useless-allow",
                        f"there is no {name} on this line to allow",
                        Span(line, 1, line, 2),
                        Severity.INFO,
                    )
                )
    return kept


def _unknown(name: str, line: int, names: list[str]) -> Diagnostic:
    hint, _ = near_hint(name, names)
    return Diagnostic(
        "unknown-allow",
        f"no check is called '{name}'",
        Span(line, 1, line, 2),
        Severity.WARNING,
        hint=hint,
    )


# --- The checks by name, and the run of all of them ---


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
    conflicting_rules,
    missing_rules,
    unused_names,
    coverage_gaps,
    points_without_rule,
    jumps,
    broken_symmetries,
    unfit_defuzzifiers,
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
