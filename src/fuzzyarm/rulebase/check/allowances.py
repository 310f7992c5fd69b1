"""``# allow NAME`` comments: what they silence, and those that silence nothing."""

from __future__ import annotations

from collections.abc import Iterable

from fuzzyarm.rulebase.diagnostic import Diagnostic, Severity, Span
from fuzzyarm.rulebase.near import near_hint
from fuzzyarm.rulebase.syntax.nodes import Document


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
