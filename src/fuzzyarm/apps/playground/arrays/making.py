"""How arrays are made: of values, of one value, evenly spaced, as grids."""

from __future__ import annotations

import builtins
import math
from collections.abc import Iterable
from typing import Any

from fuzzyarm.apps.playground.arrays.array import FLOAT, WHOLE, array_of, elements, made, ndarray
from fuzzyarm.apps.playground.arrays.kinds import dtype
from fuzzyarm.apps.playground.arrays.rows import lengths
from fuzzyarm.apps.playground.arrays.shapes import broadcast_arrays

inf, nan, pi, e = math.inf, math.nan, math.pi, math.e
newaxis = None


def asarray(value: Any, dtype: Any = None, **_order: Any) -> ndarray:
    """Return an array; an array itself unchanged."""
    return array_of(value, dtype)


asanyarray = asarray


def array(value: Any, dtype: Any = None, **_order: Any) -> ndarray:
    """Return a new array."""
    return array_of(value, dtype).copy()


def ascontiguousarray(value: Any, dtype: Any = None) -> ndarray:
    """Return an array whose elements are contiguous."""
    source = array_of(value, dtype)
    return source if source.flags.c_contiguous else source.copy()


def full(shape: Any, value: Any, dtype: Any = None) -> ndarray:
    """Return an array of one value."""
    of = lengths(shape)
    result = made([0] * math.prod(of), array_of(value, dtype).dtype, of)
    result[...] = value
    return result


def zeros(shape: Any, dtype: Any = float) -> ndarray:
    """Return an array of zeros."""
    of = lengths(shape)
    kind = _dtype(dtype)
    if kind.kind == "O":
        return made([0] * math.prod(of), kind, of)
    memory = memoryview(bytearray(builtins.max(math.prod(of), 1) * kind.itemsize)).cast(kind.code)  # type: ignore[call-overload]
    return ndarray(memory, kind, of)


empty = zeros
_dtype = dtype


def ones(shape: Any, dtype: Any = float) -> ndarray:
    """Return an array of ones."""
    return full(shape, 1, dtype)


def zeros_like(like: Any, dtype: Any = None) -> ndarray:
    """Return zeros in the shape of an array."""
    source = array_of(like)
    return zeros(source.shape, dtype or source.dtype)


empty_like = zeros_like


def ones_like(like: Any, dtype: Any = None) -> ndarray:
    """Return ones in the shape of an array."""
    source = array_of(like)
    return full(source.shape, 1, dtype or source.dtype)


def full_like(like: Any, value: Any, dtype: Any = None) -> ndarray:
    """Return one value in the shape of an array."""
    source = array_of(like)
    return full(source.shape, value, dtype or source.dtype)


def arange(*ends: Any, dtype: Any = None) -> ndarray:
    """Return evenly spaced numbers, without the end."""
    start, stop, step = (0, *ends, 1) if len(ends) == 1 else (*ends, 1)[:3]
    if builtins.all(isinstance(number, int) for number in (start, stop, step)):
        values: list[Any] = list(range(start, stop, step))
    else:
        count = builtins.max(math.ceil((stop - start) / step), 0)
        # NumPy continues by the rounded difference of the first two numbers.
        step = (start + step) - start
        values = [start + k * step for k in range(count)]
        if builtins.any(isinstance(number, float) for number in (*ends, step)):
            dtype = dtype or FLOAT
    return array_of(values, dtype or (WHOLE if not values else None))


def linspace(start: Any, stop: Any, num: int = 50) -> ndarray:
    """Return evenly spaced numbers with both ends."""
    first, last, count = float(start), float(stop), int(num) - 1
    if count < 1:
        return made([first][: count + 1], FLOAT)
    step = (last - first) / count
    if step == 0.0:
        values = [k / count * (last - first) + first for k in range(count + 1)]
    else:
        values = [k * step + first for k in range(count + 1)]
    values[-1] = last
    return made(values, FLOAT)


def fromiter(values: Iterable[Any], dtype: Any, count: int = -1) -> ndarray:
    """Return an array of an iterator's elements."""
    listed = list(values)
    return array_of(listed if count < 0 else listed[:count], dtype)


def diag(values: Any) -> ndarray:
    """Return a matrix with these numbers on its diagonal."""
    source = array_of(values)
    result = zeros((source.size, source.size), source.dtype)
    for k, value in enumerate(elements(source)):
        result[k, k] = value
    return result


def meshgrid(*axes: Any, indexing: str = "xy") -> list[ndarray]:
    """Return the coordinates of a grid."""
    rows = [array_of(axis) for axis in axes]
    if indexing == "xy" and len(rows) > 1:
        a, b = meshgrid(rows[1], rows[0], indexing="ij")
        return [b, a]
    return [axis_array.copy() for axis_array in broadcast_arrays(*ix_(*rows))]


def ix_(*axes: Any) -> tuple[ndarray, ...]:
    """Return each axis in its own dimension."""
    rows = [array_of(axis) for axis in axes]
    return tuple(
        row.reshape((1,) * k + (row.size,) + (1,) * (len(rows) - k - 1))
        for k, row in enumerate(rows)
    )
