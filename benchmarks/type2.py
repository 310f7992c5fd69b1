"""Interval type-2 inference: error and time of a point, beside two other packages.

    python benchmarks/type2.py [--quick]

200 random rule bases of two inputs with trapezoids over trapezoids, ten points each. The error
of each program is that of its ends from Karnik and Mendel's over 100,001 samples under the
trapezoid rule, in shares of the range; of the exact routine it is mostly that of the samples.
Times are medians of one point in the same process. pyit2fls and ferrifuzz are taken where they
are installed (`pip install pyit2fls ferrifuzz`).
"""

from __future__ import annotations

import importlib
import importlib.util
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference import compiled
from fuzzyarm.inference.firing_intervals import ends
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)

Array = NDArray[np.float64]
Ends = Callable[[float, float], tuple[float, float]]
"""From the two inputs to the two ends."""

SAMPLES = 100_001
LOW, HIGH = 0.0, 10.0


def rule_base(seed: int) -> RuleBase:
    """Return a random rule base: nine rules, three terms an input, five output sets."""
    draw = np.random.default_rng(seed)

    def term(name: str, centre: float, width: float) -> Term:
        flat = width * draw.uniform(0.0, 0.3)
        a, b, c, d = centre - width, centre - flat, centre + flat, centre + width
        inner = draw.uniform(0.05, 0.4, 2) * (width - flat)
        lower = Shape("trapezoid", (a + inner[0], b, c, d - inner[1]), draw.uniform(0.6, 1.0))
        return Term(name, Shape("trapezoid", (a, b, c, d)), lower=lower)

    def terms(count: int, low: float, high: float) -> tuple[Term, ...]:
        step = (high - low) / (count - 1)
        widths = step * draw.uniform(0.8, 1.6, count)
        return tuple(term(f"t{i}", low + i * step, width) for i, width in enumerate(widths))

    inputs = tuple(Input(name, -1.0, 1.0, terms(3, -1.0, 1.0)) for name in "ab")
    output = Output("y", LOW, HIGH, terms(5, 1.0, 9.0), defuzzifier=Defuzzifier("karnik-mendel"))
    rules = tuple(
        Rule(And((Is("a", f"t{i}"), Is("b", f"t{j}"))), (Consequent("y", f"t{draw.integers(5)}"),))
        for i, j in product(range(3), repeat=2)
    )
    return RuleBase("r", inputs, (output,), (RuleBlock(rules),))


def corners(shape: Shape) -> tuple[list[float], list[float]]:
    """Return the corners of a trapezoid."""
    return list(shape.parameters), [0.0, shape.height, shape.height, 0.0]


def sampled(rulebase: RuleBase, a: float, b: float) -> tuple[float, float]:
    """Return the ends over many samples, by the sums up to each switch point."""
    ys = np.linspace(LOW, HIGH, SAMPLES)
    curves = []
    for lower in (True, False):
        total = np.zeros(SAMPLES)
        for rule in rulebase.rules:
            assert isinstance(rule.antecedent, And)
            degrees = []
            for part in rule.antecedent.operands:
                assert isinstance(part, Is)
                term = rulebase.variable(part.variable).term(part.term)
                assert term.lower is not None
                shape = term.lower if lower else term.shape
                degrees.append(np.interp(a if part.variable == "a" else b, *corners(shape)))
            term = rulebase.output("y").term(rule.consequents[0].term)
            assert term.lower is not None
            shape, height = term.lower if lower else term.shape, min(degrees)
            first, last = np.searchsorted(ys, [shape.parameters[0], shape.parameters[3]])
            cut = np.minimum(height, np.interp(ys[first:last], *corners(shape)))
            np.maximum(total[first:last], cut, out=total[first:last])
        total[[0, -1]] *= 0.5
        curves.append(total)
    found = []
    for sign in (-1, 1):
        low, high = (curve[::sign] for curve in curves)
        x = ys[::sign]
        area = high.sum() + np.cumsum(low - high)
        moment = (high * x).sum() + np.cumsum((low - high) * x)
        with np.errstate(all="ignore"):
            values = np.where(area > 0.0, moment / area, -sign * np.inf)
        found.append(float(values.max() if sign > 0 else values.min()))
    return found[0], found[1]


# --- The programs ---


def of_fuzzyarm(rulebase: RuleBase) -> tuple[Ends, Callable[[float, float], Any]]:
    """Return both ends, and one point as it is evaluated: the middle."""
    both, middle = compiled(ends(rulebase).rulebase).at, compiled(rulebase).at
    return both, middle  # type: ignore[return-value]


def of_samples(rulebase: RuleBase) -> tuple[Ends, Callable[[float, float], Any]]:
    """Do the same over 101 samples."""
    way = Defuzzifier("karnik-mendel", 101)
    return of_fuzzyarm(
        replace(rulebase, outputs=tuple(replace(o, defuzzifier=way) for o in rulebase.outputs))
    )


