"""``fuzzyarm prove`` of loops: what it says, returns, writes and refuses."""

import json
import time
from fractions import Fraction
from hashlib import sha256
from pathlib import Path

import pytest

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.proof.loop import orders

SERVO = str(fuzzyarm.shipped("servo.frb"))
ON = ["prove", SERVO, "--plant", "motor"]
START = "position in 0.1 .. 0.11"


@pytest.mark.slow
def test_a_tube_alone_bounds_all_ports(capsys, tmp_path):
    figure = tmp_path / "tube.svg"
    words = ["--with", "J in 0.009 .. 0.011", "--quantise", "position=0.001"]
    assert main([*ON, "--from", START, "--for", "3ms", *words, "--plot", str(figure)]) == 0
    lines = capsys.readouterr().out.splitlines()
    sentence = f"on motor with J in 0.009 .. 0.011 from {START} for 0.003 s"
    assert lines[0].endswith(f"{sentence}; sensor of position: resolution 0.001")
    assert [line.split(" in ")[0].strip() for line in lines[1:5]] == [
        "position", "velocity", "current", "voltage",
    ]  # fmt: skip
    assert figure.read_text(encoding="utf-8").count("<path") > 10


@pytest.mark.parametrize(
    ("claim", "status", "verdict"),
    [
        (f"from {START}: position in 0 .. 0.2", 0, "proved"),
        (f"from {START}: position in 0 .. 0.105", 1, "refuted"),
        (f"from {START}: position in 0 .. 0.2 after 1 ms", 0, "proved"),
    ],
)
def test_a_claim_gets_its_end(capsys, claim, status, verdict):
    assert main([*ON, "--claim", claim, "--for", "3ms", "--json"]) == status
    data = json.loads(capsys.readouterr().out)
    assert data["verdict"] == verdict
    assert data["property"].endswith(" .. 0.003 s")
    assert (data["tube"] is None) == (verdict == "refuted")


@pytest.mark.slow
def test_a_tube_has_a_certificate(capsys, tmp_path):
    path = tmp_path / "c.json"
    claim = ["--claim", f"from {START}: position in 0 .. 0.2", "--for", "3ms"]
    assert main([*ON, *claim, "--certificate", str(path)]) == 0
    assert "the certificate" in capsys.readouterr().out
    assert main(["prove", "--check", str(path)]) == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--plant", "nope", "--stable"], "no plant 'nope'"),
        (
            ["--plant", "motor", "--claim", "stable from positon in 0 .. 1"],
            "did you mean 'position'",
        ),
        (
            ["--plant", "motor", "--claim", "position in 0.5 .. 0.1"],
            "0.5 .. 0.1 is not an interval",
        ),
        (
            ["--plant", "motor", "--stable", "--with", "K in 0 .. 1"],
            "the plant has no parameter 'K'",
        ),
    ],
)
def test_a_claim_that_names_what_is_not_there_is_at_fault(words, message, capsys):
    assert main([*ON[:2], *words]) == 1
    assert message in capsys.readouterr().err


def test_a_certificate_that_is_not_written_in_time_is_undecided(capsys, tmp_path, monkeypatch):
    path = tmp_path / "c.json"
    monkeypatch.setattr(orders, "TUBE_BUDGET", 0.0)
    claim = ["--claim", f"from {START}: position in 0 .. 0.2", "--for", "3ms"]
    assert main([*ON, *claim, "--certificate", str(path)]) == 4
    told = capsys.readouterr()
    assert "proved" in told.out
    assert "not written: no certificate was found" in told.err
    assert not path.exists()


@pytest.mark.slow
def test_a_certificate_is_part_of_the_budget(tmp_path):
    wide = "from position in 0.1 .. 0.3, velocity in -1 .. 1: position in -1 .. 1 during 0 .. 50 ms"
    begun = time.process_time()  # what else the machine does is not of the budget
    words = ["--budget", "4", "--certificate", str(tmp_path / "c.json")]
    assert main([*ON, "--claim", wide, *words]) in (0, 4)  # written, or not in time
    assert time.process_time() - begun < 8.0


