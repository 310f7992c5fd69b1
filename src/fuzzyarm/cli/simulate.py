"""Run a controller on the two-link arm and report its errors.

CONTROLLER is a name (--list shows all), several names with plus signs between, or a
Python file of yours (FILE.py or FILE.py:CLASS) with a class derived from
fuzzyarm.controller.Controller. Errors are degrees: root mean square, largest magnitude
with its sign, and final.

Examples
--------
  fuzzyarm simulate cdid+ie --trajectory pick-and-place --payload
  fuzzyarm simulate pd --angles 60 -30 --segment 1.5 --set K_P=300,200
  fuzzyarm simulate acdid --start cold --payload --conventions study --json
  fuzzyarm simulate fuzzy-direct --rulebase pd7.frb --payload --plot errors.png
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.arguments import (
    add_conventions,
    add_trajectory,
    conventions_of,
    sources_of,
    trajectory_of,
)

if TYPE_CHECKING:
    from fuzzyarm.controller import Controller
    from fuzzyarm.loop import Options, Run
    from fuzzyarm.plant import Conventions, Trajectory


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm simulate``."""
    parser.add_argument("controller", nargs="?", metavar="CONTROLLER", help="name, sum or file")
    parser.add_argument("--list", action="store_true", help="list all controllers")
    add_trajectory(parser)
    files = parser.add_argument_group("files of fuzzy controllers, in place of the shipped ones")
    files.add_argument("--rulebase", metavar="FILE", help="rules of the control")
    files.add_argument("--alpha", metavar="FILE", help="rules of the factor on the control")
    files.add_argument(
        "--table", nargs="+", metavar="FILE", help="table of the control, or one for each joint"
    )
    files.add_argument("--performance", metavar="FILE", help="table by which SOC judges")
    run = parser.add_argument_group("run")
    add_conventions(run)
    run.add_argument("--start", choices=["warm", "cold"], default="warm", help="adaptive ones")
    run.add_argument(
        "--variant",
        choices=["as-printed", "as-described"],
        default="as-printed",
        help="by the study's figures or by its text, where they disagree",
    )
    run.add_argument(
        "--set", action="append", default=[], metavar="GAIN=V[,V]", help="override a gain"
    )
    run.add_argument("--limits", nargs=2, type=float, metavar=("T1", "T2"), help="torque, N m")
    run.add_argument(
        "--runge-kutta", type=int, default=0, metavar="N", help="N fine steps in a control period"
    )
    out = parser.add_argument_group("output")
    out.add_argument("--show-gains", action="store_true", help="print the gains and stop")
    out.add_argument("--plot", metavar="FIG", help="draw the error profiles")
    out.add_argument("--json", action="store_true")


def run(arguments: argparse.Namespace) -> int:
    """Run ``fuzzyarm simulate``."""
    if arguments.list:
        return _list(arguments.json)
    if not arguments.controller:
        print("fuzzyarm simulate: which CONTROLLER? --list shows all", file=sys.stderr)
        return 2
    from fuzzyarm.controller import find_controller

    controller = find_controller(
        arguments.controller,
        start=arguments.start,
        variant=arguments.variant,
        sources=sources_of(arguments),
    ).with_gains(overrides(arguments.set))
    if arguments.show_gains:
        _show_gains(controller, arguments.json)
        return 0
    if arguments.plot:
        from fuzzyarm.study.figures import figure_format

        figure_format(arguments.plot)  # a mistake in the name is told before the run
    result = _simulate(controller, arguments)
    if arguments.plot:
        _plot(result, arguments.plot)
    print(json.dumps(_as_json(result)) if arguments.json else _as_text(result))
    return 0


def _simulate(controller: Controller, arguments: argparse.Namespace) -> Run:
    from fuzzyarm.loop import simulate
    from fuzzyarm.plant import schedule

    trajectory = trajectory_of(arguments)
    conventions = conventions_of(arguments, arguments.controller)
    arms = schedule(
        trajectory,
        payload=arguments.payload,
        segments=arguments.loaded,
        conventions=conventions,
    )
    with _busy(f"running {controller.name}"):
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
    from fuzzyarm.loop import Options

    given: dict[str, Any] = {"runge_kutta": arguments.runge_kutta}
    if arguments.limits is not None:
        given["torque_limits"] = tuple(arguments.limits)
    return Options(**given)


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


def _busy(message: str) -> Any:
    if not sys.stderr.isatty():
        return nullcontext()
    from rich.console import Console

    from fuzzyarm.kernels import watch_compiling

    status = Console(stderr=True).status(message)
    watch_compiling(
        lambda name: status.update(f"{message}: compiling {name}, once" if name else message)
    )
    return status


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
        print(json.dumps({"controller": controller.name, "gains": rows}, ensure_ascii=False))
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


def _list(as_json: bool) -> int:
    from fuzzyarm.controller import CATALOGUE

    if as_json:
        print(json.dumps({entry.name: entry.summary for entry in CATALOGUE.values()}))
        return 0
    width = max(map(len, CATALOGUE))
    for entry in CATALOGUE.values():
        print(f"{entry.name:<{width}}  {entry.summary}")
    return 0
