"""Axes at rates of their own, signals of other axes, and what was driven: beside plain Python."""

from __future__ import annotations

import math
import random
from pathlib import Path

import numpy as np
import pytest
from own_source import made

from fuzzyarm import load_controller, simulate
from fuzzyarm.apps.show.controller_diff import compare_controllers
from fuzzyarm.control.controllers.floats import ReferenceRun
from fuzzyarm.control.controllers.on_plant import site_of
from fuzzyarm.control.controllers.period import PortValue
from fuzzyarm.control.controllers.reach import reaches_of
from fuzzyarm.exchange.export.controllers import ControllerProgram
from fuzzyarm.language import format_text, parse
from fuzzyarm.language.edit import read
from fuzzyarm.language.edit.references import rename
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import with_actuators
from fuzzyarm.proof.claim.text import read_claim
from fuzzyarm.proof.loop import prove_loop
from fuzzyarm.symbolic.kernels import has_machine_code

EXAMPLES = Path(__file__).parents[2] / "examples" / "controllers"
HEAD = "controller c\nperiod 1 ms\ngain K = 2\n"
SLOW = """axis a every 4
  e    = error of x
  was  = driven u
  ce   = rate of e, filter 5 ms
  late = delayed of e, time 8 ms
  i    = integral of e, within -9 .. 9
  s    = e * K + was * 0.5 + ce * 0.001 + late + i
  drive u = s, within -5 .. 5, slew 900, on nan 1
axis b
  w = driven v
  e = a.s - w
  drive v = e * 0.5, on nan 2
  drive v = a.e * 0.1
axis d every 3
  e = error of y
  drive v = e
"""


def findings(text):
    return [(each.name, each.line) for each in parse(text).diagnostics]


def by_hand(rows):
    """Return the drives of `SLOW`: of a, of b, and of the axis with a port of the same name."""
    before = slope = lates = None
    i = u = slewed = v = z = 0.0
    for k, (x, y) in enumerate(rows):
        if k % 4 == 0:
            e, was = -x, u
            step = 0.0 if before is None else e - before
            slope = (slope or 0.0) + (step / 0.004 - (slope or 0.0)) * (0.004 / 0.009)
            lates = [e, e] if lates is None else lates
            late, lates, before = lates[1], [e, lates[0]], e
            i = min(max(i + e * 0.004, -9.0), 9.0)
            s = e * 2.0 + was * 0.5 + slope * 0.001 + late + i
            limited = min(max(s, -5.0), 5.0)
            u = slewed = min(max(limited, slewed - 3.6), slewed + 3.6)
        v = (s - v) * 0.5 + e * 0.1
        if k % 3 == 0:
            z = -y
        yield u, v, z


def test_each_axis_runs_in_its_turn_and_what_it_gave_is_held():
    rows = np.random.default_rng(4).uniform(-2.0, 2.0, (300, 2)).tolist()
    run = made(HEAD + SLOW).run(compiled=False)
    for (x, y), wanted in zip(rows, by_hand(rows), strict=True):
        sent = run.step({"a.x": x, "d.y": y}, {"a.x": 0.0, "d.y": 0.0})
        assert tuple(sent.values()) == pytest.approx(wanted, abs=1e-12, rel=1e-12)


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("name", ["slow", "cascade-servo", "smith-heater"])
def test_engines_agree_to_the_bit_whatever_they_read(name, single):
    text = made(HEAD + SLOW) if name == "slow" else load_controller(EXAMPLES / f"{name}.frb")
    runs = [text.run(single=single, compiled=how) for how in {False, has_machine_code()}]
    reference, draw = ReferenceRun(text, single=single), random.Random(3)
    axis = text.model.axis_names[0]

    def value():
        odd = draw.random()
        return math.nan if odd < 0.05 else math.inf if odd < 0.07 else draw.uniform(-3.0, 3.0)

    for _ in range(400):
        measured = {name: value() for name in runs[0].inputs}
        wanted = {name: value() for name in runs[0].references}
        given = {
            PortValue(kind, *(port.split(".") if "." in port else (axis, port))): number
            for kind, values in (("measured", measured), ("reference", wanted))
            for port, number in values.items()
        }
        expected = list(reference.step(given).values())
        for run in runs:
            assert list(run.step(measured, wanted).values()) == expected
    assert any(runs[0].skipped.values())


def test_it_goes_on_from_a_state_that_was_kept():
    text = made(HEAD + SLOW)
    run, again = text.run(), text.run()
    rows = np.random.default_rng(5).uniform(-2.0, 2.0, (30, 2)).tolist()
    for x, y in rows[:10]:
        run.step({"a.x": x, "d.y": y}, {"a.x": 0.0, "d.y": 0.0})
    again.state = run.state
    for x, y in rows[10:]:
        given = {"a.x": x, "d.y": y}, {"a.x": 0.0, "d.y": 0.0}
        assert run.step(*given) == again.step(*given)


