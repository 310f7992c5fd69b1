"""Read and write tables as files; the suffix selects the format.

To add a format: ``write_<suffix>(PlainTable) -> str`` and ``parse_<suffix>(text, path) ->
ParsedTable``, which never raises and reports findings with their positions; a record in `_TEXTS`;
the suffix in ``TABLES`` of :mod:`fuzzyarm.base.folders`. ``tests/table/test_table_files.py`` sends
every suffix through the same round trips.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fuzzyarm.base.diagnostic import Diagnostic, RuleBaseError, Span, split_lines
from fuzzyarm.base.files import write_atomically
from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.base.keywords import demand_path
from fuzzyarm.base.names import printable
from fuzzyarm.base.numbers import column_of_numbers, number_text
from fuzzyarm.base.protected import note_source
from fuzzyarm.base.value_kinds import TABLE, wrong_kind
from fuzzyarm.language.tokens import Cursor, Token
from fuzzyarm.table.axis import SUFFIXES, Axis, PlainTable, TableError, TableHeader
from fuzzyarm.table.header import (
    FORMAT,
    KEYWORDS,
    VERSION,
    Header,
    header_lines,
    read_statement,
    resolve,
    spelled,
)
from fuzzyarm.table.text import (
    MAX_CHARACTERS,
    MOST_CELLS,
    ParsedTable,
    TextGrid,
    finish,
    line_tokens,
    page_condition,
    parse_lut,
    read_grids,
    write_lut,
)

if TYPE_CHECKING:
    from fuzzyarm.table.table import LookupTable


LATEX = ".tex"
"""A table for print: written, never read."""


class TableFileError(RuleBaseError):
    """A file that is not a table; ``diagnostics`` have the faults with positions."""


def read_table(path: str | Path) -> LookupTable:
    """Return the table in a ``.lut``, ``.csv``, ``.npz`` or ``.json`` file.

    Parameters
    ----------
    path : path-like
        The file.

    Raises
    ------
    TableFileError
        If the file is at fault; it carries every finding.
    TableError
        If the suffix is none of these.
    OSError
        If the file cannot be read.
    """
    from fuzzyarm.table.table import LookupTable

    path = Path(demand_path("read_table", path))
    if path.suffix.lower() not in SUFFIXES:
        raise _unknown_suffix(path)
    note_source(path)
    if path.suffix.lower() == ".npz":
        return _read_npz(path.read_bytes(), str(path))
    parsed = parse_table(path.read_bytes(), str(path))
    if parsed.table is None:
        raise TableFileError(parsed.diagnostics)
    return LookupTable.from_plain(parsed.table)


def parse_table(data: bytes, path: str) -> ParsedTable:
    """Parse the bytes of a text table, by the suffix of `path`; never raise."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8", "replace")
        line = before.count("\n") + 1
        column = len(before) - (before.rfind("\n") + 1) + 1
        message = f"not UTF-8: byte 0x{data[error.start]:02x}"
        return _fault("not-text", message, path, Span(line, column, line, column + 1))
    if len(text) > MAX_CHARACTERS:
        message = f"a table of more than {MAX_CHARACTERS:,} characters is not read"
        return _fault("too-large", message, path)
    return _TEXTS.get(Path(path).suffix.lower(), _TEXTS[".lut"]).parse(text, path)


def write_table(table: LookupTable, path: str | Path) -> None:
    """Write `table` whole or not at all; :func:`read_table` gives back an equal table.

    Parameters
    ----------
    table : LookupTable
        The table.
    path : path-like
        Its suffix is the format.

    Raises
    ------
    TableError
        If the suffix is none of ``.lut``, ``.csv``, ``.npz``, ``.json``, ``.tex``, or the table has
        more than 1,000,000 cells and is no ``.npz``.
    OSError
        If the folder cannot be written.
    """
    from fuzzyarm.table.table import LookupTable

    if not isinstance(table, LookupTable):
        raise wrong_kind(table, TABLE)
    path = Path(demand_path("write_table", path))
    write_atomically(path, table_as(table, path.suffix.lower(), path))


