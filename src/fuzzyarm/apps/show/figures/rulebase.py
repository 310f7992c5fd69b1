"""Figures of rule bases: memberships, one inference, a whole rule base on one page."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.apps.show.figures.labels import (
    GAP,
    shortened,
    spread,
    text_height,
    text_width,
    thinned,
    wrapped,
)
from fuzzyarm.apps.show.figures.panels import draw_part
from fuzzyarm.apps.show.figures.style import (
    LABEL,
    axis_label,
    head,
    line_style,
    new_figure,
    safe,
    set_range,
    tidy,
)
from fuzzyarm.apps.show.figures.surface import ResponseFigure
from fuzzyarm.apps.show.response import Response
from fuzzyarm.apps.show.terms import footprint, is_set, membership_line, shape_words, visible_range
from fuzzyarm.base.picture import COLOURS, series
from fuzzyarm.language.model.rulebase import AnyRuleBase, Output, RuleBase, Term, Variable, model_of
from fuzzyarm.language.model.shapes import centre, membership

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.inference.trace import ConsequentTrace, OutputTrace, Trace
    from fuzzyarm.proof.map import Verdict


# --- Terms of variables as curves ---

_POINTS = 401
_EDGE = 0.95
"""Inches of a panel's width for numbers, labels and margins."""

_OVER = 0.08
"""Inches by which names may extend beyond the axes on both sides."""

_MOST_LINES = 16
"""Most lines of numbers for terms other than sets."""


def memberships_figure(rulebase: AnyRuleBase) -> Figure:
    """Return one panel for each variable of `rulebase`, inputs first.

    Parameters
    ----------
    rulebase : RuleBase
        The rule base to draw.
    """
    rulebase = model_of(rulebase)
    variables: tuple[Variable, ...] = (*rulebase.inputs, *rulebase.outputs)
    width = 7.0
    plans = [_Panel.of(variable, rulebase, width - _EDGE) for variable in variables]
    heights = [1.9 + panel.more for panel in plans]
    figure = new_figure(width, 0.6 + sum(heights))
    panels = figure.subplots(
        len(variables), 1, squeeze=False, gridspec_kw={"height_ratios": heights}
    )
    for axes, plan in zip(panels[:, 0], plans, strict=True):
        plan.draw(axes)
    head(figure, rulebase.name)
    return figure


def variable_figure(variable: Variable) -> Figure:
    """Return the terms of one variable.

    Parameters
    ----------
    variable : Variable
        The variable to draw.
    """
    width = 7.0
    panel = _Panel.of(variable, None, width - _EDGE)
    figure = new_figure(width, 2.3 + panel.more)
    panel.draw(figure.subplots())
    return figure


@dataclass(frozen=True, slots=True)
class _Name:
    """The name of a term: its position and the term's peak, both in units of the variable."""

    text: str
    place: float
    middle: float
    top: float
    colour: str


