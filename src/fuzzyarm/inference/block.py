"""The numbers of a rule base, and the block of memory in which the kernel reads them."""

from __future__ import annotations

from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference import kernel as at


class NotCoveredError(Exception):
    """The kernel does not do this; the message says what."""


class Layout(NamedTuple):
    """The numbers of a rule base.

    Attributes
    ----------
    whole, floats : list
        What the kernel reads.
    programs : int
        How many cells of all inputs together there are.
    rows, samples : int
        How many rows the kernel works in, and how long the row of samples has to be.
    marks : tuple of Mark
        Of a loose layout: where the numbers of each term stand.
    """

    whole: list[int]
    floats: list[float]
    programs: int
    rows: int
    samples: int
    marks: tuple[Mark, ...] = ()


class Mark(NamedTuple):
    """Where the numbers of a term stand in a loose layout.

    Attributes
    ----------
    sort : str
        ``curve`` (the numbers of its row function), ``pieces`` (four floats each), ``samples``
        (a degree for each position) or ``value``.
    variable, term : str
        The term; as it is, without hedges.
    row : int
        Of a curve the row that its degrees are written to; of pieces where in the whole numbers
        their count stands.
    floats, room : int
        Where its numbers begin, and for how many there is room.
    scaled : bool
        Of a set: whether its rules scale it rather than cut it.
    """

    sort: str
    variable: str
    term: str
    row: int
    floats: int
    room: int
    scaled: bool = False


class Block(NamedTuple):
    """The numbers with room for some points.

    Attributes
    ----------
    numbers : ndarray of float64
        What the kernel takes.
    columns, results : ndarray of float64, shapes (inputs, points) and (outputs, points)
        Parts of it.
    points : ndarray of int64, shape (1,)
        How many points there are; a part of it, too.
    """

    numbers: NDArray[np.float64]
    columns: NDArray[np.float64]
    results: NDArray[np.float64]
    points: NDArray[np.int64]


GAP = 24
"""Floats between two long rows. Rows that began a power of two apart would have the same lines of
the cache, and a program works in more rows at once than a line has places."""


def make_block(layout: Layout, points: int) -> Block:
    """Give the numbers of a rule base room for so many points."""
    inputs, outputs = layout.whole[at.INPUTS], layout.whole[at.OUTPUTS]
    width = points if points == 1 else points + GAP
    # In the order of memory: each name is where the next part begins.
    lengths = {
        at.FLOATS: len(layout.whole),
        at.ROOM: len(layout.floats),
        at.COLUMNS: layout.rows * width + 2 * layout.samples,
        at.RESULTS: inputs * width,
        at.ORDERED: outputs * width,
        at.ORDER: inputs * width,
        at.ENDS: 2 * width,
        at.SIZE: layout.programs + 2,
    }
    ends = dict(zip(lengths, accumulate(lengths.values()), strict=True))
    numbers = np.zeros(ends[at.SIZE])
    whole = numbers.view(np.int64)
    whole[: len(layout.whole)] = layout.whole
    whole[at.POINTS], whole[at.WIDTH] = points, width
    for name, end in ends.items():
        whole[name] = end
    numbers[ends[at.FLOATS] : ends[at.ROOM]] = layout.floats
    ones = ends[at.ROOM] + at.ONES * width
    numbers[ones : ones + points] = 1.0
    columns = numbers[ends[at.COLUMNS] : ends[at.RESULTS]].reshape(inputs, width)
    results = numbers[ends[at.RESULTS] : ends[at.ORDERED]].reshape(outputs, width)
    return Block(
        numbers, columns[:, :points], results[:, :points], whole[at.POINTS : at.POINTS + 1]
    )
