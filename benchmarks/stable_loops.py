"""How many stable loops `prove --stable` proves: random rule bases on plants of second order.

    python benchmarks/stable_loops.py                      # 203 loops
    python benchmarks/stable_loops.py --count 20 --first 40 --show

Rule bases are straight: a grid of triangles over one input or two, singletons, the weighted
average. Inputs are an error and its rate, measured or by a filter; some sensors are late by whole
periods, some drives have limits, some plants rest beside 0. A loop counts where it is stable: next
to rest the spectral radius is below 0.9995 on each piece, and runs from all around come to rest. So
what is undecided is the prover's miss; the reasons are counted.
"""

from __future__ import annotations

import argparse
import collections
import itertools
import math
import os
import random
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fuzzyarm import load_controller, prove
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop import read_claim
from fuzzyarm.proof.loop.linearised import linearised
from fuzzyarm.proof.loop.runs import run_of
from fuzzyarm.proof.map import Prover, UnprovableError, slopes_at

RADIUS = 0.9995
"""Spectral radius at rest up to which a loop counts as stable."""

BUDGET = 20.0
"""Seconds for each loop."""


class Drawn(NamedTuple):
    """Files of a loop, and what else it is made of."""

    plant: str
    rules: str
    controller: str
    delay: int
    at: str


def number(draw: random.Random, low: float, high: float) -> float:
    """Return a short number."""
    return round(draw.uniform(low, high), 3)


def drawn_plant(draw: random.Random) -> tuple[str, float]:
    """Return x'' = -k x - d x' + g u as a file, and k / g."""
    stiff = draw.choice([0.0, 0.0, number(draw, -6.0, 20.0)])
    loss, gain = number(draw, -0.3, 4.0), number(draw, 0.5, 12.0)
    text = f'''
from fuzzyarm.plant import Plant, Port

class Second(Plant):
    """Drawn."""

    name = "second"
    inputs = {{"u": Port("1", -1000.0, 1000.0)}}
    outputs = {{"y": Port("1", -1.0, 1.0), "v": Port("1/s", -5.0, 5.0, rate_of="y")}}
    states = {{"y": "1", "v": "1/s"}}
    longest_step = 0.005

    def derivative(self, t, x, u, p):
        return [x[1], {-stiff} * x[0] - {loss} * x[1] + {gain} * u[0]]
'''
    return text, stiff / gain


def peaks_of(draw: random.Random) -> list[float]:
    """Return where terms over -1 .. 1 have their peaks: evenly, or denser in the middle."""
    count = draw.choice([3, 3, 4, 5, 5, 7])
    power = draw.choice([1.0, 1.0, 1.5, 2.0])
    even = [-1.0 + 2.0 * k / (count - 1) for k in range(count)]
    return [round(abs(x) ** power * (1 if x > 0 else -1), 4) for x in even]


def terms(name: str, peaks: Sequence[float]) -> list[str]:
    """Return triangles, each from its neighbour's peak on the left to that on the right."""
    ends = [2.0 * peaks[0] - peaks[1], *peaks, 2.0 * peaks[-1] - peaks[-2]]
    return [
        f"term {name} {name.upper()}{k}: triangle {ends[k]:.9g} {ends[k + 1]:.9g} {ends[k + 2]:.9g}"
        for k in range(len(peaks))
    ]