@dataclass(frozen=True, slots=True)
class _Panel:
    """Contents and size of the panel of a variable."""

    variable: Variable
    width: float  # width of the axes in inches
    names: tuple[_Name, ...]  # from left to right, above the axes
    upright: bool  # whether the names are turned
    size: float  # font size of the names in points
    words: tuple[str, ...]  # lines about terms other than sets

    @classmethod
    def of(cls, variable: Variable, rulebase: RuleBase | None, width: float) -> _Panel:
        """Plan a panel whose axes are `width` inches wide."""
        names, upright, size = _placed_names(variable, width)
        words = _value_words(variable, rulebase, width)
        return cls(variable, width, names, upright, size, words)

    @property
    def head(self) -> float:
        """Height of the names in inches."""
        if not self.names:
            return 0.0
        if self.upright:
            return max(text_width(name.text, self.size) for name in self.names)
        return text_height("x", self.size)

    @property
    def more(self) -> float:
        """Additional height in inches over a panel with one line of names."""
        below = text_height(self.label, LABEL) - text_height("x", LABEL)
        return max(0.0, self.head - 0.2) + below + max(0.0, 0.155 * len(self.words) - 1.0)

    @property
    def label(self) -> str:
        """Label below the axes, beside which there may be a power of ten."""
        return axis_label(self.variable.name, self.variable.description, self.width - 0.5)

    def draw(self, axes: Axes, title: str = "") -> None:
        """Draw the terms, each named above its peak."""
        low, high = visible_range(self.variable)
        count = 0
        for k, term in enumerate(self.variable.terms):
            if is_set(term.shape):
                _draw_term(axes, term, k, low, high)
                count += 1
        for name in self.names:
            self._write(axes, name, high - low)
        if self.words:
            axes.text(
                0.02, 0.95, safe("\n".join(self.words)), transform=axes.transAxes, va="top",
                fontsize=8, family="monospace",
            )  # fmt: skip
        tidy(axes)
        set_range(axes, low, high)
        axes.set_ylim(0, 1.05)
        axes.set_yticks([0, 0.5, 1] if count else [])
        axes.set_xlabel(self.label, fontsize=LABEL)
        axes.set_ylabel("membership" if count else "", fontsize=8)
        if title:
            axes.set_title(safe(title), fontsize=LABEL, pad=72.0 * self.head + 7.0)

    def _write(self, axes: Axes, name: _Name, span: float) -> None:
        is_apart = abs(name.place - name.middle) > 0.004 * span or name.top < 0.9
        line = {"arrowstyle": "-", "color": name.colour, "linewidth": 0.5, "shrinkA": 0.0,
                "shrinkB": 0.0, "relpos": (0.5, 0.0)}  # fmt: skip
        axes.annotate(
            safe(name.text), (name.middle, name.top), (name.place, 1.03),
            textcoords=axes.get_xaxis_transform(), color=name.colour, fontsize=self.size,
            ha="center", va="bottom", rotation=90 if self.upright else 0,
            arrowprops=line if is_apart else None, annotation_clip=False,
        )  # fmt: skip


def _draw_term(axes: Axes, term: Term, k: int, low: float, high: float) -> None:
    style = line_style(k)
    if term.shape.kind == "singleton":
        x = term.shape.parameters[0]
        axes.vlines(x, 0, term.shape.height, colors=style["color"], linewidth=2)
        axes.plot([x], [term.shape.height], "o", color=style["color"], markersize=4)
        return
    tone, dash = series(k)
    line = membership_line(term.shape, low, high, _POINTS)
    draw_part(axes, replace(line, tone=tone, width=1.6, dash=dash))
    if term.lower is not None:  # between the two is the footprint of uncertainty
        band = footprint(term.shape, term.lower, low, high, _POINTS)
        draw_part(axes, replace(band, tone=tone))
        line = membership_line(term.lower, low, high, _POINTS)
        draw_part(axes, replace(line, tone=tone, width=0.9))


def _placed_names(variable: Variable, width: float) -> tuple[tuple[_Name, ...], bool, float]:
    """Return names in a row above the axes, rotated if too wide, then thinned."""
    low, high = visible_range(variable)
    tops = _tops(variable, low, high)
    margin = 0.02 * (high - low)  # as in `set_range`
    inch = (high - low + 2.0 * margin) / width
    for upright, size in ((False, 8.0), (False, 7.0), (True, 8.0), (True, 7.0), (True, 6.0)):
        longest = 1.5 if upright else width
        texts = [shortened(top.text, size, longest) for top in tops]
        row = 1.05 * size / 72.0
        rooms = [row if upright else text_width(text, size) + 2.0 * GAP for text in texts]
        if upright and size == 6.0:  # the smallest readable font
            tops = thinned(tops, int(width / row))
            texts, rooms = [shortened(top.text, size, longest) for top in tops], [row] * len(tops)
        positions = [(top.middle - low + margin) / inch for top in tops]
        places = spread(positions, rooms, -_OVER, width + _OVER)
        if places is not None:
            break
    assert places is not None
    names = [
        replace(top, text=text, place=low - margin + inch * place)
        for top, text, place in zip(tops, texts, places, strict=True)
    ]
    return tuple(names), upright, size


