"""Figures of runs: outputs with their references, errors, drives with their limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.show.figures.labels import columns_that_fit, shortened, wrapped
from fuzzyarm.show.figures.style import LABEL, head, label_axes, line_style, new_figure, safe, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.loop import Run

LIMIT_COLOUR = "#999999"
WANTED_COLOUR = "#333333"


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
    first = runs[0]
    drives = [_drives_of(runs, axis) for axis in first.axes]
    rows = 2 + max(map(len, drives))
    width = max(6.0, 4.6 * len(first.labels))
    figure = new_figure(width, 1.3 + 1.75 * rows)
    panels = figure.subplots(rows, len(first.labels), squeeze=False, sharex=True)
    for column, label in enumerate(first.labels):
        unit = first.units[column]
        _draw_output(panels[0][column], runs, column)
        label_axes(panels[0][column], "", _quantity(label, unit))
        _draw_errors(panels[1][column], runs, column)
        label_axes(panels[1][column], "", _quantity("error", unit))
        for row, drive in enumerate(drives[column], 2):
            _draw_drive(panels[row][column], runs, drive)
            label_axes(panels[row][column], "", _quantity(drive, first.drive_units[drive]))
        for row in range(2 + len(drives[column]), rows):
            panels[row][column].set_visible(False)
        panels[-1][column].set_xlabel("time, s", fontsize=9)
    head(figure, title or f"{first.plant}: {first.trajectory}", size=10, weight="normal")
    handles, labels = panels[0][0].get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        fontsize=8,
        frameon=False,
        loc="outside lower center",
        ncols=columns_that_fit(labels, 8, width - 0.2),
    )
    return figure


def _drives_of(runs: Sequence[Run], axis: str) -> list[str]:
    """Return the drives of an axis that ever do something in any run, or its first."""
    own = [name for name in runs[0].drives if name.rpartition(".")[0] in ("", axis)]
    return [name for name in own if any(np.any(run.drives[name]) for run in runs)] or own[:1]


def _quantity(label: str, unit: str) -> str:
    return safe(wrapped(f"{label}, {unit}" if unit != "1" else label, LABEL, 1.3, 2))


def _name(run: Run) -> str:
    stopped = f", diverged at {run.diverged:.3g} s" if run.diverged is not None else ""
    if run.ended is not None:
        stopped = f", ended at {run.ended:.3g} s"
    return safe(shortened(run.controller + stopped, 8, 4.0))


def _draw_output(axes: Axes, runs: Sequence[Run], column: int) -> None:
    tidy(axes)
    wanted = runs[0].reference[:, column]
    axes.plot(
        runs[0].time, wanted, color=WANTED_COLOUR, linewidth=0.9, linestyle=":", label="reference"
    )
    for index, run in enumerate(runs):
        output = run.reference[:, column] - run.errors[:, column]
        axes.plot(run.time, output, linewidth=1.1, label=_name(run), **line_style(index))


def _draw_errors(axes: Axes, runs: Sequence[Run], column: int) -> None:
    tidy(axes)
    axes.axhline(0.0, color=WANTED_COLOUR, linewidth=0.6)
    for index, run in enumerate(runs):
        axes.plot(run.time, run.errors[:, column], linewidth=1.0, **line_style(index))


def _draw_drive(axes: Axes, runs: Sequence[Run], drive: str) -> None:
    tidy(axes)
    reached = max(float(np.abs(run.drives[drive]).max(initial=0.0)) for run in runs)
    for limit in runs[0].limits[drive]:
        # A limit far beyond what is used would flatten the curve.
        if math.isfinite(limit) and abs(limit) <= 4.0 * max(reached, 1e-12):
            axes.axhline(limit, color=LIMIT_COLOUR, linewidth=0.9, linestyle="--")
    for index, run in enumerate(runs):
        axes.step(run.time, run.drives[drive], where="post", linewidth=0.8, **line_style(index))
