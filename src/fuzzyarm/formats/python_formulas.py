"""Python's arithmetic as a formula of the language, or as a linear sum of inputs."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable
from typing import Any

from fuzzyarm.expression.formulas import read_formula, write_formula
from fuzzyarm.formats.findings import written
from fuzzyarm.model.rulebase import Shape

__all__ = ["function_shape", "text_shape"]

_SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "^"}
_FUNCTIONS = frozenset({"abs", "min", "max", "log10"})


def text_shape(text: str, names: list[str], factor: float = 1.0) -> Shape:
    """Return a linear consequent where an expression is one, else a formula.

    Parameters
    ----------
    text : str
        An expression of Python.
    names : list of str
        The inputs, in the order of a linear consequent.
    factor : float
        What the whole is multiplied by.

    Raises
    ------
    SyntaxError, ValueError, FormulaError
        If it is not arithmetic of the inputs.
    """
    if "{" in text:
        raise ValueError("templates are not supported")
    return _shape(ast.parse(text.strip(), mode="eval").body, names, factor)


def function_shape(function: Callable[..., Any], names: list[str]) -> Shape:
    """Return what a function of the inputs computes: a linear consequent, else a formula.

    It is linear where it is at points; otherwise its own text is read.

    Parameters
    ----------
    function : callable
        Of a number for each name, in their order.
    names : list of str
        The inputs.

    Raises
    ------
    SyntaxError, ValueError, FormulaError, OSError
        If it is not arithmetic of the inputs, or its text is not at hand.
    """
    linear = _linear_at_points(function, len(names))
    if linear is not None:
        return Shape("linear", tuple(linear)) if any(linear[:-1]) else _constant(linear[-1])
    parameters, body = _definition(function)
    if len(parameters) != len(names):
        raise ValueError(f"it takes {len(parameters)} numbers, not {len(names)}")
    return _shape(_Renamed(dict(zip(parameters, names, strict=True))).visit(body), names, 1.0)


def _constant(value: float) -> Shape:
    return Shape("singleton", (value,))


_POINTS = (0.37, -1.61, 2.83, 0.59, -3.31, 1.13)
"""Numbers at which a sum is tried, in no order."""


def _linear_at_points(function: Callable[..., Any], count: int) -> list[float] | None:
    """Return factors and constant of a function that is their sum at points, else None."""

    def value(*numbers: float) -> float:
        return float(function(*numbers))

    try:
        constant = value(*[0.0] * count)
        units = ([float(i == k) for i in range(count)] for k in range(count))
        factors = [value(*unit) - constant for unit in units]
        for turn in range(len(_POINTS)):
            point = [_POINTS[(turn + i) % len(_POINTS)] * (1 + i) for i in range(count)]
            found, sum_ = value(*point), sum(f * x for f, x in zip(factors, point, strict=True))
            if not abs(found - constant - sum_) <= 1e-9 * (1.0 + abs(found)):
                return None
    except (ArithmeticError, ValueError, TypeError):
        return None
    return [*map(_plain, factors), _plain(constant)]


def _plain(number: float) -> float:
    """Return the number of twelve digits that a number is but for rounding."""
    return float(f"{number:.12g}")


def _definition(function: Callable[..., Any]) -> tuple[list[str], ast.expr]:
    """Return parameters and expression of a function of one line."""
    source = textwrap.dedent(inspect.getsource(function)).strip()
    while True:
        try:
            tree = ast.parse(source)
            break
        except SyntaxError:  # a lambda within a call: from its word on, as far as it goes
            start = source.find("lambda", 1 if source.startswith("lambda") else 0)
            source = source[start:] if start > 0 else source[:-1]
            if not source:
                raise
    for node in ast.walk(tree):
        if isinstance(node, ast.Lambda):
            return [each.arg for each in node.args.args], node.body
        if isinstance(node, ast.FunctionDef):
            statements = [each for each in node.body if not _is_docstring(each)]
            if len(statements) == 1 and isinstance(statements[0], ast.Return):
                body = statements[0].value
                if body is not None:
                    return [each.arg for each in node.args.args], body
    raise ValueError("it is not a function of one expression")


def _is_docstring(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


class _Renamed(ast.NodeTransformer):
    def __init__(self, names: dict[str, str]) -> None:
        self.names = names

    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.Name(self.names.get(node.id, node.id), node.ctx)


def _shape(tree: ast.expr, names: list[str], factor: float) -> Shape:
    affine = _affine(tree, names)
    if affine is not None:
        return Shape("linear", tuple(factor * number for number in affine))
    formula = _in_words(tree, names)
    formula = formula if factor == 1.0 else f"{written(factor)} * ({formula})"
    return Shape("formula", (), 1.0, write_formula(read_formula(formula).root))


def _affine(tree: ast.expr, names: list[str]) -> list[float] | None:
    """Return a coefficient for each name and the constant, or None."""
    match tree:
        case ast.Constant(value=int() | float() as number):
            return [*[0.0] * len(names), float(number)]
        case ast.Name(id=name) if name in names:
            return [float(each == name) for each in names] + [0.0]
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
            return f"{function}({', '.join(_in_words(each, names) for each in args)})"
    raise ValueError(f"'{ast.unparse(tree)}' is not supported")
