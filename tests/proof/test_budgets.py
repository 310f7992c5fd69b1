"""A budget counts work, so that a busy machine changes no verdict; the clock ends what hangs."""

from __future__ import annotations

import math
import threading
import time
from fractions import Fraction

import pytest

from fuzzyarm import load_controller, load_rulebase, prove, shipped
from fuzzyarm.proof import stop as stop_module
from fuzzyarm.proof.loop import parts
from fuzzyarm.proof.loop.affine import Affine
from fuzzyarm.proof.loop.form_maker import solved
from fuzzyarm.proof.map import Prover
from fuzzyarm.proof.stop import Stop, TimeOverError


def test_waiting_is_no_work() -> None:
    stop = Stop(0.4)
    time.sleep(0.25)  # as if others had the processor
    assert not stop.now
    assert stop.left > 0.2
    begun = time.thread_time()
    while time.thread_time() - begun < 0.42:
        pass
    assert stop.now


def test_the_clock_ends_what_waits_for_long(monkeypatch) -> None:
    monkeypatch.setattr(stop_module, "PATIENCE", 2.0)
    stop = Stop(0.1)
    time.sleep(0.25)
    assert stop.now


def test_in_another_thread_the_clock_counts() -> None:
    stop, found = Stop(0.1), list[bool]()
    time.sleep(0.15)
    thread = threading.Thread(target=lambda: found.append(stop.now))
    thread.start()
    thread.join()
    assert found == [True]


def test_the_rest_of_a_loop_is_sought_within_the_budget() -> None:
    """In rationals: with 250 periods of a delay that took minutes, whatever the budget."""
    rows = [Affine(Fraction(-2), {"x": Fraction(1)}), Affine(Fraction(0), {"y": Fraction(3)})]
    assert solved(rows, ["x", "y"]) == [2, 0]
    with pytest.raises(TimeOverError), Stop(0.0):
        solved(rows, ["x", "y"])


@pytest.mark.parametrize("tolerance", [math.inf, 1e308])
def test_a_tolerance_may_be_any(tolerance: float) -> None:
    pd7 = load_rulebase(shipped("pd7.frb"))
    bounds = Prover(pd7, "u", tolerance=tolerance).steepness({})
    assert bounds.high >= bounds.reached_high > 0.0
    assert prove(pd7, "u slope e in -9 .. 9", tolerance=tolerance).verdict != "refuted"


def test_a_claim_about_a_loop_ends_without_a_budget_of_its_own(monkeypatch) -> None:
    """Of sampled sets, whose pieces took hours."""
    monkeypatch.setattr(parts, "LOOP_BUDGET", 0.2)
    begun = time.process_time()
    text = load_controller("examples/closed_loop/joint-direct.frb")
    verdict = prove(text, "stable on 'examples/closed_loop/loaded_arm.py:HeldJoint'")
    assert verdict.verdict == "undecided"
    assert time.process_time() - begun < 30.0
