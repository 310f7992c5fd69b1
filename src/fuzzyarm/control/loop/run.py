"""Run a closed loop: errors over time from controller, references and plant."""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import UsageError, demand_extra
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.shown import Plotted, one_line
from fuzzyarm.base.value_kinds import CONTROLLER, wrong_kind
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.on_plant import (
    Site,
    connectable,
    controller_on,
    drive_limits,
    driven_by,
    driven_plainly,
    own_timing,
    site_of,
    text_law_of,
    timed,
    timing_on,
)
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import (
    Course,
    Motion,
    Options,
    delay_notes,
    duration_notes,
    motion,
    range_notes,
)
from fuzzyarm.control.loop.loop import SQUARES, final, rms, signed_maximum
from fuzzyarm.control.loop.metrics import METRICS, Metrics, metric_unit, metrics_of
from fuzzyarm.control.loop.open_run import OpenRun
from fuzzyarm.control.loop.program import (
    EVERY_PERIOD,
    LoopProgram,
    RunRecord,
    error_taps,
    loop_of_laws,
    scales,
    shown_errors,
    shown_units,
)
from fuzzyarm.control.loop.reference import AnySignal, AnyTime, Signal, as_seconds, as_signals
from fuzzyarm.plant.plain_python import require_sound
from fuzzyarm.plant.plant import Address, Plant, is_compiled
from fuzzyarm.plant.setting import PLAIN, SET_POINT_PERIOD, Conventions

# --- Results of a run ---

Vector = NDArray[np.float64]


def judged_names(axes: Sequence[str], labels: Sequence[str]) -> tuple[str, ...]:
    """Name the tracked outputs in metrics: by axis if it has one of them, else by label."""
    return tuple(
        axis if axes.count(axis) == 1 else label for axis, label in zip(axes, labels, strict=True)
    )


def metric_units(course: Course) -> dict[str, dict[str, str]]:
    """Return the units of all metrics, by output and metric."""
    interface, tracked = course.site.interface, course.motion.tracked
    names = judged_names([axis for axis, _ in tracked], list(map(interface.label, tracked)))
    units = {}
    for (axis, _), name, unit in zip(tracked, names, shown_units(course), strict=True):
        drives = [port.unit for (home, _), port in interface.inputs.items() if home == axis]
        units[name] = {metric: metric_unit(metric, unit, drives) for metric in METRICS}
    return units


class MetricSources(NamedTuple):
    """The data behind the metrics of a run; fields as in :class:`Run`."""

    conventions: Conventions
    axes: tuple[str, ...]
    labels: tuple[str, ...]
    period: float
    set_point_time: Vector
    reference: Vector
    error_matrix: Vector
    drives: Mapping[str, Vector]
    driven: tuple[str, ...]
    limits: Mapping[str, tuple[float, float]]
    chatter: Mapping[str, float]
    counted: Mapping[str, Vector]


def metrics_by_output(of: MetricSources | Run) -> dict[str, Metrics]:
    """Return the metrics of each tracked output, by the names of :func:`judged_names`."""
    metrics = {}
    shown = judged_names(of.axes, of.labels)
    for column, label in enumerate(of.labels):
        axis = label.rpartition(".")[0]
        driven = [name for name in of.drives if not of.driven or name in of.driven]
        names = [name for name in driven if name.rpartition(".")[0] == axis]
        drives = np.column_stack([of.drives[name] for name in names] or [np.zeros((0, 0))])
        metrics[shown[column]] = metrics_of(
            of.set_point_time,
            of.reference[:, column],
            of.error_matrix[:, column],
            drives,
            [of.limits[name] for name in names],
            of.period,
            of.conventions.maximum,
            {
                "chatter": of.chatter.get(names[0], 0.0) if names else 0.0,
                **{name: float(values[column]) for name, values in of.counted.items()},
            },
        )
    return metrics


