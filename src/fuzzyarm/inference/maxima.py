"""The maxima and the bisector of an aggregate, exact or sampled.

The last part is for outputs whose terms are numbers rather than sets.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce
from itertools import accumulate, combinations, pairwise
from operator import itemgetter
from typing import TYPE_CHECKING

from fuzzyarm.expression.kinds import SNORMS, TNORMS
from fuzzyarm.inference.aggregate import (
    Fired,
    added_up,
    aggregate,
    fold_at_point,
    sampled_aggregate_at_point,
)
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.quadrature import CLIPPING, edges_of, leaves_at_point, noise_of, rule
from fuzzyarm.inference.sets import bisect, cut, golden, peak

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.aggregate_arrays import Strengths

    Array = NDArray[np.float64]


# --- Mean, smallest and largest of the positions where an aggregate is greatest ---
#
# Exact: under `aggregation max` the positions are level cuts of the strongest sets. Under the
# others the range is cut where a set bends, where an implication clips one and where the
# aggregate reaches 1. In between every straight set is cut to a line (by the implications in
# LINEAR), and the aggregate is greatest at an end of the cell, or constant: sums of lines are
# lines; and with a convex g, −log(1 − a), a / (1 − a) or artanh a, the norms probor, hamacher
# and einstein are the inverse of a sum of g. Curved sets and other norms are searched instead:
# heights are then right to 1e-15, positions on a round top to some 1e-8 of the range.
# Sampled: over the samples; the mean is that of all of them.

SAME = 1e-12
"""Heights that differ by a smaller share than this are equally great."""

STEPS_OF_CURVES = 16
"""Even steps of a cell with a curve, between which the aggregate has one maximum at most."""

NEAR = 1e-7
"""Positions closer than this share of the range are one, and no plateau."""

LINEAR = frozenset({"min", "product", "bounded", "nilpotent", "drastic"})
"""Implications that leave lines of a straight set, between where they clip it."""

CEILINGS = frozenset({"bounded", "normalized", "nilpotent"})
"""Aggregations that bend where sums of strengths reach 1."""

Intervals = list[tuple[float, float]]

Heights = list[tuple[float, float, float]]
"""Stretches (height, start, end) over which an aggregate is constant, most of them points."""


def maxima_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the exact position, or None where the aggregate is 0."""
    if plan.output.aggregation == "max":
        intervals = _strongest(plan, fired)
    else:
        intervals = _plateaus(plan, fired)
    return _choose(plan.output.defuzzifier.method, intervals) if intervals else None


def _strongest(plan: OutputPlan, fired: Fired) -> Intervals:
    reached = []
    for index, strength in fold_at_point(plan, fired).items():
        member = plan.members[index]
        top = peak(member.pieces)
        height = TNORMS[member.implication].scalar(strength, top)
        levels = [low + rise * strength for low, rise in CLIPPING.get(member.implication, ())]
        clips = member.implication != "bounded" and height == strength < top
        reached.append((height, index, max(levels) if clips and levels else top))
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
    output, value = plan.output, aggregate(plan, fired)
    edges = {output.low, output.high}
    searched = SNORMS[output.aggregation].own
    for index, strength in fired:
        member = plan.members[index]
        edges |= {piece.x0 for piece in member.pieces}
        searched |= member.implication not in LINEAR
        searched |= any(not piece.straight for piece in member.pieces)
        for offset, factor in CLIPPING.get(member.implication, ()):
            for interval in cut(member.pieces, member.membership, offset + factor * strength):
                edges |= {*interval}
    cells = list(pairwise(sorted(edges)))
    heights: Heights = [(value(x), x, x) for x in edges]
    curves: Intervals = []
    if searched:
        level, curves = _cells_to_search(
            plan, fired, cells, max(height for height, _, _ in heights)
        )
        heights += level
        for x0, x1 in curves:
            heights += _greatest_on_curves(value, x0, x1)
    else:
        for x0, x1 in cells:
            heights += _greatest_on_lines(plan, fired, x0, x1)
    greatest = max(height for height, _, _ in heights)
    if not greatest > 0.0:
        return []
    found = [each for each in heights if each[0] >= greatest * (1.0 - SAME)]
    wide = [(a, b) for _, a, b in found if b > a]
    wide += _widened(value, sorted({x for _, x, _ in found}), greatest, curves)
    near = NEAR * (output.high - output.low)
    return _apart(found, near) + [(a, b) for a, b in _joined(wide) if b - a > near]


