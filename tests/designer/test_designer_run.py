"""The view Run without a browser: what a page may run, push and change, and what it hears."""

import json
import shutil
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from crane import write_crane

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.controllers import find_controller
from fuzzyarm.control.loop import Options, Sensor, Signal, simulate
from fuzzyarm.control.loop.run import ClosedLoop
from fuzzyarm.language.edit import ReshapeError, apply_edits, read, set_gain
from fuzzyarm.plant import find_plant

TOKEN = "b" * 32
FILES = ("servo", "tanks", "pd7", "ball-and-beam", "heater")
SERVO = shipped("servo.frb").read_text()

MINE = """\
from fuzzyarm.base.picture import Drawing, Line
from fuzzyarm.plant import Plant, Port

class Kiln(Plant):
    inputs = {"power": Port("%", 0, 100)}
    outputs = {"temperature": Port("°C", 0, 1200)}
    states = {"charge": "°C"}
    duration = 600.0

    def derivative(self, t, x, u, p):
        return [0.2 * u[0] - 0.01 * x[0]]

    def draw(self, scene):
        hot = scene.output("temperature") / 1200
        return Drawing((0, 1, 0, 1), [Line((0, 1), (0, hot), "#ff0000", 1.5)])

class Fails(Kiln):
    def derivative(self, t, x, u, p):
        return [1 / 0 if t > 100 else 0.0]
"""


# --- the edit of the text ---


def test_a_gain_is_an_edit_of_its_number():
    text = SERVO.replace('gain G_u  = 4.5 "V",', 'gain G_u  = 9/2, 3*pi "V",')
    text = text.replace("log\ngain G_ce", "log  # fast\ngain G_ce")
    for name, values in (("G_e", [17.25]), ("G_u", [4.0, -1e-3])):
        text = apply_edits(text, set_gain(read(text), name, values))
    assert 'gain G_e  = 17.25 "1/rad", tune 2 .. 200 log  # fast\n' in text
    assert 'gain G_u  = 4, -0.001 "V", tune 1 .. 10 log\n' in text
    for name, values in (("G_e", [1.0, 2.0]), ("G_x", [1.0])):
        with pytest.raises(ReshapeError):
            set_gain(read(text), name, values)


# --- the server ---


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("run")
    for name in FILES:
        shutil.copy(shipped(f"{name}.frb"), found)
    (found / "mine.py").write_text(MINE)
    (found / "way.csv").write_text("time,value\n0,0\n1,1\n")
    (found.parent / "outside.csv").write_text("time,value\n0,0\n1,1\n")
    return found


def of_page(asked):
    """Return what a page asks for: its own words, and the fields of the form."""
    own = {"until", "window", "speed", "paused", "calm", "text"}
    form = {name: value for name, value in asked.items() if name not in own}
    return {name: value for name, value in asked.items() if name in own} | {"form": form}


class Page:
    """A window on a file."""

    def __init__(self, socket, file):
        self.socket, self.file, self.number = socket, file, 0
        self.send(do="open", file=file)

    def send(self, **message):
        self.socket.send_text(json.dumps(message))

    def start(self, what, **asked):
        self.number += 1
        self.send(do="start", file=self.file, id=self.number, what=what, **of_page(asked))

    def say(self, **words):
        self.send(do="say", id=self.number, **words)

    def hear(self, wanted):
        """Return the next news that fits, and all before it."""
        found = []
        while True:
            news = json.loads(self.socket.receive_text())
            if news["is"] == "job" and news["id"] == self.number:
                found.append(news)
                if "end" in news or wanted(news):
                    return found

    def until(self, kind):
        found = self.hear(lambda news: news.get("news") == kind)
        assert found[-1].get("news") == kind, found[-1]
        return found

    def stop(self):
        self.send(do="stop", id=self.number)
        return self.hear(lambda news: False)[-1]


