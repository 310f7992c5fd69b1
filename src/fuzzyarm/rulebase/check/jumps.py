"""Neighbouring grid cells whose terms lie far apart."""

from __future__ import annotations

from collections.abc import Iterator

from fuzzyarm.rulebase.check.subject import Subject
from fuzzyarm.rulebase.check.term_order import cells_by_rank, ranks
from fuzzyarm.rulebase.diagnostic import Diagnostic, Related
from fuzzyarm.rulebase.syntax.nodes import CellNode

MOST = 2
"""A control surface may step by so many terms from one cell to the next."""


def find(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``jump`` where a cell and its left or upper neighbour are too far apart."""
    for grid in subject.grids:
        cells = cells_by_rank(grid, subject.rulebase)
        order = ranks(subject.rulebase, grid.output.text)
        if cells is None or order is None:
            continue
        for (row, column), cell in cells.items():
            for neighbour in ((row, column - 1), (row - 1, column)):
                if neighbour in cells:
                    yield from _pair(cell, cells[neighbour], order)


def _pair(cell: CellNode, other: CellNode, order: dict[str, int]) -> Iterator[Diagnostic]:
    if cell.term is None or other.term is None:
        return
    distance = abs(order[cell.term.text] - order[other.term.text])
    if distance > MOST:
        # The finding stands where the later of the two is written.
        later, earlier = sorted((cell, other), key=lambda c: c.span, reverse=True)
        assert later.term is not None
        assert earlier.term is not None
        yield Diagnostic(
            "jump",
            f"'{later.term.text}' lies {distance} terms from its neighbour '{earlier.term.text}'",
            later.span,
            related=(Related("the neighbour", earlier.span),),
        )
