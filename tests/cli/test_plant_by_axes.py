"""Without --plant a controller runs on the shipped plant that has its axes, in every command."""

import json
import re
import shlex

import pytest

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.control.controllers.findings import site_by_axes

SERVO, HEATER, DIRECT = (
    str(shipped(f"{name}.frb")) for name in ("servo", "heater", "fuzzy-direct")
)


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    def said(words, status=0):
        assert main(shlex.split(words)) == status
        streams = capsys.readouterr()
        return streams.out if status in (0, 3) else streams.err

    return said


def with_axis(path, name):
    path.write_text(shipped("servo.frb").read_text("utf-8").replace("axis shaft", f"axis {name}"))
    return path


@pytest.mark.parametrize(
    ("file", "plant"), [(SERVO, "motor"), (HEATER, "room"), (DIRECT, "arm"), ("pd", "arm")]
)
def test_simulate_sweep_and_tune_find_the_same_plant(file, plant, run):
    short = "" if plant == "arm" else "--for 100s" if plant == "room" else "--for 20ms"
    moves = "--trajectory reach --segment 0.05 --hold 0.05" if plant == "arm" else ""
    assert json.loads(run(f"simulate {file} {short} {moves} --json"))["plant"] == plant
    gain = "K_P=1..2:2" if file == "pd" else "G_e=1..2:2"
    on = "reach" if plant == "arm" else plant
    assert f" on {on}" in run(f"sweep {file} --sweep {gain} {short} {moves}")


def test_every_shipped_controller_has_its_plant():
    texts = {name: fuzzyarm.load(shipped(name)) for name in shipped_names() if ".frb" in name}
    controllers = {n: t for n, t in texts.items() if type(t).__name__ == "ControllerText"}
    sites = {name: site_by_axes(text.model) for name, text in controllers.items()}
    plants = {
        name: re.search(r"[Rr]uns on the plant `(\w[\w-]*)`", text.source)
        for name, text in controllers.items()
    }
    assert {name: site and site.name for name, site in sites.items()} == {
        name: plant.group(1) if plant else "arm" for name, plant in plants.items()
    }
    assert len(set(plants.values())) > 5


def test_axes_that_no_shipped_plant_has_are_named(run, tmp_path):
    with_axis(tmp_path / "kiln.frb", "kiln")
    err = run("simulate kiln.frb", 1)
    assert "no shipped plant has axis kiln with position, velocity, voltage" in err
    assert "--plant FILE.py" in err
    assert run("simulate kiln.frb --show-gains").startswith("G_e")
    assert json.loads(run("simulate kiln.frb --plant motor --for 20ms --json"))["plant"] == "motor"


def test_names_that_are_joined_to_ports_count(run):
    joined = " ".join(
        f"--connect shaft.{port}=joint1.{port}" for port in ("position", "velocity", "voltage")
    )
    move = "--trajectory reach --segment 0.05 --hold 0.05"
    assert json.loads(run(f"simulate {SERVO} {joined} {move} --json"))["plant"] == "arm"


def test_one_run_takes_one_plant(run):
    for command in ("simulate", "compare"):
        err = run(f"{command} {SERVO} pd", 1)
        assert "different plants: servo on motor, pd on arm" in err


# --- Two files of one name ---


def test_two_files_of_one_controller_are_told_apart(run, tmp_path):
    text = shipped("servo.frb").read_text("utf-8")
    (tmp_path / "sub").mkdir()
    (tmp_path / "servo.frb").write_text(text)
    (tmp_path / "sub" / "servo.frb").write_text(text.replace("= 16", "= 20"))
    (tmp_path / "other.frb").write_text(text.replace("= 16", "= 30"))
    files = "servo.frb sub/servo.frb other.frb"
    names = [each["controller"] for each in json.loads(run(f"simulate {files} --for 20ms --json"))]
    assert names == ["servo (servo.frb)", "servo (sub/servo.frb)", "servo (other.frb)"]
    table = run(f"compare {files} --for 20ms")
    assert all(name in table for name in names)
    run(f"simulate {files} --for 5ms --csv runs.csv")
    rows = (tmp_path / "runs.csv").read_text().splitlines()[1:]
    assert list(dict.fromkeys(row.split(",")[0] for row in rows)) == names
    # One file, or different controllers, keep their names.
    assert json.loads(run("simulate servo.frb --for 5ms --json"))["controller"] == "servo"
    # With a gain set as well.
    sets = json.loads(run("simulate servo.frb other.frb --for 5ms --set G_e=1 --json"))
    assert [each["controller"] for each in sets] == ["servo (servo.frb)", "servo (other.frb)"]


def test_a_file_beside_a_name_of_the_catalogue_is_told_apart(run, tmp_path):
    (tmp_path / "c.frb").write_text(shipped("fuzzy-lut.frb").read_text("utf-8"))
    move = "--angles 5 5 --segment 0.05"
    names = [
        each["controller"] for each in json.loads(run(f"compare fuzzy-lut c.frb {move} --json"))
    ]
    assert names == ["fuzzy-lut", "fuzzy-lut (c.frb)"]


# --- Comparing on other plants ---


