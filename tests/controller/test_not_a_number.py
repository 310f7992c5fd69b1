"""A period in which a value that an axis reads is not a number: the axis skips it."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm import load, shipped, simulate, tune
from fuzzyarm.apps.cli.main import main
from fuzzyarm.control.controllers.catalogue import controller
from fuzzyarm.control.controllers.floats import ReferenceRun
from fuzzyarm.control.controllers.period import PortValue
from fuzzyarm.control.controllers.text import PortError, with_files
from fuzzyarm.control.loop import Options, Sensor
from fuzzyarm.exchange.export.walk_of_steps import steps_of
from fuzzyarm.language import format_text, parse
from fuzzyarm.language.model.controller import EVENTS
from fuzzyarm.plant import Plant, Port
from fuzzyarm.plant.setting import Clock, Reference, State

ENGINES = pytest.mark.parametrize("compiled", [False, True])

SERVO = """controller c
period 10 ms
axis a
  e = error of x
  v = rate of e, filter 0.1 s
  i = integral of e, within -2 .. 2
  d = change of e
  drive u = e + v + i + d, within -50 .. 50, slew 100
"""


def made(text: str):
    parsed = parse(text)
    assert parsed.controller is not None, parsed.diagnostics
    whole, faults = with_files(parsed.controller, Path.cwd())
    assert faults == []
    return whole


def drives(text, values, *, compiled=False, references=None):
    run = made(text).run(compiled=compiled)
    references = [0.0] * len(values) if references is None else references
    found = [
        run.step({"x": value}, {"x": reference})["u"]
        for value, reference in zip(values, references, strict=True)
    ]
    return found, run


@ENGINES
@settings(max_examples=cases(20, 100), deadline=None)
@given(
    values=st.lists(st.one_of(st.just(math.nan), st.floats(-5, 5)), min_size=1, max_size=30),
    lost=st.sampled_from(["measured", "reference"]),
)
def test_a_skipped_period_leaves_no_trace(compiled, values, lost):
    zeros = [0.0] * len(values)
    measured, references = (values, zeros) if lost == "measured" else (zeros, values)
    found, run = drives(SERVO, measured, compiled=compiled, references=references)
    kept = [k for k, value in enumerate(values) if not math.isnan(value)]
    without, _ = drives(
        SERVO, [measured[k] for k in kept], compiled=compiled,
        references=[references[k] for k in kept],
    )  # fmt: skip
    assert [found[k] for k in kept] == without
    assert run.skipped == {"a": len(values) - len(kept)}
    # The drive of a skipped period is that of the last one, before the first 0.
    last = 0.0
    for k, value in enumerate(values):
        assert found[k] == last or k in kept
        last = found[k] if not math.isnan(value) else last


GAP = """rulebase gap
input e -10 .. 10
output u -1 .. 1
term e N: trapezoid -10 -10 -2 -1
term e P: trapezoid 1 2 10 10
term u N: singleton -1
term u P: singleton 1
inference defuzzifier weighted-average
rule if e is N then u is N
rule if e is P then u is P

controller c
period 10 ms
axis a
  e = error of x
  v = rate of e, filter 0.1 s
  before = delayed of e, time 30 ms
  slow = lag of e, time 50 ms
  u = rules gap(e)
  i = integral of u, within -2 .. 2
  s = integral of u, anti-windup back 40 ms
  on = relay of e, width 1, levels 0 .. 1
  drive u = u + v + i + s + before + slow + on, within -5 .. 5, slew 100
  drive w = i, within -2 .. 2, on nan 1.5
