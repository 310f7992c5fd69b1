"""What an editor asks of a text: at places marked with | in small files of their own."""

from __future__ import annotations

import random
import re

import pytest
from markdown_it import MarkdownIt

from fuzzyarm.base.names import quote
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.exchange.files import check_text
from fuzzyarm.language import parse
from fuzzyarm.language.edit import (
    Completion,
    NameKind,
    RenameError,
    apply_edits,
    coloured,
    complete,
    fixes,
    folds,
    hover,
    occurrence_at,
    read,
    references,
    rename,
    symbols,
)
from fuzzyarm.language.edit.fixes import Edit
from fuzzyarm.language.rules import GridNode

HEAD = """\
rulebase cart "a cart"
input  x  -1 .. 1  "position, m"
input  v  -2 .. 2
output f  -10 .. 10
terms x, v: triangles LEFT MIDDLE RIGHT
terms f: triangles PULL REST PUSH
term x 'far off': trapezoid 0.5 0.9 1 1
"""
GRID = """\
rules f
  x \\ v   LEFT  MIDDLE  RIGHT
  LEFT    PUSH  PUSH    REST
  MIDDLE  PUSH  REST    PULL
  RIGHT   REST  PULL    PULL
rule if x is 'far off' and v is not LEFT then f is PULL with 0.5
"""


def _at(text: str) -> tuple[str, int, int]:
    """Cut the mark | out of a text and return its line and column."""
    before, mark, after = text.partition("|")
    assert mark
    return before + after, before.count("\n") + 1, len(before) - before.rfind("\n")


def _offered(text: str) -> list[Completion]:
    whole, line, column = _at(text)
    return complete(read(whole), line, column)


def _labels(text: str) -> list[str]:
    return [candidate.label for candidate in _offered(text)]


# ── completion ───────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("rule if x is |", ["LEFT", "MIDDLE", "RIGHT", "far off"]),
        ("rule if x is LEFT and v is |", ["LEFT", "MIDDLE", "RIGHT"]),
        ("rule if x is very |", ["LEFT", "MIDDLE", "RIGHT", "far off"]),
        ("rule if x is power(2) |", ["LEFT", "MIDDLE", "RIGHT", "far off"]),
        ("rule if x is LEFT then f is |", ["PULL", "REST", "PUSH"]),
        ("rul if x is LEFT then f is |", ["PULL", "REST", "PUSH"]),
        ("rule if (x is LEFT or nonsense ) then f is |", ["PULL", "REST", "PUSH"]),
        ("rules f when v is |", ["LEFT", "MIDDLE", "RIGHT"]),
    ],
)
def test_exactly_the_terms_of_the_variable_in_question(line: str, expected: list[str]) -> None:
    offered = [c.label for c in _offered(HEAD + line) if c.kind == "term"]
    assert offered == expected


@pytest.mark.parametrize(
    ("line", "label"),
    [
        ("|", "rulebase"),
        ("ru|", "rules"),
        ("rule |", "if"),
        ("rule if |", "x"),
        ("rule if x |", "is"),
        ("rule if x is LEFT |", "then"),
        ("rule if x is LEFT then |", "f"),
        ("rule if x is LEFT then f is REST |", "with"),
        ("rules |", "f"),
        ("rules f |", "when"),
        ("terms |", "x"),
        ("terms x, |", "v"),
        ("terms x: |", "triangles"),
        ("term |", "x"),
        ("term x HIGH |", ":"),
        ("term x HIGH: |", "two-sided-gaussian"),
        ("term x HIGH: triangle 0 1 1 |", "height"),
        ("term f HIGH: linear 2*|", "v"),
        ("inference |", "defuzzifier"),
        ("inference f: |", "no-rule"),
        ("inference f: no-|", "no-rule"),
        ("inference and |", "hamacher"),
        ("inference and min, |", "aggregation"),
        ("inference defuzzifier |", "centroid"),
        ("inference defuzzifier centroid |", "exact"),
        ("inference defuzzifier centroid(5, |", "midpoints"),
        ("block second: |", "implication"),
        ("expect |", "x"),
        ("expect x = 0, |", "v"),
        ("expect x = 0, v = 0 |", "->"),
        ("expect x = 0, v = 0 -> |", "f"),
        ("expect x = 0, v = 0 -> f |", "in"),
        ("expect x = 0, v = 0 -> f = 1 |", "within"),
        ("lookup\n  |", "levels"),
        ("lookup\n  levels |", "x"),
        ("lookup\n  levels -1 .. 1 |", "count"),
        ("lookup\n  bins 0.1 0.2 |", "mirrored"),
        ("tune\n  |", "peaks"),
        ("tune\n  peaks |", "x"),
        ("tune\n  peaks x |", "mirrored"),
        ("tune\n  peaks x mirrored, |", "partition"),
        ("tune\n  gain G 0.1 .. 3 |", "times"),
        ("tune\n  keep x |", "LEFT"),
        ("rules f  # allow |", "jump"),
        ("input y |", "range"),
    ],
)
def test_what_can_stand_at_a_place_is_offered(line: str, label: str) -> None:
    assert label in _labels(HEAD + line)