@pytest.mark.slow
def test_compare_gives_what_simulate_gives(run, tmp_path):
    other = tmp_path / "other.frb"
    other.write_text(shipped("servo.frb").read_text("utf-8").replace("= 16", "= 30"))
    words = "--step 0.5 --for 200ms --noise position=0.001"
    runs = json.loads(run(f"compare {SERVO} other.frb {words} --json"))
    singles = [json.loads(run(f"simulate {file} {words} --json")) for file in (SERVO, "other.frb")]
    assert [each["metrics"] for each in runs] == [each["metrics"] for each in singles]
    table = run(f"compare {SERVO} other.frb {words}").splitlines()
    assert table[0] == "motor, position step:0.5, noise position=0.001, seed 1"
    assert table[1].split()[:4] == ["controller", "error", "of", "rms"]
    assert f"{runs[0]['metrics']['shaft']['rms']:.4g}" in table[2]
    marks = run(f"compare {SERVO} other.frb {words} --markdown").splitlines()
    assert marks[1] == "|---" * 8 + "|"
    run(f"compare {SERVO} other.frb {words} --plot runs.png")
    assert (tmp_path / "runs.png").read_bytes().startswith(b"\x89PNG")


ALONG = "is for plants that follow trajectories; motor takes --reference"
LOAD = "is for plants that carry a load; motor does not, --set changes its parameters: J, b, k, R,"


@pytest.mark.parametrize(
    ("option", "said"),
    [
        ("--trajectory reach-return", f"--trajectory {ALONG}"),
        ("--angles 1 2", f"--angles {ALONG}"),
        ("--segment 0", f"--segment {ALONG}"),
        ("--payload", f"--payload {LOAD}"),
        ("--no-payload", f"--no-payload {LOAD}"),
        ("--no-load-in-hold", f"--no-load-in-hold {LOAD}"),
        ("--supply 24", "motor has no --supply; --actuator INPUT=LOW..HIGH bounds a drive: v"),
        ("--inductance 0", "motor has no --inductance; --actuator INPUT=LOW..HIGH bounds a drive"),
        ("--limits 5 5", "motor has no --limits; --actuator INPUT=LOW..HIGH bounds a drive"),
        ("--conventions study", "motor has no --conventions; it counts in double precision"),
        ("--precision float32", "motor has no --precision; it counts in double precision"),
        ("--pi 0", "motor has no --pi; it counts in double precision with the true π"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("command", ["compare", "simulate", "sweep --sweep K_p=1,2", "tune"])
def test_no_option_is_dropped_that_a_plant_does_not_understand(option, said, command, run):
    if option in ("--trajectory reach-return", "--payload") and command == "compare":
        return  # which has no such option, and carries loads by itself
    if option == "--no-payload" and command[0] == "s":
        return  # which is what they do by themselves
    err = run(f"{command} {SERVO} --plant motor {option}", 1)
    assert said in err
    assert len(err.splitlines()) == 1


def test_options_of_costs_and_senses_are_for_trajectories(run):
    refused = run(f"compare {SERVO} --cost", 1)
    assert "--cost counts along the trajectories of the study's arm; motor is compared" in refused
    assert "--errors chooses among those along" in run(f"compare {SERVO} --errors path", 1)


# --- References where there are trajectories ---


def test_the_arm_follows_references_too(run):
    said = "--step 0.2 --for 300ms"
    one = json.loads(run(f"simulate pd {said} --json"))
    assert one["trajectory"] == "joint1.position step:0.2"
    assert one["samples"] == 100  # set points of 3 ms, as laws have them
    python = fuzzyarm.simulate("pd", "arm", reference={"joint1.position": 0.2}, duration=0.3)
    assert one["rms"] == pytest.approx(list(python.rms), rel=1e-12)
    both = json.loads(run(f"compare pd {said} --json"))
    assert both[0]["rms"] == one["rms"]
    text = run(f"compare pd cdid {said} --sensor-delay joint1.position=1ms")
    assert text.startswith("arm, joint1.position step:0.2")
    assert " on arm, joint1.position step:0.2: 2 runs" in run(
        f"sweep pd {said} --sweep K_P=9..99:2"
    )
    tuned = json.loads(run(f"tune {DIRECT} {said} --evals 1 --unseen 0 --no-linear --json"))
    assert tuned["scenarios"] == ["joint1.position step:0.2"]
    assert "--step and --reference" in run(f"simulate pd {said} --reference joint1.position=1", 2)


@pytest.mark.parametrize(
    "command", ["simulate pd", "compare pd", "sweep pd --random 1", "tune stfc"]
)
def test_a_trajectory_and_references_are_two_things(command, run):
    assert "--step is for references, and --segment" in run(f"{command} --step 0 --segment 1", 2)
    assert "--for sets the duration of --reference or --step" in run(f"{command} --for 2s", 2)


def test_sensors_count_in_comparisons_along_trajectories(run):
    words = "--angles 5 5 --segment 0.05 --noise joint1.position=0.01 --seed 3 --no-payload"
    found = json.loads(run(f"compare pd {words} --json"))[0]
    ways = [("reach-return", "--hold 5"), ("pick-and-place", "")]
    for at, (way, hold) in enumerate(ways):
        one = json.loads(
            run(f"simulate pd --trajectory {way} {words} {hold} --json".replace("--no-payload", ""))
        )
        assert found["rms"][2 * at : 2 * at + 2] == one["rms"]


def test_an_unknown_trajectory_is_wrong_usage(run):
    for command in ("simulate pd", "sweep pd --random 1 --sweep K_P=1..2", "learn", "tune stfc"):
        err = run(f"{command} --trajectory reech", 2)
        assert "or reach, not 'reech' (did you mean 'reach'?)" in err
