"""What could stand at a place, told by the words before it: a broken line is no hindrance."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from fuzzyarm.rulebase.diagnostic import Diagnostic, Span
from fuzzyarm.rulebase.near import nearest
from fuzzyarm.rulebase.queries.candidates import Candidate, keywords
from fuzzyarm.rulebase.queries.completion_grid import complete_grid_line
from fuzzyarm.rulebase.queries.completion_statement import complete_statement
from fuzzyarm.rulebase.queries.reading import Reading
from fuzzyarm.rulebase.syntax.tokens import Token, tokenize_line
from fuzzyarm.rulebase.syntax.words import LOOKUP_ITEMS, STATEMENTS

_PARTIAL = re.compile(r"(?:'[^']*|[^\W\d][\w-]*)\Z")
_ALLOW = re.compile(r"#\s*allow\s+(?:[\w-]+\s*,\s*)*([\w-]*)\Z")


@dataclass(frozen=True, slots=True)
class Before:
    """What stands before a place.

    Attributes
    ----------
    keyword : str
        The word that starts the statement, empty where none has been started.
    tokens : tuple of Token
        Of the statement's line, or of the line below ``rules`` and ``lookup``.
    first_line : int
        Where the statement starts.
    """

    keyword: str
    tokens: tuple[Token, ...]
    first_line: int


def complete(reading: Reading, line: int, column: int) -> list[Candidate]:
    """Return what could stand at a place, the likeliest first.

    Parameters
    ----------
    reading : Reading
        The text, however broken.
    line, column : int
        The place of the cursor, from 1.
    """
    text = reading.raw_line(line)[: column - 1]
    column = len(text) + 1
    comment = _in_comment(text, line, column)
    if comment is not None:
        return comment
    found: list[Diagnostic] = []
    tokenize_line(line, text, found)
    if any(d.name == "unterminated-string" and text[d.column - 1] == '"' for d in found):
        return []
    match = _PARTIAL.search(text)
    # A letter behind a digit belongs to no name: `1e` is on its way to a number.
    start = match.start() + 1 if match else column
    if match and text[: start - 1][-1:].isdigit():
        return []
    partial = text[start - 1 :]
    span = Span(line, start, line, column)
    tokens = tokenize_line(line, text[: start - 1], []).tokens
    before = _before(reading, line, tokens, indented=text[:1].isspace())
    offered = _offered(reading, line, before, indented=text[:1].isspace())
    wanted = partial.strip("'").casefold()
    ranked = sorted(offered, key=lambda c: not c.label.casefold().startswith(wanted))
    return [replace(candidate, span=span) for candidate in ranked]


def _in_comment(text: str, line: int, column: int) -> list[Candidate] | None:
    if not tokenize_line(line, text, []).comment and not text.endswith("#"):
        return None
    match = _ALLOW.search(text)
    if match is None:
        return []
    from fuzzyarm.rulebase.check import CHECKS

    span = Span(line, match.start(1) + 1, line, column)
    return [Candidate(n, "value", n, c.summary, span=span) for n, c in CHECKS.items()]


def _before(
    reading: Reading, line: int, tokens: tuple[Token, ...], *, indented: bool
) -> Before | None:
    if tokens and _starts_statement(tokens):
        return Before(tokens[0].text, tokens[1:], line)
    if not indented:
        # The line starts a statement, though its word may be misspelt.
        meant = nearest(tokens[0].text, STATEMENTS) if tokens else None
        if meant is not None:
            return Before(meant, tokens[1:], line)
        if not tokens:
            return None
    above: list[tuple[Token, ...]] = []
    for number in range(line - 1, 0, -1):
        earlier = reading.tokens_of(number)
        if not earlier:
            continue
        above.append(earlier)
        if _starts_statement(earlier):
            keyword = earlier[0].text
            if keyword in ("rules", "lookup"):
                return Before(keyword, tokens, number)
            joined = [token for part in reversed(above) for token in part]
            return Before(keyword, (*joined[1:], *tokens), number)
    return None


def _starts_statement(tokens: Sequence[Token]) -> bool:
    return tokens[0].kind == "name" and tokens[0].text in STATEMENTS


def _offered(
    reading: Reading, line: int, before: Before | None, *, indented: bool
) -> list[Candidate]:
    if before is None:
        return [] if indented else keywords(STATEMENTS, STATEMENTS)
    if before.first_line < line and before.keyword == "rules":
        return complete_grid_line(reading, line, before.first_line, before.tokens)
    if before.first_line < line and before.keyword == "lookup":
        return _lookup_item(reading, before.tokens)
    return complete_statement(reading.model, before.keyword, before.tokens)


def _lookup_item(reading: Reading, tokens: tuple[Token, ...]) -> list[Candidate]:
    from fuzzyarm.rulebase.queries.candidates import variables

    if not tokens:
        return keywords(LOOKUP_ITEMS)
    item, last = tokens[0].text, tokens[-1]
    if item in ("levels", "bins") and len(tokens) == 1:
        return variables(reading.model.inputs, ":")
    if last.kind != "number":
        return []
    if item == "levels" and any(token.text == ".." for token in tokens):
        return [] if {"step", "count"} & {t.text for t in tokens} else keywords(("step", "count"))
    return keywords(("mirrored",)) if item == "bins" else []
