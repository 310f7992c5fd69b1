"""Lookup tables: the table, the compiler that fills it, and its files.

What a name needs is loaded when the name is used: reading the text of a table
(:mod:`fuzzyarm.table.text`) does not load an array library.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fuzzyarm.table.axis import MODES, SUFFIXES, Axis, PlainTable, TableError, TableHeader
    from fuzzyarm.table.compiler import compile_table
    from fuzzyarm.table.diff import TableDiff, compare_tables
    from fuzzyarm.table.fidelity import (
        CompileReport,
        Fidelity,
        compile_with_report,
        measure_fidelity,
    )
    from fuzzyarm.table.files import TableFileError, read_table, write_table
    from fuzzyarm.table.table import LookupTable
    from fuzzyarm.table.text import ParsedTable, parse_lut, write_lut


_HOMES = {
    "MODES": "axis",
    "SUFFIXES": "axis",
    "Axis": "axis",
    "CompileReport": "fidelity",
    "Fidelity": "fidelity",
    "LookupTable": "table",
    "ParsedTable": "text",
    "PlainTable": "axis",
    "TableDiff": "diff",
    "TableError": "axis",
    "TableFileError": "files",
    "TableHeader": "axis",
    "compare_tables": "diff",
    "compile_table": "compiler",
    "compile_with_report": "fidelity",
    "measure_fidelity": "fidelity",
    "parse_lut": "text",
    "read_table": "files",
    "write_lut": "text",
    "write_table": "files",
}

__all__ = [
    "MODES",
    "SUFFIXES",
    "Axis",
    "CompileReport",
    "Fidelity",
    "LookupTable",
    "ParsedTable",
    "PlainTable",
    "TableDiff",
    "TableError",
    "TableFileError",
    "TableHeader",
    "compare_tables",
    "compile_table",
    "compile_with_report",
    "measure_fidelity",
    "parse_lut",
    "read_table",
    "write_lut",
    "write_table",
]


def __getattr__(name: str) -> object:
    if name in _HOMES:
        return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
