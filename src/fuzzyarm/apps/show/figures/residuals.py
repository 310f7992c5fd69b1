"""Figures of a validation: residuals, calibration, and how the rules fire."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.apps.show.figures.panels import chart_figure
from fuzzyarm.apps.show.validation import validation_chart

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fuzzyarm.learning.validation import Validation


def validation_figure(validation: Validation, target: str, title: str) -> Figure:
    """Return residuals over predictions, calibration, and the firing of the rules.

    Parameters
    ----------
    validation : Validation
        The picture; without a target only the rules.
    target : str
        Its name.
    title : str
        Of the figure.
    """
    return chart_figure(validation_chart(validation, target, title))
