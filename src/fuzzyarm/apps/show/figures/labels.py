"""Labels without overlaps: text sizes, positions in a row, thinning.

Positions are computed from text sizes before drawing, so that a figure can be as large as its
labels need. Lengths are in inches.
"""

from __future__ import annotations

import functools
import math
import textwrap
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, TypeVar

from fuzzyarm.base.names import printable

_Item = TypeVar("_Item")

LINE = 1.3
"""Line spacing in font sizes."""

GAP = 0.05
"""Distance between two labels of a row."""


@functools.lru_cache(4096)
def text_width(text: str, size: float) -> float:
    """Return the width of a text of `size` points; of several lines the widest."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(size=size)
    lines = map(printable, text.split("\n"))
    widths = [text_to_path.get_text_width_height_descent(x, font, False)[0] for x in lines]
    return float(max(widths)) / 72.0


def text_height(text: str, size: float) -> float:
    """Return the height of a text."""
    return LINE * size / 72.0 * (text.count("\n") + 1)


def wrapped(text: str, size: float, room: float, most: int = 4) -> str:
    """Wrap a text into lines no wider than `room`, as evenly as possible.

    Text beyond `most` lines is cut off.
    """
    width = text_width(text, size)
    letters = len(text) if width <= room else max(8, int(1.15 * room / width * len(text)))
    while True:
        lines = textwrap.wrap(text, max(1, letters), max_lines=most, placeholder=" …")
        if letters <= 8 or all(text_width(line, size) <= room for line in lines):
            return "\n".join(_even(text, lines, size))
        letters -= 1


def _even(text: str, lines: list[str], size: float) -> list[str]:
    """Return the same number of lines, with the widest as narrow as possible."""
    if len(lines) < 2 or lines[-1].endswith(" …"):
        return lines

    def widest(texts: list[str]) -> float:
        return max(text_width(line, size) for line in texts)

    longest = max(map(len, text.split()))
    tries = (textwrap.wrap(text, n) for n in range(longest, max(map(len, lines))))
    return min(
        [lines, *(candidate for candidate in tries if len(candidate) == len(lines))], key=widest
    )


def shortened(text: str, size: float, room: float) -> str:
    """Return a text no wider than `room`, shortened in the middle."""
    if text_width(text, size) <= room:
        return text
    for length in range(len(text) - 1, 1, -1):
        short = f"{text[: (length + 1) // 2]}…{text[len(text) - length // 2 :]}"
        if text_width(short, size) <= room:
            return short
    return "…"


def spread(
    positions: Sequence[float], widths: Sequence[float], low: float, high: float
) -> list[float] | None:
    """Return the centres of labels in a row, as near as possible to the desired ones."""
    if not positions:
        return []
    if sum(widths) > high - low:
        return None
    # Touching labels would be at `offset`; the remaining displacements must not decrease, and the
    # nearest monotone sequence has the means of pooled neighbours (isotonic regression).
    offsets = [0.0]
    for before, width in pairwise(widths):
        offsets.append(offsets[-1] + 0.5 * (before + width))
    pools: list[tuple[float, int]] = []
    for place, offset in zip(positions, offsets, strict=True):
        mean, count = place - offset, 1
        while pools and pools[-1][0] > mean:
            other, size = pools.pop()
            mean, count = (mean * count + other * size) / (count + size), count + size
        pools.append((mean, count))
    means = [mean for mean, count in pools for _ in range(count)]
    least = low + 0.5 * widths[0]
    most = high - 0.5 * widths[-1] - offsets[-1]
    return [min(most, max(least, x)) + y for x, y in zip(means, offsets, strict=True)]


def thinned(items: Sequence[_Item], most: int) -> list[_Item]:
    """Return at most `most` items, evenly spaced, with the first and the last."""
    if len(items) <= most:
        return list(items)
    if most < 2:
        return list(items[:most])
    indices = sorted({round(k * (len(items) - 1) / (most - 1)) for k in range(most)})
    return [items[k] for k in indices]


def columns_that_fit(texts: Sequence[str], size: float, room: float) -> int:
    """Return the number of columns of a key that fit side by side, at most five."""
    widest = max((text_width(text, size) for text in texts), default=0.0)
    beside = 4.2 * size / 72.0  # the stroke and its margins
    return max(1, min(5, len(texts), int(room / (widest + beside))))


def thin_ticks(axis: Any, texts: Sequence[str], room: float, size: float) -> None:
    """Label the positions 0, 1, … of an axis, every second or third if there is no room."""
    if axis.axis_name == "x":
        room_per_label = max(text_width(text, size) for text in texts) + 2.0 * GAP
    else:
        room_per_label = LINE * size / 72.0
    step = max(1, math.ceil(room_per_label * len(texts) / room))
    places = range(0, len(texts), step)
    axis.set_ticks(list(places), [texts[k] for k in places])
