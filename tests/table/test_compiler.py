from __future__ import annotations

import math
from dataclasses import fields, replace
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.base.numbers import evenly, short_levels
from fuzzyarm.inference import infer
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import Lookup, LookupAxis
from fuzzyarm.table import (
    LookupTable,
    TableError,
    compile_table,
    compile_with_report,
    measure_fidelity,
)
from fuzzyarm.table import compiler as compiler_module
from fuzzyarm.table import fidelity as fidelity_module
from fuzzyarm.table.compiler import choose_axes, round_to
from fuzzyarm.table.fidelity import smallest_even_grid

LOPSIDED = """\
rulebase lopsided
input a 0 .. 4
input b -1 .. 1 "second, mm"
output y 0 .. 10
terms a: triangles LO HI
terms b: triangles N Z P
terms y: triangles S M L
rules y
  a \\ b  N  Z  P
  LO     S  S  M
  HI     S  M  L
"""
LOOKUP = """\
lookup
  levels a: 0 1 3 4
  levels b: -1 .. 1 step 0.5
  bins   a: 0.2 1.5 3.9
  round  0.1
"""
TWO_OUTPUTS = LOPSIDED + "output z 0 .. 1\nterms z: triangles S L\nrule if a is LO then z is S\n"


def rulebase(text: str):
    parsed = parse(text)
    assert parsed.rulebase is not None, parsed.diagnostics
    return parsed.rulebase


def test_each_cell_is_the_inference_at_its_levels():
    base = rulebase(LOPSIDED + LOOKUP)
    table = compile_table(base, rounding=0)
    assert table.shape == (4, 5)
    for i, a in enumerate((0, 1, 3, 4)):
        for j, b in enumerate((-1, -0.5, 0, 0.5, 1)):
            assert table.values[i, j] == pytest.approx(infer(base, a=a, b=b)["y"], abs=1e-12)
    assert not np.allclose(table.values[:4, :4], table.values[:4, :4].T)


def test_the_settings_of_the_file_are_kept():
    table = compile_table(rulebase(LOPSIDED + LOOKUP), source="/some/where/lop.frb")
    assert table.axis("a").bins == (0.2, 1.5, 3.9)
    assert table.axis("b").bins is None
    assert table.rounding == 0.1
    assert table.default_mode == "bins"
    assert (table.low, table.high) == (0.0, 10.0)
    assert table.axis("b").description == "second, mm"
    assert np.array_equal(table.values, np.round(table.values, 1))
    origin = dict(table.provenance)
    assert origin["source"] == "lop.frb"
    assert origin["rulebase"] == "lopsided"
    assert origin["sampled"] == "at the levels of the file"
    assert compile_table(rulebase(LOPSIDED + LOOKUP), source="x/lop.frb") == table


def test_without_settings_there_are_13_even_levels_and_that_is_said():
    report = compile_with_report(rulebase(LOPSIDED))
    assert report.table.shape == (13, 13)
    assert report.default_levels
    assert dict(report.table.provenance)["sampled"] == "at 13 even levels by default"
    assert not compile_with_report(rulebase(LOPSIDED), levels=5).default_levels


def test_levels_of_the_caller_win_and_drop_the_bins():
    table = compile_table(rulebase(LOPSIDED + LOOKUP), levels={"a": (0, 2, 4)})
    assert table.axis("a").levels == (0, 2, 4)
    assert table.axis("a").bins is None
    assert table.axis("b").levels == (-1, -0.5, 0, 0.5, 1)


def test_slabs_make_no_difference(monkeypatch):
    base = rulebase(LOPSIDED)
    whole = compile_table(base, levels={"a": 50, "b": 21})
    monkeypatch.setattr(compiler_module, "_SLAB", 100)
    assert np.array_equal(compile_table(base, levels={"a": 50, "b": 21}).values, whole.values)


