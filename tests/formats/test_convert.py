"""The command line of conversion and of the corpus report."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fuzzyarm import shipped
from fuzzyarm.cli.corpus import difference
from fuzzyarm.cli.main import main
from fuzzyarm.formats import same_model
from fuzzyarm.formats.registry import read
from fuzzyarm.inference import infer
from fuzzyarm.language import load_rulebase

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
    assert "usage" in capsys.readouterr().err


def test_corpus_reports_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "one.fll").write_text((DATA / "chain.fll").read_text())
    (tmp_path / "two.fis").write_text("[System]\nName='x'\nAndMethod='mun'\n")
    reference = tmp_path / "reference"
    reference.mkdir()
    # light 0.25: power is high alone, so its centroid is that of the triangle
    row = {"input_names": ["light"], "output_names": ["power"], "inputs": [[0.25]]}
    (reference / "one.fll.json").write_text(json.dumps({**row, "outputs": [[0.75]]}))
    assert main(["corpus", str(tmp_path), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["summary"]["all"] == {
        "files": 2, "imported": 1, "diagnosed": 1, "compared": 1, "matched": 1,
    }  # fmt: skip
    assert "unknown-norm" in report["files"][1]["findings"]
    (reference / "one.fll.json").write_text(json.dumps({**row, "outputs": [[0.7501]]}))
    assert main(["corpus", str(tmp_path)]) == 0
    assert "one.fll: differs" in capsys.readouterr().out


def test_corpus_of_nothing_is_an_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["corpus", str(tmp_path)]) == 1
    assert main(["corpus", str(tmp_path / "nowhere")]) == 1
    assert len(capsys.readouterr().err.strip().splitlines()) == 2


def test_no_value_equals_no_value_alone() -> None:
    nan, inf = float("nan"), float("inf")
    assert difference(nan, nan) == 0.0
    assert difference(nan, 1.0) == difference(1.0, nan) == difference(1.0, inf) == inf
    assert difference(inf, inf) == 0.0
    assert difference(2.0, 2.0 + 4e-6) == pytest.approx(2e-6, rel=1e-4)


@pytest.mark.parametrize("suffix", ["fll", "fcl", "fis"])
@pytest.mark.parametrize("name", ["pd7", "fan", "tipper", "thermostat"])
def test_shipped_files_go_out_and_come_back_with_their_numbers(
    name: str, suffix: str, tmp_path: Path
) -> None:
    out = tmp_path / f"{name}.{suffix}"
    assert main(["convert", str(shipped(f"{name}.frb")), str(out), "-q"]) == 0
    before, after = load_rulebase(shipped(f"{name}.frb")), read(out).rulebase
    assert after is not None
    point = {v.name: v.low + 0.3 * (v.high - v.low) for v in before.inputs}
    for output, value in infer(before, point).items():
        assert infer(after, point)[output] == pytest.approx(value, rel=1e-4)
