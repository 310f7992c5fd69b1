"""Edits of the text by hand: terms added, removed and renamed, ranges, rules."""

import re

import pytest

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.language.edit import (
    Reshaped,
    ReshapeError,
    add_term,
    apply_edits,
    read,
    remove_term,
    rename_term,
    set_cell,
    set_rule,
    set_shapes,
    set_variable_range,
)
from fuzzyarm.language.model.rulebase import Shape

PD7 = shipped("pd7.frb").read_text()
TIPPER2 = shipped("tipper2.frb").read_text()


def edited(text, question, *details):
    """Return a text after an edit, which leaves no mistake in it."""
    after = apply_edits(text, question(read(text), *details))
    assert [str(each) for each in read(after).parsed.diagnostics if each.is_error] == []
    return after


@pytest.mark.parametrize("name", ["pd7", "tipper", "tipper2", "thermostat", "fan"])
def test_any_term_is_removed_with_what_names_it_and_the_others_stay(name):
    text = shipped(f"{name}.frb").read_text()
    whole, tried = read(text), 0
    for variable in (*whole.model.inputs, *whole.model.outputs):
        for term in variable.terms:
            try:
                edits = remove_term(whole, variable.name, term.name)
            except ReshapeError:  # an expectation names it
                continue
            tried += 1
            after = read(apply_edits(text, edits))
            assert not [each for each in after.parsed.diagnostics if each.is_error], term.name
            kept = {each.name: each.shape for each in variable.terms if each is not term}
            left = after.model.variable(variable.name).terms
            assert {each.name: each.shape for each in left} == kept
    assert tried > 3


def test_a_family_of_several_variables_keeps_its_comment_and_the_rest():
    after = edited(PD7, remove_term, "u", "NM")
    assert "terms e, ce: triangles NB NM NS ZE PS PM PB  # evenly spaced" in after
    assert "  NM      NB  .   .   .   NS  ZE  PS\n" in after
    assert edited(PD7, remove_term, "ce", "PB").count("\n  e \\ ce  NB  NM  NS  ZE  PS  PM\n") == 1


def test_a_term_is_added_behind_those_of_its_variable():
    shape = Shape("bell", (0.0, 1.0, 2.0), 0.5)
    after = edited(PD7, add_term, "ce", "about zero", shape)
    assert read(after).model.variable("ce").terms[-1].shape == shape
    assert after.replace("term ce 'about zero': bell 0 1 2 height 0.5\n", "") == PD7
    for variable, term in (("ce", "NB"), ("none", "A"), ("ce", " ")):
        with pytest.raises(ReshapeError):
            add_term(read(PD7), variable, term, shape)


def test_both_functions_of_an_interval_are_written():
    lower = Shape("triangle", (2.0, 5.0, 8.0), 0.75)
    new = Reshaped("tip", "cheap", Shape("triangle", (0.0, 5.0, 9.0)), lower)
    after = edited(TIPPER2, set_shapes, [new])
    assert " triangle 0 5 9 over triangle 2 5 8 height 0.75\n" in after
    assert read(after).model.variable("tip").term("cheap").lower == lower


def test_a_name_changes_wherever_it_stands():
    after = edited(TIPPER2, rename_term, "food", "rancid", "off")
    assert "food is rancid" not in after
    assert after.count("food is off") == TIPPER2.count("food is rancid")
    with pytest.raises(ReshapeError):
        rename_term(read(TIPPER2), "food", "none", "off")


def test_a_range_is_written_and_must_rise():
    assert "output u   -3 .. 3.5  " in edited(PD7, set_variable_range, "u", -3.0, 3.5)
    for low, high in ((1.0, 1.0), (2.0, 1.0), (float("nan"), 1.0)):
        with pytest.raises(ReshapeError):
            set_variable_range(read(PD7), "u", low, high)


def test_sentences_are_written_changed_and_removed():
    new = "if service is poor then tip is cheap with 0.5"
    after = edited(TIPPER2, set_rule, None, f"rule  {new}")
    rules = read(TIPPER2).model.rules
    line = rules[-1].span.line + 1
    assert after.splitlines()[line - 1] == f"rule {new}"
    assert edited(after, set_rule, line, "") == TIPPER2
    changed = edited(TIPPER2, set_rule, rules[1].span.line, "if food is rancid then tip is cheap")
    assert len(read(changed).model.rules) == len(rules)
    for at, words, said in (
        (None, "if food is none then tip is cheap", "none"),
        (None, "", "if … then"), (1, new, "no rule begins"), (None, "if food", "is"),
        (None, "if food is rancid then tip is cheap with 1\nrule x", "end of the line"),
    ):  # fmt: skip
        with pytest.raises(ReshapeError, match=said):
            set_rule(read(TIPPER2), at, words)
    with pytest.raises(ReshapeError) as error:
        set_rule(read(TIPPER2), None, "if food is rancidd then tip is cheap")
    assert error.value.hint == "did you mean 'rancid'?"


