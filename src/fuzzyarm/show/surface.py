"""Control surfaces in a terminal: two cells of colour to a character, or a line of dots."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyarm.show.drawing import Scale, fitted, number_words, ruler, shade

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.text import Text

FAILS = "✗"
"""Where a property fails."""

_NOTHING = "#808080"
_LEFT = 8
"""Letters of the name of what goes down or up."""

_DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))


@dataclass(frozen=True)
class SurfaceMap:
    """A surface seen from above.

    Attributes
    ----------
    values : sequence of sequence of float
        An even number of rows, the first at the top; NaN where there is no value.
    scale : Scale
        Colours.
    rows, columns : (str, float, float)
        Name and ends of what goes down and of what goes across.
    mark : (int, int) or None
        Row and column of the crisp inputs.
    fails : frozenset of (int, int)
        Rows and columns at which a property fails.
    """

    values: Sequence[Sequence[float]]
    scale: Scale
    rows: tuple[str, float, float]
    columns: tuple[str, float, float]
    mark: tuple[int, int] | None = None
    fails: frozenset[tuple[int, int]] = frozenset()

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        name, top, bottom = self.rows
        labels = {0: number_words(top, 3), len(self.values) - 2: number_words(bottom, 3)}
        middle = len(self.values) // 4 * 2
        labels.setdefault(middle, fitted(name, _LEFT))
        left = max(map(len, labels.values()))
        plain = console.color_system is None or console.no_color
        cell = self._shade if plain else self._cell
        for i in range(0, len(self.values), 2):
            line = Text(f"{labels.get(i, ''):>{left}} ", no_wrap=True, end="\n")
            for j, (upper, lower) in enumerate(
                zip(self.values[i], self.values[i + 1], strict=True)
            ):
                line.append(*cell(i, j, upper, lower))
            yield line
        column, low, high = self.columns
        axis = ruler(low, high, len(self.values[0]), column)
        yield Text(f"{'':>{left}} {axis}", "dim", no_wrap=True)

    def _is_marked(self, i: int, j: int) -> bool:
        return self.mark is not None and (self.mark[0] // 2 * 2, self.mark[1]) == (i, j)

    def _fails(self, i: int, j: int) -> bool:
        return bool(self.fails & {(i, j), (i + 1, j)})

    def _cell(self, i: int, j: int, upper: float, lower: float) -> tuple[str, str]:
        if self._fails(i, j):
            return FAILS, f"bold red on {self._colour(upper)}"
        if self._is_marked(i, j):
            value = upper if self.mark == (i, j) else lower
            ink = "black" if math.isnan(value) else self.scale.ink(value)
            return "◆", f"bold {ink} on {self._colour(value)}"
        return "▀", f"{self._colour(upper)} on {self._colour(lower)}"

    def _shade(self, i: int, j: int, upper: float, lower: float) -> tuple[str, str]:
        """Return the darker the higher, for terminals and files without colours."""
        if self._fails(i, j):
            return FAILS, ""
        if self._is_marked(i, j):
            return "◆", ""
        known = [value for value in (upper, lower) if not math.isnan(value)]
        if not known:
            return " ", ""
        share = sum(map(self.scale.share, known)) / len(known)
        return shade(share), ""

    def _colour(self, value: float) -> str:
        return _NOTHING if math.isnan(value) else self.scale.hexadecimal(value)


@dataclass(frozen=True)
class LinePlot:
    """An output over one input, in dots of an eighth of a character.

    Attributes
    ----------
    values : sequence of float
        Two to a column; NaN where there is no value.
    height : int
        Lines of text.
    across, up : (str, float, float)
        Name and ends of the input and of the output.
    mark : int or None
        Which value is that of the crisp input.
    fails : frozenset of int
        Values at which a property fails.
    ends : (str, str) or None
        What stands at the ends of the output, where not its numbers.
    """

    values: Sequence[float]
    height: int
    across: tuple[str, float, float]
    up: tuple[str, float, float]
    mark: int | None = None
    fails: frozenset[int] = frozenset()
    ends: tuple[str, str] | None = None

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        name, low, high = self.up
        bottom, top = self.ends or (number_words(low, 3), number_words(high, 3))
        width = len(self.values) // 2
        cells = [[0] * width for _ in range(self.height)]
        dots = 4 * self.height
        before: int | None = None
        for i, value in enumerate(self.values[: 2 * width]):
            if math.isnan(value):
                before = None
                continue
            dot = _dot(value, low, high, dots)
            start = dot if before is None else before
            for y in range(min(start, dot), max(start, dot) + 1):
                cells[y // 4][i // 2] |= _DOTS[i % 2][y % 4]
            before = dot
        labels = {0: top, self.height - 1: bottom}
        labels.setdefault(self.height // 2, fitted(name, _LEFT))
        left = max(map(len, labels.values()))
        marked = None if self.mark is None else self.mark // 2
        failing = {i // 2: self._line_of(i, low, high) for i in self.fails if i < len(self.values)}
        for k, row in enumerate(cells):
            line = Text(f"{labels.get(k, ''):>{left}} ", no_wrap=True, end="\n")
            for j, bits in enumerate(row):
                style = "bold red" if j == marked or failing.get(j) == k else "cyan"
                if failing.get(j) == k:
                    line.append(FAILS, style)
                    continue
                line.append(chr(0x2800 + bits) if bits or j != marked else "┊", style)
            yield line
        variable, first, last = self.across
        axis = ruler(first, last, width, variable)
        yield Text(f"{'':>{left}} {axis}", "dim", no_wrap=True)

    def _line_of(self, index: int, low: float, high: float) -> int:
        """Return the line of text that a value stands in; the lowest where there is none."""
        value = self.values[index]
        return (
            self.height - 1 if math.isnan(value) else _dot(value, low, high, 4 * self.height) // 4
        )


def _dot(value: float, low: float, high: float, dots: int) -> int:
    share = 0.5 if high <= low else (value - low) / (high - low)
    return round((1.0 - min(1.0, max(0.0, share))) * (dots - 1))
