"""Compile a rule base to a lookup table or to source text, or a controller to a program.

The suffix of OUT selects the format. Tables: .lut (text), .csv, .npz or .json,
and .tex (LaTeX, for print). Source text: .h (a single C99 header), .c (with a .h
beside it), .st (IEC 61131-3 Structured Text), .xml (the same as PLCopen XML), .scl (SCL for the
TIA Portal), or a module: .py for MicroPython, .mjs or .js for JavaScript, .rs for Rust. A table
also becomes a network of rectifiers: .onnx, for verifiers of neural networks.
A FILE that is a table is rewritten in the other format.

Levels, bins and rounding are those of the file's `lookup` settings; an input without
any gets 13 even levels. Prints the worst and RMS error of the table against direct inference,
for each lookup mode; "proved" bounds hold between the points too. --tolerance T searches the
smallest even grid whose linear interpolation is nowhere off by more than T, and ignores the
file's lookup settings.

Source text infers the rules themselves; with `lookup` settings in the file it looks tables up, by
--mode, with --q 15 or --q 7 in integers. --direct and --table choose explicitly, and an option of
tables (--levels, --mode, --q …) implies one. All outputs go into one file unless --output names
one.

With --for arduino or platformio OUT is a folder for that IDE: a library with the tables in flash, a
sketch, a self-test, and a README with the size and cycles on the board, measured where avr-gcc and
simavr are installed.

A controller becomes a state with `init` and `step` in C, or a function block. Its rules are
inferred, or with --table looked up in tables made as above. --guard tests before each step of C
whether the state is in the region of a certificate. With .fmu any of the three becomes
a co-simulation unit (FMI), built with the installed C compiler.

  fuzzyarm compile rulebases/pd7.frb -o controller.h --q 15
  fuzzyarm compile rulebases/stfc.frb -o stfc.h
  fuzzyarm compile rulebases/tipper.frb --for arduino -o tipper
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.cli.arguments import request_command
from fuzzyarm.apps.cli.command import (
    FORCE,
    UsageError,
    WordError,
    busy,
    demand_folder_of,
    print_error,
    print_json,
    require_suffix,
    say,
)
from fuzzyarm.apps.show.compiled import controller_lines, export_lines, report_lines, table_words
from fuzzyarm.base.folders import EXPORTS
from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.exchange.files import controller_if_any, load_sheet
from fuzzyarm.requests.fields import Request, option
from fuzzyarm.requests.making import SOURCE, ExportRequest

if TYPE_CHECKING:
    from fuzzyarm.apps.dossier import ExportReport
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.exchange.compiled import Making
    from fuzzyarm.exchange.export import Exported, ExportedController
    from fuzzyarm.exchange.export.arduino import BoardFolder
    from fuzzyarm.exchange.export.boards import Board
    from fuzzyarm.exchange.export.routine import Routine
    from fuzzyarm.language.model.rulebase import RuleBase
    from fuzzyarm.requests.making import ExportRequest
    from fuzzyarm.table import CompileReport, LookupTable


def write_for_board(request: ExportRequest, out: str, how: Making, *, as_json: bool) -> None:
    """Write a folder for an IDE and print its contents."""
    from fuzzyarm.base.files import demand_own, write_folder
    from fuzzyarm.exchange.export.arduino import board_folder
    from fuzzyarm.exchange.export.boards import board_named
    from fuzzyarm.symbolic.identifiers import DEVICES, identifier

    board = board_named(request.board or "uno")
    if how.precision not in (None, board.precision) and not board.has_double:
        raise UsageError(
            f"--precision {how.precision} does not apply: {board.named} has no double",
            hint="leave it out, or take a --board with one: due, pico, esp32",
        )
    how = replace(how, precision=how.precision or (None if how.q else board.precision))
    stem = identifier(how.name or Path(request.file).stem)
    for name in (Path(out).name, stem):
        if name.upper() in DEVICES:
            raise WordError(
                f"'{name}' is the name of a device on Windows, not of a file or folder",
                hint="take another name",
            )
    demand_folder_of(out)
    demand_own(out)
    with busy("compiling") as progress:
        controller = controller_if_any(request.file)
        if controller is not None:
            from fuzzyarm.exchange.compiled import certified, controller_program

            how = certified(how, controller, request)
            precision = how.precision or "mixed"
            program, reports = controller_program(controller, how, precision, progress)
            others = {
                option: lambda other=other: controller_program(
                    controller, other, precision, progress
                )[0]
                for option, other in _with_tables(how).items()
            }
            folder = board_folder(program, stem, board, request.place or "arduino", others)
        else:
            if given := request.given(("certificate", "guard", "trust")):
                why = f"{request.file} is not a controller"
                raise UsageError(f"{given.spelling} does not apply: {why}")
            routines, reports = _routines(load_sheet(request.file), board, how, progress)
            folder = board_folder(routines, stem, board, request.place or "arduino")
    write_folder(out, folder.files)
    if as_json:
        print_json({"folder": out, **jsonable(folder)}, 2)
        return
    lines = [line for report in reports for line in report_lines(report, out)]
    say(*lines, *_lines(folder, out))


def _with_tables(how: Making) -> dict[str, Making]:
    """Return the options for the tables of a controller, and the tables' names."""
    tables = {"--table": None, "--q 15": 15, "--q 7": 7}
    if how.q is not None:
        return {}
    before, how = how, replace(how, direct=False, table=True, certified=None)
    made = {option: replace(how, q=q) for option, q in tables.items()}
    return {option: making for option, making in made.items() if making != before}


