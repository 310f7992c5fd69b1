"""Changes of a text from the page's editor, and the merge of two texts.

A change set of CodeMirror is a list over the old text: a number keeps so many UTF-16 units, ``[n]``
removes them, ``[n, line, line, …]`` replaces them by lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from difflib import SequenceMatcher
from typing import Any

from fuzzyarm.base.errors import FuzzyarmError

Changes = list[int | list[Any]]


class ChangeError(FuzzyarmError, ValueError):
    """Changes that do not fit the text."""


def applied(text: str, changes: Any) -> str:
    """Return a text after a change set."""
    units = text.encode("utf-16-le", "surrogatepass")
    parts: list[bytes] = []
    at = 0
    if not isinstance(changes, list):
        raise ChangeError("a change set is a list")
    for section in changes:
        count, new = _section(section)
        if isinstance(section, int):
            parts.append(units[2 * at : 2 * (at + count)])
        elif new is not None:
            parts.append(new.encode("utf-16-le", "surrogatepass"))
        at += count
    if 2 * at != len(units):
        raise ChangeError("the change set is that of another text")
    return b"".join(parts).decode("utf-16-le", "surrogatepass")


def _section(section: Any) -> tuple[int, str | None]:
    """Return the length of a section in the old text, and its replacement."""
    if isinstance(section, int) and section >= 0:
        return section, None
    if isinstance(section, list) and section and isinstance(section[0], int) and section[0] >= 0:
        lines = section[1:]
        if all(isinstance(line, str) for line in lines):
            return section[0], "\n".join(lines) if lines else None
    raise ChangeError("a part of the change set is not understood")


def _units(text: str) -> int:
    return len(text.encode("utf-16-le", "surrogatepass")) // 2


def difference(old: str, new: str) -> Changes:
    """Return the change set from one text to another, between their common ends."""
    start, end = _common_ends(old, new)
    removed, added = old[start : len(old) - end], new[start : len(new) - end]
    changes: Changes = [_units(old[:start])] if start else []
    if removed or added:
        changes.append([_units(removed), *(added.split("\n") if added else [])])
    return [*changes, _units(old[len(old) - end :])] if end else changes


def merged(base: str, mine: str, theirs: str) -> str | None:
    """Return a text with the changes of both, line by line; None if they touch."""
    if mine in (base, theirs):
        return theirs
    if theirs == base:
        return mine
    lines = base.splitlines(keepends=True)
    edits = [*_edits(lines, mine), *_edits(lines, theirs)]
    edits.sort(key=lambda edit: edit[:2])
    parts: list[str] = []
    at = 0
    for number, (start, end, new) in enumerate(edits):
        if number and edits[number - 1] == (start, end, new):
            continue  # both made the same change
        if start < at or (number and start == at and edits[number - 1][1] == start):
            return None
        parts += [*lines[at:start], *new]
        at = end
    return "".join([*parts, *lines[at:]])


def _edits(base: Sequence[str], text: str) -> list[tuple[int, int, tuple[str, ...]]]:
    lines = text.splitlines(keepends=True)
    # A comparison takes quadratic time, and most of a long text has not changed.
    start, end = _common_ends(base, lines)
    old, new = base[start : len(base) - end], lines[start : len(lines) - end]
    matcher = SequenceMatcher(None, old, new, autojunk=False)
    return [
        (start + i1, start + i2, tuple(new[j1:j2]))
        for tag, i1, i2, j1, j2 in matcher.get_opcodes()
        if tag != "equal"
    ]


def _common_ends(old: Sequence[str], new: Sequence[str]) -> tuple[int, int]:
    """Return the lengths of the common start and of the common end of the rest."""
    most = min(len(old), len(new))
    start = 0
    while start < most and old[start] == new[start]:
        start += 1
    end = 0
    while end < most - start and old[-1 - end] == new[-1 - end]:
        end += 1
    return start, end
