"""Floats as the numbers of a control period: the reference for the machine code, bit for bit.

Slow and plain. Signals and gains are rounded to single precision where the run stores them so.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace

import numpy as np

from fuzzyarm.control.controllers.period import (
    Algebra,
    AxisGuard,
    AxisResults,
    Call,
    ControlPeriod,
    Lesson,
    PortValue,
    Remembered,
)
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.inference.infer import infer, with_nan_for_no_rule
from fuzzyarm.language.model.controller import GainModel
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.setting import RunArithmetic
from fuzzyarm.symbolic.evaluation import evaluate
from fuzzyarm.symbolic.nodes import Node
from fuzzyarm.table import LookupTable


@dataclass
class _LearningTable:
    """A learning table, with the cells used in the last periods."""

    table: LookupTable
    values: list[float]
    ring: list[int] = field(default_factory=list)
    taught: tuple[tuple[str, ...], int] = ((), 0)

    def cell(self, inputs: Sequence[float]) -> int:
        """Return the index of a cell, the last input fastest."""
        return _cell(self.table, inputs)


def _cell(table: LookupTable, inputs: Sequence[float]) -> int:
    cell = 0
    for name, x in zip(table.names, inputs, strict=True):
        axis = table.axis(name)
        cell = cell * len(axis.levels) + bisect_left(axis.thresholds(table.default_mode), x)
    return cell


class Floats(Algebra[float]):
    """Floats of a run.

    Parameters
    ----------
    arithmetic : RunArithmetic
        Arithmetic of the run: precision of stored values, and π.
    """

    def __init__(self, arithmetic: RunArithmetic | None = None) -> None:
        self.arithmetic = arithmetic or RunArithmetic()
        self.periods = 0
        self.signals: dict[tuple[str, str], float] = {}
        self.driven: dict[tuple[str, str], float] = {}
        self.tables: dict[tuple[str, str], _LearningTable] = {}
        self.tables_before: dict[tuple[str, str], _LearningTable] = {}

    # --- numbers ---

    def number(self, value: float) -> float:
        """Return the float."""
        return float(value)

    def add(self, a: float, b: float) -> float:
        """Return a sum."""
        return a + b

    def subtract(self, a: float, b: float) -> float:
        """Return a difference."""
        return a - b

    def multiply(self, a: float, b: float) -> float:
        """Return a product."""
        return a * b

    def divide(self, a: float, b: float) -> float:
        """Return a quotient; a divisor of 0 as in IEEE 754."""
        with np.errstate(all="ignore"):
            return float(np.float64(a) / np.float64(b))

    def limit(self, x: float, low: float, high: float) -> float:
        """Return ``min(max(x, low), high)``."""
        return min(max(x, low), high)

    def rate_limited(self, x: float, before: float, most: float) -> float:
        """Return ``min(max(x, before - most), before + most)``."""
        return min(max(x, before - most), before + most)

    def expression(self, root: Node, values: Mapping[str, float]) -> float:
        """Return the value of an expression."""
        return float(evaluate(root, values))

    def rules(self, rulebase: RuleBase, inputs: Mapping[str, float]) -> list[float]:
        """Return the outputs of a rule base."""
        return [float(value) for value in infer(with_nan_for_no_rule(rulebase), inputs).values()]

    def table(self, table: LookupTable, inputs: Mapping[str, float]) -> float:
        """Return the value of a lookup table, rounded as a gain."""
        if not self.arithmetic.single:
            return float(table.lookup(*inputs.values()))
        stored = np.array([self.rounded(x) for x in table.values.ravel().tolist()])
        held = replace(table, values=stored.reshape(table.values.shape))
        return float(held.lookup(*inputs.values()))

    # --- stored values ---

    def hold(self, value: float) -> float:
        """Return a number as the run stores it."""
        return self.arithmetic.hold(value)

    def rounded(self, value: float) -> float:
        """Return a value as the run stores it."""
        return self.arithmetic.hold(value)

    def gain(self, gain: GainModel, index: int) -> float:
        """Return a gain, rounded for storage."""
        return self.rounded(gain.values[index].value(self.arithmetic.pi))

    def signal(self, axis: str, name: str, value: float, *, rounded: bool = True) -> float:
        """Return a signal, rounded for storage."""
        self.signals[axis, name] = self.rounded(value) if rounded else value
        return self.signals[axis, name]

    def begins(self, cell: Remembered) -> float:
        """Return the initial value; NaN means none yet."""
        return cell.start

    def held(self, value: float, before: float) -> float:
        """Return an output, or its last value where no rule fires."""
        return before if math.isnan(value) else value

    def last(self, every: int) -> float:
        """Return 1 in the last period of a set point, else 0."""
        return float(self.periods % every == 0)

    # --- tables that learn ---

    def _learning(self, call: Call[float]) -> _LearningTable:
        key = (call.period.axis, call.name)
        if key not in self.tables:
            table = call.lattice()
            delay = call.learner.delay if call.learner is not None else 0
            values = [self.rounded(x) for x in table.values.ravel().tolist()]
            self.tables[key] = _LearningTable(table, values, [-1] * delay)
        return self.tables[key]

    def learned(self, call: Call[float], table: LookupTable, inputs: Mapping[str, float]) -> float:
        """Return the value of a cell; after a lesson for the same signals, the corrected one."""
        learning = self._learning(call)
        taught, cell = learning.taught
        if taught != tuple(call.signals):
            cell = learning.cell(list(inputs.values()))
        return learning.values[cell]

    def learn(self, lesson: Lesson[float]) -> None:
        """Correct the cell used some periods ago."""
        learning, inputs = self._learning(lesson.table), lesson.table.arguments
        judge = lesson.judge.lattice()
        cell = learning.cell(inputs)
        learning.taught = tuple(lesson.line.inputs), cell
        learning.ring.append(cell)
        responsible = learning.ring.pop(0)
        if responsible >= 0 and lesson.rate != 0.0:
            judged = self.rounded(float(judge.values.ravel()[_cell(judge, inputs)]))
            value = self.rounded(learning.values[responsible] + lesson.rate * judged)
            learning.values[responsible] = min(max(value, -lesson.bound), lesson.bound)

    # --- skipped periods ---

    def skipped(
        self, guard: AxisGuard, given: Mapping[PortValue, float]
    ) -> dict[str, float] | None:
        """Return the drives of an axis with a NaN input."""
        if any(math.isnan(given[value]) for value in guard.reads):
            return self._sent(guard)
        self.tables_before = {
            key: deepcopy(table) for key, table in self.tables.items() if key[0] == guard.axis
        }
        return None

    def _sent(self, guard: AxisGuard) -> dict[str, float]:
        drives = {}
        for port, sent in guard.sent.items():
            before = self.driven.get((guard.axis, port), guard.idle[port])
            drives[port] = before if sent is None else sent
        self.driven |= {(guard.axis, port): value for port, value in drives.items()}
        return drives

    def ran(self, guard: AxisGuard, results: AxisResults[float]) -> dict[str, float] | None:
        """Return the drives of a period skipped after all; None keeps those of this one."""
        values = (*results.signals.values(), *results.drives.values())
        if any(map(math.isnan, values)) or not all(map(math.isfinite, results.memory.values())):
            self.tables = {k: v for k, v in self.tables.items() if k[0] != guard.axis}
            self.tables |= self.tables_before
            return self._sent(guard)
        self.driven |= {(guard.axis, port): value for port, value in results.drives.items()}
        return None


class ReferenceRun:
    """A controller over floats, period by period: the reference for compiled runs.

    Parameters
    ----------
    text : ControllerText
        Without partners.
    single : bool
        Whether signals and gains are stored in single precision.
    """

    def __init__(self, text: ControllerText, *, single: bool = False) -> None:
        self.floats = Floats(RunArithmetic(single))
        self.period = ControlPeriod(text, self.floats)
        self.memory: dict[str, float] = {}

    @property
    def signals(self) -> dict[tuple[str, str], float]:
        """The signals of the last period, by axis and name."""
        return self.floats.signals

    def step(self, given: Mapping[PortValue, float]) -> dict[tuple[str, str], float]:
        """Run one period; return the drives by axis and port."""
        number = self.floats.periods
        self.floats.periods += 1
        drives, self.memory = self.period.run(given, self.memory, number=number)
        return drives
