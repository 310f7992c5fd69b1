"""A C file around routines: guard, head, constants, functions and the self-test."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fuzzyarm.export.names import Names, identifier
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
    test = f"-x c {file} -o self_test"
    head = _head(writer, routines, prototypes, f'#include "{file}"', test)
    inside = [*_includes(routines), code, *_self_test(writer, routines, prototypes)]
    return "\n".join([*head, *_guarded(writer, inside)]), prototypes


def c_pair(routines: Sequence[Routine], prefix: str, stem: str) -> tuple[str, str, list[Prototype]]:
    """Return a header, the ``.c`` file with everything but prototypes, and the prototypes."""
    writer = CWriter(prefix)
    prototypes, code = _definitions(writer, routines)
    include = f'#include "{stem}.h"'
    head = _head(
        writer, routines, prototypes, f"{include}, link {stem}.c", f"{stem}.c -o self_test"
    )
    declared = [
        *_includes(routines),
        "#ifdef __cplusplus",
        'extern "C" {',
        "#endif",
        "",
        *(f"{prototype};" for prototype in prototypes),
        "",
        "#ifdef __cplusplus",
        "}",
        "#endif",
        "",
    ]
    header = [*head, *_guarded(writer, declared)]
    source = [*head, include, "", code, *_self_test(writer, routines, prototypes)]
    return "\n".join(header), "\n".join(source), prototypes


def _guarded(writer: CWriter, lines: Sequence[str]) -> list[str]:
    """Return the lines of a header so that it may be included twice."""
    guard = writer.names.new(f"{writer.prefix.upper()}_H")
    return [f"#ifndef {guard}", f"#define {guard}", "", *lines, "#endif", ""]


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
    names = Names()
    parameters = tuple(names.new(argument.name) for argument in routine.arguments)
    return Prototype(name, C_TYPES[routine.kind], parameters)


def _includes(routines: Sequence[Routine]) -> list[str]:
    found = {f"#include <{name}>" for routine in routines for name in routine_headers(routine)}
    return [*sorted(found), ""] if found else []


def routine_headers(routine: Routine) -> list[str]:
    """Return the standard headers that a routine needs."""
    return ["stdint.h"] if _whole(routine) else list(getattr(routine, "headers", ()))


def _definitions(writer: CWriter, routines: Sequence[Routine]) -> tuple[list[Prototype], str]:
    """Return prototypes, and the constants, helpers and functions as text."""
    prototypes = [_prototype(writer, routine) for routine in routines]
    functions = []
    for routine, prototype in zip(routines, prototypes, strict=True):
        body = routine.body(writer, prototype.parameters)
        lines = [f"    {line}" if line else "" for line in body]
        functions.append("\n".join([f"{writer.storage}{prototype}", "{", *lines, "}", ""]))
    return prototypes, "\n".join([*writer.constants, *writer.helpers, *functions])


def _self_test(
    writer: CWriter, routines: Sequence[Routine], prototypes: Sequence[Prototype]
) -> list[str]:
    lines = [f"#ifdef {SWITCH}", "", "/* Returns 0 if the functions give what the model gives. */"]
    lines += ["int main(void)", "{"]
    calls = []
    for number, (routine, prototype) in enumerate(zip(routines, prototypes, strict=True)):
        vectors = routine.vectors()
        columns = [*vectors.inputs, vectors.expected]
        array = f"vectors_{number}"
        count = len(vectors.expected)
        if count == 0:  # no rule fires anywhere
            continue
        rows = [_literal(routine, x) for row in zip(*columns, strict=True) for x in row]
        lines.append(
            f"    static const {C_TYPES[routine.kind]} {array}[{count}][{len(columns)}] = {{"
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
        wide, cast = ("long", "(long)") if whole else (C_TYPES[routine.kind], "")
        given = ", ".join(f"{array}[k][{i}]" for i in range(len(columns) - 1))
        tolerance = "0" if whole else _literal(routine, vectors.tolerance)
        calls += [
            f"    for (k = 0u; k < {count}u; k++) {{",
            f"        const {wide} difference = {cast}{prototype.name}({given})",
            f"            - {cast}{array}[k][{len(columns) - 1}];",
            f"        if (!(difference <= {tolerance} && difference >= -{tolerance})) {{",
            "            return 1;",
            "        }",
            "    }",
        ]
    counter = ["    unsigned k;"] if calls else []
    return [*lines, *counter, *calls, "    return 0;", "}", "", "#endif", ""]


def _whole(routine: Routine) -> bool:
    return issubclass(routine.kind, np.integer)


def _literal(routine: Routine, value: float) -> str:
    return "NAN" if math.isnan(value) else c_number(value, routine.kind)
