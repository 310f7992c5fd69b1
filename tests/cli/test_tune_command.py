"""`fuzzyarm tune` does what its words say, and tells mistakes before anything runs."""

import json

import pytest

from fuzzyarm.apps.cli import main
from fuzzyarm.base.shipped_files import shipped

QUICK = ("--reference", "temperature=20", "--for", "900s", "--workers", "1", "--no-linear")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
def test_a_file_is_written_and_passes_check(folder, capsys):
    words = ["tune", "heater", *QUICK, "--evals", "8", "--unseen", "2", "--scenarios", "2"]
    assert main([*words, "--vary", "outside=0..10", "-o", "mine.frb", "--plot", "mine.svg"]) == 0
    out = capsys.readouterr().out
    assert "mean of 2 scenarios; 3 numbers moved, 8 trials" in out
    assert "G_du" in out
    assert "wrote mine.frb" in out
    assert (folder / "mine.svg").read_text().startswith("<?xml")
    assert main(["check", "--strict", "mine.frb"]) == 0
    # Over the file itself, too; what it says of itself is said once.
    assert (
        main(["tune", "mine.frb", *QUICK, "--evals", "4", "--unseen", "0", "-o", "mine.frb"]) == 0
    )
    assert (folder / "mine.frb").read_text().count("evaluations, seed 1") == 1


def test_a_journal_is_gone_on_with(folder, capsys):
    words = ["tune", "heater", *QUICK, "--unseen", "0", "--json", "--journal", "trials"]
    assert main([*words, "--evals", "5"]) == 0
    assert main([*words, "--evals", "9"]) == 1
    assert "--resume continues it" in capsys.readouterr().err
    assert main([*words, "--evals", "9", "--resume", "-o", "a.frb"]) == 0
    resumed = json.loads(capsys.readouterr().out)
    whole = ["tune", "heater", *QUICK, "--unseen", "0", "--json", "--evals", "9", "-o", "b.frb"]
    assert main(whole) == 0
    straight = json.loads(capsys.readouterr().out)
    assert resumed["curve"] == straight["curve"]
    assert (folder / "a.frb").read_text() == (folder / "b.frb").read_text()
    assert main([*words, "--evals", "9", "--resume", "--seed", "2"]) == 1
    assert "trials belongs to another search: arguments seed differs" in capsys.readouterr().err


def test_a_rule_base_is_fitted_to_samples(folder, capsys):
    lines = ["e,ce,u"] + [f"{e},{ce},{0.5 * (e + ce)}" for e in range(-6, 7) for ce in (-3, 0, 2)]
    (folder / "set.csv").write_text("\n".join(lines))
    words = ["tune", str(shipped("pd7.frb")), "--data", "set.csv", "--evals", "20", "--json"]
    assert main(words) == 0
    found = json.loads(capsys.readouterr().out)
    rows = found["rows"]
    assert set(rows) == {"as in the file", "tuned", "linear regression"}
    assert rows["tuned"]["train"]["cost"] < rows["as in the file"]["train"]["cost"]
    assert rows["linear regression"]["train"]["cost"] == pytest.approx(0.0, abs=1e-9)
    assert " of linear regression on what was not seen" in found["claim"]


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        (["heater", "--cost", "rmss"], 1, "no metric 'rmss'"),
        (["heater", "--tune", "gain G_x 1 .. 2"], 1, "heater has no gain 'G_x'"),
        (["heater", "--tune", "peaks q"], 1, "no rule base has a variable 'q'"),
        (["heater", "--tune", "peak e"], 1, "expected peaks, gain or keep"),
        (["heater", "--resume"], 2, "--resume needs the file of --journal"),
        (["heater", "--scenarios", "0"], 2, "--scenarios must be 1 to 10000, not 0"),
        (["heater", "--evals", "0"], 2, "--evals must be 1 to 10000000, not 0"),
        (["heater", "--digits", "9"], 2, "--digits must be 1 to 8, not 9"),
        (["heater", "--workers", "0"], 2, "--workers must be 1 to 10000, not 0"),
        (["heater", "--vary", "nothing=0..1", "--scenarios", "3"], 1, "has 'nothing'"),
        (["heater", "--data", "set.csv"], 1, "--data is for a rule base alone"),
        (["heater", "-o", "x.png"], 2, "cannot tell the format"),
        (["heater", "-o", "none/x.frb"], 1, "no such folder: 'none'"),
        (["heater", "--plot", "x.txt"], 2, "does not have the suffix of a figure"),
        (["heater", "--time", "5"], 2, "--time takes a time with a unit"),
        (["pd7.frb"], 1, "a rule base alone"),
        ([str(shipped("thesis-6.1.lut"))], 1, "is a table"),
        (["nothing.frb"], 1, "No such file"),
    ],
)
def test_mistakes_are_told_first(words, status, message, capsys, folder):
    (folder / "pd7.frb").write_text(shipped("pd7.frb").read_text())
    assert main(["tune", *words, "--reference", "temperature=20", "--for", "200s"]) == status
    assert message in capsys.readouterr().err
