"""Sums, extremes and products along axes, in the order of NumPy's loops."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from functools import reduce
from math import inf, nan
from typing import Any

from fuzzyarm.apps.playground.arrays.array import BOOL, WHOLE, array_of, elements, ndarray
from fuzzyarm.apps.playground.arrays.elementwise import (
    absolute,
    add,
    divide,
    equal,
    isfinite,
    isnan,
    largest,
    least,
    less_equal,
    logical_and,
    logical_or,
    multiply,
    sqrt,
    square,
    subtract,
)
from fuzzyarm.apps.playground.arrays.joining import concatenate
from fuzzyarm.apps.playground.arrays.kinds import float32
from fuzzyarm.apps.playground.arrays.positions import where
from fuzzyarm.apps.playground.arrays.rows import lengths, reduced
from fuzzyarm.apps.playground.arrays.shapes import expand_dims, moveaxis


def _pairwise(row: list[Any], keep: Callable[[Any], Any]) -> Any:
    """Return a sum in the order of NumPy: eight sums side by side, halves above 128 numbers."""
    count = len(row)
    # NumPy sums pairwise (`pairwise_sum` in loops_utils.h): the bits depend on this order.
    if count < 8:
        return _added(row, -0.0, keep) + 0.0 if row else 0.0
    if count <= 128:
        sums = row[:8]
        whole = count - count % 8
        for start in range(8, whole, 8):
            sums = [keep(a + b) for a, b in zip(sums, row[start : start + 8], strict=True)]
        a, b, c, d = (keep(sums[k] + sums[k + 1]) for k in range(0, 8, 2))
        return _added(row[whole:], keep(keep(a + b) + keep(c + d)), keep)
    half = count // 2
    half -= half % 8
    return keep(_pairwise(row[:half], keep) + _pairwise(row[half:], keep))


def _added(values: Any, start: Any, round_to: Callable[[Any], Any]) -> Any:
    """Return a sum, one after the other; of singles each is rounded."""
    return reduce(lambda a, b: round_to(a + b), values, start)


def sum(values: Any, axis: Any = None, *, keepdims: bool = False) -> Any:
    """Return the sum: pairwise along rows, one row after the other across them."""
    of = array_of(values)
    if of.dtype is BOOL or of.dtype.kind == "i":
        return reduced(of, axis, lambda row: reduce(operator.add, row, 0), WHOLE, keepdims=keepdims)
    keep: Callable[[Any], Any] = float32 if of.dtype.name == "float32" else _same
    if axis is None or of.ndim == 1 or (axis % of.ndim) == of.ndim - 1:
        return reduced(of, axis, lambda row: _pairwise(row, keep), keepdims=keepdims)
    return reduced(of, axis, lambda row: _added(row, -0.0, keep) + 0.0, keepdims=keepdims)


def _same(value: Any) -> Any:
    return value


def prod(values: Any, axis: Any = None, **named: Any) -> Any:
    """Return the product."""
    kind = array_of(values).dtype
    kind = WHOLE if kind.kind != "f" else kind
    return reduced(values, axis, lambda row: reduce(operator.mul, row, 1), kind, **named)


def mean(values: Any, axis: Any = None) -> Any:
    """Return the mean."""
    of = array_of(values)
    count = of.size if axis is None else of.shape[axis]
    return divide(sum(of.astype(float, copy=False), axis), count)


def std(values: Any, axis: Any = None) -> Any:
    """Return the standard deviation."""
    of = array_of(values)
    centre = mean(of, axis)
    if axis is not None:
        centre = expand_dims(centre, axis)
    return sqrt(mean(square(subtract(of, centre)), axis))


def _most(row: list[Any]) -> Any:
    return reduce(largest, row)


def _fewest(row: list[Any]) -> Any:
    return reduce(least, row)


def _demand_elements(of: ndarray, axis: Any, named: dict[str, Any], operation: str) -> None:
    count = of.size if axis is None else math.prod(of.shape[k] for k in lengths(axis))
    if count == 0 and "initial" not in named:
        raise ValueError(
            f"zero-size array to reduction operation {operation} which has no identity"
        )


def max(values: Any, axis: Any = None, **named: Any) -> Any:
    """Return the largest element, or NaN."""
    of = array_of(values)
    _demand_elements(of, axis, named, "maximum")
    return reduced(of, axis, _most, **named)


def min(values: Any, axis: Any = None, **named: Any) -> Any:
    """Return the least element, or NaN."""
    of = array_of(values)
    _demand_elements(of, axis, named, "minimum")
    return reduced(of, axis, _fewest, **named)


amax, amin = max, min


def nanmax(values: Any, axis: Any = None, **named: Any) -> Any:
    """Return the largest element, NaN ignored."""
    return reduced(values, axis, lambda row: _most([x for x in row if x == x] or [nan]), **named)


def ptp(values: Any, axis: Any = None) -> Any:
    """Return the largest element less the least."""
    return subtract(max(values, axis), min(values, axis))


def any(values: Any, axis: Any = None, **named: Any) -> Any:
    """Whether one is true."""
    return reduced(values, axis, lambda row: True in map(bool, row), BOOL, **named)


def all(values: Any, axis: Any = None, **named: Any) -> Any:
    """Whether all are true."""
    return reduced(values, axis, lambda row: False not in map(bool, row), BOOL, **named)


def _first(row: list[Any], best: Callable[[list[Any]], Any]) -> int:
    for k, value in enumerate(row):
        # NumPy returns the position of the first NaN.
        if value != value:
            return k
    return row.index(best(row))


def argmax(values: Any, axis: Any = None) -> Any:
    """Return the position of the largest element."""
    return reduced(values, axis, lambda row: _first(row, _most), WHOLE)


def argmin(values: Any, axis: Any = None) -> Any:
    """Return the position of the least element."""
    return reduced(values, axis, lambda row: _first(row, _fewest), WHOLE)


def nanargmax(values: Any, axis: Any = None) -> Any:
    """Return the position of the largest element, NaN ignored."""
    return argmax(where(isnan(values), -inf, values), axis)


def cumsum(values: Any, axis: Any = None, *, out: Any = None) -> ndarray:
    """Return the running sum."""
    of = array_of(values)
    sums = add.accumulate(of.ravel() if axis is None else of, 0 if axis is None else axis)
    if out is None:
        return sums
    out[...] = sums
    return out  # type: ignore[no-any-return]


def diff(values: Any, axis: int = -1, *, prepend: Any = None) -> ndarray:
    """Return the differences of neighbours."""
    of = array_of(values)
    if prepend is not None:
        of = concatenate([prepend, of], axis=axis)
    of = moveaxis(of, axis, -1)
    return moveaxis(subtract(of[..., 1:], of[..., :-1]), -1, axis)


def dot(a: Any, b: Any) -> Any:
    """Return the product of matrices, or of rows."""
    first, other = array_of(a), array_of(b)
    if other.ndim == 1:
        return sum(multiply(first, other), -1)
    if first.ndim == 1:
        return sum(multiply(expand_dims(first, -1), other), -2)
    return sum(multiply(expand_dims(first, -1), expand_dims(other, -3)), -2)


def array_equal(a: Any, b: Any) -> bool:
    """Whether two arrays have one shape and the same elements."""
    one, other = array_of(a), array_of(b)
    return one.shape == other.shape and elements(one) == elements(other)


def allclose(a: Any, b: Any, rtol: float = 1e-5, atol: float = 1e-8) -> bool:
    """Whether two arrays are nearly the same."""
    near = less_equal(absolute(subtract(a, b)), add(atol, multiply(rtol, absolute(b))))
    # Equal infinities are near, though their difference is NaN; nothing else is near to one.
    return bool(all(logical_or(equal(a, b), logical_and(near, isfinite(b)))))
