"""Close the loop: controller, references and plant give errors over time."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.controller import CompiledController, Controller
from fuzzyarm.controller.law import Law, law_integers, summed_drives
from fuzzyarm.controller.on_plant import Site, TextLaw, controller_on, driven_by, site_of
from fuzzyarm.controller.text import ControllerText
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.kernels import build, routine
from fuzzyarm.loop.course import Course, Motion, Options, arm_motion, flat, motion
from fuzzyarm.loop.loop import LOOP_ARRAYS, final, rms, run_loop, signed_maximum, within
from fuzzyarm.loop.metrics import Metrics, metrics_of
from fuzzyarm.loop.reference import Signal
from fuzzyarm.plant.own import failure
from fuzzyarm.plant.plant import (
    ADVANCE,
    Address,
    Plant,
    PlantError,
    is_compiled,
    plain_motion,
    plain_outputs,
)
from fuzzyarm.plant.setting import (
    PLAIN,
    SET_POINT_PERIOD,
    Arithmetic,
    ArmError,
    Clock,
    Conventions,
    State,
    stored_double,
    stored_single,
)
from fuzzyarm.plant.setting import Reference as ArmReference
from fuzzyarm.plant.trajectory import Schedule, Trajectory, schedule

# --- A controller as the loop takes it ---


@cache
def loop_of_laws(compiled: bool, single: bool) -> Callable[..., None]:
    """Return the loop around laws and plant by address, as machine code or as plain Python.

    Each precision has its own: what is stored need not be asked whether to be rounded.
    """
    return routine(run_loop, LOOP_ARRAYS, _held(single), compiled=compiled)


def _held(single: bool) -> dict[str, Callable[..., Any]]:
    return {"stored": stored_single if single else stored_double}


class Program:
    """A controller as the loop takes it: laws, constants and memory.

    Attributes
    ----------
    numbers, memory : ndarray
        See :func:`fuzzyarm.loop.loop.run_loop`.
    compilable : bool
        Whether every addend is a compiled law.
    """

    def __init__(self, controller: Controller, arithmetic: Arithmetic) -> None:
        self.controller = controller
        self.arithmetic = arithmetic
        parts = list(controller.parts())
        own = [part for part in parts if isinstance(part, CompiledController)]
        self.compilable = len(own) == len(parts)
        self._laws = [part.law for part in own] if self.compilable else []
        self._blocks = [part.block(arithmetic) for part in own] if self.compilable else []
        self.numbers = np.concatenate([[], *(block.numbers for block in self._blocks)])
        self.memory = np.concatenate([[], *(block.memory for block in self._blocks)])

    @property
    def compiled(self) -> bool:
        """Whether it runs as machine code: wanted, and possible."""
        return self.arithmetic.compiled and self.compilable

    def inputs(self, *, as_array: bool | None = None) -> tuple[Any, Any]:
        """Return laws and constants as the loop takes them."""
        laws = law_integers(self._laws, self._blocks, self.arithmetic)
        as_array = self.compiled if as_array is None else as_array
        return flat(laws, np.int64, as_array=as_array), flat(self.numbers, as_array=as_array)

    def law_of(self, law: Law) -> int:
        """Return where among the laws one is."""
        return next(index for index, each in enumerate(self._laws) if each is law)

    def memory_of(self, law: Law, memory: Any) -> Any:
        """Return the stretch of a memory that belongs to a law."""
        begin = 0
        for each, block in zip(self._laws, self._blocks, strict=True):
            end = begin + len(block.memory)
            if each is law:
                return memory[begin:end]
            begin = end
        raise ValueError("not a law of this program")

    def remembered(self, memory: Any) -> list[float]:
        """Return what the laws remember, of the memory after a run."""
        return [
            float(value)
            for law in self._laws
            if law.remembers
            for value in self.memory_of(law, memory)
        ]


class Record:
    """What a call of the loop writes, and what it starts from.

    Parameters
    ----------
    course : Course
        The experiment.
    memory : array_like
        Of the laws.
    taps : sequence of int
        Cells of the board that are recorded.
    seed : int, optional
        Of the start.
    """

    def __init__(self, course: Course, memory: Any, taps: Any, seed: int | None = None) -> None:
        self.course = course
        count = len(course.motion.time)

        def new(values: Any, kind: type = np.float64) -> Any:
            return flat(values, kind, as_array=course.as_array)

        self.columns = len(taps)
        self.memory = new(memory)
        self.taps = new(taps, np.int64)
        self.board = new(np.zeros(course.board_size))
        self.state = course.state(seed)
        self.clock = course.clock()
        self.record = new(np.zeros(self.columns * count))
        self.progress = new([0, -1, -1, 0], np.int64)

    @property
    def outputs(self) -> tuple[Any, ...]:
        """The last arguments of the loop, from the memory on."""
        return (
            self.memory,
            self.taps,
            self.board,
            self.state,
            self.clock,
            self.record,
            self.progress,
        )

    @property
    def samples(self) -> NDArray[np.float64]:
        """What was recorded, shape (samples, taps)."""
        count = int(self.progress[0])
        return np.array(self.record[: count * self.columns]).reshape(-1, self.columns)

    @property
    def taken(self) -> NDArray[np.int64]:
        """Indices of the set points that were sampled."""
        whole = np.flatnonzero(self.course.motion.iterations == self.course.motion.every)
        return whole[: int(self.progress[0])]

    def diverged(self) -> float | None:
        """Return when the run was stopped because it had diverged, s."""
        point, iteration = int(self.progress[1]), int(self.progress[2])
        if point < 0:
            return None
        motion = self.course.motion
        return float(motion.time[point]) + (iteration + 1) * motion.period


def error_taps(course: Course) -> list[int]:
    """Return the cells of the tracked outputs, then those of their references."""
    tracked = course.motion.tracked
    return [
        *(course.output_cell(port) for port in tracked),
        *(course.reference_cell(port) for port in tracked),
    ]


def shown_errors(course: Course, samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the errors of the first columns of :func:`error_taps`, as they are shown."""
    count = len(course.motion.tracked)
    return np.asarray((samples[:, count : 2 * count] - samples[:, :count]) * scales(course))


