"""Labels that do not run into each other: the size of a text, places in a row, thinning.

Places are found before anything is drawn, from the sizes of the texts, so that a figure can be
made as large as its labels need. Lengths are inches.
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
"""Distance of two lines of text, in sizes of the letters."""

GAP = 0.05
"""Room between two labels of a row."""


@functools.lru_cache(4096)
def text_width(text: str, size: float) -> float:
    """Return how wide a text is whose letters have `size` points; of several lines the widest."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(size=size)
    lines = map(printable, text.split("\n"))
    widths = [text_to_path.get_text_width_height_descent(x, font, False)[0] for x in lines]
    return float(max(widths)) / 72.0


def text_height(text: str, size: float) -> float:
    """Return how high a text is."""
    return LINE * size / 72.0 * (text.count("\n") + 1)


def wrapped(text: str, size: float, room: float, most: int = 4) -> str:
    """Break a text into lines no wider than `room`, as even as can be.

    What goes beyond `most` lines is cut off.
    """
    width = text_width(text, size)
    letters = len(text) if width <= room else max(8, int(1.15 * room / width * len(text)))
    while True:
        lines = textwrap.wrap(text, max(1, letters), max_lines=most, placeholder=" …")
        if letters <= 8 or all(text_width(line, size) <= room for line in lines):
            return "\n".join(_even(text, lines, size))
        letters -= 1


def _even(text: str, lines: list[str], size: float) -> list[str]:
    """Return as many lines of a text, the widest as narrow as can be; `lines` are full ones."""
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
    """Return a text no wider than `room`; of a longer one both ends stay."""
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
    """Return middles of labels in a row, as near as can be to where they are wanted."""
    if not positions:
        return []
    if sum(widths) > high - low:
        return None
    # Behind its neighbours every label would stand at `offset`: what remains must not fall, and
    # the nearest such sequence is that of the means of pooled neighbours.
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
    """Return at most `most` of some items, evenly chosen, the first and the last among them."""
    if len(items) <= most:
        return list(items)
    if most < 2:
        return list(items[:most])
    indices = sorted({round(k * (len(items) - 1) / (most - 1)) for k in range(most)})
    return [items[k] for k in indices]


def columns_that_fit(texts: Sequence[str], size: float, room: float) -> int:
    """Return in how many columns the lines of a key fit side by side, five at most."""
    widest = max((text_width(text, size) for text in texts), default=0.0)
    beside = 4.2 * size / 72.0  # the stroke, and the room around it
    return max(1, min(5, len(texts), int(room / (widest + beside))))


def thin_ticks(axis: Any, texts: Sequence[str], room: float, size: float) -> None:
    """Name the places 0, 1, … of an axis, every second or third where not all names fit."""
    if axis.axis_name == "x":
        room_per_label = max(text_width(text, size) for text in texts) + 2.0 * GAP
    else:
        room_per_label = LINE * size / 72.0
    step = max(1, math.ceil(room_per_label * len(texts) / room))
    places = range(0, len(texts), step)
    axis.set_ticks(list(places), [texts[k] for k in places])
