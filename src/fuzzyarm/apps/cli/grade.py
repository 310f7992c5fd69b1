"""Grade students' rule bases: ``fuzzyarm grade``."""

from __future__ import annotations

import argparse
import csv
import io
from collections.abc import Sequence

from fuzzyarm.apps.cli.command import (
    announced,
    argument,
    command,
    flag,
    print_json,
    say,
    write_text,
)
from fuzzyarm.apps.grading import Assignment, Grade, grade, read_assignment
from fuzzyarm.base.columns import in_columns
from fuzzyarm.base.numbers import counted

_GRADE = """Grade students' rule bases.

DIR has `hidden.frb` with expect and prove lines (each may end in `# 2 points: description`),
`submissions` with a .frb of each student, and optionally `model.frb`, an answer that must pass.
Prints a table of passed lines. A submission is only read, never executed, and a broken one is
a row with the reason.

  fuzzyarm grade examples/assignments/fan --csv > points.csv
"""

_MARKS = {"passed": "yes", "failed": "no", "undecided": "?"}


def _run(arguments: argparse.Namespace) -> int:
    with announced(f"grading {arguments.folder}"):
        assignment = read_assignment(arguments.folder)
        grades = grade(assignment)
    if arguments.json:
        print_json({"lines": assignment.lines, "submissions": grades}, 2)
    elif arguments.csv:
        write_text(_csv(assignment, grades))
    else:
        _print(assignment, grades, reasons=arguments.reasons)
    return 0


def _print(assignment: Assignment, grades: Sequence[Grade], *, reasons: bool) -> None:
    for number, line in enumerate(assignment.lines, 1):
        say(f"{number}. {line.about} ({counted(line.points, 'point')})")
    say("")
    head = ["submission", "points", *map(str, range(1, len(assignment.lines) + 1))]
    rows = [head]
    for row in grades:
        marks = [_MARKS[result.verdict] for result in row.results]
        rows.append([row.name, f"{row.points}/{assignment.points}", *marks])
    for table_line, fault in zip(
        in_columns(rows), ["", *(row.fault for row in grades)], strict=True
    ):
        say(f"{table_line}  {fault}" if fault else table_line)
    if reasons:
        for row in grades:
            for number, result in enumerate(row.results, 1):
                if result.says:
                    say(f"{row.name} {number}: {result.says}")


def _csv(assignment: Assignment, grades: Sequence[Grade]) -> str:
    """Return a row for each submission: 1 and 0, empty if undecided or unreadable."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["submission", "points", *(line.about for line in assignment.lines), "fault"])
    numbers = {"passed": "1", "failed": "0", "undecided": ""}
    for row in grades:
        cells = [numbers[result.verdict] for result in row.results]
        cells += [""] * (len(assignment.lines) - len(cells))
        writer.writerow([_inert(row.name), row.points, *cells, _inert(row.fault)])
    return stream.getvalue()


def _inert(text: str) -> str:
    """Return text that no spreadsheet reads as a formula: students choose the names."""
    return f"'{text}" if text[:1] in {"=", "+", "-", "@", "\t"} else text


COMMANDS = (
    command(
        "grade",
        _GRADE,
        _run,
        argument("folder DIR", "an assignment"),
        flag("--reasons", "also print why each line fails"),
        flag("--csv", "print the table as CSV", either="as"),
        flag("--json", "print the rows as JSON", either="as"),
    ),
)
