"""Drawings of models in the terminal; as figures in :mod:`fuzzyarm.apps.show.figures`.

The drawings are renderables of rich: ``make_console().print(rulebase_view(model))``.
"""

from typing import TYPE_CHECKING

from fuzzyarm.apps.show.controller import controller_view
from fuzzyarm.apps.show.controller_diff import compare_controllers, controller_diff_view
from fuzzyarm.apps.show.diagram import Diagram, DiagramBlock, DiagramWire, block_diagram
from fuzzyarm.apps.show.diff import compare_rulebases, rulebase_diff_view, table_diff_view
from fuzzyarm.apps.show.drawing import (
    HeatGrid,
    Scale,
    make_console,
    number_words,
    plain_text,
    scale_of,
)
from fuzzyarm.apps.show.panels import LinePlot, SurfaceMap
from fuzzyarm.apps.show.rulebase import RuleGrid, find_grids, rule_grid, rulebase_view, rules_view
from fuzzyarm.apps.show.table import learned_view, table_grids, table_view
from fuzzyarm.apps.show.terms import TermPlots, shape_words, visible_range
from fuzzyarm.apps.show.trace import OutputPlot, firing_view, trace_view
from fuzzyarm.base.lazy import lazily

__all__ = [
    "Diagram", "DiagramBlock", "DiagramWire", "HeatGrid", "LinePlot", "OutputPlot", "RuleGrid",
    "Scale", "SurfaceMap", "TermPlots", "block_diagram", "compare_controllers", "compare_rulebases",
    "controller_diff_view", "controller_view", "find_grids", "firing_view", "learned_view",
    "make_console", "number_words", "plain_text", "rule_grid", "rulebase_diff_view",
    "rulebase_view", "rules_view", "scale_of", "shape_words", "table_diff_view", "table_grids",
    "table_view", "trace_view", "visible_range",
]  # fmt: skip

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
