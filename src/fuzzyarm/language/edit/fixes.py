"""Certain repairs of diagnostics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fuzzyarm.base.diagnostic import Diagnostic, Span, split_lines
from fuzzyarm.language.rules import GridNode, RowNode
from fuzzyarm.language.tokens import name_text


@dataclass(frozen=True, slots=True)
class Edit:
    """A replacement text for a span."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Fix:
    """A repair.

    Attributes
    ----------
    title : str
        Description in a list.
    edits : tuple of Edit
        None of them overlap.
    preferred : bool
        Whether it repairs the fault instead of silencing the finding.
    """

    title: str
    edits: tuple[Edit, ...]
    preferred: bool = True


def fixes(diagnostic: Diagnostic, text: str, grids: Sequence[GridNode] = ()) -> list[Fix]:
    """Return the repairs for one finding in `text`, the best first.

    Parameters
    ----------
    diagnostic : Diagnostic
        As `check` reports it.
    text : str
        The text that it is about.
    grids : sequence of GridNode
        The grids of the file.
    """
    lines = split_lines(text)
    offers: list[Fix] = []
    if diagnostic.replacement is not None:
        old = text_of(diagnostic.span, lines)
        offers.append(
            Fix(
                f"change {_shown(old)} to {_shown(diagnostic.replacement)}",
                (Edit(diagnostic.span, diagnostic.replacement),),
            )
        )
    if diagnostic.name == "wrong-cell-count":
        offers += _cells(diagnostic, lines, grids)
    elif diagnostic.name == "missing-heading":
        start = Span(1, 1, 1, 1)
        offers.append(Fix("add a heading", (Edit(start, 'rulebase unnamed "description"\n\n'),)))
    elif diagnostic.name == "missing-rule":
        offers += _missing_rows(diagnostic, grids)
    elif diagnostic.name == "duplicate-rule":
        offers += _remove_line(diagnostic, lines)
    elif diagnostic.name == "useless-allow":
        offers += _remove_comment(diagnostic, lines)
    if diagnostic.lines:
        offers.append(_paste(diagnostic, lines))
    if not diagnostic.is_error and diagnostic.name not in ("useless-allow", "missing-heading"):
        offers += _allow(diagnostic, lines)
    return offers


def text_of(span: Span, lines: Sequence[str]) -> str:
    """Return the text of a span; of several lines the first."""
    if not 1 <= span.line <= len(lines):
        return ""
    end = span.end_column - 1 if span.end_line == span.line else None
    return lines[span.line - 1][span.column - 1 : end]


def _shown(text: str) -> str:
    return text if text.startswith("'") else f"'{text}'"


def _grid_of(line: int, grids: Sequence[GridNode]) -> tuple[GridNode, RowNode | None] | None:
    for grid in grids:
        for row in grid.rows:
            if row.label.span.line == line:
                return grid, row
        if line in (grid.header_span.line, grid.span.line):
            return grid, None
    return None


def _cells(diagnostic: Diagnostic, lines: Sequence[str], grids: Sequence[GridNode]) -> list[Fix]:
    place = _grid_of(diagnostic.line, grids)
    if place is None:
        return []
    grid, row = place
    if row is None:
        return []
    missing = len(grid.columns) - len(row.cells)
    if missing > 0:
        behind = diagnostic.span
        end = Span(behind.line, behind.column, behind.line, behind.column)
        what = "the missing cell" if missing == 1 else f"the {missing} missing cells"
        return [Fix(f"add {what}", (Edit(end, "  ." * missing),))]
    span = diagnostic.span
    start = len(lines[span.line - 1][: span.column - 1].rstrip()) + 1
    surplus = Span(span.line, start, span.end_line, span.end_column)
    return [Fix("remove the excess", (Edit(surplus, ""),))]


def _missing_rows(diagnostic: Diagnostic, grids: Sequence[GridNode]) -> list[Fix]:
    place = _grid_of(diagnostic.line, grids)
    if place is None or place[1] is not None or "has no row" not in diagnostic.message:
        return []
    grid = place[0]
    names = diagnostic.message.rpartition(" for ")[2].partition(" is ")[2].split(", ")
    last = grid.rows[-1].label.span.line if grid.rows else grid.header_span.line
    rows = "".join(f"  {name_text(n)}{'  .' * len(grid.columns)}\n" for n in names)
    title = f"add the row {names[0]}" if len(names) == 1 else f"add the {len(names)} missing rows"
    return [Fix(title, (Edit(Span(last + 1, 1, last + 1, 1), rows),))]


def _paste(diagnostic: Diagnostic, lines: Sequence[str]) -> Fix:
    """Put the lines of a finding below it, such as the points at which a property fails."""
    end = diagnostic.span.end_line
    column = len(lines[end - 1]) + 1
    text = "".join(f"\n{line}" for line in diagnostic.lines)
    what = diagnostic.lines[0].split(maxsplit=1)[0]
    title = f"paste where it fails as `{what}`"
    return Fix(title, (Edit(Span(end, column, end, column), text),), preferred=False)


def _remove_line(diagnostic: Diagnostic, lines: Sequence[str]) -> list[Fix]:
    span = diagnostic.span
    if not lines[span.line - 1].lstrip().startswith("rule ") or span.column > 1:
        return []
    return [Fix("remove this rule", (Edit(Span(span.line, 1, span.end_line + 1, 1), ""),))]


def _remove_comment(diagnostic: Diagnostic, lines: Sequence[str]) -> list[Fix]:
    line = lines[diagnostic.line - 1]
    start = line.find("# allow")
    if start < 0:
        return []
    rest = line[:start].rstrip()
    edit = Edit(Span(diagnostic.line, len(rest) + 1, diagnostic.line, len(line) + 1), "")
    return [Fix("remove the comment", (edit,))]


def _allow(diagnostic: Diagnostic, lines: Sequence[str]) -> list[Fix]:
    from fuzzyarm.language.check import CHECKS

    if diagnostic.name not in CHECKS or not 1 <= diagnostic.line <= len(lines):
        return []
    line = lines[diagnostic.line - 1]
    end = Span(diagnostic.line, len(line) + 1, diagnostic.line, len(line) + 1)
    comment = f"  # allow {diagnostic.name}"
    if "#" in line:
        if "# allow " not in line:
            return []
        comment = f", {diagnostic.name}"
    return [Fix(f"allow this {diagnostic.name}", (Edit(end, comment),), preferred=False)]


def apply_edits(text: str, edits: Sequence[Edit]) -> str:
    """Return `text` after `edits`, with positions in the original text.

    Line ends of other lines are kept as they are.
    """
    starts = _line_starts(text)
    for edit in sorted(edits, key=lambda e: e.span, reverse=True):
        start = _offset(starts, edit.span.line, edit.span.column, len(text))
        end = _offset(starts, edit.span.end_line, edit.span.end_column, len(text))
        text = text[:start] + edit.text + text[end:]
    return text


def _line_starts(text: str) -> list[int]:
    import re

    return [0, *(match.end() for match in re.finditer(r"\r\n|\r|\n", text))]


def _offset(starts: list[int], line: int, column: int, length: int) -> int:
    if line > len(starts):
        return length
    return min(starts[line - 1] + column - 1, length)
