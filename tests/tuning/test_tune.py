"""Tuning finds less cost, keeps what is promised, and says no more than it knows."""

import math
from concurrent.futures import CancelledError, Executor, Future
from dataclasses import replace

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm import load, shipped
from fuzzyarm.control.controllers import controller, find_controller
from fuzzyarm.control.controllers.catalogue import controller_of
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.loop import Sensor, Signal, simulate
from fuzzyarm.control.loop.many import Bench, Experiment
from fuzzyarm.control.loop.run import ClosedLoop, plant_motion
from fuzzyarm.inference import infer
from fuzzyarm.language import parse
from fuzzyarm.learning.data import as_samples
from fuzzyarm.learning.tuning import Journal, TuneError, tune
from fuzzyarm.learning.tuning.cost import (
    Cost,
    CostFormulaError,
    brief_values_of,
    lost,
    read_cost,
    values_of,
)
from fuzzyarm.learning.tuning.design import Design
from fuzzyarm.learning.tuning.linear import cut_off, nearest_plane, straightened
from fuzzyarm.learning.tuning.optimisers import OPTIMISERS
from fuzzyarm.learning.tuning.scenarios import train_scenarios, unseen_scenarios
from fuzzyarm.learning.tuning.tune import read_tuning, stage_of
from fuzzyarm.plant import find_plant, reach_return
from fuzzyarm.plant.plant import interface_of
from fuzzyarm.proof.map import prove_all
from fuzzyarm.requests.journal import JournalError

HEATER = shipped("heater.frb")
ROOM = {
    "reference": {"temperature": Signal("step", (20.0,))},
    "duration": 3600.0,
    "cost": "rms + overshoot",
    "unseen": 2,
}
QUICK = reach_return(segment=0.1, hold=0.05)


def heated(**given):
    settings = {"evals": 12, "linear": False, "workers": 1, **ROOM, **given}
    return tune(HEATER, **settings)


@pytest.fixture(scope="module")
def tuned():
    return heated(evals=40, linear=True, workers=2)


# --- The search ---


def test_it_costs_less_on_what_was_tuned_on_and_says_what_unseen_scenarios_show(tuned):
    file, own, linear = tuned.rows
    assert own.scores["train"].cost < file.scores["train"].cost
    assert set(own.scores) == {"train", "unseen", "noisy"}
    assert linear.name == "linear PD"
    assert len(tuned.linear.trials) == 40
    wins, count = tuned.wins("linear PD")
    parts = zip(own.scores["unseen"].parts, linear.scores["unseen"].parts, strict=True)
    assert (wins, count) == (sum(a < b for a, b in parts), 2)
    mine, theirs = (row.scores["unseen"].cost for row in (own, linear))
    change = f"{100 * abs(mine / theirs - 1):.3g} % {'lower' if mine < theirs else 'higher'} cost"
    beside_linear = tuned.claim().partition("; ")[2]
    assert beside_linear == (
        f"better than the linear PD on {wins} of 2 unseen scenarios, {change} on average"
    )


def test_what_is_written_is_what_was_scored(tuned, tmp_path):
    (path,) = tuned.write(tmp_path / "out.frb")
    text = path.read_text()
    run = simulate(
        str(path), find_plant("room"), reference=ROOM["reference"], duration=ROOM["duration"]
    )
    metrics = run.metrics["room"]
    expected = metrics.rms + metrics.overshoot
    assert tuned.row("tuned").scores["train"].cost == pytest.approx(expected, rel=1e-12)
    assert fuzzyarm.check_file(path).diagnostics == ()
    old = HEATER.read_text().splitlines()
    kept = [line for line in text.splitlines() if not line.startswith("# tuned: ")]
    assert [line for line in old if not line.startswith("gain")] == [
        line for line in kept if not line.startswith("gain")
    ]
    for change in tuned.changes:
        assert f"gain {change.what:<4} = {change.new} " in text
        assert len(change.new.replace(".", "").strip("0")) <= 3
    # Tuned again, the old notes give way to new ones.
    again = tune(path, evals=2, linear=False, workers=1, digits=2, **ROOM)
    assert again.text.count("# tuned: ") <= text.count("# tuned: ")


