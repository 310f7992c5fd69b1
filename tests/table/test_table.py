from __future__ import annotations

import itertools
import math
import pickle

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import RegularGridInterpolator
from table_strategies import finite, tables

from fuzzyarm.table import Axis, LookupTable, TableError

# No symmetry of any kind: a swap of rows and columns gives another number or an error.
ASYMMETRIC = LookupTable(
    (Axis("e", (-1, 0, 2)), Axis("ce", (0, 10, 20, 40))),
    "u",
    [[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12]],
)


def naive_cell(axis: Axis, x: float, mode: str) -> int:
    """One threshold after the other, as one would write it in C."""
    if mode == "bins" and axis.bins is not None:
        index = 0
        for threshold in axis.bins:
            if threshold < x:
                index += 1
        return index
    index = 0
    while index + 1 < len(axis.levels):
        if x > 0.5 * axis.levels[index] + 0.5 * axis.levels[index + 1]:
            index += 1
        else:
            break
    return index


def interesting(axis: Axis) -> st.SearchStrategy[float]:
    edges = [*axis.levels, *(axis.bins or ()), *axis.thresholds("nearest")]
    near = [math.nextafter(x, way) for x in edges for way in (-math.inf, math.inf)]
    return finite | st.sampled_from([*edges, *near, math.inf, -math.inf])


@given(st.data(), tables(), st.sampled_from(["bins", "nearest"]))
def test_lookup_agrees_with_a_naive_loop(data, table, mode):
    points = [[data.draw(interesting(axis)) for axis in table.axes] for _ in range(3)]
    expected = []
    for point in points:
        cell = tuple(naive_cell(a, x, mode) for a, x in zip(table.axes, point, strict=True))
        expected.append(float(table.values[cell]))
        assert table.lookup(*point, mode=mode) == expected[-1]
        assert table.cell(*point, mode=mode) == cell
    columns = [np.array(column) for column in zip(*points, strict=True)]
    np.testing.assert_array_equal(table.lookup(*columns, mode=mode), expected)


@st.composite
def even_tables(draw):
    sizes = draw(st.lists(st.integers(2, 5), min_size=1, max_size=3))
    parts = tuple(
        Axis(f"x{k}", tuple(np.cumsum(draw(st.lists(st.floats(0.1, 5), min_size=n, max_size=n)))))
        for k, n in enumerate(sizes)
    )
    number = st.floats(-10, 10)
    count = math.prod(sizes)
    values = np.array(draw(st.lists(number, min_size=count, max_size=count))).reshape(sizes)
    return LookupTable(parts, "y", values)


@given(even_tables(), st.integers(0, 2**32 - 1))
def test_linear_agrees_with_scipy(table, seed):
    random = np.random.default_rng(seed)
    low = np.array([axis.levels[0] for axis in table.axes])
    high = np.array([axis.levels[-1] for axis in table.axes])
    points = low + random.random((20, len(low))) * (high - low)
    oracle = RegularGridInterpolator([axis.levels for axis in table.axes], table.values)
    expected = oracle(np.clip(points, low, high))
    np.testing.assert_allclose(table.lookup(*points.T, mode="linear"), expected, atol=1e-12)


@given(st.data(), even_tables())
def test_scalars_and_arrays_give_the_same_bits(data, table):
    points = [data.draw(st.floats(-2, 30)) for _ in table.axes]
    for mode in ("bins", "nearest", "linear"):
        alone = table.lookup(*points, mode=mode)
        assert type(alone) is float
        together = table.lookup(*[np.array([x, x]) for x in points], mode=mode)
        assert together.tolist() == [alone, alone]


@given(tables())
def test_every_level_finds_its_own_value(table):
    for index in itertools.islice(np.ndindex(table.shape), 30):
        point = [axis.levels[i] for axis, i in zip(table.axes, index, strict=True)]
        assert table.lookup(*point, mode="nearest") == table.values[index]
        if np.abs(table.values).max() < 1e100:
            assert table.lookup(*point, mode="linear") == table.values[index]


def test_rows_are_the_first_input_and_columns_the_second():
    assert ASYMMETRIC.lookup(2, 10) == 10.0
    assert ASYMMETRIC.lookup(ce=10, e=2) == 10.0
    assert ASYMMETRIC.lookup(2, ce=10) == 10.0
    assert ASYMMETRIC.lookup(np.array([2, -1]), 40).tolist() == [12.0, 4.0]
    assert ASYMMETRIC.lookup(1.0, 5.0, mode="bilinear") == 7.5


def test_an_input_on_a_threshold_belongs_to_the_lower_cell():
    axis = Axis("e", (-1, 0, 1), (-0.6, 0.6))
    table = LookupTable((axis,), "u", [1, 2, 3])
    assert [table.lookup(x) for x in (-0.6, math.nextafter(-0.6, 1), 0.6)] == [1.0, 2.0, 2.0]
    assert table.lookup(np.array([-0.6, 0.6, 0.61])).tolist() == [1.0, 2.0, 3.0]
    # Nearest: the tie at -0.5 and at 0.5 goes to the lower level as well.
    assert [table.lookup(x, mode="nearest") for x in (-0.5, 0.5, 0.51)] == [1.0, 2.0, 3.0]


