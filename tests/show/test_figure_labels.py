"""No two texts of a figure overlap, and none leaves it; columns in the terminal stay apart."""

from __future__ import annotations

from itertools import pairwise

import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm.apps.show.drawing import HeatGrid, plain_text, ruler
from fuzzyarm.apps.show.figures import (
    inference_figure,
    memberships_figure,
    rulebase_figure,
    table_figure,
)
from fuzzyarm.apps.show.figures.labels import shortened, spread, text_width, thinned, wrapped
from fuzzyarm.apps.watch import RulebaseScene
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.exchange.files import load
from fuzzyarm.inference import explain
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.table import LookupTable, compile_table
from tests.show.boxes import faults


def one_input(count):
    terms = " ".join(f"T{k}" for k in range(count))
    return parse(
        f"rulebase many\ninput a 0 .. 1\noutput y -1e-3 .. 1e-3\nterms a, y: triangles {terms}\n"
        f"rules y\n  a {terms}\n  y {terms}\n"
    ).rulebase


def long_names():
    """Return a rule base whose names and descriptions are as long as they come."""
    sizes = ("very_small", "small", "medium", "rather_large", "large", "enormous")
    sides = ("below", "above")
    terms = [f"position_error_that_is_{side}_{size}" for side in sides for size in sizes]
    error, rate, torque = (
        f"the_{what}_of_the_position_of_the_first_joint" for what in ("error", "rate", "torque")
    )
    words, row = " ".join(terms), "\n".join(f"  {term} {' '.join(terms)}" for term in terms)
    return parse(
        f'rulebase {"name_" * 20} "a description that is no shorter than the name, by no means"\n'
        f'input {error} -6 .. 6 "{"angle between set point and position " * 3}"\n'
        f'input {rate} -1e5 .. 1e5 "its rate"\noutput {torque} 0 .. 1e-4 "torque, Nm"\n'
        f"terms {error}, {rate}, {torque}: triangles {words}\n"
        f"rules {torque}\n  {error} \\ {rate} {words}\n{row}\n"
    ).rulebase


def sugeno(count=25):
    values = "".join(
        f"term y V{k}: linear {k / 3}*a + {k / 7}*b + {k}\nrule if a is T{k % 5} and b is T{k // 5}"
        f" then y is V{k}\n"
        for k in range(count)
    )
    return parse(
        "rulebase ts\ninput a 0 .. 1\ninput b 0 .. 1\noutput y 0 .. 20\n"
        f"terms a, b: triangles T0 T1 T2 T3 T4\ninference y: defuzzifier weighted-average\n{values}"
    ).rulebase


def sheet(name):
    model = load(shipped(name))
    if isinstance(model, RuleBase | LookupTable):
        return model
    return model.model.rulebases[0] if model.model.rulebases else None


def point(rulebase):
    return {each.name: each.low + 0.37 * (each.high - each.low) for each in rulebase.inputs}


def pictures(model):
    if isinstance(model, LookupTable):
        return [table_figure(model)]
    return [rulebase_figure(model), inference_figure(model, explain(model, point(model)))]


@pytest.mark.slow
@pytest.mark.parametrize(
    "make",
    [
        lambda: rulebase_figure(sheet("fine7.frb")),
        lambda: inference_figure(m := sheet("thermostat.frb"), explain(m, point(m))),
        lambda: memberships_figure(one_input(59)),
        lambda: table_figure(compile_table(sheet("pd7.frb"), levels=59)),
        lambda: table_figure(compile_table(one_input(5), levels=17)),
        lambda: rulebase_figure(long_names()),
        lambda: memberships_figure(sugeno()),
    ],
    ids=["fine7", "thermostat", "59 terms", "59 levels", "steps", "long names", "values"],
)
def test_no_two_texts_of_a_figure_overlap(make):
    assert faults(make()) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["slide7.frb", "thesis-6.1.lut"])
def test_no_two_texts_of_the_figures_of_a_shipped_file_overlap(name):
    for figure in pictures(sheet(name)):
        assert faults(figure) == []


def test_a_narrow_set_is_not_missed_by_the_map():
    text = (
        "rulebase r\ninput a 0 .. 1\ninput b 0 .. 1\noutput y 0 .. 1\nterms b, y: triangles LO HI\n"
        "term a needle: triangle 0.5001 0.5002 0.5003\nterm a rest: trapezoid 0 0 1 1\n"
        "rule if a is needle then y is HI\nrule if b is LO then y is LO with 1e-6\n"
    )
    flat = next(
        axes for axes in rulebase_figure(parse(text).rulebase).axes if axes.get_ylabel() == "a"
        and axes.get_xlabel() == "b"
    )  # fmt: skip
    assert flat.collections[0].get_array().max() > 0.6