@json_properties(
    "controller trajectory rms max=maximum final rms_periods rms_path samples"
    " conventions=conventions.name precision=conventions.precision pi=conventions.pi"
    " load_in_hold=conventions.load_in_hold diverged ended skipped periods lost compiled plant"
    " outputs=tracked_units metrics seed"
)
@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Run(Plotted):
    """The result of a run; angles in degrees, everything else in the units of the plant.

    Attributes
    ----------
    controller, trajectory, plant : str
        Their names.
    conventions : Conventions
        Conventions of the run.
    time : ndarray, shape (n,)
        Sampling times of outputs and drives, s.
    reference, error_matrix : ndarray, shape (n, k)
        For each tracked output: the reference, and reference minus output.
    axes, labels, units : tuple of str
        Of the tracked outputs.
    wanted, outputs, drives : mapping of str to ndarray, shape (n,)
        By port, in the units of the plant: references of the tracked outputs; true outputs,
        without sensor errors; drives after the actuators, without loads.
    limits : mapping of str to (float, float)
        For each drive: those of its actuator, or narrower ones of the controller.
    drive_units : mapping of str to str
        Of each drive.
    loaded : tuple of bool
        For each sample, whether the load differs from that at the start.
    diverged : float or None
        Time at which the run was stopped for divergence, s.
    seconds : float
        Wall time of the loop.
    compiled : bool
        Whether it ran as machine code.
    memory : list of float
        Final state of the laws.
    period : float
        Time between samples, s.
    seed : int
        Of noise and disturbance.
    ended : float or None
        Time at which the plant itself ended the run, s.
    chatter : mapping of str to float
        Root mean square of the change of each drive between control periods; the step from rest to
        the first drive does not count.
    every : int
        Control periods of a set point.
    set_point_time : ndarray, shape (n,)
        Nominal time of the set points of the samples, s. A sample is taken in the last control
        period of its set point; the times of a trajectory restart in each segment.
    counted : mapping of str to ndarray, shape (k,)
        Metrics of the tracked outputs that the loop sums up in every control period, by name.
    output_units : mapping of str to str
        Of `outputs` and `wanted`.
    driven : tuple of str
        The `drives` of the controller, direct or through motors of the plant, which metrics of
        drives refer to. Empty means all.
    cause : str
        Of a diverged run: the quantity beyond its bound, or NaN.
    notes : tuple of str
        Notes on adjusted settings, in sentences.
    along : bool
        Whether it followed a trajectory of the plant.
    skipped : mapping of str to int
        For each axis with skipped periods: their number. A value read or found was NaN, or a
        remembered one infinite.
    periods : int
        Number of control periods.
    """

    controller: str
    trajectory: str
    conventions: Conventions
    time: Vector
    reference: Vector
    error_matrix: Vector
    diverged: float | None
    seconds: float
    compiled: bool
    memory: list[float]
    plant: str = ""
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
    chatter: Mapping[str, float] = field(default_factory=dict)
    every: int = 1
    set_point_time: Vector = field(default_factory=lambda: np.zeros(0))
    counted: Mapping[str, Vector] = field(default_factory=dict)
    output_units: Mapping[str, str] = field(default_factory=dict)
    driven: tuple[str, ...] = ()
    cause: str = ""
    notes: tuple[str, ...] = ()
    along: bool = False
    skipped: Mapping[str, int] = field(default_factory=dict)
    periods: int = 0

    def __repr__(self) -> str:
        errors = zip(self.labels, self.rms, self.units, strict=True)
        words = ", ".join(f"rms {name} {x:.4g} {unit}" for name, x, unit in errors)
        stopped = "" if self.diverged is None else f", diverged at {self.diverged:.4g} s"
        seconds = self.samples * self.period
        return one_line(
            self, f"{self.controller} on {self.plant}: {seconds:.4g} s, {words}{stopped}"
        )

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.error_matrix)

    @property
    def tracked_units(self) -> dict[str, str]:
        """Unit of each tracked output."""
        return dict(zip(self.labels, self.units, strict=True))

    @property
    def errors(self) -> dict[str, Vector]:
        """Errors of each tracked output at the set points, by its label."""
        return dict(zip(self.labels, self.error_matrix.T, strict=True))

    @property
    def rms(self) -> Vector:
        """Root mean square error of each tracked output, at the set points."""
        return rms(self.error_matrix)

    @property
    def final(self) -> Vector:
        """Last error of each tracked output."""
        return final(self.error_matrix)

    @property
    def maximum(self) -> Vector:
        """Largest error of each tracked output, by the conventions."""
        return signed_maximum(self.error_matrix, self.conventions.maximum)

    @property
    def rms_periods(self) -> Vector:
        """As `rms`, over all control periods, from the held set point."""
        return self.counted.get("rms_periods", np.zeros(0))

    @property
    def rms_path(self) -> Vector:
        """The same from the reference sampled by the set points."""
        return self.counted.get("rms_path", np.zeros(0))

    @property
    def where(self) -> str:
        """The task: the trajectory's name, or references with their plant."""
        return where(self.plant, self.trajectory, along=self.along)

    @property
    def lost(self) -> dict[str, int]:
        """Number of NaN errors of each tracked output with some; metrics ignore them."""
        counts = zip(self.labels, np.isnan(self.error_matrix).sum(axis=0).tolist(), strict=True)
        return {label: count for label, count in counts if count}

    @property
    def gaps(self) -> list[str]:
        """Skipped periods and lost samples in words."""
        return [
            f"axis {axis} skipped {count} of {self.periods} periods: "
            "a value was not a number, or infinite where it is remembered"
            for axis, count in self.skipped.items()
        ] + [
            f"{label} was not a number in {count} of {self.samples} samples: "
            "metrics are those of the others"
            for label, count in self.lost.items()
        ]

    @property
    def torques(self) -> Vector:
        """Joint torques of an arm, shape (n, k), N m."""
        torques = {name for name in self.drives if name.rpartition(".")[2] == "torque"}
        return np.column_stack([self.drives[name] for name in self.drives if name in torques])

    @property
    def metrics(self) -> dict[str, Metrics]:
        """Metrics of each axis; of each output if an axis has several tracked ones."""
        return metrics_by_output(self)

    def frame(self) -> Any:
        """Return the samples as a pandas DataFrame with the time as its index."""
        demand_extra("pandas", "data", "a DataFrame")
        import pandas as pd

        return pd.DataFrame(self.columns(), index=pd.Index(self.time, name="time"))

    def columns(self) -> dict[str, Vector]:
        """Return the samples by name: references, outputs and drives."""
        references = {f"{label} wanted": values for label, values in self.wanted.items()}
        return {**references, **self.outputs, **self.drives}