@pytest.mark.parametrize(
    ("text", "arguments", "message"),
    [
        (TWO_OUTPUTS, {}, "has 2 outputs: name one of y, z"),
        (TWO_OUTPUTS, {"output": "zz"}, "no output 'zz'.*did you mean 'z'"),
        (LOPSIDED, {"levels": {"c": 3}}, "no input 'c'"),
        (LOPSIDED, {"levels": 0}, "2 to 100,000 levels"),
        (LOPSIDED, {"levels": {"a": 1}}, "2 to 100,000 levels, not 1"),
        (LOPSIDED, {"levels": 9_000}, "81,000,000 cells"),
        (LOPSIDED, {"rounding": -1}, "positive step"),
        (LOPSIDED.replace("0 .. 4", "-inf .. 4").replace("terms a: triangles LO HI",
         "term a LO: ramp 4 0\nterm a HI: ramp 0 4"), {}, "'a' is unbounded"),
        ("rulebase r\noutput y 0 .. 1\nterms y: triangles A B\n", {}, None),
    ],
)  # fmt: skip
def test_what_cannot_be_compiled(text, arguments, message):
    parsed = parse(text)
    if message is None:
        with pytest.raises(TableError, match="no inputs"):
            compile_table(parsed.partial)
        return
    with pytest.raises(TableError, match=message):
        compile_table(parsed.partial, **arguments)


def test_no_value_is_refused_with_the_place():
    base = rulebase(
        "rulebase r\ninput a 0 .. 4\noutput y 0 .. 1\nterms y: triangles S L\n"
        "term a LO: triangle 0 0 1\ninference no-rule nan\nrule if a is LO then y is S\n"
    )
    with pytest.raises(TableError, match="'y' has no value at a = 1 "):
        compile_table(base, levels=(0, 1, 4))


def test_the_reported_difference_is_what_brute_force_finds():
    base = rulebase(LOPSIDED + LOOKUP)
    table = compile_table(base)
    fidelities = {f.mode: f for f in measure_fidelity(table, base, ("bins", "nearest", "linear"))}
    a, b = np.linspace(0, 4, 400)[:, None], np.linspace(-1, 1, 400)
    truth = infer(base, a=a, b=b)["y"]
    for mode, fidelity in fidelities.items():
        error = np.abs(table.lookup(a, b, mode=mode) - truth)
        assert fidelity.rms == pytest.approx(math.sqrt(np.mean(error**2)), rel=1e-9)
        assert fidelity.worst >= error.max()
        at = dict(fidelity.at)
        found = abs(table.lookup(**at, mode=mode) - infer(base, at)["y"])
        assert found == pytest.approx(fidelity.worst, abs=1e-12)


def test_the_worst_is_sought_on_both_sides_of_every_threshold():
    text = (
        "rulebase r\ninput a 0 .. 1\noutput y 0 .. 1\nterm a LO: ramp 1 0\nterm a HI: ramp 0 1\n"
        "term y ONE: singleton 1\nterm y NIL: singleton 0\n"
        "inference defuzzifier weighted-average\n"
        "rule if a is LO then y is NIL\nrule if a is HI then y is ONE\n"
    )
    base = rulebase(text)  # y = a, so every difference is known
    table = compile_table(base, levels=3)
    nearest, linear = measure_fidelity(table, base)
    assert nearest.worst == pytest.approx(0.25, abs=1e-12)
    assert nearest.rms == pytest.approx(0.25 / math.sqrt(3), rel=1e-3)
    assert linear.worst == pytest.approx(0, abs=1e-15)


CURVED = LOPSIDED.replace(
    "terms y: triangles S M L",
    "term y S: gaussian 0 1\nterm y M: gaussian 5 1\nterm y L: gaussian 10 1",
)


@pytest.mark.parametrize(
    ("text", "settings", "few"),
    [
        (LOPSIDED, "", False),
        (LOPSIDED, "implication product", False),
        (LOPSIDED, "aggregation probor", True),
        (LOPSIDED, "defuzzifier bisector", True),
        (LOPSIDED, "aggregation bounded, defuzzifier mean-of-maximum", True),
        (CURVED, "", True),
        (CURVED, "implication product, aggregation sum", True),
        (CURVED, "defuzzifier centroid(101)", False),
        (CURVED, "defuzzifier centroid(200000)", True),
        (CURVED, "defuzzifier weighted-average", False),
    ],
)
def test_few_points_are_compared_where_each_takes_long(text, settings, few, monkeypatch):
    inferred = 0

    def counted(rulebase, output, names, points, engine=None):
        nonlocal inferred
        inferred += math.prod(x.size for x in points)
        return np.zeros([x.size for x in points])

    base = rulebase(text + (f"inference {settings}\n" if settings else ""))
    table = LookupTable(choose_axes(base), "y", np.zeros((13, 13)))
    monkeypatch.setattr(fidelity_module, "evaluate", counted)
    (fidelity,) = measure_fidelity(table, base, ["linear"])
    assert math.prod(fidelity.points) == inferred
    assert inferred < 30_000 if few else inferred > 160_000


