"""The part of a window of states proved so far, as a target of further boxes.

In a loop without memory whose window has all states of the plant, a run that enters a proved box
continues like one that starts there. So the union of proved boxes is a goal, which grows backward
from rest. It is stored as cells of a grid, each wholly proved or not; a box is inside if the sum
over its cells, read from a table of partial sums, is their number.
"""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.proof.loop.enclosure import Intervals
from fuzzyarm.proof.loop.follower import Box

HALVINGS = {1: 12, 2: 8, 3: 6, 4: 5, 5: 4}
"""Halvings of each side of the window for the cells, by the number of states."""


class Cover:
    """The proved cells of a window.

    Parameters
    ----------
    window : Box
        The window: sides are halved as a box is.
    """

    def __init__(self, window: Box) -> None:
        self.low, self.high = np.array(window.low), np.array(window.high)
        self.count = 1 << HALVINGS[len(window.low)]
        self.edges = [self._edges(k, window) for k in range(len(window.low))]
        self.filled = np.zeros((self.count,) * len(self.edges))
        self.sums = np.zeros((self.count + 1,) * len(self.edges), dtype=np.int64)
        self.is_new = False

    @staticmethod
    def fits(dimensions: int) -> bool:
        """Return whether there is a grid for this number of states."""
        return dimensions in HALVINGS

    def _edges(self, way: int, window: Box) -> NDArray[np.float64]:
        """Return the ends of cells along a side, rounded like those of halved boxes."""
        ends = [window.low[way], window.high[way]]
        while len(ends) <= self.count:
            middles = [0.5 * a + 0.5 * b for a, b in pairwise(ends)]
            ends = [x for pair in zip(ends, middles, strict=False) for x in pair] + ends[-1:]
        return np.array(ends)

    def add(self, low: tuple[float, ...], high: tuple[float, ...]) -> None:
        """Add a proved box of the window, made by halving; each box once."""
        cells, share = [], 1.0
        for way, (a, b) in enumerate(zip(low, high, strict=True)):
            found = self._halved(way, a, b)
            if found is None:
                return
            first, count, part = found
            cells.append(slice(first, first + count))
            share *= part
        self.filled[tuple(cells)] += share
        self.is_new = True

    def _halved(self, way: int, a: float, b: float) -> tuple[int, int, float] | None:
        """Return the first cell of a side, their number, and the side's share of a cell: exact."""
        low, high = float(self.low[way]), float(self.high[way])
        first, count, share = 0, self.count, 1.0
        while (low, high) != (a, b):
            middle = 0.5 * low + 0.5 * high
            if not low < middle < high or a < middle < b:
                return None  # not a repeated half of the window
            above = a >= middle
            low, high = (middle, high) if above else (low, middle)
            if count > 1:
                count //= 2
                first += count if above else 0
            else:
                share *= 0.5
        return first, count, share

    def add_cells(self, inside: NDArray[np.bool_]) -> None:
        """Add whole cells."""
        self.filled[inside] = 1.0
        self.is_new = True

    def holds(self, box: Intervals) -> NDArray[np.bool_]:
        """Return which boxes, shape (states, boxes), are wholly in proved cells."""
        if self.is_new:
            # Parts of a cell are disjoint, with shares that are powers of 1/2: the sum is exact.
            whole = (self.filled >= 1.0).astype(np.int64)
            for axis in range(whole.ndim):
                whole = np.cumsum(whole, axis=axis)
            self.sums[(slice(1, None),) * whole.ndim] = whole
            self.is_new = False
        firsts, lasts = [], []
        inside = np.ones(box.low.shape[1], dtype=bool)
        for k, edges in enumerate(self.edges):
            inside &= (box.low[k] >= edges[0]) & (box.high[k] <= edges[-1])
            # The cells from the last edge not above the lower end to the first not below the upper
            # end.
            first = np.searchsorted(edges, box.low[k], side="right") - 1
            last = np.searchsorted(edges, box.high[k], side="left")
            firsts.append(np.clip(first, 0, self.count - 1))
            lasts.append(np.clip(np.maximum(last, first + 1), 1, self.count))
        number = np.prod([b - a for a, b in zip(firsts, lasts, strict=True)], axis=0)
        total = np.zeros(len(inside), dtype=np.int64)
        for ends in product((0, 1), repeat=len(self.edges)):
            index = tuple((firsts, lasts)[end][k] for k, end in enumerate(ends))
            total += (-1) ** (len(ends) - sum(ends)) * self.sums[index]
        return np.asarray(inside & (total == number))
