"""Values with their slopes: the automatic differentiation of the checker.

A :class:`Slope` bounds a value and its derivatives along some variables, over all values of these.
At a corner (``max``, ``|x|``) the derivative is the hull of both sides, which the mean value
theorem allows for a continuous function.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

from flint import arb, fmpq

from fuzzyarm.language.model.rulebase import RuleBase, Variable
from fuzzyarm.proof.check.numbers import (
    FUNCTIONS,
    ONE,
    ZERO,
    Number,
    SpanError,
    ball,
    exact,
    function,
    greatest,
    hull,
    is_point,
    least,
    square,
)
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.spans import Spans
from fuzzyarm.symbolic.nodes import Apply, Constant, Node, Symbol, constant, postorder, symbol
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.table import LookupTable


class Slope(NamedTuple):
    """Bounds of a value and of its derivatives; variables without one have 0.

    `ends` are exact bounds set by a limit: those of a ball are slightly wider.
    """

    value: Number
    along: Mapping[str, Number]
    ends: tuple[float, float] = (-math.inf, math.inf)

    def scaled(self, value: Number, factor: Number) -> Slope:
        """Return another value with the derivatives times a factor (chain rule)."""
        return Slope(value, {name: slope * factor for name, slope in self.along.items()})

    def joined(self, other: Slope, value: Number) -> Slope:
        """Return a value with the sum of both derivatives."""
        along = dict(self.along)
        for name, slope in other.along.items():
            along[name] = along[name] + slope if name in along else slope
        return Slope(value, along)


def _multiplied(a: Slope, b: Slope) -> Slope:
    value = a.value * b.value
    return a.scaled(value, b.value).joined(b.scaled(value, a.value), value)


def _inverse(a: Slope) -> Slope:
    if isinstance(a.value, Spans):  # NaN where one contains 0
        value: Number = ONE / a.value
    elif a.value > 0 or a.value < 0:
        # Bounded by its values at the ends: one ball around all would be wider.
        value = hull(ONE / least(a.value), ONE / greatest(a.value))
    else:
        raise SpanError("a division by an interval that contains 0")
    return a.scaled(value, -square(value))


def _function(name: str, a: Slope) -> Slope:
    value = function(name, a.value)
    if name == "absolute":
        if isinstance(a.value, Spans):
            return a.scaled(value, a.value.side())
        sides = [ONE] * (not a.value <= 0) + [-ONE] * (not a.value > 0)
        return a.scaled(value, hull(*sides))
    if not a.along:
        return Slope(value, {})
    slope = slopes_of([_derivative(name)], {"x": Slope(a.value, {})})[0]
    return a.scaled(value, slope.value)


@lru_cache(maxsize=64)
def _derivative(name: str) -> Node:
    """Return the derivative of a function of ``x``, from the operation's record."""
    partials = OPERATIONS[name].partials
    assert partials is not None
    (root,) = partials(symbol("x"))
    return constant(root) if isinstance(root, float | int) else root


def _powered(a: Slope, exponent: fmpq) -> Slope:
    """Return a power: products for a whole exponent, else by the exponential."""
    if exponent.q == 1 and 0 < exponent <= 16:
        result = a
        for _ in range(int(exponent.p) - 1):
            result = _multiplied(result, a)
        return result
    if exponent < 0:
        return _inverse(_powered(a, -exponent))
    if exponent == fmpq(1, 2):
        return _function("sqrt", a)
    if not exponent:
        return Slope(ONE, {})
    logarithm = _function("log", a)
    return _function("exp", logarithm.scaled(logarithm.value * exponent, exponent))


def _chosen(a: Slope, b: Slope, *, smaller: bool) -> Slope:
    """Return the smaller or larger of two."""
    first, second = (a, b) if smaller else (b, a)
    many = isinstance(a.value, Spans) or isinstance(b.value, Spans)
    if not many and first.value <= second.value:
        return a
    if not many and second.value <= first.value:
        return b
    one, other = ball(a.value), ball(b.value)
    if isinstance(other, Spans):
        one, other = other, one
    value = one.min(other) if smaller else one.max(other)
    # Either may be the extreme: its slopes are in the hull of both.
    names = {*a.along, *b.along}
    slopes = {n: hull(a.along.get(n, ZERO), b.along.get(n, ZERO)) for n in names}
    if isinstance(value, Spans):  # known for some sets
        low, high = Spans.of(first.value), Spans.of(second.value)
        for one, sure in ((a, low.high <= high.low), (b, high.high <= low.low)):
            slopes = {
                n: Spans.of(one.along.get(n, ZERO)).chosen(sure, x) for n, x in slopes.items()
            }
    return Slope(value, slopes)


def _is_less(a: Slope, b: Slope, *, or_equal: bool) -> bool:
    if a.value < b.value or (or_equal and a.value <= b.value):
        return True
    if b.value < a.value or (not or_equal and b.value <= a.value):
        return False
    raise SpanError("a choice that is open")


