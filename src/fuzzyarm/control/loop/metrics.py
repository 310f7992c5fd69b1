"""Metrics of a run: accuracy, speed, chatter, effort.

To add a metric: a field of :class:`Metrics` and its formula in ``FORMULAS``.
``docs/reference/metrics.md`` is generated from it, and a test evaluates the formula. It is then
also a cost of ``tune``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.control.loop.loop import final, rms, signed_maximum

Vector = NDArray[np.float64]

NEAR = 1e-6
"""Relative distance to a limit at which a drive counts as saturated."""

SETTLED = 0.02
"""Settling band, as a share of the step."""


@dataclass(frozen=True)
class Metrics:
    """Metrics of one axis; errors in the displayed unit, times in s, drives in their unit.

    Attributes
    ----------
    rms, max, final : float
        Root mean square, largest with its sign, and last error at the set points, by the
        conventions of the run.
    rise : float or None
        Time from 10 to 90 % of a step; None for other references, or if 90 % is not reached.
    overshoot : float or None
        Peak beyond the step, in the unit of the error; None for other references.
    settling : float or None
        Time until the error stays within 2 % of a step.
    ise, iae, itae : float
        Integrals over time of the square, the magnitude, and time times magnitude of the error.
    effort : float
        Root mean square of the axis's drives.
    variation : float
        Sum of all changes of the drives from sample to sample, per second: chatter.
    saturated : float
        Share of the samples with a drive at a limit of its actuator or of the controller.
    chatter : float
        Root mean square of the change of the axis's first drive (on the arm its torque) between
        control periods; the step from rest to the first drive does not count.
    rms_periods : float
        Root mean square error over all control periods, from the held set point.
    rms_path : float
        The same from the reference of which the set points are samples.
    """

    rms: float
    max: float
    final: float
    rise: float | None
    overshoot: float | None
    settling: float | None
    ise: float
    iae: float
    itae: float
    effort: float
    variation: float
    saturated: float
    chatter: float = 0.0
    rms_periods: float = math.nan
    rms_path: float = math.nan

    def as_dict(self) -> dict[str, float | None]:
        """Return the metrics by name; None for non-finite ones."""
        values: dict[str, float | None] = jsonable(
            {field.name: getattr(self, field.name) for field in fields(self)}
        )
        return values


METRICS = tuple(field.name for field in fields(Metrics))
"""Names of all metrics."""

ERRORS = ("rms", "rms_periods", "rms_path", "max", "final", "overshoot")
"""Metrics in the unit of the error."""


def metric_unit(metric: str, error: str, drives: Sequence[str]) -> str:
    """Return the unit of a metric; empty if it has none or the drives have different ones.

    Parameters
    ----------
    metric : str
        A field of :class:`Metrics`.
    error : str
        Unit of the error.
    drives : sequence of str
        Units of the axis's drives.
    """
    own_error = "" if error == "1" else error
    drive = drives[0] if drives else ""
    every = drive if len(set(drives)) == 1 else ""
    units = {
        "rise": "s",
        "settling": "s",
        "ise": f"{own_error}^2 s" if own_error else "s",
        "iae": f"{own_error} s".strip(),
        "itae": f"{own_error} s^2".strip(),
        "effort": every,
        "variation": f"{every}/s" if every else "",
        "saturated": "",
        "chatter": drive,
    }
    return own_error if metric in ERRORS else units[metric]


class PeriodFigures(NamedTuple):
    """Figures accumulated in every control period, which samples cannot give."""

    chatter: float = 0.0
    rms_periods: float = math.nan
    rms_path: float = math.nan


_NOTHING = PeriodFigures()


def metrics_of(
    time: Vector,
    reference: Vector,
    errors: Vector,
    drives: Vector,
    limits: list[tuple[float, float]],
    period: float,
    maximum: Literal["magnitude", "positive"] = "magnitude",
    counted: PeriodFigures = _NOTHING,
) -> Metrics:
    """Compute the metrics of one axis.

    Parameters
    ----------
    time, reference, errors : ndarray, shape (n,)
        At the samples; reference and errors in one unit. NaN errors are lost samples, ignored by
        all figures.
    drives : ndarray, shape (n, k)
        Drives of the axis.
    limits : list of pair of float
        Lowest and highest value of each drive.
    period : float
        Time between samples, s.
    maximum : {"magnitude", "positive"}, optional
        See :func:`fuzzyarm.control.loop.loop.signed_maximum`.
    counted : PeriodFigures, optional
        Figures from the loop.
    """
    if not len(errors):
        none = math.nan
        return Metrics(none, none, none, None, None, None, none, none, none, none, none, none, none)
    known = ~np.isnan(errors)
    magnitude = np.abs(errors[known])
    elapsed = (time - time[0])[known]
    ise, iae, itae = (
        float(np.sum(values) * period) if len(values) else math.nan
        for values in (np.square(magnitude), magnitude, elapsed * magnitude)
    )
    rise, overshoot, settling = _step_response(time, reference, errors)
    at_limit = np.zeros(len(errors), bool)
    limited = any(low > -math.inf or high < math.inf for low, high in limits)
    for column, (low, high) in enumerate(limits):
        # In single precision a saturated drive may be one last bit inside its limit.
        if low > -math.inf:
            at_limit |= drives[:, column] <= low + NEAR * abs(low)
        if high < math.inf:
            at_limit |= drives[:, column] >= high - NEAR * abs(high)
    span = len(errors) * period
    return Metrics(
        float(rms(errors)),
        float(signed_maximum(errors[:, None], maximum)[0]),
        float(final(errors[:, None])[0]),
        rise,
        overshoot,
        settling,
        ise,
        iae,
        itae,
        float(np.sqrt(np.mean(drives**2))) if drives.size else 0.0,
        float(np.abs(drives[1:] - drives[:-1]).sum() / span) if drives.size else 0.0,
        float(at_limit.mean()) if limited else 0.0,
        *counted,
    )


def _step_response(
    time: Vector, reference: Vector, errors: Vector
) -> tuple[float | None, float | None, float | None]:
    """Return rise time, overshoot and settling time, where the reference is one step."""
    jumps = np.flatnonzero(reference[1:] != reference[:-1])
    # A step before the first sample shows no jump: the first output is the start.
    begin = 0 if not len(jumps) else int(jumps[0]) + 1
    if len(jumps) > 1 or reference[-1] != reference[begin]:
        return None, None, None
    output = reference - errors
    known = np.flatnonzero(~np.isnan(output))
    if not (known >= begin).any():
        return None, None, None
    before = known[known < max(begin, 1)]
    start, target = float(output[before[-1] if len(before) else known[0]]), float(reference[-1])
    size = target - start
    if size == 0.0:
        return None, None, None
    # Normalise: 0 at the start, 1 at the target, for steps up and down.
    known = known[known >= begin]
    way = (output[known] - start) / size
    after = time[known] - time[begin]
    low, high = np.flatnonzero(way >= 0.1), np.flatnonzero(way >= 0.9)
    rise = float(after[high[0]] - after[low[0]]) if len(high) else None
    overshoot = max(0.0, float(way.max()) - 1.0) * abs(size)
    outside = np.flatnonzero(np.abs(way - 1.0) > SETTLED)
    settling = 0.0 if not len(outside) else None
    if len(outside) and outside[-1] + 1 < len(after):
        settling = float(after[outside[-1] + 1])
    return rise, overshoot, settling


# --- Formulas, for the documentation ---

ERROR, SECONDS, DRIVE = "of the error", "s", "of the drives"

FORMULAS: dict[str, tuple[str, str]] = {
    "rms": (ERROR, "sqrt(mean(e**2))"),
    "max": (ERROR, "e[argmax(abs(e))]"),
    "final": (ERROR, "e[-1]"),
    "rise": (SECONDS, "t[way >= 0.9][0] - t[way >= 0.1][0]"),
    "overshoot": (ERROR, "max(0, max(way) - 1) * abs(step)"),
    "settling": (SECONDS, f"t[last(abs(way - 1) > {SETTLED:g}) + 1]"),
    "ise": (f"{ERROR}, squared, times s", "sum(e**2) * T"),
    "iae": (f"{ERROR}, times s", "sum(abs(e)) * T"),
    "itae": (f"{ERROR}, times s²", "sum(t * abs(e)) * T"),
    "effort": (DRIVE, "sqrt(mean(d**2))"),
    "variation": (f"{DRIVE}, per s", "sum(abs(diff(d))) / (n * T)"),
    "saturated": ("a share, 0 to 1", "mean(any((d <= low) | (d >= high)))"),
    "chatter": ("of the first drive", "sqrt(mean(diff(d1)**2)), d1 in every control period"),
    "rms_periods": (ERROR, "sqrt(mean(e**2)), e in every control period"),
    "rms_path": (ERROR, "sqrt(mean(e**2)), e in every control period, from the reference itself"),
}
"""Unit and formula of each metric; ``docs/reference/metrics.md`` has their names.

``tests/docs/test_metrics_page.py`` computes them.
"""
