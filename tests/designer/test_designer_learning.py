"""Learning and tuning from a page have the bits of the commands; what does not fit is said."""

import asyncio
import json
import multiprocessing
import os
import shutil

import numpy as np
import pytest
from crane import write_crane

from fuzzyarm.apps.cli import main
from fuzzyarm.apps.designer import requests
from fuzzyarm.apps.designer.changes import applied
from fuzzyarm.apps.designer.folder import Workspace
from fuzzyarm.apps.designer.jobs import WindowJob
from fuzzyarm.apps.designer.open_files import WORKS
from fuzzyarm.apps.designer.records import read_record
from fuzzyarm.apps.designer.shared import SharedText
from fuzzyarm.apps.designer.stage import Plants
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.protected import marked
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.language.edit import ReshapeError, add_tuning, apply_edits, read, set_ranges
from fuzzyarm.learning.tuning.design import Design, default_ranges, everything
from fuzzyarm.plant.equations import traced
from fuzzyarm.table import read_table

SOC = """\
controller servo-soc "self-organising control of a shaft"

use F from "zero"
use P from "performance-yamazaki.lut"

period 1 ms

gain G_e  = 160 "1/rad"
gain G_ce = 4 "s/rad"
gain G_u  = 4 "V"

axis shaft
  e  = error of position * G_e
  ce = error of velocity * G_ce
  learn F by P(e, ce), delay 1, rate 0.05, bound 6
  u  = table F(e, ce) * G_u
  drive voltage = u, within -24 .. 24
"""
SINE = "position=sine:0.5,1"
ROOM = {"reference": "temperature=step:20", "duration": "900s", "unseen": 2, "linear": False}


OWN = """\
from fuzzyarm.plant import Parameter
from fuzzyarm.plant.library import Motor

class Shaft(Motor):
    name = "heavy"
    parameters = {**Motor.parameters, "J": Parameter(0.02, "kg m²", "inertia")}
"""


class Page:
    """What a window would be: it hears work, and answers."""

    def __init__(self, folder):
        self.folder, self.own = folder, ()
        self.heard = []

    def do(self, what, file, answer=lambda _news: None, **asked):
        """Have work done; `answer` returns what is said to a piece of news, or "close"."""
        path = self.folder / file
        self.heard = []

        async def tell(message):
            self.heard.append(message)
            said = None if "end" in message else answer(message)
            if said == "close":
                job.stop()
            elif said is not None:
                job.hear(said)

        async def run():
            session = Session(str(path), path.read_text(), 0)
            own = {name: asked[name] for name in ("step", "speed", "certificate") if name in asked}
            form = {name: value for name, value in asked.items() if name not in own}
            record = read_record(requests.WORKS[what], {**own, "form": form})
            await asyncio.wait_for(job.run(WORKS[what], session, record), 60)

        async def begin():
            nonlocal job
            job = WindowJob(1, tell, Workspace(self.folder), plants=lambda: Plants(self.own))
            await run()

        job = None
        asyncio.run(begin())
        return self.heard

    def message(self, what, file, **asked):
        """Return the sentence with which work fails."""
        last = self.do(what, file, **asked)[-1]
        assert last["end"] == "failed", last
        return last["message"]


@pytest.fixture
def page(tmp_path):
    (tmp_path / "servo-soc.frb").write_text(SOC)
    (tmp_path / "broken.frb").write_text(SOC.replace("axis shaft", "axes shaft"))
    for name in ("heater.frb", "roompi.frb", "pd7.frb", "servo.frb", "thesis-6.1.lut"):
        shutil.copy(shipped(name), tmp_path)
    return Page(tmp_path)


# --- learning ---


