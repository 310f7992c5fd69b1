"""Programs as IEC 61131-3 Structured Text: function blocks for PLCs.

A rule base, a table and a controller are a block each, since the constants of a function would be
copied at every call; a routine without memory is a function. The language has no number for "none":
if no rule fires and the rule base calls that an error, the output keeps its value and `fired` is
false. Its expressions only calculate: a choice, a search in an array and the call of a block come
before the statement that needs them (`flattened`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np

from fuzzyarm.exchange.export.controller_lowering import (
    ALL_NUMBERS,
    IN_TURN,
    SETTLED,
    controller_program,
)
from fuzzyarm.exchange.export.controllers import ControllerProgram
from fuzzyarm.exchange.export.lowering import routines_program
from fuzzyarm.exchange.export.numbers import ST_TYPES, ExportError, Kind, st_literal, st_number
from fuzzyarm.exchange.export.printer import FunctionPrinter, Printer, Target
from fuzzyarm.exchange.export.routine import (
    MADE,
    Routine,
    comment,
    number_lines,
    plain,
    routine_words,
    wrapped,
)
from fuzzyarm.exchange.export.rulebase import DirectRoutine
from fuzzyarm.exchange.export.typed_program import (
    COUNT,
    INDEX,
    NOTHING,
    OFFSET,
    TRUTH,
    Array,
    Called,
    Cast,
    Count,
    Element,
    Fires,
    Function,
    Leave,
    Line,
    Member,
    Program,
    Quotient,
    Repeat,
    Return,
    Run,
    Scratch,
    Search,
    Stop,
    Store,
    Truth,
    Variable,
    When,
    While,
    at,
    cast,
    every_line,
    every_node,
)
from fuzzyarm.symbolic.identifiers import Names, identifier
from fuzzyarm.symbolic.nodes import (
    Apply,
    Constant,
    Node,
    apply,
    constant,
    postorder,
    rebuilt,
    symbol,
)
from fuzzyarm.symbolic.operations import Operation
from fuzzyarm.symbolic.printing import (
    STRUCTURED_TEXT,
    Assign,
    Choose,
    NotPrintableError,
    setting,
    statements,
    variables,
)

FIRED, RESULT, FOUND = "a rule fires", "what is returned", "what was found"
"""Symbols: the flag of firing, without a number for "none"; the result; its value if a rule fires.
be, if one fires."""


class Call(NamedTuple):
    """Call the block of a function with some arguments; its result is a symbol from then on."""

    function: str
    arguments: tuple[Node, ...]


def flattened(function: Function, program: Program, is_block: Callable[[str], bool]) -> Function:
    """Return a function without choices, searches and calls of blocks inside of expressions."""
    flat = _Flattening(function, program, is_block)
    body = list(function.body)
    if function.may_lack_value:
        last = body.pop()
        value = last.value.value if isinstance(last.value, Cast) else last.value
        flat.variables[FOUND] = Variable("result", function.real)
        result = cast(symbol(FOUND), function.real, function.returned)
        body = [Assign(FIRED, Truth(True)), *body, Assign(FOUND, value),
                When(symbol(FIRED), (Assign(RESULT, result),))]  # fmt: skip
    return replace(function, body=flat.lines(body), variables=flat.variables)


def result_of(function: str) -> str:
    """Return the symbol of a called block's result."""
    return f"result of {function}"


def fired_in(function: str) -> str:
    """Return the symbol of a called block's flag of firing."""
    return f"fired in {function}"