@pytest.fixture(scope="module")
def client(folder):
    from starlette.testclient import TestClient

    from fuzzyarm.apps.designer.server import Designer, Workspace
    from fuzzyarm.apps.designer.stage import Plants

    crane, _ = write_crane(folder)
    plants = Plants((f"{folder / 'mine.py'}:Kiln", f"{folder / 'mine.py'}:Fails", crane))
    app = Designer(Workspace(folder), TOKEN, plants).app()
    with TestClient(app, base_url="http://127.0.0.1:8000") as found:
        yield found


@pytest.fixture
def open_page(client):
    sockets = []

    def opened(file):
        socket = client.websocket_connect(
            f"ws://127.0.0.1:8000/{TOKEN}/socket", headers={"origin": "http://127.0.0.1:8000"}
        )
        sockets.append(socket)
        return Page(socket.__enter__(), file)

    yield opened
    for socket in sockets:
        socket.__exit__(None, None, None)


FAST = {"plant": "motor", "reference": ["position=step:1"], "duration": "500ms", "speed": None}


@pytest.mark.slow
def test_metrics_follow_a_run_however_long_the_first_took(open_page, monkeypatch):
    whole, seen = ClosedLoop.answer, []

    def answer(self, run):
        if not seen:
            time.sleep(0.3)  # modules are loaded
        seen.append(run.next)
        return whole(self, run)

    monkeypatch.setattr(ClosedLoop, "answer", answer)
    page = open_page("servo.frb")
    page.start("run", **{**FAST, "duration": "3s", "speed": 1})
    told = [each["at"] for each in page.until("over") if each.get("news") == "metrics"]
    assert len([at for at in told if 0.1 < at < 2.9]) > 1
    assert told[-1] == 3.0
    assert page.stop()["end"] == "stopped"


def test_a_page_runs_what_simulate_runs(open_page, folder):
    page = open_page("servo.frb")
    page.start("run", **FAST)
    heard = page.until("over")
    ready = next(each for each in heard if each.get("news") == "ready")
    assert (ready["drawn"], ready["duration"]) == (True, pytest.approx(0.5))
    assert ready["drives"] == [{"name": "voltage", "unit": "V", "low": -24.0, "high": 24.0}]
    run = simulate(find_controller(str(folder / "servo.frb")), find_plant("motor"), duration=0.5)
    # Where many samples come at once, a point of a curve is the smallest and largest of some.
    t, low, high = [], [[], [], [], []], [[], [], [], []]
    for each in heard:
        t += each.get("t", ())
        for k, column in enumerate(each.get("low", ())):
            low[k] += column
            high[k] += each.get("high", each["low"])[k]
    first = np.searchsorted(run.time, np.array(t) - 1e-6)
    angle = run.reference[:, 0] - run.error_matrix[:, 0]
    expected = (run.reference[:, 0], angle, run.error_matrix[:, 0], run.drives["voltage"])
    for k, values in enumerate(expected):
        assert low[k] == pytest.approx(np.minimum.reduceat(values, first), rel=1e-4, abs=1e-9)
        assert high[k] == pytest.approx(np.maximum.reduceat(values, first), rel=1e-4, abs=1e-9)
    assert len(t) > 100
    metrics = next(each for each in reversed(heard) if each.get("news") == "metrics")["metrics"]
    units = ready["units"]["shaft"]
    assert (units["rms_path"], units["iae"], units["variation"]) == ("degrees", "degrees s", "V/s")
    for name, value in run.metrics["shaft"].to_dict().items():
        assert metrics["shaft"][name] == pytest.approx(value, rel=1e-4), name
    assert heard[-1]["how"] == "finished"
    assert page.stop()["end"] == "stopped"


