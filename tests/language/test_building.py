"""Edits of the text by hand: variables, settings, rules in words, grids, their rows and columns."""

import itertools

import pytest

from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.inference import infer
from fuzzyarm.language.edit import (
    RenameError,
    ReshapeError,
    add_column,
    add_grid,
    add_row,
    add_rule,
    add_term,
    add_variable,
    apply_edits,
    read,
    remove_column,
    remove_grid,
    remove_row,
    remove_term,
    remove_variable,
    rename_variable,
    set_cell,
    set_rule,
    set_setting,
)
from fuzzyarm.language.edit.lines import INCOMPLETE
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.language.rules import GridNode

PD7 = shipped("pd7.frb").read_text()


def mistakes(text):
    return [each for each in read(text).parsed.diagnostics if each.is_error]


def edited(text, question, *details, incomplete=False):
    """Return a text after an edit, which leaves no mistake but that something is not there yet."""
    after = apply_edits(text, question(read(text), *details))
    allowed = INCOMPLETE if incomplete else set()
    assert [str(each) for each in mistakes(after) if each.name not in allowed] == []
    return after


def _rule_bases():
    for name in shipped_names():
        text = shipped(name).read_text()
        if name.endswith(".frb") and read(text).parsed.rulebase is not None:
            yield pytest.param(text, id=name)


RULE_BASES = list(_rule_bases())


# --- from nothing ---


def test_a_rule_base_is_made_of_nothing_but_edits():
    text = '# mine\nrulebase mine "by hand"\n'
    text = edited(text, add_variable, "output", "u", (-1.0, 1.0), ("N", "Z", "P"), incomplete=True)
    text = edited(text, add_variable, "input", "e", (-2.0, 2.0), ("N", "P"), incomplete=True)
    text = edited(text, add_variable, "input", "my rate", (0.0, 5.0), incomplete=True)
    text = edited(
        text, add_term, "my rate", "is", Shape("triangle", (0.0, 2.0, 4.0)), incomplete=True
    )
    text = edited(text, add_rule, [("e", "N"), ("my rate", "is")], [("u", "Z")], "or")
    text = edited(text, set_setting, "and", "product")
    text = edited(text, set_setting, "defuzzifier", "bisector")
    text = edited(text, add_grid, "u", "e", None, "falling")
    assert (
        text
        == """\
# mine
rulebase mine "by hand"

input  e  -2 .. 2
input  'my rate'  0 .. 5
output u  -1 .. 1

terms u: triangles N Z P
terms e: triangles N P
term 'my rate' 'is': triangle 0 2 4

inference and product, defuzzifier bisector
rule if e is N or 'my rate' is 'is' then u is Z

rules u
  e  N  P
  u  P  N
"""
    )
    assert infer(read(text).model, e=2, **{"my rate": 0})["u"] < 0


def test_a_text_without_anything_takes_a_variable():
    for text in ("", "\n", "# a comment", '# a comment\n\nrulebase r "r"'):
        after = apply_edits(text, add_variable(read(text), "input", "x", (0.0, 1.0), ("A", "B")))
        assert [each.name for each in read(after).model.inputs] == ["x"]
        assert "terms x: triangles A B" in after
        assert text.strip() in after


# --- variables ---


@pytest.mark.parametrize("text", RULE_BASES)
def test_any_variable_is_removed_with_all_that_names_it(text):
    model, tried = read(text).model, 0
    for variable in (*model.inputs, *model.outputs):
        try:
            after = edited(text, remove_variable, variable.name, incomplete=True)
        except ReshapeError:  # another's term or a grid of several outputs names it
            continue
        tried += 1
        rest = read(after).model
        left = {each.name: each.terms for each in (*rest.inputs, *rest.outputs)}
        assert variable.name not in left
        for each in (*model.inputs, *model.outputs):
            if each is not variable:
                assert [(t.name, t.shape) for t in left[each.name]] == [
                    (t.name, t.shape) for t in each.terms
                ]
        kept = [line for line in text.splitlines() if line.startswith("#")]
        assert [line for line in after.splitlines() if line.startswith("#")] == kept
        assert "\n\n\n" not in after.replace(text, "")
    assert tried


