"""SCL: a reader by the manual takes it, and the tests' interpreter runs what it read."""

from __future__ import annotations

from pathlib import Path

import pytest
from scl_reader import Reader
from st_programs import Program, demand_own_test
from test_plcopen import CASES

from fuzzyarm.apps.cli import main

DOUBLE = {"servo", "learning", "curved"}


def compiled(name, *words):
    double = ["--precision", "float64"] if name in DOUBLE else []
    assert main(["compile", *CASES[name], *double, *words]) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_the_self_test_passes_in_the_interpreter(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    compiled(name, "-o", "made.scl")
    demand_own_test(Program(Reader(Path("made.scl").read_text("utf-8")).text()))


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_it_is_the_structured_text_in_another_dialect(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    compiled(name, "-o", "made.st")
    compiled(name, "-o", "made.scl")
    plain = Program(Path("made.st").read_text("utf-8"))
    read = Program(Reader(Path("made.scl").read_text("utf-8")).text())
    assert list(plain.units) == [name for name in read.units if name != "made_test"]
    for key, unit in plain.units.items():
        other = read.units[key]
        assert len(unit.inputs) == len(other.inputs)
        assert unit.outputs == other.outputs
        if unit.sort != "FUNCTION":  # a function copies the inputs that it writes to
            assert unit.code.co_consts[0].co_consts == other.code.co_consts[0].co_consts


WORDS = """rulebase words
input  begin 0 .. 1
input  region 0 .. 1
output version 0 .. 1
terms begin, region: triangles N P
term version L: singleton 0
term version H: singleton 1
rules version
  begin \\ region  N P
  N                L H
  P                H L
"""


def test_names_that_are_words_of_scl_stand_in_quotation_marks(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("words.frb").write_text(WORDS)
    assert main(["compile", "words.frb", "-o", "words.scl"]) == 0
    text = Path("words.scl").read_text("utf-8")
    assert '"begin" : Real;' in text
    assert '#"region"' in text
    Reader(text).text()


def test_what_scl_lacks_is_said(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("steep.frb").write_text(
        "rulebase steep\ninput x 1 .. 2\noutput y 0 .. 1\nterm x A: triangle 1 1.5 2\n"
        'term y B: formula "log10(x)"\ninference defuzzifier weighted-average, no-rule 0\n'
        "rule if x is A then y is B\n"
    )
    assert main(["compile", "steep.frb", "-o", "steep.scl"]) == 1
    assert "SCL has no function for 'LOG'" in capsys.readouterr().err
    assert not Path("steep.scl").exists()
