"""A controller as a program: its steps as statements of a step function, over a state."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import zip_longest

import numpy as np

from fuzzyarm.exchange.export.listing import spread
from fuzzyarm.exchange.export.lowering import cell_function, routine_function
from fuzzyarm.exchange.export.numbers import Kind, rounded
from fuzzyarm.exchange.export.steps import (
    LAST,
    Ask,
    Block,
    Find,
    LearningTable,
    Pick,
    Set,
    Step,
    Steps,
    StepVariable,
    Teach,
    first_of,
    last_of,
    limited_value,
    turn_of,
)
from fuzzyarm.exchange.export.table import FixedTable, float_table, scaled, shift_of, unscaled
from fuzzyarm.exchange.export.typed_program import (
    COUNT,
    INDEX,
    TRUTH,
    WHOLE,
    Called,
    Cast,
    Element,
    Fires,
    Function,
    Line,
    Member,
    Program,
    Return,
    Store,
    Truth,
    Variable,
    When,
    Whole,
    at,
    cast,
)
from fuzzyarm.symbolic.nodes import Node, apply, constant, replace, symbol, symbols
from fuzzyarm.symbolic.op import where
from fuzzyarm.symbolic.printing import Assign, variables

ALL_NUMBERS, SETTLED = "all are numbers", "so is what was found"
"""Remark of the condition under which an axis does its period."""

IN_TURN = "its turn"
"""Remark of the condition under which a slow axis runs."""

ENDS, LEFT = "set point ends", "periods left"
"""The argument for the last period of a set point, and the member that counts the periods."""


_REMARKS = {
    "first": "whether no period was run yet", "state": "remembered", "table": "learns",
    "visits": "of each cell", "ring": "cells in use before; -1: none",
    "held": "last value of the drive", "last": "last value of the drive",
    "turn": "periods since its last run",
}  # fmt: skip
"""Purposes of members, by their role."""


def controller_program(
    steps: Steps, *, pointers: bool = False, endless: bool = True, flags: bool = False
) -> Program:
    """Return a controller as a program, without its test, for a language with these traits.

    `flags`: a rule base has a flag for "no value", since the language has no NaN.
    """
    return _Lowering(steps, Program(pointers=pointers, endless=endless), flags).lowered()


@dataclass
class _Lowering:
    """The walk over the steps."""

    steps: Steps
    program: Program
    flags: bool = False
    parameters: dict[str, Variable] = field(default_factory=dict)
    local: dict[str, Variable] = field(default_factory=dict)
    # Substitutes of symbols: expressions used once, and narrow variables, widened at each use.
    known: dict[str, Node] = field(default_factory=dict)
    kinds: dict[str, Kind] = field(default_factory=dict)
    held: dict[str, str] = field(default_factory=dict)
    fired: list[Node] = field(default_factory=list)
    lessons: list[Line] = field(default_factory=list)
    taught: dict[str, tuple[Node, Node, Node]] = field(default_factory=dict)

    def lowered(self) -> Program:
        """Return the program."""
        precision = self.steps.precision
        self.outer, self.wide = precision.outside, precision.wide
        self.several = not self.steps.model.has_one_axis
        self._declare()
        body = list(self._statements())
        drives = [symbol(drive.symbol) for drive in self.steps.of_sort("drive")]
        if drives:
            body.append(Return(drives[0], tuple(drives[1:])))
        self.program.step = Function(
            "step", self.parameters, self.outer, body, self.local, self.wide, public=True
        )
        return self.program

    # ── declarations ─────────────────────────────────────────────────────────────────

    def _declare(self) -> None:
        for sort in ("reference", "measured"):
            for variable in self.steps.of_sort(sort):
                self.parameters[variable.symbol] = Variable(self.stem(variable), self.outer)
                self._know(variable.symbol, self.outer)
        units = {gain.name: gain.unit for gain in self.steps.model.gains}
        for sort in ("gain", "signal", "state"):
            for variable in self.steps.of_sort(sort):
                kind = self.wide if variable.wide else self.outer
                number = f"_{variable.number + 1}" if variable.number >= 0 else ""
                unit = units.get(variable.name, "") if sort == "gain" else ""
                self._member(variable.symbol, f"{variable.name}{number}", kind, variable.start,
                             axis=variable.axis, remark=unit, role=sort)  # fmt: skip
        self._declare_clock()
        for key, table in self.steps.learned.items():
            self._learned(key, table)
        self._declare_drives()

    def _declare_clock(self) -> None:
        for axis in self.steps.needs_first:
            self._member(first_of(axis), "first", TRUTH, True, axis=axis, role="first")
        if self.steps.needs_last:
            if not self.program.pointers:
                self.parameters[ENDS] = Variable("set_point_ends", TRUTH)
            self._member(LEFT, "periods_left", INDEX, self.steps.model.every, role="clock")
            self.local[LAST] = Variable("last", TRUTH)

    def _declare_drives(self) -> None:
        for guard in (block.guard for block in self.steps.blocks):
            for name, sent in guard.drives.items():
                drive = self.steps.variables[name]
                if sent is None:
                    self.held[name] = last_of(name)
                if sent is None or name in self.steps.remembered:
                    role = "held" if sent is None else "last"
                    self._member(last_of(name), f"{drive.name}_{role}", self.outer, drive.start,
                                 axis=guard.axis, role=role)  # fmt: skip
            if guard.every > 1:
                self._member(turn_of(guard.axis), "turn", INDEX, 0, axis=guard.axis, role="turn")
        for drive in self.steps.of_sort("drive"):
            variable = Variable(self.stem(drive), self.outer)
            self.local[drive.symbol] = self.program.drives[drive.symbol] = variable
            self.kinds[drive.symbol] = self.outer

    def stem(self, port: StepVariable) -> str:
        """Return the name of a port: with its axis if there are several."""
        front = "" if port.sort == "drive" else f"{port.sort}_"
        return f"{front}{self._of_axis(port.axis, port.name)}"

    def _of_axis(self, axis: str, name: str) -> str:
        return f"{axis}_{name}" if self.several and axis else name

    def _member(
        self, key: str, name: str, kind: Kind, start: float | tuple[float, ...], *,
        axis: str = "", remark: str = "", role: str = "",
    ) -> None:  # fmt: skip
        if kind in {np.float32, np.float64}:
            several = isinstance(start, tuple)
            values = rounded(start if isinstance(start, tuple) else [start], kind, f"'{name}'")
            start = tuple(values.tolist()) if several else values.tolist()[0]
        stem, remark = self._of_axis(axis, name), remark or _REMARKS.get(role, "")
        self.program.state[key] = Member(stem, kind, start, axis, remark, role, name)
        if not isinstance(start, tuple):
            self._know(key, kind)

    def _know(self, key: str, kind: Kind) -> None:
        self.kinds[key] = kind
        if kind is self.outer and self.outer is not self.wide:
            self.known[key] = Cast(symbol(key), self.outer, self.wide)

    def _learned(self, key: str, table: LearningTable) -> None:
        count = len(table.values)
        self._member(key, table.name, self.outer, table.values, axis=table.axis, role="table")
        members: list[tuple[str, Kind, float | tuple[float, ...]]] = [
            ("visits", COUNT, (0,) * count)
        ]
        if table.delay:
            members += [("ring", _cell_kind(table), (-1,) * table.delay), ("next", INDEX, 0)]
        for word, kind, start in members:
            name = f"{table.name}_{word}"
            self._member(f"{key} {word}", name, kind, start, axis=table.axis, role=word)

    # ── statements ───────────────────────────────────────────────────────────────────

    def _statements(self) -> Iterator[Line]:
        if self.steps.needs_last:
            left, ended = symbol(LEFT), symbol(LEFT) <= at(1)
            yield Assign(LAST, ended if self.program.pointers else symbol(ENDS) | ended)
            yield Assign(LEFT, where(symbol(LAST), at(self.steps.model.every), left - at(1)))
        self.uses = self.steps.uses()
        for block in self.steps.blocks:
            yield from self._block(block)

    def _block(self, block: Block) -> Iterator[Line]:
        """Yield the statements of an axis, with its state updates under its condition."""
        guard = block.guard
        begun: list[Line] = []
        for name, value in guard.sent.items():
            if guard.every > 1:
                yield Assign(name, symbol(last_of(name)))
            sent = constant(rounded([value], self.outer, "a drive").tolist()[0])
            begun.append(Assign(name, sent))
        inner: list[Line] = []
        self.fired, self.lessons = [], []
        for step, following in zip_longest(block.steps, block.steps[1:]):
            inner += self._step(step, following)
        lasting = [*self.lessons, *(line for step in block.lasting for line in self._set(step))]
        if guard.axis in self.steps.needs_first:
            lasting.append(Assign(first_of(guard.axis), Truth(False)))
        settled = guard.settled
        for fires in self.fired:
            settled = fires if settled is None else settled & fires
        inner = [*inner, *self._when(settled, lasting, SETTLED)]
        lines = [*begun, *self._when(guard.condition, inner, ALL_NUMBERS)]
        lines += [Assign(last_of(name), symbol(name)) for name in guard.sent
                  if name in self.steps.remembered]  # fmt: skip
        if guard.every > 1:
            turn = symbol(turn_of(guard.axis))
            yield from self._when(apply("equal", turn, at(0)), lines, IN_TURN)
            yield Assign(turn.name, where(turn < at(guard.every - 1), turn + at(1), at(0)))
        else:
            yield from lines
        for name in guard.drives:
            if name in self.held:
                yield Assign(name, symbol(self.held[name]))

    def _when(self, condition: Node | None, lines: list[Line], remark: str) -> list[Line]:
        if condition is None:
            return lines
        return [When(self._plain(condition), tuple(lines), (), remark)]

    def _step(self, step: Step, following: Step | None) -> list[Line]:
        if isinstance(step, Set):
            return self._set(step)
        if isinstance(step, Teach):
            return list(self._taught(step))
        if isinstance(step, Ask):
            value, kind = self._routine_call(step)
        elif isinstance(step, Find):
            inputs = tuple(self._read(name) for name in step.inputs)
            value, kind = Called(self._cell(step.grid), inputs), INDEX
        else:
            value, kind = self._picked(step), self.outer
        once = isinstance(following, Set) and self.uses.get(step.target) == 1
        if isinstance(step, Ask) and self._may_lack_value(step):
            fires = f"fires {step.target}"
            self.local[fires] = Variable("fires", TRUTH)
            self.fired.append(symbol(fires))
            self._local(step.target, kind)
            key = f"routine {step.routine}"
            return [Assign(step.target, value), Assign(fires, Fires(key))]
        if once and kind is not INDEX and step.target in symbols(following.value):  # type: ignore[union-attr]
            self.known[step.target] = cast(value, kind, self.wide)
            return []
        self._local(step.target, kind)
        return [Assign(step.target, value)]

    def _local(self, target: str, kind: Kind) -> None:
        self.local[target] = Variable(target.split(":")[1], kind)
        self._know(target, kind)

    def _read(self, name: str, kind: Kind | None = None) -> Node:
        """Return a symbol's substitute in arithmetic, or in its stored form if `kind` is that."""
        if kind is not None and self.kinds.get(name) is kind:
            return symbol(name)
        return self.known.get(name, symbol(name))

    def _plain(self, value: Node) -> Node:
        """Return an expression over the substitutes of its symbols."""
        return replace(value, {name: self._read(name) for name in symbols(value)})

    def _value(self, value: Node) -> tuple[list[Line], Node]:
        """Return the lines before a value, and the value: parts used twice come first."""
        body, result = spread("part", value, self.local)
        for name in variables(body):
            self.local[name] = Variable("part", self.wide)
        lines = [_renewed(line, self._plain) for line in body]
        return lines, self._plain(result)

    def _set(self, assignment: Set) -> list[Line]:
        lines, value = self._value(assignment.value)
        target, narrow = assignment.target, assignment.rounded and self.outer is not self.wide
        if target not in self.kinds:
            self._local(target, self.outer if assignment.rounded else self.wide)
        kind = self.kinds[target]
        if kind is self.wide and narrow:  # wide for a later line: zoom
            value = Cast(Cast(value, self.wide, self.outer), self.outer, self.wide)
        elif kind is not self.wide:
            same = isinstance(value, Cast) and value.before is kind
            value = value.value if same else cast(value, self.wide, kind)  # type: ignore[attr-defined]
        return [*lines, Assign(self.held.get(target, target), value)]

    # ── rule bases and tables ────────────────────────────────────────────────────────

    def _routine_call(self, query: Ask) -> tuple[Node, Kind]:
        """Return the call of a routine and the kind of its result."""
        routine, key = self.steps.routines[query.routine], f"routine {query.routine}"
        if key not in self.program.functions:
            made = routine_function(routine, query.routine, self.program, public=False)
            self.program.functions[key] = made
        core = getattr(routine, "core", None)
        if not isinstance(core, FixedTable):
            inputs = tuple(self._read(name, routine.kind) for name in query.inputs)
            return Called(key, inputs), routine.kind
        numbers: list[Node] = []
        for scale, name in zip(core.inputs, query.inputs, strict=True):
            steps = cast(self._plain(scaled(scale, symbol(name))), self.wide, WHOLE)
            numbers.append(cast(steps - Whole(shift_of(scale)), WHOLE, routine.kind))
        number = cast(Called(key, tuple(numbers)), routine.kind, self.wide)
        return replace(unscaled(core.output, symbol("number")), {"number": number}), self.wide

    def _may_lack_value(self, query: Ask) -> bool:
        """Whether a rule base has a flag for "no value"."""
        return self.flags and self.program.functions[f"routine {query.routine}"].may_lack_value

    def _cell(self, grid: str) -> str:
        """Return the key of the function that finds a cell of a table that learns."""
        key = f"cell {grid}"
        if key not in self.program.functions:
            inner = "float32" if self.wide is np.float32 else "float64"
            core = float_table(self.steps.grid_tables[grid], None, inner)
            self.program.functions[key] = cell_function(core, grid, self.program)
        return key

    def _taught(self, lesson: Teach) -> Iterator[Line]:
        """Correct a table, as `learn` in the kernel does."""
        table, key, cell = self.steps.learned[lesson.table], lesson.table, symbol(lesson.cell)
        judge = self.steps.judges[lesson.judge]
        values = rounded(np.asarray(judge.values).ravel(), self.outer, f"table '{lesson.judge}'")
        judges = self.program.array(lesson.judge, self.outer, values.tolist(), judge.shape[-1])
        judged = cast(Element(judges, symbol(lesson.judged)), self.outer, self.wide)
        number = sum(name.startswith("responsible") for name in self.local)
        cells = _cell_kind(table)
        kinds = {"responsible": cells, "rate": self.wide, "teaches": TRUTH, "value": self.wide,
                 "corrected": self.outer}  # fmt: skip
        names = {role: f"{role} {number}" for role in kinds}
        for role, kind in kinds.items():
            self.local[names[role]] = Variable(role, kind)
        responsible, rate_name, teaches, value, corrected = map(symbol, names.values())
        before, rate = self._value(lesson.rate)
        more, bound = self._value(lesson.bound)
        corrected_cell = cast(responsible, cells, INDEX)
        old = cast(Element(key, corrected_cell), self.outer, self.wide)
        limited = replace(limited_value(), {"value": value, "bound": bound})
        ring = Element(f"{key} ring", symbol(f"{key} next"))
        taken: Node = ring if table.delay else cast(cell, INDEX, cells)
        added = old + rate_name * judged
        if self.outer is not self.wide:
            added = Cast(Cast(added, self.wide, self.outer), self.outer, self.wide)
        yield from (*before, *more)
        yield Assign(names["responsible"], taken)
        yield Assign(names["rate"], rate)
        yield Assign(names["value"], constant(0.0))
        is_known = Whole(0, cells) <= responsible
        yield Assign(names["teaches"], is_known & ~apply("equal", rate_name, 0.0))
        remark = "none is, before the first delay is over" if table.delay else ""
        yield When(teaches, (Assign(names["value"], added),), remark=remark)
        yield Assign(names["corrected"], cast(limited, self.wide, self.outer))
        self.taught[key] = teaches, corrected_cell, corrected
        self.lessons += self._lesson(table, key, cell)

    def _lesson(self, table: LearningTable, key: str, cell: Node) -> Iterator[Line]:
        """Yield the state updates of learning: the corrected value, the visit, the ring."""
        teaches, corrected_cell, corrected = self.taught[key]
        yield When(teaches, (Store(key, corrected_cell, corrected),))
        visits = f"{key} visits"
        yield Store(visits, cell, Element(visits, cell) + Whole(1, COUNT))
        if table.delay:
            following = symbol(f"{key} next")
            yield Store(f"{key} ring", following, cast(cell, INDEX, _cell_kind(table)))
            later = where(following + at(1) < at(table.delay), following + at(1), at(0))
            yield Assign(following.name, later if table.delay > 1 else at(0))

    def _picked(self, step: Pick) -> Node:
        """Return the value of a cell, as a lesson of this period corrects it."""
        cell = symbol(step.cell)
        value: Node = Element(step.table, cell)
        if step.table not in self.taught:
            return value
        teaches, corrected_cell, corrected = self.taught[step.table]
        picked: Node = where(teaches & apply("equal", corrected_cell, cell), corrected, value)
        return picked


def _cell_kind(table: LearningTable) -> Kind:
    """Return the kind of a cell, where -1 is none."""
    return np.int16 if len(table.values) <= 0x7FFF else WHOLE


def _renewed(line: Line, change: object) -> Line:
    """Return a statement with other expressions."""
    values = (
        change(value) if isinstance(value, Node)  # type: ignore[operator]
        else tuple(_renewed(part, change) for part in value) if isinstance(value, tuple)
        else value
        for value in line
    )  # fmt: skip
    return type(line)(*values)
