"""The contents of a report: the inputs of an export, and everything known about it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.dossier.page import page
from fuzzyarm.apps.dossier.trial import ExportSize, ExportTrial, sizes, tried
from fuzzyarm.base.files import write_folder
from fuzzyarm.base.jsonable import entry, json_properties, jsonable
from fuzzyarm.exchange.export import Exported, ExportedController
from fuzzyarm.exchange.export.write import ExportedFunction
from fuzzyarm.exchange.files import check_file
from fuzzyarm.version import __version__

if TYPE_CHECKING:
    from fuzzyarm.base.diagnostic import Diagnostic
    from fuzzyarm.exchange.compiled import Making
    from fuzzyarm.proof.map.verdicts import Verdict

_BUDGET = 60.0
"""Seconds for each `prove` line."""


@dataclass(frozen=True)
class ReportedFile:
    """A file."""

    file: str = entry("its name")
    sha256: str = entry("of its bytes")
    bytes: int = entry("how many")


@json_properties(
    "format engine source used settings written functions findings proofs self_test coverage sizes"
)
@dataclass(frozen=True)
class ExportReport:
    """A report on an export."""

    source: ReportedFile = entry("the exported file")
    used: list[ReportedFile] = entry("files that it reads")
    settings: Mapping[str, Any] = entry("every option of the export")
    written: list[ReportedFile] = entry("the export")
    functions: list[ExportedFunction] = entry(
        "in order", "call worst against points proved operations stack"
    )
    findings: Sequence[Diagnostic] = entry("of the check", "name severity message line")
    proofs: list[Verdict] = entry("by `prove` lines and certificates", "statement verdict reason")
    self_test: ExportTrial = entry("the self-test", "compiler flags passed rows")
    coverage: ExportTrial = entry(
        "of the exported code by the self-test", "statements branches missed untaken"
    )
    sizes: list[ExportSize] = entry("by the cross compilers that are installed")
    format: int = entry("of this description", default=1)
    engine: str = entry("which fuzzyarm", default=f"fuzzyarm {__version__}")


def write_report(folder: str | Path, report: ExportReport) -> None:
    """Write ``report.html`` and ``report.json``, both or neither.

    Parameters
    ----------
    folder : path-like
        Where; new, empty, or of an earlier report.
    report : ExportReport
        As `report_of` gives it.

    Raises
    ------
    ForeignFolderError
        If the folder has files of others.
    """
    data = jsonable(report)
    text = json.dumps(data, indent=2, allow_nan=False) + "\n"
    write_folder(folder, {"report.html": page(data), "report.json": text})


def report_of(file: str, how: Making, exported: Exported | ExportedController) -> ExportReport:
    """Return a report on an export.

    Parameters
    ----------
    file : str
        Source of the export.
    how : Making
        The settings.
    exported : Exported or ExportedController
        A ``.c`` and its ``.h``, written or not.

    Raises
    ------
    FuzzyarmError
        If no gcc is here.
    """
    from fuzzyarm.proof.map.verdicts import Verdict, prove_all

    trial = tried(exported)
    review = check_file(file)
    proofs = prove_all(review.rulebase, budget=_BUDGET) if review.rulebase is not None else ()
    certified = [
        Verdict(statement=words, verdict="proved", reason="certificate") for words in how.proofs
    ]
    return ExportReport(
        _file(Path(file)),
        [_file(path) for path in _used(exported) if path.resolve() != Path(file).resolve()],
        _settings(how),
        [_reported(path, str(text).encode()) for path, text in exported.files],
        _functions(exported),
        review.diagnostics,
        [*proofs, *certified],
        trial,
        trial,
        sizes(exported),
    )


def _file(path: Path) -> ReportedFile:
    return _reported(path, path.read_bytes())


def _reported(path: Path, content: bytes) -> ReportedFile:
    return ReportedFile(path.name, hashlib.sha256(content).hexdigest(), len(content))


def _used(exported: Exported | ExportedController) -> list[Path]:
    """Return the files that a controller reads."""
    from fuzzyarm.control.controllers.text import home_of, sheet_path

    if isinstance(exported, Exported):
        return []
    text = exported.program.text
    folder = home_of(text.path)
    return [sheet_path(file, folder) for use in text.model.uses for file in use.files]


def _settings(how: Making) -> dict[str, Any]:
    """Return every option, those that were left to the file as well."""
    plain = asdict(replace(how, certified=None))
    settings = {
        name: value if isinstance(value, bool | int | float | str | None) else str(value)
        for name, value in plain.items()
        if name not in ("source", "proofs", "certified")
    }
    if how.certified is not None:
        settings["guard"] = f"certificate {how.certified.certificate.seal}"
    return settings


def _functions(exported: Exported | ExportedController) -> list[ExportedFunction]:
    if isinstance(exported, Exported):
        return exported.functions
    from fuzzyarm.exchange.export.cost import step_cost

    program = exported.program
    operations = step_cost(program.text).exported
    worst, points = program.tried.worst, len(program.tried.vectors.expected)
    against = "the controller in double precision"
    total = {"of a period": operations.total() if operations else None}
    return [ExportedFunction(exported.calls[1], worst, points, against, None, total, None)]
