"""From the fired rules of one output to its number, at one point or over arrays.

The rarer defuzzifiers are imported where they are used: a check has to start at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, TypeVar

from fuzzyarm.inference.aggregate import Fired
from fuzzyarm.inference.centroid import (
    closed_centroid_at_point,
    closed_centroid_over_arrays,
    enveloped_centroid_at_point,
    integrated_centroid_at_point,
    integrated_centroid_over_arrays,
    sampled_centroid_at_point,
    sampled_centroid_over_arrays,
)
from fuzzyarm.inference.plan import CENTROIDS, Member, OutputPlan
from fuzzyarm.inference.weighted import (
    tsukamoto_at_point,
    tsukamoto_over_arrays,
    weighted_at_point,
    weighted_over_arrays,
)
from fuzzyarm.model.rulebase import KARNIK_MENDEL, TYPE_2, WEIGHTED

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.aggregate_arrays import Strengths

    Array = NDArray[np.float64]

_Number = TypeVar("_Number")


# --- At one point ---


def defuzzify_at_point(
    plan: OutputPlan, fired: Fired, values: Mapping[str, float], inputs: tuple[str, ...]
) -> float | None:
    """Return the crisp value of an output.

    Parameters
    ----------
    plan : OutputPlan
        The output.
    fired : sequence of (int, float)
        Member and firing strength of the rules that fired.
    values : mapping of str to float
        Inputs and earlier outputs, for consequents that depend on them.
    inputs : tuple of str
        Names of the inputs, in the order of linear coefficients.

    Returns
    -------
    float or None
        None where the aggregate has no area.
    """
    method = plan.output.defuzzifier.method
    if method in KARNIK_MENDEL:
        return _ends_at_point(plan, fired, values, inputs)
    if plan.discrete:
        value_of = _number_of(plan, tsukamoto_at_point, consequent_value, values, inputs)
        if method in CENTROIDS or method in WEIGHTED:
            return weighted_at_point(plan, fired, value_of)
        from fuzzyarm.inference.maxima import discrete_at_point

        return discrete_at_point(plan, fired, value_of)
    if plan.output.defuzzifier.joined:
        from fuzzyarm.inference.joined import joined_at_point

        return joined_at_point(plan, fired)
    return _centroid_at_point(plan, fired) if method in CENTROIDS else _place_at_point(plan, fired)


def _place_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    """Return the bisector or one of the maxima."""
    from fuzzyarm.inference.maxima import (
        bisector_at_point,
        maxima_at_point,
        sampled_bisector_at_point,
        sampled_maxima_at_point,
    )

    exact = plan.output.defuzzifier.resolution is None
    if plan.output.defuzzifier.method == "bisector":
        return bisector_at_point(plan, fired) if exact else sampled_bisector_at_point(plan, fired)
    return maxima_at_point(plan, fired) if exact else sampled_maxima_at_point(plan, fired)


def _ends_at_point(
    plan: OutputPlan, fired: Fired, values: Mapping[str, float], inputs: tuple[str, ...]
) -> float | None:
    from fuzzyarm.inference.type_reduction import chosen

    found = ends_of_output(plan, fired, values, inputs)
    return None if found is None else chosen(plan.output.defuzzifier.method, found)


def ends_of_output(
    plan: OutputPlan, fired: Fired, values: Mapping[str, float], inputs: tuple[str, ...]
) -> tuple[float, float] | None:
    """Return the ends of the centroid of an interval type-2 output; parameters as above."""
    from fuzzyarm.inference.type_reduction import ends_at_point

    value_of = _number_of(plan, tsukamoto_at_point, consequent_value, values, inputs)
    return ends_at_point(plan, fired, lambda member: value_of(member, 0.0))


def _centroid_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    exact = plan.output.defuzzifier.resolution is None
    if exact and plan.closed is not None:
        return closed_centroid_at_point(plan, fired)
    if plan.sides:
        from fuzzyarm.inference.type_reduction import nie_tan_at_point

        return nie_tan_at_point(plan, fired)
    if not exact:
        return sampled_centroid_at_point(plan, fired)
    if plan.enveloped:
        return enveloped_centroid_at_point(plan, fired)
    return integrated_centroid_at_point(plan, fired)


def _number_of(
    plan: OutputPlan,
    invert: Callable[[OutputPlan, Member, _Number], _Number],
    evaluate: Callable[[Member, Mapping[str, _Number], tuple[str, ...]], _Number],
    values: Mapping[str, _Number],
    inputs: tuple[str, ...],
) -> Callable[[int, _Number], _Number | float]:
    """Return what gives the number of a member at a strength (or at an array of them)."""

    def value_of(index: int, strength: _Number) -> _Number | float:
        member = plan.members[index]
        if member.value is not None:
            return member.value
        if plan.output.defuzzifier.method == "tsukamoto" and member.pieces:
            return invert(plan, member, strength)
        return evaluate(member, values, inputs)

    return value_of


def consequent_value(member: Member, values: Mapping[str, float], inputs: tuple[str, ...]) -> float:
    """Return the number of a linear or formula consequent."""
    if member.formula is not None:
        return member.term.shape.height * member.formula.evaluate(values)
    *coefficients, constant = member.term.shape.parameters
    for coefficient, name in zip(coefficients, inputs, strict=True):
        constant += coefficient * values[name]
    return constant


# --- Over arrays ---


def defuzzify_over_arrays(
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
    import numpy as np

    from fuzzyarm.inference.maxima import (
        bisector_over_arrays,
        discrete_over_arrays,
        maxima_over_arrays,
        sampled_bisector_over_arrays,
        sampled_maxima_over_arrays,
    )

    method, resolution = plan.output.defuzzifier.method, plan.output.defuzzifier.resolution
    if not len(strengths):
        return np.zeros(strengths.shape), np.zeros(strengths.shape, dtype=bool)
    reduced = method in TYPE_2 and plan.closed is None
    if plan.enveloped or (reduced and not (plan.discrete and method == "nie-tan")):
        return _point_by_point(plan, strengths, values, inputs)
    if plan.discrete:
        value_of = _number_of(plan, tsukamoto_over_arrays, _consequent_values, values, inputs)
        average = method in CENTROIDS or method in WEIGHTED
        many = weighted_over_arrays if average else discrete_over_arrays
        value, weight = many(plan, strengths, value_of)
    elif plan.output.defuzzifier.joined:
        from fuzzyarm.inference.joined import joined_over_arrays

        value, weight = joined_over_arrays(plan, strengths)
    elif method in CENTROIDS:
        value, weight = _centroid_over_arrays(plan, strengths)
    elif method == "bisector":
        exact = resolution is None
        value, weight = (bisector_over_arrays if exact else sampled_bisector_over_arrays)(
            plan, strengths
        )
    else:
        exact = resolution is None
        value, weight = (maxima_over_arrays if exact else sampled_maxima_over_arrays)(
            plan, strengths
        )
    return value, weight > 0.0


def _point_by_point(
    plan: OutputPlan,
    strengths: Strengths,
    values: Mapping[str, Array],
    inputs: tuple[str, ...],
) -> tuple[Array, NDArray[np.bool_]]:
    """Take sets by their envelope, or reduce them, one after the other; the kernel is fast."""
    import numpy as np

    size = int(np.prod(strengths.shape))
    found, fires = np.zeros(size), np.zeros(size, dtype=bool)
    entries = [(member, strength.tolist()) for member, strength in strengths.flat()]
    given = {
        name: np.broadcast_to(value, strengths.shape).ravel().tolist()
        for name, value in values.items()
    }
    for i in range(size):
        fired = [(member, strength[i]) for member, strength in entries if strength[i] > 0.0]
        here = {name: value[i] for name, value in given.items()}
        value = defuzzify_at_point(plan, fired, here, inputs) if fired else None
        if value is not None:
            found[i], fires[i] = value, True
    return found.reshape(strengths.shape), fires.reshape(strengths.shape)


def _centroid_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[Array, Array]:
    if plan.output.defuzzifier.resolution is not None:
        return sampled_centroid_over_arrays(plan, strengths)
    if plan.closed is not None:
        return closed_centroid_over_arrays(plan, strengths)
    return integrated_centroid_over_arrays(plan, strengths)


def _consequent_values(
    member: Member, values: Mapping[str, Array], inputs: tuple[str, ...]
) -> Array:
    """Return the numbers of a linear or formula consequent."""
    import numpy as np

    if member.formula is not None:
        found: Array = member.term.shape.height * member.formula.evaluate_arrays(values)
        return found
    *coefficients, constant = member.term.shape.parameters
    total = np.asarray(constant)
    for coefficient, name in zip(coefficients, inputs, strict=True):
        total = total + coefficient * values[name]
    return total
