"""From the fired rules of one output at one point to its number.

The rarer defuzzifiers are imported where they are used: a check has to start at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from fuzzyarm.inference.defuzzify import centroid_closed, weighted
from fuzzyarm.inference.defuzzify.one_aggregate import Fired
from fuzzyarm.inference.plan import WEIGHTED, Member, OutputPlan
from fuzzyarm.rulebase.formula import evaluate


def defuzzify_one(
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
    method, resolution = plan.output.defuzzifier.method, plan.output.defuzzifier.resolution
    if plan.discrete:
        value_of = _values(plan, values, inputs)
        if method == "centroid" or method in WEIGHTED:
            return weighted.one(plan, fired, value_of)
        from fuzzyarm.inference.defuzzify import discrete

        return discrete.one(plan, fired, value_of)
    if method == "centroid":
        return _centroid(plan, fired)
    from fuzzyarm.inference.defuzzify import bisector, maxima

    exact = resolution is None
    if method == "bisector":
        return bisector.one(plan, fired) if exact else bisector.one_sampled(plan, fired)
    return maxima.one(plan, fired) if exact else maxima.one_sampled(plan, fired)


def _centroid(plan: OutputPlan, fired: Fired) -> float | None:
    exact = plan.output.defuzzifier.resolution is None
    if exact and plan.closed is not None:
        return centroid_closed.one(plan, fired)
    from fuzzyarm.inference.defuzzify import centroid_integrated, centroid_sampled

    if not exact:
        return centroid_sampled.one(plan, fired)
    return centroid_integrated.one(plan, fired)


def _values(
    plan: OutputPlan, values: Mapping[str, float], inputs: tuple[str, ...]
) -> Callable[[int, float], float]:
    def value_of(index: int, strength: float) -> float:
        member = plan.members[index]
        if member.value is not None:
            return member.value
        if plan.output.defuzzifier.method == "tsukamoto" and member.pieces:
            from fuzzyarm.inference.defuzzify import tsukamoto

            return tsukamoto.one(plan, member, strength)
        return consequent_value(member, values, inputs)

    return value_of


def consequent_value(member: Member, values: Mapping[str, float], inputs: tuple[str, ...]) -> float:
    """Return the number of a linear or formula consequent."""
    if member.formula is not None:
        return member.term.shape.height * evaluate(member.formula, values)
    *coefficients, constant = member.term.shape.parameters
    for coefficient, name in zip(coefficients, inputs, strict=True):
        constant += coefficient * values[name]
    return constant
