"""Python's arithmetic as a formula of the language, or as a linear sum of inputs."""

from __future__ import annotations

import ast
import inspect
import math
from collections.abc import Callable, Sequence
from types import CodeType
from typing import Any

from fuzzyarm.exchange.formats.findings import written
from fuzzyarm.language.model.rulebase import Shape
from fuzzyarm.symbolic.formulas import read_formula, write_formula

_SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "^"}
_FUNCTIONS = frozenset({"abs", "min", "max", "log10"})


def text_shape(text: str, names: list[str], factor: float = 1.0) -> Shape:
    """Return a linear consequent if the expression is one, else a formula."""
    if "{" in text:
        raise ValueError("templates are not supported")
    return _shape(ast.parse(text.strip(), mode="eval").body, names, factor)


def function_shape(
    function: Callable[..., Any],
    names: list[str],
    ranges: Sequence[tuple[float, float]] | None = None,
) -> Shape:
    """Return a function of the inputs as a linear consequent, else as a formula.

    Its source text is translated if it is arithmetic of the inputs; the result agrees with the
    function at points all over the ranges.
    """
    points = _points(function, ranges or [(-100.0, 100.0)] * len(names))
    linear = _linear_at_points(function, points, len(names))
    try:
        parameters, body = _definition(function)
        if len(parameters) != len(names):
            raise ValueError(f"it takes {len(parameters)} numbers, not {len(names)}")
        shape = _shape(_renamed(body, dict(zip(parameters, names, strict=True))), names, 1.0)
        _compare(function, shape, names, points)
    except (SyntaxError, ValueError, OSError, TypeError):
        if linear is None:
            raise
        shape = Shape("linear", tuple(linear))
    # Rounding is removed: the numbers as written by a person.
    if linear is not None and shape.kind == "linear":
        return Shape("linear", tuple(linear)) if any(linear[:-1]) else _constant(linear[-1])
    return shape


def _constant(value: float) -> Shape:
    return Shape("singleton", (value,))


_TRIALS = (0.37, -1.61, 2.83, 0.59, -3.31, 1.13)
"""Trial arguments of a sum, irregular on purpose."""

_SPREAD = 256
"""Points spread over the ranges, beside those along each input through the middle."""


def _points(
    function: Callable[..., Any], ranges: Sequence[tuple[float, float]]
) -> list[list[float]]:
    """Return points of the ranges: even, at corners, and at a function's constants (its kinks)."""
    middle = [0.5 * (low + high) for low, high in ranges]
    # A Kronecker sequence: multiples of irrational steps are evenly spread in any dimension.
    steps = [math.sqrt(prime) % 1.0 for prime in _primes(len(ranges))]
    points = [
        [
            low + (high - low) * ((turn * step) % 1.0)
            for step, (low, high) in zip(steps, ranges, strict=True)
        ]
        for turn in range(_SPREAD)
    ]
    points += [[low for low, _ in ranges], [high for _, high in ranges], middle]
    numbers = _numbers_of(function)
    for index, (low, high) in enumerate(ranges):
        along = [low + (high - low) * i / 16 for i in range(17)]
        along += [x for x in numbers if low < x < high]
        points += [[*middle[:index], x, *middle[index + 1 :]] for x in along]
    return points


def _primes(count: int) -> list[int]:
    primes: list[int] = []
    number = 2
    while len(primes) < count:
        if all(number % prime for prime in primes):
            primes.append(number)
        number += 1
    return primes


def _numbers_of(function: Callable[..., Any]) -> list[float]:
    """Return the constants in a function's code, each with its neighbours."""
    code = getattr(function, "__code__", None)
    values = [x for x in getattr(code, "co_consts", ()) if isinstance(x, (int, float))]
    near = [(x, math.nextafter(x, -math.inf), math.nextafter(x, math.inf)) for x in values[:50]]
    return [float(x) for beside in near for x in beside]


def _value(function: Callable[..., Any], point: Sequence[float]) -> float | None:
    """Return the value of a function, or None without one."""
    try:
        value = float(function(*point))
    except ArithmeticError:
        return None
    return value if math.isfinite(value) else None


def _linear_at_points(
    function: Callable[..., Any], points: Sequence[Sequence[float]], count: int
) -> list[float] | None:
    """Return factors and constant of a function that is linear at all points, else None."""
    try:
        # 0 and the unit vectors determine a linear function; the other points verify it.
        constant = float(function(*[0.0] * count))
        units = ([float(i == k) for i in range(count)] for k in range(count))
        factors = [float(function(*unit)) - constant for unit in units]
        trials = [
            [_TRIALS[(turn + i) % len(_TRIALS)] * (1 + i) for i in range(count)]
            for turn in range(len(_TRIALS))
        ]
        for point in [*trials, *points]:
            terms = [f * x for f, x in zip(factors, point, strict=True)]
            if not _agree(float(function(*point)), constant + sum(terms), [constant, *terms]):
                return None
    except (ArithmeticError, ValueError, TypeError):
        return None
    return [*map(_plain, factors), _plain(constant)]


def _agree(one: float, other: float, terms: Sequence[float] = ()) -> bool:
    """Whether two numbers agree within the rounding of the terms of their sum."""
    return abs(one - other) <= 1e-9 * (1.0 + abs(one) + sum(map(abs, terms)))


def _compare(
    function: Callable[..., Any],
    shape: Shape,
    names: Sequence[str],
    points: Sequence[Sequence[float]],
) -> None:
    """Raise if a shape differs from its function, in spite of the text."""
    formula = read_formula(shape.formula).function(names) if shape.kind == "formula" else None
    for point in points:
        value = _value(function, point)
        if value is None:
            continue
        if formula is not None:
            same = _agree(value, formula(*point))
        else:
            *factors, constant = shape.parameters
            terms = [f * x for f, x in zip(factors, point, strict=True)]
            same = _agree(value, constant + sum(terms), [constant, *terms])
        if not same:
            raise ValueError("its text does not say what it computes")


