"""The statements that are rules: grids, and sentences.

Nodes as described in :mod:`fuzzyarm.language.statements`, with their records.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from fuzzyarm.base.diagnostic import NOWHERE, Diagnostic, Figure, Span, Word
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.phrases import (
    ExpressionNode,
    Occurrence,
    PropositionNode,
    aligned,
    of_term,
    of_variable,
    read_expression,
)
from fuzzyarm.language.tokens import Cursor, Fault, Trivia, name_text

WIDTH = 100
"""A rule longer than this is broken before ``then``."""

# --- Grids ---


class CellNode(NamedTuple):
    """A grid cell: a term, maybe with a weight; no term where the file has a dot."""

    term: Word | None
    weight: Figure | None
    span: Span = NOWHERE

    @classmethod
    def read(cls, cursor: Cursor, output: Word) -> CellNode:
        """Read it from the cursor."""
        start = cursor.span
        try:
            term = cursor.term("a term or a dot", output) if not cursor.accept(".") else None
            if term is None or not cursor.accept("*"):
                return cls(term, None, start)
            weight = cursor.figure("the weight of the rule")
            return cls(term, weight, start.to(weight.span))
        except Fault as fault:
            # One bad cell must not hide the mistakes after it: note it and go on.
            cursor.forgiven.append(fault.diagnostic)
            if not cursor.at_end and fault.diagnostic.span == cursor.span:
                cursor.take()
            return cls(None, None, start)

    def __str__(self) -> str:
        if self.term is None:
            return "."
        if self.weight is None:
            return name_text(self.term)
        return f"{name_text(self.term)}*{number_text(self.weight)}"


class RowNode(NamedTuple):
    """A row of a grid."""

    label: Word
    cells: tuple[CellNode, ...]
    trivia: Trivia = Trivia()

    @classmethod
    def read(cls, cursor: Cursor, grid: GridNode, trivia: Trivia) -> tuple[RowNode, ...]:
        """Read a row below the header of `grid`: one for each of its outputs."""
        columns, outputs = grid.columns, [part.output for part in grid.parts]
        cursor.suggest("labels", grid)
        label = cursor.name("the term that labels the row")
        cells: list[list[CellNode]] = []
        cursor.suggest("cells", grid)
        while not cursor.at_end:
            cells.append([CellNode.read(cursor, outputs[0])])
            empty = cells[-1][0].term is None
            for output in outputs[1:]:
                if cursor.accept("/"):
                    cells[-1].append(CellNode.read(cursor, output))
                    continue
                if not empty:
                    cursor.fail(f"'/' and a term of '{output}'")
                cells[-1].append(cells[-1][0])
            cursor.suggest("cells", grid, len(cells))
        count = len(cells)
        # Where the one row of a grid over one input has no label, its first cell was read as one.
        unlabelled = grid.row is None and label not in outputs and count == len(columns) - 1
        if count != len(columns) and not unlabelled:
            surplus = count > len(columns)
            count_words = "1 cell" if count == 1 else f"{count} cells"
            cursor.forgiven.append(
                Diagnostic(
                    "wrong-cell-count",
                    f"row '{label}' has {count_words}, the header names {len(columns)} columns",
                    cells[len(columns)][0].span.to(cells[-1][-1].span) if surplus else cursor.span,
                    hint="" if surplus else "a cell without a rule is written as a dot",
                )
            )
        # The label of a grid over one input is its output; the first label applies to all.
        alone = grid.row is None and label == grid.output
        return tuple(
            cls(
                Word(output, label.span) if alone else label,
                tuple(cell[k] for cell in cells[: len(columns)]),
                trivia,
            )
            for k, output in enumerate(outputs)
        )


class GridNode(NamedTuple):
    """``rules OUTPUT, … [when …]`` and the grid below it.

    A grid over one input has no `row` variable; the label of its one row is the output.
    Where several outputs share a grid, `joined` has one of its own for each after the first.
    """

    output: Word
    condition: ExpressionNode | None
    row: Word | None
    column: Word
    columns: tuple[Word, ...]
    rows: tuple[RowNode, ...]
    header_trivia: Trivia = Trivia()
    header_span: Span = NOWHERE
    span: Span = NOWHERE
    joined: tuple[GridNode, ...] = ()

    @property
    def parts(self) -> tuple[GridNode, ...]:
        """A grid for each output."""
        return (self._replace(joined=()), *self.joined) if self.joined else (self,)

    @classmethod
    def read(cls, cursor: Cursor) -> GridNode:
        """Read it from the cursor."""
        (output, *others), condition = cls.read_first(cursor)
        cursor.finish()
        span = cursor.whole
        if not cursor.lines:
            raise Fault(
                Diagnostic(
                    "missing-header",
                    f"the grid for '{output}' has no lines",
                    span,
                    hint="below it comes a header like  e \\ ce  NB ZE PB  and one line per row",
                )
            )
        header, *lines = cursor.lines
        top = Cursor(header.tokens)
        row, column, columns = cls.read_header(top)
        cursor.forgiven += top.forgiven
        grid = cls(output, condition, row, column, columns, (), header.trivia, top.whole, span)
        grid = grid._replace(joined=tuple(grid._replace(output=other) for other in others))
        rows: list[tuple[RowNode, ...]] = []
        for line in lines:
            below = Cursor(line.tokens, recovers=cursor.recovers)
            try:
                rows.append(RowNode.read(below, grid, line.trivia))
            except Fault as fault:
                below.damage(fault)
            cursor.forgiven += below.forgiven
        if not lines:
            message = f"the grid for '{output}' has no rows"
            cursor.forgiven.append(Diagnostic("empty-grid", message, span))
        first, *more = [
            part._replace(rows=tuple(row[k] for row in rows)) for k, part in enumerate(grid.parts)
        ]
        return first._replace(joined=tuple(more))

    @staticmethod
    def read_first(cursor: Cursor) -> tuple[list[Word], ExpressionNode | None]:
        """Read the outputs and the condition."""
        cursor.take()
        outputs = [cursor.variable("the output that the rules are for", "output")]
        while cursor.accept(","):
            outputs.append(cursor.variable("another output", "output"))
        return outputs, read_expression(cursor) if cursor.accept("when") else None

    @staticmethod
    def read_header(cursor: Cursor) -> tuple[Word | None, Word, tuple[Word, ...]]:
        """Read the variable down (if any), the variable across and its terms."""
        cursor.suggest("headers")
        column = cursor.variable("the name of the row variable", "input")
        row: Word | None = None
        cursor.suggest("backslash")
        if cursor.accept("\\"):
            row, column = column, cursor.variable("the name of the column variable", "input")
        columns: list[Word] = []
        cursor.suggest("columns", column)
        while not cursor.at_end:
            columns.append(cursor.term(f"a term of '{column}'", column))
            cursor.suggest("columns", column, columns)
        if not columns:
            cursor.fail(f"the terms of '{column}' that head the columns", (), "missing-header")
        return row, column, tuple(columns)

    def __str__(self) -> str:
        condition = f" when {self.condition}" if self.condition is not None else ""
        return f"rules {', '.join(name_text(part.output) for part in self.parts)}{condition}"

    def below(self) -> list[tuple[str, Trivia]]:
        """Return the header and the rows, aligned."""
        corner = name_text(self.column)
        if self.row is not None:
            corner = f"{name_text(self.row)} \\ {corner}"
        cells = [[corner, *map(name_text, self.columns)]]
        for same in zip(*(part.rows for part in self.parts), strict=True):
            columns = zip(*(row.cells for row in same), strict=True)
            cells.append([name_text(same[0].label), *map(_cell_text, columns)])
        trivia = [self.header_trivia, *(row.trivia for row in self.rows)]
        return list(zip(aligned(cells), trivia, strict=True))

    def mentions(self) -> Iterator[Occurrence]:
        """Yield the names in it."""
        for part in self.parts:
            yield of_variable(part.output)
            terms = (cell.term for row in part.rows for cell in row.cells)
            yield from (of_term(part.output, term) for term in terms if term is not None)
        if self.condition is not None:
            yield from self.condition.mentions()
        if self.row is not None:
            yield of_variable(self.row)
        yield of_variable(self.column)
        yield from (of_term(self.column, word) for word in self.columns)
        for row in self.rows:
            yield of_variable(row.label) if self.row is None else of_term(self.row, row.label)


def _cell_text(cells: Sequence[CellNode]) -> str:
    """Return the text of a cell; one dot if no output has a rule."""
    texts = list(map(str, cells))
    return "." if set(texts) == {"."} else "/".join(texts)


# --- Sentences ---


class RuleNode(NamedTuple):
    """``rule if … then … [with WEIGHT]``."""

    antecedent: ExpressionNode
    consequents: tuple[PropositionNode, ...]
    weight: Figure | None
    span: Span = NOWHERE


def read_conclusion(cursor: Cursor) -> PropositionNode:
    """Read one conclusion of a rule."""
    return PropositionNode.read(cursor, "the name of an output", "output")
