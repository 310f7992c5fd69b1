"""Centroid as a sum over N samples, in the ways of other programs.

``endpoints`` is MATLAB's sum (both end samples weigh fully), ``trapezoid`` that of
Octave's toolkit, ``midpoints`` fuzzylite's, ``left`` jFuzzyLogic's.
"""

from __future__ import annotations

from operator import mul
from typing import TYPE_CHECKING

from fuzzyarm.inference.defuzzify.one_aggregate import Fired, aggregate_sampled
from fuzzyarm.inference.plan import OutputPlan

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.defuzzify.many_aggregate import Strengths

    Array = NDArray[np.float64]


def one(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the centroid of the samples, or None where all are 0."""
    samples, heights = aggregate_sampled(plan, fired)
    if plan.output.defuzzifier.sampling == "trapezoid":
        heights[0] *= 0.5
        heights[-1] *= 0.5
    area = sum(heights)
    moment = sum(map(mul, heights, samples))
    return moment / area if area > 0.0 else None


def many(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the centroids and the sums of the samples (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.defuzzify.many_aggregate import aggregate_sampled as sampled_many
    from fuzzyarm.inference.defuzzify.many_aggregate import sample_weights

    samples, heights = sampled_many(plan, strengths)
    # Sums along rows rather than a matrix product: the same digits for every chunking.
    heights *= sample_weights(plan)
    area = heights.sum(axis=1)
    heights *= samples
    moment = heights.sum(axis=1)
    value = np.divide(moment, area, out=np.zeros_like(area), where=area > 0.0)
    return value.reshape(strengths.shape), area.reshape(strengths.shape)
