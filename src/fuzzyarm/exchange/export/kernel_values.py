"""Expressions of the kernel's source as expressions of a program; see :mod:`.kernel_lowering`."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, NamedTuple, Protocol

from fuzzyarm.exchange.export.typed_program import (
    INDEX,
    OFFSET,
    REAL,
    TRUTH,
    Called,
    Cast,
    Element,
    Line,
    Quotient,
    Truth,
    When,
    Whole,
)
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.kernels import call, is_kernel
from fuzzyarm.symbolic.nodes import Apply, Constant, Node, apply, constant, symbol
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.symbolic.printing import Assign
from fuzzyarm.symbolic.translation.functions import NotTranslatedError
from fuzzyarm.symbolic.translation.types import Array, Scalar, TupleType, Type, wider

# ── whole numbers and conditions known at export ─────────────────────────────────────


def whole_number(operator: type[ast.operator], a: Node, b: Node) -> Node:
    """Return the result of an operator of Python on two whole numbers."""
    if operator is ast.FloorDiv:
        return Quotient(a, b)
    if operator is ast.Mult:
        return _times(a, b)
    if operator is ast.Sub:
        if isinstance(b, Whole):
            return plus(a, Whole(-b.value))
        return a - b
    return plus(a, b)


def plus(a: Node, b: Node) -> Node:
    """Return a sum; a known part is added last, and once."""
    if isinstance(a, Whole):
        a, b = b, a
    if not isinstance(b, Whole):
        return a + b
    known, rest = b.value, a
    if isinstance(a, Whole):
        return Whole(a.value + known)
    if isinstance(a, Apply) and a.operation in {"add", "subtract"}:
        rest_of_a, last = a.arguments
        if isinstance(last, Whole):
            rest, known = rest_of_a, known + (last.value if a.operation == "add" else -last.value)
    if known == 0:
        return rest
    return apply("add" if known > 0 else "subtract", rest, Whole(abs(known)))


def _times(a: Node, b: Node) -> Node:
    if isinstance(a, Whole):
        a, b = b, a
    if isinstance(a, Whole) and isinstance(b, Whole):
        return Whole(a.value * b.value)
    if isinstance(b, Whole) and b.value in {0, 1}:
        return a if b.value else b
    return a * b


def denied(condition: Node) -> Node:
    """Return whether a condition does not hold."""
    return Truth(not condition.value) if isinstance(condition, Truth) else ~condition


def both(a: Node, b: Node, *, is_and: bool) -> Node:
    """Return the conjunction (`is_and`) or the disjunction of two conditions."""
    for here, there in ((a, b), (b, a)):
        if isinstance(here, Truth):
            return there if here.value == is_and else Truth(not is_and)
    return a & b if is_and else a | b


SCRATCH = "scratch"

KINDS = {Scalar.TRUTH: TRUTH, Scalar.WHOLE: OFFSET, Scalar.REAL: REAL}
_OPERATIONS = {
    operation.python.partition("(")[0]: operation.name
    for operation in OPERATIONS.values()
    if operation.binds == 9
}
"""Names of operations by those of Python's functions."""

_COMPARED: dict[type, Callable[[Node, Node], Node]] = {
    ast.Lt: lambda a, b: a < b, ast.LtE: lambda a, b: a <= b, ast.Gt: lambda a, b: b < a,
    ast.GtE: lambda a, b: b <= a, ast.Eq: op.equal, ast.NotEq: lambda a, b: ~op.equal(a, b),
}  # fmt: skip
_DECIDED: dict[type, Callable[[Any, Any], bool]] = {
    ast.Lt: lambda a, b: a < b, ast.LtE: lambda a, b: a <= b, ast.Gt: lambda a, b: a > b,
    ast.GtE: lambda a, b: a >= b, ast.Eq: lambda a, b: a == b, ast.NotEq: lambda a, b: a != b,
}  # fmt: skip


class Stretch(NamedTuple):
    """A part of a memory: its begin and its length."""

    at: Node
    length: Node


class Value(NamedTuple):
    """An expression, a slice, or several values; `given` marks arguments of the walk itself."""

    content: Any
    type: Type
    given: str = ""


