"""What floats round by more than a margin is left to rationals: no rounding is a proof."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import numpy as np
import pytest
from budget import cases

from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map import Prover, UnprovableError, prove
from fuzzyarm.proof.map.arithmetic import rationals
from fuzzyarm.proof.map.bernstein import MARGIN, from_values
from fuzzyarm.proof.stop import Stop
from fuzzyarm.table import Axis, LookupTable


def read(text: str) -> RuleBase:
    found = parse(text)
    assert found.rulebase is not None, [str(each) for each in found.diagnostics]
    return found.rulebase


@pytest.mark.parametrize("seed", range(cases(40, 400)))
def test_slopes_of_linear_consequents_that_cancel_are_not_their_rounding(seed: int) -> None:
    """With strengths that are constant, the slope is a sum of coefficients alone."""
    draw = random.Random(seed)
    weights = [round(draw.uniform(0.1, 1), 3) for _ in range(4)]
    slopes = [draw.uniform(-1e6, 1e6) for _ in range(3)]
    some = sum(Fraction(w) * Fraction(c) for w, c in zip(weights, slopes, strict=False))
    slopes.append(float(-some / Fraction(weights[-1])))
    lines = ["rulebase r", "input x 0 .. 1", "output u -1e8 .. 1e8", "term x A: ramp 0 1"]
    lines += [f"term u P{i}: linear {c!r}*x + 0" for i, c in enumerate(slopes)]
    lines.append("inference u: defuzzifier weighted-average, outside extend")
    lines += [f"rule if x is any A then u is P{i} with {w!r}" for i, w in enumerate(weights)]
    rulebase = read("\n".join(lines) + "\n")
    total = sum(Fraction(w) * Fraction(c) for w, c in zip(weights, slopes, strict=True))
    assert prove(rulebase, "u rises with x").proved == (total >= 0)
    assert prove(rulebase, "u falls with x").proved == (total <= 0)


def test_slopes_within_a_cell_of_a_denormal_width_are_not_rounded_to_0() -> None:
    end = 5e-324
    rulebase = read(
        f"rulebase r\ninput x -1 .. 1\noutput u 0 .. 3\n"
        f"term x C: points (-1, 0.6) ({end!r}, 1)\nterm x D: points (0, 0.3) (1, 0.7)\n"
        "term u P: singleton 1\nterm u Q: singleton 1\n"
        "inference u: defuzzifier weighted-sum, outside extend\n"
        "rule if x is C then u is P\nrule if x is D then u is Q\n"
    )
    steep = (1 - Fraction(0.6)) / (Fraction(end) + 1) + Fraction(0.7) - Fraction(0.3)
    assert Prover(rulebase, "u").slope({}, "x").high >= steep
    assert not prove(rulebase, "u slope x in 0 .. 0.5").proved


@pytest.mark.parametrize("size", [1.0, 1e-60, 1e-80, 1e60, 1e90])
def test_a_gradient_over_any_range_has_its_bound(size: float) -> None:
    """Fourth powers of areas are beyond floats, above and below."""
    rulebase = read(
        f"rulebase r\ninput x 0 .. 1\noutput u 0 .. {size!r}\n"
        "term x A: ramp 0 1\nterm x B: ramp 1 0\n"
        f"term u P: triangle 0 {0.2 * size!r} {size!r}\n"
        f"term u Q: triangle 0 {0.9 * size!r} {size!r}\n"
        "rule if x is A then u is P\nrule if x is B then u is Q\n"
    )
    bound = Prover(rulebase, "u").steepness({}).high / size
    assert bound == pytest.approx(0.382542, rel=1e-5)


VANISHING = """
rulebase r
input x 0 .. 2
output u -1 .. 2
term x A: triangle -1 0 1
term x B: triangle 0 1 2
term x C: triangle 1 2 3
term u P: singleton 1
term u Q: singleton 0.1
inference and product, no-rule 0
inference u: defuzzifier weighted-average
rule if x is A and x is B then u is P
rule if x is C then u is Q
"""


def test_a_product_that_is_0_at_both_ends_of_a_cell_counts_between() -> None:
    """(1 - x) x is 0 at 0 and at 1; no other rule fires between."""
    rulebase = read(VANISHING)
    assert Prover(rulebase, "u").value({}).high >= 1.0
    assert prove(rulebase, "u <= 0.5").verdict == "refuted"


FAINT = """
rulebase r
input x 0 .. 1
output u 0 .. 1
term x A: ramp 0 1
term u P: singleton 0.3
inference and {norm}, no-rule 0.5
inference u: defuzzifier weighted-average
rule if {antecedent} then u is P{weight}
"""


@pytest.mark.parametrize(
    ("norm", "factors", "weight"),
    [("hamacher", 2, " with 1e-323"), ("product", 20, " with 1e-300"), ("einstein", 200, "")],
)
def test_strengths_that_are_0_by_rounding_count_over_boxes(
    norm: str, factors: int, weight: str
) -> None:
    antecedent = " and ".join(["x is very A", *["x is A"] * factors])
    rulebase = read(FAINT.format(norm=norm, antecedent=antecedent, weight=weight))
    prover = Prover(rulebase, "u", stop=Stop(0.2))
    assert prover.model is None
    assert prover.value({"x": (0.001, 0.002)}).low <= 0.3


STEEP = """
rulebase r
input x 0 .. 2
output u 0 .. 1
term x A: ramp 0 2
term u P: {shape}
inference u: defuzzifier {way}
rule if x is any A then u is P
"""


@pytest.mark.parametrize(
    ("shape", "way"),
    [("singleton 0.25", "weighted-average"), ("triangle 0 0.25 0.5", "bisector exact")],
)
def test_an_interpolation_beside_a_large_value_of_a_table_is_off_by_its_rounding(
    shape: str, way: str
) -> None:
    rulebase = read(STEEP.format(shape=shape, way=way))
    values = np.array([0.1e10, 1e-3, 0.3])
    table = LookupTable(axes=(Axis("x", (0.0, 1.0, 2.0)),), values=values, output="u")
    low = math.nextafter(1.0, 0.0)
    bounds = Prover(rulebase, "u").table(table, "linear", {"x": (low, 1.0)})
    for at in (Fraction(low), Fraction(1)):
        there = Fraction(values[0]) + at * (Fraction(values[1]) - Fraction(values[0]))
        assert bounds.low <= Fraction(0.25) - there <= bounds.high


@pytest.mark.parametrize("seed", range(cases(20, 100)))
def test_a_narrow_range_far_from_0_has_the_centre_that_it_has(seed: int) -> None:
    """The middle of the range is no float: its rounding is more than a margin of the value."""
    draw = random.Random(seed)
    low = draw.uniform(0.1, 10)
    peak, high = low * (1 + draw.uniform(1e-8, 1e-7)), low * (1 + 1.3e-7)
    rulebase = read(
        f"rulebase r\ninput x 0 .. 1\noutput u {low!r} .. {high!r}\nterm x A: ramp 0 1\n"
        f"term u P: triangle {low!r} {peak!r} {high!r}\n"
        "inference u: outside extend\nrule if x is any A then u is P\n"
    )
    value = sum(map(Fraction, (low, peak, high))) / 3
    near = float(value)
    above = near if near > value else math.nextafter(near, math.inf)
    below = near if near < value else math.nextafter(near, -math.inf)
    assert not prove(rulebase, f"u >= {above!r}").proved
    assert not prove(rulebase, f"u <= {below!r}").proved
    assert prove(rulebase, f"u in {below!r} .. {above!r}").proved


def test_a_set_narrower_than_areas_of_floats_has_no_bound_over_boxes() -> None:
    """Its centroid is next to 0; its area in floats is 0, and their quotient was 0.5."""
    rulebase = read(
        "rulebase r\ninput x 0 .. 1\noutput u 0 .. 1\nterm x A: ramp 0 1\n"
        "term u P: points (5e-324, 1) (1e-323, 0)\n"
        "inference and hamacher\nrule if x is A and x is A then u is P\n"
    )
    with pytest.raises(UnprovableError, match="next to 0"):
        Prover(rulebase, "u").value({"x": (0.5, 1.0)})


@pytest.mark.parametrize(
    ("dimension", "degree"), [(1, 4), (1, 8), (1, 12), (1, 24), (2, 8), (2, 11), (3, 6)]
)
def test_the_matrix_to_coefficients_is_off_by_less_than_a_margin(
    dimension: int, degree: int
) -> None:
    ours = from_values(dimension, degree, exact=False)
    exactly = from_values(dimension, degree, exact=True)
    rational = np.vectorize(lambda x: rationals().number(Fraction(x)), otypes=[object])
    off = np.abs(rational(ours) - exactly).astype(float).sum(axis=1).max()
    assert off <= 0.25 * MARGIN * np.abs(ours).sum(axis=1).max()


def test_a_value_beyond_the_range_by_rounding_alone_is_not_beyond() -> None:
    """Both strengths are 1e-9 and equal, or the second is larger: u = (3 a - b) / (a + b) <= 1."""
    draw = random.Random(1)
    for _ in range(6):
        a = [draw.random() for _ in range(2)]
        b = [1 - x + 1e-9 * draw.uniform(0.5, 1) for x in a]
        c = []
        for x, y in zip(a, b, strict=True):
            sum_ = Fraction(x) + Fraction(y) - 1
            near = float(sum_)
            c.append(near if near >= sum_ else math.nextafter(near, 1))
        terms = zip("ABC", (a, b, c), strict=True)
        rulebase = read(
            "rulebase r\ninput x 0 .. 1\noutput u -1 .. 1\n"
            + "".join(f"term x {n}: points (0, {p!r}) (1, {q!r})\n" for n, (p, q) in terms)
            + "term u P: singleton 3\nterm u Q: singleton -1\ninference and bounded\n"
            "inference u: defuzzifier weighted-average, outside error\n"
            "rule if x is A and x is B then u is P\nrule if x is C then u is Q\n"
        )
        assert prove(rulebase, "u <= 1").proved
