"""A tube of a loop, port by port over time, with runs in it and what is claimed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.picture import COLOURS
from fuzzyarm.show.figures.style import head, label_axes, new_figure, safe, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fuzzyarm.closed_loop.tube import Tube
    from fuzzyarm.model.claims import LoopClaim

__all__ = ["tube_figure"]

RUNS = 40


def tube_figure(way: Tube, title: str, claim: LoopClaim | None = None) -> Figure:
    """Return the outputs of a plant over time: the tube, and runs from corners and from within.

    Parameters
    ----------
    way : Tube
        One that holds all starts.
    title : str
        Above the figure.
    claim : LoopClaim, optional
        What is claimed, drawn as a border.
    """
    from fuzzyarm.closed_loop.claims import claimed_port
    from fuzzyarm.closed_loop.runs import sampled_runs

    interface = way.problem.site.interface
    outputs = list(way.ports[: len(interface.outputs)])
    figure = new_figure(7.0, 1.4 + 1.7 * len(outputs))
    rows = figure.subplots(len(outputs), 1, sharex=True, squeeze=False)[:, 0]
    runs = sampled_runs(way.problem, way.duration, RUNS)
    port = claimed_port(way.problem, claim) if claim is not None and claim.output else ""
    for axes, name, unit in zip(
        rows, outputs, (output.unit for output in interface.outputs.values()), strict=True
    ):
        _draw(axes, way, name)
        for k, run in enumerate(runs):
            axes.plot(
                run.time, run.outputs[name], color="#333333", linewidth=0.5, alpha=0.7,
                label="runs" if not k else None,
            )  # fmt: skip
        if claim is not None and name == port:
            _draw_claim(axes, way, claim)
        tidy(axes)
        label_axes(axes, "s" if name == outputs[-1] else "", safe(f"{name}, {unit}"))
    lines, words = max((axes.get_legend_handles_labels() for axes in rows), key=lambda x: len(x[0]))
    figure.legend(lines, words, loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    head(figure, safe(title))
    return figure


def _draw(axes: Axes, way: Tube, name: str) -> None:
    """Draw between what a port is in each period."""
    column = way.ports.index(name)
    times = np.column_stack([way.begins, way.ends]).ravel()
    axes.fill_between(
        times, np.repeat(way.low[:, column], 2), np.repeat(way.high[:, column], 2),
        color=COLOURS[0], alpha=0.3, linewidth=0, label="tube: all runs",
    )  # fmt: skip


def _draw_claim(axes: Axes, way: Tube, claim: LoopClaim) -> None:
    """Draw the ends of the claimed interval in the claimed time."""
    end = min(claim.end, way.duration)
    for k, value in enumerate((claim.low, claim.high)):
        if math.isfinite(value) and claim.begin < end:
            axes.plot(
                [claim.begin, end], [value, value], color=COLOURS[3], linewidth=1.2,
                label="claimed" if not k else None,
            )  # fmt: skip
