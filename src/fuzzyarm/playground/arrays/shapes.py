"""Shapes of arrays: axes in another order, put in, left out, and brought together."""

from __future__ import annotations

from typing import Any

from fuzzyarm.playground.arrays.array import array_of, broadcast_shapes, broadcast_to, ndarray


def shape(given: Any) -> tuple[int, ...]:
    """Return the shape."""
    return array_of(given).shape


def ndim(given: Any) -> int:
    """Return how many axes."""
    return array_of(given).ndim


def size(given: Any) -> int:
    """Return how many elements."""
    return array_of(given).size


def reshape(given: Any, shape: Any) -> ndarray:
    """Return the elements in another shape."""
    return array_of(given).reshape(shape)


def ravel(given: Any) -> ndarray:
    """Return all elements along one axis."""
    return array_of(given).ravel()


def transpose(given: Any, axes: Any = None) -> ndarray:
    """Return the axes in another order."""
    of = array_of(given)
    return of.transpose() if axes is None else of.transpose(tuple(axes))


def moveaxis(given: Any, source: int, destination: int) -> ndarray:
    """Put an axis at another place."""
    of = array_of(given)
    order = [axis for axis in range(of.ndim) if axis != source % of.ndim]
    order.insert(destination % of.ndim, source % of.ndim)
    return of.transpose(tuple(order))


def swapaxes(given: Any, one: int, other: int) -> ndarray:
    """Exchange two axes."""
    of = array_of(given)
    order = list(range(of.ndim))
    order[one], order[other] = order[other], order[one]
    return of.transpose(tuple(order))


def expand_dims(given: Any, axis: int) -> ndarray:
    """Put in an axis of one element."""
    of = array_of(given)
    at = axis % (of.ndim + 1)
    return of.reshape((*of.shape[:at], 1, *of.shape[at:]))


def squeeze(given: Any) -> ndarray:
    """Return it without axes of one element."""
    return array_of(given).squeeze()


def atleast_1d(given: Any) -> ndarray:
    """Return an array of one axis at least."""
    of = array_of(given)
    return of.reshape((1,)) if not of.shape else of


def atleast_2d(given: Any) -> ndarray:
    """Return an array of two axes at least."""
    of = atleast_1d(given)
    return of.reshape((1, -1)) if of.ndim == 1 else of


def broadcast_arrays(*given: Any) -> tuple[ndarray, ...]:
    """Return all in the shape that they make together."""
    arrays = [array_of(item) for item in given]
    common = broadcast_shapes(*(item.shape for item in arrays))
    return tuple(broadcast_to(item, common) for item in arrays)
