"""Terms move together: in order, mirrored, as a partition, wherever the numbers go."""

from itertools import pairwise

import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm import load, shipped
from fuzzyarm.language.model.arrangement import cores, mirror_faults, partition_faults
from fuzzyarm.language.model.rulebase import Input, PeakTuning, Shape, Term
from fuzzyarm.learning.tuning.movement import Movement, TuneError

FILES = ("pd7.frb", "pd7-study.frb", "fine7.frb", "thermostat.frb")
VARIABLES = [
    (f"{name} {variable.name}", variable)
    for name in FILES
    for variable in load(shipped(name)).inputs
    if variable.name != "presence"
]
EVEN = PeakTuning(("e",), mirrored=True, ordered=True, partition=True, gap=0.002)
shares = st.lists(st.floats(5e-4, 1 - 5e-4), min_size=12, max_size=12)


def movement(variable, peaks=EVEN, kept=()):
    return Movement(variable, peaks, kept)


@pytest.mark.parametrize("variable", [v for _, v in VARIABLES], ids=[n for n, _ in VARIABLES])
@given(shares, st.sampled_from([None, 4, 3]))
@settings(max_examples=cases(8, 15), deadline=None)
def test_order_images_and_partitions_hold_by_construction(variable, shares, digits):
    moving = movement(variable)
    found = moving.at(shares[: len(moving.names)], digits)
    assert partition_faults(found) == []
    assert list(mirror_faults(found)) == []
    before, after = cores(variable), cores(found)
    assert list(before) == list(after)
    gap = 0.002 * (variable.high - variable.low)
    peaks = [edge for core in after.values() for edge in core]
    slack = gap if digits else 1e-9  # rounding may take a little off
    assert all(b - a >= gap - slack for a, b in pairwise(peaks) if a != b)
    assert all(variable.low <= x <= variable.high for x in peaks)


@pytest.mark.parametrize("variable", [v for _, v in VARIABLES], ids=[n for n, _ in VARIABLES])
@pytest.mark.parametrize("peaks", [EVEN, PeakTuning(("e",), ordered=True), PeakTuning(("e",))])
def test_it_begins_with_the_numbers_of_the_file(variable, peaks):
    moving = movement(variable, peaks)
    for old, new in zip(variable.terms, moving.at(moving.start).terms, strict=True):
        assert new.shape.parameters == pytest.approx(old.shape.parameters, abs=1e-12)


def test_a_foot_half_way_stays_half_way():
    terms = [
        Term("A", Shape("trapezoid", (0.0, 0.0, 1.0, 2.5))),
        Term("B", Shape("triangle", (2.0, 3.0, 4.0))),
        Term("C", Shape("trapezoid", (3.5, 5.0, 6.0, 6.0))),
    ]
    moving = movement(Input("x", 0.0, 6.0, tuple(terms)), PeakTuning(("x",), ordered=True, gap=0))
    assert moving.names == ["A", "B", "C"]
    found = moving.at([0.25, 0.5, 0.5])  # of the way: C at 3, B at 1.5, A at 0.375
    a, b, c = (term.shape.parameters for term in found.terms)
    assert (a[2], b[1], c[1]) == (0.375, 1.5, 3.0)
    assert a[3] == pytest.approx(0.375 + (1.5 - 0.375) * 0.75)
    assert b[0] == pytest.approx(0.375 + (1.5 - 0.375) * 0.5)
    assert c[0] == pytest.approx(1.5 + (3.0 - 1.5) * 0.25)


def test_what_is_kept_stays_and_its_feet_follow_in_a_partition():
    e = load(shipped("pd7.frb")).variable("e")
    found = movement(e, kept=["PM"]).at([0.3])
    known = cores(found)
    assert known["PM"].middle == 4.0
    assert known["NM"].middle == -4.0
    assert known["PS"].middle != 2.0
    assert found.term("PM").shape.parameters[0] == known["PS"].middle
    with_all = movement(e, kept=[""])
    assert with_all.names == []
    assert with_all.at([]).terms == e.terms


def test_values_that_are_free_may_pass_each_other():
    du = load(shipped("roompi.frb")).variable("du")
    moving = movement(du, PeakTuning(("du",), mirrored=True))
    assert moving.names == ["PB", "PM"]
    found = {t.name: t.shape.parameters[0] for t in moving.at([0.6, 0.9]).terms}
    assert found == pytest.approx({"NB": -0.2, "NM": -0.8, "Z": 0.0, "PM": 0.8, "PB": 0.2})


def test_widths_stretch_with_what_is_around_them():
    terms = tuple(
        Term(name, Shape("gaussian", (x, 1.0))) for name, x in (("A", 0.0), ("B", 5.0), ("C", 10.0))
    )
    moving = movement(Input("x", 0.0, 10.0, terms), PeakTuning(("x",), ordered=True, gap=0))
    found = moving.at([0.2])
    assert found.term("B").shape.parameters == pytest.approx((2.0, 1.0))
    assert found.term("A").shape.parameters[1] < 1.0 < found.term("C").shape.parameters[1]


@pytest.mark.parametrize(
    ("peaks", "message"),
    [
        (PeakTuning(("e",), ordered=True, gap=0.4), "do not fit"),
        (PeakTuning(("e",), mirrored=True), "a ramp is not made one"),
    ],
)
def test_what_cannot_be_is_said(peaks, message):
    terms = (
        Term("A", Shape("triangle", (-2.0, 0.0, 2.0))),
        Term("B", Shape("triangle", (1.0, 3.0, 4.0))),
        Term("C", Shape("ramp", (3.0, 5.0))),
    )
    with pytest.raises(TuneError, match=message):
        movement(Input("e", 0.0, 6.0, terms), peaks)


def test_what_is_not_even_is_made_so_first():
    terms = (
        Term("N", Shape("triangle", (-9.0, -6.0, 1.0))),
        Term("Z", Shape("triangle", (-3.0, 0.0, 3.5))),
        Term("P", Shape("triangle", (0.5, 6.0, 9.0))),
    )
    moving = movement(Input("e", -6.0, 6.0, terms), EVEN)
    found = moving.at(moving.start)
    assert partition_faults(found) == []
    assert list(mirror_faults(found)) == []
