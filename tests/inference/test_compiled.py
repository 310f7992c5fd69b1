"""Machine code equals the readable engine, over rule bases of every kind."""

from __future__ import annotations

import dataclasses
import gc
import math
import weakref
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from budget import cases
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzyarm.inference import (
    Compiled,
    InferenceError,
    NoRuleFiredError,
    compiled,
    explain,
    infer,
    layout,
)
from fuzzyarm.inference.cells import _buckets
from fuzzyarm.inference.errors import NotANumberError
from fuzzyarm.inference.kernel import bucket_of
from fuzzyarm.inference.layout import lay_out
from fuzzyarm.inference.plan import plan
from fuzzyarm.inference.prepared import MOST, prepared
from fuzzyarm.inference.row_functions import _row_function
from fuzzyarm.inference.stage import Stage
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Hedge,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.learning.tuning.design import Design
from fuzzyarm.symbolic import kernels
from fuzzyarm.symbolic.kernels import has_machine_code
from fuzzyarm.symbolic.kinds import TNORMS
from tests.inference import small
from tests.interpreted import interpreted
from tests.strategies import (
    CONJUNCTIONS,
    DISJUNCTIONS,
    SMOOTH,
    STRAIGHT,
    hedge_lists,
    input_points,
    plain_mamdani,
    rulebases,
    shapes,
)

slow_draws = settings(
    deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large]
)


def held_middles(rulebase: RuleBase) -> dict[str, float]:
    return {each.name: 0.5 * (each.low + each.high) for each in rulebase.outputs}


def assert_equal_engines(rulebase: RuleBase, points: dict[str, list[float]]) -> str:
    fast, held = compiled(rulebase), held_middles(rulebase)
    arrays = {name: np.array(values) for name, values in points.items()}
    try:
        expected = interpreted(rulebase).evaluate(arrays, held)
    except (InferenceError, NoRuleFiredError) as error:
        with pytest.raises(type(error)):
            fast(arrays, held=held)
        return fast.kernel
    found = fast(arrays, held=held)
    count = len(next(iter(points.values())))
    for output in rulebase.outputs:
        for i in range(count):
            value = expected[output.name][i]  # type: ignore[index]
            scale = max(1.0, output.high - output.low) * max(1.0, abs(value))
            assert abs(found[output.name][i] - value) <= 1e-12 * scale
    for i in range(count):
        one = fast({name: values[i] for name, values in points.items()}, held=held)
        for output in rulebase.outputs:
            assert isinstance(one[output.name], float)
            if fast.kernel == "machine code":
                # Curved memberships of one point come from plain Python.
                value = found[output.name][i]
                scale = max(1.0, output.high - output.low) * max(1.0, abs(value))
                assert abs(one[output.name] - value) <= 1e-12 * scale
    return fast.kernel


@pytest.mark.slow
@settings(slow_draws, max_examples=cases(15, 60))
@given(st.data())
def test_any_rule_base(data: st.DataObject) -> None:
    rulebase = data.draw(rulebases())
    assert_equal_engines(rulebase, data.draw(input_points(rulebase, 5)))


@pytest.mark.slow
@settings(slow_draws, max_examples=cases(40, 200))
@given(st.data())
def test_mamdani_rule_bases_are_covered(data: st.DataObject) -> None:
    sampled = Defuzzifier("centroid", 51, data.draw(st.sampled_from(["endpoints", "trapezoid"])))
    exact = data.draw(st.booleans())
    rulebase = data.draw(
        plain_mamdani(
            aggregations=("max", "sum") if exact else DISJUNCTIONS,
            implications=("min",) if exact else CONJUNCTIONS,
            kinds=STRAIGHT if exact else STRAIGHT + SMOOTH,
            defuzzifier=None if exact else sampled,
        )
    )
    assert assert_equal_engines(rulebase, data.draw(input_points(rulebase, 8))) == "machine code"


