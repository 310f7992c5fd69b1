"""Many runs as a picture: a metric over the swept values, and the diverged runs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from fuzzyarm.base.numbers import counted
from fuzzyarm.base.picture import (
    Axis,
    Band,
    Cells,
    Chart,
    ChartPart,
    Dots,
    Line,
    Panel,
    ends_with_room,
)
from fuzzyarm.control.loop.many import Many, Vector
from fuzzyarm.control.loop.metrics import ERRORS
from fuzzyarm.control.loop.sweep import Range

DIVERGED, NOT_RUN = "diverged", "not run"

Units = Mapping[str, str]
"""Units of swept names."""


def sweep_chart(many: Many, over: Sequence[Range], metric: str = "rms") -> Chart:
    """Return a metric over one or two of the swept names, a panel for each output.

    The other swept names are reduced to the worst case: the greatest magnitude, and divergence if
    any of the runs diverged.
    """
    values, diverged = worst(many, over, metric)
    skipped = ~_have_run(many, over)
    panels = []
    for at, output in enumerate(many.outputs):
        unit = many.units[at] if metric in ERRORS else ""
        value = Axis(metric, unit, logarithmic=_spreads(values[at]))
        draw = _map_panel if len(over) == 2 else _curve_panel
        panels.append(draw(over, values[at], diverged, skipped, value, output, many.change_units))
    width = 4.6 if len(over) == 2 else 4.2
    title = _title(many, over, diverged, skipped)
    return Chart([panels], (max(5.0, width * len(panels)), 4.0), title)


def _title(many: Many, over: Sequence[Range], diverged: Any, skipped: Any) -> str:
    title = f"{many.controller} on {many.where}"
    if diverged.any():
        title += f", {int(diverged.sum())} of {diverged.size} points diverge (grey)"
    if skipped.any():
        title += f", {int(skipped.sum())} of {skipped.size} points not run"
    rest = [name for name in many.changes if name not in [span.name for span in over]]
    return f"{title}; the worst over {', '.join(rest)}" if rest else title


def worst(many: Many, over: Sequence[Range], metric: str) -> tuple[Vector, Any]:
    """Return a metric on the grid of some names, for each output, and the diverged points.

    Returns
    -------
    ndarray, shape (outputs, up, across) or (outputs, across)
        Greatest magnitude; NaN where a run diverged or has no value.
    ndarray of bool, shape (up, across) or (across,)
    """
    shape, places = _points(many, over)
    diverged = np.zeros(shape, bool)
    np.logical_or.at(diverged, places, ~np.isnan(many.diverged))
    worst_values = np.full((len(many.outputs), *shape), -np.inf)
    for at, grid in enumerate(worst_values):
        magnitude = np.abs(many[metric][:, at])
        np.maximum.at(grid, places, np.where(np.isnan(magnitude), -np.inf, magnitude))
        grid[diverged | np.isneginf(grid)] = np.nan
    return worst_values, diverged


def _points(many: Many, over: Sequence[Range]) -> tuple[tuple[int, ...], tuple[Any, ...]]:
    """Return the shape of the grid of some names, and the grid index of each run."""
    axes = [span.values() for span in reversed(over)]
    places = tuple(
        np.searchsorted(values, many.changes[span.name])
        for values, span in zip(axes, reversed(over), strict=True)
    )
    return tuple(map(len, axes)), places


def _have_run(many: Many, over: Sequence[Range]) -> Any:
    """Return the points of the grid with a run."""
    shape, places = _points(many, over)
    runs = np.zeros(shape, bool)
    runs[places] = True
    return runs


def _spreads(values: Vector) -> bool:
    """Whether values need a logarithmic scale."""
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


def _axis(swept: Range, edges: Vector, units: Units) -> Axis:
    """Return the axis of a swept name."""
    unit = units.get(swept.name, "")
    return Axis(swept.name, unit, edges[0], edges[-1], logarithmic=swept.log)


# --- Over one name ---


def _curve_panel(
    over: Sequence[Range],
    values: Vector,
    diverged: Any,
    _skipped: Any,
    value: Axis,
    title: str,
    units: Units,
) -> Panel:
    (swept,) = over
    across, edges = swept.values(), edges_of(swept)
    low, high = ends_with_room(values, logarithmic=value.logarithmic)
    up = Axis(value.name, value.unit, low, high, logarithmic=value.logarithmic)
    parts: list[ChartPart] = [
        Band([edges[k], edges[k + 1]], [low] * 2, [high] * 2, "wanted", 0.5,
             DIVERGED if number == 0 else "")
        for number, k in enumerate(np.flatnonzero(diverged))
    ]  # fmt: skip
    parts += [Line(across, values, "first", 1.2), Dots(across, values, "o", "first", 3.5)]
    axis = _axis(swept, edges, units)
    return Panel(parts, axis, up, title, key="upper left" if diverged.any() else "")


# --- Over two ---


def _map_panel(
    over: Sequence[Range],
    values: Vector,
    diverged: Any,
    skipped: Any,
    value: Axis,
    title: str,
    units: Units,
) -> Panel:
    x, y = map(edges_of, over)
    why = [words for words, at in ((DIVERGED, diverged), (NOT_RUN, skipped)) if at.any()]
    parts: list[ChartPart] = [Cells(x, y, values, value, missing=" or ".join(why))]
    if diverged.any():
        parts.append(_border(x, y, diverged))
    across, up = (_axis(swept, edges, units) for swept, edges in zip(over, (x, y), strict=True))
    return Panel(parts, across, up, title)


def _border(x: Vector, y: Vector, diverged: Any) -> Line:
    """Return the cell edges between diverged and other runs."""
    gap = math.nan
    xs: list[float] = []
    ys: list[float] = []
    for i, j in zip(*np.nonzero(diverged[:, 1:] != diverged[:, :-1]), strict=True):
        xs += [x[j + 1], x[j + 1], gap]
        ys += [y[i], y[i + 1], gap]
    for i, j in zip(*np.nonzero(diverged[1:] != diverged[:-1]), strict=True):
        xs += [x[j], x[j + 1], gap]
        ys += [y[i + 1], y[i + 1], gap]
    return Line(xs, ys, "mark", 2.0)


# --- In words ---


def sweep_lines(many: Many, metric: str) -> list[str]:
    """Return the number of diverged runs, and the extremes of a metric with their runs."""
    lost = lost_runs(many)
    lines = [
        f"{many.controller} on {many.where}: {counted(len(many), 'run')}, "
        f"{f'{lost} diverged' if lost else 'none diverged'}"
    ]
    for output, unit, least, most in extremes(many, metric):
        lines.append(f"{output}.{metric}, {unit}" if metric in ERRORS else f"{output}.{metric}")
        for word, run in (("least", least), ("most", most)):
            value = float(many[metric][run, many.outputs.index(output)])
            settings = ", ".join(f"{k} = {v:g}" for k, v in settings_of(many, run).items())
            lines.append(f"  {word:<6}{value:>12.4g}  run {run}: {settings}")
    return lines


def lost_runs(many: Many) -> int:
    """Return the number of diverged runs."""
    return int((~np.isnan(many.diverged)).sum())


def extremes(many: Many, metric: str) -> Iterator[tuple[str, str, int, int]]:
    """Yield output, unit, and the runs with the smallest and the largest magnitude of a metric."""
    values = np.abs(many[metric])
    # Values up to a divergence are not comparable.
    values[~np.isnan(many.diverged)] = np.nan
    for at, (output, unit) in enumerate(zip(many.outputs, many.units, strict=True)):
        column = values[:, at]
        if not np.isnan(column).all():
            yield output, unit, int(np.nanargmin(column)), int(np.nanargmax(column))


def settings_of(many: Many, run: int) -> dict[str, float]:
    """Return the swept values of a run."""
    return {name: float(values[run]) for name, values in many.changes.items()} or {
        "seed": int(many.seeds[run])
    }
