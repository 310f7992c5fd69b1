"""Figures of a validation: residuals, calibration, and how the rules fire."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.picture import COLOURS
from fuzzyarm.show.figures.style import head, label_axes, new_figure, safe, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.learning.validation import Validation

MOST_RULES = 60
"""Bars that can still be told apart."""


def validation_figure(validation: Validation, target: str, title: str) -> Figure:
    """Return residuals over predictions, calibration, and the firing of the rules.

    Parameters
    ----------
    validation : Validation
        What is drawn; without a target only the rules.
    target : str
        Its name.
    title : str
        Of the figure.
    """
    with_numbers = bool(validation.calibration)
    figure = new_figure(10.0 if with_numbers else 6.0, 6.4 if with_numbers else 3.6)
    if with_numbers:
        grid = figure.add_gridspec(2, 2)
        _residuals(figure.add_subplot(grid[0, 0]), validation, target)
        _calibration(figure.add_subplot(grid[0, 1]), validation, target)
        _rules(figure.add_subplot(grid[1, :]), validation)
    else:
        _rules(figure.subplots(), validation)
    head(figure, title, size=10, weight="normal")
    return figure


def _residuals(axes: Axes, validation: Validation, target: str) -> None:
    residual = validation.observed - validation.predicted
    axes.axhline(0.0, color="#333333", linewidth=0.8)
    size = 14.0 if len(residual) < 500 else 5.0
    axes.scatter(validation.predicted, residual, s=size, color=COLOURS[0], alpha=0.5, linewidths=0)
    for sign in (-1.0, 1.0):
        axes.axhline(sign * validation.error, color=COLOURS[3], linewidth=0.9, linestyle="--")
    axes.annotate(
        "± RMS error", (1.0, validation.error), xycoords=("axes fraction", "data"),
        ha="right", va="bottom", fontsize=7, color=COLOURS[3],
    )  # fmt: skip
    label_axes(axes, safe(f"{target}, predicted"), "observed − predicted", "residuals")
    tidy(axes)


def _calibration(axes: Axes, validation: Validation, target: str) -> None:
    ends = np.array([validation.predicted.min(), validation.predicted.max()])
    axes.plot(ends, ends, color="#333333", linewidth=0.8, label="perfect")
    if validation.slope == validation.slope:  # not NaN: predictions differ
        line = validation.intercept + validation.slope * ends
        sign, size = "+-"[validation.intercept < 0.0], abs(validation.intercept)
        label = f"observed = {validation.slope:.3g} × predicted {sign} {size:.3g}"
        axes.plot(ends, line, color=COLOURS[3], linewidth=0.9, linestyle="--", label=label)
    predicted = [bin_.predicted for bin_ in validation.calibration]
    observed = [bin_.observed for bin_ in validation.calibration]
    axes.plot(predicted, observed, "o", color=COLOURS[0], markersize=5, label="means of tenths")
    axes.legend(fontsize=7, frameon=False)
    label_axes(axes, safe(f"{target}, predicted"), safe(f"{target}, observed"), "calibration")
    tidy(axes)


def _rules(axes: Axes, validation: Validation) -> None:
    rules = validation.rules[:MOST_RULES]
    number = np.array([rule.number for rule in rules])
    axes.bar(number, [rule.strongest for rule in rules], color="#c8ddeb", label="strongest")
    axes.bar(number, [rule.mean for rule in rules], color=COLOURS[0], label="mean")
    never = [rule.number for rule in rules if rule.never_fires]
    if never:
        axes.plot(never, [0.0] * len(never), "x", color=COLOURS[3], label="never fires")
    more = len(validation.rules) - len(rules)
    title = f"firing strength of rules (the first {MOST_RULES})" if more else "firing strength"
    label_axes(axes, "rule, in the order of the file", "firing strength", title)
    if len(rules) <= 30:
        axes.set_xticks(number)
    axes.set_ylim(0.0, None)
    axes.legend(fontsize=7, frameon=False, ncols=3, loc="upper right")
    tidy(axes)