@pytest.mark.slow
@settings(slow_draws, max_examples=cases(15, 60))
@given(st.data())
def test_a_point_by_itself_has_the_bits_that_it_has_among_others(data: st.DataObject) -> None:
    """Both walk the same programs, one number by number, one row by row."""
    rulebase = data.draw(
        plain_mamdani(aggregations=DISJUNCTIONS, implications=CONJUNCTIONS, kinds=STRAIGHT)
        if data.draw(st.booleans())
        else rulebases()
    )
    fast, points = compiled(rulebase), data.draw(input_points(rulebase, 6))
    rows = [
        fast.named_point(dict(zip(points, row, strict=True)))
        for row in zip(*map(np.ndarray.tolist, map(np.asarray, points.values())), strict=True)
    ]
    curved = any(
        not piece.straight
        for output in plan(rulebase).outputs.values()
        for member in output.members
        for piece in member.pieces
    ) or any(term.shape.kind in SMOOTH for each in rulebase.inputs for term in each.terms)
    whole = {each.name: np.array([row if row is None else row[each.name] for row in rows], float)
             for each in rulebase.outputs}  # fmt: skip
    silent = dict.fromkeys(whole, np.nan)
    try:
        found = fast(points, held=silent)
    except (InferenceError, NoRuleFiredError):
        return
    for name, values in whole.items():
        told = ~np.isnan(values)
        close = {"rtol": 1e-12, "atol": 1e-12} if curved else {"rtol": 0.0, "atol": 0.0}
        np.testing.assert_allclose(values[told], np.asarray(found[name])[told], **close)


@pytest.mark.slow
@settings(slow_draws, max_examples=cases(20, 80))
@given(st.data())
def test_integrals_and_samples_have_the_bits_of_plain_python(data: st.DataObject) -> None:
    """So `infer` may go from one to the other while a program runs."""
    sampled = Defuzzifier("centroid", 31, "trapezoid")
    way = data.draw(st.sampled_from([Defuzzifier(), Defuzzifier("bisector"), sampled]))
    rulebase = data.draw(
        plain_mamdani(
            aggregations=[name for name in DISJUNCTIONS if name != "hamacher"],
            implications=[name for name in CONJUNCTIONS if name != "drastic"],
            kinds=STRAIGHT + SMOOTH,
            defuzzifier=way,
        )
    )
    fast, one = compiled(rulebase), interpreted(rulebase)
    assert fast.kernel == "machine code"
    points = data.draw(input_points(rulebase, 3))
    for row in zip(*points.values(), strict=True):
        found, wanted = fast.at(*row)[0], one.evaluate(dict(zip(points, row, strict=True)))["u"]
        assert found == wanted


def test_infer_takes_names_numbers_and_both() -> None:
    text = """rulebase round
input a 0 .. 1
output u 0 .. 6
terms a: triangles LO HI
term u A: gaussian 0 2
term u B: gaussian 6 1
inference aggregation sum
rule if a is LO then u is A
rule if a is HI then u is B
"""
    rulebase = parse(text).rulebase
    assert rulebase is not None
    wanted = interpreted(rulebase).point({"a": 0.3})
    for _ in range(3):
        assert infer(rulebase, a=0.3) == infer(rulebase, {"a": 0.3}) == wanted
    assert infer(rulebase, {}, a=np.float64(0.3)) == wanted


SUMS = """rulebase sums
input a 0 .. 1
input b 0 .. 1
output u 0 .. 6
terms a, b: triangles LO HI
terms u: triangles A B C
inference and {norm}, no-rule 0, aggregation {union}
rule if a is LO and b is HI and a is not HI then u is A with 0.5
rule if (a is HI or b is LO or a is not LO) then u is B with 0.6
rule if very (a is HI or b is HI or b is not LO) then u is C with 0.7
rule if (a is LO or b is LO) and (b is LO or a is LO) then u is C with 0.9
"""


@pytest.mark.parametrize("norm", ["min", "product", "einstein"])
@pytest.mark.parametrize("union", ["max", "bounded", "sum"])
def test_a_sum_in_parentheses_may_exceed_one(norm: str, union: str) -> None:
    """A rule of fewer operands than others was filled up with ones, and `min` cut it there."""
    read = parse(SUMS.format(norm=norm, union=union)).rulebase
    assert read is not None
    (block,) = read.blocks  # a text cannot say so: other programs' files can
    rulebase = dataclasses.replace(read, blocks=(dataclasses.replace(block, disjunction="sum"),))
    columns = {"a": [0.1, 0.9, 0.8, 0.3], "b": [0.2, 0.1, 0.9, 0.75]}
    assert assert_equal_engines(rulebase, columns) == "machine code"
    at_a_point = interpreted(rulebase)
    assert max(rule.strength for rule in explain(rulebase, a=0.9, b=0.1).rules) > 1.0
    assert compiled(rulebase)(a=0.9, b=0.1) == at_a_point.evaluate({"a": 0.9, "b": 0.1})


