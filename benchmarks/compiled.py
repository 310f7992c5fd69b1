"""Compiled inference against plain C, pyfuzzylite and scikit-fuzzy, in one run.

    python benchmarks/compiled.py --fuzzylite ENV/bin/python --write

Compiles ``compiled.c`` with ``gcc -O3`` (no other flags) where a C compiler is present.
pyfuzzylite 8 needs NumPy below 2 and so an environment of its own;
FUZZYARM_FUZZYLITE_PYTHON may name its Python, too. ``--write`` puts the table into
docs/explanation/performance.md and draws its pictures. Times are of the processor (all run on one
core), so that a busy machine does less harm. Ratios are medians over rounds, in each of
which both sides were measured; in parentheses the middle half of the rounds.
"""

from __future__ import annotations

import argparse
import ctypes
import functools
import json
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import workload
from compiled_pictures import draw
from ratios import Ratio, in_turns, number, quarters, ratio

import fuzzyarm.inference.sweeps as sweeps  # noqa: PLR0402 - the package has no such name
from fuzzyarm import compiled, infer
from fuzzyarm.base.files import write_atomically
from fuzzyarm.inference.sets import polyline
from fuzzyarm.language.model.rulebase import RuleBase

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/explanation/performance.md"
POINTS = 1_000_000
ROUNDS = 15
SKFUZZY_POINTS = 2_000
RULES = (10, 30, 100, 300, 1_000, 3_000, 10_000)

CORNERS = 8


class Row(NamedTuple):
    """One line of the table."""

    what: str
    ratio: Ratio
    target: str
    met: bool
    times: str = ""

    def text(self) -> str:
        """Return the line in Markdown."""
        verdict = "yes" if self.met else "**no**"
        return f"| {self.what} | {self.ratio} | {self.target} | {verdict} | {self.times} |"


class Measured(NamedTuple):
    """Everything that one run found."""

    rows: list[Row]
    microseconds: dict[str, float]
    checks: dict[int, float]
    profile: list[tuple[str, float]]


class Term(ctypes.Structure):
    """As in compiled.c."""

    _fields_ = (
        ("corners", ctypes.c_int),
        ("x", ctypes.c_double * CORNERS),
        ("y", ctypes.c_double * CORNERS),
    )


def c_terms(rulebase: RuleBase, name: str) -> Any:
    """Return the terms of a variable for C."""
    found = (Term * 7)()
    for term, source in zip(found, rulebase.variable(name).terms, strict=True):
        corners = polyline(source.shape)
        term.corners = len(corners)
        for i, (x, y) in enumerate(corners):
            term.x[i], term.y[i] = x, y
    return found