def _routines(
    model: RuleBase | LookupTable, board: Board, how: Making, progress: Any
) -> tuple[tuple[Routine, ...], tuple[CompileReport, ...]]:
    """Return the routines; explain a need for double precision by the board."""
    from fuzzyarm.exchange.compiled import routines_for
    from fuzzyarm.exchange.export.numbers import ExportError

    try:
        return routines_for(model, ".c", how, progress)
    except ExportError as error:
        if board.has_double or "double precision only" not in error.message:
            raise
        hint = f"{board.named} has no double: --table, or --board due, pico or esp32"
        raise error.in_file(how.source, hint) from error


def _lines(folder: BoardFolder, out: str) -> list[str]:
    lines = [f"{out}: {len(folder.files)} files for {folder.board.named}"]
    lines += folder.library.prototypes
    measured = folder.measured
    doubt = [f"  {folder.doubt}"] if folder.doubt else []
    if measured is None:
        bytes_ = f"  {folder.constants} bytes of tables; not measured here, README.md says how"
        return [*lines, bytes_, *doubt]
    footprint = measured.footprint
    lines.append(
        f"  flash {footprint.flash:,} of {folder.board.flash:,} bytes,"
        f" RAM {footprint.static:,} of {folder.board.ram:,}"
    )
    if measured.cycles:
        worst = max(measured.cycles)
        micros = worst / folder.board.clock * 1e6
        verdict = "passes" if measured.passes else "FAILS"
        lines.append(
            f"  the slowest of {len(measured.cycles)} calls takes {worst:,} cycles"
            f" ({micros:.1f} µs), with {footprint.stack} bytes of stack; the self-test {verdict}"
        )
    return [*lines, *doubt]


@dataclass(frozen=True, kw_only=True)
class _Output(Request):
    """Output file and form of the report."""

    out: str = option("-o --out OUT", "the file to write")
    json: bool = option("--json", "print the report as JSON", False)


@dataclass(frozen=True, kw_only=True)
class ExportWords(ExportRequest, _Output):
    """All arguments of ``fuzzyarm compile``."""

    report: str | None = option(
        "--report DIR", "of a .c: provenance, proofs, self-test, coverage", None,
        group=SOURCE,
    )  # fmt: skip


_UNIT = ".fmu"

# Options that apply to some inputs or outputs only, by name.
_SOURCE_ONLY = ("direct", "table", "q", "precision", "name")
_RULES_ONLY = ("direct", "table", "levels", "tolerance", "round", "date", "ends")
_TABLES_ONLY = ("levels", "tolerance", "round", "date", "mode", "q")
_CONTROLLERS_ONLY = ("certificate", "guard", "trust")
_UNITS_ONLY = ("fmi", "platforms")
_MADE_TABLES_ONLY = ("levels", "tolerance", "round", "date", "mode")


