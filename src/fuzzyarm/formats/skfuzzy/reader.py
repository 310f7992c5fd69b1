"""From a control system of scikit-fuzzy to a rule base."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fuzzyarm.formats.imported import Findings, Imported
from fuzzyarm.formats.rule_text import NOT, hedged
from fuzzyarm.rulebase.model import (
    And,
    Consequent,
    Defuzzifier,
    Expression,
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

METHODS = {
    "centroid": "centroid",
    "bisector": "bisector",
    "mom": "mean-of-maximum",
    "som": "smallest-of-maximum",
    "lom": "largest-of-maximum",
}
"""Defuzzifiers of scikit-fuzzy."""


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
        The rule base where there is no error, and every finding (without places: there is
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
    kept: list[float] = []
    for i, (x, y) in enumerate(zip(xs, ys, strict=True)):
        if 0 < i < len(xs) - 1 and ys[i - 1] == y == ys[i + 1]:
            continue
        kept += (x, y)
    return Shape("points", tuple(kept))


def _blocks(rules: list[Any], findings: Findings) -> tuple[RuleBlock, ...]:
    """Return a block for each run of rules with the same norms."""
    blocks: list[RuleBlock] = []
    for rule in rules:
        norms = (_norm_name(rule.and_func), _norm_name(rule.or_func))
        conjunction, disjunction = norms
        if conjunction not in ("min", "product") or disjunction not in ("max", "probor"):
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
    norms: dict[str, Callable[[float, float], float]] = {
        "min": min,
        "max": max,
        "product": lambda a, b: a * b,
        "probor": lambda a, b: a + b - a * b,
    }
    for name, norm in norms.items():
        if found == [norm(a, b) for a, b in points]:
            return name
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
