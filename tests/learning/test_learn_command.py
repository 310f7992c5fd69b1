"""fuzzyarm learn, and simulate with files, as a person calls them."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from fuzzyarm.apps.cli import main
from fuzzyarm.table import read_table

FAST = ["--segment", "0.2", "--trajectory", "pick-and-place"]
RULEBASES = Path(__file__).parents[2] / "rulebases"


def run(capsys, *words):
    status = main(list(words))
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_learn_shows_tables_visits_and_what_was_never_used(capsys):
    status, out, err = run(capsys, "learn", "--start", "zero", *FAST, "--payload")
    assert (status, err) == (0, "")
    for joint in ("joint1", "joint2"):
        assert f"{joint}: " in out
        assert f"{joint}: visits per cell" in out
    assert "of 169 cells visited" in out
    assert "never visited" in out
    assert "[" in out.split("e \\ ce")[1]
    assert "·" in out
    assert "pass 1: RMS error" in out


def test_errors_come_first_and_cells_that_were_never_used_have_a_dot(capsys):
    _, out, _ = run(capsys, "learn", *FAST, "--payload", "--passes", "2")
    lines = out.splitlines()
    assert [line.split(":")[0] for line in lines[:2]] == ["pass 1", "pass 2"]
    tables = out.split("visits per cell")
    grid = [line.split()[1:] for line in tables[0].splitlines()[5:18]]
    counts = [line.split()[1:] for line in tables[1].splitlines()[2:15]]
    assert [[cell == "·" for cell in row] for row in grid] == [
        [cell == "·" for cell in row] for row in counts
    ]
    assert any(cell == "0" for row in grid for cell in row)  # learned, and zero all the same


def test_a_cell_of_a_given_table_that_was_never_used_keeps_its_number(capsys):
    _, out, _ = run(capsys, "learn", *FAST, "--start", "table")
    assert len(re.findall(r"·-?\d\.\d", out)) > 30


@pytest.mark.slow
def test_learn_draws_what_was_learned_and_how_it_grew(capsys, tmp_path, monkeypatch):
    from PIL import Image

    from fuzzyarm.apps.show.figures import learning

    monkeypatch.setattr(learning, "MOST_FRAMES", 3)
    figure, film = tmp_path / "learned.svg", tmp_path / "learned.gif"
    words = ["--passes", "2", "--plot", str(figure), "--animate", str(film)]
    assert run(capsys, "learn", *FAST, *words)[0] == 0
    text = figure.read_text("utf-8")
    for part in ("joint1, after pass 2", "joint2, after pass 2", "RMS error", "hatched: never"):
        assert part in text
    with Image.open(film) as frames:
        assert frames.n_frames == 3


@pytest.mark.slow
def test_a_figure_of_a_training_hatches_what_was_never_used():
    from fuzzyarm.apps.show.figures.learning import LearningHistory, learning_figure
    from fuzzyarm.control.controllers import controller
    from fuzzyarm.learning import train
    from fuzzyarm.plant import pick_and_place
    from tests.show.boxes import faults

    snapshots = list(train(controller("soc-zero"), pick_and_place(segment=0.2)))
    like = read_table(RULEBASES / "thesis-6.1.lut")
    figure = learning_figure(LearningHistory("soc-zero", snapshots, ("joint1", "joint2"), like))
    learned = snapshots[-1].learned
    images = [axes.images[0].get_array() for axes in figure.axes[:2]]
    for image in images:
        np.testing.assert_array_equal(np.ma.getmaskarray(image), learned.visits[0] == 0)
    assert (images[0].compressed() == learned.values[0][learned.visits[0] > 0]).all()
    assert faults(figure) == []


def test_learn_as_json_agrees_with_itself_and_with_the_file(capsys, tmp_path):
    file = tmp_path / "learned.lut"
    words = ["--passes", "2", "--every", "100", "-o", str(file), "--json"]
    _, out, _ = run(capsys, "learn", *FAST, *words)
    report = json.loads(out)
    assert [each["pass"] for each in report["passes"]] == [1, 2]
    visits, tables = np.array(report["visits"]), np.array(report["tables"])
    assert visits.shape == tables.shape == (2, 13, 13)
    last = report["passes"][-1]["joints"]
    for joint in (0, 1):
        assert last[joint]["visited"] == (visits[joint] > 0).sum()
        assert last[joint]["never_visited"] == (visits[joint] == 0).sum()
        assert last[joint]["changed"] == (tables[joint] != 0).sum()
    assert len(report["snapshots"]) == 2 * 3
    table = read_table(file)
    assert table.names == ("joint", "e", "ce")
    np.testing.assert_array_equal(table.values, tables)
    origin = dict(table.provenance)
    assert origin["start"] == "zero"
    assert origin["performance"] == "yamazaki"
    assert "pick-and-place" in origin["trajectory"]
    assert origin["passes"] == "2"


@pytest.mark.slow
def test_a_learned_table_is_put_to_work_and_compared(capsys, tmp_path):
    file = tmp_path / "learned.lut"
    words = ["--start", "table", "--performance", "procyk-mamdani", "--rate", "0.1"]
    small = [*FAST, "--angles", "3", "-3"]
    assert run(capsys, "learn", *words, *small, "-o", str(file))[0] == 0
    status, out, _ = run(
        capsys, "simulate", "fuzzy-lut-x10", "--table", str(file), *small, "--json"
    )
    assert status == 0
    assert max(json.loads(out)["rms"]) < 0.5
    status, out, _ = run(capsys, "learn", "--start", str(file), "--freeze", *FAST, "--json")
    frozen = json.loads(out)
    np.testing.assert_array_equal(frozen["tables"], read_table(file).values)
    assert all(joint["changed"] == 0 for joint in frozen["passes"][0]["joints"])
    status, out, _ = run(capsys, "diff", str(RULEBASES / "thesis-6.1.lut"), str(file))
    assert status == 0
    assert "of 338 cells changed" in out
    assert "when joint = 2" in out


@pytest.mark.slow
def test_the_table_of_one_joint(capsys, tmp_path):
    files = [tmp_path / "one.csv", tmp_path / "two.lut"]
    for joint, file in enumerate(files, start=1):
        run(capsys, "learn", *FAST, "-o", str(file), "--joint", str(joint), "--date")
    tables = [read_table(file) for file in files]
    assert tables[0].names == ("e", "ce")
    assert dict(tables[1].provenance)["joint"] == "2"
    assert "date" in dict(tables[1].provenance)
    status, _, _ = run(capsys, "simulate", "fuzzy-lut", "--table", *map(str, files), *FAST)
    assert status == 0


def test_every_shows_the_table_grow(capsys):
    _, out, _ = run(capsys, "learn", *FAST, "--every", "90")
    assert out.count("so far") == 3
    times = [float(text) for text in re.findall(r"pass 1 of 1, ([\d.]+) s", out)]
    assert times == sorted(times)
    assert times[-1] == pytest.approx(0.798, abs=0.01)


def test_a_rate_out_of_range_is_told_with_the_range(capsys):
    status, _, err = run(capsys, "learn", "--rate", "-1")
    assert status == 2
    assert "--rate must be 0 to 10, not -1" in err
    status, _, err = run(capsys, "learn", "--set", "learning_rate=-1")
    assert status == 1
    assert "gain learning_rate = -1.0 is out of range" in err
    assert "a number from 0 to 10" in err


@pytest.mark.parametrize("words", [[], ["--json"]])
def test_a_training_that_diverges_exits_with_3(capsys, words):
    status, out, _ = run(capsys, "learn", *FAST, "--set", "supply=1e9", *words)
    assert "diverged" in out
    assert status == 3


WRONG_USAGE = (
    ["--plot", "x.gif"],
    ["--freeze", "-o", "x.lut"],
    ["--joint", "1"],
    ["-o", "x.frb"],
    ["pd", "--overview", "x.nothing"],
    ["--passes", "0"],
    ["--every", "0"],
    ["--delay", "-1"],
    ["--rate", "-1"],
    ["--rate", "11"],
    ["--rate", "nan"],
)
"""Words of ``learn`` and ``reproduce`` that are at fault themselves: exit status 2."""


@pytest.mark.parametrize(
    "words",
    [
        ["learn", "--passes", "0"],
        ["learn", "--plot", "x.gif"],
        ["learn", "--animate", "x.png"],
        ["learn", "--plot", "no/such/folder/x.png"],
        ["learn", "--every", "0"],
        ["learn", "--freeze", "-o", "x.lut"],
        ["learn", "--joint", "1"],
        ["learn", "-o", "x.frb"],
        ["learn", "-o", "no/such/folder/x.lut"],
        ["learn", "--start", "missing.lut"],
        ["learn", "--performance", "nobody"],
        ["learn", "--delay", "-1"],
        ["learn", "--rate", "-1"],
        ["learn", "--rate", "11"],
        ["learn", "--rate", "nan"],
        ["simulate", "soc-zero", "--set", "learning_rate=-1"],
        ["learn", "--set", "nothing=1"],
        ["learn", "--start", "a.lut", "b.lut", "c.lut"],
        ["learn", "--start", str(RULEBASES / "thermostat.frb")],
        ["simulate", "fuzzy-direct", "--rulebase", str(RULEBASES / "thesis-6.1.lut")],
        ["simulate", "fuzzy-direct", "--rulebase", str(RULEBASES / "tipper.frb")],
        ["simulate", "fuzzy-lut", "--table", "missing.lut"],
        ["simulate", "pd", "--table", str(RULEBASES / "thesis-6.1.lut")],
        ["simulate", "stfc", "--alpha", str(RULEBASES / "performance-yamazaki.lut")],
        ["convert", str(RULEBASES / "thesis-6.1.lut"), "x.frb"],
        ["reproduce", "pd", "--overview", "x.nothing"],
    ],
    ids=lambda words: " ".join(Path(word).name for word in words),
)
def test_bad_input_is_one_clear_line(capsys, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, *words)
    usage = words[1:] in WRONG_USAGE
    assert status == (2 if usage else 1)
    assert out == ""
    assert err.startswith("fuzzyarm: ")
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_number_of_runs_out_of_sense_is_wrong_usage(capsys):
    assert run(capsys, "reproduce", "pd", "--runs", "-1")[0] == 2


def test_reproduce_prints_the_ensemble(capsys):
    status, out, _ = run(capsys, "reproduce", "7.1.1/soc-zero", "--runs", "6", "--json")
    assert status == 0
    (row,) = json.loads(out)
    assert row["runs"] == 6
    for name in ("median", "band_low", "band_high", "lowest", "highest", "published_inside"):
        assert len(row[name]) == 8
    _, out, _ = run(capsys, "reproduce", "7.1.1/soc-zero", "--runs", "6")
    assert "6 runs, each disturbed in the last bit" in out
    assert "whatever the bounds, all four RMS errors of a row: 1 within 1 %" in out
    _, out, _ = run(capsys, "reproduce", "7.1.1/soc-zero", "--runs", "6", "--markdown")
    assert "lowest of 6" in out


@pytest.mark.slow
def test_figures_of_chapters_and_of_all(capsys, tmp_path):
    rows = ["4.2.5.1/pd", "7.1.1/pd", "7.1.1/acdid", "7.1.1/stfc", "7.1.1/soc-zero"]
    folder, overview = tmp_path / "figures", tmp_path / "all.svg"
    monkeys = ["--runs", "0", "--plot", str(folder), "--overview", str(overview)]
    assert run(capsys, "reproduce", *rows, *monkeys)[0] == 0
    names = sorted(file.name for file in folder.iterdir())
    assert names == ["chapter-4.png", "chapter-5.png", "chapter-6.png", "overview.png"]
    assert b"<svg" in overview.read_bytes()


def test_way_points_may_begin_with_a_minus(capsys):
    status, out, _ = run(
        capsys, "simulate", "pd", "--way-points", "-5,4", "2.5,-1", "--segment", "0.1", "--json"
    )
    assert status == 0
    assert json.loads(out)["trajectory"] == "way-points"


@pytest.mark.parametrize("conventions", ["plain", "study"])
def test_only_cells_that_were_used_change_and_no_rounding_shows(capsys, tmp_path, conventions):
    file = tmp_path / "learned.lut"
    words = ["--start", "table", "--conventions", conventions, "-o", str(file), "--json"]
    status, out, _ = run(capsys, "learn", *FAST, "--payload", *words)
    report = json.loads(out)
    assert status == 0
    start = read_table(RULEBASES / "thesis-6.1.lut").values
    tables, visits = np.array(report["tables"]), np.array(report["visits"])
    changed = tables != start
    assert changed.any()
    assert not (changed & (visits == 0)).any()
    # Whole steps from tenths are tenths, in either precision.
    np.testing.assert_array_equal(tables, np.round(tables, 1))
    np.testing.assert_array_equal(read_table(file).values, tables)


def test_a_text_of_ones_own_learns_and_its_table_is_not_rounded(capsys, tmp_path):
    file, out = tmp_path / "mine.frb", tmp_path / "out.lut"
    file.write_text((RULEBASES / "soc-table.frb").read_text().replace("bound bound", "bound 4"))
    status, _, _ = run(capsys, "learn", str(file), *FAST, "--rate", "0.01", "-o", str(out))
    assert status == 0
    table = read_table(out)
    assert table.rounding is None
    assert table.names == ("joint", "e", "ce")
    changed = table.values != read_table(RULEBASES / "thesis-6.1.lut").values
    assert changed.any()
    assert (np.abs(table.values[changed]) <= 4.0).all()
    assert (np.abs(table.values[changed] * 10 - np.round(table.values[changed] * 10)) > 0.01).any()
    assert dict(table.provenance)["controller"] == "mine.frb"
    assert dict(table.provenance)["start"] == "thesis-6.1.lut"
    assert run(capsys, "learn", str(RULEBASES / "stfc.frb"))[0] == 1
