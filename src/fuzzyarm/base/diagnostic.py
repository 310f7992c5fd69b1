"""Positions in a text, diagnostics with their display, and the size limits of a text."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, NamedTuple, Self

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.names import printable

# --- A finding and its position in the text ---


class Severity(StrEnum):
    """Severity of a diagnostic: only errors make a file unusable."""

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"


class Span(NamedTuple):
    """A range of text; lines and columns count characters from 1.

    Attributes
    ----------
    line, column : int
        Of the first character.
    end_line, end_column : int
        Behind the last one.
    """

    line: int
    column: int
    end_line: int
    end_column: int

    def to(self, other: Span) -> Span:
        """Return the span from the start of this one to the end of `other`."""
        return Span(self.line, self.column, other.end_line, other.end_column)


NOWHERE = Span(1, 1, 1, 1)
"""The span of objects without a text, such as a model built in Python."""


@json_properties("message line=span.line column=span.column")
class Related(NamedTuple):
    """Another position that a diagnostic refers to, for instance the first of two duplicates.

    Attributes
    ----------
    message : str
        Text of the remark.
    span : Span
        Its position.
    """

    message: str
    span: Span


SHORT_PROPERTIES = "name severity message hint line column"
"""Properties in JSON of a finding on a text not shown."""


@json_properties(
    "name severity message hint path line column"
    " end_line=span.end_line end_column=span.end_column related"
)
@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding about a text.

    Attributes
    ----------
    name : str
        Kebab-case, stable: the name in ``# allow NAME`` and in the documentation.
    message : str
        One sentence for a person.
    span : Span
        The exact text at fault.
    severity : Severity
        An error makes the file unusable; a warning and an info do not.
    hint : str
        The probable intention, or a remedy; empty if neither is certain.
    replacement : str or None
        Text for a quick fix of `span`, if the hint is certain enough.
    path : str
        The file, as the caller named it.
    related : tuple of Related
        Other positions of the finding.
    argument : str
        For values built in Python: the call or argument at fault, instead of a position.
    lines : tuple of str
        Lines that a quick fix can append below.
    """

    name: str
    message: str
    span: Span = NOWHERE
    severity: Severity = Severity.ERROR
    hint: str = ""
    replacement: str | None = None
    path: str = ""
    related: tuple[Related, ...] = ()
    argument: str = ""
    lines: tuple[str, ...] = ()

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
        """Whether the file is unusable because of it."""
        return self.severity is Severity.ERROR

    @property
    def position(self) -> str:
        """The position as printed: path, line and column, or the argument."""
        return self.argument or f"{self.path or '<text>'}:{self.line}:{self.column}"

    def __str__(self) -> str:
        position = self.position
        hint = f" ({self.hint})" if self.hint else ""
        return printable(f"{position}: {self.severity}[{self.name}]: {self.message}{hint}")


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

    @classmethod
    def of_argument(
        cls,
        name: str,
        message: str,
        argument: str,
        *,
        hint: str = "",
        replacement: str | None = None,
    ) -> RuleBaseError:
        """Return the error about one argument of a call from Python.

        Parameters
        ----------
        name, message, hint, replacement : str
            As of a :class:`Diagnostic`.
        argument : str
            The argument, as ``Shape(kind)``.
        """
        finding = Diagnostic(name, message, hint=hint, replacement=replacement, argument=argument)
        return cls([finding])

    def __reduce__(self) -> tuple[type[RuleBaseError], tuple[tuple[Diagnostic, ...]]]:
        # By default exceptions are pickled by their message: workers would lose the findings.
        return type(self), (self.diagnostics,)


# --- Limits of the language, so that no file can exhaust time or memory ---

MAX_CHARACTERS = 4_000_000
"""Longest accepted text."""

MAX_LINES = 150_000
"""Most lines of a text."""

MAX_LINE = 20_000
"""Longest single line, in characters."""

MAX_INPUTS = 32
MAX_OUTPUTS = 32
MAX_TERMS = 5_000
"""Most terms of one variable."""

MAX_RULES = 100_000
MAX_NESTING = 50
"""Deepest nesting of parentheses in an antecedent."""

