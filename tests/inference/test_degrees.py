"""Degrees are 0 to 1 exactly, and the same in every engine, next to 0 and 1 too."""

from __future__ import annotations

import math
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from budget import cases
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzyarm.exchange.export import routines_of
from fuzzyarm.inference import (
    InferenceError,
    NoRuleFiredError,
    compiled,
    infer,
    output_layout,
    quadrature,
)
from fuzzyarm.inference.sets import degrees, term_function
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Expression,
    Hedge,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.language.model.shapes import corner_points, straight_lines
from fuzzyarm.symbolic.kinds import HEDGES, SNORMS, TNORMS
from tests.export.c_programs import run_c
from tests.inference.small import inputs
from tests.interpreted import interpreted
from tests.strategies import (
    SMOOTH,
    STRAIGHT,
    few_hedges,
    input_points,
    plain_mamdani,
    rulebases,
    shapes,
)

NEAR = (
    0.0, 5e-324, 2.0**-1022, 1e-300, 2.0**-53, 0.25, 0.5 - 2.0**-54, 0.5, 0.5 + 2.0**-53,
    1.0 - 2.0**-51, 1.0 - 2.0**-52, 1.0 - 2.0**-53, 1.0,
)  # fmt: skip
SILENT = -1.0

slow_draws = settings(
    deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large]
)


def strengths_base() -> RuleBase:
    """Every norm of a and b, and every hedge of a: an output each, whose value is the strength."""
    a, b = Is("a", "high"), Is("b", "high")
    rules: dict[str, tuple[Expression, dict[str, str]]] = {}
    for name in TNORMS:
        rules[f"t_{name}"] = And((a, b)), {"conjunction": name}
    for name, kind in SNORMS.items():
        if not kind.aggregates:
            rules[f"s_{name}"] = Or((a, b)), {"disjunction": name}
    for name in HEDGES:
        if name != "power":
            rules[f"h_{name}"] = Is("a", "high", (Hedge(name),)), {}
    for word, exponent in (("05", 0.5), ("03", 0.3), ("25", 2.5)):
        rules[f"h_power_{word}"] = Is("a", "high", (Hedge("power", exponent),)), {}
    one = (Term("one", Shape("singleton", (1.0,))),)
    way = Defuzzifier("weighted-sum")
    return RuleBase(
        "strengths",
        inputs("a", "b"),
        tuple(
            Output(name, -1.0, 2.0, one, defuzzifier=way, no_rule=SILENT, outside="extend")
            for name in rules
        ),
        tuple(
            RuleBlock((Rule(antecedent, (Consequent(name, "one"),)),), name, **norms)
            for name, (antecedent, norms) in rules.items()
        ),
    )


def pairs(count: int) -> np.ndarray:
    """All pairs of the numbers near the ends, and of random bits."""
    rng = np.random.default_rng(3)
    bits = rng.integers(0, np.float64(1.0).view(np.int64), count).view(np.float64)
    near_one = 1.0 - rng.random(count) * 2.0 ** -rng.integers(1, 53, count)
    return np.array(list(product([*NEAR, *bits, *near_one, *rng.random(count)], repeat=2))).T


def same(what: str, found: dict[str, np.ndarray], wanted: dict[str, np.ndarray]) -> None:
    for name, value in wanted.items():
        there = np.asarray(found[name])
        fires = there != SILENT
        np.testing.assert_array_equal(fires, value != SILENT, err_msg=f"{what} {name}")
        assert ((there[fires] > 0.0) & (there[fires] <= 1.0)).all(), (what, name)
        np.testing.assert_array_equal(there, value, err_msg=f"{what} {name}")


