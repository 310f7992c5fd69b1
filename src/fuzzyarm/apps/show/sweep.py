"""Many runs as a picture: a metric over the swept values, and the diverged runs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzyarm.base.columns import in_columns
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
    series,
)
from fuzzyarm.control.loop.many import Many, Vector
from fuzzyarm.control.loop.metrics import ERRORS
from fuzzyarm.control.loop.robustness import PairedComparison, paired_comparison, robustness
from fuzzyarm.control.loop.sweep import Range

DIVERGED, NOT_RUN = "diverged", "not run"

Units = Mapping[str, str]
"""Units of swept names."""


@dataclass(frozen=True)
class _Course:
    """A metric of one controller over one or two of the swept names.

    Attributes
    ----------
    many : Many
        The runs.
    values : ndarray, shape (outputs, ...)
        See :func:`worst`.
    diverged, skipped : ndarray of bool
        The points with a diverged run, and those without a run.
    """

    many: Many
    values: Vector
    diverged: Any
    skipped: Any


def sweep_chart(results: Sequence[Many], over: Sequence[Range], metric: str = "rms") -> Chart:
    """Return a metric over one or two of the swept names, a panel for each output.

    The other swept names are reduced to the worst case: the greatest magnitude, and divergence if
    any of the runs diverged. Over one name several controllers share the panels; over two each
    has a row of maps, with common colours.
    """
    courses = [
        _Course(many, *worst(many, over, metric), ~_have_run(many, over)) for many in results
    ]
    units = {name: unit for each in reversed(results) for name, unit in each.change_units.items()}
    axes = [_value_axis(courses, at, metric) for at in range(len(results[0].outputs))]
    if len(over) == 2:
        rows = [
            [_map_panel(over, course, at, value, _name_of(courses, course, at), units)
             for at, value in enumerate(axes)]
            for course in courses
        ]  # fmt: skip
    else:
        draw = _curve_panel if len(courses) == 1 else _curves_panel
        rows = [[draw(over[0], courses, at, value, units) for at, value in enumerate(axes)]]
    width, height = (4.6, 4.0 if len(rows) == 1 else 3.4) if len(over) == 2 else (4.2, 4.0)
    size = max(5.0, width * len(axes)), height * len(rows)
    return Chart(rows, size, _title(courses, over), key=len(courses) > 1 and len(over) == 1)


def _value_axis(courses: Sequence[_Course], at: int, metric: str) -> Axis:
    """Return the axis of the metric of an output; of several controllers with common ends."""
    values = np.concatenate([course.values[at].ravel() for course in courses])
    unit = courses[0].many.units[at] if metric in ERRORS else ""
    finite = values[~np.isnan(values)]
    several = len(courses) > 1 and len(finite) > 0
    low, high = (float(finite.min()), float(finite.max())) if several else (None, None)
    return Axis(metric, unit, low, high, logarithmic=_spreads(values))


def _name_of(courses: Sequence[_Course], course: _Course, at: int) -> str:
    """Return the title of a panel with the points of one controller."""
    output = course.many.outputs[at]
    return output if len(courses) == 1 else f"{course.many.controller}: {output}"


def _title(courses: Sequence[_Course], over: Sequence[Range]) -> str:
    many, size = courses[0].many, courses[0].diverged.size
    title = f"{', '.join(course.many.controller for course in courses)} on {many.where}"
    diverged = [int(course.diverged.sum()) for course in courses]
    skipped = sum(int(course.skipped.sum()) for course in courses)
    if any(diverged):
        look = "grey" if len(courses) == 1 or len(over) == 2 else "crosses"
        title += f", {', '.join(map(str, diverged))} of {size} points diverge ({look})"
    if skipped:
        title += f", {skipped} of {size * len(courses)} points not run"
    rest = [name for name in many.changes if name not in [span.name for span in over]]
    return f"{title}; the worst over {', '.join(rest)}" if rest else title


def worst(many: Many, over: Sequence[Range], metric: str) -> tuple[Vector, Any]:
    """Return a metric on the grid of some names, for each output, and the diverged points.

    Returns
    -------
    ndarray, shape (outputs, up, across) or (outputs, across)
        Greatest magnitude; NaN for a diverged run or one without a value.
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
    swept: Range, courses: Sequence[_Course], at: int, value: Axis, units: Units
) -> Panel:
    """Return a curve; the points with a diverged run are grey."""
    (course,) = courses
    values, diverged = course.values[at], course.diverged
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
    title, key = course.many.outputs[at], "upper left" if diverged.any() else ""
    return Panel(parts, axis, up, title, key=key)


