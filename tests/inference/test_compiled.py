"""Machine code equals the readable engine, over rule bases of every kind."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzyarm.inference import InferenceError, NoRuleFiredError, compiled, infer
from fuzzyarm.rulebase.model import (
    CONJUNCTIONS,
    DISJUNCTIONS,
    Defuzzifier,
    RuleBase,
)
from tests.strategies import SMOOTH, STRAIGHT, input_points, plain_mamdani, rulebases

slow_draws = settings(
    deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large]
)


def held_middles(rulebase: RuleBase) -> dict[str, float]:
    return {each.name: 0.5 * (each.low + each.high) for each in rulebase.outputs}


def assert_equal_engines(rulebase: RuleBase, points: dict[str, list[float]]) -> str:
    fast, held = compiled(rulebase), held_middles(rulebase)
    arrays = {name: np.array(values) for name, values in points.items()}
    try:
        expected = infer(rulebase, arrays, held=held)
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
            if fast.kernel == "numba":
                # Curved memberships of one point come from plain Python.
                value = found[output.name][i]
                scale = max(1.0, output.high - output.low) * max(1.0, abs(value))
                assert abs(one[output.name] - value) <= 1e-12 * scale
    return fast.kernel


@pytest.mark.slow
@settings(slow_draws, max_examples=150)
@given(st.data())
def test_any_rule_base(data: st.DataObject) -> None:
    rulebase = data.draw(rulebases())
    assert_equal_engines(rulebase, data.draw(input_points(rulebase, 5)))


@pytest.mark.slow
@settings(slow_draws, max_examples=200)
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
    assert assert_equal_engines(rulebase, data.draw(input_points(rulebase, 8))) == "numba"
