"""scikit-fuzzy as an independent oracle for Mamdani values.

Its control system clips, unites and defuzzifies on the universe it is given, adding the
points where a clipped set bends, and integrates between them exactly. On a universe that
holds all corners its centroid is therefore close to the exact one; where two clipped sets
cross it cuts the corner, which a finer universe makes small. Its rules are folded by max,
its defuzzifier names are centroid, bisector, mom, som and lom.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
import skfuzzy
from skfuzzy import control

from fuzzyarm.inference import infer
from fuzzyarm.language.model.rulebase import Defuzzifier, RuleBase, Shape

pytestmark = pytest.mark.filterwarnings("ignore:Passing more than 2:DeprecationWarning")

POINTS = [(1.3, -2.2), (0.0, 0.0), (-5.7, 3.1), (4.4, 4.9), (2.05, -5.95), (-0.3, -0.2)]


def membership_values(universe: np.ndarray, shape: Shape) -> np.ndarray:
    functions = {"triangle": skfuzzy.trimf, "trapezoid": skfuzzy.trapmf}
    if shape.kind == "gaussian":
        return np.asarray(skfuzzy.gaussmf(universe, *shape.parameters))
    return np.asarray(functions[shape.kind](universe, shape.parameters))


def simulation(rulebase: RuleBase, count: int, method: str) -> Any:
    """The same system in scikit-fuzzy."""
    variables: dict[str, Any] = {}
    for each in (*rulebase.inputs, *rulebase.outputs):
        universe = np.linspace(each.low, each.high, count)
        kind = control.Antecedent if each in rulebase.inputs else control.Consequent
        settings = {} if each in rulebase.inputs else {"defuzzify_method": method}
        variables[each.name] = kind(universe, each.name, **settings)
        for term in each.terms:
            variables[each.name][term.name] = membership_values(universe, term.shape)
    rules = []
    for rule in rulebase.rules:
        first, second = rule.antecedent.operands  # type: ignore[union-attr]
        antecedent = variables[first.variable][first.term] & variables[second.variable][second.term]
        target = rule.consequents[0]
        rules.append(control.Rule(antecedent, variables[target.variable][target.term]))
    return control.ControlSystemSimulation(control.ControlSystem(rules))


def smaller(pd7: RuleBase, kind: str) -> RuleBase:
    """Every third column only: scikit-fuzzy takes seconds for 49 rules."""
    rules = tuple(rule for i, rule in enumerate(pd7.rules) if i % 3 == 0)
    shapes = {
        "triangle": None,
        "trapezoid": [Shape("trapezoid", (p - 2.5, p - 0.5, p + 0.5, p + 1.75)) for p in _peaks()],
        "gaussian": [Shape("gaussian", (p, 0.9)) for p in _peaks()],
    }[kind]

    def terms(variable: Any) -> Any:
        if shapes is None:
            return variable.terms
        return tuple(
            dataclasses.replace(term, shape=shape)
            for term, shape in zip(variable.terms, shapes, strict=True)
        )

    return dataclasses.replace(
        pd7,
        inputs=tuple(dataclasses.replace(each, terms=terms(each)) for each in pd7.inputs),
        outputs=tuple(dataclasses.replace(each, terms=terms(each)) for each in pd7.outputs),
        blocks=(dataclasses.replace(pd7.blocks[0], rules=rules),),
        expectations=(),
    )


def _peaks() -> list[float]:
    return [float(peak) for peak in range(-6, 7, 2)]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["triangle", "trapezoid", "gaussian"])
@pytest.mark.parametrize(
    ("method", "name"),
    [("centroid", "centroid"), ("bisector", "bisector"), ("mean-of-maximum", "mom")],
)
def test_scikit_fuzzy_gives_the_same(pd7: RuleBase, kind: str, method: str, name: str) -> None:
    if method != "centroid" and kind == "gaussian":
        method, name = "largest-of-maximum", "lom"
    rulebase = smaller(pd7, kind)
    exact = dataclasses.replace(
        rulebase,
        outputs=(
            dataclasses.replace(rulebase.outputs[0], defuzzifier=Defuzzifier(method), no_rule=99.0),
        ),
    )
    system = simulation(rulebase, 2401, name)
    compared = 0
    for e, ce in POINTS:
        ours = infer(exact, e=e, ce=ce)["u"]
        if ours == 99.0:
            continue
        system.input["e"], system.input["ce"] = e, ce
        system.compute()
        # Its memberships of inputs are interpolated on the universe, too: 12 / 2400 apart.
        assert system.output["u"] == pytest.approx(ours, abs=6e-3), (e, ce)
        compared += 1
    assert compared >= 4