@pytest.mark.slow
def test_a_run_stands_at_its_time_with_the_bits_of_simulate_and_goes_on(open_page, folder):
    noisy = {"noise": ["position=0.01"], "seed": "7", "duration": "", "until": "500ms"}
    page = open_page("servo.frb")
    page.start("run", **{**FAST, **noisy})
    heard = page.until("reached")
    ready = next(each for each in heard if each.get("news") == "ready")
    assert (ready["duration"], ready["window"]) == (None, pytest.approx(0.5))
    assert heard[-1]["at"] == 0.5
    metrics = next(each for each in reversed(heard) if each.get("news") == "metrics")["metrics"]
    run = simulate(
        find_controller(str(folder / "servo.frb")),
        find_plant("motor"),
        duration=0.5,
        options=Options(seed=7, sensors={"position": Sensor(noise=0.01)}),
    )
    for name, value in run.metrics["shaft"].to_dict().items():
        assert metrics["shaft"][name] == pytest.approx(value, rel=1e-4), name
    page.say(pull=[0.5, 0.0])  # a hand takes it further
    assert page.until("samples")[-1]["paused"] is False
    page.say(restart=True, pause=False, pull=None)
    assert page.until("reached")[-1]["at"] == 0.5
    page.say(pause=False)
    page.hear(lambda news: (news.get("time") or 0) > 0.6)
    assert page.stop()["end"] == "stopped"


@pytest.mark.slow
def test_a_hand_that_pushes_at_the_end_takes_a_run_further(open_page):
    page = open_page("servo.frb")
    page.start("run", **{**FAST, "duration": "", "until": "100ms", "speed": 1.0}, paused=True)
    page.until("samples")
    page.say(pull=[0.0, 0.5], pause=False)
    last = page.hear(lambda news: (news.get("time") or 0) > 0.15 or "reached" in news.values())[-1]
    assert last.get("paused") is False, last
    page.say(pull=None)  # the motor comes back while it is watched
    page.hear(lambda news: (news.get("time") or 0) > 0.3)
    assert page.stop()["end"] == "stopped"


@pytest.mark.parametrize(
    ("name", "onto_the_arm"), [("tipper", False), ("fan", False), ("pd7", True), ("servo", None)]
)
def test_a_rule_base_is_told_from_a_controller(open_page, name, onto_the_arm):
    page = open_page("servo.frb")
    page.start("plants", text=shipped(f"{name}.frb").read_text())
    found = page.hear(lambda news: "plants" in news)[-1]
    assert found["alone"] is (onto_the_arm is not None)
    fitting = {each["name"] for each in found["plants"] if not each["why"]}
    assert fitting == {None: {"motor"}, True: {"arm"}, False: set()}[onto_the_arm]


def test_a_table_says_that_it_does_not_run(open_page, folder):
    shutil.copy(shipped("thesis-6.1.lut"), folder)
    page = open_page("thesis-6.1.lut")
    page.start("plants")
    assert "a controller looks it up" in page.hear(lambda news: False)[-1]["message"]


def test_a_page_hears_which_plants_its_text_controls(open_page):
    page = open_page("heater.frb")
    page.start("plants")
    found = page.hear(lambda news: "plants" in news)[-1]
    fitting = {each["name"].rpartition("/")[2]: each for each in found["plants"] if not each["why"]}
    assert set(fitting) == {"room", "mine.py:Kiln", "mine.py:Fails"}
    assert found["chosen"] == "room"
    assert fitting["room"]["reference"] == "temperature=step:21"
    assert all("'" in each["why"] for each in found["plants"] if each["why"])


def test_only_plants_that_were_named_are_run(open_page, folder):
    page = open_page("heater.frb")
    own = folder / "mine.py"
    for name in ("none", f"{own}", f"{own}:Other", "mine.py:Kiln", "gym:CartPole-v1", "../x.fmu"):
        page.start("run", plant=name, speed=None)
        end = page.hear(lambda news: False)[-1]
        assert end["end"] == "failed", name
        assert "this designer runs no plant" in end["message"]
    page.start(
        "run", plant=f"{own}:Kiln", reference=["temperature=step:100"], duration="10min", speed=None
    )
    heard = page.until("over")
    drawing = next(each["drawing"] for each in heard if each.get("drawing"))
    assert drawing["parts"][0] == {
        "is": "line", "colour": "#ff0000", "width": 1.5, "points": drawing["parts"][0]["points"],
    }  # fmt: skip
    assert page.stop()["end"] == "stopped"


