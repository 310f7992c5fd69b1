"""A program as a module in one file, in a language with a record.

The parts come from the printer; the record (`languages.py`) has the frame of the file and of the
class of a controller, as templates: a hole on its own line takes lines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fuzzyarm.exchange.export.document import Blocks, filled, filled_text
from fuzzyarm.exchange.export.printer import FunctionPrinter, Printer, Target, start_text
from fuzzyarm.exchange.export.routine import plain
from fuzzyarm.exchange.export.typed_program import Member
from fuzzyarm.symbolic.identifiers import identifier


class Module(NamedTuple):
    """A language whose export is one file."""

    target: Target  # its spellings
    comment: str  # begins a line of comment
    test: str  # how the self-test is called, in words; a hole for the name of the module
    create: str  # makes a controller
    # The file: ``<name>`` (the stem of its path), ``<identifier>`` (made of that), ``<constants>``,
    # ``<helpers>``, ``<parts>``, ``<more>`` and ``<test>``, which sets ``failed``. Names declared
    # by it are reserved words of its language, but not ``failed``.
    frame: str
    # A class: ``<fields>``, ``<starts>``, ``<parameters>``, ``<returned>`` and ``<step>``.
    controller: str
    own: str  # the first parameter of the step
    # The declaration of a member, and its initial assignment.
    field: str
    start: str
    # The value of an array of zeros, of equal elements, of those of a constant, with holes
    # ``count``, ``value``, ``name`` (of the constant), ``type``, ``letter`` and ``bytes``.
    arrays: tuple[str, str, str]
    more: Callable[[Printer], list[str]] | None = None  # from a printer to further lines


def module_of(printer: Printer, module: Module, name: str = "module") -> str:
    """Return the text of a module without its head; `name` is the stem of its file."""
    program, parts = printer.program, list(printer.functions)
    if program.step is not None:
        parts.append("\n".join(_class(printer, module)))
    test: list[str] = []
    if program.step is not None and program.tests:
        test.append(module.create)
    for each in program.tests:
        stem = f"test of {printer.called[each.function]}" if each.function else "test"
        test += printer.test_lines(each, stem)
    blocks: Blocks = {
        "constants": printer.constants, "helpers": printer.helpers, "parts": parts, "test": test,
        "more": module.more(printer) if module.more else [], "name": name,
        "identifier": identifier(name),
    }  # fmt: skip
    return "\n" + filled_text(module.frame, blocks)


def _class(printer: Printer, module: Module) -> Iterator[str]:
    step = printer.program.step
    assert step is not None
    function = FunctionPrinter(printer, step)
    fields, starts = [], []
    for key, member in printer.program.state.items():
        name = printer.members[key].rpartition(".")[2]
        kind = printer.target.types.get(member.kind, "")
        if isinstance(member.start, tuple):
            kind = printer.target.array_type.format(kind, len(member.start))
        remark = ""
        if member.remark:
            remark = printer.target.language.remark.format(plain(member.remark))
        words = {"name": name, "type": kind, "start": _start(printer, module, member)}
        fields.append(module.field.format(**words) + remark)
        starts.append(module.start.format(**words) + ("" if module.field else remark))
    kinds = [printer.target.types.get(each.kind, "") for each in printer.program.drives.values()]
    blocks: Blocks = {
        "fields": fields, "starts": starts,
        "step": [*function.checks(), *function.lines(step.body)],
        "parameters": ", ".join(filter(None, [module.own, *function.parameter_texts()])),
        "returned": kinds[0] if len(kinds) == 1 else (
            printer.target.several_type.format(", ".join(kinds), *kinds[:1])),
    }  # fmt: skip
    return filled(module.controller, blocks)


def _start(printer: Printer, module: Module, member: Member) -> str:
    """Return the text of a member's initial value."""
    if not isinstance(member.start, tuple):
        return start_text(printer, member)
    zeros, uniform, copied = module.arrays
    kind = np.dtype(member.kind)
    words = {"count": len(member.start), "letter": LETTERS[kind.name],
             "bytes": kind.itemsize * len(member.start),
             "type": printer.target.types.get(member.kind, "")}  # fmt: skip
    if len(set(member.start)) > 1:
        constant = printer.constant(f"{member.stem}_start", member.kind, member.start)
        return copied.format(name=constant, **words)
    value = start_text(printer, replace(member, start=member.start[0]))
    return (uniform if any(member.start) else zeros).format(value=value, **words)


LETTERS = {
    "float64": "d", "float32": "f", "int8": "b", "int16": "h", "int32": "i", "uint32": "I",
    "uint64": "i",
}  # fmt: skip
"""Type codes of Python's arrays, by kind."""
