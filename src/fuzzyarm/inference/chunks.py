"""Cut the shape of a result into blocks that stay in the processor's cache."""

from __future__ import annotations

from collections.abc import Iterator
from math import prod

Block = tuple[slice, ...]


def blocks(shape: tuple[int, ...], most: int) -> Iterator[Block]:
    """Yield slices that cover an array of `shape`, each of at most `most` elements.

    Parameters
    ----------
    shape : tuple of int
        Of the whole; an empty one yields one empty block.
    most : int
        Elements, at least 1.

    Yields
    ------
    tuple of slice
        One for each axis, in the order of memory.
    """
    if prod(shape) <= most:
        yield tuple(slice(0, n) for n in shape)
        return
    inner = prod(shape[1:])
    rows = most // inner
    if rows >= 1:
        for start in range(0, shape[0], rows):
            rest = tuple(slice(0, n) for n in shape[1:])
            yield (slice(start, min(start + rows, shape[0])), *rest)
        return
    for row in range(shape[0]):
        for block in blocks(shape[1:], most):
            yield (slice(row, row + 1), *block)