def test_the_last_line_goes_with_the_break_in_front_of_it():
    text = TIPPER2[: TIPPER2.index("\n\n# The middle")]
    last = read(text).model.rules[-1].span.line
    assert last == len(text.splitlines())
    assert edited(text, set_rule, last, "") == "\n".join(text.splitlines()[:-1])


SUMS = """rulebase sums
input e -1 .. 1
input 'c e' -2 .. 2
output u -5 .. 5
output k -5 .. 5
terms e, 'c e': triangles N P
term u A: linear 0.5*e - 2*'c e' + 1
term u B: linear 0
term k C: linear 4 height 0.5
term k D: formula "e + 1"
inference defuzzifier weighted-average
rule if e is N then u is A, k is C
rule if 'c e' is P then u is B, k is D
"""


def test_a_sum_and_a_formula_are_written_as_the_text_has_them():
    model = read(SUMS).model
    shapes = [(v.name, t.name, t.shape) for v in (*model.inputs, *model.outputs) for t in v.terms]
    assert read(edited(SUMS, set_shapes, shapes)).model.outputs == model.outputs
    after = edited(SUMS, set_shapes, [("u", "B", Shape("linear", (0.0, 3.0, -1.0)))])
    assert "term u B: linear 3*'c e' - 1\n" in after
    with pytest.raises(ReshapeError, match="a sum of 2 inputs has 3 numbers, not 2"):
        set_shapes(read(SUMS), [("u", "B", Shape("linear", (3.0, -1.0)))])


GRID = """\
rulebase g
input e 0 .. 1
input ce 0 .. 1
output u 0 .. 1
terms e: triangles N P
terms ce: triangles A B C
terms u: triangles LO HI
rules u
  e \\ ce  A   B       C   # LO, as it was
  N       LO  HI*0.5  LO
  P       HI  .       HI
"""


def columns(text):
    lines = text[text.index("rules u") :].splitlines()[1:]
    return [[word.start() for word in re.finditer(r"\S+", line.split("#")[0])] for line in lines]


def test_columns_stay_below_each_other_after_a_rename_and_a_choice():
    for name in ("VERY_LOW", "'dead slow'", "L"):
        text = apply_edits(GRID, rename_term(read(GRID), "u", "LO", name))
        header, first, second = columns(text.replace("dead slow", "dead_slow"))
        assert header[-3:] == first[-3:] == second[-3:], text
        assert "# LO, as it was" in text
    text = apply_edits(GRID, set_cell(read(GRID), 10, 11, "HI"))
    assert columns(text) == columns(GRID)
    long = GRID.replace("LO HI\n", "LO ENORMOUS\n").replace("HI*0.5", "LO*0.5").replace("HI", "LO")
    header, first, second = columns(apply_edits(long, set_cell(read(long), 10, 11, "ENORMOUS")))
    assert header[-3:] == first[-3:] == second[-3:]
    assert read(apply_edits(long, set_cell(read(long), 10, 11, "ENORMOUS"))).parsed.rulebase


SPEED = """\
rulebase f
input 'fan speed' 0 .. 1
output y 0 .. 1
terms 'fan speed': triangles 'dead slow' low
terms y: triangles A B
rule if 'fan speed' is low then y is B
"""


@pytest.mark.parametrize(
    ("typed", "written"),
    [
        ("if fan speed is dead slow then y is A", "if 'fan speed' is 'dead slow' then y is A"),
        ("if 'fan speed' is dead slow then y is A", "if 'fan speed' is 'dead slow' then y is A"),
        ("if fan speed is low then y is A", "if 'fan speed' is low then y is A"),
    ],
)
def test_a_rule_is_taken_as_a_page_prints_it(typed, written):
    assert f"rule {written}\n" in apply_edits(SPEED, set_rule(read(SPEED), None, typed))
    assert f"rule {written}\n" in apply_edits(SPEED, set_rule(read(SPEED), 6, typed))


def test_a_rule_with_a_mistake_says_what_is_wrong_with_what_was_typed():
    with pytest.raises(ReshapeError, match="'fun'"):
        set_rule(read(SPEED), None, "if fun is dead slow then y is A")
