"""The closed loop against plain C: every kind of controller, 25,005 control steps each.

Compiles ``closed_loop.c`` with ``gcc -O3`` once for each controller, where a C compiler is
present; its rules and tables are written for it from the files that fuzzyarm reads. Those with
rules run twice: as shipped, with a centroid of 101 samples, and with the exact centroid, of which
C has the same closed form. Both run in turns; times are of the processor, the least of some runs,
so that a busy machine does less harm. Printed are the medians over rounds of the ratio of the
loop alone, and of the whole call of ``simulate``, which also collects the figures. Then a batch
of runs with one thread and with one for each processor.

usage: python benchmarks/closed_loop.py [--markdown] [CONTROLLER ...]
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.controllers import controller
from fuzzyarm.control.loop import simulate, simulate_many
from fuzzyarm.control.loop.many import Bench
from fuzzyarm.control.loop.program import loop_for
from fuzzyarm.inference.aggregate import positions
from fuzzyarm.inference.overlap import Layers, closed_form
from fuzzyarm.inference.sets import polyline, straight_pieces
from fuzzyarm.language import load_rulebase
from fuzzyarm.language.model.rulebase import RuleBase, Variable, propositions
from fuzzyarm.language.model.shapes import membership
from fuzzyarm.plant import reach_return
from fuzzyarm.symbolic.kernels import processors
from fuzzyarm.table import read_table

try:  # a tree of before, which `beside.py` measures with these scripts, may have other names
    from fuzzyarm.control.loop.program import RunRecord
except ImportError:
    from fuzzyarm.control.loop.program import Record as RunRecord
try:
    from fuzzyarm.control.loop.simulation import experiment_of
except ImportError:
    from fuzzyarm.control.loop.many import experiment_of

sys.path.insert(0, str(Path(__file__).parent))
from workload import exact_controller

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

_rooms: dict[int, Any] = {}

WITH_DATA = {"LUT", "CDID_LUT", "SOC", "DIRECT", "STFC", "CFAF", "HFIE"}
EXACT = ("fuzzy-direct", "stfc", "cfaf", "hfie")
"""Those that are measured with the exact centroid, too."""

GOAL = 1.5
"""Of the exact ones and of SOC: times the loop in C."""


def c_array(values: object) -> str:
    """Write nested numbers as a C initialiser."""
    if isinstance(values, (list, tuple)):
        return "{" + ", ".join(c_array(each) for each in values) + "}"
    return repr(values)


def conclusions(rulebase: RuleBase) -> list[list[int]]:
    """Return the index of the term that the rule of each pair of terms concludes."""
    e, ce = rulebase.inputs
    names = {v.name: [t.name for t in v.terms] for v in (e, ce, rulebase.outputs[0])}
    then = [[0] * 7 for _ in range(7)]
    for rule in rulebase.rules:
        parts = {part.variable: part.term for part in propositions(rule.antecedent)}
        row, column = (names[v.name].index(parts[v.name]) for v in (e, ce))
        then[row][column] = names[rulebase.outputs[0].name].index(rule.consequents[0].term)
    return then


def c_rules(name: str, rulebase: RuleBase) -> str:
    """Write a 7 × 7 rule base with trapezoids as C data."""
    e, ce = rulebase.inputs
    output = rulebase.outputs[0]

    def corners(kind: str, p: tuple[float, ...]) -> list[float]:
        return [p[0], p[1], p[1], p[2]] if kind == "triangle" else list(p)

    sets = {v.name: [corners(t.shape.kind, t.shape.parameters) for t in v.terms] for v in (e, ce)}
    x = positions(output.low, output.high, 101, "endpoints")
    sampled = [[membership(term.shape, each) for each in x] for term in output.terms]
    spans = [[i for i, y in enumerate(values) if y > 0.0] for values in sampled]
    fields = [
        sets[e.name],
        sets[ce.name],
        conclusions(rulebase),
        x,
        sampled,
        [span[0] for span in spans],
        [span[-1] + 1 for span in spans],
    ]
    return f"static const struct rules {name} = {c_array(fields)};\n"


CELLS = 8
"""Even stretches of the inputs, in each of which two terms are straight lines."""


def c_exact_rules(name: str, rulebase: RuleBase) -> str:
    """Write a 7 × 7 rule base over even partitions as C data for the exact centroid."""
    then, (output,) = conclusions(rulebase), rulebase.outputs
    pieces = [straight_pieces(polyline(t.shape), output.low, output.high) for t in output.terms]
    form = closed_form(pieces, output.low, output.high)
    assert form is not None
    # A tree of before calls them otherwise.
    set_layers = form.set_layers if hasattr(form, "set_layers") else form.own
    own = [layer(layers, 1.0) for layers in set_layers]
    pairs = {(min(o.member, *o.others), max(o.member, *o.others)): o for o in form.overlaps}
    overlaps = [layer(pairs[k, k + 1].layers, -1.0) for k in range(6)]
    assert len(pairs) == 6
    fields = [*(cells(each) for each in rulebase.inputs), then, own, overlaps, form.centre]
    return f"static const struct rules {name} = {c_array(fields)};\n"


def layer(layers: Layers, sign: float) -> list[float]:
    """Return depth and coefficients of the only layer of a set, or of an overlap less it."""
    (one,) = layers
    assert one.start == 0.0
    return [one.depth, *(sign * each for each in one[2:])]


def cells(variable: Variable) -> list[object]:
    """Return for each cell its first term, and the lines of this and of the next one."""
    width = (variable.high - variable.low) / CELLS
    rows: list[object] = []
    for cell in range(CELLS):
        low = variable.low + cell * width
        first = min(max(cell - 1, 0), 5)
        lines = []
        for term in variable.terms[first : first + 2]:
            left, right = (membership(term.shape, x) for x in (low, low + width))
            lines.append([left, low, (right - left) / width])
        rows.append([first, lines])
    return rows


def write_data(folder: Path) -> None:
    """Write the rules and tables of the shipped files as C data."""
    table = read_table(shipped("thesis-6.1.lut"))
    performance = read_table(shipped("performance-yamazaki.lut"))
    text = (
        "#ifdef EXACT\n"
        f"enum {{ CELLS = {CELLS} }};\n"
        "struct cell { int first; double line[2][3]; };\n"
        "struct rules { struct cell e[CELLS], ce[CELLS]; int then[7][7]; "
        "double set[7][6], overlap[6][6], centre; };\n"
        "#else\n"
        "struct rules { double e[7][4], ce[7][4]; int then[7][7]; "
        "double at[101], set[7][101]; int first[7], stop[7]; };\n"
        "#endif\n"
        f"static const double bins[12] = {c_array(list(table.axes[0].bins or ()))};\n"
        f"static const double control_table[13][13] = {c_array(table.values.tolist())};\n"
        f"static const double performance_table[13][13] = {c_array(performance.values.tolist())};\n"
    )
    control, alpha = (load_rulebase(shipped(f"{name}7-study.frb")) for name in ("pd", "alpha"))
    text += "#ifdef EXACT\n"
    text += c_exact_rules("control_rules", control) + c_exact_rules("alpha_rules", alpha)
    text += "#else\n"
    text += c_rules("control_rules", control) + c_rules("alpha_rules", alpha)
    text += "#endif\n"
    (folder / "closed_loop_data.h").write_text(text)


def compile_c(folder: Path, control: str, *flags: str) -> Path | None:
    """Build the C loop of one controller; None where there is no compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    program = folder / "".join([control, *flags])
    words = [compiler, "-O3", f"-DCONTROL={control}", f"-I{folder}", *flags]
    if control in WITH_DATA:
        words.append("-DWITH_DATA")
    source = Path(__file__).with_suffix(".c")
    subprocess.run([*words, str(source), "-o", str(program), "-lm"], check=True)
    return program


