"""A membership function as a small drawing in text, three lines high."""

from __future__ import annotations

import math

from fuzzyarm.rulebase.geometry import corner_points
from fuzzyarm.rulebase.membership import FUNCTIONS, membership
from fuzzyarm.rulebase.model import Shape, Variable

_EIGHTHS = " ▁▂▃▄▅▆▇█"
WIDTH = 41
ROWS = 3


def picture(shape: Shape, variable: Variable) -> str:
    """Return `shape` over the range of `variable`, with the ends of the range below.

    Empty for the values of Takagi and Sugeno, which have no membership.
    """
    if shape.kind not in FUNCTIONS:
        return ""
    low, high = shown_range(variable)
    step = (high - low) / (WIDTH - 1)
    degrees = [_highest(shape, low + i * step, step) for i in range(WIDTH)]
    lines = []
    for row in range(ROWS - 1, -1, -1):
        levels = [min(8, max(0, round(8 * (ROWS * d - row)))) for d in degrees]
        lines.append("".join(_EIGHTHS[level] for level in levels).rstrip())
    left, right = f"{low:g}", f"{high:g}"
    middle = f"{0.5 * (low + high):g}"
    axis = left + middle.center(WIDTH - len(left) - len(right)) + right
    return "\n".join([*lines, "─" * WIDTH, axis])


def _highest(shape: Shape, x: float, step: float) -> float:
    # A peak between two columns must not be lost, and a singleton has no width at all.
    inside = [c for c in corner_points(shape) if abs(c - x) <= 0.5 * step]
    return max(membership(shape, place) for place in (x, *inside))


def shown_range(variable: Variable) -> tuple[float, float]:
    """Return the range of `variable`; where it is unbounded, the stretch its terms mark."""
    places = [x for term in variable.terms for x in corner_points(term.shape)]
    ends = [x for x in (variable.low, variable.high) if math.isfinite(x)]
    known = [*places, *ends] or [0.0]
    low = variable.low if math.isfinite(variable.low) else min(known) - 1.0
    high = variable.high if math.isfinite(variable.high) else max(known) + 1.0
    return (low, high) if low < high else (low, low + 1.0)
