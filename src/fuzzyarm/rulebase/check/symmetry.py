"""Grids that are antisymmetric (or symmetric) but for a few cells."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from fuzzyarm.rulebase.check.subject import Subject
from fuzzyarm.rulebase.check.term_order import cells_by_rank, ranks
from fuzzyarm.rulebase.diagnostic import Diagnostic, Related
from fuzzyarm.rulebase.syntax.nodes import CellNode, GridNode

ALMOST = 0.75
"""So large a part of the pairs must mirror for the others to look like slips."""

_Pair = tuple[CellNode, CellNode]


def find(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``broken-antisymmetry`` or ``broken-symmetry`` for each pair that does not fit."""
    for grid in subject.grids:
        order = _ranks_of_used(grid, subject)
        pairs = _telling(_mirror_pairs(grid, subject), grid)
        if order is None or len(pairs) < 4:
            continue
        top = len(order) - 1
        by_rank = {rank: term for term, rank in order.items()}
        odd = [p for p in pairs if _rank(p[0], order) + _rank(p[1], order) != top]
        even = [p for p in pairs if _rank(p[0], order) != _rank(p[1], order)]
        if 0 < len(odd) <= (1.0 - ALMOST) * len(pairs) and len(odd) <= len(even):
            for pair in odd:
                wanted = by_rank[top - _rank(pair[0], order)]
                yield _finding("broken-antisymmetry", "antisymmetric", pair, wanted)
        elif 0 < len(even) <= (1.0 - ALMOST) * len(pairs):
            for pair in even:
                wanted = by_rank[_rank(pair[0], order)]
                yield _finding("broken-symmetry", "symmetric", pair, wanted)


def _ranks_of_used(grid: GridNode, subject: Subject) -> dict[str, int] | None:
    """Return the order of the terms that the grid uses; others would shift its middle."""
    order = ranks(subject.rulebase, grid.output.text)
    if order is None:
        return None
    used = {cell.term.text for row in grid.rows for cell in row.cells if cell.term}
    return {term: i for i, term in enumerate(sorted(used, key=lambda term: order[term]))}


def _telling(pairs: list[_Pair], grid: GridNode) -> list[_Pair]:
    """Leave out pairs of the term that most cells have: they mirror whatever the grid is like."""
    terms = [cell.term.text for row in grid.rows for cell in row.cells if cell.term]
    common, count = Counter(terms).most_common(1)[0] if terms else ("", 0)
    if 2 * count <= len(terms):
        return pairs
    return [p for p in pairs if not all(c.term and c.term.text == common for c in p)]


def _mirror_pairs(grid: GridNode, subject: Subject) -> list[_Pair]:
    cells = cells_by_rank(grid, subject.rulebase)
    if not cells or grid.row is None:
        return []
    last_row = len(subject.rulebase.variable(grid.row.text).terms) - 1
    last_column = len(subject.rulebase.variable(grid.column.text).terms) - 1
    pairs = []
    for (row, column), cell in cells.items():
        mirror = (last_row - row, last_column - column)
        if (row, column) <= mirror and mirror in cells:
            pairs.append((cell, cells[mirror]))
    return pairs


def _rank(cell: CellNode, order: dict[str, int]) -> int:
    return order[cell.term.text] if cell.term else -1


def _finding(name: str, what: str, pair: _Pair, wanted: str) -> Diagnostic:
    earlier, later = sorted(pair, key=lambda cell: cell.span)
    first = pair[0].term.text if pair[0].term else "."
    second = pair[1].term.text if pair[1].term else "."
    if earlier is later:
        return Diagnostic(
            name,
            f"the grid is otherwise {what}, but the middle cell '{first}' is not its own mirror",
            later.span,
        )
    return Diagnostic(
        name,
        f"the grid is otherwise {what}, but '{second}' does not mirror '{first}'",
        pair[1].span,
        hint=f"the mirror of '{first}' is '{wanted}'; one of the two cells is a slip",
        related=(Related("the cell it mirrors", pair[0].span),),
    )
