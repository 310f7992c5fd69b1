"""The closed loop against plain C: CDID, payload switching, 25,005 control steps.

Compiles ``closed_loop.c`` with ``gcc -O2`` where a C compiler is present, runs both in
turns and prints the ratio of the medians: of the loop alone and of the whole call of
``simulate``, which also samples the trajectory and collects the figures.
"""

from __future__ import annotations

import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from fuzzyarm.arm import reach_return
from fuzzyarm.control import Options, controller, simulate

ROUNDS = 5
REPEATS = 21


def compile_c(folder: Path) -> Path | None:
    """Build the C loop; None where there is no compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    program = folder / "closed_loop"
    source = Path(__file__).with_suffix(".c")
    subprocess.run([compiler, "-O2", str(source), "-o", str(program), "-lm"], check=True)
    return program


def run_c(program: Path) -> tuple[float, float, float]:
    """Return the median seconds of a run and the two RMS errors."""
    words = subprocess.run(
        [str(program), str(REPEATS)], check=True, capture_output=True, text=True
    ).stdout.split()
    seconds, first, second = map(float, words)
    return seconds, first, second


def run_python(name: str, compiled: bool = True, repeats: int = REPEATS) -> dict[str, float]:
    """Return the median seconds of loop and call, and the RMS errors."""
    made, path = controller(name), reach_return()
    loops, calls = [], []
    for _ in range(repeats):
        begin = time.perf_counter()
        run = simulate(made, path, payload=True, options=Options(compiled=compiled))
        calls.append(time.perf_counter() - begin)
        loops.append(run.seconds)
    return {
        "loop": statistics.median(loops),
        "call": statistics.median(calls),
        "rms_1": float(run.rms[0]),
        "rms_2": float(run.rms[1]),
    }


def main() -> int:
    """Measure and print."""
    begin = time.perf_counter()
    run_python("cdid", repeats=1)
    print(f"first call in this process: {time.perf_counter() - begin:.2f} s")
    with tempfile.TemporaryDirectory() as folder:
        program = compile_c(Path(folder))
        if program is None:
            print("no C compiler here: nothing to compare with")
            return 0
        pairs = [(run_c(program), run_python("cdid")) for _ in range(ROUNDS)]
    (_, first, second), ours = pairs[0]
    print(f"RMS errors, degrees: C {first:.9f} {second:.9f}")
    print(f"                   here {ours['rms_1']:.9f} {ours['rms_2']:.9f}")
    print(f"{'':<22}{'median ms':>10}{'ratio to C':>12}   spread")
    print(f"{'plain C, gcc -O2':<22}{1e3 * statistics.median(c[0] for c, _ in pairs):>10.3f}")
    for part in ("loop", "call"):
        ratios = sorted(python[part] / c[0] for c, python in pairs)
        milliseconds = 1e3 * statistics.median(python[part] for _, python in pairs)
        print(
            f"{'fuzzyarm, ' + part:<22}{milliseconds:>10.3f}{statistics.median(ratios):>12.2f}"
            f"   {ratios[0]:.2f} to {ratios[-1]:.2f}"
        )
    slow = run_python("cdid", compiled=False, repeats=1)
    ratio = slow["loop"] / statistics.median(c[0] for c, _ in pairs)
    print(f"{'interpreted, loop':<22}{1e3 * slow['loop']:>10.1f}{ratio:>12.0f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
