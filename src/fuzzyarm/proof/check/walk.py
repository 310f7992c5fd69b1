"""The checker's own control period: the instructions of a controller, over any kind of number.

The search reads the lines of a controller. The checker executes the instructions of ``simulate``
(:mod:`fuzzyarm.control.controllers.kernel`), with its own sensors and actuators.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any, Protocol

from fuzzyarm.base.numbers import whole_periods
from fuzzyarm.control.controllers import kernel as code
from fuzzyarm.control.controllers.code import ControllerCode, SourceError, Wiring
from fuzzyarm.control.controllers.program import write_down
from fuzzyarm.control.controllers.text import wiring_of
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.plant import Address, Port
from fuzzyarm.plant.setting import LAST, PERIOD, RunArithmetic
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError, require_one_rate
from fuzzyarm.symbolic.identifiers import Names, identifier
from fuzzyarm.symbolic.nodes import Apply, Constant, Node, Symbol, apply
from fuzzyarm.symbolic.sources import VALUE
from fuzzyarm.table import LookupTable
from fuzzyarm.table.lookup import INPUTS, VALUES


class NumberSystem(Protocol):
    """A number system: the meaning of operations, rule bases and tables."""

    def number(self, value: float) -> Any:
        """Return a number of the program, exactly."""

    def apply(self, operation: str, arguments: list[Any]) -> Any:
        """Apply an operation; a condition gives a bool, or a chooser between two numbers."""

    def limit(self, x: Any, low: float, high: float) -> Any:
        """Return ``min(max(x, low), high)``."""

    def excess(self, value: Any, x: Any, low: float, high: float) -> Any:
        """Return the change of x by a limit, which made it `value`."""

    def rules(self, rulebase: RuleBase, output: str, inputs: Mapping[str, Any]) -> Any:
        """Return a conclusion of a rule base."""

    def table(self, table: LookupTable, inputs: Mapping[str, Any]) -> Any:
        """Return the value of a table."""


class ProgramWalk:
    """The program of a loop's controller.

    Parameters
    ----------
    problem : LoopProblem
        The loop.

    Attributes
    ----------
    states : dict of str to float
        Memory of the loop, by symbol, with its start.
    begun : set of str
        Memory that begins as its first input, whatever `states` contains.
    states_read : set of str
        Memory read in the last walk, with its value from the period before.
    at : str
        The signal or drive in evaluation, during a walk.
    """

    def __init__(self, problem: LoopProblem) -> None:
        self.problem = problem
        model = problem.text.model
        self._wiring = wiring_of(model)
        try:
            # Nothing is inferred while the instructions are read: any address will do.
            self._program = write_down(
                model, problem.text.sheets, {}, self._wiring, RunArithmetic()
            )
        except SourceError as error:
            raise LoopProofError(str(error)) from error
        require_one_rate(model)
        self._names = _signals_of(self._program, self._wiring)
        self._cell_names = _names_of_states(self._program, self._names)
        self.states = {
            name: float(self._program.cells[cell]) for cell, name in self._cell_names.items()
        }
        self.begun = {name for name, start in self.states.items() if math.isnan(start)}
        self.states |= dict.fromkeys(self.begun, 0.0)
        for (axis, port), sensor in problem.sensors.items():
            self._collect(f"{axis}.{port}", sensor)
        for address, actuator in problem.site.interface.inputs.items():
            if actuator.slew < math.inf:
                self.states[f"driven:{'.'.join(address)}"] = actuator.idle
            self.states |= dict.fromkeys(self._queue("pending", address, actuator), actuator.idle)
        self.states_read: set[str] = set()
        self.at = ""

    def _collect(self, label: str, sensor: Sensor) -> None:
        if sensor.resolution or sensor.noise:
            raise LoopProofError("a sensor with steps or noise does not come to rest")
        late = [
            f"late:{label}:{k + 1}" for k in range(whole_periods(sensor.delay, self.problem.period))
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
        moved: Mapping[Address, Any] | None = None,
    ) -> tuple[dict[Address, Any], dict[str, Any]]:
        """Evaluate one period: return the plant's inputs, and the memory for the next period.

        Memory missing from `states` has its initial value. `moved` has the moving references.
        """
        self.states_read = set()
        self._numbers, self._first = numbers, first
        self._before = {
            name: states.get(name, numbers.number(start)) for name, start in self.states.items()
        }
        self._after: dict[str, Any] = {}
        measurements = self._sensed(outputs)
        self._cells = self._given(measurements, moved or {})
        for instruction, name in zip(_instructions(self._program), self._names, strict=True):
            self.at = name[1]
            self._execute(*instruction)
        self.at = ""
        drives: dict[Address, Any] = {}
        for address, cell in self._wiring.drives.items():
            port, value = self._port("drive", address), self._load(cell)
            earlier = drives.get(port)
            drives[port] = value if earlier is None else numbers.apply("add", [earlier, value])
            self._keep(self._program.last[cell], value)
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

    def _given(
        self, measurements: Mapping[Address, Any], moved: Mapping[Address, Any]
    ) -> dict[int, Any]:
        """Return the cells filled in by the loop."""
        set_point, period = self.problem.set_point, self.problem.text.model
        cells = {
            PERIOD: self._numbers.number(period.period),
            LAST: self._numbers.number(float(period.every == 1)),
        }
        for address, cell in self._wiring.measured.items():
            cells[cell] = measurements[self._port("measured", address)]
        for address, cell in self._wiring.references.items():
            port = self._port("reference", address)
            number = self._numbers.number
            cells[cell] = moved[port] if port in moved else number(set_point[port])
        return cells

    def _load(self, cell: int) -> Any:
        """Return a cell: filled in, remembered, or a constant of the program."""
        if cell in self._cells:
            return self._cells[cell]
        if cell in self._cell_names:
            return self._state(self._cell_names[cell])
        value = float(self._program.cells[cell])
        # No rational is infinite: such a number stays a float until a comparison.
        return value if math.isinf(value) else self._numbers.number(value)

    def _keep(self, cell: int, value: Any) -> None:
        """Store a cell for the next period, if anything reads it."""
        if cell in self._cell_names:
            self._after[self._cell_names[cell]] = value

    def _execute(self, operator: int, into: int, a: int, b: int, c: int) -> None:
        """Execute one instruction; a, b and c are cells, or begins of lists."""
        if operator in _ARITHMETIC:
            value = self._load(a)
            for operation, cell in zip(_ARITHMETIC[operator], (b, c), strict=False):
                value = self._numbers.apply(operation, [value, self._load(cell)])
        elif operator == code.LIMIT:
            value = self._limited(self._load(a), b)
        elif operator == code.SLEW:
            value = self._slewed(self._load(a), b)
        elif operator == code.UPDATE:
            value = self._updated(a, b, c)
        elif operator == code.LOOK_UP:
            value = self._looked_up(a, b)
        elif operator == code.INFER:
            self._infer(a)
            return
        else:
            raise LoopProofError("a controller that learns or switches: nothing is proved about it")
        self._cells[into] = value

    def _limited(self, x: Any, state: int) -> Any:
        low, high = (float(self._program.cells[state + k]) for k in (code.LOW, code.HIGH))
        value = self._numbers.limit(x, low, high)
        if state + code.OVER in self._cell_names:
            self._keep(state + code.OVER, self._numbers.excess(value, x, low, high))
        return value

    def _slewed(self, x: Any, state: int) -> Any:
        steepest = float(self._program.cells[state + code.STEEPEST])
        value = x
        if steepest < math.inf:  # else the cell keeps a value for other axes
            value = self._rate_limited(x, self._load(state + code.LAST_DRIVE), steepest)
        self._keep(state + code.LAST_DRIVE, value)
        return value

    def _rate_limited(self, value: Any, before: Any, steepest: float) -> Any:
        """Return a value with its change per period limited."""
        numbers = self._numbers
        most = numbers.number(steepest * self.problem.period)
        least = numbers.apply("subtract", [before, most])
        value = numbers.apply("maximum", [value, least])
        return numbers.apply("minimum", [value, numbers.apply("add", [before, most])])

    def _updated(self, begin: int, frame: int, x: int) -> Any:
        """Return the value of a source; store its memory for the next period."""
        kind = self._program.updates[frame]
        inputs = frame + 1 + len(kind.states)
        pairs = self._program.code[begin + code.FETCHES :][
            : 2 * self._program.code[begin + code.FETCHED]
        ]
        fetched = {inputs: x, inputs + 1: PERIOD, **dict(zip(pairs[::2], pairs[1::2], strict=True))}
        cells = {name: fetched.get(k, k) for k, name in enumerate(kind.symbols, frame + 1)}
        names = {
            name
            for name, cell in cells.items()
            if self._first and self._cell_names.get(cell) in self.begun
        }
        results: dict[str, Any] = {}

        def argument(name: str) -> Any:
            return results[name] if name in results else self._load(cells[name])

        def value(root: Node) -> Any:
            return self._value(root, argument, names)

        results[VALUE] = value(kind.expression)
        # All read the old memory: none is stored until each is known.
        after = [value(root) for root in kind.nexts]
        for cell, state in enumerate(after, frame + 1):
            self._keep(cell, state)
        return results[VALUE]

    def _infer(self, begin: int) -> None:
        """Evaluate a rule base, output by output."""
        program = self._program.code
        count, results = program[begin + code.COUNT_INPUTS], program[begin + code.COUNT_RESULTS]
        cells = program[begin + code.INFER_CELLS :][: count + results]
        _, rulebase = self._program.rulebases[cells[count]]
        inputs = {
            variable.name: self._load(cell)
            for variable, cell in zip(rulebase.inputs, cells[:count], strict=True)
        }
        for output, cell in zip(rulebase.outputs, cells[count:], strict=True):
            self._cells[cell] = self._numbers.rules(rulebase, output.name, inputs)

    def _looked_up(self, begin: int, grid: int) -> Any:
        program = self._program
        _, table = program.tables[program.code[begin + VALUES]]
        cells = program.code[begin + INPUTS :][: int(program.cells[grid])]
        inputs = dict(zip(table.names, map(self._load, cells), strict=True))
        return self._numbers.table(table, inputs)

    # ── expressions ──────────────────────────────────────────────────────────────────

    def _value(self, root: Node, argument: Callable[[str], Any], unseen: Collection[str]) -> Any:
        """Evaluate an expression; of a choice only the branch taken."""
        results: dict[Node, Any] = {}

        def value(node: Node) -> Any:
            if node not in results:
                results[node] = computed(node)
            return results[node]

        def computed(node: Node) -> Any:
            if isinstance(node, Constant):
                return node.value if math.isinf(node.value) else self._numbers.number(node.value)
            if isinstance(node, Symbol):
                return argument(node.name)
            assert isinstance(node, Apply)
            operation, arguments = node.operation, node.arguments
            if operation == "where":
                return self._chosen(value, *arguments)
            # The program's test for NaN: only memory before its first value is NaN.
            if operation == "equal" and arguments[0] is arguments[1]:
                return getattr(arguments[0], "name", "") not in unseen
            if operation in _CONDITIONS:
                return _CONDITIONS[operation](value, *arguments)
            return self._applied(node, value)

        return value(root)

    def _chosen(self, value: Callable[[Node], Any], test: Any, a: Node, b: Node) -> Any:
        """Return a where a condition holds, else b; (p < q ? p : q) is the smaller of both."""
        compares = isinstance(test, Apply) and test.operation in (
            "less",
            "less_equal",
        )
        if compares and test.arguments in ((a, b), (b, a)):
            extreme = "minimum" if test.arguments == (a, b) else "maximum"
            return self._applied(apply(extreme, *test.arguments), value)
        condition = value(test)
        if isinstance(condition, bool):
            return value(a if condition else b)
        return condition.chosen(self._numbers, value(a), value(b))

    def _applied(self, node: Apply, value: Callable[[Node], Any]) -> Any:
        limits = _limits(node)
        if limits is not None:
            x, low, high = limits
            return self._numbers.limit(value(x), low, high)
        operands = [value(argument) for argument in node.arguments]
        if any(isinstance(x, float) for x in operands):
            return _against_infinity(node.operation, operands)
        return self._numbers.apply(node.operation, operands)

    # ── sensors and actuators ────────────────────────────────────────────────────────

    def _sensed(self, outputs: Mapping[Address, Any]) -> dict[Address, Any]:
        measurements: dict[Address, Any] = {}
        for address, output in outputs.items():
            sensor = self.problem.sensors.get(address)
            value = output
            if sensor is not None:
                if sensor.difference is not None:
                    value = self._rate(address, sensor.difference, measurements)
                value = self._delayed(".".join(address), sensor.delay, value)
            measurements[address] = value
        return measurements

    def _rate(self, address: Address, constant: float, measurements: Mapping[Address, Any]) -> Any:
        """Return a sensor's filtered difference as rate."""
        numbers, h = self._numbers, self.problem.period
        label = ".".join(address)
        of = (address[0], self.problem.site.interface.outputs[address].rate_of)
        if of not in measurements:
            raise LoopProofError(f"'{label}' has no output before it whose rate it is")
        before, slope = self._state(f"before:{label}"), self._state(f"slope:{label}")
        self._after[f"before:{label}"] = measurements[of]
        value = numbers.number(0.0)
        if not self._first:
            # First-order filter, implicit Euler: s + (steep - s) h / (T + h), time constant T.
            change = numbers.apply("subtract", [measurements[of], before])
            steep = numbers.apply("divide", [change, numbers.number(h)])
            gap = numbers.apply("subtract", [steep, slope])
            share = numbers.apply("divide", [numbers.number(h), numbers.number(constant + h)])
            value = numbers.apply("add", [slope, numbers.apply("multiply", [gap, share])])
        self._after[f"slope:{label}"] = value
        return value

    def _queue(self, kind: str, address: Address, actuator: Port) -> list[str]:
        """Return the states of a dead time, youngest first."""
        count = whole_periods(actuator.dead_time, self.problem.period)
        return [f"{kind}:{'.'.join(address)}:{k + 1}" for k in range(count)]

    def _delayed(self, label: str, delay: float, value: Any) -> Any:
        passed = value
        for k in range(whole_periods(delay, self.problem.period)):
            name = f"late:{label}:{k + 1}"
            older = value if self._first else self._state(name)
            self._after[name], passed = passed, older
        return passed

    def _actuated(self, address: Address, drives: Mapping[Address, Any]) -> Any:
        numbers = self._numbers
        port = self.problem.site.interface.inputs[address]
        value = drives.get(address)
        if value is None:
            value = numbers.number(0.0)
        value = numbers.limit(value, port.low, port.high)
        if port.slew < math.inf:
            name = f"driven:{address[0]}.{address[1]}"
            value = self._rate_limited(value, self._state(name), port.slew)
            self._after[name] = value
        for name in self._queue("pending", address, port):
            self._after[name], value = value, self._state(name)
        return value


