"""Metrics of a run: accuracy, speed, chatter, effort.

To add a metric: a field of :class:`Metrics`, its record in ``METRIC_KINDS`` and a row of the table
in ``docs/tutorial/5-a-controller.md``, all in one order. ``pytest --update-golden tests/docs``
renews the pages that print all metrics; ``pytest tests/docs/test_metrics_page.py
tests/controller/test_not_a_number.py`` evaluates formula and unit, and runs without a sample. The
metric is then also a cost of ``tune``.

A metric over every control period, which samples lack, first needs

1. a row of sums in ``note_errors`` of :mod:`fuzzyarm.control.loop.loop`: its number beside `HELD`,
   one more in `ERRORS`, its statement in the kernel; then ``make native``;
2. its value in ``EVERY_PERIOD`` of :mod:`fuzzyarm.control.loop.program`, under the name of the
   metric: ``record.errors(ROW)`` is the row, ``shown_means`` the root of its mean.

The value in ``METRIC_KINDS`` is then ``_counted("NAME")``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.jsonable import JsonRecord
from fuzzyarm.control.loop.loop import final, rms, signed_maximum

Vector = NDArray[np.float64]

NEAR = 1e-6
"""Relative distance to a limit at which a drive counts as saturated."""

SETTLED = 0.02
"""Settling band, as a share of the step."""


@dataclass(frozen=True)
class Metrics(JsonRecord):
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
        The same from the reference sampled by the set points.
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


METRICS = tuple(field.name for field in fields(Metrics))
"""Names of all metrics."""


_NOTHING: Mapping[str, float] = MappingProxyType({"chatter": 0.0})


def metrics_of(
    time: Vector,
    reference: Vector,
    errors: Vector,
    drives: Vector,
    limits: list[tuple[float, float]],
    period: float,
    maximum: Literal["magnitude", "positive"] = "magnitude",
    counted: Mapping[str, float] = _NOTHING,
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
    counted : mapping of str to float, optional
        Metrics summed up by the loop in every control period.
    """
    samples = _Samples(time, reference, errors, drives, limits, period, maximum, counted)
    values: dict[str, Any] = {
        name: kind.value(samples) if len(errors) else kind.missing
        for name, kind in METRIC_KINDS.items()
    }
    return Metrics(**values)


def _step_response(
    time: Vector, reference: Vector, errors: Vector
) -> tuple[float | None, float | None, float | None]:
    """Return rise time, overshoot and settling time, if the reference is one step."""
    # Sampled definitions: 10 % to 90 % of the step, and the first sample after the last one outside
    # the band, without interpolation between samples.
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


# --- Records ---


@dataclass(frozen=True)
class _Samples:
    """The data of one axis at the samples."""

    time: Vector
    reference: Vector
    errors: Vector
    drives: Vector
    limits: list[tuple[float, float]]
    period: float
    maximum: Literal["magnitude", "positive"]
    counted: Mapping[str, float]

    @cached_property
    def magnitudes(self) -> Vector:
        """Known absolute errors."""
        known: Vector = self.errors[~np.isnan(self.errors)]
        return np.abs(known)

    @cached_property
    def elapsed(self) -> Vector:
        """Times of known errors since the first sample."""
        elapsed: Vector = (self.time - self.time[0])[~np.isnan(self.errors)]
        return elapsed

    def integral(self, values: Vector) -> float:
        """Return the integral of values over the samples; NaN of none."""
        # The rectangle rule: each sample counts for the period after it.
        return float(np.sum(values) * self.period) if len(values) else math.nan

    @cached_property
    def step(self) -> tuple[float | None, float | None, float | None]:
        """Rise time, overshoot and settling time."""
        return _step_response(self.time, self.reference, self.errors)

    @property
    def variation(self) -> float:
        """Movement of all drives per second."""
        if not self.drives.size:
            return 0.0
        # Total variation, Σ |u_k - u_(k-1)| over all drives, by the length of the run in seconds.
        moved = np.abs(self.drives[1:] - self.drives[:-1]).sum()
        return float(moved / (len(self.errors) * self.period))

    @property
    def saturated(self) -> float:
        """Share of the samples at which a drive is at a limit."""
        at_limit = np.zeros(len(self.errors), bool)
        for column, (low, high) in enumerate(self.limits):
            # In single precision a saturated drive may be one last bit inside its limit.
            if low > -math.inf:
                at_limit |= self.drives[:, column] <= low + NEAR * abs(low)
            if high < math.inf:
                at_limit |= self.drives[:, column] >= high - NEAR * abs(high)
        return float(at_limit.mean())


