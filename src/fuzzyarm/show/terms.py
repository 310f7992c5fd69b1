"""The terms of a variable as small plots of blocks: one line for each term."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyarm.rulebase.geometry import corner_points
from fuzzyarm.rulebase.membership import membership
from fuzzyarm.rulebase.model import RuleBase, Shape, Variable
from fuzzyarm.rulebase.shapes import SHAPES
from fuzzyarm.show.curves import block
from fuzzyarm.show.words import name_words, number_words, shape_words

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.text import Text

_WIDEST = 61


@dataclass(frozen=True)
class TermPlots:
    """The terms of one variable over its range.

    Attributes
    ----------
    variable : Variable
        Whose terms are drawn.
    rulebase : RuleBase or None
        Gives the names in ``linear`` consequents.
    at : float or None
        A crisp value to mark, with the membership of each term there.
    """

    variable: Variable
    rulebase: RuleBase | None = None
    at: float | None = None

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        yield Text(variable_words(self.variable), style="bold")
        names = [name_words(term.name) for term in self.variable.terms]
        words = [shape_words(term.shape, self.rulebase, digits=5) for term in self.variable.terms]
        if not names:
            return
        left = max(map(len, names))
        behind = max((len(text) for text in words if len(text) <= 30), default=0)
        room = options.max_width - left - 5 - behind - (7 if self.at is not None else 0)
        width = max(15, min(_WIDEST, room))
        width -= 1 - width % 2  # an odd number has a middle
        low, high = visible_range(self.variable)
        points = [low + (high - low) * i / (width - 1) for i in range(width)]
        drawn = False
        for name, term, shape in zip(names, self.variable.terms, words, strict=True):
            line = Text(f"  {name:<{left}} ", no_wrap=len(shape) <= 30, overflow="fold")
            if SHAPES[term.shape.kind].fuzzy:
                line.append(blocks(term.shape, points), "cyan")
                line.append(f" {shape}", "dim")
                drawn = True
            else:
                line.append(shape)
            if self.at is not None and SHAPES[term.shape.kind].fuzzy:
                line.append(f"  {membership(term.shape, self.at):.3f}", "bold")
            yield line
        if drawn:
            yield Text(f"  {'':<{left}} {ruler(low, high, width)}", "dim", no_wrap=True)


def variable_words(variable: Variable) -> str:
    """Return the name, the range and the description of a variable in one line."""
    span = f"{number_words(variable.low)} .. {number_words(variable.high)}"
    text = f"{name_words(variable.name)}  {span}"
    return f"{text}  {variable.description}" if variable.description else text


def visible_range(variable: Variable) -> tuple[float, float]:
    """Return the range to draw: that of the variable, or of its terms where it is unbounded."""
    corners = [x for term in variable.terms for x in corner_points(term.shape)]
    low = variable.low if math.isfinite(variable.low) else min(corners, default=-1.0)
    high = variable.high if math.isfinite(variable.high) else max(corners, default=1.0)
    return (low, high) if low < high else (low - 1.0, low + 1.0)


def blocks(shape: Shape, points: list[float]) -> str:
    """Return the membership at `points` in blocks of eight heights.

    A peak between two points shows on the nearer one.
    """
    degrees = [membership(shape, x) for x in points]
    if len(points) > 1:
        step = points[1] - points[0]
        for x in corner_points(shape):
            i = round((x - points[0]) / step)
            if 0 <= i < len(points) and points[0] <= x <= points[-1]:
                degrees[i] = max(degrees[i], membership(shape, x))
    return "".join(block(degree) for degree in degrees)


def ruler(low: float, high: float, width: int) -> str:
    """Return the ends and the middle of a range, spread over `width` characters."""
    left, middle, right = (number_words(x, 4) for x in (low, 0.5 * (low + high), high))
    line = [" "] * width
    line[: len(left)] = left
    line[width - len(right) :] = right
    start = width // 2 - len(middle) // 2
    if len(left) < start and start + len(middle) < width - len(right):
        line[start : start + len(middle)] = middle
    return "".join(line)
