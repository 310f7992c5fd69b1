"""The command line of conversion and of the corpus report."""

from __future__ import annotations

import itertools
import json
import re
from dataclasses import replace
from pathlib import Path

import corpus
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import input_points, rulebases

from fuzzyarm import shipped
from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.protected import MARK
from fuzzyarm.exchange.formats import same_model, write
from fuzzyarm.exchange.formats.registry import read
from fuzzyarm.exchange.formats.tables import in_tables
from fuzzyarm.inference import infer
from fuzzyarm.language import load_rulebase
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from tests.interpreted import interpreted

DATA = Path(__file__).parent / "data"


@pytest.mark.parametrize("name", ["tipper_matlab.fis", "pump_jfuzzylogic.fcl", "chain.fll"])
def test_there_and_back(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own, back = tmp_path / "a.frb", tmp_path / f"b{Path(name).suffix}"
    assert main(["convert", str(DATA / name), str(own)]) == 0
    assert main(["convert", str(own), str(back)]) == 0
    assert "written" in capsys.readouterr().out
    first, second = read(DATA / name).rulebase, read(own).rulebase
    assert first is not None
    assert second is not None
    assert same_model(first, second)
    assert read(back).rulebase is not None


def test_slight_differences_are_warnings_and_errors_when_strict(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "a.fll"
    words = ["convert", str(shipped("pd7.frb")), str(target)]
    assert main([*words, "--strict"]) == 1
    assert not target.exists()
    assert "error[sampling]" in capsys.readouterr().err
    assert main(words) == 0
    assert "warning[sampling]" in capsys.readouterr().out
    assert target.read_text().startswith("# Written by fuzzyarm")


def test_what_would_change_numbers_is_an_error_unless_lossy(tmp_path: Path) -> None:
    source, target = tmp_path / "a.frb", tmp_path / "a.fis"
    source.write_text(
        "rulebase t\ninput e 0 .. 1\noutput u 0 .. 1\nterms e, u: triangles A B\n"
        "inference and drastic\nblock one\nrule if e is A then u is A\n"
        "block two: and product\nrule if e is B then u is B\n"
    )
    assert main(["convert", str(source), str(target)]) == 1
    assert not target.exists()
    assert main(["convert", str(source), str(target), "--lossy"]) == 0


def test_a_fault_is_shown_with_its_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.fis"
    text = (DATA / "tipper_matlab.fis").read_text()
    line = text[: text.index("'trapmf'")].count("\n") + 1
    bad.write_text(text.replace("'trapmf'", "'trapfm'"))
    assert main(["convert", str(bad), str(tmp_path / "a.frb")]) == 1
    err = capsys.readouterr().err
    assert f"{bad}:{line}:" in err
    assert "^^^" in err


def test_json_says_what_happened(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", str(DATA / "chain.fll"), str(tmp_path / "a.frb"), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["written"] is True
    assert said["producer"] == "fuzzylite"
    assert {d["name"] for d in said["diagnostics"]} == {"activation-put-in"}


@pytest.mark.parametrize(
    "words",
    [
        ["nowhere.fis", "a.frb"],
        [str(DATA / "chain.fll"), "a.xyz"],
        [str(DATA / "chain.fll"), "a.frb", "--from", "octave"],
    ],
)
def test_bad_input_is_one_sentence(
    words: list[str],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["convert", *words]) == 1
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


def test_usage_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "only-one.fis"]) == 2
    assert "the file to write, OUT, is missing" in capsys.readouterr().err


def test_corpus_reports_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "one.fll").write_text((DATA / "chain.fll").read_text())
    (tmp_path / "two.fis").write_text("[System]\nName='x'\nAndMethod='mun'\n")
    reference = tmp_path / "reference"
    reference.mkdir()
    # light 0.25: power is high alone, so its centroid is that of the triangle
    row = {"input_names": ["light"], "output_names": ["power"], "inputs": [[0.25]]}
    (reference / "one.fll.json").write_text(json.dumps({**row, "outputs": [[0.75]]}))
    assert corpus.main([str(tmp_path), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["summary"]["all"] == {
        "files": 2, "imported": 1, "diagnosed": 1, "compared": 1, "matched": 1,
    }  # fmt: skip
    assert "unknown-norm" in report["files"][1]["findings"]
    (reference / "one.fll.json").write_text(json.dumps({**row, "outputs": [[0.7501]]}))
    assert corpus.main([str(tmp_path)]) == 0
    assert "one.fll: differs" in capsys.readouterr().out


def test_corpus_of_nothing_is_an_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert corpus.main([str(tmp_path)]) == 1
    assert corpus.main([str(tmp_path / "nowhere")]) == 1
    assert len(capsys.readouterr().err.strip().splitlines()) == 2


def test_no_value_equals_no_value_alone() -> None:
    nan, inf = float("nan"), float("inf")
    assert corpus.difference(nan, nan) == 0.0
    assert (
        corpus.difference(nan, 1.0)
        == corpus.difference(1.0, nan)
        == corpus.difference(1.0, inf)
        == inf
    )
    assert corpus.difference(inf, inf) == 0.0
    assert corpus.difference(2.0, 2.0 + 4e-6) == pytest.approx(2e-6, rel=1e-4)


@pytest.mark.parametrize("suffix", ["fll", "fcl", "fis"])
@pytest.mark.parametrize("name", ["pd7", "fan", "tipper", "thermostat"])
def test_shipped_files_go_out_and_come_back_with_their_numbers(
    name: str, suffix: str, tmp_path: Path
) -> None:
    out = tmp_path / f"{name}.{suffix}"
    # Of the programs that read a .fis fuzzylite takes the most samples.
    reader = ["--for", "fuzzylite"] if suffix == "fis" else []
    assert main(["convert", str(shipped(f"{name}.frb")), str(out), "-q", *reader]) == 0
    before, after = load_rulebase(shipped(f"{name}.frb")), read(out).rulebase
    assert after is not None
    point = {v.name: v.low + 0.3 * (v.high - v.low) for v in before.inputs}
    for output, value in infer(before, point).items():
        assert infer(after, point)[output] == pytest.approx(value, rel=1e-4)


@pytest.mark.parametrize("name", ["pd7", "tipper", "thermostat", "slide7"])
def test_a_fis_is_written_for_matlab_where_nothing_else_is_said(name: str, tmp_path: Path) -> None:
    out, matlab = tmp_path / "x.fis", tmp_path / "matlab.fis"
    source = str(shipped(f"{name}.frb"))
    assert main(["convert", source, str(out), "-q"]) == 0
    assert main(["convert", source, str(matlab), "-q", "--for", "matlab"]) == 0
    assert out.read_text() == matlab.read_text()
    assert "rampmf" not in out.read_text()  # which fuzzylite alone has: of thermostat
    assert read(out).producer == "matlab"


@pytest.mark.parametrize("producer", ["matlab", "octave", "fuzzylite"])
def test_a_fis_of_some_program_goes_out_for_the_same(producer: str, tmp_path: Path) -> None:
    first, again = tmp_path / "first.fis", tmp_path / "again.fis"
    source = str(shipped("tipper.frb"))
    assert main(["convert", source, str(first), "-q", "--for", producer]) == 0
    assert main(["convert", str(first), str(again), "-q"]) == 0
    assert again.read_text() == first.read_text()


# ── Nothing lost ─────────────────────────────────────────────────────────────────────

OWN = """# at the top
rulebase t  # behind the name
input e 0 .. 1
output u 0 .. 1
terms e, u: triangles A B

# between
rules u
  # above the header
  e  A  B
  # above the row
  u  A  B  # behind the row
# at the end
"""


@pytest.mark.parametrize("link", ["", "hard", "symbolic", "dotted"])
@pytest.mark.parametrize("suffix", [".frb", ".fll"])
def test_the_file_that_is_read_is_not_written(
    link: str, suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / f"a{suffix}"
    source.write_text(OWN if suffix == ".frb" else (DATA / "chain.fll").read_text())
    before = source.read_bytes()
    target = tmp_path / f"b{suffix}" if link in ("hard", "symbolic") else source
    if link == "hard":
        target.hardlink_to(source)
    if link == "symbolic":
        target.symlink_to(source)
    where = f"{tmp_path}/./a{suffix}" if link == "dotted" else str(target)
    for mode in ([], ["--lossy"], ["--strict"]):
        assert main(["convert", str(source), where, *mode]) == 1
        assert "the same" in capsys.readouterr().err
        assert source.read_bytes() == before


def test_comments_survive_or_are_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, own = tmp_path / "a.frb", tmp_path / "b.frb"
    source.write_text(OWN)
    assert main(["convert", str(source), str(own)]) == 0
    assert "nothing lost" in capsys.readouterr().out
    mark, *comments = re.findall("#.*", own.read_text())
    assert MARK in mark
    assert comments == re.findall("#.*", OWN)
    first, again = load_rulebase(source), load_rulebase(own)
    assert same_model(first, again)
    for suffix in (".fll", ".fcl", ".fis"):
        for file in (source, own):  # the mark is no comment of a person
            assert main(["convert", str(file), str(tmp_path / f"c{suffix}"), "--lossy"]) == 0
            assert "7 comments left out" in capsys.readouterr().out
    twice = tmp_path / "c.frb"
    assert main(["convert", str(own), str(twice)]) == 0
    assert twice.read_text() == own.read_text()


@pytest.mark.parametrize(("suffix", "program"), [(".fcl", "fuzzylite"), (".fis", "fuzzylite")])
def test_a_threshold_of_a_millionth_is_a_warning_both_ways(
    suffix: str, program: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, foreign = tmp_path / "a.frb", tmp_path / f"a{suffix}"
    source.write_text(OWN + "inference u: defuzzifier centroid(1000, midpoints), no-rule nan\n")
    assert main(["convert", str(source), str(foreign), "--for", program]) == 0
    assert "warning[threshold]" in capsys.readouterr().out
    back = tmp_path / "a.fll"
    assert main(["convert", str(foreign), str(back), "--from", program, "--strict"]) == 0
    away = tmp_path / "b.fcl"
    words = ["convert", str(foreign), str(away), "--from", program, "--for", "jfuzzylogic"]
    for mode, code in (("--strict", 1), ("--lossy", 0)):
        assert main([*words, mode]) == code
        said = capsys.readouterr()
        assert "[threshold]" in said.out + said.err
    foreign.unlink()
    assert main(["convert", str(source), str(foreign), "--for", program, "--strict"]) == 1
    assert not foreign.exists()


def test_tables_of_other_programs_become_grids(tmp_path: Path) -> None:
    terms = ["low", "middle", "high"]
    declared = "".join(f"  term: {t} Triangle {i} {i + 1} {i + 2}\n" for i, t in enumerate(terms))
    text = "Engine: e\n"
    for kind, name in [("Input", "a"), ("Input", "b"), ("Output", "u"), ("Output", "v")]:
        text += f"{kind}Variable: {name}\n  range: 0 4\n{declared}"
        if kind == "Output":
            text += "  aggregation: Maximum\n  defuzzifier: Centroid\n"
    text += "RuleBlock: r\n  conjunction: Minimum\n  implication: Minimum\n"
    for b in terms:  # the first condition changes fastest
        for a in terms:
            text += f"  rule: if a is {a} and b is {b} then u is {b} and v is {a}\n"
    source, target = tmp_path / "a.fll", tmp_path / "a.frb"
    source.write_text(text)
    assert main(["convert", str(source), str(target)]) == 0
    lines = target.read_text().splitlines()
    assert [line for line in lines if line.startswith("rule")] == [
        "rulebase e",
        "rules u",
        "rules v",
    ]
    inference = [line for line in lines if line.startswith("inference")]
    assert len(inference) == 2
    assert inference[1].endswith("no-rule nan, outside extend")
    one, other = read(source).rulebase, read(target).rulebase
    assert one is not None
    assert other is not None
    for a, b in itertools.product((0.3, 1.2, 2.9), (0.7, 1.9, 3.1)):
        assert infer(one, a=a, b=b) == infer(other, a=a, b=b)


@pytest.mark.slow
@settings(max_examples=cases(20, 60), deadline=None)
@given(st.data())
def test_tables_mean_what_the_rules_meant(data: st.DataObject) -> None:
    rulebase = data.draw(rulebases())
    shuffled = tuple(
        replace(block, rules=tuple(data.draw(st.permutations(block.rules))))
        for block in rulebase.blocks
    )
    for one in (rulebase, replace(rulebase, blocks=shuffled)):
        other = in_tables(one)
        assert write(other, ".frb").text is not None
        points = data.draw(input_points(one, 3))
        for row in zip(*points.values(), strict=True):
            at = dict(zip(points, row, strict=True))
            assert outcome(other, at) == pytest.approx(
                outcome(one, at), rel=1e-9, abs=1e-12, nan_ok=True
            )


def test_rules_that_ask_for_an_input_twice_fill_no_table() -> None:
    terms = tuple(
        Term(name, Shape("triangle", (k - 1.0, k, k + 1.0))) for k, name in enumerate("AB")
    )
    twice = [
        And((Is("a", x), Is("a", y), Is("b", z))) for x, y, z in itertools.product("AB", repeat=3)
    ]
    rules = tuple(Rule(each, (Consequent("u", "A"),)) for each in reversed(twice))
    inputs = tuple(Input(name, 0.0, 1.0, terms) for name in "ab")
    rulebase = RuleBase("twice", inputs, (Output("u", 0.0, 1.0, terms),), (RuleBlock(rules),))
    assert in_tables(rulebase) == rulebase


def outcome(rulebase: RuleBase, at: dict[str, float]) -> dict[str, float]:
    """The outputs at a point; none where the model gives an error."""
    held = {output.name: 0.25 for output in rulebase.outputs}
    try:
        return interpreted(rulebase).point(at, held)
    except FuzzyarmError:
        return {}
