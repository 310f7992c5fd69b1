"""What the parser understands, and how it speaks of what it does not."""

import itertools
import math

import pytest

from fuzzyarm.base.diagnostic import (
    MAX_CHARACTERS,
    MAX_DIAGNOSTICS,
    MAX_LINE,
    MAX_TERMS,
    RuleBaseError,
    render_all,
)
from fuzzyarm.language import format_text, load_rulebase, parse, write
from fuzzyarm.language.model.rulebase import And, Hedge, Hedged, Is, Or

HEAD = """rulebase t
input e -6 .. 6
input ce -6 .. 6
output u -6 .. 6
terms e, ce, u: triangles N Z P
"""


def rules_of(text):
    parsed = parse(HEAD + text)
    assert parsed.diagnostics == (), parsed.diagnostics
    return parsed.rulebase.rules


def names_of(text):
    return [diagnostic.name for diagnostic in parse(text).diagnostics]


def test_and_binds_tighter_than_or():
    (rule,) = rules_of("rule if e is N or e is Z and ce is P then u is N")
    e_n, e_z, ce_p = Is("e", "N"), Is("e", "Z"), Is("ce", "P")
    assert rule.antecedent == Or((e_n, And((e_z, ce_p))))


def test_parentheses_and_hedges():
    (rule,) = rules_of("rule if not (e is very N or ce is not power(1.5) P) then u is Z with 0.25")
    inner = Or((Is("e", "N", (Hedge("very"),)), Is("ce", "P", (Hedge("not"), Hedge("power", 1.5)))))
    assert rule.antecedent == Hedged((Hedge("not"),), inner)
    assert rule.weight == 0.25


def test_more_or_less_is_somewhat():
    (rule,) = rules_of("rule if e is more-or-less N then u is N")
    assert rule.antecedent == Is("e", "N", (Hedge("somewhat"),))


def test_a_grid_is_row_then_column_and_not_the_other_way_round():
    rules = rules_of("rules u\n  e \\ ce N P\n  N  N P\n  Z  Z .\n")
    cells = {tuple(p.term for p in r.antecedent.operands): r.consequents[0].term for r in rules}
    assert cells == {("N", "N"): "N", ("N", "P"): "P", ("Z", "N"): "Z"}
    assert all([p.variable for p in r.antecedent.operands] == ["e", "ce"] for r in rules)


def test_grid_cells_know_their_place_and_weight():
    rules = rules_of("rules u\n  e \\ ce N P\n  N  N P*0.5\n")
    assert [(r.span.line, r.span.column) for r in rules] == [(8, 6), (8, 8)]
    assert [r.weight for r in rules] == [1.0, 0.5]


def test_when_is_added_to_every_rule_of_a_grid():
    rules = rules_of("rules u when ce is P\n  e N P\n  u N P\n")
    assert rules[1].antecedent == And((Is("e", "P"), Is("ce", "P")))


def test_the_order_of_lines_is_free():
    lines = (HEAD + "rule if e is N then u is N\n").splitlines()
    assert (
        parse("\n".join(reversed(lines))).rulebase.rules == parse("\n".join(lines)).rulebase.rules
    )


def test_even_triangles_have_their_feet_under_the_neighbours_peaks():
    rulebase = parse(
        "rulebase t\ninput e 0 .. 0.7\noutput u 0 .. 1\n"
        "terms e, u: triangles A B C D\nrule if e is A then u is A"
    ).rulebase
    shapes = [term.shape.parameters for term in rulebase.inputs[0].terms]
    for left, right in itertools.pairwise(shapes):
        assert left[2] == right[1]
        assert right[0] == left[1]


def test_even_gaussians_cross_at_one_half():
    from fuzzyarm.language.model.shapes import membership

    rulebase = parse(
        "rulebase t\ninput e 0 .. 10\noutput u 0 .. 1\nterms e: gaussians A B C\n"
        "terms u: singletons X Y\nrule if e is A then u is X"
    ).rulebase
    first, second, _ = (term.shape for term in rulebase.inputs[0].terms)
    assert membership(first, 2.5) == pytest.approx(0.5)
    assert membership(second, 2.5) == pytest.approx(0.5)


@pytest.mark.parametrize(
    "value", ["0.1", "1e-300", "-0.30000000000000004", "123456789.125", "-0.0"]
)
def test_numbers_survive(value):
    text = HEAD + f"term u X: singleton {value}\nrule if e is N then u is X"
    again = parse(format_text(text)).rulebase.output("u").term("X").shape.parameters[0]
    assert again == float(value)
    assert math.copysign(1, again) == math.copysign(1, float(value))