def _curves_panel(
    swept: Range, courses: Sequence[_Course], at: int, value: Axis, units: Units
) -> Panel:
    """Return the curves of several controllers; diverged points are crosses at the upper edge."""
    across = swept.values()
    values = np.concatenate([course.values[at] for course in courses])
    low, high = ends_with_room(values, logarithmic=value.logarithmic)
    parts: list[ChartPart] = []
    for number, course in enumerate(courses):
        tone, dash = series(number)
        parts.append(Line(across, course.values[at], tone, 1.2, dash, course.many.controller))
        parts.append(Dots(across, course.values[at], "o", tone, 3.5))
        lost = across[course.diverged]
        parts += [Dots(lost, np.full(len(lost), high), "x", tone, 5.0)] if len(lost) else []
    axis = _axis(swept, edges_of(swept), units)
    up = Axis(value.name, value.unit, low, high, logarithmic=value.logarithmic)
    return Panel(parts, axis, up, courses[0].many.outputs[at])


# --- Over two ---


def _map_panel(
    over: Sequence[Range], course: _Course, at: int, value: Axis, title: str, units: Units
) -> Panel:
    x, y = map(edges_of, over)
    diverged, missing = course.diverged, ((DIVERGED, course.diverged), (NOT_RUN, course.skipped))
    why = [words for words, points in missing if points.any()]
    parts: list[ChartPart] = [Cells(x, y, course.values[at], value, missing=" or ".join(why))]
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


def sweep_lines(results: Sequence[Many], metric: str) -> list[str]:
    """Return the number of diverged runs, and the extremes of a metric with their runs.

    Of several controllers see :func:`robustness_lines`.
    """
    if len(results) > 1:
        return robustness_lines(results, metric)
    (many,) = results
    lost = lost_runs(many)
    lines = [
        f"{many.controller} on {many.where}: {counted(len(many), 'run')}, "
        f"{f'{lost} diverged' if lost else 'none diverged'}"
    ]
    for output, unit, least, most in extremes(many, metric):
        lines.append(f"{output}.{metric}, {unit}" if metric in ERRORS else f"{output}.{metric}")
        for word, run in (("least", least), ("most", most)):
            value = float(many[metric][run, many.outputs.index(output)])
            settings = _settings_words(many, run)
            lines.append(f"  {word:<6}{value:>12.4g}  run {run}: {settings}")
    return lines


def robustness_lines(results: Sequence[Many], metric: str) -> list[str]:
    """Return median, worst and failures as a table, and where the first controller is better."""
    first, *others = results
    units = dict(zip(first.outputs, first.units, strict=True))
    rows: list[tuple[str, ...]] = [("controller", metric, "median", "worst", "at", "failed")]
    for row in robustness(results, metric):
        name = f"{row.output}, {units[row.output]}" if metric in ERRORS else row.output
        numbers = ["-" if each is None else f"{each:.4g}" for each in (row.median, row.worst)]
        at = "" if row.run is None else _settings_words(first, row.run)
        rows.append((row.controller, name, *numbers, at, f"{row.failed} of {len(first)}"))
    lines = [f"on {first.where}: {counted(len(first), 'run')} of each", *in_columns(rows, "<<>><<")]
    pairs = (paired_comparison(first, other, metric) for other in others)
    return [*lines, *(_pair_words(pair, first) for pair in pairs)]


def _settings_words(many: Many, run: int) -> str:
    return ", ".join(f"{name} = {value:g}" for name, value in settings_of(many, run).items())


def _pair_words(found: PairedComparison, many: Many) -> str:
    """Return a paired comparison in a sentence."""
    always = "always at " if len(many.changes) > 1 else ""
    sides = []
    for word, count, spans in (
        ("better", found.better, found.better_where),
        ("worse", found.worse, found.worse_where),
    ):
        where = ", ".join(f"{name} = {_span_words(ends)}" for name, ends in spans.items())
        said = f" ({always}{where})" if where and count < len(many) else ""
        sides.append(f"{word} in {count}{said}")
    words = f"{found.first} against {found.second}: {', '.join(sides)}"
    return f"{words} of {counted(len(many), 'run')}"


def _span_words(spans: Sequence[tuple[float, float]]) -> str:
    return " and ".join(f"{low:g}" if low == high else f"{low:g}..{high:g}" for low, high in spans)


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
