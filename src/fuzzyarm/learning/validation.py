"""Accuracy of a rule base on samples: overall, by region, and by rule.

A single error says little. The error by region shows where a model fails, the residuals whether it
is biased, calibration whether its values can be taken literally, and the firing strengths which
rules these samples have tested at all: a rule that never fires may conclude anything.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import JsonRecord, json_properties
from fuzzyarm.base.shown import Plotted, one_line
from fuzzyarm.inference.sets import degrees
from fuzzyarm.inference.strengths import firing_strengths
from fuzzyarm.inference.trace import place_of
from fuzzyarm.language.model.rulebase import AnyRuleBase, Input, RuleBase, model_of
from fuzzyarm.language.rows import sentence
from fuzzyarm.language.writer import rule_node
from fuzzyarm.learning.data import Samples
from fuzzyarm.learning.model_text import output_names

Array = NDArray[np.float64]

FIRES = 0.01
"""Firing strength from which on a rule counts as firing: a gaussian never quite reaches 0."""

BINS = 10
"""Bins of the calibration."""


class ValidationError(FuzzyarmError, ValueError):
    """Samples by which a rule base cannot be judged."""


@json_properties("*")
class Region(NamedTuple):
    """Samples with their highest membership in one term of an input, and the errors there.

    Attributes
    ----------
    input : str
        Which input.
    term : str
        For an input without terms a third of its range: ``low third`` and so on.
    samples : int
        In it.
    error : float
        Root mean square of observed minus predicted; for classes the share of wrong answers. NaN
        without samples or without a target.
    bias : float
        Mean of observed minus predicted; 0 of classes, NaN as above.
    """

    input: str
    term: str
    samples: int
    error: float
    bias: float


@json_properties("*")
class RuleUse(NamedTuple):
    """The firing of a rule over the samples.

    Attributes
    ----------
    number : int
        From 1, in the order of the file.
    text : str
        The rule.
    line : int
        Its line in the file.
    often : float
        Share of the samples at which it fires.
    mean : float
        Mean firing strength over all samples.
    strongest : float
        Its largest firing strength.
    leads : int
        Samples at which no rule is stronger.
    error : float
        Root mean square of the error, weighted by its firing strength; NaN for a rule that never
        fires.
    column : int
        Its column in the line: a row of a grid has several rules.
    """

    number: int
    text: str
    line: int
    often: float
    mean: float
    strongest: float
    leads: int
    error: float
    column: int = 1

    @property
    def place(self) -> str:
        """The position of the rule, as its name."""
        return place_of(self.number, self.line, self.column)

    @property
    def never_fires(self) -> bool:
        """Whether no sample makes it fire."""
        return self.often == 0.0


@json_properties("*")
class Bin(NamedTuple):
    """Samples with predictions next to each other.

    Attributes
    ----------
    samples : int
        Number of samples.
    predicted, observed : float
        Means in the bin.
    """

    samples: int
    predicted: float
    observed: float


@json_properties("* -predicted -observed never_fired=silent_rules")
@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Validation(Plotted, JsonRecord):
    """The judgement of samples on a rule base.

    Attributes
    ----------
    samples : int
        In all.
    silent : int
        Samples at which no rule fires, excluded everywhere else.
    outside : int
        Those beyond the range of an input.
    error : float
        Root mean square of observed minus predicted; of classes the share of wrong answers. NaN
        without a target.
    bias, worst : float
        Mean and largest magnitude of observed minus predicted; NaN for classes, and without a
        target.
    worst_sample : int
        Where the largest is, from 1; 0 for classes and without a target.
    explained : float
        Explained share of the variance of the target (R²); NaN for classes, and for a
        constant target.
    slope, intercept : float
        Regression of the observed on the predicted: 1 and 0 if unbiased; NaN for classes.
    calibration : tuple of Bin
        From low to high predictions.
    regions : tuple of Region
        By input and term.
    rules : tuple of RuleUse
        In the order of the file.
    confusion : tuple of tuple of int
        For classes: a row for each actual class, a column for each predicted one.
    classes : tuple of str
        Empty for numbers.
    predicted, observed : ndarray
        Values of the samples with a prediction; for figures.
    """

    samples: int
    silent: int
    outside: int
    error: float
    bias: float
    worst: float
    worst_sample: int
    explained: float
    slope: float
    intercept: float
    calibration: tuple[Bin, ...]
    regions: tuple[Region, ...]
    rules: tuple[RuleUse, ...]
    confusion: tuple[tuple[int, ...], ...]
    classes: tuple[str, ...]
    predicted: Array
    observed: Array

    def __repr__(self) -> str:
        words = f"{self.samples} samples, error {self.error:.4g}, {self.silent} without a rule"
        return one_line(self, words)

    @property
    def never_fired(self) -> tuple[RuleUse, ...]:
        """The rules that no sample makes fire."""
        return tuple(rule for rule in self.rules if rule.never_fires)

    @property
    def silent_rules(self) -> tuple[int, ...]:
        """Numbers of the rules that no sample makes fire."""
        return tuple(rule.number for rule in self.never_fired)


def validate(rulebase: AnyRuleBase, samples: Samples) -> Validation:
    """Judge a rule base by samples.

    Parameters
    ----------
    rulebase : RuleBase
        Of any kind.
    samples : Samples
        With a column for each of its inputs. The target is one of its outputs; each class has an
        output. Without values (NaN) rules and ranges are judged alone.

    Raises
    ------
    ValidationError
        If an output for the target is missing.
    """
    rulebase = model_of(rulebase)
    names_wanted = output_names(samples)
    names_there = [output.name for output in rulebase.outputs]
    has_target = not np.isnan(samples.values).any()
    missing = [name for name in names_wanted if name not in names_there]
    if missing and has_target:
        hint = f"there are: {', '.join(names_there)}"
        raise ValidationError(f"the rule base has no output '{missing[0]}'", hint=hint)
    columns = dict(zip(samples.names, samples.inputs.T, strict=True))
    strengths, outputs = firing_strengths(rulebase, columns)
    shown = [outputs[name] for name in (names_there if missing else names_wanted)]
    predicted = np.stack([np.broadcast_to(column, len(samples)) for column in shown], axis=1)
    fired: NDArray[np.bool_] = ~np.asarray(np.isnan(predicted).any(axis=1))
    errors = _errors(samples, predicted) if has_target else np.full(len(samples), math.nan)
    observed, predictions = samples.values[fired], predicted[fired, 0]
    numbers = has_target and not samples.classes and len(observed) > 0
    slope, intercept = _line(predictions, observed) if numbers else (math.nan, math.nan)
    # The mean of equal numbers may miss them by the last bit.
    variance = float(np.var(observed)) if numbers and np.ptp(observed) > 0.0 else math.nan
    judged = errors[fired]
    error = _root_mean_square(judged)
    return Validation(
        samples=len(samples),
        silent=int(np.sum(~fired)),
        outside=_outside(rulebase, columns),
        error=_share_or_rms(samples, judged),
        bias=_mean(judged) if numbers else math.nan,
        worst=float(np.abs(judged).max()) if numbers else math.nan,
        worst_sample=int(np.flatnonzero(fired)[np.abs(judged).argmax()]) + 1 if numbers else 0,
        # The coefficient of determination, R².
        explained=1.0 - error**2 / variance if variance > 0.0 else math.nan,
        slope=slope,
        intercept=intercept,
        calibration=tuple(_bins(predictions, observed)) if numbers else (),
        regions=tuple(_regions(rulebase, samples, columns, np.where(fired, errors, math.nan))),
        rules=tuple(_uses(rulebase, strengths, np.where(fired, errors, math.nan))),
        confusion=_confusion(samples, predicted, fired) if has_target else (),
        classes=samples.classes,
        predicted=predictions,
        observed=observed,
    )


def _errors(samples: Samples, predicted: Array) -> Array:
    """Return observed minus predicted; of classes 1 for a wrong answer."""
    if not samples.classes:
        return samples.values - predicted[:, 0]
    with np.errstate(invalid="ignore"):
        # An output without a firing rule cannot be the answer.
        answers = np.where(np.isnan(predicted), -np.inf, predicted).argmax(axis=1)
    wrong: NDArray[np.bool_] = np.not_equal(answers, samples.values)
    return wrong.astype(float)


def _share_or_rms(samples: Samples, errors: Array) -> float:
    return _mean(errors) if samples.classes else _root_mean_square(errors)


def _mean(values: Array) -> float:
    finite = values[~np.isnan(values)]
    return float(finite.mean()) if len(finite) else math.nan


def _root_mean_square(values: Array) -> float:
    return math.sqrt(_mean(values**2)) if len(values) else math.nan


def _outside(rulebase: RuleBase, columns: dict[str, Array]) -> int:
    beyond = [
        (columns[variable.name] < variable.low) | (columns[variable.name] > variable.high)
        for variable in rulebase.inputs
    ]
    return int(np.any(beyond, axis=0).sum())


def _line(predicted: Array, observed: Array) -> tuple[float, float]:
    """Return slope and intercept of the observed over the predicted; NaN for one prediction."""
    spread = float(np.var(predicted))
    if not spread > 0.0:
        return math.nan, math.nan
    slope = float(np.mean((predicted - predicted.mean()) * (observed - observed.mean()))) / spread
    return slope, float(observed.mean()) - slope * float(predicted.mean())


def _bins(predicted: Array, observed: Array) -> Iterator[Bin]:
    # Equal counts instead of equal widths: predictions cluster, and an empty bin says nothing.
    order = np.argsort(predicted, kind="stable")
    for rows in np.array_split(order, min(BINS, len(order))):
        yield Bin(len(rows), float(predicted[rows].mean()), float(observed[rows].mean()))


def _regions(
    rulebase: RuleBase, samples: Samples, columns: dict[str, Array], errors: Array
) -> Iterator[Region]:
    for variable in rulebase.inputs:
        names, index = _parts(variable, columns[variable.name])
        for k, name in enumerate(names):
            inside = errors[(index == k) & ~np.isnan(errors)]
            count = int(np.sum(index == k))
            if not len(inside):
                yield Region(variable.name, name, count, math.nan, math.nan)
                continue
            bias = 0.0 if samples.classes else _mean(inside)
            yield Region(variable.name, name, count, _share_or_rms(samples, inside), bias)


def _parts(variable: Input, values: Array) -> tuple[list[str], NDArray[np.intp]]:
    """Return the parts of an input by name, and the part of each value."""
    at = np.clip(values, variable.low, variable.high) if variable.outside == "clamp" else values
    if len(variable.terms) > 1:
        memberships = np.stack([degrees(term.shape, at) for term in variable.terms])
        return [term.name for term in variable.terms], memberships.argmax(axis=0)
    # A single term does not divide its input, so the range of the samples is cut in three.
    low, high = max(variable.low, at.min()), min(variable.high, at.max())
    edges = np.array([low + (high - low) / 3.0, low + (high - low) * 2.0 / 3.0])
    return ["low third", "middle third", "high third"], np.searchsorted(edges, at)


def _uses(rulebase: RuleBase, strengths: Array, errors: Array) -> Iterator[RuleUse]:
    strongest = strengths.max(axis=0)
    judged = ~np.isnan(errors)
    for number, (rule, fires) in enumerate(zip(rulebase.rules, strengths, strict=True), 1):
        # The error of a rule: over all samples, weighted by its firing strength.
        weight = fires[judged].sum()
        error = math.nan
        if weight > 0.0 and fires.max() >= FIRES:
            error = math.sqrt(float(np.sum(fires[judged] * errors[judged] ** 2) / weight))
        yield RuleUse(
            number,
            sentence(rule_node(rule)),
            rule.span.line,
            float(np.mean(fires >= FIRES)),
            float(fires.mean()),
            float(fires.max()),
            int(np.sum((fires == strongest) & (fires > 0.0))),
            error,
            rule.span.column,
        )


def _confusion(
    samples: Samples, predicted: Array, fired: NDArray[np.bool_]
) -> tuple[tuple[int, ...], ...]:
    count = len(samples.classes)
    table = np.zeros((count, count), dtype=int)
    if count:
        answers = predicted[fired].argmax(axis=1)
        np.add.at(table, (samples.values[fired].astype(int), answers), 1)
    return tuple(tuple(row) for row in table.tolist())
