"""Tables read back into rules."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.inference import infer
from fuzzyarm.language import parse, write
from fuzzyarm.table import (
    Axis,
    LookupTable,
    TableError,
    compare_tables,
    compile_table,
    read_table,
    rules,
)
from fuzzyarm.table.rules import rules_of_table


def test_the_shipped_table_becomes_a_grid_with_a_small_residual():
    table = read_table(shipped("thesis-6.1.lut"))
    found = rules_of_table(table, "back")
    assert len(found.rulebase.rules) == 169
    assert found.worst <= 0.5 + 1e-12
    text = write(found.rulebase)
    assert "rule if" not in text  # all of it fits into one grid
    parsed = parse(text)
    assert not parsed.diagnostics
    assert compile_table(parsed.rulebase).axes[0].bins == table.axes[0].bins


def test_more_terms_leave_less():
    table = read_table(shipped("thesis-6.1.lut"))
    worst = [rules_of_table(table, terms=terms).worst for terms in (7, 13, 25, 61)]
    assert worst == sorted(worst, reverse=True)
    assert worst[-1] < 0.11


levels = st.lists(st.integers(-9, 9), min_size=1, max_size=4, unique=True).map(sorted)


@settings(deadline=None)
@given(st.lists(levels, min_size=1, max_size=3), st.integers(2, 9), st.data())
def test_the_residual_is_what_is_left(axes, terms, data):
    shape = [len(each) for each in axes]
    count = int(np.prod(shape))
    values = data.draw(st.lists(st.integers(-6, 6), min_size=count, max_size=count))
    table = LookupTable(
        tuple(Axis(f"x{k}", tuple(each)) for k, each in enumerate(axes)),
        "u",
        np.array(values, float).reshape(shape),
        low=-6,
        high=6,
    )
    found = rules_of_table(table, terms=terms)
    for index in np.ndindex(*shape):
        point = {a.name: a.levels[i] for a, i in zip(table.axes, index, strict=True)}
        value = infer(found.rulebase, point)["u"]
        assert found.residual[index] == pytest.approx(table.values[index] - value, abs=1e-9)
        own = 12.0 / (terms - 1)
        assert abs(found.residual[index]) <= max(0.5 * own, own / 3.0) + 1e-9


@pytest.mark.parametrize("terms", [0, 1, 100])
def test_terms_out_of_sense(terms):
    with pytest.raises(TableError, match="must be 2 to 99"):
        rules_of_table(read_table(shipped("thesis-6.1.lut")), terms=terms)


def test_a_table_without_an_input_is_compared_as_the_same_along_it():
    plain = LookupTable((Axis("ce", (0, 1)), Axis("e", (0, 1, 2))), "u", [[0, 1, 2], [3, 4, 5]])
    both = np.stack([plain.values.T, plain.values.T])
    both[1, 2, 0] = 9.0
    wide = LookupTable((Axis("joint", (1, 2)), Axis("e", (0, 1, 2)), Axis("ce", (0, 1))), "u", both)
    found = compare_tables(plain, wide)
    assert found.comparable
    (change,) = found.changes
    assert (change.levels, change.before, change.after) == ((2, 2, 0), 2.0, 9.0)
    other = LookupTable((Axis("ce", (0, 1, 2)),), "u", [0, 1, 2])
    assert not compare_tables(other, wide).comparable


def test_each_foot_lies_under_the_neighbouring_peak():
    table = LookupTable((Axis("e", (0, 1, 3)),), "u", [0, 1, 2])
    terms = rules_of_table(table).rulebase.inputs[0].terms
    assert [term.shape.parameters for term in terms] == [(-1, 0, 1), (0, 1, 3), (1, 3, 5)]


@pytest.mark.parametrize(
    ("levels", "names"),
    [
        ((-2, 0, 2), "N1 ZE P1"),
        ((-3, -2, -1, 0, 1, 2, 3), "NB NM NS ZE PS PM PB"),
        ((-1, 1), "T1 T2"),
        ((-2, 1, 2), "T1 T2 T3"),
    ],
)
def test_terms_have_the_usual_names_around_zero(levels, names):
    table = LookupTable((Axis("e", levels),), "u", np.arange(len(levels)))
    assert " ".join(term.name for term in rules_of_table(table).rulebase.inputs[0].terms) == names


def test_the_most_rules_are_made_and_one_more_is_not(monkeypatch):
    table = LookupTable((Axis("a", (0, 1)), Axis("b", (0, 1, 2))), "u", np.zeros((2, 3)))
    monkeypatch.setattr(rules, "MOST_RULES", 6)
    assert len(rules_of_table(table).rulebase.rules) == 6
    monkeypatch.setattr(rules, "MOST_RULES", 5)
    with pytest.raises(TableError, match="6 rules are too many"):
        rules_of_table(table)


def test_tables_whose_levels_differ_in_one_input_are_not_compared_cell_by_cell():
    one = LookupTable((Axis("a", (0, 1)), Axis("b", (0, 1))), "u", np.zeros((2, 2)))
    for axes in (
        (Axis("a", (0, 2)), Axis("b", (0, 1))),
        (Axis("a", (0, 1)), Axis("b", (0, 2))),
    ):
        found = compare_tables(one, LookupTable(axes, "u", np.zeros((2, 2))))
        assert not found.comparable
        assert not found.same
        assert [what for what, _, _ in found.header] in (["levels a"], ["levels b"])