@pytest.mark.parametrize("method", OPTIMISERS)
def test_a_seed_says_all_and_workers_nothing(method):
    alone, together = (heated(method=method, evals=20, workers=count) for count in (1, 3))
    points = [[trial.point.tolist() for trial in made.found.trials] for made in (alone, together)]
    assert points[0] == points[1]
    assert [t.score for t in alone.found.trials] == [t.score for t in together.found.trials]
    assert len(points[0]) == 20
    assert all(0.0 <= share <= 1.0 for point in points[0] for share in point)
    other = heated(method=method, evals=20, seed=2)
    assert [t.point.tolist() for t in other.found.trials] != points[0]


def test_a_journal_goes_on_as_if_nothing_had_been(tmp_path):
    path, question = tmp_path / "journal", {"asked": 1}
    whole = heated(evals=14)
    heated(evals=6, journal=Journal(path, question, resume=False))
    with path.open("a") as file:
        file.write('7,0.1,"torn')
    with pytest.raises(JournalError, match="has 6 trials of this search"):
        Journal(path, question, resume=False)
    with pytest.raises(JournalError, match="belongs to another search: asked was 1, not 2"):
        Journal(path, {"asked": 2}, resume=True)
    resumed = heated(evals=14, journal=Journal(path, question, resume=True))
    assert [t.score.cost for t in resumed.found.trials] == [
        t.score.cost for t in whole.found.trials
    ]
    assert resumed.text == whole.text
    assert len(path.read_text().splitlines()) == 3 + 14
    with pytest.raises(JournalError, match="another search"):
        heated(evals=14, seed=5, journal=Journal(path, question, resume=True))


def test_ctrl_c_keeps_the_best():
    def watch(found):
        if len(found.trials) == 7:
            raise KeyboardInterrupt

    made = heated(evals=500, watch=watch)
    assert made.found.interrupted
    assert len(made.found.trials) == 7
    before, after = (made.table[row]["train"].cost for row in ("as in the file", "tuned"))
    assert after < before
    assert f"{after:.4g}, as in the file {before:.4g};" in repr(made)


def test_gains_of_each_axis_and_terms_of_their_file(tmp_path):
    given = {
        "tune": ["peaks e, ce mirrored, partition", "gain G_e 0.5 .. 2 times, per axis"],
        "cost": "rms + 0.002*chatter",
        "evals": 14,
        "unseen": 0,
        "linear": False,
        "workers": 2,
    }
    made = tune(shipped("fuzzy-direct.frb"), QUICK, **given)
    assert [each.name for each in made.parameters][:3] == ["G_e[1]", "G_e[2]", "pd7.e PS"]
    first, second = made.write(tmp_path / "mine.frb")
    assert second.name == "mine-pd7.frb"
    assert 'use pd7 from "mine-pd7.frb"' in first.read_text()
    back = load(first)
    run = simulate(back, QUICK, payload=True)
    expected = np.mean([m.rms + 0.002 * m.chatter for m in run.metrics.values()])
    assert made.row("tuned").scores["train"].cost == pytest.approx(expected, rel=1e-12)
    assert fuzzyarm.check_file(second).diagnostics == ()
    assert "no unseen scenarios" in made.claim()


# --- Promises ---


def samples_of(rulebase, count=200):
    generator = np.random.default_rng(0)
    inputs = generator.uniform(-6.0, 6.0, (count, 2))
    values = infer(rulebase, e=inputs[:, 0], ce=inputs[:, 1])["u"]
    return as_samples(inputs, values, ("e", "ce"), "u")


@pytest.fixture(scope="module")
def moved():
    """PD7 with other peaks, and samples of it."""
    pd7 = load(shipped("pd7.frb"))
    design = Design(pd7, read_tuning(["peaks e mirrored, partition"]))
    other = design.rulebase_at(design.at([0.4, 0.45]))
    return pd7, other, samples_of(other)


@pytest.mark.slow
def test_samples_bring_terms_back(moved):
    pd7, other, samples = moved
    made = tune(pd7, data=samples, tune=["peaks e mirrored, partition"], evals=80, workers=1)
    assert made.row("tuned").scores["train"].cost < 0.05 * made.rows[0].scores["train"].cost
    found = {term.name: term.shape.parameters for term in made.model.variable("e").terms}
    for term in other.variable("e").terms:
        assert found[term.name] == pytest.approx(term.shape.parameters, abs=0.02)
    regression = made.row("linear regression").scores
    rest = samples.inputs, samples.values
    assert 0.0 < regression["train"].cost < np.ptp(rest[1])
    assert regression["unseen"].cost > made.row("tuned").scores["unseen"].cost


