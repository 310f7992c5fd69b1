"""fuzzyarm: a rule base as text, by one of its engines.

    python fuzzyarm_runner.py point | arrays | compiled | c | st | javascript

C is compiled by gcc, JavaScript run by node, Structured Text by the interpreter of the project's tests.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from protocol import CannotError, Case, Numbers, demand, number, serve

import fuzzyarm
from fuzzyarm.apps.cli.main import main as command

WORDS = {
    "minimum": "min",
    "lukasiewicz": "bounded",
    "maximum": "max",
    "probabilistic sum": "probor",
}
METHODS = {
    "mean of maxima": "mean-of-maximum", "smallest of maxima": "smallest-of-maximum",
    "largest of maxima": "largest-of-maximum", "middle of maxima": "middle-of-maximum",
    "nearest of maxima": "nearest-of-maximum", "farthest of maxima": "farthest-of-maximum",
    "weighted average": "weighted-average", "weighted sum": "weighted-sum",
    "karnik-mendel left": "karnik-mendel-left", "karnik-mendel right": "karnik-mendel-right",
}  # fmt: skip
SHAPES = {"constant": "singleton"}


def quoted(name: str) -> str:
    """Return a name that no word of the language is."""
    return f"'{name}'"


def shape(term: dict[str, Any]) -> str:
    """Return a shape as the language writes it."""
    kind, p = term["shape"], term["parameters"]
    if kind == "linear":
        return "linear " + " + ".join(f"{c} * {quoted(v)}" if v else f"{c}" for v, c in p.items())
    numbers = (f"({x}, {y})" for x, y in p) if kind == "points" else map(str, p)
    height = f" height {term['height']}" if "height" in term else ""
    return f"{SHAPES.get(kind, kind)} {' '.join(numbers)}{height}"


def term_line(variable: str, label: str, term: dict[str, Any]) -> str:
    """Return the line of a term; of type 2 the upper function over the lower one."""
    lower = f" over {shape(term['lower'])}" if "lower" in term else ""
    return f"term {quoted(variable)} {quoted(label)}: {shape(term)}{lower}"


def condition(tree: dict[str, Any]) -> str:
    """Return a condition."""
    ((word, parts),) = tree.items()
    if word == "is":
        return f"{quoted(parts[0])} is {quoted(parts[1])}"
    if word in {"not", "very"}:
        inner = parts
        hedges = [word]
        while next(iter(inner)) in {"not", "very"}:
            ((word, inner),) = inner.items()
            hedges.append(word)
        name, label = inner["is"]
        return f"{quoted(name)} is {' '.join(hedges)} {quoted(label)}"
    return f"({f' {word} '.join(condition(part) for part in parts)})"


def text_of(case: Case) -> str:
    """Return a case as a rule base."""
    settings = case["settings"]
    way = settings["defuzzifier"]
    defuzzifier = METHODS.get(way["method"], way["method"])
    if "samples" in way:
        defuzzifier += f"({way['samples']}, {way['sampling']})"
    words = {
        key: WORDS.get(settings[key], settings[key])
        for key in ("and", "or", "implication", "aggregation")
    }
    default = settings["no rule"]
    no_rule = "nan" if default == "nothing" else default
    lines = ["rulebase 'case'"]
    for side in ("inputs", "outputs"):
        for name, data in case[side].items():
            low, high = data["range"]
            lines.append(f"{side[:-1]} {quoted(name)} {low} .. {high}")
    lines += [term_line(name, label, term) for side in ("inputs", "outputs") for name, data in case[side].items()
              for label, term in data["terms"].items()]  # fmt: skip
    lines.append("inference " + ", ".join(f"{key} {word}" for key, word in words.items()))
    for name in case["outputs"]:
        lines.append(
            f"inference {quoted(name)}: defuzzifier {defuzzifier}, no-rule {no_rule}, outside extend"
        )
    lines += [f"inference {quoted(name)}: outside {settings['outside']}" for name in case["inputs"]]
    for one in case["rules"]:
        then = ", ".join(
            f"{quoted(name)} is {quoted(label)}" for name, label in one["then"].items()
        )
        weight = f" with {one['weight']}" if "weight" in one else ""
        lines.append(f"rule if {condition(one['if'])} then {then}{weight}")
    return "\n".join([*lines, ""])


def columns_of(case: Case) -> dict[str, np.ndarray]:
    """Return the points as columns."""
    return {
        name: np.array([p["inputs"][name] for p in case["points"]], float)
        for name in case["inputs"]
    }


def by_point(case: Case) -> Numbers:
    """Infer one point at a time, in plain Python."""
    rulebase = fuzzyarm.parse(text_of(case)).rulebase
    found = (fuzzyarm.infer(rulebase, point["inputs"]) for point in case["points"])
    return [{name: number(value) for name, value in one.items()} for one in found]


def by_arrays(case: Case) -> Numbers:
    """Infer columns of points."""
    found = fuzzyarm.infer(fuzzyarm.parse(text_of(case)).rulebase, columns_of(case))
    return [{name: number(found[name][k]) for name in found} for k in range(len(case["points"]))]


def by_machine_code(case: Case) -> Numbers:
    """Ask the compiled rule base, a call for each point."""
    rulebase = fuzzyarm.parse(text_of(case)).rulebase
    try:
        fast = fuzzyarm.compiled(rulebase)
    except ValueError as error:
        raise CannotError(str(error)) from error
    rows = [fast.at(*point["inputs"].values()) for point in case["points"]]
    return [dict(zip(case["outputs"], map(number, row), strict=True)) for row in rows]


def exported(case: Case, folder: Path, target: str, *options: str) -> Path:
    """Write a case, let the command export it, and return the file."""
    source, made = folder / "rules.frb", folder / target
    source.write_text(text_of(case), encoding="utf-8")
    said = folder / "said"
    with (
        said.open("w") as stream,
        contextlib.redirect_stdout(stream),
        contextlib.redirect_stderr(stream),
    ):
        code = command(["compile", str(source), "-o", str(made), *options])
    message = said.read_text()
    if code or not made.exists():
        refusal = next((line for line in message.splitlines() if "error" in line), message.strip())
        raise CannotError(refusal.split("error: ", 1)[-1].split("error[", 1)[-1])
    return made


DRIVER = """#include "rules.h"
#include <stdio.h>
int main(void)
{{
{lines}
    return 0;
}}
"""


def by_c(case: Case) -> Numbers:
    """Compile the exported C with gcc and run it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        exported(case, folder, "rules.c", "--direct", "--precision", "float64")
        functions = re.findall(
            r"^double (\w+)\(double", (folder / "rules.h").read_text(), re.MULTILINE
        )
        calls = [
            f'    printf("%.17g\\n", {function}({", ".join(repr(float(v)) for v in point["inputs"].values())}));'
            for point in case["points"]
            for function in functions
        ]
        (folder / "main.c").write_text(DRIVER.format(lines="\n".join(calls)))
        words = [
            "gcc",
            "-std=c99",
            "-O0",
            str(folder / "main.c"),
            str(folder / "rules.c"),
            "-o",
            str(folder / "main"),
            "-lm",
        ]
        subprocess.run(words, check=True)
        printed = subprocess.run(
            [str(folder / "main")], check=True, capture_output=True, text=True
        ).stdout
    values = iter(map(number, printed.split()))
    return [{output: next(values) for output in case["outputs"]} for _ in case["points"]]