def test_a_hedge_without_a_value_above_one_silences_its_rule_alone() -> None:
    text = SUMS.format(norm="min", union="probor").replace("very (a", "seldom (a")
    read = parse(text).rulebase
    assert read is not None
    (block,) = read.blocks
    rulebase = dataclasses.replace(read, blocks=(dataclasses.replace(block, disjunction="sum"),))
    assert compiled(rulebase).reason == ""
    at = {"a": 0.9, "b": 0.1}
    assert infer(rulebase, at) == compiled(rulebase)(at) == interpreted(rulebase).point(at)


def test_antecedents_of_any_form_are_covered() -> None:
    text = """rulebase nested
input a 0 .. 1
input b 0 .. 1
input c 0 .. 1
output u 0 .. 6
terms a, b, c, u: triangles LO HI
inference no-rule 0, and product, or probor
rule if (a is LO or b is not HI) and c is very LO then u is HI
rule if somewhat (a is HI and (b is LO or c is HI)) then u is LO
rule if not (a is LO or b is LO) or c is LO and a is HI then u is HI
"""
    parsed = parse(text)
    assert parsed.rulebase is not None, [str(each) for each in parsed.diagnostics]
    fast, one = compiled(parsed.rulebase), interpreted(parsed.rulebase)
    assert fast.kernel == "machine code"
    axis = np.linspace(0.0, 1.0, 6)
    found = fast(a=axis[:, None, None], b=axis[:, None], c=axis)["u"]
    for index in np.ndindex(found.shape):
        point = dict(zip("abc", axis[list(index)].tolist(), strict=True))
        assert found[index] == pytest.approx(one.evaluate(point)["u"], abs=1e-13)
        assert fast(point)["u"] == found[index]


def norms_base(conjunction: str, disjunction: str, aggregation: str) -> RuleBase:
    """Rules with *and* and *or*, a weight and a threshold; two outputs of two kinds."""
    lines = (Term("low", Shape("ramp", (1.0, 0.0))), Term("high", Shape("ramp", (0.0, 1.0))))
    inputs = tuple(Input(name, 0.0, 1.0, lines) for name in ("a", "b", "c"))
    sets = (
        Term("small", Shape("triangle", (-1.0, 0.0, 2.0))),
        Term("big", Shape("gaussian", (4.0, 1.0))),
    )
    u = Output(
        "u", 0.0, 5.0, sets, aggregation=aggregation, no_rule=1.5,
        defuzzifier=Defuzzifier("centroid", 21, "midpoints"),
    )  # fmt: skip
    values = (
        Term("flat", Shape("singleton", (2.0,))),
        Term("slope", Shape("linear", (1.0, -2.0, 0.5, 3.0))),
    )
    v = Output(
        "v", -9.0, 9.0, values, aggregation=aggregation, no_rule=0.5,
        defuzzifier=Defuzzifier("weighted-average"),
    )  # fmt: skip
    rules = (
        Rule(And((Is("a", "high"), Is("b", "low"), Is("c", "high"))), (Consequent("u", "small"),)),
        Rule(
            Or((Is("a", "low"), Is("c", "low"))),
            (Consequent("u", "big"), Consequent("v", "flat")),
            weight=0.7,
        ),
        Rule(And((Is("a", "high"), Is("b", "high"))), (Consequent("v", "slope"),)),
        Rule(Is("b", "high", (Hedge("very"),)), (Consequent("v", "slope"),)),
        Rule(Is("c", "high", (Hedge("not"),)), (Consequent("u", "big"),)),
    )
    block = RuleBlock(
        rules, conjunction=conjunction, disjunction=disjunction, implication=conjunction,
        threshold=0.1,
    )  # fmt: skip
    return RuleBase("norms", inputs, (u, v), (block,))


