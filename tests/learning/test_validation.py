"""Judgements of rule bases, against computations by hand and other engines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import strategies
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm import explain, load, parse, shipped
from fuzzyarm.inference.strengths import firing_strengths
from fuzzyarm.learning.data import Samples, as_samples
from fuzzyarm.learning.validation import ValidationError, validate
from tests.interpreted import interpreted

TEXT = """rulebase m
input a 0 .. 10
input b 0 .. 1
output y 0 .. 10
term a LOW: triangle -10 0 10
term a HIGH: triangle 0 10 20
term a FAR: triangle 10 20 30
term y R1: linear a
term y R2: linear a
term y R3: linear 5
inference and product, aggregation sum, defuzzifier weighted-average, outside extend, no-rule error
rule if a is LOW then y is R1
rule if a is HIGH then y is R2
rule if a is FAR then y is R3
"""


@pytest.fixture
def rulebase():
    found = parse(TEXT).rulebase
    assert found is not None
    return found


def test_numbers_of_a_judgement(rulebase):
    a = np.array([0.0, 2.0, 8.0, 10.0])
    samples = as_samples(
        np.column_stack([a, a / 10.0]), a + np.array([1.0, -1.0, 1.0, 3.0]), ("a", "b")
    )
    found = validate(rulebase, samples)
    assert (found.samples, found.silent, found.outside) == (4, 0, 0)
    assert found.error == pytest.approx(np.sqrt(3.0))
    assert (found.bias, found.worst, found.worst_sample) == (1.0, 3.0, 4)
    assert [(r.term, r.samples) for r in found.regions[:3]] == [("LOW", 2), ("HIGH", 2), ("FAR", 0)]
    assert found.regions[1].error == pytest.approx(np.sqrt(5.0))
    assert [r.term for r in found.regions[3:]] == ["low third", "middle third", "high third"]
    slope, intercept = np.polyfit(a, samples.values, 1)
    assert (found.slope, found.intercept) == pytest.approx((slope, intercept))
    assert [rule.number for rule in found.never_fired] == [3]
    assert found.rules[0].mean == pytest.approx(0.5)
    assert found.rules[0].line == 12
    assert found.to_dict()["rules"][2]["error"] is None


def test_samples_at_which_nothing_fires_are_counted_apart(rulebase):
    samples = as_samples([[-20.0, 0.0], [5.0, 0.0]], [0.0, 6.0], ("a", "b"))
    found = validate(rulebase, samples)
    assert (found.silent, found.outside) == (1, 1)
    assert found.error == pytest.approx(1.0)


def test_without_a_target_the_rules_are_judged(rulebase):
    samples = Samples(("a", "b"), np.array([[5.0, 0.0]]), "y", np.array([np.nan]))
    found = validate(rulebase, samples)
    assert np.isnan(found.error)
    assert found.calibration == ()
    assert found.rules[0].often == 1.0


def test_an_output_that_is_not_there(rulebase):
    with pytest.raises(ValidationError, match="no output 'z'"):
        validate(rulebase, as_samples([[1.0, 0.0]], [1.0], ("a", "b"), "z"))


def test_firing_strengths_are_those_of_the_trace():
    rulebase = load(shipped("pd7.frb"))
    strengths, outputs = firing_strengths(rulebase, {"e": [1.3, -4.0], "ce": [-2.2, 3.1]})
    trace = explain(rulebase, {"e": 1.3, "ce": -2.2})
    fired = {(rule.line, rule.column): rule.strength for rule in trace.rules}
    for rule, strength in zip(rulebase.rules, strengths[:, 0], strict=True):
        assert strength == pytest.approx(fired.get((rule.span.line, rule.span.column), 0.0))
    assert outputs["u"][0] == pytest.approx(trace.outputs[0].value)


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
@given(strategies.rulebases(), st.data())
def test_strengths_come_with_the_outputs_of_inference(rulebase, data):
    point = data.draw(strategies.input_points(rulebase, 4))
    silent = tuple(replace(each, no_rule=float("nan")) for each in rulebase.outputs)
    quiet = replace(rulebase, outputs=silent)
    strengths, outputs = firing_strengths(rulebase, point)
    assert strengths.shape == (len(rulebase.rules), 4)
    for name, values in interpreted(quiet).evaluate(point).items():
        assert np.array_equal(outputs[name], values, equal_nan=True)
