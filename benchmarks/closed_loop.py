"""The closed loop against plain C: every kind of controller, 25,005 control steps each.

Compiles ``closed_loop.c`` with ``gcc -O3`` once for each controller, where a C compiler is
present; its rules and tables are written for it from the files that fuzzyarm reads. Runs
both in turns and prints the ratio of the medians: of the loop alone and of the whole call
of ``simulate``, which also collects the figures. Then a batch of runs with one thread and
with one for each processor.

usage: python benchmarks/closed_loop.py [--markdown]
"""

from __future__ import annotations

import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from fuzzyarm.controller import controller
from fuzzyarm.inference.aggregate import positions
from fuzzyarm.language import load_rulebase
from fuzzyarm.loop import Options, simulate, simulate_many
from fuzzyarm.model.rulebase import RuleBase, propositions
from fuzzyarm.model.shapes import membership
from fuzzyarm.plant import reach_return
from fuzzyarm.shipped_files import shipped
from fuzzyarm.table import read_table

ROUNDS = 7
REPEATS = 15

CONTROLS = {
    "pd": "PD",
    "ct": "CT",
    "ffid": "FFID",
    "cdid": "CDID",
    "acdid": "ACDID",
    "mrac": "MRAC",
    "dac": "DAC",
    "fuzzy-lut": "LUT",
    "cdid+fuzzy": "CDID_LUT",
    "soc-zero": "SOC",
    "fuzzy-direct": "DIRECT",
    "stfc": "STFC",
    "cfaf": "CFAF",
    "hfie": "HFIE",
}
"""Controller here: its name in the C program."""

WITH_DATA = {"LUT", "CDID_LUT", "SOC", "DIRECT", "STFC", "CFAF", "HFIE"}


def c_array(values: object) -> str:
    """Write nested numbers as a C initialiser."""
    if isinstance(values, (list, tuple)):
        return "{" + ", ".join(c_array(each) for each in values) + "}"
    return repr(values)


def c_rules(name: str, rulebase: RuleBase) -> str:
    """Write a 7 × 7 rule base with trapezoids as C data."""
    e, ce = rulebase.inputs
    output = rulebase.outputs[0]

    def corners(kind: str, p: tuple[float, ...]) -> list[float]:
        return [p[0], p[1], p[1], p[2]] if kind == "triangle" else list(p)

    sets = {v.name: [corners(t.shape.kind, t.shape.parameters) for t in v.terms] for v in (e, ce)}
    names = {v.name: [term.name for term in v.terms] for v in (e, ce, output)}
    then = [[0] * 7 for _ in range(7)]
    for rule in rulebase.rules:
        parts = {part.variable: part.term for part in propositions(rule.antecedent)}
        row, column = (names[v.name].index(parts[v.name]) for v in (e, ce))
        then[row][column] = names[output.name].index(rule.consequents[0].term)
    x = positions(output.low, output.high, 101, "endpoints")
    sampled = [[membership(term.shape, each) for each in x] for term in output.terms]
    spans = [[i for i, y in enumerate(values) if y > 0.0] for values in sampled]
    fields = [
        sets[e.name],
        sets[ce.name],
        then,
        x,
        sampled,
        [span[0] for span in spans],
        [span[-1] + 1 for span in spans],
    ]
    return f"static const struct rules {name} = {c_array(fields)};\n"


def write_data(folder: Path) -> None:
    """Write the rules and tables of the shipped files as C data."""
    table = read_table(shipped("thesis-6.1.lut"))
    performance = read_table(shipped("performance-yamazaki.lut"))
    text = (
        "struct rules { double e[7][4], ce[7][4]; int then[7][7]; "
        "double at[101], set[7][101]; int first[7], stop[7]; };\n"
        f"static const double bins[12] = {c_array(list(table.axes[0].bins or ()))};\n"
        f"static const double control_table[13][13] = {c_array(table.values.tolist())};\n"
        f"static const double performance_table[13][13] = {c_array(performance.values.tolist())};\n"
    )
    text += c_rules("control_rules", load_rulebase(shipped("pd7-study.frb")))
    text += c_rules("alpha_rules", load_rulebase(shipped("alpha7-study.frb")))
    (folder / "closed_loop_data.h").write_text(text)