@pytest.mark.slow
def test_what_cannot_be_run_is_said(open_page, folder):
    page = open_page("servo.frb")
    for change, words in (
        ({"reference": ["position=stap:1"]}, "no reference is called 'stap'"),
        ({"reference": ["speed=step:1"]}, "no port 'speed'"),
        ({"reference": [f"position={folder.parent / 'outside.csv'}"]}, "not a file of this folder"),
        ({"reference": ["position=../outside.csv"]}, "not a file of this folder"),
        ({"disturb": ["voltage=../outside.csv"]}, "not a file of this folder"),
        ({"duration": "500"}, "takes a time with a unit"),
        ({"duration": "9h"}, "up to 2,000,000 set points"),
        ({"duration": "", "until": "9h"}, "up to 2,000,000 set points"),
        ({"duration": "", "until": "2"}, "takes a time with a unit"),
        ({"duration": "", "window": "2"}, "takes a time with a unit"),
        ({"duration": "", "window": "0s"}, "a run lasts longer than 0s"),
        ({"duration": "", "until": "0s"}, "a run lasts longer than 0s"),
        ({"duration": "0 ms"}, "a run lasts longer than 0 ms"),
        ({"noise": ["position"]}, "takes NAME=VALUE"),
        ({"plant": "tanks"}, "the tanks has no reference value 'position'"),
        ({"speed": -1}, "not understood"),
        ({"seed": "-1"}, "seed must be at least 0, not -1"),
        ({"seed": "one"}, "seed must be a whole number, not 'one'"),
    ):
        page.start("run", **{**FAST, **change})
        end = page.hear(lambda news: False)[-1]
        assert words in end["message"], end
    page.start("run", **{**FAST, "reference": ["position=way.csv"]})
    assert page.until("over")[-1]["how"] == "finished"
    page.stop()


def test_a_restart_that_does_not_work_leaves_the_run_as_it_stands(open_page):
    page = open_page("servo.frb")
    settings = {**FAST, "duration": "", "until": "100ms"}
    page.start("run", **settings)
    page.until("reached")
    page.say(restart=True, asked=of_page({**settings, "until": "nonsense"}), pause=False)
    note = page.until("note")[-1]
    assert (note["field"], "not 'nonsense'" in note["text"]) == ("duration", True)
    page.say(step=1)
    stepped = page.until("samples")[-1]
    assert (stepped["paused"], stepped["time"]) == (True, pytest.approx(0.101))
    page.say(restart=True, asked=of_page(settings), pause=False)
    assert page.until("reached")[-1]["at"] == pytest.approx(0.1)
    page.stop()


@pytest.mark.slow
def test_divergence_and_a_plant_that_fails_are_said(open_page, folder):
    page = open_page("ball-and-beam.frb")
    page.start("run", plant="ball-and-beam", reference=["position=step:1"], speed=None)
    end = page.until("over")[-1]
    assert (end["how"], end["port"], end["bound"]) == ("diverged", "position", 0.5)
    assert abs(end["value"]) > 0.5
    asked = {"plant": "ball-and-beam", "reference": ["position=step:0.1"], "duration": "1s"}
    page.say(restart=True, asked=of_page(asked), speed=None)
    assert page.until("over")[-1]["how"] == "finished"
    page.stop()
    page = open_page("heater.frb")
    page.start("run", plant=f"{folder / 'mine.py'}:Fails", duration="10min", speed=None)
    end = page.hear(lambda news: False)[-1]
    assert (end["end"], "ZeroDivisionError" in end["message"]) == ("failed", True)


