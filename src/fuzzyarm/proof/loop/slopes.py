"""Values with their slopes, as intervals of rationals: how the checker differentiates.

A :class:`Slope` is where a value is, and where its derivatives along some variables are, while
these are anywhere in their intervals. That of a corner (``max``, ``|x|``) is the hull of both
sides, which the mean value theorem allows for what is continuous. Of the plant's equations, of the
controller's program, and of rule bases by their pieces.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

from fuzzyarm.language.model.rulebase import RuleBase, Variable
from fuzzyarm.proof.loop.rule_pieces import RulePieces
from fuzzyarm.proof.loop.spans import (
    FUNCTIONS,
    RationalInterval,
    SpanError,
    exactly,
    function,
    hull,
)
from fuzzyarm.symbolic.nodes import Apply, Constant, Node, Symbol, constant, postorder, symbol
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.table import LookupTable

__all__ = ["Slope", "SlopeNumbers", "applied", "slopes_of"]

ZERO = exactly(Fraction(0))
ONE = exactly(Fraction(1))


class Slope(NamedTuple):
    """Where a value is, and where its derivatives are; variables without one have 0."""

    value: RationalInterval
    along: Mapping[str, RationalInterval]

    def scaled(self, value: RationalInterval, factor: RationalInterval) -> Slope:
        """Return another value, of which this one's derivatives count by a factor."""
        return Slope(value, {name: slope.times(factor) for name, slope in self.along.items()})

    def joined(self, other: Slope, value: RationalInterval) -> Slope:
        """Return a value with the sums of the derivatives of both."""
        along = dict(self.along)
        for name, slope in other.along.items():
            along[name] = along[name].plus(slope) if name in along else slope
        return Slope(value, along)


def _multiplied(a: Slope, b: Slope) -> Slope:
    value = a.value.times(b.value)
    return a.scaled(value, b.value).joined(b.scaled(value, a.value), value)


def _inverse(a: Slope) -> Slope:
    value = ONE.over(a.value)
    return a.scaled(value, ZERO.minus(value.times(value)))


def _function(name: str, a: Slope) -> Slope:
    value = function(name, a.value)
    if name == "absolute":
        sides = [ONE] * (a.value.high > 0) + [exactly(Fraction(-1))] * (a.value.low <= 0)
        return a.scaled(value, hull(*sides))
    if not a.along:
        return Slope(value, {})
    slope = slopes_of([_derivative(name)], {"x": Slope(a.value, {})})[0]
    return a.scaled(value, slope.value)


@cache
def _derivative(name: str) -> Node:
    """Return the derivative of a function of ``x``, from the record of the operation."""
    partials = OPERATIONS[name].partials
    assert partials is not None
    (root,) = partials(symbol("x"))
    return constant(root) if isinstance(root, float | int) else root


def _powered(a: Slope, exponent: Fraction) -> Slope:
    """Return a power: of products where it is whole, else of the exponential."""
    if exponent.denominator == 1 and 0 < exponent <= 16:
        result = a
        for _ in range(int(exponent) - 1):
            result = _multiplied(result, a)
        return result
    if exponent < 0:
        return _inverse(_powered(a, -exponent))
    if exponent == Fraction(1, 2):
        return _function("sqrt", a)
    if not exponent:
        return Slope(ONE, {})
    by = exactly(exponent)
    logarithm = _function("log", a)
    return _function("exp", logarithm.scaled(logarithm.value.times(by), by))


def _chosen(a: Slope, b: Slope, *, smaller: bool) -> Slope:
    """Return the smaller or the larger of two."""
    first, second = (a, b) if smaller else (b, a)
    if first.value.high <= second.value.low:
        return a
    if second.value.high <= first.value.low:
        return b
    pick = min if smaller else max
    value = RationalInterval(pick(a.value.low, b.value.low), pick(a.value.high, b.value.high))
    # Either may be the one: its slopes are among the hull of both.
    names = {*a.along, *b.along}
    return Slope(value, {n: hull(a.along.get(n, ZERO), b.along.get(n, ZERO)) for n in names})


def _is_less(a: Slope, b: Slope, *, or_equal: bool) -> bool:
    if a.value.high < b.value.low or (or_equal and a.value.high <= b.value.low):
        return True
    if b.value.high < a.value.low or (not or_equal and b.value.high <= a.value.low):
        return False
    raise SpanError("a choice that is open")


