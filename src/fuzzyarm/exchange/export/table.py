"""A lookup table in the numbers of a small machine (floating point, Q15, Q7), as a routine."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.export.numbers import (
    C_TYPES,
    ExportError,
    Kind,
    Precision,
    precision_named,
    rounded,
    rounded_down,
)
from fuzzyarm.exchange.export.routine import Accuracy, CallCost, RoutineArgument, TestPoints
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import Node
from fuzzyarm.table import Axis, LookupTable
from fuzzyarm.table.axis import mode_named
from fuzzyarm.table.fidelity import dense_points
from fuzzyarm.table.header import index_words
from fuzzyarm.table.lookup import OVER_ARRAYS, LookupArithmetic, PreparedTable

MOST_AXES = 8
"""Interpolation over more inputs would take more than 256 corners."""

Reals = NDArray[np.floating]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class NumberTable:
    """A table in the numbers of a machine, looked up by their arithmetic."""

    arithmetic: ClassVar[LookupArithmetic] = OVER_ARRAYS
    table: LookupTable  # the table in double precision
    mode: str  # ``bins``, ``nearest`` or ``linear``
    # For each axis the thresholds between the cells, rounded down so that a comparison decides as
    # one in double precision does; with ``linear`` the levels.
    points: tuple[NDArray[Any], ...]
    values: NDArray[Any]  # flat, the last axis fastest
    precision: Precision  # the types of numbers

    @property
    def linear(self) -> bool:
        """Whether it interpolates."""
        return self.mode == "linear"

    def _steepest(self) -> list[float]:
        """Return the largest difference between neighbouring values along each axis."""
        values = self.table.values
        return [
            float(np.abs(np.diff(values, axis=k)).max()) if size > 1 else 0.0
            for k, size in enumerate(values.shape)
        ]

    def _look_up(self, columns: Sequence[NDArray[Any]]) -> NDArray[Any]:
        grid = PreparedTable.of(self.table.shape, self.points, self.values, self.arithmetic)
        values = grid.interpolate(columns) if self.linear else grid.pick(columns)
        return np.broadcast_to(values, columns[0].shape)


# --- A lookup table in floating point ---


class FloatTable(NumberTable):
    """A table whose inputs, cells and result are floating-point numbers."""

    def evaluate(self, *inputs: Any) -> Reals:
        """Return the exported function's result, bit for bit, in the outer type.

        The inputs, in the order of the axes, are rounded to that type first. NaN counts as the
        lower border of its axis.
        """
        outside, inside, _ = self.precision
        with np.errstate(over="ignore"):
            arguments = np.broadcast_arrays(*(np.asarray(x, dtype=outside) for x in inputs))
        columns = [np.where(np.isnan(x), outside(-math.inf), x).astype(inside) for x in arguments]
        return self._look_up(columns).astype(outside)

    def arithmetic_error(self) -> float:
        """Return a bound on the difference between result and table in this arithmetic.

        Shares of the way are off by the rounding of levels and of three operations, each blend
        by that of four, and the result once more; doubled, for terms of second order.
        """
        values = self.table.values
        if not self.linear:  # the cell is right: only the value is rounded
            return float(np.abs(values.astype(self.precision.outside) - values).max())
        inside, outside = (float(np.finfo(real).eps) for real in self.precision[1::-1])
        largest = float(np.abs(values).max())
        error = (outside + (1.0 + 4.0 * len(self.table.axes)) * inside) * largest
        for axis, steepest in zip(self.table.axes, self._steepest(), strict=True):
            if len(axis.levels) > 1:
                far = max(map(abs, axis.levels))
                width = min(b - a for a, b in pairwise(axis.levels))
                error += (4.0 + 2.0 * far / width) * inside * steepest
        return 2.0 * error

    @property
    def scales(self) -> list[WholeNumberScale | None]:
        """Of the inputs and the output: none."""
        return [None] * (len(self.table.axes) + 1)

    def remarks(self) -> list[str]:
        """Return the header comment's lines on numbers."""
        words = self.precision.words
        if not self.linear:
            words = (
                f"{C_TYPES[self.precision.outside]} comparisons; thresholds are rounded so that"
                " the cell is the one that double precision finds for the same number"
            )
        return ["an input that is not a number (NaN) counts as the lower border", words]

    def truth(self, mesh: Sequence[NDArray[Any]]) -> NDArray[np.float64]:
        """Return the table in double precision at some inputs."""
        quantities = [x.astype(np.float64) for x in mesh]
        return np.asarray(self.table.lookup(*quantities, mode=self.mode))

    def quantity(self, result: Reals) -> NDArray[np.float64]:
        """Return the meaning of results."""
        return result.astype(np.float64)

    def inputs_near(self, k: int, dense: NDArray[np.float64]) -> Reals:
        """Return dense points of an axis, edges with their neighbours and points outside."""
        levels, outside = self.table.axes[k].levels, self.precision.outside
        close = np.concatenate([self.points[k].astype(outside), np.array(levels, dtype=outside)])
        around = [np.nextafter(close, outside(way)) for way in (-np.inf, np.inf)]
        width = levels[-1] - levels[0] or 1.0
        beyond = np.array([levels[0] - width, levels[-1] + width])
        with np.errstate(over="ignore"):
            points = np.concatenate([dense.astype(outside), close, *around, beyond.astype(outside)])
        return np.unique(points[np.isfinite(points)])


