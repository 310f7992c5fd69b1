"""The built-in shapes of membership functions: one record each.

A definition is complete: values at a point, over arrays, in machine code and in exported programs
are derived from it, and so are derivatives and bounds. A piecewise linear shape is the list of its
corners, from which the exact centroid follows, too. On a vertical edge the higher value holds.

Sources: the shapes of the Fuzzy Logic Toolbox (MathWorks, *Fuzzy Logic Toolbox User's
Guide*) and those of fuzzylite (J. Rada-Vilela, *The FuzzyLite Libraries for Fuzzy Logic Control*,
2018).

To add a shape
--------------
Add its record here, by the calls that users have (``docs/reference/kinds.md``), with the key of its
source in :mod:`fuzzyarm.base.sources`. Scalars, arrays, machine code, every exported language,
derivatives, bounds, completion, hover and the tables of ``docs/reference/language.md`` follow;
``pytest --update-golden tests/language tests/lsp`` renews the page and the editor's grammar.
``tests/expression``, ``tests/kinds`` and all drawn rule bases (``tests/strategies.py``) include it
automatically; some values, worked out by hand from the source, go into
``tests/expression/test_definitions.py``. Its names in other programs are ``names`` of the record;
with an ``inverse`` it may be a consequent of Tsukamoto's method.
By hand: in ``geometry/shapes.js`` of the page the corners of a straight one, a handle for each
number that is not a position (``WIDTHS``) and the mirror image (``mirrorOf``); then ``make
designer``. ``tests/designer/test_designer_server.py`` has numbers for each and compares.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.records import ShapeKind, shape

X = Any
"""An expression, a number or an array; definitions accept and return any of them."""

# ── straight shapes ──────────────────────────────────────────────────────────────────
#
# Defined by their corners alone; see `lines.py` for the degree between two of them.


def _trapezoid_corners(*p: float) -> Sequence[tuple[float, float]]:
    """Return the finite corners: a shoulder has no foot."""
    corners = zip(p, (0.0, 1.0, 1.0, 0.0), strict=True)
    # Without any it is 1 everywhere: a single corner on a flat line.
    return [corner for corner in corners if abs(corner[0]) < op.inf] or [(0.0, 1.0)]


def _binary_corners(start: float, direction: float) -> Sequence[tuple[float, float]]:
    rises = direction > start
    return [(start, 0.0 if rises else 1.0), (start, 1.0 if rises else 0.0)]


# ── curved shapes ────────────────────────────────────────────────────────────────────


def gaussian(x: X, mean: X, deviation: X) -> X:
    """exp(−(x − mean)² / (2 deviation²))."""
    distance, spread = x - mean, 2.0 * deviation * deviation
    # If 2 σ² underflows: 1 at the mean, 0 elsewhere.
    needle = op.where(op.equal(distance, 0.0), 1.0, 0.0)
    return op.where(op.equal(spread, 0.0), needle, op.exp(-(distance * distance) / spread))


def _two_sided_gaussian(
    x: X, left_mean: X, left_deviation: X, right_mean: X, right_deviation: X
) -> X:
    """Gaussian flanks outside the two means; their product if the means are crossed."""
    left = op.where(x < left_mean, gaussian(x, left_mean, left_deviation), 1.0)
    right = op.where(x > right_mean, gaussian(x, right_mean, right_deviation), 1.0)
    return left * right


def bell(x: X, centre: X, width: X, slope: X) -> X:
    """1 / (1 + |(x − centre) / width|^(2 slope))."""
    return 1.0 / (1.0 + op.power(abs((x - centre) / width), 2.0 * slope))


def sigmoid(x: X, inflection: X, slope: X) -> X:
    """1 / (1 + exp(−slope (x − inflection)))."""
    return 1.0 / (1.0 + op.exp(-slope * (x - inflection)))


def _sigmoid_difference(x: X, inflection1: X, slope1: X, inflection2: X, slope2: X) -> X:
    """|sigmoid 1 − sigmoid 2|."""
    return abs(sigmoid(x, inflection1, slope1) - sigmoid(x, inflection2, slope2))


def _sigmoid_product(x: X, inflection1: X, slope1: X, inflection2: X, slope2: X) -> X:
    """Sigmoid 1 × sigmoid 2."""
    return sigmoid(x, inflection1, slope1) * sigmoid(x, inflection2, slope2)


def _parabolas(t: X) -> X:
    """Two parabolas from (0, 0) to (1, 1) that meet at one half with equal slopes."""
    return op.where(t <= 0.5, 2.0 * t * t, 1.0 - 2.0 * ((1.0 - t) * (1.0 - t)))


def _s_curve(x: X, zero: X, one: X) -> X:
    """Rise by two parabolas; a step at `one` where the two are equal."""
    return op.where(x >= one, 1.0, op.where(x <= zero, 0.0, _parabolas((x - zero) / (one - zero))))


def _z_curve(x: X, one: X, zero: X) -> X:
    """Fall by two parabolas: the mirror image of `_s_curve`."""
    return op.where(x <= one, 1.0, op.where(x >= zero, 0.0, _parabolas((zero - x) / (zero - one))))


def _pi_curve(x: X, left: X, top_left: X, top_right: X, right: X) -> X:
    """`_s_curve` on the left times `_z_curve` on the right."""
    return _s_curve(x, left, top_left) * _z_curve(x, top_right, right)


def concave(x: X, inflection: X, end: X) -> X:
    """Hyperbola that reaches 1 at `end`; rises if `inflection` <= `end`, else falls."""
    rise = op.where(x >= end, 1.0, (end - inflection) / (2.0 * end - inflection - x))
    fall = op.where(x <= end, 1.0, (inflection - end) / (inflection - 2.0 * end + x))
    return op.minimum(1.0, op.where(inflection <= end, rise, fall))  # rounding may exceed 1


def cosine(x: X, centre: X, width: X) -> X:
    """One period of a raised cosine, 0 outside."""
    wave = 0.5 * (1.0 + op.cos(2.0 / width * op.pi * (x - centre)))
    return op.where(abs(x - centre) > 0.5 * width, 0.0, wave)


def spike(x: X, centre: X, width: X) -> X:
    """exp(−|10 (x − centre) / width|)."""
    return op.exp(-abs(10.0 / width * (x - centre)))


def arc(x: X, zero: X, one: X) -> X:
    """Follow a quarter of an ellipse from 0 at `zero` to 1 at `one`, constant beyond."""
    t = op.minimum(1.0, op.maximum(0.0, (x - one) / (zero - one)))
    return op.where(op.equal(zero, one), op.where(x >= one, 1.0, 0.0), op.sqrt(1.0 - t * t))


def _semi_ellipse(x: X, start: X, end: X) -> X:
    """Half an ellipse from `start` to `end`."""
    radius, centre = 0.5 * abs(end - start), 0.5 * (start + end)
    share = (x - centre) / radius
    outside = op.either(abs(x - centre) > radius, op.equal(radius, 0.0))
    return op.where(outside, 0.0, op.sqrt(1.0 - share * share))


# ── breakpoints for quadrature and bounds ────────────────────────────────────────────


def _around(centre: float, width: float) -> list[float]:
    """Positions around a flank, at several scales."""
    return [centre, *(centre + sign * k * width for k in (0.5, 1, 2, 4, 8, 16) for sign in (-1, 1))]


def _flanks(*pairs: float) -> list[float]:
    """Positions around pairs of a centre and a width."""
    return [x for c, w in zip(pairs[0::2], pairs[1::2], strict=True) for x in _around(c, w)]


def _inflections(*pairs: float) -> list[float]:
    widths = [1.0 / slope if slope else 0.0 for slope in pairs[1::2]]
    return [x for c, w in zip(pairs[0::2], widths, strict=True) for x in _around(c, w)]


def _cosine_ends(centre: float, width: float) -> list[float]:
    return [centre - 0.5 * width, centre, centre + 0.5 * width]


def parameters_and_middles(*parameters: float) -> list[float]:
    """Breakpoints of a curved shape without its own."""
    return [*parameters, *(0.5 * (a + b) for a, b in pairwise(parameters))]


def _middle(*p: float) -> float:
    return 0.5 * (p[0] + p[-1])


# ── inverses: the position of a degree ───────────────────────────────────────────────


def _sigmoid_inverse(degree: Any, inflection: Any, slope: Any) -> Any:
    end = op.where(slope < 0.0, -op.inf, op.inf)
    position = inflection + op.log(degree / (1.0 - degree)) / slope
    return op.where(degree <= 0.0, -end, op.where(degree >= 1.0, end, position))


def _parabolas_inverse(degree: Any, zero: Any, one: Any) -> Any:
    first = zero + (one - zero) * op.sqrt(0.5 * degree)
    second = one - (one - zero) * op.sqrt(0.5 * (1.0 - degree))
    return op.where(degree <= 0.5, first, second)


def _concave_inverse(degree: Any, inflection: Any, end: Any) -> Any:
    nothing = op.where(inflection <= end, -op.inf, op.inf)
    return op.where(degree <= 0.0, nothing, 2.0 * end - inflection - (end - inflection) / degree)


# ── the records ──────────────────────────────────────────────────────────────────────

_FOUR = ("left", "top-left", "top-right", "right")
_TWO_SIGMOIDS = ("inflection1", "slope1", "inflection2", "slope2")
_TWO_SIGMOIDS_FLL = "inflection1 slope1 slope2 inflection2"
_TWO_SIGMOIDS_FIS = "slope1 inflection1 slope2 inflection2"


def _names(fll: str, mf: str = "", fcl: str = "", *, matlab: bool = False) -> dict[str, str]:
    """Return the names of a shape in other programs; `mf` is its word in a FIS."""
    names = {"fll": fll, "fcl": fll}
    if mf:
        names["fis"] = mf
    if matlab:
        names |= {"matlab": mf, "octave": mf, "skfuzzy": mf}
    if fcl:
        names["jfl"] = fcl
    return names


def register() -> None:
    """Register the built-in shapes."""

    def kind(name: str, parameters: tuple[str, ...], function: Any, **facts: Any) -> ShapeKind:
        return shape(name, parameters, function, own=False, **facts)

    kind(
        "triangle",
        ("left", "peak", "right"),
        None,
        doc="straight up from left to peak, straight down to right",
        ordered=True,
        corners=lambda left, peak, right: [(left, 0.0), (peak, 1.0), (right, 0.0)],
        centre=lambda left, peak, right: peak,
        names=_names("Triangle", "trimf", "TRIAN", matlab=True) | {"fml": "triangularShape"},
    )
    kind(
        "trapezoid",
        _FOUR,
        None,
        doc="up, flat, down; infinite or equal corners make shoulders",
        ordered=True,
        unbounded=_FOUR,
        corners=_trapezoid_corners,
        centre=lambda *p: 0.5 * (p[1] + p[2]),
        names=_names("Trapezoid", "trapmf", "TRAPE", matlab=True) | {"fml": "trapezoidShape"},
    )
    kind(
        "rectangle",
        ("start", "end"),
        None,
        doc="1 between start and end, both included",
        ordered=True,
        unbounded=("start", "end"),
        centre=_middle,
        corners=lambda start, end: _trapezoid_corners(start, start, end, end),
        names=_names("Rectangle", "rectmf") | {"fml": "rectangularShape"},
    )
    kind(
        "ramp",
        ("zero", "one"),
        None,
        doc="0 at the first number, 1 at the second and beyond, either way round",
        corners=lambda zero, one: sorted([(zero, 0.0), (one, 1.0)]),
        inverse=lambda degree, zero, one: zero + degree * (one - zero),
        names=_names("Ramp", "rampmf")
        | dict.fromkeys(("matlab", "octave"), "linsmf, linzmf one zero")
        | {"fml": "rightLinearShape, leftLinearShape one zero"},
    )
    kind(
        "binary",
        ("start", "direction"),
        None,
        doc="1 from start on, towards direction (inf or -inf)",
        unbounded=("direction",),
        corners=_binary_corners,
        names=_names("Binary", "binarymf"),
    )
    kind(
        "points",
        (),
        None,
        doc="straight lines through (x, y) pairs; two points may share an x",
        corners=lambda *pairs: list(zip(pairs[0::2], pairs[1::2], strict=True)),
        turns=lambda *pairs: pairs[0::2],
        names={"fll": "Discrete", "fcl": "Discrete", "fis": "discretemf"},
    )
    kind(
        "singleton",
        ("value",),
        None,
        doc="1 at one value, 0 elsewhere",
        # Corners of a set without width: an output treats it as a number.
        corners=lambda value: [(value, 0.0), (value, 1.0), (value, 0.0)],
        centre=lambda value: value,
        names={"fll": "Constant", "fcl": "Constant", "fis": "constant, singletonmf"}
        | {"matlab": "constant", "octave": "constant", "fml": "singletonShape"},
    )
    kind(
        "gaussian",
        ("mean", "deviation"),
        gaussian,
        doc="the bell curve exp(−(x − mean)² / (2 deviation²))",
        positive=("deviation",),
        bends=_flanks,
        turns=lambda mean, deviation: (mean,),
        centre=lambda mean, deviation: mean,
        names=_names("Gaussian", "gaussmf deviation mean", "GAUSS", matlab=True)
        | {"fml": "gaussianShape"},
    )
    kind(
        "two-sided-gaussian",
        ("left-mean", "left-deviation", "right-mean", "right-deviation"),
        _two_sided_gaussian,
        doc="a gaussian flank on either side, 1 between the means",
        positive=("left-deviation", "right-deviation"),
        bends=_flanks,
        turns=lambda *p: p[0::2],
        centre=lambda *p: 0.5 * (p[0] + p[2]),
        names=_names(
            "GaussianProduct",
            "gauss2mf left-deviation left-mean right-deviation right-mean",
            "GAUSS2",
            matlab=True,
        ),
    )
    kind(
        "bell",
        ("centre", "width", "slope"),
        bell,
        doc="1 / (1 + |(x − centre) / width|^(2 slope))",
        nonzero=("width",),
        bends=lambda centre, width, slope: _around(centre, width),
        turns=lambda *p: p[:1],
        centre=lambda *p: p[0],
        names=_names("Bell", "gbellmf width slope centre", "GBELL width slope centre", matlab=True),
    )
    kind(
        "sigmoid",
        ("inflection", "slope"),
        sigmoid,
        doc="1 / (1 + exp(−slope (x − inflection)))",
        bends=_inflections,
        turns=lambda *p: p[:1],
        inverse=_sigmoid_inverse,
        names=_names("Sigmoid", "sigmf slope inflection", "SIGM slope inflection", matlab=True),
    )
    kind(
        "sigmoid-difference",
        _TWO_SIGMOIDS,
        _sigmoid_difference,
        doc="|sigmoid 1 − sigmoid 2|",
        bends=_inflections,
        turns=lambda *p: p[0::2],
        names=_names(
            f"SigmoidDifference {_TWO_SIGMOIDS_FLL}",
            f"dsigmf {_TWO_SIGMOIDS_FIS}",
            f"DSIGM {_TWO_SIGMOIDS_FIS}",
            matlab=True,
        ),
    )
    kind(
        "sigmoid-product",
        _TWO_SIGMOIDS,
        _sigmoid_product,
        doc="sigmoid 1 × sigmoid 2",
        bends=_inflections,
        turns=lambda *p: p[0::2],
        names=_names(
            f"SigmoidProduct {_TWO_SIGMOIDS_FLL}", f"psigmf {_TWO_SIGMOIDS_FIS}", matlab=True
        ),
    )
    kind(
        "z",
        ("one", "zero"),
        _z_curve,
        doc="smooth fall from 1 to 0 by two parabolas",
        ordered=True,
        inverse=lambda degree, one, zero: _parabolas_inverse(degree, zero, one),
        names=_names("ZShape", "zmf", matlab=True) | {"fml": "zShape"},
    )
    kind(
        "s",
        ("zero", "one"),
        _s_curve,
        doc="smooth rise from 0 to 1 by two parabolas",
        ordered=True,
        inverse=_parabolas_inverse,
        names=_names("SShape", "smf", matlab=True) | {"fml": "sShape"},
    )
    kind(
        "pi",
        _FOUR,
        _pi_curve,
        doc="s on the left, flat, z on the right",
        ordered=True,
        centre=lambda *p: 0.5 * (p[1] + p[2]),
        names=_names("PiShape", "pimf", matlab=True),
    )
    kind(
        "concave",
        ("inflection", "end"),
        concave,
        doc="hyperbolic rise (or fall) that reaches 1 at end",
        inverse=_concave_inverse,
        names=_names("Concave", "concavemf"),
    )
    kind(
        "cosine",
        ("centre", "width"),
        cosine,
        doc="one period of a raised cosine",
        positive=("width",),
        bends=_cosine_ends,
        turns=_cosine_ends,
        centre=lambda centre, width: centre,
        names=_names("Cosine", "cosinemf", "COSINE"),
    )
    kind(
        "spike",
        ("centre", "width"),
        spike,
        doc="exp(−|10 (x − centre) / width|)",
        nonzero=("width",),
        bends=lambda centre, width: _around(centre, 0.1 * width),
        turns=lambda centre, width: (centre,),
        centre=lambda centre, width: centre,
        names=_names("Spike", "spikemf"),
    )
    kind(
        "arc",
        ("zero", "one"),
        arc,
        doc="a quarter of an ellipse from 0 to 1",
        inverse=lambda degree, zero, one: one + (zero - one) * op.sqrt(1.0 - degree * degree),
        names={"fll": "Arc", "fcl": "Arc", "fis": "Arc"},
    )
    kind(
        "semi-ellipse",
        ("start", "end"),
        _semi_ellipse,
        doc="half an ellipse between start and end",
        turns=lambda start, end: (start, _middle(start, end), end),
        centre=_middle,
        names={"fll": "SemiEllipse", "fcl": "SemiEllipse", "fis": "SemiEllipse"},
    )
    kind(
        "linear",
        (),
        None,
        doc="consequent: inputs times numbers, plus a number",
        fuzzy=False,
        names={"fll": "Linear", "fcl": "Linear", "fis": "linear", "jfl": "FUNCTION"}
        | {"matlab": "linear", "octave": "linear"},
    )
    kind(
        "formula", (), None,
        doc="consequent or term: an arithmetic expression", fuzzy=False,
        names={"fll": "Function", "fcl": "Function", "fis": "function", "jfl": "FUNCTION"},
    )  # fmt: skip
