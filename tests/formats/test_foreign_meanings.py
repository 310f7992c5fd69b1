"""Meanings that a file does not show: what a program does with it, measured with that program.

The numbers are those of fuzzylite 7.0.0 (C++), pyfuzzylite 8.0.6, jFuzzyLogic and JFML 1.3 for
these files, or arithmetic that is written out here.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
import skfuzzy

import fuzzyarm
from fuzzyarm.base.diagnostic import Severity
from fuzzyarm.exchange.formats import Imported, parse, parse_fcl, parse_fis, parse_fll, read, write
from fuzzyarm.exchange.formats.fcl_text import is_cut
from fuzzyarm.exchange.formats.fcl_writer import write_fcl
from fuzzyarm.exchange.formats.meaning import root
from fuzzyarm.exchange.formats.shapes import estimated_range, larger_wins
from fuzzyarm.inference import InferenceError, infer, infer_interval
from fuzzyarm.language.model.rulebase import Defuzzifier, Hedge, RuleBase, Shape
from fuzzyarm.language.model.shapes import apply_hedges, membership

DATA = Path(__file__).parent / "data"


def good(imported: Imported) -> RuleBase:
    assert imported.rulebase is not None, [str(d) for d in imported.errors]
    return imported.rulebase


def warned(imported: Imported) -> set[str]:
    return {d.name for d in imported.diagnostics if d.severity is Severity.WARNING}


def same(found: float, expected: float) -> bool:
    return found == pytest.approx(expected, rel=1e-9, abs=1e-9, nan_ok=True)


# ── a rule fires above a millionth, and is hedged then ───────────────────────────────

NAN = math.nan
CONCLUDED = {  # of conclusions_fuzzylite.fcl by fuzzylite 7.0.0: y, z
    1.0: (0.25, 2.0), 2.0: (NAN, 2.0), 3.0: (0.25, 2.0), 4.0: (NAN, 2.0), 5.0: (NAN, 2.0),
    5.4: (0.75, 3.0), 5.5: (0.75, 3.0), 6.2: (0.75, 3.0), 7.0: (0.75, 3.0), 8.0: (0.75, 3.0),
}  # fmt: skip


@pytest.mark.parametrize("x", CONCLUDED)
def test_a_hedged_conclusion_counts_where_the_rule_fires(x: float) -> None:
    found = infer(good(read(DATA / "conclusions_fuzzylite.fcl")), x=x)
    assert same(found["y"], CONCLUDED[x][0])
    assert found["z"] == pytest.approx(CONCLUDED[x][1], abs=2e-3)


@pytest.mark.parametrize("suffix", [".fcl", ".frb"])
def test_what_is_hedged_comes_back_from_every_file_that_can_say_it(suffix: str) -> None:
    rulebase = good(read(DATA / "conclusions_fuzzylite.fcl"))
    producer = None if suffix == ".frb" else "fuzzylite"
    exported = write(rulebase, suffix, producer=producer)
    assert exported.text is not None, [str(d) for d in exported.errors]
    again = good(parse(exported.text, suffix, producer=producer))
    for x in CONCLUDED:
        one, other = infer(rulebase, x=x), infer(again, x=x)
        assert all(same(one[name], other[name]) for name in one), x


FIS = """[System]
Name='s'
Type='sugeno'
NumInputs=1
NumOutputs=1
NumRules=2
AndMethod='prod'
OrMethod='max'
ImpMethod='min'
AggMethod='max'
DefuzzMethod='wtaver'
[Input1]
Name='x'
Range=[0 10]
MF1='l':TERM
MF2='h':'trimf',[6 8 10]
[Output1]
Name='y'
Range=[0 1]
MF1='a':'constant',[0.25]
MF2='b':'constant',[0.75]
[Rules]
1, -1 (1) : 1
2, 2.2 (1) : 1
"""


def fis(term: str = "'trimf',[0 2 4]", **changes: str) -> str:
    text = FIS.replace("TERM", term)
    for key, value in changes.items():
        head, _, rest = text.partition(f"{key}='")
        text = f"{head}{key}='{value}'{rest.partition(chr(39))[2]}"
    return text


def test_a_negated_conclusion_of_a_fis_by_fuzzylite() -> None:
    rulebase = good(parse_fis(fis(), producer="fuzzylite"))
    # fuzzylite 7.0.0 at 1, 5, 7 and 9.9
    assert [infer(rulebase, x=x)["y"] for x in (1.0, 7.0, 9.9)] == [0.25, 0.75, 0.75]
    assert math.isnan(infer(rulebase, x=5.0)["y"])
    exported = write(rulebase, ".fis", producer="fuzzylite")
    assert exported.text is not None, [str(d) for d in exported.errors]
    again = good(parse_fis(exported.text))
    for x in (1.0, 5.0, 7.0, 9.9):
        assert same(infer(again, x=x)["y"], infer(rulebase, x=x)["y"])


@pytest.mark.parametrize(
    ("term", "severity"),
    [
        ("'trimf',[0 2 4]", None),
        ("'smf',[0 10]", Severity.WARNING),  # below 1e-6 in a part in 1400 of the range
        ("'gaussmf',[0.5 2]", Severity.ERROR),
        ("'gaussmf',[3 5]", None),  # above 1e-6 everywhere
    ],
)
def test_what_lies_between_0_and_a_millionth_is_said(term: str, severity: Severity | None) -> None:
    imported = parse_fis(fis(term), producer="fuzzylite")
    found = [d.severity for d in imported.diagnostics if d.name == "hedged-conclusion"]
    assert found == ([severity] if severity else [])
    assert (imported.rulebase is None) == (severity is Severity.ERROR)


FLL = """Engine: e
InputVariable: x
  range: 0 1
  term: a Ramp 0.5 1