def test_a_name_that_is_used_up_is_not_offered_again() -> None:
    assert "x" not in _labels(HEAD + "expect x = 0, |")
    assert "and" not in _labels(HEAD + "inference and min, |")


@pytest.mark.parametrize("line", ['rulebase y "te|', "rule if x is LEFT # not|", "input y 1|"])
def test_nothing_is_offered_in_texts_comments_and_numbers(line: str) -> None:
    assert _labels(HEAD + line) == []


def test_a_quoted_name_is_replaced_with_its_quote() -> None:
    offered = {c.label: c for c in _offered(HEAD + "rule if x is 'fa|")}
    chosen = offered["far off"]
    assert chosen.insert == "'far off'"
    assert chosen.span is not None
    assert chosen.span.column == len("rule if x is ") + 1


def test_shapes_come_with_their_numbers() -> None:
    offered = {c.label: c for c in _offered(HEAD + "term x HIGH: |")}
    assert offered["trapezoid"].snippet == (
        "trapezoid ${1:left} ${2:top_left} ${3:top_right} ${4:right}"
    )


def test_the_header_of_a_grid_is_offered_whole() -> None:
    first = _labels(HEAD + "rules f\n  |")[0]
    assert first == "x \\ v  LEFT  MIDDLE  RIGHT"
    assert _labels(HEAD + "rules f\n  v \\ |") == ["x"]
    assert _labels(HEAD + "rules f\n  x \\ v |")[0] == "LEFT  MIDDLE  RIGHT"


def test_rows_offer_the_labels_that_are_missing_and_the_terms_of_the_output() -> None:
    grid = "rules f\n  x \\ v  LEFT  RIGHT\n  LEFT  PUSH  REST\n  |"
    assert _labels(HEAD + grid) == ["MIDDLE", "RIGHT", "far off"]
    assert _labels(HEAD + grid.replace("|", "MIDDLE |")) == ["PULL", "REST", "PUSH", "."]
    assert _labels(HEAD + grid.replace("|", "MIDDLE REST PULL |")) == []


def test_every_offer_can_be_read() -> None:
    # What completion offers for a proposition and its consequent makes a rule without mistakes.
    for term in _offered(HEAD + "rule if x is |"):
        if term.kind != "term":
            continue
        text = f"{HEAD}rule if x is {term.insert} then f is REST\n"
        assert parse(text).rulebase is not None, term


# ── places ───────────────────────────────────────────────────────────────────────────────


def _places(text: str) -> list[tuple[int, int, bool]]:
    whole, line, column = _at(text)
    reading = read(whole)
    occurrence = occurrence_at(reading, line, column)
    assert occurrence is not None
    return [(o.span.line, o.span.column, o.is_definition) for o in references(reading, occurrence)]


def test_references_of_a_term_are_those_of_its_variable() -> None:
    marked = HEAD + GRID.replace("  LEFT    PUSH", "  LE|FT    PUSH")
    assert _places(marked) == [(5, 23, True), (10, 3, False)]


