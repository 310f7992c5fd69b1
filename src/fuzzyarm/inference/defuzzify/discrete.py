"""Bisector and maxima of an output whose terms are numbers rather than sets."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from fuzzyarm.inference.defuzzify.bisector import halve, halve_many
from fuzzyarm.inference.defuzzify.maxima import greatest_of, greatest_of_many
from fuzzyarm.inference.defuzzify.one_aggregate import Fired, fold
from fuzzyarm.inference.plan import OutputPlan

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.defuzzify.many_aggregate import Strengths

    Array = NDArray[np.float64]


def one(plan: OutputPlan, fired: Fired, value_of: Callable[[int, float], float]) -> float | None:
    """Return the place, or None where no rule fired."""
    spikes = sorted((value_of(member, w), w) for member, w in fold(plan, fired).items())
    if not spikes:
        return None
    samples, heights = [y for y, _ in spikes], [w for _, w in spikes]
    method = plan.output.defuzzifier.method
    return (
        halve(samples, heights) if method == "bisector" else greatest_of(method, samples, heights)
    )


def many(
    plan: OutputPlan, strengths: Strengths, value_of: Callable[[int, Array], Array | float]
) -> tuple[Array, Array]:
    """Return the places and the greatest strengths (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.defuzzify.many_aggregate import fold as fold_many

    folded = fold_many(plan, list(strengths))
    if not folded:
        return np.zeros(strengths.shape), np.zeros(strengths.shape)
    size = int(np.prod(strengths.shape))
    places, heights = np.empty((size, len(folded))), np.empty((size, len(folded)))
    for column, (member, strength) in enumerate(folded.items()):
        value = value_of(member, strength)
        places[:, column] = np.broadcast_to(value, strengths.shape).ravel()
        heights[:, column] = np.broadcast_to(strength, strengths.shape).ravel()
    order = np.argsort(places, axis=1, kind="stable")
    places, heights = np.take_along_axis(places, order, 1), np.take_along_axis(heights, order, 1)
    value = np.empty(size)
    method = plan.output.defuzzifier.method
    function = halve_many if method == "bisector" else greatest_of_many
    # The order differs from point to point only where values depend on the inputs.
    for row in range(size) if (places != places[0]).any() else [slice(None)]:
        rows = slice(row, row + 1) if isinstance(row, int) else row
        samples = places[rows][0]
        args = (
            (samples, heights[rows]) if method == "bisector" else (method, samples, heights[rows])
        )
        value[rows] = function(*args)[0]
    return value.reshape(strengths.shape), heights.max(axis=1).reshape(strengths.shape)
