"""What comes out over what goes in: a line, a surface, or slices through more inputs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.model.rulebase import AnyRuleBase, Output, RuleBase, Variable
from fuzzyarm.model.shapes import corner_points
from fuzzyarm.picture import COLOURS
from fuzzyarm.show.drawing import number_words, scale_of
from fuzzyarm.show.figures.labels import shortened, text_width, thin_ticks, wrapped
from fuzzyarm.show.figures.style import (
    LABEL,
    axis_label,
    colour_bar,
    colour_map,
    label_axes,
    new_figure,
    safe,
    set_range,
    short_numbers,
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
"""Points of a line, and along each side of a surface; fewer where each takes long."""

_FEWEST = 31
_SECONDS = 4.0
"""Points along a side, and what all of them may take, roughly."""

_SPACE = 41
"""Meshes along each side of a surface in space."""

_MOST_NUMBERS = 17
"""Rows or columns of a table up to which its cells have numbers."""


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
    rulebase: AnyRuleBase,
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
    rulebase = rulebase.model
    outputs = [rulebase.output(output)] if output else list(rulebase.outputs)
    responses = [Response(rulebase, target, at or {}, fails) for target in outputs]
    heights = [each.height for each in responses]
    figure = new_figure(max(each.width for each in responses), sum(heights))
    parts = figure.subfigures(len(outputs), 1, height_ratios=heights, squeeze=False)[:, 0]
    for part, response in zip(parts, responses, strict=True):
        response.draw(part)
    return figure


class Response:
    """One output of a rule base over the inputs that it depends on.

    Parameters
    ----------
    rulebase : RuleBase
        Whose output.
    output : Output
        What is drawn.
    at : mapping of str to float
        Values of inputs: held fixed, or marked.
    fails : sequence of Verdict
        On properties that fail, of any output.
    """

    def __init__(
        self,
        rulebase: RuleBase,
        output: Output,
        at: Mapping[str, float],
        fails: Sequence[Verdict] = (),
    ) -> None:
        from fuzzyarm.inference.plan import part_for

        inputs = part_for(rulebase, [output.name]).inputs or rulebase.inputs
        self._rulebase, self._output = rulebase, output
        self._fails = [
            verdict for verdict in fails if verdict.output == output.name and verdict.points
        ]
        hidden = [variable.name for variable in inputs[2:]]
        if self._fails and hidden and not at:  # the slice that has the first of them
            at = {name: self._fails[0].points[0][name] for name in hidden}
        self._at = {each.name: at[each.name] for each in inputs if each.name in at}
        self._free, self._fixed = _free_and_fixed(inputs, self._at)

    @property
    def width(self) -> float:
        """Of its picture, inches."""
        return 6.4 if len(self._free) == 1 else 9.6

    @property
    def height(self) -> float:
        """Of its picture, inches."""
        return 3.6 if len(self._free) == 1 else 4.3

    def draw(self, part: Any) -> None:
        """Draw it into a figure or a part of one."""
        import numpy as np

        sides = [_Side(v.name, v.description, *visible_range(v)) for v in self._free]
        target = _Side(
            self._output.name, self._output.description, self._output.low, self._output.high
        )
        line = len(sides) == 1
        count = self._count(line=line)
        points = [_points(variable, count, edges=line) for variable in self._free]
        grid = np.ix_(*points)
        inputs = {
            **self._fixed,
            **{side.name: values for side, values in zip(sides, grid, strict=True)},
        }
        found = with_gaps(self._rulebase, self._output, inputs)
        values = np.broadcast_to(found, [point.size for point in points])
        notes = [_fixed_words(self._fixed), "blank: no rule fires" if _has_gaps(values) else ""]
        title = "\n".join(wrapped(note, LABEL, 0.42 * self.width) for note in notes if note)
        if line:
            axes = part.subplots()
            _line(axes, sides[0], target, points[0], values, title)
            if sides[0].name in self._at:
                axes.axvline(self._at[sides[0].name], color="#111111", linewidth=1)
            for (x,), height, number in self._failures():
                _mark(axes, x, height, number)
            _name_failures(axes, self._fails)
            return
        marks = [self._at[side.name] for side in sides if side.name in self._at]
        _plane(part, sides, target, points, values, title, marks)
        space, flat = part.axes[:2]
        for (y, x), height, number in self._failures():
            space.plot(y, x, height, "X", **_FAILS, zorder=10)
            _mark(flat, x, y, number)
        _name_failures(flat, self._fails)

    def _count(self, *, line: bool) -> int:
        """Return how many even points there are along a side."""
        from fuzzyarm.inference.effort import points_within
        from fuzzyarm.inference.plan import part_for

        part = part_for(self._rulebase, [self._output.name])
        if line:
            return points_within(part, _SECONDS, least=_FEWEST, most=_LINE)
        return math.isqrt(points_within(part, _SECONDS, least=_FEWEST**2, most=_PLANE**2))

    def _failures(self) -> list[tuple[list[float], float, int]]:
        """Return where properties fail on what is drawn, the output there, and which property."""
        import numpy as np

        names, found = [variable.name for variable in self._free], []
        every = [(point, k) for k, verdict in enumerate(self._fails, 1) for point in verdict.points]
        for point, number in every:
            if any(point[name] != x for name, x in self._fixed.items()):
                continue
            inputs = {name: np.array([point[name]]) for name in (*names, *self._fixed)}
            value = float(np.ravel(with_gaps(self._rulebase, self._output, inputs))[0])
            height = value if math.isfinite(value) else self._output.low
            found.append(([point[name] for name in names], height, number))
        return found


def _points(variable: Variable, count: int, *, edges: bool) -> Any:
    """Return where a variable is sampled: evenly, and where its terms bend.

    With `edges` on both sides of these points, so that a step is drawn upright.
    """
    import numpy as np

    low, high = visible_range(variable)
    bends = {x for term in variable.terms for x in corner_points(term.shape) if low < x < high}
    found = [*np.linspace(low, high, count), *bends]
    if edges:
        found += [math.nextafter(x, end) for x in bends for end in (-math.inf, math.inf)]
    return np.unique(found)


def _mark(axes: Axes, x: float, y: float, number: int) -> None:
    axes.plot(x, y, "X", clip_on=False, **_FAILS)
    axes.annotate(
        str(number), (x, y), (6, 4), textcoords="offset points", fontsize=8, color=_FAILS["color"]
    )


def _name_failures(axes: Axes, fails: Sequence[Verdict]) -> None:
    if fails:
        words = "\n".join(
            f"{number} refuted: {verdict.statement}"
            for number, verdict in enumerate(fails, start=1)
        )
        axes.annotate(
            safe(words), (0.0, -0.2), xycoords="axes fraction", fontsize=8, va="top",
            color=_FAILS["color"], annotation_clip=False,
        )  # fmt: skip


def with_gaps(rulebase: RuleBase, output: Output, inputs: Mapping[str, Any]) -> Any:
    """Return the inference, NaN where no rule fires and the file states no value for that."""
    from fuzzyarm.inference import infer

    if not isinstance(output.no_rule, str):
        return infer(rulebase, inputs, outputs=[output.name])[output.name]
    gaps = tuple(replace(o, no_rule=math.nan) if o is output else o for o in rulebase.outputs)
    held = {o.name: 0.5 * (o.low + o.high) for o in gaps if o.no_rule == "hold"}
    model = replace(rulebase, outputs=gaps)
    return infer(model, inputs, held=held, outputs=[output.name])[output.name]


def _free_and_fixed(
    inputs: Sequence[Variable], at: Mapping[str, float]
) -> tuple[list[Variable], dict[str, float]]:
    if len(inputs) <= 2:
        return list(inputs), {}
    free = [variable for variable in inputs if variable.name not in at][:2]
    for variable in inputs:  # all are named: the first two vary all the same
        if len(free) < 2 and variable not in free:
            free.append(variable)
    free.sort(key=inputs.index)
    fixed = {}
    for variable in inputs:
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
        With more than two inputs the page nearest to `at` (or the middle one) is drawn, and
        the title says which of how many it is.
    at : mapping of str to float, optional
        A point to mark.
    """
    picture = TablePicture(table, at or {})
    figure = new_figure(picture.width, picture.height)
    picture.draw(figure)
    return figure


