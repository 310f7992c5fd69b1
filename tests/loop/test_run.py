"""The closed loop: against an independent loop, compiled against interpreted, its faults."""

import math
import subprocess
from pathlib import Path

import needs
import numpy as np
import pytest
from budget import cases

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.control.controllers import CATALOGUE, Controller, controller
from fuzzyarm.control.loop import Options, Sensor, program, simulate
from fuzzyarm.control.loop.loop import LoopBlock
from fuzzyarm.control.loop.many import Bench, Experiment
from fuzzyarm.control.loop.program import RunRecord, loop_for
from fuzzyarm.plant import (
    LOADED,
    PLAIN,
    STUDY_CONVENTIONAL,
    UNLOADED,
    ArmError,
    pick_and_place,
    reach,
    reach_return,
    through,
)
from fuzzyarm.plant.arm import forward_dynamics
from fuzzyarm.symbolic import kernels

INTERPRETED = Options(compiled=False)


@pytest.mark.parametrize("name", ["pd", "fuzzy-lut", "soc-zero", "fuzzy-direct", "cdid"])
def test_a_plant_compiled_into_its_loop_is_the_one_called_by_address(name, monkeypatch):
    followed = reach_return((40, -25), 0.3, 0.2)
    compiled_in = simulate(controller(name), followed, payload=True)
    inner = []

    def is_built(function, arrays, bindings):
        inner.append("plant_kernel" in bindings or "summed_drives" in bindings)
        return not inner[-1] and kernels.is_built(function, arrays, bindings)

    monkeypatch.setattr(program, "is_built", is_built)
    by_address = simulate(controller(name), followed, payload=True)
    assert compiled_in.compiled
    assert by_address.compiled
    assert inner[0]
    for kept in ("outputs", "drives"):
        columns, others = getattr(compiled_in, kept), getattr(by_address, kept)
        assert columns.keys() == others.keys()
        assert all(columns[port].tobytes() == others[port].tobytes() for port in columns)


def straight_loop(segments, kp, kd, ki, whole_run):
    """A PID loop over (start, end, duration, arm), written from the description alone."""
    q, v, total, errors = np.zeros(2), np.zeros(2), np.zeros(2), []
    for begins, ends, duration, arm in segments:
        start, end = np.radians(begins), np.radians(ends)
        t = 0.0
        while t <= duration:
            s = t / duration
            way = end - start
            qd = start + way * (10 * s**3 - 15 * s**4 + 6 * s**5)
            vd = way * (30 * s**2 - 60 * s**3 + 30 * s**4) / duration
            t += 0.003
            for k in range(5):
                e = qd - q
                total = total + e
                torque = kp * e + kd * (vd - v) + ki * total
                if k == 4:
                    errors.append(np.degrees(e))
                    if not whole_run:
                        total = np.zeros(2)
                a = forward_dynamics(arm, q, v, torque)
                v = v + a * 0.0006
                q = q + v * 0.0006 + 0.5 * a * 0.0006**2
    return np.array(errors)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "ki", "whole"), [("pd", 0, False), ("pid", 0.25, True), ("pid-modified", 50, False)]
)
def test_plain_run_equals_an_independent_loop(name, ki, whole):
    segments = [
        ((0, 0), (40, -25), 0.5, UNLOADED),
        ((40, -25), (0, 0), 0.5, LOADED),
        ((0, 0), (0, 0), 0.3, LOADED),
    ]
    want = straight_loop(segments, 100, 50, ki, whole)
    run = simulate(controller(name), reach_return((40, -25), 0.5, 0.3), payload=True)
    assert run.samples == len(want)
    np.testing.assert_allclose(run.error_matrix, want, atol=1e-10)
    np.testing.assert_allclose(run.rms, np.sqrt((want**2).mean(axis=0)), rtol=1e-10)
    np.testing.assert_allclose(run.final, want[-1], atol=1e-10)


