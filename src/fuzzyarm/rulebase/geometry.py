"""Where a shape changes, where it is zero and where its middle is."""

from __future__ import annotations

import math
from itertools import pairwise

from fuzzyarm.rulebase.membership import membership
from fuzzyarm.rulebase.model import Shape, Variable
from fuzzyarm.rulebase.shapes import SHAPES

_BOUNDED = {"cosine": lambda p: (p[0] - 0.5 * p[1], p[0], p[0] + 0.5 * p[1])}
_CENTRES = {
    "triangle": lambda p: p[1],
    "trapezoid": lambda p: 0.5 * (p[1] + p[2]),
    "rectangle": lambda p: 0.5 * (p[0] + p[1]),
    "gaussian": lambda p: p[0],
    "two-sided-gaussian": lambda p: 0.5 * (p[0] + p[2]),
    "bell": lambda p: p[0],
    "cosine": lambda p: p[0],
    "spike": lambda p: p[0],
    "pi": lambda p: 0.5 * (p[1] + p[2]),
    "semi-ellipse": lambda p: 0.5 * (p[0] + p[1]),
    "singleton": lambda p: p[0],
}


def corner_points(shape: Shape) -> tuple[float, ...]:
    """Return the finite numbers on the axis at which `shape` may start, end or turn."""
    if shape.kind in _BOUNDED:
        return tuple(_BOUNDED[shape.kind](shape.parameters))
    xs = shape.parameters[0::2] if shape.kind == "points" else shape.parameters
    if shape.kind in ("gaussian", "bell", "sigmoid", "spike"):
        xs = shape.parameters[:1]
    elif shape.kind in ("two-sided-gaussian", "sigmoid-difference", "sigmoid-product"):
        xs = shape.parameters[0::2]
    return tuple(x for x in xs if math.isfinite(x))


def centre(shape: Shape, low: float, high: float) -> float | None:
    """Return the middle of a fuzzy shape within `low` … `high`; None for values.

    For a shape without a middle of its own (ramps, sigmoids, …) it is the middle of the
    stretch where the membership is largest.
    """
    if not SHAPES[shape.kind].fuzzy:
        return None
    if shape.kind in _CENTRES:
        middle = float(_CENTRES[shape.kind](shape.parameters))
        if math.isfinite(middle):
            return min(high, max(low, middle))
    if not (math.isfinite(low) and math.isfinite(high)):
        return None
    samples = [low + (high - low) * i / 200 for i in range(201)]
    degrees = [membership(shape, x) for x in samples]
    top = max(degrees)
    best = [x for x, degree in zip(samples, degrees, strict=True) if degree >= top - 1e-9]
    return 0.5 * (best[0] + best[-1])


def corners(variable: Variable) -> list[float]:
    """Return, in increasing order, the ends of the range and where terms start, end or turn."""
    found = {x for term in variable.terms for x in corner_points(term.shape)}
    low = variable.low if math.isfinite(variable.low) else min(found, default=0.0) - 1.0
    high = variable.high if math.isfinite(variable.high) else max(found, default=0.0) + 1.0
    if any(not SHAPES[term.shape.kind].piecewise_linear for term in variable.terms):
        found |= {low + (high - low) * i / 64 for i in range(65)}
    return sorted({low, high} | {x for x in found if low < x < high})


def probe_points(variable: Variable) -> list[float]:
    """Return the corners and the middles between them, in increasing order.

    Between two corners no bounded term starts or ends, so the middle stands for the stretch.
    """
    found = corners(variable)
    return sorted({*found, *(0.5 * (a + b) for a, b in pairwise(found))})
