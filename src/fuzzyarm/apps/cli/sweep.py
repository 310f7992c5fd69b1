"""Run a controller many times: over ranges of gains, parameters of the plant, loads and noise.

Each --sweep NAME=A..B:N takes N values from A to B (logarithmically with a final "log");
several span a grid. With --random N values are drawn from ranges without a number of values.
NAME is a gain of the controller, a parameter of the plant (plant.NAME where both have it), seed,
disturbance, noise.PORT, delay.PORT or resolution.PORT, and for a plant with a load, such as the
arm, payload: 0 for none, 1 for that of --payload, 2 for twice as much.

-o writes a line for each run. After an interruption it has the first part of the file, and
--resume writes the rest. Results do not depend on the number of workers.

Examples
--------
  fuzzyarm sweep stfc --sweep payload=0..2:21 --sweep "G_e=100..3000:12 log" -o sweep.csv
  fuzzyarm sweep stfc --sweep payload=0..2:21 --sweep G_e=100..3000:12 --plot map.png
  fuzzyarm sweep servo.frb --plant motor --sweep J=0.005..0.03 --sweep R=1..4 --random 1000
  fuzzyarm sweep heater.frb --plant mine.py:Kiln --random 200 --noise temperature=0.2
  fuzzyarm sweep stfc --sweep payload=0..2:200 -o sweep.csv --dask tcp://scheduler:8786
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.cli.arguments import request_command, with_choice
from fuzzyarm.apps.cli.command import (
    DIVERGED,
    EXIT_INTERRUPTED,
    FORCE,
    UsageError,
    announced,
    attempted,
    demand_figure,
    group,
    print_error,
    print_json,
    say,
    steps_bar,
)
from fuzzyarm.base.jsonable import entry, json_properties
from fuzzyarm.base.numbers import counted
from fuzzyarm.requests.fields import Request, option
from fuzzyarm.requests.runs import SweepRequest

if TYPE_CHECKING:
    from fuzzyarm.control.loop.many import Many
    from fuzzyarm.control.loop.sweep import Range


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """Output of many runs."""

    plot: str | None = option(
        "--plot FIG", "draw the metric over the swept values", None, idle=True, group="output"
    )
    json: bool = option("--json", "print the result as JSON", False, idle=True, group="output")


@dataclass(frozen=True, kw_only=True)
class SweepWords(SweepRequest, _Output):
    """All arguments of ``fuzzyarm sweep``."""


# --- The runs ---


def sweep(request: SweepWords) -> int:
    """Run a sweep; return the exit status."""
    _require_sensible(request)
    from fuzzyarm.control.loop.many import many_of
    from fuzzyarm.control.loop.sweeps import answered, cluster, map_axes, sweep_of

    plan = sweep_of(request)
    for note in plan.bench.loop.notes():
        print_error(f"note: {note}")
    axes = map_axes(request, plan) if request.plot else ()
    file = plan.file(request.out) if request.out else None
    with (
        announced(f"sweeping {request.controller}: {counted(plan.count, 'run')}"),
        cluster(request) as (executor, workers),
        steps_bar("runs", plan.count) as moved,
    ):
        answer = answered(plan, file, request.replaced(workers=workers), executor, moved)
    faults = list(answer.faults)
    many = many_of(plan.bench, plan.changes, answer.rows)
    if len(many):
        if request.json:
            print_json(SweepReport(many, plan.ranges, request.metric, request.out))
        else:
            say(*_as_text(many, request))
    if request.plot and len(many):
        faults += attempted(lambda: _plot(many, axes, request))
    for fault in faults:
        print_error(fault)
    if answer.interrupted:
        done = f"{len(many)} of {counted(plan.count, 'run')}"
        journal = (
            "with -o they are kept" if file is None else f"{file.path} has them, --resume goes on"
        )
        print_error(f"interrupted after {done}; {journal}")
        return EXIT_INTERRUPTED
    if faults:
        return 1
    from fuzzyarm.apps.show.sweep import lost_runs

    return DIVERGED if 0 < len(many) == lost_runs(many) else 0


def _require_sensible(request: SweepWords) -> None:
    """Report mistakes before anything runs."""
    from fuzzyarm.control.loop.sweeps import require_sensible

    require_sensible(request)
    if request.map and not request.plot:
        raise UsageError("--map is drawn to the file of --plot, and none is given")
    demand_figure(request.plot)


# --- Results ---


def _plot(many: Many, axes: tuple[Range, ...], request: SweepWords) -> None:
    from fuzzyarm.apps.show.figures import save_figure
    from fuzzyarm.apps.show.figures.sweep import sweep_figure

    save_figure(sweep_figure(many, axes, request.metric), request.plot or "")


def _as_text(many: Many, request: SweepWords) -> list[str]:
    from fuzzyarm.apps.show.sweep import sweep_lines

    lines = sweep_lines(many, request.metric)
    return [*lines, f"wrote {request.out}"] if request.out else lines


@json_properties(
    "controller=many.controller plant=many.plant trajectory=many.trajectory runs=many.__len__"
    " diverged sweep outputs metric extremes file columns? rows?"
)
@dataclass(frozen=True)
class SweepReport:
    """Report on many runs."""

    many: Many
    sweep: tuple[Range, ...] = entry("in the order of the runs, the last one fastest")
    metric: str = entry("whose extremes are shown")
    file: str | None = entry("the written file")

    @property
    def diverged(self) -> int:
        """How many of them diverged."""
        from fuzzyarm.apps.show.sweep import lost_runs

        return lost_runs(self.many)

    @property
    def outputs(self) -> dict[str, str]:
        """Units by output."""
        return dict(zip(self.many.outputs, self.many.units, strict=True))

    @property
    def extremes(self) -> dict[str, dict[str, dict[str, Any]]]:
        """By output, the runs of the least and the most: number, value, and what was swept."""
        from fuzzyarm.apps.show.sweep import extremes, settings_of

        many, metric = self.many, self.metric
        return {
            output: {
                word: {
                    "run": run,
                    "value": float(many[metric][run, many.outputs.index(output)]),
                    **settings_of(many, run),
                }
                for word, run in (("least", least), ("most", most))
            }
            for output, _, least, most in extremes(many, metric)
        }

    @property
    def columns(self) -> tuple[str, ...]:
        """Of `rows`; without -o."""
        return () if self.file else tuple(self.many.columns())

    @property
    def rows(self) -> tuple[tuple[Any, ...], ...]:
        """All runs; without -o."""
        return () if self.file else tuple(zip(*self.many.columns().values(), strict=True))


COMMANDS = (
    request_command("sweep", with_choice(__doc__), sweep, SweepWords, *group("output", FORCE)),
)
