"""Numbers as text without loss, and the short forms of lists of numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction

_MOST_DECIMALS = 6


def number(x: float) -> str:
    """Return the shortest text that reads back as exactly `x`; whole numbers without a point."""
    if x.is_integer() and abs(x) < 1e15:
        return "-0" if x == 0 and math.copysign(1.0, x) < 0 else str(int(x))
    return repr(x)


def column_of_numbers(values: Sequence[float]) -> list[str]:
    """Return texts with equally many decimals where few are enough, else the shortest ones."""
    texts = [number(x) for x in values]
    if any("e" in text for text in texts):
        return texts
    decimals = max((len(text.partition(".")[2]) for text in texts), default=0)
    if decimals > _MOST_DECIMALS:
        return texts
    return [f"{x:.{decimals}f}" for x in values]


def stepped(low: float, high: float, step: float) -> tuple[float, ...] | None:
    """Return low, low + step, …, high; None if the step does not lead to `high`.

    The numbers are taken as the decimals they are written as, so that step 0.1 gives 0.3
    and not 0.30000000000000004.
    """
    start, width = Fraction(repr(low)), Fraction(repr(step))
    count = (Fraction(repr(high)) - start) / width
    if count.denominator != 1 or count < 0:
        return None
    return tuple(float(start + i * width) for i in range(int(count) + 1))


def evenly(low: float, high: float, count: int) -> tuple[float, ...]:
    """Return `count` even levels from `low` to `high`, each the float nearest to its decimal."""
    if count == 1:
        return (0.5 * low + 0.5 * high,)
    start = Fraction(repr(float(low)))
    width = (Fraction(repr(float(high))) - start) / (count - 1)
    return tuple(float(start + i * width) for i in range(count))


def mirror(numbers: Iterable[float]) -> tuple[float, ...]:
    """Return the numbers and their negatives, in order, zero once."""
    positive = [abs(x) for x in numbers]
    return tuple(sorted({*positive, *(-x + 0.0 for x in positive)}))


def short_levels(levels: Sequence[float]) -> str:
    """Return ``low .. high step s`` where that means exactly `levels`, else all of them."""
    if len(levels) > 2:
        width = Fraction(repr(levels[-1])) - Fraction(repr(levels[0]))
        step = float(width / (len(levels) - 1))
        if step > 0 and stepped(levels[0], levels[-1], step) == tuple(levels):
            return f"{number(levels[0])} .. {number(levels[-1])} step {number(step)}"
    return " ".join(number(x) for x in levels)


def short_bins(bins: Sequence[float]) -> str:
    """Return the positive half and ``mirrored`` where `bins` are symmetric, else all of them."""
    half = [x for x in bins if x >= 0]
    if len(bins) > 1 and mirror(half) == tuple(bins):
        return " ".join(number(x) for x in half) + " mirrored"
    return " ".join(number(x) for x in bins)