@dataclass
class _Flattening:
    function: Function
    program: Program
    is_block: Callable[[str], bool]
    variables: dict[str, Variable] = field(default_factory=dict)
    before: list[Line] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.variables = dict(self.function.variables)
        self.count = 0

    # ── statements ───────────────────────────────────────────────────────────────────

    def lines(self, body: Sequence[Line]) -> list[Line]:
        """Return statements, each after the lines that its values need."""
        lines: list[Line] = []
        for line in body:
            outer, self.before = self.before, []
            made = self._line(line)
            lines += [*self.before, *made]
            self.before = outer
        return lines

    def _line(self, line: Line) -> list[Line]:
        if isinstance(line, Assign):
            return self._set(line.name, line.value, line.remark)
        if isinstance(line, Return):  # the drives of a step are outputs
            is_step = self.function is self.program.step
            return [] if is_step else self._set(RESULT, line.value, "")
        return [self._compound(line)]

    def _compound(self, line: Line) -> Line:
        if isinstance(line, Choose | When):
            then, otherwise = (tuple(self.lines(part)) for part in (line.then, line.otherwise))
            return When(self._value(line.condition), then, otherwise, getattr(line, "remark", ""))
        if isinstance(line, Store):
            return Store(line.array, self._value(line.position), self._value(line.value))
        if isinstance(line, Run | Leave | Stop | Scratch):  # of kernels, where nothing chooses
            return line
        assert isinstance(line, Repeat | While | Count)
        return line._replace(body=tuple(self.lines(line.body)))

    def _set(self, name: str, value: Node, remark: str) -> list[Line]:
        if self.function.of_kernel:
            return [Assign(name, value, remark)]
        value = self._inner(value)
        # The operand of a cast is computed first: a choice is not an expression.
        if isinstance(value, Cast) and _chooses(value.value):
            value = Cast(self._named(value.value, value.before), value.before, value.after)
        body, result = statements(value, prefix="part_", reserved=self.variables)
        for part in variables(body):
            self.variables.setdefault(part, Variable("part", self.function.real))
        lines = setting(name, body, result, remark)
        return [part for line in lines for part in _with_numbers(line)]

    # ── expressions ──────────────────────────────────────────────────────────────────

    def _value(self, node: Node, kind: Kind | None = None) -> Node:
        """Return an expression that only calculates."""
        node = self._inner(node)
        return self._named(node, kind or self.function.real) if _chooses(node) else node

    def _named(self, node: Node, kind: Kind) -> Node:
        """Return a variable set to a value before."""
        name = self._new("value", kind)
        self.before += self._set(name, node, "")
        return symbol(name)

    def _new(self, stem: str, kind: Kind) -> str:
        self.count += 1
        name = f"{stem} {self.count}"
        self.variables[name] = Variable(stem, kind)
        return name

    def _inner(self, root: Node) -> Node:
        """Return an expression whose searches and calls of blocks are done before."""
        return rebuilt(root, lambda node, new: new if node is not new else self._leaf(node))

    def _leaf(self, node: Node) -> Node:
        if isinstance(node, Search):
            return self._searched(node)
        if isinstance(node, Called):
            return self._called(node)
        if isinstance(node, Fires):
            return symbol(fired_in(node.function))
        if isinstance(node, Element):
            return Element(node.array, self._value(node.index, INDEX))
        if isinstance(node, Cast):
            return Cast(self._value(node.value, node.before), node.before, node.after)
        if isinstance(node, Quotient):
            node = Quotient(self._value(node.dividend), self._value(node.divisor))
        return node

    def _called(self, node: Called) -> Node:
        function = self.program.functions[node.function]
        kinds = [variable.kind for variable in function.parameters.values()]
        arguments = tuple(map(self._value, node.arguments, kinds))
        if not self.is_block(node.function):
            return Called(node.function, arguments)
        # A statement calls a block once: its result stays until the next call.
        self.before.append(Call(node.function, arguments))
        return symbol(result_of(node.function))

    def _searched(self, node: Search) -> Node:
        """Return the count of a bisection run before."""
        kind = self.program.functions[node.function].real
        x = self._value(node.value, kind)
        if not isinstance(x, type(symbol("x"))):
            x = self._named(x, kind)
        for word in ("low", "high", "middle"):
            self.variables.setdefault(f"{word} of a search", Variable(word, INDEX))
        low, high, middle = (symbol(f"{w} of a search") for w in ("low", "high", "middle"))
        place: Node = middle + at(node.first) if node.first else middle
        passed = apply("less_equal" if node.reached else "less", Element(node.array, place), x)
        self.before += [
            Assign(low.name, at(0)),
            Assign(high.name, at(node.count)),
            While(low < high, (
                Assign(middle.name, Quotient(low + high, at(2))),
                When(passed, (Assign(low.name, middle + at(1)),), (Assign(high.name, middle),)),
            )),
        ]  # fmt: skip
        name = self._new("count", INDEX)
        self.before.append(Assign(name, low))
        return symbol(name)


