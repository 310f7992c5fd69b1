"""One period of a closed loop up to the inputs of the plant: sensors, controller, actuators.

The controller is :class:`fuzzyarm.control.controllers.period.ControlPeriod`; its algebras are
affine forms for certificates, zonotopes for tubes, floats near a rest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Generic, TypeVar

from fuzzyarm.base.numbers import whole_periods
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.period import Algebra, ControlPeriod, PortValue
from fuzzyarm.control.controllers.text import ports_of
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.controller import Learn, Line, SignalLine, Zoom
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.actuators import dead_time
from fuzzyarm.plant.plant import Address, Port
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError, require_one_rate

T = TypeVar("T")


class LoopAlgebra(Algebra[T]):
    """The algebra of a closed loop."""

    def error(self, x: T, size: float) -> T:
        """Return ``x`` plus an unknown error of at most `size`."""
        raise NotImplementedError


class LoopPeriod(Generic[T]):
    """One period of the loop up to the inputs of the plant, over an algebra.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    algebra : LoopAlgebra
        The algebra.

    Attributes
    ----------
    memory : dict of str to float
        Memory of sensors, controller and actuators, with its value before the first period; NaN
        if it starts as the first reading.
    """

    def __init__(self, problem: LoopProblem, algebra: LoopAlgebra[T]) -> None:
        self.problem, self.algebra = problem, algebra
        self.control = ControlPeriod(problem.text, algebra)
        require_one_rate(problem.text.model)
        for index, line in _lines(problem):
            self._demand_provable(index, line)
        self.memory: dict[str, float] = {}
        for (axis, port), sensor in problem.sensors.items():
            if sensor.difference is not None:
                self.memory[f"{axis}.{port} sensed before"] = math.nan
                self.memory[f"{axis}.{port} sensed slope"] = 0.0
            cells = self._cells(f"{axis}.{port} late", whole_periods(sensor.delay, problem.period))
            self.memory |= dict.fromkeys(cells, math.nan)
        self.memory |= {name: cell.start for name, cell in self.control.cells.items()}
        for (axis, name), actuator in problem.site.interface.inputs.items():
            if actuator.slew < math.inf:
                self.memory[f"{axis}.{name} driven"] = actuator.idle
            cells = self._cells(f"{axis}.{name} pending", _periods(actuator, problem.period))
            self.memory |= dict.fromkeys(cells, actuator.idle)

    def _demand_provable(self, index: int, line: Line) -> None:
        """Refuse features that no proof covers, by name."""
        if isinstance(line, Zoom):
            words = f"'zoom {', '.join(line.signals)}' switches"
            raise LoopProofError(f"{words}: nothing is proved about it")
        if isinstance(line, Learn):
            raise LoopProofError(f"the table '{line.table}' learns: nothing is proved about it")
        if not isinstance(line, SignalLine) or line.source is None:
            return
        source = line.source
        if source.record.of == "call":
            sheet = self.control.sheet(source.name, index)
            if sheet is None:
                raise LoopProofError(f"'{source.name}' could not be read")
            if isinstance(sheet, RuleBase) and any(o.no_rule == "hold" for o in sheet.outputs):
                raise LoopProofError(f"'{source.name}' holds its output where no rule fires")
        if "cleared" in dict(source.options) and self.problem.text.model.every > 1:
            message = f"the sum '{line.names[0]}' begins again at each set point"
            raise LoopProofError(f"{message}: nothing is proved about it")

    def run(
        self,
        outputs: Mapping[Address, T],
        memory: Mapping[str, T],
        *,
        first: bool = False,
        moved: Mapping[Address, T] | None = None,
    ) -> tuple[dict[Address, T], dict[str, T]]:
        """Evaluate one period: return the plant's limited and slewed inputs, and the memory.

        In the first period some sources have no input yet, and memory that begins as NaN is not
        read. `moved` has the moving references.
        """
        self._before, self._after, self._first = memory, dict[str, T](), first
        given = self._given(self._sensed(outputs), moved or {})
        try:
            drives, after = self.control.run(given, memory, first=first)
        except SourceError as error:
            raise LoopProofError(str(error)) from error
        self._after |= after
        sums: dict[Address, T] = {}
        for address, value in drives.items():
            port = self._port("drive", address)
            sums[port] = self.algebra.add(sums[port], value) if port in sums else value
        inputs = {
            address: self._actuated(address, port, sums)
            for address, port in self.problem.site.interface.inputs.items()
        }
        stays = {name: self._state(name) for name in self.memory if name not in self._after}
        return inputs, self._after | stays  # a drive without a limit has no excess

    def _port(self, kind: str, address: Address) -> Address:
        return self.problem.site.find(self.problem.text.model, kind, address)

    def _given(
        self, measured: Mapping[Address, T], moved: Mapping[Address, T]
    ) -> dict[PortValue, T]:
        """Return the values read by the controller, by its own names."""
        model, set_point = self.problem.text.model, self.problem.set_point
        given = {
            PortValue("measured", *address): measured[self._port("measured", address)]
            for address in ports_of(model, "measured")
        }
        for address in ports_of(model, "reference"):
            port = self._port("reference", address)
            given[PortValue("reference", *address)] = (
                moved[port] if port in moved else self.algebra.number(set_point[port])
            )
        return given

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
        """Return a sensor's processing of an output: rate, resolution, delay, in this order."""
        algebra, period = self.algebra, self.problem.period
        label = ".".join(address)
        if sensor.difference is not None:
            of = self.problem.site.interface.outputs[address].rate_of
            if not of:
                raise LoopProofError(f"'{label}' is not the rate of another output")
            if (address[0], of) not in measurements:  # it would be a value of the last period
                raise LoopProofError(f"'{label}' stands before the output whose rate it is")
            source = measurements[address[0], of]
            before, slope = (
                self._state(f"{label} sensed before"),
                self._state(f"{label} sensed slope"),
            )
            self._after[f"{label} sensed before"] = source
            value = algebra.number(0.0)
            if not self._first:
                # First-order filter, implicit Euler: s + (steep - s) h / (T + h), time constant T.
                steep = algebra.divide(algebra.subtract(source, before), algebra.number(period))
                step = algebra.multiply(algebra.subtract(steep, slope), algebra.number(period))
                step = algebra.divide(step, algebra.number(sensor.difference + period))
                value = algebra.add(slope, step)
            self._after[f"{label} sensed slope"] = value
        if sensor.resolution:
            port = self.problem.site.interface.outputs[address]
            value = algebra.limit(
                algebra.error(value, 0.5 * sensor.resolution), port.low, port.high
            )
        return self._delayed(f"{label} late", whole_periods(sensor.delay, period), value)

    def _cells(self, name: str, count: int) -> list[str]:
        """Return the names of a delay's memory cells, youngest first."""
        return [f"{name} {k + 1}" for k in range(count)]

    def _delayed(self, name: str, count: int, value: T) -> T:
        """Return a value delayed by `count` periods: a shift register."""
        now = value
        for cell in self._cells(name, count):
            begins = self._first and math.isnan(self.memory[cell])
            passed = now if begins else self._state(cell)
            self._after[cell], value = value, passed
        return value

    def _actuated(self, address: Address, port: Port, drives: Mapping[Address, T]) -> T:
        algebra = self.algebra
        value = drives.get(address, algebra.number(0.0))
        value = algebra.limit(value, port.low, port.high)
        if port.slew < math.inf:
            name = f"{address[0]}.{address[1]} driven"
            value = algebra.rate_limited(value, self._state(name), port.slew * self.problem.period)
            self._after[name] = value
        count = _periods(port, self.problem.period)
        return self._delayed(f"{address[0]}.{address[1]} pending", count, value)

    def _state(self, name: str) -> T:
        """Return the previous value, or the first one."""
        if name in self._before:
            return self._before[name]
        begin = self.memory[name]
        return self.algebra.number(0.0 if math.isnan(begin) else begin)


def _periods(actuator: Port, period: float) -> int:
    """Return the periods of a dead time, rounded up."""
    count, rest = dead_time(actuator.dead_time, period)
    return count + (rest > 0.0)


def _lines(problem: LoopProblem) -> Iterator[tuple[int, Line]]:
    """Yield the lines of all axes, with the index of the axis."""
    model = problem.text.model
    every = [axes for axes in model.axes for _ in axes.names]
    return ((index, line) for index, axes in enumerate(every) for line in axes.lines)
