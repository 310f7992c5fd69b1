"""A mistake or a doubt, with its place in the text."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from fuzzyarm.errors import FuzzyarmError


class Severity(StrEnum):
    """How grave a diagnostic is: only errors keep a file from being used."""

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"


class Span(NamedTuple):
    """A stretch of text; lines and columns count characters from 1, the end is exclusive."""

    line: int
    column: int
    end_line: int
    end_column: int

    def to(self, other: Span) -> Span:
        """Return the span from the start of this one to the end of `other`."""
        return Span(self.line, self.column, other.end_line, other.end_column)


NOWHERE = Span(1, 1, 1, 1)
"""The span of what has no place in a text, for instance a model built in Python."""


@dataclass(frozen=True, slots=True)
class Related:
    """Another place that a diagnostic speaks of, for instance the first of two duplicates."""

    message: str
    span: Span


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding about a text.

    Attributes
    ----------
    name : str
        Kebab-case, stable: what ``# allow NAME`` silences and the documentation explains.
    message : str
        One sentence to a person.
    span : Span
        Exactly the text that is at fault.
    severity : Severity
        An error keeps the file from being used; a warning and an info do not.
    hint : str
        What was probably meant, or what to do; empty where nothing is certain.
    replacement : str or None
        The text to put in place of `span` where the hint is certain enough for a quick fix.
    path : str
        The file, as the caller named it.
    related : tuple of Related
        Other places that belong to the finding.
    """

    name: str
    message: str
    span: Span = NOWHERE
    severity: Severity = Severity.ERROR
    hint: str = ""
    replacement: str | None = None
    path: str = ""
    related: tuple[Related, ...] = ()

    @property
    def line(self) -> int:
        """Line of the first character, from 1."""
        return self.span.line

    @property
    def column(self) -> int:
        """Column of the first character, from 1."""
        return self.span.column

    @property
    def is_error(self) -> bool:
        """Whether the file cannot be used as it stands."""
        return self.severity is Severity.ERROR

    def __str__(self) -> str:
        place = f"{self.path or '<text>'}:{self.line}:{self.column}"
        hint = f" ({self.hint})" if self.hint else ""
        return f"{place}: {self.severity}[{self.name}]: {self.message}{hint}"


class RuleBaseError(FuzzyarmError, ValueError):
    """A file or a model that cannot be used.

    Parameters
    ----------
    diagnostics : sequence of Diagnostic
        Every finding, errors and others, in the order of the text; at least one.

    Attributes
    ----------
    diagnostics : tuple of Diagnostic
        As given.
    """

    def __init__(self, diagnostics: tuple[Diagnostic, ...] | list[Diagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        errors = [d for d in self.diagnostics if d.is_error] or list(self.diagnostics)
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        super().__init__(f"{errors[0]}{more}")
