"""A text with everything that reading it brought to light, and each position of each name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Any

from fuzzyarm.expression.formulas import FormulaError, read_formula
from fuzzyarm.language.nodes import (
    BlockNode,
    Broken,
    Document,
    EvenTermsNode,
    ExpectNode,
    ExpressionNode,
    GridNode,
    Heading,
    InferenceNode,
    LookupNode,
    RuleNode,
    ShapeNode,
    StatementNode,
    TermNode,
    VariableNode,
    Word,
    proposition_nodes,
)
from fuzzyarm.language.parser import ParseMemory
from fuzzyarm.language.reading import Parsed, parse
from fuzzyarm.language.tokens import HEDGE_WORDS, RESERVED, Line, Token
from fuzzyarm.model.rulebase import Input, Output, RuleBase
from fuzzyarm.text.diagnostic import Span, split_lines

# --- Every place at which a text names something: a variable, a term, a block ---


class Kind(StrEnum):
    """What a name stands for."""

    RULEBASE = "rulebase"
    VARIABLE = "variable"
    TERM = "term"
    BLOCK = "block"


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A name at its place.

    Attributes
    ----------
    kind : Kind
        What it stands for.
    name : str
        Without quotes.
    span : Span
        As written, quotes included.
    owners : tuple of str
        The variables of a term: one, or several where ``terms`` declares them together.
    is_definition : bool
        Whether the name is declared here.
    """

    kind: Kind
    name: str
    span: Span
    owners: tuple[str, ...] = ()
    is_definition: bool = False


def find_occurrences(document: Document, lines: Sequence[Line]) -> tuple[Occurrence, ...]:
    """Return every occurrence of every name, in the order of the text.

    Of statements that could not be read, those that are certain: declared variables, and
    the words behind their ``is``.
    """
    nodes = [statement.node for statement in document.statements]
    found = [each for node in nodes for each in _of_node(node)]
    declared = {o.name for o in found if o.kind is Kind.VARIABLE and o.is_definition}
    for node in nodes:
        if isinstance(node, Broken):
            found += _of_broken(node, lines, declared)
    return tuple(sorted(found, key=lambda o: o.span))


def _of_node(node: StatementNode) -> Iterator[Occurrence]:
    walk = _WALKS.get(type(node))
    if walk is not None:
        yield from walk(node)


def _of_heading(node: Heading) -> Iterator[Occurrence]:
    yield Occurrence(Kind.RULEBASE, node.name.text, node.name.span, is_definition=True)


def _of_declaration(node: VariableNode) -> Iterator[Occurrence]:
    yield _variable(node.name, definition=True)


def _of_even_terms(node: EvenTermsNode) -> Iterator[Occurrence]:
    owners = tuple(word.text for word in node.variables)
    yield from map(_variable, node.variables)
    for word in node.names:
        yield Occurrence(Kind.TERM, word.text, word.span, owners, is_definition=True)


def _of_term(node: TermNode) -> Iterator[Occurrence]:
    yield _variable(node.variable)
    owner = (node.variable.text,)
    yield Occurrence(Kind.TERM, node.name.text, node.name.span, owner, is_definition=True)
    if node.shape is not None:
        yield from _of_shape(node.shape)


def _of_inference(node: InferenceNode) -> Iterator[Occurrence]:
    if node.target is not None:
        yield _variable(node.target)


def _of_block(node: BlockNode) -> Iterator[Occurrence]:
    yield Occurrence(Kind.BLOCK, node.name.text, node.name.span, is_definition=True)


def _of_rule(node: RuleNode) -> Iterator[Occurrence]:
    yield from _of_expression(node.antecedent)
    for consequent in node.consequents:
        yield from _of_expression(consequent)


def _of_lookup(node: LookupNode) -> Iterator[Occurrence]:
    yield from (_variable(item.variable) for item in node.items if item.variable is not None)


def _of_expect(node: ExpectNode) -> Iterator[Occurrence]:
    yield from (_variable(word) for word, _ in node.inputs)
    yield from (_variable(outcome.variable) for outcome in node.outcomes)


def _variable(word: Word, *, definition: bool = False) -> Occurrence:
    return Occurrence(Kind.VARIABLE, word.text, word.span, is_definition=definition)


def _term(owner: str, word: Word) -> Occurrence:
    return Occurrence(Kind.TERM, word.text, word.span, (owner,))


def _of_expression(node: ExpressionNode) -> Iterator[Occurrence]:
    for proposition in proposition_nodes(node):
        yield _variable(proposition.variable)
        yield _term(proposition.variable.text, proposition.term)


def _of_shape(shape: ShapeNode) -> Iterator[Occurrence]:
    for part in shape.parts:
        if part.variable is not None:
            yield _variable(part.variable)
    if shape.formula:
        yield from _of_formula(shape.formula, shape.formula_span)


def _of_formula(text: str, span: Span) -> Iterator[Occurrence]:
    try:
        formula = read_formula(text)
    except FormulaError:
        return
    # Where the text has escapes, positions within it are not those of the file.
    if span.end_column - span.column != len(text) + 2:
        return
    for name, position in formula.mentions:
        quoted = text[position - 1 : position] == "'"
        start = span.column + 1 + position - quoted
        end = start + len(name) + 2 * quoted
        yield Occurrence(Kind.VARIABLE, name, Span(span.line, start, span.line, end))


