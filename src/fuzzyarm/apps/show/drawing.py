"""Elements of drawings in the terminal: console, colour scales, heat grids, curves."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import IO, TYPE_CHECKING, Any

from fuzzyarm.base.names import printable
from fuzzyarm.base.numbers import number_text

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.measure import Measurement
    from rich.text import Text


# --- Readable numbers ---


def number_words(x: float, digits: int = 6) -> str:
    """Return `x` with at most `digits` significant digits.

    Parameters
    ----------
    x : float
        Any number.
    digits : int
        At least 1.
    """
    rounded = float(f"{x:.{digits}g}") + 0.0
    return number_text(rounded)


def run_words(controller: str, plant: str) -> str:
    """Return controller and plant, ``servo on motor``; one name if both are equal."""
    return controller if controller == plant else f"{controller} on {plant}"


def time_words(seconds: float, end: float) -> str:
    """Return a time in a run until `end`, with sensible decimals."""
    return f"{seconds:.{2 if end < 20.0 else 1 if end < 200.0 else 0}f}"


# --- Console ---


_BLANKS = re.compile(r" +$", re.MULTILINE)


def make_console(file: IO[str] | None = None, **options: Any) -> Console:
    """Return a rich console that leaves numbers and brackets unchanged.

    It drops control characters in names and descriptions.

    Off a terminal it has no colours and 80 columns, unless overridden by the environment (COLUMNS,
    FORCE_COLOR, NO_COLOR).

    Parameters
    ----------
    file : file, optional
        Where to write; the standard output by default.
    **options
        Passed on to :class:`rich.console.Console`.
    """
    from rich.console import Console
    from rich.segment import Segment

    class PrintableConsole(Console):
        def render(
            self, renderable: RenderableType, options: ConsoleOptions | None = None
        ) -> Iterator[Segment]:
            for segment in super().render(renderable, options):
                text, style, control = segment
                if control or text == "\n" or text.isprintable():
                    yield segment
                else:
                    yield Segment("\n".join(map(printable, text.split("\n"))), style)

        def print(self, *objects: Any, **how: Any) -> None:
            # Cells are padded for their background colour; in plain text the blanks are noise.
            if self.is_terminal or self.is_jupyter or self.record:
                super().print(*objects, **how)
                return
            with self.capture() as captured:
                super().print(*objects, **how)
            self.file.write(_BLANKS.sub("", captured.get()))

        def on_broken_pipe(self) -> None:
            raise  # noqa: PLE0704 - rich would end the process with status 1

    settings: dict[str, Any] = {"highlight": False, "markup": False, "emoji": False}
    if file is not None:
        settings["force_jupyter"] = False  # else a notebook would show it as well
    return PrintableConsole(file=file, **(settings | options))


def plain_text(drawing: RenderableType, width: int = 80) -> str:
    """Return a drawing as text without colours, for logs, hovers and reports.

    Parameters
    ----------
    drawing : renderable of rich
        A drawing from :mod:`fuzzyarm.apps.show`.
    width : int
        Columns.
    """
    import io

    out = io.StringIO()
    console = make_console(out, width=width, no_color=True, force_terminal=False)
    console.print(drawing)
    return out.getvalue()


# --- Grids of texts with coloured cells: rules, tables, visits, differences ---

Cell = tuple[str, str]
"""The text of a cell and its style."""


@dataclass(frozen=True)
class HeatGrid:
    r"""Rows and columns with labels.

    In a narrow terminal the columns continue in bands below, so that no cell is cut off. Labels too
    long for a band of one column lose their middle. The texts are complete without colours.

    Attributes
    ----------
    corner : str
        Meaning of rows and columns, as ``e \ ce``.
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
        grid = self._for(options.max_width)
        left, widths = grid._left(), grid._widths()
        room = options.max_width - left
        # A space on either side of a text, or before it if there is little room.
        gap = 2 if sum(widths) + 2 * len(widths) <= room else 1
        for k, (start, stop) in enumerate(_bands([w + gap for w in widths], room)):
            if k:
                yield _line([])
            span = range(start, stop)
            parts = [(_padded(grid.corner, left), "bold")]
            parts += [(_boxed(grid.columns[j], widths[j], gap), "bold") for j in span]
            yield _line(parts)
            for label, row in zip(grid.rows, grid.cells, strict=True):
                parts = [(_padded(label, left), "bold")]
                parts += [(_boxed(row[j][0], widths[j], gap), row[j][1]) for j in span]
                yield _line(parts)

    def _for(self, width: int) -> HeatGrid:
        """Return this grid with labels that fit into a line."""
        left, widest = self._left(), max(self._widths(), default=0)
        if left + 1 + widest <= width:
            return self
        most = max(5, width // 3, width - 1 - widest)
        rows = [fitted(label, most) for label in self.rows]
        narrow = replace(self, corner=fitted(self.corner, most), rows=rows)
        most = max(3, width - 1 - narrow._left())
        return replace(narrow, columns=[fitted(label, most) for label in self.columns])

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
    """Yield the ranges of columns that fit side by side."""
    start, width_so_far = 0, 0
    for j, width in enumerate(widths):
        if j > start and width_so_far + width > room:
            yield start, j
            start, width_so_far = j, 0
        width_so_far += width
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


# --- Colour scales, common to terminal and figures ---
#
# Both scales are safe for colour-blind eyes: blue to red through near-white for signed values, dark
# blue to yellow for others.

_DIVERGING = ((33, 102, 172), (146, 197, 222), (247, 247, 247), (244, 165, 130), (178, 24, 43))
_SEQUENTIAL = ((68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37))


@dataclass(frozen=True, slots=True)
class Scale:
    """A range of numbers mapped to colours.

    Attributes
    ----------
    low, high : float
        The ends; numbers beyond them have the colour of the nearest end.
    diverging : bool
        Whether the middle, zero, is neutral.
    logarithmic : bool
        Whether equal ratios have equal distances; both ends are positive then.
    """

    low: float
    high: float
    diverging: bool
    logarithmic: bool = False

    def share(self, value: float) -> float:
        """Return the position of `value`, 0 at `low` and 1 at `high`."""
        if self.high <= self.low:
            return 0.5
        if self.logarithmic:
            share = math.log(max(value, self.low) / self.low) / math.log(self.high / self.low)
        else:
            share = (value - self.low) / (self.high - self.low)
        return min(1.0, max(0.0, share))

    def value(self, share: float) -> float:
        """Return the number at a position from 0 to 1."""
        if self.logarithmic:
            return self.low * math.pow(self.high / self.low, share)
        return self.low + share * (self.high - self.low)

    def colour(self, value: float) -> tuple[int, int, int]:
        """Return red, green and blue, 0 to 255."""
        stops = self.stops
        position = self.share(value) * (len(stops) - 1)
        i = min(int(position), len(stops) - 2)
        part = position - i
        red, green, blue = (
            round(a + part * (b - a)) for a, b in zip(stops[i], stops[i + 1], strict=True)
        )
        return red, green, blue

    def hexadecimal(self, value: float) -> str:
        """Return the colour as ``#rrggbb``."""
        return "#" + "".join(f"{part:02x}" for part in self.colour(value))

    def ink(self, value: float) -> str:
        """Return ``black`` or ``white``, whichever is readable on the colour of `value`."""
        red, green, blue = self.colour(value)
        return "black" if 0.299 * red + 0.587 * green + 0.114 * blue > 140 else "white"

    def style(self, value: float) -> str:
        """Return the terminal style of a cell with `value`."""
        return f"{self.ink(value)} on {self.hexadecimal(value)}"

    @property
    def stops(self) -> tuple[tuple[int, int, int], ...]:
        """The colours at even distances from `low` to `high`."""
        return _DIVERGING if self.diverging else _SEQUENTIAL


def scale_of(values: Iterable[float], low: float | None = None, high: float | None = None) -> Scale:
    """Return the scale for `values`: diverging and symmetric if they have both signs.

    Parameters
    ----------
    values : iterable of float
        Values to colour; non-finite ones are ignored.
    low, high : float, optional
        Range of the variable, which extends the scale if it is finite.
    """
    ends = [x for x in (*values, low, high) if x is not None and math.isfinite(x)]
    if not ends:
        return Scale(0.0, 1.0, diverging=False)
    least, most = min(ends), max(ends)
    if least < 0.0 < most:
        reach = max(-least, most)
        return Scale(-reach, reach, diverging=True)
    return Scale(least, most, diverging=False)


_SHADES = "·░▒▓█"


def shade(share: float) -> str:
    """Return a character as dark as the share, for output without colours."""
    return _SHADES[min(len(_SHADES) - 1, int(share * len(_SHADES)))]


@dataclass(frozen=True)
class ScaleBar:
    """A scale as a line of colours between its ends.

    Attributes
    ----------
    scale : Scale
        The stretch of numbers.
    width : int
        Width of the whole line in characters.
    name : str
        Name of the quantity, omitted if there is no room.
    """

    scale: Scale
    width: int
    name: str = ""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        low, high = (_compact(x, 3) for x in (self.scale.low, self.scale.high))
        name = f"{fitted(self.name, self.width // 3)} " if self.name else ""
        room = self.width - len(name) - len(low) - len(high) - 2
        line = Text(no_wrap=True, overflow="ellipsis")
        line.append(f"{name}{low} ", "dim")
        plain = console.color_system is None or console.no_color
        for k in range(max(2, room)):
            share = (k + 0.5) / max(2, room)
            value = self.scale.value(share)
            if plain:
                line.append(shade(share))
            else:
                line.append(" ", f"on {self.scale.hexadecimal(value)}")
        line.append(f" {high}", "dim")
        yield line


# --- Piecewise-linear curves as a row of blocks ---

Curve = Sequence[tuple[float, float]]

_BLOCKS = " ▁▂▃▄▅▆▇█"


def block(height: float) -> str:
    """Return the block for a height from 0 to 1; anything above one hundredth is visible."""
    if height <= 0.01:
        return " "
    return _BLOCKS[max(1, min(8, round(8 * height)))]


def curve_blocks(curve: Curve, low: float, high: float, width: int) -> str:
    """Return the greatest height of `curve` in each of `width` equal parts."""
    step = (high - low) / (width - 1)
    edges = [low + (i - 0.5) * step for i in range(width + 1)]
    return "".join(block(_largest(curve, a, b)) for a, b in pairwise(edges))


def marker(value: float, low: float, high: float, width: int) -> str:
    """Return a line with ``^`` at the position of `value`; empty for NaN."""
    if not math.isfinite(value):
        return ""
    column = round((value - low) / (high - low) * (width - 1))
    return " " * max(0, min(width - 1, column)) + "^"


def fitted(text: str, room: int) -> str:
    """Return a text of at most `room` characters, shortened in the middle, where names agree."""
    if len(text) <= room:
        return text
    length = max(0, room - 1)
    return f"{text[: (length + 1) // 2]}…{text[len(text) - length // 2 :]}" if room > 0 else ""


def ruler(low: float, high: float, width: int, name: str = "") -> str:
    """Return the ends of a range, and its middle or a name, over `width` characters.

    Without enough room for all, the middle is omitted first.
    """
    for digits in (4, 3, 2, 1):
        left, right = (_compact(x, digits) for x in (low, high))
        room = width - len(left) - len(right) - 2
        if room >= -1:
            break
    else:
        return ""
    middle = fitted(name, room) if name else _compact(0.5 * (low + high), 4)
    line = [" "] * width
    line[: len(left)] = left
    line[width - len(right) :] = right
    start = width // 2 - len(middle) // 2
    if name:  # centred between the ends
        start = len(left) + 1 + (room - len(middle)) // 2
    if len(left) < start and start + len(middle) < width - len(right):
        line[start : start + len(middle)] = middle
    return "".join(line)


def _compact(x: float, digits: int) -> str:
    """Return a number in few characters: a million is 1e6."""
    words = number_words(x, digits)
    power = f"{x:.{digits - 1}e}"
    short = re.sub(r"\.?0*e([+-])0*", lambda match: "e" + match[1].strip("+"), power)
    return short if len(short) < len(words) - 1 else words


def height_at(curve: Curve, x: float) -> float:
    """Return the height of `curve` at `x`: the larger at a vertical edge, 0 outside."""
    heights = [0.0]
    for (x0, y0), (x1, y1) in pairwise(curve):
        if x0 <= x <= x1:
            heights += [y0, y1] if x1 == x0 else [y0 + (y1 - y0) * (x - x0) / (x1 - x0)]
    return max(heights)


def _largest(curve: Curve, start: float, end: float) -> float:
    # The value at the middle makes falling and rising edges look the same; corners inside are added
    # so that no peak is missed.
    inside = [y for x, y in curve if start <= x < end]
    return max([height_at(curve, 0.5 * (start + end)), *inside])
