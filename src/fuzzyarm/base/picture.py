"""Pictures as data: lines, areas, marks and words in data coordinates.

A picture is made once and drawn by several renderers: :mod:`fuzzyarm.apps.show` in a terminal,
:mod:`fuzzyarm.apps.show.figures` with matplotlib, the page of the designer by :func:`part_data`
and :func:`panel_data`. Nothing here depends on the size of a screen or imports NumPy; the numbers
of a part may be arrays.

To add a picture, write a function that returns a :class:`Panel`; terminal, figure and page draw it
without another line. Look at it, at one and two times its size, dark and light, with long names.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict, TypeVar, cast

from fuzzyarm.base.jsonable import jsonable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = [
    "Area", "Axis", "Band", "Cells", "Chart", "Dots", "Drawing", "Level", "Line", "Mark", "Panel",
    "Words", "frame", "rectangle",
]  # fmt: skip

Numbers: TypeAlias = "Sequence[float] | NDArray[np.float64]"

# --- Colours by meaning ---

COLOURS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#7A6A00", "#333333")
"""The colours of Okabe and Ito, safe for colour-blind eyes."""

DASHES = ("-", "--", "-.")

TONES = {
    "first": COLOURS[0],
    "second": COLOURS[1],
    "wanted": "#999999",
    "mark": COLOURS[3],
    "metal": "#444444",
    "water": COLOURS[5],
    "ink": "#333333",
}
"""Colours by name; the page has its own for light and dark. Any other colour is ``#rrggbb``."""


def colour_of(tone: str) -> str:
    """Return the colour of a tone: a name of :data:`TONES` or a colour."""
    return TONES.get(tone, tone)


# --- Parts of a picture ---


@dataclass(frozen=True)
class Line:
    """A polyline.

    Parameters
    ----------
    x, y : sequence of float
        The points.
    tone : str
        Colour: ``#rrggbb`` or a name of ``TONES``.
    width : float
        Points.
    dash : str
        ``-``, ``--``, ``-.`` or ``:``.
    label : str
        Entry in the legend; empty for none.
    steps : bool
        Whether it is a staircase: level from each point to the next.
    opacity : float
        From 0 to 1.
    """

    x: Numbers
    y: Numbers
    tone: str = "metal"
    width: float = 1.0
    dash: str = "-"
    label: str = ""
    steps: bool = False
    opacity: float = 1.0


@dataclass(frozen=True)
class Area:
    """A filled polygon.

    Parameters
    ----------
    x, y : sequence of float
        Corners.
    tone : str
        Colour.
    opacity : float
        From 0 to 1; in a chart.
    label : str
        Entry in the legend; empty for none.
    """

    x: Numbers
    y: Numbers
    tone: str = "first"
    opacity: float = 1.0
    label: str = ""


@dataclass(frozen=True)
class Mark:
    """A symbol of fixed size.

    Parameters
    ----------
    x, y : float
        Centre.
    sign : str
        ``o`` round, ``s`` square, ``^`` triangle.
    size : float
        Points.
    tone : str
        Colour.
    """

    x: float
    y: float
    sign: str = "o"
    size: float = 6.0
    tone: str = "metal"


@dataclass(frozen=True)
class Words:
    """A line of text.

    Parameters
    ----------
    x, y : float
        Start of the text.
    text : str
        Free text; a renderer shows it literally.
    size : float
        Points.
    """

    x: float
    y: float
    text: str
    size: float = 8.0


Part: TypeAlias = Line | Area | Mark | Words


@dataclass(frozen=True)
class Drawing:
    """A drawing to scale: equal lengths across and up.

    Parameters
    ----------
    stage : tuple of float
        Left, right, bottom and top of the visible part.
    parts : sequence of Line, Area, Mark or Words
        From back to front.
    grip : tuple of float, optional
        Handle for the mouse; by default the centre.
    """

    stage: tuple[float, float, float, float]
    parts: Sequence[Part]
    grip: tuple[float, float] | None = None

    @property
    def held_at(self) -> tuple[float, float]:
        """Handle for the mouse."""
        left, right, bottom, top = self.stage
        return self.grip or (0.5 * (left + right), 0.5 * (bottom + top))


# --- Charts: parts over two axes ---


