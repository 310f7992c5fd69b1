"""A file of one kind where one of another is wanted: one sentence, with what can be typed."""

import re
import shlex

import pytest
from fis import system

from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.shipped_files import shipped

RULES, TABLE, CONTROLLER = (str(shipped(n)) for n in ("pd7.frb", "thesis-6.1.lut", "servo.frb"))

FIS = (
    system("lamp", rules=1)
    + """\
[Input1]
Name='x'
Range=[0 1]
NumMFs=1
MF1='low':'trimf',[-1 0 1]

[Output1]
Name='y'
Range=[0 1]
NumMFs=1
MF1='low':'trimf',[-1 0 1]

[Rules]
1, 1 (1) : 1
"""
)

WANT_A_CONTROLLER = (
    "simulate {}",
    "simulate {} --plant motor",
    "simulate pd+{}",
    "simulate pd {}",
    "compare {} pd",
    "sweep {} --random 2 --sweep G_e=1..2",
    "learn {} --plant motor",
    "simulate {} --show-gains",
)

WANT_A_RULE_BASE = (
    "eval {} e=1 ce=1",
    "prove {} --range",
    "compile {} -o x.lut",
    "simulate fuzzy-direct --rulebase {}",
    "simulate stfc --alpha {}",
    "show {} --at e=1",
    "plot {} -o x.png --what surface",
    "plot {} -o x.png --what terms",
)


@pytest.fixture
def said(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lamp.fis").write_text(FIS)
    (tmp_path / "data.csv").write_text("e,ce,u\n1,1,1\n2,2,2\n")

    def run(words):
        status = main(shlex.split(words))
        streams = capsys.readouterr()
        assert status == 1, streams.out
        assert streams.err.count("\n") == 1, streams.err
        return streams.err

    return run


@pytest.mark.parametrize("words", WANT_A_CONTROLLER)
@pytest.mark.parametrize(
    ("file", "kind"), [(RULES, "rule base"), (TABLE, "lookup table"), ("lamp.fis", "rule base")]
)
def test_what_is_not_a_controller_says_so(words, file, kind, said):
    err = said(words.format(file))
    assert f"{file} is a {kind}, not a controller (fuzzyarm simulate fuzzy-" in err


@pytest.mark.parametrize("words", WANT_A_RULE_BASE)
def test_a_controller_says_which_rule_base_it_looks_up(words, said):
    err = said(words.format(CONTROLLER))
    assert f"{CONTROLLER} is a controller, not a rule base or a table" in err
    assert RULES in err


@pytest.mark.parametrize("file", [RULES, TABLE])
def test_the_hint_can_be_typed(file, said, capsys):
    hint = r"\(fuzzyarm (.*) runs (?:rules|a table) of e and ce on the arm;"
    words = re.search(hint, said(f"simulate {file}")).group(1)
    assert main([*shlex.split(words), "--trajectory", "reach", "--segment", "0.1"]) == 0
    assert "rms" in capsys.readouterr().out


def test_a_rule_base_with_doubts_only_says_the_same(tmp_path, said):
    text = shipped("pd7.frb").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("rulebase")]
    (tmp_path / "w.frb").write_text("\n".join([*lines, ""]), "utf-8")  # warns: no heading
    assert "not a controller" in said("simulate w.frb")


def test_a_missing_file_is_called_that(said):
    for name in ("nix.frb", "nix.lut", "nix.fis", "a+b.frb"):
        assert "No such file" in said(f"simulate {name}")


def test_a_sum_may_end_with_a_file(said, capsys):
    file = shipped("fuzzy-lut.frb")
    short = ["--trajectory", "reach", "--segment", "0.1", "--hold", "0.1"]
    assert main(["simulate", f"pd+{file}", *short, "--json"]) == 0
    first = capsys.readouterr().out
    assert main(["simulate", "pd+fuzzy-lut", *short, "--json"]) == 0
    assert (
        capsys.readouterr().out.split('"conventions"')[0].split('"trajectory"')[1]
        == (first.split('"conventions"')[0].split('"trajectory"')[1])
    )


def test_a_phase_portrait_says_where_a_controller_comes_from(said):
    words = f"plot {RULES} -o x.png --what phase --plant motor"
    assert "fuzzyarm new NAME --kind controller" in said(words)


def test_fmt_says_what_it_formats(said):
    assert f"fmt formats .frb files, which {TABLE} is not" in said(f"fmt {TABLE}")


def test_what_has_only_doubts_ends_with_a_word(tmp_path, capsys):
    """Where a rule base is wanted: a controller with a warning, and nothing else to say."""
    path = tmp_path / "doubtful.frb"
    text = shipped("servo.frb").read_text(encoding="utf-8")
    path.write_text(text.replace("axis shaft", "gain idle = 1\n\naxis shaft"), "utf-8")
    assert main(["convert", str(path), str(tmp_path / "x.fis")]) == 1
    assert "this is a controller, not a rule base" in capsys.readouterr().err
    assert main(["eval", str(path), "e=1", "ce=1"]) == 1
    assert "is a controller, not a rule base" in capsys.readouterr().err
