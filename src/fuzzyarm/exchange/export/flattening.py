"""Functions for a language whose expressions only calculate: Structured Text.

A choice, a search in an array and the call of a function block are statements there, so they come
before the statement that needs them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from fuzzyarm.exchange.export.numbers import Kind
from fuzzyarm.exchange.export.typed_program import (
    INDEX,
    Called,
    Cast,
    Element,
    Function,
    Line,
    Program,
    Quotient,
    Repeat,
    Return,
    Search,
    Store,
    Truth,
    Variable,
    Walk,
    When,
    While,
    at,
    cast,
)
from fuzzyarm.symbolic.nodes import Apply, Constant, Node, apply, constant, postorder, symbol
from fuzzyarm.symbolic.printing import Assign, Choose, setting, statements, variables

__all__ = ["FIRED", "RESULT", "Call", "flattened", "result_of"]

FIRED, RESULT, FOUND = "a rule fires", "what is returned", "what was found"
"""Symbols: whether a rule fires, where there is no number for "none"; what is returned; what would
be, if one fires."""


class Call(NamedTuple):
    """Call the block of a function with some arguments; its result is a symbol from then on."""

    function: str
    arguments: tuple[Node, ...]


def flattened(function: Function, program: Program, is_block: Callable[[str], bool]) -> Function:
    """Return a function without choices, searches and calls of blocks inside of expressions."""
    flat = _Flattening(function, program, is_block)
    body = list(function.body)
    if function.may_be_silent:
        last = body.pop()
        value = last.value.value if isinstance(last.value, Cast) else last.value
        flat.variables[FOUND] = Variable("result", function.real)
        result = cast(symbol(FOUND), function.real, function.returned)
        body = [Assign(FIRED, Truth(True)), *body, Assign(FOUND, value),
                When(symbol(FIRED), (Assign(RESULT, result),))]  # fmt: skip
    return replace(function, body=flat.lines(body), variables=flat.variables)


def result_of(function: str) -> str:
    """Return the symbol of the result of a block that was called."""
    return f"result of {function}"


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
        """Return statements, each after those that its values need."""
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
        if isinstance(line, Walk):
            return line._replace(parts=tuple(map(self._value, line.parts)))
        assert isinstance(line, Repeat | While)
        return line._replace(body=tuple(self.lines(line.body)))

    def _set(self, name: str, value: Node, remark: str) -> list[Line]:
        value = self._inner(value)
        # A value that is cast is found first: a choice is not an expression.
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
        """Return a variable that is set to a value before."""
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
        made: dict[Node, Node] = {}
        for node in postorder(root):
            if isinstance(node, Apply):
                made[node] = apply(node.operation, *(made[part] for part in node.arguments))
            else:
                made[node] = self._leaf(node)
        return made[root]

    def _leaf(self, node: Node) -> Node:
        if isinstance(node, Search):
            return self._searched(node)
        if isinstance(node, Called):
            return self._called(node)
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
        """Return the count of a bisection that is done before."""
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
    """Return a statement that sets a number; where that is none, no rule fires."""
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