@pytest.mark.slow
def test_benchmark_c_loop_gives_the_same_errors(tmp_path):
    needs.need("C compiler")
    compiler = needs.program("C compiler")
    source = Path(__file__).parents[2] / "benchmarks" / "closed_loop.c"
    binary = tmp_path / "loop"
    subprocess.run([compiler, "-O2", str(source), "-o", str(binary), "-lm"], check=True)
    words = subprocess.run([str(binary), "1"], check=True, capture_output=True, text=True).stdout
    run = simulate(controller("cdid"), reach_return(), payload=True)
    np.testing.assert_allclose(run.rms, [float(word) for word in words.split()[1:]], rtol=1e-9)


CASES = [
    pytest.param(name, start, id=f"{name}-{start}")
    for name, entry in CATALOGUE.items()
    for start in (("warm", "cold") if entry.adaptive else ("warm",))
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "start"), CASES)
def test_compiled_equals_interpreted_to_the_last_bit(name, start):
    extras = ({}, {"torque_limits": (30.0, 10.0)}, {"disturbance": 1e-7})
    share = cases(1, 4) / 4  # of the time; interpreted periods are what takes long
    trajectories = (
        reach_return((70, -50), 0.3 * share, 0.1 * share), pick_and_place((30, -60), 0.2 * share)
    )  # fmt: skip
    for way, conventions in enumerate((PLAIN, STUDY_CONVENTIONAL)):
        for more, extra in enumerate(extras):
            # In turn, so that either meets both conventions and all three extras.
            in_turn = trajectories[:: 1 if (way + more) % 2 else -1]
            for trajectory in in_turn[: cases(1, 2)]:
                first, second = (
                    simulate(
                        controller(name, start=start),
                        trajectory,
                        payload=True,
                        conventions=conventions,
                        options=Options(compiled=compiled, **extra),
                    )
                    for compiled in (True, False)
                )
                assert first.compiled
                assert not second.compiled
                np.testing.assert_array_equal(first.error_matrix, second.error_matrix)
                np.testing.assert_array_equal(first.torques, second.torques)
                assert first.memory == second.memory


def test_environment_turns_compilation_off(monkeypatch):
    monkeypatch.setenv("FUZZYARM_NATIVE", "0")
    assert not simulate(controller("pd"), reach(segment=0.05, hold=0.05)).compiled


def test_runs_do_not_remember_each_other():
    made = controller("acdid+ie")
    first, second = (
        simulate(made, reach(segment=0.1, hold=0.1), options=INTERPRETED) for _ in range(2)
    )
    np.testing.assert_array_equal(first.error_matrix, second.error_matrix)


def test_runge_kutta_agrees_with_the_study_integrator_to_first_order():
    path = reach((30.0, -30.0), 0.4, 0.2)
    study = simulate(controller("pd"), path, options=Options(compiled=False))
    fine = simulate(controller("pd"), path, options=Options(compiled=False, runge_kutta=1))
    finer = simulate(controller("pd"), path, options=Options(compiled=False, runge_kutta=3))
    np.testing.assert_allclose(fine.error_matrix, finer.error_matrix, atol=1e-7)
    apart = np.abs(study.error_matrix - finer.error_matrix).max()
    assert 0.0 < apart < 0.02 * np.abs(finer.error_matrix).max()


def test_single_precision_keeps_the_state_single():
    run = simulate(
        controller("pd"),
        reach(segment=0.1, hold=0.1),
        conventions=STUDY_CONVENTIONAL,
        options=INTERPRETED,
    )
    double = simulate(controller("pd"), reach(segment=0.1, hold=0.1), options=INTERPRETED)
    assert (run.torques == run.torques.astype(np.float32)).all()
    assert not (double.torques == double.torques.astype(np.float32)).all()


@pytest.mark.slow
def test_torque_limits_bind_only_when_given():
    path = reach((90.0, -90.0), 0.2)
    free = simulate(controller("cdid"), path, options=INTERPRETED)
    bound = simulate(
        controller("cdid"), path, options=Options(compiled=False, torque_limits=(55.44, 48.51))
    )
    assert np.abs(free.torques).max() > 100
    assert (np.abs(bound.torques) <= [55.44, 48.51]).all()
    assert (np.abs(bound.torques).max(axis=0) == [55.44, 48.51]).all()


