r"""From an interval type-2 set to its centroid, at one point: Karnik and Mendel, Nie and Tan.

The set is all memberships μ between a lower one L and an upper one U. Their centroids fill an
interval. Its right end belongs to the μ that is L on the left of some c and U on the right of
it, and c is that centroid (Karnik and Mendel). With

    φ(c) = (∫_{y<c} y L + ∫_{y>c} y U) / (∫_{y<c} L + ∫_{y>c} U)

no φ(c) is beyond the end, and where c is short of it, φ(c) is nearer: c ← φ(c) rises to it, each
step twice as many digits (it is Newton's on the root of F in :mod:`.centroid_bounds`, which
has the same bounds over arrays of panels, for proofs). The left end is the mirrored case. Over
samples, and over the values of Takagi and Sugeno, integrals are sums and the steps are finite.
Nie and Tan take the centroid of (L + U) / 2.

Where L is nothing anywhere, the ends are those of what U covers, to which the ends for a small L
go.

References
----------
N. N. Karnik, J. M. Mendel, *Centroid of a type-2 fuzzy set*, 2001.
M. Nie, W. W. Tan, *Towards an efficient type-reduction method for interval type-2 fuzzy logic
systems*, 2008.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzyarm.inference.aggregate import (
    Fired,
    added_up,
    aggregate,
    fold_at_point,
    sampled_aggregate_at_point,
    weights,
)
from fuzzyarm.inference.centroid import envelop_at_point, room_for_envelopes
from fuzzyarm.inference.envelope import STEPS, add_up, reach_end
from fuzzyarm.inference.firing_intervals import LOWER, UPPER
from fuzzyarm.inference.plan import OutputPlan
from fuzzyarm.inference.quadrature import Leaf, edges_of, leaves_at_point, noise_of
from fuzzyarm.symbolic.kernels import kernel

Interval = tuple[float, float]


def side_of(plan: OutputPlan, fired: Fired, side: int) -> Fired:
    """Return what fired for the upper or the lower set."""
    return [(member, strength) for member, strength in fired if plan.sides[member] == side]


def ends_at_point(
    plan: OutputPlan, fired: Fired, value_of: Callable[[int], float] | None = None
) -> Interval | None:
    """Return the two ends of the centroid of an output.

    Parameters
    ----------
    plan : OutputPlan
        Of an interval type-2 output.
    fired : sequence of (int, float)
        Member and firing strength of the readings that fired.
    value_of : callable, optional
        Gives the number of a member; for outputs of values only.

    Returns
    -------
    (float, float) or None
        None where nothing has an area, or a weight.
    """
    if plan.discrete:
        assert value_of is not None
        return _ends_of_values(plan, fired, value_of)
    if plan.output.defuzzifier.resolution is not None:
        return _ends_of_samples(plan, fired)
    return _ends_of_sets(plan, fired)


# ── sums ─────────────────────────────────────────────────────────────────────────────


@kernel
def end_of_average(numbers: Any, lower: Any, upper: Any, count: int, sign: float) -> float:
    """Return the greatest (sign 1) or least (-1) average of numbers with weights between two.

    0 where all weights are 0. Plain enough for a compiler.
    """
    total = moment = 0.0
    for i in range(count):
        if upper[i] > 0.0:
            total += lower[i] + upper[i]
            moment += (lower[i] + upper[i]) * numbers[i]
    c = 0.0
    if total > 0.0:
        c = moment / total
    for _ in range(count + 2):
        total = moment = 0.0
        for i in range(count):
            if upper[i] > 0.0:
                weight = upper[i] if sign * (numbers[i] - c) > 0.0 else lower[i]
                total += weight
                moment += weight * numbers[i]
        # Nothing is left beyond c where all lower weights are 0: it is the last number.
        if not total > 0.0:
            break
        if not sign * (moment / total - c) > 0.0:
            break
        c = moment / total
    return c


def _ends_of_values(
    plan: OutputPlan, fired: Fired, value_of: Callable[[int], float]
) -> Interval | None:
    folded = fold_at_point(plan, fired)
    pairs = [(up, low) for up, low in plan.pairs if folded.get(up, 0.0) > 0.0]
    if not pairs:
        return None
    upper = [folded[up] for up, _ in pairs]
    # Rounding may leave the lower strength a bit above the upper one.
    lower = [min(folded.get(low, 0.0), folded[up]) for up, low in pairs]
    values = [sorted((value_of(low), value_of(up))) for up, low in pairs]
    least, greatest = [low for low, _ in values], [high for _, high in values]
    count = len(pairs)
    left = end_of_average(least, lower, upper, count, -1.0)
    return left, end_of_average(greatest, lower, upper, count, 1.0)


def _ends_of_samples(plan: OutputPlan, fired: Fired) -> Interval | None:
    way = plan.output.defuzzifier
    assert way.resolution is not None
    samples, upper = sampled_aggregate_at_point(plan, side_of(plan, fired, UPPER))
    _, lower = sampled_aggregate_at_point(plan, side_of(plan, fired, LOWER))
    if not any(height > 0.0 for height in upper):
        return None
    factors = weights(way.resolution, way.sampling)
    upper = [factor * height for factor, height in zip(factors, upper, strict=True)]
    lower = [factor * height for factor, height in zip(factors, lower, strict=True)]
    left = end_of_average(samples, lower, upper, len(samples), -1.0)
    return left, end_of_average(samples, lower, upper, len(samples), 1.0)


# ── integrals ────────────────────────────────────────────────────────────────────────


class _Curve(NamedTuple):
    """One of the two sets, and the edges of its first panels."""

    function: Callable[[float], float]
    edges: list[float]
    noise: float

    def leaves(self, start: float = -math.inf, end: float = math.inf) -> list[Leaf]:
        """Return the finished panels between two positions.

        Halved anew, as the kernel does, which has no room to keep those of the whole.
        """
        low, high = self.edges[0], self.edges[-1]
        start, end = max(start, low), min(end, high)
        inner = [edge for edge in self.edges if start < edge < end]
        edges = [start, *inner, end] if start < end else []
        return leaves_at_point(self.function, edges, self.noise, (low, high))

    def between(self, start: float = -math.inf, end: float = math.inf) -> tuple[float, float]:
        """Return area and moment (about the centre of the range) between two positions."""
        leaves = self.leaves(start, end)
        return added_up(leaf.area for leaf in leaves), added_up(leaf.moment for leaf in leaves)


def _curve(plan: OutputPlan, fired: Fired) -> _Curve:
    noise = noise_of(plan, max((strength for _, strength in fired), default=0.0))
    return _Curve(aggregate(plan, fired, integrated=True), edges_of(plan, fired), noise)


def _ends_of_sets(plan: OutputPlan, fired: Fired) -> Interval | None:
    if plan.enveloped:
        return _ends_of_envelopes(plan, fired)
    upper, lower = (_curve(plan, side_of(plan, fired, side)) for side in (UPPER, LOWER))
    (area, moment), (lower_area, more) = upper.between(), lower.between()
    if not area > 0.0:
        return None
    if not lower_area > 0.0:
        covered = [leaf for leaf in upper.leaves() if leaf.area > 0.0]
        return covered[0].x0, covered[-1].x1
    centre = 0.5 * (plan.output.low + plan.output.high)
    left = right = centre + (moment + more) / (area + lower_area)
    for _ in range(STEPS):
        (a1, m1), (a2, m2) = lower.between(end=right), upper.between(right)
        following = centre + (m1 + m2) / (a1 + a2)
        if not following > right:
            break
        right = following
    for _ in range(STEPS):
        (a1, m1), (a2, m2) = upper.between(end=left), lower.between(left)
        following = centre + (m1 + m2) / (a1 + a2)
        if not following < left:
            break
        left = following
    return left, right


def _ends_of_envelopes(plan: OutputPlan, fired: Fired) -> Interval | None:
    heap, begin = room_for_envelopes(plan)
    centre = 0.5 * (plan.output.low + plan.output.high)
    # The upper envelope from `begin` to `middle`, behind it the lower one to `behind`.
    middle = envelop_at_point(plan, side_of(plan, fired, UPPER), heap, begin)
    area, torque = add_up(heap, begin, middle, centre)
    behind = envelop_at_point(plan, side_of(plan, fired, LOWER), heap, middle)
    lower_area, more = add_up(heap, middle, behind, centre)
    area, torque = area + lower_area, torque + more
    if not area > 0.0:
        return None
    start = centre + torque / area
    left, right = (
        reach_end(heap, begin, middle, behind, start, centre, lower_area, sign)
        for sign in (-1.0, 1.0)
    )
    return left, right


# ── Nie and Tan ──────────────────────────────────────────────────────────────────────


def nie_tan_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the centroid of the middle of the two sets; None where nothing has an area.

    For sets without a closed form: otherwise, and of values, it is an ordinary centroid of
    both sides together (:func:`fuzzyarm.inference.plan.plan`).
    """
    area = moment = 0.0
    heap, begin = room_for_envelopes(plan) if plan.enveloped else ([], 0)
    behind = begin
    for side in (UPPER, LOWER):
        fired_here = side_of(plan, fired, side)
        if plan.enveloped:
            behind = envelop_at_point(plan, fired_here, heap, behind)
            continue
        if plan.output.defuzzifier.resolution is None:
            a, m = _curve(plan, fired_here).between()
        else:
            a, m = _sums_of_samples(plan, fired_here)
        area, moment = area + a, moment + m
    if plan.enveloped:
        area, moment = add_up(heap, begin, behind, 0.5 * (plan.output.low + plan.output.high))
    if not area > 0.0:
        return None
    exact = plan.output.defuzzifier.resolution is None
    centre = 0.5 * (plan.output.low + plan.output.high) if exact else 0.0
    return centre + moment / area


def _sums_of_samples(plan: OutputPlan, fired: Fired) -> tuple[float, float]:
    way = plan.output.defuzzifier
    assert way.resolution is not None
    samples, heights = sampled_aggregate_at_point(plan, fired)
    parts = [f * y for f, y in zip(weights(way.resolution, way.sampling), heights, strict=True)]
    moments = [part * x for part, x in zip(parts, samples, strict=True)]
    return added_up(parts), added_up(moments)
