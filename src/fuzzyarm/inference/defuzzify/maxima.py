"""Mean, smallest and largest of the places where an aggregate is greatest.

Exact: under ``aggregation max`` the places are level cuts of the strongest sets; under
the others the greatest value is looked for at all corners, clipping edges and
:data:`CANDIDATES` even places, which is exact for straight sets cut by min and within the
spacing of the places otherwise. Sampled: over the samples; the mean is that of all of them.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from fuzzyarm.inference.defuzzify.one_aggregate import (
    Fired,
    aggregate,
    aggregate_sampled,
    fold,
)
from fuzzyarm.inference.plan import OutputPlan
from fuzzyarm.inference.profile import cut, peak
from fuzzyarm.inference.sampling import places
from fuzzyarm.rulebase.norms import TNORMS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.defuzzify.many_aggregate import Strengths

    Array = NDArray[np.float64]

SAME = 1e-12
"""Heights that differ by a smaller share than this are equally great."""

CANDIDATES = 2001
"""Even places that are tried where the aggregation is not max."""

CLIPPING = frozenset({"min", "nilpotent"})
"""Implications that leave a plateau at the firing strength."""

Intervals = list[tuple[float, float]]


def one(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the exact place, or None where the aggregate is 0."""
    if plan.output.aggregation == "max":
        intervals = _strongest(plan, fired)
    else:
        intervals = _plateaus(plan, fired)
    return _choose(plan.output.defuzzifier.method, intervals) if intervals else None


def _strongest(plan: OutputPlan, fired: Fired) -> Intervals:
    reached = []
    for index, strength in fold(plan, fired).items():
        member = plan.members[index]
        top = peak(member.pieces)
        height = TNORMS[member.implication](strength, top)
        clips = member.implication in CLIPPING and strength < top
        reached.append((height, index, strength if clips else top))
    greatest = max((height for height, _, _ in reached), default=0.0)
    if not greatest > 0.0:
        return []
    return [
        interval
        for height, index, level in reached
        if height >= greatest * (1.0 - SAME)
        for interval in cut(plan.members[index].pieces, plan.members[index].membership, level)
    ]


def _plateaus(plan: OutputPlan, fired: Fired) -> Intervals:
    output = plan.output
    value = aggregate(plan, fired)
    xs = {*places(output.low, output.high, CANDIDATES, "endpoints")}
    for index, strength in fired:
        member = plan.members[index]
        xs |= {x for piece in member.pieces for x in (piece.x0, piece.x1)}
        for level in (strength, 1.0 - strength):
            for interval in cut(member.pieces, member.membership, level):
                xs |= {*interval}
    ordered = sorted(xs)
    heights = [value(x) for x in ordered]
    greatest = max(heights)
    if not greatest > 0.0:
        return []
    enough = greatest * (1.0 - SAME)
    spots = [x for x, height in zip(ordered, heights, strict=True) if height >= enough]
    flat = [
        (a, b)
        for a, b in pairwise(spots)
        if value(0.5 * (a + b)) >= enough and value(0.3 * a + 0.7 * b) >= enough
    ]
    return [*((x, x) for x in spots), *flat]


def _choose(method: str, intervals: Intervals) -> float:
    if method == "smallest-of-maximum":
        return min(a for a, _ in intervals)
    if method == "largest-of-maximum":
        return max(b for _, b in intervals)
    length = moment = reach = 0.0
    reach = min(a for a, _ in intervals)
    for start, end in sorted(intervals):
        begin = max(start, reach)
        if end > begin:
            length += end - begin
            moment += (end - begin) * 0.5 * (begin + end)
            reach = end
    if length > 0.0:
        return moment / length
    spots = sorted({a for a, _ in intervals})
    return sum(spots) / len(spots)


def many(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the exact places and the greatest strengths (0 where nothing fired).

    The level cuts of a point are few numbers of irregular count; they are taken point by
    point in plain Python, once for each distinct combination of strengths.
    """
    import numpy as np

    entries = strengths.flat()
    size = int(np.prod(strengths.shape))
    table = np.stack([strength for _, strength in entries] or [np.zeros(size)], axis=1)
    distinct, back = np.unique(table, axis=0, return_inverse=True)
    value, top = np.zeros(len(distinct)), np.zeros(len(distinct))
    for row, levels in enumerate(distinct.tolist()):
        fired = [
            (member, level)
            for (member, _), level in zip(entries, levels, strict=False)
            if level > 0.0
        ]
        found = one(plan, fired) if fired else None
        if found is not None:
            value[row], top[row] = found, 1.0
    back = back.reshape(strengths.shape)
    return value[back], top[back]


def one_sampled(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the place among the samples, or None where all are 0."""
    samples, heights = aggregate_sampled(plan, fired)
    return greatest_of(plan.output.defuzzifier.method, samples, heights)


def greatest_of(method: str, samples: list[float], heights: list[float]) -> float | None:
    """Return mean, smallest or largest of the samples that are greatest."""
    enough = max(heights) * (1.0 - SAME)
    if not enough > 0.0:
        return None
    top = [y for y, height in zip(samples, heights, strict=True) if height >= enough]
    if method == "mean-of-maximum":
        return sum(top) / len(top)
    return top[0] if method == "smallest-of-maximum" else top[-1]


def many_sampled(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the places among the samples and the greatest heights (0: nothing fired)."""
    from fuzzyarm.inference.defuzzify.many_aggregate import aggregate_sampled as sampled_many

    samples, heights = sampled_many(plan, strengths)
    value, top = greatest_of_many(plan.output.defuzzifier.method, samples, heights)
    return value.reshape(strengths.shape), top.reshape(strengths.shape)


def greatest_of_many(method: str, samples: Array, heights: Array) -> tuple[Array, Array]:
    """Return what :func:`greatest_of` does for each row of `heights`, and the greatest."""
    import numpy as np

    top = heights.max(axis=1)
    among = heights >= (top * (1.0 - SAME))[:, None]
    if method == "mean-of-maximum":
        value = np.where(among, samples, 0.0).sum(axis=1) / among.sum(axis=1)
    elif method == "smallest-of-maximum":
        value = samples[among.argmax(axis=1)]
    else:
        value = samples[samples.size - 1 - among[:, ::-1].argmax(axis=1)]
    return value, top
