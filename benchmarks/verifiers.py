"""One loop, one claim: proved by fuzzyarm, and by immrax on the same controller as a network.

    python benchmarks/verifiers.py --immrax PYTHON

PYTHON is an interpreter with `immrax` and `onnx` (`pip install immrax onnx` in an environment of
its own); without the option only fuzzyarm's part is printed. The loop is the single pendulum of
ARCH-COMP under five rules of one signal, whose network (`compile -o x.onnx`) has their values
exactly. `--keep FOLDER` keeps the network and the loop, for CORA, JuliaReach or NNV.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fuzzyarm
from fuzzyarm.exchange.compiled import Making, source_of
from fuzzyarm.language import parse
from fuzzyarm.plant.own import find_plant
from fuzzyarm.proof.claim.problem import loop_problem
from fuzzyarm.proof.loop.tube import Demand, tube

PLANT = Path(__file__).parents[1] / "examples" / "closed_loop" / "single_pendulum.py"
START = {"angle": (1.0, 1.175), "rate": (0.0, 0.2)}
GAINS = (1.0, 0.5)  # of the signal: angle and rate
GOAL, FROM, TO = (0.0, 1.0), 0.5, 1.0  # of the angle, and its seconds

RULES = """rulebase hold "torque over angle plus half the rate"
input  s -2 .. 2
output torque -1 .. 1
terms s: triangles NB NS ZE PS PB
term torque NB: singleton -1
term torque NS: singleton -0.75
term torque ZE: singleton 0
term torque PS: singleton 0.75
term torque PB: singleton 1
inference aggregation sum, defuzzifier weighted-average, outside clamp
rule if s is NB then torque is PB
rule if s is NS then torque is PS
rule if s is ZE then torque is ZE
rule if s is PS then torque is NS
rule if s is PB then torque is NB
"""

CONTROLLER = f"""controller one-signal
use hold from "hold.frb"
period 50 ms
axis pendulum
  angle = measured angle
  rate  = measured rate
  s     = angle * {GAINS[0]:g} + rate * {GAINS[1]:g}
  u     = rules hold(s)
  drive torque = u
"""


def timed(run: Callable[[], Any]) -> tuple[Any, float]:
    """Return the result of a call and its processor time in seconds."""
    before = time.process_time()
    result = run()
    return result, time.process_time() - before


def row(tool: str, proved: bool, low: float, high: float, seconds: str, words: str) -> None:
    """Print one line of the table."""
    verdict = "proved" if proved else "not proved"
    print(f"{tool:<9} {verdict:<10} {low:7.4f} .. {high:<7.4f} {seconds:<30} {words}", flush=True)


def own(folder: Path) -> None:
    """Prove the claim and that the loop is stable; write the network."""
    (folder / "hold.frb").write_text(RULES)
    path = folder / "one-signal.frb"
    path.write_text(CONTROLLER)
    making = Making(levels=tuple(map(float, range(-2, 3))))
    rules = parse(RULES).rulebase
    assert rules is not None
    network, _ = source_of(rules, folder / "hold.onnx", making)
    network.write()
    print(f"hold.onnx differs from the rules by {network.routines[0].accuracy.worst:.2g}")

    problem = loop_problem(fuzzyarm.load_controller(path), find_plant(str(PLANT)), start=START)
    demand = Demand("angle", *GOAL, FROM, TO)
    found, seconds = timed(lambda: tube(problem, TO, demands=[demand]))
    low, high = found.bounds("angle", FROM, TO)
    row(
        "fuzzyarm",
        found.complete and not found.open,
        low,
        high,
        f"{seconds:.2f} s",
        "sampled, rounding included",
    )
    verdict, seconds = timed(lambda: fuzzyarm.prove(path, "stable", plant=str(PLANT)))
    print(
        f"{'':10} {verdict.verdict}: stable, for all time, in {seconds:.2f} s, with a certificate"
    )


def main() -> None:
    """Print both rows."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--immrax", metavar="PYTHON", help="an interpreter with immrax and onnx")
    parser.add_argument("--keep", metavar="FOLDER", type=Path, help="keep network and loop there")
    words = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = words.keep or Path(temporary)
        folder.mkdir(exist_ok=True)
        print(f"angle within {GOAL[0]:g} .. {GOAL[1]:g} from {FROM:g} to {TO:g} s; processor time")
        own(folder)
        if not words.immrax:
            print("immrax: --immrax PYTHON names an interpreter with immrax and onnx")
            return
        script = Path(__file__).with_name("verifiers_immrax.py")
        given = json.dumps({"gains": GAINS, "start": list(START.values()), "time": (FROM, TO)})
        command = [words.immrax, str(script), str(folder / "hold.onnx"), given]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        found = json.loads(said.splitlines()[-1])
    proved = GOAL[0] <= found["low"] and found["high"] <= GOAL[1]
    seconds = f"{found['compiling']:.2f} s to compile, {found['running']:.3f} s"
    remark = "continuous control; Euler steps of 1 ms in single precision, errors not bounded"
    row("immrax", proved, found["low"], found["high"], seconds, remark)


if __name__ == "__main__":
    main()
