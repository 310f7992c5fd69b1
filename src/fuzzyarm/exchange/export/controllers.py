"""Controllers ready for export: tables in place of rules, self-test, remarks."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.base.numbers import number_text
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.exchange.export.c_files import TestSequence
from fuzzyarm.exchange.export.controller_lowering import controller_program
from fuzzyarm.exchange.export.routine import MADE
from fuzzyarm.exchange.export.steps import Steps
from fuzzyarm.exchange.export.table import FixedTable
from fuzzyarm.exchange.export.trial import EvaluatedController, trial
from fuzzyarm.exchange.export.walk_of_steps import RoutineOptions, steps_of
from fuzzyarm.language.model.controller import Line, SignalLine, Source
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.table import LookupTable
from fuzzyarm.table.compiler import over_inputs

if TYPE_CHECKING:
    from fuzzyarm.exchange.export.guard import RegionGuard
    from fuzzyarm.proof.check.checking import Checked

PERIODS = 200
"""Periods of a self-test."""

PERIODS_IN_SINGLE = 24
"""Periods of a self-test in single precision, whose difference to the controller grows."""

Compile = Callable[[RuleBase, str], LookupTable]
"""From a rule base and one of its outputs to a table."""


def with_tables(text: ControllerText, compile_output: Compile) -> ControllerText:
    """Return a controller that looks tables up instead of evaluating rule bases.

    Parameters
    ----------
    text : ControllerText
        The controller.
    compile_output : callable
        From a rule base and the name of an output to its table.

    Returns
    -------
    ControllerText
        A line ``a, b = rules R(e)`` becomes a line for each table ``R_a``, ``R_b``.
    """
    sheets = dict(text.sheets)
    tables: dict[tuple[int, str], LookupTable] = {}

    def table(rulebase: RuleBase, output: str) -> LookupTable:
        # Axes may share a rule base: each output is compiled once.
        key = (id(rulebase), output)
        if key not in tables:
            tables[key] = compile_output(rulebase, output)
        return tables[key]

    def lines_of(line: Line) -> list[Line]:
        if not isinstance(line, SignalLine) or line.source is None or line.source.kind != "rules":
            return [line]
        source = line.source
        lines: list[Line] = []
        source_sheets = text.sheets[source.name]
        for number, name in enumerate(line.names):
            # Each axis may have its own rule base under the name, with other names of outputs.
            outputs = [
                sheet.outputs[number].name for sheet in source_sheets if isinstance(sheet, RuleBase)
            ]
            table_name = source.name if len(line.names) == 1 else f"{source.name}_{outputs[0]}"
            rulebases = [sheet for sheet in source_sheets if isinstance(sheet, RuleBase)]
            compiled = [table(*pair) for pair in zip(rulebases, outputs, strict=True)]
            inputs, sheets[table_name] = _looked_up(rulebases, compiled, source.inputs)
            looked_up = Source("table", table_name, inputs, source.options)
            lines.append(replace(line, names=(name,), source=looked_up))
        return lines

    axes = tuple(
        replace(axis, lines=tuple(new for line in axis.lines for new in lines_of(line)))
        for axis in text.model.axes
    )
    return ControllerText(replace(text.model, axes=axes), sheets, text.path)


def _looked_up(
    rulebases: Sequence[RuleBase], tables: Sequence[LookupTable], inputs: tuple[str, ...]
) -> tuple[tuple[str, ...], tuple[LookupTable, ...]]:
    """Return the union of the tables' inputs, and the tables over all of them."""
    indices = [
        k
        for k in range(len(inputs))
        if any(
            rulebase.inputs[k].name in table.names
            for rulebase, table in zip(rulebases, tables, strict=True)
        )
    ]
    over = tuple(
        over_inputs(table, [rulebase.inputs[k] for k in indices])
        for rulebase, table in zip(rulebases, tables, strict=True)
    )
    return tuple(inputs[k] for k in indices), over


@dataclass(frozen=True)
class Tried:
    """The run of a controller over a sequence of periods.

    Attributes
    ----------
    vectors : TestSequence
        Ports and drives.
    worst : float
        Largest difference of a drive to the controller in double precision.
    largest : float
        Largest drive.
    truths : sequence of sequence of float
        Drives of the controller in double precision.
    """

    vectors: TestSequence
    worst: float
    largest: float
    truths: Sequence[Sequence[float]]


def worst_of(found: Sequence[Sequence[float]], truths: Sequence[Sequence[float]]) -> float:
    """Return the largest difference between drives; infinite where only one is not a number."""
    worst = 0.0
    for row, truth in zip(found, truths, strict=True):
        for x, y in zip(row, truth, strict=True):
            if math.isnan(x) != math.isnan(y):
                return math.inf
            worst = max(worst, 0.0 if math.isnan(x) or x == y else abs(x - y))
    return worst


