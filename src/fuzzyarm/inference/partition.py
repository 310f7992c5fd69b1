"""A variable cut at the corners of its straight terms.

Between two corners every straight term is one line, so that a cell lists the lines that are not
zero there. The kernel reads the cut.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from fuzzyarm.symbolic.lines import StraightLine, StraightShape

__all__ = ["Partition", "cut_at_corners"]


class Partition(NamedTuple):
    """A variable cut at corners; terms are known by their number.

    Attributes
    ----------
    edges : list of float
        The corners, ascending.
    cells : list of dict of int to StraightLine
        In front of the first edge, between two of them, behind the last: the lines that are not
        zero there.
    at : list of dict of int to float
        At each edge: the degrees that are not zero.
    apart : set of float
        Edges at which a line on their right has not the degree: vertical edges, and peaks that
        a line misses by its rounding.
    """

    edges: list[float]
    cells: list[dict[int, StraightLine]]
    at: list[dict[int, float]]
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