@pytest.mark.parametrize(
    ("conjunction", "disjunction"), [(name, TNORMS[name].dual or "max") for name in CONJUNCTIONS]
)
def test_every_norm(conjunction: str, disjunction: str) -> None:
    axis = np.linspace(-0.1, 1.1, 13)
    for aggregation in DISJUNCTIONS:
        rulebase = norms_base(conjunction, disjunction, aggregation)
        fast = compiled(rulebase)
        assert fast.kernel == "machine code"
        grid = {"a": axis[:, None, None], "b": axis[:, None], "c": axis}
        found, expected = fast(grid), infer(rulebase, grid)
        for name in ("u", "v"):
            assert found[name].shape == (13, 13, 13)
            np.testing.assert_allclose(found[name], expected[name], rtol=1e-12, atol=1e-12)


def test_interpreted_kernel_has_the_same_bits(
    pd7: RuleBase, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = np.random.default_rng(5).uniform(-7.0, 7.0, (2, 60))
    cases = [pd7, norms_base("product", "probor", "sum")]
    machine = [compiled(each) for each in cases]
    monkeypatch.setenv("FUZZYARM_NATIVE", "0")
    plain = [compiled(each) for each in cases]
    assert [each.kernel for each in plain] == ["python", "python"]
    for one, other in zip(machine, plain, strict=True):
        names = [each.name for each in one.rulebase.inputs]
        given_ = dict(zip(names, (points[0], points[1], points[0][::-1]), strict=False))
        first, second = one(given_), other(given_)
        for name, values in first.items():
            np.testing.assert_array_equal(values, second[name])


@pytest.mark.parametrize("shape", [(), (1,), (7,), (3, 5), (2, 3, 4), (0,), (3, 0)])
def test_arrays_of_any_shape_and_precision(pd7: RuleBase, shape: tuple[int, ...]) -> None:
    fast = compiled(pd7)
    e = np.random.default_rng(0).uniform(-7, 7, shape)
    for values in (e, e.astype(np.float32), np.array(e, order="F")):
        found, expected = fast(e=values, ce=0.5)["u"], infer(pd7, e=values, ce=0.5)["u"]
        assert np.shape(found) == shape
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_plain_arrays_and_others_have_the_bits_of_points(pd7: RuleBase) -> None:
    e, ce = np.random.default_rng(9).uniform(-7, 7, (2, 120_000))  # on all processors
    fast = compiled(pd7)
    plain = fast(e=e, ce=ce)["u"]
    np.testing.assert_array_equal(plain, fast(e=e, ce=np.repeat(ce, 2)[::2])["u"])
    np.testing.assert_array_equal(
        plain.reshape(300, 400), fast(e=e.reshape(300, 400), ce=ce.reshape(300, 400))["u"]
    )
    each = [fast.at(*point)[0] for point in zip(e[:500].tolist(), ce[:500].tolist(), strict=True)]
    assert plain[:500].tolist() == each
    e[7] = math.nan
    with pytest.raises(NotANumberError):
        fast(e=e, ce=ce)


def test_more_points_than_a_chunk_and_views_with_steps(pd7: RuleBase) -> None:
    points = np.random.default_rng(7).uniform(-6, 6, (50_000, 2))
    found = compiled(pd7)(e=points[::2, 0], ce=points[::2, 1])["u"]
    expected = infer(pd7, e=points[::2, 0], ce=points[::2, 1])["u"]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_ways_of_calling(pd7: RuleBase) -> None:
    fast = compiled(pd7)
    wanted = infer(pd7, e=1.3, ce=-2.2)
    assert fast(e=1.3, ce=-2.2) == wanted
    assert fast(ce=-2.2, e=1.3) == wanted
    assert fast({"e": 1.3}, ce=-2.2) == wanted
    assert fast(1.3, -2.2) == wanted
    assert fast(e=np.float32(1.0), ce=-2) == infer(pd7, e=1.0, ce=-2.0)
    assert fast.at(1.3, -2.2) == (wanted["u"],)
    assert repr(fast) == "<compiled 'pd7', kernel machine code>"


@pytest.mark.parametrize(
    "inputs",
    [
        {"e": 1.0},
        {"e": 1.0, "ce": 2.0, "what": 3.0},
        {"e": 1.0, "ce": "two"},
        {"e": float("nan"), "ce": 0.0},
        {"e": np.array([1.0, np.nan]), "ce": 0.0},
        {"e": np.zeros(3), "ce": np.zeros(4)},
        {"e": np.array(["a"]), "ce": 0.0},
    ],
    ids=str,
)
def test_bad_inputs_are_the_errors_of_infer(pd7: RuleBase, inputs: dict[str, object]) -> None:
    with pytest.raises(InferenceError) as expected:
        infer(pd7, inputs)
    with pytest.raises(type(expected.value)) as found:
        compiled(pd7)(inputs)
    assert str(found.value) == str(expected.value)


def test_points_where_nothing_fires(pd7: RuleBase) -> None:
    block = dataclasses.replace(pd7.blocks[0], rules=pd7.blocks[0].rules[:1])
    sparse = dataclasses.replace(pd7, blocks=(block,))
    e = np.array([-6.0, 3.0, -5.0])
    with pytest.raises(NoRuleFiredError, match="e = 3"):
        compiled(sparse)(e=e, ce=-6.0)
    with pytest.raises(NoRuleFiredError, match="e = 3"):
        compiled(sparse)(e=3.0, ce=-6.0)
    output = dataclasses.replace(pd7.outputs[0], no_rule="hold")
    holding = compiled(dataclasses.replace(sparse, outputs=(output,)))
    assert holding(e=e, ce=-6.0, held={"u": 0.25})["u"][1] == 0.25
    assert holding(e=3.0, ce=-6.0, held={"u": 0.25}) == {"u": 0.25}


@pytest.mark.slow
def test_all_that_is_made_of_a_rule_base_belongs_to_one_object(pd7: RuleBase) -> None:
    own = dataclasses.replace(pd7)
    made = prepared(own)
    infer(own, e=1.0, ce=2.0)
    infer(own, e=np.zeros(3), ce=2.0)
    assert prepared(own) is made
    assert plan(own) is made.part(plan.__wrapped__)  # type: ignore[attr-defined]
    others = [dataclasses.replace(pd7) for _ in range(MOST)]
    for each in others:
        plan(each)
    gone = weakref.ref(made)
    del made
    gc.collect()
    assert gone() is None


@pytest.mark.skipif(not has_machine_code(), reason="no machine code was built")
def test_a_formula_that_is_met_again_has_the_address_that_it_had() -> None:
    text = (
        "rulebase r\ninput e 0 .. 1\noutput u 0 .. 9\nterms e: triangles A B\n"
        'term u A: formula "exp(-abs(x - {}))"\nterm u B: triangle 1 2 3\n'
        "inference u: defuzzifier bisector\n"
        "rule if e is A then u is A\nrule if e is B then u is B\n"
    )

    def met(number: float) -> float:
        rulebase = parse(text.format(number)).rulebase
        assert rulebase is not None
        return float(compiled(rulebase).at(0.25)[0])

    first = met(2.0)
    count = len(kernels._addresses)
    _row_function.cache_clear()  # as if many others had been met
    assert met(2.0) == first
    assert len(kernels._addresses) == count
    assert met(3.0) != first


def test_what_machine_code_does_not_cover_is_interpreted(pd7: RuleBase) -> None:
    way = Defuzzifier("mean-of-maximum")
    output = dataclasses.replace(pd7.outputs[0], defuzzifier=way, aggregation="sum")
    rulebase = dataclasses.replace(pd7, outputs=(output,))
    slow = compiled(rulebase)
    assert slow.kernel == "python"
    what = "the exact mean-of-maximum of 'u' under aggregation sum"
    assert repr(slow) == f"<compiled 'pd7', kernel python: {what}>"
    assert slow(e=1.3, ce=0.2) == infer(rulebase, e=1.3, ce=0.2)


def test_rules_too_many_to_index_by_all_inputs(
    pd7: RuleBase, monkeypatch: pytest.MonkeyPatch
) -> None:
    e, ce = np.random.default_rng(9).uniform(-6, 6, (2, 300))
    wanted = np.asarray(infer(pd7, e=e, ce=ce)["u"])
    for programs in (1, 6):
        monkeypatch.setattr("fuzzyarm.inference.layout.MOST_PROGRAMS", programs)
        assert compiled(pd7)(e=e[0], ce=ce[0])["u"] == pytest.approx(wanted[0], abs=1e-12)
        np.testing.assert_allclose(compiled(pd7)(e=e, ce=ce)["u"], wanted, rtol=0, atol=1e-12)


def test_threads_do_not_disturb_each_other(pd7: RuleBase) -> None:
    fast = compiled(pd7)
    values = np.random.default_rng(3).uniform(-6, 6, (400, 2)).tolist()
    wanted = [fast.at(*pair) for pair in values]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lambda pair: fast.at(*pair), values)) == wanted