@dataclass(frozen=True, eq=False)
class ControllerProgram:
    """A controller, ready to be exported.

    Attributes
    ----------
    text : ControllerText
        As exported, with tables in place of rules where requested.
    precision : str
        ``mixed``, ``float32`` or ``float64``.
    q : int or None
        Fraction bits of tables in whole numbers.
    proofs : tuple of str
        Statements proved of it in its loop.
    widened : bool
        Whether rule bases that need double precision compute in it internally.
    beside_rules : str
        How far its drives with tables are from those with rules; empty if unknown.
    certified : Checked or None
        The certificate behind the guard of its program.
    """

    text: ControllerText
    precision: str = "mixed"
    q: int | None = None
    proofs: tuple[str, ...] = ()
    widened: bool = False
    beside_rules: str = ""
    certified: Checked | None = None

    @cached_property
    def guard(self) -> RegionGuard | None:
        """The guard of its program."""
        if self.certified is None:
            return None
        from fuzzyarm.exchange.export.certified_guard import region_guard

        return region_guard(self.certified, self.steps)

    @cached_property
    def steps(self) -> Steps:
        """The steps of a period."""
        return steps_of(self.text, self.precision, RoutineOptions(self.q, self.widened))

    @cached_property
    def tried(self) -> Tried:
        """The sequence of the self-test, and the error of the printed program.

        The expected results are the drives of the controller, in its precision; in single precision
        throughout and with tables of integers they are those of the program.
        """
        steps, outside = self.steps, self.steps.precision.outside
        evaluated = EvaluatedController(controller_program(steps))
        exact = self.precision != "float32" and self.q is None
        plain = self.text.run(compiled=False)
        single = self.text.run(single=True, compiled=False) if self.precision == "mixed" else plain
        names = steps.port_names("drive")
        inputs = [*steps.of_sort("reference"), *steps.of_sort("measured")]
        slowest = max((block.guard.every for block in steps.blocks), default=1)
        periods = PERIODS if exact else max(PERIODS_IN_SINGLE, min(slowest + 2, PERIODS))
        given, expected, truths, found = [], [], [], []
        for period in trial(steps, periods, controller=evaluated):
            ports = _by_port(steps, period)
            row = [period[variable.symbol] for variable in inputs]
            truth = plain.step(ports["measured"], ports["reference"])
            own = truth if single is plain else single.step(ports["measured"], ports["reference"])
            given.append(row)
            found.append(list(evaluated.step(*row)))
            truths.append([truth[name] for name in names])
            expected.append([float(outside(own[name])) for name in names] if exact else found[-1])
        drives = [abs(x) for row in expected for x in row if not math.isnan(x)]
        largest = max(drives, default=0.0)
        tolerance = self._last_places() * float(np.finfo(outside).eps) * max(largest, 1e-30)
        vectors = TestSequence(given, expected, tolerance)
        return Tried(vectors, worst_of(found, truths), largest, truths)

    def measured(self, found: Sequence[Sequence[float]]) -> ControllerProgram:
        """Return the same with the drives' differences measured on an exported text."""
        program = replace(self)
        worst = worst_of(found, self.tried.truths)
        vars(program).update(vars(self) | {"tried": replace(self.tried, worst=worst)})
        return program

    def _last_places(self) -> float:
        """Return the self-test's tolerance in last places of the largest drive."""
        loose = 4096.0 if self.precision == "float32" else 16.0
        return loose * 16.0 if self.steps.calls_functions else loose

    @property
    def reference(self) -> str:
        """The reference of the exported controller, with the same tables."""
        with_tables = any(
            isinstance(sheet, LookupTable)
            for sheets in self.text.sheets.values()
            for sheet in sheets
        )
        return f"the controller{' with these tables' * with_tables} in double precision"

    def head(self) -> list[str]:
        """Return the lines at the head of an exported file."""
        model, steps = self.text.model, self.steps
        words = f"{model.name}: {model.description}" if model.description else model.name
        lines = [
            MADE,
            "",
            f"controller {words}",
            f"runs every {number_text(model.period)} s",
            *self._port_words(),
            *self._sheet_words(),
            steps.precision.words + (" for signals" if self.q is not None else ""),
            f"worst difference to {self.reference}: {self.tried.worst:.3g}"
            f" ({len(self.tried.vectors.expected)} periods, drives up to {self.tried.largest:.3g})",
            *([self.beside_rules] if self.beside_rules else []),
        ]
        if steps.calls_functions:
            lines.append(
                "functions of math.h are called, whose last bits may differ between machines"
            )
        guard = [] if self.guard is None else self.guard.words(self.steps)
        return [*lines, *(f"{key}: {value}" for key, value in self.provenance()), *guard]

    def _port_words(self) -> list[str]:
        words = {"reference": "references", "measured": "measured", "drive": "drives"}
        return [
            f"{words[sort]}: {', '.join(self.steps.port_names(sort))}"
            for sort in self.steps.port_sorts
        ]

    def _sheet_words(self) -> list[str]:
        lines = []
        for name, routine in self.steps.routines.items():
            rulebase = getattr(routine, "rulebase", None)
            if isinstance(rulebase, RuleBase):
                lines.append(f"{name}: direct inference of {len(rulebase.rules)} rules")
            else:
                core = routine.core  # type: ignore[attr-defined]
                shape = " x ".join(map(str, core.table.shape))
                whole = f", in q{self.q}" if isinstance(core, FixedTable) else ""
                lines.append(f"{name}: table of {shape} cells, looked up by {core.mode}{whole}")
        lines += [
            f"{learning.axis} {learning.name}: table of {len(learning.values)} cells that learns"
            for learning in self.steps.learned.values()
        ]
        return lines

    def provenance(self) -> list[tuple[str, str]]:
        """Return its provenance."""
        entries = [("proved in real arithmetic", words) for words in self.proofs]
        if self.text.path:
            entries.append(("source", Path(self.text.path).name))
            content = Path(self.text.path).read_bytes() if Path(self.text.path).is_file() else b""
            entries.append(("sha256", hashlib.sha256(content).hexdigest()))
        return entries


def _by_port(steps: Steps, values: dict[str, float]) -> dict[str, dict[str, float]]:
    return {
        sort: {
            steps.port_name(variable): values[variable.symbol] for variable in steps.of_sort(sort)
        }
        for sort in ("measured", "reference")
    }