def _tops(variable: Variable, low: float, high: float) -> list[_Name]:
    """Return the names of the terms with a peak, above it, from left to right."""
    tops = []
    for k, term in enumerate(variable.terms):
        middle = centre(term.shape, low, high)
        if middle is None:
            continue
        if term.shape.kind == "trapezoid":  # the name of a shoulder is above its visible top
            a, b = max(term.shape.parameters[1], low), min(term.shape.parameters[2], high)
            middle = 0.5 * (a + b) if a <= b else middle
        top = min(1.0, membership(term.shape, middle))
        tops.append(_Name(term.name, middle, middle, top, str(line_style(k)["color"])))
    return sorted(tops, key=lambda top: top.middle)


def _value_words(variable: Variable, rulebase: RuleBase | None, width: float) -> tuple[str, ...]:
    """Return the terms other than sets, in lines of `width`."""
    letters = max(20, int(0.94 * width / 0.0672))  # of DejaVu Sans Mono in 8 points
    lines: list[str] = []
    for term in variable.terms:
        if not is_set(term.shape):
            words = f"{term.name}: {shape_words(term.shape, rulebase, digits=4)}"
            lines += textwrap.wrap(words, letters, subsequent_indent="  ", max_lines=3)
    if len(lines) > _MOST_LINES:
        remaining = len(lines) - _MOST_LINES + 1
        lines[_MOST_LINES - 1 :] = [f"… and {remaining} more lines"]
    return tuple(lines)


# --- Rule base on one page: terms on the left, control surfaces on the right ---


