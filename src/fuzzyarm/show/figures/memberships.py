"""The terms of variables as curves."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

from fuzzyarm.rulebase.geometry import centre, corner_points
from fuzzyarm.rulebase.membership import membership
from fuzzyarm.rulebase.model import Input, Output, RuleBase, Term, Variable
from fuzzyarm.rulebase.shapes import SHAPES
from fuzzyarm.show.figures.style import axis_label, line_style, new_figure, safe, tidy
from fuzzyarm.show.terms import visible_range
from fuzzyarm.show.words import shape_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_POINTS = 401


def memberships_figure(rulebase: RuleBase) -> Figure:
    """Return one panel for each variable of `rulebase`, inputs first."""
    variables: tuple[Input | Output, ...] = (*rulebase.inputs, *rulebase.outputs)
    figure = new_figure(7.0, 0.6 + 1.9 * len(variables))
    panels = figure.subplots(len(variables), 1, squeeze=False)
    for axes, variable in zip(panels[:, 0], variables, strict=True):
        draw_memberships(axes, variable, rulebase)
    figure.suptitle(safe(rulebase.name), fontweight="bold")
    return figure


def draw_memberships(axes: Axes, variable: Variable, rulebase: RuleBase | None = None) -> None:
    """Draw the terms of one variable, each named at its peak."""
    low, high = visible_range(variable)
    words: list[str] = []
    drawn = 0
    for k, term in enumerate(variable.terms):
        if not SHAPES[term.shape.kind].fuzzy:
            words.append(f"{term.name}: {shape_words(term.shape, rulebase, digits=4)}")
            continue
        style = line_style(k)
        if term.shape.kind == "singleton":
            x = term.shape.parameters[0]
            axes.vlines(x, 0, term.shape.height, colors=style["color"], linewidth=2)
            axes.plot([x], [term.shape.height], "o", color=style["color"], markersize=4)
        else:
            xs, ys = _curve(term, low, high)
            axes.plot(xs, ys, linewidth=1.6, **style)
        drawn += 1
    _name_terms(axes, variable, low, high)
    if words:
        axes.text(
            0.02, 0.95, safe("\n".join(words)), transform=axes.transAxes, va="top", fontsize=8,
            family="monospace",
        )  # fmt: skip
    tidy(axes)
    margin = 0.02 * (high - low)
    axes.set_xlim(low - margin, high + margin)
    axes.set_ylim(0, 1.22)
    axes.set_yticks([0, 0.5, 1] if drawn else [])
    axes.set_xlabel(axis_label(variable.name, variable.description), fontsize=9)
    axes.set_ylabel("membership" if drawn else "", fontsize=8)


def _curve(term: Term, low: float, high: float) -> tuple[list[float], list[float]]:
    """Return points on the curve, with both sides of every corner, so that edges are upright."""
    xs = [low + (high - low) * i / (_POINTS - 1) for i in range(_POINTS)]
    for x in corner_points(term.shape):
        xs += [math.nextafter(x, -math.inf), x, math.nextafter(x, math.inf)]
    xs = sorted(x for x in xs if low <= x <= high)
    ys = [membership(term.shape, x) for x in xs]
    # Where a term is zero on both sides as well, no line lies on the axis.
    around = zip([0.0, *ys[:-1]], ys, [*ys[1:], 0.0], strict=True)
    return xs, [math.nan if not any(near) else near[1] for near in around]


def _name_terms(axes: Axes, variable: Variable, low: float, high: float) -> None:
    """Write the names above the peaks; names that would run into each other are turned."""
    places: list[tuple[float, float, str, str]] = []
    for k, term in enumerate(variable.terms):
        middle = centre(term.shape, low, high)
        if middle is None:
            continue
        if term.shape.kind == "trapezoid":  # a shoulder is named above its visible top
            a, b = max(term.shape.parameters[1], low), min(term.shape.parameters[2], high)
            middle = 0.5 * (a + b) if a <= b else middle
        top = min(1.0, membership(term.shape, middle))
        places.append((middle, top, term.name, str(line_style(k)["color"])))
    places.sort()
    gaps = [b[0] - a[0] for a, b in pairwise(places)]
    room = min(gaps, default=high - low) / (high - low)
    longest = max((len(name) for _, _, name, _ in places), default=0)
    angle = 0 if longest * 0.016 <= room else 30
    for x, y, name, colour in places:
        align = "left" if angle else "center"
        if not angle and x <= low + 0.01 * (high - low):
            align = "left"
        elif not angle and x >= high - 0.01 * (high - low):
            align = "right"
        axes.text(
            x, y + 0.03, safe(name), color=colour, fontsize=8, ha=align, va="bottom",
            rotation=angle, rotation_mode="anchor",
        )  # fmt: skip
