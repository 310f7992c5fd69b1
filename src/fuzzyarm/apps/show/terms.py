"""The terms of a variable: their shapes in words, and as small plots of blocks."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.drawing import block, fitted, marker, number_words, ruler
from fuzzyarm.base.numbers import number_text
from fuzzyarm.base.picture import Band, Line
from fuzzyarm.language.model.rulebase import RuleBase, Shape, Variable
from fuzzyarm.language.model.shapes import corner_points, membership
from fuzzyarm.language.phrases import sum_text
from fuzzyarm.language.tokens import name_text
from fuzzyarm.language.writer import shape_node
from fuzzyarm.symbolic.kinds import SHAPES

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.text import Text


def is_set(shape: Shape) -> bool:
    """Whether a shape has memberships to draw; consequents of Takagi and Sugeno have none."""
    return SHAPES[shape.kind].fuzzy


def shape_words(
    shape: Shape, rulebase: RuleBase | None = None, *, digits: int | None = None
) -> str:
    """Return a shape with its numbers, in full or with a few `digits`.

    Parameters
    ----------
    shape : Shape
        Any shape.
    rulebase : RuleBase, optional
        Rule base with the inputs of a ``linear`` consequent.
    digits : int, optional
        Significant digits; all by default.
    """
    if shape.kind == "formula":
        return f"formula {shape.formula}"
    spell = number_text if digits is None else partial(number_words, digits=digits)
    if shape.kind == "linear":
        return _linear_words(shape, rulebase, spell)
    numbers = " ".join(spell(x) for x in shape.parameters)
    height = "" if shape.height == 1.0 else f" height {number_text(shape.height)}"
    return f"{shape.kind} {numbers}{height}"


def _linear_words(shape: Shape, rulebase: RuleBase | None, spell: Callable[[float], str]) -> str:
    count = len(shape.parameters) - 1
    names = [v.name for v in rulebase.inputs] if rulebase else [f"x{k}" for k in range(count)]
    return f"linear {sum_text(shape_node(shape, names).parts, spell)}"


def visible_range(variable: Variable) -> tuple[float, float]:
    """Return the range to draw: the variable's, or that of its terms if it is unbounded.

    Parameters
    ----------
    variable : Variable
        Any variable.
    """
    corners = [x for term in variable.terms for x in corner_points(term.shape)]
    low = variable.low if math.isfinite(variable.low) else min(corners, default=-1.0)
    high = variable.high if math.isfinite(variable.high) else max(corners, default=1.0)
    return (low, high) if low < high else (low - 1.0, low + 1.0)


# --- Membership functions as parts of a picture ---


def membership_line(
    shape: Shape, low: float, high: float, count: int, *, upright: bool = True
) -> Line:
    """Return a membership function at `count` even positions and at its corners.

    With `upright` edges both sides of a corner are added. NaN replaces zeros between zeros, so that
    no line is on the axis.
    """
    xs = _places((shape,), low, high, count, upright=upright)
    ys = [membership(shape, x) for x in xs]
    around = zip([0.0, *ys[:-1]], ys, [*ys[1:], 0.0], strict=True)
    return Line(xs, [math.nan if not any(near) else near[1] for near in around])


def footprint(upper: Shape, lower: Shape, low: float, high: float, count: int) -> Band:
    """Return the area between both membership functions of an interval type-2 term."""
    xs = _places((upper, lower), low, high, count)
    below, above = ([membership(shape, x) for x in xs] for shape in (lower, upper))
    return Band(xs, below, above, opacity=0.25)


def _places(
    shapes: Sequence[Shape], low: float, high: float, count: int, *, upright: bool = True
) -> list[float]:
    """Return even positions and all corners, with both sides of them for upright edges."""
    xs = [low + (high - low) * i / (count - 1) for i in range(count)]
    for shape in shapes:
        for x in corner_points(shape):
            sides = (math.nextafter(x, -math.inf), math.nextafter(x, math.inf)) if upright else ()
            xs += [x, *sides]
    return sorted(x for x in xs if low <= x <= high)


_WIDEST = 61
_LONG = 30
"""Longer numbers of a shape do not narrow the plots."""


@dataclass(frozen=True)
class TermPlots:
    """The terms of one variable over its range, one to a line.

    Attributes
    ----------
    variable : Variable
        Variable of the terms.
    rulebase : RuleBase or None
        Rule base with the names in ``linear`` consequents.
    at : float or None
        A crisp value, whose memberships are added.
    width : int or None
        Width of the narrow layout, without the numbers of the shapes and with a mark below the
        crisp value. None: the wide layout.
    """

    variable: Variable
    rulebase: RuleBase | None = None
    at: float | None = None
    width: int | None = None

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        return self._wide(options.max_width) if self.width is None else self._narrow(self.width)

    def _wide(self, room: int) -> Iterator[Text]:
        from rich.text import Text

        variable = self.variable
        span = f"{number_words(variable.low)} .. {number_words(variable.high)}"
        heading = f"{name_text(variable.name)}  {span}  {variable.description}"
        yield Text(heading.rstrip(), style="bold")
        names = [name_text(term.name) for term in variable.terms]
        words = [shape_words(term.shape, self.rulebase, digits=5) for term in variable.terms]
        behind_over = [
            shape_words(term.lower, self.rulebase, digits=5) if term.lower is not None else ""
            for term in variable.terms
        ]
        if not names:
            return
        left = max(map(len, names))
        lengths = [len(text) for text in (*words, *behind_over) if len(text) <= _LONG]
        behind = max(lengths, default=0)
        room -= left + 5 + behind + (7 if self.at is not None else 0)
        width = max(15, min(_WIDEST, room))
        width -= 1 - width % 2  # an odd number has a middle
        has_set = False
        left = max(left, 4) if any(behind_over) else left
        for name, term, shape, lower in zip(names, variable.terms, words, behind_over, strict=True):
            line = Text(f"  {name:<{left}} ", no_wrap=len(shape) <= _LONG, overflow="fold")
            yield self._with_shape(line, term.shape, shape, width, "dim " if lower else "")
            if term.lower is not None:  # between the two is the footprint of uncertainty
                line = Text(f"  {'over':>{left}} ", no_wrap=len(lower) <= _LONG, overflow="fold")
                yield self._with_shape(line, term.lower, lower, width, "")
            has_set = has_set or is_set(term.shape)
        if has_set:
            axis = ruler(*visible_range(variable), width)
            yield Text(f"  {'':<{left}} {axis}", "dim", no_wrap=True)

    def _with_shape(self, line: Text, shape: Shape, words: str, width: int, style: str) -> Text:
        """Return a line with the blocks of a set, its numbers, and its membership of the value."""
        if not is_set(shape):
            return line.append(words)
        line.append(self._blocks(shape, width), f"{style}cyan")
        line.append(f" {words}", "dim")
        if self.at is not None:
            line.append(f"  {membership(shape, self.at):.3f}", "bold")
        return line

    def _narrow(self, width: int) -> Iterator[Text]:
        from rich.text import Text

        line = partial(Text, no_wrap=True, overflow="ellipsis")
        variable = self.variable
        yield line(f"{name_text(variable.name)}  {variable.description}", "bold")
        names = [fitted(name_text(term.name), width // 3) for term in variable.terms]
        left = max(map(len, names), default=0)
        width = max(11, width - left - 10)
        width -= 1 - width % 2
        for name, term in zip(names, variable.terms, strict=True):
            text = line(f" {name:<{left}} ")
            if not is_set(term.shape):
                text.append(shape_words(term.shape))
            elif self.at is None:
                text.append(self._blocks(term.shape, width), "cyan")
            else:
                degree = membership(term.shape, self.at)
                text.append(self._blocks(term.shape, width), "cyan" if degree else "dim cyan")
                text.append(f" {degree:.3f}", "bold" if degree else "dim")
            yield text
            if term.lower is not None and is_set(term.lower):
                text = line(f" {'over':>{left}} ")
                text.append(self._blocks(term.lower, width), "cyan")
                if self.at is not None:
                    text.append(f" {membership(term.lower, self.at):.3f}", "dim")
                yield text
        low, high = visible_range(variable)
        if self.at is not None:
            yield line(f" {'':<{left}} {marker(self.at, low, high, width)}", "bold red")
        yield line(f" {'':<{left}} {ruler(low, high, width)}", "dim")
        yield Text()

    def _blocks(self, shape: Shape, width: int) -> str:
        """Return the membership in `width` blocks; a peak in between goes to the nearer one."""
        low, high = visible_range(self.variable)
        line = membership_line(shape, low, high, width, upright=False)
        # The step as in the positions of the line: rounded together with `low`.
        heights, step = [0.0] * width, low + (high - low) / (width - 1) - low
        for x, y in zip(line.x, line.y, strict=True):
            # Over a few ulps the step vanishes in the rounding of `low`.
            column = round((x - low) / step if step else (x - low) / (high - low) * (width - 1))
            heights[column] = max(heights[column], 0.0 if math.isnan(y) else y)
        return "".join(map(block, heights))