def test_that_few_points_were_compared_is_said(tmp_path, capsys):
    path = tmp_path / "curved.frb"
    path.write_text(CURVED)
    assert main(["compile", str(path), "-o", str(tmp_path / "y.lut"), "--levels", "3"]) == 0
    assert "few points were compared" in capsys.readouterr().out
    path.write_text(LOPSIDED)
    assert main(["compile", str(path), "-o", str(tmp_path / "y.lut"), "--levels", "3"]) == 0
    assert "few points were compared" not in capsys.readouterr().out


def test_a_probe_that_proved_a_grid_wrong_is_asked_first():
    base = rulebase(LOPSIDED)
    probes = fidelity_module._Probes(base, "y")
    probes.remember([1.0, 0.5])
    assert probes.points[0].tolist() == [1.0, 0.5]
    np.testing.assert_array_equal(probes.truth, probes._infer(probes.points.T))


@pytest.mark.parametrize("alone", [0, 100])
def test_every_probe_counts(alone):
    probes = fidelity_module._Probes(rulebase(LOPSIDED), "y")
    probes.truth[:] = probes._interpolate(probes.points, 5)
    assert probes.worst(5, 1e-3) == 0.0
    probes.truth[alone] += 1.0
    assert probes.worst(5, 1e-3) == pytest.approx(1.0)


@pytest.mark.parametrize(("step", "value"), [(3e6, 6e6), (0.1 + 2e-17, 0.7), (1 / 3, 2 / 3)])
def test_steps_that_are_no_short_decimals(step, value):
    assert round_to(np.array([value * 1.01]), step)[0] == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("tolerance", [1.0, 0.5, 0.25])
def test_the_tolerance_is_met_by_the_smallest_grid(tolerance):
    base = rulebase(LOPSIDED)
    report = compile_with_report(base, tolerance=tolerance)
    count = report.table.shape[0]
    assert report.table.shape == (count, count)
    assert report.table.mode == "linear"
    a, b = np.linspace(0, 4, 701)[:, None], np.linspace(-1, 1, 701)
    truth = infer(base, a=a, b=b)["y"]
    worst = []
    for size in range(2, count + 1):
        grid = compile_table(base, levels=size, rounding=0)
        worst.append(np.abs(grid.lookup(a, b, mode="linear") - truth).max())
    assert worst[-1] <= tolerance
    # Every smaller grid is worse; a finer grid of test points can only make it more so.
    assert min([math.inf, *worst[:-1]]) > tolerance * 0.98


@pytest.mark.parametrize("bending", range(1, 90))
def test_the_search_for_the_fewest_levels_ends_whatever_the_surface(pd7, monkeypatch, bending):
    probes = fidelity_module._Probes(pd7, "u")
    monkeypatch.setattr(probes, "_jump", lambda: (0.0, []))
    asked = []

    def bend(count):
        asked.append(count)
        assert len(asked) < 40
        return 1.0 if count <= bending else 0.0

    monkeypatch.setattr(probes, "_bend", bend)
    assert 2 <= probes.fewest(1001, 0.5) <= bending + 1


def test_a_tolerance_out_of_reach_is_an_error(monkeypatch):
    from fuzzyarm.table import fidelity

    monkeypatch.setitem(fidelity.LIMITS, 2, 9)
    monkeypatch.setattr(fidelity._Probes, "worst", lambda *_: pytest.fail("a grid was tried"))
    with pytest.raises(TableError, match=r"up to 9 levels .* meets 1e-06: the surface bends by"):
        smallest_even_grid(rulebase(LOPSIDED), None, 1e-6)
    for tiny in (1e-300, 5e-324):
        with pytest.raises(TableError, match="the surface bends by"):
            smallest_even_grid(rulebase(LOPSIDED), None, tiny)
    for bad in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(TableError, match="positive number"):
            smallest_even_grid(rulebase(LOPSIDED), None, bad)


JUMPS = """rulebase jumps
input a 0 .. 10
output y 0 .. 1
term a L: rectangle 0 3.7
term a H: rectangle 3.7 10
term y S: singleton 0
term y L: singleton 1
inference defuzzifier weighted-average
rule if a is L then y is S
rule if a is H then y is L
"""


