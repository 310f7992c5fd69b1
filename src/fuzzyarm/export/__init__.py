"""Controllers as source text for small machines: C99 and IEC 61131-3 Structured Text.

A *routine* is one function of the exported file together with a Python model of the very
same arithmetic: :class:`~fuzzyarm.export.table_numbers.FloatTable`,
:class:`~fuzzyarm.export.table_numbers.FixedTable` and
:class:`~fuzzyarm.export.rulebase.DirectRoutine`. The model is what the tests hold the compiled
C against, and what the figures in the head of an exported file are measured with.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fuzzyarm.export.numbers import ExportError
    from fuzzyarm.export.rulebase import DirectRoutine
    from fuzzyarm.export.structured_text import structured_text
    from fuzzyarm.export.table_numbers import FixedTable, FloatTable
    from fuzzyarm.export.write import EXPORTS, Exported, export_files, routines_of, write_export


_HOMES = {
    "EXPORTS": "write",
    "DirectRoutine": "rulebase",
    "ExportError": "numbers",
    "Exported": "write",
    "FixedTable": "table_numbers",
    "FloatTable": "table_numbers",
    "export_files": "write",
    "routines_of": "write",
    "structured_text": "structured_text",
    "write_export": "write",
}

__all__ = [
    "EXPORTS",
    "DirectRoutine",
    "ExportError",
    "Exported",
    "FixedTable",
    "FloatTable",
    "export_files",
    "routines_of",
    "structured_text",
    "write_export",
]


def __getattr__(name: str) -> object:
    if name in _HOMES:
        return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