def _both(value: Callable[[Node], Any], a: Node, b: Node) -> Any:
    first = value(a)
    if isinstance(first, bool):
        return first and value(b)
    return first.both(value(b))


def _negated(truth: Any) -> Any:
    return not truth if isinstance(truth, bool) else truth.negated()


_CONDITIONS: dict[str, Callable[..., Any]] = {
    "both": _both,
    "either": lambda value, a, b: _negated(_both(lambda node: _negated(value(node)), a, b)),
    "negation": lambda value, a: _negated(value(a)),
}
"""Joined conditions: the second is evaluated if the first does not decide."""


_ARITHMETIC: dict[int, tuple[str, ...]] = {
    code.COPY: (),
    code.ADD: ("add",),
    code.SUBTRACT: ("subtract",),
    code.MULTIPLY: ("multiply",),
    code.DIVIDE: ("divide",),
    code.MULTIPLY_BOTH: ("multiply", "multiply"),
    code.MULTIPLY_DIVIDE: ("multiply", "divide"),
    code.SUBTRACT_MULTIPLY: ("subtract", "multiply"),
}
"""Operations that fold the first cell with each of the others, by instruction."""


def _instructions(program: ControllerCode) -> Iterator[list[int]]:
    """Yield instructions without their rounding steps."""
    for at in range(1, 1 + code.INSTRUCTION * program.code[0], code.INSTRUCTION):
        yield program.code[at : at + code.INSTRUCTION - 1]


