"""A text read with a memory of its earlier versions is read as if for the first time."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from budget import cases

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.language import parse
from fuzzyarm.language.document import ParseMemory
from fuzzyarm.language.reading import parse_once
from fuzzyarm.symbolic import kinds
from fuzzyarm.symbolic.kinds import SHAPES

SHIPPED = sorted((Path(__file__).parents[2] / "rulebases").glob("*.frb"))
PIECES = (
    "",
    "x",
    "\n",
    "  ",
    "NB",
    "rule if ",
    " # note",
    "'",
    '"',
    ".",
    "\n\n  PB",
    "terms ",
    "θ",
)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda p: p.stem)
def test_edits_are_read_as_a_fresh_text(path: Path) -> None:
    chance = random.Random(path.stem)
    text = path.read_text(encoding="utf-8")
    memory = ParseMemory()
    for _ in range(cases(10, 40)):
        assert parse(text, memory=memory) == parse(text)
        start = chance.randrange(len(text) + 1)
        end = min(len(text), start + chance.choice((0, 0, 1, 3, 30)))
        text = text[:start] + chance.choice(PIECES) + text[end:]


def test_the_places_of_moved_lines_are_new() -> None:
    text = "rulebase a\ninput x 0 .. 1\noutput y 0 .. 1\nrule if x is A then y is B\n"
    memory = ParseMemory()
    parse(text, memory=memory)
    moved = parse("\n# above\n" + text, memory=memory)
    assert [d.span for d in moved.diagnostics] == [
        d.span for d in parse("\n# above\n" + text).diagnostics
    ]
    assert moved.diagnostics[0].line == 6


def test_a_hint_for_a_quoted_name_is_quoted() -> None:
    text = (
        "rulebase a\ninput x 0 .. 1\noutput y 0 .. 1\nterms y: singletons A B\n"
        "term x 'very low': triangle 0 0 1\nterm x high: triangle 0 1 1\n"
        "rule if x is 'very lov' then y is A\nrule if x is high then y is B\n"
    )
    (finding,) = parse(text).diagnostics
    assert finding.hint == "did you mean 'very low'?"
    assert finding.replacement == "'very low'"


# --- A text that was read lately ---

BUMP = "term tip AVERAGE:   triangle 10 15 20"


def test_a_text_read_twice_is_read_once_until_a_kind_comes_or_goes() -> None:
    text = shipped("tipper.frb").read_text()
    first = parse_once(text, "tipper.frb")
    assert parse_once(text, "tipper.frb").rulebase is first.rulebase
    assert parse_once(text + "# more\n", "tipper.frb").rulebase is not first.rulebase
    curved = text.replace(BUMP, "term tip AVERAGE: bump-of-tests 15")
    assert curved != text
    assert parse_once(curved).rulebase is None
    kinds.shape("bump-of-tests", ("centre",), lambda x, centre: 1.0 / (1.0 + (x - centre) ** 2))
    try:
        assert parse_once(curved).rulebase is not None
        assert parse_once(text, "tipper.frb").rulebase is not first.rulebase
    finally:
        SHAPES.remove("bump-of-tests")
    assert parse_once(curved).rulebase is None
