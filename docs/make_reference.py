"""The pages that are read from the program itself: commands and the Python API.

    python docs/make_reference.py    # writes docs/commands.md

The page of commands is kept with the others, so that it can be read without building the site;
`tests/docs/test_reference.py` holds it to the parser. The pages of the API are written into
``docs/api`` at each build (``conf.py``) and not kept.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
import shutil
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from types import ModuleType

import fuzzyarm
from fuzzyarm.cli.command import Argument, Command
from fuzzyarm.cli.main import COMMANDS, HEADINGS, find_command
from fuzzyarm.text.files import write_atomically

HERE = Path(__file__).parent

# --- Commands ---

_HEAD = """\
# Commands

`fuzzyarm --help` lists them, `fuzzyarm COMMAND --help` prints what stands here. This page is
written from the parser of the commands by `docs/make_reference.py`.

Exit status: 0 fine, 1 the input is at fault, 2 wrong usage, 3 a run diverged, 4 a proof stayed
undecided, 130 interrupted. `fuzzyarm --version` prints the version, `fuzzyarm --print-completion
bash` (or `zsh`, `tcsh`) a script for [completion](install.md#completion).
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
        yield "| argument | what it is |\n|---|---|"
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


# --- The Python API ---

_NOT_FOR_IMPORT = ("fuzzyarm.cli", "fuzzyarm.lsp", "fuzzyarm.studio")
"""Packages that people call from a terminal or an editor."""


def public_packages() -> list[str]:
    """Return the packages, and modules on the top, that list what is public in ``__all__``."""
    found = ["fuzzyarm"]
    for each in pkgutil.walk_packages(fuzzyarm.__path__, "fuzzyarm."):
        private = each.name.startswith(_NOT_FOR_IMPORT) or "._" in each.name
        if private or each.name == "fuzzyarm.__main__":
            continue
        if each.ispkg or each.name.count(".") == 1:
            module = importlib.import_module(each.name)
            if getattr(module, "__all__", ()):
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
    write_atomically(HERE / "commands.md", commands_page())
