"""Time pyfuzzylite filling a table; runs in the environment that has it.

Called by benchmarks/inference.py. Prints one JSON object: seconds for each repetition of
the 201 × 201 table with vectorised arrays, and a few values for a check.
"""

from __future__ import annotations

import json
import sys
import time

import numpy as np
from make_fuzzylite_reference import engine


def main() -> None:
    """Fill the table a few times."""
    points, repetitions, resolution = (int(word) for word in sys.argv[1:4])
    case = {
        "terms": "triangle", "conjunction": "min", "implication": "min",
        "aggregation": "max", "method": "centroid", "resolution": resolution,
    }  # fmt: skip
    system = engine(case)
    axis = np.linspace(-6.0, 6.0, points)
    e, ce = (grid.ravel() for grid in np.meshgrid(axis, axis, indexing="ij"))
    seconds = []
    for _ in range(repetitions):
        start = time.perf_counter()
        system.input_variable("e").value = e
        system.input_variable("ce").value = ce
        system.process()
        values = np.asarray(system.output_variable("u").value)
        seconds.append(time.perf_counter() - start)
    print(json.dumps({"seconds": seconds, "values": values.ravel()[:: points + 7].tolist()}))


if __name__ == "__main__":
    main()