def _cells_to_search(
    plan: OutputPlan, fired: Fired, cells: Intervals, reached: float
) -> tuple[Heights, Intervals]:
    """Return cells over which an aggregate is level, and those where it may exceed `reached`.

    In a cell every set is a part of one of its monotone pieces, so that its ends bound it, and
    norms rise with every degree: most cells need no search.
    """
    norm = SNORMS[plan.output.aggregation].scalar
    ends = {index: _degrees_at_ends(plan.members[index], cells) for index, _ in fired}
    parts = [
        (TNORMS[plan.members[index].implication].scalar, strength, ends[index])
        for index, strength in fired
    ]
    bounds = []
    for k, (x0, x1) in enumerate(cells):
        low = high = 0.0
        for implication, strength, own in parts:
            least, most = own[k]
            low = norm(low, implication(strength, least))
            high = norm(high, implication(strength, most))
        bounds.append((low, high, x0, x1))
    reached = max(reached, *(low for low, _, _, _ in bounds))
    ceiling = max(high for _, high, _, _ in bounds)
    level: Heights = []
    curves: Intervals = []
    for low, high, x0, x1 in bounds:
        if low == high or low >= ceiling * (1.0 - SAME):
            level.append((low, x0, x1))
        elif high >= reached * (1.0 - 2.0 * SAME):
            curves.append((x0, x1))
    return level, curves


def _degrees_at_ends(member: Member, cells: Intervals) -> list[tuple[float, float]]:
    """Return the least and the greatest degree of a set in each cell."""
    pieces, found, k = member.pieces, [], 0
    for x0, x1 in cells:
        while k + 1 < len(pieces) and pieces[k].x1 <= x0:
            k += 1
        piece = pieces[k]
        if piece.y0 == piece.y1:
            found.append((piece.y0, piece.y0))
            continue
        left = piece.y0 if x0 <= piece.x0 else member.membership(x0)
        right = piece.y1 if x1 >= piece.x1 else member.membership(x1)
        found.append((left, right) if left <= right else (right, left))
    return found


def _joined(stretches: Intervals) -> Intervals:
    """Return stretches with those that touch as one: a plateau may go on beyond a corner."""
    joined: Intervals = []
    for start, end in sorted(stretches):
        if joined and start <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], end))
        else:
            joined.append((start, end))
    return joined


def _apart(found: Heights, near: float) -> Intervals:
    """Return the highest of the positions that are close to each other, as points."""
    groups: list[list[tuple[float, float]]] = []
    for x, height in sorted((x, height) for height, start, end in found for x in (start, end)):
        if groups and x - groups[-1][-1][0] <= near:
            groups[-1].append((x, height))
        else:
            groups.append([(x, height)])
    tops = [max(group, key=lambda spot: spot[1])[0] for group in groups]
    return [(x, x) for x in tops]


def _greatest_on_lines(plan: OutputPlan, fired: Fired, x0: float, x1: float) -> Heights:
    """Return the heights at the ends of a cell, seen from inside, and where it is constant."""
    norm = SNORMS[plan.output.aggregation].scalar
    ends = [_ends_of_line(plan.members[index], strength, x0, x1) for index, strength in fired]
    shares = {0.0, 1.0}
    if plan.output.aggregation in CEILINGS:
        left, right = (math.fsum(line[side] for line in ends) for side in (0, 1))
        sums = [(left, right)]
        if plan.output.aggregation == "nilpotent":
            sums = [(a[0] + b[0], a[1] + b[1]) for a, b in combinations(ends, 2)]
        shares |= {(1.0 - a) / (b - a) for a, b in sums if (a - 1.0) * (b - 1.0) < 0.0}

    def height(share: float) -> float:
        return reduce(norm, ((1.0 - share) * a + share * b for a, b in ends), 0.0)

    found = []
    for start, end in pairwise(sorted(shares)):
        a, b = (x0 + (x1 - x0) * share for share in (start, end))
        inside = [height(start + (end - start) * share) for share in (1e-6, 0.5, 1.0 - 1e-6)]
        if max(inside) - min(inside) <= SAME * max(inside):
            found.append((min(inside), a, b))
        found += [(height(start), a, a), (height(end), b, b)]
    return found


