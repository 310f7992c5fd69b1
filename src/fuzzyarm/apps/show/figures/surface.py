"""Outputs over inputs: a line, a surface, or slices through more inputs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.show.cells import table_panel
from fuzzyarm.apps.show.drawing import number_words, scale_of
from fuzzyarm.apps.show.figures.labels import shortened, text_width, thin_ticks, wrapped
from fuzzyarm.apps.show.figures.style import (
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
from fuzzyarm.apps.show.response import Response
from fuzzyarm.apps.show.terms import visible_range
from fuzzyarm.base.numbers import column_of_numbers
from fuzzyarm.base.picture import COLOURS, Axis, Cells, Dots, Level, Line, Panel
from fuzzyarm.language.model.rulebase import AnyRuleBase, Variable, model_of
from fuzzyarm.language.model.shapes import corner_points

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.proof.map import Verdict
    from fuzzyarm.table import LookupTable


_LINE = 601
_PLANE = 121
"""Samples of a line, and along each side of a surface; fewer if evaluation is slow."""

_FEWEST = 31
_SECONDS = 4.0
"""Fewest samples along a side, and the approximate time limit in seconds."""

_SPACE = 41
"""Meshes along each side of a 3-D surface."""

_MOST_NUMBERS = 17
"""Most rows or columns of a table with numbers in its cells."""


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
        A line for one input; a surface and its map for two; a slice over two of them for more.
    output : str, optional
        The only output to draw.
    at : mapping of str to float, optional
        With more than two inputs, the values of the fixed ones (the middle of the range by
        default); the first two other inputs are drawn. With two or fewer, a point to mark.
    fails : sequence of Verdict
        Refuted properties, whose counterexamples are marked.
    """
    rulebase = model_of(rulebase)
    outputs = [rulebase.output(output)] if output else list(rulebase.outputs)
    responses = [ResponseFigure(Response(rulebase, target, at or {}, fails)) for target in outputs]
    heights = [response.height for response in responses]
    figure = new_figure(max(response.width for response in responses), sum(heights))
    parts = figure.subfigures(len(outputs), 1, height_ratios=heights, squeeze=False)[:, 0]
    for part, response in zip(parts, responses, strict=True):
        response.draw(part)
    return figure


class ResponseFigure:
    """A response in a figure, with its size.

    Parameters
    ----------
    response : Response
        The response to draw.
    """

    def __init__(self, response: Response) -> None:
        self.response = response

    @property
    def width(self) -> float:
        """Width of its picture in inches."""
        return 6.4 if self.response.is_line else 9.6

    @property
    def height(self) -> float:
        """Height of its picture in inches."""
        return 3.6 if self.response.is_line else 4.3

    def draw(self, part: Any) -> None:
        """Draw it into a figure or a part of one."""
        response = self.response
        count = self._count()
        panel = response.panel(
            [_points(variable, count, edges=response.is_line) for variable in response.free]
        )
        curve = panel.parts[0]
        values = curve.values if isinstance(curve, Cells) else curve.y  # type: ignore[union-attr]
        notes = [panel.title, "blank: no rule fires" if _has_gaps(values) else ""]
        title = "\n".join(wrapped(note, LABEL, 0.42 * self.width) for note in notes if note)
        failures = response.failures()
        if isinstance(curve, Cells):
            _plane(part, panel, curve, title)
            space, flat = part.axes[:2]
            for failure in failures:
                y, x = failure.point
                space.plot(y, x, failure.height, "X", **_FAILS, zorder=10)
                _mark(flat, x, y, failure.number)
        else:
            flat = part.subplots()
            _line(flat, panel, title)
            for failure in failures:
                _mark(flat, failure.point[0], failure.height, failure.number)
        _name_failures(flat, response.fails)

    def _count(self) -> int:
        """Return the number of even samples along a side."""
        from fuzzyarm.inference.effort import points_within

        part = self.response.part
        if self.response.is_line:
            return points_within(part, _SECONDS, least=_FEWEST, most=_LINE)
        return math.isqrt(points_within(part, _SECONDS, least=_FEWEST**2, most=_PLANE**2))