def scales(course: Course) -> NDArray[np.float64]:
    """Return what makes of each tracked output what is shown: degrees of radians."""
    outputs = course.site.interface.outputs
    turn = 180.0 / course.conventions.pi
    return np.array([turn if outputs[p].unit == "rad" else 1.0 for p in course.motion.tracked])


def shown_units(course: Course) -> tuple[str, ...]:
    """Return the units in which the tracked outputs are shown."""
    units = [course.site.interface.outputs[port].unit for port in course.motion.tracked]
    return tuple("degrees" if unit == "rad" else unit for unit in units)


# --- Loops in which something is plain Python ---


def loop_for(program: Program, course: Course, record: Record) -> Callable[..., None]:
    """Return the loop that runs a program; what it calls of plain Python is bound to its arrays."""
    single = course.conventions.single
    if program.compilable and is_compiled(course.plant):
        return loop_of_laws(program.compiled, single)
    bindings: dict[str, Callable[..., Any]] = _held(single)
    if not is_compiled(course.plant):
        bindings |= plain_plant(course)
    if not program.compilable:
        bindings["control"] = plain_law(program.controller)
    elif program.arithmetic.compiled:
        bindings["control"] = compiled_law(program, course, record)
    return build(run_loop, bindings, compiled=False)


def plain_law(controller: Controller) -> Callable[..., None]:
    """Return what asks a controller in plain Python, on the arm."""

    def control(told: Any, _laws: Any, _numbers: Any, _memory: Any, drives: Any) -> None:
        t = told
        reference = ArmReference((t[3], t[4]), (t[5], t[6]), (t[7], t[8]))
        state = State((t[9], t[10]), (t[11], t[12]))
        clock = Clock(t[0], t[1] != 0.0, t[2] != 0.0)
        first, second = controller.torque(reference, state, clock)
        drives[0], drives[1] = float(first), float(second)

    return control