class Setting(Protocol):
    """Where a kernel is lowered: tables, and the other functions of the same walk."""

    whole: tuple[int, ...]
    floats: tuple[float, ...]
    limit: float
    least: float
    kind: Any

    def memory(self, kind: Array) -> str:
        """Return the key of the array in which stretches of a kind lie."""

    def function(self, function: Callable[..., Any], arguments: Sequence[Value]) -> LoweredKernel:
        """Lower a function for arguments of some types, with all functions that it calls."""

    def dispatch(self, number: Node, arguments: Sequence[Value]) -> list[Line]:
        """Return the call of the function behind an address."""


class LoweredKernel(Protocol):
    """A kernel as a function of the program."""

    key: str
    returned: Type
    result: Node | None

    def arguments(self, values: Sequence[Value]) -> tuple[Node, ...]:
        """Return the arguments of some values."""

    def run(self, values: Sequence[Value]) -> list[Line]:
        """Return the statement that calls it."""


class Expressions:
    """Lowers expressions of one kernel.

    Attributes
    ----------
    before : list of Line
        Statements to run before that of the expression.
    kinds : dict
        Types of the new variables.
    local, types : dict
        Values and types of the names of the kernel.
    """

    whole: Setting
    globals: dict[str, Any]
    before: list[Line]
    kinds: dict[str, Any]
    local: dict[str, Value]
    types: dict[str, Type]
    count: int

    def _result(self, number: int) -> Element:
        raise NotImplementedError

    def value(self, node: ast.expr) -> Value:
        """Lower an expression."""
        writer = self._VALUES.get(type(node))
        if writer is None:
            raise NotTranslatedError(node, "a program")
        return writer(self, node)

    def new_name(self, stem: str) -> str:
        """Return the name of a new variable, a whole number."""
        self.count += 1
        name = f"{stem} {self.count}"
        self.kinds[name] = OFFSET
        return name

    def named(self, value: Value) -> Value:
        """Return a variable set to a value before the statement."""
        if not isinstance(value.type, Scalar) or isinstance(value.content, Constant | Whole):
            return value
        name = self.new_name("t")
        self.kinds[name] = KINDS[value.type]
        self.before.append(Assign(name, value.content))
        return value._replace(content=symbol(name))

    def _number(self, value: object, node: ast.AST) -> Value:
        if isinstance(value, bool):
            return Value(Truth(value), Scalar.TRUTH)
        if isinstance(value, int):
            return Value(Whole(value), Scalar.WHOLE)
        if isinstance(value, float):
            limit = self.whole.limit
            value = max(value, self.whole.least) if value > 0.0 else value
            return Value(constant(min(max(value, -limit), limit)), Scalar.REAL)
        raise NotTranslatedError(node, "a program")

    def _constant(self, node: ast.Constant) -> Value:
        return self._number(node.value, node)

    def _name(self, node: ast.Name) -> Value:
        name = node.id
        if name in self.local:
            return self.local[name]
        if name not in self.types:
            return self._number(self.globals.get(name), node)
        type_ = self.types[name]
        if isinstance(type_, Array):
            ends = symbol(f"{name} at"), symbol(f"{name} n")
            return Value(Stretch(*ends), type_)
        return Value(symbol(name), type_)

    def _binary(self, node: ast.BinOp) -> Value:
        return self.calculated(node, self.value(node.left), self.value(node.right))

    def calculated(self, node: ast.BinOp | ast.AugAssign, a: Value, b: Value) -> Value:
        """Return the result of an operator on two values."""
        operator = type(node.op)
        both = wider(a.type, b.type)
        type_ = (
            Scalar.REAL if operator is ast.Div else Scalar.WHOLE if both is Scalar.TRUTH else both
        )
        one, other = as_type(a, type_), as_type(b, type_)
        if type_ is Scalar.WHOLE:
            return Value(whole_number(operator, one, other), type_)
        made = {ast.Add: "add", ast.Sub: "subtract", ast.Mult: "multiply", ast.Div: "divide"}
        return Value(apply(made[operator], one, other), type_)

    def _unary(self, node: ast.UnaryOp) -> Value:
        value = self.value(node.operand)
        if isinstance(node.op, ast.USub):
            if isinstance(value.content, Whole):
                return value._replace(content=Whole(-value.content.value))
            if isinstance(value.content, Constant):
                return value._replace(content=constant(-value.content.value))
            return value._replace(content=-value.content, given="")
        return Value(denied(value.content), Scalar.TRUTH)

    def _joined(self, node: ast.BoolOp) -> Value:
        is_and = isinstance(node.op, ast.And)
        joined: Node = Truth(is_and)
        for part in node.values:
            joined = both(joined, self.value(part).content, is_and=is_and)
        return Value(joined, Scalar.TRUTH)

    def _compared(self, node: ast.Compare) -> Value:
        values = [self.value(part) for part in (node.left, *node.comparators)]
        joined: Node = Truth(True)
        for a, sign, b in zip(values[:-1], node.ops, values[1:], strict=True):
            joined = both(joined, self._pair(a, type(sign), b), is_and=True)
        return Value(joined, Scalar.TRUTH)

    def _pair(self, a: Value, sign: type[ast.cmpop], b: Value) -> Node:
        if Scalar.TRUTH in {a.type, b.type}:  # whether two conditions are the same, or not
            assert sign in {ast.Eq, ast.NotEq}
            a, b = self.named(a), self.named(b)
            same: Node = (a.content & b.content) | (~a.content & ~b.content)
            return same if sign is ast.Eq else ~same
        type_ = wider(a.type, b.type)
        one, other = as_type(a, type_), as_type(b, type_)
        if isinstance(one, Whole | Constant) and isinstance(other, Whole | Constant):
            return Truth(_DECIDED[sign](one.value, other.value))
        return _COMPARED[sign](one, other)

    def _choice(self, node: ast.IfExp) -> Value:
        condition = self.value(node.test).content
        if isinstance(condition, Truth):
            return self.value(node.body if condition.value else node.orelse)
        branches = []
        for part in (node.body, node.orelse):
            outer, self.before = self.before, []
            branches.append((self.value(part), self.before))
            self.before = outer
        type_ = wider(branches[0][0].type, branches[1][0].type)
        name = self.new_name("t")
        self.kinds[name] = KINDS[Scalar(type_)]
        then, otherwise = (
            (*before, Assign(name, as_type(value, type_))) for value, before in branches
        )
        self.before.append(When(condition, then, otherwise))
        return Value(symbol(name), type_)

    def _tuple(self, node: ast.Tuple) -> Value:
        values = tuple(self.value(part) for part in node.elts)
        return Value(values, TupleType(tuple(value.type for value in values)))

    def _subscript(self, node: ast.Subscript) -> Value:
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            return Value(self.value(node.value.value).content.length, Scalar.WHOLE)
        whole = self.value(node.value)
        if isinstance(whole.type, TupleType):
            part: Value = whole.content[int(str(ast.literal_eval(node.slice)))]
            return part
        assert isinstance(whole.type, Array)
        stretch = whole.content
        if isinstance(node.slice, ast.Slice):
            ends = (node.slice.lower, node.slice.upper)
            start, end = (None if part is None else self.value(part).content for part in ends)
            # An explicit end lies inside.
            length = stretch.length if end is None else end
            at = stretch.at
            if start is not None:
                at = plus(at, start)
                length = whole_number(ast.Sub, length, start)
            return Value(Stretch(at, length), whole.type)
        index = plus(stretch.at, self.value(node.slice).content)
        tables = {Array.WHOLES: self.whole.whole, Array.CONSTANTS: self.whole.floats}
        if isinstance(index, Whole) and whole.type in tables:
            return self._number(tables[whole.type][index.value], node)
        element: Node = Element(self.whole.memory(whole.type), index_of(index))
        if whole.type is Array.WHOLES:
            element = Cast(element, self.whole.kind, OFFSET)
        return Value(element, whole.type.element)

    def _attribute(self, node: ast.Attribute) -> Value:
        if ast.unparse(node.value) == "math":
            return self._number(getattr(math, node.attr), node)
        if node.attr == "size":
            return Value(self.value(node.value).content.length, Scalar.WHOLE)
        raise NotTranslatedError(node, "a program")

    # ── calls ────────────────────────────────────────────────────────────────────────

    def _called(self, node: ast.Call) -> Value:
        word = node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
        function = None
        if isinstance(node.func, ast.Name):
            function = self.globals.get(word)
        if word == "float" and isinstance(node.args[0], ast.Constant):  # "inf", "nan"
            return self._number(float(str(node.args[0].value)), node)
        values = [self.value(argument) for argument in node.args]
        if function is call:
            self.before += self.whole.dispatch(values[0].content, values[1:])
            return Value((), TupleType(()))
        if function is not None and is_kernel(function):
            return self._of_kernel(function, values)
        if word == "len":
            return Value(values[0].content.length, Scalar.WHOLE)
        return self._of_mathematics(node, word, values)

    def _of_kernel(self, function: Callable[..., Any], values: list[Value]) -> Value:
        made = self.whole.function(function, values)
        if made.result is not None:
            return Value(made.result, made.returned)
        if isinstance(made.returned, Scalar):
            return Value(Called(made.key, made.arguments(values)), made.returned)
        self.before += made.run(values)
        if not isinstance(made.returned, TupleType):
            return Value((), TupleType(()))
        # At once: the next call leaves its own numbers there.
        parts = tuple(
            self.named(Value(from_real(self._result(i), part), part))
            for i, part in enumerate(made.returned.parts)
        )
        return Value(parts, made.returned)

    def _of_mathematics(self, node: ast.Call, word: str, values: list[Value]) -> Value:
        type_ = values[0].type
        for value in values[1:]:
            type_ = wider(type_, value.type)
        if word == "int":
            return Value(as_type(values[0], Scalar.WHOLE), Scalar.WHOLE)
        if word == "float":
            return Value(as_type(values[0], Scalar.REAL), Scalar.REAL)
        if word == "isnan":
            return Value(~op.equal(values[0].content, values[0].content), Scalar.TRUTH)
        if word in {"min", "max"} and type_ is Scalar.WHOLE:
            return self._extreme(word, values)
        if word not in _OPERATIONS:
            raise NotTranslatedError(node, "a program")
        contents = [as_type(value, Scalar.REAL) for value in values]
        if word in {"min", "max"}:  # two at a time, in their order
            found = contents[0]
            for other in contents[1:]:
                found = apply(_OPERATIONS[word], found, other)
            return Value(found, Scalar.REAL)
        return Value(apply(_OPERATIONS[word], *contents), Scalar.REAL)

    def _extreme(self, word: str, values: list[Value]) -> Value:
        """Return the least or the greatest whole number."""
        if all(isinstance(value.content, Whole) for value in values):
            found = (min if word == "min" else max)(value.content.value for value in values)
            return Value(Whole(found), Scalar.WHOLE)
        name = self.new_name("t")
        self.before.append(Assign(name, values[0].content))
        for other in map(self.named, values[1:]):
            ends = other.content, symbol(name)
            passed = apply("less", *(ends if word == "min" else ends[::-1]))
            self.before.append(When(passed, (Assign(name, other.content),)))
        return Value(symbol(name), Scalar.WHOLE)

    _VALUES: ClassVar[dict[type, Callable[..., Value]]] = {
        ast.Constant: _constant, ast.Name: _name, ast.BinOp: _binary, ast.UnaryOp: _unary,
        ast.BoolOp: _joined, ast.Compare: _compared, ast.IfExp: _choice, ast.Tuple: _tuple,
        ast.Subscript: _subscript, ast.Attribute: _attribute, ast.Call: _called,
    }  # fmt: skip


def as_type(value: Value, type_: Type) -> Node:
    """Return a value converted to another type."""
    content: Node = value.content
    if value.type == type_:
        return content
    if isinstance(content, Whole) and type_ is Scalar.REAL:
        return constant(float(content.value))
    if isinstance(content, Constant) and type_ is Scalar.WHOLE:
        return Whole(int(content.value))
    if value.type is Scalar.TRUTH:
        if isinstance(content, Truth):
            return constant(float(content.value)) if type_ is Scalar.REAL else Whole(content.value)
        raise TypeError("a condition is not a number here")
    return Cast(content, KINDS[Scalar(value.type)], KINDS[Scalar(type_)])


def from_real(element: Element, type_: Type) -> Node:
    """Return an element of the scratch array as a number of some type."""
    return element if type_ is Scalar.REAL else Cast(element, REAL, KINDS[Scalar(type_)])


def index_of(index: Node) -> Node:
    """Return a position as an index of an array."""
    if isinstance(index, Whole):
        return Whole(index.value, INDEX)
    return Cast(index, OFFSET, INDEX)
