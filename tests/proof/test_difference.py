"""Proved differences of two rule bases: no point lies outside, and they are attained."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from budget import cases

import fuzzyarm
from fuzzyarm.apps.cli import main
from fuzzyarm.inference.apart import apart
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map import Prover, UnprovableError
from fuzzyarm.proof.map.difference import with_proofs
from tests.fuzz.random_proofs import irregular, points

PD7 = fuzzyarm.shipped("pd7.frb").read_text("utf-8")
SUGENO = """rulebase s
input  a -1 .. 1
input  b -1 .. 1
output y -3 .. 3
terms a, b: triangles N Z P
term y low: linear 0.5*a - 1*b + 0.2
term y high: singleton 1.5
inference {way}defuzzifier weighted-average
rule if a is N and b is Z then y is low
rule if a is P then y is high
rule if b is N then y is high
rule if a is Z and b is not N then y is low
rule if b is P then y is {last}
"""


def made(text: str) -> RuleBase:
    found = parse(text)
    assert found.rulebase is not None, found.diagnostics
    return found.rulebase


def varied(rulebase: RuleBase, draw: random.Random) -> RuleBase:
    """Return a rule base with a term moved and a weight changed."""
    variable = draw.choice(rulebase.inputs)
    terms = list(variable.terms)
    at, by = draw.randrange(len(terms)), draw.uniform(-0.2, 0.2)
    shape = terms[at].shape
    terms[at] = replace(
        terms[at], shape=replace(shape, parameters=tuple(x + by for x in shape.parameters))
    )
    inputs = tuple(
        replace(each, terms=tuple(terms)) if each is variable else each for each in rulebase.inputs
    )
    return replace(rulebase, inputs=inputs)


def require_sound(one: RuleBase, two: RuleBase, draw: random.Random, count: int = 4_000) -> bool:
    """Compare a proof with points; return whether there is one."""
    output = one.outputs[0].name
    first, second = Prover(one, output), Prover(two, two.outputs[0].name)
    try:
        bounds = first.apart(second)
    except UnprovableError:
        return False
    at = points(one, draw, count)
    gap = np.asarray(fuzzyarm.infer(one, at)[output])
    gap = gap - np.asarray(fuzzyarm.infer(two, at)[two.outputs[0].name])
    assert bounds.low <= gap.min() + 1e-9
    assert gap.max() <= bounds.high + 1e-9
    ends = (bounds.reached_low, bounds.at_low), (bounds.reached_high, bounds.at_high)
    for value, place in ends:
        exact = [prover.exactly(place) for prover in (first, second)]
        if None not in exact:
            assert float(exact[0] - exact[1]) == pytest.approx(value, abs=1e-6)
    assert not bounds.complete or bounds.high - bounds.reached_high < 1e-5
    back = second.apart(first)
    assert (-back.high, -back.low) == pytest.approx((bounds.low, bounds.high), abs=1e-6)
    return True


@pytest.mark.parametrize("inputs", [1, 2])
@pytest.mark.parametrize("seed", range(cases(12, 60)))
def test_random_rule_bases_are_apart_by_what_is_proved(seed: int, inputs: int) -> None:
    draw = random.Random(seed)
    one = irregular(draw, inputs)
    require_sound(one, varied(one, draw), draw)


@pytest.mark.slow
def test_most_random_rule_bases_have_such_a_proof() -> None:
    proved = 0
    for seed in range(12):
        draw = random.Random(seed)
        one = irregular(draw, 1)
        covered = replace(one, outputs=tuple(replace(o, no_rule=0.0) for o in one.outputs))
        proved += require_sound(covered, varied(covered, draw), draw, 200)
    assert proved >= 3


@pytest.mark.parametrize("way", ["", "and product, aggregation sum, "])
def test_averages_centroids_and_products_are_compared_with_each_other(way: str) -> None:
    draw = random.Random(3)
    plain = made(SUGENO.format(way="", last="high"))
    other = made(SUGENO.format(way=way, last="low"))
    assert require_sound(plain, other, draw)
    mamdani = made(
        SUGENO.format(way=way, last="high")
        .replace("linear 0.5*a - 1*b + 0.2", "triangle -2 -1 0")
        .replace("singleton 1.5", "triangle 0 1 3")
        .replace("defuzzifier weighted-average", "defuzzifier centroid exact")
        .replace("and product, aggregation sum, ", "")
    )
    assert require_sound(plain, mamdani, draw)


def test_what_is_proved_is_what_was_found() -> None:
    one, two = made(PD7), made(PD7.replace("NB      NB  NB  NB  NM", "NB      NB  NB  NS  NM"))
    (found,) = with_proofs(one, two, apart(one, two))
    assert found.proved is not None
    assert found.worst <= found.proved <= found.worst + 1e-6
    (same,) = with_proofs(one, one, apart(one, one))
    assert (same.worst, same.proved) == (0.0, 0.0)


@pytest.mark.parametrize(
    "change",
    [
        ("centroid exact", "centroid(101, endpoints)"),  # sampled
        ("input  e   -6 .. 6", "input  e   -5 .. 6"),
        ("no-rule error", "no-rule 0"),
    ],
)
def test_what_cannot_be_proved_is_only_searched(change: tuple[str, str]) -> None:
    one, two = made(PD7), made(PD7.replace(*change))
    (found,) = with_proofs(one, two, apart(one, two))
    assert (found.proved is None) == (change[0] != "no-rule error")


def test_inputs_in_another_order_are_only_searched() -> None:
    swapped = made(PD7)
    swapped = replace(swapped, inputs=swapped.inputs[::-1])
    (found,) = with_proofs(made(PD7), swapped, apart(made(PD7), swapped))
    assert found.proved is None


@pytest.mark.slow
def test_the_command_rounds_what_is_proved_away_from_zero(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.frb").write_text(PD7, "utf-8")
    text = PD7.replace("NB      NB  NB  NB  NM", "NB      NB  NB  NS  NM")
    (tmp_path / "b.frb").write_text(text, "utf-8")
    files = [str(tmp_path / name) for name in ("a.frb", "b.frb")]
    assert main(["diff", *files, "--json"]) == 0
    (output,) = json.loads(capsys.readouterr().out)["outputs"]
    assert main(["diff", *files]) == 0
    said = " ".join(capsys.readouterr().out.split())
    number = float(said.split("nowhere over ")[1].split(" (proved)")[0])
    assert number >= output["proved"] > output["worst"]
    assert main(["diff", files[0], files[0]]) == 0
    assert "the same everywhere (proved)" in " ".join(capsys.readouterr().out.split())
