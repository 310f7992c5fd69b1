"""Where two clipped sets may cross: panels cut there leave the quadrature nothing to seek.

Over a straight piece a set cut at the strength w is one of a few straight lines
α + β μ(y): under min it is μ or w, under product w μ, under bounded μ + w − 1. Two sets
cross where two of these lines do.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from fuzzyarm.inference.profile import Piece

Forms = tuple[tuple[Any, Any], ...]
"""(α, β) for each line, floats or arrays."""

FORMS: dict[str, Callable[[Any], Forms]] = {
    "min": lambda w: ((0.0, 1.0), (w, 0.0)),
    "product": lambda w: ((0.0, w),),
    "bounded": lambda w: ((w - 1.0, 1.0),),
}
"""The lines of a set cut at a strength, by implication."""


class Stretch(NamedTuple):
    """Two members that are straight and not both zero from `start` to `end`.

    Attributes
    ----------
    first, second : int
        The members.
    start, end : float
        The stretch.
    first_start, first_end, second_start, second_end : float
        Their memberships at its ends.
    """

    first: int
    second: int
    start: float
    end: float
    first_start: float
    first_end: float
    second_start: float
    second_end: float


def stretches(profiles: Sequence[Sequence[Piece]]) -> tuple[Stretch, ...]:
    """Return the stretches over which two straight sets overlap."""
    found = []
    for i, pieces in enumerate(profiles):
        for j in range(i + 1, len(profiles)):
            for one in pieces:
                for other in profiles[j]:
                    start, end = max(one.x0, other.x0), min(one.x1, other.x1)
                    if start < end and _matters(one) and _matters(other):
                        ends = (*_between(one, start, end), *_between(other, start, end))
                        found.append(Stretch(i, j, start, end, *ends))
    return tuple(found)


def _matters(piece: Piece) -> bool:
    return piece.straight and (piece.y0 > 0.0 or piece.y1 > 0.0)


def _between(piece: Piece, start: float, end: float) -> tuple[float, float]:
    slope = (piece.y1 - piece.y0) / (piece.x1 - piece.x0)
    return piece.y0 + slope * (start - piece.x0), piece.y0 + slope * (end - piece.x0)


def gaps(stretch: Stretch, first: Forms, second: Forms) -> list[tuple[Any, Any]]:
    """Return by how much the first set is above the second at both ends, line by line.

    They cross where the two signs differ, at the share gap₀ / (gap₀ − gap₁) of the way.
    """
    _, _, _, _, a0, a1, b0, b1 = stretch
    return [
        (alpha + beta * a0 - gamma - delta * b0, alpha + beta * a1 - gamma - delta * b1)
        for alpha, beta in first
        for gamma, delta in second
    ]
