"""Exported C, compiled and run by the points of its self-test: results, coverage, sizes."""

from __future__ import annotations

import gzip
import json
import math
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.base.jsonable import entry, json_properties
from fuzzyarm.exchange.export import Exported, ExportedController
from fuzzyarm.exchange.export.avr import run_tool
from fuzzyarm.exchange.export.numbers import ExportError, c_number
from fuzzyarm.exchange.export.steps import Steps
from fuzzyarm.symbolic.identifiers import identifier

_SECONDS = 300
# Not optimised, so that gcov counts the lines of the text.
_FLAGS = ("-std=c99", "-ffp-contract=off", "-O0", "--coverage")
_SMALL = ("-std=c99", "-Os", "-ffunction-sections", "-fdata-sections")

TARGETS = {
    "ATmega328P": ("avr-gcc", "avr-size", ("-mmcu=atmega328p",)),
    "Cortex-M3": ("arm-none-eabi-gcc", "arm-none-eabi-size", ("-mcpu=cortex-m3", "-mthumb")),
}
"""Processors with the compilers used, where installed: compiler, size, flags."""


@json_properties("* passed")
@dataclass(frozen=True)
class TrialRow:
    """One point, or one period."""

    function: str = entry("which is called")
    inputs: tuple[float, ...] = entry("that go in; null where it is not a number")
    expected: tuple[float, ...] = entry("of the model; null where it is not a number")
    computed: tuple[float, ...] = entry("by the C; null where it is not a number")
    tolerance: float = entry("of a difference")

    @property
    def passed(self) -> bool:
        """Whether every result is near enough."""
        return all(
            # Equality first: the difference of two infinite values is a NaN.
            a == b or abs(a - b) <= self.tolerance or (math.isnan(a) and math.isnan(b))
            for a, b in zip(self.expected, self.computed, strict=True)
        )


@json_properties("*")
class TextLine(NamedTuple):
    """A line of a text.

    Attributes
    ----------
    line : int
        Its number.
    text : str
        Its words.
    """

    line: int
    text: str


@dataclass(frozen=True)
class ExportTrial:
    """A run of the exported functions by all rows, and which of their text it reached."""

    compiler: str = entry("and its version")
    flags: tuple[str, ...] = entry("of it")
    rows: tuple[TrialRow, ...] = entry("in order")
    statements: tuple[int, int] = entry("reached, and in all")
    branches: tuple[int, int] = entry("taken, and in all")
    missed: tuple[TextLine, ...] = entry("that no point reaches")
    untaken: tuple[TextLine, ...] = entry("with a branch that no point takes")

    @property
    def passed(self) -> bool:
        """Whether every point does."""
        return all(row.passed for row in self.rows)


@dataclass(frozen=True)
class ExportSize:
    """Bytes of the functions alone."""

    processor: str = entry("for which")
    compiler: str = entry("and its version")
    flags: tuple[str, ...] = entry("of it")
    flash: int = entry("bytes")
    ram: int = entry("bytes of static variables")


def tried(exported: Exported | ExportedController) -> ExportTrial:
    """Compile an export with gcc, run it at its points, and read the counts of gcov."""
    for program in ("gcc", "gcov"):
        if shutil.which(program) is None:
            raise ExportError(f"a report needs {program}, which is not here", hint="install gcc")
    files = {path.name: str(text) for path, text in exported.files}
    source = next(name for name in files if name.endswith(".c"))
    stem = source.removesuffix(".c")
    if isinstance(exported, Exported):
        cases, driver = _points(exported, stem)
    else:
        cases, driver = _periods(exported, stem)
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as name:
        folder = Path(name)
        for file, text in {**files, "driver.c": driver}.items():
            (folder / file).write_text(text, "utf-8")
        _run(["gcc", *_FLAGS, "-c", source, "-o", "own.o"], folder)
        _run(["gcc", "-std=c99", "driver.c", "own.o", "--coverage", "-o", "driver", "-lm"], folder)
        values = iter(_run(["./driver"], folder).split())
        rows = tuple(
            TrialRow(
                function, inputs, expected, tuple(_read(next(values)) for _ in expected), tolerance
            )
            for function, inputs, expected, tolerance in cases
        )
        counted = _counted(folder, source)
        compiler = _run(["gcc", "--version"], folder).splitlines()[0]
    return ExportTrial(compiler, _FLAGS, rows, *_coverage(counted, files[source]))


Case = tuple[str, tuple[float, ...], tuple[float, ...], float]
"""Function, inputs, expected outputs and tolerance."""


def _points(exported: Exported, stem: str) -> tuple[list[Case], str]:
    """Return the points of all routines, and the program that prints the results."""
    cases: list[Case] = []
    lines: list[str] = []
    for routine, call in zip(exported.routines, exported.calls, strict=True):
        function = call.partition("(")[0].split()[-1]
        vectors = routine.vectors()
        whole = np.issubdtype(routine.kind, np.integer)
        # In hexadecimal a float loses no bit on its way.
        show = 'printf("%ld\\n", (long)' if whole else 'printf("%a\\n", (double)'
        for row in zip(*(c.tolist() for c in (*vectors.inputs, vectors.expected)), strict=True):
            arguments = ", ".join(c_number(x, routine.kind) for x in row[:-1])
            lines.append(f"    {show}{function}({arguments}));")
            cases.append((function, row[:-1], row[-1:], vectors.tolerance))
    return cases, _program(stem, lines)


