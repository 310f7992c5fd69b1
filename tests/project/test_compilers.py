"""Processes that compile kernels at the same time as this one."""

import sys
from itertools import chain

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm import compilers, kernels, machine_code
from fuzzyarm.inference.kernel import evaluate, run, sweep
from fuzzyarm.inference.row_functions import _hedged_polyline_row, _polyline_row
from fuzzyarm.kernels import Wanted, address_of, kernel
from fuzzyarm.loop.loop import run_loop
from fuzzyarm.plant.setting import stored_double, stored_single

NAMED = [
    Wanted(evaluate, "f"),
    Wanted(run, "f", inline=True),
    Wanted(sweep, "f"),
    Wanted(run_loop, "fii", (("stored", stored_double),)),
    Wanted(run_loop, "fii", (("stored", stored_single),)),
]


@kernel
def of_a_user(values):
    values[0] = 1.0


@given(st.lists(st.sampled_from([*NAMED, Wanted(of_a_user, "f")]), unique=True), st.integers(1, 9))
def test_each_function_has_one_share_and_what_has_no_name_stays_here(missing, processes):
    own, *others = compilers._shares(missing, processes)
    assert sorted(map(repr, chain(own, *others))) == sorted(map(repr, missing))
    assert len(others) < processes
    assert all(others)
    assert not any(each.function is of_a_user for share in others for each in share)


@pytest.mark.parametrize("wanted", NAMED)
def test_a_function_is_found_by_its_words(wanted):
    assert compilers._from_words(compilers._words(wanted)) == wanted


def need():
    address_of(_hedged_polyline_row, 3, compiled=True)
    address_of(_polyline_row, 3, compiled=True)


@pytest.fixture
def two_kernels(tmp_path, monkeypatch):
    """Have nothing compiled yet; give what is told, and what a helper has made."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(kernels, "_addresses", {})
    told, taken = [], []

    def take(wanted, made):
        taken.append(wanted.function)
        kernels.take_machine_code(wanted, made)

    monkeypatch.setattr(compilers, "take_machine_code", take)
    before = machine_code.watch_compiling(told.append)
    yield told, taken
    machine_code.watch_compiling(before)


def test_what_is_gathered_is_not_compiled(two_kernels):
    with kernels.gathered() as wanted:
        assert address_of(_polyline_row, 3, compiled=True) == 0
        need()
    small, large = Wanted(_polyline_row, "fff"), Wanted(_hedged_polyline_row, "fff")
    assert wanted == [small, large, small]
    assert kernels.to_compile(wanted) == [small, large]
    assert two_kernels[0] == []


@pytest.mark.slow
def test_a_helper_compiles_its_share_and_its_functions_are_told(two_kernels, tmp_path):
    told, taken = two_kernels
    compilers.compile_together(need, processors=2)
    assert taken == [_polyline_row]
    assert len(list(tmp_path.glob("*.code"))) == 2
    names = [each.name for each in told if each is not None]
    assert {"_hedged_polyline_row", "_polyline_row"} <= set(names)
    assert told[-1] is None
    assert told.count(None) == 1
    assert max(each.done for each in told[:-1]) < told[0].total
    told.clear()
    need()
    with compilers.foreseen(lambda: pytest.fail("nothing is to be compiled")):
        need()
    assert told == []


@pytest.mark.slow
@pytest.mark.parametrize("python", ["", "no-python", "python-that-is-not-there", "/bin/false"])
def test_without_a_helper_all_is_compiled_here(two_kernels, tmp_path, monkeypatch, python):
    monkeypatch.setattr(sys, "executable", python)
    _, taken = two_kernels
    compilers.compile_together(need, processors=2)
    assert taken == []
    assert len(list(tmp_path.glob("*.code"))) == 1
