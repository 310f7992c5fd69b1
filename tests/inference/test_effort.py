"""How many points are worth it: numbers that are the same on every machine."""

from __future__ import annotations

import pytest

import fuzzyarm
from fuzzyarm.inference.effort import microseconds, points_within
from fuzzyarm.language import parse

HEADS = """rulebase dear
input e -1 .. 1
output u -1 .. 1
terms e: gaussians N Z P
terms u: gaussians N Z P
rule if e is N then u is N
rule if e is Z then u is Z
rule if e is P then u is P
"""


def effort(settings: str) -> float:
    parsed = parse(f"{HEADS}inference {settings}\n")
    assert parsed.rulebase is not None, parsed.diagnostics
    return microseconds(parsed.rulebase)


@pytest.mark.parametrize(
    ("cheap", "dear"),
    [
        ("defuzzifier weighted-average", "defuzzifier centroid(101)"),
        ("defuzzifier centroid(101)", "defuzzifier centroid(1000)"),
        ("defuzzifier centroid(101)", "defuzzifier bisector(101)"),
        ("defuzzifier centroid(101, midpoints)", "defuzzifier centroid(101, joined)"),
        ("defuzzifier mean-of-maximum", "defuzzifier mean-of-maximum, aggregation sum"),
        ("defuzzifier centroid(101)", "defuzzifier centroid"),
    ],
)
def test_what_takes_longer_has_the_larger_number(cheap, dear):
    assert effort(cheap) < effort(dear)


def test_where_points_are_cheap_all_of_them_are_taken():
    pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    assert points_within(pd7, 2.0, least=256, most=160_000) == 160_000
    dear = parse(f"{HEADS}inference defuzzifier mean-of-maximum, aggregation sum\n").rulebase
    assert dear is not None
    assert 256 < points_within(dear, 2.0, least=256, most=160_000) < 20_000
    assert points_within(dear, 1e-6, least=256, most=160_000) == 256
