"""Panels of a chart in the terminal: lines in dots of braille, cells two to a character."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.canvas import Canvas
from fuzzyarm.apps.show.drawing import Scale, ScaleBar, fitted, number_words, ruler, scale_of, shade
from fuzzyarm.base.picture import Area, Axis, Cells, Dots, Level, Line, Numbers, Panel, with_ends

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.text import Text

FAILS = "✗"
"""Marks a violated property."""

LEFT = 8
"""Characters for the name of the vertical axis."""


# --- A growing line below its name, for runs ---


def panel_lines(
    panel: Panel, index: int, size: tuple[int, int], *, unicode: bool = True
) -> list[Text]:
    """Return the first line of a panel up to one of its points, and its value there."""
    from rich.text import Text

    width, height = size
    line = panel.of(Line)[0]
    low, high = _reach(line.y)
    unit = panel.up.unit if panel.up.unit != "1" else ""
    words = f" {number_words(float(line.y[index]), 3)} {unit}"
    head = Text(no_wrap=True, overflow="crop")
    head.append(fitted(panel.name, max(4, width - len(words))), "bold")
    head.append(words)
    canvas = Canvas(width, height, 0.0, 1.0, 0.0, 1.0, unicode)
    # Horizontal and vertical scales are independent.
    last = max(1, len(line.y) - 1)
    # A character of braille is two dots wide and four high.
    across, up = 2 * width - 1, 4 * height - 1
    columns = [round(column * last / across) for column in range(2 * width)]
    rows = [(high - float(line.y[min(k, last)])) / (high - low) * up for k in columns if k <= index]
    _connect(canvas, rows)
    if low < 0.0 < high:
        for column in range(0, 2 * width, 4):
            canvas.dot(column, high / (high - low) * up, "cyan")
    return [head, *canvas.lines()]


def _reach(values: Numbers) -> tuple[float, float]:
    low, high = float(min(values)), float(max(values))
    equal = high - low < 1e-12 * max(1.0, abs(high))
    return (low - 1.0, high + 1.0) if equal else (low, high)


def _connect(canvas: Canvas, rows: list[float]) -> None:
    """Draw a curve with one height for each column, with gaps at NaN."""
    before = math.nan
    for column, row in enumerate(rows):
        if not math.isnan(row):
            start, end = sorted((row, row if math.isnan(before) else before))
            for i in range(round(start), round(end) + 1):
                canvas.dot(column, i, "cyan")
        before = row


# --- A whole panel, with its axes ---


@dataclass(frozen=True)
class LinePlot:
    """A panel in braille dots, with the ends of its axes.

    Attributes
    ----------
    panel : Panel
        Draws its first line, or the outline of its first area, and its round dots, all of them if
        there is neither. A vertical level is a mark; crosses ``X`` among its dots are violations of
        a property.
    width, height : int
        Size of the plot area in characters.
    """

    panel: Panel
    width: int
    height: int

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        panel, width, height = self.panel, self.width, self.height
        low, high = self._ends
        labels = {0: number_words(high, 3), height - 1: number_words(low, 3)}
        up = f"log {panel.up.name}" if panel.up.logarithmic else panel.up.name
        labels.setdefault(height // 2, fitted(up, LEFT))
        left = max(map(len, labels.values()))
        canvas = Canvas(width, height, 0.0, 1.0, 0.0, 1.0)
        _connect(canvas, [self._row(y) for y in self._heights])
        for x, y in self._points():
            canvas.dot(self._dot_column(x), round(y), "cyan")
        columns = [self._column(level.at) for level in panel.of(Level) if level.upright]
        failing = dict(self._failing())
        for k, row in enumerate(canvas.lines()):
            line = Text(f"{labels.get(k, ''):>{left}} ", no_wrap=True, end="\n")
            for j, dots in enumerate(row.plain):
                fails = failing.get(j) == k
                style = "bold red" if j in columns or fails else "cyan"
                # U+2800, braille without dots, has the same width as the others in every font.
                empty = "┊" if j in columns else chr(0x2800)
                line.append(FAILS if fails else empty if dots == " " else dots, style)
            yield line
        axis = ruler(*self._across, width, panel.across.name)
        yield Text(f"{'':>{left}} {axis}", "dim", no_wrap=True)

    @cached_property
    def _line(self) -> Line | Area | None:
        outlines: list[Line | Area] = [*self.panel.of(Line), *self.panel.of(Area)]
        return outlines[0] if outlines else None

    @property
    def _across(self) -> tuple[float, float]:
        axis = self.panel.across
        if self._line is None:
            return _both(with_ends(self.panel)[0])
        x = self._line.x
        low, high = (float(x[0]), float(x[-1])) if len(x) else (0.0, 1.0)
        return (low if axis.low is None else axis.low, high if axis.high is None else axis.high)

    @property
    def _ends(self) -> tuple[float, float]:
        axis = self.panel.up
        if self._line is None:
            return _both(with_ends(self.panel)[1])
        heights = [float(y) for y in self._line.y if math.isfinite(y)] or [0.0, 1.0]
        low = min(heights) if axis.low is None else axis.low
        return low, max(heights) if axis.high is None else axis.high

    @property
    def _heights(self) -> Iterator[float]:
        """Yield a value for each column of dots, NaN beyond the ends of the line."""
        line = self._line
        if line is None or not len(line.y):
            yield from [math.nan] * (2 * self.width)
            return
        y, first = line.y, self._dot_column(float(line.x[0]))
        count = self._dot_column(float(line.x[-1])) - first + 1
        for column in range(2 * self.width):
            at = column - first
            yield float(y[at * len(y) // count]) if 0 <= at < count else math.nan

    def _column(self, x: float) -> int:
        """Return the column of characters of a horizontal position."""
        return self._dot_column(x) // 2

    def _dot_column(self, x: float) -> int:
        """Return the column of dots of a horizontal position."""
        low, high = self._across
        if self.panel.across.logarithmic:
            low, high, x = math.log(low), math.log(high), math.log(x)
        return round((x - low) / (high - low) * (2 * self.width - 1)) if high > low else 0

    def _row(self, value: float) -> float:
        """Return the row of dots of a value, NaN if outside."""
        low, high = self._ends
        if not math.isfinite(value):
            return math.nan
        if self.panel.up.logarithmic:
            low, high, value = math.log10(low), math.log10(high), math.log10(value)
        share = 0.5 if high <= low else (value - low) / (high - low)
        return round((1.0 - min(1.0, max(0.0, share))) * (4 * self.height - 1))

    def _points(self) -> Iterator[tuple[float, float]]:
        """Yield position and row of the dots drawn as points."""
        for dots in self.panel.of(Dots):
            if dots.sign != "X" and (dots.sign == "o" or self._line is None):
                for x, y in zip(dots.x, dots.y, strict=True):
                    row = self._row(float(y))
                    if not math.isnan(row):
                        yield float(x), row

    def _failing(self) -> Iterator[tuple[int, int]]:
        """Yield column and row of the characters with a violation."""
        for x, y in _failing(self.panel):
            row = self._row(y)
            yield self._column(x), self.height - 1 if math.isnan(row) else round(row) // 4


def _both(axis: Axis) -> tuple[float, float]:
    """Return the ends of an axis with both ends."""
    assert axis.low is not None
    assert axis.high is not None
    return axis.low, axis.high


def _failing(panel: Panel) -> list[tuple[float, float]]:
    """Return the positions marked as violations."""
    crosses = (dots for dots in panel.of(Dots) if dots.sign == "X")
    return [place for dots in crosses for place in zip(dots.x, dots.y, strict=True)]


# --- Cells from above ---

_NOTHING = "#808080"

HATCH = "╱"
"""A cell without a value, if that has a meaning."""


@dataclass(frozen=True)
class SurfaceMap:
    """The cells of a panel in colours, two to a character, with their scale below.

    Attributes
    ----------
    panel : Panel
        With cells; the round dot marks the crisp inputs, crosses are violations of a property.
    width, height : int
        Size of the map in characters; few cells are enlarged evenly and may need less.
    """

    panel: Panel
    width: int
    height: int

    def __rich_console__(
        self, console: Console, options: ConsoleOptions
    ) -> Iterator[Text | ScaleBar]:
        from rich.text import Text

        cells, panel = self._cells, self.panel
        x, y = self._middles
        ends = [y[0], y[-1]] if cells.downward else [y[-1], y[0]]
        wide, tall = self._size
        labels = {k: number_words(float(x), 3) for k, x in zip((0, tall - 2), ends, strict=True)}
        labels.setdefault(tall // 4 * 2, fitted(panel.up.name, LEFT))
        left = max(map(len, labels.values()))
        draw = self._shade if console.color_system is None or console.no_color else self._coloured
        for i in range(0, tall, 2):
            line = Text(f"{labels.get(i, ''):>{left}} ", no_wrap=True, end="\n")
            for j in range(wide):
                line.append(*draw(i, j))
            yield line
        axis = ruler(float(x[0]), float(x[-1]), wide, panel.across.name)
        yield Text(f"{'':>{left}} {axis}", "dim", no_wrap=True)
        yield ScaleBar(self._scale, wide + 9)
        if cells.missing:
            yield Text(f"{'':>{left}} {HATCH} {cells.missing}", "dim", no_wrap=True)

    @property
    def _cells(self) -> Cells:
        return self.panel.of(Cells)[0]

    @cached_property
    def _middles(self) -> tuple[Numbers, Numbers]:
        """Positions of columns and rows."""
        cells, panel = self._cells, self.panel
        if not cells.has_edges:
            return cells.x, cells.y
        return _between(cells.x, panel.across), _between(cells.y, panel.up)

    @cached_property
    def _scale(self) -> Scale:
        value = self._cells.value
        scale = scale_of(self._cells.values.ravel().tolist(), value.low, value.high)
        return replace(scale, logarithmic=value.logarithmic and scale.low > 0.0)

    @cached_property
    def _size(self) -> tuple[int, int]:
        """Half characters across and down: whole cells if possible, an even number of rows."""
        columns, rows = self._cells.size
        wide = max(1, self.width // columns) * columns if columns <= self.width else self.width
        room = 2 * self.height
        tall = max(1, room // rows) * rows if rows <= room else room
        return wide, tall + tall % 2

    def _value(self, i: int, j: int) -> float:
        """Return the value at a half character."""
        (wide, tall), cells = self._size, self._cells
        columns, rows = cells.size
        row = min(rows - 1, i * rows // tall)
        if not cells.downward:
            row = rows - 1 - row
        return float(cells.values[row][j * columns // wide])

    def _place(self, x: float, y: float) -> tuple[int, int]:
        """Return row and column of the half character at a position."""
        (wide, tall), cells = self._size, self._cells
        columns, rows = cells.size
        column, row = map(_nearest, self._middles, (x, y))
        if not cells.downward:
            row = rows - 1 - row
        i, j = int((row + 0.5) * tall / rows), int((column + 0.5) * wide / columns)
        return min(tall - 1, i), min(wide - 1, j)

    @cached_property
    def _mark(self) -> tuple[int, int] | None:
        """Row and column of the crisp inputs."""
        marks = [dots for dots in self.panel.of(Dots) if dots.sign == "o"]
        return self._place(marks[0].x[0], marks[0].y[0]) if marks else None

    @cached_property
    def _failures(self) -> set[tuple[int, int]]:
        """Rows and columns of characters with a violation."""
        places = (self._place(*place) for place in _failing(self.panel))
        return {(i // 2, j) for i, j in places}

    def _sign(self, i: int, j: int) -> str:
        """Return the sign on a character, beside its colours."""
        if (i // 2, j) in self._failures:
            return FAILS
        is_mark = self._mark is not None and (self._mark[0] // 2, self._mark[1]) == (i // 2, j)
        return "◆" if is_mark else ""

    def _coloured(self, i: int, j: int) -> tuple[str, str]:
        upper, lower, sign = self._value(i, j), self._value(i + 1, j), self._sign(i, j)
        if sign == FAILS:
            return sign, f"bold red on {self._colour(upper)}"
        if sign:
            value = upper if self._mark == (i, j) else lower
            ink = "black" if math.isnan(value) else self._scale.ink(value)
            return sign, f"bold {ink} on {self._colour(value)}"
        if self._cells.missing and math.isnan(upper) and math.isnan(lower):
            return HATCH, f"black on {_NOTHING}"
        # The upper half is the foreground, the lower one the background.
        return "▀", f"{self._colour(upper)} on {self._colour(lower)}"

    def _shade(self, i: int, j: int) -> tuple[str, str]:
        """Return a character as dark as the value, for output without colours."""
        values = [x for x in (self._value(i, j), self._value(i + 1, j)) if not math.isnan(x)]
        shares = list(map(self._scale.share, values))
        blank = HATCH if self._cells.missing else " "
        return self._sign(i, j) or (shade(sum(shares) / len(values)) if values else blank), ""

    def _colour(self, value: float) -> str:
        return _NOTHING if math.isnan(value) else self._scale.hexadecimal(value)


def _between(edges: Numbers, axis: Axis) -> list[float]:
    """Return the midpoints between edges."""
    pairs = pairwise(map(float, edges))
    return [math.sqrt(a * b) if axis.logarithmic else 0.5 * (a + b) for a, b in pairs]


def _nearest(values: Numbers, x: float) -> int:
    return min(range(len(values)), key=lambda k: abs(float(values[k]) - x))


# --- Either ---


def panel_view(panel: Panel, width: int, height: int) -> LinePlot | SurfaceMap:
    """Return a panel in the given size: its cells if it has some, else its line."""
    if panel.of(Cells):
        return SurfaceMap(panel, max(8, width - LEFT - 1), max(3, height - 3))
    return LinePlot(panel, max(8, width - LEFT - 1), max(3, height - 2))
