"""A text at a glance: colours of its words, stretches that fold, its symbols."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass, replace
from typing import Any

from fuzzyarm.base.diagnostic import Span
from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS, CONTROLLER_WORDS
from fuzzyarm.language.edit.completion import variable_detail
from fuzzyarm.language.edit.reading import Reading
from fuzzyarm.language.model.rulebase import SAMPLINGS
from fuzzyarm.language.model.shapes import EVEN_SHAPES
from fuzzyarm.language.phrases import SETTINGS, NameKind
from fuzzyarm.language.rows import mentions
from fuzzyarm.language.rules import GridNode
from fuzzyarm.language.statements import STATEMENTS, WORDS, BlockNode, StatementNode, VariableNode
from fuzzyarm.language.tokens import RESERVED, Token
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SHAPES, SNORMS, TNORMS, Registry
from fuzzyarm.symbolic.sources import SOURCES

# --- The kind of each word, for colours ---

COLOURS = (
    "keyword", "namespace", "variable", "enumMember", "modifier", "type", "property",
    "number", "string", "comment", "operator",
)  # fmt: skip
"""The kinds, in the order of the protocol's legend."""

_OPERATORS = {"->", "..", "=", "<", "<=", ">", ">=", "*", "\\"}
_NAMES = {
    NameKind.RULEBASE: "namespace",
    NameKind.BLOCK: "namespace",
    NameKind.VARIABLE: "variable",
    NameKind.TERM: "enumMember",
    NameKind.CONTROLLER: "namespace",
    NameKind.USE: "namespace",
    NameKind.SIGNAL: "variable",
    NameKind.AXIS: "enumMember",
    NameKind.PORT: "property",
    NameKind.PLANT: "namespace",
    NameKind.STATE: "property",
    NameKind.PARAMETER: "property",
}
_VALUES = {*EVEN_SHAPES, *SAMPLINGS, *SETTINGS["outside"].values, "exact", "hold"}
_KINDS: tuple[Registry[Any], ...] = (SHAPES, TNORMS, SNORMS, DEFUZZIFIERS)
_WORDS: tuple[tuple[Container[str], str], ...] = (
    (HEDGES.words, "modifier"),
    (("inf", "nan"), "number"),
    *((words, "type") for words in (_VALUES, *(kinds.words for kinds in _KINDS))),
    (SETTINGS.keys() - RESERVED, "property"),
    ({*RESERVED, *WORDS, *CONTROLLER_WORDS}, "keyword"),
    (SOURCES, "keyword"),
)
"""Colours of words that are not names: the first matching entry."""


@dataclass(frozen=True, slots=True)
class Coloured:
    """A stretch of one line: its span, one of `COLOURS`, and whether a name is declared here."""

    line: int
    column: int
    end: int
    colour: str
    declares: bool = False


def coloured(reading: Reading) -> list[Coloured]:
    """Return every word and comment that has a colour, in the order of the text."""
    names = {(o.span.line, o.span.column): o for o in reading.occurrences}
    words: list[Coloured] = []
    for line in reading.lines:
        for index, token in enumerate(line.tokens):
            name = names.get((token.line, token.column))
            if name is not None and token.kind in ("name", "quoted"):
                colour: str | None = _NAMES[name.kind]
            else:
                colour = _of_token(token, first=index == 0)
            if colour is not None:
                declares = name is not None and name.is_definition
                words.append(Coloured(token.line, token.column, token.end, colour, declares))
        if line.comment:
            after = line.tokens[-1].end - 1 if line.tokens else 0
            start = reading.raw_line(line.number).find("#", after)
            if start >= 0:
                end = start + len(line.comment)
                words.append(Coloured(line.number, start + 1, end + 1, "comment"))
    return words


def _of_token(token: Token, *, first: bool) -> str | None:
    if token.kind == "name":
        return _of_word(token.text, first=first)
    if token.kind == "mark":
        return "operator" if token.text in _OPERATORS else None
    return token.kind if token.kind in ("number", "string") else None


def _of_word(word: str, *, first: bool) -> str | None:
    if first and (word in STATEMENTS or word in CONTROLLER_STATEMENTS):
        return "keyword"
    for words, colour in _WORDS:
        if word in words:
            return colour
    return None


# --- Foldable stretches of a text ---


