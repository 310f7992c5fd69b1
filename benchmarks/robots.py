"""The families of the study on PUMA 560: median errors over seeds, with noise.

A move and back, a second each, over 20 degrees: of the first three joints, or of all six. The
plant is the file's, or carries 2.5 kg from the way back on, or has masses that are 20 % larger than
those the controllers know. Encoders have noise of 0.005 degrees, velocities 0.05 degrees/s.
Printed is the RMS error of all moved joints together, its median over the seeds; the best, and
what is within its quartiles, is marked.

usage: python benchmarks/robots.py [--seeds 30] [--plant FILE] [--journal FILE]
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from fuzzyarm.control.controllers.own import find_controller
from fuzzyarm.control.loop.along import trajectory_motion
from fuzzyarm.control.loop.course import Options, Sensor
from fuzzyarm.control.loop.run import ClosedLoop
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import with_parameters

HERE = Path(__file__).resolve().parent
ROBOTS = HERE.parent / "examples" / "robots"
FUZZY = ("pd", "fuzzy-direct", "hfie", "stfc", "cfaf", "soc")
LAWS = ("ct", "ffid", "ffid+ie", "cdid", "mrac", "dac")
SUMS = ("fuzzy-direct", "soc")
MOVES = {"three joints": (3, 20.0), "six joints": (6, 20.0)}
CASES = {"as known": ({}, False), "2.5 kg": ({}, True), "masses +20 %": ({"masses": 1.2}, False)}


def names() -> Iterator[str]:
    """Yield the controllers, as commands take them."""
    files = {name: str(HERE / "puma560" / f"{name}.frb") for name in FUZZY}
    files["fuzzy-direct"] = str(ROBOTS / "puma-fuzzy.frb")
    yield from files.values()
    yield from LAWS
    yield from (f"ct+{files[name]}" for name in SUMS)


def errors_of(name: str, move: str, case: str, plant_file: str, seeds: int) -> list[float]:
    """Return the RMS error of each seed, degrees; infinite where a run diverges."""
    values, loaded = CASES[case]
    plant = with_parameters(find_plant(plant_file), values)
    joints = list(plant.joints)
    count, angle = MOVES[move]
    rest = plant.trajectories["reach"].keywords["start"]
    to = tuple(a + angle * (k < count) for k, a in enumerate(rest))
    trajectory = plant.trajectories["reach-return"](angles=to, segment=1.0, hold=0.3)
    noise = {}
    for joint in joints:
        noise[f"{joint}.position"] = Sensor(noise=math.radians(0.005))
        noise[f"{joint}.velocity"] = Sensor(noise=math.radians(0.05))
    controller = find_controller(name)
    followed = trajectory_motion(plant, trajectory, controller, payload=loaded)
    loop = ClosedLoop(controller, followed, options=Options(sensors=noise))
    found = []
    for seed in range(1, seeds + 1):
        run = loop.run(seed=seed)
        moved = run.error_matrix[:, :count]
        whole = run.diverged is None and np.isfinite(moved).all()
        found.append(float(np.sqrt(np.mean(moved**2))) if whole else math.inf)
    return found


def main() -> None:
    """Run what the journal does not have, and print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument("--plant", default=str(ROBOTS / "puma560.xml"))
    parser.add_argument("--journal", type=Path)
    asked = parser.parse_args()
    done: dict[str, list[float]] = {}
    if asked.journal and asked.journal.exists():
        done = dict(json.loads(line) for line in asked.journal.read_text().splitlines())
    columns = [(move, case) for move in MOVES for case in CASES]
    rows: dict[str, list[list[float]]] = {}
    for name in names():
        short = "+".join(
            Path(part).stem.replace("puma-fuzzy", "fuzzy-direct") for part in name.split("+")
        )
        rows[short if name not in LAWS else name] = row = []
        for move, case in columns:
            key = f"{short} {name in LAWS} {move} {case} {asked.seeds}"
            if key not in done:
                done[key] = errors_of(name, move, case, asked.plant, asked.seeds)
                if asked.journal:
                    with asked.journal.open("a") as journal:
                        journal.write(json.dumps([key, done[key]]) + "\n")
                print(f"{key}: {statistics.median(done[key]):.4f}", file=sys.stderr, flush=True)
            row.append(done[key])
    print("| RMS, degrees | " + " | ".join(f"{move}, {case}" for move, case in columns) + " |")
    print("|---" * (len(columns) + 1) + "|")
    best = [
        min((row[k] for row in rows.values()), key=statistics.median) for k in range(len(columns))
    ]
    for name, row in rows.items():
        cells = []
        for k, errors in enumerate(row):
            median = statistics.median(errors)
            tied = median <= statistics.quantiles(best[k], n=4)[2]
            words = f"{median:.4f}" if math.isfinite(median) else "diverges"
            cells.append(f"**{words}**" if tied else words)
        print(f"| {name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
