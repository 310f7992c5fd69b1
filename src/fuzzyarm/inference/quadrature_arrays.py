"""The adaptive quadrature of :mod:`.quadrature` for many points of the inputs at once.

All unfinished panels of all points are one list; each round halves them together. What is halved
does not depend on the order, unless a point has so many panels that they run out: such a point is
done once more, in the order of the plain one, so that both have the same bits.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.aggregate_arrays import Array, aggregate_over_arrays
from fuzzyarm.inference.plan import OutputPlan
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
from fuzzyarm.inference.sets import cut_lines, gaps

Entries = list[tuple[int, Array]]

_AT_ONCE = 1 << 14


class PanelsOfPoints(NamedTuple):
    """Panels of some points: whose each is, its ends, its area, its moment about the centre."""

    point: NDArray[np.intp]
    x0: Array
    x1: Array
    area: Array
    moment: Array

    def where(self, chosen: NDArray[Any]) -> PanelsOfPoints:
        """Return the panels that a mask or indices choose."""
        return PanelsOfPoints(*(column[chosen] for column in self))


def _one_list(lists: Sequence[PanelsOfPoints]) -> PanelsOfPoints:
    return PanelsOfPoints(*map(np.concatenate, zip(*lists, strict=True)))


class _Quadrature:
    """The aggregates of `count` points, and when the halves of their panels agree."""

    def __init__(self, plan: OutputPlan, entries: Entries, count: int) -> None:
        output = plan.output
        self.plan, self.entries = plan, entries
        self.centre, self.half_range = (
            0.5 * (output.low + output.high), 0.5 * (output.high - output.low)
        )  # fmt: skip
        point, x0, x1 = _first_panels(plan, entries, count)
        area, moment = panel_rule(plan, entries, point, x0, x1, self.centre)
        self.first = PanelsOfPoints(point, x0, x1, area, moment)
        self.total = sum_by_point(point, area, count)
        strongest = np.maximum.reduce([strength for _, strength in entries])
        self.noise = np.array([noise_of(plan, 1.0)]) * np.minimum(1.0, strongest)
        if noise_of(plan, 0.0) > 0.0:  # rounding that does not shrink with the strengths
            self.noise = np.full(count, noise_of(plan, 1.0))

    def halved(
        self, panels: PanelsOfPoints
    ) -> tuple[PanelsOfPoints, PanelsOfPoints, NDArray[np.bool_]]:
        """Return the left and the right halves, and whether they agree with the wholes."""
        point, x0, x1, area, moment = panels
        middle = 0.5 * (x0 + x1)
        left, right = (
            PanelsOfPoints(point, start, end, *panel_rule(
                self.plan, self.entries, point, start, end, self.centre))
            for start, end in ((x0, middle), (middle, x1))
        )  # fmt: skip
        limit = TOLERANCE * (self.total[point] + area) + self.noise[point] * (x1 - x0)
        agree = np.abs(area - left.area - right.area) <= limit
        agree &= np.abs(moment - left.moment - right.moment) <= limit * self.half_range
        return left, right, agree

    def leaves_in_order(self, panels: PanelsOfPoints) -> PanelsOfPoints:
        """Finish one point as :func:`.leaves_at_point` does, whose panels run out on the way.

        That goes from left to right: a panel comes before its left half, and that, with all its
        halves, before the right one. In this order the first MOST_PANELS are halved where they have
        to be, and those that are left over then are taken as they are. Here all of one depth are
        halved together, but none that is known to come too late.
        """
        count = panels.point.size
        family = _Origins(
            np.zeros(count, np.intp), np.arange(count), np.zeros(count, np.int64),
            np.full(count, -1),
        )  # fmt: skip
        families, finished, agreements, panels_so_far = [], [], [], 0
        for depth in range(DEEPEST + 1):
            left, right, agree = self.halved(panels)
            agree |= depth == DEEPEST
            families.append(family)
            finished.append(_whole(left, right))
            agreements.append(agree)
            parents, rank = _ranked(families)
            split = np.flatnonzero(~agree & (rank[panels_so_far:] < MOST_PANELS))
            if not split.size:
                break
            panels = _one_list([left.where(split), right.where(split)])
            family = family.halves(split, panels_so_far)
            panels_so_far = rank.size
        in_time = rank < MOST_PANELS
        # One that comes too late is there because the whole of which it is a half did not.
        halved_in_time = (parents < 0) | in_time[parents]
        chosen = np.where(in_time, np.concatenate(agreements), halved_in_time)
        return _one_list(finished).where(chosen)


class _Origins(NamedTuple):
    """Where panels of one point come from.

    How often they were halved, out of which first panel; which halves they are, a bit for each
    halving from DEEPEST down (1: the right one); and the number of the whole, or -1.
    """

    depth: NDArray[np.intp]
    first: NDArray[np.intp]
    way: NDArray[np.int64]
    parent: NDArray[np.intp]

    def halves(self, split: NDArray[np.intp], panels_so_far: int) -> _Origins:
        """Return the same of the left halves of some, and then of the right ones.

        `panels_so_far`: how many panels there were before these.
        """
        depth, first, way, _ = (column[split] for column in self)
        right = way | (1 << (DEEPEST - 1 - depth))
        return _Origins(
            np.tile(depth + 1, 2), np.tile(first, 2), np.concatenate([way, right]),
            np.tile(panels_so_far + split, 2),
        )  # fmt: skip


def _ranked(families: Sequence[_Origins]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the wholes of panels, and when they come: left to right, wholes before halves."""
    depth, first, way, parent = map(np.concatenate, zip(*families, strict=True))
    rank = np.empty(depth.size, np.intp)
    rank[np.lexsort((depth, way, first))] = np.arange(depth.size)
    return parent, rank


