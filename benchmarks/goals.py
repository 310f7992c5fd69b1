"""What a person waits for, and how work scales: each with its goal, in one run.

    python benchmarks/goals.py

Commands are timed as a whole, the least of some runs, so that a busy machine does less harm:
on the clock, which is what a person waits. Scaling compares the time on the clock with all
processors and with one. Times on the clock need a machine that is quiet for a moment, so they
are the best of some rounds.
"""

from __future__ import annotations

import itertools
import math
import os
import resource
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
import workload

import fuzzyarm.inference.sweeps as sweeps  # noqa: PLR0402 - the package has no such name
from fuzzyarm import compiled, infer
from fuzzyarm.control.controllers import CATALOGUE, controller
from fuzzyarm.control.loop import simulate_many
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant import reach_return
from fuzzyarm.symbolic.kernels import processors

ROOT = Path(__file__).resolve().parent.parent
ROUNDS = 5
RUNS = 64
"""In a batch of closed loops."""


class Goal(NamedTuple):
    """One line: what was measured, and its goal."""

    what: str
    value: float
    unit: str
    goal: float
    least: bool = False

    def text(self) -> str:
        """Return the line in Markdown."""
        met = self.value >= self.goal if self.least else self.value <= self.goal
        sign = "≥" if self.least else "≤"
        verdict = "yes" if met else "**no**"
        return f"| {self.what} | {self.value:.3g} {self.unit} | {sign} {self.goal:g} | {verdict} |"


class Taken(NamedTuple):
    """What a command takes, s."""

    processor: float
    clock: float


def taken(words: list[str]) -> Taken:
    """Return what a command takes."""
    environment = os.environ | {"FUZZYARM_NATIVE": "1"}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(words, check=True, capture_output=True, env=environment)
    after, end = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Taken(processor, end - begin)


def starts() -> Iterator[Goal]:
    """Measure commands as a whole: machine code was made when fuzzyarm was installed."""
    command = str(Path(sys.executable).with_name("fuzzyarm"))
    point = (
        "from fuzzyarm import compiled, load, shipped;"
        "compiled(load(shipped('pd7.frb')))(e=1.3, ce=-2.2)"
    )
    for what, words in (
        ("`simulate pd`", [command, "simulate", "pd"]),
        ("`simulate stfc`", [command, "simulate", "stfc"]),
        ("`simulate fuzzy-direct`", [command, "simulate", "fuzzy-direct"]),
        ("a first point by `compiled`", [sys.executable, "-c", point]),
    ):
        taken(words)  # bytecode is there after an installation
        runs = [taken(words) for _ in range(ROUNDS)]
        yield Goal(f"{what}, on the clock", min(run.clock for run in runs), "s", 0.6)
    check = [command, "check", str(ROOT / "rulebases/pd7.frb")]
    bare = [sys.executable, "-c", "import argparse"]
    pairs = [(taken(check).processor, taken(bare).processor) for _ in range(15)]
    ratio = min(ours for ours, _ in pairs) / min(theirs for _, theirs in pairs)
    yield Goal('`check pd7.frb` / `python -c "import argparse"`', ratio, "times", 4.5)


def best(action: Callable[[], object], rounds: int, clock: Callable[[], float]) -> float:
    """Return the least time of some rounds, s."""
    found = math.inf
    for _ in range(rounds):
        start = clock()
        action()
        found = min(found, clock() - start)
    return found


def points_of(rulebase: RuleBase, count: int) -> dict[str, np.ndarray]:
    """Return random points, by name."""
    random = np.random.default_rng(1)
    return {each.name: random.uniform(each.low, each.high, count) for each in rulebase.inputs}