def build_c(folder: Path) -> list[ctypes.CDLL]:
    """Compile the C loops, without and with branches; none where there is no compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return []
    source, built = str(Path(__file__).with_suffix(".c")), []
    for name, more in (("plain", []), ("asking", ["-DASKING"])):
        library = str(folder / f"{name}.so")
        words = [compiler, "-O3", *more, "-shared", "-fPIC", source, "-o", library]
        subprocess.run(words, check=True)
        built.append(ctypes.CDLL(library))
    return built


def pointer(array: np.ndarray[Any, Any]) -> ctypes.c_void_p:
    """Return where an array begins."""
    return ctypes.c_void_p(array.ctypes.data)


def c_loop(
    library: ctypes.CDLL, rulebase: RuleBase, e: Any, ce: Any, u: Any, *, even: bool
) -> Callable[[], object]:
    """Return an action that evaluates all points in C."""
    rules = (ctypes.c_int * 49)(*workload.table(rulebase))
    arrays = [pointer(array) for array in (e, ce, u)]
    low, high = ctypes.c_double(workload.LOW), ctypes.c_double(workload.HIGH)
    terms = [] if even else [c_terms(rulebase, name) for name in ("e", "ce", "u")]
    function = library.even if even else library.straight
    return lambda: function(*arrays, ctypes.c_long(u.size), rules, *terms, low, high)


def against_c(
    libraries: list[ctypes.CDLL], title: str, *, even: bool, grid: bool
) -> tuple[Row, float, float]:
    """Measure points against the faster C; return the row and the seconds a point of both."""
    rulebase = workload.even() if even else workload.uneven()
    fast = compiled(rulebase)
    if grid:
        axis = np.linspace(workload.LOW, workload.HIGH, 201)
        inputs: dict[str, Any] = {"e": axis[:, None], "ce": axis[None, :]}
        e, ce = (np.ascontiguousarray(a).ravel() for a in np.meshgrid(axis, axis, indexing="ij"))
    else:
        e, ce = np.random.default_rng(1).uniform(workload.LOW, workload.HIGH, (2, POINTS))
        inputs = {"e": e, "ce": ce}
    u = np.empty(e.size)
    loops = [c_loop(library, rulebase, e, ce, u, even=even) for library in libraries]
    tried = [statistics.median(in_turns(loop, loop, 3)[1]) for loop in loops]
    by_hand = loops[tried.index(min(tried))]
    by_hand()
    apart = float(np.abs(fast(inputs)["u"].ravel() - u).max())
    if apart > 1e-9:
        raise SystemExit(f"{title}: C and fuzzyarm are {apart:g} apart")
    ours, theirs = in_turns(lambda: fast(inputs), by_hand, ROUNDS if not grid else 6 * ROUNDS)
    found, most = ratio(ours, theirs), 2.0 if even else 1.5
    each = statistics.median(ours) / e.size
    hand = statistics.median(theirs) / e.size
    times = f"{1e9 * each:.1f} ns, C {1e9 * hand:.1f} ns"
    return Row(title, found, f"≤ {most:g}", found.median <= most, times), each, hand


def fuzzylite(python: str) -> dict[str, list[float]]:
    """Measure pyfuzzylite in its own environment."""
    words = [python, str(ROOT / "benchmarks/fuzzylite_points.py"), "10000", "7"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout.splitlines()[-1]))


def skfuzzy() -> dict[str, list[float]]:
    """Measure scikit-fuzzy's control systems with 101 samples."""
    from skfuzzy import control, trimf  # noqa: PLC0415 - takes a third of a second

    rulebase = workload.even()
    universe = np.linspace(workload.LOW, workload.HIGH, 101)
    variables = [control.Antecedent(universe, name) for name in ("e", "ce")]
    u = control.Consequent(universe, "u")
    for variable in (*variables, u):
        for term in rulebase.inputs[0].terms:
            variable[term.name] = trimf(universe, term.shape.parameters)
    rules = []
    for rule in rulebase.rules:
        first, second = (part.term for part in rule.antecedent.operands)  # type: ignore[union-attr]
        then = u[rule.consequents[0].term]
        rules.append(control.Rule(variables[0][first] & variables[1][second], then))
    simulation = control.ControlSystemSimulation(control.ControlSystem(rules), cache=False)
    e, ce = np.random.default_rng(1).uniform(workload.LOW, workload.HIGH, (2, SKFUZZY_POINTS))
    found: dict[str, list[float]] = {"arrays": [], "single": []}
    for way, count, values in (
        ("single", 1, [(float(a), float(b)) for a, b in zip(e[:7], ce[:7], strict=True)]),
        ("arrays", SKFUZZY_POINTS, [(e, ce)] * 3),
    ):
        for first, second in values:
            simulation.reset()
            simulation.input["e"], simulation.input["ce"] = first, second
            start = time.process_time()
            simulation.compute()
            found[way].append((time.process_time() - start) / count)
    return found


def single_times() -> dict[str, list[float]]:
    """Measure one point, called from Python: by name, and in order."""
    fast = compiled(workload.even())
    values = np.random.default_rng(2).uniform(workload.LOW, workload.HIGH, (500, 2)).tolist()
    found: dict[str, list[float]] = {"by name": [], "in order": [], "plain Python": []}
    for _ in range(ROUNDS):
        start = time.process_time()
        for e, ce in values:
            fast(e=e, ce=ce)
        middle = time.process_time()
        for e, ce in values:
            fast.at(e, ce)
        end = time.process_time()
        found["by name"].append((middle - start) / len(values))
        found["in order"].append((end - middle) / len(values))
        start = time.process_time()
        for e, ce in values[:50]:
            infer(fast.rulebase, e=e, ce=ce)
        found["plain Python"].append((time.process_time() - start) / 50)
    return found


def three_inputs() -> tuple[Row, float]:
    """Measure 343 rules on three inputs against 49 on two."""
    actions = []
    for rulebase in (workload.many_inputs(7, 3), workload.even()):
        points = np.random.default_rng(3).uniform(
            workload.LOW, workload.HIGH, (len(rulebase.inputs), POINTS)
        )
        names = [each.name for each in rulebase.inputs]
        inputs = dict(zip(names, points, strict=True))
        actions.append(functools.partial(compiled(rulebase), inputs))
    for action in actions:
        action()
    large, small = in_turns(actions[0], actions[1], ROUNDS)
    found = ratio(large, small)
    what = "343 rules on three inputs / 49 on two, random points"
    each = statistics.median(large) / POINTS
    return Row(what, found, "≤ 4", found.median <= 4.0, f"{1e9 * each:.1f} ns"), each


