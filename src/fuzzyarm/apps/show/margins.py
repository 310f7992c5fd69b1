"""Margins of a loop opened at a drive: in words, and as Bode and Nyquist diagrams."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.apps.show.diagram import time_text
from fuzzyarm.base.columns import in_columns
from fuzzyarm.base.picture import COLOURS, Axis, Chart, ChartPart, Dots, Level, Line, Panel

if TYPE_CHECKING:
    from fuzzyarm.proof.loop.margins import DriveMargins, Margins, WorstMargins

POINTS = 600
NEAREST = 3.0
"""Half the width of a Nyquist diagram, which includes the point -1."""


def margins_chart(found: Sequence[DriveMargins], title: str) -> Chart:
    """Return a row for each drive: gain and phase over frequency, and the curve of L."""
    rows = [_row(each, named=len(found) > 1) for each in found]
    return Chart(rows, (11.4, 0.8 + 3.2 * len(rows)), title, heading=True)


def _row(each: DriveMargins, *, named: bool) -> list[Panel]:
    omega = _frequencies(each)
    values = each.loop.at(omega)
    across = Axis("frequency", "rad/s", logarithmic=True)
    return [
        _gain_panel(each, omega, np.abs(values), across, each.drive[1] if named else ""),
        _phase_panel(each, omega, values, across),
        _nyquist_panel(each, values),
    ]


def _frequencies(each: DriveMargins) -> np.ndarray:
    """Return frequencies from well below the first relevant one to half the sampling rate."""
    fastest = math.pi / each.loop.period
    marks = [each.nominal.gain_at, each.nominal.phase_at]
    first = min((w for w in marks if w), default=fastest)
    return np.geomspace(min(0.01 * first, 1e-3 * fastest), fastest * (1.0 - 1e-9), POINTS)


def _gain_panel(
    each: DriveMargins, omega: np.ndarray, sizes: np.ndarray, across: Axis, name: str
) -> Panel:
    parts: list[ChartPart] = [
        Level(0.0, dash=":"),
        Line(omega, 20.0 * np.log10(sizes), "first", 1.4),
    ]
    margins = each.nominal
    title = name
    if margins.stable and margins.gain_at and math.isfinite(margins.gain or math.inf):
        decibels = 20.0 * math.log10(margins.gain or 1.0)
        at = margins.gain_at
        parts.append(Line((at, at), (-decibels, 0.0), COLOURS[3], 1.6))
        title = ": ".join(filter(None, (name, f"gain margin {decibels:.1f} dB")))
    return Panel(parts, across, Axis("gain", "dB"), title)


def _phase_panel(each: DriveMargins, omega: np.ndarray, values: np.ndarray, across: Axis) -> Panel:
    degrees = np.degrees(np.unwrap(np.angle(values)))
    margins = each.nominal
    at, margin = margins.phase_at or 0.0, margins.phase or 0.0
    is_shown = bool(margins.stable and at)
    # Of the turns of the curve the one whose -180 degrees the margin is measured from.
    nearest = float(np.interp(at, omega, degrees)) - margin + 180.0 if is_shown else 0.0
    first = 360.0 * math.ceil((degrees[0] - 180.0) / 360.0)
    degrees -= 360.0 * round(nearest / 360.0) if is_shown else first
    parts: list[ChartPart] = [Level(-180.0, dash=":"), Line(omega, degrees, "first", 1.4)]
    title = ""
    if is_shown:
        parts.append(Line((at, at), (-180.0, margin - 180.0), COLOURS[3], 1.6))
        title = f"phase margin {margin:.1f}°"
    return Panel(parts, across, Axis("phase", "°"), title)


def _nyquist_panel(each: DriveMargins, values: np.ndarray) -> Panel:
    real, imaginary = values.real, values.imag
    seen = np.abs(values) <= 2.0 * NEAREST
    x = np.where(seen, real, np.nan)
    y = np.where(seen, imaginary, np.nan)
    angle = np.linspace(0.0, 2.0 * math.pi, 121)
    parts: list[ChartPart] = [
        Line(np.cos(angle), np.sin(angle), "wanted", 0.7, ":"),
        Line(x, y, "first", 1.4),
        Line(x, -y, "first", 0.8, "--"),
        Dots((-1.0,), (0.0,), "+", COLOURS[3], 7.0, edge=1.4),
    ]
    title = ""
    peak = each.nominal.sensitivity
    if peak:
        parts.insert(1, Line(np.cos(angle) / peak - 1.0, np.sin(angle) / peak, COLOURS[3], 0.8))
        title = f"peak sensitivity {peak:.3g}"
    wide = Axis("real part", low=-NEAREST, high=0.5 * NEAREST)
    high = Axis("imaginary part", low=-0.75 * NEAREST, high=0.75 * NEAREST)
    return Panel(parts, wide, high, title, equal=True)


# --- In words ---


def margin_lines(each: DriveMargins) -> list[str]:
    """Return the margins at a drive in words."""
    nominal, worst = each.nominal, each.worst
    head = f"opened at '{each.drive[1]}'"
    held = [f"  at rest {words}" for words in each.held]
    if not nominal.stable:
        return [f"{head}: not stable, the spectral radius is {each.loop.radius:.6g}", *held]
    beside = worst.margins if worst is not None and worst.margins.stable else None
    rows = [("", "at rest", "worst over the gains of the rules" if beside else "")]
    for name, words in _WORDS.items():
        rows.append((name, words(nominal), words(beside) if beside else ""))
    return [head, *held, *in_columns(rows, indent="  "), *_gain_lines(worst)]


def _gain_lines(worst: WorstMargins | None) -> list[str]:
    if worst is None:
        return ["  no bounds of the rules' gains: at rest only"]
    ends = [f"  {gain.words}: {gain.low:.4g} .. {gain.high:.4g}" for gain in worst.gains]
    if worst.margins.stable:
        return ["  with gains of the rules in", *(f"  {line}" for line in ends)]
    at = ", ".join(f"{value:.4g}" for value in worst.where["stable"])
    return [
        "  not stable for all gains of the rules in",
        *(f"  {e}" for e in ends),
        f"  not at {at}",
    ]


def _at(omega: float | None) -> str:
    return "" if omega is None else f" at {omega:.4g} rad/s"


def _gain(margins: Margins) -> str:
    assert margins.gain is not None
    assert margins.gain_down is not None
    if math.isinf(margins.gain):
        return f"from {margins.gain_down:.4g}"
    decibels = 20.0 * math.log10(margins.gain)
    return f"{margins.gain_down:.4g} .. {margins.gain:.4g}, {decibels:.2f} dB{_at(margins.gain_at)}"


def _phase(margins: Margins) -> str:
    assert margins.phase is not None
    if math.isinf(margins.phase):
        return "the gain never reaches 1"
    return f"{margins.phase:.4g}°{_at(margins.phase_at)}"


def _delay(margins: Margins) -> str:
    assert margins.delay is not None
    return "any" if math.isinf(margins.delay) else time_text(float(f"{margins.delay:.4g}"))


def _sensitivity(margins: Margins) -> str:
    return f"{margins.sensitivity:.4g}{_at(margins.sensitivity_at)}"


_WORDS = {
    "gain": _gain,
    "phase": _phase,
    "dead time": _delay,
    "peak sensitivity": _sensitivity,
}
