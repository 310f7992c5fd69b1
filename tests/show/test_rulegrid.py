from __future__ import annotations

from fuzzyarm.apps.show.diff import compare_rulebases
from fuzzyarm.apps.show.drawing import plain_text
from fuzzyarm.apps.show.rulebase import expression_words, find_grids, rules_view
from fuzzyarm.language import parse
from fuzzyarm.language.edit.hover import rule_sentence

HEADER = """\
rulebase r
input a 0 .. 1
input b 0 .. 1
input c 0 .. 1
output y 0 .. 1
output z 0 .. 1
terms a, b, c: triangles LO HI
terms y, z: triangles S M L
"""


def rulebase(text: str):
    parsed = parse(HEADER + text)
    assert parsed.rulebase is not None, parsed.diagnostics
    return parsed.rulebase


def test_rules_in_words_form_the_same_grid_whatever_their_order():
    grid = rulebase("rules y\n a \\ b LO HI\n LO S M\n HI M L\n")
    loose = rulebase(
        "rule if a is HI and b is HI then y is L\n"
        "rule if a is LO and b is LO then y is S\n"
        "rule if a is HI and b is LO then y is M\n"
        "rule if a is LO and b is HI then y is M\n"
    )
    assert plain_text(rules_view(grid)) == plain_text(rules_view(loose))
    assert compare_rulebases(grid, loose).same


def test_further_conditions_make_further_grids():
    base = rulebase(
        "rules y when c is LO\n a \\ b LO HI\n LO S S\n HI S S\n"
        "rules y when c is HI\n a \\ b LO HI\n LO L L\n HI L L\n"
    )
    text = plain_text(rules_view(base))
    assert text.index("when c is LO") < text.index("S") < text.index("when c is HI")


def test_contradictions_weights_holes_and_several_outputs():
    base = rulebase(
        "rules y\n a \\ b LO HI\n LO S .\n HI M*0.5 L\n"
        "rule if a is LO and b is LO then y is L\n"
        "rule if a is LO and b is HI then y is M and z is S\n"
        "rule if a is LO then z is S\n"
        "rule if a is very LO or b is not HI then z is L with 0.25\n"
    )
    grids, others = find_grids(base.blocks[0])
    assert [(g.output, g.row, g.column) for g in grids] == [("y", "a", "b")]
    text = plain_text(rules_view(base))
    assert "S/L" in text
    assert "M*0.5" in text
    assert [rule_sentence(rule) for rule in others] == [
        "if a is LO and b is HI then y is M and z is S",
        "if a is LO then z is S",
        "if a is very LO or b is not HI then z is L with 0.25",
    ]


def test_words_keep_the_parentheses_that_matter():
    text = "rule if (a is LO or b is LO) and not (b is HI and c is somewhat LO) then y is S\n"
    rule = rulebase(text).blocks[0].rules[0]
    words = expression_words(rule.antecedent)
    assert words == "(a is LO or b is LO) and not (b is HI and c is somewhat LO)"
    again = rulebase(f"rule if {words} then y is S\n").blocks[0].rules[0]
    assert again == rule


def test_differences_name_each_rule():
    before = rulebase("rules y\n a \\ b LO HI\n LO S M\n HI M L\n")
    after = rulebase("rules y\n a \\ b LO HI\n LO S L\n HI . L\nrule if c is LO then z is S\n")
    diff = compare_rulebases(before, after)
    assert [(c.kind, c.what, c.before, c.after) for c in diff.rules] == [
        ("changed", "if a is LO and b is HI", "y is M", "y is L"),
        ("removed", "if a is HI and b is LO", "y is M", ""),
        ("added", "if c is LO", "", "z is S"),
    ]
    assert not diff.terms
    assert compare_rulebases(before, before).same


def test_what_has_another_name_alone_is_one_line():
    rules = (
        "input s 0 .. 2\noutput w 0 .. 3\nterms s: triangles C H\nterms w: triangles X Y\n"
        "rule if s is C then w is X\nrule if s is H and a is LO then w is Y\n"
    )
    before = rulebase(rules)
    renamed = rules.replace("s is", "temp is").replace("input s", "input temp")
    renamed = renamed.replace("terms s", "terms temp").replace(" C", " cold")
    changes = [("input", "s", "temp")], [("term of temp", "C", "cold")]
    diff = compare_rulebases(before, rulebase(renamed))
    assert not diff.rules
    assert not diff.same
    for found, expected in zip((diff.settings, diff.terms), changes, strict=True):
        assert [(c.what, c.before, c.after) for c in found] == expected
        assert {c.kind for c in found} == {"renamed"}
    # With another range it is another variable.
    diff = compare_rulebases(before, rulebase(renamed.replace("0 .. 2", "0 .. 4")))
    assert {c.kind for c in diff.settings} == {"added", "removed"}


def test_names_with_words_of_the_language_in_them_are_told_apart():
    rules = "term y '{0} then M': triangle 0 {1} 1\nrule if a is LO then y is '{0} then M'\n"
    before, after = (
        rulebase("term y 'S then M': triangle 0 0.5 1\n" + rules.format(word, peak))
        for word, peak in (("L", 0.25), ("X", 0.75))
    )
    assert [(c.kind, c.before, c.after) for c in compare_rulebases(before, after).rules] == [
        ("changed", "y is 'L then M'", "y is 'X then M'")
    ]


def test_a_rule_of_two_conclusions_is_two_grids():
    together = rulebase("rule if a is LO and b is HI then y is M and z is S with 0.5\n")
    grid = "rules {0}\n a \\ b LO HI\n LO . {1}*0.5\n HI . .\n"
    apart = rulebase(grid.format("y", "M") + grid.format("z", "S"))
    assert compare_rulebases(together, apart).same
    other = rulebase("rule if b is HI and a is LO then z is S and y is L with 0.5\n")
    assert [(c.kind, c.what, c.before, c.after) for c in compare_rulebases(apart, other).rules] == [
        (
            "changed",
            "if a is LO and b is HI",
            "y is M with 0.5, z is S with 0.5",
            "y is L with 0.5, z is S with 0.5",
        )
    ]
