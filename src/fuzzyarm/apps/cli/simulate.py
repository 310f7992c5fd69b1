"""Run controllers on a plant, the two-link arm or any other, and report their errors.

CONTROLLER is a name (--list shows all), a controller as text (FILE.frb), your own Python file
(FILE.py or FILE.py:CLASS) with a class derived from fuzzyarm.control.controllers.Controller,
or several of these joined by plus signs. Several controllers make the same run one after
the other. Errors (of angles in degrees) are root mean square, largest magnitude with its
sign, and final, each at the set points. A set point held for several control periods is
sampled in the last of them; beside it are the root mean square over all periods, and that
against the path of the set points. Exit status 3 if a run diverged.

A plant with trajectories, such as the arm, follows one of them, any plant references.
--set changes gains of the controller and parameters of the plant (plant.NAME where both
have a name). With --sweep or --random it is `fuzzyarm sweep`: many runs, a line for each.

Examples
--------
  fuzzyarm simulate servo.frb --plant motor --step 1 --for 2s --noise position=0.001
  fuzzyarm simulate heater.frb --plant mine.py:Kiln --connect temperature=T --csv run.csv
  fuzzyarm simulate rulebases/cartpole.frb --plant cartpole --watch
  fuzzyarm simulate cdid+ie --trajectory pick-and-place --payload
  fuzzyarm simulate pd --angles 60 -30 --segment 1.5 --set K_P=300,200
  fuzzyarm simulate acdid --start cold --payload --conventions study --json
  fuzzyarm simulate fuzzy-direct --rulebase pd7.frb --payload --plot errors.png
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.cli.arguments import request_command, with_choice
from fuzzyarm.apps.cli.command import (
    DIVERGED,
    FORCE,
    UsageError,
    busy,
    demand_figure,
    demand_places,
    group,
    hush,
    print_json,
    progress_bar,
)
from fuzzyarm.apps.cli.sweep import SweepWords, sweep
from fuzzyarm.base.columns import in_columns
from fuzzyarm.requests.fields import Request, option
from fuzzyarm.requests.runs import ManyRuns, SimulateRequest, Workers

if TYPE_CHECKING:
    from fuzzyarm.control.controllers import Controller
    from fuzzyarm.control.loop import Motion, Run
    from fuzzyarm.plant import Conventions, Plant

OUTPUT = "output"


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """Output of the runs."""

    list: bool = option("--list", "list all controllers", False)
    show_gains: bool = option("--show-gains", "print the gains and stop", False, group=OUTPUT)
    plot: str | None = option(
        "--plot FIG", "draw outputs, errors and drives over time", None, group=OUTPUT
    )
    animate: str | None = option(
        "--animate FILE", "write the first run as .gif, .html or .mp4", None, group=OUTPUT
    )
    watch: bool = option(
        "--watch", "show the runs in the terminal, as they go on", False, group=OUTPUT
    )
    csv: str | None = option("--csv FILE", "write the samples", None, group=OUTPUT)
    json: bool = option("--json", "print the result as JSON", False, group=OUTPUT)


@dataclass(frozen=True, kw_only=True)
class SimulateWords(SimulateRequest, ManyRuns, Workers, _Output):
    """All arguments of ``fuzzyarm simulate``."""


# --- The run ---


def _run(request: SimulateWords) -> int:
    if request.list:
        _list(request.json)
        return 0
    if not request.controller:
        print("fuzzyarm simulate: which CONTROLLER? --list shows all", file=sys.stderr)
        return 2
    if request.sweep or request.random is not None:
        return _sweep(request)
    _require_pictures(request)
    from fuzzyarm.control.loop.experiments import controllers_of, with_plant, with_settings

    controllers = controllers_of(request, request.controller)
    if request.show_gains and request.plant is None:
        from fuzzyarm.plant import PLANTS

        # A gain has the same value wherever it is used.
        request = request.replaced(plant=next(iter(PLANTS)))
    request, plant = with_plant(request, controllers)
    controllers, plant = with_settings(request, controllers, plant)
    if request.show_gains:
        for controller, name in zip(controllers, request.controller, strict=True):
            _show_gains(controller, request.json)
            _print_notes(name)
        return 0
    results = [_simulate(controller, plant, request) for controller in controllers]
    for note in dict.fromkeys(note for result in results for note in result.notes):
        print(f"fuzzyarm: note: {note}", file=sys.stderr)
    _write_files(request, results, plant)
    if request.watch:
        _watch(results, plant)
    _print_results(results, as_json=request.json)
    lost = [
        name
        for result, name in zip(results, request.controller, strict=True)
        if result.diverged is not None
    ]
    for name in lost:
        _print_notes(name)
    return DIVERGED if lost else 0


def _print_results(results: Sequence[Run], *, as_json: bool) -> None:
    if not as_json:
        print("\n\n".join(map(_as_text, results)))
        return
    print_json(results if len(results) > 1 else results[0])


def _print_notes(name: str) -> None:
    """Print the restrictions of a controller of the catalogue."""
    from fuzzyarm.control.controllers.catalogue import notes_on

    for note in notes_on(name):
        print(f"fuzzyarm: note: {note}", file=sys.stderr)


def _sweep(request: SimulateWords) -> int:
    if request.given(("csv", "show_gains", "animate", "watch")):
        raise UsageError("--sweep does not take --csv, --animate, --watch or --show-gains")
    first, *others = request.controller
    return sweep(request.as_kind(SweepWords, controller=first, against=others))


def _require_pictures(request: SimulateWords) -> None:
    """Report a mistake in the name of a picture before the run."""
    if request.out or request.resume:
        option = "-o" if request.out else "--resume"
        raise UsageError(
            f"{option} is for a --sweep", hint="--csv FILE writes the samples of a run"
        )
    demand_figure(request.plot)
    demand_places(request.csv, request.animate)
    if request.animate:
        from fuzzyarm.apps.show.figures.animation import require_animation

        require_animation(request.animate)
    if request.watch and request.json:
        raise UsageError(
            "--watch draws on the terminal, where --json prints: leave one of them out"
        )
    if request.watch and not sys.stdout.isatty():
        raise UsageError("--watch needs a terminal", hint="--animate FILE writes an animation")


def _watch(results: list[Run], plant: Plant) -> None:
    """Show runs in the terminal, one after the other; Ctrl-C stops it."""
    from fuzzyarm.apps.show.drawing import make_console
    from fuzzyarm.apps.show.live import play

    hush()
    console = make_console()
    for result in results:
        if result.samples and not play(result, plant, console):
            break


def _write_files(request: SimulateWords, results: list[Run], plant: Plant) -> None:
    if request.plot:
        _plot(results, request.plot)
    if request.animate:
        _animate(results[0], plant, request.animate)
    if request.csv:
        _write_csv(results, request.csv)


def _simulate(controller: Controller, plant: Plant, request: SimulateRequest) -> Run:
    from fuzzyarm.control.loop.run import run_along
    from fuzzyarm.control.loop.simulation import experiment_on
    from fuzzyarm.control.loop.words import connections, conventions_of

    motion, options = experiment_on(request, controller, plant)
    conventions = conventions_of(request)
    with busy(f"running {controller.name}"):
        result = run_along(controller, motion, conventions, options, connections(request))
        slower = _slowdown(result, motion, conventions)
    if slower:
        print(slower, file=sys.stderr)
    return result


def _slowdown(result: Run, motion: Motion, conventions: Conventions) -> str:
    """Return a note on the slowdown of an interpreted run against a compiled one, for laws."""
    from fuzzyarm.control.controllers import controller
    from fuzzyarm.control.controllers.on_plant import lacking, site_of
    from fuzzyarm.control.loop.run import run_along
    from fuzzyarm.symbolic.kernels import has_machine_code

    if result.compiled or not has_machine_code() or lacking(site_of(motion.plants[0])):
        return ""
    pd = controller("pd")
    # The first run loads the machine code, so the second one is timed.
    run_along(pd, motion, conventions)
    compiled = run_along(pd, motion, conventions)
    if compiled.samples != result.samples:
        return ""
    return (
        f"fuzzyarm: {result.controller} ran as plain Python in {result.seconds:.2f} s, "
        f"{result.seconds / compiled.seconds:.0f} times as long as compiled pd"
    )


def _as_text(result: Run) -> str:
    lines = [
        f"{result.controller} on {result.where}, {result.samples} samples, "
        f"{result.conventions.name} conventions, {result.conventions.precision}",
    ]
    if result.samples and result.along:
        lines += _error_lines(result)
    elif result.samples:
        lines += _metric_lines(result)
    lines += result.gaps
    if result.ended is not None:
        lines.append(
            f"ended by the plant at {result.ended:.4f} s; the figures are those until then"
        )
    if result.diverged is not None:
        until = "the figures are those until then" if result.samples else "before the first sample"
        stopped = f"diverged: stopped at {result.diverged:.4f} s with {result.cause}"
        lines.append(f"{stopped}; {until}")
    return "\n".join(lines)


def _error_lines(result: Run) -> list[str]:
    """Return a table of the errors along a trajectory; steps have none."""
    from fuzzyarm.control.loop.run import judged_names

    names, units = [*judged_names(result.axes, result.labels)], dict.fromkeys(result.units)
    if len(units) > 1:
        names = [f"{name}, {unit}" for name, unit in zip(names, result.units, strict=True)]
    head = f"error, {next(iter(units))}" if len(units) == 1 else "error of"
    rows = {"rms": result.rms}
    if result.every > 1:
        rows |= {"  all periods": result.rms_periods, "  path": result.rms_path}
    rows |= {"max": result.maximum, "final": result.final}
    lines = [(label, *(f"{error:.4f}" for error in errors)) for label, errors in rows.items()]
    return in_columns([(head, *names), *lines], "<>", least=(16, 10))


def _metric_lines(result: Run) -> list[str]:
    """Return a table with a column for each tracked output."""
    names = [f"{label}, {unit}" for label, unit in zip(result.labels, result.units, strict=True)]
    columns = [metrics.to_dict() for metrics in result.metrics.values()]
    lines = [("error of", *names)]
    # With a set point in every control period all three are equal.
    between = {"rms_periods": "  all periods", "rms_path": "  path"}
    shown = [name for name in columns[0] if name not in between]
    if result.every > 1:
        # Variants of a metric follow it.
        shown[1:1] = between
    for metric in shown:
        cells = ["-" if column[metric] is None else f"{column[metric]:.4g}" for column in columns]
        lines.append((between.get(metric, metric), *cells))
    return in_columns(lines, "<>", least=(16, 12))


def _plot(results: list[Run], path: str) -> None:
    from fuzzyarm.apps.show.figures.panels import draw_runs
    from fuzzyarm.apps.study.figures import save_figure

    save_figure(draw_runs(results), Path(path))


def _animate(result: Run, plant: Plant, path: str) -> None:
    """Write the animation of a run, with a progress bar on a terminal."""
    from fuzzyarm.apps.show.figures.animation import animate

    with progress_bar("drawing", min(100, result.samples)) as advance:
        animate(result, plant, path, watch=advance)


def _write_csv(results: list[Run], path: str) -> None:
    """Write the samples of a run; of several, with the controller in the first column."""
    from fuzzyarm.base.files import write_atomically
    from fuzzyarm.requests.journal import csv_line

    lines: list[str] = []
    several = len(results) > 1
    for index, result in enumerate(results):
        # One file has the same columns for all runs.
        columns = _csv_columns(result, constant_set_points=any(run.every > 1 for run in results))
        if not index:
            heads = [*["controller"] * several, *columns]
            lines.append(csv_line(heads))
        for row in zip(*columns.values(), strict=True):
            words = [repr(float(value)) for value in row]
            lines.append(csv_line([*[result.controller] * several, *words]))
    write_atomically(path, "".join(lines))


def _csv_columns(result: Run, *, constant_set_points: bool) -> dict[str, Any]:
    """Return the columns of a file by heading, with units."""
    units = {
        **{f"{label} wanted": result.output_units[label] for label in result.wanted},
        **result.output_units,
        **result.drive_units,
    }
    times = {"time [s]": result.time}
    if constant_set_points:
        times["set point time [s]"] = result.set_point_time
    return times | {f"{name} [{units[name]}]": column for name, column in result.columns().items()}


def _show_gains(controller: Controller, as_json: bool) -> None:
    gains = controller.gains
    if as_json:
        print_json({"controller": controller.name, "gains": gains}, ascii_only=False)
        return
    if not gains:
        print(f"{controller.name} has no gains")
        return
    table = [
        (name, _numbers(gain.value), gain.unit, gain.origin, gain.meaning)
        for name, gain in gains.items()
    ]
    print("\n".join(in_columns(table)))


def _numbers(values: tuple[float, ...]) -> str:
    shown = values[:1] if len(set(values)) == 1 else values
    return ", ".join(f"{value:g}" for value in shown)


def _list(as_json: bool) -> None:
    from fuzzyarm.control.controllers import CATALOGUE

    if as_json:
        print_json({entry.name: entry.summary for entry in CATALOGUE.values()})
        return
    rows = []
    for entry in CATALOGUE.values():
        rows.append((entry.name, entry.summary))
        rows += [("", f"note: {entry.note}")] if entry.note else []
    print("\n".join(in_columns(rows)))


COMMANDS = (
    request_command("simulate", with_choice(__doc__), _run, SimulateWords, *group("output", FORCE)),
)
