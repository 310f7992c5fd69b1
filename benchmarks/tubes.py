"""Print how long tubes take: problems of ARCH-COMP (AINNCS) and shipped plants under rule bases.

    python benchmarks/tubes.py                   # all
    python benchmarks/tubes.py TORA motor        # those whose names have one of these words

The problems and where they come from stand in docs/explanation/closed-loop.md.
"""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path
from typing import NamedTuple

import fuzzyarm
from fuzzyarm.plant.own import find_plant
from fuzzyarm.proof.claim.problem import loop_problem
from fuzzyarm.proof.loop.tube import Demand, Tube, tube

EXAMPLES = Path(__file__).parents[1] / "examples" / "closed_loop"
Range = tuple[float, float]


class Problem(NamedTuple):
    """A loop, its starts, and what is asked of it."""

    controller: str
    plant: str
    duration: float
    start: dict[str, Range]
    demands: list[Demand]
    set_point: dict[str, float]
    parameters: dict[str, Range]
    boxes: list[int]


def problem(
    controller: str, plant: str, duration: float, start: dict[str, Range],
    demands: list[Demand] | None = None, **more: object,
) -> Problem:  # fmt: skip
    """Return a problem; without demands it is only followed."""
    facts: dict[str, object] = {"set_point": {}, "parameters": {}, "boxes": [], **more}
    return Problem(controller, plant, duration, start, demands or [], **facts)  # type: ignore[arg-type]


BOX = [Demand(f"x{i}", -2.0, 2.0, 0.0, 20.0) for i in (1, 2, 3, 4)]
GOAL = [Demand("x1", -0.1, 0.2, 5.0, 5.0), Demand("x2", -0.9, -0.6, 5.0, 5.0)]
UPRIGHT = [Demand(port, -0.001, 0.001, 8.0, 10.0) for port in ("x1", "x3", "x4")]

PROBLEMS = {
    "Single Pendulum": problem(
        "single-pendulum.frb", "single_pendulum.py", 1.0,
        {"angle": (1.0, 1.175), "rate": (0.0, 0.2)}, [Demand("angle", 0.0, 1.0, 0.5, 1.0)],
    ),
    "TORA, remain": problem(
        "tora-remain.frb", "tora.py", 20.0,
        {"x1": (0.6, 0.7), "x2": (-0.7, -0.6), "x3": (-0.4, -0.3), "x4": (0.5, 0.6)}, BOX,
    ),
    "TORA, reach": problem(
        "tora-reach.frb", "tora.py", 5.0,
        {"x1": (-0.77, -0.75), "x2": (-0.45, -0.43), "x3": (0.51, 0.54), "x4": (-0.3, -0.28)},
        GOAL, set_point={"x3": -1.0},
    ),
    "ACC": problem(
        "acc.frb", "acc.py", 5.0,
        {"x_lead": (90, 110), "v_lead": (32, 32.2), "x_ego": (10, 11), "v_ego": (30, 30.2)},
        [Demand("margin", 0.0, math.inf, 0.0, 5.0)],
    ),
    "Balancing": problem(
        "balancing.frb", "balancing.py", 10.0,
        {"x1": (-0.1, 0.1), "x2": (-0.05, 0.05), "x3": (-0.1, 0.1), "x4": (-0.05, 0.05)}, UPRIGHT,
    ),
    "motor": problem(
        "servo.frb", "motor", 0.5, {"position": (-0.05, 0.05), "velocity": (-0.1, 0.1)},
        set_point={"position": 1.0},
    ),
    "motor, J ± 10 %, T ± 0.1 N m": problem(
        "servo.frb", "motor", 0.5, {"position": (-0.05, 0.05), "velocity": (-0.1, 0.1)},
        set_point={"position": 1.0}, parameters={"J": (0.009, 0.011), "T": (-0.1, 0.1)},
    ),
    "cartpole": problem(
        "cartpole.frb", "cartpole", 4.0, {"x": (-0.05, 0.05), "theta": (-0.05, 0.05)}
    ),
    "ball-and-beam": problem(
        "ball-and-beam.frb", "ball-and-beam", 5.0, {"position": (0.1, 0.12)}
    ),
    "tanks": problem(
        "tanks.frb", "tanks", 60.0, {"level1": (0.1, 0.15), "level2": (0.1, 0.12)},
        set_point={"level2": 0.2},
    ),
    "room": problem(
        "heater.frb", "room", 7200.0, {"temperature": (14, 16), "wall": (14, 16)},
        set_point={"temperature": 20.0},
    ),
    "arm, load 0 .. 1": problem(
        "arm.frb", "loaded_arm.py", 0.3, {"q_1": (0.0, 0.01), "q_2": (0.5, 0.51)},
        set_point={"joint1.position": 0.1, "joint2.position": 0.6}, parameters={"load": (0.0, 1.0)},
        boxes=[1, 1, 8],
    ),
}  # fmt: skip


def solve(chosen: Problem, budget: float = 120.0) -> Tube:
    """Return the tube of a problem."""
    own = EXAMPLES / chosen.controller
    path = own if own.exists() else fuzzyarm.shipped(chosen.controller)
    plant = EXAMPLES / chosen.plant
    loop = loop_problem(
        fuzzyarm.load_controller(path),
        find_plant(str(plant) if plant.exists() else chosen.plant),
        start=chosen.start,
        set_point=chosen.set_point,
        parameters=chosen.parameters,
    )
    return tube(loop, chosen.duration, demands=chosen.demands, boxes=chosen.boxes, budget=budget)


def main(words: list[str]) -> None:
    """Print a row for each problem."""
    print(f"{'problem':30} {'verdict':10} {'boxes':>5} {'wall s':>7} {'CPU s':>7}  at the end")
    for name, chosen in PROBLEMS.items():
        if words and not any(word.lower() in name.lower() for word in words):
            continue
        wall, cpu = time.perf_counter(), time.process_time()
        found = solve(chosen)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        proved = found.complete and not found.open
        verdict = "undecided" if not proved else "proved" if chosen.demands else "followed"
        ends = ""
        if found.complete:
            end = found.duration
            ports = found.ports[: len(found.problem.site.interface.outputs)]
            ends = ", ".join(
                f"{port} {low:.4g} .. {high:.4g}"
                for port, (low, high) in ((port, found.bounds(port, end, end)) for port in ports)
            )
        print(f"{name:30} {verdict:10} {found.boxes:5} {wall:7.1f} {cpu:7.1f}  {ends}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
