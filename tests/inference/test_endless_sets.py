"""Sets without ends mean the same to every engine."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fuzzyarm import compiled, parse
from tests.interpreted import interpreted

X = np.array([-7.0, -1.0, 0.0, 0.25, 1.0, 7.0])


@pytest.mark.parametrize(
    ("shape", "holds"),
    [
        ("rectangle -inf inf", lambda x: True),
        ("rectangle -inf 0", lambda x: x <= 0.0),
        ("rectangle 0 inf", lambda x: x >= 0.0),
        ("trapezoid -inf -inf inf inf", lambda x: True),
        ("trapezoid -inf -inf 0 0", lambda x: x <= 0.0),
    ],
)
def test_every_engine_agrees(shape, holds):
    rulebase = parse(f"""rulebase m
input a 0 .. 1
output y 0 .. 10
term a SOME: {shape}
term y R1: linear 3*a + 1
inference defuzzifier weighted-average, outside extend, no-rule nan
rule if a is SOME then y is R1
""").rulebase
    assert rulebase is not None
    wanted = [3.0 * x + 1.0 if holds(x) else math.nan for x in X.tolist()]
    point = [interpreted(rulebase).point({"a": x})["y"] for x in X.tolist()]
    for found in (
        point,
        interpreted(rulebase).evaluate({"a": X})["y"],
        compiled(rulebase)(a=X)["y"],
    ):
        assert np.array_equal(found, wanted, equal_nan=True)