def test_comments_and_blank_lines_are_kept():
    text = (
        "# first\n\n# second\nrulebase t  # behind\ninput e 0 .. 1\noutput u 0 .. 1\n"
        "terms e, u: triangles A B\nrules u\n  # over the header\n  e A B\n  # over the row\n"
        "  u A B  # behind the row\n# last\n"
    )
    formatted = format_text(text)
    for comment in (
        "# first",
        "# second",
        "# behind",
        "# over the header",
        "# over the row",
        "# behind the row",
        "# last",
    ):
        assert comment in formatted
    assert format_text(formatted) == formatted


def test_every_mistake_is_reported_in_one_run_and_in_order():
    text = HEAD + (
        "rule if e is NN then u is N\n"
        "rule if e iss N then u is N\n"
        "imput x 0 .. 1\n"
        "rule if ee is N then u is N with 3\n"
        "term u Q: trapezoid 3 1 2 4\n"
        "inference and mim\n"
    )
    found = [(d.name, d.line, d.column) for d in parse(text, "f.frb").diagnostics]
    assert found == [
        ("unknown-term", 6, 14),
        ("unexpected-token", 7, 11),
        ("unknown-statement", 8, 1),
        ("unknown-variable", 9, 9),
        ("bad-weight", 9, 34),
        ("bad-shape", 10, 23),
        ("unknown-choice", 11, 15),
    ]


@pytest.mark.parametrize(
    ("line", "name", "hint"),
    [
        ("rule if e is n then u is N", "unknown-term", "did you mean 'N'?"),
        ("rule if E is N then u is N", "unknown-variable", "did you mean 'e'?"),
        ("rule if e is vary N then u is N", "unknown-hedge", "did you mean 'very'?"),
        ("term u X: triangel 0 1 2", "unknown-shape", "did you mean 'triangle'?"),
        ("inference defuzzifier centriod", "unknown-defuzzifier", "did you mean 'centroid'?"),
        ("inference agregation max", "unknown-setting", "did you mean 'aggregation'?"),
        ("outptu v 0 .. 1", "unknown-statement", "did you mean 'output'?"),
        ("rules u\n  e \\ ce N Z P\n  N N Z\n", "wrong-cell-count", "written as a dot"),
        ("rule if e is N then e is N", "not-an-output", ""),
        ("expect e = 1 -> u = 0", "incomplete-expectation", ""),
        ("expect e = 1, ce = 0 -> e = 0", "not-an-output", ""),
        ("input e 0 .. 1", "duplicate-variable", ""),
        ("term e N: triangle 0 1 2\nterm e N: triangle 0 1 3", "duplicate-term", ""),
        ("terms e: triangles N Z P", "duplicate-term", ""),
        ("input x 1 .. 0", "bad-range", ""),
        ("input x -1e308 .. 1e308", "bad-range", ""),
        ("input x 0 .. 1e-320", "bad-range", ""),
        ("term u X: triangle -1e308 0 1", "bad-shape", ""),
        ("term u X: gaussian 0 1e-300", "bad-shape", ""),
        ("term u X: spike 0 -1e-300", "bad-shape", ""),
        ("input x 0 1", "unexpected-token", ""),
        ("input 3x 0 .. 1", "bad-number", "single quotes"),
        ('input x 0 .. 1 "open', "unterminated-string", ""),
        ("input x 0 .. 1 @", "unexpected-character", ""),
        ("input x 0 .. 1 2", "trailing-text", ""),
        ("input if 0 .. 1", "reserved-word", "'if'"),
        ("input very 0 .. 1", "reserved-word", "'very'"),
        ("term u X: triangle 1 2", "wrong-parameter-count", ""),
        ("term u X: gaussian 1 0", "bad-shape", ""),
        ('term u X: formula "1 +"', "bad-formula", ""),
        ('term u X: formula "q + 1"', "unknown-variable", ""),
        ("term e X: linear 1", "not-a-fuzzy-set", ""),
        ("terms e: singletons A B", "singleton-input", ""),
        ("inference e: aggregation max", "misplaced-setting", ""),
        ("inference u: and min", "misplaced-setting", ""),
        ("inference defuzzifier centroid(1)", "bad-resolution", ""),
        ("inference and min, and min", "duplicate-setting", ""),
        ("inference threshold 1", "bad-threshold", ""),
        ("rules u", "missing-header", "header"),
        ("rules u\n  e \\ e N\n  N N", "same-variable", ""),
        ("rules u\n  e \\ ce N N\n  N N N", "repeated-column", ""),
        ("rules u\n  e \\ ce N\n  N N\n  N N", "repeated-row", ""),
        ("rules u\n  e N Z\n  v N Z", "bad-row-label", ""),
        ("rule if u is N then u is N", "cyclic-blocks", ""),
        ("block b\nblock b", "duplicate-block", ""),
        ("lookup\n  levels 0 .. 1 step 0.3", "bad-levels", ""),
        ("lookup\n  levels 0 .. 1 count 1", "bad-levels", ""),
        ("lookup\n  levels 0 .. 1 count 2.5", "bad-levels", ""),
        ("lookup\n  bins 1 2", "missing-levels", ""),
        ("lookup\n  levels 0 1 2\n  bins 1", "bad-bins", ""),
        ("lookup\n  round 0\n  levels 0 1", "bad-round", ""),
        ("lookup\n  round e: 0.1\n  levels 0 1", "unexpected-token", ""),
        ("lookup\n  levels -7 .. 7 step 1", "levels-outside-range", ""),
        ("tune\n  peaks q", "unknown-variable", ""),
        ("tune\n  peaks e mirored", "unknown-setting", "mirrored"),
        ("tune\n  peaks e gap 60 %", "bad-range", ""),
        ("tune\n  peaks e gap 6", "incomplete-statement", ""),
        ("tune\n  peaks e\n  peaks e, ce", "duplicate-setting", ""),
        ("tune\n  gain G 3 .. 1", "bad-range", ""),
        ("tune\n  gain G 0 .. 1 log", "bad-range", ""),
        ("tune\n  gain G 0 .. 1, axis", "unexpected-token", ""),
        ("tune\n  keep e XX", "unknown-term", ""),
        ("tune\n  peak e", "unknown-setting", "peaks"),
        ("tune\ntune", "duplicate-statement", ""),
        ("rulebase again", "duplicate-statement", ""),
        (f"rule if {'(' * 60}e is N{')' * 60} then u is N", "too-deep", ""),
        ("term u X: singleton 1e999", "bad-number", ""),
        ("rulebase 'a\\qb'", "bad-escape", ""),
    ],
)
def test_a_mistake_has_its_name_its_line_and_its_hint(line, name, hint):
    parsed = parse(HEAD + "rule if e is N then u is N\n" + line)
    found = [d for d in parsed.diagnostics if d.name == name]
    assert found, parsed.diagnostics
    assert found[0].line >= 7
    assert hint in found[0].hint


