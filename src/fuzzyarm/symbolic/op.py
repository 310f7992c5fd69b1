"""The functions for definitions of shapes, norms, hedges and other kinds.

Each takes expressions, numbers or arrays, and returns the same: tracing a definition gives an
expression, calling it with numbers gives a number. Arithmetic is that of Python
(``+ - * / **``, ``abs``), comparisons give conditions; ``where`` chooses between two values,
``equal`` compares values.

>>> from fuzzyarm import op
>>> op.where(op.sqrt(4.0) < 3.0, op.minimum(1.0, 2.0), 0.0)
1.0
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fuzzyarm.symbolic.nodes import Node, apply
from fuzzyarm.symbolic.operations import OPERATIONS

__all__ = [
    "acos", "asin", "atan", "atan2", "both", "ceil", "cos", "cosh", "either", "equal", "exp",
    "floor", "fmod", "inf", "log", "log10", "maximum", "minimum", "negation", "pi", "power",
    "round", "sin", "sinh", "sqrt", "tan", "tanh", "truncate", "where",
]  # fmt: skip

pi = math.pi
inf = math.inf


def _function(name: str, summary: str) -> Callable[..., Any]:
    operation = OPERATIONS[name]

    def function(*arguments: Any) -> Any:
        if len(arguments) != operation.arity:
            raise TypeError(
                f"op.{name} takes {operation.arity} arguments, {len(arguments)} are given"
            )
        if any(isinstance(argument, Node) for argument in arguments):
            return apply(name, *arguments)
        if any(hasattr(argument, "__array__") for argument in arguments):
            from fuzzyarm.symbolic.evaluation import array_function

            return array_function(name)(*arguments)
        return operation.scalar(*arguments)

    function.__name__ = function.__qualname__ = name
    function.__doc__ = summary
    return function


minimum = _function("minimum", "Return the smaller of two, the first of equal ones.")
maximum = _function("maximum", "Return the larger of two, the first of equal ones.")
where = _function("where", "Return the second argument where the first holds, else the third.")
equal = _function("equal", "Return whether two values are equal.")
both = _function("both", "Return whether two conditions hold; ``a & b`` of expressions.")
either = _function("either", "Return whether one of two conditions holds; ``a | b``.")
negation = _function("negation", "Return whether a condition does not hold; ``~a``.")
sqrt = _function("sqrt", "Return the square root; NaN of a negative number.")
exp = _function("exp", "Return e to a power; infinite where it is too large.")
log = _function("log", "Return the natural logarithm; -inf of 0, NaN of a negative number.")
log10 = _function("log10", "Return the decimal logarithm; -inf of 0, NaN of a negative number.")
power = _function("power", "Return the first argument to the power of the second.")
fmod = _function("remainder", "Return the remainder of a division, with the sign of the first.")
sin = _function("sin", "Return the sine of an angle in radians.")
cos = _function("cos", "Return the cosine of an angle in radians.")
tan = _function("tan", "Return the tangent of an angle in radians.")
asin = _function("asin", "Return the arc sine, in radians.")
acos = _function("acos", "Return the arc cosine, in radians.")
atan = _function("atan", "Return the arc tangent, in radians.")
atan2 = _function("atan2", "Return the angle of the point (second, first), in radians.")
sinh = _function("sinh", "Return the hyperbolic sine.")
cosh = _function("cosh", "Return the hyperbolic cosine.")
tanh = _function("tanh", "Return the hyperbolic tangent.")
floor = _function("floor", "Return the largest whole number that is not above.")
ceil = _function("ceil", "Return the smallest whole number that is not below.")
round = _function("round", "Return the nearest whole number; of two the even one.")  # noqa: A001
truncate = _function("truncate", "Return the whole number next towards 0.")


def raised(base: Any, exponent: Any) -> Any:
    """Return a power of a non-negative base, with exact forms for squares and roots.

    C compilers replace a constant exponent of 2 by a product and one of 0.5 by a root: their last
    bits differ from the library's power.
    """
    other = where(equal(exponent, 0.5), sqrt(base), power(base, exponent))
    return where(equal(exponent, 2.0), base * base, other)
