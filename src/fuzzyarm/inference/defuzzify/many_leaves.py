"""The adaptive quadrature of :mod:`.quadrature` for many points at once.

All unfinished panels of all points are one list; each round halves them together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.crossings import FORMS, gaps
from fuzzyarm.inference.defuzzify.many_aggregate import aggregate_at, sum_by_point
from fuzzyarm.inference.defuzzify.quadrature import (
    CLIPPING,
    DEEPEST,
    MOST_PANELS,
    NODES,
    TOLERANCE,
    WEIGHTS,
    noise_of,
    panels,
)
from fuzzyarm.inference.plan import OutputPlan

Array = NDArray[np.float64]
Entries = list[tuple[int, Array]]

_NODES = np.array([*(-node for node in reversed(NODES)), *NODES])
_WEIGHTS = np.array([*reversed(WEIGHTS), *WEIGHTS])
_AT_ONCE = 1 << 14


@dataclass(frozen=True, slots=True)
class Leaves:
    """Finished panels of many points, in no order: arrays of one length."""

    point: NDArray[np.intp]
    x0: Array
    x1: Array
    area: Array
    moment: Array


def many_leaves(plan: OutputPlan, entries: Entries, count: int) -> Leaves:
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
        if depth == DEEPEST or point.size > MOST_PANELS * count:
            good[:] = True
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
    return Leaves(*columns)


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
                        place = x0 + (x1 - x0) * ((level - y0) / (y1 - y0))
                        edges.append(np.where(cuts, place, x0)[None, :])
    edges += [place[None, :] for place in _crossings(plan, entries)]
    borders = np.sort(np.concatenate(edges), axis=0).T
    real = borders[:, 1:] > borders[:, :-1]
    return np.nonzero(real)[0], borders[:, :-1][real], borders[:, 1:][real]


def _crossings(plan: OutputPlan, entries: Entries) -> list[Array]:
    forms = {
        index: (FORMS[plan.members[index].implication](strength), strength > 0.0)
        for index, strength in entries
        if plan.members[index].implication in FORMS
    }
    found = []
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
                found.append(stretch.start + (stretch.end - stretch.start) * share)
    return found


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
        steps = half[:, None] * _NODES
        own = [(member, strength[point[part]]) for member, strength in entries]
        places = middle[:, None] + steps
        places[:, 0] = np.nextafter(x0[part], x1[part])
        places[:, -1] = np.nextafter(x1[part], x0[part])
        values = aggregate_at(plan, own, places) * _WEIGHTS
        total = values.sum(axis=1)
        area[part] = half * total
        moment[part] = half * ((values * steps).sum(axis=1) + (middle - centre) * total)
    return area, moment
