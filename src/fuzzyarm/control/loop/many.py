"""Many runs of one experiment, with different gains, plants, loads, noise and seeds.

A run depends on its number and its own values alone, not on the number of workers or the division
into blocks.

To vary something else: ``Bench._owner`` returns the object of a name, and
``Bench.course`` or ``Bench.run`` applies it. Add a line to ``docs/howto/sweeps.md`` and a single
run for comparison to ``tests/loop/test_many.py``. An object without a pickle has a recipe in
``packed`` of :mod:`.blocks`, by text or by name, never by address.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyarm.base.errors import FuzzyarmError, demand_extra
from fuzzyarm.base.keywords import wrong_argument
from fuzzyarm.base.names import near_hint, shortened
from fuzzyarm.base.shown import one_line
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.loop.along import AnyWay, FollowedPlant, equipped, trajectory_motion, way_of
from fuzzyarm.control.loop.blocks import Block, Rows, Workers, in_order, packed, unpacked
from fuzzyarm.control.loop.course import Course, Motion, Options, Sensor
from fuzzyarm.control.loop.metrics import METRICS, Metrics
from fuzzyarm.control.loop.program import LoopProgram, shown_units
from fuzzyarm.control.loop.reference import AnySignal, AnyTime
from fuzzyarm.control.loop.run import (
    ClosedLoop,
    Run,
    judged_names,
    metric_units,
    plant_motion,
    where,
)
from fuzzyarm.plant.equations import begins_by_itself
from fuzzyarm.plant.following import carries, with_load
from fuzzyarm.plant.plant import Plant, parameter, with_parameters
from fuzzyarm.plant.setting import PLAIN, Conventions
from fuzzyarm.requests.bounds import MOST_RUNS

Vector = NDArray[np.float64]

Changes = Mapping[str, Any]
"""The changes of one run, by name: a number, or several for a gain with one for each axis."""

Columns = Mapping[str, Vector]
"""The changes of many runs: one entry or row for each; NaN for a run without a change."""


class SweepError(FuzzyarmError, ValueError):
    """An invalid sweep parameter; `name` is its name."""

    def __init__(self, message: str, *, name: str = "", hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.name = name


# --- Results of many runs ---


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Many:
    """Results of many runs; ``many["rms"]`` is a metric of all of them.

    Attributes
    ----------
    controller, plant, trajectory : str
        Names.
    outputs, units : tuple of str
        Names and units of the measured quantities: axes, or ports if one axis has several.
    changes : mapping of str to ndarray
        The swept values, shape (n,), or (n, k) for k numbers.
    seeds : ndarray of int64, shape (n,)
        Seeds of noise and disturbance.
    diverged : ndarray, shape (n,)
        Time of divergence, s, the end of the metrics; NaN without one.
    values : ndarray, shape (n, outputs, metrics)
        In the order of ``fuzzyarm.control.loop.metrics.METRICS``; NaN for an undefined metric.
    along : bool
        Whether a trajectory of the plant was followed.
    change_units : mapping of str to str
        Units of `changes`, where known.
    """

    controller: str
    plant: str
    trajectory: str
    outputs: tuple[str, ...]
    units: tuple[str, ...]
    changes: Columns
    seeds: NDArray[np.int64]
    diverged: Vector
    values: Vector
    along: bool = False
    change_units: Mapping[str, str] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.diverged)

    def __repr__(self) -> str:
        lost = int(np.isfinite(self.diverged).sum())
        changed = ", ".join(self.changes) or "the seed"
        words = f"{len(self)} runs that differ in {changed}, {lost} diverged"
        return one_line(self, f"{self.controller} on {self.plant}: {words}")

    def __getitem__(self, metric: str) -> Vector:
        """Return a metric of all runs, shape (n, outputs); see :class:`Metrics` for the names."""
        if metric not in METRICS:
            hint = near_hint(metric, METRICS)[0] or f"one of {', '.join(METRICS)}"
            raise SweepError(f"no metric '{metric}'", name=metric, hint=hint)
        return np.asarray(self.values[:, :, METRICS.index(metric)])

    @property
    def where(self) -> str:
        """The task of the runs: the trajectory's name, or references with their plant."""
        return where(self.plant, self.trajectory, along=self.along)

    @property
    def rms(self) -> Vector:
        """Root mean square errors, shape (n, outputs)."""
        return self["rms"]

    @property
    def maximum(self) -> Vector:
        """Largest errors by the conventions, shape (n, outputs)."""
        return self["max"]

    @property
    def final(self) -> Vector:
        """Last errors, shape (n, outputs)."""
        return self["final"]

    def columns(self) -> dict[str, NDArray[Any]]:
        """Return everything by name, shape (n,) each: swept values, seed, divergence, metrics."""
        table: dict[str, NDArray[Any]] = {}
        for name, values in self.changes.items():
            parts = values.reshape(len(self), -1).T
            table |= {part_name(name, i, len(parts)): part for i, part in enumerate(parts)}
        table |= {"seed": self.seeds, "diverged": self.diverged}
        for at, name in enumerate(metric_names(self.outputs)):
            table[name] = self.values.reshape(len(self), -1)[:, at]
        return table

    def frame(self) -> Any:
        """Return the results as a pandas DataFrame with a row for each run."""
        demand_extra("pandas", "data", "a DataFrame")
        import pandas as pd

        return pd.DataFrame(self.columns(), index=pd.RangeIndex(len(self), name="run"))


