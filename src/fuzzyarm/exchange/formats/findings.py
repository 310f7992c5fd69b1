"""Results of reading and writing foreign formats, and the findings on the way.

:class:`Imported` and :class:`Exported` are the results, :class:`Findings` collects the diagnostics;
numbers are read and written without loss.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import islice

from fuzzyarm.base.diagnostic import NOWHERE, Diagnostic, Related, Severity, Span
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.shown import one_line
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic.evaluation import evaluate
from fuzzyarm.symbolic.formulas import FormulaError, read_formula

# --- Results and findings ---

MAX_CHARACTERS = 1_000_000
"""Longest foreign text: four times the largest that programs write."""

MAX_FINDINGS = 300
"""Most findings listed of a file; the rest is counted."""

MAX_HINTS = 20
"""Findings with a suggested name (the search costs time)."""

MAX_CHOICES = 300
"""Most names compared for a suggestion."""

MAX_LISTED = 12
"""Most names listed in a hint."""

MAX_VARIABLES = 200
MAX_RULES = 10_000

LOSSY_HINT = "--lossy continues anyway"


class FormatError(FuzzyarmError, ValueError):
    """An unknown suffix or producer."""


def demand_program(
    producer: str | None, suffix: str, does: str, known_by: Mapping[str, tuple[str, ...]]
) -> None:
    """Refuse an unknown producer for a suffix."""
    programs = known_by.get(suffix, ())
    if producer is not None and producer not in programs:
        names = ", ".join(programs) or "none"
        raise FormatError(f"{suffix} files are not {does} '{producer}' (known: {names})")


@dataclass(frozen=True, slots=True, repr=False)
class Imported:
    """The result of reading a foreign file.

    Attributes
    ----------
    rulebase : RuleBase or None
        None after any error.
    diagnostics : tuple of Diagnostic
        Faults of the file and conversion losses, in text order.
    producer : str
        The program whose defaults apply: ``fuzzylite``, ``jfuzzylogic``, ``scikit-fuzzy``,
        ``matlab``, ``octave``, ``ieee1855`` (FML) or ``fuzzyarm``; for a live object its library.
    """

    rulebase: RuleBase | None
    diagnostics: tuple[Diagnostic, ...] = ()
    producer: str = ""

    def __repr__(self) -> str:
        content = "no rule base" if self.rulebase is None else repr(self.rulebase)
        return one_line(self, f"{content}, {len(self.diagnostics)} findings, as of {self.producer}")

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The errors, which make the file unusable."""
        return tuple(d for d in self.diagnostics if d.is_error)


