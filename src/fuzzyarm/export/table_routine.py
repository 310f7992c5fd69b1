"""A lookup table as a routine to export."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.export.c_writer import CWriter
from fuzzyarm.export.fixed_point import FixedTable, Scale
from fuzzyarm.export.float_table import FloatTable
from fuzzyarm.export.routine import Accuracy, Argument, Cost, Vectors
from fuzzyarm.export.table_c import Core, bytes_of_locals, literal, outer_type, table_body
from fuzzyarm.lut.fidelity import dense_points
from fuzzyarm.lut.numbers import number

_VECTORS = 48
_SLAB = 262_144
_MOST_POINTS = 3_000_000


@dataclass(frozen=True, eq=False)
class TableRoutine:
    """A table with the arithmetic it is exported in.

    Attributes
    ----------
    core : FloatTable or FixedTable
        The arithmetic.
    """

    core: Core

    @property
    def output(self) -> Argument:
        """The result."""
        table = self.core.table
        low = float(table.values.min()) if table.low is None else table.low
        high = float(table.values.max()) if table.high is None else table.high
        scale = self.core.output if isinstance(self.core, FixedTable) else None
        return Argument(table.output, low, high, table.description, _scaling(scale))

    @property
    def arguments(self) -> Sequence[Argument]:
        """The arguments, in order."""
        scales: Sequence[Scale | None] = (
            self.core.inputs
            if isinstance(self.core, FixedTable)
            else [None] * len(self.core.table.axes)
        )
        return [
            Argument(axis.name, axis.low, axis.high, axis.description, _scaling(scale))
            for axis, scale in zip(self.core.table.axes, scales, strict=True)
        ]

    @property
    def kind(self) -> str:
        """The C type of arguments and result."""
        return outer_type(self.core)

    def evaluate(self, *inputs: Any) -> NDArray[Any]:
        """Return what the function returns, bit for bit."""
        return self.core.evaluate(*inputs)

    def literal(self, value: Any) -> str:
        """Return an argument or a result as a C literal."""
        return literal(self.core, value)

    def body(self, writer: CWriter, parameters: Sequence[str]) -> list[str]:
        """Return the statements of the function."""
        return table_body(self.core, writer, parameters)

    def cost(self) -> Cost:
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
        return Cost((("comparisons", comparisons), *operations.items()), bytes_of_locals(self.core))

    def remarks(self) -> list[str]:
        """Return what the head of the file says of index order, borders and arithmetic."""
        table, core = self.core.table, self.core
        places = ["column", "row", *["page"] * len(table.axes)][: len(table.axes)][::-1]
        order = ", ".join(
            f"{place} {axis.name} ({len(axis.levels)} levels)"
            for place, axis in zip(places, table.axes, strict=True)
        )
        lines = [f"index order: {order}; the last one varies fastest"]
        lines.append(f"looked up by {core.mode}: {_MODE_WORDS[core.mode]}")
        lines.append(
            "inputs beyond the outer levels take the value at the border (saturation)"
            if core.linear
            else "inputs beyond the outer cells take the value of the outer cell (saturation)"
        )
        if isinstance(core, FixedTable):
            lines.append(
                f"q{core.bits}: whole numbers of {core.bits + 1} bits, 32-bit arithmetic, no"
                " floating point; scale an input to the nearest whole number and saturate it to"
                f" {core.output.low} .. {core.output.high}"
            )
        else:
            lines.append("an input that is not a number (NaN) counts as the lower border")
            lines.append(_arithmetic_words(core))
        return lines

    def provenance(self) -> Sequence[tuple[str, str]]:
        """Return where the table comes from."""
        return self.core.table.provenance

    def accuracy(self) -> Accuracy:
        """Return :attr:`measured`, as all routines do."""
        return self.measured

    @cached_property
    def measured(self) -> Accuracy:
        """Compare with the table in double precision over a dense grid."""
        worst, points = 0.0, 0
        table = self.core.table
        for part in _slabs(self._grid()):
            mesh = np.ix_(*part)
            result = self.evaluate(*mesh)
            truth = self._truth(mesh)
            if isinstance(self.core, FixedTable):
                result = self.core.output.quantity(result)
            worst = max(worst, float(np.abs(result.astype(np.float64) - truth).max()))
            points += result.size
        return Accuracy(worst, points, f"the table of {table.output} in double precision")

    def _truth(self, mesh: Sequence[NDArray[Any]]) -> NDArray[np.float64]:
        core = self.core
        if isinstance(core, FloatTable):
            given = [x.astype(np.float64) for x in mesh]
            return np.asarray(core.table.lookup(*given, mode=core.mode))
        if core.linear:
            given = [scale.quantity(x) for scale, x in zip(core.inputs, mesh, strict=True)]
            return np.asarray(core.table.lookup(*given, mode="linear"))
        # The thresholds are whole numbers by exact arithmetic: the cell is right, and only the
        # value is rounded.
        cells = replace(core, values=np.arange(core.values.size)).evaluate(*mesh)
        return np.asarray(core.table.values.ravel()[cells])

    def _grid(self) -> list[NDArray[Any]]:
        grid = [self._axis_points(k, dense) for k, dense in enumerate(self._dense())]
        if math.prod(x.size for x in grid) > _MOST_POINTS:
            most = max(3, int(_MOST_POINTS ** (1.0 / len(grid))))
            grid = [x[:: -(-x.size // most)] for x in grid]
        return grid

    def _dense(self) -> list[NDArray[np.float64]]:
        return dense_points(self.core.table.axes)

    def _axis_points(self, k: int, dense: NDArray[np.float64]) -> NDArray[Any]:
        """Return dense points, edges with their neighbours and points outside, as arguments."""
        axis, edges = self.core.table.axes[k], self.core.points[k]
        if isinstance(self.core, FixedTable):
            scale = self.core.inputs[k]
            whole = [scale.nearest(x) for x in dense.tolist()]
            near = [edges - 1, edges, edges + 1, np.array([scale.low, scale.high, *whole])]
            return np.unique(np.clip(np.concatenate(near), scale.low, scale.high))
        outside = self.core.precision.outside
        close = np.concatenate([edges.astype(outside), np.array(axis.levels, dtype=outside)])
        around = [np.nextafter(close, outside(way)) for way in (-np.inf, np.inf)]
        width = axis.levels[-1] - axis.levels[0] or 1.0
        beyond = np.array([axis.levels[0] - width, axis.levels[-1] + width])
        with np.errstate(over="ignore"):
            points = np.concatenate([dense.astype(outside), close, *around, beyond.astype(outside)])
        return np.unique(points[np.isfinite(points)])

    def vectors(self) -> Vectors:
        """Return corners, edges with their neighbours and points between, mixed over the axes."""
        inputs = []
        for k in range(len(self.core.table.axes)):
            points = self._axis_points(k, np.array(self.core.table.axes[k].levels))
            # Strides without a common factor combine every kind of point with every other.
            stride = (1, 7, 11, 13, 17, 19, 23, 29)[k % 8]
            inputs.append(points[(np.arange(_VECTORS) * stride + k) * 5 % points.size])
        expected = self.evaluate(*inputs)
        if isinstance(self.core, FixedTable) or not self.core.linear:
            return Vectors(tuple(inputs), expected, 0.0)
        step = float(np.finfo(self.core.precision.outside).eps)
        scale = float(np.abs(self.core.values).max())
        return Vectors(tuple(inputs), expected, 4.0 * step * scale)


_MODE_WORDS = {
    "bins": "an input equal to a threshold belongs to the lower cell",
    "nearest": "the nearest level; a tie goes to the lower one",
    "linear": "interpolation between the neighbouring levels of every input",
}


def _arithmetic_words(core: FloatTable) -> str:
    inside, outside = core.precision.c_inside, core.precision.c_outside
    if not core.linear:
        return (
            f"{outside} comparisons; thresholds are rounded so that the cell is the one that double"
            " precision finds for the same number"
        )
    if inside == outside:
        return f"{inside} arithmetic"
    return f"double arithmetic, the result rounded to {outside}"


def _scaling(scale: Scale | None) -> str:
    if scale is None:
        return ""
    offset = f" + {number(scale.offset)}" if scale.offset else ""
    return f"number * {number(scale.span)} / {1 << scale.bits}{offset}"


def _slabs(grid: list[NDArray[Any]]) -> Iterator[list[NDArray[Any]]]:
    rows = max(1, _SLAB // math.prod(x.size for x in grid[1:]))
    for start in range(0, grid[0].size, rows):
        yield [grid[0][start : start + rows], *grid[1:]]
