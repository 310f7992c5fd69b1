"""From a rule base to a control system of scikit-fuzzy."""

from __future__ import annotations

import math
from functools import reduce
from itertools import pairwise
from typing import Any

from fuzzyarm.formats.draft import VALUES
from fuzzyarm.formats.export import note_chaining, note_left_out, note_threshold
from fuzzyarm.formats.imported import Findings
from fuzzyarm.formats.norms import reverse
from fuzzyarm.formats.rule_text import NOT
from fuzzyarm.formats.skfuzzy.reader import METHODS
from fuzzyarm.rulebase.diagnostic import Diagnostic
from fuzzyarm.rulebase.membership import membership
from fuzzyarm.rulebase.model import (
    And,
    Expression,
    Hedged,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
)

_BACK = reverse(METHODS)


def to_skfuzzy(
    rulebase: RuleBase, *, samples: int = 101, lossy: bool = False
) -> tuple[Any, tuple[Diagnostic, ...]]:
    """Return a control system of scikit-fuzzy for a rule base.

    Parameters
    ----------
    rulebase : RuleBase
        Mamdani with min (or product) and max, clipped by min.
    samples : int
        Even points of every universe; the corners of straight terms are added to them.
    lossy : bool
        Whether to go on where scikit-fuzzy gives other numbers.

    Returns
    -------
    skfuzzy.control.ControlSystem or None
        None where a diagnostic is an error.
    tuple of Diagnostic
        What scikit-fuzzy cannot express.
    """
    findings = Findings(lossy=lossy)
    _check(rulebase, findings)
    if findings.failed:
        return None, findings.all()
    return _system(rulebase, samples), findings.all()


def _check(rulebase: RuleBase, findings: Findings) -> None:
    note_left_out(rulebase, findings, descriptions=False)
    note_chaining(rulebase, findings, "scikit-fuzzy", own=False)
    note_threshold(rulebase, findings, "scikit-fuzzy", 0.0)
    variables: tuple[Input | Output, ...] = (*rulebase.inputs, *rulebase.outputs)
    for each in variables:
        _check_terms(each, findings)
    for variable in rulebase.inputs:
        if variable.outside == "extend":
            message = f"'{variable.name}' is not clamped to its range, as scikit-fuzzy does"
            findings.loss("outside-range", message)
    for output in rulebase.outputs:
        _check_output(output, findings)
    for block in rulebase.blocks:
        if (block.conjunction, block.disjunction, block.implication) not in (
            ("min", "max", "min"),
            ("product", "max", "min"),
            ("min", "probor", "min"),
            ("product", "probor", "min"),
        ):
            message = "scikit-fuzzy clips by the minimum and is given min or product, max or probor"
            findings.loss("unsupported-norm", message)
        for rule in block.rules:
            _check_hedges(rule, findings)


def _check_terms(variable: Input | Output, findings: Findings) -> None:
    if not (math.isfinite(variable.low) and math.isfinite(variable.high)):
        findings.error("bad-range", f"the universe of '{variable.name}' must be finite")
    for term in variable.terms:
        if term.shape.kind in VALUES:
            message = f"scikit-fuzzy has nothing like the value '{term.name}' of '{variable.name}'"
            findings.error("unsupported-shape", message)


def _check_output(output: Output, findings: Findings) -> None:
    if output.defuzzifier.method not in _BACK:
        message = f"scikit-fuzzy has no {output.defuzzifier.method} for '{output.name}'"
        findings.error("unsupported-defuzzifier", message)
    if output.defuzzifier.resolution is not None:
        message = f"'{output.name}' is sampled; scikit-fuzzy integrates between its points"
        findings.loss("sampling", message)
    if output.aggregation != "max":
        message = f"scikit-fuzzy joins the terms of '{output.name}' by the maximum"
        findings.loss("unsupported-norm", message)
    if output.no_rule != "error":
        message = f"'{output.name}' is left out of the result where no rule fires"
        findings.warn("no-rule", message)


def _check_hedges(rule: Rule, findings: Findings) -> None:
    found = [h for h in _hedges(rule.antecedent) if h != NOT]
    found += [hedge for consequent in rule.consequents for hedge in consequent.hedges]
    for hedge in found:
        message = f"scikit-fuzzy has no hedge '{hedge.name}' there"
        findings.loss("unsupported-hedge", message, rule.span)


def _hedges(expression: Expression) -> list[Any]:
    if isinstance(expression, Is):
        return list(expression.hedges)
    if isinstance(expression, Hedged):
        return [*expression.hedges, *_hedges(expression.operand)]
    return [hedge for operand in expression.operands for hedge in _hedges(operand)]


def _system(rulebase: RuleBase, samples: int) -> Any:
    from skfuzzy import control

    variables: dict[str, Any] = {}
    for variable in rulebase.inputs:
        made = control.Antecedent(_universe(variable, samples), variable.name)
        variables[variable.name] = _with_terms(made, variable)
    for output in rulebase.outputs:
        made = control.Consequent(
            _universe(output, samples), output.name, _BACK[output.defuzzifier.method]
        )
        variables[output.name] = _with_terms(made, output)
    rules = [
        _rule(rule, block, variables, number)
        for number, (rule, block) in enumerate(
            (rule, block) for block in rulebase.blocks for rule in block.rules
        )
    ]
    return control.ControlSystem(rules)


def _universe(variable: Input | Output, samples: int) -> Any:
    import numpy as np

    corners = [c for term in variable.terms for c in _corners(term.shape)]
    inside = [c for c in corners if variable.low <= c <= variable.high]
    return np.union1d(np.linspace(variable.low, variable.high, samples), inside)


def _corners(shape: Shape) -> list[float]:
    """Return the x where a function bends; on both sides of an edge where it jumps."""
    if shape.kind == "points":
        return list(shape.parameters[0::2])
    if shape.kind not in ("triangle", "trapezoid", "rectangle", "ramp", "binary"):
        return []
    xs = [x for x in shape.parameters if math.isfinite(x)]
    jumps = xs if shape.kind in ("rectangle", "binary") else [a for a, b in pairwise(xs) if a == b]
    return [*xs, *(math.nextafter(x, side) for x in jumps for side in (-math.inf, math.inf))]


def _with_terms(made: Any, variable: Input | Output) -> Any:
    import numpy as np

    for term in variable.terms:
        made[term.name] = np.array([membership(term.shape, float(x)) for x in made.universe])
    return made


def _rule(rule: Rule, block: RuleBlock, variables: dict[str, Any], number: int) -> Any:
    import numpy as np
    from skfuzzy import control

    conclusions = [variables[c.variable][c.term] % float(rule.weight) for c in rule.consequents]
    return control.Rule(
        _antecedent(rule.antecedent, variables),
        conclusions,
        label=f"rule {number + 1}",
        and_func=np.multiply if block.conjunction == "product" else np.fmin,
        or_func=_probor if block.disjunction == "probor" else np.fmax,
    )


def _probor(a: Any, b: Any) -> Any:
    return a + b - a * b


def _antecedent(expression: Expression, variables: dict[str, Any]) -> Any:
    if isinstance(expression, Is):
        term = variables[expression.variable][expression.term]
        return reduce(lambda part, _: ~part, [h for h in expression.hedges if h == NOT], term)
    if isinstance(expression, Hedged):
        inner = _antecedent(expression.operand, variables)
        return reduce(lambda part, _: ~part, [h for h in expression.hedges if h == NOT], inner)
    parts = [_antecedent(operand, variables) for operand in expression.operands]
    if isinstance(expression, And):
        return reduce(lambda a, b: a & b, parts)
    return reduce(lambda a, b: a | b, parts)