# --- Places in a row ---

widths = st.lists(st.floats(0.01, 0.5), min_size=1, max_size=12)


@settings(max_examples=cases(20, 60), deadline=None)
@given(st.data(), widths)
def test_labels_in_a_row_stand_apart_and_near(data, widths):
    wanted = sorted(
        data.draw(st.lists(st.floats(0, 4), min_size=len(widths), max_size=len(widths)))
    )
    places = spread(wanted, widths, 0.0, 4.0)
    if sum(widths) > 4.0:
        assert places is None
        return
    ends = [(x - 0.5 * w, x + 0.5 * w) for x, w in zip(places, widths, strict=True)]
    assert ends[0][0] >= -1e-9
    assert ends[-1][1] <= 4.0 + 1e-9
    assert all(b[0] >= a[1] - 1e-9 for a, b in pairwise(ends))
    # Nothing moves where nothing is in the way.
    free = [(x - 0.5 * w, x + 0.5 * w) for x, w in zip(wanted, widths, strict=True)]
    apart = all(b[0] >= a[1] for a, b in pairwise(free))
    if apart and free[0][0] >= 0.0 and free[-1][1] <= 4.0:
        assert places == pytest.approx(wanted)


def test_texts_fit_the_room_they_are_given():
    text = "position error of the first joint before the gear"
    assert all(text_width(line, 9) <= 1.5 for line in wrapped(text, 9, 1.5).split("\n"))
    long = "rate: change of the room temperature, K per 10 min"
    assert wrapped(long, 9, 2.9) == "rate: change of the room\ntemperature, K per 10 min"
    assert wrapped(f"{long} {long}", 9, 1.3, 2).endswith(" …")
    short = shortened("a_long_name_that_ends_in_small", 8, 1.0)
    assert text_width(short, 8) <= 1.0
    assert (short[:2], short[-2:]) == ("a_", "ll")
    assert thinned(range(100), 5) == [0, 25, 50, 74, 99]
    assert thinned("ab", 5) == ["a", "b"]


# --- In the terminal ---

words = st.text("abcdefgh_", min_size=1, max_size=24)


def same(shown, name):
    """Whether a label is a name, or both ends of it."""
    start, dots, end = shown.partition("…")
    return shown == name or (bool(dots) and name.startswith(start) and name.endswith(end))


@settings(max_examples=cases(20, 60), deadline=None)
@given(
    st.lists(words, min_size=1, max_size=30),
    st.lists(words, min_size=1, max_size=4),
    st.integers(32, 140),
)
def test_the_columns_of_a_grid_in_the_terminal_stay_apart(columns, rows, width):
    cells = [[(f"{i}.{j}", "") for j in range(len(columns))] for i in range(len(rows))]
    lines = plain_text(HeatGrid("x", columns, rows, cells), width).splitlines()
    bands = [lines[k : k + len(rows) + 1] for k in range(0, len(lines), len(rows) + 2)]
    heads = [name for band in bands for name in band[0].split()[1:]]
    assert [same(*pair) for pair in zip(heads, columns, strict=True)].count(False) == 0
    for i, row in enumerate(rows):
        found = [band[i + 1].split() for band in bands]
        assert all(same(each[0], row) for each in found)
        assert [cell for each in found for cell in each[1:]] == [text for text, _ in cells[i]]


@settings(max_examples=cases(66, 200), deadline=None)
@given(
    st.floats(-1e6, 1e6), st.floats(1e-6, 1e6), st.integers(8, 80), st.one_of(st.just(""), words)
)
def test_the_words_below_a_plot_stay_apart(low, span, width, name):
    line = ruler(low, low + span, width, name)
    assert len(line) in (0, width)
    parts = line.split()
    assert len(parts) <= 3
    # Whatever stands there is a number of its own, or the name or its ends.
    for part in (parts[0], parts[-1]) if line else ():
        assert float(part) == pytest.approx(low + span * (part is parts[-1]), abs=0.6 * 10**6)
    if name and len(parts) == 3:
        assert parts[1] == name or "…" in parts[1]


@pytest.mark.parametrize("width", [30, 46])
def test_long_names_leave_no_line_of_a_pane_longer_than_the_pane(width):
    scene = RulebaseScene(long_names())
    for view in ("surface", "terms"):
        lines = plain_text(scene.draw(view, width, 14), width).splitlines()
        assert max(map(len, lines)) <= width
