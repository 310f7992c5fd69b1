"""Compare controllers under the same conditions: along trajectories of a plant, or references."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.cli.arguments import request_command
from fuzzyarm.apps.cli.command import (
    DIVERGED,
    FORCE,
    WordError,
    demand_figure,
    print_error,
    print_json,
    progress_bar,
)
from fuzzyarm.base.columns import in_columns
from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.requests.fields import Request, option
from fuzzyarm.requests.runs import CompareRequest

if TYPE_CHECKING:
    from fuzzyarm.apps.study.comparison import Compared, ControlStepCost
    from fuzzyarm.control.controllers import Controller
    from fuzzyarm.control.loop import Run
    from fuzzyarm.plant import Conventions, Plant, Trajectory


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """Output of a comparison."""

    plot: str | None = option("--plot FIG", "draw error against cost", None)
    markdown: bool = option("--markdown", "print a table for a page", False)
    json: bool = option("--json", "print the result as JSON", False)


@dataclass(frozen=True, kw_only=True)
class CompareWords(CompareRequest, _Output):
    """All arguments of ``fuzzyarm compare``."""


_COMPARE = """Compare controllers under the same conditions: errors, chatter, cost.

CONTROLLER is a name of the catalogue, a sum or a file; by default those of the study's
summary table and the new ones beside them. The arm follows reach-return and pick-and-place,
another plant its own trajectories, all under the conditions of the options, whatever the
controllers. By default: with load, also in the hold; double precision and the true π; set
points held for as many periods as a controller needs (laws: five of 0.6 ms), motors without
inductance, unlimited torque. For the conditions of the study see `fuzzyarm reproduce`.

"rms" are the RMS errors of links 1 and 2 on the first trajectory, then on the second, in
degrees: at the set points, each in the last of its periods, as the study samples them; in
all control periods, against the held set point; and against the path itself, which moves on
while a set point is held. "change" measures chatter: the mean magnitude of the change of a
joint's torque (on another plant: of the first drive of an axis) from one control period to the
next, the largest of all, in N m.

With --operations: floating-point operations of a control step, both joints together
(measured in the loop, sines and cosines included, averaged along a short move), and those of
a step of the program by `fuzzyarm compile`, at most. With --cost also the processor time of a
step in the loop. Both are for the arm.

On a plant without trajectories (that of --plant, or the shipped one with the axes of the
controllers), and with --reference or --step on any, they follow the same references, with the
options of `fuzzyarm simulate`; the table has the metrics of each run, and --plot draws the
runs side by side. Over ranges of parameters, loads and noise see `fuzzyarm sweep`.

Examples
--------
  fuzzyarm compare
  fuzzyarm compare --interpolate
  fuzzyarm compare --angles 80 -20 --segment 1 --limits 55.44 48.51
  fuzzyarm compare pd-motor fuzzy-fine mine.frb --inductance 0.002 --supply 24 --cost
  fuzzyarm compare servo.frb tuned.frb --step 1 --for 2s --noise position=0.001
