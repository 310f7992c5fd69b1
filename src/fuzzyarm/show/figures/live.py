"""A run in the terminal: the plant to scale in dots of braille, errors and drives beside it.

What is drawn is what an animation shows (:mod:`fuzzyarm.show.figures.plants`): its lines, patches
and words are read from the axes that nobody else sees.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from fuzzyarm.show.drawing import fitted, number_words, run_words, time_words
from fuzzyarm.show.figures.plants import Scene, picture_of

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.text import Text

    from fuzzyarm.loop import Run
    from fuzzyarm.plant import Plant

RATE = 12
"""Pictures in a second."""

LONGEST = 8.0
"""Longer runs are shown faster, in this many seconds."""

_BRAILLE = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""The bit of each dot of a character, by row and column."""

_PLAIN = " .:*#"
"""Where there is no braille: the more dots, the denser."""


@dataclass
class Canvas:
    """Dots on a terminal: two to a character across, four down, about as wide as high.

    Attributes
    ----------
    columns, rows : int
        Characters.
    left, right, bottom, top : float
        What they show.
    unicode : bool
        Whether the terminal has braille.
    """

    columns: int
    rows: int
    left: float
    right: float
    bottom: float
    top: float
    unicode: bool = True
    _bits: dict[tuple[int, int], int] = field(default_factory=dict)
    _colours: dict[tuple[int, int], str] = field(default_factory=dict)
    _words: list[tuple[int, int, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        # As large as fits, and in the middle: a length is the same across and up.
        across, up = 2 * self.columns - 1, 4 * self.rows - 1
        self._scale = min(across / (self.right - self.left), up / (self.top - self.bottom))
        self._x = 0.5 * (across - self._scale * (self.left + self.right))
        self._y = 0.5 * (up + self._scale * (self.bottom + self.top))

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Return column and row of the dot at a point, not yet rounded."""
        return self._x + self._scale * x, self._y - self._scale * y

    def dot(self, column: float, row: float, colour: str) -> None:
        """Set a dot; nothing happens outside."""
        if not (math.isfinite(column) and math.isfinite(row)):
            return
        i, j = round(row), round(column)
        if 0 <= i < 4 * self.rows and 0 <= j < 2 * self.columns:
            cell = i // 4, j // 2
            self._bits[cell] = self._bits.get(cell, 0) | _BRAILLE[i % 4][j % 2]
            self._colours[cell] = colour

    def line(self, points: Sequence[tuple[float, float]], colour: str, width: float = 1.0) -> None:
        """Draw straight lines; those wider than two points in a figure are two dots wide."""
        placed = [self.place(*point) for point in points]
        for (x0, y0), (x1, y1) in pairwise(placed):
            if not all(map(math.isfinite, (x0, y0, x1, y1))):
                continue
            steps = max(1, min(4000, math.ceil(max(abs(x1 - x0), abs(y1 - y0)))))
            thick = 0.5 if width > 2.0 else 0.0
            across = abs(y1 - y0) > abs(x1 - x0)
            for k in range(steps + 1):
                x, y = x0 + (x1 - x0) * k / steps, y0 + (y1 - y0) * k / steps
                for by in {-thick, thick}:
                    self.dot(x + by * across, y + by * (not across), colour)

    def area(self, points: Sequence[tuple[float, float]], colour: str) -> None:
        """Fill a polygon."""
        placed = [self.place(*point) for point in points]
        rows = [y for _, y in placed]
        for row in range(
            max(0, math.ceil(min(rows))), min(4 * self.rows, math.floor(max(rows)) + 1)
        ):
            cuts = sorted(
                x0 + (row - y0) * (x1 - x0) / (y1 - y0)
                for (x0, y0), (x1, y1) in zip(placed, [*placed[1:], placed[0]], strict=True)
                if (y0 <= row) != (y1 <= row)
            )
            for start, end in zip(cuts[::2], cuts[1::2], strict=False):
                for column in range(math.ceil(start), math.floor(end) + 1):
                    self.dot(column, row, colour)

    def blob(self, x: float, y: float, size: float, colour: str) -> None:
        """Draw a mark of a size in points."""
        column, row = self.place(x, y)
        reach = max(0, round(size / 6.0))
        for i in range(-reach, reach + 1):
            for j in range(-reach, reach + 1):
                self.dot(column + j, row + i, colour)

    def words(self, x: float, y: float, text: str) -> None:
        """Write a line beginning at a point."""
        column, row = self.place(x, y)
        self._words.append((round(row) // 4, max(0, round(column) // 2), text))

    def lines(self) -> list[Text]:
        """Return the rows of characters."""
        from rich.text import Text

        found = []
        for i in range(self.rows):
            line = Text(no_wrap=True, overflow="crop")
            for j in range(self.columns):
                bits = self._bits.get((i, j), 0)
                line.append(self._character(bits), self._colours.get((i, j), ""))
            found.append(line)
        for row, column, text in self._words:
            if 0 <= row < self.rows and column < self.columns:
                shown = fitted(text, self.columns - column)
                whole = found[row]
                found[row] = whole[:column] + Text(shown) + whole[column + len(shown) :]
        return found

    def _character(self, bits: int) -> str:
        if self.unicode:
            return chr(0x2800 + bits) if bits else " "
        return _PLAIN[min(len(_PLAIN) - 1, -(-bits.bit_count() // 2))]


class Surface(Protocol):
    """Where what stands in axes is drawn; a :class:`Canvas` is one."""

    def line(self, points: Sequence[tuple[float, float]], colour: str, width: float = 1.0) -> None:
        """Draw straight lines."""

    def area(self, points: Sequence[tuple[float, float]], colour: str) -> None:
        """Fill a polygon."""

    def blob(self, x: float, y: float, size: float, colour: str) -> None:
        """Draw a mark."""

    def words(self, x: float, y: float, text: str) -> None:
        """Write a line beginning at a point."""


def read_axes(axes: Any, canvas: Surface) -> None:
    """Draw what stands in axes of matplotlib: patches, lines, marks and words.

    Parameters
    ----------
    axes : Axes
        Lines and patches in its data.
    canvas : Surface
        Where they are drawn.
    """
    from matplotlib.colors import to_hex

    for patch in axes.patches:
        shape = patch.get_transform() - axes.transData
        corners = [tuple(x) for x in patch.get_path().interpolated(1).to_polygons(shape)[0]]
        if patch.get_fill():
            canvas.area(corners, to_hex(patch.get_facecolor()))
        else:
            canvas.line(corners, to_hex(patch.get_edgecolor()), 1.0)
    for line in axes.lines:
        points = [(float(x), float(y)) for x, y in line.get_xydata()]
        colour = to_hex(line.get_color())
        if line.get_linestyle() not in ("None", "", " "):
            canvas.line(points, colour, line.get_linewidth())
        if line.get_marker() not in ("None", "", " ", None):
            for x, y in points:
                canvas.blob(x, y, line.get_markersize(), colour)
    for text in axes.texts:
        x, y = text.get_position()
        canvas.words(x, y, text.get_text().replace(r"\$", "$"))


# --- A picture of a run ---


class LiveView:
    """What is seen of a run at one sample after the other.

    Parameters
    ----------
    run : Run
        With samples.
    plant : Plant
        On which it ran.
    unicode : bool, optional
        Whether the terminal has braille.
    """

    def __init__(self, run: Run, plant: Plant, *, unicode: bool = True) -> None:
        self.run, self.plant, self.unicode = run, plant, unicode
        self._picture = picture_of(run, plant)
        self._axes: Any = None
        if self._picture is not None:
            from matplotlib.figure import Figure

            self._axes = Figure().subplots()

    def at(self, index: int, width: int, height: int) -> RenderableType:
        """Return the picture of a sample in a given room, in characters."""
        from rich.console import Group
        from rich.table import Table
        from rich.text import Text

        run = self.run
        title = Text(run_words(run.controller, run.plant), "bold", no_wrap=True)
        end = float(run.time[-1])
        now = time_words(float(run.time[index]), end)
        title.append(f"  {now} of {time_words(end, end)} s", "not bold")
        rows = max(4, height - 1)
        if self._picture is None:
            return Group(title, *self._curves(index, width, rows))
        left = max(12, min(2 * rows, width // 2))
        table = Table.grid(padding=(0, 2, 0, 0))
        table.add_column(width=left, no_wrap=True)
        table.add_column(width=max(10, width - left - 2), no_wrap=True)
        drawn = self._plant(index, left, rows)
        table.add_row(Group(*drawn), Group(*self._curves(index, width - left - 2, rows)))
        return Group(title, table)

    def _plant(self, index: int, columns: int, rows: int) -> list[Text]:
        assert self._picture is not None
        self._axes.clear()
        self._picture.draw(self._axes, Scene(self.run, self.plant, index))
        (left, right), (bottom, top) = self._axes.get_xlim(), self._axes.get_ylim()
        canvas = Canvas(columns, rows, left, right, bottom, top, self.unicode)
        read_axes(self._axes, canvas)
        return canvas.lines()

    def _curves(self, index: int, width: int, rows: int) -> list[Text]:
        """Return errors and drives until a sample, each below the line that names it."""
        run = self.run
        curves = [
            (f"error of {label}", unit, run.errors[:, column])
            for column, (label, unit) in enumerate(zip(run.labels, run.units, strict=True))
        ]
        used = [name for name in run.drives if np.any(run.drives[name])] or list(run.drives)[:1]
        curves += [(name, run.drive_units[name], np.asarray(run.drives[name])) for name in used]
        curves = curves[: max(1, rows // 3)]
        each = max(1, rows // len(curves) - 1)
        found: list[Text] = []
        for name, unit, values in curves:
            found += self._curve(name, unit, values, index, (width, each))
        return found

    def _curve(
        self, name: str, unit: str, values: Any, index: int, size: tuple[int, int]
    ) -> Iterator[Text]:
        from rich.text import Text

        width, height = size
        low, high = float(np.min(values)), float(np.max(values))
        if high - low < 1e-12 * max(1.0, abs(high)):
            low, high = low - 1.0, high + 1.0
        words = f" {number_words(float(values[index]), 3)} {unit if unit != '1' else ''}"
        line = Text(no_wrap=True, overflow="crop")
        line.append(fitted(name, max(4, width - len(words))), "bold")
        line.append(words)
        yield line
        canvas = Canvas(width, height, 0.0, 1.0, 0.0, 1.0, self.unicode)
        # Across and up have scales of their own.
        last = max(1, len(values) - 1)
        across, up = 2 * width - 1, 4 * height - 1
        before: tuple[float, float] | None = None
        for column in range(2 * width):
            k = round(column * last / across)
            if k > index:
                break
            row = (high - float(values[min(k, last)])) / (high - low) * up
            start, end = sorted((row, row if before is None else before[1]))
            for i in range(round(start), round(end) + 1):
                canvas.dot(column, i, "cyan")
            before = column, row
        if low < 0.0 < high:
            for column in range(0, 2 * width, 4):
                canvas.dot(column, high / (high - low) * up, "cyan")
        yield from canvas.lines()


def frames_of(run: Run) -> list[int]:
    """Return the samples that are shown: the run as long as it is, longer ones faster."""
    seconds = min(LONGEST, max(1.0, float(run.time[-1])))
    count = min(run.samples, max(2, round(RATE * seconds)))
    return sorted({round(k * (run.samples - 1) / max(1, count - 1)) for k in range(count)})


def play(run: Run, plant: Plant, console: Console) -> bool:
    """Show a run in a terminal as it goes on; the last picture stays.

    Parameters
    ----------
    run : Run
        With samples.
    plant : Plant
        On which it ran.
    console : Console
        Of a terminal.

    Returns
    -------
    bool
        False if Ctrl-C ended it before its time.
    """
    from rich.live import Live

    has_braille = "utf" in (console.encoding or "").lower()
    view = LiveView(run, plant, unicode=has_braille)
    frames = frames_of(run)
    width, height = min(console.width, 110), max(8, min(console.height - 2, 26))
    pause = min(LONGEST, max(1.0, float(run.time[-1]))) / len(frames)
    try:
        with Live(console=console, auto_refresh=False) as live:
            due = time.monotonic()
            for index in frames:
                live.update(view.at(index, width, height), refresh=True)
                due = max(due + pause, time.monotonic() - 1.0)
                time.sleep(max(0.0, due - time.monotonic()))
    except KeyboardInterrupt:
        return False
    return True
