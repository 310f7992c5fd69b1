"""Tables as ``.lut`` text: the header and the grids of values, read and written. No numpy.

All mistakes are found in one run, each at its position. Comments (``#`` to the end of the line) are
not kept: information worth keeping belongs in an ``origin`` line.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

from fuzzyarm.base.diagnostic import MAX_DIAGNOSTICS, Diagnostic, Span, split_lines
from fuzzyarm.base.names import did_you_mean, near_hint
from fuzzyarm.base.numbers import column_of_numbers, counted, number_text
from fuzzyarm.language.tokens import Cursor, Fault, Token, tokenize_line
from fuzzyarm.table.axis import Axis, PlainTable, TableHeader
from fuzzyarm.table.header import KEYWORDS, Header, header_lines, read_statement, resolve, spelled

# --- The whole text ---

MAX_CHARACTERS = 64_000_000
"""Longest accepted table text."""

MOST_CELLS = 1_000_000
"""Most cells in text form: 200 bytes of memory each, and every such text can be read."""


@dataclass(frozen=True, slots=True)
class ParsedTable:
    """The result of parsing a text.

    Attributes
    ----------
    table : PlainTable or None
        None if the diagnostics contain an error.
    diagnostics : tuple of Diagnostic
        Every finding, in the order of the text.
    header : TableHeader or None
        Axes and output where at least these could be made out.
    """

    table: PlainTable | None
    diagnostics: tuple[Diagnostic, ...]
    header: TableHeader | None = None


def parse_lut(text: str, path: str = "<text>") -> ParsedTable:
    """Read the text of a ``.lut`` file.

    Parameters
    ----------
    text : str
        Anything at all; this function does not raise.
    path : str
        Named in the diagnostics.

    Returns
    -------
    ParsedTable
        The table, or the faults of the text.
    """
    diagnostics: list[Diagnostic] = []
    header, grids = _scan(text, diagnostics)
    if header.version is None:
        # A file that is not a table has a mistake in every line: report a few of them.
        return finish(None, None, [_no_format(text), *diagnostics][:20], path)
    head = resolve(header, diagnostics)
    values = read_grids(head, grids, diagnostics) if head else None
    return finish(head, values, diagnostics, path)


def finish(
    head: TableHeader | None,
    values: list[float] | None,
    diagnostics: list[Diagnostic],
    path: str,
) -> ParsedTable:
    """Sort the findings, name their file, and make the table if none is an error."""
    unique = dict.fromkeys(sorted(diagnostics, key=lambda d: d.span))
    findings = tuple(replace(d, path=path) for d in list(unique)[:MAX_DIAGNOSTICS])
    if head is None or values is None or any(d.is_error for d in findings):
        return ParsedTable(None, findings, head)
    return ParsedTable(PlainTable(**head.head(), values=tuple(values)), findings, head)


def _scan(text: str, diagnostics: list[Diagnostic]) -> tuple[Header, list[TextGrid]]:
    header = Header()
    grids: list[TextGrid] = []
    for number, line in enumerate(split_lines(text), start=1):
        bare = line.lstrip()
        if not bare or bare[0] == "#":
            continue
        # Rows of a grid are kept as text: tokens of millions of cells would take minutes.
        first = bare.split(None, 1)[0].split("#", 1)[0]
        if grids and first not in KEYWORDS:
            grids[-1].lines.append((number, line))
            continue
        tokens = line_tokens(number, line, diagnostics)
        if not tokens:
            continue
        word = tokens[0].text if tokens[0].kind == "name" else ""
        if word == "grid":
            grids.append(TextGrid(tokens))
        elif word in KEYWORDS:
            read_statement(header, Cursor(tokens), diagnostics)
        else:
            diagnostics.append(_unknown_word(tokens))
    return header, grids


def line_tokens(number: int, line: str, diagnostics: list[Diagnostic]) -> tuple[Token, ...]:
    """Return the tokens of one line, the `number`-th of the text."""
    return tokenize_line(number, line, diagnostics).tokens


def _unknown_word(tokens: tuple[Token, ...]) -> Diagnostic:
    word = tokens[0]
    hint, replacement = near_hint(word.text, KEYWORDS)
    return Diagnostic(
        "unknown-keyword",
        f"a line of a table cannot start with '{word.text[:40]}'",
        word.span,
        hint=hint or f"lines start with {', '.join(KEYWORDS)}",
        replacement=replacement,
    )


def _no_format(text: str) -> Diagnostic:
    return Diagnostic(
        "missing-format",
        "not a lookup table: its first line must be 'fuzzyarm-table 1'",
        Span(1, 1, 1, 2),
    )


# --- The grids, read against the axes that the header promises ---

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?\Z")
_WORD = re.compile(r"[^\s]+")


@dataclass(slots=True)
class TextGrid:
    """The ``grid`` line and the lines below it."""

    tokens: tuple[Token, ...]
    lines: list[tuple[int, str]] = field(default_factory=list)

    @property
    def span(self) -> Span:
        """The span of the ``grid`` line."""
        return self.tokens[0].span.to(self.tokens[-1].span)


@dataclass(frozen=True, slots=True)
class TextCell:
    """One cell of text and its position."""

    text: str
    span: Span


def read_grids(
    head: TableHeader, grids: Sequence[TextGrid], diagnostics: list[Diagnostic]
) -> list[float] | None:
    """Return the values, the last axis fastest; None if any is missing or at fault."""
    pages = head.shape[:-2]
    size = math.prod(head.shape[-2:])
    count = math.prod(pages)
    filled: dict[int, Span] = {}
    values: dict[int, list[float]] = {}
    for grid in grids:
        page = _page_index(head, grid, diagnostics)
        if page is not None and page in filled:
            message = f"this grid has been given already in line {filled[page].line}"
            diagnostics.append(Diagnostic("duplicate-grid", message, grid.span))
        elif page is not None:
            filled[page] = grid.span
        block = _GridReader(head, grid, diagnostics).read()
        if page is not None and block is not None and len(block) == size:
            values[page] = block
    if len(filled) < count:
        _report_missing_pages(head, filled, count, grids, diagnostics)
    if len(values) < count:
        return None
    return [x for page in range(count) for x in values[page]]


def _report_missing_pages(
    head: TableHeader,
    filled: dict[int, Span],
    count: int,
    grids: Sequence[TextGrid],
    diagnostics: list[Diagnostic],
) -> None:
    where = grids[-1].span if grids else Span(1, 1, 1, 2)
    missing = count - len(filled)
    condition = next(c for k, c in enumerate(_page_conditions(head)) if k not in filled)
    more = f" and {missing - 1} more" if missing > 1 else ""
    diagnostics.append(Diagnostic("missing-grid", f"there is no 'grid{condition}'{more}", where))


def _page_index(head: TableHeader, grid: TextGrid, diagnostics: list[Diagnostic]) -> int | None:
    """Return the page index selected by the ``when`` of a grid."""
    pages = {axis.name: axis for axis in head.axes[:-2]}
    indices: dict[str, int] = {}
    cursor = Cursor(grid.tokens)
    cursor.take()
    try:
        if cursor.accept("when"):
            while True:
                name, index = _page_level(cursor, pages)
                indices[name] = index
                if not cursor.accept(","):
                    break
        cursor.finish()
    except Fault as fault:
        diagnostics.append(fault.diagnostic)
        return None
    missing = [name for name in pages if name not in indices]
    if missing:
        diagnostics.append(
            Diagnostic(
                "incomplete-page",
                f"the grid does not say for which '{missing[0]}' it is",
                grid.span,
                hint=f"write: grid when {', '.join(f'{name} = …' for name in pages)}",
            )
        )
        return None
    index = 0
    for name, axis in pages.items():
        index = index * len(axis.levels) + indices[name]
    return index


def _page_level(cursor: Cursor, pages: dict[str, Axis]) -> tuple[str, int]:
    name = cursor.name("the name of a page input")
    if name not in pages:
        hint, replacement = near_hint(name, pages)
        raise Fault(
            Diagnostic(
                "unknown-variable",
                f"'{name}' is not a page of the index order",
                name.span,
                hint=hint,
                replacement=replacement,
            )
        )
    cursor.expect("=", "before the level")
    figure = cursor.figure("a level")
    levels = pages[name].levels
    if figure not in levels:
        message = f"{figure:g} is not a level of '{name}'"
        raise Fault(Diagnostic("wrong-label", message, figure.span))
    return name, levels.index(figure)


class _GridReader:
    """The reading of one grid."""

    def __init__(self, head: TableHeader, grid: TextGrid, diagnostics: list[Diagnostic]) -> None:
        self.head = head
        self.grid = grid
        self.diagnostics = diagnostics
        self.column = head.axes[-1]
        self.row = head.axes[-2] if len(head.axes) > 1 else None

    def read(self) -> list[float] | None:
        """Return the values of the grid row by row, or None."""
        if not self.grid.lines:
            self._report("missing-rows", "the grid has no lines", self.grid.span)
            return None
        number, line = self.grid.lines[0]
        sound = self._read_head(number, line)
        rows = self.grid.lines[1:]
        if self.row is None:
            return self._read_single(rows) if sound else None
        labels: list[float | None] = []
        values: list[float] = []
        for row_number, text in rows:
            label, cells = self._read_row(row_number, text)
            labels.append(label)
            values += cells
        fits = self._check_labels(labels, rows)
        return values if sound and fits else None

    def _read_head(self, number: int, line: str) -> bool:
        """Check the line with the names and the column levels."""
        names, rest = _names_and_rest(number, line)
        names_expected = (
            [self.column.name] if self.row is None else [self.row.name, self.column.name]
        )
        if names is None or [token.text for token in names] != names_expected:
            self._report_corner(names, names_expected, number, line)
            return False
        cells = _cells(number, line, rest)
        return self._check_levels(cells, self.column, number, line)

    def _report_corner(
        self, names: list[Token] | None, expected: list[str], number: int, line: str
    ) -> None:
        spell = " \\ ".join(expected)
        if not names:
            span = Span(number, 1, number, len(line) + 1)
            message = f"the first line of a grid starts with '{spell}'"
            self._report("missing-corner", message, span)
            return
        span = names[0].span.to(names[-1].span)
        names_there = [token.text for token in names]
        corner = " \\ ".join(names_there)
        if names_there == expected[::-1]:
            self._report(
                "transposed-labels",
                f"the corner '{corner}' contradicts the index order "
                f"(row {expected[0]}, column {expected[1]})",
                span,
                hint="is the table transposed? change the index order or the corner, not both",
            )
            return
        self._report(
            "wrong-corner",
            f"the grid is headed '{corner}', the index order needs '{spell}'",
            span,
        )

    def _check_levels(self, cells: list[TextCell], axis: Axis, number: int, line: str) -> bool:
        values = [self._number(cell) for cell in cells]
        if None in values:
            return False
        if values == list(axis.levels):
            return True
        span = cells[0].span.to(cells[-1].span) if cells else _line_end(number, line)
        if self.row is not None and values == list(self.row.levels):
            self._report(
                "transposed-labels",
                f"the columns are labelled with the levels of '{self.row.name}', "
                f"the index order says column {axis.name}",
                span,
                hint="is the table transposed?",
            )
        elif len(values) != len(axis.levels):
            self._report(
                "wrong-cell-count",
                f"{counted(len(values), 'column')}, but '{axis.name}' has "
                f"{counted(len(axis.levels), 'level')}",
                span,
            )
        else:
            k = next(k for k, x in enumerate(values) if x != axis.levels[k])
            self._report(
                "wrong-label",
                f"column {k + 1} is labelled {values[k]:g}, the level of '{axis.name}' "
                f"is {axis.levels[k]:g}",
                cells[k].span,
            )
        return False

    def _read_row(self, number: int, line: str) -> tuple[float | None, list[float]]:
        # Fast path for a sound row; the rest only diagnoses others.
        words = line.split("#", 1)[0].split()
        if len(words) == len(self.column.levels) + 1 and all(map(_NUMBER.match, words)):
            numbers = [float(word) for word in words]
            if all(map(math.isfinite, numbers)):
                return numbers[0], numbers[1:]
        cells = _cells(number, line, 0)
        numbers_or_none = [self._number(cell) for cell in cells]
        self._check_count(cells, number, line)
        return next(iter(numbers_or_none), None), []

    def _check_count(self, cells: list[TextCell], number: int, line: str) -> None:
        count, count_expected = max(0, len(cells) - 1), len(self.column.levels)
        if count == count_expected:
            return
        extra = cells[count_expected + 1 :]
        span = extra[0].span.to(extra[-1].span) if extra else _line_end(number, line)
        self._report(
            "wrong-cell-count",
            f"the row has {counted(count, 'cell')}, '{self.column.name}' has "
            f"{counted(count_expected, 'level')}",
            span,
        )

    def _check_labels(self, labels: list[float | None], rows: list[tuple[int, str]]) -> bool:
        assert self.row is not None
        levels = self.row.levels
        if labels == list(levels):
            return True
        sound = [label for label in labels if label is not None]
        whole = self.grid.span
        if rows:
            whole = Span(rows[0][0], 1, rows[-1][0], len(rows[-1][1]) + 1)
        if sound == list(self.column.levels) and levels != self.column.levels:
            self._report(
                "transposed-labels",
                f"the rows are labelled with the levels of '{self.column.name}', "
                f"the index order says row {self.row.name}",
                whole,
                hint="is the table transposed?",
            )
            return False
        for label, level, (number, line) in zip(labels, levels, rows, strict=False):
            if label is not None and label != level:
                self._report(
                    "wrong-label",
                    f"the row is labelled {label:g}, the level of '{self.row.name}' is {level:g}",
                    _cells(number, line, 0)[0].span,
                )
                break
        if len(labels) != len(levels):
            name = "missing-row" if len(labels) < len(levels) else "extra-row"
            extra = rows[len(levels)] if len(labels) > len(levels) else None
            self._report(
                name,
                f"the grid has {counted(len(labels), 'row')}, '{self.row.name}' has "
                f"{counted(len(levels), 'level')}",
                Span(extra[0], 1, extra[0], len(extra[1]) + 1) if extra else self.grid.span,
            )
        return False

    def _read_single(self, rows: list[tuple[int, str]]) -> list[float] | None:
        """Read the one row of a table with one input: the output's name and the values."""
        if len(rows) != 1:
            name = "missing-row" if not rows else "extra-row"
            span = Span(rows[1][0], 1, rows[1][0], len(rows[1][1]) + 1) if rows else self.grid.span
            message = f"a table of one input has one row, not {len(rows)}"
            self._report(name, message, span)
            return None
        number, line = rows[0]
        names, rest = _names_and_rest(number, line)
        if names is None or [token.text for token in names] != [self.head.output]:
            message = f"the row of values starts with the output '{self.head.output}'"
            cells = _cells(number, line, 0)
            span = cells[0].span if cells else _line_end(number, line)
            self._report("wrong-label", message, span)
            return None
        cells = _cells(number, line, rest)
        values = [self._number(cell) for cell in cells]
        # The first cell counts for the label, which other rows have among theirs.
        self._check_count([TextCell("", self.grid.span), *cells], number, line)
        return [x for x in values if x is not None]

    def _number(self, cell: TextCell) -> float | None:
        if _NUMBER.match(cell.text):
            value = float(cell.text)
            if math.isfinite(value):
                return value
            self._report("not-a-number", f"'{cell.text[:40]}' is too large for a number", cell.span)
            return None
        hint, replacement = "", None
        mended = cell.text.replace("\u2212", "-").replace(",", ".")
        if mended != cell.text and _NUMBER.match(mended):
            hint, replacement = did_you_mean(mended), mended
        message = f"'{cell.text[:40]}' is not a number"
        self._report("not-a-number", message, cell.span, hint, replacement)
        return None

    def _report(
        self, name: str, message: str, span: Span, hint: str = "", replacement: str | None = None
    ) -> None:
        self.diagnostics.append(Diagnostic(name, message, span, hint=hint, replacement=replacement))


