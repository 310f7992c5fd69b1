"""A report as one page of HTML without anything from elsewhere, to be read, printed and kept."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

__all__ = ["page"]

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


def page(data: dict[str, Any]) -> str:
    """Return a report as HTML."""
    parts = [
        *_summary(data), *_made_of(data), *_functions(data), *_findings(data), *_proofs(data),
        *_coverage(data), *_sizes(data), *_rows(data), *_open(),
    ]  # fmt: skip
    title = f"Report on {data['source']['file']}"
    head = (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(title)}</title>"
        f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style></head>'
    )
    return "\n".join([head, "<body>", *parts, "</body></html>", ""])


def _summary(data: dict[str, Any]) -> list[str]:
    test, coverage = data["self_test"], data["coverage"]
    count, failed = len(test["rows"]), sum(not row["passed"] for row in test["rows"])
    errors = sum(entry["severity"] != "info" for entry in data["findings"])
    count_of_proofs = len(data["proofs"])
    proved = sum(entry["verdict"] == "proved" for entry in data["proofs"])
    claims = _verdict(proved == count_of_proofs, f"{proved} of {count_of_proofs} proved")
    return [
        f"<h1>Report on {escape(data['source']['file'])}</h1>",
        f'<p class="note">made by {escape(data["engine"])}</p>',
        _table(
            ("what", "result"),
            [
                ("self-test", _verdict(test["passed"], f"{count - failed} of {count} points pass")),
                ("statements reached by it", _share(coverage["statements"])),
                ("branches reached by it", _share(coverage["branches"])),
                ("findings", _verdict(not errors, f"{errors} errors and warnings")),
                ("statements about all points", claims if count_of_proofs else "none are made"),
            ],
        ),
    ]  # fmt: skip


def _made_of(data: dict[str, Any]) -> list[str]:
    files = [("source", data["source"]), *(("used", file) for file in data["used"]),
             *(("written", file) for file in data["written"])]  # fmt: skip
    settings = [
        (f"<code>{escape(name)}</code>", escape(_setting(x)))
        for name, x in data["settings"].items()
    ]
    return [
        "<h2>Files</h2>",
        _table(
            ("", "file", "bytes", "SHA-256"),
            [
                (word, escape(file["file"]), _number(file["bytes"]),
                 f"<code>{file['sha256']}</code>")
                for word, file in files
            ],
        ),
        "<h2>Settings of the export</h2>",
        _table(("option", "value"), settings),
    ]  # fmt: skip


def _setting(value: bool | float | str | None) -> str:
    if value is None:
        return "left to the file and the format"
    return {True: "yes", False: "no"}[value] if isinstance(value, bool) else str(value)


def _functions(data: dict[str, Any]) -> list[str]:
    lines = ["<h2>Accuracy and worst-case operations</h2>"]
    for function in data["functions"]:
        rows = [
            (f"worst error against {escape(function['against'])}",
             f"{function['worst']:.3g}, over {function['points']:,} points")
        ]  # fmt: skip
        if function["proved"] is not None:
            rows.append(("worst error against the rules", f"{function['proved']:.6g}, proved"))
        rows += [
            (f"at most: {escape(sort)}", "not bounded" if n is None else f"{n:,}")
            for sort, n in function["operations"].items()
        ]
        if function["stack"] is not None:
            rows.append(("local variables, about", f"{function['stack']:,} bytes"))
        lines += [f"<p><code>{escape(function['call'])}</code></p>", _table(("", ""), rows)]
    return lines


def _findings(data: dict[str, Any]) -> list[str]:
    rows = [
        (str(finding["line"]), escape(finding["severity"]), escape(finding["name"]),
         escape(finding["message"]))
        for finding in data["findings"]
    ]  # fmt: skip
    table = _table(("line", "severity", "finding", "message"), rows) if rows else "<p>None.</p>"
    return ["<h2>Findings of the check</h2>", table]


def _proofs(data: dict[str, Any]) -> list[str]:
    rows = [
        (escape(proof["statement"]),
         _verdict(proof["verdict"] == "proved", proof["verdict"]), escape(proof["reason"]))
        for proof in data["proofs"]
    ]  # fmt: skip
    none = "<p>The file has no <code>prove</code> line, and no certificate was given.</p>"
    table = _table(("statement about all points", "verdict", ""), rows) if rows else none
    return ["<h2>Proofs and certificates</h2>", table]


def _coverage(data: dict[str, Any]) -> list[str]:
    coverage, test = data["coverage"], data["self_test"]
    lines = [
        "<h2>Coverage of the exported code by the self-test</h2>",
        f"<p>{escape(test['compiler'])}, <code>{escape(' '.join(test['flags']))}</code>, gcov.</p>",
        _table(
            ("", "reached"),
            [("statements (lines)", _share(coverage["statements"])),
             ("branches", _share(coverage["branches"]))],
        ),
    ]  # fmt: skip
    if coverage["missed"]:
        rows = [(str(x["line"]), f"<code>{escape(x['text'])}</code>") for x in coverage["missed"]]
        lines += ["<p>Lines that no point reaches:</p>", _table(("line", "text"), rows)]
    if coverage["untaken"]:
        rows = [(str(x["line"]), f"<code>{escape(x['text'])}</code>") for x in coverage["untaken"]]
        lines += [
            "<p>Lines with an untaken branch; test or justify each of them:</p>",
            _table(("line", "text"), rows),
        ]
    return lines


def _sizes(data: dict[str, Any]) -> list[str]:
    rows = [
        (escape(size["processor"]), _number(size["flash"]), _number(size["ram"]),
         f"{escape(size['compiler'])}, <code>{escape(' '.join(size['flags']))}</code>")
        for size in data["sizes"]
    ]  # fmt: skip
    none = "<p>No cross compiler is installed.</p>"
    table = _table(("processor", "flash, bytes", "static RAM, bytes", "compiler"), rows)
    note = (
        '<p class="note">The functions alone; the arithmetic of the C library is not counted, nor'
        " the state of a controller, which the caller holds.</p>"
    )
    return ["<h2>Size</h2>", table + note if rows else none]


def _rows(data: dict[str, Any]) -> list[str]:
    rows = [
        (f"<code>{escape(row['function'])}</code>", _list(row["inputs"]),
         _list(row["expected"]), _list(row["computed"]),
         _verdict(row["passed"], "passes" if row["passed"] else "fails"))
        for row in data["self_test"]["rows"]
    ]  # fmt: skip
    tolerance = max((row["tolerance"] for row in data["self_test"]["rows"]), default=0.0)
    return [
        "<h2>Points of the self-test</h2>",
        f"<p>Expected values are those of the model in Python; a difference up to {tolerance:.3g}"
        " passes. Points of a controller are periods of one sequence.</p>",
        _table(("function", "inputs", "expected", "computed", ""), rows),
    ]


def _open() -> list[str]:
    return [
        "<h2>What this report is not</h2>",
        "<p>It is evidence about one export, made by the tool that made the export. It is not a"
        " certificate or an assessment: whether the rules are right for the plant, the compiler"
        " and processor of the product, and the code around these functions are yours to"
        " show.</p>",
    ]


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    titles = "".join(f"<th>{cell}</th>" for cell in head) if any(head) else ""
    lines = [f"<tr>{titles}</tr>"] if titles else []
    lines += [f"<tr>{''.join(_cell(cell) for cell in row)}</tr>" for row in rows]
    return f"<table>{''.join(lines)}</table>"


def _cell(text: str) -> str:
    return f"<td>{text}</td>"


def _number(value: int) -> str:
    return f"{value:,}"


def _list(numbers: Sequence[float | None]) -> str:
    return "<br>".join("none" if x is None else f"{x:.9g}" for x in numbers)


def _share(pair: Sequence[int]) -> str:
    reached, total = pair
    if not total:
        return "there are none"
    return _verdict(reached == total, f"{reached} of {total} ({100 * reached / total:.1f} %)")


def _verdict(good: bool, words: str) -> str:
    return f'<span class="{"good" if good else "bad"}">{escape(words)}</span>'
