"""The aggregate of one output at many points of the inputs, and its adaptive quadrature."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.expression.kinds import SNORMS, TNORMS
from fuzzyarm.inference.aggregate import positions, sampled_set, weights
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.quadrature import (
    CLIPPING,
    DEEPEST,
    MOST_PANELS,
    NODES,
    TOLERANCE,
    WEIGHTS,
    noise_of,
    panels,
)
from fuzzyarm.inference.sets import BELOW_ONE, cut_lines, degrees, gaps, plateaus

# --- The aggregate of one output at many points of the inputs ---

Array = NDArray[np.float64]

ArrayFigures = dict[str, Array]
"""Numbers of aggregates, by their names in :mod:`fuzzyarm.expression.defuzzifiers`."""


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


def _aggregate_at(plan: OutputPlan, entries: list[tuple[int, Array]], xs: Array) -> Array:
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


def sum_by_point(point: NDArray[np.intp], amounts: Array, count: int) -> Array:
    """Return the sum of the amounts of each of `count` points."""
    return np.bincount(point, amounts, minlength=count).astype(float, copy=False)


# --- The adaptive quadrature of `.quadrature` for many points at once ---
#
# All unfinished panels of all points are one list; each round halves them together.

Entries = list[tuple[int, Array]]

_AT_ONCE = 1 << 14


@dataclass(frozen=True, slots=True)
class Leaves:
    """Finished panels, point by point from left to right: arrays of one length."""

    point: NDArray[np.intp]
    x0: Array
    x1: Array
    area: Array
    moment: Array


def leaves_over_arrays(plan: OutputPlan, entries: Entries, count: int) -> Leaves:
    """Integrate the aggregates of `count` points.

    Parameters
    ----------
    plan : OutputPlan
        The output.
    entries : list of (int, ndarray of shape (count,))
        Member and strength.
    count : int
        Number of points.

    Returns
    -------
    Leaves
        Of every point.
    """
    output = plan.output
    centre, half_range = 0.5 * (output.low + output.high), 0.5 * (output.high - output.low)
    point, x0, x1 = _first_panels(plan, entries, count)
    area, moment = panel_rule(plan, entries, point, x0, x1, centre)
    total = sum_by_point(point, area, count)
    strongest = np.maximum.reduce([strength for _, strength in entries])
    noise = np.array([noise_of(plan, 1.0)]) * np.minimum(1.0, strongest)
    if noise_of(plan, 0.0) > 0.0:  # rounding that does not shrink with the strengths
        noise = np.full(count, noise_of(plan, 1.0))
    finished: list[tuple[NDArray[np.intp], Array, Array, Array, Array]] = []
    for depth in range(DEEPEST + 1):
        middle = 0.5 * (x0 + x1)
        area_a, moment_a = panel_rule(plan, entries, point, x0, middle, centre)
        area_b, moment_b = panel_rule(plan, entries, point, middle, x1, centre)
        limit = TOLERANCE * (total[point] + area) + noise[point] * (x1 - x0)
        good = np.abs(area - area_a - area_b) <= limit
        good &= np.abs(moment - moment_a - moment_b) <= limit * half_range
        if depth == DEEPEST:
            good[:] = True
        elif point.size > MOST_PANELS:  # a matter of each point, whatever the others need
            good |= (np.bincount(point, minlength=count) > MOST_PANELS)[point]
        finished.append(
            (point[good], x0[good], x1[good], (area_a + area_b)[good], (moment_a + moment_b)[good])
        )
        open_ = ~good
        if not open_.any():
            break
        point = np.concatenate([point[open_], point[open_]])
        x0, x1 = (
            np.concatenate([x0[open_], middle[open_]]),
            np.concatenate([middle[open_], x1[open_]]),
        )
        area = np.concatenate([area_a[open_], area_b[open_]])
        moment = np.concatenate([moment_a[open_], moment_b[open_]])
    columns = [np.concatenate(column) for column in zip(*finished, strict=True)]
    order = np.lexsort((columns[1], columns[0]))
    return Leaves(*(column[order] for column in columns))


def _first_panels(
    plan: OutputPlan, entries: Entries, count: int
) -> tuple[NDArray[np.intp], Array, Array]:
    """Return the panels of every point: cut at corners and where straight sets bend or cross."""
    edges = [np.broadcast_to(np.array(panels(plan))[:, None], (len(panels(plan)), count))]
    for index, strength in entries:
        member = plan.members[index]
        for offset, factor in CLIPPING.get(member.implication, ()):
            level = offset + factor * strength
            for x0, y0, x1, y1, straight in member.pieces:
                if straight and y0 != y1:
                    cuts = ((y0 - level) * (y1 - level) < 0.0) & (strength > 0.0)
                    if cuts.any():
                        x = x0 + (x1 - x0) * ((level - y0) / (y1 - y0))
                        edges.append(np.where(cuts, x, x0)[None, :])
    edges += [cross[None, :] for cross in _crossings_over_arrays(plan, entries)]
    borders = np.sort(np.concatenate(edges), axis=0).T
    real = borders[:, 1:] > borders[:, :-1]
    return np.nonzero(real)[0], borders[:, :-1][real], borders[:, 1:][real]


def _crossings_over_arrays(plan: OutputPlan, entries: Entries) -> list[Array]:
    forms = {
        index: (lines, strength > 0.0)
        for index, strength in entries
        if (lines := cut_lines(plan.members[index].implication, strength)) is not None
    }
    crossings = []
    for stretch in plan.stretches:
        if stretch.first not in forms or stretch.second not in forms:
            continue
        (first, first_fires), (second, second_fires) = forms[stretch.first], forms[stretch.second]
        both = first_fires & second_fires
        if not both.any():
            continue
        for before, after in gaps(stretch, first, second):
            cross = np.broadcast_to(before * after < 0.0, both.shape) & both
            if cross.any():
                share = np.where(cross, before, 0.0) / np.where(cross, before - after, 1.0)
                crossings.append(stretch.start + (stretch.end - stretch.start) * share)
    return crossings


def panel_rule(
    plan: OutputPlan,
    entries: Entries,
    point: NDArray[np.intp],
    x0: Array,
    x1: Array,
    centre: float,
) -> tuple[Array, Array]:
    """Return area and moment of panels; `point` says whose aggregate each belongs to."""
    area, moment = np.empty(point.size), np.empty(point.size)
    for start in range(0, point.size, _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        middle, half = 0.5 * (x0[part] + x1[part]), 0.5 * (x1[part] - x0[part])
        pairs = [(member, strength[point[part]]) for member, strength in entries]
        xs = np.empty((2 * len(NODES), middle.size))
        for i, node in enumerate(NODES):
            step = half * node
            xs[2 * i], xs[2 * i + 1] = middle - step, middle + step
        xs[-2] = np.nextafter(x0[part], x1[part])
        xs[-1] = np.nextafter(x1[part], x0[part])
        heights = _aggregate_at(plan, pairs, xs.T).T
        whole, torque = np.zeros(middle.size), np.zeros(middle.size)
        for i, (node, weight) in enumerate(zip(NODES, WEIGHTS, strict=True)):
            left, right = heights[2 * i], heights[2 * i + 1]
            whole += weight * (left + right)
            torque += weight * (half * node) * (right - left)
        area[part] = half * whole
        moment[part] = half * (torque + (middle - centre) * whole)
    return area, moment
