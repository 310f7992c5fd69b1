"""A lookup table as a routine to export, and the statements of its function in C."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.export.names import Names, identifier
from fuzzyarm.export.numbers import C_TYPES, Kind, c_number
from fuzzyarm.export.routine import Accuracy, CallCost, CWriter, RoutineArgument, TestPoints
from fuzzyarm.export.table_numbers import FixedTable, FloatTable, WholeNumberScale
from fuzzyarm.expression.nodes import symbol
from fuzzyarm.expression.printing import c_language
from fuzzyarm.table.fidelity import dense_points
from fuzzyarm.table.header import index_words
from fuzzyarm.table.lookup import blend, corner_offsets, share_of_way, strides_of
from fuzzyarm.text.numbers import number_text

Core = FloatTable | FixedTable

MOST_CELLS = 1_000_000
"""Cells of a table in source text, which compilers read slowly."""


def fewer_levels(axes: int, cells: int) -> str:
    """Return the hint about a table with more cells than `cells`, for its number of axes."""
    return f"compile it with fewer levels:  --levels {int(cells ** (1 / axes) + 1e-9)}"


@dataclass(frozen=True, slots=True)
class Side:
    """An input that matters: one with more than one level."""

    axis: int  # its number among the inputs
    name: str  # of the parameter
    size: int  # levels
    stride: int  # cells from one of its indices to the next


# --- The statements in C ---

COUNT_FUNCTION = """INDEX NAME(const IN_FLASH TYPE *POINTS, INDEX count, TYPE x)
{
    INDEX low = 0u;
    INDEX high = count;
    while (low < high) {
        const INDEX middle = low + ((high - low) / 2u);
        if (POINTS[middle] COMPARISON x) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low; /* REMARK */
}
"""

SMALLER = {
    "POINTS": "edges",
    "COMPARISON": "<",
    "REMARK": "the number of edges smaller than x; none for NaN",
}
_REACHED = {
    "POINTS": "levels",
    "COMPARISON": "<=",
    "REMARK": "the number of levels that x has reached",
}

_CLAMP = """TYPE NAME(TYPE x, TYPE low, TYPE high)
{
    return (x > low) ? ((x < high) ? x : high) : low; /* low for NaN */
}
"""

_BLEND = """TYPE NAME(TYPE near, TYPE far, TYPE share)
{
    return VALUE;
}
"""

# Rounded to the nearest, ties away from zero: as `fuzzyarm.export.table_numbers.part`.
_BLEND_FIXED = """int32_t NAME(int32_t near, int32_t far, int32_t share)
{
    const int32_t product = (far - near) * share;
    return near + ((product >= 0) ? ((product + 16384) / 32768) : -((16384 - product) / 32768));
}
"""


class _CTable:
    """The statements of a look-up; other languages print `fuzzyarm.export.lowering`."""

    def __init__(self, core: Core, writer: CWriter, parameters: Sequence[str]) -> None:
        self.core, self.writer, self.parameters = core, writer, parameters
        self.fixed = isinstance(core, FixedTable)
        self.outer, self.inner, self.wide = (C_TYPES[kind] for kind in core.precision)
        shape = core.table.shape
        axes = enumerate(zip(parameters, shape, strides_of(shape), strict=True))
        self.sides = [Side(axis, *rest) for axis, rest in axes if rest[1] > 1]
        self.offsets = corner_offsets(shape)
        self.language = c_language(self.inner)
        # The type that holds every index, and the suffix of its literals.
        small = core.values.size <= 0xFFFF
        self.index, self.u = ("unsigned", "u") if small else ("unsigned long", "UL")

    def body(self) -> list[str]:
        """Return the statements of the function."""
        sized = zip(self.parameters, self.core.table.shape, strict=True)
        lines = [f"(void){name}; /* one level only */" for name, size in sized if size == 1]
        return lines + (self._interpolate() if self.core.linear else self._pick())

    def _literals(self, numbers: NDArray[Any]) -> list[str]:
        return [c_number(x, self.core.precision.inside) for x in numbers.tolist()]

    def _constant(self, side: Side, what: str) -> str:
        name = f"{identifier(self.core.table.axes[side.axis].name)}_{what}"
        points = self._literals(self.core.points[side.axis])
        return self.writer.constant(self.core.precision.inside, points, name)

    def _values(self) -> str:
        table = self.core.table
        name, literals = f"{identifier(table.output)}_values", self._literals(self.core.values)
        kind = self.core.precision.inside
        return self.writer.constant(kind, literals, name, columns=table.shape[-1])

    def _pick(self) -> list[str]:
        index = ""
        for side in self.sides:
            words = {"INDEX": self.index, "TYPE": self.outer, **SMALLER}
            count = self.writer.helper("cell", COUNT_FUNCTION, **words)
            edges = self._constant(side, "bins" if self.core.mode == "bins" else "middles")
            call = f"{count}({edges}, {side.size - 1}{self.u}, {side.name})"
            front = f"({index})" if "+" in index else index
            index = f"({front} * {side.size}{self.u})\n        + {call}" if index else call
        return [f"return {self._values()}[{index or '0u'}];"]

    def _interpolate(self) -> list[str]:
        names = Names(reserved=set(self.parameters))
        lines: list[str] = []
        shares: list[str] = []
        terms: list[str] = []
        for side in self.sides:
            part, share, lower = self._neighbour(side, names)
            lines += part
            shares.append(share)
            terms.append(lower if side.stride == 1 else f"({lower} * {side.stride}{self.u})")
        values = self._values()
        if not shares:
            return [f"return {self._narrow(f'{values}[0]')};"]
        cell = names.new("cell")
        kind = f"{self.writer.in_flash}{self.inner}"
        lines.append(f"const {kind} *const {cell} = &{values}[{' + '.join(terms)}];")
        helper = self._blend_helper()

        corners = [f"{cell}[{offset}{self.u}]" for offset in self.offsets]
        # Pairwise, the last input first, until one value remains.
        for axis in range(len(shares) - 1, -1, -1):
            pairs = zip(corners[0::2], corners[1::2], strict=True)
            corners = [f"{helper}({near}, {far}, {shares[axis]})" for near, far in pairs]
            if axis:
                values_of = [(names.new(f"v_{k}_{axis}"), call) for k, call in enumerate(corners)]
                lines += [f"const {self.wide} {name} = {call};" for name, call in values_of]
                corners = [name for name, _ in values_of]
        return [*lines, f"return {self._narrow(corners[0])};"]

    def _neighbour(self, side: Side, names: Names) -> tuple[list[str], str, str]:
        """Return the statements for one input, its share of the way and its lower neighbour."""
        index, u = self.index, self.u
        clamp = self.writer.helper("clamp", _CLAMP, TYPE=self.inner)
        levels = self._constant(side, "levels")
        x, i = names.new(f"x_{side.name}"), names.new(f"i_{side.name}")
        points = self._literals(self.core.points[side.axis])
        argument = f"({self.inner}){side.name}" if self.inner != self.outer else side.name
        index_text = f"0{u}"
        if side.size > 2:
            count = self.writer.helper(
                "level", COUNT_FUNCTION, INDEX=index, TYPE=self.inner, **_REACHED
            )
            index_text = f"{count}(&{levels}[1], {side.size - 2}{u}, {x})"
        t = names.new(f"t_{side.name}")
        lower, upper = f"{levels}[{i}]", f"{levels}[{i} + 1u]"
        way = share_of_way(symbol(x), symbol(lower), symbol(upper))
        share = self.language.expression(way)
        if self.fixed:
            share = f"(((int32_t){x} - {lower}) * 32768)\n        / ((int32_t){upper} - {lower})"
        return [
            f"const {self.inner} {x} = {clamp}({argument}, {points[0]}, {points[-1]});",
            f"const {index} {i} = {index_text};",
            f"const {self.wide} {t} = {share};",
        ], t, i  # fmt: skip

    def _blend_helper(self) -> str:
        if self.fixed:
            return self.writer.helper("blend", _BLEND_FIXED)
        value = self.language.expression(blend(*map(symbol, ("near", "far", "share"))))
        return self.writer.helper("blend", _BLEND, TYPE=self.inner, VALUE=value)

    def _narrow(self, expression: str) -> str:
        return expression if self.wide == self.outer else f"({self.outer}){expression}"


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

    def body(self, writer: CWriter, parameters: Sequence[str]) -> list[str]:
        """Return the statements of the function."""
        return _CTable(self.core, writer, parameters).body()

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