def where(plant: str, trajectory: str, *, along: bool) -> str:
    """Return the task in words; see :attr:`Run.where`."""
    return trajectory if along else f"{plant}, {trajectory}"


class Judged(NamedTuple):
    """Errors and chatter of a run; see :attr:`Run.rms` and :attr:`Metrics.chatter`.

    Attributes
    ----------
    rms, chatter : mapping of str to float
        By the names of :func:`judged_names`.
    diverged : float or None
        Time at which the run was stopped for divergence, s.
    """

    rms: Mapping[str, float]
    chatter: Mapping[str, float]
    diverged: float | None


# --- Runs ---

AnyController = Controller | ControllerText | str | os.PathLike[str]
"""A controller, or the name or the file of one."""


def as_controller(controller: AnyController) -> Controller:
    """Convert a name, a file or a text to a controller."""
    if isinstance(controller, Controller):
        return controller
    if isinstance(controller, str | os.PathLike):
        from fuzzyarm.control.controllers.own import find_controller

        return find_controller(os.fspath(controller))
    if isinstance(controller, ControllerText):
        from fuzzyarm.control.controllers.catalogue import controller_of

        return controller_of(controller)
    raise wrong_kind(controller, CONTROLLER)


def with_gains(
    controller: Controller, gains: Mapping[str, float | Sequence[float]] | None
) -> Controller:
    """Return a controller with some gains replaced, by numbers or one number for each axis."""
    if not gains:
        return controller
    values = {name: np.atleast_1d(value).tolist() for name, value in gains.items()}
    changed = controller.with_gains(values)
    changed.name = controller.name
    return changed


