"""Draw loops and claims about them; what is said of them is judged by runs of our own.

    python tests/fuzz/random_loops.py --seed 1 --count 1000
    python tests/fuzz/random_loops.py --seed 1 --first 345 --count 1

The judge is :mod:`own_loop`, which has nothing of the package. Plants of one to three states,
linear, stiff, with products, sines, limits; rules with every `outside`, gaps and terms that end
beside the range; signals with memory, sensors, actuators, set points, references that move,
parameters, joined names.

- *proved*: runs from the region and from the starts, and those that climb towards a violation, stay
  where they are said to be, at samples and between them; V falls in each period by its share.
- *refuted*: the run from the start that is told does the same here.
- a certificate that is written is accepted; with any field changed and sealed again it is refused,
  or what it then says holds of our own runs.
- a plant or a controller that Python changed is in the sentence, and its certificate is refused for
  the files.
- No traceback, no warning, and no more than one and a half times the budget.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import random
import re
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "fuzz")]

import numpy as np  # noqa: E402
from fuzzing import Told, run  # noqa: E402
from own_loop import (  # noqa: E402
    Course,
    Driven,
    Line,
    Loop,
    Move,
    Output,
    OwnPlant,
    Rule,
    Rules,
    Runner,
    Seen,
    Term,
    Variable,
    move_of,
)

from fuzzyarm import load_controller, prove, simulate  # noqa: E402
from fuzzyarm.base.errors import FuzzyarmError  # noqa: E402
from fuzzyarm.control.loop.course import Options, Sensor  # noqa: E402
from fuzzyarm.language.model.claims import LoopClaim  # noqa: E402
from fuzzyarm.plant.own import find_plant  # noqa: E402
from fuzzyarm.plant.plant import with_parameters  # noqa: E402
from fuzzyarm.proof.check import Checked, check_certificate  # noqa: E402
from fuzzyarm.proof.check.certificate import sealed  # noqa: E402
from fuzzyarm.proof.check.numbers import precisely  # noqa: E402
from fuzzyarm.proof.check.tube import Followed, Follower  # noqa: E402
from fuzzyarm.proof.claim.text import loop_sentence, problem_of  # noqa: E402
from fuzzyarm.proof.loop import (  # noqa: E402
    LoopVerdict,
    read_claim,
    write_certificate,
)
from fuzzyarm.proof.loop.boxes import certify_tube  # noqa: E402
from fuzzyarm.proof.loop.timed import loop_tube  # noqa: E402

BUDGET = 1.0
"""Seconds for each claim."""

counted: dict[str, int] = {}
"""What was said, of which kind of claim."""


def count(*words: str) -> None:
    """Count one."""
    key = " ".join(words)
    counted[key] = counted.get(key, 0) + 1


# ── what is drawn ────────────────────────────────────────────────────────────────────


def number(draw: random.Random, low: float, high: float, digits: int = 3) -> float:
    """Return a short number."""
    return round(draw.uniform(low, high), digits)


def drawn_plant(draw: random.Random) -> OwnPlant:
    """Return a plant: mostly one that some gain holds at rest."""
    size = draw.choice([1, 1, 2, 2, 2, 3])
    rates, fastest = _rates(draw, size)
    affine = True
    if draw.random() < 0.35:
        extra, speed = _curve(draw, size)
        rates[-1] += extra
        fastest, affine = fastest + speed, False
    parameters = {}
    if draw.random() < 0.35:
        parameters["c"] = number(draw, 0.8, 1.2)
        rates[-1] = f"p[0] * ({rates[-1]})"
        fastest *= 1.5
    states = ("y", "v", "w")[:size]
    wide = draw.choice([1.0, 1.0, 10.0, 1000.0])
    outputs = [Output("y", "x[0]", -wide, wide)]
    if size > 1 and draw.random() < 0.6:
        outputs.append(Output("v", "x[1]", -wide, wide, "y"))
    if draw.random() < 0.12:
        of = draw.choice(
            [
                f"{draw.choice([0.5, 2.0])} * x[0] + 0.1 * x[{size - 1}]",
                "math.sin(x[0])",
                "x[0] + 0.1 * x[0] * x[0]",
                "x[0] + 0.1 * u[0]",
            ]
        )
        outputs.append(Output("z", of, -wide, wide))
    undriven = draw.random() < 0.1
    if undriven:
        rates[-1] += " + 0.7 * u[1]"
    limit = draw.choice([math.inf, 1.0, 5.0, 50.0])
    low = -limit if draw.random() < 0.8 else draw.choice([0.0, -0.5 * limit])
    return OwnPlant(
        states,
        tuple(rates),
        tuple(outputs),
        low if math.isfinite(limit) else -limit,
        limit,
        draw.choice([math.inf] * 5 + [20.0]),
        parameters,
        _start(draw, size, parameters),
        draw.choice([math.inf] * 6 + [5.0 * wide, 1e9]),
        affine,
        fastest,
        draw.choice([0.5, 1.0, 2.0, 10.0]),
        begin=draw.choice([0.0] * 6 + [0.3]),
        undriven=undriven,
        error_bound=draw.choice([math.inf] * 6 + [2.0 * wide]),
    )


def _rates(draw: random.Random, size: int) -> tuple[list[str], float]:
    gain = number(draw, 0.5, 12.0, 2)
    if size == 1:
        if draw.random() < 0.12:
            fast = draw.choice([200.0, 2000.0])
            return [f"{-fast} * x[0] + {fast} * u[0]"], fast
        own = draw.choice([0.0, number(draw, -5.0, 1.5)])
        return [f"{own} * x[0] + {gain} * u[0]"], abs(own) + 1.0
    stiff, loss = number(draw, -8.0, 25.0), number(draw, -0.2, 4.0)
    if draw.random() < 0.3:
        stiff = 0.0
    turn = f"{-stiff} * x[0] - {loss} * x[1]"
    fastest = math.sqrt(abs(stiff)) + abs(loss) + 1.0
    if size == 2:
        return ["x[1]", f"{turn} + {gain} * u[0]"], fastest
    fast = number(draw, 2.0, 40.0, 1)
    return ["x[1]", f"{turn} + {gain} * x[2]", f"{fast} * (u[0] - x[2])"], fastest + fast


def _curve(draw: random.Random, size: int) -> tuple[str, float]:
    k = number(draw, 0.2, 3.0)
    last = size - 1
    return draw.choice(
        [
            (f" - {k} * math.sin(x[0])", k),
            (f" + {k} * math.sin(x[0])", k),
            (f" + {k} * x[0] * u[0]", 5.0 * k),
            (f" - {k} * math.tanh(x[{last}])", k),
            (f" - {k} * x[{last}] * x[{last}] * x[{last}]", 10.0 * k),
            (f" + {k} * max(-0.5, min(0.5, x[0]))", k),
            (f" + {k} * x[0] * x[0]", 5.0 * k),
            (f" - {k} * abs(x[{last}])", k),
            (f" - {k} * x[0] / (1.0 + x[0] * x[0])", k),
            (f" - {k} * math.exp(-x[0] * x[0]) * x[0]", 2.0 * k),
            (f" - {k} * math.atan(x[{last}])", k),
            (f" + {k} * math.cos(x[0]) * u[0]", 5.0 * k),
        ]
    )


def _start(draw: random.Random, size: int, parameters: Mapping[str, float]) -> tuple[str, ...]:
    kind = draw.random()
    rest = ["0.0"] * (size - 1)
    if kind < 0.7:
        return ()
    if kind < 0.85:
        return (f"{number(draw, -0.5, 0.5)}", *rest)
    if kind < 0.95 or not parameters:
        return ("0.3 * float(rng.standard_normal())", *rest)
    return ("0.2 * parameter(self, 'c').value", *rest)


def drawn_rules(draw: random.Random, name: str, inputs: int) -> Rules:
    """Return a rule base of one or two inputs; half of them are those of a textbook."""
    plain = draw.random() < 0.5
    outside = ["clamp", "extend", "error"]
    variables = []
    for k in range(inputs):
        width = draw.choice([1.0, 1.0, 2.0])
        terms = _textbook(width) if plain and draw.random() < 0.8 else _odd(draw, width)
        variables.append(
            Variable(
                f"i{k}",
                -width,
                width,
                terms,
                draw.choice(outside[: 1 if plain and draw.random() < 0.5 else 3]),
            )
        )
    sets = draw.random() < 0.3
    count_ = draw.choice([2, 3, 3, 5])
    places = [-1.0 + 2.0 * k / (count_ - 1) for k in range(count_)]
    if not plain and draw.random() < 0.5:
        places = sorted({number(draw, -1.3, 1.3) for _ in range(count_)})
    step = 2.0 / (count_ - 1)
    conclusions = tuple(
        Term(f"O{k}", "triangle", (x - step, x, x + step))
        if sets
        else Term(f"O{k}", "singleton", (x,))
        for k, x in enumerate(places)
    )
    output = Variable(
        "u",
        -1.0,
        1.0,
        conclusions,
        draw.choice(["clamp"] if plain else ["clamp", "extend", "error"]),
    )
    if sets:
        output = replace(output, outside="clamp")
    # Mostly what is cut into straight pieces.
    aggregation = draw.choice(["max", "sum"])
    both = "min"
    if (aggregation == "sum" and not sets) or draw.random() < 0.1:
        both = draw.choice(["min", "product", "product", "bounded"])
    rules = _rows(draw, variables, len(places), full=plain or draw.random() < 0.5)
    return Rules(
        name,
        tuple(variables),
        output,
        rules,
        "centroid" if sets else draw.choice(["weighted-average"] * 4 + ["weighted-sum"]),
        aggregation,
        both,
        "max",
        draw.choice(["0", "error"])
        if plain
        else draw.choice(["error", "error", "0", "0", "0", "0.5", "0.5", "hold", "nan"]),
    )


def _textbook(width: float) -> tuple[Term, ...]:
    return tuple(
        Term(name, "triangle", ((k - 1) * width, k * width, (k + 1) * width))
        for name, k in (("N", -1), ("Z", 0), ("P", 1))
    )


def _odd(draw: random.Random, width: float) -> tuple[Term, ...]:
    """Terms that overlap or leave gaps, and end beyond the range or before its ends."""
    count_ = draw.choice([2, 3, 4])
    terms = []
    for k in range(count_):
        middle = width * (-1.0 + 2.0 * k / (count_ - 1)) + width * number(draw, -0.1, 0.1)
        reach = 2.0 * width / (count_ - 1)
        a = round(middle - reach * draw.choice([0.4, 0.9, 1.0, 1.0, 1.6, 30.0]), 4)
        d = round(middle + reach * draw.choice([0.4, 0.9, 1.0, 1.0, 1.6, 30.0]), 4)
        top = draw.choice([0.0, 0.0, 0.2 * reach])
        b, c = round(middle - min(top, middle - a), 4), round(middle + min(top, d - middle), 4)
        if draw.random() < 0.07:
            a = b
        kind = Term(f"T{k}", "trapezoid", (a, b, c, d))
        terms.append(kind if top else Term(f"T{k}", "triangle", (a, round(middle, 4), d)))
    return tuple(
        t
        if t.numbers == tuple(sorted(t.numbers)) and t.numbers[0] < t.numbers[-1]
        else Term(t.name, "triangle", (-width, 0.0, width))
        for t in terms
    )


def _rows(
    draw: random.Random, variables: Sequence[Variable], conclusions: int, *, full: bool
) -> tuple[Rule, ...]:
    rules = []
    sizes = [len(variable.terms) for variable in variables]
    cells = (
        [(i,) for i in range(sizes[0])]
        if len(sizes) == 1
        else [(i, j) for i in range(sizes[0]) for j in range(sizes[1])]
    )
    for cell in cells:
        if not full and draw.random() < 0.25:
            continue
        share = sum(i / (size - 1) for i, size in zip(cell, sizes, strict=True)) / len(sizes)
        then = round(share * (conclusions - 1))
        if not full and draw.random() < 0.15:
            then = draw.randrange(conclusions)
        parts = tuple((k, not full and draw.random() < 0.1, i) for k, i in enumerate(cell))
        weight = draw.choice([0.5, 0.8]) if not full and draw.random() < 0.2 else 1.0
        joint = "or" if not full and len(parts) > 1 and draw.random() < 0.1 else "and"
        rules.append(Rule(parts, then, joint, weight))
    return tuple(rules) or (Rule(((0, False, 0),), 0),)


def drawn_loop(draw: random.Random) -> Loop:
    """Return a loop; mostly one whose runs from near 0 stay there and have values."""
    tame = draw.random() < 0.8
    for _ in range(30 if tame else 1):
        loop = _any_loop(draw)
        if tame and not _is_tame(loop):
            continue
        break
    return loop


def _is_tame(loop: Loop) -> bool:
    """Whether four runs of 80 periods stay near, and fade where they come from near 0."""
    runner = Runner(replace(loop, plant=replace(loop.plant, fastest=0.2 * loop.plant.fastest)), 1)
    size, sizes = len(loop.plant.states), np.array([0.3, -0.3, 0.05, -0.05])
    states = np.zeros((size, 4))
    states[0] = sizes
    values = np.array([[x] * 4 for x in loop.plant.parameters.values()]).reshape(-1, 4)
    course = runner.run(states, values, 80)
    ends = np.abs(course.states[-1] - course.states[-1].mean(axis=1, keepdims=True)).max()
    return not course.lost.any() and bool(ends < 0.25)


def plain_loop(draw: random.Random) -> Loop:
    """Return a loop of which a region may be found: an affine plant, odd rules, some memory."""
    size = draw.choice([1, 2, 2, 3])
    rates, fastest = _rates(draw, size)
    wide = draw.choice([1.0, 1.0, 10.0, 1000.0])
    outputs = [Output("y", "x[0]", -wide, wide)]
    if size > 1:
        outputs.append(Output("v", "x[1]", -wide, wide, "y"))
    affine = draw.random() < 0.75
    if not affine:
        k = number(draw, 0.2, 3.0)
        rates[-1] += draw.choice(
            [
                f" - {k} * math.sin(x[0])",
                f" + {k} * x[0] * u[0]",
                f" - {k} * math.tanh(x[0])",
                f" - {k} * math.atan(x[0])",
            ]
        )
        fastest += 5.0 * k
    limit = draw.choice([math.inf, 5.0])
    plant = OwnPlant(
        ("y", "v", "w")[:size],
        tuple(rates),
        tuple(outputs),
        -limit,
        limit,
        bound=draw.choice([math.inf, 5.0 * wide]),
        affine=affine,
        fastest=fastest,
    )
    lines = [Line("e", "error", ("y",), draw.choice([0.3, 1.0, 3.0]))]
    if size > 1:
        lines.append(Line("d", "error", ("v",), draw.choice([0.1, 0.3])))
    elif draw.random() < 0.3:
        lines.append(Line("d", "rate", ("e",), 0.05, {"filter": 0.05}))
    signals = [line.name for line in lines]
    variables = tuple(
        Variable(f"i{k}", -1.0, 1.0, _textbook(1.0), draw.choice(["clamp", "extend", "error"]))
        for k in range(len(signals))
    )
    places = (-1.0, -0.5, 0.0, 0.5, 1.0) if len(signals) > 1 else (-1.0, 0.0, 1.0)
    output = Variable(
        "u",
        -1.0,
        1.0,
        tuple(Term(f"O{k}", "singleton", (x,)) for k, x in enumerate(places)),
        "clamp",
    )
    rules = Rules(
        "r",
        variables,
        output,
        _rows(draw, variables, len(places), full=True),
        aggregation="sum",
        both=draw.choice(["min", "product"]),
    )
    lines.append(Line("k", "rules", tuple(signals), draw.choice([0.5, 1.0, 3.0]), {"rules": rules}))
    last = "k"
    if draw.random() < 0.2:
        lines.append(Line("i", "integral", ("e",), 0.2))
        lines.append(Line("t", "sum", ("k", "i"), 1.0, {"signs": (1.0, 1.0)}))
        last = "t"
    period = draw.choice([0.005, 0.01, 0.02, 0.05])
    sensors = {"y": Seen(delay=draw.choice([1.0, 2.0]) * period)} if draw.random() < 0.2 else {}
    within = draw.choice([None, None, (-1.0, 1.0)])
    drives = (Driven("u", last, draw.choice([1] * 14 + [-1]), within),)
    return Loop(_late(draw, plant, period), period, tuple(lines), drives, sensors)


def _any_loop(draw: random.Random) -> Loop:
    plant = drawn_plant(draw)
    period = draw.choice([0.001, 0.005, 0.01, 0.01, 0.02, 0.05, 0.1])
    lines, signals = _sources(draw, plant)
    last, drive = _law(draw, lines, signals, plant)
    slew = draw.choice([None] * 6 + [10.0])
    bounds = draw.choice([None, None, (-1.0, 1.0), (-0.3, 0.8)])
    if any("hold" in line.options for line in lines):
        bounds = bounds or (-1.0, 1.0)
    drives = (Driven(drive, last, draw.choice([1] * 9 + [-1]), bounds, slew),)
    sensors = _sensors(draw, plant, period)
    set_point = {"y": number(draw, -0.4, 0.4)} if draw.random() < 0.25 else {}
    connect = {}
    if draw.random() < 0.15:
        lines = [replace(line, of=("Y",)) if line.of == ("y",) else line for line in lines]
        connect = {"Y": "y"}
    plant = _late(draw, plant, period)
    return Loop(plant, period, tuple(lines), drives, sensors, set_point, connect)


def _late(draw: random.Random, plant: OwnPlant, period: float) -> OwnPlant:
    """Return some plants with a dead time of their actuator, of whole periods."""
    return replace(plant, dead=draw.choice([0] * 5 + [1, 2, 3]) * period)


def _sources(draw: random.Random, plant: OwnPlant) -> tuple[list[Line], list[str]]:
    """Return the lines that rules may read, and the names of two of them at most."""
    gain = draw.choice([0.3, 1.0, 1.0, 3.0])
    lines = [Line("e", "error", ("y",), gain)]
    signals = ["e"]
    kind = draw.random()
    if len(plant.outputs) > 1 and plant.outputs[1].name == "v" and kind < 0.7:
        lines.append(Line("d", "error", ("v",), draw.choice([0.1, 0.3, 1.0])))
        signals.append("d")
    elif kind < 0.5:
        options = draw.choice([{}, {"filter": 0.05}, {"filter": 0.2}])
        lines.append(Line("d", "rate", ("e",), draw.choice([0.05, 0.2]), options))
        signals.append("d")
    extra = draw.random()
    if extra < 0.08:
        lines.append(Line("q", "lag", ("e",), 1.0, {"time": 0.05}))
    elif extra < 0.14:
        lines.append(
            Line("q", draw.choice(["deadband", "hysteresis"]), ("e",), 1.0, {"width": 0.1})
        )
    elif extra < 0.24:
        lines.append(Line("s", "product", ("e", "e"), draw.choice([1.0, 0.3])))
        lines.append(Line("q", "sum", ("e", "s"), 1.0, {"signs": (1.0, -1.0)}))
    elif extra < 0.28:
        lines.append(Line("q", "change", ("e",), 3.0))
    elif extra < 0.34:  # filters in a row
        lines.append(Line("f", "lag", ("e",), 1.0, {"time": draw.choice([0.02, 0.2])}))
        lines.append(Line("q", "lag", ("f",), 1.0, {"time": 0.05}))
    elif extra < 0.42:  # one law near, another one far away: with a jump between them
        lines.append(Line("g", "sum", ("e",), 1.0, {"signs": (draw.choice([0.3, 0.9, 3.0]),)}))
        where = ("e", draw.choice(["<", "<=", ">", ">="]), draw.choice([-0.1, 0.05, 0.3, 1.0]))
        lines.append(
            Line("q", "choice", draw.choice([("e", "g"), ("g", "e")]), 1.0, {"where": where})
        )
    else:
        return lines, signals
    return lines, ["q", *signals[1:]]


def _law(
    draw: random.Random, lines: list[Line], signals: list[str], plant: OwnPlant
) -> tuple[str, str]:
    if draw.random() < 0.15:
        signs = tuple(number(draw, 0.2, 4.0, 2) for _ in signals)
        lines.append(Line("k", "sum", tuple(signals), 1.0, {"signs": signs}))
        return "k", plant.input
    rules = drawn_rules(draw, "r", len(signals))
    lines.append(
        Line("k", "rules", tuple(signals), draw.choice([0.5, 1.0, 3.0, 10.0]), {"rules": rules})
    )
    if draw.random() < 0.2:
        options: dict[str, object] = draw.choice(
            [
                {},
                {"within": (-0.5, 0.5)},
                {"hold": 1.0},
                {"within": (-0.2, 0.4), "start": 0.1},
                {"back": 0.1, "start": 0.1},
                {"back": 0.5, "within": (-1.0, 1.0)},
            ]
        )
        gain = draw.choice([0.2, 1.0])
        if "hold" in options:
            options = {"hold": gain}
        lines.append(Line("i", "integral", (signals[0],), gain, options))
        lines.append(Line("t", "sum", ("k", "i"), 1.0, {"signs": (1.0, 1.0)}))
        if "back" not in options and draw.random() < 0.3:  # back needs one way to the drive
            where = ("t", draw.choice(["<", ">"]), draw.choice([-0.1, 0.1, 1.0]))
            lines.append(Line("z", "choice", draw.choice([("t", "k"), ("k", "t")]), 1.0,
                              {"where": where}))  # fmt: skip
            return "z", plant.input
        return "t", plant.input
    return "k", plant.input


def _sensors(draw: random.Random, plant: OwnPlant, period: float) -> dict[str, Seen]:
    if draw.random() < 0.65:
        return {}
    ports = plant.outputs if draw.random() < 0.3 else [draw.choice(plant.outputs)]
    return {port.name: _sensor(draw, port, period) for port in ports}


def _sensor(draw: random.Random, port: Output, period: float) -> Seen:
    kind = draw.random()
    if kind < 0.5:
        return Seen(delay=draw.choice([1.0, 2.0, 3.0, 1.5, 0.3]) * period)
    if kind < 0.8:
        return Seen(resolution=draw.choice([0.01, 0.001]))
    if port.rate_of:
        return Seen(difference=draw.choice([0.0, 0.02]))
    return Seen(delay=period, resolution=0.01)


# ── a case ───────────────────────────────────────────────────────────────────────────


class Bench:
    """A loop, its files in the folder at hand, and runs of our own."""

    def __init__(self, draw: random.Random, loop: Loop, told: Told) -> None:
        self.draw, self.loop, self.told = draw, loop, told
        self.rng = np.random.default_rng(draw.randrange(2**32))
        self.files = {"own.py": loop.plant.text, "own.frb": loop.text}
        self.files |= {f"{rules.name}.frb": rules.text for rules in loop.rule_bases}
        for name, text in self.files.items():
            Path(name).write_text(text)
            told.append(f"# {name}\n{text}")
        told.append(f"# sensors {loop.sensors} connect {loop.connect} at {loop.set_point}")
        self.controller = load_controller("own.frb")
        self.plant = find_plant("own.py")
        self.runner = Runner(loop)
        self.own_start = self._start_of_plant()

    @property
    def words(self) -> dict[str, Any]:
        """Of the package, for the sensors and names of the loop."""
        sensors = {
            name: Sensor(resolution=s.resolution, delay=s.delay, difference=s.difference)
            for name, s in self.loop.sensors.items()
        }
        return {"sensors": sensors, "connect": dict(self.loop.connect) or None}

    @property
    def is_drawn(self) -> bool:
        """Whether the plant draws its start."""
        return any("rng" in text for text in self.loop.plant.start)

    def _start_of_plant(self) -> list[str]:
        return list(self.loop.plant.start) or ["0.0"] * len(self.loop.plant.states)

    def starts(
        self,
        box: Mapping[str, tuple[float, float]],
        parameters: Mapping[str, tuple[float, float]],
        runs: int,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return states and parameters: corners, borders, and the inside of boxes."""
        plant = self.loop.plant
        values = np.array(
            [
                self._within(*parameters.get(name, (x, x)), runs)
                for name, x in plant.parameters.items()
            ]
        ).reshape(-1, runs)
        states = []
        for k, name in enumerate(plant.states):
            if name in box:
                states.append(self._within(*box[name], runs))
            else:
                states.append(self._begun(k, values, runs))
        return np.array(states), values

    def _begun(self, k: int, values: np.ndarray, runs: int) -> np.ndarray:
        text = self.own_start[k]
        if "rng" in text:
            return 0.3 * self.rng.standard_normal(runs)
        if "parameter" in text:
            return 0.2 * values[0]
        return np.full(runs, float(text))

    def _within(self, low: float, high: float, runs: int) -> np.ndarray:
        even = self.rng.uniform(low, high, runs) if low < high else np.full(runs, low)
        ends = self.rng.choice([low, high], runs)
        return np.where(self.rng.random(runs) < 0.5, even, ends)

    def run(self, states: np.ndarray, parameters: np.ndarray, periods: int, **words: Any) -> Course:
        """Run from starts."""
        return self.runner.run(states, parameters, periods, **words)