def _of_grid(node: GridNode) -> Iterator[Occurrence]:
    yield _variable(node.output)
    if node.condition is not None:
        yield from _of_expression(node.condition)
    if node.row is not None:
        yield _variable(node.row)
    yield _variable(node.column)
    yield from (_term(node.column.text, word) for word in node.columns)
    for row in node.rows:
        yield _variable(row.label) if node.row is None else _term(node.row.text, row.label)
        yield from (_term(node.output.text, c.term) for c in row.cells if c.term is not None)


def _of_broken(node: Broken, lines: Sequence[Line], declared: set[str]) -> Iterator[Occurrence]:
    tokens = [
        token
        for line in lines[node.span.line - 1 : node.span.end_line]
        for token in line.tokens
        if node.span.line < token.line or token.column > node.span.column
    ]
    if node.keyword in ("input", "output", "rulebase", "block"):
        return
    for index, token in enumerate(tokens):
        if not _is_name(token):
            continue
        owner = _asked_variable(tokens, index)
        if owner is not None:
            yield Occurrence(Kind.TERM, token.text, token.span, (owner,))
        elif token.text in declared:
            yield Occurrence(Kind.VARIABLE, token.text, token.span)


def _is_name(token: Token) -> bool:
    return token.kind == "quoted" or (token.kind == "name" and token.text not in RESERVED)


def _asked_variable(tokens: list[Token], index: int) -> str | None:
    """Return the variable before the ``is`` that the token at `index` follows, hedges between."""
    index -= 1
    while index >= 0 and tokens[index].kind == "name" and tokens[index].text in HEDGE_WORDS:
        index -= 1
    if index < 1 or tokens[index].text != "is" or tokens[index].kind != "name":
        return None
    return tokens[index - 1].text if _is_name(tokens[index - 1]) else None


_WALKS: dict[type[StatementNode], Callable[[Any], Iterator[Occurrence]]] = {
    Heading: _of_heading,
    VariableNode: _of_declaration,
    EvenTermsNode: _of_even_terms,
    TermNode: _of_term,
    InferenceNode: _of_inference,
    BlockNode: _of_block,
    GridNode: _of_grid,
    RuleNode: _of_rule,
    LookupNode: _of_lookup,
    ExpectNode: _of_expect,
}


# --- A text with everything that reading it brought to light ---


@dataclass(frozen=True)
class Reading:
    """A text, its tokens, its syntax tree and what the sound part of it means.

    Attributes
    ----------
    text : str
        As it was given.
    parsed : Parsed
        Tree, meaning and mistakes.
    lines : tuple of Line
        The tokens, line by line.
    """

    text: str
    parsed: Parsed
    lines: tuple[Line, ...]

    @property
    def document(self) -> Document:
        """The syntax tree."""
        return self.parsed.document

    @property
    def model(self) -> RuleBase:
        """What the sound statements mean."""
        return self.parsed.partial

    @cached_property
    def raw_lines(self) -> list[str]:
        """The lines of the text without their ends."""
        return split_lines(self.text)

    @cached_property
    def occurrences(self) -> tuple[Occurrence, ...]:
        """Every place of every name, in the order of the text."""
        return find_occurrences(self.document, self.lines)

    def raw_line(self, line: int) -> str:
        """Return the text of a line, empty beyond the end."""
        return self.raw_lines[line - 1] if 1 <= line <= len(self.raw_lines) else ""

    def tokens_of(self, line: int) -> tuple[Token, ...]:
        """Return the tokens of a line, none beyond the end."""
        return self.lines[line - 1].tokens if 1 <= line <= len(self.lines) else ()

    def token_at(self, line: int, column: int) -> Token | None:
        """Return the token that a cursor touches, the one behind it before the one in front."""
        touched = [t for t in self.tokens_of(line) if t.column <= column <= t.end]
        return touched[-1] if touched else None

    def variable(self, name: str) -> Input | Output | None:
        """Return the variable called `name`, or None."""
        try:
            return self.model.variable(name)
        except KeyError:
            return None

    @cached_property
    def extents(self) -> list[tuple[StatementNode, int, int]]:
        """Every statement with its first and last line, the lines below it included."""
        nodes = [statement.node for statement in self.document.statements]
        starts = [node.span.line for node in nodes]
        ends = [*(start - 1 for start in starts[1:]), len(self.lines)]
        found = []
        for node, start, stop in zip(nodes, starts, ends, strict=False):
            end = stop
            while end > start and not self.tokens_of(end):
                end -= 1
            found.append((node, start, end))
        return found

    def statement_at(self, line: int) -> tuple[StatementNode, int, int] | None:
        """Return the statement that has tokens on `line` or around it."""
        for extent in self.extents:
            if extent[1] <= line <= extent[2]:
                return extent
        return None


def read(text: str, path: str = "<text>", memory: ParseMemory | None = None) -> Reading:
    """Read a text; never raises.

    Parameters
    ----------
    text : str
        Anything.
    path : str
        Named in the diagnostics.
    memory : ParseMemory, optional
        Of an earlier version of the same text.
    """
    memory = memory or ParseMemory()
    parsed = parse(text, path, memory)
    return Reading(text, parsed, tuple(memory.lines))


def contains(span: Span, line: int, column: int) -> bool:
    """Whether a cursor at this place touches `span`, its end included."""
    return (span.line, span.column) <= (line, column) <= (span.end_line, span.end_column)