def test_references_of_an_output_term_are_its_cells_and_rules() -> None:
    marked = HEAD + GRID.replace("with 0.5", "").replace("then f is PULL", "then f is |PULL")
    assert [place[:2] for place in _places(marked)] == [
        (6, 20), (11, 25), (12, 17), (12, 25), (13, 52),
    ]  # fmt: skip


def test_a_variable_is_defined_where_it_is_declared() -> None:
    whole, line, column = _at(HEAD + GRID.replace("  x \\ v", "  x \\ |v"))
    reading = read(whole)
    occurrence = occurrence_at(reading, line, column)
    assert occurrence is not None
    (home,) = [o for o in references(reading, occurrence) if o.is_definition]
    assert (home.span.line, home.span.column) == (3, 8)


def test_a_formula_names_variables() -> None:
    text = HEAD + 'term f SUM: formula "2 * x + v|"\n'
    assert _places(text) == [
        (3, 8, True), (5, 10, False), (8, 30, False),
    ]  # fmt: skip


# ── rename ───────────────────────────────────────────────────────────────────────────────


def _renamed(text: str, name: str) -> str:
    whole, line, column = _at(text)
    return apply_edits(whole, rename(read(whole), line, column, name))


def test_rename_reaches_headers_grids_rules_and_damaged_lines() -> None:
    marked = HEAD + GRID.replace("is PULL", "is P|ULL") + "rule if x is LEFT thn f is PULL\n"
    text = _renamed(marked, "to the left")
    assert "PULL" not in text
    assert text.count("'to the left'") == 6
    assert "rule if x is LEFT thn f is 'to the left'" in text


def test_terms_that_are_declared_together_are_renamed_together() -> None:
    text = _renamed(HEAD.replace(" LEFT", " LE|FT") + GRID, "WEST")
    assert "LEFT" not in text
    assert [d.name for d in parse(text).diagnostics] == []
    before, after = parse(HEAD + GRID).partial, parse(text).partial
    assert [r.consequents for r in before.rules] == [r.consequents for r in after.rules]


def test_a_renamed_variable_leaves_the_file_sound() -> None:
    text = _renamed(HEAD.replace("input  v", "input  v|") + GRID, "'error rate'")
    assert parse(text).rulebase is not None
    assert re.search(r"  x \\ 'error rate' +LEFT", text)


@pytest.mark.parametrize(
    ("name", "message"),
    [("RIGHT", "'v' has a term 'RIGHT' already"), ("  ", "empty"), ("''", "empty")],
)
def test_a_name_that_is_taken_or_empty_is_refused(name: str, message: str) -> None:
    with pytest.raises(RenameError, match=message):
        _renamed(HEAD.replace(" LEFT", " LE|FT"), name)


def test_a_keyword_has_no_other_name() -> None:
    with pytest.raises(RenameError, match="no variable"):
        _renamed("|" + HEAD, "anything")


# ── hover ────────────────────────────────────────────────────────────────────────────────


def _shown(text: str) -> str:
    whole, line, column = _at(text)
    found = hover(read(whole), line, column)
    return "" if found is None else found.markdown


def test_a_term_shows_its_shape_and_a_drawing() -> None:
    shown = _shown(HEAD.replace(" LEFT", " LE|FT"))
    assert "`LEFT` of `x`: `triangle -2 -1 0`" in shown
    assert "`LEFT` of `v`: `triangle -4 -2 0`" in shown
    assert "█" in shown


def test_a_word_means_what_it_means_at_its_place() -> None:
    assert "gains of the controller" in _shown(f"{HEAD}tune ga|in 0.5 .. 2\n")
    assert "gains of the controller" not in _shown("controller c\nga|in K = 1\n")


def test_the_drawing_is_highest_at_the_peak() -> None:
    shown = _shown(HEAD.replace("MIDDLE RIGHT", "MID|DLE RIGHT"))
    top = shown.split("```text\n")[1].splitlines()[0]
    assert len(top.rstrip()) - len(top.rstrip().lstrip()) <= 15
    assert top[20] == "█"
    assert top[:10].strip() == ""