def _points(variable: Variable, count: int, *, edges: bool) -> Any:
    """Return samples of a variable: even ones and bends of its terms, with `edges` both sides."""
    import numpy as np

    low, high = visible_range(variable)
    bends = {x for term in variable.terms for x in corner_points(term.shape) if low < x < high}
    positions = [*np.linspace(low, high, count), *bends]
    if edges:
        positions += [math.nextafter(x, end) for x in bends for end in (-math.inf, math.inf)]
    return np.unique(positions)


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


def table_figure(table: LookupTable, at: Mapping[str, float] | None = None) -> Figure:
    """Return a lookup table as steps (one input) or as a map of its cells with their levels.

    Parameters
    ----------
    table : LookupTable
        With more than two inputs the page nearest to `at` (or the middle one) is drawn, and the
        title has its number.
    at : mapping of str to float, optional
        A point to mark.
    """
    picture = TablePicture(table, at or {})
    figure = new_figure(picture.width, picture.height)
    picture.draw(figure)
    return figure


class TablePicture:
    """A lookup table in a figure, with its size.

    Parameters
    ----------
    table : LookupTable
        The table to draw.
    at : mapping of str to float
        A point to mark; with more than two inputs it selects the page.
    """

    def __init__(self, table: LookupTable, at: Mapping[str, float]) -> None:
        self._table, self._at = table, at
        self._panel = table_panel(table, at)
        cells = self._panel.parts[0]
        self._cells = cells if isinstance(cells, Cells) else None
        if self._cells is None:
            return
        values = self._cells.values
        self._texts = _cell_texts(values)
        cell = max(text_width(text, 7) for text in self._texts) + 0.09 if self._texts else 0.0
        small = max(values.shape) <= 9
        self._room = max(cell * values.shape[1], 4.0 if small else 4.6), 3.4 if small else 4.4

    @property
    def width(self) -> float:
        """Width of its picture in inches."""
        return 6.4 if self._cells is None else self._room[0] + 2.0

    @property
    def height(self) -> float:
        """Height of its picture in inches."""
        return 3.9 if self._cells is None else self._room[1] + 1.2

    def draw(self, part: Any) -> None:
        """Draw it into a figure or a part of one."""
        panel, cells, axes = self._panel, self._cells, part.subplots()
        if cells is None:
            _table_line(axes, self._table, panel, self._at)
            return
        width, height = self._room
        image = _cells(axes, panel, cells, (self._table.low, self._table.high), self._texts)
        for levels, ticks, room in ((cells.y, axes.yaxis, height), (cells.x, axes.xaxis, width)):
            thin_ticks(ticks, [number_words(x, 4) for x in levels], room, 8)
        across, up = (axis_label(axis.name, axis.about) for axis in (panel.across, panel.up))
        label_axes(axes, across, up, wrapped(panel.title, LABEL, width))
        label = axis_label(cells.value.name, cells.value.about)
        bar = colour_bar(part, image, axes, label, shrink=0.9)
        bar.outline.set_visible(False)


def _cell_texts(values: Any) -> list[str]:
    """Return the numbers in cells, row by row; none if there are too many cells."""
    if max(values.shape) > _MOST_NUMBERS:
        return []
    return column_of_numbers([float(number_words(float(x), 4)) for x in values.ravel()])


def _table_line(axes: Axes, table: LookupTable, panel: Panel, at: Mapping[str, float]) -> None:
    """Draw the lookup between the levels of a table, and its levels as dots."""
    import numpy as np

    levels, (low, high) = table.axes[0].levels, table.axes[0].ends
    xs = np.linspace(min(low, levels[0]), max(high, levels[-1]), 2001)
    marks = [part for part in panel.parts if isinstance(part, Level)]
    line = Line(xs, table.lookup(xs), "first", 1.8)
    _line(axes, replace(panel, parts=[line]), f"looked up by {table.default_mode}")
    if len(levels) <= 60:
        axes.plot(levels, table.values, "o", color=COLOURS[3], markersize=4)
    for mark in marks:
        axes.axvline(mark.at, color="#111111", linewidth=1)


