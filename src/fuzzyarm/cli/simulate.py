"""Run a controller on the two-link arm and report its errors.

CONTROLLER is a name (--list shows all), a controller as text (FILE.frb), a Python file of
yours (FILE.py or FILE.py:CLASS) with a class derived from fuzzyarm.controller.Controller,
or several of these with plus signs between. Errors are degrees: root mean square, largest
magnitude with its sign, and final. Exit status 3 if the run diverged.

Examples
--------
  fuzzyarm simulate cdid+ie --trajectory pick-and-place --payload
  fuzzyarm simulate pd --angles 60 -30 --segment 1.5 --set K_P=300,200
  fuzzyarm simulate acdid --start cold --payload --conventions study --json
  fuzzyarm simulate fuzzy-direct --rulebase pd7.frb --payload --plot errors.png
"""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import replace
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
)

if TYPE_CHECKING:
    from fuzzyarm.controller import Controller, Sources
    from fuzzyarm.loop import Options, Run
    from fuzzyarm.plant import Conventions, Trajectory
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
    arguments: argparse.Namespace, controller: str
) -> tuple[Trajectory, Conventions, Schedule]:
    """Return what the arguments name: the way, the conventions for a controller and the loads."""
    from fuzzyarm.controller.catalogue import study_conventions
    from fuzzyarm.plant import PLAIN, schedule

    trajectory = _trajectory(arguments)
    conventions = study_conventions(controller) if arguments.conventions == "study" else PLAIN
    if arguments.precision:
        conventions = replace(conventions, precision=arguments.precision)
    arms = schedule(
        trajectory, payload=arguments.payload, segments=arguments.loaded, conventions=conventions
    )
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


# --- The arm and its motors, and how set points come: what `compare` says in the same words ---

ARM_OPTIONS = group(
    "conditions",
    flag("--interpolate", "lead the reference in straight lines from set point to set point"),
    argument("--inductance H", "of the arm's motors; 0 by default", type=float),
    argument("--supply V", "largest voltage at the arm's motors", type=float),
    argument("--limits T1 T2", "largest torques of the arm's joints, N m", type=float),
)


def arm_options(arguments: argparse.Namespace) -> Options:
    """Return the conditions that the arguments name."""
    from fuzzyarm.loop import Options

    given: dict[str, Any] = {"interpolate": arguments.interpolate}
    for name in ("inductance", "supply"):
        if getattr(arguments, name) is not None:
            given[name] = getattr(arguments, name)
    if arguments.limits is not None:
        given["torque_limits"] = tuple(arguments.limits)
    return Options(**given)


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
    from fuzzyarm.controller import find_controller

    controller = find_controller(
        arguments.controller,
        start=arguments.start,
        variant=arguments.variant,
        sources=_sources(arguments),
    ).with_gains(overrides(arguments.set))
    if arguments.show_gains:
        _show_gains(controller, arguments.json)
        _print_notes(arguments.controller)
        return 0
    if arguments.plot:
        from fuzzyarm.study.figures import figure_format

        figure_format(arguments.plot)  # a mistake in the name is told before the run
    result = _simulate(controller, arguments)
    if arguments.plot:
        _plot(result, arguments.plot)
    if arguments.json:
        print_json(_as_json(result))
    else:
        print(_as_text(result))
    if result.diverged is None:
        return 0
    _print_notes(arguments.controller)
    return DIVERGED


def _print_notes(name: str) -> None:
    """Say where a controller of the catalogue must not be used."""
    from fuzzyarm.controller.catalogue import notes_on

    for note in notes_on(name):
        print(f"fuzzyarm: note: {note}", file=sys.stderr)


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


def _simulate(controller: Controller, arguments: argparse.Namespace) -> Run:
    from fuzzyarm.loop import simulate

    trajectory, conventions, arms = experiment_of(arguments, arguments.controller)
    with busy(f"running {controller.name}"):
        result = simulate(
            controller,
            trajectory,
            arms=arms,
            conventions=conventions,
            options=_options(arguments),
        )
        slower = _slowdown(result, trajectory, conventions)
    if slower:
        print(slower, file=sys.stderr)
    return result


def _options(arguments: argparse.Namespace) -> Options:
    return replace(arm_options(arguments), runge_kutta=arguments.runge_kutta)


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
        **{name: [_number(value) for value in pair] for name, pair in norms.items()},
        "samples": result.samples,
        "conventions": result.conventions.name,
        "precision": result.conventions.precision,
        "diverged": result.diverged,
        "compiled": result.compiled,
    }


def _number(value: float) -> float | None:
    """Return null for what JSON has no number for: a run without samples has no errors."""
    return float(value) if math.isfinite(value) else None


def _as_text(result: Run) -> str:
    lines = [
        f"{result.controller} on {result.trajectory}, {result.samples} samples, "
        f"{result.conventions.name} conventions, {result.conventions.precision}",
    ]
    if result.samples:
        lines.append(f"{'error, degrees':<16}{'link 1':>12}{'link 2':>12}")
        for name, pair in (("rms", result.rms), ("max", result.maximum), ("final", result.final)):
            lines.append(f"{name:<16}{pair[0]:>12.4f}{pair[1]:>12.4f}")
    if result.diverged is not None:
        until = "the figures are those until then" if result.samples else "before the first sample"
        lines.append(
            f"diverged: stopped at {result.diverged:.4f} s with an error over ten turns or a joint "
            f"over 100000 rad/s; {until}"
        )
    return "\n".join(lines)


def _plot(result: Run, path: str) -> None:
    from fuzzyarm.study.figures import draw_profiles, save_figure

    save_figure(draw_profiles([result], result.controller), Path(path))


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
        argument("controller CONTROLLER", "name, sum or file", nargs="?"),
        flag("--list", "list all controllers"),
        *TRAJECTORY,
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
        *ARM_OPTIONS,
        *group(
            "output",
            flag("--show-gains", "print the gains and stop"),
            argument("--plot FIG", "draw the error profiles"),
            JSON,
        ),
    ),
)