def checks() -> list[dict[int, float]]:
    """Measure `fuzzyarm check` on files of 10 to 10,000 rules; processor seconds in each round."""
    command = Path(sys.executable).with_name("fuzzyarm")
    found: list[dict[int, float]] = []
    with tempfile.TemporaryDirectory() as folder:
        files = {rules: Path(folder) / f"rules{rules}.frb" for rules in RULES}
        for rules, file in files.items():
            file.write_text(workload.rule_file(rules), encoding="utf-8")
        for _ in range(7):
            found.append({})
            for rules, file in files.items():
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                subprocess.run([str(command), "check", str(file)], check=True, capture_output=True)
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
                found[-1][rules] = spent
    return found


def start_up() -> Row:
    """Measure a second process: from numba imported to the first value of a new rule base."""
    script = """
import sys, time
sys.path.insert(0, sys.argv[1])
import numpy, numba
import workload, dataclasses
rulebase = workload.uneven()
output = dataclasses.replace(rulebase.outputs[0], high=6.0 + float(sys.argv[2]))
rulebase = dataclasses.replace(rulebase, outputs=(output,))
start = time.process_time()
from fuzzyarm import compiled
compiled(rulebase)(e=1.3, ce=-2.2)
print(time.process_time() - start)
"""
    times = []
    for i in range(7):
        words = [sys.executable, "-c", script, str(ROOT / "benchmarks"), str(0.1 * i)]
        done = subprocess.run(words, check=True, capture_output=True, text=True)
        times.append(float(done.stdout))
    found = quarters(times)
    what = (
        "another process, an edited rule base: processor seconds to the first value, numba imported"
    )
    return Row(what, found, "< 0.3", found.median < 0.3)


def profile() -> list[tuple[str, float]]:
    """Return where the time of 1,000,000 random points goes, in ns a point."""
    spent = {"whole call": [], "kernel": []}  # type: dict[str, list[float]]
    real, inside = sweeps.on_block, [0.0]

    def watched(*given: Any, **named: Any) -> Callable[[], None]:
        call = real(*given, **named)

        def timed() -> None:
            start = time.process_time()
            call()
            inside[0] += time.process_time() - start

        return timed

    sweeps.on_block = watched
    sweeps.MANY, many = 1 << 62, sweeps.MANY
    fast = compiled(workload.even())
    e, ce = np.random.default_rng(1).uniform(workload.LOW, workload.HIGH, (2, POINTS))
    fast(e=e, ce=ce)
    for _ in range(ROUNDS):
        inside[0] = 0.0
        start = time.process_time()
        fast(e=e, ce=ce)
        spent["whole call"].append((time.process_time() - start) / POINTS)
        spent["kernel"].append(inside[0] / POINTS)
    sweeps.on_block, sweeps.MANY = real, many
    whole, core = (statistics.median(spent[name]) for name in ("whole call", "kernel"))
    return [
        ("kernel: finding cells, sorting, firing, integrating", 1e9 * core),
        ("chunks: copying in and out, memory of the result", 1e9 * (whole - core)),
    ]


def array_times() -> list[float]:
    """Measure 1,000,000 random points; seconds a point."""
    fast = compiled(workload.even())
    e, ce = np.random.default_rng(1).uniform(workload.LOW, workload.HIGH, (2, POINTS))
    found = []
    for _ in range(ROUNDS):
        start = time.process_time()
        fast(e=e, ce=ce)
        found.append((time.process_time() - start) / POINTS)
    return found


def against_peer(
    name: str,
    peer: Callable[[], dict[str, list[float]]],
    floors: tuple[float, float],
    micro: dict[str, float],
) -> Iterator[Row]:
    """Hold our times against those of a peer, measured just between; add them to `micro`."""
    singles, arrays = single_times(), array_times()
    times = peer()
    arrays += array_times()
    for way, more in single_times().items():
        singles[way] += more
    ours = statistics.median(arrays)
    found = quarters([each / ours for each in times["arrays"]])
    what = f"{name}, arrays / 1,000,000 random points"
    yield Row(what, found, f"≥ {floors[0]:,.0f}", found.median >= floors[0])
    for way in ("by name", "in order"):
        ours = statistics.median(singles[way])
        found = quarters([each / ours for each in times["single"]])
        what = f"{name}, one point / one point {way}"
        yield Row(what, found, f"≥ {floors[1]:,.0f}", found.median >= floors[1])
    micro[f"{name}, arrays"] = 1e6 * statistics.median(times["arrays"])
    micro[f"{name}, one point"] = 1e6 * statistics.median(times["single"])
    for way, each in singles.items():
        micro[f"one point, {way}"] = 1e6 * statistics.median(each)


