"""The checks, a record each; the run of all of them; the comments that silence them.

To add a check: write its function in :mod:`.terms` or :mod:`.rules`, and its record here.

Its description goes into ``docs/reference/checks.md``, at the same place, and a text with and one
without it into ``tests/language/test_checks.py``, which names what is missing and finds shipped
files that the check blames. A doubt about a controller is a function of
:mod:`fuzzyarm.language.controller_doubts` where its lines are enough, of
:mod:`fuzzyarm.control.controllers.findings` where files, ranges or the plant are needed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

from fuzzyarm.base.diagnostic import Diagnostic, Severity, Span
from fuzzyarm.base.names import near_hint
from fuzzyarm.language.check.coverage import coverage_gaps, missing_rules, points_without_rule
from fuzzyarm.language.check.rules import (
    broken_symmetries,
    conflicting_rules,
    jumps,
)
from fuzzyarm.language.check.subject import Subject
from fuzzyarm.language.check.terms import (
    clamped_values,
    cores_outside,
    crossed_terms,
    formula_degrees,
    short_reaches,
    uneven_terms,
    unfit_defuzzifiers,
    unused_names,
)
from fuzzyarm.language.document import Document
from fuzzyarm.language.model.rulebase import RuleBase


class Check(NamedTuple):
    """A check: one possible finding.

    Attributes
    ----------
    name : str
        Name for ``# allow``.
    severity : Severity
        An error fails ``fuzzyarm check``; a warning does with ``--strict``.
    doc : str
        Meaning, as in the reference.
    find : callable or None
        Yields the findings, possibly of several names; None if found elsewhere.
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
            "Two rules of a block have the same antecedent and different consequents for an "
            "output.",
            conflicting_rules,
        ),
        Check(
            "failed-expectation",
            Severity.ERROR,
            "An `expect` line does not hold; the message has the actual value.",
        ),
        Check(
            "refuted-property",
            Severity.ERROR,
            "A `prove` line does not hold; the message has a point, or a pair of points, where it "
            "fails.",
        ),
        Check(
            "undecided-property",
            Severity.INFO,
            "A `prove` line takes longer than a check may; `fuzzyarm prove` has the time for it.",
        ),
        Check(
            "defuzzifier-does-not-fit",
            Severity.ERROR,
            "The defuzzifier cannot work on the terms of its output: a centroid of plain values, "
            "Tsukamoto's method on terms that rise and fall, a centroid of interval type-2 terms.",
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
            "unknown-port",
            Severity.ERROR,
            "A controller uses a port that its plant does not have. Only a warning if the plant "
            "was found by its axes.",
        ),
        Check(
            "no-area",
            Severity.WARNING,
            "A set is above 0 at one point alone: an integral does not count it, and a sum over "
            "samples does only where a sample meets it.",
            unfit_defuzzifiers,
        ),
        Check(
            "duplicate-rule",
            Severity.WARNING,
            "A rule is repeated.",
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
            "At some point, given in the message, no rule of an output fires. Only an info if "
            "`no-rule` says what happens then; in a controller a warning where its signal is then "
            "not a number.",
            points_without_rule,
        ),
        Check(
            "coverage-gap",
            Severity.WARNING,
            "No term of an input covers part of its range.",
            coverage_gaps,
        ),
        Check(
            "core-outside-range",
            Severity.WARNING,
            "The core of a term, or a singleton, lies outside the range of its variable.",
            cores_outside,
        ),
        Check(
            "formula-degrees",
            Severity.WARNING,
            "The formula of a set has no value at some positions, where its degree is taken as 0, "
            "or leaves 0 .. 1.",
            formula_degrees,
        ),
        Check(
            "crossed-terms",
            Severity.WARNING,
            "The terms of a variable are listed in the order of their peaks, except one that has "
            "crossed its neighbour.",
            crossed_terms,
        ),
        Check(
            "broken-partition",
            Severity.WARNING,
            "The memberships of a variable add up to 1 except between a few neighbours, or its "
            "`tune` line says `partition` and they do not.",
            uneven_terms,
        ),
        Check(
            "uneven-mirror",
            Severity.WARNING,
            "The terms of a variable are mirror images about the middle of the range except "
            "for one pair, or its `tune` line says `mirrored` and they are not.",
            uneven_terms,
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
            "A grid over inputs about 0 is antisymmetric (opposite inputs give opposite outputs) "
            "except for a few cells; the same applies to grids under `when` together.",
            broken_symmetries,
        ),
        Check(
            "broken-symmetry",
            Severity.WARNING,
            "A grid over inputs about 0 is symmetric (opposite inputs give equal outputs) except "
            "for a few cells; the same applies to grids under `when` together.",
            broken_symmetries,
        ),
        Check(
            "unused-signal",
            Severity.WARNING,
            "Nothing on its axis reads a signal of a controller.",
        ),
        Check(
            "unused-name",
            Severity.WARNING,
            "Nothing reads a gain, a partner, a rule base or a table of a controller.",
        ),
        Check(
            "unread-table",
            Severity.WARNING,
            "A table learns, but nothing looks it up.",
        ),
        Check(
            "outside-tune",
            Severity.WARNING,
            "A gain lies outside the range that its `tune` allows.",
        ),
        Check(
            "windup",
            Severity.WARNING,
            "An integral keeps growing while its drive is at a limit.",
        ),
        Check(
            "windup-gain",
            Severity.WARNING,
            "An anti-windup goes back by the excess of a drive, but there is more than constant "
            "gains between integral and drive.",
        ),
        Check(
            "no-limits",
            Severity.WARNING,
            "The anti-windup of an integral has no effect, because its drive has no limits. Only "
            "an info if a drive without limits can exceed those of the actuator.",
        ),
        Check(
            "limits-add-up",
            Severity.WARNING,
            "Several drives of one port each have limits, and together exceed them.",
        ),
        Check(
            "always-cleared",
            Severity.WARNING,
            "A sum that is cleared at each set point is cleared in every period, because no line "
            "says how long a set point lasts.",
        ),
        Check(
            "range-mismatch",
            Severity.WARNING,
            "A signal is far wider than the universe of its rule base or table, "
            "so that it saturates, or uses less than a tenth of it.",
        ),
        Check(
            "wide-limits",
            Severity.WARNING,
            "The limits of a drive are wider than those of the actuator.",
        ),
        Check(
            "limit-before-factor",
            Severity.WARNING,
            "The limits of an integral with a factor are those of what reads the product, but hold "
            "before the factor.",
        ),
        Check(
            "weak-drive",
            Severity.WARNING,
            "A drive never reaches a tenth of what the actuator can do.",
        ),
        Check(
            "unlike-units",
            Severity.WARNING,
            "The unit of a gain and that of its signal are different units of one quantity and do "
            "not cancel, such as rad and deg; a width is not in the unit of its signal; the terms "
            "of a sum have different units; or a drive or an input of rules has another dimension.",
        ),
        Check(
            "unknown-unit",
            Severity.WARNING,
            "The unit of a gain is spelled otherwise than its symbol, such as Rad or volts: it is "
            "compared with no other.",
        ),
        Check(
            "unknown-allow",
            Severity.WARNING,
            "An `allow` comment names no check.",
        ),
        Check(
            "clamped-output",
            Severity.INFO,
            "A linear consequent leaves the range of its output where its rules fire; the output "
            "is cut.",
            clamped_values,
        ),
        Check(
            "short-reach",
            Severity.INFO,
            "A centroid stays away from an end of its range by more than an eighth of it, however "
            "fully the rules fire.",
            short_reaches,
        ),
        Check(
            "undecided",
            Severity.INFO,
            "A search for `missing-rule` or `no-rule-fires` had too many combinations and "
            "found nothing before it gave up.",
        ),
        Check(
            "useless-allow",
            Severity.INFO,
            "An `allow` comment silences nothing on its line.",
        ),
    )
}
"""Every check by its name, the most severe first."""


