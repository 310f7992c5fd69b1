"""Weighted average and weighted sum of numbers: constants, linear forms, peaks of sets.

The strength of the rules that share a consequent is folded by the aggregation first, so
``aggregation sum`` adds every rule by itself (Takagi and Sugeno), ``max`` takes the
strongest. The centroid of singletons is the same average.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from fuzzyarm.inference.defuzzify.one_aggregate import Fired, fold
from fuzzyarm.inference.plan import OutputPlan

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.defuzzify.many_aggregate import Strengths

    Array = NDArray[np.float64]


def one(plan: OutputPlan, fired: Fired, value_of: Callable[[int, float], float]) -> float | None:
    """Return the average (or sum), or None where no rule fired.

    `value_of` gives the number of a member at its folded strength.
    """
    total = weighted = 0.0
    for member, strength in fold(plan, fired).items():
        total += strength
        weighted += strength * value_of(member, strength)
    if not total > 0.0:
        return None
    return weighted if plan.output.defuzzifier.method == "weighted-sum" else weighted / total


def many(
    plan: OutputPlan, strengths: Strengths, value_of: Callable[[int, Array], Array | float]
) -> tuple[Array, Array]:
    """Return the averages (or sums) and the sums of the strengths (0 where nothing fired)."""
    import numpy as np

    from fuzzyarm.inference.defuzzify.many_aggregate import fold as fold_many

    total, weighted = np.zeros(strengths.shape), np.zeros(strengths.shape)
    for member, strength in fold_many(plan, list(strengths)).items():
        total += strength
        value = value_of(member, strength)
        # A consequent without a value where its rule does not fire (1/0) must not spoil the sum.
        weighted += np.where(strength > 0.0, strength * value, 0.0)
    if plan.output.defuzzifier.method == "weighted-sum":
        return weighted, total
    return np.divide(weighted, total, out=weighted, where=total > 0.0), total