def _ends_of_line(member: Member, strength: float, x0: float, x1: float) -> tuple[float, float]:
    """Return what a cut set that is one line (or nearly so) in a cell tends to at its ends.

    From two positions inside: at the ends the set, or its implication, may jump.
    """
    implication = TNORMS[member.implication].scalar
    first = implication(strength, member.membership(x0 + 0.25 * (x1 - x0)))
    second = implication(strength, member.membership(x0 + 0.75 * (x1 - x0)))
    if first == second:
        return first, second
    rise = 0.5 * (second - first)
    return max(0.0, first - rise), max(0.0, second + rise)


def _greatest_on_curves(value: Callable[[float], float], x0: float, x1: float) -> Heights:
    """Return the greatest heights inside a cell, by golden section where samples show one."""
    xs = [x0 + (x1 - x0) * i / STEPS_OF_CURVES for i in range(STEPS_OF_CURVES + 1)]
    xs[0], xs[-1] = x0 + 1e-9 * (x1 - x0), x1 - 1e-9 * (x1 - x0)  # inside: it may jump there
    # Beside an end, too: a top may lie between it and the next sample.
    xs[1:1], xs[-1:-1] = [xs[0] + 1e-3 * (xs[1] - xs[0])], [xs[-1] - 1e-3 * (xs[-1] - xs[-2])]
    ys = [value(x) for x in xs]
    found = [(y, x, x) for x, y in zip(xs, ys, strict=True)]
    for i in range(1, len(xs) - 1):
        if ys[i] >= ys[i - 1] and ys[i] >= ys[i + 1] and ys[i] > min(ys[i - 1], ys[i + 1]):
            x = golden(value, xs[i - 1], xs[i + 1], 1.0, xs[i])
            found.append((value(x), x, x))
    return found


def _widened(
    value: Callable[[float], float], tops: list[float], greatest: float, cells: Intervals
) -> Intervals:
    """Return the stretches around positions over which an aggregate is greatest."""
    wide = []
    for x0, x1 in cells:
        inside = [x for x in tops if x0 <= x <= x1]
        for a, b in pairwise(inside):
            if all(value(a + share * (b - a)) >= greatest * (1.0 - SAME) for share in (0.3, 0.5)):
                wide.append((a, b))
        step = (x1 - x0) / STEPS_OF_CURVES
        for start, way in ((inside[0], -step), (inside[-1], step)) if inside else ():
            end = min(x1, max(x0, start + way))
            reach = bisect(lambda x: float(value(x) >= greatest), start, end, 0.5)
            wide.append((min(start, reach), max(start, reach)))
    return wide


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
    return added_up(spots) / len(spots)


def maxima_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the exact positions and the greatest strengths (0 where nothing fired).

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
        found = maxima_at_point(plan, fired) if fired else None
        if found is not None:
            value[row], top[row] = found, 1.0
    back = back.reshape(strengths.shape)
    return value[back], top[back]


def sampled_maxima_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the choice among the samples, or None where all are 0."""
    samples, heights = sampled_aggregate_at_point(plan, fired)
    return _greatest_of(plan.output.defuzzifier.method, samples, heights)


def _greatest_of(method: str, samples: list[float], heights: list[float]) -> float | None:
    """Return mean, smallest or largest of the samples that are greatest."""
    enough = max(heights) * (1.0 - SAME)
    if not enough > 0.0:
        return None
    top = [y for y, height in zip(samples, heights, strict=True) if height >= enough]
    if method == "mean-of-maximum":
        return added_up(top) / len(top)
    return top[0] if method == "smallest-of-maximum" else top[-1]


def sampled_maxima_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the choices among the samples and the greatest heights (0: nothing fired)."""
    from fuzzyarm.inference.aggregate_arrays import sampled_aggregate_over_arrays

    samples, heights = sampled_aggregate_over_arrays(plan, strengths)
    value, top = _greatest_of_many(plan.output.defuzzifier.method, samples, heights)
    return value.reshape(strengths.shape), top.reshape(strengths.shape)


def _greatest_of_many(method: str, samples: Array, heights: Array) -> tuple[Array, Array]:
    """Return what :func:`_greatest_of` does for each column of `heights`, and the greatest."""
    import numpy as np

    top = heights.max(axis=0)
    among = heights >= top * (1.0 - SAME)
    if method == "mean-of-maximum":
        value = _added_up_rows(np.where(among, samples[:, None], 0.0)) / among.sum(axis=0)
    elif method == "smallest-of-maximum":
        value = samples[among.argmax(axis=0)]
    else:
        value = samples[samples.size - 1 - among[::-1].argmax(axis=0)]
    return value, top


