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

import argparse
import math
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fuzzyarm.cli.command import (
    EXIT_INTERRUPTED,
    JSON,
    WordError,
    announced,
    argument,
    attempted,
    command,
    counted,
    demand_places,
    flag,
    group,
    print_error,
    print_json,
    say,
    steps_bar,
)
from fuzzyarm.cli.experiment import (
    DIVERGED,
    RUN,
    SOURCES,
    TRAJECTORY,
    conventions_of,
    named_controllers,
    trajectory_of_words,
    with_settings,
)
from fuzzyarm.cli.plants import (
    MOTORS,
    PLANT,
    connections,
    equipped_by,
    follows,
    motion_of,
    plant_of,
)
from fuzzyarm.errors import FuzzyarmError, demand_extra, sentence_of

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from fuzzyarm.loop.many import Bench, Many, Vector
    from fuzzyarm.loop.sweep import Range, SweepFile

SWEEP = group(
    "many runs",
    argument(
        "--sweep NAME=A..B:N",
        "N values from A to B; several span a grid",
        action="append",
        default=[],
    ),
    argument("--random N", "N runs with values drawn from ranges NAME=A..B", type=int),
    argument(
        "--metric NAME", "metric of summary and figure: rms, max, overshoot, …", default="rms"
    ),
    argument("--map X,Y", "draw the metric over these two with --plot"),
    argument("-o --out FILE.csv", "write a line for each run"),
    flag("--resume", "go on with the file of -o"),
    argument("--workers N", "runs at a time, one for each processor by default", type=int),
    argument("--dask ADDRESS", "run on a Dask cluster, as in tcp://scheduler:8786"),
)
"""Arguments of every command that sweeps."""


# --- What is asked ---


@dataclass(frozen=True)
class Asked:
    """What a sweep is to do: the bench, what differs, and how to say it."""

    bench: Bench
    ranges: tuple[Range, ...]
    changes: Mapping[str, Vector]
    count: int
    question: Mapping[str, Any]


def read_asked(arguments: argparse.Namespace) -> Asked:
    """Return what the arguments ask for."""
    from fuzzyarm.loop.along import Way
    from fuzzyarm.loop.many import Bench, Experiment

    (controller,) = named_controllers(arguments, [arguments.controller])
    controller, plant = with_settings(arguments, controller, plant_of(arguments, [controller]))
    along = follows(arguments, plant)
    plant, options = equipped_by(arguments, plant)
    connect, conventions = connections(arguments), conventions_of(arguments)
    shared: dict[str, float] = {}
    segments = tuple(arguments.loaded) if arguments.loaded else None
    on: Any
    if along:
        on = Way(plant, trajectory_of_words(arguments, plant))
        if arguments.payload or segments:
            shared["payload"] = 1.0
    else:
        on = motion_of(arguments, controller, plant)
    ranges, changes, count = _ranges(arguments)
    experiment = Experiment(controller, on, segments, shared, conventions, options, connect=connect)
    bench = Bench(experiment, list(changes))
    return Asked(bench, ranges, changes, count, _question(arguments, bench))


def _ranges(
    arguments: argparse.Namespace,
) -> tuple[tuple[Range, ...], dict[str, Vector], int]:
    from fuzzyarm.loop.many import MOST_RUNS
    from fuzzyarm.loop.sweep import drawn, grid, read_range, whole

    ranges = tuple(map(read_range, arguments.sweep))
    if arguments.random is not None:
        if not 1 <= arguments.random <= MOST_RUNS:
            raise WordError(f"--random {arguments.random} is out of range: 1 to {MOST_RUNS:,}")
        return ranges, whole(drawn(ranges, arguments.random, arguments.seed)), arguments.random
    if not ranges:
        raise WordError("nothing is swept", hint="--sweep NAME=A..B:N, or --random N")
    count = math.prod(interval.count or 1 for interval in ranges)
    if count > MOST_RUNS:
        raise WordError(f"a grid of {count:,} runs is out of range: up to {MOST_RUNS:,}")
    return ranges, whole(grid(ranges)), count


NOT_ASKED = ("out", "resume", "workers", "dask", "plot", "json", "metric", "map", "csv", "list")
"""Arguments on which no run depends."""


def _question(arguments: argparse.Namespace, bench: Bench) -> dict[str, Any]:
    """Return all that the runs depend on: arguments, the content of files, the version."""
    from fuzzyarm.version import __version__

    words = {
        name: value
        for name, value in vars(arguments).items()
        if name not in NOT_ASKED and not callable(value) and value not in (None, [], False, "")
    }
    return {"fuzzyarm": __version__, "arguments": words, "files": _files(bench, arguments)}


