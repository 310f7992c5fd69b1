r"""Tables as ``.csv``: the ``.lut`` header in comment lines, then one rectangle of cells.

With two inputs the first line is ``e \ ce`` and the column levels, and each further line a
row level and its values; page inputs stand in columns of their own before the row level.
"""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from itertools import product

from fuzzyarm.lut.header import PlainTable, TableHeader
from fuzzyarm.lut.numbers import column_of_numbers, number
from fuzzyarm.lut.text import ParsedTable, finish, line_tokens, parse_lut, resolve
from fuzzyarm.lut.text_grid import Grid, read_grids
from fuzzyarm.lut.text_header import Header, read_statement
from fuzzyarm.lut.words import KEYWORDS
from fuzzyarm.lut.write_text import header_lines, page_conditions, spelled
from fuzzyarm.rulebase.diagnostic import Diagnostic, Span
from fuzzyarm.rulebase.syntax.cursor import Cursor
from fuzzyarm.rulebase.syntax.tokens import Token, split_lines


def write_csv(table: PlainTable) -> str:
    """Return the text of `table` as comma-separated values."""
    out = io.StringIO()
    for line in header_lines(table):
        out.write(f"# {line}".rstrip() + "\n")
    writer = csv.writer(out, lineterminator="\n")
    columns = [number(x) for x in table.axes[-1].levels]
    texts = column_of_numbers(table.values)
    for k, labels in enumerate(_row_labels(table)):
        if k == 0:
            writer.writerow([*_corner(table), *columns])
        writer.writerow([*labels, *texts[k * len(columns) : (k + 1) * len(columns)]])
    return out.getvalue()


def _corner(table: TableHeader) -> list[str]:
    names = [spelled(name) for name in table.names]
    return [*names[:-2], " \\ ".join(names[-2:])]


def _row_labels(table: TableHeader) -> list[list[str]]:
    if len(table.axes) == 1:
        return [[spelled(table.output)]]
    levels = [axis.levels for axis in table.axes[:-1]]
    return [[number(x) for x in row] for row in product(*levels)]


def parse_csv(text: str, path: str = "<text>") -> ParsedTable:
    """Read what :func:`write_csv` writes; every mistake in one run, never an exception."""
    diagnostics: list[Diagnostic] = []
    header, rows = Header(), []
    for line_number, line in enumerate(split_lines(text), start=1):
        if line.startswith("#"):
            # A space in place of the mark keeps the columns of the diagnostics right.
            tokens = line_tokens(line_number, " " + line[1:], diagnostics)
            if tokens and tokens[0].text in KEYWORDS and tokens[0].text != "grid":
                read_statement(header, Cursor(tokens), diagnostics)
        elif line.strip():
            rows.append((line_number, line))
    if header.version is None:
        return replace(parse_lut("", path), table=None)
    head = resolve(header, diagnostics)
    if head is None:
        return finish(None, None, diagnostics, path)
    grids = _grids(head, rows, diagnostics)
    values = None if grids is None else read_grids(head, grids, diagnostics)
    return finish(head, values, diagnostics, path)


def _grids(
    head: TableHeader, rows: list[tuple[int, str]], diagnostics: list[Diagnostic]
) -> list[Grid] | None:
    """Return the rectangle cut into grids, one for each combination of the pages."""
    pages = len(head.axes[:-2])
    split = [(n, _plain_cells(n, line, diagnostics)) for n, line in rows]
    if not split:
        diagnostics.append(Diagnostic("missing-grid", "there are no values", Span(1, 1, 1, 2)))
        return None
    first, corner = split[0]
    names = [spelled(name) for name in head.names[:pages]]
    if [cell.strip() for cell in corner[:pages]] != names:
        message = f"the first columns must be headed {', '.join(names)}"
        diagnostics.append(Diagnostic("wrong-corner", message, Span(first, 1, first, 2)))
        return None
    conditions = {_key(condition): k for k, condition in enumerate(_page_keys(head))}
    texts = list(page_conditions(head))
    grids: dict[int, Grid] = {}
    for line_number, cells in split[1:]:
        page = conditions.get(_key(cells[:pages]))
        if page is None:
            message = f"{', '.join(cells[:pages])} are no levels of {', '.join(names)}"
            span = Span(line_number, 1, line_number, 2)
            diagnostics.append(Diagnostic("wrong-label", message, span))
            continue
        if page not in grids:
            tokens = line_tokens(line_number, f"grid{texts[page]}", [])
            grids[page] = Grid(tuple(_at_start(token) for token in tokens))
            grids[page].lines.append((first, "  ".join(corner[pages:])))
        grids[page].lines.append((line_number, "  ".join(cells[pages:])))
    return list(grids.values())


def _page_keys(head: TableHeader) -> list[list[str]]:
    return [[number(x) for x in row] for row in product(*(a.levels for a in head.axes[:-2]))]


def _key(cells: list[str]) -> tuple[float | str, ...]:
    key: list[float | str] = []
    for cell in cells:
        try:
            key.append(float(cell))
        except ValueError:
            key.append(cell)
    return tuple(key)


def _at_start(token: Token) -> Token:
    return token._replace(column=1, end=2)


def _plain_cells(line_number: int, line: str, diagnostics: list[Diagnostic]) -> list[str]:
    """Return the cells of a line, each without white space inside, so that it stays one word."""
    try:
        cells = next(csv.reader([line], strict=True))
    except (csv.Error, StopIteration):
        span = Span(line_number, 1, line_number, len(line) + 1)
        diagnostics.append(Diagnostic("bad-csv", "this line is not comma-separated", span))
        return []
    for cell in cells:
        if "#" in cell and "'" not in cell:  # the reader of rows would take it for a comment
            span = Span(line_number, 1, line_number, len(line) + 1)
            message = f"'{cell[:40]}' is not a number"
            diagnostics.append(Diagnostic("not-a-number", message, span))
    return [cell if "\\" in cell or "'" in cell else cell.strip() or "''" for cell in cells]