@pytest.mark.slow
def test_a_table_that_was_watched_has_the_bytes_of_the_command(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    modes = []

    def answer(news):
        if "mode" in news:
            modes.append(news["mode"])
            if news["mode"] == "stop":
                return {"save": "page.lut"}
            if news["mode"] == "pause":
                return {"go": "stop"} if news["pass"] == 2 else {"go": "step"}
            return {"go": "pause"} if len(modes) == 3 else None
        return "close" if "saved" in news else None

    heard = page.do("learn", "servo-soc.frb", answer, reference=SINE, passes=1)
    assert heard[-1]["end"] == "stopped"
    assert modes[3] == "pause"
    assert modes[-1] == "stop"
    states = [news for news in heard if "mode" in news]
    grown = [news["tables"][0]["visited"] for news in states]
    assert grown == sorted(grown)
    assert len(states) > 40  # a picture now and then, not one for each pass
    assert sum(len(news["errors"]) for news in states) == 2
    words = ["learn", "servo-soc.frb", "--plant", "motor", "--reference", SINE]
    assert main([*words, "--passes", "2", "-o", "command.lut"]) == 0
    capsys.readouterr()
    assert (page.folder / "page.lut").read_bytes() == (page.folder / "command.lut").read_bytes()
    last = states[-1]["tables"][0]
    table = read_table(page.folder / "page.lut")
    np.testing.assert_array_equal(table.values.ravel(), last["values"])
    never = [visits == 0 for visits in last["visits"]]
    assert sum(never) == last["never_visited"]
    # A cell that was used may have learned a zero.
    assert any(v == 0 and not n for v, n in zip(last["values"], never, strict=True))


def test_shipped_soc_runs_on_the_arm_and_saving_asks(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    (page.folder / "there.lut").write_text("mine")
    names = iter(("../out.lut", "out.frb", "there.lut"))

    def answer(news):
        if news.get("mode") == "pause" or "unsaved" in news:
            return {"save": next(names)}
        if "exists" in news:
            assert (page.folder / "there.lut").read_text() == "mine"
            return {"save": "there.lut", "replace": True}
        return "close" if "saved" in news else None

    asked = {"controller": "soc-zero", "trajectory": "pick-and-place", "payload": True}
    heard = page.do("learn", "pd7.frb", answer, **asked, passes=1, speed="fast")
    assert [news["unsaved"] for news in heard if "unsaved" in news] == [
        "'../out.lut' is not the name of a file in this folder",
        "the name must end with .lut, as in out.lut",
    ]
    words = ["learn", "soc-zero", "--trajectory", "pick-and-place", "--payload"]
    assert main([*words, "-o", "command.lut"]) == 0
    capsys.readouterr()
    assert (page.folder / "there.lut").read_bytes() == (page.folder / "command.lut").read_bytes()
    with pytest.raises(ValueError, match="one file open"):
        Workspace(page.folder / "pd7.frb").beside("x.lut", ".lut")


def test_what_cannot_learn_is_said(page):
    facts = page.do("learnable", "servo-soc.frb")[0]
    assert facts["own"]
    assert facts["texts"][0]["plants"] == [
        {"name": "motor", "fits": True, "trajectories": [], "shown": "", "carries": False,
         "reference": "position=step:1"}
    ]  # fmt: skip
    soc = next(each for each in facts["texts"] if each["name"] == "soc-zero")["plants"][0]
    assert soc == {
        "name": "arm", "fits": True, "trajectories": ["reach-return", "pick-and-place", "reach"],
        "shown": "pick-and-place", "carries": True, "reference": "",
    }  # fmt: skip
    room = page.do("tunable", "heater.frb")[0]["plants"][0]
    assert room["reference"] == "temperature=step:21"  # as Run offers it
    assert not page.do("learnable", "thesis-6.1.lut")[0]["own"]
    for file, asked, words in (
        ("heater.frb", {}, "has no table that learns"),
        ("thesis-6.1.lut", {}, "a table does not learn by itself"),
        ("broken.frb", {}, "axes"),
        ("servo-soc.frb", {"plant": "own.py:Plant"}, "runs no plant 'own.py:Plant'"),
        ("servo-soc.frb", {"plant": "room"}, "the room has no reference value"),
        ("servo-soc.frb", {"reference": "position=/etc/x.csv"}, "is not a file of this folder"),
        ("servo-soc.frb", {"passes": 1e9}, "passes must be 1 to 10000"),
        ("servo-soc.frb", {"rate": 11}, "rate must be 0 to 10, not 11"),
        ("servo-soc.frb", {"begin": "../x.lut"}, "is not a table of this folder"),
        ("servo-soc.frb", {"controller": "ct"}, "is not a shipped controller"),
        ("servo-soc.frb", {"passes": "[1]"}, "passes must be a whole number, not '[1]'"),
        ("servo-soc.frb", {"rate": "<b>"}, "rate must be a number, not '<b>'"),
    ):
        assert words in page.message("learn", file, **asked), (file, asked)


# --- tuning ---


@pytest.mark.slow
def test_tuned_in_a_page_the_text_is_that_of_the_command(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)

    def answer(news):
        return {"take": True} if "report" in news else "close" if "taken" in news else None

    given = {"cost": "rms + overshoot", "evals": 12, "seed": 3, "scenarios": 2, "digits": 4}
    given |= {"noise": ["temperature=0.02"], "vary": "P=1500..2500 outside=-5..5"}
    given |= {"connect": ["temperature=room.temperature"], "quantise": ["temperature=0.01"]}
    heard = page.do("tune", "heater.frb", answer, **given, **ROOM)
    report = next(news["report"] for news in heard if "report" in news)
    taken = next(news["taken"] for news in heard if "taken" in news)
    words = ["tune", "heater.frb", "--reference", "temperature=step:20", "--for", "900s"]
    words += ["--cost", "rms + overshoot", "--evals", "12", "--seed", "3", "--unseen", "2"]
    words += ["--scenarios", "2", "--digits", "4", "--noise", "temperature=0.02"]
    words += ["--vary", "P=1500..2500", "--vary", "outside=-5..5"]
    words += ["--connect", "temperature=room.temperature", "--quantise", "temperature=0.01"]
    assert main([*words, "--no-linear", "-o", "command.frb"]) == 0
    assert report["claim"] in capsys.readouterr().out
    written = (page.folder / "command.frb").read_bytes()
    assert marked("command.frb", taken["new"].encode()) == written
    assert taken["written"] == []
    # Every candidate is told once, and where the best of them lies between its bounds.
    told = [news for news in heard if news.get("phase") == "search"]
    assert told[-1]["count"] == report["trials"] == 12
    panel = [news["panel"] for news in heard if "panel" in news][-1]
    dots, line = panel["parts"]
    assert (dots["is"], line["is"], line["steps"]) == ("dots", "line", True)
    assert line["y"][-1] == pytest.approx(report["curve"][-1])
    assert len(dots["x"]) <= 12
    assert told[-1]["best"] == report["curve"][-1]
    assert len(told[-1]["best_shares"]) == len(heard[0]["moving"]) == 3
    # It becomes one change of the text as it is meanwhile.
    shared = SharedText(page.folder / "heater.frb")
    shared.replace(shared.text + "# typed meanwhile\n", "x")
    edit = shared.answer({"what": "merge", "old": taken["old"], "new": taken["new"]})
    assert applied(shared.text, edit["changes"]) == taken["new"] + "# typed meanwhile\n"
    shared.replace(shared.text.replace("G_du = 0.4", "G_du = 0.5"), "x")
    edit = shared.answer({"what": "merge", "old": taken["old"], "new": taken["new"]})
    assert "same lines" in edit["error"]


@pytest.mark.slow
def test_a_search_that_is_stopped_keeps_the_best(page):
    def answer(news):
        if news.get("phase") == "search" and news["count"] > 4:
            return {"enough": True}
        return "close" if "report" in news else None

    heard = page.do("tune", "heater.frb", answer, evals=90_000, **{**ROOM, "linear": True})
    report = next(news["report"] for news in heard if "report" in news)
    assert report["interrupted"]
    assert report["trials"] < 90_000
    assert "linear PD" not in report["rows"]  # to beat half an opponent would say nothing
    tuned, file = (report["rows"][name]["train"]["cost"] for name in ("tuned", "as in the file"))
    assert tuned <= file
    assert tuned == pytest.approx(report["curve"][-1], rel=0.02)
    # A window that goes ends the search, wherever it is.
    children = []

    def close(news):
        if not news.get("phase"):
            return None
        children.extend(each.pid for each in multiprocessing.active_children())
        return "close"

    assert page.do("tune", "heater.frb", close, evals=90_000, **ROOM)[-1]["end"] == "stopped"
    assert children
    assert os.getpid() not in children
    assert multiprocessing.active_children() == []


@pytest.mark.slow
def test_rule_bases_of_other_files_are_written_beside(page):
    (page.folder / "servo-pd7.frb").write_text("mine")

    def answer(news):
        if "report" in news:
            return {"take": True}
        if "exists" in news:
            return {"take": True, "replace": True}
        return "close" if "taken" in news else None

    asked = {"tune": ["peaks e mirrored, keep order"], "duration": "0.3s", "evals": 6, "unseen": 0}
    heard = page.do("tune", "servo.frb", answer, **asked, linear=False)
    assert any(news.get("exists") == ["servo-pd7.frb"] for news in heard)
    taken = next(news["taken"] for news in heard if "taken" in news)
    assert taken["new"] == taken["old"].replace('"pd7.frb"', '"servo-pd7.frb"')
    written = (page.folder / "servo-pd7.frb").read_text()
    assert written.count("# tuned: ") >= 3
    assert main(["check", str(page.folder / "servo-pd7.frb")]) == 0
    assert (page.folder / "pd7.frb").read_text() == shipped("pd7.frb").read_text()


@pytest.mark.slow
def test_a_plant_of_ones_own_offers_its_trajectories(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    write_crane(page.folder)
    page.own = ("crane.py",)
    facts = page.do("tunable", "hook.frb")[0]
    crane = next(each for each in facts["plants"] if each["name"] == "crane.py")
    assert crane == {
        "name": "crane.py", "fits": True, "trajectories": ["lift", "swing"], "shown": "lift",
        "carries": True, "reference": "",
    }  # fmt: skip

    def take(news):
        return {"take": True} if "report" in news else "close" if "taken" in news else None

    asked = {"plant": "crane.py", "trajectory": "swing", "evals": 3, "unseen": 2, "linear": False}
    heard = page.do("tune", "hook.frb", take, **asked, payload=True)
    report = next(news["report"] for news in heard if "report" in news)
    words = ["--plant", "crane.py", "--trajectory", "swing", "--evals", "3", "--unseen", "2"]
    capsys.readouterr()
    assert main(["tune", "hook.frb", *words, "--no-linear", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert report["scenarios"] == told["scenarios"] == ["swing"]
    assert report["rows"] == told["rows"]


@pytest.mark.slow
def test_a_plant_that_was_named_is_learned_and_tuned_on(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    (page.folder / "own.py").write_text(OWN)
    asked = {"plant": "own.py:Shaft", "reference": SINE}
    assert "runs no plant" in page.message("tune", "servo.frb", **asked)
    page.own = ("own.py:Shaft",)
    for what in ("learnable", "tunable"):
        facts = page.do(what, "servo-soc.frb")[0]
        offered = facts["plants"] if what == "tunable" else facts["texts"][0]["plants"]
        assert [each["name"] for each in offered if each["fits"]] == ["motor", "own.py:Shaft"]

    def answer(news):
        if news.get("mode") == "pause":
            return {"save": "page.lut"}
        return "close" if "saved" in news else None

    page.do("learn", "servo-soc.frb", answer, **asked, passes=1, speed="fast")
    words = ["--plant", "own.py:Shaft", "--reference", SINE]
    assert main(["learn", "servo-soc.frb", *words, "--passes", "1", "-o", "command.lut"]) == 0
    assert (page.folder / "page.lut").read_bytes() == (page.folder / "command.lut").read_bytes()

    def take(news):
        return {"take": True} if "report" in news else "close" if "taken" in news else None

    tuned = {"tune": ["gain G_e 0.5 .. 2 times"], "duration": "0.3s", "evals": 3, "unseen": 1}
    heard = page.do("tune", "servo-soc.frb", take, **asked, **tuned)
    taken = next(news["taken"] for news in heard if "taken" in news)
    words += ["--tune", "gain G_e 0.5 .. 2 times", "--for", "300ms", "--evals", "3"]
    words += ["--unseen", "1", "-o", "command.frb"]
    assert main(["tune", "servo-soc.frb", *words]) == 0
    capsys.readouterr()
    written = (page.folder / "command.frb").read_bytes()
    assert marked("command.frb", taken["new"].encode()) == written


def test_a_mistake_is_said_at_its_field(page):
    for asked, field in (
        ({"noise": "temperature"}, "noise"),
        ({"noise": "foo=1"}, "noise"),
        ({"actuator": ["power=1"]}, "actuator"),
        ({"disturb": "power=/x.csv"}, "disturb"),
        ({"vary": "P"}, "vary"),
        ({"cost": "nothing +"}, "cost"),
        ({"tune": ["peaks"]}, "tune"),
        ({"time": "10"}, "time"),
        ({"plant": "none"}, ""),
    ):
        last = page.do("tune", "heater.frb", **asked)[-1]
        assert (last["end"], last["field"]) == ("failed", field), (asked, last)


def test_what_cannot_be_tuned_is_said(page):
    for file, asked, words in (
        ("thesis-6.1.lut", {}, "a table is not tuned"),
        ("broken.frb", {}, "axes"),
        ("pd7.frb", {}, "nothing says what is good"),
        ("pd7.frb", {"data": "../x.csv"}, "is not a file of samples"),
        ("heater.frb", {"cost": "x.py:f"}, "on the command line alone"),
        ("heater.frb", {"plant": "x.fmu"}, "runs no plant 'x.fmu'"),
        ("heater.frb", {"reference": "20"}, "--reference takes NAME=VALUE, not '20'"),
        ("heater.frb", {"reference": "temperature=x"}, "'x' is not a signal"),
        ("heater.frb", {"evals": 1.5}, "evals must be a whole number, not 1.5"),
        ("heater.frb", {"tune": ["peaks"]}, "expected the name of a variable"),
    ):
        assert words in page.message("tune", file, **asked), (file, asked)
    assert "a table is not tuned" in page.message("tunable", "thesis-6.1.lut")
    assert "has mistakes" in page.message("tunable", "broken.frb")
    facts = page.do("tunable", "pd7.frb")[0]
    assert (facts["loop"], facts["says"], facts["samples"]) == (False, False, [])
    assert page.do("tunable", "heater.frb")[0]["says"]


@pytest.mark.parametrize("name", ["pd7.frb", "tipper.frb", "alpha7.frb"])
def test_what_moves_where_nothing_is_said_can_be_written_into_the_text(name):
    text = shipped(name).read_text()
    before = read(text)
    after = read(apply_edits(text, add_tuning(before, everything(before.model))))
    assert [each.message for each in after.parsed.diagnostics] == []
    assert Design(after.model).parameters == Design(before.model).parameters
    assert after.text.startswith(text.rstrip("\n"))
    with pytest.raises(ReshapeError, match="already"):
        add_tuning(after, everything(before.model))


def test_gains_get_ranges_and_keep_those_that_they_have(page):
    reading = read(SOC.replace('gain G_u  = 4 "V"', 'gain G_u  = 4 "V", tune 1 .. 10 log  # mine'))
    ranges = default_ranges(reading.parsed.controller)
    assert ranges == {"G_e": (32.0, 800.0), "G_ce": (0.8, 20.0)}
    after = apply_edits(reading.text, set_ranges(reading, ranges))
    assert 'gain G_e  = 160 "1/rad", tune 32 .. 800 log\n' in after
    assert 'gain G_u  = 4 "V", tune 1 .. 10 log  # mine\n' in after
    shared = SharedText(page.folder / "servo-soc.frb")
    assert len(shared.answer({"what": "movable"})["edits"]) == 3
    assert (
        "table" in SharedText(page.folder / "thesis-6.1.lut").answer({"what": "movable"})["error"]
    )


PLAIN = """\
import multiprocessing
import os

from fuzzyarm.plant import Parameter, Plant, Port

class Kiln(Plant):
    axis = "room"
    inputs = {"power": Port("%", 0, 100)}
    outputs = {"temperature": Port("°C", -50, 100)}
    states = {"T": "°C"}
    parameters = {"loss": Parameter(0.001, "1/s", "heat lost through the wall")}
    duration = 300.0

    def start(self, rng):
        return [15.0]

    def derivative(self, t, x, u, p):
        if x[0] > 80.0:  # a branch on the state: not an expression of symbols
            return [-0.01 * (x[0] - 10.0)]
        return [0.002 * u[0] - p[0] * (x[0] - 10.0)]

class Breaks(Kiln):
    def derivative(self, t, x, u, p):
        rates = super().derivative(t, x, u, p)
        if p[0] != 0.001 and multiprocessing.parent_process() is not None:
            os._exit(9)  # as a library might that is loaded into the process
        return rates
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["Kiln", "Breaks"])
def test_on_a_plant_in_plain_python_the_result_is_kept_whatever_follows(page, name, monkeypatch):
    monkeypatch.chdir(page.folder)
    (page.folder / "own.py").write_text(PLAIN)
    page.own = (f"own.py:{name}",)
    assert traced(Plants(page.own).new(f"own.py:{name}")) is None  # it runs as plain Python

    def take(news):
        return {"take": True} if "report" in news else "close" if "taken" in news else None

    asked = {"plant": f"own.py:{name}", "reference": "temperature=step:20", "evals": 8, "unseen": 1}
    asked["vary"] = "loss=0.002..0.003"  # in unseen scenarios; the search has the plant as it is
    heard = page.do("tune", "heater.frb", take, **asked)
    report = next(news["report"] for news in heard if "report" in news)
    assert report["trials"] == 8
    if name == "Kiln":
        assert report["faults"] == []
        assert set(report["rows"]) == {"as in the file", "tuned", "linear PD"}
    else:
        assert report["faults"] == ["its process has ended unexpectedly"]
    taken = next(news["taken"] for news in heard if "taken" in news)
    assert "# tuned: nelder-mead, 8 evaluations" in taken["new"]