@pytest.mark.slow
def test_a_file_takes_the_certificate_of_one_claim(capsys, tmp_path):
    path = tmp_path / "two.frb"
    text = Path(ON[1]).read_text("utf-8")
    claims = "prove stable on motor\nprove stable on motor from position in -0.1 .. 0.1\n"
    path.write_text(f"{text}\n{claims}", "utf-8")
    assert main(["prove", str(path), "--certificate", str(tmp_path / "c.json")]) == 2
    told = capsys.readouterr().err
    assert f"--certificate takes one claim, and {path} has 2" in told
    assert '--claim "stable on motor"' in told
    assert not (tmp_path / "c.json").exists()


@pytest.mark.slow
def test_a_certificate_knows_the_sensors(capsys, tmp_path):
    path = tmp_path / "c.json"
    late = ["--sensor-delay", "position=1ms", "--sensor-delay", "velocity=1ms"]
    assert main([*ON, "--stable", *late, "--certificate", str(path)]) == 0
    assert "late 1" in capsys.readouterr().out
    assert main(["prove", "--check", str(path)]) == 0
    data = json.loads(path.read_text(encoding="utf-8"))
    assert data["sensors"]["position"]["delay"] == str(Fraction(0.001))


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (["--stable", "--for", "1s"], 2, "--stable is for all time"),
        (["--from", START], 2, "--from goes with --stable or --for"),
        (["--with", "J in 1 .. 2"], 2, "--with goes with --stable, --map or --for"),
        (["--claim", "stable", "--from", START], 2, "--from is part of --claim"),
        (["--claim", "stable", "--for", "1s"], 2, "--for gives a claim"),
        (
            ["--claim", f"from {START}: position in 0 .. 1 after 2 s", "--for", "1s"],
            1,
            "before the",
        ),
        (["--from", "positon in 0 .. 1", "--for", "1s"], 1, "no state 'positon'"),
    ],
)
def test_what_does_not_fit_is_said(capsys, words, status, said):
    assert main([*ON, *words]) == status
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("words", [["--range"], ["--sector"], []])
def test_a_certificate_of_no_loop_is_refused(capsys, tmp_path, words):
    path = tmp_path / "x.json"
    pd7 = str(fuzzyarm.shipped("pd7.frb"))
    assert main(["prove", pd7, *words, "--certificate", str(path)]) == 2
    assert "--certificate goes with a claim about a loop" in capsys.readouterr().err
    assert main([*ON, "--from", START, "--for", "3ms", "--certificate", str(path)]) == 2
    assert not path.exists()


@pytest.mark.slow
def test_a_line_about_a_drive_is_proved(capsys, tmp_path):
    for name in ("servo.frb", "pd7.frb"):
        text = fuzzyarm.shipped(name).read_text(encoding="utf-8")
        (tmp_path / name).write_text(text, encoding="utf-8")
    file = tmp_path / "servo.frb"
    with file.open("a", encoding="utf-8") as end:
        end.write("\nprove stable on motor: voltage in -24 .. 24\n")
    assert main(["prove", str(file)]) == 0
    assert "proved: stable on motor: voltage in -24 .. 24" in capsys.readouterr().out


OWN = (
    "from fuzzyarm.plant import Plant, Port\n\n\n"
    "class Own(Plant):\n"
    "    name = 'own'\n"
    "    inputs = {'voltage': Port('V')}\n"
    "    outputs = {'position': Port('rad'), 'velocity': Port('rad/s', rate_of='position')}\n"
    "    states = {'position': 'rad', 'velocity': 'rad/s'}\n"
    "    axis = 'shaft'\n\n"
)


def said_of_own(folder, capsys):
    """Return what is said of the plant in a folder, which cannot be traced."""
    words = ["--plant", str(folder / "own.py"), "--connect", "shaft=plant", "--for", "3ms"]
    assert main(["prove", SERVO, *words]) == 1
    said = capsys.readouterr().err
    assert "the equations of own cannot be traced" in said
    return said


