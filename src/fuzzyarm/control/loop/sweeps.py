"""A sweep from its request to its runs: swept values, journal, workers."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
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
    owner_of,
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
    """A prepared sweep: benches, swept values, and all that determines the results.

    Each controller has a bench. Runs are numbered one controller after the other.
    """

    benches: tuple[Bench, ...]
    ranges: tuple[Range, ...]
    changes: Mapping[str, Vector]
    each: int
    """Runs of each controller."""
    question: Mapping[str, Any]

    @property
    def count(self) -> int:
        """Number of runs of all controllers."""
        return self.each * len(self.benches)

    @property
    def width(self) -> int:
        """Numbers in a row: the time of divergence, and the metrics of each output."""
        return 1 + len(self.benches[0].outputs) * len(METRICS)

    def changes_of(self, bench: Bench) -> dict[str, Vector]:
        """Return the swept values of a controller, without gains of the others."""
        return {name: values for name, values in self.changes.items() if name in bench.owners}

    def file(self, path: str) -> SweepFile:
        """Return the journal of the sweep; of several controllers it begins with the controller."""
        bench, several = self.benches[0], len(self.benches)
        front: dict[str, Any] = {
            name: np.tile(values, several)
            for name, values in self.changes.items()
            if name != "seed"
        }
        front["seed"] = np.tile(seeds_of(bench, self.changes, self.each), several)
        if several > 1:
            names = [each.loop.controller.name for each in self.benches]
            front = {"controller": np.repeat(names, self.each), **front}
        return SweepFile(path, self.question, front, bench.outputs, bench.column_units)

    def results(self, rows: Vector) -> list[Many]:
        """Return the results of the first runs.

        Of a single controller these runs, of several a record for each complete one.
        """
        if len(self.benches) == 1:
            return [many_of(self.benches[0], self.changes, rows)] if len(rows) else []
        begins = range(0, len(rows) - self.each + 1, self.each)
        return [
            many_of(bench, self.changes, rows[begin : begin + self.each])
            for bench, begin in zip(self.benches, begins, strict=False)
        ]


def sweep_of(request: SweepRequest, controllers: Sequence[Controller] = ()) -> Sweep:
    """Return the sweep of a request; `controllers` replace those it names."""
    require_sensible(request)
    request = _with_ranges(request)
    laws = list(controllers) or controllers_of(request, [request.controller, *request.against])
    request, plant = with_plant(request, laws)
    laws, plant = with_settings(request, laws, plant)
    along = follows(request, plant)
    plant, options = with_drives(request, plant)
    shared: dict[str, float] = {}
    on: FollowedPlant | None = None
    if along:
        trajectory = trajectory_of_request(request, plant)
        if not request.way_points:
            request = request.replaced(
                trajectory=request.trajectory or next(iter(plant.trajectories))
            )
        on = FollowedPlant(plant, trajectory)
        if request.payload or request.loaded:
            shared["payload"] = 1.0
    ranges, changes, count = _ranges(request, len(laws))
    gains = {name for name in changes if owner_of(name, laws, plant) == "gain"}
    benches = []
    files = files_named(request)
    for law in laws:
        experiment = Experiment(
            law,
            on or motion_of(request, law, plant),
            request.loaded or None,
            shared,
            conventions_of(request),
            options,
            connect=connections(request),
        )
        lacked = {name for name in gains if owner_of(name, [law], plant) != "gain"}
        benches.append(Bench(experiment, [name for name in changes if name not in lacked]))
        files |= _files_of_controller(benches[-1])
    _require_comparable(benches)
    question = question_of(request.question(), files)
    return Sweep(tuple(benches), ranges, changes, count, question)


def _with_ranges(request: SweepRequest) -> SweepRequest:
    """Return a request with ``--set NAME=A..B:N`` as a range."""
    ranges = tuple(word for word in request.set if ".." in word)
    settings = tuple(word for word in request.set if ".." not in word)
    return request.replaced(sweep=(*request.sweep, *ranges), set=settings)


def _require_comparable(benches: Sequence[Bench]) -> None:
    """Raise WordError for controllers of different references or judged outputs."""
    first, *others = benches
    for other in others:
        tasks = {bench.loop.controller.name: _task(bench) for bench in (first, other)}
        if _task(first) != _task(other):
            words = [
                f"{name} {task}, judged by {outputs}" for name, (task, outputs) in tasks.items()
            ]
            message = f"the controllers have different tasks: {'; '.join(words)}"
            raise WordError(message, hint="--reference PORT=SIGNAL gives all of them one")


def _task(bench: Bench) -> tuple[str, str]:
    """Return the references of a controller, and its judged outputs."""
    outputs = zip(bench.outputs, bench.units, strict=True)
    return bench.motion.name, " and ".join(f"{name} in {unit}" for name, unit in outputs)


def require_sensible(request: SweepRequest) -> None:
    """Raise an error for mistakes that show before anything is loaded."""
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


def _ranges(
    request: SweepRequest, controllers: int
) -> tuple[tuple[Range, ...], dict[str, Vector], int]:
    ranges = tuple(map(read_range, request.sweep))
    if request.random is not None:
        return ranges, whole(drawn(ranges, request.random, request.seed)), request.random
    if not ranges:
        raise UsageError("nothing is swept", hint="--sweep NAME=A..B:N, or --random N")
    count = math.prod(interval.count or 1 for interval in ranges)
    if count * controllers > MOST_RUNS:
        message = f"a grid of {count * controllers:,} runs is out of range: up to {MOST_RUNS:,}"
        raise WordError(message)
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
    """Execute the missing runs. Ctrl-C or a failing run stops it, keeping the runs before.

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
    for bench in sweep.benches:
        check_extremes(bench, sweep.changes_of(bench))
    rows = np.empty((sweep.count, sweep.width))
    count, faults, interrupted = begun(file, rows, resume=request.resume), list[str](), False
    try:
        with closing(_streamed(sweep, count, executor, request.workers)) as parts:
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
        # No result: no file to keep.
        if not count:
            raise
        faults.append(sentence_of(error))
    finally:
        if file is not None:
            file.close()
    return Answer(rows[:count], faults, interrupted)


def _streamed(
    sweep: Sweep, begin: int, executor: Executor | None, workers: int | None
) -> Generator[tuple[int, Vector], None, None]:
    """Yield the rows of the runs from `begin` on, one controller after the other."""
    for number, bench in enumerate(sweep.benches):
        before = number * sweep.each
        if begin >= before + sweep.each:
            continue
        runs = stream(
            bench, sweep.changes_of(bench), sweep.each, begin=max(0, begin - before),
            executor=executor, workers=workers,
        )  # fmt: skip
        with closing(runs) as parts:
            for first, rows in parts:
                yield before + first, rows


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
    """Append rows; after a failed write the runs continue for the report, but the file ends."""
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


def swept(request: SweepRequest) -> list[Many]:
    """Return the runs of each controller of a request; a file records them, too."""
    sweep = sweep_of(request)
    file = sweep.file(request.out) if request.out else None
    with cluster(request) as (executor, workers):
        answer = answered(sweep, file, request.replaced(workers=workers), executor)
    if answer.interrupted:
        raise KeyboardInterrupt
    if answer.faults:
        raise SweepFaultError(answer.faults[0])
    return sweep.results(answer.rows)


class SweepFaultError(FuzzyarmError, RuntimeError):
    """A sweep that ended early, or whose file was not written."""