"""


@ENGINES
@settings(max_examples=cases(20, 100), deadline=None)
@given(
    values=st.lists(
        st.one_of(st.sampled_from([math.nan, math.inf, -math.inf, 0.0, 0.5]), st.floats(-5, 5)),
        min_size=1, max_size=30,
    )
)  # fmt: skip
def test_a_period_in_which_no_rule_fires_leaves_no_trace(compiled, values):
    text = made(GAP)
    run, without = text.run(compiled=compiled), text.run(compiled=compiled)
    reference = ReferenceRun(text)
    last = {"u": 0.0}
    count = 0
    for value in values:
        found = run.step({"x": -value}, {"x": 0.0})
        given = {PortValue("measured", "a", "x"): -value, PortValue("reference", "a", "x"): 0.0}
        assert {("a", port): drive for port, drive in found.items()} == reference.step(given)
        if not abs(value) > 1.0 or math.isinf(value):
            count += 1
            assert found == {"u": last["u"], "w": 1.5}
        else:
            last = without.step({"x": -value}, {"x": 0.0})
            assert found == last
    assert run.skipped == {"a": count}
    assert all(map(math.isfinite, run.state[1:] if count < len(values) else ()))


@ENGINES
def test_an_integral_of_what_has_no_value_stays(compiled):
    level = GAP.replace("e = error of x", "e = measured x").replace(", anti-windup back 40 ms", "")
    _, run = drives(level, [4.5, 4.5, 0.5, 4.5], compiled=compiled)
    assert run.skipped == {"a": 1}
    assert run.signal("a", "i") == pytest.approx(0.03)
    assert run.signal("a", "s") == pytest.approx(0.03)


@ENGINES
def test_lessons_of_a_skipped_period_are_forgotten(compiled):
    text = load(shipped("soc-table.frb"))
    run, other = text.run(compiled=compiled), text.run(compiled=compiled)
    draw = np.random.default_rng(3)
    ports = list(run.inputs)
    zero = dict.fromkeys(run.references, 0.0)
    # A difference of two infinities is not a number; the second axis goes on with its own values.
    lost = dict.fromkeys(ports, math.inf)
    for k in range(40):
        values = {port: draw.normal() for port in ports}
        if k % 5 == 4:
            run.step(lost, zero | dict.fromkeys(zero, math.inf))
        assert run.step(values, zero) == other.step(values, zero)
    counts = {guard.count for guard in run.program.guards.values()}
    for cell, a, b in zip(run.program.memory(), run.state[1:], other.state[1:], strict=True):
        assert a == b or cell in counts
    assert set(run.skipped.values()) == {8}


@ENGINES
@pytest.mark.parametrize("value", [math.inf, -math.inf])
def test_an_infinity_is_not_remembered(compiled, value):
    found, run = drives(SERVO, [1.0, 2.0, value, 3.0], compiled=compiled)
    without, _ = drives(SERVO, [1.0, 2.0, 3.0], compiled=compiled)
    assert found == [*without[:2], without[1], without[2]]
    assert run.skipped == {"a": 1}


@ENGINES
def test_a_finite_sample_is_remembered_however_large(compiled):
    text = "controller c\nperiod 1 ms\naxis a\n  e = error of x\n  v = rate of e, filter 5 ms\n"
    # A rate without a filter remembers what it is of alone, which is finite.
    plain = text + "  w = rate of v\n  drive u = v + w, within -24 .. 24\n"
    _, run = drives(plain, [0.1, 0.1, 1e303, *[0.1] * 10], compiled=compiled)
    assert run.skipped == {"a": 0}
    text += "  w = rate of v, filter 5 ms\n  drive u = v + w, within -24 .. 24\n"
    for sample, skipped in ((1e300, 0), (1e303, 10), (1.7e308, 1)):
        # A rate of 1e303 is memory; the next one overflows in each later period.
        _, run = drives(text, [0.1, 0.1, sample, *[0.1] * 10], compiled=compiled)
        assert run.skipped == {"a": skipped}


@ENGINES
@pytest.mark.parametrize(
    ("drive", "expected"),
    [
        ("drive u = e", [0.0, -3.0, -3.0]),
        ("drive u = e, within 2 .. 5", [2.0, 2.0, 2.0]),
        ("drive u = e, within -5 .. -2", [-2.0, -3.0, -3.0]),
        ("drive u = e, within -5 .. 5, on nan 4", [4.0, -3.0, 4.0]),
        ("drive u = e, on nan 1\n  drive u = e, on nan 2", [3.0, -6.0, 3.0]),
        ("drive u = e, within 1 .. 5\n  drive u = e, within 2 .. 4", [3.0, 3.0, 3.0]),
    ],
)
def test_what_is_driven_in_a_skipped_period(compiled, drive, expected):
    text = f"controller c\nperiod 10 ms\naxis a\n  e = error of x\n  {drive}\n"
    found, _ = drives(text, [math.nan, 3.0, math.nan], compiled=compiled)
    assert found == expected


@ENGINES
def test_only_the_axis_that_reads_the_value_is_skipped(compiled):
    text = "controller c\nperiod 10 ms\naxis a, b\n  s = sum of error of x\n  drive u = s\n"
    run = made(text).run(compiled=compiled)
    zero = {"a.x": 0.0, "b.x": 0.0}
    run.step({"a.x": -1.0, "b.x": -1.0}, zero)
    assert run.step({"a.x": math.nan, "b.x": -1.0}, zero) == {"a.u": 1.0, "b.u": 2.0}
    assert run.step({"a.x": -1.0, "b.x": -1.0}, zero) == {"a.u": 2.0, "b.u": 3.0}
    assert run.skipped == {"a": 1, "b": 0}
    # A value that no axis reads is nobody's business.
    assert run.step({"a.x": -1.0, "b.x": -1.0}, zero | {"c": math.nan})["a.u"] == 3.0


@ENGINES
def test_an_infinity_is_a_number(compiled):
    text = "controller c\nperiod 10 ms\naxis a\n  e = error of x\n  drive u = e, within -5 .. 5\n"
    found, run = drives(text, [math.inf, -math.inf, 1.0], compiled=compiled)
    assert found == [-5.0, 5.0, -1.0]
    assert run.skipped == {"a": 0}
    two = (
        "controller c\nperiod 10 ms\naxis a\n  m = measured x\n  r = reference x\n"
        "  drive u = m, within -5 .. 5\n  drive v = r, within -5 .. 5\n"
    )
    found, run = drives(two, [math.inf], references=[-math.inf], compiled=compiled)
    assert (found, run.skipped) == ([5.0], {"a": 0})


@ENGINES
def test_the_state_of_a_run_has_the_drives_that_are_held(compiled):
    run = made(SERVO).run(compiled=compiled)
    run.step({"x": -1.0}, {"x": 0.0})
    other = made(SERVO).run(compiled=compiled)
    other.state = run.state
    lost = {"x": math.nan}
    assert other.step(lost, {"x": 0.0}) == run.step(lost, {"x": 0.0}) != {"u": 0.0}
    assert other.skipped == run.skipped == {"a": 1}


@pytest.mark.parametrize("name", ["heater.frb", "servo.frb", "stfc.frb", "soc-table.frb"])
def test_one_sample_does_not_disable_a_shipped_controller(name):
    run = load(shipped(name)).run()
    draw = np.random.default_rng(3)
    for k in range(20):
        values = {port: draw.normal() for port in run.inputs}
        lost = dict.fromkeys(run.inputs, math.nan) if k == 10 else values
        found = run.step(lost, dict.fromkeys(run.references, 0.0))
        assert all(map(math.isfinite, found.values()))
    assert set(run.skipped.values()) == {1}


def test_tables_that_learn_stay_as_they_were():
    run = load(shipped("soc-table.frb")).run()
    draw = np.random.default_rng(3)
    zero = dict.fromkeys(run.references, 0.0)
    for _ in range(20):
        run.step({port: draw.normal() for port in run.inputs}, zero)
    before = run.state
    run.step(dict.fromkeys(run.inputs, math.nan), zero)
    counts = [guard.count for guard in run.program.guards.values()]
    changed = [
        cell
        for cell, a, b in zip(run.program.memory(), before[1:], run.state[1:], strict=True)
        if a != b
    ]
    assert sorted(changed) == sorted(counts)


@pytest.mark.parametrize("name", ["pd", "dac", "mrac", "ct+fuzzy"])
def test_laws_of_the_arm_hold_their_torque(name):
    law = controller(name)
    law.start()
    reference = Reference((0.1, 0.2), (0.0, 0.0), (0.0, 0.0))
    clock = Clock(0.0006, False, False)
    still = State((0.0, 0.1), (0.0, 0.0))
    once = law.torque(reference, still, clock)
    lost = law.torque(reference, State((0.0, math.nan), (0.0, 0.0)), clock)
    if name != "ct+fuzzy":  # the axis of the other joint goes on
        assert lost == once
    assert all(map(math.isfinite, law.torque(reference, still, clock)))


class Failing(Plant):
    """A mass whose sensor fails for a while: no divergence, for its states are finite."""

    inputs = {"u": Port("N", -50, 50)}
    outputs = {"x": Port("m"), "seen": Port("m")}
    states = {"position": "m", "velocity": "m/s"}
    duration = 1.0

    def derivative(self, t, x, u, p):
        return [x[1], u[0]]

    def measure(self, t, x, u, p):
        return [x[0], math.nan if 0.1 <= t < 0.2 else x[0]]


def test_a_run_tells_what_was_skipped(tmp_path):
    text = tmp_path / "c.frb"
    text.write_text(
        "controller c\nperiod 10 ms\naxis a\n  e = error of x\n  m = measured seen\n"
        "  drive u = e - m, within -50 .. 50\n"
    )
    run = simulate(text, plant=Failing(), step=1.0)
    assert (run.skipped, run.lost, run.periods, run.notes) == ({"a": 10}, {}, 100, ())
    (gap,) = run.gaps
    assert gap.startswith("axis a skipped 10 of 100 periods: a value was not a number")
    assert np.isfinite(run.drives["u"]).all()


class Lost(Failing):
    """A mass whose velocity has no finite value after a while."""

    def derivative(self, t, x, u, p):
        return [x[1], math.nan if t >= 0.5 else u[0]]


def test_a_state_that_is_not_a_number_is_a_divergence(tmp_path):
    text = tmp_path / "c.frb"
    text.write_text(
        "controller c\nperiod 10 ms\naxis a\n  e = error of x\n  drive u = e, within -50 .. 50\n"
    )
    run = simulate(text, plant=Lost(), step=1.0)
    assert run.diverged == pytest.approx(0.51, abs=0.02)


def test_the_words_read_back_and_print():
    line = "drive u = e, within -5 .. 5, slew 3, on nan 4, on leaving hold"
    text = f"controller c\nperiod 10 ms\naxis a\n  e = error of x\n  {line}\n"
    model = made(text).model
    assert dict(model.axes[0].lines[-1].events) == {"nan": 4.0, "leaving": "hold"}
    assert line in format_text(text)
    turned = text.replace("slew 3, on nan 4, on leaving hold", "on leaving hold, on nan 4, slew 3")
    assert made(turned).model == model


@pytest.mark.parametrize("event", EVENTS)
def test_a_value_outside_the_limits_is_a_finding(event):
    text = (
        "controller c\nperiod 10 ms\naxis a\n  e = error of x\n"
        f"  drive u = e, within -5 .. 5, on {event} 9\n"
    )
    (finding,) = parse(text).diagnostics
    assert finding.name == "bad-number"
    assert finding.message == f"'on {event}' sends 9, outside the limits of the drive"
    assert finding.hint == f"write  on {event} 5  or wider limits"
    assert not parse(text.replace("9", "hold")).diagnostics
    (finding,) = parse(text.replace(f"on {event} 9", "on 9")).diagnostics
    assert finding.message.startswith("expected 'leaving' or 'nan' after 'on'")
    (finding,) = parse(text.replace("9", "last")).diagnostics
    assert finding.message == f"expected the value sent on {event} or 'hold', found 'last'"


def test_holding_and_leaving_change_no_number(tmp_path):
    runs = []
    for words in ("", ", on nan hold", ", on leaving 3"):
        path = tmp_path / "c.frb"
        path.write_text(
            "controller c\nperiod 10 ms\naxis a\n  e = error of x\n"
            f"  drive u = e * 20, within -50 .. 50{words}\n"
        )
        run = simulate(path, plant=Moving(), step=1.0)
        assert run.skipped == {"a": 10}
        runs.append(run.error_matrix.tobytes())
    assert len(set(runs)) == 1


def test_the_steps_of_an_axis_have_a_guard():
    steps = steps_of(load(shipped("stfc.frb")))
    assert [block.guard.axis for block in steps.blocks] == ["joint1", "joint2"]
    assert [step for block in steps.blocks for step in block.steps] == steps.steps


class Moving(Failing):
    """A mass whose position is lost for a while, and with it the velocity formed of it."""

    outputs = {"x": Port("m"), "v": Port("m/s", rate_of="x")}

    def measure(self, t, x, u, p):
        return [math.nan if 0.1 <= t < 0.2 else x[0], x[1]]


@pytest.mark.parametrize(
    "sensors", [{"x": Sensor(resolution=0.01)}, {"v": Sensor(difference=0.02)}], ids=str
)
@pytest.mark.parametrize("compiled", [False, True])
def test_a_sensor_that_rounds_or_differs_goes_on_after_lost_samples(tmp_path, sensors, compiled):
    text = tmp_path / "c.frb"
    text.write_text(
        "controller c\nperiod 10 ms\naxis a\n  e = error of x\n  m = measured v\n"
        "  drive u = e * 20 - m * 8, within -50 .. 50\n"
    )
    options = Options(sensors=sensors, compiled=compiled)
    run = simulate(text, plant=Moving(), step=1.0, options=options)
    assert (run.skipped, run.lost) == ({"a": 10}, {"x": 10})
    assert run.diverged is None


class Blind(Failing):
    """A mass whose position is lost for a while."""

    def measure(self, t, x, u, p):
        return [math.nan if 0.3 <= t < 0.4 else x[0], x[0]]


def figures_of_known(run):
    """Return errors, their times and the outputs where they are numbers."""
    errors = run.error_matrix[:, 0]
    known = ~np.isnan(errors)
    return errors[known], run.time[known] - run.time[0], (run.reference[:, 0] - errors)[known]


@ENGINES
def test_metrics_are_those_of_the_samples_that_are_numbers(tmp_path, compiled):
    text = tmp_path / "c.frb"
    text.write_text(
        "controller c\nperiod 10 ms\naxis a\n  e = error of x\n  v = rate of e\n"
        "  drive u = e * 50 + v * 3, within -50 .. 50\n"
    )
    options = Options(compiled=compiled)
    run = simulate(text, plant=Blind(), step=1.0, options=options)
    e, t, output = figures_of_known(run)
    assert run.lost == {"x": 10}
    assert len(e) == 90
    (found,) = run.metrics.values()
    expected = {
        "rms": np.sqrt(np.mean(e**2)), "max": e[np.argmax(np.abs(e))], "final": e[-1],
        "rise": t[output >= 0.9][0] - t[output >= 0.1][0], "overshoot": output.max() - 1.0,
        "ise": np.sum(e**2) * 0.01, "iae": np.sum(abs(e)) * 0.01,
        "itae": np.sum(t * abs(e)) * 0.01,
        "rms_periods": np.sqrt(np.mean(e**2)), "rms_path": np.sqrt(np.mean(e**2)),
    }  # fmt: skip
    for name, value in expected.items():
        assert getattr(found, name) == pytest.approx(value, rel=1e-12), name
    assert expected["overshoot"] > 0.05
    last = np.flatnonzero(abs(output - 1.0) > 0.02)[-1]
    assert found.settling == (t[last + 1] if last + 1 < len(t) else None)


class Late(Failing):
    """A mass whose position is unknown at the start."""

    def measure(self, t, x, u, p):
        return [math.nan if t < 0.05 else x[0], x[0]]


class Never(Failing):
    """A mass whose position is never known."""

    def measure(self, t, x, u, p):
        return [math.nan, x[0]]


def test_a_first_sample_may_be_lost_and_all_of_them(tmp_path):
    text = tmp_path / "c.frb"
    text.write_text(
        "controller c\nperiod 10 ms\naxis a\n  e = error of x\n  drive u = e * 50 - 1\n"
    )
    late = simulate(text, plant=Late(), step=1.0)
    assert (late.skipped, late.lost) == ({"a": 5}, {"x": 5})
    assert (late.drives["u"][:6] == [0.0, 0.0, 0.0, 0.0, 0.0, 49.0]).all()
    (found,) = late.metrics.values()
    errors = late.error_matrix[5:, 0]
    assert (found.max, found.final) == (errors[np.abs(errors).argmax()], errors[-1])
    never = simulate(text, plant=Never(), step=1.0)
    assert (never.diverged, never.lost) == (None, {"x": 100})
    (found,) = never.metrics.values()
    numbers = found.to_dict()
    assert {name for name, value in numbers.items() if value is not None} == {
        "effort", "variation", "saturated", "chatter",
    }  # fmt: skip


def test_the_command_tells_what_was_skipped(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("c.frb").write_text(
        "controller c\nperiod 10 ms\naxis a\n  e = error of x\n  drive u = e * 50\n"
    )
    Path("mass.py").write_text(
        "import math\nfrom fuzzyarm.plant import Plant, Port\n\n\nclass Mass(Plant):\n"
        '    inputs = {"u": Port("N")}\n    outputs = {"x": Port("m")}\n'
        '    states = {"x": "m", "v": "m/s"}\n    duration = 1.0\n\n'
        "    def derivative(self, t, x, u, p):\n        return [x[1], u[0]]\n\n"
        "    def measure(self, t, x, u, p):\n"
        "        return [math.nan if 0.3 <= t < 0.4 else x[0]]\n"
    )
    run = ["simulate", "c.frb", "--plant", "mass.py", "--step", "1"]
    assert main(run) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[-2:] == [
        "axis a skipped 10 of 100 periods: a value was not a number, or infinite where it is"
        " remembered",
        "x was not a number in 10 of 100 samples: metrics are those of the others",
    ]
    assert main([*run, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["skipped"], data["periods"], data["lost"]) == ({"a": 10}, 100, {"x": 10})
    assert main(["compare", *run[1:]]) == 0
    assert "c: axis a skipped 10 of 100 periods" in capsys.readouterr().err


@pytest.mark.slow
def test_gains_are_tuned_on_runs_with_lost_samples(tmp_path):
    text = tmp_path / "c.frb"
    text.write_text(
        "controller c\nperiod 10 ms\n"
        "gain K = 5, tune 1 .. 100 log\ngain D = 1, tune 0.1 .. 50 log\n"
        "axis a\n  e = error of x\n  v = rate of e\n  drive u = e * K + v * D\n"
    )
    for cost in ("rms", "itae"):
        tuned = tune(
            text, Blind(), step=1.0, cost=cost, evals=40, unseen=0, linear=False, workers=1
        )
        before, best = tuned.found.trials[0].score.cost, tuned.found.best.score.cost
        assert 0.0 < best < 0.8 * before < math.inf


@ENGINES
@pytest.mark.parametrize("value", [None, "1.0", [1.0], 1j])
def test_a_measured_value_is_a_number(compiled, value):
    run = made(SERVO).run(compiled=compiled)
    with pytest.raises(PortError, match="measured value of 'x' is not a number"):
        run.step({"x": value}, {"x": 0.0})
    with pytest.raises(PortError, match="reference of 'x' is not a number"):
        run.step({"x": 0.0}, {"x": value})
    assert run.step({"x": np.float32(-1.0)}, {"x": 0})["u"] != 0.0  # nothing came of it


class TwoSensors(Plant):
    """A mass with a second output, which no axis reads."""

    name = "two"
    axis = "a"
    inputs = {"u": Port("N", -50.0, 50.0)}
    outputs = {"x": Port("m"), "other": Port("m", bound=math.inf)}
    states = {"x": "m", "v": "m/s"}
    other = 0.0
    duration = 1.0
    longest_step = 0.01

    def derivative(self, t, x, u, p):
        return x[1], u[0] - x[1]

    def measure(self, t, x, u, p):
        return x[0], self.other * x[0]


@pytest.mark.parametrize("factor", [math.nan, math.inf])
def test_a_value_that_no_axis_reads_skips_no_period(factor):
    odd, plain = TwoSensors(), TwoSensors()
    odd.other = factor
    runs = [simulate(made(SERVO), plant, reference={"x": "step:1"}) for plant in (odd, plain)]
    assert runs[0].skipped == runs[1].skipped == {}
    assert (runs[0].drives["u"] == runs[1].drives["u"]).all()
    assert np.ptp(runs[0].drives["u"]) > 0.0