def table_as(table: LookupTable, suffix: str, path: str | Path = "") -> str | bytes:
    """Return the content of a file of `table` with the given suffix."""
    if suffix in {*_TEXTS, LATEX} and table.values.size > MOST_CELLS:
        message = f"{table.values.size:,} cells are not written as {suffix}: at most {MOST_CELLS:,}"
        raise TableError(message, hint="an .npz takes any table")
    if suffix in _TEXTS:
        return _TEXTS[suffix].write(table.plain())
    if suffix == ".npz":
        return _npz_bytes(table)
    if suffix == LATEX:
        return write_latex(table.plain())
    raise _unknown_suffix(Path(path))


def _unknown_suffix(path: Path) -> TableError:
    return TableError(
        f"'{path.name}' has no suffix of a table", hint=f"tables are {', '.join(SUFFIXES)}"
    )


# --- Tables as `.csv`: the `.lut` header in comment lines, then one rectangle of cells ---
#
# With two inputs the first line is `e \ ce` and the column levels, and each further line a row
# level and its values; page inputs have their own columns before the row level.


def _write_csv(table: PlainTable) -> str:
    """Return the text of `table` as comma-separated values."""
    out = io.StringIO()
    for line in header_lines(table):
        out.write(f"# {line}".rstrip() + "\n")
    writer = csv.writer(out, lineterminator="\n")
    columns = [number_text(x) for x in table.axes[-1].levels]
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
    return [[number_text(x) for x in row] for row in product(*levels)]


def parse_csv(text: str, path: str = "<text>") -> ParsedTable:
    """Read the format of :func:`_write_csv`; all mistakes in one run, never an exception."""
    diagnostics: list[Diagnostic] = []
    header, rows = Header(), []
    for line_number, line in enumerate(split_lines(text), start=1):
        if line.startswith("#"):
            # A space instead of the mark: columns of diagnostics stay correct.
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
) -> list[TextGrid] | None:
    """Return the rectangle cut into grids, one for each combination of the pages."""
    pages = len(head.axes[:-2])
    split = [(n, _plain_cells(n, line, diagnostics)) for n, line in rows]
    if not split:
        diagnostics.append(Diagnostic("missing-grid", "no values", Span(1, 1, 1, 2)))
        return None
    first, corner = split[0]
    names = [spelled(name) for name in head.names[:pages]]
    if [cell.strip() for cell in corner[:pages]] != names:
        message = f"the first columns must be headed {', '.join(names)}"
        diagnostics.append(Diagnostic("wrong-corner", message, Span(first, 1, first, 2)))
        return None
    levels = [set(axis.levels) for axis in head.axes[:-2]]
    grids: dict[tuple[float, ...], TextGrid] = {}
    for line_number, cells in split[1:]:
        page = _page(cells[:pages], levels)
        if page is None:
            message = f"{', '.join(cells[:pages])} are not levels of {', '.join(names)}"
            span = Span(line_number, 1, line_number, 2)
            diagnostics.append(Diagnostic("wrong-label", message, span))
            continue
        if page not in grids:
            tokens = line_tokens(line_number, f"grid{page_condition(head, page)}", [])
            grids[page] = TextGrid(tuple(_at_start(token) for token in tokens))
            grids[page].lines.append((first, "  ".join(corner[pages:])))
        grids[page].lines.append((line_number, "  ".join(cells[pages:])))
    return list(grids.values())


def _page(cells: list[str], levels: list[set[float]]) -> tuple[float, ...] | None:
    """Return the levels of the page inputs at the start of a row; None for other words."""
    try:
        page = tuple(map(float, cells))
    except ValueError:
        return None
    is_complete = len(page) == len(levels) and all(map(set.__contains__, levels, page))
    return page if is_complete else None


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
        if "#" in cell and "'" not in cell:  # the reader of rows would read a comment
            span = Span(line_number, 1, line_number, len(line) + 1)
            message = f"'{cell[:40]}' is not a number"
            diagnostics.append(Diagnostic("not-a-number", message, span))
    return [cell if "\\" in cell or "'" in cell else cell.strip() or "''" for cell in cells]


# --- Tables as `.json`: one object with named axes, for other programs ---


def header_data(table: TableHeader) -> dict[str, Any]:
    """Return the header of `table` as plain data for JSON; an infinite end is null."""
    return {"format": FORMAT, "version": VERSION, **jsonable(table)}


