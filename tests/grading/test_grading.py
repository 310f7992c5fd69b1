"""Assignments: the shipped ones pass, and whatever is handed in is a row."""

from __future__ import annotations

import csv
import io
import json
import shutil
from pathlib import Path

import pytest

from fuzzyarm.apps.cli import main
from fuzzyarm.apps.grading import GradingError, grade, read_assignment

ASSIGNMENTS = Path(__file__).parents[2] / "examples" / "assignments"
SHIPPED = sorted(path.name for path in ASSIGNMENTS.iterdir() if path.is_dir())


@pytest.fixture
def fan(tmp_path):
    return Path(shutil.copytree(ASSIGNMENTS / "fan", tmp_path / "fan"))


@pytest.mark.parametrize("name", SHIPPED)
def test_a_model_answer_gets_every_point(name, tmp_path):
    """`read_assignment` refuses one that does not; an empty answer gets none of them."""
    folder = Path(shutil.copytree(ASSIGNMENTS / name, tmp_path / name))
    for old in (folder / "submissions").iterdir():
        old.unlink()
    shutil.copy(folder / "model.frb", folder / "submissions" / "model.frb")
    (row,) = grade(read_assignment(folder))
    assert row.points == read_assignment(folder).points >= 9
    assert (folder / "task.md").is_file()


def test_who_passes_what(capsys):
    assert main(["grade", str(ASSIGNMENTS / "fan")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "1. nearly off when cold and dry (1 point)"
    table = {line.split()[0]: line.split()[1:] for line in lines[8:]}
    assert table["ada"] == ["9/9", *["yes"] * 6]
    assert table["bea"] == ["7/9", *["yes"] * 5, "no"]
    assert "  line 6: " in lines[-1]
    assert lines[-1].endswith("'OF'")


def test_reasons_are_points_that_can_be_tried(capsys):
    assert main(["grade", "--reasons", str(ASSIGNMENTS / "fan")]) == 0
    assert "bea 6: expect temp = " in capsys.readouterr().out


HOSTILE = {
    "empty": b"",
    "bytes": bytes(range(256)),
    "utf16": "rulebase x".encode("utf-16"),
    "nested": b"rulebase x\ninput temp 10 .. 40\noutput speed 0 .. 1\nrule if "
    + b"(" * 20_000
    + b"\n",
    "open-quote": b'rulebase x "\ninput temp 10 .. 40\n',
    "large": b"# \n" * 100_000,
    "own-lines": b"rulebase x\ninput temp 10 .. 40\ninput damp 20 .. 100\noutput speed 0 .. 100\n"
    b"terms temp, damp: triangles A B\nterms speed: singletons C D\n"
    b"rule if temp is A then speed is C\nexpect temp = 10, damp = 20 -> speed < 15\n",
    "formula": b"rulebase x\ninput temp 10 .. 40\ninput damp 20 .. 100\noutput speed 0 .. 100\n"
    b"term temp A: formula \"__import__('os').system('touch ran')\"\n"
    b"term speed C: singleton 1\nrule if temp is A then speed is C\n",
    "controller": b'controller x\nuse F from "/etc/passwd"\n',
    "=HYPERLINK(1)": b"nothing",
}


@pytest.mark.slow
def test_broken_and_hostile_submissions_are_rows(fan, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    for name, data in HOSTILE.items():
        (fan / "submissions" / f"{name}.frb").write_bytes(data)
    (fan / "submissions" / "notes.txt").write_text("I was ill")
    (fan / "submissions" / "folder.frb").mkdir()
    (fan / "submissions" / "link.frb").symlink_to(fan / "model.frb")
    rows = {row.name: row for row in grade(read_assignment(fan))}
    assert set(HOSTILE) <= set(rows)
    assert rows["ada"].points == 9
    for name in [*HOSTILE, "notes", "folder", "link"]:
        row = rows[name]
        assert row.points < 9, name
        assert bool(row.fault) != bool(row.results), name
        assert "\n" not in row.fault
    assert rows["link"].fault == "not a file of its own: a link, a folder or a device"
    assert rows["notes"].fault == "not a .frb file: 'notes.txt'"
    assert not (tmp_path / "ran").exists()
    # A student's own expect line stands for nothing.
    assert [result.verdict for result in rows["own-lines"].results][3:] != ["passed"] * 3
    assert main(["grade", str(fan), "--csv"]) == 0
    table = list(csv.reader(io.StringIO(capsys.readouterr().out)))
    assert len(table) == 1 + len(rows)
    assert {len(row) for row in table} == {len(table[0])}
    assert "'=HYPERLINK(1)" in {row[0] for row in table}
    assert main(["grade", str(fan), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["submissions"]) == len(rows)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            lambda f: (f / "hidden.frb").unlink(),
            "hidden.frb with expect and prove lines",
        ),
        (lambda f: (f / "hidden.frb").write_text("# none\n"), "neither an expect line nor a prove"),
        (lambda f: (f / "hidden.frb").write_text("import os\n"), "hidden.frb:1: a line is expect"),
        (lambda f: (f / "hidden.frb").write_bytes(b"\xff\xfe\x00"), "cannot be read"),
        (lambda f: shutil.rmtree(f / "submissions"), "the folder submissions is missing"),
        (lambda f: (f / "model.frb").write_text("rulebase"), "the answer cannot be read"),
        (lambda f: shutil.copy(f / "submissions" / "bea.frb", f / "model.frb"), "does not pass"),
    ],
)
def test_an_assignment_with_a_broken_file_is_one_sentence(fan, capsys, change, sentence):
    change(fan)
    with pytest.raises(GradingError):
        read_assignment(fan)
    assert main(["grade", str(fan)]) == 1
    said = capsys.readouterr()
    assert sentence in said.err
    assert said.err.count("\n") == 1
    assert said.out == ""


def test_a_folder_that_is_not_there(capsys):
    assert main(["grade", "nowhere"]) == 1
    assert capsys.readouterr().err == "fuzzyarm: nowhere is not a folder\n"
