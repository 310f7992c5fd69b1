"""Panels as a page hears them: fit for JSON, and nothing beyond the ends of an axis."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.apps.show.plane import MOST_RULINGS, plane_panel
from fuzzyarm.base.picture import (
    COLOURS,
    TONES,
    Axis,
    Band,
    Cells,
    Dots,
    Level,
    Line,
    Panel,
    panel_data,
    short,
)

NUMBERS = st.lists(st.floats(-1e6, 1e6) | st.just(math.nan), min_size=2, max_size=8)


def seen(part, key):
    """Return the numbers of a part along an axis."""
    if part["is"] == "level":
        return [part["at"]] if part["upright"] == (key == "x") else []
    if part["is"] == "band" and key == "y":
        return [*part["low"], *part["high"]]
    return part[key]


@given(NUMBERS, NUMBERS, st.booleans())
def test_all_that_is_drawn_lies_between_the_ends(x, y, upright):
    count = min(len(x), len(y))
    x, y = x[:count], y[:count]
    parts = [Line(x, y), Dots(x, y, "x", COLOURS[3]), Band(x, y, y), Level(x[0], upright=upright)]
    data = panel_data(Panel(parts))
    assert json.loads(json.dumps(data, allow_nan=False)) == data
    for axis, key in (("across", "x"), ("up", "y")):
        low, high = data[axis]["low"], data[axis]["high"]
        assert low < high
        room = 1e-8 * max(abs(low), abs(high))
        for part in data["parts"]:
            for value in seen(part, key):
                assert value is None or low - room <= value <= high + room
    tones = {part["tone"] for part in data["parts"]}
    assert tones <= {*TONES, "series3"}


def test_ends_that_are_said_stay_and_a_logarithm_begins_above_zero():
    axis = Axis("cost", "V", 1.0, 2.0)
    data = panel_data(Panel([Line([0.0, 0.1, 1.0], [5.0, 6.0, 7.0])], Axis(logarithmic=True), axis))
    assert data["up"] == {"words": "cost, V", "low": 1.0, "high": 2.0, "logarithmic": False,
                          "whole": False}  # fmt: skip
    assert (data["across"]["low"], data["across"]["high"]) == (0.1, 1.0)


def test_a_panel_of_nothing_has_axes_all_the_same():
    for logarithmic in (False, True):
        data = panel_data(Panel([], up=Axis(logarithmic=logarithmic)))
        assert data["up"]["low"] < data["up"]["high"]


def test_samples_of_a_plane_are_told_row_by_row():
    points = {"a": np.linspace(0.0, 1.0, 3), "b": np.linspace(-1.0, 1.0, 2)}
    values = np.array([[0.0, 1.0, np.nan], [-3.0, 0.5, 2.0]])
    grid = {"a": [0.0, 0.5, 1.0], "b": range(MOST_RULINGS + 1)}
    panel = plane_panel(
        points, {"": values}, Axis("u"), at={"a": 0.5, "b": 1.0}, signed=True, grid=grid
    )
    cells, *others = panel_data(panel)["parts"]
    assert cells["values"] == [0.0, 1.0, None, -3.0, 0.5, 2.0]
    assert (cells["value"]["low"], cells["value"]["high"]) == (-3.0, 3.0)
    assert [part["is"] for part in others] == ["level"] * 3 + ["dots"]


def test_over_one_input_each_of_the_values_is_a_line():
    points = {"a": np.linspace(0.0, 1.0, 3)}
    values = {"one": np.zeros((1, 3)), "two": np.ones((1, 3))}
    data = panel_data(plane_panel(points, values, Axis("u"), at={"a": 0.25}))
    assert [part.get("label") for part in data["parts"]] == ["one", "two", None]
    assert data["up"]["words"] == "u"
    assert panel_data(plane_panel(points, {"one": np.zeros(3)}, Axis("u")))["up"]["low"] == -1.0


@pytest.mark.parametrize("value", [1.0 / 3.0, -1e-12, 123456789.5])
def test_numbers_have_nine_digits(value):
    cells = Cells([0.0], [0.0], [value], Axis("u", "", -1.0, 1.0))
    assert panel_data(Panel([cells]))["parts"][0]["values"] == [short(value, 9)]