def test_blocks_keep_what_is_said_of_other_variables():
    text = """\
rulebase r "r"
input a 0 .. 1
input b 0 .. 1
output y 0 .. 1
output z 0 .. 1
terms a, b, y, z: triangles L H
inference b: outside error
rule if a is L then y is L and z is H  # both
rule if b is L then z is H
lookup
  levels a: 0 .. 1 count 3
  levels b: 0 .. 1 count 3
tune
  peaks a, b, z  mirrored
  keep  b L
expect a = 0, b = 0 -> z > 0.5
"""
    after = edited(text, remove_variable, "b")
    assert "terms a, y, z: triangles L H\n" in after
    assert after.count("rule if") == 1
    assert "levels a" in after
    assert "peaks a, z  mirrored\n" in after
    for gone in ("inference", "levels b", "keep", "expect"):
        assert gone not in after
    after = edited(text, remove_variable, "z")
    assert "rule if a is L then y is L  # both\n" in after
    assert "rule if b" not in after


@pytest.mark.parametrize(
    ("details", "said"),
    [
        (("input", "e", (0.0, 1.0)), "there is a variable 'e' already"),
        (("input", "x", (1.0, 0.0)), "from a lower to a higher"),
        (("input", " ", (0.0, 1.0)), "needs a name"),
        (("rule", "x", (0.0, 1.0)), "an input or an output"),
        (("input", "x", (0.0, 1.0), ("A", "A")), "'A'"),
        (("input", "x", (0.0, 1.0), ("A\nrule", "B")), ""),
    ],
)
def test_a_variable_that_cannot_be_is_refused(details, said):
    with pytest.raises(ReshapeError) as caught:
        add_variable(read(PD7), *details)
    assert said in str(caught.value)


def test_a_variable_is_renamed_wherever_it_stands():
    after = edited(PD7, rename_variable, "ce", "rate of e")
    assert "'rate of e'" in after
    assert "ce" not in {each.name for each in read(after).model.inputs}
    assert len(read(after).model.rules) == 49
    with pytest.raises(RenameError):
        rename_variable(read(PD7), "ce", "u")


# --- settings ---


def test_a_setting_is_changed_where_it_stands_or_added():
    after = edited(PD7, set_setting, "and", "product")
    assert after == PD7.replace("inference and min", "inference and product")
    after = edited(PD7, set_setting, "threshold", "0.1")
    assert "no-rule error, threshold 0.1" in after or ", threshold 0.1\n" in after
    text = edited(PD7, set_setting, "defuzzifier", "bisector", "u")
    assert "\ninference u: defuzzifier bisector\n" in text
    assert str(read(text).model.outputs[0].defuzzifier).startswith("bisector")
    text = edited(text, set_setting, "defuzzifier", "mean-of-maximum", "u")
    assert text.count("inference u:") == 1
    assert str(read(text).model.outputs[0].defuzzifier).startswith("mean-of-maximum")


@pytest.mark.parametrize(
    ("key", "value", "target", "said"),
    [
        ("and", "nonsense", "", "nonsense"),
        ("nonsense", "min", "", "nonsense"),
        ("and", "min, or max", "", "is not a setting"),
        ("and", "product", "u", "belongs to rules"),
        ("defuzzifier", "weighted-sum\nrule", "", "rule"),
    ],
)
def test_a_setting_that_cannot_be_is_refused(key, value, target, said):
    with pytest.raises(ReshapeError) as caught:
        set_setting(read(PD7), key, value, target)
    assert said in str(caught.value)


def test_every_choice_of_norms_is_taken_by_any_rule_base():
    from fuzzyarm.symbolic.kinds import SNORMS, TNORMS

    for key, kinds in (("and", TNORMS), ("implication", TNORMS), ("or", SNORMS)):
        for value in itertools.islice(kinds, 6):
            if value in kinds.words:
                assert f"{key} {value}" in edited(PD7, set_setting, key, value)


# --- grids ---


@pytest.mark.parametrize("text", RULE_BASES)
def test_rows_and_columns_go_and_come_back_with_the_rest_of_the_grid(text):
    whole = read(text)
    grids = [s.node for s in whole.document.statements if isinstance(s.node, GridNode)]
    for grid in grids:
        line, rules = grid.span.line, len(whole.model.rules)
        heads = [(remove_column, add_column, str(each)) for each in grid.columns]
        if grid.row is not None:
            heads += [(remove_row, add_row, str(each.label)) for each in grid.rows]
        for remove, add, term in heads:
            less = apply_edits(text, remove(whole, line, term))
            smaller = read(less)
            assert len(smaller.model.rules) < rules or "." in text
            if less.count("\n  ") < 3:
                continue
            again = read(apply_edits(less, add(smaller, line, term)))
            (same,) = [
                s.node
                for s in again.document.statements
                if isinstance(s.node, GridNode) and s.node.span.line == line
            ]
            assert same.columns == grid.columns
            assert [e.label for e in same.rows] == [e.label for e in grid.rows]
            assert [e for e in again.parsed.diagnostics if e.is_error] == []