def _line(axes: Axes, panel: Panel, title: str) -> None:
    for part in panel.parts:
        if isinstance(part, Line):
            axes.plot(part.x, part.y, color=COLOURS[0], linewidth=part.width)
    tidy(axes)
    across, up = (axis_label(axis.name, axis.about) for axis in (panel.across, panel.up))
    label_axes(axes, across, up, title)
    set_range(axes, *ends_of(panel.across))
    for part in panel.parts:
        if isinstance(part, Level):
            axes.axvline(part.at, color="#111111", linewidth=1)


def _plane(part: Any, panel: Panel, cells: Cells, title: str) -> None:
    """Draw a 3-D surface on the left, its map with contour lines on the right."""
    import numpy as np
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    values = without_noise(cells.values)
    least, most = _ends(values)
    scale = scale_of([least, most])
    limits = {"cmap": colour_map(scale), "vmin": scale.low, "vmax": scale.high}
    grid = part.add_gridspec(1, 2, width_ratios=[1.15, 1.0])
    space = part.add_subplot(grid[0], projection="3d")
    rows, columns = cells.y, cells.x
    y, x = np.asarray(rows)[:, None], np.asarray(columns)[None, :]
    indices = [_meshes(rows, panel.up), _meshes(columns, panel.across)]
    mesh = np.ix_(*indices)
    space.plot_surface(
        (y + 0 * x)[mesh], (x + 0 * y)[mesh], values[mesh], rstride=1, cstride=1,
        linewidth=0.15, edgecolor="#00000055", antialiased=True, **limits,
    )  # fmt: skip
    space.view_init(elev=28, azim=-128)
    axes = (panel.up, panel.across, cells.value)
    names = [safe(shortened(axis.name, LABEL, 1.0)) for axis in axes]
    label_axes(space, names[0], names[1])
    space.set_zlabel(names[2], fontsize=LABEL)
    space.zaxis.set_rotate_label(False)  # matplotlib's default is downwards
    space.zaxis.label.set_rotation(90)  # horizontal text would leave the figure
    space.zaxis.labelpad = 0.0  # with more of it, the label leaves a subfigure
    for axis, name in zip((space.xaxis, space.yaxis), names, strict=False):
        axis.labelpad = 4.0 + 12.0 * text_width(
            name, LABEL
        )  # space between long names and the numbers
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
    if most > least:
        lines = flat.contour(columns, rows, values, levels=9, colors="#222222", linewidths=0.6)
        _name_lines(flat, lines)
    for mark in _marks(panel):
        flat.plot(mark.x[0], mark.y[0], "o", markersize=8, color="white", markeredgecolor="black")
    flat.tick_params(labelsize=8)
    short_numbers(flat.xaxis)
    short_numbers(flat.yaxis)
    up, across, value = (axis_label(axis.name, axis.about) for axis in axes)
    colour_bar(part, image, flat, value, shrink=0.95)
    label_axes(flat, across, up, title)


def _marks(panel: Panel) -> list[Dots]:
    return [part for part in panel.parts if isinstance(part, Dots) and part.sign == "o"]


def ends_of(axis: Axis) -> tuple[float, float]:
    """Return both ends of an axis."""
    assert axis.low is not None
    assert axis.high is not None
    return axis.low, axis.high


def _has_gaps(values: Any) -> bool:
    import numpy as np

    return bool(np.isnan(values).any())


def _ends(values: Any) -> tuple[float, float]:
    """Return the least and greatest value; 0 and 0 without values."""
    import numpy as np

    sound = values[np.isfinite(values)]
    return (float(sound.min()), float(sound.max())) if sound.size else (0.0, 0.0)


def without_noise(values: Any) -> Any:
    """Round values to a millionth of their range, beyond the resolution of a picture.

    Otherwise rounding noise would draw contour lines across a plateau.
    """
    import numpy as np

    least, most = _ends(values)
    size = max(most - least, 1e-6 * max(abs(least), abs(most)))
    return np.round(values, 6 - math.floor(math.log10(size))) if size else values


