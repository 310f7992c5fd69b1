"""Evaluate a rule base: one call for scalars and arrays; run its ``expect`` lines."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, overload

from fuzzyarm.base.diagnostic import Diagnostic, Severity
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference.firing_intervals import Ends, ends
from fuzzyarm.inference.inputs import check_names
from fuzzyarm.inference.labelled import gathered
from fuzzyarm.inference.plan import part_for
from fuzzyarm.inference.prepared import at_point, remember_point, remembered
from fuzzyarm.language.model.rulebase import (
    AnyRuleBase,
    Expectation,
    Outcome,
    Output,
    RuleBase,
    model_of,
)

# --- Evaluate a rule base: one call for scalars and arrays ---


@overload
def infer(
    rulebase: AnyRuleBase,
    inputs: Mapping[str, float] | None = None,
    /,
    *,
    held: Mapping[str, float] | None = None,
    outputs: Iterable[str] | None = None,
    **named: float,
) -> dict[str, float]: ...
@overload
def infer(
    rulebase: AnyRuleBase,
    inputs: Any = None,
    /,
    *,
    held: Mapping[str, float] | None = None,
    outputs: Iterable[str] | None = None,
    **named: Any,
) -> Any: ...
def infer(
    rulebase: AnyRuleBase,
    inputs: Any = None,
    /,
    *positional: Any,
    held: Mapping[str, float] | None = None,
    outputs: Iterable[str] | None = None,
    **named: Any,
) -> Any:
    """Evaluate a rule base.

    Parameters
    ----------
    rulebase : RuleBase
        The model, or one under construction.
    inputs : mapping of str to float or array_like, DataFrame or Dataset, optional
        Inputs by name; for names that are not identifiers. Other columns of a DataFrame and other
        variables of a Dataset are ignored.
    *positional
        Refused: inputs have names.
    held : mapping of str to float, optional
        Last values of outputs that hold where no rule fires.
    outputs : iterable of str, optional
        Outputs to evaluate; only the inputs that they depend on are then needed.
    **named : float, array_like, Series, DataFrame or DataArray
        Inputs by name, in the units of the file. Arrays broadcast against each other,
        DataArrays by their dims. A value outside the range of its input is clamped to it,
        unless the file says ``outside extend`` or ``outside error``.

    Returns
    -------
    dict of str to float or ndarray of float64
        Every output, or the selected ones, by name: floats where all inputs are scalars, else
        arrays of the broadcast shape. Series, DataFrames and DataArrays for such inputs, with their
        index, or their dims and coordinates. For `inputs` in a DataFrame or a Dataset a DataFrame
        or a Dataset of the outputs. NaN only where the file states it (``no-rule nan``).

    Raises
    ------
    InferenceError
        For a model that cannot be evaluated; names that are unknown, missing or given
        twice; values that are not numbers (text is not, even ``"2"``) or outside a range that
        forbids it; indexes or coordinates that differ.
    NoRuleFiredError
        If no rule fires for an output that states no value for that case.

    Examples
    --------
    >>> from fuzzyarm import infer, load, shipped
    >>> pd7 = load(shipped("pd7.frb"))
    >>> infer(pd7, e=1.3, ce=-2.2)
    {'u': -1.0677966101694918}
    >>> infer(pd7, e=[1.3, 0.0, -1.3], ce=0.0)
    {'u': array([ 1.24439919,  0.        , -1.24439919])}
    """
    if held is None and outputs is None and not positional:  # the fast path
        point = named if inputs is None else inputs
        if point is named or (type(point) is dict and not named):
            try:
                found = at_point[id(rulebase)](point)
            except KeyError:
                found = None
            if found is not None:
                return found
    rulebase = model_of(rulebase)
    if positional:
        inputs = (inputs, *positional)  # positional, hence refused
    values, labels = gathered(inputs, named, rulebase.inputs)
    results = _outputs(rulebase, values, held, None if outputs is None else tuple(outputs))
    return results if labels is None else labels.on(results)


def _outputs(
    rulebase: RuleBase,
    inputs: Mapping[str, Any],
    held: Mapping[str, float] | None,
    outputs: tuple[str, ...] | None,
) -> dict[str, Any]:
    """Evaluate a rule base at inputs without labels."""
    if outputs is not None:
        return _some(rulebase, inputs, held, outputs)
    from fuzzyarm.inference.engine import cached_engine  # takes a while to import

    engine = cached_engine(rulebase)
    remember_point(rulebase, engine.named_point)
    return engine.evaluate(inputs, held)


@remembered
def with_nan_for_no_rule(rulebase: RuleBase) -> RuleBase:
    """Return a rule base with NaN where no rule fires and the file states no number."""
    outputs = (
        output if isinstance(output.no_rule, int | float) else replace(output, no_rule=math.nan)
        for output in rulebase.outputs
    )
    return replace(rulebase, outputs=tuple(outputs))


def infer_interval(
    rulebase: AnyRuleBase,
    inputs: Any = None,
    /,
    *,
    held: Mapping[str, float] | None = None,
    outputs: Iterable[str] | None = None,
    **named: Any,
) -> dict[str, tuple[Any, Any]]:
    """Evaluate a rule base and return both ends of every output.

    Parameters
    ----------
    rulebase, inputs, held, outputs, **named
        As for :func:`infer`.

    Returns
    -------
    dict of str to (left, right)
        The ends of the centroid of each output under `karnik-mendel`, whose middle :func:`infer`
        returns; floats or arrays as there. Any other output is both of its ends.

    Raises
    ------
    InferenceError, NoRuleFiredError
        As :func:`infer`.

    Examples
    --------
    >>> import fuzzyarm
    >>> tipper = fuzzyarm.load(fuzzyarm.shipped("tipper2.frb"))
    >>> left, right = infer_interval(tipper, service=2, food=3)["tip"]
    >>> print(f"{left:.10f} .. {right:.10f}")
    5.4202799202 .. 9.4553511985
    """
    ends = both_ends(model_of(rulebase))
    names = ends.names if outputs is None else _named(ends.names, outputs)
    names_wanted = (
        None if outputs is None else dict.fromkeys(n for pair in names.values() for n in pair)
    )
    held_ends = {
        end: value for name, value in (held or {}).items() for end in names.get(name, (name,))
    }
    values = infer(ends.rulebase, inputs, held=held_ends, outputs=names_wanted, **named)
    return {name: (values[left], values[right]) for name, (left, right) in names.items()}


@remembered
def both_ends(rulebase: RuleBase) -> Ends:
    """Return the rule base with the ends of another's outputs; cached."""
    return ends(rulebase)


