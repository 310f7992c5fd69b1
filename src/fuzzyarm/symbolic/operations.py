"""The table of operations: one record defines an operation for every reader.

Floats, arrays, source text in four languages, derivatives and bounds are all read from here. A new
operation is one record.

Conventions
-----------
The functions over floats never raise: where arithmetic is undefined they give NaN or an infinity,
as arrays and compiled code do. ``minimum`` and ``maximum`` are ``b if b < a else a`` (``b > a``)
in every language: of two equal arguments (0.0 and -0.0 are equal) they return the first, also if
one of them is NaN.

To add a reading of expressions (another language, another kind of number), write a walk as in
:mod:`.evaluation`, or a ``Language`` of :mod:`.printing`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import wraps
from typing import Any, NamedTuple

from fuzzyarm.symbolic.nodes import Node, Number, apply, constant


class Interval(NamedTuple):
    """All numbers from `low` to `high`, both included; never NaN."""

    low: float
    high: float


EVERYTHING = Interval(-math.inf, math.inf)
TRUE, FALSE, UNKNOWN = Interval(1.0, 1.0), Interval(0.0, 0.0), Interval(0.0, 1.0)
"""Bounds of a condition: true everywhere, nowhere, or in part."""

Bounds = Callable[..., Interval]
Partials = Callable[..., tuple[Number, ...]]


class Operation(NamedTuple):
    """An operation, with one field for each reader.

    Attributes
    ----------
    name : str
        Its name in the graph.
    arity : int
        Number of arguments.
    scalar : callable
        Value over floats; never raises.
    array : str
        Function of NumPy; empty if `scalar` serves arrays, too (``where``).
    python, c, st, js : str
        Source text with ``{0}`` and so on for the arguments. Empty if the language lacks it; for
        JavaScript empty means the text of C. In C a name after ``@`` takes the suffix ``f`` in
        single precision.
    binds : int
        Precedence of its text; 9 for a call.
    partials : callable or None
        Partial derivatives by each argument, as nodes. None for conditions and steps, whose
        derivative is 0 almost everywhere.
    bounds : callable
        Enclosure of the values for arguments in given intervals.
    exact : bool
        Whether the value is one of the arguments, or exact: no rounding.
    sort : str
        Class in operation counts of programs.
    """

    name: str
    arity: int
    scalar: Callable[..., Any]
    array: str
    python: str
    c: str
    st: str
    bounds: Bounds
    partials: Partials | None = None
    binds: int = 9
    exact: bool = False
    sort: str = "functions"
    js: str = ""

    @property
    def is_condition(self) -> bool:
        """Whether its value is true or false."""
        return self.sort in {"comparisons", "logic"}

    @property
    def of_library(self) -> bool:
        """Whether its last bit depends on the C library, and so may differ from NumPy's."""
        return self.sort == "functions" and not self.exact and self.name not in _CORRECTLY_ROUNDED


_CORRECTLY_ROUNDED = frozenset({"sqrt", "remainder"})
"""Functions with the same bits on every machine, being correctly rounded."""


# ── floats ───────────────────────────────────────────────────────────────────────────
#
# NaN or infinity in place of exceptions. The text of these functions is part of MicroPython
# exports, docstrings included.


def _divide(a: float, b: float) -> float:
    try:
        return a / b
    except ZeroDivisionError:
        if a == 0.0 or math.isnan(a):
            return math.nan
        return math.copysign(math.inf, a) * math.copysign(1.0, b)


@wraps(math.pow)
def _power(base: float, exponent: float) -> float:
    try:
        return math.pow(base, exponent)
    except OverflowError:
        odd = exponent % 2.0 == 1.0
    except ValueError:  # 0 to a negative power, or a fractional power of a negative number
        if base != 0.0:
            return math.nan
        odd = exponent % 2.0 == 1.0
    return math.copysign(math.inf, base) if odd else math.inf


def _quiet(function: Callable[..., float]) -> Callable[..., float]:
    @wraps(function)
    def quiet(*arguments: float) -> float:
        try:
            return float(function(*arguments))
        except OverflowError:
            return math.inf
        except ValueError:
            return math.nan

    return quiet