def _plain(number: float) -> float:
    """Return the number of twelve digits approximated by a number."""
    return float(f"{number:.12g}")


def _definition(function: Callable[..., Any]) -> tuple[list[str], ast.expr]:
    """Return parameters and expression of a function with a single expression."""
    if not inspect.isfunction(function):
        raise ValueError("it is not a function of one expression")
    code = function.__code__
    lines, _ = inspect.findsource(function)
    definitions: list[tuple[int, list[str], ast.expr]] = []
    for node in ast.walk(ast.parse("".join(lines))):
        body = _body(node)
        if body is not None and _is_of(node, body, code):
            size = len(list(ast.walk(body)))
            definitions.append((size, [arg.arg for arg in node.args.args], body))  # type: ignore[attr-defined]
    if not definitions:
        raise ValueError("it is not a function of one expression")
    _, parameters, body = min(definitions, key=lambda entry: entry[0])  # the innermost
    return parameters, body


def _body(node: ast.AST) -> ast.expr | None:
    """Return the single expression of a function, or None."""
    if isinstance(node, ast.Lambda):
        return node.body
    if isinstance(node, ast.FunctionDef):
        statements = [part for part in node.body if not _is_docstring(part)]
        if len(statements) == 1 and isinstance(statements[0], ast.Return):
            return statements[0].value
    return None


def _is_of(node: ast.AST, body: ast.expr, code: CodeType) -> bool:
    """Whether code was compiled from an expression of a text: it spans all instructions."""
    first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))])  # type: ignore[attr-defined]
    if isinstance(node, ast.Lambda) != (code.co_name == "<lambda>") or code.co_firstlineno != first:
        return False
    starts: list[tuple[int, int]] = []
    ends: list[tuple[int, int]] = []
    for line, end_line, column, end_column in code.co_positions():
        if line is not None and column is not None and (line, column) >= _start(body):
            starts.append((line, column))
            ends.append((end_line or line, end_column or column))
    return bool(starts) and min(starts) == _start(body) and max(ends) <= _end(body)


def _start(node: ast.expr) -> tuple[int, int]:
    return node.lineno, node.col_offset


def _end(node: ast.expr) -> tuple[int, int]:
    return node.end_lineno or node.lineno, node.end_col_offset or node.col_offset


def _is_docstring(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


class _Renamed(ast.NodeTransformer):
    def __init__(self, names: dict[str, str]) -> None:
        self.names = names

    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.Name(self.names.get(node.id, node.id), node.ctx)


def _renamed(body: ast.expr, names: dict[str, str]) -> ast.expr:
    """Return an expression of parameters as one of inputs; any other name is an error."""
    for node in ast.walk(body):
        if isinstance(node, ast.Name) and node.id not in {*names, *_FUNCTIONS}:
            raise ValueError(f"'{node.id}' is not one of its parameters")
    renamed: ast.expr = _Renamed(names).visit(body)
    return renamed


def _shape(tree: ast.expr, names: list[str], factor: float) -> Shape:
    affine = _affine(tree, names)
    if affine is not None:
        return Shape("linear", tuple(factor * number for number in affine))
    formula = _in_words(tree, names)
    formula = formula if factor == 1.0 else f"{written(factor)} * ({formula})"
    return Shape("formula", (), 1.0, write_formula(read_formula(formula).root))


def _affine(tree: ast.expr, names: list[str]) -> list[float] | None:
    """Return a coefficient for each name, then the constant; None if not affine."""
    match tree:
        case ast.Constant(value=int() | float() as number):
            return [*[0.0] * len(names), float(number)]
        case ast.Name(id=name) if name in names:
            return [float(other == name) for other in names] + [0.0]
        case ast.UnaryOp(op=ast.USub() | ast.UAdd() as sign, operand=operand):
            inner = _affine(operand, names)
            return inner and [-x if isinstance(sign, ast.USub) else x for x in inner]
        case ast.BinOp(left=left, op=sign, right=right):
            a, b = _affine(left, names), _affine(right, names)
            return _affine_of(sign, a, b) if a is not None and b is not None else None
    return None


def _affine_of(sign: ast.operator, a: list[float], b: list[float]) -> list[float] | None:
    match sign:
        case ast.Add():
            return [x + y for x, y in zip(a, b, strict=True)]
        case ast.Sub():
            return [x - y for x, y in zip(a, b, strict=True)]
        case ast.Mult() if not any(a[:-1]):
            return [a[-1] * y for y in b]
        case ast.Mult() if not any(b[:-1]):
            return [x * b[-1] for x in a]
        case ast.Div() if not any(b[:-1]) and b[-1]:
            return [x / b[-1] for x in a]
    return None


def _in_words(tree: ast.expr, names: list[str]) -> str:
    match tree:
        case ast.Constant(value=int() | float() as number):
            return written(float(number))
        case ast.Name(id=name):
            if name not in names:
                raise ValueError(f"'{name}' is not an input")
            return name
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return f"(-({_in_words(operand, names)}))"
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _in_words(operand, names)
        case ast.BinOp(left=left, op=sign, right=right) if type(sign) in _SIGNS:
            return f"({_in_words(left, names)} {_SIGNS[type(sign)]} {_in_words(right, names)})"
        case ast.Call(func=ast.Name(id=function), args=args, keywords=[]) if function in _FUNCTIONS:
            return f"{function}({', '.join(_in_words(argument, names) for argument in args)})"
    raise ValueError(f"'{ast.unparse(tree)}' is not supported")
