"""A controller as arrays of the loop kernel, the arrays of a run, and loops with plain Python."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from types import MappingProxyType
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import near_hint
from fuzzyarm.control.controllers import on_plant
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.controller import CompiledController, Controller
from fuzzyarm.control.controllers.law import Law, drives_of_laws, law_integers, view
from fuzzyarm.control.controllers.robot_laws import EFFORTS, JointMoment, RobotLaw
from fuzzyarm.control.controllers.text import ControllerRun
from fuzzyarm.control.loop.course import Course, flat
from fuzzyarm.control.loop.loop import (
    ALONG_PATH,
    CHANGES,
    ERRORS,
    HELD,
    LOOP_ARRAYS,
    LOST,
    NEXT,
    SAMPLES,
    TICK,
    UNKNOWN,
    UNTIL,
    LoopBlock,
    loop_bindings,
    run_loop,
    within,
)
from fuzzyarm.plant.equations import USERS
from fuzzyarm.plant.own import failure_of
from fuzzyarm.plant.plain_python import plain_motion, plain_outputs
from fuzzyarm.plant.plant import ADVANCE, CLOCK_SIZE, Address, is_compiled, is_traced
from fuzzyarm.plant.setting import CLOCK, LAST, PERIOD, Clock, RunArithmetic, State
from fuzzyarm.plant.setting import Reference as ArmReference
from fuzzyarm.symbolic.kernels import bound_routine, is_built, routine, with_names

# --- A controller as arrays of the loop kernel ---


Loop = Callable[[LoopBlock], None]


def loop_of_laws(program: LoopProgram, course: Course) -> Loop:
    """Return the loop around laws and plant, as machine code or as plain Python.

    The fastest of equivalent variants: plant and controller compiled in, or both called by address.
    """
    single = course.conventions.single
    if program.compiled:
        for dynamics in (course.dynamics, None):
            for of_text in (program.is_text, False):
                bindings = loop_bindings(dynamics, single=single, of_text=of_text)
                if is_built(run_loop, LOOP_ARRAYS, bindings):
                    return _routine(tuple(sorted(bindings.items())))
        return _routine(tuple(sorted(_held(single).items())))
    return with_names(run_loop, _held(single))


@cache
def _routine(bindings: tuple[tuple[str, Callable[..., Any]], ...]) -> Loop:
    machine_code = routine(run_loop, LOOP_ARRAYS, dict(bindings), compiled=True)
    return lambda block: machine_code(*block)


def _held(single: bool) -> dict[str, Callable[..., Any]]:
    return loop_bindings(None, single=single, of_text=False)


class LoopProgram:
    """A controller as arrays of the loop kernel: laws, constants and state.

    Attributes
    ----------
    numbers, memory : ndarray
        See :class:`fuzzyarm.control.loop.loop.LoopBlock`.
    compilable : bool
        Whether all addends are compiled laws.
    """

    def __init__(self, controller: Controller, arithmetic: RunArithmetic) -> None:
        self.controller = controller
        self.arithmetic = arithmetic
        parts = list(controller.parts())
        compiled_parts = [part for part in parts if isinstance(part, CompiledController)]
        self.compilable = len(compiled_parts) == len(parts)
        self._laws = [part.law for part in compiled_parts] if self.compilable else []
        self._blocks = (
            [part.block(arithmetic) for part in compiled_parts] if self.compilable else []
        )
        self.numbers = np.concatenate([[], *(block.numbers for block in self._blocks)])
        self.memory = np.concatenate([[], *(block.memory for block in self._blocks)])
        self._parts: dict[bool, dict[str, Any]] = {}

    @property
    def compiled(self) -> bool:
        """Whether it runs as machine code: requested and possible."""
        return self.arithmetic.compiled and self.compilable

    @property
    def is_text(self) -> bool:
        """Whether it consists of one controller as text."""
        return len(self._laws) == 1 and isinstance(self._laws[0], on_plant.TextLaw)

    def parts(self, *, as_array: bool | None = None) -> dict[str, Any]:
        """Return laws and constants by their names in a :class:`LoopBlock`, shared by all runs."""
        as_array = self.compiled if as_array is None else as_array
        if as_array not in self._parts:
            laws = law_integers(self._laws, self._blocks, self.arithmetic)
            self._parts[as_array] = {
                "laws": flat(laws, np.int64, as_array=as_array),
                "numbers": flat(self.numbers, as_array=as_array),
            }
        return self._parts[as_array]

    def memory_of(self, law: Law, memory: Any) -> Any:
        """Return the slice of the state that belongs to a law."""
        begin = 0
        for part, block in zip(self._laws, self._blocks, strict=True):
            end = begin + len(block.memory)
            if part is law:
                return memory[begin:end]
            begin = end
        raise ValueError("not a law of this program")

    def structure(self) -> tuple[Any, ...]:
        """Return a key: programs with equal keys can exchange state.

        For a text it holds timing, instructions and number of states; numbers, terms,
        rules and entries of tables may differ. For any other law it holds everything.
        """
        parts: list[Any] = []
        for law, block in zip(self._laws, self._blocks, strict=True):
            if isinstance(law, on_plant.TextLaw):
                model, program = law.text.model, law.program(self.arithmetic)
                parts += [model.period, model.every, model.axis_names]
                parts += [program.instructions(), len(program.memory())]
                parts += [law.site.driven(model), [gain.name for gain in model.gains]]
            else:
                parts += [law, block.numbers.tolist(), len(block.memory)]
        return self.compilable, *parts

    def kept(self) -> NDArray[np.int64]:
        """Return the indices of the state cells that carry over to the next control period."""
        cells: list[int] = []
        begin = 0
        for law, block in zip(self._laws, self._blocks, strict=True):
            cells_of_law: Sequence[int] = range(len(block.memory))
            if isinstance(law, on_plant.TextLaw):
                cells_of_law = law.program(self.arithmetic).memory()
            cells += [begin + cell for cell in cells_of_law]
            begin += len(block.memory)
        return np.array(cells, np.int64)

    def remembered(self, memory: Any) -> list[float]:
        """Return the state of the laws with state."""
        values: list[float] = []
        for law in self._laws:
            if law.remembers:
                values += self.memory_of(law, memory).tolist()
        return values

    def skipped(self, memory: Any) -> dict[str, int]:
        """Return the number of periods skipped because of NaN inputs, by axis, where not 0."""
        counts: dict[str, int] = {}
        for law in self._laws:
            if isinstance(law, on_plant.TextLaw):
                program = law.program(self.arithmetic)
                for axis, count in program.skipped(self.memory_of(law, memory)).items():
                    counts[axis] = max(count, counts.get(axis, 0))
        return {axis: count for axis, count in counts.items() if count}


class RunRecord:
    """The state of a run: the arrays that the loop writes.

    Parameters
    ----------
    course : Course
        The experiment.
    memory : array_like
        Initial state of the laws.
    taps : sequence of int
        Recorded cells of the board.
    seed : int, optional
        Seed of the initial state.
    between : bool, optional
        Whether errors are summed over all control periods, see :meth:`squares`.
    room : ndarray, optional
        Buffer for the recorded cells, at least one number for each and each set point.
    """

    def __init__(
        self,
        course: Course,
        memory: Any,
        taps: Any,
        seed: int | None = None,
        *,
        between: bool = True,
        room: NDArray[np.float64] | None = None,
    ) -> None:
        self.course, self.seed = course, seed
        count = len(course.motion.time)

        def new(values: Any, kind: type = np.float64) -> Any:
            return flat(values, kind, as_array=course.as_array)

        self.columns = len(taps)
        self.memory = new(memory)
        self.taps = new(taps, np.int64)
        self.board = new(np.zeros(course.board_size))
        self.state = course.state(seed)
        self.clock = course.clock(between=between)
        size = self.columns * count
        room = np.zeros(size) if room is None else room[:size]  # large: not copied
        self.record: Any = room if course.as_array else view(room)
        self.progress = new([0, -1, -1, 0, 0, count, 0], np.int64)

    def block(self, program: LoopProgram, experiment: Mapping[str, Any] | None = None) -> LoopBlock:
        """Return the argument of the loop: the parts of an experiment, of a program, and these.

        `experiment` is the result of :meth:`Course.parts` at the start, for a run that continues.
        """
        if experiment is None:
            experiment = self.course.parts(self.seed)
        return LoopBlock(
            **experiment,
            **program.parts(as_array=self.course.as_array),
            memory=self.memory,
            taps=self.taps,
            board=self.board,
            state=self.state,
            clock=self.clock,
            record=self.record,
            progress=self.progress,
        )

    @property
    def rows(self) -> NDArray[np.float64]:
        """The samples so far, shape (samples, taps): a view."""
        every = np.asarray(self.record).reshape(self.columns, len(self.course.motion.time))
        return np.asarray(every[:, : int(self.progress[SAMPLES])].T)

    @property
    def taken(self) -> NDArray[np.int64]:
        """Indices of the sampled set points."""
        return self.course.whole[: int(self.progress[SAMPLES])]

    @property
    def next(self) -> int:
        """Number of completed set points."""
        return int(self.progress[NEXT])

    def go_on(self, until: int) -> None:
        """Set the set point before which the next call of the loop stops."""
        self.progress[UNTIL] = until

    def changes(self, kind: int) -> NDArray[np.float64]:
        """Return for each drive the mean over all periods of a sum of its changes."""
        sums = np.array(self.clock[CLOCK_SIZE : self._errors]).reshape(CHANGES, -1)[kind]
        return np.asarray(sums / max(self.ticks - 1, 1))

    def squares(self, kind: int) -> NDArray[np.float64]:
        """Return for each tracked output the mean squared error over all control periods.

        Periods with a NaN error do not count.
        """
        counted = self.ticks - self.errors(UNKNOWN)
        return np.where(counted > 0, self.errors(kind) / np.maximum(counted, 1.0), np.nan)

    def errors(self, kind: int) -> NDArray[np.float64]:
        """Return a row of ``note_errors``, one number for each tracked output."""
        return np.asarray(np.array(self.clock[self._errors :]).reshape(ERRORS, -1)[kind])

    @property
    def _errors(self) -> int:
        """Index of the sums of errors in the clock."""
        return CLOCK_SIZE + CHANGES * len(self.course.site.interface.inputs)

    @property
    def ticks(self) -> int:
        """Number of completed control periods."""
        return int(self.progress[TICK])

    @property
    def lost(self) -> int | None:
        """The set point of divergence."""
        point = int(self.progress[LOST])
        return None if point < 0 else point

    def diverged(self) -> float | None:
        """Time of divergence, s."""
        return None if self.lost is None else self.ticks * self.course.motion.period


def error_taps(course: Course) -> list[int]:
    """Return the cells of the tracked outputs, then those of their references."""
    tracked = course.motion.tracked
    return [
        *(course.output_cell(port) for port in tracked),
        *(course.reference_cell(port) for port in tracked),
    ]


def shown_errors(course: Course, samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the errors of the first columns of :func:`error_taps`, in displayed units."""
    count = len(course.motion.tracked)
    # One row for each tap: along columns NumPy would stride.
    taps = np.ascontiguousarray(samples.T)
    with np.errstate(over="ignore"):  # a diverged run may overflow in degrees
        return np.asarray(((taps[count : 2 * count] - taps[:count]) * scales(course)[:, None]).T)


