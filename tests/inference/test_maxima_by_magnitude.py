"""The maximal position nearest to 0 and that farthest from it, against sums by hand."""

from __future__ import annotations

import random

import numpy as np
import pytest

from fuzzyarm import compiled, infer, prove
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase

METHODS = ("nearest-of-maximum", "farthest-of-maximum")

APART = ((-3.4, -3.0, -1.0, -0.4), (0.2, 0.5, 1.0, 1.6))

Sets = tuple[tuple[float, ...], ...]


def rulebase_of(method: str, sets: Sets, low: float, high: float) -> RuleBase:
    """Every set is cut at the strength that is one of the inputs."""
    inputs = "".join(f"input s{i} 0 .. 1\nterm s{i} on: ramp 0 1\n" for i in range(len(sets)))
    terms = "".join(
        f"term u t{i}: trapezoid {' '.join(map(repr, each))}\n" for i, each in enumerate(sets)
    )
    rules = "".join(f"rule if s{i} is on then u is t{i}\n" for i in range(len(sets)))
    text = f"{inputs}output u {low} .. {high}\n{terms}inference u: defuzzifier {method}\n{rules}"
    found = parse(text)
    assert found.rulebase is not None, found.diagnostics
    return found.rulebase


def values(rulebase: RuleBase, strengths: tuple[float, ...]) -> float:
    """Return the value of a point, which arrays and machine code have as well."""
    point = {f"s{i}": strength for i, strength in enumerate(strengths)}
    value = infer(rulebase, point)["u"]
    columns = {name: np.array([each, each]) for name, each in point.items()}
    for found in (infer(rulebase, columns)["u"], compiled(rulebase)(columns)["u"]):
        assert [each.hex() for each in found.tolist()] == [value.hex()] * 2
    return value


def degree(x: float, a: float, b: float, c: float, d: float) -> float:
    """A trapezoid as the manuals of others write it."""
    return max(0.0, min(1.0, (x - a) / (b - a), (d - x) / (d - c)))


def by_hand(
    method: str, sets: Sets, strengths: tuple[float, ...], low: float, high: float
) -> float:
    """101 samples, the greatest of the cut sets, and the least or the greatest magnitude."""
    samples = [low + (high - low) * i / 100 for i in range(101)]
    heights = [
        max(min(s, degree(x, *each)) for s, each in zip(strengths, sets, strict=True))
        for x in samples
    ]
    top = [x for x, y in zip(samples, heights, strict=True) if y >= max(heights) - 1e-12]
    return min(top, key=abs) if method.startswith("nearest") else max(top, key=abs)


@pytest.mark.parametrize(
    ("sets", "strengths", "way", "wanted"),
    [
        (APART, (0.5, 0.5), "(101)", (0.38, -3.16)),
        (APART, (0.5, 0.5), " exact", (0.35, -3.2)),
        (((-3.9, -3.8, -1.0, -0.5),), (1.0,), " exact", (-1.0, -3.8)),
        (((-1.0, -0.5, 1.0, 2.0),), (1.0,), " exact", (0.0, 1.0)),
        (((-1.0, -0.53, 1.0, 2.0),), (1.0,), "(11)", (0.2, 0.8)),
        (((-4.0, -3.5, -3.0, -2.5), (-2.0, -1.5, -1.0, -0.5), (1.2, 1.5, 1.8, 2.0)),
         (1.0, 1.0, 1.0), " exact", (-1.0, -3.5)),
        # Equally far from 0: the first, which is negative.
        (((-1.6, -1.0, -0.5, -0.25), (0.25, 0.5, 1.0, 1.6)), (1.0, 1.0), " exact", (-0.5, -1.0)),
        (((-1.6, -1.1, -0.4, -0.2), (0.2, 0.4, 1.1, 1.6)), (1.0, 1.0), "(13)", (-0.5, -1.0)),
    ],
)  # fmt: skip
def test_the_end_of_least_or_greatest_magnitude_is_taken(sets, strengths, way, wanted) -> None:
    for method, value in zip(METHODS, wanted, strict=True):
        rulebase = rulebase_of(method + way, sets, -4.0, 2.0)
        assert values(rulebase, strengths) == pytest.approx(value, abs=1e-12), method


def test_a_range_below_0_has_its_upper_end_nearest() -> None:
    found = [rulebase_of(f"{method} exact", ((-10.0, -8.0, -5.0, -1.0),), -10.0, 0.0)
             for method in METHODS]  # fmt: skip
    assert [values(each, (1.0,)) for each in found] == [-5.0, -8.0]


@pytest.mark.parametrize("method", METHODS)
def test_sets_at_random_have_the_sample_that_is_found_by_hand(method: str) -> None:
    draw = random.Random(7)
    for _ in range(40):
        sets = tuple(
            tuple(sorted(draw.uniform(-4.5, 2.5) for _ in range(4)))
            for _ in range(draw.randint(1, 3))
        )
        strengths = tuple(draw.choice((0.25, 0.5, 0.5, 1.0)) for _ in sets)
        rulebase = rulebase_of(f"{method}(101)", sets, -4.0, 2.0)
        wanted = by_hand(method, sets, strengths, -4.0, 2.0)
        assert values(rulebase, strengths) == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("way", [" exact", "(101)", "(10, midpoints)"])
@pytest.mark.parametrize("method", METHODS)
def test_ranges_that_are_proved_are_narrow_and_hold_the_values(method: str, way: str) -> None:
    rulebase = rulebase_of(method + way, ((-1.0, -0.5, 1.0, 2.0),), -4.0, 2.0)
    columns = {"s0": np.linspace(0.4, 0.6, 101)}
    found = np.asarray(infer(rulebase, columns)["u"])
    verdict = prove(rulebase, "s0 in 0.4 .. 0.6 -> u in -2 .. 2", budget=5.0, tolerance=0.01)
    assert verdict.verdict == "proved"
    low, high = verdict.bound
    assert low <= found.min() <= low + 0.2
    assert high - 0.2 <= found.max() <= high
