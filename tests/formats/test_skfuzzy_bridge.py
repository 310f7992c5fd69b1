"""scikit-fuzzy gives the numbers on both sides of the bridge."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
import skfuzzy
from skfuzzy import control

from fuzzyarm.exchange.formats.tables import in_tables
from fuzzyarm.exchange.live.skfuzzy import from_skfuzzy, to_skfuzzy
from fuzzyarm.inference import NoRuleFiredError, infer
from fuzzyarm.language import parse, write
from fuzzyarm.language.model.rulebase import And, Defuzzifier, Hedge, Is, Or, RuleBase, Shape

# scikit-fuzzy calls np.maximum in a way that newer NumPy frowns upon.
pytestmark = pytest.mark.filterwarnings("ignore:Passing more than 2 positional")

STEPS = np.linspace(-1.0, 1.0, 9)


def system(method: str = "centroid") -> control.ControlSystem:
    """A position controller on universes whose points are where the terms cross."""
    error = control.Antecedent(np.linspace(-1, 1, 17), "error")
    rate = control.Antecedent(np.linspace(-1, 1, 17), "rate")
    force = control.Consequent(np.linspace(-10, 10, 41), "force", method)
    for variable in (error, rate):
        variable["neg"] = skfuzzy.trapmf(variable.universe, [-1, -1, -0.5, 0])
        variable["zero"] = skfuzzy.trimf(variable.universe, [-0.5, 0, 0.5])
        variable["pos"] = skfuzzy.trapmf(variable.universe, [0, 0.5, 1, 1])
    force["pull"] = skfuzzy.trimf(force.universe, [-10, -5, 0])
    force["rest"] = skfuzzy.trimf(force.universe, [-5, 0, 5])
    force["push"] = skfuzzy.gaussmf(force.universe, 6, 2)
    rules = [
        control.Rule(error["neg"] & ~rate["pos"], force["push"]),
        control.Rule(error["zero"] | (rate["zero"] & ~(error["neg"] | rate["pos"])), force["rest"]),
        control.Rule(error["pos"] & rate["zero"], (force["pull"] % 0.5)),
        control.Rule(error["pos"] & rate["pos"], force["pull"], and_func=np.multiply),
        control.Rule(rate["neg"], force["rest"] % 0.25),
    ]
    return control.ControlSystem(rules)


def computed(made: control.ControlSystem, **values: float) -> dict[str, float]:
    simulation = control.ControlSystemSimulation(made)
    simulation.inputs(values)
    simulation.compute()
    return {name: float(value) for name, value in simulation.output.items()}


def good(made: Any) -> RuleBase:
    imported = from_skfuzzy(made)
    assert imported.rulebase is not None, imported.diagnostics
    return imported.rulebase


@pytest.mark.parametrize("method", ["centroid", "bisector"])
def test_a_control_system_gives_its_numbers(method: str) -> None:
    """Though terms cross between two points of the universe, and one of them is curved."""
    made = system(method)
    rulebase = good(made)
    for e in STEPS[::2]:
        for r in STEPS[::2]:
            expected = computed(made, error=float(e), rate=float(r)).get("force")
            if expected is None:  # scikit-fuzzy leaves out an output where no rule fires
                with pytest.raises(NoRuleFiredError):
                    infer(rulebase, error=float(e), rate=float(r))
                continue
            found = infer(rulebase, error=float(e), rate=float(r))["force"]
            assert found == pytest.approx(expected, abs=1e-12 * 20)


def test_the_numbers_are_the_same_where_terms_cross_at_points_of_the_universe() -> None:
    x = control.Antecedent(np.linspace(0, 1, 5), "x")
    y = control.Consequent(np.linspace(0, 4, 9), "y")
    x["low"] = skfuzzy.trimf(x.universe, [0, 0, 1])
    x["high"] = skfuzzy.trimf(x.universe, [0, 1, 1])
    y["low"] = skfuzzy.trimf(y.universe, [0, 1, 2])
    y["high"] = skfuzzy.trapmf(y.universe, [2, 3, 4, 4])
    made = control.ControlSystem(
        [control.Rule(x["low"], y["low"]), control.Rule(x["high"], y["high"])]
    )
    rulebase = good(made)
    for value in (0.0, 0.125, 0.4, 0.77, 1.0):
        expected = computed(made, x=value)["y"]
        assert infer(rulebase, x=value)["y"] == pytest.approx(expected, rel=1e-12)


def test_what_comes_over() -> None:
    rulebase = good(system())
    error = rulebase.variable("error")
    assert (error.low, error.high, error.outside) == (-1.0, 1.0, "clamp")
    assert rulebase.outputs[0].defuzzifier == Defuzzifier("centroid", 41, "joined")
    assert rulebase.outputs[0].no_rule == "error"
    pos = Is("rate", "pos")
    assert rulebase.rules[0].antecedent == And(
        (Is("error", "neg"), Is("rate", "pos", (Hedge("not"),)))
    )
    assert isinstance(rulebase.rules[1].antecedent, Or)
    assert rulebase.rules[2].weight == 0.5
    assert [block.conjunction for block in rulebase.blocks] == ["min", "product", "min"]
    assert pos in rulebase.rules[3].antecedent.operands  # type: ignore[union-attr]


def test_shapes_are_recovered() -> None:
    rulebase = good(system())
    shapes = {t.name: t.shape for v in (*rulebase.inputs, *rulebase.outputs) for t in v.terms}
    assert shapes["neg"] == Shape("trapezoid", (-1.0, -1.0, -0.5, 0.0))
    assert shapes["zero"] == Shape("triangle", (-0.5, 0.0, 0.5))
    assert shapes["push"] == Shape("gaussian", (6.0, 2.0))


def test_points_are_kept_where_that_is_asked_for() -> None:
    x = control.Antecedent(np.linspace(-1, 1, 33), "x")
    y = control.Consequent(np.linspace(0, 4, 9), "y")
    x["zero"] = skfuzzy.gaussmf(x.universe, 0.1, 0.3)
    x["pos"] = skfuzzy.trapmf(x.universe, [0, 0.5, 1, 1])
    y["low"] = skfuzzy.sigmf(y.universe, 2, -3)
    made = control.ControlSystem([control.Rule(x["zero"] & x["pos"], y["low"])])
    imported = from_skfuzzy(made)
    assert [d.name for d in imported.diagnostics] == ["between-samples"]
    assert good(made).variable("x").term("zero").shape == Shape("gaussian", (0.1, 0.3))
    kept = from_skfuzzy(made, points=True).rulebase
    assert kept is not None
    assert kept.variable("x").term("zero").shape.parameters[1::2] == tuple(x["zero"].mf)
    assert kept.variable("x").term("pos").shape.kind == "trapezoid"  # straight either way
    assert kept.outputs[0].term("low").shape.kind == "points"


@pytest.mark.parametrize(("count", "kind"), [(33, "gaussian"), (23, "points")])
def test_points_are_kept_where_a_shape_would_differ_by_more_than_one_percent(
    count: int, kind: str
) -> None:
    """Between two points a gaussian is off by (step / deviation)² / 8: 0.54 % and 1.15 %."""
    x = control.Antecedent(np.linspace(-1, 1, count), "x")
    y = control.Consequent(np.linspace(0, 4, 9), "y")
    x["zero"] = skfuzzy.gaussmf(x.universe, 0, 0.3)
    y["low"] = skfuzzy.gaussmf(y.universe, 0, 1)  # its defuzzifier joins the points anyway
    imported = from_skfuzzy(control.ControlSystem([control.Rule(x["zero"], y["low"])]))
    assert imported.rulebase is not None
    assert imported.rulebase.variable("x").term("zero").shape.kind == kind
    assert imported.rulebase.outputs[0].term("low").shape.kind == "gaussian"
    (finding,) = imported.diagnostics
    assert finding.name == "between-samples"
    assert ("these are kept" in finding.message) == (kind == "points")


@pytest.mark.slow
def test_a_rule_base_of_gaussians_is_short() -> None:
    """The sizes of docs/howto/from-scikit-fuzzy.md."""
    names = ["NB", "NM", "NS", "ZE", "PS", "PM", "PB"]
    e = control.Antecedent(np.linspace(-6, 6, 121), "e")
    ce = control.Antecedent(np.linspace(-3, 3, 121), "ce")
    u = control.Consequent(np.linspace(-10, 10, 201), "u")
    for variable, high in ((e, 6), (ce, 3), (u, 10)):
        for i, name in enumerate(names):
            centre, width = -high + high * i / 3, high / 6 * 1.1
            variable[name] = skfuzzy.gaussmf(variable.universe, centre, width)
    rules = [
        control.Rule(e[a] & ce[b], u[names[min(6, max(0, i + j - 3))]])
        for i, a in enumerate(names)
        for j, b in enumerate(names)
    ]
    made = control.ControlSystem(rules)
    short = write(in_tables(good(made)))
    long = from_skfuzzy(made, points=True).rulebase
    assert long is not None
    assert short.count("\n") == 43
    assert round(len(write(in_tables(long))) / 1000) == 114


def test_a_norm_of_ones_own_is_an_error() -> None:
    made = system()
    for rule in made.rules:
        rule.and_func = lambda a, b: np.sqrt(a * b)
    assert "unknown-norm" in {d.name for d in from_skfuzzy(made).errors}


LANGUAGE = """rulebase heater
input  t 0 .. 40
input  d -1 .. 1
output p 0 .. 100
term t cold: trapezoid 0 0 10 20
term t warm: triangle 10 20 30
term t hot: trapezoid 20 30 40 40
term d falling: triangle -1 -1 1
term d rising: triangle -1 1 1
term p off: triangle 0 0 40
term p half: triangle 20 50 80
term p full: triangle 60 100 100
inference and min, or max, implication min
inference p: aggregation max, defuzzifier centroid exact, no-rule error
rule if t is cold and d is falling then p is full
rule if t is cold and d is rising then p is half
rule if t is warm and not (d is rising or d is not falling) then p is half with 0.75
rule if t is hot or (t is warm and d is rising) then p is off
"""


def test_a_rule_base_becomes_a_control_system_with_its_numbers() -> None:
    rulebase = parse(LANGUAGE).rulebase
    assert rulebase is not None
    made, diagnostics = to_skfuzzy(rulebase, samples=401)
    assert not [d for d in diagnostics if d.is_error]
    for t, d in ((0.0, -1.0), (12.5, 0.25), (20.0, 0.0), (27.0, -0.5), (40.0, 1.0)):
        expected = infer(rulebase, t=t, d=d)["p"]
        assert computed(made, t=t, d=d)["p"] == pytest.approx(expected, abs=1e-3)


def test_joined_samples_go_there_and_back() -> None:
    text = LANGUAGE.replace("centroid exact", "centroid(31, joined)")
    rulebase = parse(text).rulebase
    assert rulebase is not None
    made, diagnostics = to_skfuzzy(rulebase, samples=401)
    assert not [d for d in diagnostics if d.is_error]
    for t, d in ((0.0, -1.0), (12.5, 0.25), (20.0, 0.0), (27.0, -0.5), (40.0, 1.0)):
        expected = infer(rulebase, t=t, d=d)["p"]
        assert computed(made, t=t, d=d)["p"] == pytest.approx(expected, abs=1e-10)
    again = good(made)
    assert again.outputs[0].defuzzifier == Defuzzifier("centroid", 31, "joined")
    assert again.outputs[0].terms == rulebase.outputs[0].terms


def test_there_and_back_is_the_same_rules() -> None:
    rulebase = parse(LANGUAGE).rulebase
    assert rulebase is not None
    made, _ = to_skfuzzy(rulebase)
    again = good(made)
    assert {rule.antecedent for rule in again.rules} == {r.antecedent for r in rulebase.rules}


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ("implication min", "implication product", "unsupported-norm"),
        ("aggregation max", "aggregation sum", "unsupported-norm"),
        ("centroid exact", "centroid(101, endpoints)", "sampling"),
        ("is cold and", "is very cold and", "unsupported-hedge"),
        ("triangle 20 50 80", "singleton 50", "unsupported-shape"),
        ("centroid exact", "weighted-average", "unsupported-defuzzifier"),
    ],
)
def test_what_scikit_fuzzy_cannot_say_is_said(old: str, new: str, name: str) -> None:
    rulebase = parse(LANGUAGE.replace(old, new)).rulebase
    assert rulebase is not None
    made, diagnostics = to_skfuzzy(rulebase)
    assert made is None
    assert name in {d.name for d in diagnostics if d.is_error}


def test_formats_import_no_array_library() -> None:
    code = (
        "import sys, fuzzyarm.exchange.formats, fuzzyarm.exchange.live.skfuzzy\n"
        "assert not {'numpy', 'skfuzzy', 'scipy'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def accumulating(norm: Any) -> control.ControlSystem:
    """Three rules of one term, another term with one."""
    x = control.Antecedent(np.linspace(0, 10, 11), "x")
    z = control.Antecedent(np.linspace(0, 10, 11), "z")
    y = control.Consequent(np.linspace(0, 20, 41), "y")
    y.accumulation_method = norm
    x.automf(3)
    z.automf(3)
    y["low"] = skfuzzy.trimf(y.universe, [0, 0, 13])
    y["high"] = skfuzzy.trimf(y.universe, [5, 20, 20])
    rules = [
        control.Rule(x["good"], y["high"]),
        control.Rule(x["average"] & z["good"], y["high"]),
        control.Rule(~z["good"], y["high"]),
        control.Rule(x["poor"], y["low"]),
    ]
    return control.ControlSystem(rules)


@pytest.mark.parametrize("norm", [np.add, lambda a, b: a + b - a * b, np.fmax])
def test_rules_of_a_term_accumulate_by_the_norm_of_its_output(norm: Any) -> None:
    made = accumulating(norm)
    rulebase = good(made)
    assert parse(write(rulebase)).rulebase is not None
    for x in np.linspace(0, 10, 9):
        for z in np.linspace(0, 10, 9):
            expected = computed(made, x=float(x), z=float(z))["y"]
            found = infer(rulebase, x=float(x), z=float(z))["y"]
            assert found == pytest.approx(expected, abs=2e-9), (x, z)


def test_other_accumulations_are_refused() -> None:
    found = from_skfuzzy(accumulating(lambda a, b: 0.5 * a + 0.5 * b))
    assert [d.name for d in found.errors] == ["unsupported-norm"]
