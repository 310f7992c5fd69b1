"""Curves of straight lines as a row of blocks."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

Curve = Sequence[tuple[float, float]]

_BLOCKS = " ▁▂▃▄▅▆▇█"


def block(height: float) -> str:
    """Return the block for a height of 0 to 1; anything above one hundredth shows."""
    if height <= 0.01:
        return " "
    return _BLOCKS[max(1, min(8, round(8 * height)))]


def curve_blocks(curve: Curve, low: float, high: float, width: int) -> str:
    """Return the largest height of `curve` within each of `width` equal stretches."""
    step = (high - low) / (width - 1)
    edges = [low + (i - 0.5) * step for i in range(width + 1)]
    return "".join(block(_largest(curve, a, b)) for a, b in pairwise(edges))


def marker(value: float, low: float, high: float, width: int, mark: str = "^") -> str:
    """Return a line with `mark` where `value` lies between `low` and `high`."""
    place = round((value - low) / (high - low) * (width - 1))
    return " " * max(0, min(width - 1, place)) + mark


def height_at(curve: Curve, x: float) -> float:
    """Return the height of `curve` at `x`: the larger at a vertical edge, 0 outside."""
    heights = [0.0]
    for (x0, y0), (x1, y1) in pairwise(curve):
        if x0 <= x <= x1:
            heights += [y0, y1] if x1 == x0 else [y0 + (y1 - y0) * (x - x0) / (x1 - x0)]
    return max(heights)


def _largest(curve: Curve, start: float, end: float) -> float:
    # The middle decides, so that a falling edge looks the same as a rising one;
    # corners in the stretch are added so that no peak is missed.
    inside = [y for x, y in curve if start <= x < end]
    return max([height_at(curve, 0.5 * (start + end)), *inside])