OutputVariable: y
  range: 0 1
  aggregation: AGGREGATION
  defuzzifier: METHOD
  default: nan
  term: low TERM1
  term: high TERM2
RuleBlock: b
  implication: IMPLICATION
  activation: ACTIVATION
  rule: if x is a then y is CONCLUSION
"""


def fll(conclusion: str = "low", **changes: str) -> Imported:
    usual = {
        "METHOD": "Centroid", "AGGREGATION": "Maximum", "IMPLICATION": "Minimum",
        "ACTIVATION": "General", "TERM1": "Triangle 0 0.25 0.5", "TERM2": "Triangle 0.5 0.75 1",
        "CONCLUSION": conclusion,
    } | changes  # fmt: skip
    text = FLL
    for key, value in usual.items():
        text = text.replace(key, value)
    return parse_fll(text)


def test_an_fll_is_read_as_python_has_it_and_says_so() -> None:
    imported = fll("not low")
    assert infer(good(imported), x=0.2)["y"] == pytest.approx(0.25)  # where nothing fires
    (finding,) = [d for d in imported.diagnostics if d.name == "hedged-conclusion"]
    assert "the C++ program only where it fires above 1e-06" in finding.message
    assert "hedged-conclusion" not in warned(fll("very low"))


def test_a_threshold_of_an_fll_is_that_of_the_degree_before_its_hedges() -> None:
    imported = fll("very low", ACTIVATION="Threshold > 0.2")
    assert good(imported).blocks[0].threshold == pytest.approx(0.04)
    assert infer(good(imported), x=0.65)["y"] == pytest.approx(0.25)  # 0.3, under very 0.09
    assert math.isnan(infer(good(imported), x=0.55)["y"])
    refused = fll("not low", ACTIVATION="Threshold > 0.2")
    assert [d.name for d in refused.errors] == ["hedged-conclusion"]


# ── maxima ───────────────────────────────────────────────────────────────────────────

MAXIMA = {"MM": 0.5, "LM": 0.0005, "RM": 0.9995}
FCL = """FUNCTION_BLOCK f
VAR_INPUT
  x: REAL;