def _names_and_rest(number: int, line: str) -> tuple[list[Token] | None, int]:
    r"""Return the names at the start of a line (``e`` or ``e \ ce``) and the index after them."""
    tokens = line_tokens(number, line, [])
    names: list[Token] = []
    end = 0
    for k, token in enumerate(tokens):
        if k % 2 == 0:
            if token.kind not in ("name", "quoted"):
                return None, 0
            names.append(token)
            end = token.end - 1
        elif not (token.kind == "mark" and token.text == "\\"):
            break
    return names, end


def _cells(number: int, line: str, start: int) -> list[TextCell]:
    """Return the words of `line` from offset `start` to a comment."""
    stop = line.find("#", start)
    return [
        TextCell(m.group(), Span(number, m.start() + 1, number, m.end() + 1))
        for m in _WORD.finditer(line, start, len(line) if stop < 0 else stop)
    ]


def _line_end(number: int, line: str) -> Span:
    end = len(line.split("#", 1)[0].rstrip()) + 1
    return Span(number, end, number, end + 1)


def _page_conditions(table: TableHeader) -> Iterator[str]:
    """Yield the condition of every page, in order."""
    for levels in product(*(axis.levels for axis in table.axes[:-2])):
        yield page_condition(table, levels)


def page_condition(table: TableHeader, levels: Sequence[float]) -> str:
    """Return `` when a = 1, b = 2`` for some levels of the page inputs."""
    pairs = zip(table.names[:-2], levels, strict=True)
    parts = [f"{spelled(name)} = {number_text(x)}" for name, x in pairs]
    return f" when {', '.join(parts)}" if parts else ""


