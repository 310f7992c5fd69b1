"""Ratios of times and how far they spread."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple


class Ratio(NamedTuple):
    """A median with the middle half around it."""

    median: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{number(self.median)} ({number(self.low)} … {number(self.high)})"


def number(value: float) -> str:
    """Write three digits, thousands with a comma."""
    if value >= 100.0:
        return f"{float(f'{value:.3g}'):,.0f}"
    return f"{value:.3g}"


def quarters(values: Sequence[float]) -> Ratio:
    """Return the median and the quartiles."""
    if len(values) < 2:
        return Ratio(values[0], values[0], values[0])
    low, middle, high = statistics.quantiles(values, n=4, method="inclusive")
    return Ratio(middle, low, high)


def in_turns(
    first: Callable[[], object], second: Callable[[], object], rounds: int
) -> tuple[list[float], list[float]]:
    """Time two actions in turns, so that both see the same machine."""
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(rounds):
        for action, found in zip((first, second), times, strict=True):
            start = time.process_time()
            action()
            found.append(time.process_time() - start)
    return times


def ratio(slow: Sequence[float], fast: Sequence[float]) -> Ratio:
    """Return the ratios of pairs of times."""
    return quarters([a / b for a, b in zip(slow, fast, strict=True)])
