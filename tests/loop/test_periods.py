"""The period and the set points of a text hold on the arm; errors between and beside set points."""

import json
import math

import numpy as np
import pytest
from arm_oracle import EMPTY, LOADED, rms_of

from fuzzyarm import load, shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.apps.study.comparison import compare
from fuzzyarm.apps.study.cost import count_operations, measure_time
from fuzzyarm.control.controllers import controller
from fuzzyarm.control.controllers.catalogue import controller_in
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.on_plant import SITE_OF_LAWS, timing_on
from fuzzyarm.control.loop import Options, Sensor, Signal, simulate, simulate_many
from fuzzyarm.control.loop.along import trajectory_motion
from fuzzyarm.language import read_text
from fuzzyarm.plant import PLAIN, STUDY, Arm, reach_return, through
from fuzzyarm.plant.setting import STUDY_TIMING

PD = read_text(shipped("pd-motor.frb"))
MOVES = reach_return((50.0, -40.0), segment=0.901, hold=0.301)


def timed(period, every=None, gains=(100, 16), source=PD):
    """Return the linear PD on the motors at another period, with other gains."""
    text = source.replace("period 0.6 ms", f"period {period}")
    line = "" if every is None else f"set-point every {every}"
    text = text.replace("set-point every 5", line)
    text = text.replace("K_p       = 100", f"K_p       = {gains[0]}")
    return text.replace("K_d       = 16", f"K_d       = {gains[1]}")


def law_of(gains):
    def law(error, rate):
        control = gains[0] * error * 1080 / math.pi + gains[1] * rate * 10.8 / math.pi
        return min(max(control * 20 / 6, -20.0), 20.0)

    return law


def moves_of(path, *, payload):
    turns = [
        ([math.radians(a) for a in each.start], [math.radians(a) for a in each.end], each.duration)
        for each in path.segments
    ]
    heavy = [payload and loaded for loaded in path.loaded]
    return [(*turn, LOADED if each else EMPTY) for turn, each in zip(turns, heavy, strict=True)]


@pytest.mark.parametrize(
    ("period", "seconds", "every", "gains"),
    [
        ("0.6 ms", 0.0006, 5, (100, 16)),
        ("0.6 ms", 0.0006, 2, (20, 4)),
        ("0.2 ms", 0.0002, 7, (20, 4)),
        ("4 ms", 0.004, 1, (4, 3)),
        ("10 ms", 0.01, 3, (2, 2)),
    ],
)
def test_the_arm_runs_at_the_period_of_the_text(period, seconds, every, gains):
    run = simulate(controller_in(timed(period, every, gains), "t.frb"), MOVES, payload=True)
    expected = rms_of(moves_of(MOVES, payload=True), law_of(gains), seconds, every)
    for found, oracle in zip((run.rms, run.rms_periods, run.rms_path), expected, strict=True):
        assert found == pytest.approx(oracle, rel=1e-6)
    assert run.period == pytest.approx(seconds * every)
    assert np.diff(run.time) == pytest.approx(seconds * every)


def test_a_slow_controller_is_as_bad_as_it_is():
    """At 20 ms these gains only swing between both ends of the supply."""
    slow = simulate(controller_in(timed("20 ms", 5), "t.frb"), reach_return(), payload=True)
    fast = simulate(controller_in(PD, "t.frb"), reach_return(), payload=True)
    assert (slow.rms > 1.2).all()
    assert (slow.rms < 3.0).all()
    assert fast.rms == pytest.approx([0.0179, 0.0127], abs=1e-4)
    assert slow.metrics["joint1"].saturated > 0.5


def test_a_fine_integrator_agrees_at_a_long_period():
    made = controller_in(timed("4 ms", 1, (4, 3)), "t.frb")
    coarse, fine = (
        simulate(made, MOVES, options=Options(runge_kutta=parts)).rms for parts in (0, 40)
    )
    assert coarse == pytest.approx(fine, rel=2e-3)


@pytest.mark.parametrize("options", [Options(inductance=1e-7), Options(supply=1e6)])
def test_motors_with_next_to_no_inductance_agree_at_a_long_period(options):
    made = controller_in(timed("4 ms", 1, (4, 3)), "t.frb")
    assert simulate(made, MOVES, options=options).rms == pytest.approx(
        simulate(made, MOVES).rms, rel=1e-6
    )


