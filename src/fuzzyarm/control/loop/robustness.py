"""Controllers over the same runs: the robustness of each, and the runs in which one is better.

A run fails if it diverges, or if the metric has no value, such as the settling time of a loop that
does not settle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import JsonRecord
from fuzzyarm.control.loop.many import Many, Vector

Choice = NDArray[np.bool_]
Spans = Mapping[str, Sequence[tuple[float, float]]]


class RobustnessError(FuzzyarmError, ValueError):
    """Results of different runs."""


@dataclass(frozen=True)
class Robustness(JsonRecord):
    """A metric of one output over the runs of a controller.

    Attributes
    ----------
    controller, output : str
        Names.
    median : float or None
        Median magnitude of all runs, failed ones taken as infinite; None if it is.
    worst : float or None
        Greatest magnitude of the completed runs; None if all failed.
    run : int or None
        Its number, from 0.
    failed : int
        Number of failed runs.
    """

    controller: str
    output: str
    median: float | None
    worst: float | None
    run: int | None
    failed: int


@dataclass(frozen=True)
class PairedComparison(JsonRecord):
    """Two controllers, run by run: one is better whose metric is smaller on every output.

    Attributes
    ----------
    first, second : str
        Their names.
    better, worse : int
        Number of runs in which the first one is better, and the second.
    better_where, worse_where : mapping of str to sequence of pair of float
        By swept name, first and last of neighbouring values at which this holds for all values of
        the other names.
    """

    first: str
    second: str
    better: int
    worse: int
    better_where: Spans
    worse_where: Spans


def robustness(results: Sequence[Many], metric: str = "rms") -> list[Robustness]:
    """Return median, worst and failures of each controller and output.

    Parameters
    ----------
    results : sequence of Many
        The same runs of each controller.
    metric : str, optional
        See :class:`fuzzyarm.control.loop.metrics.Metrics`.
    """
    _require_same_runs(results)
    return [
        _robustness(many, output, magnitudes)
        for many in results
        for output, magnitudes in zip(many.outputs, _magnitudes(many, metric).T, strict=True)
    ]


def _robustness(many: Many, output: str, magnitudes: Vector) -> Robustness:
    failed = np.isinf(magnitudes)
    median = float(np.median(magnitudes))
    run = None if failed.all() else int(np.argmax(np.where(failed, -1.0, magnitudes)))
    return Robustness(
        many.controller,
        output,
        median if math.isfinite(median) else None,
        None if run is None else float(magnitudes[run]),
        run,
        int(failed.sum()),
    )


def paired_comparison(first: Many, second: Many, metric: str = "rms") -> PairedComparison:
    """Compare two controllers run by run.

    Parameters
    ----------
    first, second : Many
        The same runs of each.
    metric : str, optional
        See :class:`fuzzyarm.control.loop.metrics.Metrics`.
    """
    _require_same_runs([first, second])
    ours, theirs = _magnitudes(first, metric), _magnitudes(second, metric)
    better: Choice = np.logical_and.reduce(ours < theirs, axis=1)
    worse: Choice = np.logical_and.reduce(theirs < ours, axis=1)
    return PairedComparison(
        first.controller,
        second.controller,
        int(better.sum()),
        int(worse.sum()),
        _where(first, better),
        _where(first, worse),
    )


def _magnitudes(many: Many, metric: str) -> Vector:
    """Return the magnitude of a metric, shape (n, outputs); infinite for a failed run."""
    values = np.abs(many[metric])
    values[~np.isnan(many.diverged)] = np.inf
    return np.where(np.isnan(values), np.inf, values)


def _require_same_runs(results: Sequence[Many]) -> None:
    first, *others = results
    for other in others:
        same = (
            len(first) == len(other)
            and first.outputs == other.outputs
            and np.array_equal(first.seeds, other.seeds)
            and list(first.changes) == list(other.changes)
            and all(map(_equal, first.changes.values(), other.changes.values()))
        )
        if not same:
            names = f"{first.controller} and {other.controller}"
            raise RobustnessError(f"{names} are not compared in the same runs")


def _equal(one: Vector, other: Vector) -> bool:
    return np.array_equal(one, other, equal_nan=True)


def _where(many: Many, chosen: Choice) -> dict[str, list[tuple[float, float]]]:
    """Return the values, by swept name, at which a choice of runs holds."""
    spans: dict[str, list[tuple[float, float]]] = {}
    for name, column in many.changes.items():
        values, at = np.unique(column, return_inverse=True)
        # Of several names drawn at random, no two runs share a value: nothing to compare.
        if column.ndim == 1 and (len(values) < len(column) or len(many.changes) == 1):
            holds = np.ones(len(values), bool)
            np.logical_and.at(holds, at, chosen)
            spans[name] = _spans(values, holds)
    return {name: found for name, found in spans.items() if found}


def _spans(values: Vector, holds: Choice) -> list[tuple[float, float]]:
    """Return first and last of each series of neighbouring values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]])))
    return [
        (float(values[first]), float(values[end - 1]))
        for first, end in list(pairwise(edges.tolist()))[::2]
    ]
