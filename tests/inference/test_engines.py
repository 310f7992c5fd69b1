"""Invariants of the engines, over rule bases of every kind."""

from __future__ import annotations

import dataclasses
import itertools
import math
import subprocess
import sys

import numpy as np
import pytest
from budget import cases
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzyarm.inference import InferenceError, NoRuleFiredError, compiled, explain, infer
from fuzzyarm.inference.sweeps import parts_of
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import (
    And,
    Defuzzifier,
    Expression,
    Hedged,
    Is,
    Or,
    Output,
    RuleBase,
)
from tests.interpreted import interpreted
from tests.strategies import SMOOTH, STRAIGHT, input_points, plain_mamdani, rulebases

slow_draws = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


def held_middles(rulebase: RuleBase) -> dict[str, float]:
    return {each.name: 0.5 * (each.low + each.high) for each in rulebase.outputs}


def tolerance(output: Output) -> float:
    # The inverse of a set has an infinite slope at its ends (Tsukamoto): the last bit of a
    # strength moves it by the root of that bit.
    share = 3e-8 if output.defuzzifier.method == "tsukamoto" else 1e-12
    return share * max(1.0, output.high - output.low)


@pytest.mark.slow
@settings(slow_draws, max_examples=cases(20, 120))
@given(st.data())
def test_one_point_at_a_time_equals_arrays(data: st.DataObject) -> None:
    rulebase = data.draw(rulebases())
    points = data.draw(input_points(rulebase, 4))
    held = held_middles(rulebase)
    try:
        found = infer(rulebase, {k: np.array(v) for k, v in points.items()}, held=held)
    except InferenceError as error:
        with pytest.raises(type(error)):
            _ = [infer(rulebase, {k: v[i] for k, v in points.items()}, held=held) for i in range(4)]
        return
    except NoRuleFiredError as error:
        with pytest.raises(NoRuleFiredError):
            infer(rulebase, error.inputs, held=held)
        return
    for i in range(4):
        single = infer(rulebase, {k: v[i] for k, v in points.items()}, held=held)
        for output in rulebase.outputs:
            value = single[output.name]
            assert isinstance(value, float)
            assert math.isfinite(value)
            scale = max(1.0, abs(value))
            assert abs(found[output.name][i] - value) <= tolerance(output) * scale


@pytest.mark.slow
@settings(slow_draws, max_examples=cases(12, 60))
@given(st.data())
def test_outputs_of_sets_stay_in_their_range(data: st.DataObject) -> None:
    rulebase = data.draw(rulebases())
    rulebase = dataclasses.replace(
        rulebase,
        outputs=tuple(
            dataclasses.replace(each, no_rule=each.low, outside="clamp")
            for each in rulebase.outputs
        ),
    )
    points = data.draw(input_points(rulebase, 6))
    for name, values in infer(rulebase, {k: np.array(v) for k, v in points.items()}).items():
        output = rulebase.output(name)
        assert (values >= output.low).all()
        assert (values <= output.high).all()


@settings(slow_draws, max_examples=cases(12, 60))
@given(st.data())
def test_the_order_of_rules_changes_nothing(data: st.DataObject) -> None:
    rulebase = data.draw(
        plain_mamdani(
            aggregations=("max", "sum", "probor", "einstein", "hamacher", "bounded"),
            implications=("min", "product"),
            kinds=STRAIGHT + SMOOTH,
        )
    )
    block = rulebase.blocks[0]
    shuffled = data.draw(st.permutations(block.rules))
    other = dataclasses.replace(
        rulebase, blocks=(dataclasses.replace(block, rules=tuple(shuffled)),)
    )
    points = {k: np.array(v) for k, v in data.draw(input_points(rulebase, 6)).items()}
    width = rulebase.outputs[0].high - rulebase.outputs[0].low
    np.testing.assert_allclose(
        infer(rulebase, points)["u"], infer(other, points)["u"], rtol=0, atol=1e-11 * width
    )


