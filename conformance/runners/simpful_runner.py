"""simpful: its fuzzy systems, rules as text."""

from __future__ import annotations

import importlib.metadata
import warnings
from typing import Any

import simpful as sf
from protocol import Case, Numbers, demand, demand_type_1, number, serve, stays_within, way_of

AND = {"minimum": "AND", "product": "AND_p"}
OR = {"maximum": "OR", "probabilistic sum": "OR_p"}
AGGREGATIONS = {
    "maximum": max,
    "sum": sum,
    "probabilistic sum": sf.probor if hasattr(sf, "probor") else None,
}


def fuzzy_set(label: str, term: dict[str, Any]) -> Any:
    """Return a set."""
    p, shape = term["parameters"], term["shape"]
    demand("height" not in term, "no heights of sets")
    if shape == "triangle":
        return sf.TriangleFuzzySet(*p, label)
    if shape == "trapezoid":
        return sf.TrapezoidFuzzySet(*p, label)
    if shape in {"ramp", "points"}:
        corners = sorted([[p[0], 0], [p[1], 1]]) if shape == "ramp" else p
        return sf.FuzzySet(points=corners, term=label)
    if shape == "gaussian":
        return sf.GaussianFuzzySet(*p, label)
    if shape == "sigmoid":
        return sf.SigmoidFuzzySet(*p, label)
    if shape == "rectangle":
        return sf.CrispSet(*p, label)
    demand(False, f"no shape like {shape}, but for functions of one's own")
    return None


def text(tree: dict[str, Any], settings: dict[str, Any]) -> str:
    """Return a condition as text."""
    ((word, parts),) = tree.items()
    if word == "is":
        return f"({parts[0]} IS {parts[1]})"
    demand(word != "very", "no hedges beside NOT")
    if word == "not":
        return f"(NOT {text(parts, settings)})"
    names = AND if word == "and" else OR
    demand(settings[word] in names, "and is min or product, or is max or the probabilistic sum")
    said = text(parts[0], settings)
    for part in parts[1:]:
        said = f"({said} {names[settings[word]]} {text(part, settings)})"
    return said


def answer(case: Case) -> Numbers:
    """Return what Mamdani_inference or Sugeno_inference computes."""
    demand_type_1(case)
    settings = case["settings"]
    method, count, sampling = way_of(case)
    demand(settings["outside"] == "extend" or stays_within(case), "inputs are used as they are")
    values = method == "weighted average"
    if values:
        demand(settings["aggregation"] == "sum", "rules that share a value are added up")
    else:
        demand(method == "centroid", "the centroid, or the weighted average")
        demand(sampling == "endpoints", "sums with both ends")
        demand(settings["implication"] == "minimum", "strengths cut sets, nothing else")
        demand(
            AGGREGATIONS.get(settings["aggregation"]) is not None, "max, sum or probor unite sets"
        )
    system = sf.FuzzySystem(show_banner=False)
    for name, data in case["inputs"].items():
        sets = [fuzzy_set(label, term) for label, term in data["terms"].items()]
        system.add_linguistic_variable(
            name, sf.LinguisticVariable(sets, universe_of_discourse=data["range"])
        )
    for name, data in case["outputs"].items():
        if not values:
            sets = [fuzzy_set(label, term) for label, term in data["terms"].items()]
            system.add_linguistic_variable(
                name, sf.LinguisticVariable(sets, universe_of_discourse=data["range"])
            )
            continue
        for label, term in data["terms"].items():
            if term["shape"] == "constant":
                system.set_crisp_output_value(label, term["parameters"][0])
            else:
                parts = [f"{c} * {v}" if v else f"{c}" for v, c in term["parameters"].items()]
                system.set_output_function(label, " + ".join(parts))
    for one in case["rules"]:
        for name, label in one["then"].items():
            weight = f" WEIGHT {one['weight']}" if "weight" in one else ""
            system.add_rules([f"IF {text(one['if'], settings)} THEN ({name} IS {label}){weight}"])
    results: Numbers = []
    for point in case["points"]:
        for name, value in point["inputs"].items():
            system.set_variable(name, value)
        if values:
            said = system.Sugeno_inference()
        else:
            said = system.Mamdani_inference(
                subdivisions=count, aggregation_function=AGGREGATIONS[settings["aggregation"]]
            )
        results.append({name: number(said[name]) for name in case["outputs"]})
    return results


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    serve("simpful", importlib.metadata.version("simpful"), answer)
