"""Maxima of curved sets that are equally high: each is at its peak in one point."""

import numpy as np
import pytest

from fuzzyarm import compiled, infer, parse, prove

TEXT = """rulebase tie
input  e  0 .. 1
output u  0 .. 1
term e A: rectangle 0 1
term u L: gaussian 0.1 0.05
term u R: gaussian 0.6 0.1
inference implication {implication}, defuzzifier {method} exact
rule if e is A then u is L
rule if e is A then u is R
"""


@pytest.mark.parametrize("implication", ["product", "min"])
@pytest.mark.parametrize(
    ("method", "expected"),
    [("smallest-of-maximum", 0.1), ("mean-of-maximum", 0.35), ("largest-of-maximum", 0.6)],
)
def test_peaks_count_alike_however_wide_their_curves_are(implication, method, expected):
    rulebase = parse(TEXT.format(implication=implication, method=method)).rulebase
    value = infer(rulebase, e=0.5)["u"]
    assert value == pytest.approx(expected, abs=1e-15)
    assert infer(rulebase, {"e": np.array([0.5])})["u"].tolist() == [value]
    assert compiled(rulebase)(e=0.5)["u"] == value


def test_a_range_of_a_formula_set_is_bounded():
    text = TEXT.format(implication="min", method="centroid")
    text = text.replace("gaussian 0.6 0.1", 'formula "1 - x"')
    text = text.replace("rectangle 0 1", "triangle -1 0.5 2")
    verdict = prove(parse(text).rulebase, "u in 0.2 .. 0.5", budget=20)
    assert verdict.verdict == "proved"
