"""Rule bases, tables and controllers as modules in one file, each with its head and its test."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.export.controller_lowering import controller_program
from fuzzyarm.exchange.export.controllers import ControllerProgram
from fuzzyarm.exchange.export.languages import PYTHON
from fuzzyarm.exchange.export.lowering import routines_program
from fuzzyarm.exchange.export.modules import Module, module_of
from fuzzyarm.exchange.export.printer import FunctionPrinter, Printer
from fuzzyarm.exchange.export.routine import Routine, plain, routine_words
from fuzzyarm.exchange.export.typed_program import SelfTest
from fuzzyarm.version import __version__

__all__ = ["controller_module", "routines_module"]

SINGLE_PERIODS = 1e-2
"""What a port with floats of 32 bits may be off by in the self-test, of the largest drive."""


def routines_module(
    routines: Sequence[Routine], module: Module, name: str
) -> tuple[str, tuple[str, ...]]:
    """Return a module with a function for every routine, and how they are called."""
    program = routines_program(routines)
    printer = Printer(program, module.target)
    public = [key for key, function in program.functions.items() if function.public]
    calls = tuple(printer.call(key) for key in public)
    words = [
        f"made by fuzzyarm {__version__}; do not edit: make it again from its source",
        "",
        *(line for routine, call in zip(routines, calls, strict=True)
          for line in (call, *(f"  {word}" for word in routine_words(routine)), "")),
        module.test.format(name),
    ]  # fmt: skip
    return _headed(words, module, module_of(printer, module)), calls


def controller_module(
    program: ControllerProgram, module: Module, name: str
) -> tuple[str, tuple[str, ...], ControllerProgram]:
    """Return a module with a class, how it is made and called, and the program as measured."""
    lowered, vectors = controller_program(program.steps), program.tried.vectors
    assert lowered.step is not None
    rows = [
        (*given, *drives) for given, drives in zip(vectors.inputs, vectors.expected, strict=True)
    ]
    loose = SINGLE_PERIODS * max(program.tried.largest, 1e-30)
    late = program.steps.needs_last
    test = SelfTest("", np.float64, rows, len(vectors.inputs[0]), vectors.tolerance, loose, late)
    lowered.tests.append(test)
    printer = Printer(lowered, module.target)
    body = module_of(printer, module)
    if module.target is PYTHON:
        program = program.measured(_driven(body, vectors.inputs))
    call = f"step({', '.join(FunctionPrinter(printer, lowered.step).parameter_texts())})"
    drives = [variable.stem for variable in lowered.drives.values()]
    words = [
        *program.head(),
        "",
        f"use: {module.create.removesuffix(';')}, then controller.{call}"
        f" every {number_text(program.text.model.period)} s",
        f"step returns {drives[0] if len(drives) == 1 else ', '.join(drives)}",
        "gains are members of the controller, to be set at any time",
        *_use_words(program, printer),
        module.test.format(name),
    ]
    calls = (module.create.partition("= ")[2].removesuffix(";"), call)
    return _headed(words, module, body), calls, program


def _driven(text: str, inputs: Sequence[Sequence[float]]) -> list[list[float]]:
    """Return the drives of a module of Python, which is executed."""
    names: dict[str, Any] = {}
    exec(compile(text, "module", "exec"), names)
    controller = names["Controller"]()
    found = (controller.step(*row) for row in inputs)
    return [list(drives) if isinstance(drives, tuple) else [drives] for drives in found]


def _use_words(program: ControllerProgram, printer: Printer) -> Iterator[str]:
    steps = program.steps
    if steps.needs_last:
        yield (
            f"a set point lasts {steps.model.every} periods; where the next one comes off that"
            " count, set_point_ends is true in the last period of the present one"
        )
    if steps.learned:
        names = ", ".join(printer.members[key].partition(".")[2] for key in steps.learned)
        yield f"tables that learn are arrays: {names}, each with its visits"


def _headed(words: Sequence[str], module: Module, body: str) -> str:
    """Return a text with its comment at the head."""
    head = [f"{module.comment} {plain(line)}".rstrip() for line in words]
    return "\n".join([*head, body])
