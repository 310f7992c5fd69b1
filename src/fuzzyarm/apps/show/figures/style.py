"""Common look of all figures."""

from __future__ import annotations

import io
from functools import partial
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.show.drawing import Scale
from fuzzyarm.apps.show.figures.labels import wrapped
from fuzzyarm.base.names import printable
from fuzzyarm.base.picture import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


DASHES = ("-", "--", "-.")


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of the given size in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    # Outside of pyplot a notebook would show the class name instead.
    figure._repr_png_ = partial(png_of, figure)  # type: ignore[attr-defined]
    FigureCanvasAgg(figure)
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.08, wspace=0.04, hspace=0.05)  # type: ignore[union-attr, call-arg]
    return figure


def png_of(figure: Figure) -> bytes:
    """Return a figure as a PNG for a page."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=90)
    return out.getvalue()


def line_style(index: int) -> dict[str, Any]:
    """Return colour and dashes of line number `index`: the first 24 differ."""
    dash = DASHES[(index // len(COLOURS)) % len(DASHES)]
    return {"color": COLOURS[index % len(COLOURS)], "linestyle": dash}


def colour_map(scale: Scale) -> Any:
    """Return the matplotlib colour map with the colours of the terminal."""
    from matplotlib.colors import LinearSegmentedColormap

    stops = [tuple(part / 255 for part in stop) for stop in scale.stops]
    return LinearSegmentedColormap.from_list("fuzzyarm", stops)


def tidy(axes: Axes) -> None:
    """Remove redundant lines; draw a faint grid."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8)
    axes.grid(visible=True, color="#dddddd", linewidth=0.6)
    short_numbers(axes.xaxis)
    short_numbers(axes.yaxis)
    axes.set_axisbelow(True)


def safe(text: str) -> str:
    """Return any text for matplotlib, with dollar signs as characters, not mathematics."""
    return "\n".join(map(printable, text.split("\n"))).replace("$", r"\$")


LABEL, TITLE = 9, 11
"""Font sizes of axis labels and titles in points."""


def axis_label(name: str, description: str, room: float = 2.9) -> str:
    """Return ``name: description`` for an axis, wrapped at `room` inches."""
    label = f"{name}: {description}" if description else name
    return safe(wrapped(label, LABEL, room))


def head(figure: Figure, title: str, *, size: float = TITLE, weight: str = "bold") -> None:
    """Write a title over a figure, which grows by the lines after the first."""
    room = figure.get_figwidth() - 0.3
    lines = wrapped(title, 1.12 * size if weight == "bold" else size, room)
    figure.set_figheight(figure.get_figheight() + lines.count("\n") * 1.3 * size / 72.0)
    figure.suptitle(safe(lines), fontsize=size, fontweight=weight)


def label_axes(axes: Axes, across: str, up: str, title: str = "") -> None:
    """Label both axes with texts of :func:`axis_label`."""
    axes.set_xlabel(across, fontsize=LABEL)
    axes.set_ylabel(up, fontsize=LABEL)
    axes.set_title(safe(title), fontsize=LABEL)


def set_range(axes: Axes, low: float, high: float) -> None:
    """Set the horizontal range, with a small margin at its ends."""
    margin = 0.02 * (high - low)
    axes.set_xlim(low - margin, high + margin)


def short_numbers(axis: Any) -> None:
    """Move a power of ten to the end of an axis with long numbers."""
    from matplotlib.ticker import ScalarFormatter

    if isinstance(axis.get_major_formatter(), ScalarFormatter):
        # Plain down to 0.0001: milliseconds of a time axis stay readable.
        axis.get_major_formatter().set_powerlimits((-5, 5))
        axis.get_major_formatter().set_useOffset(False)


def colour_bar(part: Any, image: Any, axes: Axes, label: str, *, shrink: float) -> Any:
    """Return a colour bar beside `axes`."""
    bar = part.colorbar(image, ax=axes, shrink=shrink)
    bar.set_label(label, fontsize=LABEL)
    bar.ax.tick_params(labelsize=8)
    short_numbers(bar.ax.yaxis)
    return bar
