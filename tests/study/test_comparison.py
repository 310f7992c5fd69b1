"""Comparison under changed conditions, chatter, and what a control step costs."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from fuzzyarm import load, shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.apps.study import find_rows, reproduce_row
from fuzzyarm.apps.study.comparison import CONDITIONS, compare, compared_names, watched_run
from fuzzyarm.apps.study.cost import RESOLUTION, CostError, count_operations, measure_time
from fuzzyarm.control.controllers import CompiledController, Controller, controller
from fuzzyarm.control.controllers.law import Law, law_kernel
from fuzzyarm.control.controllers.own import find_controller
from fuzzyarm.control.loop import Options, Signal, simulate
from fuzzyarm.language import read_text
from fuzzyarm.plant import pick_and_place, through
from fuzzyarm.plant.setting import PLAIN, STUDY_TABLES
from fuzzyarm.requests import CompareRequest

SHORT = through([(0.5, -0.4)], segment=0.05)
QUICK = through([(10.0, -10.0), (-5.0, 4.0)], segment=0.3)


def compared(*names, **changed):
    return {each.name: each for each in compare(names, **changed)}


# --- Operations ---


@pytest.mark.parametrize(
    ("name", "arithmetic", "functions"),
    [
        ("pd", 2 * 5, 0),  # two differences, two products, a sum
        ("ie", 2 * 3, 0),  # a difference, a sum, a product
        ("pd+ie", 2 * 8, 0),
        # In texts the sum of the 17 signals of the arm, less itself, is 0 unless one is lost; so is
        # the sum of all values, one for each instruction: three operations for the two tests.
        ("fuzzy-lut", 2 * 7 + 17 + 10 + 3, 0),  # a difference, a product each; the converter: three
        ("pd-motor", 2 * 10 + 17 + 18 + 3, 0),  # four; two products, a sum; the drive: three
        ("ct", 46, 4),
    ],
)
def test_operations_are_those_that_the_text_and_the_equations_have(name, arithmetic, functions):
    counted = count_operations(controller(name))
    assert counted.arithmetic == arithmetic
    assert counted.functions == functions
    assert counted.total == counted.arithmetic + counted.comparisons + counted.functions


def test_a_law_that_does_nothing_costs_nothing():
    counted = count_operations(CompiledController(Law("nothing", law_kernel, "", ())))
    assert counted.total == 0


def test_a_partner_counts_with_its_functions():
    alone, with_table = (
        count_operations(controller("cdid")),
        count_operations(controller("cdid+fuzzy")),
    )
    assert with_table.functions == alone.functions == 4
    assert with_table.arithmetic > alone.arithmetic


def test_counting_changes_no_result():
    from fuzzyarm.apps.study.cost import _Counting

    for name in ("acdid", "stfc", "soc-zero", "cdid+fuzzy"):
        plain = simulate(controller(name), SHORT, options=Options(compiled=False))
        counted = simulate(_Counting(controller(name)), SHORT, options=Options(compiled=False))
        np.testing.assert_array_equal(plain.error_matrix, counted.error_matrix)


@pytest.mark.slow
def test_rules_cost_more_than_a_line_and_two_rule_bases_twice_one():
    totals = {
        name: count_operations(controller(name), SHORT).total
        for name in ("pd-motor", "soc-zero", "fuzzy-smooth", "fuzzy-direct", "stfc")
    }
    assert sorted(totals, key=totals.get) == list(totals)
    assert 1.5 < totals["stfc"] / totals["fuzzy-direct"] < 4.0


class Own(Controller):
    name = "own"

    def torque(self, reference, state, clock):
        return 0.0, 0.0


def test_plain_python_is_not_counted():
    with pytest.raises(CostError, match="'own' are not counted"):
        count_operations(Own())


def test_time_of_a_step_is_measured_beside_a_law_that_does_nothing():
    # Machine code on one side only: what the interpreter adds is far above any disturbance.
    assert measure_time(controller("stfc"), rounds=3) > measure_time(controller("pd"), rounds=3)


# --- Errors and chatter ---


class Noting(Controller):
    """Adds up by how much the torque changes, in plain Python."""

    def __init__(self, name):
        self.inner, self.name = controller(name), name
        self.last, self.sums, self.steps = np.zeros(2), np.zeros(2), 0

    def start(self, single=False):
        self.inner.start(single)

    def torque(self, reference, state, clock):
        torque = np.array(self.inner.torque(reference, state, clock))
        if self.steps:  # that a run begins is not a change
            self.sums += abs(torque - self.last)
        self.last, self.steps = torque, self.steps + 1
        return tuple(torque)


@pytest.mark.parametrize("name", ["pid-modified", "acdid", "fuzzy-lut", "fuzzy-smooth"])
def test_change_of_torque_is_the_mean_over_control_periods(name):
    noting = Noting(name)
    expected = simulate(noting, QUICK, payload=True)
    watched = watched_run(controller(name), QUICK, PLAIN, Options())
    assert watched.rms == pytest.approx(tuple(expected.rms), rel=1e-9)
    changes = noting.sums / (noting.steps - 1)
    assert watched.variation == pytest.approx(tuple(changes), rel=1e-9)
    assert watched.rms_periods == pytest.approx(tuple(expected.rms_periods), rel=1e-9)
    assert watched.rms_path == pytest.approx(tuple(expected.rms_path), rel=1e-9)
    assert watched.diverged is None


@pytest.mark.parametrize("name", ["cdid+ie", "soc-zero", "hfie"])
def test_compared_errors_are_those_of_simulate(name):
    found = compared(name, trajectories=(QUICK, QUICK), conventions=STUDY_TABLES)
    run = simulate(controller(name), QUICK, payload=True, conventions=STUDY_TABLES)
    assert found[name].rms == (*run.rms, *run.rms)


@pytest.mark.parametrize("name", ["fuzzy-lut", "stfc", "pd-motor", "cdid+fuzzy"])
@pytest.mark.parametrize("words", [[], ["--conventions", "study"], ["--no-load-in-hold"]])
def test_no_name_changes_what_is_counted(name, words, tmp_path, capsys):
    copy = tmp_path / "c.frb"
    copy.write_text(read_text(shipped(f"{name}.frb")))
    moves = ["--angles", "30", "-20", "--segment", "0.4"]
    assert (
        main(["compare", name, str(shipped(f"{name}.frb")), str(copy), *moves, *words, "--json"])
        == 0
    )
    first, *others = json.loads(capsys.readouterr().out)
    for result in (first, *others):
        result.pop("controller")  # told apart by their files
    assert others == [first, first]
    runs = []
    for each in (name, str(copy)):
        short = ["simulate", each, "--payload", "--segment", "0.2", "--hold", "0.2"]
        assert main([*short, *words, "--json"]) == 0
        runs.append(json.loads(capsys.readouterr().out))
    assert runs[0] == runs[1]


def test_loaded_like_the_others_the_rules_at_every_step_are_worse_than_published():
    """In its rows of direct fuzzy control the study's arm holds still without its load."""
    expected = {"hfie": 0.1043, "stfc": 0.1886, "cfaf": 0.0936}
    found = compared(*expected)
    without = compared(*expected, conventions=replace(PLAIN, load_in_hold=False))
    for name, first in expected.items():
        assert found[name].rms[0] == pytest.approx(first, abs=5e-5)
        row = find_rows([f"7.1.1/{name}"])[0].corrected
        assert without[name].rms == pytest.approx(row[::2], rel=0.01)


