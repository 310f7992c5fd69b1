"""The views Sweep and Fit without a browser: runs and models are those of the commands."""

import csv
import json
import random
import shutil

import pytest
from test_designer_learning import Page

from fuzzyarm.apps.cli import main
from fuzzyarm.apps.designer.forms import FIT, FORMS, SWEEP
from fuzzyarm.base.protected import marked
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.language import parse

RANGES = ("G_e=4..30:4 log", "J=0.01..0.05:3")


@pytest.fixture
def page(tmp_path):
    for name in ("pd7.frb", "servo.frb", "tipper.frb", "thesis-6.1.lut"):
        shutil.copy(shipped(name), tmp_path)
    draw = random.Random(4)
    with (tmp_path / "data.csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["a", "b", "y"])
        for _ in range(60):
            a, b = draw.uniform(-2, 2), draw.uniform(0, 5)
            rows.writerow([a, b, a * a - b * a])
    return Page(tmp_path)


def result(heard):
    """Return the news that has lines."""
    (news,) = [news for news in heard if "lines" in news]
    return news


# --- Sweep ---


def test_runs_over_ranges_are_those_of_the_command(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    news = result(page.do("sweep", "servo.frb", sweep=list(RANGES), duration="0.2s"))
    words = [word for range_ in RANGES for word in ("--sweep", range_)]
    command = ["sweep", "servo.frb", "--plant", "motor", "--for", "0.2s", *words]
    assert main([*command, "-o", "runs.csv"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert news["lines"] == printed[:-1]  # the last one says what is written
    (panel,) = news["panels"]
    (cells,) = panel["parts"]
    assert (len(cells["x"]), len(cells["y"]), len(cells["values"])) == (5, 4, 12)
    assert panel["across"]["logarithmic"]
    assert [file["name"] for file in news["files"]] == ["servo-sweep.csv"]


def test_the_file_of_a_sweep_has_the_bytes_of_the_command(page, monkeypatch, capsys):
    from fuzzyarm.apps.designer.jobs import Downloads

    monkeypatch.chdir(page.folder)
    kept = {}
    monkeypatch.setattr(
        Downloads, "offer", lambda self, name, content: kept.setdefault(name, content) and name
    )
    page.do("sweep", "servo.frb", sweep=[RANGES[1]], duration="0.1s", plant="motor")
    words = ["--plant", "motor", "--for", "0.1s", "--sweep", RANGES[1], "-o", "runs.csv"]
    assert main(["sweep", "servo.frb", *words]) == 0
    capsys.readouterr()
    assert kept["servo-sweep.csv"] == (page.folder / "runs.csv").read_bytes()


def test_others_run_beside_the_open_text_as_by_the_command(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    softer = (page.folder / "servo.frb").read_text().replace("G_u  = 4.5", "G_u  = 2")
    (page.folder / "softer.frb").write_text(softer)
    asked = {"sweep": [RANGES[1]], "duration": "0.2s", "plant": "motor"}
    news = result(page.do("sweep", "servo.frb", against="softer.frb", **asked))
    command = ["sweep", "servo.frb", "softer.frb", "--plant", "motor", "--for", "0.2s"]
    assert main([*command, "--sweep", RANGES[1], "-o", "runs.csv"]) == 0
    assert news["lines"] == capsys.readouterr().out.splitlines()[:-1]
    (panel,) = news["panels"]
    labels = [part["label"] for part in panel["parts"] if part["is"] == "line"]
    assert labels == ["servo (servo.frb)", "servo (softer.frb)"]


@pytest.mark.parametrize("other", ["../servo.frb", "own.py", "nobody", "tipper.frb"])
def test_others_are_of_the_folder_or_of_the_catalogue(page, other):
    (page.folder / "own.py").write_text("raise SystemExit('executed')")
    asked = {"sweep": [RANGES[1]], "duration": "0.2s", "against": other}
    last = page.do("sweep", "servo.frb", **asked)[-1]
    assert (last["end"], last["field"]) == ("failed", "against"), last


def test_drawn_runs_have_no_map_and_of_three_ranges_the_first_two_are_drawn(page):
    drawn = result(page.do("sweep", "servo.frb", random="3", duration="0.05s"))
    assert drawn["panels"] == []
    assert "3 runs" in drawn["lines"][0]
    three = [*RANGES, "R=1..2:2"]
    (panel,) = result(page.do("sweep", "servo.frb", sweep=three, duration="0.05s"))["panels"]
    assert [panel[axis]["words"].split(",")[0] for axis in ("across", "up")] == ["G_e", "J"]


def test_what_may_be_swept_is_told(page):
    (facts, *_) = page.do("sweepable", "servo.frb")
    assert facts["gains"] == ["G_e", "G_ce", "G_u"]
    assert facts["plants"][0]["name"] == "motor"
    assert [field["name"] for field in facts["form"]] == [*SWEEP.first, *SWEEP.more]


@pytest.mark.parametrize(
    ("asked", "words", "field"),
    [
        ({}, "nothing is swept", "sweep"),
        ({"sweep": ["q=1..2:3"]}, "has 'q'", "sweep"),
        ({"sweep": ["G_e=1..2"]}, "no number of values", "sweep"),
        ({"sweep": ["nonsense"]}, "is not a range", "sweep"),
        ({"sweep": ["G_e=1..2:40000"]}, "40,000 runs are out of range here", "sweep"),
        ({"sweep": ["G_e=1..2:4"], "map": "a,b"}, "'a' is not swept", "map"),
        ({"sweep": ["G_e=1..2:4"], "metric": "rsm"}, "did you mean 'rms'", "metric"),
        ({"sweep": ["G_e=1..2:4"], "plant": "own.py"}, "runs no plant 'own.py'", "plant"),
        ({"random": "0"}, "random must be 1 to", "random"),
    ],
)
def test_what_cannot_be_swept_is_said_at_its_field(page, asked, words, field):
    last = page.do("sweep", "servo.frb", **asked)[-1]
    assert (last["end"], last["field"]) == ("failed", field), last
    assert words in last["message"]


@pytest.mark.parametrize(
    ("file", "words"),
    [
        ("thesis-6.1.lut", "a table does not run by itself"),
        ("tipper.frb", "tipper.frb is a rule base, not a controller (the view Run makes one"),
    ],
)
def test_what_does_not_run_is_not_swept(page, file, words):
    assert words in page.message("sweepable", file)


@pytest.mark.parametrize(
    "over", [{"random": "3000"}, {"sweep": ["G_e=2..60:60 log", "J=0.01..0.05:50"]}]
)
def test_a_sweep_that_is_ended_keeps_its_runs_and_its_map(page, over):
    ended = []

    def end(news):
        if "doing" in news and not ended:
            ended.append(True)
            return {"enough": True}
        return None

    heard = page.do("sweep", "servo.frb", end, **over, duration="1s")
    news = result(heard)
    lines = news["lines"]
    assert lines[-1].startswith("stopped after ")
    assert lines[-1].endswith(" of 3,000 runs")
    assert heard[-1]["end"] == "stopped"
    if "random" in over:
        assert news["panels"] == []
        return
    done = int(lines[-1].split()[2].replace(",", ""))
    cells = next(part for part in news["panels"][0]["parts"] if part["is"] == "cells")
    assert sum(value is not None for value in cells["values"]) == done
    assert cells["missing"] == "not run"


# --- Fit ---


@pytest.mark.slow
def test_a_fit_begins_with_what_is_open_and_names_no_folder(page):
    facts = page.do("fittable", "tipper.frb")[0]
    assert facts["models"][0] == "tipper.frb"
    assert "servo.frb" not in facts["models"]  # a controller is not sampled
    heard = page.do("fit", "tipper.frb", lambda news: "close" if "name" in news else None,
                    data="tipper.frb", rules="4")  # fmt: skip
    assert str(page.folder) not in json.dumps(heard)


def test_a_model_is_that_of_the_command_and_is_saved(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)

    def answer(news):
        if "name" in news:
            return {"save": "own.frb"}
        if "exists" in news:
            return {"save": "own.frb", "replace": True}
        return "close" if "saved" in news else None

    asked = {"data": "data.csv", "rules": "4", "nested": "no", "move": "no", "name": "own"}
    for again in (False, True):
        heard = page.do("fit", "servo.frb", answer, **asked)
        assert any("exists" in news for news in heard) == again
    words = ["--rules", "4", "--nested", "no", "--move", "no", "--name", "own"]
    assert main(["fit", "data.csv", *words, "-o", "other.frb"]) == 0
    own = marked("own.frb", (page.folder / "own.frb").read_bytes())
    assert own == (page.folder / "other.frb").read_bytes()
    printed = capsys.readouterr().out.splitlines()
    news = result(heard)
    assert news["lines"][1:] == printed[1:]  # the first one names the file
    titles = [panel["title"] for panel in news["panels"]]
    assert titles == ["residuals (dashed: ± RMS error)", "calibration", "firing strength"]
    assert parse((page.folder / "own.frb").read_text()).rulebase is not None


def test_a_table_is_learned_too_and_samples_judge(page):
    close = {"name": "close"}
    heard = page.do(
        "fit", "pd7.frb", lambda news: close.get("name" if "name" in news else ""),
        data="thesis-6.1.lut", rules="4", nested="no", move="no",
    )  # fmt: skip
    assert any("fidelity" in line for line in result(heard)["lines"])


def test_enough_keeps_the_best_so_far(page):
    def answer(news):
        if "doing" in news:
            return {"enough": True}
        return "close" if "name" in news else None

    lines = result(page.do("fit", "pd7.frb", answer, data="data.csv"))["lines"]
    assert lines[-1].startswith("interrupted: ")


@pytest.mark.parametrize(
    ("asked", "words", "field"),
    [
        ({}, "choose the samples", "data"),
        ({"data": "../data.csv"}, "not a file of samples in this folder", "data"),
        ({"data": "data.csv", "test": "none.csv"}, "not a file of samples", "test"),
        ({"data": "data.csv", "target": "q"}, "there is no column 'q'", "target"),
        ({"data": "data.csv", "words": "a"}, "--words takes a number", "words"),
        ({"data": "data.csv", "terms": "a"}, "--terms takes numbers", "terms"),
        ({"data": "data.csv", "terms": "2,2,2"}, "for each of 2 inputs, not 3", "terms"),
        ({"data": "data.csv", "rules": "0"}, "rules must be 1 to 1000", "rules"),
        ({"data": "data.csv", "time": "soon"}, "soon", "time"),
    ],
)
def test_what_cannot_be_learned_is_said_at_its_field(page, asked, words, field):
    last = page.do("fit", "pd7.frb", **asked)[-1]
    assert (last["end"], last["field"]) == ("failed", field), last
    assert words in last["message"]


def test_what_may_be_learned_from_is_told(page):
    head, first, *_ = (page.folder / "data.csv").read_text().splitlines(keepends=True)
    (page.folder / "a.csv").write_text(head + first)
    (facts, *_) = page.do("fittable", "pd7.frb")
    assert facts["samples"] == ["data.csv", "a.csv"]  # one learns from the largest
    last = page.do("fit", "pd7.frb", data="a.csv")[-1]
    assert (last["field"], last["message"]) == ("data", "one sample is not enough to learn from")
    assert "thesis-6.1.lut" in facts["models"]
    assert [field["name"] for field in facts["form"]] == [*FIT.first, *FIT.more]
    assert {"sweep", "fit"} <= set(FORMS)
