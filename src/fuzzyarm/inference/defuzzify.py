"""From the fired rules of one output to its number, at one point or over arrays.

The rarer defuzzifiers are imported where they are used: a check has to start at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, TypeVar

from fuzzyarm.inference.aggregate import Figures, Fired
from fuzzyarm.inference.centroid import (
    closed_centroid_at_point,
    closed_centroid_over_arrays,
    enveloped_centroid_at_point,
    integrated_centroid_at_point,
    integrated_centroid_over_arrays,
    sampled_centroid_at_point,
    sampled_centroid_over_arrays,
)
from fuzzyarm.inference.plan import Member, OutputPlan
from fuzzyarm.inference.weighted import (
    chosen_at_point,
    chosen_over_arrays,
    tsukamoto_at_point,
    tsukamoto_over_arrays,
    weighted_at_point,
    weighted_over_arrays,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fuzzyarm.inference.aggregate_arrays import ArrayFigures, Strengths

    Array = NDArray[np.float64]

_Number = TypeVar("_Number")

CHOICES = frozenset({"top", "area"})
"""What of numbers is one of them, or lies between two."""


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
    figures = _figures_at_point(plan, fired, values, inputs)
    return None if figures is None else float(plan.record.value(figures))


def _figures_at_point(
    plan: OutputPlan, fired: Fired, values: Mapping[str, float], inputs: tuple[str, ...]
) -> Figures | None:
    """Return what a defuzzifier takes of an aggregate, by name."""
    record = plan.record
    # By what is taken of the aggregate, then by what that is made of; ends have their own of each.
    if record.of == "ends":
        ends = ends_of_output(plan, fired, values, inputs)
        return None if ends is None else dict(zip(record.aspect.figures, ends, strict=True))
    if plan.discrete:
        value_of = _number_of(plan, tsukamoto_at_point, consequent_value, values, inputs)
        choose = chosen_at_point if record.of in CHOICES else weighted_at_point
        return choose(plan, fired, value_of)
    if plan.output.defuzzifier.joined:
        from fuzzyarm.inference.polylines import joined_at_point

        return joined_at_point(plan, fired)
    exact = plan.output.defuzzifier.resolution is None
    if record.of == "top":
        from fuzzyarm.inference.maxima import maxima_at_point, sampled_maxima_at_point

        return (maxima_at_point if exact else sampled_maxima_at_point)(plan, fired)
    if record.of == "area":
        from fuzzyarm.inference.bisector import bisector_at_point, sampled_bisector_at_point

        half = (bisector_at_point if exact else sampled_bisector_at_point)(plan, fired)
        return None if half is None else {"half": half}
    centroid = _centroid_at_point(plan, fired)
    return None if centroid is None else {"centroid": centroid}


def ends_of_output(
    plan: OutputPlan, fired: Fired, values: Mapping[str, float], inputs: tuple[str, ...]
) -> tuple[float, float] | None:
    """Return the ends of the centroid of an interval type-2 output; parameters as above."""
    from fuzzyarm.inference.type_reduction import ends_at_point

    value_of = _number_of(plan, tsukamoto_at_point, consequent_value, values, inputs)
    return ends_at_point(plan, fired, lambda member: value_of(member, 0.0))


def _centroid_at_point(plan: OutputPlan, fired: Fired) -> float | None:
    # The cheapest way that is exact: polynomials, an envelope, at last the quadrature.
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
        if plan.record.inverts and member.pieces:
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

    if not len(strengths):
        return np.zeros(strengths.shape), np.zeros(strengths.shape, dtype=bool)
    record = plan.record
    reduced = record.type2 and plan.closed is None
    if plan.enveloped or (reduced and not (plan.discrete and record.both)):
        return _point_by_point(plan, strengths, values, inputs)
    if plan.discrete:
        value_of = _number_of(plan, tsukamoto_over_arrays, _consequent_values, values, inputs)
        choose = chosen_over_arrays if record.of in CHOICES else weighted_over_arrays
        figures, weight = choose(plan, strengths, value_of)
    else:
        figures, weight = _figures_over_arrays(plan, strengths)
    with np.errstate(all="ignore"):  # where nothing fired it may be anything
        return record.value(figures), weight > 0.0


def _figures_over_arrays(plan: OutputPlan, strengths: Strengths) -> tuple[ArrayFigures, Array]:
    """Return what a defuzzifier takes of sets, and something above 0 where a rule fired."""
    if plan.output.defuzzifier.joined:
        from fuzzyarm.inference.polylines import joined_over_arrays

        return joined_over_arrays(plan, strengths)
    exact = plan.output.defuzzifier.resolution is None
    if plan.record.of == "top":
        from fuzzyarm.inference.maxima import maxima_over_arrays, sampled_maxima_over_arrays

        return (maxima_over_arrays if exact else sampled_maxima_over_arrays)(plan, strengths)
    if plan.record.of == "area":
        from fuzzyarm.inference.bisector import bisector_over_arrays, sampled_bisector_over_arrays

        halve = bisector_over_arrays if exact else sampled_bisector_over_arrays
        half, area = halve(plan, strengths)
        return {"half": half}, area
    centroid, area = _centroid_over_arrays(plan, strengths)
    return {"centroid": centroid}, area


def _point_by_point(
    plan: OutputPlan,
    strengths: Strengths,
    values: Mapping[str, Array],
    inputs: tuple[str, ...],
) -> tuple[Array, NDArray[np.bool_]]:
    """Take sets by their envelope, or reduce them, one after the other; the kernel is fast."""
    import numpy as np

    size = int(np.prod(strengths.shape))
    results, fires = np.zeros(size), np.zeros(size, dtype=bool)
    entries = [(member, strength.tolist()) for member, strength in strengths.flat()]
    arguments = {
        name: np.broadcast_to(value, strengths.shape).ravel().tolist()
        for name, value in values.items()
    }
    for i in range(size):
        fired = [(member, strength[i]) for member, strength in entries if strength[i] > 0.0]
        here = {name: value[i] for name, value in arguments.items()}
        value = defuzzify_at_point(plan, fired, here, inputs) if fired else None
        if value is not None:
            results[i], fires[i] = value, True
    return results.reshape(strengths.shape), fires.reshape(strengths.shape)


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
        results: Array = member.term.shape.height * member.formula.evaluate_arrays(values)
        return results
    *coefficients, constant = member.term.shape.parameters
    total = np.asarray(constant)
    for coefficient, name in zip(coefficients, inputs, strict=True):
        total = total + coefficient * values[name]
    return total
