"""Charts in figures of matplotlib: parts of a picture, panels, a whole chart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from fuzzyarm.apps.show.drawing import scale_of
from fuzzyarm.apps.show.figures.labels import columns_that_fit, shortened, wrapped
from fuzzyarm.apps.show.figures.style import (
    LABEL,
    colour_bar,
    colour_map,
    head,
    label_axes,
    new_figure,
    safe,
    tidy,
)
from fuzzyarm.apps.show.run import run_chart
from fuzzyarm.base.figure_files import plain_powers
from fuzzyarm.base.picture import (
    Area,
    Axis,
    Cells,
    Chart,
    ChartPart,
    Dots,
    Drawing,
    Level,
    Line,
    Panel,
    Part,
    Words,
    colour_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.control.loop import Run

# --- A thing to scale ---


def draw_thing(axes: Axes, drawing: Drawing) -> None:
    """Draw a thing to scale, without axes."""
    left, right, bottom, top = drawing.stage
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal")
    axes.axis("off")
    for part in drawing.parts:
        _draw_thing_part(axes, part)


def _draw_thing_part(axes: Axes, part: Part) -> None:
    from matplotlib.patches import Polygon

    if isinstance(part, Words):
        axes.text(part.x, part.y, safe(part.text), fontsize=part.size)
        return
    colour = colour_of(part.tone)
    if isinstance(part, Line):
        axes.plot(part.x, part.y, color=colour, linewidth=part.width, solid_capstyle="round")
    elif isinstance(part, Area):
        corners = list(zip(part.x, part.y, strict=True))
        axes.add_patch(Polygon(corners, color=colour, linewidth=0))
    else:
        axes.plot(part.x, part.y, part.sign, color=colour, markersize=part.size)


# --- A chart ---

KEY = 8
"""Font size of a key in points."""


def chart_figure(chart: Chart) -> Figure:
    """Return a chart as a figure."""
    figure = new_figure(*chart.size)
    rows, columns = len(chart.rows), max(map(len, chart.rows), default=0)
    if rows and columns:
        places = figure.subplots(rows, columns, squeeze=False, sharex=bool(chart.below))
        room = chart.size[0] / columns, chart.size[1] / rows
        for row, line in zip(places, chart.rows, strict=True):
            if chart.stretched and len(line) == 1:
                _stretch(row)
            for axes, panel in zip(row, [*line, *[None] * (columns - len(line))], strict=True):
                if panel is None:
                    axes.set_visible(False)
                else:
                    draw_panel(axes, panel, room)
        if chart.below:
            for axes in places[-1]:
                axes.set_xlabel(chart.below, fontsize=LABEL)
        if chart.key:
            _key_below(figure, places.ravel(), chart.size[0])
    if chart.title:
        look: dict[str, Any] = {} if chart.heading else {"size": 10, "weight": "normal"}
        head(figure, chart.title, **look)
    return figure


def _stretch(row: Any) -> None:
    """Extend the first panel of a row over the whole row."""
    grid = row[0].get_subplotspec().get_gridspec()
    at = row[0].get_subplotspec().rowspan.start
    row[0].set_subplotspec(grid[at, :])


def _key_below(figure: Figure, places: Any, width: float) -> None:
    """Write a common key, that of the panel with most labels, below all panels."""
    handles, labels = max(
        (axes.get_legend_handles_labels() for axes in places), key=lambda pair: len(pair[1])
    )
    figure.legend(
        handles, labels, fontsize=KEY, frameon=False, loc="outside lower center",
        ncols=columns_that_fit(labels, KEY, width - 0.2),
    )  # fmt: skip


def draw_panel(axes: Axes, panel: Panel, room: tuple[float, float] = (3.4, 3.4)) -> None:
    """Draw a panel into a space of `room` inches."""
    for part in panel.parts:
        draw_part(axes, part)
    if panel.of(Cells):
        axes.tick_params(labelsize=8)
    else:
        tidy(axes)
    _scale(axes, panel)
    across, up = _words(panel.across, 0.85 * room[0]), _words(panel.up, 0.6 * room[1], 2)
    label_axes(axes, across, up, panel.title)
    if panel.key:
        axes.legend(fontsize=KEY, frameon=False, loc=panel.key)  # type: ignore[call-overload]


def _scale(axes: Axes, panel: Panel) -> None:
    """Give both axes their scales, ends and ticks."""
    for which, axis in (("x", panel.across), ("y", panel.up)):
        if axis.logarithmic:
            axes.set(**{f"{which}scale": "log"})
    if (panel.across.low, panel.across.high) != (None, None):
        axes.set_xlim(panel.across.low, panel.across.high)
    if (panel.up.low, panel.up.high) != (None, None):
        axes.set_ylim(panel.up.low, panel.up.high)
    if panel.equal:
        axes.set_aspect("equal")
    for which, axis in (("x", panel.across), ("y", panel.up)):
        if axis.logarithmic:
            low, high = axes.get_xlim() if which == "x" else axes.get_ylim()
            plain_powers(axes, which, low, high)


def _words(axis: Axis, room: float, most: int = 4) -> str:
    return safe(wrapped(axis.words, LABEL, room, most)) if axis.name else ""


def draw_part(axes: Axes, part: ChartPart) -> None:
    """Draw one part in the coordinates of axes."""
    if isinstance(part, Cells):
        _draw_cells(axes, part)
        return
    colour = colour_of(part.tone)
    if isinstance(part, Level):
        line = axes.axvline if part.upright else axes.axhline
        line(part.at, color=colour, linewidth=part.width, linestyle=part.dash)
    elif isinstance(part, Line):
        axes.plot(
            part.x, part.y, color=colour, linewidth=part.width, linestyle=part.dash,
            label=_label(part.label), drawstyle="steps-post" if part.steps else "default",
            alpha=_alpha(part.opacity),
        )  # fmt: skip
    elif isinstance(part, Dots):
        edge: dict[str, Any] = {"markeredgewidth": part.edge} if part.edge else {}
        axes.plot(
            part.x, part.y, part.sign, color=colour, markersize=part.size,
            label=_label(part.label), alpha=_alpha(part.opacity), **edge,
        )  # fmt: skip
    elif isinstance(part, Area):
        axes.fill(
            part.x, part.y, color=colour, alpha=part.opacity, linewidth=0,
            label=_label(part.label),
        )  # fmt: skip
    else:
        axes.fill_between(
            part.x, part.low, part.high, color=colour, alpha=part.opacity, linewidth=0,
            label=_label(part.label),
        )  # fmt: skip


HATCHED: dict[str, Any] = {"cmap": "gray", "vmin": 0.0, "vmax": 1.2, "hatch": "////",
                           "edgecolor": "#777777", "linewidth": 0.0}  # fmt: skip
"""Look of cells without a value, if that has a meaning."""


def _draw_cells(axes: Axes, part: Cells) -> None:
    """Draw cells in the colours of the terminal, with a colour bar."""
    import numpy as np
    from matplotlib.colors import LogNorm, Normalize
    from matplotlib.ticker import MaxNLocator

    values = np.ma.masked_invalid(np.asarray(part.values, dtype=float))
    shading: Literal["flat", "nearest"] = "flat" if part.has_edges else "nearest"
    if values.count():
        axis = part.value
        scale = scale_of(values.compressed().tolist(), axis.low, axis.high)
        norm = (LogNorm if axis.logarithmic else Normalize)(scale.low, scale.high)
        image = axes.pcolormesh(
            part.x, part.y, values, cmap=colour_map(scale), norm=norm, shading=shading,
            rasterized=True,
        )  # fmt: skip
        bar = colour_bar(axes.get_figure(), image, axes, safe(axis.words), shrink=0.9)
        bar.ax.tick_params(which="minor", labelsize=7)
        if axis.whole and not axis.logarithmic:
            bar.locator = MaxNLocator(integer=True)
            bar.update_ticks()
    if part.missing and np.ma.is_masked(values):
        blank = np.ma.masked_where(~np.ma.getmaskarray(values), np.ones(values.shape))
        axes.pcolor(part.x, part.y, blank, shading=shading, **HATCHED)
    if part.downward:
        axes.invert_yaxis()


def _label(text: str) -> str | None:
    return safe(shortened(text, KEY, 4.0)) if text else None


def _alpha(opacity: float) -> float | None:
    return opacity if opacity < 1.0 else None


def draw_runs(runs: Sequence[Run], title: str = "") -> Figure:
    """Draw runs of the same plant: a column for each tracked output.

    Each column has the output with its reference, the error, and the drives of its axis with
    their limits, over time.

    Parameters
    ----------
    runs : sequence of Run
        At least one; on one plant.
    title : str, optional
        Title of the figure; by default the plant and the trajectory.
    """
    return chart_figure(run_chart(runs, title))
