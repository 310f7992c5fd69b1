"""The terms of one variable that hold at a place, found by bisection.

At a place only a few terms of a variable are not zero. Straight terms are therefore cut
at all their corners once; a value then finds its cell and evaluates that cell's lines.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

from fuzzyarm.inference.profile import LINEAR_HEDGES, polyline
from fuzzyarm.rulebase.model import Hedge, Shape
from fuzzyarm.rulebase.shapes import SHAPES

Degree = tuple[int, float]


class Proposition(NamedTuple):
    """A term with its hedges, under the number that rules know it by."""

    number: int
    shape: Shape
    hedges: tuple[Hedge, ...]
    function: Callable[[float], float]


class Partition:
    """The propositions about one variable.

    Parameters
    ----------
    propositions : sequence of Proposition
        In any order.
    """

    def __init__(self, propositions: Sequence[Proposition]) -> None:
        self._all = tuple((each.number, each.function) for each in propositions)
        straight = [each for each in propositions if is_straight(each.shape, each.hedges)]
        self._curved = tuple(
            (each.number, each.function) for each in propositions if each not in straight
        )
        corners = {each.number: polyline(each.shape) for each in straight}
        self._edges = sorted({x for line in corners.values() for x, _ in line})
        self._cells = [
            tuple(
                (each.number, *line)
                for each in straight
                if (line := line_at(corners[each.number], each.hedges, place)) is not None
            )
            for place in inside(self._edges)
        ]

    def at(self, x: float) -> list[Degree]:
        """Return (number, degree) of every proposition that is not zero at `x`."""
        edges = self._edges
        i = bisect_right(edges, x)
        if i and edges[i - 1] == x:  # a vertical edge belongs to the set: ask the shape itself
            return [(n, degree) for n, f in self._all if (degree := f(x)) > 0.0]
        found = [
            (n, degree)
            for n, x0, y0, slope in self._cells[i]
            if (degree := y0 + (x - x0) * slope) > 0.0
        ]
        if self._curved:
            found += [(n, degree) for n, f in self._curved if (degree := f(x)) > 0.0]
        return found


def is_straight(shape: Shape, hedges: Sequence[Hedge]) -> bool:
    """Whether a proposition consists of straight lines, hedges included."""
    if shape.kind == "singleton" or not SHAPES[shape.kind].piecewise_linear:
        return False
    return all(hedge.name in LINEAR_HEDGES for hedge in hedges)


def inside(edges: list[float]) -> list[float]:
    """Return one place inside each cell, the outer two included."""
    if not edges:
        return [0.0]
    between = [0.5 * (a + b) for a, b in pairwise(edges)]
    return [edges[0] - 1.0 - abs(edges[0]), *between, edges[-1] + 1.0 + abs(edges[-1])]


def line_at(
    corners: list[tuple[float, float]], hedges: Sequence[Hedge], place: float
) -> tuple[float, float, float] | None:
    """Return (x0, y0, slope) of the line around `place`; None where it is zero."""
    if place <= corners[0][0]:
        x0, y0, slope = 0.0, corners[0][1], 0.0
    elif place >= corners[-1][0]:
        x0, y0, slope = 0.0, corners[-1][1], 0.0
    else:
        i = next(i for i, (x, _) in enumerate(corners) if x > place)
        (x0, y0), (x1, y1) = corners[i - 1], corners[i]
        slope = (y1 - y0) / (x1 - x0)
        if slope < 0.0:  # fall towards the foot from the foot: no residue just before it
            x0, y0 = x1, y1
    for hedge in reversed(hedges):
        y0, slope = (1.0 - y0, -slope) if hedge.name == "not" else (1.0, 0.0)
    return None if y0 == 0.0 and slope == 0.0 else (x0, y0, slope)
