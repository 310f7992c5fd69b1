"""A controller in the form of its kernel: cells, instructions, and where its parts are.

:mod:`.program` writes it; the layout is described in :mod:`.kernel`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.control.controllers import kernel
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.setting import RunArithmetic
from fuzzyarm.symbolic.sources import SourceKind
from fuzzyarm.table import LookupTable

Sheet = RuleBase | LookupTable
"""A rule base or a table that a controller looks up."""

AXIS = "joint"
"""Input that distinguishes the tables of the axes, with levels 1, 2 …"""


class SourceError(FuzzyarmError, ValueError):
    """An unsuitable rule base, table or port of a controller."""

    def __init__(self, message: str, *, hint: str = "") -> None:
        super().__init__(message, hint=hint)


@dataclass(frozen=True)
class Wiring:
    """The first cells of a controller, by port of the plant.

    Attributes
    ----------
    references, measured, drives : dict
        The cell of each axis and port.
    partners : tuple of int
        Cells of a partner's torque, one for each axis.
    size : int
        Number of cells, the clock included.
    starts : dict
        Initial values of drives, from actuators that have one.
    """

    references: Mapping[tuple[str, str], int]
    measured: Mapping[tuple[str, str], int]
    drives: Mapping[tuple[str, str], int]
    partners: tuple[int, ...]
    size: int
    starts: Mapping[tuple[str, str], float]


@dataclass(frozen=True)
class TableCells:
    """The cells of a learning table: its first value, its first visit, their number."""

    values: int
    visits: int
    count: int


@dataclass(frozen=True)
class Guard:
    """Conditions around the instructions of an axis.

    Attributes
    ----------
    begin, end : int
        Range of its instructions in the code.
    count : int
        Counter of skipped periods.
    every, turn : int
        The periods between two runs, and their counter.
    reads : tuple of int
        Cells of references and measured values; NaN in one of them skips the axis.
    drives : dict
        By the cell of each drive, the cell of its value in a skipped period: its last value, or a
        number.
    """

    begin: int
    end: int
    count: int
    every: int
    turn: int
    reads: tuple[int, ...]
    drives: Mapping[int, int]


@dataclass(frozen=True, eq=False)
class ControllerCode:
    """A controller in the form of its kernel.

    Attributes
    ----------
    code : list of int
        The instructions and their lists.
    cells : ndarray of float64
        Their values before the first period.
    signals : dict
        The cell of each axis and signal.
    learned : dict
        The :class:`TableCells` of each learning table of each axis.
    rings : tuple of (int, int)
        The rings of learners, to empty before another run with the same tables.
    gains : dict
        The cells of each gain, one for each axis.
    rulebases : dict
        By the cell of the first result: name in the text and rule base.
    tables : dict
        By the cell of the first value: name in the text and table of one axis.
    updates : dict
        The sources with an update, by the first cell of their frame.
    guards : dict
        The :class:`Guard` of each axis.
    last : dict
        The cell of each drive's last value, by the cell of the drive.
    """

    code: list[int]
    cells: NDArray[np.float64]
    signals: Mapping[tuple[str, str], int]
    learned: Mapping[tuple[str, str], TableCells]
    rings: tuple[tuple[int, int], ...]
    gains: Mapping[str, tuple[int, ...]]
    rulebases: Mapping[int, tuple[str, RuleBase]]
    tables: Mapping[int, tuple[str, LookupTable]]
    updates: Mapping[int, SourceKind]
    guards: Mapping[str, Guard]
    last: Mapping[int, int]

    def skipped(self, cells: Sequence[float] | NDArray[np.float64]) -> dict[str, int]:
        """Return the number of skipped periods of each axis, from the cells after a run."""
        return {axis: int(cells[guard.count]) for axis, guard in self.guards.items()}

    def cells_with(
        self, values: Mapping[str, Sequence[float]], arithmetic: RunArithmetic
    ) -> NDArray[np.float64]:
        """Return the cells with other values of gains, one for all axes or one for each."""
        cells = self.cells.copy()
        for name, numbers in values.items():
            stored = [arithmetic.hold(number) for number in numbers]
            for index, cell in enumerate(self.gains[name]):
                cells[cell] = stored[index if len(stored) > 1 else 0]
        return cells

    def instructions(self) -> list[int]:
        """Return the operations in order, without their operands."""
        return self.code[1 : 1 + kernel.INSTRUCTION * self.code[0] : kernel.INSTRUCTION]

    def memory(self) -> list[int]:
        """Return the state cells, in order."""
        code = self.code
        cells: set[int] = set()
        for at in range(1, 1 + kernel.INSTRUCTION * code[0], kernel.INSTRUCTION):
            operation, state = code[at], code[at + 3]
            # Operand b: the state of limits and slews, the frame of an update.
            cells |= {state + cell.offset for cell in kernel.REMEMBERED.get(operation, ())}
            if operation == kernel.UPDATE:
                cells |= set(range(state + 1, state + code[code[at + 2] + kernel.FILLED]))
            elif operation == kernel.INFER:
                cells |= self._held(code[at + 2])
            elif operation == kernel.PARTNER:
                at_list = code[at + 2]
                cells |= set(
                    range(code[at_list + kernel.MEMORY], code[at_list + kernel.MEMORY_END])
                )
        for guard in self.guards.values():
            cells |= {guard.count, *guard.drives}
            if guard.every > 1:
                cells.add(guard.turn)
        # Learning tables: the ring of used cells, the values and their visits.
        for begin, end in self.rings:
            cells |= set(range(begin, end))
        for table in self.learned.values():
            cells |= set(range(table.values, table.values + table.count))
            cells |= set(range(table.visits, table.visits + table.count))
        return sorted(cells)

    def _held(self, at: int) -> set[int]:
        """Return the results of an inference that hold if no rule fires."""
        count = self.code[at + kernel.COUNT_RESULTS]
        first = at + kernel.INFER_CELLS + self.code[at + kernel.COUNT_INPUTS]
        cells, holds = (
            self.code[first : first + count],
            self.code[first + count : first + 2 * count],
        )
        return {cell for cell, is_hold in zip(cells, holds, strict=True) if is_hold}
