"""The subject of a claim about a closed loop: controller, plant, parameters, starts, set point.

The loop is that of :mod:`fuzzyarm.loop.loop`: in each control period sensors read the outputs,
then the controller runs, then the limits of the actuators hold, then the plant moves on with its
inputs held. :class:`ControlPeriod` does one such period, up to the inputs of the plant, over any
kind of number (an :class:`Algebra`): affine forms for certificates, zonotopes for tubes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from fuzzyarm.controller.on_plant import Site, site_of
from fuzzyarm.controller.program import AXIS, SourceError, of_axis
from fuzzyarm.controller.text import ControllerText
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.expression.evaluation import specialise
from fuzzyarm.expression.nodes import Node, constant, substituted, symbol, symbols
from fuzzyarm.expression.operations import Interval
from fuzzyarm.expression.sources import SourceKind, unseen
from fuzzyarm.loop.course import Sensor, periods_of
from fuzzyarm.model.controller import Axes, Drive, Factor, Learn, Product, SignalLine, Source, Zoom
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.plant.equations import expressions_of, has_queue
from fuzzyarm.plant.own import start_of
from fuzzyarm.plant.plant import Address, Plant, Port, parameter, with_parameters
from fuzzyarm.table import LookupTable
from fuzzyarm.text.names import near_hint
from fuzzyarm.text.numbers import number_text

__all__ = [
    "Algebra",
    "ControlPeriod",
    "LoopProblem",
    "LoopProofError",
    "PlantEquations",
    "loop_problem",
]


class LoopProofError(FuzzyarmError, ValueError):
    """Nothing can be proved about a loop; the message says why."""

    def __init__(self, message: str, *, hint: str = "") -> None:
        super().__init__(message, hint=hint)


class ClaimError(LoopProofError):
    """A claim uses a name that its plant does not have, or an interval with its ends exchanged."""


# ── the record ───────────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class PlantEquations:
    """The equations of a plant as expressions over ``t``, ``x0`` …, ``u0`` … and ``p0`` ….

    Attributes
    ----------
    rates : tuple of Node
        Of the states, in their order.
    outputs : tuple of Node
        In the order of the ports.
    states, inputs, parameters : tuple of str
        The symbols, in the order of the plant.
    """

    rates: tuple[Node, ...]
    outputs: tuple[Node, ...]
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    parameters: tuple[str, ...]


@dataclass(frozen=True)
class LoopProblem:
    """A closed loop, and where it starts.

    Attributes
    ----------
    text : ControllerText
        The controller, with its rule bases and tables.
    plant : Plant
        Shipped or a user's, with equations that can be traced.
    site : Site
        How the controller finds the ports.
    start : dict of str to Interval
        Of each state of the plant, by name.
    parameters : dict of str to Interval
        Of all parameters of the plant, by name; most are points.
    set_point : dict of (str, str) to float
        Of each reference of the plant, by axis and port; constant, and 0 for rates.
    sensors : dict of (str, str) to Sensor
        By axis and port; those that are not there are exact.
    begins_alone : tuple of str
        States that begin where the plant says, and not where a claim does.
    unknown_start : str
        Why it is not known where those begin; empty where it is.
    """

    text: ControllerText
    plant: Plant
    site: Site
    start: Mapping[str, Interval]
    parameters: Mapping[str, Interval]
    set_point: Mapping[Address, float]
    sensors: Mapping[Address, Sensor] = field(default_factory=dict)
    begins_alone: tuple[str, ...] = ()
    unknown_start: str = ""

    def require_known_start(self) -> None:
        """Refuse a claim about runs whose start is not one box.

        Raises
        ------
        LoopProofError
            If a state begins where the plant says, and that is not one place.
        """
        if self.unknown_start:
            boxes = ", ".join(f"{name} in LOW .. HIGH" for name in self.begins_alone)
            raise LoopProofError(self.unknown_start, hint=f"say it: from {boxes}")

    @property
    def period(self) -> float:
        """Of control, s."""
        return float(self.text.model.period)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the plant's states."""
        return tuple(self.plant.states)

    @cached_property
    def equations(self) -> PlantEquations:
        """The equations of the plant; LoopProofError if they cannot be traced."""
        plant = self.plant
        roots = expressions_of(plant)
        if roots is None:
            hint = (
                "leave the queue out of the plant and delay its sensor, --sensor-delay PORT=TIME"
                if has_queue(plant)
                else "arithmetic and functions of math in `derivative`, without `if` on a state"
            )
            raise LoopProofError(f"the equations of {plant.name} cannot be traced", hint=hint)
        rates, outputs = roots
        states = tuple(f"x{k}" for k in range(len(plant.states)))
        measured = tuple(symbol(name) for name in states[: len(plant.outputs)])
        inputs = tuple(f"u{k}" for k in range(len(plant.inputs)))
        if any(set(symbols(root)) & set(inputs) for root in outputs or ()):
            raise LoopProofError(f"an output of {plant.name} depends on an input at once")
        return PlantEquations(
            tuple(rates),
            measured if outputs is None else tuple(outputs),
            states,
            inputs,
            tuple(f"p{k}" for k in range(len(plant.parameters))),
        )