def _files(bench: Bench, arguments: argparse.Namespace) -> dict[str, str]:
    """Return digests of the files that runs depend on, by name."""
    from hashlib import sha256

    from fuzzyarm.controller.on_plant import text_law_of
    from fuzzyarm.controller.text import sheet_path

    paths: dict[str, Path] = {}
    for part in bench.loop.controller.parts():
        law = text_law_of(part)
        if law is not None:
            text = law.text
            if not text.path:
                continue
            paths[Path(text.path).name] = Path(text.path)
            for use in text.model.uses:
                for file in use.files:
                    paths[file] = sheet_path(file, Path(text.path).parent)
        elif hasattr(part, "path"):
            paths[str(part.path)] = Path(part.path)
    given = [arguments.rulebase, arguments.alpha, arguments.performance, *(arguments.table or [])]
    given += [arguments.plant.partition(".py")[0] + ".py", arguments.plant]
    given += [word.partition("=")[2] for word in (*arguments.reference, *arguments.disturb)]
    paths |= {word: Path(word) for word in given if word}
    return {
        name: sha256(path.read_bytes()).hexdigest()[:16]
        for name, path in sorted(paths.items())
        if path.is_file()
    }


# --- The runs ---


def sweep(arguments: argparse.Namespace) -> int:
    """Do what the arguments ask; return the exit status."""
    from fuzzyarm.loop.many import many_of, seeds_of
    from fuzzyarm.loop.metrics import METRICS
    from fuzzyarm.loop.sweep import SweepFile

    _require_sensible(arguments, METRICS)
    asked = read_asked(arguments)
    for note in asked.bench.loop.notes():
        print_error(f"note: {note}")
    axes = _map_axes(arguments, asked)
    bench = asked.bench
    front: dict[str, Any] = {
        name: values for name, values in asked.changes.items() if name != "seed"
    }
    front["seed"] = seeds_of(bench, asked.changes, asked.count)
    file = None
    if arguments.out:
        file = SweepFile(arguments.out, asked.question, front, bench.outputs, bench.column_units)
    answer = _answered(asked, file, arguments)
    faults = list(answer.faults)
    many = many_of(bench, asked.changes, answer.rows)
    if len(many):
        if arguments.json:
            print_json(_as_json(many, asked, arguments))
        else:
            say(*_as_text(many, asked, arguments))
    if arguments.plot and len(many) == asked.count:
        faults += attempted(lambda: _plot(many, asked, axes, arguments))
    for fault in faults:
        print_error(fault)
    if answer.interrupted:
        done = f"{len(many)} of {counted(asked.count, 'run')}"
        kept = "-o keeps them" if file is None else f"{file.path} has them, --resume goes on"
        print_error(f"interrupted after {done}; {kept}")
        return EXIT_INTERRUPTED
    if faults:
        return 1
    return DIVERGED if 0 < len(many) == _lost(many) else 0


def _require_sensible(arguments: argparse.Namespace, metrics: tuple[str, ...]) -> None:
    """Tell mistakes before anything runs."""
    from fuzzyarm.text.names import near_hint

    if arguments.metric not in metrics:
        hint = near_hint(arguments.metric, metrics)[0] or f"one of {', '.join(metrics)}"
        raise WordError(f"no metric '{arguments.metric}'", hint=hint)
    if arguments.resume and not arguments.out:
        raise WordError("--resume goes on with the file of -o, and none is given")
    if arguments.map and not arguments.plot:
        raise WordError("--map is drawn to the file of --plot, and none is given")
    if arguments.workers is not None and not 1 <= arguments.workers <= 10_000:
        raise WordError(f"--workers {arguments.workers} is out of range: 1 to 10000")
    if arguments.plot:
        from fuzzyarm.show.figures.style import require_figure_suffix

        require_figure_suffix(arguments.plot)
    demand_places(arguments.plot)


class _Answer(NamedTuple):
    """The rows of the runs that were made, all or the first ones, and what failed."""

    rows: Vector
    faults: list[str]
    interrupted: bool


def _answered(asked: Asked, file: SweepFile | None, arguments: argparse.Namespace) -> _Answer:
    """Run what is missing. Ctrl-C ends it, and so does a run that fails, with those before it."""
    import numpy as np

    from fuzzyarm.loop.many import check_extremes, stream
    from fuzzyarm.loop.metrics import METRICS

    check_extremes(asked.bench, asked.changes)
    rows = np.empty((asked.count, 1 + len(asked.bench.outputs) * len(METRICS)))
    done, faults, interrupted = 0, list[str](), False
    if file is not None and arguments.resume and file.path.exists():
        known = file.resume()
        done = len(known)
        rows[:done] = known
    elif file is not None:
        file.begin()
    try:
        with (
            announced(f"sweeping {arguments.controller}: {counted(asked.count - done, 'run')}"),
            cluster(arguments) as (executor, workers),
            steps_bar("runs", asked.count, done) as moved,
            closing(
                stream(
                    asked.bench,
                    asked.changes,
                    asked.count,
                    begin=done,
                    executor=executor,
                    workers=workers,
                )
            ) as parts,
        ):
            for first, part in parts:
                rows[first : first + len(part)] = part
                if file is not None and not faults:
                    faults += _appended(file, first, part)
                done = first + len(part)
                moved(done)
    except KeyboardInterrupt:
        interrupted = True
    except (FuzzyarmError, MemoryError) as error:
        if not done:
            raise
        faults.append(sentence_of(error))
    return _Answer(rows[:done], faults, interrupted)


