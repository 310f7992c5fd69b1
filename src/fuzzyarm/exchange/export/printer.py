"""A program in a language: its parts as text, by a record of spellings.

The records and the frames around the parts (a module, a class, a crate) are in `languages.py`.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fuzzyarm.exchange.export.numbers import Kind
from fuzzyarm.exchange.export.typed_program import (
    INDEX,
    OFFSET,
    TRUTH,
    ArrayArgument,
    Called,
    Cast,
    Count,
    Element,
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
    SelfTest,
    Stepped,
    Stop,
    Store,
    Truth,
    Variable,
    View,
    When,
    While,
    Whole,
    at,
    every_node,
)
from fuzzyarm.symbolic.identifiers import Names
from fuzzyarm.symbolic.nodes import Constant, Node, Symbol, apply, constant, symbol
from fuzzyarm.symbolic.op import where
from fuzzyarm.symbolic.operations import Operation
from fuzzyarm.symbolic.printing import Assign, Choose, Language


@dataclass(frozen=True)
class Target:
    """The spellings of a language."""

    language: Language  # how it writes expressions, assignments and choices
    names: str  # key of the reserved words in `fuzzyarm.symbolic.identifiers.RESERVED`
    # From a printer, an operation and the kind of its floats to its text with holes; it may add
    # helpers.
    operation: Callable[[Printer, Operation, Kind], str]
    # From a printer, a float and its kind to its text.
    number: Callable[[Printer, float, Kind], str]
    cast: Callable[[str, Kind, Kind], str]  # from a text and two kinds to the text of a conversion
    # From a printer, a name and an array to its definition.
    array: Callable[[Printer, str, Kind, Sequence[float], int], str]
    member: str  # a variable of the state
    again: str  # declares a variable that is assigned again later
    function: tuple[str, str]  # the line before the body, and the one after
    # Empty in a language without declarations.
    types: Mapping[Kind, str] = field(default_factory=dict)
    truths: tuple[str, str] = ("false", "true")  # false and true
    # With holes ``name`` and ``type``; that of the end of a set point, if it differs.
    parameter: str = "{name}"
    late: str = ""
    array_argument: str = ""
    argument: str = "{}"
    # An element of an array; an array as argument; the type of an array parameter.
    element: str = "{0}[{1}]"
    # Suffix of a literal of a whole number of a kind.
    marks: Mapping[Kind, str] = field(default_factory=dict)
    cast_binds: int = 0  # required precedence of the text: 9 for a conversion by a prefix operator
    quotient: str = "{} / {}"  # the quotient of two whole numbers, which binds like a product
    view: str = ""
    # The lines of compound statements.
    when: str = "if ({}) {{"
    otherwise: str = "}} else {{"
    repeat: str = "for ({index} = 0; {index} < {count}; {index}++) {{"
    loop: str = "while ({}) {{"
    end: str = "}"
    end_repeat: str | None = None
    end_loop: str | None = None
    remark: str = "// {}"
    returned: str = "return {};"
    private: str = "{}"
    # Prefixes of public and of private functions.
    public: str = ""
    hidden: str = ""
    unused: str = ""  # the statement that marks a parameter as unused, if a compiler needs one
    refused: re.Pattern[str] | None = None  # names that are macros in the including file
    # Several results, their type (of all kinds, or of the first), and that of an array of the
    # state.
    several: str = "[{}]"
    several_type: str = ""
    array_type: str = ""
    part: str = "{}[{}]"
    whole_tuple: str = "const {name} = {value};"
    helpers: tuple[str, ...] = ()  # names of helpers that `operation` adds
    flawed_floats: bool = False  # whether a port of the language may compute in floats of 32 bits
    # The declaration of an array of floats; its spelling as argument; the type of such a parameter.
    scratch: str = ""
    lent: str = "{}"
    written: str = ""
    # The head of a loop over whole numbers; empty for a language with conditional loops only.
    count: str = ""
    # The statements that return from anywhere, and that leave a loop.
    left: str = "return{};"
    stop: str = "break;"
    run: str = "{};"  # the statement that calls a procedure
    # For a language without types: the statement that refuses a non-numeric argument, with a hole
    # for its name, and the definition that it calls.
    checked: tuple[str, str] = ("", "")


@dataclass
class Printer:
    """The parts of a program as text."""

    program: Program
    target: Target
    taken: Iterable[str] = ()
    # Definitions, in order.
    constants: list[str] = field(default_factory=list)
    helpers: list[str] = field(default_factory=list)
    functions: list[str] = field(default_factory=list)
    arrays: dict[str, str] = field(default_factory=dict)
    members: dict[str, str] = field(default_factory=dict)
    called: dict[str, str] = field(default_factory=dict)
    known: dict[object, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        target = self.target
        self.names = Names(target.names, {*self.taken, *target.helpers}, target.refused)
        self.reserve()
        functions = self.program.functions
        for key in sorted(functions, key=lambda key: not functions[key].public):
            stem, public = functions[key].stem, functions[key].public
            self.called[key] = self.public(stem) if public else self.free(stem)
        for key, array in self.program.arrays.items():
            self.arrays[key] = self.constant(array.stem, array.kind, array.values, array.columns)
        self.name_state()
        for key, function in functions.items():
            self.functions.append("\n".join(self.function_printer(function).text(self.called[key])))

    def reserve(self) -> None:
        """Reserve the names in the frame of the file."""

    def name_state(self) -> None:
        """Name the variables of the state."""
        attributes = Names(self.target.names, {"step"})
        for key, member in self.program.state.items():
            name = attributes.new(member.stem)
            text = self.members[key] = self.target.member.format(name)
            if isinstance(member.start, tuple):
                self.arrays[key] = text

    def function_printer(self, function: Function, declared: Iterable[str] = ()) -> FunctionPrinter:
        """Return the printer of a function."""
        return FunctionPrinter(self, function, declared=declared)

    def helper(self, name: str, text: str) -> str:
        """Add a definition, once; return the name."""
        if text not in self.helpers:
            self.helpers.append(text)
        return name

    def constant(self, stem: str, kind: Kind, values: Sequence[float], columns: int = 0) -> str:
        """Define an array of constants beside those of the program; return its name."""
        name = self.free(stem)
        self.constants.append(self.target.array(self, name, kind, values, columns))
        return name

    def public(self, stem: str) -> str:
        """Return a name for others."""
        return self.names.new(stem)

    def free(self, stem: str) -> str:
        """Return a name that nothing in the file has yet."""
        return self.target.private.format(self.names.new(stem))

    def call(self, key: str) -> str:
        """Return the signature of a function: its name and its parameters."""
        function = self.program.functions[key]
        return f"{self.called[key]}({', '.join(self.parameters(function).values())})"

    def parameters(self, function: Function) -> dict[str, str]:
        """Return the names of parameters, by their symbols."""
        names = self.names.inner()
        return {key: names.new(variable.stem) for key, variable in function.parameters.items()}

    def test_lines(self, test: SelfTest, stem: str) -> list[str]:
        """Return the statements of a test: a wrong result sets ``failed``."""
        width = len(test.rows[0])
        key = f"test {len(self.arrays)}"
        data = [x for row in test.rows for x in row]
        self.arrays[key] = self.constant(stem, test.kind, data, width)
        first = symbol("k") * at(width)
        row = [Element(key, first + at(i) if i else first) for i in range(width)]
        given = tuple(row[: test.inputs])
        results = tuple(f"found {i}" for i in range(width - test.inputs))
        local = {"failed": Variable("failed", TRUTH), "k": Variable("k", INDEX)}
        local |= {name: Variable("found", test.kind) for name in results}
        local["within"] = Variable("within", test.kind)
        if test.function:
            lines: list[Line] = [Assign(results[0], Called(test.function, given))]
        else:
            lines = [
                Stepped(results, given + (Truth(False),) * test.has_end_argument, test.guarded)
            ]
        pairs = zip(map(symbol, results), row[test.inputs :], strict=True)
        lines += judged(test, list(pairs), self.target)
        body = [Repeat("k", len(test.rows), tuple(lines))]
        function = Function("", {}, TRUTH, body, local, test.kind)
        return self.function_printer(function, {"failed"}).lines(body)


def judged(test: SelfTest, pairs: Sequence[tuple[Node, Node]], target: Target) -> list[Line]:
    """Return the statements that set ``failed`` for a wrong result."""
    if np.issubdtype(test.kind, np.integer):
        return [When(~apply("equal", *pair), (Assign("failed", Truth(True)),)) for pair in pairs]
    most: Node = constant(test.tolerance)
    if target.flawed_floats:
        flawed = apply("equal", constant(1.0) + 1e-10, 1.0)
        most = where(flawed, constant(test.tolerance_of_singles), constant(test.tolerance))
    within = symbol("within")
    lines: list[Line] = [Assign("within", most)]
    for column, (result, expected) in enumerate(pairs):
        off = result - expected
        fine: Node = (off <= within) & (-within <= off)
        if any(np.isnan(row[test.inputs + column]) for row in test.rows):
            fine = fine | (~apply("equal", expected, expected) & ~apply("equal", result, result))
        lines.append(When(~fine, (Assign("failed", Truth(True)),)))
    return lines


def start_text(printer: Printer, member: Member) -> str:
    """Return the text of a state number's initial value."""
    start, target = member.start, printer.target
    assert not isinstance(start, tuple)
    if member.kind is TRUTH:
        return target.truths[bool(start)]
    if np.issubdtype(member.kind, np.integer):
        return f"{int(start)}{target.marks.get(member.kind, '')}"
    return target.number(printer, float(start), member.kind)