def _demand_whole_delays(sensors: Mapping[str, Sensor], period: float) -> None:
    """Refuse a delay that the loop would round: the sentence of a proof has it as it is."""
    for name, sensor in sensors.items():
        count = periods_of(sensor.delay, period)
        if not math.isclose(sensor.delay, count * period, rel_tol=1e-6, abs_tol=1e-12):
            raise LoopProofError(
                f"the delay of '{name}' is {sensor.delay / period:.4g} control periods, and a loop"
                " is proved with whole ones",
                hint=f"{count} of them are {number_text(count * period)} s",
            )


def loop_problem(
    text: ControllerText,
    plant: Plant,
    *,
    start: Mapping[str, tuple[float, float]] | None = None,
    parameters: Mapping[str, tuple[float, float]] | None = None,
    set_point: Mapping[str, float] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    connect: Mapping[str, str] | None = None,
) -> LoopProblem:
    """Put a closed loop together.

    Parameters
    ----------
    text : ControllerText
        The controller.
    plant : Plant
        What it runs.
    start : mapping of str to (float, float), optional
        By state or by output that is a state; others begin where the plant does.
    parameters : mapping of str to (float, float), optional
        By name; others have their value.
    set_point : mapping of str to float, optional
        By port; 0 for others.
    sensors : mapping of str to Sensor, optional
        By port.
    connect : mapping of str to str, optional
        From names of the controller to ports of the plant, where they differ.

    Raises
    ------
    LoopProofError
        If a name is unknown, an interval is empty, or the plant has no equations to trace.
    PlantError
        If there is no such port.
    SourceError
        If the controller does not fit the plant.
    """
    site = site_of(plant, connect)
    if text.model.partners:
        name = text.model.partners[0].name
        raise LoopProofError(
            f"the partner '{name}' is a law of the study, about which nothing is proved"
        )
    site.wiring(text.model)  # says which port is missing
    _demand_whole_delays(sensors or {}, text.model.period)
    numbers = {name: parameter(plant, name).value for name in plant.parameters}
    values = {name: Interval(x, x) for name, x in numbers.items()}
    values |= _chosen("parameter", parameters, plant.parameters)
    begun, unknown = _begun(plant, values)
    starts = {name: Interval(x, x) for name, x in zip(plant.states, begun, strict=True)}
    starts |= _chosen("state", start, plant.states)
    alone = tuple(name for name in plant.states if name not in (start or {}))
    interface = site.interface
    set_points = dict.fromkeys(interface.references, 0.0)
    for name, value in (set_point or {}).items():
        port = interface.port(name)
        if port not in set_points or interface.references[port].order:
            raise ClaimError(f"'{name}' has no constant set point")
        set_points[port] = float(value)
    effective = {
        port: sensor
        for name, sensor in (sensors or {}).items()
        for port in interface.every_port(name)
    }
    for port, port_sensor in effective.items():
        if port_sensor.noise:
            label = interface.label(port)
            raise LoopProofError(
                f"the noise of '{label}' has no bound", hint="a resolution or a delay has one"
            )
    return LoopProblem(
        text, plant, site, starts, values, set_points, effective, alone, unknown if alone else ""
    )


