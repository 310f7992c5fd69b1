"""Expressions as graphs: formulas and definitions of kinds as data.

A node is a constant, a symbol or an operation applied to nodes. Equal nodes are one object
(hash consing), so a common subexpression is one node with two parents, visited once by each
reading. The meaning of the operations for each reader is in
:mod:`fuzzyarm.symbolic.operations`.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import ClassVar, TypeAlias, TypeVar
from weakref import WeakValueDictionary

T = TypeVar("T")

# Every living node by its content: equal expressions are shared. Weak references, so that
# expressions of discarded rule bases are freed.
_nodes: WeakValueDictionary[tuple[object, ...], Node] = WeakValueDictionary()

_of_values: ContextVar[bool] = ContextVar("of_values", default=False)


@contextmanager
def comparing_values() -> Iterator[None]:
    """Refuse equality of different nodes: code written for numbers means equality of values."""
    token = _of_values.set(True)
    try:
        yield
    finally:
        _of_values.reset(token)


class Node:
    """Base of all nodes: equality is identity, and Python's operators build expressions.

    A comparison gives a condition; ``op.where`` chooses by it. Conditions are combined by ``&``,
    ``|`` and ``~``. Equality of values is ``op.equal``: ``==`` tests whether two nodes are the same
    expression, and is refused with a number.
    """

    __slots__ = ("__weakref__",)

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        # `if x == 0` would be false of every symbol, and the branch lost without a word.
        if _of_values.get() or not isinstance(other, Node):
            raise TypeError("an expression equals no number while it is traced: use op.equal")
        return False

    def __hash__(self) -> int:
        if _of_values.get():  # `x in {0.0, 1.0}` compares hashes first
            raise TypeError("an expression is in no set of numbers while it is traced")
        return id(self)

    def __add__(self, other: Number) -> Node:
        return apply("add", self, other)

    def __radd__(self, other: Number) -> Node:
        return apply("add", other, self)

    def __sub__(self, other: Number) -> Node:
        return apply("subtract", self, other)

    def __rsub__(self, other: Number) -> Node:
        return apply("subtract", other, self)

    def __mul__(self, other: Number) -> Node:
        return apply("multiply", self, other)

    def __rmul__(self, other: Number) -> Node:
        return apply("multiply", other, self)

    def __truediv__(self, other: Number) -> Node:
        return apply("divide", self, other)

    def __rtruediv__(self, other: Number) -> Node:
        return apply("divide", other, self)

    def __mod__(self, other: Number) -> Node:
        return apply("remainder", self, other)

    def __rmod__(self, other: Number) -> Node:
        return apply("remainder", other, self)

    def __pow__(self, exponent: Number) -> Node:
        # A square is a product: the same bits on every machine, unlike pow().
        if isinstance(exponent, int | float) and exponent in {2, 3}:
            square = apply("multiply", self, self)
            return square if exponent == 2 else apply("multiply", square, self)
        return apply("power", self, exponent)

    def __rpow__(self, base: Number) -> Node:
        return apply("power", base, self)

    def __neg__(self) -> Node:
        return apply("negative", self)

    def __pos__(self) -> Node:
        return self

    def __abs__(self) -> Node:
        return apply("absolute", self)

    def __lt__(self, other: Number) -> Node:
        return apply("less", self, other)

    def __le__(self, other: Number) -> Node:
        return apply("less_equal", self, other)

    def __gt__(self, other: Number) -> Node:
        return apply("less", other, self)

    def __ge__(self, other: Number) -> Node:
        return apply("less_equal", other, self)

    def __and__(self, other: Node) -> Node:
        return apply("both", self, other)

    def __or__(self, other: Node) -> Node:
        return apply("either", self, other)

    def __invert__(self) -> Node:
        return apply("negation", self)

    def __bool__(self) -> bool:
        raise TypeError(
            "an expression has no truth value while it is traced: choose with op.where,"
            " join conditions with & and |"
        )

    def __float__(self) -> float:
        raise TypeError("an expression is not a number while it is traced: use the functions of op")


class Constant(Node):
    """A number."""

    __slots__ = ("value",)
    __match_args__: ClassVar[tuple[str, ...]] = ("value",)
    value: float

    def __repr__(self) -> str:
        return repr(self.value)


class Symbol(Node):
    """A variable or a parameter, by its name."""

    __slots__ = ("name",)
    __match_args__: ClassVar[tuple[str, ...]] = ("name",)
    name: str

    def __repr__(self) -> str:
        return self.name


class Apply(Node):
    """An operation, by its name, with its arguments."""

    __slots__ = ("arguments", "operation")
    __match_args__: ClassVar[tuple[str, ...]] = ("operation", "arguments")
    operation: str
    arguments: tuple[Node, ...]

    def __repr__(self) -> str:
        return f"{self.operation}({', '.join(map(repr, self.arguments))})"


Number: TypeAlias = Node | float
"""A number in the definition of a kind."""


def constant(value: float) -> Constant:
    """Return the node of a number; 0.0 and -0.0 differ."""
    value = float(value)
    # Keyed by the bits: 0.0 == -0.0, and NaN does not equal itself.
    key = ("constant", struct.pack("d", value))
    node = _nodes.get(key)
    if node is None:
        node = Constant()
        node.value = value
        _nodes[key] = node
    assert isinstance(node, Constant)
    return node


def symbol(name: str) -> Symbol:
    """Return the node of a name."""
    key = ("symbol", name)
    node = _nodes.get(key)
    if node is None:
        node = Symbol()
        node.name = name
        _nodes[key] = node
    assert isinstance(node, Symbol)
    return node


def apply(operation: str, *arguments: Number) -> Apply:
    """Return the node of an operation applied to nodes or numbers."""
    nodes = tuple(as_node(argument) for argument in arguments)
    # The arguments live as long as the node, so their identities are unique.
    key = (operation, *map(id, nodes))
    node = _nodes.get(key)
    if node is None:
        node = Apply()
        node.operation, node.arguments = operation, nodes
        _nodes[key] = node
    assert isinstance(node, Apply)
    return node


def as_node(value: Number) -> Node:
    """Return a node unchanged and a number as a constant."""
    return value if isinstance(value, Node) else constant(value)


def children(node: Node) -> tuple[Node, ...]:
    """Return the arguments of a node; none for a constant or a symbol."""
    return node.arguments if isinstance(node, Apply) else ()


def postorder(*roots: Node) -> Iterator[Node]:
    """Yield every node once, arguments before their parents.

    Iterative: a sum of a thousand terms is a thousand nodes deep.
    """
    visited: set[Node] = set()
    for root in roots:
        stack: list[tuple[Node, bool]] = [(root, False)]
        while stack:
            node, ready = stack.pop()
            if node in visited:
                continue
            if ready:
                visited.add(node)
                yield node
            else:
                stack.append((node, True))
                stack += [
                    (child, False) for child in reversed(children(node)) if child not in visited
                ]


def fold(
    roots: Sequence[Node],
    values: Mapping[str, T],
    number: Callable[[float], T],
    applied: Callable[[Apply, list[T]], T],
) -> list[T]:
    """Return expressions in another arithmetic: values of symbols, of numbers, of operations."""
    results: dict[Node, T] = {}
    for node in postorder(*roots):
        if isinstance(node, Apply):
            results[node] = applied(node, [results[argument] for argument in node.arguments])
        elif isinstance(node, Constant):
            results[node] = number(node.value)
        else:
            assert isinstance(node, Symbol)
            results[node] = values[node.name]
    return [results[root] for root in roots]


def symbols(*roots: Node) -> tuple[str, ...]:
    """Return the names in an expression, in order of appearance."""
    return tuple(node.name for node in postorder(*roots) if isinstance(node, Symbol))


def replace(root: Node, values: Mapping[str, Number]) -> Node:
    """Return an expression with numbers or expressions substituted for symbols.

    Nothing is simplified: x + 0 is not x for x = -0.0.
    """

    def change(node: Node, new: Node) -> Node:
        if isinstance(node, Symbol) and node.name in values:
            return as_node(values[node.name])
        return new

    return rebuilt(root, change)


def rebuilt(root: Node, change: Callable[[Node, Node], Node]) -> Node:
    """Rebuild an expression from its leaves on.

    `change` takes each node, and its copy over arguments already changed; it returns the node in
    their place.
    """
    nodes: dict[Node, Node] = {}
    for node in postorder(root):
        new = node
        if isinstance(node, Apply):
            new = apply(node.operation, *(nodes[child] for child in node.arguments))
        nodes[node] = change(node, new)
    return nodes[root]


def substituted(root: Node, part: Node, instead: Node) -> Node:
    """Return an expression with one part replaced by another."""
    return rebuilt(root, lambda node, new: instead if node is part else new)


def argument_names(function: Callable[..., object]) -> tuple[str, ...]:
    """Return the names of the arguments of a definition, in order."""
    code = getattr(function, "__code__", None)
    if code is not None:  # faster than importing `inspect`
        names: tuple[str, ...] = code.co_varnames[: code.co_argcount]
        return names
    own: tuple[str, ...] | None = getattr(function, "argument_names", None)
    if own is not None:
        return own
    import inspect

    return tuple(inspect.signature(function).parameters)


def trace(function: Callable[..., Number], names: Iterable[str]) -> Node:
    """Run a definition on symbols, and return its expression.

    Parameters
    ----------
    function : callable
        Takes one node for each name; uses arithmetic, comparisons and the functions of
        :mod:`fuzzyarm.symbolic.op`.
    names : iterable of str
        Names of its arguments, in order.

    Returns
    -------
    Node
        The expression.

    Raises
    ------
    TypeError
        If the function needs the value of an expression, as ``if`` and :mod:`math` do.
    """
    result = function(*(symbol(name) for name in names))
    # A bool is an int in Python, but a definition that returns one has compared plain numbers.
    if isinstance(result, bool) or not isinstance(result, Node | int | float):
        raise TypeError(f"a definition returns an expression, not {type(result).__name__}")
    if isinstance(result, int | float) and math.isnan(result):
        raise TypeError("a definition returns an expression, not nan")
    return as_node(result)
