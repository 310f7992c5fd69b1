"""Membership, norms and truth at one point, in plain Python.

Used where a single point is asked for (checks, expectations, traces): importing an
array library would take longer than the answer. The array twin is
:mod:`fuzzyarm.inference.membership`; the tests hold the two together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from fuzzyarm.model.rulebase import Expression, Hedge, Hedged, Is, Or, RuleBlock, Shape

# --- Membership of one number in one shape, in plain Python ---


def triangle(x: float, left: float, peak: float, right: float) -> float:
    """Rise from `left` to `peak`, fall to `right`; 1 at the peak even on a vertical edge."""
    if x == peak:
        return 1.0
    if x <= left or x >= right:
        return 0.0
    return (x - left) / (peak - left) if x < peak else (right - x) / (right - peak)


def trapezoid(x: float, left: float, top_left: float, top_right: float, right: float) -> float:
    """Rise, flat top, fall; an infinite foot is a shoulder that never ends."""
    if top_left <= x <= top_right:
        return 1.0
    if x <= left or x >= right:
        return 0.0
    if x < top_left:
        return 1.0 if math.isinf(left) else (x - left) / (top_left - left)
    return 1.0 if math.isinf(right) else (right - x) / (right - top_right)


def rectangle(x: float, start: float, end: float) -> float:
    """1 between `start` and `end`, both included."""
    return 1.0 if start <= x <= end else 0.0


def ramp(x: float, zero: float, one: float) -> float:
    """0 at `zero`, 1 at `one`, straight between, constant beyond."""
    if zero == one:
        return 1.0 if x >= one else 0.0
    return min(1.0, max(0.0, (x - zero) / (one - zero)))


def binary(x: float, start: float, direction: float) -> float:
    """1 from `start` on in the direction of the sign of `direction`."""
    return 1.0 if (x >= start if direction > start else x <= start) else 0.0


def points(x: float, *pairs: float) -> float:
    """Straight lines through (x1, y1, x2, y2, …), constant beyond the ends.

    Where two points share an x, the value there is the larger of the two.
    """
    xs, ys = pairs[0::2], pairs[1::2]
    at = [y for px, y in zip(xs, ys, strict=True) if px == x]
    if at:
        return max(at)
    if x < xs[0]:
        return ys[0]
    if x > xs[-1]:
        return ys[-1]
    i = next(i for i, px in enumerate(xs) if px > x)
    return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1])


def singleton(x: float, value: float) -> float:
    """1 at exactly `value`."""
    return 1.0 if x == value else 0.0


def gaussian(x: float, mean: float, deviation: float) -> float:
    """exp(-(x - mean)² / (2 deviation²))."""
    distance, spread = x - mean, 2.0 * deviation * deviation
    if spread == 0.0:  # too narrow for a float
        return 1.0 if distance == 0.0 else 0.0
    # A product of huge numbers is infinite, where a power would raise an error.
    return math.exp(-(distance * distance) / spread)


def two_sided_gaussian(
    x: float, left_mean: float, left_deviation: float, right_mean: float, right_deviation: float
) -> float:
    """Gaussian flanks outside the two means; their product where the means are crossed."""
    left = gaussian(x, left_mean, left_deviation) if x < left_mean else 1.0
    right = gaussian(x, right_mean, right_deviation) if x > right_mean else 1.0
    return left * right


def bell(x: float, centre: float, width: float, slope: float) -> float:
    """1 / (1 + |(x - centre) / width|^(2 slope))."""
    base = abs((x - centre) / width)
    try:
        return float(1.0 / (1.0 + base ** (2.0 * slope)))
    except (OverflowError, ZeroDivisionError):
        return 0.0


def sigmoid(x: float, inflection: float, slope: float) -> float:
    """1 / (1 + exp(-slope (x - inflection)))."""
    exponent = -slope * (x - inflection)
    return 0.0 if exponent > 709.0 else 1.0 / (1.0 + math.exp(exponent))


def sigmoid_difference(
    x: float, inflection1: float, slope1: float, inflection2: float, slope2: float
) -> float:
    """|sigmoid 1 - sigmoid 2|."""
    return abs(sigmoid(x, inflection1, slope1) - sigmoid(x, inflection2, slope2))


def sigmoid_product(
    x: float, inflection1: float, slope1: float, inflection2: float, slope2: float
) -> float:
    """Sigmoid 1 × sigmoid 2."""
    return sigmoid(x, inflection1, slope1) * sigmoid(x, inflection2, slope2)


def s_curve(x: float, zero: float, one: float) -> float:
    """Smooth rise by two parabolas that meet at one half."""
    if x <= zero and zero != one:
        return 0.0
    if x >= one:
        return 1.0
    if x < one and zero == one:
        return 0.0
    t = (x - zero) / (one - zero)
    return 2.0 * t * t if t <= 0.5 else 1.0 - 2.0 * (1.0 - t) ** 2


def z_curve(x: float, one: float, zero: float) -> float:
    """Smooth fall: the mirror image of :func:`s_curve`."""
    return s_curve(-x, -zero, -one)


def pi_curve(x: float, left: float, top_left: float, top_right: float, right: float) -> float:
    """`s_curve` on the left times `z_curve` on the right."""
    return s_curve(x, left, top_left) * z_curve(x, top_right, right)


def concave(x: float, inflection: float, end: float) -> float:
    """Hyperbola that reaches 1 at `end`; rises if `inflection <= end`, else falls."""
    if inflection <= end:
        return 1.0 if x >= end else (end - inflection) / (2.0 * end - inflection - x)
    return 1.0 if x <= end else (inflection - end) / (inflection - 2.0 * end + x)


def cosine(x: float, centre: float, width: float) -> float:
    """One period of a raised cosine, 0 outside."""
    if abs(x - centre) > 0.5 * width:
        return 0.0
    return 0.5 * (1.0 + math.cos(2.0 / width * math.pi * (x - centre)))


def spike(x: float, centre: float, width: float) -> float:
    """exp(-|10 (x - centre) / width|)."""
    return math.exp(-abs(10.0 / width * (x - centre)))


def arc(x: float, zero: float, one: float) -> float:
    """Follow a quarter of an ellipse: 0 at `zero`, 1 at `one`, constant beyond."""
    if zero == one:
        return 1.0 if x >= one else 0.0
    t = min(1.0, max(0.0, (x - one) / (zero - one)))
    return math.sqrt(1.0 - t * t)


def semi_ellipse(x: float, start: float, end: float) -> float:
    """Half an ellipse over the stretch from `start` to `end`."""
    radius, centre = 0.5 * abs(end - start), 0.5 * (start + end)
    if radius == 0.0 or abs(x - centre) > radius:
        return 0.0
    return math.sqrt(1.0 - ((x - centre) / radius) ** 2)


FUNCTIONS: dict[str, Callable[..., float]] = {
    "triangle": triangle,
    "trapezoid": trapezoid,
    "rectangle": rectangle,
    "ramp": ramp,
    "binary": binary,
    "points": points,
    "singleton": singleton,
    "gaussian": gaussian,
    "two-sided-gaussian": two_sided_gaussian,
    "bell": bell,
    "sigmoid": sigmoid,
    "sigmoid-difference": sigmoid_difference,
    "sigmoid-product": sigmoid_product,
    "z": z_curve,
    "s": s_curve,
    "pi": pi_curve,
    "concave": concave,
    "cosine": cosine,
    "spike": spike,
    "arc": arc,
    "semi-ellipse": semi_ellipse,
}
"""The function of each fuzzy shape, called as ``function(x, *parameters)``."""


def membership(shape: Shape, x: float) -> float:
    """Return the membership of `x` in `shape`.

    Parameters
    ----------
    shape : Shape
        A fuzzy shape; ``linear`` and ``formula`` have no membership.
    x : float
        Any number.

    Returns
    -------
    float
        Between 0 and the height of the shape.
    """
    return shape.height * FUNCTIONS[shape.kind](x, *shape.parameters)


def apply_hedge(hedge: Hedge, degree: float) -> float:
    """Return `degree` as modified by `hedge`.

    not: 1 - d; very: d²; somewhat: √d; extremely: d³; any: 1; power(p): dᵖ;
    intensify: 2d² up to one half, then 1 - 2(1 - d)²; seldom: √(d/2) up to one half,
    then 1 - √((1 - d)/2).
    """
    return _HEDGES[hedge.name](degree, hedge.exponent if hedge.exponent is not None else 1.0)


def apply_hedges(hedges: Sequence[Hedge], degree: float) -> float:
    """Return `degree` as modified by `hedges`, the last of which acts first."""
    for hedge in reversed(hedges):
        degree = apply_hedge(hedge, degree)
    return degree


_HEDGES: dict[str, Callable[[float, float], float]] = {
    "not": lambda d, _: 1.0 - d,
    "very": lambda d, _: d * d,
    "somewhat": lambda d, _: math.sqrt(d),
    "extremely": lambda d, _: d * d * d,
    "any": lambda d, _: 1.0,
    "power": lambda d, p: d**p,
    "intensify": lambda d, _: 2.0 * d * d if d <= 0.5 else 1.0 - 2.0 * (1.0 - d) ** 2,
    "seldom": lambda d, _: math.sqrt(0.5 * d) if d <= 0.5 else 1.0 - math.sqrt(0.5 * (1.0 - d)),
}


# --- T-norms and s-norms of two floats; the array twins are in `fuzzyarm.inference` ---

Norm = Callable[[float, float], float]


def _t_hamacher(a: float, b: float) -> float:
    return a * b / (a + b - a * b) if a > 0.0 and b > 0.0 else 0.0


def _t_drastic(a: float, b: float) -> float:
    return min(a, b) if max(a, b) >= 1.0 else 0.0


def _s_hamacher(a: float, b: float) -> float:
    return 1.0 if a * b >= 1.0 else (a + b - 2.0 * a * b) / (1.0 - a * b)


def _s_drastic(a: float, b: float) -> float:
    return max(a, b) if min(a, b) <= 0.0 else 1.0


TNORMS: dict[str, Norm] = {
    "min": min,
    "product": lambda a, b: a * b,
    "bounded": lambda a, b: max(0.0, a + b - 1.0),
    "drastic": _t_drastic,
    "hamacher": _t_hamacher,
    "einstein": lambda a, b: a * b / (2.0 - (a + b - a * b)),
    "nilpotent": lambda a, b: min(a, b) if a + b > 1.0 else 0.0,
}
"""Conjunctions and implications by name."""

SNORMS: dict[str, Norm] = {
    "max": max,
    "probor": lambda a, b: a + b - a * b,
    "bounded": lambda a, b: min(1.0, a + b),
    "drastic": _s_drastic,
    "hamacher": _s_hamacher,
    "einstein": lambda a, b: (a + b) / (1.0 + a * b),
    "nilpotent": lambda a, b: max(a, b) if a + b < 1.0 else 1.0,
    "sum": lambda a, b: a + b,
    "normalized": lambda a, b: (a + b) / max(1.0, a + b),
}
"""Disjunctions and aggregations by name."""


# --- The truth of an antecedent at one point, in plain Python ---

Degree = Callable[[str, str], float]
"""Membership of the present value of a variable in one of its terms, by their names."""


def truth(expression: Expression, degree: Degree, block: RuleBlock) -> float:
    """Return the truth of `expression`, 0 to 1, by the norms of `block`.

    Parameters
    ----------
    expression : Expression
        An antecedent.
    degree : callable
        ``degree(variable, term)`` gives the membership.
    block : RuleBlock
        Names the conjunction and the disjunction.
    """
    if isinstance(expression, Is):
        return apply_hedges(expression.hedges, degree(expression.variable, expression.term))
    if isinstance(expression, Hedged):
        return apply_hedges(expression.hedges, truth(expression.operand, degree, block))
    norm = SNORMS[block.disjunction] if isinstance(expression, Or) else TNORMS[block.conjunction]
    result, *rest = (truth(operand, degree, block) for operand in expression.operands)
    for value in rest:
        result = norm(result, value)
    return result