class _Watched(Mapping[str, Any]):
    """Parameters of a plant that note which are read; no dict, whose copies note nothing."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = dict(values)
        self.read: set[str] = set()

    def __getitem__(self, name: str) -> Any:
        self.read.add(name)
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def copy(self) -> dict[str, Any]:
        return dict(self)

    def __or__(self, other: Mapping[str, Any]) -> dict[str, Any]:
        return dict(self) | dict(other)

    def __ror__(self, other: Mapping[str, Any]) -> dict[str, Any]:
        return dict(other) | dict(self)


def _begun(plant: Plant, values: Mapping[str, Interval]) -> tuple[list[float], str]:
    """Return where a plant begins by itself, and why that is not one place; empty: it is."""
    points = {name: span.low for name, span in values.items()}
    at = with_parameters(plant, points) if points else copy(plant)
    at.parameters = watched = _Watched(at.parameters)
    generator = np.random.default_rng(0)
    before = _drawn_from(generator)
    begun = start_of(at, generator)
    if _drawn_from(generator) != before or start_of(at, np.random.default_rng(0)) != begun:
        return begun, f"{plant.name} draws where it starts, and a claim is about all starts"
    free = [n for n, span in values.items() if span.low < span.high and n in watched.read]
    if free:
        return begun, f"{plant.name} makes its start of '{free[0]}', of which only bounds are known"
    return begun, ""


def _drawn_from(generator: np.random.Generator) -> tuple[str, int]:
    """Return what a generator of numbers changes when it is used."""
    bits: Any = generator.bit_generator
    return repr(bits.state), bits.seed_seq.n_children_spawned


def _chosen(
    what: str, ranges: Mapping[str, tuple[float, float]] | None, names: Mapping[str, object]
) -> dict[str, Interval]:
    intervals = {}
    for name, (low, high) in (ranges or {}).items():
        if name not in names:
            hint = near_hint(name, list(names))[0] or f"there are {', '.join(names)}"
            raise ClaimError(f"the plant has no {what} '{name}'", hint=hint)
        if not (math.isfinite(low) and math.isfinite(high) and low <= high):
            raise ClaimError(f"{name} in {low:g} .. {high:g} is not an interval")
        intervals[name] = Interval(float(low), float(high))
    return intervals


# ── one control period ───────────────────────────────────────────────────────────────

T = TypeVar("T")


class Algebra(Protocol[T]):
    """A kind of number that a control period is computed with."""

    def number(self, value: float) -> T:
        """Return a number of the file: the double that it is."""

    def add(self, a: T, b: T) -> T:
        """Return a sum."""

    def subtract(self, a: T, b: T) -> T:
        """Return a difference."""

    def multiply(self, a: T, b: T) -> T:
        """Return a product."""

    def divide(self, a: T, b: T) -> T:
        """Return a quotient."""

    def limit(self, x: T, low: float, high: float) -> T:
        """Return ``min(max(x, low), high)``."""

    def near(self, x: T, before: T, most: float) -> T:
        """Return ``min(max(x, before - most), before + most)``."""

    def expression(self, root: Node, values: Mapping[str, T]) -> T:
        """Return what an expression is for some values of its symbols."""

    def rules(self, sheet: RuleBase, inputs: Mapping[str, T]) -> list[T]:
        """Return what a rule base concludes, output by output."""

    def table(self, sheet: LookupTable, inputs: Mapping[str, T]) -> T:
        """Return what a lookup table says."""

    def error(self, x: T, size: float) -> T:
        """Return ``x`` and an unknown error of at most a size."""


Memory = dict[str, T]
"""What one period leaves for the next, by name: sources, slews, excesses of limits, sensors."""


class ControlPeriod(Generic[T]):
    """One period of the loop up to the inputs of the plant, over some kind of number.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    algebra : Algebra
        The kind of number.

    Attributes
    ----------
    memory : dict of str to float
        What the loop remembers, and its value before the first period; NaN where the first
        period takes what it sees.
    """

    def __init__(self, problem: LoopProblem, algebra: Algebra[T]) -> None:
        self.problem, self.algebra = problem, algebra
        self.model = problem.text.model
        self.memory: dict[str, float] = {}
        self._collect()

    def run(
        self, outputs: Mapping[Address, T], memory: Mapping[str, T], *, first: bool = False
    ) -> tuple[dict[Address, T], dict[str, T]]:
        """Do one period.

        Parameters
        ----------
        outputs : mapping
            The outputs of the plant as they are, by axis and port.
        memory : mapping
            What the last period left; in the first period values for NaN are not read.
        first : bool
            Whether it is the first period, in which some sources have seen nothing yet.

        Returns
        -------
        inputs : dict
            Of the plant, by axis and port, limits and slews included.
        memory : dict
            For the next period.
        """
        self._before, self._after = memory, dict[str, T]()
        self._first = first
        self._measurements = self._sensed(outputs)
        self._signals: dict[tuple[str, str], T] = {}
        self._drives: dict[Address, T] = {}
        index = 0
        for axes in self.model.axes:
            for name in axes.names:
                self._axis, self._index = name, index
                self._names = [line for line in axes.lines if isinstance(line, Drive)]
                for line in axes.lines:
                    self._line(axes, line)
                index += 1
        inputs = {
            address: self._actuated(address, port)
            for address, port in self.problem.site.interface.inputs.items()
        }
        return inputs, self._after

    # --- what is remembered ---

    def _collect(self) -> None:
        """List what is remembered; refuse what is not covered, by name."""
        problem = self.problem
        for (axis, port), sensor in problem.sensors.items():
            if sensor.difference is not None:
                self.memory[f"{axis}.{port} sensed before"] = math.nan
                self.memory[f"{axis}.{port} sensed slope"] = 0.0
            for late in range(periods_of(sensor.delay, problem.period)):
                self.memory[f"{axis}.{port} late {late + 1}"] = math.nan
        index = 0
        for axes in self.model.axes:
            for axis in axes.names:
                for line in axes.lines:
                    self._collect_line(axes, axis, index, line)
                index += 1
        for (axis, name), actuator in problem.site.interface.inputs.items():
            if actuator.slew < math.inf:
                self.memory[f"{axis}.{name} driven"] = actuator.idle

    def _collect_line(self, axes: Axes, axis: str, index: int, line: object) -> None:
        if isinstance(line, Zoom):
            words = f"'zoom {', '.join(line.signals)}' switches"
            raise LoopProofError(f"{words}: nothing is proved about it")
        if isinstance(line, Learn):
            raise LoopProofError(f"the table '{line.table}' learns: nothing is proved about it")
        if isinstance(line, Drive) and line.slew is not None:
            self.memory[_drive_name(axis, line, "slew")] = 0.0
        if isinstance(line, SignalLine) and line.source is not None:
            self._collect_source(axes, axis, index, line, line.source)

    def _collect_source(
        self, axes: Axes, axis: str, index: int, line: SignalLine, source: Source
    ) -> None:
        kind, options = source.record, dict(source.options)
        if kind.of == "call":
            sheet = self._sheet(source.name, index)
            if isinstance(sheet, RuleBase) and any(o.no_rule == "hold" for o in sheet.outputs):
                raise LoopProofError(f"'{source.name}' holds its output where no rule fires")
        if "cleared" in options and self.model.every > 1:
            message = f"the sum '{line.names[0]}' begins again at each set point"
            raise LoopProofError(f"{message}: nothing is proved about it")
        for state, begin in zip(kind.states, kind.starts(options), strict=True):
            self.memory[f"{axis}.{line.names[0]} {state.name}"] = begin
        drive = self._wound(axes, line, source)
        if drive is not None:
            self.memory[_drive_name(axis, drive, "excess")] = 0.0

    def _wound(self, axes: Axes, line: SignalLine, source: Source) -> Drive | None:
        """Return the drive whose limits an anti-windup looks at; None without."""
        kind = source.record
        if not kind.windup or not kind.settings(dict(source.options))[_word(kind.windup)]:
            return None
        return axes.driven_by(line.names[0])

    # --- sensors and actuators ---

    def _sensed(self, outputs: Mapping[Address, T]) -> dict[Address, T]:
        measurements: dict[Address, T] = {}
        for address, value in outputs.items():
            sensor = self.problem.sensors.get(address)
            measurements[address] = (
                value if sensor is None else self._sensor(address, sensor, value, measurements)
            )
        return measurements

    def _sensor(
        self, address: Address, sensor: Sensor, value: T, measurements: Mapping[Address, T]
    ) -> T:
        """Return what a sensor makes of an output: rate, steps, delay, in this order."""
        algebra, period = self.algebra, self.problem.period
        label = ".".join(address)
        if sensor.difference is not None:
            of = self.problem.site.interface.outputs[address].rate_of
            if not of:
                raise LoopProofError(f"'{label}' is not the rate of another output")
            if (address[0], of) not in measurements:  # it would be that of the last period
                raise LoopProofError(f"'{label}' stands before the output whose rate it is")
            source = measurements[address[0], of]
            before, slope = (
                self._state(f"{label} sensed before"),
                self._state(f"{label} sensed slope"),
            )
            self._after[f"{label} sensed before"] = source
            value = algebra.number(0.0)
            if not self._first:
                # A filter of first order, implicit: s + (steep - s) h / (T + h), T its time.
                steep = algebra.divide(algebra.subtract(source, before), algebra.number(period))
                way = algebra.multiply(algebra.subtract(steep, slope), algebra.number(period))
                way = algebra.divide(way, algebra.number(sensor.difference + period))
                value = algebra.add(slope, way)
            self._after[f"{label} sensed slope"] = value
        if sensor.resolution:
            port = self.problem.site.interface.outputs[address]
            value = algebra.limit(
                algebra.error(value, 0.5 * sensor.resolution), port.low, port.high
            )
        # A delay of n periods is n values in a row, each handed on once in a period.
        late = value
        for k in range(periods_of(sensor.delay, period)):
            name = f"{label} late {k + 1}"
            passed = value if self._first else self._before[name]
            self._after[name], late = late, passed
        return late

    def _actuated(self, address: Address, port: Port) -> T:
        algebra = self.algebra
        value = self._drives.get(address, algebra.number(port.idle))
        value = algebra.limit(value, port.low, port.high)
        if port.slew < math.inf:
            name = f"{address[0]}.{address[1]} driven"
            value = algebra.near(value, self._state(name), port.slew * self.problem.period)
            self._after[name] = value
        return value

    def _state(self, name: str) -> T:
        """Return what was remembered, or its first value."""
        if name in self._before:
            return self._before[name]
        begin = self.memory[name]
        return self.algebra.number(0.0 if math.isnan(begin) else begin)

    # --- lines of the controller ---

    def _line(self, axes: Axes, line: object) -> None:
        if isinstance(line, Drive):
            self._drive(line)
        elif isinstance(line, SignalLine):
            for name, value in zip(line.names, self._values(axes, line), strict=False):
                self._signals[self._axis, name] = value

    def _values(self, axes: Axes, line: SignalLine) -> list[T]:
        source = line.source
        if source is None:
            return [self._sum(line.products)]
        if source.record.of == "call":
            values = self._called(source)
        else:
            values = [self._updated(axes, line, source)]
        (product,) = line.products or (Product(()),)
        return [self._scaled(value, product.factors) for value in values]

    def _drive(self, line: Drive) -> None:
        algebra = self.algebra
        demand = self._sum(line.products)
        value = demand
        if line.within is not None:
            value = algebra.limit(demand, *line.within)
            excess = _drive_name(self._axis, line, "excess")
            if excess in self.memory:
                self._after[excess] = algebra.subtract(value, demand)
        if line.slew is not None:
            name = _drive_name(self._axis, line, "slew")
            value = algebra.near(value, self._state(name), line.slew * self.problem.period)
            self._after[name] = value
        port = self.problem.site.find(self.model, "drive", (self._axis, line.port))
        earlier = self._drives.get(port)
        self._drives[port] = value if earlier is None else algebra.add(earlier, value)

    def _sum(self, products: Sequence[Product]) -> T:
        total: T | None = None
        for product in products:
            first, *others = product.factors
            value = self._scaled(self._operand(first.value), others)
            if total is None and not product.negative:
                total = value
            else:
                apply = self.algebra.subtract if product.negative else self.algebra.add
                total = apply(self.algebra.number(0.0) if total is None else total, value)
        return self.algebra.number(0.0) if total is None else total

    def _scaled(self, value: T, factors: Iterable[Factor]) -> T:
        """Return a value times (or over) factors, from left to right as the program does it."""
        for factor in factors:
            by = self._operand(factor.value)
            apply = self.algebra.divide if factor.divides else self.algebra.multiply
            value = apply(value, by)
        return value

    def _operand(self, value: str | float) -> T:
        if not isinstance(value, str):
            return self.algebra.number(float(value))
        signal = self._signals.get((self._axis, value))
        if signal is not None:
            return signal
        gain = next(model for model in self.model.gains if model.name == value)
        amount = gain.values[self._index if len(gain.values) > 1 else 0]
        return self.algebra.number(amount.value(math.pi))

    # --- sources ---

    def _taken_of(self, source: Source) -> T:
        kind, key = source.record, (self._axis, source.name)
        if not kind.ports:
            return self._signals[key]
        site, set_point = self.problem.site, self.problem.set_point
        reference = measured = self.algebra.number(0.0)
        if "reference" in kind.ports:
            reference = self.algebra.number(set_point[site.find(self.model, "reference", key)])
        if "measured" in kind.ports:
            measured = self._measurements[site.find(self.model, "measured", key)]
        if len(kind.ports) == 1:
            return reference if "reference" in kind.ports else measured
        weight = source.option("weight")
        if isinstance(weight, str | float):
            reference = self.algebra.multiply(reference, self._operand(weight))
        return self.algebra.subtract(reference, measured)

    def _updated(self, axes: Axes, line: SignalLine, source: Source) -> T:
        kind = source.record
        x = self._taken_of(source)
        if kind.function is None:
            return x
        algebra, name = self.algebra, f"{self._axis}.{line.names[0]}"
        drive = self._wound(axes, line, source)
        settings = dict(kind.settings(dict(source.options)))
        if kind.windup and drive is None:
            settings[_word(kind.windup)] = 0.0
        values: dict[str, T] = {word: self._operand(value) for word, value in settings.items()}
        values |= {"x": x, "period": algebra.number(self.problem.period)}
        values |= {"last": algebra.number(float(self.model.every == 1))}
        values |= {"excess": algebra.number(0.0), "gain": algebra.number(0.0)}
        if drive is not None:
            values["excess"] = self._state(_drive_name(self._axis, drive, "excess"))
            values["gain"] = self._gain_of_drive(axes, line, drive)
        for state in kind.states:
            values[state.name] = self._state(f"{name} {state.name}")
        output = algebra.expression(_seen(kind.expression, kind, self._first), values)
        for state, root in zip(kind.states, kind.nexts, strict=True):
            values["value"] = output
            after = algebra.expression(_seen(root, kind, self._first), values)
            self._after[f"{name} {state.name}"] = after
        return output

    def _gain_of_drive(self, axes: Axes, line: SignalLine, drive: Drive) -> T:
        constants = {gain.name for gain in self.model.gains}
        products = axes.gain_of(line.names[0], drive, constants)
        if not products:
            return self.algebra.number(1.0 if products is None else 0.0)
        one = self.algebra.number(1.0)
        total = self.algebra.number(0.0)
        for product in products:
            value = self._scaled(one, product.factors)
            apply = self.algebra.subtract if product.negative else self.algebra.add
            total = apply(total, value)
        return total

    # --- rule bases and tables ---

    def _sheet(self, name: str, index: int) -> RuleBase | LookupTable:
        sheets = self.problem.text.sheets.get(name)
        if not sheets:
            raise LoopProofError(f"'{name}' could not be read")
        return sheets[index if len(sheets) > 1 else 0]

    def _called(self, source: Source) -> list[T]:
        sheet = self._sheet(source.name, self._index)
        arguments = [self._signals[self._axis, name] for name in source.inputs]
        if isinstance(sheet, RuleBase):
            waiting = iter(arguments)
            inputs = {
                variable.name: self.algebra.number(self._index + 1.0)
                if variable.name == AXIS and AXIS not in source.inputs
                else next(waiting)
                for variable in sheet.inputs
            }
            return self.algebra.rules(sheet, inputs)
        try:
            axes, values = of_axis(sheet, self._index)
        except SourceError as error:
            raise LoopProofError(str(error)) from error
        lattice = replace(sheet, axes=tuple(axes), values=np.asarray(values))
        return [self.algebra.table(lattice, dict(zip(lattice.names, arguments, strict=True)))]


def _word(option: str) -> str:
    """Return the argument of an update that an option says."""
    return option.replace("-", "_")


def _drive_name(axis: str, line: Drive, what: str) -> str:
    """Return the name of what a drive remembers; several of one port stand on several lines."""
    return f"{axis}.{line.port} {what} {line.span.line}"


@cache
def _seen(root: Node, kind: SourceKind, first: bool) -> Node:
    """Return an update where it is known whether states that start as NaN have seen anything."""
    # An update asks by s == s, which is false for NaN.
    for state in kind.states:
        begun = isinstance(state.start, float) and math.isnan(state.start) and first
        root = substituted(root, unseen(symbol(state.name)), constant(float(begun)))
    return specialise(root, {})