def slack(loop: Loop, *sizes: float) -> float:
    """Return by how much our own runs may be off."""
    return (1e-9 if loop.plant.affine else 1e-7) * (1.0 + max(map(abs, sizes), default=0.0))


Box = dict[str, tuple[float, float]]


def box_text(box: Box) -> str:
    """Return intervals as a claim has them."""
    return ", ".join(f"{name} in {low!r} .. {high!r}" for name, (low, high) in box.items())


def case(draw: random.Random, told: Told) -> None:
    """Draw a loop, and ask about it."""
    loop = plain_loop(draw) if draw.random() < 0.4 else drawn_loop(draw)
    with folder_at_hand(), warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            bench = Bench(draw, loop, told)
        except FuzzyarmError as error:  # of files that mean nothing
            raise AssertionError(f"cannot be read: {error}") from error
        if draw.random() < 0.15:
            demand_same_runs(bench)
        if draw.random() < 0.15:
            demand_bound(bench)
        kind = draw.random()
        if kind < 0.35:
            judge_stable(bench)
        elif kind < 0.65:
            judge_bounded(bench)
        elif kind < 0.75:
            judge_moving(bench)
        elif kind < 0.85:
            judge_sets(bench)
        elif kind < 0.93:
            judge_tube(bench)
        else:
            judge_endless(bench)