def drawn_rules(draw: random.Random, inputs: Sequence[str]) -> str:
    """Return a rule base that mostly rises with its inputs, and is 0 where they are, or near."""
    peaks = [peaks_of(draw) for _ in inputs]
    cells = list(itertools.product(*(range(len(places)) for places in peaks)))
    # What a row adds rises by random steps, and each cell is off by a share of its own.
    rows = [list(itertools.accumulate(draw.expovariate(1.0) for _ in places)) for places in peaks]
    uneven, odd = draw.choice([0.0, 0.2, 0.5]), draw.random() < 0.4
    heights: dict[tuple[int, ...], float] = {}
    for cell in cells:
        mirror = tuple(len(p) - 1 - k for p, k in zip(peaks, cell, strict=True))
        height = sum(row[k] - row[len(row) // 2] for row, k in zip(rows, cell, strict=True))
        height = height / len(inputs) + uneven * draw.uniform(-0.5, 0.5)
        if odd and mirror in heights:
            height = -heights[mirror]
        heights[cell] = round(height, 3) if cell != mirror else 0.0
    end = max(1.0, *(abs(x) for x in heights.values()))
    lines = [
        "rulebase r",
        *(f"input {name} -1 .. 1" for name in inputs),
        f"output u {-end} .. {end}",
    ]
    for name, places in zip(inputs, peaks, strict=True):
        lines += terms(name, places)
    lines += [f"term u O{k}: singleton {heights[cell]}" for k, cell in enumerate(cells)]
    lines.append(f"inference and {draw.choice(['product', 'product', 'min'])}")
    lines.append("inference u: aggregation sum, defuzzifier weighted-average")
    for k, cell in enumerate(cells):
        parts = (f"{n} is {n.upper()}{i}" for n, i in zip(inputs, cell, strict=True))
        lines.append(f"rule if {' and '.join(parts)} then u is O{k}")
    return "\n".join(lines) + "\n"


def drawn(draw: random.Random) -> Drawn:
    """Return a loop, stable or not."""
    plant, share = drawn_plant(draw)
    period = draw.choice([0.005, 0.01, 0.02, 0.05])
    inputs = draw.choice([("e",), ("e", "d"), ("e", "d")])
    lines = [f"e = error of y * {number(draw, 0.5, 4.0)}"]
    if len(inputs) > 1:
        kind = draw.choice(["error of v", "rate of e", "rate of e"])
        size = number(draw, 0.05, 0.6)
        after = f", filter {draw.choice([20, 100])} ms" if kind == "rate of e" else ""
        lines.append(f"d = {kind} * {size}{after}")
    lines.append(f"u = rules r({', '.join(inputs)}) * {round(10.0 ** draw.uniform(-0.5, 2.0), 2)}")
    within = draw.choice(["", "", f", within {-10 - draw.randrange(5)} .. 10"])
    delay = draw.choice([0, 0, 0, 1, 2])
    at = " at y = 0.1" if share and draw.random() < 0.5 else ""
    return Drawn(
        plant,
        drawn_rules(draw, inputs),
        "\n".join([
            'controller drawn', '', 'use r from "r.frb"', '', f"period {period * 1000:g} ms", '',
            "axis a", *(f"  {line}" for line in lines), f"  drive u = u{within}", "",
        ]),
        delay,
        at,
    )  # fmt: skip


class Case:
    """A loop in its files, in the folder at hand."""

    def __init__(self, loop: Drawn, number: int) -> None:
        for name, text in (
            ("second.py", loop.plant), ("r.frb", loop.rules), ("drawn.frb", loop.controller),
        ):  # fmt: skip
            Path(f"{number}").mkdir(exist_ok=True)
            Path(f"{number}/{name}").write_text(text)
        self.text: ControllerText = load_controller(f"{number}/drawn.frb")
        self.plant: Plant = find_plant(f"{number}/second.py")
        period = self.text.model.period
        self.sensors = {"y": Sensor(delay=loop.delay * period)} if loop.delay else {}
        self.claim = f"stable on '{number}/second.py'{loop.at}"
        self.problem = problem_of(
            self.text, read_claim(self.claim), plant=self.plant, sensors=self.sensors
        )

    def radius(self) -> float:
        """Return the largest spectral radius next to rest, of all pieces that meet there."""
        loop = linearised(self.problem)
        found = loop.slopes[0]
        sides = slopes_at(Prover(found.sheet, found.output), found.at)
        names = [slope.input for slope in loop.slopes]
        radii = [loop.opened(loop.drives[0]).radius]
        for side in sides.sides:
            by_name = dict(zip(sides.names, side.gradient, strict=True))
            changed = {k: float(by_name[name]) for k, name in enumerate(names)}
            radii.append(loop.opened(loop.drives[0], changed).radius)
        self.rest = loop.rest
        return max(radii)

    def comes_to_rest(self) -> bool:
        """Tell whether runs from all around the rest fade; next to it scale does not matter."""
        names = self.problem.states
        for k in range(8):
            way = math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)
            start = {n: self.rest[n] + 1e-4 * x for n, x in zip(names, way, strict=True)}
            run = run_of(self.problem, start, {}, duration=12_000 * self.problem.period)
            if run is None or run.diverged is not None:
                return False
            far = np.abs(np.asarray(run.outputs["y"]) - self.rest["y"])
            if not far[-500:].max() < 0.05 * max(far.max(), 1e-4):
                return False
        return True


def main() -> None:
    """Print the share that is proved, and why the others are not."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=203)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--show", action="store_true", help="a line for each loop")
    options = parser.parse_args()
    verdicts: collections.Counter[str] = collections.Counter()
    reasons: collections.Counter[str] = collections.Counter()
    spent, seed = 0.0, options.first
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        while sum(verdicts.values()) < options.count:
            try:
                case = Case(drawn(random.Random(seed)), seed)
                stable = case.radius() < RADIUS and case.comes_to_rest()
            except (LoopProofError, UnprovableError):
                stable = False  # no rest is found, or none inside the ranges
            seed += 1
            if not stable:
                continue
            begun = time.process_time()
            found = prove(
                case.text, case.claim, plant=case.plant, sensors=case.sensors, budget=BUDGET
            )
            spent += time.process_time() - begun
            verdicts[found.verdict] += 1
            if found.verdict != "proved":
                reasons[found.reason] += 1
            if options.show:
                print(seed - 1, found.verdict, f"{time.process_time() - begun:.2f}", found.reason,
                      flush=True)  # fmt: skip
    total = sum(verdicts.values())
    print(
        f"{total} stable loops (seeds {options.first} .. {seed - 1}), {spent / total:.2f} s each:"
    )
    for verdict, times in verdicts.most_common():
        print(f"{times:5} {verdict} ({100 * times / total:.0f} %)")
    for reason, times in reasons.most_common():
        print(f"{times:9} {reason}")


if __name__ == "__main__":
    main()
