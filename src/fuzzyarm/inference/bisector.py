"""The position that halves the area of an aggregate, exact or sampled.

Where the halves are parted by a gap, the middle of the gap. Sampled, the first sample at
which the running sum of the heights reaches half of the total, as in MATLAB; an exact half
takes the middle towards the next sample. With `midpoints` the sample whose running sum
is nearest to half, or the mean of those that are equally near, as in fuzzylite.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import accumulate
from typing import TYPE_CHECKING

from fuzzyarm.inference.aggregate import (
    Fired,
    added_up,
    aggregate,
    sampled_aggregate_at_point,
)
from fuzzyarm.inference.plan import OutputPlan
from fuzzyarm.inference.quadrature import edges_of, leaves_at_point, noise_of, rule

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.aggregate_arrays import Strengths

    Array = NDArray[np.float64]

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
    values = []
    for share in (0.5 - SAME_HALF, 0.5 + SAME_HALF):
        before = 0.0
        for part in parts:
            if before + part.area >= share * total:
                values.append(_inside(function, part.x0, part.x1, share * total - before))
                break
            before += part.area
        else:
            values.append(parts[-1].x1)
    return 0.5 * (values[0] + values[1])


def _inside(function: Callable[[float], float], x0: float, x1: float, target: float) -> float:
    a, b = x0, x1
    for _ in range(STEPS):
        middle = 0.5 * (a + b)
        if rule(function, x0, middle, 0.0)[0] < target:
            a = middle
        else:
            b = middle
    return 0.5 * (a + b)


def bisector_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the exact bisectors and the areas (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.quadrature_arrays import leaves_over_arrays, panel_rule, sum_by_point

    size = int(np.prod(strengths.shape))
    entries = strengths.flat()
    leaves = leaves_over_arrays(plan, entries, size)
    point, x0, x1, area = leaves.point, leaves.x0, leaves.x1, leaves.area
    total = sum_by_point(point, area, size)
    first = np.searchsorted(point, np.arange(size))
    last = np.append(first[1:], point.size) - 1
    running = _running_sums(area, first, last)
    before = np.concatenate([[0.0], running[:-1]])
    before[first] = 0.0
    ends = []
    for share in (0.5 - SAME_HALF, 0.5 + SAME_HALF):
        reached = running >= (share * total)[point]
        panel = np.minimum.reduceat(np.where(reached, np.arange(point.size), point.size), first)
        panel = np.minimum(panel, last)
        target = share * total - before[panel]
        a, b, points = x0[panel].copy(), x1[panel].copy(), np.arange(size)
        for _ in range(STEPS):
            middle = 0.5 * (a + b)
            below = panel_rule(plan, entries, points, x0[panel], middle, 0.0)[0] < target
            a, b = np.where(below, middle, a), np.where(below, b, middle)
        ends.append(0.5 * (a + b))
    # Half of the sum, as at a point: halves of the least floats would be 0.
    value = 0.5 * (ends[0] + ends[1])
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
    values = [y for y, far in zip(samples, distances, strict=True) if far <= enough]
    return added_up(values) / len(values)


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
    function = _nearest_half_many if midpoints else halve_many
    value, total = function(samples, heights)
    return value.reshape(strengths.shape), total.reshape(strengths.shape)


def _nearest_half_many(samples: Array, heights: Array) -> tuple[Array, Array]:
    """Return what :func:`_nearest_half` does for each column of `heights`, and the totals."""
    import numpy as np

    from fuzzyarm.inference.aggregate_arrays import added_up_rows

    running = np.cumsum(heights, axis=0)
    total = running[-1].copy()
    running /= np.where(total > 0.0, total, 1.0)
    distance = np.abs(running - 0.5)
    among = distance <= distance.min(axis=0) + SAME_HALF
    return added_up_rows(np.where(among, samples[:, None], 0.0)) / among.sum(axis=0), total


def halve_many(samples: Array, heights: Array) -> tuple[Array, Array]:
    """Return what :func:`halve` does for each column of `heights`, and the totals."""
    import numpy as np

    running = np.cumsum(heights, axis=0)
    total = running[-1]
    first, last = (
        samples[(running >= share * total).argmax(axis=0)]
        for share in (0.5 - SAME_HALF, 0.5 + SAME_HALF)
    )
    return 0.5 * (first + last), total
