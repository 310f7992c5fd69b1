"""Function blocks as fcl-for-scikit-fuzzy reads them: degrees at points, hedges of those degrees.

The expected degrees come from scikit-fuzzy itself, or from the definitions in IEEE 1855.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import numpy as np
import pytest
import skfuzzy
from skfuzzy import control

from fuzzyarm.exchange.formats import FormatError, Imported, parse_fcl, write_fcl
from fuzzyarm.exchange.live.skfuzzy import from_skfuzzy
from fuzzyarm.language.model.shapes import membership_function

TEXT = """FUNCTION_BLOCK A
VAR_INPUT x : REAL; END_VAR
VAR_OUTPUT y : REAL; END_VAR
FUZZIFY x
 RANGE := (0 .. 11) WITH {step};
 TERM a := {term};
END_FUZZIFY
DEFUZZIFY y
 RANGE := (0 .. 11) WITH 1;
 TERM b := Triangle 0 2 10;
 METHOD : {method};
END_DEFUZZIFY
RULEBLOCK
 RULE 1 : IF x IS {hedge} a THEN y IS {then} b;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""


def read(
    term: str = "Triangle 0 5 15",
    hedge: str = "",
    *,
    step: str = "0.5",
    method: str = "COG",
    then: str = "",
) -> Imported:
    text = TEXT.format(step=step, term=term, hedge=hedge, method=method, then=then)
    return parse_fcl(text, dialect="scikit-fuzzy")


POINTS = np.arange(0, 11, 0.5)


def step_at(x: float, *, falls: bool) -> np.ndarray:
    return (x > POINTS if falls else x <= POINTS).astype(float)


NOTHING = np.zeros(len(POINTS))


@pytest.mark.parametrize(
    ("term", "degrees"),
    [
        ("LEFTLINEAR 7 2", step_at(2, falls=True)),
        ("LEFTLINEAR 5 5", step_at(5, falls=True)),
        ("LEFTLINEAR 2 7", np.clip((7 - POINTS) / 5, 0, 1)),
        ("RIGHTLINEAR 7 2", step_at(2, falls=False)),
        ("RIGHTLINEAR 5 5", step_at(5, falls=False)),
        ("RIGHTLINEAR 2 7", np.clip((POINTS - 2) / 5, 0, 1)),
        ("RAMP 5 5", NOTHING),
        ("RAMP 7 2", np.clip((7 - POINTS) / 5, 0, 1)),
        ("RECTANGLE 7 2", NOTHING),
        ("RECTANGULAR 7 2", NOTHING),
        ("RECTANGULAR 2 7", ((POINTS >= 2) & (POINTS <= 7)).astype(float)),
        ("GAUSSIANPRODUCT 6 1 3 2", skfuzzy.gauss2mf(POINTS, 3, 2, 6, 1)),
        ("GAUSSIANPRODUCT 3 1 6 2", skfuzzy.gauss2mf(POINTS, 3, 1, 6, 2)),
        ("PI 1 3 5 8", skfuzzy.pimf(POINTS, 1, 3, 5, 8)),
        ("pishape 1 3 5 8", skfuzzy.pimf(POINTS, 1, 3, 5, 8)),
        ("S 2 7", skfuzzy.smf(POINTS, 2, 7)),
        ("Z 5 5", step_at(5, falls=True)),
        ("PI 1 3 5 5", skfuzzy.pimf(POINTS, 1, 3, 5, 5.0)),
        ("SINGLETON 4.1", (POINTS == 4).astype(float)),
        ("4.1", (POINTS == 4).astype(float)),
        (
            "LEFTGAUSSIAN 5 2",
            np.where(POINTS <= 5, 1, skfuzzy.gaussmf(POINTS, 5, 2)),
        ),
        (
            "RIGHTGAUSSIAN 5 -2",
            np.where(POINTS >= 5, 1, skfuzzy.gaussmf(POINTS, 5, 2)),
        ),
        ("SIGMOIDDIFFERENCE 3 2 6 2", skfuzzy.dsigmf(POINTS, 3, 2, 6, 2)),
    ],
)
def test_the_degrees_at_the_points_are_those_of_the_program(term: str, degrees: np.ndarray) -> None:
    imported = read(term)
    assert imported.rulebase is not None, imported.errors
    degree = membership_function(imported.rulebase.inputs[0].terms[0].shape)
    assert [degree(float(x)) for x in POINTS] == pytest.approx(list(degrees), abs=1e-12)


