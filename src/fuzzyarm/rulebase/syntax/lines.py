"""Gather physical lines into statements with the lines that belong to them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.limits import MAX_DIAGNOSTICS
from fuzzyarm.rulebase.near import near_hint
from fuzzyarm.rulebase.syntax.nodes import Trivia
from fuzzyarm.rulebase.syntax.tokens import Line, Token
from fuzzyarm.rulebase.syntax.words import STATEMENTS

_ALLOW = re.compile(r"#\s*allow\s+([\w-]+(?:\s*,\s*[\w-]+)*)")


@dataclass(frozen=True, slots=True)
class BlockLine:
    """A line below ``rules`` or ``lookup``."""

    tokens: tuple[Token, ...]
    trivia: Trivia


@dataclass(slots=True)
class Group:
    """The tokens of one statement; for ``rules`` and ``lookup`` also the lines below it."""

    tokens: list[Token]
    before: tuple[str, ...]
    behind: str
    lines: list[BlockLine] = field(default_factory=list)

    @property
    def keyword(self) -> str:
        """The first word, which is a key of STATEMENTS."""
        return self.tokens[0].text


def group_lines(
    lines: list[Line], diagnostics: list[Diagnostic]
) -> tuple[list[Group], tuple[str, ...]]:
    """Return the statements of `lines` and the comments after the last one.

    A line that starts with a statement word starts a statement. Any other line belongs to
    the statement above it if it is indented (or if that is a grid); else it is an
    ``unknown-statement``, read on as the nearest statement if there is a near one.
    """
    groups: list[Group] = []
    waiting: list[str] = []
    for line in lines:
        if len(diagnostics) > MAX_DIAGNOSTICS:
            break
        if not line.tokens:
            if line.comment or (waiting[-1:] != [""] and (groups or waiting)):
                waiting.append(line.comment)
            continue
        first = line.tokens[0]
        if first.kind == "name" and first.text in STATEMENTS:
            groups.append(Group(list(line.tokens), tuple(waiting), line.comment))
        elif groups and _belongs(line, groups[-1]):
            _extend(groups[-1], line, waiting)
        else:
            diagnostic = _unknown_statement(first)
            diagnostics.append(diagnostic)
            if diagnostic.replacement is None:
                continue
            # Read on as what was probably meant, so that one slip does not look like many.
            meant = first._replace(kind="name", text=diagnostic.replacement)
            groups.append(Group([meant, *line.tokens[1:]], tuple(waiting), line.comment))
        waiting = []
    while waiting and waiting[-1] == "":
        waiting.pop()
    return groups, tuple(waiting)


def _belongs(line: Line, group: Group) -> bool:
    if line.indented:
        return True
    # A grid or a lookup block is understood without its indentation too, unless the line
    # looks like a misspelt statement.
    return (
        group.keyword in ("rules", "lookup") and not near_hint(line.tokens[0].text, STATEMENTS)[0]
    )


def _extend(group: Group, line: Line, waiting: list[str]) -> None:
    if group.keyword in ("rules", "lookup"):
        group.lines.append(BlockLine(line.tokens, Trivia(tuple(waiting), line.comment)))
        return
    group.tokens.extend(line.tokens)
    comments = [comment for comment in (*waiting, line.comment) if comment]
    group.before = (*group.before, *comments)


def _unknown_statement(token: Token) -> Diagnostic:
    hint, replacement = near_hint(token.text, STATEMENTS)
    return Diagnostic(
        "unknown-statement",
        f"no statement starts with '{token.text}'",
        token.span,
        hint=hint or "statements start with " + ", ".join(STATEMENTS),
        replacement=replacement,
    )


def allowances(lines: list[Line]) -> dict[int, frozenset[str]]:
    """Return the names that ``# allow NAME, NAME`` silences, by line."""
    allowed: dict[int, frozenset[str]] = {}
    for line in lines:
        match = _ALLOW.search(line.comment) if line.comment else None
        if match:
            allowed[line.number] = frozenset(re.split(r"\s*,\s*", match.group(1)))
    return allowed
