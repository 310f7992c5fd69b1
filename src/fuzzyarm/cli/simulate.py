"""Run controllers on the two-link arm, or on any plant, and report their errors.

CONTROLLER is a name (--list shows all), a controller as text (FILE.frb), a Python file of
yours (FILE.py or FILE.py:CLASS) with a class derived from fuzzyarm.controller.Controller,
or several of these with plus signs between. Several controllers make the same run one after
the other. Errors (of angles in degrees) are root mean square, largest magnitude with its
sign, and final. Exit status 3 if a run diverged.

The arm follows a trajectory; any other plant runs a controller as text along references.
--set changes gains of the controller and parameters of the plant (plant.NAME where both
have a name).

Examples
--------
  fuzzyarm simulate cdid+ie --trajectory pick-and-place --payload
  fuzzyarm simulate pd --angles 60 -30 --segment 1.5 --set K_P=300,200
  fuzzyarm simulate acdid --start cold --payload --conventions study --json
  fuzzyarm simulate fuzzy-direct --rulebase pd7.frb --payload --plot errors.png
  fuzzyarm simulate servo.frb --plant motor --step 1 --for 2s --noise position=0.001
  fuzzyarm simulate heater.frb --plant mine.py:Kiln --connect temperature=T --csv run.csv
"""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.command import (
    JSON,
    SET,
    WordError,
    argument,
    busy,
    command,
    flag,
    group,
    load_rulebase,
    load_table,
    print_json,
    progress_bar,
)
from fuzzyarm.cli.plants import (
    MOTORS,
    PLANT,
    connections,
    motion_of,
    options_of,
    plant_of,
    require_plain,
    split_settings,
)

if TYPE_CHECKING:
    from fuzzyarm.controller import Controller, Sources
    from fuzzyarm.loop import Run
    from fuzzyarm.plant import Conventions, Plant, Trajectory
    from fuzzyarm.plant.trajectory import Schedule
    from fuzzyarm.table import LookupTable


# --- What `learn` says in the same words: trajectory, load, conventions and tables ---

TRAJECTORY = (
    *group(
        "trajectory",
        argument(
            "--trajectory",
            choices=["reach", "reach-return", "pick-and-place"],
            default="reach-return",
        ),
        argument("--angles A1 A2", "where to turn to, degrees", type=float, either="where"),
        argument("--segment SECONDS", "duration of each segment but the hold", type=float),
        argument("--hold SECONDS", "duration of the hold, 5 by default", type=float),
        argument(
            "--way-points A1,A2", "move through these, degrees, instead", nargs="+", either="where"
        ),
    ),
    *group(
        "load",
        argument("--payload", action=argparse.BooleanOptionalAction, default=False),
        argument("--loaded N", "carry the load in these segments", nargs="+", type=int),
    ),
)
CONVENTIONS = (
    argument("--conventions", choices=["plain", "study"], default="plain"),
    argument("--precision", choices=["float32", "float64"]),
)


def experiment_of(
    arguments: argparse.Namespace, controller: str, plant: Plant | None = None
) -> tuple[Trajectory, Conventions, Schedule]:
    """Return what the arguments name: the way, the conventions for a controller and the loads.

    Parameters of the arm that differ from the study's are its parameters with a load, too, but
    for those that the load changes.
    """
    from fuzzyarm.controller.catalogue import study_conventions
    from fuzzyarm.plant import PLAIN, UNLOADED, Arm, ArmParameters, schedule

    trajectory = _trajectory(arguments)
    conventions = study_conventions(controller) if arguments.conventions == "study" else PLAIN
    if arguments.precision:
        conventions = replace(conventions, precision=arguments.precision)
    for option in ("step", "reference", "duration"):
        if getattr(arguments, option, None):
            word = "for" if option == "duration" else option
            raise WordError(f"--{word} is of other plants; the arm follows --trajectory")
    arms = schedule(
        trajectory, payload=arguments.payload, segments=arguments.loaded, conventions=conventions
    )
    if isinstance(plant, Arm):
        own = plant.arm
        changed = {
            each.name: getattr(own, each.name)
            for each in fields(ArmParameters)
            if getattr(own, each.name) != getattr(UNLOADED, each.name)
        }
        arms = tuple(replace(arm, **changed) for arm in arms)
    return trajectory, conventions, arms


