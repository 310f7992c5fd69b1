"""Live objects of other libraries give their own numbers as rule bases.

scikit-fuzzy, simpful and fuzzylogic are asked themselves; of pyfuzzylite there is a stand-in, and
itself where it is installed.
"""

from __future__ import annotations

import sys
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyit2fls
import pytest
import simpful
import skfuzzy
from fuzzylogic.classes import Domain, Rule
from fuzzylogic.functions import R, S, gauss, rectangular, triangular
from fuzzylogic.hedges import minus, very
from needs import requires
from skfuzzy import control

import fuzzyarm
from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.exchange.formats.comparison import compare, comparison_points
from fuzzyarm.exchange.live.objects import read_object
from fuzzyarm.exchange.live.simpful import from_simpful
from fuzzyarm.language import write
from fuzzyarm.language.model.rulebase import Defuzzifier, Shape
from fuzzyarm.language.model.shapes import membership

STAND_IN = Path(__file__).parent / "stand_in"


def mamdani() -> Any:
    system = simpful.FuzzySystem(show_banner=False)
    air = simpful.AutoTriangle(3, terms=["low", "medium", "high"], universe_of_discourse=[0, 10])
    system.add_linguistic_variable("air", air)
    sets = [
        simpful.GaussianFuzzySet(1, 2, "near"),
        simpful.InvGaussianFuzzySet(1, 2, "far"),
        simpful.InvSigmoidFuzzySet(2, 3, "below"),
        simpful.DoubleGaussianFuzzySet(1, 0.5, 3, 1, "some"),
        simpful.FuzzySet(function=lambda x: min(1, max(0, 1 - abs(x - 3) / 2)), term="own"),
        simpful.FuzzySet(points=[[1, 0.2], [2, 1], [4, 0]], term="bent"),
        simpful.CrispSet(2.5, 4, "crisp"),
    ]
    variable = simpful.LinguisticVariable(sets, universe_of_discourse=[0, 5])
    system.add_linguistic_variable("sugar", variable)
    out = [
        simpful.TrapezoidFuzzySet(0, 0, 10, 20, "little"),
        simpful.TriangleFuzzySet(10, 20, 40, "more"),
        simpful.TrapezoidFuzzySet(20, 30, 50, 50, "much"),
    ]
    system.add_linguistic_variable(
        "out", simpful.LinguisticVariable(out, concept="grams", universe_of_discourse=[0, 50])
    )
    system.add_rules(
        [
            "IF (air IS low) AND (NOT (sugar IS near)) THEN (out IS little) WEIGHT 0.5",
            "IF (sugar IS own) AND ((air IS medium) OR (sugar IS below)) THEN (out IS more)",
            "IF (air IS high) AND (sugar IS far) THEN (out IS much)",
            "IF (sugar IS some) AND_p (sugar IS bent) THEN (out IS more)",
            "IF (sugar IS crisp) THEN (out IS much)",
        ]
    )
    return system


def sugeno() -> Any:
    system = simpful.FuzzySystem(operators=["AND_PRODUCT"], show_banner=False)
    for name in ("a", "b"):
        sets = [
            simpful.FuzzySet(points=[[0, 1], [4, 0]], term="no"),
            simpful.FuzzySet(points=[[0, 0], [4, 1]], term="yes"),
        ]
        variable = simpful.LinguisticVariable(sets, universe_of_discourse=[0, 4])
        system.add_linguistic_variable(name, variable)
    system.set_crisp_output_value("two", 2)
    system.set_output_function("line", "2 * a - b / 4 + 1")
    system.set_output_function("curve", "a * b ** 2 + abs(a - 3)")
    system.add_rules(
        [
            "IF (a IS no) AND (b IS no) THEN (y IS two) WEIGHT 0.5",
            "IF (a IS no) AND (b IS yes) THEN (y IS line)",
            "IF (a IS yes) AND (b IS no) THEN (y IS two)",
            "IF (a IS yes) AND (b IS yes) THEN (y IS curve)",
        ]
    )
    return system


