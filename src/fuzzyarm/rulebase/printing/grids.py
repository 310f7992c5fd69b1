"""Print a grid with its columns aligned, in characters as a terminal shows them."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

from fuzzyarm.rulebase.printing.expressions import expression_text
from fuzzyarm.rulebase.printing.words import figure_text, word_text
from fuzzyarm.rulebase.syntax.nodes import CellNode, GridNode


def grid_lines(node: GridNode) -> tuple[str, list[str]]:
    """Return the first line of a grid and the aligned lines below it, header included."""
    first = f"rules {word_text(node.output)}"
    if node.condition is not None:
        first += f" when {expression_text(node.condition)}"
    corner = word_text(node.column)
    if node.row is not None:
        corner = f"{word_text(node.row)} \\ {corner}"
    cells = [[corner, *map(word_text, node.columns)]]
    cells += [[word_text(row.label), *map(_cell, row.cells)] for row in node.rows]
    return first, aligned(cells)


def _cell(cell: CellNode) -> str:
    if cell.term is None:
        return "."
    weight = f"*{figure_text(cell.weight)}" if cell.weight else ""
    return word_text(cell.term) + weight


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return `rows` as lines indented by two, columns two spaces apart and left-aligned."""
    widths = [0] * max(map(len, rows), default=0)
    for row in rows:
        for i, text in enumerate(row):
            widths[i] = max(widths[i], display_width(text))
    return [
        "  " + "  ".join(pad(text, widths[i]) for i, text in enumerate(row)).rstrip()
        for row in rows
    ]


def display_width(text: str) -> int:
    """Return the number of terminal columns that `text` takes."""
    if text.isascii():
        return len(text)
    return sum(
        0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1
        for c in text
    )


def pad(text: str, width: int) -> str:
    """Return `text` with spaces behind it up to `width` terminal columns."""
    return text + " " * (width - display_width(text))