def compile_c(folder: Path, control: str) -> Path | None:
    """Build the C loop of one controller; None where there is no compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    program = folder / control
    words = [compiler, "-O3", f"-DCONTROL={control}", f"-I{folder}"]
    if control in WITH_DATA:
        words.append("-DWITH_DATA")
    source = Path(__file__).with_suffix(".c")
    subprocess.run([*words, str(source), "-o", str(program), "-lm"], check=True)
    return program


def run_c(program: Path) -> tuple[float, float, float]:
    """Return the median seconds of a run and the two RMS errors."""
    words = subprocess.run(
        [str(program), str(REPEATS)], check=True, capture_output=True, text=True
    ).stdout.split()
    seconds, first, second = map(float, words)
    return seconds, first, second


def run_python(name: str, compiled: bool = True, repeats: int = REPEATS) -> dict[str, float]:
    """Return the median seconds of loop and call, and the RMS errors."""
    made, path = controller(name), reach_return()
    loops, calls = [], []
    for _ in range(repeats):
        begin = time.perf_counter()
        run = simulate(made, path, payload=True, options=Options(compiled=compiled))
        calls.append(time.perf_counter() - begin)
        loops.append(run.seconds)
    return {
        "loop": statistics.median(loops),
        "call": statistics.median(calls),
        "rms_1": float(run.rms[0]),
        "rms_2": float(run.rms[1]),
    }


def compare(folder: Path, name: str, control: str) -> list[str]:
    """Return the cells of one line: C, ours, ratios, and whether the figures are the same."""
    program = compile_c(folder, control)
    assert program is not None
    pairs = [(run_c(program), run_python(name)) for _ in range(ROUNDS)]
    (_, first, second), ours = pairs[0]
    ratios = sorted(python["loop"] / c[0] for c, python in pairs)
    calls = statistics.median(python["call"] / c[0] for c, python in pairs)
    apart = max(abs(first / ours["rms_1"] - 1.0), abs(second / ours["rms_2"] - 1.0))
    return [
        name,
        f"{1e3 * statistics.median(c[0] for c, _ in pairs):.2f}",
        f"{1e3 * statistics.median(python['loop'] for _, python in pairs):.2f}",
        f"{statistics.median(ratios):.2f}",
        f"{ratios[0]:.2f} to {ratios[-1]:.2f}",
        f"{calls:.2f}",
        f"{apart:.0e}",
    ]


def batches() -> list[str]:
    """Return how much faster many runs are with a thread for each processor."""
    lines = []
    for name in ("cdid", "soc-zero", "fuzzy-direct"):
        made, path = controller(name), reach_return()
        seconds = []
        for workers in (1, os.cpu_count() or 1):
            begin = time.perf_counter()
            simulate_many(made, path, {"seed": np.arange(200)}, payload=True, workers=workers)
            seconds.append(time.perf_counter() - begin)
        lines.append(
            f"200 runs of {name}: {1e3 * seconds[0] / 200:.2f} ms a run with one thread, "
            f"{1e3 * seconds[1] / 200:.2f} with {os.cpu_count()}: {seconds[0] / seconds[1]:.2f} "
            "times as fast"
        )
    return lines


HEADINGS = ["controller", "C, ms", "here, ms", "ratio", "spread", "whole call", "RMS apart"]


def main() -> int:
    """Measure and print."""
    begin = time.perf_counter()
    run_python("cdid", repeats=1)
    print(f"first call in this process: {time.perf_counter() - begin:.2f} s", file=sys.stderr)
    markdown = "--markdown" in sys.argv
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if shutil.which("gcc") is None and shutil.which("cc") is None:
            print("no C compiler here: nothing to compare with")
            return 0
        write_data(folder)
        rows = [HEADINGS]
        rows += [compare(folder, ours, control) for ours, control in CONTROLS.items()]
    if markdown:
        rows.insert(1, ["---"] * len(HEADINGS))
        print("\n".join(f"| {' | '.join(row)} |" for row in rows))
    else:
        widths = [max(len(row[i]) for row in rows) for i in range(len(HEADINGS))]
        for row in rows:
            print("  ".join(f"{cell:>{width}}" for cell, width in zip(row, widths, strict=True)))
    print("\n".join(batches()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
