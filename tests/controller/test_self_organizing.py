"""Self-organizing control against its description in plain Python; training."""

import math

import numpy as np
import pytest

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.controllers import Controller, Sources, controller
from fuzzyarm.control.controllers.catalogue import CATALOGUE, Choice, text_controller
from fuzzyarm.control.controllers.on_plant import learned
from fuzzyarm.control.controllers.text import teaching
from fuzzyarm.control.loop import simulate
from fuzzyarm.language import RuleBaseError
from fuzzyarm.learning import train
from fuzzyarm.plant import pick_and_place
from fuzzyarm.plant.setting import RunArithmetic
from fuzzyarm.symbolic.kernels import has_machine_code
from fuzzyarm.table import Axis, LookupTable, read_table


def shipped_table(name):
    return read_table(shipped(name))


def taught(name, rate=None, delay=None, **sources):
    """Return a shipped controller that learns, at another rate or delay."""
    choice = Choice(sources=Sources(**sources))
    return text_controller(CATALOGUE[name].file(), choice, change=teaching(rate, delay))


def kept_by(made, run):
    """Return what it has learned in a run."""
    return learned(made.law, RunArithmetic(compiled=has_machine_code()), run.memory)


SHORT = pick_and_place(segment=0.4)
YAMAZAKI = shipped_table("performance-yamazaki.lut")
PROCYK = shipped_table("performance-procyk-mamdani.lut")


class Described(Controller):
    """The previous cells are corrected by the judgement of the present, then looked up."""

    name = "described"

    def __init__(self, performance, start, rate=1.0, delay=1, bound=6.0):
        self.performance, self.begin = performance, start
        self.rate, self.delay, self.bound = rate, delay, bound

    def start(self, single=False):
        self.tables = [np.array(self.begin), np.array(self.begin)]
        self.used = [[], []]

    def torque(self, reference, state, clock):
        out = []
        for j, ratio in ((0, 80.0), (1, 70.0)):
            e = (reference.position[j] - state.position[j]) * (1080.0 / math.pi)
            ce = (reference.velocity[j] - state.velocity[j]) * (10.8 / math.pi)
            cell = self.performance.cell(e, ce)
            self.used[j].append(cell)
            if len(self.used[j]) > self.delay:
                judged = self.used[j][-1 - self.delay]
                value = self.tables[j][judged] + self.rate * self.performance.lookup(e, ce)
                self.tables[j][judged] = min(max(value, -self.bound), self.bound)
            control = self.tables[j][cell]
            v = state.velocity[j]
            out.append((20.0 * control / 6.0 - 0.066 * v * ratio) * 0.066 / 2.32 * ratio)
        return out


@pytest.mark.parametrize(
    ("performance", "start", "rate", "delay"),
    [
        (YAMAZAKI, None, 1.0, 1),
        (PROCYK, None, 1.0, 1),
        (YAMAZAKI, "thesis-6.1.lut", 1.0, 1),
        (YAMAZAKI, None, 0.125, 0),
        (PROCYK, "thesis-6.1.lut", 0.5, 4),
    ],
)
def test_runs_like_its_description(performance, start, rate, delay):
    table = shipped_table(start) if start else None
    begin = table.values if table else np.zeros((13, 13))
    made = taught("soc-zero", rate, delay, table=table, performance=performance)
    told = Described(performance, begin, rate, delay)
    ours, theirs = simulate(made, SHORT, payload=True), simulate(told, SHORT, payload=True)
    # The last bits differ by the order of multiplications, and the loop magnifies them.
    np.testing.assert_allclose(ours.error_matrix[:300], theirs.error_matrix[:300], atol=1e-5)
    kept = kept_by(made, ours)
    assert np.abs(kept.values).max() <= 6.0
    assert kept.visits.sum() == 2 * 5 * len(ours.error_matrix)
    untouched = kept.visits == 0
    np.testing.assert_array_equal(kept.values[untouched], np.stack([begin, begin])[untouched])