def run_c(program: Path) -> tuple[float, float, float]:
    """Return the least seconds of a run and the two RMS errors."""
    words = subprocess.run(
        [str(program), str(REPEATS)], check=True, capture_output=True, text=True
    ).stdout.split()
    seconds, first, second = map(float, words)
    return seconds, first, second


class Ours(NamedTuple):
    """What is measured of one controller."""

    loop: Callable[[], float]
    call: Callable[[], float]
    rms: tuple[float, float]


def begun(course: Any, program: Any, taps: Any) -> Callable[[], None]:
    """Return what runs a loop once: a record that is full is not run again.

    It records into memory that is kept, as sweeps do: of fresh memory the system takes 6 to 10 ns a
    period to give the pages.
    """
    room = _rooms.setdefault(len(taps), np.zeros(len(taps) * len(course.motion.time)))
    record = RunRecord(course, program.memory, taps, room=room)
    loop = loop_for(program, course, record)
    if hasattr(record, "block"):
        block = record.block(program)
        return lambda: loop(block)
    arrays = (*course.inputs(), *program.inputs(), *record.outputs)  # a tree of before
    return lambda: loop(*arrays)


def ours_of(made: Any) -> Ours:
    """Return what measures a controller: seconds of the loop, and of a whole call."""
    bench = Bench(experiment_of(made, reach_return()), ["payload"])
    course, program = bench.loop.course, bench.loop.program

    def loop() -> float:
        run = begun(course, program, bench.loop.taps)
        begin = time.thread_time()
        run()
        return time.thread_time() - begin

    def call() -> float:
        begin = time.thread_time()
        simulate(made, reach_return(), payload=True)
        return time.thread_time() - begin

    run = simulate(made, reach_return(), payload=True)
    return Ours(loop, call, (float(run.rms[0]), float(run.rms[1])))


