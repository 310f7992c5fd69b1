from __future__ import annotations

import dataclasses
import json

import pytest
from budget import cases
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzyarm.base.diagnostic import Severity, Span
from fuzzyarm.inference import InferenceError, NoRuleFiredError, check_expectations, explain, infer
from fuzzyarm.language.model.rulebase import Expectation, Outcome, RuleBase, Shape
from tests.inference.small import base, rule, terms
from tests.strategies import input_points, rulebases


def test_the_trace_of_one_inference(pd7: RuleBase) -> None:
    trace = explain(pd7, e=1.3, ce=-2.2)
    degrees = dict(trace.inputs[0].degrees)
    assert degrees["ZE"] == pytest.approx(0.35)
    assert degrees["PS"] == pytest.approx(0.65)
    assert degrees["NB"] == 0.0
    fired = trace.fired
    assert [round(each.strength, 12) for each in fired] == [0.65, 0.35, 0.1, 0.1]
    assert fired[0].text == "if e is PS and ce is NS then u is ZE"
    assert fired[0].number == 4 * 7 + 2 + 1
    assert fired[0].line == pd7.rules[4 * 7 + 2].span.line > 1
    output = trace.outputs[0]
    assert {each.term for each in output.consequents} == {"ZE", "NS", "NM"}
    assert output.value == infer(pd7, e=1.3, ce=-2.2)["u"]
    assert output.fired
    assert max(y for _, y in output.aggregate) == pytest.approx(0.65)


def test_the_clipped_set_has_its_corners() -> None:
    hill = terms(hill=Shape("triangle", (0.0, 5.0, 10.0)))
    trace = explain(base([rule("a high", "u hill")], hill, names=["a"]), a=0.5)
    corners = [(0.0, 0.0), (2.5, 0.5), (5.0, 0.5), (7.5, 0.5), (10.0, 0.0)]
    assert trace.outputs[0].consequents[0].curve == tuple(corners)


def test_a_trace_says_what_was_given_and_what_was_used(pd7: RuleBase) -> None:
    trace = explain(pd7, {"e": 9.0}, ce=0.0)
    assert (trace.inputs[0].given, trace.inputs[0].value) == (9.0, 6.0)


def test_a_trace_without_a_rule() -> None:
    hill = terms(hill=Shape("triangle", (0.0, 5.0, 10.0)))
    trace = explain(base([rule("a high", "u hill")], hill, names=["a"], no_rule=4.0), a=0.0)
    assert not trace.outputs[0].fired
    assert trace.outputs[0].value == 4.0
    assert trace.outputs[0].consequents == ()


@pytest.mark.slow
@settings(
    max_examples=cases(13, 40),
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(st.data())
def test_a_trace_agrees_with_infer_and_is_json(data: st.DataObject) -> None:
    rulebase = data.draw(rulebases())
    point = {k: v[0] for k, v in data.draw(input_points(rulebase, 1)).items()}
    held = {each.name: each.low for each in rulebase.outputs}
    try:
        values = infer(rulebase, point, held=held)
    except (InferenceError, NoRuleFiredError) as error:
        with pytest.raises(type(error)):
            explain(rulebase, point, held=held)
        return
    trace = explain(rulebase, point, held=held)
    assert {each.name: each.value for each in trace.outputs} == values
    assert len(trace.rules) == len(rulebase.rules)
    written = json.loads(json.dumps(trace.to_dict(), allow_nan=False))
    assert written["outputs"][0]["value"] == trace.outputs[0].value
    for output in trace.outputs:
        for _, y in output.aggregate:
            assert y >= 0.0


# ── expectations ─────────────────────────────────────────────────────────────────────

AT_ZERO = (("e", 0.0), ("ce", 0.0))


def expecting(pd7: RuleBase, *outcomes: Outcome, at: object = AT_ZERO) -> RuleBase:
    expectation = Expectation(at, outcomes, Span(7, 1, 7, 20))  # type: ignore[arg-type]
    return dataclasses.replace(pd7, expectations=(expectation,))


@pytest.mark.parametrize(
    ("relation", "value", "other", "holds"),
    [
        ("=", 0.0, None, True),
        ("=", 1.1e-8, None, True),
        ("=", 1.3e-8, None, False),
        ("=", 0.3, 0.3, True),
        ("=", 0.3, 0.2, False),
        ("<", 0.0, None, False),
        ("<", 0.1, None, True),
        ("<=", 0.0, None, True),
        (">", -0.1, None, True),
        (">", 0.0, None, False),
        (">=", 0.1, None, False),
        ("in", -0.1, 0.1, True),
        ("in", 0.1, 0.2, False),
    ],
)
def test_relations(
    pd7: RuleBase, relation: str, value: float, other: float | None, holds: bool
) -> None:
    found = check_expectations(expecting(pd7, Outcome("u", relation, value, other)))
    assert (not found) == holds


def test_a_failure_says_what_was_expected_and_what_came_out(pd7: RuleBase) -> None:
    good, bad = Outcome("u", ">=", 0.0), Outcome("u", "=", 2.5, 0.1)
    (found,) = check_expectations(expecting(pd7, good, bad))
    assert found.name == "failed-expectation"
    assert found.severity is Severity.ERROR
    assert found.line == 7
    assert found.message == "expected u = 2.5 ± 0.1 at e = 0, ce = 0, but u = 0"


def test_an_expectation_that_cannot_be_evaluated_fails(pd7: RuleBase) -> None:
    outcome = Outcome("u", "=", 0.0)
    (missing,) = check_expectations(expecting(pd7, outcome, at=(("e", 0.0),)))
    assert "no value for input ce" in missing.message
    (unknown,) = check_expectations(expecting(pd7, Outcome("v", "=", 0.0)))
    assert "no output 'v'" in unknown.message


def test_the_shipped_rule_base_meets_its_expectations(pd7: RuleBase) -> None:
    assert pd7.expectations
    assert check_expectations(pd7) == []