def _is_equal(a: Slope, b: Slope) -> bool:
    if a.value.is_point and b.value.is_point:
        return a.value == b.value
    if a.value.high < b.value.low or b.value.high < a.value.low:
        return False
    raise SpanError("a comparison that is open")


def _negative(a: Slope) -> Slope:
    return a.scaled(ZERO.minus(a.value), exactly(Fraction(-1)))


_OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a.joined(b, a.value.plus(b.value)),
    "subtract": lambda a, b: a.joined(_negative(b), a.value.minus(b.value)),
    "negative": _negative,
    "multiply": _multiplied,
    "divide": lambda a, b: _multiplied(a, _inverse(b)),
    "minimum": lambda a, b: _chosen(a, b, smaller=True),
    "maximum": lambda a, b: _chosen(a, b, smaller=False),
    "equal": _is_equal,
    "less": lambda a, b: _is_less(a, b, or_equal=False),
    "less_equal": lambda a, b: _is_less(a, b, or_equal=True),
}


def applied(operation: str, arguments: Sequence[Slope]) -> Any:
    """Return an operation of values with slopes; of a comparison a bool."""
    if operation in FUNCTIONS:
        return _function(operation, arguments[0])
    if operation == "power" and arguments[1].value.is_point and not arguments[1].along:
        return _powered(arguments[0], arguments[1].value.low)
    if operation not in _OPERATIONS:
        raise SpanError(f"the checker does not read '{operation}'")
    return _OPERATIONS[operation](*arguments)


def slopes_of(roots: Sequence[Node], values: Mapping[str, Slope]) -> list[Slope]:
    """Return expressions with their slopes."""
    results: dict[Node, Any] = {}
    for node in postorder(*roots):
        if isinstance(node, Constant):
            results[node] = Slope(exactly(node.value), {})
        elif isinstance(node, Symbol):
            results[node] = values[node.name]
        else:
            assert isinstance(node, Apply)
            arguments = [results[argument] for argument in node.arguments]
            if node.operation == "where":
                results[node] = arguments[1] if arguments[0] else arguments[2]
            # x · x of one x: intervals would take two independent factors and lose its sign.
            elif node.operation == "multiply" and node.arguments[0] is node.arguments[1]:
                results[node] = _squared(arguments[0])
            else:
                results[node] = applied(node.operation, arguments)
    return [results[root] for root in roots]


def _squared(a: Slope) -> Slope:
    size = function("absolute", a.value)
    return a.scaled(size.times(size), a.value.times(exactly(Fraction(2))))


class SlopeNumbers:
    """Values with slopes, for a walk over the program.

    Parameters
    ----------
    pieces : callable
        The pieces of a rule base's output.
    """

    def __init__(self, pieces: Callable[[RuleBase, str], RulePieces]) -> None:
        self.pieces = pieces

    def number(self, value: float) -> Slope:
        """Return a number of the program."""
        return Slope(exactly(value), {})

    def apply(self, operation: str, arguments: list[Slope]) -> Any:
        """Return an operation."""
        return applied(operation, arguments)

    def limit(self, x: Slope, low: float, high: float) -> Slope:
        """Return ``min(max(x, low), high)``."""
        for operation, end in (("maximum", low), ("minimum", high)):
            if abs(end) < float("inf"):
                x = applied(operation, [x, self.number(end)])
        return x

    def rules(self, sheet: RuleBase, output: str, inputs: Mapping[str, Slope]) -> Slope:
        """Return what a rule base concludes."""
        pieces = self.pieces(sheet, output)
        inputs = {
            variable.name: self._brought(inputs[variable.name], variable)
            for variable in sheet.inputs
        }
        region = {name: (x.value.low, x.value.high) for name, x in inputs.items()}
        result = Slope(pieces.value(region), {})
        # Chain rule: the slope of the output along each input, over the region, times its slopes.
        for name, x in inputs.items():
            if x.along:
                result = result.joined(x.scaled(x.value, pieces.slope(region, name)), result.value)
        return result

    def _brought(self, x: Slope, variable: Variable) -> Slope:
        """Return an input as a rule base takes it."""
        if variable.outside == "clamp":
            return self.limit(x, variable.low, variable.high)
        inside = variable.low <= x.value.low and x.value.high <= variable.high
        if variable.outside == "error" and not inside:
            raise SpanError(f"'{variable.name}' may be outside its range, where there is no value")
        return x

    def table(self, sheet: LookupTable, inputs: Mapping[str, Slope]) -> Slope:
        """Refuse a table."""
        raise SpanError("a table where the rest is not rational")