def plant_motion(
    controller: Controller,
    plant: Plant,
    references: Mapping[str, AnySignal] | None = None,
    duration: AnyTime | None = None,
    connect: Mapping[str, str] | None = None,
) -> Motion:
    """Return the set points of a plant, at the period of a controller as text.

    By default the reference of the first followed output steps to 1.
    """
    require_sound(plant)
    site = site_of(plant, connect)
    chosen = controller_on(controller, site)
    signals = as_signals(references) or _stepped(controller, site, 1.0)
    timing = timing_on(chosen, site)
    # The period as written: Timing has the duration of a set point.
    clock = next(filter(None, map(timed, chosen.parts())), timing)
    if duration is None:
        duration = plant.duration or 1000 * clock.period * clock.every
    return motion(plant, signals, as_seconds(duration, "duration"), clock.period, clock.every)


def stepped(
    controller: Controller,
    plant: Plant,
    step: float,
    reference: Mapping[str, AnySignal] | None = None,
    connect: Mapping[str, str] | None = None,
) -> dict[str, Signal]:
    """Return a step of the output followed by a controller."""
    if reference:
        raise UsageError("a step and references exclude each other", hint="give one of them")
    require_sound(plant)
    return _stepped(controller, site_of(plant, connect), float(step))


def _stepped(controller: Controller, site: Site, step: float) -> dict[str, Signal]:
    followed = followed_by(controller_on(controller, site), site)
    return {site.interface.label(followed): Signal("step", (step,))}


def followed_by(controller: Controller, site: Site) -> Address:
    """Return the output followed by a controller: by its text, or the first of the plant."""
    for part in controller.parts():
        law = text_law_of(part)
        if law is not None:
            return first_error(law.text, site)
    return next(iter(site.interface.outputs))


def text_of(controller: Controller, site: Site) -> ControllerText:
    """Return the text of a controller, or of the first addend."""
    first_part = next(iter(controller_on(controller, site).parts()))
    law = text_law_of(first_part)
    if law is None:
        raise SourceError(f"{first_part.name} is not a controller as text")
    return law.text


def first_error(text: ControllerText, site: Site) -> Address:
    """Return the first output in an error of the text, or the first of the plant."""
    from fuzzyarm.control.controllers.text import ports_of

    for port_name in ports_of(text.model, "reference"):
        port = site.find(text.model, "reference", port_name)
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
    """Run a controller along set points; see :func:`fuzzyarm.control.loop.simulate`."""
    return ClosedLoop(controller, followed, conventions, options, connect).run()


def _coarse(course: Course) -> tuple[str, ...]:
    """Return notes on coarse settings, possible causes of divergence."""
    if course.plant.derivative is None or math.isfinite(course.plant.longest_step):
        return ()
    return (
        f"the plant is integrated in steps of a control period, {course.motion.period:g} s: "
        "where its equations are faster, give it a longest_step",
    )


_rooms = threading.local()


def _room(size: int) -> Vector:
    """Return a scratch array of each thread."""
    # Kept: the system would map fresh memory of this size page by page in every run.
    array: Vector | None = getattr(_rooms, "array", None)
    if array is None or len(array) < size:
        array = _rooms.array = np.zeros(size)
    return array


