"""A program evaluated: printed as Python over numbers of its kinds, and run.

What a report says of an exported text is measured here, on the program that is printed. In single
precision numbers are those of NumPy, whose arithmetic rounds every result.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fuzzyarm.exchange.export.languages import MODULES, PYTHON
from fuzzyarm.exchange.export.modules import module_of
from fuzzyarm.exchange.export.numbers import Kind
from fuzzyarm.exchange.export.printer import Printer
from fuzzyarm.exchange.export.typed_program import Program
from fuzzyarm.symbolic.operations import Operation

__all__ = ["EvaluatedController"]


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