def test_a_hand_pauses_steps_pushes_and_tunes(open_page):
    page = open_page("servo.frb")
    page.start("run", **{**FAST, "duration": "", "paused": True})
    first = page.until("samples")[-1]
    assert (first["paused"], first["time"]) == (True, 0.001)
    page.say(step=499)
    at_rest = page.until("samples")[-1]
    assert (at_rest["time"], at_rest["paused"]) == (0.5, True)
    assert abs(at_rest["low"][2][-1]) < 1e-3
    page.say(pull=[-0.2, 0.0])  # the pointer is at 1 rad: to the left turns it on
    page.say(step=200)
    pushed = page.until("samples")[-1]
    assert pushed["low"][1][-1] > 57.3 + 1.0
    held = pushed["low"][2][-1]
    page.say(gains={"G_u": [9.0]})
    page.say(step=400)
    stiffer = page.until("samples")[-1]["low"][2][-1]
    assert abs(stiffer) < 0.7 * abs(held)
    page.say(gains={"G_x": [9.0]})
    assert "no gain 'G_x'" in page.until("note")[-1]["text"]
    page.say(pull=None)
    page.say(step=600)
    assert abs(page.until("samples")[-1]["low"][2][-1]) < 1e-2
    page.stop()


@pytest.mark.slow
def test_a_text_is_taken_up_while_it_runs(open_page, folder):
    page = open_page("servo.frb")
    page.start("run", **{**FAST, "duration": "", "paused": True})
    page.until("ready")
    page.say(gains={"G_e": [30.0]})
    page.say(text=SERVO.replace("= 4.5", "= 9"))
    taken = page.until("text")[-1]
    assert taken["taken"]
    assert {each["name"]: each["values"] for each in taken["gains"]}["G_u"] == [9.0]
    page.say(text=SERVO.replace("period 1 ms", "period 2 ms"))
    assert page.until("text")[-1]["taken"] is False
    page.say(text=SERVO.replace("period", "peridot"))
    assert "mistakes" in page.until("note")[-1]["text"]
    page.say(restart=True)  # of a text with mistakes: what ran is still there
    assert "mistakes" in page.hear(lambda n: n.get("news") == "note" and n["text"])[-1]["text"]
    page.say(text=SERVO.replace("period 1 ms", "period 2 ms"), restart=True)
    assert [each["period"] for each in page.hear(lambda n: n.get("news") == "ready")
            if each.get("news") == "ready"] == [0.002]  # fmt: skip
    # A rule base that the controller uses is written by somebody else.
    page.until("samples")
    rules = folder / "pd7.frb"
    time.sleep(0.02)
    rules.write_text(
        rules.read_text().replace("  ZE      NB  NM  NS  ZE", "  ZE      NB  NM  NS  PS")
    )
    assert page.until("text")[-1]["taken"]
    page.stop()


def test_a_gain_of_any_sign_can_be_moved_both_ways(open_page, folder):
    text = SERVO.replace('16 "1/rad", tune 2 .. 200 log', '-16 "1/rad"')
    (folder / "signs.frb").write_text(text.replace('0.7 "s/rad", tune 0.05 .. 5 log', '0 "s/rad"'))
    page = open_page("signs.frb")
    page.start("run", **FAST)
    ready = page.until("ready")[-1]
    assert [gain["values"] for gain in ready["gains"][:2]] == [[-16.0], [0.0]]
    for gain in ready["gains"]:
        assert gain["low"] < min(gain["values"]) <= max(gain["values"]) < gain["high"], gain
    page.stop()


def test_a_rule_base_runs_on_the_arm(open_page):
    page = open_page("pd7.frb")
    page.start("run", plant="arm", trajectory="pick-and-place", payload=True, speed=None)
    heard = page.until("over")
    ready = next(each for each in heard if each.get("news") == "ready")
    assert [each["unit"] for each in ready["drives"]] == ["N m", "N m", "V", "V"]
    assert not any(each["written"] for each in ready["gains"])
    last = [each["drawing"] for each in heard if each.get("drawing")][-1]
    assert {part["colour"] for part in last["parts"]} >= {"first", "second", "wanted", "metal"}
    page.stop()


