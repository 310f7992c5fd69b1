"""eval, show, plot, compile and diff as they are called."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from fuzzyarm.apps.cli import main
from fuzzyarm.inference import infer
from fuzzyarm.language import load_rulebase
from fuzzyarm.table import LookupTable, read_table, write_table

RULEBASES = Path(__file__).parents[2] / "rulebases"
PD7 = str(RULEBASES / "pd7.frb")
TABLE = str(RULEBASES / "thesis-6.1.lut")


@pytest.fixture
def frb(tmp_path, lopsided_text):
    path = tmp_path / "lopsided.frb"
    path.write_text(lopsided_text, "utf-8")
    return str(path)


def said(capsys) -> str:
    return capsys.readouterr().out


def complaint(capsys, *words: str, status: int = 1) -> str:
    """Return the one line on the error stream of a call that must fail."""
    assert main(words) == status
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert "Traceback" not in err
    return err


def test_eval_prints_every_output(capsys, frb):
    expected = infer(load_rulebase(frb), a=3.5, b=0.25)
    assert main(["eval", frb, "a=3.5", "b=0.25", "--json"]) == 0
    assert json.loads(said(capsys)) == expected
    assert main(["eval", frb, "b=.25,a=35e-1"]) == 0
    assert said(capsys) == f"y = {expected['y']!r}\n"


def test_eval_of_a_table(capsys):
    assert main(["eval", TABLE, "e=1.3", "ce=-2.2", "--json"]) == 0
    assert said(capsys) == '{"u": 2.5}\n'
    assert main(["eval", TABLE, "e=1.3", "ce=-2.2", "--mode", "nearest", "--explain"]) == 0
    text = said(capsys)
    assert "e = 1.3: level 1 (index 7), 0.5 < e <= 1.5" in text
    assert text.endswith("u = 1.9\n") is False  # ce = -2.2 is nearest to -2
    assert text.endswith("u = 1.8\n")


def test_the_defuzzifier_of_the_command_line_wins(capsys):
    from dataclasses import replace

    from fuzzyarm.language.model.rulebase import Defuzzifier

    rulebase = load_rulebase(PD7)
    assert main(["eval", PD7, "e=1.3", "ce=-2.2", "--json", "--defuzzifier", "centroid(101)"]) == 0
    sampled = json.loads(said(capsys))["u"]
    way = Defuzzifier("centroid", 101, "endpoints")
    changed = replace(rulebase, outputs=(replace(rulebase.outputs[0], defuzzifier=way),))
    assert sampled == infer(changed, e=1.3, ce=-2.2)["u"]
    assert sampled != infer(rulebase, e=1.3, ce=-2.2)["u"]


def test_explain_as_text_and_as_data(capsys, frb):
    assert main(["eval", frb, "a=3.5", "b=0.25", "--explain"]) == 0
    text = said(capsys)
    assert "5 of 7 rules fire" in text
    assert "line 16:13" in text
    assert main(["eval", frb, "a=3.5", "b=0.25", "--explain", "--json"]) == 0
    data = json.loads(said(capsys))
    assert data["outputs"][0]["value"] == infer(load_rulebase(frb), a=3.5, b=0.25)["y"]


@pytest.mark.parametrize(
    ("words", "message", "status"),
    [
        (["e=1", "cx=2"], "unknown input 'cx' (did you mean 'ce'?)", 1),
        (["e=1"], "no value for input ce (add, for instance, ce=0)", 1),
        ([], "no value for inputs e, ce", 1),
        (["e=nan", "ce=0"], "the value of 'e' must be finite, not nan", 2),
        (["e=inf", "ce=0"], "must be finite", 2),
        (["e=one", "ce=0"], "the value of 'e' is not a number: 'one'", 2),
        (["e=1", "e=2", "ce=0"], "'e' is given twice", 2),
        (["1.3", "ce=0"], "'1.3' is not an assignment", 2),
        (["e=1", "ce=0", "--defuzzifier", "centriod"], "did you mean 'centroid'", 2),
        (["e=1", "ce=0", "--mode", "bins"], "--mode is for tables", 1),
        (["e=1", "ce=0", "--held", "v=2"], "unknown output 'v'", 1),
        (["e=1", "ce=0", "--plot", "x.gif"], "does not have the suffix of a figure", 2),
    ],
)
def test_eval_complains_in_one_sentence(capsys, words, message, status):
    assert message in complaint(capsys, "eval", PD7, *words, status=status)


def test_eval_needs_no_array_library():
    code = (
        "import sys; from fuzzyarm.apps.cli import main;"
        f"main(['eval', {PD7!r}, 'e=1.3', 'ce=-2.2', '--explain', '--json']);"
        "sys.exit('numpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_show_of_rule_bases_and_tables(capsys, frb):
    assert main(["show", frb, TABLE]) == 0
    text = said(capsys)
    assert "M*0.5" in text
    assert "-5.6 -5.4 -5.0" in text
    assert main(["show", frb, "--at", "a=3.5,b=0.25"]) == 0
    assert "5 of 7 rules fire" in said(capsys)
    assert main(["show", TABLE, "--at", "e=1.3,ce=-2.2"]) == 0
    assert "[2.5]" in said(capsys)
    assert main(["show", frb, TABLE, "--json"]) == 0
    models = json.loads(said(capsys))
    assert [model["kind"] for model in models] == ["rulebase", "table"]
    assert models[1]["values"][0][12] == -4.2
    assert "did you mean 'ce'" in complaint(capsys, "show", TABLE, "--at", "cee=1,e=0")


def test_compile_writes_every_format(capsys, tmp_path, frb):
    tables = []
    for suffix in (".lut", ".csv", ".npz", ".json"):
        out = tmp_path / f"table{suffix}"
        assert main(["compile", frb, "-o", str(out), "--levels", "a=3,b=5"]) == 0
        text = said(capsys)
        assert "3 x 5 cells of y over a, b" in text
        assert "worst" in text
        tables.append(read_table(out))
    assert all(table == tables[0] for table in tables)
    origin = dict(tables[0].provenance)
    assert origin["source"] == "lopsided.frb"
    assert len(origin["sha256"]) == 64
    assert "date" not in origin
    assert origin["error-nearest"].startswith("worst ")


def test_compile_reports_as_data(capsys, tmp_path, frb):
    out = str(tmp_path / "t.lut")
    assert main(["compile", frb, "-o", out, "--json"]) == 0
    data = json.loads(said(capsys))
    assert data["default_levels"] is True
    assert data["shape"] == [13, 13]
    assert {each["mode"] for each in data["errors"]} == {"nearest", "linear"}
    assert main(["compile", frb, "-o", out, "--tolerance", "0.4", "--json"]) == 0
    data = json.loads(said(capsys))
    assert data["errors"][0]["mode"] == data["mode"] == "linear"
    assert 0 < data["errors"][0]["worst"] <= 0.4
    assert read_table(out).default_mode == "linear"


@pytest.mark.parametrize(
    ("words", "message", "status"),
    [
        (["-o", "t.xls"], "cannot tell the format of 't.xls'", 2),
        (["-o", "t.lut", "--output", "x"], "no output 'x' (it has y)", 1),
        (["-o", "t.lut", "--levels", "1"], "--levels must be 2 to 100,000, not 1", 2),
        (["-o", "t.lut", "--levels", "c = 4"], "no input 'c'", 1),
        (["-o", "t.lut", "--levels", "a = 4, 5"], "does not name its input", 2),
        (["-o", "t.lut", "--levels", "0 .. 4 step 3"], "the step 3 does not divide", 2),
        (["-o", "t.lut", "--levels", "lots"], "levels as numbers", 2),
        (["-o", "t.lut", "--levels", "9 8 7"], "must increase", 1),
        (["-o", "t.lut", "--tolerance", "-1"], "--tolerance must be above 0, not -1", 2),
        (["-o", "t.lut", "--tolerance", "1e-9"], "no even grid of up to", 1),
        (["-o", "t.lut", "--round", "-1"], "--round must be at least 0, not -1", 2),
        (["-o", "t.lut", "--levels", "100000"], "at most 32,000,000", 1),
    ],
)
@pytest.mark.slow
def test_compile_complains_in_one_sentence(
    capsys, tmp_path, monkeypatch, frb, words, message, status
):
    monkeypatch.chdir(tmp_path)
    assert message in complaint(capsys, "compile", frb, *words, status=status)
    assert [path.name for path in tmp_path.iterdir()] == ["lopsided.frb"]


def test_compile_rewrites_a_table_in_another_format(capsys, tmp_path):
    out = str(tmp_path / "t.csv")
    assert main(["compile", TABLE, "-o", out]) == 0
    assert said(capsys) == f"{out}: 13 x 13 cells of u over e, ce\n"
    assert read_table(out) == read_table(TABLE)
    assert main(["compile", TABLE, "-o", out, "--mode", "linear", "--json"]) == 0
    assert json.loads(said(capsys))["mode"] == read_table(out).default_mode == "linear"
    told = complaint(capsys, "compile", TABLE, "-o", out, "--levels", "5", status=2)
    assert "is a table already" in told
    assert "has no output 'x'" in complaint(capsys, "compile", TABLE, "-o", out, "--output", "x")


def test_diff_of_tables_goes_by_name_not_by_place(capsys, tmp_path):
    table = read_table(TABLE)
    turned = LookupTable(
        table.axes[::-1], table.output, table.values.T.copy(), low=table.low, high=table.high,
        description=table.description, rounding=table.rounding,
    )  # fmt: skip
    path = tmp_path / "turned.lut"
    write_table(turned, path)
    assert main(["diff", TABLE, str(path), "--json"]) == 0
    data = json.loads(said(capsys))
    assert (data["transposed"], data["cells"], data["same"]) == (True, [], False)
    values = table.values.copy()
    values[9, 3] = 9.5
    write_table(table.with_values(values), path)
    assert main(["diff", TABLE, str(path)]) == 0
    text = said(capsys)
    assert "1 of 169 cells changed, by up to 7" in text
    assert "e = 3, ce = -3: 2.5 -> 9.5" in text
    assert main(["diff", TABLE, TABLE, "--json"]) == 0
    assert json.loads(said(capsys))["same"] is True


def test_diff_of_rule_bases(capsys, tmp_path, frb, lopsided_text):
    other = tmp_path / "other.frb"
    other.write_text(lopsided_text.replace("M*0.5", "L    "), "utf-8")
    assert main(["diff", frb, str(other), "--json"]) == 0
    data = json.loads(said(capsys))
    assert [(c["what"], c["before"], c["after"]) for c in data["rules"]] == [
        ("if a is HI and b is Z", "y is M with 0.5", "y is L")
    ]
    assert "cannot be compared" in complaint(capsys, "diff", frb, TABLE)


@pytest.mark.slow
def test_plot_writes_figures(capsys, tmp_path, frb):
    for name, words in {
        "all.png": [frb],
        "terms.svg": [frb, "--what", "terms"],
        "surface.pdf": [frb, "--what", "surface", "--output", "y", "--at", "a=1,b=0"],
        "table.png": [TABLE, "--at", "e=1.3,ce=-2.2"],
    }.items():
        out = tmp_path / name
        assert main(["plot", *words, "-o", str(out)]) == 0
        assert out.stat().st_size > 5_000
    capsys.readouterr()
    bad = str(tmp_path / "x.bmp")
    assert "does not have the suffix of a figure" in complaint(
        capsys, "plot", frb, "-o", bad, status=2
    )
    good = str(tmp_path / "x.png")
    assert "no output 'z'" in complaint(capsys, "plot", frb, "-o", good, "--output", "z")
    assert "for rule bases" in complaint(capsys, "plot", TABLE, "-o", good, "--what", "terms")


@pytest.mark.parametrize("command", ["eval", "show", "plot", "compile", "diff"])
def test_missing_and_damaged_files(capsys, tmp_path, command):
    more = {"plot": ["-o", "x.png"], "compile": ["-o", "x.lut"], "diff": [TABLE]}.get(command, [])
    missing = str(tmp_path / "nowhere.frb")
    assert "No such file" in complaint(capsys, command, missing, *more)
    damaged = tmp_path / "damaged.lut"
    damaged.write_text(Path(TABLE).read_text("utf-8").replace("-5.6", "-5,6"), "utf-8")
    assert main([command, str(damaged), *more]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert "damaged.lut:18:11: error[not-a-number]: '-5,6' is not a number" in err
    assert "did you mean '-5.6'?" in err


def test_visits_are_written_short():
    from fuzzyarm.apps.show.table import _count_text

    assert [_count_text(n) for n in (1, 2, 99_999, 123_456)] == ["1", "2", "99999", "123k"]
    assert not _count_text(0).isdigit()
