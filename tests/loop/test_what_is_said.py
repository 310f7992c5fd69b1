"""What a run says of itself: when samples were taken, calm, limits, notes; the file of samples."""

import csv
import json
import math

import numpy as np
import pytest

from fuzzyarm import load, shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.control.controllers import controller
from fuzzyarm.control.controllers.catalogue import controller_in
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.loop import Options, Sensor, Signal, simulate, simulate_many
from fuzzyarm.language import read_text
from fuzzyarm.plant import STUDY, Plant, PlantError, Port, find_plant, reach, reach_return
from fuzzyarm.plant.plant import with_actuators

SERVO = read_text(shipped("servo.frb"))
STEP = {"position": Signal("step", (1.0,))}
SHORT = reach_return((20.0, -10.0), segment=0.3, hold=0.1)


def text(*lines, head=("period 1 ms",), axis="shaft"):
    body = ["controller own", *head, f"axis {axis}", *(f"  {line}" for line in lines)]
    return controller_in("\n".join(body) + "\n", "own.frb")


# --- When a sample is taken ---


def test_outputs_are_those_of_their_time():
    """At a reference that stands still set points change nothing but when samples are taken."""
    every = simulate(controller_in(SERVO, "s.frb"), "motor", reference=STEP, duration=0.2)
    fifth = SERVO.replace("period 1 ms", "period 1 ms\nset-point every 5")
    some = simulate(controller_in(fifth, "s.frb"), "motor", reference=STEP, duration=0.2)
    at = np.searchsorted(every.time, some.time - 1e-9)
    assert some.time == pytest.approx(every.time[at])
    assert some.outputs["position"] == pytest.approx(every.outputs["position"][at], abs=1e-12)
    assert some.time - some.set_point_time == pytest.approx(0.004)


def test_times_of_the_arm_go_on_where_those_of_a_trajectory_begin_anew():
    run = simulate("pd-motor", SHORT, conventions=STUDY)
    assert (np.diff(run.time) > 0).all()
    # The last set point of a segment has one period and no sample.
    jumps = np.diff(run.time) / 0.0006
    assert sorted(set(np.round(jumps).astype(int))) == [5, 6]
    assert run.time[0] == pytest.approx(4 * 0.0006)


def test_a_run_is_lost_after_its_last_sample():
    fast = reach((80.0, -20.0), segment=1.0, hold=0.1)
    run = simulate("dac", fast)
    assert run.time[-1] < run.diverged < run.time[-1] + 0.0031


# --- Calm ---


def test_the_first_drive_is_not_a_change():
    run = simulate(load(shipped("servo.frb")), "motor", reference=STEP, duration=2.0)
    changes = np.diff(run.drives["voltage"])
    expected = math.sqrt(np.mean(changes**2))
    assert run.chatter["voltage"] == pytest.approx(expected)
    assert expected == pytest.approx(0.0795, abs=1e-4)
    assert run.metrics["shaft"].chatter == run.chatter["voltage"]
    still = text("e = error of position", "u = e * 0 + 3", "drive voltage = u")
    assert simulate(still, "motor", reference=STEP, duration=0.1).chatter["voltage"] == 0.0


# --- Limits ---


def test_a_drive_at_the_limit_of_its_text_is_saturated():
    for low, high in ((-3, 5), (-0.7, 0.1)):
        held = text("u = error of position * 40", f"drive voltage = u, within {low} .. {high}")
        run = simulate(held, "motor", reference=STEP, duration=0.5)
        drives = run.drives["voltage"]
        expected = np.mean((drives == low) | (drives == high))
        assert run.metrics["shaft"].saturated == expected > 0.1
        assert run.limits["voltage"] == (low, high)


@pytest.mark.parametrize("sign", ["", "-"])
def test_so_is_one_that_is_an_integral_at_its_bound(sign):
    lines = ["e = error of velocity", "i = integral of e, within -2 .. 3"]
    made = text(*lines, f"drive voltage = {sign}i * K / 2", head=("period 1 ms", "gain K = 3"))
    run = simulate(made, "motor", reference={"velocity": Signal("step", (-40.0,))}, duration=0.5)
    ends = (-3.0, 4.5) if not sign else (-4.5, 3.0)
    assert run.limits["voltage"] == pytest.approx(ends)
    drives = run.drives["voltage"]
    expected = np.mean(np.isclose(drives, ends[0]) | np.isclose(drives, ends[1]))
    assert run.metrics["shaft"].saturated == expected > 0.1


def test_limits_of_two_drives_add_up_and_one_without_any_is_free():
    both = ("drive voltage = e, within -1 .. 2", "drive voltage = e * 3, within -2 .. 2")
    free = ("drive voltage = e, within -1 .. 2", "drive voltage = e * 3")
    expected = {both: (-3.0, 4.0), free: (-24.0, 24.0)}
    for lines, limits in expected.items():
        run = simulate(text("e = error of position", *lines), "motor", duration=0.05)
        assert run.limits["voltage"] == limits


