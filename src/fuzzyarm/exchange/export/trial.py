"""Signals to try a controller with: the sequence of its self-test."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.exchange.export.evaluation import EvaluatedController
from fuzzyarm.exchange.export.steps import Ask, Find, Steps
from fuzzyarm.exchange.export.table_numbers import FixedTable

__all__ = ["LOST", "trial"]

LOST = 7
"""The period in which the first axis reads a value that is not a number; the next axis in the next.
In the very first period all axes do: their drives have no last value yet."""

_SEGMENT = 5
"""Periods of one sort."""

_ANY_SIZE = np.array([-3.0, -0.9, -0.3, -0.05, -0.002, 0.0, 0.002, 0.05, 0.3, 0.9, 3.0])

_NO_SIZE = np.array([], np.float64)

_PROBE = 1e-3


def trial(
    steps: Steps, periods: int, seed: int = 1, controller: EvaluatedController | None = None
) -> Iterator[dict[str, float]]:
    """Yield values for the ports, period by period.

    References wander. Measured values miss them by errors: for some periods in turn those that
    show most, then some about one point, so that changes are of every size, too. With a controller
    the errors bring what its rule bases and tables read into every piece of their terms and cells,
    and beyond their ranges. Some values are not numbers (`LOST`).
    """
    draw = np.random.default_rng(seed)
    outside = steps.precision.outside
    references = {variable: draw.uniform(0.2, 2.0, 2) for variable in steps.of_sort("reference")}
    measured = steps.of_sort("measured")
    telling = _telling_errors(steps, controller) if controller is not None else {}
    errors = {port: telling.get(port.symbol, (_ANY_SIZE, _NO_SIZE)) for port in measured}
    turns = {port: [_in_turn(sizes, draw) for sizes in each] for port, each in errors.items()}
    points = dict.fromkeys(measured, 0.0)
    for k in range(periods):
        around = (k // _SEGMENT) % 3 == 2
        if k % _SEGMENT == 0:
            spread = 10.0 ** draw.uniform(-3.0, 0.0)
        for port, (next_size, next_change) in turns.items():
            sizes, changes = errors[port]
            if not around or k % _SEGMENT == 0:
                points[port] = next(next_size)
            elif changes.size:
                points[port] += next(next_change)
            else:
                points[port] += spread * sizes[-1] * draw.uniform(-1.0, 1.0)
        sample = {
            variable.symbol: float(outside(a * math.sin(0.05 * b * k)))
            for variable, (a, b) in references.items()
        }
        for port, error in points.items():
            target = sample.get(port.symbol.replace("measured:", "reference:"), 0.0)
            sample[port.symbol] = float(outside(target - error))
        for number, (guard, *_) in enumerate(steps.guards):
            if k in (0, LOST + number):
                sample[guard.reads[k % len(guard.reads)]] = math.nan
        yield sample


def _in_turn(sizes: NDArray[Any], draw: np.random.Generator) -> Iterator[float]:
    """Yield all sizes, in another order each time."""
    while sizes.size:
        yield from draw.permutation(sizes).tolist()


def _telling_errors(
    steps: Steps, controller: EvaluatedController
) -> dict[str, tuple[NDArray[Any], NDArray[Any]]]:
    """Return errors of each measured port, and changes of them, for the values that show most."""
    ports = [port.symbol for sort in ("reference", "measured") for port in steps.of_sort(sort)]
    wanted = list(_read(steps))

    def values(moved: str) -> list[NDArray[Any]]:
        """Return what is read in the period in which a port moves, and in the next one."""
        controller.start()
        found = []
        for size in (0.0, _PROBE, _PROBE):
            controller.step(*(-size if port == moved else 0.0 for port in ports))
            found.append(np.array([controller.value(name) for name, _ in wanted]))
        return found[1:]

    rest, telling = values("")[0], {}
    for port in ports:
        slopes, later = ((found - rest) / _PROBE for found in values(port))
        errors, changes = [_NO_SIZE], [_NO_SIZE]
        for slope, stays, start, (_, points) in zip(slopes, later, rest, wanted, strict=True):
            if slope != 0.0 and math.isfinite(slope):
                kind = errors if abs(stays) > 1e-3 * abs(slope) else changes
                kind.append((points - start) / slope)
        sizes, moved = (np.unique(np.concatenate(each)) for each in (errors, changes))
        telling[port] = (sizes if sizes.size else _ANY_SIZE), moved
    controller.start()
    return telling


def _read(steps: Steps) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield what rule bases and tables read, each with values in and between its pieces."""
    for step in steps.steps:
        if isinstance(step, Ask):
            columns = steps.routines[step.routine].vectors().inputs
            telling = [np.unique(column.astype(np.float64)) for column in columns]
            core = getattr(steps.routines[step.routine], "core", None)
            if isinstance(core, FixedTable):
                scales = core.inputs
                telling = [scale.quantity(x) for scale, x in zip(scales, telling, strict=True)]
        elif isinstance(step, Find):
            telling = [_between(edges) for _, edges in steps.grids[step.grid]]
        else:
            continue
        yield from zip(step.inputs, telling, strict=True)


def _between(edges: tuple[float, ...]) -> NDArray[Any]:
    """Return values between edges, and beyond."""
    if len(edges) < 2:
        return np.array([edges[0] - 1.0, edges[0] + 1.0] if edges else [0.0])
    points = np.array(edges)
    middles = 0.5 * (points[1:] + points[:-1])
    return np.concatenate([[2 * points[0] - middles[0]], middles, [2 * points[-1] - middles[-1]]])