def check(
    rulebase: RuleBase,
    document: Document | None = None,
    *,
    path: str = "",
    more: Iterable[Diagnostic] = (),
    on_step: Callable[[], None] = lambda: None,
) -> list[Diagnostic]:
    """Return the probable mistakes in a valid rule base.

    Parameters
    ----------
    rulebase : RuleBase
        Free of errors.
    document : Document, optional
        Its syntax tree; without it, checks of grids and comments are skipped.
    path : str
        Name of the file, for the diagnostics.
    more : iterable of Diagnostic
        Findings of other packages (failed expectations), sorted in and silenced alike.
    on_step : callable
        Called repeatedly; an exception ends the check.

    Returns
    -------
    list of Diagnostic
        In the order of the text, without those silenced by ``# allow`` comments.
    """
    tree = document or Document(())
    subject = Subject(rulebase, tree, on_step)
    findings = list(more)
    # One finder may yield findings of several records; each runs once, in their order.
    for find in dict.fromkeys(record.find for record in CHECKS.values() if record.find):
        for finding in find(subject):
            findings.append(finding)
            on_step()
        on_step()
    return judged(findings, tree, path)


def judged(findings: Iterable[Diagnostic], document: Document, path: str = "") -> list[Diagnostic]:
    """Return findings in the order of the text, without those that ``# allow`` comments silence."""
    weighed = [replace(finding, severity=_severity(finding)) for finding in findings]
    return sorted(
        (replace(finding, path=path) for finding in _without_allowed(weighed, document)),
        key=lambda finding: (finding.span, finding.name),
    )


_FROM_SEVERE_TO_MILD = list(Severity)


def _severity(finding: Diagnostic) -> Severity:
    # A finder may judge a single case milder than its kind, never graver.
    if finding.name not in CHECKS:
        return finding.severity
    return max(finding.severity, CHECKS[finding.name].severity, key=_FROM_SEVERE_TO_MILD.index)


def _without_allowed(findings: list[Diagnostic], document: Document) -> Iterator[Diagnostic]:
    """Yield the findings not silenced by ``# allow`` comments, and faults of these comments."""
    silenced: set[tuple[int, str]] = set()
    for finding in findings:
        if finding.name in document.allowed.get(finding.line, ()):
            silenced.add((finding.line, finding.name))
        else:
            yield finding
    for line, allowed in document.allowed.items():
        span = Span(line, 1, line, 2)
        for name in sorted(allowed):
            if name not in CHECKS:
                hint, _ = near_hint(name, CHECKS)
                message = f"no check is called '{name}'"
                yield Diagnostic("unknown-allow", message, span, Severity.WARNING, hint=hint)
            elif (line, name) not in silenced:
                message = f"there is no {name} on this line to allow"
                yield Diagnostic("useless-allow", message, span, Severity.INFO)