def _sinh(x: float) -> float:
    return math.copysign(_quiet(math.sinh)(abs(x)), x)


def _logarithm(function: Callable[[float], float]) -> Callable[[float], float]:
    @wraps(function)
    def logarithm(x: float) -> float:
        if x == 0.0:
            return -math.inf
        return function(x) if x > 0.0 else math.nan

    return logarithm


def _whole(function: Callable[[float], float]) -> Callable[[float], float]:
    """Return a rounding that preserves infinities, NaN and the sign of zero."""

    def rounded(x: float) -> float:
        return math.copysign(float(function(x)), x) if math.isfinite(x) else x

    return rounded


def _where(condition: bool, then: float, otherwise: float) -> float:
    return then if condition else otherwise


# ── bounds ───────────────────────────────────────────────────────────────────────────


def _around(values: list[float]) -> Interval:
    if any(math.isnan(value) for value in values):
        return EVERYTHING
    return Interval(min(values), max(values))


def _product(a: Interval, b: Interval) -> Interval:
    # 0 times an infinite end is 0 here: the end is a bound, not a value.
    return _around([0.0 if 0.0 in (x, y) else x * y for x in a for y in b])


def _quotient(a: Interval, b: Interval) -> Interval:
    if b.low <= 0.0 <= b.high:
        return EVERYTHING
    return _around([_divide(x, y) for x in a for y in b])


def _power_bounds(a: Interval, b: Interval) -> Interval:
    if a.low >= 0.0 and (a.low > 0.0 or b.low >= 0.0):
        return _around(
            [_power(x, y) for x in a for y in b] + ([1.0] if a.low <= 1 <= a.high else [])
        )
    if b.low == b.high and b.low >= 0.0 and b.low % 1.0 == 0.0:
        ends = [_power(x, b.low) for x in a]
        return _around([*ends, 0.0] if a.low <= 0.0 <= a.high else ends)
    return EVERYTHING


def _rising(function: Callable[[float], float], low: float = -math.inf) -> Bounds:
    """Return the bounds of a non-decreasing function defined from `low` on."""

    def bounds(a: Interval) -> Interval:
        # Outside the domain every value is NaN, so any interval encloses them.
        return _around([function(max(a.low, low)), function(max(a.high, low))])

    return bounds


def _within(function: Callable[[float], float], low: float, high: float) -> Bounds:
    """Return the bounds of a monotone function defined from `low` to `high`."""

    def bounds(a: Interval) -> Interval:
        return _around([function(min(max(x, low), high)) for x in a])

    return bounds


def _wave(function: Callable[[float], float], top: float) -> Bounds:
    """Return the bounds of sin or cos: 1 at `top` + 2kπ, -1 half-way."""

    def bounds(a: Interval) -> Interval:
        if not (math.isfinite(a.low) and math.isfinite(a.high)) or a.high - a.low >= 2 * math.pi:
            return Interval(-1.0, 1.0)
        values = [function(a.low), function(a.high)]
        slack = 1e-9 * (1.0 + abs(a.low) + abs(a.high))  # an extremum at the very edge counts
        for turn, value in ((top, 1.0), (top + math.pi, -1.0)):
            nearest = math.ceil((a.low - slack - turn) / (2 * math.pi))
            if turn + 2 * math.pi * nearest <= a.high + slack:
                values.append(value)
        return _around(values)

    return bounds


def _even(function: Callable[[float], float]) -> Bounds:
    """Return the bounds of an even function that increases with |x|."""

    def bounds(a: Interval) -> Interval:
        values = [function(a.low), function(a.high)]
        return _around([*values, function(0.0)] if a.low <= 0.0 <= a.high else values)

    return bounds


def _tangent_bounds(a: Interval) -> Interval:
    middle = math.floor(a.low / math.pi + 0.5) if math.isfinite(a.low) else math.nan
    inside = a.high < (middle + 0.5) * math.pi - 1e-9 and a.low > (middle - 0.5) * math.pi + 1e-9
    return _around([math.tan(a.low), math.tan(a.high)]) if inside else EVERYTHING


