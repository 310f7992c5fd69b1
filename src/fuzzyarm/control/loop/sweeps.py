"""A sweep from its request to its runs: swept values, journal, workers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError, UsageError, WordError, demand_extra, sentence_of
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.on_plant import text_law_of
from fuzzyarm.control.controllers.text import files_of
from fuzzyarm.control.loop.along import FollowedPlant
from fuzzyarm.control.loop.experiments import (
    controllers_of,
    files_named,
    follows,
    trajectory_of_request,
    with_drives,
    with_plant,
    with_settings,
)
from fuzzyarm.control.loop.many import (
    Bench,
    Experiment,
    Many,
    Vector,
    check_extremes,
    many_of,
    seeds_of,
    stream,
)
from fuzzyarm.control.loop.metrics import METRICS
from fuzzyarm.control.loop.sweep import Range, SweepFile, drawn, grid, read_range, whole
from fuzzyarm.control.loop.words import connections, conventions_of, motion_of
from fuzzyarm.requests.bounds import MOST_RUNS
from fuzzyarm.requests.fields import unknown_choice
from fuzzyarm.requests.journal import question_of
from fuzzyarm.requests.runs import SweepRequest, Workers


@dataclass(frozen=True)
class Sweep:
    """A prepared sweep: the bench, the swept values, and all that determines the results."""

    bench: Bench
    ranges: tuple[Range, ...]
    changes: Mapping[str, Vector]
    count: int
    question: Mapping[str, Any]

    def file(self, path: str) -> SweepFile:
        """Return the journal of the sweep."""
        front: dict[str, Any] = {
            name: values for name, values in self.changes.items() if name != "seed"
        }
        front["seed"] = seeds_of(self.bench, self.changes, self.count)
        return SweepFile(path, self.question, front, self.bench.outputs, self.bench.column_units)


def sweep_of(request: SweepRequest, controller: Controller | None = None) -> Sweep:
    """Return the sweep of a request; `controller` replaces the one it names."""
    require_sensible(request)
    if controller is None:
        (controller,) = controllers_of(request, [request.controller])
    request, plant = with_plant(request, [controller])
    (controller,), plant = with_settings(request, [controller], plant)
    along = follows(request, plant)
    plant, options = with_drives(request, plant)
    shared: dict[str, float] = {}
    on: Any
    if along:
        trajectory = trajectory_of_request(request, plant)
        if not request.way_points:
            request = request.replaced(
                trajectory=request.trajectory or next(iter(plant.trajectories))
            )
        on = FollowedPlant(plant, trajectory)
        if request.payload or request.loaded:
            shared["payload"] = 1.0
    else:
        on = motion_of(request, controller, plant)
    ranges, changes, count = _ranges(request)
    experiment = Experiment(
        controller,
        on,
        request.loaded or None,
        shared,
        conventions_of(request),
        options,
        connect=connections(request),
    )
    bench = Bench(experiment, list(changes))
    files = files_named(request) | _files_of_controller(bench)
    return Sweep(bench, ranges, changes, count, question_of(request.question(), files))


def require_sensible(request: SweepRequest) -> None:
    """Raise for mistakes that show before anything is loaded."""
    if request.metric not in METRICS:
        raise unknown_choice("metric", request.metric, METRICS)
    if request.resume and not request.out:
        raise UsageError("--resume needs the file of -o")


def map_axes(request: SweepRequest, sweep: Sweep) -> tuple[Range, ...]:
    """Return the one or two ranges of a picture."""
    ranges = {interval.name: interval for interval in sweep.ranges}
    names = [name.strip() for name in request.map.split(",")] if request.map else list(ranges)
    if request.random is not None:
        raise UsageError("a figure is drawn of a grid, not of --random")
    for name in names:
        if name not in ranges:
            raise UsageError(f"--map: '{name}' is not swept", hint=f"swept: {', '.join(ranges)}")
    if request.map and len(set(names)) != 2:
        raise UsageError("--map takes two names, as in payload,G_e")
    if len(names) > 2:
        raise UsageError("--map selects the two of the figure", hint=",".join(names[:2]))
    return tuple(ranges[name] for name in names)


def _ranges(request: SweepRequest) -> tuple[tuple[Range, ...], dict[str, Vector], int]:
    ranges = tuple(map(read_range, request.sweep))
    if request.random is not None:
        return ranges, whole(drawn(ranges, request.random, request.seed)), request.random
    if not ranges:
        raise UsageError("nothing is swept", hint="--sweep NAME=A..B:N, or --random N")
    count = math.prod(interval.count or 1 for interval in ranges)
    if count > MOST_RUNS:
        raise WordError(f"a grid of {count:,} runs is out of range: up to {MOST_RUNS:,}")
    return ranges, whole(grid(ranges)), count


def _files_of_controller(bench: Bench) -> dict[str, Path]:
    """Return the files of a controller, by name."""
    paths: dict[str, Path] = {}
    for part in bench.loop.controller.parts():
        law = text_law_of(part)
        if law is not None:
            paths |= files_of(law.text.model, law.text.path)
        elif hasattr(part, "path"):
            paths[str(part.path)] = Path(part.path)
    return paths


# --- The runs ---


class Answer(NamedTuple):
    """The rows of completed runs, all or the first ones, and the failures."""

    rows: Vector
    faults: list[str]
    interrupted: bool


def answered(
    sweep: Sweep,
    file: SweepFile | None,
    request: SweepRequest,
    executor: Executor | None,
    moved: Callable[[int], None] = lambda _done: None,
) -> Answer:
    """Run the missing runs. Ctrl-C or a failing run stops it, keeping the runs before.

    Parameters
    ----------
    sweep : Sweep
        The sweep.
    file : SweepFile or None
        Its journal.
    request : SweepRequest
        Supplies resumption and number of workers.
    executor : Executor or None
        See :func:`fuzzyarm.control.loop.simulate_many`.
    moved : callable, optional
        Called with the number of completed runs.
    """
    check_extremes(sweep.bench, sweep.changes)
    rows = np.empty((sweep.count, 1 + len(sweep.bench.outputs) * len(METRICS)))
    count, faults, interrupted = begun(file, rows, resume=request.resume), list[str](), False
    runs = stream(
        sweep.bench, sweep.changes, sweep.count, begin=count, executor=executor,
        workers=request.workers,
    )  # fmt: skip
    try:
        with closing(runs) as parts:
            for first, part in parts:
                rows[first : first + len(part)] = part
                # After a failed write the file would have a gap.
                if file is not None and not faults:
                    faults += _appended(file, first, part)
                count = first + len(part)
                moved(count)
    except KeyboardInterrupt:
        interrupted = True
    except (FuzzyarmError, MemoryError) as error:
        # Nothing computed: nothing to keep.
        if not count:
            raise
        faults.append(sentence_of(error))
    finally:
        if file is not None:
            file.close()
    return Answer(rows[:count], faults, interrupted)


def begun(file: SweepFile | None, rows: Vector, *, resume: bool) -> int:
    """Begin the file, or resume it: fill in its rows, and return their number."""
    if file is None:
        return 0
    if not (resume and file.path.exists()):
        file.begin()
        return 0
    earlier = file.resume()
    rows[: len(earlier)] = earlier
    return len(earlier)


def _appended(file: SweepFile, first: int, part: Vector) -> list[str]:
    """Append rows; after a failed write the runs go on for the report, but the file ends."""
    try:
        file.append(first, part)
    except OSError as error:
        words = f"the file has the runs before {first}, and --resume continues from there"
        return [f"{file.path}: {error.strerror or error}; {words}"]
    return []


@contextmanager
def cluster(workers: Workers) -> Iterator[tuple[Executor | None, int | None]]:
    """Connect to a Dask cluster, if given; yield it and the number of workers."""
    if not workers.dask:
        yield None, workers.workers
        return
    demand_extra("distributed", "cluster", "--dask")
    from distributed import Client

    with Client(workers.dask, timeout="20s", set_as_default=False) as client:
        yield client.get_executor(), workers.workers or sum(client.ncores().values()) or 1


def swept(request: SweepRequest) -> Many:
    """Return the runs of a request; a file records them, too."""
    sweep = sweep_of(request)
    file = sweep.file(request.out) if request.out else None
    with cluster(request) as (executor, workers):
        answer = answered(sweep, file, request.replaced(workers=workers), executor)
    if answer.interrupted:
        raise KeyboardInterrupt
    if answer.faults:
        raise SweepFaultError(answer.faults[0])
    return many_of(sweep.bench, sweep.changes, answer.rows)


class SweepFaultError(FuzzyarmError, RuntimeError):
    """A sweep that ended early, or whose file was not written."""
