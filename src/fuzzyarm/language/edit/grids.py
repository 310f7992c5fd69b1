"""Editing of rule grids: new ones, their rows and columns."""

from __future__ import annotations

import math
from collections.abc import Sequence

from fuzzyarm.base.diagnostic import Span, Word, display_width
from fuzzyarm.language.edit.fixes import Edit
from fuzzyarm.language.edit.lines import (
    ReshapeError,
    demand_sound,
    last_lines,
    line_of_rules,
    lines_behind,
    nodes_of,
    without_line_ranges,
    without_word,
)
from fuzzyarm.language.edit.reading import Reading
from fuzzyarm.language.edit.reshape import add_term
from fuzzyarm.language.model.rulebase import Shape, Variable
from fuzzyarm.language.model.shapes import centre
from fuzzyarm.language.rows import text_of
from fuzzyarm.language.rules import CellNode, GridNode, RowNode
from fuzzyarm.language.tokens import name_text

FILLS = ("empty", "rising", "falling")
"""How the cells of a new grid are filled: with dots, or with terms that go with the inputs."""


def graded(share: float, names: Sequence[str]) -> str:
    """Return the term at a fraction of the range in a list of terms from low to high.

    Ties go away from the middle on both sides alike, so that a grid stays antisymmetric.
    """
    position = share * (len(names) - 1)
    middle = 0.5 * (len(names) - 1)
    distance = abs(position - middle)
    # Of an even number of terms none is in the middle: they lie 0.5, 1.5, … away from it.
    steps = int(distance + 0.5 + 1e-9) if middle == int(middle) else int(distance) + 0.5
    index = middle + (steps if position > middle else -steps)
    if distance < 1e-9:
        index = int(middle)
    return names[int(min(max(index, 0), len(names) - 1))]


def add_grid(
    reading: Reading, output: str, column: str, row: str | None = None, fill: str = "empty"
) -> list[Edit]:
    """Return the edits that add a grid of rules over one input or two, with all their terms.

    Parameters
    ----------
    reading : Reading
        The text.
    output : str
        The concluded output.
    column, row : str
        The inputs that go across and down.
    fill : str, optional
        One of `FILLS`.

    Raises
    ------
    ReshapeError
        If a variable has no terms, or the text would have a mistake with the grid.
    """
    if fill not in FILLS:
        raise ReshapeError(f"a grid is filled {', '.join(FILLS)}, not '{fill}'")
    if row == column:
        raise ReshapeError(f"'{column}' cannot go down and across")
    across = _terms(reading, column)
    down = [output] if row is None else _terms(reading, row)
    concluded = _terms(reading, output)
    rows = []
    for i, label in enumerate(down):
        shares = [_share(j, across) for j in range(len(across))]
        if row is not None:  # the sum of both inputs, each from -1 to 1, held to the range
            shares = [min(1.0, max(0.0, share + _share(i, down) - 0.5)) for share in shares]
        if fill == "falling":
            shares = [1.0 - share for share in shares]
        cells = [None if fill == "empty" else Word(graded(share, concluded)) for share in shares]
        rows.append(RowNode(Word(label), tuple(CellNode(cell, None) for cell in cells)))
    node = GridNode(
        Word(output),
        None,
        None if row is None else Word(row),
        Word(column),
        tuple(map(Word, across)),
        tuple(rows),
    )
    lines = ["", text_of(node), *(line for line, _ in node.below())]
    return demand_sound(reading, [lines_behind(reading, line_of_rules(reading), lines)])


def _share(index: int, names: Sequence[str]) -> float:
    return index / (len(names) - 1) if len(names) > 1 else 0.5


def _terms(reading: Reading, variable: str) -> list[str]:
    """Return the names of the terms of a variable, from low to high."""
    record = reading.variable(variable)
    if record is None:
        raise ReshapeError(f"the text declares no variable '{variable}'")
    if not record.terms:
        raise ReshapeError(f"'{variable}' has no terms yet", hint="add some first")
    order = _order(record)
    return sorted((term.name for term in record.terms), key=order.__getitem__)


def _order(variable: Variable) -> dict[str, tuple[float, int]]:
    """Return the positions of terms by name: their centres, else their order."""
    order = {}
    for index, term in enumerate(variable.terms):
        middle = centre(term.shape, variable.low, variable.high)
        at = middle if middle is not None and math.isfinite(middle) else math.inf
        order[term.name] = (at, index)
    return order


def remove_grid(reading: Reading, line: int) -> list[Edit]:
    """Return the edits that remove the grid that begins on a line.

    Raises
    ------
    ReshapeError
        If none does.
    """
    _grid(reading, line)
    remaining_text = without_line_ranges(reading, [(line, last_lines(reading)[line])])
    return demand_sound(reading, remaining_text)


