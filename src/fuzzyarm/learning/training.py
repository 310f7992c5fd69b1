"""Training a table that learns: by keywords, or by a request as ``fuzzyarm learn`` has it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TypedDict, Unpack

from fuzzyarm.base.keywords import ArgumentError, demand_alone, demand_arguments
from fuzzyarm.control.controllers.catalogue import (
    CATALOGUE,
    Choice,
    Sources,
    TextEntry,
    text_controller,
)
from fuzzyarm.control.controllers.controller import CompiledController
from fuzzyarm.control.controllers.text import teaching
from fuzzyarm.control.loop.along import FollowedPlant, Schedule, equipped, trajectory_motion, way_of
from fuzzyarm.control.loop.course import Motion, Options
from fuzzyarm.control.loop.experiments import (
    control_tables,
    follows,
    overrides,
    performance_table,
    set_points,
    split_settings,
    with_drives,
    with_plant,
)
from fuzzyarm.control.loop.words import connections, conventions_of
from fuzzyarm.learning.self_organizing import (
    Snapshot,
    Trainee,
    reference_words,
    trained,
    trajectory_words,
)
from fuzzyarm.plant.plant import with_parameters
from fuzzyarm.plant.setting import PLAIN, Conventions
from fuzzyarm.plant.trajectory import Trajectory
from fuzzyarm.requests.fields import RequestError
from fuzzyarm.requests.learn import LearnRequest


class TrainKeywords(TypedDict, total=False):
    """Keywords of `train`.

    Attributes
    ----------
    passes : int
        How often; once by default.
    every : int
        Set points from one snapshot to the next; by default one snapshot for each pass.
    payload, schedule, conventions, options, connect
        See :func:`fuzzyarm.control.loop.simulate`.
    """

    passes: int
    every: int | None
    payload: bool | float
    schedule: Schedule | None
    conventions: Conventions
    options: Options | None
    connect: Mapping[str, str] | None


def train(
    controller: CompiledController | LearnRequest,
    plant: Trajectory | Motion | None = None,
    **keywords: Unpack[TrainKeywords],
) -> Iterator[Snapshot]:
    """Run self-organising control repeatedly; the plant restarts in each pass.

    Parameters
    ----------
    controller : CompiledController or LearnRequest
        Controller of a text with a learning table. A request alone holds all settings of ``fuzzyarm
        learn``.
    plant : Trajectory or Motion, optional
        A trajectory of the arm, or set points of any plant, see
        :func:`fuzzyarm.control.loop.along.trajectory_motion` and
        :func:`fuzzyarm.control.loop.run.plant_motion`.
    **keywords
        ``passes``, ``every``, ``payload``, ``schedule``, ``conventions``, ``options``,
        ``connect``; see :class:`~fuzzyarm.learning.training.TrainKeywords`.

    Yields
    ------
    Snapshot
        The last one of each pass is complete.
    """
    demand_arguments("train", keywords, TrainKeywords, ("controller", "plant"))
    every = keywords.get("every")
    if isinstance(controller, LearnRequest):
        demand_alone("train", plant, {name for name in keywords if name != "every"} or None)
        yield from Training.of(controller).snapshots(every)
        return
    if plant is None:
        raise ArgumentError("train() needs a trajectory or set points", argument="plant")
    conventions, options = keywords.get("conventions", PLAIN), keywords.get("options")
    connect = keywords.get("connect")
    way = way_of(plant)
    if isinstance(way, FollowedPlant):
        assert way.trajectory is not None
        way = trajectory_motion(
            equipped(way.plant, options or Options()),
            way.trajectory,
            controller,
            conventions,
            payload=keywords.get("payload", False),
            schedule=keywords.get("schedule"),
            connect=connect,
        )
    passes = keywords.get("passes", 1)
    yield from trained(controller, way, passes, every, conventions, options, connect)


# --- By a request ---


@dataclass(frozen=True)
class Training:
    """A prepared training.

    Attributes
    ----------
    request : LearnRequest
        With its plant.
    name : str
        Name of the controller.
    trainee : Trainee
        The controller on its plant.
    motion : Motion
        Set points of a pass.
    options : Options
        Sensors, seed and the rest of how to run.
    along : bool
        Whether a trajectory of the plant is followed.
    """

    request: LearnRequest
    name: str
    trainee: Trainee
    motion: Motion
    options: Options
    along: bool

    @classmethod
    def of(cls, request: LearnRequest) -> Training:
        """Return the training of a request."""
        # The two shipped ones differ in how the table begins.
        name = request.controller or ("soc-table" if request.begin == ("table",) else "soc-zero")
        entry = CATALOGUE.get(name)
        path = entry.file() if isinstance(entry, TextEntry) else name
        # Frozen, a table is corrected at the rate 0: everything else runs as in a training.
        change = teaching(0.0 if request.freeze else request.rate, request.delay)
        controller = text_controller(path, Choice(sources=_sources(request)), change=change)
        request, plant = with_plant(request, [controller])
        gains, parameters = split_settings(overrides(request.set), [controller], plant)
        plant = with_parameters(plant, parameters) if parameters else plant
        along = follows(request, plant)
        plant, options = with_drives(request, plant)
        trainee = Trainee(controller.with_gains(gains), plant, connections(request), name)
        count = len(trainee.axes)
        if request.joint is not None and request.joint > count:
            raise RequestError("joint", f"must be 1 to {count}, not {request.joint}")
        motion = set_points(request, trainee.controller, plant)
        return cls(request, name, trainee, motion, options, along)

    def snapshots(self, every: int | None = None) -> Iterator[Snapshot]:
        """Train; see :func:`train`."""
        request = self.request
        return self.trainee.snapshots(
            self.motion, request.passes, every, conventions_of(request), self.options
        )

    def words(self) -> str:
        """Describe the task of the training."""
        request = self.request
        if not self.along:
            plant = Path(request.plant or "").name
            return reference_words(plant, request.reference, request.step or 1.0)
        name, details = request.trajectory or self.motion.name, list[str]()
        if request.way_points:
            name, details = "way points", list(request.way_points)
        elif request.angles is not None:
            details.append("to {:g}° and {:g}°".format(*request.angles))
        if request.segment is not None:
            details.append(f"in {request.segment:g} s")
        payload = bool(request.payload)
        return trajectory_words(name, payload=payload, loaded=request.loaded, details=details)

    def provenance(self, last: Snapshot, *, dated: bool = False) -> dict[str, str]:
        """Return the provenance of a learned table."""
        request = self.request
        start = " ".join(Path(word).name for word in request.begin)
        pairs = self.trainee.provenance(
            self.words(),
            last.passage if last.complete else f"a part of 1, {last.time:.4g} s",
            "" if request.controller and start == "zero" else start,
            Path(request.performance).name if request.performance else "",
            request.conventions,
        )
        if request.controller:
            pairs["controller"] = Path(request.controller).name
        if request.set:
            pairs["gains"] = " ".join(request.set)
        if request.joint:
            pairs["joint"] = str(request.joint)
        if dated:
            pairs["date"] = datetime.now(UTC).date().isoformat()
        return pairs


def _sources(request: LearnRequest) -> Sources:
    table = None
    if request.begin not in (("zero",), ("table",)):
        table = control_tables(request.begin, "--start")
    judge = request.performance
    return Sources(table=table, performance=performance_table(judge) if judge else None)
