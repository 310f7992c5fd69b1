"""How far two rule bases are apart: the worst point beside a fine grid."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fuzzyarm import infer, load
from fuzzyarm.apps.cli import main
from fuzzyarm.inference.apart import UnlikeRuleBasesError, apart
from fuzzyarm.language import parse

ROOT = Path(__file__).parents[2]
PD7 = ROOT / "rulebases" / "pd7.frb"
JUMP = """rulebase a
input  x 0 .. 10
output y 0 .. 1
term x lo: ramp 6 2
term x hi: ramp 3 8
term y s: singleton 0
term y b: singleton 1
inference defuzzifier weighted-average
rule if x is lo then y is s
rule if x is hi then y is b
"""


def made(text):
    return parse(text).rulebase


def moved(rulebase, by):
    """Return a rule base with the middle term of its first input moved."""
    first = rulebase.inputs[0]
    at = len(first.terms) // 2
    shape = first.terms[at].shape
    shape = replace(shape, parameters=tuple(x + by for x in shape.parameters))
    terms = (*first.terms[:at], replace(first.terms[at], shape=shape), *first.terms[at + 1 :])
    return replace(rulebase, inputs=(replace(first, terms=terms), *rulebase.inputs[1:]))


@pytest.mark.parametrize("name", ["pd7", "roompi", "fan"])
@pytest.mark.parametrize("by", [0.3, 1e-3])
def test_no_point_of_a_fine_grid_is_worse(name, by):
    one = load(ROOT / "rulebases" / f"{name}.frb").model
    two = moved(one, by)
    count = round(250_000 ** (1.0 / len(one.inputs)))
    axes = [np.linspace(variable.low, variable.high, count) for variable in one.inputs]
    grid = [axis.ravel() for axis in np.meshgrid(*axes)]
    points = {variable.name: axis for variable, axis in zip(one.inputs, grid, strict=True)}
    for found in apart(one, two):
        gap = np.abs(infer(two, points)[found.output] - infer(one, points)[found.output])
        assert found.worst >= gap.max() * (1 - 1e-9)
        assert found.worst <= 1.2 * gap.max() + 1e-12
        assert found.rms == pytest.approx(math.sqrt(float(np.mean(gap * gap))), rel=0.08)
        values = infer(one, found.at)[found.output], infer(two, found.at)[found.output]
        assert (found.before, found.after) == values
        assert abs(values[1] - values[0]) == found.worst


def test_a_difference_beside_a_jump_is_found():
    one = made(JUMP.replace("ramp 6 2", "rectangle 0 3"))
    two = made(JUMP.replace("ramp 6 2", "rectangle 0 3.001"))
    (found,) = apart(one, two)
    # Between 3 and 3.001 the first one has one rule, the second one two.
    assert found.worst == pytest.approx(1.0 - 0.001 / 5 / (1 + 0.001 / 5), abs=1e-3)
    assert 3.0 <= found.at["x"] <= 3.0010001


def test_where_only_one_has_a_value_is_told():
    one = made(JUMP.replace("ramp 3 8", "ramp 8 10"))  # nothing fires between 6 and 8
    one = replace(one, outputs=tuple(replace(o, no_rule=math.nan) for o in one.outputs))
    (found,) = apart(one, made(JUMP))
    assert 6.0 <= found.missing["x"] <= 8.0


def test_the_same_rule_base_is_nowhere_apart():
    model = load(PD7).model
    assert [found.worst for found in apart(model, model)] == [0.0]


def test_names_that_differ_correspond_in_their_order():
    one = made(JUMP)
    other = made(JUMP.replace(" x ", " z ").replace("if x", "if z"))
    assert apart(one, other)[0].worst == 0.0
    assert set(apart(one, other)[0].at) == {"z"}
    more = made(JUMP.replace("output", "input  w 0 .. 1\noutput"))
    with pytest.raises(UnlikeRuleBasesError, match="one has 1 inputs, the other 2"):
        apart(one, more)


def test_diff_compares_a_conversion_by_numbers(tmp_path, capsys):
    assert main(["convert", str(PD7), str(tmp_path / "pd7.fis")]) == 0
    capsys.readouterr()
    assert main(["diff", str(PD7), str(tmp_path / "pd7.fis"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    (output,) = found["outputs"]
    (expected,) = apart(load(PD7).model, load(tmp_path / "pd7.fis").model)
    assert output["worst"] == pytest.approx(expected.worst)
    assert main(["diff", str(PD7), str(tmp_path / "pd7.fis")]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "u: apart by" in said or "u: no difference at" in said


@pytest.mark.slow
def test_rule_bases_of_many_inputs_are_compared():
    def many(value):
        lines = [
            f"input  x{k} 0 .. 1\nterm x{k} low: ramp 1 0\nterm x{k} high: ramp 0 1"
            for k in range(20)
        ]
        rules = [
            f"rule if x{k} is high then y is b\nrule if x{k} is low then y is s" for k in range(20)
        ]
        return made("\n".join([
            "rulebase a", *lines, "output y 0 .. 2", "term y s: singleton 0",
            f"term y b: singleton {value}", "inference defuzzifier weighted-average", *rules,
        ]))  # fmt: skip

    # The mean of all inputs, times 1 and times 2: farthest apart where all are 1.
    (found,) = apart(many(1), many(2))
    assert found.worst == pytest.approx(1.0, abs=1e-9)
    assert set(found.at.values()) == {1.0}