def shown_means(course: Course, record: RunRecord, kind: int) -> NDArray[np.float64]:
    """Return RMS errors over all control periods, in displayed units; see :class:`RunRecord`."""
    return np.asarray(np.sqrt(record.squares(kind)) * scales(course))


EVERY_PERIOD: Mapping[str, Callable[[Course, RunRecord], NDArray[np.float64]]] = MappingProxyType({
    "rms_periods": lambda course, record: shown_means(course, record, HELD),
    "rms_path": lambda course, record: shown_means(course, record, ALONG_PATH),
})  # fmt: skip
"""Metrics of the tracked outputs from sums over all control periods, by name."""


def scales(course: Course) -> NDArray[np.float64]:
    """Return the display scale of each tracked output: degrees for radians."""
    outputs = course.site.interface.outputs
    turn = 180.0 / course.conventions.pi
    return np.array([turn if outputs[p].unit == "rad" else 1.0 for p in course.motion.tracked])


def shown_units(course: Course) -> tuple[str, ...]:
    """Return the displayed units of the tracked outputs."""
    units = [course.site.interface.outputs[port].unit for port in course.motion.tracked]
    return tuple("degrees" if unit == "rad" else unit for unit in units)


# --- Loops with plain Python in them ---


def loop_for(program: LoopProgram, course: Course, record: RunRecord) -> Loop:
    """Return the loop for a program; plain Python functions are bound to the record's arrays."""
    single = course.conventions.single
    if program.compilable and is_compiled(course.plant):
        return loop_of_laws(program, course)
    bindings: dict[str, Callable[..., Any]] = _held(single)
    if not is_compiled(course.plant) or is_traced(course.plant):
        bindings |= plain_plant(course)
    if not program.compilable:
        bindings["control"] = plain_control(program, course)
    elif program.arithmetic.compiled:
        bindings["control"] = compiled_law(program, course, record)
    return with_names(run_loop, bindings)


