"""Memberships, norms and formulas over arrays.

The twins of :mod:`fuzzyarm.model.membership` and :mod:`fuzzyarm.model.formula`, which take
one number; the tests hold the two together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.model.formula import CONSTANTS, FormulaError, Name, Node, Number, parse_formula
from fuzzyarm.model.rulebase import Hedge, Shape

# --- Formulas over arrays; the twin of `model.formula.evaluate` ---

FORMULA_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "%": np.fmod,
    "^": np.power,
    "neg": np.negative,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "exp": np.exp,
    "log": np.log,
    "log10": np.log10,
    "sqrt": np.sqrt,
    "abs": np.abs,
    "floor": np.floor,
    "ceil": np.ceil,
    "round": np.round,
    "min": np.minimum,
    "max": np.maximum,
    "pow": np.power,
    "atan2": np.arctan2,
    "fmod": np.fmod,
}
"""The operators and functions of the language over arrays."""


def evaluate_arrays(node: Node, values: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the value of a formula over arrays that broadcast.

    Parameters
    ----------
    node : formula tree
        As from :func:`fuzzyarm.model.formula.parse_formula`.
    values : mapping of str to ndarray
        A value for every name.

    Returns
    -------
    ndarray of float64
        NaN or infinite where arithmetic is; without a warning.
    """
    with np.errstate(all="ignore"):
        return np.asarray(_value(node, values), dtype=float)


def _value(node: Node, values: Mapping[str, NDArray[np.float64]]) -> Any:
    if isinstance(node, Number):
        return np.float64(node.value)
    if isinstance(node, Name):
        if node.name in values:
            return values[node.name]
        if node.name in CONSTANTS:
            return np.float64(CONSTANTS[node.name])
        raise FormulaError(f"'{node.name}' is no variable", node.name, node.position)
    return FORMULA_FUNCTIONS[node.function](*(_value(part, values) for part in node.arguments))


# --- Membership of arrays in shapes; the twin of `model.membership` ---
#
# The smooth shapes that scikit-fuzzy has are scikit-fuzzy's, where it is right: its s, z and
# pi shapes divide by zero where two corners are equal, and its two-sided gaussian refuses
# crossed means, so those cases are treated here. Straight shapes are computed here: the
# exact centroid needs their corners, both uses must agree to the last bit on vertical
# edges, and scikit-fuzzy's fancy indexing takes ten times as long as two lines and a
# minimum. Ramp, rectangle, binary, points, concave, cosine, spike, arc and semi-ellipse
# are not in scikit-fuzzy.

Array = NDArray[np.float64]


def _up(x: Array, zero: float, one: float) -> Array:
    """Rise from 0 at `zero` towards 1 at `one`, not bounded; a step where they are equal."""
    if zero == one or np.isinf(zero):
        return np.where(x >= one, 1.0, 0.0) if zero == one else np.ones_like(x)
    out = np.subtract(x, zero)
    out /= one - zero
    return out


def _down(x: Array, one: float, zero: float) -> Array:
    if zero == one or np.isinf(zero):
        return np.where(x <= one, 1.0, 0.0) if zero == one else np.ones_like(x)
    out = np.subtract(zero, x)
    out /= zero - one
    return out


def triangle(x: Array, left: float, peak: float, right: float) -> Array:
    """Rise from `left` to `peak`, fall to `right`."""
    degree = np.minimum(_up(x, left, peak), _down(x, peak, right))
    return np.maximum(degree, 0.0, out=degree)


def trapezoid(x: Array, left: float, top_left: float, top_right: float, right: float) -> Array:
    """Rise, flat top, fall; an infinite foot is a shoulder that never ends."""
    degree = np.minimum(_up(x, left, top_left), _down(x, top_right, right))
    return np.clip(degree, 0.0, 1.0, out=degree)


def rectangle(x: Array, start: float, end: float) -> Array:
    """1 between `start` and `end`, both included."""
    return np.where((x >= start) & (x <= end), 1.0, 0.0)


def ramp(x: Array, zero: float, one: float) -> Array:
    """0 at `zero`, 1 at `one`, straight between, constant beyond."""
    return np.clip(_up(x, zero, one), 0.0, 1.0)


def binary(x: Array, start: float, direction: float) -> Array:
    """1 from `start` on in the direction of the sign of `direction`."""
    return np.where(x >= start if direction > start else x <= start, 1.0, 0.0)


def points(x: Array, *pairs: float) -> Array:
    """Straight lines through (x1, y1, x2, y2, …); the larger value on a vertical edge."""
    xs, ys = np.array(pairs[0::2]), np.array(pairs[1::2])
    degree = np.interp(x, xs, ys)
    for place in np.unique(xs[1:][xs[1:] == xs[:-1]]):
        degree = np.where(x == place, ys[xs == place].max(), degree)
    return np.asarray(degree, dtype=float)


def singleton(x: Array, value: float) -> Array:
    """1 at exactly `value`."""
    return np.where(x == value, 1.0, 0.0)


def gaussian(x: Array, mean: float, deviation: float) -> Array:
    """exp(-(x - mean)² / (2 deviation²))."""
    from skfuzzy.membership import gaussmf

    return np.asarray(gaussmf(x, mean, deviation))


