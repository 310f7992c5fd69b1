"""Straight-line arithmetic: expressions and statements that both NumPy and C can run.

The direct inference of a rule base is written down once in these few operations. Running
them over arrays (:func:`run`) is the Python model; printing them (:func:`statements_in_c`)
is the C. Nothing else may happen between the two.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.export.numbers import C_TYPES, c_number

Array = NDArray[Any]


@dataclass(frozen=True, slots=True)
class Number:
    """A constant, rounded to the type of the arithmetic."""

    value: float


@dataclass(frozen=True, slots=True)
class Local:
    """A variable that a statement has set, or a parameter."""

    name: str


@dataclass(frozen=True, slots=True)
class Binary:
    """``+ - * /`` or ``min max`` of two expressions."""

    operator: str
    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class Select:
    """`yes` where `left` compares so with `right`, else `no`."""

    operator: str
    left: Expression
    right: Expression
    yes: Expression
    no: Expression


@dataclass(frozen=True, slots=True)
class Call:
    """A function of one argument that stands before the main one."""

    function: Function
    argument: Expression


Expression = Number | Local | Binary | Select | Call


@dataclass(frozen=True, slots=True)
class Assign:
    """Set a variable, maybe again; the remark goes into the C as a comment."""

    name: str
    value: Expression
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Function:
    """Statements and a result, of one parameter."""

    wanted: str
    parameter: str
    statements: tuple[Assign, ...]
    result: Expression


ZERO, ONE = Number(0.0), Number(1.0)


def add(a: Expression, b: Expression) -> Expression:
    """Return a + b; a sum with zero is no operation."""
    if a == ZERO:
        return b
    return a if b == ZERO else Binary("+", a, b)


def subtract(a: Expression, b: Expression) -> Expression:
    """Return a - b."""
    return a if b == ZERO else Binary("-", a, b)


def times(a: Expression, b: Expression) -> Expression:
    """Return a × b; a product with zero or one is no operation."""
    if ZERO in {a, b}:
        return ZERO
    if a == ONE:
        return b
    return a if b == ONE else Binary("*", a, b)


def divide(a: Expression, b: Expression) -> Expression:
    """Return a / b; a division by a power of two becomes a product."""
    if isinstance(b, Number) and abs(np.frexp(b.value)[0]) == 0.5:
        return times(a, Number(1.0 / b.value))
    return Binary("/", a, b)


def least(a: Expression, b: Expression) -> Expression:
    """Return the smaller one."""
    return Binary("min", a, b)


def greatest(a: Expression, b: Expression) -> Expression:
    """Return the greater one."""
    return Binary("max", a, b)


# ── running ──────────────────────────────────────────────────────────────────────────

_COMPARISONS = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
}
_ARITHMETIC: dict[str, Callable[[Any, Any], Any]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "min": lambda a, b: np.where(a < b, a, b),  # of two zeros the second, as in C
    "max": lambda a, b: np.where(a > b, a, b),
}


def run(
    statements: Sequence[Assign],
    result: Expression,
    values: Mapping[str, Array],
    kind: type[np.floating],
) -> Array:
    """Return the result over arrays, every operation rounded to `kind`.

    Parameters
    ----------
    statements, result
        What to do.
    values : mapping of str to ndarray
        The parameters, of type `kind`.
    kind : type
        ``np.float32`` or ``np.float64``.
    """
    known: dict[str, Any] = dict(values)
    with np.errstate(all="ignore"):  # branches that are not taken may divide by zero
        for statement in statements:
            known[statement.name] = _value(statement.value, known, kind)
        return np.asarray(_value(result, known, kind))


def _value(expression: Expression, known: Mapping[str, Any], kind: type[np.floating]) -> Any:
    if isinstance(expression, Number):
        return kind(expression.value)
    if isinstance(expression, Local):
        return known[expression.name]
    if isinstance(expression, Call):
        function = expression.function
        argument = {function.parameter: _value(expression.argument, known, kind)}
        return run(function.statements, function.result, argument, kind)
    left, right = _value(expression.left, known, kind), _value(expression.right, known, kind)
    if isinstance(expression, Select):
        holds = _COMPARISONS[expression.operator](left, right)
        yes, no = _value(expression.yes, known, kind), _value(expression.no, known, kind)
        return np.where(holds, yes, no)
    return _ARITHMETIC[expression.operator](left, right)


def locals_of(expression: Expression) -> set[str]:
    """Return the variables that an expression reads."""
    if isinstance(expression, Number):
        return set()
    if isinstance(expression, Local):
        return {expression.name}
    if isinstance(expression, Call):
        return locals_of(expression.argument)
    read = locals_of(expression.left) | locals_of(expression.right)
    if isinstance(expression, Select):
        read |= locals_of(expression.yes) | locals_of(expression.no)
    return read


def without_unused(statements: Sequence[Assign], result: Expression) -> tuple[Assign, ...]:
    """Return the statements that the result depends on."""
    used = locals_of(result)
    kept = []
    for statement in reversed(statements):
        if statement.name in used:
            used |= locals_of(statement.value)
            kept.append(statement)
    return tuple(reversed(kept))


def functions_of(statements: Sequence[Assign], result: Expression) -> list[Function]:
    """Return the functions that are called, each once, in the order of their first use."""
    found: dict[Function, None] = {}
    waiting = [result, *(statement.value for statement in reversed(statements))]
    while waiting:
        expression = waiting.pop()
        if isinstance(expression, Call):
            found.setdefault(expression.function)
            waiting.append(expression.argument)
        elif isinstance(expression, Binary | Select):
            waiting += [expression.left, expression.right]
            if isinstance(expression, Select):
                waiting += [expression.yes, expression.no]
    return list(found)


# ── counting ─────────────────────────────────────────────────────────────────────────

_KINDS = {
    "+": "additions and subtractions",
    "-": "additions and subtractions",
    "*": "multiplications",
    "/": "divisions",
    "min": "comparisons",
    "max": "comparisons",
}


def operations(statements: Sequence[Assign], result: Expression) -> Counter[str]:
    """Return how many operations of each kind are done at most (both branches never are)."""
    total: Counter[str] = Counter()
    for expression in [*(statement.value for statement in statements), result]:
        total += _operations(expression)
    return total


def _operations(expression: Expression) -> Counter[str]:
    if isinstance(expression, Number | Local):
        return Counter()
    if isinstance(expression, Call):
        function = expression.function
        inside = operations(function.statements, function.result)
        return inside + _operations(expression.argument)
    both = _operations(expression.left) + _operations(expression.right)
    if isinstance(expression, Select):
        branches = _operations(expression.yes) | _operations(expression.no)
        return both + branches + Counter({"comparisons": 1})
    return both + Counter({_KINDS[expression.operator]: 1})


# ── printing ─────────────────────────────────────────────────────────────────────────


class CPrinter:
    """Prints expressions as C.

    Parameters
    ----------
    kind : type
        Of the arithmetic.
    helpers : mapping of str to callable
        Give the names of the C functions for ``min`` and ``max``, which are written if asked for.
    functions : mapping of Function to str
        Names of the C functions that are called.
    """

    def __init__(
        self,
        kind: type[np.floating],
        helpers: Mapping[str, Callable[[], str]],
        functions: Mapping[Function, str],
    ) -> None:
        self._kind = kind
        self._helpers = helpers
        self._functions = functions

    def expression(self, expression: Expression, *, inner: bool = False) -> str:
        """Return C; in parentheses where it stands inside another expression."""
        if isinstance(expression, Number) and math.isnan(expression.value):
            return "NAN" if self._kind is np.float32 else "(double)NAN"
        if isinstance(expression, Number):
            text = c_number(expression.value, self._kind)
            return f"({text})" if text.startswith("-") and inner else text
        if isinstance(expression, Local):
            return expression.name
        if isinstance(expression, Call):
            name = self._functions[expression.function]
            return f"{name}({self.expression(expression.argument)})"
        if isinstance(expression, Binary) and expression.operator in self._helpers:
            parts = (self.expression(expression.left), self.expression(expression.right))
            return f"{self._helpers[expression.operator]()}({parts[0]}, {parts[1]})"
        left = self.expression(expression.left, inner=True)
        right = self.expression(expression.right, inner=True)
        text = f"{left} {expression.operator} {right}"
        if isinstance(expression, Select):
            yes = self.expression(expression.yes, inner=True)
            no = self.expression(expression.no, inner=True)
            text = f"{text} ? {yes} : {no}"
        return f"({text})" if inner else text

    def statements(self, statements: Sequence[Assign]) -> list[str]:
        """Return lines that declare every variable where it is set first."""
        kind = C_TYPES[self._kind]
        counts = Counter(statement.name for statement in statements)
        seen: set[str] = set()
        lines = []
        for statement in statements:
            name = statement.name
            constant = "const " if counts[name] == 1 else ""
            head = name if name in seen else f"{constant}{kind} {name}"
            seen.add(name)
            remark = f" /* {statement.remark} */" if statement.remark else ""
            lines.append(f"{head} = {self.expression(statement.value)};{remark}")
        return lines