@dataclass(frozen=True)
class Dots:
    """Points, each a symbol of fixed size.

    Parameters
    ----------
    x, y : sequence of float
        Positions.
    sign : str
        As of a mark; ``x`` and ``+`` are crosses, ``.`` is a small round one.
    tone : str
        Colour.
    size : float
        Points.
    label : str
        Entry in the legend; empty for none.
    opacity : float
        From 0 to 1.
    edge : float
        Line width of a cross; 0 for the default.
    """

    x: Numbers
    y: Numbers
    sign: str = "."
    tone: str = "first"
    size: float = 3.0
    label: str = ""
    opacity: float = 1.0
    edge: float = 0.0


@dataclass(frozen=True)
class Band:
    """The area between two curves.

    Parameters
    ----------
    x, low, high : sequence of float
        The points, and the ends at each.
    tone : str
        Colour.
    opacity : float
        From 0 to 1.
    label : str
        Entry in the legend.
    """

    x: Numbers
    low: Numbers
    high: Numbers
    tone: str = "first"
    opacity: float = 0.3
    label: str = ""


@dataclass(frozen=True)
class Level:
    """A straight line across the whole chart.

    Parameters
    ----------
    at : float
        Position.
    upright : bool
        Whether it is vertical.
    tone : str
        Colour.
    width : float
        Points.
    dash : str
        As of a line.
    """

    at: float
    upright: bool = False
    tone: str = "ink"
    width: float = 0.6
    dash: str = "-"


@dataclass(frozen=True)
class Axis:
    """One axis of a chart.

    Parameters
    ----------
    name : str
        The quantity along it; may be text from a file.
    unit : str
        Unit; empty, or ``1``, for none.
    low, high : float, optional
        Ends; by default those of the parts.
    logarithmic : bool
        Whether equal lengths are equal ratios.
    about : str
        Explanation of the name.
    whole : bool
        Whether it counts: ticks at whole numbers only.
    """

    name: str = ""
    unit: str = ""
    low: float | None = None
    high: float | None = None
    logarithmic: bool = False
    about: str = ""
    whole: bool = False

    @property
    def words(self) -> str:
        """Name, unit and meaning."""
        name = f"{self.name}, {self.unit}" if self.unit not in ("", "1") else self.name
        return f"{name}: {self.about}" if self.about else name


@dataclass(frozen=True)
class Cells:
    """Values over a grid, as colours.

    Parameters
    ----------
    x, y : sequence of float
        Centres of the columns and rows, or their edges (one more) if widths differ.
    values : array_like, shape (rows, columns)
        Row by row; NaN for a missing value.
    value : Axis
        Quantity of the values, and the minimum range of the colour scale.
    downward : bool
        Whether the first row is at the top, as in a file.
    signed : bool
        Whether the colour scale diverges at zero, for differences.
    missing : str
        Meaning of a cell without a value, as in ``diverged``: such cells are hatched. Empty:
        they stay blank.
    """

    x: Numbers
    y: Numbers
    values: Any
    value: Axis
    downward: bool = False
    signed: bool = False
    missing: str = ""

    @property
    def size(self) -> tuple[int, int]:
        """Numbers of columns and rows."""
        return len(self.values[0]), len(self.values)

    @property
    def has_edges(self) -> bool:
        """Whether `x` and `y` are the edges of the cells, not their centres."""
        return (len(self.x), len(self.y)) != self.size


_Kind = TypeVar("_Kind")

ChartPart: TypeAlias = Line | Area | Band | Dots | Level | Cells


@dataclass(frozen=True)
class Panel:
    """Parts over two axes.

    Parameters
    ----------
    parts : sequence
        Lines, bands, dots, levels, cells, from back to front.
    across, up : Axis
        The axes.
    title : str
        Text above it.
    key : str
        Position of the legend: ``upper left`` and so on; empty for no legend.
    name : str
        Short name, for displays without room for axes.
    equal : bool
        Whether a unit is as long across as up.
    """

    parts: Sequence[ChartPart]
    across: Axis = Axis()
    up: Axis = Axis()
    title: str = ""
    key: str = ""
    name: str = ""
    equal: bool = False

    def of(self, kind: type[_Kind]) -> list[_Kind]:
        """Return the parts of one kind."""
        return [part for part in self.parts if isinstance(part, kind)]