def _chooses(root: Node) -> bool:
    return any(isinstance(node, Apply) and node.operation == "where" for node in postorder(root))


def _with_numbers(line: Line) -> list[Line]:
    """Return a statement that sets a number; NaN means that no rule fires."""
    if isinstance(line, Assign):
        if isinstance(line.value, Constant) and math.isnan(line.value.value):
            return [line._replace(value=constant(0.0)), Assign(FIRED, Truth(False))]
        return [line]
    if isinstance(line, Choose):
        then, otherwise = (
            tuple(part for each in branch for part in _with_numbers(each))
            for branch in (line.then, line.otherwise)
        )
        return [When(line.condition, then, otherwise)]
    return [line]


_TYPES = {**ST_TYPES, INDEX: "DINT", COUNT: "DINT", TRUTH: "BOOL", OFFSET: "DINT", NOTHING: "BOOL"}


def _operation(_printer: Printer, operation: Operation, _kind: Kind) -> str:
    return {"minimum": "MIN({0}, {1})", "maximum": "MAX({0}, {1})"}.get(
        operation.name, operation.st
    )


def _number(_printer: Printer, value: float, kind: Kind) -> str:
    if not math.isfinite(value):
        raise ExportError("Structured Text has no infinite number", hint="export C")
    return st_literal(value, kind)


def _cast(text: str, before: Kind, after: Kind) -> str:
    one, other = _TYPES[before], _TYPES[after]
    if one == other:
        return text
    if np.issubdtype(before, np.floating) and not np.issubdtype(after, np.floating):
        return f"TRUNC({text})"
    return f"{one}_TO_{other}({text})"


def _array(_printer: Printer, _name: str, kind: Kind, values: Sequence[float], columns: int) -> str:
    """Return the elements of an array: its declaration is in a section."""
    return elements_text([st_number(x, kind) for x in values], columns)


def elements_text(literals: Sequence[str], columns: int = 0) -> str:
    """Return the initial value of an array."""
    return "\n".join(["[", *number_lines(literals, columns, indent="        "), "    ]"])


TARGET = Target(
    language=STRUCTURED_TEXT, names="st", operation=_operation, number=_number, array=_array,
    cast=_cast, truths=("FALSE", "TRUE"), types=_TYPES, again="{name} := {value};", member="{}",
    function=("", ""), when="IF {} THEN", otherwise="ELSE", end="END_IF;",
    repeat="FOR {index} := 0 TO {count} - 1 DO", end_repeat="END_FOR;", loop="WHILE {} DO",
    end_loop="END_WHILE;", remark="(* {} *)", stop="EXIT;",
    count="FOR {index} := {start} TO {last} BY {signed} DO",
)  # fmt: skip


@dataclass(frozen=True)
class Declaration:
    """A variable: its type or that of its elements, the last index of an array, its initial value.

    `start` is the text of the number, or of all elements; `remark` mostly is a unit; `named` is the
    name of the type of an array that has one.
    """

    name: str
    type: str
    last: int | None = None
    start: str = ""
    remark: str = ""
    named: str = ""

    @property
    def elements(self) -> list[str]:
        """The numbers that an array starts with."""
        return [text.strip() for text in self.start.strip("[]").split(",")]

    def text(self) -> str:
        """Return its line in a section."""
        of = self.type if self.last is None else f"ARRAY [0..{self.last}] OF {self.type}"
        start = f" := {self.start}" if self.start else ""
        remark = f" (* {self.remark} *)" if self.remark else ""
        return f"    {self.name} : {self.named or of}{start};{remark}"


