"""Every conventional and adaptive row against the published figures, through the real code.

The bounds below are written here on purpose, apart from those the package judges by.
"""

import numpy as np
import pytest

from fuzzyarm.apps.study import find_rows, judge, reproduce_row, variants
from fuzzyarm.apps.study.reproduce import count_within, row_controller
from fuzzyarm.control.controllers import CATALOGUE
from fuzzyarm.control.loop import Options

EXACT = ["pd", "pid", "pid-modified", "ct", "ffid", "cdid", "ct+ie", "ffid+ie", "cdid+ie", "acdid"]
ONE_PERCENT = ["5.4.2", "7.1.1/acdid+ie", "5.5.1", "7.1.1/mrac", "5.5.2"]

STUCK = {("4.2.5.1/pid", 1): 0.0015}
"""The one final error known to be further off: printed as 0.0, 0.0013 degrees here."""


def rms_differences(result):
    places = [0, 2, 4, 6]
    got, wanted = np.array(result.figures), np.array(result.published.figures)
    return np.abs(got[places] / wanted[places] - 1.0)


@pytest.mark.parametrize("row", find_rows(EXACT), ids=lambda row: row.identifier)
def test_rows_that_have_to_come_out_exactly(row):
    result = reproduce_row(row)
    assert rms_differences(result).max() <= 0.005
    for index in (1, 3, 5, 7):
        if row.trajectories[index // 4] == "pick-and-place":
            continue
        off = abs(result.figures[index] - row.figures[index])
        allowed = max(0.001, 0.005 * abs(row.figures[index]))
        assert off <= STUCK.get((row.identifier, index), allowed)


@pytest.mark.parametrize("row", find_rows(EXACT[:-1]), ids=lambda row: row.identifier)
def test_maxima_of_the_conventional_rows(row):
    result = reproduce_row(row)
    for index in (5, 7):
        if row.trajectories[1] == "pick-and-place":
            assert result.figures[index] == pytest.approx(row.figures[index], rel=0.005)


@pytest.mark.parametrize("row", find_rows(ONE_PERCENT), ids=lambda row: row.identifier)
def test_adaptive_rows_within_one_percent(row):
    assert rms_differences(reproduce_row(row)).max() <= 0.01


def test_the_integral_of_mrac_has_the_printed_digits_from_a_cold_start_alone():
    cold, warm = (reproduce_row(row) for row in find_rows(["mrac+ie"]))
    assert (cold.published.start, warm.published.start) == ("cold", "warm")
    assert cold.figures == pytest.approx(cold.published.figures, abs=1.01e-4)
    assert 0.040 < rms_differences(warm).max() < 0.042
    assert not warm.judgement.within
    assert "4.09 % (bound 4 %)" in warm.judgement.sentence


def test_a_report_counts_rows_by_how_near_they_come():
    (row,) = find_rows(["7.1.1/cdid"])
    figures = [tuple(each * (1 + off) for each in row.figures) for off in (0, 0.015, 0.03, 0.2)]
    counted = count_within([judge(row, each) for each in figures])
    assert counted == {0.01: 1, 0.02: 2, 0.05: 3}


@pytest.mark.parametrize("name", ["dac", "dac+ie"])
def test_decentralised_rows_within_five_percent_and_two_in_the_mean(name):
    (row,) = find_rows([name])
    differences = rms_differences(reproduce_row(row))
    assert differences.max() <= 0.05
    assert differences.mean() <= 0.02


def test_single_precision_shows():
    # Final errors of ±0.0029 degrees are positions that stick at a last bit.
    (row,) = find_rows(["4.2.5.1/ffid"])
    figures = reproduce_row(row).figures
    assert figures[1] == pytest.approx(-0.0029, abs=5e-5)
    assert figures[3] == pytest.approx(0.0030, abs=5e-5)


def test_rows_with_two_variants_are_those_whose_text_and_figures_disagree():
    both = {
        row.controller
        for row in find_rows([])
        if not CATALOGUE[row.controller].accepts and len(variants(row)) == 2
    }
    assert both == {"ct", "ct+ie", "acdid", "acdid+ie", "mrac", "mrac+ie", "dac+ie"}


def test_as_described_rows_give_other_figures():
    (row,) = find_rows(["7.1.1/acdid"])
    figures = reproduce_row(row, "as-described").figures
    # With the regressor of the theory: known figures of the second trajectory.
    assert figures[4] == pytest.approx(0.0397, abs=1e-4)
    assert figures[6] == pytest.approx(0.0338, abs=1e-4)
    (row,) = find_rows(["7.1.1/mrac+ie"])
    assert reproduce_row(row, "as-described").figures[1] == pytest.approx(1.05, abs=0.01)


def test_inexact_model_is_the_only_difference_of_its_rows():
    exact, inexact = (row_controller(find_rows([name])[0]) for name in ("4.2.5.1/ct", "4.2.5.2/ct"))
    changed = {name for name in exact.gains if exact.gains[name] != inexact.gains[name]}
    assert changed == {"model.m_1", "model.m_2"}


def test_judgement_sees_a_wrong_figure():
    (row,) = find_rows(["7.1.1/cdid"])
    assert judge(row, row.figures).within
    wrong = (row.figures[0] * 1.006, *row.figures[1:])
    judgement = judge(row, wrong)
    assert not judgement.within
    assert "DIFFERS" in judgement.sentence
    final = (row.figures[0], row.figures[1] + 0.0012, *row.figures[2:])
    assert not judge(row, final).within
    maximum = (*row.figures[:5], 9.9, *row.figures[6:])
    assert judge(row, maximum).within


@pytest.mark.slow
def test_a_row_runs_interpreted_with_the_same_figures():
    (row,) = find_rows(["7.1.1/cdid+ie"])
    interpreted = reproduce_row(row, options=Options(compiled=False))
    assert interpreted.figures == reproduce_row(row).figures
