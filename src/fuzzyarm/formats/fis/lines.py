"""FIS text: sections in brackets, ``key=value`` lines, rules of numbers."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from fuzzyarm.formats.imported import Findings, Word
from fuzzyarm.rulebase.diagnostic import NOWHERE, Span

_SECTION = re.compile(r"\[\s*(system|input|output|rules)\s*(\d*)\s*\]\s*\Z", re.IGNORECASE)


@dataclass(slots=True)
class Section:
    """One section of a file.

    Attributes
    ----------
    kind : str
        ``system``, ``input``, ``output`` or ``rules``.
    number : int
        The number in ``[Input2]``; 0 where there is none.
    span : Span
        The header.
    lines : list of Word
        What stands in it, without comments and space around.
    """

    kind: str
    number: int = 0
    span: Span = NOWHERE
    lines: list[Word] = field(default_factory=list)


def fis_sections(text: str, findings: Findings) -> list[Section]:
    """Split a text into sections; report lines outside of any."""
    sections: list[Section] = []
    for number, raw in enumerate(text.split("\n"), 1):
        content = _without_comment(raw)
        stripped = content.strip()
        if not stripped:
            continue
        start = len(content) - len(content.lstrip()) + 1
        word = Word(stripped, Span(number, start, number, start + len(stripped)))
        match = _SECTION.match(stripped) if len(stripped) < 100 else None
        if match:
            digits = match.group(2)[:6]
            sections.append(Section(match.group(1).lower(), int(digits or 0), word.span))
        elif sections:
            sections[-1].lines.append(word)
        else:
            message = f"'{stripped[:40]}' stands before any section"
            findings.error("syntax", message, word)
    return sections


def _without_comment(raw: str) -> str:
    """Cut a comment: ``%`` or ``#`` first on a line, or after a space outside quotes; ``//``."""
    if raw.lstrip()[:1] in ("%", "#"):
        return ""
    if "%" not in raw and "#" not in raw and "//" not in raw:
        return raw
    quoted = False
    for index, letter in enumerate(raw):
        if letter == "'":
            quoted = not quoted
        elif not quoted and (letter in "%#" or raw.startswith("//", index)):
            return raw[:index]
    return raw


def key_and_value(line: Word) -> tuple[Word, Word] | None:
    """Split ``key = value``; None where there is no equals sign."""
    key, equals, value = line.text.partition("=")
    if not equals:
        return None
    span = line.span
    name = key.rstrip()
    at = span.column + len(key) + 1 + len(value) - len(value.lstrip())
    return (
        Word(name, Span(span.line, span.column, span.line, span.column + len(name))),
        Word(value.strip(), Span(span.line, at, span.line, span.end_column)),
    )


def unquoted(word: Word) -> Word:
    """Return the text between quotes, where it stands in quotes."""
    text = word.text
    if len(text) >= 2 and text[0] == text[-1] and text[0] in "'\"":
        return Word(text[1:-1], word.span)
    return word


_NUMBER = re.compile(r"[^\s,;\[\]]+")


def bracketed(value: Word) -> list[Word]:
    """Return the words between ``[`` and ``]``, split at space, commas and semicolons."""
    span = value.span
    return [
        Word(m.group(), Span(span.line, span.column + m.start(), span.line, span.column + m.end()))
        for m in _NUMBER.finditer(value.text)
    ]


_MEMBERSHIP = re.compile(
    r"\s*(?:'(?P<quoted>[^']*)'|(?P<bare>[^:']*?))\s*:\s*'?(?P<kind>[\w.]*)'?\s*,\s*"
    r"(?P<rest>.*?)\s*\Z",
    re.DOTALL,
)


def membership_parts(value: Word) -> tuple[Word, Word, Word] | None:
    """Split ``'name':'kind',[numbers]``; None where it does not look like that."""
    match = _MEMBERSHIP.match(value.text)
    if match is None:
        return None
    span = value.span

    def word(group: str) -> Word:
        start, end = match.span(group)
        return Word(
            match.group(group),
            Span(span.line, span.column + start, span.line, span.column + end),
        )

    name = word("quoted") if match.group("quoted") is not None else word("bare")
    return name, word("kind"), word("rest")