def calls() -> Iterator[Goal]:
    """Measure single points, and plain `infer` beside `compiled`."""
    fast = compiled(workload.even())
    values = np.random.default_rng(2).uniform(workload.LOW, workload.HIGH, (500, 2)).tolist()

    def by_name() -> None:
        for e, ce in values:
            fast(e=e, ce=ce)

    each = best(by_name, 50, time.process_time) / len(values)
    yield Goal("one point of 49 rules, by name", 1e6 * each, "µs", 0.35)

    def in_order() -> None:
        for e, ce in values:
            fast.at(e, ce)

    each = best(in_order, 50, time.process_time) / len(values)
    yield Goal("one point of 49 rules, in order", 1e6 * each, "µs", 0.1)
    smooth = workload.smooth()

    def through_infer() -> None:
        for e, ce in values[:50]:
            infer(smooth, e=e, ce=ce)

    through_infer()
    each = best(through_infer, 20, time.process_time) / 50
    yield Goal("one point of smooth terms, 101 samples, by `infer`", 1e6 * each, "µs", 100.0)
    for terms, inputs, count in ((7, 2, 200_000), (7, 4, 50_000), (3, 8, 5_000)):
        rulebase = workload.many_inputs(terms, inputs)
        fast, points = compiled(rulebase), points_of(rulebase, count)
        fast(points)
        one = best(lambda f=fast, p=points: f(p), 7, time.process_time)  # type: ignore[misc]
        plain = best(lambda r=rulebase, p=points: infer(r, p), 7, time.process_time)  # type: ignore[misc]
        what = f"{terms**inputs:,} rules on {inputs} inputs, arrays: `infer` / `compiled`"
        yield Goal(f"{what} ({1e9 * one / count:.0f} ns a point)", plain / one, "times", 1.2)


def scaling() -> Iterator[Goal]:
    """Measure what all processors are worth, over arrays and in batches of closed loops."""
    available = processors()
    goal = {1: 0.9, 2: 1.7}.get(available, 0.6 * available)
    fast, many = compiled(workload.even()), sweeps.MANY
    for count in (100_000, 1_000_000):
        points = points_of(fast.rulebase, count)
        times = {many: math.inf, 1 << 62: math.inf}
        for _ in range(20_000_000 // count):  # in turns
            for threshold, found in times.items():
                sweeps.MANY = threshold
                times[threshold] = min(found, best(lambda p=points: fast(p), 1, time.perf_counter))  # type: ignore[misc]
        sweeps.MANY = many
        ratio = times[1 << 62] / times[many]
        yield Goal(
            f"{count:,} points, {available} processors / one", ratio, "times", goal, least=True
        )
    slowest, name = math.inf, ""
    for entry in CATALOGUE.values():
        ratio = batch_ratio(entry.name, available)
        if ratio < slowest:
            slowest, name = ratio, entry.name
    goal = {1: 0.9, 2: 1.8}.get(available, 0.6 * available)
    what = f"{RUNS} runs of a controller, {available} processors / one: the worst of all ({name})"
    yield Goal(what, slowest, "times", goal, least=True)


def worth_of_processors() -> float:
    """Return how much more points all processors evaluate than one where no memory is new.

    Two processors that are threads of one core share what it computes with: then no ratio above is
    greater than this. Measured in processor time, so that others on the machine do less harm.
    """
    available = processors()
    start = threading.Barrier(available)
    ways = [compiled(workload.even()) for _ in range(available)]
    points = points_of(ways[0].rulebase, 8_000)  # in the cache

    def call(way: Callable[..., object]) -> float:
        begin = time.thread_time()
        for _ in range(20):
            way(points)
        return time.thread_time() - begin

    def calls(way: Callable[..., object]) -> list[float]:
        start.wait()
        return [call(way) for _ in range(200)]

    alone = min(call(ways[0]) for _ in range(400))
    with ThreadPoolExecutor(available) as pool:
        together = itertools.chain(*pool.map(calls, ways))
    return available * alone / statistics.median(together)


def batch_ratio(name: str, available: int) -> float:
    """Return how much faster a batch of closed loops is with all processors."""
    made, path = controller(name), reach_return()
    times = {1: math.inf, available: math.inf}
    for _ in range(ROUNDS):
        for workers, found in times.items():

            def batch(workers: int = workers) -> object:
                return simulate_many(
                    made, path, {"seed": np.arange(RUNS)}, payload=True, workers=workers
                )

            times[workers] = min(found, best(batch, 1, time.perf_counter))
    return times[1] / times[available]


def main() -> int:
    """Measure and print."""
    print("| what | measured | goal | met |\n|---|---|---|---|")
    for part in (starts, calls, scaling):
        print(f"… {part.__name__}", file=sys.stderr)
        for goal in part():
            print(goal.text(), flush=True)
    worth = worth_of_processors()
    print(f"\nof points in the cache all processors evaluate {worth:.2f} times as many as one")
    return 0


if __name__ == "__main__":
    sys.exit(main())