@dataclass(frozen=True)
class Chart:
    """Panels in rows and columns.

    Parameters
    ----------
    rows : sequence of sequence of Panel or None
        From the top; None leaves a cell empty.
    size : tuple of float
        Width and height on paper, inches.
    title : str
        Text above all of them.
    key : bool
        Whether one legend below serves all panels.
    below : str
        Label of the shared horizontal axis, below the last row only; empty if each panel has its
        own.
    heading : bool
        Whether the title is a heading, in larger letters.
    stretched : bool
        Whether a row of one panel takes the whole width.
    """

    rows: Sequence[Sequence[Panel | None]]
    size: tuple[float, float]
    title: str = ""
    key: bool = False
    below: str = ""
    heading: bool = False
    stretched: bool = False

    @property
    def panels(self) -> list[Panel]:
        """All panels, row by row."""
        return [panel for row in self.rows for panel in row if panel is not None]


def series(index: int) -> tuple[str, str]:
    """Return colour and dashes of line number `index`; the first 24 all differ."""
    return COLOURS[index % len(COLOURS)], DASHES[(index // len(COLOURS)) % len(DASHES)]


# --- Common shapes ---


def rectangle(left: float, bottom: float, width: float, height: float, tone: str) -> Area:
    """Return a filled rectangle."""
    right, top = left + width, bottom + height
    return Area((left, right, right, left), (bottom, bottom, top, top), tone)


def frame(left: float, bottom: float, width: float, height: float, tone: str = "metal") -> Line:
    """Return the outline of a rectangle."""
    area = rectangle(left, bottom, width, height, tone)
    return Line((*area.x, left), (*area.y, bottom), tone)


ROOM = 0.05
"""Margin beyond the data, as a share of their width."""


def ends_with_room(values: Numbers, *, logarithmic: bool = False) -> tuple[float, float]:
    """Return the ends of an axis a little beyond the values, so that marks are not cut off."""
    finite = [value for value in _flat(values) if math.isfinite(value)]
    low, high = min(finite, default=0.0), max(finite, default=1.0)
    if logarithmic and 0.0 < low < high:
        factor = (high / low) ** ROOM
        return low / factor, high * factor
    room = ROOM * (high - low) or ROOM * abs(high) or 1.0
    return low - room, high + room


# --- As JSON, for a page ---


def drawing_data(drawing: Drawing) -> dict[str, Any]:
    """Return a drawing as JSON data; parts with a non-finite number are left out."""
    parts = map(part_data, drawing.parts)
    return {
        "stage": list(drawing.stage),
        "parts": [part for part in parts if part is not None],
        "grip": [short(x) for x in drawing.held_at],
    }


def part_data(part: Part) -> dict[str, Any] | None:
    """Return a part as JSON data; None if a number is not finite."""
    if isinstance(part, Line | Area):
        points = [[short(x), short(y)] for x, y in zip(part.x, part.y, strict=True)]
        if any(None in point for point in points):
            return None
        data: dict[str, Any] = {"points": points, "colour": part.tone}
        return {"is": "area", **data} if isinstance(part, Area) else {
            "is": "line", **data, "width": part.width,
        }  # fmt: skip
    at = {"x": short(part.x), "y": short(part.y), "size": part.size}
    if None in at.values():
        return None
    if isinstance(part, Words):
        return {"is": "words", **at, "text": part.text}
    return {"is": "mark", **at, "sign": part.sign, "colour": part.tone}


# --- Panels as JSON ---


class AxisData(TypedDict):
    """An axis for a page, with both ends."""

    words: str
    low: float
    high: float
    logarithmic: bool
    whole: bool


PartData = TypedDict(
    "PartData",
    {
        "is": str,
        "x": list[float | None],
        "y": list[float | None],
        "low": list[float | None],
        "high": list[float | None],
        "tone": str,
        "width": float,
        "dash": str,
        "label": str,
        "steps": bool,
        "opacity": float,
        "sign": str,
        "size": float,
        "edge": float,
        "at": float | None,
        "upright": bool,
        "values": list[float | None],
        "value": AxisData,
        "downward": bool,
        "signed": bool,
        "missing": str,
    },
    total=False,
)
"""A part of a panel for a page; its fields depend on ``is``.

Non-finite numbers are null. A tone is one of `TONES`, ``series`` and an index of `COLOURS`, or
``#rrggbb``.
"""


class PanelData(TypedDict):
    """A panel for a page."""

    title: str
    across: AxisData
    up: AxisData
    parts: list[PartData]
    equal: bool


def panel_data(panel: Panel) -> PanelData:
    """Return a panel as JSON data: its parts, and its axes with both ends."""
    across, up = with_ends(panel)
    return {
        "title": panel.title,
        "across": _axis_data(across),
        "up": _axis_data(up),
        "parts": list(map(_chart_part_data, panel.parts)),
        "equal": panel.equal,
    }


def chart_data(chart: Chart) -> list[PanelData]:
    """Return the panels of a chart as JSON data; an untitled panel has the chart's title."""
    panels = map(panel_data, chart.panels)
    return [{**data, "title": data["title"] or chart.title} for data in panels]


def with_ends(panel: Panel) -> tuple[Axis, Axis]:
    """Return both axes of a panel with both ends: their own, or those of the parts."""
    along = [_reach_of(part) for part in panel.parts]
    return (
        _with_ends(panel.across, [x for xs, _ in along for x in xs]),
        _with_ends(panel.up, [y for _, ys in along for y in ys]),
    )


def _reach_of(part: ChartPart) -> tuple[list[float], list[float]]:
    """Return all numbers of a part along both axes."""
    if isinstance(part, Level):
        return ([part.at], []) if part.upright else ([], [part.at])
    if isinstance(part, Band):
        return _flat(part.x), [*_flat(part.low), *_flat(part.high)]
    return _flat(part.x), _flat(part.y)


def _with_ends(axis: Axis, along: Iterable[float]) -> Axis:
    """Return an axis with its own ends, or those of the data along it."""
    usable = [x for x in along if math.isfinite(x) and (x > 0.0 or not axis.logarithmic)]
    low = min(usable, default=0.1 if axis.logarithmic else 0.0) if axis.low is None else axis.low
    high = max(usable, default=1.0) if axis.high is None else axis.high
    if not low < high:
        low, high = (0.5 * low, 2.0 * high) if axis.logarithmic else (low - 1.0, high + 1.0)
    return replace(axis, low=low, high=high)


def _axis_data(axis: Axis) -> AxisData:
    assert axis.low is not None
    assert axis.high is not None
    return {
        "words": axis.words, "low": float(axis.low), "high": float(axis.high),
        "logarithmic": axis.logarithmic, "whole": axis.whole,
    }  # fmt: skip


def _chart_part_data(part: ChartPart) -> PartData:
    if isinstance(part, Cells):
        values = _flat(part.values)
        return cast(PartData, {
            "is": "cells", "x": _shorts(part.x), "y": _shorts(part.y), "values": _shorts(values),
            "value": _axis_data(_with_ends(part.value, values)), "downward": part.downward,
            "signed": part.signed, "missing": part.missing,
        })  # fmt: skip
    if isinstance(part, Line) and part.steps:
        part = _corners(part)
    words = {field.name: getattr(part, field.name) for field in fields(part)}
    data = {
        name: value if isinstance(value, str | bool | int) else
        short(value, DIGITS) if isinstance(value, float) else _shorts(value)
        for name, value in words.items()
    }  # fmt: skip
    tone = words["tone"]
    data["tone"] = f"series{COLOURS.index(tone)}" if tone in COLOURS else tone
    return cast(PartData, {"is": type(part).__name__.lower(), **data})


def _corners(line: Line) -> Line:
    """Return a staircase without the points inside its level stretches."""
    y = _flat(line.y)
    last = len(y) - 1
    # The first point of a level stretch is enough.
    indices = [k for k, value in enumerate(y) if k in (0, last) or value != y[k - 1]]
    x = _flat(line.x)
    return replace(line, x=[x[k] for k in indices], y=[y[k] for k in indices])


DIGITS = 9
"""Significant digits of the numbers of a panel."""


def _flat(values: Any) -> list[float]:
    """Return numbers as a flat list, from any container."""
    flat = values.ravel().tolist() if hasattr(values, "ravel") else values
    return [float(value) for value in flat]


def _shorts(values: Any) -> list[float | None]:
    return [short(value, DIGITS) for value in _flat(values)]


def short(value: float, digits: int = 6) -> float | None:
    """Return a number rounded for a page; None if not finite."""
    shortened: float | None = jsonable(float(f"{value:.{digits}g}"))
    return shortened
