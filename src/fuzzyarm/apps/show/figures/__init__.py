"""Figures with matplotlib: memberships, control surfaces, tables, one inference, validations.

Each function returns a :class:`matplotlib.figure.Figure` without global state or window;
:func:`save_figure` writes it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.apps.show.figures.analysis import describing_figure, portrait_figure
from fuzzyarm.apps.show.figures.diagram import controller_figure, diagram_figure
from fuzzyarm.apps.show.figures.panels import draw_runs
from fuzzyarm.apps.show.figures.residuals import validation_figure
from fuzzyarm.apps.show.figures.rulebase import (
    inference_figure,
    memberships_figure,
    rulebase_figure,
    variable_figure,
)
from fuzzyarm.apps.show.figures.surface import surface_figure, table_figure
from fuzzyarm.base.figure_files import FigureFileError, save_figure
from fuzzyarm.base.lazy import lazily

__all__ = [
    "FigureFileError", "controller_figure", "describing_figure", "diagram_figure", "draw_runs",
    "inference_figure", "memberships_figure", "portrait_figure", "rulebase_figure", "save_figure",
    "surface_figure", "table_figure", "validation_figure", "variable_figure",
]  # fmt: skip

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