def part_name(name: str, index: int, count: int) -> str:
    """Return the name of one component of a swept name."""
    return name if count == 1 else f"{name}[{index + 1}]"


def metric_names(outputs: Sequence[str]) -> list[str]:
    """Return the names of all metrics of some outputs, in the order of :attr:`Many.values`."""
    return [f"{output}.{metric}" for output in outputs for metric in METRICS]


# --- The experiment that all runs share ---


@dataclass(frozen=True)
class Experiment:
    """State shared by all runs, see :func:`fuzzyarm.control.loop.simulate_many`; pickled as is."""

    controller: Controller
    on: FollowedPlant | AnyWay
    segments: tuple[int, ...] | None = None
    shared: Changes = field(default_factory=dict)
    conventions: Conventions = PLAIN
    options: Options = field(default_factory=Options)
    references: Mapping[str, AnySignal] | None = None
    duration: AnyTime | None = None
    connect: Mapping[str, str] | None = None

    @property
    def way(self) -> FollowedPlant | Motion:
        """The plant and trajectory, or the set points."""
        if isinstance(self.on, FollowedPlant):
            return self.on
        return way_of(self.on, referred=bool(self.references) or self.duration is not None)


class Bench:
    """An experiment prepared in the process that runs it.

    Parameters
    ----------
    experiment : Experiment
        The state shared by all runs.
    names : sequence of str
        The swept names.

    Raises
    ------
    SweepError
        If a name is unknown.
    """

    def __init__(self, experiment: Experiment, names: Sequence[str]) -> None:
        way = experiment.way
        carrying = (
            isinstance(way, FollowedPlant) and way.trajectory is not None and carries(way.plant)
        )
        if "payload" in names and carrying:
            # Loads are part of every run or of none: a run without one has load 0.
            shared = {"payload": 0.0, **experiment.shared}
            experiment = replace(experiment, shared=shared)
        self.experiment = experiment
        controller = experiment.controller
        conventions, options = experiment.conventions, experiment.options
        if isinstance(way, FollowedPlant):
            way = way._replace(plant=equipped(way.plant, options))
        self.way = way
        if isinstance(way, Motion):
            self.motion = way
        elif way.trajectory is None:
            self.motion = plant_motion(
                controller,
                way.plant,
                experiment.references,
                experiment.duration,
                experiment.connect,
            )
        else:
            self.motion = trajectory_motion(
                way.plant,
                way.trajectory,
                controller,
                conventions,
                payload="payload" in names or bool(experiment.shared.get("payload")),
                segments=experiment.segments,
                connect=experiment.connect,
            )
        # Indices of the loaded plants of the motion.
        self.loaded = self.motion.carrying if carrying else ()
        self.loop = ClosedLoop(controller, self.motion, conventions, options, experiment.connect)
        self.owners = {
            name: self._owner(name) for name in dict.fromkeys([*experiment.shared, *names])
        }
        self.interpreted = threading.Lock()

    @property
    def outputs(self) -> tuple[str, ...]:
        """The measured quantities."""
        tracked = self.motion.tracked
        label = self.loop.site.interface.label
        return judged_names([axis for axis, _ in tracked], list(map(label, tracked)))

    @property
    def units(self) -> tuple[str, ...]:
        """The units of `outputs`."""
        return shown_units(self.loop.course)

    @property
    def change_units(self) -> dict[str, str]:
        """Units of the swept values, by name."""
        return {name: self._unit_of(name) for name in self.owners}

    @property
    def column_units(self) -> dict[str, str]:
        """Units of swept values and all metrics, by name; without dimensionless ones."""
        units = {"diverged": "s", **self.change_units}
        for output, units_by_metric in metric_units(self.loop.course).items():
            units |= {f"{output}.{name}": unit for name, unit in units_by_metric.items()}
        return {name: unit for name, unit in units.items() if unit not in ("", "1")}

    def _unit_of(self, name: str) -> str:
        """Return the unit of a swept name."""
        kind, _, bare = name.partition(".")
        if self.owners[name] == "gain":
            gains = self.loop.controller.gains
            bare = name.rpartition(":")[2]
            units = (gain.unit for key, gain in gains.items() if key.rpartition(":")[2] == bare)
            return next(units, "")
        if self.owners[name] == "parameter":
            return parameter(self.motion.plants[0], name.removeprefix("plant.")).unit
        if self.owners[name] == "sensor":
            interface = self.loop.site.interface
            port = interface.outputs.get(interface.every_port(bare)[0])
            return "s" if kind == "delay" else port.unit if port is not None else ""
        return ""

    # --- Owners of names ---

    def _owner(self, name: str) -> str:
        if name in ("seed", "disturbance"):
            return name
        if name == "payload" and self.loaded:
            if not any(self.loaded):
                message = f"the {self.motion.plants[0].name} carries no load on this trajectory"
                raise SweepError(message, name=name, hint="--loaded selects its segments")
            return name
        kind, dot, port = name.partition(".")
        if dot and kind in SENSOR_FIELDS:
            self.loop.site.interface.every_port(port)  # raises if unknown
            return "sensor"
        controller, plant = self.experiment.controller, self.motion.plants[0]
        owner = owner_of(name, [controller], plant)
        if owner is None:
            others = ["seed", *(["payload"] if carries(plant) else []), "noise.PORT"]
            message, hint = unknown_setting(name, [controller], plant, others)
            raise SweepError(message, name=name, hint=hint)
        return owner

    def _of(self, owner: str, changes: Changes) -> dict[str, Any]:
        return {name: value for name, value in changes.items() if self.owners[name] == owner}

    # --- Runs ---

    def run(self, index: int, changes: Changes) -> Run:
        """Run once with changes to the experiment."""
        return self.loop.run(*self._changed(index, changes))

    def _changed(self, index: int, changes: Changes) -> tuple[LoopProgram | None, Course, int]:
        """Return program, course and seed of a run."""
        changes = {**self.experiment.shared, **changes}
        gains = self._of("gain", changes)
        program = None
        if gains:
            gain_values = {name: np.atleast_1d(value).tolist() for name, value in gains.items()}
            program = self.loop.program_with(gain_values)
        seed = int(changes.get("seed", self.experiment.options.seed + index))
        return program, self.course(changes), seed

    def course(self, changes: Changes) -> Course:
        """Return the experiment with changes of plants, sensors and disturbances."""
        course = self.loop.course
        plants = self._plants(changes)
        if plants is not None:
            course = course.with_plants(replace(self.motion, plants=plants))
        sensors = self._of("sensor", changes)
        if sensors or "disturbance" in changes:
            options: dict[str, Any] = {}
            if "disturbance" in changes:
                options["disturbance"] = float(changes["disturbance"])
            if sensors:
                options["sensors"] = changed_sensors(course.options.sensors, sensors)
            course = course.with_options(replace(course.options, **options))
        return course

    def _plants(self, changes: Changes) -> tuple[Plant, ...] | None:
        parameters = {
            name.removeprefix("plant."): float(value)
            for name, value in self._of("parameter", changes).items()
        }
        if not parameters and "payload" not in changes:
            return None
        plants: Sequence[Plant] = self.motion.plants
        if self.loaded:
            assert isinstance(self.way, FollowedPlant)
            share, bare = float(changes.get("payload", 1.0)), self.way.plant
            plants = [with_load(bare, share) if loaded else bare for loaded in self.loaded]
        # Parameters set in a run hold for the loaded plant, too.
        return tuple(with_parameters(plant, parameters) for plant in plants)

    def rows(
        self, first: int, changes: Columns, count: int, stop: threading.Event | None = None
    ) -> Block:
        """Run a block."""
        begin = time.perf_counter()
        rows = np.full((count, 1 + len(self.outputs) * len(METRICS)), np.nan)
        for at in range(count):
            if stop is not None and stop.is_set():
                return rows[:at], 0.0
            row_changes = {name: values[at] for name, values in changes.items()}
            metrics, diverged = self.one(first + at, row_changes)
            if diverged is not None:
                rows[at, 0] = diverged
            metric_values = [vars(metric).values() for metric in metrics.values()]
            rows[at, 1:] = [
                np.nan if value is None else value for row in metric_values for value in row
            ]
        return rows, time.perf_counter() - begin

    def one(self, index: int, values: Mapping[str, Any]) -> tuple[dict[str, Metrics], float | None]:
        """Run once with an entry of each column; return metrics and the time of divergence.

        NaN entries change nothing.
        """
        changes = {name: value for name, value in values.items() if not np.isnan(value).any()}
        try:
            if self.loop.compiled and not begins_by_itself(self.loop.course.plant):
                return self.loop.measured(*self._changed(index, changes))
            with self.interpreted:  # user code may have state
                return self.loop.measured(*self._changed(index, changes))
        except FuzzyarmError as error:
            error.at(f"run {index}")
            raise


