"""Several controllers in the same many runs: median, worst, failures, and where one is better."""

import csv
import json
from itertools import product

import numpy as np
import pytest

from fuzzyarm.apps.cli import main
from fuzzyarm.control.loop import Many, paired_comparison, robustness, simulate_many
from fuzzyarm.control.loop.metrics import METRICS
from fuzzyarm.control.loop.robustness import RobustnessError

SHORT = ["--segment", "0.3", "--hold", "0.1"]
RANGES = ["--sweep", "payload=0..2:3", "--set", "K_P=20..800:2"]
ASKED = ["sweep", "pd", "pid", "fuzzy-lut", *SHORT, *RANGES]


def many(name, rms, changes, diverged=()):
    """Return runs of one output with these errors; those with NaN have no value."""
    rms = np.asarray(rms, float)
    values = np.full((len(rms), 1, len(METRICS)), np.nan)
    values[:, 0, METRICS.index("rms")] = rms
    lost = np.full(len(rms), np.nan)
    lost[list(diverged)] = 0.5
    return Many(
        controller=name,
        plant="p",
        trajectory="t",
        outputs=("x",),
        units=("m",),
        changes={key: np.asarray(column, float) for key, column in changes.items()},
        seeds=np.arange(len(rms)),
        diverged=lost,
        values=values,
    )


def test_failed_runs_are_infinite_in_the_median_and_not_the_worst():
    a = {"a": range(5)}
    rows = robustness([
        many("one", [1, -7, 3, np.nan, 2], a),
        many("two", [1, 2, 3, 4, 9], a, diverged=[2, 3, 4]),
        many("none", [np.nan] * 5, a),
    ])  # fmt: skip
    assert [(r.controller, r.median, r.worst, r.run, r.failed) for r in rows] == [
        ("one", 3.0, 7.0, 1, 1),
        ("two", None, 2.0, 1, 3),
        ("none", None, None, None, 5),
    ]


def test_where_one_is_better_over_one_name():
    a = {"a": [1, 2, 3, 4, 5, 6]}
    one = many("one", [1, 1, 5, 2, 3, np.nan], a)
    two = many("two", [2, 2, 4, 2, 9, 1], a, diverged=[5])
    found = paired_comparison(one, two)
    assert (found.better, found.worse) == (3, 1)  # equal ones and two failed ones are neither
    assert found.better_where == {"a": [(1.0, 2.0), (5.0, 5.0)]}
    assert found.worse_where == {"a": [(3.0, 3.0)]}
    other_way = paired_comparison(two, one)
    assert (other_way.better, other_way.better_where) == (found.worse, found.worse_where)


def test_where_one_is_better_over_two_names_it_is_whatever_the_other_is():
    a, b = np.array(list(product([1, 2, 3], [10, 20]))).T
    one = many("one", [1, 1, 1, 5, 5, 5], {"a": a, "b": b})
    found = paired_comparison(one, many("two", [2] * 6, {"a": a, "b": b}))
    assert (found.better_where, found.worse_where) == ({"a": [(1.0, 1.0)]}, {"a": [(3.0, 3.0)]})


def test_results_of_other_runs_are_not_compared():
    with pytest.raises(RobustnessError, match="one and two are not compared in the same runs"):
        paired_comparison(many("one", [1, 2], {"a": [1, 2]}), many("two", [1, 2], {"a": [1, 3]}))


# --- The command ---


def runs_of(name, gain=True):
    payload, k_p = np.array(list(product([0.0, 1.0, 2.0], [20.0, 800.0]))).T
    changes = {"payload": payload} | ({"K_P": k_p} if gain else {})
    from fuzzyarm.plant import reach_return

    return simulate_many(name, reach_return(segment=0.3, hold=0.1), changes)