def _added_up_rows(rows: Array) -> Array:
    """Return the sum of the rows in their order, as :func:`added_up` does."""
    import numpy as np

    total = np.zeros(rows.shape[1])
    for row in rows:
        total += row
    return total


# --- The position that halves the area of an aggregate ---
#
# Where the halves are parted by a gap, the middle of the gap. Sampled, the first sample at
# which the running sum of the heights reaches half of the total, as in MATLAB; an exact half
# takes the middle towards the next sample. With `midpoints` the sample whose running sum
# is nearest to half, or the mean of those that are equally near, as in fuzzylite.

SAME_HALF = 1e-12
"""Shares of the area closer to one half than this are one half; in the kernel, too."""

STEPS = 60
"""Halvings of a panel; in the kernel, too."""


def bisector_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the exact bisector, or None where the aggregate has no area."""
    function = aggregate(plan, fired, integrated=True)
    noise = noise_of(plan, max((strength for _, strength in fired), default=0.0))
    parts = leaves_at_point(function, edges_of(plan, fired), noise)
    total = added_up(part.area for part in parts)
    if not total > 0.0:
        return None
    found = []
    for share in (0.5 - SAME_HALF, 0.5 + SAME_HALF):
        before = 0.0
        for part in parts:
            if before + part.area >= share * total:
                found.append(_inside(function, part.x0, part.x1, share * total - before))
                break
            before += part.area
        else:
            found.append(parts[-1].x1)
    return 0.5 * (found[0] + found[1])


def _inside(function: Callable[[float], float], x0: float, x1: float, wanted: float) -> float:
    a, b = x0, x1
    for _ in range(STEPS):
        middle = 0.5 * (a + b)
        if rule(function, x0, middle, 0.0)[0] < wanted:
            a = middle
        else:
            b = middle
    return 0.5 * (a + b)


def bisector_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the exact bisectors and the areas (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.aggregate_arrays import leaves_over_arrays, panel_rule, sum_by_point

    size = int(np.prod(strengths.shape))
    entries = strengths.flat()
    found = leaves_over_arrays(plan, entries, size)
    point, x0, x1, area = found.point, found.x0, found.x1, found.area
    total = sum_by_point(point, area, size)
    first = np.searchsorted(point, np.arange(size))
    last = np.append(first[1:], point.size) - 1
    running = _running_sums(area, first, last)
    before = np.concatenate([[0.0], running[:-1]])
    before[first] = 0.0
    value = np.zeros(size)
    for share in (0.5 - SAME_HALF, 0.5 + SAME_HALF):
        reached = running >= (share * total)[point]
        panel = np.minimum.reduceat(np.where(reached, np.arange(point.size), point.size), first)
        panel = np.minimum(panel, last)
        wanted = share * total - before[panel]
        a, b, own = x0[panel].copy(), x1[panel].copy(), np.arange(size)
        for _ in range(STEPS):
            middle = 0.5 * (a + b)
            below = panel_rule(plan, entries, own, x0[panel], middle, 0.0)[0] < wanted
            a, b = np.where(below, middle, a), np.where(below, b, middle)
        value += 0.5 * (0.5 * (a + b))
    return value.reshape(strengths.shape), total.reshape(strengths.shape)


def _running_sums(area: Array, first: NDArray[np.intp], last: NDArray[np.intp]) -> Array:
    """Sum within each point's stretch, from its own zero (no digits lost to other points)."""
    import numpy as np

    running = np.empty_like(area)
    for a, b in zip(first.tolist(), last.tolist(), strict=True):
        np.cumsum(area[a : b + 1], out=running[a : b + 1])
    return running


