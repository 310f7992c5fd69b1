"""Tables in C: bit for bit the Python model, and the table itself to one unit in the last place."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import table_definition as definition
from c_programs import ARM, HOST, compile_c, execute, run_c, spread, ulps
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from fuzzyarm.exchange.export import ExportError, export_files, routines_of
from fuzzyarm.table import Axis, LookupTable, read_table

RULEBASES = Path(__file__).parents[2] / "rulebases"
TARGETS = [HOST, pytest.param(ARM, marks=pytest.mark.slow)]

PRINTED = read_table(RULEBASES / "thesis-6.1.lut")
UNEVEN = LookupTable(
    (
        Axis("load", (-1.5, 0.1, 0.7), bins=(-0.3, 0.3)),
        Axis("e", (0.0, 0.3, 1.0, 7.7)),
        Axis("alone", (4.0,)),
        Axis("ce", (-2.2, -0.1, 0.1, 0.2, 9.9), bins=(-1.1, 0.0, 0.15, 1.7)),
    ),
    "torque",
    np.random.default_rng(7).uniform(-3.0, 5.0, (3, 4, 1, 5)),
)


def edge_points(axis, dtype=np.float32):
    """Every level and threshold with both neighbours, corners, and far outside."""
    near = np.array(
        [*axis.levels, *axis.thresholds("bins"), *axis.thresholds("nearest")], dtype=dtype
    )
    around = [np.nextafter(near, dtype(way)) for way in (-np.inf, np.inf)]
    far = np.array([-1e30, 1e30, -np.inf, np.inf, axis.levels[0] - 1, axis.levels[-1] + 1], dtype)
    return np.unique(np.concatenate([near, *around, far]))


def points_of(table, count, dtype=np.float32):
    return spread([edge_points(axis, dtype) for axis in table.axes], count, seed=3)


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_every_way_of_looking_up_agrees_over_100_000_points(tmp_path, target):
    routines, columns = [], []
    for table in (PRINTED, UNEVEN):
        for mode in ("bins", "nearest", "linear"):
            for precision in ("mixed", "float32", "float64"):
                routines += routines_of(table, mode=mode, precision=precision)
                dtype = np.float64 if precision == "float64" else np.float32
                columns.append(points_of(table, 100_000, dtype))
    for routine, points, found in zip(
        routines, columns, run_c(routines, columns, tmp_path, target), strict=True
    ):
        core = routine.core
        assert found.size >= 100_000
        np.testing.assert_array_equal(found, routine.evaluate(*points))
        given64 = [x.astype(np.float64) for x in points]
        truth = core.table.lookup(*given64, mode=core.mode)
        if core.precision.outside is np.float64:
            np.testing.assert_array_equal(found, truth)
        elif not core.linear or core.precision.inside is np.float64:
            # Correctly rounded, also where values of both signs nearly cancel.
            np.testing.assert_array_equal(found, truth.astype(np.float32))
            assert ulps(found, truth).max() <= 1
        else:
            largest = float(np.abs(core.table.values).max())
            assert np.abs(found - truth).max() <= 8 * np.finfo(np.float32).eps * largest


def test_ties_edges_and_levels_are_those_of_the_definition(tmp_path):
    axes = (Axis("e", (-2.0, -1.0, 1.0, 3.0), (-1.0, 0.0, 2.5)), Axis("ce", (0.0, 0.5, 1.0)))
    table = LookupTable(axes, "u", np.arange(12.0).reshape(4, 3) ** 2)
    e, ce = (x.ravel() for x in np.meshgrid(
        [-3, -2, -1.5, -1, -0.0, 0, 0.5, 1, 2, 2.5, 3, 4], [-1, 0, 0.25, 0.5, 0.75, 1, 2]
    ))  # fmt: skip
    points = list(zip(e.tolist(), ce.tolist(), strict=True))
    modes = ("bins", "nearest", "linear")
    routines = [routine for mode in modes for routine in routines_of(table, mode=mode)]
    found = run_c(routines, [(e, ce)] * 3, tmp_path)
    for mode, routine, values in zip(modes, routines, found, strict=True):
        expected = [
            float(definition.interpolated(axes, table.values, point))
            if mode == "linear"
            else definition.picked(axes, table.values, point, mode)
            for point in points
        ]
        assert values.tolist() == expected
        assert routine.evaluate(e, ce).tolist() == expected


@pytest.mark.parametrize("mode", ["bins", "nearest", "linear"])
def test_nan_counts_as_the_lower_border(tmp_path, mode):
    routines = routines_of(PRINTED, mode=mode)
    columns = [np.array([np.nan, 1.3]), np.array([2.0, np.nan])]
    (found,) = run_c(routines, [columns], tmp_path)
    expected = PRINTED.lookup([-6.0, np.float32(1.3)], [2.0, -6.0], mode=mode)
    np.testing.assert_array_equal(found, np.float32(expected))
    np.testing.assert_array_equal(found, routines[0].evaluate(*columns))


number = st.floats(-1e6, 1e6, width=32)


@st.composite
def small_tables(draw):
    axes = []
    for k in range(draw(st.integers(1, 3))):
        levels = sorted(draw(st.sets(number.map(lambda x: x + 0.0), min_size=1, max_size=5)))
        bins = None
        if draw(st.booleans()):
            wanted = len(levels) - 1
            found = draw(st.sets(number.map(lambda x: x + 0.0), min_size=wanted, max_size=wanted))
            bins = tuple(sorted(found))
        axes.append(
            Axis(draw(st.sampled_from(["e", "ė", "int", "a b"])) + str(k), tuple(levels), bins)
        )
    size = math.prod(len(axis.levels) for axis in axes)
    values = draw(st.lists(number, min_size=size, max_size=size))
    return LookupTable(
        tuple(axes), draw(st.sampled_from(["u", "1", "double", "u_values"])),
        np.reshape(values, [len(a.levels) for a in axes]),
    )  # fmt: skip


@pytest.mark.slow
@settings(
    max_examples=3, suppress_health_check=list(HealthCheck), phases=(Phase.explicit, Phase.generate)
)  # no shrinking: every step would call the compiler
@given(st.lists(small_tables(), min_size=8, max_size=16), st.data())
def test_any_tables_in_one_file_agree_in_every_arithmetic(tmp_path, tables, data):
    routines, columns = [], []
    for table in tables:
        q = data.draw(st.sampled_from([None, 15, 7]))
        mode = data.draw(st.sampled_from(["bins", "nearest", "linear"]))
        precision = data.draw(st.sampled_from(["mixed", "float32", "float64"]))
        try:
            routines += routines_of(table, mode=mode, q=q, precision=precision)
        except ExportError:  # levels that coincide in the format
            continue
        if q is None:
            dtype = np.float64 if precision == "float64" else np.float32
            columns.append(spread([edge_points(axis, dtype) for axis in table.axes], 500))
        else:
            scale = routines[-1].core.inputs[0]
            parts = [
                np.clip(
                    np.concatenate([p - 1, p, p + 1, [scale.low, scale.high, 0]]),
                    scale.low, scale.high,
                )
                for p in routines[-1].core.points
            ]  # fmt: skip
            columns.append(spread(parts, 500))
    if not routines:
        return
    found = run_c(routines, columns, tmp_path, suffix=data.draw(st.sampled_from([".h", ".c"])))
    for routine, points, result in zip(routines, columns, found, strict=True):
        np.testing.assert_array_equal(result, routine.evaluate(*points))


@pytest.mark.parametrize("suffix", [".h", ".c"])
@pytest.mark.parametrize(
    "options",
    [{"mode": "bins"}, {"mode": "linear"}, {"q": 15, "mode": "linear"}, {"q": 7}],
    ids=str,
)
def test_the_self_test_passes_and_can_fail(tmp_path, suffix, options):
    exported = export_files(routines_of(PRINTED, **options), tmp_path / f"controller{suffix}")
    for path, text in exported.files:
        path.write_text(text, "utf-8")
    source = [*(["-x", "c"] if suffix == ".h" else []), tmp_path / f"controller{suffix}"]
    compile_c(source, tmp_path / "good", HOST, "-DFUZZYARM_SELF_TEST")
    assert execute(tmp_path / "good") == 0
    path, text = exported.files[0]
    table, _, rest = text.partition("u_values[169] = {\n")
    values, _, rest = rest.partition("};")
    assert "2" in values
    wrong = values.replace("2", "1")
    path.write_text(f"{table}u_values[169] = {{\n{wrong}}};{rest}", "utf-8")
    compile_c(source, tmp_path / "bad", HOST, "-DFUZZYARM_SELF_TEST")
    assert execute(tmp_path / "bad") == 1


def test_the_worst_error_in_the_head_is_what_a_dense_grid_shows():
    (routine,) = routines_of(PRINTED, mode="linear", precision="float32")
    stated = routine.accuracy
    e = np.linspace(-6.5, 6.5, 331, dtype=np.float32)
    mesh = np.meshgrid(e, e)
    truth = PRINTED.lookup(*(x.astype(float) for x in mesh), mode="linear")
    seen = float(np.abs(routine.evaluate(*mesh) - truth).max())
    assert 0.3 * stated.worst <= seen <= 1.5 * stated.worst
    assert stated.points > 160_000


def test_the_head_names_rows_columns_units_origin_and_size(tmp_path):
    (file,) = export_files(routines_of(PRINTED), tmp_path / "controller.h").files
    head = file[1].partition("*/")[0]
    for words in (
        "float controller_u(float e, float ce)",
        "e: -6 .. 6, position error, normalised",
        "index order: row e (13 levels), column ce (13 levels)",
        "saturation",
        "source: thesis, Table 6.1",
        "worst error against the table of u",
        f"constants (flash): {4 * (169 + 12)} bytes",
        "operations per call, at most: 8 comparisons",
        "static RAM: 0 bytes",
    ):
        assert words in head, words


def test_nothing_in_a_file_can_break_out_of_a_comment(tmp_path):
    axis = Axis("x*/int y;/*", (0.0, 1.0), description="*/ #error ??/\n out")
    table = LookupTable((axis,), "*/", [1.0, 2.0], provenance=(("a", "(*/*) \\"), ("b", "*//*/")))
    routines = routines_of(table)
    (found,) = run_c(routines, [[np.array([0.2, 0.9])]], tmp_path)
    assert found.tolist() == [1.0, 2.0]


def test_a_large_table_takes_long_indexes(tmp_path):
    size = 300
    axes = (Axis("a", tuple(range(size))), Axis("b", tuple(range(size))))
    table = LookupTable(axes, "u", np.arange(size * size, dtype=float).reshape(size, size))
    points = np.random.default_rng(1).integers(0, size, (2, 500)).astype(float)
    (found,) = run_c(routines_of(table), [points], tmp_path)
    np.testing.assert_array_equal(found, points[0] * size + points[1])


def test_what_cannot_be_exported_is_said_in_one_sentence():
    huge = LookupTable((Axis("x", (0.0, 1.0)),), "y", [0.0, 1e300])
    with pytest.raises(ExportError, match=r"1e\+300, which is too large for single precision"):
        routines_of(huge)
    assert routines_of(huge, precision="float64")[0].evaluate(1.0) == 1e300
    close = LookupTable((Axis("x", (1.0, 1.0 + 1e-12, 2.0)),), "y", [0.0, 1.0, 2.0])
    with pytest.raises(ExportError, match="two levels of 'x' are the same number"):
        routines_of(close, mode="linear", precision="float32")
    with pytest.raises(ExportError, match="are the same number in q7"):
        routines_of(close, mode="linear", q=7)
    many = LookupTable(tuple(Axis(f"x{k}", (0.0, 1.0)) for k in range(9)), "y", np.zeros((2,) * 9))
    with pytest.raises(ExportError, match="interpolation is exported for at most 8"):
        routines_of(many, mode="linear")
