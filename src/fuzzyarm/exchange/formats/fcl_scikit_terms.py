"""Terms as fcl-for-scikit-fuzzy computes them: degrees at the points of a universe, also hedged."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

from fuzzyarm.exchange.formats.shapes import nothing, with_article
from fuzzyarm.language.model.rulebase import Hedge, Shape
from fuzzyarm.language.model.shapes import apply_hedge, apply_hedges
from fuzzyarm.symbolic.kinds import HEDGES

# --- Shapes with a different meaning of their numbers ---

_ORDERED = {
    "TRIANGULAR": "triangle", "TRIANGLE": "triangle", "TRIAN": "triangle",
    "TRAPEZOID": "trapezoid", "TRAPE": "trapezoid", "PI": "pi", "PISHAPE": "pi",
    "S": "s", "SSHAPE": "s", "Z": "z", "ZSHAPE": "z",
}  # fmt: skip
"""Words whose corners must not decrease."""

_DIVIDED = {"S": (0,), "SSHAPE": (0,), "PI": (0,), "PISHAPE": (0,)}
"""Words whose flank, from the corner of this index, scikit-fuzzy divides by its width."""


def refusal(key: str, values: Sequence[float]) -> str:
    """Return the reason why scikit-fuzzy refuses the numbers of a word in capitals, or ''."""
    if key in _ORDERED and any(a > b for a, b in pairwise(values)):
        return f"scikit-fuzzy refuses corners of {with_article(_ORDERED[key])} that decrease"
    if key == "GAUSS2" and len(values) == 4 and values[0] > values[2]:
        return "scikit-fuzzy refuses a first mean above the second"
    if any(values[i] == values[i + 1] for i in _DIVIDED.get(key, ()) if i + 1 < len(values)):
        kind = with_article(_ORDERED[key])
        return f"scikit-fuzzy divides by the width of the rising flank of {kind}, which is 0"
    return ""


def own_shape(key: str, values: Sequence[float]) -> Shape | None:
    """Return the shape of a word whose numbers differ from those of other programs."""
    make = _OWN.get(key)
    numbers = _OWN_NUMBERS.get(key, 2)
    return make(*values) if make is not None and len(values) == numbers else None


def _two_sided(*values: float) -> Shape | None:
    """Return a gaussian of two means; its deviations are only ever squared."""
    low, left, high, right = values
    if not left or not right:
        return None
    return Shape("two-sided-gaussian", (low, abs(left), high, abs(right)))


def _step(x: float, before: float) -> Shape:
    """Return a step between 0 and 1 at `x`, `before` on its left."""
    ends = (math.nextafter(x, -math.inf), x)
    return Shape("ramp", ends if before == 0.0 else ends[::-1])


def _pi(a: float, b: float, c: float, d: float) -> Shape | None:
    """Return a pi whose right flank is a step: it is 0 there, where the model has 1."""
    edge = math.nextafter(d, -math.inf)
    return Shape("pi", (a, b, edge, d)) if b <= edge and c == d else None


_OWN: dict[str, Callable[..., Shape | None]] = {
    "SINGLETON": lambda x: Shape("singleton", (x,)),
    "GAUSSIANPRODUCT": lambda a, s, b, t: _two_sided(b, t, a, s) if a > b else None,
    "Z": lambda a, b: _step(b, 1.0) if a == b else None,
    "ZSHAPE": lambda a, b: _step(b, 1.0) if a == b else None,
    "PI": _pi,
    "PISHAPE": _pi,
    "LEFTLINEAR": lambda a, b: _step(b, 1.0) if a >= b else None,
    "RIGHTLINEAR": lambda a, b: _step(b, 0.0) if a >= b else None,
    "RAMP": lambda a, b: nothing([a, b]) if a == b else None,
    "RECTANGLE": lambda a, b: nothing([a, b]) if a > b else None,
    "RECTANGULAR": lambda a, b: nothing([a, b]) if a > b else None,
    "LEFTGAUSSIAN": lambda mean, s: _two_sided(-math.inf, s, mean, s),
    "RIGHTGAUSSIAN": lambda mean, s: _two_sided(mean, s, math.inf, s),
}
_OWN_NUMBERS = {"SINGLETON": 1, "GAUSSIANPRODUCT": 4, "PI": 4, "PISHAPE": 4}


def least_difference(shape: Shape, xs: Sequence[float]) -> float:
    """Return the least value, negative or not, of a difference of sigmoids at the points."""

    def sigmoid(x: float, centre: float, slope: float) -> float:
        return 0.5 * (1.0 + math.tanh(0.5 * slope * (x - centre)))

    first, slope, second, other = shape.parameters
    return min(sigmoid(x, first, slope) - sigmoid(x, second, other) for x in xs)


def closed(shape: Shape, xs: Sequence[float]) -> Shape:
    """Cut an open-ended shape at the first and the last point."""
    if shape.kind != "two-sided-gaussian":
        return shape
    low, left, high, right = shape.parameters
    if math.isinf(low):
        low = min(xs[0], high)
    if math.isinf(high):
        high = max(xs[-1], low)
    return Shape(shape.kind, (low, left, high, right), shape.height)


# --- Hedges, which act on the degrees at the points ---


def _above(degrees: list[float]) -> list[float]:
    top = degrees.index(max(degrees))
    return [0.0 if i < top else 1.0 - degree for i, degree in enumerate(degrees)]


def _below(degrees: list[float]) -> list[float]:
    top = degrees.index(max(degrees))
    return [0.0 if i >= top else 1.0 - degree for i, degree in enumerate(degrees)]


def _norm(degrees: list[float]) -> list[float]:
    top = max(degrees)
    return [degree / top for degree in degrees] if top else degrees


def _slightly(degrees: list[float]) -> list[float]:
    """Return the hedge *slightly*: "somewhat, but not very" (IEEE 1855, A.11)."""
    both = [min(degree**1.25, 1.0 - degree * degree) for degree in degrees]
    return [apply_hedge(Hedge("intensify"), degree) for degree in _norm(both)]


_OF_ALL_POINTS: dict[str, Callable[[list[float]], list[float]]] = {
    "above": _above, "below": _below, "norm": _norm, "slightly": _slightly,
}  # fmt: skip
"""Hedges over the degrees of all points, which the model lacks."""

MORE_HEDGES = {
    "more_or_less": Hedge("power", 1.0 / 3.0),
    "plus": Hedge("power", 1.25),
    **{name: Hedge(name) for name in _OF_ALL_POINTS},
}
"""Hedges of IEEE 1855 by the words of the program, beside the common ones."""


def is_at_points_only(hedges: Sequence[Hedge]) -> bool:
    """Whether some of the hedges need all points, which the model cannot express."""
    return any(hedge.name in _OF_ALL_POINTS for hedge in hedges)


def hedged_degrees(degrees: Sequence[float], hedges: Sequence[Hedge]) -> list[float]:
    """Return the degrees at points under hedges; the last hedge acts first."""
    values = list(degrees)
    for hedge in reversed(hedges):
        if hedge.name in _OF_ALL_POINTS:
            values = _OF_ALL_POINTS[hedge.name](values)
        else:
            values = [apply_hedge(hedge, degree) for degree in values]
    return values


def widest_gap(degrees: Sequence[float], hedges: Sequence[Hedge]) -> float:
    """Return the greatest gap between a hedged straight line and the line of hedged degrees."""
    if all(HEDGES[hedge.name].straight for hedge in hedges):
        return 0.0
    widest = 0.0
    for (one, other), ends in zip(
        pairwise(degrees), pairwise(hedged_degrees(degrees, hedges)), strict=True
    ):
        if one == other:
            continue
        for part in (0.05, 0.25, 0.5, 0.75, 0.95):
            inner = apply_hedges(hedges, one + (other - one) * part)
            widest = max(widest, abs(inner - (ends[0] + (ends[1] - ends[0]) * part)))
    return widest
