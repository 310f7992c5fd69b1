"""An experiment as arrays of the loop kernel: set points, plant, sensors, disturbances, limits."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from copy import copy
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import UsageError
from fuzzyarm.base.keywords import demand_arguments
from fuzzyarm.base.numbers import is_whole, whole_periods
from fuzzyarm.control.controllers.law import view
from fuzzyarm.control.controllers.on_plant import Site, site_of
from fuzzyarm.control.loop.loop import CHANGES, ERRORS, SENSOR, LoopConstants
from fuzzyarm.control.loop.reference import (
    AnySignal,
    AnyTime,
    Signal,
    as_number,
    as_seconds,
    as_signal,
)
from fuzzyarm.plant.actuators import dead_time_rows
from fuzzyarm.plant.own import for_runs, start_of
from fuzzyarm.plant.plant import (
    CLOCK_SIZE,
    IN_SINGLE,
    PARTS,
    STEP,
    WORK,
    Address,
    Dynamics,
    Plant,
    PlantError,
    dynamics_of,
    is_compiled,
    is_traced,
    numbers_of,
)
from fuzzyarm.plant.setting import CLOCK, PLAIN, ArmError, Conventions, Pair, RunArithmetic
from fuzzyarm.symbolic.kernels import has_machine_code

Vector = NDArray[np.float64]


# --- Options of a run ---


class OptionError(ArmError, PlantError, UsageError):
    """A run option out of range."""


@dataclass(frozen=True, init=False)
class Sensor:
    """The model of a sensor.

    Parameters
    ----------
    noise : float, optional
        Standard deviation of white noise, in the unit of the port.
    resolution : float, optional
        Quantisation step; values are its multiples within the range of the port; 0 for none.
    delay : float or str, optional
        s, or with its unit, as in ``"2ms"``; rounded to whole control periods, halves up.
    difference : float or str, optional
        Form this rate as the filtered difference of the measured value of its port instead of with
        a sensor of its own: time constant of the filter, s or with its unit, 0 for none.
    """

    noise: float
    resolution: float
    delay: float
    difference: float | None

    def __init__(
        self,
        noise: float = 0.0,
        resolution: float = 0.0,
        delay: AnyTime = 0.0,
        difference: AnyTime | None = None,
    ) -> None:
        if difference is not None:
            difference = as_seconds(difference, "difference")
        noise, resolution = as_number(noise, "noise"), as_number(resolution, "resolution")
        values = (noise, resolution, as_seconds(delay, "delay"), difference)
        for name, value in zip(("noise", "resolution", "delay", "difference"), values, strict=True):
            object.__setattr__(self, name, value)
            if value is not None and not 0.0 <= value < 1e12:
                hint = "zero or a positive number"
                raise OptionError(f"{name} = {value} is out of range", name=name, hint=hint)


LARGEST_INDUCTANCE = 10.0
"""H; a larger value is taken as a typing error."""


@dataclass(frozen=True)
class Options:
    """Run options beyond the conventions.

    Parameters
    ----------
    torque_limits : pair of float, optional
        Joint torques of an arm, N m; infinite by default.
    inductance : float, optional
        Armature inductance of the motors, H; 0 by default.
    supply : float, optional
        Largest motor voltage, V; infinite by default.
    runge_kutta : int, optional
        Steps of the integrator in each control period; 0 for the plant's own integrator, if any,
        else for the necessary number.
    disturbance : float, optional
        Largest relative disturbance of each state at each step.
    seed : int, optional
        Seed of disturbance and noise.
    compiled : bool, optional
        Whether to run machine code; by default by the environment.
    interpolate : bool, optional
        Whether the reference is interpolated linearly between set points instead of held.
    sensors : mapping of str to Sensor, optional
        By port; other sensors are ideal.
    loads : mapping of str to Signal, str or float, optional
        By input: disturbance added to a drive after its limits; a signal like a reference.
    """

    torque_limits: Pair = (math.inf, math.inf)
    inductance: float = 0.0
    supply: float = math.inf
    runge_kutta: int = 0
    disturbance: float = 0.0
    seed: int = 1
    compiled: bool | None = None
    interpolate: bool = False
    sensors: Mapping[str, Sensor] = field(default_factory=dict)
    loads: Mapping[str, AnySignal] = field(default_factory=dict)

    def __post_init__(self) -> None:
        demand_arguments("Options", vars(self), type(self))
        for limit in self.torque_limits:
            if not limit > 0:
                raise OptionError(f"a torque limit of {limit} N m is out of range", value=limit)
        if not 0.0 <= self.inductance < LARGEST_INDUCTANCE:
            message = f"an inductance of {self.inductance} H is out of range"
            raise OptionError(message, value=self.inductance, hint="0 to 10")
        if not self.supply > 0:
            raise OptionError(f"a supply of {self.supply} V is out of range", value=self.supply)
        if self.seed < 0:
            message = f"a seed of {self.seed} is out of range"
            raise OptionError(message, name="seed", hint="0 or more")
        if not 0 <= self.runge_kutta <= 1000:
            message = f"{self.runge_kutta} Runge-Kutta steps in a control period are out of range"
            raise OptionError(message, name="runge_kutta", hint="0 to 1000")

    def arithmetic(self, conventions: Conventions) -> RunArithmetic:
        """Return the arithmetic of the laws under these conventions."""
        compiled = has_machine_code() if self.compiled is None else self.compiled
        return RunArithmetic(conventions.single, conventions.pi, compiled)


# --- The references of a run ---


@dataclass(frozen=True, eq=False)
class Motion:
    """Set points of a run.

    Attributes
    ----------
    name : str
        Its name in reports.
    time : ndarray, shape (n,)
        s.
    references : ndarray, shape (n, R)
        In the order of the plant's references.
    iterations : ndarray of int64, shape (n,)
        Control periods of each set point.
    block : ndarray of int64, shape (n,)
        Index into `plants`, for each set point.
    plants : tuple of Plant
        One, or one for each load.
    tracked : tuple of (str, str)
        The outputs whose errors are measured.
    period, step : float
        Control period, s; exact, and as stored in the precision of the run.
    every : int
        Control periods of a whole set point.
    path : ndarray, shape (m, k), optional
        The reference of each tracked output in each of the `m` control periods, where set points
        are samples of a moving reference; by default the set points themselves.
    along : bool, optional
        Whether it is a trajectory of the plant.
    carrying : tuple of bool, optional
        Whether each of the plants carries its load.
    duration : float, optional
        Requested duration, s; a run takes whole set points.
    """

    name: str
    time: Vector
    references: Vector
    iterations: NDArray[np.int64]
    block: NDArray[np.int64]
    plants: tuple[Plant, ...]
    tracked: tuple[Address, ...]
    period: float
    step: float
    every: int
    path: Vector | None = None
    along: bool = False
    carrying: tuple[bool, ...] = ()
    duration: float | None = None

    @property
    def sampled(self) -> Vector:
        """Sampling time of each set point, s: that of its last control period."""
        return np.asarray((np.cumsum(self.iterations) - 1) * self.period, np.float64)


MOST_POINTS = 20_000_000
"""Largest number of set points of a run."""


def require_points(duration: float, set_point: float) -> int:
    """Return the number of set points in a duration; PlantError for none or too many."""
    count = math.ceil(duration / set_point - 1e-9) if duration < math.inf else 0
    if not 1 <= count <= MOST_POINTS:
        hint = f"up to {MOST_POINTS:,} set points of {set_point:g} s"
        raise OptionError(f"a run of {duration:g} s is out of range", name="duration", hint=hint)
    return count


def motion(
    plant: Plant,
    references: Mapping[str, Signal],
    duration: float,
    period: float,
    every: int = 1,
) -> Motion:
    """Return the set points of any plant.

    Parameters
    ----------
    plant : Plant
        The plant.
    references : mapping of str to Signal
        By port; other ports have the reference 0. The first is tracked.
    duration : float
        s.
    period : float
        Of control, s.
    every : int, optional
        Control periods of a set point.

    Raises
    ------
    PlantError
        If the plant has no such output, or the run would be too long.
    """
    interface = site_of(plant).interface
    count = require_points(duration, period * every)
    time = np.arange(count, dtype=np.float64) * (period * every)
    values_by_port = {}
    for name, signal in references.items():
        port = interface.port(name)
        if port not in interface.outputs:
            raise PlantError(f"'{name}' is an input, which has no reference", name=name)
        values_by_port[port] = signal.at(time)
    # References of rates and accelerations without a signal are derivatives of the port's signal.
    columns = np.zeros((count, len(interface.references)))
    for column, (address, reference) in enumerate(interface.references.items()):
        if address in values_by_port:
            columns[:, column] = values_by_port[address][0]
        elif reference.of in values_by_port:
            columns[:, column] = values_by_port[reference.of][reference.order]
    words = [f"{name} {signal}" for name, signal in references.items()]
    tracked = tuple(values_by_port) or tuple(interface.outputs)[:1]
    path = None
    # Between held set points the reference itself moves on: sampled in every control period.
    if every > 1:
        signals = {interface.port(name): signal for name, signal in references.items()}
        ticks = np.arange(count * every, dtype=np.float64) * period
        path = np.zeros((len(ticks), len(tracked)))
        for column, port in enumerate(tracked):
            if port in signals:
                path[:, column] = signals[port].at(ticks)[0]
    return Motion(
        ", ".join(words) or "at rest",
        time,
        columns,
        np.full(count, every),
        np.zeros(count, np.int64),
        (plant,),
        tracked,
        period,
        period,
        every,
        path,
        duration=duration,
    )


def delay_notes(options: Options, period: float) -> tuple[str, ...]:
    """Return notes on delays rounded to whole control periods."""
    notes = []
    for name, sensor in options.sensors.items():
        count = whole_periods(sensor.delay, period)
        if not is_whole(sensor.delay, period):
            notes.append(
                f"the delay of '{name}' is {sensor.delay / period:.12g} control periods of "
                f"{period:g} s: {count} are taken, {count * period:g} s"
            )
    return tuple(notes)


def duration_notes(motion: Motion) -> tuple[str, ...]:
    """Return a note on a duration rounded to whole set points."""
    set_point = motion.every * motion.period
    whole = len(motion.time) * set_point
    if motion.duration is None or math.isclose(whole, motion.duration, rel_tol=1e-6):
        return ()
    counted = f"{motion.duration:g} s are not a whole number of set points of {set_point:g} s"
    return (f"{counted}: {whole:g} s are run",)


def range_notes(motion: Motion, site: Site) -> tuple[str, ...]:
    """Return notes on set points outside the range of their sensor."""
    notes = []
    for column, (address, reference) in enumerate(site.interface.references.items()):
        port = site.interface.outputs.get(address)
        if port is None or reference.order or not len(motion.references):
            continue
        points = motion.references[:, column]
        furthest = points.max() if points.max() > port.high else points.min()
        if not port.low <= furthest <= port.high:
            label, unit = site.interface.label(address), f" {port.unit}" if port.unit else ""
            notes.append(
                f"the set point {furthest:g}{unit} of '{label}' is beyond its range, "
                f"{port.low:g} .. {port.high:g}"
            )
    return tuple(notes)


# --- Arrays of the loop ---


def flat(values: Any, kind: type = np.float64, *, as_array: bool = True) -> Any:
    """Return numbers as one flat array, or for the interpreter as a memory view of it."""
    row: NDArray[Any] = np.ascontiguousarray(np.array(values, kind).ravel())
    return row if as_array else view(row)


class Course:
    """An experiment as arrays of the loop kernel.

    Parameters
    ----------
    motion : Motion
        Set points and plants.
    conventions : Conventions
        Precision and π.
    options : Options
        The rest of the setting.
    driven : collection of (str, str)
        Inputs driven by the controller.
    as_array : bool
        Arrays for machine code, or views for the interpreter.
    connect : mapping of str to str, optional
        From names of the controller to ports of the plant, if they differ.

    Attributes
    ----------
    dynamics : Dynamics or None
        The kernel shared by all plants of the kind; None for a plant in plain Python.
    """

    def __init__(
        self,
        motion: Motion,
        conventions: Conventions = PLAIN,
        options: Options | None = None,
        *,
        driven: Collection[Address] = (),
        as_array: bool,
        connect: Mapping[str, str] | None = None,
    ) -> None:
        self.motion = motion
        self.conventions = conventions
        self.options = options or Options()
        self.as_array = as_array
        self.plant = for_runs(motion.plants[0])
        self.site = site_of(self.plant, connect)
        self.arithmetic = self.options.arithmetic(conventions)._replace(compiled=as_array)
        self.driven = driven
        self.steps = int(motion.iterations.sum())
        # Only set points with all their periods are sampled (if the run gets that far).
        self.whole = np.flatnonzero(motion.iterations == motion.every)
        self.dynamics = self._dynamics()
        cells, bounds = self._checks()
        path: Any = [] if motion.path is None else motion.path
        self._parts: dict[str, Any] = {
            "references": self._flat(motion.references),
            "iterations": self._flat(motion.iterations, np.int64),
            "links": self._flat(self._write_links(), np.int64),
            "pushes": self._flat(self._pushes()),
            "checks": self._flat(cells, np.int64),
            "bounds": self._flat(bounds),
            "path": self._flat(path),
            **self._meeting(),
            **self._sensing(self.options.seed),
        }
        self._setting = LoopConstants(
            motion.step,
            conventions.single,
            motion.every,
            self.options.interpolate,
            float(self.options.disturbance),
            self.options.seed,
            len(self.plant.states),
        )

    # --- Cells of the board: as `frame_of` of fuzzyarm.control.loop.loop divides it ---

    @property
    def _seen(self) -> int:
        return CLOCK + len(self.site.interface.references)

    @property
    def _true(self) -> int:
        """Cell of the first true output: after the observation and the scratch for drives."""
        return self.site.observation_end + len(self.site.interface.inputs)

    @property
    def board_size(self) -> int:
        """Number of cells."""
        outputs = len(self.site.interface.outputs) + self.site.extra
        return self._true + outputs + len(self.site.interface.inputs)

    def reference_cell(self, port: Address) -> int:
        """Return the cell of a reference."""
        return CLOCK + list(self.site.interface.references).index(port)

    def output_cell(self, port: Address) -> int:
        """Return the cell of a true output."""
        first = self._true if self.options.sensors else self._seen
        return first + list(self.site.interface.outputs).index(port)

    def drive_cell(self, port: Address) -> int:
        """Return the cell of a drive after actuators and loads."""
        outputs = len(self.site.interface.outputs) + self.site.extra
        return self._true + outputs + list(self.site.interface.inputs).index(port)

    # --- Parts ---

    def _flat(self, values: Any, kind: type = np.float64) -> Any:
        return flat(values, kind, as_array=self.as_array)

    def _write_links(self) -> list[int]:
        size = len(numbers_of(self.plant, self.driven, self.arithmetic))
        dynamics = self.dynamics
        if dynamics is None:
            return [0, size, 0, 0]
        return [dynamics.address, size, int(dynamics.actuates), int(dynamics.extra > 0)]

    def _dynamics(self) -> Dynamics | None:
        if not is_compiled(self.plant):
            return None
        finely = self.options.runge_kutta > 0
        return dynamics_of(self.plant, self.arithmetic, finely=finely)

    def _meeting(self) -> dict[str, Any]:
        """Return the parameter blocks of all plants, and the block of each set point."""
        plants = self.plant, *self.motion.plants[1:]
        blocks = [numbers_of(plant, self.driven, self.arithmetic) for plant in plants]
        return {
            "plant_of": self._flat(self.motion.block, np.int64),
            "plants": self._flat(blocks),
        }

    def with_plants(self, motion: Motion) -> Course:
        """Return the same experiment with other plants of the kind."""
        other = copy(self)
        other.motion = motion
        other.plant = for_runs(motion.plants[0])
        if is_traced(other.plant) != is_traced(self.plant):  # a program of one, numbers of another
            raise PlantError(f"the equations of {self.plant.name} change from run to run")
        other._parts = {**self._parts, **other._meeting()}
        return other

    def with_options(self, options: Options) -> Course:
        """Return the same experiment with other sensors and state disturbances."""
        other = copy(self)
        other.options = options
        other._parts = {**self._parts, **other._sensing(options.seed)}
        other._setting = self._setting._replace(disturbance=float(options.disturbance))
        return other

    def _sensing(self, seed: int) -> dict[str, Any]:
        """Return sensor records and noise; both empty if all sensors are ideal."""
        sensors, noise = self._sensor_numbers(seed)
        return {"sensors": self._flat(sensors), "noise": self._flat(noise)}

    def _sensor_numbers(self, seed: int) -> tuple[list[float], Any]:
        interface = self.site.interface
        sensors = {
            port: record
            for name, record in self.options.sensors.items()
            for port in interface.every_port(name)
        }
        for port in sensors:
            if port not in interface.outputs:
                message = f"'{interface.label(port)}' is an input, which has no sensor"
                raise PlantError(message, name=interface.label(port))
        if not sensors:
            return [], []
        # Ten numbers for each sensor in the order of `loop.SENSOR`, then the rings of delayed
        # values; `ring` is where the next one begins.
        heads: list[float] = []
        ring = SENSOR * (len(interface.outputs) + self.site.extra)
        noisy: list[float] = []
        for port, output in interface.outputs.items():
            sensor = sensors.get(port, Sensor())
            # A longer delay has no effect in this run, but takes memory.
            delay = min(whole_periods(sensor.delay, self.motion.period), self.steps)
            source = -1
            if sensor.difference is not None:
                if not output.rate_of:
                    label = interface.label(port)
                    raise PlantError(f"'{label}' is not the rate of another output", name=label)
                source = list(interface.outputs).index((port[0], output.rate_of))
            column = len(noisy) if sensor.noise > 0 else -1
            if sensor.noise > 0:
                noisy.append(sensor.noise)
            heads += [sensor.resolution, output.low, output.high, delay, ring, source]
            heads += [sensor.difference or 0.0, math.nan, 0.0, column]
            ring += delay
        # Quantities that a plant derives from its outputs have ideal sensors.
        exact = [0.0, -math.inf, math.inf, 0.0, 0.0, -1.0, 0.0, math.nan, 0.0, -1.0]
        heads += exact * self.site.extra
        heads += [0.0] * (ring - len(heads))
        noise = np.random.default_rng(seed).standard_normal((self.steps, len(noisy)))
        return heads, noise * noisy

    def _pushes(self) -> Any:
        loads = {
            # One row for each control period, one column for each input, evaluated beforehand.
            port: as_signal(signal)
            for name, signal in self.options.loads.items()
            for port in self.site.interface.every_port(name)
        }
        if not loads:
            return []
        ports = self.plant.particulars.disturbed or tuple(self.plant.inputs)
        time = np.arange(self.steps, dtype=np.float64) * self.motion.period
        columns = np.zeros((self.steps, len(self.site.interface.inputs)))
        for (column, port), name in zip(
            enumerate(self.site.interface.inputs), self.plant.inputs, strict=True
        ):
            if port not in loads:
                continue
            if name not in ports:
                message = f"a load of the {self.plant.name} acts on {', '.join(ports)}"
                raise PlantError(message, name=name, hint=f"{ports[0]}=step:-2,1")
            columns[:, column] = loads.pop(port).at(time)[0]
        if loads:
            label = self.site.interface.label(next(iter(loads)))
            raise PlantError(f"'{label}' is an output; a load acts on an input", name=label)
        return columns

    def _checks(self) -> tuple[list[int], list[float]]:
        # Pairs of cells: a reference (-1: none) and the output to stay near it, or near 0.
        cells: list[int] = []
        bounds: list[float] = []
        for port in self.motion.tracked:
            if self.site.interface.outputs[port].error_bound < math.inf:
                cells += [self.reference_cell(port), self.output_cell(port)]
                bounds.append(self.site.interface.outputs[port].error_bound)
        for port, output in self.site.interface.outputs.items():
            if output.bound < math.inf:
                cells += [-1, self.output_cell(port)]
                bounds.append(output.bound)
        return cells, bounds

    # --- Arguments of the loop ---

    def parts(self, seed: int | None = None, loads: Any = None) -> dict[str, Any]:
        """Return the experiment's parts of a :class:`LoopBlock`, by name, for one run.

        Limits and sensors have state, so each run gets its own copy. `seed` and `loads` override
        those of the options.
        """
        run_seed = self._setting.seed if seed is None else seed
        # The generator has 31 bits.
        setting = self._flat(self._setting._replace(seed=run_seed % 2**31))
        parts = {**self._parts, "setting": setting, "limits": self._flat(self._limits())}
        ports = self.site.interface.inputs.values()
        parts["dead_times"] = self._flat(
            dead_time_rows(list(ports), self.motion.period, self.steps)
        )
        if len(parts["sensors"]):
            # Noise is drawn anew only for another seed.
            own = {"sensors": self._flat(parts["sensors"])}
            parts |= own if run_seed == self.options.seed else self._sensing(run_seed)
        if loads is not None:
            parts["pushes"] = loads
        return parts

    def loads(self) -> Any:
        """Return the drive disturbances of every control period, to be overwritten by hand."""
        load_array = self._parts["pushes"]
        if len(load_array):
            return self._flat(load_array)
        # Adding -0.0 keeps every bit of a drive; adding 0.0 would turn -0.0 into 0.0.
        return self._flat(np.full(self.steps * len(self.site.interface.inputs), -0.0))

    def _limits(self) -> list[float]:
        period = self.motion.period
        rows: list[float] = []
        for port in self.site.interface.inputs.values():
            rows += [port.low, port.high, port.slew * period, port.idle]
        return rows

    def clock(self, *, between: bool = True) -> Any:
        """Return the initial clock of the plant, followed by the sums of changes and errors.

        Without `between` the sums of errors over all control periods are left out.
        """
        parts = self.options.runge_kutta
        if not parts:
            parts = max(1, math.ceil(self.motion.period / self.plant.longest_step - 1e-9))
        errors = ERRORS * len(self.motion.tracked) if between else 0
        sums = CHANGES * len(self.site.interface.inputs) + errors
        clock = np.zeros(CLOCK_SIZE + sums)
        clock[STEP], clock[PARTS] = self.motion.step, parts
        clock[IN_SINGLE] = float(self.conventions.single)
        return self._flat(clock)

    def state(self, seed: int | None = None) -> Any:
        """Return the initial states, followed by the scratch of the integrator."""
        generator = np.random.default_rng(self._setting.seed if seed is None else seed)
        start = start_of(self.plant, generator)
        size = self.plant.particulars.room or (1 + WORK) * len(start)
        return self._flat([*start, *[0.0] * (size - len(start))])
