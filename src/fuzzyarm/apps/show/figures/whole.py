"""One figure of any file, as ``fuzzyarm plot`` draws it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language.model.rulebase import RuleBase

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fuzzyarm.proof.map import Verdict
    from fuzzyarm.table import LookupTable


def model_figure(
    model: RuleBase | LookupTable | ControllerText,
    part: str = "all",
    output: str | None = None,
    at: Mapping[str, float] | None = None,
) -> Figure:
    """Return the figure of a rule base, a table or a controller."""
    from fuzzyarm.apps.show.figures import (
        controller_figure,
        diagram_figure,
        memberships_figure,
        rulebase_figure,
        surface_figure,
        table_figure,
    )

    if isinstance(model, ControllerText):
        return diagram_figure(model) if part == "diagram" else controller_figure(model)
    if not isinstance(model, RuleBase):
        return table_figure(model, at=at)
    if part == "diagram":
        return diagram_figure(model)
    if part == "terms":
        return memberships_figure(model)
    if output is not None:
        from fuzzyarm.table.compiler import choose_output

        output = choose_output(model, output).name
    draw = surface_figure if part == "surface" else rulebase_figure
    return draw(model, output, at, _refuted(model))


def _refuted(rulebase: RuleBase) -> list[Verdict]:
    """Return the refuted properties of a rule base, within the limits of a check."""
    if not rulebase.properties:
        return []
    from fuzzyarm.exchange.files import judge

    return [verdict for verdict in judge(rulebase).verdicts if verdict.verdict == "refuted"]
