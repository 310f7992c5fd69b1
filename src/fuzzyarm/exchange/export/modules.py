"""A program as a module in one file: MicroPython, JavaScript, Rust.

The parts come from the printer; here they get their frame: the comment at the head, the class of a
controller, the self-test, and what a language expects of a module.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from fuzzyarm.base.jsonable import script_json
from fuzzyarm.exchange.export.languages import JAVASCRIPT, LETTERS, PYTHON, RUST
from fuzzyarm.exchange.export.printer import FunctionPrinter, Printer, Target
from fuzzyarm.exchange.export.routine import plain
from fuzzyarm.exchange.export.typed_program import TRUTH, Member

__all__ = ["MODULES", "Module", "module_of", "start_text"]


Members = Sequence[tuple[str, Member]]
"""The variables of the state, each with its text."""


class Module(NamedTuple):
    """A language whose export is one file.

    Attributes
    ----------
    target : Target
        Its spellings.
    comment : str
        Begins a line of comment.
    test : str
        How the self-test is called, in words; a hole for the name of the module.
    frame : callable
        From a printer, the parts and the test to the lines behind the head.
    controller : callable
        From the lines of the members and of the step to those of the class.
    create : str
        Makes a controller.
    """

    target: Target
    comment: str
    test: str
    frame: Callable[[Printer, Sequence[str], Sequence[str]], list[str]]
    controller: Callable[[Printer, Members, list[str], list[str]], list[str]]
    create: str


def module_of(printer: Printer, module: Module) -> str:
    """Return the text of a module without its head."""
    program, parts = printer.program, list(printer.functions)
    if program.step is not None:
        parts.append("\n".join(_class(printer, module)))
    test: list[str] = []
    if program.step is not None and program.tests:
        test.append(module.create)
    for each in program.tests:
        stem = f"test of {printer.called[each.function]}" if each.function else "test"
        test += printer.test_lines(each, stem)
    return "\n".join(module.frame(printer, parts, test))


def _class(printer: Printer, module: Module) -> list[str]:
    step = printer.program.step
    assert step is not None
    function = FunctionPrinter(printer, step)
    parameters, lines = function.parameter_texts(), function.lines(step.body)
    members = [(printer.members[key], member) for key, member in printer.program.state.items()]
    return module.controller(printer, members, parameters, lines)


def start_text(printer: Printer, member: Member) -> str:
    """Return the text of the value that a number of the state begins with."""
    start, target = member.start, printer.target
    assert not isinstance(start, tuple)
    if member.kind is TRUTH:
        return target.truths[bool(start)]
    if np.issubdtype(member.kind, np.integer):
        return f"{int(start)}{target.marks.get(member.kind, '')}"
    return target.number(printer, float(start), member.kind)


def _array_start(printer: Printer, member: Member, uniform: str, copied: str) -> str:
    """Return the text of the elements that an array begins with: all alike, or of a constant."""
    assert isinstance(member.start, tuple)
    if len(set(member.start)) == 1:
        value = start_text(printer, replace(member, start=member.start[0]))
        return uniform.format(value=value, count=len(member.start))
    return copied.format(printer.constant(f"{member.stem}_start", member.kind, member.start))


# ── MicroPython ──────────────────────────────────────────────────────────────────────


def _python_start(printer: Printer, member: Member) -> str:
    if not isinstance(member.start, tuple):
        return start_text(printer, member)
    letter, size = LETTERS[np.dtype(member.kind).name], np.dtype(member.kind).itemsize
    zeros = f'array("{letter}", bytes({size * len(member.start)}))'
    uniform = zeros if not any(member.start) else "[{value}] * {count}"
    return _array_start(printer, member, uniform, f'array("{letter}", {{}})')


def _python_class(
    printer: Printer, members: Members, parameters: list[str], step: list[str]
) -> list[str]:
    starts = []
    for name, member in members:
        remark = f"  # {plain(member.remark)}" if member.remark else ""
        starts.append(f"        {name} = {_python_start(printer, member)}{remark}")
    return [
        "class Controller:", "    def __init__(self):", *(starts or ["        pass"]), "",
        f"    def step({', '.join(['self', *parameters])}):",
        *(f"        {line}" for line in step), "",
    ]  # fmt: skip


def _python_frame(printer: Printer, parts: Sequence[str], test: Sequence[str]) -> list[str]:
    needs_math = any("math." in text for text in [*printer.helpers, *parts])
    return [
        "", *(["import math"] if needs_math else []), "from array import array", "",
        *printer.constants, "", *printer.helpers, *parts,
        "def self_test():", "    # Returns 0 if all agrees with the model.", "    failed = False",
        *(f"    {line}" for line in test), "    return int(failed)", "",
    ]  # fmt: skip


# ── JavaScript ───────────────────────────────────────────────────────────────────────


def _javascript_class(
    printer: Printer, members: Members, parameters: list[str], step: list[str]
) -> list[str]:
    starts = []
    for name, member in members:
        start = (
            _array_start(printer, member, "Array({count}).fill({value})", "{}.slice()")
            if isinstance(member.start, tuple) else start_text(printer, member)
        )  # fmt: skip
        remark = f" // {plain(member.remark)}" if member.remark else ""
        starts.append(f"    {name} = {start};{remark}")
    return [
        "export class Controller {", "  constructor() {", *starts, "  }", "",
        f"  step({', '.join(parameters)}) {{", *(f"    {line}" for line in step), "  }", "}", "",
    ]  # fmt: skip


def _javascript_frame(printer: Printer, parts: Sequence[str], test: Sequence[str]) -> list[str]:
    return [
        "", *printer.constants, "", *printer.helpers, "", *parts, *_by_name(printer),
        "/** Returns 0 if all agrees with the model. */", "export function selfTest() {",
        "    let failed = false;", *(f"    {line}" for line in test),
        "    return failed ? 1 : 0;", "}", "",
    ]  # fmt: skip


def _by_name(printer: Printer) -> list[str]:
    """Return functions over inputs by their names in the rule base, and the two lists of names."""
    public = [(key, f) for key, f in printer.program.functions.items() if f.public]
    if not public:
        return []
    pairs = []
    for key, function in public:
        arguments = ", ".join(
            f"Number(given[{script_json(v.stem)}])" for v in function.parameters.values()
        )
        pairs.append(f"    {script_json(function.stem)}: {printer.called[key]}({arguments}),")
    return [
        f"export const inputs = {script_json(printer.program.inputs)};",
        f"export const outputs = {script_json(printer.program.outputs)};",
        "/** The outputs by name, from the inputs by name; NaN where there is no value. */",
        "export function infer(given) {", "  return {", *pairs, "  };", "}", "",
        "/** Rows of outputs by name, from columns of inputs by name (arrays of one length). */",
        "export function inferMany(given) {",
        "  const found = Object.fromEntries(outputs.map((each) => [each.name, []]));",
        "  for (let k = 0; k < given[inputs[0].name].length; k++) {",
        "    const at = Object.fromEntries(inputs.map(({ name }) => [name, given[name][k]]));",
        "    for (const [name, value] of Object.entries(infer(at))) found[name].push(value);",
        "  }", "  return found;", "}", "",
    ]  # fmt: skip


# ── Rust ─────────────────────────────────────────────────────────────────────────────


def _rust_class(
    printer: Printer, members: Members, parameters: list[str], step: list[str]
) -> list[str]:
    fields, starts = [], []
    for text, member in members:
        name, kind = text.removeprefix("self."), printer.target.types[member.kind]
        start = (
            _array_start(printer, member, "[{value}; {count}]", "{}")
            if isinstance(member.start, tuple) else start_text(printer, member)
        )  # fmt: skip
        kind = f"[{kind}; {len(member.start)}]" if isinstance(member.start, tuple) else kind
        remark = f" // {plain(member.remark)}" if member.remark else ""
        fields.append(f"    pub {name}: {kind},{remark}")
        starts.append(f"            {name}: {start},")
    kinds = [printer.target.types[v.kind] for v in printer.program.drives.values()]
    returned = kinds[0] if len(kinds) == 1 else f"({', '.join(kinds)})"
    return [
        "pub struct Controller {", *fields, "}", "", "impl Controller {",
        "    pub fn new() -> Self {", "        Controller {", *starts, "        }", "    }", "",
        f"    pub fn step({', '.join(['&mut self', *parameters])}) -> {returned} {{",
        *(f"        {line}" for line in step), "    }", "}", "",
    ]  # fmt: skip


def _rust_frame(printer: Printer, parts: Sequence[str], test: Sequence[str]) -> list[str]:
    return [
        "", "#![allow(dead_code, non_snake_case, non_upper_case_globals, unused)]",
        "#![allow(clippy::all)]", "", *printer.constants, "", *printer.helpers, *parts,
        "/// Returns 0 if all agrees with the model.", "pub fn self_test() -> i32 {",
        "    let mut failed = false;", *(f"    {line}" for line in test),
        "    i32::from(failed)", "}", "", "#[cfg(test)]", "#[test]", "fn agrees_with_the_model() {",
        "    assert_eq!(self_test(), 0);", "}", "",
    ]  # fmt: skip


_JAVASCRIPT_MODULE = Module(
    JAVASCRIPT, "//", "selfTest() is 0 where all is well", _javascript_frame, _javascript_class,
    "const controller = new Controller();",
)  # fmt: skip

MODULES: Mapping[str, Module] = MappingProxyType({
    ".py": Module(PYTHON, "#", "on a board: import {0}, and {0}.self_test() is 0 where all is well",
                  _python_frame, _python_class, "controller = Controller()"),
    **dict.fromkeys((".mjs", ".js"), _JAVASCRIPT_MODULE),
    ".rs": Module(
        RUST, "//", "self-test: rustc --test {0}.rs && ./{0}; self_test() is 0 where all is well",
        _rust_frame, _rust_class, "let mut controller = Controller::new();",
    ),
})  # fmt: skip
"""Languages whose export is one file, by its suffix."""
