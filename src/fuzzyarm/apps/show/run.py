"""Runs as charts: outputs with their references, errors, drives with their limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fuzzyarm.base.picture import Axis, Chart, Level, Line, Panel, series

if TYPE_CHECKING:
    from fuzzyarm.control.loop import Run


def run_chart(runs: Sequence[Run], title: str = "") -> Chart:
    """Return runs of one plant, with a column for each tracked output.

    Each column has the output with its reference, the error, and the drives of its axis with
    their limits, over time.
    """
    first = runs[0]
    drives = [_drives_of(runs, axis) for axis in first.axes]
    count = 2 + max(map(len, drives))
    columns = []
    for column, drive_names in enumerate(drives):
        panels = [_output_panel(runs, column), error_panel(runs, column)]
        panels += [drive_panel(runs, drive) for drive in drive_names]
        columns.append([*panels, *[None] * (count - len(panels))])
    rows = [list(row) for row in zip(*columns, strict=True)]
    size = max(6.0, 4.6 * len(columns)), 1.3 + 1.75 * count
    return Chart(
        rows, size, title or f"{first.plant}: {first.trajectory}", key=True, below="time, s"
    )


def summary_panels(run: Run) -> list[Panel]:
    """Return the errors of a run in one panel, and its drives in one panel for each unit."""
    errors = [
        Line(run.time, run.error_matrix[:, column], series(column)[0], label=label)
        for column, label in enumerate(run.labels)
    ]
    panels = [Panel(errors, up=Axis("error", run.units[0]))]
    drives = drives_that_move([run], list(run.drives))
    for unit in dict.fromkeys(run.drive_units[name] for name in drives):
        alike = [name for name in drives if run.drive_units[name] == unit]
        lines = [
            Line(run.time, run.drives[name], series(k)[0], 0.9, label=name)
            for k, name in enumerate(alike)
        ]
        panels.append(Panel(lines, up=Axis(unit)))
    return panels


def drives_that_move(runs: Sequence[Run], names: Sequence[str]) -> list[str]:
    """Return the drives that are nonzero in any run, or the first."""
    return [name for name in names if any(np.any(run.drives[name]) for run in runs)] or [*names[:1]]


def _drives_of(runs: Sequence[Run], axis: str) -> list[str]:
    names = [name for name in runs[0].drives if name.rpartition(".")[0] in ("", axis)]
    return drives_that_move(runs, names)


def _name(run: Run) -> str:
    if run.ended is not None:
        return f"{run.controller}, ended at {run.ended:.3g} s"
    if run.diverged is not None:
        return f"{run.controller}, diverged at {run.diverged:.3g} s"
    return run.controller


def _output_panel(runs: Sequence[Run], column: int) -> Panel:
    first = runs[0]
    lines = [Line(first.time, first.reference[:, column], "ink", 0.9, ":", "reference")]
    for index, run in enumerate(runs):
        output = run.reference[:, column] - run.error_matrix[:, column]
        lines.append(Line(run.time, output, *_look(index, 1.1), _name(run)))
    return Panel(lines, up=Axis(first.labels[column], first.units[column]))


def error_panel(runs: Sequence[Run], column: int) -> Panel:
    """Return the error of an output over time."""
    first = runs[0]
    lines = [
        Line(run.time, run.error_matrix[:, column], *_look(index, 1.0))
        for index, run in enumerate(runs)
    ]
    title = f"error of {first.labels[column]}"
    return Panel([Level(0.0), *lines], up=Axis("error", first.units[column]), name=title)


def drive_panel(runs: Sequence[Run], drive: str) -> Panel:
    """Return a drive over time, with its limits if they are near."""
    reached = max(float(np.abs(run.drives[drive]).max(initial=0.0)) for run in runs)
    # A limit far beyond the values would flatten the curve.
    limits = [
        Level(limit, tone="wanted", width=0.9, dash="--")
        for limit in runs[0].limits[drive]
        if math.isfinite(limit) and abs(limit) <= 4.0 * max(reached, 1e-12)
    ]
    lines = [
        Line(run.time, run.drives[drive], *_look(index, 0.8), steps=True)
        for index, run in enumerate(runs)
    ]
    return Panel([*limits, *lines], up=Axis(drive, runs[0].drive_units[drive]), name=drive)


def _look(index: int, width: float) -> tuple[str, float, str]:
    """Return colour, width and dashes of a run's line."""
    tone, dash = series(index)
    return tone, width, dash
