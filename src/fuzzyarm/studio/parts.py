"""Drawings for narrow columns: the terms of a variable, and the rules that fire."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.inference.trace import RuleTrace, Trace
from fuzzyarm.rulebase.membership import membership
from fuzzyarm.rulebase.model import Variable
from fuzzyarm.rulebase.shapes import SHAPES
from fuzzyarm.show.curves import marker
from fuzzyarm.show.terms import blocks, ruler, visible_range
from fuzzyarm.show.trace import OutputPlot
from fuzzyarm.show.words import name_words, number_words, shape_words

if TYPE_CHECKING:
    from rich.console import Group, RenderableType
    from rich.text import Text

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
