"""`fuzzyarm compile FILE --for arduino -o DIR`: folders that open in an IDE for boards."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.api import controller_if_any, load_sheet
from fuzzyarm.cli.command import UsageError, WordError, busy, demand_folder_of, print_json, say
from fuzzyarm.show.compiled import report_lines

if TYPE_CHECKING:
    from fuzzyarm.export.arduino import BoardFolder
    from fuzzyarm.export.boards import Board
    from fuzzyarm.export.routine import Routine
    from fuzzyarm.model.rulebase import RuleBase
    from fuzzyarm.proof.compiled import Making
    from fuzzyarm.requests.making import ExportRequest
    from fuzzyarm.table import CompileReport, LookupTable


def write_for_board(request: ExportRequest, out: str, how: Making, *, as_json: bool) -> None:
    """Write a folder for an IDE and say what is in it."""
    from fuzzyarm.export.arduino import board_folder
    from fuzzyarm.export.boards import board_named
    from fuzzyarm.export.names import DEVICES, identifier
    from fuzzyarm.text.whole_folders import demand_own, write_folder

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
            from fuzzyarm.proof.compiled import controller_program

            program, reports = controller_program(
                controller, how, how.precision or "mixed", progress
            )
            folder = board_folder(program, stem, board, request.place or "arduino")
        else:
            routines, reports = _routines(load_sheet(request.file), board, how, progress)
            folder = board_folder(routines, stem, board, request.place or "arduino")
    write_folder(out, folder.files)
    if as_json:
        print_json(_data(folder, out), 2)
        return
    lines = [line for report in reports for line in report_lines(report, out)]
    say(*lines, *_lines(folder, out))


def _routines(
    model: RuleBase | LookupTable, board: Board, how: Making, progress: Any
) -> tuple[tuple[Routine, ...], tuple[CompileReport, ...]]:
    """Return the routines; where only double precision could, say it of the board."""
    from fuzzyarm.export.numbers import ExportError
    from fuzzyarm.proof.compiled import routines_for

    try:
        return routines_for(model, ".c", how, progress)
    except ExportError as error:
        if board.has_double or "double precision only" not in error.message:
            raise
        hint = f"{board.named} has no double: --table, or --board due, pico or esp32"
        raise error.in_file(how.source, hint) from error


def _data(folder: BoardFolder, out: str) -> dict[str, Any]:
    measured = folder.measured
    report: dict[str, Any] = {
        "folder": out,
        "files": sorted(folder.files),
        "functions": list(folder.library.prototypes),
        "board": folder.board.name,
        "constants": folder.constants,
        "state": folder.state,
        "measured": None,
    }
    if measured is not None:
        report["measured"] = {
            "compiler": f"avr-gcc {measured.compiler}",
            "flash": measured.footprint.flash,
            "object": measured.object,
            "ram": measured.footprint.static,
            "stack": measured.footprint.stack if measured.cycles else None,
            "cycles": list(measured.cycles) if measured.cycles else None,
            "self_test": measured.passes,
        }
    return report


def _lines(folder: BoardFolder, out: str) -> list[str]:
    lines = [f"{out}: {len(folder.files)} files for {folder.board.named}"]
    lines += folder.library.prototypes
    measured = folder.measured
    if measured is None:
        return [
            *lines,
            f"  {folder.constants} bytes of tables; not measured here, README.md says how",
        ]
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
            f"  a call takes {worst:,} cycles at most ({micros:.1f} µs) and {footprint.stack}"
            f" bytes of stack; the self-test {verdict}"
        )
    return lines
