"""Make irregular rule bases; nothing that happens lies outside what is proved of them.

    python tests/fuzz/random_proofs.py --seed 1 --count 20000

Of each: points inside the bounds, slopes of small steps inside those of slopes, errors of a table
inside its proved error, multiples inside a sector; and false statements, a bound shifted inward by
1e-9 of the range where it is attained, are not proved. One case in fifty is a large one: 5,000
points, four seconds of the processor for each statement, and more terms and rules.
"""

from __future__ import annotations

import math
import random
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "fuzz")]

import numpy as np  # noqa: E402
from fuzzing import Told, run  # noqa: E402

from fuzzyarm import compile_table, infer  # noqa: E402
from fuzzyarm.language import parse, write  # noqa: E402
from fuzzyarm.language.model.rulebase import RuleBase  # noqa: E402
from fuzzyarm.proof.map import (  # noqa: E402
    Bounds,
    Prover,
    UnprovableError,
    arithmetic,
    prove,
    sector,
)
from fuzzyarm.proof.stop import Stop, TimeOverError  # noqa: E402

PLANTED = 1e-9
SECONDS = 4.0
"""For each statement; bounds that are not tight by then hold all the same."""


class Size(NamedTuple):
    """How large a case is: points, seconds for each statement, terms and rules at most."""

    points: int
    seconds: float
    terms: int
    rules: int


LARGE, SMALL = Size(5_000, SECONDS, 4, 9), Size(500, 0.1, 3, 5)
OFTEN_SMALL = 0.98

counted = {"large": 0, "value": 0, "slope": 0, "table": 0, "sector": 0, "statements": 0}
"""Large cases, bounds that were found in time, and false statements that were judged."""


OTHERS = (
    "bisector exact", "bisector(31)", "bisector(30, midpoints)", "bisector(31, joined)",
    "centroid(31, joined)", "mean-of-maximum exact", "smallest-of-maximum exact",
    "largest-of-maximum(31)", "nearest-of-maximum exact", "nearest-of-maximum(30, midpoints)",
    "farthest-of-maximum exact", "middle-of-maximum exact", "tsukamoto", "karnik-mendel exact",
    "karnik-mendel(31)", "nie-tan exact", "nie-tan(31)",
)  # fmt: skip
"""Defuzzifiers that go by boxes."""


def irregular(draw: random.Random, inputs: int = 2, way: str = "", size: Size = LARGE) -> RuleBase:
    """Return a rule base with overlapping trapezoids at odd positions and conclusions at random.

    `way`: one of :data:`OTHERS`; ramps for tsukamoto, sets between two for interval type 2.
    """
    names = [f"x{i}" for i in range(inputs)]
    lines = ["rulebase r", *(f"input {name} -1 .. 1" for name in names), "output u -1 .. 1"]
    counts = {}
    numbers = draw.random() < 0.2 and not way
    between = way.startswith(("karnik", "nie-tan"))
    for name in (*names, "u"):
        counts[name] = draw.randint(2, size.terms)
        for term in range(counts[name]):
            middle, width = draw.uniform(-1, 1), 2.4 / counts[name]
            ends = sorted(middle + width * draw.uniform(-1, 1) for _ in range(4))
            shape = f"trapezoid {' '.join(f'{x:.3f}' for x in ends)}"
            if name == "u" and numbers:
                shape = f"singleton {middle:.3f}"
            if name == "u" and way == "tsukamoto":
                shape = f"ramp {middle:.3f} {middle + draw.choice([-0.4, 0.7]):.3f}"
            elif between:
                shape = f"{shape} over {shape} height 0.7"
            lines.append(f"term {name} t{term}: {shape}")
    way = f", defuzzifier {way}" if way else ", defuzzifier weighted-average" if numbers else ""
    way += ", aggregation sum" if draw.random() < 0.3 else ""
    way += ", and product" if numbers and "sum" in way and draw.random() < 0.5 else ""
    way += ", and bounded" if "product" not in way and draw.random() < 0.2 else ""
    lines.append(f"inference no-rule 0{way}")
    joints = [" and ", " and ", " or "] if "product" not in way else [" and "]
    for _ in range(draw.randint(3, size.rules)):
        word = draw.choice(["is", "is", "is", "is not"])
        parts = [f"{name} {word} t{draw.randrange(counts[name])}" for name in names]
        weight = draw.choice(["", "", " with 0.7"])
        joint = draw.choice(joints).join(parts)
        lines.append(f"rule if {joint} then u is t{draw.randrange(counts['u'])}{weight}")
    found = parse("\n".join(lines) + "\n").rulebase
    assert found is not None
    return found


def points(rulebase: RuleBase, draw: random.Random, count: int) -> dict[str, np.ndarray]:
    """Return points drawn at random, a fifth of the inputs at corners of terms."""
    rng = np.random.default_rng(draw.randrange(2**32))
    inputs = {}
    for variable in rulebase.inputs:
        corners = [x for term in variable.terms for x in term.shape.parameters]
        near = [x for x in corners if variable.low <= x <= variable.high] or [variable.low]
        even = rng.uniform(variable.low, variable.high, count)
        inputs[variable.name] = np.where(rng.random(count) < 0.8, even, rng.choice(near, count))
    return inputs