MAX_LEVELS = 100_000
"""Most levels of one lookup axis."""

MAX_MAGNITUDE = 1e100
"""Largest number of a range or a shape, infinity apart: areas and moments are its powers."""

MIN_WIDTH = 1e-100
"""Smallest width of a range, and smallest spread of a shape."""

MAX_DIAGNOSTICS = 1_000
"""Most findings of one run; reading stops after them."""


# --- Display: position, source line, caret, hint, as plain text ---

_COLOURS = {Severity.ERROR: "31", Severity.WARNING: "33", Severity.INFO: "36"}
_WIDEST = 160


_LINE_END = re.compile(r"\r\n|\r|\n")


def split_lines(text: str) -> list[str]:
    r"""Return the lines of `text`; only ``\n``, ``\r\n`` and ``\r`` end a line."""
    lines = _LINE_END.split(text)
    if lines and lines[-1] == "":
        lines.pop()
    return lines


def display_width(text: str) -> int:
    """Return the width of `text` in terminal columns."""
    if text.isascii():
        return len(text)
    import unicodedata

    return sum(
        0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1
        for c in text
    )


def render_all(diagnostics: Sequence[Diagnostic], text: str, *, colour: bool = False) -> str:
    """Return diagnostics of one text, each as headline, source line, caret, hint and relations.

    Parameters
    ----------
    diagnostics : sequence of Diagnostic
        The findings.
    text : str
        Their text.
    colour : bool
        Whether to use terminal colours.
    """
    lines = split_lines(text)
    return "\n".join("\n".join(_parts(d, lines, colour=colour)) for d in diagnostics)


def _parts(diagnostic: Diagnostic, lines: list[str], *, colour: bool) -> list[str]:
    position = printable(diagnostic.position)
    label = f"{diagnostic.severity}[{diagnostic.name}]"
    if colour:
        label = f"\x1b[1;{_COLOURS[diagnostic.severity]}m{label}\x1b[0m"
    parts = [f"{position}: {label}: {printable(diagnostic.message)}"]
    parts += _excerpt(diagnostic.span, lines)
    if diagnostic.hint:
        parts.append(f"       = hint: {printable(diagnostic.hint)}")
    for related in diagnostic.related:
        message = printable(related.message)
        parts.append(f"       = {message}: {related.span.line}:{related.span.column}")
        parts += _excerpt(related.span, lines)
    return parts


def _excerpt(span: Span, lines: list[str]) -> list[str]:
    if not 1 <= span.line <= len(lines):
        return []
    line = lines[span.line - 1]
    start = min(span.column - 1, len(line))
    end = span.end_column - 1 if span.end_line == span.line else len(line)
    end = max(min(end, len(line)), start)
    offset = 0
    if len(line) > _WIDEST:
        # Long lines are cut to start a little before the fault.
        offset = max(0, min(start - 20, len(line) - _WIDEST))
        end = min(end, offset + _WIDEST)
    before = printable(line[offset:start])
    mark = printable(line[start:end])
    excerpt = printable(line[offset : offset + _WIDEST])
    caret = " " * display_width(before) + "^" * max(1, display_width(mark))
    number = f"{span.line:>6}"
    return [f"{number} | {excerpt}", f"{'':>6} | {caret}"]


# --- Names and numbers that carry their position ---
#
# They are strings and floats: a model made of them equals one built in Python, and computes the
# same.


class Word(str):
    """A name, or a word of the language, without quotes."""

    __slots__ = ("span",)

    span: Span

    def __new__(cls, text: str, span: Span = NOWHERE) -> Self:
        """Return a name with its position."""
        word = super().__new__(cls, text)
        word.span = span
        return word

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.span)


class Figure(float):
    """A number."""

    __slots__ = ("span",)

    span: Span

    def __new__(cls, value: float, span: Span = NOWHERE) -> Figure:
        """Return a number with its position."""
        figure = super().__new__(cls, value)
        figure.span = span
        return figure

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (float(self), self.span)


def span_of(value: object) -> Span:
    """Return the position of a name or a number; NOWHERE for one built in Python."""
    span = getattr(value, "span", NOWHERE)
    return span if isinstance(span, Span) else NOWHERE