class ClosedLoop:
    """A controller, set points and a plant, prepared for one run or many.

    Parameters
    ----------
    controller, followed, conventions, options, connect
        See :func:`simulate`.

    Attributes
    ----------
    controller : Controller
        Bound to this plant.
    program : LoopProgram
        Its program.
    course : Course
        The experiment.
    compiled : bool
        Whether laws and plant both run as machine code.
    """

    def __init__(
        self,
        controller: Controller,
        followed: Motion,
        conventions: Conventions = PLAIN,
        options: Options | None = None,
        connect: Mapping[str, str] | None = None,
    ) -> None:
        options = options or Options()
        self.site = site_of(followed.plants[0], connect)
        self.controller = controller_on(controller, self.site)
        require_timing(self.controller, followed)
        self.arithmetic = options.arithmetic(conventions)
        plant = followed.plants[0]
        self.program = LoopProgram(self.controller, self.arithmetic)
        self.compiled = self.program.compiled and is_compiled(plant)
        driven = driven_plainly(self.site)
        if self.program.compilable:
            driven = driven_by(self.controller, self.site)
        self.course = Course(
            followed,
            conventions,
            options,
            driven=driven,
            as_array=self.compiled,
            connect=connect,
        )
        if self.compiled:  # compile now, not in the first run
            loop_of_laws(self.program, self.course)
            self.program.parts()
        errors = error_taps(self.course)
        outputs = map(self.course.output_cell, self.site.interface.outputs)
        drives = [*map(self.course.drive_cell, self.site.interface.inputs)]
        self.taps = [*errors, *outputs, *drives]
        self._measured_taps = [*errors, *drives]

    def program_with(self, gains: Mapping[str, Sequence[float]]) -> LoopProgram:
        """Return the program of the same controller with other gains."""
        return LoopProgram(self.controller.with_gains(gains), self.arithmetic)

    def run(
        self,
        program: LoopProgram | None = None,
        course: Course | None = None,
        seed: int | None = None,
    ) -> Run:
        """Run once.

        Parameters
        ----------
        program, course : optional
            Replace its own: with other gains, plants or sensors.
        seed : int, optional
            Replaces that of the options.
        """
        open_run = self.open(program, course, seed)
        open_run.advance()
        return self.answer(open_run)

    def judged(
        self,
        program: LoopProgram | None = None,
        course: Course | None = None,
        seed: int | None = None,
    ) -> Judged:
        """Run once for errors and chatter alone: faster, for searches."""
        program, course = program or self.program, course or self.course
        taps = self.taps[: 2 * len(course.motion.tracked)]
        record = RunRecord(course, program.memory, taps, seed, between=False)
        OpenRun(self.site, program, course, record).advance()
        stopped = None if course.plant.ended else record.diverged()
        names = list(map(self.site.interface.label, course.motion.tracked))
        labels = judged_names([axis for axis, _ in course.motion.tracked], names)
        errors = rms(shown_errors(course, record.rows)).tolist()
        chatter = self._chatter(record)
        first: dict[str, float] = {}  # of the first drive of each axis
        for name, value in chatter.items():
            first.setdefault(name.rpartition(".")[0], value)
        calm = [first.get(name.rpartition(".")[0], 0.0) for name in names]
        return Judged(
            dict(zip(labels, errors, strict=True)), dict(zip(labels, calm, strict=True)), stopped
        )

    def _chatter(self, record: RunRecord) -> dict[str, float]:
        interface = self.site.interface
        changes = np.sqrt(record.changes(SQUARES)).tolist()
        every = dict(zip(map(interface.label, interface.inputs), changes, strict=True))
        return {name: every[name] for name in self._driven}

    @property
    def _driven(self) -> tuple[str, ...]:
        """Drives of the controller, without those moved only by a disturbance."""
        interface, driven = self.site.interface, self.course.driven
        coupled = self.course.plant.dynamics is not None  # torques follow from voltages
        moved = [port for port in interface.inputs if coupled or port in driven]
        return tuple(map(interface.label, moved))

    def open(
        self,
        program: LoopProgram | None = None,
        course: Course | None = None,
        seed: int | None = None,
        *,
        loaded: bool = False,
    ) -> OpenRun:
        """Begin a run in parts: :class:`fuzzyarm.control.loop.open_run.OpenRun`."""
        program, course = program or self.program, course or self.course
        record = RunRecord(course, program.memory, self.taps, seed)
        return OpenRun(self.site, program, course, record, loaded=loaded)

    def measured(
        self,
        program: LoopProgram | None = None,
        course: Course | None = None,
        seed: int | None = None,
    ) -> tuple[dict[str, Metrics], float | None]:
        """Run once for metrics and the time of divergence: faster, for many runs."""
        program, course = program or self.program, course or self.course
        room = _room(len(self._measured_taps) * len(course.motion.time))
        record = RunRecord(course, program.memory, self._measured_taps, seed, room=room)
        open_run = OpenRun(self.site, program, course, record)
        open_run.advance()
        taps = np.ascontiguousarray(record.rows.T)
        metrics = metrics_by_output(self._metric_sources(open_run, taps))
        return metrics, None if course.plant.ended else record.diverged()

    def _metric_sources(self, run: OpenRun, taps: Vector) -> MetricSources:
        """Return the data for metrics, from one row for each tap: errors first, drives last."""
        record, course = run.record, run.course
        followed, label = course.motion, self.site.interface.label
        count, inputs = len(followed.tracked), self.site.interface.inputs
        is_main_program = run.program is self.program
        return MetricSources(
            conventions=course.conventions,
            axes=tuple(axis for axis, _ in followed.tracked),
            labels=tuple(map(label, followed.tracked)),
            period=followed.period * followed.every,
            set_point_time=followed.time[record.taken],
            reference=taps[count : 2 * count].T * scales(course),
            error_matrix=shown_errors(course, taps.T),
            drives=dict(zip(map(label, inputs), taps[-len(inputs) :], strict=True)),
            driven=self._driven,
            limits=dict(self._own_limits) if is_main_program else self._limits(run.program),
            chatter=self._chatter(record),
            counted={name: sums(course, record) for name, sums in EVERY_PERIOD.items()},
        )

    def answer(self, run: OpenRun) -> Run:
        """Return the result of a run so far."""
        program, record, course = run.program, run.record, run.course
        followed, interface = course.motion, self.site.interface
        inputs, label = interface.inputs, interface.label
        samples = record.taken
        # One row for each tap: everything below goes along rows.
        taps = np.ascontiguousarray(record.rows.T)
        # A run ended by the plant itself has not diverged.
        stopped, over = record.diverged(), course.plant.ended
        references, outputs, _ = self._by_port(course, taps)
        return Run(
            **self._metric_sources(run, taps)._asdict(),
            controller=program.controller.name,
            trajectory=followed.name,
            time=followed.sampled[samples],
            diverged=None if over else stopped,
            seconds=run.seconds,
            compiled=self.compiled,
            memory=program.remembered(record.memory),
            plant=course.plant.name,
            units=shown_units(course),
            wanted=references,
            outputs=outputs,
            drive_units={label(port): variable.unit for port, variable in inputs.items()},
            cause="" if over or stopped is None else self._cause(record),
            loaded=tuple((followed.block[samples] != 0).tolist()),
            seed=course.options.seed if record.seed is None else record.seed,
            ended=stopped if over else None,
            every=followed.every,
            output_units={label(port): output.unit for port, output in interface.outputs.items()},
            along=followed.along,
            notes=self.notes(course) + (() if over or stopped is None else _coarse(course)),
            skipped=program.skipped(record.memory),
            periods=record.ticks,
        )

    def _cause(self, record: RunRecord) -> str:
        """Return the cause of divergence, from the final values."""
        interface, board = self.site.interface, np.asarray(record.board, float)
        label = interface.label
        for port in interface.inputs:
            if math.isnan(board[self.course.drive_cell(port)]):
                return f"a drive, {label(port)}, that is not a number"
        for port, output in interface.outputs.items():
            value = board[self.course.output_cell(port)]
            if math.isnan(value):
                return f"an output, {label(port)}, that is not a number"
            if not abs(value) <= output.bound:
                return f"{label(port)} at {value:.4g}, beyond its bound of {output.bound:g}"
            error = board[self.course.reference_cell(port)] - value
            if port in self.course.motion.tracked and not abs(error) <= output.error_bound:
                return f"an error of {label(port)} of {error:.4g}, beyond {output.error_bound:.4g}"
        return "an output beyond its bound or not a number"

    def notes(self, course: Course | None = None) -> tuple[str, ...]:
        """Return notes on adjusted settings."""
        course, site = course or self.course, self.site
        notes = [*duration_notes(course.motion)]
        notes += delay_notes(course.options, course.motion.period)
        notes += range_notes(course.motion, site)
        names: set[str] = set()
        for part in self.controller.parts():
            names |= connectable(part)
            names |= set(site.connect) if part.takes_ports else set()
        for name, port in site.connect.items():
            if name not in names:
                notes.append(
                    f"nothing in {self.controller.name} is called '{name}': "
                    f"--connect {name}={port} has no effect"
                )
        idle = {axis for axis, _ in site.interface.inputs} - {axis for axis, _ in course.driven}
        notes += [f"nothing drives {axis}" for axis in sorted(idle)]
        return tuple(notes)

    @cached_property
    def _own_limits(self) -> dict[str, tuple[float, float]]:
        """Limits under its own program, for all runs with the same gains."""
        return self._limits(self.program)

    def _limits(self, program: LoopProgram) -> dict[str, tuple[float, float]]:
        """Return the limits of each drive: the actuator's, or narrower ones of the text."""
        limits = {}
        limits_of_drives = drive_limits(program.controller, self.site)
        for port, actuator in self.site.interface.inputs.items():
            low, high = limits_of_drives.get(port, (-math.inf, math.inf))
            limits[self.site.interface.label(port)] = (
                max(low, actuator.low),
                min(high, actuator.high),
            )
        return limits

    def _by_port(
        self, course: Course, taps: Vector
    ) -> tuple[dict[str, Vector], dict[str, Vector], dict[str, Vector]]:
        """Return references of tracked outputs, outputs and drives, from one row for each tap."""
        interface, tracked = self.site.interface, course.motion.tracked
        rows = iter(taps[len(tracked) :])
        by_port = [
            {interface.label(port): next(rows) for port in ports}
            for ports in (tracked, interface.outputs, interface.inputs)
        ]
        return by_port[0], by_port[1], by_port[2]

    def so_far(self, run: OpenRun) -> SoFar:
        """Return the samples of a run in progress, as views of the loop's arrays."""
        course, record = run.course, run.record
        several = len(course.motion.plants) > 1
        blocks = course.motion.block[record.taken] if several else ()
        return SoFar(
            course.plant.name,
            *self._by_port(course, record.rows.T),
            [block != 0 for block in blocks],
        )


@dataclass(frozen=True, eq=False)
class SoFar:
    """The samples of a run so far; see :class:`Run` for the attributes."""

    plant: str
    wanted: Mapping[str, Vector]
    outputs: Mapping[str, Vector]
    drives: Mapping[str, Vector]
    loaded: Sequence[bool]


def require_timing(controller: Controller, followed: Motion) -> None:
    """Raise SourceError if the period of the set points is not the text's."""
    timing = own_timing(controller)
    if timing is None:
        return
    if timing.every != followed.every or not math.isclose(
        timing.period, followed.period, rel_tol=1e-9
    ):
        raise SourceError(
            f"{controller.name} runs every {timing.period:g} s with a set point every "
            f"{timing.every}, and these set points are for {followed.period:g} s "
            f"and {followed.every}"
        )