def test_a_misspelt_term_is_never_taken_for_another():
    parsed = parse(HEAD + "rule if e is NB then u is P")
    assert parsed.rulebase is None
    assert parsed.partial.rules == ()


def test_a_mistake_in_a_declaration_is_not_repeated_at_each_use():
    text = (
        "rulebase t\ninput e -6  6\noutput u -6 .. 6\nterms e: triangels N P\n"
        "term u X: triangle 3 2 1\nrule if e is N then u is X\n"
    )
    assert names_of(text) == ["unexpected-token", "unknown-shape", "bad-shape"]


def test_the_caret_stands_under_the_whole_span():
    text = HEAD + "rule if größe is N then u is N\n"
    (found,) = parse(text, "x.frb").diagnostics
    lines = render_all([found], text).splitlines()
    assert lines[0].startswith("x.frb:6:9: error[unknown-variable]: ")
    assert lines[1] == "     6 | rule if größe is N then u is N"
    assert lines[2] == "       |         ^^^^^"


def test_carets_under_wide_characters_and_tabs():
    text = HEAD + "rule if\t誤差 is N then u is N\n"
    (found,) = parse(text).diagnostics
    _, source, caret, *_ = render_all([found], text).splitlines()
    assert source.index("誤") == caret.index("^")
    assert caret.count("^") == 4


def test_several_findings_are_rendered_one_below_the_other():
    text = HEAD + "rule if e is X then u is Y\n"
    assert render_all(parse(text).diagnostics, text).count("\n       |") == 2


@pytest.mark.slow
def test_absurd_input_is_refused_with_a_reason():
    assert names_of("x" * (MAX_CHARACTERS + 1)) == ["file-too-large"]
    assert names_of(HEAD + "# " + "x" * MAX_LINE) == ["line-too-long"]
    many = "".join(f"input i{k} 0 .. 1\n" for k in range(40))
    assert (
        names_of("rulebase t\n" + many + "output u 0 .. 1\nrule if i0 is A then u is A").count(
            "too-many-variables"
        )
        == 1
    )
    terms = "".join(f"term e T{k}: triangle 0 0.5 1\n" for k in range(MAX_TERMS + 1))
    assert "too-many-terms" in names_of(
        f"rulebase t\ninput e 0 .. 1\noutput u 0 .. 1\n"
        f"{terms}terms u: triangles A B\n"
        "rule if e is T0 then u is A"
    )
    flood = parse(HEAD + "@\n" * (2 * MAX_DIAGNOSTICS))
    assert len(flood.diagnostics) == MAX_DIAGNOSTICS + 1
    assert flood.diagnostics[-1].name == "too-many-mistakes"