@pytest.mark.parametrize("conventions", ["plain", "study"])
def test_on_the_arm_the_supply_in_the_text_counts(conventions, capsys):
    words = ["simulate", "pd-motor", "--angles", "80", "-20", "--segment", "1", "--json"]
    assert main([*words, "--conventions", conventions]) == 0
    assert '"saturated": 0.1' in capsys.readouterr().out


def test_limits_of_the_arm_and_its_motors_count():
    for options, port, limit in (
        (Options(torque_limits=(5.0, math.inf)), "joint1.torque", 5.0),
        (Options(supply=3.0), "joint1.voltage", 3.0),
    ):
        run = simulate("pd", SHORT, options=options)
        drives = np.abs(run.drives[port])
        assert run.limits[port] == (-limit, limit)
        at_limit = np.mean(drives >= limit * (1 - 1e-9))
        assert run.metrics["joint1"].saturated == pytest.approx(at_limit)
        assert at_limit > 0.05


def test_a_sum_has_the_limits_of_its_addends():
    run = simulate(controller("pd-motor") + controller("pd"), SHORT)
    assert run.limits["joint1.voltage"] == (-20.0, 20.0)
    assert run.limits["joint1.torque"] == (-math.inf, math.inf)


# --- What is joined, and what is refused ---


def test_an_axis_is_joined_as_a_whole(capsys):
    path = reach((30.0, 0.0), segment=0.5, hold=0.5)
    run = simulate(load(shipped("servo.frb")), path, connect={"shaft": "joint1"})
    assert abs(run.final[0]) < 5.0
    assert np.abs(run.drives["joint1.voltage"]).max() > 1.0
    assert not run.drives["joint2.voltage"].any()
    assert run.notes == ("nothing drives joint2",)
    by_port = {"position": "joint1.position", "velocity": "joint1.velocity"}
    same = simulate(
        load(shipped("servo.frb")), path, connect={**by_port, "voltage": "joint1.voltage"}
    )
    assert (same.error_matrix == run.error_matrix).all()
    words = ["simulate", str(shipped("servo.frb")), "--connect", "shaft=joint2", "--hold", "0.1"]
    assert main(words) == 0
    assert "note: nothing drives joint1" in capsys.readouterr().err
    assert (
        main(["check", str(shipped("servo.frb")), "--plant", "arm", "--connect", "shaft=joint1"])
        == 0
    )
    with pytest.raises(SourceError, match="no axis 'shaft'"):
        simulate(load(shipped("servo.frb")), path, connect={"shaft": "joint3"})


def test_a_name_that_joins_nothing_is_said():
    run = simulate(
        load(shipped("servo.frb")), "motor", duration=0.05, connect={"speed": "velocity"}
    )
    assert run.notes == (
        "nothing in servo is called 'speed': --connect speed=velocity has no effect",
    )
    assert simulate(load(shipped("servo.frb")), "motor", duration=0.05).notes == ()


def test_what_the_arm_would_ignore_is_refused(capsys):
    arm = find_plant("arm")
    with pytest.raises(PlantError, match="makes its drives itself"):
        with_actuators(arm, {"joint1.voltage": Port(low=-5, high=5)})
    for words in (["--actuator", "voltage=-5..5"], ["--disturb", "joint1.voltage=step:5"]):
        assert main(["simulate", "pd-motor", *words]) == 1
    assert capsys.readouterr().err.count("\n") == 2
    pushed = Options(loads={"joint1.torque": Signal("step", (5.0,))})
    assert simulate("pd", SHORT, options=pushed).rms[0] != simulate("pd", SHORT).rms[0]


def test_a_delay_between_two_periods_is_said_by_the_command(capsys):
    words = ["--plant", "motor", "--for", "50ms", "--sensor-delay", "position=2.5ms"]
    assert main(["simulate", str(shipped("servo.frb")), *words]) == 0
    said = "the delay of 'position' is 2.5 control periods of 0.001 s: 3 are taken, 0.003 s"
    assert said in capsys.readouterr().err
    assert main(["sweep", str(shipped("servo.frb")), *words, "--random", "2"]) == 0
    assert said in capsys.readouterr().err
    options = Options(sensors={"position": Sensor(delay=0.003)})
    assert simulate(load(shipped("servo.frb")), "motor", options=options, duration=0.05).notes == ()


# --- The file ---


def heads_of(path):
    with path.open(encoding="utf-8") as file:
        rows = [row for row in csv.reader(file) if not row[0].startswith("#")]
    return rows[0], np.array([[float(cell or "nan") for cell in row] for row in rows[1:]])