def test_what_cannot_be_followed_is_said_by_name(capsys, tmp_path):
    (tmp_path / "own.py").write_text(
        f"{OWN}    def derivative(self, t, x, u, p):\n"
        "        return [x[1], u[0] if x[0] > 0 else -u[0]]\n",
        encoding="utf-8",
    )
    said = said_of_own(tmp_path, capsys)
    assert "--sensor-delay" not in said


@pytest.mark.parametrize(
    ("start", "verdict"), [("", "proved: "), (", start=4", "refuted: "), (", start=0", "proved: ")]
)
def test_a_proof_begins_at_the_start_of_a_slewed_actuator(capsys, tmp_path, start, verdict):
    plant = tmp_path / "own.py"
    plant.write_text(
        "from fuzzyarm.plant import Plant, Port\n\n\n"
        "class Own(Plant):\n"
        "    name = 'own'\n"
        f"    inputs = {{'power': Port('W', 0, 5, slew=1{start})}}\n"
        "    outputs = {'level': Port('m')}\n"
        "    states = {'level': 'm'}\n"
        "    axis = 'tank'\n\n"
        "    def derivative(self, t, x, u, p):\n"
        "        return [u[0]]\n",
        encoding="utf-8",
    )
    file = tmp_path / "c.frb"
    claim = "from level in 0 .. 0: level in -0.001 .. 0.02 during 0 .. 30 ms"
    file.write_text(
        "controller c\nperiod 10 ms\naxis tank\n  e = error of level\n  u = e * 0\n"
        f"  drive power = u\n\nprove on '{plant}' {claim}\n",
        encoding="utf-8",
    )
    assert main(["prove", str(file), "--plant", str(plant)]) == (verdict[0] == "r")
    out = capsys.readouterr().out
    assert verdict in out
    assert ("level = 0.0399 after 0.01 s" in out) is (verdict[0] == "r")


@pytest.mark.parametrize("queue", ["deque", "list"])
@pytest.mark.parametrize("at_start", [False, True])
def test_a_queue_of_a_plant_is_a_delay_of_its_sensor(capsys, tmp_path, at_start, queue):
    made = "    def start(self, rng):" if at_start else "    def __init__(self):"
    (tmp_path / "own.py").write_text(
        f"from collections import deque\n\n{OWN}{made}\n"
        f"        self.late = {queue}([0.0] * 5)\n"
        f"{'        return [0.0, 0.0]' if at_start else ''}\n\n"
        "    def step(self, t, x, u, p, dt):\n"
        "        self.late.append(x[0])\n"
        "        return [x[0] + dt * x[1], x[1] + dt * u[0]]\n\n"
        "    def measure(self, t, x, u, p):\n"
        f"        y = self.late.{'popleft()' if queue == 'deque' else 'pop(0)'}\n"
        "        return [y, x[1]]\n",
        encoding="utf-8",
    )
    said = said_of_own(tmp_path, capsys)
    assert "--sensor-delay PORT=TIME" in said


LAG = (
    "from fuzzyarm.plant import Plant, Port\n\n\n"
    "class Lag(Plant):\n"
    "    inputs = {'u': Port('V', -10, 10)}\n"
    "    outputs = {'y': Port('V')}\n"
    "    states = {'y': 'V'}\n\n"
    "    def derivative(self, t, x, u, p):\n"
    "        return [u[0] - x[0]]\n"
)
ON_LAG = "controller c\nperiod 10 ms\naxis y\n  e = error of y\n  drive u = e, within -10 .. 10\n"


