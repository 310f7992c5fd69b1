"""Names as text: quoting, printable forms, and suggestions for misspelt names."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from functools import lru_cache
from itertools import islice

_LENGTH_DIFFERENCE = 4
"""Largest difference in length of a name and its suggestions."""

_SUGGESTIONS = 4

_MOST = 300
"""Limits the time for suggestions in a file with a thousand terms and a thousand mistakes."""


def nearest(word: str, choices: Iterable[str]) -> str | None:
    """Return the most likely intended choice, or None.

    A difference in case alone comes first, then few edits relative to the length.
    """
    near = several_nearest(word, choices, 1)
    return near[0] if near else None


def several_nearest(word: str, choices: Iterable[str], most: int = 3) -> list[str]:
    """Return the `most` likeliest meanings of `word` among `choices`, the likeliest first."""
    options, key = list(choices), word.casefold()
    same = [option for option in options if option.casefold() == key]
    if same or len(word) > 100:
        return same[:1]
    begun = [option for option in options if len(key) > 3 and option.casefold().startswith(key)]
    similar = (option for option in options if abs(len(option) - len(word)) <= _LENGTH_DIFFERENCE)
    closest = _closest(key, tuple(islice(similar, _MOST)))
    return list(dict.fromkeys([*sorted(begun, key=len), *closest]))[:most]


@lru_cache(maxsize=2048)
def _closest(key: str, options: tuple[str, ...]) -> list[str]:
    # Cached: an editor checks the same mistake at every key stroke until it is corrected.
    import difflib

    cutoff = 0.5 if len(key) <= 3 else 0.6
    spellings = {option.casefold(): option for option in reversed(options)}
    matches = difflib.get_close_matches(key, spellings, n=_SUGGESTIONS, cutoff=cutoff)
    return [spellings[match] for match in matches if _is_slip(key, match)]


def _is_slip(word: str, meant: str) -> bool:
    """Whether `word` is a misspelt `meant`: at most one edit for each three letters."""
    return _edits(word, meant) <= max(1, (max(len(word), len(meant)) + 1) // 3)


def _edits(one: str, other: str) -> int:
    """Return the edit distance: insertions, deletions, replacements, swaps of neighbours."""
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, a in enumerate(one):
        older, before, row = before, row, [i + 1]
        for j, b in enumerate(other):
            cost = min(before[j + 1] + 1, row[j] + 1, before[j] + (a != b))
            if i and j and a == other[j - 1] and one[i - 1] == b:
                cost = min(cost, older[j - 1] + 1)
            row.append(cost)
    return row[-1]


def did_you_mean(*names: str) -> str:
    """Return the question for one of several names."""
    quoted = [f"'{name}'" for name in names]
    return f"did you mean {' or '.join(quoted)}?"


def near_hint(word: str, choices: Iterable[str]) -> tuple[str, str | None]:
    """Return a hint in words and the replacement text; empty and None if nothing is near.

    Choices with names of other programs (`foreign`) are matched by those first.
    """
    word = str(word)  # a call from Python may pass any object
    spelling = getattr(choices, "foreign", {}).get(word.casefold())
    if spelling is not None:
        ours, order = spelling
        if order:  # the parameters have another order: no safe replacement
            return f"'{word}' of other programs is '{ours}' here: {ours} {order}", None
        return f"'{word}' of other programs is '{ours}' here", ours
    near = nearest(word, choices)
    return ("", None) if near is None else (did_you_mean(near), near)


def quote(text: str, mark: str) -> str:
    """Return `text` between two `mark` characters, with unprintable characters escaped."""
    out = [mark]
    for character in text:
        if character in (mark, "\\"):
            out.append("\\" + character)
        elif character.isprintable():
            out.append(character)
        else:
            code = ord(character)
            out.append(f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}")
    return "".join([*out, mark])


def printable(text: str) -> str:
    """Return untrusted `text` made harmless for a terminal or a figure.

    Controls, line ends and direction marks become U+FFFD, tabs and other spaces become spaces.
    """
    if text.isprintable():
        return text
    from unicodedata import category

    text = text.replace("\t", "    ")
    return "".join(c if c.isprintable() else " " if category(c) == "Zs" else "\ufffd" for c in text)


def shortened(text: str, most: int = 60) -> str:
    """Return `text` on one line, its middle elided beyond `most` characters."""
    text = printable(text)
    if len(text) <= most:
        return text
    return f"{text[: most - most // 3 - 3]} … {text[len(text) - most // 3 :]}"


_PLAIN_NAME = re.compile(r"[^\W\d]\w*(?:-[^\W\d]\w*)*\Z")


def is_plain_name(text: str) -> bool:
    """Whether `text` is a valid name without quotes."""
    return _PLAIN_NAME.match(text) is not None


def typed(path: str | os.PathLike[str]) -> str:
    """Return a path as typed on a command line."""
    text = os.fspath(path)
    if os.name == "nt":
        return f'"{text}"' if re.search(r"[ &()^,;=]", text) else text
    import shlex

    return shlex.quote(text)
