"""Functions of elements: arithmetic, comparisons, mathematics, rounding."""

from __future__ import annotations

import builtins
import math
import operator
from bisect import bisect_right
from collections.abc import Callable
from contextlib import ContextDecorator
from functools import reduce
from itertools import accumulate
from math import inf, nan
from typing import Any

from fuzzyarm.apps.playground.arrays.array import (
    BOOL,
    FLOAT,
    WHOLE,
    array_of,
    broadcast_to,
    elements,
    made,
    ndarray,
    operate,
)
from fuzzyarm.apps.playground.arrays.kinds import DType, dtype, float32, promoted
from fuzzyarm.apps.playground.arrays.rows import along, reduced


def _divided(a: Any, b: Any) -> float:
    try:
        return float(a / b)
    except ZeroDivisionError:
        if a == 0 or a != a:
            return nan
        return math.copysign(inf, a) * math.copysign(1.0, b)


def _raised(a: Any, b: Any) -> Any:
    if isinstance(a, float) and b == 2:
        return a * a  # as in NumPy: pow may differ in the last bit
    try:
        result = a**b
    except OverflowError:
        if a > 0 or b % 2 == 0:
            return inf
        return -inf if b % 2 == 1 else nan
    except ZeroDivisionError:
        return math.copysign(inf, a) if b % 2 == 1 else inf
    return nan if isinstance(result, complex) else result


def _is_float(a: Any, b: Any) -> bool:
    """Whether a division is one of floats: whole numbers divided by 0 give 0 in NumPy."""
    return isinstance(a, float) or isinstance(b, float)


def largest(a: Any, b: Any) -> Any:
    """Return the larger of two numbers, or NaN."""
    # `a != a` for NaN, which propagates as in NumPy.
    return a if a >= b or a != a else b


def least(a: Any, b: Any) -> Any:
    """Return the smaller of two numbers, or NaN."""
    return a if a <= b or a != a else b


def _quiet(act: Callable[[float], float], beyond: float) -> Callable[[float], float]:
    """Return a mathematical function that is NaN where undefined."""

    def quiet(x: float) -> float:
        try:
            return act(x)
        except ValueError:
            return nan
        except OverflowError:
            return beyond

    return quiet


def _signed(act: Callable[[float], int]) -> Callable[[float], float]:
    """Return a rounding that preserves the sign of zero."""
    return lambda x: math.copysign(float(act(x)), x) if math.isfinite(x) else x


class ufunc:
    """An elementwise function with the interface of NumPy's.

    Parameters
    ----------
    act : callable
        Function of numbers.
    kind : DType, optional
        Kind of the results; by default that of the operands.
    floats : bool
        Whether integers become floats.
    """

    def __init__(
        self, act: Callable[..., Any], kind: DType | None = None, *, floats: bool = False
    ) -> None:
        self._act, self._kind, self._floats = act, kind, floats

    def __call__(self, *values: Any, out: Any = None, where: Any = None, **named: Any) -> Any:
        """Apply it to all elements; with `where` only to those, in `out`."""
        kind = self._kind if named.get("dtype") is None else dtype(named["dtype"])
        if kind is None and self._floats:
            kinds = [
                array_of(operand).dtype
                for operand in values
                if not isinstance(operand, int | float)
            ]
            together = reduce(promoted, kinds) if kinds else FLOAT
            kind = together if together.kind == "f" else FLOAT
        if where is not None and where is not True:
            mask = broadcast_to(where, out.shape)
            before = elements(out)
            results = operate(self._act, values, kind)
            results = elements(broadcast_to(results, out.shape))
            flags = elements(mask)
            out[...] = made(
                [new if yes else old for new, old, yes in zip(results, before, flags, strict=True)],
                out.dtype, out.shape,
            )  # fmt: skip
            return out
        return operate(self._act, values, kind, out)

    def accumulate(self, values: Any, axis: int = 0, dtype: Any = None) -> ndarray:
        """Return the accumulated results along an axis."""
        of = array_of(values, dtype)
        kind = of.dtype if of.dtype is not BOOL else WHOLE
        act = self._act
        if kind.name == "float32":
            act = lambda a, b: float32(float(a) + float(b)) if self is add else self._act(a, b)  # noqa: E731
        return along(of, axis, lambda row: list(accumulate(row, act)), kind)

    def reduce(
        self, values: Any, axis: Any = 0, initial: Any = None, *, keepdims: bool = False
    ) -> Any:
        """Reduce all elements along an axis."""
        act = self._act
        return reduced(
            values, axis, lambda row: reduce(act, row), initial=initial, keepdims=keepdims
        )

    def reduceat(self, values: Any, places: Any, axis: int = 0) -> ndarray:
        """Reduce the slices that begin at some indices."""
        of = array_of(values)
        starts = elements(array_of(places))
        ends = [*starts[1:], of.shape[axis]]
        pairs = list(zip(starts, ends, strict=True))
        return along(of, axis, lambda row: [reduce(self._act, row[a:b]) for a, b in pairs])

    def outer(self, a: Any, b: Any) -> Any:
        """Return it of each of one and each of the other."""
        first = array_of(a)
        return self(first.reshape((*first.shape, *(1,) * array_of(b).ndim)), b)


