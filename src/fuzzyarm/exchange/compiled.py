"""Tables with a proved error, and the source text and programs that look them up or infer.

What ``fuzzyarm compile`` makes, and the designer's exports: the same bytes from the same text.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.base.diagnostic import MAX_LEVELS
from fuzzyarm.base.errors import WordError
from fuzzyarm.base.folders import MODULES, NETWORK
from fuzzyarm.base.numbers import outward_text
from fuzzyarm.language.model.controller import Axes, Drive, SignalLine, Zoom
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map.tables import table_proof
from fuzzyarm.requests.fields import RequestError
from fuzzyarm.requests.making import ExportRequest
from fuzzyarm.table.axis import TableError
from fuzzyarm.table.compiler import Levels, choose_output
from fuzzyarm.table.fidelity import CompileReport, compile_with_report
from fuzzyarm.table.levels import read_levels

if TYPE_CHECKING:
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.exchange.export import ControllerProgram, Exported, ExportedController
    from fuzzyarm.exchange.export.routine import Routine
    from fuzzyarm.proof.check.checking import Checked
    from fuzzyarm.table import LookupTable

_DEFAULTS = {
    **dict.fromkeys((".st", ".xml", ".scl"), "float32"),  # few PLCs have a double
    **dict.fromkeys((".fmu", *MODULES), "float64"),
}
"""Default precision of source text; elsewhere it is mixed."""

Tell = Callable[[str], None]
"""Callback with the current step in words."""


@dataclass(frozen=True, slots=True)
class Making:
    """Options for a table, source text or a program: those of an `ExportRequest`, read.

    None is the file's own choice. `source` is the name of the file and `proofs` are proved
    properties of a controller's loop, for the header comment; `certified` is the certificate of a
    guard.
    """

    source: str = ""
    output: str | None = None
    levels: Levels | Mapping[str, Levels] | None = None
    tolerance: float | None = None
    rounding: float | None = None
    mode: str | None = None
    date: str | None = None
    direct: bool = False
    table: bool = False
    q: int | None = None
    precision: str | None = None
    name: str | None = None
    fmi: int = 2
    platforms: str | None = None
    proofs: tuple[str, ...] = ()
    certified: Checked | None = None


def making_of(request: ExportRequest) -> Making:
    """Return the options of a request."""
    if request.levels is not None and request.tolerance is not None:
        raise RequestError("tolerance", "and levels exclude each other")
    return Making(
        source=request.file,
        output=request.output,
        levels=None if request.levels is None else _levels(request.levels),
        tolerance=request.tolerance,
        rounding=request.round,
        mode=request.mode,
        date=datetime.now(UTC).date().isoformat() if request.date else None,
        direct=request.direct,
        table=request.table,
        q=request.q,
        precision=request.precision,
        name=request.name,
        fmi=request.fmi or 2,
        platforms=request.platforms,
    )


def certified(how: Making, controller: ControllerText, request: ExportRequest) -> Making:
    """Check the certificates of a request; return options with their claims and the guard."""
    from fuzzyarm.proof.check.checking import check_certificate, proof_words
    from fuzzyarm.proof.claim.text import claimed_plant

    files = dict.fromkeys(filter(None, (request.certificate, request.guard)))
    if files and (request.table or request.q):
        raise WordError("the certificate is about the rules, not about a table or integers")
    for path in files:
        checked = check_certificate(path, controller, trust=request.trust)
        if not checked.proved:
            raise WordError(f"{path}: {checked.reason}")
        plant = claimed_plant(checked.claim, trust=request.trust)
        how = replace(how, proofs=(*how.proofs, proof_words(checked, controller, plant)))
        if path == request.guard:
            how = replace(how, certified=checked)
    return how


def _levels(text: str) -> Levels | Mapping[str, Levels]:
    try:
        levels = read_levels(text)
    except TableError as error:
        message = error.message.removeprefix("levels ")
        raise RequestError("levels", message, hint=error.hint) from None
    if isinstance(levels, int) and not 2 <= levels <= MAX_LEVELS:
        raise RequestError("levels", f"must be 2 to {MAX_LEVELS:,}, not {levels:,}")
    return levels


def infers(model: RuleBase | LookupTable, how: Making) -> bool:
    """Return whether source text infers the rules of a model instead of looking a table up.

    By default rules are inferred, unless the file has `lookup` settings or an option concerns
    tables.
    """
    if how.direct or not isinstance(model, RuleBase):
        return how.direct
    of_a_table = (how.levels, how.tolerance, how.rounding, how.mode, how.date, how.q)
    return model.lookup is None and not how.table and all(option is None for option in of_a_table)


def compiled(
    rulebase: RuleBase, output: str | None, how: Making, progress: Tell | None = None
) -> CompileReport:
    """Return the table of an output, and its error: proved, or at points if a proof takes long.

    Raises
    ------
    FuzzyarmError
        As :func:`fuzzyarm.table.compile_with_report`.
    """
    return compile_with_report(
        rulebase,
        output,
        levels=how.levels,
        rounding=how.rounding,
        mode=how.mode,
        tolerance=how.tolerance,
        source=how.source or None,
        date=how.date,
        progress=progress,
        proof=table_proof(rulebase, choose_output(rulebase, output).name),
    )


def source_of(
    model: RuleBase | LookupTable, path: str | Path, how: Making, progress: Tell | None = None
) -> tuple[Exported, tuple[CompileReport, ...]]:
    """Return a rule base or a table as source text, not yet written, and its tables."""
    from fuzzyarm.exchange.export import ExportError, export_files
    from fuzzyarm.exchange.export.sets import TABLE_HINT

    try:
        routines, reports = routines_for(model, path, how, progress)
    except ExportError as error:
        if how.direct or not infers(model, how):
            raise
        hint = error.hint if "--table" in error.hint else f"{error.hint}, or {TABLE_HINT}"
        # The rules cannot be written, but a table of them can.
        raise error.in_file("", hint) from error
    exported = export_files(routines, path, how.name, fmi=how.fmi, platforms=how.platforms)
    return exported, reports


def routines_for(
    model: RuleBase | LookupTable, path: str | Path, how: Making, progress: Tell | None = None
) -> tuple[tuple[Routine, ...], tuple[CompileReport, ...]]:
    """Return the routines of a rule base or a table, and its tables; as :func:`source_of`."""
    from fuzzyarm.exchange.export import routines_of

    suffix = Path(path).suffix.lower()
    if suffix == NETWORK and not how.direct:  # a network interpolates between the cells of a table
        how = replace(how, table=True, mode=how.mode or "linear")
    direct = infers(model, how)
    reports: tuple[CompileReport, ...] = ()
    sources: RuleBase | list[LookupTable]
    if not isinstance(model, RuleBase):
        sources = [model]
    elif direct:
        sources = model
    else:
        names = (how.output,) if how.output else tuple(output.name for output in model.outputs)
        # Without any output `compiled` raises a clear error.
        reports = tuple(compiled(model, name, how, progress) for name in names or (None,))
        sources = [report.table for report in reports]
    default = _DEFAULTS.get(suffix, "mixed")
    _refuse_precision(suffix, how)
    # The head states only the error in the table's lookup mode.
    proved = {
        report.table.output: fidelity.proved
        for report in reports
        for fidelity in report.fidelities
        if fidelity.mode == (how.mode or report.table.default_mode)
    }
    routines = routines_of(
        sources,
        output=how.output if direct else None,
        mode=how.mode,
        q=how.q,
        precision=how.precision or default,
        source=how.source or None,
        proved=proved,
        widened=how.precision is None,
    )
    return routines, reports


def _refuse_precision(suffix: str, how: Making) -> None:
    """Refuse a precision of a module."""
    if suffix in MODULES and how.precision not in (None, "float64"):
        floats = "the floats of its port" if suffix == ".py" else "floats of 64 bits"
        raise WordError(
            f"--precision {how.precision} does not apply: a {suffix} computes in {floats}",
            hint="leave it out",
        )


def program_of(
    controller: ControllerText, path: str | Path, how: Making, progress: Tell | None = None
) -> tuple[ExportedController, tuple[CompileReport, ...]]:
    """Return a controller as a program, not yet written, and its lookup tables."""
    from fuzzyarm.exchange.export import export_controller

    suffix = Path(path).suffix.lower()
    default = _DEFAULTS.get(suffix, "mixed")
    _refuse_precision(suffix, how)
    program, reports = controller_program(controller, how, default, progress)
    if progress is not None:
        progress("exporting")
    exported = export_controller(program, path, how.name, fmi=how.fmi, platforms=how.platforms)
    return exported, reports


def controller_program(
    controller: ControllerText, how: Making, default: str, progress: Tell | None = None
) -> tuple[ControllerProgram, tuple[CompileReport, ...]]:
    """Return a controller ready for export, and its lookup tables."""
    from fuzzyarm.exchange.export import ControllerProgram, with_tables

    reports: dict[tuple[int, str], CompileReport] = {}

    def compile_output(rulebase: RuleBase, output: str) -> LookupTable:
        report = reports[id(rulebase), output] = compiled(rulebase, output, how, progress)
        table = report.table
        return table if how.mode is None else replace(table, mode=how.mode)

    beside_rules = ""
    if how.table:
        by_rules, controller = controller, with_tables(controller, compile_output)
        beside_rules = "" if how.q is not None else _beside_rules(by_rules, how, reports)
    elif how.q is not None and not _looks_up(controller):
        raise WordError(
            f"--q {how.q} does not apply: {controller.model.name} has no table", hint="add --table"
        )
    precision, widened = how.precision or default, how.precision is None
    program = ControllerProgram(
        controller, precision, how.q, how.proofs, widened, beside_rules, how.certified
    )
    return program, tuple(reports.values())


def _looks_up(controller: ControllerText) -> bool:
    return any(
        not isinstance(sheet, RuleBase) for sheets in controller.sheets.values() for sheet in sheets
    )


def _beside_rules(
    text: ControllerText, how: Making, reports: Mapping[tuple[int, str], CompileReport]
) -> str:
    """Return the known bounds of the difference between drives from tables and from rules.

    A bound is the proved error of a table times the constant gain from there to the drive: limits
    and slews increase no difference.
    """
    errors = {
        key: fidelity.proved
        for key, report in reports.items()
        for fidelity in report.fidelities
        if fidelity.mode == (how.mode or report.table.default_mode)
    }
    within: dict[str, float] = {}
    further_up: set[str] = set()  # signals of axes that depend on rules
    index = 0
    for axes in text.model.axes:
        rules = [x for x in axes.lines if isinstance(x, SignalLine) and _is_of_rules(x)]
        for axis in axes.names:
            numbers = {
                gain.name: gain.values[index if len(gain.values) > 1 else 0].value(math.pi)
                for gain in text.model.gains
            }
            for drive in (line for line in axes.lines if isinstance(line, Drive)):
                name = drive.port if text.model.has_one_axis else f"{axis}.{drive.port}"
                within[name] = within.get(name, 0.0) + sum(
                    _difference(axes, line, drive, numbers, text.sheets, index, errors)
                    for line in rules
                )
                if any(line is drive for line in axes.moved_by(further_up)):
                    within[name] = math.inf
            own = {name for line in rules for name in line.names}
            for line in axes.moved_by(further_up | own):
                if isinstance(line, SignalLine | Zoom):
                    own |= set(line.names if isinstance(line, SignalLine) else line.signals)
            further_up |= {f"{axis}.{name}" for name in own}
            index += 1
    known = [
        f"{name} by at most {outward_text(x, up=True, digits=3)}"
        for name, x in within.items()
        if math.isfinite(x)
    ]
    if not known:
        return ""
    return (
        "difference to the controller with rules, of one period from the same signals and memory"
        f" (proved): {', '.join(known)}"
    )


def _is_of_rules(line: SignalLine) -> bool:
    return line.source is not None and line.source.kind == "rules"


def _difference(
    axes: Axes,
    line: SignalLine,
    drive: Drive,
    numbers: Mapping[str, float],
    sheets: Mapping[str, Sequence[object]],
    index: int,
    errors: Mapping[tuple[int, str], float | None],
) -> float:
    """Return the part of a line with rules in the difference of a drive; infinite if unknown."""
    assert line.source is not None
    there = sheets[line.source.name]
    rulebase = there[index if len(there) > 1 else 0]
    assert isinstance(rulebase, RuleBase)
    total = 0.0
    for name, output in zip(line.names, rulebase.outputs, strict=False):
        products = axes.gain_of(name, drive, numbers)
        error = errors.get((id(rulebase), output.name))
        clamped = all(variable.outside == "clamp" for variable in rulebase.inputs)
        if products == ():
            continue
        if products is None or error is None or not clamped:
            return math.inf
        total += abs(sum(product.value(numbers) for product in products)) * error
    return math.inf if math.isnan(total) else total
