"""From the fired rules of one output at many points to its numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.defuzzify import (
    bisector,
    centroid_closed,
    centroid_integrated,
    centroid_sampled,
    discrete,
    maxima,
    tsukamoto,
    weighted,
)
from fuzzyarm.inference.defuzzify.many_aggregate import Strengths
from fuzzyarm.inference.formula import evaluate_arrays
from fuzzyarm.inference.plan import WEIGHTED, Member, OutputPlan

Array = NDArray[np.float64]


def defuzzify_many(
    plan: OutputPlan,
    strengths: Strengths,
    values: Mapping[str, Array],
    inputs: tuple[str, ...],
) -> tuple[Array, NDArray[np.bool_]]:
    """Return the crisp values of an output over a chunk of points.

    Parameters
    ----------
    plan : OutputPlan
        The output.
    strengths : Strengths
        Of its members.
    values : mapping of str to ndarray
        Inputs and earlier outputs, for consequents that depend on them.
    inputs : tuple of str
        Names of the inputs, in the order of linear coefficients.

    Returns
    -------
    (ndarray of float64, ndarray of bool)
        Values, and where there is one; both of the shape of the chunk.
    """
    method, resolution = plan.output.defuzzifier.method, plan.output.defuzzifier.resolution
    if not len(strengths):
        return np.zeros(strengths.shape), np.zeros(strengths.shape, dtype=bool)
    if plan.discrete:
        value_of = _values(plan, values, inputs)
        average = method == "centroid" or method in WEIGHTED
        many = weighted.many if average else discrete.many
        value, weight = many(plan, strengths, value_of)
    elif method == "centroid":
        value, weight = _centroid(plan, strengths)
    elif method == "bisector":
        exact = resolution is None
        value, weight = (bisector.many if exact else bisector.many_sampled)(plan, strengths)
    else:
        exact = resolution is None
        value, weight = (maxima.many if exact else maxima.many_sampled)(plan, strengths)
    return value, weight > 0.0


def _centroid(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    if plan.output.defuzzifier.resolution is not None:
        return centroid_sampled.many(plan, strengths)
    if plan.closed is not None:
        return centroid_closed.many(plan, strengths)
    return centroid_integrated.many(plan, strengths)


def _values(
    plan: OutputPlan, values: Mapping[str, Array], inputs: tuple[str, ...]
) -> Callable[[int, Array], Array | float]:
    def value_of(index: int, strength: Array) -> Array | float:
        member = plan.members[index]
        if member.value is not None:
            return member.value
        if plan.output.defuzzifier.method == "tsukamoto" and member.pieces:
            return tsukamoto.many(plan, member, strength)
        return consequent_values(member, values, inputs)

    return value_of


def consequent_values(
    member: Member, values: Mapping[str, Array], inputs: tuple[str, ...]
) -> Array:
    """Return the numbers of a linear or formula consequent."""
    if member.formula is not None:
        return member.term.shape.height * evaluate_arrays(member.formula, values)
    *coefficients, constant = member.term.shape.parameters
    total = np.asarray(constant)
    for coefficient, name in zip(coefficients, inputs, strict=True):
        total = total + coefficient * values[name]
    return total
