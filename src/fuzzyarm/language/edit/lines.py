"""Small edits of a text by statements and lines, as building blocks."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from fuzzyarm.base.diagnostic import Diagnostic, Span
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.language.edit.fixes import Edit, apply_edits
from fuzzyarm.language.edit.reading import Reading, read
from fuzzyarm.language.phrases import NameKind
from fuzzyarm.language.rows import mentions
from fuzzyarm.language.rules import GridNode, RuleNode
from fuzzyarm.language.statements import (
    BlockNode,
    EvenTermsNode,
    Heading,
    InferenceNode,
    StatementNode,
    TermNode,
    VariableNode,
)

INCOMPLETE = frozenset({"no-rules", "no-inputs", "no-outputs"})
"""Errors of an unfinished text whose present part is valid."""


class ReshapeError(FuzzyarmError, ValueError):
    """A change without a unique position in the text."""


def nodes_of(reading: Reading) -> Iterator[StatementNode]:
    """Return the statements of a text."""
    return (statement.node for statement in reading.document.statements)


def declaration_of(reading: Reading, variable: str) -> VariableNode:
    """Return the statement that declares a variable, or raise."""
    for node in nodes_of(reading):
        if isinstance(node, VariableNode) and node.name == variable:
            return node
    raise ReshapeError(f"the text declares no variable '{variable}'")


def names_term(node: StatementNode, variable: str, term: str) -> bool:
    """Whether a statement names a term of a variable."""
    return any(
        mention.kind is NameKind.TERM and mention.name == term and variable in mention.owners
        for mention in mentions(node)
    )


def last_lines(reading: Reading) -> dict[int, int]:
    """Return the last line of every statement by its first one."""
    return {start: end for _, start, end in reading.extents}


def last_line(reading: Reading, *kinds: type) -> int:
    """Return the last line of statements of these kinds; 0 without any."""
    return max((end for node, _, end in reading.extents if isinstance(node, kinds)), default=0)


def line_of_rules(reading: Reading) -> int:
    """Return the line after which rules are added: after the last rules, or the declarations."""
    line = last_line(reading, RuleNode, GridNode, BlockNode)
    need = (Heading, VariableNode, TermNode, EvenTermsNode, InferenceNode)
    return line or last_line(reading, *need) or max(1, len(reading.raw_lines))


def lines_behind(reading: Reading, line: int, added: Sequence[str]) -> Edit:
    """Return the edit that puts lines after another one."""
    end = len(reading.raw_line(line)) + 1
    return Edit(Span(line, end, line, end), "".join(f"\n{words}" for words in added))


def without_lines(reading: Reading, first: int, last: int) -> Edit:
    """Remove lines, from the first to the last."""
    if last < len(reading.raw_lines):
        return Edit(Span(first, 1, last + 1, 1), "")
    before = max(1, first - 1)  # at the end of the text delete the line break before
    start = len(reading.raw_line(before)) + 1 if first > 1 else 1
    return Edit(Span(before, start, last, len(reading.raw_line(last)) + 1), "")


def without_statement(reading: Reading, node: StatementNode) -> Edit:
    """Remove a statement with the lines that belong to it."""
    return without_lines(reading, node.span.line, last_lines(reading)[node.span.line])


def without_line_ranges(reading: Reading, ranges: Iterable[tuple[int, int]]) -> list[Edit]:
    """Remove stretches of lines, and a blank line after if one before stays."""
    merged: list[tuple[int, int]] = []
    for start, end in sorted(ranges):
        first, last = start, end
        if merged and start <= merged[-1][1] + 1:
            first, last = merged[-1][0], max(end, merged.pop()[1])
        if _is_blank(reading, first - 1) and _is_blank(reading, last + 1):
            last = min(last + 1, len(reading.raw_lines))
        merged.append((first, last))
    return [without_lines(reading, first, last) for first, last in merged]


def _is_blank(reading: Reading, line: int) -> bool:
    return not reading.raw_line(line).strip()


def without_word(reading: Reading, span: Span) -> Edit:
    """Remove a word of a grid and the blanks before it."""
    text = reading.raw_line(span.line)[: span.column - 1]
    start = len(text.rstrip(" ")) + 1
    return Edit(Span(span.line, start, span.line, span.end_column), "")


_GRID_WORD = re.compile(r"(?:'[^']*'|[^\s'#])+")
"""A word of a line of a grid: a cell with its weight is one."""


def realigned(reading: Reading, edits: Sequence[Edit]) -> list[Edit]:
    """Return edits with the blanks that keep the columns of the grids they touch aligned."""
    found = list(edits)
    touched = {edit.span.line for edit in edits}
    for node in nodes_of(reading):
        if isinstance(node, GridNode):
            lines = [node.header_span.line, *(row.label.span.line for row in node.rows)]
            if touched.intersection(lines):
                found += _blanks(reading, lines, len(node.columns), edits)
    return found


def _blanks(
    reading: Reading, lines: Sequence[int], count: int, edits: Sequence[Edit]
) -> Iterator[Edit]:
    """Yield the changes of blanks in the lines of a grid, for the words that edits put there."""
    rows = [_columns_of(reading.raw_line(line), count) for line in lines]
    if not all(rows):
        return  # a line has not as many words as the grid has columns
    places = [row[0][0] for row in rows]  # start of the word before, after the edits
    for column in range(1, count + 1):
        ends = [row[column - 1][1] for row in rows]
        starts = [row[column][0] for row in rows]
        gaps = [start - end for start, end in zip(starts, ends, strict=True)]
        behind = [
            place + _width(line, row[column - 1], edits)
            for place, line, row in zip(places, lines, rows, strict=True)
        ]
        if len(set(starts)) == 1:
            place = max(starts[0], *(end + min(gaps) for end in behind))
            places = [place] * len(rows)
        else:
            places = [end + gap for end, gap in zip(behind, gaps, strict=True)]
        for line, old, start, end, place in zip(lines, ends, starts, behind, places, strict=True):
            if place - end != start - old:
                yield Edit(Span(line, old, line, start), " " * (place - end))


def _columns_of(text: str, count: int) -> list[tuple[int, int]]:
    """Return the columns of a line's head and last words, from 1; empty if there are too few."""
    words = [(word.start() + 1, word.end() + 1) for word in _GRID_WORD.finditer(_uncommented(text))]
    if len(words) <= count:
        return []
    head = words[0][0], words[-count - 1][1]
    return [head, *words[-count:]]


