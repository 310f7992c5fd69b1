"""A centroid of samples in exact pieces, in the search and in the checker, beside its sums."""

from fractions import Fraction

import numpy as np
import pytest
from budget import cases
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

import fuzzyarm
from fuzzyarm.language import parse
from fuzzyarm.proof.check.rules import RuleSurface
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.map.prover import Prover

TERMS = {"N": (-3, -2, 0), "Z": (-1, 0, 1.25), "P": (0, 1.5, 3)}
"""Triangles of the output, on -2 .. 2."""

TEXT = """rulebase stairs
input  x -1 .. 1
input  y -1 .. 1
output u -2 .. 2
terms x, y: triangles N Z P
{terms}
inference and min, or max, implication min, aggregation {aggregation}, defuzzifier {way}
rules u
  x \\ y  N  Z  P
  N      N  N  Z
  Z      N  Z  P
  P      Z  P  P
"""
INPUTS = {"N": -1.0, "Z": 0.0, "P": 1.0}
RULES = {("N", "N"): "N", ("N", "Z"): "N", ("N", "P"): "Z", ("Z", "N"): "N", ("Z", "Z"): "Z",
         ("Z", "P"): "P", ("P", "N"): "Z", ("P", "Z"): "P", ("P", "P"): "P"}  # fmt: skip


def rulebase(way, aggregation="max"):
    terms = "\n".join(f"term u {n}: triangle {a} {b} {c}" for n, (a, b, c) in TERMS.items())
    parsed = parse(TEXT.format(terms=terms, way=way, aggregation=aggregation))
    assert parsed.rulebase is not None, parsed.diagnostics
    return parsed.rulebase


def samples(count, sampling):
    if sampling == "midpoints":
        return -2.0 + 4.0 * (np.arange(count) + 0.5) / count
    if sampling == "left":
        return -2.0 + 4.0 * np.arange(count) / count
    return np.linspace(-2.0, 2.0, count)


def centroid(x, y, count, sampling, aggregation):
    """Return the centroid by its sums alone."""
    at = samples(count, sampling)
    total = np.zeros(count)
    for (of_x, of_y), term in RULES.items():
        strength = min(max(0.0, 1.0 - abs(x - INPUTS[of_x])), max(0.0, 1.0 - abs(y - INPUTS[of_y])))
        a, b, c = TERMS[term]
        cut = np.minimum(
            strength, np.maximum(0.0, np.minimum((at - a) / (b - a), (c - at) / (c - b)))
        )
        total = np.maximum(total, cut) if aggregation == "max" else total + cut
    weights = np.ones(count)
    if sampling == "trapezoid":
        weights[[0, -1]] = 0.5
    return float((weights * total * at).sum() / (weights * total).sum())


@settings(max_examples=cases(20, 400))
@given(
    x=st.floats(-1, 1),
    y=st.floats(-1, 1),
    count=st.integers(9, 31),
    sampling=st.sampled_from(["endpoints", "midpoints", "left", "trapezoid"]),
    aggregation=st.sampled_from(["max", "sum"]),
)
def test_both_have_the_value_of_the_sums(x, y, count, sampling, aggregation):
    model = rulebase(f"centroid({count}, {sampling})", aggregation)
    expected = pytest.approx(centroid(x, y, count, sampling, aggregation), abs=1e-12)
    at = {"x": x, "y": y}
    assert Prover(model, "u", sampled=True).exactly(at) == expected
    points = {name: (fmpq(*Fraction(z).as_integer_ratio()),) * 2 for name, z in at.items()}
    assert float(RuleSurface(model, "u").value(points)) == expected


def test_at_a_vertical_edge_the_rounded_position_of_a_sample_decides():
    """Positions are sums of floats: beside an edge at a tenth some fall to its other side."""
    text = """rulebase edge
input  x 0 .. 1
output u -0.7 .. 1.3
term x ON: trapezoid 0 0 1 1
term u LOW: trapezoid -0.7 -0.7 EDGE EDGE
inference defuzzifier centroid(21, endpoints)
rule if x is ON then u is LOW
"""
    for edge in np.round(np.linspace(-0.6, 1.2, 19), 1):
        model = parse(text.replace("EDGE", repr(float(edge)))).rulebase
        assert model is not None
        expected = pytest.approx(fuzzyarm.infer(model, x=0.5)["u"], abs=1e-12)
        assert Prover(model, "u", sampled=True).exactly({"x": 0.5}) == expected
        half = (fmpq(1, 2),) * 2
        assert float(RuleSurface(model, "u").value({"x": half})) == expected


@pytest.mark.parametrize("name", ["x", "y"])
def test_the_slopes_found_are_accepted_and_no_narrower_ones(name):
    model = rulebase("centroid(21, endpoints)")
    region = {"x": (0.1, 0.4), "y": (-0.3, 0.2)}
    found = Prover(model, "u", sampled=True).slope(region, name)
    exact = {n: tuple(fmpq(*Fraction(z).as_integer_ratio()) for z in r) for n, r in region.items()}
    low, high = (fmpq(*Fraction(z).as_integer_ratio()) for z in (found.low, found.high))
    surface = RuleSurface(model, "u")
    assert surface.has_slope(exact, name, low, high)
    assert not surface.has_slope(exact, name, low + fmpq(1, 1000), high)
    assert not surface.has_slope(exact, name, low, high - fmpq(1, 1000))


def test_what_is_joined_between_samples_is_refused():
    with pytest.raises(LoopProofError, match="joined"):
        RuleSurface(rulebase("centroid(21, joined)"), "u")
    model = rulebase("centroid(21, endpoints)")
    assert Prover(model, "u").reason  # the map goes by boxes
