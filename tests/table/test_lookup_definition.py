"""Every reading of a table against the definition in fractions, on ties, edges and levels."""

from __future__ import annotations

import math

import numpy as np
import pytest
import table_definition as definition
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.table import Axis, LookupTable
from fuzzyarm.table.lookup import (
    interpolator,
    looked_up,
    pack_grid,
    picker,
)

MODES = ["bins", "nearest", "linear"]

# Eighths: midpoints, shares and products of three of them are exact in a float, so that a
# result is the exact one or wrong.
eighths = st.integers(-80, 80).map(lambda k: k / 8)


@st.composite
def exact_tables(draw, axes):
    sides = []
    for name in "abc"[:axes]:
        count = draw(st.integers(1, 5))
        first = draw(st.integers(-10, 10))
        # Widths of powers of two: the share of the way is exact, too.
        widths = draw(st.lists(st.sampled_from([1, 2, 4]), min_size=count, max_size=count))
        levels = [float(first + sum(widths[:k])) for k in range(count)]
        bins = draw(st.none() | st.sets(eighths, min_size=count - 1, max_size=count - 1))
        sides.append(Axis(name, tuple(levels), bins and tuple(sorted(bins))))
    shape = [len(side.levels) for side in sides]
    size = math.prod(shape)
    values = draw(st.lists(st.integers(-99, 99), min_size=size, max_size=size))
    return LookupTable(tuple(sides), "u", np.reshape(np.array(values, float), shape))


def ties(axis):
    """Levels, thresholds and midpoints, the next numbers on both sides, and numbers outside."""
    middles = [(a + b) / 2 for a, b in zip(axis.levels, axis.levels[1:], strict=False)]
    near = [*axis.levels, *(axis.bins or ()), *middles]
    around = [math.nextafter(x, way) for x in near for way in (-math.inf, math.inf)]
    return st.sampled_from([*near, *near, *around, axis.levels[0] - 3, axis.levels[-1] + 3, -0.0])


def expected(table, point, mode):
    if mode == "linear":
        return float(definition.interpolated(table.axes, table.values, point))
    return float(definition.picked(table.axes, table.values, point, mode))


def agree(found, wanted, mode):
    # Beside a level a share is tiny and rounded: an error of one unit in the last place of 99.
    assert found == wanted or (mode == "linear" and abs(found - wanted) < 1e-13)


@given(st.data(), st.integers(1, 3).flatmap(exact_tables), st.sampled_from(MODES))
def test_points_arrays_and_kernels(data, table, mode):
    points = [[data.draw(ties(axis)) for axis in table.axes] for _ in range(4)]
    wanted = [expected(table, point, mode) for point in points]
    columns = [np.array(column) for column in zip(*points, strict=True)]
    arrays = table.lookup(*columns, mode=mode)
    kernels = np.empty(len(points))
    way = interpolator if mode == "linear" else picker
    sides = [a.levels if mode == "linear" else a.thresholds(mode) for a in table.axes]
    evaluate = way(table.values, sides, compiled=False)
    assert evaluate is not None
    assert evaluate(columns, kernels)
    for k, point in enumerate(points):
        for found in (table.lookup(*point, mode=mode), arrays[k], kernels[k]):
            agree(found, wanted[k], mode)


def in_the_loop(look_up, table, point, mode, room=()):
    """Look up as a controller does: a grid at some index, then values, inputs and room."""
    grid = pack_grid(table.axes, mode)
    values = 1 + len(grid)
    inputs = values + table.values.size
    room = room or [0.0] * (len(point) + 2 ** len(point))
    cells = np.array([7.0, *grid, *table.values.ravel().tolist(), *point, *room])
    whole = np.array([values, inputs + len(point), *range(inputs, inputs + len(point))])
    return look_up(whole, cells, 0, 1)


@given(st.data(), exact_tables(2), st.sampled_from(MODES))
def test_the_kernels_of_a_closed_loop(data, table, mode):
    point = [data.draw(ties(axis)) for axis in table.axes]
    found = in_the_loop(looked_up, table, point, mode)
    agree(found, expected(table, point, mode), mode)


@given(st.data(), exact_tables(2), st.sampled_from([mode for mode in MODES if mode != "linear"]))
def test_where_an_input_was_last_changes_nothing(data, table, mode):
    last = [float(data.draw(st.integers(0, len(axis.levels) - 1))) for axis in table.axes]
    last += [0.0] * 4  # room for more than a look-up by cell needs
    anywhere = st.sampled_from([math.inf, -math.inf, math.nan])
    point = [data.draw(st.one_of(ties(axis), anywhere)) for axis in table.axes]
    fresh = in_the_loop(looked_up, table, point, mode)
    assert in_the_loop(looked_up, table, point, mode, last) == fresh


def test_not_a_number_in_the_loop_is_the_lowest_cell():
    axes = (Axis("e", (-1.0, 1.0), (0.0,)), Axis("ce", (0.0, 1.0, 2.0)))
    table = LookupTable(axes, "u", [[1, 2, 3], [4, 5, 6]])
    for mode in MODES:
        assert in_the_loop(looked_up, table, (math.nan, 1.0), mode) == 2.0


@pytest.mark.parametrize("mode", MODES)
def test_threads_give_what_one_thread_gives(mode, monkeypatch):
    from fuzzyarm.table import lookup

    axes = (Axis("e", (-2.0, -1.0, 1.0, 3.0), (-1.0, 0.0, 2.5)), Axis("ce", (0.0, 0.5, 1.0)))
    table = LookupTable(axes, "u", np.arange(12.0).reshape(4, 3) ** 2)
    e, ce = np.linspace(-3, 4, 57)[:, None], np.linspace(-1, 2, 31)
    plain = table.lookup(e, ce, mode=mode)
    flat = table.lookup(*map(np.ravel, np.broadcast_arrays(e, ce)), mode=mode)
    monkeypatch.setattr(lookup, "worthwhile", lambda points: True)
    monkeypatch.setattr(lookup, "_machine", lambda function, compiled: function)
    monkeypatch.setattr(lookup, "WORTH_THREADS", 1)
    monkeypatch.setattr(lookup, "processors", lambda: 3)
    for x, y in ((e, ce), (e.T, ce[:, None])):
        found = table.lookup(x, y, mode=mode)
        np.testing.assert_array_equal(found, plain if x is e else plain.T)
    np.testing.assert_array_equal(
        table.lookup(*map(np.ravel, np.broadcast_arrays(e, ce)), mode=mode), flat
    )
    with pytest.raises(lookup.TableError, match="input 'ce' of the table is not a number"):
        table.lookup(e, np.where(ce > 1.9, np.nan, ce), mode=mode)
