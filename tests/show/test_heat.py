from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.apps.show.drawing import HeatGrid, curve_blocks, height_at, plain_text, scale_of
from fuzzyarm.apps.show.table import table_grids, table_view
from fuzzyarm.table import Axis, LookupTable

ASYMMETRIC = LookupTable(
    (Axis("e", (-1, 0, 2)), Axis("ce", (0, 10, 20, 40))),
    "u",
    [[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12]],
)


def lines_of(table: LookupTable, **options) -> list[list[str]]:
    text = "".join(plain_text(grid) for grid in table_grids(table, **options))
    return [line.split() for line in text.splitlines()]


def test_rows_are_the_first_input():
    assert lines_of(ASYMMETRIC) == [
        ["e", "\\", "ce", "0", "10", "20", "40"],
        ["-1", "1", "2", "3", "4"],
        ["0", "5", "6", "7", "8"],
        ["2", "9", "10", "11", "12"],
    ]


def test_other_numbers_on_the_same_axes_and_marked_cells():
    visits = np.arange(12).reshape(3, 4)
    lines = lines_of(ASYMMETRIC, values=visits, mark=lambda index: index == (2, 1))
    assert lines[3] == ["2", "8", "[9]", "10", "11"]


@given(st.integers(20, 120), st.integers(1, 40), st.data())
def test_every_cell_is_there_at_any_width(width, count, data):
    numbers = data.draw(st.lists(st.integers(-999, 999), min_size=count, max_size=count))
    grid = HeatGrid(
        "corner", [str(k) for k in range(count)], ["r"], [[(str(x), "") for x in numbers]]
    )
    lines = plain_text(grid, width).splitlines()
    shown = [int(x) for line in lines if re.match(r" *r ", line) for x in line.split()[1:]]
    assert shown == numbers
    assert max(map(len, lines)) <= width


def test_thirteen_columns_of_minus_five_point_six_fit_80_columns():
    levels = tuple(range(-6, 7))
    table = LookupTable((Axis("e", levels), Axis("ce", levels)), "u", np.full((13, 13), -5.6))
    text = plain_text(table_grids(table)[0])
    assert len(text.splitlines()) == 14
    assert max(map(len, text.splitlines())) <= 80


@pytest.mark.slow
def test_large_tables_are_thinned_out_and_say_so():
    levels = tuple(range(201))
    values = np.add.outer(1000 * np.arange(201), np.arange(201))
    table = LookupTable((Axis("e", levels), Axis("ce", levels)), "u", values)
    text = plain_text(table_view(table), 120)
    assert "13 of the 201 levels of e and 13 of the 201 levels of ce" in text
    assert "200200" in text
    everything = plain_text(table_view(table, all_levels=True), 120)
    assert "13 of" not in everything
    assert "123045" in everything


@pytest.mark.parametrize(
    ("values", "diverging", "ends"),
    [
        ([-1, 4], True, (-4, 4)),
        ([0, 4], False, (0, 4)),
        ([], False, (0, 1)),
        ([-3], False, (-3, -3)),
    ],
)
def test_scales(values, diverging, ends):
    scale = scale_of([*values, float("nan")])
    assert (scale.diverging, (scale.low, scale.high)) == (diverging, ends)
    assert scale.style(0.0).startswith(("black on #", "white on #"))


def test_zero_is_the_neutral_colour_of_a_diverging_scale():
    scale = scale_of([-1, 7])
    assert scale.colour(0) == (247, 247, 247)
    assert scale.colour(-7)[2] > scale.colour(-7)[0]
    assert scale.colour(7)[0] > scale.colour(7)[2]


def test_curves_show_peaks_and_edges():
    curve = [(0, 0), (5, 1), (5, 0), (10, 0)]
    assert height_at(curve, 5) == 1.0
    assert height_at(curve, 2.5) == 0.5
    assert height_at(curve, 11) == 0.0
    drawn = curve_blocks(curve, 0, 10, 11)
    assert drawn[5] == "█"
    assert drawn[6:] == "     "
