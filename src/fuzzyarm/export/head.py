"""The comment at the head of an exported file: what it is, whence, how good and how dear."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from fuzzyarm import __version__
from fuzzyarm.export.c_writer import CWriter
from fuzzyarm.export.routine import Argument, Routine
from fuzzyarm.lut.numbers import number

_WIDTH = 96


def head_lines(
    routines: Sequence[Routine], prototypes: Sequence[Any], writer: CWriter, use: str, test: str
) -> list[str]:
    """Return the comment of a C file as lines, an empty one last."""
    lines = [f"made by fuzzyarm {__version__}; do not edit: make it again from its source", ""]
    for routine, prototype in zip(routines, prototypes, strict=True):
        lines += [str(prototype), *_indented(routine_words(routine)), ""]
    lines += [
        f"constants (flash): {writer.flash} bytes, besides the code",
        "static RAM: 0 bytes; nothing is allocated, no function of a library is called",
        "",
        f"use: {use}",
        f"self-test (returns 0 if all is well): {test}",
    ]
    return [*comment(lines, "/*", " *", " */"), ""]


def routine_words(routine: Routine, *, names: Sequence[str] = ()) -> list[str]:
    """Return what is said of one routine: arguments, remarks, error, cost, origin."""
    cost, accuracy = routine.cost(), routine.accuracy()
    lines = [_argument(argument) for argument in routine.arguments]
    lines.append(f"result {_argument(routine.output)}")
    lines += routine.remarks()
    lines.append(
        f"worst error against {accuracy.against}: {accuracy.worst:.3g}, in units of the output"
        f" ({accuracy.points:,} points, every edge among them)"
    )
    lines.append(f"operations per call, at most: {cost.in_words()}")
    lines.append(f"local variables (stack): about {cost.stack} bytes")
    lines += [f"{key}: {text}" for key, text in routine.provenance()]
    return lines


def _argument(argument: Argument) -> str:
    words = f"{argument.name}: {number(argument.low)} .. {number(argument.high)}"
    if argument.description:
        words += f", {argument.description}"
    return f"{words}; quantity = {argument.scaling}" if argument.scaling else words


def _indented(lines: Sequence[str]) -> list[str]:
    return [f"  {line}" for line in lines]


def comment(lines: Sequence[str], first: str, every: str, last: str) -> list[str]:
    """Return lines as a block comment; nothing in them can end it or start another."""
    body = []
    for line in lines:
        clean = plain(line)
        indent = " " * (len(clean) - len(clean.lstrip()) + 2)
        wrapped = textwrap.wrap(
            clean, _WIDTH - len(every), subsequent_indent=indent, break_on_hyphens=False
        )
        body += [f"{every} {part}" for part in wrapped] or [every]
    opening = f"{first}{body[0].removeprefix(every)}" if body else first
    return [opening, *body[1:], last]


def plain(text: str) -> str:
    """Return `text` on one line, harmless in a comment of C or of Structured Text."""
    shown = "".join(letter if letter.isprintable() else " " for letter in text)
    for mark in ("*/", "/*", "(*", "*)", "??"):
        while mark in shown:
            shown = shown.replace(mark, f"{mark[0]} {mark[1]}")
    return shown.replace("\\", "/") if shown.endswith("\\") else shown
