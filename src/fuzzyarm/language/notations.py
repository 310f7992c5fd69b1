"""Foreign notations: a record for each that can be corrected, and for each that gets advice."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

from fuzzyarm.base.diagnostic import Span

NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
NAME = r"(?:'[^']*'|[^\W\d]\w*(?:-[^\W\d]\w*)*)"
ANY_CASE = re.IGNORECASE

Written = str | Callable[[re.Match[str]], str]


class Slip(NamedTuple):
    """A foreign notation: its message, its pattern and its replacement.

    `words` are the statements in which it is looked for: of a rule base ``row`` and ``header`` for
    the lines of a grid, of a controller ``signal``, and an empty word for a line that begins like
    none; without them, all lines are. It is looked for outside strings and comments, or, as
    `whole`, in all of the line.
    """

    message: str
    pattern: re.Pattern[str]
    written: Written
    words: tuple[str, ...] = ()
    whole: bool = False


class Advice(NamedTuple):
    """The message about a line that cannot be corrected automatically, and a hint.

    `message` and `hint` may ask the match; the finding stands at its group ``at``, or at all of it.
    """

    pattern: re.Pattern[str]
    message: Written
    hint: Written
    words: tuple[str, ...] = ()

    def on(self, line: str, number: int) -> tuple[str, str, Span] | None:
        """Return message, hint and place for a line, None where it is another one."""
        match = self.pattern.search(line)
        if match is None:
            return None
        group = "at" if "at" in self.pattern.groupindex else 0
        span = Span(number, match.start(group) + 1, number, match.end(group) + 1)
        message, hint = (
            text if isinstance(text, str) else text(match) for text in (self.message, self.hint)
        )
        return message, hint, span


def small(match: re.Match[str]) -> str:
    """Write what was found in small letters."""
    return match.group().lower()


CAPITALS = "words of the language are written in small letters"
