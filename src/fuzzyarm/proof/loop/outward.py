"""Floats beside rationals, and bounds of expressions in rationals: rounded outward, or exact."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction

from fuzzyarm.proof.loop.affine import ZERO, NotAffineError
from fuzzyarm.symbolic.nodes import Apply, Node, fold

Ends = tuple[Fraction, Fraction]


def lower(x: float) -> float:
    """Return the float two steps below."""
    return math.nextafter(math.nextafter(x, -math.inf), -math.inf)


def higher(x: float) -> float:
    """Return the float two steps above."""
    return math.nextafter(math.nextafter(x, math.inf), math.inf)


def below(x: Fraction) -> float:
    """Return a float below a rational."""
    return lower(float(x))


def above(x: Fraction) -> float:
    """Return a float above a rational."""
    return higher(float(x))


def around(rest: Fraction, half: Fraction) -> tuple[float, float]:
    """Return an interval that contains rest ± half."""
    return end_of(rest - half, low=True), end_of(rest + half, low=False)


def end_of(x: Fraction, *, low: bool) -> float:
    """Return the number itself if it is a float, else one below (`low`) or above it."""
    near = float(x)
    if Fraction(near) == x:
        return near
    return lower(near) if low else higher(near)


def exact_bounds(
    root: Node,
    ranges: Mapping[str, Ends],
    wave: Callable[[str, Ends], Ends] | None = None,
) -> Ends:
    """Return bounds of an expression in rationals: exactly 0 for a factor 0.

    Sine and cosine are bounded by `wave`; without it only at 0.
    """

    def applied(node: Apply, arguments: list[Ends]) -> Ends:
        if wave is not None and node.operation in ("sin", "cos"):
            return wave(node.operation, arguments[0])
        if node.operation in ("less_equal", "where"):
            return _choice(*arguments)
        return _exact_operation(node.operation, arguments)

    return fold([root], ranges, lambda x: (Fraction(x), Fraction(x)), applied)[0]


def _choice(a: Ends, b: Ends, c: Ends | None = None) -> Ends:
    """Return whether a ≤ b, as 1 or 0; with c the choice of b for a = 1, c for 0."""
    if c is None:
        return Fraction(a[1] <= b[0]), Fraction(a[0] <= b[1])
    branches = [x for x, taken in ((b, a[1]), (c, 1 - a[0])) if taken]
    return min(x[0] for x in branches), max(x[1] for x in branches)


def _exact_operation(operation: str, arguments: list[Ends]) -> Ends:
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