@pytest.mark.slow
def test_names_in_a_certificate_count_from_its_folder(capsys, tmp_path, monkeypatch):
    for folder in ("plants", "loops", "proofs", "moved", "elsewhere"):
        (tmp_path / folder).mkdir()
    (tmp_path / "plants/lag.py").write_text(LAG)
    claim = "on 'plants/lag.py' from y in 0.1 .. 0.2: y in 0 .. 0.3 during 0 .. 50 ms"
    (tmp_path / "loops/c.frb").write_text(ON_LAG)
    monkeypatch.chdir(tmp_path)
    out = "proofs/c.json"
    assert main(["prove", "loops/c.frb", "--claim", claim, "--certificate", out]) == 0
    seal = capsys.readouterr().out.split()[-1]
    assert json.loads(Path(out).read_text())["seal"].startswith(seal)
    for folder in (".", "proofs", "loops", "elsewhere"):
        monkeypatch.chdir(tmp_path / folder)
        assert main(["prove", "--check", str(tmp_path / out), "--trust"]) == 0
        plant = str(tmp_path / "plants/lag.py")
        assert main(["prove", "--check", str(tmp_path / out), "--plant", plant]) == 0
        assert capsys.readouterr().out.count("c.json: proved: on ") == 2
        # A plant of the certificate's choice runs by no other way.
        assert main(["prove", "--check", str(tmp_path / out)]) == 1
        assert "lag.py' is code" in capsys.readouterr().err
    monkeypatch.chdir(tmp_path)
    Path(out).rename("c.json")
    assert main(["prove", "--check", "c.json", "--trust"]) == 1
    assert "the controller ../loops/c.frb is not there" in capsys.readouterr().err
    for name in ("plants", "loops", "proofs"):
        Path(name).rename(f"moved/{name}")
    Path("c.json").rename("moved/proofs/c.json")
    assert main(["prove", "--check", "moved/proofs/c.json", "--trust"]) == 0
    # A plant that is elsewhere is named, and is the one that was proved or refused.
    Path("elsewhere/lag.py").write_text(LAG)
    found = ["prove", "--check", "moved/proofs/c.json", "--plant", "elsewhere/lag.py"]
    assert main(found) == 0
    Path("elsewhere/lag.py").write_text(LAG.replace("- x[0]", "- 2.0 * x[0]"))
    assert main(found) == 1
    assert "is not the plant that was proved" in capsys.readouterr().err
    # A file of the same name in the working folder is not looked at.
    Path("elsewhere/c.frb").write_text(ON_LAG.replace("10 ms", "20 ms"))
    Path("moved/loops/c.frb").unlink()
    monkeypatch.chdir("elsewhere")
    assert main(["prove", "--check", "../moved/proofs/c.json", "--trust"]) == 1


@pytest.mark.slow
def test_a_plant_of_a_line_counts_from_the_folder_of_the_controller(capsys, tmp_path, monkeypatch):
    (tmp_path / "loops a").mkdir()
    monkeypatch.chdir(tmp_path)
    Path("loops a/läg.py").write_text(LAG)
    line = "prove on 'läg.py' from y in 0.1 .. 0.2: y in 0 .. 0.3 during 0 .. 50 ms\n"
    Path("loops a/c.frb").write_text(f"{ON_LAG}\n{line}")
    plant = "loops a/läg.py"
    for words in (["--trust"], ["--plant", plant]):
        assert main(["prove", "loops a/c.frb", *words, "--certificate", "c.json"]) == 0
        assert f"proved: on '{plant}' from" in capsys.readouterr().out
    # The checker names the file that it ran.
    assert main(["prove", "--check", "c.json", "--trust"]) == 0
    digest = sha256(Path(plant).read_bytes()).hexdigest()
    assert f"read {plant}, SHA-256 {digest}" in capsys.readouterr().out
    # One of the working folder is not meant.
    Path(plant).rename("läg.py")
    assert main(["prove", "loops a/c.frb", "--trust"]) == 1
    assert f"no file '{plant}' (names in a controller" in capsys.readouterr().err


def test_a_map_of_a_loop_without_a_region_says_why(capsys, tmp_path):
    path = tmp_path / "away.frb"
    path.write_text(
        ON_LAG.replace("axis y", "axis shaft")
        .replace("of y", "of position")
        .replace("drive u = e", "drive voltage = e * -2")
    )
    words = ["prove", str(path), "--plant", "motor", "--map", "--budget", "5"]
    assert main(words) == 4
    assert "no region around rest is proved: next to rest a deviation grows" in (
        capsys.readouterr().out
    )
    arm = ["prove", str(fuzzyarm.shipped("stfc.frb")), "--plant", "arm", "--map"]
    assert main(arm) == 1
    assert "the equations of arm cannot be traced" in capsys.readouterr().err
