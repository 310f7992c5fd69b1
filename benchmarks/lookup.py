"""Table look-up against plain C: 1,000,000 random points, by bins, nearest and bilinear.

Compiles ``lookup.c`` with ``gcc -O3``, runs both in turns and prints the medians, the ratio
and its spread over the rounds; then the peak memory of compiling a 4000 x 4000 table.
"""

from __future__ import annotations

import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from fuzzyarm import shipped
from fuzzyarm.table import LookupTable, read_table

POINTS = 1_000_000
ROUNDS = 7
REPEATS = 9
MODES = ("bins", "nearest", "linear")

MEMORY = """
import re
from fuzzyarm import shipped
from fuzzyarm.table import compile_table
from fuzzyarm.language import load_rulebase

def peak():  # of this program alone; getrusage would begin with that of its parent
    with open("/proc/self/status") as status:
        return 1024 * int(re.search(r"VmHWM:\\s+(\\d+)", status.read())[1])

model = load_rulebase(shipped("pd7.frb"))
compile_table(model, levels=10)
before = peak()
table = compile_table(model, levels=4000, rounding=0)
print((peak() - before) / table.values.nbytes)
"""


def compile_c(folder: Path) -> Path | None:
    """Build the C loops; None where there is no compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    program = folder / "lookup"
    subprocess.run(
        [compiler, "-O3", str(Path(__file__).with_suffix(".c")), "-o", program], check=True
    )
    return program


def write_points(table: LookupTable, x: np.ndarray, y: np.ndarray, path: Path) -> None:
    """Write the table and the points for the C program."""
    rows, columns = table.axes
    parts = [
        [len(rows.levels), len(columns.levels), x.size],
        rows.levels, columns.levels, rows.thresholds("bins"), columns.thresholds("bins"),
        table.values.ravel(), x, y,
    ]  # fmt: skip
    np.concatenate(parts).tofile(path)


def run_c(program: Path, data: Path) -> dict[str, tuple[float, float]]:
    """Return for each mode the median nanoseconds per point and the sum of the values."""
    words = [str(program), str(data), str(REPEATS)]
    lines = subprocess.run(words, check=True, capture_output=True, text=True).stdout.split("\n")
    pairs = [tuple(map(float, line.split())) for line in lines if line]
    return {mode: (pair[0], pair[1]) for mode, pair in zip(MODES, pairs, strict=True)}


def run_python(table: LookupTable, x: np.ndarray, y: np.ndarray) -> dict[str, tuple[float, float]]:
    """Return the same of ``table.lookup``."""
    found = {}
    for mode in MODES:
        times = []
        for _ in range(REPEATS):
            begin = time.perf_counter()
            values = table.lookup(x, y, mode=mode)
            times.append(time.perf_counter() - begin)
        found[mode] = (1e9 * statistics.median(times) / x.size, float(values.sum()))
    return found


def main() -> int:
    """Measure and print."""
    table = read_table(shipped("thesis-6.1.lut"))
    random = np.random.default_rng(1)
    x, y = random.uniform(-6.5, 6.5, (2, POINTS))
    begin = time.perf_counter()
    run_python(table, x, y)
    print(f"first calls in this process: {time.perf_counter() - begin:.2f} s")
    with tempfile.TemporaryDirectory() as folder:
        program = compile_c(Path(folder))
        if program is None:
            print("no C compiler here: nothing to compare with")
        else:
            write_points(table, x, y, Path(folder) / "points.bin")
            rounds = [
                (run_c(program, Path(folder) / "points.bin"), run_python(table, x, y))
                for _ in range(ROUNDS)
            ]
            report(rounds)
    if not Path("/proc/self/status").exists():
        return 0
    memory = subprocess.run(
        [sys.executable, "-c", MEMORY], check=True, capture_output=True, text=True
    )
    print(f"peak memory of a 4000 x 4000 table: {float(memory.stdout):.2f} x the table")
    return 0


Round = tuple[dict[str, tuple[float, float]], dict[str, tuple[float, float]]]


def report(rounds: list[Round]) -> None:
    """Print medians and ratios."""
    print(f"{'':<10}{'C -O3, ns':>10}{'here, ns':>10}{'ratio':>8}   spread      sums")
    for mode in MODES:
        ratios = sorted(ours[mode][0] / c[mode][0] for c, ours in rounds)
        c_time = statistics.median(c[mode][0] for c, _ in rounds)
        our_time = statistics.median(ours[mode][0] for _, ours in rounds)
        same = abs(rounds[0][0][mode][1] - rounds[0][1][mode][1]) < 1e-6 * POINTS
        print(
            f"{mode:<10}{c_time:>10.2f}{our_time:>10.2f}{statistics.median(ratios):>8.2f}"
            f"   {ratios[0]:.2f} to {ratios[-1]:.2f}  {'agree' if same else 'DIFFER'}"
        )


if __name__ == "__main__":
    sys.exit(main())
