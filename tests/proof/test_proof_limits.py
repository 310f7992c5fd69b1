"""What is too large is counted before it is listed, and budgets hold."""

import tracemalloc

import numpy as np
import pytest

from fuzzyarm.language import parse
from fuzzyarm.proof.map import Prover, UnprovableError, boxes, pieces, prove
from fuzzyarm.proof.stop import Stop
from fuzzyarm.table import Axis, LookupTable

RULES = """\
rulebase b
{inputs}output y -1 .. 1
terms y: triangles {terms}
inference and {norm}, or max, implication {norm}, aggregation {sums}, defuzzifier centroid exact, \
outside clamp, no-rule 0
{rules}"""


def rules_over(inputs, terms, rules, norm="min", sums="max"):
    """Return a rule base of so many inputs with so many triangles each."""
    names = " ".join(f"T{k}" for k in range(terms))
    lines = "".join(f"input x{i} -1 .. 1\nterms x{i}: triangles {names}\n" for i in range(inputs))
    text = RULES.format(inputs=lines, terms=names, rules=rules, norm=norm, sums=sums)
    rulebase = parse(text).rulebase
    assert rulebase is not None
    return rulebase


def conjunction(inputs, terms=1, word="and"):
    parts = f" {word} ".join(f"x{i} is T{i % terms}" for i in range(inputs))
    return f"rule if {parts} then y is T1\n"


@pytest.mark.parametrize(
    "case",
    [
        (12, 2, conjunction(12)),
        (32, 2, conjunction(32)),
        (3, 2, "rule if " + " and ".join(f"x{i % 3} is T{i % 2}" for i in range(100))
         + " then y is T1\n", "product", "sum"),
    ],
    ids=["12 inputs", "32 inputs", "degree 100"],
)  # fmt: skip
def test_what_is_too_large_is_counted_before_it_is_listed(case):
    tracemalloc.start()
    verdict = prove(rules_over(*case), "y in -0.5 .. 0.5", budget=5.0)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert verdict.verdict == "undecided"
    assert "pieces" in verdict.reason
    assert most < 30_000_000


def test_pieces_and_their_numbers_are_limited(monkeypatch):
    rulebase = rules_over(2, 3, "".join(
        f"rule if x0 is T{i} and x1 is T{j} then y is T{(i + j) % 3}\n"
        for i in range(3) for j in range(3)))  # fmt: skip
    assert prove(rulebase, "y in -1 .. 1").proved
    monkeypatch.setattr(pieces, "MOST_NUMBERS", 100)
    assert "more than" in prove(rulebase, "y in -1 .. 1").reason


@pytest.mark.slow
@pytest.mark.parametrize(
    "case",
    [
        (9, 2, conjunction(9)),
        (1, 700, "".join(f"rule if x0 is T{k} then y is T{k}\n" for k in range(700))),
        (2, 2, "rule if " + " and ".join(f"x{i % 2} is T0" for i in range(40)) + " then y is T1\n",
         "product", "sum"),
    ],
    ids=["many simplices", "many terms", "high degree"],
)  # fmt: skip
def test_the_clock_of_a_proof_is_looked_at_in_every_part(case, monkeypatch):
    """Of time that is measured in looks at the clock none is spent where nobody looks."""
    rulebase, looks = rules_over(*case), []
    monkeypatch.setattr(Stop, "now", property(lambda stop: looks.append(0) or len(looks) > 4))
    assert prove(rulebase, "y in -0.5 .. 0.5", budget=60.0).reason == "time ran out"


@pytest.mark.parametrize(
    ("word", "norm", "sums"),
    [("and", "min", "max"), ("or", "min", "max"), ("and", "product", "sum")],
)
def test_a_rule_of_many_parts_is_no_deeper_than_one_of_few(word, norm, sums):
    parts = f" {word} ".join(f"x{i % 2} is T{i % 3}" for i in range(1500))
    rulebase = rules_over(2, 3, f"rule if {parts} then y is T1\n", norm, sums)
    few = f" {word} ".join(f"x{i % 2} is T{i % 3}" for i in range(6))
    same = rules_over(2, 3, f"rule if {few} then y is T1\n", norm, sums)
    verdict = prove(rulebase, "y in -1 .. 1")
    if norm == "product":
        assert "degree 1500" in verdict.reason
    else:
        assert verdict.proved
        assert verdict.bound == prove(same, "y in -1 .. 1").bound


def test_a_table_of_many_cells_is_counted_before_its_cells_are_boxes(monkeypatch):
    monkeypatch.setattr(boxes, "MOST", 200)
    names = "abc"
    lines = "".join(f"input {n} 0 .. 1\nterms {n}: gaussians L H\n" for n in names)
    rulebase = parse(
        f"rulebase b\n{lines}output y 0 .. 1\nterms y: triangles L H\n"
        "rule if " + " and ".join(f"{n} is L" for n in names) + " then y is H\n"
    ).rulebase
    assert rulebase is not None
    axes = tuple(Axis(n, tuple(k / 7 for k in range(8))) for n in names)
    table = LookupTable(axes=axes, output="y", values=np.zeros((8, 8, 8)))
    with pytest.raises(UnprovableError, match="cells of the table"):
        Prover(rulebase, "y").table(table, "linear")
