"""The reference page of the language says nothing that the parser does not do."""

import re
from pathlib import Path

import pytest

from fuzzyarm.expression.kinds import SHAPES, SNORMS
from fuzzyarm.language import format_text, parse, write
from fuzzyarm.language.tokens import HEDGE_WORDS, STATEMENTS
from fuzzyarm.model.rulebase import DEFUZZIFIERS
from fuzzyarm.model.shapes import EVEN_SHAPES
from fuzzyarm.text.diagnostic import MAX_INPUTS, MAX_TERMS

PAGE = (Path(__file__).parents[2] / "docs" / "language.md").read_text()
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


@pytest.mark.parametrize(
    "word",
    [*STATEMENTS, *SHAPES, *EVEN_SHAPES, *HEDGE_WORDS, *DEFUZZIFIERS, *SNORMS],
)
def test_every_word_of_the_language_is_on_the_page(word):
    assert re.search(rf"\b{re.escape(word)}\b", PAGE)


def test_the_stated_limits_are_the_real_ones():
    assert f"{MAX_INPUTS} inputs" in PAGE
    assert f"{MAX_TERMS:,} terms" in PAGE
