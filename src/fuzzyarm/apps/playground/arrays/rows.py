"""Operations on the rows along an axis: each makes a row of results, or one."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

from fuzzyarm.apps.playground.arrays.array import array_of, elements, made, ndarray, single
from fuzzyarm.apps.playground.arrays.kinds import DType
from fuzzyarm.apps.playground.arrays.shapes import moveaxis


def along(
    of: ndarray, axis: int, act: Callable[[list[Any]], list[Any]], kind: DType | None = None
) -> ndarray:
    """Replace each row along an axis by a row of results."""
    axis %= of.ndim
    last = moveaxis(of, axis, -1)
    size = last.shape[-1]
    flat = elements(last)
    rows = [act(flat[k : k + size]) for k in range(0, len(flat), size or 1)]
    length = len(rows[0]) if rows else 0
    values = [value for row in rows for value in row]
    result = made(values, kind or of.dtype, (*last.shape[:-1], length))
    return moveaxis(result, -1, axis)


def reduced(
    source: Any, axis: Any, act: Callable[[list[Any]], Any], kind: DType | None = None,
    *, initial: Any = None, keepdims: bool = False,
) -> Any:  # fmt: skip
    """Replace each row along an axis, or all elements, by one result."""
    of = array_of(source)
    kind = kind or of.dtype
    begin = [] if initial is None else [initial]
    if axis is None:
        result = act([*begin, *elements(of)])
        return made([result], kind, (1,) * of.ndim) if keepdims else single(result, kind)
    if isinstance(axis, tuple):
        result = of
        for axis_number in sorted((a % of.ndim for a in axis), reverse=True):
            result = reduced(result, axis_number, act, kind, initial=initial)
        return result
    axis %= of.ndim
    last = moveaxis(of, axis, -1)
    size = last.shape[-1]
    flat = elements(last)
    count = math.prod(last.shape[:-1])
    values = [act([*begin, *flat[k * size : (k + 1) * size]]) for k in range(count)]
    shape = (
        tuple(1 if k == axis else n for k, n in enumerate(of.shape))
        if keepdims
        else last.shape[:-1]
    )
    result = made(values, kind, shape)
    return result if shape else result[()]


def lengths(shape: Any) -> tuple[int, ...]:
    """Return a shape, or one length, as a tuple."""
    return tuple(map(int, shape)) if isinstance(shape, Iterable) else (int(shape),)