def test_columns_stay_below_each_other():
    after = edited(PD7, remove_column, 12, "NS")
    assert "  e \\ ce  NB  NM  ZE  PS  PM  PB\n  NB      NB  NB  NM  NS  NS  ZE\n" in after
    after = edited(after, add_column, 12, "NS")
    assert "  e \\ ce  NB  NM  NS  ZE  PS  PM  PB\n  NB      NB  NB  .   NM  NS  NS  ZE\n" in after
    after = edited(after, remove_column, 12, "PB")
    after = edited(after, add_column, 12, "PB")
    assert "  e \\ ce  NB  NM  NS  ZE  PS  PM  PB\n  NB      NB  NB  .   NM  NS  NS  .\n" in after
    after = edited(after, remove_row, 12, "ZE")
    after = edited(after, add_row, 12, "ZE")
    assert "\n  ZE      .   .   .   .   .   .   .\n  PS " in after


def test_a_row_of_a_new_term_stands_where_its_centre_is():
    shape = Shape("triangle", (-1.0, 0.5, 1.0))
    after = edited(PD7, add_row, 12, "a bit", shape)
    rows = [line.split("  ")[1] for line in after.splitlines()[14:22]]
    assert rows == ["NB", "NM", "NS", "ZE", "'a bit'", "PS", "PM", "PB"]
    assert "term e 'a bit': triangle -1 0.5 1\n" in after
    after = edited(PD7, add_column, 12, "a bit", shape)
    assert "  e \\ ce  NB  NM  NS  ZE  'a bit'  PS  PM  PB\n" in after
    with pytest.raises(ReshapeError, match="already"):
        add_row(read(PD7), 12, "ZE")
    with pytest.raises(ReshapeError, match="no term 'XX'"):
        add_row(read(PD7), 12, "XX")
    with pytest.raises(ReshapeError, match="no grid begins on line 3"):
        add_row(read(PD7), 3, "ZE")


def test_cells_of_several_outputs_stay_together():
    text = """\
rulebase r "r"
input a 0 .. 1
output y 0 .. 1
output z 0 .. 1
terms a, y, z: triangles L M H
rules y, z
  a  L    M    H
  y  L/H  M/M  H/L   # two at a time
"""
    after = edited(text, remove_column, 6, "M")
    assert "  a  L    H\n  y  L/H  H/L   # two at a time\n" in after
    after = edited(after, add_column, 6, "M")
    assert "  a  L    M  H\n  y  L/H  .  H/L   # two at a time\n" in after
    with pytest.raises(ReshapeError, match="one row"):
        add_row(read(text), 6, "L")
    with pytest.raises(ReshapeError, match="concludes 'z' and others"):
        remove_variable(read(text), "z")


def test_a_grid_is_added_whole_and_removed_whole():
    without = edited(PD7, remove_grid, 12, incomplete=True)
    assert "rules" not in without.replace("rules on error", "")
    for fill, first in (("empty", "."), ("rising", "NB"), ("falling", "PB")):
        after = edited(without, add_grid, "u", "ce", "e", fill, incomplete=fill == "empty")
        assert f"\n\nrules u\n  e \\ ce  NB  NM  NS  ZE  PS  PM  PB\n  NB      {first}" in after
    rising = read(edited(without, add_grid, "u", "ce", "e", "rising")).model
    assert len(rising.rules) == 49
    assert infer(rising, e=0, ce=0)["u"] == 0
    assert infer(rising, e=6, ce=6)["u"] > 5
    with pytest.raises(ReshapeError, match="down and across"):
        add_grid(read(PD7), "u", "e", "e")


def test_the_last_row_takes_the_grid_and_the_last_rule_leaves_an_incomplete_text():
    text = """\
rulebase r "r"
input a 0 .. 1
output y 0 .. 1
terms a, y: triangles L H
rules y
  a  H
  y  L
"""
    after = edited(text, remove_column, 5, "H", incomplete=True)
    assert "rules" not in after
    text = edited(after, add_rule, [("a", "L")], [("y", "H")])
    assert edited(text, set_rule, 5, "", incomplete=True) == after
    assert "'L'" not in edited(text, remove_term, "a", "H")
    cell = read(PD7).model.rules[0].span
    assert "." in edited(PD7, set_cell, cell.line, cell.column, None)