@contextlib.contextmanager
def folder_at_hand() -> Iterator[None]:
    """Be in a folder of one's own."""
    with tempfile.TemporaryDirectory() as name, contextlib.chdir(name):
        yield


def asked(bench: Bench, statement: str, budget: float = BUDGET) -> LoopVerdict | None:
    """Return a verdict; None where the claim is refused in a sentence."""
    bench.told.append(f"prove: {statement} (budget {budget})")
    begun = time.process_time()
    try:
        verdict = prove(bench.controller, statement, plant="own.py", budget=budget, **bench.words)
    except FuzzyarmError as error:
        count("refused")
        bench.told.append(f"refused: {error}")
        return None
    taken = time.process_time() - begun
    bench.told.append(f"{verdict}\n({taken:.2f} s)")
    assert taken < 1.5 * budget + 0.5, f"{taken:.2f} s of the processor with a budget of {budget}"
    return verdict


def at_text(bench: Bench) -> str:
    """Return the set points of a claim."""
    at = bench.loop.set_point
    return f"at {', '.join(f'{name} = {x!r}' for name, x in at.items())} " if at else ""


def drawn_conditions(bench: Bench, size: float) -> tuple[Box, Box, str]:
    """Return starts, parameters, and the words of a claim for both."""
    draw, plant = bench.draw, bench.loop.plant
    box: Box = {}
    if (bench.is_drawn and draw.random() < 0.7) or (not bench.is_drawn and draw.random() < 0.9):
        for k, name in enumerate(plant.states):
            if k and draw.random() < 0.4 and not bench.is_drawn:
                continue
            middle = size * number(draw, -1.0, 1.0)
            half = size * draw.choice([0.0, 0.01, 0.1, 0.1])
            if k:
                middle *= 0.3
            box[name] = (round(middle - half, 6), round(middle + half, 6))
    parameters: Box = {}
    if plant.parameters and draw.random() < 0.6:
        c = plant.parameters["c"]
        parameters["c"] = (round(c - 0.05, 6), round(c + 0.05, 6))
    words = at_text(bench)
    words += f"with {box_text(parameters)} " if parameters else ""
    words += f"from {box_text(box)}" if box else ""
    return box, parameters, words.strip()


