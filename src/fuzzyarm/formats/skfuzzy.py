"""scikit-fuzzy: a ``ControlSystem`` to a rule base and back.

scikit-fuzzy keeps a term as numbers over the points of its universe and draws straight
lines between them, so a term comes over as ``points`` and is exactly the same function.
Its centroid is the exact one of the clipped terms, but joins their union between the points
of the universe (and of the cuts) by straight lines: where two terms cross between two
points, it differs from the integral by a triangle of that width. docs/formats.md has more.

This is the one part of the package that needs array libraries, inside its functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce
from itertools import pairwise, product
from typing import Any

from fuzzyarm.expression.kinds import SHAPES, SNORMS, TNORMS
from fuzzyarm.formats.drafts import VALUES
from fuzzyarm.formats.findings import Findings, Imported
from fuzzyarm.formats.sentences import NOT, hedged
from fuzzyarm.formats.writing import note_chaining, note_left_out, note_threshold, refuse_type_2
from fuzzyarm.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Expression,
    Hedged,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.model.shapes import membership
from fuzzyarm.text.diagnostic import Diagnostic

__all__ = ["from_skfuzzy", "to_skfuzzy"]

# --- From a control system of scikit-fuzzy to a rule base ---

METHODS = {
    "centroid": "centroid",
    "bisector": "bisector",
    "mom": "mean-of-maximum",
    "som": "smallest-of-maximum",
    "lom": "largest-of-maximum",
}
"""Defuzzifiers of scikit-fuzzy."""

_TNORMS, _SNORMS = ("min", "product"), ("max", "probor")
"""Norms that a rule is given there; it clips by the minimum and joins terms by the maximum."""


def from_skfuzzy(system: Any, name: str = "system", *, lossy: bool = False) -> Imported:
    """Return the rule base that a control system of scikit-fuzzy is.

    Parameters
    ----------
    system : skfuzzy.control.ControlSystem
        Complete: every variable with its terms, every rule.
    name : str
        What the rule base is called.
    lossy : bool
        Whether a loss that changes numbers is a warning rather than an error.

    Returns
    -------
    Imported
        The rule base where there is no error, and every finding (without positions: there is
        no text).
    """
    findings = Findings(lossy=lossy)
    inputs = tuple(_input(each) for each in system.antecedents)
    outputs = tuple(_output(each, findings) for each in system.consequents)
    blocks = _blocks(list(system.rules), findings)
    rulebase = None if findings.failed else RuleBase(name, inputs, outputs, blocks)
    return Imported(rulebase, findings.all(), "scikit-fuzzy")


def _input(variable: Any) -> Input:
    low, high = _range(variable)
    return Input(variable.label, low, high, _terms(variable))


def _output(variable: Any, findings: Findings) -> Output:
    low, high = _range(variable)
    method = METHODS.get(variable.defuzzify_method)
    if method is None:
        message = f"'{variable.label}' has the defuzzifier '{variable.defuzzify_method}'"
        findings.error("unknown-defuzzifier", message)
    aggregation = _norm_name(variable.accumulation_method)
    if aggregation != "max":
        message = f"'{variable.label}' accumulates by something else than the maximum"
        findings.loss("unsupported-norm", message)
    return Output(
        variable.label,
        low,
        high,
        _terms(variable),
        outside="extend",
        defuzzifier=Defuzzifier(method or "centroid"),
    )


def _range(variable: Any) -> tuple[float, float]:
    return float(variable.universe.min()), float(variable.universe.max())


def _terms(variable: Any) -> tuple[Term, ...]:
    xs = [float(x) for x in variable.universe]
    return tuple(
        Term(str(label), _points(xs, [float(y) for y in term.mf]))
        for label, term in variable.terms.items()
    )


def _points(xs: list[float], ys: list[float]) -> Shape:
    """Return straight lines through all points, without those inside a plateau."""
    pairs: list[float] = []
    for i, (x, y) in enumerate(zip(xs, ys, strict=True)):
        if 0 < i < len(xs) - 1 and ys[i - 1] == y == ys[i + 1]:
            continue
        pairs += (x, y)
    return Shape("points", tuple(pairs))


def _blocks(rules: list[Any], findings: Findings) -> tuple[RuleBlock, ...]:
    """Return a block for each run of rules with the same norms."""
    blocks: list[RuleBlock] = []
    for rule in rules:
        norms = (_norm_name(rule.and_func), _norm_name(rule.or_func))
        conjunction, disjunction = norms
        if conjunction not in _TNORMS or disjunction not in _SNORMS:
            message = f"the rule '{rule.label}' joins conditions by a function of its own"
            findings.error("unknown-norm", message)
            continue
        made = _rules(rule)
        last = blocks[-1] if blocks else None
        if last is not None and (last.conjunction, last.disjunction) == norms:
            blocks[-1] = RuleBlock((*last.rules, *made), last.name, *norms)
        else:
            blocks.append(RuleBlock(made, "" if not blocks else f"{len(blocks) + 1}", *norms))
    return tuple(blocks)


def _norm_name(function: Callable[..., Any]) -> str:
    """Return the norm that a function computes at three points; empty for any other."""
    points = ((0.25, 0.5), (0.75, 0.25), (0.5, 1.0))
    found = [float(function(a, b)) for a, b in points]
    for kind in (*map(TNORMS.get, _TNORMS), *map(SNORMS.get, _SNORMS)):
        if kind is not None and found == [kind.scalar(a, b) for a, b in points]:
            return kind.name
    return ""


def _rules(rule: Any) -> tuple[Rule, ...]:
    """Return a rule of the model for each weight among the conclusions."""
    antecedent = _expression(rule.antecedent)
    weights: dict[float, list[Consequent]] = {}
    for weighted in rule.consequent:
        term = weighted.term
        consequent = Consequent(term.parent.label, str(term.label))
        weights.setdefault(float(weighted.weight), []).append(consequent)
    return tuple(Rule(antecedent, tuple(group), weight) for weight, group in weights.items())


def _expression(part: Any) -> Expression:
    kind = getattr(part, "kind", None)
    if kind is None:
        return Is(part.parent.label, str(part.label))
    first = _expression(part.term1)
    if kind == "not":
        return hedged((NOT,), first)
    joined = And if kind == "and" else Or
    # ``a & b & c`` is one conjunction; it is taken from the left here and there.
    left = first.operands if isinstance(first, joined) else (first,)
    return joined((*left, _expression(part.term2)))


# --- From a rule base to a control system of scikit-fuzzy ---

_BACK = {method: word for word, method in METHODS.items()}


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
    if refuse_type_2(rulebase, findings, "scikit-fuzzy"):
        return
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
        norms = (block.conjunction, block.disjunction, block.implication)
        if norms not in product(_TNORMS, _SNORMS, ("min",)):
            message = (
                "scikit-fuzzy clips by the minimum and is given min or product, max or probor, "
                f"not {', '.join(norms)}"
            )
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
        what = f"the terms of '{output.name}' by the maximum, not {output.aggregation}"
        message = f"scikit-fuzzy joins {what}"
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
    corners_of = SHAPES[shape.kind].corners
    corners = corners_of(*shape.parameters) if corners_of is not None else ()
    xs = [x for x, _ in corners]
    if shape.kind == "points":
        return xs
    jumps = [x for (x, y), (right, z) in pairwise(corners) if x == right and y != z]
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
        or_func=SNORMS["probor"].array if block.disjunction == "probor" else np.fmax,
    )


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