SENSOR_FIELDS = ("noise", "resolution", "delay")
"""Fields of a sensor that ``noise.position`` and the like change."""


def changed_sensors(sensors: Mapping[str, Sensor], values: Changes) -> dict[str, Sensor]:
    """Return sensors with some fields replaced."""
    result = dict(sensors)
    for name, value in values.items():
        kind, _, port = name.partition(".")
        result[port] = replace(result.get(port, Sensor()), **{kind: float(value)})
    return result


def owner_of(name: str, controllers: Sequence[Controller], plant: Plant) -> str | None:
    """Return the owner of a name: ``gain`` of a controller, or ``parameter`` of the plant.

    A name of both is the controller's; ``plant.NAME`` is the plant's. A sum also has
    ``ADDEND:NAME``. None if the name is unknown.
    """
    gains = [gain for controller in controllers for gain in controller.gains]
    if name in gains or any(gain.rpartition(":")[2] == name for gain in gains):
        return "gain"
    if name.removeprefix("plant.") in plant.parameters:
        return "parameter"
    if ":" in name and name.rpartition(":")[2] in {gain.rpartition(":")[2] for gain in gains}:
        return "gain"
    return None


def unknown_setting(
    name: str, controllers: Sequence[Controller], plant: Plant, others: Iterable[str] = ()
) -> tuple[str, str]:
    """Return message and hint for a name that is neither a gain nor a parameter."""
    gains = dict.fromkeys(gain for controller in controllers for gain in controller.gains)
    names = [*gains, *plant.parameters, *others]
    owners = ", ".join(controller.name for controller in controllers)
    hint = near_hint(name, names)[0] or (f"there are {', '.join(names)}" if names else "")
    return f"neither {owners} nor {plant.name} has '{name}'", hint


