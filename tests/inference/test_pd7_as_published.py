"""The shipped file against the published table (6.4.1), written out once more in tests/pd7.py."""

from __future__ import annotations

import numpy as np
import pytest

from fuzzyarm.inference import infer
from fuzzyarm.language.model.rulebase import RuleBase
from tests.pd7 import make_pd7


def test_the_shipped_rules_are_the_published_ones(pd7: RuleBase) -> None:
    published = make_pd7()
    assert pd7.blocks == published.blocks
    axis = np.linspace(-7.0, 7.0, 29)
    shipped = infer(pd7, e=axis[:, None], ce=axis)["u"]
    np.testing.assert_array_equal(shipped, infer(published, e=axis[:, None], ce=axis)["u"])


@pytest.mark.parametrize(
    ("e", "ce", "u"),
    [
        (0.0, 0.0, 0.0),
        (6.0, 6.0, 6.0 - 2.0 / 3.0),  # half a triangle at the edge of the range
        (-6.0, 4.0, -2.0),  # one rule at full strength: the centre of its triangle
        (4.0, -6.0, -2.0),
        (2.0, -2.0, 0.0),
        (0.0, 4.0, 4.0),
    ],
)
def test_values_worked_out_by_hand(pd7: RuleBase, e: float, ce: float, u: float) -> None:
    assert infer(pd7, e=e, ce=ce)["u"] == pytest.approx(u, abs=1e-12)
