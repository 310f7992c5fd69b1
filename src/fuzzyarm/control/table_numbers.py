"""Lookup tables over e and ce as the flat numbers that kernels read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.control.law import Arithmetic
from fuzzyarm.control.sources import SourceError
from fuzzyarm.kernels import kernel
from fuzzyarm.lut import Axis, LookupTable

JOINT = "joint"
"""Name of the input that tells the tables of the joints apart, with levels 1 and 2."""

ROW, COLUMN = "e", "ce"


@dataclass(frozen=True)
class JointTables:
    """One table for each joint, rows e, columns ce.

    Attributes
    ----------
    rows, columns : Axis
        Of e and of ce.
    values : ndarray, shape (2, rows, columns)
        Of joint 1 and joint 2.
    mode : str
        How they are looked up.
    """

    rows: Axis
    columns: Axis
    values: NDArray[np.float64]
    mode: str

    @property
    def cells(self) -> int:
        """Cells of one table."""
        return len(self.rows.levels) * len(self.columns.levels)

    def edges(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the thresholds between rows and between columns."""
        mode = "nearest" if self.mode == "linear" else self.mode
        return self.rows.thresholds(mode), self.columns.thresholds(mode)


def joint_tables(table: LookupTable) -> JointTables:
    """Arrange a table as rows e, columns ce; one table serves both joints.

    Raises
    ------
    SourceError
        If its inputs are others than e and ce and, perhaps, joint with levels 1 and 2.
    """
    names = table.names
    if sorted(names) not in ([COLUMN, ROW], [COLUMN, ROW, JOINT]):
        raise SourceError(
            f"a controller needs a table over e and ce (and joint), not over {', '.join(names)}"
        )
    order = [names.index(name) for name in (JOINT, ROW, COLUMN) if name in names]
    values = np.transpose(table.values, order)
    if JOINT in names:
        levels = table.axis(JOINT).levels
        if levels != (1.0, 2.0):
            raise SourceError("the input joint of a table has to have the levels 1 and 2")
    else:
        values = np.stack([values, values])
    return JointTables(table.axis(ROW), table.axis(COLUMN), values, table.default_mode)


def over_joints(tables: JointTables, like: LookupTable) -> LookupTable:
    """Return both tables as one over joint, e and ce; with head and axes as `like` has them."""
    joint = Axis(JOINT, (1.0, 2.0), description="joint of the arm")
    return LookupTable(
        (joint, tables.rows, tables.columns),
        like.output,
        tables.values,
        low=like.low,
        high=like.high,
        description=like.description,
        mode=like.mode,
        provenance=like.provenance,
    )


def joined(first: LookupTable, second: LookupTable) -> LookupTable:
    """Return the tables of two joints as one.

    Raises
    ------
    SourceError
        If they do not serve, or differ in levels, bins or lookup.
    """
    one, other = joint_tables(first), joint_tables(second)
    if (one.rows.levels, one.columns.levels, one.edges(), one.mode) != (
        other.rows.levels,
        other.columns.levels,
        other.edges(),
        other.mode,
    ):
        raise SourceError("the tables of the joints differ in their levels or bins")
    values = np.stack([one.values[0], other.values[1]])
    return over_joints(JointTables(one.rows, one.columns, values, one.mode), first)


SHAPE = 3
"""Numbers in front of the edges: rows, columns, whether to interpolate."""


def pack_grid(tables: JointTables) -> list[float]:
    """Write down size, edges and levels; the values follow, or are remembered."""
    rows, columns = tables.edges()
    return [
        len(rows) + 1,
        len(columns) + 1,
        float(tables.mode == "linear"),
        *rows,
        *columns,
        *tables.rows.levels,
        *tables.columns.levels,
    ]


def pack_values(tables: JointTables, arithmetic: Arithmetic) -> list[float]:
    """Write down the values, joint 1 first, as they are stored."""
    return [arithmetic.hold(value) for value in tables.values.ravel().tolist()]


@kernel
def grid_length(numbers: list[float], at: int) -> int:
    """Return how many numbers :func:`pack_grid` wrote."""
    return SHAPE + 2 * int(numbers[at]) + 2 * int(numbers[at + 1]) - 2


@kernel
def cell_of(numbers: list[float], at: int, e: float, ce: float) -> int:
    """Return the cell of two scaled errors; one equal to an edge belongs to the lower cell."""
    rows = int(numbers[at])
    columns = int(numbers[at + 1])
    row = below(numbers, at + SHAPE, rows - 1, e)
    column = below(numbers, at + SHAPE + rows - 1, columns - 1, ce)
    return row * columns + column


@kernel
def below(numbers: list[float], first: int, count: int, value: float) -> int:
    """Count the sorted numbers that are smaller than `value`, by halving."""
    low = 0
    high = count
    while low < high:
        middle = (low + high) >> 1
        if numbers[first + middle] < value:
            low = middle + 1
        else:
            high = middle
    return low


@kernel
def interpolated(numbers: list[float], at: int, values: int, e: float, ce: float) -> float:
    """Return the value between the four cells around two scaled errors."""
    rows = int(numbers[at])
    columns = int(numbers[at + 1])
    row_levels = at + SHAPE + rows + columns - 2
    column_levels = row_levels + rows
    row, up = placed(numbers, row_levels, rows, e)
    column, right = placed(numbers, column_levels, columns, ce)
    here = values + row * columns + column
    next_row = columns if rows > 1 else 0
    next_column = 1 if columns > 1 else 0
    low = (1.0 - right) * numbers[here] + right * numbers[here + next_column]
    high = (1.0 - right) * numbers[here + next_row] + right * numbers[here + next_row + next_column]
    return (1.0 - up) * low + up * high


@kernel
def placed(numbers: list[float], levels: int, count: int, value: float) -> tuple[int, float]:
    """Return the level below a value, and the share of the way to the next."""
    if count == 1:
        return 0, 0.0
    inside = min(max(value, numbers[levels]), numbers[levels + count - 1])
    low = max(below(numbers, levels, count, inside) - 1, 0)
    low = min(low, count - 2)
    start = numbers[levels + low]
    return low, (inside - start) / (numbers[levels + low + 1] - start)
