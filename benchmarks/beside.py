"""Every speed that is demanded of the engine, beside that of another tree, in one run.

    python benchmarks/beside.py --before OTHER/.venv/bin/python [--rounds 3] [PART …]

Both trees are measured by this folder's scripts, each in a process of its own Python, in turns; of
the rounds the best counts, so that a busy machine does less harm, and times on the clock need a
quiet one. Without `--before` this tree is measured alone. The parts are

    starts    first commands and a first point, on the clock; a check beside `import argparse`
    import    `import fuzzyarm`, processor time
    calls     one point by name and in order; 49, 2,401 and 6,561 rules over arrays
    cores     100,000 points on two cores beside one
    loops     closed loops of all controllers, and beside C with the same closed form
    tuning    pairs of trajectories a second
    runs      10,000 runs of the arm, from 500, on two cores
    size      an environment with the default installation: asks the package index

All but `size` are done if none is named.
"""

from __future__ import annotations

import argparse
import importlib.util
import itertools
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import closed_loop
import goals
import sweeps
import workload

import fuzzyarm
from fuzzyarm import compiled
from fuzzyarm.control.loop import simulate_many
from fuzzyarm.plant import reach_return
from fuzzyarm.symbolic.kernels import has_machine_code, processors

HERE = Path(__file__).resolve().parent


class Figure(NamedTuple):
    """A number that was measured.

    Attributes
    ----------
    what : str
        The name of the line.
    value : float
        In `unit`.
    unit : str
        Of the value.
    goal : float
        NaN where the demand is to be no slower than before.
    most : bool
        Whether greater is better.
    """

    what: str
    value: float
    unit: str
    goal: float = float("nan")
    most: bool = False


# --- Parts: each runs in a process of the tree that it measures ---


def starts() -> Iterator[Figure]:
    """Measure commands as a whole."""
    for goal in goals.starts():
        yield Figure(goal.what, goal.value, goal.unit, goal.goal)


def imports() -> Iterator[Figure]:
    """Measure what `import fuzzyarm` takes."""
    words = [sys.executable, "-c", "import fuzzyarm"]
    seconds = min(goals.taken(words).processor for _ in range(10))
    bare = min(goals.taken([sys.executable, "-c", "pass"]).processor for _ in range(10))
    yield Figure("`import fuzzyarm`, without Python's own start", 1e3 * (seconds - bare), "ms")


def calls() -> Iterator[Figure]:
    """Measure points one by one and over arrays."""
    for goal in itertools.islice(goals.calls(), 2):
        yield Figure(goal.what, goal.value, goal.unit, goal.goal)
    for terms, inputs, count in ((7, 2, 200_000), (7, 4, 50_000), (3, 8, 5_000)):
        even = (terms, inputs) == (7, 2)
        rulebase = workload.even() if even else workload.many_inputs(terms, inputs)
        fast, points = compiled(rulebase), goals.points_of(rulebase, count)
        fast(points)
        # On one processor: below the number from which on all are used.
        few = {name: column[:50_000] for name, column in points.items()}
        size = len(next(iter(few.values())))
        seconds = goals.best(lambda f=fast, p=few: f(p), 40, time.process_time)
        yield Figure(f"{terms**inputs:,} rules over arrays, a point", 1e9 * seconds / size, "ns")


def cores() -> Iterator[Figure]:
    """Measure what a second core is worth over arrays."""
    goal = next(goals.scaling())
    yield Figure(goal.what, goal.value, goal.unit, goal.goal, most=True)


