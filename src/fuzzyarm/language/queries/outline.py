"""A text at a glance: colours of its words, stretches that fold, its symbols."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass

from fuzzyarm.expression.kinds import SHAPES, SNORMS, TNORMS
from fuzzyarm.language.nodes import (
    BlockNode,
    ExpectNode,
    GridNode,
    Heading,
    LookupNode,
    RuleNode,
    VariableNode,
)
from fuzzyarm.language.parser import OUTSIDE
from fuzzyarm.language.queries.completion import variable_detail
from fuzzyarm.language.queries.reading import Kind, Reading
from fuzzyarm.language.tokens import (
    CONNECTIVES,
    HEDGE_WORDS,
    LOOKUP_ITEMS,
    RESERVED,
    SETTINGS,
    STATEMENTS,
    Token,
)
from fuzzyarm.model.rulebase import DEFUZZIFIERS, SAMPLINGS
from fuzzyarm.model.shapes import EVEN_SHAPES
from fuzzyarm.text.diagnostic import Span

# --- What kind of word each word is, for colouring a text ---

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
    *SHAPES, *EVEN_SHAPES, *TNORMS, *SNORMS, *DEFUZZIFIERS, *SAMPLINGS, *OUTSIDE,
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


# --- Stretches of a text that can be folded away ---


@dataclass(frozen=True, slots=True)
class Fold:
    """Lines `first` to `last`, from 1; `is_comment` for runs of comment lines."""

    first: int
    last: int
    is_comment: bool = False


def folds(reading: Reading) -> list[Fold]:
    """Return grids, lookup settings, long rules, blocks and runs of comment lines."""
    found = [Fold(first, last) for _, first, last in reading.extents if last > first]
    found += _blocks(reading)
    found += _comments(reading)
    return sorted(found, key=lambda fold: (fold.first, -fold.last))


def _blocks(reading: Reading) -> list[Fold]:
    extents = reading.extents
    starts = [i for i, (node, _, _) in enumerate(extents) if isinstance(node, BlockNode)]
    ends = [*(i - 1 for i in starts[1:]), len(extents) - 1]
    return [
        Fold(extents[start][1], extents[end][2])
        for start, end in zip(starts, ends, strict=False)
        if end > start
    ]


def _comments(reading: Reading) -> list[Fold]:
    found: list[Fold] = []
    first = 0
    for number in range(1, len(reading.lines) + 2):
        inside = number <= len(reading.lines)
        line = reading.lines[number - 1] if inside else None
        if line is not None and line.comment and not line.tokens:
            first = first or number
            continue
        if first and number - 1 > first:
            found.append(Fold(first, number - 1, is_comment=True))
        first = 0
    return found


# --- The outline of a file ---


@dataclass(frozen=True, slots=True)
class Symbol:
    """A part of a file.

    Attributes
    ----------
    name, detail : str
        What an outline shows.
    kind : str
        ``rulebase``, ``input``, ``output``, ``term``, ``block``, ``grid``, ``rule``,
        ``lookup`` or ``expect``.
    span, selection : Span
        All of it, and its name; the second lies within the first.
    children : tuple of Symbol
        The terms of a variable.
    """

    name: str
    detail: str
    kind: str
    span: Span
    selection: Span
    children: tuple[Symbol, ...] = ()


def symbols(reading: Reading) -> list[Symbol]:
    """Return the parts of a file in its order; the terms of a variable below it."""
    found: list[Symbol] = []
    for node, first, last in reading.extents:
        whole = Span(first, node.span.column, last, len(reading.raw_line(last)) + 1)
        if isinstance(node, Heading):
            found.append(
                _named(node.name.text, node.description, "rulebase", whole, node.name.span)
            )
        elif isinstance(node, VariableNode):
            found.append(_variable(reading, node, whole))
        elif isinstance(node, BlockNode):
            found.append(_named(node.name.text, "", "block", whole, node.name.span))
        elif isinstance(node, GridNode):
            size = f"{len(node.rows)} × {len(node.columns)}"
            name = f"rules {node.output.text}"
            found.append(_named(name, size, "grid", whole, node.output.span))
        elif isinstance(node, RuleNode):
            text = " ".join(reading.raw_line(first).split())
            found.append(_named(text[:60] or "rule", "", "rule", whole, node.span))
        elif isinstance(node, LookupNode):
            found.append(_named("lookup", "", "lookup", whole, node.span))
        elif isinstance(node, ExpectNode):
            text = " ".join(reading.raw_line(first).split())
            found.append(_named(text[:60] or "expect", "", "expect", whole, node.span))
    return found


def _named(name: str, detail: str | None, kind: str, span: Span, selection: Span) -> Symbol:
    end = min((selection.end_line, selection.end_column), (span.end_line, span.end_column))
    return Symbol(
        name or "?", detail or "", kind, span, Span(selection.line, selection.column, *end)
    )


def _variable(reading: Reading, node: VariableNode, span: Span) -> Symbol:
    variable = reading.variable(node.name.text)
    if variable is None:
        return _named(node.name.text, "", node.role, span, node.name.span)
    # A child must lie within its parent, but terms are declared elsewhere: they point home.
    children = tuple(
        _named(term.name, term.shape.kind, "term", node.name.span, node.name.span)
        for term in variable.terms
    )
    return Symbol(
        node.name.text or "?", variable_detail(variable), node.role, span, node.name.span, children
    )
