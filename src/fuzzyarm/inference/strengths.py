"""The firing strength of every rule: one walk, at a point or over arrays.

For explanations. Outputs come from the kernel, and so do the values that later rules read.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from fuzzyarm.inference.engine import compiled
from fuzzyarm.inference.inputs import array_in_range, arrays_of
from fuzzyarm.inference.plan import Plan, PlannedRule, plan
from fuzzyarm.inference.sets import degrees, hedged, term_function
from fuzzyarm.language.model.rulebase import And, Expression, Hedge, Hedged, Is, RuleBase, Shape
from fuzzyarm.language.model.shapes import apply_hedges, straight_lines
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS, Norm

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Strength = Any
"""A float, or an array of them."""


class _Algebra(NamedTuple):
    """The arithmetic of the walk."""

    degree: Callable[[Shape, Strength, tuple[Hedge, ...]], Strength]
    norm: Callable[[Norm], Callable[[Strength, Strength], Strength]]
    hedged: Callable[[Sequence[Hedge], Strength], Strength]
    at_most_one: Callable[[Strength], Strength]
    above: Callable[[Strength, float], Strength]


def _degree(shape: Shape, value: float, hedges: tuple[Hedge, ...]) -> float:
    if math.isnan(value):  # of an output without a value, under `any` too
        return 0.0
    lines = straight_lines(shape, hedges)
    degree = lines.at(value) if lines is not None else term_function(shape, hedges)(value)
    return max(0.0, degree)  # of an output without a value, too


def _float_algebra() -> _Algebra:
    return _Algebra(
        _degree,
        attrgetter("scalar"),
        apply_hedges,
        lambda strength: min(1.0, strength),
        lambda strength, threshold: strength if strength > threshold else 0.0,
    )


def _array_algebra() -> _Algebra:
    import numpy as np

    def degree(shape: Shape, value: Strength, hedges: tuple[Hedge, ...]) -> Strength:
        return np.where(np.isnan(value), 0.0, degrees(shape, value, hedges))

    return _Algebra(
        degree,
        attrgetter("array"),
        hedged,
        lambda strength: np.minimum(1.0, strength),
        lambda strength, threshold: np.where(strength > threshold, strength, 0.0),
    )


class _Walk:
    def __init__(self, steps: Plan, values: Mapping[str, Strength], algebra: _Algebra) -> None:
        self._plan, self._values, self._algebra = steps, values, algebra
        self._degrees: dict[tuple[str, str, tuple[Hedge, ...]], Strength] = {}
        self._strengths: dict[int, Strength] = {}

    def strengths(self) -> list[Strength]:
        for index in self._plan.steps:
            if isinstance(index, int):
                planned = self._plan.rules[index]
                strength = self._truth(planned.rule.antecedent, planned) * planned.rule.weight
                self._strengths[index] = self._algebra.above(strength, planned.threshold)
        return [self._strengths[index] for index in range(len(self._plan.rules))]

    def _truth(self, expression: Expression, planned: PlannedRule) -> Strength:
        if isinstance(expression, Is):
            if expression.variable in planned.degrees:
                return self._activation(expression)
            return self._proposition(expression)
        if isinstance(expression, Hedged):
            return self._algebra.hedged(expression.hedges, self._truth(expression.operand, planned))
        conjunction = isinstance(expression, And)
        record = TNORMS[planned.conjunction] if conjunction else SNORMS[planned.disjunction]
        norm = self._algebra.norm(record)
        first, *rest = expression.operands
        truth = self._truth(first, planned)
        for operand in rest:
            truth = norm(truth, self._truth(operand, planned))
        return truth

    def _proposition(self, part: Is) -> Strength:
        key = (part.variable, part.term, part.hedges)
        if key not in self._degrees:
            shape = self._plan.rulebase.variable(part.variable).term(part.term).shape
            value = self._values[part.variable]
            self._degrees[key] = self._algebra.degree(shape, value, part.hedges)
        return self._degrees[key]

    def _activation(self, part: Is) -> Strength:
        """Return the degree of a term of an output of the same block, from the rules so far."""
        output = self._plan.outputs[part.variable]
        terms = {i for i, member in enumerate(output.members) if member.term.name == part.term}
        norm = self._algebra.norm(SNORMS[output.output.aggregation])
        total: Strength = 0.0
        for member, rule in output.contributions:
            if member in terms:
                total = norm(total, self._strengths[rule])
        # A sum may exceed a degree.
        return self._algebra.hedged(part.hedges, self._algebra.at_most_one(total))


def rule_strengths(steps: Plan, values: Mapping[str, float]) -> list[float]:
    """Return the firing strengths of a plan's rules, and the outputs that later rules read."""
    return _Walk(steps, values, _float_algebra()).strengths()


def firing_strengths(
    rulebase: RuleBase, inputs: Mapping[str, Any]
) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]:
    """Return the firing strengths of all rules at many points, and the outputs there.

    Strengths have the shape (rules, *points), in the order of ``rulebase.rules``: truth of the
    antecedent times the weight; of interval type 2 the upper one. Outputs are NaN where no rule
    fires, whatever the file states for that case.
    """
    import numpy as np

    without_value = tuple(replace(output, no_rule=float("nan")) for output in rulebase.outputs)
    unstated = replace(rulebase, outputs=without_value)
    arrays, shape = arrays_of(rulebase, inputs)
    found = compiled(unstated).evaluate(arrays)
    outputs = {name: np.broadcast_to(np.asarray(column), shape) for name, column in found.items()}
    ranged = {v.name: array_in_range(v, arrays[v.name]) for v in rulebase.inputs}
    steps = plan(unstated)
    strengths = np.zeros((len(rulebase.rules), *shape))
    rows = _Walk(steps, ranged | outputs, _array_algebra()).strengths()
    for rule, readings in enumerate(steps.readings):
        strengths[rule] = rows[readings[0]]
    return strengths, outputs