def sampled_bisector_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the bisector of the samples, or None where all are 0."""
    samples, heights = sampled_aggregate_at_point(plan, fired)
    sampling = plan.output.defuzzifier.sampling
    if sampling == "trapezoid":
        heights[0] *= 0.5
        heights[-1] *= 0.5
    return _nearest_half(samples, heights) if sampling == "midpoints" else halve(samples, heights)


def _nearest_half(samples: list[float], heights: list[float]) -> float | None:
    """Return the sample at which the running sum is nearest to half of the total."""
    total = added_up(heights)
    if not total > 0.0:
        return None
    distances = [abs(running / total - 0.5) for running in accumulate(heights)]
    enough = min(distances) + SAME_HALF
    found = [y for y, far in zip(samples, distances, strict=True) if far <= enough]
    return added_up(found) / len(found)


def halve(samples: list[float], heights: list[float]) -> float | None:
    """Return the position at which the running sum of `heights` reaches half of the total."""
    total = added_up(heights)
    if not total > 0.0:
        return None
    low_share, high_share = (0.5 - SAME_HALF) * total, (0.5 + SAME_HALF) * total
    running, first = 0.0, None
    for sample, height in zip(samples, heights, strict=True):
        running += height
        if first is None and running >= low_share:
            first = sample
        if running >= high_share:
            return 0.5 * ((first if first is not None else sample) + sample)
    return samples[-1]


def sampled_bisector_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the bisectors of the samples and the sums (0 where nothing fired)."""
    from fuzzyarm.inference.aggregate_arrays import sample_weights, sampled_aggregate_over_arrays

    samples, heights = sampled_aggregate_over_arrays(plan, strengths)
    heights *= sample_weights(plan)[:, None]
    midpoints = plan.output.defuzzifier.sampling == "midpoints"
    function = _nearest_half_many if midpoints else _halve_many
    value, total = function(samples, heights)
    return value.reshape(strengths.shape), total.reshape(strengths.shape)


def _nearest_half_many(samples: Array, heights: Array) -> tuple[Array, Array]:
    """Return what :func:`_nearest_half` does for each column of `heights`, and the totals."""
    import numpy as np

    running = np.cumsum(heights, axis=0)
    total = running[-1].copy()
    running /= np.where(total > 0.0, total, 1.0)
    distance = np.abs(running - 0.5)
    among = distance <= distance.min(axis=0) + SAME_HALF
    return _added_up_rows(np.where(among, samples[:, None], 0.0)) / among.sum(axis=0), total


def _halve_many(samples: Array, heights: Array) -> tuple[Array, Array]:
    """Return what :func:`halve` does for each column of `heights`, and the totals."""
    import numpy as np

    running = np.cumsum(heights, axis=0)
    total = running[-1]
    value = np.zeros(total.size)
    for share in (0.5 - SAME_HALF, 0.5 + SAME_HALF):
        value += 0.5 * samples[(running >= share * total).argmax(axis=0)]
    return value, total


# --- Bisector and maxima of an output whose terms are numbers rather than sets ---


def discrete_at_point(
    plan: OutputPlan, fired: Fired, value_of: Callable[[int, float], float]
) -> float | None:
    """Return the value, or None where no rule fired."""
    folded = fold_at_point(plan, fired)
    spikes = sorted(((value_of(m, w), w) for m, w in folded.items()), key=itemgetter(0))
    if not spikes:
        return None
    samples, heights = [y for y, _ in spikes], [w for _, w in spikes]
    method = plan.output.defuzzifier.method
    return (
        halve(samples, heights) if method == "bisector" else _greatest_of(method, samples, heights)
    )


def discrete_over_arrays(
    plan: OutputPlan, strengths: Strengths, value_of: Callable[[int, Array], Array | float]
) -> tuple[Array, Array]:
    """Return the values and the greatest strengths (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.aggregate_arrays import fold_over_arrays

    folded = fold_over_arrays(plan, list(strengths))
    if not folded:
        return np.zeros(strengths.shape), np.zeros(strengths.shape)
    size = int(np.prod(strengths.shape))
    values, heights = np.empty((len(folded), size)), np.empty((len(folded), size))
    for row, (member, strength) in enumerate(folded.items()):
        values[row] = np.broadcast_to(value_of(member, strength), strengths.shape).ravel()
        heights[row] = np.broadcast_to(strength, strengths.shape).ravel()
    order = np.argsort(values, axis=0, kind="stable")
    values, heights = np.take_along_axis(values, order, 0), np.take_along_axis(heights, order, 0)
    value = np.empty(size)
    method = plan.output.defuzzifier.method
    function = _halve_many if method == "bisector" else _greatest_of_many
    # The order differs from point to point only where values depend on the inputs.
    for column in range(size) if (values != values[:, :1]).any() else [slice(None)]:
        some = slice(column, column + 1) if isinstance(column, int) else column
        own = (values[:, some][:, 0], heights[:, some])
        value[some] = function(*(own if method == "bisector" else (method, *own)))[0]
    return value.reshape(strengths.shape), heights.max(axis=0).reshape(strengths.shape)
