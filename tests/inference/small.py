"""A few short hands for rule bases in tests."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fuzzyarm.language.model.rulebase import (
    Consequent,
    Defuzzifier,
    Expression,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)

LOW_HIGH = (Term("low", Shape("ramp", (1.0, 0.0))), Term("high", Shape("ramp", (0.0, 1.0))))
"""Two terms over 0 … 1 whose memberships are 1 − x and x: strengths to choose freely."""


def inputs(*names: str) -> tuple[Input, ...]:
    return tuple(Input(name, 0.0, 1.0, LOW_HIGH) for name in names)


def terms(**shapes: Shape) -> tuple[Term, ...]:
    return tuple(Term(name, shape) for name, shape in shapes.items())


def rule(antecedent: str | Expression, *consequents: str, weight: float = 1.0) -> Rule:
    """``rule("a high", "u big")``."""
    if isinstance(antecedent, str):
        antecedent = Is(*antecedent.split())
    return Rule(antecedent, tuple(Consequent(*each.split()) for each in consequents), weight)


def base(
    rules: Sequence[Rule],
    output_terms: tuple[Term, ...],
    method: str = "centroid",
    *,
    names: Sequence[str] = ("a", "b"),
    resolution: int | None = None,
    sampling: str = "endpoints",
    low: float = 0.0,
    high: float = 10.0,
    implication: str = "min",
    **settings: Any,
) -> RuleBase:
    """One output u; the strength of ``a high`` is a itself."""
    defuzzifier = Defuzzifier(method, resolution, sampling)
    output = Output("u", low, high, output_terms, defuzzifier=defuzzifier, **settings)
    block = RuleBlock(tuple(rules), implication=implication)
    return RuleBase("small", inputs(*names), (output,), (block,))
