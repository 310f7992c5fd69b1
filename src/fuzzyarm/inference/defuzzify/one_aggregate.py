"""The aggregate of one output at one point of the inputs, in plain Python."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from fuzzyarm.inference.plan import OutputPlan
from fuzzyarm.rulebase.norms import SNORMS, TNORMS

Fired = Sequence[tuple[int, float]]
"""(index of a member, firing strength above 0), in the order of the rules."""


def aggregate(plan: OutputPlan, fired: Fired) -> Callable[[float], float]:
    """Return the aggregate as a function of the place in the output's range."""
    norm = SNORMS[plan.output.aggregation]
    parts = [
        (TNORMS[plan.members[member].implication], strength, plan.members[member].membership)
        for member, strength in fired
    ]

    def value(y: float) -> float:
        total = 0.0
        for implication, strength, membership in parts:
            total = norm(total, implication(strength, membership(y)))
        return total

    return value


def fold(plan: OutputPlan, fired: Fired) -> dict[int, float]:
    """Return one strength for each member: those of its rules under the aggregation."""
    norm = SNORMS[plan.output.aggregation]
    folded: dict[int, float] = {}
    for member, strength in fired:
        folded[member] = norm(folded[member], strength) if member in folded else strength
    return folded
