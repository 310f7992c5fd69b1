"""A range is proved of every ordinary setting of inference, and a close one over a part.

None stays out. Under the implication *drastic* the right answer is another one: of a set that is
cut below 1 it leaves a single point, which has no area, so that there is no value to prove anything
of; the statement is refuted by such a point.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map import Prover, prove
from fuzzyarm.proof.map.boxes import Boxes
from fuzzyarm.proof.stop import Stop

SETS = "terms u: triangles A B"
CURVES = "terms u: gaussians A B"
VALUES = "terms u: singletons A B"
LINEAR = "term u A: linear 1*a + 0.2\nterm u B: linear 0.5*b"
FORMULA = 'term u A: formula "a*b"\nterm u B: formula "a + b"'
RAMPS = "term u A: ramp 1 0\nterm u B: ramp 0 1"
INTERVALS = (
    "term u A: triangle 0 0 1 over triangle 0 0 0.6\nterm u B: triangle 0 1 1 over triangle 0.4 1 1"
)


RULES = """\
rule if a is L and b is L then u is A
rule if a is L and b is H then u is B
rule if a is H and b is L then u is B
rule if a is H and b is H then u is B
"""

OPPOSED = """\
rule if a is L and a is H then u is A with 0.9
rule if a is L or a is H then u is B
rule if b is H and a is L then u is B with 0.2
"""
"""B is above A everywhere: 0.5 and more against 0.45. One box knows only that both are 0 to 1."""


class Setting(NamedTuple):
    """A way of inference over two inputs."""

    defuzzifier: str
    terms: str = SETS
    conjunction: str = "min"
    implication: str = "min"
    aggregation: str = "max"
    family: str = "triangles"

    def rulebase(self, rules: str = "") -> RuleBase:
        text = (
            "rulebase setting\ninput a 0 .. 1\ninput b 0 .. 1\noutput u 0 .. 1\n"
            f"terms a, b: {self.family} L H\n{self.terms}\n"
            f"inference and {self.conjunction}, implication {self.implication}\n"
            f"inference u: aggregation {self.aggregation}, defuzzifier {self.defuzzifier}\n"
            f"{rules or RULES}"
        )
        found = parse(text)
        assert found.rulebase is not None, [str(each) for each in found.diagnostics]
        return found.rulebase


SETTINGS = {
    "centroid": Setting("centroid exact"),
    "centroid sampled": Setting("centroid(51)"),
    "centroid joined": Setting("centroid(51, joined)"),
    "bisector": Setting("bisector exact"),
    "bisector sampled": Setting("bisector(51)"),
    "bisector joined": Setting("bisector(51, joined)"),
    "mean of maximum": Setting("mean-of-maximum exact"),
    "mean of maximum sampled": Setting("mean-of-maximum(51)"),
    "smallest of maximum": Setting("smallest-of-maximum exact"),
    "largest of maximum sampled": Setting("largest-of-maximum(51)"),
    "nearest of maximum": Setting("nearest-of-maximum exact"),
    "nearest of maximum sampled": Setting("nearest-of-maximum(51)"),
    "farthest of maximum sampled": Setting("farthest-of-maximum(51)"),
    "middle of maximum": Setting("middle-of-maximum exact"),
    "middle of maximum sampled": Setting("middle-of-maximum(51)"),
    "centroid of curves": Setting("centroid exact", CURVES),
    "bisector of curves": Setting("bisector exact", CURVES),
    "sum": Setting("centroid exact", aggregation="sum"),
    "product": Setting("centroid exact", implication="product"),
    "probor": Setting("centroid exact", aggregation="probor"),
    "bounded": Setting("centroid exact", implication="bounded"),
    "einstein sampled": Setting("centroid(51)", implication="einstein", aggregation="probor"),
    "and product": Setting("centroid exact", conjunction="product"),
    "gaussian inputs": Setting("centroid exact", family="gaussians"),
    "average": Setting("weighted-average", VALUES),
    "average of lines": Setting("weighted-average", LINEAR),
    "average of formulas": Setting("weighted-average", FORMULA),
    "sum of values": Setting("weighted-sum", VALUES),
    "tsukamoto": Setting("tsukamoto", RAMPS),
    "maximum of values": Setting("mean-of-maximum exact", VALUES),
    "bisector of values": Setting("bisector exact", VALUES),
    "karnik-mendel": Setting("karnik-mendel exact", INTERVALS),
    "karnik-mendel sampled": Setting("karnik-mendel(51)", INTERVALS),
    "nie-tan": Setting("nie-tan exact", INTERVALS),
    "nie-tan sampled": Setting("nie-tan(51)", INTERVALS),
}
"""Ordinary settings that are proved; *drastic* is not."""

CLOSE = {"budget": 10.0, "tolerance": 0.01}

PART = {"a": (0.1, 0.9), "b": (0.1, 0.4)}


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.slow] if n == "bounded" else []) for n in SETTINGS],
)
def test_a_range_is_proved(name: str) -> None:
    verdict = prove(SETTINGS[name].rulebase(), "u in -1 .. 2", budget=5.0)
    assert verdict.verdict == "proved", verdict
    assert isinstance(verdict.bound, tuple)


@pytest.mark.parametrize("name", SETTINGS)
def test_a_close_range_over_a_part_is_proved_by_cutting_it(name: str) -> None:
    rulebase = SETTINGS[name].rulebase(OPPOSED)
    axes = np.meshgrid(*(np.linspace(*ends, 61) for ends in PART.values()))
    values = np.asarray(fuzzyarm.infer(rulebase, dict(zip(PART, axes, strict=True)))["u"])
    low, high = float(values.min()) - 0.03, float(values.max()) + 0.03
    where = ", ".join(f"{name} in {a} .. {b}" for name, (a, b) in PART.items())
    if Prover(rulebase, "u").model is None:
        corners = (np.array([[ends[side] for ends in PART.values()]]) for side in (0, 1))
        least, most = Boxes(rulebase, "u", list(PART.values()), Stop())._value_bounds(*corners)
        assert least[0] < low or high < most[0], "one box is enough: this shows nothing"
    verdict = prove(rulebase, f"{where} -> u in {low:.6f} .. {high:.6f}", **CLOSE)
    assert verdict.verdict == "proved", verdict
    # The bound is one of this part, not of the universe; and what is seen lies in it.
    assert isinstance(verdict.bound, tuple)
    assert low - 1e-6 <= verdict.bound[0] <= values.min() + 1e-12
    assert values.max() - 1e-12 <= verdict.bound[1] <= high + 1e-6
    seen = float(values.max())
    planted = prove(rulebase, f"{where} -> u <= {seen - 0.01:.6f}", **CLOSE)
    assert planted.verdict == "refuted", planted


def test_under_drastic_there_is_no_value_and_the_statement_is_refuted() -> None:
    rulebase = Setting("centroid exact", implication="drastic").rulebase()
    verdict = prove(rulebase, "u in -1 .. 2", budget=5.0)
    assert verdict.verdict == "refuted"
    assert verdict.reason.startswith("no rule fires at ")
    (point,) = verdict.points
    with pytest.raises(fuzzyarm.FuzzyarmError):
        fuzzyarm.infer(rulebase, **point)


@pytest.mark.parametrize("name", ["mean of maximum", "bisector sampled", "tsukamoto", "nie-tan"])
@pytest.mark.parametrize("claim", ["u rises with a", "u slope a in -99 .. 99", "u odd"])
def test_what_needs_pieces_is_refused_by_name(name: str, claim: str) -> None:
    setting = SETTINGS[name]
    text = f"u {claim[2:]}"
    rulebase = setting.rulebase()
    if claim == "u odd":  # which a range from 0 cannot be
        return
    verdict = prove(rulebase, text)
    assert verdict.verdict == "undecided"
    assert setting.defuzzifier.split("(")[0].split()[0] in verdict.reason


@pytest.mark.parametrize(
    "name", ["mean of maximum", "mean of maximum sampled", "smallest of maximum"]
)
def test_where_the_value_jumps_the_bound_is_that_of_both_sides(name: str) -> None:
    """At a = 1/2 A and B are cut alike: the value is that of either, or of both together."""
    prover = Prover(SETTINGS[name].rulebase(), "u")
    assert prover.value({"a": (0.49, 0.51), "b": (0.1, 0.1)}).high > 0.5
    assert prover.value({"a": (0.2, 0.48), "b": (0.1, 0.1)}).high < 0.5
