"""A kind that is registered anew counts at once, also for rule bases that have been used."""

import numpy as np
import pytest

from fuzzyarm import compiled, infer, kinds, load, op

TEXT = """rulebase r
input  e  -1 .. 1
output u  -1 .. 1
term e A: newly 0 1
term e B: triangle -1 1 1
term u L: triangle -1 -0.5 0
term u R: newly 0.5 0.4
inference defuzzifier centroid(101), no-rule 0
rule if e is A then u is R
rule if e is B then u is L
"""


def test_a_kind_that_is_registered_anew_counts_for_what_was_used(tmp_path):
    path = tmp_path / "r.frb"
    path.write_text(TEXT)
    try:
        kinds.shape("newly", ("c", "w"), lambda x, c, w: op.maximum(0.0, 1.0 - ((x - c) / w) ** 2))
        used = load(path)
        before = infer(used, e=0.5), compiled(used)(e=0.5)
        kinds.shape(
            "newly", ("c", "w"), lambda x, c, w: 0.3 * op.maximum(0.0, 1.0 - abs(x - c) / w)
        )
        fresh = infer(load(path), e=0.5)
        assert fresh["u"] != pytest.approx(before[0]["u"])
        assert infer(used, e=0.5) == fresh
        assert infer(used, {"e": np.array([0.5, 0.5])})["u"].tolist() == [fresh["u"]] * 2
        assert compiled(used)(e=0.5) == pytest.approx(fresh)
    finally:
        from fuzzyarm.symbolic.kinds import SHAPES

        SHAPES.remove("newly")