def compiled_law(program: Program, course: Course, record: Record) -> Callable[..., None]:
    """Return what runs compiled laws from a loop in plain Python, on the arrays of a record."""
    run = routine(summed_drives, "fifff", _held(course.conventions.single), compiled=True)
    laws, numbers = program.inputs(as_array=True)
    board = np.asarray(record.board)
    size = len(course.site.interface.inputs)
    told = board[: course.site.told + size]
    step = run.bind(told, laws, numbers, np.asarray(record.memory), board[len(board) - size :])  # type: ignore[attr-defined]

    def control(*_arrays: object) -> None:
        step()

    return control


def plain_plant(course: Course) -> dict[str, Callable[..., Any]]:
    """Return what asks a plant in plain Python."""
    plant, states = course.plant, len(course.plant.states)
    moved, measured = plain_motion(plant, states), plain_outputs(plant, states)

    def ask_plant(task: int, _links: Any, x: Any, y: Any, u: Any, p: Any, clock: Any) -> None:
        (moved if task == ADVANCE else measured)(x, y, u, p, clock)

    def goes_on(board: Any, checks: Any, bounds: Any) -> bool:
        return not plant.ended and within(board, checks, bounds)

    return {"ask_plant": ask_plant, "within": goes_on}


# --- What came of a run ---

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """What came of it; angles are shown in degrees, all else in the units of the plant.

    Attributes
    ----------
    controller, trajectory, plant : str
        Names.
    conventions : Conventions
        As run.
    time : ndarray, shape (n,)
        Of the samples, s.
    reference, errors : ndarray, shape (n, k)
        Of each tracked output: what was wanted, and that minus what was.
    axes, labels, units : tuple of str
        Of the tracked outputs.
    wanted, outputs, drives : mapping of str to ndarray, shape (n,)
        By port, in the units of the plant: references of the tracked outputs; outputs as they
        are, whatever sensors say; drives as the actuators give them, loads not among them.
    limits, drive_units : mapping
        Of each drive.
    loaded : tuple of bool
        Of each sample, whether the arm carries another load than at the start.
    diverged : float or None
        When the run was stopped because it had diverged, s.
    seconds : float
        Wall time of the loop.
    compiled : bool
        Whether it ran as machine code.
    memory : list of float
        What the laws remember at the end.
    period : float
        From sample to sample, s.
    seed : int
        Of noise and disturbance.
    ended : float or None
        When the plant ended the run by itself, s.
    """

    controller: str
    trajectory: str
    conventions: Conventions
    time: Vector
    reference: Vector
    errors: Vector
    diverged: float | None
    seconds: float
    compiled: bool
    memory: list[float]
    plant: str = "arm"
    axes: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    wanted: Mapping[str, Vector] = field(default_factory=dict)
    outputs: Mapping[str, Vector] = field(default_factory=dict)
    drives: Mapping[str, Vector] = field(default_factory=dict)
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    drive_units: Mapping[str, str] = field(default_factory=dict)
    loaded: tuple[bool, ...] = ()
    period: float = SET_POINT_PERIOD
    seed: int = 1
    ended: float | None = None

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.errors)

    @property
    def rms(self) -> Vector:
        """Root mean square error of each tracked output."""
        return rms(self.errors)

    @property
    def final(self) -> Vector:
        """Last error of each tracked output."""
        return final(self.errors)

    @property
    def maximum(self) -> Vector:
        """Largest error of each tracked output, as the conventions count it."""
        return signed_maximum(self.errors, self.conventions.maximum)

    @property
    def torques(self) -> Vector:
        """Torques of the arm's joints, shape (n, 2), N m."""
        return np.column_stack([self.drives["joint1.torque"], self.drives["joint2.torque"]])

    @property
    def metrics(self) -> dict[str, Metrics]:
        """Metrics of each axis; of each output where one axis has several that are tracked."""
        found = {}
        for column, label in enumerate(self.labels):
            axis = label.rpartition(".")[0]
            names = [name for name in self.drives if name.rpartition(".")[0] == axis]
            drives = np.column_stack([self.drives[name] for name in names] or [np.zeros((0, 0))])
            name = self.axes[column]
            found[name if self.axes.count(name) == 1 else label] = metrics_of(
                self.time,
                self.reference[:, column],
                self.errors[:, column],
                drives,
                [self.limits[name] for name in names],
                self.period,
            )
        return found

    def frame(self) -> Any:
        """Return the samples as a pandas DataFrame with the time as its index."""
        import pandas as pd

        return pd.DataFrame(self.columns(), index=pd.Index(self.time, name="time"))

    def columns(self) -> dict[str, Vector]:
        """Return the samples by name: references, outputs and drives."""
        wanted = {f"{label} wanted": values for label, values in self.wanted.items()}
        return {**wanted, **self.outputs, **self.drives}


