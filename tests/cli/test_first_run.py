"""What a new user meets first: compiling with a bar, the shipped files, what is told to type."""

from __future__ import annotations

import io
import json
import re
import shlex

import pytest

from fuzzyarm.cli import command as commands
from fuzzyarm.cli import main
from fuzzyarm.machine_code import Compiling
from fuzzyarm.shipped_files import shipped, shipped_names


def words_of(out):
    """Return what stood on a terminal at any time, without its control sequences."""
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", out.getvalue()).replace("\r", "\n")


def display_on(out):
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    console = Console(file=out, force_terminal=True, width=100, color_system=None)
    columns = (TextColumn("{task.description}"), BarColumn(20), TextColumn("{task.percentage:.0f}"))
    return Progress(*columns, console=console, transient=True, auto_refresh=False)


def test_compiling_is_told_with_a_bar_that_goes_away(monkeypatch):
    out = io.StringIO()
    monkeypatch.setattr(commands, "_display", lambda: display_on(out))
    bar = commands.CompilingBar()
    for done in range(5):
        bar.show(Compiling(f"part_{done}", done, 4))
        bar._display.refresh()
    bar.show(None)
    told = words_of(out)
    assert "compiling machine code, once on this machine: part_0" in told
    shares = [int(x) for x in re.findall(r"(\d+)\s*$", told, re.MULTILINE)]
    assert shares[0] == 0
    assert 75 in shares
    assert max(shares) < 100  # more functions than there were to be: the bar is not full
    assert told.rstrip().splitlines()[-1].count("compiling") <= 1
    bar.show(None)  # nothing was begun


def test_within_other_work_the_bar_is_part_of_its_display():
    out = io.StringIO()
    with display_on(out) as display:
        display.add_task("running pd", total=None)
        bar = commands.CompilingBar(display)
        bar.show(Compiling("run_loop", 0, 0))
        display.refresh()
        assert [task.description for task in display.tasks][1].endswith("run_loop")
        bar.show(None)
        assert len(display.tasks) == 1


def test_nothing_is_shown_of_short_work_where_there_is_no_terminal(capsys):
    with commands.busy("running") as tell:
        tell("further")
    with commands.progress_bar("runs", 3) as advance:
        advance(1)
    assert capsys.readouterr() == ("", "")


def test_new_says_what_can_be_typed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "my joint's"]) == 0
    told = capsys.readouterr().out.split("see it with")[1]
    words = shlex.split(told)
    assert words == ["fuzzyarm", "studio", "my joint's.frb"]
    assert (tmp_path / words[-1]).is_file()


@pytest.mark.parametrize("name", ["", ".", "..", ".frb", "/"])
def test_new_wants_a_name(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", name]) == 1
    assert f"'{name}' is not a name for a rule base" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


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
    assert "pd7.frb is there already (--force replaces it)" in capsys.readouterr().err
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