def float_table(
    table: LookupTable, mode: str | None = None, precision: str = "mixed"
) -> FloatTable:
    """Prepare a table in floating point; refuse levels that coincide in the type."""
    lookup_mode = _chosen_mode(table, mode)
    linear = lookup_mode == "linear"
    types = precision_named(precision, arithmetic=linear)
    points = []
    for axis in table.axes:
        rounded((axis.levels[0], axis.levels[-1]), types.outside, f"axis '{axis.name}'")
        if linear:
            levels = rounded(axis.levels, types.inside, f"axis '{axis.name}'")
            _require_distinct(levels, axis.name)
            points.append(levels)
        else:
            edges = axis.thresholds(lookup_mode)
            points.append(rounded_down(edges, types.inside, f"axis '{axis.name}'"))
    name = f"the table of '{table.output}'"
    rounded(table.values, types.outside, name)
    values = rounded(table.values.ravel(), types.inside, name)
    return FloatTable(table, lookup_mode, tuple(points), values, types)


def _chosen_mode(table: LookupTable, mode: str | None) -> str:
    lookup_mode = table.default_mode if mode is None else mode_named(mode)
    if lookup_mode == "linear" and len(table.axes) > MOST_AXES:
        raise ExportError(
            f"the table has {len(table.axes)} inputs; interpolation is exported for at most"
            f" {MOST_AXES}",
            hint="export it with --mode nearest",
        )
    return lookup_mode


def _require_distinct(levels: Reals, name: str) -> None:
    for a, b in pairwise(levels.tolist()):
        if not a < b:
            raise ExportError(
                f"two levels of '{name}' are the same number ({a:g}) in single precision",
                hint="export with --precision mixed or float64",
            )


# --- A lookup table in whole numbers: Q15 in int16, Q7 in int8, with 32-bit arithmetic ---
#
# A quantity v is held as a whole number r = 2^q (v - offset) / span, rounded to the nearest and
# kept within -2^q … 2^q - 1. Offset is the middle and span half the width of its range, so
# that a range of -6 … 6 has offset 0 and span 6. Both are chosen by the exporter and stated in
# the exported file; everything between input and output is integer arithmetic, and
# `FixedTable.evaluate` is the same arithmetic in Python.

FORMATS = {
    15: Precision(np.int16, np.int16, np.int32),
    7: Precision(np.int8, np.int8, np.int32),
}
"""Available fraction bits, and the types: Q15 in 16 bits, Q7 in 8."""

SHARE_BITS = 15
"""Fraction bits of the share between two levels, whatever the format."""

ONE = 1 << SHARE_BITS


@dataclass(frozen=True, slots=True)
class WholeNumberScale:
    """How a quantity becomes a whole number."""

    offset: float  # the quantity at 0
    span: float  # quantity of 2^bits steps; positive
    bits: int  # fraction bits: 15 or 7

    @property
    def low(self) -> int:
        """The smallest whole number."""
        return -(1 << self.bits)

    @property
    def high(self) -> int:
        """The largest whole number."""
        return (1 << self.bits) - 1

    @property
    def step(self) -> float:
        """The quantity of one step."""
        return self.span / (1 << self.bits)

    def exact(self, value: float) -> Fraction:
        """Return `value` in steps of the whole numbers, without rounding."""
        return (Fraction(value) - Fraction(self.offset)) * (1 << self.bits) / Fraction(self.span)

    def nearest(self, value: float) -> int:
        """Return `value` as a whole number: the nearest one, ties to even, saturated."""
        return min(max(round(self.exact(value)), self.low), self.high)

    def below(self, value: float) -> int:
        """Return the largest whole number whose quantity does not exceed `value`."""
        return min(max(math.floor(self.exact(value)), self.low), self.high)

    def quantity(self, numbers: Any) -> NDArray[np.float64]:
        """Return the meaning of integers."""
        return self.offset + np.asarray(numbers, dtype=np.float64) * self.step


