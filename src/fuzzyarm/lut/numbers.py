"""Numbers as text without loss, and the short forms of lists of numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fuzzyarm.rulebase.meaning.lookup import even_levels
from fuzzyarm.rulebase.printing.words import number_text as number

__all__ = ["column_of_numbers", "evenly", "mirror", "number", "short_bins", "short_levels"]

_MOST_DECIMALS = 6
_SHORT = 8


def column_of_numbers(values: Sequence[float]) -> list[str]:
    """Return texts with equally many decimals where few are enough, else the shortest ones."""
    texts = [number(x) for x in values]
    if any("e" in text for text in texts):
        return texts
    decimals = max((len(text.partition(".")[2]) for text in texts), default=0)
    if decimals > _MOST_DECIMALS:
        return texts
    return [f"{x:.{decimals}f}" for x in values]


def evenly(low: float, high: float, count: int) -> tuple[float, ...]:
    """Return `count` even levels from `low` to `high`, as the language means them."""
    if count == 1:
        return (0.5 * low + 0.5 * high,)
    return even_levels(low, high, count - 1)


def mirror(numbers: Iterable[float]) -> tuple[float, ...]:
    """Return the numbers and their negatives, in order, zero once."""
    positive = [abs(x) for x in numbers]
    return tuple(sorted({*positive, *(-x + 0.0 for x in positive)}))


def short_levels(levels: Sequence[float]) -> str:
    """Return the short form with ``step`` or ``count`` where it means exactly `levels`."""
    count = len(levels)
    if count > 2 and evenly(levels[0], levels[-1], count) == tuple(levels):
        ends = f"{number(levels[0])} .. {number(levels[-1])}"
        step = number((levels[-1] - levels[0]) / (count - 1))
        return f"{ends} step {step}" if len(step) <= _SHORT else f"{ends} count {count}"
    return " ".join(number(x) for x in levels)


def short_bins(bins: Sequence[float]) -> str:
    """Return the positive half and ``mirrored`` where `bins` are symmetric, else all of them."""
    half = [x for x in bins if x >= 0]
    if len(bins) > 1 and mirror(half) == tuple(bins):
        return " ".join(number(x) for x in half) + " mirrored"
    return " ".join(number(x) for x in bins)
