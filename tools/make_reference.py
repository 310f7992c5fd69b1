"""The pages that are read from the program itself: commands, metrics and the Python API.

    python tools/make_reference.py    # writes commands.md, metrics.md, formats.md and api.md
    # in docs/reference

These are kept with the others, so that they can be read without building the site;
`tests/docs/test_site.py` holds them to the program. The pages of each package are written into
``docs/api`` at each build (``conf.py``) and not kept.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
import shutil
from collections.abc import Iterator
from dataclasses import fields
from itertools import groupby
from pathlib import Path
from types import ModuleType

import fuzzyarm
from fuzzyarm.apps.cli.command import Argument, Command
from fuzzyarm.apps.cli.main import COMMANDS, HEADINGS, find_command
from fuzzyarm.base.files import write_atomically
from fuzzyarm.control.loop.metrics import FORMULAS, Metrics
from fuzzyarm.learning.tuning.cost import ERRORS
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SHAPES, SNORMS, TNORMS

REFERENCE = Path(__file__).parents[1] / "docs" / "reference"

# --- Commands ---

_HEAD = """\
# Commands

`fuzzyarm --help` lists them, `fuzzyarm COMMAND --help` prints what stands here. This page is
written from the parser of the commands by `tools/make_reference.py`.

Exit status: 0 fine, 1 the input is at fault, 2 wrong usage (a number of the command line that is
out of range among it), 3 a run diverged, 4 a proof stayed undecided, 130 interrupted. Wherever
it is not 0, a sentence on the standard error says why; what takes longer than 1.5 s says there
what it does (`FUZZYARM_PROGRESS=0`: it does not).

No command replaces a file that fuzzyarm did not write, unless `--force`, an option of every
command, is given. What fuzzyarm writes is marked: by a line `Written by fuzzyarm` where the format
has comments. Remove the line to keep the file.

