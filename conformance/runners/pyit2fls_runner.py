"""pyit2fls: its systems of type 1 and of interval type 2."""

from __future__ import annotations

import importlib.metadata
import warnings
from typing import Any

import numpy as np
import pyit2fls as it2
from protocol import Case, Numbers, demand, is_type_2, number, parts_of, serve, stays_within, way_of

NORMS = {
    "minimum": it2.min_t_norm, "product": it2.product_t_norm, "lukasiewicz": it2.lukasiewicz_t_norm,
    "drastic": it2.drastic_t_norm, "nilpotent": it2.nilpotent_minimum_t_norm,
    "hamacher": it2.hamacher_product_t_norm,
}  # fmt: skip
SUMS = {
    "maximum": it2.max_s_norm, "probabilistic sum": it2.probabilistic_sum_s_norm,
    "lukasiewicz": it2.bounded_sum_s_norm, "drastic": it2.drastic_s_norm,
    "nilpotent": it2.nilpotent_maximum_s_norm, "einstein": it2.einstein_sum_s_norm,
}  # fmt: skip


def shape(term: dict[str, Any]) -> tuple[Any, list[float]]:
    """Return a function of pyit2fls and its parameters."""
    p, height = term["parameters"], term.get("height", 1)
    kind = term["shape"]
    if kind == "triangle":
        return it2.tri_mf, [*p, height]
    if kind == "trapezoid":
        return it2.trapezoid_mf, [*p, height]
    if kind == "gaussian":
        return it2.gaussian_mf, [*p, height]
    if kind == "bell":
        return it2.gbell_mf, [p[1], p[2], p[0], height]
    if kind == "points":
        return it2.points_mf, [number for corner in p for number in corner]
    if kind == "ramp" and p[0] < p[1]:
        return it2.ltri_mf, [p[0], p[1], height]
    if kind == "ramp":
        return it2.rtri_mf, [p[0], p[1], height]
    demand(False, f"no shape like {kind}, but for functions of one's own")
    return None, []


def set_1(term: dict[str, Any], low: float, high: float, count: int, negated: bool = False) -> Any:
    """Return a set of type 1."""
    function, parameters = shape(term)
    made = it2.T1FS(np.linspace(low, high, count), function, parameters)
    return -made if negated else made


def set_2(term: dict[str, Any], low: float, high: float, count: int) -> Any:
    """Return a set of interval type 2."""
    lower = term.get("lower", term)
    return it2.IT2FS(np.linspace(low, high, count), *shape(term), *shape(lower))


def antecedent(case: Case, tree: dict[str, Any], make: Any) -> list[tuple[str, Any]]:
    """Return the propositions of a condition."""
    word, listed = parts_of(tree)
    demand(word == "and", "propositions are joined by and")
    found = []
    for name, label, hedges in listed:
        demand(hedges in ([], ["not"]), "no hedges beside not")
        more = {"negated": True} if hedges else {}
        demand(not hedges or make is set_1, "not is of sets of type 1")
        variable = case["inputs"][name]
        found.append((name, make(variable["terms"][label], *variable["range"], 101, **more)))
    return found