def fan() -> Any:
    temp, hum = Domain("temp", -20, 40, res=0.1), Domain("hum", 0, 100)
    speed = Domain("speed", 0, 2000, res=5)
    temp.cold, temp.hot, temp.mild = S(0, 15), R(10, 30), triangular(5, 25)
    hum.dry, hum.wet, hum.about = S(20, 50), R(40, 70), gauss(45, 0.01)
    hum.box = rectangular(30.5, 50)
    speed.slow, speed.middle, speed.fast = S(250, 750), triangular(500, 1200), R(1000, 1500)
    return Rule(
        {
            (temp.hot, hum.dry): speed.slow,
            (very(temp.cold), hum.dry): speed.fast,
            (~temp.mild, hum.wet): speed.middle,
            (minus(temp.hot), hum.about): speed.fast,
            (temp.hot & temp.mild, hum.box): speed.fast,
        }
    )


def tank() -> Any:
    level = control.Antecedent(np.linspace(0, 10, 41), "level")
    rate = control.Antecedent(np.arange(-1, 1.25, 0.25), "rate")
    valve = control.Consequent(np.linspace(-1, 1, 33), "valve")
    level["low"] = skfuzzy.trimf(level.universe, [0, 0, 7.5])
    level["high"] = skfuzzy.trapmf(level.universe, [2, 6, 10, 10])
    rate.automf(3)
    for name, centre in (("close", -0.8), ("keep", 0.1), ("open", 0.7)):
        valve[name] = skfuzzy.gaussmf(valve.universe, centre, 0.3)
    return control.ControlSystem(
        [
            control.Rule(level["low"] & rate["poor"], valve["open"]),
            control.Rule(level["high"] & ~rate["good"], (valve["keep"] % 0.5)),
            control.Rule(level["high"] | rate["good"], valve["close"], and_func=np.multiply),
        ]
    )


def type_2(
    t_norm: Any = pyit2fls.product_t_norm,
    s_norm: Any = pyit2fls.max_s_norm,
    method: str = "Centroid",
    algorithm: str = "KM",
) -> Any:
    around, points = np.linspace(-1, 1, 51), np.linspace(0, 10, 101)
    system = pyit2fls.IT2Mamdani(t_norm, s_norm, method=method, algorithm=algorithm)
    sets = (
        pyit2fls.IT2FS(around, pyit2fls.trapezoid_mf, [-2, -1, -0.5, 0.4, 1],
                       pyit2fls.trapezoid_mf, [-2, -1, -0.6, 0.2, 0.9]),
        pyit2fls.IT2FS_Gaussian_UncertStd(around, [0, 0.4, 0.3, 1]),
        pyit2fls.IT2FS(around, pyit2fls.ltri_mf, [-0.2, 0.8, 1], lower_half, []),
    )  # fmt: skip
    ends = (
        pyit2fls.IT2FS(points, pyit2fls.tri_mf, [0, 2, 5, 1], pyit2fls.tri_mf, [1, 2, 4, 0.9]),
        pyit2fls.IT2FS_Gaussian_UncertStd(points, [5, 1.5, 0.4, 0.9]),
        pyit2fls.IT2FS(points, pyit2fls.gbell_mf, [1, 2, 8, 1], pyit2fls.gbell_mf, [0.8, 2, 8, 1]),
    )
    for name in ("a", "b"):
        system.add_input_variable(name)
    system.add_output_variable("z")
    for i, one in enumerate(sets):
        for j, other in enumerate(sets):
            system.add_rule([("a", one), ("b", other)], [("z", ends[(i + j) % 3])])
    return system


def lower_half(x: Any, _parameters: Any) -> Any:
    return np.minimum(0.5, np.maximum(0.0, x / 2))


def type_2_sums() -> Any:
    system = pyit2fls.IT2TSK(pyit2fls.min_t_norm, pyit2fls.max_s_norm)
    around = np.linspace(-1, 1, 51)
    sets = (
        pyit2fls.IT2FS(around, pyit2fls.rtri_mf, [1, -1, 1], pyit2fls.rtri_mf, [0.8, -1, 0.9]),
        pyit2fls.IT2FS(around, pyit2fls.ltri_mf, [-1, 1, 1], pyit2fls.ltri_mf, [-0.8, 1, 0.9]),
    )
    for name in ("x", "y"):
        system.add_input_variable(name)
    for name in ("u", "v"):
        system.add_output_variable(name)
    for i, one in enumerate(sets):
        for j, other in enumerate(sets):
            sums = {"const": i - j, "x": 1.0 + i, "y": 0.5 * j}
            constant = {"const": 2.0 * i + j, "x": 0.0, "y": 0.0}
            system.add_rule([("x", one), ("y", other)], [("u", sums), ("v", constant)])
    return system


