"""`check` of folders and of standard input; `eval --explain` where no rule fires."""

import io
import sys

import pytest

from fuzzyarm.apps.cli import main
from fuzzyarm.base.shipped_files import shipped

PD7 = shipped("pd7.frb").read_text()
HOLE = """\
rulebase t
input a 0 .. 1
input b 0 .. 1
output u 0 .. 1
terms a, b, u: triangles L M H
rules u
  a \\ b L M H
  L     L M H
  M     L . M
  H     L M H
"""


def test_a_folder_is_checked_with_the_folders_in_it(tmp_path, capsys):
    (tmp_path / "b" / "deep").mkdir(parents=True)
    (tmp_path / "a.frb").write_text(PD7)
    (tmp_path / "b" / "deep" / "c.frb").write_text(PD7.replace("PS  PM", "PX  PM", 1))
    (tmp_path / "b" / "data.csv").write_text("1,2\n")
    assert main(["check", str(tmp_path)]) == 1
    captured = capsys.readouterr()
    assert captured.out == f"{tmp_path}/a.frb: no findings\n"
    assert f"{tmp_path}/b/deep/c.frb:13:27: error[unknown-term]" in captured.err
    assert "data.csv" not in captured.out + captured.err


def test_a_folder_without_rule_bases_says_so(tmp_path, capsys):
    assert main(["check", str(tmp_path)]) == 1
    assert f"{tmp_path}: no files to check in this folder" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("data", "status", "words"),
    [
        (PD7.encode(), 0, "<stdin>: no findings"),
        (PD7.replace("PS  PM", "PX  PM", 1).encode(), 1, "<stdin>:13:27: error[unknown-term]"),
        (b"rulebase \xff", 1, "<stdin>:1:10: error[not-utf-8]"),
    ],
)
def test_a_dash_is_standard_input(data, status, words, monkeypatch, capsys):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data)))
    assert main(["check", "-"]) == status
    captured = capsys.readouterr()
    assert words in captured.out + captured.err


def test_explain_shows_the_degrees_and_the_nearest_rules_where_none_fires(tmp_path, capsys):
    (tmp_path / "t.frb").write_text(HOLE)
    assert main(["eval", str(tmp_path / "t.frb"), "a=0.5", "b=0.5", "--explain"]) == 1
    captured = capsys.readouterr()
    assert "no rule fires for 'u' at a = 0.5, b = 0.5" in captured.err
    assert "M  1.0000" in captured.out
    assert "line 8:11  if a is L and b is M then u is M" in captured.out
    assert "0.0000  a is L" in captured.out
    assert "a is H and b is H" not in captured.out, "two propositions do not hold: not near"


def test_explain_of_an_output_that_holds_nothing_shows_the_same(tmp_path, capsys):
    (tmp_path / "t.frb").write_text(HOLE + "inference no-rule hold\n")
    assert main(["eval", str(tmp_path / "t.frb"), "a=0.5", "b=0.5", "--explain"]) == 1
    assert "no rule for u fires" in capsys.readouterr().out
