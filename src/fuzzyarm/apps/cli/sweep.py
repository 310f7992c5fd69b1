"""Run a controller many times: over ranges of gains, parameters of the plant, loads and noise.

Each --sweep NAME=A..B:N takes N values from A to B (logarithmically with a final "log");
several span a grid. With --random N values are drawn from ranges without a number of values.
NAME is a gain of the controller, a parameter of the plant (plant.NAME where both have it), seed,
disturbance, noise.PORT, delay.PORT or resolution.PORT, and for a plant with a load, such as the
arm, payload: 0 for none, 1 for that of --payload, 2 for twice as much.

With several controllers all run under the same changes and seeds. The table has median and worst of
--metric over all runs of each, and how many failed: diverged, or without a value, such as the
settling time of a loop that does not settle; the median takes these as infinite. Below it, the runs
in which the first controller is better than each of the others, and the swept values at which it
always is. Better is a smaller value on every output. A gain is swept in each controller that has
it. --set NAME=A..B:N is the same as --sweep NAME=A..B:N.

-o writes a line for each run. After an interruption it has the first part of the file, and
--resume writes the rest. Results do not depend on the number of workers.

Examples
--------
  fuzzyarm sweep stfc --sweep payload=0..2:21 --sweep "G_e=100..3000:12 log" -o sweep.csv
  fuzzyarm sweep stfc --sweep payload=0..2:21 --sweep G_e=100..3000:12 --plot map.png
  fuzzyarm sweep pd stfc ct+pd --sweep m_2=1..3:9 --sweep payload=0..2:9 --plot maps.png
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
    from fuzzyarm.control.loop.robustness import PairedComparison, Robustness
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
    from fuzzyarm.control.loop.sweeps import answered, cluster, map_axes, sweep_of

    plan = sweep_of(request)
    for note in dict.fromkeys(note for bench in plan.benches for note in bench.loop.notes()):
        print_error(f"note: {note}")
    axes = map_axes(request, plan) if request.plot else ()
    file = plan.file(request.out) if request.out else None
    names = ", ".join([request.controller, *request.against])
    with (
        announced(f"sweeping {names}: {counted(plan.count, 'run')}"),
        cluster(request) as (executor, workers),
        steps_bar("runs", plan.count) as moved,
    ):
        answer = answered(plan, file, request.replaced(workers=workers), executor, moved)
    faults = list(answer.faults)
    results = plan.results(answer.rows)
    if results:
        if request.json:
            print_json(_report(results, plan.ranges, request))
        else:
            say(*_as_text(results, request))
    if request.plot and results:
        faults += attempted(lambda: _plot(results, axes, request))
    for fault in faults:
        print_error(fault)
    if answer.interrupted:
        done = f"{len(answer.rows)} of {counted(plan.count, 'run')}"
        journal = (
            "with -o they are kept" if file is None else f"{file.path} has them, --resume goes on"
        )
        print_error(f"interrupted after {done}; {journal}")
        return EXIT_INTERRUPTED
    if faults:
        return 1
    from fuzzyarm.apps.show.sweep import lost_runs

    return DIVERGED if all(len(many) == lost_runs(many) for many in results) and results else 0


def _require_sensible(request: SweepWords) -> None:
    """Report mistakes before anything runs."""
    from fuzzyarm.control.loop.sweeps import require_sensible

    require_sensible(request)
    if request.map and not request.plot:
        raise UsageError("--map is drawn to the file of --plot, and none is given")
    demand_figure(request.plot)


# --- Results ---


def _report(
    results: list[Many], ranges: tuple[Range, ...], request: SweepWords
) -> SweepReport | SweepComparison:
    if len(results) > 1:
        return SweepComparison(tuple(results), ranges, request.metric, request.out)
    return SweepReport(results[0], ranges, request.metric, request.out)


def _plot(results: list[Many], axes: tuple[Range, ...], request: SweepWords) -> None:
    from fuzzyarm.apps.show.figures import save_figure
    from fuzzyarm.apps.show.figures.sweep import sweep_figure

    save_figure(sweep_figure(results, axes, request.metric), request.plot or "")


def _as_text(results: list[Many], request: SweepWords) -> list[str]:
    from fuzzyarm.apps.show.sweep import sweep_lines

    lines = sweep_lines(results, request.metric)
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
        """The runs of the least and the greatest value, by output: number, value, swept values."""
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


@json_properties("plant trajectory runs sweep outputs metric controllers pairs file")
@dataclass(frozen=True)
class SweepComparison:
    """Report on the same many runs of several controllers."""

    results: tuple[Many, ...]
    sweep: tuple[Range, ...] = entry("in the order of the runs, the last one fastest")
    metric: str = entry("by which controllers are judged")
    file: str | None = entry("the written file")

    @property
    def plant(self) -> str:
        """Its name."""
        return self.results[0].plant

    @property
    def trajectory(self) -> str:
        """Its name, or the references."""
        return self.results[0].trajectory

    @property
    def runs(self) -> int:
        """Of each controller."""
        return len(self.results[0])

    @property
    def outputs(self) -> dict[str, str]:
        """Units by output."""
        return dict(zip(self.results[0].outputs, self.results[0].units, strict=True))

    @property
    def controllers(self) -> list[Robustness]:
        """Of each controller, each output."""
        from fuzzyarm.control.loop.robustness import robustness

        return robustness(self.results, self.metric)

    @property
    def pairs(self) -> list[PairedComparison]:
        """Of the first controller with each of the others."""
        from fuzzyarm.control.loop.robustness import paired_comparison

        first, *others = self.results
        return [paired_comparison(first, other, self.metric) for other in others]


COMMANDS = (
    request_command("sweep", with_choice(__doc__), sweep, SweepWords, *group("output", FORCE)),
)