@dataclass(frozen=True)
class Unit:
    """A function, a function block or a program; `returned` is the type of a function.

    `sections` are its declarations by their titles, as in ``VAR_INPUT``.
    """

    head: str
    sort: str
    name: str
    returned: str
    sections: Mapping[str, Sequence[Declaration]]
    statements: str

    def ports(self, title: str) -> list[str]:
        """Return the variables under a title."""
        return [declaration.name for declaration in self.sections.get(title, ())]

    def text(self) -> str:
        """Return the unit."""
        sections = [
            line
            for title, declarations in self.sections.items()
            for line in (title, *(each.text() for each in declarations), "END_VAR")
        ]
        return "\n".join([
            *(comment(self.head.split("\n"), "(*", "*)") if self.head else ()),
            f"{self.sort} {self.name}{f' : {self.returned}' if self.returned else ''}",
            *sections, "", f"{self.statements}END_{self.sort}", "",
        ])  # fmt: skip


@dataclass(frozen=True)
class Project:
    """All units, callees first.

    `blocks` are the names of the blocks that a program calls, `types` the arrays whose types have
    names.
    """

    name: str
    units: tuple[Unit, ...]
    blocks: tuple[str, ...]
    types: tuple[Declaration, ...] = ()

    def text(self) -> str:
        """Return the file."""
        types = [
            f"TYPE\n{replace(array, name=array.named, named='').text()}\nEND_TYPE\n"
            for array in self.types
        ]
        return "\n".join([*types, *(unit.text() for unit in self.units)])


def routines_st(routines: Sequence[Routine], prefix: str) -> Project:
    """Return a function block for every routine."""
    with printable_only():
        program = routines_program(routines, endless=False)
        blocks = [key for key, function in program.functions.items() if function.public]
        words = {
            key: _routine_words(routine) for key, routine in zip(blocks, routines, strict=True)
        }
        file = _File(program, prefix, words)
        return file.project([file.called[key] for key in blocks])


def controller_st(program: ControllerProgram, prefix: str) -> Project:
    """Return a controller as a function block."""
    with printable_only():
        steps = program.steps
        words = {
            f"routine {name}": _routine_words(routine) for name, routine in steps.routines.items()
        }
        file = _File(controller_program(steps, endless=False, flags=True), prefix, words)
        period = steps.model.period
        use = [f"call it every {period:g} s; gains are inputs, with their values"]
        if steps.needs_last:
            use.append(
                f"a set point lasts {steps.model.every} periods; where the next one comes off"
                " that count, set_point_ends is TRUE in the last period of the present one"
            )
        if steps.learned:
            use.append("tables that learn are RETAIN: they survive a loss of power")
        return file.project([file.controller], [*program.head(), "", *use])


@contextmanager
def printable_only() -> Iterator[None]:
    """Raise an error: the language lacks the function, which is for printing only."""
    try:
        yield
    except NotPrintableError as error:
        raise ExportError(str(error), hint="export C, or a table") from None


def _routine_words(routine: Routine) -> list[str]:
    """Return the comment of a block."""
    words = routine_words(routine)
    if isinstance(routine, DirectRoutine):
        words = [line for line in words if line != routine.silence]
        words.append("where no rule fires the output keeps its value, and fired is FALSE")
    return [MADE, "", *words]


