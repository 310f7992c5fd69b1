"""The reference page of the language says nothing that the parser does not do."""

import re
from pathlib import Path

import pytest

from fuzzyarm.base.diagnostic import MAX_INPUTS, MAX_TERMS
from fuzzyarm.language import format_text, parse, write
from fuzzyarm.language.model.shapes import EVEN_SHAPES
from fuzzyarm.language.phrases import SETTINGS
from fuzzyarm.language.statements import STATEMENTS
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SHAPES, SNORMS, TNORMS

PATH = Path(__file__).parents[2] / "docs" / "reference" / "language.md"
PAGE = PATH.read_text()
BLOCKS = re.findall(r"```frb ?(\w*)\n(.*?)```", PAGE, re.DOTALL)
PREAMBLE = next(text for kind, text in BLOCKS if kind == "preamble")
A_RULE = "rule if e is ZE then u is ZE\n"


def whole_text(kind, text):
    if kind == "":
        return text
    extra = "" if re.search(r"^rules? ", text, re.MULTILINE) else A_RULE
    return PREAMBLE + (text if kind == "fragment" else "") + extra


@pytest.mark.parametrize(("kind", "text"), BLOCKS)
def test_every_example_is_parsed_and_survives_formatting(kind, text):
    whole = whole_text(kind, text)
    parsed = parse(whole)
    assert parsed.diagnostics == ()
    formatted = format_text(whole)
    assert parse(formatted).rulebase == parsed.rulebase
    assert format_text(formatted) == formatted
    assert parse(write(parsed.rulebase)).rulebase == parsed.rulebase


def test_there_are_examples_of_every_kind():
    assert {kind for kind, _ in BLOCKS} == {"", "preamble", "fragment"}
    assert len(BLOCKS) >= 9


def test_every_word_of_the_language_is_on_the_page():
    words = [*STATEMENTS, *SHAPES, *EVEN_SHAPES, *HEDGES.words, *DEFUZZIFIERS, *SNORMS]
    assert [word for word in words if not re.search(rf"\b{re.escape(word)}\b", PAGE)] == []


def test_the_stated_limits_are_the_real_ones():
    assert f"{MAX_INPUTS} inputs" in PAGE
    assert f"{MAX_TERMS:,} terms" in PAGE


# ── tables that follow from the records ──────────────────────────────────────────────────


def rows_of_shapes():
    for kind in SHAPES.values():
        if kind.fuzzy:
            numbers = "(x, y) …" if kind.name == "points" else " ".join(kind.parameters)
            yield f"`{kind.name}`", numbers, kind.doc


def rows_of_hedges():
    for kind in HEDGES.values():
        numbers = f"({', '.join(kind.parameters)})" if kind.parameters else ""
        yield ", ".join(f"`{word}{numbers}`" for word in (kind.name, *kind.aliases)), kind.doc


def rows_of_norms(norms):
    for kind in norms.values():
        yield f"`{kind.name}`", kind.doc, f"`{kind.dual}`" if kind.dual else ""


def rows_of_defuzzifiers():
    for kind in DEFUZZIFIERS.values():
        sampled = "" if kind.weighs else "N" if not kind.joins else "N, joined"
        takes = "values" if kind.weighs else "intervals" if kind.type2 else "sets, values"
        yield f"`{kind.name}`", kind.doc, "monotonic sets" if kind.inverts else takes, sampled


TABLES = {
    "| statement |": lambda: (
        (f"`{f'{r.word} {r.syntax}'.strip()}`", r.doc) for r in STATEMENTS.values()
    ),
    "| family |": lambda: ((f"`{name}`", doc) for name, doc in EVEN_SHAPES.items()),
    "| shape |": rows_of_shapes,
    "| hedge |": rows_of_hedges,
    "| T-norm |": lambda: rows_of_norms(TNORMS),
    "| S-norm |": lambda: rows_of_norms(SNORMS),
    "| defuzzifier |": rows_of_defuzzifiers,
}


@pytest.mark.parametrize("head", TABLES)
def test_tables_of_kinds_are_those_of_the_records(head, update_golden):
    page = PATH.read_text()
    (table,) = re.findall(rf"^{re.escape(head)}.*\n\|---.*\n((?:\|.*\n)*)", page, re.MULTILINE)
    lines = [" | ".join(cell.replace("|", "\\|") for cell in row) for row in TABLES[head]()]
    expected = "".join(f"| {line} |\n" for line in lines)
    if update_golden:
        before, after = re.split(rf"(?<=\n){re.escape(head)}", page)
        rule = after.index("\n", after.index("\n|---") + 1) + 1
        PATH.write_text(before + head + after[:rule] + expected + after[rule + len(table) :])
        return
    assert table == expected


def words_of(names):
    return " ".join(f"`{name}`" for name in names)


def values_of_defuzzifiers():
    of_intervals = [name for name, kind in DEFUZZIFIERS.items() if kind.type2]
    of_sets = [name for name in DEFUZZIFIERS if name not in of_intervals]
    return f"{words_of(of_sets)}; for interval type-2 terms {words_of(of_intervals)}"


LISTED = {
    "and": lambda: words_of(SETTINGS["and"].values),
    "or": lambda: words_of(SETTINGS["or"].values),
    "defuzzifier": values_of_defuzzifiers,
}
"""Settings with a name of a record, and their values as the page lists them."""


@pytest.mark.parametrize("key", LISTED)
def test_values_of_a_setting_are_those_of_the_records(key, update_golden):
    page = PATH.read_text()
    row = re.search(rf"^\| `{key}` \| (.*) \| \w+ \|$", page, re.MULTILINE)
    if update_golden:
        PATH.write_text(page[: row.start(1)] + LISTED[key]() + page[row.end(1) :])
        return
    assert row[1] == LISTED[key]()


def test_settings_of_the_page_are_those_of_the_records():
    rows = re.findall(r"^\| `([\w-]+)` \| (.*) \| (\w+[\w ]*) \|$", PAGE, re.MULTILINE)
    stated = {key: (values, of) for key, values, of in rows if key in SETTINGS}
    assert list(stated) == ["and", "or", "implication", "threshold", "aggregation",
                            "defuzzifier", "no-rule", "outside"]  # fmt: skip
    assert set(stated) == set(SETTINGS)
    for key in ("no-rule", "outside"):
        assert re.findall(r"`([a-z-]+)`", stated[key][0])[: len(SETTINGS[key].values)] == list(
            SETTINGS[key].values
        )
    for key, (_, of) in stated.items():
        assert SETTINGS[key].of in (of, of.replace("inputs and outputs", "variables"))
