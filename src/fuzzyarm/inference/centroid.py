"""The centroid: of straight sets in closed form, of samples, of anything by quadrature.

Each way has a function for one point (plain Python) and one over arrays; the quadrature is
imported where it is used, because a check has to start at once.
"""

from __future__ import annotations

from functools import reduce
from operator import mul
from typing import TYPE_CHECKING

from fuzzyarm.inference.aggregate import (
    Fired,
    added_up,
    aggregate,
    fold_at_point,
    sampled_aggregate_at_point,
)
from fuzzyarm.inference.envelope import cut_pieces, envelope_of, heap_size, whole_of
from fuzzyarm.inference.overlap import Layers
from fuzzyarm.inference.plan import OutputPlan

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.aggregate_arrays import Strengths

    Array = NDArray[np.float64]


# --- Centroid as a sum over N samples, in the ways of other programs ---
#
# `endpoints` is MATLAB's sum (both end samples weigh fully), `trapezoid` that of
# Octave's toolkit, `midpoints` fuzzylite's, `left` jFuzzyLogic's.


def sampled_centroid_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the centroid of the samples, or None where all are 0."""
    samples, heights = sampled_aggregate_at_point(plan, fired)
    if plan.output.defuzzifier.sampling == "trapezoid":
        heights[0] *= 0.5
        heights[-1] *= 0.5
    area = added_up(heights)
    moment = added_up(map(mul, heights, samples))
    return moment / area if area > 0.0 else None


def sampled_centroid_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the centroids and the sums of the samples (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.aggregate_arrays import sample_weights, sampled_aggregate_over_arrays

    samples, heights = sampled_aggregate_over_arrays(plan, strengths)
    heights *= sample_weights(plan)[:, None]
    area, moment = np.zeros(heights.shape[1]), np.zeros(heights.shape[1])
    for sample, height in zip(samples.tolist(), heights, strict=True):  # in their order
        area += height
        moment += height * sample
    value = np.divide(moment, area, out=np.zeros_like(area), where=area > 0.0)
    return value.reshape(strengths.shape), area.reshape(strengths.shape)


# --- Exact centroid of straight sets without a closed form, by their upper envelope ---


def room_for_envelopes(plan: OutputPlan) -> tuple[list[float], int]:
    """Return a heap for what one point has of envelopes, and where they begin in it."""
    begin, end = heap_size(sum(len(member.pieces) for member in plan.members))
    return [0.0] * end, begin


def envelop_at_point(plan: OutputPlan, fired: Fired, heap: list[float], into: int) -> int:
    """Write down the upper envelope of cut or scaled sets; return where it ends."""
    events = 0
    for index, height in fold_at_point(plan, fired).items():
        member = plan.members[index]
        numbers = [number for piece in member.pieces for number in piece[:4]]
        scaled = member.implication == "product"
        events = cut_pieces(numbers, 0, len(member.pieces), height, scaled, heap, events)
    return envelope_of(heap, events, into)


def enveloped_centroid_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the centroid, or None where the envelope has no area."""
    heap, begin = room_for_envelopes(plan)
    area, moment = whole_of(heap, begin, envelop_at_point(plan, fired, heap, begin))
    return moment / area if area > 0.0 else None


# --- Exact centroid of any aggregate, by adaptive quadrature ---


