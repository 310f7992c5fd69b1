"""The statements of a table's function in C, for floating and fixed point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fuzzyarm.export import c_writer
from fuzzyarm.export.c_writer import CWriter
from fuzzyarm.export.fixed_point import FixedTable
from fuzzyarm.export.float_table import FloatTable
from fuzzyarm.export.names import Names, identifier
from fuzzyarm.export.numbers import c_number

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
        search = writer.helper("cell", c_writer.COUNT_BELOW, INDEX=index, TYPE=outer_type(core))
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
        clamp = writer.helper("clamp", c_writer.CLAMP, TYPE=inner)
        levels = _points(core, writer, axis, "levels")
        x, i = names.new(f"x_{parameter}"), names.new(f"i_{parameter}")
        first, last = (literal(core, core.points[axis][k], inside=True) for k in (0, -1))
        given = f"({inner}){parameter}" if inner != outer else parameter
        lines.append(f"const {inner} {x} = {clamp}({given}, {first}, {last});")
        found = f"0{suffix}"
        if size > 2:
            search = writer.helper("level", c_writer.COUNT_UP_TO, INDEX=index, TYPE=inner)
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
        writer.helper("blend", c_writer.BLEND_FIXED)
        if fixed
        else writer.helper(
            "blend", c_writer.BLEND_FLOAT, TYPE=inner, ONE=literal(core, 1.0, inside=True)
        )
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
