"""Rule bases over many boxes of inputs: a plane through their values, and the band around it.

On each exact piece of a rule base (:mod:`.rules`) an output is N/D. The part of a piece that a box
may meet lies in the smaller simplex of shares λᵢ ≥ aᵢ, whose corners have the shares W. There the
coefficients of a polynomial are those of its tensor, W applied to each index, and for a plane with
the values Lⱼ at the corners

    u - k·x = (N - L D) / D,    (N - L D)_γ = N_γ - Σⱼ γⱼ/d · Lⱼ D_{γ - eⱼ},    |γ| = d,

so that no value exceeds the largest quotient of coefficients. Any plane is sound; least squares
over the corners make the band narrow.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import combinations_with_replacement, pairwise
from itertools import product as every
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.proof.check.numbers import SpanError
from fuzzyarm.proof.check.polynomials import coefficients
from fuzzyarm.proof.check.rules import RuleSurface
from fuzzyarm.proof.check.spans import Spans, Vector

OFF = 2.0**-42
"""Error per largest coefficient: 2,000 roundings, more than converting and cutting take."""

BEYOND = 2.0**-36
"""Widening of a share, so that no rounding leaves a gap between a box and a piece."""

MOST_PAIRS = 20_000
"""Pairs of a box and a piece that are evaluated at once."""


class RuleBands:
    """One output of a rule base, for many boxes of inputs.

    Parameters
    ----------
    surface : RuleSurface
        With its exact pieces.

    Attributes
    ----------
    why : str
        Why the last box without a result had none.
    """

    def __init__(self, surface: RuleSurface) -> None:
        self.surface, self.why = surface, ""
        cuts = surface.grid
        pieces = [
            piece
            for cell in every(*(range(max(len(ends) - 1, 1)) for ends, _, _ in cuts))
            for piece in surface.pieces_of(cell)
            if not piece.is_flat
        ]
        if not pieces:
            raise SpanError(f"'{surface.name}' has no pieces")
        self.variables = surface.rulebase.inputs
        self.jumps = [np.array([float(x) for x, jump in zip(ends, steps, strict=True) if jump])
                      for ends, steps, _ in cuts]  # fmt: skip
        self.ends = [(float(ends[0]), float(ends[-1])) for ends, _, _ in cuts]
        self.faulty = np.array([bool(piece.piece.fault) for piece in pieces])
        self.corners = np.array([[[float(x) for x in corner] for corner in piece.piece.corners]
                                 for piece in pieces])  # fmt: skip
        self.gradient = np.array([[[float(x) for x in row] for row in piece.gradient]
                                  for piece in pieces])  # fmt: skip
        self.count, self.size = self.corners.shape[1:]  # corners, inputs
        good = [piece.piece for piece in pieces if not piece.piece.fault]
        degrees = [(int(p.lower.total_degree()), int(p.upper.total_degree()) - 1) for p in good]
        below = max(map(max, degrees), default=1)
        self.degree = below + 1
        shape = (len(pieces), *(self.count,) * below)
        self.lower, self.upper = np.ones(shape), np.zeros((*shape, self.count))
        for row, piece in enumerate(pieces):
            if not piece.piece.fault:
                self.lower[row] = self._tensor(piece.piece.lower, below)
                self.upper[row] = self._tensor(piece.piece.upper, self.degree)
        flat = (len(pieces), -1)
        self.sizes = (np.abs(self.upper.reshape(flat)).max(axis=1),
                      np.abs(self.lower.reshape(flat)).max(axis=1))  # fmt: skip

    def _tensor(self, polynomial: Any, degree: int) -> Vector:
        """Return the symmetric tensor of a homogeneous polynomial, raised to a degree."""
        found = coefficients(polynomial, degree)
        tensor = np.zeros((self.count,) * degree)
        for index in np.ndindex(*tensor.shape):
            powers = tuple(index.count(k) for k in range(self.count))
            ways = math.factorial(degree) // math.prod(map(math.factorial, powers))
            tensor[index] = float(found.get(powers, 0) / ways)
        return tensor

    @cached_property
    def _lattice(self) -> tuple[list[tuple[int, ...]], Vector, NDArray[np.int64]]:
        """For each coefficient: an index of its tensor, γⱼ/d, and the coefficient of γ − eⱼ."""
        below = list(combinations_with_replacement(range(self.count), self.degree - 1))
        above = list(combinations_with_replacement(range(self.count), self.degree))
        positions = {index: k for k, index in enumerate(below)}
        shares = np.zeros((len(above), self.count))
        sources = np.zeros((len(above), self.count), dtype=np.int64)
        for row, index in enumerate(above):
            for corner in set(index):
                rest = list(index)
                rest.remove(corner)
                shares[row, corner] = index.count(corner) / self.degree
                sources[row, corner] = positions[tuple(rest)]
        return above, shares, sources

    # --- questions ---

    def band(self, inputs: Sequence[Spans]) -> tuple[list[Vector], Vector, Vector]:
        """Return slopes of planes over boxes, and bounds of the output minus the plane.

        The bounds are infinite where a term jumps, the output has no value, or the box is far off.
        """
        shape = np.broadcast_shapes(*(x.low.shape for x in inputs))
        low, high = (np.stack([np.broadcast_to(end, shape) for end in ends])
                     for ends in ([x.low for x in inputs], [x.high for x in inputs]))  # fmt: skip
        lost = ~np.isfinite(low).all(axis=0) | ~np.isfinite(high).all(axis=0)
        for k, (variable, (first, last)) in enumerate(zip(self.variables, self.ends, strict=True)):
            if variable.outside == "clamp":  # clamped inputs are never outside
                low[k], high[k] = np.clip(low[k], first, last), np.clip(high[k], first, last)
            beyond = ~((low[k] >= first) & (high[k] <= last))
            jumps = np.zeros(shape, dtype=bool)
            for position in self.jumps[k]:
                jumps |= (low[k] <= position) & (position <= high[k])
            if beyond.any():
                self.why = f"'{variable.name}' may be outside its range, where nothing is known"
            if jumps.any():
                self.why = f"a term of '{self.surface.name}' has a vertical edge: jumps"
            lost |= beyond | jumps
        slopes = np.zeros((self.size, *shape))
        least, most = np.full(shape, -np.inf), np.full(shape, np.inf)
        known = np.flatnonzero(~lost)
        for part in self._parts(low, high, known):
            with np.errstate(all="ignore"):
                found = self._band(low[:, part], high[:, part])
            slopes[:, part], least[part], most[part] = found
        return list(slopes), least, most

    def _parts(self, low: Vector, high: Vector, known: NDArray[np.int64]) -> Sequence[Any]:
        """Return the known boxes in groups with a limited number of pairs with pieces."""
        if not len(known):
            return []
        met = self._met(low[:, known], high[:, known]).sum(axis=1)
        ends = np.searchsorted(np.cumsum(met), np.arange(0, met.sum() + MOST_PAIRS, MOST_PAIRS))
        return [known[a:b] for a, b in pairwise(np.unique([*ends, 0, len(known)])) if a < b]

    def _met(self, low: Vector, high: Vector) -> NDArray[np.bool_]:
        """Return which boxes may meet which pieces, by their bounding boxes; (boxes, pieces)."""
        met = np.ones((low.shape[1], len(self.corners)), dtype=bool)
        for k in range(self.size):
            first, last = self.corners[:, :, k].min(axis=1), self.corners[:, :, k].max(axis=1)
            more = BEYOND * (np.abs(first) + np.abs(last))
            met &= (low[k][:, None] <= last + more) & (high[k][:, None] >= first - more)
        return met

    def _band(self, low: Vector, high: Vector) -> tuple[Vector, Vector, Vector]:
        boxes = low.shape[1]
        box, piece = np.nonzero(self._met(low, high))
        shares = self._least_shares(low[:, box], high[:, box], piece)
        room = 1.0 - shares.sum(axis=1)
        here = (room > -BEYOND) & np.isfinite(room)
        box, piece, shares, room = box[here], piece[here], shares[here], room[here]
        faulty = np.zeros(boxes, dtype=bool)
        np.logical_or.at(faulty, box, self.faulty[piece])
        # The corners of the smaller simplex: one share gets all of the remainder, rounded up.
        left = room + self.count * BEYOND
        corners = shares[:, None, :] - BEYOND + left[:, None, None] * np.eye(self.count)
        upper = _in_new_corners(self.upper[piece], corners)
        lower = _in_new_corners(self.lower[piece], corners)
        index, parts, sources = self._lattice
        upper = _entries(upper, index)
        below = list(combinations_with_replacement(range(self.count), self.degree - 1))
        lower = _entries(lower, below)
        spread = lower[:, sources] * parts  # (pairs, coefficients, corners)
        raised = spread.sum(axis=2)
        positions = corners @ self.corners[piece]  # (pairs, corners, inputs)
        ends = [index.index((k,) * self.degree) for k in range(self.count)]
        heights = upper[:, ends] / raised[:, ends]
        slopes = self._planes(box, boxes, low, high, positions, heights)
        line = _sum(positions[:, :, k] * slopes[k, box][:, None] for k in range(self.size))
        gap = upper - (spread * line[:, None, :]).sum(axis=2)
        reach = (np.abs(self.corners[piece]).max(axis=1).T * np.abs(slopes[:, box])).sum(axis=0)
        size = self.sizes[0][piece] + (reach + np.abs(line).max(axis=1)) * self.sizes[1][piece]
        doubt = OFF * self.sizes[1][piece]
        sure = (raised > 2.0 * doubt[:, None]).all(axis=1)
        found = gap / raised
        # Error of a quotient with inexact parts; the denominator is more than half of its value.
        off = 2.0 * (OFF * size[:, None] + doubt[:, None] * np.abs(found)) / raised
        least, most = np.full(boxes, np.inf), np.full(boxes, -np.inf)
        np.minimum.at(least, box, np.where(sure, (found - off).min(axis=1), -np.inf))
        np.maximum.at(most, box, np.where(sure, (found + off).max(axis=1), np.inf))
        nothing = faulty | ~(least <= most)
        if nothing.any():
            self.why = f"'{self.surface.name}' may have no value somewhere, or leave its range"
        return slopes, np.where(nothing, -np.inf, least), np.where(nothing, np.inf, most)

    def _least_shares(self, low: Vector, high: Vector, piece: NDArray[np.int64]) -> Vector:
        """Return least shares of boxes in pieces, rounded down; infinite if they are apart.

        λᵢ(x) = Σ gᵢₖ (xₖ − x₀ₖ), and 1 more for the corner x₀ itself.
        """
        gradient, origin = self.gradient[piece], self.corners[piece, 0]  # (pairs, corners, inputs)
        below, above = low.T - origin, high.T - origin
        ends = gradient * below[:, None, :], gradient * above[:, None, :]
        least, most = np.minimum(*ends).sum(axis=2), np.maximum(*ends).sum(axis=2)
        size = np.abs(gradient) * (np.abs(low.T) + np.abs(high.T) + np.abs(origin))[:, None, :]
        off = OFF * (1.0 + size.sum(axis=2))
        least[:, 0] += 1.0
        most[:, 0] += 1.0
        least, most = least - off, most + off
        apart = (most < 0.0).any(axis=1) | (least > 1.0).any(axis=1)
        return np.where(apart[:, None], np.inf, np.clip(least, 0.0, 1.0))

    def _planes(
        self, box: NDArray[np.int64], boxes: int, low: Vector, high: Vector, positions: Vector,
        heights: Vector,
    ) -> Vector:  # fmt: skip
        """Return slopes of planes near some points, by least squares: any are sound."""
        n = self.size
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        wide = np.array([last - first for first, last in self.ends])[:, None]
        half = np.maximum(half, 1e-9 * wide)
        near = (positions - middle.T[box][:, None, :]) / half.T[box][:, None, :]
        heights = np.where(np.isfinite(heights), heights, 0.0)
        columns = np.concatenate([near, np.ones((*near.shape[:2], 1))], axis=2)
        rows, right = np.zeros((boxes, n + 1, n + 1)), np.zeros((boxes, n + 1))
        every_corner = range(columns.shape[1])
        squares = _sum(columns[:, c, :, None] * columns[:, c, None, :] for c in every_corner)
        np.add.at(rows, box, squares)
        np.add.at(right, box, _sum(columns[:, c] * heights[:, c, None] for c in every_corner))
        rows += 1e-9 * np.eye(n + 1)
        solved = np.linalg.solve(rows, right[:, :, None])[:, :n, 0].T / half
        return np.where(np.isfinite(solved), solved, 0.0)


def _sum(terms: Iterable[Vector]) -> Vector:
    """Return a sum in a fixed order: a box's result does not depend on its neighbours."""
    return functools.reduce(np.add, terms)


def _in_new_corners(tensors: Vector, corners: Vector) -> Vector:
    """Return tensors in the coordinates of new corners: their shares applied to each index."""
    shape = tensors.shape
    for _ in shape[1:]:
        turned = corners @ tensors.reshape(shape[0], shape[1], -1)
        tensors = np.swapaxes(turned, 1, 2).reshape(shape)
    return tensors


def _entries(tensors: Vector, indices: Sequence[tuple[int, ...]]) -> Vector:
    """Return selected entries of each tensor."""
    positions = np.ravel_multi_index(tuple(np.transpose(indices)), tensors.shape[1:])
    return np.asarray(tensors.reshape(len(tensors), -1)[:, positions])
