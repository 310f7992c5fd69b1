"""A little of each fuzzer; by hand they run for hours."""

from __future__ import annotations

import damaged_tables
import damaged_texts
import pytest
import random_rule_bases
from fuzzing import search


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fuzzer", "count"), [(damaged_texts, 300), (damaged_tables, 300), (random_rule_bases, 30)],
    ids=["damaged texts", "damaged tables", "random rule bases"],
)  # fmt: skip
def test_nothing_is_found(fuzzer, count):
    found = search(fuzzer.case, seed=0, count=count)
    assert not found, f"{found[0].told}\n{found[0].trace}"


def test_a_finding_has_its_input_and_its_place():
    def case(r, told):
        told.append(f"input {r.randrange(10)}")
        if told[0].endswith("3"):
            raise ZeroDivisionError("planted")

    found = search(case, seed=1, count=100)
    assert {each.told for each in found} == {"input 3"}
    assert {each.sort.split()[0] for each in found} == {"ZeroDivisionError"}
    again = search(case, seed=1, count=1, first=found[-1].number)
    assert again[0].told == "input 3"
