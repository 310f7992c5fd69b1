"""Rule bases and tables as functions of a program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.exchange.export.kernel_lowering import walk_lines
from fuzzyarm.exchange.export.listing import Loop, Walked, element, function_body
from fuzzyarm.exchange.export.numbers import Kind, rounded
from fuzzyarm.exchange.export.program import Call
from fuzzyarm.exchange.export.routine import Routine, RoutineArgument
from fuzzyarm.exchange.export.rulebase import DirectRoutine
from fuzzyarm.exchange.export.table import Core, FixedTable, TableRoutine
from fuzzyarm.exchange.export.typed_program import (
    INDEX,
    WHOLE,
    Called,
    Cast,
    Element,
    Function,
    Line,
    Program,
    Quotient,
    Repeat,
    Return,
    SelfTest,
    Variable,
    View,
    Whole,
    at,
    cast,
)
from fuzzyarm.symbolic.identifiers import identifier
from fuzzyarm.symbolic.nodes import Node, constant, replace, symbol
from fuzzyarm.symbolic.op import where
from fuzzyarm.symbolic.printing import Assign, Choose, Statement
from fuzzyarm.table.lookup import blend, corner_offsets, share_of_way, strides_of

SINGLE_TEST = 1e-4
"""Tolerance of a port with floats of 32 bits in a self-test, as a share of the largest result."""


def routines_program(
    routines: Sequence[Routine], *, pointers: bool = False, endless: bool = True
) -> Program:
    """Return a program with a function for each routine, and their tests."""
    program = Program(pointers=pointers, endless=endless)
    for number, routine in enumerate(routines):
        key = f"routine {number}"
        program.functions[key] = routine_function(routine, routine.output.name, program)
        test = _test(routine, key)
        if test.rows:
            program.tests.append(test)
        program.inputs += [
            each
            for each in map(_described, routine.arguments)
            if each["name"] not in {other["name"] for other in program.inputs}
        ]
        program.outputs.append(_described(routine.output))
    return program


def _described(argument: RoutineArgument) -> dict[str, Any]:
    low, high = jsonable((argument.low, argument.high))
    return {"name": argument.name, "low": low, "high": high, "description": argument.description}


def routine_function(
    routine: Routine, stem: str, program: Program, *, public: bool = True
) -> Function:
    """Return the function of a rule base or a table; its callees are added to the program."""
    if isinstance(routine, TableRoutine):
        return _Table(routine.core, program).looked_up(stem, public=public)
    assert isinstance(routine, DirectRoutine)
    return _Rules(routine, program).function(stem, public=public)


def cell_function(core: Core, stem: str, program: Program) -> Function:
    """Return the function that finds the cell of a table that its inputs fall into."""
    return _Table(core, program).cell_function(stem)


# ── rules ────────────────────────────────────────────────────────────────────────────


@dataclass
class _Rules:
    """A rule base: the statements of its listing, with calls and elements in place of symbols."""

    routine: DirectRoutine
    program: Program

    def function(self, stem: str, *, public: bool) -> Function:
        """Return the function of the output."""
        listing, types = self.routine.listing, self.routine.precision
        outside, inside, _ = types
        parameters, body = {}, list[Line]()
        for number, argument in enumerate(self.routine.arguments):
            parameters[f"parameter {number}"] = Variable(argument.name, outside)
        for given, parameter in zip(self.routine.program.symbols, parameters, strict=True):
            if given in listing.reads:
                body.append(Assign(given, Cast(symbol(parameter), outside, inside)))
        self.instead: dict[str, Node] = {}
        for name, (call, argument_of_call) in listing.calls.items():
            if name in listing.reads:
                argument_node = replace(argument_of_call, self.instead)
                self.instead[name] = Called(self._called(call, inside), (argument_node,))
        counters = {}
        for loop in listing.body:
            if isinstance(loop, Walked):
                parts = tuple(replace(part, self.instead) for part in loop.parts)
                body += walk_lines(loop.walk, parts, self.program)
                continue
            if isinstance(loop, Loop):
                counters[loop.sums.index] = Variable(loop.sums.index, INDEX)
                body += self._loop(loop)
            else:
                body.append(self._statement(loop))
        result = replace(listing.result, self.instead)
        body.append(Return(cast(result, inside, outside)))
        return Function(
            stem, parameters, outside, body, counters, inside, public=public,
            result=self.routine.output.name, may_lack_value=True,
        )  # fmt: skip

    def _called(self, call: Call, real: Kind) -> str:
        *body, last = function_body(call)
        assert isinstance(last, Assign)
        lines = [*body, Return(last.value)]
        key = f"{call.stem} {np.dtype(real)} {lines!r}"
        parameters = {"h": Variable("h", real)}
        return self.program.function(key, Function(call.stem, parameters, real, lines, real=real))

    def _statement(self, statement: Statement) -> Statement:
        if isinstance(statement, Assign):
            return statement._replace(value=replace(statement.value, self.instead))
        then, otherwise = (
            tuple(map(self._statement, branch)) for branch in (statement.then, statement.otherwise)
        )
        return Choose(statement.name, replace(statement.condition, self.instead), then, otherwise)

    def _loop(self, loop: Loop) -> list[Line]:
        sums, kind = loop.sums, self.routine.precision.inside
        for name, column in sums.columns.items():
            values = rounded(column, kind, name).tolist()
            array = self.program.array(sums.stems[name], kind, values)
            self.instead[element(sums, name)] = Element(array, symbol(sums.index))
        return [
            *(Assign(name, constant(0.0)) for name in (sums.area, sums.moment)),
            Repeat(sums.index, sums.count, tuple(map(self._statement, loop.body))),
        ]


# ── tables ───────────────────────────────────────────────────────────────────────────


@dataclass
class _Table:
    """A table: the cell of the inputs, or the blend of the corners around them."""

    core: Core
    program: Program

    def __post_init__(self) -> None:
        self.fixed = isinstance(self.core, FixedTable)
        self.outside, self.inside, self.wide = self.core.precision
        self.parameters = {
            f"parameter {k}": Variable(axis.name, self.outside)
            for k, axis in enumerate(self.core.table.axes)
        }
        self.body: list[Line] = []
        self.local: dict[str, Variable] = {}

    def looked_up(self, stem: str, *, public: bool) -> Function:
        """Return the function that looks a value up."""
        value = self._interpolated() if self.core.linear else Element(self._values(), self._cell())
        self.body.append(Return(value))
        return Function(
            stem, self.parameters, self.outside, self.body, self.local, self.wide, public=public,
            result=self.core.table.output,
        )  # fmt: skip

    def cell_function(self, stem: str) -> Function:
        """Return the function that finds the number of a cell."""
        body = [Return(self._cell())]
        return Function(stem, self.parameters, INDEX, body, {}, self.wide, result="cell")

    def _number(self, value: float) -> Node:
        return Whole(int(value), self.inside) if self.fixed else constant(float(value))

    def _points(self, axis: int, part: str) -> str:
        stem = f"{identifier(self.core.table.axes[axis].name)}_{part}"
        return self.program.array(stem, self.inside, self.core.points[axis].tolist())

    def _values(self) -> str:
        table = self.core.table
        stem, columns = f"{identifier(table.output)}_values", table.shape[-1]
        return self.program.array(stem, self.inside, self.core.values.tolist(), columns)

    def _axes(self) -> list[tuple[int, str, int]]:
        """Return the axes with more than one level: number, parameter, levels."""
        sizes = zip(self.parameters, self.core.table.shape, strict=True)
        return [(k, name, size) for k, (name, size) in enumerate(sizes) if size > 1]

    def _cell(self) -> Node:
        part = "bins" if self.core.mode == "bins" else "middles"
        index: Node | None = None
        for axis, name, size in self._axes():
            points = self._points(axis, part)
            level = self.program.search(
                points, 0, size - 1, symbol(name), kind=self.inside, reached=False
            )
            index = level if index is None else index * at(size) + level
        return at(0) if index is None else index

    def _interpolated(self) -> Node:
        strides = strides_of(self.core.table.shape)
        shares, cell = [], None
        for axis, name, size in self._axes():
            share, index = self._neighbour(axis, name, size)
            shares.append(share)
            step = index if strides[axis] == 1 else index * at(strides[axis])
            cell = step if cell is None else cell + step
        values = self._values()
        if cell is None:
            return cast(Element(values, at(0)), self.inside, self.outside)
        offsets = corner_offsets(self.core.table.shape)
        if self.program.pointers:
            self.body.append(View("cell", values, cell))
            elements = [Element("cell", at(k)) for k in offsets]
        else:
            first = self._set("cell", INDEX, cell)
            elements = [Element(values, first + at(k) if k else first) for k in offsets]
        corners: list[Node] = [cast(element, self.inside, self.wide) for element in elements]
        blended = self.program.function(f"blend {np.dtype(self.wide)}", self._blend())
        for side in range(len(shares) - 1, -1, -1):
            pairs = list(zip(corners[0::2], corners[1::2], strict=True))
            corners = [Called(blended, (near, far, shares[side])) for near, far in pairs]
            if side:
                corners = [
                    self._set(f"v_{k}_{side}", self.wide, value) for k, value in enumerate(corners)
                ]
        return cast(corners[0], self.wide, self.outside)

    def _neighbour(self, axis: int, name: str, size: int) -> tuple[Node, Node]:
        """Return the share of the way between two levels of an input, and the lower one."""
        levels, (low, *_, high) = self._points(axis, "levels"), self.core.points[axis].tolist()
        stem = self.parameters[name].stem
        given = cast(symbol(name), self.outside, self.inside)
        ends = self._number(low), self._number(high)
        limited = Called(self._clamp(), (given, *ends))
        x = self._set(f"x_{stem}", self.inside, limited)
        lower: Node = at(0)
        if size > 2:
            lower = self.program.search(levels, 1, size - 2, x, kind=self.inside, reached=True)
        index = self._set(f"i_{stem}", INDEX, lower)
        way_ends = Element(levels, index), Element(levels, index + at(1))
        way = [cast(node, self.inside, self.wide) for node in (x, *way_ends)]
        if self.fixed:
            share: Node = Quotient((way[0] - way[1]) * Whole(32768), way[2] - way[1])
        else:
            share = share_of_way(*way)
        return self._set(f"t_{stem}", self.wide, share), index

    def _set(self, name: str, kind: Kind, value: Node) -> Node:
        """Set a new variable, and return its symbol."""
        while name in self.local:
            name += "_"
        self.local[name] = Variable(name, kind)
        self.body.append(Assign(name, value))
        return symbol(name)

    def _clamp(self) -> str:
        kind = self.inside
        x, low, high = (symbol(name) for name in ("x", "low", "high"))
        limited: Node = where(low < x, where(x < high, x, high), low)
        parameters = {name: Variable(name, kind) for name in ("x", "low", "high")}
        lines = [Return(limited)]
        clamp = Function("clamp", parameters, kind, lines, real=kind, remark="low for NaN")
        return self.program.function(f"clamp {np.dtype(kind)}", clamp)

    def _blend(self) -> Function:
        near, far, share = (symbol(name) for name in ("near", "far", "share"))
        parameters = {name: Variable(name, self.wide) for name in ("near", "far", "share")}
        if not self.fixed:
            return Function(
                "blend", parameters, self.wide, [Return(blend(near, far, share))], real=self.wide
            )
        # Rounded to the nearest, ties away from zero: as
        # `fuzzyarm.exchange.export.table.part`.
        product, half, one = symbol("product"), Whole(16384), Whole(32768)
        body = [
            Assign("product", (far - near) * share),
            Choose(
                "value", Whole(0) <= product,
                (Assign("value", near + Quotient(product + half, one)),),
                (Assign("value", near - Quotient(half - product, one)),),
            ),
            Return(symbol("value")),
        ]  # fmt: skip
        local = {name: Variable(name, WHOLE) for name in ("product", "value")}
        return Function("blend", parameters, self.wide, body, local, self.wide)


# ── the self-test ────────────────────────────────────────────────────────────────────


def _test(routine: Routine, key: str) -> SelfTest:
    vectors = routine.vectors()
    columns = [np.asarray(column).tolist() for column in (*vectors.inputs, vectors.expected)]
    largest = float(np.nanmax(np.abs(vectors.expected.astype(np.float64)), initial=1e-30))
    whole = np.issubdtype(routine.kind, np.integer)
    rows = list(zip(*columns, strict=True))
    loose = 0.0 if whole else SINGLE_TEST * largest
    return SelfTest(key, routine.kind, rows, len(columns) - 1, vectors.tolerance, loose)
