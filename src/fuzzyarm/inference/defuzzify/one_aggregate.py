"""The aggregate of one output at one point of the inputs, in plain Python."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import NamedTuple

from fuzzyarm.inference.plan import OutputPlan, term_function
from fuzzyarm.inference.sampling import places
from fuzzyarm.rulebase.model import Defuzzifier, Hedge, Shape
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


class SampledSet(NamedTuple):
    """A set at the samples of its output: the stretch that is not zero."""

    first: int
    heights: tuple[float, ...]


@lru_cache(maxsize=512)
def sampled_set(
    shape: Shape,
    hedges: tuple[Hedge, ...],
    low: float,
    high: float,
    defuzzifier: Defuzzifier,
) -> SampledSet:
    """Return a set at the samples of a defuzzifier; the last few are remembered."""
    function = term_function(shape, hedges)
    heights = [function(y) for y in sample_places(low, high, defuzzifier)]
    inside = [i for i, height in enumerate(heights) if height > 0.0]
    if not inside:
        return SampledSet(0, ())
    return SampledSet(inside[0], tuple(heights[inside[0] : inside[-1] + 1]))


def sample_places(low: float, high: float, defuzzifier: Defuzzifier) -> list[float]:
    """Return where a sampled defuzzifier looks."""
    assert defuzzifier.resolution is not None
    return places(low, high, defuzzifier.resolution, defuzzifier.sampling)


def aggregate_sampled(plan: OutputPlan, fired: Fired) -> tuple[list[float], list[float]]:
    """Return the samples of an output and the aggregate there."""
    output = plan.output
    samples = sample_places(output.low, output.high, output.defuzzifier)
    norm = SNORMS[output.aggregation]
    total = [0.0] * len(samples)
    for member, strength in fired:
        term, hedges, implication = plan.members[member][:3]
        first, heights = sampled_set(
            term.shape, hedges, output.low, output.high, output.defuzzifier
        )
        cut = TNORMS[implication]
        for i, height in enumerate(heights, first):
            total[i] = norm(total[i], cut(strength, height))
    return samples, total


def fold(plan: OutputPlan, fired: Fired) -> dict[int, float]:
    """Return one strength for each member: those of its rules under the aggregation."""
    norm = SNORMS[plan.output.aggregation]
    folded: dict[int, float] = {}
    for member, strength in fired:
        folded[member] = norm(folded[member], strength) if member in folded else strength
    return folded
