"""A tube of a loop, port by port over time, with runs in it and the claim."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.base.picture import COLOURS, Axis, Band, Chart, ChartPart, Line, Panel

if TYPE_CHECKING:
    from fuzzyarm.language.model.claims import LoopClaim
    from fuzzyarm.proof.loop.tube import Tube

RUNS = 40


def tube_chart(way: Tube, title: str, claim: LoopClaim | None = None) -> Chart:
    """Return outputs and errors of a loop over time: the tube, with runs from its starts."""
    from fuzzyarm.proof.claim.text import claimed_port
    from fuzzyarm.proof.loop.runs import sampled_runs, values_of

    interface = way.problem.site.interface
    count = len(interface.outputs)
    outputs = [*way.ports[:count], *way.ports[count + len(interface.inputs) :]]
    ports = [*interface.outputs.values(), *(interface.outputs[a] for a in way.problem.errors)]
    runs = sampled_runs(way.problem, way.duration, RUNS)
    values = [values_of(way.problem, run) for run in runs]
    port = claimed_port(way.problem, claim) if claim is not None and claim.output else ""
    rows: list[list[Panel | None]] = []
    for name, output in zip(outputs, ports, strict=True):
        parts: list[ChartPart] = [_tube(way, name)]
        parts += [
            Line(run.time, values[k][name], "ink", 0.5, label="" if k else "runs", opacity=0.7)
            for k, run in enumerate(runs)
        ]
        if claim is not None and name == port:
            parts += _claimed(way, claim)
        rows.append([Panel(parts, up=Axis(name, output.unit))])
    size = 7.0, 1.4 + 1.7 * len(outputs)
    return Chart(rows, size, title, key=True, below="time, s", heading=True)


def _tube(way: Tube, name: str) -> Band:
    """Return the area between the bounds of a port in each period."""
    column = way.ports.index(name)
    times = np.column_stack([way.begins, way.ends]).ravel()
    low, high = (np.repeat(bounds[:, column], 2) for bounds in (way.low, way.high))
    return Band(times, low, high, COLOURS[0], 0.3, "tube: all runs")


def _claimed(way: Tube, claim: LoopClaim) -> list[Line]:
    """Return the ends of the claimed interval over the claimed time."""
    end = min(claim.end, way.duration)
    if not claim.begin < end:
        return []
    ends = [value for value in (claim.low, claim.high) if math.isfinite(value)]
    return [
        Line((claim.begin, end), (value, value), COLOURS[3], 1.2, label="" if k else "claimed")
        for k, value in enumerate(ends)
    ]
