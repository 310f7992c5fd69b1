"""Dead times of actuators: the loop beside a simulation of its own by matrix exponentials."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from fuzzyarm import load_controller, shipped, simulate
from fuzzyarm.control.controllers.text import with_files
from fuzzyarm.control.loop import Options
from fuzzyarm.language import parse
from fuzzyarm.plant import Plant, PlantError, Port, find_plant
from fuzzyarm.plant.plant import with_actuators
from fuzzyarm.proof.check.checking import check_certificate
from fuzzyarm.proof.claim.text import read_claim
from fuzzyarm.proof.loop import margins, prove_loop

PERIOD, STEPS = 0.01, 60
DELAYS = (0.0, 0.01, 0.03, 0.004, 0.0137, 0.0999, 3.0)

A = np.array(
    [[0.0, 1.0, 0.0, 0.0], [-1.0, -0.5, 0.3, 0.0], [0.0, 0.0, 0.0, 1.0], [0.2, 0.0, -2.0, -0.4]]
)
B = np.array([[0.0, 0.0], [1.0, 0.2], [0.0, 0.0], [0.1, 1.5]])
ROWS = np.hstack([A, B]).tolist()
STATES = ("p", "v", "q", "w")
GAINS = np.array([[4.0, 1.0, 0.0, 0.0], [0.0, 0.0, 3.0, 0.5]])
LIMITS, SLEW, STARTS, SET_POINT = (3.0, 2.0), (40.0, math.inf), (0.4, -0.1), (1.0, -0.5)

TEXT = """controller two "state feedback of two masses"
period 10 ms
axis left
  e = error of p
  w = measured v
  drive f = e * 4 - w
axis right
  e = error of q
  w = measured w
  drive f = e * 3 - w * 0.5
