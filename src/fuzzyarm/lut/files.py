"""Read and write tables as files; the suffix tells the format."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.files import write_atomically
from fuzzyarm.lut.axis import TableError
from fuzzyarm.lut.text import ParsedTable, parse_lut
from fuzzyarm.rulebase.diagnostic import Diagnostic, RuleBaseError, Span

if TYPE_CHECKING:
    from fuzzyarm.lut.table import LookupTable

SUFFIXES = (".lut", ".csv", ".npz", ".json")
"""The formats that are read back to an identical table."""


class TableFileError(RuleBaseError):
    """A file that is no table; ``diagnostics`` say what is wrong and where."""


def read_table(path: str | Path) -> LookupTable:
    """Return the table in a ``.lut``, ``.csv``, ``.npz`` or ``.json`` file.

    Raises
    ------
    TableFileError
        If the file is at fault; it carries every finding.
    TableError
        If the suffix is none of these.
    OSError
        If the file cannot be read.
    """
    from fuzzyarm.lut.table import LookupTable

    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise _unknown_suffix(path)
    if path.suffix.lower() == ".npz":
        from fuzzyarm.lut.npz import read_npz

        return read_npz(path.read_bytes(), str(path))
    parsed = parse_table(path.read_bytes(), str(path))
    if parsed.table is None:
        raise TableFileError(parsed.diagnostics)
    return LookupTable.from_plain(parsed.table)


def parse_table(data: bytes, path: str) -> ParsedTable:
    """Return what the bytes of a text table say, by the suffix of `path`; never raise."""
    suffix = Path(path).suffix.lower()
    text, fault = decode(data, path)
    if fault is not None:
        return ParsedTable(None, (fault,))
    readers: dict[str, str] = {".csv": "parse_csv", ".json": "parse_json"}
    if suffix in readers:
        module = importlib.import_module(f"fuzzyarm.lut.{suffix[1:]}_text")
        parse: Callable[[str, str], ParsedTable] = getattr(module, readers[suffix])
        return parse(text, path)
    return parse_lut(text, path)


def decode(data: bytes, path: str) -> tuple[str, Diagnostic | None]:
    """Return `data` as text, or a diagnostic at the first byte that is no UTF-8."""
    try:
        return data.decode("utf-8-sig"), None
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8", "replace")
        line = before.count("\n") + 1
        column = len(before) - (before.rfind("\n") + 1) + 1
        message = f"this is no text: byte 0x{data[error.start]:02x} is not UTF-8"
        span = Span(line, column, line, column + 1)
        return "", Diagnostic("not-text", message, span, path=path)


def write_table(table: LookupTable, path: str | Path) -> None:
    """Write `table` whole or not at all; :func:`read_table` gives back an equal table.

    Raises
    ------
    TableError
        If the suffix is none of ``.lut``, ``.csv``, ``.npz``, ``.json``.
    OSError
        If the folder cannot be written.
    """
    path = Path(path)
    write_atomically(path, table_as(table, path.suffix.lower(), path))


def table_as(table: LookupTable, suffix: str, path: str | Path = "") -> str | bytes:
    """Return the content of a file of `table` with the given suffix."""
    if suffix == ".lut":
        from fuzzyarm.lut.write_text import write_lut

        return write_lut(table.plain())
    if suffix == ".csv":
        from fuzzyarm.lut.csv_text import write_csv

        return write_csv(table.plain())
    if suffix == ".json":
        from fuzzyarm.lut.json_text import write_json

        return write_json(table.plain())
    if suffix == ".npz":
        from fuzzyarm.lut.npz import npz_bytes

        return npz_bytes(table)
    raise _unknown_suffix(Path(path))


def _unknown_suffix(path: Path) -> TableError:
    return TableError(
        f"'{path.name}' has no suffix of a table", hint=f"tables are {', '.join(SUFFIXES)}"
    )
