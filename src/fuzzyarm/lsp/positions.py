"""Between the protocol's positions, which count code units from 0, and places in a text.

The protocol ends lines at CR LF, LF and CR only, as the language does.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

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