def test_a_cell_shows_its_rule_in_words() -> None:
    shown = _shown(HEAD + GRID.replace("PUSH    REST", "PU|SH    REST"))
    assert shown.startswith("**if x is LEFT and v is MIDDLE then f is PUSH**")
    dot = _shown(HEAD + GRID.replace("PUSH    REST", "|.    REST"))
    assert dot == "no rule for x is LEFT and v is MIDDLE"


HOSTILE = [
    "![x](http://evil/x.png)", "<script>alert(1)</script>", "<img src=x onerror=y>", "**b**", "`c`",
    "[l](command:evil)", "```\n<b>", "https://evil.example/x", "$$x$$", "&lt;b&gt;", "\\", "_i_",
    "<http://evil>", "a | b", "# h", "\x1b[31m", "``", "a`b``c",
]  # fmt: skip


MARKUP = {
    "html_inline",
    "html_block",
    "image",
    "link_open",
    "table_open",
    "heading_open",
    "em_open",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hover_shows_names_and_descriptions_as_they_are(name: str) -> None:
    markdown = MarkdownIt("gfm-like", {"linkify": False, "html": True})
    x, text = quote(name, "'"), quote(name, '"')
    source = (
        f"rulebase {x} {text}\ninput {x} 0 .. 1 {text}\noutput y 0 .. 1 {text}\n"
        f"term {x} {x}: triangle 0 0.5 0.7\nterm y {x}: formula {text}\n"
        f'term y F: formula "{x} + 1"\nterms y: triangles A B\nblock {x}\n'
        f"rules y\n  {x} {x}\n  y A\nrule if {x} is {x} then y is B\n"
    )
    reading = read(source)
    shown = [
        found.markdown
        for line, words in enumerate(source.splitlines(), start=1)
        for column in range(1, len(words) + 2)
        if (found := hover(reading, line, column)) is not None
    ]
    assert len(shown) > 20
    for text in set(shown):
        parts = markdown.parse(text)
        kinds = {leaf.type for part in parts for leaf in (part, *(part.children or ()))}
        assert not kinds & MARKUP, text
        assert text.replace("\n", "").isprintable()


def test_a_variable_shows_range_and_coverage() -> None:
    assert "every value is covered" in _shown(HEAD.replace("input  v", "input  |v"))
    gap = HEAD + "input y 0 .. 4\nterm y LOW: triangle 0 1 2\nexpect y| = 1"
    assert "`0 .. 4`" in _shown(gap)
    assert "no term of 'y' covers 2 .. 4" in _shown(gap)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("te|rms x: triangles A B", "evenly spaced"),
        ("term x A: trap|ezoid 0 1 2 3", "top_left"),
        ("inference defuzzifier centroid", ""),
        ("rule if x is so|mewhat LEFT then f is REST", "√d"),
        ("inference no-r|ule 0", "no rule fires"),
        ("block seco|nd: and product\nrule if x is LEFT then f is REST", "1 rules"),
        ("rulebase c|art", "inputs"),
    ],
)
def test_words_of_the_language_are_explained(text: str, word: str) -> None:
    if word:
        assert word in _shown(HEAD + text)


# ── fixes ────────────────────────────────────────────────────────────────────────────────


def _mended(text: str, name: str) -> str:
    review = check_text(text)
    finding = next(d for d in review.diagnostics if d.name == name)
    nodes = [s.node for s in parse(text).document.statements]
    best = fixes(finding, text, [n for n in nodes if isinstance(n, GridNode)])[0]
    return apply_edits(text, best.edits)


def test_a_misspelt_term_is_changed_to_the_nearest() -> None:
    text = HEAD + GRID.replace("with 0.5", "").replace("LEFT then f is PULL", "LEFT then f is PUL")
    assert "then f is PULL" in _mended(text, "unknown-term")


def test_a_missing_cell_is_added_as_a_dot() -> None:
    text = HEAD + GRID.replace("REST  PULL    PULL", "REST  PULL  # two")
    mended = _mended(text, "wrong-cell-count")
    assert "RIGHT   REST  PULL  .  # two" in mended
    assert not any(d.name == "wrong-cell-count" for d in parse(mended).diagnostics)


