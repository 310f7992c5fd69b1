"""Reports on exports: what they say is so, and what is wrong in the C stands in them."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
from needs import requires

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.apps.dossier.contents import report_of
from fuzzyarm.exchange.compiled import Making, source_of
from fuzzyarm.language import load_rulebase

needs_gcc = requires("gcov")

PROVED = """rulebase lamp "a <lamp> & more"
input  light 0 .. 1
output lit   0 .. 1
terms light, lit: triangles N P
rule if light is N then lit is P
rule if light is P then lit is N
prove lit falls with light
prove lit in 0 .. 0.5
"""


class Reader(HTMLParser):
    """Fails where a tag is closed that is not open."""

    def __init__(self):
        super().__init__()
        self.open, self.words = [], []

    def handle_starttag(self, tag, attrs):
        if tag not in {"meta", "br"}:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


def read_html(path):
    reader = Reader()
    reader.feed(path.read_text("utf-8"))
    assert reader.open == []
    return "".join(reader.words)


@needs_gcc
@pytest.mark.parametrize("sheet", ["pd7.frb", "heater.frb"])
def test_a_report_tells_files_settings_results_and_coverage(tmp_path, monkeypatch, sheet):
    jsonschema = pytest.importorskip("jsonschema")
    monkeypatch.chdir(tmp_path)
    shutil.copy(shipped(sheet), sheet)
    for name in _used(sheet):
        shutil.copy(shipped(name), name)
    assert main(["compile", sheet, "-o", "made.c", "--report", "report"]) == 0
    data = json.loads(Path("report/report.json").read_text("utf-8"))
    schema = Path(__file__).parents[2] / "docs" / "schemas" / "compile-report.json"
    jsonschema.validate(data, json.loads(schema.read_text("utf-8")))
    for each in (data["source"], *data["used"], *data["written"]):
        content = Path(each["file"]).read_bytes()
        assert each["sha256"] == hashlib.sha256(content).hexdigest()
        assert each["bytes"] == len(content)
    assert [each["file"] for each in data["used"]] == _used(sheet)
    assert data["self_test"]["passed"]
    for row in data["self_test"]["rows"]:
        assert row["computed"] == pytest.approx(row["expected"], abs=row["tolerance"])
    reached, total = data["coverage"]["statements"]
    assert 0 < reached <= total
    assert len(data["coverage"]["missed"]) == total - reached
    text = read_html(Path("report/report.html"))
    assert f"{len(data['self_test']['rows'])} of" in text
    assert data["source"]["sha256"] in text


def _used(sheet):
    text = Path(shipped(sheet)).read_text("utf-8")
    return [line.split('"')[1] for line in text.splitlines() if line.startswith("use ")]


@needs_gcc
def test_verdicts_on_prove_lines_stand_in_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("lamp.frb").write_text(PROVED)
    assert main(["compile", "lamp.frb", "-o", "lamp.c", "--report", "report"]) == 0
    data = json.loads(Path("report/report.json").read_text("utf-8"))
    assert [each["verdict"] for each in data["proofs"]] == ["proved", "refuted"]
    assert "1 of 2 proved" in read_html(Path("report/report.html"))


@needs_gcc
def test_c_that_computes_something_else_fails_in_its_report(tmp_path):
    file = tmp_path / "lamp.frb"
    file.write_text(PROVED)
    how = Making(source=str(file))
    exported, _ = source_of(load_rulebase(file), tmp_path / "lamp.c", how)
    (path, text), header = exported.files
    wrong = replace(exported, files=((path, text.replace("return ", "return 0.25f + ")), header))
    good, bad = (report_of(str(file), how, each) for each in (exported, wrong))
    assert good.self_test.passed
    assert not bad.self_test.passed


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["-o", "made.st"], "--report is for C"),
        (["-o", "made.c"], "is not empty, and not of fuzzyarm"),
        (["-o", "report.c", "--report", "report.c"], "they cannot be one"),
    ],
)
def test_what_is_refused_writes_nothing(tmp_path, monkeypatch, capsys, words, message):
    monkeypatch.chdir(tmp_path)
    Path("report").mkdir()
    Path("report/mine.txt").write_text("mine")
    status = 1 if "not empty" in message else 2
    assert main(["compile", str(shipped("pd7.frb")), "--report", "report", *words]) == status
    assert message in capsys.readouterr().err
    assert [path.name for path in Path().iterdir()] == ["report"]


@needs_gcc
def test_a_proved_error_is_rounded_outward(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("r.frb").write_text(
        "rulebase r\ninput e 0 .. 1\noutput u 0 .. 1\nterms e: triangles N P\n"
        "term u N: singleton 0.1234564\nterm u P: singleton 0.6172824\n"
        "inference u: defuzzifier weighted-average\nrule if e is N then u is N\n"
        "rule if e is P then u is P\n"
    )
    # By the nearest of two levels it is off by half of 0.493826 in the middle, and a rounding.
    words = ["compile", "r.frb", "-o", "r.c", "--levels", "2", "--mode", "nearest"]
    assert main([*words, "--report", "report"]) == 0
    told = re.search(r"([0-9.]+), proved", read_html(Path("report/report.html")))
    data = json.loads(Path("report/report.json").read_text("utf-8"))
    assert float(told[1]) >= data["functions"][0]["proved"] >= 0.246913