def test_every_candidate_keeps_the_expectations(moved):
    pd7, _, samples = moved
    held = replace(pd7, expectations=(*pd7.expectations, *_expected(pd7, 2.0)))
    made = tune(held, data=samples, tune=["peaks e mirrored, partition"], evals=60, workers=1)
    assert made.found.refused > 0
    assert abs(infer(made.model, e=2.0, ce=0.0)["u"] - infer(pd7, e=2.0, ce=0.0)["u"]) <= 0.02
    broken = replace(pd7, expectations=_expected(pd7, 2.0, off=1.0))
    with pytest.raises(TuneError, match="breaks a promise of its own"):
        tune(broken, data=samples)


def _expected(rulebase, e, off=0.0):
    from fuzzyarm.language.model.rulebase import Expectation, Outcome

    value = infer(rulebase, e=e, ce=0.0)["u"] + off
    return (Expectation((("e", e), ("ce", 0.0)), (Outcome("u", "=", value, 0.02),)),)


@pytest.mark.slow
def test_proved_properties_hold_afterwards(moved):
    pd7, _, samples = moved
    text = fuzzyarm.write(pd7) + "prove u odd\nprove u in -5.4 .. 5.4\n"
    made = tune(fuzzyarm.parse(text).rulebase, data=samples, evals=12, workers=1)
    assert [verdict.proved for verdict in prove_all(made.model)] == [True, True]


def test_nothing_moves_in_a_file_that_lets_nothing_move():
    text = load(shipped("fuzzy-direct.frb"))
    still = tuple(replace(each, tune=None) for each in text.model.gains)
    model = replace(text.model, gains=still)
    # Nothing said anywhere: all peaks move, and what is even stays even.
    design = Design(replace(text, model=model))
    assert len(design.parameters) == 9
    with pytest.raises(TuneError, match="nothing may move"):
        Design(text, read_tuning(["keep e"]))


# --- Costs ---


@pytest.mark.parametrize(
    ("cost", "message"),
    [
        ("rmss", "no metric 'rmss'"),
        ("rms +", "cannot be read"),
        ("'room.rmse'", "no metric 'room.rmse'"),
        ("'hall.rms'", "unknown metric 'hall.rms'"),
        ("cost.py", "does not name a function"),
    ],
)
def test_a_cost_that_means_nothing(cost, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CostFormulaError, match=message):
        heated(cost=cost, evals=2)


def test_metrics_of_one_axis_and_functions_of_ones_own(tmp_path):
    (tmp_path / "own.py").write_text(
        "def late(runs):\n    return sum(abs(run.error_matrix[-1, 0]) for run in runs)\n"
        "def wrong(runs):\n    return runs[0].nothing\n"
    )
    made = heated(cost=f"{tmp_path / 'own.py'}:late", evals=10)
    assert made.row("tuned").scores["train"].cost <= made.found.trials[0].score.cost
    with pytest.raises(CostFormulaError, match=r"own.py:4: AttributeError"):
        heated(cost=f"{tmp_path / 'own.py'}:wrong", evals=2)
    with pytest.raises(CostFormulaError, match="no function 'lat'"):
        read_cost(f"{tmp_path / 'own.py'}:lat")
    assert Cost("2*'room.rms'").of({"rms": 1.0, "room.rms": 3.0}) == 6.0


def test_values_are_means_over_axes_and_a_lost_run_costs_more_the_sooner():
    run = simulate("pd", QUICK, payload=True)
    values, metrics = values_of(run), run.metrics
    assert values["rms"] == pytest.approx(np.mean(run.rms))
    assert values["joint2.iae"] == metrics["joint2"].iae
    assert values["max"] == pytest.approx(np.mean([abs(m.max) for m in metrics.values()]))
    assert "overshoot" not in values
    assert [lost(at, 2.0) for at in (0.0, 1.0, 2.0)] == [2e6, 1.5e6, 1e6]


@pytest.mark.parametrize("noisy", [False, True])
def test_what_a_search_keeps_of_a_run_is_what_the_whole_run_says(noisy):
    noise = Sensor(noise=1e-3)
    arm = Bench(Experiment(controller("cfaf"), QUICK, shared={"payload": 1.0}), []).loop
    heater = controller_of(load(HEATER))
    motion = plant_motion(heater, find_plant("room"), ROOM["reference"], 600.0)
    for loop in (arm, ClosedLoop(heater, motion)):
        course = loop.course
        if noisy:
            port = loop.site.interface.label(course.motion.tracked[0])
            course = course.with_options(replace(course.options, sensors={port: noise}, seed=5))
        run, judged = loop.run(None, course, 5), loop.judged(None, course, 5)
        values, brief = values_of(run), brief_values_of(judged)
        assert {name.rpartition(".")[2] for name in brief} == {"rms", "chatter"}
        assert brief == {name: values[name] for name in brief}
        assert judged.diverged == run.diverged
    assert Cost("rms + 2*'joint1.chatter' + pi").is_brief
    assert not Cost("rms + max").is_brief