END_VAR
VAR_OUTPUT
  y: REAL;
END_VAR
FUZZIFY x
  RANGE := (0.000 .. 1.000);
  TERM a := Ramp 0.500 1.000;
END_FUZZIFY
DEFUZZIFY y
  RANGE := (0.000 .. 1.000);
  TERM low := Triangle 0.000 0.250 0.500;
  METHOD : METHOD_;
  ACCU : ACCU_;
  DEFAULT := DEFAULT_;
END_DEFUZZIFY
RULEBLOCK r
  AND : MIN;
  ACT : ACT_;
  RULE 1 : if x is a then y is low
END_RULEBLOCK
END_FUNCTION_BLOCK
"""


def fcl(method: str = "COG", accu: str = "MAX", act: str = "MIN", default: str = "nan") -> str:
    text = FCL.replace("METHOD_", method).replace("ACCU_", accu)
    return text.replace("ACT_", act).replace("DEFAULT_", default)


@pytest.mark.parametrize("method", MAXIMA)
@pytest.mark.parametrize("default", ["nan", "0.9"])
def test_maxima_of_nothing_are_all_samples_to_fuzzylite(method: str, default: str) -> None:
    imported = parse_fcl(fcl(method, default=default))
    assert infer(good(imported), x=0.2)["y"] == pytest.approx(MAXIMA[method], abs=1e-12)
    assert ("maximum-of-nothing" in warned(imported)) == (default != "nan")
    assert good(parse_fcl(fcl("COG", default=default))).outputs[0].no_rule == pytest.approx(
        float(default), nan_ok=True
    )


def test_a_default_that_never_counts_is_not_written() -> None:
    imported = good(parse_fcl(fcl("MM")))
    other = imported.outputs[0]
    rulebase = replace(imported, outputs=(replace(other, no_rule=0.9),))
    for suffix in (".fcl", ".fis"):
        errors = write(rulebase, suffix, producer="fuzzylite").errors
        assert [d.name for d in errors] == ["no-rule"]
        assert write(imported, suffix, producer="fuzzylite").text is not None


@pytest.mark.parametrize("method", ["COG", "COA", *MAXIMA])
def test_ties_of_maxima_are_said(method: str) -> None:
    is_maximum = method in MAXIMA
    assert ("ties-of-maxima" in warned(parse_fcl(fcl(method)))) == is_maximum
    plain = parse_fcl(JFUZZYLOGIC.replace("COG", method))
    assert ("ties-of-maxima" in warned(plain)) == (method in ("LM", "RM"))
    assert ("mean-of-maximum" in warned(plain)) == (method == "MM")
    words = {"COG": "Centroid", "COA": "Bisector", "MM": "MeanOfMaximum",
             "LM": "SmallestOfMaximum", "RM": "LargestOfMaximum"}  # fmt: skip
    assert ("ties-of-maxima" in warned(fll(METHOD=words[method]))) == is_maximum
    assert good(parse_fcl(fcl(method), strict=not is_maximum)) is not None
    assert (parse_fcl(fcl(method), strict=True).rulebase is None) == is_maximum


# ── an integral needs its norms ──────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("imported", "what"),
    [
        (lambda: fll(IMPLICATION="none"), "there is no implication"),
        (lambda: fll(AGGREGATION="none"), "there is no aggregation"),
        (lambda: parse_fcl(fcl(act="NONE")), "there is no implication"),
        (lambda: parse_fcl(fcl(accu="NONE")), "there is no aggregation"),
        (lambda: parse_fcl(fcl().replace("  ACT : MIN;\n", "")), "there is no implication"),
        (
            lambda: parse_fis(
                fis(DefuzzMethod="centroid", ImpMethod="").replace("[0.25]", "[0.5]"),
                producer="fuzzylite",
            ),
            "there is no implication",
        ),
    ],
)
def test_an_integral_without_a_norm_is_an_error(imported: object, what: str) -> None:
    errors = imported().errors  # type: ignore[operator]
    assert {d.name for d in errors} == {"missing-norm"}
    assert what in errors[0].message
    norm = "agg|accu|acc" if "aggregation" in what else "imp|act"
    assert re.match(rf"write ({norm})\w* ?[:=] ?'?(max|min)", errors[0].hint, re.IGNORECASE)


def test_values_need_no_implication() -> None:
    imported = fll(
        IMPLICATION="none", AGGREGATION="none", METHOD="WeightedAverage", TERM1="Constant 1",
        TERM2="Constant 2",
    )  # fmt: skip
    assert infer(good(imported), x=1.0)["y"] == 1.0
    # MATLAB has norms of its own where the file names none.
    assert good(parse_fis(fis(ImpMethod=""), producer="matlab")) is not None


# ── what jFuzzyLogic drops or refuses, what Octave refuses ───────────────────────────

JFUZZYLOGIC = """FUNCTION_BLOCK a
VAR_INPUT
 x : REAL;
