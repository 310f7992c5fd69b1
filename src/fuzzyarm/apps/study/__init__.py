"""The published experiments: figures as data, and their reproduction."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.apps.study.identify import Identified, UnknownProblemError, identify
from fuzzyarm.apps.study.published import PublishedRow, UnknownRowError, find_rows, published_rows
from fuzzyarm.apps.study.reproduce import (
    Ensemble,
    Reproduced,
    RowJudgement,
    chaotic,
    judge,
    reproduce,
    reproduce_row,
    variants,
)
from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.apps.study.comparison import Compared, compare, compared_names, cost_of
    from fuzzyarm.apps.study.figures import draw_chapter, draw_overview, draw_profiles, save_figure

__all__ = [
    "Compared", "Ensemble", "Identified", "PublishedRow", "Reproduced", "RowJudgement",
    "UnknownProblemError", "UnknownRowError", "chaotic", "compare", "compared_names", "cost_of",
    "draw_chapter", "draw_overview", "draw_profiles", "find_rows", "identify", "judge",
    "published_rows", "reproduce", "reproduce_row", "save_figure", "variants",
]  # fmt: skip

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "comparison": ("Compared", "compare", "compared_names", "cost_of"),
            "figures": ("draw_chapter", "draw_overview", "draw_profiles", "save_figure"),
        },
        __all__,
    )