def _remainder_bounds(a: Interval, b: Interval) -> Interval:
    most = max(abs(b.low), abs(b.high))
    low = 0.0 if a.low >= 0.0 else max(-most, a.low)
    return Interval(low, 0.0 if a.high <= 0.0 else min(most, a.high))


def _less_bounds(a: Interval, b: Interval) -> Interval:
    return TRUE if a.high < b.low else FALSE if a.low >= b.high else UNKNOWN


def _less_equal_bounds(a: Interval, b: Interval) -> Interval:
    return TRUE if a.high <= b.low else FALSE if a.low > b.high else UNKNOWN


def _equal_bounds(a: Interval, b: Interval) -> Interval:
    if a.high < b.low or b.high < a.low:
        return FALSE
    return TRUE if a.low == a.high == b.low == b.high else UNKNOWN


def _where_bounds(condition: Interval, then: Interval, otherwise: Interval) -> Interval:
    if condition == TRUE:
        return then
    if condition == FALSE:
        return otherwise
    return Interval(min(then.low, otherwise.low), max(then.high, otherwise.high))


# ── derivatives ──────────────────────────────────────────────────────────────────────


def _where_node(condition: Node, then: Number, otherwise: Number) -> Node:
    return apply("where", condition, then, otherwise)


def _call(name: str, *arguments: Number) -> Node:
    return apply(name, *arguments)


def _power_partials(a: Node, b: Node) -> tuple[Number, ...]:
    by_base = b * _call("power", a, b - 1.0)
    # ∂aᵇ/∂b = aᵇ ln a; 0 at a = 0, where the logarithm is infinite.
    by_exponent = _where_node(a > 0.0, _call("power", a, b) * _call("log", a), 0.0)
    return by_base, by_exponent


def _atan2_partials(y: Node, x: Node) -> tuple[Number, ...]:
    square = x * x + y * y
    return x / square, -y / square


_ZERO, _ONE = constant(0.0), constant(1.0)


def _of_one(rule: Callable[[Node], Number]) -> Partials:
    """Return the partial derivatives of a function of one argument."""
    return lambda a: (rule(a),)


# ── the table ────────────────────────────────────────────────────────────────────────

_SUMS, _PRODUCTS, _QUOTIENTS = "additions and subtractions", "multiplications", "divisions"
_COMPARISONS = "comparisons"


def _function(
    name: str,
    scalar: Callable[..., float],
    words: tuple[str, str, str, str],
    bounds: Bounds,
    partials: Partials | None = None,
    *,
    arity: int = 1,
    exact: bool = False,
    js: str = "",
) -> Operation:
    """Return an operation printed as a call, named by `words` in NumPy, Python, C and ST."""
    array, python, c, st = words
    holes = ", ".join(f"{{{i}}}" for i in range(arity))

    def call(word: str) -> str:
        return f"{word}({holes})" if word else ""

    texts = call(python), call(f"@{c}"), call(st)
    text_js = call(js or f"Math.{c}")
    return Operation(name, arity, scalar, array, *texts, bounds, partials, exact=exact, js=text_js)