def rk4(rate, x, time, longest):
    """Return the state after a time; the steps are the largest that fit."""
    count = max(1, math.ceil(time / longest - 1e-9))
    h = time / count
    for _ in range(count):
        a = rate(x)
        b = rate(x + 0.5 * h * a)
        c = rate(x + 0.5 * h * b)
        d = rate(x + h * c)
        x = x + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return x


def servo_by_hand(count):
    """Return position and voltage of the cascade on the motor, without fuzzyarm."""
    J, b, k, R, L = 0.01, 0.02, 0.35, 2.0, 0.004  # noqa: N806 - as the equations have them
    x, load, emf, found = np.zeros(3), 0.0, 0.0, []
    for n in range(count):
        if n % 25 == 0:
            speed = (1.0 - x[0]) * 15.0
        if n % 5 == 0:
            e = speed - x[1]
            load = min(max(load + e * 40.0 * 0.001, -2.0), 2.0)
            amps = e * 2.0 + load
        e = amps - x[2]
        emf = min(max(emf + e * 1000.0 * 0.0002, -24.0), 24.0)
        u = min(max(e * 4.0 + emf, -24.0), 24.0)
        found.append((x[0], u))

        def rate(x, u=u):
            return np.array([x[1], (k * x[2] - b * x[1]) / J, (u - R * x[2] - k * x[1]) / L])

        x = rk4(rate, x, 0.0002, 0.001)
    return np.array(found)


def test_the_cascade_is_that_of_an_independent_simulation():
    text = load_controller(EXAMPLES / "cascade-servo.frb")
    run = simulate(text, find_plant("motor"), reference={"position": "step:1"}, duration=1.0)
    found = servo_by_hand(5000)
    assert np.abs(run.outputs["position"] - found[:, 0]).max() < 1e-12
    assert np.abs(run.drives["voltage"] - found[:, 1]).max() < 1e-12


def heater_by_hand(count):
    """Return temperature and power of the predictor on the room, without fuzzyarm."""
    x, sent, found = np.array([15.0, 15.0]), [0.0] * 20, []
    late, i, excess, quick, slow = None, 0.0, 0.0, None, None
    for _ in range(count):
        u = sent[-1]
        quick = u if quick is None else quick + (u - quick) * 30.0 / (27.4 * 60.0 + 30.0)
        slow = u if slow is None else slow + (u - slow) * 30.0 / (17.3 * 3600.0 + 30.0)
        now = quick * 0.1255 + slow * 0.2335
        late = [now] * 20 if late is None else late
        ahead = 21.0 - x[0] - now + late[-1]
        late = [now, *late[:-1]]
        if not excess / 0.03 * ahead < 0.0:
            i += ahead * 30.0
        wanted = ahead * 30.0 + i * 0.03
        power = min(max(wanted, 0.0), 100.0)
        excess = power - wanted
        found.append((x[0], power))
        heat, sent = sent[-20] * 20.0, [*sent, power]

        def rate(x, heat=heat):
            to_wall = (x[0] - x[1]) / 0.008
            air = (heat - to_wall - (x[0] - 5.0) / 0.05) / 2.5e5
            return np.array([air, (to_wall - (x[1] - 5.0) / 0.02) / 4e6])

        x = rk4(rate, x, 30.0, 60.0)
    return np.array(found)


def test_the_predictor_is_that_of_an_independent_simulation():
    text = load_controller(EXAMPLES / "smith-heater.frb")
    room = with_actuators(find_plant("room"), {}, {"power": 600.0})
    run = simulate(text, room, reference={"temperature": "step:21"}, duration=7200.0)
    found = heater_by_hand(240)
    assert np.abs(run.outputs["temperature"] - found[:, 0]).max() < 1e-12
    late = run.drives["power"][20:]  # as it reaches the room
    assert np.abs(late - found[:-20, 1]).max() < 1e-12


def test_a_predictor_takes_away_what_the_dead_time_does():
    text = load_controller(EXAMPLES / "smith-heater.frb")
    plain = text.source.replace("ahead = e - now + late", "ahead = e - 0 * now + 0 * late")
    room = with_actuators(find_plant("room"), {}, {"power": 600.0})
    step = {"reference": {"temperature": "step:21"}, "duration": 14400.0}
    with_it, without = (simulate(each, room, **step) for each in (text, made(plain)))
    assert max(with_it.outputs["temperature"]) < 21.05
    assert max(without.outputs["temperature"]) > 21.5


# --- Ranges, proofs, findings, the editor ---


