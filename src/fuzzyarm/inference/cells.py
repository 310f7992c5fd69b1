"""An input as the cells of the kernel.

Between two corners every straight term is one line, so a cell lists its nonzero lines. A corner at
which the line on its right has another degree (a vertical edge, a peak missed by rounding) gets a
cell of its own, one float wide. Even buckets lead from a value to its cell.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

from fuzzyarm.symbolic.lines import StraightLine, StraightShape

# ── the lines between corners ──────────────────────────────────────────────────


class Partition(NamedTuple):
    """A variable cut at corners; terms are numbered."""

    edges: list[float]  # the corners, ascending
    # Before the first edge, between neighbours, after the last: the nonzero lines.
    cells: list[dict[int, StraightLine]]
    at: list[dict[int, float]]  # at each edge: the nonzero degrees
    # Edges at which a line on their right has another degree: vertical edges, and peaks missed by
    # rounding.
    apart: set[float]


def cut_at_corners(terms: Sequence[tuple[int, StraightShape]]) -> Partition:
    """Cut a variable at the corners of some terms."""
    edges = sorted({edge for _, lines in terms for edge in lines.edges})
    index_of = {edge: i for i, edge in enumerate(edges)}
    cells: list[dict[int, StraightLine]] = [{} for _ in range(len(edges) + 1)]
    at: list[dict[int, float]] = [{} for _ in edges]
    apart: set[float] = set()
    for number, lines in terms:
        indices = [index_of[edge] for edge in lines.edges]
        for line, first, last in zip(
            lines.between, [-1, *indices], [*indices, len(edges)], strict=True
        ):
            if line.height == 0.0 and line.slope == 0.0:
                continue
            for cell in range(first + 1, last + 1):
                cells[cell][number] = line
            for i in range(first + 1, last):  # corners of other terms
                at[i][number] = line.at(edges[i])
        for i, height, behind in zip(indices, lines.heights, lines.between[1:], strict=True):
            if height != 0.0:
                at[i][number] = height
            if behind.at(edges[i]) != height:
                apart.add(edges[i])
    return Partition(edges, cells, at, apart)


# ── cells and buckets ──────────────────────────────────────────────────────────

FINENESS = 8
"""Most buckets for each cell."""


class InputCells(NamedTuple):
    """The cells of an input."""

    # Ascending; cell i reaches from edge i up to, but not at, edge i + 1. The first and the last
    # are infinite.
    edges: tuple[float, ...]
    # For each cell its nonzero propositions, by their number.
    lines: tuple[dict[int, StraightLine], ...]
    # ``int((x − first) scale)`` is the bucket of x, clamped to 0 … buckets − 1.
    first: float
    scale: float
    starts: tuple[int, ...]  # first cell of the search, for each bucket


def cut_into_cells(
    propositions: Sequence[tuple[int, StraightShape]], low: float, high: float
) -> InputCells:
    """Cut an input at the corners of its straight propositions."""
    cut = cut_at_corners(propositions)
    edges, lines = [-math.inf], [cut.cells[0]]
    for edge, degrees, cell in zip(cut.edges, cut.at, cut.cells[1:], strict=True):
        parts = [(edge, cell)]
        if edge in cut.apart:
            constants = {
                number: StraightLine(degree, 0.0, 0.0) for number, degree in degrees.items()
            }
            parts = [(edge, constants), (math.nextafter(edge, math.inf), cell)]
        for start, lines_here in parts:
            # Inputs are in the range. A corner may be the next float after another one with a cell
            # of its own. The end of the range has such a cell where the lines before it round to
            # another degree.
            if start <= low or start == edges[-1]:
                lines[-1] = lines_here
            elif start < high or (start == high and not _reaches(lines[-1], degrees, high)):
                edges.append(start)
                lines.append(lines_here)
    first, scale, buckets = _buckets([*edges, math.inf])
    return InputCells((*edges, math.inf), tuple(lines), first, scale, buckets)


def _lag(shares: list[float], count: int) -> float:
    """Return the offsets of edges from the left end of their bucket, in widths of the range."""
    total = 0.0
    for share in shares:
        place = share * count
        total += max(place - math.floor(place + 1e-9), 0.0)
    return total / count


def _reaches(lines: dict[int, StraightLine], degrees: dict[int, float], x: float) -> bool:
    """Return whether lines have exactly these degrees at a position."""
    values = {number: degree for number, line in lines.items() if (degree := line.at(x)) != 0.0}
    return values == {number: degree for number, degree in degrees.items() if degree != 0.0}


def _buckets(edges: list[float]) -> tuple[float, float, tuple[int, ...]]:
    """Return the even buckets with the fewest steps from their first cell to the right one."""
    inner = edges[1:-1]
    if not inner:
        return 0.0, 0.0, (0,)
    if len(inner) == 1:  # two cells, a bucket each: a branch between them would be unpredictable
        width = max(1.0, abs(inner[0]))
        return inner[0] - width, 1.0 / width, (0, 1)
    first, width = inner[0], inner[-1] - inner[0]
    if not math.isfinite(width / (FINENESS * len(inner))) or not width > 0.0:
        return 0.0, 0.0, (0,)

    # Among equally good numbers of buckets the smallest counts.
    shares = [(edge - first) / width for edge in inner[:-1]]
    count = min(range(len(inner) - 1, FINENESS * len(inner)), key=partial(_lag, shares))
    starts = [0]  # the first bucket holds all values below, the last all above
    for bucket in range(count + 1):
        left = first + (bucket + 1e-9) / count * width
        starts.append(bisect_right(inner, left))
    return first - width / count, count / width, tuple(starts)
