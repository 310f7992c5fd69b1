"""The extension for Visual Studio Code: its files fit together and its grammars know every word."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Iterable
from pathlib import Path

import pytest
from needs import need

from fuzzyarm.base.numbers import TIMES
from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS, CONTROLLER_WORDS, SIGNAL
from fuzzyarm.language.model.rulebase import SAMPLINGS
from fuzzyarm.language.model.shapes import EVEN_SHAPES
from fuzzyarm.language.phrases import SETTINGS
from fuzzyarm.language.statements import LOOKUP_ITEMS, STATEMENTS, WORDS
from fuzzyarm.language.tokens import RESERVED
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SHAPES, SNORMS, TNORMS
from fuzzyarm.symbolic.sources import SOURCES
from fuzzyarm.table.header import KEYWORDS

FOLDER = Path(__file__).parents[2] / "editors" / "vscode"
GRAMMAR = FOLDER / "syntaxes" / "fuzzyarm.tmLanguage.json"
"""Read by each test: `--update-golden` writes it."""
TABLE = (FOLDER / "syntaxes" / "fuzzyarm-table.tmLanguage.json").read_text("utf-8")


# What the words between `(` and `)` in the patterns of a scope are, by the records.
_NAMED = SETTINGS.keys() - RESERVED
_PLAIN_HEDGES = [word for word, name in HEDGES.words.items() if not HEDGES[name].parameters]
_FAMILIES = [*EVEN_SHAPES, *SHAPES]
_VALUES = dict.fromkeys(
    word
    for words in (TNORMS, SNORMS, DEFUZZIFIERS, ("exact",), SAMPLINGS, SETTINGS["outside"].values,
                  SETTINGS["no-rule"].values)
    for word in words
)  # fmt: skip
_BEFORE_NAMES = [word for word in STATEMENTS if word in ("rulebase", "input", "output", "block")]
_WITH_OWN_PATTERN = {*_BEFORE_NAMES, "terms", "term", "rules"}
_CONNECTIVES = dict.fromkeys(
    [*(word for word in RESERVED if word not in ("inf", "nan")),
     *(word for word in WORDS if word not in (*LOOKUP_ITEMS, "exact"))]
)  # fmt: skip
_LINES = [word for word in CONTROLLER_STATEMENTS if word not in (SIGNAL, "controller")]
_OPTIONS = [option for source in SOURCES.values() for option in source.options.values()]
_INSIDE = dict.fromkeys(
    [*(word for word in CONTROLLER_WORDS if word not in (*SOURCES, *TIMES)),
     *(word for option in _OPTIONS for word in option.rest), "partner", "hold", "back"]
)  # fmt: skip
WORD_LISTS: dict[tuple[str, int | str], Iterable[str]] = {
    ("controller", "end"): STATEMENTS,
    ("line", 0): _LINES,
    ("signal", 0): SOURCES,
    ("signal", 1): TIMES,
    ("signal", 2): _INSIDE,
    ("declaration", 0): _BEFORE_NAMES,
    ("statement", 0): [word for word in STATEMENTS if word not in _WITH_OWN_PATTERN],
    ("lookup", 0): LOOKUP_ITEMS,
    ("words", 1): _PLAIN_HEDGES,
    ("words", 2): HEDGES.words,
    ("words", 3): _CONNECTIVES,
    ("words", 4): sorted(_NAMED),
    ("words", 5): _FAMILIES,
    ("words", 6): _VALUES,
}
"""The words of a rule of the grammar, by its name and the index of the pattern in it, or by the
part of the rule where that is another one."""
_LIST = re.compile(r"(?<=[(:])[A-Za-z-]+(?:\|[A-Za-z-]+)+(?=\))")


def with_words(grammar: str) -> str:
    """Return the text of the grammar with the words of the records in its lists."""
    tree = json.loads(grammar)
    for (rule, index), words in WORD_LISTS.items():
        part = tree["repository"][rule]
        if isinstance(index, str):
            pattern = part[index]
        else:
            pattern = (part["patterns"][index] if "patterns" in part else part)["match"]
        listed = _LIST.search(pattern)
        assert listed is not None
        there, wanted = listed[0].split("|"), list(words)
        # The order is the grammar's own: that of the records may be of a set.
        kept = [word for word in there if word in wanted]
        new_words = sorted({*wanted} - {*there})
        changed = pattern[: listed.start()] + "|".join(kept + new_words) + pattern[listed.end() :]
        old, new = (json.dumps(text, ensure_ascii=False) for text in (pattern, changed))
        grammar = grammar.replace(old, new)
    return grammar


def test_the_words_of_the_grammar_are_those_of_the_records(update_golden: bool) -> None:
    expected = with_words(GRAMMAR.read_text("utf-8"))
    if update_golden:
        GRAMMAR.write_text(expected, "utf-8")
    assert GRAMMAR.read_text("utf-8") == expected
    assert _WITH_OWN_PATTERN - {*_BEFORE_NAMES} == {
        word for word in STATEMENTS if rf"^\\s*({word})" in expected
    }


def _words(grammar: str) -> set[str]:
    return set(re.findall(r"[A-Za-z]+(?:-[A-Za-z]+)*", grammar.replace("\\\\b", " ")))


@pytest.mark.parametrize(
    "words",
    [
        STATEMENTS,
        CONTROLLER_WORDS,
        _LINES,
        HEDGES.words,
        SHAPES,
        EVEN_SHAPES,
        DEFUZZIFIERS,
        LOOKUP_ITEMS,
    ],
)
def test_the_grammar_knows_every_word_of_the_language(words: object) -> None:
    assert set(words) <= _words(GRAMMAR.read_text("utf-8"))  # type: ignore[call-overload]


def test_the_grammar_of_tables_knows_every_keyword() -> None:
    assert set(KEYWORDS) <= _words(TABLE)


def test_what_the_manifest_names_is_there() -> None:
    manifest = json.loads((FOLDER / "package.json").read_text("utf-8"))
    contributed = manifest["contributes"]
    for grammar in contributed["grammars"]:
        path = FOLDER / grammar["path"]
        assert json.loads(path.read_text("utf-8"))["scopeName"] == grammar["scopeName"]
    for language in contributed["languages"]:
        assert json.loads((FOLDER / language["configuration"]).read_text("utf-8"))
    assert contributed["configuration"]["properties"]["fuzzyarm.command"]["default"] == [
        "fuzzyarm", "lsp",
    ]  # fmt: skip


def test_the_lock_file_names_no_host() -> None:
    lock = json.loads((FOLDER / "package-lock.json").read_text("utf-8"))
    named = [p for p in lock["packages"].values() if "resolved" in p]
    assert named == []


@pytest.mark.slow
def test_the_grammars_pass_their_own_tests() -> None:
    need("npm", "tools of the extension")
    done = subprocess.run(["npm", "test"], cwd=FOLDER, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
