"""Routines as the writer of a file sees them, and the header of the file.

A routine is one function of the exported file; the header comment states provenance, accuracy and
cost of each.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from numpy.typing import NDArray

from fuzzyarm.base.numbers import number_text, outward_text
from fuzzyarm.exchange.export.numbers import Kind
from fuzzyarm.version import __version__

MADE = f"made by fuzzyarm {__version__}; do not edit: make it again from its source"
"""The first line of an exported file."""

WIDTH = 96
"""Longest line of a list of numbers."""


def number_lines(literals: Sequence[str], columns: int = 0, indent: str = "    ") -> list[str]:
    """Return literals as lines, `columns` to a line if they fit, right-aligned."""
    width = max(map(len, literals))
    fitting = max(1, (WIDTH - len(indent)) // (width + 2))
    per_line = columns if 0 < columns <= fitting else fitting
    if 0 < fitting < columns:  # equal parts of a row, so that rows stay visible
        parts = -(-columns // fitting)
        per_line = -(-columns // parts)
    rows = (
        [literals[i : i + columns] for i in range(0, len(literals), columns)]
        if columns
        else [literals]
    )
    parts_of_rows = [row[i : i + per_line] for row in rows for i in range(0, len(row), per_line)]
    lines = [indent + ", ".join(x.rjust(width) for x in part) + "," for part in parts_of_rows]
    lines[-1] = lines[-1].removesuffix(",")
    return lines


# --- A routine as the writer of a file sees it ---


@dataclass(frozen=True, slots=True)
class RoutineArgument:
    """An argument or a result: its name in the model and its meaning."""

    name: str
    low: float
    high: float
    description: str = ""
    scaling: str = ""
    holds: bool = False  # the value to hold if no rule fires


@dataclass(frozen=True, slots=True)
class CallCost:
    """Upper bounds of the cost of a call."""

    operations: tuple[tuple[str, int], ...]  # kind of operation and its number
    stack: int  # bytes of local variables, without the compiler's own
    unbounded: str = ""  # the defuzzifier whose loops are not counted

    def by_sort(self) -> dict[str, int | None]:
        """Return the most operations of each kind; None if unbounded."""
        return {**dict(self.operations), **({self.unbounded: None} if self.unbounded else {})}

    def in_words(self) -> str:
        """Return the operations as text."""
        parts = [
            f"{count} {kind if count > 1 else kind.replace('s and ', ' or ').replace('ns', 'n')}"
            for kind, count in self.operations
            if count
        ]
        if self.unbounded:
            parts.append(f"and those of {self.unbounded}, not bounded")
        return ", ".join(parts) or "none"


@dataclass(frozen=True, slots=True)
class Accuracy:
    """The difference between a routine and its model in double precision."""

    worst: float  # largest absolute difference, in units of the output
    points: int  # number of compared points
    against: str  # the model of the comparison


@dataclass(frozen=True, eq=False)
class TestPoints:
    """Points for a self-test: the inputs, one array for each, and the expected results."""

    inputs: tuple[NDArray[Any], ...]
    expected: NDArray[Any]
    tolerance: float


class Routine(Protocol):
    """A function to be exported, with the Python model of its arithmetic."""

    @property
    def output(self) -> RoutineArgument:
        """The result."""

    @property
    def arguments(self) -> Sequence[RoutineArgument]:
        """The arguments, in order."""

    @property
    def kind(self) -> Kind:
        """The type of arguments and result."""

    def evaluate(self, *inputs: Any) -> NDArray[Any]:
        """Return the function's result, bit for bit."""

    def cost(self) -> CallCost:
        """Return the cost of one call."""

    def remarks(self) -> list[str]:
        """Return the header comment's lines on index order, borders and arithmetic."""

    def provenance(self) -> Sequence[tuple[str, str]]:
        """Return its provenance, as pairs of key and text."""

    @property
    def accuracy(self) -> Accuracy:
        """The difference to the model in double precision over a dense grid."""

    def vectors(self) -> TestPoints:
        """Return points for the self-test."""