class Noting(Controller):
    """Does what another does, and notes its torques."""

    def __init__(self, name):
        self.inner, self.torques = controller(name), []

    def start(self, single=False):
        self.inner.start(single)

    def torque(self, reference, state, clock):
        self.torques.append(self.inner.torque(reference, state, clock))
        return self.torques[-1]


def test_chatter_is_the_root_mean_square_change_of_the_torque():
    noting = Noting("pid-modified")
    run = simulate(noting, QUICK)
    changes = np.diff(np.array(noting.torques), axis=0)  # that the run begins is not one
    found = [metrics.chatter for metrics in run.metrics.values()]
    assert found == pytest.approx(np.sqrt((changes**2).mean(axis=0)), rel=1e-12)
    compiled = simulate("pid-modified", QUICK)
    assert [m.chatter for m in compiled.metrics.values()] == pytest.approx(found, rel=1e-9)


# --- Scenarios, and the linear opponent ---


def test_more_scenarios_begin_with_the_same_ones_and_unseen_ones_are_others():
    text = load(shipped("fuzzy-direct.frb"))
    stage = stage_of(text, None, {}, seed=3)
    made = controller("fuzzy-direct")
    few, many = (train_scenarios(stage, count, made) for count in (4, 7))
    assert many[:4] == few
    assert [each.name for each in few[:2]] == ["reach-return", "pick-and-place"]
    loads = [each.changes["payload"] for each in many[2:]]
    assert all(0.0 <= load <= 1.3 for load in loads)
    unseen = unseen_scenarios(stage, 5, made)
    seen = {each.along for each in many}
    assert not seen & {each.along for each in unseen}
    assert not {s.changes.get("seed") for s in many} & {s.changes["seed"] for s in unseen}


def test_references_are_scaled_from_where_the_plant_rests():
    text = load(HEATER)
    stage = stage_of(text, None, {"reference": ROOM["reference"], "duration": 600.0})
    drawn = unseen_scenarios(stage, 20, find_controller(str(HEATER)))
    goals = [each.on.references[-1, 0] for each in drawn]
    assert all(17.5 <= goal <= 22.5 for goal in goals)  # half of the way from 15 to half more
    assert len(set(goals)) == 20
    noisy = stage.noisy()
    louder = stage.noisy(1e-3).options.sensors["temperature"].noise
    assert louder == pytest.approx(80.0 * 1e-3)
    assert noisy.options.sensors["temperature"].noise == pytest.approx(80.0 * 1e-5)


def test_the_noise_of_the_judgement_shows_and_its_size_is_said():
    found = tune(shipped("servo.frb"), plant="motor", evals=3, unseen=3, linear=False)
    row = found.row("as in the file")
    assert found.noise in (1e-5, 1e-4, 1e-3, 1e-2)
    assert row.scores["noisy"].cost != pytest.approx(row.scores["unseen"].cost, rel=1e-3)
    assert f"noisy: with noise of {100 * found.noise:g} % of each range" in list(found.remarks())
    assert found.to_dict()["noise"] == found.noise


def test_noise_leaves_what_a_sensor_has_beside_it():
    stage = stage_of(load(HEATER), None, {"reference": ROOM["reference"], "duration": 600.0})
    arm, late = find_plant("arm"), Sensor(delay=0.001)
    options = replace(stage.options, sensors={"position": late})  # of both joints
    sensors = replace(stage, plant=arm, options=options).noisy().options.sensors
    axes = [axis for axis, name in interface_of(arm).outputs if name == "position"]
    assert len(axes) == 2
    assert "position" not in sensors
    for axis in axes:
        sensor = sensors[f"{axis}.position"]
        assert sensor.delay == late.delay
        assert (sensor.noise > 0.0) == math.isfinite(arm.outputs[f"{axis}.position"].high)


