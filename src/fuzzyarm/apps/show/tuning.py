"""Tuning in the terminal: the best cost so far, the table beside the opponent, the changes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.apps.show.panels import LinePlot
from fuzzyarm.apps.show.search import cost_panel
from fuzzyarm.base.columns import in_columns

if TYPE_CHECKING:
    from rich.console import Group

    from fuzzyarm.learning.tuning.result import ComparedRow, Tuned
    from fuzzyarm.learning.tuning.search import Found

WIDTH, HEIGHT = 60, 8
"""Size of the curve in characters."""

LABELS = 12
"""Columns beside a curve."""


def curve_view(result: Found, columns: int = 80, height: int = HEIGHT) -> LinePlot:
    """Return the best cost over the trials, as wide as the screen allows."""
    width = max(10, min(WIDTH, columns - LABELS))
    return LinePlot(cost_panel({"": result}), width, height)


def search_view(result: Found, state: str, columns: int = 80) -> Group:
    """Return the state of a search: a line of progress, and the curve."""
    from rich.console import Group
    from rich.text import Text

    return Group(Text(state), curve_view(result, columns))


def table_lines(tuned: Tuned) -> Iterator[str]:
    """Yield the table of costs: in the tuning scenarios, in unseen ones, and in those with noise.

    The costs are followed by RMS error and chatter in the unseen scenarios.
    """
    columns = [name for name in ("train", "unseen", "noisy") if name in tuned.rows[1].scores]
    loop = any(not math.isnan(row.scores["train"].chatter) for row in tuned.rows)
    last = columns[min(1, len(columns) - 1)]
    heads = ["", *columns, *([f"rms ({last})", f"chatter ({last})"] if loop else [])]
    lines = [heads]
    for row in tuned.rows:
        cells = [_cost(row, name) for name in columns]
        if loop:
            score = row.scores.get(last, row.scores["train"])
            cells += [_number(score.error), _number(score.chatter)]
        lines.append([row.name, *cells])
    yield from in_columns(lines, "<>")


def _cost(row: ComparedRow, name: str) -> str:
    score = row.scores.get(name)
    if score is None:
        return "-"
    return f"{score.diverged} diverge" if score.diverged else _number(score.cost)


def _number(value: float) -> str:
    return "-" if math.isnan(value) else number_words(value, 4)


def change_lines(tuned: Tuned) -> Iterator[str]:
    """Yield the changes, old → new, aligned."""
    table = in_columns([(name, f"{old} →") for name, old, _ in tuned.changes], "<>")
    yield from (f"{line} {change.new}" for line, change in zip(table, tuned.changes, strict=True))


MOST_FRONT = 8


def front_lines(tuned: Tuned) -> Iterator[str]:
    """Yield some points of the front of error and chatter, both ends included."""
    front = tuned.front
    if len(front) < 2:
        return
    count = min(MOST_FRONT, len(front))
    picked = [front[at * (len(front) - 1) // (count - 1)] for at in range(count)]
    names = ("rms", "chatter")
    rows = [(name, *(number_words(pair[k], 3) for pair in picked)) for k, name in enumerate(names)]
    yield from in_columns(rows, "<>", least=(0, 6, 8))