def test_a_load_acts_for_the_whole_of_a_long_period():
    push = Options(loads={"joint1.torque": Signal("step", (8.0,))})
    # A torque of 8 N m is worth 8 R / (k N) volts at the motor.
    volts = 8.0 * 2.32 / (0.066 * 80)
    text = timed("4 ms", 1, (4, 3))
    head, _, _ = text.partition("  drive voltage")
    joints = (
        head.replace("axis joint1, joint2", "axis joint1")
        + f"  drive voltage = u * supply / converter + {volts}\n"
    )
    joints += head[head.index("axis joint1, joint2") :].replace(
        "axis joint1, joint2", "axis joint2"
    )
    joints += "  drive voltage = u * supply / converter\n"
    free = timed("4 ms", 1, (4, 3)).replace(", within -20 .. 20", "")
    pushed = simulate(controller_in(free, "t.frb"), MOVES, options=push)
    asked = simulate(controller_in(joints, "t.frb"), MOVES)
    assert pushed.rms == pytest.approx(asked.rms, rel=1e-9)


def test_the_timing_of_the_study_is_that_of_its_texts_to_the_bit():
    timing = timing_on(controller("pd-motor"), SITE_OF_LAWS)
    assert timing == STUDY_TIMING == timing_on(controller("pd"), SITE_OF_LAWS)
    assert timing.period == 0.003 / 5
    for conventions in (PLAIN, STUDY):
        own, default = (
            trajectory_motion(Arm(), MOVES, law, conventions, payload=True)
            for law in (controller("stfc"), controller("pd"))
        )
        assert (own.period, own.step) == (default.period, default.step)
        assert (own.references == default.references).all()


def test_texts_of_different_periods_do_not_add_up():
    both = controller_in(PD, "t.frb") + controller_in(timed("1 ms", 5), "t.frb")
    with pytest.raises(SourceError, match=r"cannot be added: a period of 0\.0006 s .* 0\.001 s"):
        simulate(both, MOVES)
    shaft = load(shipped("servo.frb"))
    slower = controller_in(
        read_text(shipped("servo.frb")).replace("period 1 ms", "period 2 ms"), "t.frb"
    )
    with pytest.raises(SourceError, match="cannot be added"):
        simulate(controller_in(shaft.source, "t.frb") + slower, "motor")
    # A law has no period of its own.
    assert simulate(controller("pd") + controller("pd-motor"), MOVES).samples


def test_set_points_for_another_period_are_refused():
    made = trajectory_motion(Arm(), MOVES)
    with pytest.raises(SourceError, match=r"runs every 0\.001 s .* set points are for 0\.0006 s"):
        simulate(controller_in(timed("1 ms", 5), "t.frb"), made)


def test_every_way_to_run_takes_the_period():
    text = timed("10 ms", 3, (2, 2))
    made = controller_in(text, "t.frb")
    one = simulate(made, MOVES, payload=True)
    many = simulate_many(made, MOVES, [{}], payload=True)
    assert many.rms[0] == pytest.approx(one.rms)
    assert many["rms_path"][0] == pytest.approx(one.rms_path)


def test_compared_and_counted_at_the_period(tmp_path):
    file = tmp_path / "slow.frb"
    file.write_text(timed("10 ms", 3, (2, 2)))
    (found,) = compare([str(file)], trajectories=[MOVES] * 2)
    run = simulate(str(file), MOVES, payload=True)
    assert found.rms == (*run.rms, *run.rms)
    assert found.rms_periods == (*run.rms_periods, *run.rms_periods)
    assert found.rms_path == (*run.rms_path, *run.rms_path)
    # A step costs what it costs, however often it is taken.
    fast = count_operations(controller("pd-motor"), through([(5.0, -5.0)], segment=0.3))
    slow = count_operations(
        controller_in(timed("10 ms", 1), "t.frb"), through([(5.0, -5.0)], segment=0.3)
    )
    assert slow.arithmetic == fast.arithmetic
    assert measure_time(controller_in(timed("10 ms", 1), "t.frb"), rounds=2) < 1e-4


# --- Errors in all periods and from the path ---


def test_where_every_period_has_a_set_point_the_three_are_one():
    run = simulate(
        load(shipped("servo.frb")),
        "motor",
        reference={"position": Signal("sine", (1.0, 2.0))},
        duration=0.5,
    )
    assert run.rms_periods == pytest.approx(run.rms, rel=1e-12)
    assert run.rms_path == pytest.approx(run.rms, rel=1e-12)


