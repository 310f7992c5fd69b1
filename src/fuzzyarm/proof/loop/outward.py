"""Floats beside rationals, and bounds of expressions in rationals: rounded outward, or exact."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction

from fuzzyarm.proof.loop.affine import ZERO, NotAffineError
from fuzzyarm.symbolic.nodes import Apply, Constant, Node, Symbol, postorder


def lower(x: float) -> float:
    """Return a float two steps below."""
    return math.nextafter(math.nextafter(x, -math.inf), -math.inf)


def higher(x: float) -> float:
    """Return a float two steps above."""
    return math.nextafter(math.nextafter(x, math.inf), math.inf)


def below(x: Fraction) -> float:
    """Return a float that is less."""
    return lower(float(x))


def above(x: Fraction) -> float:
    """Return a float that is greater."""
    return higher(float(x))


def around(rest: Fraction, half: Fraction) -> tuple[float, float]:
    """Return an interval that holds rest ± half."""
    return end_of(rest - half, low=True), end_of(rest + half, low=False)


def end_of(x: Fraction, *, low: bool) -> float:
    """Return the number itself where it is a float, else one below (`low`) or above it."""
    near = float(x)
    if Fraction(near) == x:
        return near
    return lower(near) if low else higher(near)


def exact_bounds(
    root: Node, ranges: Mapping[str, tuple[Fraction, Fraction]]
) -> tuple[Fraction, Fraction]:
    """Return bounds of an expression in rationals: exactly 0 where that is a factor."""
    bounds: dict[Node, tuple[Fraction, Fraction]] = {}
    for node in postorder(root):
        if isinstance(node, Constant):
            bounds[node] = (Fraction(node.value), Fraction(node.value))
        elif isinstance(node, Symbol):
            bounds[node] = ranges[node.name]
        else:
            assert isinstance(node, Apply)
            bounds[node] = _exact_operation(node.operation, [bounds[a] for a in node.arguments])
    return bounds[root]


def _exact_operation(
    operation: str, arguments: list[tuple[Fraction, Fraction]]
) -> tuple[Fraction, Fraction]:
    a = arguments[0]
    b = arguments[1] if len(arguments) > 1 else a
    if operation == "add":
        return a[0] + b[0], a[1] + b[1]
    if operation == "subtract":
        return a[0] - b[1], a[1] - b[0]
    if operation == "negative":
        return -a[1], -a[0]
    if operation in ("multiply", "divide"):
        if operation == "divide":
            if b[0] <= 0 <= b[1]:
                raise NotAffineError("a division by a parameter that may be 0")
            b = (1 / b[1], 1 / b[0])
        products = [x * y for x in a for y in b]
        return min(products), max(products)
    if operation in ("minimum", "maximum") and len(arguments) == 2:
        pick = min if operation == "minimum" else max
        return pick(a[0], b[0]), pick(a[1], b[1])
    zero = {"sin": 0, "cos": 1, "tan": 0, "sqrt": 0}
    if operation in zero and a == (ZERO, ZERO):
        return (Fraction(zero[operation]),) * 2
    raise NotAffineError(f"'{operation}' of a parameter at rest")