@pytest.mark.parametrize(
    ("term", "said"),
    [
        ("TRIANGLE 4 1 8", "refuses corners of a triangle that decrease"),
        ("TRAPEZOID 3 2 1 4", "refuses corners of a trapezoid that decrease"),
        ("S 7 2", "refuses corners of an 's'"),
        ("ZSHAPE 7 2", "refuses corners of a 'z'"),
        ("PI 1 3 9 8", "refuses corners of a pi"),
        ("GAUSS2 6 1 3 2", "refuses a first mean above the second"),
        ("S 5 5", "divides by the width"),
        ("PI 5 5 7 8", "divides by the width"),
        ("SIGMOIDDIFFERENCE 6 2 3 2", "a negative degree to scikit-fuzzy"),
        ("POINTSET 1 2", "'POINTSET' is not known"),
    ],
)
def test_what_the_program_has_no_degrees_for_is_refused(term: str, said: str) -> None:
    (error,) = read(term).errors
    assert said in error.message


def test_a_difference_that_is_hardly_negative_is_a_warning() -> None:
    imported = read("SIGMOIDDIFFERENCE 3 2 6 5")
    assert imported.rulebase is not None
    assert "negative-difference" in {d.name for d in imported.diagnostics}


def test_the_step_of_a_block_is_its_own() -> None:
    text = TEXT.format(step="0.5", term="Triangle 0 5 9", hedge="", method="COG", then="")
    other = text.replace("BLOCK A", "BLOCK B").replace("WITH 0.5", "WITH 4")
    bare = text.replace("BLOCK A", "BLOCK B").replace(" WITH 0.5", "").replace(" WITH 1", "")
    alone = parse_fcl(text, dialect="scikit-fuzzy", block="A").rulebase
    for second in (other, bare):
        both = parse_fcl(text + second, dialect="scikit-fuzzy", block="A").rulebase
        assert both == alone
        block = parse_fcl(text + second, dialect="scikit-fuzzy", block="B").rulebase
        assert block == parse_fcl(second, dialect="scikit-fuzzy").rulebase
    twice = text.replace(
        " RANGE := (0 .. 11) WITH 1;", " RANGE := (0 .. 5) WITH 1; RANGE := (0 .. 11);"
    )
    assert (
        parse_fcl(twice, dialect="scikit-fuzzy").rulebase.outputs[0].defuzzifier.resolution == 1100
    )


@pytest.mark.parametrize("step", ["nan", "inf", "-1", "0"])
def test_a_step_that_is_none_is_an_error(step: str) -> None:
    assert {d.name for d in read(step=step).errors} == {"bad-range"}


@pytest.mark.parametrize("ends", ["-1e308 .. 1e308", "0 .. inf", "nan .. 3", "5 .. 5", "7 .. 2"])
def test_a_range_without_points_is_an_error(ends: str) -> None:
    text = TEXT.format(step="1", term="Triangle 0 5 9", hedge="", method="COG", then="")
    damaged = re.sub(r"\(0 \.\. 11\) WITH \d", f"({ends})", text)
    assert {d.name for d in parse_fcl(damaged, dialect="scikit-fuzzy").errors} == {"bad-range"}


def test_the_mean_of_maximum_is_said_on_both_ways() -> None:
    imported = read(method="MOM", step="1")
    assert "mean-of-maximum" in {d.name for d in imported.diagnostics}
    assert {d.name for d in read(method="LM").diagnostics} == {"assumed-producer"}
    assert {d.name for d in read(method="COA").diagnostics} == {"assumed-producer"}
    live = from_skfuzzy(simulated(lambda a: a, step=1.0, method="mom").ctrl)
    assert [d.name for d in live.diagnostics] == ["mean-of-maximum"]


# --- Hedges ---


