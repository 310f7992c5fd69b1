"""Attack what is proved, and paste what is said to refute; the judge is inference alone.

    python tests/fuzz/attacked_proofs.py --seed 1 --count 1000

A rule base with everything that a statement may stumble over: numbers for *no rule* inside and
beyond the range, held values and errors; outputs that extend, clamp or forbid; all norms, hedges
and implications; holes, sets without an area in the range, vertical edges, open ranges, thresholds.
Of each four statements, put where inference has been seen to be, a little to either side, and the
bounds of the value. Sets, values, monotone sets (Tsukamoto) and sets of interval type 2, each with
all its defuzzifiers, exact and sampled. A statement that is *proved* is attacked at corners, next
to them, at random and where no rule fires; the evidence of one that is *refuted* is pasted and run.
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "fuzz")]

import numpy as np  # noqa: E402
from fuzzing import Told, run  # noqa: E402

from fuzzyarm import compile_table, infer  # noqa: E402
from fuzzyarm.base.errors import FuzzyarmError  # noqa: E402
from fuzzyarm.inference import check_expectations  # noqa: E402
from fuzzyarm.inference.strengths import firing_strengths  # noqa: E402
from fuzzyarm.language import parse, write  # noqa: E402
from fuzzyarm.language.model.rulebase import RuleBase  # noqa: E402
from fuzzyarm.language.model.shapes import corner_points  # noqa: E402
from fuzzyarm.proof.map import Prover, UnprovableError, Verdict, prove  # noqa: E402
from fuzzyarm.proof.map.boxes import Boxes  # noqa: E402
from fuzzyarm.proof.stop import Stop, TimeOverError  # noqa: E402

SECONDS = 1.0
"""For each statement."""

STATEMENTS = 4

BOXES = 12
"""Boxes of each rule base that are attacked one by one."""

counted = {"boxes": 0, "statements": 0, "bounds": 0, "proved": 0, "refuted": 0, "undecided": 0}
"""What was asked, for whoever runs it by hand."""

Points = dict[str, np.ndarray]

STRAIGHT = ("triangle", "trapezoid", "rectangle", "ramp", "points", "singleton")
CURVED = ("gaussian", "bell", "sigmoid", "s", "z", "pi", "cosine")
MONOTONE = ("ramp", "ramp", "sigmoid", "s", "z", "concave", "arc")

FAMILIES = ("sets", "values", "monotone", "type 2")
"""What an output may be made of."""

SAMPLED = ("(21)", "(20, midpoints)", "(21, trapezoid)", "(20, left)", "(21, joined)")

OFTEN = {
    "sets": ["centroid exact"] * 6 + ["weighted-average"]
    + [f"{way}{how}" for way in ("centroid", "bisector") for how in (" exact", *SAMPLED)]
    + [f"{way}-of-maximum{how}"
       for way in ("mean", "smallest", "largest", "middle", "nearest", "farthest")
       for how in (" exact", " exact", "(21)", "(20, midpoints)")],
    "values": ["weighted-average"] * 4 + ["weighted-sum"] * 2 + ["centroid exact", "bisector exact"]
    + ["mean-of-maximum exact", "smallest-of-maximum exact", "largest-of-maximum exact"],
    "monotone": ["tsukamoto"],
    "type 2": [f"{way}{how}" for way in ("karnik-mendel", "nie-tan")
               for how in (" exact", " exact", "(21)", "(20, midpoints)", "(21, trapezoid)")],
}  # fmt: skip
"""The defuzzifiers of each, as often as they stand here."""


# ── rule bases ───────────────────────────────────────────────────────────────────────


class Drawn:
    """A rule base drawn at random, as text."""

    def __init__(self, draw: random.Random, family: str = "") -> None:
        self.draw = draw
        self.family = family or draw.choice(["sets", *FAMILIES])
        numbers = self.family == "type 2" and draw.random() < 0.25
        self.numbers = numbers or self.family == "values"
        self.lines = ["rulebase r"]
        self.curved = draw.random() < 0.25
        self.terms: dict[str, list[str]] = {}

    def text(self) -> str:
        draw = self.draw
        inputs = ["x", "y"][: draw.choice([1, 1, 1, 2, 2])]
        for name in inputs:
            self._input(name)
        low = draw.choice([-1, 0, -10])
        high = low + draw.choice([1, 2, 20])
        self.lines.append(f"output u {low} .. {high}")
        self._terms("u", low, high, values=self.numbers)
        self._settings(low, high)
        for _ in range(draw.randint(1, 6)):
            self.lines.append(self._rule(inputs))
        return "\n".join(self.lines) + "\n"

    def _input(self, name: str) -> None:
        draw = self.draw
        low = draw.choice([-3, -1, 0])
        high = low + draw.choice([1, 2, 8])
        ends, outside = f"{low} .. {high}", draw.choice(["clamp", "clamp", "extend", "error"])
        if draw.random() < 0.12:
            ends, outside = draw.choice(["-inf .. inf", f"{low} .. inf"]), "extend"
        self.lines += [f"input {name} {ends}", f"inference {name}: outside {outside}"]
        self._terms(name, low, high)

    def _terms(self, name: str, low: float, high: float, *, values: bool = False) -> None:
        draw = self.draw
        self.terms[name] = [f"T{i}" for i in range(draw.randint(1, 4))]
        for term in self.terms[name]:
            shape = f"singleton {self._place(low, high)}" if values else self._shape(low, high)
            if self.family == "monotone" and name == "u" and draw.random() < 0.9:
                shape = self._shape(low, high, draw.choice(MONOTONE))
            if self.family == "type 2" and draw.random() < 0.6:
                shape = self._interval(shape, low, high, values=values)
            self.lines.append(f"term {name} {term}: {shape}")

    def _interval(self, upper: str, low: float, high: float, *, values: bool) -> str:
        """Return a shape over one that is lower everywhere."""
        draw = self.draw
        kind, *numbers = upper.split(" height ", maxsplit=1)[0].split()
        if values:
            return f"{upper} over singleton {self._place(low, high)}"
        if kind == "triangle" and draw.random() < 0.5:
            a, b, c = map(float, numbers)
            part = draw.choice([0.25, 0.5])
            upper = f"triangle {a} {b} {c}"
            return f"{upper} over triangle {b - part * (b - a)} {b} {b + part * (c - b)}"
        return f"{upper} over {kind} {' '.join(numbers)} height {draw.choice([0.3, 0.5])}"

    def _place(self, low: float, high: float) -> float:
        draw, width = self.draw, high - low
        if draw.random() < 0.5:
            return round(low + width * draw.randint(-4, 20) / 16, 6)
        return round(draw.uniform(low - 0.3 * width, high + 0.3 * width), draw.choice([1, 3]))

    def _shape(self, low: float, high: float, kind: str = "") -> str:
        draw, width = self.draw, high - low
        kind = kind or draw.choice(CURVED if self.curved and draw.random() < 0.7 else STRAIGHT)
        a, b, c, d = sorted(self._place(low, high) for _ in range(4))
        heights = [draw.choice([0, 0, 0.3, 1]) for _ in range(3)] + [1]
        draw.shuffle(heights)
        pairs = zip((a, b, c, d), heights, strict=True)
        numbers = {
            "triangle": (a, b, c) if a < c else (a - width, b, c + width),
            "trapezoid": (a - 0.1, b, c, d + 0.1),
            "pi": (a - 0.1, b, c, d + 0.1),
            "rectangle": (a, d + 0.1),
            "s": (a, d + 0.1),
            "z": (a, d + 0.1),
            "ramp": draw.sample([a, d + 0.2], 2),
            "arc": draw.sample([a, d + 0.2], 2),
            "concave": draw.sample([a, d + 0.2], 2),
            "points": [f"({x}, {y})" for x, y in pairs],
            "singleton": (a,),
            "sigmoid": (b, draw.choice([-8, 5, 20]) / width),
            "bell": (b, 0.2 * width, draw.choice([1, 2.5])),
        }.get(kind, (b, draw.choice([0.05, 0.2, 0.5]) * width))
        height = "" if draw.random() < 0.9 else " height 0.6"
        return f"{kind} {' '.join(map(str, numbers))}{height}"

    def _settings(self, low: float, high: float) -> None:
        draw = self.draw
        no_rule = draw.choice(
            [low, 0.5 * (low + high), high, high + 1, low - 2.5, "error", "error", "hold", "nan"]
        )
        norms = ["min", "min", "product", "bounded", "drastic", "hamacher", "einstein", "nilpotent"]
        unions = ["max", "max", "max", "sum", "probor", "bounded", "hamacher", "drastic"]
        either = ["max", "max", "probor", "bounded", "hamacher", "einstein", "nilpotent", "drastic"]
        way = draw.choice(OFTEN[self.family])
        plain = draw.random() < 0.45
        joint, disjoint = ("min", "max") if plain else (draw.choice(norms), draw.choice(either))
        cut = "min" if plain or draw.random() < 0.5 else draw.choice(norms)
        union = "max" if plain else draw.choice(unions)
        threshold = draw.choice([0, 0, 0, 0, 0.25]) if not plain else 0
        self.lines += [
            f"inference and {joint}, or {disjoint}, implication {cut}, threshold {threshold}",
            f"inference u: aggregation {union}, defuzzifier {way}, no-rule {no_rule},"
            f" outside {draw.choice(['clamp', 'extend', 'extend', 'error'])}",
        ]

    def _rule(self, inputs: Sequence[str]) -> str:
        draw = self.draw
        parts = []
        for name in inputs if draw.random() < 0.8 else inputs[:1]:
            hedge = draw.choice(
                ["", "", "", "not ", "not ", "very ", "somewhat ", "any ", "seldom "]
            )
            parts.append(f"{name} is {hedge}{draw.choice(self.terms[name])}")
        weight = draw.choice(["", "", "", " with 0.7"])
        joined = draw.choice([" and ", " and ", " or "]).join(parts)
        hedge = ""
        if not self.numbers and self.family != "monotone" and draw.random() < 0.15:
            hedge = draw.choice(["not ", "very ", "somewhat "])
        return f"rule if {joined} then u is {hedge}{draw.choice(self.terms['u'])}{weight}"


def drawn(draw: random.Random, family: str = "") -> RuleBase:
    """Return a rule base that can be evaluated; of one of :data:`FAMILIES`, or of any."""
    while True:
        rulebase = parse(Drawn(draw, family).text()).rulebase
        if rulebase is None:
            continue
        try:
            infer(silent(rulebase), {v.name: 0.5 for v in rulebase.inputs})
        except FuzzyarmError:
            continue
        return rulebase


# ── what inference says ──────────────────────────────────────────────────────────────


def silent(rulebase: RuleBase) -> RuleBase:
    """Return a rule base that says NaN where an output has no value, and never raises for it."""
    outputs = tuple(
        each if isinstance(each.no_rule, float) else replace(each, no_rule=math.nan)
        for each in rulebase.outputs
    )
    return replace(rulebase, outputs=outputs)


def ends_of(rulebase: RuleBase, region: dict[str, tuple[float, float]]) -> dict[str, tuple]:
    """Return the stretch of each input; of an open range one beyond its corners."""
    found = {}
    for variable in rulebase.inputs:
        corners = [x for term in variable.terms for x in corner_points(term.shape)]
        low, high = region.get(variable.name, (variable.low, variable.high))
        low = low if math.isfinite(low) else min(corners) - 2.0
        high = high if math.isfinite(high) else max(corners) + 2.0
        found[variable.name] = low, high
    return found


def positions(rulebase: RuleBase, region: dict, draw: random.Random, count: int) -> Points:
    """Return points of a region: corners, their neighbours, middles, multiples, and any."""
    rng = np.random.default_rng(draw.randrange(2**32))
    found = {}
    for variable in rulebase.inputs:
        low, high = ends_of(rulebase, region)[variable.name]
        corners = np.array([x for term in variable.terms for x in corner_points(term.shape)])
        edges = np.unique(np.clip(np.array([low, high, *corners]), low, high))
        near = [edges, np.nextafter(edges, -np.inf), np.nextafter(edges, np.inf)]
        near += [0.5 * (edges[:-1] + edges[1:]), edges + 1e-6, edges - 1e-6]
        special = np.concatenate(near)
        special[np.abs(special) < 1e-290] = 0.0  # quotients of strengths below have no digits
        special = np.clip(special, low, high)
        even = rng.uniform(low, high, count)
        found[variable.name] = np.where(rng.random(count) < 0.5, even, rng.choice(special, count))
    return found


def values_of(rulebase: RuleBase, points: Points) -> np.ndarray:
    """Return the output; NaN where there is none, or an error."""
    judge = silent(rulebase)  # one object: what inference plans of it is remembered
    try:
        return np.asarray(infer(judge, points)["u"], dtype=float)
    except FuzzyarmError:
        found = []
        for row in zip(*points.values(), strict=True):
            try:
                found.append(infer(judge, dict(zip(points, map(float, row))))["u"])  # noqa: B905
            except FuzzyarmError:
                found.append(math.nan)
        return np.array(found)


def fires(rulebase: RuleBase, points: Points) -> np.ndarray:
    """Whether any rule fires."""
    outputs = tuple(replace(each, outside="extend") for each in rulebase.outputs)
    strengths, _ = firing_strengths(replace(rulebase, outputs=outputs), points)
    return np.asarray((strengths > 0.0).any(axis=0))


# ── statements ───────────────────────────────────────────────────────────────────────


def statements(
    rulebase: RuleBase, values: np.ndarray, draw: random.Random
) -> Iterator[tuple[str, dict[str, tuple[float, float]]]]:
    """Yield statements with their regions, close to what was seen."""
    known = values[np.isfinite(values)]
    output = rulebase.output("u")
    width = output.high - output.low
    for _ in range(STATEMENTS):
        region = {}
        for variable in rulebase.inputs:
            low, high = ends_of(rulebase, {})[variable.name]
            if not math.isfinite(variable.high - variable.low) or draw.random() < 0.25:
                a, b = sorted(round(draw.uniform(low, high), 2) for _ in range(2))
                a, b = max(a, variable.low), min(b, variable.high)
                region[variable.name] = (a, b) if a < b else (low, high)
        where = ", ".join(f"{name} in {a!r} .. {b!r}" for name, (a, b) in region.items())
        yield (f"{where} -> " if where else "") + _claim(rulebase, known, width, draw), region


def _claim(rulebase: RuleBase, known: np.ndarray, width: float, draw: random.Random) -> str:
    least, most = (known.min(), known.max()) if known.size else (0.0, 1.0)
    shift = width * draw.choice([-0.2, -1e-3, -1e-7, 0.0, 1e-10, 1e-7, 1e-3, 0.2])
    low, high = f"{least - shift:.10g}", f"{most + shift:.10g}"
    name = draw.choice([each.name for each in rulebase.inputs])
    kind = draw.choice(["high", "high", "low", "low", "in", "in", "strict", "equal", "rises",
                        "falls", "slope", "odd", "covered", "covered", "table"])  # fmt: skip
    return {
        "high": f"u <= {high}",
        "low": f"u >= {low}",
        "in": f"u in {low} .. {high}",
        "strict": draw.choice([f"u < {high}", f"u > {low}"]),
        "equal": f"u = {draw.choice([low, high])} ± {0.1 * width:.6g}",
        "rises": f"u rises with {name}",
        "falls": f"u falls with {name}",
        "slope": f"u slope {name} in {-draw.uniform(0, 4):.4g} .. {draw.uniform(0, 4):.4g}",
        "odd": "u odd",
        "covered": "u covered",
        "table": f"table {draw.choice(['linear', 'bins'])} within {draw.uniform(0, 0.3) * width:g}",
    }[kind]


# ── the attack ───────────────────────────────────────────────────────────────────────


def case(draw: random.Random, told: Told, family: str = "") -> None:
    """Attack some statements on one rule base."""
    rulebase = drawn(draw, family)
    text = write(rulebase)
    told.append(text)
    values = values_of(rulebase, positions(rulebase, {}, draw, 1_500))
    attack_boxes(rulebase, draw)
    attack_bounds(rulebase, draw)
    for statement, region in statements(rulebase, values, draw):
        told.append(f"prove {statement}")
        try:
            verdict = prove(rulebase, statement, budget=SECONDS)
        except FuzzyarmError as error:  # a statement that means nothing here, as odd of 0 .. 8
            told.append(str(error))
            continue
        told.append(f"{verdict.verdict} {verdict.reason} {verdict.evidence}")
        counted["statements"] += 1
        counted[verdict.verdict] += 1
        if verdict.verdict == "proved":
            attack(rulebase, statement, region, draw)
        elif verdict.verdict == "refuted":
            paste(rulebase, text, statement, verdict)


def attack_boxes(rulebase: RuleBase, draw: random.Random) -> None:
    """Nothing that inference says in a box lies outside what is said of that box."""
    ends = list(ends_of(rulebase, {}).values())
    try:
        boxes = Boxes(rulebase, "u", ends, Stop(5.0 * SECONDS))
    except (UnprovableError, TimeOverError):
        return
    for _ in range(BOXES):
        region = {}
        for name, (low, high) in ends_of(rulebase, {}).items():
            special = positions(rulebase, {name: (low, high)}, draw, 1)[name][0]
            a = draw.choice([draw.uniform(low, high), float(special)])
            b = a + (high - low) * draw.choice([0.0, 1e-9, 1e-4, 0.01, 0.1, 0.4])
            region[name] = (max(low, min(a, high)), max(low, min(b, high)))
        low, high = (np.array([[each[end] for each in region.values()]]) for end in (0, 1))
        counted["boxes"] += 1
        least, most = (float(each[0]) for each in boxes._value_bounds(low, high))
        values = values_of(rulebase, positions(rulebase, region, draw, 150))
        values = values[np.isfinite(values)]
        slack = 1e-11 * max(1.0, *np.abs(values)) if values.size else 0.0
        assert least - slack <= values.min(initial=math.inf), ("below", region, least, values.min())
        assert values.max(initial=-math.inf) <= most + slack, ("above", region, most, values.max())


def attack_bounds(rulebase: RuleBase, draw: random.Random) -> None:
    """Nothing that inference says lies outside bounds of the value."""
    region = {n: e for n, e in ends_of(rulebase, {}).items()
              if not math.isfinite(sum(map(abs, _range(rulebase, n))))}  # fmt: skip
    try:
        bounds = Prover(rulebase, "u", stop=Stop(SECONDS)).value(region)
    except (UnprovableError, TimeOverError):
        return
    counted["bounds"] += 1
    values = values_of(rulebase, positions(rulebase, region, draw, 3_000))
    values = values[np.isfinite(values)]
    slack = 1e-11 * max(1.0, *np.abs(values)) if values.size else 0.0
    assert bounds.low - slack <= values.min(initial=math.inf), ("below", bounds, values.min())
    assert values.max(initial=-math.inf) <= bounds.high + slack, ("above", bounds, values.max())


def _range(rulebase: RuleBase, name: str) -> tuple[float, float]:
    variable = rulebase.variable(name)
    return variable.low, variable.high


def attack(rulebase: RuleBase, statement: str, region: dict, draw: random.Random) -> None:
    """Look for a point at which a statement that is proved fails."""
    claim = statement.rpartition("-> ")[2].split()
    points = positions(rulebase, region, draw, 4_000)
    values = values_of(rulebase, points)
    output = rulebase.output("u")
    width = output.high - output.low
    slack = 1e-11 * max(1.0, width, float(np.nanmax(np.abs(values), initial=0.0)))
    if claim[1] in {"<", "<=", ">", ">=", "in", "="}:
        low, high = interval(claim)
        known = values[~np.isnan(values)]
        assert (known >= low - slack).all(), (statement, known.min())
        assert (known <= high + slack).all(), (statement, known.max())
        if output.no_rule == "error":
            assert fires(rulebase, points).all(), (statement, "no rule fires")
    elif claim[1] == "covered":
        assert fires(rulebase, points).all(), statement
    elif claim[1] in {"rises", "falls", "slope"}:
        along(rulebase, claim, region, draw)
    elif claim[1] == "odd":
        there = values_of(rulebase, {name: -x for name, x in points.items()})
        assert (np.abs(values + there) <= 1e-9 * width + slack).all(), statement
    else:
        table = compile_table(rulebase, "u")
        looked = table.lookup(*(points[name] for name in table.names), mode=claim[1])
        error = np.abs(np.asarray(looked) - values)
        assert (error[~np.isnan(error)] <= float(claim[3]) + slack).all(), (statement, error.max())


def interval(claim: Sequence[str]) -> tuple[float, float]:
    """Return what a statement on the value allows."""
    relation, number = claim[1], float(claim[2])
    if relation == "in":
        return number, float(claim[4])
    if relation == "=":
        return number - float(claim[4]), number + float(claim[4])
    return (-math.inf, number) if relation[0] == "<" else (number, math.inf)


def along(rulebase: RuleBase, claim: Sequence[str], region: dict, draw: random.Random) -> None:
    """Follow an input, the others fixed: steps are neither against the claim nor too steep."""
    name = claim[3] if claim[1] != "slope" else claim[2]
    ends, width = ends_of(rulebase, region), rulebase.output("u").high - rulebase.output("u").low
    for _ in range(12):
        fixed = positions(rulebase, region, draw, 1)
        own = positions(rulebase, region, draw, 150)[name]
        x = np.unique(np.concatenate([own, np.linspace(*ends[name], 150)]))
        u = values_of(rulebase, {**{k: np.full(x.size, v[0]) for k, v in fixed.items()}, name: x})
        step, rise = np.diff(x), np.diff(u)
        slack = 1e-11 * max(1.0, width)
        if claim[1] == "slope":
            low, high = float(claim[4]), float(claim[6])
            assert (rise >= low * step - slack).all(), claim
            assert (rise <= high * step + slack).all(), claim
        else:
            sign = 1.0 if claim[1] == "rises" else -1.0
            assert (sign * rise >= -slack).all(), (claim, (sign * rise).min())


def paste(rulebase: RuleBase, text: str, statement: str, verdict: Verdict) -> None:
    """Evidence holds as it is pasted, and shows that the statement fails."""
    claim = statement.rpartition("-> ")[2].split()
    again = parse(text + "\n".join(verdict.evidence) + "\n")
    assert again.rulebase is not None, [str(each) for each in again.diagnostics]
    failed = check_expectations(again.rulebase)
    assert not failed, [str(each) for each in failed]
    points = [dict(each.inputs) for each in again.rulebase.expectations]
    values = [float(infer(rulebase, point)["u"]) for point in points]
    if claim[1] in {"<", "<=", ">", ">=", "in", "="}:
        low, high = interval(claim)
        strict = claim[1] in {"<", ">"}
        for value in values:
            assert not low <= value <= high or (strict and value in (low, high)), (value, claim)
        if not points:
            _demand_silence(rulebase, verdict)
    elif claim[1] == "covered":
        _demand_silence(rulebase, verdict)
    elif claim[1] in {"rises", "falls"} and points:
        (first, second), sign = values, 1.0 if claim[1] == "rises" else -1.0
        assert points[0][claim[3]] < points[1][claim[3]]
        assert sign * (second - first) <= 0.0, (claim, values)
    elif claim[1] == "slope" and points:
        run_of = points[1][claim[2]] - points[0][claim[2]]
        slope = (values[1] - values[0]) / run_of
        slack = 1e-12 * max(1.0, *map(abs, values)) / abs(run_of)
        assert not float(claim[4]) + slack < slope < float(claim[6]) - slack, (claim, slope)
    elif claim[1] == "odd" and points:
        assert abs(values[0] + values[1]) > 0.0


def _demand_silence(rulebase: RuleBase, verdict: Verdict) -> None:
    assert verdict.points, verdict
    if "in exact arithmetic" in verdict.reason:  # by less than floats tell: nothing to paste
        return
    covers = verdict.statement.endswith(" covered")
    for point in verdict.points:
        one = {name: np.array([x]) for name, x in point.items()}
        if covers:
            assert not fires(rulebase, one).any(), (verdict, "a rule fires")
        else:  # what fires may have no area
            assert np.isnan(values_of(rulebase, one)).all(), (verdict, "there is a value")


if __name__ == "__main__":
    status = run(__doc__, case)
    print(counted)
    raise SystemExit(status)
