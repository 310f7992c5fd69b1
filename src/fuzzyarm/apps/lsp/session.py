"""One open file, with positions in the protocol's units; independent of the protocol's library."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.lsp.tables import TableText
from fuzzyarm.base.diagnostic import Diagnostic, RuleBaseError, Span, split_lines
from fuzzyarm.exchange.files import Judgement, Review, check_parsed, judge
from fuzzyarm.language import Parsed, format_text
from fuzzyarm.language.document import ParseMemory
from fuzzyarm.language.edit import (
    Coloured,
    Completion,
    Edit,
    Facts,
    Fix,
    Fold,
    Hover,
    OutlineSymbol,
    Reading,
    coloured,
    complete,
    fixes,
    folds,
    hover,
    occurrence_at,
    plain,
    read,
    references,
    rename,
    symbols,
)
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.phrases import NameKind as Name
from fuzzyarm.language.rules import GridNode

if TYPE_CHECKING:
    from fuzzyarm.plant.plant import Plant
    from fuzzyarm.proof.map import Verdict

# --- Protocol positions (code units, from 0) and lines and columns (from 1) ---
#
# The protocol ends lines at CR LF, LF and CR only, as the language does.

UTF8, UTF16, UTF32 = "utf-8", "utf-16", "utf-32"

_LINE_END = re.compile(r"\r\n|\n|\r")


def units(text: str, encoding: str = UTF16) -> int:
    """Return the length of `text` in the code units of `encoding`."""
    if encoding == UTF32 or text.isascii():
        return len(text)
    if encoding == UTF8:
        return len(text.encode("utf-8", "surrogatepass"))
    return len(text) + sum(character > "\uffff" for character in text)


def characters(text: str, count: int, encoding: str = UTF16) -> int:
    """Return the number of characters in the first `count` code units of `text`.

    A count beyond the end means the end; one inside a character means its start.
    """
    if encoding == UTF32 or text.isascii():
        return max(0, min(count, len(text)))
    width = 0
    for index, character in enumerate(text):
        width += units(character, encoding)
        if width > count:
            return index
    return len(text)


def to_position(lines: Sequence[str], line: int, column: int, encoding: str) -> tuple[int, int]:
    """Return line and code unit, from 0, of a position counted from 1."""
    text = lines[line - 1] if 1 <= line <= len(lines) else ""
    return line - 1, units(text[: column - 1], encoding)


def to_place(lines: Sequence[str], line: int, character: int, encoding: str) -> tuple[int, int]:
    """Return line and column, from 1, of a position of the protocol."""
    text = lines[line] if 0 <= line < len(lines) else ""
    return line + 1, characters(text, character, encoding) + 1


Range = tuple[int, int, int, int]
"""Start line and character, end line and character, in the protocol's units."""


def _change_text(text: str, where: Range | None, new: str, encoding: str = UTF16) -> str:
    """Return `text` after one change of the protocol; without a range all of it is replaced."""
    if where is None:
        return new
    starts = [0, *(match.end() for match in _LINE_END.finditer(text))]
    start = _offset(text, starts, where[0], where[1], encoding)
    end = max(start, _offset(text, starts, where[2], where[3], encoding))
    return text[:start] + new + text[end:]


def _offset(text: str, starts: list[int], line: int, character: int, encoding: str) -> int:
    if line >= len(starts):
        return len(text)
    start = starts[line]
    stop = starts[line + 1] if line + 1 < len(starts) else len(text)
    content = text[start:stop].rstrip("\r\n")
    return start + characters(content, character, encoding)


# --- The kinds of files ---


@dataclass(frozen=True, slots=True)
class FileKind:
    """The editing functions of a kind of file; all but `read` work on its result.

    Attributes
    ----------
    read : callable
        From the text and its path to its reading.
    complete, hover : callable
        Completions at a line and column, and the hover text there.
    name_at : callable
        The name there and its span, or None.
    occurrences : callable
        All spans of the name there, and whether each is a declaration.
    rename : callable
        The edits of a new name; may raise RenameError.
    symbols, folds, coloured : callable
        The outline, the foldable ranges, and the coloured words.
    fixes : callable
        The repairs of a diagnostic.
    formatted : callable
        The canonical text, or None if the text has mistakes or would lose something.
    """

    read: Callable[[str, str, ParseMemory], Any]
    complete: Callable[[Any, int, int], list[Completion]]
    hover: Callable[[Any, int, int], Hover | None]
    name_at: Callable[[Any, int, int], tuple[str, Span] | None]
    occurrences: Callable[[Any, int, int], list[tuple[Span, bool]]]
    rename: Callable[[Any, int, int, str], list[Edit]]
    symbols: Callable[[Any], list[OutlineSymbol]]
    folds: Callable[[Any], list[Fold]]
    coloured: Callable[[Any], Iterable[Coloured]]
    fixes: Callable[[Any, Diagnostic], list[Fix]]
    formatted: Callable[[Any], str | None]


