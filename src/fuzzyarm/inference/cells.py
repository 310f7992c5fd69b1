"""An input cut at the corners of its terms.

Between two corners every straight term is one line, so a cell lists the lines that are not
zero there. A corner with a vertical edge gets a cell of its own, as narrow as floats are:
the value there belongs to the set. Even buckets lead from a value to its cell.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fuzzyarm.inference.point import line_at
from fuzzyarm.inference.sets import term_function
from fuzzyarm.model.rulebase import Hedge, Shape
from fuzzyarm.model.shapes import polyline

Line = tuple[float, float, float]
"""y0, x0 and slope: y = y0 + (x − x0) slope."""

ZERO_LINE: Line = (0.0, 0.0, 0.0)

FINENESS = 8
"""Most buckets for each cell."""


class Cells(NamedTuple):
    """An input, cut up.

    Attributes
    ----------
    edges : tuple of float
        Ascending; cell i reaches from edge i up to, but not at, edge i + 1. The first and
        the last are infinite.
    lines : tuple of dict of int to Line
        For each cell, the propositions that are not zero there, by their number.
    first, scale : float
        ``int((x − first) scale)`` is the bucket of x, brought into 0 … buckets − 1.
    starts : tuple of int
        The cell where to begin to look, for each bucket.
    """

    edges: tuple[float, ...]
    lines: tuple[dict[int, Line], ...]
    first: float
    scale: float
    starts: tuple[int, ...]


def cut_into_cells(
    propositions: Sequence[tuple[int, Shape, Sequence[Hedge]]], low: float, high: float
) -> Cells:
    """Cut an input at the corners of its straight propositions.

    Parameters
    ----------
    propositions : sequence of (int, Shape, sequence of Hedge)
        Number, shape and hedges of each.
    low, high : float
        Values that can occur.

    Returns
    -------
    Cells
        All cells that hold values from `low` to `high`.
    """
    corners = [polyline(shape) for _, shape, _ in propositions]
    steps = {a[0] for line in corners for a, b in pairwise(line) if a[0] == b[0]}
    corner_points = sorted({x for line in corners for x, _ in line})
    edges = [-math.inf]
    for x in corner_points:
        if x in steps:
            edges += [x, math.nextafter(x, math.inf)]
        else:
            edges.append(x)
    edges = _within(sorted(set(edges[1:])), low, high, steps)
    reaches = [
        _reach(line, hedges) for line, (_, _, hedges) in zip(corners, propositions, strict=True)
    ]
    lines = []
    for left, right in pairwise(edges):
        left, right = max(left, low), min(right, high)  # noqa: PLW2901
        at_step = left in steps and right in {left, math.nextafter(left, math.inf)}
        cell: dict[int, Line] = {}
        middle = _between(left, right)
        for line, (begin, end), (number, shape, hedges) in zip(
            corners, reaches, propositions, strict=True
        ):
            if at_step:
                found: Line | None = (term_function(shape, tuple(hedges))(left), 0.0, 0.0)
            elif not begin < middle < end:
                continue
            else:
                found = _line(line, hedges, middle)
            if found is not None and found != ZERO_LINE:
                cell[number] = found
        lines.append(cell)
    first, scale, starts = _buckets(edges)
    return Cells(tuple(edges), tuple(lines), first, scale, starts)


def _within(edges: list[float], low: float, high: float, steps: set[float]) -> list[float]:
    """Drop the edges that no value passes."""
    inside = [x for x in edges if low < x < high or (x == high and x in steps)]
    return [-math.inf, *inside, math.inf]


def _reach(corners: list[tuple[float, float]], hedges: Sequence[Hedge]) -> tuple[float, float]:
    """Return between what a term may not be 0; most terms end soon."""
    (first, below), (last, above) = corners[0], corners[-1]
    begin = first if below == 0.0 and not hedges else -math.inf
    return begin, last if above == 0.0 and not hedges else math.inf


def _between(left: float, right: float) -> float:
    if math.isinf(left) and math.isinf(right):
        return 0.0
    if math.isinf(left):
        return right - 1.0 - abs(right)
    return left + 1.0 + abs(left) if math.isinf(right) else 0.5 * (left + right)


def _line(
    corners: list[tuple[float, float]], hedges: Sequence[Hedge], position: float
) -> Line | None:
    found = line_at(corners, hedges, position)
    return None if found is None else (found[1], found[0], found[2])


def _buckets(edges: list[float]) -> tuple[float, float, tuple[int, ...]]:
    """Return the even buckets that need the fewest steps from there to the cell."""
    inner = edges[1:-1]
    if len(inner) < 2:
        return 0.0, 0.0, (0,)
    first, width = inner[0], inner[-1] - inner[0]
    if not math.isfinite(width / (FINENESS * len(inner))) or not width > 0.0:
        return 0.0, 0.0, (0,)

    # How far edges stand from the left end of their bucket, in widths of the range, added up in
    # their order for each number of buckets; of equals the first counts.
    counts = np.arange(len(inner) - 1, FINENESS * len(inner))
    shares = (np.array(inner[:-1]) - first)[:, None] / width * counts
    late = np.maximum(shares - np.floor(shares + 1e-9), 0.0)
    lags = np.add.accumulate(late)[-1] / counts
    count = int(counts[np.argmin(lags)])
    starts = [0]  # the first bucket holds all that is below, the last all that is above
    for bucket in range(count + 1):
        left = first + (bucket + 1e-9) / count * width
        starts.append(bisect_right(inner, left))
    return first - width / count, count / width, tuple(starts)
