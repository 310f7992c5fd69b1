"""Compile a rule base to a lookup table or to source text, or a controller to a program.

The suffix of OUT tells the format. Tables: .lut (text), .csv, .npz or .json,
and .tex (LaTeX, to be printed). Source text: .h (a C99 header on its own), .c (with a .h
beside it), .st (IEC 61131-3 Structured Text), .xml (the same as PLCopen XML, or with --format
iec61131-10 as the XML of that standard), .scl (SCL for the TIA Portal) or .py (a module for
MicroPython);
.mjs or .js is a module of JavaScript that infers the rules themselves.
FILE may be a table already; it is then rewritten in the other format.

The levels, bins and rounding are those of the file's `lookup` settings; an input without
any gets 13 even levels. Prints how far the table is from direct inference, at worst and on
average, for each way of looking it up; "proved" holds between the points too.
With --tolerance T the smallest even grid is searched whose linear interpolation differs nowhere
by more than T; the file's lookup settings are then not used.

Source text infers the rules themselves; of a file with `lookup` settings it looks tables up, by
--mode, with --q 15 or --q 7 in whole numbers. --direct and --table say which, and an option of
a table (--levels, --mode, --q …) means one. All outputs go into one file unless --output names one.

With --for arduino or platformio OUT is a folder that opens in that program: a library whose
tables stay in flash, a sketch, a self-test, and a README with the bytes and cycles that a board
takes, measured where avr-gcc and simavr are installed.

A controller becomes a state with `init` and `step` in C, a function block, or with .fmu a
co-simulation unit (FMI), built with the C compiler that is there. Its rules are inferred, or
with --table looked up in tables that are made as above.

  fuzzyarm compile rulebases/pd7.frb -o controller.h --q 15
  fuzzyarm compile rulebases/stfc.frb -o stfc.h
  fuzzyarm compile rulebases/tipper.frb --for arduino -o tipper
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.api import controller_if_any, load_sheet
from fuzzyarm.cli.command import (
    WordError,
    argument,
    busy,
    command,
    flag,
    group,
    json_of,
    out,
    print_json,
    read_number,
    require_suffix,
    say,
)
from fuzzyarm.show.compiled import controller_lines, export_lines, report_lines, table_words

if TYPE_CHECKING:
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.export import Exported, ExportedController
    from fuzzyarm.export.routine import Routine
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.proof.compiled import Making
    from fuzzyarm.table import CompileReport, LookupTable
    from fuzzyarm.table.compiler import Levels


_EXPORTS = (".h", ".c", ".st", ".xml", ".scl", ".py")
_UNIT = ".fmu"
_MODULES = (".mjs", ".js")

# Options that make no sense for some inputs or outputs, by their names.
_SOURCE_ONLY = ("direct", "table", "q", "precision", "name")
_RULES_ONLY = ("direct", "table", "levels", "tolerance", "round", "date", "ends")
_TABLES_ONLY = ("levels", "tolerance", "round", "date", "mode", "q")
_CONTROLLERS_ONLY = ("fmi", "platforms", "certificate")
_MADE_TABLES_ONLY = ("levels", "tolerance", "round", "date", "mode")


def _run(arguments: argparse.Namespace) -> int:
    from fuzzyarm.table import SUFFIXES
    from fuzzyarm.table.files import LATEX

    tables = (*SUFFIXES, LATEX)
    arguments.out = str(Path(arguments.out))  # ./x.lut is x.lut
    place = getattr(arguments, "for")
    if place is not None:
        _write_for_board(arguments, place)
        return 0
    _forbid(arguments, ("board",), "without --for nothing is made for a board")
    suffix = require_suffix(arguments.out, (*tables, *_EXPORTS, _UNIT, *_MODULES))
    if suffix != ".xml":
        _forbid(arguments, ("format",), f"{Path(arguments.out).name} is not an .xml")
    if suffix in _MODULES:
        _write_module(arguments)
        return 0
    exports = suffix not in tables
    controller = controller_if_any(arguments.file) if exports else None
    if controller is not None:
        _export_controller(controller, suffix, arguments)
        return 0
    if suffix == _UNIT:
        hint = "fuzzyarm new NAME --kind controller writes one"
        raise WordError(
            f"an .fmu is made from a controller, which {arguments.file} is not", hint=hint
        )
    if not exports:
        _forbid(arguments, _SOURCE_ONLY, f"{Path(arguments.out).name} is a table")
    _forbid(arguments, _CONTROLLERS_ONLY, f"{arguments.file} is not exported as a controller")
    _compile_sheet(arguments, exports=exports)
    return 0


def _write_for_board(arguments: argparse.Namespace, place: str) -> None:
    """Write a folder for Arduino or PlatformIO."""
    from fuzzyarm.cli.boards import write_for_board

    _forbid(
        arguments,
        ("ends", "fmi", "platforms", "certificate", "format"),
        f"--for {place} makes a folder for a board",
    )
    if arguments.table and arguments.direct:
        raise WordError("--table and --direct exclude each other")
    with _of_file(arguments.file):
        write_for_board(arguments, place, _making(arguments))


def _write_module(arguments: argparse.Namespace) -> None:
    """Write a rule base as a module of JavaScript."""
    from fuzzyarm.export.javascript import rule_base_module
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.text.files import write_atomically

    model = load_sheet(arguments.file)
    if not isinstance(model, RuleBase):
        raise WordError(f"a module of JavaScript is made of a rule base, not {arguments.file}")
    refused = (*_TABLES_ONLY, *_CONTROLLERS_ONLY, "table", "precision", "output", "name")
    _forbid(arguments, refused, "JavaScript infers the rules of all outputs")
    text = rule_base_module(model, arguments.file)
    write_atomically(arguments.out, text)
    names = ", ".join(variable.name for variable in model.inputs)
    if arguments.json:
        print_json({"file": arguments.out, "bytes": len(text.encode())}, 2)
    else:
        say(f"{arguments.out}: infer({{{names}}}), {len(text.encode())} bytes")


def _compile_sheet(arguments: argparse.Namespace, *, exports: bool) -> None:
    """Compile a rule base or a table."""
    from fuzzyarm.model.rulebase import RuleBase

    model = load_sheet(arguments.file)
    if not isinstance(model, RuleBase):
        _forbid(arguments, _RULES_ONLY, f"{arguments.file} is a table already")
        if arguments.output not in (None, model.output):
            has = f"it has {model.output}"
            raise WordError(f"the table has no output '{arguments.output}': {has}")
        if exports:
            _export(model, arguments)
        else:
            _rewrite(model, arguments)
    elif arguments.direct:
        if arguments.table:
            raise WordError("--table and --direct exclude each other")
        _forbid(arguments, (*_TABLES_ONLY, "ends"), "with --direct there is no table")
        _export(model, arguments)
    elif exports:
        _forbid(arguments, ("ends",), "make the two tables first; each becomes source text")
        _export(model, arguments)
    elif arguments.ends:
        _compile_ends(model, arguments)
    else:
        report = _compile(model, arguments.output, arguments)
        _write(report.table, arguments)
        if arguments.json:
            print_json(_report_data(report, arguments.out), 2)
        else:
            say(*report_lines(report, arguments.out))


def _compile_ends(model: RuleBase, arguments: argparse.Namespace) -> None:
    """Write a table of each end of an interval type-2 output, with the end in its name."""
    from fuzzyarm.expression.kinds import DEFUZZIFIERS
    from fuzzyarm.table.compiler import choose_output

    output = choose_output(model, arguments.output)
    if output.defuzzifier.record.of != "ends":
        raise WordError(f"--ends are those of karnik-mendel, and '{output.name}' is one number")
    out, data = Path(arguments.out), []
    for end in ("left", "right"):
        way = replace(output.defuzzifier, method=DEFUZZIFIERS.plain(end))
        one = replace(output, defuzzifier=way)
        outputs = tuple(one if each is output else each for each in model.outputs)
        arguments.out = str(out.with_name(f"{out.stem}-{end}{out.suffix}"))
        report = _compile(replace(model, outputs=outputs), output.name, arguments)
        _write(report.table, arguments)
        if arguments.json:
            data.append(_report_data(report, arguments.out))
        else:
            say(f"{arguments.out}: the {end} end", *report_lines(report, arguments.out))
    if arguments.json:
        print_json(data, 2)


def _forbid(arguments: argparse.Namespace, words: tuple[str, ...], why: str) -> None:
    for word in words:
        if getattr(arguments, word) not in (None, False):
            raise WordError(f"--{word} does not apply: {why}")


def _making(arguments: argparse.Namespace) -> Making:
    """Return what the options say."""
    from fuzzyarm.proof.compiled import Making

    def number(text: str | None, option: str) -> float | None:
        return None if text is None else read_number(text, option)

    return Making(
        source=arguments.file,
        output=arguments.output,
        levels=None if arguments.levels is None else _levels(arguments.levels),
        tolerance=number(arguments.tolerance, "--tolerance"),
        rounding=number(arguments.round, "--round"),
        mode=arguments.mode,
        date=datetime.now(UTC).date().isoformat() if arguments.date else None,
        direct=arguments.direct,
        table=arguments.table,
        q=arguments.q,
        precision=arguments.precision,
        name=arguments.name,
        fmi=arguments.fmi or 2,
        platforms=arguments.platforms,
        xml=arguments.format or "plcopen",
    )


def _levels(text: str) -> Levels | Mapping[str, Levels]:
    from fuzzyarm.table.axis import TableError
    from fuzzyarm.table.levels import read_levels

    try:
        return read_levels(text)
    except TableError as error:
        raise WordError(f"--{error.message}") from None


def _compile(model: RuleBase, output: str | None, arguments: argparse.Namespace) -> CompileReport:
    from fuzzyarm.proof.compiled import compiled

    how = _making(arguments)
    with busy("compiling") as progress:
        return compiled(model, output, how, progress)


def _rewrite(table: LookupTable, arguments: argparse.Namespace) -> None:
    """Write a table in another format."""
    if arguments.mode is not None:
        table = replace(table, mode=arguments.mode)
    _write(table, arguments)
    if arguments.json:
        print_json({**_table_data(table, arguments.out), "mode": table.default_mode}, 2)
    else:
        say(table_words(table, arguments.out))


def _write(table: LookupTable, arguments: argparse.Namespace) -> None:
    from fuzzyarm.table.files import write_table

    write_table(table, arguments.out)


def _export(model: RuleBase | LookupTable, arguments: argparse.Namespace) -> None:
    """Write source text and say how accurate and how large it is."""
    from fuzzyarm.proof.compiled import source_of
    from fuzzyarm.text.files import write_atomically

    if arguments.precision is not None and arguments.q is not None:
        raise WordError("--precision does not apply with --q: whole numbers have no precision")
    how = _making(arguments)
    with busy("compiling") as progress, _of_file(arguments.file):
        exported, reports = source_of(model, arguments.out, how, progress)
    for where, text in exported.files:
        write_atomically(where, text)
    if arguments.json:
        tables = [_report_data(report, arguments.out) for report in reports]
        print_json({**_export_data(exported), "tables": tables}, 2)
        return
    lines = [line for report in reports for line in report_lines(report, arguments.out)]
    say(*lines, *export_lines(exported))


@contextmanager
def _of_file(path: str) -> Iterator[None]:
    """Say of what cannot be exported in which file it stands."""
    from fuzzyarm.export.numbers import ExportError

    try:
        yield
    except ExportError as error:
        raise error.in_file(path) from error


def _certified(path: str, controller: ControllerText) -> str:
    """Check a certificate; return what it proves, for the head of a program."""
    from fuzzyarm.closed_loop import check_certificate

    verdict = check_certificate(path, controller)
    if not verdict.proved or verdict.certificate is None:
        raise WordError(f"{path}: {verdict.reason}")
    how = "as if it ran without a period" if verdict.continuous else "as sampled"
    return f"{verdict.statement}, {how}; certificate {verdict.certificate.seal}"


def _export_controller(
    controller: ControllerText, suffix: str, arguments: argparse.Namespace
) -> None:
    """Write a controller as a program and say what it is."""
    from fuzzyarm.proof.compiled import program_of

    if arguments.table and arguments.direct:
        raise WordError("--table and --direct exclude each other")
    if not arguments.table:
        _forbid(arguments, _MADE_TABLES_ONLY, "without --table no table is made of rules")
    _forbid(arguments, ("output",), "a controller is exported as a whole")
    if suffix != _UNIT:
        _forbid(arguments, ("fmi", "platforms"), f"{Path(arguments.out).name} is not an FMU")
    elif arguments.precision not in (None, "float64"):
        raise WordError("an FMU computes in double precision: --precision float64")
    how = _making(arguments)
    if arguments.certificate is not None:
        if arguments.table or arguments.q:
            raise WordError("the certificate is of the rules, not of a table or of whole numbers")
        how = replace(how, proofs=(_certified(arguments.certificate, controller),))
    with busy("exporting") as progress, _of_file(arguments.file):
        exported, reports = program_of(controller, arguments.out, how, progress)
    exported.write()
    if arguments.json:
        tables = [_report_data(report, arguments.out) for report in reports]
        print_json({**_controller_data(exported), "tables": tables}, 2)
        return
    lines = [line for report in reports for line in report_lines(report, arguments.out)]
    say(*lines, *controller_lines(exported))


# --- What --json says of tables and of source text ---


def _table_data(table: LookupTable, out: str) -> dict[str, Any]:
    return {
        "file": out,
        "output": table.output,
        "index": list(table.names),
        "shape": list(table.shape),
        "cells": int(table.values.size),
    }


def _report_data(report: CompileReport, out: str) -> dict[str, Any]:
    return {
        **_table_data(report.table, out),
        "default_levels": report.default_levels,
        "tolerance": report.tolerance,
        "mode": report.table.default_mode,
        "errors": [
            {
                "mode": fidelity.mode,
                "worst": fidelity.worst if fidelity.proved is None else fidelity.proved,
                "proved": fidelity.proved is not None,
                "sampled": fidelity.worst,
                "rms": fidelity.rms,
                "at": dict(fidelity.at),
                "points": list(fidelity.points),
            }
            for fidelity in report.fidelities
        ],
    }


def _export_data(exported: Exported) -> dict[str, Any]:
    from fuzzyarm.export.numbers import C_TYPES

    return {
        "files": [str(path) for path, _ in exported.files],
        "functions": [
            {
                "call": call,
                "output": routine.output.name,
                "arguments": [argument.name for argument in routine.arguments],
                "type": C_TYPES[routine.kind],
                "worst": routine.accuracy.worst,
                "points": routine.accuracy.points,
                "against": routine.accuracy.against,
                "proved": _proved(routine),
                "operations": dict(routine.cost().operations),
                "stack": routine.cost().stack,
            }
            for call, routine in zip(exported.calls, exported.routines, strict=True)
        ],
    }


def _proved(routine: Routine) -> float | None:
    """Return the proved worst error against the rules."""
    from fuzzyarm.export.table import TableRoutine

    return routine.worst_proved() if isinstance(routine, TableRoutine) else None


def _controller_data(exported: ExportedController) -> dict[str, Any]:
    from fuzzyarm.export.controllers import port_name

    program = exported.program
    steps, tried = program.steps, program.tried
    ports = {
        word: [port_name(steps, port) for port in steps.of_sort(sort)]
        for sort, word in (
            ("reference", "references"), ("measured", "measured"), ("drive", "drives"),
        )
    }  # fmt: skip
    return {
        "files": [str(path) for path, _ in exported.files],
        "controller": program.text.model.name,
        "period": program.text.model.period,
        **ports,
        "gains": list(dict.fromkeys(gain.name for gain in steps.of_sort("gain"))),
        "calls": list(exported.calls),
        "precision": program.precision,
        "worst": tried.worst,
        "largest": tried.largest,
        "periods": len(tried.vectors.expected),
    }


COMMANDS = (
    command(
        "compile",
        __doc__,
        _run,
        argument("file FILE", "a rule base (.frb, .fll, .fcl, .fis), a table or a controller"),
        out("OUT", "the file to write"),
        argument("--output NAME", "which output, if there are several"),
        argument("--levels SPEC", "49, or '-6 .. 6 step 1', or 'e = 49, ce = 25'", either="size"),
        argument("--tolerance T", "find the smallest even grid within T", either="size"),
        argument("--round STEP", "round the values; 0 for not at all"),
        argument("--mode", "how to look up", choices=("bins", "nearest", "linear")),
        flag("--ends", "two tables: of the left and the right end of an interval type-2 output"),
        flag("--date", "put today's date into the table"),
        json_of("the report"),
        *group(
            "source text (.h, .c, .st, .xml, .scl) and units (.fmu)",
            flag(
                "--direct", "infer the rules, without a table: the default without lookup settings"
            ),
            flag("--table", "look tables up instead of inferring the rules"),
            argument("--fmi", "version of FMI, 2 by default", type=int, choices=(2, 3)),
            argument(
                "--platforms LIST", "of an FMU: linux64,win64,darwin64 and others, by ziglang"
            ),
            argument("--q", "fixed point: int16 or int8", type=int, choices=(15, 7)),
            argument(
                "--precision",
                "mixed (float outside, double inside where needed) by default",
                choices=("mixed", "float32", "float64"),
            ),
            argument("--name IDENT", "begins every identifier"),
            argument(
                "--format", "of an .xml: plcopen by default", choices=("plcopen", "iec61131-10")
            ),
            argument("--for", "a folder for an IDE", choices=("arduino", "platformio")),
            argument("--board NAME", "of --for: uno (default), nano, mega, due, pico, esp32"),
            argument("--certificate CERT", "of a controller: what it proves goes into the head"),
        ),
    ),
)