@dataclass(frozen=True, slots=True)
class Fold:
    """Lines `first` to `last`, from 1; `is_comment` for runs of comment lines."""

    first: int
    last: int
    is_comment: bool = False


def folds(reading: Reading) -> list[Fold]:
    """Return grids, lookup settings, long rules, blocks and runs of comment lines."""
    ranges = [Fold(first, last) for _, first, last in reading.extents if last > first]
    ranges += _blocks(reading)
    ranges += _comments(reading)
    return sorted(ranges, key=lambda fold: (fold.first, -fold.last))


def _blocks(reading: Reading) -> list[Fold]:
    extents = reading.extents
    starts = [i for i, (node, _, _) in enumerate(extents) if isinstance(node, BlockNode)]
    ends = [*(i - 1 for i in starts[1:]), len(extents) - 1]
    return [
        Fold(extents[start][1], extents[end][2])
        # Without blocks there is one end more.
        for start, end in zip(starts, ends, strict=False)
        if end > start
    ]


def _comments(reading: Reading) -> list[Fold]:
    folds: list[Fold] = []
    first = 0
    # One step beyond the last line ends a run of comments that reaches the end.
    for number in range(1, len(reading.lines) + 2):
        inside = number <= len(reading.lines)
        line = reading.lines[number - 1] if inside else None
        if line is not None and line.comment and not line.tokens:
            first = first or number
            continue
        if first and number - 1 > first:
            folds.append(Fold(first, number - 1, is_comment=True))
        first = 0
    return folds


# --- The outline of a file ---


@dataclass(frozen=True, slots=True)
class OutlineSymbol:
    """A part of a file.

    Attributes
    ----------
    name, detail : str
        Texts of the outline.
    kind : str
        ``rulebase``, ``input``, ``output``, ``term``, ``block``, ``grid``, ``rule``,
        ``lookup`` or ``expect``.
    span, selection : Span
        All of it, and its name; the second lies within the first.
    children : tuple of OutlineSymbol
        The terms of a variable.
    """

    name: str
    detail: str
    kind: str
    span: Span
    selection: Span
    children: tuple[OutlineSymbol, ...] = ()


def symbols(reading: Reading) -> list[OutlineSymbol]:
    """Return the parts of a file in its order; the terms of a variable below it."""
    entries: list[OutlineSymbol] = []
    for node, first, last in reading.extents:
        word = reading.tokens_of(first)[0].text
        record = STATEMENTS.get(word) or CONTROLLER_STATEMENTS.get(word)
        if record is None or not record.outline or not isinstance(node, record.node):
            continue
        whole = Span(first, node.span.column, last, len(reading.raw_line(last)) + 1)
        if isinstance(node, VariableNode):
            entries.append(_variable(reading, node, whole))
        else:
            entries.append(_named(*_title(reading, node, first), record.outline, whole))
    return entries


def _title(reading: Reading, node: StatementNode, line: int) -> tuple[str, str, Span]:
    """Return name and detail of a statement, and its span in the outline."""
    if isinstance(node, GridNode):
        size = f"{len(node.rows)} × {len(node.columns)}"
        outputs = ", ".join(part.output for part in node.parts)
        return f"rules {outputs}", size, node.output.span
    name = next((o for o in mentions(node) if o.is_definition), None)
    if name is not None:
        return name.name, getattr(node, "description", None) or "", name.span
    tokens = reading.tokens_of(line)
    text = " ".join(reading.raw_line(line).split()) if len(tokens) > 1 else tokens[0].text
    return text[:60], "", node.span


def _named(name: str, detail: str, selection: Span, kind: str, span: Span) -> OutlineSymbol:
    end = min((selection.end_line, selection.end_column), (span.end_line, span.end_column))
    return OutlineSymbol(
        name or "?", detail, kind, span, Span(selection.line, selection.column, *end)
    )


def _variable(reading: Reading, node: VariableNode, span: Span) -> OutlineSymbol:
    variable = reading.variable(node.name)
    home = node.name.span
    if variable is None:
        return _named(node.name, "", home, node.role, span)
    # A child must lie within its parent, but terms are declared elsewhere: they point home.
    children = tuple(
        _named(term.name, term.shape.kind, home, "term", home) for term in variable.terms
    )
    symbol = _named(node.name, variable_detail(variable), home, node.role, span)
    return replace(symbol, children=children)