def _write_json(table: PlainTable) -> str:
    """Return the text of `table` as a JSON object; ``values`` is nested in index order."""
    data = header_data(table)
    data["values"] = _nested(list(table.values), table.shape)
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _parse_json(text: str, path: str = "<text>") -> ParsedTable:
    """Read the format of :func:`_write_json`; any fault is a diagnostic."""
    try:
        data = json.loads(text, parse_constant=_refused)
    except json.JSONDecodeError as error:
        span = Span(error.lineno, error.colno, error.lineno, error.colno + 1)
        return _fault("bad-json", f"not JSON: {error.msg}", path, span)
    except (RecursionError, ValueError) as error:
        return _fault("bad-json", f"cannot read this JSON: {error}", path)
    try:
        head = _header_from(data)
        values = _flat(data["values"], head.shape)
        return ParsedTable(PlainTable(**head.head(), values=tuple(values)), (), head)
    except KeyError as error:
        return _fault("missing-key", f"the object has no {error}", path)
    except TableError as error:
        return _fault("bad-table", error.message, path)
    except (TypeError, ValueError, AttributeError, OverflowError):
        return _fault("bad-table", "the object is not of the form of a table", path)


def _refused(word: str) -> None:
    """Refuse numbers that Python accepts and JSON lacks."""
    raise ValueError(f"{word} is not a number of JSON")


def _header_from(data: Any) -> TableHeader:
    """Return the header from :func:`header_data`; raise an error for another form."""
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise TableError(f'not a lookup table: "format" must be "{FORMAT}"')
    if data.get("version") != VERSION:
        raise TableError(f"this fuzzyarm reads version {VERSION} of the format")
    index = data["index"]
    axes = tuple(_axis(axis) for axis in data["axes"])
    if list(index) != [axis.name for axis in axes]:
        raise TableError(f"the index order {index} is not that of the axes")
    output = data["output"]
    return TableHeader(
        axes,
        _text(output["name"]),
        low=_end(output.get("low"), -math.inf if output.get("bounded") else None),
        high=_end(output.get("high"), math.inf if output.get("bounded") else None),
        description=_text(output.get("description") or ""),
        rounding=_end(data.get("round"), None),
        mode=data.get("mode"),
        provenance=tuple((_text(key), _text(value)) for key, value in data["provenance"]),
    )


def _axis(data: dict[str, Any]) -> Axis:
    bins = data.get("bins")
    low, high = _end(data.get("low"), -math.inf), _end(data.get("high"), math.inf)
    return Axis(
        _text(data["name"]),
        tuple(_number(x) for x in data["levels"]),
        None if bins is None else tuple(_number(x) for x in bins),
        low=-math.inf if low is None else low,
        high=math.inf if high is None else high,
        description=_text(data.get("description") or ""),
    )


def _end(value: Any, otherwise: float | None) -> float | None:
    return otherwise if value is None else _number(value)


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TableError(f"{value!r:.40} is not a number")
    return float(value)


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TableError(f"{value!r:.40} is not text")
    return value


def _nested(values: list[float], shape: tuple[int, ...]) -> list[Any]:
    if len(shape) == 1:
        return values
    size = len(values) // shape[0]
    return [_nested(values[i : i + size], shape[1:]) for i in range(0, len(values), size)]


def _flat(values: Any, shape: tuple[int, ...]) -> list[float]:
    if not isinstance(values, list) or len(values) != shape[0]:
        raise TableError(f"the values do not have the shape {shape} of the axes")
    if len(shape) == 1:
        numbers = [_number(x) for x in values]
        if not all(map(math.isfinite, numbers)):
            raise TableError("a value is not finite")
        return numbers
    return [x for part in values for x in _flat(part, shape[1:])]


def _fault(name: str, message: str, path: str, span: Span = Span(1, 1, 1, 2)) -> ParsedTable:  # noqa: B008
    return ParsedTable(None, (Diagnostic(name, message, span, path=path),))


class _Format(NamedTuple):
    """A format of text; its parser reports every fault and never raises."""

    parse: Callable[[str, str], ParsedTable]
    write: Callable[[PlainTable], str]


_TEXTS = {
    ".lut": _Format(parse_lut, write_lut),
    ".csv": _Format(parse_csv, _write_csv),
    ".json": _Format(_parse_json, _write_json),
}


# --- Tables as `.npz`: the values as an array, the header as JSON text beside it ---


MOST_BYTES = 320_000_000
"""Uncompressed size of an archive: the largest compiled table, and its header."""


