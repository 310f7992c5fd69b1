"""Write a table as ``.lut`` text: a header and aligned grids, one row of cells to a line."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from fuzzyarm.lut.header import PlainTable, TableHeader
from fuzzyarm.lut.numbers import column_of_numbers, number, short_bins, short_levels
from fuzzyarm.lut.words import KEYWORDS
from fuzzyarm.rulebase.syntax.tokens import is_plain_name, quote
from fuzzyarm.rulebase.syntax.words import RESERVED

FORMAT = "fuzzyarm-table"
VERSION = 1

_WIDTH = 78


def write_lut(table: PlainTable) -> str:
    """Return the text of `table`; :func:`fuzzyarm.lut.parse_lut` reads back the same table."""
    lines = [*header_lines(table), ""]
    columns = len(table.axes[-1].levels)
    texts = column_of_numbers(table.values)
    if len(table.axes) == 1:
        labels = [spelled(table.axes[0].name), spelled(table.output)]
        cells = [[number(x) for x in table.axes[0].levels], texts]
        return "\n".join([*lines, "grid", *_aligned(labels, cells), ""])
    rows = len(table.axes[-2].levels)
    size = rows * columns
    row, column = table.axes[-2], table.axes[-1]
    corner = f"{spelled(row.name)} \\ {spelled(column.name)}"
    labels = [corner, *(number(x) for x in row.levels)]
    blocks = []
    for k, condition in enumerate(page_conditions(table)):
        page = texts[k * size : (k + 1) * size]
        cells = [[number(x) for x in column.levels]]
        cells += [page[i * columns : (i + 1) * columns] for i in range(rows)]
        blocks.append("\n".join([f"grid{condition}", *_aligned(labels, cells)]))
    return "\n".join([*lines, "\n\n".join(blocks), ""])


def header_lines(table: TableHeader) -> list[str]:
    """Return the lines of the header, from the format to the provenance."""
    lines = [f"{FORMAT} {VERSION}", ""]
    lines += _variable_lines(table)
    lines += ["", f"index   {', '.join(index_words(table))}"]
    lines += _axis_lines("levels", [(a.name, short_levels(a.levels)) for a in table.axes])
    binned = [(a.name, short_bins(a.bins)) for a in table.axes if a.bins]
    lines += _axis_lines("bins", binned, len(table.axes))
    if table.rounding is not None:
        lines.append(f"round   {number(table.rounding)}")
    if table.mode is not None:
        lines.append(f"mode    {table.mode}")
    if table.provenance:
        keys = [k if is_plain_name(k) else quote(k, "'") for k, _ in table.provenance]
        widest = max(map(len, keys))
        lines.append("")
        for key, (_, value) in zip(keys, table.provenance, strict=True):
            lines.append(f"origin  {key:<{widest}}  {quote(value, chr(34))}")
    return lines


def index_words(table: TableHeader) -> list[str]:
    """Return ``page a``, ``row e``, ``column ce``: the order of the indices by name."""
    names = [spelled(name) for name in table.names]
    places = ["page"] * max(0, len(names) - 2) + ["row", "column"][-len(names) :]
    return [f"{place} {name}" for place, name in zip(places, names, strict=True)]


def page_conditions(table: TableHeader) -> Iterator[str]:
    """Yield `` when a = 1, b = 2`` for every combination of the page levels, in order."""
    pages = table.axes[:-2]
    for levels in product(*(axis.levels for axis in pages)):
        parts = [f"{spelled(a.name)} = {number(x)}" for a, x in zip(pages, levels, strict=True)]
        yield f" when {', '.join(parts)}" if parts else ""


def spelled(name: str) -> str:
    """Return `name` as it stands in a file: in single quotes where it must."""
    plain = is_plain_name(name) and name not in RESERVED and name not in KEYWORDS
    return name if plain else quote(name, "'")


def _variable_lines(table: TableHeader) -> list[str]:
    rows = [("input", spelled(a.name), _span(a.low, a.high), a.description) for a in table.axes]
    rows.append(("output", spelled(table.output), _span(table.low, table.high), table.description))
    names = max(len(name) for _, name, _, _ in rows)
    spans = max(len(span) for _, _, span, _ in rows)
    lines = []
    for word, name, span, description in rows:
        text = quote(description, chr(34)) if description else ""
        lines.append(f"{word:<6}  {name:<{names}}  {span:<{spans}}  {text}".rstrip())
    return lines


def _span(low: float | None, high: float | None) -> str:
    if low is None or high is None:
        return ""
    return f"{number_or_inf(low)} .. {number_or_inf(high)}"


def number_or_inf(x: float) -> str:
    """Return `x` as the language writes it."""
    return number(x) if abs(x) != float("inf") else ("inf" if x > 0 else "-inf")


def _axis_lines(word: str, texts: list[tuple[str, str]], count: int | None = None) -> list[str]:
    """Return one line for each distinct text, without names where it holds for every axis."""
    groups: dict[str, list[str]] = {}
    for name, text in texts:
        groups.setdefault(text, []).append(spelled(name))
    if len(groups) == 1 and len(texts) == (count or len(texts)):
        return [f"{word:<6}  {text}" for text in groups]
    return [f"{word:<6}  {', '.join(names)}: {text}" for text, names in groups.items()]


def _aligned(labels: list[str], cells: list[list[str]]) -> list[str]:
    left = max(map(len, labels))
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    gap = "  " if left + sum(widths) + 2 * len(widths) <= _WIDTH else " "
    return [
        f"  {label:>{left}}  " + gap.join(f"{c:>{w}}" for c, w in zip(row, widths, strict=True))
        for label, row in zip(labels, cells, strict=True)
    ]
