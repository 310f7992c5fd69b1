"""Exact centroid of any aggregate, by adaptive quadrature."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.inference.defuzzify.one_aggregate import Fired, aggregate
from fuzzyarm.inference.defuzzify.quadrature import edges_of, leaves, noise_of
from fuzzyarm.inference.plan import OutputPlan

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.defuzzify.many_aggregate import Strengths

    Array = NDArray[np.float64]


def one(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the centroid, or None where the aggregate has no area."""
    noise = noise_of(plan, max((strength for _, strength in fired), default=0.0))
    parts = leaves(aggregate(plan, fired), edges_of(plan, fired), noise)
    area = sum(part.area for part in parts)
    centre = 0.5 * (plan.output.low + plan.output.high)
    return centre + sum(part.moment for part in parts) / area if area > 0.0 else None


def many(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    """Return the centroids and the areas (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.defuzzify.many_aggregate import sum_by_point
    from fuzzyarm.inference.defuzzify.many_leaves import many_leaves

    size = int(np.prod(strengths.shape))
    found = many_leaves(plan, strengths.flat(), size)
    area = sum_by_point(found.point, found.area, size)
    moment = sum_by_point(found.point, found.moment, size)
    value = np.divide(moment, area, out=np.zeros(size), where=area > 0.0)
    value += 0.5 * (plan.output.low + plan.output.high)
    return value.reshape(strengths.shape), area.reshape(strengths.shape)
