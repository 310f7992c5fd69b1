"""Identification finds the shipped gains again from round starting points."""

import pytest

from fuzzyarm.apps.study.identify import PROBLEMS, UnknownProblemError, identify


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "tolerance"), [("mrac", 0.01), ("mrac+ie", 0.05), ("acdid+ie", 0.12), ("dac+ie", 0.15)]
)
def test_fit_finds_the_shipped_gains(name, tolerance):
    result = identify(name)
    for label, fitted, shipped in zip(result.labels, result.fitted, result.shipped, strict=True):
        # a is weakly determined by the figures.
        allowed = 1.0 if label == "a" else tolerance
        assert fitted == pytest.approx(shipped, rel=allowed), label
    assert max(map(abs, result.fitted_rms)) < 0.04


@pytest.mark.slow
def test_fit_of_dac_explains_its_row_better_than_the_round_gains():
    result = identify("dac")
    assert max(map(abs, result.fitted_rms)) < max(map(abs, result.shipped_rms)) < 0.05


def test_searches_start_away_from_the_shipped_gains():
    from fuzzyarm.apps.study.identify import _shipped
    from fuzzyarm.apps.study.published import find_rows

    for problem in PROBLEMS.values():
        row = find_rows(list(problem.rows))[0]
        for unknown, shipped in zip(problem.unknowns, _shipped(row, problem.unknowns), strict=True):
            assert abs(unknown.start / shipped - 1.0) > 0.05


def test_unknown_problem():
    with pytest.raises(UnknownProblemError, match="mrac"):
        identify("pd")
