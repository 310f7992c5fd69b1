"""Elements in order: sorted, found again among others, counted."""

from __future__ import annotations

import builtins
from bisect import bisect_left, bisect_right
from typing import Any

from fuzzyarm.playground.arrays.array import BOOL, WHOLE, array_of, elements, made, ndarray, operate
from fuzzyarm.playground.arrays.rows import along


def sort(given: Any, axis: int = -1) -> ndarray:
    """Return the elements in order along an axis."""
    return along(array_of(given), axis, lambda row: sorted(row, key=_nan_last))


def _nan_last(value: Any) -> Any:
    return (value != value, value)


def argsort(given: Any, axis: int = -1, **_named: Any) -> ndarray:
    """Return the places of the elements in order."""

    def places(row: list[Any]) -> list[Any]:
        return sorted(range(len(row)), key=lambda k: _nan_last(row[k]))

    return along(array_of(given), axis, places, WHOLE)


def lexsort(keys: Any) -> ndarray:
    """Return the places in the order of the last key, then of the one before."""
    rows = [elements(array_of(key)) for key in keys]
    count = len(rows[0]) if rows else 0
    order = sorted(range(count), key=lambda k: tuple(row[k] for row in reversed(rows)))
    return made(order, WHOLE)


def unique(given: Any, **named: Any) -> Any:
    """Return the elements in order, each once."""
    flat = elements(array_of(given))
    values = sorted(set(flat), key=_nan_last)
    result = made(values, array_of(given).dtype)
    if named.get("return_inverse"):
        places = {value: place for place, value in enumerate(values)}
        return result, made([places[x] for x in flat], WHOLE, array_of(given).shape)
    return result


def isin(given: Any, among: Any) -> ndarray:
    """Whether each element is one of others."""
    members = set(elements(array_of(among)))
    return array_of(operate(lambda x: x in members, (array_of(given),), BOOL))


def searchsorted(points: Any, values: Any, side: str = "left") -> Any:
    """Return where values would stand among points."""
    row = elements(array_of(points))
    find = bisect_left if side == "left" else bisect_right
    size = len(row)
    # Each NaN stands behind all numbers, which nothing may be compared with.
    numbers = size - builtins.sum(x != x for x in row)
    of_nan = numbers if side == "left" else size
    return operate(lambda x: of_nan if x != x else find(row, x, 0, numbers), (values,), WHOLE)


def bincount(given: Any, minlength: int = 0) -> ndarray:
    """Return how often each whole number is there."""
    values = elements(array_of(given))
    counts = [0] * builtins.max(minlength, builtins.max(values, default=-1) + 1)
    for value in values:
        counts[value] += 1
    return made(counts, WHOLE)
