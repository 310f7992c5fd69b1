"""Stability margins of a loop: gain, phase and delay margin, and peak sensitivity.

The sampled loop is linearised at its rest, with sensors (but their steps), delays, memory and hold,
and opened at each drive in turn with the others closed. The gain margin is the factor on the loop
gain, up and down, at which it becomes unstable; the delay margin is the same for dead time of the
actuator, fractions of a period included.

A rule base has a single gain at rest only. Its gain over the ranges of its inputs (or over --share
of them) has proved bounds; the worst margins found among those gains are printed as well.

Exit status 3 if the loop at rest is not stable. --plot draws Bode and Nyquist diagrams.

  fuzzyarm margins rulebases/servo.frb --plant motor
  fuzzyarm margins rulebases/heater.frb --plant room --at temperature=21 --plot margins.png
"""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.apps.cli.arguments import request_command
from fuzzyarm.apps.cli.command import FORCE, busy, demand_figure, print_json, say
from fuzzyarm.requests.fields import option
from fuzzyarm.requests.margins import MarginsRequest

EXIT_UNSTABLE = 3


@dataclass(frozen=True, kw_only=True)
class MarginsWords(MarginsRequest):
    """All arguments of ``fuzzyarm margins``."""

    plot: str | None = option("--plot FIG", "draw Bode and Nyquist as .png, .svg or .pdf", None)
    json: bool = option("--json", "print the margins as JSON", False)


def _run(request: MarginsWords) -> int:
    demand_figure(request.plot)
    from fuzzyarm.apps.show.margins import margin_lines, margins_chart
    from fuzzyarm.proof.loop.orders import margins_of_request

    with busy(f"margins of {request.file}"):
        found = margins_of_request(request)
    if request.json:
        print_json(found)
    else:
        say(*(line for each in found for line in margin_lines(each)))
    if request.plot:
        from fuzzyarm.apps.show.figures.panels import chart_figure
        from fuzzyarm.base.figure_files import save_figure

        save_figure(chart_figure(margins_chart(found, request.file)), request.plot)
    return 0 if all(each.nominal.stable for each in found) else EXIT_UNSTABLE


COMMANDS = (request_command("margins", __doc__, _run, MarginsWords, FORCE),)
"""One command."""