def rulebase_figure(
    rulebase: AnyRuleBase,
    output: str | None = None,
    at: Mapping[str, float] | None = None,
    fails: Sequence[Verdict] = (),
) -> Figure:
    """Return the memberships of every variable above the surface of every output.

    Parameters
    ----------
    rulebase : RuleBase
        The rule base to draw.
    output : str, optional
        The surface of this output only.
    at, fails
        As for :func:`fuzzyarm.apps.show.figures.surface_figure`.
    """
    rulebase = model_of(rulebase)
    outputs = [rulebase.output(output)] if output else list(rulebase.outputs)
    variables: list[Variable] = [*rulebase.inputs, *rulebase.outputs]
    columns = 2 if len(variables) in (2, 4) else min(3, len(variables))
    rows = -(-len(variables) // columns)
    width = max(3.5 * columns, 9.0)
    plans = [_Panel.of(variable, rulebase, width / columns - _EDGE) for variable in variables]
    responses = [ResponseFigure(Response(rulebase, target, at or {}, fails)) for target in outputs]
    top = rows * (2.1 + max((plan.more for plan in plans), default=0.0))
    heights = [top, *(response.height for response in responses)]
    figure = new_figure(width, sum(heights) + 0.4)
    parts = figure.subfigures(1 + len(outputs), 1, height_ratios=heights, squeeze=False)[:, 0]
    panels = _panels(parts[0], rows, columns, len(variables))
    for axes, plan in zip(panels, plans, strict=True):
        plan.draw(axes)
    for part, response in zip(parts[1:], responses, strict=True):
        response.draw(part)
    title = f"{rulebase.name}: {rulebase.description}" if rulebase.description else rulebase.name
    head(figure, title)
    return figure


def _panels(part: Any, rows: int, columns: int, count: int) -> list[Axes]:
    """Return `count` axes in rows and columns; the last row may have fewer."""
    panels = list(part.subplots(rows, columns, squeeze=False).ravel())
    for axes in panels[count:]:
        axes.set_visible(False)
    return panels[:count]


# --- Inference as in textbooks: fuzzified inputs, clipped sets, the value ---


def inference_figure(rulebase: AnyRuleBase, trace: Trace) -> Figure:
    """Return the inputs with their memberships on top, below them the sets of each output.

    Parameters
    ----------
    rulebase : RuleBase
        The evaluated rule base.
    trace : Trace
        From :func:`fuzzyarm.inference.explain`.
    """
    rulebase = model_of(rulebase)
    inputs = [
        input_value for input_value in trace.inputs if rulebase.variable(input_value.name).terms
    ]
    columns = max(1, min(3, len(inputs)))
    rows = -(-len(inputs) // columns)
    width = max(4.2 * columns, 7.0)
    plans = [
        _Panel.of(rulebase.variable(input_value.name), rulebase, width / columns - _EDGE)
        for input_value in inputs
    ]
    top = max(rows, 1) * (2.2 + max((plan.more for plan in plans), default=0.0))
    heights = [top, *([2.9] * len(trace.outputs))]
    figure = new_figure(width, sum(heights) + 0.4)
    parts = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    panels = _panels(parts[0], max(rows, 1), columns, len(inputs))
    for axes, value, plan in zip(panels, inputs, plans, strict=True):
        variable = plan.variable
        label = f"{value.name} = {number_words(value.given, 5)}"
        plan.draw(axes, shortened(label, LABEL, width / columns - _EDGE))
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
    for part, output in zip(parts[1:], trace.outputs, strict=True):
        _draw_output(part.subplots(), rulebase, output)
    count = len(trace.fired)
    title = f"{trace.rulebase}: {count} of {len(trace.rules)} rules fire"
    head(figure, title)
    return figure


_MOST_CONSEQUENTS = 14
"""Most entries in the key of an output, the strongest first."""


def _draw_consequent(axes: Axes, consequent: ConsequentTrace, colour: Any, *, named: bool) -> None:
    """Draw a clipped set or a value; for interval type 2 from lower to upper."""
    span = number_words(consequent.strength, 3)
    if consequent.lower is not None:
        span = f"{number_words(consequent.lower, 3)} .. {span}"
    label = safe(f"{shortened(consequent.term, 8, 1.6)}  {span}") if named else "_"
    if consequent.curve:
        xs, ys = zip(*consequent.curve, strict=True)
        alpha = 0.35 if consequent.lower is None else 0.2
        axes.fill_between(xs, ys, color=colour, alpha=alpha, linewidth=0, label=label)
        axes.plot(xs, ys, color=colour, linewidth=1)
        if consequent.lower_curve:  # filled twice: the certain part is darker
            xs, ys = zip(*consequent.lower_curve, strict=True)
            axes.fill_between(xs, ys, color=colour, alpha=0.35, linewidth=0)
    elif consequent.value is not None and consequent.lower_value is not None:
        ends = sorted((consequent.lower_value, consequent.value))
        axes.fill_between(ends, [consequent.strength] * 2, color=colour, alpha=0.2, linewidth=3)
        axes.fill_between(
            ends, [consequent.lower or 0.0] * 2, color=colour, alpha=0.5, linewidth=3,
            label=label,
        )  # fmt: skip
    elif consequent.value is not None:
        axes.vlines(
            consequent.value, 0, consequent.strength, colors=colour, linewidth=3, label=label
        )


def _reach_of(variable: Output, output: OutputTrace) -> tuple[float, float]:
    """Return the visible range of an output; without a finite range, extended to the results."""
    low, high = visible_range(variable)
    if not math.isfinite(output.high - output.low):
        places = [output.value, *(consequent.value for consequent in output.consequents)]
        positions = [x for x in places if x is not None and math.isfinite(x)]
        low, high = min([low, *positions]), max([high, *positions])
    return low, high


def _draw_output(axes: Axes, rulebase: RuleBase, output: OutputTrace) -> None:
    """Draw the clipped sets of an output, their union and the value."""
    variable = rulebase.output(output.name)
    order = {term.name: k for k, term in enumerate(variable.terms)}
    strongest = sorted(output.consequents, key=lambda consequent: -consequent.strength)[
        :_MOST_CONSEQUENTS
    ]
    for consequent in output.consequents:
        colour = line_style(order.get(consequent.term.split()[-1], 0))["color"]
        _draw_consequent(axes, consequent, colour, named=consequent in strongest)
    weaker = len(output.consequents) - len(strongest)
    if weaker:
        axes.plot([], [], " ", label=f"and {weaker} weaker")
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
    set_range(axes, *_reach_of(variable, output))
    axes.set_ylim(0, 1.05)
    axes.set_xlabel(axis_label(output.name, variable.description), fontsize=LABEL)
    axes.set_ylabel("membership", fontsize=8)
    title = f"{output.name} = {number_words(output.value, 6)}  by {output.method}"
    if output.left is not None and output.right is not None:
        title += f", {number_words(output.left, 5)} .. {number_words(output.right, 5)}"
    axes.set_title(safe(wrapped(title, 10, 4.0)), fontsize=10, color=COLOURS[3])
    if output.consequents:
        axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
