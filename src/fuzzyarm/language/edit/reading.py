"""A text with everything that reading it brought to light, and every mention of every name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

from fuzzyarm.base.diagnostic import Span, split_lines
from fuzzyarm.language.document import Document, ParseMemory
from fuzzyarm.language.model.rulebase import Input, Output, RuleBase
from fuzzyarm.language.phrases import NameKind, Occurrence
from fuzzyarm.language.reading import Parsed, parse
from fuzzyarm.language.rows import mentions
from fuzzyarm.language.statements import Broken, StatementNode
from fuzzyarm.language.tokens import SourceLine, Token, is_reserved
from fuzzyarm.symbolic.kinds import HEDGES

Facts = Mapping[tuple[NameKind, str], str]
"""Facts on names beyond the text, in words: ports of plants, ranges of signals. Supplied by the
caller, as the language knows neither plants nor numerics."""

NOTHING: Facts = MappingProxyType({})


def _find_occurrences(document: Document, lines: Sequence[SourceLine]) -> tuple[Occurrence, ...]:
    """Return every occurrence of every name, in the order of the text.

    In unreadable statements only certain ones: declared variables, and the words after their
    ``is``.
    """
    nodes = [statement.node for statement in document.statements]
    occurrences = [mention for node in nodes for mention in mentions(node)]
    variable_names = {
        o.name for o in occurrences if o.kind is NameKind.VARIABLE and o.is_definition
    }
    for node in nodes:
        if isinstance(node, Broken):
            occurrences += _of_broken(node, lines, variable_names)
    return tuple(sorted(occurrences, key=lambda o: o.span))


def _of_broken(
    node: Broken, lines: Sequence[SourceLine], declared: set[str]
) -> Iterator[Occurrence]:
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
        owner = expected_variable(tokens[:index])
        if owner is not None:
            yield Occurrence(NameKind.TERM, token.text, token.span, (owner,))
        elif token.text in declared:
            yield Occurrence(NameKind.VARIABLE, token.text, token.span)


def _is_name(token: Token) -> bool:
    return token.kind == "quoted" or (token.kind == "name" and not is_reserved(token.text))


def expected_variable(tokens: Sequence[Token]) -> str | None:
    """Return the variable whose term is expected after ``is`` and hedges; None otherwise."""
    index = len(tokens) - 1
    while index >= 0 and tokens[index].kind == "name" and tokens[index].text in HEDGES.words:
        index -= 1
    if index < 1 or tokens[index].text != "is" or tokens[index].kind != "name":
        return None
    return tokens[index - 1].text if _is_name(tokens[index - 1]) else None


@dataclass(frozen=True)
class Reading:
    """A text with its tokens, its syntax tree and the meaning of its valid part.

    Attributes
    ----------
    text : str
        The original text.
    parsed : Parsed
        Tree, meaning and mistakes.
    lines : tuple of SourceLine
        The tokens, line by line.
    path : str
        Path of the file; named files are relative to it.
    """

    text: str
    parsed: Parsed
    lines: tuple[SourceLine, ...]
    path: str = "<text>"

    @property
    def document(self) -> Document:
        """The syntax tree."""
        return self.parsed.document

    @property
    def model(self) -> RuleBase:
        """The model of the valid statements."""
        return self.parsed.partial

    @cached_property
    def raw_lines(self) -> list[str]:
        """The lines of the text without their ends."""
        return split_lines(self.text)

    @cached_property
    def occurrences(self) -> tuple[Occurrence, ...]:
        """Every occurrence of every name, in the order of the text."""
        return _find_occurrences(self.document, self.lines)

    def raw_line(self, line: int) -> str:
        """Return the text of a line, empty beyond the end."""
        return self.raw_lines[line - 1] if 1 <= line <= len(self.raw_lines) else ""

    def tokens_of(self, line: int) -> tuple[Token, ...]:
        """Return the tokens of a line, none beyond the end."""
        return self.lines[line - 1].tokens if 1 <= line <= len(self.lines) else ()

    def token_at(self, line: int, column: int) -> Token | None:
        """Return the token at a cursor: of two adjacent ones the right one."""
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
        spans = []
        for node, start, stop in zip(nodes, starts, ends, strict=False):
            end = stop
            while end > start and not self.tokens_of(end):
                end -= 1
            spans.append((node, start, end))
        return spans

    def statement_at(self, line: int) -> tuple[StatementNode, int, int] | None:
        """Return the statement on or around `line`."""
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
        Memory of an earlier version of the same text.
    """
    memory = memory or ParseMemory()
    parsed = parse(text, path, memory)
    return Reading(text, parsed, tuple(memory.lines), path)


def contains(span: Span, line: int, column: int) -> bool:
    """Whether a cursor at this position touches `span`, its end included."""
    return (span.line, span.column) <= (line, column) <= (span.end_line, span.end_column)