def scale_over(numbers: Sequence[float], bits: int) -> WholeNumberScale:
    """Return the scale whose range just holds all finite `numbers`."""
    finite = [x for x in numbers if math.isfinite(x)]
    low, high = min(finite), max(finite)
    span = 0.5 * high - 0.5 * low
    if not math.isfinite(span * 2.0):
        raise ExportError(
            f"the range {low:g} .. {high:g} is too wide for fixed point",
            hint="leave out --q",
        )
    return WholeNumberScale(0.5 * low + 0.5 * high, span if span > 0.0 else 1.0, bits)


# The conversion from a floating-point signal to a whole number and back, as printed.


def shift_of(scale: WholeNumberScale) -> int:
    """Return the offset that makes an integer nonnegative."""
    return -scale.low


def scaled(scale: WholeNumberScale, x: Node) -> Node:
    """Return a quantity in steps of whole numbers, shifted: cut off, it is rounded.

    NaN becomes the lowest number.
    """
    steps = (x - scale.offset) * (1.0 / scale.step) if scale.offset else x * (1.0 / scale.step)
    inside: Node = op.minimum(op.maximum(float(scale.low), steps), float(scale.high))
    return inside + (shift_of(scale) + 0.5)


def unscaled(scale: WholeNumberScale, number: Node) -> Node:
    """Return the quantity of a whole number."""
    value = number * scale.step
    return value + scale.offset if scale.offset else value


def whole_share(x: Integers, lower: Integers, upper: Integers) -> Integers:
    """Return the share of the way in steps of 2^-15, rounded down."""
    return (x - lower) * ONE // (upper - lower)


def whole_blend(near: Integers, far: Integers, share: Integers) -> Integers:
    """Return the value at a share of the way, rounded to the nearest as :func:`part` is."""
    return near + part(far - near, share)


