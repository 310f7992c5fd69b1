"""A recorded run through a controller: its computed drives beside the recorded ones."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import UsageError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.control.controllers.text import ControllerText

Array = NDArray[np.float64]

CLOSE = 1e-6
"""Share of the largest recorded value within which both drives count as equal."""


@json_properties("drive compared parts_at would was worst worst_at rms")
@dataclass(frozen=True, slots=True)
class ReplayedDrive:
    """A drive of a recorded run.

    Attributes
    ----------
    drive : str
        Its port.
    compared : int
        Number of periods with a recorded value.
    parts_at : int or None
        The first period with a difference above the tolerance, from 0; None: they agree.
    would, was : float or None
        The computed and the recorded drive there.
    worst : float
        The greatest magnitude of the difference.
    worst_at : int
        Its period.
    rms : float
        Root mean square of the difference.
    """

    drive: str
    compared: int
    parts_at: int | None
    would: float | None
    was: float | None
    worst: float
    worst_at: int
    rms: float


@json_properties("periods gap skipped drives")
@dataclass(frozen=True, slots=True)
class Replay:
    """A recorded run, replayed.

    Attributes
    ----------
    periods : int
        Its length.
    gap : int or None
        The first period not one control period after the one before; None without a gap or without
        times.
    skipped : dict of str to int
        Number of skipped periods, by axis.
    drives : tuple of ReplayedDrive
        Each recorded drive.
    """

    periods: int
    gap: int | None
    skipped: Mapping[str, int]
    drives: tuple[ReplayedDrive, ...]


def replay(
    text: ControllerText,
    measured: Mapping[str, Array],
    references: Mapping[str, Array],
    driven: Mapping[str, Array],
    *,
    times: Array | None = None,
    tolerance: float | None = None,
) -> Replay:
    """Run a controller over a recorded run; it begins anew with the first period.

    Parameters
    ----------
    text : ControllerText
        The controller.
    measured, references, driven : mapping of str to ndarray
        By port, a value for each period; NaN is a lost sample.
    times : ndarray, optional
        The time of each period, s.
    tolerance : float, optional
        Permitted difference of both drives, in their unit; by default 1e-6 of the largest value.

    Raises
    ------
    UsageError
        If the tolerance is negative or not a number.
    """
    if tolerance is not None and not 0.0 <= tolerance < math.inf:
        raise UsageError(f"a tolerance of {tolerance:g} is out of range", hint="0 or more")
    run = text.run()
    count = min(len(values) for values in (*measured.values(), *references.values()))
    would = {name: np.empty(count) for name in driven}
    for k in range(count):
        sent = run.step(
            {name: float(values[k]) for name, values in measured.items()},
            {name: float(values[k]) for name, values in references.items()},
        )
        for name, values in would.items():
            values[k] = sent[name]
    drives = tuple(
        _compared(name, would[name], np.asarray(was, float)[:count], tolerance)
        for name, was in driven.items()
    )
    gap = None if times is None else _gap(times, text.model.period)
    return Replay(count, gap, run.skipped, drives)


def _compared(name: str, would: Array, was: Array, tolerance: float | None) -> ReplayedDrive:
    known = ~np.isnan(was)  # infinity counts as a value, far from any other
    apart = np.where(known, np.abs(would - was), 0.0)
    if tolerance is None:
        tolerance = CLOSE * float(np.abs(was[np.isfinite(was)]).max(initial=0.0))
    beyond = np.flatnonzero(known & (apart > tolerance))
    first = int(beyond[0]) if beyond.size else None
    worst = int(apart.argmax())
    one, other = (None if first is None else float(values[first]) for values in (would, was))
    rms = math.sqrt(float(np.mean(apart[known] ** 2))) if known.any() else 0.0
    size = float(apart[worst])
    return ReplayedDrive(name, int(known.sum()), first, one, other, size, worst, rms)


def _gap(times: Array, period: float) -> int | None:
    """Return the first period that is not one control period after the one before."""
    steps = np.diff(times)
    odd = np.flatnonzero(~(np.abs(steps - period) <= 0.05 * period))
    return int(odd[0]) + 1 if odd.size else None
