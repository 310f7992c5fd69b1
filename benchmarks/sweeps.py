"""Measure many runs of the arm: where the time of a run goes, and what 10,000 runs take.

    python benchmarks/sweeps.py [--runs N] [NAME ...]

On a machine that does other things, too, wall time says little. So processor time is measured
beside it, and that of the C loop of `closed_loop.c` in the same minutes, which tells how fast the
machine is just then.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from fuzzyarm.control.controllers import controller
from fuzzyarm.control.loop import simulate_many
from fuzzyarm.control.loop.blocks import packed
from fuzzyarm.control.loop.many import Bench, cut
from fuzzyarm.plant import reach_return
from fuzzyarm.symbolic.kernels import processors

sys.path.insert(0, str(Path(__file__).parent))
from closed_loop import CONTROLS, begun, compile_c, experiment_of, write_data

GOALS = {"fuzzy-lut": 20.0, "soc-zero": 20.0, "fuzzy-direct": 60.0, "stfc": 60.0}
"""Seconds for 10,000 runs on two cores: 20 for tables, 60 for rules."""

DEMANDED = 10_000
ROUNDS = 5


def processor_seconds(work: Callable[[], object]) -> float:
    """Return how long the processor works in this thread."""
    begin = time.thread_time()
    work()
    return time.thread_time() - begin


def c_seconds(program: Path, rounds: int = 10) -> float:
    """Return the processor time of a run of the C loop."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([str(program), str(rounds)], check=True, capture_output=True)
    return (resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before) / rounds


def changes_of(name: str, count: int) -> dict[str, np.ndarray]:
    """Return loads and a gain that differ."""
    gains = controller(name).gains
    gain = "G_e" if "G_e" in gains else next(iter(gains))
    value = gains[gain].value[0]
    shares = np.random.default_rng(1).random((2, count))
    return {"payload": 2.0 * shares[0], gain: value * (0.8 + 0.4 * shares[1])}


def measure(name: str, count: int, folder: Path) -> list[str]:
    """Return the cells of one line."""
    runs = changes_of(name, count)
    bench = Bench(experiment_of(name, reach_return()), list(runs))
    bench.rows(0, cut(runs, 0, 2), 2)
    loop = bench.loop
    few = cut(runs, 0, 20)

    def only_loop() -> float:
        return processor_seconds(begun(loop.course, loop.program, loop.taps))

    program = compile_c(folder, CONTROLS[name])
    alone, whole, c = [], [], []
    for _ in range(ROUNDS):  # in turn, for the machine changes from minute to minute
        c.append(c_seconds(program) if program is not None else float("nan"))
        alone.append(statistics.median(only_loop() for _ in range(5)))
        whole.append(processor_seconds(lambda: bench.rows(0, few, 20)) / 20)
    begin, busy = time.perf_counter(), time.process_time()
    simulate_many(name, reach_return(), runs, workers=2)
    wall, busy = time.perf_counter() - begin, time.process_time() - busy
    c_run, inside, run = map(statistics.median, (c, alone, whole))
    scaled = DEMANDED / count
    message = len(packed((bench.experiment, tuple(runs))))
    return [
        name,
        f"{1e3 * c_run:.2f}",
        f"{1e3 * inside:.2f}",
        f"{1e3 * run:.2f}",
        f"{run / c_run:.2f}",
        f"{100 * (run - inside) / run:.0f} %",
        f"{scaled * wall:.0f}",
        f"{scaled * busy / 2:.0f}",
        f"{GOALS.get(name, float('nan')):.0f}",
        f"{message / 1e3:.1f} kB + {8 * (1 + len(runs))} B",
    ]


HEADINGS = [
    "controller",
    "C loop, ms",
    "loop, ms",
    "whole run, ms",
    "run / C",
    "beside the loop",
    "10,000 on two cores, s of wall",
    "s of processor / 2",
    "goal, s",
    "message: block + run",
]


def main(words: list[str] | None = None) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=200, help="of each controller")
    parser.add_argument("names", nargs="*", default=list(GOALS))
    arguments = parser.parse_args(words if words is not None else sys.argv[1:])
    print(f"processors: {processors()}, load {os.getloadavg()[0]:.1f}", file=sys.stderr)
    print(f"| {' | '.join(HEADINGS)} |\n|{'---|' * len(HEADINGS)}")
    with tempfile.TemporaryDirectory() as name:
        write_data(Path(name))
        for each in arguments.names:
            print(f"| {' | '.join(measure(each, arguments.runs, Path(name)))} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