MAKERS = {
    "mamdani": mamdani,
    "sugeno": sugeno,
    "fan": fan,
    "tank": tank,
    "type_2": type_2,
    "type_2_eiasc": lambda: type_2(algorithm="EIASC"),
    "type_2_nie_tan": lambda: type_2(algorithm="NT"),
    "type_2_bounded": lambda: type_2(pyit2fls.lukasiewicz_t_norm, pyit2fls.bounded_sum_s_norm),
    "type_2_sums": type_2_sums,
}


@pytest.fixture
def stand_in(monkeypatch: pytest.MonkeyPatch) -> Any:
    for name in [each for each in sys.modules if each.partition(".")[0] == "fuzzylite"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.syspath_prepend(str(STAND_IN))
    import fuzzylite

    yield fuzzylite
    for name in [each for each in sys.modules if each.partition(".")[0] == "fuzzylite"]:
        monkeypatch.delitem(sys.modules, name, raising=False)


@pytest.mark.filterwarnings("ignore:Passing more than 2 positional")
@pytest.mark.parametrize("name", MAKERS)
def test_the_numbers_are_those_of_the_library(name: str) -> None:
    """`from_live` warns of any difference beyond 1e-9 of the range."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", fuzzyarm.FileWarning)
        rulebase = fuzzyarm.from_live(MAKERS[name](), name)
    assert fuzzyarm.parse(write(rulebase)).rulebase == rulebase


@pytest.mark.slow
def test_what_the_libraries_take_for_granted_is_written_out() -> None:
    read = {name: read_object(make(), name).rulebase for name, make in MAKERS.items()}
    texts = {name: write(rulebase) for name, rulebase in read.items() if rulebase is not None}
    assert "defuzzifier centroid(1000, endpoints), no-rule 0" in texts["mamdani"]
    assert "terms air: triangles low medium high" in texts["mamdani"]
    assert "if air is high and sugar is not 'complement of far'" in texts["mamdani"]
    assert "aggregation sum, defuzzifier weighted-average, no-rule 0" in texts["sugeno"]
    assert "term y line:       linear 2*a - 0.25*b + 1" in texts["sugeno"]
    assert "temp is very cold" in texts["fan"]
    assert "temp is not mild" in texts["fan"]
    assert "temp is power(0.75) hot" in texts["fan"]
    assert "term hum box:    rectangle 30.5 50" in texts["fan"]
    assert "defuzzifier centroid(33, joined), no-rule error" in texts["tank"]


def test_sets_of_type_2_keep_both_functions() -> None:
    rulebase = read_object(type_2(), "z").rulebase
    assert rulebase is not None
    first, second, third = rulebase.inputs[0].terms
    assert (first.shape.kind, first.lower.kind) == ("trapezoid", "trapezoid")
    assert (second.shape.kind, second.lower.kind) == ("gaussian", "gaussian")
    assert (third.shape.kind, third.lower.kind, third.lower.height) == ("ramp", "ramp", 0.5)
    assert rulebase.outputs[0].defuzzifier == Defuzzifier("karnik-mendel", 101, "endpoints")
    assert read_object(type_2_sums(), "z").rulebase.outputs[1].terms[3].shape.parameters == (3.0,)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"algorithm": "WM"}, "the algorithm 'WM_algorithm' is not supported"),
        ({"method": "CoSet"}, "the type reduction 'CoSet' is not supported"),
        ({"t_norm": lambda a, *others: a}, "the norm '<lambda>' is not supported"),
    ],
)
def test_what_pyit2fls_alone_has_is_refused_by_name(options: Any, said: str) -> None:
    assert [d.message.partition(";")[0] for d in read_object(type_2(**options)).errors] == [said]


@pytest.mark.slow
def test_a_function_without_a_shape_is_taken_at_points_and_the_size_is_said() -> None:
    system = type_2()
    two = pyit2fls.IT2FS_Gaussian_UncertMean(np.linspace(-1, 1, 51), [0, 0.4, 0.3, 1])
    system.add_rule([("a", two)], system.rules[0][1])
    imported = read_object(system, "z")
    assert imported.rulebase.inputs[0].terms[3].shape.kind == "two-sided-gaussian"
    assert imported.rulebase.inputs[0].terms[3].lower.kind == "points"
    assert "(gauss_uncert_mean_lmf) is taken at 1001 points" in imported.diagnostics[0].message
    with (
        pytest.warns(fuzzyarm.FileWarning, match="1001 points"),
        pytest.warns(fuzzyarm.FileWarning, match=r"'z' differs by up to \d(\.\d)?e-0[5-7] of its"),
    ):
        fuzzyarm.from_live(system)


def test_a_wrong_algorithm_of_pyit2fls_is_told_by_the_size_of_its_difference() -> None:
    with pytest.warns(fuzzyarm.FileWarning, match=r"'z' differs by up to 0\.00"):
        fuzzyarm.from_live(type_2(algorithm="EKM"))


def test_rules_of_pyit2fls_that_cannot_be_carried() -> None:
    system = type_2()
    known = system.rules[0]
    system.rules = [([("w", known[0][0][1])], known[1]), ([], known[1]), (known[0], [])]
    found = {d.name for d in read_object(system).errors}
    assert found == {"undefined-variable", "empty-rule"}
    system.rules = []
    assert {d.name for d in read_object(system).errors} == {"no-rules"}


def test_an_engine_is_read_through_its_own_exporter(stand_in: Any) -> None:
    engine = stand_in.Engine("ramp", slope=1 / 3)
    rulebase = fuzzyarm.from_live(engine)
    assert rulebase.name == "ramp"
    assert rulebase.outputs[0].term("all").shape.parameters == (1 / 3,)  # more than three decimals
    assert (stand_in.settings.decimals, stand_in.settings.atol) == (3, 1e-3)


@pytest.mark.parametrize(
    ("error", "severity"), [(1e-12, "info"), (1e-3, "warning"), (0.1, "error")]
)
def test_the_size_of_a_difference_is_said(stand_in: Any, error: float, severity: str) -> None:
    engine = stand_in.Engine("ramp", slope=2.0, error=error)
    if severity == "error":
        with pytest.raises(RuleBaseError, match=r"differs by up to 0\.05 of its range"):
            fuzzyarm.from_live(engine)
    elif severity == "warning":
        with pytest.warns(fuzzyarm.FileWarning, match=r"differs by up to 0\.0005 of its range"):
            fuzzyarm.from_live(engine)
    else:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            fuzzyarm.from_live(engine)


@requires("pyfuzzylite")
def test_pyfuzzylite_itself() -> None:
    names: dict[str, Any] = {}
    script = Path(__file__).parents[2] / "examples/elsewhere/blinds_pyfuzzylite.py"
    exec(script.read_text(), names)
    with warnings.catch_warnings():
        warnings.simplefilter("error", fuzzyarm.FileWarning)
        assert fuzzyarm.from_live(names["engine"]).name == "blinds"


def test_a_value_where_there_should_be_none_is_said() -> None:
    rulebase = fuzzyarm.from_live(sugeno(), "sugeno")
    points = comparison_points(rulebase)
    found = compare(rulebase, [(point, {}) for point in points], "simpful")
    assert [(d.name, d.severity) for d in found] == [
        ("numbers-differ", "error"),
        ("same-numbers", "info"),
    ][: len(found)]
    assert "has a value only here at 100 of 100 points" in found[0].message


def test_a_library_that_raises_leaves_nothing_to_compare() -> None:
    rulebase = fuzzyarm.from_live(sugeno(), "sugeno")
    found = compare(rulebase, [(p, None) for p in comparison_points(rulebase)], "simpful")
    assert {d.name for d in found} == {"not-compared"}


def broken(change: Any) -> set[str]:
    system = change(mamdani())
    return {d.name for d in read_object(system).diagnostics if d.is_error}


def with_rules(*rules: str) -> Any:
    def change(system: Any) -> Any:
        system._rules = []
        system.add_rules(list(rules))
        return system

    return change


@pytest.mark.parametrize(
    ("rule", "name"),
    [
        ("IF (air IS lowe) THEN (out IS little)", "undefined-term"),
        ("IF (air IS low) THEN (out IS litle)", "undefined-term"),
        ("IF (wind IS low) THEN (out IS little)", "undefined-variable"),
        ("IF (air IS low) THEN (oud IS little)", "undefined-variable"),
        ("IF (out IS much) THEN (out IS little)", "chained-output"),
        ("IF () THEN (out IS little)", "empty-rule"),
        ("IF (air IS low) XOR (air IS high) THEN (out IS little)", "unknown-norm"),
        (
            "IF (air IS low) AND ((air IS low) AND_p (air IS high)) THEN (out IS much)",
            "mixed-norms",
        ),
    ],
)
def test_rules_of_simpful_that_cannot_be_carried(rule: str, name: str) -> None:
    assert name in broken(with_rules(rule))


def test_a_misspelt_term_has_a_hint() -> None:
    system = with_rules("IF (air IS hihg) THEN (out IS much)")(mamdani())
    (found,) = read_object(system).errors
    assert "did you mean 'high'" in found.hint


def test_nothing_to_convert() -> None:
    with pytest.raises(TypeError, match=r"builtins\.dict is not a system of scikit-fuzzy"):
        fuzzyarm.from_live({})
    assert broken(with_rules()) == {"no-rules"}
    empty = read_object(control.ControlSystem())
    assert {d.name for d in empty.errors} == {"no-rules"}
    half_made = simpful.FuzzySystem(show_banner=False)
    del half_made._rules
    assert {d.name for d in read_object(half_made).errors} == {"unreadable-object"}


def test_a_rule_of_fuzzylogic_with_two_targets() -> None:
    temp, one, other = Domain("temp", 0, 1), Domain("one", 0, 1), Domain("other", 0, 1)
    temp.hot = temp.cold = R(0, 1)
    temp.cold, one.big, other.big = S(0, 1), R(0, 1), R(0, 1)
    rule = Rule({(temp.hot,): one.big, (temp.cold,): other.big})
    assert [d.name for d in read_object(rule).errors] == ["rule-too-rich"]


def test_points_cover_the_ranges_and_what_is_beside_them() -> None:
    rulebase = fuzzyarm.from_live(sugeno(), "sugeno")
    points = comparison_points(rulebase)
    values = np.array([[p["a"], p["b"]] for p in points])
    assert len(points) == 100
    assert {(0.0, 0.0), (4.0, 0.0), (0.0, 4.0), (4.0, 4.0), (2.0, 2.0)} <= set(map(tuple, values))
    assert values.min() < 0.0
    assert values.max() > 4.0
    inside = values[(values > 0.0).all(axis=1) & (values < 4.0).all(axis=1)]
    cells = {tuple(row) for row in (inside // 1.0).astype(int)}
    assert len(cells) == 16
    assert SimpleNamespace(**points[0]).a == 0.0


def test_points_of_simpful_go_on_at_their_boundary_values() -> None:
    sets = [
        simpful.FuzzySet(points=[[1, 1], [2, 0.4], [4, 0.2]], boundary_values=[0, 0.4], term="a"),
        simpful.FuzzySet(points=[[1, 0.2], [2, 0.7], [4, 0.2]], boundary_values=[0.7, 0], term="b"),
        simpful.SingletonsSet(pairs=[[3, 0.8]], term="one"),
        simpful.SingletonsSet(pairs=[[1, 0.5], [3, 0.8]], term="two"),  # which no shape is
    ]
    system = simpful.FuzzySystem(show_banner=False)
    system.add_linguistic_variable(
        "x", simpful.LinguisticVariable(sets, universe_of_discourse=[0, 6])
    )
    system.set_crisp_output_value("two", 2)
    system.add_rules([f"IF (x IS {name}) THEN (y IS two)" for name in ("a", "b", "one", "two")])
    rulebase = from_simpful(system, "points").rulebase
    assert rulebase is not None
    shapes = {term.name: term.shape for term in rulebase.inputs[0].terms}
    assert shapes["one"] == Shape("singleton", (3.0,), 0.8)
    for each in sets[:2]:
        for x in (0.0, 0.9, 1.0, 1.3, 2.0, 3.5, 4.0, 4.1, 6.0):
            assert membership(shapes[each._term], x) == pytest.approx(each.get_value(x)), x