@pytest.mark.slow
def test_disturbance_is_repeatable_and_small():
    path = reach((30.0, -30.0), 0.2)
    options = [Options(compiled=False, disturbance=1e-7, seed=seed) for seed in (1, 1, 2)]
    one, again, other = (simulate(controller("pd"), path, options=each) for each in options)
    still = simulate(controller("pd"), path, options=INTERPRETED)
    np.testing.assert_array_equal(one.error_matrix, again.error_matrix)
    assert not np.array_equal(one.error_matrix, other.error_matrix)
    apart = np.abs(one.error_matrix - still.error_matrix).max()
    assert 0 < apart < 1e-3


def test_diverging_run_is_stopped_and_reported():
    made = controller("pid").with_gains({"K_I": [1000.0]})
    run = simulate(made, reach_return(), options=INTERPRETED)
    assert run.diverged is not None
    assert 0.1 < run.diverged < 1.0
    assert 0 < run.samples < 500
    for figures in (run.rms, run.final, run.maximum, run.error_matrix, run.torques):
        assert np.isfinite(figures).all()


def test_controller_that_returns_not_a_number_diverges_at_once():
    class Broken(Controller):
        def torque(self, reference, state, clock):
            return math.nan, 0.0

    run = simulate(Broken(), reach(segment=0.1, hold=0.1))
    assert run.diverged == pytest.approx(0.0006)
    assert run.samples == 0


def test_schedule_that_does_not_fit_is_refused():
    with pytest.raises(ArmError, match="2 sets of parameters does not fit the 3 segments"):
        simulate(controller("pd"), reach_return(), schedule=[vars(UNLOADED), vars(LOADED)])


@pytest.mark.parametrize(
    "options",
    [{"torque_limits": (0.0, 1.0)}, {"torque_limits": (math.nan, 1.0)}, {"runge_kutta": -1}],
)
def test_options_out_of_sense_are_refused(options):
    with pytest.raises(FuzzyarmError, match="out of range"):
        Options(**options)


def test_way_points_run():
    run = simulate(
        controller("cdid"), through([(20.0, 10.0), (5.0, -15.0)], 0.5), options=INTERPRETED
    )
    assert run.samples == 2 * 167
    assert np.abs(run.error_matrix).max() < 0.2
    np.testing.assert_allclose(run.reference[-1], [5.0, -15.0], atol=1e-4)


def test_maximum_counts_as_the_conventions_do():
    path = pick_and_place((45.0, -45.0), 0.4)
    plain = simulate(controller("ct"), path, payload=True, options=INTERPRETED)
    np.testing.assert_array_equal(np.abs(plain.maximum), np.abs(plain.error_matrix).max(axis=0))
    study = simulate(
        controller("ct"), path, payload=True, conventions=STUDY_CONVENTIONAL, options=INTERPRETED
    )
    np.testing.assert_array_equal(study.maximum, study.error_matrix.max(axis=0))


class FromTheFront(np.ndarray):
    """An array that counts from its front only, as machine code takes every index as it is."""

    def __getitem__(self, key):
        ends = (key.start or 0, key.stop or 0) if isinstance(key, slice) else (key,)
        assert min(ends) >= 0
        assert isinstance(key, slice) or key < len(self)
        found = super().__getitem__(key)
        return found if isinstance(found, np.ndarray) else found.item()

    def __setitem__(self, key, value):
        assert 0 <= key < len(self)
        super().__setitem__(key, value)


@pytest.mark.parametrize("name", [*CATALOGUE])
def test_no_kernel_counts_from_the_end_of_an_array(name):
    sensors = {"position": Sensor(noise=1e-5, resolution=1e-6, delay=0.0012)}
    options = Options(compiled=False, sensors=sensors, supply=20.0, interpolate=True)
    way = reach_return(segment=0.006, hold=0.006)
    loop = Bench(Experiment(controller(name), way, options=options), []).loop
    record = RunRecord(loop.course, loop.program.memory, loop.taps)
    loop.program.controller.prepare(loop.arithmetic)
    block = record.block(loop.program)
    run = loop_for(loop.program, loop.course, record)
    run(LoopBlock(*(np.array(each).view(FromTheFront) for each in block)))
