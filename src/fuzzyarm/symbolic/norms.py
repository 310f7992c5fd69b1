"""The built-in T-norms, S-norms and hedges: one record each.

Every one maps degrees from 0 to 1 into 0 .. 1, rounding included; only the sum may exceed 1, it
is for aggregation. Sources: E. P. Klement, R. Mesiar, E. Pap, *Triangular Norms*, 2000; J. C.
Fodor, *Contrapositive symmetry of fuzzy implications*, 1995 (nilpotent).

To add a norm or a hedge
------------------------
Add its record here, with its source; the rest follows as for shapes (:mod:`.shapes`). A norm
has no parameters: fix them in its definition, which is symmetric to the bit, and gives S(a, 0) = a
exactly and T(a, 1) = a, rounding apart: write √(a² − (1 − b)(1 + b)), not √(a² + b² − 1). `dual` is
the norm of the other sort that is 1 − T(1 − a, 1 − b), if there is one. By hand: its row in
``docs/explanation/inference.md`` (``tests/inference/test_inference_page.py``). A new operation is a
record of :mod:`.operations`.
"""

from __future__ import annotations

from typing import Any

from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.records import hedge, snorm, tnorm

X = Any
"""An expression, a number or an array of degrees."""

# ── T-norms ──────────────────────────────────────────────────────────────────────────


def _t_hamacher(a: X, b: X) -> X:
    product = a * b
    # 0 if the product vanishes, by a degree of 0 or by underflow.
    return op.where(product > 0.0, product / (a + b - product), 0.0)


def _t_einstein(a: X, b: X) -> X:
    return a * b / (2.0 - (a + b - a * b))


def _t_drastic(a: X, b: X) -> X:
    return op.where(op.maximum(a, b) >= 1.0, op.minimum(a, b), 0.0)


def _t_nilpotent(a: X, b: X) -> X:
    return op.where(a + b > 1.0, op.minimum(a, b), 0.0)


# ── S-norms ──────────────────────────────────────────────────────────────────────────


def _probor(a: X, b: X) -> X:
    return a + b - a * b


def _s_hamacher(a: X, b: X) -> X:
    """Return (a + b − 2ab) / (1 − ab) in a form without cancellation.

    With l <= h: a(1 − b) + b(1 − a) over (1 − h) + h(1 − l). The first summand of the
    numerator is at most that of the denominator, rounding included: never above 1.
    """
    low, high = op.minimum(a, b), op.maximum(a, b)
    first = high * (1.0 - low)
    value = (low * (1.0 - high) + first) / ((1.0 - high) + first)
    return op.where(low <= 0.0, high, op.where(high >= 1.0, 1.0, value))


def _s_drastic(a: X, b: X) -> X:
    return op.where(op.minimum(a, b) <= 0.0, op.maximum(a, b), 1.0)


def _s_nilpotent(a: X, b: X) -> X:
    return op.where(a + b < 1.0, op.maximum(a, b), 1.0)


def _normalized(a: X, b: X) -> X:
    return (a + b) / op.maximum(1.0, a + b)


# ── hedges ───────────────────────────────────────────────────────────────────────────


def _intensify(d: X) -> X:
    rest = 1.0 - d
    return op.where(d <= 0.5, 2.0 * d * d, 1.0 - 2.0 * (rest * rest))


def _seldom(d: X) -> X:
    return op.where(d <= 0.5, op.sqrt(0.5 * d), 1.0 - op.sqrt(0.5 * (1.0 - d)))


def register() -> None:
    """Register the built-in norms and hedges."""
    _register_tnorms()
    _register_snorms()
    _register_hedges()


def _register_tnorms() -> None:
    def kind(name: str, function: Any, **facts: Any) -> None:
        tnorm(name, function, own=False, **facts)

    kind(
        "min",
        op.minimum,
        dual="max",
        doc="the smaller",
        sources=("zadeh1965",),
        positive=True,
        lines=lambda w: ((0.0, 1.0), (w, 0.0)),
        names={"fll": "Minimum", "fis": "min", "fcl": "MIN", "jfl": "MIN"}
        | {"matlab": "min", "octave": "min", "skfuzzy": "fmin", "fml": "MIN"},
    )
    kind(
        "product",
        lambda a, b: a * b,
        dual="probor",
        doc="ab",
        positive=True,
        lines=lambda w: ((0.0, w),),
        names={"fll": "AlgebraicProduct", "fis": "prod", "fcl": "PROD", "jfl": "PROD"}
        | {"matlab": "prod", "octave": "prod", "skfuzzy": "multiply", "fml": "PROD"},
    )
    kind(
        "bounded",
        lambda a, b: op.maximum(0.0, a + b - 1.0),
        dual="bounded",
        doc="max(0, a + b − 1), Łukasiewicz",
        lines=lambda w: ((w - 1.0, 1.0),),
        names={"fll": "BoundedDifference", "fis": "bounded_difference", "fcl": "BDIF"}
        | {"jfl": "BDIF", "octave": "bounded_difference", "fml": "BDIF"},
    )
    kind(
        "drastic",
        _t_drastic,
        dual="drastic",
        doc="the smaller where the other is 1, else 0",
        leaves_ones=True,
        names={"fll": "DrasticProduct", "fis": "drastic_product", "fcl": "DPROD", "jfl": "DMIN"}
        | {"octave": "drastic_product", "fml": "DRP"},
    )
    kind(
        "hamacher",
        _t_hamacher,
        dual="hamacher",
        doc="ab / (a + b − ab)",
        positive=True,
        names={"fll": "HamacherProduct", "fis": "hamacher_product", "fcl": "HPROD"}
        | {"jfl": "HAMACHER", "octave": "hamacher_product", "fml": "HPROD"},
    )
    kind(
        "einstein",
        _t_einstein,
        dual="einstein",
        doc="ab / (2 − (a + b − ab))",
        positive=True,
        names={"fll": "EinsteinProduct", "fis": "einstein_product", "fcl": "EPROD"}
        | {"octave": "einstein_product", "fml": "EPROD"},
    )
    kind(
        "nilpotent", _t_nilpotent, dual="nilpotent",
        doc="the smaller where a + b > 1, else 0",
        names={"fll": "NilpotentMinimum", "fis": "nilpotent_minimum", "fcl": "NMIN"}
        | {"jfl": "NIPMIN", "fml": "NILMIN"},
    )  # fmt: skip


