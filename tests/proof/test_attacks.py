"""What is proved is attacked by inference alone; what is refuted is pasted and run."""

from __future__ import annotations

import math
import random
from functools import partial

import pytest
from budget import cases

import fuzzyarm
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map import Prover, UnprovableError, prove
from fuzzyarm.proof.map.boxes import Boxes
from fuzzyarm.proof.stop import Stop
from tests.fuzz import attacked_proofs
from tests.fuzz.attacked_proofs import FAMILIES, OFTEN, attack, attack_boxes, case, drawn
from tests.fuzz.fuzzing import search


def read(text: str) -> RuleBase:
    found = parse(text)
    assert found.rulebase is not None, [str(each) for each in found.diagnostics]
    return found.rulebase


@pytest.mark.slow
def test_nothing_false_is_proved_and_evidence_holds_as_pasted() -> None:
    found = search(case, seed=3, count=cases(6, 400))
    assert not found, f"{found[0].told}\n{found[0].trace}"


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_no_family_of_outputs_has_a_false_proof(
    family: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(attacked_proofs, "SECONDS", 0.1)
    found = search(partial(case, family=family), seed=5, count=cases(8, 300))
    assert not found, f"{found[0].told}\n{found[0].trace}"


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_every_defuzzifier_of_a_family_is_drawn(family: str) -> None:
    """And nothing is refused: each has bounds over boxes, or is made of pieces."""
    refused, methods = set(), set()
    for seed in range(cases(40, 60)):
        rulebase = drawn(random.Random(f"{family} {seed}"), family)
        methods.add(rulebase.output("u").defuzzifier.method)
        prover = Prover(rulebase, "u", stop=Stop(0.0))
        if prover.model is None:
            try:
                Boxes(rulebase, "u", [(0.0, 0.5)] * len(rulebase.inputs), Stop())
            except UnprovableError as error:
                refused.add(str(error))
    assert all("tsukamoto cannot invert it" in each for each in refused), refused
    assert methods == {way.split("(")[0].split()[0] for way in OFTEN[family]}


def test_the_attack_sees_a_bound_of_a_box_that_is_too_close(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rulebase = fuzzyarm.load_rulebase(fuzzyarm.shipped("pd7.frb"))
    outside = Boxes._value_bounds

    def inside(self: Boxes, low: object, high: object) -> tuple[object, object]:
        least, most = outside(self, low, high)  # type: ignore[arg-type]
        return least + 0.45 * (most - least), most

    monkeypatch.setattr(Boxes, "_value_bounds", inside)
    with pytest.raises(AssertionError, match="below"):
        attack_boxes(rulebase, random.Random(1))


def test_the_attack_sees_a_false_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Prover, "without_value", lambda *_: None)
    rulebase = read(BEYOND.format(outside="extend"))
    assert prove(rulebase, "u <= 1.5").proved
    with pytest.raises(AssertionError):
        attack(rulebase, "u <= 1.5", {}, random.Random(1))


BEYOND = """
rulebase r
input x -3 .. 5
output u 0 .. 1
term x T0: triangle -11 -3 5
term u A: triangle -1 0 1
inference no-rule 2, outside {outside}
rule if x is not T0 then u is A
"""


@pytest.mark.parametrize("outside", ["extend", "clamp"])
def test_a_number_for_no_rule_counts_beyond_the_range(outside: str) -> None:
    rulebase = read(BEYOND.format(outside=outside))
    assert fuzzyarm.infer(rulebase, x=-3.0) == {"u": 2.0}
    verdict = prove(rulebase, "u <= 1.5")
    assert verdict.verdict == "refuted"
    assert verdict.evidence == ("expect x = -3 -> u = 2",)
    assert prove(rulebase, "u <= 2").proved
    assert prove(rulebase, "u < 2").verdict == "refuted"
    assert Prover(rulebase, "u").value({}).high == 2.0


NO_AREA = """
rulebase r
input x 0 .. 2
output u 0 .. 1
term x L: triangle -1 0 1
term x R: triangle 0 1 3
term u A: {set}
term u B: triangle 0 0.5 1
inference no-rule {no_rule}, outside extend{more}
rule if x is L then u is B
rule if x is R then u is A
"""


@pytest.mark.parametrize("more", ["", ", aggregation sum", ", implication product",
                                  ", implication product, aggregation sum",
                                  ", defuzzifier centroid(51)"])  # fmt: skip
@pytest.mark.parametrize("set_", ["triangle 5 6 7", "triangle 1 2 3"])
def test_so_it_does_where_what_fires_has_no_area_in_the_range(more: str, set_: str) -> None:
    rulebase = read(NO_AREA.format(set=set_, no_rule=3, more=more))
    assert fuzzyarm.infer(rulebase, x=1.5) == {"u": 3.0}
    verdict = prove(rulebase, "u <= 2", budget=20)
    assert verdict.verdict == "refuted", verdict
    assert prove(rulebase, "u covered", budget=20).proved
    error = read(NO_AREA.format(set=set_, no_rule="error", more=more))
    assert prove(error, "u <= 2", budget=20).verdict == "refuted"
    with pytest.raises(UnprovableError):
        Prover(error, "u").slope({}, "x")


@pytest.mark.parametrize(
    ("points", "setting"),
    [
        ("0 0.5 1 height 0.5", "implication bounded"),
        ("0 0.5 1", "implication drastic"),
        ("0 0.5 1 height 0.5", "implication nilpotent"),
        ("0.101 0.105 0.109", "defuzzifier centroid(11)"),  # between two samples
    ],
)
def test_so_it_does_where_a_rule_that_fires_leaves_nothing(points: str, setting: str) -> None:
    rulebase = read(
        "rulebase r\ninput x 0 .. 2\noutput u 0 .. 1\nterm x L: triangle -1 0 3\n"
        f"term u B: triangle {points}\n"
        f"inference no-rule 3, outside extend, {setting}\nrule if x is L then u is B\n"
    )
    assert fuzzyarm.infer(rulebase, x=1.9) == {"u": 3.0}
    assert not prove(rulebase, "u <= 2", budget=0.5).proved


def test_ends_of_karnik_and_mendel_are_no_averages() -> None:
    """A region of averages was given: 2.11 .. 2.19, where it is 2."""
    rulebase = read(
        "rulebase r\ninput x 0 .. 10\noutput u 0 .. 30\n"
        "term x A: triangle -10 2 16 over triangle -5 2 15 height 0.8\n"
        "term u P: singleton 3 over singleton 1\n"
        "inference u: defuzzifier karnik-mendel, no-rule 2\nrule if x is A then u is P\n"
    )
    assert fuzzyarm.infer(rulebase, x=5.0) == {"u": 2.0}
    bounds = Prover(rulebase, "u").value({})
    assert bounds.low <= 2.0 <= bounds.high
    assert bounds.high - bounds.low < 1e-9


def test_a_single_point_where_nothing_of_type_2_fires_counts() -> None:
    rulebase = read(
        "rulebase r\ninput x 0 .. 2\noutput u 0 .. 1\n"
        "term x A: trapezoid -1 0 0.5 1 over trapezoid -1 0 0.25 0.75\n"
        "term x B: trapezoid 1 1.5 2 3 over trapezoid 1.25 1.75 2 3\n"
        "term u P: singleton 0.5 over singleton 0.4\n"
        "inference u: defuzzifier karnik-mendel, no-rule 1\n"
        "rule if x is A then u is P\nrule if x is B then u is P\n"
    )
    assert fuzzyarm.infer(rulebase, x=1.0) == {"u": 1.0}
    assert not prove(rulebase, "u <= 0.6", budget=2).proved
    assert prove(rulebase, "x in 0 .. 0.5 -> u <= 0.6", budget=2).proved


@pytest.mark.slow
def test_strengths_too_small_for_floats_give_values_all_the_same() -> None:
    rulebase = read(
        "rulebase r\ninput x 0 .. 2\noutput u 0 .. 1\nterm x L: triangle -1 0 3\n"
        "term u B: triangle 0 0.5 1\ninference no-rule 0\nrule if x is L then u is B with 1e-14\n"
    )
    bounds = Prover(rulebase, "u").value({})
    assert bounds.low <= fuzzyarm.infer(rulebase, x=1.0)["u"] <= bounds.high


ROUNDED = """
rulebase r
input x 0 .. 1
input y 0 .. 1
output u 0 .. 1
term x A: triangle 0 0.3 1
term y A: triangle 0 0.7 1
term u P: triangle 0 0.2 1
inference and bounded, no-rule {no_rule}, outside extend
rule if x is A and y is A then u is P
"""


def test_evidence_is_what_inference_gives() -> None:
    rulebase = read(ROUNDED.format(no_rule=2))
    verdict = prove(rulebase, "u <= 1", budget=20)
    assert verdict.verdict == "refuted"
    (line,) = verdict.evidence
    again = read(ROUNDED.format(no_rule=2) + line + "\n")
    assert fuzzyarm.inference.check_expectations(again) == []
    silent = prove(read(ROUNDED.format(no_rule="error")), "u <= 1", budget=20)
    assert silent.verdict == "refuted"
    (point,) = silent.points
    with pytest.raises(fuzzyarm.inference.NoRuleFiredError):
        fuzzyarm.infer(read(ROUNDED.format(no_rule="error")), point)


TOUCHES = """
rulebase r
input x 0 .. 1
output u 0 .. 1
term x A: points (0, 1) (0.3, 0.1) (1, 1)
term x B: points (0, 1) (0.3, 0.9) (1, 1)
term u P: triangle 0 0.2 1
inference and bounded, no-rule {no_rule}, outside extend
rule if x is A and x is B then u is P
"""


def test_what_fails_by_less_than_a_rounding_is_said_and_not_pasted() -> None:
    """0.1 + 0.9 − 1 is 0 or 5.6e-17 below; floats may say either."""
    verdict = prove(read(TOUCHES.format(no_rule=2)), "u <= 1")
    if verdict.verdict == "refuted":
        assert verdict.evidence or "in exact arithmetic" in verdict.reason
    for line in verdict.evidence:
        again = read(TOUCHES.format(no_rule=2) + line + "\n")
        assert fuzzyarm.inference.check_expectations(again) == []


def nine_terms(seed: int, more: str = "") -> RuleBase:
    """Return a rule base of two inputs with nine terms at odd positions each."""
    draw = random.Random(seed)
    lines = ["rulebase r", "input x -1 .. 1", "input y -1 .. 1", "output u -1 .. 1"]
    for name in ("x", "y", "u"):
        peaks = sorted(round(draw.uniform(-1, 1), 3) for _ in range(7))
        peaks = [-1.0, *peaks, 1.0]
        ends = [-1.5, *peaks, 1.5]
        for i, peak in enumerate(peaks):
            lines.append(f"term {name} T{i}: triangle {ends[i]} {peak} {ends[i + 2]}")
    lines.append(f"inference no-rule 0{more}")
    for i in range(9):
        for j in range(9):
            k = min(8, max(0, i + j - 4 + draw.choice([0, 0, 0, 1])))
            lines.append(f"rule if x is T{i} and y is T{j} then u is T{k}")
    return read("\n".join(lines) + "\n")


STATEMENTS = ["u slope x in -1 .. 9", "u rises with x", "u <= 0.7", "u odd", "u covered"]


@pytest.mark.parametrize("more", ["", ", and bounded", ", implication product", ", and hamacher"])
@pytest.mark.parametrize("statement", STATEMENTS)
def test_something_is_said_before_anything_takes_long(statement: str, more: str) -> None:
    """And when time is over there is a verdict: whatever is cut or searched looks at the clock."""
    told: list[tuple[str, int, float]] = []
    rulebase = nine_terms(1, more)
    verdict = prove(rulebase, statement, budget=1e-6, tell=lambda *each: told.append(each))
    assert not verdict.proved
    assert told[0][:2] == (verdict.statement, 0)
    assert math.isnan(told[0][2])


@pytest.mark.parametrize(
    ("no_rule", "verdict", "words"),
    [
        ("nan", "refuted", "no rule fires at e = "),
        ("error", "refuted", "no rule fires at e = "),
        ("hold", "undecided", "'u' holds its last value"),
        ("0.45", "proved", ""),
    ],
)
def test_where_no_rule_fires_no_value_is_proved(no_rule: str, verdict: str, words: str) -> None:
    rulebase = read(
        "input e -1 .. 1\noutput u -1 .. 1\nterm e N: triangle -1 -0.6 -0.2\n"
        "term e P: triangle 0.2 0.6 1\nterm u L: singleton 0.45\nterm u H: singleton 0.55\n"
        f"inference u: defuzzifier weighted-average, no-rule {no_rule}\n"
        "rule if e is N then u is L\nrule if e is P then u is H\n"
    )
    judged = prove(rulebase, "u in 0.4 .. 0.6")
    assert judged.verdict == verdict
    assert words in judged.reason
    for there in ("e in -0.8 .. -0.4 -> u in 0.4 .. 0.6", "e in 0.3 .. 0.9 -> u >= 0.54"):
        assert prove(rulebase, there).verdict == "proved"
