"""Two ratios of everyday use, measured in one run.

    python benchmarks/inference.py --fuzzylite ENV/bin/python

1. A 201 × 201 table of the 49-rule controller with the exact centroid, against
   pyfuzzylite 8 filling the same grid with its vectorised arrays and `centroid(101)`.
   pyfuzzylite needs NumPy below 2 and so an environment of its own (see
   make_fuzzylite_reference.py); FUZZYARM_FUZZYLITE_PYTHON may name its Python, too.
2. `fuzzyarm check rulebases/pd7.frb` against `python -c "import argparse"`.

Ratios are medians; the spread is that of the middle half of the ratios of single runs.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from fuzzyarm.inference import infer
from fuzzyarm.language import load_rulebase

ROOT = Path(__file__).resolve().parent.parent
PD7 = ROOT / "rulebases/pd7.frb"


def timed(action: Callable[[], object]) -> float:
    """Seconds of one call."""
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


def ratio_line(title: str, slow: list[float], fast: list[float]) -> str:
    """Median ratio and the spread of the ratios of single runs."""
    median = statistics.median(slow) / statistics.median(fast)
    single = sorted(a / b for a in slow for b in fast)
    low, high = single[len(single) // 4], single[-len(single) // 4]
    return f"{title}: {median:.1f} ({low:.1f} … {high:.1f})"


def table_ratio(fuzzylite: str | None, points: int, repetitions: int) -> str:
    """Measure the table against pyfuzzylite."""
    title = f"{points} × {points} table, pyfuzzylite arrays / fuzzyarm exact"
    rulebase = load_rulebase(PD7)
    axis = np.linspace(-6.0, 6.0, points)
    e, ce = axis[:, None], axis[None, :]
    infer(rulebase, e=e, ce=ce)
    ours = [timed(lambda: infer(rulebase, e=e, ce=ce)) for _ in range(5 * repetitions)]
    each = statistics.median(ours) / points**2 * 1e6
    if not fuzzylite:
        return (
            f"{title}: pyfuzzylite's Python is not given (--fuzzylite); "
            f"fuzzyarm alone: {each:.3f} µs a point"
        )
    script = str(ROOT / "benchmarks/fuzzylite_table.py")
    words = [fuzzylite, script, str(points), str(repetitions), "101"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        return f"{title}: {fuzzylite} failed: {done.stderr.strip().splitlines()[-1:]}"
    peer = json.loads(done.stdout.splitlines()[-1])
    found = infer(rulebase, e=e, ce=ce)["u"].ravel()[:: points + 7]
    apart = float(np.abs(found - np.array(peer["values"])).max())
    line = ratio_line(title, peer["seconds"], ours)
    return f"{line}; {each:.3f} µs a point here; values at most {apart:.1e} apart"


def start_up_ratio(repetitions: int) -> str:
    """Measure a check against the start of Python itself."""
    command = str(Path(sys.executable).with_name("fuzzyarm"))
    check, bare = [command, "check", str(PD7)], [sys.executable, "-c", "import argparse"]
    slow, fast = [], []
    for words in (check, bare):
        subprocess.run(words, capture_output=True, check=True)
    for _ in range(repetitions):  # alternating, so that both see the same machine
        slow.append(timed(lambda: subprocess.run(check, capture_output=True, check=True)))
        fast.append(timed(lambda: subprocess.run(bare, capture_output=True, check=True)))
    return ratio_line('fuzzyarm check pd7.frb / python -c "import argparse"', slow, fast)


def main() -> None:
    """Print both ratios."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--fuzzylite",
        default=os.environ.get("FUZZYARM_FUZZYLITE_PYTHON"),
        metavar="PYTHON",
        help="Python of an environment with pyfuzzylite 8",
    )
    parser.add_argument("--points", type=int, default=201, help="points along each axis")
    parser.add_argument("--repetitions", type=int, default=9)
    arguments = parser.parse_args()
    print(table_ratio(arguments.fuzzylite, arguments.points, arguments.repetitions))
    print(start_up_ratio(2 * arguments.repetitions + 1))


if __name__ == "__main__":
    main()
