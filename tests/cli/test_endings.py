"""How commands end: with a status, and with a sentence wherever that is not 0."""

import argparse
import json
import math
import shutil
import sys

import pytest
from stopped_clock import StoppedClock

from fuzzyarm.apps.cli import command, main
from fuzzyarm.apps.cli.command import Command, announced, busy, hush
from fuzzyarm.apps.cli.main import COMMANDS, ENDINGS
from fuzzyarm.base.shipped_files import shipped

DOUBTFUL = """rulebase doubtful
input e -1 .. 1
output u -1 .. 1
terms e, u: triangles N Z P
rule if e is N then u is N
rule if e is P then u is P
"""
BROKEN = DOUBTFUL.replace("u is P", "u is PP")


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "doubtful.frb").write_text(DOUBTFUL)
    (tmp_path / "broken.frb").write_text(BROKEN)
    (tmp_path / "loose.frb").write_text("rulebase   loose\n" + DOUBTFUL.split("\n", 1)[1])
    shutil.copy(shipped("heater.frb"), tmp_path)
    shutil.copy(shipped("alpha7.frb"), tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("words", "status"),
    [
        ("check broken.frb", 1),
        ("check broken.frb --json", 1),
        ("check doubtful.frb --strict", 1),
        ("check doubtful.frb --strict --json", 1),
        ("check doubtful.frb --strict --quiet", 1),
        ("check missing.frb --json", 1),
        ("fmt --check loose.frb", 1),
        ("convert doubtful.frb x.fcl --json --strict", 1),
        ("convert broken.frb x.fcl --json", 1),
        ("watch broken.frb --once", 1),
        ("watch heater.frb --once --table x.lut", 1),
        ("prove alpha7.frb --sector", 4),
        ("prove alpha7.frb --sector --json", 4),
        ("simulate acdid --start cold --payload --segment 0.2 --hold 0.1", 3),
        ("simulate acdid --start cold --payload --segment 0.2 --hold 0.1 --json", 3),
        ("diff broken.frb doubtful.frb --json", 1),
        ("sweep pd --metric=--", 2),
        ("simulate", 2),
        ("simulate pd --plant=--", 2),
        ("nothing", 2),
        ("reproduce pd --runs -1", 2),
    ],
)  # fmt: skip
def test_an_end_that_is_not_fine_is_a_sentence_on_the_standard_error(files, capsys, words, status):
    assert main(words.split()) == status
    said = capsys.readouterr().err
    assert bool(said.strip()) == (status != 0), said
    assert "Traceback" not in said


@pytest.mark.parametrize("status", ENDINGS)
def test_a_command_that_says_nothing_of_its_end_is_given_words(monkeypatch, capsys, status):
    silent = Command("check", None, lambda _arguments: status, ())
    monkeypatch.setattr(sys.modules["fuzzyarm.apps.cli.main"], "find_command", lambda _name: silent)
    assert main(["check"]) == status
    assert capsys.readouterr().err == f"fuzzyarm: {ENDINGS[status]}\n"


def test_what_json_has_no_number_for_is_null(files, capsys):
    text = DOUBTFUL.replace("output u -1 .. 1", "output u -1 .. 1\ninference u: no-rule nan")
    text += "term e Z: trapezoid -inf -inf 0 1\n"
    (files / "nan.frb").write_text(text)
    assert main(["show", "nan.frb", "--json"]) == 0
    data = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert data["outputs"][0]["no_rule"] is None
    assert data["inputs"][0]["terms"][1]["shape"]["parameters"] == ["-inf", "-inf", 0, 1]
    assert main(["eval", "nan.frb", "e=0", "--json"]) == 0
    assert json.loads(capsys.readouterr().out, parse_constant=pytest.fail) == {"u": None}
    assert main(["reproduce", "--list", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["identifier"]


# --- Long work ---


@pytest.fixture
def slow(monkeypatch):
    """A command that works longer than it may be silent."""
    monkeypatch.setattr(command, "SOON", 2.0)
    clock = StoppedClock()
    clock.put_into(command, monkeypatch)

    def run(arguments: argparse.Namespace) -> int:
        if "hush" in arguments.words:
            hush()
        if "stage" in arguments.words:
            with busy("drawing the surface"):
                clock.sleep(3)
        else:
            clock.sleep(3)
        return 1 if "fails" in arguments.words else 0

    record = Command("show", None, run, (command.argument("words", nargs="*"),))
    monkeypatch.setattr(sys.modules["fuzzyarm.apps.cli.main"], "find_command", lambda _name: record)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("x.frb", "fuzzyarm: at work on: show x.frb\n"),
        ("stage", "fuzzyarm: drawing the surface\n"),
        ("hush", ""),
        ("hush stage", ""),
        # A line of progress is no word about the end.
        ("fails", f"fuzzyarm: at work on: show fails\nfuzzyarm: {ENDINGS[1]}\n"),
    ],
)
def test_every_command_says_soon_what_it_does(slow, capsys, words, said):
    main(["show", *words.split()])
    assert capsys.readouterr().err == said


def test_a_command_that_is_quick_says_nothing_of_it(monkeypatch, capsys, files):
    monkeypatch.setattr(command, "SOON", 30.0)
    for name in COMMANDS:
        with announced(name):
            pass
    assert main(["show", "alpha7.frb"]) == 0
    assert capsys.readouterr().err == ""


def test_progress_is_not_said_where_it_is_not_wanted(capsys):
    assert math.isinf(command.SOON)  # FUZZYARM_PROGRESS=0, as in all tests
    with announced("checking"):
        pass
    assert capsys.readouterr().err == ""