def test_of_any_plant_the_path_is_the_reference():
    """A shaft that stands still: errors are those of the reference alone, at each period."""
    head = "controller still\nperiod 1 ms\nset-point every 4\naxis shaft\n"
    still = head + "  u = error of position * 0\n  drive voltage = u\n"
    slope = {"position": Signal("ramp", (2.0,))}
    run = simulate(controller_in(still, "s.frb"), "motor", reference=slope, duration=0.4)
    ticks = np.arange(400) * 0.001
    held = np.repeat(2.0 * ticks[::4], 4)
    degrees = {"rms": held[3::4], "rms_periods": held, "rms_path": 2.0 * ticks}
    for name, errors in degrees.items():
        expected = np.degrees(np.sqrt(np.mean(errors**2)))
        assert getattr(run, name) == pytest.approx([expected], rel=1e-12), name
    assert run.time == pytest.approx(ticks[3::4])
    assert run.set_point_time == pytest.approx(ticks[::4])


def test_a_filter_of_set_points_is_late_between_them():
    run = simulate("fuzzy-smooth", reach_return(), payload=True)
    assert run.rms == pytest.approx([0.0005, 0.0002], abs=5e-5)
    assert run.rms_periods == pytest.approx([0.0257, 0.0258], abs=5e-5)
    assert run.rms_path == pytest.approx([0.0421, 0.0422], abs=5e-5)
    line = simulate("pd-motor", reach_return(), payload=True)
    assert (line.rms_path < run.rms_path).all()
    assert (line.rms_periods < run.rms_periods).all()


def test_led_set_points_lie_on_the_path():
    run = simulate("pd-motor", reach_return(), payload=True, options=Options(interpolate=True))
    assert run.rms_periods == pytest.approx(run.rms_path, rel=2e-3)


def test_runs_in_parts_have_the_errors_of_whole_ones():
    from fuzzyarm.control.loop.run import ClosedLoop

    motion = trajectory_motion(Arm(), MOVES)
    loop = ClosedLoop(controller("pd-motor"), motion)
    whole = loop.run()
    parts = loop.open()
    for until in (1, 40, 41, 300):
        parts.advance(until)
    parts.advance()
    pieced = loop.answer(parts)
    assert (pieced.rms_periods == whole.rms_periods).all()
    assert (pieced.rms_path == whole.rms_path).all()
    assert pieced.chatter == whole.chatter
    assert np.isnan(loop.answer(loop.open()).rms_path).all()


def test_the_command_says_all_three(capsys):
    words = ["simulate", "fuzzy-smooth", "--segment", "0.5", "--hold", "0.2"]
    assert main(words) == 0
    lines = [line[:16].strip() for line in capsys.readouterr().out.splitlines()[2:]]
    assert lines == ["rms", "all periods", "path", "max", "final"]
    assert main(["simulate", str(shipped("servo.frb")), "--plant", "motor", "--for", "100ms"]) == 0
    assert "path" not in capsys.readouterr().out


# --- The command ---


@pytest.mark.parametrize(
    ("name", "words", "keywords"),
    [
        ("stfc", ["--segment", "0.3", "--hold", "0.1"], {"trajectory": True}),
        ("servo", ["--plant", "motor", "--for", "0.2s"], {"plant": "motor", "duration": 0.2}),
        (
            "tanks", ["--plant", "tanks", "--for", "30s", "--noise", "level2=0.01"],
            {"plant": "tanks", "duration": 30.0,
             "options": Options(sensors={"level2": Sensor(noise=0.01)})},
        ),
    ],
)  # fmt: skip
def test_the_command_prints_the_metrics_of_the_run_in_python(name, words, keywords, capsys):
    given = dict(keywords)
    if given.pop("trajectory", False):
        given["plant"] = reach_return(segment=0.3, hold=0.1)
        controller = name
    else:
        controller = str(shipped(f"{name}.frb"))
    assert main(["simulate", controller, *words, "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    run = simulate(controller, **given)
    for metric in ("rms", "rms_periods", "rms_path"):
        assert printed[metric] == getattr(run, metric).tolist()
    assert printed["metrics"] == {key: each.to_dict() for key, each in run.metrics.items()}
