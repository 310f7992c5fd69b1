"""``fuzzyarm compare`` on a plant other than the arm: the same references for every controller."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.cli.command import WordError, print_json, progress_bar
from fuzzyarm.cli.experiment import DIVERGED
from fuzzyarm.cli.plants import (
    OF_COMPARED,
    OF_OTHERS,
    connections,
    motion_of,
    option_given,
    options_of,
    plant_of,
    require_plain,
)
from fuzzyarm.cli.simulate import run_as_json

if TYPE_CHECKING:
    from fuzzyarm.controller import Controller
    from fuzzyarm.loop import Run
    from fuzzyarm.plant import Plant

SHOWN = ("rms", "max", "overshoot", "settling", "effort", "chatter")
"""Metrics of a run that the table has."""


def other_plant(
    arguments: argparse.Namespace, names: Sequence[str]
) -> tuple[list[Controller], Plant] | None:
    """Return the controllers and the plant that is meant, or None where it is the arm."""
    from fuzzyarm.controller.own import find_controllers
    from fuzzyarm.plant import Arm

    controllers = find_controllers(names)
    plant = plant_of(arguments, controllers)
    if isinstance(plant, Arm):
        option = option_given(arguments, OF_OTHERS)
        if option is not None:
            message = f"{option} is for other plants; the arm runs along its trajectories"
            raise WordError(message)
        return None
    require_plain(arguments, payload=True, others=OF_COMPARED)
    return controllers, plant


def compare_on(
    arguments: argparse.Namespace, controllers: Sequence[Controller], plant: Plant
) -> int:
    """Run controllers on a plant, and print what came of them."""
    from fuzzyarm.loop.run import run_along
    from fuzzyarm.plant import PLAIN

    connect, options = connections(arguments), options_of(arguments, plant)
    runs: list[Run] = []
    with progress_bar("controllers", len(controllers)) as bar:
        for controller in controllers:
            motion = motion_of(arguments, controller, plant)
            runs.append(run_along(controller, motion, PLAIN, options, connect))
            bar(1)
    if arguments.plot:
        from fuzzyarm.show.figures.run import draw_runs
        from fuzzyarm.study.figures import save_figure

        save_figure(draw_runs(runs), Path(arguments.plot))
    if arguments.json:
        print_json([run_as_json(run) for run in runs], 1)
    elif arguments.markdown:
        print("\n".join(_markdown(runs)))
    else:
        print("\n".join(_lines(runs)))
    return DIVERGED if all(run.diverged is not None for run in runs) else 0


def _rows(runs: Sequence[Run]) -> Iterator[list[str]]:
    """Yield a row for each controller and tracked output, the heads first."""
    several = len(runs[0].labels) > 1
    unit = dict(zip(runs[0].labels, runs[0].units, strict=True))
    yield ["controller", "error of", *SHOWN]
    for run in runs:
        for (name, metrics), label in zip(run.metrics.items(), run.labels, strict=True):
            cells = metrics.as_dict()
            numbers = ["-" if cells[each] is None else f"{cells[each]:.4g}" for each in SHOWN]
            if run.diverged is not None:
                numbers = [f"diverged at {run.diverged:.4g} s", *[""] * (len(SHOWN) - 1)]
            yield [run.controller, f"{name if several else label}, {unit[label]}", *numbers]


def _lines(runs: Sequence[Run]) -> Iterator[str]:
    yield f"{runs[0].plant}, {runs[0].trajectory}"
    rows = list(_rows(runs))
    widths = [max(len(row[column]) for row in rows) for column in range(2)]
    for row in rows:
        first = [f"{cell:<{width}}" for cell, width in zip(row, widths, strict=False)]
        yield "  ".join([*first, *(f"{cell:>10}" for cell in row[2:])]).rstrip()


def _markdown(runs: Sequence[Run]) -> Iterator[str]:
    heads, *rows = _rows(runs)
    yield f"| {' | '.join(heads)} |"
    yield "|---" * len(heads) + "|"
    for row in rows:
        yield f"| {' | '.join(row)} |"
