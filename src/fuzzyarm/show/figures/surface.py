"""What comes out over what goes in: a line, a surface, or slices through more inputs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.model.rulebase import Output, RuleBase, Variable
from fuzzyarm.show.drawing import number_words, scale_of
from fuzzyarm.show.figures.style import (
    COLOURS,
    axis_label,
    colour_bar,
    colour_map,
    label_axes,
    new_figure,
    safe,
    set_range,
    tidy,
)
from fuzzyarm.show.terms import visible_range
from fuzzyarm.text.numbers import column_of_numbers

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.proof import Verdict
    from fuzzyarm.table import LookupTable


_LINE = 601
_PLANE = 121


@dataclass(frozen=True, slots=True)
class _Side:
    """One input or output of what is drawn: its name, its words and its range."""

    name: str
    description: str
    low: float
    high: float

    @property
    def label(self) -> str:
        """The words at the axis."""
        return axis_label(self.name, self.description)


_FAILS: dict[str, Any] = {"color": COLOURS[3], "markersize": 9, "markeredgecolor": "white"}


def surface_figure(
    rulebase: RuleBase,
    output: str | None = None,
    at: Mapping[str, float] | None = None,
    fails: Sequence[Verdict] = (),
) -> Figure:
    """Return the control surface of every output, or of the one named.

    Parameters
    ----------
    rulebase : RuleBase
        One input gives a line; two a surface and its map; more a slice over two of them.
    output : str, optional
        Only this one.
    at : mapping of str to float, optional
        With more than two inputs, the values of those that are held fixed (the middle of
        the range by default); the first two that are not named are drawn. With two or
        fewer, a point to mark.
    fails : sequence of Verdict
        On properties that fail: their points are marked.
    """
    outputs = [rulebase.output(output)] if output else list(rulebase.outputs)
    one = len(rulebase.inputs) == 1
    height = 3.6 if one else 4.3
    figure = new_figure(6.4 if one else 9.6, height * len(outputs))
    parts = figure.subfigures(len(outputs), 1, squeeze=False)[:, 0]
    for part, target in zip(parts, outputs, strict=True):
        draw_response(part, rulebase, target, at or {}, fails)
    return figure


def draw_response(
    part: Any,
    rulebase: RuleBase,
    output: Output,
    at: Mapping[str, float],
    fails: Sequence[Verdict] = (),
) -> None:
    """Draw one output of `rulebase` into a figure or a part of one."""
    fails = [each for each in fails if each.output == output.name and each.points]
    inputs_left = [variable.name for variable in rulebase.inputs[2:]]
    if fails and inputs_left and not at:  # the slice that has the first of them
        at = {name: fails[0].points[0][name] for name in inputs_left}
    free, fixed = _free_and_fixed(rulebase, at)
    sides = [_Side(v.name, v.description, *visible_range(v)) for v in free]
    target = _Side(output.name, output.description, output.low, output.high)
    import numpy as np

    counts = _LINE if len(sides) == 1 else _PLANE
    grid = np.ix_(*(np.linspace(side.low, side.high, counts) for side in sides))
    inputs = {**fixed, **{side.name: values for side, values in zip(sides, grid, strict=True)}}
    values = np.broadcast_to(_with_gaps(rulebase, output, inputs), [counts] * len(sides))
    notes = [_fixed_words(fixed), "blank: no rule fires" if _has_gaps(values) else ""]
    title = "\n".join(filter(None, notes))
    marks = _marks(rulebase, output, fails, [side.name for side in sides], fixed)
    if len(sides) == 1:
        axes = part.subplots()
        _line(axes, sides[0], target, grid[0], values, title)
        for (x,), height, number in marks:
            _mark(axes, x, height, number)
        _name_failures(axes, fails)
        return
    point = [at[side.name] for side in sides if side.name in at]
    _plane(part, sides, target, [x.ravel() for x in grid], values, title, point)
    space, flat = part.axes[:2]
    for (y, x), height, number in marks:
        space.plot(y, x, height, "X", **_FAILS, zorder=10)
        _mark(flat, x, y, number)
    _name_failures(flat, fails)


def _marks(
    rulebase: RuleBase,
    output: Output,
    fails: Sequence[Verdict],
    names: Sequence[str],
    fixed: Mapping[str, float],
) -> list[tuple[list[float], float, int]]:
    """Return where properties fail on what is drawn, the output there, and which property."""
    import numpy as np

    found = []
    every = [(point, k) for k, each in enumerate(fails, start=1) for point in each.points]
    for point, number in every:
        if any(point[name] != x for name, x in fixed.items()):
            continue
        inputs = {name: np.array([x]) for name, x in point.items()}
        value = float(np.ravel(_with_gaps(rulebase, output, inputs))[0])
        height = value if math.isfinite(value) else output.low
        found.append(([point[name] for name in names], height, number))
    return found


def _mark(axes: Axes, x: float, y: float, number: int) -> None:
    axes.plot(x, y, "X", clip_on=False, **_FAILS)
    axes.annotate(
        str(number), (x, y), (6, 4), textcoords="offset points", fontsize=8, color=_FAILS["color"]
    )


def _name_failures(axes: Axes, fails: Sequence[Verdict]) -> None:
    if fails:
        words = "\n".join(
            f"{number} refuted: {each.statement}" for number, each in enumerate(fails, start=1)
        )
        axes.annotate(
            safe(words), (0.0, -0.2), xycoords="axes fraction", fontsize=8, va="top",
            color=_FAILS["color"], annotation_clip=False,
        )  # fmt: skip


def _with_gaps(rulebase: RuleBase, output: Output, inputs: Mapping[str, Any]) -> Any:
    """Return the inference, NaN where no rule fires and the file states no value for that."""
    from fuzzyarm.inference import infer

    if not isinstance(output.no_rule, str):
        return infer(rulebase, inputs)[output.name]
    gaps = tuple(replace(o, no_rule=math.nan) if o is output else o for o in rulebase.outputs)
    held = {o.name: 0.5 * (o.low + o.high) for o in gaps if o.no_rule == "hold"}
    return infer(replace(rulebase, outputs=gaps), inputs, held=held)[output.name]


def _free_and_fixed(
    rulebase: RuleBase, at: Mapping[str, float]
) -> tuple[list[Variable], dict[str, float]]:
    variables: list[Variable] = list(rulebase.inputs)
    if len(variables) <= 2:
        return variables, {}
    free = [variable for variable in variables if variable.name not in at][:2]
    for variable in variables:  # all are named: the first two vary all the same
        if len(free) < 2 and variable not in free:
            free.append(variable)
    free.sort(key=variables.index)
    fixed = {}
    for variable in variables:
        if variable not in free:
            low, high = visible_range(variable)
            fixed[variable.name] = at.get(variable.name, 0.5 * (low + high))
    return free, fixed


def _fixed_words(fixed: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {number_words(x, 4)}" for name, x in fixed.items())


def table_figure(table: LookupTable, at: Mapping[str, float] | None = None) -> Figure:
    """Return a lookup table as steps (one input) or as a map of its cells with their levels.

    Parameters
    ----------
    table : LookupTable
        With more than two inputs the page nearest to `at` (or the middle one) is drawn.
    at : mapping of str to float, optional
        A point to mark.
    """
    at = at or {}
    sides = [_Side(a.name, a.description, a.low, a.high) for a in table.axes]
    reach = [float(table.values.min()), float(table.values.max())]
    low = table.low if table.low is not None and math.isfinite(table.low) else reach[0]
    high = table.high if table.high is not None and math.isfinite(table.high) else reach[1]
    target = _Side(table.output, table.description, low, high)
    if len(sides) == 1:
        return _table_line(table, sides[0], target, at)
    pages = table.axes[:-2]
    index = tuple(a.cell(at.get(a.name, a.levels[len(a.levels) // 2]), "nearest") for a in pages)
    fixed = {a.name: a.levels[i] for a, i in zip(pages, index, strict=True)}
    size = max(len(table.axes[-1].levels), len(table.axes[-2].levels))
    figure = new_figure(6.8, 5.6) if size > 9 else new_figure(6.0, 4.6)
    point = [at[side.name] for side in sides[-2:] if side.name in at]
    _cells(figure, table, sides[-2:], target, table.values[index], _fixed_words(fixed), point)
    return figure


def _table_line(table: LookupTable, side: _Side, target: _Side, at: Mapping[str, float]) -> Figure:
    import numpy as np

    figure = new_figure(6.4, 3.9)
    xs = np.linspace(
        min(side.low, table.axes[0].levels[0]), max(side.high, table.axes[0].levels[-1]), 2001
    )
    axes = figure.subplots()
    _line(axes, side, target, xs, table.lookup(xs), f"looked up by {table.default_mode}")
    if len(table.axes[0].levels) <= 60:
        axes.plot(table.axes[0].levels, table.values, "o", color=COLOURS[3], markersize=4)
    if side.name in at:
        axes.axvline(at[side.name], color="#111111", linewidth=1)
    return figure


def _line(axes: Axes, side: _Side, target: _Side, xs: Any, values: Any, title: str) -> None:
    axes.plot(xs, values, color=COLOURS[0], linewidth=1.8)
    tidy(axes)
    label_axes(axes, side.label, target.label, title)
    set_range(axes, side.low, side.high)


def _plane(
    part: Any,
    sides: list[_Side],
    target: _Side,
    points: list[Any],
    values: Any,
    title: str,
    at: list[float],
) -> None:
    """Draw a surface in space on the left, its map with contour lines on the right."""
    from matplotlib.ticker import MaxNLocator

    least, most = _ends(values)
    scale = scale_of([least, most])
    limits = {"cmap": colour_map(scale), "vmin": scale.low, "vmax": scale.high}
    grid = part.add_gridspec(1, 2, width_ratios=[1.15, 1.0])
    space = part.add_subplot(grid[0], projection="3d")
    rows, columns = points
    y, x = rows[:, None], columns[None, :]
    space.plot_surface(
        y + 0 * x, x + 0 * y, values, rcount=41, ccount=41, linewidth=0.15, edgecolor="#00000055",
        antialiased=True, **limits,
    )  # fmt: skip
    space.view_init(elev=28, azim=-128)
    label_axes(space, safe(sides[0].name), safe(sides[1].name))
    space.set_zlabel(safe(target.name), fontsize=9)
    space.tick_params(labelsize=7, pad=0)
    for axis in (space.xaxis, space.yaxis, space.zaxis):
        axis.set_major_locator(MaxNLocator(5))
    space.set_box_aspect((1, 1, 0.8), zoom=0.94)
    flat = part.add_subplot(grid[1])
    image = flat.pcolormesh(
        columns,
        rows,
        values,
        shading="nearest" if _has_gaps(values) else "gouraud",
        rasterized=True,
        **limits,
    )
    if most - least > 1e-12:
        lines = flat.contour(columns, rows, values, levels=9, colors="#222222", linewidths=0.6)
        flat.clabel(lines, fontsize=7, inline_spacing=2)
    if len(at) == 2:
        flat.plot(at[1], at[0], "o", markersize=8, color="white", markeredgecolor="black")
    flat.tick_params(labelsize=8)
    colour_bar(part, image, flat, target.label, shrink=0.95)
    label_axes(flat, sides[1].label, sides[0].label, title)


def _has_gaps(values: Any) -> bool:
    import numpy as np

    return bool(np.isnan(values).any())


def _ends(values: Any) -> tuple[float, float]:
    """Return the least and the largest value; 0 and 0 where there is none."""
    import numpy as np

    sound = values[np.isfinite(values)]
    return (float(sound.min()), float(sound.max())) if sound.size else (0.0, 0.0)


def _cells(
    figure: Figure,
    table: LookupTable,
    sides: list[_Side],
    target: _Side,
    values: Any,
    title: str,
    at: list[float],
) -> None:
    """Draw the cells of a table as it stands in a file: first row on top, all cells alike."""
    scale = scale_of([float(values.min()), float(values.max())], target.low, target.high)
    axes = figure.subplots()
    image = axes.imshow(
        values, cmap=colour_map(scale), vmin=scale.low, vmax=scale.high, aspect="auto"
    )
    for axis, drawn in ((table.axes[-2], axes.yaxis), (table.axes[-1], axes.xaxis)):
        step = max(1, math.ceil(len(axis.levels) / 16))
        chosen = range(0, len(axis.levels), step)
        drawn.set_ticks(list(chosen), [number_words(axis.levels[i], 4) for i in chosen])
    if max(values.shape) <= 17:
        flat = [float(x) for x in values.ravel()]
        texts = column_of_numbers([float(number_words(x, 4)) for x in flat])
        for k, (text, value) in enumerate(zip(texts, flat, strict=True)):
            i, j = divmod(k, values.shape[1])
            ink = scale.ink(value)
            axes.text(j, i, text, ha="center", va="center", fontsize=7, color=ink)
    if len(at) == 2:
        i, j = (a.cell(x, table.default_mode) for a, x in zip(table.axes[-2:], at, strict=True))
        axes.plot(j, i, "s", markersize=22, fillstyle="none", color="black", markeredgewidth=2)
    label_axes(axes, sides[1].label, sides[0].label, title)
    axes.xaxis.set_label_position("top")
    axes.xaxis.tick_top()
    axes.tick_params(labelsize=8, length=0)
    axes.spines[:].set_visible(False)
    bar = colour_bar(figure, image, axes, target.label, shrink=0.9)
    bar.outline.set_visible(False)
