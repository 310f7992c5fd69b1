"""A map of starts as a picture: proved, lost and open starts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.base.picture import Axis, Cells, Chart, Panel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fuzzyarm.proof.loop import StartMap

COLUMNS, ROWS = 160, 120


def map_chart(found: StartMap) -> Chart:
    """Return a map of starts over the first two states of its window, and over the next two."""
    names = list(found.window)
    pairs = [(0, 1), (2, 3)] if len(names) > 3 else [(0, min(1, len(names) - 1))]
    panels = [_panel(found, pair, COLUMNS, ROWS) for pair in pairs]
    title = f"{found.statement}: {found.sentence()}"
    words = title.replace(" every run", "\nevery run", 1)
    return Chart([panels], (5.4 * len(panels), 4.4), words)


def map_panel(found: StartMap, columns: int = COLUMNS, rows: int = ROWS) -> Panel:
    """Return a map of starts over the first two states of its window."""
    return _panel(found, (0, min(1, len(found.window) - 1)), columns, rows)


def _panel(found: StartMap, pair: tuple[int, int], columns: int, rows: int) -> Panel:
    names, units = list(found.window), found.units
    first, second = pair
    spans = [found.window[names[k]] for k in pair]
    rows = rows if first != second else 2
    x, y = (
        np.linspace(span.low, span.high, count + 1)
        for span, count in zip(spans, (columns, rows), strict=True)
    )
    values = _values(found, pair, x, y)
    others = len(names) > 2
    states = f"proved (−1), open (0), lost (1){', on average' * others}"
    value = Axis(states, "", -1.0, 1.0, whole=not others)
    across, up = (
        Axis(names[k], units.get(names[k], ""), span.low, span.high)
        for k, span in zip(pair, spans, strict=True)
    )
    if first == second:
        up = Axis()
    return Panel([Cells(x, y, values, value, signed=True)], across, up)


def _values(
    found: StartMap, pair: tuple[int, int], x: NDArray[np.float64], y: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the lost share less the proved share of each cell, over all other states."""
    total = np.zeros((len(y) - 1, len(x) - 1))
    flat = pair[0] == pair[1]
    sides = [span.high - span.low for span in found.window.values()]
    for box in found.boxes:
        sign = {"proved": -1.0, "refuted": 1.0}.get(box.verdict, 0.0)
        if not sign:
            continue
        for k, side in enumerate(sides):
            if k not in pair:
                sign *= (box.high[k] - box.low[k]) / side
        first, second = pair
        across = _shares(x, box.low[first], box.high[first])
        up = np.ones(len(y) - 1) if flat else _shares(y, box.low[second], box.high[second])
        some, those = np.flatnonzero(across), np.flatnonzero(up)
        total[np.ix_(those, some)] += sign * np.outer(up[those], across[some])
    return total


def _shares(edges: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    """Return the share of each cell of an axis between two ends."""
    ends = np.clip(edges, low, high)
    return np.asarray(np.diff(ends) / np.diff(edges))
