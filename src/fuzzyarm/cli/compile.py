"""Compile one output of a rule base to a lookup table, or a controller to C.

The suffix of OUT tells the format. Tables: .lut (text), .csv, .npz or .json. Source text:
.h (a C99 header on its own), .c (with a .h beside it) or .st (IEC 61131-3 Structured Text).
FILE may be a table already; it is then rewritten in the other format.

The levels, bins and rounding are those of the file's `lookup` settings; an input without
any gets 13 even levels. Prints how far the table is from direct inference, at worst and on
average, for each way of looking it up. With --tolerance T the smallest even grid is searched
whose linear interpolation differs nowhere by more than T; the file's lookup settings are then
not used.

Source text looks a table up, by --mode; with --q 15 or --q 7 in whole numbers. With --direct
C infers the rules themselves. All outputs go into one file unless --output names one.

  fuzzyarm compile rulebases/pd7.frb -o controller.h --q 15
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.cli.arguments import WordError, read_levels, read_number

if TYPE_CHECKING:
    from fuzzyarm.export import Exported
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.table import CompileReport, LookupTable


EXPORTS = (".h", ".c", ".st")

_SOURCE_ONLY = ("direct", "q", "precision", "name")
_RULES_ONLY = ("direct", "levels", "tolerance", "round", "date")
_TABLES_ONLY = ("levels", "tolerance", "round", "date", "mode", "q")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm compile``."""
    parser.add_argument(
        "file", metavar="FILE", help="a rule base (.frb, .fll, .fcl, .fis) or a table"
    )
    parser.add_argument("-o", "--out", required=True, metavar="OUT", help="the file to write")
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
    source = parser.add_argument_group("source text (.h, .c, .st)")
    source.add_argument("--direct", action="store_true", help="infer the rules, without a table")
    source.add_argument("--q", type=int, choices=(15, 7), help="fixed point: int16 or int8")
    source.add_argument(
        "--precision",
        choices=("mixed", "float32", "float64"),
        help="mixed (float outside, double inside where needed) by default",
    )
    source.add_argument("--name", metavar="IDENT", help="begins every identifier")


def run(arguments: argparse.Namespace) -> int:
    """Compile, write, report."""
    from fuzzyarm.api import load
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.table.files import SUFFIXES

    out = Path(arguments.out)
    exports = out.suffix.lower() in EXPORTS
    if not exports and out.suffix.lower() not in SUFFIXES:
        known = ", ".join((*SUFFIXES, *EXPORTS))
        raise WordError(f"'{out.name}' does not tell a format", hint=f"known: {known}")
    if not exports:
        _forbid(arguments, _SOURCE_ONLY, f"{out.name} is a table")
    model = load(arguments.file)
    if not isinstance(model, RuleBase):
        _forbid(arguments, _RULES_ONLY, f"{arguments.file} is a table already")
        return _rewrite(model, out, arguments)
    if arguments.direct:
        _forbid(arguments, _TABLES_ONLY, "with --direct there is no table")
        return _export(model, (), out, arguments)
    if not exports:
        report = _compile(model, arguments.output, arguments)
        _write_table(report.table, out)
        data = as_data(report, out)
        print(json.dumps(data, indent=2) if arguments.json else in_words(report, out))
        return 0
    names = [arguments.output] if arguments.output else [each.name for each in model.outputs]
    reports = [_compile(model, name, arguments) for name in names or [None]]
    return _export([report.table for report in reports], reports, out, arguments)


def _forbid(arguments: argparse.Namespace, words: tuple[str, ...], why: str) -> None:
    for word in words:
        if getattr(arguments, word) not in (None, False):
            raise WordError(f"--{word} makes no sense here: {why}")


def _compile(model: RuleBase, output: str | None, arguments: argparse.Namespace) -> CompileReport:
    from fuzzyarm.table.fidelity import compile_with_report

    with _progress() as progress:
        return compile_with_report(
            model,
            output,
            levels=None if arguments.levels is None else read_levels(arguments.levels),
            rounding=_number(arguments.round, "--round"),
            mode=arguments.mode,
            tolerance=_number(arguments.tolerance, "--tolerance"),
            source=arguments.file,
            date=datetime.now(UTC).date().isoformat() if arguments.date else None,
            progress=progress,
        )


def _rewrite(table: LookupTable, out: Path, arguments: argparse.Namespace) -> int:
    """Write a table in another format."""
    if arguments.output not in (None, table.output):
        raise WordError(f"the table has no output '{arguments.output}': it has {table.output}")
    if out.suffix.lower() in EXPORTS:
        return _export([table], (), out, arguments)
    if arguments.mode is not None:
        table = replace(table, mode=arguments.mode)
    _write_table(table, out)
    shape = " x ".join(map(str, table.shape))
    data = {
        "file": str(out),
        "output": table.output,
        "index": list(table.names),
        "shape": list(table.shape),
        "cells": int(table.values.size),
        "mode": table.default_mode,
    }
    words = f"{out}: {shape} cells of {table.output} over {', '.join(table.names)}"
    print(json.dumps(data, indent=2) if arguments.json else words)
    return 0


def _write_table(table: LookupTable, out: Path) -> None:
    from fuzzyarm.table.files import write_table

    write_table(table, out)


def _export(
    model: RuleBase | list[LookupTable],
    reports: tuple[CompileReport, ...] | list[CompileReport],
    out: Path,
    arguments: argparse.Namespace,
) -> int:
    """Write source text and say how good and how large it is."""
    from fuzzyarm.export import routines_of, write_export

    direct = bool(arguments.direct)
    precision = arguments.precision
    if precision is None:  # few PLCs have a double; a C compiler always has
        precision = "float32" if out.suffix.lower() == ".st" else "mixed"
    elif arguments.q is not None:
        raise WordError("--precision makes no sense with --q: whole numbers have no precision")
    routines = routines_of(
        model,
        output=arguments.output if direct else None,
        mode=arguments.mode,
        q=arguments.q,
        precision=precision,
        source=arguments.file,
    )
    exported = write_export(routines, out, arguments.name)
    if arguments.json:
        tables = [as_data(report, out) for report in reports]
        print(json.dumps(export_data(exported, tables), indent=2))
        return 0
    for report in reports:
        print(in_words(report, out))
    print(export_words(exported))
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
    from fuzzyarm.show.rulebase import number_words

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


# --- What `compile` says of exported source text ---


def export_data(exported: Exported, tables: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the report as JSON data; `tables` are those that were compiled on the way."""
    return {
        "files": [str(path) for path, _ in exported.files],
        "functions": [
            {
                "call": call,
                "output": routine.output.name,
                "arguments": [argument.name for argument in routine.arguments],
                "type": routine.kind,
                "worst": routine.accuracy().worst,
                "points": routine.accuracy().points,
                "against": routine.accuracy().against,
                "operations": dict(routine.cost().operations),
                "stack": routine.cost().stack,
            }
            for call, routine in zip(exported.calls, exported.routines, strict=True)
        ],
        "tables": tables,
    }


def export_words(exported: Exported) -> str:
    """Return the report as lines of text."""
    from fuzzyarm.show.rulebase import number_words

    lines = []
    for path, text in exported.files:
        lines.append(f"{path}: {len(text.encode()):,} bytes of source")
    for call, routine in zip(exported.calls, exported.routines, strict=True):
        accuracy, cost = routine.accuracy(), routine.cost()
        lines.append(call)
        lines.append(
            f"  worst error against {accuracy.against}: {number_words(accuracy.worst, 3)}"
            f" (of {accuracy.points:,} points)"
        )
        lines.append(f"  at most {cost.in_words()}")
    return "\n".join(lines)
