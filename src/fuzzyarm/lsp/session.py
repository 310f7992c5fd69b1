"""One open file, and the positions of the protocol in its text. Free of the protocol's library."""

from __future__ import annotations

import re
import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import Self

from fuzzyarm.api import Review
from fuzzyarm.language.queries import Candidate, Coloured, Edit, Fix, Fold, Hover, Symbol, fixes
from fuzzyarm.text.diagnostic import Diagnostic, Span, split_lines

# --- Between the protocol's positions, which count code units from 0, and places in a text ---
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
    """Return how many characters of `text` the first `count` code units are.

    A count beyond the end is the end; one in the middle of a character is its start.
    """
    if encoding == UTF32 or text.isascii():
        return max(0, min(count, len(text)))
    used = 0
    for index, character in enumerate(text):
        used += units(character, encoding)
        if used > count:
            return index
    return len(text)


def to_position(lines: Sequence[str], line: int, column: int, encoding: str) -> tuple[int, int]:
    """Return line and code unit, from 0, of a place that counts from 1."""
    text = lines[line - 1] if 1 <= line <= len(lines) else ""
    return line - 1, units(text[: column - 1], encoding)


def to_place(lines: Sequence[str], line: int, character: int, encoding: str) -> tuple[int, int]:
    """Return line and column, from 1, of a position of the protocol."""
    text = lines[line] if 0 <= line < len(lines) else ""
    return line + 1, characters(text, character, encoding) + 1


Range = tuple[int, int, int, int]
"""Start line and character, end line and character, as the protocol counts."""


def change_text(text: str, where: Range | None, new: str, encoding: str = UTF16) -> str:
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


# --- One open file: its text, what an editor asks of it, and the findings of its check ---

SLOW = 0.2
"""A file whose check takes longer, in seconds, is checked beside the answering of questions."""


class OpenText(ABC):
    """An open file; a kind of files is a class that answers the questions of an editor.

    Places count lines and columns from 1.

    Parameters
    ----------
    path : str
        Named in the diagnostics.
    text : str
        The text when it is opened.
    version : int or None
        The editor's number for this state of the text.
    """

    def __init__(self, path: str, text: str, version: int | None = None) -> None:
        self.path = path
        self.text = text
        self.version = version
        # Until it has been measured, what a check costs is guessed from the length.
        self.cost = 2e-6 * len(text)
        self._elapsed = 0.0
        self._review: Review | None = None

    @cached_property
    def lines(self) -> list[str]:
        """The lines of the text, without their ends."""
        return split_lines(self.text)

    def replace(self, text: str, version: int | None = None) -> None:
        """Take a new text."""
        self.version = version
        if text == self.text:
            return
        self.text = text
        self._review = None
        self._forget()

    def _forget(self) -> None:
        """Drop what was found in the text before."""
        for name in list(self.__dict__):
            if isinstance(getattr(type(self), name, None), cached_property):
                del self.__dict__[name]

    def change(self, where: Range | None, new: str, encoding: str = UTF16) -> None:
        """Take one change as an editor sends it."""
        self.replace(change_text(self.text, where, new, encoding), self.version)

    def review(self) -> Review:
        """Return the findings for the text as it is now: those of ``fuzzyarm check``."""
        if self._review is None:
            start = time.perf_counter()
            self._review = self._check()
            # The lesser of two: a single hiccup of the machine makes no file slow.
            elapsed = time.perf_counter() - start
            self.cost, self._elapsed = min(elapsed, self._elapsed or self.cost), elapsed
        return self._review

    def adopt(self, other: Self) -> bool:
        """Take over what `other` found, if it is about the same text; return whether it is."""
        if other.text != self.text:
            return False
        self._review, self.cost = other.review(), other.cost
        return True

    @abstractmethod
    def _check(self) -> Review: ...

    @abstractmethod
    def formatted(self) -> str | None:
        """Return the text in canonical form; None if it has mistakes, or something to lose."""

    @abstractmethod
    def complete(self, line: int, column: int) -> list[Candidate]:
        """Return what could stand at a place."""

    @abstractmethod
    def hover(self, line: int, column: int) -> Hover | None:
        """Return what stands at a place, explained."""

    @abstractmethod
    def name_at(self, line: int, column: int) -> tuple[str, Span] | None:
        """Return the name that a cursor touches, and where it stands."""

    @abstractmethod
    def occurrences(self, line: int, column: int) -> list[tuple[Span, bool]]:
        """Return every place of the name at a place, and whether it is declared there."""

    @abstractmethod
    def rename(self, line: int, column: int, new_name: str) -> list[Edit]:
        """Return the edits that give the name at a place another one; or raise RenameError."""

    @abstractmethod
    def symbols(self) -> list[Symbol]:
        """Return the outline."""

    @abstractmethod
    def folds(self) -> list[Fold]:
        """Return what can be folded away."""

    @abstractmethod
    def coloured(self) -> list[Coloured]:
        """Return every word that has a colour."""

    def fixes(self, finding: Diagnostic) -> list[Fix]:
        """Return the repairs of a finding."""
        return fixes(finding, self.text)