# --- Writing: a header and aligned grids, one row of cells to a line ---

_WIDTH = 78


def write_lut(table: PlainTable) -> str:
    """Return the text of `table`; :func:`fuzzyarm.table.parse_lut` reads back the same table.

    Parameters
    ----------
    table : PlainTable
        The table.
    """
    lines = [*header_lines(table), ""]
    columns = len(table.axes[-1].levels)
    texts = column_of_numbers(table.values)
    if len(table.axes) == 1:
        labels = [spelled(table.axes[0].name), spelled(table.output)]
        cells = [[number_text(x) for x in table.axes[0].levels], texts]
        return "\n".join([*lines, "grid", *_aligned(labels, cells), ""])
    rows = len(table.axes[-2].levels)
    size = rows * columns
    row, column = table.axes[-2], table.axes[-1]
    corner = f"{spelled(row.name)} \\ {spelled(column.name)}"
    labels = [corner, *(number_text(x) for x in row.levels)]
    blocks = []
    for k, condition in enumerate(_page_conditions(table)):
        page = texts[k * size : (k + 1) * size]
        cells = [[number_text(x) for x in column.levels]]
        cells += [page[i * columns : (i + 1) * columns] for i in range(rows)]
        blocks.append("\n".join([f"grid{condition}", *_aligned(labels, cells)]))
    return "\n".join([*lines, "\n\n".join(blocks), ""])


def _aligned(labels: list[str], cells: list[list[str]]) -> list[str]:
    left = max(map(len, labels))
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    gap = "  " if left + sum(widths) + 2 * len(widths) <= _WIDTH else " "
    return [
        f"  {label:>{left}}  " + gap.join(f"{c:>{w}}" for c, w in zip(row, widths, strict=True))
        for label, row in zip(labels, cells, strict=True)
    ]
