"""Figures of rule bases: memberships, one inference, a whole rule base on one page."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from fuzzyarm.model.rulebase import RuleBase, Shape, Term, Variable
from fuzzyarm.model.shapes import centre, corner_points, membership
from fuzzyarm.show.drawing import number_words
from fuzzyarm.show.figures.style import (
    COLOURS,
    axis_label,
    line_style,
    new_figure,
    safe,
    set_range,
    tidy,
)
from fuzzyarm.show.figures.surface import draw_response
from fuzzyarm.show.terms import is_set, shape_words, visible_range

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.inference.trace import ConsequentTrace, OutputTrace, Trace


# --- The terms of variables as curves ---

_POINTS = 401


def memberships_figure(rulebase: RuleBase) -> Figure:
    """Return one panel for each variable of `rulebase`, inputs first."""
    variables: tuple[Variable, ...] = (*rulebase.inputs, *rulebase.outputs)
    figure = new_figure(7.0, 0.6 + 1.9 * len(variables))
    panels = figure.subplots(len(variables), 1, squeeze=False)
    for axes, variable in zip(panels[:, 0], variables, strict=True):
        _draw_memberships(axes, variable, rulebase)
    figure.suptitle(safe(rulebase.name), fontweight="bold")
    return figure


def _draw_memberships(axes: Axes, variable: Variable, rulebase: RuleBase | None = None) -> None:
    """Draw the terms of one variable, each named at its peak."""
    low, high = visible_range(variable)
    words: list[str] = []
    drawn = 0
    for k, term in enumerate(variable.terms):
        if not is_set(term.shape):
            words.append(f"{term.name}: {shape_words(term.shape, rulebase, digits=4)}")
            continue
        style = line_style(k)
        if term.shape.kind == "singleton":
            x = term.shape.parameters[0]
            axes.vlines(x, 0, term.shape.height, colors=style["color"], linewidth=2)
            axes.plot([x], [term.shape.height], "o", color=style["color"], markersize=4)
        else:
            xs, ys = _curve(term.shape, low, high)
            axes.plot(xs, ys, linewidth=1.6, **style)
            if term.lower is not None:  # between the two lies the footprint of uncertainty
                _fill_footprint(axes, term, low, high, style)
        drawn += 1
    _name_terms(axes, variable, low, high)
    if words:
        axes.text(
            0.02, 0.95, safe("\n".join(words)), transform=axes.transAxes, va="top", fontsize=8,
            family="monospace",
        )  # fmt: skip
    tidy(axes)
    set_range(axes, low, high)
    axes.set_ylim(0, 1.22)
    axes.set_yticks([0, 0.5, 1] if drawn else [])
    axes.set_xlabel(axis_label(variable.name, variable.description), fontsize=9)
    axes.set_ylabel("membership" if drawn else "", fontsize=8)


def _fill_footprint(
    axes: Axes, term: Term, low: float, high: float, style: Mapping[str, Any]
) -> None:
    """Draw the lower membership function, and fill what is between it and the upper one."""
    assert term.lower is not None
    xs = _positions((term.shape, term.lower), low, high)
    below, above = ([membership(shape, x) for x in xs] for shape in (term.lower, term.shape))
    axes.fill_between(xs, below, above, color=style["color"], alpha=0.25, linewidth=0)
    xs, below = _curve(term.lower, low, high)
    axes.plot(xs, below, color=style["color"], linewidth=0.9)


def _positions(shapes: Sequence[Shape], low: float, high: float) -> list[float]:
    """Return even positions and both sides of every corner."""
    xs = [low + (high - low) * i / (_POINTS - 1) for i in range(_POINTS)]
    for shape in shapes:
        for x in corner_points(shape):
            xs += [math.nextafter(x, -math.inf), x, math.nextafter(x, math.inf)]
    return sorted(x for x in xs if low <= x <= high)


def _curve(shape: Shape, low: float, high: float) -> tuple[list[float], list[float]]:
    """Return points on the curve, with both sides of every corner, so that edges are upright."""
    xs = _positions((shape,), low, high)
    ys = [membership(shape, x) for x in xs]
    # Where a term is zero on both sides as well, no line lies on the axis.
    around = zip([0.0, *ys[:-1]], ys, [*ys[1:], 0.0], strict=True)
    return xs, [math.nan if not any(near) else near[1] for near in around]


def _name_terms(axes: Axes, variable: Variable, low: float, high: float) -> None:
    """Write the names above the peaks; names that would run into each other are turned."""
    tops: list[tuple[float, float, str, str]] = []
    for k, term in enumerate(variable.terms):
        middle = centre(term.shape, low, high)
        if middle is None:
            continue
        if term.shape.kind == "trapezoid":  # a shoulder is named above its visible top
            a, b = max(term.shape.parameters[1], low), min(term.shape.parameters[2], high)
            middle = 0.5 * (a + b) if a <= b else middle
        top = min(1.0, membership(term.shape, middle))
        tops.append((middle, top, term.name, str(line_style(k)["color"])))
    tops.sort()
    gaps = [b[0] - a[0] for a, b in pairwise(tops)]
    room = min(gaps, default=high - low) / (high - low)
    longest = max((len(name) for _, _, name, _ in tops), default=0)
    angle = 0 if longest * 0.016 <= room else 30
    for x, y, name, colour in tops:
        align = "left" if angle else "center"
        if not angle and x <= low + 0.01 * (high - low):
            align = "left"
        elif not angle and x >= high - 0.01 * (high - low):
            align = "right"
        axes.text(
            x, y + 0.03, safe(name), color=colour, fontsize=8, ha=align, va="bottom",
            rotation=angle, rotation_mode="anchor",
        )  # fmt: skip


# --- A whole rule base on one page ---
#
# Its terms on the left, its control surfaces on the right.


def rulebase_figure(
    rulebase: RuleBase, output: str | None = None, at: Mapping[str, float] | None = None
) -> Figure:
    """Return the memberships of every variable above the surface of every output.

    Parameters
    ----------
    rulebase : RuleBase
        What to draw.
    output : str, optional
        The surface of this output only.
    at : mapping of str to float, optional
        As for :func:`fuzzyarm.show.figures.surface_figure`.
    """
    outputs = [rulebase.output(output)] if output else list(rulebase.outputs)
    variables: list[Variable] = [*rulebase.inputs, *rulebase.outputs]
    columns = 2 if len(variables) in (2, 4) else min(3, len(variables))
    rows = -(-len(variables) // columns)
    one = len(rulebase.inputs) == 1
    heights = [2.1 * rows, *([3.2 if one else 4.0] * len(outputs))]
    figure = new_figure(max(3.5 * columns, 9.0), sum(heights) + 0.4)
    parts = figure.subfigures(1 + len(outputs), 1, height_ratios=heights, squeeze=False)[:, 0]
    panels = _panels(parts[0], rows, columns, len(variables))
    for axes, variable in zip(panels, variables, strict=True):
        _draw_memberships(axes, variable, rulebase)
    for part, target in zip(parts[1:], outputs, strict=True):
        draw_response(part, rulebase, target, at or {})
    title = f"{rulebase.name}: {rulebase.description}" if rulebase.description else rulebase.name
    figure.suptitle(safe(title), fontweight="bold", fontsize=11)
    return figure


def _panels(part: Any, rows: int, columns: int, count: int) -> list[Axes]:
    """Return `count` axes in rows and columns; the rest of the last row stays empty."""
    panels = list(part.subplots(rows, columns, squeeze=False).ravel())
    for axes in panels[count:]:
        axes.set_visible(False)
    return panels[:count]


# --- One inference as the classic picture: fuzzified inputs, clipped sets, the value ---


def inference_figure(rulebase: RuleBase, trace: Trace) -> Figure:
    """Return the inputs with their memberships on top, below them the sets of each output.

    Parameters
    ----------
    rulebase : RuleBase
        What was evaluated.
    trace : Trace
        From :func:`fuzzyarm.inference.explain`.
    """
    inputs = [each for each in trace.inputs if rulebase.variable(each.name).terms]
    columns = max(1, min(3, len(inputs)))
    rows = -(-len(inputs) // columns)
    heights = [2.2 * max(rows, 1), *([2.9] * len(trace.outputs))]
    figure = new_figure(max(4.2 * columns, 7.0), sum(heights) + 0.4)
    parts = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    panels = _panels(parts[0], max(rows, 1), columns, len(inputs))
    for axes, value in zip(panels, inputs, strict=True):
        variable = rulebase.variable(value.name)
        _draw_memberships(axes, variable, rulebase)
        axes.vlines(value.value, 0, 1, colors="#111111", linewidth=1.2)
        for k, term in enumerate(variable.terms):
            if is_set(term.shape):
                degree = membership(term.shape, value.value)
                colour = line_style(k)["color"]
                if degree > 0.0:
                    axes.plot(value.value, degree, "o", color=colour, markersize=5)
                if degree > 0.0 and term.lower is not None:
                    below = membership(term.lower, value.value)
                    axes.plot([value.value] * 2, [below, degree], color=colour, linewidth=3)
                    axes.plot(value.value, below, "o", color=colour, markersize=5)
        axes.set_title(safe(f"{value.name} = {number_words(value.given, 5)}"), fontsize=9)
    for part, output in zip(parts[1:], trace.outputs, strict=True):
        _draw_output(part.subplots(), rulebase, output)
    count = len(trace.fired)
    title = f"{trace.rulebase}: {count} of {len(trace.rules)} rules fire"
    figure.suptitle(safe(title), fontweight="bold", fontsize=11)
    return figure


def _draw_consequent(axes: Axes, each: ConsequentTrace, colour: Any) -> None:
    """Draw one clipped set, or one value; of interval type 2 from lower to upper."""
    label = f"{each.term}  {number_words(each.strength, 3)}"
    if each.lower is not None:
        label = f"{each.term}  {number_words(each.lower, 3)} .. {number_words(each.strength, 3)}"
    if each.curve:
        xs, ys = zip(*each.curve, strict=True)
        alpha = 0.35 if each.lower is None else 0.2
        axes.fill_between(xs, ys, color=colour, alpha=alpha, linewidth=0, label=safe(label))
        axes.plot(xs, ys, color=colour, linewidth=1)
        if each.lower_curve:  # what is certain is darker: it is filled twice
            xs, ys = zip(*each.lower_curve, strict=True)
            axes.fill_between(xs, ys, color=colour, alpha=0.35, linewidth=0)
    elif each.value is not None and each.lower_value is not None:
        ends = sorted((each.lower_value, each.value))
        axes.fill_between(ends, [each.strength] * 2, color=colour, alpha=0.2, linewidth=3)
        axes.fill_between(
            ends, [each.lower or 0.0] * 2, color=colour, alpha=0.5, linewidth=3,
            label=safe(label),
        )  # fmt: skip
    elif each.value is not None:
        axes.vlines(each.value, 0, each.strength, colors=colour, linewidth=3, label=safe(label))


def _draw_output(axes: Axes, rulebase: RuleBase, output: OutputTrace) -> None:
    """Draw the clipped sets of an output, their union and the value."""
    variable = rulebase.output(output.name)
    order = {term.name: k for k, term in enumerate(variable.terms)}
    for each in output.consequents:
        colour = line_style(order.get(each.term.split()[-1], 0))["color"]
        _draw_consequent(axes, each, colour)
    if output.aggregate:
        xs, ys = zip(*output.aggregate, strict=True)
        axes.plot(xs, ys, color="#111111", linewidth=1.6)
    if output.lower_aggregate:
        xs, ys = zip(*output.lower_aggregate, strict=True)
        axes.plot(xs, ys, color="#111111", linewidth=1.0)
    if output.left is not None and output.right is not None:
        axes.axvspan(output.left, output.right, color=COLOURS[3], alpha=0.12, linewidth=0)
    axes.axvline(output.value, color=COLOURS[3], linewidth=1.8)
    axes.plot(output.value, 0, "^", color=COLOURS[3], markersize=9, clip_on=False, zorder=5)
    tidy(axes)
    set_range(axes, output.low, output.high)
    axes.set_ylim(0, 1.05)
    axes.set_xlabel(axis_label(output.name, variable.description), fontsize=9)
    axes.set_ylabel("membership", fontsize=8)
    title = f"{output.name} = {number_words(output.value, 6)}  by {output.method}"
    if output.left is not None and output.right is not None:
        title += f", {number_words(output.left, 5)} .. {number_words(output.right, 5)}"
    axes.set_title(safe(title), fontsize=10, color=COLOURS[3])
    if output.consequents:
        axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