class _File(Printer):
    """The units of a file: functions, and blocks for those with constants of their own."""

    def __init__(self, program: Program, prefix: str, words: Mapping[str, list[str]]) -> None:
        self.program, self.target, self.words, self.stem = program, TARGET, words, prefix
        self.names, self.members, self.arrays = Names("st"), {}, {}
        self.controller = self.names.new(prefix) if program.step is not None else prefix
        self.called = {}
        functions = {key: f for key, f in program.functions.items() if not _takes_array(f)}
        for key in sorted(functions, key=lambda key: key not in words):
            self.called[key] = self.names.new(f"{prefix}_{identifier(functions[key].stem)}")
        self.blocks = {
            key for key, f in functions.items()
            if key in words or (_has_arrays(f) and not f.of_kernel)
        }  # fmt: skip
        self.lent: dict[str, dict[str, int]] = {}  # of functions: constants passed to them
        self.array_types: dict[tuple[str, int], Declaration] = {}
        for key, function in functions.items():
            self.lent[key] = self._lent_to(function)
        self.ports: dict[str, tuple[list[str], str]] = {}  # of blocks: inputs and output
        self.flags: dict[str, str] = {}  # of blocks with a flag of firing

    def _lent_to(self, function: Function) -> dict[str, int]:
        """Return the constants read by a function and its callees, with their sizes."""
        lent: dict[str, int] = {}
        for node in every_node(function.body):
            if isinstance(node, Element) and function.of_kernel:
                if node.array in self.program.arrays:
                    lent[node.array] = len(self.program.arrays[node.array].values)
            elif isinstance(node, Called):
                lent |= self.lent.get(node.function, {})
        for line in every_line(function.body):
            if isinstance(line, Run):
                lent |= self.lent.get(line.function, {})
        return lent

    def array_of_type(self, name: str, kind: Kind, size: int, start: str = "") -> Declaration:
        """Return an array whose type has a name.

        One without a name is the same as no other, and an argument by reference has to
        have the same.
        """
        key = _TYPES[kind], size
        if key not in self.array_types:
            named = self.names.new(f"{self.stem}_{size}_{_TYPES[kind]}")
            self.array_types[key] = Declaration("", _TYPES[kind], size - 1, named=named)
        return replace(self.array_types[key], name=name, start=start)

    def project(self, blocks: Sequence[str], words: Sequence[str] = ()) -> Project:
        """Return all units; `words` are those of the controller."""
        units = [
            _Unit(self, key, function, self.words.get(key, ())).unit()
            for key, function in self.program.functions.items()
            if key in self.called
        ]
        if self.program.step is not None:
            units.append(_Unit(self, "", self.program.step, words).unit())
        return Project(self.stem, tuple(units), tuple(blocks), tuple(self.array_types.values()))


ERROR = "error of the block"


def _with_error(step: Function) -> Function:
    """Return the step with an output that is true in a skipped period."""

    def with_flag(line: Line) -> Line:
        if not isinstance(line, When) or line.remark not in {IN_TURN, ALL_NUMBERS, SETTLED}:
            return line
        then = tuple(map(with_flag, line.then))
        if line.remark == IN_TURN:  # a period between two runs is not a skipped one
            return line._replace(then=then)
        return line._replace(then=then, otherwise=(*line.otherwise, Assign(ERROR, Truth(True))))

    body: list[Line] = list(map(with_flag, step.body))
    return replace(step, body=[Assign(ERROR, Truth(False)), *body]) if body != step.body else step


def _takes_array(function: Function) -> bool:
    return any(each.of_array and not each.size for each in function.parameters.values())


def _has_arrays(function: Function) -> bool:
    return any(isinstance(node, Element | Search) for node in every_node(function.body))


