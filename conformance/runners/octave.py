"""Octave's fuzzy-logic-toolkit: `.fis` files, read by readfis, evaluated by evalfis.

All cases go through one Octave, since its start takes longer than they do.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from protocol import (
    CannotError,
    Case,
    cases,
    demand,
    demand_type_1,
    number,
    parts_of,
    stays_within,
    way_of,
)

FAR = 1e6  # where a shoulder ends
T_NORMS = {
    "minimum": "min", "product": "prod", "lukasiewicz": "bounded_difference", "drastic": "drastic_product",
    "hamacher": "hamacher_product", "einstein": "einstein_product",
}  # fmt: skip
S_NORMS = {
    "maximum": "max", "probabilistic sum": "algebraic_sum", "lukasiewicz": "bounded_sum",
    "drastic": "drastic_sum", "hamacher": "hamacher_sum", "einstein": "einstein_sum", "sum": "sum",
}  # fmt: skip
METHODS = {
    "centroid": "centroid", "bisector": "bisector", "mean of maxima": "mom", "smallest of maxima": "som",
    "largest of maxima": "lom", "weighted average": "wtaver", "weighted sum": "wtsum",
}  # fmt: skip
SAMPLED = {"centroid": "trapezoid"}


def parted(numbers: list[float], low: float, high: float) -> list[float]:
    """Return corners with feet apart from tops, as trimf and trapmf want them: beyond the range."""
    found = list(map(float, numbers))
    if found[0] == found[1]:
        demand(found[0] <= low, "no vertical edge inside of a range")
        found[0] -= 1.0
    if found[-1] == found[-2]:
        demand(found[-1] >= high, "no vertical edge inside of a range")
        found[-1] += 1.0
    return found


def function(
    term: dict[str, Any], inputs: list[str], low: float, high: float
) -> tuple[str, list[float]]:
    """Return the name of a membership function and its numbers."""
    p, shape = term["parameters"], term["shape"]
    demand("height" not in term, "no heights of sets")
    if shape == "constant":
        return "constant", [*p]
    if shape == "linear":
        return "linear", [*(p.get(name, 0) for name in inputs), p.get("", 0)]
    if shape == "ramp":
        return "trapmf", [p[0], p[1], FAR, 2 * FAR] if p[0] < p[1] else [-2 * FAR, -FAR, p[1], p[0]]
    if shape == "rectangle":
        return "trapmf", parted([p[0], p[0], p[1], p[1]], low, high)
    if shape in {"triangle", "trapezoid"}:
        return {"triangle": "trimf", "trapezoid": "trapmf"}[shape], parted(p, low, high)
    if shape == "gaussian":
        return "gaussmf", [p[1], p[0]]
    if shape == "bell":
        return "gbellmf", [p[1], p[2], p[0]]
    if shape == "sigmoid":
        return "sigmf", [p[1], p[0]]
    demand(shape != "points", "no polylines, but for functions of one's own")
    return {"s": "smf", "z": "zmf", "pi": "pimf"}[shape], list(p)


def variable(title: str, name: str, data: dict[str, Any], inputs: list[str]) -> list[str]:
    """Return the section of a variable."""
    lines = [
        f"[{title}]",
        f"Name='{name}'",
        f"Range=[{data['range'][0]} {data['range'][1]}]",
        f"NumMFs={len(data['terms'])}",
    ]
    for k, (label, term) in enumerate(data["terms"].items(), 1):
        kind, numbers = function(term, inputs, *data["range"])
        lines.append(f"MF{k}='{label}':'{kind}',[{' '.join(repr(float(n)) for n in numbers)}]")
    return [*lines, ""]


def rule(case: Case, one: dict[str, Any]) -> str:
    """Return a rule as indices; a decimal is a hedge, a minus sign is not."""
    word, listed = parts_of(one["if"])
    indices = dict.fromkeys(case["inputs"], "0")
    for name, label, hedges in listed:
        demand(indices[name] == "0", "an input stands once in a rule")
        demand(hedges in ([], ["not"], ["very"], ["not", "very"]), "not stands before hedges")
        index = str(list(case["inputs"][name]["terms"]).index(label) + 1)
        index += ".2" if "very" in hedges else ""
        indices[name] = f"-{index}" if "not" in hedges else index
    then = [str(list(data["terms"]).index(one["then"][name]) + 1) if name in one["then"] else "0"
            for name, data in case["outputs"].items()]  # fmt: skip
    return f"{' '.join(indices.values())}, {' '.join(then)} ({one.get('weight', 1)}) : {1 if word == 'and' else 2}"


def fis(case: Case) -> str:
    """Return the text of a file, or refuse the case."""
    demand_type_1(case)
    settings = case["settings"]
    method, _count, sampling = way_of(case)
    demand(method in METHODS, "no such defuzzifier")
    values = method.startswith("weighted")
    demand(
        values or sampling == SAMPLED.get(method, "endpoints"),
        "its own sums: trapezoids, both ends for maxima",
    )
    demand(settings["and"] in T_NORMS and settings["or"] in S_NORMS, "no such norm by a name")
    demand(settings["implication"] in T_NORMS, "no such implication by a name")
    demand(settings["aggregation"] in S_NORMS, "no such aggregation by a name")
    demand(settings["no rule"] == "nothing", "no number to be given where no rule fires")
    demand(stays_within(case), "inputs beyond their range are refused")
    if values:
        demand(settings["aggregation"] == "sum", "rules that share a value are added up")
    rules = [rule(case, one) for one in case["rules"]]
    names = list(case["inputs"])
    aggregation = settings["aggregation"]
    lines = [
        "[System]", "Name='case'", f"Type='{'sugeno' if values else 'mamdani'}'", "Version=2.0",
        f"NumInputs={len(names)}", f"NumOutputs={len(case['outputs'])}", f"NumRules={len(rules)}",
        f"AndMethod='{T_NORMS[settings['and']]}'", f"OrMethod='{S_NORMS[settings['or']]}'",
        f"ImpMethod='{T_NORMS[settings['implication']]}'", f"AggMethod='{S_NORMS[aggregation]}'",
        f"DefuzzMethod='{METHODS[method]}'", "",
    ]  # fmt: skip
    for k, (name, data) in enumerate(case["inputs"].items(), 1):
        lines += variable(f"Input{k}", name, data, names)
    for k, (name, data) in enumerate(case["outputs"].items(), 1):
        lines += variable(f"Output{k}", name, data, names)
    return "\n".join([*lines, "[Rules]", *rules, ""])


SCRIPT = """
pkg load fuzzy-logic-toolkit
{loop}
"""
ONE = """
try
  system = readfis ('{path}');
  values = evalfis ({points}, system, {count});
  printf ("@%d", {index}); printf (" %.17g", values'); printf ("\\n");
catch problem
  printf ("!%d %s\\n", {index}, strrep (problem.message, "\\n", " "));
end_try_catch
"""


def run(script: str) -> tuple[str, str]:
    """Return what Octave prints, and its version."""
    words = ["octave-cli", "--no-gui", "--quiet", "--no-init-file"]
    try:
        done = subprocess.run(words, input=script, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        sys.exit("octave-cli is not installed: apt install octave octave-fuzzy-logic-toolkit")
    return done.stdout, done.stderr


def main() -> None:
    """Answer all cases."""
    said: list[dict[str, Any]] = []
    loop = []
    with tempfile.TemporaryDirectory() as folder:
        for index, case in enumerate(cases()):
            said.append({"name": case["name"], "error": "Octave printed nothing"})
            said[-1]["case"] = case
            try:
                text = fis(case)
            except CannotError as error:
                said[-1] = {"name": case["name"], "cannot": str(error)}
                continue
            path = Path(folder) / f"case{index}.fis"
            path.write_text(text)
            points = "; ".join(
                " ".join(repr(float(v)) for v in p["inputs"].values()) for p in case["points"]
            )
            loop.append(
                ONE.format(
                    path=path, points=f"[{points}]", count=way_of(case)[1] or 101, index=index
                )
            )
        printed, _ = run(SCRIPT.format(loop="\n".join(loop)))
    for line in printed.splitlines():
        if match := re.match(r"@(\d+)((?: \S+)+)$", line):
            entry = said[int(match[1])]
            names = list(entry["case"]["outputs"])
            numbers = [number(word.replace("NA", "nan")) for word in match[2].split()]
            rows = [numbers[k : k + len(names)] for k in range(0, len(numbers), len(names))]
            entry["points"] = [dict(zip(names, row, strict=True)) for row in rows]
            del entry["error"]
        elif match := re.match(r"!(\d+) (.*)$", line):
            said[int(match[1])]["error"] = match[2]
    version, _ = run("pkg load fuzzy-logic-toolkit\np = pkg('list','fuzzy-logic-toolkit'){1};\n"
                     "printf(\"%s\", p.version)")  # fmt: skip
    print(json.dumps({"tool": "Octave fuzzy-logic-toolkit", "version": version.strip()}))
    for entry in said:
        entry.pop("case", None)
        print(json.dumps(entry))


if __name__ == "__main__":
    main()
