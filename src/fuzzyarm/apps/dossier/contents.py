"""A report: the inputs of an export, everything known about it, and its page of HTML.

The page is self-contained, for printing and archiving.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fuzzyarm.apps.dossier.trial import ExportSize, ExportTrial, sizes, tried
from fuzzyarm.base.files import write_folder
from fuzzyarm.base.jsonable import entry, json_properties, jsonable
from fuzzyarm.base.numbers import outward_text
from fuzzyarm.exchange.export import Exported, ExportedController
from fuzzyarm.exchange.export.write import ExportedFunction
from fuzzyarm.exchange.files import check_file
from fuzzyarm.version import __version__

if TYPE_CHECKING:
    from fuzzyarm.base.diagnostic import Diagnostic
    from fuzzyarm.exchange.compiled import Making
    from fuzzyarm.proof.map.verdicts import Verdict

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #1b1b1b; max-width: 62rem; margin: 2rem auto;
       padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
table { border-collapse: collapse; width: 100%; margin: .6rem 0; }
th, td { border: 1px solid #c8c8c8; padding: .25rem .5rem; text-align: left; vertical-align: top; }
th { background: #f1f1f1; } td.n { text-align: right; font-variant-numeric: tabular-nums; }
code { font: 13px/1.4 ui-monospace, monospace; overflow-wrap: anywhere; }
.good { color: #0a6b2d; font-weight: 600; } .bad { color: #a40000; font-weight: 600; }
.note { color: #555; }
@media print {
  body { max-width: none; margin: 0; } h2 { break-after: avoid; } tr { break-inside: avoid; }
}
"""


class _Section(NamedTuple):
    """A heading, an introduction, and a table; `note` replaces a table without rows."""

    title: str
    note: str = ""
    head: Sequence[str] = ()
    rows: Iterable[Sequence[str]] = ()


def page(data: dict[str, Any]) -> str:
    """Return a report as HTML."""
    file = escape(data["source"]["file"])
    parts = [
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<title>Report on {file}</title><meta name="viewport" content="width=device-width">'
        f"<style>{_STYLE}</style></head>",
        f"<body><h1>Report on {file}</h1>",
        f'<p class="note">made by {escape(data["engine"])}</p>',
        _table(("what", "result"), _summary(data)),
    ]
    for title, note, head, rows in _sections(data):
        parts.append(f"<h2>{title}</h2>" if title else "")
        parts.append(f"<p>{note}</p>" if note else "")
        parts.append(_table(head, rows))
    return "\n".join([*filter(None, parts), "</body></html>", ""])


def _summary(data: dict[str, Any]) -> Iterator[Sequence[str]]:
    rows, proofs = data["self_test"]["rows"], data["proofs"]
    passed = sum(row["passed"] for row in rows)
    proved = sum(proof["verdict"] == "proved" for proof in proofs)
    errors = sum(finding["severity"] != "info" for finding in data["findings"])
    claims = _verdict(proved == len(proofs), f"{proved} of {len(proofs)} proved")
    yield "self-test", _verdict(passed == len(rows), f"{passed} of {len(rows)} points pass")
    yield "statements reached by it", _share(data["coverage"]["statements"])
    yield "branches reached by it", _share(data["coverage"]["branches"])
    yield "findings", _verdict(not errors, f"{errors} errors and warnings")
    yield "statements about all points", claims if proofs else "none are made"


