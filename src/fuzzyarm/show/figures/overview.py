"""A whole rule base on one page: its terms on the left, its control surfaces on the right."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from fuzzyarm.rulebase.model import RuleBase, Variable
from fuzzyarm.show.figures.memberships import draw_memberships
from fuzzyarm.show.figures.style import new_figure, safe
from fuzzyarm.show.figures.surface import draw_response

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
    panels = parts[0].subplots(rows, columns, squeeze=False).ravel()
    for axes, variable in zip(panels, variables, strict=False):
        draw_memberships(axes, variable, rulebase)
    for axes in panels[len(variables) :]:
        axes.set_visible(False)
    for part, target in zip(parts[1:], outputs, strict=True):
        draw_response(part, rulebase, target, at or {})
    title = f"{rulebase.name}: {rulebase.description}" if rulebase.description else rulebase.name
    figure.suptitle(safe(title), fontweight="bold", fontsize=11)
    return figure
