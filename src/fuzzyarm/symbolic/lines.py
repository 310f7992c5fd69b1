"""Piecewise linear membership functions, with one definition of their rounding.

A straight shape is given by its corners (x, y). At a corner its degree is exactly the height of
the corner, on a vertical edge the greatest; it is constant beyond the first and the last; and
between two corners (x₀, y₀) and (x₁, y₁) it is

    max(0, y + (x − x') s)    with    s = (y₁ − y₀) / (x₁ − x₀),

taken from (x', y): the foot of the line if one end is 0, so that the degree vanishes exactly
there, else its upper end. Every operation is rounded once, to the nearest double.

The engine for one point, that for arrays, the kernel in a loop, and the programs in C, Structured
Text and JavaScript all use it, so they agree to the bit wherever a rounding decides.

The samples of an output's set are precomputed numbers shared by all engines. They use linear
interpolation, y + (y' − y) (x − x₀) / (x₁ − x₀), as by hand (:func:`sampled_degrees`): the
published runs were recorded with them.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

Corner = tuple[float, float]


class StraightLine(NamedTuple):
    """A straight line: max(0, height + (x − x_0) slope)."""

    height: float
    x_0: float
    slope: float

    def at(self, x: float) -> float:
        """Return the degree on the line."""
        return max(0.0, self.height + (x - self.x_0) * self.slope)


class StraightShape(NamedTuple):
    """A piecewise linear shape.

    Attributes
    ----------
    edges : tuple of float
        Positions of its corners, ascending, each once.
    heights : tuple of float
        The degrees there.
    between : tuple of StraightLine
        Before the first edge, between neighbours, after the last.
    """

    edges: tuple[float, ...]
    heights: tuple[float, ...]
    between: tuple[StraightLine, ...]

    def at(self, x: float) -> float:
        """Return the degree at a position."""
        edges = self.edges
        i = bisect_left(edges, x)
        if i < len(edges) and edges[i] == x:
            return self.heights[i]
        height, x_0, slope = self.between[i]
        return max(0.0, height + (x - x_0) * slope) if slope else height

    def over(self, x: Any) -> Any:
        """Return the degrees at the positions in an array."""
        import numpy as np

        first, last = self._sloping_ends()
        values = np.empty(np.shape(x))
        values[...] = _over_line(self.between[last], x)
        for i in range(last - 1, -1, -1):
            edge, line = self.edges[i], self.between[i]
            if i >= first:
                np.copyto(values, _over_line(line, x), where=x < edge)
            if self.heights[i] != self.between[i + 1].at(edge):
                np.copyto(values, self.heights[i], where=x == edge)
        return values

    def _sloping_ends(self) -> tuple[int, int]:
        """Return the first and last line needed: a line with its foot at an edge is not."""
        first, last = 0, len(self.between) - 1
        if last > 1:
            first += self.between[0].height == 0.0 and self._begins(1, 0)
            last -= self.between[last].height == 0.0 and self._begins(last - 1, -1)
        return first, last

    def _begins(self, line: int, edge: int) -> bool:
        """Whether a line has its foot at an edge where the degree is 0."""
        height, x_0, slope = self.between[line]
        foot = height == 0.0 and slope != 0.0 and x_0 == self.edges[edge]
        return foot and self.heights[edge] == 0.0


def _over_line(line: StraightLine, x: Any) -> Any:
    import numpy as np

    height, x_0, slope = line
    if slope == 0.0:
        return height
    heights = np.subtract(x, x_0, out=np.empty(np.shape(x)))
    heights *= slope
    if height != 0.0:
        heights += height
    return np.maximum(heights, 0.0, out=heights)


def lines_through(corners: Sequence[Corner]) -> StraightShape:
    """Return the lines through corners.

    Parameters
    ----------
    corners : sequence of (float, float)
        From left to right; at a common position the greatest height counts.
    """
    edges: list[float] = []
    heights: list[float] = []
    between = [StraightLine(corners[0][1], 0.0, 0.0)]
    for x, y in corners:
        if edges and edges[-1] == x:
            heights[-1] = max(heights[-1], y)
        else:
            edges.append(x)
            heights.append(y)
    between += [_line(*a, *b) for a, b in pairwise(corners) if a[0] != b[0]]
    between.append(StraightLine(corners[-1][1], 0.0, 0.0))
    return StraightShape(tuple(edges), tuple(heights), tuple(between))


def _line(x_0: float, y_0: float, x_1: float, y_1: float) -> StraightLine:
    """Return the line between two corners in order."""
    slope = (y_1 - y_0) / (x_1 - x_0)
    if not abs(slope) < math.inf:  # a vertical edge: closer than 1e-308
        return StraightLine(max(y_0, y_1), 0.0, 0.0)
    if (slope < 0.0) == (min(y_0, y_1) == 0.0):
        return StraightLine(y_1, x_1, slope)
    return StraightLine(y_0, x_0, slope)


def degree_on_corners(corners: Sequence[float], x: float) -> float:
    """Return the same degree from corners (x, y, x, y …): for rows with variable numbers.

    Simple enough for a compiler, and for the translator to JavaScript.
    """
    count = len(corners) // 2
    after, end = 0, count  # bisection for the first corner at or after x
    while after < end:
        middle = (after + end) // 2
        if corners[2 * middle] < x:
            after = middle + 1
        else:
            end = middle
    if after == count:
        return corners[2 * count - 1]
    height = corners[2 * after + 1]
    if corners[2 * after] == x:
        while after + 1 < count and corners[2 * after + 2] == x:
            after += 1
            height = max(height, corners[2 * after + 1])
        return height
    if after == 0:
        return height
    x_0, y_0, x_1 = corners[2 * after - 2], corners[2 * after - 1], corners[2 * after]
    slope = (height - y_0) / (x_1 - x_0)
    if not abs(slope) < math.inf:
        return max(y_0, height)
    if (slope < 0.0) == (min(y_0, height) == 0.0):
        return max(0.0, height + (x - x_1) * slope)
    return max(0.0, y_0 + (x - x_0) * slope)


def sampled_degrees(corners: Sequence[Corner], positions: Sequence[float]) -> list[float]:
    """Return the degrees of a set at its samples.

    Parameters
    ----------
    corners : sequence of (float, float)
        From left to right; at a common position the greatest height counts.
    positions : sequence of float
        Ascending.
    """
    lines = lines_through(corners)
    ends = [(a, b) for a, b in pairwise(corners) if a[0] != b[0]]
    values = []
    i = 0  # first edge at or after the sample
    for x in positions:
        while i < len(lines.edges) and lines.edges[i] < x:
            i += 1
        if i < len(lines.edges) and lines.edges[i] == x:
            values.append(lines.heights[i])
        elif i in {0, len(lines.edges)}:
            values.append(lines.between[i].height)
        else:
            (x_0, y_0), (x_1, y_1) = ends[i - 1]
            low, high = min(y_0, y_1), max(y_0, y_1)
            way = x - x_0 if y_0 <= y_1 else x_1 - x
            values.append(min(high, low + (high - low) * way / (x_1 - x_0)))
    return values
