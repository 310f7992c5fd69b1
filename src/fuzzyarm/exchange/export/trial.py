"""A trial of a controller: its program evaluated over the sequence of its self-test.

The figures of a report on an exported text are measured here, on the printed program, as Python
over numbers of its kinds. In single precision numbers are those of NumPy, whose arithmetic rounds
every result.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.exchange.export.languages import MODULES, PYTHON
from fuzzyarm.exchange.export.modules import module_of
from fuzzyarm.exchange.export.numbers import Kind
from fuzzyarm.exchange.export.printer import Printer
from fuzzyarm.exchange.export.rulebase import DirectRoutine
from fuzzyarm.exchange.export.steps import Ask, Find, Steps, StepVariable
from fuzzyarm.exchange.export.table import FixedTable
from fuzzyarm.exchange.export.typed_program import Program
from fuzzyarm.symbolic.operations import Operation


def _operation(printer: Printer, operation: Operation, kind: Kind) -> str:
    """Return the text of an operation; a function of a library is rounded to the arithmetic."""
    text = PYTHON.operation(printer, operation, kind)
    of_library = operation.sort == "functions" and operation.name != "absolute"
    return f"{_NAMES[kind]}({text})" if of_library else text


def _number(_printer: Printer, value: float, kind: Kind) -> str:
    return f'{_NAMES[kind]}("{value!r}")'


def _array(_printer: Printer, name: str, kind: Kind, values: Sequence[float], _columns: int) -> str:
    make = _NAMES.get(kind, "int")
    return f"{name} = [{', '.join(f'{make}({str(x)!r})' for x in values)}]"


def _cast(text: str, _before: Kind, after: Kind) -> str:
    return f"{_NAMES.get(after, 'int')}({text})"


_NAMES: Mapping[Kind, str] = {np.float32: "single", np.float64: "float"}

_EVALUATED = replace(
    PYTHON, operation=_operation, number=_number, array=_array, cast=_cast, flawed_floats=False,
    checked=("", ""),
)  # fmt: skip


def _remembering(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that keeps its results: an error that is tried leaves most axes alone."""
    results: dict[str, Any] = {}

    def remembering(*numbers: Any) -> Any:
        key = repr(numbers)  # of 0 with its sign
        if key not in results:
            results[key] = function(*numbers)
        return results[key]

    return remembering


class EvaluatedController:
    """A controller as its program drives it.

    Parameters
    ----------
    program : Program
        With a step.
    """

    def __init__(self, program: Program) -> None:
        module = MODULES[".py"]._replace(target=_EVALUATED)
        printer = Printer(program, _EVALUATED)
        text = module_of(printer, module)
        self._members = {key: name.partition(".")[2] for key, name in printer.members.items()}
        names: dict[str, Any] = {"single": np.float32}
        exec(compile(text, "program", "exec"), names)
        for key, function in program.functions.items():
            if not any(each.of_array for each in function.parameters.values()):
                names[printer.called[key]] = _remembering(names[printer.called[key]])
        assert program.step is not None
        self.kinds = [variable.kind for variable in program.step.parameters.values()]
        self._new: Callable[[], Any] = names["Controller"]
        self.start()

    def start(self) -> None:
        """Forget everything."""
        self.controller = self._new()
        for name, value in vars(self.controller).items():
            if isinstance(value, array) and value.typecode == "f":  # which returns doubles
                setattr(self.controller, name, list(map(np.float32, value)))
        state = vars(self.controller)
        self._arrays = [name for name, value in state.items() if isinstance(value, array | list)]

    def value(self, symbol: str) -> float:
        """Return a variable of the state by its symbol; NaN for any other."""
        return float(getattr(self.controller, self._members.get(symbol, ""), math.nan))

    def after(self, symbols: Sequence[str], *ports: float) -> tuple[list[float], tuple[float, ...]]:
        """Return variables of the state, and the drives, of a period that does not count."""
        before = dict(vars(self.controller))
        before |= {name: copy(before[name]) for name in self._arrays}
        drives = self.step(*ports)
        found = [self.value(symbol) for symbol in symbols]
        vars(self.controller).update(before)
        return found, drives

    def step(self, *ports: float) -> tuple[float, ...]:
        """Run one period with values of references and measured ports; return the drives."""
        late = [False] * (len(self.kinds) - len(ports))
        given = [_PORTS[kind](x) for kind, x in zip(self.kinds, ports, strict=False)]
        with np.errstate(all="ignore"):
            drives = self.controller.step(*given, *late)
        return tuple(map(float, drives if isinstance(drives, tuple) else (drives,)))