def test_a_cell_too_much_is_removed() -> None:
    text = HEAD + GRID.replace("REST  PULL    PULL", "REST  PULL    PULL REST")
    assert not parse(_mended(text, "wrong-cell-count")).diagnostics


def test_a_missing_row_is_added() -> None:
    text = HEAD + GRID.replace("  MIDDLE  PUSH  REST    PULL\n", "").partition("rule if")[0]
    mended = _mended(text, "missing-rule")
    assert "  MIDDLE  .  .  ." in mended


def test_a_duplicate_rule_is_removed_and_a_doubt_can_be_allowed() -> None:
    rule = "rule if x is LEFT then f is PUSH\n"
    assert _mended(HEAD + rule + rule, "duplicate-rule") == HEAD + rule
    text = HEAD + GRID.replace("RIGHT   REST", "RIGHT   PULL")
    nodes = [s.node for s in parse(text).document.statements]
    for finding in check_text(text).diagnostics:
        repairs = fixes(finding, text, [n for n in nodes if isinstance(n, GridNode)])
        allow = [fix for fix in repairs if not fix.preferred]
        assert allow, finding
        quiet = check_text(apply_edits(text, allow[0].edits)).diagnostics
        assert (finding.name, finding.line) not in {(d.name, d.line) for d in quiet}


def test_edits_keep_the_ends_of_other_lines() -> None:
    text = "a\r\nb\rc\n"
    from fuzzyarm.base.diagnostic import Span

    assert apply_edits(text, [Edit(Span(3, 1, 3, 2), "C"), Edit(Span(1, 1, 1, 2), "A")]) == (
        "A\r\nb\rC\n"
    )


# ── outline, folding, colours ────────────────────────────────────────────────────────────


@pytest.mark.parametrize("name", ["pd7.frb", "servo.frb"])
def test_a_part_of_the_outline_is_selected_by_its_name(name: str) -> None:
    reading = read(shipped(name).read_text("utf-8"))
    named = [symbol for symbol in symbols(reading) if " " not in symbol.name]
    assert len(named) >= 4
    for symbol in named:
        span = symbol.selection
        assert span.line == span.end_line
        assert reading.raw_line(span.line)[span.column - 1 : span.end_column - 1] == symbol.name


def test_the_outline_has_every_part() -> None:
    found = [(s.kind, s.name) for s in symbols(read(HEAD + GRID))]
    assert found[:4] == [("rulebase", "cart"), ("input", "x"), ("input", "v"), ("output", "f")]
    assert ("grid", "rules f") in found
    variable = symbols(read(HEAD))[1]
    assert [child.name for child in variable.children] == ["LEFT", "MIDDLE", "RIGHT", "far off"]


def test_grids_blocks_and_comments_fold() -> None:
    text = "# one\n# two\n" + HEAD + GRID + "block b\nrule if x is LEFT\n  then f is REST\n"
    found = [(fold.first, fold.last, fold.is_comment) for fold in folds(read(text))]
    assert found == [(1, 2, True), (10, 14, False), (16, 18, False), (17, 18, False)]


def test_words_are_coloured_by_what_they_are() -> None:
    text = HEAD + "rule if x is very LEFT then f is PULL  # why\n"
    last = [(c.colour, text.splitlines()[c.line - 1][c.column - 1 : c.end - 1])
            for c in coloured(read(text)) if c.line == 8]  # fmt: skip
    assert last == [
        ("keyword", "rule"), ("keyword", "if"), ("variable", "x"), ("keyword", "is"),
        ("modifier", "very"), ("enumMember", "LEFT"), ("keyword", "then"), ("variable", "f"),
        ("keyword", "is"), ("enumMember", "PULL"), ("comment", "# why"),
    ]  # fmt: skip