add, subtract, multiply = ufunc(operator.add), ufunc(operator.sub), ufunc(operator.mul)
divide = true_divide = ufunc(_divided, floats=True)
negative, absolute = ufunc(operator.neg), ufunc(builtins.abs)
square, power = ufunc(lambda x: x * x), ufunc(_raised)
maximum, minimum = ufunc(largest), ufunc(least)
mod = remainder = ufunc(lambda a, b: a % b if b else nan if _is_float(a, b) else 0)
floor_divide = ufunc(lambda a, b: a // b if b else _divided(a, b) if _is_float(a, b) else 0)
equal, not_equal = ufunc(operator.eq, BOOL), ufunc(operator.ne, BOOL)
less, less_equal = ufunc(operator.lt, BOOL), ufunc(operator.le, BOOL)
greater, greater_equal = ufunc(operator.gt, BOOL), ufunc(operator.ge, BOOL)
logical_and = ufunc(lambda a, b: bool(a) and bool(b), BOOL)
logical_or = ufunc(lambda a, b: bool(a) or bool(b), BOOL)
logical_not = ufunc(operator.not_, BOOL)
isnan, isinf, isfinite = (
    ufunc(math.isnan, BOOL),
    ufunc(math.isinf, BOOL),
    ufunc(math.isfinite, BOOL),
)
sqrt = ufunc(_quiet(math.sqrt, inf), floats=True)
sin, cos = ufunc(_quiet(math.sin, nan), floats=True), ufunc(_quiet(math.cos, nan), floats=True)
tan, arctan = ufunc(_quiet(math.tan, nan), floats=True), ufunc(math.atan, floats=True)
tanh, arctan2 = ufunc(math.tanh, floats=True), ufunc(math.atan2, floats=True)
exp = ufunc(_quiet(math.exp, inf), floats=True)
log = ufunc(lambda x: math.log(x) if x > 0.0 else (nan if x else -inf), floats=True)
hypot = ufunc(math.hypot, floats=True)
floor, ceil = ufunc(_signed(math.floor), floats=True), ufunc(_signed(math.ceil), floats=True)
trunc, rint = ufunc(_signed(math.trunc), floats=True), ufunc(_signed(builtins.round), floats=True)
sign = ufunc(lambda x: x if x != x else type(x)((x > 0) - (x < 0)))
copysign = ufunc(math.copysign, floats=True)


def nextafter(a: Any, b: Any) -> Any:
    """Return the next number from each towards another one."""
    single = array_of(a).dtype.name == "float32"
    if not single:
        return operate(math.nextafter, (a, b), FLOAT)
    return operate(_next_single, (a, b), dtype(float32))


def _next_single(a: float, b: float) -> float:
    import struct

    if a == b or a != a or b != b:
        return b if a == b else nan
    if a == 0.0:
        return math.copysign(2.0**-149, b)
    (bits,) = struct.unpack("i", struct.pack("f", a))
    away = (b > a) == (a > 0.0)
    return float(struct.unpack("f", struct.pack("i", bits + (1 if away else -1)))[0])


def clip(values: Any, low: Any = None, high: Any = None, **named: Any) -> Any:
    """Hold elements between two ends."""
    result = values if low is None else maximum(values, low)
    return result if high is None else minimum(result, high, out=named.get("out"))


def round(values: Any, decimals: int = 0) -> Any:
    """Round to a number of decimals, halves to even, as NumPy does: by a power of ten."""
    ten = 10.0 ** builtins.abs(decimals)
    if decimals >= 0:
        return divide(rint(multiply(values, ten)), ten) if decimals else rint(values)
    return multiply(rint(divide(values, ten)), ten)


around = round
abs = absolute


def interp(at: Any, x: Any, y: Any) -> Any:
    """Interpolate linearly between points, at some positions."""
    xs, ys = elements(array_of(x)), elements(array_of(y))

    def height(place: float) -> float:
        if place != place:
            return nan
        if place >= xs[-1]:
            return float(ys[-1])
        if place <= xs[0]:
            return float(ys[0])
        k = bisect_right(xs, place) - 1
        slope = (ys[k + 1] - ys[k]) / (xs[k + 1] - xs[k])
        return float(slope * (place - xs[k]) + ys[k])

    return operate(height, (at,), FLOAT)


class errstate(ContextDecorator):
    """Nothing is said of divisions by zero here."""

    def __init__(self, **_kinds: str) -> None:
        pass

    def __enter__(self) -> None:
        """Begin."""

    def __exit__(self, *_error: object) -> None:
        """End."""
