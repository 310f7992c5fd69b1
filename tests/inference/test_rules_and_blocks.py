"""Takagi–Sugeno consequents, several blocks and outputs, no rule, bad input."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.inference import (
    CyclicRulesError,
    InferenceError,
    MissingInputError,
    NoRuleFiredError,
    NotANumberError,
    NothingHeldError,
    OutsideRangeError,
    UnknownNameError,
    compiled,
    explain,
    infer,
)
from fuzzyarm.language.model.rulebase import (
    And,
    Defuzzifier,
    Hedge,
    Is,
    Or,
    Output,
    RuleBase,
    RuleBlock,
    Shape,
)
from fuzzyarm.symbolic.formulas import FormulaError
from tests.inference.small import base, inputs, rule, terms

HILL = terms(hill=Shape("triangle", (0.0, 5.0, 10.0)))
LINES = terms(
    left=Shape("linear", (2.0, -1.0, 0.5)), right=Shape("formula", formula="a * b + sin(a)")
)


def test_linear_and_formula_consequents() -> None:
    rules = [rule("a high", "u left"), rule("b high", "u right")]
    rulebase = base(rules, LINES, "weighted-average", outside="extend")
    a, b = 0.5, 0.25
    left, right = 2 * a - b + 0.5, a * b + math.sin(a)
    assert infer(rulebase, a=a, b=b)["u"] == pytest.approx((a * left + b * right) / (a + b))
    grid = infer(rulebase, a=np.array([[0.5], [1.0]]), b=np.array([0.25, 0.5, 0.75]))["u"]
    assert grid.shape == (2, 3)
    assert grid[0, 0] == pytest.approx((a * left + b * right) / (a + b))


def test_a_formula_without_a_value_where_its_rule_is_silent() -> None:
    outputs = terms(left=Shape("formula", formula="1 / a"), right=Shape("singleton", (3.0,)))
    rulebase = base(
        [rule("a high", "u left"), rule("b high", "u right")], outputs, "weighted-average"
    )
    assert infer(rulebase, a=0.0, b=0.5)["u"] == 3.0
    assert infer(rulebase, a=np.array([0.0]), b=0.5)["u"][0] == 3.0


def test_a_formula_without_a_value_is_an_error() -> None:
    outputs = terms(left=Shape("formula", formula="sqrt(a - 2)"))
    rulebase = base([rule("a high", "u left")], outputs, "weighted-average")
    for a in (0.5, np.array([0.5])):
        with pytest.raises(NotANumberError, match=r"'u' has none at a = 0\.5"):
            infer(rulebase, a=a, b=0.0)


@pytest.mark.parametrize(
    ("shape", "error", "text"),
    [
        (Shape("linear", (1.0, 2.0)), InferenceError, "needs 3 numbers"),
        (Shape("formula", formula="a + nope"), UnknownNameError, "no variable 'nope'"),
        (Shape("formula", formula="a +"), FormulaError, "formula ends"),
    ],
)
def test_consequents_at_fault(shape: Shape, error: type[Exception], text: str) -> None:
    rulebase = base([rule("a high", "u left")], terms(left=shape), "weighted-average")
    with pytest.raises(error, match=text):
        infer(rulebase, a=0.5, b=0.5)


# ── several outputs and blocks ───────────────────────────────────────────────────────


def chained(*blocks: RuleBlock) -> RuleBase:
    spikes = terms(small=Shape("singleton", (0.0,)), big=Shape("singleton", (1.0,)))
    slopes = terms(small=Shape("ramp", (1.0, 0.0)), big=Shape("ramp", (0.0, 1.0)))
    average = Defuzzifier("weighted-average")
    return RuleBase(
        "chained",
        inputs("a"),
        (
            Output("mid", 0.0, 1.0, slopes, defuzzifier=Defuzzifier("tsukamoto"), no_rule=0.25),
            Output("u", 0.0, 1.0, spikes, defuzzifier=average, no_rule=0.0),
        ),
        blocks,
    )


FIRST = RuleBlock((rule("a high", "mid big"),), "first")
SECOND = RuleBlock((rule("mid big", "u big"), rule("mid small", "u small")), "second")


@pytest.mark.parametrize("a", [0.3, 0.0])
def test_a_later_block_uses_the_value_of_an_earlier_output(a: float) -> None:
    # Tsukamoto of one ramp: mid is a (0.25 where no rule fires); u is then mid.
    expected = a or 0.25
    result = infer(chained(FIRST, SECOND), a=a)
    assert result["mid"] == pytest.approx(expected)
    assert result["u"] == pytest.approx(expected)
    arrays = infer(chained(FIRST, SECOND), a=np.array([a, 1.0]))
    np.testing.assert_allclose(arrays["u"], [expected, 1.0])


def test_within_a_block_an_output_counts_by_how_far_it_is_asserted() -> None:
    rules = (*SECOND.rules, *FIRST.rules, rule("a low", "mid small"))
    result = infer(chained(RuleBlock(rules)), a=0.3)
    # mid is big with 0.3 and small with 0.7: u is (0.3 × 1 + 0.7 × 0) / 1.
    assert result["u"] == pytest.approx(0.3)
    assert infer(chained(RuleBlock(rules)), a=np.array([0.3]))["u"][0] == pytest.approx(0.3)


def test_cycles_are_errors() -> None:
    with pytest.raises(CyclicRulesError, match="before all rules that conclude it") as caught:
        infer(chained(SECOND, FIRST), a=0.3)
    assert caught.value.names == ("mid",)
    circle = RuleBlock((rule("mid big", "u big"), rule("u big", "mid big")))
    with pytest.raises(CyclicRulesError, match="in a circle"):
        infer(chained(circle), a=0.3)


def test_one_rule_with_two_consequents() -> None:
    block = RuleBlock((rule("a high", "mid big", "u big"), rule("a low", "u small")))
    result = infer(chained(block), a=0.6)
    assert result == {"mid": pytest.approx(0.6), "u": pytest.approx(0.6)}


def test_norms_weights_and_hedges_of_antecedents() -> None:
    both = And((Is("a", "high"), Is("b", "high", (Hedge("not"), Hedge("very")))))
    either = Or((Is("a", "high"), Is("b", "high")))
    spikes = terms(left=Shape("singleton", (0.0,)), right=Shape("singleton", (1.0,)))
    made = base(
        [rule(both, "u left", weight=0.5), rule(either, "u right")], spikes, "weighted-average"
    )
    block = dataclasses.replace(made.blocks[0], conjunction="product", disjunction="probor")
    rulebase = dataclasses.replace(made, blocks=(block,))
    a, b = 0.5, 0.4
    left, right = 0.5 * a * (1 - b**2), a + b - a * b
    assert infer(rulebase, a=a, b=b)["u"] == pytest.approx(right / (left + right))


def test_a_threshold_silences_weak_rules() -> None:
    made = base([rule("a high", "u hill")], HILL, names=["a"], no_rule=-1.0, outside="extend")
    block = dataclasses.replace(made.blocks[0], threshold=0.25)
    rulebase = dataclasses.replace(made, blocks=(block,))
    assert infer(rulebase, a=0.25)["u"] == -1.0
    assert infer(rulebase, a=0.26)["u"] == pytest.approx(5.0)
    np.testing.assert_allclose(infer(rulebase, a=np.array([0.25, 0.26]))["u"], [-1.0, 5.0])
    assert compiled(rulebase)(a=0.25)["u"] == -1.0
    assert [explain(rulebase, a=a).rules[0].strength for a in (0.25, 0.26)] == [0.0, 0.26]


# ── no rule ──────────────────────────────────────────────────────────────────────────


def silent(no_rule: float | str) -> RuleBase:
    return base([rule("a high", "u hill")], HILL, no_rule=no_rule)


def test_no_rule_is_an_error_with_the_point() -> None:
    for a in (0.0, np.array([1.0, 0.0])):
        with pytest.raises(NoRuleFiredError, match=r"'u' at a = 0, b = 0\.25") as caught:
            infer(silent("error"), a=a, b=0.25)
        assert caught.value.output == "u"
        assert caught.value.inputs == {"a": 0.0, "b": 0.25}


def test_no_rule_gives_the_stated_number() -> None:
    assert infer(silent(7.5), a=0.0, b=0.0)["u"] == 7.5
    np.testing.assert_allclose(infer(silent(7.5), a=np.array([0.0, 1.0]), b=0.0)["u"], [7.5, 5.0])


def test_hold_keeps_what_the_caller_passes() -> None:
    assert infer(silent("hold"), a=0.0, b=0.0, held={"u": 3.25})["u"] == 3.25
    assert infer(silent("hold"), a=1.0, b=0.0)["u"] == pytest.approx(5.0)
    for a in (0.0, np.array([0.0])):
        with pytest.raises(NothingHeldError, match="pass held="):
            infer(silent("hold"), a=a, b=0.0)
    with pytest.raises(UnknownNameError, match="no output 'v'"):
        infer(silent("hold"), a=0.0, b=0.0, held={"v": 3.25})


def test_a_rule_whose_set_lies_outside_the_range_concludes_nothing() -> None:
    beyond = terms(hill=Shape("triangle", (20.0, 25.0, 30.0)))
    rulebase = base([rule("a high", "u hill")], beyond, no_rule=1.0)
    assert infer(rulebase, a=1.0, b=0.0)["u"] == 1.0
    assert infer(rulebase, a=np.array([1.0]), b=0.0)["u"][0] == 1.0


def test_an_output_without_rules() -> None:
    rulebase = base([rule("a high", "u hill")], HILL, no_rule=2.0)
    rulebase = dataclasses.replace(rulebase, blocks=())
    assert infer(rulebase, a=1.0, b=0.0) == {"u": 2.0}
    np.testing.assert_array_equal(infer(rulebase, a=np.ones(3), b=0.0)["u"], [2.0, 2.0, 2.0])


# ── input ────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("value", [math.nan, np.array([0.5, np.nan])])
def test_nan_is_refused_by_name(value: float | np.ndarray) -> None:
    with pytest.raises(NotANumberError, match="'b'") as caught:
        infer(silent(0.0), a=0.5, b=value)
    assert caught.value.name == "b"


def test_names_at_fault() -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'alpha'"):
        infer(dataclasses.replace(silent(0.0), inputs=inputs("alpha", "a")), alpa=1.0, a=1.0)
    with pytest.raises(UnknownNameError, match="there are: a, b"):
        infer(silent(0.0), a=1.0, b=1.0, zzz=np.ones(2))
    for value in (0.5, np.ones(2)):
        with pytest.raises(MissingInputError, match="no value for input b"):
            infer(silent(0.0), a=value)
    with pytest.raises(InferenceError, match="'a' is given twice"):
        infer(silent(0.0), {"a": 1.0}, a=1.0, b=1.0)
    for ask in (infer, explain):
        with pytest.raises(
            InferenceError, match=r"inputs are given by name .*, not as int"
        ) as error:
            ask(silent(0.0), 3)
        assert error.value.hint == "write a=3, b=…"


@pytest.mark.parametrize("value", ["much", None, [1.0, "x"], object()])
def test_what_is_no_number_is_refused(value: object) -> None:
    with pytest.raises(NotANumberError, match="'a'"):
        infer(silent(0.0), a=value, b=0.5)


def test_shapes_that_do_not_fit() -> None:
    with pytest.raises(InferenceError, match=r"does not fit the others: a \(2,\), b \(3,\)"):
        infer(silent(0.0), a=np.ones(2), b=np.ones(3))


def test_outside_the_range() -> None:
    def with_outside(outside: str) -> RuleBase:
        made = base([rule("a high", "u left")], LINES[:1], "weighted-average", outside="extend")
        return dataclasses.replace(
            made, inputs=tuple(dataclasses.replace(v, outside=outside) for v in made.inputs)
        )

    for a in (3.0, np.array([3.0])):
        assert infer(with_outside("clamp"), a=a, b=0.0)["u"] == pytest.approx(2.5)
        assert infer(with_outside("extend"), a=a, b=0.0)["u"] == pytest.approx(6.5)
        with pytest.raises(OutsideRangeError, match=r"a = 3 lies outside its range 0 \.\. 1"):
            infer(with_outside("error"), a=a, b=0.0)
    assert infer(with_outside("clamp"), a=math.inf, b=-math.inf)["u"] == pytest.approx(2.5)
    for a in (math.inf, np.array([np.inf])):
        with pytest.raises(NotANumberError, match="infinite"):
            infer(with_outside("extend"), a=a, b=0.0)


def test_outside_of_an_output_says_what_happens_to_its_value() -> None:
    def with_outside(outside: str) -> RuleBase:
        spike = terms(far=Shape("singleton", (12.0,)))
        return base([rule("a high", "u far")], spike, "weighted-average", outside=outside)

    for a in (0.5, np.array([0.5])):
        assert infer(with_outside("clamp"), a=a, b=0.0)["u"] == 10.0
        assert infer(with_outside("extend"), a=a, b=0.0)["u"] == 12.0
        with pytest.raises(OutsideRangeError, match="u = 12 lies outside"):
            infer(with_outside("error"), a=a, b=0.0)


@pytest.mark.parametrize(
    ("made", "text"),
    [
        (rule("a hihg", "u hill"), "no term of 'a' 'hihg'.*did you mean 'high'"),
        (rule("q high", "u hill"), "no variable 'q'"),
        (rule("a high", "u hil"), "did you mean 'hill'"),
        (rule("a high", "b high"), "concludes 'b', which is an input"),
    ],
)
def test_models_at_fault(made: object, text: str) -> None:
    with pytest.raises(InferenceError, match=text):
        infer(base([made], HILL), a=0.5, b=0.5)  # type: ignore[list-item]


def test_a_variable_twice_and_an_empty_range() -> None:
    twice = dataclasses.replace(silent(0.0), inputs=inputs("a", "a"))
    with pytest.raises(InferenceError, match="two variables called 'a'"):
        infer(twice, a=0.5)
    with pytest.raises(RuleBaseError, match="range of 'u' must go from a lower to a higher"):
        base([rule("a high", "u hill")], HILL, low=1.0, high=1.0)


@pytest.mark.parametrize("method", ["weighted-average", "weighted-sum"])
def test_blocks_that_differ_in_the_implication_share_the_strength_of_a_number(method: str) -> None:
    outputs = terms(left=Shape("singleton", (1.0,)), right=Shape("triangle", (4.0, 5.0, 6.0)))
    first = RuleBlock((rule("a high", "u left", "u right"),), "first", implication="min")
    second = RuleBlock((rule("b high", "u left"),), "second", implication="product")
    rulebase = dataclasses.replace(base([], outputs, method), blocks=(first, second))
    a, b = 0.25, 0.75
    weighted = (a + b) * 1.0 + a * 5.0
    expected = weighted if method == "weighted-sum" else weighted / (a + b + a)
    assert infer(rulebase, a=a, b=b)["u"] == pytest.approx(expected, abs=1e-15)
    assert infer(rulebase, a=np.array([a]), b=b)["u"][0] == pytest.approx(expected, abs=1e-15)
    assert compiled(rulebase)(a=np.array([a]), b=b)["u"][0] == pytest.approx(expected, abs=1e-15)