def test_loading_carries_all_diagnostics(tmp_path):
    path = tmp_path / "bad.frb"
    path.write_text(HEAD + "rule if e is X then u is Y\n")
    with pytest.raises(RuleBaseError) as caught:
        load_rulebase(path)
    assert [d.name for d in caught.value.diagnostics] == ["unknown-term", "unknown-term"]
    assert all(d.path == str(path) for d in caught.value.diagnostics)
    assert isinstance(caught.value, ValueError)


def test_bytes_that_are_no_text_are_located(tmp_path):
    path = tmp_path / "binary.frb"
    path.write_bytes(b"rulebase t\ninput \xff")
    with pytest.raises(RuleBaseError) as caught:
        load_rulebase(path)
    (found,) = caught.value.diagnostics
    assert (found.name, found.line, found.column) == ("not-utf-8", 2, 7)


def test_a_byte_order_mark_is_no_mistake(tmp_path):
    path = tmp_path / "bom.frb"
    path.write_bytes(b"\xef\xbb\xbf" + (HEAD + "rule if e is N then u is N\n").encode())
    assert load_rulebase(path).name == "t"


def test_windows_line_ends_mean_the_same():
    text = HEAD + "rules u\n  e \\ ce N Z P\n  N N N Z\n"
    assert parse(text.replace("\n", "\r\n")).rulebase == parse(text).rulebase


@pytest.mark.parametrize(
    "word", ["power", "levels", "step", "in", "exact", "input", "round", "error"]
)
def test_words_that_their_place_tells_apart_are_names(word):
    text = (
        f"rulebase {word}\ninput {word} 0 .. 1\noutput u 0 .. 1\nterms {word}: triangles A B\n"
        f"term u {word}: triangle 0 0.5 1\nrule if {word} is A then u is {word}\n"
        f"rule if {word} is not B then u is {word}\nexpect {word} = 0 -> u = 0.5\n"
    )
    parsed = parse(text)
    assert parsed.diagnostics == ()
    assert parse(format_text(text)).rulebase == parsed.rulebase


def test_a_formula_may_use_constants_but_no_unknown_names():
    text = HEAD + 'term u F: formula "sin(pi * e) + ce"\nrule if e is N then u is F\n'
    assert parse(text).diagnostics == ()


def test_a_threshold_belongs_to_the_rules_of_a_file_or_a_block():
    text = (
        HEAD + "inference threshold 0.1\nrule if e is N then u is N\n"
        "block more: threshold 0.25, and product\nrule if e is P then u is P\n"
        "block none: threshold 0\nrule if e is Z then u is Z\n"
    )
    rulebase = parse(text).rulebase
    assert [block.threshold for block in rulebase.blocks] == [0.1, 0.25, 0.0]
    assert parse(write(rulebase)).rulebase == rulebase


@pytest.mark.parametrize("first", [True, False])
def test_a_term_of_its_own_replaces_one_of_a_family(first):
    family, own = "terms e: triangles A B C\n", "term e B: triangle 0 1 2\n"
    text = (
        "rulebase t\ninput e -6 .. 6\noutput u -6 .. 6\n"
        + (own + family if first else family + own)
        + "term u X: singleton 1\nrule if e is B then u is X\n"
    )
    rulebase = parse(text).rulebase
    assert rulebase.inputs[0].term("B").shape.parameters == (0, 1, 2)
    assert rulebase.inputs[0].term("C").shape.parameters == (0, 6, 12)
    assert {term.name for term in rulebase.inputs[0].terms} == set("ABC")
    assert parse(format_text(text)).rulebase == rulebase
    assert parse(write(rulebase)).rulebase == rulebase


@pytest.mark.parametrize(
    "apart", ["1.52 .5", ".5 .5", "1 -2", "1e1 .5", "1e1 -2", "1 +2", "0.5 .25"]
)
def test_adjacent_numbers_need_a_space(apart):
    text = "rulebase r\ninput e 0 .. 5\noutput u 0 .. 1\nterms u: triangles A B\n"
    text += "term e N: ramp {}\nrule if e is N then u is A\n"
    found = parse(text.format(apart.replace(" ", ""))).diagnostics
    assert [(d.name, d.line) for d in found if d.is_error] == [("bad-number", 5)]
    found = parse(text.format(apart)).diagnostics
    if ".5 .5" not in apart:  # which is a ramp from a number to itself
        assert not [d for d in found if d.is_error]
