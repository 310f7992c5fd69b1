"""The shapes a term can have: parameters, what makes them sensible, corners, support and middle.

The registry is data. What a shape *computes* stands in
:mod:`fuzzyarm.model.membership` (one point, plain Python) and in
:mod:`fuzzyarm.inference.membership` (arrays).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from fuzzyarm.model.membership import membership
from fuzzyarm.model.rulebase import Shape, Variable

# --- The shapes a term can have: names, parameters and what makes their numbers sensible ---


@dataclass(frozen=True, slots=True)
class ShapeKind:
    """What the language knows of one kind of shape.

    Attributes
    ----------
    name : str
        The word in a file.
    parameters : tuple of str
        Names of its numbers, in order. Empty for the kinds with a syntax of their own
        (``points``, ``linear``, ``formula``).
    ordered : bool
        Whether the numbers must not decrease.
    positive : tuple of str
        Parameters that must be greater than zero.
    piecewise_linear : bool
        Whether the membership function consists of straight pieces.
    fuzzy : bool
        False for the consequents of Takagi and Sugeno, which are values rather than sets.
    summary : str
        One line for help and completion.
    """

    name: str
    parameters: tuple[str, ...]
    summary: str
    ordered: bool = False
    positive: tuple[str, ...] = ()
    piecewise_linear: bool = False
    fuzzy: bool = True


_KINDS = (
    ShapeKind(
        "triangle",
        ("left", "peak", "right"),
        "straight up from left to peak, straight down to right",
        ordered=True,
        piecewise_linear=True,
    ),
    ShapeKind(
        "trapezoid",
        ("left", "top_left", "top_right", "right"),
        "up, flat, down; equal corners make a shoulder",
        ordered=True,
        piecewise_linear=True,
    ),
    ShapeKind(
        "rectangle",
        ("start", "end"),
        "1 between start and end, both included",
        ordered=True,
        piecewise_linear=True,
    ),
    ShapeKind(
        "ramp",
        ("zero", "one"),
        "0 at the first number, 1 at the second and beyond, either way round",
        piecewise_linear=True,
    ),
    ShapeKind(
        "binary",
        ("start", "direction"),
        "1 from start on, towards direction (inf or -inf)",
        piecewise_linear=True,
    ),
    ShapeKind("points", (), "straight lines through (x, y) pairs", piecewise_linear=True),
    ShapeKind("singleton", ("value",), "1 at one value, 0 elsewhere", piecewise_linear=True),
    ShapeKind("gaussian", ("mean", "deviation"), "the bell curve", positive=("deviation",)),
    ShapeKind(
        "two-sided-gaussian",
        ("left_mean", "left_deviation", "right_mean", "right_deviation"),
        "a gaussian flank on either side, 1 between the means",
        positive=("left_deviation", "right_deviation"),
    ),
    ShapeKind(
        "bell",
        ("centre", "width", "slope"),
        "1 / (1 + |(x - centre) / width| ^ (2 slope))",
    ),
    ShapeKind("sigmoid", ("inflection", "slope"), "1 / (1 + exp(-slope (x - inflection)))"),
    ShapeKind(
        "sigmoid-difference",
        ("inflection1", "slope1", "inflection2", "slope2"),
        "|sigmoid 1 - sigmoid 2|",
    ),
    ShapeKind(
        "sigmoid-product",
        ("inflection1", "slope1", "inflection2", "slope2"),
        "sigmoid 1 × sigmoid 2",
    ),
    ShapeKind("z", ("one", "zero"), "smooth fall from 1 to 0 by two parabolas", ordered=True),
    ShapeKind("s", ("zero", "one"), "smooth rise from 0 to 1 by two parabolas", ordered=True),
    ShapeKind(
        "pi",
        ("left", "top_left", "top_right", "right"),
        "s on the left, z on the right",
        ordered=True,
    ),
    ShapeKind("concave", ("inflection", "end"), "hyperbolic rise (or fall) that reaches 1 at end"),
    ShapeKind("cosine", ("centre", "width"), "one period of a raised cosine", positive=("width",)),
    ShapeKind("spike", ("centre", "width"), "exp(-|10 (x - centre) / width|)"),
    ShapeKind("arc", ("zero", "one"), "a quarter of an ellipse from 0 to 1"),
    ShapeKind("semi-ellipse", ("start", "end"), "half an ellipse between start and end"),
    ShapeKind("linear", (), "consequent: inputs times numbers, plus a number", fuzzy=False),
    ShapeKind("formula", (), "consequent or term: an arithmetic expression", fuzzy=False),
)

SHAPES: dict[str, ShapeKind] = {kind.name: kind for kind in _KINDS}
"""Every kind of shape by its name."""

EVEN_SHAPES: dict[str, str] = {
    "triangles": "each foot under its neighbour's peak",
    "gaussians": "neighbours cross at one half",
    "singletons": "evenly spaced values of an output",
}
"""The families that ``terms`` can spread evenly over a range."""


# --- Where a shape changes, where it is zero and where its middle is ---

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
