"""A lookup table as a routine to export."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.export.numbers import Kind
from fuzzyarm.exchange.export.routine import Accuracy, CallCost, RoutineArgument, TestPoints
from fuzzyarm.exchange.export.table_numbers import FixedTable, FloatTable, WholeNumberScale
from fuzzyarm.table.fidelity import dense_points
from fuzzyarm.table.header import index_words

Core = FloatTable | FixedTable

MOST_CELLS = 1_000_000
"""Cells of a table in source text, which compilers read slowly."""


def fewer_levels(axes: int, cells: int) -> str:
    """Return the hint about a table with more cells than `cells`, for its number of axes."""
    return f"compile it with fewer levels:  --levels {int(cells ** (1 / axes) + 1e-9)}"


def bytes_of_locals(core: Core) -> int:
    """Return roughly what the local variables of a call take."""
    axes: int = sum(size > 1 for size in core.table.shape)
    if not core.linear:
        return 12 + 4 * axes
    wide = np.dtype(core.precision.wide).itemsize
    return axes * (4 + 2 * wide) + (1 << axes) * wide + 16


# --- A lookup table as a routine to export ---

_VECTORS = 48
_SLAB = 262_144
_MOST_POINTS = 3_000_000


@dataclass(frozen=True, eq=False)
class TableRoutine:
    """A table with the arithmetic it is exported in.

    `proved` is what the table nowhere differs from its rules by, where that is known.
    """

    core: Core
    proved: float | None = None

    @property
    def output(self) -> RoutineArgument:
        """The result."""
        table = self.core.table
        low, high = table.reach
        scaling = _scaling(self.core.scales[-1])
        return RoutineArgument(table.output, low, high, table.description, scaling)

    @property
    def arguments(self) -> Sequence[RoutineArgument]:
        """The arguments, in order."""
        return [
            RoutineArgument(axis.name, axis.low, axis.high, axis.description, _scaling(scale))
            for axis, scale in zip(self.core.table.axes, self.core.scales[:-1], strict=True)
        ]

    @property
    def kind(self) -> Kind:
        """The type of arguments and result."""
        return self.core.precision.outside

    def evaluate(self, *inputs: Any) -> NDArray[Any]:
        """Return what the function returns, bit for bit."""
        return self.core.evaluate(*inputs)

    def cost(self) -> CallCost:
        """Return what one call takes."""
        sizes = [size for size in self.core.table.shape if size > 1]
        searched = [size - 2 if self.core.linear else size - 1 for size in sizes]
        comparisons = sum(math.ceil(math.log2(n + 1)) for n in searched)
        operations = {"index multiplications": max(0, len(sizes) - 1)}
        if self.core.linear:
            n, blends = len(sizes), 2 ** len(sizes) - 1
            comparisons += 2 * n
            operations |= {"divisions": n, "additions and subtractions": 2 * n}
            if isinstance(self.core, FixedTable):
                operations["multiplications"] = n + blends
                operations["additions and subtractions"] += 3 * blends
                comparisons += blends
                operations["divisions by 32768 (shifts)"] = blends
            else:
                operations["multiplications"] = 2 * blends
                operations["additions and subtractions"] += 2 * blends
        return CallCost(
            (("comparisons", comparisons), *operations.items()), bytes_of_locals(self.core)
        )

    def remarks(self) -> list[str]:
        """Return what the head of the file says of index order, borders and arithmetic."""
        table, core = self.core.table, self.core
        order = ", ".join(
            f"{word} {axis.name} ({len(axis.levels)} levels)"
            for word, axis in zip(index_words(len(table.axes)), table.axes, strict=True)
        )
        lines = [f"index order: {order}; the last one varies fastest"]
        lines.append(f"looked up by {core.mode}: {_MODE_WORDS[core.mode]}")
        lines.append(
            "inputs outside the levels use the value at the border (saturation)"
            if core.linear
            else "inputs outside the cells use the value of the outer cell (saturation)"
        )
        return lines + core.remarks()

    def provenance(self) -> Sequence[tuple[str, str]]:
        """Return where the table comes from."""
        return self.core.table.provenance

    def worst_proved(self) -> float | None:
        """Return the worst error against the rules, this arithmetic included; None if unknown."""
        return None if self.proved is None else self.proved + self.core.arithmetic_error()

    @cached_property
    def accuracy(self) -> Accuracy:
        """The difference to the table in double precision over a dense grid."""
        worst, points = 0.0, 0
        for part in _slabs(self._grid()):
            mesh = np.ix_(*part)
            result = self.core.quantity(self.evaluate(*mesh))
            worst = max(worst, float(np.abs(result - self.core.truth(mesh)).max()))
            points += result.size
        return Accuracy(worst, points, f"the table of {self.core.table.output} in double precision")

    def _grid(self) -> list[NDArray[Any]]:
        dense = dense_points(self.core.table.axes)
        grid = [self.core.inputs_near(k, points) for k, points in enumerate(dense)]
        if math.prod(x.size for x in grid) > _MOST_POINTS:
            most = max(3, int(_MOST_POINTS ** (1.0 / len(grid))))
            grid = [x[:: -(-x.size // most)] for x in grid]
        return grid

    def vectors(self) -> TestPoints:
        """Return corners, edges with their neighbours and points between, mixed over the axes."""
        inputs = []
        for k in range(len(self.core.table.axes)):
            points = self.core.inputs_near(k, np.array(self.core.table.axes[k].levels))
            # Strides without a common factor combine every kind of point with every other.
            stride = (1, 7, 11, 13, 17, 19, 23, 29)[k % 8]
            inputs.append(points[(np.arange(_VECTORS) * stride + k) * 5 % points.size])
        expected = self.evaluate(*inputs)
        if isinstance(self.core, FixedTable) or not self.core.linear:
            return TestPoints(tuple(inputs), expected, 0.0)
        step = float(np.finfo(self.core.precision.outside).eps)
        scale = float(np.abs(self.core.values).max())
        return TestPoints(tuple(inputs), expected, 4.0 * step * scale)


_MODE_WORDS = {
    "bins": "an input equal to a threshold belongs to the lower cell",
    "nearest": "the nearest level; ties go to the lower one",
    "linear": "interpolation between the neighbouring levels of every input",
}


def _scaling(scale: WholeNumberScale | None) -> str:
    if scale is None:
        return ""
    offset = f" + {number_text(scale.offset)}" if scale.offset else ""
    return f"number * {number_text(scale.span)} / {1 << scale.bits}{offset}"


def _slabs(grid: list[NDArray[Any]]) -> Iterator[list[NDArray[Any]]]:
    rows = max(1, _SLAB // math.prod(x.size for x in grid[1:]))
    for start in range(0, grid[0].size, rows):
        yield [grid[0][start : start + rows], *grid[1:]]