def simulated(
    hedge: Callable[[np.ndarray], np.ndarray], *, step: float, method: str = "centroid"
) -> control.ControlSystemSimulation:
    x = control.Antecedent(np.arange(0, 11, step), "x")
    y = control.Consequent(np.arange(0, 11, 1.0), "y", defuzzify_method=method)
    x["a"] = hedge(skfuzzy.trimf(x.universe, [0, 5, 15]))
    y["b"] = skfuzzy.trimf(y.universe, [0, 2, 10])
    return control.ControlSystemSimulation(control.ControlSystem([control.Rule(x["a"], y["b"])]))


def intensified(degrees: np.ndarray) -> np.ndarray:
    return np.where(degrees <= 0.5, 2 * degrees**2, 1 - 2 * (1 - degrees) ** 2)


def seldom(degrees: np.ndarray) -> np.ndarray:
    return np.where(degrees <= 0.5, np.sqrt(degrees / 2), 1 - np.sqrt((1 - degrees) / 2))


def slightly(degrees: np.ndarray) -> np.ndarray:
    both = np.minimum(degrees**1.25, 1 - degrees**2)
    return intensified(both / both.max())


def beside(degrees: np.ndarray, *, above: bool) -> np.ndarray:
    places = np.arange(len(degrees))
    top = degrees.argmax()
    return np.where(places >= top if above else places < top, 1 - degrees, 0)


HEDGES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "VERY": lambda d: d**2,
    "SOMEWHAT": np.sqrt,
    "EXTREMELY": lambda d: d**3,
    "INTENSIFY": intensified,
    "SELDOM": seldom,
    "MORE_OR_LESS": np.cbrt,
    "PLUS": lambda d: d**1.25,
    "NORM": lambda d: d / d.max(),
    "SLIGHTLY": slightly,
    "ABOVE": lambda d: beside(d, above=True),
    "BELOW": lambda d: beside(d, above=False),
    "NOT VERY": lambda d: 1 - d**2,
    "VERY NOT": lambda d: (1 - d) ** 2,
    "NOT": lambda d: 1 - d,
    "VERY ABOVE": lambda d: beside(d, above=True) ** 2,
}


@pytest.mark.parametrize("hedge", HEDGES)
@pytest.mark.parametrize("step", [5.0, 0.5])
def test_hedges_act_on_the_degrees_at_the_points(hedge: str, step: float) -> None:
    imported = read(hedge=hedge, step=str(step))
    assert imported.rulebase is not None, imported.errors
    simulation = simulated(HEDGES[hedge], step=step)
    for value in (1.5, 3.0, 4.3, 6.2, 8.75):
        simulation.input["x"] = value
        try:
            simulation.compute()
            expected: Sequence[float] = [simulation.output["y"]]
        except (KeyError, ValueError):
            continue  # the rule does not fire
        # Where hedge and lines differ by less than a hundredth the hedge stays a hedge.
        assert imported.rulebase(x=value)["y"] == pytest.approx(expected[0], abs=0.03), value


def test_a_coarse_step_is_exact_and_a_fine_one_keeps_the_hedge() -> None:
    coarse, fine = read(hedge="VERY", step="5").rulebase, read(hedge="VERY", step="0.1").rulebase
    assert [term.name for term in coarse.inputs[0].terms] == ["a", "very_a"]
    assert [term.name for term in fine.inputs[0].terms] == ["a"]
    simulation = simulated(HEDGES["VERY"], step=5.0)
    simulation.input["x"] = 1.5
    simulation.compute()
    assert coarse(x=1.5)["y"] == pytest.approx(simulation.output["y"], rel=1e-12)


def test_a_conclusion_fails_at_not_alone() -> None:
    assert "fails at a conclusion with NOT alone" in read(then="NOT").errors[0].message
    assert read(then="NOT VERY").rulebase is not None
    assert "slightly_b" in {term.name for term in read(then="SLIGHTLY").rulebase.outputs[0].terms}


def test_it_is_not_written_for_this_program() -> None:
    rulebase = read().rulebase
    with pytest.raises(FormatError, match=r"not written for 'scikit-fuzzy' \(known: jfuzzylogic"):
        write_fcl(rulebase, dialect="scikit-fuzzy")
