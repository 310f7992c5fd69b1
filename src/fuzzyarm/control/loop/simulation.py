"""Python calls for one run and for many, by keywords or by a request."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing
from typing import TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike

from fuzzyarm.base.keywords import demand_alone, demand_arguments
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.findings import site_for
from fuzzyarm.control.loop.along import (
    AnyWay,
    FollowedPlant,
    Schedule,
    equipped,
    trajectory_motion,
    way_of,
)
from fuzzyarm.control.loop.course import Motion, Options
from fuzzyarm.control.loop.experiments import (
    controllers_of,
    follows,
    set_points,
    with_drives,
    with_plant,
    with_settings,
)
from fuzzyarm.control.loop.many import Bench, Changes, Experiment, Many, columns_of, many_of, stream
from fuzzyarm.control.loop.metrics import METRICS
from fuzzyarm.control.loop.reference import AnySignal, AnyTime
from fuzzyarm.control.loop.run import (
    AnyController,
    Run,
    as_controller,
    plant_motion,
    run_along,
    stepped,
    with_gains,
)
from fuzzyarm.control.loop.sweeps import swept
from fuzzyarm.control.loop.words import connections, conventions_of
from fuzzyarm.plant.plant import Plant
from fuzzyarm.plant.setting import PLAIN, Conventions
from fuzzyarm.plant.trajectory import Trajectory
from fuzzyarm.requests.experiment import ExperimentRequest
from fuzzyarm.requests.fields import RequestError, read_fields
from fuzzyarm.requests.runs import SimulateRequest, SweepRequest


class RunKeywords(TypedDict, total=False):
    """Keywords of `simulate`.

    Attributes
    ----------
    trajectory : Trajectory or str
        A trajectory of the plant, or its name.
    payload : bool or float
        Whether the plant carries the load of the trajectory, or the share of it.
    schedule : sequence of mapping
        Plant parameters of each segment, in place of its load.
    conventions : Conventions
        Precision, π, timing.
    options : Options
        Sensors, disturbances, limits, integrator.
    reference : mapping of str to Signal, str or float
        Signals of a plant by port: a signal, its words, as in ``"step:1"`` or ``"sine:0.5,2"``,
        or the height of a step. By default the first output steps to 1.
    step : float
        Height of the step of the first reference, in place of `reference`.
    duration : float or str
        Duration of a run, s, or with its unit, as in ``"300ms"``; by default the plant's own.
    connect : mapping of str to str
        From names of the controller to ports of the plant, if they differ.
    gains : mapping of str to float or sequence of float
        Gains that replace the controller's: a number, or one for each axis.
    """

    trajectory: Trajectory | str | None
    payload: bool | float
    schedule: Schedule | None
    conventions: Conventions
    options: Options | None
    reference: Mapping[str, AnySignal] | None
    step: float | None
    duration: AnyTime | None
    connect: Mapping[str, str] | None
    gains: Mapping[str, float | Sequence[float]] | None


def simulate(
    controller: AnyController | SimulateRequest,
    plant: AnyWay | None = None,
    **keywords: Unpack[RunKeywords],
) -> Run:
    """Run a controller on a plant, along a trajectory or references.

    Parameters
    ----------
    controller : Controller, ControllerText, str, path-like or SimulateRequest
        Its ports must be those of the plant; laws of the study need those of the arm. Sums of
        compiled ones run as machine code. A string is a name of the catalogue or a file. A request
        alone holds every setting of ``fuzzyarm simulate``.
    plant : Plant, Trajectory, Motion, str or path-like, optional
        The plant; a trajectory of the arm; or set points made before. A string is the name or file
        of a plant, which by default follows its first trajectory, if any. By default the
        shipped plant with the axes of the controller.
    **keywords
        ``trajectory``, ``payload``, ``schedule``, ``conventions``, ``options``, ``reference``,
        ``step``, ``duration``, ``connect``, ``gains``; see :class:`RunKeywords`.

    Returns
    -------
    Run
        The result, diverged or not.

    Raises
    ------
    ArmError
        If an angle, a time or a schedule does not fit the trajectory.
    PlantError
        If the plant lacks a port, or cannot be run.
    SourceError
        If the plant lacks a port that the controller measures or drives.
    WordError
        If the words for a reference or a time are invalid.

    Examples
    --------
    >>> from fuzzyarm import shipped
    >>> servo = shipped("servo.frb")
    >>> simulate(servo, "motor", reference={"position": "step:1"}, duration="300ms")
    <Run servo on motor: 0.3 s, rms position 27.09 degrees>
    """
    demand_arguments("simulate", keywords, RunKeywords, ("controller", "plant"))
    if isinstance(controller, SimulateRequest):
        demand_alone("simulate", plant, keywords)
        return run_of(controller)
    options, connect = keywords.get("options") or Options(), keywords.get("connect")
    conventions = keywords.get("conventions", PLAIN)
    law = with_gains(as_controller(controller), keywords.get("gains"))
    way, reference = _followed(law, plant, keywords)
    if isinstance(way, FollowedPlant):
        home = equipped(way.plant, options)
        if way.trajectory is None:
            way = plant_motion(law, home, reference, keywords.get("duration"), connect)
        else:
            way = trajectory_motion(
                home,
                way.trajectory,
                law,
                conventions,
                payload=keywords.get("payload", False),
                schedule=keywords.get("schedule"),
                connect=connect,
            )
    return run_along(law, way, conventions, options, connect)


def _followed(
    chosen: Controller, plant: AnyWay | None, keywords: RunKeywords | ManyKeywords
) -> tuple[FollowedPlant | Motion, Mapping[str, AnySignal] | None]:
    """Return the followed plant or motion, and its references, if any."""
    connect = keywords.get("connect")
    reference, step = keywords.get("reference"), keywords.get("step")
    referred = bool(reference) or step is not None or keywords.get("duration") is not None
    place = site_for(chosen, connect).name if plant is None else plant
    way = way_of(place, keywords.get("trajectory"), referred=referred)
    if step is not None and isinstance(way, FollowedPlant):
        reference = stepped(chosen, way.plant, step, reference, connect)
    return way, reference


def run_of(request: SimulateRequest) -> Run:
    """Return the run of a request with one controller."""
    if len(request.controller) != 1:
        raise RequestError("controller", f"must have 1 value here, not {len(request.controller)}")
    controllers = controllers_of(request, request.controller)
    request, plant = with_plant(request, controllers)
    (controller,), plant = with_settings(request, controllers, plant)
    return run_on(request, controller, plant)


def run_on(request: SimulateRequest, controller: Controller, plant: Plant) -> Run:
    """Return the run of a controller with its gains on a plant with its parameters."""
    motion, options = experiment_on(request, controller, plant)
    return run_along(controller, motion, conventions_of(request), options, connections(request))


def experiment_on(
    request: ExperimentRequest, controller: Controller, plant: Plant
) -> tuple[Motion, Options]:
    """Return set points and options of a run; settings unknown to the plant raise."""
    # Called for its errors: options unknown to the plant.
    follows(request, plant)
    plant, options = with_drives(request, plant)
    return set_points(request, controller, plant), options


# --- Many runs ---


class ManyKeywords(TypedDict, total=False):
    """Keywords of `simulate_many`.

    Attributes
    ----------
    executor : Executor
        An executor of :mod:`concurrent.futures`, loky, Dask (``client.get_executor()``) or mpi4py.
    workers : int
        Number of runs at a time: by default one for each processor, or the number of workers of
        `executor`.
    trajectory : Trajectory or str
        See :class:`RunKeywords`.
    payload : bool or float
        The load of runs without one of their own.
    segments : sequence of int
        Segments with the load, counted from 1; by default those of the trajectory.
    shared : dict
        Changes common to all runs.
    conventions, options, reference, step, duration, connect
        See :class:`RunKeywords`. Run i has the seed of `options` plus i unless it has its own.
    watch : callable
        Called with the number of completed runs.
    """

    executor: Executor | None
    workers: int | None
    trajectory: Trajectory | str | None
    payload: bool | float
    segments: Sequence[int] | None
    shared: Changes | None
    conventions: Conventions
    options: Options | None
    reference: Mapping[str, AnySignal] | None
    step: float | None
    duration: AnyTime | None
    connect: Mapping[str, str] | None
    watch: Callable[[int], None] | None


def simulate_many(
    controller: AnyController | SweepRequest,
    plant: AnyWay | None = None,
    runs: Sequence[Changes] | Mapping[str, ArrayLike] = (),
    **keywords: Unpack[ManyKeywords],
) -> Many:
    """Run a controller many times.

    Compiled loops run in threads of this process, which share machine code and set points. With
    plain Python in controller or plant, processes run it: loky's if installed. Results have the
    same bits with any executor and any number of workers.

    Parameters
    ----------
    controller, plant
        See :func:`simulate`. A `SweepRequest` alone holds every setting of ``fuzzyarm sweep``.
    runs : sequence of dict, or mapping of str to array_like
        The changes of each run, by name: gains of the controller (one number, or one for each
        axis), parameters of the plant (``plant.NAME`` if the controller has the name, too),
        ``noise.PORT``, ``delay.PORT`` and ``resolution.PORT`` of sensors, ``disturbance``,
        ``seed``; along a trajectory of a plant with a load ``payload``: its share, 0 for none. A
        mapping has arrays with an entry for each run.
    **keywords
        ``executor``, ``workers``, ``trajectory``, ``payload``, ``segments``, ``shared``,
        ``conventions``, ``options``, ``reference``, ``step``, ``duration``, ``connect``,
        ``watch``; see :class:`ManyKeywords`.

    Raises
    ------
    SweepError
        If a name is unknown, or there are no runs.
    TravelError
        If an object has to go to another process and cannot be pickled.

    Examples
    --------
    >>> from fuzzyarm.plant import reach
    >>> runs = [{"K_P": 100.0, "payload": 0.0}, {"K_P": 200.0, "payload": 2.0}]
    >>> many = simulate_many("pd", reach(segment=0.3), runs, workers=1)
    >>> many.rms.shape, bool((many.diverged > 0).any())
    ((2, 2), False)
    """
    demand_arguments("simulate_many", keywords, ManyKeywords, ("controller", "plant", "runs"))
    if isinstance(controller, SweepRequest):
        demand_alone("simulate_many", plant, tuple(runs) or None, keywords)
        if controller.against:
            raise RequestError("against", "is for the command", hint="call it for each controller")
        return swept(controller)[0]
    changes, count = columns_of(runs)
    bench = Bench(experiment_of(controller, plant, **keywords), list(changes))
    executor = keywords.get("executor")
    workers = read_fields(SweepRequest, keywords, ("workers",))["workers"]
    watch = keywords.get("watch")
    # A row for each run: when it diverged, or NaN, then the metrics of each output.
    rows = np.empty((count, 1 + len(bench.outputs) * len(METRICS)))
    # Closed even if `watch` raises, so that all workers stop.
    with closing(stream(bench, changes, count, executor=executor, workers=workers)) as parts:
        for first, part in parts:
            rows[first : first + len(part)] = part
            if watch is not None:
                watch(len(part))
    return many_of(bench, changes, rows)


def experiment_of(
    controller: AnyController, plant: AnyWay | None = None, **keywords: Unpack[ManyKeywords]
) -> Experiment:
    """Return the state shared by all runs, from the keywords of :func:`simulate_many`."""
    law = as_controller(controller)
    payload, segments = keywords.get("payload", False), keywords.get("segments")
    shared = dict(keywords.get("shared") or {})
    if payload or segments is not None:
        # Loaded segments imply a load: the full one by default.
        shared.setdefault("payload", float(payload or 1.0))
    way, reference = _followed(law, plant, keywords)
    return Experiment(
        law,
        way,
        tuple(segments) if segments is not None else None,
        shared,
        keywords.get("conventions", PLAIN),
        keywords.get("options") or Options(),
        reference,
        keywords.get("duration"),
        keywords.get("connect"),
    )
