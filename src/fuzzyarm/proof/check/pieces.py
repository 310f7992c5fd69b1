"""A simplex of inputs with an output as quotient of two polynomials, and its bounds."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

from flint import arb, fmpq, fmpq_mat

from fuzzyarm.proof.check.numbers import ONE, ZERO, Number
from fuzzyarm.proof.check.polynomials import (
    Polynomial,
    Vector,
    bounds_of,
    dot,
    first_coefficient,
    is_not_negative,
    moved,
    plus,
    ratio,
    ring_of,
)
from fuzzyarm.proof.claim.problem import LoopProofError

GRID = 1 << 20
"""Resolution to which shares of a simplex are rounded."""


class Piece(NamedTuple):
    """A simplex and an output on it, ``upper / lower``; `fault`: why it has no value."""

    corners: tuple[Vector, ...]
    upper: Polynomial
    lower: Polynomial
    fault: str = ""


class BoundedPiece:
    """A piece of full dimension with bounds of value and slopes, computed on demand."""

    def __init__(self, piece: Piece) -> None:
        self.piece = piece
        axes = range(len(piece.corners[0]))
        gradient = gradients_of(piece, axes)
        self.is_flat = gradient is None
        if gradient is not None:
            self.gradient = gradient
            # λᵢ(x) = Σ gᵢₖ (xₖ − x₀ₖ), and 1 more for the corner x₀ itself.
            self.origin = piece.corners[0]

    def shares(self, box: Sequence[Number]) -> list[tuple[Number, Number]] | None:
        """Return bounds of the barycentric coordinates of a box; None if it misses the piece."""
        if self.is_flat:
            return None
        away = [arb(x) - arb(x0) for x, x0 in zip(box, self.origin, strict=True)]
        found = []
        for k, row in enumerate(self.gradient):
            share = arb(int(k == 0))
            for x, weight in zip(away, row, strict=True):
                share += x * weight
            low, high = share.lower(), share.upper()
            if high < 0 or low > 1:
                return None
            found.append((low if low > 0 else arb(0), high if high < 1 else arb(1)))
        return found

    def bounds(
        self,
        axes: Sequence[int],
        shares: Sequence[tuple[Number, Number]],
        box: Sequence[Number],
    ) -> tuple[Number, list[Number]]:
        """Return bounds of the value, and of slopes along some axes, for bounds of the shares."""
        if not axes and all((high - low) * GRID < 1 for low, high in shares):  # a point
            upper, lower = (bounds_of(terms, shares) for terms in self._terms)
            return (upper / lower if lower > 0 else self._whole[0]), []
        if self.constant is not None:
            away = tuple(arb(x) - x0 for x, x0 in zip(box, self.origin, strict=True))
            value = self._whole[2] + dot(away, self.constant)
            return value, [self.constant[axis] for axis in axes]
        small, _, size = self._smaller(shares)
        upper, lower = (p.compose(*small) for p in (self.piece.upper, self.piece.lower))
        part, area = Piece(self.piece.corners, upper, lower), lower * lower * size
        slopes = [ratio(slope_along(part, self.gradient, axis), area) for axis in axes]
        return ratio(upper, lower), slopes

    @cached_property
    def constant(self) -> Vector | None:
        """The slopes, if they are constant over the piece."""
        slopes = self._whole[1]
        return tuple(slopes) if all(isinstance(slope, fmpq) for slope in slopes) else None

    def _smaller(
        self, shares: Sequence[tuple[Number, Number]]
    ) -> tuple[list[Polynomial], list[Vector], fmpq]:
        """Return λ by μ in the subsimplex λᵢ ≥ aᵢ, λ = a + (1 − Σ a) μ, its corners, 1 − Σ a."""
        steps = (int((low * GRID).floor().unique_fmpz()) - 1 for low, _ in shares)
        lows = [fmpq(max(step, 0), GRID) for step in steps]
        size = ONE - sum(lows, ZERO)
        if size <= 0:  # empty but for rounding
            size, lows = ONE, [ZERO] * len(lows)
        units = ring_of(len(shares))[1]
        unit = sum(units)
        small = [unit * a + x * size for a, x in zip(lows, units, strict=True)]
        whole = list(zip(*self.piece.corners, strict=True))
        base = tuple(dot(tuple(lows), axis) for axis in whole)
        corners = [
            tuple(b + size * x for b, x in zip(base, corner, strict=True))
            for corner in self.piece.corners
        ]
        return small, corners, size

    @cached_property
    def _terms(self) -> list[list[tuple[Any, Number]]]:
        return [[(powers, arb(x)) for powers, x in p.to_dict().items()]
                for p in (self.piece.upper, self.piece.lower)]  # fmt: skip

    @cached_property
    def _whole(self) -> tuple[Number, list[Number], fmpq]:
        """Bounds of value and slopes over the piece, and the value at its first corner."""
        piece, axes = self.piece, range(len(self.gradient[0]))
        area = piece.lower * piece.lower
        slopes = [ratio(slope_along(piece, self.gradient, axis), area) for axis in axes]
        up, down = (first_coefficient(p.to_dict()) for p in (piece.upper, piece.lower))
        return ratio(piece.upper, piece.lower), slopes, up / down


def is_within(piece: Piece, low: fmpq, high: fmpq) -> bool:
    """Return whether the output is proved to lie between two numbers on a piece."""
    return is_not_negative(plus(piece.upper, piece.lower, -low)) and is_not_negative(
        plus(piece.lower * high, piece.upper, -ONE)
    )


def sides_of(piece: Piece, row: Vector) -> list[Piece]:
    """Return a piece, or its parts on both sides of σ = 0."""
    waiting, parts = [piece], []
    while waiting:
        part = waiting.pop()
        sums = [dot(row, corner) for corner in part.corners]
        low, high = min(sums), max(sums)
        if low >= 0 or high <= 0:
            parts.append(part)
            continue
        i, j = sums.index(low), sums.index(high)
        share = sums[i] / (sums[i] - sums[j])  # of the way from corner i to corner j
        for stays, moves, way in ((i, j, share), (j, i, ONE - share)):
            corners = list(part.corners)
            corners[moves] = tuple(
                (ONE - way) * a + way * b
                for a, b in zip(corners[stays], corners[moves], strict=True)
            )
            polynomials = (moved(p, stays, moves, way) for p in (part.upper, part.lower))
            waiting.append(Piece(tuple(corners), *polynomials))
    return parts


def gradients_of(piece: Piece, axes: Sequence[int]) -> list[Vector] | None:
    """Return ∂λᵢ/∂x along some axes, from Σ λᵢ vᵢ = x and Σ λᵢ = 1; None for a flat simplex."""
    size = len(piece.corners)
    if len(axes) != size - 1:
        raise LoopProofError("a piece of another dimension than its inputs")
    rows = [[corner[k] for corner in piece.corners] for k in axes]
    whole = fmpq_mat([*rows, [ONE] * size])
    if not whole.det():
        return None
    inverse = whole.inv()
    return [tuple(inverse[i, k] for k in range(size - 1)) for i in range(size)]


def slope_along(piece: Piece, gradient: Sequence[Vector], axis: int) -> Polynomial:
    """Return ∂N D − N ∂D along an axis."""
    ring, _ = ring_of(len(piece.corners))
    along = []
    for p in (piece.upper, piece.lower):
        parts = (p.derivative(i) * row[axis] for i, row in enumerate(gradient))
        along.append(sum(parts, ring.constant(ZERO)))
    return along[0] * piece.lower - piece.upper * along[1]
