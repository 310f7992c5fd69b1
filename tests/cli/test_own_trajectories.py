"""A user's plant with trajectories and a load of its own, through every command and in Python."""

import json
import re
import shlex
from dataclasses import replace

import numpy as np
import pytest
from crane import CRANE, HOOK, errors_of_crane, write_crane

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.control.loop import simulate_many
from fuzzyarm.plant import ArmError, PlantError, find_plant, reach, through
from fuzzyarm.plant.following import trajectory_of, with_load

LIFT = [(0.0, 1.0, 1.0), (1.0, 1.0, 0.5)]
SWING = [(0.0, 0.5, 0.8), (0.5, -0.25, 0.8)]
"""Its trajectories: start, end and time of each segment; the load is picked up after the first."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("crane")
    write_crane(place)
    return place


@pytest.fixture
def run(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)

    def said(words, status=0):
        assert main(shlex.split(words)) == status
        streams = capsys.readouterr()
        return streams.out if status in (0, 3) else streams.err

    return said


def rms(segments, masses, **changed):
    return float(np.sqrt(np.mean(np.square(errors_of_crane(segments, masses, **changed)))))


# --- One run ---


@pytest.mark.parametrize(
    ("words", "segments", "masses"),
    [
        ("", LIFT, (2, 2)),
        ("--payload", LIFT, (2, 5)),
        ("--payload --no-load-in-hold", LIFT, (2, 2)),
        ("--loaded 1 --segment 0.4", [(0, 1, 0.4), (1, 1, 0.5)], (5, 2)),
        ("--trajectory swing --payload", SWING, (2, 5)),
        ("--payload --set m=3", LIFT, (3, 3)),
        ("--way-points 0.5 -0.25 --segment 0.8 --payload", SWING, (2, 5)),
    ],
)
def test_simulate_follows_trajectories_of_the_plant(words, segments, masses, run):
    report = json.loads(run(f"simulate hook.frb --plant crane.py {words} --json"))
    errors = errors_of_crane(segments, masses)
    assert report["samples"] == len(errors)
    assert report["rms"] == pytest.approx([rms(segments, masses)], rel=1e-9)
    assert report["final"] == pytest.approx([errors[-1]], abs=1e-12)
    assert report["plant"] == "crane"
    assert report["outputs"] == {"height": "m"}


def test_the_report_and_files_say_what_was_followed(run, folder):
    text = run("simulate hook.frb --plant crane.py --payload --plot lift.png --csv lift.csv")
    assert text.splitlines()[:2] == [
        "hook on lift, 302 samples, plain conventions, float64",
        f"{'error, m':<16}{'hook':>12}",
    ]
    assert (folder / "lift.png").read_bytes().startswith(b"\x89PNG")
    rows = np.genfromtxt(folder / "lift.csv", delimiter=",", names=True)
    assert rows["height_wanted_m"][-1] == pytest.approx(1.0)


def test_references_take_the_place_of_trajectories(run):
    text = run("simulate hook.frb --plant crane.py --step 1 --for 500ms")
    assert text.startswith("hook on crane, height step:1, 100 samples")
    assert "overshoot" in text


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        ("--angles 1 2", 1, "lift has no angles"),
        ("--trajectory swing --segment 1", 1, "swing has no segment"),
        ("--way-points 1,2", 1, "has 2 numbers, and the crane follows with 1: height"),
        ("--way-points x", 2, "way point 'x' is not numbers"),
        ("--loaded 3", 1, "names segment 3, but 'lift' has 2 segments"),
        ("--step 1 --trajectory lift", 2, "--step is for references, and --trajectory for a"),
        ("--reference height=1 --payload", 2, "--reference is for references, and --payload for"),
        ("--for 2s", 2, "--for sets the duration of --reference or --step"),
        (
            "--supply 12",
            1,
            "crane has no --supply; --actuator INPUT=LOW..HIGH bounds a drive: force",
        ),
        ("--precision float32", 1, "crane has no --precision; it counts in double precision"),
        ("--segment 0.001", 1, "a segment of 0.001 s is out of range (at least a set point, 0.005"),
    ],
)
def test_what_does_not_fit_is_one_sentence(words, status, said, run):
    err = run(f"simulate hook.frb --plant crane.py {words}", status)
    assert said in err
    assert len(err.splitlines()) == 1


def test_an_unknown_trajectory_is_wrong_usage(run):
    err = run("simulate hook.frb --plant crane.py --trajectory lit", 2)
    assert "--trajectory must be lift or swing, not 'lit' (did you mean 'lift'?)" in err


# --- Compared, swept, tuned ---


@pytest.mark.slow
def test_compare_runs_along_all_of_them(run, folder):
    rows = json.loads(run("compare hook.frb --plant crane.py --json"))
    assert rows[0]["rms"] == pytest.approx([rms(LIFT, (2, 5)), rms(SWING, (2, 5))], rel=1e-9)
    forces = [np.diff(forces_of(*each)) for each in ((LIFT, (2, 5)), (SWING, (2, 5)))]
    assert rows[0]["variation"] == pytest.approx([np.abs(f).mean() for f in forces], rel=1e-9)
    table = run("compare hook.frb --plant crane.py --no-payload --plot crane.png").splitlines()
    assert table[0] == "lift and swing without load, plain conventions, float64, π 3.141593"
    assert table[1].split() == ["controller", "rms", "1,", "m", "rms", "1,", "m", "change"]
    assert table[2].split()[3:5] == [f"{rms(LIFT, (2, 2)):.4f}", f"{rms(SWING, (2, 2)):.4f}"]
    assert (folder / "crane.png").read_bytes().startswith(b"\x89PNG")
    assert "--cost counts along the trajectories" in run(
        "compare hook.frb --plant crane.py --cost", 1
    )
    assert "crane, height step:1" in run("compare hook.frb --plant crane.py --step 1")


def forces_of(segments, masses):
    """Return what the controller asks for, of the same run."""
    found = []
    errors_of_crane(segments, masses, forces=found)
    return found


def test_sweep_scales_the_load_and_keeps_what_is_set(run):
    words = "sweep hook.frb --plant crane.py --workers 1 --json"
    report = json.loads(run(f"{words} --sweep payload=0..2:3"))
    at = report["columns"].index("hook.rms")
    expected = [rms(LIFT, (2.0, mass)) for mass in (2.0, 5.0, 8.0)]
    assert [row[at] for row in report["rows"]] == pytest.approx(expected, rel=1e-9)
    report = json.loads(run(f"{words} --sweep c=2..6:3 --payload --trajectory swing"))
    expected = [rms(SWING, (2.0, 5.0), friction=friction) for friction in (2.0, 4.0, 6.0)]
    assert [row[at] for row in report["rows"]] == pytest.approx(expected, rel=1e-9)
    report = json.loads(run(f"{words} --sweep m=3..4:2 --payload"))
    assert [row[at] for row in report["rows"]] == pytest.approx(
        [rms(LIFT, (mass, mass)) for mass in (3.0, 4.0)], rel=1e-9
    )


@pytest.mark.slow
def test_tune_runs_on_its_trajectories_and_on_drawn_ones(run):
    words = "tune hook.frb --plant crane.py --workers 1 --evals 3 --unseen 2 --json"
    report = json.loads(run(f"{words} --scenarios 4"))
    names = report["scenarios"]
    assert names[:2] == ["lift", "swing"]
    assert all(re.search(r": \(.*\) in (0\.8 s each|1 s), load ", name) for name in names[2:])
    cost = 0.5 * (rms(LIFT, (2, 5)) + rms(SWING, (2, 5)))
    report = json.loads(run(words))
    assert cost_of(report) == pytest.approx(cost, rel=1e-9)
    report = json.loads(run(f"{words} --trajectory swing --no-payload --no-linear"))
    assert report["scenarios"] == ["swing"]
    assert cost_of(report) == pytest.approx(rms(SWING, (2, 2)), rel=1e-9)
    report = json.loads(run(f"{words} --loaded 1 --no-linear"))
    assert cost_of(report) == pytest.approx(rms(LIFT, (5, 2)), rel=1e-9)


def cost_of(report):
    return report["rows"]["as in the file"]["train"]["cost"]


def test_learn_trains_along_them(run, folder):
    soc = fuzzyarm.shipped("soc-zero.frb").read_text("utf-8")
    head, _, lines = soc.partition("axis joint1, joint2")
    lines = lines.replace("position", "height").replace("velocity", "speed")
    lines = lines.replace("drive voltage = count * supply / 255", "drive force = count / 10")
    head = head.replace("0.6 ms", "5 ms").replace("every 5", "every 1").replace("1080/pi", "6")
    (folder / "soc.frb").write_text(head.replace("10.8/pi", "3") + "axis hook" + lines)
    (folder / "performance-yamazaki.lut").write_text(
        fuzzyarm.shipped("performance-yamazaki.lut").read_text("utf-8")
    )
    words = "learn soc.frb --plant crane.py --trajectory swing --payload --passes 2"
    report = json.loads(run(f"{words} -o learned.lut --json"))
    assert [each["complete"] for each in report["passes"]] == [True, True]
    assert '"swing with payload"' in (folder / "learned.lut").read_text()


# --- In Python ---


def test_the_same_in_python(folder, monkeypatch):
    monkeypatch.chdir(folder)
    crane = find_plant("crane.py")
    first = fuzzyarm.simulate("hook.frb", "crane.py", payload=True)
    assert (first.trajectory, first.along, first.where) == ("lift", True, "lift")
    assert first.rms == pytest.approx([rms(LIFT, (2, 5))], rel=1e-9)
    again = fuzzyarm.simulate("hook.frb", crane, trajectory=trajectory_of(crane), payload=True)
    np.testing.assert_array_equal(first.error_matrix, again.error_matrix)
    half = fuzzyarm.simulate("hook.frb", crane, trajectory="swing", payload=0.5)
    assert half.rms == pytest.approx([rms(SWING, (2, 3.5))], rel=1e-9)
    own = fuzzyarm.simulate(
        "hook.frb", crane, trajectory="swing", schedule=[{"m": 4}, {"m": 1, "c": 4}]
    )
    assert own.rms == pytest.approx([rms(SWING, (4, 1))], rel=1e-9)
    many = simulate_many("hook.frb", crane, [{"payload": 0.5}, {}], trajectory="swing", workers=1)
    assert many.rms[:, 0] == pytest.approx([rms(SWING, (2, 3.5)), rms(SWING, (2, 2))], rel=1e-9)
    stepped = fuzzyarm.simulate("hook.frb", crane, reference={"height": 1.0}, duration=0.5)
    assert stepped.where == "crane, height step:1"
    tuned = fuzzyarm.tune(
        "hook.frb", crane, trajectory="swing", evals=2, unseen=0, linear=False, workers=1
    )
    assert tuned.scenarios == ("swing",)
    with pytest.raises(PlantError, match="both a trajectory and references"):
        fuzzyarm.simulate("hook.frb", crane, trajectory="swing", reference={"height": 1.0})
    with pytest.raises(PlantError, match="both a trajectory and references"):
        fuzzyarm.simulate("pd", reach(), trajectory="reach")
    with pytest.raises(PlantError, match="has no supply"):
        fuzzyarm.simulate("hook.frb", crane, options=fuzzyarm.control.loop.Options(supply=12.0))
    with pytest.raises(ArmError, match="payload of -1"):
        with_load(crane, -1.0)


def test_a_class_of_ones_own_need_not_be_a_plant_and_may_draw_its_moves(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = CRANE.replace("class Crane(Plant)", "class Crane").replace(
        "import Plant, Port", "import Port"
    )
    drawn = (
        "    def random_trajectory(self, rng):\n        return through([(rng.random(),)], 0.5)\n"
    )
    (tmp_path / "crane.py").write_text(text + "\n" + drawn)
    (tmp_path / "hook.frb").write_text(HOOK)
    tuned = fuzzyarm.tune(
        "hook.frb", "crane.py", scenarios=4, evals=1, unseen=0, linear=False, workers=1
    )
    assert all(name.endswith(" in 0.5 s") for name in tuned.scenarios[2:])  # nowhere is a load


def test_several_axes_follow_with_their_first_outputs_or_with_those_that_are_named(tmp_path):
    arm = find_plant("arm")
    own = through([(10.0, -5.0)], 0.3)
    whole = fuzzyarm.simulate("pd", arm, trajectory=own)
    np.testing.assert_array_equal(whole.error_matrix, fuzzyarm.simulate("pd", own).error_matrix)
    turned = replace(own, outputs=("joint2.position", "joint1.position"))
    swapped = fuzzyarm.simulate("pd", arm, trajectory=turned)
    assert swapped.labels == ("joint2.position", "joint1.position")
    assert swapped.reference[-1] == pytest.approx([10.0, -5.0], rel=1e-3)
    alone = through([(10.0,)], 0.3)
    with pytest.raises(PlantError, match=r"the arm follows with 2: joint1\.position, joint2\.pos"):
        fuzzyarm.simulate("pd", arm, trajectory=alone)
    second = fuzzyarm.simulate("pd", arm, trajectory=replace(alone, outputs=("joint2.position",)))
    assert second.labels == ("joint2.position",)
    with pytest.raises(PlantError, match="is an input, which cannot follow a trajectory"):
        fuzzyarm.simulate("pd", arm, trajectory=replace(alone, outputs=("joint2.torque",)))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('{"lift": lift, ', "[lift, {", "trajectories must be a mapping"),
        ('"lift": lift', '"lift": 3', "trajectory 'lift' is 3"),
        (
            "trajectories =",
            "trajectory =",
            "'trajectory' is not read (did you mean 'trajectories'?)",
        ),
        ('loaded_parameters = {"m"', 'loaded_parameters = {"M"', "loaded_parameters has 'M': 5.0"),
        (
            'loaded_parameters = {"m": 5.0}',
            "loaded_parameters = 5.0",
            "mapping of names to numbers",
        ),
        (
            "longest_step =",
            "compared_along = ('up',)\n    longest_step =",
            "which is not a trajectory",
        ),
        ('hold, name="lift")', 'hold, nam="lift")', "trajectory 'lift' of the crane failed"),
        (
            'return through([(1.0,)], segment, hold, name="lift")',
            "return 3",
            "'lift' of the crane is a int",
        ),
    ],
)
def test_mistakes_in_a_plant_are_said_before_the_run(old, new, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert old in CRANE
    text = CRANE.replace(old, new)
    if new.startswith("["):
        text = text.replace('"swing": through([(0.5,), (-0.25,)], 0.8, name="swing")}', "}]")
    (tmp_path / "crane.py").write_text(text)
    (tmp_path / "hook.frb").write_text(HOOK)
    with pytest.raises((PlantError, ArmError)) as caught:
        fuzzyarm.simulate("hook.frb", "crane.py")
    assert said in str(caught.value)
