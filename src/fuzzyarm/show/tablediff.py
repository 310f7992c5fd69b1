"""The differences between two tables: which cells changed, from what to what."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fuzzyarm.lut.diff import CellChange, TableDiff
from fuzzyarm.lut.numbers import number
from fuzzyarm.show.table import table_grids
from fuzzyarm.show.words import name_words, number_words

if TYPE_CHECKING:
    from rich.console import Group, RenderableType

MOST_LISTED = 400
"""More changed cells than this are counted, not listed."""


def table_diff_view(diff: TableDiff) -> Group:
    """Return what changed: a summary, the header, a grid of the changes, and each cell."""
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = [Text(summary_words(diff), "bold")]
    if diff.transposed:
        order = ", ".join(map(name_words, diff.before.names))
        parts.append(Text(f"the second table has its inputs in another order than {order}"))
    parts += [Text(f"{what}: {a} -> {b}") for what, a, b in diff.header]
    if diff.changes:
        parts += [Text(), Text("after - before"), *change_grids(diff), Text()]
        parts += [Text(change_words(diff, change)) for change in diff.changes[:MOST_LISTED]]
        rest = len(diff.changes) - MOST_LISTED
        if rest > 0:
            parts.append(Text(f"and {rest} more cells"))
    return Group(*parts)


def summary_words(diff: TableDiff) -> str:
    """Return the outcome of the comparison in one sentence."""
    if not diff.comparable:
        return "the tables cannot be compared cell by cell: their inputs or levels differ"
    count, size = len(diff.changes), diff.before.values.size
    if not count:
        return f"all {size} cells are equal"
    largest = max(diff.changes, key=lambda change: abs(change.after - change.before))
    return (
        f"{count} of {size} cells changed, by up to "
        f"{number_words(abs(largest.after - largest.before), 4)}"
    )


def change_words(diff: TableDiff, change: CellChange) -> str:
    """Return one changed cell as ``e = 1, ce = -2: 0.5 -> 0.7``."""
    place = ", ".join(
        f"{name_words(name)} = {number_words(level)}"
        for name, level in zip(diff.before.names, change.levels, strict=True)
    )
    return f"{place}: {number(change.before)} -> {number(change.after)}"


def change_grids(diff: TableDiff) -> list[RenderableType]:
    """Return heat grids of *after - before*; an unchanged cell is a dot."""
    difference: Any = diff.after.values - diff.before.values
    return table_grids(diff.before, difference, text=_change_text)


def _change_text(x: float) -> str:
    if x == 0:
        return "."
    text = number_words(x, 3)
    return text if x < 0 else f"+{text}"