def _run(request: ExportWords) -> int:
    from fuzzyarm.table import SUFFIXES
    from fuzzyarm.table.files import LATEX

    tables = (*SUFFIXES, LATEX)
    request = request.replaced(out=str(Path(request.out)))  # ./x.lut is x.lut
    if request.place is not None:
        _write_for_board(request)
        return 0
    _forbid(request, ("board",), "without --for nothing is made for a board")
    if request.report is not None:
        _demand_report(request.out, request.report)
    suffix = require_suffix(request.out, (*tables, *EXPORTS))
    if suffix != _UNIT:
        _forbid(request, _UNITS_ONLY, f"{Path(request.out).name} is not an FMU")
    elif request.precision not in (None, "float64"):
        raise UsageError("an FMU computes in double precision: --precision float64")
    exports = suffix not in tables
    controller = controller_if_any(request.file) if exports else None
    if controller is not None:
        _export_controller(controller, suffix, request)
        return 0
    if not exports:
        _forbid(request, _SOURCE_ONLY, f"{Path(request.out).name} is a table")
    _forbid(request, _CONTROLLERS_ONLY, f"{request.file} is not exported as a controller")
    _compile_sheet(request, exports=exports)
    return 0


def _demand_report(out: str, folder: str) -> None:
    """Refuse a report about anything but C, or into a folder with other files."""
    from fuzzyarm.base.files import demand_own

    if Path(out).suffix.lower() != ".c":
        raise UsageError("--report is for C", hint="-o x.c: its coverage is counted by gcov")
    if Path(folder) in (Path(out), Path(out).with_suffix(".h")):
        raise UsageError("--report names a folder, and -o a file: they cannot be one")
    demand_own(folder)


def _report(
    request: ExportWords, how: Making, exported: Exported | ExportedController
) -> ExportReport | None:
    """Return the requested report, not yet written."""
    if request.report is None:
        return None
    from fuzzyarm.apps.dossier import report_of

    return report_of(request.file, how, exported)


def _write_report(folder: str | None, report: ExportReport | None) -> None:
    """Write a report into its folder."""
    if folder is not None and report is not None:
        from fuzzyarm.apps.dossier import write_report

        write_report(folder, report)


def _report_line(folder: str | None, report: ExportReport | None) -> list[str]:
    """Return the lines about a report, if there is one."""
    if report is None:
        return []
    rows, coverage = report.self_test.rows, report.coverage
    passed = sum(row.passed for row in rows)
    statements, branches = (
        f"{reached} of {total}" for reached, total in (coverage.statements, coverage.branches)
    )
    return [
        f"{folder}: report.html, report.json; {passed} of {len(rows)} points pass,"
        f" {statements} statements and {branches} branches reached"
    ]


def _write_for_board(request: ExportWords) -> None:
    """Write a folder for Arduino or PlatformIO."""
    from fuzzyarm.exchange.compiled import making_of

    _forbid(
        request,
        ("ends", "fmi", "platforms", "report"),
        f"--for {request.place} makes a folder for a board",
    )
    if request.table and request.direct:
        raise UsageError("--table and --direct exclude each other")
    with _of_file(request.file):
        write_for_board(request, request.out, making_of(request), as_json=request.json)


def _compile_sheet(request: ExportWords, *, exports: bool) -> None:
    """Compile a rule base or a table."""
    from fuzzyarm.language.model.rulebase import RuleBase

    model = load_sheet(request.file)
    if not isinstance(model, RuleBase):
        _forbid(request, _RULES_ONLY, f"{request.file} is a table already")
        if request.output not in (None, model.output):
            has = f"it has {model.output}"
            raise WordError(f"the table has no output '{request.output}': {has}")
        if exports:
            _export(model, request)
        else:
            _rewrite(model, request)
    elif request.direct:
        if request.table:
            raise UsageError("--table and --direct exclude each other")
        _forbid(request, (*_TABLES_ONLY, "ends"), "with --direct there is no table")
        _export(model, request)
    elif exports:
        _forbid(request, ("ends",), "make the two tables first; each becomes source text")
        _export(model, request)
    elif request.ends:
        _compile_ends(model, request)
    else:
        report = _compile(model, request.output, request)
        _write(report.table, request)
        if request.json:
            print_json(_with_file(request, report), 2)
        else:
            say(*report_lines(report, request.out))


