"""pyfuzzylite: its engines.

It is under the GPL and needs NumPy below 2, so `fuzzylite_env.py` gives it an environment of its own.
"""

from __future__ import annotations

from typing import Any

import fuzzylite as fl
from protocol import Case, Numbers, demand, demand_type_1, number, serve, stays_within, way_of

T_NORMS = {
    "minimum": fl.Minimum, "product": fl.AlgebraicProduct, "lukasiewicz": fl.BoundedDifference,
    "drastic": fl.DrasticProduct, "hamacher": fl.HamacherProduct, "einstein": fl.EinsteinProduct,
    "nilpotent": fl.NilpotentMinimum,
}  # fmt: skip
S_NORMS = {
    "maximum": fl.Maximum, "probabilistic sum": fl.AlgebraicSum, "lukasiewicz": fl.BoundedSum,
    "drastic": fl.DrasticSum, "hamacher": fl.HamacherSum, "einstein": fl.EinsteinSum,
    "nilpotent": fl.NilpotentMaximum, "sum": fl.UnboundedSum,
}  # fmt: skip
METHODS = {
    "centroid": fl.Centroid, "bisector": fl.Bisector, "mean of maxima": fl.MeanOfMaximum,
    "smallest of maxima": fl.SmallestOfMaximum, "largest of maxima": fl.LargestOfMaximum,
}  # fmt: skip
WEIGHTED = {
    "weighted average": lambda: fl.WeightedAverage("TakagiSugeno"),
    "weighted sum": lambda: fl.WeightedSum("TakagiSugeno"),
    "tsukamoto": lambda: fl.WeightedAverage("Tsukamoto"),
}


def fuzzy_set(label: str, term: dict[str, Any], inputs: list[str]) -> Any:
    """Return a term."""
    p, shape = term["parameters"], term["shape"]
    if shape == "constant":
        return fl.Constant(label, *p)
    if shape == "linear":
        return fl.Linear(label, [*(p.get(name, 0.0) for name in inputs), p.get("", 0.0)])
    kinds = {
        "triangle": fl.Triangle, "trapezoid": fl.Trapezoid, "rectangle": fl.Rectangle, "ramp": fl.Ramp,
        "s": fl.SShape, "z": fl.ZShape, "pi": fl.PiShape, "gaussian": fl.Gaussian, "bell": fl.Bell,
        "sigmoid": fl.Sigmoid,
    }  # fmt: skip
    height = float(term.get("height", 1))
    if shape == "points":
        return fl.Discrete(label, [float(n) for corner in p for n in corner], height=height)
    return kinds[shape](label, *map(float, p), height=height)


def condition(tree: dict[str, Any], inner: bool = False) -> str:
    """Return a condition as text."""
    ((word, parts),) = tree.items()
    hedges = []
    while word in {"not", "very"}:
        hedges.append(word)
        ((word, parts),) = parts.items()
    if word == "is":
        return f"{parts[0]} is {' '.join([*hedges, parts[1]])}"
    demand(not hedges, "hedges stand before a term")
    said = f" {word} ".join(condition(part, inner=True) for part in parts)
    return f"( {said} )" if inner else said


def answer(case: Case) -> Numbers:
    """Return what Engine.process computes."""
    demand_type_1(case)
    settings = case["settings"]
    method, count, sampling = way_of(case)
    if method in WEIGHTED:
        defuzzifier = WEIGHTED[method]()
    else:
        demand(method in METHODS, "no such place of the maximum")
        demand(sampling == "midpoints", "sums over midpoints")
        defuzzifier = METHODS[method](count)
    outside = settings["outside"] == "clamp"
    names = list(case["inputs"])
    variables = [
        fl.InputVariable(
            name=name, minimum=float(data["range"][0]), maximum=float(data["range"][1]),
            lock_range=outside and not stays_within(case),
            terms=[fuzzy_set(label, term, names) for label, term in data["terms"].items()],
        )
        for name, data in case["inputs"].items()
    ]  # fmt: skip
    default = settings["no rule"]
    outputs = [
        fl.OutputVariable(
            name=name, minimum=float(data["range"][0]), maximum=float(data["range"][1]),
            aggregation=S_NORMS[settings["aggregation"]](), defuzzifier=defuzzifier,
            default_value=fl.nan if default == "nothing" else float(default),
            terms=[fuzzy_set(label, term, names) for label, term in data["terms"].items()],
        )
        for name, data in case["outputs"].items()
    ]  # fmt: skip
    rules = []
    for one in case["rules"]:
        then = " and ".join(f"{name} is {label}" for name, label in one["then"].items())
        weight = f" with {one['weight']:.6f}" if "weight" in one else ""
        rules.append(fl.Rule.create(f"if {condition(one['if'])} then {then}{weight}"))
    block = fl.RuleBlock(
        name="", conjunction=T_NORMS[settings["and"]](), disjunction=S_NORMS[settings["or"]](),
        implication=T_NORMS[settings["implication"]](), activation=fl.General(), rules=rules,
    )  # fmt: skip
    engine = fl.Engine(
        name="case", input_variables=variables, output_variables=outputs, rule_blocks=[block]
    )
    for output in engine.output_variables:
        for term in output.terms:
            if isinstance(term, fl.Linear):
                term.engine = engine
    for rule in block.rules:
        rule.load(engine)
    results: Numbers = []
    for point in case["points"]:
        engine.restart()
        for name, value in point["inputs"].items():
            engine.input_variable(name).value = float(value)
        engine.process()
        results.append(
            {name: number(engine.output_variable(name).value) for name in case["outputs"]}
        )
    return results


if __name__ == "__main__":
    serve("pyfuzzylite", fl.__version__, answer)
