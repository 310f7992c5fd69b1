"""`fuzzyarm compile FILE --for arduino -o DIR`: folders that open in an IDE for boards."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.cli.command import UsageError, WordError, busy, demand_folder_of, print_json, say
from fuzzyarm.apps.show.compiled import report_lines
from fuzzyarm.base.jsonable import jsonable
from fuzzyarm.exchange.files import controller_if_any, load_sheet

if TYPE_CHECKING:
    from fuzzyarm.exchange.compiled import Making
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
