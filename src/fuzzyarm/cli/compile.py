"""Compile one output of a rule base to a lookup table.

The suffix of OUT tells the format: .lut (text), .csv, .npz or .json. The levels, bins and
rounding are those of the file's `lookup` settings; an input without any gets 13 even
levels. Prints how far the table is from direct inference, at worst and on average, for
each way of looking it up.

With --tolerance T the smallest even grid is searched whose linear interpolation differs
nowhere by more than T; the file's lookup settings are then not used.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.assignments import WordError, read_number
from fuzzyarm.cli.levels import read_levels

if TYPE_CHECKING:
    from fuzzyarm.lut import CompileReport


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm compile``."""
    parser.add_argument("file", metavar="FILE", help="a rule base: .frb, .fll, .fcl or .fis")
    parser.add_argument("-o", "--out", required=True, metavar="OUT", help="the table to write")
    parser.add_argument("--output", metavar="NAME", help="which output, if there are several")
    size = parser.add_mutually_exclusive_group()
    size.add_argument(
        "--levels", metavar="SPEC", help="49, or '-6 .. 6 step 1', or 'e = 49, ce = 25'"
    )
    size.add_argument("--tolerance", metavar="T", help="find the smallest even grid within T")
    parser.add_argument("--round", metavar="STEP", help="round the values; 0 for not at all")
    parser.add_argument("--mode", choices=("bins", "nearest", "linear"), help="how to look up")
    parser.add_argument("--date", action="store_true", help="put today's date into the table")
    parser.add_argument("--json", action="store_true", help="print the report as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Compile, write, report."""
    from fuzzyarm.api import load
    from fuzzyarm.lut.files import SUFFIXES, write_table
    from fuzzyarm.lut.report import compile_with_report
    from fuzzyarm.rulebase import RuleBase

    out = Path(arguments.out)
    if out.suffix.lower() not in SUFFIXES:
        known = ", ".join(SUFFIXES)
        raise WordError(f"'{out.name}' does not tell a table format", hint=f"known: {known}")
    rulebase = load(arguments.file)
    if not isinstance(rulebase, RuleBase):
        raise WordError(f"{arguments.file} is a table already; only rule bases are compiled")
    with _progress() as progress:
        report = compile_with_report(
            rulebase,
            arguments.output,
            levels=None if arguments.levels is None else read_levels(arguments.levels),
            rounding=_number(arguments.round, "--round"),
            mode=arguments.mode,
            tolerance=_number(arguments.tolerance, "--tolerance"),
            source=arguments.file,
            date=datetime.now(UTC).date().isoformat() if arguments.date else None,
            progress=progress,
        )
    write_table(report.table, out)
    print(json.dumps(as_data(report, out), indent=2) if arguments.json else in_words(report, out))
    return 0


def _number(text: str | None, name: str) -> float | None:
    return None if text is None else read_number(text, name)


def as_data(report: CompileReport, out: Path) -> dict[str, Any]:
    """Return the report as JSON data."""
    table = report.table
    return {
        "file": str(out),
        "output": table.output,
        "index": list(table.names),
        "shape": list(table.shape),
        "cells": int(table.values.size),
        "default_levels": report.default_levels,
        "tolerance": report.tolerance,
        "mode": table.default_mode,
        "errors": [
            {
                "mode": fidelity.mode,
                "worst": fidelity.worst,
                "rms": fidelity.rms,
                "at": dict(fidelity.at),
                "points": list(fidelity.points),
            }
            for fidelity in report.fidelities
        ],
    }


def in_words(report: CompileReport, out: Path) -> str:
    """Return the report as lines of text."""
    from fuzzyarm.show.words import number_words

    table = report.table
    shape = " x ".join(map(str, table.shape))
    lines = [f"{out}: {shape} cells of {table.output} over {', '.join(table.names)}"]
    if report.default_levels:
        lines.append("the file names no levels for every input: 13 even levels were taken")
    lines.append("difference to direct inference, in units of the output:")
    for fidelity in report.fidelities:
        at = ", ".join(f"{name} = {number_words(x, 4)}" for name, x in fidelity.at)
        size = " x ".join(map(str, fidelity.points))
        lines.append(
            f"  {fidelity.mode:<7}  worst {number_words(fidelity.worst, 4):<8} "
            f"rms {number_words(fidelity.rms, 4):<8} worst at {at} (of {size} points)"
        )
    if report.tolerance is not None:
        lines.append(
            f"this is the smallest even grid within {report.tolerance:g}, looked up linearly"
        )
    return "\n".join(lines)


@contextmanager
def _progress() -> Iterator[Callable[[str], None] | None]:
    """Show what is going on, on a terminal only."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console

    with Console(stderr=True).status("compiling") as status:
        yield status.update