# --- Runs as columns ---


def columns_of(runs: Sequence[Changes] | Mapping[str, ArrayLike]) -> tuple[dict[str, Vector], int]:
    """Return the changes as arrays, and the number of runs."""
    if isinstance(runs, Mapping):
        columns = {name: np.atleast_1d(_numbers(name, values)) for name, values in runs.items()}
        counts = {name: len(values) for name, values in columns.items()}
        if len(set(counts.values())) > 1:
            text = ", ".join(f"{count} of {name}" for name, count in counts.items())
            raise SweepError(f"the runs do not match: {text}")
        count = next(iter(counts.values()), 0)
    else:
        if not isinstance(runs, Sequence) or not all(isinstance(run, Mapping) for run in runs):
            expected = "a list of mappings or a mapping of lists"
            raise wrong_argument("simulate_many", "runs", expected, runs)
        count = len(runs)
        names = dict.fromkeys(name for run in runs for name in run)
        columns = {name: _column(name, runs) for name in names}
    if not 1 <= count <= MOST_RUNS:
        raise SweepError(f"{count:,} runs are out of range", hint=f"1 to {MOST_RUNS:,}")
    for name, values in columns.items():
        if np.isinf(values).any():
            raise SweepError(f"'{name}' is infinite in a run", name=name)
    return columns, count


def _numbers(name: str, values: ArrayLike) -> Vector:
    """Return the values of a swept name as numbers."""
    try:
        return np.asarray(values, np.float64)
    except (TypeError, ValueError):
        message = f"'{name}' is not a number in a run: {shortened(repr(values))}"
        raise SweepError(message, name=name) from None