def test_a_rate_of_zero_is_control_by_the_table():
    table = shipped_table("thesis-6.1.lut")
    frozen = controller("soc-table").with_gains({"learning_rate": [0.0]})
    fixed = controller("fuzzy-lut-x10", sources=Sources(table=table))
    np.testing.assert_array_equal(
        simulate(frozen, SHORT, payload=True).error_matrix,
        simulate(fixed, SHORT, payload=True).error_matrix,
    )


def test_the_bound_holds_and_a_performance_table_of_another_grid_serves():
    coarse = LookupTable(
        (Axis("e", (-1, 0, 1), (-0.5, 0.5)), Axis("ce", (0,))), "p", [[-2], [0], [2]]
    )
    made = controller("soc-table", sources=Sources(performance=coarse))
    made = made.with_gains({"bound": [2.5]})
    kept = kept_by(made, simulate(made, SHORT))
    changed = kept.values != shipped_table("thesis-6.1.lut").values
    assert changed.any()
    assert np.abs(kept.values[changed]).max() == 2.5


@pytest.mark.parametrize("delay", ["-1", "0.5", "2000"])
def test_a_delay_out_of_range_is_refused(delay, tmp_path):
    file = tmp_path / "soc.frb"
    file.write_text(CATALOGUE["soc-zero"].file().read_text().replace("delay 1", f"delay {delay}"))
    with pytest.raises(RuleBaseError, match="periods is out of range"):
        text_controller(file, Choice())


def test_tables_that_cannot_be_corrected_are_refused():
    smooth = LookupTable(YAMAZAKI.axes, "u", np.zeros((13, 13)), mode="linear")
    with pytest.raises(RuleBaseError, match="no responsible cell"):
        controller("soc-zero", sources=Sources(table=smooth))


def test_training_in_stretches_is_one_run():
    made = controller("soc-zero")
    whole = simulate(made, SHORT, payload=True)
    shots = list(train(made, SHORT, every=37, payload=True))
    assert shots[-1].complete
    assert not any(shot.complete for shot in shots[:-1])
    np.testing.assert_array_equal(shots[-1].errors, whole.error_matrix)
    np.testing.assert_array_equal(shots[-1].learned.values, kept_by(made, whole).values)
    growing = [int(shot.learned.visits.sum()) for shot in shots]
    assert growing == sorted(growing)


def test_passes_go_on_from_what_was_learned():
    made = controller("soc-zero").with_gains({"learning_rate": [0.01]})
    shots = list(train(made, pick_and_place(), passes=3, payload=True))
    assert [shot.passage for shot in shots] == [1, 2, 3]
    assert (shots[2].rms < 0.1 * shots[0].rms).all()
    assert shots[2].points == 3 * shots[0].points


def test_a_training_that_diverges_ends_there():
    made = controller("soc-zero").with_gains({"supply": [1e6]})
    *_, last = train(made, SHORT, passes=5)
    assert last.diverged is not None
    assert last.passage == 1


def test_an_error_on_the_edge_of_a_bin_belongs_to_the_lower_cell():
    # A run begins with errors of exactly 0. The middle cells below reach from just above -1e-300
    # to 0, both ends of which are thresholds: nothing but an error of 0 falls into them, and
    # only if a number that is equal to a threshold belongs to the lower cell.
    def pinhole(name):
        return Axis(name, (-1, 0, 1), (-1e-300, 0.0))

    start = LookupTable((pinhole("e"), pinhole("ce")), "u", np.zeros((3, 3)))
    judgement = np.zeros((3, 3))
    judgement[1, 1] = 2.0
    judge = start.with_values(judgement)
    coarse = LookupTable((pinhole("e"), Axis("ce", (0,))), "p", judgement[:, 1:2])
    for performance in (judge, coarse):
        made = taught("soc-table", delay=0, table=start, performance=performance)
        kept = kept_by(made, simulate(made, SHORT))
        assert kept.visits[:, 1, 1].min() >= 1
        # Without a delay the cell in use is the responsible one.
        assert kept.values[:, 1, 1].min() >= 2.0