END_VAR
VAR_OUTPUT
 y : REAL;
END_VAR
FUZZIFY x
 TERM l := (0,1) (1,0);
 TERM h := (0,0) (1,1);
END_FUZZIFY
DEFUZZIFY y
 TERM l := TRIAN 0 2 4;
 TERM h := TRIAN 6 8 10;
 METHOD : COG;
 RANGE := (0 .. 10);
END_DEFUZZIFY
RULEBLOCK r
 AND : MIN;
 ACCU : MAX;
 RULE 1 : IF x IS l THEN y IS l;
 RULE 2 : IF x IS h THEN y IS h;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""


def test_jfuzzylogic_drops_a_not_in_a_conclusion() -> None:
    for conclusion in ("y IS NOT l", "y IS not l"):
        text = JFUZZYLOGIC.replace("THEN y IS l", f"THEN {conclusion}")
        (error,) = parse_fcl(text, lossy=True).errors
        assert (error.name, error.line) == ("hedged-conclusion", 21)
        assert "jFuzzyLogic drops the NOT of a conclusion: to it this rule says y IS l" in (
            error.message
        )


def test_a_hedge_that_jfuzzylogic_does_not_have() -> None:
    imported = parse_fcl(JFUZZYLOGIC.replace("x IS h", "x IS very h"))
    assert "guessed-hedge" in warned(imported)
    assert "guessed-hedge" not in warned(parse_fcl(JFUZZYLOGIC.replace("x IS h", "x IS NOT h")))


def test_octave_refuses_values_outside_a_range() -> None:
    rulebase = good(parse_fis(fis().replace(", -1", ", 1"), producer="octave"))
    assert rulebase.inputs[0].outside == "error"
    with pytest.raises(InferenceError):
        infer(rulebase, x=10.5)
    again = write(rulebase, ".fis", producer="octave")
    assert "outside-range" not in {d.name for d in again.diagnostics}
    plain = good(parse_fis(fis().replace(", -1", ", 1"), producer="fuzzylite"))
    assert "outside-range" in {d.name for d in write(plain, ".fis", producer="octave").diagnostics}


# ── FCL for scikit-fuzzy ─────────────────────────────────────────────────────────────


