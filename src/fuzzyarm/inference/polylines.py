"""Sets and their union as straight lines between N samples, as scikit-fuzzy takes them.

Every set is taken at N even points with both ends and joined by straight lines. It is cut at the
strength of its rule, and the points where a line passes that strength are added to the samples.
The union is taken at all these points and joined again, so that two sets which cross between two of
them are cut off by a chord; of the result the integrals are exact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from fuzzyarm.inference.aggregate import (
    Figures,
    Fired,
    added_up,
    folded_where_max,
    sample_positions,
    sampled_set,
)
from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.plan import OutputPlan
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.aggregate_arrays import ArrayFigures, Strengths

    Array = NDArray[np.float64]

_AT_ONCE = 1 << 20
"""Vertices of many points that are worked on together."""


class _AssertedSet(NamedTuple):
    """A set at the samples, and how strongly it is asserted."""

    degrees: Sequence[float]
    strength: float
    cut: Callable[[float, float], float]
    bends: bool  # whether it is cut off flat, which adds a vertex

    def crosses(self, i: int) -> bool:
        """Whether the line from sample `i` to the next passes the strength."""
        return self.bends and (self.degrees[i] >= self.strength) != (
            self.degrees[i + 1] >= self.strength
        )


# --- At one point ---


def joined_at_point(plan: OutputPlan, fired: Fired) -> Figures | None:
    """Return the centroid or the bisector of the joined union, or None where it has no area."""
    _check(plan)
    xs, ys = _vertices(plan, fired)
    areas = [0.5 * (b - a) * (y + z) for (a, b), (y, z) in zip(pairwise(xs), pairwise(ys))]  # noqa: B905
    total = added_up(areas)
    if not total > 0.0:
        return None
    if plan.record.of == "area":
        return {"half": _half(xs, ys, areas, 0.5 * total)}
    # Six times the moment about 0 of a trapezoid over a .. b, as high as y at a and as z at b.
    moment = added_up(
        (b - a) * (a * (2.0 * y + z) + b * (y + 2.0 * z))
        for (a, b), (y, z) in zip(pairwise(xs), pairwise(ys))  # noqa: B905
    )
    return {"centroid": moment / 6.0 / total}


def _vertices(plan: OutputPlan, fired: Fired) -> tuple[list[float], list[float]]:
    """Return the vertices of the joined union, left to right."""
    output = plan.output
    samples = sample_positions(output.low, output.high, output.defuzzifier)
    norm = SNORMS[output.aggregation].scalar
    parts = [_part(plan, member, strength, len(samples))
             for member, strength in folded_where_max(plan, fired)]  # fmt: skip

    def height(degrees: Sequence[float]) -> float:
        total = 0.0
        for part, degree in zip(parts, degrees, strict=True):
            total = norm(total, part.cut(part.strength, degree))
        return total

    xs, ys = [samples[0]], [height([part.degrees[0] for part in parts])]
    for i, (a, b) in enumerate(pairwise(samples)):
        # A vertex of one set is one of all: on the way to the next sample every line is looked at
        # wherever any of them is cut off.
        before = [part.degrees[i] for part in parts]
        after = [part.degrees[i + 1] for part in parts]
        shares = {
            (part.strength - y) / (z - y)
            for part, y, z in zip(parts, before, after, strict=True)
            if part.crosses(i)
        }
        for share in sorted(shares - {0.0, 1.0}):
            xs.append(a + share * (b - a))
            ys.append(height([y + share * (z - y) for y, z in zip(before, after, strict=True)]))
        xs.append(b)
        ys.append(height(after))
    return xs, ys


def _part(plan: OutputPlan, index: int, strength: float, count: int) -> _AssertedSet:
    output, member = plan.output, plan.members[index]
    sampled = sampled_set(
        member.term.shape, member.hedges, output.low, output.high, output.defuzzifier
    )
    cut = TNORMS[member.implication].scalar
    return _AssertedSet(sampled.over(count), strength, cut, member.implication == "min")


def _half(xs: list[float], ys: list[float], areas: list[float], half: float) -> float:
    """Return where the area from the left reaches `half`."""
    before = 0.0
    for (a, b), (y, z), area in zip(pairwise(xs), pairwise(ys), areas):  # noqa: B905
        if before + area >= half:
            return a + _reach(b - a, y, z, half - before)
        before += area
    return xs[-1]


def _reach(width: float, y: float, z: float, area: float) -> float:
    """Return how far a line from y to z has to be followed for an area under it."""
    if area <= 0.0:
        return 0.0
    slope = (z - y) / width
    # The root of y t + slope t² / 2 = area, in the form that takes no difference of near numbers.
    root = math.sqrt(max(0.0, y * y + 2.0 * slope * area))
    return min(width, 2.0 * area / (y + root))


def _check(plan: OutputPlan) -> None:
    if not plan.record.joins:
        what = f"the {plan.record.name} of '{plan.output.name}'"
        raise InferenceError(f"{what} does not know joined samples")


# --- Over arrays ---


def joined_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[ArrayFigures, Array]:
    """Return centroids or bisectors, and the areas (0 where nothing fired)."""
    import numpy as np

    _check(plan)
    entries = strengths.flat()
    size = int(np.prod(strengths.shape))
    count = plan.output.defuzzifier.resolution or 2
    value, total = np.zeros(size), np.zeros(size)
    step = max(1, _AT_ONCE // ((len(entries) + 2) * count))
    for start in range(0, size, step):
        part = slice(start, start + step)
        pairs = [(member, strength[part]) for member, strength in entries]
        value[part], total[part] = _some(plan, pairs)
    (name,) = plan.record.symbols
    return {name: value.reshape(strengths.shape)}, total.reshape(strengths.shape)


def _some(plan: OutputPlan, entries: list[tuple[int, Array]]) -> tuple[Array, Array]:
    """Return values and areas of P points, whose vertices have the shape (P, cells, M + 2)."""
    import numpy as np

    output = plan.output
    samples = np.array(sample_positions(output.low, output.high, output.defuzzifier))
    # Degrees alone are wanted here, which do not depend on the strength.
    sets = [np.array(_part(plan, member, 1.0, samples.size).degrees) for member, _ in entries]
    shares = [np.zeros((len(entries[0][1]), samples.size - 1))]
    for (member, strength), degree in zip(entries, sets, strict=True):
        if plan.members[member].implication == "min":
            s, y, z = strength[:, None], degree[:-1], degree[1:]
            crosses = ((y >= s) != (z >= s)) & (s > 0.0)
            # One that is not cut off in a cell gets share 0 there: a vertex twice, without a width.
            rise = np.where(crosses, z - y, 1.0)
            shares.append(np.where(crosses, (s - y) / rise, 0.0))
    shares.append(np.ones_like(shares[0]))
    share = np.sort(np.stack(shares, axis=-1), axis=-1)
    norm, heights = SNORMS[output.aggregation].array, np.zeros_like(share)
    for (member, strength), degree in zip(entries, sets, strict=True):
        line = _between(degree, share)
        cut = TNORMS[plan.members[member].implication].array
        heights = norm(heights, cut(strength[:, None, None], line))
    xs = _between(samples, share)
    width = np.diff(xs, axis=-1)
    y, z = heights[..., :-1], heights[..., 1:]
    areas = 0.5 * width * (y + z)
    total = _added_up(areas)
    if plan.record.of == "area":
        return _halves(xs[..., :-1], width, y, z, areas, total), total
    moment = _added_up(width * (xs[..., :-1] * (2.0 * y + z) + xs[..., 1:] * (y + 2.0 * z)))
    return np.divide(moment / 6.0, total, out=np.zeros_like(total), where=total > 0.0), total


def _between(values: Array, share: Array) -> Array:
    """Return what lies at some shares of the ways from value to value, exactly at both ends."""
    import numpy as np

    line: Array = values[:-1, None] + share * np.diff(values)[:, None]
    return np.where(share == 1.0, values[1:, None], line)


def _added_up(parts: Array) -> Array:
    """Return the sum over all cells of each point, from left to right."""
    import numpy as np

    flat = parts.reshape(len(parts), -1)
    return np.asarray(np.add.accumulate(flat, axis=1)[:, -1])


def _halves(xs: Array, width: Array, y: Array, z: Array, areas: Array, total: Array) -> Array:
    """Return for each point where the area from the left reaches a half."""
    import numpy as np

    flat = [array.reshape(len(total), -1) for array in (xs, width, y, z, areas)]
    running = np.cumsum(flat[4], axis=1)
    index = (running >= 0.5 * total[:, None]).argmax(axis=1)
    before = np.concatenate([np.zeros((len(total), 1)), running[:, :-1]], axis=1)
    a, w, y, z, reached = [
        np.take_along_axis(array, index[:, None], axis=1)[:, 0] for array in (*flat[:4], before)
    ]
    target = 0.5 * total - reached
    slope = np.divide(z - y, w, out=np.zeros_like(w), where=w > 0.0)
    root = np.sqrt(np.maximum(0.0, y * y + 2.0 * slope * target))
    far = np.divide(2.0 * target, y + root, out=np.zeros_like(w), where=y + root > 0.0)
    return np.asarray(a + np.minimum(w, np.maximum(0.0, far)))
