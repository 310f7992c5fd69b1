from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

GOLDEN = Path(__file__).parent / "golden"

LOPSIDED = """\
rulebase lopsided "no symmetry anywhere"
input  a  0 .. 4   "first input, V"
input  b  -1 .. 1  "second input, mm"
output y  0 .. 10  "result, %"
term a LO: triangle 0 0 4
term a HI: triangle 0 4 4
term b N: triangle -1 -1 0
term b Z: triangle -1 0 1
term b P: triangle 0 1 1
term y S: triangle 0 2 4
term y M: triangle 3 5 7
term y L: triangle 6 8 10
rules y
  a \\ b  N  Z       P
  LO     S  S       M
  HI     S  M*0.5   L
rule if a is very HI or b is not N then y is L with 0.1
"""


@pytest.fixture
def lopsided_text() -> str:
    return LOPSIDED


@pytest.fixture
def lopsided():
    from fuzzyarm.language import parse

    return parse(LOPSIDED, "lopsided.frb").rulebase


@pytest.fixture
def golden(update_golden: bool) -> Callable[[str, str], None]:
    """Compare a text with a file that changes only by ``pytest --update-golden``."""

    def compare(name: str, text: str) -> None:
        path = GOLDEN / name
        if update_golden:
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, "utf-8")
        assert path.exists(), f"run pytest --update-golden to make {path.name}"
        assert text == path.read_text("utf-8")

    return compare