def _name_at(reading: Reading, line: int, column: int) -> tuple[str, Span] | None:
    occurrence = occurrence_at(reading, line, column)
    return None if occurrence is None else (occurrence.name, occurrence.span)


def _occurrences(reading: Reading, line: int, column: int) -> list[tuple[Span, bool]]:
    occurrence = occurrence_at(reading, line, column)
    every = [] if occurrence is None else references(reading, occurrence)
    return [(mention.span, mention.is_definition) for mention in every]


def _fixes(reading: Reading, finding: Diagnostic) -> list[Fix]:
    nodes = (statement.node for statement in reading.document.statements)
    return fixes(finding, reading.text, [node for node in nodes if isinstance(node, GridNode)])


def _formatted(reading: Reading) -> str | None:
    try:
        return format_text(reading.text)
    except RuleBaseError:
        return None


def _ports(reading: Reading) -> Facts:
    """Return the ports of the plants with the axes of a controller."""
    if reading.parsed.whole is None:
        return {}
    from fuzzyarm.control.controllers.findings import plants_in_words, ports_in_words

    axes = reading.parsed.whole.axis_names
    names = {(Name.PORT, name): words for name, words in ports_in_words(axes).items()}
    of_plants = plants_in_words(axes)
    names |= {(Name(kind), name): words for (kind, name), words in of_plants.items()}
    return names


def _facts(reading: Reading) -> Facts:
    """Return a controller's ports and the ranges of its signals."""
    controller = reading.parsed.controller
    if controller is None:
        return _ports(reading)
    from fuzzyarm.control.controllers.findings import ranges_in_words
    from fuzzyarm.control.controllers.text import home_of, with_files

    ranges = ranges_in_words(with_files(controller, home_of(reading.path), reading.path)[0])
    signals = {(Name.SIGNAL, name): f"reaches {words}" for name, words in ranges.items()}
    return {**_ports(reading), **signals}


def _complete(reading: Reading, line: int, column: int) -> list[Completion]:
    return complete(reading, line, column, _ports(reading))


def _hover(reading: Reading, line: int, column: int) -> Hover | None:
    return hover(reading, line, column, _facts(reading))


RULE_BASE = FileKind(
    read, _complete, _hover, _name_at, _occurrences, rename, symbols, folds, coloured, _fixes,
    _formatted,
)  # fmt: skip
TABLE = FileKind(
    lambda text, path, _memory: TableText(text, path),
    TableText.complete,
    TableText.hover,
    TableText.name_at,
    TableText.occurrences,
    TableText.rename,
    TableText.symbols,
    TableText.folds,
    TableText.coloured,
    lambda table, finding: fixes(finding, "\n".join(table.lines)),
    TableText.formatted,
)


# --- An open file: text, reading and findings ---

SLOW = 0.2
"""Duration of a check in seconds from which on the file is read in a thread, too."""


