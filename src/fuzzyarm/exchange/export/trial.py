"""A controller tried: its program evaluated, over the sequence of its self-test.

What a report says of an exported text is measured here, on the program that is printed: as Python
over numbers of its kinds. In single precision numbers are those of NumPy, whose arithmetic rounds
every result.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.exchange.export.languages import MODULES, PYTHON
from fuzzyarm.exchange.export.modules import module_of
from fuzzyarm.exchange.export.numbers import Kind
from fuzzyarm.exchange.export.printer import Printer
from fuzzyarm.exchange.export.steps import Ask, Find, Steps
from fuzzyarm.exchange.export.table import FixedTable
from fuzzyarm.exchange.export.typed_program import Program
from fuzzyarm.symbolic.operations import Operation

__all__ = ["LOST", "EvaluatedController", "trial"]


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
    PYTHON, operation=_operation, number=_number, array=_array, cast=_cast, flawed_floats=False
)


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
        assert program.step is not None
        self.kinds = [variable.kind for variable in program.step.parameters.values()]
        self._new: Callable[[], Any] = names["Controller"]
        self.start()

    def start(self) -> None:
        """Forget everything."""
        self.controller = self._new()
        for name, value in vars(self.controller).items():
            if isinstance(value, array) and value.typecode == "f":  # which gives doubles back
                setattr(self.controller, name, list(map(np.float32, value)))

    def value(self, symbol: str) -> float:
        """Return a variable of the state by its symbol; NaN of what is none."""
        return float(getattr(self.controller, self._members.get(symbol, ""), math.nan))

    def step(self, *ports: float) -> tuple[float, ...]:
        """Run one period with values of references and measured ports; return the drives."""
        late = [False] * (len(self.kinds) - len(ports))
        given = [_PORTS[kind](x) for kind, x in zip(self.kinds, ports, strict=False)]
        with np.errstate(all="ignore"):
            drives = self.controller.step(*given, *late)
        return tuple(map(float, drives if isinstance(drives, tuple) else (drives,)))


_PORTS: Mapping[Kind, Callable[[float], Any]] = {np.float32: np.float32, np.float64: float}


LOST = 7
"""The period in which the first axis reads a value that is not a number; the next axis in the next.
In the very first period all axes do: their drives have no last value yet."""

_SEGMENT = 5
"""Periods of one sort."""

_ANY_SIZE = np.array([-3.0, -0.9, -0.3, -0.05, -0.002, 0.0, 0.002, 0.05, 0.3, 0.9, 3.0])

_NO_SIZE = np.array([], np.float64)

_PROBE = 1e-3


def trial(
    steps: Steps, periods: int, seed: int = 1, controller: EvaluatedController | None = None
) -> Iterator[dict[str, float]]:
    """Yield values for the ports, period by period.

    References wander. Measured values miss them by errors: for some periods in turn those that
    show most, then some about one point, so that changes are of every size, too. With a controller
    the errors bring what its rule bases and tables read into every piece of their terms and cells,
    and beyond their ranges. Some values are not numbers (`LOST`).
    """
    draw = np.random.default_rng(seed)
    outside = steps.precision.outside
    references = {variable: draw.uniform(0.2, 2.0, 2) for variable in steps.of_sort("reference")}
    measured = steps.of_sort("measured")
    telling = _telling_errors(steps, controller) if controller is not None else {}
    errors = {port: telling.get(port.symbol, (_ANY_SIZE, _NO_SIZE)) for port in measured}
    turns = {port: [_in_turn(sizes, draw) for sizes in each] for port, each in errors.items()}
    points = dict.fromkeys(measured, 0.0)
    for k in range(periods):
        around = (k // _SEGMENT) % 3 == 2
        if k % _SEGMENT == 0:
            spread = 10.0 ** draw.uniform(-3.0, 0.0)
        for port, (next_size, next_change) in turns.items():
            sizes, changes = errors[port]
            if not around or k % _SEGMENT == 0:
                points[port] = next(next_size)
            elif changes.size:
                points[port] += next(next_change)
            else:
                points[port] += spread * sizes[-1] * draw.uniform(-1.0, 1.0)
        sample = {
            variable.symbol: float(outside(a * math.sin(0.05 * b * k)))
            for variable, (a, b) in references.items()
        }
        for port, error in points.items():
            target = sample.get(port.symbol.replace("measured:", "reference:"), 0.0)
            sample[port.symbol] = float(outside(target - error))
        for number, (guard, *_) in enumerate(steps.guards):
            if k in (0, LOST + number):
                sample[guard.reads[k % len(guard.reads)]] = math.nan
        yield sample


def _in_turn(sizes: NDArray[Any], draw: np.random.Generator) -> Iterator[float]:
    """Yield all sizes, in another order each time."""
    while sizes.size:
        yield from draw.permutation(sizes).tolist()


def _telling_errors(
    steps: Steps, controller: EvaluatedController
) -> dict[str, tuple[NDArray[Any], NDArray[Any]]]:
    """Return errors of each measured port, and changes of them, for the values that show most."""
    ports = [port.symbol for sort in ("reference", "measured") for port in steps.of_sort(sort)]
    wanted = list(_read(steps))

    def values(moved: str) -> list[NDArray[Any]]:
        """Return what is read in the period in which a port moves, and in the next one."""
        controller.start()
        found = []
        for size in (0.0, _PROBE, _PROBE):
            controller.step(*(-size if port == moved else 0.0 for port in ports))
            found.append(np.array([controller.value(name) for name, _ in wanted]))
        return found[1:]

    rest, telling = values("")[0], {}
    for port in ports:
        slopes, later = ((found - rest) / _PROBE for found in values(port))
        errors, changes = [_NO_SIZE], [_NO_SIZE]
        for slope, stays, start, (_, points) in zip(slopes, later, rest, wanted, strict=True):
            if slope != 0.0 and math.isfinite(slope):
                kind = errors if abs(stays) > 1e-3 * abs(slope) else changes
                kind.append((points - start) / slope)
        sizes, moved = (np.unique(np.concatenate(each)) for each in (errors, changes))
        telling[port] = (sizes if sizes.size else _ANY_SIZE), moved
    controller.start()
    return telling


def _read(steps: Steps) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield what rule bases and tables read, each with values in and between its pieces."""
    for step in steps.steps:
        if isinstance(step, Ask):
            columns = steps.routines[step.routine].vectors().inputs
            telling = [np.unique(column.astype(np.float64)) for column in columns]
            core = getattr(steps.routines[step.routine], "core", None)
            if isinstance(core, FixedTable):
                scales = core.inputs
                telling = [scale.quantity(x) for scale, x in zip(scales, telling, strict=True)]
        elif isinstance(step, Find):
            telling = [_between(edges) for _, edges in steps.grids[step.grid]]
        else:
            continue
        yield from zip(step.inputs, telling, strict=True)


def _between(edges: tuple[float, ...]) -> NDArray[Any]:
    """Return values between edges, and beyond."""
    if len(edges) < 2:
        return np.array([edges[0] - 1.0, edges[0] + 1.0] if edges else [0.0])
    points = np.array(edges)
    middles = 0.5 * (points[1:] + points[:-1])
    return np.concatenate([[2 * points[0] - middles[0]], middles, [2 * points[-1] - middles[-1]]])
