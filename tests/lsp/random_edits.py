"""Random edits as an editor sends them, with positions that may lie anywhere."""

from __future__ import annotations

import random
import re

SMALL = """\
rulebase small "a few rules"
input x -1 .. 1
input 𝜃 -2 .. 2  # two units wide
output f 0 .. 1
terms x, 𝜃: triangles N Z P
terms f: triangles LOW HIGH
rules f
  x \\ 𝜃  N     Z     P
  N      LOW   LOW   HIGH
  Z      LOW   HIGH  LOW
  P      HIGH  LOW   LOW
rule if x is very N and 𝜃 is not Z then f is HIGH with 0.5
expect x = 0, 𝜃 = 0 -> f > 0.5
"""

PIECES = (
    "", "", "", " ", "\n", "\r\n", "\r", "  ", "x", "N", "𝜃", "ß", "'", '"', "\\", "#", ".",
    "..", ":", ",", "(", ")", "-", "*", "1", "0.5", "inf", "\u2028", "\x0c", "\x00", "is ",
    "rule ", "rules f\n", "if x is N then f is LOW\n", "term x Q: triangle 0 1 2\n", "very ",
    "terms ", "input y 0 .. 1\n", "expect ", "lookup\n  levels 0 1\n", "block b\n", "and ",
    "\n  N LOW LOW LOW\n", "# allow jump", "linear 2*x", "with 2", "inference ",
)  # fmt: skip

_LINE_END = re.compile("\r\n|\n|\r")

Where = tuple[int, int, int, int]


def random_edit(text: str, chance: random.Random) -> tuple[Where | None, str]:
    """Return a change of the protocol: a range in UTF-16 units, sometimes beyond the text."""
    if len(text) > 1200 or chance.random() < 0.003:
        return None, SMALL
    lines = _LINE_END.split(text)
    line = chance.randrange(len(lines) + 1)
    length = len(lines[line].encode("utf-16-le")) // 2 if line < len(lines) else 3
    start = chance.randrange(length + 2)
    end_line, end = line, start + chance.choice((0, 0, 0, 1, 1, 2, 6))
    if chance.random() < 0.05:
        end_line, end = line + chance.randrange(3), chance.randrange(8)
    if (end_line, end) < (line, start):
        end = start
    return (line, start, end_line, end), chance.choice(PIECES)


def changed(text: str, where: Where | None, new: str) -> str:
    """Return `text` after a change, worked out on UTF-16 code units: an oracle."""
    if where is None:
        return new
    units = text.encode("utf-16-le")
    starts, stops = [0], []
    for match in _LINE_END.finditer(text):
        stops.append(len(text[: match.start()].encode("utf-16-le")))
        starts.append(len(text[: match.end()].encode("utf-16-le")))
    stops.append(len(units))

    def offset(line: int, character: int) -> int:
        if line >= len(starts):
            return len(units)
        place = min(starts[line] + 2 * character, stops[line])
        # Never cut a pair in two: step back to the character that the position lies in.
        inside = starts[line] < place < len(units) and 0xDC <= units[place + 1] < 0xE0
        return place - 2 if inside else place

    start = offset(*where[:2])
    end = max(start, offset(*where[2:]))
    return (units[:start] + new.encode("utf-16-le") + units[end:]).decode("utf-16-le")