class MetricKind(NamedTuple):
    """The definition of a metric.

    Attributes
    ----------
    unit : str
        For the page: ``of the error``, ``s``, …
    formula : str
        In NumPy, for the page; a test computes it.
    value : callable
        From the samples to its value.
    symbol : str
        Its unit, with the placeholders ``{error}``, ``{drive}`` (of the first drive) and
        ``{every}`` (of all drives); empty if a necessary one is empty or ``1``.
    missing : float or None
        Its value without samples.
    """

    unit: str
    formula: str
    value: Callable[[_Samples], float | None]
    symbol: str = "{error}"
    missing: float | None = math.nan


def _counted(name: str) -> Callable[[_Samples], float]:
    """Return the reader of a metric summed up by the loop."""
    return lambda samples: samples.counted.get(name, math.nan)


ERROR, SECONDS, DRIVE = "of the error", "s", "of the drives"

METRIC_KINDS: dict[str, MetricKind] = {
    "rms": MetricKind(ERROR, "sqrt(mean(e**2))", lambda s: float(rms(s.errors))),
    "max": MetricKind(
        ERROR, "e[argmax(abs(e))]",
        lambda s: float(signed_maximum(s.errors[:, None], s.maximum)[0]),
    ),
    "final": MetricKind(ERROR, "e[-1]", lambda s: float(final(s.errors[:, None])[0])),
    "rise": MetricKind(
        SECONDS, "t[way >= 0.9][0] - t[way >= 0.1][0]", lambda s: s.step[0], "s", None
    ),
    "overshoot": MetricKind(
        ERROR, "max(0, max(way) - 1) * abs(step)", lambda s: s.step[1], missing=None
    ),
    "settling": MetricKind(
        SECONDS, f"t[last(abs(way - 1) > {SETTLED:g}) + 1]", lambda s: s.step[2], "s", None
    ),
    "ise": MetricKind(
        f"{ERROR}, squared, times s", "sum(e**2) * T",
        lambda s: s.integral(np.square(s.magnitudes)), "{error}^2 s",
    ),
    "iae": MetricKind(
        f"{ERROR}, times s", "sum(abs(e)) * T", lambda s: s.integral(s.magnitudes), "{error} s"
    ),
    "itae": MetricKind(
        f"{ERROR}, times s²", "sum(t * abs(e)) * T",
        lambda s: s.integral(s.elapsed * s.magnitudes), "{error} s^2",
    ),
    "effort": MetricKind(
        DRIVE, "sqrt(mean(d**2))",
        lambda s: float(np.sqrt(np.mean(s.drives**2))) if s.drives.size else 0.0, "{every}",
    ),
    "variation": MetricKind(
        f"{DRIVE}, per s", "sum(abs(diff(d))) / (n * T)", lambda s: s.variation, "{every}/s"
    ),
    "saturated": MetricKind(
        "a share, 0 to 1", "mean(any((d <= low) | (d >= high)))", lambda s: s.saturated, ""
    ),
    "chatter": MetricKind(
        "of the first drive", "sqrt(mean(diff(d1)**2)), d1 in every control period",
        _counted("chatter"), "{drive}",
    ),
    "rms_periods": MetricKind(
        ERROR, "sqrt(mean(e**2)), e in every control period", _counted("rms_periods")
    ),
    "rms_path": MetricKind(
        ERROR, "sqrt(mean(e**2)), e in every control period, from the reference itself",
        _counted("rms_path"),
    ),
}  # fmt: skip
"""Each metric, in the order of :class:`Metrics`; ``docs/reference/metrics.md`` has their names.

``tests/docs/test_metrics_page.py`` computes the formulas.
"""

ERRORS = tuple(name for name, kind in METRIC_KINDS.items() if kind.symbol == "{error}")
"""Metrics in the unit of the error."""

FORMULAS = {name: (kind.unit, kind.formula) for name, kind in METRIC_KINDS.items()}
"""Unit and formula of each metric, for its page."""


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
    drive = drives[0] if drives else ""
    every = drive if len(set(drives)) == 1 else ""
    own = "" if error == "1" else error
    symbol = METRIC_KINDS[metric].symbol
    if "{every}" in symbol and not every:
        return ""
    if "{error}^" in symbol and not own:
        symbol = "s"
    return symbol.format(error=own, drive=drive, every=every).strip()