def _npz_bytes(table: LookupTable) -> bytes:
    """Return the content of the file: ``values``, ``header``, and each axis for convenience."""
    import numpy as np

    data = header_data(table)
    arrays = {f"levels_{k}": np.array(axis.levels) for k, axis in enumerate(table.axes)}
    out = io.BytesIO()
    header = np.array(json.dumps(data, ensure_ascii=False, allow_nan=False))
    arrays |= {"values": table.values, "header": header}
    np.savez_compressed(out, allow_pickle=False, **arrays)
    return out.getvalue()


def _read_npz(data: bytes, path: str) -> LookupTable:
    """Return the table stored by :func:`_npz_bytes`; TableFileError for a fault."""
    import numpy as np

    from fuzzyarm.table.table import LookupTable

    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            size = sum(member.file_size for member in archive.zip.infolist())
            if size > MOST_BYTES:
                raise TableError(
                    f"unpacked, the archive has {size:,} bytes; at most {MOST_BYTES:,} are read"
                )
            # NumPy accepts any 32 bits as a character; invalid ones must not get into a text.
            header = np.asarray(archive["header"], dtype="<U").tobytes().decode("utf-32-le")
            head = _header_from(json.loads(header.rstrip("\0")))
            values = np.asarray(archive["values"], dtype=np.float64)
        values.setflags(write=False)
        return LookupTable(**head.head(), values=values)
    except TableError as error:
        message = error.message
    except Exception as error:
        message = f"not an archive of a table ({type(error).__name__})"
    raise TableFileError([Diagnostic("bad-table", message, Span(1, 1, 1, 2), path=path)])


# --- Tables as `.tex`, to be printed: a `tabular` for each page, without packages ---

_SPECIAL = {
    "\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", '"': "''",
    **{mark: f"${mark}$" for mark in "<>|"}, **{mark: f"\\{mark}" for mark in "#$%&_{}"},
}  # fmt: skip
"""Special characters of LaTeX → their escapes."""


def write_latex(table: PlainTable) -> str:
    """Return a table in LaTeX: rows go down, columns across, further inputs are pages."""
    across = [_latex_number(x) for x in table.axes[-1].levels]
    rows = table.axes[-2].levels if len(table.axes) > 1 else ()
    cells = column_of_numbers(table.values)
    pages = list(product(*(axis.levels for axis in table.axes[:-2])))
    size = len(cells) // max(1, len(pages))
    parts = ["".join(f"% {printable(line)}\n" for line in _heading(table))]
    for number, page in enumerate(pages):
        part = cells[number * size : (number + 1) * size]
        parts.append(_tabular(table, page, across, rows, part))
    return "\n".join(parts)


def _heading(table: PlainTable) -> list[str]:
    words = f"{table.output} over {', '.join(table.names)}"
    return [words, *(f"{key}: {value}" for key, value in table.provenance)]


def _tabular(
    table: PlainTable,
    page: tuple[float, ...],
    across: list[str],
    rows: tuple[float, ...],
    cells: list[str],
) -> str:
    names = [_latex_text(name) for name in table.names]
    output = _latex_text(table.output)
    lines = []
    if page:
        where = ", ".join(
            f"{name} = {_latex_number(x)}" for name, x in zip(names[:-2], page, strict=True)
        )
        lines.append(f"\\noindent {output}, {where}\\\\[1ex]")
    corner = f"{names[-2]} $\\backslash$ {names[-1]}" if rows else names[-1]
    lines += [
        f"\\begin{{tabular}}{{r|{'r' * len(across)}}}",
        f"{corner} & {' & '.join(across)} \\\\",
        "\\hline",
    ]
    width = len(across)
    for number, label in enumerate([_latex_number(x) for x in rows] or [output]):
        row = cells[number * width : (number + 1) * width]
        lines.append(f"{label} & {' & '.join(map(_math, row))} \\\\")
    return "\n".join([*lines, "\\end{tabular}", ""])


def _latex_number(x: float) -> str:
    return _math(number_text(x))


def _math(written: str) -> str:
    """Return a number with the minus sign and the power of mathematics."""
    base, _, power = written.strip().partition("e")
    return f"${base} \\cdot 10^{{{int(power)}}}$" if power else f"${base}$"


def _latex_text(name: str) -> str:
    """Return anybody's name as LaTeX prints it."""
    return re.sub(r"[\\~^<>|\"#$%&_{}]", lambda match: _SPECIAL[match[0]], printable(name))