def case(draw: random.Random, told: Told) -> None:
    """Prove what can be proved of one rule base, and try to refute it."""
    size = SMALL if draw.random() < OFTEN_SMALL else LARGE
    counted["large"] += size is LARGE
    inputs, way = draw.choice([1, 1, 2, 2, 2]), draw.choice(["", draw.choice(OTHERS)])
    judged(irregular(draw, inputs, way, size), draw, told, size.points, size.seconds)


def judged(
    rulebase: RuleBase, draw: random.Random, told: Told, count: int, seconds: float | None = None
) -> None:
    """Try to refute what is proved of a rule base with one output ``u`` from -1 to 1."""
    told.append(write(rulebase))
    seconds = SECONDS if seconds is None else seconds
    inputs = points(rulebase, draw, count)
    values = np.asarray(infer(rulebase, inputs)["u"])
    prover = Prover(rulebase, "u", stop=Stop(seconds))
    try:
        bounds = prover.value({})
    except TimeOverError:
        return
    counted["value"] += 1
    assert bounds.low - 1e-11 <= values.min(), "below"
    assert values.max() <= bounds.high + 1e-11, "above"
    _plant(rulebase, bounds, seconds)
    _steps(rulebase, prover, inputs, seconds)
    _table(rulebase, prover, inputs, values, seconds)
    _multiples(rulebase, prover, inputs, values, seconds)


def _demand_not_proved(rulebase: RuleBase, line: str, seconds: float) -> None:
    counted["statements"] += 1
    assert prove(rulebase, line, budget=seconds).verdict != "proved", line


def _plant(rulebase: RuleBase, bounds: Bounds, seconds: float) -> None:
    high, low = bounds.reached_high - 2 * PLANTED, bounds.reached_low + 2 * PLANTED
    lines = [f"u <= {high!r}", f"u >= {low!r}"]
    if -math.inf < bounds.low < high:  # not where it is one number, or nothing is known yet
        lines.append(f"u in {bounds.low!r} .. {high!r}")
    for line in lines if math.isfinite(high - low) else []:
        _demand_not_proved(rulebase, line, seconds)


def _steps(
    rulebase: RuleBase, prover: Prover, inputs: dict[str, np.ndarray], seconds: float
) -> None:
    """Slopes of small steps are no steeper than the slopes that are proved."""
    name = rulebase.inputs[-1].name
    prover.stop = Stop(seconds)
    try:
        slopes = prover.slope({}, name)
    except (UnprovableError, TimeOverError):
        return
    counted["slope"] += 1
    step = 1e-4
    start = np.clip(inputs[name], -1.0, 1.0 - step)[:1000]
    here = {other: x[:1000] for other, x in inputs.items()} | {name: start}
    there = here | {name: start + step}
    rise = (np.asarray(infer(rulebase, there)["u"]) - np.asarray(infer(rulebase, here)["u"])) / step
    slack = 1e-8 * (1.0 + np.abs(rise).max())
    assert slopes.low - slack <= rise.min(), "steeper down"
    assert rise.max() <= slopes.high + slack, "steeper up"
    planted = slopes.reached_high - PLANTED * max(1.0, abs(slopes.reached_high))
    line = f"u slope {name} in {min(slopes.low, planted)!r} .. {planted!r}"
    _demand_not_proved(rulebase, line, seconds)


def _table(
    rulebase: RuleBase,
    prover: Prover,
    inputs: dict[str, np.ndarray],
    values: np.ndarray,
    seconds: float,
) -> None:
    table = compile_table(rulebase, levels=5)
    prover.stop = Stop(seconds)
    try:
        bounds = prover.table(table, "linear")
    except (UnprovableError, TimeOverError):
        return
    counted["table"] += 1
    error = values - np.asarray(table.lookup(*(inputs[n] for n in table.names), mode="linear"))
    assert bounds.low - 1e-11 <= error.min(), "table above"
    assert error.max() <= bounds.high + 1e-11, "table below"


def _multiples(
    rulebase: RuleBase,
    prover: Prover,
    inputs: dict[str, np.ndarray],
    values: np.ndarray,
    seconds: float,
) -> None:
    weights = {each.name: 1 for each in rulebase.inputs}
    prover.stop = Stop(seconds)
    try:
        found = sector(prover, weights)
    except (UnprovableError, TimeOverError):
        return
    counted["sector"] += 1
    form = sum(inputs.values())
    slack = (found.slack + 1e-11) * np.abs(form)
    assert (found.low * form**2 <= values * form + slack).all(), "below the sector"
    assert (values * form <= found.high * form**2 + slack).all(), "above the sector"


if __name__ == "__main__":
    # Seconds of the processor: on a busy machine as much is proved as on a quiet one.
    arithmetic.time = SimpleNamespace(monotonic=time.process_time)  # type: ignore[attr-defined]
    status = run(__doc__, case)
    print(counted)
    raise SystemExit(status)