def test_a_step_makes_the_points_of_scikit_fuzzy() -> None:
    """The rules once more by functions of scikit-fuzzy alone."""
    import numpy as np

    imported = read(DATA / "spray_scikit.fcl")
    rulebase = good(imported)
    assert imported.producer == "scikit-fuzzy"
    wind, wet, dose = np.arange(0, 20, 0.5), np.arange(0, 1, 0.25), np.arange(0, 4, 0.1)
    assert (rulebase.inputs[0].high, rulebase.inputs[1].high) == (19.5, 0.75)
    assert rulebase.outputs[0].defuzzifier == Defuzzifier("centroid", 40, "joined")
    calm = skfuzzy.trimf(wind, [0, 0, 8])
    fresh = skfuzzy.gaussmf(wind, 10, 3)
    storm = np.interp(wind, [0, 9, 15, 20], [0, 0, 1, 1])
    yes = skfuzzy.smf(wet, 0.1, 0.9)
    none = (np.arange(40) == 0).astype(float)
    some, full = skfuzzy.trapmf(dose, [0.5, 1, 2, 3]), skfuzzy.gaussmf(dose, 4, 0.6)
    at = skfuzzy.interp_membership
    for wind_at, wet_at in ((3.25, 0.1), (9.9, 0.6), (14.2, 0.3), (25.0, 2.0), (0.0, 0.0)):
        w, h = min(wind_at, 19.5), min(wet_at, 0.75)
        c, s, y = at(wind, calm, w), at(wind, storm, w), at(wet, yes, h)
        f = at(wind, fresh**2, w)
        first, second = c * (1 - y), 0.8 * (f + y * c - f * y * c)
        cuts = ((first, full), (second, some), (s, none))
        xs = dose
        for cut, degrees in cuts:
            xs = np.union1d(xs, skfuzzy.interp_universe(dose, degrees, cut))
        union = np.zeros_like(xs)
        for cut, degrees in cuts:
            union = np.fmax(union, np.fmin(cut, np.interp(xs, dose, degrees)))
        expected = skfuzzy.defuzz(xs, union, "centroid")
        found = infer(rulebase, wind=wind_at, wet=wet_at)["dose"]
        # `fresh` differs by 0.5 % from straight lines between its points
        assert found == pytest.approx(expected, abs=2e-2), (wind_at, wet_at)


def test_terms_of_coarse_points_are_straight_between_them() -> None:
    imported = read(DATA / "spray_scikit.fcl")
    assert good(imported).inputs[1].term("yes").shape.kind == "points"
    assert good(imported).inputs[0].term("fresh").shape.kind == "gaussian"
    assert "between-samples" in {d.name for d in imported.diagnostics}


@pytest.mark.parametrize(
    ("text", "producer"),
    [
        (fcl(), "fuzzylite"),
        (fcl().replace("0.000 .. 1.000)", "0.000 .. 1.000) WITH 0.1"), "scikit-fuzzy"),
        (JFUZZYLOGIC, "jfuzzylogic"),
        (JFUZZYLOGIC.replace("FUZZIFY x", "FUZZIFY x\n RANGE := (0 .. 1);", 1), "scikit-fuzzy"),
        (
            JFUZZYLOGIC.replace("FUZZIFY x", "FUZZIFY x\n RANGE := (0 .. 1);", 1)
            .replace("IF", "if").replace("THEN", "then"),
            "fuzzylite",
        ),
        (JFUZZYLOGIC.replace(" x : REAL;", " x : REAL; RANGE := (0 .. 1);"), "jfuzzylogic"),
    ],
)  # fmt: skip
def test_whose_fcl_it_is(text: str, producer: str) -> None:
    assert parse_fcl(text).producer == producer


def test_a_range_where_jfuzzylogic_has_none_is_said() -> None:
    text = JFUZZYLOGIC.replace("FUZZIFY x", "FUZZIFY x\n RANGE := (0 .. 1) WITH 0.1;", 1)
    assert {"misplaced-range", "dropped-step"} <= warned(parse_fcl(text, dialect="jfuzzylogic"))


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ("WITH 0.5", "WITH 0", "bad-range"),
        ("RANGE := (0 .. 1) WITH 0.25", "", "bad-range"),
        ("(0 .. 1) WITH 0.25", "(0 .. 1) WITH 4", "bad-range"),
        ("(0 .. 1) WITH 0.25", "(0 .. 1) WITH 1e-9", "bad-range"),
        ("dose is none", "dose is not none", "hedged-conclusion"),
        ("METHOD : COG", "METHOD : COGF", "unknown-defuzzifier"),
        ("METHOD : COG;", "METHOD : COG; ACCU : BSUM;", "unsupported-norm"),
        ("Triangle 0 0 8", "FUNCTION wind * 2", "unknown-shape"),
    ],
)
def test_what_the_reader_of_scikit_fuzzy_does_not_take(old: str, new: str, name: str) -> None:
    text = (DATA / "spray_scikit.fcl").read_text()
    assert old in text
    imported = parse_fcl(text.replace(old, new), dialect="scikit-fuzzy")
    assert name in {d.name for d in imported.errors}


