"""What kind of word each word is, for colouring a text."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass

from fuzzyarm.rulebase.model import CONJUNCTIONS, DEFUZZIFIERS, DISJUNCTIONS, SAMPLINGS
from fuzzyarm.rulebase.queries.occurrences import Kind
from fuzzyarm.rulebase.queries.reading import Reading
from fuzzyarm.rulebase.shapes import EVEN_SHAPES, SHAPES
from fuzzyarm.rulebase.syntax.settings import OUTSIDE
from fuzzyarm.rulebase.syntax.tokens import Token
from fuzzyarm.rulebase.syntax.words import (
    CONNECTIVES,
    HEDGE_WORDS,
    LOOKUP_ITEMS,
    RESERVED,
    SETTINGS,
    STATEMENTS,
)

COLOURS = (
    "keyword", "namespace", "variable", "enumMember", "modifier", "type", "property",
    "number", "string", "comment", "operator",
)  # fmt: skip
"""The kinds, in the order of the protocol's legend."""

_OPERATORS = {"->", "..", "=", "<", "<=", ">", ">=", "*", "\\"}
_NAMES = {
    Kind.RULEBASE: "namespace",
    Kind.BLOCK: "namespace",
    Kind.VARIABLE: "variable",
    Kind.TERM: "enumMember",
}
_TYPES = {
    *SHAPES, *EVEN_SHAPES, *CONJUNCTIONS, *DISJUNCTIONS, *DEFUZZIFIERS, *SAMPLINGS, *OUTSIDE,
    "exact", "hold",
}  # fmt: skip
_KEYWORDS = {
    *RESERVED, *CONNECTIVES, *LOOKUP_ITEMS, "step", "count", "mirrored", "within", "in", "height",
}  # fmt: skip
_WORDS: tuple[tuple[Container[str], str], ...] = (
    (HEDGE_WORDS, "modifier"),
    (("inf", "nan"), "number"),
    (_TYPES, "type"),
    (frozenset(SETTINGS) - {"and", "or"}, "property"),
    (_KEYWORDS, "keyword"),
)


@dataclass(frozen=True, slots=True)
class Coloured:
    """A stretch of one line: its place, one of `COLOURS`, and whether a name is declared here."""

    line: int
    column: int
    end: int
    colour: str
    declares: bool = False


def coloured(reading: Reading) -> list[Coloured]:
    """Return every word and comment that has a colour, in the order of the text."""
    names = {(o.span.line, o.span.column): o for o in reading.occurrences}
    found: list[Coloured] = []
    for line in reading.lines:
        for index, token in enumerate(line.tokens):
            name = names.get((token.line, token.column))
            if name is not None and token.kind in ("name", "quoted"):
                colour: str | None = _NAMES[name.kind]
            else:
                colour = _of_token(token, first=index == 0)
            if colour is not None:
                declares = name is not None and name.is_definition
                found.append(Coloured(token.line, token.column, token.end, colour, declares))
        if line.comment:
            after = line.tokens[-1].end - 1 if line.tokens else 0
            start = reading.raw_line(line.number).find("#", after)
            if start >= 0:
                end = start + len(line.comment)
                found.append(Coloured(line.number, start + 1, end + 1, "comment"))
    return found


def _of_token(token: Token, *, first: bool) -> str | None:
    if token.kind == "name":
        return _of_word(token.text, first=first)
    if token.kind == "mark":
        return "operator" if token.text in _OPERATORS else None
    return token.kind if token.kind in ("number", "string") else None


def _of_word(word: str, *, first: bool) -> str | None:
    if first and word in STATEMENTS:
        return "keyword"
    for words, colour in _WORDS:
        if word in words:
            return colour
    return None
