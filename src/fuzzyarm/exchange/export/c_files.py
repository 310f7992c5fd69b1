"""Files in C: a header on its own, a source with its header, or a library of three files.

:mod:`.c` prints the program; here it gets its head comment, includes, guards and self-test.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from shlex import quote
from typing import NamedTuple

import numpy as np

from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.export.c import LIBRARY, CPrinter, of_struct
from fuzzyarm.exchange.export.controller_lowering import controller_program
from fuzzyarm.exchange.export.guard import (
    RegionGuard,
    step_name,
)
from fuzzyarm.exchange.export.lowering import routines_program
from fuzzyarm.exchange.export.numbers import c_number
from fuzzyarm.exchange.export.routine import (
    Routine,
    c_comment,
    calls_functions,
    head_lines,
)
from fuzzyarm.exchange.export.steps import Steps, StepVariable
from fuzzyarm.exchange.export.typed_program import (
    SelfTest,
)
from fuzzyarm.symbolic.identifiers import C_FUNCTIONS

SWITCH = "FUZZYARM_SELF_TEST"
"""The macro that adds a ``main`` to an exported file."""


@dataclass(frozen=True)
class CText:
    """Exported files.

    Attributes
    ----------
    files : dict of str to str
        Texts, by the ending of their names: ``.h``; ``.c`` with its ``.h``; of a library
        ``_self_test.c`` too, with the function `self_test`.
    printer : CPrinter
        Its parts.
    prototypes : tuple of str
        Of the functions that others call.
    """

    files: Mapping[str, str]
    printer: CPrinter
    prototypes: tuple[str, ...]

    @property
    def self_test(self) -> str:
        """The function of a library that returns 0 where all is well."""
        return self.printer.self_test

    def place(self, variable: StepVariable) -> str:
        """Return the C expression of a port, a gain or a signal of a controller."""
        return of_struct(self.printer.places[variable.symbol])


@dataclass(frozen=True)
class TestSequence:
    """A sequence of periods for the self-test: ports, row by row, and the drives."""

    inputs: Sequence[Sequence[float]]
    expected: Sequence[Sequence[float]]
    tolerance: float


def routines_c(routines: Sequence[Routine], prefix: str, stem: str, form: str) -> CText:
    """Return rule bases and tables in C."""
    printer = CPrinter(routines_program(routines, pointers=True), prefix, form)

    def head(text: _Text) -> list[str]:
        return head_lines(routines, text.prototypes, printer.flash, text.use, text.test)

    calls = any(map(calls_functions, routines))
    whole = all(issubclass(routine.kind, np.integer) for routine in routines)
    return _written(printer, stem, head, calls_functions=calls, whole=whole)


def controller_c(
    steps: Steps,
    prefix: str,
    stem: str,
    form: str,
    vectors: TestSequence | None,
    words: Sequence[str],
    guard: RegionGuard | None = None,
) -> CText:
    """Return a controller in C; `words` begin the comment at its head, others as `routines_c`."""
    program = controller_program(steps, pointers=True)
    if vectors is not None:
        rows = [
            (*given[: len(program.step.parameters) if program.step else 0], *drives)
            for given, drives in zip(vectors.inputs, vectors.expected, strict=True)
        ]
        kind, inputs = steps.precision.outside, len(rows[0]) - len(vectors.expected[0])
        program.tests.append(SelfTest("", kind, rows, inputs, vectors.tolerance, 0.0))
        if guard is not None:
            program.tests += (
                SelfTest("", kind, rows, inputs, vectors.tolerance, 0.0, guarded=True)
                for rows in guard.trials(steps, controller_program(steps))
            )
    if guard is not None:
        guard.add_to(program, steps)
    printer = CPrinter(program, prefix, form, steps)
    printer.fallback = guard.fallback if guard is not None else None

    def head(text: _Text) -> list[str]:
        lines = [*words, "", *_use_words(printer, steps, text), f"self-test{text.test}"]
        return c_comment(lines)

    return _written(printer, stem, head, calls_functions=steps.calls_functions)


class _Text(NamedTuple):
    """Lines of the head of a text: prototypes, use and self-test."""

    prototypes: tuple[str, ...]
    use: str
    test: str


def _written(
    printer: CPrinter,
    stem: str,
    head: Callable[[_Text], list[str]],
    *,
    calls_functions: bool,
    whole: bool = False,
) -> CText:
    """Return the files of a program."""
    form, prototypes = printer.form, printer.prototypes()
    include = f'#include "{stem}.h"'
    uses = {".h": include, ".c": f"{include}, link {stem}.c", LIBRARY: include}
    code = printer.code()
    if form == LIBRARY:
        test = f": {stem}.c {stem}_self_test.c, and call {printer.self_test}()"
    else:
        # Without -x gcc would precompile a header instead of compiling a program.
        source, library = quote(f"{stem}{form}"), " -lm" * calls_functions
        source = f"-x c {source}" if form == ".h" else source
        command = f"gcc -std=c99 -ffp-contract=off -D{SWITCH} {source} -o self_test{library}"
        test = f" (returns 0 if all is well): {command} && ./self_test"
    top = head(_Text(prototypes, uses[form], test))
    macros = _macros(printer)
    declared = [*macros, *([""] if macros else []), *printer.types]
    headers = _headers("\n".join([*declared, code, *prototypes]))
    opening = [*(f"#include <{name}>" for name in headers), *([""] if headers else [])]
    declarations = [f"{prototype};" for prototype in prototypes]
    if form == LIBRARY:
        tested = printer.test(f"int {printer.self_test}(void)")
        declarations.append(f"int {printer.self_test}(void); /* returns 0 if all is well */")
        remark = f"/* Values of the model, for a test of {stem}.c; linked where it is called. */"
        more = [f"#include <{name}>" for name in _headers("\n".join(tested))]
        files = {
            ".h": [*top, *_guarded(printer, [*opening, *declared, *_for_cxx(declarations)], whole)],
            ".c": [*top, include, "", *_flash_macro(printer, code), code],
            "_self_test.c": [remark, "", *more, "", include, "",
                             *_flash_macro(printer, "\n".join(tested)), *tested],
        }  # fmt: skip
    else:
        tested = printer.test("int main(void)")
        # Includes come before all else (MISRA C:2012, 20.1), those of the self-test too.
        more = [name for name in _headers("\n".join(tested)) if name not in headers]
        of_test = [f"#ifdef {SWITCH}", *(f"#include <{name}>" for name in more), "#endif", ""]
        of_test = of_test if more else []
        switched = [f"#ifdef {SWITCH}", "", *tested, "#endif", ""]
        if form == ".h":
            inside = [*of_test, *opening, *declared, code, *switched]
            files = {".h": [*top, *_guarded(printer, inside, whole)]}
        else:
            inside = [*opening, *declared, *_for_cxx(declarations)]
            files = {
                ".c": [*top, include, "", *of_test, code, *switched],
                ".h": [*top, *_guarded(printer, inside, whole)],
            }
    texts = {suffix: "\n".join(lines) for suffix, lines in files.items()}
    return CText(texts, printer, prototypes)


_HEADERS = {
    "math.h": re.compile(rf"\b(NAN|INFINITY|(?:{'|'.join(C_FUNCTIONS)})f?\()"),
    "stdbool.h": re.compile(r"\b(bool|true|false)\b"),
    "stddef.h": re.compile(r"\bNULL\b"),
    "stdint.h": re.compile(r"\bint\d+_t\b"),
}


def _headers(text: str) -> list[str]:
    """Return the standard headers for a text."""
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    return [name for name, words in _HEADERS.items() if words.search(code)]


def _macros(printer: CPrinter) -> list[str]:
    """Return the macros for a program that runs a controller."""
    steps, upper = printer.steps, printer.prefix.upper()
    if steps is None:
        return []
    period = c_number(steps.model.period, steps.precision.outside)
    lines = [f"#define {upper}_PERIOD {period} /* s */"]
    if steps.learned:
        cells = sum(len(table.values) for table in steps.learned.values())
        lines.append(f"#define {upper}_LEARNED_CELLS {cells}u /* of save and load */")
    return lines


def _flash_macro(printer: CPrinter, text: str) -> list[str]:
    """Return the lines that locate the constants, if any.

    An AVR has flash in a separate address space, from which gcc's C reads `__flash` constants by
    the instruction ``lpm``, as ``pgm_read_float`` does; elsewhere constants need no macro.
    """
    name = printer.in_flash.strip()
    if not re.search(rf"\b{name}\b", text):
        return []
    lines = ["#ifdef __FLASH /* AVR */", f"#define {name} __flash", "#else", f"#define {name}"]
    return [*lines, "#endif", ""]


def _for_cxx(declarations: Iterable[str]) -> list[str]:
    """Return declarations with C linkage for a C++ compiler."""
    return [
        "#ifdef __cplusplus", 'extern "C" {', "#endif", "", *declarations, "",
        "#ifdef __cplusplus", "}", "#endif", "",
    ]  # fmt: skip


def _guarded(printer: CPrinter, lines: Sequence[str], whole: bool) -> list[str]:
    """Return the lines of a header with an include guard.

    Unless all its numbers are whole, it refuses a compiler that assumes no NaN.

    The guard depends on the content: two headers of one name do not hide each other.
    """
    digest = hashlib.sha256("\n".join(lines).encode()).hexdigest()[:8].upper()
    guard = printer.names.new(f"{printer.prefix.upper()}_{digest}_H")
    needs = () if whole else _NAN_NEEDED
    return [f"#ifndef {guard}", f"#define {guard}", "", *needs, *lines, "#endif", ""]


# gcc and clang set the first with -ffast-math, the second with -ffinite-math-only as well.
_NAN_NEEDED = (
    "#ifdef __FAST_MATH__",
    '#error "compile without -ffast-math: this code compares with NaN"',
    "#elif defined(__FINITE_MATH_ONLY__)",
    "#if __FINITE_MATH_ONLY__",
    '#error "compile without -ffinite-math-only: this code compares with NaN"',
    "#endif",
    "#endif",
    "",
)


def _use_words(printer: CPrinter, steps: Steps, text: _Text) -> list[str]:
    prefix = printer.prefix
    step = f"{prefix}_{step_name(guarded=printer.program.guard is not None)}"
    lines = [f"{prototype};" for prototype in text.prototypes]
    lines += [
        f"constants (flash): {printer.flash} bytes, besides the code",
        f"state (RAM): about {printer.ram()} bytes; nothing is allocated, nothing is static",
        f"use: {text.use}",
        f"call {prefix}_init once, {step} every {number_text(steps.model.period)} s;"
        f" gains are s.gains, which {prefix}_init sets",
    ]
    if steps.needs_last:
        lines.append(
            f"a set point lasts {steps.model.every} periods, counted from init; "
            "where the next one comes off that count, set s.until_set_point = 1 before the last"
            " step of the present one"
        )
    if steps.learned:
        lines.append(
            f"tables that learn are part of the state: {prefix}_save copies their values and visits"
            f" out ({prefix.upper()}_LEARNED_CELLS numbers each, axis by axis), {prefix}_load"
            " copies them in, after init; visits may be a null pointer"
        )
    return lines
