"""FLL text, line by line: ``key: value`` with ``#`` comments."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.rulebase.diagnostic import Span

_WORD = re.compile(r"[(),]|[^\s(),]+")
_PLAIN_WORD = re.compile(r"\S+")


@dataclass(frozen=True, slots=True)
class Line:
    """One setting.

    Attributes
    ----------
    key : Word
        Left of the colon.
    value : Word
        Right of it, without space around; empty text where there is nothing.
    """

    key: Word
    value: Word

    def words(self, *, rule: bool = False) -> list[Word]:
        """Return the words of the value; in a rule parentheses are words of their own."""
        start = self.value.span.column
        number = self.value.span.line
        pattern = _WORD if rule else _PLAIN_WORD
        return [
            Word(m.group(), Span(number, start + m.start(), number, start + m.end()))
            for m in pattern.finditer(self.value.text)
        ]


def fll_lines(text: str, findings: Findings) -> Iterator[Line]:
    """Yield the settings of a text; report lines that are none."""
    for number, raw in enumerate(text.split("\n"), 1):
        content = raw.split("#", 1)[0].rstrip()
        if not content.strip():
            continue
        start = len(content) - len(content.lstrip())
        key, colon, value = content.partition(":")
        if not colon:
            word = Word(content.strip(), Span(number, start + 1, number, len(content) + 1))
            findings.error("syntax", f"'{word.text[:40]}' is no 'key: value'", word)
            continue
        gap = len(value) - len(value.lstrip())
        at = len(key) + 1 + gap
        name = key.strip()
        yield Line(
            Word(name, Span(number, start + 1, number, start + 1 + len(name))),
            Word(value.strip(), Span(number, at + 1, number, len(content) + 1)),
        )
