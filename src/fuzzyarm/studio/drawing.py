"""Drawings of the studio: control surfaces, terms and firing rules for narrow columns."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.inference.trace import RuleTrace, Trace
from fuzzyarm.model.rulebase import Variable
from fuzzyarm.model.shapes import membership
from fuzzyarm.show.drawing import Scale, marker
from fuzzyarm.show.rulebase import (
    blocks,
    name_words,
    number_words,
    ruler,
    shape_words,
    visible_range,
)
from fuzzyarm.show.trace import OutputPlot

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, Group, RenderableType
    from rich.text import Text


# --- Control surfaces in a terminal: two cells of colour to a character, or a line of dots ---

_NOTHING = "#808080"
_SHADES = "·░▒▓█"
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
    """

    values: Sequence[Sequence[float]]
    scale: Scale
    rows: tuple[str, float, float]
    columns: tuple[str, float, float]
    mark: tuple[int, int] | None = None

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        name, top, bottom = self.rows
        labels = {0: number_words(top, 3), len(self.values) - 2: number_words(bottom, 3)}
        middle = len(self.values) // 4 * 2
        labels.setdefault(middle, name)
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
        width = len(self.values[0])
        yield Text(f"{'':>{left}} {self._axis(width)}", "dim", no_wrap=True)

    def _cell(self, i: int, j: int, upper: float, lower: float) -> tuple[str, str]:
        if self.mark is not None and self.mark[0] // 2 == i // 2 and self.mark[1] == j:
            value = upper if self.mark[0] == i else lower
            ink = "black" if math.isnan(value) else self.scale.ink(value)
            return "◆", f"bold {ink} on {self._colour(value)}"
        return "▀", f"{self._colour(upper)} on {self._colour(lower)}"

    def _shade(self, i: int, j: int, upper: float, lower: float) -> tuple[str, str]:
        """Return the darker the higher, for terminals and files without colours."""
        if self.mark is not None and self.mark[0] // 2 == i // 2 and self.mark[1] == j:
            return "◆", ""
        known = [value for value in (upper, lower) if not math.isnan(value)]
        if not known:
            return " ", ""
        share = sum(map(self.scale.share, known)) / len(known)
        return _SHADES[min(len(_SHADES) - 1, int(share * len(_SHADES)))], ""

    def _colour(self, value: float) -> str:
        if math.isnan(value):
            return _NOTHING
        red, green, blue = self.scale.colour(value)
        return f"#{red:02x}{green:02x}{blue:02x}"

    def _axis(self, width: int) -> str:
        name, low, high = self.columns
        start, end = number_words(low, 3), number_words(high, 3)
        return start + name.center(max(0, width - len(start) - len(end))) + end


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
    """

    values: Sequence[float]
    height: int
    across: tuple[str, float, float]
    up: tuple[str, float, float]
    mark: int | None = None

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        name, low, high = self.up
        width = len(self.values) // 2
        cells = [[0] * width for _ in range(self.height)]
        dots = 4 * self.height
        before: int | None = None
        for i, value in enumerate(self.values[: 2 * width]):
            if math.isnan(value):
                before = None
                continue
            place = _place(value, low, high, dots)
            start = place if before is None else before
            for y in range(min(start, place), max(start, place) + 1):
                cells[y // 4][i // 2] |= _DOTS[i % 2][y % 4]
            before = place
        labels = {0: number_words(high, 3), self.height - 1: number_words(low, 3)}
        labels.setdefault(self.height // 2, name)
        left = max(map(len, labels.values()))
        marked = None if self.mark is None else self.mark // 2
        for k, row in enumerate(cells):
            line = Text(f"{labels.get(k, ''):>{left}} ", no_wrap=True, end="\n")
            for j, bits in enumerate(row):
                style = "bold red" if j == marked else "cyan"
                line.append(chr(0x2800 + bits) if bits or j != marked else "┊", style)
            yield line
        name, low, high = self.across
        start_text, end_text = number_words(low, 3), number_words(high, 3)
        room = max(0, width - len(start_text) - len(end_text))
        axis = start_text + name.center(room) + end_text
        yield Text(f"{'':>{left}} {axis}", "dim", no_wrap=True)


def _place(value: float, low: float, high: float, dots: int) -> int:
    share = 0.5 if high <= low else (value - low) / (high - low)
    return round((1.0 - min(1.0, max(0.0, share))) * (dots - 1))


# --- Drawings for narrow columns: the terms of a variable, and the rules that fire ---

_BAR = 8


def term_lines(variable: Variable, width: int, at: float | None = None) -> Text:
    """Return the terms of a variable, one to a line, with the membership of a crisp value."""
    from rich.text import Text

    text = Text(no_wrap=True, overflow="ellipsis")
    text.append(f"{name_words(variable.name)}  {variable.description}\n", "bold")
    names = [name_words(term.name) for term in variable.terms]
    left = max(map(len, names), default=0)
    columns = max(11, width - left - 10)
    columns -= 1 - columns % 2
    low, high = visible_range(variable)
    points = [low + (high - low) * i / (columns - 1) for i in range(columns)]
    for name, term in zip(names, variable.terms, strict=True):
        text.append(f" {name:<{left}} ")
        if not SHAPES[term.shape.kind].fuzzy:
            text.append(f"{shape_words(term.shape)}\n")
            continue
        degree = None if at is None else membership(term.shape, at)
        text.append(blocks(term.shape, points), "cyan" if degree is None or degree else "dim cyan")
        text.append("\n" if degree is None else f" {degree:.3f}\n", "bold" if degree else "dim")
    if at is not None:
        pointer = marker(at, low, high, columns)
        text.append(f" {'':<{left}} {pointer}\n", "bold red")
    text.append(f" {'':<{left}} {ruler(low, high, columns)}\n", "dim")
    return text


def firing_view(trace: Trace) -> Group:
    """Return the memberships, the rules that fire, the clipped sets and the outputs."""
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = []
    for value in trace.inputs:
        line = Text(f"{name_words(value.name)} {number_words(value.value, 4)}", "bold")
        for name, degree in value.degrees:
            if degree > 0:
                line.append(f"  {name_words(name)} ", "not bold")
                line.append(f"{degree:.3g}", "not bold cyan")
        parts.append(line)
    parts.append(Text(f"{len(trace.fired)} of {len(trace.rules)} rules fire", "bold"))
    parts += [_rule(rule) for rule in trace.fired]
    for output in trace.outputs:
        parts += [Text(), OutputPlot(output)]
    return Group(*parts)


def _rule(rule: RuleTrace) -> Text:
    from rich.text import Text

    bar = "█" * max(1, round(rule.strength * _BAR))
    line = Text(no_wrap=True, overflow="ellipsis")
    line.append(f" {rule.strength:.3f} ")
    line.append(f"{bar:<{_BAR}} ", "cyan")
    line.append(rule.text.removeprefix("if "))
    return line