_TABLE = (
    # Arithmetic. Precedence as in each language: or 1, and 2, not 3, < 4, + 5, × 6, - 7.
    Operation(
        "add", 2, lambda a, b: a + b, "add", "{0} + {1}", "{0} + {1}", "{0} + {1}",
        lambda a, b: _around([a.low + b.low, a.high + b.high]),
        lambda a, b: (_ONE, _ONE), 5, sort=_SUMS,
    ),
    Operation(
        "subtract", 2, lambda a, b: a - b, "subtract", "{0} - {1}", "{0} - {1}", "{0} - {1}",
        lambda a, b: _around([a.low - b.high, a.high - b.low]),
        lambda a, b: (_ONE, constant(-1.0)), 5, sort=_SUMS,
    ),
    Operation(
        "multiply", 2, lambda a, b: a * b, "multiply", "{0} * {1}", "{0} * {1}", "{0} * {1}",
        _product, lambda a, b: (b, a), 6, sort=_PRODUCTS,
    ),
    Operation(
        "divide", 2, _divide, "divide", "{0} / {1}", "{0} / {1}", "{0} / {1}",
        _quotient, lambda a, b: (1.0 / b, -a / (b * b)), 6, sort=_QUOTIENTS,
    ),
    Operation(
        "negative", 1, lambda a: -a, "negative", "-{0}", "-{0}", "-{0}",
        lambda a: Interval(-a.high, -a.low), _of_one(lambda a: constant(-1.0)), 7,
        exact=True, sort=_SUMS,
    ),
    _function(
        "remainder", _quiet(math.fmod), ("fmod", "fmod", "fmod", ""), _remainder_bounds,
        lambda a, b: (_ONE, -_call("truncate", a / b)), arity=2, js="remainder",
    ),
    _function(
        "power", _power, ("power", "pow", "pow", "EXPT"), _power_bounds, _power_partials, arity=2,
        js="power",
    ),
    Operation(
        "minimum", 2, min, "",
        "min({0}, {1})", "minimum({0}, {1})", "minimum({0}, {1})",
        lambda a, b: Interval(min(a.low, b.low), min(a.high, b.high)),
        lambda a, b: (_where_node(b < a, 0.0, 1.0), _where_node(b < a, 1.0, 0.0)),
        exact=True, sort=_COMPARISONS + " of two", js="min({0}, {1})",
    ),
    Operation(
        "maximum", 2, max, "",
        "max({0}, {1})", "maximum({0}, {1})", "maximum({0}, {1})",
        lambda a, b: Interval(max(a.low, b.low), max(a.high, b.high)),
        lambda a, b: (_where_node(b > a, 0.0, 1.0), _where_node(b > a, 1.0, 0.0)),
        exact=True, sort=_COMPARISONS + " of two", js="max({0}, {1})",
    ),
    # Functions.
    _function(
        "absolute", abs, ("abs", "abs", "fabs", "ABS"), _even(abs),
        _of_one(lambda a: _where_node(a < 0.0, -1.0, 1.0)), exact=True, js="Math.abs",
    ),
    _function(
        "sqrt", _quiet(math.sqrt), ("sqrt", "sqrt", "sqrt", "SQRT"), _rising(math.sqrt, 0.0),
        _of_one(lambda a: 0.5 / _call("sqrt", a)),
    ),
    _function(
        "exp", _quiet(math.exp), ("exp", "exp", "exp", "EXP"), _rising(_quiet(math.exp)),
        _of_one(lambda a: _call("exp", a)),
    ),
    _function(
        "log", _logarithm(math.log), ("log", "log", "log", "LN"),
        _rising(_logarithm(math.log), 0.0), _of_one(lambda a: 1.0 / a),
    ),
    _function(
        "log10", _logarithm(math.log10), ("log10", "log10", "log10", "LOG"),
        _rising(_logarithm(math.log10), 0.0), _of_one(lambda a: 1.0 / (math.log(10.0) * a)),
    ),
    _function(
        "sin", _quiet(math.sin), ("sin", "sin", "sin", "SIN"), _wave(math.sin, 0.5 * math.pi),
        _of_one(lambda a: _call("cos", a)),
    ),
    _function(
        "cos", _quiet(math.cos), ("cos", "cos", "cos", "COS"), _wave(math.cos, 0.0),
        _of_one(lambda a: -_call("sin", a)),
    ),
    _function(
        "tan", _quiet(math.tan), ("tan", "tan", "tan", "TAN"), _tangent_bounds,
        _of_one(lambda a: 1.0 + _call("tan", a) ** 2),
    ),
    _function(
        "asin", _quiet(math.asin), ("arcsin", "asin", "asin", "ASIN"),
        _within(math.asin, -1.0, 1.0),
        _of_one(lambda a: 1.0 / _call("sqrt", 1.0 - a * a)),
    ),
    _function(
        "acos", _quiet(math.acos), ("arccos", "acos", "acos", "ACOS"),
        _within(math.acos, -1.0, 1.0),
        _of_one(lambda a: -1.0 / _call("sqrt", 1.0 - a * a)),
    ),
    _function(
        "atan", math.atan, ("arctan", "atan", "atan", "ATAN"), _rising(math.atan),
        _of_one(lambda a: 1.0 / (1.0 + a * a)),
    ),
    _function(
        "atan2", math.atan2, ("arctan2", "atan2", "atan2", ""),
        lambda y, x: Interval(-math.pi, math.pi), _atan2_partials, arity=2,
    ),
    _function(
        "sinh", _sinh, ("sinh", "sinh", "sinh", ""), _rising(_sinh),
        _of_one(lambda a: _call("cosh", a)),
    ),
    _function(
        "cosh", _quiet(math.cosh), ("cosh", "cosh", "cosh", ""), _even(_quiet(math.cosh)),
        _of_one(lambda a: _call("sinh", a)),
    ),
    _function(
        "tanh", math.tanh, ("tanh", "tanh", "tanh", ""), _rising(math.tanh),
        _of_one(lambda a: 1.0 - _call("tanh", a) ** 2),
    ),
    _function(
        "floor", _whole(math.floor), ("floor", "floor", "floor", ""), _rising(_whole(math.floor)),
        exact=True,
    ),
    _function(
        "ceil", _whole(math.ceil), ("ceil", "ceil", "ceil", ""), _rising(_whole(math.ceil)),
        exact=True,
    ),
    _function(  # half to even, in every language
        "round", _whole(round), ("round", "rint", "rint", ""), _rising(_whole(round)), exact=True,
        js="rint",
    ),
    _function(
        "truncate", _whole(math.trunc), ("trunc", "trunc", "trunc", ""),
        _rising(_whole(math.trunc)), exact=True,
    ),
    # Conditions, and the choice. `then` and `otherwise` are evaluated on demand.
    Operation(
        "less", 2, lambda a, b: a < b, "less", "{0} < {1}", "{0} < {1}", "{0} < {1}",
        _less_bounds, binds=4, exact=True, sort=_COMPARISONS,
    ),
    Operation(
        "less_equal", 2, lambda a, b: a <= b, "less_equal",
        "{0} <= {1}", "{0} <= {1}", "{0} <= {1}",
        _less_equal_bounds, binds=4, exact=True, sort=_COMPARISONS,
    ),
    Operation(
        "equal", 2, lambda a, b: a == b, "equal", "{0} == {1}", "{0} == {1}", "{0} = {1}",
        _equal_bounds, binds=4, exact=True, sort=_COMPARISONS, js="{0} === {1}",
    ),
    Operation(
        "both", 2, lambda a, b: a and b, "logical_and", "{0} and {1}", "{0} && {1}", "{0} AND {1}",
        lambda a, b: Interval(min(a.low, b.low), min(a.high, b.high)),
        binds=2, exact=True, sort="logic",
    ),
    Operation(
        "either", 2, lambda a, b: a or b, "logical_or", "{0} or {1}", "{0} || {1}", "{0} OR {1}",
        lambda a, b: Interval(max(a.low, b.low), max(a.high, b.high)),
        binds=1, exact=True, sort="logic",
    ),
    Operation(
        "negation", 1, lambda a: not a, "logical_not", "not {0}", "!{0}", "NOT {0}",
        lambda a: Interval(1.0 - a.high, 1.0 - a.low), binds=3, exact=True, sort="logic",
    ),
    Operation(
        "where", 3, _where, "", "{1} if {0} else {2}", "{0} ? {1} : {2}", "",
        _where_bounds, lambda c, a, b: (_ZERO, _where_node(c, 1.0, 0.0), _where_node(c, 0.0, 1.0)),
        binds=0, exact=True, sort=_COMPARISONS + " of two",
    ),
)  # fmt: skip

OPERATIONS: dict[str, Operation] = {operation.name: operation for operation in _TABLE}
"""Every operation by its name."""
