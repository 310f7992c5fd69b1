"""The exported program: functions over typed variables, a state, a self-test, without a language.

Rule bases, tables and controllers are lowered to a `Program` once (`lowering.py`,
`controller_lowering.py`); a target is a record of spellings (`languages.py`) that one printer
(`printer.py`) reads.

Expressions are those of :mod:`fuzzyarm.symbolic.nodes`: they have text in every language
already, so formulas of shapes, norms and sources are used directly. Parts that only
programs have (elements of arrays, calls, conversions, whole numbers) are further nodes. Python's
own syntax tree, the form of the kernels, was the other candidate: it has no remarks and one kind of
float, and would have been a third printer of formulas.

A variable is a symbol of any spelling; `Variable` has the stem of its name and its kind, and the
printer finds a free identifier in its language. So no lowering knows reserved words.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.exchange.export.numbers import Kind
from fuzzyarm.symbolic.nodes import Node, apply, symbol
from fuzzyarm.symbolic.printing import Assign, Choose

REAL, WHOLE, TRUTH = np.float64, np.int32, bool
"""Kinds of variables, beside the small whole numbers of fixed point."""

INDEX, COUNT = np.uintp, np.uint32
"""Kinds of nonnegative integers: numbers of elements, and counts of events."""

OFFSET = np.intp
"""The kind of whole numbers in kernels, which count elements and may be negative on their way."""

NOTHING = type(None)
"""The kind of a procedure's result."""


# ── expressions ──────────────────────────────────────────────────────────────────────


@dataclass(frozen=True, eq=False)
class Whole(Node):
    """A whole number of a kind."""

    value: int
    kind: Kind = WHOLE


@dataclass(frozen=True, eq=False)
class Truth(Node):
    """True or false."""

    value: bool


@dataclass(frozen=True, eq=False)
class Element(Node):
    """An element of an array, by the key of the array."""

    array: str
    index: Node


@dataclass(frozen=True, eq=False)
class Called(Node):
    """The result of a function of the program, by the key of the function."""

    function: str
    arguments: tuple[Node, ...]


@dataclass(frozen=True, eq=False)
class ArrayArgument(Node):
    """An array passed to a function, which may write into it."""

    array: str


@dataclass(frozen=True, eq=False)
class Fires(Node):
    """Whether a rule fired in the last call of a function, for a language without NaN."""

    function: str


@dataclass(frozen=True, eq=False)
class Cast(Node):
    """A value converted to another kind; floats are rounded, or truncated to a whole number."""

    value: Node
    before: Kind
    after: Kind


@dataclass(frozen=True, eq=False)
class Quotient(Node):
    """The quotient of two non-negative whole numbers, truncated."""

    dividend: Node
    divisor: Node


@dataclass(frozen=True, eq=False)
class Search(Node):
    """The number of elements of a rising array, from `first` on, below a value; 0 for NaN.

    `function` counts them (`Program.search`), up to the end that it is given: those that equal the
    value as well, or not.
    """

    function: str
    array: str
    first: int
    count: int
    value: Node
    reached: bool = False


def at(number: int) -> Node:
    """Return the number of an element."""
    return Whole(number, INDEX)


def cast(value: Node, before: Kind, after: Kind) -> Node:
    """Return a value converted to another kind; unchanged if the kinds are equal."""
    return value if before is after else Cast(value, before, after)


def parts(node: Node) -> tuple[Node, ...]:
    """Return the operands of a node, those of programs included."""
    if isinstance(node, Element):
        return (node.index,)
    if isinstance(node, Called):
        return node.arguments
    if isinstance(node, Cast | Search):
        return (node.value,)
    if isinstance(node, Quotient):
        return (node.dividend, node.divisor)
    return getattr(node, "arguments", ())


# ── statements ───────────────────────────────────────────────────────────────────────


class Store(NamedTuple):
    """Set an element of an array of the state."""

    array: str
    position: Node
    value: Node


