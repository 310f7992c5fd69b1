"""A row of parts is all that a statement needs to be read, written, offered and renamed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import pytest

from fuzzyarm.base.diagnostic import NOWHERE, Figure, Span, Word
from fuzzyarm.language import format_text, parse
from fuzzyarm.language.edit import (
    apply_edits,
    coloured,
    complete,
    folds,
    hover,
    read,
    rename,
    symbols,
)
from fuzzyarm.language.parts import FixedText, Keyword, Number, VariableName
from fuzzyarm.language.rows import StatementKind, StatementRow
from fuzzyarm.language.statements import STATEMENTS
from fuzzyarm.language.tokens import STARTERS, name_text

HEAD = """\
rulebase r
input e -1 .. 1
output u -1 .. 1
terms e, u: triangles N P
rule if e is N then u is N
rule if e is P then u is P
"""


class GainNode(NamedTuple):
    """``gain VARIABLE by NUMBER``."""

    variable: Word
    factor: Figure
    span: Span = NOWHERE


@pytest.fixture(autouse=True)
def gain(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    row = StatementRow(
        GainNode,
        Keyword("gain"),
        VariableName("variable", "the name of an input", role="input", follow=" by", label="INPUT"),
        FixedText("by", "after the input"),
        Number("factor", "the factor", "FACTOR"),
    )
    record = StatementKind("gain", "scales an input", row, outline="gain")
    assert record.syntax == "INPUT by FACTOR"
    assert record.words == {"by": ""}
    monkeypatch.setitem(STATEMENTS, "gain", record)
    STARTERS.add("gain")
    yield
    STARTERS.remove("gain")


def test_it_is_read_and_written() -> None:
    parsed = parse(HEAD + "gain   e  by 2.50  # why\n")
    assert parsed.diagnostics == ()
    assert isinstance(parsed.document.statements[-1].node, GainNode)
    assert format_text(HEAD + "gain   e  by 2.50  # why\n") == (
        HEAD.replace("input e -1", "input  e  -1").replace("output u ", "output u  ")
        + "gain e by 2.5  # why\n"
    )
    assert name_text("gain") == "'gain'"


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("gain e bi 2", "expected 'by' after the input, found 'bi'"),
        ("gain e by", "expected the factor, found the end of the line"),
        ("gain e by 2 3", "expected the end of the line, found '3'"),
        ("gian e by 2", "no statement starts with 'gian'"),
    ],
)
def test_what_is_wrong_with_it_is_told(line: str, message: str) -> None:
    (found,) = parse(HEAD + line).diagnostics
    assert found.message == message


@pytest.mark.parametrize(
    ("line", "offered"),
    [("gain ", ["e by"]), ("gain e ", ["by"]), ("gain e by ", [])],
)
def test_it_is_completed(line: str, offered: list[str]) -> None:
    reading = read(HEAD + line)
    assert [c.insert for c in complete(reading, HEAD.count("\n") + 1, len(line) + 1)] == offered


def test_it_is_offered_coloured_explained_and_renamed() -> None:
    text = HEAD + "gain e by 2\n"
    reading = read(text)
    last = text.count("\n")
    assert "gain" in [c.insert for c in complete(reading, last + 1, 1)]
    assert [c.colour for c in coloured(reading) if c.line == last][:2] == ["keyword", "variable"]
    shown = hover(reading, last, 2)
    assert shown is not None
    assert shown.markdown == "**gain**: scales an input"
    assert [s.kind for s in symbols(reading)][-1] == "gain"
    assert folds(reading) == []
    assert apply_edits(text, rename(reading, 2, 7, "error")).endswith("gain error by 2\n")
