"""The operators and methods of arrays, which are functions as well."""

from __future__ import annotations

import operator
from typing import Any

from fuzzyarm.apps.playground.arrays import (
    elementwise,
    joining,
    ordering,
    positions,
    reductions,
    shapes,
)
from fuzzyarm.apps.playground.arrays.array import array_of, ndarray
from fuzzyarm.apps.playground.arrays.elementwise import (
    absolute,
    add,
    divide,
    equal,
    floor_divide,
    greater,
    greater_equal,
    less,
    less_equal,
    mod,
    multiply,
    negative,
    not_equal,
    power,
    subtract,
    ufunc,
)
from fuzzyarm.apps.playground.arrays.kinds import number
from fuzzyarm.apps.playground.arrays.reductions import dot

METHODS = {
    reductions: (
        "sum", "prod", "mean", "std", "max", "min", "any", "all", "argmax", "argmin", "cumsum",
        "dot",
    ),
    elementwise: ("round", "clip"),
    positions: ("nonzero", "take"),
    ordering: ("searchsorted", "argsort"),
    shapes: ("swapaxes",),
    joining: ("repeat",),
}  # fmt: skip
"""Functions that are methods of arrays as well, by their modules."""


def give_operators() -> None:
    """Add the operators to arrays, and the functions that are methods as well."""
    for module, names in METHODS.items():
        for name in names:
            setattr(ndarray, name, getattr(module, name))
    both = {
        "add": add, "sub": subtract, "mul": multiply, "truediv": divide, "pow": power,
        "mod": mod, "floordiv": floor_divide,
    }  # fmt: skip
    for name, act in both.items():
        setattr(ndarray, f"__{name}__", lambda a, b, act=act: act(a, b))
        setattr(ndarray, f"__r{name}__", lambda a, b, act=act: act(b, a))
        setattr(ndarray, f"__i{name}__", lambda a, b, act=act: act(a, b, out=a))
    compared = {
        "eq": equal, "ne": not_equal, "lt": less, "le": less_equal, "gt": greater,
        "ge": greater_equal,
    }  # fmt: skip
    for name, act in compared.items():
        setattr(ndarray, f"__{name}__", lambda a, b, act=act: act(a, b))
    bits = {"and": operator.and_, "or": operator.or_, "xor": operator.xor}
    for name, plain in bits.items():
        act = ufunc(plain)
        setattr(ndarray, f"__{name}__", lambda a, b, act=act: act(a, b))
        setattr(ndarray, f"__r{name}__", lambda a, b, act=act: act(b, a))
        setattr(ndarray, f"__i{name}__", lambda a, b, act=act: act(a, b, out=a))
    turned = ufunc(lambda x: not x if isinstance(x, bool) else ~x)
    for name, of_one in {"neg": negative, "abs": absolute, "invert": turned}.items():
        setattr(ndarray, f"__{name}__", lambda a, of_one=of_one: of_one(a))
    setattr(ndarray, "__matmul__", dot)  # noqa: B010 - as all of them
    setattr(number, "__getattr__", _of_array)  # noqa: B010


def _of_array(value: number, name: str) -> Any:
    """Return an attribute of a single number: as NumPy's it has those of an array without axes."""
    if name.startswith("_"):
        raise AttributeError(name)
    return getattr(array_of(value), name)
