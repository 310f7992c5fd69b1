"""A lookup table as a picture: steps over one input, or a page of cells over two."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.base.picture import Axis, Cells, Dots, Level, Line, Panel

if TYPE_CHECKING:
    from fuzzyarm.table import LookupTable


def table_panel(
    table: LookupTable, at: Mapping[str, float], axes: tuple[str, str] = ("", "")
) -> Panel:
    """Return a table as cells, the first row on top, or as a line over its only input."""
    low, high = table.reach
    target = Axis(table.output, "", low, high, about=table.description)
    name, down = (
        (axes if all(axes) else table.names[-2:])[::-1]
        if len(table.axes) > 1
        else (table.names[0], "")
    )
    axis = table.axis(name)
    if len(table.axes) == 1:
        line = Line(axis.levels, table.values, "first", 1.8, steps=True)
        marks = [Level(at[name], upright=True)] if name in at else []
        return Panel([line, *marks], Axis(name, "", *axis.ends, about=axis.description), target)
    down = axes[0] or table.names[-2]
    pages = [axis_name for axis_name in table.names if axis_name not in (down, name)]
    import numpy as np

    order = [table.names.index(axis_name) for axis_name in (*pages, down, name)]
    index = tuple(_page_index(table, axis_name, at) for axis_name in pages)
    values = np.transpose(table.values, order)[index]
    row = table.axis(down)
    parts: list[Cells | Dots] = [Cells(axis.levels, row.levels, values, target, downward=True)]
    if name in at and down in at:
        i, j = (a.cell(at[a.name], table.default_mode) for a in (row, axis))
        parts.append(Dots([axis.levels[j]], [row.levels[i]], "o"))
    right, up = (Axis(a.name, "", *a.ends, about=a.description) for a in (axis, row))
    fixed = {
        axis_name: table.axis(axis_name).levels[k]
        for axis_name, k in zip(pages, index, strict=True)
    }
    return Panel(parts, right, up, _page_words(table, index, fixed))


def _page_index(table: LookupTable, name: str, at: Mapping[str, float]) -> int:
    axis = table.axis(name)
    return int(axis.cell(at.get(name, axis.levels[len(axis.levels) // 2]), "nearest"))


def _page_words(table: LookupTable, index: tuple[int, ...], fixed: Mapping[str, float]) -> str:
    """Return the page of a table in words, with the option for the others."""
    words = ", ".join(f"{name} = {number_words(x, 4)}" for name, x in fixed.items())
    sizes = [len(table.axis(name).levels) for name in fixed]
    count = math.prod(sizes)
    if count <= 1:
        return words
    number = 0
    for size, position in zip(sizes, index, strict=True):
        number = number * size + position
    others = ",".join(f"{name}=…" for name in fixed)
    return f"{words}: page {number + 1} of {count}; --at {others} draws another"