def _appended(file: SweepFile, first: int, part: Vector) -> list[str]:
    """Write rows; where that fails, the runs go on for the report, and the file ends there."""
    try:
        file.append(first, part)
    except OSError as error:
        words = f"the file has the runs before {first}, and --resume goes on from there"
        return [f"{file.path}: {error.strerror or error}; {words}"]
    return []


@contextmanager
def cluster(arguments: argparse.Namespace) -> Iterator[tuple[Executor | None, int | None]]:
    """Connect to a Dask cluster, where one is given."""
    if not arguments.dask:
        yield None, arguments.workers
        return
    demand_extra("distributed", "cluster", "--dask")
    from distributed import Client

    with Client(arguments.dask, timeout="20s", set_as_default=False) as client:
        yield client.get_executor(), arguments.workers or sum(client.ncores().values()) or 1


# --- What came of it ---


def _map_axes(arguments: argparse.Namespace, asked: Asked) -> tuple[str, ...]:
    """Return the one or two names over which a figure is drawn."""
    if not arguments.plot:
        return ()
    names = [interval.name for interval in asked.ranges]
    axes = tuple(names)
    if arguments.map:
        axes = tuple(name.strip() for name in arguments.map.split(","))
    if arguments.random is not None:
        raise WordError("a figure is drawn of a grid, not of --random")
    for name in axes:
        if name not in names:
            raise WordError(f"--map: '{name}' is not swept", hint=f"swept: {', '.join(names)}")
    if arguments.map and len(set(axes)) != 2:
        raise WordError("--map takes two names, as in payload,G_e")
    if len(axes) > 2:
        raise WordError("--map says over which two the figure is drawn", hint=",".join(names[:2]))
    return axes


def _plot(many: Many, asked: Asked, axes: tuple[str, ...], arguments: argparse.Namespace) -> None:
    from fuzzyarm.show.figures import save_figure
    from fuzzyarm.show.figures.sweep import sweep_figure

    ranges = {interval.name: interval for interval in asked.ranges}
    figure = sweep_figure(many, [ranges[name] for name in axes], arguments.metric)
    save_figure(figure, arguments.plot)


def _extremes(many: Many, metric: str) -> Iterator[tuple[str, str, int, int]]:
    """Yield output, unit, and the runs with the smallest and the largest magnitude of a metric."""
    import numpy as np

    values = np.abs(many[metric])
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


def _as_text(many: Many, asked: Asked, arguments: argparse.Namespace) -> list[str]:
    from fuzzyarm.loop.metrics import ERRORS

    lost = _lost(many)
    lines = [
        f"{many.controller} on {many.where}: {counted(len(many), 'run')}, "
        f"{f'{lost} diverged' if lost else 'none diverged'}"
    ]
    metric = arguments.metric
    for output, unit, least, most in _extremes(many, metric):
        lines.append(f"{output}.{metric}, {unit}" if metric in ERRORS else f"{output}.{metric}")
        for word, run in (("least", least), ("most", most)):
            value = float(many[metric][run, many.outputs.index(output)])
            with_what = ", ".join(f"{k} = {v:g}" for k, v in _settings(many, run).items())
            lines.append(f"  {word:<6}{value:>12.4g}  run {run}: {with_what}")
    if arguments.out:
        lines.append(f"wrote {arguments.out}")
    return lines


def _as_json(many: Many, asked: Asked, arguments: argparse.Namespace) -> dict[str, Any]:
    metric = arguments.metric

    found: dict[str, Any] = {
        "controller": many.controller,
        "plant": many.plant,
        "trajectory": many.trajectory,
        "runs": len(many),
        "diverged": _lost(many),
        "sweep": [asdict(interval) for interval in asked.ranges],
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
        "file": arguments.out,
    }
    if not arguments.out:
        columns = many.columns()
        found["columns"] = list(columns)
        found["rows"] = list(zip(*columns.values(), strict=True))
    return found


COMMANDS = (
    command(
        "sweep",
        __doc__,
        sweep,
        argument("controller CONTROLLER", "name, sum or file"),
        *SWEEP,
        *TRAJECTORY,
        *PLANT,
        *SOURCES,
        *RUN,
        *MOTORS,
        *group("output", argument("--plot FIG", "draw the metric over what is swept"), JSON),
    ),
)
