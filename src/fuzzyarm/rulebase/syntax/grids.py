r"""Read a rule grid: ``rules u``, a header ``e \ ce NB NM …`` and one line per row."""

from __future__ import annotations

from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.syntax.cursor import Cursor, Fault
from fuzzyarm.rulebase.syntax.expressions import read_expression
from fuzzyarm.rulebase.syntax.lines import BlockLine
from fuzzyarm.rulebase.syntax.nodes import (
    CellNode,
    ExpressionNode,
    GridNode,
    RowNode,
    Word,
)


def read_grid(cursor: Cursor, lines: list[BlockLine], diagnostics: list[Diagnostic]) -> GridNode:
    """Read the grid whose first line `cursor` holds and whose other lines are `lines`."""
    cursor.take()
    output = cursor.name("the output that the rules are for")
    condition: ExpressionNode | None = None
    if cursor.accept("when"):
        condition = read_expression(cursor)
    cursor.finish()
    span = cursor.whole
    if not lines:
        raise Fault(
            Diagnostic(
                "missing-header",
                f"the grid for '{output.text}' has no lines",
                span,
                hint="below it stands a header like  e \\ ce  NB ZE PB  and one line per row",
            )
        )
    header = lines[0]
    row, column, columns = _read_header(Cursor(header.tokens))
    rows = []
    for line in lines[1:]:
        try:
            rows.append(_read_row(Cursor(line.tokens), line, len(columns), diagnostics))
        except Fault as fault:
            diagnostics.append(fault.diagnostic)
    if len(lines) == 1:
        diagnostics.append(
            Diagnostic("empty-grid", f"the grid for '{output.text}' has no rows", span)
        )
    return GridNode(
        output,
        condition,
        row,
        column,
        columns,
        tuple(rows),
        header.trivia,
        Cursor(header.tokens).whole,
        span,
    )


def _read_header(cursor: Cursor) -> tuple[Word | None, Word, tuple[Word, ...]]:
    first = cursor.name("the name of the row variable")
    row: Word | None = None
    column = first
    if cursor.accept("\\"):
        row, column = first, cursor.name("the name of the column variable")
    columns: list[Word] = []
    while not cursor.at_end:
        columns.append(cursor.name(f"a term of '{column.text}'"))
    if not columns:
        cursor.fail(f"the terms of '{column.text}' that head the columns", (), "missing-header")
    return row, column, tuple(columns)


def _read_row(
    cursor: Cursor, line: BlockLine, count: int, diagnostics: list[Diagnostic]
) -> RowNode:
    label = cursor.name("the term that labels the row")
    cells: list[CellNode] = []
    while not cursor.at_end:
        cells.append(_read_cell(cursor, diagnostics))
    if len(cells) != count:
        where = cells[count].span.to(cells[-1].span) if len(cells) > count else cursor.span
        diagnostics.append(
            Diagnostic(
                "wrong-cell-count",
                f"row '{label.text}' has {_cells(len(cells))}, the header names {count} columns",
                where,
                hint="a cell without a rule is written as a dot" if len(cells) < count else "",
            )
        )
    return RowNode(label, tuple(cells[:count]), line.trivia)


def _cells(count: int) -> str:
    return "1 cell" if count == 1 else f"{count} cells"


def _read_cell(cursor: Cursor, diagnostics: list[Diagnostic]) -> CellNode:
    start = cursor.span
    try:
        if cursor.accept("."):
            return CellNode(None, None, start)
        term = cursor.name("a term or a dot")
        if not cursor.accept("*"):
            return CellNode(term, None, start)
        weight = cursor.figure("the weight of the rule")
        return CellNode(term, weight, start.to(weight.span))
    except Fault as fault:
        # One bad cell must not hide the mistakes behind it: note it and go on.
        diagnostics.append(fault.diagnostic)
        if not cursor.at_end and fault.diagnostic.span == cursor.span:
            cursor.take()
        return CellNode(None, None, start)