class Session:
    """An open file.

    Parameters
    ----------
    path : str
        Named in the diagnostics; ``.lut`` makes it a table.
    text : str
        The text on opening.
    version : int or None
        The editor's number for this state of the text.
    plants : sequence of Plant
        Plants of the user, for controllers, beside the shipped ones.
    """

    def __init__(
        self, path: str, text: str, version: int | None = None, plants: Sequence[Plant] = ()
    ) -> None:
        self.path = path
        self.plants = plants
        self.text = text
        self.version = version
        self.kind = TABLE if path.lower().endswith(".lut") else RULE_BASE
        # Until the first measurement the duration of a check is estimated from the length.
        self.cost = 2e-6 * len(text)
        self._elapsed = 0.0
        self._judged: tuple[RuleBase, list[Span], Judgement] | None = None
        self._memory = ParseMemory()
        self._reading: Any = None
        self._last_reading: Any = None
        self._review: Review | None = None

    @property
    def lines(self) -> list[str]:
        """The lines of the text, without their ends."""
        return split_lines(self.text)

    def replace(self, text: str, version: int | None = None) -> None:
        """Replace the text."""
        self.version = version
        if text != self.text:
            self.text = text
            self._reading = self._review = None

    def change(self, where: Range | None, new: str, encoding: str = UTF16) -> None:
        """Apply a change from an editor."""
        self.replace(_change_text(self.text, where, new, encoding), self.version)

    @property
    def reading(self) -> Any:
        """The current text, read: a `Reading`, or a `TableText`."""
        if self._reading is None:
            self._reading = self.kind.read(self.text, self.path, self._memory)
            self._last_reading = self._reading
        return self._reading

    @property
    def quick_reading(self) -> Any:
        """The words of the current text; in a large rule base with the previous meaning.

        For completion: the names are known, and a key stroke rarely changes them.
        """
        slow = self._reading is None and self.cost >= SLOW
        if not slow or not isinstance(self._last_reading, Reading):
            return self.reading
        lines = self._memory.tokenize(self.text, [])
        return Reading(self.text, self._last_reading.parsed, tuple(lines), self.path)

    @property
    def reviewed(self) -> bool:
        """Whether the findings of the current text are known."""
        return self._review is not None

    def review(self, on_step: Callable[[], None] = lambda: None) -> Review:
        """Return the findings of the current text, as in ``fuzzyarm check``.

        `on_step` is called at intervals; an exception from it ends the check.
        """
        if self._review is None:
            start = time.perf_counter()
            self._review = self._check(on_step)
            # The lesser of two measurements: a single hiccup of the machine makes no file slow.
            elapsed = time.perf_counter() - start
            self.cost, self._elapsed = min(elapsed, self._elapsed or self.cost), elapsed
        return self._review

    def _check(self, on_step: Callable[[], None]) -> Review:
        parsed = self.reading.parsed
        if not isinstance(parsed, Parsed):
            return Review(self.text, tuple(parsed.diagnostics))
        failed = self._failed(parsed.rulebase, on_step)
        return check_parsed(parsed, self.text, self.path, failed, on_step, own=self.plants)

    def _failed(
        self, rulebase: RuleBase | None, on_step: Callable[[], None]
    ) -> list[Diagnostic] | None:
        """Return the failed promises; the previous ones if the meaning is unchanged."""
        if rulebase is None or not (rulebase.expectations or rulebase.properties):
            return None
        judged, spans = self._judged, [expectation.span for expectation in rulebase.expectations]
        spans += [statement.span for statement in rulebase.properties]
        if judged is None or judged[1] != spans or judged[0] != rulebase:
            judged = rulebase, spans, judge(rulebase, on_step)
        self._judged = judged
        return judged[2].findings

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """The verdicts on the ``prove`` lines, after a review of the current text."""
        return () if self._judged is None or self._review is None else self._judged[2].verdicts

    def hover(self, line: int, column: int) -> Hover | None:
        """Return the hover text at a position, with the last verdict on a ``prove`` line."""
        answer: Hover | None = self.kind.hover(self.reading, line, column)
        verdict = next((candidate for candidate in self.verdicts if candidate.line == line), None)
        if answer is None or verdict is None:
            return answer
        text = "\n\n".join(plain(words) for words in str(verdict).splitlines())
        return Hover(f"{answer.markdown}\n\n{text}", answer.span)

    def copy(self) -> Session:
        """Return a session for a check in another thread; the fast parts are read here."""
        other = Session(self.path, self.text, self.version, self.plants)
        other.cost, other._elapsed, other._judged = self.cost, self._elapsed, self._judged
        if self.cost < SLOW:
            other._reading = self.reading
        return other

    def adopt(self, other: Session) -> bool:
        """Adopt the findings of a copy with the same text; return whether it has it."""
        if other.text != self.text:
            return False
        self._reading = self._last_reading = other.reading
        self._review, self._judged = other.review(), other._judged
        self.cost, self._elapsed = other.cost, other._elapsed
        return True