def by_structured_text(case: Case) -> Numbers:
    """Run the exported function block by the interpreter of the tests."""
    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests" / "export"))
    from st_programs import Program

    with tempfile.TemporaryDirectory() as name:
        path = exported(case, Path(name), "rules.st", "--direct", "--precision", "float64")
        program = Program(path.read_text(encoding="utf-8"))
    blocks = [unit.name for unit in program.units.values() if unit.sort != "FUNCTION"]
    results: Numbers = []
    for point in case["points"]:
        row = []
        for block in blocks:
            instance = program.instance(block)
            instance.run(**dict(zip(instance.unit.inputs, point["inputs"].values(), strict=False)))
            outputs = dict(instance.outputs())
            fired = outputs.pop("fired", True)  # without a rule the value of before stays
            row.append(number(next(iter(outputs.values()))) if fired else None)
        results.append(dict(zip(case["outputs"], row, strict=True)))
    return results


MODULE = """
import { infer } from "./rules.mjs";
import { readFileSync } from "fs";
const points = JSON.parse(readFileSync(0));
console.log(JSON.stringify(points.map((point) => infer(point))));
"""


def by_javascript(case: Case) -> Numbers:
    """Run the exported module by node."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        exported(case, folder, "rules.mjs")
        (folder / "run.mjs").write_text(MODULE)
        points = json.dumps([point["inputs"] for point in case["points"]])
        done = subprocess.run(
            ["node", str(folder / "run.mjs")],
            input=points,
            check=True,
            capture_output=True,
            text=True,
        )
    return [
        {output: number(row[output]) for output in case["outputs"]}
        for row in json.loads(done.stdout)
    ]


ENGINES: dict[str, Callable[[Case], Numbers]] = {
    "point": by_point, "arrays": by_arrays, "compiled": by_machine_code, "c": by_c,
    "st": by_structured_text, "javascript": by_javascript,
}  # fmt: skip


if __name__ == "__main__":
    demand(len(sys.argv) == 2 and sys.argv[1] in ENGINES, f"one of {', '.join(ENGINES)}")
    os.environ["FUZZYARM_PROGRESS"] = "0"
    serve(f"fuzzyarm {sys.argv[1]}", fuzzyarm.__version__, ENGINES[sys.argv[1]])
