"""A grid of texts, coloured by numbers: for rules, tables, visits and differences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.measure import Measurement
    from rich.text import Text

Cell = tuple[str, str]
"""The text of a cell and its style."""


@dataclass(frozen=True)
class HeatGrid:
    r"""Rows and columns with labels.

    Where the terminal is too narrow, the columns go on in further bands below: nothing is
    cut off. Without colours the texts say everything.

    Attributes
    ----------
    corner : str
        What the rows and the columns are, as ``e \ ce``.
    columns, rows : sequence of str
        The labels.
    cells : sequence of sequence of (str, str)
        Text and style, row by row.
    """

    corner: str
    columns: Sequence[str]
    rows: Sequence[str]
    cells: Sequence[Sequence[Cell]]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        left, widths = self._left(), self._widths()
        room = options.max_width - left
        # A space on either side of a text looks better, one in front of it is enough.
        gap = 2 if sum(widths) + 2 * len(widths) <= room else 1
        for k, (start, stop) in enumerate(_bands([w + gap for w in widths], room)):
            if k:
                yield _line([])
            span = range(start, stop)
            parts = [(_padded(self.corner, left), "bold")]
            parts += [(_boxed(self.columns[j], widths[j], gap), "bold") for j in span]
            yield _line(parts)
            for label, row in zip(self.rows, self.cells, strict=True):
                parts = [(_padded(label, left), "bold")]
                parts += [(_boxed(row[j][0], widths[j], gap), row[j][1]) for j in span]
                yield _line(parts)

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        from rich.measure import Measurement

        left, widths = self._left(), self._widths()
        least = left + 1 + max(widths, default=0)
        most = left + sum(widths) + 2 * len(widths)
        return Measurement(min(least, options.max_width), min(most, options.max_width))

    def _left(self) -> int:
        return max(map(_width, (self.corner, *self.rows)))

    def _widths(self) -> list[int]:
        return [
            max([_width(label), *(_width(row[j][0]) for row in self.cells)])
            for j, label in enumerate(self.columns)
        ]


def _boxed(text: str, width: int, gap: int) -> str:
    return " " + _padded(text, width) + " " * (gap - 1)


def _bands(widths: Sequence[int], room: int) -> Iterator[tuple[int, int]]:
    """Yield the stretches of columns that fit next to each other."""
    start, used = 0, 0
    for j, width in enumerate(widths):
        if j > start and used + width > room:
            yield start, j
            start, used = j, 0
        used += width
    yield start, len(widths)


def _padded(text: str, width: int) -> str:
    return " " * (width - _width(text)) + text


def _width(text: str) -> int:
    from rich.cells import cell_len

    return cell_len(text)


def _line(parts: Sequence[Cell]) -> Text:
    from rich.text import Text

    text = Text(no_wrap=True, overflow="ignore", end="\n")
    for part, style in parts:
        text.append(part, style)
    return text
