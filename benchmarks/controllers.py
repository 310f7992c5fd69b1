"""A period of every shipped controller: exported C beside the kernel of the closed loop.

Each controller without a partner is exported in double precision and compiled with
``gcc -O2``; the same periods (errors of every size) run through it and through the kernel as
machine code, in turns. Printed are nanoseconds of a period and the ratio of the medians, with
the operations that both take at most, and the time of ``run().step`` from Python.

usage: python benchmarks/controllers.py [--markdown]
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

from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.control.controllers.kernel import step
from fuzzyarm.exchange.export.c_files import controller_c
from fuzzyarm.exchange.export.cost import step_cost
from fuzzyarm.exchange.export.trial import trial
from fuzzyarm.exchange.export.walk_of_steps import steps_of
from fuzzyarm.exchange.files import load
from fuzzyarm.plant.setting import stored_double
from fuzzyarm.symbolic.kernels import kernel, routine

ROUNDS = 7
PERIODS = 5_000
SECONDS = 0.02
"""Of one measurement, at least."""

MAIN = """#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <time.h>
#include "made.h"
static double rows[{periods}][{columns}];
int main(int argc, char **argv)
{{
    static made_state s;
{declared}
    FILE *in = fopen(argv[1], "rb");
    long turns = 0;
    struct timespec from, to;
    double sum = 0.0, spent;
    unsigned k;
    if (argc != 2 || fread(rows, sizeof rows, 1, in) != 1) {{
        return 1;
    }}
    clock_gettime(CLOCK_MONOTONIC, &from);
    do {{
        made_init(&s);
        for (k = 0; k < {periods}u; k++) {{
{sets}
            made_step({called});
            sum += {first};
        }}
        turns++;
        clock_gettime(CLOCK_MONOTONIC, &to);
        spent = (double)(to.tv_sec - from.tv_sec) + 1e-9 * (double)(to.tv_nsec - from.tv_nsec);
    }} while (spent < {seconds});
    printf("%.17g %.17g\\n", 1e9 * spent / (double)turns / {periods}.0, sum);
    return 0;
}}
"""


@kernel
def many(k, s, rows, ports, drive):
    """Run a controller over rows; leave the sum of a drive behind the last row."""
    columns = ports.shape[0]
    total = 0.0
    for period in range(rows.shape[0] // columns):
        for i in range(columns):
            s[ports[i]] = rows[period * columns + i]
        step(k, s)
        total += s[drive[0]]
    s[drive[0]] = total


class Case:
    """One controller, both ways."""

    def __init__(self, name: str, folder: Path) -> None:
        self.text = load(shipped(f"{name}.frb"))
        self.steps = steps_of(self.text)
        ports = [*self.steps.of_sort("reference"), *self.steps.of_sort("measured")]
        self.given = list(trial(self.steps, PERIODS))
        self.rows = np.array([[each[port.symbol] for port in ports] for each in self.given])
        self.run = self.text.run(compiled=True)
        wiring = self.run._wiring
        cells = {"reference": wiring.references, "measured": wiring.measured}
        self.cells = np.array([cells[p.sort][p.axis, p.name] for p in ports], np.int64)
        self.drive = np.array([next(iter(wiring.drives.values()))], np.int64)
        self.program = self._compiled(folder, ports)

    def _compiled(self, folder: Path, ports: list) -> Path:
        made = controller_c(self.steps, "made", "made", ".h", None, ["a benchmark"])
        (folder / "made.h").write_text(made.files[".h"])
        sorts = [s for s in ("reference", "measured", "drive") if self.steps.of_sort(s)]
        types = {"reference": "reference", "measured": "measured", "drive": "drives"}
        text = MAIN.format(
            periods=PERIODS,
            columns=len(ports),
            seconds=SECONDS,
            declared="\n".join(f"    static made_{types[sort]} {sort};" for sort in sorts),
            sets="\n".join(
                f"            {made.place(port)} = rows[k][{i}];" for i, port in enumerate(ports)
            ),
            called=", ".join(["&s", *(f"&{sort}" for sort in sorts)]),
            first=made.place(self.steps.of_sort("drive")[0]),
        )
        (folder / "main.c").write_text(text)
        program, data = folder / "main", folder / "rows.bin"
        data.write_bytes(self.rows.tobytes())
        words = ["-std=c99", "-O2", "-ffp-contract=off", "main.c", "-o", str(program), "-lm"]
        subprocess.run(["gcc", *words], cwd=folder, check=True)
        return program

    def in_c(self) -> tuple[float, float]:
        """Return nanoseconds of a period and the sum of a drive."""
        data = self.program.parent / "rows.bin"
        words = [str(self.program), str(data)]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        spent, total = map(float, done.stdout.split())
        return spent, total

    def in_kernel(self) -> float:
        """Return nanoseconds of a period as machine code."""
        call = routine(many, "iffii", {"stored": stored_double}, compiled=True)
        rows = self.rows.ravel()
        turns, begin = 0, time.perf_counter()
        while time.perf_counter() - begin < SECONDS:
            self.run.start()
            call(self.run._code, self.run._cells, rows, self.cells, self.drive)
            turns += 1
        return 1e9 * (time.perf_counter() - begin) / turns / PERIODS

    def from_python(self) -> float:
        """Return nanoseconds of a call of `step`."""
        sides = [
            tuple(
                {self.steps.port_name(p): each[p.symbol] for p in self.steps.of_sort(sort)}
                for sort in ("measured", "reference")
            )
            for each in self.given[:500]
        ]
        begin = time.perf_counter()
        for measured, reference in sides:
            self.run.step(measured, reference)
        return 1e9 * (time.perf_counter() - begin) / len(sides)


def controllers() -> list[str]:
    """Return the shipped controllers without partners."""
    found = []
    for file in sorted(shipped_names()):
        if file.endswith(".frb"):
            text = load(shipped(file))
            model = getattr(text, "model", None)
            if model is not None and not model.partners:
                found.append(Path(file).stem)
    return found


def main() -> int:
    """Measure and print."""
    if shutil.which("gcc") is None:
        print("no gcc here: exported controllers are not measured")
        return 0
    markdown = "--markdown" in sys.argv
    titles = (
        "controller", "C, ns", "kernel, ns", "kernel / C", "step, us", "operations in C",
        "of the kernel",
    )  # fmt: skip
    row = "| {:<26} | {:>7} | {:>10} | {:>10} | {:>8} | {:>15} | {:>14} |"
    if not markdown:
        row = row.replace("| ", "").replace(" |", "")
    print(row.format(*titles))
    if markdown:
        print(row.format(*("---" for _ in titles)))
    for name in controllers():
        with tempfile.TemporaryDirectory() as folder:
            case = Case(name, Path(folder))
            case.in_kernel()
            pairs = [(case.in_c()[0], case.in_kernel()) for _ in range(ROUNDS)]
            c, machine = (statistics.median(column) for column in zip(*pairs, strict=True))
            cost = step_cost(case.text)
            kernel_words = f"{cost.least.total():,} .. {cost.most.total():,}"
            print(
                row.format(
                    name, f"{c:.0f}", f"{machine:.0f}", f"{machine / c:.2f}",
                    f"{case.from_python() / 1e3:.1f}", f"{cost.exported.total():,}", kernel_words,
                ),
                flush=True,
            )  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())
