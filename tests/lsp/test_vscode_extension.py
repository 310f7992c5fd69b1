"""The extension for Visual Studio Code: its files fit together and its grammars know every word."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.language.tokens import HEDGE_WORDS, LOOKUP_ITEMS, STATEMENTS
from fuzzyarm.model.rulebase import DEFUZZIFIERS
from fuzzyarm.model.shapes import EVEN_SHAPES
from fuzzyarm.table.grid import KEYWORDS

FOLDER = Path(__file__).parents[2] / "editors" / "vscode"
GRAMMAR = (FOLDER / "syntaxes" / "fuzzyarm.tmLanguage.json").read_text("utf-8")
TABLE = (FOLDER / "syntaxes" / "fuzzyarm-table.tmLanguage.json").read_text("utf-8")


def _words(grammar: str) -> set[str]:
    return set(re.findall(r"[A-Za-z]+(?:-[A-Za-z]+)*", grammar.replace("\\\\b", " ")))


@pytest.mark.parametrize(
    "words", [STATEMENTS, HEDGE_WORDS, SHAPES, EVEN_SHAPES, DEFUZZIFIERS, LOOKUP_ITEMS]
)
def test_the_grammar_knows_every_word_of_the_language(words: object) -> None:
    assert set(words) <= _words(GRAMMAR)  # type: ignore[call-overload]


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
    npm = shutil.which("npm")
    if npm is None or not (FOLDER / "node_modules").is_dir():
        pytest.skip("needs node and `npm ci` in editors/vscode")
    done = subprocess.run([npm, "test"], cwd=FOLDER, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
