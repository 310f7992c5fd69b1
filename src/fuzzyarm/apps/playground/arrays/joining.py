"""Arrays put together, repeated, written into each other, and gone through in one piece."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from typing import Any

from fuzzyarm.apps.playground.arrays.array import array_of, broadcast_to, elements, made, ndarray
from fuzzyarm.apps.playground.arrays.kinds import promoted
from fuzzyarm.apps.playground.arrays.making import ascontiguousarray
from fuzzyarm.apps.playground.arrays.rows import along
from fuzzyarm.apps.playground.arrays.shapes import (
    atleast_1d,
    atleast_2d,
    broadcast_arrays,
    expand_dims,
    moveaxis,
    ravel,
)


def concatenate(parts: Any, axis: int = 0, dtype: Any = None) -> ndarray:
    """Put arrays one after the other."""
    arrays = [array_of(part, dtype) for part in parts]
    kind = reduce(
        promoted,
        (piece.dtype for piece in arrays if piece.size or len(arrays) == 1),
        arrays[0].dtype,
    )
    axis %= arrays[0].ndim
    whole = list(arrays[0].shape)
    whole[axis] = 0
    for piece in arrays:
        whole[axis] += piece.shape[axis]
    if axis == 0:
        flat = [x for piece in arrays for x in elements(piece.astype(kind, copy=False))]
        return made(flat, kind, tuple(whole))
    turned = concatenate([moveaxis(piece, axis, 0) for piece in arrays])
    return ascontiguousarray(moveaxis(turned, 0, axis))


def stack(parts: Any, axis: int = 0) -> ndarray:
    """Put arrays beside each other along a new axis."""
    arrays = [array_of(part) for part in parts]
    at = axis % (arrays[0].ndim + 1)
    return concatenate([expand_dims(piece, at) for piece in arrays], at)


def vstack(parts: Any) -> ndarray:
    """Put rows below each other."""
    return concatenate([atleast_2d(part) for part in parts])


def hstack(parts: Any) -> ndarray:
    """Put arrays beside each other."""
    arrays = [atleast_1d(part) for part in parts]
    return concatenate(arrays, 0 if arrays[0].ndim == 1 else 1)


def column_stack(parts: Any) -> ndarray:
    """Put columns beside each other."""
    arrays = [array_of(part) for part in parts]
    return concatenate([a.reshape((-1, 1)) if a.ndim < 2 else a for a in arrays], 1)


def append(values: Any, more: Any) -> ndarray:
    """Append elements to an array."""
    return concatenate([ravel(values), ravel(more)])


def repeat(values: Any, times: Any, axis: int | None = None) -> ndarray:
    """Repeat each element along an axis."""
    of = array_of(values)
    if axis is None:
        of, axis = of.ravel(), 0
    counts = elements(broadcast_to(times, (of.shape[axis],)))
    return along(
        of, axis, lambda row: [x for x, n in zip(row, counts, strict=True) for _ in range(n)]
    )


def copyto(to: ndarray, value: Any, where: Any = True) -> None:
    """Write values into an array, at chosen positions."""
    if where is True:
        to[...] = value
        return
    mask, values = (elements(broadcast_to(operand, to.shape)) for operand in (where, value))
    pairs = zip(mask, values, elements(to), strict=True)
    to[...] = made([new if yes else old for yes, new, old in pairs], to.dtype, to.shape)


class nditer:
    """All elements of some arrays in one piece, the last array writable.

    Parameters
    ----------
    arrays : sequence of ndarray
        Broadcast together.
    """

    def __init__(self, arrays: Sequence[ndarray], **_flags: Any) -> None:
        *inputs, self._to = broadcast_arrays(*arrays)
        self._columns = [ascontiguousarray(column).ravel() for column in inputs]
        self._out = ascontiguousarray(self._to).ravel()

    def __enter__(self) -> nditer:
        """Begin."""
        return self

    def __exit__(self, *_error: object) -> None:
        """Write the remaining elements."""
        if not self._to.flags.c_contiguous:
            self._to[...] = self._out.reshape(self._to.shape)

    def __iter__(self) -> Iterator[tuple[ndarray, ...]]:
        """Give the one piece."""
        return iter([(*self._columns, self._out)])
