"""A controller as a function block of Structured Text, after the blocks that it calls."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from fuzzyarm.export.controllers import ControllerProgram
from fuzzyarm.export.names import Names
from fuzzyarm.export.numbers import ST_TYPES, ExportError, rounded, st_number
from fuzzyarm.export.routine import number_lines, plain
from fuzzyarm.export.steps import (
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
)
from fuzzyarm.export.structured_text import (
    CellBlock,
    block_of,
    head_comment,
    printable_only,
    st_numbers,
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
from fuzzyarm.expression.printing import Statement, setting, statements, variables


def controller_st(program: ControllerProgram, prefix: str) -> tuple[str, str]:
    """Return the text of a controller as a function block, and the name of the block.

    Parameters
    ----------
    program : ControllerProgram
        The controller.
    prefix : str
        The name of the block; it begins the names of those that it calls.

    Raises
    ------
    ExportError
        If the language lacks something that the controller needs.
    """
    with printable_only():
        controller = _Controller(program.steps, prefix)
        return controller.text(program.head()), controller.name


@dataclass
class _Controller:
    """The parts of the block."""

    steps: Steps
    prefix: str
    members: dict[str, str] = field(default_factory=dict)  # symbol → how it is read
    targets: dict[str, str] = field(default_factory=dict)  # symbol → how it is written
    arrays: dict[str, str] = field(default_factory=dict)  # of learned tables and judges
    blocks: list[str] = field(default_factory=list)  # text of the blocks that are called
    instances: dict[str, str] = field(default_factory=dict)  # of routines and grids
    sections: dict[str, list[str]] = field(default_factory=dict)
    parts: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.file_names = Names("st")
        self.name = self.file_names.new(self.prefix)
        self.names = Names("st", {self.name})
        types = self.steps.precision
        self.outer, self.wide = ST_TYPES[types.outside], ST_TYPES[types.wide]
        self.language = st_numbers(types.wide)
        self.result: dict[str, tuple[list[str], str]] = {}
        for title in ("VAR_INPUT", "VAR_OUTPUT", "VAR CONSTANT", "VAR RETAIN", "VAR"):
            self.sections[title] = []
        self._declare()

    # --- Declarations ---

    def _declare(self) -> None:
        for sort, title in (
            ("reference", "VAR_INPUT"), ("measured", "VAR_INPUT"), ("gain", "VAR_INPUT"),
            ("drive", "VAR_OUTPUT"), ("signal", "VAR"), ("state", "VAR"),
        ):  # fmt: skip
            for variable in self.steps.of_sort(sort):
                self._variable(variable, title)
        one = len(self.steps.model.axis_names) == 1
        for axis in self.steps.needs_first:
            name = self.names.new("first" if one else f"{axis}_first")
            self.language.rename[first_of(axis)] = name
            self.sections["VAR"].append(f"    {name} : BOOL := TRUE;")
        if self.steps.needs_last:
            self.language.rename[LAST] = self.names.new("last")
            self.ends, self.left = self.names.new("set_point_ends"), self.names.new("periods_left")
            self.sections["VAR_INPUT"].append(f"    {self.ends} : BOOL;")
            every = self.steps.model.every
            self.sections["VAR"].append(f"    {self.left} : DINT := {every};")
            self.sections["VAR"].append(f"    {self.language.rename[LAST]} : BOOL;")
        for key, table in self.steps.learned.items():
            self._learned(key, table)
        for key, judge in self.steps.judges.items():
            values = np.asarray(judge.values).ravel().tolist()
            self.arrays[key] = self._array("VAR CONSTANT", key, values, judge.shape[-1])

    def _variable(self, variable: StepVariable, title: str) -> None:
        one = len(self.steps.model.axis_names) == 1
        axis = f"{variable.axis}_" if variable.axis and not one else ""
        front = f"{variable.sort}_" if variable.sort in ("reference", "measured") else ""
        number = f"_{variable.number + 1}" if variable.number >= 0 else ""
        name = self.names.new(f"{front}{axis}{variable.name}{number}")
        kind = self.wide if variable.wide else self.outer
        start = ""
        if variable.sort in ("gain", "state") or (variable.sort == "drive" and variable.start):
            start = f" := {self._number(variable.start, wide=variable.wide)}"
        remark = ""
        if variable.sort == "gain":
            unit = next(g.unit for g in self.steps.model.gains if g.name == variable.name)
            remark = f" (* {plain(unit)} *)" if unit else ""
        self.sections[title].append(f"    {name} : {kind}{start};{remark}")
        self._know(variable.symbol, name, kind)

    def _number(self, value: float, *, wide: bool = False) -> str:
        types = self.steps.precision
        kind = types.wide if wide else types.outside
        if not math.isfinite(value):
            raise ExportError("Structured Text has no infinite number", hint="export C")
        return st_number(rounded([value], kind, "a number").tolist()[0], kind)

    def _know(self, name: str, text: str, kind: str) -> None:
        self.targets[name] = text
        self.members[name] = text if kind == self.wide else f"{kind}_TO_{self.wide}({text})"
        self.language.rename[name] = self.members[name]

    def _array(self, title: str, stem: str, values: Sequence[float], columns: int = 0) -> str:
        name = self.names.new(stem)
        literals = [self._number(float(value)) for value in values]
        lines = number_lines(literals, columns, indent="        ")
        head = f"    {name} : ARRAY [0..{len(literals) - 1}] OF {self.outer} := ["
        self.sections[title].append("\n".join([head, *lines, "    ];"]))
        return name

    def _learned(self, key: str, table: LearningTable) -> None:
        one = len(self.steps.model.axis_names) == 1
        base = table.name if one else f"{table.axis}_{table.name}"
        self.arrays[key] = self._array("VAR RETAIN", base, table.values)
        last = len(table.values) - 1
        visits = self.arrays[f"{key} visits"] = self.names.new(f"{base}_visits")
        self.sections["VAR RETAIN"].append(f"    {visits} : ARRAY [0..{last}] OF DINT;")
        if table.delay:
            ring = self.arrays[f"{key} ring"] = self.names.new(f"{base}_ring")
            self.arrays[f"{key} next"] = self.names.new(f"{base}_next")
            starts = ", ".join(["-1"] * table.delay)
            self.sections["VAR"] += [
                f"    {ring} : ARRAY [0..{table.delay - 1}] OF DINT := [{starts}];",
                f"    {self.arrays[f'{key} next']} : DINT;",
            ]
        cell = self.arrays[f"{key} cell"] = self.names.new(f"{base}_responsible")
        self.sections["VAR"].append(f"    {cell} : DINT;")

    def _local(self, target: str, kind: str) -> str:
        name = self.names.new(target.split(":")[1])
        self.sections["VAR"].append(f"    {name} : {kind};")
        if kind == "DINT":
            self.targets[target] = self.members[target] = name
        else:
            self._know(target, name, kind)
        return name

    # --- The blocks that are called ---

    def _instance(self, key: str) -> str:
        """Return the instance of the block of a routine or a grid."""
        if key not in self.instances:
            type_name = self.file_names.new(f"{self.name}_{key}")
            if key in self.steps.routines:
                block = block_of(self.steps.routines[key], type_name, self.file_names)
            else:
                inner = "float32" if self.steps.precision.wide is np.float32 else "float64"
                core = float_table(self.steps.grid_tables[key], None, inner)
                block = CellBlock(TableRoutine(core), type_name)
            self.blocks.append(block.text())
            name = self.names.new(f"the_{key}" if key in self.arrays else key)
            self.sections["VAR"].append(f"    {name} : {type_name};")
            self.instances[key] = name
            self.result[key] = (block.inputs, block.output)
        return self.instances[key]

    def _call(self, key: str, arguments: Sequence[str]) -> tuple[str, str]:
        """Return the statement that calls a block, and its result."""
        instance = self._instance(key)
        inputs, output = self.result[key]
        pairs = zip(inputs, arguments, strict=True)
        passed = ", ".join(f"{name} := {value}" for name, value in pairs)
        return f"{instance}({passed});", f"{instance}.{output}"

    # --- Statements ---

    def _statements(self) -> Iterator[str]:
        if self.steps.needs_last:
            last = self.language.rename[LAST]
            yield f"{last} := {self.ends} OR ({self.left} <= 1);"
            yield f"IF {last} THEN"
            yield f"    {self.left} := {self.steps.model.every};"
            yield "ELSE"
            yield f"    {self.left} := {self.left} - 1;"
            yield "END_IF;"
        for block in self.steps.blocks():
            yield from self._block(block)

    def _block(self, block: Block) -> Iterator[str]:
        """Yield the statements of a block, in the condition of its guard."""
        inner = [line for step in block.steps for line in self._step(step)]
        inner += [f"{self.language.rename[first_of(axis)]} := FALSE;" for axis in block.begun]
        guard = block.guard
        if guard is None:
            yield from inner
            return
        yield f"IF {self.language.expression(guard.condition)} THEN (* all are numbers *)"
        yield from (f"    {line}" for line in inner)
        if guard.sent:
            yield "ELSE"
        for name, value in guard.sent.items():
            yield f"    {self.targets[name]} := {self._number(value)};"
        yield "END_IF;"

    def _step(self, step: Step) -> Iterator[str]:
        if isinstance(step, Set):
            yield from self._set(step)
        elif isinstance(step, Ask):
            yield from self._asked(step)
        elif isinstance(step, Find):
            arguments = [self.members[name] for name in step.inputs]
            call, result = self._call(step.grid, arguments)
            yield call
            yield f"{self._local(step.target, 'DINT')} := {result};"
        elif isinstance(step, Pick):
            value = f"{self.arrays[step.table]}[{self.targets[step.cell]}]"
            yield f"{self._local(step.target, self.outer)} := {value};"
        else:
            yield from self._taught(step)

    def _parts(self, value: Node) -> tuple[tuple[Statement, ...], Node]:
        """Return the statements that set parts of a value; a choice is not an expression here."""
        body, result = statements(value, prefix="part_", reserved=self.names.used)
        self.names.take(variables(body))
        self.parts |= set(variables(body))
        return body, result

    def _expression(self, value: Node) -> tuple[list[str], str]:
        """Return the lines before a value, and its text."""
        body, result = self._parts(value)
        return self.language.lines(body), self.language.expression(result)

    def _set(self, assignment: Set) -> Iterator[str]:
        variable = self.steps.variables.get(assignment.target)
        if variable is not None:
            kind = self.wide if variable.wide else self.outer
        else:
            kind = self.outer if assignment.rounded else self.wide
        if kind == self.wide and not (assignment.rounded and self.outer != self.wide):
            body, value = self._parts(assignment.value)
            target = self._target(assignment.target, kind)
            yield from self.language.lines(setting(target, body, value))
            return
        lines, text = self._expression(assignment.value)
        yield from lines
        text = f"{self.wide}_TO_{self.outer}({text})"
        if kind == self.wide:
            text = f"{self.outer}_TO_{self.wide}({text})"
        yield f"{self._target(assignment.target, kind)} := {text};"

    def _target(self, target: str, kind: str) -> str:
        """Return the variable that a step sets; a local one is declared."""
        is_variable = target in self.steps.variables
        return self.targets[target] if is_variable else self._local(target, kind)

    def _asked(self, query: Ask) -> Iterator[str]:
        routine = self.steps.routines[query.routine]
        core = getattr(routine, "core", None)
        if not isinstance(core, FixedTable):
            kind = ST_TYPES[routine.kind]
            arguments = [
                self.targets[name] if kind != self.wide else self.members[name]
                for name in query.inputs
            ]
            call, result = self._call(query.routine, arguments)
            yield call
            yield f"{self._local(query.target, kind)} := {result};"
            return
        kind, arguments = ST_TYPES[routine.kind], []
        for scale, name in zip(core.inputs, query.inputs, strict=True):
            lines, text = self._expression(scaled(scale, symbol(name)))
            yield from lines
            arguments.append(f"DINT_TO_{kind}(TRUNC({text}) - {shift_of(scale)})")
        call, result = self._call(query.routine, arguments)
        yield call
        self.language.rename["whole number"] = f"{kind}_TO_{self.wide}({result})"
        text = self.language.expression(unscaled(core.output, symbol("whole number")))
        yield f"{self._local(query.target, self.wide)} := {text};"

    def _taught(self, lesson: Teach) -> Iterator[str]:
        """Correct a table, as `learn` in the kernel does."""
        table, key = self.steps.learned[lesson.table], lesson.table
        values, cell = self.arrays[key], self.targets[lesson.cell]
        responsible = self.arrays[f"{key} cell"]
        narrow = self.outer != self.wide
        rate, bound = (self.language.expression(node) for node in (lesson.rate, lesson.bound))
        judged = f"{self.arrays[lesson.judge]}[{self.targets[lesson.judged]}]"
        old = f"{values}[{responsible}]"
        if narrow:
            judged, old = (f"{self.outer}_TO_{self.wide}({text})" for text in (judged, old))
        value = f"{old} + {rate} * {judged}"
        if narrow:
            value = f"{self.outer}_TO_{self.wide}({self.wide}_TO_{self.outer}({value}))"
        value = f"MIN(MAX({value}, -{bound}), {bound})"
        value = f"{self.wide}_TO_{self.outer}({value})" if narrow else value
        zero = self.language.number(0.0)
        if table.delay:
            ring, place = self.arrays[f"{key} ring"], self.arrays[f"{key} next"]
            yield f"{responsible} := {ring}[{place}];"
        else:
            yield f"{responsible} := {cell};"
        yield f"IF ({responsible} >= 0) AND ({rate} <> {zero}) THEN"
        yield f"    {values}[{responsible}] := {value};"
        yield "END_IF;"
        visits = f"{self.arrays[f'{key} visits']}[{cell}]"
        yield f"{visits} := {visits} + 1;"
        if table.delay:
            yield f"{ring}[{place}] := {cell};"
            yield f"{place} := ({place} + 1) MOD {table.delay};"

    # --- The file ---

    def text(self, words: Sequence[str]) -> str:
        """Return the file."""
        lines = list(self._statements())
        targets = {line.strip().partition(" := ")[0] for line in lines}
        self.sections["VAR"] += [
            f"    {part} : {self.wide};" for part in sorted(self.parts & targets)
        ]
        declarations = []
        for title, section_lines in self.sections.items():
            if section_lines:
                declarations += [title, *section_lines, "END_VAR"]
        head = head_comment([*words, "", *self._use_words()])
        block = [*head, f"FUNCTION_BLOCK {self.name}", *declarations, "", *lines]
        return "\n".join([*self.blocks, *block, "END_FUNCTION_BLOCK", ""])

    def _use_words(self) -> Iterator[str]:
        yield f"call it every {self.steps.model.period:g} s; gains are inputs, with their values"
        if self.steps.needs_last:
            yield (
                f"a set point lasts {self.steps.model.every} periods; where the next one comes off"
                f" that count, {self.ends} is TRUE in the last period of the present one"
            )
        if self.steps.learned:
            yield "tables that learn are RETAIN: they survive a loss of power"