def of_nie_tan(rulebase: RuleBase) -> tuple[Ends, Callable[[float, float], Any]]:
    """Nie and Tan's one number, which has no ends: its time counts."""
    way = Defuzzifier("nie-tan")
    changed = tuple(replace(o, defuzzifier=way) for o in rulebase.outputs)
    at = compiled(replace(rulebase, outputs=changed)).at
    return (lambda a, b: (at(a, b)[0],) * 2), at


def of_pyit2fls(rulebase: RuleBase) -> tuple[Ends, Callable[[float, float], Any]]:
    """Build it in pyit2fls, over 101 samples, by its Karnik and Mendel's."""
    other = importlib.import_module("pyit2fls")

    def sets(variable: Input | Output, low: float, high: float) -> dict[str, Any]:
        made = {}
        for term in variable.terms:
            assert term.lower is not None
            upper, lower = (
                [*term.shape.parameters, 1.0],
                [*term.lower.parameters, term.lower.height],
            )
            made[term.name] = other.IT2FS(
                np.linspace(low, high, 101),
                other.trapezoid_mf, upper, other.trapezoid_mf, lower,
            )  # fmt: skip
        return made

    system = other.IT2Mamdani(other.min_t_norm, other.max_s_norm, method="Centroid", algorithm="KM")
    known = {"y": sets(rulebase.outputs[0], LOW, HIGH)}
    for variable in rulebase.inputs:
        system.add_input_variable(variable.name)
        known[variable.name] = sets(variable, -1.0, 1.0)
    system.add_output_variable("y")
    for rule in rulebase.rules:
        assert isinstance(rule.antecedent, And)
        parts = [p for p in rule.antecedent.operands if isinstance(p, Is)]
        end = rule.consequents[0]
        system.add_rule(
            [(p.variable, known[p.variable][p.term]) for p in parts], [("y", known["y"][end.term])]
        )

    def both(a: float, b: float) -> tuple[float, float]:
        found = system.evaluate({"a": a, "b": b})[1]["y"]
        return float(found[0]), float(found[1])

    return both, both


def of_ferrifuzz(rulebase: RuleBase) -> tuple[Ends, Callable[[float, float], Any]]:
    """Build it in ferrifuzz with its default of 200 steps."""
    other = importlib.import_module("ferrifuzz")

    system = other.FuzzySystem()
    for variable in (*rulebase.inputs, *rulebase.outputs):
        made = other.Variable(variable.name, variable.low, variable.high)
        for term in variable.terms:
            assert term.lower is not None
            made[term.name] = other.mf.it2(
                other.mf.trapezoid(*term.shape.parameters),
                other.mf.trapezoid(*term.lower.parameters), term.lower.height,
            )  # fmt: skip
        (system.add_output if isinstance(variable, Output) else system.add_input)(made)
    for rule in rulebase.rules:
        assert isinstance(rule.antecedent, And)
        parts = [p for p in rule.antecedent.operands if isinstance(p, Is)]
        words = " AND ".join(f"{p.variable} IS {p.term}" for p in parts)
        system += f"IF {words} THEN y IS {rule.consequents[0].term}"

    def both(a: float, b: float) -> tuple[float, float]:
        found = system.compute_interval({"a": a, "b": b})["y"]
        return found[0], found[1]

    return both, lambda a, b: system.compute({"a": a, "b": b})


PROGRAMS = {
    "fuzzyarm, exact": (of_fuzzyarm, 1),
    "fuzzyarm, 101 samples": (of_samples, 1),
    "fuzzyarm, nie-tan": (of_nie_tan, 1),
    "ferrifuzz, 200 steps": (of_ferrifuzz, 1),
    "pyit2fls, 101 samples": (of_pyit2fls, 20),  # a millisecond a point: every twentieth
}


def main() -> None:
    """Print a line for each program."""
    count = 20 if "--quick" in sys.argv[1:] else 200
    draw = np.random.default_rng(0)
    cases = []
    for seed in range(count):
        rulebase = rule_base(seed)
        points = draw.uniform(-0.95, 0.95, (10, 2)).tolist()
        cases.append((rulebase, points, [sampled(rulebase, *point) for point in points]))
    print(f"{count} rule bases × 10 points; error in shares of the range")
    for name, (make, step) in PROGRAMS.items():
        package = name.partition(",")[0]
        if importlib.util.find_spec(package) is None:
            print(f"{name:<24} not installed")
            continue
        worst, times = 0.0, []
        for rulebase, points, wanted in cases[::step]:
            both, one = make(rulebase)
            for point, truth in zip(points, wanted, strict=True):
                found = both(*point)
                away = max(abs(x - y) for x, y in zip(found, truth, strict=True))
                worst = max(worst, away / (HIGH - LOW))
                one(*point)
                start = time.perf_counter()
                one(*point)
                times.append(time.perf_counter() - start)
        error = "      —" if make is of_nie_tan else f"{worst:7.1e}"
        print(
            f"{name:<24} worst error {error}   median {1e6 * statistics.median(times):8.1f} µs"
            f" a point   95 % within {1e6 * float(np.quantile(times, 0.95)):8.1f} µs",
            flush=True,
        )


if __name__ == "__main__":
    main()
