"""Machine code for large arrays gives the bits of the reference, and comes only when asked."""

from __future__ import annotations

import math

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from table_strategies import tables

from fuzzyarm.table import Axis, LookupTable, TableError, lookup
from fuzzyarm.table.lookup import interpolator, make_finder, picker


def columns_for(table, seed, count=200):
    random = np.random.default_rng(seed)
    columns = []
    for axis in table.axes:
        near = np.array([*axis.levels, *axis.thresholds("bins"), *axis.thresholds("nearest")])
        around = [np.nextafter(near, way) for way in (-np.inf, np.inf)]
        points = np.concatenate([near, *around, [np.inf, -np.inf, 1e300, -1e300, 0.0]])
        low, high = axis.levels[0] - 1.0, axis.levels[-1] + 1.0
        chosen = np.where(
            random.random(count) < 0.5,
            random.choice(points, count),
            random.uniform(low, high, count),
        )
        columns.append(chosen)
    return columns


def same_as_the_reference(table, mode, columns, *, machine):
    way = interpolator if mode == "linear" else picker
    points = [a.levels if mode == "linear" else a.thresholds(mode) for a in table.axes]
    evaluate = way(table.values, points, compiled=machine)
    out = np.empty(columns[0].size)
    with np.errstate(all="ignore"):
        expected = table.lookup(*columns, mode=mode)
        assert evaluate is None or evaluate(columns, out)
    if evaluate is not None:
        np.testing.assert_array_equal(out, expected)
    return evaluate is not None


@settings(max_examples=cases(20, 60))
@given(tables(max_axes=3), st.sampled_from(["bins", "nearest", "linear"]), st.integers(0, 2**32))
def test_the_kernels_find_what_bisection_finds(table, mode, seed):
    if mode == "linear" and np.abs(table.values).max() > 1e300:
        return  # a difference of values overflows in either
    same_as_the_reference(table, mode, columns_for(table, seed, 60), machine=False)


UNEVEN = LookupTable(
    (
        Axis("a", (-2.0, -1.9, -0.3, 0.1, 5.0), bins=(-1.0, -0.5, 0.0, 4.0)),
        Axis("alone", (1.0,)),
        Axis("b", tuple(np.linspace(-6, 6, 13))),
        Axis("c", (0.0, 1e-9, 2e-9, 1.0)),
    ),
    "u",
    np.random.default_rng(1).normal(size=(5, 1, 13, 4)),
)


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["bins", "nearest", "linear"])
def test_machine_code_gives_the_same_bits(mode):
    for table in (UNEVEN, LookupTable(UNEVEN.axes[2:3], "v", UNEVEN.values[0, 0, :, 0])):
        assert same_as_the_reference(table, mode, columns_for(table, 3, 50_000), machine=True)


@pytest.mark.parametrize("mode", ["bins", "nearest", "linear"])
@pytest.mark.parametrize("axis", range(4))
def test_a_nan_is_no_number_on_any_axis(mode, axis):
    """An axis with one level has nothing to look up, and a NaN there is one all the same."""
    columns = [np.full(3, 0.5) for _ in range(4)]
    columns[axis][1] = np.nan
    way = interpolator if mode == "linear" else picker
    points = [a.levels if mode == "linear" else a.thresholds(mode) for a in UNEVEN.axes]
    evaluate = way(UNEVEN.values, points, compiled=False)
    with np.errstate(invalid="ignore"):
        assert evaluate is None or not evaluate(columns, np.empty(3))


@pytest.mark.slow
def test_large_arrays_of_any_shape_go_through_it(monkeypatch):
    a, b = np.linspace(-3, 6, 400)[:, None], np.linspace(-7, 7, 300)[None, :]
    plain = UNEVEN.lookup(a, 1.0, b, 0.5, mode="linear")
    monkeypatch.setattr(lookup, "WORTH_CALLING", 1)
    used = []
    monkeypatch.setattr(
        lookup, "interpolator", lambda *words: used.append(1) or interpolator(*words)
    )
    np.testing.assert_array_equal(UNEVEN.lookup(a, 1.0, b, 0.5, mode="linear"), plain)
    np.testing.assert_array_equal(UNEVEN.lookup(a[::-1], 1.0, b, 0.5, mode="linear"), plain[::-1])
    assert used
    with pytest.raises(TableError, match="input 'b' of the table is not a number"):
        UNEVEN.lookup(a, 1.0, np.where(b > 6, np.nan, b), 0.5, mode="nearest")


@given(st.lists(st.floats(-1e6, 1e6), min_size=0, max_size=40, unique=True), st.integers(0, 999))
def test_a_finder_counts_smaller_points(points, seed):
    points = sorted({x + 0.0 for x in points})
    finder = make_finder(points)
    if finder is None:
        return
    random = np.random.default_rng(seed)
    near = [math.nextafter(x, way) for x in points for way in (-math.inf, math.inf)]
    x = np.array([*points, *near, *random.uniform(-2e6, 2e6, 5), np.inf, -np.inf])
    index, missing = np.zeros(x.size, np.int32), np.zeros(1, np.int64)
    points_of_axis, start, edge, numbers = lookup._arrays_of(finder, 1)
    with np.errstate(invalid="ignore"):
        lookup.add_cells(x, points_of_axis, start, edge, numbers, index, missing)
    assert index.tolist() == np.searchsorted(points, x).tolist()
    assert not missing[0]
    nan = np.array([np.nan])
    lookup.add_cells(nan, points_of_axis, start, edge, numbers, index[:1], missing)
    assert missing[0] == 1