# ── for a bounded time ───────────────────────────────────────────────────────────────


def judge_bounded(bench: Bench) -> None:
    """Claim of a port, close to where our own runs are, for a time with an end."""
    draw, loop = bench.draw, bench.loop
    box, parameters, words = drawn_conditions(bench, draw.choice([0.3, 1.0, 2.5]))
    periods = draw.choice([1, 2, 3, 5, 10, 20, 40])
    end = periods * loop.period
    begin = draw.choice([0.0, 0.0, 0.5 * end, loop.period * (periods // 2)])
    port = draw.choice([*(each.name for each in loop.plant.outputs), loop.plant.input, "y", "y"])
    seen = extremes(bench, box, parameters, port, begin, end)
    low, high = seen.low, seen.high
    if not (math.isfinite(low) and abs(low) < 1e6 and abs(high) < 1e6):
        low, high = -1.0, 1.0
    width = max(high - low, 1e-3)
    a = low - width * draw.choice([0.3, 0.05, 0.01, 1e-3, -1e-3, -0.1])
    b = high + width * draw.choice([0.3, 0.3, 0.05, 0.01, 1e-3, -1e-3, -0.1])
    if not a < b:
        a, b = low - width, high + width
    statement = f"{words}: {port} in {a!r} .. {b!r} during {begin!r} .. {end!r} s"
    verdict = asked(bench, statement)
    if verdict is None:
        return
    count("bounded", verdict.verdict)
    if verdict.verdict == "proved":
        demand_bounded(bench, box, parameters, port, (a, b), begin, end)
        if verdict.tube is not None:
            demand_in_tube(bench, verdict.tube, box, parameters, end)
        if draw.random() < 0.4:
            demand_certificate(bench, verdict)
    elif verdict.verdict == "refuted":
        demand_refuted(bench, verdict, port, (a, b), begin, end)


def judge_moving(bench: Bench) -> None:
    """Claim of an output or its error along a reference that moves, for a time with an end."""
    draw, period = bench.draw, bench.loop.period
    fixed = {name: x for name, x in bench.loop.set_point.items() if name != "y"}
    plant = replace(bench.loop.plant, error_bound=math.inf)
    bench = Bench(draw, replace(bench.loop, plant=plant, set_point=fixed), bench.told)
    kind, numbers = drawn_move(draw, period)
    move = move_of(kind, numbers)
    bench = along(bench, {"y": move})
    box, parameters, words = drawn_conditions(bench, draw.choice([0.1, 0.3, 1.0]))
    periods = draw.choice([2, 5, 10, 20, 40])
    end = periods * period
    begin = draw.choice([0.0, 0.0, 0.5 * end])
    port = draw.choice(["error of y", "error of y", "y", bench.loop.plant.input])
    seen = extremes(bench, box, parameters, port, begin, end)
    if not (math.isfinite(seen.low) and abs(seen.low) < 1e6 and abs(seen.high) < 1e6):
        return
    width = max(seen.high - seen.low, 1e-3)
    a = seen.low - width * draw.choice([0.5, 0.2, 0.05, 0.01, 1e-3, -1e-3])
    b = seen.high + width * draw.choice([0.5, 0.2, 0.05, 0.01, 1e-3, -1e-3])
    claim = f"{port} in {a!r} .. {b!r} during {begin!r} .. {end!r} s"
    verdict = asked(bench, f"{words} while y follows {move.text}: {claim}", 2.0)
    if verdict is None:
        return
    count("moving", kind, verdict.verdict)
    if verdict.verdict == "proved":
        demand_bounded(bench, box, parameters, port, (a, b), begin, end)
        if draw.random() < 0.4:
            demand_certificate(bench, verdict)
    elif verdict.verdict == "refuted":
        demand_refuted(bench, verdict, port, (a, b), begin, end)


def drawn_move(draw: random.Random, period: float) -> tuple[str, tuple[float, ...]]:
    """Return a kind of reference and its numbers, as a certificate has them."""
    first, last, other = (number(draw, -0.4, 0.4) for _ in range(3))
    time = draw.choice([0.0, 1.0, 3.0, 4.5, 7.2]) * period
    some = draw.choice([0.5, 1.0, 5.0, 12.5]) * period
    kind = draw.choice(["step", "ramp", "sine", "quintic"])
    if kind == "sine":
        return kind, (last, round(draw.uniform(0.01, 0.2) / period, 3), first)
    if kind == "ramp":
        return kind, (last, time, first)
    if kind == "step":
        return kind, (last, time, first)
    more = draw.choice([(), (last, 2 * period), (other, 4.25 * period)])
    return kind, (last, some, first, *more)


def along(bench: Bench, moves: Mapping[str, Move], loop: Loop | None = None) -> Bench:
    """Return a bench with other references, or another loop."""
    loop = replace(loop or bench.loop, moves=dict(moves))
    other = object.__new__(Bench)
    vars(other).update(vars(bench), loop=loop, runner=Runner(loop))
    return other


def in_time(course: Course, port: str, begin: float, end: float) -> np.ndarray:
    """Return the values of a port, runs in columns, in a time with both ends."""
    if port in course.outputs:
        at = (course.times >= begin - 1e-12) & (course.times <= end + 1e-12)
        return course.outputs[port][at]
    period = course.times[-1] / len(course.drives)
    # Held from each sample to the next one, which begins a new value: not judged at that moment.
    held = np.arange(len(course.drives)) * period
    at = (held + period > begin + 1e-9 * period) & (held < end - 1e-9 * period)
    return course.drives[at]


def extremes(
    bench: Bench,
    box: Box,
    parameters: Box,
    port: str,
    begin: float,
    end: float,
    target: tuple[float, float] | None = None,
) -> SimpleNamespace:
    """Return how far a port goes, by runs that climb; and the worst starts."""
    periods = max(1, math.ceil(end / bench.loop.period - 1e-9))
    states, values = bench.starts(box, parameters, 200)
    free = [(0, k, *box[n]) for k, n in enumerate(bench.loop.plant.states) if n in box]
    free += [
        (1, k, *parameters[n]) for k, n in enumerate(bench.loop.plant.parameters) if n in parameters
    ]
    low, high, lost, worst = math.inf, -math.inf, False, None
    for turn in range(4):
        course = bench.run(states, values, periods)
        rows = in_time(course, port, begin, end)
        lost = lost or bool(course.lost.any())
        if rows.size:
            least, most = rows.min(axis=0), rows.max(axis=0)
            low, high = min(low, float(least.min())), max(high, float(most.max()))
            order = np.concatenate([np.argsort(least)[:10], np.argsort(-most)[:10]])
            worst = (states[:, order], values[:, order])
        if turn == 3 or worst is None or not free:
            break
        states, values = np.tile(worst[0], 6), np.tile(worst[1], 6)
        for which, k, a, b in free:
            rows_of = states if which == 0 else values
            step = (b - a) * 0.3 ** (turn + 1) * bench.rng.standard_normal(rows_of.shape[1])
            rows_of[k] = np.clip(rows_of[k] + step, a, b)
    return SimpleNamespace(low=low, high=high, lost=lost, worst=worst)


def demand_bounded(
    bench: Bench,
    box: Box,
    parameters: Box,
    port: str,
    between: tuple[float, float],
    begin: float,
    end: float,
) -> None:
    """A claim that is proved holds of our own runs, all of which have a value."""
    seen = extremes(bench, box, parameters, port, begin, end)
    assert not seen.lost, "proved, and the controller has no value in a run"
    room = slack(bench.loop, seen.low, seen.high)
    assert seen.low >= between[0] - room, ("false proof: below", port, seen.low, between)
    assert seen.high <= between[1] + room, ("false proof: above", port, seen.high, between)


def demand_in_tube(bench: Bench, tube: Any, box: Box, parameters: Box, end: float) -> None:
    """All of our own runs are in a tube, at samples and between them."""
    loop = bench.loop
    periods = max(1, math.ceil(end / loop.period - 1e-9))
    states, values = bench.starts(box, parameters, 150)
    course = bench.run(states, values, periods)
    assert not course.lost.any(), "a tube of runs without a value"
    for port in [each.name for each in loop.plant.outputs]:
        for k in bench.rng.choice(periods, min(periods, 12), replace=False):
            begin, stop = k * loop.period, min((k + 1) * loop.period, end)
            bounds = tube.bounds(port, begin, stop)
            rows = in_time(course, port, begin, stop)
            room = slack(loop, float(rows.min()), float(rows.max()))
            assert bounds.low - room <= rows.min(), ("tube", port, k, bounds, rows.min())
            assert rows.max() <= bounds.high + room, ("tube", port, k, bounds, rows.max())


def judge_tube(bench: Bench) -> None:
    """Ask for the bounds of all ports for a time."""
    draw = bench.draw
    box, parameters, words = drawn_conditions(bench, draw.choice([0.3, 1.0, 2.5]))
    end = draw.choice([1, 3, 10, 30]) * bench.loop.period
    bench.told.append(f"tube: {words} for {end}")
    begun = time.process_time()
    try:
        claim = LoopClaim(
            "own.py",
            stable=True,
            start=_rows_of(box),
            parameters=_rows_of(parameters),
            at=tuple(bench.loop.set_point.items()),
        )
        tube, _ = loop_tube(
            bench.controller, claim, end, plant=bench.plant, budget=BUDGET, **bench.words
        )
    except FuzzyarmError as error:
        count("tube", "refused")
        bench.told.append(f"refused: {error}")
        return
    assert time.process_time() - begun < 1.5 * BUDGET + 0.5, "the budget of a tube"
    count("tube", str(tube.complete))
    if tube.complete:
        demand_in_tube(bench, tube, box, parameters, end)


def _rows_of(box: Box) -> tuple[tuple[str, float, float], ...]:
    return tuple((name, low, high) for name, (low, high) in box.items())


EVIDENCE = re.compile(r"([A-Za-z]\w*) = (\S+?)(?:,|$)")


@precisely
def judge_sets(bench: Bench) -> None:
    """Sets of the checker hold our own runs, sample by sample, until it says that they are lost."""
    claim = read_claim(f"stable {at_text(bench)}".strip(), "own.py")
    try:
        problem = problem_of(bench.controller, claim, plant=bench.plant, **bench.words)
        follower = Follower(problem)
    except FuzzyarmError:
        count("sets refused")
        return
    draw, places = bench.draw, [list(bench.loop.plant.states).index(s) for s in problem.states]
    for _ in range(4):
        box = {}
        for name in problem.states:
            middle = draw.choice([0.0, 0.3, 1.0, 3.0]) * draw.uniform(-1.0, 1.0)
            half = draw.choice([0.0, 1e-3, 0.05, 0.3]) * draw.random()
            box[name] = (middle - half, middle + half)
        states, values = bench.starts(box, {}, 40)
        course = bench.run(states, values, 25)
        follower.numbers.sets = 1
        now = follower.start_forms([[tuple(map(Fraction, box[name])) for name in problem.states]])
        for k in range(25):
            follower.numbers.symbols = max(len(form.weights) for form in now)
            try:
                which, now, _ = follower._advanced(np.arange(1), now, k, "", [Followed(0)])
            except FuzzyarmError:
                which = np.arange(0)
            if not len(which):
                count("sets lost")
                break
            for form, place in zip(now, places, strict=False):
                low, high, x = form.span.low[0], form.span.high[0], course.states[k + 1][place]
                room = 10.0 * slack(bench.loop, low, high)
                seen = x[~course.lost]
                assert (seen >= low - room).all(), ("a run leaves the sets", k, box)
                assert (seen <= high + room).all(), ("a run leaves the sets", k, box)
        else:
            count("sets hold")
            assert not course.lost.any(), ("followed, and runs have no value", box)


def demand_refuted(
    bench: Bench,
    verdict: LoopVerdict,
    port: str,
    between: tuple[float, float],
    begin: float,
    end: float,
) -> None:
    """The run that refutes does so here; one that has no value may do so anyhow."""
    states, values = started(bench, verdict)
    course = bench.run(states, values, max(1, math.ceil(end / bench.loop.period - 1e-9)))
    if course.lost.any():
        return
    rows = in_time(course, port, begin, end)
    reads_drive = any("u[0]" in each.of for each in bench.loop.plant.outputs if each.name == port)
    if port not in course.outputs or reads_drive:  # new at a sample: before it or after it
        return
    room = slack(bench.loop, *between) * 1e3
    bad = (rows < between[0] + room).any() or (rows > between[1] - room).any()
    far = not bool((np.abs(course.states) < 1e6).all()) or bound_left(bench, course)
    assert bad or far, ("false refutation", verdict.evidence, rows.min(), rows.max(), between)


def bound_left(bench: Bench, course: Course) -> bool:
    """Whether a run is beyond what its plant takes for divergence."""
    plant = bench.loop.plant
    error = bench.loop.set_point.get("y", 0.0) - course.outputs["y"]
    return bool((np.abs(error) > plant.error_bound).any()) or any(
        bool((np.abs(rows) > plant.bound).any()) for rows in course.outputs.values()
    )


def started(bench: Bench, verdict: LoopVerdict) -> tuple[np.ndarray, np.ndarray]:
    """Return the start that a refutation tells, as it is rounded there."""
    plant = bench.loop.plant
    told = dict(EVIDENCE.findall(verdict.evidence[0].removeprefix("from ")))
    states, values = bench.starts({}, {}, 1)
    for k, name in enumerate(plant.states):
        if name in told:
            states[k] = float(told[name])
    for k, name in enumerate(plant.parameters):
        if name in told:
            values[k] = float(told[name])
    return states, values


# ── for all time ─────────────────────────────────────────────────────────────────────


def judge_stable(bench: Bench) -> None:
    """Claim stability, from somewhere or from nowhere said."""
    draw = bench.draw
    box: Box = {}
    parameters: Box = {}
    words = at_text(bench)
    if draw.random() < 0.3:
        box, parameters, words = drawn_conditions(bench, draw.choice([0.1, 0.5, 2.0]))
    verdict = asked(bench, f"stable {words}", draw.choice([1.0, 2.0]))
    if verdict is None:
        return
    count("stable from" if box else "stable", verdict.verdict)
    if verdict.verdict == "proved":
        demand_stable(bench, verdict, box, parameters)
        if verdict.certificate is not None and draw.random() < 0.5:
            demand_certificate(bench, verdict)
    elif verdict.verdict == "refuted":
        demand_unstable(bench, verdict)


def judge_endless(bench: Bench) -> None:
    """Claim of a port for all time, or from a time on."""
    draw = bench.draw
    box, parameters, words = drawn_conditions(bench, draw.choice([0.02, 0.1, 0.5]))
    port = draw.choice([each.name for each in bench.loop.plant.outputs])
    begin = draw.choice([0.0, 0.0, 20 * bench.loop.period])
    seen = extremes(bench, box, parameters, port, begin, max(60, 3 * 20) * bench.loop.period)
    if not (math.isfinite(seen.low) and abs(seen.low) < 1e3 and abs(seen.high) < 1e3):
        return
    width = max(seen.high - seen.low, 1e-2)
    grow = draw.choice([0.05, 0.5, 2.0])
    between = (seen.low - grow * width, seen.high + grow * width)
    when = f"after {begin!r} s" if begin else "always"
    verdict = asked(bench, f"{words}: {port} in {between[0]!r} .. {between[1]!r} {when}", 2.0)
    if verdict is None:
        return
    count("endless", verdict.verdict)
    if verdict.verdict == "proved":
        end = begin + 400 * bench.loop.period
        if box or verdict.tube is not None:  # else of its region, which is judged below
            demand_bounded(bench, box, parameters, port, between, begin, end)
        if verdict.tube is None:
            demand_region(bench, verdict)
        if verdict.certificate is not None and draw.random() < 0.5:
            demand_certificate(bench, verdict)
    elif verdict.verdict == "refuted":
        demand_refuted(bench, verdict, port, between, begin, begin + 400 * bench.loop.period)


PERIODS = 300


def demand_stable(bench: Bench, verdict: LoopVerdict | Checked, box: Box, parameters: Box) -> None:
    """Runs from a proved region, and from the starts of the claim, come to rest."""
    if verdict.continuous:
        return
    arrival = arrival_of(bench, verdict)
    if arrival is None:
        demand_region(bench, verdict)
    if box or arrival is not None:
        states, values = bench.starts(box, parameters, 200)
        course = bench.run(states, values, _long(bench, verdict))
        assert not course.lost.any(), "stable, and the controller has no value in a run"
        demand_at_rest(bench, verdict, course)


def arrival_of(bench: Bench, verdict: LoopVerdict | Checked) -> float | None:
    """Return when all runs are in the region; None: they begin there."""
    if isinstance(verdict, Checked):
        tubes = verdict.certificate.tubes
        return max(tube.periods for tube in tubes) * bench.loop.period if tubes else None
    return verdict.tube.arrival if verdict.tube is not None else None


def _long(bench: Bench, verdict: LoopVerdict | Checked) -> int:
    """Return periods after which V has fallen to a millionth, or as many as we run."""
    fall = max(verdict.fall, 1e-6)
    arrival = arrival_of(bench, verdict)
    return min(1500, math.ceil(14.0 / fall) + math.ceil((arrival or 0.0) / bench.loop.period) + 10)


def demand_at_rest(bench: Bench, verdict: LoopVerdict | Checked, course: Course) -> None:
    """Where V falls by a share in each period, states are so near to rest by the end."""
    names = bench.loop.plant.states
    arrival = arrival_of(bench, verdict)
    left = len(course.drives) - math.ceil((arrival or 0.0) / bench.loop.period) - 1
    share = math.sqrt((1.0 - verdict.fall) ** max(left, 0))
    for k, name in enumerate(names):
        low, high = verdict.region[name]
        rest = verdict.rest[name]
        reach = max(high - rest, rest - low) * share * (1.0 + 1e-6)
        off = np.abs(course.states[-1][k] - rest).max()
        room = slack(bench.loop, rest) + 4e-9
        assert off <= reach + room, ("false proof: not at rest", name, off, reach)


def demand_region(bench: Bench, verdict: LoopVerdict | Checked) -> None:
    """V ≤ 1 is not left, and V falls by its share in each period."""
    certificate = verdict.certificate
    assert certificate is not None
    loop = bench.loop
    p = np.array([[float(x) for x in row] for row in certificate.region.p])
    rest = np.array([verdict.rest[name] for name in certificate.region.states])
    own = [memory_key(name, loop) for name in certificate.region.states]
    parameters = {n: (a, b) for n, a, b in certificate.claim.parameters}
    _, values = bench.starts({}, parameters, 300)
    runs = 300
    factor = np.linalg.inv(np.linalg.cholesky(p)).T
    way = bench.rng.standard_normal((len(p), runs))
    way /= np.linalg.norm(way, axis=0)
    size = np.where(bench.rng.random(runs) < 0.6, 1.0, bench.rng.random(runs) ** 3)
    z = factor @ (way * size)
    points = z + rest[:, None]
    names = list(loop.plant.states)
    states = np.array([points[certificate.region.states.index(name)] for name in names])
    memory: dict[str, np.ndarray] | None = None
    if len(names) < len(certificate.region.states):
        if any(key is None for key in own):
            count("region not sampled")
            return _demand_along(bench, verdict)
        memory = {
            key: points[k]
            for k, key in enumerate(own)
            if key and certificate.region.states[k] not in names
        }
    try:
        course = bench.run(states, values, PERIODS, memory=memory)
    except KeyError:  # of a memory that the certificate does not have
        count("region not sampled")
        return _demand_along(bench, verdict)
    count("region sampled")
    assert not course.lost.any(), "a region with runs without a value"
    before = np.einsum("ir,ij,jr->r", z, p, z)
    # With functions of cones z'Pz is only below what it was at first, times their growth.
    growth = float(certificate.region.growth)
    count("region of cones" if certificate.region.cones else "region of one function")
    for k in range(PERIODS):
        place = {name: course.states[k + 1][j] for j, name in enumerate(names)}
        if k + 1 < PERIODS:
            place |= {
                name: course.memory[k + 1].get(key)
                for name, key in zip(certificate.region.states, own, strict=True)
                if key
            }
        elif memory is not None:
            break
        away = np.array(
            [place[name] - r for name, r in zip(certificate.region.states, rest, strict=True)]
        )
        now = np.einsum("ir,ij,jr->r", away, p, away)
        room = 1e-7 + (1e-5 * before if not loop.plant.affine else 1e-7 * before)
        worst = int(np.argmax(now - before))
        # Down to what the rest is known by.
        floor = 1e-12 + 1e-7 * np.abs(p).max() * 1e-9
        wrong = now > growth * (1.0 - verdict.fall) * before + room + floor
        assert not wrong.any(), ("false proof: V grows", k, before[worst], now[worst], z[:, worst])
        before = (1.0 - verdict.fall) * before if certificate.region.cones else now
    return None


def _demand_along(bench: Bench, verdict: LoopVerdict | Checked) -> None:
    """Runs that begin along one state, the memory as it begins, stay in the region and fade."""
    names = bench.loop.plant.states
    for k, name in enumerate(names):
        reach = verdict.start_region.get(name)
        if reach is None:
            continue
        states, values = bench.starts({}, {}, 9)
        for j, other in enumerate(names):
            states[j] = verdict.rest[other]
        states[k] += np.linspace(-0.999, 0.999, 9) * reach
        course = bench.run(states, values, _long(bench, verdict))
        assert not course.lost.any(), "a region with runs without a value"
        for j, other in enumerate(names):
            low, high = verdict.region[other]
            room = slack(bench.loop, low, high)
            assert course.states[:, j].min() >= low - room, ("left the region", other)
            assert course.states[:, j].max() <= high + room, ("left the region", other)
        demand_at_rest(bench, verdict, course)


def memory_key(name: str, loop: Loop) -> str | None:
    """Return what our own loop calls a memory of a certificate; None: it has another."""
    bare = name.partition(".")[2] or name
    if bare.endswith(" driven"):
        return "driven"
    if " pending " in bare:
        return f"pending {bare.rpartition(' ')[2]}"
    if " slew " in bare:
        return "slew 0"
    if " excess " in bare:
        return "excess"
    return (
        bare
        if bare.endswith((" total", " before", " slope", " lagged", " held")) or " late " in bare
        else None
    )


def demand_unstable(bench: Bench, verdict: LoopVerdict) -> None:
    """The run that refutes neither comes to rest here, nor do those from nearer to its end."""
    states, values = started(bench, verdict)
    loop = bench.loop
    periods = min(6000, max(1500, 3 * math.ceil(loop.plant.duration / loop.period)))
    if not loop.plant.affine:
        periods = min(periods, 2000)
    course = bench.run(states, values, periods)
    if course.lost.any() or bound_left(bench, course):
        return
    last = course.states[-periods // 3 :, :, 0]
    move = np.abs(last - last[-1]).max()
    begun, end = course.states[0, :, 0], last[-1]
    if not move < 1e-6 * max(np.abs(begun - end).max(), 1e-9) + 1e-12:
        return  # it moves on
    # That it is stable is said of the rest next to which the run begins, by the word of the pages.
    near_by = {port.name: 3e-3 * (port.high - port.low) for port in loop.plant.outputs}
    claim = verdict.claim
    if (
        claim is not None
        and not claim.start
        and any(
            abs(begun[k] - end[k]) > near_by.get(name, 3e-3)
            for k, name in enumerate(loop.plant.states)
        )
    ):
        return
    near = np.repeat(end[:, None], 40, axis=1)
    near += 1e-4 * max(np.abs(begun - end).max(), 1e-6) * bench.rng.standard_normal(near.shape)
    again = bench.run(near, np.repeat(values, 40, axis=1), periods)
    if again.lost.any():
        return  # they go where rules have no value
    off = np.abs(again.states[-1] - end[:, None]).max()
    assert off > 1e-2 * np.abs(near - end[:, None]).max() or grows(bench, course, values), (
        "false refutation: it comes to rest",
        verdict.evidence,
        end,
    )


def grows(bench: Bench, course: Course, values: np.ndarray) -> bool:
    """Whether small deviations grow in the end, memory among them: slowly, an integral's.

    Each block of periods begins with the deviations of the block before, made small again, so that
    what grows most is left.
    """
    rest, kept = course.states[-2][:, :1], {k: v[:1] for k, v in course.memory[-1].items()}
    shape = (len(rest), 40)
    states = rest + 1e-4 * bench.rng.standard_normal(shape)
    memory = {k: v + 1e-4 * bench.rng.standard_normal(shape[1]) for k, v in kept.items()}
    runs, growth = np.repeat(values, shape[1], axis=1), np.ones(shape[1])

    def away(states: np.ndarray, memory: dict[str, np.ndarray]) -> np.ndarray:
        rows = [*(states - rest), *(memory[k] - kept[k] for k in kept)]
        return np.abs(rows).max(axis=0)

    for _ in range(4):
        begun = away(states, memory)
        block = bench.run(states, runs, 1500, memory=memory)
        states, memory = block.states[-2], block.memory[-1]
        left = away(states, memory)
        growth = left / begun
        small = 1e-4 / np.where(left > 0.0, left, 1.0)
        states = rest + (states - rest) * small
        memory = {k: kept[k] + (memory[k] - kept[k]) * small for k in kept}
    return bool((growth > 1.0).any())


# ── simulate ─────────────────────────────────────────────────────────────────────────


def demand_same_runs(bench: Bench) -> None:
    """`simulate` and our own loop agree: else one of them misreads the pages."""
    loop = bench.loop
    if bench.is_drawn:
        return
    try:
        run_ = simulate(
            bench.controller,
            bench.plant,
            duration=30 * loop.period,
            reference={
                port.name: loop.set_point.get(port.name, 0.0)
                for port in loop.plant.outputs
                if not port.rate_of
            },
            options=Options(
                sensors=bench.words["sensors"], runge_kutta=0 if loop.plant.affine else 8
            ),
            connect=bench.words["connect"],
        )
    except FuzzyarmError as error:
        bench.told.append(f"simulate: {error}")
        return
    if run_.diverged is not None or any("hold" in r.no_rule for r in loop.rule_bases):
        return
    states, values = bench.starts({}, {}, 1)
    course = bench.run(states, values, 30)
    if course.lost.any() or loop.plant.fastest * loop.period > 0.5:
        return
    if any(s.resolution for s in loop.sensors.values()):
        return  # a value next to a step may fall to either side
    count("same runs")
    for port, rows in course.outputs.items():
        # An output that reads a drive is sampled before the drive of the new period.
        theirs = np.asarray(run_.outputs[port])[1:]
        mine = rows[bench.runner.between :: bench.runner.between + 1, 0][: len(theirs)]
        size = 1.0 + np.abs(mine).max()
        off = np.abs(mine - theirs).max()
        assert off < 1e-4 * size, ("simulate differs", port, off)


# ── certificates ─────────────────────────────────────────────────────────────────────


def demand_certificate(bench: Bench, verdict: LoopVerdict) -> None:
    """A certificate is accepted; with a field changed it is refused, or what it says holds."""
    certificate = verdict.certificate
    if certificate is None:
        if verdict.claim is None or not verdict.claim.output or math.isinf(verdict.claim.end):
            return
        try:
            certificate = certify_tube(
                bench.controller, verdict.claim, plant=bench.plant, budget=BUDGET, **bench.words
            )
        except FuzzyarmError as error:
            count("certificate not found")
            bench.told.append(f"certificate: {error}")
            return
    count("certificate", type(certificate).__name__)
    write_certificate(certificate, "c.json")
    again = check_certificate("c.json", plant=bench.plant)
    assert again.proved, ("its certificate is refused", str(again))
    data = json.loads(Path("c.json").read_text())
    leaves = list(fields_of(data))
    bench.draw.shuffle(leaves)
    often = [
        path for path in leaves if path[0] in ("claim", "sensors", "connect", "regions", "tubes")
    ]
    some = [*often[:8], *leaves[:4]]
    if bench.draw.random() < 0.1:  # every field, except for most of the numbers
        count("every field forged")
        some = [p for p in leaves if "p" not in p] + some
    for path in some:
        if path == ("claim", "plant"):  # which we give
            continue
        demand_forged(bench, data, path)


def demand_bound(bench: Bench) -> None:
    """What Python changed is said, and a certificate of it is not one of the files."""
    plant, text, draw = find_plant("own.py"), bench.controller, bench.draw
    claim = read_claim(f"y in -1e3 .. 1e3 during 0 .. {bench.loop.period!r} s", "own.py")
    plain = loop_sentence(claim, plant=plant, text=text)
    kind = draw.choice(["actuator", "equations", "start", "parameter", "period", "rules"])
    if kind == "actuator":
        port = plant.inputs["u"]
        plant.inputs = {"u": replace(port, high=port.high + 1.0 if port.high < 1e9 else 1e3)}
    elif kind == "equations":
        own = plant.derivative
        plant.derivative = lambda t, x, u, p: [rate + 0.125 for rate in own(t, x, u, p)]
    elif kind == "start":
        plant.start = lambda rng: [0.0625 * (k + 1) for k in range(len(plant.states))]
    elif kind == "parameter" and plant.parameters:
        plant = with_parameters(plant, {"c": 1.0625})
    elif kind == "rules" and text.sheets:
        sheets = {
            name: tuple(replace(s, outputs=tuple(_other(o) for o in s.outputs)) for s in row)
            for name, row in text.sheets.items()
        }
        text = replace(text, sheets=sheets)
    else:
        kind = "period"
        text = replace(text, model=replace(text.model, period=2.0 * text.model.period))
    bench.told.append(f"changed in Python: {kind}")
    count("changed", kind)
    said = loop_sentence(claim, plant=plant, text=text)
    assert said != plain, ("a change is not said", kind)
    try:
        certificate = certify_tube(text, claim, plant=plant, budget=BUDGET, **bench.words)
    except FuzzyarmError:
        return
    write_certificate(certificate, "b.json")
    assert check_certificate("b.json", text, plant).statement.startswith(said)
    try:
        again = check_certificate("b.json", plant=bench.plant)
    except FuzzyarmError:
        count("changed and refused")
        return
    raise AssertionError(("a certificate of a changed loop is accepted", kind, str(again)))


def _other(output: Any) -> Any:
    return replace(output, outside="clamp" if output.outside == "extend" else "extend")


Path_ = tuple[str | int, ...]


def fields_of(value: Any, path: Path_ = ()) -> Iterator[Path_]:
    """Yield where something may be changed."""
    if path and path[0] in ("seal", "format"):
        return
    if isinstance(value, dict):
        for name, part in value.items():
            yield from fields_of(part, (*path, name))
    elif isinstance(value, list):
        for k, part in enumerate(value):
            yield from fields_of(part, (*path, k))
    if path:
        yield path


def forged(draw: random.Random, value: Any) -> Any:
    """Return something else."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, str):
        return draw.choice(_texts_near(value))
    if isinstance(value, list):
        return draw.choice([[], value[:-1], [*value, *value[-1:]], value[::-1]])
    if not isinstance(value, dict):
        return draw.choice(
            ["0", "1/100", "inf", True] if value is None else [value + 1, -1, "x", None]
        )
    name = draw.choice([*value, "y", "a.y"])
    if name in value and draw.random() < 0.7:
        return {k: v for k, v in value.items() if k != name}
    return {**value, name: draw.choice([1, "1", ["1/100", None], None])}


def _texts_near(value: str) -> list[Any]:
    """Return other texts for one: numbers near a number, words for a word, what is none."""
    if re.fullmatch(r"-?\d+(/\d+)?", value):
        x, step = Fraction(value), Fraction(1, 1000)
        near = [x + step, x - step, x * 2, x / 2, -x, x * (1 + step), Fraction(0), x + 1]
        return [*map(str, near), "inf", "-inf", None, "x", 1]
    times = ["always", "during", "after"]
    return [*(times if value in times else ["y", "v", "u"]), "", "own.py", value + "x", None, 3]


def demand_forged(bench: Bench, data: Any, path: Path_) -> None:
    """Change a field, seal it, and judge what is then accepted."""
    changed = json.loads(json.dumps(data))
    inner = changed
    for key in path[:-1]:
        inner = inner[key]
    before = inner[path[-1]]
    inner[path[-1]] = forged(bench.draw, before)
    if inner[path[-1]] == before:
        return
    changed.pop("seal")
    bench.told.append(f"forged {path}: {str(before)[:80]} -> {str(inner[path[-1]])[:80]}")
    Path("f.json").write_text(json.dumps(sealed(changed)))
    begun = time.process_time()
    try:
        verdict = check_certificate("f.json", plant=bench.plant)
    except (FuzzyarmError, OSError):  # of a file that is not there
        count("forged refused")
        bench.told.pop()
        return
    assert time.process_time() - begun < 30.0, "a forged certificate keeps the checker busy"
    if not verdict.proved:
        count("forged refused")
        bench.told.pop()
        return
    count("forged accepted")
    bench.told.append(f"accepted: {verdict}")
    demand_said(bench, verdict)
    del bench.told[-2:]


def demand_said(bench: Bench, verdict: Checked) -> None:
    """What a certificate says, of whatever loop, holds of our own runs."""
    claim, certificate = verdict.claim, verdict.certificate
    sensors = {
        name.rpartition(".")[2]: Seen(s.delay, s.resolution, s.difference)
        for name, s in certificate.sensors.items()
    }
    loop = replace(
        bench.loop,
        sensors=sensors,
        set_point={n.rpartition(".")[2]: x for n, x in claim.at},
        connect={name: port.rpartition(".")[2] for name, port in certificate.connect.items()}
        or bench.loop.connect,
    )
    moves = {each.port.rpartition(".")[2]: each for each in claim.follows}
    other = along(bench, {n: move_of(each.kind, each.numbers) for n, each in moves.items()}, loop)
    box = {n: (a, b) for n, a, b in claim.start}
    parameters = {n: (a, b) for n, a, b in claim.parameters}
    is_region = not certificate.tubes
    if is_region and not verdict.continuous:
        demand_region(other, verdict)
    if not claim.output:
        if claim.start and not verdict.continuous:
            demand_stable(other, verdict, box, parameters)
        return
    assert claim.begin <= claim.end, "a claim that ends before it begins is accepted"
    assert claim.end > 0.0, "a claim that ends before the run is accepted"
    end = claim.end if math.isfinite(claim.end) else claim.begin + 300 * loop.period
    if not certificate.regions:
        assert math.isfinite(claim.end), "sets for a time, and a claim without an end"
        assert claim.when == "during", f"sets for a time, and a claim that holds '{claim.when}'"
    port = claim.output.rpartition(".")[2]
    if claim.error and port not in moves:
        return
    port = f"error of {port}" * claim.error or port
    if box or not is_region:
        demand_bounded(other, box, parameters, port, (claim.low, claim.high), claim.begin, end)


if __name__ == "__main__":
    status = run(__doc__, case)
    print(dict(sorted(counted.items())))
    raise SystemExit(status)
