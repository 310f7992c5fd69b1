"""The samples of an output, and its aggregate at one point of the inputs, in plain Python."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from typing import NamedTuple

from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.plan import OutputPlan
from fuzzyarm.inference.sets import degrees, term_function
from fuzzyarm.language.model.rulebase import Defuzzifier, Hedge, Shape
from fuzzyarm.language.model.shapes import apply_hedges
from fuzzyarm.symbolic.kinds import SHAPES, SNORMS, TNORMS
from fuzzyarm.symbolic.lines import sampled_degrees
from fuzzyarm.symbolic.records import emptied_with_kinds

# --- The sample points of a defuzzifier, in plain Python and over arrays alike ---


def positions(low: float, high: float, count: int, sampling: str) -> list[float]:
    """Return the sample points over a range, in order; InferenceError for too few.

    ``endpoints``, ``trapezoid`` and ``joined`` have both ends, ``midpoints`` the middles of `count`
    equal stretches, ``left`` their left ends.
    """
    both_ends = sampling in {"endpoints", "trapezoid", "joined"}
    if count < (2 if both_ends else 1):
        raise InferenceError(f"a defuzzifier cannot work with {count} samples at {sampling}")
    width = high - low
    if both_ends:
        return [low + width * (i / (count - 1)) for i in range(count - 1)] + [high]
    shift = 0.5 if sampling == "midpoints" else 0.0
    return [low + width * ((i + shift) / count) for i in range(count)]


def weights(count: int, sampling: str) -> list[float]:
    """Return the weight of each sample in a sum: 1, or ½ at the ends of ``trapezoid``."""
    if sampling != "trapezoid":
        return [1.0] * count
    return [0.5, *[1.0] * (count - 2), 0.5]


# --- The aggregate of one output at one point of the inputs, in plain Python ---

Fired = Sequence[tuple[int, float]]
"""(index of a member, firing strength above 0), in the order of the rules."""

Figures = dict[str, float]
"""Numbers that an aggregate has, by their names in :mod:`fuzzyarm.symbolic.defuzzifiers`."""


def aggregate(plan: OutputPlan, fired: Fired) -> Callable[[float], float]:
    """Return the aggregate as a function of the position in the output's range."""
    norm = SNORMS[plan.output.aggregation].scalar
    parts = []
    for index, strength in folded_where_max(plan, fired):
        member = plan.members[index]
        parts.append((TNORMS[member.implication].scalar, strength, member.membership))

    def value(y: float) -> float:
        total = 0.0
        for implication, strength, membership in parts:
            total = norm(total, implication(strength, membership(y)))
        return total

    return value


MOST_PLAIN_SAMPLES = 20_000
"""Samples of a set computed one by one; more are computed by NumPy, with the same bits."""


class SampledSet(NamedTuple):
    """A set at the samples of its output: the stretch that is not zero."""

    first: int
    heights: tuple[float, ...]

    def over(self, count: int) -> tuple[float, ...]:
        """Return the heights at all `count` samples."""
        behind = count - self.first - len(self.heights)
        return (*[0.0] * self.first, *self.heights, *[0.0] * behind)


@lru_cache(maxsize=512)
def sampled_set(
    shape: Shape,
    hedges: tuple[Hedge, ...],
    low: float,
    high: float,
    defuzzifier: Defuzzifier,
) -> SampledSet:
    """Return a set at the samples of a defuzzifier; the last few are remembered."""
    samples = sample_positions(low, high, defuzzifier)
    corners = SHAPES[shape.kind].corners
    if corners is not None:
        plain = sampled_degrees(corners(*shape.parameters), samples)
        heights = [apply_hedges(hedges, shape.height * degree) for degree in plain]
    elif len(samples) > MOST_PLAIN_SAMPLES:
        import numpy as np

        heights = degrees(shape, np.array(samples), hedges).tolist()
    else:
        heights = list(map(term_function(shape, hedges), samples))
    inside = [i for i, height in enumerate(heights) if height > 0.0]
    if not inside:
        return SampledSet(0, ())
    return SampledSet(inside[0], tuple(heights[inside[0] : inside[-1] + 1]))


emptied_with_kinds(sampled_set.cache_clear)


def sample_positions(low: float, high: float, defuzzifier: Defuzzifier) -> list[float]:
    """Return the sample points of a sampled defuzzifier."""
    assert defuzzifier.resolution is not None
    return positions(low, high, defuzzifier.resolution, defuzzifier.sampling)


def folded_strengths(plan: OutputPlan, fired: Fired) -> dict[int, float]:
    """Return one strength for each member, in their order: its rules under the aggregation."""
    norm = SNORMS[plan.output.aggregation].scalar
    folded: dict[int, float] = {}
    for member, strength in fired:
        folded[member] = norm(folded[member], strength) if member in folded else strength
    return dict(sorted(folded.items()))


def folded_where_max(plan: OutputPlan, fired: Fired) -> Fired:
    """Return one strength for each member under max: a T-norm rises with the strength."""
    return (
        list(folded_strengths(plan, fired).items()) if plan.output.aggregation == "max" else fired
    )


def added_up(numbers: Iterable[float]) -> float:
    """Return the sum from left to right, each addition rounded.

    ``sum`` of Python 3.12 and later compensates rounding, and other engines do not.
    """
    total = 0.0
    for number in numbers:
        total += number
    return total