@settings(max_examples=cases(10, 30))
@given(st.data())
def test_rules_with_one_consequent_never_overwrite_each_other(data: st.DataObject) -> None:
    """Under max, several rules of one consequent are one rule with their disjunction."""
    rulebase = data.draw(plain_mamdani(defuzzifier=Defuzzifier("centroid", 51)))
    rulebase = dataclasses.replace(
        rulebase,
        blocks=tuple(
            dataclasses.replace(
                block, rules=tuple(dataclasses.replace(rule, weight=1.0) for rule in block.rules)
            )
            for block in rulebase.blocks
        ),
    )
    block = rulebase.blocks[0]
    merged: dict[object, list[Expression]] = {}
    for rule in block.rules:
        merged.setdefault(rule.consequents, []).append(rule.antecedent)
    rules = tuple(
        dataclasses.replace(
            block.rules[0], antecedent=parts[0] if len(parts) == 1 else Or(tuple(parts)),
            consequents=consequents,
        )
        for consequents, parts in merged.items()
    )  # fmt: skip
    other = dataclasses.replace(rulebase, blocks=(dataclasses.replace(block, rules=rules),))
    points = {k: np.array(v) for k, v in data.draw(input_points(rulebase, 6)).items()}
    np.testing.assert_allclose(infer(rulebase, points)["u"], infer(other, points)["u"], atol=1e-13)


METHODS = [
    Defuzzifier(),
    Defuzzifier("centroid", 101, "endpoints"),
    Defuzzifier("centroid", 100, "midpoints"),
    Defuzzifier("centroid", 101, "trapezoid"),
    Defuzzifier("bisector"),
    Defuzzifier("bisector", 101),
    Defuzzifier("mean-of-maximum"),
    Defuzzifier("mean-of-maximum", 101),
    Defuzzifier("weighted-average"),
]


@pytest.mark.parametrize("aggregation", ["max", "sum", "probor"])
@pytest.mark.parametrize("defuzzifier", METHODS, ids=str)
def test_an_antisymmetric_rule_base_gives_an_antisymmetric_output(
    pd7: RuleBase, defuzzifier: Defuzzifier, aggregation: str
) -> None:
    output = dataclasses.replace(pd7.outputs[0], defuzzifier=defuzzifier, aggregation=aggregation)
    rulebase = dataclasses.replace(pd7, outputs=(output,))
    e, ce = np.random.default_rng(1).uniform(-6.0, 6.0, (2, 40))
    there, back = infer(rulebase, e=e, ce=ce)["u"], infer(rulebase, e=-e, ce=-ce)["u"]
    if defuzzifier == Defuzzifier("bisector", 101):
        np.testing.assert_allclose(there, -back, atol=0.12 + 1e-9)  # to the spacing of samples
    else:
        np.testing.assert_allclose(there, -back, atol=1e-9)


def test_the_grid_is_not_transposed(pd7: RuleBase) -> None:
    # The table of pd7 is nearly symmetric, so one rule in a corner stands for it.
    lopsided = dataclasses.replace(
        pd7, blocks=(dataclasses.replace(pd7.blocks[0], rules=pd7.blocks[0].rules[:1]),)
    )
    rule = lopsided.blocks[0].rules[0]
    asymmetric = dataclasses.replace(rule, antecedent=And((Is("e", "PB"), Is("ce", "NB"))))
    rulebase = dataclasses.replace(
        lopsided,
        outputs=(dataclasses.replace(pd7.outputs[0], no_rule=0.0),),
        blocks=(dataclasses.replace(pd7.blocks[0], rules=(asymmetric,)),),
    )
    axis = np.array([-6.0, 0.0, 6.0])
    table = infer(rulebase, e=axis[:, None], ce=axis[None, :])["u"]
    assert table[2, 0] < -4.0
    assert np.count_nonzero(table) == 1