def _trajectory(arguments: argparse.Namespace) -> Trajectory:
    from fuzzyarm.plant import ArmError, pick_and_place, reach, reach_return, through

    given: dict[str, Any] = {}
    if arguments.segment is not None:
        given["segment"] = arguments.segment
    if arguments.hold is not None:
        given["hold"] = arguments.hold
    if arguments.way_points:
        return through([_pair(text) for text in arguments.way_points], **given)
    if arguments.angles is not None:
        given["angles"] = tuple(arguments.angles)
    if arguments.trajectory == "pick-and-place":
        if "hold" in given:
            raise ArmError("pick-and-place has no hold", name="hold", value=arguments.hold)
        return pick_and_place(**given)
    return (reach if arguments.trajectory == "reach" else reach_return)(**given)


def _pair(text: str) -> tuple[float, float]:
    from fuzzyarm.plant import ArmError

    try:
        first, second = (float(part) for part in text.split(","))
    except ValueError:
        message = f"way point '{text}' is not two angles"
        raise ArmError(message, name="way_points", value=text, hint="as in 45,-30") from None
    return first, second


def read_control_table(paths: list[str], option: str) -> tuple[LookupTable, ...]:
    """Return the table in one file, or the tables of both joints in two.

    A rule base is compiled at the levels of its file.
    """
    if len(paths) > 2:
        raise WordError(f"{option} takes one file, or one for each of the two joints")
    return tuple(load_table(path) for path in paths)


def read_performance(word: str) -> LookupTable:
    """Return a performance table: of a file, or a shipped one by its author."""
    from fuzzyarm.shipped_files import shipped, shipped_names

    name = f"performance-{word}.lut"
    known = not Path(word).exists() and name in shipped_names()
    return load_table(str(shipped(name)) if known else word)


# --- The run ---

DIVERGED = 3
"""Exit status where the arm was lost: the figures are those until then."""


def _run(arguments: argparse.Namespace) -> int:
    if arguments.list:
        _list(arguments.json)
        return 0
    if not arguments.controller:
        print("fuzzyarm simulate: which CONTROLLER? --list shows all", file=sys.stderr)
        return 2
    _require_pictures(arguments)
    plant = plant_of(arguments)
    made = [_controller(arguments, name, plant) for name in arguments.controller]
    if arguments.show_gains:
        for (controller, _), name in zip(made, arguments.controller, strict=True):
            _show_gains(controller, arguments.json)
            _print_notes(name)
        return 0
    results = [
        _simulate(controller, changed, name, arguments)
        for (controller, changed), name in zip(made, arguments.controller, strict=True)
    ]
    _write_files(arguments, results, made[0][1])
    if arguments.json:
        shown = [_as_json(result) for result in results]
        print_json(shown if len(shown) > 1 else shown[0])
    else:
        print("\n\n".join(map(_as_text, results)))
    lost = [
        name
        for result, name in zip(results, arguments.controller, strict=True)
        if result.diverged is not None
    ]
    for name in lost:
        _print_notes(name)
    return DIVERGED if lost else 0


def _print_notes(name: str) -> None:
    """Say where a controller of the catalogue must not be used."""
    from fuzzyarm.controller.catalogue import notes_on

    for note in notes_on(name):
        print(f"fuzzyarm: note: {note}", file=sys.stderr)


def _require_pictures(arguments: argparse.Namespace) -> None:
    """Tell a mistake in the name of a picture before the run."""
    if arguments.plot:
        from fuzzyarm.study.figures import figure_format

        figure_format(arguments.plot)
    if arguments.animate:
        from fuzzyarm.show.figures.animation import require_animation

        require_animation(arguments.animate)


def _write_files(arguments: argparse.Namespace, results: list[Run], plant: Plant) -> None:
    if arguments.plot:
        _plot(results, arguments.plot)
    if arguments.animate:
        _animate(results[0], plant, arguments.animate)
    if arguments.csv:
        _write_csv(results, arguments.csv)


def _controller(arguments: argparse.Namespace, name: str, plant: Plant) -> tuple[Controller, Plant]:
    """Return a controller with its gains set, and the plant with its parameters."""
    from fuzzyarm.controller import find_controller
    from fuzzyarm.plant.plant import with_parameters

    found = find_controller(
        name, start=arguments.start, variant=arguments.variant, sources=_sources(arguments)
    )
    gains, parameters = split_settings(overrides(arguments.set), found, plant)
    return found.with_gains(gains), with_parameters(plant, parameters) if parameters else plant


def _sources(arguments: argparse.Namespace) -> Sources:
    """Return the rule bases and tables that the arguments name."""
    from fuzzyarm.controller import Sources

    rulebase, alpha, performance = arguments.rulebase, arguments.alpha, arguments.performance
    return Sources(
        load_rulebase(rulebase, "--rulebase") if rulebase else None,
        load_rulebase(alpha, "--alpha") if alpha else None,
        read_control_table(arguments.table, "--table") if arguments.table else None,
        read_performance(performance) if performance else None,
    )