`fuzzyarm --version` prints the version, `fuzzyarm --print-completion bash` (or `zsh`, `tcsh`) a
script for [completion](../howto/install.md#completion).
"""


def commands_page() -> str:
    """Return the page of all commands as Markdown."""
    parts = [_HEAD]
    for name, (_, summary) in COMMANDS.items():
        if name in HEADINGS:
            parts.append(f"## {HEADINGS[name]}\n")
        parts += [f"### {name}\n", *_command_parts(find_command(name), summary)]
    return "\n".join(parts)


def _command_parts(command: Command, summary: str) -> Iterator[str]:
    yield f"```text\nfuzzyarm {command.name} {_usage(command.arguments)}".rstrip() + "\n```\n"
    yield _description(command.description or f"{summary[0].upper()}{summary[1:]}.")
    ordered = sorted(command.arguments, key=lambda each: bool(each.group))
    for title, arguments in groupby(ordered, key=lambda each: each.group):
        if title:
            yield f"*{title[0].upper()}{title[1:]}*\n"
        yield "| argument | meaning |\n|---|---|"
        yield "\n".join(f"| {_names(each)} | {_said(each)} |" for each in arguments) + "\n"


def _usage(arguments: object) -> str:
    """Return the words in which nothing may be left out; the tables have the others."""
    words = []
    for each in arguments:  # type: ignore[attr-defined]
        if not each.names[0].startswith("-"):
            words.append(_positional(each))
        elif each.options.get("required"):
            words.append(f"{each.names[0]} {each.options['metavar']}")
    return " ".join([*words, "[options]"])


def _positional(each: Argument) -> str:
    name = _metavar(each) or each.names[0].upper()
    return {"+": f"{name} …", "*": f"[{name} …]", "?": f"[{name}]"}.get(
        str(each.options.get("nargs")), name
    )


def _description(text: str) -> str:
    """Return a help text as Markdown: its examples, which are indented, as blocks."""
    text = re.sub(r"(?m)^Examples\n-+\n", "", text.strip())
    parts = []
    for paragraph in text.split("\n\n"):
        if paragraph.startswith("  "):
            parts.append(f"```text\n{inspect.cleandoc(paragraph)}\n```")
        else:
            parts.append(_escaped(paragraph))
    return "\n\n".join(parts) + "\n"


def _names(each: Argument) -> str:
    values = _metavar(each)
    if not each.names[0].startswith("-"):
        return f"`{_positional(each)}`"
    return ", ".join(f"`{name} {values}".rstrip() + "`" for name in each.names)


def _metavar(each: Argument) -> str:
    given = each.options.get("metavar", "")
    return " ".join(given) if isinstance(given, tuple) else str(given)


def _said(each: Argument) -> str:
    said = (each.options.get("help") or "").replace("%%", "%")
    choices = each.options.get("choices")
    listed = ", ".join(f"`{choice}`" for choice in choices) if choices else ""
    return _escaped(f"{said}: " if said and listed else said).replace("|", "\\|") + listed


def _escaped(text: str) -> str:
    """Return a text in which stars, brackets and options stand for themselves in Markdown."""
    pieces = re.split(r"(`[^`]*`)", text)
    for index in range(0, len(pieces), 2):
        piece = re.sub(r"(?<![\w-])(--?[a-zA-Z][\w-]*)", r"`\1`", pieces[index])
        pieces[index] = re.sub(r"(?<!\w)([A-Za-z_+.-]*\*\w*|[<\[][^\n]*)", _plain, piece)
    return "".join(pieces)


def _plain(found: re.Match[str]) -> str:
    return re.sub(r"([<\[])", r"\\\1", found.group())


# --- Metrics ---


def metrics_page() -> str:
    """Return the page of metrics with the tables of today."""
    names = [each.name for each in fields(Metrics)]
    rows = [f"| `{name}` | {FORMULAS[name][0]} | {_formula(FORMULAS[name][1])} |" for name in names]
    words = [
        f"| {', '.join(f'`{name.strip()}`' for name in told.split(','))} | {_said_of(text)} |"
        for told, text in _attributes(Metrics)
    ]
    errors = [f"| `{name}` | {what} |" for name, what in ERRORS.items()]
    text = (REFERENCE / "metrics.md").read_text("utf-8")
    text = _with_rows(text, "| metric | unit | computed as |", rows)
    text = _with_rows(text, "| metric | in words |", words)
    return _with_rows(text, "| metric | of the errors |", errors)


_FOREIGN = {
    "FLL": "fll", "FCL of fuzzylite": "fcl", "FCL of jFuzzyLogic": "jfl", "FIS of fuzzylite": "fis",
    "FIS of MATLAB": "matlab", "FIS of Octave": "octave", "FML": "fml", "scikit-fuzzy": "skfuzzy",
}  # fmt: skip
"""The keys of `names` in the record of a kind, by the heads of columns."""

_KINDS = {
    "shape": SHAPES, "T-norm": TNORMS, "S-norm": SNORMS, "hedge": HEDGES,
    "defuzzifier": DEFUZZIFIERS,
}  # fmt: skip


def formats_page() -> str:
    """Return the page of formats with the names of today's kinds in other programs."""
    rows = []
    for sort, kinds in _KINDS.items():
        for kind in (each for each in kinds.values() if not each.own):
            names = [_foreign_name(kind.names.get(key, "")) for key in _FOREIGN.values()]
            if set(names) != {"–"}:
                rows.append(f"| {sort} | `{kind.name}` | {' | '.join(names)} |")
    text = (REFERENCE / "formats.md").read_text("utf-8")
    return _with_rows(text, f"| kind | here | {' | '.join(_FOREIGN)} |", rows)


def _foreign_name(names: str) -> str:
    """Return alternatives as code, each with the order of its numbers where that differs."""
    words = [name.partition(" ") for name in names.split(", ")]
    return ", ".join(f"`{word}` {order}".rstrip() for word, _, order in words) if names else "–"


def _with_rows(text: str, head: str, rows: list[str]) -> str:
    """Return a page with other rows in the table of this head."""
    table = re.compile(rf"(?m)^{re.escape(head)}\n(\|[-|]+\n)(?:\|.*\n)*")
    if len(table.findall(text)) != 1:
        raise ValueError(f"the page has no table, or several, with the head {head}")
    return table.sub(lambda found: "\n".join([head, f"{found[1]}" + "\n".join(rows), ""]), text)


def _formula(how: str) -> str:
    """Return a formula as code, and what is said behind it as words."""
    code, comma, words = how.partition("), ")
    return f"`{code})`, {words}" if comma else f"`{how}`".replace("|", "\\|")


def _attributes(kind: type) -> Iterator[tuple[str, str]]:
    """Yield the names and the text of each entry under Attributes of a docstring."""
    text = (inspect.getdoc(kind) or "").partition("Attributes\n----------\n")[2]
    for entry in re.split(r"\n(?=\S)", text):
        head, _, body = entry.partition("\n")
        yield head.partition(" : ")[0], inspect.cleandoc(body)


def _said_of(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


# --- The Python API ---

_API = """\
# The Python API

By purpose. Most programs need `fuzzyarm` alone: importing it is instant, and names load their
modules on first use. The pages of the packages are generated from their docstrings when the site is
built, and list the names of their `__all__`. This page is generated by `tools/make_reference.py`;
[rule bases in Python](../howto/python.md) has examples.
"""

PURPOSES = {
    "Rule bases and files": (
        "fuzzyarm", "fuzzyarm.exchange.files", "fuzzyarm.apps.builder", "fuzzyarm.language.model",
        "fuzzyarm.language", "fuzzyarm.exchange.formats", "fuzzyarm.exchange.live",
        "fuzzyarm.symbolic.kinds", "fuzzyarm.symbolic.op", "fuzzyarm.base",
    ),
    "Evaluate, tabulate, prove": (
        "fuzzyarm.inference", "fuzzyarm.table", "fuzzyarm.proof.map", "fuzzyarm.proof.loop",
        "fuzzyarm.proof.claim", "fuzzyarm.proof.check", "fuzzyarm.apps.grading",
    ),
    "Controllers, plants, runs": (
        "fuzzyarm.control.controllers", "fuzzyarm.plant", "fuzzyarm.base.picture",
        "fuzzyarm.control.loop",
        "fuzzyarm.learning.tuning", "fuzzyarm.apps.study", "fuzzyarm.requests",
    ),
    "From data": ("fuzzyarm.learning", "fuzzyarm.apps.estimators"),
    "Show and export": (
        "fuzzyarm.apps.show", "fuzzyarm.apps.show.figures", "fuzzyarm.apps.notebook",
        "fuzzyarm.exchange.export", "fuzzyarm.apps.dossier",
        "fuzzyarm.base.figure_files",
    ),
    "Building blocks for other tools": (
        "fuzzyarm.language.check", "fuzzyarm.language.edit",
    ),
}  # fmt: skip
"""Packages with a page of their own, by what one wants of them."""


def names_by_purpose() -> dict[str, list[tuple[str, str]]]:
    """Return the names of ``fuzzyarm`` with their first lines, grouped as ``help`` has them."""
    text = (inspect.getdoc(fuzzyarm) or "").split("Rooms, each with")[0]
    found: dict[str, list[tuple[str, str]]] = {}
    for heading, body in re.findall(r"(?m)^(\w.*)\n((?:    \w.*\n(?: {8,}\S.*\n)*)+)", text):
        entries = [" ".join(each.split()) for each in re.split(r"\n(?=    \w)", body.rstrip())]
        found[heading] = [(name, said) for name, _, said in (e.partition(" ") for e in entries)]
    return found


def api_index() -> str:
    """Return the page of the Python API as Markdown: names and packages by purpose."""
    parts = [_API]
    for heading, names in names_by_purpose().items():
        rows = [f"| {_linked(name)} | {_escaped(said)} |" for name, said in names]
        parts.append("\n".join([f"## {heading}\n", "| name | what it is |\n|---|---|", *rows, ""]))
    parts.append("## Packages\n")
    for purpose, packages in PURPOSES.items():
        pages = [f"/api/{package}" for package in packages]
        words = ["```{toctree}", ":maxdepth: 1", f":caption: {purpose}", "", *pages, "```", ""]
        parts.append("\n".join(words))
    return "\n".join(parts).rstrip() + "\n"


def _linked(name: str) -> str:
    """Return a name as a link to where it is told: a module to the page on what it is for."""
    if inspect.ismodule(getattr(fuzzyarm, name)):
        return f"[`fuzzyarm.{name}`](kinds.md)"
    return f"{{py:obj}}`fuzzyarm.{name}`"


_NOT_FOR_IMPORT = ("fuzzyarm.apps.cli", "fuzzyarm.apps.lsp", "fuzzyarm.apps.watch")
"""Packages that people call from a terminal or an editor."""


def public_packages() -> list[str]:
    """Return the packages, and the modules that a room names, with public names of their own."""
    found = ["fuzzyarm"]
    for each in pkgutil.walk_packages(fuzzyarm.__path__, "fuzzyarm."):
        room = importlib.import_module(each.name.rpartition(".")[0])
        if each.name.startswith(_NOT_FOR_IMPORT) or "._" in each.name:
            continue
        module = importlib.import_module(each.name)
        leaf = each.name.rpartition(".")[2]
        named = leaf in getattr(room, "__all__", ()) and getattr(room, leaf) is module
        if each.ispkg or named:
            names = getattr(module, "__all__", ())
            if not all(inspect.ismodule(getattr(module, name)) for name in names):
                found.append(each.name)
    return found


def write_api_pages(folder: Path) -> None:
    """Write a page for each public package; a name of ``fuzzyarm`` itself is told there."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    told: dict[int, str] = {}
    for package in public_packages():
        module = importlib.import_module(package)
        write_atomically(folder / f"{package}.rst", api_page(module, told))


def api_page(module: ModuleType, told: dict[int, str]) -> str:
    """Return the page of a package; `told` has the page of each object so far."""
    package = module.__name__
    lines = [package, "=" * len(package), "", f".. automodule:: {package}", "   :no-members:", ""]
    elsewhere = []
    for name in module.__all__:
        thing = getattr(module, name)
        home = told.setdefault(id(thing), package)
        if home != package and not isinstance(thing, int | float | str | tuple):
            elsewhere.append(f"``{name}`` (:doc:`{home}`)")
        elif not inspect.ismodule(thing):
            lines += _directive(f"{package}.{name}", thing)
    if elsewhere:
        lines += ["", f"Told elsewhere: {', '.join(elsewhere)}.", ""]
    return "\n".join(lines)


def _directive(name: str, thing: object) -> list[str]:
    if hasattr(thing, "__origin__"):  # another name for a type
        return [f".. py:type:: {name}", f"   :canonical: {thing}", ""]
    if inspect.isclass(thing):
        kind = "autoexception" if issubclass(thing, BaseException) else "autoclass"
        return [f".. {kind}:: {name}", "   :members:", ""]
    if inspect.isroutine(thing):
        return [f".. autofunction:: {name}", ""]
    return [f".. autodata:: {name}", "   :no-value:", ""]


if __name__ == "__main__":
    write_atomically(REFERENCE / "commands.md", commands_page())
    write_atomically(REFERENCE / "metrics.md", metrics_page())
    write_atomically(REFERENCE / "formats.md", formats_page())
    write_atomically(REFERENCE / "api.md", api_index())
