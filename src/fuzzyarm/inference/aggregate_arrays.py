"""The aggregate of one output at many points of the inputs."""

from __future__ import annotations

from collections.abc import Iterator
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.aggregate import positions, sampled_set, weights
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.sets import BELOW_ONE, degrees, plateaus
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS

Array = NDArray[np.float64]

ArrayFigures = dict[str, Array]
"""Numbers of aggregates, by their names in :mod:`fuzzyarm.symbolic.defuzzifiers`."""


class Strengths:
    """Firing strengths of the members of an output over a chunk of points.

    They come in the order of the members where rules that share one are united, else in that of
    the rules, whichever of them fire in the chunk.

    Parameters
    ----------
    shape : tuple of int
        Of the chunk.
    folded : bool
        Whether rules that share a member are united by their maximum at once.
    """

    def __init__(self, shape: tuple[int, ...], *, folded: bool) -> None:
        self.shape = shape
        self._folded = folded
        self._entries: dict[int, tuple[int, Array]] = {}
        self._owned: set[int] = set()

    def __iter__(self) -> Iterator[tuple[int, Array]]:
        return iter([entry for _, entry in sorted(self._entries.items(), key=itemgetter(0))])

    def __len__(self) -> int:
        return len(self._entries)

    def add(self, contribution: int, member: int, strength: Array) -> None:
        """Add the strength of one rule; it is not changed, but may be kept.

        `contribution` is its number among what the rules say of the output.
        """
        key = member if self._folded else contribution
        if key not in self._entries:
            self._entries[key] = (member, strength)
            return
        mine = self._entries[key][1]
        # On an open mesh a rule on more inputs has strengths of a larger shape.
        fits = np.broadcast_shapes(mine.shape, strength.shape) == mine.shape
        if key in self._owned and fits:
            np.maximum(mine, strength, out=mine)
        else:
            self._entries[key] = (member, np.maximum(mine, strength))
            self._owned.add(key)

    def flat(self) -> list[tuple[int, Array]]:
        """Return the entries as one-dimensional arrays over all points of the chunk."""
        return [
            (member, np.broadcast_to(strength, self.shape).ravel()) for member, strength in self
        ]


def _member_at(member: Member, xs: Array) -> Array:
    """Return the membership of positions in the set of a member."""
    return degrees(member.term.shape, xs, member.hedges)


def fold_over_arrays(plan: OutputPlan, entries: list[tuple[int, Array]]) -> dict[int, Array]:
    """Return one strength for each member: those of its rules under the aggregation."""
    norm = SNORMS[plan.output.aggregation].array
    folded: dict[int, Array] = {}
    for member, strength in entries:
        folded[member] = norm(folded[member], strength) if member in folded else strength
    return dict(sorted(folded.items()))


def aggregate_over_arrays(plan: OutputPlan, entries: list[tuple[int, Array]], xs: Array) -> Array:
    """Return the aggregate of P points at positions of their own, both of shape (P, K)."""
    norm = SNORMS[plan.output.aggregation].array
    total = np.zeros(xs.shape)
    low, high = xs.min(axis=1), xs.max(axis=1)
    for index, strength in entries:
        member = plan.members[index]
        start, end = _support(member)
        rows = np.flatnonzero((strength > 0.0) & (high >= start) & (low <= end))
        if not rows.size:
            continue
        part = slice(None) if rows.size == strength.size else rows
        degree = _member_at(member, xs[part])
        implication = TNORMS[member.implication]
        if implication.leaves_ones:
            flat = [(xs[part] >= a) & (xs[part] <= b) for a, b in plateaus(member.pieces)]
            on_peak = ~np.logical_or.reduce(flat) if flat else True
            degree = np.where(on_peak, np.minimum(degree, BELOW_ONE), degree)
        cut = implication.array(strength[part, None], degree)
        total[part] = norm(total[part], cut)
    return total


def _support(member: Member) -> tuple[float, float]:
    """Return the ends of the stretch outside which a set is zero."""
    inside = [piece for piece in member.pieces if piece.y0 > 0.0 or piece.y1 > 0.0]
    if not inside or any(not piece.straight for piece in member.pieces):
        return -np.inf, np.inf
    return inside[0].x0, inside[-1].x1


def sampled_aggregate_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the N samples of the output and the aggregate there.

    The aggregate has the shape (N, points of the chunk). Only the stretch where a set is not
    zero is touched: 0 changes no aggregate.
    """
    output, count = plan.output, plan.output.defuzzifier.resolution
    assert count is not None
    samples = np.array(positions(output.low, output.high, count, output.defuzzifier.sampling))
    norm = SNORMS[output.aggregation].array
    total = np.zeros((samples.size, int(np.prod(strengths.shape))))
    for member, strength in strengths.flat():
        term, hedges, implication = plan.members[member][:3]
        sampled = sampled_set(term.shape, hedges, output.low, output.high, output.defuzzifier)
        degree = np.array(sampled.heights)[:, None]
        part = slice(sampled.first, sampled.first + len(degree))
        total[part] = norm(total[part], TNORMS[implication].array(strength, degree))
    return samples, total


def added_up_rows(rows: Array) -> Array:
    """Return the sum of the rows in their order, as :func:`.aggregate.added_up` does."""
    total = np.zeros(rows.shape[1])
    for row in rows:
        total += row
    return total


def sample_weights(plan: OutputPlan) -> Array:
    """Return what each sample counts in a sum, by the sampling of the output."""
    count = plan.output.defuzzifier.resolution
    assert count is not None
    return np.array(weights(count, plan.output.defuzzifier.sampling))
