"""Exports of the present text: the bytes of the commands, for download.

Each has the bytes of `fuzzyarm compile`, `convert` or `plot` for the same text.
Files of a controller are read as saved, and only from the folder.
"""

from __future__ import annotations

import contextlib
import sys
import tempfile
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.designer.forms import PICTURES, export_form
from fuzzyarm.apps.designer.grounds import FieldError, form_of
from fuzzyarm.apps.designer.messages import FormField
from fuzzyarm.apps.designer.names import clean_name, in_words
from fuzzyarm.apps.designer.requests import ExportWork, FormValues
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.apps.show.compiled import controller_lines, export_lines, report_lines, table_words
from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.folders import EXPORTS, FOREIGN, NETWORK
from fuzzyarm.base.protected import marked
from fuzzyarm.exchange.compiled import Making, compiled, making_of, program_of, source_of
from fuzzyarm.exchange.formats.conversion import converted, findings_of
from fuzzyarm.exchange.formats.findings import Imported
from fuzzyarm.language.edit import Reading
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.requests.fields import RequestError
from fuzzyarm.requests.making import ExportRequest
from fuzzyarm.table import SUFFIXES as TABLES
from fuzzyarm.table import LookupTable
from fuzzyarm.table.files import LATEX, table_as

if TYPE_CHECKING:
    from fuzzyarm.apps.designer.jobs import WindowJob
    from fuzzyarm.control.controllers.text import ControllerText

Sheet = RuleBase | LookupTable

PART: FormField = {
    "name": "what",
    "title": "What",
    "description": "what of the rule base is drawn",
    "type": "string",
    "enum": ["all", "terms", "surface"],
    "default": "all",
}
"""Part of a rule base to draw, as in ``fuzzyarm plot --what``."""
WAY: FormField = {
    "name": "way",
    "title": "Computed from",
    "description": "the rules have their exact values; a table of them is looked up in fewer steps",
    "type": "string",
    "enum": ["rules", "table"],
    "default": "rules",
}
"""Basis of a program: ``--direct`` or ``--table`` of ``fuzzyarm compile``."""
LOSSY: FormField = {
    "name": "lossy",
    "title": "Lossy",
    "description": "write what the format can say, and report the differences",
    "type": "boolean",
    "default": False,
}
"""Whether losses are accepted, as ``fuzzyarm convert --lossy`` does."""
IN_PAGE = sys.platform == "emscripten"
OF_MACHINE = frozenset({".fmu", NETWORK, ".npz", *PICTURES})
"""Made by a C compiler, NumPy, Matplotlib or onnx: a page with its own Python does not offer it."""

WRITTEN_TABLES = (*TABLES, LATEX)

_SOURCES = tuple(suffix for suffix in EXPORTS if suffix != ".js")
"""Source text; a module of JavaScript is an ``.mjs``, which node and servers know by its suffix."""

_DRAWING = threading.Lock()
"""Figures are drawn one at a time: matplotlib's settings are global."""


class ExportRefusedError(FuzzyarmError, ValueError):
    """A text cannot be exported in this form."""


@dataclass(frozen=True)
class Offered:
    """A file for download."""

    name: str
    content: bytes


def model_of(session: Session) -> Any:
    """Return the rule base, controller or table in a text."""
    parsed = session.reading.parsed
    mistakes = [diagnostic for diagnostic in parsed.diagnostics if diagnostic.is_error]
    if mistakes:
        raise ExportRefusedError(f"the text has mistakes: {in_words(RuleBaseError(mistakes[:1]))}")
    if not isinstance(session.reading, Reading):
        return LookupTable.from_plain(parsed.table)
    if parsed.controller is not None:
        return _controller(session)
    if parsed.rulebase is None:
        raise ExportRefusedError("the text has no rules yet")
    return parsed.rulebase


def _controller(session: Session) -> ControllerText:
    """Return a controller with its files."""
    from fuzzyarm.control.controllers.text import home_of, with_files

    model = session.reading.parsed.controller
    text, faults = with_files(model, home_of(session.path), session.path)
    if faults:
        raise ExportRefusedError(in_words(RuleBaseError(faults)))
    return text


def kinds_of(session: Session) -> list[str]:
    """Return the export suffixes of a text; a page has no compiler."""
    kinds = _kinds(session)
    return [each for each in kinds if each not in OF_MACHINE] if IN_PAGE else kinds


def _kinds(session: Session) -> list[str]:
    if not isinstance(session.reading, Reading):
        return [*_SOURCES, ".csv", LATEX, ".json", ".npz", ".png", ".svg"]
    if session.reading.parsed.controller is not None:
        return [suffix for suffix in _SOURCES if suffix != NETWORK]
    tables = (".lut", ".csv", LATEX)
    return [*_SOURCES, *tables, ".png", ".svg", *FOREIGN]


def forms_of(session: Session) -> dict[str, list[FormField]]:
    """Return the fields of the form of each export, by suffix."""
    if not isinstance(session.reading, Reading):
        kind = "table"
    else:
        kind = "rules" if session.reading.parsed.controller is None else "controller"
    return {
        suffix: [
            *([WAY] if suffix in EXPORTS and suffix != NETWORK and kind != "table" else []),
            *export_form(suffix, kind).fields(),
            *([PART] if suffix in PICTURES and kind == "rules" else []),
            *([LOSSY] if suffix in FOREIGN else []),
        ]
        for suffix in kinds_of(session)
    }