def test_the_file_of_samples_has_units_and_both_times(tmp_path, capsys):
    file = tmp_path / "run.csv"
    words = ["--segment", "0.2", "--hold", "0.1", "--csv", str(file)]
    assert main(["simulate", "pd-motor", *words]) == 0
    heads, rows = heads_of(file)
    assert heads[:4] == [
        "time [s]", "set point time [s]", "joint1.position wanted [rad]",
        "joint2.position wanted [rad]",
    ]  # fmt: skip
    assert heads[-2:] == ["joint1.voltage [V]", "joint2.voltage [V]"]
    assert all(head.endswith("]") for head in heads)
    run = simulate("pd-motor", reach_return(segment=0.2, hold=0.1))
    assert rows[:, 0] == pytest.approx(run.time)
    assert rows[:, 1] == pytest.approx(run.set_point_time)
    assert main(["simulate", str(shipped("servo.frb")), "--plant", "motor", "--for", "10ms",
                 "--csv", str(file)]) == 0  # fmt: skip
    assert heads_of(file)[0] == [
        "time [s]", "position wanted [rad]", "position [rad]", "velocity [rad/s]", "current [A]",
        "voltage [V]",
    ]  # fmt: skip


def test_the_file_of_a_sweep_says_its_units(tmp_path):
    file = tmp_path / "sweep.csv"
    words = ["--segment", "0.2", "--hold", "0.1", "-o", str(file), "--sweep", "payload=0..1:2"]
    more = ["--sweep", "G_e=100..200:2", "--sweep", "delay.joint1.position=0..0.0006:2"]
    assert main(["sweep", "fuzzy-lut", *words, *more]) == 0
    heads, rows = heads_of(file)
    assert len(rows) == 8
    units = json.loads(file.read_text("utf-8").splitlines()[1].removeprefix("# "))["units"]
    assert set(units) <= set(heads)
    assert set(heads) - set(units) == {
        "run", "payload", "seed", *(f"joint{joint}.{name}" for joint in (1, 2)
                                    for name in ("saturated", "effort", "variation")),
    }  # fmt: skip
    expected = {
        "G_e": "1/rad", "delay.joint1.position": "s", "diverged": "s", "joint1.rms": "degrees",
        "joint2.rms_path": "degrees", "joint1.chatter": "N m", "joint1.ise": "degrees^2 s",
    }  # fmt: skip
    assert units | expected == units
    assert main(["sweep", "fuzzy-lut", *words, *more, "--resume"]) == 0
    assert len(heads_of(file)[1]) == 8


def test_metrics_of_sweeps_stand_beside_each_other():
    many = simulate_many("pd-motor", SHORT, [{}, {"payload": 1.0}])
    run = simulate("pd-motor", SHORT)
    assert many["rms_periods"][0] == pytest.approx(run.rms_periods)
    assert many["rms_path"][0] == pytest.approx(run.rms_path)
    assert (many["rms_path"][1] != many["rms_path"][0]).all()


@pytest.mark.parametrize(("step", "said"), [(6.0, None), (7.0, "7"), (-7.0, "-7")])
def test_a_set_point_that_no_sensor_can_say_is_noted(step, said):
    references = {"position": Signal("step", (step,))}
    run = simulate(shipped("servo.frb"), "motor", reference=references, duration=0.01)
    words = f"the set point {said} rad of 'position' is beyond its range, -6.28319 .. 6.28319"
    assert run.notes == (() if said is None else (words,))


def test_a_run_that_diverges_says_of_what(tmp_path, capsys):
    class Rooted(Plant):
        name = "rooted"
        inputs = {"voltage": Port("V", -24.0, 24.0)}
        outputs = {"position": Port("rad", bound=50.0)}
        states = {"position": "rad"}

        def derivative(self, t, x, u, p):
            return [1e3 * u[0] if x[0] < self.end else math.nan]

    asked = {"reference": STEP, "duration": 0.2}
    wild = text("e = error of position", "drive voltage = e * 1000")
    plant = Rooted()
    plant.end = 0.5
    assert simulate(wild, plant, **asked).cause == "an output, position, that is not a number"
    plant.end = math.inf
    away = text("e = measured position", "r = reference position", "drive voltage = e * 1000 - r")
    assert "position at -" in simulate(away, plant, **asked).cause
    assert "beyond its bound of 50" in simulate(away, plant, **asked).cause
    holes = """
rulebase holes
input e -1 .. 1
output u -1 .. 1
terms e, u: triangles N Z P
inference no-rule error
rule if e is N then u is N

controller own
period 1 ms
axis shaft
  e = error of position
  u = rules holes(e)
  drive voltage = u
"""
    run = simulate(controller_in(holes, "own.frb"), plant, **asked)
    # Where no rule fires the period is skipped: the drive stays, and nothing diverges.
    assert (run.cause, run.skipped) == ("", {"shaft": run.periods})
    assert (
        simulate(text("e = error of position", "drive voltage = e"), "motor", **asked).cause == ""
    )