def _sections(data: dict[str, Any]) -> Iterator[_Section]:
    test, coverage = data["self_test"], data["coverage"]
    files = [("source", data["source"]), *(("used", file) for file in data["used"]),
             *(("written", file) for file in data["written"])]  # fmt: skip
    yield _Section(
        "Files", "", ("", "file", "bytes", "SHA-256"),
        [(word, escape(file["file"]), f"{file['bytes']:,}", _code(file["sha256"]))
         for word, file in files],
    )  # fmt: skip
    yield _Section(
        "Settings of the export", "", ("option", "value"),
        [(_code(name), escape(_setting(value))) for name, value in data["settings"].items()],
    )  # fmt: skip
    yield _Section("Accuracy and worst-case operations")
    for function in data["functions"]:
        yield _Section("", _code(function["call"]), ("", ""), _figures_of(function))
    findings = data["findings"]
    yield _Section(
        "Findings of the check", "" if findings else "None.",
        ("line", "severity", "finding", "message"),
        [(str(each["line"]), *(escape(each[key]) for key in ("severity", "name", "message")))
         for each in findings],
    )  # fmt: skip
    proofs = data["proofs"]
    yield _Section(
        "Proofs and certificates",
        "" if proofs else "The file has no <code>prove</code> line, and no certificate was given.",
        ("statement about all points", "verdict", ""),
        [(escape(each["statement"]), _verdict(each["verdict"] == "proved", each["verdict"]),
          escape(each["reason"])) for each in proofs],
    )  # fmt: skip
    yield _Section(
        "Coverage of the exported code by the self-test",
        f"{escape(test['compiler'])}, {_code(' '.join(test['flags']))}, gcov.",
        ("", "reached"),
        [("statements (lines)", _share(coverage["statements"])),
         ("branches", _share(coverage["branches"]))],
    )  # fmt: skip
    for key, note in (
        ("missed", "Lines that no point reaches:"),
        ("untaken", "Lines with an untaken branch; test or justify each of them:"),
    ):
        if coverage[key]:
            rows = [(str(line["line"]), _code(line["text"])) for line in coverage[key]]
            yield _Section("", note, ("line", "text"), rows)
    sizes = data["sizes"]
    yield _Section(
        "Size",
        "The functions alone; the arithmetic of the C library is not counted, nor the state of a"
        " controller, which the caller holds." if sizes else "No cross compiler is installed.",
        ("processor", "flash, bytes", "static RAM, bytes", "compiler"),
        [(escape(each["processor"]), f"{each['flash']:,}", f"{each['ram']:,}",
          f"{escape(each['compiler'])}, {_code(' '.join(each['flags']))}") for each in sizes],
    )  # fmt: skip
    tolerance = max((row["tolerance"] for row in test["rows"]), default=0.0)
    yield _Section(
        "Points of the self-test",
        f"Expected values are those of the model in Python; a difference up to {tolerance:.3g}"
        " passes. Points of a controller are periods of one sequence.",
        ("function", "inputs", "expected", "computed", ""),
        [(_code(row["function"]), *(_list(row[key]) for key in ("inputs", "expected", "computed")),
          _verdict(row["passed"], "passes" if row["passed"] else "fails")) for row in test["rows"]],
    )  # fmt: skip
    yield _Section(
        "What this report is not",
        "It is evidence about one export, made by the tool that made the export. It is not a"
        " certificate or an assessment: whether the rules are right for the plant, the compiler"
        " and processor of the product, and the code around these functions are yours to show.",
    )


def _figures_of(function: dict[str, Any]) -> Iterator[Sequence[str]]:
    worst = f"{function['worst']:.3g}, over {function['points']:,} points"
    yield f"worst error against {escape(function['against'])}", worst
    if function["proved"] is not None:
        worst = outward_text(function["proved"], up=True, digits=6)
        yield "worst error against the rules", f"{worst}, proved"
    for sort, count in function["operations"].items():
        yield f"at most: {escape(sort)}", "not bounded" if count is None else f"{count:,}"
    if function["stack"] is not None:
        yield "local variables, about", f"{function['stack']:,} bytes"


def _setting(value: bool | float | str | None) -> str:
    if value is None:
        return "left to the file and the format"
    return {True: "yes", False: "no"}[value] if isinstance(value, bool) else str(value)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = ["".join(f"<td>{cell}</td>" for cell in row) for row in rows]
    if not lines:
        return ""
    titles = ["".join(f"<th>{cell}</th>" for cell in head)] if any(head) else []
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in (*titles, *lines))}</table>"


def _code(text: str) -> str:
    return f"<code>{escape(text)}</code>"


def _list(numbers: Sequence[float | None]) -> str:
    return "<br>".join("none" if x is None else f"{x:.9g}" for x in numbers)


def _share(pair: Sequence[int]) -> str:
    reached, total = pair
    if not total:
        return "there are none"
    return _verdict(reached == total, f"{reached} of {total} ({100 * reached / total:.1f} %)")


def _verdict(good: bool, words: str) -> str:
    return f'<span class="{"good" if good else "bad"}">{escape(words)}</span>'


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
        The result of `report_of`.

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
    """Return every option, defaults of the file included."""
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
