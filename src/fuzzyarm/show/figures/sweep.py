"""A metric of many runs over what was swept: a curve, or a map with the border of divergence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzyarm.loop.many import Many, Vector
from fuzzyarm.loop.metrics import ERRORS
from fuzzyarm.loop.sweep import Range
from fuzzyarm.picture import COLOURS
from fuzzyarm.show.figures.style import (
    colour_bar,
    head,
    label_axes,
    new_figure,
    safe,
    tidy,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def sweep_figure(many: Many, over: Sequence[Range], metric: str = "rms") -> Figure:
    """Draw a metric over one or two of the swept names, a panel for each output.

    Where more was swept, the worst of the rest is drawn: the largest magnitude, and divergence
    where any of the runs diverged.

    Parameters
    ----------
    many : Many
        Runs on a grid.
    over : sequence of Range
        One for a curve; two for a map, across and up.
    metric : str, optional
        See :class:`fuzzyarm.loop.metrics.Metrics`.
    """
    values, diverged = worst(many, over, metric)
    count = len(many.outputs)
    width = 4.6 if len(over) == 2 else 4.2
    figure = new_figure(max(5.0, width * count), 4.0)
    panels = figure.subplots(1, count, squeeze=False)[0]
    for at, (axes, output) in enumerate(zip(panels, many.outputs, strict=True)):
        unit = many.units[at] if metric in ERRORS else ""
        label = f"{metric}, {unit}" if unit else metric
        if len(over) == 2:
            _draw_map(figure, axes, over, values[at], diverged, label)
            label_axes(axes, safe(over[0].name), safe(over[1].name), output)
        else:
            _draw_curve(axes, over[0], values[at], diverged)
            label_axes(axes, safe(over[0].name), label, output)
    title = f"{many.controller} on {many.where}"
    if diverged.any():
        title += f", {int(diverged.sum())} of {diverged.size} points diverge (grey)"
    rest = [name for name in many.changes if name not in [range_.name for range_ in over]]
    if rest:
        title += f"; the worst over {', '.join(rest)}"
    head(figure, title, size=10, weight="normal")
    return figure


def worst(many: Many, over: Sequence[Range], metric: str) -> tuple[Vector, Any]:
    """Return a metric on the grid of some names, for each output, and where runs diverged.

    Returns
    -------
    ndarray, shape (outputs, up, across) or (outputs, across)
        Largest magnitude; not a number where a run diverged or nothing was measured.
    ndarray of bool, shape (up, across) or (across,)
    """
    axes = [range_.values() for range_ in reversed(over)]
    places = tuple(
        np.searchsorted(values, many.changes[range_.name])
        for values, range_ in zip(axes, reversed(over), strict=True)
    )
    shape = tuple(map(len, axes))
    diverged = np.zeros(shape, bool)
    np.logical_or.at(diverged, places, ~np.isnan(many.diverged))
    worst_values = np.full((len(many.outputs), *shape), -np.inf)
    for at, grid in enumerate(worst_values):
        magnitude = np.abs(many[metric][:, at])
        np.maximum.at(grid, places, np.where(np.isnan(magnitude), -np.inf, magnitude))
        grid[diverged | np.isneginf(grid)] = np.nan
    return worst_values, diverged


def _draw_curve(axes: Axes, over: Range, values: Vector, lost: Any) -> None:
    across = over.values()
    axes.plot(across, values, ".-", color=COLOURS[0], linewidth=1.2, markersize=4)
    if over.log:
        axes.set_xscale("log")
    _scale_up(axes, values)
    edges = edges_of(over)
    for at in np.flatnonzero(lost):
        axes.axvspan(edges[at], edges[at + 1], color="#cccccc", linewidth=0)
    tidy(axes)


def _scale_up(axes: Axes, values: Vector) -> None:
    if _spreads(values):
        axes.set_yscale("log")


def _spreads(values: Vector) -> bool:
    """Whether values need a logarithm to be told apart."""
    finite = values[~np.isnan(values)]
    return (
        bool(len(finite)) and bool(finite.min() > 0.0) and bool(finite.max() > 30.0 * finite.min())
    )


def edges_of(over: Range) -> Vector:
    """Return the edges of the cells around the values of a range."""
    values = np.log(over.values()) if over.log else over.values()
    steps = np.diff(values) / 2.0 if len(values) > 1 else np.array([0.5])
    first, last = values[0] - steps[0], values[-1] + steps[-1]
    edges = np.array([first, *(values[:-1] + values[1:]) / 2.0, last])
    return np.exp(edges) if over.log else edges


def _draw_map(
    figure: Figure, axes: Axes, over: Sequence[Range], values: Vector, lost: Any, label: str
) -> None:
    from matplotlib.colors import LogNorm

    across, up = map(edges_of, over)
    norm = LogNorm() if _spreads(values) else None
    finite = np.ma.masked_invalid(values)
    if finite.count():
        image = axes.pcolormesh(across, up, finite, cmap="viridis_r", norm=norm, rasterized=True)
        bar = colour_bar(figure, image, axes, label, shrink=0.9)
        bar.ax.tick_params(which="minor", labelsize=7)
    if lost.any():
        grey = np.ma.masked_where(~lost, np.ones(lost.shape))
        axes.pcolor(
            across,
            up,
            grey,
            cmap="gray",
            vmin=0.0,
            vmax=1.2,
            hatch="////",
            edgecolor="#777777",
            linewidth=0.0,
        )
        _draw_border(axes, across, up, lost)
    if over[0].log:
        axes.set_xscale("log")
    if over[1].log:
        axes.set_yscale("log")
    axes.set_xlim(across[0], across[-1])
    axes.set_ylim(up[0], up[-1])
    axes.tick_params(labelsize=8)


def _draw_border(axes: Axes, across: Vector, up: Vector, lost: Any) -> None:
    """Draw a line along the edges of cells that part runs that diverged from the others."""
    from matplotlib.collections import LineCollection

    lines = [
        [(across[j + 1], up[i]), (across[j + 1], up[i + 1])]
        for i, j in zip(*np.nonzero(lost[:, 1:] != lost[:, :-1]), strict=True)
    ]
    lines += [
        [(across[j], up[i + 1]), (across[j + 1], up[i + 1])]
        for i, j in zip(*np.nonzero(lost[1:] != lost[:-1]), strict=True)
    ]
    axes.add_collection(LineCollection(lines, colors=COLOURS[3], linewidths=2.0))