def test_evaluating_leaves_no_trace(pd7: RuleBase) -> None:
    first = infer(pd7, e=1.3, ce=-2.2)
    infer(pd7, e=-6.0, ce=-6.0)
    infer(pd7, e=np.linspace(-6, 6, 50), ce=0.0)
    explain(pd7, e=6.0, ce=6.0)
    assert infer(pd7, e=1.3, ce=-2.2) == first


@pytest.mark.parametrize("shape", [(), (1,), (7,), (3, 5), (2, 3, 4), (0,), (3, 0)])
def test_arrays_of_any_shape(pd7: RuleBase, shape: tuple[int, ...]) -> None:
    e = np.random.default_rng(0).uniform(-6, 6, shape)
    u = infer(pd7, e=e, ce=0.5)["u"]
    assert np.shape(u) == shape
    flat = [infer(pd7, e=float(each), ce=0.5)["u"] for each in e.ravel()]
    np.testing.assert_allclose(np.ravel(u), flat, atol=1e-12)


def test_axes_broadcast(pd7: RuleBase) -> None:
    e, ce = np.linspace(-6, 6, 31), np.linspace(-5, 6, 17)
    table = infer(pd7, e=e[:, None], ce=ce)["u"]
    full = infer(pd7, e=np.repeat(e, 17), ce=np.tile(ce, 31))["u"]
    np.testing.assert_array_equal(table, full.reshape(31, 17))


def test_a_number_broadcasts_along_axes_of_two_others() -> None:
    rulebase = parse(
        "rulebase three\ninput x 0 .. 1\ninput y 0 .. 1\ninput z 0 .. 1\noutput u 0 .. 3\n"
        "terms x: triangles L H\nterms y: triangles L H\nterms z: triangles L H\n"
        "term u A: singleton 0\nterm u B: singleton 3\n"
        "inference u: defuzzifier weighted-average\n"
        "rule if x is H and y is H or z is H then u is B\nrule if x is L or y is L then u is A\n"
    ).rulebase
    assert rulebase is not None
    x, y = np.linspace(0, 1, 3)[:, None], np.linspace(0, 1, 4)[None, :]
    values = interpreted(rulebase).evaluate({"x": x, "y": y, "z": 0.25})["u"]
    each = [[infer(rulebase, x=a, y=b, z=0.25)["u"] for b in y[0]] for a in x[:, 0]]
    np.testing.assert_allclose(values, each, atol=1e-12)


@pytest.mark.parametrize("method", ["centroid exact", "bisector exact"])
def test_a_set_that_is_nowhere_above_0_takes_no_part(method: str) -> None:
    text = (
        "rulebase none\ninput x 0 .. 1\noutput u 0 .. 1\nterms x: triangles L H\n"
        f"{{}}term u G: gaussian 0.3 0.2\ninference u: defuzzifier {method}\n{{}}"
        "rule if x is H then u is G\n"
    )
    bare = parse(text.format("", "")).rulebase
    extra = "term u Z: points (0, 0) (1, 0)\n", "rule if x is L then u is Z\n"
    rulebase = parse(text.format(*extra)).rulebase
    assert bare is not None
    assert rulebase is not None
    x = np.linspace(0.1, 1, 10)
    values = [interpreted(model).evaluate({"x": x})["u"] for model in (bare, rulebase)]
    np.testing.assert_allclose(values[0], values[1], atol=1e-12)


def test_chunks_change_nothing(pd7: RuleBase, monkeypatch: pytest.MonkeyPatch) -> None:
    e, ce = np.linspace(-6, 6, 23)[:, None], np.linspace(-6, 6, 29)[None, :]
    whole = infer(pd7, e=e, ce=ce)["u"]
    for size in (1, 7, 30, 100):
        monkeypatch.setattr("fuzzyarm.inference.sweeps.CHUNK", size)
        np.testing.assert_array_equal(infer(pd7, e=e, ce=ce)["u"], whole)