def _simulate(
    controller: Controller, plant: Plant, name: str, arguments: argparse.Namespace
) -> Run:
    from fuzzyarm.loop.run import run_along
    from fuzzyarm.plant import PLAIN, Arm

    connect, options = connections(arguments), options_of(arguments, plant)
    if isinstance(plant, Arm):
        trajectory, conventions, arms = experiment_of(arguments, name, plant)
        on: Any = trajectory
    else:
        require_plain(arguments)
        conventions, arms = PLAIN, None
        on = motion_of(arguments, controller, plant, connect)
    with busy(f"running {controller.name}"):
        if arms is None:
            return run_along(controller, on, conventions, options, connect)
        from fuzzyarm.loop import simulate

        result = simulate(
            controller, on, arms=arms, conventions=conventions, options=options, connect=connect
        )
        slower = _slowdown(result, on, conventions)
    if slower:
        print(slower, file=sys.stderr)
    return result


def overrides(words: list[str]) -> dict[str, list[float]]:
    """Return the gains that words like ``K_P=120,80`` set."""
    from fuzzyarm.controller import GainError

    values = {}
    for word in words:
        name, equals, text = word.partition("=")
        try:
            values[name.strip()] = [float(part) for part in text.split(",")]
        except ValueError:
            hint = "as in K_P=120 or K_P=120,80"
            message = f"'{word}' does not set a gain"
            raise GainError(message, name=name, value=text, hint=hint) from None
        if not equals:
            raise GainError(f"'{word}' does not set a gain", name=name, hint="as in K_P=120")
    return values


def _slowdown(result: Run, trajectory: Trajectory, conventions: Conventions) -> str:
    """Say how much longer an interpreted run took than a compiled one of the same length."""
    from fuzzyarm.controller import controller
    from fuzzyarm.kernels import jit_wanted
    from fuzzyarm.loop import simulate

    if result.compiled or not jit_wanted():
        return ""
    pd = controller("pd")
    simulate(pd, trajectory, conventions=conventions)
    compiled = simulate(pd, trajectory, conventions=conventions)
    if compiled.samples != result.samples:
        return ""
    return (
        f"fuzzyarm: {result.controller} ran as plain Python in {result.seconds:.2f} s, "
        f"{result.seconds / compiled.seconds:.0f} times as long as compiled pd"
    )


def _as_json(result: Run) -> dict[str, Any]:
    norms = {"rms": result.rms, "max": result.maximum, "final": result.final}
    return {
        "controller": result.controller,
        "trajectory": result.trajectory,
        **{name: [_number(value) for value in values] for name, values in norms.items()},
        "samples": result.samples,
        "conventions": result.conventions.name,
        "precision": result.conventions.precision,
        "diverged": result.diverged,
        "ended": result.ended,
        "compiled": result.compiled,
        "plant": result.plant,
        "outputs": dict(zip(result.labels, result.units, strict=True)),
        "metrics": {name: each.as_dict() for name, each in result.metrics.items()},
        "seed": result.seed,
    }


def _number(value: float) -> float | None:
    """Return null for what JSON has no number for: a run without samples has no errors."""
    return float(value) if math.isfinite(value) else None


def _as_text(result: Run) -> str:
    on = result.trajectory if result.plant == "arm" else f"{result.plant}, {result.trajectory}"
    lines = [
        f"{result.controller} on {on}, {result.samples} samples, "
        f"{result.conventions.name} conventions, {result.conventions.precision}",
    ]
    if result.samples and result.plant == "arm":
        lines.append(f"{'error, degrees':<16}{'link 1':>12}{'link 2':>12}")
        for name, pair in (("rms", result.rms), ("max", result.maximum), ("final", result.final)):
            lines.append(f"{name:<16}{pair[0]:>12.4f}{pair[1]:>12.4f}")
    elif result.samples:
        lines += _metric_lines(result)
    if result.ended is not None:
        lines.append(
            f"ended by the plant at {result.ended:.4f} s; the figures are those until then"
        )
    if result.diverged is not None:
        until = "the figures are those until then" if result.samples else "before the first sample"
        bound = "an output beyond its bound"
        if result.plant == "arm":
            bound = "an error over ten turns or a joint over 100000 rad/s"
        lines.append(f"diverged: stopped at {result.diverged:.4f} s with {bound}; {until}")
    return "\n".join(lines)