def two_sided_gaussian(
    x: Array, left_mean: float, left_deviation: float, right_mean: float, right_deviation: float
) -> Array:
    """Gaussian flanks outside the two means; their product where the means are crossed."""
    left = np.where(x < left_mean, gaussian(x, left_mean, left_deviation), 1.0)
    return np.where(x > right_mean, gaussian(x, right_mean, right_deviation), 1.0) * left


def bell(x: Array, centre: float, width: float, slope: float) -> Array:
    """1 / (1 + |(x - centre) / width|^(2 slope))."""
    from skfuzzy.membership import gbellmf

    return np.asarray(gbellmf(x, width, slope, centre))


def sigmoid(x: Array, inflection: float, slope: float) -> Array:
    """1 / (1 + exp(-slope (x - inflection)))."""
    from skfuzzy.membership import sigmf

    return np.asarray(sigmf(x, inflection, slope))


def sigmoid_difference(
    x: Array, inflection1: float, slope1: float, inflection2: float, slope2: float
) -> Array:
    """|sigmoid 1 - sigmoid 2|."""
    from skfuzzy.membership import dsigmf

    return np.asarray(np.abs(dsigmf(x, inflection1, slope1, inflection2, slope2)))


def sigmoid_product(
    x: Array, inflection1: float, slope1: float, inflection2: float, slope2: float
) -> Array:
    """Sigmoid 1 × sigmoid 2."""
    from skfuzzy.membership import psigmf

    return np.asarray(psigmf(x, inflection1, slope1, inflection2, slope2))


def s_curve(x: Array, zero: float, one: float) -> Array:
    """Smooth rise by two parabolas that meet at one half."""
    if zero == one:
        return np.where(x >= one, 1.0, 0.0)
    from skfuzzy.membership import smf

    return np.asarray(smf(x.ravel(), zero, one)).reshape(x.shape)


def z_curve(x: Array, one: float, zero: float) -> Array:
    """Smooth fall by two parabolas that meet at one half."""
    if zero == one:
        return np.where(x <= one, 1.0, 0.0)
    from skfuzzy.membership import zmf

    return np.asarray(zmf(x.ravel(), one, zero)).reshape(x.shape)


def pi_curve(x: Array, left: float, top_left: float, top_right: float, right: float) -> Array:
    """`s_curve` on the left times `z_curve` on the right."""
    return s_curve(x, left, top_left) * z_curve(x, top_right, right)


def concave(x: Array, inflection: float, end: float) -> Array:
    """Hyperbola that reaches 1 at `end`; rises if `inflection <= end`, else falls."""
    if inflection <= end:
        return np.where(x >= end, 1.0, (end - inflection) / (2.0 * end - inflection - x))
    return np.where(x <= end, 1.0, (inflection - end) / (inflection - 2.0 * end + x))


def cosine(x: Array, centre: float, width: float) -> Array:
    """One period of a raised cosine, 0 outside."""
    wave = 0.5 * (1.0 + np.cos(2.0 / width * np.pi * (x - centre)))
    return np.where(np.abs(x - centre) > 0.5 * width, 0.0, wave)


def spike(x: Array, centre: float, width: float) -> Array:
    """exp(-|10 (x - centre) / width|)."""
    return np.exp(-np.abs(10.0 / width * (x - centre)))


def arc(x: Array, zero: float, one: float) -> Array:
    """Follow a quarter of an ellipse: 0 at `zero`, 1 at `one`, constant beyond."""
    if zero == one:
        return np.where(x >= one, 1.0, 0.0)
    t = np.clip((x - one) / (zero - one), 0.0, 1.0)
    return np.sqrt(1.0 - t * t)


def semi_ellipse(x: Array, start: float, end: float) -> Array:
    """Half an ellipse over the stretch from `start` to `end`."""
    radius, centre = 0.5 * abs(end - start), 0.5 * (start + end)
    if radius == 0.0:
        return np.zeros_like(x)
    inside = 1.0 - ((x - centre) / radius) ** 2
    return np.where(np.abs(x - centre) > radius, 0.0, np.sqrt(np.maximum(inside, 0.0)))


