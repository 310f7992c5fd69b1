"""A controller in C99: a struct with what it remembers, `init` and `step`, and its self-test."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest

import numpy as np

from fuzzyarm.export.c import (
    SWITCH,
    CLibrary,
    for_cxx,
    guarded,
    library_file,
    library_writer,
    routine_headers,
    test_function,
)
from fuzzyarm.export.listing import c_numbers, needs_math_header, spread
from fuzzyarm.export.names import Names, identifier
from fuzzyarm.export.numbers import C_TYPES, Kind, c_number, rounded, rounded_down
from fuzzyarm.export.routine import CWriter, comment, plain
from fuzzyarm.export.steps import (
    LAST,
    Ask,
    Block,
    Find,
    Grid,
    LearningTable,
    Set,
    Step,
    Steps,
    StepVariable,
    Teach,
    first_of,
    limited_value,
)
from fuzzyarm.export.table import COUNT_FUNCTION, SMALLER
from fuzzyarm.export.table_numbers import FixedTable, scaled, shift_of, unscaled
from fuzzyarm.expression.nodes import Node, postorder, symbol, symbols
from fuzzyarm.expression.printing import variables as names_set
from fuzzyarm.text.numbers import number_text

_NAN_HEADER = ("#include <math.h> /* NAN */", "")

_FUNCTIONS = ("init", "step", "save", "load")

POINTERS = {"reference": "reference", "measured": "measured", "drive": "drive"}
"""The arguments of the step that hold ports, by their sort."""


@dataclass(frozen=True)
class TestSequence:
    """A sequence of periods for the self-test: ports, row by row, and the drives."""

    inputs: Sequence[Sequence[float]]
    expected: Sequence[Sequence[float]]
    tolerance: float


@dataclass
class CController:
    """The parts of a C file of a controller.

    Attributes
    ----------
    steps : Steps
        The controller.
    writer : CWriter
        Of the file: its prefix begins every name.
    """

    steps: Steps
    writer: CWriter
    members: dict[str, str] = field(default_factory=dict)  # symbol → how C reads it
    targets: dict[str, str] = field(default_factory=dict)  # symbol → how C writes it
    functions: dict[str, str] = field(default_factory=dict)  # of routines and grids
    tables: dict[str, str] = field(default_factory=dict)  # of learned tables: their member
    judges: dict[str, str] = field(default_factory=dict)
    held: dict[str, str] = field(default_factory=dict)  # of drives: the member with the last value

    def __post_init__(self) -> None:
        self.prefix = self.writer.prefix
        for word in ("state", "gains", "reference", "measured", "drives", *_FUNCTIONS):
            self.writer.names.new(f"{self.prefix}_{word}")
        self.outer, self.wide = (
            C_TYPES[kind] for kind in (self.steps.precision.outside, self.steps.precision.wide)
        )
        self.language = c_numbers(self.writer, self.steps.precision.wide)
        self.locals = Names(reserved={"s", "reference", "measured", "drive", "last"})
        self.axes = self._axis_members()
        self.types = list(self._types())
        for name, routine in self.steps.routines.items():
            self.functions[name] = self.writer.names.new(f"{self.prefix}_{name}")
            self._define(name, routine)

    # --- Names ---

    def _axis_members(self) -> dict[str, Names]:
        """Give the axes their members; of one axis the struct itself is its room."""
        axes = self.steps.model.axis_names
        self.room = self.writer.scope()
        for word in ("gains", "until_set_point"):
            self.room.new(word)
        if len(axes) == 1:
            self.paths = {axes[0]: ""}
            return {axes[0]: self.room}
        self.paths = {axis: f"{self.room.new(axis)}." for axis in axes}
        return {axis: self.writer.scope() for axis in axes}

    def kind_of(self, variable: StepVariable) -> str:
        """Return the type of a variable."""
        return self.wide if variable.wide else self.outer

    def _know(self, name: str, text: str, kind: str) -> None:
        """Let a symbol be read by a text; a narrow one is widened where it is."""
        self.targets[name] = text
        self.members[name] = text if kind == self.wide else f"({self.wide}){text}"
        self.language.rename[name] = self.members[name]

    # --- Types ---

    def _types(self) -> Iterator[str]:
        for sort in POINTERS:
            yield from self._port_type(sort)
        yield from self._gain_type()
        yield from self._table_types()
        lines = []
        if self.steps.of_sort("gain"):
            lines.append(
                f"    {self.prefix}_gains gains; /* init sets them; change them at will */"
            )
        if self.steps.needs_last:
            lines.append(
                "    unsigned until_set_point; /* periods to the next one, this included */"
            )
        inner = {axis: list(self._axis_lines(axis)) for axis in self.axes}
        lines += self._in_axes(inner, "state")
        self.language.rename[LAST] = "last"
        if not lines:
            lines = ["    char nothing; /* C wants a member */"]
        yield "\n".join(
            [f"typedef struct {{ /* {self.prefix}_state */", *lines, f"}} {self.prefix}_state;\n"]
        )

    def _in_axes(self, lines: dict[str, list[str]], what: str) -> list[str]:
        """Return members, in a struct for each axis where there are several."""
        members: list[str] = []
        for axis, axis_lines in lines.items():
            path = self.paths[axis]
            if axis_lines and path:
                tag = self.writer.names.new(f"{self.prefix}_{what}_{path[:-1]}")
                inner = (f"    {line}" for line in axis_lines)
                members += [f"    struct {tag} {{", *inner, f"    }} {path[:-1]};"]
            else:
                members += axis_lines
        return members

    def _port_type(self, sort: str) -> Iterator[str]:
        ports = self.steps.of_sort(sort)
        if not ports:
            return
        lines: dict[str, list[str]] = {axis: [] for axis in self.axes}
        names = {axis: self.writer.scope() for axis in self.axes}
        for port in ports:
            member = names[port.axis].new(port.name)
            self._know(port.symbol, f"{sort}->{self.paths[port.axis]}{member}", self.outer)
            lines[port.axis].append(f"    {self.outer} {member};")
        name = f"{self.prefix}_{_TYPE_OF[sort]}"
        yield "\n".join(
            [
                f"typedef struct {{ /* {name} */",
                *self._in_axes(lines, _TYPE_OF[sort]),
                f"}} {name};\n",
            ]
        )

    def _gain_type(self) -> Iterator[str]:
        gains = self.steps.of_sort("gain")
        if not gains:
            return
        names, lines = self.writer.scope(), []
        units = {gain.name: gain.unit for gain in self.steps.model.gains}
        count = len(self.steps.model.axis_names)
        for gain in gains:
            if gain.number <= 0:
                member = names.new(gain.name)
                size = f"[{count}]" if gain.number == 0 else ""
                unit = f" /* {plain(units[gain.name])} */" if units[gain.name] else ""
                lines.append(f"    {self.outer} {member}{size};{unit}")
            index = f"[{gain.number}]" if gain.number >= 0 else ""
            self._know(gain.symbol, f"s->gains.{member}{index}", self.outer)
        yield "\n".join(
            [f"typedef struct {{ /* {self.prefix}_gains */", *lines, f"}} {self.prefix}_gains;\n"]
        )

    def _axis_lines(self, axis: str) -> Iterator[str]:
        if axis in self.steps.needs_first:
            member = self.axes[axis].new("first")
            self.language.rename[first_of(axis)] = f"s->{self.paths[axis]}{member}"
            yield f"int {member}; /* whether no step was made yet */"
        for variable in self.steps.variables.values():
            if variable.axis == axis and variable.sort in ("signal", "state"):
                member = self.axes[axis].new(variable.name)
                kind = self.kind_of(variable)
                self._know(variable.symbol, f"s->{self.paths[axis]}{member}", kind)
                remark = " /* remembered */" if variable.sort == "state" else ""
                yield f"    {kind} {member};{remark}"
        for key, table in self.steps.learned.items():
            if table.axis == axis:
                member = self.axes[axis].new(table.name)
                self.tables[key] = f"s->{self.paths[axis]}{member}"
                yield f"    {self.table_types[key]} {member}; /* learns */"
        yield from self._held_lines(axis)

    def _held_lines(self, axis: str) -> Iterator[str]:
        """Yield members for the drives that keep their value in a skipped period."""
        for guard, *_ in self.steps.guards:
            for name, sent in guard.drives.items():
                if guard.axis == axis and sent is None:
                    member = self.axes[axis].new(f"{self.steps.variables[name].name}_held")
                    self.held[name] = f"s->{self.paths[axis]}{member}"
                    yield f"    {self.outer} {member}; /* last value of the drive */"

    def _table_types(self) -> Iterator[str]:
        self.table_types: dict[str, str] = {}
        types: dict[tuple[int, int], str] = {}
        for key, table in self.steps.learned.items():
            shape = (len(table.values), table.delay)
            if shape not in types:
                types[shape] = self.writer.names.new(f"{self.prefix}_{table.name}_table")
                whole = _whole(table)
                ring = (
                    [
                        f"    {whole} ring[{table.delay}]; /* cells in use before; -1: none */",
                        "    unsigned next;",
                    ]
                    if table.delay
                    else []
                )
                yield "\n".join(
                    [
                        f"typedef struct {{ /* {types[shape]} */",
                        f"    {self.outer} values[{shape[0]}];",
                        f"    unsigned long visits[{shape[0]}]; /* of each cell */",
                        *ring,
                        f"}} {types[shape]};\n",
                    ]
                )
            self.table_types[key] = types[shape]

    # --- Functions that the step calls ---

    def _define(self, name: str, routine: object) -> None:
        names = Names()
        parameters = [names.new(argument.name) for argument in routine.arguments]  # type: ignore[attr-defined]
        kind = C_TYPES[routine.kind]  # type: ignore[attr-defined]
        body = routine.body(self.writer, parameters)  # type: ignore[attr-defined]
        listed = ", ".join(f"{kind} {parameter}" for parameter in parameters)
        lines = [f"    {line}" if line else "" for line in body]
        head = f"{self._inner()}{kind} {self.functions[name]}({listed})"
        self.writer.helpers.append("\n".join([head, "{", *lines, "}", ""]))

    def _inner(self) -> str:
        return "static inline " if self.writer.storage else "static "

    def _cell_function(self, name: str, grid: Grid) -> str:
        """Return the name of the function that finds a cell."""
        if name in self.functions:
            return self.functions[name]
        names = Names()
        kind = self.steps.precision.wide
        words = {"INDEX": "unsigned", "TYPE": self.wide, **SMALLER}
        index, parameters = "", []
        for axis, thresholds in grid:
            parameter = names.new(axis)
            parameters.append(parameter)
            if not thresholds:
                continue
            edges = rounded_down(thresholds, kind, f"the thresholds of '{axis}'")
            literals = [c_number(x, kind) for x in edges.tolist()]
            array = self.writer.constant(kind, literals, f"{identifier(axis)}_edges")
            count = self.writer.helper("count", COUNT_FUNCTION, **words)
            call = f"{count}({array}, {len(thresholds)}u, {parameter})"
            index = f"(({index}) * {len(thresholds) + 1}u) + {call}" if index else call
        listed = ", ".join(f"{self.wide} {parameter}" for parameter in parameters)
        unused = [f"    (void){p};" for (_, t), p in zip(grid, parameters, strict=True) if not t]
        self.functions[name] = self.writer.names.new(f"{self.prefix}_{name}")
        head = f"{self._inner()}unsigned {self.functions[name]}({listed})"
        body = [head, "{", *unused, f"    return {index or '0u'};", "}", ""]
        self.writer.helpers.append("\n".join(body))
        return self.functions[name]

    def _learn_function(self, key: str) -> str:
        """Return the name of the function that corrects a table.

        What `learn` in the kernel does, over indices of arrays, which are not expressions.
        """
        table_type = self.table_types[key]
        if table_type in self.functions:
            return self.functions[table_type]
        table, wide = self.steps.learned[key], self.wide
        whole = _whole(table)
        values = "table->values[responsible]"
        sum_text, limited = f"{values} + (rate * judged)", self.language.expression(limited_value())
        if self.outer != wide:
            sum_text = f"({self.outer})(({wide}){sum_text})"
            limited = f"({self.outer})({limited.replace('value', f'({wide})value')})"
        zero = self.language.number(0.0)
        name = self.functions[table_type] = self.writer.names.new(
            f"{self.prefix}_learn_{table.name}"
        )
        lines = [
            f"const {whole} responsible = "
            + ("table->ring[table->next];" if table.delay else f"({whole})cell;"),
            f"if ((responsible >= 0) && (rate != {zero})) {{"
            + (" /* none is, before the first delay is over */" if table.delay else ""),
            f"    const {self.outer} value = {sum_text};",
            f"    {values} = {limited};",
            "}",
            "table->visits[cell]++;",
        ]
        if table.delay:
            lines.append(f"table->ring[table->next] = ({whole})cell;")
            following = f"(table->next + 1u) % {table.delay}u" if table.delay > 1 else "0u"
            lines.append(f"table->next = {following};")
        head = (
            f"{self._inner()}void {name}({table_type} *table, unsigned cell, {wide} judged,"
            f" {wide} rate, {wide} bound)"
        )
        body = [f"    {line}" for line in lines]
        self.writer.helpers.append("\n".join([head, "{", *body, "}", ""]))
        return name

    # --- The step ---

    def step_lines(self) -> list[str]:
        """Return the statements of the step."""
        lines = []
        if self.steps.needs_last:
            lines += [
                "const bool last = s->until_set_point <= 1u;",
                f"s->until_set_point = last ? {self.prefix.upper()}_SET_POINT_EVERY"
                " : (s->until_set_point - 1u);",
            ]
        uses = self.steps.uses()
        for block in self.steps.blocks():
            lines += self._block(block, uses)
        return lines

    def _block(self, block: Block, uses: dict[str, int]) -> list[str]:
        """Return the statements of a block, in the condition of its guard."""
        inner: list[str] = []
        for step, following in zip_longest(block.steps, block.steps[1:]):
            inner += self._step(step, following, uses)
        inner += [f"{self.language.rename[first_of(axis)]} = 0;" for axis in block.begun]
        guard = block.guard
        if guard is None:
            return inner
        otherwise = [
            f"{self.targets[name]} = {self._outer_number(value)};"
            for name, value in guard.sent.items()
        ]
        return [
            f"if ({self.language.expression(guard.condition)}) {{ /* all are numbers */",
            *(f"    {line}" for line in inner),
            *(["} else {", *(f"    {line}" for line in otherwise)] if otherwise else []),
            "}",
            *(f"{self.targets[n]} = {self.held[n]};" for n in guard.drives if n in self.held),
        ]

    def _outer_number(self, value: float) -> str:
        kind = self.steps.precision.outside
        return c_number(rounded([value], kind, "a drive").tolist()[0], kind)

    def _step(self, step: Step, following: Step | None, uses: dict[str, int]) -> list[str]:
        if isinstance(step, Set):
            return self._set(step)
        if isinstance(step, Teach):
            return [self._taught(step)]
        kind = self.wide
        if isinstance(step, Ask):
            text, kind = self._asked(step)
        elif isinstance(step, Find):
            inputs = ", ".join(self.members[name] for name in step.inputs)
            function = self._cell_function(step.grid, self.steps.grids[step.grid])
            text, kind = f"{function}({inputs})", "unsigned"
        else:
            text, kind = f"{self.tables[step.table]}.values[{self.targets[step.cell]}]", self.outer
        once = isinstance(following, Set) and uses.get(step.target) == 1
        if once and kind != "unsigned" and step.target in symbols(following.value):  # type: ignore[union-attr]
            self._know(step.target, text, kind)
            return []
        name = self._local(step.target, kind)
        return [f"const {kind} {name} = {text};"]

    def _local(self, target: str, kind: str) -> str:
        name = self.locals.new(target.split(":")[1])
        if kind == "unsigned":
            self.targets[target] = self.members[target] = name
        else:
            self._know(target, name, kind)
        return name

    def _set(self, assignment: Set) -> list[str]:
        body, value = spread("part", assignment.value, self.locals.used)
        lines = self.language.lines(body)
        self.locals.take(names_set(body))
        text = self.language.expression(value)
        variable = self.steps.variables.get(assignment.target)
        if variable is not None:
            kind = self.kind_of(variable)
        else:
            kind = self.outer if assignment.rounded else self.wide
        narrow = kind != self.wide
        if assignment.rounded and not narrow and self.outer != self.wide:
            text = f"({self.wide})({self.outer})({text})"  # kept wide for a later line: zoom
        # A value that was narrow before needs no way through the wider type.
        plain = text.removeprefix(f"({self.wide})")
        if narrow and plain != text and not set(plain) & set(" ?("):
            text = plain
        elif narrow:
            text = f"({kind}){text}" if text.isidentifier() else f"({kind})({text})"
        if variable is None:
            return [*lines, f"const {kind} {self._local(assignment.target, kind)} = {text};"]
        target = self.held.get(assignment.target, self.targets[assignment.target])
        return [*lines, f"{target} = {text};"]

    def _asked(self, query: Ask) -> tuple[str, str]:
        """Return the call of a routine and the type of its result."""
        routine, function = self.steps.routines[query.routine], self.functions[query.routine]
        core = getattr(routine, "core", None)
        if not isinstance(core, FixedTable):
            kind = C_TYPES[routine.kind]
            texts = [self._in_type(name, kind) for name in query.inputs]
            return f"{function}({', '.join(texts)})", kind
        kind, wide = C_TYPES[routine.kind], self.wide
        inputs = []
        for scale, name in zip(core.inputs, query.inputs, strict=True):
            text = self.language.expression(scaled(scale, symbol(name)))
            inputs.append(f"({kind})((int32_t)({text}) - {shift_of(scale)})")
        self.language.rename["whole number"] = f"({wide}){function}({', '.join(inputs)})"
        return self.language.expression(unscaled(core.output, symbol("whole number"))), wide

    def _in_type(self, name: str, kind: str) -> str:
        """Return how a symbol is handed to a function that takes this type."""
        return self.targets[name] if kind != self.wide else self.members[name]

    def _taught(self, lesson: Teach) -> str:
        judge = self.steps.judges[lesson.judge]
        kind = self.steps.precision.outside
        if lesson.judge not in self.judges:
            values = rounded(np.asarray(judge.values).ravel(), kind, f"table '{lesson.judge}'")
            literals = [c_number(x, kind) for x in values.tolist()]
            columns = judge.shape[-1]
            self.judges[lesson.judge] = self.writer.constant(kind, literals, lesson.judge, columns)
        cast = f"({self.wide})" if self.wide != self.outer else ""
        arguments = [
            f"&{self.tables[lesson.table]}",
            self.targets[lesson.cell],
            f"{cast}{self.judges[lesson.judge]}[{self.targets[lesson.judged]}]",
            self.language.expression(lesson.rate),
            self.language.expression(lesson.bound),
        ]
        return f"{self._learn_function(lesson.table)}({', '.join(arguments)});"

    # --- init, save, load ---

    def init_lines(self) -> list[str]:
        """Return the statements of init."""
        lines = []
        for variable in self.steps.variables.values():
            if variable.sort in ("gain", "signal", "state"):
                kind = self.steps.precision.wide if variable.wide else self.steps.precision.outside
                start = rounded([variable.start], kind, f"'{variable.name}'").tolist()[0]
                lines.append(f"{self.targets[variable.symbol]} = {c_number(start, kind)};")
        lines += [
            f"{member} = {self._outer_number(self.steps.variables[name].start)};"
            for name, member in self.held.items()
        ]
        lines += [f"{self.language.rename[first_of(axis)]} = 1;" for axis in self.steps.needs_first]
        if self.steps.needs_last:
            lines.append(f"s->until_set_point = {self.prefix.upper()}_SET_POINT_EVERY;")
        if self.steps.learned:
            lines.append("unsigned k;")
            lines.insert(0, lines.pop())
        for key, table in self.steps.learned.items():
            lines += self._init_table(key, table)
        return lines

    def _init_table(self, key: str, table: LearningTable) -> list[str]:
        kind, member = self.steps.precision.outside, self.tables[key]
        start = c_number(0.0, kind)
        if any(table.values):
            values = rounded(table.values, kind, f"table '{table.name}'").tolist()
            literals = [c_number(x, kind) for x in values]
            start = f"{self.writer.constant(kind, literals, f'{table.name}_start')}[k]"
        lines = [
            f"for (k = 0u; k < {len(table.values)}u; k++) {{",
            f"    {member}.values[k] = {start};",
            f"    {member}.visits[k] = 0UL;",
            "}",
        ]
        if table.delay:
            lines += [
                f"for (k = 0u; k < {table.delay}u; k++) {{",
                f"    {member}.ring[k] = -1;",
                "}",
                f"{member}.next = 0u;",
            ]
        return lines

    def prototypes(self) -> dict[str, str]:
        """Return the functions of the file, by what they do."""
        p = self.prefix
        ports = [
            f"{'' if sort == 'drive' else 'const '}{p}_{_TYPE_OF[sort]} *{sort}"
            for sort in POINTERS
            if self.steps.of_sort(sort)
        ]
        signatures = {
            "init": f"void {p}_init({p}_state *s)",
            "step": f"void {p}_step({', '.join([f'{p}_state *s', *ports])})",
        }
        if self.steps.learned:
            kind = self.outer
            signatures["save"] = (
                f"void {p}_save(const {p}_state *s, {kind} *values, unsigned long *visits)"
            )
            signatures["load"] = (
                f"void {p}_load({p}_state *s, const {kind} *values, const unsigned long *visits)"
            )
        return signatures

    def copy_lines(self, what: str) -> list[str]:
        """Return the statements of ``save`` or ``load``."""
        lines, first = ["unsigned k;"], 0
        for key, table in self.steps.learned.items():
            outer = f"{first}u + k" if first else "k"
            for name, optional in (("values", False), ("visits", True)):
                inside, outside = f"{self.tables[key]}.{name}[k]", f"{name}[{outer}]"
                pair = (outside, inside) if what == "save" else (inside, outside)
                body = [
                    f"for (k = 0u; k < {len(table.values)}u; k++) {{",
                    f"    {pair[0]} = {pair[1]};",
                    "}",
                ]
                if optional:
                    body = [f"if ({name} != NULL) {{", *(f"    {line}" for line in body), "}"]
                lines += body
            first += len(table.values)
        return lines

    # --- The file ---

    def headers(self) -> list[str]:
        """Return the standard headers that are needed."""
        nodes: list[Node] = []
        for step in self.steps.steps:
            nodes += [step.value] if isinstance(step, Set) else []
        names = {"math.h"} if needs_math_header(list(postorder(*nodes))) else set()
        names |= {"stddef.h"} if self.steps.learned else set()
        names |= {"stdbool.h"} if self.steps.needs_last else set()
        for routine in self.steps.routines.values():
            names |= set(routine_headers(routine))
        return [f"#include <{name}>" for name in sorted(names)]

    def constants(self) -> list[str]:
        """Return the macros of the file."""
        upper, model = self.prefix.upper(), self.steps.model
        lines = [
            f"#define {upper}_PERIOD {c_number(model.period, self.steps.precision.outside)} /* s */"
        ]
        if self.steps.needs_last:
            lines.append(f"#define {upper}_SET_POINT_EVERY {model.every}u /* periods */")
        if self.steps.learned:
            cells = sum(len(table.values) for table in self.steps.learned.values())
            lines.append(f"#define {upper}_LEARNED_CELLS {cells}u /* of save and load */")
        return lines

    def definitions(self) -> str:
        """Return constants, helpers and functions as text."""
        bodies = {"init": self.init_lines(), "step": self.step_lines()}
        if self.steps.learned:
            bodies |= {what: self.copy_lines(what) for what in ("save", "load")}
        functions = []
        for what, prototype in self.prototypes().items():
            body = bodies[what]
            if not any("s->" in line for line in body):  # a drive that is a number
                body = ["(void)s;", *body]
            lines = [f"    {line}" if line else "" for line in body]
            functions.append("\n".join([f"{self.writer.storage}{prototype}", "{", *lines, "}", ""]))
        return self.writer.assembled(functions)

    def self_test(self, vectors: TestSequence) -> list[str]:
        """Return a ``main`` that runs the sequence and returns 0 if the drives come out."""
        body = test_function("int main(void)", self.test_lines(vectors), "steps")
        return [f"#ifdef {SWITCH}", "", *body, "#endif", ""]

    def test_lines(self, vectors: TestSequence) -> list[str]:
        """Return the statements of a function that returns 0 if the drives come out."""
        kind = self.steps.precision.outside
        sorts = [sort for sort in POINTERS if self.steps.of_sort(sort)]
        count = len(vectors.expected)
        lines: list[str] = []
        arrays = {"given": vectors.inputs, "expected": vectors.expected}
        for name, rows in arrays.items():
            width = max(1, len(rows[0]))
            literals = [_literal(x, kind) for row in rows for x in (row or [0.0])]
            body = [
                f"        {{{', '.join(literals[i : i + width])}}},"
                for i in range(0, len(literals), width)
            ]
            stored = f"{self.writer.in_flash}{C_TYPES[kind]}"
            lines += [
                f"    static const {stored} {name}[{count}][{width}] = {{",
                *body[:-1],
                body[-1].removesuffix(","),
                "    };",
            ]
        tolerance = c_number(vectors.tolerance, kind)
        lines += [f"    static {self.prefix}_state s;"]
        lines += [f"    {self.prefix}_{_TYPE_OF[sort]} {sort};" for sort in sorts]
        lines += ["    unsigned k;", f"    {self.prefix}_init(&s);"]
        lines += [f"    for (k = 0u; k < {count}u; k++) {{"]
        place = 0
        for sort in ("reference", "measured"):
            for port in self.steps.of_sort(sort):
                member = self.targets[port.symbol].replace("->", ".", 1)
                lines.append(f"        {member} = given[k][{place}];")
                place += 1
        if not place:
            lines.append("        (void)given;")
        arguments = ", ".join(["&s", *(f"&{sort}" for sort in sorts)])
        lines.append(f"        {self.prefix}_step({arguments});")
        for number, port in enumerate(self.steps.of_sort("drive")):
            member = self.targets[port.symbol].replace("->", ".", 1)
            difference = f"({member} - expected[k][{number}])"
            lines += [
                f"        if (!(({difference} <= {tolerance})"
                f" && ({difference} >= -{tolerance}))) {{",
                "            failed = 1;",
                "        }",
            ]
        return [*lines, "    }"]

    def ram(self) -> int:
        """Return roughly how many bytes the state takes."""
        size = {"float": 4, "double": 8}
        total = 8
        for variable in self.steps.variables.values():
            if variable.sort in ("gain", "signal", "state"):
                total += size[self.kind_of(variable)]
        total += size[self.outer] * len(self.held)
        for table in self.steps.learned.values():
            total += len(table.values) * (size[self.outer] + 8) + 4 * table.delay + 4
        return total


def controller_c(
    steps: Steps, prefix: str, stem: str, suffix: str, vectors: TestSequence, words: Sequence[str]
) -> tuple[dict[str, str], CController]:
    """Return a header on its own (``.h``), or a ``.c`` and a ``.h``, by suffix."""
    alone = suffix == ".h"
    writer = CWriter(prefix, "static inline " if alone else "")
    controller = CController(steps, writer)
    code = controller.definitions()
    library = " -lm" if steps.calls_functions else ""
    sources = f"-x c {stem}.h" if alone else f"{stem}.c"
    test = (
        f"gcc -std=c99 -ffp-contract=off -D{SWITCH} {sources} -o self_test{library} && ./self_test"
    )
    head = [
        *words,
        "",
        *_use_words(controller, stem, alone=alone),
        f"self-test (returns 0 if all is well): {test}",
    ]
    top = [*comment(head, "/*", " *", " */"), ""]
    opening = controller.headers()
    opening += [""] if opening and opening[-1] else []
    declarations = [*opening, *controller.constants(), "", *controller.types]
    # Includes stand above all else (MISRA C:2012, 20.1), that of the self-test too.
    included = any("math.h" in line for line in opening)
    of_test = [] if included else [f"#ifdef {SWITCH}", _NAN_HEADER[0], "#endif", ""]
    test_lines = controller.self_test(vectors)
    if alone:
        lines = [*top, *guarded(writer, [*of_test, *declarations, code, *test_lines])]
        return {suffix: "\n".join(lines)}, controller
    prototypes = [f"{prototype};" for prototype in controller.prototypes().values()]
    header = [*top, *guarded(writer, [*declarations, *for_cxx(prototypes)])]
    source = [*top, f'#include "{stem}.h"', "", *of_test, code, *test_lines]
    return {".c": "\n".join(source), ".h": "\n".join(header)}, controller


def controller_library(
    steps: Steps, prefix: str, stem: str, vectors: TestSequence, words: Sequence[str]
) -> tuple[CLibrary, CController]:
    """Return a controller as a library of three files; parameters as of `controller_c`."""
    writer = library_writer(prefix)
    name = writer.names.new(f"{prefix}_self_test")
    controller = CController(steps, writer)
    code = controller.definitions()
    test = f"{stem}.c {stem}_self_test.c, and call {name}()"
    head = [*words, "", *_use_words(controller, stem, alone=False), f"self-test: {test}"]
    top = [*comment(head, "/*", " *", " */"), ""]
    declarations = [f"{prototype};" for prototype in controller.prototypes().values()]
    tested = f"int {name}(void); /* returns 0 if all is well */"
    inside = [
        *controller.headers(),
        "",
        *controller.constants(),
        "",
        *controller.types,
        *for_cxx([*declarations, tested]),
    ]
    header = "\n".join([*top, *guarded(writer, inside)])
    source = library_file(writer, top, stem, [code], flash=bool(writer.constants))
    body = test_function(f"int {name}(void)", controller.test_lines(vectors), "steps")
    remark = f"/* A sequence of the model, for a test of {stem}.c; linked where it is called. */"
    tests = library_file(writer, [remark, "", *_NAN_HEADER], stem, body)
    prototypes = tuple(controller.prototypes().values())
    return CLibrary(header, source, tests, writer, prototypes, name), controller


def _use_words(controller: CController, stem: str, *, alone: bool) -> list[str]:
    prefix = controller.prefix
    lines = [f"{prototype};" for prototype in controller.prototypes().values()]
    lines += [
        f"constants (flash): {controller.writer.flash} bytes, besides the code",
        f"state (RAM): about {controller.ram()} bytes; nothing is allocated, nothing is static",
        f'use: #include "{stem}.h"' + ("" if alone else f", link {stem}.c"),
        f"call {prefix}_init once, "
        f"{prefix}_step every {number_text(controller.steps.model.period)} s;"
        f" gains are s.gains, which {prefix}_init sets",
    ]
    if controller.steps.needs_last:
        lines.append(
            f"a set point lasts {controller.steps.model.every} periods, counted from init; "
            "where the next one comes off that count, set s.until_set_point = 1 before the last"
            " step of the present one"
        )
    if controller.steps.learned:
        lines.append(
            f"tables that learn are part of the state: {prefix}_save copies their values and visits"
            f" out ({prefix.upper()}_LEARNED_CELLS numbers each, axis by axis), {prefix}_load"
            " copies them in, after init; visits may be a null pointer"
        )
    return lines


_TYPE_OF = {"reference": "reference", "measured": "measured", "drive": "drives"}


def _whole(table: LearningTable) -> str:
    """Return the type of a cell in a ring, where -1 means no cell."""
    return "int" if len(table.values) <= 0x7FFF else "long"


def _literal(value: float, kind: Kind) -> str:
    return "NAN" if math.isnan(value) else c_number(value, kind)
