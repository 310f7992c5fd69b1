"""From text to syntax tree. Never raises: what cannot be read becomes a diagnostic."""

from __future__ import annotations

from fuzzyarm.rulebase.diagnostic import Diagnostic, Span
from fuzzyarm.rulebase.limits import MAX_CHARACTERS, MAX_DIAGNOSTICS, MAX_LINE, MAX_LINES
from fuzzyarm.rulebase.syntax.cursor import Cursor, Fault
from fuzzyarm.rulebase.syntax.lines import Group, allowances, group_lines
from fuzzyarm.rulebase.syntax.memory import ParseMemory
from fuzzyarm.rulebase.syntax.nodes import Broken, Document, Statement, StatementNode, Trivia
from fuzzyarm.rulebase.syntax.statements import read_statement
from fuzzyarm.rulebase.syntax.tokens import split_lines


def parse_document(text: str, memory: ParseMemory | None = None) -> Document:
    """Return the syntax tree of `text` with every lexical and syntactic mistake.

    A statement that cannot be read is kept as :class:`Broken`, and reading goes on with
    the next one. With a `memory`, what has not changed since the last text is not read again.
    """
    too_large = _size_fault(text)
    if too_large is not None:
        return Document((), diagnostics=(too_large,))
    diagnostics: list[Diagnostic] = []
    memory = memory or ParseMemory()
    lines = memory.tokenize(text, diagnostics)
    groups, ending = group_lines(lines, diagnostics)
    statements = tuple(_read_group(group, diagnostics, memory) for group in groups)
    memory.finish()
    return Document(statements, ending, allowances(lines), _first_at_each_place(diagnostics))


def _first_at_each_place(diagnostics: list[Diagnostic]) -> tuple[Diagnostic, ...]:
    # The lexer's complaint of a token comes before the parser's of the same one.
    first: dict[tuple[int, int], Diagnostic] = {}
    for diagnostic in diagnostics:
        first.setdefault((diagnostic.line, diagnostic.column), diagnostic)
    return tuple(sorted(first.values(), key=lambda diagnostic: diagnostic.span))


def _read_group(group: Group, diagnostics: list[Diagnostic], memory: ParseMemory) -> Statement:
    trivia = Trivia(group.before, group.behind)
    if len(diagnostics) > MAX_DIAGNOSTICS:
        return Statement(Broken(group.keyword, group.tokens[0].span), trivia)
    known = memory.recall(group)
    if known is None:
        found: list[Diagnostic] = []
        node = _read_node(group, found)
        memory.keep(group, node, found)
        known = node, tuple(found)
    diagnostics += known[1]
    return Statement(known[0], trivia)


def _read_node(group: Group, diagnostics: list[Diagnostic]) -> StatementNode:
    # A token that the lexer has already complained of needs no second complaint.
    if any(token.kind == "bad" for token in group.tokens):
        return Broken(group.keyword, Cursor(group.tokens).whole)
    try:
        return read_statement(group, diagnostics)
    except Fault as fault:
        diagnostics.append(fault.diagnostic)
        return Broken(group.keyword, Cursor(group.tokens).whole)


def _size_fault(text: str) -> Diagnostic | None:
    if len(text) > MAX_CHARACTERS:
        return Diagnostic(
            "file-too-large",
            f"the text has {len(text):,} characters; the limit is {MAX_CHARACTERS:,}",
        )
    if text.count("\n") + text.count("\r") > MAX_LINES and len(split_lines(text)) > MAX_LINES:
        return Diagnostic(
            "file-too-large",
            f"the text has more than {MAX_LINES:,} lines",
            Span(MAX_LINES + 1, 1, MAX_LINES + 1, 2),
        )
    if len(text) > MAX_LINE:
        for number, line in enumerate(split_lines(text), start=1):
            if len(line) > MAX_LINE:
                return Diagnostic(
                    "line-too-long",
                    f"the line has {len(line):,} characters; the limit is {MAX_LINE:,}",
                    Span(number, MAX_LINE + 1, number, MAX_LINE + 2),
                )
    return None