@pytest.mark.slow
def test_a_plant_of_ones_own_runs_along_its_trajectory(open_page, folder):
    crane = str(folder / "crane.py")
    page = open_page("hook.frb")
    page.start("plants")
    found = page.hear(lambda news: "plants" in news)[-1]
    (one,) = [each for each in found["plants"] if not each["why"]]
    assert (one["name"], one["trajectories"], one["shown"]) == (crane, ["lift", "swing"], "lift")
    assert (one["carries"], one["reference"], found["likely"]) == (True, "", "")
    page.start("run", plant=crane, trajectory="swing", payload=True, speed=None)
    heard = page.until("over")
    ready = next(each for each in heard if each.get("news") == "ready")
    run = simulate(str(folder / "hook.frb"), crane, trajectory="swing", payload=True)
    assert ready["duration"] == pytest.approx(run.samples * run.period)
    metrics = next(each for each in reversed(heard) if each.get("news") == "metrics")["metrics"]
    assert metrics["hook"]["rms"] == pytest.approx(run.rms[0], rel=1e-4)
    page.stop()
    page.start("run", plant=crane, trajectory="up", speed=None)
    assert "the crane has no trajectory 'up'" in page.hear(lambda news: False)[-1]["message"]


def test_a_run_that_is_stopped_leaves_no_thread(open_page):
    def jobs():
        return [each for each in threading.enumerate() if each.name == "fuzzyarm-job"]

    page = open_page("servo.frb")
    for paused in (True, False):
        page.start("run", **{**FAST, "duration": "", "speed": 1, "paused": paused})
        page.until("samples")
        assert jobs()
        assert page.stop()["end"] == "stopped"
        for _ in range(3000):
            if not jobs():
                break
            time.sleep(0.02)
        assert not jobs()


def test_the_plants_of_the_command_line_are_judged_before_it_serves(tmp_path, capsys):
    from fuzzyarm.apps.cli.main import main

    (tmp_path / "mine.py").write_text(MINE)
    words = ["designer", str(tmp_path), "--no-browser", "--plant"]
    assert main([*words, f"{tmp_path / 'mine.py'}:Kilm"]) == 1
    assert "has no plant 'Kilm'" in capsys.readouterr().err


def test_a_pull_in_the_wind_is_no_load():
    from fuzzyarm.apps.designer.stage import loads_of
    from fuzzyarm.control.loop.run import SoFar
    from fuzzyarm.plant.drawings import PlantScene
    from fuzzyarm.plant.plant import interface_of

    plant = find_plant("arm")
    at = {f"joint{k}.position": np.zeros(1) for k in (1, 2)}
    scene = PlantScene(SoFar("arm", {}, at, {}, ()), 0)
    port = interface_of(plant)
    assert loads_of(plant, scene, port, float("nan"), 0.0) == {}
    # A force along the stretched arm makes no torque; one across it the lengths times itself.
    along = loads_of(plant, scene, port, 1.0, 0.0)
    assert list(along.values()) == [0.0, 0.0]
    across = loads_of(plant, scene, port, 0.0, 1.0)
    assert across["joint1", "torque"] == pytest.approx(60.0 * (0.26 + 0.28))
    assert across["joint2", "torque"] == pytest.approx(60.0 * 0.28)


def test_signals_of_a_page_are_those_of_simulate():
    from fuzzyarm.apps.designer.forms import RUN
    from fuzzyarm.control.loop.words import motion_of, options_of

    asked = {"reference": ("position=step:2",), "duration": "1s", "seed": 3, "plant": "x"}
    words = RUN.request(asked, Path())
    motion = motion_of(words, find_controller(str(shipped("servo.frb"))), find_plant("motor"))
    assert motion.references[0][0] == 2.0
    assert options_of(words, find_plant("motor")).seed == 3
    assert Signal("step", (2.0,)).numbers == (2.0,)
