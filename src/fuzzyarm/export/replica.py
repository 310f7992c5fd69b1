"""The model of an exported controller: its steps in Python, and signals to try it with."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from fuzzyarm.export.numbers import Kind
from fuzzyarm.export.routine import Routine
from fuzzyarm.export.steps import (
    LAST,
    Ask,
    Find,
    Grid,
    Pick,
    Set,
    Step,
    Steps,
    StepVariable,
    Teach,
    first_of,
)
from fuzzyarm.export.table import TableRoutine
from fuzzyarm.export.table_numbers import FixedTable, scaled, shift_of, unscaled
from fuzzyarm.expression.evaluation import Schedule, evaluate_arrays, schedule
from fuzzyarm.expression.nodes import Node, symbol


class Replica:
    """The steps in Python, in the precision and with the arithmetic of the exported program.

    Parameters
    ----------
    steps : Steps
        Which controller.
    """

    def __init__(self, steps: Steps) -> None:
        self.program = steps
        self.real = steps.precision.wide
        self._orders: dict[Node, Schedule] = {}
        self._routines = {name: _call_of(routine) for name, routine in steps.routines.items()}
        self.start()

    def start(self) -> None:
        """Forget everything."""
        steps = self.program
        self.values: dict[str, Any] = {
            name: self.real(self._held(variable)) for name, variable in steps.variables.items()
        }
        self.values |= {first_of(axis): np.True_ for axis in steps.needs_first}
        storage_type = np.float32 if steps.single else np.float64
        self.tables = {
            name: np.array(learning.values, storage_type).astype(self.real)
            for name, learning in steps.learned.items()
        }
        self.visits = {name: np.zeros(len(t), np.int64) for name, t in self.tables.items()}
        self._rings = {name: [-1] * learning.delay for name, learning in steps.learned.items()}
        self._judges = {
            name: np.asarray(table.values, storage_type).ravel().astype(self.real)
            for name, table in steps.judges.items()
        }
        self._periods = 0

    def _held(self, variable: StepVariable) -> float:
        wide = variable.wide or not self.program.single
        return variable.start if wide else float(np.float32(variable.start))

    def step(self, inputs: Mapping[str, float]) -> dict[str, float]:
        """Run one period with values of references and measured ports, by symbol."""
        outside = self.program.precision.outside
        for name, value in inputs.items():
            self.values[name] = self.real(outside(value))
        self._periods += 1
        self.values[LAST] = np.bool_(self._periods % self.program.model.every == 0)
        for block in self.program.blocks():
            if block.guard is not None and not self._truth(block.guard.condition):
                self.values |= {name: self.real(x) for name, x in block.guard.sent.items()}
                continue
            for step in block.steps:
                self._run(step)
            self.values |= {first_of(axis): np.False_ for axis in block.begun}
        return {
            variable.symbol: self.values[variable.symbol]
            for variable in self.program.of_sort("drive")
        }

    def _run(self, step: Step) -> None:
        values = self.values
        if isinstance(step, Set):
            value = self._value(step.value)
            if step.rounded and self.program.single:
                value = self.real(np.float32(value))
            values[step.target] = value
        elif isinstance(step, Ask):
            arguments = [values[name] for name in step.inputs]
            values[step.target] = self._routines[step.routine](arguments, self.real)
        elif isinstance(step, Find):
            values[step.target] = _cell(
                self.program.grids[step.grid], [values[n] for n in step.inputs]
            )
        elif isinstance(step, Pick):
            values[step.target] = self.tables[step.table][values[step.cell]]
        else:
            self._teach(step)

    def _value(self, node: Node) -> Any:
        return self.real(self._truth(node))

    def _truth(self, node: Node) -> Any:
        if node not in self._orders:
            self._orders[node] = schedule(node)
        return evaluate_arrays(node, self.values, self.real, self._orders[node])

    def _teach(self, lesson: Teach) -> None:
        table, ring = self.tables[lesson.table], self._rings[lesson.table]
        cell = self.values[lesson.cell]
        responsible = ring.pop(0) if ring else cell
        if self.program.learned[lesson.table].delay:
            ring.append(cell)
        rate, bound = self._value(lesson.rate), self._value(lesson.bound)
        if responsible >= 0 and rate != 0.0:
            judged = self._judges[lesson.judge][self.values[lesson.judged]]
            value = table[responsible] + rate * judged
            if self.program.single:
                value = self.real(np.float32(value))
            table[responsible] = min(max(value, -bound), bound)
        self.visits[lesson.table][cell] += 1


def _cell(grid: Grid, inputs: Sequence[Any]) -> int:
    """Return the number of a cell, the last input fastest."""
    cell = 0
    for (_, thresholds), x in zip(grid, inputs, strict=True):
        cell = cell * (len(thresholds) + 1) + bisect_left(thresholds, float(x))
    return cell


def _call_of(routine: Routine) -> Callable[[Sequence[Any], Kind], Any]:
    """Return how the exported program calls a routine."""

    def plain(inputs: Sequence[Any], real: Kind) -> Any:
        return real(routine.evaluate(*([x] for x in inputs))[0])

    core = routine.core if isinstance(routine, TableRoutine) else None
    if not isinstance(core, FixedTable):
        return plain

    def in_whole_numbers(inputs: Sequence[Any], real: Kind) -> Any:
        numbers = [
            [int(evaluate_arrays(scaled(scale, symbol("x")), {"x": x}, real)) - shift_of(scale)]
            for scale, x in zip(core.inputs, inputs, strict=True)
        ]
        number = real(int(core.evaluate(*numbers)[0]))
        return real(evaluate_arrays(unscaled(core.output, symbol("n")), {"n": number}, real))

    return in_whole_numbers


# --- Signals to try a controller with ---

LOST = 7
"""The period in which the first axis reads a value that is not a number; the next axis in the next.
In the very first period all axes do: their drives have no last value yet."""


def trial(steps: Steps, periods: int, seed: int = 1) -> Iterator[dict[str, float]]:
    """Yield values for the ports, period by period.

    References wander; measured values miss them by errors of every size from 1e-4 to 10, so
    that rule bases are asked near their middle and beyond their ranges. Some are not numbers
    (`LOST`).
    """
    draw = np.random.default_rng(seed)
    outside = steps.precision.outside
    references = {variable: draw.uniform(0.2, 2.0, 2) for variable in steps.of_sort("reference")}
    errors = {variable: draw.uniform(0.05, 0.4, 2) for variable in steps.of_sort("measured")}
    for k in range(periods):
        sample = {
            variable.symbol: float(outside(a * math.sin(0.05 * b * k)))
            for variable, (a, b) in references.items()
        }
        for port, (a, b) in errors.items():
            size = 10.0 ** (4.0 * math.sin(a * k + 1.0) * math.cos(0.3 * b * k) - 1.5)
            target = sample.get(port.symbol.replace("measured:", "reference:"), 0.0)
            sample[port.symbol] = float(outside(target - min(size, 10.0) * math.sin(b * k + 2.0)))
        for number, (guard, *_) in enumerate(steps.guards):
            if k in (0, LOST + number):
                sample[guard.reads[k % len(guard.reads)]] = math.nan
        yield sample
