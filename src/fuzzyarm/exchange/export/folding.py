"""Whole numbers and conditions that are known when a program is made: calculated there."""

from __future__ import annotations

import ast

from fuzzyarm.exchange.export.typed_program import Quotient, Truth, Whole
from fuzzyarm.symbolic.nodes import Apply, Node, apply


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
    """Return whether both of two conditions hold, or one of them."""
    for here, there in ((a, b), (b, a)):
        if isinstance(here, Truth):
            return there if here.value == is_and else Truth(not is_and)
    return a & b if is_and else a | b