def integrated_centroid_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the centroid, or None where the aggregate has no area."""
    from fuzzyarm.inference.quadrature import edges_of, leaves_at_point, noise_of

    noise = noise_of(plan, max((strength for _, strength in fired), default=0.0))
    parts = leaves_at_point(aggregate(plan, fired, integrated=True), edges_of(plan, fired), noise)
    area = added_up(part.area for part in parts)
    centre = 0.5 * (plan.output.low + plan.output.high)
    return centre + added_up(part.moment for part in parts) / area if area > 0.0 else None


def integrated_centroid_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the centroids and the areas (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.quadrature_arrays import leaves_over_arrays, sum_by_point

    size = int(np.prod(strengths.shape))
    leaves = leaves_over_arrays(plan, strengths.flat(), size)
    area = sum_by_point(leaves.point, leaves.area, size)
    moment = sum_by_point(leaves.point, leaves.moment, size)
    value = np.divide(moment, area, out=np.zeros(size), where=area > 0.0)
    value += 0.5 * (plan.output.low + plan.output.high)
    return value.reshape(strengths.shape), area.reshape(strengths.shape)


# --- Exact centroid of clipped straight sets: polynomials of the heights ---
#
# See `inference.overlap` for the mathematics.


def closed_centroid_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the centroid, or None where nothing has an area."""
    form = plan.closed
    assert form is not None
    area = moment = 0.0
    if plan.output.aggregation == "max":
        heights = fold_at_point(plan, fired)
        for member, height in heights.items():
            area, moment = _with_layers(area, moment, form.set_layers[member], height, 1.0)
        if len(heights) > 1:
            for member, others, layers in form.overlaps:
                height = heights.get(member, 0.0)
                if height > 0.0:
                    above = max([heights.get(other, 0.0) for other in others])
                    if above > 0.0:
                        height = min(height, above)
                        area, moment = _with_layers(area, moment, layers, height, -1.0)
    else:
        for member, height in fired:
            area, moment = _with_layers(area, moment, form.set_layers[member], height, 1.0)
    return form.centre + moment / area if area > 0.0 else None


def _with_layers(
    area: float, moment: float, layers: Layers, height: float, sign: float
) -> tuple[float, float]:
    """Add layers up to a height, one after the other, to an area and a moment."""
    for start, depth, a1, a2, b1, b2, b3 in layers:
        x = height - start
        if x <= 0.0:
            break
        x = min(x, depth)
        area += sign * (x * (a1 + a2 * x))
        moment += sign * (x * (b1 + x * (b2 + b3 * x)))
    return area, moment


def closed_centroid_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the centroids and, for each point, the area (0 where nothing fired)."""
    import numpy as np

    form = plan.closed
    assert form is not None
    work = _Accumulator(strengths.shape)
    for member, height in strengths:  # in the order of the members, or of the rules
        work.add(form.set_layers[member], height, 1.0)
    if plan.output.aggregation == "max":
        heights = dict(strengths)
        cut = np.empty(strengths.shape)
        for member, others, layers in form.overlaps:
            above = [heights[other] for other in others if other in heights]
            if member not in heights or not above:
                continue
            # On an open mesh the heights of rules on fewer inputs have smaller shapes.
            np.minimum(heights[member], reduce(np.maximum, above), out=cut)
            work.add(layers, cut, -1.0)
    value = np.divide(work.moment, work.area, out=work.moment, where=work.area > 0.0)
    value += form.centre
    return value, work.area


class _Accumulator:
    """Sums of layers over a chunk of points, without new arrays."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        import numpy as np

        self.area, self.moment = np.zeros(shape), np.zeros(shape)
        self._x, self._y = np.empty(shape), np.empty(shape)

    def add(self, layers: Layers, height: Array, sign: float) -> None:
        import numpy as np

        y = self._y
        for start, depth, a1, a2, b1, b2, b3 in layers:
            x = self._clip(height, start, depth)
            np.multiply(x, sign * a2, out=y)
            y += sign * a1
            y *= x
            self.area += y
            if b3 == 0.0 and b2 == 0.0 and b1 == 0.0:
                continue
            if b3 != 0.0:
                np.multiply(x, sign * b3, out=y)
                y += sign * b2
                y *= x
            else:
                np.multiply(x, sign * b2, out=y)
            y += sign * b1
            y *= x
            self.moment += y

    def _clip(self, height: Array, start: float, depth: float) -> Array:
        import numpy as np

        if start == 0.0:
            return np.minimum(height, depth, out=self._x)
        np.subtract(height, start, out=self._x)
        return np.clip(self._x, 0.0, depth, out=self._x)
