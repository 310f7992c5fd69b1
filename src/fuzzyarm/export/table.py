"""A lookup table as a routine to export, and the statements of its function in C."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.export.names import Names, identifier
from fuzzyarm.export.numbers import c_number
from fuzzyarm.export.routine import (
    BLEND_FIXED,
    BLEND_FLOAT,
    CLAMP,
    COUNT_BELOW,
    COUNT_UP_TO,
    Accuracy,
    Argument,
    Cost,
    CWriter,
    Vectors,
)
from fuzzyarm.export.table_numbers import FixedTable, FloatTable, Scale
from fuzzyarm.table.fidelity import dense_points
from fuzzyarm.text.numbers import number_text

# --- The statements of a table's function in C, for floating and fixed point ---

Core = FloatTable | FixedTable


def outer_type(core: Core) -> str:
    """Return the C type of arguments and result."""
    if isinstance(core, FixedTable):
        return f"int{core.bits + 1}_t"
    return core.precision.c_outside


def inner_type(core: Core) -> str:
    """Return the C type of the constants."""
    return outer_type(core) if isinstance(core, FixedTable) else core.precision.c_inside


def literal(core: Core, value: float | int, *, inside: bool = False) -> str:
    """Return a number of the table's arithmetic as a C literal."""
    if isinstance(core, FixedTable):
        return str(int(value))
    return c_number(value, core.precision.inside if inside else core.precision.outside)


def index_type(core: Core) -> tuple[str, str]:
    """Return the C type that holds every index, and the suffix of its literals."""
    return ("unsigned", "u") if core.values.size <= 0xFFFF else ("unsigned long", "ul")


def table_body(core: Core, writer: CWriter, parameters: Sequence[str]) -> list[str]:
    """Return the statements of the function."""
    return (_interpolate if core.linear else _pick)(core, writer, parameters)


def _points(core: Core, writer: CWriter, axis: int, what: str) -> str:
    literals = [literal(core, x, inside=True) for x in core.points[axis].tolist()]
    name = f"{identifier(core.table.axes[axis].name)}_{what}"
    return writer.constant(inner_type(core), literals, name)


def _values(core: Core, writer: CWriter) -> str:
    literals = [literal(core, x, inside=True) for x in core.values.tolist()]
    name = f"{identifier(core.table.output)}_values"
    return writer.constant(inner_type(core), literals, name, columns=core.table.shape[-1])


def _pick(core: Core, writer: CWriter, parameters: Sequence[str]) -> list[str]:
    index, suffix = index_type(core)
    lines = []
    terms = ""
    for axis, (parameter, size) in enumerate(zip(parameters, core.table.shape, strict=True)):
        if size == 1:
            lines.append(f"(void){parameter}; /* one level only */")
            continue
        search = writer.helper("cell", COUNT_BELOW, INDEX=index, TYPE=outer_type(core))
        edges = _points(core, writer, axis, "bins" if core.mode == "bins" else "middles")
        call = f"{search}({edges}, {size - 1}{suffix}, {parameter})"
        scaled = f"({terms}) * {size}{suffix}" if "+" in terms else f"{terms} * {size}{suffix}"
        terms = f"{scaled}\n        + {call}" if terms else call
    return [*lines, f"return {_values(core, writer)}[{terms or '0u'}];"]