# ── formulas that are sets, corners out of order, FML ────────────────────────────────


def test_formulas_are_the_sets_that_they_draw() -> None:
    imported = read(DATA / "drawn.fll")
    steer = good(imported).outputs[0]
    assert steer.term("left").shape == Shape("triangle", (0.0, 0.25, 0.5))
    right = steer.term("right").shape
    assert right.kind == "points"
    step = 1 / 200
    xs = [(i + 0.5) * step for i in range(200)]
    assert max(abs(membership(right, x) - x * x) for x in xs) < 1e-12
    assert steer.term("middle").shape == Shape("rectangle", (0.0, 1.0), 0.5)
    obstacle = good(imported).inputs[0].term("right").shape
    assert obstacle.kind == "ramp"
    assert membership(obstacle, 0.6) == pytest.approx(0.55)


def by_hand(obstacle: float) -> float:
    """The centroid of drawn.fll over 200 midpoints, by its three formulas."""
    left = max(0.0, min(obstacle / 0.333, (0.666 - obstacle) / 0.333))
    right = min(1.0, max(0.0, 3 * obstacle - 1.25))
    area = moment = 0.0
    for i in range(200):
        x = (i + 0.5) / 200
        triangle = max(0.0, x / 0.25 if x < 0.25 else (0.5 - x) / 0.25)
        degree = max(min(left, x * x), min(right, triangle), min(0.25, 0.5))
        area, moment = area + degree, moment + degree * x
    return moment / area


@pytest.mark.parametrize("obstacle", [0.1, 0.333, 0.5, 0.8])
def test_their_numbers(obstacle: float) -> None:
    found = infer(good(read(DATA / "drawn.fll")), obstacle=obstacle)["steer"]
    assert found == pytest.approx(by_hand(obstacle), abs=1e-12)


CRANE = {  # gear by JFML 1.3 (a tie: the mean of both), brake by hand
    -8.0: (1.0, 0.0), -3.0: (1.0, 2.0), 0.0: (1.0, 2.0), 2.0: (1.0, 2.3), 5.0: (4.0, 5.5),
    9.0: (4.0, 9.5),
}  # fmt: skip


@pytest.mark.parametrize("swing", CRANE)
def test_winners_and_terms_of_terms_in_fml(swing: float) -> None:
    rulebase = good(read(DATA / "crane_ieee1855.fml"))
    found = infer(rulebase, swing=swing)
    assert found["gear"] == CRANE[swing][0]
    soft = max(0.0, 1 - abs(swing) / 6)
    along = 0.0 if swing <= 0 else 2 * (swing / 6) ** 2 if swing <= 3 else (
        1.0 if swing >= 6 else 1 - 2 * ((swing - 6) / 6) ** 2
    )  # fmt: skip
    total = soft + along
    brake = (2 * soft + (5 + 0.5 * swing) * along) / total if total else 0.0
    assert found["brake"] == pytest.approx(brake)


def test_terms_that_are_made_of_others_are_exact_where_they_are_straight() -> None:
    imported = read(DATA / "crane_ieee1855.fml")
    swing = good(imported).inputs[0]
    assert swing.term("left or still").shape == Shape("trapezoid", (-10.0, -10.0, 0.0, 6.0))
    both = swing.term("both").shape
    assert membership(both, -3.0) == pytest.approx(0.5)  # left and still meet
    assert both == Shape("triangle", (-6.0, -3.0, 0.0), 0.5)
    assert "unsupported-shape" not in warned(imported)
    text = (DATA / "crane_ieee1855.fml").read_text(encoding="utf-8")
    curved = text.replace('t-norm="MIN"><termName>left', 't-norm="PROD"><termName>still')
    assert curved != text
    assert "unsupported-shape" in warned(parse(curved, ".fml"))  # `right` is curved
    assert [membership(swing.term("nowhere").shape, x) for x in (1.0, 2.0, 3.0)] == [0.0] * 3
    assert (good(imported).outputs[1].low, good(imported).outputs[1].high) == (0.0, 10.0)


