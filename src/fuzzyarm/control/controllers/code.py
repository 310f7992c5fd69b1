"""A controller in the form of its kernel: cells, instructions, and where its parts are.

:mod:`.program` writes it; the layout is described in :mod:`.kernel`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.control.controllers import kernel as to
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.setting import RunArithmetic
from fuzzyarm.symbolic.sources import SourceKind
from fuzzyarm.table import LookupTable

Sheet = RuleBase | LookupTable
"""A rule base or a table that a controller looks up."""

AXIS = "joint"
"""Input that distinguishes the tables of the axes, with levels 1, 2 …"""


class SourceError(FuzzyarmError, ValueError):
    """A rule base, a table or a port does not serve a controller."""

    def __init__(self, message: str, *, hint: str = "") -> None:
        super().__init__(message, hint=hint)


@dataclass(frozen=True)
class Wiring:
    """Where the ports of a plant are among the first cells.

    Attributes
    ----------
    references, measured, drives : dict
        The cell of each axis and port.
    partners : tuple of int
        Where a partner leaves its torque, one cell for each axis.
    size : int
        Number of cells, the clock included.
    starts : dict
        Initial values of drives whose actuators have one.
    """

    references: Mapping[tuple[str, str], int]
    measured: Mapping[tuple[str, str], int]
    drives: Mapping[tuple[str, str], int]
    partners: tuple[int, ...]
    size: int
    starts: Mapping[tuple[str, str], float]


@dataclass(frozen=True)
class Place:
    """Position of a learning table among the cells."""

    values: int
    visits: int
    count: int


@dataclass(frozen=True)
class Guard:
    """Conditions around the instructions of an axis.

    Attributes
    ----------
    begin, end : int
        Where its instructions begin and end in the code.
    count : int
        The cell that counts the skipped periods.
    every, turn : int
        The periods from one run to the next, and the cell that counts them.
    reads : tuple of int
        Cells of references and measured values; where one is not a number, the axis is skipped.
    drives : dict
        By the cell of each drive, that of its value in a skipped period: of its last value,
        or of a number.
    """

    begin: int
    end: int
    count: int
    every: int
    turn: int
    reads: tuple[int, ...]
    drives: Mapping[int, int]


@dataclass(frozen=True)
class ControllerCode:
    """A controller in the form of its kernel.

    Attributes
    ----------
    code : list of int
        The instructions and their lists.
    cells : ndarray of float64
        As they are before the first period.
    signals : dict
        The cell of each axis and signal.
    learned : dict
        Location of each learning table of each axis.
    rings : tuple of (int, int)
        The rings of learners, to be emptied before another run with the same tables.
    gains : dict
        The cells of each gain, one for each axis.
    rulebases : dict
        By the cell of their first result: name in the text and rule base.
    tables : dict
        By the cell of their first value, the name in the text and the table of one axis.
    updates : dict
        By the first cell of their frame, the sources with an update.
    guards : dict
        Of each axis its :class:`Guard`.
    last : dict
        By the cell of each drive, that of its last value.
    """

    code: list[int]
    cells: NDArray[np.float64]
    signals: Mapping[tuple[str, str], int]
    learned: Mapping[tuple[str, str], Place]
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
        return self.code[1 : 1 + to.INSTRUCTION * self.code[0] : to.INSTRUCTION]

    def memory(self) -> list[int]:
        """Return the cells that one period leaves for the next, in order."""
        code = self.code
        cells: set[int] = set()
        for at in range(1, 1 + to.INSTRUCTION * code[0], to.INSTRUCTION):
            operation, state = code[at], code[at + 3]
            # Operand b: the state of limits and slews, the frame of an update.
            cells |= {state + cell.offset for cell in to.REMEMBERED.get(operation, ())}
            if operation == to.UPDATE:
                cells |= set(range(state + 1, state + code[code[at + 2] + to.FILLED]))
            elif operation == to.INFER:
                cells |= self._held(code[at + 2])
            elif operation == to.PARTNER:
                at_list = code[at + 2]
                cells |= set(range(code[at_list + to.MEMORY], code[at_list + to.MEMORY_END]))
        for guard in self.guards.values():
            cells |= {guard.count, *guard.drives}
            if guard.every > 1:
                cells.add(guard.turn)
        # Tables that learn: the ring of cells in use, the values and their visits.
        for begin, end in self.rings:
            cells |= set(range(begin, end))
        for place in self.learned.values():
            cells |= set(range(place.values, place.values + place.count))
            cells |= set(range(place.visits, place.visits + place.count))
        return sorted(cells)

    def _held(self, at: int) -> set[int]:
        """Return the results of an inference that hold where no rule fires."""
        count = self.code[at + to.COUNT_RESULTS]
        first = at + to.INFER_CELLS + self.code[at + to.COUNT_INPUTS]
        cells, holds = (
            self.code[first : first + count],
            self.code[first + count : first + 2 * count],
        )
        return {cell for cell, is_hold in zip(cells, holds, strict=True) if is_hold}
