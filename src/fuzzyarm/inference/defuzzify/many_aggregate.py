"""The aggregate of one output at many points of the inputs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.membership import membership
from fuzzyarm.inference.plan import PLACE, Member, OutputPlan
from fuzzyarm.inference.sampling import places, weights
from fuzzyarm.inference.snorms import SNORMS
from fuzzyarm.inference.tnorms import TNORMS

Array = NDArray[np.float64]


class Strengths:
    """Firing strengths of the members of an output over a chunk of points.

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
        self._entries: list[tuple[int, Array]] = []
        self._place: dict[int, int] = {}
        self._owned: set[int] = set()

    def __iter__(self) -> Iterator[tuple[int, Array]]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def add(self, member: int, strength: Array) -> None:
        """Add the strength of one rule; it is not changed, but may be kept."""
        place = self._place.get(member)
        if not self._folded or place is None:
            self._place[member] = len(self._entries)
            self._entries.append((member, strength))
            return
        mine = self._entries[place][1]
        # On an open mesh a rule on more inputs has strengths of a larger shape.
        fits = np.broadcast_shapes(mine.shape, strength.shape) == mine.shape
        if member in self._owned and fits:
            np.maximum(mine, strength, out=mine)
        else:
            self._entries[place] = (member, np.maximum(mine, strength))
            self._owned.add(member)

    def flat(self) -> list[tuple[int, Array]]:
        """Return the entries as one-dimensional arrays over all points of the chunk."""
        return [
            (member, np.broadcast_to(strength, self.shape).ravel())
            for member, strength in self._entries
        ]

    def any_fired(self) -> NDArray[np.bool_]:
        """Return where at least one strength is above 0."""
        fired = np.zeros(self.shape, dtype=bool)
        for _, strength in self._entries:
            fired |= strength > 0.0
        return fired


def member_at(member: Member, places: Array) -> Array:
    """Return the membership of places in the set of a member."""
    return membership(member.term.shape, places, member.hedges, {PLACE: places})


def fold(plan: OutputPlan, entries: list[tuple[int, Array]]) -> dict[int, Array]:
    """Return one strength for each member: those of its rules under the aggregation."""
    norm = SNORMS[plan.output.aggregation]
    folded: dict[int, Array] = {}
    for member, strength in entries:
        folded[member] = norm(folded[member], strength) if member in folded else strength
    return folded


def aggregate_at(plan: OutputPlan, entries: list[tuple[int, Array]], places: Array) -> Array:
    """Return the aggregate of P points at places of their own.

    Parameters
    ----------
    plan : OutputPlan
        The output.
    entries : list of (int, ndarray of shape (P,))
        Member and strength.
    places : ndarray of shape (P, K)
        K places for each point.

    Returns
    -------
    ndarray of shape (P, K)
        The aggregate there.
    """
    norm = SNORMS[plan.output.aggregation]
    total = np.zeros(places.shape)
    low, high = places.min(axis=1), places.max(axis=1)
    for index, strength in entries:
        member = plan.members[index]
        start, end = _support(member)
        rows = np.flatnonzero((strength > 0.0) & (high >= start) & (low <= end))
        if not rows.size:
            continue
        part = slice(None) if rows.size == strength.size else rows
        degree = member_at(member, places[part])
        cut = TNORMS[member.implication](strength[part, None], degree)
        total[part] = norm(total[part], cut)
    return total


def _support(member: Member) -> tuple[float, float]:
    """Return the ends of the stretch outside which a set is zero."""
    inside = [piece for piece in member.pieces if piece.y0 > 0.0 or piece.y1 > 0.0]
    if not inside or any(not piece.straight for piece in member.pieces):
        return -np.inf, np.inf
    return inside[0].x0, inside[-1].x1


def aggregate_sampled(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the N sample places of the output and the aggregate there.

    The aggregate has the shape (points of the chunk, N). Only the stretch where a set is not
    zero is touched: 0 changes no aggregate.
    """
    output, count = plan.output, plan.output.defuzzifier.resolution
    assert count is not None
    samples = np.array(places(output.low, output.high, count, output.defuzzifier.sampling))
    norm = SNORMS[output.aggregation]
    total = np.zeros((int(np.prod(strengths.shape)), samples.size))
    for member, strength in strengths.flat():
        degree = member_at(plan.members[member], samples)
        where = np.flatnonzero(degree > 0.0)
        if not where.size:
            continue
        part = slice(where[0], where[-1] + 1)
        cut = TNORMS[plan.members[member].implication](strength[:, None], degree[None, part])
        total[:, part] = norm(total[:, part], cut)
    return samples, total


def sample_weights(plan: OutputPlan) -> Array:
    """Return what each sample counts in a sum, by the sampling of the output."""
    count = plan.output.defuzzifier.resolution
    assert count is not None
    return np.array(weights(count, plan.output.defuzzifier.sampling))


def sum_by_point(point: NDArray[np.intp], amounts: Array, count: int) -> Array:
    """Return the sum of the amounts of each of `count` points."""
    return np.bincount(point, amounts, minlength=count).astype(float, copy=False)
