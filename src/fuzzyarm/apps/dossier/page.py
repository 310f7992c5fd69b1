"""A report as one page of HTML without anything from elsewhere, to be read, printed and kept."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from html import escape
from typing import Any, NamedTuple

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
    """A heading, a paragraph in front, and a table; `note` replaces it where there are no rows."""

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
        yield "worst error against the rules", f"{function['proved']:.6g}, proved"
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