def _periods(exported: ExportedController, stem: str) -> tuple[list[Case], str]:
    """Return the sequence of periods, and the program that prints the drives."""
    program = exported.program
    steps, vectors = program.steps, program.tried.vectors
    step = exported.calls[1].partition("(")[0].split()[-1]
    prefix, kind = step.removesuffix("_step"), steps.precision.outside
    inputs = [*steps.of_sort("reference"), *steps.of_sort("measured")]
    structs = {
        sort: name
        for sort, name in (
            ("reference", "reference"),
            ("measured", "measured"),
            ("drive", "drives"),
        )
        if steps.of_sort(sort)
    }
    lines = [f"    static {prefix}_state s;"]
    lines += [f"    {prefix}_{name} {sort};" for sort, name in structs.items()]
    lines.append(f"    {prefix}_init(&s);")
    arguments = ", ".join(["&s", *(f"&{sort}" for sort in structs)])
    cases: list[Case] = []
    for row, expected in zip(vectors.inputs, vectors.expected, strict=True):
        for port, x in zip(inputs, row, strict=True):
            text = "NAN" if math.isnan(x) else c_number(x, kind)
            lines.append(f"    {port.sort}.{_member(steps, port)} = {text};")
        lines.append(f"    {step}({arguments});")
        lines += [
            f'    printf("%a\\n", (double)drive.{_member(steps, drive)});'
            for drive in steps.of_sort("drive")
        ]
        cases.append((step, tuple(row), tuple(expected), vectors.tolerance))
    return cases, _program(stem, lines)


def _member(steps: Steps, port: Any) -> str:
    return ".".join(identifier(part) for part in steps.port_name(port).split("."))


def _program(stem: str, lines: Sequence[str]) -> str:
    head = ["#include <math.h>", "#include <stdio.h>", f'#include "{stem}.h"', ""]
    return "\n".join([*head, "int main(void)", "{", *lines, "    return 0;", "}", ""])


def _read(text: str) -> float:
    return float.fromhex(text) if "x" in text else float(text)


def _counted(folder: Path, source: str) -> Mapping[str, Any]:
    """Return gcov's report about a source."""
    _run(["gcov", "--branch-probabilities", "--json-format", "own.o"], folder)
    (packed,) = folder.glob("*own*.gcov.json.gz")
    with gzip.open(packed, "rt", encoding="utf-8") as file:
        data = json.load(file)
    entry: Mapping[str, Any] = next(f for f in data["files"] if f["file"].endswith(source))
    return entry


_Lines = tuple[TextLine, ...]


def _coverage(
    counted: Mapping[str, Any], text: str
) -> tuple[tuple[int, int], tuple[int, int], _Lines, _Lines]:
    lines = counted["lines"]
    branches = [branch for line in lines for branch in line["branches"]]
    source_lines = text.split("\n")

    def listed(numbers: set[int]) -> _Lines:
        return tuple(
            TextLine(number, source_lines[number - 1].strip()) for number in sorted(numbers)
        )

    uncovered = {line["line_number"] for line in lines if not line["count"]}
    untaken = {
        line["line_number"]
        for line in lines
        if not all(branch["count"] for branch in line["branches"])
    }
    return (
        (sum(bool(line["count"]) for line in lines), len(lines)),
        (sum(bool(branch["count"]) for branch in branches), len(branches)),
        listed(uncovered),
        listed(untaken - uncovered),
    )


def sizes(exported: Exported | ExportedController) -> list[ExportSize]:
    """Return flash and RAM of the exported functions alone, by the installed compilers."""
    results = []
    files = {path.name: str(text) for path, text in exported.files}
    source = next(name for name in files if name.endswith(".c"))
    for processor, (compiler, size, flags) in TARGETS.items():
        if shutil.which(compiler) is None or shutil.which(size) is None:
            continue
        with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as name:
            folder = Path(name)
            for file, text in files.items():
                (folder / file).write_text(text, "utf-8")
            _run([compiler, *flags, *_SMALL, "-c", source, "-o", "own.o"], folder)
            numbers = _run([size, "own.o"], folder).splitlines()[1].split()[:3]
            version = _run([compiler, "--version"], folder).splitlines()[0]
        text_bytes, data, bss = map(int, numbers)
        flash, ram = text_bytes + data, data + bss
        results.append(ExportSize(processor, version, (*flags, *_SMALL), flash, ram))
    return results


def _run(words: Sequence[str], folder: Path) -> str:
    """Run a program and return its output."""
    return run_tool(words, folder, _SECONDS).stdout