def test_what_the_study_did_for_a_row_is_said_by_options(capsys):
    words = ["--precision", "float64", "--pi", "3.141592653589793", "--no-load-in-hold"]
    long = ["simulate", "stfc", "--payload", "--conventions", "study", *words, "--json"]
    assert main(long) == 0
    run = json.loads(capsys.readouterr().out)
    row = reproduce_row(find_rows(["7.1.1/stfc"])[0])
    assert run["rms"] == list(row.runs[0].rms)
    assert (run["pi"], run["load_in_hold"]) == (math.pi, False)
    assert main(["compare", "pd", "--pi", "4"]) == 2
    assert "4.0 for π is out of range" in capsys.readouterr().err


def test_all_controllers_are_compared():
    names = compared_names()
    assert len(names) == 26 + 5
    assert names[0] == "pd"
    assert names[-1] == "pid-smooth"


def test_with_set_points_interpolated_most_of_the_error_goes():
    names = ("fuzzy-fine", "pd-motor", "acdid+ie", "fuzzy-direct")
    held, between = (
        compared(*names, options=CONDITIONS[each]) for each in ("held", "interpolated")
    )
    assert between["fuzzy-fine"].rms == pytest.approx((0.0043, 0.0022, 0.0044, 0.0028), abs=6e-5)
    assert between["pd-motor"].rms == pytest.approx((0.0029, 0.0015, 0.0029, 0.0018), abs=6e-5)
    assert between["acdid+ie"].error < 0.1 * held["acdid+ie"].error
    # Not everything is the staircase: what does not follow in any case does not gain.
    assert between["fuzzy-direct"].error == pytest.approx(held["fuzzy-direct"].error, rel=0.15)


