"""The order of an output's terms along its range, which the shape of a grid is judged by."""

from __future__ import annotations

from fuzzyarm.rulebase.geometry import centre
from fuzzyarm.rulebase.model import RuleBase
from fuzzyarm.rulebase.syntax.nodes import CellNode, GridNode


def ranks(rulebase: RuleBase, name: str) -> dict[str, int] | None:
    """Return the place of each term of the variable `name` by its middle; None for values."""
    variable = rulebase.variable(name)
    middles = {}
    for term in variable.terms:
        middle = centre(term.shape, variable.low, variable.high)
        if middle is None:
            return None
        middles[term.name] = middle
    return {term: i for i, term in enumerate(sorted(middles, key=lambda t: middles[t]))}


def cells_by_rank(grid: GridNode, rulebase: RuleBase) -> dict[tuple[int, int], CellNode] | None:
    """Return the filled cells of a two-input grid by the ranks of row and column terms."""
    if grid.row is None:
        return None
    rows, columns = ranks(rulebase, grid.row.text), ranks(rulebase, grid.column.text)
    if rows is None or columns is None:
        return None
    return {
        (rows[row.label.text], columns[column.text]): cell
        for row in grid.rows
        for cell, column in zip(row.cells, grid.columns, strict=False)
        if cell.term is not None
    }
