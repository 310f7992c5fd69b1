"""One inference as the classic picture: fuzzified inputs, clipped sets, the value."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.rulebase.membership import membership
from fuzzyarm.rulebase.model import RuleBase
from fuzzyarm.rulebase.shapes import SHAPES
from fuzzyarm.show.figures.memberships import draw_memberships
from fuzzyarm.show.figures.style import COLOURS, axis_label, line_style, new_figure, safe, tidy
from fuzzyarm.show.words import number_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.inference.trace import OutputTrace, Trace


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
    panels = parts[0].subplots(max(rows, 1), columns, squeeze=False).ravel()
    for axes, value in zip(panels, inputs, strict=False):
        variable = rulebase.variable(value.name)
        draw_memberships(axes, variable, rulebase)
        axes.vlines(value.value, 0, 1, colors="#111111", linewidth=1.2)
        for k, term in enumerate(variable.terms):
            if SHAPES[term.shape.kind].fuzzy:
                degree = membership(term.shape, value.value)
                if degree > 0.0:
                    axes.plot(value.value, degree, "o", color=line_style(k)["color"], markersize=5)
        axes.set_title(safe(f"{value.name} = {number_words(value.given, 5)}"), fontsize=9)
    for axes in panels[len(inputs) :]:
        axes.set_visible(False)
    for part, output in zip(parts[1:], trace.outputs, strict=True):
        draw_output(part.subplots(), rulebase, output)
    count = len(trace.fired)
    title = f"{trace.rulebase}: {count} of {len(trace.rules)} rules fire"
    figure.suptitle(safe(title), fontweight="bold", fontsize=11)
    return figure


def draw_output(axes: Axes, rulebase: RuleBase, output: OutputTrace) -> None:
    """Draw the clipped sets of an output, their union and the value."""
    variable = rulebase.output(output.name)
    order = {term.name: k for k, term in enumerate(variable.terms)}
    for each in output.consequents:
        colour = line_style(order.get(each.term.split()[-1], 0))["color"]
        label = f"{each.term}  {number_words(each.strength, 3)}"
        if each.curve:
            xs, ys = zip(*each.curve, strict=True)
            axes.fill_between(xs, ys, color=colour, alpha=0.35, linewidth=0, label=safe(label))
            axes.plot(xs, ys, color=colour, linewidth=1)
        elif each.value is not None:
            axes.vlines(each.value, 0, each.strength, colors=colour, linewidth=3, label=safe(label))
    if output.aggregate:
        xs, ys = zip(*output.aggregate, strict=True)
        axes.plot(xs, ys, color="#111111", linewidth=1.6)
    axes.axvline(output.value, color=COLOURS[3], linewidth=1.8)
    axes.plot(output.value, 0, "^", color=COLOURS[3], markersize=9, clip_on=False, zorder=5)
    tidy(axes)
    margin = 0.02 * (output.high - output.low)
    axes.set_xlim(output.low - margin, output.high + margin)
    axes.set_ylim(0, 1.05)
    axes.set_xlabel(axis_label(output.name, variable.description), fontsize=9)
    axes.set_ylabel("membership", fontsize=8)
    title = f"{output.name} = {number_words(output.value, 6)}  by {output.method}"
    axes.set_title(safe(title), fontsize=10, color=COLOURS[3])
    if output.consequents:
        axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
