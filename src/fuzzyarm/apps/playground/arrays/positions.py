"""Indices of elements: search by condition, and access by index arrays."""

from __future__ import annotations

import builtins
from collections.abc import Iterator, Sequence
from functools import reduce
from itertools import product
from typing import Any

from fuzzyarm.apps.playground.arrays.array import (
    FLOAT,
    WHOLE,
    array_of,
    broadcast_shapes,
    broadcast_to,
    elements,
    kind_of,
    made,
    ndarray,
    operate,
)
from fuzzyarm.apps.playground.arrays.kinds import promoted


def nonzero(values: Any) -> tuple[ndarray, ...]:
    """Return the indices of nonzero elements, an array for each axis."""
    of = array_of(values)
    spots = argwhere(of)
    return tuple(spots[:, axis] for axis in range(of.ndim))


def argwhere(values: Any) -> ndarray:
    """Return the indices of nonzero elements, a row for each."""
    of = array_of(values)
    spots = [
        spot
        for spot, is_true in zip(product(*map(range, of.shape)), elements(of), strict=True)
        if is_true
    ]
    return made([index for spot in spots for index in spot], WHOLE, (len(spots), of.ndim))


def flatnonzero(values: Any) -> ndarray:
    """Return the indices of nonzero elements in the flattened array."""
    return made([k for k, value in enumerate(elements(array_of(values))) if value], WHOLE)


def unravel_index(place: Any, shape: Sequence[int]) -> tuple[Any, ...]:
    """Return a flat index as indices of each axis."""
    indices: list[Any] = []
    rest: Any = place if isinstance(place, ndarray) else int(place)
    for size in reversed(shape):
        indices.append(rest % size)
        rest = rest // size
    return tuple(reversed(indices))


def ndindex(*shape: Any) -> Iterator[tuple[int, ...]]:
    """Go through all indices of a shape."""
    sizes = shape[0] if len(shape) == 1 and isinstance(shape[0], Sequence) else shape
    return product(*map(range, sizes))


def take(values: Any, indices: Any, axis: int | None = None) -> Any:
    """Return the elements at some indices along an axis."""
    of = array_of(values)
    if axis is None:
        return of.ravel()[indices]
    return of[(slice(None),) * (axis % of.ndim) + (indices,)]


def take_along_axis(values: Any, indices: Any, axis: int) -> ndarray:
    """Return the elements at indices that differ from row to row."""
    of, at = array_of(values), array_of(indices)
    axis %= of.ndim
    shape = list(broadcast_shapes(*(
        tuple(1 if k == axis else n for k, n in enumerate(operand.shape)) for operand in (of, at)
    )))  # fmt: skip
    shape[axis] = at.shape[axis]
    grid = [
        made(list(range(n)), WHOLE).reshape([-1 if j == k else 1 for j in range(len(shape))])
        for k, n in enumerate(shape)
    ]
    grid[axis] = broadcast_to(at, shape)
    return array_of(
        broadcast_to(of, [of.shape[axis] if k == axis else n for k, n in enumerate(shape)])[
            tuple(grid)
        ]
    )


def where(condition: Any, *values: Any) -> Any:
    """Choose between two values element by element; of a condition alone, its true positions."""
    if not values:
        return nonzero(condition)
    kinds = [branch for branch in values if isinstance(branch, ndarray)]
    kind = reduce(promoted, (branch.dtype for branch in kinds)) if kinds else None
    if kind is None or (
        kind.kind != "f" and builtins.any(isinstance(branch, float) for branch in values)
    ):
        kind = reduce(promoted, map(kind_of, values)) if not kinds else FLOAT
    return operate(lambda yes, a, b: a if yes else b, (condition, *values), kind)
