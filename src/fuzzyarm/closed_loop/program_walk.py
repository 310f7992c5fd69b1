"""One control period by the controller's program, over any kind of number: the checker's reading.

The search reads the lines of a controller (:class:`fuzzyarm.controller.period.ControlPeriod`).
The checker does not: it walks the instructions that ``simulate`` runs and ``compile`` prints
(:mod:`fuzzyarm.export.steps`), and does what is outside the controller, sensors and actuators,
itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from fuzzyarm.closed_loop.problem import LoopProblem, LoopProofError
from fuzzyarm.export.steps import LAST, Ask, Set, first_of, steps_of
from fuzzyarm.expression.nodes import Apply, Constant, Node, Symbol, postorder
from fuzzyarm.loop.course import Sensor, periods_of
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.plant.plant import Address
from fuzzyarm.table import LookupTable

__all__ = ["NumberSystem", "ProgramWalk"]


class NumberSystem(Protocol):
    """A kind of number: what operations are, and what rule bases and tables say."""

    def number(self, value: float) -> Any:
        """Return a number of the program: the double that it is."""

    def apply(self, operation: str, arguments: list[Any]) -> Any:
        """Return an operation; of a condition a bool."""

    def limit(self, x: Any, low: float, high: float) -> Any:
        """Return ``min(max(x, low), high)``."""

    def rules(self, sheet: RuleBase, output: str, inputs: Mapping[str, Any]) -> Any:
        """Return what a rule base concludes."""

    def table(self, sheet: LookupTable, inputs: Mapping[str, Any]) -> Any:
        """Return what a table says."""


class ProgramWalk:
    """The program of a loop's controller.

    Parameters
    ----------
    problem : LoopProblem
        The loop.

    Attributes
    ----------
    states : dict of str to float
        What the loop remembers, by symbol, and what it is before the first period.
    begun : set of str
        Those that begin as what is first seen, whatever stands in `states`.
    states_read : set of str
        Those that the last walk has read, as the period before had left them.
    """

    def __init__(self, problem: LoopProblem) -> None:
        self.problem = problem
        self.steps = steps_of(problem.text)
        self.states = {
            name: variable.start
            for name, variable in self.steps.variables.items()
            if variable.sort == "state"
        }
        self.begun: set[str] = set()
        for step in self.steps.steps:
            if isinstance(step, Set):
                self.begun |= _unseen(step.value)
            elif not isinstance(step, Ask):
                raise LoopProofError("a controller that learns: nothing is proved about it")
        for (axis, port), sensor in problem.sensors.items():
            self._collect(f"{axis}.{port}", sensor)
        for address, actuator in problem.site.interface.inputs.items():
            if actuator.slew < math.inf:
                self.states[f"driven:{'.'.join(address)}"] = actuator.idle
        self.states_read: set[str] = set()

    def _collect(self, label: str, sensor: Sensor) -> None:
        if sensor.resolution or sensor.noise:
            raise LoopProofError("a sensor with steps or noise does not come to rest")
        late = [
            f"late:{label}:{k + 1}" for k in range(periods_of(sensor.delay, self.problem.period))
        ]
        if sensor.difference is not None:
            self.states[f"slope:{label}"] = 0.0
            late.append(f"before:{label}")
        self.states.update(dict.fromkeys(late, 0.0))
        self.begun.update(late)

    # ── one period ───────────────────────────────────────────────────────────────────

    def period(
        self,
        numbers: NumberSystem,
        outputs: Mapping[Address, Any],
        states: Mapping[str, Any],
        *,
        first: bool = False,
    ) -> tuple[dict[Address, Any], dict[str, Any]]:
        """Do one period.

        Parameters
        ----------
        numbers : NumberSystem
            What it is done with.
        outputs : mapping
            Of the plant, by axis and port.
        states : mapping of str
            What the loop remembers; what is not there is as it begins.
        first : bool
            Whether it is the first period.

        Returns
        -------
        inputs : dict
            Of the plant, by axis and port.
        states : dict
            For the next period.
        """
        self.states_read = set()
        self._numbers, self._first = numbers, first
        self._before = {
            name: states.get(name, numbers.number(start)) for name, start in self.states.items()
        }
        self._after: dict[str, Any] = {}
        measurements = self._sensed(outputs)
        self._values: dict[str, Any] = {
            **dict.fromkeys(map(first_of, self.steps.needs_first), first),
            LAST: self.problem.text.model.every == 1,
        }
        drives: dict[Address, Any] = {}
        for name, variable in self.steps.variables.items():
            key = (variable.axis, variable.name)
            if variable.sort == "gain":
                self._values[name] = numbers.number(variable.start)
            elif variable.sort == "measured":
                self._values[name] = measurements[self._port("measured", key)]
            elif variable.sort == "reference":
                set_point = self.problem.set_point[self._port("reference", key)]
                self._values[name] = numbers.number(set_point)
        for step in self.steps.steps:
            if isinstance(step, Set):
                value = self._value(step.value)
                if step.target in self.states:
                    self._after[step.target] = value
                self._values[step.target] = value
            else:
                assert isinstance(step, Ask)
                self._values[step.target] = self._asked(step)
        for variable in self.steps.of_sort("drive"):
            port = self._port("drive", (variable.axis, variable.name))
            value = self._values[variable.symbol]
            earlier = drives.get(port)
            drives[port] = value if earlier is None else numbers.apply("add", [earlier, value])
        inputs = {address: self._actuated(address, drives) for address in self._inputs}
        return inputs, {**self._before, **self._after}

    @property
    def _inputs(self) -> list[Address]:
        return list(self.problem.site.interface.inputs)

    def _port(self, kind: str, address: Address) -> Address:
        return self.problem.site.find(self.problem.text.model, kind, address)

    def _state(self, name: str) -> Any:
        if name not in self._after:
            self.states_read.add(name)
            return self._before[name]
        return self._after[name]

    # ── the program ──────────────────────────────────────────────────────────────────

    def _value(self, root: Node) -> Any:
        """Return an expression; of a choice only the branch that is taken is looked at."""
        results: dict[Node, Any] = {}

        def value(node: Node) -> Any:
            if node not in results:
                results[node] = self._computed(node, value)
            return results[node]

        return value(root)

    def _computed(self, node: Node, value: Callable[[Node], Any]) -> Any:
        if isinstance(node, Constant):
            # No rational is infinite: such a number stays a float until something is compared with
            # it.
            return node.value if math.isinf(node.value) else self._numbers.number(node.value)
        if isinstance(node, Symbol):
            # A state that a line has set is read anew from then on; before that, as the last period
            # left it.
            is_value = node.name in self._values and node.name not in self.states
            return self._values[node.name] if is_value else self._state(node.name)
        assert isinstance(node, Apply)
        operation, arguments = node.operation, node.arguments
        if operation == "where":
            return value(arguments[1] if value(arguments[0]) else arguments[2])
        if operation in _CONDITIONS:
            return _CONDITIONS[operation](value, *arguments)
        return self._applied(node, value)

    def _applied(self, node: Apply, value: Callable[[Node], Any]) -> Any:
        operation, arguments = node.operation, node.arguments
        # The program asks so whether x is NaN. No number here is; the first period, in which a
        # state may be, has a flag of its own.
        if operation == "equal" and arguments[0] is arguments[1]:
            return True
        limits = _limits(node)
        if limits is not None:
            x, low, high = limits
            return self._numbers.limit(value(x), low, high)
        operands = [value(argument) for argument in arguments]
        if any(isinstance(x, float) for x in operands):
            return _against_infinity(operation, operands)
        return self._numbers.apply(operation, operands)

    def _asked(self, step: Ask) -> Any:
        arguments = [self._values[name] for name in step.inputs]
        sheet = self.steps.sheets[step.routine]
        if isinstance(sheet, LookupTable):
            return self._numbers.table(sheet, dict(zip(sheet.names, arguments, strict=True)))
        rulebase, output = sheet
        names = [variable.name for variable in rulebase.inputs]
        return self._numbers.rules(rulebase, output, dict(zip(names, arguments, strict=True)))

    # ── sensors and actuators ────────────────────────────────────────────────────────

    def _sensed(self, outputs: Mapping[Address, Any]) -> dict[Address, Any]:
        measurements: dict[Address, Any] = {}
        for address, output in outputs.items():
            sensor = self.problem.sensors.get(address)
            value = output
            if sensor is not None:
                if sensor.difference is not None:
                    value = self._rate(address, sensor.difference, measurements)
                value = self._late(".".join(address), sensor.delay, value)
            measurements[address] = value
        return measurements

    def _rate(self, address: Address, constant: float, measurements: Mapping[Address, Any]) -> Any:
        """Return the filtered difference that a sensor gives for a rate."""
        numbers, h = self._numbers, self.problem.period
        label = ".".join(address)
        of = (address[0], self.problem.site.interface.outputs[address].rate_of)
        if of not in measurements:
            raise LoopProofError(f"'{label}' has no output before it whose rate it is")
        before, slope = self._state(f"before:{label}"), self._state(f"slope:{label}")
        self._after[f"before:{label}"] = measurements[of]
        value = numbers.number(0.0)
        if not self._first:
            way = numbers.apply("subtract", [measurements[of], before])
            steep = numbers.apply("divide", [way, numbers.number(h)])
            gap = numbers.apply("subtract", [steep, slope])
            share = numbers.apply("divide", [numbers.number(h), numbers.number(constant + h)])
            value = numbers.apply("add", [slope, numbers.apply("multiply", [gap, share])])
        self._after[f"slope:{label}"] = value
        return value

    def _late(self, label: str, delay: float, value: Any) -> Any:
        passed = value
        for k in range(periods_of(delay, self.problem.period)):
            name = f"late:{label}:{k + 1}"
            older = value if self._first else self._state(name)
            self._after[name], passed = passed, older
        return passed

    def _actuated(self, address: Address, drives: Mapping[Address, Any]) -> Any:
        numbers = self._numbers
        port = self.problem.site.interface.inputs[address]
        value = drives.get(address)
        if value is None:
            value = numbers.number(port.idle)
        value = numbers.limit(value, port.low, port.high)
        if port.slew < math.inf:
            name = f"driven:{address[0]}.{address[1]}"
            before, most = self._state(name), numbers.number(port.slew * self.problem.period)
            least = numbers.apply("subtract", [before, most])
            value = numbers.apply("maximum", [value, least])
            value = numbers.apply("minimum", [value, numbers.apply("add", [before, most])])
            self._after[name] = value
        return value


_CONDITIONS: dict[str, Callable[..., bool]] = {
    "both": lambda value, a, b: value(a) and value(b),
    "either": lambda value, a, b: value(a) or value(b),
    "negation": lambda value, a: not value(a),
}
"""Conditions that are joined: the second one is looked at where the first does not tell."""


def _unseen(root: Node) -> set[str]:
    """Return the symbols of states of which an expression asks whether they have seen anything."""
    # Such a state begins as NaN, the one number that x == x is false of.
    names = set()
    for node in postorder(root):
        if isinstance(node, Apply) and node.operation == "equal":
            first, second = node.arguments
            if first is second and isinstance(first, Symbol):
                names.add(first.name)
    return names


def _limits(node: Apply) -> tuple[Node, float, float] | None:
    """Return what is limited, and by which numbers, of ``min(max(x, low), high)``."""
    if node.operation != "minimum":
        return None
    inner, high = node.arguments
    if not (isinstance(inner, Apply) and inner.operation == "maximum"):
        return None
    x, low = inner.arguments
    if isinstance(low, Constant) and isinstance(high, Constant):
        return x, low.value, high.value
    return None


def _against_infinity(operation: str, arguments: list[Any]) -> Any:
    """Return a comparison, or the smaller or larger, where one of two is infinite."""
    first, second = arguments
    if operation in ("less", "less_equal"):
        return first < 0 if isinstance(first, float) else second > 0
    endless, other = (first, second) if isinstance(first, float) else (second, first)
    if operation in ("minimum", "maximum"):
        return other if (endless > 0) == (operation == "minimum") else endless
    raise LoopProofError(f"'{operation}' of something infinite")
