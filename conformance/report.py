"""Write docs/explanation/conformance.md from the answers in `results` and the reasons in `differences.json`.

python -m conformance.report
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from conformance.run import RESULTS, TOOLS
from conformance.suite import FOLDER, Case, read_all

PAGE = FOLDER.parent / "docs" / "explanation" / "conformance.md"
DIFFERENCES = FOLDER / "differences.json"
ORDER = ("pass", "differs", "error", "cannot")
OWN = "fuzzyarm"
REASONS = {
    "setting": "a setting", "choice": "a choice of the program", "bug": "a known bug", "open": "open",
    "": "open, not looked into",
}  # fmt: skip


@dataclass(frozen=True)
class Result:
    """What one tool answered."""

    key: str
    tool: str
    version: str
    verdicts: Mapping[str, Mapping[str, Any]]

    def count(self, verdict: str, topic: str = "") -> int:
        """Return how many cases have a verdict, of one topic or of all."""
        return sum(
            v["verdict"] == verdict and topic in {"", v["topic"]} for v in self.verdicts.values()
        )


def results(folder: Path = RESULTS) -> list[Result]:
    """Return all results, fuzzyarm's first, then as the tools are listed."""
    found = {}
    for path in sorted(folder.glob("*.json")):
        data = json.loads(path.read_text(encoding="utf-8"))
        found[path.stem] = Result(path.stem, data["tool"], data["version"], data["verdicts"])
    order = [*(key for key in TOOLS if key in found), *(key for key in found if key not in TOOLS)]
    return [found[key] for key in order]


def reason(key: str, case: str, reasons: Sequence[Mapping[str, Any]]) -> Mapping[str, Any]:
    """Return why a tool differs in a case, as far as anybody knows."""
    for entry in reasons:
        if any(fnmatch(key, tool) for tool in entry["tools"]) and any(
            fnmatch(case, name) for name in entry["cases"]
        ):
            return entry
    return {"because": "", "says": ""}


def rows(cells: Iterable[Sequence[object]]) -> list[str]:
    """Return the lines of a table, the first as its head."""
    listed = [[str(cell) for cell in row] for row in cells]
    lines = ["| " + " | ".join(row) + " |" for row in listed]
    return [lines[0], "|" + "---|" * len(listed[0]), *lines[1:]]


def number(value: object) -> str:
    """Return a number as the page shows it."""
    return "none" if value is None else repr(value)


def shown(verdict: Mapping[str, Any]) -> str:
    """Return what was expected and what came, or what the tool said."""
    if verdict["verdict"] == "error":
        return "it said: " + " ".join(verdict["says"].replace("|", "\\|").split())[:110]
    point = ", ".join(f"{name} = {value}" for name, value in verdict["inputs"].items())
    return f"{point}: {number(verdict['got'])}, not {number(verdict['expected'])}"


def differing(found: Sequence[Result], reasons: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the section of one or more tools that answer alike: each reason, and what it is about."""
    groups: dict[tuple[str, str, str], list[tuple[str, str, str]]] = {}
    for result in found:
        for case, verdict in result.verdicts.items():
            if verdict["verdict"] not in {"differs", "error"}:
                continue
            entry = reason(result.key, case, reasons)
            key = (REASONS[entry["because"]], entry["says"], entry.get("thread", ""))
            groups.setdefault(key, []).append((result.tool, case, shown(verdict)))
    if not groups:
        return ["No case differs.", ""]
    lines = []
    for (because, says, thread), members in groups.items():
        cases = list(dict.fromkeys(case for _, case, _ in members))
        tools = list(dict.fromkeys(tool for tool, _, _ in members))
        link = f" ([thread]({thread}))" if thread else ""
        who = "" if len(tools) == 1 else f" Of {', '.join(tools)}."
        lines.append(f"- **{because[0].upper()}{because[1:]}.** {says}{link}{who}")
        listed = ", ".join(f"`{case}`" for case in cases[:8]) + (" …" if len(cases) > 8 else "")
        lines.append(f"  Cases: {listed}. The first: {members[0][2]}.")
    return [*lines, ""]


HEAD = """# Whose number is right

<!-- Made by `python -m conformance.report`; edit that script, not this page. -->

`conformance/` holds {cases} cases of fuzzy inference with {points} points whose results are
known: fractions, found by an evaluator in rational arithmetic that shares no code with any program here, and confirmed a
second way to 1e-13 of the range. Each program is asked as its users ask it. A case **passes** where every number
is within 1e-9 of the output's range, and where there is no number none is given. **Cannot** means that the program has
no such setting; it is no fault. [One example, four numbers](one-example-four-numbers.md) shows what such settings do.
"""


def page(
    cases: Sequence[Case], found: Sequence[Result], reasons: Sequence[Mapping[str, Any]]
) -> str:
    """Return the page."""
    points = sum(len(case.data["points"]) for case in cases)
    lines = [HEAD.format(cases=len(cases), points=points)]
    own = [result for result in found if result.key.startswith(OWN)]
    others = [result for result in found if not result.key.startswith(OWN)]
    lines += ["## fuzzyarm's own misses", "", *differing(own, reasons)]
    refused: dict[str, list[str]] = {}
    for result in own:
        for case, verdict in result.verdicts.items():
            if verdict["verdict"] == "cannot":
                refused.setdefault(f"{result.tool}: {verdict['says']}", []).append(case)
    for text, names in refused.items():
        lines.append(
            f"- {text} ({len(names)} cases: {', '.join(f'`{n}`' for n in names[:4])}{' …' if len(names) > 4 else ''})"
        )
    lines += [""] if refused else []
    lines += ["## All programs", ""]
    table: list[Sequence[object]] = [
        ("program", "version", "pass", "differ", "fail with an error", "cannot")
    ]
    table += [(r.tool, r.version, *(r.count(word) for word in ORDER)) for r in found]
    lines += [*rows(table), ""]
    topics = list(dict.fromkeys(case.topic for case in cases))
    lines += ["Cases that pass, of those that the program can be asked, by topic:", ""]
    table = [("program", *topics)]
    for result in found:
        cells = []
        for topic in topics:
            asked = sum(result.count(word, topic) for word in ("pass", "differs", "error"))
            cells.append(f"{result.count('pass', topic)} / {asked}" if asked else "")
        table.append((result.tool, *cells))
    lines += [*rows(table), ""]
    lines += ["## What differs, and why", ""]
    for result in others:
        lines += [f"### {result.tool} {result.version}", "", *differing([result], reasons)]
    lines += [TAIL]
    return "\n".join(lines)


TAIL = """## Not asked

MATLAB needs a licence, jFuzzyLogic a Java that is not among what is installed here, eFLL a board. Their settings are in
the suite, from their documentation and source, and marked as theirs (`about`); nobody ran these programs for this
page. Adding a tool (`conformance/README.md`) takes a program that reads and prints lines.

Run it again: `python -m conformance.run`, then `python -m conformance.report`.
"""


def main() -> int:
    """Write the page."""
    reasons = json.loads(DIFFERENCES.read_text(encoding="utf-8"))
    text = page(read_all(), results(), reasons)
    draft = PAGE.with_suffix(".draft")
    draft.write_text(text, encoding="utf-8")
    draft.replace(PAGE)
    print(f"{PAGE.name}: written")
    return 0


if __name__ == "__main__":
    sys.exit(main())