@given(st.lists(st.integers(0, 6), max_size=4).map(tuple), st.integers(1, 40))
def test_parts_cover_a_shape_once(shape: tuple[int, ...], most: int) -> None:
    seen = np.zeros(shape, dtype=int)
    for block in parts_of(shape, most):
        assert seen[block].size <= most
        seen[block] += 1
    assert (seen == 1).all()


def test_a_large_surface_needs_little_memory(pd7: RuleBase) -> None:
    import tracemalloc

    axis = np.linspace(-6, 6, 1000)
    tracemalloc.start()
    infer(pd7, e=axis[:, None], ce=axis[None, :])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2 * 8 * axis.size**2  # the result itself is half of this


def test_single_precision_inputs_are_taken_as_they_are(pd7: RuleBase) -> None:
    e = np.linspace(-6, 6, 11, dtype=np.float32)
    u = infer(pd7, e=e, ce=np.float32(0.25))["u"]
    assert u.dtype == np.float64
    np.testing.assert_array_equal(u, infer(pd7, e=e.astype(float), ce=0.25)["u"])
    assert isinstance(infer(pd7, e=np.float32(1.0), ce=1)["u"], float)


def test_importing_and_a_single_point_need_no_array_library() -> None:
    code = (
        "import sys\nimport fuzzyarm.inference as i\n"
        "from fuzzyarm.language.model.rulebase import *\n"
        "t = (Term('A', Shape('triangle', (0.0, 1.0, 2.0))),)\n"
        "r = RuleBase('r', (Input('e', 0.0, 2.0, t),), (Output('u', 0.0, 2.0, t),),"
        " (RuleBlock((Rule(Is('e', 'A'), (Consequent('u', 'A'),)),)),))\n"
        "assert i.infer(r, e=0.5) == {'u': 1.0}\n"
        "i.explain(r, e=0.5); i.check_expectations(r)\n"
        "heavy = {'numpy', 'scipy', 'skfuzzy', 'numba', 'matplotlib'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.slow
def test_every_combination_of_norms_agrees_in_both_engines(pd7: RuleBase) -> None:
    from tests.strategies import CONJUNCTIONS, DISJUNCTIONS

    e, ce = np.array([1.3, -6.0, 0.0, 3.0]), np.array([-2.2, 6.0, 0.0, 5.5])
    for implication, aggregation in itertools.product(CONJUNCTIONS, DISJUNCTIONS):
        output = dataclasses.replace(pd7.outputs[0], aggregation=aggregation, no_rule=0.0)
        block = dataclasses.replace(pd7.blocks[0], implication=implication)
        rulebase = dataclasses.replace(pd7, outputs=(output,), blocks=(block,))
        arrays = infer(rulebase, e=e, ce=ce)["u"]
        singles = [infer(rulebase, e=a, ce=b)["u"] for a, b in zip(e, ce, strict=True)]
        np.testing.assert_allclose(
            arrays, singles, rtol=0, atol=2e-11, err_msg=f"{implication} {aggregation}"
        )


def test_hedges_on_a_whole_expression(pd7: RuleBase) -> None:
    from fuzzyarm.language.model.rulebase import Consequent, Hedge, Rule

    inside = Or((Is("e", "NB"), Is("e", "PB")))
    rule = Rule(Hedged((Hedge("not"), Hedge("very")), inside), (Consequent("u", "PB"),))
    rulebase = dataclasses.replace(pd7, blocks=(dataclasses.replace(pd7.blocks[0], rules=(rule,)),))
    assert explain(rulebase, e=5.0, ce=0.0).rules[0].strength == 0.75


@pytest.mark.parametrize("x", [1e155, 1e200, -1e308])
def test_values_far_beyond_an_extended_range_end_in_the_flanks(x: float) -> None:
    text = """rulebase far
input a -1 .. 1
output u 0 .. 1
term a G: gaussian 0 0.5
term a T: two-sided-gaussian -0.1 0.2 0.1 0.3
term a B: bell 0 1 2
term a S: sigmoid 0 -4
terms u: triangles L H
inference a: outside extend
inference no-rule 0.25
rule if a is G or a is T or a is B then u is H
rule if a is not S and a is G then u is L
"""
    rulebase = parse(text).rulebase
    assert rulebase is not None
    assert infer(rulebase, a=x)["u"] == 0.25
    assert infer(rulebase, a=np.array([x]))["u"][0] == 0.25
    assert compiled(rulebase)(a=np.array([x]))["u"][0] == 0.25


@pytest.mark.slow
@settings(slow_draws, max_examples=cases(12, 60))
@given(st.data())
def test_an_open_mesh_equals_its_full_grid(data: st.DataObject) -> None:
    """Rules on some of the inputs have strengths of smaller shapes than the mesh."""
    rulebase = data.draw(rulebases())
    axes = [np.linspace(v.low, v.high, 2 + i) for i, v in enumerate(rulebase.inputs)]
    names = [v.name for v in rulebase.inputs]
    held = held_middles(rulebase)
    mesh = dict(zip(names, np.ix_(*axes), strict=True))
    full = dict(zip(names, np.meshgrid(*axes, indexing="ij"), strict=True))
    fast = compiled(rulebase)
    engines = [
        lambda given: interpreted(rulebase).evaluate(given, held),
        lambda x: fast(x, held=held),
    ]
    try:
        expected = engines[0](full)
    except (InferenceError, NoRuleFiredError) as error:
        for engine in engines:
            with pytest.raises(type(error)):
                engine(mesh)
        return
    for found in (engine(mesh) for engine in engines):
        for output in rulebase.outputs:
            there = np.broadcast_to(found[output.name], [axis.size for axis in axes])
            wanted = expected[output.name]
            scale = max(1.0, np.abs(wanted).max())
            assert np.abs(there - wanted).max() <= tolerance(output) * scale


def test_a_rule_on_more_inputs_may_join_those_on_fewer_on_an_open_mesh() -> None:
    text = """rulebase t
input a 0 .. 1
input b 0 .. 1
output y 0 .. 1
terms a, b, y: triangles LO HI
rule if a is LO then y is HI
rule if a is HI then y is HI
rule if a is HI and b is HI then y is HI
"""
    a, b = np.array([[0.1], [0.7]]), np.array([[0.1, 0.5, 0.9]])
    whole = infer(parse(text).rulebase, a=a, b=b)["y"]
    for i, j in np.ndindex(whole.shape):
        one = infer(parse(text).rulebase, a=float(a[i, 0]), b=float(b[0, j]))["y"]
        assert whole[i, j] == pytest.approx(one, rel=1e-12)


def test_rules_on_fewer_inputs_join_on_an_open_mesh() -> None:
    """Rules on y alone for A and B, on x alone for C: heights of three shapes meet."""
    text = """
rulebase mesh
input x 0 .. 2
input y 0 .. 2
output u 0 .. 4
terms x, y: triangles LOW HIGH
term u A: triangle 0 1 3
term u B: triangle 0 2 4
term u C: triangle 1 2 4
rule if y is LOW then u is A
rule if y is HIGH then u is B
rule if x is LOW then u is C
rule if x is HIGH then u is C
"""
    parsed = parse(text).rulebase
    assert parsed is not None
    x, y = np.linspace(0.0, 2.0, 5), np.linspace(0.0, 2.0, 7)
    mesh = interpreted(parsed).evaluate({"x": x[:, None], "y": y[None, :]})["u"]
    one = [[interpreted(parsed).point({"x": a, "y": b})["u"] for b in y] for a in x]
    np.testing.assert_allclose(mesh, one, rtol=0, atol=1e-12)