def test_the_opponent_is_the_plane_nearest_to_the_rules():
    text = load(HEATER)
    (room,) = (each for (each,) in text.sheets.values())
    slopes, constant = nearest_plane(room, "du")
    assert slopes == pytest.approx([0.5, 0.5])  # the rules of roompi are a plane
    assert constant == 0.0
    line, tuning = straightened(text)
    names = [each.names for each in tuning.gains]
    assert names == [("slope of du along en",), ("slope of du along ce",), ("G_du",)]
    plant = find_plant("room")
    given = {"reference": ROOM["reference"], "duration": ROOM["duration"]}
    fuzzy, straight = (simulate(each, plant, **given) for each in (text, line))
    # Only clipping each input by itself, as rules do, tells them apart.
    assert straight.rms == pytest.approx(fuzzy.rms, rel=0.05)
    cut = cut_off(room.outputs[0])
    values = infer(cut, s=np.array([-3.0, -0.4, 0.7, 9.0]))["v"]
    assert values.tolist() == pytest.approx([-1.0, -0.4, 0.7, 1.0])


@pytest.mark.slow
def test_a_rule_base_alone_needs_to_be_told_what_is_good():
    with pytest.raises(TuneError, match="a rule base alone"):
        tune(shipped("pd7.frb"))
    made = tune(
        shipped("thermostat.frb"),
        cost=lambda rulebase: abs(rulebase.variable("error").term("COOL").shape.parameters[1] - 3),
        tune=["peaks error mirrored, keep order"],
        evals=40,
        workers=1,
    )
    shape = made.model.variable("error").term("COOL").shape
    assert shape.parameters[1] == pytest.approx(3.0, abs=0.1)
    assert math.isnan(made.found.best.score.error)


class GoingAway(Executor):
    """A cluster that goes after some examinations."""

    def __init__(self, examinations):
        self.left = examinations

    def submit(self, function, /, *words):
        future = Future()
        self.left -= 1
        if self.left < 0:
            future.cancel()
        else:
            future.set_result(function(*words))
        return future


def test_the_best_is_kept_where_the_workers_go():
    gone = heated(evals=500, executor=GoingAway(20), linear=True)
    assert gone.found.interrupted
    assert len(gone.found.trials) == 20
    assert gone.row("linear PD") is None
    again = heated(evals=20)
    assert gone.text == again.text
    with pytest.raises(CancelledError):
        heated(executor=GoingAway(0))


def test_an_opponent_whose_search_was_ended_is_left_out():
    def enough(found):
        if len(found.trials) == 3:
            raise KeyboardInterrupt

    told = []
    half = heated(
        linear=True, watch_linear=enough, watch=lambda found: told.append(len(found.trials))
    )
    assert told[-1] == len(half.found.trials) == 12
    assert half.found.interrupted
    assert "linear" not in half.claim()


@pytest.mark.parametrize("linear", [True, False])
def test_a_time_is_that_of_the_whole(linear, monkeypatch):
    """By a clock that goes on by 0.1 s at each look; a run takes as long as in the search."""
    from itertools import count

    from fuzzyarm.learning.tuning import search

    ticks = count(0.0, 0.1)
    monkeypatch.setattr(search.time, "monotonic", lambda: next(ticks))
    made = heated(evals=10**6, time=60.0, unseen=24, linear=linear)
    monkeypatch.undo()
    searches = [found for found in (made.found, made.linear) if found is not None]
    assert len(searches) == 1 + linear
    share = 0.8 * 60.0 / len(searches)
    assert all(share < found.seconds < share + 3.0 for found in searches)
    (judged,) = {len(row.scores["unseen"].parts) for row in made.rows}
    assert len(made.unseen) == judged
    pace = made.found.seconds / len(made.found.trials)
    assert 1 <= judged <= 24
    assert judged * 2 * len(made.rows) * pace <= 0.2 * 60.0
    assert any("time ran out" in line for line in made.remarks()) == (judged < 24)
    at_once = heated(evals=50, time=1e-9, unseen=5, linear=linear)
    assert len(at_once.found.trials) == 1  # the file itself, always
    assert {len(row.scores["unseen"].parts) for row in at_once.rows} == {1}
    assert all("noisy" not in row.scores for row in at_once.rows)


def test_the_nearest_plane_of_a_plane_is_itself():
    rulebase = parse(
        "rulebase plane\ninput a -1 .. 1\ninput b 0 .. 2\noutput u -9 .. 9\n"
        "terms a: triangles L H\nterm u P: linear 2*a - b + 3\n"
        "inference u: defuzzifier weighted-average, aggregation sum\n"
        "rule if a is L then u is P\nrule if a is H then u is P\n"
    ).rulebase
    slopes, constant = nearest_plane(rulebase, "u")
    assert (*slopes, constant) == pytest.approx((2.0, -1.0, 3.0))