AddendStep = Callable[[Any], Iterable[tuple[int, float]]]
"""From an observation to increments of drives: index of the input, value."""


def plain_control(program: LoopProgram, course: Course) -> Callable[..., None]:
    """Return the `control` function of a controller in plain Python, addend by addend."""
    parts = list(program.controller.parts())
    if not any(part.takes_ports for part in parts):
        parts = [program.controller]  # it adds its torques itself
    controls = [_addend_step(part, program.arithmetic, course) for part in parts]
    zeros = range(len(course.site.interface.inputs))

    def control(signals: Any, *others: Any) -> None:
        drives = others[-1]
        for column in zeros:
            drives[column] = 0.0
        for ask in controls:
            for column, value in ask(signals):
                drives[column] += value

    return control


def _addend_step(part: Controller, arithmetic: RunArithmetic, course: Course) -> AddendStep:
    if isinstance(part, RobotLaw):
        return _robot_step(part, course)
    if part.takes_ports:
        return _port_step(part, course)
    law = on_plant.text_law_of(part)
    if law is not None and course.site.extra == 0:
        return _text_step(part, law, arithmetic, course)
    return _torque_step(part)


def _torque_step(part: Controller) -> AddendStep:
    def ask(t: Any) -> Iterable[tuple[int, float]]:
        # The layout of `write_observation` in fuzzyarm.control.controllers.law.
        reference = ArmReference((t[3], t[4]), (t[5], t[6]), (t[7], t[8]))
        state = State((t[9], t[10]), (t[11], t[12]))
        clock = Clock(t[0], t[1] != 0.0, t[2] != 0.0)
        with _named(part):
            first, second = part.torque(reference, state, clock)
        return (0, float(first)), (1, float(second))

    return ask


