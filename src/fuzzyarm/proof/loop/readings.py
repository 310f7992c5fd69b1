"""Expressions over affine forms: the reading of each operation.

Smooth functions are those of :mod:`.zonotope`; powers and choices are rewritten in other
operations, or refused by name. A condition is an interval of 0 and 1, and an undecided choice
contains both of its branches.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.proof.loop.enclosure import EnclosureError, Intervals, square_root
from fuzzyarm.proof.loop.zonotope import FUNCTIONS, Forms, aligned, larger, smaller
from fuzzyarm.proof.map.laws import JUMPS
from fuzzyarm.symbolic.evaluation import specialise
from fuzzyarm.symbolic.nodes import (
    Apply,
    Constant,
    Node,
    Symbol,
    apply,
    constant,
    postorder,
    replace,
    symbols,
)


class UnenclosedError(FuzzyarmError, ValueError):
    """An expression has an operation without an enclosure; the message names it."""


# ── readable operations ──────────────────────────────────────────────────────────────


def readable(root: Node) -> Node:
    """Return an expression in the operations over forms."""
    nodes: dict[Node, Node] = {}
    for node in postorder(root):
        if not isinstance(node, Apply):
            nodes[node] = node
            continue
        arguments = tuple(nodes[argument] for argument in node.arguments)
        nodes[node] = _rewritten(node.operation, arguments)
    return nodes[root]


def may_jump(root: Node) -> bool:
    """Return whether an expression has a choice, condition or step, invisible to slopes."""
    return any(
        isinstance(node, Apply) and node.operation in JUMPS and bool(symbols(node))
        for node in postorder(root)
    )


def is_total(root: Node) -> bool:
    """Return whether an expression has only sums, products and quotients by numbers.

    Such an expression has a value everywhere, unlike ``0 * sqrt(x)``, whose slope is 0.
    """
    return all(
        not isinstance(node, Apply)
        or not symbols(node)
        or node.operation in ("add", "subtract", "multiply", "negative")
        or (node.operation == "divide" and not symbols(node.arguments[1]))
        for node in postorder(root)
    )


def takes_condition(root: Node) -> bool:
    """Return whether an undecided condition is used as a number, as in ``5 * (x > 0.1)``."""

    def is_condition(node: Node) -> bool:
        return isinstance(node, Apply) and node.operation in CONDITIONS and bool(symbols(node))

    return is_condition(root) or any(
        any(map(is_condition, node.arguments[node.operation == "where" :]))
        for node in postorder(root)
        if isinstance(node, Apply) and node.operation not in CONDITIONS
    )


def pruned(root: Node, numbers: Mapping[str, float]) -> Node:
    """Return an expression with numbers for some symbols, without the branches that these rule out.

    Arithmetic is not folded, since it would be rounded: numbers only decide choices.
    """
    nodes: dict[Node, Node] = {}
    root = replace(root, numbers)
    for node in postorder(root):
        if not isinstance(node, Apply):
            nodes[node] = node
            continue
        arguments = [nodes[argument] for argument in node.arguments]
        rewritten: Node = apply(node.operation, *arguments)
        if node.operation in CONDITIONS:
            known = specialise(rewritten, {})
            # An undecided comparison keeps its arguments, which identify a choice as a limit.
            if isinstance(known, Constant) or node.operation not in ("less", "less_equal"):
                rewritten = known
        elif node.operation == "where" and isinstance(arguments[0], Constant):
            rewritten = arguments[1] if arguments[0].value else arguments[2]
        elif node.operation in ("minimum", "maximum") or node.operation == "where":
            rewritten = _without_infinite(
                _choice(*arguments) if node.operation == "where" else rewritten
            )
        nodes[node] = rewritten
    return nodes[root]


def _without_infinite(node: Node) -> Node:
    """Return the other operand of a minimum or maximum with an infinite limit."""
    if isinstance(node, Apply) and node.operation in ("minimum", "maximum"):
        absent = math.inf if node.operation == "minimum" else -math.inf
        for branch, other in (node.arguments, node.arguments[::-1]):
            if isinstance(branch, Constant) and branch.value == absent:
                return other
    return node


def _rewritten(operation: str, arguments: tuple[Node, ...]) -> Node:
    if operation in _READINGS:
        return apply(operation, *arguments)
    if operation == "where":
        return _choice(*arguments)
    if operation == "power":
        return _power(*arguments)
    raise UnenclosedError(f"no enclosure is known for '{operation}'")


def _choice(condition: Node, then: Node, otherwise: Node) -> Node:
    """Return a choice; as a minimum or maximum if it is one."""
    if isinstance(condition, Apply) and condition.operation in ("less", "less_equal"):
        if condition.arguments == (then, otherwise):
            return apply("minimum", then, otherwise)
        if condition.arguments == (otherwise, then):
            return apply("maximum", then, otherwise)
    return apply("where", condition, then, otherwise)


def _power(base: Node, exponent: Node) -> Node:
    if not isinstance(exponent, Constant):
        raise UnenclosedError("no enclosure is known for 'power' with an exponent that changes")
    number = exponent.value
    if number == 0.5:
        return apply("sqrt", base)
    if number % 1.0 == 0.0 and 0.0 < abs(number) <= 16.0:
        result = base
        for _ in range(int(abs(number)) - 1):
            result = apply("multiply", result, base)
        return result if number > 0 else apply("divide", constant(1.0), result)
    return apply("exp", apply("multiply", exponent, apply("log", base)))


# ── conditions: intervals of 0 and 1 ─────────────────────────────────────────────────
#
# Over forms a condition may be undecided: possible is whatever is not excluded.


def _less(a: Forms, b: Forms) -> Intervals:
    gap = (a - b).bounds
    return Intervals((gap.high < 0.0).astype(float), (~(gap.low >= 0.0)).astype(float))


def is_less_equal(a: Forms, b: Forms) -> Intervals:
    """Return whether a form is at most another one, as a condition."""
    gap = (a - b).bounds
    return Intervals((gap.high <= 0.0).astype(float), (~(gap.low > 0.0)).astype(float))


def _equal(a: Forms, b: Forms) -> Intervals:
    one, two = a.bounds, b.bounds
    exactly = (a.radius == 0.0) & (b.radius == 0.0) & (a.centre == b.centre)
    apart = (one.high < two.low) | (two.high < one.low)
    return Intervals(exactly.astype(float), (~apart).astype(float))


CONDITIONS: dict[str, Callable[..., Intervals]] = {
    "less": _less,
    "less_equal": is_less_equal,
    "equal": _equal,
    "both": lambda a, b: Intervals(np.minimum(a.low, b.low), np.minimum(a.high, b.high)),
    "either": lambda a, b: Intervals(np.maximum(a.low, b.low), np.maximum(a.high, b.high)),
    "negation": lambda a: Intervals(1.0 - a.high, 1.0 - a.low),
}
"""Conditions over forms, or over other conditions."""


def choice_of(condition: Intervals, then: Forms, otherwise: Forms) -> Forms:
    """Return a choice; for an undecided condition the hull of both branches."""
    yes, no = condition.low > 0.0, condition.high < 1.0
    if yes.all():
        return then
    if no.all():
        return otherwise
    # Undecided: the mean of both branches ± half of their difference.
    half = (then - otherwise).scaled(0.5)
    middle = then - half
    both = Forms(middle.centre, middle.parts, middle.rest).within(half.bounds.size)
    then, otherwise = aligned(then, otherwise)
    then, both = aligned(then, both)
    return Forms(
        *(
            np.where(yes, a, np.where(no, b, c))
            for a, b, c in zip(*map(_arrays, (then, otherwise, both)), strict=True)
        )
    )


def _arrays(forms: Forms) -> tuple[Any, ...]:
    return forms.centre, forms.parts, forms.rest


def _absolute(x: Forms) -> Forms:
    return larger(x, -x)


def _root(x: Forms) -> Forms:
    """Return the root of a positive form."""
    if np.any(x.bounds.low <= 0.0):
        raise EnclosureError("the root of an interval that contains 0 or negative numbers")
    return x.function("sqrt")


def _steep_root(x: Forms) -> Forms:
    """Return the root of a nonnegative quantity, even if its form contains negative numbers.

    √x - a x rises from 0 to its maximum 1/(4a) and falls: the minimum is at 0 or at the end.
    """
    bounds = x.bounds
    if (bounds.low > 0.0).all():
        return x.function("sqrt")
    # Any slope a > 0 is sound; this one makes the ends equal: √h - a h = 0.
    high = np.maximum(bounds.high, 1e-290)
    steep = Intervals.at(1.0 / np.sqrt(high))
    end = square_root(Intervals.at(high)) - steep * Intervals.at(high)
    top = 0.25 / steep
    return x.scaled(steep.low) + Forms.between(np.minimum(end.low, 0.0), top.high)


def _is_never_negative(node: Node, value: Callable[[Node], Any]) -> bool:
    """Return whether an expression is nonnegative for all values of its symbols."""
    if isinstance(node, Constant):
        return node.value >= 0.0
    if isinstance(node, Symbol):
        return bool(np.all(value(node).bounds.low >= 0.0))
    assert isinstance(node, Apply)
    arguments = node.arguments
    if node.operation == "maximum":
        return any(_is_never_negative(argument, value) for argument in arguments)
    if node.operation == "multiply" and arguments[0] is arguments[1]:
        return True
    if node.operation in ("multiply", "divide", "add", "minimum"):
        return all(_is_never_negative(argument, value) for argument in arguments)
    return node.operation in ("absolute", "exp", "sqrt")


_READINGS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": lambda a, b: a / b,
    "negative": lambda a: -a,
    **{name: partial(Forms.function, name=name) for name in FUNCTIONS},
    "sqrt": _root,
    "absolute": _absolute,
    "minimum": smaller,
    "maximum": larger,
    "where": choice_of,
    **CONDITIONS,
}
"""Each operation over forms."""


_WITH_NUMBERS: dict[tuple[str, bool], Callable[[Forms, float], Forms]] = {
    ("add", True): lambda x, number: x + number,
    ("add", False): lambda x, number: x + number,
    ("subtract", True): lambda x, number: x + (-number),
    ("subtract", False): lambda x, number: -x + number,
    ("multiply", True): lambda x, number: x.scaled(number),
    ("multiply", False): lambda x, number: x.scaled(number),
    ("divide", True): lambda x, number: x / number,
}
"""The same with a number, by whether it is the second argument."""


def read(roots: Sequence[Node], values: Mapping[str, Forms]) -> list[Forms]:
    """Return expressions, readable ones (:func:`readable`), over forms of their symbols."""
    results: dict[Node, Any] = {}
    shape = next(iter(values.values())).shape
    for node in postorder(*roots):
        if isinstance(node, Constant):
            results[node] = node.value
        elif isinstance(node, Symbol):
            results[node] = values[node.name]
        else:
            assert isinstance(node, Apply)
            arguments = [results[argument] for argument in node.arguments]
            results[node] = applied(node, arguments, shape, results.__getitem__)
    return [as_forms(results[root], shape) for root in roots]


def as_forms(value: Any, shape: tuple[int, ...]) -> Any:
    """Return a number as forms; anything else unchanged."""
    return Forms.at(np.full(shape, value)) if isinstance(value, float) else value


def applied(
    node: Apply, arguments: list[Any], shape: tuple[int, ...], value: Callable[[Node], Any]
) -> Any:
    """Apply an operation; products and sums with a number are cheaper."""
    if node.operation == "sqrt" and _is_never_negative(node.arguments[0], value):
        return _steep_root(as_forms(arguments[0], shape))
    numbers = [isinstance(argument, float) for argument in arguments]
    if numbers in ([True, False], [False, True]):
        variable, number = arguments if numbers[1] else reversed(arguments)
        by_number = _WITH_NUMBERS.get((node.operation, numbers[1]))
        if by_number is not None:
            return by_number(variable, number)
    return _READINGS[node.operation](*(as_forms(argument, shape) for argument in arguments))
