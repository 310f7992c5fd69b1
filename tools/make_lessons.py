"""Make notebooks and marimo files of the lessons: `python tools/make_lessons.py DIR [PAGE…]`.

The pages in `docs/tutorial` and `docs/tutorial/controller.md` are the one definition. Prose becomes
cells of text; a file that a page names is written by a cell; a command of a console block is a cell
that runs it in the same process, so that it needs no shell; Python runs as it stands.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = [*sorted((DOCS / "tutorial").glob("[0-9]*.md")), DOCS / "tutorial" / "controller.md"]
FENCE = re.compile(r"(?ms)^(?P<indent> *)```(?P<kind>\w+)\n(?P<body>.*?)^ *```\n?")
NAMED = re.compile(r"(?:#|//|/\*) ?([\w./-]+\.(?:frb|py|csv|lut))(?: \*/)?\n")
STATUS = re.compile(r"\s+# exit status (\d+)$")

PREPARE = '''# Commands run in this process: no shell, no path.
import os
import shlex
import shutil
from pathlib import Path

try:
    from fuzzyarm import shipped
    from fuzzyarm.apps.cli import main
except ImportError:
    raise SystemExit("fuzzyarm is not installed here: pip install fuzzyarm") from None

os.environ["FUZZYARM_PROGRESS"] = "0"
if not Path("rulebases").exists():  # what comes with fuzzyarm, as pages name it
    shutil.copytree(Path(shipped("pd7.frb")).parent, "rulebases")


def run_command(line):
    """Run a command as if it were typed; say how it ended where that is not well."""
    status = main(shlex.split(line)[1:])
    if status:
        print(f"(exit status {status})")


def write_file(name, text):
    """Write a file of the lesson."""
    Path(name).parent.mkdir(parents=True, exist_ok=True)
    Path(name).write_text(text, encoding="utf-8")
    print(f"{name}: written")
'''


class Cell(NamedTuple):
    """One cell: `text`, or `code`."""

    kind: str
    body: str


def cells(page: Path) -> Iterator[Cell]:
    """Yield the cells of a page."""
    text = page.read_text(encoding="utf-8")
    yield Cell("code", PREPARE)
    files = []
    end = 0
    blocks = list(FENCE.finditer(text))
    for match in blocks:
        body = re.sub(rf"(?m)^{match['indent']}", "", match["body"])
        prose = text[end : match.start()].strip()
        end = match.end()
        if prose:
            yield Cell("text", linked(prose))
        named = NAMED.match(body)
        if match["kind"] in {"frb", "python", "csv", "lut"} and named:
            files.append(named[1])
            yield Cell("code", f"write_file({named[1]!r}, {quoted(body)})")
        elif match["kind"] == "console":
            typed = [line[2:] for line in body.splitlines() if line.startswith("$ ")]
            own = [STATUS.sub("", line) for line in typed if line.startswith("fuzzyarm ")]
            if own:
                yield Cell("code", "\n".join(f"run_command({line!r})" for line in own))
        elif match["kind"] == "python":
            yield Cell("code", body.rstrip())
        else:
            yield Cell("text", f"```{match['kind']}\n{body}```")
    rest = text[end:].strip()
    if rest:
        yield Cell("text", linked(rest))


def quoted(body: str) -> str:
    """Return a text as a literal that is readable."""
    if "'''" in body:
        return repr(body)
    return f"r'''{body}'''" if "\\" in body else f"'''\\\n{body}'''"


def linked(prose: str) -> str:
    """Return prose without links and pictures that lie beside the page."""
    prose = re.sub(r"!\[([^]]*)\]\([^)]*\)", r"*(\1)*", prose)
    return re.sub(r"\[([^]]*)\]\((?!https?:)[^)]*\)", r"\1", prose)


def notebook(page: Path) -> str:
    """Return a page as a notebook."""
    made = []
    for number, cell in enumerate(cells(page)):
        source = cell.body.splitlines(keepends=True)
        common = {"id": f"cell-{number}", "metadata": {}, "source": source}
        if cell.kind == "text":
            made.append({"cell_type": "markdown", **common})
        else:
            made.append({"cell_type": "code", "execution_count": None, "outputs": [], **common})
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    data = {
        "cells": made, "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4, "nbformat_minor": 5,
    }  # fmt: skip
    return json.dumps(data, ensure_ascii=False, indent=1) + "\n"


def marimo(page: Path) -> str:
    """Return a page as a marimo file.

    Cells of marimo run when the names that they take are there: each step gives one to the next, so
    that they run in the order of the page. All other names are a cell's own.
    """
    first, *others = cells(page)
    parts = ["import marimo", "", "app = marimo.App()", "", ""]
    parts += ["@app.cell", "def _():", indented(first.body), "    step_0 = True", ""]
    parts += ["    return run_command, step_0, write_file", "", ""]
    parts += ["@app.cell", "def _():", "    import marimo as mo", "", "    return (mo,)", "", ""]
    step = 0
    for cell in others:
        if cell.kind == "text":
            parts += ["@app.cell(hide_code=True)", "def _(mo):", f"    mo.md({cell.body!r})"]
            parts += ["    return", "", ""]
            continue
        step += 1
        calls = re.match(r"(run_command|write_file)\(", cell.body)
        body = cell.body if calls else f"def _block():\n{indented(cell.body)}\n\n_block()"
        taken = sorted({f"step_{step - 1}", *([calls[1]] if calls else [])})
        parts += ["@app.cell", f"def _({', '.join(taken)}):", indented(body)]
        parts += [f"    step_{step} = step_{step - 1}", f"    return (step_{step},)", "", ""]
    return "\n".join([*parts, 'if __name__ == "__main__":', "    app.run()", ""])


def indented(body: str) -> str:
    """Return code one level deeper; the lines of a literal stay where they are."""
    lines, inside = [], False
    for line in body.splitlines():
        lines.append(line if inside or not line else f"    {line}")
        inside ^= line.count("'''") % 2 == 1
    return "\n".join(lines)


def main(words: list[str]) -> int:
    """Write both kinds of every page, or of those that are named."""
    if not words:
        print(__doc__.splitlines()[0], file=sys.stderr)
        return 2
    target = Path(words[0])
    chosen = [page for page in PAGES if not words[1:] or page.stem in words[1:]]
    if not chosen:
        known = ", ".join(page.stem for page in PAGES)
        print(f"no such page: {' '.join(words[1:])}; there are {known}", file=sys.stderr)
        return 1
    if target.exists() and not target.is_dir():
        print(f"{target} is not a folder", file=sys.stderr)
        return 1
    target.mkdir(parents=True, exist_ok=True)
    for page in chosen:
        (target / f"{page.stem}.ipynb").write_text(notebook(page), encoding="utf-8")
        (target / f"{page.stem.replace('-', '_')}.py").write_text(marimo(page), encoding="utf-8")
    print(f"{target}: {len(chosen)} lessons, each as .ipynb and as .py for marimo")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
