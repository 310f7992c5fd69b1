"""The contents of a report: the inputs of an export, and everything known about it."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.dossier.page import page
from fuzzyarm.apps.dossier.trial import ExportTrial, sizes, tried
from fuzzyarm.base.files import write_folder
from fuzzyarm.exchange.export import Exported, ExportedController
from fuzzyarm.exchange.export.table import TableRoutine
from fuzzyarm.exchange.files import check_file
from fuzzyarm.version import __version__

if TYPE_CHECKING:
    from fuzzyarm.exchange.compiled import Making
    from fuzzyarm.language.model.rulebase import RuleBase

__all__ = ["report_of", "write_report"]

_BUDGET = 60.0
"""Seconds for each `prove` line."""


def write_report(folder: str | Path, report: dict[str, Any]) -> None:
    """Write ``report.html`` and ``report.json``, both or neither.

    Parameters
    ----------
    folder : path-like
        Where; new, empty, or of an earlier report.
    report : dict
        As `report_of` gives it.

    Raises
    ------
    ForeignFolderError
        If the folder holds what is somebody else's.
    """
    text = json.dumps(report, indent=2, allow_nan=False) + "\n"
    write_folder(folder, {"report.html": page(report), "report.json": text})


def report_of(file: str, how: Making, exported: Exported | ExportedController) -> dict[str, Any]:
    """Return a report as plain data; ``docs/schemas/compile-report.json`` describes it.

    Parameters
    ----------
    file : str
        What the export was made of.
    how : Making
        The settings.
    exported : Exported or ExportedController
        A ``.c`` and its ``.h``, written or not.

    Raises
    ------
    FuzzyarmError
        If no gcc is here.
    """
    trial = tried(exported)
    review = check_file(file)
    return {
        "format": 1,
        "engine": f"fuzzyarm {__version__}",
        "source": _file(Path(file)),
        "used": [_file(path) for path in _used(exported) if path.resolve() != Path(file).resolve()],
        "settings": _settings(how),
        "written": [
            {"file": path.name, "sha256": _hash(str(text).encode()), "bytes": len(str(text))}
            for path, text in exported.files
        ],
        "functions": _functions(exported),
        "findings": [
            {"name": finding.name, "severity": str(finding.severity), "message": finding.message,
             "line": finding.span.line}
            for finding in review.diagnostics
        ],
        "proofs": [*_proofs(review.rulebase), *_claimed(how)],
        "self_test": _self_test(trial),
        "coverage": {
            "statements": list(trial.statements),
            "branches": list(trial.branches),
            "missed": [{"line": line, "text": text} for line, text in trial.missed],
            "untaken": [{"line": line, "text": text} for line, text in trial.untaken],
        },
        "sizes": sizes(exported),
    }  # fmt: skip


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _file(path: Path) -> dict[str, Any]:
    content = path.read_bytes()
    return {"file": path.name, "sha256": _hash(content), "bytes": len(content)}


def _used(exported: Exported | ExportedController) -> list[Path]:
    """Return the files that a controller reads."""
    from fuzzyarm.control.controllers.text import sheet_path

    if isinstance(exported, Exported):
        return []
    text = exported.program.text
    folder = Path(text.path).parent
    return [sheet_path(file, folder) for use in text.model.uses for file in use.files]


def _settings(how: Making) -> dict[str, Any]:
    """Return every option, those that were left to the file as well."""
    plain = asdict(how)
    return {
        name: value if isinstance(value, bool | int | float | str | None) else str(value)
        for name, value in plain.items()
        if name not in ("source", "proofs")
    }


def _functions(exported: Exported | ExportedController) -> list[dict[str, Any]]:
    if isinstance(exported, ExportedController):
        from fuzzyarm.exchange.export.cost import step_cost

        program = exported.program
        operations = step_cost(program.text).exported
        return [
            {
                "call": exported.calls[1], "worst": program.tried.worst,
                "against": "the controller in double precision",
                "points": len(program.tried.vectors.expected), "proved": None,
                "operations": {"of a period": operations and operations.total()},
                "stack": None,
            }
        ]  # fmt: skip
    return [
        {
            "call": call, "worst": routine.accuracy.worst, "against": routine.accuracy.against,
            "points": routine.accuracy.points,
            "proved": routine.worst_proved() if isinstance(routine, TableRoutine) else None,
            "operations": routine.cost().by_sort(), "stack": routine.cost().stack,
        }
        for call, routine in zip(exported.calls, exported.routines, strict=True)
    ]  # fmt: skip


def _proofs(rulebase: RuleBase | None) -> list[dict[str, Any]]:
    """Judge the `prove` lines of a rule base."""
    from fuzzyarm.proof.map.verdicts import prove_all

    if rulebase is None:
        return []
    return [
        {"statement": verdict.statement, "verdict": verdict.verdict, "reason": verdict.reason}
        for verdict in prove_all(rulebase, budget=_BUDGET)
    ]


def _claimed(how: Making) -> list[dict[str, Any]]:
    """Return what a certificate proves of a controller."""
    return [{"statement": words, "verdict": "proved", "reason": "certificate"}
            for words in how.proofs]  # fmt: skip


def _self_test(trial: ExportTrial) -> Mapping[str, Any]:
    return {
        "compiler": trial.compiler,
        "flags": list(trial.flags),
        "passed": all(row.passed for row in trial.rows),
        "rows": [
            {
                "function": row.function, "inputs": _finite(row.inputs),
                "expected": _finite(row.expected), "computed": _finite(row.computed),
                "tolerance": row.tolerance, "passed": row.passed,
            }
            for row in trial.rows
        ],
    }  # fmt: skip


def _finite(numbers: tuple[float, ...]) -> list[float | None]:
    """Return numbers as JSON has them: what is not a number is null."""
    return [x if math.isfinite(x) else None for x in numbers]
