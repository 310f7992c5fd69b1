"""Figures of a training: tables, visits of their cells, and the error of each pass."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyarm.apps.show.drawing import number_words, scale_of
from fuzzyarm.apps.show.figures.animation import write_film
from fuzzyarm.apps.show.figures.labels import thin_ticks, wrapped
from fuzzyarm.apps.show.figures.panels import draw_panel
from fuzzyarm.apps.show.figures.style import (
    LABEL,
    colour_bar,
    colour_map,
    head,
    label_axes,
    new_figure,
    safe,
)
from fuzzyarm.apps.show.learning import error_panel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from fuzzyarm.control.controllers.on_plant import LearnedTables
    from fuzzyarm.learning.self_organizing import Snapshot
    from fuzzyarm.table import LookupTable

MOST_FRAMES = 50
"""Most frames of an animation."""

_NEVER = {"facecolor": "#efefef", "edgecolor": "#c4c4c4", "hatch": "////", "linewidth": 0.0}
_ROOM = (3.3, 2.6)
"""Width and height of a table's cells in inches."""


@dataclass(frozen=True)
class LearningHistory:
    """The history of a training.

    Attributes
    ----------
    name : str
        Name of the controller.
    snapshots : sequence of Snapshot
        In order of time; the last of each pass is complete.
    axes : sequence of str
        Names of the controller's axes, each with its own table.
    like : LookupTable
        A table with the range and the names.
    """

    name: str
    snapshots: Sequence[Snapshot]
    axes: Sequence[str]
    like: LookupTable

    @property
    def passes(self) -> list[Snapshot]:
        """The snapshots at the ends of passes."""
        return [snapshot for snapshot in self.snapshots if snapshot.complete]

    def tables(self, learned: LearnedTables) -> list[tuple[NDArray[Any], NDArray[Any]]]:
        """Return values and visits of each axis as rows and columns.

        A table of more than two inputs is reduced to its most visited page at the end.
        """
        return learned.pages(self.snapshots[-1].learned.visits)


def learning_figure(training: LearningHistory) -> Figure:
    """Return the final tables, the visits of their cells and the RMS error of each pass.

    Cells without visits are hatched, whatever their value.
    """
    figure, show = _stage(training)
    show(len(training.snapshots) - 1)
    return figure


def animate_learning(
    training: LearningHistory,
    path: str | os.PathLike[str],
    *,
    watch: Callable[[int], None] | None = None,
) -> None:
    """Write a film of the growing tables, whole or not at all."""
    figure, show = _stage(training)
    last = len(training.snapshots) - 1
    frames = np.unique(np.linspace(0, last, min(MOST_FRAMES, last + 1)).round().astype(int))

    def draw(index: int) -> list[Any]:
        show(index)
        return []

    write_film(figure, draw, frames, max(1.0, 0.1 * len(frames)), path, watch=watch)


def _stage(training: LearningHistory) -> tuple[Figure, Callable[[int], None]]:
    """Return the figure, and a function that shows a snapshot in it."""
    rows = len(training.axes)
    figure = new_figure(9.2, 3.5 * rows + 2.5)
    grid = figure.add_gridspec(rows + 1, 2, height_ratios=[3.5] * rows + [2.2])
    # Tables and visits use the final scales, so that a film does not flicker.
    end = training.tables(training.snapshots[-1].learned)
    most = max(1.0, *(float(visits.max()) for _, visits in end))
    scale = scale_of(
        [float(x) for values, _ in end for x in values.ravel()],
        training.like.low,
        training.like.high,
    )
    limits = {"cmap": colour_map(scale), "vmin": scale.low, "vmax": scale.high}
    # Visits span powers of ten, and cells without visits have no logarithm.
    counts = {"cmap": "viridis", "vmin": 0.0, "vmax": np.log10(1.0 + most)}
    cells = []
    for row, name in enumerate(training.axes):
        left, right = (figure.add_subplot(grid[row, column]) for column in (0, 1))
        images = _draw_cells(left, training, limits), _draw_cells(right, training, counts)
        colour_bar(figure, images[0], left, safe(training.like.output), shrink=0.9)
        bar = colour_bar(figure, images[1], right, "visits", shrink=0.9)
        powers = [x for x in (0, 1, 10, 100, 1000, 10_000, 100_000) if x <= most]
        bar.set_ticks([float(np.log10(1.0 + x)) for x in powers], labels=[str(x) for x in powers])
        cells.append((name, left, right, images))
    errors = figure.add_subplot(grid[rows, :])
    head(figure, f"{training.name}: learned tables", size=10, weight="normal")

    def show(index: int) -> None:
        snapshot = training.snapshots[index]
        for (name, left, right, images), (values, visits) in zip(
            cells, training.tables(snapshot.learned), strict=True
        ):
            never = visits == 0
            images[0].set_data(np.ma.masked_where(never, values))
            images[1].set_data(np.ma.masked_where(never, np.log10(1.0 + visits)))
            left.set_title(safe(f"{name}, {_moment(snapshot)}"), fontsize=LABEL)
            text = f"{int((~never).sum())} of {never.size} cells visited; hatched: never"
            right.set_title(text, fontsize=LABEL)
        _draw_errors(errors, training, index)

    return figure, show


def _moment(snapshot: Snapshot) -> str:
    if snapshot.complete:
        return f"after pass {snapshot.passage}"
    return f"pass {snapshot.passage}, {snapshot.time:.2f} s"


def _draw_cells(axes: Axes, training: LearningHistory, limits: dict[str, Any]) -> Any:
    """Draw the hatched frame of a table, and return the image of its visited cells."""
    learned = training.snapshots[0].learned.axes
    down, across = (None, *learned)[-2:]
    levels = [[""] if axis is None else list(map(_level, axis.levels)) for axis in (down, across)]
    shape = (len(levels[0]), len(levels[1]))
    from matplotlib.patches import Rectangle

    axes.add_patch(Rectangle((-0.5, -0.5), shape[1], shape[0], zorder=0, **_NEVER))  # type: ignore[arg-type]
    image = axes.imshow(np.full(shape, np.nan), aspect="auto", zorder=1, **limits)
    thin_ticks(axes.yaxis, levels[0], _ROOM[1], 8)
    thin_ticks(axes.xaxis, levels[1], _ROOM[0], 8)
    axes.tick_params(labelsize=8, length=0)
    axes.spines[:].set_visible(False)
    words = ["" if axis is None else wrapped(axis.name, LABEL, 2.5, 1) for axis in (across, down)]
    label_axes(axes, safe(words[0]), safe(words[1]))
    return image


def _level(x: float) -> str:
    return number_words(x, 4)


def _draw_errors(axes: Axes, training: LearningHistory, index: int) -> None:
    """Draw the RMS error of the passes finished at a snapshot, a line for each output."""
    axes.clear()
    over = [snapshot for snapshot in training.snapshots[: index + 1] if snapshot.complete]
    units, last = training.snapshots[-1].units, training.snapshots[-1].passage
    names = [
        training.axes[column] if column < len(training.axes) else f"output {column + 1}"
        for column in range(len(units))
    ]
    draw_panel(axes, error_panel(names, units, [passage.rms for passage in over], last))
    axes.set_xticks(_passes(last))
    errors = np.array([passage.rms for passage in training.passes])
    if errors.size and np.isfinite(errors).all():  # the final scale, for a film
        axes.set_ylim(0.0, 1.08 * float(errors.max()) or 1.0)


def _passes(last: int) -> list[int]:
    step = max(1, -(-last // 20))
    return list(range(1, last + 1, step))