def type_1(case: Case) -> Numbers:
    """Return what T1Mamdani or T1TSK computes."""
    settings = case["settings"]
    method, count, sampling = way_of(case)
    demand(settings["no rule"] in ({"weighted average": (0,)}.get(method, ("nothing",))) or method == "weighted average",
           "no number to be given where no rule fires")  # fmt: skip
    if method == "weighted average":
        demand(
            settings["and"] == "product" or all("and" not in r["if"] for r in case["rules"]),
            "strengths are products",
        )
        demand(settings["aggregation"] == "sum", "rules that share a value are added up")
        default = float("nan") if settings["no rule"] == "nothing" else settings["no rule"]
        system: Any = it2.T1TSK(default)
    else:
        demand(
            method == "centroid" and sampling == "trapezoid", "the centroid by the trapezoid rule"
        )
        demand(settings["aggregation"] == "maximum", "the maximum unites sets")
        engine = {"minimum": "Minimum", "product": "Product"}.get(settings["implication"], "")
        plain = all("and" not in r["if"] for r in case["rules"])
        demand(
            bool(engine) and (plain or settings["and"] == settings["implication"]),
            "min or product, for both",
        )
        system = it2.T1Mamdani(engine=engine, defuzzification="CoG")
    for name in case["inputs"]:
        system.add_input_variable(name)
    for name in case["outputs"]:
        system.add_output_variable(name)
    order = list(case["inputs"])
    sets: dict[tuple[str, str], Any] = {}
    for one in case["rules"]:
        demand("weight" not in one, "no weights of rules")
        then = []
        for name, label in one["then"].items():
            data = case["outputs"][name]
            term = data["terms"][label]
            if method == "weighted average":
                slopes = (
                    term["parameters"] if term["shape"] == "linear" else {"": term["parameters"][0]}
                )
                then.append(
                    (
                        name,
                        lambda *x, s=slopes: sum(
                            c * (x[order.index(v)] if v else 1) for v, c in s.items()
                        ),
                    )
                )
            else:
                sets.setdefault((name, label), set_1(term, *data["range"], count or 0))
                then.append((name, sets[name, label]))
        system.add_rule(antecedent(case, one["if"], set_1), then)
    results: Numbers = []
    for point in case["points"]:
        if method == "weighted average":
            said = system.evaluate(point["inputs"], tuple(point["inputs"].values()))
        else:
            said = system.evaluate(point["inputs"])[1]
        results.append({name: number(said[name]) for name in case["outputs"]})
    return results


def type_2(case: Case) -> Numbers:
    """Return what IT2Mamdani or IT2TSK computes."""
    settings = case["settings"]
    method, count, sampling = way_of(case)
    demand(settings["and"] in NORMS, "no such T-norm")
    demand(settings["no rule"] == "nothing", "no number to be given where no rule fires")
    values = any(
        t["shape"] in {"constant", "linear"}
        for v in case["outputs"].values()
        for t in v["terms"].values()
    )
    if values:
        demand(method == "karnik-mendel", "only the middle of the ends")
        system: Any = it2.IT2TSK(NORMS[settings["and"]], it2.max_s_norm)
    else:
        demand(sampling == "endpoints", "sums with both ends")
        demand(settings["and"] == settings["implication"], "one T-norm for conditions and cuts")
        demand(settings["aggregation"] in SUMS, "no such S-norm")
        algorithm = "NT" if method == "nie-tan" else "KM"
        system = it2.IT2Mamdani(
            NORMS[settings["and"]],
            SUMS[settings["aggregation"]],
            method="Centroid",
            algorithm=algorithm,
        )
    for name in case["inputs"]:
        system.add_input_variable(name)
    for name in case["outputs"]:
        system.add_output_variable(name)
    for one in case["rules"]:
        demand("weight" not in one, "no weights of rules")
        then: list[tuple[str, Any]] = []
        for name, label in one["then"].items():
            data = case["outputs"][name]
            if values:
                constant = {"const": float(data["terms"][label]["parameters"][0])}
                then.append((name, {**constant, **dict.fromkeys(case["inputs"], 0.0)}))
            else:
                then.append((name, set_2(data["terms"][label], *data["range"], count or 0)))
        system.add_rule(antecedent(case, one["if"], set_2), then)
    results: Numbers = []
    for point in case["points"]:
        said = system.evaluate(point["inputs"])
        row: dict[str, float | None] = {}
        for name in case["outputs"]:
            if values:
                row[name] = number(said[name])
                continue
            ends = said[1][name]
            whole = number(ends) if np.ndim(ends) == 0 else None
            if whole is None:
                left, right = float(ends[0]), float(ends[1])
                whole = {"karnik-mendel left": left, "karnik-mendel right": right}.get(
                    method, (left + right) / 2
                )
            row[name] = number(whole)
        results.append(row)
    return results


def answer(case: Case) -> Numbers:
    """Return what the system of this kind computes."""
    demand(
        case["settings"]["outside"] == "extend" or stays_within(case), "inputs are used as they are"
    )
    return type_2(case) if is_type_2(case) else type_1(case)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    serve("pyit2fls", importlib.metadata.version("pyit2fls"), answer)