def loops() -> Iterator[Figure]:
    """Measure closed loops, and C beside them."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        closed_loop.write_data(folder)
        for row in closed_loop.measured(folder, []):
            cells = dict(zip(closed_loop.HEADINGS, row, strict=True))
            who = cells["controller"]
            yield Figure(f"loop of {who}", float(cells["here, ms"]), "ms")
            if cells["goal"]:
                ratio = float(cells["ratio"])
                yield Figure(f"loop of {who} / C", ratio, "times", closed_loop.GOAL)


def tuning() -> Iterator[Figure]:
    """Measure pairs of trajectories a second, by the script of the tree that is measured."""
    script = _module_of("tuning")
    more = {"fuzzy-direct": [], "stfc": ["peaks alpha keep order"]}
    with tempfile.TemporaryDirectory() as name:
        for who, goal in (("fuzzy-direct", 150.0), ("stfc", 100.0)):
            text = workload.exact_controller(Path(name), who)
            lines = [script.PEAKS, script.GAINS, *more[who]]
            pairs = script.pairs_a_second(text, lines)
            yield Figure(f"tuning {who}, exact", pairs, "pairs a second", goal, most=True)


def runs() -> Iterator[Figure]:
    """Measure many runs of the arm."""
    count = 500
    for name, goal in sweeps.GOALS.items():
        changes = sweeps.changes_of(name, count)
        simulate_many(name, reach_return(), {k: v[:4] for k, v in changes.items()}, workers=2)
        begin, busy = time.perf_counter(), time.process_time()
        simulate_many(name, reach_return(), changes, workers=2)
        seconds, processor = time.perf_counter() - begin, time.process_time() - busy
        what = f"{sweeps.DEMANDED:,} runs of {name}, two cores"
        yield Figure(what, seconds * sweeps.DEMANDED / count, "s", goal)
        # On a machine that does other things, too, the clock says little.
        yield Figure(f"{what}, processor time of one run", 1e3 * processor / count, "ms")


def size() -> Iterator[Figure]:
    """Measure an environment with what `pip install` of this tree brings."""
    root = Path(fuzzyarm.__file__).parents[2]
    with tempfile.TemporaryDirectory() as name:
        subprocess.run([sys.executable, "-m", "venv", name], check=True)
        pip = [str(Path(name, "bin", "python")), "-m", "pip", "install", "--quiet"]
        lock = ["--require-hashes", "-r", str(root / "requirements/run.lock")]
        subprocess.run([*pip, *lock], check=True, capture_output=True)
        subprocess.run([*pip, "--no-deps", str(root)], check=True, capture_output=True)
        # As `du` counts: what a file takes on the disk.
        blocks = sum(path.lstat().st_blocks for path in Path(name).rglob("*"))
    yield Figure("environment of the default installation", 512 * blocks / 1e6, "MB", 400.0)


PARTS: dict[str, Callable[[], Iterator[Figure]]] = {
    "starts": starts,
    "import": imports,
    "calls": calls,
    "cores": cores,
    "loops": loops,
    "tuning": tuning,
    "runs": runs,
    "size": size,
}


def _module_of(name: str) -> Any:
    """Load a script of the measured tree: it may use what only that tree has."""
    path = Path(fuzzyarm.__file__).parents[2] / "benchmarks" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"{name}_of_tree", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


# --- Both trees in turns ---


def measured(python: str, part: str) -> list[Figure]:
    """Return the figures of a part, by a Python of some tree."""
    words = [python, str(HERE / "beside.py"), "--part", part]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        print(f"{part} failed by {python}:\n{done.stderr[-2000:]}", file=sys.stderr)
        return []
    return [Figure(*row) for row in json.loads(done.stdout.splitlines()[-1])]


def best_of(rows: list[Figure]) -> Figure:
    """Return the best of the rounds of a line."""
    return (max if rows[0].most else min)(rows, key=lambda row: row.value)


def lines(part: str, pythons: dict[str, str], rounds: int) -> Iterator[str]:
    """Measure a part in all trees, in turns; iterate over the lines of the table."""
    rows: dict[str, dict[str, list[Figure]]] = {}
    for _ in range(rounds):
        for tree, python in pythons.items():
            for figure in measured(python, part):
                rows.setdefault(figure.what, {}).setdefault(tree, []).append(figure)
    for what, trees in rows.items():
        figures = {tree: best_of(trees[tree]) for tree in trees}
        yield line(what, figures.get("before"), figures.get("now"))


def line(what: str, before: Figure | None, now: Figure | None) -> str:
    """Return a line of the table, in Markdown."""
    present = now or before
    assert present is not None
    share = f"{now.value / before.value:.2f}" if now and before else ""
    goal = present.goal
    demand, verdict = "", ""
    if not math.isnan(goal):
        demand = f"{'≥' if present.most else '≤'} {goal:g}"
        value = present.value
        verdict = "yes" if (value >= goal if present.most else value <= goal) else "**no**"
    cells = [f"{each.value:.3g} {each.unit}" if each else "—" for each in (before, now)]
    return f"| {what} | {' | '.join(cells)} | {share} | {demand} | {verdict} |"


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--before", metavar="PYTHON", help="the Python of the other tree")
    parser.add_argument("--rounds", type=int, default=3, help="of each part and tree (3)")
    parser.add_argument("--part", choices=PARTS, help=argparse.SUPPRESS)
    parser.add_argument("parts", metavar="PART", nargs="*", help=", ".join(PARTS))
    chosen = parser.parse_args()
    if chosen.part:
        if not has_machine_code():
            raise SystemExit("without machine code of these sources there is nothing to compare")
        print(json.dumps(list(PARTS[chosen.part]())))
        return 0
    for part in chosen.parts:
        if part not in PARTS:
            parser.error(f"unknown part '{part}': {', '.join(PARTS)}")
    pythons = {"before": chosen.before} if chosen.before else {}
    pythons["now"] = sys.executable
    print(f"processors: {processors()}, load {os.getloadavg()[0]:.1f}", file=sys.stderr)
    print("| what | before | now | now / before | goal | met |\n|---|---|---|---|---|---|")
    for part in chosen.parts or [part for part in PARTS if part != "size"]:
        print(f"… {part}", file=sys.stderr)
        for row in lines(part, pythons, 1 if part == "size" else chosen.rounds):
            print(row, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
