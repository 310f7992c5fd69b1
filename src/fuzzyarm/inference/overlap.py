"""The area and the moment of a union of clipped sets, in closed form.

Let the sets μ₁ … μₙ be piecewise linear, cut at the heights h₁ … hₙ; sought are area and moment of
A = max min(hₖ, μₖ). Between neighbouring corners and crossings of the sets their order is fixed,
say μ₁ ≥ μ₂ ≥ …; there, with Hₖ = max(h₁ … hₖ₋₁) and F(h) = ∫ min(h, μₖ),

    ∫ A = Σₖ F(hₖ) − F(min(hₖ, Hₖ)).

(For a level t between Hₖ and hₖ set k is the widest that reaches t, so it alone counts.) All the
integrals F of one argument merge into a piecewise quadratic for the area and a piecewise cubic for
the moment. So an inference needs no breakpoints, no sorting and no samples: it adds a few
polynomials of the heights. Where at most two sets overlap this is the sum of the clipped sets minus
the overlaps of neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from fuzzyarm.inference.sets import Piece

MOST_OVERLAPPING = 10
"""With more sets than this at one position the closed form grows too long."""

MOST_PIECES = 1_000
"""Pieces of one set; each has a share in each of as many layers."""

SAME_LEVEL = 1e-13
"""Corner heights closer than this are the same."""


class Layer(NamedTuple):
    """One stretch of the polynomials: with x = min(max(h − start, 0), depth),

    area = x (a1 + a2 x) and moment = x (b1 + x (b2 + b3 x)), the moment about the centre.
    """  # noqa: D400

    start: float
    depth: float
    a1: float
    a2: float
    b1: float
    b2: float
    b3: float


Layers = tuple[Layer, ...]


class Overlap(NamedTuple):
    """A subtrahend: `layers` at the smaller of hₖ and the greatest of the others."""

    member: int
    others: tuple[int, ...]
    layers: Layers


class ClosedForm(NamedTuple):
    """The union of clipped sets as polynomials of the heights."""

    centre: float  # middle of the range; moments are about it
    set_layers: tuple[Layers, ...]  # for each set
    overlaps: tuple[Overlap, ...]  # empty where the sets are summed instead of united


def closed_form(
    profiles: Sequence[Sequence[Piece]],
    low: float,
    high: float,
    *,
    united: bool = True,
    same_level: float = SAME_LEVEL,
) -> ClosedForm | None:
    """Return the closed form of the union (else the sum) of some sets over a range.

    None where a piece is not straight, a set has too many, or too many sets overlap. With 0 for
    `same_level` and pieces of exact numbers (``fractions.Fraction``) the coefficients are exact
    too.
    """
    if any(not piece.straight for pieces in profiles for piece in pieces):
        return None
    if any(len(pieces) > MOST_PIECES for pieces in profiles):
        return None
    centre = (low + high) / 2
    members_form = tuple(_layers(pieces, centre, same_level) for pieces in profiles)
    if not united:
        return ClosedForm(centre, members_form, ())
    stretches: dict[tuple[int, tuple[int, ...]], list[Piece]] = {}
    for cell in _cells(profiles):
        if len(cell) > MOST_OVERLAPPING:
            return None
        for ranked in _ordered(cell):
            members = [member for member, _ in ranked]
            for rank in range(1, len(ranked)):
                member, above = members[rank], tuple(sorted(members[:rank]))
                if len(above) == 1 and above[0] > member:  # min(h1, h2) in either order
                    member, above = above[0], (member,)
                stretches.setdefault((member, above), []).append(ranked[rank][1])
    overlaps = tuple(
        Overlap(member, above, _layers(lines, centre, same_level))
        for (member, above), lines in sorted(stretches.items())
    )
    return ClosedForm(centre, members_form, overlaps)


def _cells(profiles: Sequence[Sequence[Piece]]) -> list[list[tuple[int, Piece]]]:
    """Cut all sets at all corners; a cell lists its nonzero sets."""
    edges = sorted({x for pieces in profiles for piece in pieces for x in (piece.x0, piece.x1)})
    cells: list[list[tuple[int, Piece]]] = [[] for _ in edges[1:]]
    index_of = {x: i for i, x in enumerate(edges)}
    for member, pieces in enumerate(profiles):
        for piece in pieces:
            if piece.y0 <= 0.0 and piece.y1 <= 0.0:
                continue
            for i in range(index_of[piece.x0], index_of[piece.x1]):
                cells[i].append((member, piece.between(edges[i], edges[i + 1])))
    return cells


def _ordered(cell: list[tuple[int, Piece]]) -> list[list[tuple[int, Piece]]]:
    """Cut a cell where its lines cross; sort each part from the highest line down."""
    if len(cell) < 2:
        return []
    x0, x1 = cell[0][1].x0, cell[0][1].x1
    cuts = {x0, x1}
    for i, (_, first) in enumerate(cell):
        for _, second in cell[i + 1 :]:
            left, right = first.y0 - second.y0, first.y1 - second.y1
            if left * right < 0.0:
                x = x0 + (x1 - x0) * left / (left - right)
                if x0 < x < x1:
                    cuts.add(x)
    parts = []
    for a, b in pairwise(sorted(cuts)):
        lines = [(member, line.between(a, b)) for member, line in cell]
        lines.sort(key=lambda entry: (-(entry[1].y0 + entry[1].y1), entry[0]))
        parts.append(lines)
    return parts


def _layers(lines: Sequence[Piece], centre: float, same_level: float) -> Layers:
    levels = _levels(lines, same_level)
    layers = []
    for start, end in pairwise(levels):
        total = [0 * abs(centre)] * 5  # a zero of the number type of the lines
        for line in lines:
            for i, term in enumerate(_share(line, start, end, centre, same_level)):
                total[i] += term
        if any(total):
            layers.append(Layer(start, end - start, *total))
    return tuple(layers)


def _levels(lines: Sequence[Piece], same_level: float) -> list[float]:
    heights = sorted(y for line in lines for y in (line.y0, line.y1))
    levels = [0 * abs(heights[0])] if heights else [0.0]
    for y in heights:
        if y > levels[-1] + same_level:
            levels.append(y)
    return levels


def _share(
    line: Piece, start: float, end: float, centre: float, same_level: float
) -> tuple[float, float, float, float, float]:
    """Polynomials of one line between two levels: integrals over h of the part above h."""
    width = line.x1 - line.x0
    zero = 0 * width
    bottom, top = min(line.y0, line.y1), max(line.y0, line.y1)
    if top <= start + same_level:
        return (zero, zero, zero, zero, zero)
    if bottom >= end - same_level:  # the whole line is above this layer
        return (width, zero, width * ((line.x0 + line.x1) / 2 - centre), zero, zero)
    above_end, below_end = (line.x0, line.x1) if line.y0 > line.y1 else (line.x1, line.x0)
    anchor, half = above_end - centre, (below_end - above_end) / 2
    drop = top - bottom
    share = (top - start) / drop
    return (
        width * share,
        -width / (2 * drop),
        width * share * (anchor + half * share),
        -width * (anchor + 2 * half * share) / (2 * drop),
        width * half / (3 * drop * drop),
    )