class TablePicture:
    """A lookup table, and how large its picture is.

    Parameters
    ----------
    table : LookupTable
        What is drawn.
    at : mapping of str to float
        A point to mark; of more than two inputs it chooses the page.
    """

    def __init__(self, table: LookupTable, at: Mapping[str, float]) -> None:
        self._table, self._at = table, at
        self._sides = [_Side(a.name, a.description, *a.ends) for a in table.axes]
        if len(self._sides) == 1:
            return
        pages = table.axes[:-2]
        self._index = tuple(
            a.cell(at.get(a.name, a.levels[len(a.levels) // 2]), "nearest") for a in pages
        )
        self._values = table.values[self._index]
        self._texts = _cell_texts(self._values)
        cell = max(text_width(text, 7) for text in self._texts) + 0.09 if self._texts else 0.0
        small = max(self._values.shape) <= 9
        self._room = max(cell * self._values.shape[1], 4.0 if small else 4.6), 3.4 if small else 4.4

    @property
    def width(self) -> float:
        """Of its picture, inches."""
        return 6.4 if len(self._sides) == 1 else self._room[0] + 2.0

    @property
    def height(self) -> float:
        """Of its picture, inches."""
        return 3.9 if len(self._sides) == 1 else self._room[1] + 1.2

    def draw(self, part: Any) -> None:
        """Draw it into a figure or a part of one."""
        table, sides, at = self._table, self._sides, self._at
        target = _Side(table.output, table.description, *table.reach)
        axes = part.subplots()
        if len(sides) == 1:
            _table_line(axes, table, sides[0], target, at)
            return
        fixed = {a.name: a.levels[i] for a, i in zip(table.axes[:-2], self._index, strict=True)}
        width, height = self._room
        marks = [at[side.name] for side in sides[-2:] if side.name in at]
        image = _cells(axes, table, self._values, self._texts, marks)
        for axis, drawn, room in (
            (table.axes[-2], axes.yaxis, height),
            (table.axes[-1], axes.xaxis, width),
        ):
            thin_ticks(drawn, [number_words(x, 4) for x in axis.levels], room, 8)
        title = wrapped(_page_words(table, self._index, fixed), LABEL, width)
        label_axes(axes, sides[-1].label, sides[-2].label, title)
        bar = colour_bar(part, image, axes, target.label, shrink=0.9)
        bar.outline.set_visible(False)


def _page_words(table: LookupTable, index: tuple[int, ...], fixed: Mapping[str, float]) -> str:
    """Say which page of a table is drawn, and how to see the others."""
    pages = table.shape[:-2]
    if math.prod(pages) <= 1:
        return _fixed_words(fixed)
    number = 0
    for size, position in zip(pages, index, strict=True):
        number = number * size + position
    others = ",".join(f"{name}=…" for name in fixed)
    count = math.prod(pages)
    return f"{_fixed_words(fixed)}: page {number + 1} of {count}; --at {others} draws another"


def _cell_texts(values: Any) -> list[str]:
    """Return the numbers of cells, row by row; none where the cells are too many to be read."""
    if max(values.shape) > _MOST_NUMBERS:
        return []
    return column_of_numbers([float(number_words(float(x), 4)) for x in values.ravel()])


def _table_line(
    axes: Axes, table: LookupTable, side: _Side, target: _Side, at: Mapping[str, float]
) -> None:
    import numpy as np

    xs = np.linspace(
        min(side.low, table.axes[0].levels[0]), max(side.high, table.axes[0].levels[-1]), 2001
    )
    _line(axes, side, target, xs, table.lookup(xs), f"looked up by {table.default_mode}")
    if len(table.axes[0].levels) <= 60:
        axes.plot(table.axes[0].levels, table.values, "o", color=COLOURS[3], markersize=4)
    if side.name in at:
        axes.axvline(at[side.name], color="#111111", linewidth=1)


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
    import numpy as np
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    least, most = _ends(values)
    scale = scale_of([least, most])
    limits = {"cmap": colour_map(scale), "vmin": scale.low, "vmax": scale.high}
    grid = part.add_gridspec(1, 2, width_ratios=[1.15, 1.0])
    space = part.add_subplot(grid[0], projection="3d")
    rows, columns = points
    y, x = rows[:, None], columns[None, :]
    chosen = [_meshes(points[k], side) for k, side in enumerate(sides)]
    mesh = np.ix_(*chosen)
    space.plot_surface(
        (y + 0 * x)[mesh], (x + 0 * y)[mesh], values[mesh], rstride=1, cstride=1,
        linewidth=0.15, edgecolor="#00000055", antialiased=True, **limits,
    )  # fmt: skip
    space.view_init(elev=28, azim=-128)
    names = [safe(shortened(side.name, LABEL, 1.0)) for side in (*sides, target)]
    label_axes(space, names[0], names[1])
    space.set_zlabel(names[2], fontsize=LABEL)
    space.zaxis.set_rotate_label(False)  # matplotlib would write it from the top down
    space.zaxis.label.set_rotation(90 if len(names[2]) > 4 else 0)
    for axis, name in zip((space.xaxis, space.yaxis), names, strict=False):
        axis.labelpad = 4.0 + 12.0 * text_width(name, LABEL)  # long names stand clear of numbers
    space.tick_params(labelsize=7, pad=0)
    for axis in (space.xaxis, space.yaxis, space.zaxis):
        axis.set_major_locator(MaxNLocator(5))
        axis.set_major_formatter(FuncFormatter(lambda x, _: _short(x)))
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
        _name_lines(flat, lines)
    if len(at) == 2:
        flat.plot(at[1], at[0], "o", markersize=8, color="white", markeredgecolor="black")
    flat.tick_params(labelsize=8)
    short_numbers(flat.xaxis)
    short_numbers(flat.yaxis)
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
    axes: Axes, table: LookupTable, values: Any, texts: Sequence[str], at: Sequence[float]
) -> Any:
    """Draw the cells of a table as it stands in a file: first row on top, all cells alike."""
    low = table.low if table.low is not None and math.isfinite(table.low) else None
    high = table.high if table.high is not None and math.isfinite(table.high) else None
    scale = scale_of([float(values.min()), float(values.max())], low, high)
    image = axes.imshow(
        values, cmap=colour_map(scale), vmin=scale.low, vmax=scale.high, aspect="auto"
    )
    for k, text in enumerate(texts):
        i, j = divmod(k, values.shape[1])
        ink = scale.ink(float(values[i, j]))
        axes.text(j, i, text, ha="center", va="center", fontsize=7, color=ink)
    if len(at) == 2:
        i, j = (a.cell(x, table.default_mode) for a, x in zip(table.axes[-2:], at, strict=True))
        axes.plot(j, i, "s", markersize=22, fillstyle="none", color="black", markeredgewidth=2)
    axes.xaxis.set_label_position("top")
    axes.xaxis.tick_top()
    axes.tick_params(labelsize=8, length=0)
    axes.spines[:].set_visible(False)
    return image


def _short(x: float) -> str:
    return f"{x:.3g}".replace("e+0", "e").replace("e-0", "e-")


def _meshes(points: Any, side: _Side) -> Any:
    """Return the indices of points for a surface in space: even ones, and the bends among them."""
    import numpy as np

    even = np.linspace(side.low, side.high, _SPACE)
    regular = np.linspace(side.low, side.high, _PLANE)
    bends = np.flatnonzero(~np.isin(points, regular))
    # Very many bends are as good as even, and would take long.
    bends = bends if bends.size <= _SPACE else bends[:0]
    return np.unique([*np.abs(points[:, None] - even).argmin(axis=0), *bends])


def _name_lines(axes: Axes, lines: Any) -> None:
    """Write the values on contour lines; of those that would touch each other only the first."""
    from matplotlib.patheffects import withStroke

    taken: list[tuple[float, float, float]] = []
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    for text in axes.clabel(lines, fontsize=7, inline=False, fmt=_short):
        # Round each text lies a circle, in inches of axes that are about this large.
        across, up = text.get_position()
        x, y = 3.0 * (across - left) / (right - left), 3.3 * (up - bottom) / (top - bottom)
        reach = 0.5 * text_width(text.get_text(), 7) + 0.03
        inside = reach <= x <= 3.0 - reach and reach <= y <= 3.3 - reach
        free = all(math.hypot(x - a, y - b) >= reach + other for a, b, other in taken)
        if not (inside and free):
            text.remove()
            continue
        taken.append((x, y, reach))
        text.set_path_effects([withStroke(linewidth=1.5, foreground="#ffffffaa")])