def test_a_jump_is_named_at_once_and_what_is_above_it_is_met(monkeypatch):
    from fuzzyarm.table import fidelity

    asked = 0
    ordinary = fidelity._Probes._infer

    def counted(probes, columns):
        nonlocal asked
        asked += np.size(columns[0])
        return ordinary(probes, columns)

    monkeypatch.setattr(fidelity._Probes, "_infer", counted)
    with pytest.raises(TableError, match=r"the surface jumps by \S+ at a = 3\.7"):
        smallest_even_grid(rulebase(JUMPS), None, 0.2)
    assert asked < 10_000  # 20,001 sizes would be tried
    assert smallest_even_grid(rulebase(JUMPS), None, 1.0) == 2


def test_a_surface_that_lines_meet_needs_no_more_levels_than_its_kinks():
    straight = JUMPS.replace("rectangle 0 3.7", "ramp 10 0").replace(
        "rectangle 3.7 10", "ramp 0 10"
    )
    assert smallest_even_grid(rulebase(straight), None, 1e-9) == 2
    kinked = JUMPS.replace("rectangle 0 3.7", "points (0, 1) (5, 0.1) (10, 0)")
    kinked = kinked.replace("rectangle 3.7 10", "points (0, 0) (5, 0.9) (10, 1)")
    assert smallest_even_grid(rulebase(kinked), None, 1e-9) == 3


SETTINGS = {
    "axes": Lookup((LookupAxis("a", (0.0, 1.0, 4.0)),)),
    "round": Lookup(round=0.5),
}
"""By field, settings in which it counts."""


@pytest.mark.parametrize("field", [each.name for each in fields(Lookup)])
def test_a_table_states_each_setting_that_it_was_made_with(field):
    lookup = SETTINGS[field]
    without = replace(lookup, **{field: getattr(Lookup(), field)})
    one, other = (
        compile_table(replace(rulebase(LOPSIDED), lookup=each)) for each in (lookup, without)
    )
    stated = [replace(table, values=np.zeros(table.shape), provenance=()) for table in (one, other)]
    assert stated[0] != stated[1]


@given(st.floats(-1e4, 1e4), st.sampled_from([0.1, 0.5, 1.0, 0.25, 0.3, 0.001, 2.5, 10.0]))
def test_rounding_gives_the_float_nearest_to_the_decimal(x, step):
    rounded = float(round_to(np.array([x]), step)[0])
    multiple = Decimal(repr(step)) * round(Decimal(rounded) / Decimal(repr(step)))
    assert rounded == float(multiple)
    assert abs(rounded - x) <= step * (0.5 + 1e-9)
    assert math.copysign(1.0, rounded) > 0 or rounded < 0


@given(
    st.integers(-50, 50).map(lambda k: k / 10), st.integers(1, 80).map(lambda k: k / 10),
    st.integers(3, 300),
)  # fmt: skip
def test_even_levels_have_a_short_form_that_reads_back(low, width, count):
    from fuzzyarm.table import parse_lut
    from fuzzyarm.table.axis import Axis

    levels = Axis("e", evenly(low, low + width, count)).levels
    text = short_levels(levels)
    assert ".." in text
    cells = " ".join(["0"] * count)
    labels = " ".join(map(repr, levels))
    source = (
        f"fuzzyarm-table 1\noutput u\nindex column e\nlevels {text}\n"
        f"grid\n e {labels}\n u {cells}\n"
    )
    assert parse_lut(source).table.axes[0].levels == levels


@pytest.mark.slow
def test_a_large_table_has_the_values_of_a_small_one(pd7):
    from fuzzyarm.inference import infer

    table = compile_table(pd7, levels=1001, rounding=0.0)
    axis = np.array(table.axes[0].levels)
    there = infer(pd7, e=axis[::7, None], ce=axis[None, ::7])["u"]
    assert np.abs(table.values[::7, ::7] - there).max() < 1e-12