class When(NamedTuple):
    """Run statements if a condition holds, else others."""

    condition: Node
    then: tuple[Line, ...]
    otherwise: tuple[Line, ...] = ()
    remark: str = ""


class View(NamedTuple):
    """Name the part of an array of constants that begins at an element; for pointers alone."""

    name: str
    array: str
    position: Node


class Repeat(NamedTuple):
    """Run statements with an index from 0 to `times` - 1."""

    variable: str
    times: int
    body: tuple[Line, ...]


class While(NamedTuple):
    """Run statements as long as a condition holds."""

    condition: Node
    body: tuple[Line, ...]


class Count(NamedTuple):
    """Run statements with a whole number that goes in steps from `start` to before `end`."""

    variable: str
    start: Node
    end: Node
    step: int
    body: tuple[Line, ...]


class Stop(NamedTuple):
    """Leave the innermost loop."""


class Scratch(NamedTuple):
    """Make an array of floats that functions write into."""

    name: str
    size: int


class Run(NamedTuple):
    """Call a procedure, by its key."""

    function: str
    arguments: tuple[Node, ...]


class Leave(NamedTuple):
    """Return from a function, from anywhere in it; from a procedure without a value."""

    value: Node | None = None


class Return(NamedTuple):
    """The result of a function, as its last line; of a step several."""

    value: Node
    more: tuple[Node, ...] = ()


class Stepped(NamedTuple):
    """Run a period of the tested controller; set variables to its drives."""

    targets: tuple[str, ...]
    arguments: tuple[Node, ...]
    guarded: bool = False


Line = Any
"""`Assign` and `Choose` of :mod:`fuzzyarm.symbolic.printing`, and the statements above."""


# ── the parts of a program ───────────────────────────────────────────────────────────


class Variable(NamedTuple):
    """The stem of a name, and its kind, or that of the elements of an array argument.

    An array of known size is writable.
    """

    stem: str
    kind: Kind = REAL
    of_array: bool = False
    size: int = 0


@dataclass(frozen=True, eq=False)
class Array:
    """Constants."""

    stem: str  # of its name
    kind: Kind  # of its elements
    values: tuple[float, ...]  # in order
    columns: int = 0  # elements to a line, where that matters


@dataclass(frozen=True, eq=False)
class Member:
    """A variable of the state."""

    # Of its name, with its axis if there are several, and without.
    stem: str
    kind: Kind  # of it, or of its elements
    # Its value before the first period; of an array those of all elements.
    start: float | tuple[float, ...]
    axis: str = ""  # its axis; empty if shared by all axes
    remark: str = ""  # its unit or purpose
    role: str = "state"  # ``gain``, ``signal``, ``state``, ``table`` (which learns) or ``held``
    name: str = ""


@dataclass(frozen=True, eq=False)
class Function:
    """A function."""

    stem: str  # of its name
    parameters: Mapping[str, Variable]  # by their symbols, in order
    returned: Kind  # kind of its result
    body: Sequence[Line]  # the last one is `Return`
    # Local variables, by symbol; others have their symbol as the stem and `real` as the kind.
    variables: Mapping[str, Variable] = field(default_factory=dict)
    real: Kind = REAL  # kind of the arithmetic
    public: bool = False  # whether it is called from outside
    remark: str = ""  # its result
    result: str = ""  # stem of the name of its result, if that is a variable
    may_lack_value: bool = False  # whether it is a rule base, which returns NaN if no rule fires
    # Whether it comes from a kernel: its last statement is `Leave`, or none.
    of_kernel: bool = False


@dataclass(frozen=True, eq=False)
class SelfTest:
    """Rows of inputs and expected results."""

    function: str  # key of the function; empty for the step
    kind: Kind
    rows: Sequence[tuple[float, ...]]  # inputs, then results
    inputs: int  # how many of a row are inputs
    tolerance: float  # the largest difference of a result
    tolerance_of_singles: float  # the same for a port in floats of 32 bits
    # Whether a step has a last argument for the end of a set point, which is false.
    has_end_argument: bool = False
    guarded: bool = False  # whether it is of the guarded step


