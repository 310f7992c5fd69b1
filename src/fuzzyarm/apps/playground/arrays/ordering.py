"""Elements in order: sorted, found again among others, counted."""

from __future__ import annotations

import builtins
from bisect import bisect_left, bisect_right
from typing import Any

from fuzzyarm.apps.playground.arrays.array import (
    BOOL,
    FLOAT,
    WHOLE,
    array_of,
    elements,
    made,
    ndarray,
    operate,
)
from fuzzyarm.apps.playground.arrays.rows import along


def sort(values: Any, axis: int = -1) -> ndarray:
    """Return the elements in order along an axis."""
    return along(array_of(values), axis, lambda row: sorted(row, key=_nan_last))


def _nan_last(value: Any) -> Any:
    return (value != value, value)


def argsort(values: Any, axis: int = -1, kind: str = "stable") -> ndarray:
    """Return the positions of the elements in order."""

    def places(row: list[Any]) -> list[Any]:
        return sorted(range(len(row)), key=lambda k: _nan_last(row[k]))

    return along(array_of(values), axis, places, WHOLE)


def lexsort(keys: Any) -> ndarray:
    """Return the positions in the order of the last key, then of the one before."""
    rows = [elements(array_of(key)) for key in keys]
    count = len(rows[0]) if rows else 0
    order = sorted(range(count), key=lambda k: tuple(row[k] for row in reversed(rows)))
    return made(order, WHOLE)


def unique(source: Any, axis: int | None = None, *, return_inverse: bool = False) -> Any:
    """Return the elements in order, each once; along axis 0 the rows of a table."""
    of = array_of(source)
    flat: list[Any] = elements(of)
    shape: tuple[int, ...] = ()
    if axis is not None:
        if axis != 0 or of.ndim != 2:
            raise NotImplementedError("unique along another axis than 0 of a table needs NumPy")
        shape, width = of.shape[1:], of.shape[1]
        flat = [tuple(flat[k * width : (k + 1) * width]) for k in range(of.shape[0])]
    key = _nan_last if axis is None else lambda row: tuple(map(_nan_last, row))
    values = sorted(set(flat), key=key)
    every = values if axis is None else [element for row in values for element in row]
    result = made(every, of.dtype, (len(values), *shape))
    if not return_inverse:
        return result
    places = {value: place for place, value in enumerate(values)}
    inverse = made([places[x] for x in flat], WHOLE)
    return result, inverse if axis is not None else inverse.reshape(of.shape)


def isin(values: Any, among: Any) -> ndarray:
    """Whether each element is in a set."""
    members = set(elements(array_of(among)))
    return array_of(operate(lambda x: x in members, (array_of(values),), BOOL))


def searchsorted(points: Any, values: Any, side: str = "left") -> Any:
    """Return the positions of values among points."""
    row = elements(array_of(points))
    find = bisect_left if side == "left" else bisect_right
    size = len(row)
    # NaNs, unordered, follow all numbers.
    numbers = size - builtins.sum(x != x for x in row)
    of_nan = numbers if side == "left" else size
    return operate(lambda x: of_nan if x != x else find(row, x, 0, numbers), (values,), WHOLE)


def bincount(source: Any, weights: Any = None, minlength: int = 0) -> ndarray:
    """Return the count of each whole number, or the sum of its weights."""
    values = elements(array_of(source))
    size = builtins.max(minlength, builtins.max(values, default=-1) + 1)
    if weights is None:
        counts = [0] * size
        for value in values:
            counts[value] += 1
        return made(counts, WHOLE)
    sums = [0.0] * size
    for value, weight in zip(values, elements(array_of(weights)), strict=True):
        sums[value] += float(weight)
    return made(sums, FLOAT)