"""


class Masses(Plant):
    """Two coupled masses: slow, so that Runge-Kutta steps of a millisecond are exact to 1e-15."""

    name = "masses"
    inputs = {
        "left.f": Port("N", -LIMITS[0], LIMITS[0], SLEW[0], start=STARTS[0]),
        "right.f": Port("N", -LIMITS[1], LIMITS[1], start=STARTS[1]),
    }
    outputs = {
        "left.p": Port("m"), "left.v": Port("m/s", rate_of="p"),
        "right.q": Port("m"), "right.w": Port("m/s", rate_of="q"),
    }  # fmt: skip
    states = dict.fromkeys(STATES, "1")
    longest_step = 0.001

    def derivative(self, t, x, u, p):
        s = [*x, *u]
        return [sum(w * y for w, y in zip(row, s, strict=True)) for row in ROWS]


class Counted(Masses):
    """The same in plain Python: equations that count cannot be traced."""

    def derivative(self, t, x, u, p):
        self.calls = getattr(self, "calls", 0) + 1
        return super().derivative(t, x, u, p)


def by_exponentials(delays, load=0.0):
    """Return the states at the samples: every value acts from its sample plus its dead time on."""
    x, sent, rows = np.zeros(4), [], []
    last = np.array(STARTS)
    for k in range(STEPS):
        rows.append(x)
        wanted = GAINS @ (np.array([SET_POINT[0], 0.0, SET_POINT[1], 0.0]) - x)
        value = np.clip(wanted, -np.array(LIMITS), LIMITS)
        most = np.array(SLEW) * PERIOD
        last = np.clip(value, last - most, last + most)
        sent.append(last)
        instants = sorted(
            {0.0, PERIOD, *(d - PERIOD * math.floor(d / PERIOD + 1e-9) for d in delays)}
        )
        for begin, end in pairwise(instants):
            ages = [math.floor(k + (begin - d) / PERIOD + 1e-6) for d in delays]
            u = [sent[age][j] if age >= 0 else STARTS[j] for j, age in enumerate(ages)]
            u[0] += load
            whole = np.zeros((6, 6))
            whole[:4, :4], whole[:4, 4:] = A, B
            motion = expm(whole * (end - begin))
            x = motion[:4, :4] @ x + motion[:4, 4:] @ np.array(u)
    return np.array(rows)


def controller(text):
    made, faults = with_files(parse(text).controller, Path())
    assert not faults
    return made


def run_of(plant, **options):
    text = controller(TEXT)
    loads = {"left.f": options.pop("load")} if "load" in options else {}
    return simulate(
        text, plant, duration=STEPS * PERIOD, options=Options(loads=loads, **options),
        reference={"left.p": SET_POINT[0], "right.q": SET_POINT[1]},
    )  # fmt: skip


@pytest.mark.parametrize("delays", [*((d, 0.0) for d in DELAYS), (0.0137, 0.004), (0.004, 0.0237)])
@pytest.mark.parametrize("kind", [Masses, Counted])
def test_a_late_value_acts_from_its_instant_on(delays, kind):
    plant = with_actuators(kind(), {}, {"left.f": delays[0], "right.f": delays[1]})
    expected = by_exponentials(delays)
    for compiled in (True, False):
        run = run_of(plant, compiled=compiled)
        found = np.array([run.outputs[name] for name in Masses.outputs]).T
        assert np.abs(found - expected).max() < 1e-12


def test_a_load_is_not_late():
    plant = with_actuators(Masses(), {}, {"left.f": 0.0137})
    found = run_of(plant, load=0.7).outputs["left.p"]
    assert np.abs(found - by_exponentials((0.0137, 0.0), 0.7)[:, 0]).max() < 1e-12


def test_a_run_shows_the_value_that_acts_from_each_sample_on():
    late = [
        run_of(with_actuators(Masses(), {}, {"left.f": d})).drives["left.f"] for d in (0.02, 0.013)
    ]
    assert all((drive[:2] == STARTS[0]).all() and drive[2] != STARTS[0] for drive in late)


def test_a_text_is_a_time_and_a_dead_time_is_of_an_input():
    assert Port("N", delay="30ms").dead_time == Port("N", delay=0.03).dead_time == 0.03
    assert Port("N", delay="30ms") == Port("N", delay=0.03)
    for wrong in ("30", "-1ms", -0.1, math.inf, math.nan, True, None):
        with pytest.raises(PlantError, match="delay"):
            Port("N", delay=wrong)

    class Late(Masses):
        outputs = {**Masses.outputs, "left.p": Port("m", delay="1ms")}

    with pytest.raises(PlantError, match=r"output 'left\.p' has the delay of an actuator"):
        run_of(Late())
    with pytest.raises(PlantError, match="makes its drives itself"):
        with_actuators(find_plant("arm"), {}, {"joint1.voltage": 0.1})


@pytest.mark.parametrize("delay", [0.0, 0.02, 0.0137])
def test_a_sampled_system_has_the_same_bits(delay):
    control = pytest.importorskip("control", reason="python-control is not installed")
    from fuzzyarm.plant.adapters import to_control

    plant = with_actuators(Masses(), {}, {"left.f": delay, "right.f": 0.004})
    system = to_control(plant, PERIOD)
    assert len(system.state_labels) == 4 + 1 + math.ceil(delay / PERIOD - 1e-9) + 1
    start = [0.0] * 4 + [STARTS[0]] + [STARTS[0]] * math.ceil(delay / PERIOD - 1e-9) + [STARTS[1]]
    run = run_of(plant)
    loop = control.interconnect(
        [system, to_control(controller(TEXT))],
        inputs=["reference_left_p", "reference_right_q"],
        outputs=["left_p", "left_v", "right_q", "right_w"],
    )  # fmt: skip
    time = np.arange(STEPS) * PERIOD
    wanted = np.array([np.full(STEPS, value) for value in SET_POINT])
    size = loop.nstates - len(start)
    answer = control.input_output_response(loop, time, wanted, [*start, *[0.0] * size]).outputs
    for row, name in zip(answer, Masses.outputs, strict=True):
        assert np.abs(row - run.outputs[name]).max() == 0.0


def test_a_discrete_system_takes_whole_periods_only():
    control = pytest.importorskip("control", reason="python-control is not installed")
    from fuzzyarm.plant.adapters import ControlPlant

    lag = control.ss([[0.9]], [[0.1]], [[1.0]], 0, PERIOD, inputs="u", outputs="y", name="lag")
    text = controller("controller p\nperiod 10 ms\naxis lag\n  e = error of y\n  drive u = e * 2\n")
    whole = with_actuators(ControlPlant(lag), {}, {"u": 0.02})
    found = simulate(text, whole, reference={"y": 1.0}, duration=0.3).outputs["y"]
    y, line = 0.0, [0.0, 0.0]
    for value in found:
        assert value == pytest.approx(y, abs=1e-15)
        line.append(2.0 * (1.0 - y))
        y = 0.9 * y + 0.1 * line.pop(0)
    with pytest.raises(PlantError, match="is sampled every"):
        simulate(text, with_actuators(ControlPlant(lag), {}, {"u": 0.005}), duration=0.3)


@pytest.mark.parametrize("delay", [0.0, 0.01, 0.0137, 0.045])
def test_the_delay_margin_is_what_a_dead_time_leaves_and_runs_confirm_it(delay):
    late = with_actuators(find_plant("motor"), {}, {"voltage": delay})
    text = controller(
        "controller p\nperiod 10 ms\naxis shaft\n  e = error of position\n  drive voltage = e * 2\n"
    )
    found = margins(text, late)["shaft.voltage"].nominal
    assert found.delay + delay == pytest.approx(
        margins(text, "motor")["shaft.voltage"].nominal.delay, rel=1e-9
    )
    ends = []
    for share in (0.99, 1.01):
        plant = with_actuators(
            find_plant("motor"), {"voltage": Port("V")}, {"voltage": delay + share * found.delay}
        )
        errors = np.abs(
            simulate(text, plant, reference={"position": 0.01}, duration=60.0).errors["position"]
        )
        ends.append(errors[-400:].max() / errors[2000:2400].max())
    assert ends[0] < 1.0 < ends[1]


@pytest.mark.slow
def test_whole_periods_are_states_of_a_proof_and_fractions_are_refused():
    plant = with_actuators(find_plant("motor"), {}, {"voltage": 0.002})
    servo = load_controller(shipped("servo.frb"))
    claim = read_claim("stable on motor", "motor")
    verdict = prove_loop(servo, claim, plant=plant)
    assert verdict.verdict == "proved"
    assert "delay 0.002 s" in verdict.statement
    assert verdict.certificate.delays == {"voltage": 0.002}
    assert check_certificate(verdict.certificate, servo).verdict == "proved"
    # Another dead time is another loop.
    other = replace(verdict.certificate, delays={"voltage": 0.003})
    with pytest.raises(Exception, match="plant"):
        check_certificate(other, servo)
    inside = with_actuators(find_plant("motor"), {}, {"voltage": 0.0025})
    refused = prove_loop(servo, claim, plant=inside)
    assert refused.verdict == "undecided"
    assert "the delay of 'voltage' is 2.5 control periods" in refused.reason