class FunctionPrinter:
    """One function: the names of its variables and its lines."""

    def __init__(
        self, printer: Printer, function: Function, *, declared: Iterable[str] = ()
    ) -> None:
        self.printer, self.target, self.function = printer, printer.target, function
        self.times_set = Counter(_set_in(function.body))
        self.declared = {*function.parameters, *declared, *printer.members}
        self.rename = dict(printer.members)
        self.names = printer.names.inner()
        self.name_variables()
        self.arrays = {**printer.arrays, **self.rename}
        self.language = self.target.language._replace(
            text=lambda operation: self.target.operation(printer, operation, function.real),
            number=lambda value: self.target.number(printer, value, function.real),
            rename=self.rename,
            leaf=self._leaf,
        )

    def name_variables(self) -> None:
        """Name parameters and local variables."""
        for key, variable in {**self.function.parameters, **self.function.variables}.items():
            if key not in self.rename:
                self.rename[key] = self.names.new(variable.stem)
        for key in self.times_set:
            if key not in self.rename:
                self.rename[key] = self.names.new(key)

    def kind_of(self, key: str) -> Kind:
        """Return the kind of a variable."""
        function = self.function
        member = self.printer.program.state.get(key)
        variable = function.variables.get(key) or function.parameters.get(key) or member
        return variable.kind if variable else function.real

    def parameter_texts(self) -> list[str]:
        """Return the parameters, with types in a typed language."""
        target, texts = self.target, []
        for key, variable in self.function.parameters.items():
            kind = target.types.get(variable.kind, "")
            template = target.array_argument if variable.of_array else ""
            template = target.written if variable.size else template
            kind = template.format(kind) if template else kind
            late = variable.kind is TRUTH and not self.function.of_kernel
            form = (target.late if late else "") or target.parameter
            texts.append(form.format(name=self.rename[key], type=kind))
        return texts

    def text(self, name: str) -> list[str]:
        """Return the definition."""
        function = self.function
        head, end = self.target.function
        opening = head.format(
            name=name, parameters=", ".join(self.parameter_texts()),
            type=self.target.types.get(function.returned, ""),
            public=self.target.public if function.public else self.target.hidden,
        )  # fmt: skip
        remark = [f"    {self.target.remark.format(function.remark)}"] if function.remark else []
        unread: list[str] = []
        if self.target.unused:
            nodes = list(every_node(function.body))
            read = {node.name for node in nodes if isinstance(node, Symbol)}
            read |= {node.array for node in nodes if isinstance(node, Element | Search)}
            unread = [f"    {self.target.unused.format(self.rename[key])}"
                      for key in function.parameters if key not in read]  # fmt: skip
        checks = self.checks() if function.public else []
        lines = [f"    {line}" for line in [*checks, *self.lines(function.body)]]
        return [opening, *remark, *unread, *lines, end]

    def checks(self) -> list[str]:
        """Return the statements that refuse non-numeric arguments."""
        statement, definition = self.target.checked
        numbers = [
            self.rename[key]
            for key, variable in self.function.parameters.items()
            if statement and variable.kind is not TRUTH and not variable.of_array
        ]
        if numbers:
            self.printer.helper("checked", definition)
        return [statement.format(name) for name in numbers]

    # ── statements ───────────────────────────────────────────────────────────────────

    def lines(self, body: Sequence[Line]) -> list[str]:
        """Return the lines of some statements."""
        return [text for line in body for text in self._line(line)]

    def _inner(self, body: Sequence[Line]) -> list[str]:
        declared = set(self.declared)
        lines = [f"    {line}" for line in self.lines(body)]
        self.declared = declared
        return lines

    def _line(self, line: Line) -> list[str]:
        lines: list[str] = getattr(self, self._LINES[type(line)])(line)
        return lines

    def _assigned(self, line: Assign) -> list[str]:
        if isinstance(line.value, Constant):
            value = self.target.number(self.printer, line.value.value, self.kind_of(line.name))
        else:
            value = self.language.expression(line.value)
        return [self._set(line.name, value, line.remark)]

    def _returned(self, line: Return) -> list[str]:
        values = list(map(self.language.expression, (line.value, *line.more)))
        value = self.target.several.format(", ".join(values)) if line.more else values[0]
        return [self.target.returned.format(value)]

    def _viewed(self, line: View) -> list[str]:
        """Name a part of an array."""
        kind = self.target.types[self.printer.program.arrays[line.array].kind]
        array, position = self.arrays[line.array], self.language.expression(line.position)
        name = self.arrays[line.name] = self.names.new(line.name)
        return [self.target.view.format(type=kind, name=name, array=array, position=position)]

    def _stored(self, line: Store) -> list[str]:
        index, value = map(self.language.expression, (line.position, line.value))
        element = self.target.element.format(self.arrays[line.array], index)
        return [self.language.assign.format(name=element, value=value)]

    def _repeated(self, line: Repeat) -> list[str]:
        count, kind = self._number(line.times), self.target.types.get(INDEX, "")
        index = self.rename[line.variable]
        opening = self.target.repeat.format(index=index, count=count, type=kind)
        return [opening, *self._inner(line.body), *self._end(self.target.end_repeat)]

    def _looped(self, line: While) -> list[str]:
        opening = self.target.loop.format(self.language.expression(line.condition))
        return [opening, *self._inner(line.body), *self._end(self.target.end_loop)]

    def _stepped(self, line: Stepped) -> list[str]:
        arguments = ", ".join(map(self.language.expression, line.arguments))
        call = f"controller.step({arguments})"
        if len(line.targets) == 1:
            return [self._set(line.targets[0], call, "")]
        drives = self.names.new("drives")
        head = self.target.whole_tuple.format(name=drives, value=call)
        parts = (self.target.part.format(drives, i) for i in range(len(line.targets)))
        return [head, *map(self._set, line.targets, parts, [""] * len(line.targets))]

    def _counted(self, line: Count) -> list[str]:
        """Run statements in a loop with a counter."""
        if not self.target.count:
            following = symbol(line.variable) + Whole(line.step)
            ends = symbol(line.variable), line.end
            short = apply("less", *(ends if line.step > 0 else ends[::-1]))
            self.times_set[line.variable] += 1
            return [
                *self._assigned(Assign(line.variable, line.start)),
                *self._looped(While(short, (*line.body, Assign(line.variable, following)))),
            ]  # fmt: skip
        start, end = map(self.language.expression, (line.start, line.end))
        opening = self.target.count.format(
            index=self.rename[line.variable], start=start, end=end, step=abs(line.step),
            sign="<" if line.step > 0 else ">", way="+" if line.step > 0 else "-",
            last=self.language.expression(_last_of(line)), signed=line.step,
            type=self.target.types.get(OFFSET, ""),
        )  # fmt: skip
        self.declared.add(line.variable)
        return [opening, *self._inner(line.body), *self._end(self.target.end_repeat)]

    def _stopped(self, _line: Stop) -> list[str]:
        return [self.target.stop]

    def _made(self, line: Scratch) -> list[str]:
        return [self.target.scratch.format(name=self.rename[line.name], count=line.size)]

    def _run(self, line: Run) -> list[str]:
        return [self.target.run.format(self._called(Called(line.function, line.arguments), 0))]

    def _left(self, line: Leave) -> list[str]:
        value = "" if line.value is None else f" {self.language.expression(line.value)}"
        return [self.target.left.format(value)]

    def _end(self, end: str | None = None) -> list[str]:
        end = self.target.end if end is None else end
        return [end] if end else []

    def _set(self, key: str, value: str, remark: str) -> str:
        template = self.language.assign
        if key not in self.declared:
            template = self.target.again if self.times_set[key] > 1 else self.language.declare
            self.declared.add(key)
        kind = self.target.types.get(self.kind_of(key), "")
        text = template.format(name=self.rename[key], value=value, type=kind)
        return text + (self.language.remark.format(remark) if remark else "")

    def _branches(self, line: Choose | When) -> list[str]:
        both = set(_set_in(line.then)) & set(_set_in(line.otherwise))
        if isinstance(line, Choose):
            both = {line.name}
        lines = [self._declare(key) for key in sorted(both - self.declared)]
        lines = lines if self.language.declare_only else []
        remark = getattr(line, "remark", "")
        opening = self.target.when.format(self.language.expression(line.condition))
        lines.append(opening + (self.language.remark.format(remark) if remark else ""))
        lines += self._inner(line.then)
        if line.otherwise:
            lines += [self.target.otherwise.format(), *self._inner(line.otherwise)]
        return [*lines, *self._end()]

    def _declare(self, key: str) -> str:
        self.declared.add(key)
        return self.language.declare_only.format(
            name=self.rename[key], type=self.target.types.get(self.kind_of(key), "")
        )

    # ── expressions that only programs have ──────────────────────────────────────────

    def _leaf(self, node: Node, binds: int) -> str:
        return self._LEAVES[type(node)](self, node, binds)

    def _whole(self, node: Whole, binds: int) -> str:
        text = f"{node.value}{self.target.marks.get(node.kind, '')}"
        return f"({text})" if node.value < 0 and binds > 5 else text

    def _number(self, value: int) -> str:
        return self._whole(Whole(value, INDEX), 0)

    def _truth(self, node: Truth, _binds: int) -> str:
        return self.target.truths[node.value]

    def _element(self, node: Element, _binds: int) -> str:
        index = self.language.expression(node.index)
        return self.target.element.format(self.arrays[node.array], index)

    def _called(self, node: Called, _binds: int) -> str:
        arguments = ", ".join(map(self.language.expression, node.arguments))
        return f"{self.printer.called[node.function]}({arguments})"

    def _search(self, node: Search, _binds: int) -> str:
        array, end = self.arrays[node.array], node.first + node.count
        if self.printer.program.pointers and node.first:
            array, end = f"&{array}[{self._number(node.first)}]", node.count
        passed = self.target.argument.format(array), self._number(end)
        arguments = ", ".join([*passed, self.language.expression(node.value)])
        return f"{self.printer.called[node.function]}({arguments})"

    def _array_argument(self, node: ArrayArgument, _binds: int) -> str:
        name = self.rename[node.array]
        return name if node.array in self.function.parameters else self.target.lent.format(name)

    def _quotient(self, node: Quotient, binds: int) -> str:
        parts = (self.language.expression(part, 7) for part in (node.dividend, node.divisor))
        text = self.target.quotient.format(*parts)
        return f"({text})" if binds > 6 else text

    def _cast(self, node: Cast, binds: int) -> str:
        plain = not self.target.cast("", node.before, node.after)
        text = self.language.expression(node.value, binds if plain else self.target.cast_binds)
        return self.target.cast(text, node.before, node.after)

    _LINES: ClassVar[Mapping[type, str]] = {
        Assign: "_assigned", Choose: "_branches", When: "_branches", Return: "_returned",
        Store: "_stored", Repeat: "_repeated", While: "_looped", Stepped: "_stepped",
        View: "_viewed", Count: "_counted", Stop: "_stopped", Scratch: "_made", Run: "_run",
        Leave: "_left",
    }  # fmt: skip
    _LEAVES: ClassVar[Mapping[type, Callable[[Any, Any, int], str]]] = {
        Whole: _whole, Truth: _truth, Element: _element, Called: _called, Search: _search,
        Quotient: _quotient, Cast: _cast, ArrayArgument: _array_argument,
    }  # fmt: skip


def _last_of(line: Count) -> Node:
    """Return the last number of a loop that goes up or down by one, or the next after it."""
    step = 1 if line.step > 0 else -1
    if isinstance(line.end, Whole):
        return Whole(line.end.value - step)
    return line.end - Whole(1) if step > 0 else line.end + Whole(1)


def _set_in(body: Sequence[Line]) -> list[str]:
    """Return the variables that statements set, as often as they do so."""
    names = []
    for line in body:
        if isinstance(line, Assign):
            names.append(line.name)
        elif isinstance(line, Choose):
            names.append(line.name)
            branches = {*_set_in(line.then), *_set_in(line.otherwise)} - {line.name}
            names += branches
        elif isinstance(line, When):
            names += [*_set_in(line.then), *_set_in(line.otherwise)]
        elif isinstance(line, Scratch):
            names.append(line.name)
        elif isinstance(line, Stepped):
            names += line.targets
        elif isinstance(line, Repeat | While | Count):
            names += [] if isinstance(line, While) else [line.variable]
            names += _set_in(line.body)
    return names