def _column(name: str, runs: Sequence[Changes]) -> Vector:
    width = max(np.size(run[name]) for run in runs if name in run)
    column = np.full((len(runs), width), np.nan)
    for at, run in enumerate(runs):
        if name in run:
            column[at] = _numbers(name, run[name])
    return column[:, 0] if width == 1 else column


# --- Results ---


def many_of(bench: Bench, changes: Columns, rows: Rows) -> Many:
    """Return the results of the first runs from their rows."""
    loop, count = bench.loop, len(rows)
    return Many(
        controller=loop.controller.name,
        plant=loop.course.plant.name,
        trajectory=bench.motion.name,
        outputs=bench.outputs,
        units=bench.units,
        changes={name: values[:count] for name, values in changes.items() if name != "seed"},
        seeds=seeds_of(bench, changes, count),
        diverged=rows[:, 0],
        values=rows[:, 1:].reshape(count, len(bench.outputs), len(METRICS)),
        along=bench.motion.along,
        change_units=bench.change_units,
    )


def seeds_of(bench: Bench, changes: Columns, count: int) -> NDArray[np.int64]:
    """Return the seeds of the first runs."""
    values = np.arange(count, dtype=np.int64) + bench.experiment.options.seed
    if "seed" in bench.experiment.shared:
        values[:] = int(bench.experiment.shared["seed"])
    if "seed" in changes:
        seeds = changes["seed"][:count]
        is_given = ~np.isnan(seeds)
        values[is_given] = seeds[is_given].astype(np.int64)
    return values


def stream(
    bench: Bench,
    changes: Columns,
    count: int,
    *,
    begin: int = 0,
    executor: Executor | None = None,
    workers: int | None = None,
) -> Generator[tuple[int, Rows], None, None]:
    """Yield the rows of runs in their order, a block at a time.

    A row has the time of divergence, then the metrics of each output. Closing the iterator stops
    the runs.
    """
    check_extremes(bench, changes)
    threads = bench.loop.compiled or (executor is None and workers == 1)
    with Workers(workers, executor, threads=threads) as crew:
        stop = threading.Event()
        if executor is None and not threads:
            # The first runs here, until processes are worth starting.
            for rows in _begun_here(bench, changes, begin, count):
                yield begin, rows
                begin += len(rows)
        travels = begin < count and not crew.in_threads
        question = packed((bench.experiment, tuple(changes))) if travels else b""

        def submit(first: int, last: int) -> Future[Block]:
            part = first, cut(changes, first, last), last - first
            if crew.in_threads:
                return crew.submit(bench.rows, *part, stop)
            return crew.submit(run_block, question, *part)

        try:
            yield from in_order(submit, begin, count, crew.count)
        finally:
            stop.set()


def check_extremes(bench: Bench, changes: Columns) -> None:
    """Try the smallest and the largest value of every name, to show mistakes at once."""
    shared = bench.experiment.shared
    for name, values in changes.items():
        values_given = values[~np.isnan(values).reshape(len(values), -1).any(axis=1)]
        if name == "seed" and len(values_given) and values_given.min() < 0.0:
            message = f"a seed of {values_given.min():g} is out of range"
            raise SweepError(message, name=name, hint="0 or more")
        for extreme in (
            (values_given.min(axis=0), values_given.max(axis=0)) if len(values_given) else ()
        ):
            changed = {**shared, name: extreme}
            if bench.owners[name] == "gain":
                bench.loop.program_with({name: np.atleast_1d(extreme).tolist()})
            else:
                bench.course(changed)


WORTH = 3.0
"""Shorter sweeps, s, end before worker processes have started."""


def _begun_here(bench: Bench, changes: Columns, begin: int, count: int) -> Iterator[Rows]:
    """Yield the rows of single runs, until the rest would take long."""
    while begin < count:
        rows, seconds = bench.rows(begin, cut(changes, begin, begin + 1), 1)
        begin += 1
        yield rows
        if seconds * (count - begin) > WORTH:
            break


def cut(changes: Columns, first: int, last: int) -> dict[str, Vector]:
    """Return the columns of some runs."""
    return {name: values[first:last] for name, values in changes.items()}


def run_block(question: bytes, first: int, changes: Columns, count: int) -> Block:
    """Run a block in any process."""
    return _bench_of(question).rows(first, changes, count)


@lru_cache(maxsize=4)
def _bench_of(question: bytes) -> Bench:
    return Bench(*unpacked(question))