@pytest.mark.slow
def test_a_table_of_many_inputs_is_compared_at_points_that_are_drawn():
    # Three points along each of 16 inputs would be 43 million, with 65,536 corners each.
    names = [f"x{i}" for i in range(16)]
    rulebase = parse(
        "rulebase many\n"
        + "".join(f"input {name} 0 .. 1\n" for name in names)
        + "output u 0 .. 1\n"
        + f"terms {', '.join(names)}, u: triangles L H\n"
        + "".join(f"rule if {n} is L then u is L\nrule if {n} is H then u is H\n" for n in names)
        + "lookup\n  levels 0 .. 1 count 2\n"
    ).rulebase
    report = compile_with_report(rulebase)
    for each in report.fidelities:
        assert each.points == (6_103,)
        point = dict(each.at)
        direct = infer(rulebase, point)["u"]
        assert abs(report.table.lookup(**point, mode=each.mode) - direct) == pytest.approx(
            each.worst, abs=1e-12
        )
        assert 0.0 < each.rms < each.worst


def own_inputs():
    """Return a rule base of two outputs on different inputs."""
    return parse(
        "rulebase own\ninput a 0 .. 1\ninput b 0 .. 4\ninput c 0 .. 1\n"
        "output u 0 .. 10\noutput v 0 .. 10\nterms a, b, c, u, v: triangles LO HI\n"
        "rule if a is LO then u is HI\nrule if a is HI then u is LO\n"
        "rule if b is LO and c is LO then v is LO\nrule if b is HI or c is HI then v is HI\n"
        "lookup\n  levels b: 0 .. 4 count 5\n"
    ).rulebase


def test_a_table_has_the_inputs_that_its_output_depends_on():
    rulebase = own_inputs()
    assert compile_table(rulebase, "u").names == ("a",)
    table = compile_table(rulebase, "v", levels={"a": 3, "c": 7})
    assert (table.names, table.shape) == (("b", "c"), (5, 7))
    b, c = (np.array(axis.levels) for axis in table.axes)
    there = infer(rulebase, b=b[:, None], c=c, outputs=["v"])["v"]
    np.testing.assert_array_equal(table.values, there)
    report = compile_with_report(rulebase, "v", tolerance=0.5)
    assert report.table.names == ("b", "c")
    assert report.fidelities[0].worst <= 0.5


def test_an_output_that_depends_on_nothing_has_a_small_table_all_the_same():
    text = (
        "rulebase r\ninput a 0 .. 1\ninput b 0 .. 1\noutput y 0 .. 1\nterms a, y: triangles L H\n"
    )
    text += "inference y: no-rule 0.25\nrule if a is L then y is H with 0\n"
    table = compile_table(parse(text).rulebase)
    assert table.names == ("a",)
    assert set(table.values.ravel().tolist()) == {0.25}


def test_a_table_over_further_inputs_gives_the_same_numbers():
    from fuzzyarm.proof.map import table_proof
    from fuzzyarm.table.compiler import over_inputs

    rulebase = own_inputs()
    table = compile_table(rulebase, "v")
    whole = over_inputs(table, rulebase.inputs)
    assert whole.names == ("a", "b", "c")
    draw = np.random.default_rng(3).random((3, 50)) * [[1.0], [4.0], [1.0]]
    for mode in ("nearest", "linear"):
        there = whole.lookup(*draw, mode=mode)
        np.testing.assert_allclose(there, table.lookup(*draw[1:], mode=mode), atol=1e-12)
    assert over_inputs(table, rulebase.inputs[1:]) is table
    proved = table_proof(rulebase, "v")
    assert proved(whole, "nearest") == pytest.approx(proved(table, "nearest"), rel=1e-6)


@pytest.mark.parametrize(
    ("mode", "cells", "ways"),
    [
        ("", "worst error 2 of -5.3 .. 5.3, 19 %", "--levels N or --mode linear"),
        ("--mode linear", "worst error 0.544 of -5.3 .. 5.3, 5.1 %", "--levels N"),
        ("--mode linear --levels 51", "", ""),
    ],
)
def test_a_large_error_is_said_beside_the_range_and_what_reduces_it(
    mode, cells, ways, tmp_path, capsys
):
    words = ["compile", str(shipped("pd7.frb")), "-o", str(tmp_path / "t.h"), "--table"]
    assert main([*words, *mode.split()]) == 0
    lines = [x for x in capsys.readouterr().out.splitlines() if " %" in x]
    assert lines == ([f"{cells}: less with  {ways}"] if cells else [])


@pytest.mark.parametrize("step", [5e-324, 1e-310, 2.0**-200])
def test_a_step_below_the_distance_of_floats_changes_nothing(step):
    values = np.array([1.7e300, -1.0, 0.25, 0.0])
    assert round_to(values, step).tolist() == values.tolist()
