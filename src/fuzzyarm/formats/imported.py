"""What a reader or writer of a foreign format hands back, and how it collects findings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice

from fuzzyarm.rulebase.diagnostic import NOWHERE, Diagnostic, Related, Severity, Span
from fuzzyarm.rulebase.model import RuleBase
from fuzzyarm.rulebase.near import near_hint

MAX_CHARACTERS = 200_000
"""Longest foreign text that is read: some hundred times the largest that people write."""

MAX_FINDINGS = 300
"""Most findings that one reading lists; the rest is counted."""

MAX_HINTS = 20
"""Findings that get a guess of what was meant (a guess costs time)."""

MAX_CHOICES = 300
"""Names that are compared for such a guess."""

MAX_TERMS = 1_000
MAX_VARIABLES = 200
MAX_RULES = 10_000

LOSSY_HINT = "--lossy goes on regardless"


@dataclass(frozen=True, slots=True)
class Imported:
    """A foreign file, read.

    Attributes
    ----------
    rulebase : RuleBase or None
        None where any diagnostic is an error.
    diagnostics : tuple of Diagnostic
        Faults of the file and what could not be carried, in the order of the text.
    producer : str
        The program whose defaults were taken: ``fuzzylite``, ``jfuzzylogic``, ``matlab``,
        ``octave`` or ``fuzzyarm``.
    """

    rulebase: RuleBase | None
    diagnostics: tuple[Diagnostic, ...] = ()
    producer: str = ""

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The findings that keep the file from being used."""
        return tuple(d for d in self.diagnostics if d.is_error)


@dataclass(frozen=True, slots=True)
class Exported:
    """A rule base, written in a foreign format.

    Attributes
    ----------
    text : str or None
        None where any diagnostic is an error.
    diagnostics : tuple of Diagnostic
        What the format cannot express.
    """

    text: str | None
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The findings that kept the text from being written."""
        return tuple(d for d in self.diagnostics if d.is_error)


@dataclass(frozen=True, slots=True)
class Word:
    """A piece of text and where it stood."""

    text: str
    span: Span = NOWHERE


class Findings:
    """Collects the diagnostics of one file.

    Parameters
    ----------
    path : str
        The file, as the caller named it.
    lossy : bool
        Whether a loss that changes numbers is a warning rather than an error.
    """

    def __init__(self, path: str = "", *, lossy: bool = False) -> None:
        self.path = path
        self.lossy = lossy
        self._items: list[Diagnostic] = []
        self._left_out = 0
        self._errors = 0
        self._hints = 0
        self._full: set[str] = set()

    @property
    def failed(self) -> bool:
        """Whether there was an error."""
        return self._errors > 0

    def error(self, name: str, message: str, at: Word | Span = NOWHERE, hint: str = "") -> None:
        """Record a fault that keeps the file from being used."""
        self._add(name, message, at, Severity.ERROR, hint)

    def loss(self, name: str, message: str, at: Word | Span = NOWHERE, hint: str = "") -> None:
        """Record what cannot be carried and changes numbers."""
        severity = Severity.WARNING if self.lossy else Severity.ERROR
        self._add(name, message, at, severity, hint or ("" if self.lossy else LOSSY_HINT))

    def warn(self, name: str, message: str, at: Word | Span = NOWHERE, hint: str = "") -> None:
        """Record a doubt that changes no number."""
        self._add(name, message, at, Severity.WARNING, hint)

    def info(self, name: str, message: str, at: Word | Span = NOWHERE, hint: str = "") -> None:
        """Record a choice or a piece of text that was left out."""
        self._add(name, message, at, Severity.INFO, hint)

    def unknown(self, name: str, what: str, word: Word, choices: Iterable[str]) -> None:
        """Record an error about a word that is none of `choices`, with a guess."""
        hint, replacement = "", None
        if self._hints < MAX_HINTS:
            self._hints += 1
            hint, replacement = near_hint(word.text, islice(choices, MAX_CHOICES))
        message = f"{what} '{shortened(word.text)}' is not known"
        self._add(name, message, word, Severity.ERROR, hint, replacement)

    def room(self, count: int, most: int, what: str, at: Word | Span) -> bool:
        """Whether one more than `count` is allowed; the first time it is not, say so."""
        if count < most:
            return True
        if what not in self._full:
            self._full.add(what)
            self.error("too-many", f"more than {most} {what} are not read", at)
        return False

    def duplicate(self, name: str, message: str, at: Word | Span, first: Span) -> None:
        """Record a warning that also points at the first of two."""
        related = (Related("the first one", first),)
        self._add(name, message, at, Severity.WARNING, "", None, related)

    def _add(
        self,
        name: str,
        message: str,
        at: Word | Span,
        severity: Severity,
        hint: str,
        replacement: str | None = None,
        related: tuple[Related, ...] = (),
    ) -> None:
        span = at.span if isinstance(at, Word) else at
        self._errors += severity is Severity.ERROR
        if len(self._items) >= MAX_FINDINGS:
            self._left_out += 1
            return
        self._items.append(
            Diagnostic(name, message, span, severity, hint, replacement, self.path, related)
        )

    def all(self) -> tuple[Diagnostic, ...]:
        """Return everything found, in the order of the text."""
        found = sorted(self._items, key=lambda d: (d.span, d.name))
        if self._left_out:
            severity = Severity.ERROR if self.failed else Severity.INFO
            message = f"{self._left_out} more findings are not listed"
            found.append(Diagnostic("more-findings", message, NOWHERE, severity, path=self.path))
        return tuple(found)


def too_long(text: str, path: str) -> Imported | None:
    """Return the refusal of a text of absurd length, or None."""
    if len(text) <= MAX_CHARACTERS:
        return None
    findings = Findings(path)
    message = f"the file has {len(text)} characters, more than the {MAX_CHARACTERS} that are read"
    findings.error("too-long", message)
    return Imported(None, findings.all())


def shortened(text: str, length: int = 60) -> str:
    """Return `text`, cut in the middle where it is longer than `length`."""
    if len(text) <= length:
        return text
    half = (length - 1) // 2
    return f"{text[:half]}…{text[-half:]}"