# --- Runs ---


def simulate(
    controller: Controller | ControllerText,
    on: Trajectory | Plant | Motion,
    *,
    payload: bool = False,
    arms: Schedule | None = None,
    conventions: Conventions = PLAIN,
    options: Options | None = None,
    references: Mapping[str, Signal] | None = None,
    duration: float | None = None,
    connect: Mapping[str, str] | None = None,
) -> Run:
    """Run a controller along a trajectory of the arm, or on any plant.

    Parameters
    ----------
    controller : Controller or ControllerText
        Any on the arm, where sums of compiled ones run as machine code; on other plants
        controllers as text.
    on : Trajectory, Plant or Motion
        What the arm is to follow, the plant, or set points that were made before.
    payload : bool, optional
        Whether the arm carries its load where the trajectory says.
    arms : tuple of ArmParameters, optional
        One arm for each segment, instead.
    conventions : Conventions, optional
        Precision, π, timing.
    options : Options, optional
        Sensors, disturbances, limits, integrator.
    references : mapping of str to Signal, optional
        Of a plant, by port; a step to 1 of the first output by default.
    duration : float, optional
        Of a run on a plant, s; by default the plant's own.
    connect : mapping of str to str, optional
        From names of the controller to ports of the plant, where they differ.

    Returns
    -------
    Run
        Diverged or not.

    Raises
    ------
    ArmError
        If `arms` does not fit the segments.
    PlantError
        If the plant does not have a port, or cannot be run.
    SourceError
        If the plant does not have what the controller measures or drives.
    """
    options = options or Options()
    chosen = as_controller(controller)
    if isinstance(on, Trajectory):
        arms = checked_arms(on, arms, payload=payload, conventions=conventions)
        on = arm_motion(on, arms, conventions, options)
    elif isinstance(on, Plant):
        on = plant_motion(chosen, on, references, duration, connect)
    return run_along(chosen, on, conventions, options, connect)


def as_controller(controller: Controller | ControllerText) -> Controller:
    """Return a controller, of its text where that is what is given."""
    if isinstance(controller, ControllerText):
        from fuzzyarm.controller.catalogue import controller_of

        return controller_of(controller)
    return controller


def plant_motion(
    controller: Controller,
    plant: Plant,
    references: Mapping[str, Signal] | None = None,
    duration: float | None = None,
    connect: Mapping[str, str] | None = None,
    step: Signal | None = None,
) -> Motion:
    """Return the set points of a plant, at the period of a controller as text.

    Without references the first output that the controller asks a reference of follows `step`,
    by default to 1.
    """
    site = site_of(plant, connect)
    text = text_of(controller, site)
    if not references:
        tracked = first_error(text, site)
        references = {site.interface.label(tracked): step or Signal("step", (1.0,))}
    period, every = text.model.period, text.model.every
    if duration is None:
        duration = plant.duration or 1000 * period * every
    return motion(plant, references, duration, period, every)


def text_of(controller: Controller, site: Site) -> ControllerText:
    """Return the text of a controller, or of the first addend.

    Raises
    ------
    SourceError
        If it is a law of the arm.
    """
    found = next(iter(controller_on(controller, site).parts()))
    assert isinstance(found, CompiledController)
    assert isinstance(found.law, TextLaw)
    return found.law.text


