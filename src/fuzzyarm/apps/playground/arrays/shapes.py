"""Shapes of arrays: axes in another order, put in, left out, and brought together."""

from __future__ import annotations

from typing import Any

from fuzzyarm.apps.playground.arrays.array import array_of, broadcast_shapes, broadcast_to, ndarray


def shape(values: Any) -> tuple[int, ...]:
    """Return the shape."""
    return array_of(values).shape


def ndim(values: Any) -> int:
    """Return the number of axes."""
    return array_of(values).ndim


def size(values: Any) -> int:
    """Return the number of elements."""
    return array_of(values).size


def reshape(values: Any, shape: Any) -> ndarray:
    """Return the elements in another shape."""
    return array_of(values).reshape(shape)


def ravel(values: Any) -> ndarray:
    """Return all elements along one axis."""
    return array_of(values).ravel()


def transpose(values: Any, axes: Any = None) -> ndarray:
    """Return the axes in another order."""
    of = array_of(values)
    return of.transpose() if axes is None else of.transpose(tuple(axes))


def moveaxis(values: Any, source: int, destination: int) -> ndarray:
    """Move an axis to another position."""
    of = array_of(values)
    order = [axis for axis in range(of.ndim) if axis != source % of.ndim]
    order.insert(destination % of.ndim, source % of.ndim)
    return of.transpose(tuple(order))


def swapaxes(values: Any, one: int, other: int) -> ndarray:
    """Exchange two axes."""
    of = array_of(values)
    order = list(range(of.ndim))
    order[one], order[other] = order[other], order[one]
    return of.transpose(tuple(order))


def expand_dims(values: Any, axis: int) -> ndarray:
    """Put in an axis of one element."""
    of = array_of(values)
    at = axis % (of.ndim + 1)
    return of.reshape((*of.shape[:at], 1, *of.shape[at:]))


def squeeze(values: Any) -> ndarray:
    """Return it without axes of one element."""
    return array_of(values).squeeze()


def atleast_1d(values: Any) -> ndarray:
    """Return an array of one axis at least."""
    of = array_of(values)
    return of.reshape((1,)) if not of.shape else of


def atleast_2d(values: Any) -> ndarray:
    """Return an array of two axes at least."""
    of = atleast_1d(values)
    return of.reshape((1, -1)) if of.ndim == 1 else of


def broadcast_arrays(*values: Any) -> tuple[ndarray, ...]:
    """Return all arrays in their common broadcast shape."""
    arrays = [array_of(item) for item in values]
    common = broadcast_shapes(*(item.shape for item in arrays))
    return tuple(broadcast_to(item, common) for item in arrays)