"""


def _compare(request: CompareWords) -> int:
    from fuzzyarm.apps.study.comparison import compared_names
    from fuzzyarm.control.controllers.own import find_controllers
    from fuzzyarm.control.loop.experiments import follows, with_plant, with_settings

    demand_figure(request.plot)
    names = request.controllers or compared_names()
    controllers = find_controllers(names)
    request, plant = with_plant(request, controllers)
    controllers, plant = with_settings(request, controllers, plant)
    along = follows(request, plant)
    _require_counted(request, plant, along=along)
    if not along:
        return _compare_references(request, controllers, plant)
    return _compare_trajectories(request, names, controllers, plant)


def _require_counted(request: CompareWords, plant: Plant, *, along: bool) -> None:
    """Raise WordError for an option of the other kind of comparison."""
    from fuzzyarm.apps.study.comparison import is_counted

    option = request.given(("cost", "operations"))
    if option and not (along and is_counted(plant)):
        listing = ", ".join(SHOWN[:3])
        message = f"{option.spelling} counts along the trajectories of the study's arm"
        raise WordError(f"{message}; {plant.name} is compared by errors and chatter: {listing}, …")
    if request.errors and not along:
        message = "--errors chooses among those along trajectories"
        raise WordError(f"{message}; along --reference there are {', '.join(SHOWN)}")


# --- Along trajectories ---


def _compare_trajectories(
    request: CompareWords,
    names: Sequence[str],
    controllers: Sequence[Controller],
    plant: Plant,
) -> int:
    from fuzzyarm.apps.study.comparison import compare, compared_along, cost_of, is_counted
    from fuzzyarm.control.loop.experiments import with_drives
    from fuzzyarm.control.loop.words import connections, conventions_of

    trajectories, conventions = compared_along(request, plant), conventions_of(request)
    _, options = with_drives(request, plant)
    # The figure of the arm draws errors against cost.
    timed = bool(request.cost or (request.plot and is_counted(plant)))
    counted = names if timed or request.operations else ()
    comparisons: list[Compared] = []
    costs: list[ControlStepCost] = []
    with progress_bar("controllers", len(names) + len(counted)) as bar:
        for comparison in compare(
            controllers,
            options,
            plant=plant,
            trajectories=trajectories,
            conventions=conventions,
            payload=bool(request.payload),
            connect=connections(request),
        ):
            comparisons.append(comparison)
            bar(1)
        for name in counted:
            costs.append(cost_of(name, conventions=conventions, timed=timed))
            bar(1)
    ways = " and ".join(trajectory.name for trajectory in trajectories)
    heading = f"{ways}{_conditions(request, plant)}, {_counting(conventions)}"
    if request.plot and costs:
        from fuzzyarm.apps.study.figures import draw_cost, save_figure

        save_figure(draw_cost(comparisons, costs, heading), request.plot)
    elif request.plot:
        runs = _runs_along(request, controllers, plant, trajectories[0])
        title = f"{plant.name}: {trajectories[0].name}{_conditions(request, plant)}"
        _plot_runs(runs, request.plot, title)
    _print_notes(comparisons)
    senses = [request.errors] if request.errors else list(_SENSES)
    if request.json:
        records = jsonable((comparisons, costs))
        plain: Any = zip_longest(*records, fillvalue={})
        print_json([compared | cost for compared, cost in plain], 1)
    elif request.markdown:
        print("\n".join(_compared_markdown(comparisons, costs, senses)))
    else:
        print(heading)
        print("\n".join(_compared_lines(comparisons, costs, senses)))
    return 0


def _print_notes(compared: Sequence[Compared | Run]) -> None:
    for note in dict.fromkeys(note for result in compared for note in result.notes):
        print_error(f"note: {note}")


def _conditions(request: CompareWords, plant: Plant) -> str:
    """Return the common conditions of all controllers in words."""
    from fuzzyarm.control.loop.words import conditions, conventions_of
    from fuzzyarm.plant.following import carries

    load = _load(conventions_of(request), payload=bool(request.payload)) if carries(plant) else ""
    around = conditions(request)
    return f"{load}, {around}" if around else load


def _load(conventions: Conventions, *, payload: bool) -> str:
    """Return the load in words."""
    if not payload:
        return " without load"
    return " with load" if conventions.load_in_hold else " with load but not in the hold"


def _counting(conventions: Conventions) -> str:
    """Return the numerical conventions in words."""
    numbers = f"{conventions.precision}, π {conventions.pi:.7g}"
    return f"{conventions.name} conventions, {numbers}"


def _runs_along(
    request: CompareWords,
    controllers: Sequence[Controller],
    plant: Plant,
    trajectory: Trajectory,
) -> list[Run]:
    """Run controllers along one trajectory, for a figure of the runs."""
    from fuzzyarm.control.loop.along import trajectory_motion
    from fuzzyarm.control.loop.experiments import with_drives
    from fuzzyarm.control.loop.run import run_along
    from fuzzyarm.control.loop.words import connections, conventions_of
    from fuzzyarm.plant.following import carries

    connect, conventions = connections(request), conventions_of(request)
    plant, options = with_drives(request, plant)
    payload = bool(request.payload) and carries(plant)
    runs = []
    for controller in controllers:
        motion = trajectory_motion(
            plant, trajectory, controller, conventions, payload=payload, connect=connect
        )
        runs.append(run_along(controller, motion, conventions, options, connect))
    return runs


_SENSES = {"set-points": "set points", "periods": "all periods", "path": "path"}
"""Names of the errors by the word of ``--errors``."""


def _compared_lines(
    compared: Sequence[Compared], costs: Sequence[ControlStepCost], senses: Sequence[str]
) -> Iterator[str]:
    """Yield a table with a line for each controller and kind of error."""
    heads = ["change", *(_cost_heads(costs) if costs else [])]
    count = len(compared[0].rms)
    yield _columns("controller", "", [*_rms_heads(compared[0]), *heads], count)
    for comparison, cost in zip_longest(compared, costs):
        # One line for a controller with diverged runs only.
        sense_names = senses if any(time is None for time in comparison.diverged) else senses[:1]
        for at, sense in enumerate(sense_names):
            name, others = (comparison.name, _others(comparison, cost)) if at == 0 else ("", [])
            yield _columns(name, _SENSES[sense], [*_errors(comparison, sense), *others], count)


def _outputs_of(compared: Compared) -> list[int]:
    """Return the output of each error, counted from 1."""
    # Errors are ordered by trajectory, then by output.
    outputs = len(compared.rms) // len(compared.diverged)
    return [1 + index % outputs for index in range(len(compared.rms))]


def _rms_heads(compared: Compared) -> list[str]:
    """Return a heading for each error; degrees go without saying."""
    units = ["" if unit == "degrees" else f", {unit}" for unit in compared.units]
    return [f"rms {at}{unit}" for at, unit in zip(_outputs_of(compared), units, strict=True)]


def _compared_markdown(
    compared: Sequence[Compared], costs: Sequence[ControlStepCost], senses: Sequence[str]
) -> Iterator[str]:
    """Yield a table with a line for each controller; with costs, beside mean errors."""
    if costs:
        heads = ["controller", "geometric mean at set points", "from the path"]
        heads += _cost_heads(costs)
    else:
        heads = ["controller"]
        first, *others = map(str, _outputs_of(compared[0]))
        for sense in senses:
            heads += [f"{_SENSES[sense]}: {first}", *others]
        heads.append("change")
    yield f"| {' | '.join(heads)} |"
    yield "|---" * len(heads) + "|"
    for comparison, cost in zip_longest(compared, costs):
        if cost is None:
            cells = [cell for sense in senses for cell in _errors(comparison, sense)]
            cells += _others(comparison, None)
        else:
            diverges = any(time is not None for time in comparison.diverged)
            means = (comparison.error, comparison.path_error)
            cells = ["diverges" if diverges else f"{mean:.4f}" for mean in means] + _cost_cells(
                cost
            )
        yield f"| {' | '.join([comparison.name, *cells])} |"


def _errors(compared: Compared, sense: str) -> list[str]:
    values = {
        "set-points": compared.rms,
        "periods": compared.rms_periods,
        "path": compared.rms_path,
    }[sense]
    outputs = len(values) // len(compared.diverged)
    divergences = [compared.diverged[index // outputs] is not None for index in range(len(values))]
    return [
        "diverges" if diverges else f"{value:.4f}"
        for diverges, value in zip(divergences, values, strict=True)
    ]


def _others(compared: Compared, cost: ControlStepCost | None) -> list[str]:
    """Return the largest change of torque, and the cost of a step."""
    diverges = any(time is not None for time in compared.diverged)
    change = "" if diverges else f"{max(compared.variation, default=0.0):.2f}"
    return [change, *(_cost_cells(cost) if cost is not None else [])]


def _cost_heads(costs: Sequence[ControlStepCost]) -> list[str]:
    timed = costs[0].seconds is not None
    return ["operations", "exported", *(["ns"] if timed else [])]


def _cost_cells(cost: ControlStepCost) -> list[str]:
    exported = "-" if cost.exported is None else f"{cost.exported}"
    cells = [f"{cost.operations.total:.0f}", exported]
    return cells if cost.seconds is None else [*cells, cost.nanoseconds]


def _columns(name: str, sense: str, cells: Sequence[str], errors: int) -> str:
    """Return a line of the table with this many cells of errors."""
    least = [18, 12, *[10] * errors, 12]
    return in_columns([(name, sense, *cells)], "<<>", gap="", least=least)[0]


# --- Along references ---

SHOWN = ("rms", "max", "overshoot", "settling", "effort", "chatter")
"""Metrics of a run in the table."""


def _compare_references(
    request: CompareWords, controllers: Sequence[Controller], plant: Plant
) -> int:
    """Run controllers along the same references and print the metrics."""
    from fuzzyarm.control.loop.experiments import with_drives
    from fuzzyarm.control.loop.run import run_along
    from fuzzyarm.control.loop.words import conditions, connections, conventions_of, motion_of

    plant, options = with_drives(request, plant)
    connect, conventions = connections(request), conventions_of(request)
    runs: list[Run] = []
    with progress_bar("controllers", len(controllers)) as bar:
        for controller in controllers:
            motion = motion_of(request, controller, plant)
            runs.append(run_along(controller, motion, conventions, options, connect))
            bar(1)
    _print_notes(runs)
    for run in runs:
        for gap in run.gaps:
            print_error(f"note: {run.controller}: {gap}")
    around = conditions(request)
    heading = f"{runs[0].trajectory}{', ' if around else ''}{around}"
    if request.plot:
        _plot_runs(runs, request.plot, f"{plant.name}: {heading}")
    if request.json:
        print_json(runs, 1)
    elif request.markdown:
        print("\n".join(_markdown(runs)))
    else:
        print(f"{plant.name}, {heading}", *_lines(runs), sep="\n")
    return DIVERGED if all(run.diverged is not None for run in runs) else 0


def _plot_runs(runs: list[Run], path: str, title: str) -> None:
    """Draw runs side by side below their conditions."""
    from fuzzyarm.apps.show.figures.panels import draw_runs
    from fuzzyarm.apps.study.figures import save_figure

    save_figure(draw_runs(runs, title), Path(path))


def _rows(runs: Sequence[Run]) -> Iterator[list[str]]:
    """Yield the headings, then a row for each controller and tracked output."""
    several = len(runs[0].labels) > 1
    unit = dict(zip(runs[0].labels, runs[0].units, strict=True))
    yield ["controller", "error of", *SHOWN]
    for run in runs:
        for (name, metrics), label in zip(run.metrics.items(), run.labels, strict=True):
            cells = metrics.to_dict()
            numbers = ["-" if cells[metric] is None else f"{cells[metric]:.4g}" for metric in SHOWN]
            if run.diverged is not None:
                numbers = [f"diverged at {run.diverged:.4g} s", *[""] * (len(SHOWN) - 1)]
            yield [run.controller, f"{name if several else label}, {unit[label]}", *numbers]


def _lines(runs: Sequence[Run]) -> Iterator[str]:
    yield from in_columns(list(_rows(runs)), "<<>", least=(0, 0, 10))


def _markdown(runs: Sequence[Run]) -> Iterator[str]:
    heads, *rows = _rows(runs)
    yield f"| {' | '.join(heads)} |"
    yield "|---" * len(heads) + "|"
    for row in rows:
        yield f"| {' | '.join(row)} |"


COMMANDS = (request_command("compare", _COMPARE, _compare, CompareWords, FORCE),)
