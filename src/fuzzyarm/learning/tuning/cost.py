"""Costs to minimise: a formula of metrics, a function of the user, an error on samples."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.names import near_hint
from fuzzyarm.control.loop.metrics import METRICS
from fuzzyarm.control.loop.run import Judged, Run
from fuzzyarm.inference import infer
from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.learning.data import Samples
from fuzzyarm.learning.tuning.movement import TuneError
from fuzzyarm.plant.equations import USERS
from fuzzyarm.plant.own import executed, failure
from fuzzyarm.symbolic.formulas import CONSTANTS, Formula, FormulaError, read_formula

Vector = NDArray[np.float64]

LOST = 1e6
"""Cost of a run that diverges at its end; a run that diverges at once costs twice as much."""

ERRORS = {
    "rmse": "root mean square error",
    "mae": "mean magnitude of the error",
    "worst": "largest magnitude of the error",
}
"""Metrics of a cost on samples."""


class CostFormulaError(TuneError):
    """A cost cannot be read, or has no value."""


@dataclass(frozen=True)
class Cost:
    """A formula of metrics of a run, or of errors on samples.

    Parameters
    ----------
    text : str
        As in ``rms + 0.002*variation``. A metric is the mean over the tracked outputs; that of one
        axis is ``'joint1.rms'``.
    metrics : tuple of str
        The names permitted in the formula.

    Raises
    ------
    CostFormulaError
        If it cannot be read, or has another name.
    """

    text: str
    metrics: tuple[str, ...] = METRICS

    def __post_init__(self) -> None:
        for name in self.formula.names:
            bare = name.rpartition(".")[2]
            if bare not in self.metrics and name not in CONSTANTS:
                hint = near_hint(bare, self.metrics)[0] or f"one of {', '.join(self.metrics)}"
                raise CostFormulaError(f"no metric '{name}'", name=name, hint=hint)

    @cached_property
    def formula(self) -> Formula:
        """The parsed formula."""
        try:
            return read_formula(self.text)
        except FormulaError as error:
            message = f"the cost '{self.text}' cannot be read: {error.message}"
            raise CostFormulaError(message, name=self.text) from None

    @property
    def is_brief(self) -> bool:
        """Whether it depends only on errors and chatter of a run."""
        return all(name.rpartition(".")[2] in (*BRIEF, *CONSTANTS) for name in self.formula.names)

    def of(self, values: Mapping[str, float]) -> float:
        """Return the cost of some values by name."""
        for name in self.formula.names:
            if name not in values and name not in CONSTANTS:
                axes = sorted({label.rpartition(".")[0] for label in values} - {""})
                hint = f"axes are {', '.join(axes)}" if axes else ""
                raise CostFormulaError(f"unknown metric '{name}'", name=name, hint=hint)
        value = self.formula.evaluate(values)
        return value if not math.isnan(value) else math.inf


# --- Of runs ---


def values_of(run: Run) -> dict[str, float]:
    """Return the metrics of a run by name: means over the tracked outputs, and those of each axis.

    A step without a rise or settling time has the duration of the run instead. Metrics of
    steps are omitted if the reference is not a step.
    """
    numbers_by_name: dict[str, list[float]] = {}
    labelled: dict[str, float] = {}
    span = float(run.time[-1] - run.time[0]) + run.period if run.samples else math.nan
    for label, metrics in run.metrics.items():
        for name, value in vars(metrics).items():
            if value is None and metrics.overshoot is None:
                continue
            number = span if value is None else float(value)
            # Extreme and final errors have a sign; a cost counts their magnitude.
            number = abs(number) if name in ("max", "final") else number
            numbers_by_name.setdefault(name, []).append(number)
            labelled[f"{label}.{name}"] = number
    return {name: float(np.mean(numbers)) for name, numbers in numbers_by_name.items()} | labelled


BRIEF = ("rms", "chatter")
"""Metrics that do not need the whole run."""


def brief_values_of(judged: Judged) -> dict[str, float]:
    """Return these metrics as :func:`values_of` does."""
    means = {}
    for name, values in zip(BRIEF, (judged.rms, judged.chatter), strict=True):
        means[name] = float(np.mean(list(values.values())))
        means |= {f"{label}.{name}": value for label, value in values.items()}
    return means


def lost(diverged: float | None, duration: float) -> float:
    """Return the cost of a diverged run: the earlier, the higher."""
    share = (diverged or 0.0) / duration if duration > 0.0 else 0.0
    return LOST * (2.0 - min(share, 1.0))


# --- Of samples ---


def errors_of(rulebase: RuleBase, samples: Samples) -> dict[str, float]:
    """Return the errors of a rule base on samples, by name; infinite if no rule fires."""
    inputs = dict(zip(samples.names, samples.inputs.T, strict=True))
    try:
        values = infer(rulebase, inputs)[samples.target]
    except InferenceError:
        return dict.fromkeys(ERRORS, math.inf)
    return errors_between(np.broadcast_to(values, samples.values.shape), samples.values)


def errors_between(predicted: Vector, observed: Vector) -> dict[str, float]:
    """Return root mean square, mean and largest magnitude of the difference."""
    magnitudes = np.abs(predicted - observed)
    if np.isnan(magnitudes).any():
        return dict.fromkeys(ERRORS, math.inf)
    rmse = math.sqrt(float(np.mean(magnitudes**2)))
    return {"rmse": rmse, "mae": float(magnitudes.mean()), "worst": float(magnitudes.max())}


# --- A function of the user's ---

OwnCost = Callable[[Any], float]
"""From a list of :class:`fuzzyarm.control.loop.Run`, or from the rule base if tuned alone."""


def read_cost(text: str, metrics: tuple[str, ...] = METRICS) -> Cost | OwnCost:
    """Return a user's cost: a formula, or ``FILE.py:FUNCTION``, which is executed."""
    path, _, name = text.rpartition(":")
    if not path.endswith(".py"):
        if text.endswith(".py"):
            hint = f"{text}:FUNCTION"
            raise CostFormulaError(f"'{text}' does not name a function", name=text, hint=hint)
        return Cost(text, metrics)
    module = executed(path, CostFormulaError)
    function = getattr(module, name, None)
    if not callable(function):
        functions = list(_functions(module))
        hint = near_hint(name, functions)[0] or f"it has {', '.join(functions) or 'none'}"
        raise CostFormulaError(f"{path} has no function '{name}'", name=name, hint=hint)
    return function  # type: ignore[no-any-return]


def _functions(module: Any) -> Iterator[str]:
    for name, value in vars(module).items():
        if callable(value) and getattr(value, "__module__", "") == module.__name__:
            yield name


def value_of_user(function: OwnCost, what: Any) -> float:
    """Return the value of a function of the user; an exception becomes one sentence."""
    try:
        value = float(function(what))
    except USERS as error:
        path = getattr(getattr(function, "__code__", None), "co_filename", "")
        raise CostFormulaError(f"the cost failed: {failure(path, error)}") from error
    return value if not math.isnan(value) else math.inf
