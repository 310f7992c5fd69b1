"""Fixed point: the Python model against fractions, and C bit for bit against the model."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import table_definition as definition
from c_programs import ARM, HOST, run_c, spread
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.exchange.export import routines_of
from fuzzyarm.exchange.export.table import WholeNumberScale, fixed_table, part, scale_over
from fuzzyarm.table import Axis, LookupTable, read_table

PRINTED = read_table(Path(__file__).parents[2] / "rulebases" / "thesis-6.1.lut")
TARGETS = [HOST, pytest.param(ARM, marks=pytest.mark.slow)]


@given(
    st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=6),
    st.sampled_from([15, 7]),
    st.floats(-2e6, 2e6),
)
def test_a_scale_rounds_to_the_nearest_step_and_saturates(numbers, bits, value):
    scale = scale_over(numbers, bits)
    number = scale.nearest(value)
    assert scale.low <= number <= scale.high
    place = (Fraction(value) - Fraction(scale.offset)) * 2**bits / Fraction(scale.span)
    if scale.low <= place <= scale.high:
        assert abs(place - number) <= Fraction(1, 2)
        assert 0 <= place - scale.below(value) < 1
    elif place < scale.low:
        assert number == scale.low
    else:
        assert number == scale.high
    for end in (min(numbers), max(numbers)):  # the whole range fits, but for the last step
        assert abs(float(scale.quantity(scale.nearest(end))) - end) <= 1.001 * scale.step


def test_a_symmetric_range_has_no_offset():
    assert scale_over([-6.0, 6.0, 1.0], 15) == WholeNumberScale(0.0, 6.0, 15)
    assert scale_over([20.0, 100.0], 15) == WholeNumberScale(60.0, 40.0, 15)
    assert scale_over([3.0, 3.0], 7) == WholeNumberScale(3.0, 1.0, 7)


@given(st.integers(-65535, 65535), st.integers(0, 32768))
def test_a_part_is_rounded_to_the_nearest_and_fits_32_bits(difference, share):
    result = int(part(np.array(difference), np.array(share)))
    exact = Fraction(difference * share, 32768)
    assert abs(result - exact) <= Fraction(1, 2)
    assert abs(difference * share) + 16384 < 2**31
    assert int(part(np.array(-difference), np.array(share))) == -result
    assert result == definition.half_away(exact)


def test_exact_ties_of_a_scale_go_to_the_even_number():
    scale = WholeNumberScale(0.0, 32768.0, 15)  # a step is 1
    halves = [-2.5, -1.5, -0.5, 0.5, 1.5, 2.5]
    assert [scale.nearest(x) for x in halves] == [-2, -2, 0, 0, 2, 2]
    assert [scale.below(x) for x in (*halves, 3.0)] == [-3, -2, -1, 0, 1, 2, 3]


def halves(values):
    """A table whose blends meet exact ties at e = 0 and t = 0, of either sign."""
    axes = (Axis("e", (-1.0, 1.0)), Axis("t", (-1.0, 0.25, 1.0)))
    return LookupTable(axes, "u", np.array(values) / 32768, low=-1.0, high=1.0)


TIES = halves([[3, 8, -5], [8, -3, 5]]), halves([[-7, -2, 1], [1, -1, 0]])


@pytest.mark.parametrize("table", TIES, ids=["a", "b"])
def test_blends_are_those_of_the_definition_also_on_exact_ties(table, tmp_path):
    (routine,) = routines_of(table, mode="linear", q=15)
    core = routine.core
    # The share at e = 0 is one half in steps of 2^-15: (0 + 32768) 32768 / 65535, rounded down.
    assert definition.neighbours(core.points[0].tolist(), 0)[1] * 32768 // 1 == 16384
    e, t = (x.ravel() for x in np.meshgrid(
        [-32768, -1, 0, 1, 777, 32767], [-32768, -12288, -12287, 0, 8192, 20480, 32767]
    ))  # fmt: skip
    levels, values = [x.tolist() for x in core.points], core.values.reshape(2, 3).tolist()
    expected = [
        definition.in_fixed_point(levels, values, point)
        for point in zip(e.tolist(), t.tolist(), strict=True)
    ]
    assert routine.evaluate(e, t).tolist() == expected
    (found,) = run_c([routine], [(e, t)], tmp_path)
    assert found.tolist() == expected


def test_the_cell_is_the_one_of_the_quantity_itself():
    core = fixed_table(PRINTED, 15, "bins")
    every = np.arange(-32768, 32768)
    e = np.asarray(core.inputs[0].quantity(every))
    cells = np.searchsorted(core.points[0], every, side="left")
    assert cells.tolist() == [PRINTED.axes[0].cell(x) for x in e.tolist()]


@pytest.mark.parametrize("bits", [15, 7])
def test_interpolation_stays_within_a_few_steps_of_the_table(bits):
    core = fixed_table(PRINTED, bits, "linear")
    whole = np.unique(np.linspace(core.output.low, core.output.high, 300).astype(int))
    mesh = np.meshgrid(whole, whole)
    truth = PRINTED.lookup(*(core.inputs[0].quantity(x) for x in mesh), mode="linear")
    error = np.abs(core.output.quantity(core.evaluate(*mesh)) - truth).max()
    # Values are off by half a step, levels by half a step times the steepest slope, and
    # three blends round once more each.
    slope = max(np.abs(np.diff(PRINTED.values, axis=k)).max() for k in (0, 1))
    assert error <= core.output.step * 2.0 + 2 * slope * core.inputs[0].step


def test_a_table_that_is_its_own_mirror_image_stays_so():
    values = np.array([[-3.3, -1.1, 0.0], [-1.7, 0.0, 1.7], [0.0, 1.1, 3.3]])
    table = LookupTable((Axis("e", (-1, 0, 1)), Axis("ce", (-1, 0, 1))), "u", values)
    core = fixed_table(table, 15, "linear")
    e = np.arange(-32767, 32768, 97)
    mesh = np.meshgrid(e, e[::-7])
    # Level 1 is 2^15, beyond the largest number: mirrored inputs are taken below it.
    mesh = [np.clip(x, -32766, 32766) for x in mesh]
    result = core.evaluate(*mesh)
    mirrored = core.evaluate(*(-x for x in mesh))
    assert np.abs(result + mirrored).max() <= 2


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("bits", [15, 7])
def test_c_is_bit_for_bit_the_model_over_100_000_points(tmp_path, bits, target):
    heated = LookupTable(
        (Axis("t", (20.0, 35.0, 80.0, 100.0), bins=(30.0, 50.0, 90.0)), Axis("w", (0.0, 0.5))),
        "power",
        [[0.0, 1.0], [30.0, 20.0], [1500.0, 70.0], [3000.0, 2999.0]],
        low=0.0,
        high=3000.0,
    )
    routines, columns = [], []
    for table in (PRINTED, heated):
        for mode in ("bins", "nearest", "linear"):
            (routine,) = routines_of(table, mode=mode, q=bits)
            low, high = routine.core.inputs[0].low, routine.core.inputs[0].high
            parts = [
                np.clip(np.concatenate([p - 1, p, p + 1, [low, high]]), low, high)
                for p in routine.core.points
            ]
            routines.append(routine)
            columns.append(spread(parts, 100_000))
    found = run_c(routines, columns, tmp_path, target)
    for routine, points, result in zip(routines, columns, found, strict=True):
        np.testing.assert_array_equal(result, routine.evaluate(*points))


def test_no_floating_point_is_in_the_file(tmp_path):
    from fuzzyarm.exchange.export import export_files

    for mode in ("bins", "linear"):
        (file,) = export_files(routines_of(PRINTED, mode=mode, q=15), tmp_path / "c.h").files
        code = file[1].partition("*/")[2]
        assert "float" not in code
        assert "double" not in code
        assert "int32_t" in code or mode == "bins"