class _Unit(FunctionPrinter):
    """A function or a block: its declarations in their sections, and its statements."""

    file: _File

    def __init__(self, file: _File, key: str, function: Function, words: Sequence[str]) -> None:
        self.file, self.key, self.words = file, key, words
        self.is_step = not key
        self.is_block = self.is_step or key in file.blocks
        self.name = file.called.get(key, file.controller)
        titles = ("VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR CONSTANT", "VAR RETAIN", "VAR")
        self.sections: dict[str, list[Declaration]] = {title: [] for title in titles}
        self.state_arrays: dict[str, str] = {}
        self.instances: dict[str, str] = {}
        plain_function = flattened(function, file.program, file.blocks.__contains__)
        super().__init__(file, _with_error(plain_function) if self.is_step else plain_function)
        self.arrays = self.state_arrays
        if function.of_kernel:
            self.sections["VAR_IN_OUT"] += [
                file.array_of_type(self._new_array(array), kind, size)
                for array, (kind, size) in self._arrays_of_kernel(key).items()
            ]
        for node in every_node(self.function.body):
            if isinstance(node, Element) and node.array in file.program.arrays.keys() - self.arrays:
                self._array("VAR CONSTANT", node.array, file.program.arrays[node.array])

    def unit(self) -> Unit:
        """Return the unit."""
        body = self.lines(self.function.body)
        if self.function.returned is NOTHING:
            body = [f"{self.name} := TRUE;", *body]
        if body[-1] == "RETURN;":
            body = body[:-1]
        sort = "FUNCTION_BLOCK" if self.is_block else "FUNCTION"
        returned = "" if self.is_block else _TYPES[self.function.returned]
        sections = {title: each for title, each in self.sections.items() if each}
        statements = "".join(f"{line}\n" for line in body)
        return Unit("\n".join(wrapped(self.words)), sort, self.name, returned, sections, statements)

    # ── declarations ─────────────────────────────────────────────────────────────────

    def name_variables(self) -> None:
        """Name and declare ports, state and local variables."""
        function = self.function
        self.names = Names("st", {self.name})
        for key, variable in function.parameters.items():
            if not variable.of_array:
                self._declare_one("VAR_INPUT", key, variable.stem, variable.kind)
        if self.is_step:
            self._declare_state()
        elif self.is_block:
            self._declare_one("VAR_OUTPUT", RESULT, function.result, function.returned)
            inputs = [self.rename[key] for key in function.parameters]
            self.file.ports[self.key] = inputs, self.rename[RESULT]
            if function.may_lack_value:
                self._declare_one("VAR_OUTPUT", FIRED, "fired", TRUTH)
                self.file.flags[self.key] = self.rename[FIRED]
        else:
            self.rename[RESULT] = self.name
        for key in self.times_set:
            if key not in self.rename:
                variable = function.variables.get(key, Variable(key, function.real))
                self._declare_one("VAR", key, variable.stem, variable.kind)

    def _declare_one(
        self, title: str, key: str, stem: str, kind: Kind, start: str = "", remark: str = ""
    ) -> None:
        name = self.rename[key] = self.names.new(stem)
        declaration = Declaration(name, _TYPES[kind], start=start, remark=plain(remark))
        self.sections[title].append(declaration)

    def _array(self, title: str, key: str, array: Array) -> None:
        name = self.arrays[key] = self.names.new(array.stem)
        start = _array(self.file, name, array.kind, array.values, array.columns)
        declaration = Declaration(name, _TYPES[array.kind], len(array.values) - 1, start)
        self.sections[title].append(declaration)

    def _declare_state(self) -> None:
        program, self.arrays = self.file.program, self.state_arrays
        # A port gets its name before inner variables.
        for key, variable in program.drives.items():
            held = program.state.get(f"held {key}")
            start = _start(held) if held is not None and held.start else ""
            self._declare_one("VAR_OUTPUT", key, variable.stem, variable.kind, start)
            self.rename[f"held {key}"] = self.rename[key]
        if ERROR in self.times_set:
            remark = "an axis skipped this period: it read what is not a number"
            self._declare_one("VAR_OUTPUT", ERROR, "error", TRUTH, remark=remark)
        for key, member in program.state.items():
            retained = member.role in {"table", "visits"}
            title = "VAR_INPUT" if member.role == "gain" else "VAR RETAIN" if retained else "VAR"
            if isinstance(member.start, tuple):
                self._array(title, key, Array(member.stem, member.kind, member.start))
            elif member.role != "held":
                start = "" if member.role == "signal" else _start(member)
                self._declare_one(title, key, member.stem, member.kind, start, member.remark)

    # ── statements ───────────────────────────────────────────────────────────────────

    def _line(self, line: Line) -> list[str]:
        if isinstance(line, Call):
            return [self._called_block(line)]
        if isinstance(line, Assign) and line.value is symbol(f"held {line.name}"):
            return []  # an output keeps its value anyway
        return super()._line(line)

    def _set(self, key: str, value: str, remark: str) -> str:
        text = self.language.assign.format(name=self.rename[key], value=value)
        return text + (self.language.remark.format(remark) if remark else "")

    def _called_block(self, line: Call) -> str:
        key = line.function
        inputs, output = self.file.ports[key]
        if key not in self.instances:
            stem = self.file.program.functions[key].stem
            taken = stem in {array.stem for array in self.file.program.arrays.values()}
            name = self.instances[key] = self.names.new(f"the_{stem}" if taken else stem)
            self.sections["VAR"].append(Declaration(name, self.file.called[key]))
            self.rename[result_of(key)] = f"{name}.{output}"
            self.rename[fired_in(key)] = f"{name}.{self.file.flags.get(key, '')}"
        values = map(self.language.expression, line.arguments)
        passed = ", ".join(f"{x} := {value}" for x, value in zip(inputs, values, strict=True))
        return f"{self.instances[key]}({passed});"

    # ── array arguments ──────────────────────────────────────────────────────────────

    def _new_array(self, key: str) -> str:
        array = self.file.program.arrays.get(key)
        name = self.arrays[key] = self.rename[key] = self.names.new(array.stem if array else key)
        return name

    def _arrays_of_kernel(self, key: str) -> dict[str, tuple[Kind, int]]:
        """Return the arguments of a function by reference: scratch, then constants."""
        parameters, arrays = self.function.parameters, self.file.program.arrays
        room = {name: (each.kind, each.size) for name, each in parameters.items() if each.of_array}
        return room | {
            name: (arrays[name].kind, size) for name, size in self.file.lent[key].items()
        }

    def _made(self, line: Scratch) -> list[str]:
        """Declare the scratch array of a walk, and the constants that its functions are handed."""
        name = self._new_array(line.name)
        self.sections["VAR"].append(self.file.array_of_type(name, np.float64, line.size))
        return []

    def _lent(self, key: str) -> str:
        """Return an array passed to a function; of a block it is a variable."""
        if key not in self.arrays:
            array = self.file.program.arrays[key]
            start = _array(self.file, key, array.kind, array.values, 0)
            # Not a constant: arguments by reference must be writable.
            self.sections["VAR"].append(self.file.array_of_type(
                self._new_array(key), array.kind, len(array.values), start
            ))  # fmt: skip
        return self.arrays[key]

    def _called(self, node: Called, _binds: int) -> str:
        passed = [*map(self.language.expression, node.arguments),
                  *map(self._lent, self.file.lent.get(node.function, ()))]  # fmt: skip
        return f"{self.file.called[node.function]}({', '.join(passed)})"

    def _run(self, line: Run) -> list[str]:
        if "done" not in self.rename:
            self._declare_one("VAR", "done", "done", TRUTH)
        return [f"{self.rename['done']} := {super()._run(line)[0]}"]

    def _left(self, line: Leave) -> list[str]:
        value = [] if line.value is None else [
            f"{self.name} := {self.language.expression(line.value)};"
        ]  # fmt: skip
        return [*value, "RETURN;"]

    _LEAVES: ClassVar[Mapping[type, Callable[[Any, Any, int], str]]] = {
        **FunctionPrinter._LEAVES, Called: _called,
    }  # fmt: skip


def _start(member: Member) -> str:
    assert not isinstance(member.start, tuple)
    if member.kind is TRUTH:
        return TARGET.truths[bool(member.start)]
    if not math.isfinite(member.start):
        raise ExportError("Structured Text has no infinite number", hint="export C")
    return st_number(member.start, member.kind)
