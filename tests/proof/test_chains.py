"""Outputs that read other outputs: what is proved of them holds, and is not far from the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from budget import cases
from hypothesis import given, settings

import fuzzyarm
from fuzzyarm.exchange.formats import tree
from fuzzyarm.language import parse
from fuzzyarm.proof.map import Prover, prove
from fuzzyarm.proof.stop import Stop
from tests import strategies

CHAIN = """rulebase chain
input a 0 .. 10
input b 0 .. 10
output m 0 .. 1
output y 0 .. 100
term a L: ramp 10 0
term a H: ramp 0 10
term b L: gaussian 0 4
term b H: ramp 0 10
terms m: triangles L H
term m lo: triangle 0 0 0.5
term m hi: trapezoid 0.2 0.9 1 1
terms y: triangles S B
inference and min, or max, implication min, aggregation max
inference m: defuzzifier centroid(101, endpoints)
inference y: defuzzifier centroid
rule if a is L and b is L then m is L
rule if a is H or b is H then m is H
block second
rule if m is lo or b is H then y is S
rule if m is hi and a is H then y is B
"""


def _rulebase(text: str = CHAIN) -> fuzzyarm.RuleBase:
    parsed = parse(text)
    assert parsed.rulebase is not None, [str(each) for each in parsed.diagnostics]
    return parsed.rulebase


def _values(rulebase: fuzzyarm.RuleBase, name: str, points: int) -> np.ndarray:
    axes = [np.linspace(v.low, v.high, points) for v in rulebase.inputs]
    grid = np.meshgrid(*axes)
    inputs = {v.name: x.ravel() for v, x in zip(rulebase.inputs, grid, strict=True)}
    return np.asarray(fuzzyarm.infer(rulebase, inputs)[name])


def test_the_range_of_a_chain_is_proved_and_near_the_truth() -> None:
    rulebase = _rulebase()
    values = _values(rulebase, "y", 201)
    bounds = Prover(rulebase, "y", tolerance=0.5).value({})
    assert bounds.low <= values.min()
    assert values.max() <= bounds.high
    assert bounds.low >= values.min() - 2.0
    assert bounds.high <= values.max() + 2.0
    assert bounds.complete
    assert bounds.way == "boxes"


def test_statements_about_a_chain_are_proved_and_refuted() -> None:
    rulebase = _rulebase()
    highest = float(_values(rulebase, "y", 101).max())
    assert prove(rulebase, f"y <= {highest + 3.0:.3f}", tolerance=0.5).proved
    verdict = prove(rulebase, f"y <= {highest - 5.0:.3f}", tolerance=0.5)
    assert verdict.verdict == "refuted"
    (at,) = verdict.points
    assert fuzzyarm.infer(rulebase, at)["y"] > highest - 5.0
    assert "depends on another output (m)" in str(prove(rulebase, "y rises with a"))


def test_where_the_output_that_is_read_may_have_no_value_nothing_is_proved() -> None:
    text = CHAIN.replace("rule if a is H or b is H then m is H\n", "rule if a is H then m is H\n")
    text = text.replace("term a L: ramp 10 0", "term a L: ramp 4 0")
    text = text.replace("term a H: ramp 0 10", "term a H: ramp 6 10")
    verdict = prove(_rulebase(text), "y in 0 .. 100", budget=1.0)
    assert verdict.verdict != "proved"
    # With a number for no rule it is one of the values.
    named = text.replace("inference m:", "inference m: no-rule 0.1,")
    bounds = Prover(_rulebase(named), "y", tolerance=2.0, stop=Stop(5.0)).value(
        {"a": (4.5, 5.5), "b": (0.0, 1.0)}
    )
    y = fuzzyarm.infer(_rulebase(named), a=5.0, b=0.5)["y"]
    assert bounds.low <= y <= bounds.high


@settings(max_examples=cases(4, 40))
@given(strategies.plain_mamdani(), strategies.plain_mamdani())
def test_no_value_of_a_chain_is_outside_its_bounds(one, other) -> None:
    ends = ("p", one.outputs[0].name), ("q", other.inputs[0].name)
    connection = " -> ".join(map("/".join, ends))
    joint = tree({"p": _with_numbers(one), "q": _with_numbers(other)}, [connection]).rulebase
    assert joint is not None
    name = joint.outputs[-1].name
    # As coarse as can be: the first boxes, and what they are cut into for half a second.
    bounds = Prover(joint, name, tolerance=1.0, stop=Stop(0.5)).value({})
    rng = np.random.default_rng(0)
    inputs = {v.name: rng.uniform(v.low, v.high, 200) for v in joint.inputs}
    values = np.asarray(fuzzyarm.infer(joint, inputs)[name])
    assert bounds.low <= values.min()
    assert values.max() <= bounds.high


def _with_numbers(rulebase: fuzzyarm.RuleBase) -> fuzzyarm.RuleBase:
    """Return a rule base that has a number everywhere, and reads inputs as they are."""
    outputs = tuple(replace(o, no_rule=0.5 * (o.low + o.high)) for o in rulebase.outputs)
    inputs = tuple(replace(v, outside="extend") for v in rulebase.inputs)
    return replace(rulebase, inputs=inputs, outputs=outputs)
