"""The kernel, compiled and interpreted, gives the numbers of two evaluators that share nothing.

Rule bases are drawn as cases of the referee: every norm, method and sampling that it has, weights,
hedges, sets of interval type 2. Numbers of straight sets are fractions of powers of two, so that a
degree is the same number in floats and in fractions, and a tie is a tie in both.
"""

from __future__ import annotations

import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from budget import cases
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from conformance import exact, second
from conformance.make_cases import converted
from conformance.pieces import NotStraightError
from fuzzyarm.inference import compiled
from fuzzyarm.language import parse
from tests.interpreted import interpreted

sys.path.insert(0, str(Path(__file__).parents[2] / "conformance" / "runners"))
from fuzzyarm_runner import text_of

CLOSE = 1e-8
"""Of a range of 8: what is searched for by halving is found to some 1e-9 of it."""

POINTS = 3
SMOOTH = ("minimum", "product", "lukasiewicz", "hamacher", "einstein")
EXACT = ("minimum", "product", "lukasiewicz", "drastic", "nilpotent")
"""T-norms whose results have no rounding here."""

UNIONS = ("maximum", "probabilistic sum", "lukasiewicz", "sum", "drastic", "nilpotent")
STRAIGHT = ("triangle", "trapezoid", "rectangle", "ramp", "points")
MAXIMA = tuple(
    f"{which} of maxima"
    for which in ("mean", "smallest", "largest", "middle", "nearest", "farthest")
)
SAMPLES = {
    "endpoints": (9, 17, 33),
    "trapezoid": (9, 17, 33),
    "midpoints": (8, 16, 32),
    "left": (8, 16),
}
INTERVALS = ("karnik-mendel", "karnik-mendel left", "karnik-mendel right", "nie-tan")

Draw = Any
Case = dict[str, Any]


def eighths(low: int, high: int) -> st.SearchStrategy[float]:
    return st.integers(8 * low, 8 * high).map(lambda i: i / 8)


@st.composite
def shapes(draw: Draw, kinds: tuple[str, ...]) -> Case:
    """A shape over about 0 .. 8; the widths of slopes are powers of two."""
    kind = draw(st.sampled_from(kinds))
    a, w, v = draw(eighths(0, 6)), *draw(st.tuples(*[st.sampled_from([0.5, 1.0, 2.0, 4.0])] * 2))
    flat = draw(st.sampled_from([0.5, 1.0, 2.0]))
    numbers = {
        "triangle": [a - w, a, a + v], "trapezoid": [a - w, a, a + flat, a + flat + v],
        "rectangle": [a, a + flat], "ramp": draw(st.sampled_from([[a, a + w], [a + w, a]])),
        "points": [[a - w, 0.25], [a, 1.0], [a + v, draw(st.sampled_from([0.0, 0.5]))]],
        "s": [a - w, a + v], "z": [a - w, a + v], "pi": [a - w, a, a + flat, a + flat + v],
        "gaussian": [a, w], "sigmoid": [a, draw(st.sampled_from([-2.0, 1.0, 3.0]))],
        "bell": [a, w, draw(st.sampled_from([1.0, 2.0]))],
    }  # fmt: skip
    height = {} if draw(st.integers(0, 3)) else {"height": 0.75}
    return {"shape": kind, "parameters": numbers[kind], **height}


def between(term: Case) -> Case:
    """Return a term with a lower function: its own, half as high."""
    return {**term, "lower": {**term, "height": 0.5 * term.get("height", 1.0)}}


@st.composite
def conditions(draw: Draw, names: tuple[str, ...], depth: int = 2) -> Case:
    word = draw(st.sampled_from(["is", "is", "not", "very", *["and", "or"] * depth]))
    if word in {"and", "or"}:
        parts = st.lists(conditions(names, depth - 1), min_size=2, max_size=3)
        return {word: draw(parts)}
    about = {"is": [draw(st.sampled_from(names)), draw(st.sampled_from("LMH"))]}
    return about if word == "is" else {word: about}


@st.composite
def settings_of(draw: Draw, method: str, *, jumps: bool, sampled: bool) -> Case:
    norms = EXACT if jumps else SMOOTH
    way: Case = {"method": method}
    unions = UNIONS[:4] if not jumps else UNIONS
    if sampled:
        sampling = draw(st.sampled_from(tuple(SAMPLES)))
        way |= {"samples": draw(st.sampled_from(SAMPLES[sampling])), "sampling": sampling}
    return {
        "and": draw(st.sampled_from(norms)), "or": draw(st.sampled_from(unions[:3])),
        "implication": draw(st.sampled_from(norms)), "aggregation": draw(st.sampled_from(unions)),
        "defuzzifier": way, "outside": draw(st.sampled_from(["clamp", "extend"])),
        "no rule": draw(st.sampled_from(["nothing", 0.5])),
    }  # fmt: skip


CONSTANTS = eighths(0, 8).map(lambda x: {"shape": "constant", "parameters": [x]})
LINEAR = st.tuples(eighths(-2, 2), eighths(0, 4)).map(
    lambda pair: {"shape": "linear", "parameters": {"e": pair[0], "": pair[1]}}
)
ALL = (*STRAIGHT, "s", "z", "pi", "gaussian", "sigmoid", "bell")
KINDS = {
    "sets": (shapes(STRAIGHT), ("centroid", "bisector")),
    "curved": (shapes(ALL), ("centroid",)),
    "maxima": (shapes(STRAIGHT), MAXIMA),
    "exact maxima": (shapes(STRAIGHT), MAXIMA),
    "values": (CONSTANTS | LINEAR, ("weighted average", "weighted sum")),
    "tsukamoto": (
        shapes(("ramp", "z")).map(lambda term: {**term, "height": 1.0}), ("tsukamoto",)
    ),
    "interval": (shapes(("triangle", "trapezoid")).map(between), INTERVALS),
    "interval values": (CONSTANTS, INTERVALS),
}  # fmt: skip
"""Consequents and methods of a kind of rule base."""

