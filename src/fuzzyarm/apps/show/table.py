"""Lookup tables as heat grids, fixed or learned."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.show.drawing import Cell, HeatGrid, Scale, number_words, scale_of
from fuzzyarm.base.numbers import column_of_numbers, number_text, short_bins, short_levels
from fuzzyarm.language.tokens import name_text

if TYPE_CHECKING:
    from rich.console import Group, RenderableType
    from rich.text import Text

    from fuzzyarm.table import LookupTable


# --- A lookup table, or any numbers on its axes, as heat grids ---

_MOST_LEVELS = 25
"""Most levels of an input in a grid, unless all are requested."""

_THINNED = 13
"""Levels after thinning."""

_NEVER = "·"
"""Mark of an unused cell."""

Mark = Callable[[tuple[int, ...]], bool]


def table_view(
    table: LookupTable, *, all_levels: bool = False, at: Sequence[float] | None = None
) -> Group:
    """Return a table with its header.

    Parameters
    ----------
    table : LookupTable
        The table to draw.
    all_levels : bool
        Draw every level of a large table.
    at : sequence of float, optional
        Inputs of the marked cell.
    """
    from rich.console import Group
    from rich.text import Text

    mark: Mark | None = None
    lines: list[RenderableType] = []
    if at is not None:
        cell = table.cell(*at)
        inputs = ", ".join(
            f"{name_text(n)} = {number_text(x)}" for n, x in zip(table.names, at, strict=True)
        )
        lines = [Text(f"{inputs} falls into the marked cell [ ].\n")]
        mark = cell.__eq__
    grids = table_grids(table, mark=mark, all_levels=all_levels, more="; --all shows all")
    return Group(_header(table), Text(), *lines, *grids)


def _header(table: LookupTable) -> Text:
    from rich.text import Text

    shape = " x ".join(str(size) for size in table.shape)
    text = Text()
    text.append(f"table of {name_text(table.output)}", "bold")
    text.append(f"  {shape}, looked up by {_MODE_WORDS[table.default_mode]}")
    text.append(f"\n  {table.description}" if table.description else "")
    for axis in table.axes:
        text.append(f"\n{name_text(axis.name)}", "bold")
        text.append(f"  {axis.description}" if axis.description else "")
        text.append(f"\n  levels {short_levels(axis.levels)}")
        if axis.bins:
            text.append(f"\n  bins   {short_bins(axis.bins)}")
    for key, value in table.provenance:
        text.append(f"\n{key}: {value}", "dim")
    return text


_MODE_WORDS = {"bins": "bins", "nearest": "the nearest level", "linear": "linear interpolation"}


def table_grids(
    table: LookupTable,
    values: Any = None,
    *,
    scale: Scale | None = None,
    mark: Mark | None = None,
    unused: Mark | None = None,
    all_levels: bool = False,
    text: Callable[[float], str] | None = None,
    more: str = "",
) -> list[RenderableType]:
    """Return one heat grid for each combination of page levels.

    Parameters
    ----------
    table : LookupTable
        Table with the axes.
    values : array_like, optional
        Numbers in the shape of the table, drawn instead of its values, such as visits.
    scale : Scale, optional
        Colours; by default from the values and the range of the output.
    mark : callable, optional
        Selects the cells in brackets by index.
    unused : callable, optional
        Selects the cells without colour and with a dot before their number.
    all_levels : bool
        Draw every level of a large table.
    text : callable, optional
        Text of a number; by default uniform and without loss.
    more : str, optional
        Text after the note on thinned levels, with the option for all.
    """
    import numpy as np
    from rich.text import Text

    is_own = values is None
    array = table.values if is_own else np.asarray(values)
    indices = [_drawn(size, all_levels=all_levels) for size in array.shape]
    excerpt = array[np.ix_(*indices)]
    if scale is None:
        bounds = (table.low, table.high) if is_own else (None, None)
        scale = scale_of(array.ravel().tolist(), *bounds)
    flat = [float(x) for x in excerpt.ravel()]
    texts = [text(x) for x in flat] if text else _readable(flat)
    drawings: list[RenderableType] = []
    if excerpt.size < array.size:
        drawings.append(Text(_thinned_words(table, indices) + more, "dim"))
    size = excerpt.shape[-1] * (excerpt.shape[-2] if excerpt.ndim > 1 else 1)
    # In memory order: `product` also varies the last index fastest.
    pages = list(product(*indices[:-2]))
    for k, page in enumerate(pages):
        if page:
            drawings.append(Text(_page_words(table, page), "bold"))
        part = slice(k * size, (k + 1) * size)
        cells = _cells(flat[part], texts[part], indices, page, scale, (mark, unused))
        drawings.append(_grid(table, indices, cells))
        if k + 1 < len(pages):
            drawings.append(Text())
    return drawings


def _readable(values: list[float]) -> list[str]:
    texts = column_of_numbers(values)
    return texts if max(map(len, texts)) <= 9 else column_of_numbers(
        [float(number_words(x, 4)) for x in values]
    )  # fmt: skip


def _drawn(size: int, *, all_levels: bool) -> list[int]:
    """Return the indices to draw: all, or evenly thinned including both ends."""
    if all_levels or size <= _MOST_LEVELS:
        return list(range(size))
    return sorted({round(i * (size - 1) / (_THINNED - 1)) for i in range(_THINNED)})


def _thinned_words(table: LookupTable, indices_of_axes: list[list[int]]) -> str:
    parts = [
        f"{len(indices)} of the {len(axis.levels)} levels of {name_text(axis.name)}"
        for axis, indices in zip(table.axes, indices_of_axes, strict=True)
        if len(indices) < len(axis.levels)
    ]
    return f"shown are {' and '.join(parts)}"


def _page_words(table: LookupTable, page: tuple[int, ...]) -> str:
    parts = [
        f"{name_text(axis.name)} = {number_text(axis.levels[i])}"
        for axis, i in zip(table.axes, page, strict=False)
    ]
    return f"when {', '.join(parts)}"


def _cells(
    values: list[float],
    texts: list[str],
    indices_of_axes: list[list[int]],
    page: tuple[int, ...],
    scale: Scale,
    marks: tuple[Mark | None, Mark | None],
) -> list[list[Cell]]:
    mark, unused = marks
    columns = indices_of_axes[-1]
    rows = indices_of_axes[-2] if len(indices_of_axes) > 1 else [None]
    cells: list[list[Cell]] = []
    for i, row in enumerate(rows):
        line: list[Cell] = []
        for j, column in enumerate(columns):
            k = i * len(columns) + j
            index = (*page, *(() if row is None else (row,)), column)
            if mark is not None and mark(index):
                line.append((f"[{texts[k]}]", f"bold {scale.style(values[k])}"))
            elif unused is not None and unused(index):
                line.append((f"{_NEVER}{texts[k]}" if values[k] else _NEVER, "dim"))
            else:
                line.append((texts[k], scale.style(values[k])))
        cells.append(line)
    return cells


def _grid(
    table: LookupTable, indices_of_axes: list[list[int]], cells: list[list[Cell]]
) -> HeatGrid:
    column = table.axes[-1]
    labels = _labels(column.levels, indices_of_axes[-1])
    if len(table.axes) == 1:
        return HeatGrid(column.name, labels, [table.output], cells)
    row = table.axes[-2]
    return HeatGrid(
        f"{row.name} \\ {column.name}", labels, _labels(row.levels, indices_of_axes[-2]), cells
    )


def _labels(levels: Sequence[float], indices: Sequence[int]) -> list[str]:
    """Return labels as short as possible that still differ."""
    values = [levels[i] for i in indices]
    for digits in (4, 6, 9):
        labels = [number_words(x, digits) for x in values]
        if len(set(labels)) == len(labels):
            return labels
    return [number_text(x) for x in values]


# --- Learned tables: values, visits and changes as heat grids ---


def learned_view(
    start: LookupTable, now: LookupTable, visits: Any, name: str, *, with_visits: bool = True
) -> Group:
    """Return one joint's table with changed cells in brackets, and its visits.

    Unvisited cells have no colour, and a dot before their number.

    Parameters
    ----------
    start, now : LookupTable
        Before the training and after, over e and ce.
    visits : array_like of int
        Number of uses of each cell.
    name : str
        Name of the joint.
    with_visits : bool, optional
        Whether to append the grid of visits.
    """
    import numpy as np
    from rich.console import Group
    from rich.text import Text

    counts = np.asarray(visits)
    changed = start.values != now.values
    cells, visited = counts.size, int((counts > 0).sum())
    summary = (
        f"{name}: {visited} of {cells} cells visited, {int(changed.sum())} changed [ ], "
        f"{cells - visited} never visited {_NEVER}"
    )
    parts: list[RenderableType] = [
        Text(summary, "bold"),
        *table_grids(
            now,
            mark=lambda index: bool(changed[index]),
            unused=lambda index: not counts[index],
            text=number_text,
        ),
    ]
    if with_visits:
        # Most visits go to a few cells: a logarithmic scale shows the others.
        shades = np.log10(1.0 + counts)
        texts = iter([_count_text(int(count)) for count in counts.ravel()])
        parts += [
            Text(f"{name}: visits per cell ({_NEVER} never)", "bold"),
            *table_grids(now, shades, scale=scale_of([0.0, *shades.ravel().tolist()]),
                         text=lambda _shade: next(texts)),
        ]  # fmt: skip
    return Group(*parts, Text())


def _count_text(count: int) -> str:
    if count == 0:
        return _NEVER
    return str(count) if count < 100_000 else f"{number_words(count / 1000, 3)}k"