def test_a_controller_as_text_beats_the_best_row_with_less_chatter_than_soc():
    found = compared("fuzzy-smooth", "pid-smooth", "acdid+fuzzy", "soc-zero", "soc-table")
    best = (0.0130, 0.0119, 0.0290, 0.0226)
    assert found["acdid+fuzzy"].rms == pytest.approx(best, abs=1e-4)
    for name in ("fuzzy-smooth", "pid-smooth"):
        assert all(np.array(found[name].rms) < 0.1 * np.array(best))
        for soc in ("soc-zero", "soc-table"):
            assert max(found[name].variation) < 0.1 * min(found[soc].variation)


def test_it_beats_nothing_in_between_and_on_the_path():
    """It is late by its filter, and there at the one moment at which the study looks."""
    found = compared("fuzzy-smooth", "pid-smooth", "acdid+fuzzy", "pd-motor")
    for name in ("fuzzy-smooth", "pid-smooth"):
        for other in ("acdid+fuzzy", "pd-motor"):
            assert all(np.array(found[name].rms_path) > found[other].rms_path)
            assert all(np.array(found[name].rms_periods) > found[other].rms_periods)


def test_it_does_so_on_moves_on_which_nothing_was_chosen():
    rng = np.random.default_rng(5)
    for _ in range(6):
        points = [tuple(each) for each in rng.uniform(-60, 60, (3, 2))]
        path = through(points, segment=float(rng.uniform(2.0, 3.0)), hold=0.5)
        found = {
            name: simulate(controller(name), path, payload=True).rms
            for name in ("fuzzy-smooth", "acdid+fuzzy", "pd-motor", "soc-table")
        }
        for name in ("acdid+fuzzy", "pd-motor", "soc-table"):
            assert (found["fuzzy-smooth"] < found[name]).all(), (points, name)


# --- Decentralised adaptive control ---


def moves(seed, count=24):
    rng = np.random.default_rng(seed)
    return [
        pick_and_place(tuple(rng.uniform(-90, 90, 2)), segment=float(rng.uniform(0.5, 2.0)))
        for _ in range(count)
    ]


@pytest.mark.parametrize("name", ["dac", "dac+ie", "dac+fuzzy"])
def test_decentralised_control_is_lost_on_fast_moves(name):
    named = pick_and_place((80.0, -20.0), segment=1.0)
    assert simulate(controller(name), named).diverged < 0.1
    lost = [simulate(controller(name), each, payload=True).diverged for each in moves(12)]
    assert sum(each is not None for each in lost) >= 12


def test_its_direct_part_is_what_loses_it():
    without = controller("dac").with_gains({"k": [0.0]})
    assert all(simulate(without, each, payload=True).diverged is None for each in moves(12))


def test_the_catalogue_says_so(capsys):
    assert main(["simulate", "--list"]) == 0
    listed = capsys.readouterr().out.splitlines()
    for name in ("dac", "dac+ie", "dac+fuzzy"):
        (at,) = (i for i, line in enumerate(listed) if line.split()[0] == name)
        assert "note: diverges on fast moves" in listed[at + 1]
    assert sum("note:" in line for line in listed) == 3
    main(["simulate", "pd+dac", "--show-gains"])
    assert "note: dac diverges on fast moves" in capsys.readouterr().err
    fast = ["--trajectory", "pick-and-place", "--angles", "80", "-20", "--segment", "1"]
    assert main(["simulate", "dac+ie", *fast]) == 3
    assert "note: dac+ie diverges on fast moves" in capsys.readouterr().err


# --- Motors with inductance, and a supply that ends ---


def test_torque_limits_keep_decentralised_control_from_infinity():
    named = pick_and_place((80.0, -20.0), segment=1.0)
    run = simulate(controller("dac"), named, payload=True, options=CONDITIONS["saturation"])
    assert run.diverged is None
    assert abs(run.torques).max(axis=0) == pytest.approx([55.44, 48.51])


def test_the_study_asks_for_less_than_its_motors_give():
    names = ("cdid", "acdid+ie", "stfc", "pd-motor")
    plain, saturated = (
        compared(*names, options=CONDITIONS[each]) for each in ("held", "saturation")
    )
    for name in names:
        assert saturated[name].rms == pytest.approx(plain[name].rms, abs=1e-4)


# --- The command ---