_PORTS: Mapping[Kind, Callable[[float], Any]] = {np.float32: np.float32, np.float64: float}


LOST = 7
"""The period of the first axis' NaN input; the next axis has it in the next. All axes have one in
the first period, without last values of drives."""

_SEGMENT = 5
"""Periods of one sort."""

_ANY_SIZE = np.array([-3.0, -0.9, -0.3, -0.05, -0.002, 0.0, 0.002, 0.05, 0.3, 0.9, 3.0])

_NO_SIZE = np.array([], np.float64)

_PROBE = 1e-3

_CHOICES = 7
"""Errors to choose from in each period."""

_AIMED = 2
"""How many more are moved so that a rule base or a table reads a value in or beyond its pieces,
whatever the controller remembers."""

_MOST_CHOSEN = 64
"""Measured ports up to which errors are chosen, each moved separately. More of them wander."""


def trial(
    steps: Steps, periods: int, seed: int = 1, controller: EvaluatedController | None = None
) -> Iterator[dict[str, float]]:
    """Yield values for the ports, period by period.

    References wander. Measured values miss them by errors: for some periods in turn those that show
    most, then some about one point, so that changes are of every size, too. With a controller the
    errors move the inputs of its rule bases and tables into every piece of their terms and cells,
    and beyond their ranges: of several errors the one that reaches most new places. Then the caller
    runs it, period by period. Some values are not numbers (`LOST`).
    """
    draw = np.random.default_rng(seed)
    sample = _sample(steps, draw)
    measured = steps.of_sort("measured")
    controller = controller if len(measured) <= _MOST_CHOSEN else None
    telling, movers = _probing_errors(steps, controller) if controller is not None else ({}, {})
    errors = {port: telling.get(port.symbol, (_ANY_SIZE, _NO_SIZE)) for port in measured}
    turns = {port: [_in_turn(sizes, draw) for sizes in each] for port, each in errors.items()}
    points = dict.fromkeys(measured, 0.0)
    places = _Places(steps, controller, movers) if controller is not None else None

    def moved(*, around: bool, spread: float) -> dict[StepVariable, float]:
        """Return possible next errors."""
        found = {}
        for port, (next_size, next_change) in turns.items():
            sizes, changes = errors[port]
            if not around:
                found[port] = next(next_size)
            elif changes.size:
                found[port] = points[port] + next(next_change)
            else:
                found[port] = points[port] + spread * sizes[-1] * draw.uniform(-1.0, 1.0)
        return found

    spread = 1.0
    for k in range(periods):
        if k % _SEGMENT == 0:
            spread = 10.0 ** draw.uniform(-3.0, 0.0)
        around = (k // _SEGMENT) % 3 == 2 and k % _SEGMENT != 0
        choices = [moved(around=around, spread=spread) for _ in range(_CHOICES if places else 1)]
        if places is not None:
            aimed = (places.aimed(x, partial(sample, k), draw) for x in choices[:_AIMED])
            choices = [*choices, *aimed]
        samples = [sample(k, choice) for choice in choices]
        best = places.visit_best(samples) if places is not None else 0
        points = choices[best]
        yield samples[best]


def _sample(
    steps: Steps, draw: np.random.Generator
) -> Callable[[int, Mapping[StepVariable, float]], dict[str, float]]:
    """Return the function from a period and the errors in it to the values of all ports."""
    outside = steps.precision.outside
    symbols = {variable: variable.symbol for variable in steps.of_sort("measured")}
    targets = {port: x.replace("measured:", "reference:") for port, x in symbols.items()}
    waves = {variable.symbol: draw.uniform(0.2, 2.0, 2) for variable in steps.of_sort("reference")}

    @lru_cache(1)
    def references(k: int) -> dict[str, float]:
        return {
            symbol: float(outside(a * math.sin(0.05 * b * k))) for symbol, (a, b) in waves.items()
        }

    def sample(k: int, errors: Mapping[StepVariable, float]) -> dict[str, float]:
        values = dict(references(k))
        for port, error in errors.items():
            values[symbols[port]] = float(outside(values.get(targets[port], 0.0) - error))
        for number, block in enumerate(steps.blocks):
            reads, every = block.guard.reads, block.guard.every
            lost = -(-(LOST + number) // every) * every  # a period in which it runs
            # A slow axis runs in the first period, perhaps for the only time: with its numbers.
            if k in ((0, lost) if every == 1 else (lost,)) and reads:
                values[reads[k % len(reads)]] = math.nan
        return values

    return sample


_NONE = math.inf, -math.inf


class _Places:
    """Places read in a controller's rule bases and tables, with a visible effect on a drive.

    A place is a piece of each input, and the pieces of all inputs together. A drive with a repeated
    value shows no effect: it is at a limit.
    """

    def __init__(
        self, steps: Steps, controller: EvaluatedController, movers: Mapping[str, Sequence[str]]
    ) -> None:
        self._controller, self._movers = controller, movers
        self._ports = _port_symbols(steps)
        self._readers = list(_read(steps))
        self._names = [name for reader in self._readers for name, _ in reader]
        self._visited: set[tuple[object, ...]] = set()
        self._driven: set[tuple[int, float]] = set()
        self._ends: dict[int, tuple[float, float]] = {}

    def visit_best(self, samples: Sequence[Mapping[str, float]]) -> int:
        """Visit the pieces of the sample with most new ones; return its number."""
        shown = [self._reached(sample) for sample in samples]
        counts = [self._new(reached, driven) for reached, driven in shown]
        best = counts.index(max(counts))
        self._visit(*shown[best])
        return best

    def aimed(
        self,
        errors: Mapping[StepVariable, float],
        sample: Callable[[Mapping[StepVariable, float]], dict[str, float]],
        draw: np.random.Generator,
    ) -> dict[StepVariable, float]:
        """Return errors moved so that one reader reads values drawn from those of its pieces."""
        moved = dict(errors)

        def reading(name: str, port: StepVariable | None = None, step: float = 0.0) -> float:
            values = sample(moved if port is None else {**moved, port: moved[port] + step})
            return self._controller.after([name], *(values[x] for x in self._ports))[0][0]

        reader = self._readers[draw.integers(len(self._readers))] if self._readers else []
        free = list(moved)
        for name, points in reader:
            target, before = draw.choice(points), reading(name)
            movers = [port for port in free if port.symbol in self._movers[name]]
            slopes = {port: (reading(name, port, _PROBE) - before) / _PROBE for port in movers}
            moves = [port for port, x in slopes.items() if x != 0.0 and math.isfinite(x)]
            if moves:
                port = max(moves, key=lambda port: abs(slopes[port]))
                moved[port] += (target - before) / slopes[port]
                free.remove(port)
        return moved

    def _new(self, reached: set[tuple[object, ...]], driven: set[tuple[int, float]]) -> int:
        """Return the number of unvisited pieces, and of drives beyond their greatest values."""
        beyond = (
            not self._ends.get(k, _NONE)[0] <= x <= self._ends.get(k, _NONE)[1] for k, x in driven
        )
        return len(reached - self._visited) + sum(beyond)

    def _visit(self, reached: set[tuple[object, ...]], driven: set[tuple[int, float]]) -> None:
        self._visited |= reached
        self._driven |= driven
        for k, x in driven:
            low, high = self._ends.get(k, _NONE)
            self._ends[k] = min(low, x), max(high, x)

    def _reached(
        self, sample: Mapping[str, float]
    ) -> tuple[set[tuple[object, ...]], set[tuple[int, float]]]:
        ports = (sample[port] for port in self._ports)
        found, drives = self._controller.after(self._names, *ports)
        values, places = iter(found), set[tuple[object, ...]]()
        for number, reader in enumerate(self._readers):
            cells = [int(np.searchsorted(points, next(values))) for _, points in reader]
            places |= {(number, k, cell) for k, cell in enumerate(cells)} | {(number, *cells)}
        driven = set(enumerate(drives))
        shown = [number for number, _ in driven - self._driven]
        return {(number, *place) for number in shown for place in places}, driven


def _port_symbols(steps: Steps) -> list[str]:
    return [port.symbol for sort in ("reference", "measured") for port in steps.of_sort(sort)]


def _in_turn(sizes: NDArray[Any], draw: np.random.Generator) -> Iterator[float]:
    """Yield all sizes, in another order each time."""
    while sizes.size:
        yield from draw.permutation(sizes).tolist()


def _probing_errors(
    steps: Steps, controller: EvaluatedController
) -> tuple[dict[str, tuple[NDArray[Any], NDArray[Any]]], dict[str, list[str]]]:
    """Return errors of each measured port, and changes of them, for the values that show most.

    And for measured values, the ports that move them.
    """
    ports = _port_symbols(steps)
    wanted = [reads for reader in _read(steps) for reads in reader]

    def values(moved: str, size: float = _PROBE) -> list[NDArray[Any]]:
        """Return the measured values in the period in which a port moves, and in the next one."""
        controller.start()
        found = []
        for error in (0.0, size, size):
            controller.step(*(-error if port == moved else 0.0 for port in ports))
            found.append(np.array([controller.value(name) for name, _ in wanted]))
        return found[1:]

    rest, telling = values("")[0], {}
    movers: dict[str, list[str]] = {name: [] for name, _ in wanted}
    for port in ports:
        slopes, later = ((found - rest) / _PROBE for found in values(port))
        errors, changes = [_NO_SIZE], [_NO_SIZE]
        for k, (slope, stays, (_, points)) in enumerate(zip(slopes, later, wanted, strict=True)):
            if slope != 0.0 and math.isfinite(slope):
                movers[wanted[k][0]].append(port)
                kind = errors if abs(stays) > 1e-3 * abs(slope) else changes
                sizes = (points - rest[k]) / slope
                kind.append(sizes)
                # Far from rest a signal may grow otherwise: it is magnified near it, or limited.
                largest = float(sizes[np.argmax(np.abs(sizes))])
                far = (values(port, largest)[0][k] - rest[k]) / largest if largest else slope
                if far != 0.0 and math.isfinite(far) and abs(far - slope) > 0.01 * abs(slope):
                    kind.append((points - rest[k]) / far)
        sizes, moved = (np.unique(np.concatenate(each)) for each in (errors, changes))
        telling[port] = (sizes if sizes.size else _ANY_SIZE), moved
    controller.start()
    return telling, movers


def _read(steps: Steps) -> Iterator[list[tuple[str, NDArray[Any]]]]:
    """Yield the inputs of each rule base and table, with values in and between its pieces."""
    for step in steps.steps:
        if isinstance(step, Ask):
            routine = steps.routines[step.routine]
            points = routine.pieces() if isinstance(routine, DirectRoutine) else routine.vectors()
            columns = points.inputs
            telling = [np.unique(column.astype(np.float64)) for column in columns]
            core = getattr(routine, "core", None)
            if isinstance(core, FixedTable):
                scales = core.inputs
                telling = [scale.quantity(x) for scale, x in zip(scales, telling, strict=True)]
        elif isinstance(step, Find):
            telling = [_between(edges) for _, edges in steps.grids[step.grid]]
        else:
            continue
        yield list(zip(step.inputs, telling, strict=True))


def _between(edges: tuple[float, ...]) -> NDArray[Any]:
    """Return values between edges, and beyond."""
    if len(edges) < 2:
        return np.array([edges[0] - 1.0, edges[0] + 1.0] if edges else [0.0])
    points = np.array(edges)
    middles = 0.5 * (points[1:] + points[:-1])
    return np.concatenate([[2 * points[0] - middles[0]], middles, [2 * points[-1] - middles[-1]]])
