"""A validation as a picture: residuals, calibration, and firing of the rules."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.base.picture import (
    Area,
    Axis,
    Chart,
    ChartPart,
    Dots,
    Level,
    Line,
    Panel,
    ends_with_room,
)

if TYPE_CHECKING:
    from fuzzyarm.learning.validation import RuleUse, Validation

MOST_RULES = 60
"""Most bars that are distinguishable."""

MOST_LARGE = 500
"""Most large dots."""

POINTS = 101
"""Points of a straight line: a terminal joins them by steps."""

HALF = 0.4
"""Half the width of a bar, in distances of rules."""


def validation_chart(validation: Validation, target: str, title: str) -> Chart:
    """Return residuals over predictions, calibration, and the firing of the rules."""
    rules = _rules(validation.rules)
    if not validation.calibration:
        return Chart([[rules]], (6.0, 3.6), title)
    first = [_residuals(validation, target), _calibration(validation, target)]
    return Chart([first, [rules]], (10.0, 6.4), title, stretched=True)


def _residuals(validation: Validation, target: str) -> Panel:
    residual = validation.observed - validation.predicted
    size = 4.0 if len(residual) < MOST_LARGE else 2.0
    parts: list[ChartPart] = [
        Level(0.0, width=0.8),
        Dots(validation.predicted, residual, "o", "first", size, opacity=0.5),
        *(Level(sign * validation.error, tone="mark", width=0.9, dash="--") for sign in (-1, 1)),
    ]
    heights = [*residual, validation.error, -validation.error]
    across = Axis(f"{target}, predicted", "", *ends_with_room(validation.predicted))
    up = Axis("observed − predicted", "", *ends_with_room(heights))
    return Panel(parts, across, up, "residuals (dashed: ± RMS error)")


def _calibration(validation: Validation, target: str) -> Panel:
    xs = np.linspace(validation.predicted.min(), validation.predicted.max(), POINTS)
    parts: list[ChartPart] = [Line(xs, xs, "ink", 0.8, label="perfect")]
    if not math.isnan(validation.slope):  # predictions differ
        line = validation.intercept + validation.slope * xs
        sign, size = "+-"[validation.intercept < 0.0], abs(validation.intercept)
        label = f"observed = {validation.slope:.3g} × predicted {sign} {size:.3g}"
        parts.append(Line(xs, line, "mark", 0.9, "--", label))
    predicted = [bin_.predicted for bin_ in validation.calibration]
    observed = [bin_.observed for bin_ in validation.calibration]
    parts.append(Dots(predicted, observed, "o", "first", 5.0, "means of tenths"))
    across, up = Axis(f"{target}, predicted"), Axis(f"{target}, observed")
    return Panel(parts, across, up, "calibration", key="best")


def _rules(uses: Sequence[RuleUse]) -> Panel:
    rules = uses[:MOST_RULES]
    strongest = [rule.strongest for rule in rules]
    parts: list[ChartPart] = [
        _bars(rules, strongest, 0.3, "strongest"),
        _bars(rules, [rule.mean for rule in rules], 1.0, "mean"),
    ]
    never = [rule.number for rule in rules if rule.never_fires]
    if never:
        parts.append(Dots(never, [0.0] * len(never), "x", "mark", 5.0, "never fires"))
    title = f"firing strength of rules (the first {MOST_RULES})" if len(uses) > len(
        rules) else "firing strength"  # fmt: skip
    last = max((rule.number for rule in rules), default=1)
    across = Axis("rule, in the order of the file", low=0.5, high=last + 0.5, whole=True)
    high = 1.25 * max(strongest, default=0.0) or 1.0  # room for the key
    up = Axis("firing strength", low=0.0, high=high)
    return Panel(parts, across, up, title, key="upper right")


def _bars(rules: Sequence[RuleUse], heights: Sequence[float], opacity: float, label: str) -> Area:
    """Return a bar for each rule, as one outline along the axis."""
    xs: list[float] = []
    ys: list[float] = []
    for rule, height in zip(rules, heights, strict=True):
        left, right = rule.number - HALF, rule.number + HALF
        xs += [left, left, right, right]
        ys += [0.0, height, height, 0.0]
    return Area(xs, ys, "first", opacity, label)