def test_each_controller_runs_as_by_itself_and_a_gain_is_swept_where_it_is(tmp_path, capsys):
    file = tmp_path / "sweep.csv"
    assert main([*ASKED, "-o", str(file)]) == 0
    shown = capsys.readouterr().out
    assert "6 runs of each" in shown
    heading, *rows = (
        row for row in csv.reader(file.read_text().splitlines()) if not row[0].startswith("#")
    )
    assert heading[:6] == ["run", "controller", "payload", "K_P", "seed", "diverged"]
    column = heading.index("joint2.rms")
    for number, (name, gain) in enumerate((("pd", True), ("pid", True), ("fuzzy-lut", False))):
        own = rows[6 * number : 6 * number + 6]
        assert {row[1] for row in own} == {name}
        assert [float(row[column]) for row in own] == runs_of(name, gain).rms[:, 1].tolist()
        assert [row[4] for row in own] == [str(seed) for seed in range(1, 7)]


def test_the_report_has_what_numpy_says_of_the_runs(capsys):
    assert main([*ASKED, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    results = [runs_of("pd"), runs_of("pid"), runs_of("fuzzy-lut", gain=False)]
    values = [abs(each.rms[:, k]) for each in results for k in range(2)]
    said = report["controllers"]
    assert [row["median"] for row in said] == [float(np.median(each)) for each in values]
    assert [row["worst"] for row in said] == [float(each.max()) for each in values]
    better = [(results[0].rms < other.rms).all(axis=1).sum() for other in results[1:]]
    assert [(pair["second"], pair["better"]) for pair in report["pairs"]] == [
        ("pid", better[0]), ("fuzzy-lut", better[1]),
    ]  # fmt: skip


@pytest.mark.parametrize("kept", [0, 5, 6, 13, 17, 18])
def test_a_file_that_was_cut_is_completed_to_the_same_bytes(tmp_path, capsys, kept):
    file = tmp_path / "sweep.csv"
    main([*ASKED, "-o", str(file)])
    complete, shown = file.read_bytes(), capsys.readouterr().out
    file.write_bytes(b"".join(complete.splitlines(keepends=True)[: 3 + kept]) + b"9,pd,")
    assert main([*ASKED, "-o", str(file), "--resume", "--workers", "1"]) == 0
    assert file.read_bytes() == complete
    assert capsys.readouterr().out == shown


def test_pictures_share_their_scales():
    from fuzzyarm.apps.show.sweep import sweep_chart
    from fuzzyarm.base.picture import Cells, Line
    from fuzzyarm.control.loop.sweep import Range

    a, b = np.array(list(product([1, 2, 3], [10, 20]))).T
    over = [Range("a", 1, 3, 3), Range("b", 10, 20, 2)]
    results = [
        many("one", [1, 1, 1, 5, 5, 5], {"a": a, "b": b}),
        many("two", [2] * 6, {"a": a, "b": b}, diverged=[1]),
    ]
    maps = sweep_chart(results, over)
    assert [[panel.title for panel in row] for row in maps.rows] == [["one: x"], ["two: x"]]
    assert {(c.value.low, c.value.high) for p in maps.panels for c in p.of(Cells)} == {(1.0, 5.0)}
    (panel,) = sweep_chart(results, over[:1]).panels
    assert [line.label for line in panel.of(Line)] == ["one", "two"]
    assert sweep_chart(results, over[:1]).title.startswith("one, two on")


def test_controllers_of_other_tasks_are_refused(tmp_path, capsys):
    text = 'controller {0} "x"\nperiod 1 s\naxis a\n  e = error of {0}\n  drive pump = e\n'
    files = []
    for level in ("level1", "level2"):
        files.append(str(tmp_path / f"{level}.frb"))
        (tmp_path / f"{level}.frb").write_text(text.format(level))
    command = ["sweep", *files, "--plant", "tanks", "--step", "0.1", "--for", "9s"]
    assert main([*command, "--sweep", "k=4e-6..5e-6:2"]) == 1
    words = "level1 level1 step:0.1, judged by tanks in m; level2 level2 step:0.1, judged by"
    assert words in capsys.readouterr().err
