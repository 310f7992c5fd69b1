"""Dots of braille on a terminal: lines, areas, marks and words, to scale."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.drawing import fitted
from fuzzyarm.base.picture import Area, Drawing, Line, Mark, Numbers, Part, colour_of

if TYPE_CHECKING:
    from rich.text import Text

_BRAILLE = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""The bit of each dot of a character, by row and column."""

_PLAIN = " .:*#"
"""ASCII substitutes for braille, denser with more dots."""


@dataclass
class Canvas:
    """A grid of dots on a terminal: 2 × 4 to a character, about square.

    Attributes
    ----------
    columns, rows : int
        Size in characters.
    left, right, bottom, top : float
        Visible part of the plane.
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
        # As large as possible, centred, with one scale in both directions.
        across, up = 2 * self.columns - 1, 4 * self.rows - 1
        self._scale = min(across / (self.right - self.left), up / (self.top - self.bottom))
        self._x = 0.5 * (across - self._scale * (self.left + self.right))
        self._y = 0.5 * (up + self._scale * (self.bottom + self.top))

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Return the fractional column and row of the dot at a point."""
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

    def draw(self, parts: Iterable[Part]) -> None:
        """Draw parts of a picture from back to front."""
        for part in parts:
            if isinstance(part, Line):
                self.line(part.x, part.y, colour_of(part.tone), part.width)
            elif isinstance(part, Area):
                self.area(part.x, part.y, colour_of(part.tone))
            elif isinstance(part, Mark):
                self.mark(part.x, part.y, part.size, colour_of(part.tone))
            else:
                self.words(part.x, part.y, part.text)

    def line(self, x: Numbers, y: Numbers, colour: str, width: float = 1.0) -> None:
        """Draw straight lines; lines wider than two points are two dots wide."""
        points = list(map(self.place, x, y))
        for (x0, y0), (x1, y1) in pairwise(points):
            if not all(map(math.isfinite, (x0, y0, x1, y1))):
                continue
            steps = max(1, min(4000, math.ceil(max(abs(x1 - x0), abs(y1 - y0)))))
            thick = 0.5 if width > 2.0 else 0.0
            across = abs(y1 - y0) > abs(x1 - x0)
            for k in range(steps + 1):
                column, row = x0 + (x1 - x0) * k / steps, y0 + (y1 - y0) * k / steps
                for by in {-thick, thick}:
                    self.dot(column + by * across, row + by * (not across), colour)

    def area(self, x: Numbers, y: Numbers, colour: str) -> None:
        """Fill a polygon."""
        points = list(map(self.place, x, y))
        rows = [y for _, y in points]
        for row in range(
            max(0, math.ceil(min(rows))), min(4 * self.rows, math.floor(max(rows)) + 1)
        ):
            cuts = sorted(
                x0 + (row - y0) * (x1 - x0) / (y1 - y0)
                for (x0, y0), (x1, y1) in zip(points, [*points[1:], points[0]], strict=True)
                if (y0 <= row) != (y1 <= row)
            )
            for start, end in zip(cuts[::2], cuts[1::2], strict=False):
                for column in range(math.ceil(start), math.floor(end) + 1):
                    self.dot(column, row, colour)

    def mark(self, x: float, y: float, size: float, colour: str) -> None:
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

        rows = []
        for i in range(self.rows):
            line = Text(no_wrap=True, overflow="crop")
            for j in range(self.columns):
                bits = self._bits.get((i, j), 0)
                line.append(self._character(bits), self._colours.get((i, j), ""))
            rows.append(line)
        for row, column, text in self._words:
            if 0 <= row < self.rows and column < self.columns:
                label = fitted(text, self.columns - column)
                whole = rows[row]
                rows[row] = whole[:column] + Text(label) + whole[column + len(label) :]
        return rows

    def _character(self, bits: int) -> str:
        if self.unicode:
            return chr(0x2800 + bits) if bits else " "
        return _PLAIN[min(len(_PLAIN) - 1, -(-bits.bit_count() // 2))]


def drawing_lines(drawing: Drawing, columns: int, rows: int, *, unicode: bool = True) -> list[Text]:
    """Return a drawing as lines of characters, in a given size."""
    canvas = Canvas(columns, rows, *drawing.stage, unicode)
    canvas.draw(drawing.parts)
    return canvas.lines()
