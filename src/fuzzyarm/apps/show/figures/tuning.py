"""Figures of tuning: the cost over trials, error against chatter, and costs by controller."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.apps.show.figures.panels import draw_panel
from fuzzyarm.apps.show.figures.style import label_axes, new_figure, safe, tidy
from fuzzyarm.apps.show.search import cost_panel, spreads
from fuzzyarm.base.figure_files import plain_powers
from fuzzyarm.base.picture import COLOURS
from fuzzyarm.learning.tuning.result import front_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.learning.tuning.result import Tuned
    from fuzzyarm.learning.tuning.search import Found


def tuning_figure(tuned: Tuned, title: str = "") -> Figure:
    """Return the curve of the cost, the front of error and chatter, and the table as bars."""
    with_front = len(tuned.front) > 1
    panels = 3 if with_front else 2
    figure = new_figure(4.2 * panels, 3.6)
    axes = list(np.atleast_1d(figure.subplots(1, panels)))
    searches = {name: search for name, search, _ in _searches(tuned)}
    draw_panel(axes[0], cost_panel(searches, tuned.cost), (4.2, 3.6))
    if with_front:
        _draw_front(axes[1], tuned)
    _draw_rows(axes[-1], tuned)
    if title:
        figure.suptitle(safe(title), fontsize=10)
    return figure


def _searches(tuned: Tuned) -> list[tuple[str, Found, str]]:
    searches = [("tuned", tuned.found, COLOURS[0])]
    if tuned.linear is not None:
        searches.append(("linear PD", tuned.linear, COLOURS[1]))
    return searches


def _draw_front(axes: Axes, tuned: Tuned) -> None:
    for _name, search, colour in _searches(tuned):
        front = front_of(search)
        error, chatter = np.array(front).T if front else np.zeros((2, 0))
        axes.plot(error, chatter, "o-", color=colour, markersize=2.5, linewidth=0.8)
    markers = {"as in the file": "s", "tuned": "*", "linear PD": "D"}
    for row in tuned.rows:
        score = row.scores["train"]
        colour = COLOURS[1] if row.name == "linear PD" else COLOURS[0]
        if row.name in markers and math.isfinite(score.error) and not score.diverged:
            axes.plot(
                score.error, score.chatter, markers[row.name], color=colour,
                markeredgecolor="#333333", markersize=8, linestyle="none", label=row.name,
            )  # fmt: skip
    axes.legend(fontsize=7, frameon=False)
    pairs = [pair for _, search, _ in _searches(tuned) for pair in front_of(search)]
    _spread(axes, "x", [error for error, _ in pairs])
    _spread(axes, "y", [chatter for _, chatter in pairs])
    label_axes(axes, "RMS error", "chatter", "front of error and chatter")
    tidy(axes)


def _spread(axes: Axes, which: str, values: list[float]) -> None:
    """Use a logarithmic axis with plain numbers if values spread widely."""
    if spreads(values):
        axes.set(**{f"{which}scale": "log"})
        plain_powers(axes, which, min(values), max(values))


def _draw_rows(axes: Axes, tuned: Tuned) -> None:
    columns = [name for name in ("train", "unseen", "noisy") if name in tuned.rows[1].scores]
    width = 0.8 / len(tuned.rows)
    for at, row in enumerate(tuned.rows):
        costs = [row.scores[name].cost if name in row.scores else math.nan for name in columns]
        divergences = [
            bool(row.scores[name].diverged) if name in row.scores else False for name in columns
        ]
        places = np.arange(len(columns)) + (at - 0.5 * (len(tuned.rows) - 1)) * width
        heights = [
            0.0 if diverges else cost for cost, diverges in zip(costs, divergences, strict=True)
        ]
        colour = {"tuned": COLOURS[0], "as in the file": "#bbbbbb"}.get(row.name, COLOURS[1])
        axes.bar(places, heights, 0.92 * width, color=colour, label=row.name)
        for place, diverges in zip(places, divergences, strict=True):
            if diverges:
                axes.annotate("diverges", (place, 0.0), rotation=90, ha="center", fontsize=7)
    axes.set_xticks(np.arange(len(columns)), columns)
    axes.set_ylim(0.0, 1.2 * axes.get_ylim()[1])
    axes.legend(fontsize=7, frameon=False, ncols=len(tuned.rows), loc="upper center")
    label_axes(axes, "", safe(tuned.cost), "cost in the tuning scenarios and others")
    tidy(axes)