def measure(python: str | None) -> Iterator[str | Measured]:
    """Measure everything; yields what is being done, and at last what was found."""
    rows: list[Row] = []
    micro: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        libraries = build_c(Path(folder))
        if not libraries:
            yield "no C compiler: nothing is held against C"
        else:
            for title, even, grid in (
                ("1,000,000 random points, strong triangular partitions / C", True, False),
                ("1,000,000 random points, any piecewise-linear terms / C", False, False),
                ("201 × 201 table, strong triangular partitions / C", True, True),
                ("201 × 201 table, any piecewise-linear terms / C", False, True),
            ):
                yield title
                row, each, hand = against_c(libraries, title, even=even, grid=grid)
                rows.append(row)
                what = title.removesuffix(" / C")
                micro[what] = 1e6 * each
                micro[f"C, {what}"] = 1e6 * hand
    yield "three inputs"
    rows.append(three_inputs()[0])
    if python:
        yield "pyfuzzylite"
        rows += against_peer("pyfuzzylite", lambda: fuzzylite(python), (150.0, 2_000.0), micro)
    yield "scikit-fuzzy"
    rows += against_peer("scikit-fuzzy", skfuzzy, (5_000.0, 10_000.0), micro)
    yield "start of another process"
    rows.append(start_up())
    yield "fuzzyarm check"
    rounds = checks()
    found = quarters([each[10_000] for each in rounds])
    rows.append(
        Row("`fuzzyarm check`, 10,000 rules: processor seconds", found, "< 1", found.median < 1.0)
    )
    what = "a rule more: from 1,000 to 10,000 rules / from 100 to 1,000"
    found = quarters([(t[10_000] - t[1_000]) / 9_000 / ((t[1_000] - t[100]) / 900) for t in rounds])
    rows.append(Row(what, found, "≈ 1 (linear)", 0.75 < found.median < 1.33))
    seconds = {rules: statistics.median(each[rules] for each in rounds) for rules in RULES}
    yield "profile"
    yield Measured(rows, micro, seconds, profile())


def lines_of(found: Measured) -> str:
    """Return tables in Markdown."""
    lines = ["| ratio | median (middle half) | target | met | a point |", "|---|---|---|---|---|"]
    lines += [row.text() for row in found.rows]
    lines += ["", "| a point | µs |", "|---|---|"]
    lines += [f"| {what} | {number(value)} |" for what, value in found.microseconds.items()]
    lines += ["", "| rules | `fuzzyarm check`, processor seconds |", "|---|---|"]
    lines += [f"| {rules:,} | {seconds:.3f} |" for rules, seconds in found.checks.items()]
    lines += ["", "| where the time of a random point goes | ns |", "|---|---|"]
    lines += [f"| {what} | {value:.1f} |" for what, value in found.profile]
    return "\n".join(lines)


def write_page(text: str) -> None:
    """Put the tables between the marks in docs/explanation/performance.md."""
    page = PAGE.read_text(encoding="utf-8")
    start, end = "<!-- compiled inference: begin -->", "<!-- compiled inference: end -->"
    pattern = re.compile(re.escape(start) + ".*?" + re.escape(end), re.DOTALL)
    write_atomically(PAGE, pattern.sub(lambda _: f"{start}\n{text}\n{end}", page))


def main(words: list[str] | None = None) -> int:
    """Measure, print, and write if asked to."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--fuzzylite",
        default=os.environ.get("FUZZYARM_FUZZYLITE_PYTHON"),
        metavar="PYTHON",
        help="Python of an environment with pyfuzzylite 8",
    )
    parser.add_argument(
        "--write", action="store_true", help="renew docs/explanation/performance.md"
    )
    arguments = parser.parse_args(words)
    if not arguments.fuzzylite:
        print("pyfuzzylite's Python is not given (--fuzzylite): it is left out", file=sys.stderr)
    for step in measure(arguments.fuzzylite):
        if isinstance(step, str):
            print(f"… {step}", file=sys.stderr)
            continue
        print(lines_of(step))
        if arguments.write:
            write_page(lines_of(step))
            draw(step.microseconds, step.checks)
    return 0


if __name__ == "__main__":
    sys.exit(main())