@pytest.mark.slow
def test_compare_prints_a_line_for_each(capsys, tmp_path):
    figure = tmp_path / "cost.png"
    words = ["compare", "pd", "pd-motor", "dac", "--interpolate"]
    assert main([*words, "--plot", str(figure), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["controller"] for row in rows] == ["pd", "pd-motor", "dac"]
    assert rows[0]["operations"]["total"] == 10
    assert [row["exported_operations"] for row in rows] == [None, 22, None]
    fours = ("rms", "rms_periods", "rms_path", "variation")
    assert all(len(row[name]) == 4 for row in rows for name in fours)
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert main(words) == 0
    conditions, *lines = capsys.readouterr().out.splitlines()
    assert conditions == (
        "reach-return and pick-and-place with load, interpolate, plain conventions, float64, "
        "π 3.141593"
    )
    errors = ["set points", "all periods", "path"]
    names = ["controller", "pd", "", "", "pd-motor", "", "", "dac", "", ""]
    assert [line[:18].strip() for line in lines] == names
    assert [line[18:30].strip() for line in lines] == ["", *errors * 3]
    assert main([*words, "--markdown"]) == 0
    assert capsys.readouterr().out.startswith("| controller | set points: 1 | 2 | 1 | 2 | all")


@pytest.mark.slow
def test_exported_programs_have_every_rule_in_a_row(capsys):
    from fuzzyarm.exchange.export.cost import step_cost

    assert main(["compare", "hfie", "stfc", "cdid+fuzzy", "--cost", "--json"]) == 0
    rows = {row["controller"]: row for row in json.loads(capsys.readouterr().out)}
    for name in ("hfie", "stfc"):
        counted = step_cost(load(shipped(f"{name}.frb")))
        assert rows[name]["exported_operations"] == counted.exported.total()
        assert rows[name]["operations"]["total"] < 0.4 * counted.exported.total()
    assert rows["cdid+fuzzy"]["exported_operations"] is None


def test_a_run_that_diverges_is_shown_as_such(capsys):
    assert main(["compare", "dac", "pd", "--angles", "80", "-20", "--segment", "1"]) == 0
    _, _, dac, pd, *_ = capsys.readouterr().out.splitlines()
    assert dac.split() == ["dac", "set", "points", *["diverges"] * 4]
    assert len(pd.split()) == 8


@pytest.mark.parametrize(
    "words",
    [["nothing"], ["pd", "--inductance", "-1"], ["pd", "--supply", "0"], ["pd", "--plot", "x.y"]],
    ids=" ".join,
)
def test_what_cannot_be_compared_is_one_clear_line(capsys, words):
    assert main(["compare", *words]) == (1 if words == ["nothing"] else 2)
    found = capsys.readouterr()
    assert found.out == ""
    assert found.err.startswith("fuzzyarm: ")
    assert found.err.count("\n") == 1


def test_a_time_that_is_lost_in_the_noise_is_never_a_figure(monkeypatch, capsys):
    """What a run with a law takes less than one without is the noise of the machine."""
    taken = iter([3e-3, 3e-3, 3e-3, 4e-3])  # warm, then one pair: the law is faster than nothing

    class Run:
        seconds = property(lambda self: next(taken))

    with monkeypatch.context() as patched:
        patched.setattr("fuzzyarm.apps.study.cost.simulate", lambda *a, **k: Run())
        assert measure_time(controller("pd"), rounds=1) == RESOLUTION
    measured = iter([RESOLUTION, 4.2e-8])
    monkeypatch.setattr(
        "fuzzyarm.apps.study.comparison.measure_time", lambda *a, **k: next(measured)
    )
    assert main(["compare", "pd", "ct", "--cost"]) == 0
    rows = {line.split()[0]: line for line in capsys.readouterr().out.splitlines() if line}
    assert rows["pd"].rstrip().endswith(" < 10")
    assert rows["ct"].rstrip().endswith(" 42")


@pytest.mark.parametrize("settings", [(), ("G_e=10",)])
def test_a_request_compares_along_references(settings):
    servo = str(shipped("servo.frb"))
    request = CompareRequest(
        controllers=(servo,), plant="motor", step=0.1, duration="0.1s", set=settings
    )
    (found,) = compare(request)
    gains = {key: [float(value)] for key, _, value in (word.partition("=") for word in settings)}
    run = simulate(
        find_controller(servo).with_gains(gains),
        "motor",
        reference={"position": Signal("step", (0.1,))},
        duration=0.1,
    )
    assert found.rms == pytest.approx([metrics.rms for metrics in run.metrics.values()])