def _robot_step(part: RobotLaw, course: Course) -> AddendStep:
    """Return the step of a law on all joints of a robot."""
    interface = course.site.interface
    columns = [at for at, port in enumerate(interface.inputs) if port[1] in EFFORTS]
    axes = [axis for axis, port in interface.inputs if port in EFFORTS]
    references, outputs = list(interface.references), list(interface.outputs)
    first = CLOCK + len(references)
    cells = [
        [CLOCK + references.index((axis, port)) for axis in axes]
        for port in ("position", "velocity", "acceleration")
    ] + [
        [first + outputs.index((axis, port)) for axis in axes] for port in ("position", "velocity")
    ]

    def ask(signals: Any) -> Iterable[tuple[int, float]]:
        at, v, a, position, velocity = (np.array([signals[cell] for cell in row]) for row in cells)
        last, step = signals[LAST] != 0.0, float(signals[PERIOD])
        now = JointMoment(at, v, a, position, velocity, last, step)
        with _named(part):
            torques = part.torques(now)
        return zip(columns, torques.tolist(), strict=True)

    return ask


def _text_step(
    part: Controller, law: on_plant.TextLaw, arithmetic: RunArithmetic, course: Course
) -> AddendStep:
    """Return the step of a controller as text beside one in Python."""
    gains = {
        gain.name: part.gains[gain.name].value
        for gain in law.gains
        if part.gains[gain.name].value != gain.value
    }
    run = ControllerRun(
        law.text, gains=gains, single=arithmetic.single, compiled=arithmetic.compiled
    )
    cells = law.site.wiring(law.text.model)
    first = course.site.observation_end + len(course.site.interface.inputs)
    references = list(zip(run.references, cells.references.values(), strict=True))
    measured = list(zip(run.inputs, cells.measured.values(), strict=True))
    columns = {
        name: cell - first for name, cell in zip(run.drives, cells.drives.values(), strict=True)
    }

    def ask(signals: Any) -> Iterable[tuple[int, float]]:
        drives = run.step(
            {name: signals[cell] for name, cell in measured},
            {name: signals[cell] for name, cell in references},
        )
        return [(columns[name], value) for name, value in drives.items()]

    return ask


