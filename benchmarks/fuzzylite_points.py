"""Time pyfuzzylite on the 49-rule controller; runs in the environment that has it.

    ENV/bin/python benchmarks/fuzzylite_points.py POINTS REPETITIONS

Called by benchmarks/compiled.py. Prints one JSON object: seconds a point for each
repetition, with arrays of POINTS random points and one point at a time.
"""

from __future__ import annotations

import json
import sys
import time

import numpy as np
from make_fuzzylite_reference import engine

SINGLES = 60


def main() -> None:
    """Measure both ways."""
    points, repetitions = (int(word) for word in sys.argv[1:3])
    case = {
        "terms": "triangle", "conjunction": "min", "implication": "min",
        "aggregation": "max", "method": "centroid", "resolution": 101,
    }  # fmt: skip
    system = engine(case)
    values = np.random.default_rng(1).uniform(-6.0, 6.0, (2, points))
    found: dict[str, list[float]] = {"arrays": [], "single": []}
    for _ in range(repetitions):
        start = time.process_time()
        system.input_variable("e").value, system.input_variable("ce").value = values
        system.process()
        _ = system.output_variable("u").value
        found["arrays"].append((time.process_time() - start) / points)
        start = time.process_time()
        for i in range(SINGLES):
            system.input_variable("e").value = float(values[0, i])
            system.input_variable("ce").value = float(values[1, i])
            system.process()
            _ = system.output_variable("u").value
        found["single"].append((time.process_time() - start) / SINGLES)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