def _interpolate(core: Core, writer: CWriter, parameters: Sequence[str]) -> list[str]:
    index, suffix = index_type(core)
    fixed = isinstance(core, FixedTable)
    inner, outer = inner_type(core), outer_type(core)
    wide = "int32_t" if fixed else inner
    names = Names(taken=set(parameters))
    lines: list[str] = []
    shares: list[str] = []
    strides: list[int] = []
    terms: list[str] = []
    stride = core.values.size
    for axis, (parameter, size) in enumerate(zip(parameters, core.table.shape, strict=True)):
        stride //= size
        if size == 1:
            lines.append(f"(void){parameter}; /* one level only */")
            continue
        clamp = writer.helper("clamp", CLAMP, TYPE=inner)
        levels = _points(core, writer, axis, "levels")
        x, i = names.new(f"x_{parameter}"), names.new(f"i_{parameter}")
        first, last = (literal(core, core.points[axis][k], inside=True) for k in (0, -1))
        given = f"({inner}){parameter}" if inner != outer else parameter
        lines.append(f"const {inner} {x} = {clamp}({given}, {first}, {last});")
        found = f"0{suffix}"
        if size > 2:
            search = writer.helper("level", COUNT_UP_TO, INDEX=index, TYPE=inner)
            found = f"{search}({levels} + 1, {size - 2}{suffix}, {x})"
        lines.append(f"const {index} {i} = {found};")
        t = names.new(f"t_{parameter}")
        if fixed:
            way = f"((int32_t){x} - {levels}[{i}]) * 32768"
            share = f"{way}\n        / ((int32_t){levels}[{i} + 1u] - {levels}[{i}])"
        else:
            share = f"({x} - {levels}[{i}]) / ({levels}[{i} + 1u] - {levels}[{i}])"
        lines.append(f"const {wide} {t} = {share};")
        shares.append(t)
        strides.append(stride)
        terms.append(i if stride == 1 else f"{i} * {stride}{suffix}")
    values = _values(core, writer)
    if not shares:
        lines.append(f"return {_narrow(core, f'{values}[0]')};")
        return lines
    cell = names.new("cell")
    lines.append(f"const {inner} *const {cell} = {values} + ({' + '.join(terms)});")
    blend = (
        writer.helper("blend", BLEND_FIXED)
        if fixed
        else writer.helper("blend", BLEND_FLOAT, TYPE=inner, ONE=literal(core, 1.0, inside=True))
    )
    lines += _corners(core, names, blend, cell, shares, strides)
    return lines


def _corners(
    core: Core, names: Names, blend: str, cell: str, shares: list[str], strides: list[int]
) -> list[str]:
    """Blend the corners of a cell pairwise, the last axis first."""
    _, suffix = index_type(core)
    wide = "int32_t" if isinstance(core, FixedTable) else inner_type(core)
    offsets = [0]
    for stride in strides:
        offsets = [base + more for base in offsets for more in (0, stride)]
    values = [f"{cell}[{offset}{suffix}]" for offset in offsets]
    lines: list[str] = []
    for axis in range(len(shares) - 1, -1, -1):
        blended: list[str] = []
        for near, far in zip(values[0::2], values[1::2], strict=True):
            call = f"{blend}({near}, {far}, {shares[axis]})"
            if axis == 0:
                return [*lines, f"return {_narrow(core, call)};"]
            name = names.new(f"v_{len(blended)}_{axis}")
            lines.append(f"const {wide} {name} = {call};")
            blended.append(name)
        values = blended
    raise AssertionError("an axis remains")


def _narrow(core: Core, expression: str) -> str:
    inner = "int32_t" if isinstance(core, FixedTable) else inner_type(core)
    outer = outer_type(core)
    return expression if inner == outer else f"({outer}){expression}"


def bytes_of_locals(core: Core) -> int:
    """Return roughly what the local variables of a call take."""
    axes: int = sum(size > 1 for size in core.table.shape)
    if not core.linear:
        return 12 + 4 * axes
    wide = 4 if isinstance(core, FixedTable) else int(np.dtype(core.precision.inside).itemsize)
    return axes * (4 + 2 * wide) + (1 << axes) * wide + 16


# --- A lookup table as a routine to export ---

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
    offset = f" + {number_text(scale.offset)}" if scale.offset else ""
    return f"number * {number_text(scale.span)} / {1 << scale.bits}{offset}"


def _slabs(grid: list[NDArray[Any]]) -> Iterator[list[NDArray[Any]]]:
    rows = max(1, _SLAB // math.prod(x.size for x in grid[1:]))
    for start in range(0, grid[0].size, rows):
        yield [grid[0][start : start + rows], *grid[1:]]
