"""Block diagrams in the terminal: boxes and wires of line-drawing characters."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.diagram import Diagram
from fuzzyarm.apps.show.placement import ROUND, Pen, Picture, PlacedBlock, place

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.text import Text

UP, RIGHT, DOWN, LEFT = 1, 2, 4, 8
LINES = " ╵╶└╷│┌├╴┘─┴┐┤┬┼"
"""Line-drawing characters, by the sum of their directions."""

SIGNS = {"+": "+", "-": "−", "*": "×", "/": "÷"}


def _width(text: str, style: str) -> float:
    from rich.cells import cell_len

    return cell_len(text)


PEN = Pen(width_of=_width, line=1.0, pad=1.0, room=24.0, track=2.0, arrow=3.0)
"""In characters."""


@dataclass(frozen=True)
class DiagramView:
    """A block diagram; in a narrow terminal it is cropped, never wrapped.

    Attributes
    ----------
    diagram : Diagram
        Diagram of a controller or a rule base.
    """

    diagram: Diagram

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        for row in _Sheet(place(self.diagram, PEN)).rows():
            yield Text(row.rstrip(), no_wrap=True, overflow="ignore")


class _Sheet:
    """Characters by row and column; later ones overwrite earlier ones."""

    def __init__(self, picture: Picture) -> None:
        self.lines: dict[tuple[int, int], int] = defaultdict(int)
        self.letters: dict[tuple[int, int], str] = {}
        for start, end in picture.strokes:
            self._stroke(*map(round, (*start, *end)))
        for text, x, y, _ in picture.words:
            self._write(text, round(x), round(y) - 1)
        for block in picture.blocks:
            self._block(block, picture.pitch)
        for _, points in picture.wires:
            x, y = points[-1]
            self.letters[round(y), round(x) - 1] = "▶"

    def _stroke(self, x: int, y: int, to_x: int, to_y: int) -> None:
        (x, to_x), (y, to_y) = sorted((x, to_x)), sorted((y, to_y))
        for column in range(x, to_x):
            self.lines[y, column] |= RIGHT
            self.lines[y, column + 1] |= LEFT
        for row in range(y, to_y):
            self.lines[row, x] |= DOWN
            self.lines[row + 1, x] |= UP

    def _write(self, text: str, x: int, y: int) -> None:
        for k, letter in enumerate(text):
            self.letters[y, x + k] = letter

    def _block(self, placed: PlacedBlock, pitch: float) -> None:
        block, x, y, width, height, lines = placed
        left, right = round(x), round(x + width)
        top, bottom = round(y), round(y + height)
        if block.kind in ROUND:
            for row in range(top, bottom + 1):
                self._write("(" + " " * (right - left - 1) + ")", left, row)
            for word, _, at in placed.pins(pitch):
                self._write(SIGNS.get(word, word), (left + right) // 2, round(at))
            return
        for row in range(top + 1, bottom):
            self._write("│" + " " * (right - left - 1) + "│", left, row)
        self._write("┌" + "─" * (right - left - 1) + "┐", left, top)
        self._write("└" + "─" * (right - left - 1) + "┘", left, bottom)
        first = (top + bottom + 1 - len(lines)) // 2
        for k, (text, _) in enumerate(lines):
            self._write(text, left + (right - left + 1 - len(text)) // 2, first + k)

    def rows(self) -> Iterator[str]:
        """Yield the rows from the top."""
        places = self.lines.keys() | self.letters.keys()
        top = min((row for row, _ in places), default=0)
        bottom, right = (max((place[k] for place in places), default=-1) for k in (0, 1))
        for row in range(top, bottom + 1):
            yield "".join(
                self.letters.get((row, column), LINES[self.lines.get((row, column), 0)])
                for column in range(right + 1)
            )
