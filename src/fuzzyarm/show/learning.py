"""What self-organizing control has learned: tables, visits and changes as heat grids."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fuzzyarm.lut.numbers import number
from fuzzyarm.show.scale import scale_of
from fuzzyarm.show.table import table_grids
from fuzzyarm.show.words import number_words

if TYPE_CHECKING:
    from rich.console import Group, RenderableType

    from fuzzyarm.lut import LookupTable

NEVER = "·"
"""Stands in the grid of visits where a cell was never used."""


def learned_view(
    start: LookupTable, now: LookupTable, visits: Any, name: str, *, with_visits: bool = True
) -> Group:
    """Return one joint's table with the cells that changed in brackets, and its visits.

    Parameters
    ----------
    start, now : LookupTable
        Before the training and now, over e and ce.
    visits : array_like of int
        How often each cell was used.
    name : str
        Of the joint.
    with_visits : bool, optional
        Whether the grid of visits follows.
    """
    import numpy as np
    from rich.console import Group
    from rich.text import Text

    counts = np.asarray(visits)
    changed = start.values != now.values
    parts: list[RenderableType] = [
        Text(f"{name}: {learned_words(changed, counts)}", "bold"),
        *table_grids(now, mark=lambda index: bool(changed[index]), text=number),
    ]
    if with_visits:
        # Most visits go to a few cells: colours by the logarithm tell the others apart.
        shades = np.log10(1.0 + counts)
        texts = iter([_count_text(int(each)) for each in counts.ravel()])
        parts += [
            Text(f"{name}: visits per cell ({NEVER} never)", "bold"),
            *table_grids(now, shades, scale=scale_of([0.0, *shades.ravel().tolist()]),
                         text=lambda _shade: next(texts)),
        ]  # fmt: skip
    return Group(*parts, Text())


def learned_words(changed: Any, visits: Any) -> str:
    """Return how many cells were used, changed and never used."""
    cells = int(visits.size)
    used = int((visits > 0).sum())
    return (
        f"{used} of {cells} cells visited, {int(changed.sum())} changed [ ], "
        f"{cells - used} never visited"
    )


def _count_text(count: int) -> str:
    if count == 0:
        return NEVER
    return str(count) if count < 100_000 else f"{number_words(count / 1000, 3)}k"
