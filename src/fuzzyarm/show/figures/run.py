"""Figures of runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fuzzyarm.show.figures.panels import chart_figure
from fuzzyarm.show.run import run_chart

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fuzzyarm.loop import Run


def draw_runs(runs: Sequence[Run], title: str = "") -> Figure:
    """Draw runs of the same plant: a column for each tracked output.

    Each column has the output with its reference, the error, and the drives of its axis with
    their limits, over time.

    Parameters
    ----------
    runs : sequence of Run
        At least one; on one plant.
    title : str, optional
        Above the figure; by default the plant and what it follows.
    """
    return chart_figure(run_chart(runs, title))