def first_error(text: ControllerText, site: Site) -> Address:
    """Return the first output that a controller asks a reference of, or the first of the plant."""
    from fuzzyarm.controller.text import ports_of

    for asked in ports_of(text.model, "reference"):
        port = site.find(text.model, "reference", asked)
        if port in site.interface.outputs:
            return site.interface.references[port].of
    return next(iter(site.interface.outputs))


def run_along(
    controller: Controller,
    followed: Motion,
    conventions: Conventions = PLAIN,
    options: Options | None = None,
    connect: Mapping[str, str] | None = None,
) -> Run:
    """Run a controller along set points; see :func:`simulate`."""
    options = options or Options()
    site = site_of(followed.plants[0], connect)
    controller = controller_on(controller, site)
    arithmetic = options.arithmetic(conventions)
    program = Program(controller, arithmetic)
    compiled = program.compiled and is_compiled(followed.plants[0])
    driven = driven_by(controller, site) if program.compilable else torques_only(site)
    course = Course(followed, conventions, options, driven=driven, as_array=compiled)
    outputs, inputs = site.interface.outputs, site.interface.inputs
    taps = [
        *error_taps(course),
        *map(course.output_cell, outputs),
        *map(course.drive_cell, inputs),
    ]
    record = Record(course, program.memory, taps)
    controller.prepare(arithmetic)
    loop = loop_for(program, course, record)
    own = program.inputs(as_array=compiled)
    begin = time.perf_counter()
    with np.errstate(all="ignore"), plain_errors(followed.plants[0]):
        loop(*course.inputs(), *own, *record.outputs)
    seconds = time.perf_counter() - begin
    samples, taken = record.samples, record.taken
    stopped, over = record.diverged(), followed.plants[0].ended
    count = len(followed.tracked)
    label = site.interface.label
    front = 2 * count
    turned = scales(course)
    return Run(
        controller.name,
        followed.name,
        conventions,
        followed.time[taken],
        samples[:, count:front] * turned,
        shown_errors(course, samples),
        None if over else stopped,
        seconds,
        compiled,
        program.remembered(record.memory),
        followed.plants[0].name,
        tuple(axis for axis, _ in followed.tracked),
        tuple(map(label, followed.tracked)),
        shown_units(course),
        {label(port): samples[:, count + i] for i, port in enumerate(followed.tracked)},
        {label(port): samples[:, front + i] for i, port in enumerate(outputs)},
        {label(port): samples[:, front + len(outputs) + i] for i, port in enumerate(inputs)},
        {label(port): (each.low, each.high) for port, each in inputs.items()},
        {label(port): each.unit for port, each in inputs.items()},
        tuple(bool(each) for each in followed.block[taken]),
        followed.period * followed.every,
        options.seed,
        stopped if over else None,
    )


def torques_only(site: Site) -> frozenset[Address]:
    """Return what a controller in plain Python drives: torques, those of motors included."""
    return frozenset(port for port in site.interface.inputs if port[1] == "torque")


@contextmanager
def plain_errors(plant: Plant) -> Iterator[None]:
    """Make one clear sentence of what a plant in plain Python raises."""
    try:
        yield
    except FuzzyarmError:
        raise
    except Exception as error:
        if is_compiled(plant):
            raise
        path = sys.modules[type(plant).__module__].__file__ or ""
        raise PlantError(f"plant {plant.name} failed: {failure(path, error)}") from error


def checked_arms(
    trajectory: Trajectory,
    arms: Schedule | None,
    *,
    payload: bool,
    conventions: Conventions,
) -> Schedule:
    """Return `arms`, or by default those of the trajectory; one for each segment.

    Raises
    ------
    ArmError
        If `arms` does not fit the segments.
    """
    if arms is None:
        arms = schedule(trajectory, payload=payload, conventions=conventions)
    if len(arms) != len(trajectory.segments):
        raise ArmError(
            f"a payload schedule of {len(arms)} arms does not fit the "
            f"{len(trajectory.segments)} segments of '{trajectory.name}'",
            name="arms",
            value=len(arms),
        )
    return arms