def compare(name: str, made: Any, programs: list[Path]) -> list[str]:
    """Return the cells of one line: C, ours, ratios, and whether the figures are the same."""
    # Where C has two ways (to ask whether a set fired, or not) the faster one counts.
    program = min(programs, key=lambda each: run_c(each)[0])
    ours = ours_of(made)
    rounds = []
    for _ in range(ROUNDS):
        c = run_c(program)
        loop, call = (min(what() for _ in range(REPEATS)) for what in (ours.loop, ours.call))
        rounds.append((c[0], loop, call))
    ratios = sorted(loop / c for c, loop, _ in rounds)
    _, first, second = run_c(program)
    apart = max(abs(first / ours.rms[0] - 1.0), abs(second / ours.rms[1] - 1.0))
    has_goal = "exact" in name or name == "soc-zero"
    return [
        name,
        f"{1e3 * min(c for c, _, _ in rounds):.2f}",
        f"{1e3 * min(loop for _, loop, _ in rounds):.2f}",
        f"{statistics.median(ratios):.2f}",
        f"{ratios[0]:.2f} to {ratios[-1]:.2f}",
        f"{statistics.median(call / c for c, _, call in rounds):.2f}",
        f"≤ {GOAL:g}" if has_goal else "",
        f"{apart:.0e}",
    ]


def measured(folder: Path, wanted: list[str]) -> list[list[str]]:
    """Return the lines of all controllers, or of those that are named."""
    rows = []
    for name, control in CONTROLS.items():
        if not wanted or name in wanted:
            program = compile_c(folder, control)
            assert program is not None
            rows.append(compare(name, controller(name), [program]))
    for name in EXACT:
        if not wanted or name in wanted:
            made = exact_controller(folder, name)
            ways = [["-DEXACT"], ["-DEXACT", "-DASKING"]]
            programs = [compile_c(folder, CONTROLS[name], *flags) for flags in ways]
            rows.append(compare(f"{name}, exact", made, [each for each in programs if each]))
    return rows


def batches() -> list[str]:
    """Return how much faster many runs are with a thread for each processor."""
    lines = []
    for name in ("cdid", "soc-zero", "fuzzy-direct"):
        made, path = controller(name), reach_return()
        seconds = []
        for workers in (1, processors()):
            begin = time.perf_counter()
            simulate_many(made, path, {"seed": np.arange(200)}, payload=True, workers=workers)
            seconds.append(time.perf_counter() - begin)
        lines.append(
            f"200 runs of {name}: {1e3 * seconds[0] / 200:.2f} ms a run with one thread, "
            f"{1e3 * seconds[1] / 200:.2f} with {processors()}: {seconds[0] / seconds[1]:.2f} "
            "times as fast"
        )
    return lines


HEADINGS = ["controller", "C, ms", "here, ms", "ratio", "spread", "whole call", "goal", "RMS apart"]


def main(words: list[str] | None = None) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="the closed loop against plain C")
    parser.add_argument("--markdown", action="store_true")
    parser.add_argument("names", nargs="*", help="controllers; all by default")
    arguments = parser.parse_args(sys.argv[1:] if words is None else words)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if shutil.which("gcc") is None and shutil.which("cc") is None:
            print("no C compiler here: nothing to compare with")
            return 0
        write_data(folder)
        rows = [HEADINGS, *measured(folder, arguments.names)]
    if arguments.markdown:
        rows.insert(1, ["---"] * len(HEADINGS))
        print("\n".join(f"| {' | '.join(row)} |" for row in rows))
    else:
        widths = [max(len(row[i]) for row in rows) for i in range(len(HEADINGS))]
        for row in rows:
            print("  ".join(f"{cell:>{width}}" for cell, width in zip(row, widths, strict=True)))
    if not arguments.names:
        print("\n".join(batches()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
