"""The exact positions of an aggregate's maximum, under other aggregations than ``max``.

Under ``max`` they are level cuts of the strongest sets (:mod:`.positions`). Here the range is cut
where a set bends, where an implication clips one and where the aggregate reaches 1. In between
every straight set is cut to a line (by the implications in LINEAR), and the aggregate is greatest
at an end of the cell, or constant: sums of lines are lines; and with a convex g, −log(1 − a), a /
(1 − a) or artanh a, the norms probor, hamacher and einstein are the inverse of a sum of g. Curved
sets and other norms are searched instead: heights are then accurate to 1e-15, positions on a round
top to some 1e-8 of the range.

All of it is plain Python, called by the interpreted kernel.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import reduce
from itertools import combinations, pairwise
from typing import Any
from weakref import WeakValueDictionary

from fuzzyarm.inference.aggregate import Figures, Fired, added_up, aggregate
from fuzzyarm.inference.block import (
    DETAIL,
    GROUP_HEAD,
    GROUPS,
    HEIGHTS,
    OPERANDS,
    OUTPUT,
    RULE_HEAD,
    WIDTH,
)
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.quadrature import CLIPPING
from fuzzyarm.inference.sets import bisect, cut, golden
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS

SAME = 1e-12
"""Heights that differ by a smaller share than this are equally great."""

STEPS_OF_CURVES = 16
"""Even steps of a cell with a curve, between which the aggregate has one maximum at most."""

NEAR = 1e-7
"""Positions closer than this share of the range are one, and no plateau."""

LINEAR = frozenset({"min", "product", "bounded", "nilpotent", "drastic"})
"""Implications that leave a straight set straight, between the clipping points."""

CEILINGS = frozenset({"bounded", "normalized", "nilpotent"})
"""Aggregations that bend where sums of strengths reach 1."""

Intervals = list[tuple[float, float]]

Heights = list[tuple[float, float, float]]
"""Stretches (height, start, end) over which an aggregate is constant, most of them points."""


class SearchedMaxima:
    """An output with a search for exact maxima in the interpreted kernel.

    Attributes
    ----------
    number : int
        Its number in the layout, valid for the layout's life.
    """

    def __init__(self, plan: OutputPlan) -> None:
        self._plan = plan
        self.number = id(self)
        _searched[self.number] = self

    def value(self, fired: Fired) -> float | None:
        """Return the value of the output; None where its aggregate is 0."""
        intervals = _plateaus(self._plan, fired)
        return float(self._plan.record.value(_figures(intervals))) if intervals else None


_searched: WeakValueDictionary[int, SearchedMaxima] = WeakValueDictionary()


def position_of_searched(
    k: Any, f: Any, scratch: Any, heap: Any, point: int
) -> tuple[float, float]:
    """Return the greatest strength (0: no rule fires) and the value; each rule is a group."""
    fired = []
    place = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        member = k[k[place + 1]]
        place += GROUP_HEAD + k[place] * (RULE_HEAD + k[OPERANDS])
        strength = float(scratch[group * k[WIDTH] + point])
        if strength > 0.0:
            fired.append((member, strength))
    value = _searched[k[k[OUTPUT] + DETAIL]].value(fired) if fired else None
    return (0.0, 0.0) if value is None else (1.0, value)


def _plateaus(plan: OutputPlan, fired: Fired) -> Intervals:
    output, value = plan.output, aggregate(plan, fired)
    edges = {output.low, output.high}
    searched = SNORMS[output.aggregation].own
    for index, strength in fired:
        member = plan.members[index]
        edges |= {piece.x0 for piece in member.pieces}
        searched |= member.implication not in LINEAR
        searched |= any(not piece.straight for piece in member.pieces)
        # A cut adds edges where the degree passes the strength, or the clipping level.
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
    highest = [candidate for candidate in heights if candidate[0] >= greatest * (1.0 - SAME)]
    wide = [(a, b) for _, a, b in highest if b > a]
    wide += _widened(value, sorted({x for _, x, _ in highest}), greatest, curves)
    near = NEAR * (output.high - output.low)
    return _apart(highest, near) + [(a, b) for a, b in _joined(wide) if b - a > near]


def _cells_to_search(
    plan: OutputPlan, fired: Fired, cells: Intervals, reached: float
) -> tuple[Heights, Intervals]:
    """Return cells with a constant aggregate, and those where it may exceed `reached`.

    In a cell every set is monotone, so its ends bound it, and norms rise with every degree: most
    cells need no search.
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
        for implication, strength, cells_here in parts:
            least, most = cells_here[k]
            low = norm(low, implication(strength, least))
            high = norm(high, implication(strength, most))
        bounds.append((low, high, x0, x1))
    # No cell whose upper bound is below the best height found can hold the maximum.
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
    pieces, ends, k = member.pieces, [], 0
    for x0, x1 in cells:
        while k + 1 < len(pieces) and pieces[k].x1 <= x0:
            k += 1
        piece = pieces[k]
        if piece.y0 == piece.y1:
            ends.append((piece.y0, piece.y0))
            continue
        left = piece.y0 if x0 <= piece.x0 else member.membership(x0)
        right = piece.y1 if x1 >= piece.x1 else member.membership(x1)
        ends.append((left, right) if left <= right else (right, left))
    return ends