@dataclass
class Program:
    """An exported program."""

    # By key, in order of definition: callees come before callers.
    arrays: dict[str, Array] = field(default_factory=dict)
    functions: dict[str, Function] = field(default_factory=dict)
    state: dict[str, Member] = field(default_factory=dict)
    # Of a controller: its parameters are the ports; it returns the drives.
    step: Function | None = None
    guard: Function | None = None  # of a guarded one: the test of its state, before the step
    # For a controller, by symbol: the result of a step.
    drives: dict[str, Variable] = field(default_factory=dict)
    tests: list[SelfTest] = field(default_factory=list)  # its self-test
    # Of rule bases and tables: ``name``, ``low``, ``high`` and ``description``.
    inputs: list[dict[str, Any]] = field(default_factory=list)
    outputs: list[dict[str, Any]] = field(default_factory=list)
    # Whether it is for a language with pointers: parts of arrays are passed, and a step finds the
    # end of a set point in its state.
    pointers: bool = False
    endless: bool = True  # whether it is for a language with infinite numbers

    def array(self, stem: str, kind: Kind, values: Sequence[float], columns: int = 0) -> str:
        """Return the key of an array of constants; equal ones are one."""
        data = np.asarray(values, np.dtype(kind))
        key = f"array {data.dtype} {data.tobytes().hex()}"
        if key not in self.arrays:
            self.arrays[key] = Array(stem, kind, tuple(data.tolist()), columns)
        return key

    def function(self, key: str, function: Function) -> str:
        """Add a function unless it is there; return its key."""
        self.functions.setdefault(key, function)
        return key

    def search(
        self, array: str, first: int, count: int, value: Node, *, kind: Kind, reached: bool
    ) -> Search:
        """Return the search of a value of a kind, counting the reached or passed elements."""
        begin = 0 if self.pointers else first
        key = f"count {np.dtype(kind)} {reached} {begin}"
        function = self.function(key, _counting(kind, begin, reached=reached))
        return Search(function, array, first, count, value, reached)


def _counting(kind: Kind, first: int, *, reached: bool) -> Function:
    """Return the function that counts the elements of an array from `first` on, by bisection."""
    low, high, middle = (symbol(name) for name in ("low", "high", "middle"))
    passed = apply("less_equal" if reached else "less", Element("points", middle), symbol("x"))
    body = (
        Assign("low", at(first)),
        Assign("high", symbol("end")),
        While(low < high, (
            Assign("middle", low + Quotient(high - low, at(2))),
            When(passed, (Assign("low", middle + at(1)),), (Assign("high", middle),)),
        )),
        Return(low - at(first) if first else low),
    )  # fmt: skip
    parameters = {
        "points": Variable("points", kind, of_array=True), "end": Variable("end", INDEX),
        "x": Variable("x", kind),
    }  # fmt: skip
    local = {name: Variable(name, INDEX) for name in ("low", "high", "middle")}
    stem = "reached" if reached else "passed"
    remark = "the number of elements that x has reached" if reached else (
        "the number of elements smaller than x; none for NaN")  # fmt: skip
    return Function(stem, parameters, INDEX, body, local, kind, remark=remark)


def blocks_of(line: Line) -> list[tuple[Line, ...]]:
    """Return the blocks of a compound statement."""
    if isinstance(line, When | Choose):
        return [line.then, line.otherwise]
    return [line.body] if isinstance(line, Repeat | While | Count) else []


def every_line(body: Iterable[Line]) -> Iterator[Line]:
    """Yield all statements, each before those in it."""
    for line in body:
        yield line
        for block in blocks_of(line):
            yield from every_line(block)


def every_node(lines: Iterable[Any]) -> Iterator[Node]:
    """Yield all nodes of some statements."""
    for value in lines:
        if isinstance(value, Node):
            yield value
            yield from every_node(parts(value))
        elif isinstance(value, tuple | list):
            yield from every_node(value)
