"""What a new user meets first: compiling with a bar, the shipped files, what is told to type."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

from fuzzyarm.apps.cli import command as commands
from fuzzyarm.apps.cli import main
from fuzzyarm.base.shipped_files import shipped, shipped_names


def words_of(out):
    """Return what stood on a terminal at any time, without its control sequences."""
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", out.getvalue()).replace("\r", "\n")


def test_what_is_soon_done_shows_nothing_where_there_is_no_terminal(capsys):
    with commands.busy("running") as tell:
        tell("still running")
    with commands.progress_bar("runs", 3) as advance:
        advance(1)
    assert capsys.readouterr() == ("", "")


def test_new_says_what_can_be_typed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "my joint's"]) == 0
    told = capsys.readouterr().out.split("see it with")[1]
    words = shlex.split(told)
    assert words == ["fuzzyarm", "watch", "my joint's.frb"]
    assert (tmp_path / words[-1]).is_file()


@pytest.mark.parametrize("name", ["", ".", "..", ".frb", "/"])
def test_new_wants_a_name(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", name]) == 1
    assert f"'{name}' is not a name for a rule base" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("kind", "plant", "reference", "settled"),
    [("pd", "motor", "position=step:1", 0.3), ("pi", "room", "temperature=step:21", 3600)],
)
def test_new_writes_a_controller_that_settles(
    kind, plant, reference, settled, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    assert main(["new", "my rules", "--kind", kind]) == 0
    assert main(["new", "sub/c", "--kind", "controller", "--around", "my rules.frb"]) == 0
    assert main(["check", "sub/c.frb"]) == 0
    assert '"../my rules.frb"' in Path("sub/c.frb").read_text()
    capsys.readouterr()
    words = ["sub/c.frb", "--plant", plant, "--reference", reference, "--json"]
    assert main(["simulate", *words]) == 0
    (metrics,) = json.loads(capsys.readouterr().out)["metrics"].values()
    assert metrics["settling"] < settled
    assert abs(metrics["final"]) < 0.01


def test_new_says_what_a_controller_cannot_be_around(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "c", "--kind", "controller"]) == 0  # around a shipped one
    assert main(["check", "c.frb"]) == 0
    for words, said in {
        ("--kind", "controller", "--around", "nix.frb"): "there is no file nix.frb",
        ("--kind", "controller", "--around", "c.frb"): "this is a controller",
        ("--kind", "controller", "--input", "e 0..1 A B"): "inputs and outputs of its rule base",
        ("--around", "c.frb"): "--around names the rules of a controller",
        ("--kind", "blank", "--input", "e 0..1 A B"): "a blank file has no variables",
    }.items():
        assert main(["new", "d", *words]) == 1
        assert said in capsys.readouterr().err
    assert not Path("d.frb").exists()
    assert main(["new", "d", "--kind", "blank"]) == 0
    assert "\nrulebase d " in Path("d.frb").read_text()


def test_shipped_lists_every_file_with_what_it_is(capsys):
    assert main(["shipped"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == shipped_names()
    assert any(re.fullmatch(r"tipper.frb +rule base +tip from the quality .*", x) for x in lines)
    assert main(["shipped", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert {row["kind"] for row in rows} == {"rule base", "controller", "table"}
    assert all(row["description"] for row in rows)


def test_shipped_copies_and_replaces_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["shipped", "pd7.frb", "tipper.frb", "-o", "."]) == 0
    assert (tmp_path / "pd7.frb").read_bytes() == shipped("pd7.frb").read_bytes()
    assert main(["check", "--strict", "pd7.frb", "tipper.frb"]) == 0
    (tmp_path / "pd7.frb").write_text("mine")
    capsys.readouterr()
    assert main(["shipped", "pd7.frb", "-o", "."]) == 1
    assert "pd7.frb already exists (--force replaces it)" in capsys.readouterr().err
    assert (tmp_path / "pd7.frb").read_text() == "mine"
    assert main(["shipped", "pd7.frb", "-o", "other.frb"]) == 0
    assert main(["shipped", "pd7.frb", "-o", ".", "--force"]) == 0
    assert (tmp_path / "pd7.frb").read_text() == (tmp_path / "other.frb").read_text()
    capsys.readouterr()
    assert main(["shipped", "tipper.frb"]) == 0
    assert capsys.readouterr().out == shipped("tipper.frb").read_text("utf-8")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["pd8.frb"], "did you mean 'pd7.frb'?"),
        (["-o", "."], "name the files to copy"),
        (["pd7.frb", "fan.frb", "-o", "x.frb"], "x.frb is not a folder, for 2 files"),
        (["pd7.frb", "-o", "no/folder/x.frb"], "no/folder"),
    ],
)
def test_shipped_says_what_is_wrong(words, told, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["shipped", *words]) == 1
    assert told in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
