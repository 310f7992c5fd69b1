"""A C file around routines: guard, head, constants, functions and the self-test."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from fuzzyarm.export.names import ARDUINO_MACROS, identifier
from fuzzyarm.export.numbers import C_TYPES, c_number
from fuzzyarm.export.routine import (
    CWriter,
    Routine,
    calls_functions,
    head_lines,
    number_lines,
)

SWITCH = "FUZZYARM_SELF_TEST"
"""The macro that adds a ``main`` to an exported file."""


@dataclass(frozen=True, slots=True)
class Prototype:
    """A function of the file with the names of its parameters."""

    name: str
    kind: str
    parameters: tuple[str, ...]

    def __str__(self) -> str:
        listed = ", ".join(f"{self.kind} {parameter}" for parameter in self.parameters)
        return f"{self.kind} {self.name}({listed})"


def c_header(routines: Sequence[Routine], prefix: str, file: str) -> tuple[str, list[Prototype]]:
    """Return a header on its own, with ``static inline`` functions, and its prototypes."""
    writer = CWriter(prefix, "static inline ")
    prototypes, code = _definitions(writer, routines)
    # Without -x gcc would precompile a header rather than compile it as a program.
    test = f"-x c {file} -o self_test"
    head = _head(writer, routines, prototypes, f'#include "{file}"', test)
    inside = [*_includes(routines), code, *_self_test(writer, routines, prototypes)]
    return "\n".join([*head, *guarded(writer, inside, whole=_all_whole(routines))]), prototypes


def c_pair(routines: Sequence[Routine], prefix: str, stem: str) -> tuple[str, str, list[Prototype]]:
    """Return a header, the ``.c`` file with everything but prototypes, and the prototypes."""
    writer = CWriter(prefix)
    prototypes, code = _definitions(writer, routines)
    include = f'#include "{stem}.h"'
    head = _head(
        writer, routines, prototypes, f"{include}, link {stem}.c", f"{stem}.c -o self_test"
    )
    declarations = for_cxx(f"{prototype};" for prototype in prototypes)
    inside = [*_includes(routines), *declarations]
    header = [*head, *guarded(writer, inside, whole=_all_whole(routines))]
    source = [*head, include, "", code, *_self_test(writer, routines, prototypes)]
    return "\n".join(header), "\n".join(source), prototypes


@dataclass(frozen=True)
class CLibrary:
    """A C library of three files, whose constants stay in flash.

    Attributes
    ----------
    header, source, test : str
        The texts; ``test`` defines the function `self_test`.
    writer : CWriter
        Of the source.
    prototypes : tuple of str
        Of the functions of the source.
    self_test : str
        The function that returns 0 where all is well.
    """

    header: str
    source: str
    test: str
    writer: CWriter
    prototypes: tuple[str, ...]
    self_test: str


def library_writer(prefix: str) -> CWriter:
    """Return the writer of a library whose constants stay in flash."""
    return CWriter(prefix, in_flash=f"{prefix.upper()}_IN_FLASH ", refused=ARDUINO_MACROS)


def library_file(
    writer: CWriter, head: Sequence[str], stem: str, body: Sequence[str], *, flash: bool = True
) -> str:
    """Return a ``.c`` file of a library: head, include, where its constants are, and its body."""
    macro = flash_macro(writer) if flash else []
    return "\n".join([*head, f'#include "{stem}.h"', "", *macro, *body])


def flash_macro(writer: CWriter) -> list[str]:
    """Return the lines that say where constants are.

    An AVR has flash in an address space of its own, where gcc's C reads what is `__flash`
    by the instruction ``lpm``, as ``pgm_read_float`` does; elsewhere a constant just stays there.
    """
    name = writer.in_flash.strip()
    lines = ["#ifdef __FLASH /* AVR */", f"#define {name} __flash", "#else", f"#define {name}"]
    return [*lines, "#endif", ""]


def c_library(routines: Sequence[Routine], prefix: str, stem: str) -> CLibrary:
    """Return routines as a library of three files."""
    writer = library_writer(prefix)
    name = writer.names.new(f"{prefix}_self_test")
    prototypes, code = _definitions(writer, routines)
    test = f"{stem}.c {stem}_self_test.c, and call {name}()"
    head = head_lines(routines, prototypes, writer, f'#include "{stem}.h"', test)
    prototypes_of_c = [f"{prototype};" for prototype in prototypes]
    declarations = for_cxx([*prototypes_of_c, f"int {name}(void); /* returns 0 if all is well */"])
    inside = [*_includes(routines), *declarations]
    header = "\n".join([*head, *guarded(writer, inside, whole=_all_whole(routines))])
    source = library_file(writer, head, stem, [code], flash=bool(writer.constants))
    body = test_function(
        f"int {name}(void)", _test_lines(routines, prototypes, writer.in_flash), "functions"
    )
    rows = any(len(routine.vectors().expected) for routine in routines)
    test_text = library_file(writer, _test_head(stem), stem, body, flash=rows)
    return CLibrary(header, source, test_text, writer, tuple(map(str, prototypes)), name)


def _test_head(stem: str) -> list[str]:
    return [
        f"/* Values of the model, for a test of {stem}.c; not linked unless it is called. */",
        "",
    ]


def for_cxx(declarations: Iterable[str]) -> list[str]:
    """Return declarations that a C++ compiler takes as those of C."""
    return [
        "#ifdef __cplusplus",
        'extern "C" {',
        "#endif",
        "",
        *declarations,
        "",
        "#ifdef __cplusplus",
        "}",
        "#endif",
        "",
    ]


def guarded(writer: CWriter, lines: Sequence[str], *, whole: bool = False) -> list[str]:
    """Return the lines of a header so that it may be included twice.

    Unless all its numbers are whole, a compiler for which nothing is NaN refuses it.

    The guard is of the content: of two headers under one name neither hides the other.
    """
    digest = hashlib.sha256("\n".join(lines).encode()).hexdigest()[:8].upper()
    guard = writer.names.new(f"{writer.prefix.upper()}_{digest}_H")
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


def _head(
    writer: CWriter,
    routines: Sequence[Routine],
    prototypes: Sequence[Prototype],
    use: str,
    test: str,
) -> list[str]:
    library = " -lm" if any(map(calls_functions, routines)) else ""
    command = f"gcc -std=c99 -D{SWITCH} {test}{library} && ./self_test"
    return head_lines(routines, prototypes, writer, use, command)


def _prototype(writer: CWriter, routine: Routine) -> Prototype:
    name = writer.names.new(f"{writer.prefix}_{identifier(routine.output.name)}")
    names = writer.scope()
    parameters = tuple(names.new(argument.name) for argument in routine.arguments)
    return Prototype(name, C_TYPES[routine.kind], parameters)


def _includes(routines: Sequence[Routine]) -> list[str]:
    includes = {f"#include <{name}>" for routine in routines for name in routine_headers(routine)}
    return [*sorted(includes), ""] if includes else []


def _all_whole(routines: Sequence[Routine]) -> bool:
    return all(map(_whole, routines))


def routine_headers(routine: Routine) -> list[str]:
    """Return the standard headers that a routine needs."""
    return ["stdint.h"] if _whole(routine) else list(getattr(routine, "headers", ()))


def _definitions(writer: CWriter, routines: Sequence[Routine]) -> tuple[list[Prototype], str]:
    """Return prototypes, and the constants, helpers and functions as text."""
    # Public functions first: of two equal names the later one gets a number, which must be that of
    # a helper.
    prototypes = [_prototype(writer, routine) for routine in routines]
    functions = []
    for routine, prototype in zip(routines, prototypes, strict=True):
        body = routine.body(writer, prototype.parameters)
        lines = [f"    {line}" if line else "" for line in body]
        functions.append("\n".join([f"{writer.storage}{prototype}", "{", *lines, "}", ""]))
    return prototypes, writer.assembled(functions)


def _self_test(
    writer: CWriter, routines: Sequence[Routine], prototypes: Sequence[Prototype]
) -> list[str]:
    body = test_function("int main(void)", _test_lines(routines, prototypes), "functions")
    return [f"#ifdef {SWITCH}", "", *body, "#endif", ""]


def test_function(prototype: str, body: Sequence[str], tested: str) -> list[str]:
    """Return the lines of the function that tests a file."""
    remark = f"/* Returns 0 if the {tested} agree with the model. */"
    return [remark, prototype, "{", "    int failed = 0;", *body, "    return failed;", "}", ""]


def _test_lines(
    routines: Sequence[Routine], prototypes: Sequence[Prototype], in_flash: str = ""
) -> list[str]:
    lines: list[str] = []
    calls: list[str] = []
    for number, (routine, prototype) in enumerate(zip(routines, prototypes, strict=True)):
        vectors = routine.vectors()
        columns = [*vectors.inputs, vectors.expected]
        array = f"vectors_{number}"
        count = len(vectors.expected)
        if count == 0:  # no rule fires anywhere
            continue
        rows = [_literal(routine, x) for row in zip(*columns, strict=True) for x in row]
        lines.append(
            f"    static const {in_flash}{C_TYPES[routine.kind]}"
            f" {array}[{count}][{len(columns)}] = {{"
        )
        body = number_lines(rows, columns=len(columns), indent="        ")
        if len(body) == count:
            body = [f"        {{{line.strip().removesuffix(',')}}}," for line in body]
            body[-1] = body[-1].removesuffix(",")
        else:  # long rows: one brace for each
            body = [
                "        {" + ", ".join(rows[i : i + len(columns)]) + "},"
                for i in range(0, len(rows), len(columns))
            ]
        lines += [*body, "    };"]
        whole = _whole(routine)
        # An int of an AVR has 16 bits, in which the difference of two int16_t may overflow.
        wide, cast = ("long", "(long)") if whole else (C_TYPES[routine.kind], "")
        arguments = ", ".join(f"{array}[k][{i}]" for i in range(len(columns) - 1))
        tolerance = "0" if whole else _literal(routine, vectors.tolerance)
        # The condition is negated so that a difference that is NaN fails, too.
        calls += [
            f"    for (k = 0u; k < {count}u; k++) {{",
            f"        const {wide} difference = {cast}{prototype.name}({arguments})",
            f"            - {cast}{array}[k][{len(columns) - 1}];",
            f"        if (!((difference <= {tolerance}) && (difference >= -{tolerance}))) {{",
            "            failed = 1;",
            "        }",
            "    }",
        ]
    counter = ["    unsigned k;"] if calls else []
    return [*lines, *counter, *calls]


def _whole(routine: Routine) -> bool:
    return issubclass(routine.kind, np.integer)


def _literal(routine: Routine, value: float) -> str:
    return "NAN" if math.isnan(value) else c_number(value, routine.kind)