def _grid(reading: Reading, line: int) -> GridNode:
    for node in nodes_of(reading):
        if isinstance(node, GridNode) and node.span.line == line:
            return node
    raise ReshapeError(f"no grid begins on line {line}")


# --- Rows and columns ---


def add_row(reading: Reading, line: int, term: str, shape: Shape | None = None) -> list[Edit]:
    """Return the edits that add a row of dots to the grid that begins on a line.

    Parameters
    ----------
    reading : Reading
        The text.
    line : int
        Where the grid begins, from 1.
    term : str
        Head of the row, inserted in the order of terms.
    shape : Shape, optional
        Shape of a new term.

    Raises
    ------
    ReshapeError
        If there is no such grid, its rows are not terms, or the term has a row already.
    """
    grid = _grid(reading, line)
    if grid.row is None:
        raise ReshapeError("a grid over one input has one row", hint="add a column, or a grid")
    labels = [row.label for row in grid.rows]
    edits, place = _placed(reading, grid.row, labels, term, shape)
    behind = grid.header_span.line if place == 0 else grid.rows[place - 1].label.span.line
    text = f"  {name_text(term)}"
    for word in grid.columns:
        text = f"{text:<{max(word.span.column - 1, display_width(text) + 2)}}."
    return demand_sound(reading, [*edits, lines_behind(reading, behind, [text])])


def add_column(reading: Reading, line: int, term: str, shape: Shape | None = None) -> list[Edit]:
    """Return the edits that add a column of dots to a grid; as `add_row`."""
    grid = _grid(reading, line)
    labels = list(grid.columns)
    edits, place = _placed(reading, grid.column, labels, term, shape)
    word = name_text(term)
    width = max(display_width(word), 1)
    spans = [
        [column.span for column in grid.columns],
        *(_cells(grid, i) for i in range(len(grid.rows))),
    ]
    if place < len(labels):
        for number, line_spans in enumerate(spans):
            at = line_spans[place]
            text = "." if number else word
            edits.append(Edit(Span(at.line, at.column, at.line, at.column), f"{text:<{width}}  "))
        return demand_sound(reading, edits)
    ends = [span[-1].end_column for span in spans]
    for number, (line_spans, end) in enumerate(zip(spans, ends, strict=True)):
        at = line_spans[-1]
        space = " " * (max(ends) - end + 2)
        text = "." if number else word
        edits.append(Edit(Span(at.line, end, at.line, end), f"{space}{text}"))
    return demand_sound(reading, edits)


def remove_row(reading: Reading, line: int, term: str) -> list[Edit]:
    """Return the edits that remove a row of the grid at a line; the last row removes the grid.

    Raises
    ------
    ReshapeError
        If there is no such grid or row.
    """
    grid = _grid(reading, line)
    lines = [row.label.span.line for row in grid.rows if row.label == term]
    if grid.row is None or not lines:
        raise ReshapeError(f"the grid on line {line} has no row '{term}'")
    if len(grid.rows) == 1:
        return remove_grid(reading, line)
    return demand_sound(reading, without_line_ranges(reading, [(lines[0], lines[0])]))


def remove_column(reading: Reading, line: int, term: str) -> list[Edit]:
    """Return the edits that remove a column of a grid; as `remove_row`."""
    grid = _grid(reading, line)
    labels = list(map(str, grid.columns))
    if term not in labels:
        raise ReshapeError(f"the grid on line {line} has no column '{term}'")
    if len(labels) == 1:
        return remove_grid(reading, line)
    place = labels.index(term)
    spans = [grid.columns[place].span]
    for number in range(len(grid.rows)):
        cells = _cells(grid, number)
        # While a text is written, a row may be shorter than its heads.
        spans += [cells[place]] if place < len(cells) else []
    return demand_sound(reading, [without_word(reading, span) for span in spans])


def _cells(grid: GridNode, row: int) -> list[Span]:
    """Return the spans of the cells of a row; one cell may serve several outputs."""
    parts = [part.rows[row].cells for part in grid.parts]
    return [first.span.to(last.span) for first, last in zip(parts[0], parts[-1], strict=True)]


def _placed(
    reading: Reading, variable: str, labels: Sequence[str], term: str, shape: Shape | None
) -> tuple[list[Edit], int]:
    """Return the edits that declare a new term, and its index among the heads of a grid."""
    record = reading.variable(variable)
    if record is None:
        raise ReshapeError(f"the text declares no variable '{variable}'")
    if term in labels:
        raise ReshapeError(f"the grid has '{term}' already")
    order = _order(record)
    if shape is not None:
        edits = add_term(reading, variable, term, shape)
        middle = centre(shape, record.low, record.high)
        order[term] = (math.inf if middle is None else middle, len(order))
    else:
        edits = []
        if term not in order:
            raise ReshapeError(f"'{variable}' has no term '{term}'")
    later = [i for i, label in enumerate(labels) if label in order and order[label] > order[term]]
    return edits, min(later, default=len(labels))
