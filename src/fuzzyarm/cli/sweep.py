"""Run a controller many times: over ranges of gains, parameters of the plant, loads and noise.

Each --sweep NAME=A..B:N takes N values from A to B (evenly in the logarithm with "log" behind);
several span a grid. With --random N values are drawn from ranges without a number of values.
NAME is a gain of the controller, a parameter of the plant (plant.NAME where both have it), seed,
disturbance, noise.PORT, delay.PORT or resolution.PORT, and of a plant that carries a load, as the
arm, payload: a share of it, 0 for none, 1 for that of --payload, 2 for twice as much.

-o writes a line for each run. Interrupted, it is the front of the whole file, and --resume
writes the rest. Results do not depend on how many workers there are.

Examples
--------
  fuzzyarm sweep stfc --sweep payload=0..2:21 --sweep "G_e=100..3000:12 log" -o sweep.csv
  fuzzyarm sweep stfc --sweep payload=0..2:21 --sweep G_e=100..3000:12 --plot map.png
  fuzzyarm sweep servo.frb --plant motor --sweep J=0.005..0.03 --sweep R=1..4 --random 1000
  fuzzyarm sweep heater.frb --plant mine.py:Kiln --random 200 --noise temperature=0.2
  fuzzyarm sweep stfc --sweep payload=0..2:200 -o sweep.csv --dask tcp://scheduler:8786
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.arguments import request_command, with_choice
from fuzzyarm.cli.command import (
    DIVERGED,
    EXIT_INTERRUPTED,
    UsageError,
    announced,
    attempted,
    counted,
    demand_figure,
    print_error,
    print_json,
    say,
    steps_bar,
)
from fuzzyarm.requests.fields import Request, option
from fuzzyarm.requests.runs import SweepRequest

if TYPE_CHECKING:
    from fuzzyarm.loop.many import Many
    from fuzzyarm.loop.sweeps import Sweep


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """What a command shows and draws of many runs."""

    plot: str | None = option(
        "--plot FIG", "draw the metric over what is swept", None, idle=True, group="output"
    )
    json: bool = option("--json", "print the result as JSON", False, idle=True, group="output")


@dataclass(frozen=True, kw_only=True)
class SweepWords(SweepRequest, _Output):
    """All that ``fuzzyarm sweep`` takes."""


# --- The runs ---


def sweep(asked: SweepWords) -> int:
    """Do what the words ask; return the exit status."""
    _require_sensible(asked)
    from fuzzyarm.loop.many import many_of
    from fuzzyarm.loop.sweeps import answered, cluster, sweep_of

    plan = sweep_of(asked)
    for note in plan.bench.loop.notes():
        print_error(f"note: {note}")
    axes = _map_axes(asked, plan)
    file = plan.file(asked.out) if asked.out else None
    with (
        announced(f"sweeping {asked.controller}: {counted(plan.count, 'run')}"),
        cluster(asked) as (executor, workers),
        steps_bar("runs", plan.count) as moved,
    ):
        answer = answered(plan, file, asked.replaced(workers=workers), executor, moved)
    faults = list(answer.faults)
    many = many_of(plan.bench, plan.changes, answer.rows)
    if len(many):
        if asked.json:
            print_json(_as_json(many, plan, asked))
        else:
            say(*_as_text(many, asked))
    if asked.plot and len(many) == plan.count:
        faults += attempted(lambda: _plot(many, plan, axes, asked))
    for fault in faults:
        print_error(fault)
    if answer.interrupted:
        done = f"{len(many)} of {counted(plan.count, 'run')}"
        kept = (
            "with -o they are kept" if file is None else f"{file.path} has them, --resume goes on"
        )
        print_error(f"interrupted after {done}; {kept}")
        return EXIT_INTERRUPTED
    if faults:
        return 1
    return DIVERGED if 0 < len(many) == _lost(many) else 0


def _require_sensible(asked: SweepWords) -> None:
    """Tell mistakes before anything runs."""
    from fuzzyarm.loop.sweeps import require_sensible

    require_sensible(asked)
    if asked.map and not asked.plot:
        raise UsageError("--map is drawn to the file of --plot, and none is given")
    demand_figure(asked.plot)


# --- What came of it ---


def _map_axes(asked: SweepWords, plan: Sweep) -> tuple[str, ...]:
    """Return the one or two names over which a figure is drawn."""
    if not asked.plot:
        return ()
    names = [interval.name for interval in plan.ranges]
    axes = tuple(names)
    if asked.map:
        axes = tuple(name.strip() for name in asked.map.split(","))
    if asked.random is not None:
        raise UsageError("a figure is drawn of a grid, not of --random")
    for name in axes:
        if name not in names:
            raise UsageError(f"--map: '{name}' is not swept", hint=f"swept: {', '.join(names)}")
    if asked.map and len(set(axes)) != 2:
        raise UsageError("--map takes two names, as in payload,G_e")
    if len(axes) > 2:
        raise UsageError("--map says over which two the figure is drawn", hint=",".join(names[:2]))
    return axes


def _plot(many: Many, plan: Sweep, axes: tuple[str, ...], asked: SweepWords) -> None:
    from fuzzyarm.show.figures import save_figure
    from fuzzyarm.show.figures.sweep import sweep_figure

    ranges = {interval.name: interval for interval in plan.ranges}
    figure = sweep_figure(many, [ranges[name] for name in axes], asked.metric)
    save_figure(figure, asked.plot or "")


def _extremes(many: Many, metric: str) -> Iterator[tuple[str, str, int, int]]:
    """Yield output, unit, and the runs with the smallest and the largest magnitude of a metric."""
    import numpy as np

    values = np.abs(many[metric])
    # What a run measured until it diverged is not comparable.
    values[~np.isnan(many.diverged)] = np.nan
    for at, (output, unit) in enumerate(zip(many.outputs, many.units, strict=True)):
        column = values[:, at]
        if not np.isnan(column).all():
            yield output, unit, int(np.nanargmin(column)), int(np.nanargmax(column))


def _settings(many: Many, run: int) -> dict[str, float]:
    """Return what a run was made with."""
    return {name: float(values[run]) for name, values in many.changes.items()} or {
        "seed": int(many.seeds[run])
    }


def _lost(many: Many) -> int:
    import numpy as np

    return int((~np.isnan(many.diverged)).sum())


def _as_text(many: Many, asked: SweepWords) -> list[str]:
    from fuzzyarm.loop.metrics import ERRORS

    lost = _lost(many)
    lines = [
        f"{many.controller} on {many.where}: {counted(len(many), 'run')}, "
        f"{f'{lost} diverged' if lost else 'none diverged'}"
    ]
    metric = asked.metric
    for output, unit, least, most in _extremes(many, metric):
        lines.append(f"{output}.{metric}, {unit}" if metric in ERRORS else f"{output}.{metric}")
        for word, run in (("least", least), ("most", most)):
            value = float(many[metric][run, many.outputs.index(output)])
            with_what = ", ".join(f"{k} = {v:g}" for k, v in _settings(many, run).items())
            lines.append(f"  {word:<6}{value:>12.4g}  run {run}: {with_what}")
    if asked.out:
        lines.append(f"wrote {asked.out}")
    return lines


def _as_json(many: Many, plan: Sweep, asked: SweepWords) -> dict[str, Any]:
    metric = asked.metric

    found: dict[str, Any] = {
        "controller": many.controller,
        "plant": many.plant,
        "trajectory": many.trajectory,
        "runs": len(many),
        "diverged": _lost(many),
        "sweep": [asdict(interval) for interval in plan.ranges],
        "outputs": dict(zip(many.outputs, many.units, strict=True)),
        "metric": metric,
        "extremes": {
            output: {
                word: {
                    "run": run,
                    "value": float(many[metric][run, many.outputs.index(output)]),
                    **_settings(many, run),
                }
                for word, run in (("least", least), ("most", most))
            }
            for output, _, least, most in _extremes(many, metric)
        },
        "file": asked.out,
    }
    if not asked.out:
        columns = many.columns()
        found["columns"] = list(columns)
        found["rows"] = list(zip(*columns.values(), strict=True))
    return found


COMMANDS = (request_command("sweep", with_choice(__doc__), sweep, SweepWords),)
