"""Each verb of a statement against rule bases whose truth is known: lines between points.

Triangles at an even distance and numbers as consequents make the output the line through the
numbers; without a rule for one term it has no value at that term's peak. So each statement is true
or false by sums of whole eighths, without inference. A verb without such a truth fails here.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest
from budget import cases

import fuzzyarm
from fuzzyarm.language.model.rulebase import Property
from fuzzyarm.language.statements import VERBS
from fuzzyarm.proof.map import prove

REFERENCE = Path(__file__).parents[2] / "docs" / "reference"
PEAKS = [Fraction(k, 2) - 1 for k in range(5)]
HEAD = "rulebase r\ninput x -1 .. 1\noutput y -8 .. 8\nterms x: triangles A B C D E\n"
END = "inference defuzzifier weighted-average, no-rule error\n"

Numbers = list[Fraction | None]
"""Of each term of x the number that its rule concludes; None: it has no rule."""


def rulebase_of(numbers: Numbers) -> fuzzyarm.RuleBase:
    lines = [f"term y o{k}: singleton {float(v)}\n" for k, v in enumerate(numbers) if v is not None]
    rules = [
        f"rule if x is {'ABCDE'[k]} then y is o{k}\n"
        for k, v in enumerate(numbers)
        if v is not None
    ]
    found = fuzzyarm.parse(HEAD + "".join(lines) + END + "".join(rules)).rulebase
    assert found is not None
    return found


def steps(numbers: Numbers) -> list[Fraction]:
    whole = [v for v in numbers if v is not None]
    return [b - a for a, b in pairwise(whole)]


def slope_claim(numbers: Numbers, draw: random.Random) -> tuple[str, bool]:
    low, high = (2 * end(steps(numbers)) for end in (min, max))
    off = [draw.choice([Fraction(0), Fraction(1, 1024), Fraction(-1, 1024)]) for _ in range(2)]
    a, b = low - off[0], high + off[1]
    if a > b:
        a, b = b, a
    return f"y slope x in {float(a)} .. {float(b)}", a <= low and high <= b


Claim = Callable[[Numbers, random.Random], tuple[str, bool]]

TRUTHS: dict[str, Claim] = {
    "rises": lambda v, _: ("y rises with x", min(steps(v)) >= 0),
    "falls": lambda v, _: ("y falls with x", max(steps(v)) <= 0),
    "slope": slope_claim,
    "odd": lambda v, _: ("y odd", all(a == -b for a, b in zip(v, v[::-1], strict=True))),  # type: ignore[operator]
    "covered": lambda v, _: ("y covered", None not in v),
}
"""By verb, a statement about y(x), and whether it is true."""


def drawn(verb: str, draw: random.Random) -> Numbers:
    """Return numbers for which a statement with the verb is often true, or nearly."""
    numbers: Numbers = sorted(Fraction(draw.randint(-16, 16), 8) for _ in PEAKS)
    if verb == "falls":
        numbers.reverse()
    if verb == "odd":
        half = [Fraction(draw.randint(-16, 16), 8) for _ in range(2)]
        numbers = [*half, Fraction(0), -half[1], -half[0]]
    if draw.random() < 0.5:
        changed = draw.randrange(len(numbers))
        numbers[changed] = (numbers[changed] or Fraction(0)) + Fraction(draw.choice([-1, 1]), 1024)
    if verb == "covered" and draw.random() < 0.5:
        numbers[draw.randrange(len(numbers))] = None
    return numbers


def test_each_verb_has_a_truth() -> None:
    assert set(TRUTHS) == set(VERBS)


@pytest.mark.parametrize("page", ["language", "metrics"])
def test_each_verb_is_on_the_pages(page: str) -> None:
    text = (REFERENCE / f"{page}.md").read_text("utf-8")
    assert [verb for verb in VERBS if not re.search(rf"\bu {verb}\b", text)] == []


def test_the_model_names_each_verb() -> None:
    assert [verb for verb in VERBS if f"``{verb}``" not in (Property.__doc__ or "")] == []


@pytest.mark.parametrize("last", [-5, 5])  # odd and even up to 0.5, and not beyond
@pytest.mark.parametrize("verb", TRUTHS)
def test_a_point_against_it_is_in_the_ranges_or_they_are_refused(verb: str, last: int) -> None:
    half = -2 if last > 0 else 2
    numbers: Numbers = [Fraction(v) for v in (7, 2, 0, half, last)]
    claim, _ = TRUTHS[verb](numbers, random.Random(verb))
    whole = rulebase_of(numbers)
    cut = replace(whole, inputs=(replace(whole.inputs[0], low=-0.5),))
    try:
        verdict = prove(cut, claim)
    except fuzzyarm.RuleBaseError:
        return
    points = [float(x) for line in verdict.evidence for x in re.findall(r"x = (\S+)", line)]
    assert all(-0.5 <= x <= 1.0 for x in points)
    assert points or verdict.proved


@pytest.mark.parametrize("verb", TRUTHS)
def test_what_is_true_is_proved_and_what_is_false_refuted(verb: str) -> None:
    draw, seen = random.Random(verb), set()
    for _ in range(cases(24, 200)):
        numbers = drawn(verb, draw)
        claim, true = TRUTHS[verb](numbers, draw)
        verdict = prove(rulebase_of(numbers), claim).verdict
        assert verdict == ("proved" if true else "refuted"), (numbers, claim)
        seen.add(verdict)
    assert seen == {"proved", "refuted"}