def _whole(left: PanelsOfPoints, right: PanelsOfPoints) -> PanelsOfPoints:
    """Return finished panels: the sums of their halves."""
    return PanelsOfPoints(
        left.point, left.x0, right.x1, left.area + right.area, left.moment + right.moment
    )


def leaves_over_arrays(plan: OutputPlan, entries: Entries, count: int) -> PanelsOfPoints:
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
    PanelsOfPoints
        The finished ones of every point, point by point from left to right.
    """
    quadrature = _Quadrature(plan, entries, count)
    panels = quadrature.first
    looked_at, hard = np.zeros(count, np.intp), np.zeros(count, bool)
    finished = []
    for depth in range(DEEPEST + 1):
        looked_at += np.bincount(panels.point, minlength=count)
        if (looked_at > MOST_PANELS).any():  # a matter of each point, whatever the others need
            hard |= looked_at > MOST_PANELS
            panels = panels.where(~hard[panels.point])
        left, right, agree = quadrature.halved(panels)
        agree |= depth == DEEPEST
        finished.append(_whole(left, right).where(agree))
        if agree.all():
            break
        panels = _one_list([left.where(~agree), right.where(~agree)])
    leaves = _one_list(finished)
    if hard.any():
        first = quadrature.first
        alone = [first.where(first.point == point) for point in np.flatnonzero(hard)]
        leaves = _one_list(
            [leaves.where(~hard[leaves.point]), *map(quadrature.leaves_in_order, alone)]
        )
    return leaves.where(np.lexsort((leaves.x0, leaves.point)))


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
        heights = aggregate_over_arrays(plan, pairs, xs.T).T
        whole, torque = np.zeros(middle.size), np.zeros(middle.size)
        for i, (node, weight) in enumerate(zip(NODES, WEIGHTS, strict=True)):
            left, right = heights[2 * i], heights[2 * i + 1]
            whole += weight * (left + right)
            torque += weight * (half * node) * (right - left)
        area[part] = half * whole
        moment[part] = half * (torque + (middle - centre) * whole)
    return area, moment


def sum_by_point(point: NDArray[np.intp], amounts: Array, count: int) -> Array:
    """Return the sum of the amounts of each of `count` points."""
    return np.bincount(point, amounts, minlength=count).astype(float, copy=False)
