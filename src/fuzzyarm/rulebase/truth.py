"""The truth of an antecedent at one point, in plain Python."""

from __future__ import annotations

from collections.abc import Callable

from fuzzyarm.rulebase.membership import apply_hedges
from fuzzyarm.rulebase.model import Expression, Hedged, Is, Or, RuleBlock
from fuzzyarm.rulebase.norms import SNORMS, TNORMS

Degree = Callable[[str, str], float]
"""Membership of the present value of a variable in one of its terms, by their names."""


def truth(expression: Expression, degree: Degree, block: RuleBlock) -> float:
    """Return the truth of `expression`, 0 to 1, by the norms of `block`.

    Parameters
    ----------
    expression : Expression
        An antecedent.
    degree : callable
        ``degree(variable, term)`` gives the membership.
    block : RuleBlock
        Names the conjunction and the disjunction.
    """
    if isinstance(expression, Is):
        return apply_hedges(expression.hedges, degree(expression.variable, expression.term))
    if isinstance(expression, Hedged):
        return apply_hedges(expression.hedges, truth(expression.operand, degree, block))
    norm = SNORMS[block.disjunction] if isinstance(expression, Or) else TNORMS[block.conjunction]
    result, *rest = (truth(operand, degree, block) for operand in expression.operands)
    for value in rest:
        result = norm(result, value)
    return result
