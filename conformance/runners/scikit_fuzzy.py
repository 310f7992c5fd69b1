"""scikit-fuzzy: its control systems, as its documentation builds them."""

from __future__ import annotations

import importlib.metadata
from functools import reduce
from typing import Any

import numpy as np
import skfuzzy as fuzz
from protocol import Case, Numbers, demand, demand_type_1, number, serve, stays_within, way_of
from skfuzzy import control

METHODS = {"centroid": "centroid", "bisector": "bisector"}
FINE = 2001  # points of the universe of an input, on which every corner of the suite lies
AND = {"minimum": np.fmin, "product": np.multiply}
OR = {"maximum": np.fmax, "probabilistic sum": lambda a, b: a + b - a * b}


def membership(universe: Any, term: dict[str, Any]) -> Any:
    """Return the array of a term."""
    p, shape = term["parameters"], term["shape"]
    low, high = universe[0], universe[-1]
    if (shape == "triangle" and low <= p[0] and p[2] <= high) or shape == "triangle":
        made = fuzz.trimf(universe, p)
    elif shape == "trapezoid":
        made = fuzz.trapmf(universe, p)
    elif shape == "rectangle":
        made = fuzz.trapmf(universe, [p[0], p[0], p[1], p[1]])
    elif shape in {"ramp", "points"}:
        corners = sorted([(p[0], 0), (p[1], 1)]) if shape == "ramp" else p
        made = np.interp(universe, [x for x, _ in corners], [y for _, y in corners])
    elif shape in {"s", "z", "pi"}:
        made = getattr(fuzz, {"s": "smf", "z": "zmf", "pi": "pimf"}[shape])(universe, *p)
    elif shape == "gaussian":
        made = fuzz.gaussmf(universe, *p)
    elif shape == "bell":
        made = fuzz.gbellmf(universe, p[1], p[2], p[0])
    else:
        demand(shape == "sigmoid", "no values or sums as conclusions")
        made = fuzz.sigmf(universe, *p)
    return made * term.get("height", 1)


def variable(make: Any, name: str, data: dict[str, Any], count: int) -> Any:
    """Return a variable with its terms."""
    made = make(np.linspace(*data["range"], count), name)
    for label, term in data["terms"].items():
        made[label] = membership(made.universe, term)
    return made


def condition(tree: dict[str, Any], inputs: dict[str, Any]) -> Any:
    """Return an antecedent."""
    ((word, parts),) = tree.items()
    if word == "is":
        return inputs[parts[0]][parts[1]]
    demand(word != "very", "no hedges beside not")
    if word == "not":
        return ~condition(parts, inputs)
    listed = [condition(part, inputs) for part in parts]
    return reduce((lambda a, b: a & b) if word == "and" else (lambda a, b: a | b), listed)


def answer(case: Case) -> Numbers:
    """Return what ControlSystemSimulation computes."""
    demand_type_1(case)
    settings = case["settings"]
    method, count, sampling = way_of(case)
    demand(method in METHODS, "no values or sums as conclusions, no such place of the maximum")
    demand(sampling == "joined", "only its own integral of polylines")
    demand(settings["implication"] == "minimum", "strengths cut sets, nothing else")
    demand(settings["aggregation"] == "maximum", "the union of terms is the maximum")
    demand(settings["and"] in AND and settings["or"] in OR, "no function for this norm is at hand")
    demand(settings["no rule"] == "nothing", "no number to be given where no rule fires")
    demand(settings["outside"] == "clamp" or stays_within(case), "inputs are clamped, or refused")
    inputs = {
        name: variable(control.Antecedent, name, data, FINE)
        for name, data in case["inputs"].items()
    }
    outputs = {
        name: variable(control.Consequent, name, data, count or 0)
        for name, data in case["outputs"].items()
    }
    for each in outputs.values():
        each.defuzzify_method = METHODS[method]
    rules = []
    for one in case["rules"]:
        then = [outputs[name][label] % one.get("weight", 1) for name, label in one["then"].items()]
        functions = {"and_func": AND[settings["and"]], "or_func": OR[settings["or"]]}
        rules.append(control.Rule(condition(one["if"], inputs), then, **functions))
    simulation = control.ControlSystemSimulation(control.ControlSystem(rules))
    results: Numbers = []
    for point in case["points"]:
        for name, value in point["inputs"].items():
            simulation.input[name] = value
        simulation.compute()
        results.append({name: number(simulation.output.get(name)) for name in outputs})
    return results


if __name__ == "__main__":
    serve("scikit-fuzzy", importlib.metadata.version("scikit-fuzzy"), answer)