def _compile_ends(model: RuleBase, request: ExportWords) -> None:
    """Write a table of each end of an interval type-2 output, with the end in its name."""
    from fuzzyarm.symbolic.kinds import DEFUZZIFIERS
    from fuzzyarm.table.compiler import choose_output

    output = choose_output(model, request.output)
    if output.defuzzifier.record.of != "ends":
        raise WordError(f"--ends are those of karnik-mendel, and '{output.name}' is one number")
    out, data = Path(request.out), []
    for end in ("left", "right"):
        way = replace(output.defuzzifier, method=DEFUZZIFIERS.plain(end))
        one = replace(output, defuzzifier=way)
        outputs = tuple(one if variable is output else variable for variable in model.outputs)
        request = request.replaced(out=str(out.with_name(f"{out.stem}-{end}{out.suffix}")))
        report = _compile(replace(model, outputs=outputs), output.name, request)
        _write(report.table, request)
        if request.json:
            data.append(_with_file(request, report))
        else:
            say(f"{request.out}: the {end} end", *report_lines(report, request.out))
    if request.json:
        print_json(data, 2)


def _forbid(request: ExportWords, names: tuple[str, ...], why: str) -> None:
    if option := request.given(names):
        raise UsageError(f"{option.spelling} does not apply: {why}")


def _compile(model: RuleBase, output: str | None, request: ExportWords) -> CompileReport:
    from fuzzyarm.exchange.compiled import compiled, making_of

    how = making_of(request)
    with busy("compiling") as progress:
        return compiled(model, output, how, progress)


def _rewrite(table: LookupTable, request: ExportWords) -> None:
    """Write a table in another format."""
    if request.mode is not None:
        table = replace(table, mode=request.mode)
    _write(table, request)
    if request.json:
        print_json(_with_file(request, table, REWRITTEN), 2)
    else:
        say(table_words(table, request.out))


REWRITTEN = "output index=names shape cells mode=default_mode"
"""Properties in JSON of a table in another format."""


def _write(table: LookupTable, request: ExportWords) -> None:
    from fuzzyarm.table.files import write_table

    write_table(table, request.out)


def _export(model: RuleBase | LookupTable, request: ExportWords) -> None:
    """Write source text and print its accuracy and size."""
    from fuzzyarm.exchange.compiled import making_of, source_of

    if request.precision is not None and request.q is not None:
        raise UsageError("--precision does not apply with --q: whole numbers have no precision")
    how = making_of(request)
    with busy("compiling") as progress, _of_file(request.file):
        exported, reports = source_of(model, request.out, how, progress)
    _write_export(request, how, exported, reports, export_lines(exported))


@contextmanager
def _of_file(path: str) -> Iterator[None]:
    """Name the file in export errors."""
    from fuzzyarm.exchange.export.numbers import ExportError

    try:
        yield
    except ExportError as error:
        raise error.in_file(path) from error


def _export_controller(controller: ControllerText, suffix: str, request: ExportWords) -> None:
    """Write a controller as a program and print a summary."""
    from fuzzyarm.exchange.compiled import certified, making_of, program_of

    if request.table and request.direct:
        raise UsageError("--table and --direct exclude each other")
    if not request.table:
        _forbid(request, _MADE_TABLES_ONLY, "without --table no table is made of rules")
    _forbid(request, ("output",), "a controller is exported as a whole")
    how = certified(making_of(request), controller, request)
    with busy("exporting") as progress, _of_file(request.file):
        exported, reports = program_of(controller, request.out, how, progress)
    if how.certified is not None:
        from fuzzyarm.exchange.export.certified_guard import start_outside

        outside = start_outside(how.certified)
        if outside:
            print_error(outside)
    _write_export(request, how, exported, reports, controller_lines(exported))


def _write_export(
    request: ExportWords,
    how: Making,
    exported: Exported | ExportedController,
    tables: Sequence[CompileReport],
    lines: Sequence[str],
) -> None:
    """Write source text with the requested report, and list both in `lines`."""
    report = _report(request, how, exported)
    exported.write()
    _write_report(request.report, report)
    if request.json:
        records = [_with_file(request, table) for table in tables]
        print_json(report or {**jsonable(exported), "tables": records}, 2)
        return
    of_tables = [line for table in tables for line in report_lines(table, request.out)]
    say(*of_tables, *lines, *_report_line(request.report, report))


def _with_file(request: ExportWords, record: object, words: str = "") -> dict[str, Any]:
    return {"file": request.out, **jsonable(record, words)}


COMMANDS = (request_command("compile", __doc__, _run, ExportWords, FORCE),)
