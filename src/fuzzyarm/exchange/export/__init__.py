"""Controllers as source text for small machines: C99 and IEC 61131-3 Structured Text.

Rule bases, tables and controllers are lowered once to a typed program
(:mod:`fuzzyarm.exchange.export.typed_program`), which every target prints.

A *routine* is one function of the exported file together with a Python model of the very
same arithmetic: :class:`~fuzzyarm.exchange.export.table.FloatTable`,
:class:`~fuzzyarm.exchange.export.table.FixedTable` and
:class:`~fuzzyarm.exchange.export.rulebase.DirectRoutine`. The tests hold the compiled C against the
model, and the figures in the head of an exported file are measured with it. A whole controller is a
:class:`~fuzzyarm.exchange.export.controllers.ControllerProgram`.
"""

from typing import TYPE_CHECKING

from fuzzyarm.base.folders import EXPORTS
from fuzzyarm.base.lazy import lazily
from fuzzyarm.exchange.export.controllers import ControllerProgram, with_tables
from fuzzyarm.exchange.export.cost import StepCost, step_cost
from fuzzyarm.exchange.export.numbers import ExportError
from fuzzyarm.exchange.export.rulebase import DirectRoutine
from fuzzyarm.exchange.export.table import FixedTable, FloatTable
from fuzzyarm.exchange.export.write import (
    Exported,
    ExportedController,
    export_controller,
    export_files,
    routines_of,
    write_export,
)

__all__ = [
    "EXPORTS", "ControllerProgram", "DirectRoutine", "ExportError", "Exported",
    "ExportedController", "FixedTable", "FloatTable", "StepCost", "export_controller",
    "export_files", "routines_of", "step_cost", "with_tables", "write_export",
]  # fmt: skip

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