ALWAYS = {
    # Under a T-norm that leaves single points the evaluators lose these; under another aggregation
    # maxima are searched for, to fewer digits.
    "exact maxima": {"implication": "minimum", "aggregation": "maximum"},
    "tsukamoto": {"aggregation": "maximum"},  # no strength above the height of a set
    "interval": {"and": "product", "implication": "minimum", "aggregation": "maximum"},
    "interval values": {"and": "product", "aggregation": "maximum"},
}


@st.composite
def systems(draw: Draw, kind: str) -> Case:
    """A rule base of one kind."""
    consequents, methods = KINDS[kind]
    names = ("e", "f")[: draw(st.integers(1, 2))]
    terms = shapes(ALL if kind == "curved" else STRAIGHT)
    inputs = {
        name: {"range": [0, 8], "terms": draw(st.fixed_dictionaries(dict.fromkeys("LMH", terms)))}
        for name in names
    }
    if kind.startswith("interval"):
        inputs["e"]["terms"] = {k: between(term) for k, term in inputs["e"]["terms"].items()}
    sampled = {"maxima": True, "curved": True, "sets": None, "interval": None}.get(kind, False)
    chosen = settings_of(
        draw(st.sampled_from(methods)), jumps=kind in {"sets", "maxima", "exact maxima"},
        sampled=draw(st.booleans()) if sampled is None else sampled,
    )  # fmt: skip
    rules = draw(st.lists(st.builds(
        lambda condition, term, weight: {"if": condition, "then": {"u": term}, "weight": weight},
        conditions(names), st.sampled_from("ABC"), st.sampled_from([1.0, 1.0, 0.5, 0.75]),
    ), min_size=1, max_size=5))  # fmt: skip
    if kind == "interval values":  # the evaluators do not fold strengths of one value there
        rules = list({rule["then"]["u"]: rule for rule in rules}.values())
    places = st.integers(-32, 8 * 64 + 32).map(lambda i: i / 64)
    points = st.lists(
        st.fixed_dictionaries(dict.fromkeys(names, places)), min_size=POINTS, max_size=POINTS
    )
    outputs = draw(st.fixed_dictionaries(dict.fromkeys("ABC", consequents)))
    return {
        "inputs": inputs, "outputs": {"u": {"range": [0, 8], "terms": outputs}}, "rules": rules,
        "settings": draw(chosen) | ALWAYS.get(kind, {}),
        "points": [{"inputs": point} for point in draw(points)],
    }  # fmt: skip


def wanted(case: Case, point: Case) -> float | None:
    """Return the number of the exact evaluator, of the other one where sets bend."""
    try:
        found = exact.number(converted(case, Fraction), "u", converted(point, Fraction))
    except NotStraightError:
        again = second.number(converted(case, Decimal), "u", converted(point, Decimal))
        return None if again is None else float(again)
    return None if found is None else float(found)


def in_gap(case: Case, point: Case, right: float) -> float:
    """Return the middle of a gap of samples that parts the halves, whose start is `right`.

    The one choice in which the kernel differs from the evaluators (`differences.json`).
    """
    data = converted(case, Fraction)
    way, (low, high) = data["settings"]["defuzzifier"], data["outputs"]["u"]["range"]
    if way["method"] != "bisector" or way.get("sampling") not in {"endpoints", "trapezoid", "left"}:
        return right
    inputs = converted(point, Fraction)
    if data["settings"]["outside"] == "clamp":
        inputs = {name: min(max(x, low), high) for name, x in inputs.items()}
    cut = [(term, upper) for term, (_, upper) in exact.conclusions(data, "u", inputs)]
    samples = exact.positions(low, high, int(way["samples"]), way["sampling"])
    weights = [(float(x), w * exact.union_at(data, cut, x)) for x, w in samples]
    before = sum(w for x, w in weights if x <= right)
    behind = [(x, w) for x, w in weights if x > right]
    if not before or before != sum(w for _, w in behind) or behind[0][1] > 0:
        return right
    return 0.5 * (right + next(x for x, w in behind if w > 0))


@pytest.mark.slow(seconds=20)
@pytest.mark.parametrize("kind", KINDS)
def test_the_kernel_has_the_numbers_of_the_evaluators(kind: str) -> None:
    @settings(max_examples=cases(12, 400), deadline=None, derandomize=True, database=None,
              phases=[Phase.generate], suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(systems(kind))
    def each(case: Case) -> None:
        parsed = parse(text_of(case))
        assert parsed.rulebase is not None, (text_of(case), parsed.diagnostics)
        engines = compiled(parsed.rulebase), interpreted(parsed.rulebase)
        for point in case["points"]:
            right = wanted(case, point["inputs"])
            if right is not None:
                right = in_gap(case, point["inputs"], right)
            for engine in engines:
                found = float(np.asarray(engine(point["inputs"])["u"]))
                said = (text_of(case), point["inputs"], found, right)
                assert np.isnan(found) == (right is None), said
                assert right is None or abs(found - right) <= CLOSE, said

    each()