def test_ranges_go_from_axis_to_axis_and_round_by_the_drive():
    motor = site_of(find_plant("motor"))
    reaches = reaches_of(load_controller(EXAMPLES / "cascade-servo.frb"), motor).signals
    assert reaches["rotor", "e"].at.high == pytest.approx(15.0 * 4.0 * math.pi + 60.0)
    room = reaches_of(load_controller(EXAMPLES / "smith-heater.frb"), None).signals
    assert tuple(room["room", "sent"].at) == (0.0, 100.0)
    assert tuple(room["room", "quick"].at) == (0.0, 100.0)


def verdict(text, claim, plant="motor"):
    return prove_loop(text, read_claim(claim), plant=find_plant(plant), budget=20.0)


@pytest.mark.slow
def test_a_loop_with_what_was_driven_is_proved():
    lines = "  e = error of position\n  w = measured velocity\n  was = driven voltage\n"
    drive = "  drive voltage = e * 2 - w * 0.2 + was * 0.3, within -24 .. 24\n"
    text = made("controller c\nperiod 1 ms\naxis shaft\n" + lines + drive)
    assert verdict(text, "stable on motor").verdict == "proved"


def test_several_rates_are_refused_by_name():
    text = load_controller(EXAMPLES / "cascade-servo.frb")
    found = verdict(text, "stable on motor")
    assert found.verdict == "undecided"
    assert "the axis 'angle' runs every 25 control periods" in found.reason


def of_axes(first, second="  drive v = a.e\n", every=""):
    return f"{HEAD}axis a{every}\n{first}axis b\n{second}"


ONE = "  e = error of x\n  drive u = e * K\n"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (of_axes(ONE, "  drive v = a.s\n"), ("unknown-signal", 8)),
        (of_axes(ONE, "  e = error of y\n  drive v = b.e\n"), ("signal-before-made", 9)),
        (of_axes(ONE, "  drive v = c.e\n"), ("unknown-signal", 8)),
        (of_axes("  x = driven v\n" + ONE, "  drive v = a.x\n"), ("unknown-signal", 5)),
        (of_axes(ONE, every=" every 2.5"), ("bad-set-point", 4)),
        (of_axes(ONE, every=" every 0"), ("bad-set-point", 4)),
        (of_axes("  l = delayed of e, time 1 ms\n" + ONE, every=" every 2"), ("bad-number", 5)),
        (of_axes("  s = sum of error of x, cleared each set-point\n" + ONE, "  drive v = a.s\n",
                 every=" every 2"), ("bad-set-point", 5)),
    ],
)  # fmt: skip
def test_what_cannot_be_is_a_finding(text, expected):
    assert expected in findings(text)


def test_a_signal_that_only_another_axis_reads_is_read():
    first = "  e = error of x\n  s = e * K\n"
    assert findings(of_axes(first, "  drive v = a.s\n")) == []
    unread = of_axes(f"{first}  t = e\n", "  drive v = a.s\n")
    assert findings(unread) == [("unused-signal", 7)]


def test_the_canonical_text_has_the_rate_and_the_axis():
    first = "axis 'a b'   every 10\n  e = error of x\n  s = e * K\n"
    text = f"{HEAD}{first}axis b\n  drive v='a b'.s*2\n"
    assert "axis 'a b' every 10\n" in format_text(text)
    assert "  drive v = 'a b'.s * 2\n" in format_text(text)
    assert parse(format_text(text)).controller == parse(text).controller


def test_a_signal_and_an_axis_are_renamed_where_others_read_them():
    text = of_axes("  e = error of x\n  s = e * K\n", "  drive v = a.s\n")
    reading = read(text)
    line = text.splitlines().index("  drive v = a.s") + 1
    for column, name, changed in ((13, "outer", "outer.s"), (15, "speed", "a.speed")):
        edits = rename(reading, line, column, name)
        assert len(edits) == 2
        assert (line, name) in {(edit.span.line, edit.text) for edit in edits}
        assert changed.endswith(name) or changed.startswith(name)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@pytest.mark.parametrize("every", [25, 400])
def test_the_self_test_has_a_run_of_the_slowest_axis(precision, every):
    law = "axis a every {}\n  e = error of x * K\naxis b\n  f = error of y\n  drive v = f + a.e\n"
    program = ControllerProgram(made(HEAD + law.format(every)), precision)
    rows = np.array(program.tried.vectors.inputs)
    # In the first period the fast axis has a lost sample, the slow one its numbers.
    inputs = [*program.steps.of_sort("reference"), *program.steps.of_sort("measured")]
    slow = [k for k, variable in enumerate(inputs) if variable.axis == "a"]
    assert np.isfinite(rows[0, slow]).all()
    assert np.isnan(rows[0]).any()
    assert len(rows) > min(every, 100)


def test_a_difference_of_rates_is_a_difference():
    law = "axis a{}\n  e = error of x * K\n  drive v = e\n"
    slow, plain = (made(HEAD + law.format(every)) for every in (" every 4", ""))
    diff = compare_controllers(plain, slow)
    assert not diff.same
    assert [str(change) for change in diff.settings] == ["axis a: every 4"]
