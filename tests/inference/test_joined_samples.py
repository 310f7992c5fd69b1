"""Sets joined by straight lines between samples: scikit-fuzzy's own defuzzifiers are the oracle."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import reduce
from itertools import pairwise

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from skfuzzy import defuzz
from strategies import input_points, plain_mamdani

from fuzzyarm import compiled
from fuzzyarm.inference import infer
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import Defuzzifier
from fuzzyarm.language.model.shapes import membership
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS
from tests.interpreted import interpreted

TEXT = """
rulebase lamp
input  a  0 .. 1
input  b  0 .. 1
input  c  0 .. 1
output y -3 .. 7
term a on: ramp 0 1
term b on: ramp 0 1
term c on: ramp 0 1
term y low:  triangle -3 -1.3 2.1
term y mid:  gaussian 1.7 1.4
term y high: trapezoid 1 4.3 7 7
inference y: defuzzifier centroid(23, joined), no-rule nan
rule if a is on then y is low
rule if b is on then y is mid
rule if c is on then y is high
"""

DEGREES = st.sampled_from([0.0, 1e-3, 0.2, 0.5, 0.77, 1.0]) | st.floats(0.0, 1.0)


def model(method: str):
    rulebase = parse(TEXT.replace("centroid(", f"{method}(")).rulebase
    assert rulebase is not None
    return rulebase


JOINED = [name for name, record in DEFUZZIFIERS.items() if record.joins]
MODELS = {method: model(method) for method in JOINED}


def union(rulebase, strengths: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Add the points where a set passes its strength, and unite: as scikit-fuzzy's simulation."""
    output = rulebase.outputs[0]
    xs = np.linspace(output.low, output.high, output.defuzzifier.resolution)
    sets = [np.array([membership(t.shape, float(x)) for x in xs]) for t in output.terms]
    points = [xs]
    for degrees, strength in zip(sets, strengths, strict=True):
        for (a, b), (y, z) in zip(pairwise(xs), pairwise(degrees), strict=True):
            if (y >= strength) != (z >= strength):
                points.append(np.array([a + (strength - y) * (b - a) / (z - y)]))
    every = reduce(np.union1d, points)
    clipped = [np.minimum(s, np.interp(every, xs, d)) for d, s in zip(sets, strengths, strict=True)]
    return every, reduce(np.maximum, clipped)


@pytest.mark.parametrize("method", JOINED)
@settings(max_examples=cases(20, 60), deadline=None)
@given(strengths=st.tuples(DEGREES, DEGREES, DEGREES).filter(lambda s: max(s) > 1e-6))
def test_the_numbers_of_scikit_fuzzy(method, strengths):
    """The bisector by its meaning: scikit-fuzzy loses digits where a plateau slopes by a bit."""
    rulebase = MODELS[method]
    xs, ys = union(rulebase, list(strengths))
    point = dict(zip("abc", strengths, strict=True))
    many = infer(rulebase, {name: np.array([value, 0.3]) for name, value in point.items()})["y"]
    for found in (infer(rulebase, point)["y"], many[0]):
        if method == "centroid":
            assert found == pytest.approx(float(defuzz(xs, ys, method)), abs=1e-11)
            continue
        left = xs < found
        left_xs = np.append(xs[left], found)
        left_ys = np.append(ys[left], np.interp(found, xs, ys))
        total = np.trapezoid(ys, xs)
        assert np.trapezoid(left_ys, left_xs) == pytest.approx(total / 2, rel=1e-10)


@settings(max_examples=cases(13, 40), deadline=None)
@given(data=st.data())
def test_both_programs_agree_whatever_the_norms(data):
    way = Defuzzifier(data.draw(st.sampled_from(JOINED)), data.draw(st.integers(2, 30)), "joined")
    rulebase = data.draw(
        plain_mamdani(
            defuzzifier=way,
            aggregations=("max", "sum", "probor"),
            implications=("min", "product", "bounded"),
        )
    )
    (output,) = (replace(each, no_rule=math.nan) for each in rulebase.outputs)
    rulebase = replace(rulebase, outputs=(output,))
    columns = data.draw(input_points(rulebase, count=5))
    prepared = interpreted(rulebase)
    together = infer(rulebase, columns)[output.name]
    for i, value in enumerate(together):
        alone = prepared.evaluate({name: values[i] for name, values in columns.items()})
        near = 1e-10 * (output.high - output.low)
        assert alone[output.name] == pytest.approx(value, rel=0.0, abs=near, nan_ok=True)


def test_two_samples_make_one_line():
    rulebase = parse(TEXT.replace("23", "2")).rulebase
    # Only the trapezoid is above 0 at an end: a triangle with its peak at 7.
    assert infer(rulebase, a=1.0, b=0.0, c=1.0)["y"] == pytest.approx(-3 + 10 * 2 / 3)


def test_nothing_fired_is_no_value():
    assert math.isnan(infer(MODELS["bisector"], a=0.0, b=0.0, c=0.0)["y"])


def test_the_maxima_do_not_know_it():
    found = parse(TEXT.replace("centroid(", "mean-of-maximum("))
    assert [d.name for d in found.diagnostics] == ["misplaced-setting"]


def test_what_is_called_often_takes_it_too():
    engine = compiled(MODELS["centroid"])
    point = {"a": 0.25, "b": 0.5, "c": 1.0}
    assert engine(**point)["y"] == infer(MODELS["centroid"], point)["y"]
