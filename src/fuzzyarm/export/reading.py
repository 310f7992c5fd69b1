"""What a function of a kernel computes, as an expression: read from its own source.

A kernel is plain Python that writes numbers into cells; what is exported has to be the very
same arithmetic. So it is not written a second time: the source is run here on expressions in
place of numbers. What is known (the kind of an instruction, the cells that it names, numbers
that never change) is computed; what is not becomes an expression, and an ``if`` on it a
choice between what both branches leave behind. That needs no more of Python than kernels use:
assignments, ``if``, loops over known ranges, calls of each other.
"""

from __future__ import annotations

import ast
import inspect
import math
import operator
import textwrap
from collections.abc import Callable
from functools import cache
from typing import Any, ClassVar, Protocol

from fuzzyarm.expression import op
from fuzzyarm.expression.nodes import Node, apply

__all__ = ["KernelCells", "read"]


class KernelCells(Protocol):
    """The numbers that a kernel works on, by their index."""

    def load(self, index: int) -> Any:
        """Return a number, or an expression for one that changes."""

    def store(self, index: int, value: Any) -> None:
        """Have a number or an expression written."""

    def rounded(self, value: Any) -> Any:
        """Return a value as it is stored in the precision of the run."""

    def is_nan(self, value: Node) -> Node:
        """Return the condition that an expression is not a number."""

    def is_not_zero(self, value: Node) -> Node:
        """Return the condition that an expression is not 0."""


def read(function: Callable[..., Any], cells: KernelCells, *arguments: Any) -> Any:
    """Return what a kernel returns; the cells are told what it writes.

    Parameters
    ----------
    function : callable
        A kernel in plain Python.
    cells : KernelCells
        What its argument ``s`` stands for.
    *arguments
        Its arguments; ``s`` is given as `cells`, the code as a list.
    """
    trial = _BranchCells(cells)
    result = _KernelCall(function, trial).run(
        [trial if argument is cells else argument for argument in arguments]
    )
    for index, value in trial.written.items():
        cells.store(index, value)
    return result


class _BranchCells:
    """Cells that keep what is written until it is known which branch is taken."""

    def __init__(self, cells: KernelCells) -> None:
        self.cells = cells
        self.written: dict[int, Any] = {}

    def load(self, index: int) -> Any:
        return self.written[index] if index in self.written else self.cells.load(index)


_BINARY: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
    ast.Div: operator.truediv, ast.Mod: operator.mod,
}  # fmt: skip

_COMPARED: dict[type, Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge,
}  # fmt: skip