# ── damage ───────────────────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_no_damage_stops_a_question() -> None:
    chance = random.Random(6)
    pieces = ["", "'", '"', "\n", " ", "|", "\\", "#", ".", "(", "rule ", "θ", "\t", "is "]
    text = HEAD + GRID
    for _ in range(150):
        start = chance.randrange(len(text) + 1)
        text = text[:start] + chance.choice(pieces) + text[start + chance.randrange(3) :]
        reading = read(text)
        line = chance.randrange(len(reading.lines) + 1) + 1
        column = chance.randrange(len(reading.raw_line(line)) + 1) + 1
        for candidate in complete(reading, line, column):
            assert candidate.span is not None
            assert candidate.span.line == line
        hover(reading, line, column)
        occurrence = occurrence_at(reading, line, column)
        if occurrence is not None:
            assert occurrence in references(reading, occurrence)
        for symbol in symbols(reading):
            start_end = (symbol.span.end_line, symbol.span.end_column)
            assert (symbol.selection.end_line, symbol.selection.end_column) <= start_end
        folds(reading)
        places = [(c.line, c.column) for c in coloured(reading)]
        assert places == sorted(places)
        for finding in check_text(text).diagnostics:
            fixes(finding, text, [])


CONTROLLER = """controller c "of one shaft"
use pd from "pd7.frb"
period 1 ms
gain G_e = 2 "1/rad"
axis shaft
  e = error of position * G_e
  ce = rate of e
  u = rules pd(e, ce)
  drive voltage = u * G_e
"""


PORTS = {
    (NameKind.PORT, name): f"{name} of a motor" for name in ("position", "voltage", "torque")
} | {(NameKind.SIGNAL, "u"): "reaches -6 .. 6"}


@pytest.mark.parametrize(
    ("line", "text", "wanted"),
    [
        (6, "  e = ", {"error", "integral", "rules", "G_e"}),
        (6, "  e = error of ", {"position"}),
        (6, "  e = error of position * ", {"G_e"}),
        (8, "  u = rules ", {"pd"}),
        (8, "  u = rules pd(", {"e", "ce", "G_e"}),
        (3, "period 1 ", {"ms", "s", "h"}),
        (9, "  drive ", {"voltage", "torque"}),
        (9, "  drive voltage = ", {"u", "e", "G_e"}),
        (10, "  ", {"zoom", "learn", "drive"}),
        (10, "", {"use", "gain", "axis"}),
        (7, "  ce = rate of e, filter 3 ", {"ms", "min"}),
    ],
)
def test_a_controller_is_completed(line, text, wanted):
    lines = CONTROLLER.split("\n")
    lines[line - 1] = text
    reading = read("\n".join(lines))
    found = complete(reading, line, len(text) + 1, PORTS)
    offered = {candidate.label for candidate in found}
    assert wanted <= offered
    assert not offered & {"rulebase NAME", "terms", "e \\ ce"}


def test_a_controller_is_explained_renamed_and_outlined():
    reading = read(CONTROLLER)
    assert "gain" in hover(reading, 6, 27).markdown
    assert hover(reading, 9, 19).markdown.startswith("`u = rules pd(e, ce)`")
    assert "used 1 time" in hover(reading, 9, 19).markdown
    assert "port" in hover(reading, 9, 10).markdown
    assert "of a motor" in hover(reading, 9, 10, PORTS).markdown
    assert "reaches" not in hover(reading, 9, 19).markdown
    assert hover(reading, 9, 19, PORTS).markdown.endswith("reaches -6 .. 6")
    assert "how often" in hover(reading, 3, 2).markdown
    edits = rename(reading, 7, 3, "rate_of_e")
    assert [(edit.span.line, edit.text) for edit in edits] == [(7, "rate_of_e"), (8, "rate_of_e")]
    names = [(symbol.kind, symbol.name) for symbol in symbols(reading)]
    assert ("controller", "c") in names
    assert ("gain", "G_e") in names
    assert ("axis", "shaft") in names
    colours = {(c.line, c.column): c.colour for c in coloured(reading)}
    assert colours[(1, 1)] == "keyword"
    assert colours[(6, 3)] == "variable"
    assert colours[(9, 9)] == "property"