# --- Header comment of an exported file: provenance, accuracy, cost ---


def head_lines(
    routines: Sequence[Routine], prototypes: Sequence[str], flash: int, use: str, test: str
) -> list[str]:
    """Return the comment of a C file as lines, an empty one last."""
    lines = [MADE, ""]
    for routine, prototype in zip(routines, prototypes, strict=True):
        lines += [prototype, *_indented(routine_words(routine)), ""]
    lines += [
        f"constants (flash): {flash} bytes, besides the code",
        f"static RAM: 0 bytes; nothing is allocated, {_library_words(routines)}",
        "",
        f"use: {use}",
        f"self-test{test}",
    ]
    return c_comment(lines)


def calls_functions(routine: Routine) -> bool:
    """Return whether a routine calls functions of the mathematical library."""
    return bool(getattr(routine, "calls_functions", False))


def _library_words(routines: Sequence[Routine]) -> str:
    if any(map(calls_functions, routines)):
        return "functions of math.h are called, whose last bits may differ between machines"
    return "no function of a library is called"


def routine_words(routine: Routine) -> list[str]:
    """Return the description of a routine: arguments, remarks, error, cost, origin."""
    cost, accuracy = routine.cost(), routine.accuracy
    lines = [_argument(argument) for argument in routine.arguments]
    lines.append(f"result {_argument(routine.output)}")
    lines += routine.remarks()
    lines.append(
        f"worst error against {accuracy.against}: {accuracy.worst:.3g}, in units of the output"
        f" ({accuracy.points:,} points, every edge among them)"
    )
    proved = proved_words(routine)
    if proved:
        lines.append(f"worst error {proved}, in units of the output")
    lines.append(f"operations per call, at most: {cost.in_words()}")
    lines.append(f"local variables (stack): about {cost.stack} bytes")
    lines += [f"{key}: {text}" for key, text in routine.provenance()]
    return lines


def proved_words(routine: Routine) -> str:
    """Return the proved worst error against the rules; empty if unknown."""
    worst_proved = getattr(routine, "worst_proved", None)
    worst = worst_proved() if worst_proved is not None else None
    if worst is None:
        return ""
    text = outward_text(worst, up=True, digits=6)
    return f"against the rules of {routine.output.name}: {text} (proved, rounding included)"


def _argument(argument: RoutineArgument) -> str:
    words = f"{argument.name}: {number_text(argument.low)} .. {number_text(argument.high)}"
    if argument.description:
        words += f", {argument.description}"
    return f"{words}; quantity = {argument.scaling}" if argument.scaling else words


def _indented(lines: Sequence[str]) -> list[str]:
    return [f"  {line}" for line in lines]


def wrapped(lines: Sequence[str]) -> list[str]:
    """Return lines as those of a block comment; nothing in them can end it or start another."""
    body = []
    for line in lines:
        clean = plain(line)
        indent = " " * (len(clean) - len(clean.lstrip()) + 2)
        body += textwrap.wrap(
            clean, WIDTH - 2, subsequent_indent=indent, break_on_hyphens=False
        ) or [""]  # fmt: skip
    return body


def comment(body: Sequence[str], first: str, last: str) -> list[str]:
    """Return wrapped lines between the marks of a block comment."""
    head, *rest = body
    return [f"{first} {head}", *(f" * {line}".rstrip() for line in rest), f" {last}"]


def c_comment(lines: Sequence[str]) -> list[str]:
    """Return the comment at the head of a C file, and an empty line."""
    return [*comment(wrapped(lines), "/*", "*/"), ""]


def plain(text: str) -> str:
    """Return foreign text on one line, harmless in a comment of every language here."""
    printable = "".join(letter if letter.isprintable() else " " for letter in text)
    for mark in ("*/", "/*", "(*", "*)", "??"):
        while mark in printable:
            printable = printable.replace(mark, f"{mark[0]} {mark[1]}")
    return printable.replace("\\", "/") if printable.endswith("\\") else printable