def _is_equal(a: Slope, b: Slope) -> bool:
    if is_point(a.value) and is_point(b.value):
        same = bool(a.value == b.value)
        if same or not (isinstance(a.value, Spans) or isinstance(b.value, Spans)):
            return same
    if a.value < b.value or b.value < a.value:
        return False
    raise SpanError("a comparison that is open")


_OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a.joined(b, a.value + b.value),
    "subtract": lambda a, b: a.joined(b.scaled(ZERO, -ONE), a.value - b.value),
    "negative": lambda a: a.scaled(-a.value, -ONE),
    "multiply": _multiplied,
    "divide": lambda a, b: _multiplied(a, _inverse(b)),
    "minimum": lambda a, b: _chosen(a, b, smaller=True),
    "maximum": lambda a, b: _chosen(a, b, smaller=False),
    "equal": _is_equal,
    "less": lambda a, b: _is_less(a, b, or_equal=False),
    "less_equal": lambda a, b: _is_less(a, b, or_equal=True),
}


def applied(operation: str, arguments: Sequence[Slope]) -> Any:
    """Apply an operation to values with slopes; a comparison gives a bool."""
    if any(isinstance(x, bool) for x in arguments):
        raise SpanError("a condition taken for a number")
    if operation in FUNCTIONS:
        return _function(operation, arguments[0])
    if operation == "power" and isinstance(arguments[1].value, fmpq) and not arguments[1].along:
        return _powered(arguments[0], arguments[1].value)
    if operation not in _OPERATIONS:
        raise SpanError(f"the checker does not read '{operation}'")
    return _OPERATIONS[operation](*arguments)


@lru_cache(maxsize=256)
def _steps(roots: tuple[Node, ...]) -> tuple[Node, ...]:
    return tuple(postorder(*roots))


def slopes_of(roots: Sequence[Node], values: Mapping[str, Slope]) -> list[Slope]:
    """Return expressions with their slopes."""
    results: dict[Node, Any] = {}
    for node in _steps(tuple(roots)):
        if isinstance(node, Constant):
            results[node] = Slope(exact(node.value), {})
        elif isinstance(node, Symbol):
            results[node] = values[node.name]
        else:
            assert isinstance(node, Apply)
            arguments = [results[argument] for argument in node.arguments]
            if node.operation == "where":
                results[node] = arguments[1] if arguments[0] else arguments[2]
            # x · x with one x: two independent factors would lose its sign.
            elif node.operation == "multiply" and node.arguments[0] is node.arguments[1]:
                a = arguments[0]
                results[node] = a.scaled(square(a.value), a.value * 2)
            else:
                results[node] = applied(node.operation, arguments)
    if any(isinstance(results[root], bool) for root in roots):
        raise SpanError("a condition taken for a number")
    return [results[root] for root in roots]


class SlopeNumbers:
    """Values with slopes, for a walk over the program."""

    def __init__(self, surfaces: RuleSurfaces) -> None:
        self.surfaces = surfaces

    def number(self, value: float) -> Slope:
        """Return a number of the program."""
        return Slope(exact(value), {})

    def apply(self, operation: str, arguments: list[Slope]) -> Any:
        """Apply an operation."""
        return applied(operation, arguments)

    def limit(self, x: Slope, low: float, high: float) -> Slope:
        """Return ``min(max(x, low), high)``."""
        ends = max(x.ends[0], low), min(x.ends[1], high)
        for operation, end in (("maximum", low), ("minimum", high)):
            if math.isfinite(end):
                x = applied(operation, [x, self.number(end)])
        return x._replace(ends=ends)

    def excess(self, value: Slope, x: Slope, low: float, high: float) -> Slope:
        """Return the change of x by a limit."""
        return value.joined(x.scaled(x.value, -ONE), value.value - x.value)

    def rules(self, rulebase: RuleBase, output: str, inputs: Mapping[str, Slope]) -> Slope:
        """Return a conclusion of a rule base."""
        surface = self.surfaces(rulebase, output)
        inputs = {v.name: self._into_range(inputs[v.name], v) for v in rulebase.inputs}
        moving = [name for name, x in inputs.items() if x.along]
        if not moving and all(isinstance(x.value, fmpq) for x in inputs.values()):
            return Slope(surface.value({n: (x.value, x.value) for n, x in inputs.items()}), {})
        value, slopes = surface.over({name: x.value for name, x in inputs.items()}, moving)
        result = Slope(value, {})
        # Chain rule: the slope of the output along each input, over the region, times its slopes.
        for name in moving:
            result = result.joined(inputs[name].scaled(value, slopes[name]), value)
        return result

    def _into_range(self, x: Slope, variable: Variable) -> Slope:
        """Return an input brought into its universe."""
        if variable.outside == "clamp":
            return self.limit(x, variable.low, variable.high)
        if variable.outside == "error" and not (
            arb(variable.low) <= x.value and x.value <= arb(variable.high)
        ):
            raise SpanError(f"'{variable.name}' may be outside its range, where there is no value")
        return x

    def table(self, table: LookupTable, inputs: Mapping[str, Slope]) -> Slope:
        """Refuse a table."""
        raise SpanError("a table where the rest is not rational")