@dataclass(frozen=True, slots=True, repr=False)
class Exported:
    """The result of writing a rule base in a foreign format.

    Attributes
    ----------
    text : str or None
        None after any error.
    diagnostics : tuple of Diagnostic
        Features that the format cannot express.
    """

    text: str | None
    diagnostics: tuple[Diagnostic, ...] = ()

    def __repr__(self) -> str:
        size = "no text" if self.text is None else f"{len(self.text):,} characters"
        return one_line(self, f"{size}, {len(self.diagnostics)} findings")

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The errors, which prevented the text."""
        return tuple(d for d in self.diagnostics if d.is_error)


@dataclass(frozen=True, slots=True)
class TextPiece:
    """A piece of text with its position."""

    text: str
    span: Span = NOWHERE

    def part(self, start: int, end: int) -> TextPiece:
        """Return the characters from index `start` to `end` of a word on one line."""
        line, column = self.span.line, self.span.column
        return TextPiece(self.text[start:end], Span(line, column + start, line, column + end))

    def parts(self, pattern: re.Pattern[str]) -> list[TextPiece]:
        """Return the pieces that match a pattern."""
        return [self.part(*match.span()) for match in pattern.finditer(self.text)]

    def around(self, sign: str) -> tuple[TextPiece, TextPiece] | None:
        """Return the stripped texts before and after a sign; None without the sign."""
        before, sign_, after = self.text.partition(sign)
        if not sign_:
            return None
        start = len(self.text) - len(after.lstrip())
        return self.part(0, len(before.rstrip())), self.part(start, len(self.text))


class UnreadableError(Exception):
    """An unreadable part of a live object, with the reason.

    Parameters
    ----------
    part : str
        Name of the part in messages.
    error : Exception
        The exception raised on reading.
    """

    def __init__(self, part: str, error: Exception) -> None:
        super().__init__(f"{part} cannot be read: {type(error).__name__}: {error}")


@contextmanager
def reading(part: str) -> Iterator[None]:
    """Convert any exception inside into an :class:`UnreadableError` of this part."""
    try:
        yield
    except (UnreadableError, FuzzyarmError):
        raise
    except Exception as error:
        raise UnreadableError(part, error) from error


class FaultError(ValueError):
    """The end of parsing: message, word, and name of the finding."""

    def __init__(self, message: str, word: TextPiece, name: str = "syntax") -> None:
        super().__init__(message)
        self.word = word
        self.name = name


class Findings:
    """Collects the diagnostics of one file.

    Parameters
    ----------
    path : str
        The file, as named by the caller.
    lossy : bool
        Make a loss that changes numbers a warning instead of an error.
    strict : bool
        Make a slight loss an error too.
    """

    def __init__(self, path: str = "", *, lossy: bool = False, strict: bool = False) -> None:
        self.path = path
        self.lossy = lossy
        self.strict = strict
        self._items: list[Diagnostic] = []
        self._left_out = 0
        self._errors = 0
        self._hints = 0
        self._full: set[str] = set()
        self._unknown: dict[tuple[str, str, str], tuple[int, int]] = {}

    @property
    def failed(self) -> bool:
        """Whether an error was recorded."""
        return self._errors > 0

    def has(self, *names: str) -> bool:
        """Whether there is an error of one of these names."""
        return any(item.name in names and item.is_error for item in self._items)

    @property
    def is_damaged(self) -> bool:
        """Whether parts of the file are missing, which explains further faults."""
        return self.has("syntax", "wrong-count")

    def error(
        self, name: str, message: str, at: TextPiece | Span = NOWHERE, hint: str = ""
    ) -> None:
        """Record a fault that makes the file unusable."""
        self._add(name, message, at, Severity.ERROR, hint)

    def fault(self, fault: FaultError) -> None:
        """Record the end of parsing of a part."""
        self.error(fault.name, str(fault), fault.word)

    def loss(
        self,
        name: str,
        message: str,
        at: TextPiece | Span = NOWHERE,
        hint: str = "",
        *,
        slight: bool = False,
    ) -> None:
        """Record a conversion loss that changes numbers.

        A `slight` loss, such as another sampling, is a warning unless the caller is strict.
        """
        allowed = self.lossy or (slight and not self.strict)
        severity = Severity.WARNING if allowed else Severity.ERROR
        self._add(name, message, at, severity, hint or ("" if allowed else LOSSY_HINT))

    def warn(self, name: str, message: str, at: TextPiece | Span = NOWHERE, hint: str = "") -> None:
        """Record a doubt without numerical effect."""
        self._add(name, message, at, Severity.WARNING, hint)

    def info(self, name: str, message: str, at: TextPiece | Span = NOWHERE, hint: str = "") -> None:
        """Record a choice or an omission."""
        self._add(name, message, at, Severity.INFO, hint)

    def no_term(
        self, variable: str, word: TextPiece, terms: Iterable[str], before: str = ""
    ) -> None:
        """Record an unknown term of a variable."""
        self.unknown("undefined-term", f"{before}'{variable}' has no term", word, terms, ending="")

    def unknown(
        self,
        name: str,
        subject: str,
        word: TextPiece,
        choices: Iterable[str],
        *,
        ending: str = " is not known",
    ) -> None:
        """Record a word outside `choices`, with the nearest one as a suggestion.

        A repeated word is one finding with its count. The hint lists names of the file; words of
        the format only where none is near.
        """
        key = (name, subject, word.text)
        if key in self._unknown:
            index, times = self._unknown[key]
            # Counts for `failed`, although it is not listed again.
            self._unknown[key] = index, times + 1
            self._errors += 1
            return
        names = list(islice(choices, MAX_CHOICES))
        hint, replacement = "", None
        if self._hints < MAX_HINTS:
            self._hints += 1
            hint, replacement = near_hint(word.text, names)
        # Names of the file are few; all words of a format are a last resort.
        if not hint or name.startswith("undefined"):
            hint = "; ".join(filter(None, (hint, listed(names))))
        message = f"{subject} '{shortened(word.text)}'{ending}"
        if len(self._items) < MAX_FINDINGS:
            self._unknown[key] = len(self._items), 1
        self._add(name, message, word, Severity.ERROR, hint, replacement)

    def ignored_key(self, word: TextPiece, choices: Sequence[str]) -> None:
        """Record an ineffective key: an error if one of `choices` may be meant."""
        hint, _ = near_hint(word.text.lower(), [choice.lower() for choice in choices])
        if hint:
            self.unknown("unknown-key", "the key", word, choices)
        else:
            message = f"the key '{shortened(word.text)}' is not known; it is left out"
            self.warn("unknown-key", message, word)

    def norm(
        self, subject: str, word: TextPiece, table: Mapping[str, str], key: str = ""
    ) -> str | None:
        """Return the norm of `key` (by default the word itself) in a table of words."""
        name = table.get(key or word.text)
        if name is None:
            self.unknown("unknown-norm", subject, word, table)
        return name

    def room(self, count: int, most: int, items: str, at: TextPiece | Span) -> bool:
        """Whether there is room for one more than `count`; report the first time there is not."""
        if count < most:
            return True
        if items not in self._full:
            self._full.add(items)
            self.error("too-many", f"more than {most} {items} are not read", at)
        return False

    def duplicate(self, name: str, message: str, at: TextPiece | Span, first: Span) -> None:
        """Record a warning that also points at the first of the two."""
        related = (Related("the first one", first),)
        self._add(name, message, at, Severity.WARNING, "", None, related)

    def _add(
        self,
        name: str,
        message: str,
        at: TextPiece | Span,
        severity: Severity,
        hint: str,
        replacement: str | None = None,
        related: tuple[Related, ...] = (),
    ) -> None:
        span = at.span if isinstance(at, TextPiece) else at
        self._errors += severity is Severity.ERROR
        if len(self._items) >= MAX_FINDINGS:
            self._left_out += 1
            return
        self._items.append(
            Diagnostic(name, message, span, severity, hint, replacement, self.path, related)
        )

    def imported(self, rulebase: RuleBase | None, producer: str) -> Imported:
        """Return the result of reading with all findings; no rule base after an error."""
        return Imported(None if self.failed else rulebase, self.all(), producer)

    def exported(self, text: str) -> Exported:
        """Return the result of writing with all findings; no text after an error."""
        return Exported(None if self.failed else text, self.all())

    def all(self) -> tuple[Diagnostic, ...]:
        """Return all findings in text order."""
        items = list(self._items)
        for index, times in self._unknown.values():
            if times > 1:
                message = f"{items[index].message} (here and {times - 1} more times)"
                items[index] = replace(items[index], message=message)
        diagnostics = sorted(items, key=lambda d: (d.span, d.name))
        if self._left_out:
            severity = Severity.ERROR if self.failed else Severity.INFO
            message = f"{self._left_out} more findings are not listed"
            diagnostics.append(
                Diagnostic("more-findings", message, NOWHERE, severity, path=self.path)
            )
        return tuple(diagnostics)


def listed(names: Sequence[str]) -> str:
    """Return names as the end of a hint, cut after the first few."""
    names = [name for name in names if name]
    if not names:
        return ""
    some = ", ".join(map(shortened, names[:MAX_LISTED]))
    return f"known: {some}, …" if len(names) > MAX_LISTED else f"known: {some}"


def shortened(text: str) -> str:
    """Return `text`, cut in the middle beyond 60 characters."""
    if len(text) <= 60:
        return text
    half = 29  # with the ellipsis, 59 characters
    return f"{text[:half]}…{text[-half:]}"


def unique_name(name: str, names: set[str]) -> str:
    """Return `name`, with the first number that makes it unique if needed."""
    if name not in names:
        return name
    number = 2
    while f"{name}_{number}" in names:
        number += 1
    return f"{name}_{number}"


# --- Numbers, read and written without loss ---

_PLAIN = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eEdD][+-]?\d+)?\Z", re.ASCII)
_SPECIAL = {
    "nan": math.nan, "+nan": math.nan, "-nan": math.nan, "na": math.nan,
    "inf": math.inf, "+inf": math.inf, "-inf": -math.inf,
    "infinity": math.inf, "-infinity": -math.inf,
}  # fmt: skip
_PRODUCT = re.compile(r"[+-]*(?:[\d.pi*/]|e[+-]?\d)+", re.ASCII)


def number(text: str) -> float | None:
    """Return the value of `text`, or None for anything but a finite or infinite number.

    Besides decimal numbers: ``nan``, ``inf``, and products and quotients with ``pi`` such as
    ``-pi/4`` or ``2*pi``, which are common in hand-written ``.fis`` files.
    """
    if _PLAIN.match(text):
        # MATLAB and Octave read `1d3` as a number.
        value = float(text.replace("d", "e").replace("D", "e"))
        return value if math.isfinite(value) else None
    if len(text) > 60:
        return None
    lowered = text.lower()
    if lowered in _SPECIAL:
        return _SPECIAL[lowered]
    if "pi" not in lowered or not _PRODUCT.fullmatch(lowered):
        return None
    try:
        value = evaluate(read_formula(lowered).with_constants(()), {})
    except FormulaError:
        return None
    return value if math.isfinite(value) else None


def is_too_large(text: str) -> bool:
    """Whether a text is a number beyond the range of doubles."""
    return _PLAIN.match(text) is not None and number(text) is None


def not_a_number(text: str) -> str:
    """Return the message about a text without a value by :func:`number`."""
    fault = "too large for a number" if is_too_large(text) else "not a number"
    return f"'{text[:60]}' is {fault}"


def numbers(words: list[TextPiece], findings: Findings) -> list[float] | None:
    """Return the values of `words`; None, with findings, if one is not a number."""
    values: list[float] = []
    failed = False
    for word in words:
        value = number(word.text)
        if value is None:
            findings.error("not-a-number", not_a_number(word.text), word)
            failed = True
        else:
            values.append(value)
    return None if failed else values


def written(value: float) -> str:
    """Return the shortest text that reads back exactly as `value`."""
    if math.isnan(value):
        return "nan"
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    text = repr(float(value))
    return text.removesuffix(".0")


def all_written(values: tuple[float, ...]) -> str:
    """Return the numbers separated by spaces."""
    return " ".join(map(written, values))


_THREE = re.compile(r"(?<![\w.])-?\d+\.\d{3}(?![\w.])", re.ASCII)
_OTHER = re.compile(r"(?<![\w.])-?\d+\.(\d{1,2}|\d{4,})(?![\w.])", re.ASCII)


def rounded(text: str) -> re.Match[str] | None:
    """Return the first number with three decimals, if all numbers of the text have three.

    fuzzylite prints three decimals by default; a file with nothing but such numbers may give other
    outputs than its original.
    """
    if _OTHER.search(text):
        return None
    return next((m for m in _THREE.finditer(text) if not m.group().endswith("0")), None)
