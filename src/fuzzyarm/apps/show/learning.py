"""A training as a picture: the RMS error of each pass."""

from __future__ import annotations

import math
from collections.abc import Sequence

from fuzzyarm.base.picture import Axis, ChartPart, Dots, Line, Numbers, Panel, series


def error_panel(
    names: Sequence[str], units: Sequence[str], errors: Sequence[Numbers], last: int = 0
) -> Panel:
    """Return the error of the finished passes, a line for each output."""
    passes = range(1, len(errors) + 1)
    parts: list[ChartPart] = []
    for column, (name, unit) in enumerate(zip(names, units, strict=False)):
        values = [row[column] for row in errors]
        tone, dash = series(column)
        parts.append(Line(passes, values, tone, 1.2, dash, f"{name}, {unit}"))
        parts.append(Dots(passes, values, "o", tone, 4.0))
    finite = [value for row in errors for value in row if math.isfinite(value)]
    high = 1.08 * max(finite, default=0.0) or 1.0
    across = Axis("pass", low=0.5, high=max(last, len(errors), 1) + 0.5, whole=True)
    return Panel(parts, across, Axis("RMS error", low=0.0, high=high), key="lower left")