MEMBERSHIPS: dict[str, Callable[..., Array]] = {
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

_HEDGES: dict[str, Callable[[Array, float], Any]] = {
    "not": lambda d, _: 1.0 - d,
    "very": lambda d, _: d * d,
    "somewhat": lambda d, _: np.sqrt(d),
    "extremely": lambda d, _: d * d * d,
    "any": lambda d, _: np.ones_like(d),
    "power": lambda d, p: d**p,
    "intensify": lambda d, _: np.where(d <= 0.5, 2.0 * d * d, 1.0 - 2.0 * (1.0 - d) ** 2),
    "seldom": lambda d, _: np.where(
        d <= 0.5, np.sqrt(0.5 * d), 1.0 - np.sqrt(np.maximum(0.5 * (1.0 - d), 0.0))
    ),
}


def apply_hedges(hedges: Sequence[Hedge], degree: Array) -> Array:
    """Return degrees as modified by hedges, the last of which acts first."""
    for hedge in reversed(hedges):
        exponent = 1.0 if hedge.exponent is None else hedge.exponent
        degree = np.asarray(_HEDGES[hedge.name](degree, exponent))
    return degree


def membership(
    shape: Shape,
    x: Array,
    hedges: Sequence[Hedge] = (),
    values: Mapping[str, Array] | None = None,
) -> Array:
    """Return the membership of every element of `x` in a shape.

    Parameters
    ----------
    shape : Shape
        A fuzzy shape, or a ``formula`` in `x` (and in `values`).
    x : ndarray of float64
        Any shape.
    hedges : sequence of Hedge
        The last acts first.
    values : mapping of str to ndarray, optional
        Variables that a formula may use.

    Returns
    -------
    ndarray of float64
        As `x`, between 0 and the height of the shape.
    """
    with np.errstate(over="ignore", under="ignore", divide="ignore", invalid="ignore"):
        if shape.kind == "formula":
            degree = evaluate_arrays(parse_formula(shape.formula), {**(values or {}), "x": x})
            degree = np.broadcast_to(degree, np.broadcast_shapes(np.shape(degree), x.shape))
        else:
            degree = MEMBERSHIPS[shape.kind](x, *shape.parameters)
        if shape.height != 1.0:
            degree = degree * shape.height
        return apply_hedges(hedges, degree) if hedges else degree


# --- T-norms over arrays: what *and* means, and how a rule cuts its consequent ---
#
# Each takes two float arrays of degrees that broadcast and returns their conjunction; the
# names are those of `model.rulebase.CONJUNCTIONS`.

Norm = Callable[[Any, Any], Array]


def bounded_tnorm(a: Array, b: Array) -> Array:
    """Łukasiewicz: max(0, a + b − 1)."""
    return np.maximum(0.0, a + b - 1.0)


def drastic_tnorm(a: Array, b: Array) -> Array:
    """Return the smaller where the other is 1, else 0."""
    return np.where(np.maximum(a, b) >= 1.0, np.minimum(a, b), 0.0)


def hamacher_tnorm(a: Array, b: Array) -> Array:
    """Return ab / (a + b − ab), 0 where both are 0."""
    product = np.multiply(a, b)
    below = a + b - product
    return np.divide(product, below, out=np.zeros_like(product), where=product > 0.0)


def einstein_tnorm(a: Array, b: Array) -> Array:
    """Return ab / (2 − (a + b − ab))."""
    product = np.multiply(a, b)
    return np.divide(product, 2.0 - (a + b - product))


def nilpotent_tnorm(a: Array, b: Array) -> Array:
    """Return the smaller where a + b > 1, else 0."""
    return np.where(a + b > 1.0, np.minimum(a, b), 0.0)


TNORMS: dict[str, Norm] = {
    "min": np.minimum,
    "product": np.multiply,
    "bounded": bounded_tnorm,
    "drastic": drastic_tnorm,
    "hamacher": hamacher_tnorm,
    "einstein": einstein_tnorm,
    "nilpotent": nilpotent_tnorm,
}
"""Conjunctions and implications by name."""


# --- S-norms over arrays: what *or* means, and how the sets of several rules become one ---
#
# Each takes two float arrays of degrees that broadcast; the names are those of
# `model.rulebase.DISJUNCTIONS`. `sum` may exceed 1: it is for aggregation.


def probor(a: Array, b: Array) -> Array:
    """Return a + b − ab."""
    return a + b - np.multiply(a, b)


def bounded_snorm(a: Array, b: Array) -> Array:
    """Return min(1, a + b)."""
    return np.minimum(1.0, np.add(a, b))


def drastic_snorm(a: Array, b: Array) -> Array:
    """Return the larger where the other is 0, else 1."""
    return np.where(np.minimum(a, b) <= 0.0, np.maximum(a, b), 1.0)


def hamacher_snorm(a: Array, b: Array) -> Array:
    """Return (a + b − 2ab) / (1 − ab), 1 where both are 1."""
    product = np.multiply(a, b)
    return np.divide(
        a + b - 2.0 * product, 1.0 - product, out=np.ones_like(product), where=product < 1.0
    )


def einstein_snorm(a: Array, b: Array) -> Array:
    """Return (a + b) / (1 + ab)."""
    return np.divide(np.add(a, b), 1.0 + np.multiply(a, b))


def nilpotent_snorm(a: Array, b: Array) -> Array:
    """Return the larger where a + b < 1, else 1."""
    return np.where(a + b < 1.0, np.maximum(a, b), 1.0)


def normalized(a: Array, b: Array) -> Array:
    """Return (a + b) / max(1, a + b), taken pair by pair."""
    total = np.add(a, b)
    return np.divide(total, np.maximum(1.0, total))


SNORMS: dict[str, Norm] = {
    "max": np.maximum,
    "probor": probor,
    "bounded": bounded_snorm,
    "drastic": drastic_snorm,
    "hamacher": hamacher_snorm,
    "einstein": einstein_snorm,
    "nilpotent": nilpotent_snorm,
    "sum": np.add,
    "normalized": normalized,
}
"""Disjunctions and aggregations by name."""
