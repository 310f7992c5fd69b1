"""Outputs that later rules read: stages of the kernel, with the bits of one point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from budget import cases
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzyarm import compiled, infer
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference import NoRuleFiredError, explain
from fuzzyarm.inference.stages import stages
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from tests.interpreted import interpreted
from tests.strategies import input_points, rulebases

HEAD = """rulebase chain
input a 0 .. 1
input b -1 .. 1
output y 0 .. 10
output z -2 .. 2
output w 0 .. 4
terms a, b, y: triangles N Z P
terms z: gaussians N P
"""

CHAIN = """terms w: triangles L H
inference no-rule {silent}
block first
rule if a is N and b is not P then y is P
rule if a is P then y is N with 0.7
block second
rule if y is P or a is very Z then z is P
rule if y is not P and b is N then z is N
block third
rule if z is P and y is N then w is H
rule if z is N or b is P then w is L
"""

ASSERTED = """terms w: triangles L H
inference threshold 0.1, no-rule 0
inference z: aggregation {union}
rule if a is N or b is P then z is P with 0.8
rule if a is P then z is P
rule if b is N and a is Z then z is N
block behind
rule if z is very P and b is not N then w is H
rule if z is not N then w is L with 0.5
"""

FORMULAS = """term w L: linear 1*a + 2*b + 0.5
term w H: formula "y * z - b"
inference w: defuzzifier weighted-average
rule if a is N then y is P
rule if a is Z or a is P then y is N
rule if b is N then z is P
rule if b is Z or b is P then z is N
block last
rule if a is P then w is L
rule if b is not P then w is H
rule if y is P then w is L
"""


def read(text: str) -> RuleBase:
    parsed = parse(HEAD + text)
    assert parsed.rulebase is not None, [str(each) for each in parsed.diagnostics]
    return parsed.rulebase


def in_one_block(rulebase: RuleBase) -> RuleBase:
    """Put the first two blocks together: a text may not, files of other programs do."""
    first, second, *others = rulebase.blocks
    both = replace(first, rules=first.rules + second.rules)
    return replace(rulebase, blocks=(both, *others))


def demand_bits_of_points(rulebase: RuleBase) -> None:
    """Points and arrays go through the kernel, and have the bits of plain Python."""
    fast = compiled(rulebase)
    assert fast.reason == ""
    assert fast.kernel == "machine code"
    draw = np.random.default_rng(3)
    count = cases(100, 200)
    columns = {v.name: draw.uniform(v.low, v.high, count) for v in rulebase.inputs}
    rows = [dict(zip(columns, map(float, row), strict=True)) for row in zip(*columns.values())]  # noqa: B905
    held = {output.name: 0.25 for output in rulebase.outputs}
    wanted = [interpreted(rulebase).point(row, held) for row in rows]
    for found in (fast(columns, held=held), infer(rulebase, columns, held=held)):
        for name, values in found.items():
            np.testing.assert_array_equal(values, [each[name] for each in wanted])
    ordinary = [fast.named_point(row) for row in rows]
    assert [found for found in ordinary if found] == [
        each for each, found in zip(wanted, ordinary, strict=True) if found
    ]
    assert any(ordinary)


@pytest.mark.slow
@pytest.mark.parametrize("silent", ["0.5", "12", "nan", "hold"])
def test_rules_read_outputs_of_earlier_blocks(silent: str) -> None:
    rulebase = read(CHAIN.format(silent=silent))
    assert len(stages(rulebase)) == 3
    demand_bits_of_points(rulebase)


@pytest.mark.parametrize("union", ["max", "sum", "probor", "bounded"])
def test_rules_read_how_far_their_own_block_asserts(union: str) -> None:
    rulebase = in_one_block(read(ASSERTED.format(union=union)))
    assert stages(rulebase) == (rulebase,)
    demand_bits_of_points(rulebase)


@pytest.mark.slow
def test_formulas_read_outputs() -> None:
    rulebase = read(FORMULAS)
    assert len(stages(rulebase)) == 2
    demand_bits_of_points(rulebase)


def test_the_error_of_a_later_stage_names_the_inputs() -> None:
    rulebase = read(CHAIN.format(silent="0.5").replace("no-rule 0.5", "no-rule error"))
    for point in ({"a": 0.5, "b": 0.0}, {"a": np.array([0.5, 0.5]), "b": np.array([0.0, 0.0])}):
        with pytest.raises(NoRuleFiredError, match=r"for 'y' at a = 0.5, b = 0 "):
            compiled(rulebase)(point)


@pytest.mark.slow
def test_an_output_is_read_as_a_value_and_as_a_set() -> None:
    text = ASSERTED.format(union="max").replace("terms w", "output v 0 .. 1\nterms v, w")
    more = "rule if z is P then v is H\nblock last\nrule if z is N then v is L\n"
    rulebase = in_one_block(read(text + more))
    assert len(stages(rulebase)) == 2
    wanted = {"y": 0.0, "z": 0.30705349447234126, "w": 1.5873775873217315, "v": 0.4759123990393927}
    assert infer(rulebase, a=0.3, b=0.4) == wanted
    demand_bits_of_points(rulebase)


@pytest.mark.slow
@settings(
    max_examples=cases(20, 100),
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(st.data())
def test_stages_of_any_rule_base_have_the_bits_of_a_point(data: st.DataObject) -> None:
    rulebase = data.draw(rulebases())
    columns = data.draw(input_points(rulebase, 4))
    fast = compiled(rulebase)
    for row in zip(*columns.values(), strict=True):
        point = dict(zip(columns, row, strict=True))
        found = fast.named_point(point)
        if found is not None:
            assert found == interpreted(rulebase).point(point)
        else:
            try:
                interpreted(rulebase).point(point)
            except FuzzyarmError:
                continue


@pytest.mark.parametrize("shape", ["triangle 0 1 1", "gaussian 1 0.3"])
def test_no_rule_reads_an_output_without_a_value(shape: str) -> None:
    """Under `any` a term holds everywhere, but not where there is no value."""
    text = (
        "rulebase none\ninput a 0 .. 1\noutput y 0 .. 1\noutput z 0 .. 1\n"
        f"terms a, z: triangles L H\nterm y H: {shape}\ninference y: no-rule nan\n"
        "inference z: no-rule 0.25\ninference threshold 0.1\n"
        "rule if a is H then y is H\nblock next\nrule if y is any not H then z is H\n"
    )
    rulebase = parse(text).rulebase
    assert rulebase is not None
    assert infer(rulebase, a=0.0)["z"] == infer(rulebase, a=np.zeros(2))["z"][1] == 0.25
    assert [rule.strength for rule in explain(rulebase, a=0.0).rules] == [0.0, 0.0]
    assert infer(rulebase, a=0.5)["z"] > 0.5