# ── constants and linear terms between two ends ──────────────────────────────────────


def ends_by_trial(rows: list[tuple[float, float, float, float]]) -> tuple[float, float]:
    """The least and the largest average, over every choice of the ends of the weights."""
    from itertools import product

    lows, highs = [], []
    for weights in product(*[(low, high) for low, high, _, _ in rows]):
        total = sum(weights)
        lows.append(sum(w * row[2] for w, row in zip(weights, rows, strict=True)) / total)
        highs.append(sum(w * row[3] for w, row in zip(weights, rows, strict=True)) / total)
    return min(lows), max(highs)


@pytest.mark.parametrize("at", [(-0.3, 0.6), (0.9, -1.1), (0.0, 0.0)])
def test_values_of_type_2_lie_between_two_ends(at: tuple[float, float]) -> None:
    imported = read(DATA / "observer.t2fis")
    rulebase = good(imported)

    def trapezoid(x: float, a: float, b: float, c: float, d: float) -> float:
        return max(0.0, min((x - a) / (b - a), 1.0, (d - x) / (d - c)))

    def gauss(x: float, sigma: float, c: float, height: float = 1.0) -> float:
        return height * math.exp(-((x - c) ** 2) / (2 * sigma**2))

    x, y = at
    first = (
        (trapezoid(x, -2.5, -1.5, -1.5, 0.5), trapezoid(x, -3.5, -1.5, -0.5, 1.5)),
        (trapezoid(x, -0.5, 1.5, 1.5, 2.5), trapezoid(x, -1.5, 0.5, 1.5, 3.5)),
    )
    second = (
        (gauss(y, 0.8, -1.5, 0.9), gauss(y, 1.2, -1.5)),
        (gauss(y, 0.8, 1.5, 0.9), gauss(y, 1.2, 1.5)),
    )
    lines = (0.5 * x + 0.5, 0.5 * x + 0.125 * y + 1.0)
    values = ((-1, -0.75), (-0.5, -0.5), (0.25, 0.5), (min(lines), max(lines)))
    rows = [
        (first[i][0] * second[j][0], first[i][1] * second[j][1], *values[2 * i + j])
        for i in (0, 1)
        for j in (0, 1)
    ]
    low, high = infer_interval(rulebase, x1=x, x2=y)["y"]
    assert (low, high) == pytest.approx(ends_by_trial(rows), abs=1e-9)
    assert infer(rulebase, x1=x, x2=y)["y"] == pytest.approx(0.5 * (low + high))


def test_the_toolbox_of_type_2_multiplies_and_starts_from_0() -> None:
    text = (DATA / "observer.t2fis").read_text()
    imported = parse(text.replace("AndMethod='prod'", "AndMethod='min'"), ".t2fis")
    assert "unsupported-norm" in warned(imported)
    assert good(imported).blocks[0].conjunction == "product"
    assert good(imported).outputs[0].no_rule == 0.0
    by_mean = good(parse(text.replace("'KM'", "'NT'"), ".t2fis")).outputs[0]
    assert math.isnan(float(by_mean.no_rule))
    errors = parse(text.replace("1 1, 1 (1)", "-1 1, 1 (1)"), ".t2fis").errors
    assert [d.name for d in errors] == ["unsupported-hedge"]


# ── pieces of meaning ────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    "hedge",
    [*(Hedge(name) for name in ("very", "somewhat", "extremely")), Hedge("power", 2.5)],
    ids=str,
)
def test_a_root_undoes_its_hedge(hedge: Hedge) -> None:
    for degree in (0.0, 0.01, 0.3, 0.85, 1.0):
        assert apply_hedges((root(hedge), hedge), degree) == pytest.approx(degree, abs=1e-12)