def _port_step(part: Controller, course: Course) -> AddendStep:
    """Return the step of a controller in Python with values by port name."""
    site = course.site
    label = site.interface.label
    references = _cells_of(site, site.interface.references, CLOCK)
    measured = _cells_of(site, site.interface.outputs, CLOCK + len(references))
    columns = _cells_of(site, site.interface.inputs, 0)
    names = {label(port) for port in course.driven}
    only = next(iter(names)) if len(names) == 1 else ""
    for name, port in site.connect.items():
        homes = [cells for cells in (references, measured, columns) if port in cells]
        if not homes:
            hint = near_hint(port, [*measured, *columns])[0]
            raise SourceError(f"the {site.name} has no port '{port}'", hint=hint)
        for cells in homes:
            cells[name] = cells[port]

    def ask(signals: Any) -> Iterable[tuple[int, float]]:
        with _named(part):
            drives = part.step(
                _NamedValues({name: float(signals[cell]) for name, cell in measured.items()}),
                _NamedValues({name: float(signals[cell]) for name, cell in references.items()}),
            )
        if not isinstance(drives, Mapping):
            if not only:
                hint = f"return a mapping of {', '.join(sorted(names))}"
                message = f"{part.name} does not name the input that it drives"
                raise SourceError(message, hint=hint)
            drives = {only: drives}
        for name in drives:
            if name not in columns:
                hint = near_hint(name, columns)[0] or f"it has {', '.join(columns)}"
                raise SourceError(f"the {site.name} has no drive '{name}'", hint=hint)
        return [(columns[name], _number(part, name, value)) for name, value in drives.items()]

    return ask


class _NamedValues(dict[str, float]):
    """Values by name; the error for a missing name lists the others."""

    def __missing__(self, name: str) -> NoReturn:
        raise KeyError(f"no '{name}' among {', '.join(self) or 'nothing'}")


def _cells_of(site: on_plant.Site, ports: Iterable[Address], first: int) -> dict[str, int]:
    return {site.interface.label(port): first + at for at, port in enumerate(ports)}


def _number(part: Controller, name: str, value: Any) -> float:
    with suppress(TypeError, ValueError):
        number = float(value)
        if not math.isnan(number):
            return number
    raise SourceError(f"{part.name} gives {value!r} for '{name}', not a number")


@contextmanager
def _named(part: Controller) -> Iterator[None]:
    """Attribute errors to the controller, since the same loop calls the plant."""
    try:
        yield
    except FuzzyarmError:
        raise
    except USERS as error:
        message = f"controller {part.name} failed: {failure_of(part, error)}"
        raise SourceError(message) from error


def compiled_law(program: LoopProgram, course: Course, record: RunRecord) -> Callable[..., None]:
    """Return a call of compiled laws for a loop in plain Python, on the arrays of a record."""
    parts = program.parts(as_array=True)
    board = np.asarray(record.board)
    size = len(course.site.interface.inputs)
    signals = board[: course.site.observation_end + size]
    drives, memory = board[len(board) - size :], np.asarray(record.memory)
    arrays = (signals, parts["laws"], parts["numbers"], memory, drives)
    precision = _held(course.conventions.single)
    step = bound_routine(drives_of_laws, "fifff", arrays, precision, brief=True)

    def control(*_arrays: object) -> None:
        step()

    return control


def plain_plant(course: Course) -> dict[str, Callable[..., Any]]:
    """Return the calls of a plant in plain Python."""
    plant, states = course.plant, len(course.plant.states)
    moved, measured = plain_motion(plant, states), plain_outputs(plant, states)

    def ask_plant(task: int, _links: Any, x: Any, y: Any, u: Any, p: Any, clock: Any) -> None:
        (moved if task == ADVANCE else measured)(x, y, u, p, clock)

    def goes_on(*watched: Any) -> bool:
        return not plant.ended and within(*watched)

    return {"ask_plant": ask_plant, "within": goes_on}