@cache
def _source(function: Callable[..., Any]) -> ast.FunctionDef:
    (definition,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
    assert isinstance(definition, ast.FunctionDef)
    return definition


class _KernelCall:
    """One call of a function."""

    def __init__(self, function: Callable[..., Any], cells: _BranchCells) -> None:
        self.function = function
        self.names = vars(inspect.getmodule(function))
        self.cells = cells
        self.values: dict[str, Any] = {}

    def run(self, arguments: list[Any]) -> Any:
        source = _source(self.function)
        names = [argument.arg for argument in source.args.args]
        self.values = dict(zip(names, arguments, strict=True))
        *body, last = source.body
        self.statements(body)
        if isinstance(last, ast.Return) and last.value is not None:
            return self.value(last.value)
        self.statements([last])
        return None

    # --- Statements ---

    def statements(self, body: list[ast.stmt]) -> None:
        for statement in body:
            self.statement(statement)

    def statement(self, node: ast.stmt) -> None:
        if isinstance(node, ast.Expr):
            if not isinstance(node.value, ast.Constant):  # else a docstring
                self.value(node.value)
        elif isinstance(node, ast.Assign):
            value = self.value(node.value)
            for target in node.targets:
                self.assign(target, value)
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            self.assign(node.target, self.value(node.value))
        elif isinstance(node, ast.AugAssign):
            before = self.value(node.target)
            self.assign(node.target, _BINARY[type(node.op)](before, self.value(node.value)))
        elif isinstance(node, ast.If):
            self.choose(node)
        elif isinstance(node, ast.For):
            for item in self.value(node.iter):
                self.assign(node.target, item)
                self.statements(node.body)
        else:
            raise NotImplementedError(ast.unparse(node))

    def assign(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            self.values[target.id] = value
        elif isinstance(target, ast.Tuple):
            for part, item in zip(target.elts, value, strict=True):
                self.assign(part, item)
        else:
            assert isinstance(target, ast.Subscript)
            assert self.value(target.value) is self.cells
            self.cells.written[self.value(target.slice)] = value

    def choose(self, node: ast.If) -> None:
        condition = self.value(node.test)
        if not isinstance(condition, Node):
            self.statements(node.body if condition else node.orelse)
            return
        names, stores = dict(self.values), dict(self.cells.written)
        self.statements(node.body)
        then_names, then_written = self.values, self.cells.written
        self.values, self.cells.written = dict(names), dict(stores)
        self.statements(node.orelse)
        # What one branch alone sets is not read afterwards in a kernel.
        for name in then_names.keys() & self.values.keys():
            self.values[name] = _choice(condition, then_names[name], self.values[name])
        for index in {**then_written, **self.cells.written}:
            before = stores[index] if index in stores else self.cells.cells.load(index)
            then = then_written.get(index, before)
            otherwise = self.cells.written.get(index, before)
            self.cells.written[index] = _choice(condition, then, otherwise)

    # --- Expressions ---

    def value(self, node: ast.expr) -> Any:
        reader = self._READERS.get(type(node))
        if reader is None:
            raise NotImplementedError(ast.unparse(node))
        return reader(self, node)

    def name(self, node: ast.Name) -> Any:
        return self.values[node.id] if node.id in self.values else self.names[node.id]

    def binary(self, node: ast.BinOp) -> Any:
        return _BINARY[type(node.op)](self.value(node.left), self.value(node.right))

    def comparison(self, node: ast.Compare) -> Any:
        (sign,), (right,) = node.ops, node.comparators
        a, b = self.value(node.left), self.value(right)
        if isinstance(sign, ast.NotEq) and isinstance(a, Node) and b == 0.0:
            return self.cells.cells.is_not_zero(a)
        return _compared(type(sign), a, b)

    def choice(self, node: ast.IfExp) -> Any:
        condition = self.value(node.test)
        if isinstance(condition, Node):
            return _choice(condition, self.value(node.body), self.value(node.orelse))
        return self.value(node.body if condition else node.orelse)

    def subscript(self, node: ast.Subscript) -> Any:
        array, index = self.value(node.value), self.value(node.slice)
        return self.cells.load(index) if array is self.cells else array[index]

    def unary(self, node: ast.UnaryOp) -> Any:
        value = self.value(node.operand)
        return -value if isinstance(node.op, ast.USub) else not value

    def joined(self, operation: ast.BoolOp) -> Any:
        """Join conditions, as far as the known ones do not decide."""
        conjunction = isinstance(operation.op, ast.And)
        node: Node | None = None
        for part in operation.values:
            value = self.value(part)
            if isinstance(value, Node):
                connective = "both" if conjunction else "either"
                node = value if node is None else apply(connective, node, value)
            elif bool(value) != conjunction:
                return value
        return conjunction if node is None else node

    def called(self, node: ast.Call) -> Any:
        if isinstance(node.func, ast.Attribute):  # math.isnan(x)
            assert node.func.attr == "isnan"
            value = self.value(node.args[0])
            is_number = not isinstance(value, Node)
            return math.isnan(value) if is_number else self.cells.cells.is_nan(value)
        assert isinstance(node.func, ast.Name)
        name, arguments = node.func.id, [self.value(part) for part in node.args]
        if name == "stored":
            return self.cells.cells.rounded(arguments[0])
        if name in _PLAIN:
            unknown = any(isinstance(argument, Node) for argument in arguments)
            plain, traced = _PLAIN[name]
            return traced(*arguments) if unknown else plain(*arguments)
        return _KernelCall(self.names[name], self.cells).run(arguments)

    _READERS: ClassVar[dict[type, Callable[..., Any]]] = {
        ast.Constant: lambda _, constant: constant.value,
        ast.Name: name,
        ast.BinOp: binary,
        ast.UnaryOp: unary,
        ast.BoolOp: joined,
        ast.Compare: comparison,
        ast.IfExp: choice,
        ast.Subscript: subscript,
        ast.Call: called,
    }


def _choice(condition: Node, then: Any, otherwise: Any) -> Any:
    if then is otherwise:
        return then
    return op.where(condition, then, otherwise)


def _compared(sign: type, a: Any, b: Any) -> Any:
    if sign in _COMPARED:
        return _COMPARED[sign](a, b)
    if not isinstance(a, Node) and not isinstance(b, Node):
        return a == b if sign is ast.Eq else a != b
    equal = op.equal(a, b)
    return equal if sign is ast.Eq else ~equal


_PLAIN: dict[str, tuple[Callable[..., Any], Callable[..., Any]]] = {
    "min": (min, op.minimum),
    "max": (max, op.maximum),
    "abs": (abs, abs),
    "float": (float, lambda value: value),
    "int": (int, int),
    "range": (range, range),
}
"""Functions of Python, on what is known and on expressions."""