def _named(
    names: Mapping[str, tuple[str, str]], outputs: Iterable[str]
) -> dict[str, tuple[str, str]]:
    wanted_names = list(outputs)
    check_names(wanted_names, names, what="output")
    return {name: names[name] for name in wanted_names}


def _some(
    rulebase: RuleBase,
    inputs: Mapping[str, Any],
    held: Mapping[str, float] | None,
    outputs: tuple[str, ...],
) -> dict[str, Any]:
    """Evaluate some outputs, from the inputs that they need among those passed."""
    part = part_for(rulebase, outputs)
    check_names(inputs, [variable.name for variable in rulebase.inputs])
    check_names(held or (), [variable.name for variable in rulebase.outputs], what="output")
    input_names = {variable.name for variable in part.inputs}
    names_there = {variable.name for variable in part.outputs}
    results = _outputs(
        part,
        {name: value for name, value in inputs.items() if name in input_names},
        {name: value for name, value in (held or {}).items() if name in names_there},
        None,
    )
    return {name: results[name] for name in outputs}


# --- Run the `expect` lines of a rule base ---

FAILED = "failed-expectation"
"""The name of the diagnostic."""

DEFAULT_TOLERANCE = 1e-9
"""Of the range of the output, where an ``=`` states no tolerance."""

MANY_SAMPLES = 2_000_000
"""Expectations that need more samples of their outputs are worth loading the machine code."""


def check_expectations(
    rulebase: RuleBase, on_step: Callable[[], None] = lambda: None
) -> list[Diagnostic]:
    """Evaluate every expectation and report those that fail.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    on_step : callable
        Called before each expectation; an exception from it ends the check.

    Returns
    -------
    list of Diagnostic
        One ``failed-expectation`` for each outcome that does not hold, at the line that
        expects it, in order. An expectation that cannot be evaluated fails too.
    """
    if not rulebase.expectations:
        return []
    from fuzzyarm.inference.engine import Compiled

    samples = sum(output.defuzzifier.resolution or 0 for output in rulebase.outputs)
    few = samples * len(rulebase.expectations) < MANY_SAMPLES
    try:
        evaluate = Compiled(rulebase, interpreted=few).point
    except FuzzyarmError as error:  # the same for all: reported once
        return [_failed(rulebase.expectations[0], str(error))]
    failures: list[Diagnostic] = []
    for expectation in rulebase.expectations:
        on_step()
        failures += _check(rulebase, evaluate, expectation)
    return failures


def _check(
    rulebase: RuleBase,
    evaluate: Callable[[Mapping[str, float]], Mapping[str, float]],
    expectation: Expectation,
) -> list[Diagnostic]:
    try:
        values = evaluate(dict(expectation.inputs))
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
    """Return whether `value` fits; the range of `output` is behind a default tolerance."""
    target = outcome.value
    if outcome.relation == "=":
        width = output.high - output.low
        # An unbounded range has no share of itself.
        scale = width if math.isfinite(width) else max(1.0, abs(target))
        tolerance = DEFAULT_TOLERANCE * scale if outcome.other is None else outcome.other
        return abs(value - target) <= tolerance
    if outcome.relation == "in":
        end = target if outcome.other is None else outcome.other
        return min(target, end) <= value <= max(target, end)
    relations = {
        "<": value < target,
        "<=": value <= target,
        ">": value > target,
        ">=": value >= target,
    }
    return relations[outcome.relation]


def _written(outcome: Outcome) -> str:
    if outcome.relation == "in":
        return f"{outcome.variable} in {outcome.value:g} .. {outcome.other:g}"
    tolerance = f" ± {outcome.other:g}" if outcome.other is not None else ""
    return f"{outcome.variable} {outcome.relation} {outcome.value:.10g}{tolerance}"