def _register_snorms() -> None:
    def kind(name: str, function: Any, **facts: Any) -> None:
        snorm(name, function, own=False, **facts)

    kind(
        "max",
        op.maximum,
        dual="min",
        doc="the larger",
        sources=("zadeh1965",),
        names={"fll": "Maximum", "fis": "max", "fcl": "MAX", "jfl": "MAX"}
        | {"matlab": "max", "octave": "max", "skfuzzy": "fmax", "fml": "MAX"},
    )
    kind(
        "probor",
        _probor,
        dual="product",
        doc="a + b − ab",
        names={"fll": "AlgebraicSum", "fis": "probor", "fcl": "ASUM", "jfl": "PROBOR, ASUM"}
        | {"matlab": "probor", "octave": "probor", "fml": "PROBOR"},
    )
    kind(
        "bounded",
        lambda a, b: op.minimum(1.0, a + b),
        dual="bounded",
        doc="min(1, a + b)",
        names={"fll": "BoundedSum", "fis": "bounded_sum", "fcl": "BSUM", "jfl": "BSUM"}
        | {"octave": "bounded_sum", "fml": "BSUM"},
    )
    kind(
        "drastic",
        _s_drastic,
        dual="drastic",
        doc="the larger where the other is 0, else 1",
        names={"fll": "DrasticSum", "fis": "drastic_sum", "fcl": "DSUM", "jfl": "DMAX"}
        | {"octave": "drastic_sum", "fml": "DRS"},
    )
    kind(
        "hamacher",
        _s_hamacher,
        dual="hamacher",
        doc="(a + b − 2ab) / (1 − ab)",
        names={"fll": "HamacherSum", "fis": "hamacher_sum", "fcl": "HSUM"}
        | {"octave": "hamacher_sum", "fml": "HSUM"},
    )
    kind(
        "einstein",
        lambda a, b: (a + b) / (1.0 + a * b),
        dual="einstein",
        doc="(a + b) / (1 + ab)",
        names={"fll": "EinsteinSum", "fis": "einstein_sum", "fcl": "ESUM", "jfl": "EINSTEIN"}
        | {"octave": "einstein_sum", "fml": "ESUM"},
    )
    kind(
        "nilpotent",
        _s_nilpotent,
        dual="nilpotent",
        doc="the larger where a + b < 1, else 1",
        names={"fll": "NilpotentMaximum", "fis": "nilpotent_maximum", "fcl": "NMAX"}
        | {"jfl": "NIPMAX", "fml": "NILMAX"},
    )
    kind(
        "sum",
        lambda a, b: a + b,
        doc="a + b, for aggregation",
        aggregates=True,
        names={"fll": "UnboundedSum", "fis": "sum", "fcl": "SUM", "jfl": "SUM"}
        | {"matlab": "sum", "octave": "sum"},
    )
    kind(
        "normalized", _normalized, doc="(a + b) / max(1, a + b), for aggregation", aggregates=True,
        names={"fll": "NormalizedSum", "fis": "normalized_sum", "fcl": "NSUM", "jfl": "NSUM"}
        | {"fml": "custom_NSUM"},
    )  # fmt: skip


def _register_hedges() -> None:
    def kind(name: str, function: Any, **facts: Any) -> None:
        hedge(name, function, own=False, **facts)

    kind(
        "not",
        lambda d: 1.0 - d,
        doc="1 − d",
        straight=True,
        names={"fll": "not", "fcl": "not", "jfl": "not", "skfuzzy": "not", "fml": "not"},
    )
    kind(
        "very",
        lambda d: d * d,
        doc="d²",
        names={"fll": "very", "fcl": "very", "fis": "0.2", "octave": "0.2", "fml": "very"},
    )
    kind(
        "somewhat",
        op.sqrt,
        doc="√d",
        aliases=("more-or-less",),
        names={"fll": "somewhat", "fcl": "somewhat", "fis": "0.05", "octave": "0.05"}
        | {"fml": "somewhat"},
    )
    kind("extremely", lambda d: d * d * d, doc="d³", names={"octave": "0.3", "fml": "extremely"})
    kind(
        "intensify",
        _intensify,
        bends=(0.5,),
        doc="2d² up to one half, then 1 − 2(1 − d)²",
        # Not `extremely` above: fuzzylite's word for this hedge.
        names={"fll": "extremely", "fcl": "extremely", "fis": "0.3", "fml": "intensify"},
    )
    kind(
        "seldom",
        _seldom,
        bends=(0.5,),
        doc="√(d/2) up to one half, then 1 − √((1 − d)/2)",
        names={"fll": "seldom", "fcl": "seldom", "fis": "0.01", "fml": "seldom"},
    )
    kind(
        "any",
        lambda d: 1.0,
        doc="1, whatever the degree",
        straight=True,
        names={"fll": "any", "fcl": "any", "fis": "0.99", "fml": "any"},
    )
    kind(
        "power", op.raised, parameters=("exponent",),
        doc="d to the power in parentheses",
    )  # fmt: skip
