"""Make the reference points of tests/inference/data/fuzzylite_centroid.json.

pyfuzzylite 8 needs NumPy below 2, so it lives in an environment of its own:

    python3.11 -m venv ENV
    ENV/bin/pip install "pyfuzzylite==8.0.6"
    ENV/bin/python benchmarks/make_fuzzylite_reference.py

Each case is the 49-rule controller with other norms, terms or sampling; its settings are
stored beside the points, so the tests rebuild it without this script.
"""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import fuzzylite as fl
import numpy as np

TARGET = Path(__file__).parent.parent / "tests/inference/data/fuzzylite_centroid.json"
NAMES = ("NB", "NM", "NS", "ZE", "PS", "PM", "PB")
TABLE = (
    "NB NB NB NM NS NS ZE",
    "NB NM NM NM NS ZE PS",
    "NB NM NS NS ZE PS PM",
    "NB NM NS ZE PS PM PB",
    "NM NS ZE PS PS PM PB",
    "NS ZE PS PM PM PM PB",
    "ZE PS PS PM PB PB PB",
)
NORMS = {
    "min": fl.Minimum, "product": fl.AlgebraicProduct, "bounded": fl.BoundedDifference,
    "drastic": fl.DrasticProduct, "hamacher": fl.HamacherProduct,
    "einstein": fl.EinsteinProduct, "nilpotent": fl.NilpotentMinimum,
}  # fmt: skip
AGGREGATIONS = {
    "max": fl.Maximum, "probor": fl.AlgebraicSum, "bounded": fl.BoundedSum,
    "drastic": fl.DrasticSum, "hamacher": fl.HamacherSum, "einstein": fl.EinsteinSum,
    "nilpotent": fl.NilpotentMaximum, "sum": fl.UnboundedSum, "normalized": fl.NormalizedSum,
}  # fmt: skip
METHODS = {
    "centroid": fl.Centroid, "bisector": fl.Bisector, "mean-of-maximum": fl.MeanOfMaximum,
    "smallest-of-maximum": fl.SmallestOfMaximum, "largest-of-maximum": fl.LargestOfMaximum,
}  # fmt: skip


def term(kind: str, name: str, peak: float) -> fl.Term:
    """One of seven evenly spaced terms."""
    if kind == "gaussian":
        return fl.Gaussian(name, peak, 0.9)
    return fl.Triangle(name, peak - 2.0, peak, peak + 2.0)


def engine(case: dict[str, object]) -> fl.Engine:
    """Build the controller of a case."""
    kind = str(case["terms"])
    places = list(zip(NAMES, range(-6, 7, 2), strict=True))

    def variable(make: type, name: str, **settings: object) -> fl.Variable:
        terms = [term(kind, label, float(peak)) for label, peak in places]
        return make(name=name, minimum=-6.0, maximum=6.0, terms=terms, **settings)

    output = variable(
        fl.OutputVariable,
        "u",
        aggregation=AGGREGATIONS[str(case["aggregation"])](),
        defuzzifier=METHODS[str(case["method"])](case["resolution"]),
    )
    rules = [
        fl.Rule.create(f"if e is {NAMES[i]} and ce is {NAMES[j]} then u is {consequent}")
        for i, row in enumerate(TABLE)
        for j, consequent in enumerate(row.split())
    ]
    block = fl.RuleBlock(
        name="",
        conjunction=NORMS[str(case["conjunction"])](),
        implication=NORMS[str(case["implication"])](),
        activation=fl.General(),
        rules=rules,
    )
    made = fl.Engine(
        name="pd7",
        input_variables=[variable(fl.InputVariable, "e"), variable(fl.InputVariable, "ce")],
        output_variables=[output],
        rule_blocks=[block],
    )
    for rule in block.rules:
        rule.load(made)
    return made


def cases() -> list[dict[str, object]]:
    """Vary one thing at a time, and a few together."""
    base: dict[str, object] = {
        "terms": "triangle", "conjunction": "min", "implication": "min",
        "aggregation": "max", "method": "centroid", "resolution": 100,
    }  # fmt: skip
    varied = [base, {**base, "resolution": 1000}, {**base, "terms": "gaussian"}]
    varied += [{**base, "conjunction": each} for each in NORMS]
    varied += [{**base, "implication": each} for each in NORMS]
    varied += [{**base, "aggregation": each} for each in AGGREGATIONS]
    varied += [{**base, "method": each} for each in METHODS]
    pairs = itertools.product(["product", "einstein"], ["sum", "probor", "hamacher"])
    varied += [{**base, "terms": "gaussian", "implication": a, "aggregation": b} for a, b in pairs]
    return [case for i, case in enumerate(varied) if case not in varied[:i]]


def main() -> None:
    """Evaluate every case at the same points and store them."""
    random = np.random.default_rng(7)
    points = np.round(random.uniform(-6.0, 6.0, (24, 2)), 3)
    points = np.vstack([points, [[0.0, 0.0], [6.0, -6.0], [6.0, 6.0], [-1.0, 3.0]]])
    for case in (stored := cases()):
        system = engine(case)
        values = []
        for e, ce in points.tolist():
            system.restart()
            system.input_variable("e").value = e
            system.input_variable("ce").value = ce
            system.process()
            values.append(np.asarray(system.output_variable("u").value).item())
        case["u"] = [None if np.isnan(value) else value for value in values]
    made_by = f"pyfuzzylite {fl.__version__}"
    content = {"made_by": made_by, "points": points.tolist(), "cases": stored}
    TARGET.write_text(json.dumps(content, indent=None) + "\n", encoding="utf-8")
    print(f"{TARGET}: {len(stored)} cases of {len(points)} points")


if __name__ == "__main__":
    main()