@pytest.mark.parametrize("implication", ["min", "product"])
@pytest.mark.parametrize("strength", [0.0, 5e-324, 1e-300, 1e-35, 1e-17])
def test_a_rule_that_all_but_fails_hides_no_other(strength: float, implication: str) -> None:
    """Its set is above the foot of the other one, over a stretch that no float can resolve."""
    terms = small.terms(A=Shape("ramp", (1.0, 2.0)), B=Shape("triangle", (0.0, 1.0, 2.0)))
    rules = [small.rule("a high", "u A"), small.rule("b high", "u B")]
    rulebase = small.base(rules, terms, low=1.0, implication=implication)
    area, moment = 0.5 + 8.0, 0.5 * (1.0 + 2.0 / 3.0) + 8.0 * 6.0
    point = {"a": 1.0, "b": strength}
    for found in (compiled(rulebase)(point), infer(rulebase, point)):
        assert found["u"] == pytest.approx(moment / area, rel=1e-12)


@pytest.mark.parametrize("aggregation", ["max", "sum"])
@pytest.mark.parametrize("implication", ["min", "product"])
@pytest.mark.parametrize(
    "method", ["centroid", "centroid of samples", "bisector", "weighted-average"]
)
def test_the_kernel_needs_no_help_where_rules_fire(
    method: str, implication: str, aggregation: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What it cannot evaluate is asked once more, which would hide that it fails."""
    corners = ((0.0, 2.0, 8.0), (0.0, 4.0, 8.0), (0.0, 6.0, 8.0), (1.0, 5.0, 10.0))
    sets = small.terms(
        **{name: Shape("triangle", each) for name, each in zip("ABCD", corners, strict=True)}
    )
    rules = [small.rule(f"{name} high", f"u {name.upper()}") for name in "abcd"]
    rulebase = small.base(
        rules, sets, method.split(maxsplit=1)[0], names="abcd", implication=implication,
        aggregation=aggregation, resolution=101 if "samples" in method else None,
    )  # fmt: skip
    fast = compiled(rulebase)
    assert fast.kernel == "machine code"
    draw = np.random.default_rng(1)
    points = {name: draw.uniform(0.01, 1.0, 40) for name in "abcd"}
    wanted = interpreted(rulebase).evaluate(points)["u"]
    monkeypatch.setattr(Stage, "complete", None)
    np.testing.assert_allclose(fast(points)["u"], wanted, rtol=1e-12)
    for i in range(40):
        found = fast.named_point({name: float(column[i]) for name, column in points.items()})
        assert found is not None
        assert found["u"] == pytest.approx(wanted[i], rel=1e-12)


def test_terms_that_ignore_their_numbers_do_not_share_a_program_with_more_of_them() -> None:
    def under(hedges: str) -> RuleBase:
        text = (
            "rulebase r\ninput e -5 .. 5\noutput u -2 .. 2\nterm e A: s -5 -4.5\n"
            "term u N: triangle -2 -1 0\nterm u P: triangle 0 1 2\n"
            "inference implication product, aggregation sum\n"
            f"rule if e is {hedges} A then u is P\nrule if e is A then u is N\n"
        )
        rulebase = parse(text).rulebase
        assert rulebase is not None
        return rulebase

    for hedges in ("any power(0.5)", "power(0.5) any", "any", "any power(0.5)", "any"):
        rulebase = under(hedges)
        fast, one = compiled(rulebase), interpreted(rulebase)
        for x in (-4.75, -4.6, 0.0, 3.0):
            assert fast(e=x) == one.evaluate({"e": x}), (hedges, x)


@pytest.mark.slow
@pytest.mark.parametrize("kind", [*STRAIGHT, *SMOOTH])
@settings(deadline=None, max_examples=6)
@given(data=st.data())
def test_terms_of_every_shape_under_hedges(kind: str, data: st.DataObject) -> None:
    """The scalars are what compiled inference is held against: plain `infer` may be the same."""
    shape = data.draw(shapes(kind, -5.0, 5.0))
    modifiers = data.draw(hedge_lists)
    sets = tuple(
        Term(name, Shape("triangle", corners))
        for name, corners in (("N", (-2.0, -1.0, 0.0)), ("P", (0.0, 1.0, 2.0)))
    )
    rules = (
        Rule(Is("e", "A", modifiers), (Consequent("u", "P"),)),
        Rule(Is("e", "A"), (Consequent("u", "N"),)),
    )
    output = Output("u", -2.0, 2.0, sets, aggregation="sum", no_rule=0.25)
    rulebase = RuleBase(
        "r", (Input("e", -5.0, 5.0, (Term("A", shape),)),), (output,),
        (RuleBlock(rules, implication="product"),),
    )  # fmt: skip
    fast = compiled(rulebase)
    assert fast.kernel == "machine code"
    for x in np.linspace(-5.0, 5.0, 41).tolist():
        wanted = interpreted(rulebase).point({"e": x})["u"]
        assert fast(e=x)["u"] == pytest.approx(wanted, rel=1e-9, abs=1e-12)


def test_programs_that_are_taken_over_are_those_that_would_be_written(pd7: RuleBase) -> None:
    """Terms that move leave them as they are, as long as the same ones meet in the same cells."""
    exact = plan(pd7)
    sampled = plan(
        dataclasses.replace(
            pd7,
            outputs=tuple(
                dataclasses.replace(each, defuzzifier=Defuzzifier("centroid", 31, "midpoints"))
                for each in pd7.outputs
            ),
        )
    )
    for made in (exact, sampled):
        design = Design(made.rulebase)
        points = np.random.default_rng(4).random((6, len(design.start)))
        moved = [plan(design.at(point).rulebases[pd7.name]) for point in [design.start, *points]]
        layout._programs.clear()
        taken = [lay_out(each) for each in moved]
        assert len(layout._programs) <= 4  # a peak that a slope misses has a cell of its own
        for each, found in zip(moved, taken, strict=True):
            layout._programs.clear()
            assert lay_out(each) == found


ENDLESS = """
rulebase endless
input x -inf .. inf
input y -1 .. 1
output u 0 .. 1
terms y: triangles low high
term x left:  sigmoid 0 -1
term x right: sigmoid 0 1
term x near:  triangle -1 0 1
terms u: triangles small large
rule if x is left and y is low then u is small
rule if x is right or y is high then u is large
rule if x is near then u is small
"""


def test_infinite_values_of_an_endless_input_lie_in_no_cell() -> None:
    rulebase = parse(ENDLESS).rulebase
    assert rulebase is not None
    fast = compiled(rulebase)
    assert fast.kernel in {"machine code", "python"}
    x = np.array([-math.inf, -1e300, -2.0, 0.5, 2.0, 1e300, math.inf])
    for y in (-1.0, 0.25):
        expected = [infer(rulebase, x=value, y=y)["u"] for value in x]
        assert fast(x=x, y=np.full(7, y))["u"].tolist() == expected
        assert [fast(x=value, y=y)["u"] for value in x] == expected


def test_an_input_with_one_edge_has_a_bucket_on_either_side():
    for edge in (0.0, 0.5, -3.0, 1e12, 1e-300):
        first, scale, starts = _buckets([-math.inf, edge, math.inf])
        below, above = math.nextafter(edge, -math.inf), math.nextafter(edge, math.inf)
        for x in (-1e300, -1e13, below, edge, above, 1e13, 1e300):
            bucket = int(bucket_of(x, first, scale, len(starts) - 1.0))
            # Rounding may lead next to an edge into the other one, from where a step is taken.
            assert starts[bucket] == (x >= edge) or x in {below, above}


@pytest.mark.parametrize("size", [1, 511, 512, 513, 8192, 8193])
def test_blocks_of_any_room_give_the_bits_of_single_points(pd7: RuleBase, size: int) -> None:
    fast = compiled(dataclasses.replace(pd7))
    e, ce = np.random.default_rng(size).uniform(-7.0, 7.0, (2, size))
    for columns in ((e, ce), (e.astype(np.float32), ce), (e[::-1], ce)):  # as they are, or copied
        found = fast(*columns)["u"]
        wanted = [fast.at(float(x), float(y))[0] for x, y in zip(*columns, strict=True)]
        np.testing.assert_array_equal(found, wanted)


def test_a_point_function_outlives_its_rule_base() -> None:
    """The interpreted kernel finds plain Python by its number, as long as somebody may call it."""
    text = """rulebase searched
input a 0 .. 1
output y 0 .. 1
term a L: gaussian 0.3 0.2
term y H: gaussian 0.5 0.2
term y K: triangle 0 0.2 1
inference and product, implication product, aggregation probor, defuzzifier mean-of-maximum exact
rule if a is L then y is H
rule if a is L then y is K
"""
    rulebase = parse(text).rulebase
    assert rulebase is not None
    at = compiled(rulebase).at
    assert at(0.3) == compiled(rulebase).at(0.3)


@pytest.mark.parametrize("interpreted", [False, True])
@pytest.mark.parametrize("e", [0.3, 0.5, 7, "0.3", math.nan, [0.1, 0.5]])
def test_a_call_by_position_or_by_name_or_in_one_is_the_same(
    gap: RuleBase, interpreted: bool, e: Any
) -> None:
    fast = Compiled(gap, interpreted=interpreted)
    found = [outcome_of(fast, *given, **named) for given, named in (((e,), {}), ((), {"e": e}))]
    found += [outcome_of(fast, {"e": e}), outcome_of(infer, gap, e=e)]
    assert all(str(each) == str(found[0]) for each in found)


@pytest.mark.parametrize("interpreted", [False, True])
def test_a_point_in_order_takes_numbers_only(gap: RuleBase, interpreted: bool) -> None:
    fast = Compiled(gap, interpreted=interpreted)
    assert fast.at(0.25) == fast.at(np.float32(0.25))
    for value in ([0.1, 0.3], np.array([0.1, 0.3]), {"e": 0.3}, "0.3"):
        with pytest.raises(NotANumberError):
            fast.at(value)


def outcome_of(function: Callable[..., Any], *given: Any, **named: Any) -> Any:
    """Return a result, or the error."""
    try:
        return function(*given, **named)
    except (InferenceError, NoRuleFiredError) as error:
        return error


@pytest.fixture
def gap() -> RuleBase:
    text = """rulebase gap
input e 0 .. 1
output y 0 .. 1
term e L: triangle 0 0.2 0.4
term y ON: singleton 0.7
inference defuzzifier weighted-average, no-rule error
rule if e is L then y is ON
"""
    rulebase = parse(text).rulebase
    assert rulebase is not None
    return rulebase


def test_an_output_without_a_value_leaves_others_theirs_over_arrays() -> None:
    """Where no machine code is built: that two outputs are silent at different points."""
    text = """rulebase two
input e 0 .. 1
output a 0 .. 1
output b 0 .. 1
term e L: triangle 0 0.2 0.4
term e H: triangle 0.6 0.8 1
terms a, b: singletons ON
inference defuzzifier weighted-average, no-rule nan
rule if e is L then a is ON
rule if e is H then b is ON
"""
    rulebase = parse(text).rulebase
    assert rulebase is not None
    points = {"e": np.array([0.2, 0.5, 0.8])}
    found = interpreted(rulebase).evaluate(points)
    assert found.keys() == {"a", "b"}
    for name, values in compiled(rulebase).evaluate(points).items():
        np.testing.assert_array_equal(found[name], values)
    assert np.isnan(found["a"]).tolist() == [False, True, True]
    assert np.isnan(found["b"]).tolist() == [True, True, False]