def _joined(stretches: Intervals) -> Intervals:
    """Return stretches with adjacent ones joined: a plateau may go on beyond a corner."""
    merged: Intervals = []
    for start, end in sorted(stretches):
        if merged and start <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(merged[-1][1], end))
        else:
            merged.append((start, end))
    return merged


def _apart(heights: Heights, near: float) -> Intervals:
    """Return the highest of each cluster of positions, as points."""
    groups: list[list[tuple[float, float]]] = []
    for x, height in sorted((x, height) for height, start, end in heights for x in (start, end)):
        if groups and x - groups[-1][-1][0] <= near:
            groups[-1].append((x, height))
        else:
            groups.append([(x, height)])
    tops = [max(group, key=lambda spot: spot[1])[0] for group in groups]
    return [(x, x) for x in tops]


def _greatest_on_lines(plan: OutputPlan, fired: Fired, x0: float, x1: float) -> Heights:
    """Return the one-sided heights at the ends of a cell, and constant stretches."""
    norm = SNORMS[plan.output.aggregation].scalar
    ends = [_ends_of_line(plan.members[index], strength, x0, x1) for index, strength in fired]
    shares = {0.0, 1.0}
    if plan.output.aggregation in CEILINGS:
        left, right = (math.fsum(line[side] for line in ends) for side in (0, 1))
        sums = [(left, right)]
        if plan.output.aggregation == "nilpotent":
            sums = [(a[0] + b[0], a[1] + b[1]) for a, b in combinations(ends, 2)]
        # A bounded sum bends where it reaches 1: one more edge inside the cell.
        shares |= {(1.0 - a) / (b - a) for a, b in sums if (a - 1.0) * (b - 1.0) < 0.0}

    def height(share: float) -> float:
        return reduce(norm, ((1.0 - share) * a + share * b for a, b in ends), 0.0)

    heights_found = []
    for start, end in pairwise(sorted(shares)):
        a, b = (x0 + (x1 - x0) * share for share in (start, end))
        inside = [height(start + (end - start) * share) for share in (1e-6, 0.5, 1.0 - 1e-6)]
        if max(inside) - min(inside) <= SAME * max(inside):
            heights_found.append((min(inside), a, b))
        heights_found += [(height(start), a, a), (height(end), b, b)]
    return heights_found


def _ends_of_line(member: Member, strength: float, x0: float, x1: float) -> tuple[float, float]:
    """Return the one-sided limits of a cut set at the ends of a cell where it is (nearly) straight.

    Extrapolated from two inner points: at the ends the set, or its implication, may jump.
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
    heights_found = [(y, x, x) for x, y in zip(xs, ys, strict=True)]
    for i in range(1, len(xs) - 1):
        if ys[i] >= ys[i - 1] and ys[i] >= ys[i + 1] and ys[i] > min(ys[i - 1], ys[i + 1]):
            x = golden(value, xs[i - 1], xs[i + 1], 1.0, xs[i])
            heights_found.append((value(x), x, x))
    return heights_found


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
        # A curved top may be flat beyond the last sample: its extent, by bisection.
        for start, way in ((inside[0], -step), (inside[-1], step)) if inside else ():
            end = min(x1, max(x0, start + way))
            reach = bisect(lambda x: float(value(x) >= greatest), start, end, 0.5)
            wide.append((min(start, reach), max(start, reach)))
    return wide


def _figures(intervals: Intervals) -> Figures:
    first, last = min(a for a, _ in intervals), max(b for _, b in intervals)
    nearest = nearest_to_zero(a if a > 0.0 else min(0.0, b) for a, b in sorted(intervals))
    return {"first": first, "last": last, "mean": _mean(intervals, first), "nearest": nearest}


def _mean(intervals: Intervals, reach: float) -> float:
    """Return the mean of all positions from `reach` on; of points, if all are points."""
    length = moment = 0.0
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


def nearest_to_zero(positions: Iterable[float]) -> float:
    """Return the position nearest to 0; of two equally near ones the first."""
    return min(positions, key=abs)