def _uncommented(text: str) -> str:
    found = re.match(r"(?:'[^']*'|[^'#])*", text)
    return found[0] if found else ""


def _width(line: int, word: tuple[int, int], edits: Sequence[Edit]) -> int:
    """Return the length of a word after the edits within it."""
    start, end = word
    within = [
        edit
        for edit in edits
        if edit.span.line == line and start <= edit.span.column and edit.span.end_column <= end
    ]
    change = sum(len(edit.text) - edit.span.end_column + edit.span.column for edit in within)
    return end - start + change


def demand_sound(reading: Reading, edits: Sequence[Edit], what: str = "") -> list[Edit]:
    """Return the edits unless they add a mistake to the text.

    A definition missing only until or since an edit is not a mistake.
    """
    before = [_said(diagnostic) for diagnostic in reading.parsed.diagnostics if diagnostic.is_error]
    for diagnostic in read(apply_edits(reading.text, edits), reading.path).parsed.diagnostics:
        if not diagnostic.is_error or diagnostic.name in INCOMPLETE:
            continue
        if _said(diagnostic) not in before:
            raise ReshapeError(f"{what}{diagnostic.message}", hint=diagnostic.hint)
        before.remove(_said(diagnostic))
    return list(edits)


def _said(finding: Diagnostic) -> tuple[str, str]:
    return finding.name, finding.message