def test_the_default_mode_is_bins_where_there_are_bins():
    binned = LookupTable((Axis("e", (0, 1), (0.9,)),), "u", [5, 7])
    assert binned.default_mode == "bins"
    assert binned.lookup(0.8) == 5.0
    assert binned.lookup(0.8, mode="nearest") == 7.0
    assert ASYMMETRIC.default_mode == "nearest"
    linear = LookupTable((Axis("e", (0, 1)),), "u", [5, 7], mode="bilinear")
    assert linear.mode == linear.default_mode == "linear"
    assert linear.lookup(0.5) == 6.0


def test_outside_the_levels_the_border_counts():
    for mode in ("bins", "nearest", "linear"):
        assert ASYMMETRIC.lookup(-9, 99, mode=mode) == 4.0
        assert ASYMMETRIC.lookup(math.inf, -math.inf, mode=mode) == 9.0
        assert ASYMMETRIC.lookup(np.array([np.inf]), -5, mode=mode).tolist() == [9.0]


def test_shapes_broadcast_and_large_arrays_go_in_chunks():
    e, ce = np.linspace(-2, 3, 301)[:, None], np.linspace(-5, 50, 401)
    for mode in ("bins", "nearest", "linear"):
        surface = ASYMMETRIC.lookup(e, ce, mode=mode)
        assert surface.shape == (301, 401)
        for i, j in [(0, 0), (300, 400), (123, 7), (250, 399)]:
            assert surface[i, j] == ASYMMETRIC.lookup(float(e[i, 0]), float(ce[j]), mode=mode)
    assert ASYMMETRIC.lookup(np.empty((0, 3)), 1).shape == (0, 3)
    assert ASYMMETRIC.lookup(np.float32(2), np.int64(10)) == 10.0


@pytest.mark.parametrize("mode", ["bins", "nearest", "linear"])
def test_not_a_number_is_refused(mode):
    for bad in (math.nan, np.array([0.0, np.nan])):
        with pytest.raises(TableError, match="NaN"):
            ASYMMETRIC.lookup(bad, 0, mode=mode)
        with pytest.raises(TableError, match="NaN"):
            ASYMMETRIC.lookup(0, bad, mode=mode)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda t: t.lookup(1), "no value for input 'ce'"),
        (lambda t: t.lookup(1, 2, 3), "has 2 inputs .e, ce., not 3"),
        (lambda t: t.lookup(1, cx=2), "no input 'cx'.*did you mean 'ce'"),
        (lambda t: t.lookup(1, e=2), "'e' is given twice"),
        (lambda t: t.lookup(1, 2, mode="cubic"), "unknown lookup mode 'cubic'"),
        (lambda t: t.lookup(np.zeros(2), np.zeros(3)), "do not fit each other"),
    ],
)
def test_wrong_questions_are_answered_clearly(call, message):
    with pytest.raises(TableError, match=message):
        call(ASYMMETRIC)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: LookupTable((), "u", []), "at least one axis"),
        (lambda: Axis("e", ()), "has no levels"),
        (lambda: Axis("e", (0, 0)), "must increase"),
        (lambda: Axis("e", (0, math.inf)), "must be finite"),
        (lambda: Axis("e", (-1e308, 1e308)), "too far apart"),
        (lambda: Axis("e", (0, 1), (0.2, 0.3)), "needs 1 bins, not 2"),
        (lambda: Axis("e", (0, 1), low=2, high=1), "runs from 2 down to 1"),
        (lambda: LookupTable((Axis("e", (0, 1)),), "u", [1, 2, 3]), "shape"),
        (lambda: LookupTable((Axis("e", (0, 1)),), "u", [1, math.nan]), "not finite"),
        (lambda: LookupTable((Axis("e", (0,)), Axis("e", (0,))), "u", [[1]]), "called 'e'"),
        (lambda: LookupTable((Axis("e", (0,)),), "u", [1], low=1), "only one end"),
        (lambda: LookupTable((Axis("e", (0,)),), "u", [1], rounding=0), "positive step"),
    ],
)
def test_nonsense_is_refused(make, message):
    with pytest.raises(TableError, match=message):
        make()


def test_a_table_cannot_be_changed_behind_its_back():
    values = np.array([[1.0, 2.0]])
    table = LookupTable((Axis("e", (0,)), Axis("ce", (0, 1))), "u", values)
    values[0, 0] = 99.0
    assert table.lookup(0, 0) == 1.0
    with pytest.raises(ValueError, match="read-only"):
        table.values[0, 0] = 5.0


@given(tables())
@settings(max_examples=cases(10, 30))
def test_equality_hash_and_pickle(table):
    copy = pickle.loads(pickle.dumps(table))
    assert copy == table
    assert hash(copy) == hash(table)
    other = table.with_values(np.where(table.values == 0, 1.0, 0.0))
    assert other != table
    assert table != "table"


def test_a_minus_before_zero_is_dropped():
    axis = Axis("e", (-0.0,), low=-0.0, high=-0.0)
    table = LookupTable((axis,), "u", [0.0], low=-0.0, high=-0.0)
    for x in (*axis.levels, axis.low, axis.high, table.low, table.high):
        assert math.copysign(1.0, x) == 1.0


def test_levels_are_a_count_or_numbers():
    from fuzzyarm.table.levels import read_levels

    assert read_levels(" 7 ") == 7
    assert tuple(read_levels("0 1")) == (0.0, 1.0)
    assert tuple(read_levels("-1 0.5 2")) == (-1.0, 0.5, 2.0)
    with pytest.raises(TableError, match="is not a whole number of levels"):
        read_levels("0.5")
