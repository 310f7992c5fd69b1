"""A controller as a class of MicroPython, with its state, and the self-test of the module.

Every line of the text is a line of `step`. In floats of 64 bits it has the bits of the controller.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from fuzzyarm.export.controllers import ControllerProgram
from fuzzyarm.export.listing import spread
from fuzzyarm.export.micropython import (
    RESERVED,
    PythonModule,
    TableInPython,
    module_text,
    routine_function,
)
from fuzzyarm.export.names import Names
from fuzzyarm.export.routine import plain
from fuzzyarm.export.steps import (
    LAST,
    Ask,
    Block,
    Find,
    LearningTable,
    Set,
    Step,
    Steps,
    StepVariable,
    Teach,
    first_of,
    limited_value,
)
from fuzzyarm.export.table import TableRoutine
from fuzzyarm.export.table_numbers import (
    FixedTable,
    float_table,
    scaled,
    shift_of,
    unscaled,
)
from fuzzyarm.expression.nodes import Node, symbol
from fuzzyarm.expression.printing import variables
from fuzzyarm.text.numbers import number_text

__all__ = ["python_controller"]

_SINGLE = 1e-2
"""What a port with floats of 32 bits may be off by in the self-test, of the largest drive."""


def python_controller(program: ControllerProgram, name: str) -> tuple[str, tuple[str, ...]]:
    """Return a module with a class, and how it is made and called."""
    controller = _Class(program.steps)
    body = controller.text()
    calls = ("Controller()", f"step({', '.join(controller.parameters)})")
    words = [
        *program.head(),
        "",
        f"use: controller = {name}.Controller(), then controller.{calls[1]}"
        f" every {number_text(program.text.model.period)} s",
        "step takes its arguments by name as well; it returns " + controller.returned_words(),
        "gains are attributes of the controller, to be set at any time",
        *controller.use_words(),
        f"on a board: import {name}, and {name}.self_test() is 0 where all is well",
    ]
    vectors = program.tried.vectors
    test = controller.test(
        vectors.inputs, vectors.expected, vectors.tolerance, program.tried.largest
    )
    return module_text(words, controller.module, [*controller.functions, body], test), calls


class LearnedNames(NamedTuple):
    """Attributes beside a table that learns."""

    visits: str
    ring: str
    next: str


@dataclass
class _Class:
    """The parts of the class."""

    steps: Steps
    module: PythonModule = field(default_factory=PythonModule)
    functions: list[str] = field(default_factory=list)
    starts: list[str] = field(default_factory=list)  # lines of __init__
    parameters: list[str] = field(default_factory=list)
    targets: dict[str, str] = field(default_factory=dict)  # symbol → how it is written
    tables: dict[str, str] = field(default_factory=dict)  # of learned tables: their attribute
    of_tables: dict[str, LearnedNames] = field(default_factory=dict)
    judges: dict[str, str] = field(default_factory=dict)
    cells: dict[str, str] = field(default_factory=dict)  # of grids: their function
    routines: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.module.names.new("Controller")
        self.language = self.module.language()
        self.attributes = Names("python", {"step"}, RESERVED)
        self.locals = Names("python", {"self", "last"}, RESERVED)
        for sort in ("reference", "measured"):
            for variable in self.steps.of_sort(sort):
                name = self.locals.new(self._wanted(variable))
                self.parameters.append(name)
                self._know(variable.symbol, name)
        for sort in ("gain", "signal", "state"):
            for variable in self.steps.of_sort(sort):
                self._attribute(variable)
        one = len(self.steps.model.axis_names) == 1
        for axis in self.steps.needs_first:
            name = f"self.{self.attributes.new('first' if one else f'{axis}_first')}"
            self.starts.append(f"{name} = True")
            self.language.rename[first_of(axis)] = name
        for guard, *_ in self.steps.guards:
            for drive in guard.drives:
                self._held(self.steps.variables[drive])
        if self.steps.needs_last:
            self.ends = self.locals.new("set_point_ends")
            self.parameters.append(f"{self.ends}=False")
            self.left = f"self.{self.attributes.new('periods_left')}"
            self.starts.append(f"{self.left} = {self.steps.model.every}")
            self.language.rename[LAST] = "last"
        for key, table in self.steps.learned.items():
            self._learned(key, table)

    # --- Names and attributes ---

    def _wanted(self, variable: StepVariable) -> str:
        one = len(self.steps.model.axis_names) == 1
        axis = f"{variable.axis}_" if variable.axis and not one else ""
        front = f"{variable.sort}_" if variable.sort in ("reference", "measured") else ""
        number = f"_{variable.number + 1}" if variable.number >= 0 else ""
        return f"{front}{axis}{variable.name}{number}"

    def _know(self, name: str, text: str) -> None:
        self.targets[name] = self.language.rename[name] = text

    def _attribute(self, variable: StepVariable) -> None:
        name = self.attributes.new(self._wanted(variable))
        remark = ""
        if variable.sort == "gain":
            units = {gain.name: gain.unit for gain in self.steps.model.gains}
            unit = units[variable.name]
            remark = f"  # {plain(unit)}" if unit else ""
        self.starts.append(f"self.{name} = {self.module.number(float(variable.start))}{remark}")
        self._know(variable.symbol, f"self.{name}")

    def _held(self, drive: StepVariable) -> None:
        """Make a drive an attribute: it keeps its value in a skipped period."""
        name = self.attributes.new(f"{self._wanted(drive)}_held")
        self.starts.append(f"self.{name} = {self.module.number(drive.start)}")
        self._know(drive.symbol, f"self.{name}")

    def _learned(self, key: str, table: LearningTable) -> None:
        one = len(self.steps.model.axis_names) == 1
        name = self.attributes.new(table.name if one else f"{table.axis}_{table.name}")
        beside = (self.attributes.new(f"{name}_{word}") for word in LearnedNames._fields)
        own = LearnedNames(*(f"self.{word}" for word in beside))
        self.of_tables[key] = own
        attribute = self.tables[key] = f"self.{name}"
        count = len(table.values)
        start = f"bytes({8 * count})"
        if any(table.values):
            start = self.module.array(table.values, np.float64, f"{name}_start")
        self.starts.append(f'{attribute} = array("d", {start})')
        self.starts.append(f'{own.visits} = array("i", bytes({4 * count}))')
        if table.delay:
            self.starts.append(f"{own.ring} = [-1] * {table.delay}")
            self.starts.append(f"{own.next} = 0")

    def _local(self, target: str) -> str:
        """Name a local variable: a drive as its port; no function of the module is called so."""
        drive = self.steps.variables.get(target)
        name = self.locals.new(self._wanted(drive) if drive else target.split(":")[1])
        self._know(target, name)
        return name

    # --- Statements ---

    def _statements(self) -> list[str]:
        lines: list[str] = []
        if self.steps.needs_last:
            lines += [
                f"last = {self.ends} or {self.left} <= 1",
                f"{self.left} = {self.steps.model.every} if last else {self.left} - 1",
            ]
        for block in self.steps.blocks():
            lines += self._block(block)
        drives = [self.targets[drive.symbol] for drive in self.steps.of_sort("drive")]
        return [*lines, f"return {', '.join(drives)}"] if drives else lines

    def _block(self, block: Block) -> list[str]:
        """Return the statements of a block, in the condition of its guard."""
        inner = [line for step in block.steps for line in self._step(step)]
        inner += [f"{self.language.rename[first_of(axis)]} = False" for axis in block.begun]
        guard = block.guard
        if guard is None:
            return inner
        otherwise = [
            f"{self.targets[name]} = {self.module.number(value)}"
            for name, value in guard.sent.items()
        ]
        return [
            f"if {self.language.expression(guard.condition)}:  # all are numbers",
            *(f"    {line}" for line in inner),
            *(["else:", *(f"    {line}" for line in otherwise)] if otherwise else []),
        ]

    def _step(self, step: Step) -> list[str]:
        if isinstance(step, Set):
            return self._set(step)
        if isinstance(step, Ask):
            return self._asked(step)
        if isinstance(step, Teach):
            return self._taught(step)
        if isinstance(step, Find):
            arguments = ", ".join(self.language.rename[name] for name in step.inputs)
            value = f"{self._cell(step.grid)}({arguments})"
        else:
            value = f"{self.tables[step.table]}[{self.targets[step.cell]}]"
        return [f"{self._local(step.target)} = {value}"]

    def _expression(self, value: Node) -> tuple[list[str], str]:
        """Return the lines before a value, and its text."""
        body, result = spread("part", value, self.locals.used)
        self.locals.take(variables(body))
        return self.language.lines(body), self.language.expression(result)

    def _set(self, assignment: Set) -> list[str]:
        lines, text = self._expression(assignment.value)
        if assignment.target not in self.targets:
            self._local(assignment.target)
        return [*lines, f"{self.targets[assignment.target]} = {text}"]

    def _asked(self, query: Ask) -> list[str]:
        if query.routine not in self.routines:
            name = self.routines[query.routine] = f"_{self.module.names.new(query.routine)}"
            routine = self.steps.routines[query.routine]
            self.functions.append(routine_function(routine, name, self.module)[1])
        function = self.routines[query.routine]
        core = getattr(self.steps.routines[query.routine], "core", None)
        if not isinstance(core, FixedTable):
            arguments = ", ".join(self.language.rename[name] for name in query.inputs)
            return [f"{self._local(query.target)} = {function}({arguments})"]
        lines, given_numbers = [], []
        for scale, name in zip(core.inputs, query.inputs, strict=True):
            before, text = self._expression(scaled(scale, symbol(name)))
            lines += before
            given_numbers.append(f"int({text}) - {shift_of(scale)}")
        self.language.rename["whole number"] = f"float({function}({', '.join(given_numbers)}))"
        text = self.language.expression(unscaled(core.output, symbol("whole number")))
        return [*lines, f"{self._local(query.target)} = {text}"]

    def _cell(self, key: str) -> str:
        """Return the function that finds a cell of a table that learns."""
        if key not in self.cells:
            routine = TableRoutine(float_table(self.steps.grid_tables[key], None, "float64"))
            inner = Names("python", refused=RESERVED)
            parameters = [inner.new(argument.name) for argument in routine.arguments]
            name = self.cells[key] = f"_{self.module.names.new(key)}"
            cell = TableInPython(routine, self.module, parameters, inner).cell()
            head = f"def {name}({', '.join(parameters)}):"
            self.functions.append(f"{head}\n    return {cell}\n")
        return self.cells[key]

    def _taught(self, lesson: Teach) -> list[str]:
        """Correct a table, as `learn` in the kernel does."""
        table, attribute = self.steps.learned[lesson.table], self.tables[lesson.table]
        if lesson.judge not in self.judges:
            values = np.asarray(self.steps.judges[lesson.judge].values).ravel()
            self.judges[lesson.judge] = self.module.array(values, np.float64, lesson.judge)
        judged = f"{self.judges[lesson.judge]}[{self.targets[lesson.judged]}]"
        cell = self.targets[lesson.cell]
        before, rate = self._expression(lesson.rate)
        more, bound = self._expression(lesson.bound)
        names = {role: self.locals.new(role) for role in ("responsible", "rate", "value")}
        responsible, rate_name, value = names.values()
        self.language.rename.update({"value": value, "bound": bound})
        limited = self.language.expression(limited_value())
        own = self.of_tables[lesson.table]
        ring = f"{own.ring}[{own.next}]" if table.delay else cell
        lines = [
            *before,
            *more,
            f"{responsible} = {ring}",
            f"{rate_name} = {rate}",
            f"if {responsible} >= 0 and {rate_name} != 0.0:",
            f"    {value} = {attribute}[{responsible}] + {rate_name} * {judged}",
            f"    {attribute}[{responsible}] = {limited}",
            f"{own.visits}[{cell}] += 1",
        ]
        if table.delay:
            lines.append(f"{own.ring}[{own.next}] = {cell}")
            lines.append(f"{own.next} = ({own.next} + 1) % {table.delay}")
        return lines

    # --- The class and its test ---

    def text(self) -> str:
        """Return the class."""
        statements = self._statements()
        head = f"    def step({', '.join(['self', *self.parameters])}):"
        return "\n".join(
            [
                "class Controller:",
                "    def __init__(self):",
                *(f"        {line}" for line in self.starts or ["pass"]),
                "",
                head,
                *(f"        {line}" for line in statements),
                "",
            ]
        )

    def returned_words(self) -> str:
        """Return what a step returns, as words."""
        drives = [self._wanted(drive) for drive in self.steps.of_sort("drive")]
        return drives[0] if len(drives) == 1 else f"a tuple: {', '.join(drives)}"

    def use_words(self) -> list[str]:
        """Return what else is to be known."""
        lines = []
        if self.steps.needs_last:
            lines.append(
                f"a set point lasts {self.steps.model.every} periods; where the next one comes off"
                f" that count, {self.ends} is True in the last period of the present one"
            )
        if self.steps.learned:
            names = ", ".join(name.removeprefix("self.") for name in self.tables.values())
            lines.append(f"tables that learn are arrays: {names}, each with its visits")
        return lines

    def test(
        self,
        inputs: Sequence[Sequence[float]],
        expected: Sequence[Sequence[float]],
        tolerance: float,
        largest: float,
    ) -> list[str]:
        """Return a remark, and the lines that run a sequence through the class."""
        rows = [(*ports, *drives) for ports, drives in zip(inputs, expected, strict=True)]
        width, count = len(rows[0]), len(inputs[0])
        array = self.module.array(np.array(rows).ravel(), np.float64, "test")
        ports = ", ".join(f"{array}[k + {i}]" for i in range(count))
        one = width - count == 1
        lines = [
            "controller = Controller()",
            "# a port with floats of 32 bits is as good as these",
            f"within = {tolerance!r} if 1.0 + 1e-10 != 1.0 else {_SINGLE * max(largest, 1e-30)!r}",
            f"for k in range(0, {width * len(rows)}, {width}):",
            f"    drives = controller.step({ports})",
        ]
        for i in range(width - count):
            drive, target = "drives" if one else f"drives[{i}]", f"{array}[k + {count + i}]"
            if any(math.isnan(row[count + i]) for row in rows):
                lines.append(f"    if {target} != {target} and {drive} != {drive}:")
                lines.append("        continue")
            lines.append(f"    if not abs({drive} - {target}) <= within:")
            lines.append("        return 1")
        return ["Returns 0 if a sequence of periods agrees with the controller.", *lines]