@pytest.mark.parametrize("slopes", [(1.0, 1.0), (0.5, 0.5), (2.0, 1.0), (0.5, 1.0), (-1.0, -1.0)])
@pytest.mark.parametrize("inflections", [(2.0, 5.0), (5.0, 2.0), (3.0, 3.0)])
def test_a_difference_of_sigmoids_is_cut_where_it_is_negative(
    slopes: tuple[float, float], inflections: tuple[float, float]
) -> None:
    (a, b), (p, q) = slopes, inflections
    values = [1 / (1 + math.exp(-a * (x - p))) - 1 / (1 + math.exp(-b * (x - q)))
              for x in [-15.0 + 0.125 * i for i in range(281)]]  # fmt: skip
    assert is_cut(Shape("sigmoid-difference", (p, a, q, b))) == (min(values) < 0.0)


def test_the_range_that_jfuzzylogic_takes_reaches_as_far_as_the_feet() -> None:
    difference = Shape("sigmoid-difference", (2.0, 3.0, 7.0, 4.5))  # 9/3 and 9/4.5 about them
    assert estimated_range([difference]) == (-1.0, 9.0)
    gaussian = Shape("gaussian", (-3.0, 0.5))
    assert estimated_range([difference, gaussian]) == (-5.0, 9.0)


def test_of_two_points_at_one_place_the_larger_wins_in_either_program() -> None:
    down, up = (0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 2.0, 0.0), (0.0, 0.0, 1.0, 0.5, 1.0, 1.0, 2.0, 0.0)
    after, before = math.nextafter(1.0, 2.0), math.nextafter(1.0, 0.0)
    assert larger_wins(down, "last") == (0.0, 0.0, 1.0, 1.0, after, 0.5, 2.0, 0.0)
    assert larger_wins(up, "first") == (0.0, 0.0, before, 0.5, 1.0, 1.0, 2.0, 0.0)
    assert (larger_wins(down, "first"), larger_wins(up, "last")) == (down, up)


SINGLETONS = """rulebase t
input x 0 .. 10
output y 0 .. 10
terms x: triangles L H
term y A: singleton 1
term y B: {second}
inference y: defuzzifier weighted-average
rule if x is L then y is A
rule if x is H then y is B
"""


@pytest.mark.parametrize(("second", "method"), [("singleton 2", "COGS"), ("linear 0.4", "COGF")])
def test_jfuzzylogic_has_a_method_of_its_own_for_formulas(second: str, method: str) -> None:
    rulebase = fuzzyarm.parse(SINGLETONS.format(second=second)).rulebase
    assert rulebase is not None
    text = write_fcl(rulebase, dialect="jfuzzylogic", lossy=True).text
    assert f"METHOD : {method};" in text


def test_only_some_files_of_fuzzylite_say_which_method_takes_inverses() -> None:
    text = SINGLETONS.format(second="triangle 0 5 10").replace("singleton 1", "ramp 0 10")
    text = text.replace("weighted-average", "tsukamoto").replace("rule if x is H then y is B\n", "")
    rulebase = fuzzyarm.parse(text).rulebase
    assert rulebase is not None
    for suffix, wanted in ((".fll", False), (".fis", True)):
        producer = None if suffix == ".fll" else "fuzzylite"
        messages = [d.message for d in write(rulebase, suffix, producer=producer).diagnostics]
        assert any("is Tsukamoto's if all of its terms" in words for words in messages) == wanted


@pytest.mark.parametrize("name", [":=", ""])
def test_a_term_without_a_name_is_said(name: str) -> None:
    text = (DATA / "pump_jfuzzylogic.fcl").read_text("utf-8")
    errors = parse_fcl(text.replace("TERM low :=", f"TERM {name}", 1)).errors
    assert [d.line for d in errors][:1] == [15]
    assert "the name of a term is expected here" in errors[0].message