@pytest.mark.slow
def test_every_norm_and_hedge_gives_degrees_alike_in_every_engine(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rulebase, (a, b) = strengths_base(), pairs(12)
    one = interpreted(rulebase)
    rows = [one.evaluate({"a": x, "b": y}) for x, y in zip(a.tolist(), b.tolist(), strict=True)]
    wanted = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    same("scalars", wanted, wanted)
    same("arrays", interpreted(rulebase).evaluate({"a": a, "b": b}), wanted)
    fast = compiled(rulebase)
    assert fast.kernel == "machine code"
    same("machine code", fast(a=a, b=b), wanted)
    some = slice(0, None, 17)
    monkeypatch.setenv("FUZZYARM_NATIVE", "0")
    few = {name: value[some] for name, value in wanted.items()}
    same("interpreted kernel", compiled(rulebase)(a=a[some], b=b[some]), few)


@pytest.mark.slow
def test_every_norm_and_hedge_gives_degrees_in_c(tmp_path: Path) -> None:
    rulebase, (a, b) = strengths_base(), pairs(12)
    names = [each.name for each in rulebase.outputs]
    routines = [routines_of(rulebase, output=each, precision="float64")[0] for each in names]
    found = run_c(routines, [(a, b)] * len(routines), tmp_path)
    same(
        "C", dict(zip(names, found, strict=True)), interpreted(rulebase).evaluate({"a": a, "b": b})
    )


@pytest.mark.slow
@settings(slow_draws, max_examples=cases(100, 300))
@given(st.data())
def test_terms_give_degrees_next_to_their_corners(data: st.DataObject) -> None:
    kind = data.draw(st.sampled_from(STRAIGHT + SMOOTH))
    shape, hedges = data.draw(shapes(kind, -6.0, 6.0)), data.draw(few_hedges)
    corners = [x for x in corner_points(shape) if math.isfinite(x)]
    near = [math.nextafter(x, side) for x in corners for side in (-math.inf, math.inf)]
    xs = np.array([*corners, *near, *np.linspace(-7.0, 7.0, 9)])
    function, lines = term_function(shape, hedges), straight_lines(shape, hedges)
    one = np.array([function(x) for x in xs.tolist()])
    many = degrees(shape, xs, hedges)
    assert ((one >= 0.0) & (one <= 1.0)).all()
    if lines is not None:
        np.testing.assert_array_equal([lines.at(x) for x in xs.tolist()], one)
    np.testing.assert_array_equal(many, one)


@pytest.mark.parametrize("x", [0.06249999999999999, math.nextafter(0.0625, 0.0)])
def test_a_line_is_above_zero_up_to_its_foot(x: float) -> None:
    shape = Shape("points", (-0.116, 1.0, 0.0625, 0.0))
    assert term_function(shape)(x) > 0.0
    assert degrees(shape, np.array([x]))[0] == term_function(shape)(x)


def test_a_hyperbola_ends_at_one() -> None:
    assert term_function(Shape("concave", (58.88, 0.16)))(0.16000000000000003) == 1.0


@pytest.mark.slow
@settings(slow_draws, max_examples=cases(20, 100))
@given(st.data())
def test_a_value_does_not_depend_on_the_other_points(data: st.DataObject) -> None:
    rulebase = data.draw(st.one_of(rulebases(), plain_mamdani(kinds=STRAIGHT + SMOOTH)))
    points = {k: np.array(v) for k, v in data.draw(input_points(rulebase, 5)).items()}
    held = {each.name: 0.5 * (each.low + each.high) for each in rulebase.outputs}
    fast = compiled(rulebase)
    for engine in (
        lambda given: interpreted(rulebase).evaluate(given, held),
        lambda x: fast(x, held=held),
    ):
        try:
            whole = engine(points)
        except (InferenceError, NoRuleFiredError):
            continue
        for i in range(5):
            alone = engine({name: column[i : i + 1] for name, column in points.items()})
            for name, column in whole.items():
                np.testing.assert_array_equal(alone[name], column[i : i + 1])


@pytest.mark.parametrize("budget", [3, 40, 41, 333])
@pytest.mark.parametrize("method", ["centroid", "bisector"])
def test_a_hard_integral_costs_its_own_point_only(
    method: str, budget: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where panels run out, all engines take the same ones as they are; others keep theirs."""
    for module in (quadrature, output_layout):
        monkeypatch.setattr(module, "MOST_PANELS", budget)
    terms = (Term("A", Shape("gaussian", (4.0, 1.0))), Term("B", Shape("formula", formula=NOISE)))
    output = Output("u", 0.0, 10.0, terms, defuzzifier=Defuzzifier(method))
    block = RuleBlock((
        Rule(Is("a", "high"), (Consequent("u", "A"),)),
        Rule(Is("b", "high"), (Consequent("u", "B"),)),
    ))  # fmt: skip
    rulebase = RuleBase("hard", inputs("a", "b"), (output,), (block,))
    a, b = np.array([0.7, 0.7, 0.0]), np.array([0.0, 0.9, 0.5])
    whole = interpreted(rulebase).evaluate({"a": a, "b": b})["u"]
    kernel = compiled(rulebase)
    assert not kernel.reason
    for i in range(3):
        alone = interpreted(rulebase).evaluate({"a": a[i : i + 1], "b": b[i : i + 1]})["u"]
        here = {"a": a[i].item(), "b": b[i].item()}
        assert alone[0] == whole[i] == infer(rulebase, here)["u"] == kernel(here)["u"]


NOISE = "0.5 + 0.5 * sin(300 * x)"


def test_a_sum_of_assertions_is_a_degree() -> None:
    """Within a block an output counts by how far it is asserted: by 1 at most."""
    sets = (Term("A", Shape("triangle", (0.0, 1.0, 2.0))),)
    u = Output("u", 0.0, 2.0, sets, aggregation="sum")
    v = Output(
        "v", 0.0, 2.0, (Term("one", Shape("singleton", (1.0,))),),
        defuzzifier=Defuzzifier("weighted-sum"), no_rule=SILENT, outside="extend",
    )  # fmt: skip
    for hedges, wanted in (((), 1.0), ((Hedge("not"),), SILENT), ((Hedge("seldom"),), 1.0)):
        block = RuleBlock((
            Rule(Is("a", "high"), (Consequent("u", "A"),)),
            Rule(Is("b", "high"), (Consequent("u", "A"),)),
            Rule(Is("u", "A", hedges), (Consequent("v", "one"),)),
        ))  # fmt: skip
        rulebase = RuleBase("asserted", inputs("a", "b"), (u, v), (block,))
        point = {"a": 0.9, "b": 0.8}
        assert interpreted(rulebase).point(point)["v"] == wanted
        found = interpreted(rulebase).evaluate({k: np.array([x]) for k, x in point.items()})
        assert found["v"][0] == wanted
