"""Stability margins of a loop: gain, phase and delay margin, and peak sensitivity.

The sampled loop is linearised at its rest, with sensors, delays, memory and hold, and opened at
each drive in turn with the others closed. The gain margin is the factor on the loop gain, up and
down, at which it becomes unstable; the delay margin is the same for dead time of the actuator,
fractions of a period included.

A rule base has a single gain at rest only. Its gain over the ranges of its inputs (or over --share
of them) has proved bounds; the worst margins found among those gains are printed as well.

Exit status 3 if the loop at rest is not stable. --plot draws Bode and Nyquist diagrams.

  fuzzyarm margins rulebases/servo.frb --plant motor
  fuzzyarm margins rulebases/heater.frb --plant room --at temperature=21 --plot margins.png
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyarm.apps.cli.arguments import request_command
from fuzzyarm.apps.cli.command import FORCE, busy, demand_figure, print_json, say
from fuzzyarm.base.columns import in_columns
from fuzzyarm.requests.fields import option
from fuzzyarm.requests.margins import MarginsRequest

if TYPE_CHECKING:
    from fuzzyarm.proof.loop.margins import DriveMargins, Margins, WorstMargins

EXIT_UNSTABLE = 3


@dataclass(frozen=True, kw_only=True)
class MarginsWords(MarginsRequest):
    """All arguments of ``fuzzyarm margins``."""

    plot: str | None = option("--plot FIG", "draw Bode and Nyquist as .png, .svg or .pdf", None)
    json: bool = option("--json", "print the margins as JSON", False)


def _run(request: MarginsWords) -> int:
    demand_figure(request.plot)
    from fuzzyarm.proof.loop.orders import margins_of_request

    with busy(f"margins of {request.file}"):
        found = margins_of_request(request)
    if request.json:
        print_json(found)
    else:
        say(*(line for each in found for line in lines(each)))
    if request.plot:
        from fuzzyarm.apps.show.figures.panels import chart_figure
        from fuzzyarm.apps.show.margins import margins_chart
        from fuzzyarm.base.figure_files import save_figure

        save_figure(chart_figure(margins_chart(found, request.file)), request.plot)
    return 0 if all(each.nominal.stable for each in found) else EXIT_UNSTABLE


def lines(each: DriveMargins) -> list[str]:
    """Return the margins at a drive in words."""
    nominal, worst = each.nominal, each.worst
    head = f"opened at '{each.drive[1]}'"
    if not nominal.stable:
        return [f"{head}: not stable, the spectral radius is {each.loop.radius:.6g}"]
    beside = worst.margins if worst is not None and worst.margins.stable else None
    rows = [("", "at rest", "worst over the gains of the rules" if beside else "")]
    for name, words in _WORDS.items():
        rows.append((name, words(nominal), words(beside) if beside else ""))
    return [head, *in_columns(rows, indent="  "), *_gain_lines(worst)]


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
    from fuzzyarm.apps.show.diagram import time_text

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

COMMANDS = (request_command("margins", __doc__, _run, MarginsWords, FORCE),)
"""One command."""