def part(difference: Integers, share: Integers) -> Integers:
    """Return difference × share / 2^15, rounded to the nearest, ties away from zero.

    Both signs alike, so that a table that is its own mirror image stays so.
    """
    product = difference * share
    magnitude = (np.abs(product) + ONE // 2) // ONE
    return np.asarray(np.where(product < 0, -magnitude, magnitude))


IN_WHOLE_NUMBERS = OVER_ARRAYS._replace(share=whole_share, blend=whole_blend)
"""The arithmetic of fixed point, over arrays."""


@dataclass(frozen=True, eq=False)
class FixedTable(NumberTable):
    """A table whose inputs, cells and result are whole numbers.

    Attributes
    ----------
    inputs : tuple of WholeNumberScale
        One for each axis.
    output : WholeNumberScale
        Of the result.
    """

    arithmetic = IN_WHOLE_NUMBERS
    inputs: tuple[WholeNumberScale, ...]
    output: WholeNumberScale

    def evaluate(self, *inputs: Any) -> Integers:
        """Return the exported function's result, bit for bit.

        Inputs, in the order of the axes, and result are whole numbers within the format.
        """
        columns = np.broadcast_arrays(*(np.asarray(x, dtype=np.int64) for x in inputs))
        return np.array(self._look_up(columns))

    def arithmetic_error(self) -> float:
        """Return a bound on the difference between result and table in this arithmetic.

        A value is rounded by half a step, and so is each blend. A share of the way is rounded down
        by 2⁻¹⁵, and levels are rounded by a known amount; each moves the value by that share of the
        difference to its neighbour.
        """
        values = self.table.values
        rounded_values = self.output.quantity(self.values).reshape(values.shape)
        error = float(np.abs(rounded_values - values).max())
        if not self.linear:
            return error
        error += 0.5 * self.output.step * len(self.table.axes)
        for k, (axis, scale) in enumerate(zip(self.table.axes, self.inputs, strict=True)):
            if len(axis.levels) < 2:
                continue
            exact = [float(scale.exact(level)) for level in axis.levels]
            shift = max(abs(a - int(b)) for a, b in zip(exact, self.points[k], strict=True))
            widths = [b - a for a, b in pairwise(exact)] + np.diff(self.points[k]).tolist()
            share = 2.0**-SHARE_BITS + shift / min(widths)
            error += share * self._steepest()[k]
        return error * (1.0 + 1e-9)

    @property
    def scales(self) -> list[WholeNumberScale | None]:
        """Of the inputs and the output."""
        return [*self.inputs, self.output]

    def remarks(self) -> list[str]:
        """Return the header comment's lines on numbers."""
        scale = self.output
        return [
            f"q{scale.bits}: whole numbers of {scale.bits + 1} bits, 32-bit arithmetic, no"
            " floating point; scale an input to the nearest whole number and saturate it to"
            f" {scale.low} .. {scale.high}",
            "whole numbers have no NaN: the caller decides about a value that is not a number",
        ]

    def truth(self, mesh: Sequence[NDArray[Any]]) -> NDArray[np.float64]:
        """Return the table in double precision at some inputs."""
        if self.linear:
            quantities = [scale.quantity(x) for scale, x in zip(self.inputs, mesh, strict=True)]
            return np.asarray(self.table.lookup(*quantities, mode="linear"))
        # The thresholds are whole numbers by exact arithmetic: the cell is right, and only the
        # value is rounded.
        cells = replace(self, values=np.arange(self.values.size)).evaluate(*mesh)
        return np.asarray(self.table.values.ravel()[cells])

    def quantity(self, result: Integers) -> NDArray[np.float64]:
        """Return the meaning of results."""
        return self.output.quantity(result)

    def inputs_near(self, k: int, dense: NDArray[np.float64]) -> Integers:
        """Return dense points of an axis and edges with their neighbours."""
        scale, edges = self.inputs[k], self.points[k]
        # Anywhere between edges will do, so these are rounded without fractions, at once.
        steps = np.rint((dense - scale.offset) / scale.span * (1 << scale.bits))
        ends = np.array([scale.low, scale.high])
        near = [edges - 1, edges, edges + 1, ends, np.clip(steps, *ends).astype(np.int64)]
        return np.unique(np.clip(np.concatenate(near), *ends))


def fixed_table(table: LookupTable, bits: int, mode: str | None = None) -> FixedTable:
    """Prepare a table in Q15 or Q7; refuse levels that coincide in the format."""
    if bits not in FORMATS:
        raise ExportError(f"no fixed-point format q{bits}", hint="there are q15 and q7")
    lookup_mode = _chosen_mode(table, mode)
    scales = tuple(
        scale_over((axis.low, axis.high, *axis.levels, *axis.thresholds(lookup_mode)), bits)
        for axis in table.axes
    )
    points = tuple(
        _points(axis, scale, lookup_mode) for axis, scale in zip(table.axes, scales, strict=True)
    )
    ends = () if table.low is None or table.high is None else (table.low, table.high)
    output = scale_over((*ends, float(table.values.min()), float(table.values.max())), bits)
    values = np.array([output.nearest(x) for x in table.values.ravel().tolist()], dtype=np.int64)
    return FixedTable(table, lookup_mode, points, values, FORMATS[bits], scales, output)


def _points(axis: Axis, scale: WholeNumberScale, mode: str) -> Integers:
    if mode != "linear":
        return np.array([scale.below(x) for x in axis.thresholds(mode)], dtype=np.int64)
    levels = np.array([scale.nearest(x) for x in axis.levels], dtype=np.int64)
    for i in np.flatnonzero(np.diff(levels) <= 0).tolist():
        raise ExportError(
            f"the levels {axis.levels[i]:g} and {axis.levels[i + 1]:g} of '{axis.name}' are the"
            f" same number in q{scale.bits}",
            hint="take fewer levels" if scale.bits == max(FORMATS) else "take q15",
        )
    return levels


Core = FloatTable | FixedTable

MOST_CELLS = 1_000_000
"""Cells of a table in source text, which compilers read slowly."""


def fewer_levels(axes: int, cells: int) -> str:
    """Return the hint about a table with more cells than `cells`, for its number of axes."""
    return f"compile it with fewer levels:  --levels {int(cells ** (1 / axes) + 1e-9)}"


def bytes_of_locals(core: Core) -> int:
    """Return the approximate size of a call's local variables."""
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

    `proved` is the bound on the difference between table and rules, if known.
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
        """Return the function's result, bit for bit."""
        return self.core.evaluate(*inputs)

    def cost(self) -> CallCost:
        """Return the cost of one call."""
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
        """Return the header comment's lines on index order, borders and arithmetic."""
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
        """Return the provenance of the table."""
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