def _metric_lines(result: Run) -> list[str]:
    """Return a table with a column for each tracked output."""
    names = [f"{label}, {unit}" for label, unit in zip(result.labels, result.units, strict=True)]
    columns = [each.as_dict() for each in result.metrics.values()]
    widths = [max(14, len(name) + 2) for name in names]
    lines = ["error of".ljust(16) + "".join(map(str.rjust, names, widths))]
    for metric in columns[0]:
        cells = ["-" if each[metric] is None else f"{each[metric]:.4g}" for each in columns]
        lines.append(metric.ljust(16) + "".join(map(str.rjust, cells, widths)))
    return lines


def _plot(results: list[Run], path: str) -> None:
    from fuzzyarm.show.figures.run import draw_runs
    from fuzzyarm.study.figures import save_figure

    save_figure(draw_runs(results), Path(path))


def _animate(result: Run, plant: Plant, path: str) -> None:
    """Write the animation of a run, with a progress bar where a terminal shows it."""
    from fuzzyarm.show.figures.animation import animate

    with progress_bar("drawing", min(100, result.samples)) as advance:
        animate(result, plant, path, watch=advance)


def _write_csv(results: list[Run], path: str) -> None:
    """Write the samples of one run; of several, a file with the controller in the first column."""
    import io

    from fuzzyarm.text.files import write_atomically

    text = io.StringIO()
    several = len(results) > 1
    for index, result in enumerate(results):
        columns = {"time": result.time, **result.columns()}
        if not index:
            text.write(",".join([*["controller"] * several, *columns]) + "\n")
        for row in zip(*columns.values(), strict=True):
            words = [repr(float(value)) for value in row]
            text.write(",".join([*[result.controller] * several, *words]) + "\n")
    write_atomically(path, text.getvalue())


def _show_gains(controller: Controller, as_json: bool) -> None:
    gains = controller.gains
    if as_json:
        rows = {
            name: {
                "value": list(gain.value),
                "unit": gain.unit,
                "origin": gain.origin,
                "meaning": gain.meaning,
            }
            for name, gain in gains.items()
        }
        print_json({"controller": controller.name, "gains": rows}, ascii_only=False)
        return
    if not gains:
        print(f"{controller.name} has no gains")
        return
    table = [
        (name, _numbers(gain.value), gain.unit, gain.origin, gain.meaning)
        for name, gain in gains.items()
    ]
    widths = [max(len(row[column]) for row in table) for column in range(4)]
    for row in table:
        cells = [f"{cell:<{width}}" for cell, width in zip(row, widths, strict=False)]
        print("  ".join([*cells, row[4]]))


def _numbers(values: tuple[float, ...]) -> str:
    shown = values[:1] if len(set(values)) == 1 else values
    return ", ".join(f"{value:g}" for value in shown)


def _list(as_json: bool) -> None:
    from fuzzyarm.controller import CATALOGUE

    if as_json:
        print_json({entry.name: entry.summary for entry in CATALOGUE.values()})
        return
    width = max(map(len, CATALOGUE))
    for entry in CATALOGUE.values():
        print(f"{entry.name:<{width}}  {entry.summary}")
        if entry.note:
            print(f"{'':<{width}}  note: {entry.note}")


COMMANDS = (
    command(
        "simulate",
        __doc__,
        _run,
        argument("controller CONTROLLER", "name, sum or file; or several", nargs="*"),
        flag("--list", "list all controllers"),
        *TRAJECTORY,
        *PLANT,
        *group(
            "files of fuzzy controllers, in place of the shipped ones",
            argument("--rulebase FILE", "rules of the control"),
            argument("--alpha FILE", "rules of the factor on the control"),
            argument("--table FILE", "table of the control, or one for each joint", nargs="+"),
            argument("--performance FILE", "table by which SOC judges"),
        ),
        *group(
            "run",
            *CONVENTIONS,
            argument("--start", "adaptive ones", choices=["warm", "cold"], default="warm"),
            argument(
                "--variant",
                "by the study's figures or by its text, where they disagree",
                choices=["as-printed", "as-described"],
                default="as-printed",
            ),
            SET,
            argument("--runge-kutta N", "N fine steps in a control period", type=int, default=0),
        ),
        *MOTORS,
        *group(
            "output",
            flag("--show-gains", "print the gains and stop"),
            argument("--plot FIG", "draw outputs, errors and drives over time"),
            argument("--animate FILE", "write the first run as .gif, .html or .mp4"),
            argument("--csv FILE", "write the samples"),
            JSON,
        ),
    ),
)
