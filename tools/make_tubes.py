"""Draw the figure of docs/explanation/closed-loop.md: tubes with runs in them.

python tools/make_tubes.py
"""

from __future__ import annotations

import copy
import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "benchmarks"))

from tubes import PROBLEMS, solve  # noqa: E402

from fuzzyarm.control.loop.simulation import simulate  # noqa: E402
from fuzzyarm.plant.plant import with_parameters  # noqa: E402
from fuzzyarm.proof.loop.tube import Tube  # noqa: E402

RUNS = 60
DARK, LIGHT = "#1f4e79", "#9dc3e6"


def runs(found: Tube, name: str) -> list[tuple[Any, Any]]:
    """Return times and values of a port in runs from corners of the starts and from within."""
    problem = found.problem
    generator = np.random.default_rng(0)
    courses = []
    for number in range(RUNS):
        chosen = [
            {
                key: generator.choice([low, high]) if number % 2 else generator.uniform(low, high)
                for key, (low, high) in ranges.items()
            }
            for ranges in (problem.start, problem.parameters)
        ]
        plant = copy.copy(with_parameters(problem.plant, chosen[1]))
        plant.start = lambda rng, start=chosen[0]: list(start.values())  # type: ignore[method-assign]
        label = problem.site.interface.label
        wanted = {
            label(port): value
            for port, value in problem.set_point.items()
            if not problem.site.interface.references[port].order
        }
        course = simulate(problem.text, plant, reference=wanted, duration=found.duration)
        courses.append((course.time, course.outputs[name]))
    return courses


def draw(axes: Any, found: Tube, name: str) -> None:
    """Draw a tube in all its stretches, its runs, and what is demanded of it."""
    column = found.ports.index(name)
    times = np.column_stack([found.begins, found.ends]).ravel()
    low = np.repeat(found.low[:, column], 2)
    high = np.repeat(found.high[:, column], 2)
    axes.fill_between(times, low, high, color=LIGHT, linewidth=0, label="tube")
    for index, (time, values) in enumerate(runs(found, name)):
        axes.plot(time, values, color=DARK, linewidth=0.5, label="runs" if index == 0 else None)


def main() -> None:
    """Draw and write."""
    figure = Figure(figsize=(9.0, 3.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    draw(left, solve(PROBLEMS["Single Pendulum"]), "angle")
    left.plot([0.5, 1.0, 1.0, 0.5, 0.5], [0.0, 0.0, 1.0, 1.0, 0.0], color="#c00000", linewidth=1.2)
    left.text(0.99, 0.93, "demanded", color="#c00000", ha="right", va="top")
    left.set(title="Single Pendulum", xlabel="s", ylabel="angle, rad", xlim=(0, 1))
    draw(right, solve(PROBLEMS["tanks"]), "level2")
    right.axhline(0.2, color="#7f7f7f", linewidth=0.8, linestyle="--")
    right.set(title="tanks", xlabel="s", ylabel="level2, m", xlim=(0, 60))
    left.legend(frameon=False, loc="lower left")
    figure.savefig(ROOT / "docs" / "pictures" / "tubes.png", dpi=110)


if __name__ == "__main__":
    main()