def _cells(
    axes: Axes,
    panel: Panel,
    cells: Cells,
    ends: tuple[float | None, float | None],
    texts: Sequence[str],
) -> Any:
    """Draw the cells of a table as in its file: first row on top, all cells of equal size."""
    values = cells.values
    scale = scale_of([float(values.min()), float(values.max())], *ends)
    image = axes.imshow(
        values, cmap=colour_map(scale), vmin=scale.low, vmax=scale.high, aspect="auto"
    )
    for k, text in enumerate(texts):
        i, j = divmod(k, values.shape[1])
        ink = scale.ink(float(values[i, j]))
        axes.text(j, i, text, ha="center", va="center", fontsize=7, color=ink)
    for mark in _marks(panel):
        j, i = list(cells.x).index(mark.x[0]), list(cells.y).index(mark.y[0])
        axes.plot(j, i, "s", markersize=22, fillstyle="none", color="black", markeredgewidth=2)
    axes.xaxis.set_label_position("top")
    axes.xaxis.tick_top()
    axes.tick_params(labelsize=8, length=0)
    axes.spines[:].set_visible(False)
    return image


def _short(x: float) -> str:
    return f"{x + 0.0:.3g}".replace("e+0", "e").replace("e-0", "e-")


def _meshes(points: Any, axis: Axis) -> Any:
    """Return the indices of a 3-D surface's meshes: even ones, and the bends between them."""
    import numpy as np

    ends = ends_of(axis)
    even = np.linspace(*ends, _SPACE)
    regular = np.linspace(*ends, _PLANE)
    bends = np.flatnonzero(~np.isin(points, regular))
    # Very many bends are no better than even meshes, but slow.
    bends = bends if bends.size <= _SPACE else bends[:0]
    return np.unique([*np.abs(points[:, None] - even).argmin(axis=0), *bends])


def _name_lines(axes: Axes, lines: Any) -> None:
    """Label contour lines without overlaps, and not on a cliff, where several levels meet."""
    from matplotlib.patheffects import withStroke

    circles: list[tuple[float, float, float]] = []
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    # Approximate size of the axes in inches.
    scale = 3.0 / (right - left), 3.3 / (top - bottom)
    levels = [_segments(path, scale) for path in lines.get_paths()]
    for text in axes.clabel(lines, fontsize=7, inline=False, fmt=_short):
        across, up = text.get_position()
        reach = 0.5 * text_width(text.get_text(), 7) + 0.03
        x, y = scale[0] * across, scale[1] * up
        inside = (
            scale[0] * left + reach <= x <= scale[0] * right - reach
            and scale[1] * bottom + reach <= y <= scale[1] * top - reach
        )
        free = all(math.hypot(x - a, y - b) >= reach + other for a, b, other in circles)
        alone = sum(_comes_near(segments, (x, y)) for segments in levels) <= 1
        if not (inside and free and alone):
            text.remove()
            continue
        circles.append((x, y, reach))
        text.set_path_effects([withStroke(linewidth=1.5, foreground="#ffffffaa")])


_CLIFF = 0.06
"""Distance of lines of two levels, in inches, below which there is no room for a label."""


def _segments(path: Any, scale: tuple[float, float]) -> Any:
    """Return start and end points of the segments of a contour line, in inches."""
    import numpy as np

    parts = [np.multiply(line, scale) for line in path.to_polygons(closed_only=False)]
    pairs = [np.stack([line[:-1], line[1:]]) for line in parts]
    return np.concatenate(pairs, axis=1) if pairs else np.empty((2, 0, 2))


def _comes_near(segments: Any, point: tuple[float, float]) -> bool:
    """Return whether a segment is nearer to a point than `_CLIFF`."""
    import numpy as np

    begin, step = segments[0], segments[1] - segments[0]
    length = np.maximum((step * step).sum(axis=1), 1e-300)
    share = np.clip(((point - begin) * step).sum(axis=1) / length, 0.0, 1.0)
    gap = begin + share[:, None] * step - point
    return bool((np.hypot(gap[:, 0], gap[:, 1]) < _CLIFF).any())
