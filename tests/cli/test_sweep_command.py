"""``fuzzyarm sweep``: ranges, the file and going on with it, summary and figure."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.apps.cli import main
from fuzzyarm.control.loop import SweepError, simulate_many
from fuzzyarm.control.loop.sweep import Range, SweepFile, drawn, grid, read_range
from fuzzyarm.plant import reach_return

SHORT = ["--segment", "0.3", "--hold", "0.1"]
ASKED = ["sweep", "pd", *SHORT, "--sweep", "payload=0..2:4", "--sweep", "K_P=50..500:3 log"]


# --- Ranges ---


def test_ranges_as_they_are_written():
    assert read_range("payload=0..2:21") == Range("payload", 0.0, 2.0, 21)
    assert read_range(" G_e = 100..3000:5 log") == Range("G_e", 100.0, 3000.0, 5, True)
    assert read_range("x=-1e-3..+2.5") == Range("x", -1e-3, 2.5)


@pytest.mark.parametrize(
    "word",
    ["", "payload", "payload=", "=0..1:2", "payload=1", "payload=0..1:0", "payload=0..1:x",
     "payload=1..0:3", "payload=0..inf:3", "payload=nan..1:3", "x=0..1:4 log", "x=0..1:2:3"],
)  # fmt: skip
def test_ranges_that_are_not(word):
    with pytest.raises(SweepError):
        read_range(word)


@pytest.mark.slow
@given(st.floats(1e-6, 1e6), st.floats(1.0, 1e3), st.integers(2, 50), st.booleans())
def test_a_range_holds_both_ends_and_rises(low, factor, count, log):
    values = Range("x", low, low * factor, count, log).values()
    assert values[0] == low
    assert values[-1] == low * factor
    assert (np.diff(values) >= 0).all()


def test_a_grid_and_what_is_drawn():
    found = grid([Range("a", 0.0, 1.0, 2), Range("b", 1.0, 3.0, 3)])
    assert found["a"].tolist() == [0, 0, 0, 1, 1, 1]
    assert found["b"].tolist() == [1, 2, 3, 1, 2, 3]
    ranges = [Range("a", 5.0, 6.0), Range("b", 1.0, 1000.0, log=True)]
    few, many = drawn(ranges, 10, 3), drawn(ranges, 4000, 3)
    assert few["a"].tolist() == many["a"][:10].tolist()
    assert 0.45 < (many["b"] < np.sqrt(1000.0)).mean() < 0.55
    assert ((many["a"] >= 5.0) & (many["a"] <= 6.0)).all()
    for wrong in ([Range("a", 0.0, 1.0)], [Range("a", 0.0, 1.0, 2)] * 2):
        with pytest.raises(SweepError):
            grid(wrong)
    with pytest.raises(SweepError, match="number of values"):
        drawn([Range("a", 0.0, 1.0, 2)], 3, 1)


# --- The file ---


def lines_of(path):
    return [row for row in csv.reader(path.read_text().splitlines()) if row[0][0] != "#"]


def test_the_file_has_a_line_for_each_run(tmp_path, capsys):
    file = tmp_path / "sweep.csv"
    assert main([*ASKED, "-o", str(file)]) == 0
    assert "12 runs, none diverged" in capsys.readouterr().out
    heading, *rows = lines_of(file)
    assert heading[:6] == ["run", "payload", "K_P", "seed", "diverged", "joint1.rms"]
    assert [int(row[0]) for row in rows] == list(range(12))
    columns = grid([Range("payload", 0.0, 2.0, 4), Range("K_P", 50.0, 500.0, 3, log=True)])
    many = simulate_many("pd", reach_return(segment=0.3, hold=0.1), columns)
    assert [float(row[5]) for row in rows] == many.rms[:, 0].tolist()
    assert [row[3] for row in rows] == [str(seed) for seed in range(1, 13)]


@pytest.mark.parametrize("kept", [0, 1, 7, 11, 12])
@pytest.mark.parametrize("torn", [b"", b"9,1.0,5", b"\xff,\x00"])
def test_a_file_that_was_cut_is_completed_to_the_same_bytes(tmp_path, capsys, kept, torn):
    file = tmp_path / "sweep.csv"
    main([*ASKED, "-o", str(file)])
    complete = file.read_bytes()
    lines = complete.splitlines(keepends=True)
    file.write_bytes(b"".join(lines[: 3 + kept]) + torn)
    assert main([*ASKED, "-o", str(file), "--resume", "--workers", "1"]) == 0
    assert file.read_bytes() == complete
    capsys.readouterr()


def test_another_question_is_refused(tmp_path, capsys):
    file = tmp_path / "sweep.csv"
    main([*ASKED, "-o", str(file)])
    before = file.read_bytes()
    for change, told in (
        (["--payload"], "payload"),
        (["--set", "K_D=3"], "set"),
        (["--seed", "2"], "seed"),
        (["--sweep", "K_D=1..2:2"], "sweep"),
    ):
        assert main([*ASKED, *change, "-o", str(file), "--resume"]) == 1
        shown = capsys.readouterr().err
        assert "belongs to another sweep" in shown
        assert told in shown
    assert file.read_bytes() == before


def test_another_content_of_a_file_is_refused(tmp_path, capsys, monkeypatch):
    from fuzzyarm import shipped

    monkeypatch.chdir(tmp_path)
    text = shipped("fuzzy-lut.frb").read_text()
    Path("mine.frb").write_text(text)
    asked = ["sweep", "mine.frb", *SHORT, "--sweep", "payload=0..1:2", "-o", "sweep.csv"]
    assert main(asked) == 0
    Path("mine.frb").write_text(text + "# changed\n")
    assert main([*asked, "--resume"]) == 1
    assert "files mine.frb differs" in capsys.readouterr().err


def test_an_unfinished_file_is_not_lost_by_accident(tmp_path, capsys):
    file = tmp_path / "sweep.csv"
    main([*ASKED, "-o", str(file)])
    assert main([*ASKED, "-o", str(file)]) == 0  # a complete one is made anew
    lines = file.read_bytes().splitlines(keepends=True)
    file.write_bytes(b"".join(lines[:6]))
    assert main([*ASKED, "-o", str(file)]) == 1
    assert "has 3 of the 12 runs" in capsys.readouterr().err


def test_a_damaged_file_says_where(tmp_path, capsys):
    file = tmp_path / "sweep.csv"
    main([*ASKED, "-o", str(file)])
    lines = file.read_text().splitlines(keepends=True)
    for number, damaged in ((5, lines[6]), (7, lines[7].replace(",", ";")), (4, "\n")):
        file.write_text("".join([*lines[:number], damaged, *lines[number + 1 :]]))
        assert main([*ASKED, "-o", str(file), "--resume"]) == 1
        assert f"line {number + 1} is not that of run {number - 3}" in capsys.readouterr().err
    for content in (b"", b"a,b\n", b"# fuzzyarm sweep 1\n", b"# fuzzyarm sweep 1\n# {\n"):
        file.write_bytes(content)
        assert main([*ASKED, "-o", str(file), "--resume"]) == 1
        assert "is not a sweep file" in capsys.readouterr().err


def test_headings_with_commas(tmp_path):
    file = SweepFile(tmp_path / "x.csv", {}, {'a,"b"': np.array([1.0])}, ["joint1"])
    file.begin()
    assert lines_of(file.path)[0][1] == 'a,"b"'


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Windows has other signals")
def test_ctrl_c_leaves_a_file_that_is_completed(tmp_path):
    file = tmp_path / "sweep.csv"
    words = ["sweep", "pd", *SHORT, "--sweep", "payload=0..2:1000", "-o", str(file)]
    # Interpreted, a run takes long enough to be interrupted.
    slow = {**os.environ, "FUZZYARM_NATIVE": "0"}
    command = [sys.executable, "-m", "fuzzyarm", *words]
    process = subprocess.Popen(
        [*command, "--workers", "1"], env=slow, stderr=subprocess.PIPE, text=True
    )
    while process.poll() is None:
        if file.exists() and len(file.read_bytes().splitlines()) > 4:
            break
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=300)
    assert process.returncode == 130
    assert "--resume goes on" in told
    done = len(lines_of(file)) - 1
    assert 0 < done < 1000
    assert main([*words, "--resume"]) == 0
    other = tmp_path / "whole.csv"
    main([*words[:-1], str(other)])
    assert file.read_bytes() == other.read_bytes()


# --- What is printed and drawn ---


def test_json_of_a_sweep(capsys):
    assert main([*ASKED, "--json", "--metric", "max"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["runs"] == len(found["rows"]) == 12
    assert found["columns"][:3] == ["payload", "K_P", "seed"]
    least = found["extremes"]["joint1"]["least"]
    at = found["columns"].index("joint1.max")
    assert abs(least["value"]) == min(abs(row[at]) for row in found["rows"])
    assert found["rows"][least["run"]][0] == least["payload"]


def test_simulate_sweeps_too(capsys):
    main([*ASKED, "--json"])
    first = json.loads(capsys.readouterr().out)
    main(["simulate", *ASKED[1:], "--json"])
    assert json.loads(capsys.readouterr().out) == first


def test_drawn_runs_on_a_plant(tmp_path, capsys, monkeypatch):
    from tests.loop.test_many import HEATER

    monkeypatch.chdir(tmp_path)
    Path("heater.frb").write_text(HEATER)
    words = ["sweep", "heater.frb", "--plant", "room", "--for", "1h", "--random", "5", "--json"]
    assert main([*words, "--sweep", "G_e=1..3", "--noise", "temperature=0.1"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["runs"] == 5
    assert found["outputs"] == {"room": "°C"}
    assert len({row[0] for row in found["rows"]}) == 5


@pytest.mark.slow
@pytest.mark.parametrize("names", [["payload"], ["payload", "K_I"]])
def test_figures_show_where_runs_diverge(tmp_path, capsys, names):
    from fuzzyarm.apps.show.figures.sweep import sweep_figure
    from fuzzyarm.apps.show.sweep import worst

    ranges = [Range("payload", 0.0, 2.0, 3), Range("K_I", 1.0, 1e4, 4, log=True)]
    many = simulate_many("pid", reach_return(segment=0.3, hold=0.1), grid(ranges))
    over = [each for each in ranges if each.name in names]
    values, lost = worst(many, over, "rms")
    shape = (4, 3) if len(names) == 2 else (3,)
    assert lost.shape == shape
    diverged = ~np.isnan(many.diverged.reshape(3, 4))
    assert 0 < diverged.sum() < 12
    if len(names) == 2:
        np.testing.assert_array_equal(lost, diverged.T)
        rms = np.where(diverged, np.nan, many.rms[:, 0].reshape(3, 4)).T
        np.testing.assert_array_equal(values[0], rms)
    else:
        np.testing.assert_array_equal(lost, diverged.any(axis=1))
    figure = sweep_figure([many], over)
    assert f"{int(lost.sum())} of {lost.size} points diverge" in figure.get_suptitle()
    words = ["sweep", "pid", *SHORT, "--sweep", "payload=0..2:3", "--sweep", "K_I=1..1e4:4 log"]
    file = tmp_path / "map.png"
    assert main([*words, "--map", "K_I,payload", "--plot", str(file)]) == 0
    assert file.read_bytes().startswith(b"\x89PNG")
    capsys.readouterr()


@pytest.mark.parametrize(
    ("words", "status", "told"),
    [
        ([], 2, "nothing is swept"),
        (["--sweep", "payload=0..2:3", "--map", "payload,x"], 2, "the file of --plot"),
        (["--sweep", "payload=0..2:3", "--plot", "x.gif"], 2, "'x.gif' does not have"),
        (["--sweep", "payload=0..2:3", "--resume"], 2, "the file of -o"),
        (["--sweep", "payload=0..2:3", "--metric", "rsm"], 2, "not 'rsm' (did you mean 'rms'?)"),
        (["--sweep", "payload=0..2:3", "--workers", "0"], 2, "--workers must be 1 to 10000, not 0"),
        (["--sweep", "payload=0..2", "--random", "0"], 2, "--random must be 1 to 10000000, not 0"),
        (["--sweep", "K_Q=0..2:3"], 1, "has 'K_Q'"),
        (["--sweep", "payload=0..2", "--random", "3", "--plot", "x.png"], 2, "not of --random"),
        (["--sweep", "m_1=1..2:1000000", "--sweep", "m_2=1..2:100"], 1, "a grid of 100,000,000"),
    ],
)
def test_mistakes_are_told_before_anything_runs(capsys, tmp_path, monkeypatch, words, status, told):
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", "pd", *SHORT, *words]) == status
    assert told in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
