"""The shapes a term can have: names, parameters and what makes their numbers sensible.

The registry is data. What a shape *computes* stands in
:mod:`fuzzyarm.rulebase.membership` (one point, plain Python) and in
:mod:`fuzzyarm.inference.membership` (arrays).
"""

from __future__ import annotations

from dataclasses import dataclass


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
