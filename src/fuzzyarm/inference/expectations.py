"""Run the ``expect`` lines of a rule base."""

from __future__ import annotations

import math

from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.inference.scalar import Prepared, prepare
from fuzzyarm.rulebase.diagnostic import Diagnostic, Severity
from fuzzyarm.rulebase.model import Expectation, Outcome, Output, RuleBase

FAILED = "failed-expectation"
"""The name of the diagnostic."""

DEFAULT_TOLERANCE = 1e-9
"""Of the range of the output, where an ``=`` states no tolerance."""


def check_expectations(rulebase: RuleBase) -> list[Diagnostic]:
    """Evaluate every expectation and report those that fail.

    Parameters
    ----------
    rulebase : RuleBase
        The model.

    Returns
    -------
    list of Diagnostic
        One ``failed-expectation`` for each outcome that does not hold, at the line that
        expects it, in order. An expectation that cannot be evaluated fails too.
    """
    if not rulebase.expectations:
        return []
    try:
        prepared = prepare(rulebase)
    except FuzzyarmError as error:
        return [_failed(rulebase.expectations[0], str(error))]
    return [
        found
        for expectation in rulebase.expectations
        for found in _check(rulebase, prepared, expectation)
    ]


def _check(rulebase: RuleBase, prepared: Prepared, expectation: Expectation) -> list[Diagnostic]:
    try:
        values = prepared.evaluate(dict(expectation.inputs))
    except FuzzyarmError as error:
        return [_failed(expectation, str(error))]
    where = ", ".join(f"{name} = {value:g}" for name, value in expectation.inputs)
    failures = []
    for outcome in expectation.outcomes:
        if outcome.variable not in values:
            failures.append(_failed(expectation, f"there is no output '{outcome.variable}'"))
            continue
        value = values[outcome.variable]
        if not holds(outcome, value, rulebase.output(outcome.variable)):
            came = f"{outcome.variable} = {value:.10g}"
            failures.append(
                _failed(expectation, f"expected {_written(outcome)} at {where}, but {came}")
            )
    return failures


def _failed(expectation: Expectation, message: str) -> Diagnostic:
    return Diagnostic(FAILED, message, expectation.span, Severity.ERROR)


def holds(outcome: Outcome, value: float, output: Output) -> bool:
    """Return whether `value` is what `outcome` says.

    Parameters
    ----------
    outcome : Outcome
        The relation and its right side.
    value : float
        What came out.
    output : Output
        Whose range gives the tolerance of an ``=`` without one.
    """
    wanted = outcome.value
    if outcome.relation == "=":
        width = output.high - output.low
        scale = width if math.isfinite(width) else max(1.0, abs(wanted))
        tolerance = DEFAULT_TOLERANCE * scale if outcome.other is None else outcome.other
        return abs(value - wanted) <= tolerance
    if outcome.relation == "in":
        end = wanted if outcome.other is None else outcome.other
        return min(wanted, end) <= value <= max(wanted, end)
    relations = {
        "<": value < wanted,
        "<=": value <= wanted,
        ">": value > wanted,
        ">=": value >= wanted,
    }
    return relations[outcome.relation]


def _written(outcome: Outcome) -> str:
    if outcome.relation == "in":
        return f"{outcome.variable} in {outcome.value:g} .. {outcome.other:g}"
    tolerance = f" ± {outcome.other:g}" if outcome.other is not None else ""
    return f"{outcome.variable} {outcome.relation} {outcome.value:.10g}{tolerance}"
