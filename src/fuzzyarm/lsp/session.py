"""One open file: its text, what reading it found, and the findings of its check."""

from __future__ import annotations

import time

from fuzzyarm.api import Review, check_parsed, failed_expectations
from fuzzyarm.lsp.positions import UTF16, Range, change_text
from fuzzyarm.rulebase import Diagnostic, RuleBase, Span
from fuzzyarm.rulebase.queries import Reading, read
from fuzzyarm.rulebase.syntax.memory import ParseMemory
from fuzzyarm.rulebase.syntax.nodes import GridNode
from fuzzyarm.rulebase.syntax.tokens import split_lines

SLOW = 0.2
"""A file whose check takes longer, in seconds, is checked beside the answering of questions."""


class Session:
    """An open rule base or table.

    Parameters
    ----------
    path : str
        Named in the diagnostics; ``.lut`` makes it a table.
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
        self._judged: tuple[RuleBase, list[Span], list[Diagnostic]] | None = None
        self._elapsed = 0.0
        self._memory = ParseMemory()
        self._reading: Reading | None = None
        self._last_reading: Reading | None = None
        self._review: Review | None = None

    @property
    def is_table(self) -> bool:
        """Whether the file is a lookup table."""
        return self.path.lower().endswith(".lut")

    @property
    def lines(self) -> list[str]:
        """The lines of the text, without their ends."""
        return split_lines(self.text)

    def replace(self, text: str, version: int | None = None) -> None:
        """Take a new text."""
        self.version = version
        if text == self.text:
            return
        self.text = text
        self._reading = self._review = None

    def change(self, where: Range | None, new: str, encoding: str = UTF16) -> None:
        """Take one change as an editor sends it."""
        self.replace(change_text(self.text, where, new, encoding), self.version)

    @property
    def reading(self) -> Reading:
        """The text as it is now, read."""
        if self._reading is None:
            self._reading = read(self.text, self.path, self._memory)
            self._last_reading = self._reading
        return self._reading

    @property
    def quick_reading(self) -> Reading:
        """The words of the text as it is now; of a large file with the meaning it had last.

        Good for completion: the names are known, and a key stroke rarely changes them.
        """
        if self._reading is not None or self._last_reading is None or self.cost < SLOW:
            return self.reading
        lines = self._memory.tokenize(self.text, [])
        return Reading(self.text, self._last_reading.parsed, tuple(lines))

    @property
    def grids(self) -> list[GridNode]:
        """The rule grids of the file."""
        nodes = (statement.node for statement in self.reading.document.statements)
        return [node for node in nodes if isinstance(node, GridNode)]

    def review(self) -> Review:
        """Return the findings for the text as it is now: those of ``fuzzyarm check``."""
        if self._review is None:
            start = time.perf_counter()
            self._review = self._check()
            # The lesser of two: a single hiccup of the machine makes no file slow.
            elapsed = time.perf_counter() - start
            self.cost, self._elapsed = min(elapsed, self._elapsed or self.cost), elapsed
        return self._review

    def _check(self) -> Review:
        if self.is_table:
            from fuzzyarm.lut import parse_lut

            return Review(self.text, tuple(parse_lut(self.text, self.path).diagnostics))
        parsed = self.reading.parsed
        return check_parsed(parsed, self.text, self.path, self._failed(parsed.rulebase))

    def _failed(self, rulebase: RuleBase | None) -> list[Diagnostic] | None:
        """Return the failed expectations; those found last, if nothing has changed in meaning."""
        if rulebase is None or not rulebase.expectations:
            return None
        known, spans = self._judged, [e.span for e in rulebase.expectations]
        if known is None or known[1] != spans or known[0] != rulebase:
            known = rulebase, spans, failed_expectations(rulebase)
        self._judged = known
        return known[2]

    def adopt(self, other: Session) -> bool:
        """Take over what `other` found, if it is about the same text; return whether it is."""
        if other.text != self.text:
            return False
        self._reading = self._last_reading = other.reading if not self.is_table else None
        self._review, self.cost = other.review(), other.cost
        return True
