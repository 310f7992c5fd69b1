"""CartPole-v1 by rules: how many steps each seed holds, with four inputs and with two.

    python benchmarks/cartpole.py [SEEDS]

Needs fuzzyarm[plants]. The two-input controller is the same file without the cart.
"""

from __future__ import annotations

import sys
import time

from fuzzyarm import load, shipped
from fuzzyarm.control.controllers.catalogue import controller_of
from fuzzyarm.control.loop import Options, Signal, simulate
from fuzzyarm.plant import find_plant

WHOLE = controller_of(load(shipped("cartpole.frb")))
POLE_ONLY = WHOLE.with_gains({"G_x": [0.0], "G_v": [0.0]})


def held(controller, steps: int, seeds: int) -> tuple[int, int]:
    """Return in how many seeds all steps are held, and the fewest steps."""
    plant = find_plant("gym:CartPole-v1")
    still = {"x": Signal("step", (0.0,))}
    counts = []
    for seed in range(seeds):
        options = Options(seed=seed)
        run = simulate(controller, plant, reference=still, duration=steps * 0.02, options=options)
        counts.append(run.samples)
    return sum(count == steps for count in counts), min(counts)


def main() -> None:
    """Print a table."""
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    for steps, count in ((500, seeds), (5_000, max(1, seeds // 5))):
        for name, controller in (("four inputs", WHOLE), ("two inputs", POLE_ONLY)):
            begin = time.perf_counter()
            whole, least = held(controller, steps, count)
            seconds = time.perf_counter() - begin
            print(f"{steps:5} steps, {name:11}: {whole:3} of {count} seeds, "
                  f"the shortest {least} steps; {seconds:.1f} s")  # fmt: skip


if __name__ == "__main__":
    main()
