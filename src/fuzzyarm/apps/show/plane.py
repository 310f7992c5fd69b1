"""Values over one or two inputs as a picture: lines, or samples of a plane."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fuzzyarm.base.picture import Axis, Cells, ChartPart, Dots, Level, Line, Numbers, Panel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MOST_RULINGS = 80
"""Most grid lines along an axis; more would hide the values."""

LOOKS = (("first", "-"), ("second", "--"))
"""Colours and dashes of the lines over one input."""


def plane_panel(
    points: Mapping[str, Numbers],
    values: Mapping[str, NDArray[np.float64]],
    value: Axis,
    *,
    title: str = "",
    at: Mapping[str, float] | None = None,
    signed: bool = False,
    grid: Mapping[str, Numbers] | None = None,
) -> Panel:
    """Return values over one or two inputs as a panel.

    Parameters
    ----------
    points : mapping of str to sequence of float
        Samples of the inputs: the horizontal one, then the vertical one if there is one.
    values : mapping of str to ndarray
        Values by name, row by row; several only over one input.
    value : Axis
        Name and range of the values; the ends are those of the values by default.
    title : str, optional
        Title of the panel.
    at : mapping of str to float, optional
        A point to mark.
    signed : bool
        Whether the values are differences, with colours split at zero.
    grid : mapping of str to sequence of float, optional
        Levels of the inputs, drawn as grid lines.
    """
    names, at = list(points), at or {}
    across, *up = (Axis(name, "", xs[0], xs[-1]) for name, xs in points.items())
    value = _with_ends(value, values.values(), about_zero=signed)
    rulings = [
        Level(x, upright=name == names[0], tone="wanted", width=0.5)
        for name, xs in (grid or {}).items()
        if len(xs) <= MOST_RULINGS
        for x in xs
    ]
    parts: list[ChartPart]
    if not up:
        marks = [Level(at[names[0]], upright=True)] if names[0] in at else []
        parts = [
            Line(points[names[0]], row.ravel(), tone, 2.0, dash, name if len(values) > 1 else "")
            for (name, row), (tone, dash) in zip(values.items(), LOOKS, strict=False)
        ]
        return Panel([*rulings, *parts, *marks], across, value, title)
    (plane,) = values.values()
    parts = [Cells(points[names[0]], points[names[1]], plane, value, signed=signed), *rulings]
    if all(name in at for name in names):
        parts.append(Dots([at[names[0]]], [at[names[1]]], "+"))
    return Panel(parts, across, up[0], title)


def _with_ends(value: Axis, rows: Any, *, about_zero: bool) -> Axis:
    """Return the axis of values with its ends, symmetric for differences."""
    from dataclasses import replace

    if value.low is not None:
        return value
    finite = [x for row in rows for x in row.ravel().tolist() if math.isfinite(x)]
    low, high = min(finite, default=0.0), max(finite, default=1.0)
    if about_zero:
        high = max(abs(low), abs(high)) or 1.0
        low = -high
    elif not low < high:
        low, high = low - 1.0, high + 1.0
    return replace(value, low=low, high=high)
