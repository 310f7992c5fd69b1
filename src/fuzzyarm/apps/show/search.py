"""A search as a picture: the cost of each trial, and the best so far."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from fuzzyarm.base.picture import COLOURS, Axis, ChartPart, Dots, Line, Panel

if TYPE_CHECKING:
    from fuzzyarm.learning.tuning.search import Found

CEILING = 20.0
"""Costs above this multiple of the best have one colour."""


def cost_panel(searches: Mapping[str, Found], cost: str = "cost") -> Panel:
    """Return the cost of the trials of some searches, and the best of each so far."""
    best = {
        name: [value if math.isfinite(value) else math.nan for value in search.curve]
        for name, search in searches.items()
    }
    finite = [value for curve in best.values() for value in curve if math.isfinite(value)]
    ceiling = CEILING * min(finite) if finite and min(finite) > 0.0 else math.inf
    parts: list[ChartPart] = []
    for k, (name, search) in enumerate(searches.items()):
        costs = [trial.score.cost for trial in search.trials]
        points = [(at, x) for at, x in enumerate(costs, start=1) if x <= ceiling]
        trials, values = zip(*points, strict=True) if points else ((), ())
        size = dot_size(len(costs))
        parts.append(Dots(trials, values, ".", COLOURS[k], size, opacity=size / 6.0))
        numbers = range(1, len(costs) + 1)
        parts.append(Line(numbers, best[name], COLOURS[k], 1.5, label=name, steps=True))
    high = ceiling if finite and max(finite) > ceiling else None
    across, up = Axis("trials", whole=True), Axis(cost, high=high, logarithmic=spreads(finite))
    return Panel(parts, across, up, "cost of trials, and the best so far", key="best")


def dot_size(trials: int) -> float:
    """Return the size of a trial's dot: of thousands they are small and pale."""
    return min(4.0, max(1.5, 40.0 / math.sqrt(max(trials, 1))))


def spreads(values: list[float]) -> bool:
    """Whether values spread enough for a logarithmic scale."""
    return bool(values) and min(values) > 0.0 and max(values) >= 5.0 * min(values)