def export(session: Session, request: ExportWork, job: WindowJob) -> None:
    """Make files and report on them; a page loads them by their addresses."""
    files, lines, is_table = files_of(session, request.suffix, request.options, job.progress)
    job.check()
    offered = [
        {"name": file.name, "bytes": len(file.content), "href": job.offer(file.name, file.content)}
        for file in files
    ]
    job.tell({"files": offered, "lines": lines, "measured": is_table})


def files_of(
    session: Session, suffix: str, options: FormValues, progress: Callable[[str], None]
) -> tuple[list[Offered], list[str], bool]:
    """Return the files of an export, its report, and whether that has the errors of new tables."""
    if suffix not in kinds_of(session):
        raise ExportRefusedError(f"{Path(session.path).name} is not exported as {suffix}")
    model = model_of(session)
    out = clean_name(Path(session.path).name, suffix)
    how = making_on_page(session, options)
    if isinstance(model, RuleBase | LookupTable):
        return _sheet(session, model, out, how, options, progress)
    # The header comment quotes its source from the file, here the current text.
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as folder:
        path = Path(folder) / Path(session.path).name
        path.write_bytes(_content(session))
        program, reports = program_of(replace(model, path=str(path)), out, how, progress)
        files = [_offered(path.name, content) for path, content in program.files]
        lines = [line for report in reports for line in report_lines(report, out)]
        return files, [*lines, *controller_lines(program)], bool(reports)


def _content(session: Session) -> bytes:
    """Return the bytes of a text: those of the file, line ends included, if it is saved."""
    with contextlib.suppress(OSError, UnicodeDecodeError):
        data = Path(session.path).read_bytes()
        if data.decode("utf-8-sig").replace("\r\n", "\n") == session.text:
            return data
    return session.text.encode()


def making_on_page(session: Session, options: FormValues) -> Making:
    """Return the options of a dialog; an empty field counts as absent."""
    way = options.get("way")
    if way not in (None, *WAY["enum"]):
        raise FieldError(f"'{str(way)[:40]}' is not one of rules, table", field="way")
    # `direct` is not for controllers: their rule bases are inferred unless tables are requested.
    values = {**options, "direct": way == "rules", "table": way == "table"}
    request = form_of(ExportRequest, **{**values, "file": Path(session.path).name})
    try:
        return making_of(request)
    except RequestError as error:
        # The dialog shows it beside the field at fault.
        raise FieldError(error.message, field=error.field, hint=error.hint) from error


def _sheet(
    session: Session,
    model: Sheet,
    out: str,
    how: Making,
    options: FormValues,
    progress: Callable[[str], None],
) -> tuple[list[Offered], list[str], bool]:
    suffix = Path(out).suffix
    if suffix in EXPORTS:
        exported, reports = source_of(model, out, how, progress)
        lines = [line for report in reports for line in report_lines(report, out)]
        files = [_offered(path.name, text) for path, text in exported.files]
        return files, [*lines, *export_lines(exported)], bool(reports)
    if suffix in PICTURES:
        return [Offered(out, _picture(model, suffix, how, options))], [], False
    if suffix in WRITTEN_TABLES:
        files, lines = _table(model, out, how, progress)
        return files, lines, isinstance(model, RuleBase)
    assert isinstance(model, RuleBase)
    return *_conversion(session, model, out, lossy=options.get("lossy") is True), False


def _table(
    model: Sheet, out: str, how: Making, progress: Callable[[str], None]
) -> tuple[list[Offered], list[str]]:
    suffix = Path(out).suffix
    if isinstance(model, LookupTable):
        return [_offered(out, table_as(model, suffix))], [table_words(model, out)]
    report = compiled(model, how.output, how, progress)
    return [_offered(out, table_as(report.table, suffix))], report_lines(report, out)


def _picture(model: Sheet, suffix: str, how: Making, options: FormValues) -> bytes:
    from fuzzyarm.apps.show.figures.whole import model_figure
    from fuzzyarm.base.figure_files import figure_bytes

    what = str(options.get("what") or "all")
    if what not in ("all", "terms", "surface"):
        raise ExportRefusedError(f"'{what[:40]}' is not one of all, terms, surface")
    with _DRAWING:
        return figure_bytes(model_figure(model, what, how.output), suffix)


def _conversion(
    session: Session, model: RuleBase, out: str, *, lossy: bool
) -> tuple[list[Offered], list[str]]:
    exported = converted(model, session.path, Path(out).suffix, session.text, lossy=lossy)
    diagnostics = findings_of(Imported(model, (), "fuzzyarm"), exported, session.path)
    diagnostics.sort(key=lambda diagnostic: not diagnostic.is_error)  # errors first
    lines = [in_words(RuleBaseError([diagnostic])) for diagnostic in diagnostics]
    if exported.text is None:
        raise ExportRefusedError("; ".join(lines))
    return [_offered(out, exported.text)], lines


def _offered(name: str, content: str | bytes) -> Offered:
    return Offered(name, marked(name, content.encode() if isinstance(content, str) else content))
