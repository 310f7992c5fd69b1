"""Stretches of an input's range that no term covers."""

from __future__ import annotations

from collections.abc import Iterator

from fuzzyarm.rulebase.check.subject import Subject
from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.geometry import corners, probe_points
from fuzzyarm.rulebase.membership import membership
from fuzzyarm.rulebase.model import Input

FAINT = 1e-6
"""A membership below this covers nothing."""


def find(subject: Subject) -> Iterator[Diagnostic]:
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