def _fetched(program: ControllerCode, begin: int) -> dict[int, int]:
    """Return the cells of an update's arguments that are not constants."""
    pairs = program.code[begin + code.FETCHES :][: 2 * program.code[begin + code.FETCHED]]
    return dict(zip(pairs[::2], pairs[1::2], strict=True))


def _signals_of(program: ControllerCode, wiring: Wiring) -> list[Address]:
    """Return the axis and the signal or drive that each instruction works for."""
    signals = {cell: key for key, cell in program.signals.items()}
    signals |= {cell: key for key, cell in wiring.drives.items()}
    names, following = list[Address](), ("", "")
    for _, into, *_ in reversed(list(_instructions(program))):
        following = signals.get(into, following)
        names.append(following)
    return names[::-1]


def _names_of_states(program: ControllerCode, signals: Sequence[Address]) -> dict[int, str]:
    """Return the persistent cells that are read, named after their signal or drive."""
    instructions = list(_instructions(program))
    limits = {
        b + code.OVER: k
        for k, (operator, _, _, b, _) in enumerate(instructions)
        if operator == code.LIMIT
    }
    names, cell_names, last = Names(), dict[int, str](), set(program.last.values())

    def name(cell: int, suffix: str, at: int) -> None:
        axis, base = signals[at]
        if cell not in cell_names:
            stem = names.new(f"{axis}_{base}_{suffix}").removeprefix(f"{identifier(axis)}_")
            cell_names[cell] = f"state:{axis}:{stem}"

    for at, (operator, _, a, b, _) in enumerate(instructions):
        if operator == code.COPY and a in last:
            name(a, "last", at)
        elif operator == code.SLEW:
            name(b + code.LAST_DRIVE, "before_slew", at)
        elif operator == code.UPDATE:
            for cell, state in enumerate(program.updates[b].states, b + 1):
                name(cell, state.name, at)
            for cell in _fetched(program, a).values():
                if cell in limits:
                    name(cell, "excess", limits[cell])
    return cell_names


def _limits(node: Apply) -> tuple[Node, float, float] | None:
    """Return the limited cell and the limits of ``min(max(x, low), high)``."""
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
    """Return a comparison, minimum or maximum with one infinite operand."""
    first, second = arguments
    if operation in ("less", "less_equal"):
        return first < 0 if isinstance(first, float) else second > 0
    endless, other = (first, second) if isinstance(first, float) else (second, first)
    if operation in ("minimum", "maximum"):
        return other if (endless > 0) == (operation == "minimum") else endless
    raise LoopProofError(f"'{operation}' of something infinite")
