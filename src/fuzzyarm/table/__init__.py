"""Lookup tables: the table, the compiler that fills it, and its files.

Reading order: :mod:`.axis` (levels along an input), :mod:`.table`, :mod:`.lookup` (values
between levels), :mod:`.compiler` (the table of a rule base), :mod:`.fidelity` (its error,
and the smallest table within a tolerance), :mod:`.text` and :mod:`.files` (its formats).

Names load their modules on first use: reading the text of a table
(:mod:`fuzzyarm.table.text`) does not load an array library.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

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

__all__ = [
    "MODES", "SUFFIXES", "Axis", "CompileReport", "Fidelity", "LookupTable", "ParsedTable",
    "PlainTable", "TableDiff", "TableError", "TableFileError", "TableHeader", "compare_tables",
    "compile_table", "compile_with_report", "measure_fidelity", "parse_lut", "read_table",
    "write_lut", "write_table",
]  # fmt: skip

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "axis": (
                "MODES",
                "SUFFIXES",
                "Axis",
                "PlainTable",
                "TableError",
                "TableHeader",
            ),
            "compiler": ("compile_table",),
            "diff": (
                "TableDiff",
                "compare_tables",
            ),
            "fidelity": (
                "CompileReport",
                "Fidelity",
                "compile_with_report",
                "measure_fidelity",
            ),
            "files": (
                "TableFileError",
                "read_table",
                "write_table",
            ),
            "table": ("LookupTable",),
            "text": (
                "ParsedTable",
                "parse_lut",
                "write_lut",
            ),
        },
    )
