"""The designer as a folder of files, for any web server: a page with its own Python.

The folder needs no program behind it: text with findings, pictures, tables, runs of the shipped
plants, conversion and code are made in the browser of whoever opens it, by the modules of fuzzyarm
in Pyodide and by the kernels as WebAssembly. Nothing is loaded from elsewhere. FILEs are what a
visitor finds there.

Pyodide is fetched by npm, or taken from a folder. The kernels are compiled by the C compiler of the
extra platforms (ziglang, about 90 MB); where it is not installed the command asks whether it may
be, or --install says so. Without it runs are plain Python, and slow. Node, which comes with npm,
prepares the memory of Python; without it a page takes longer to start.

  fuzzyarm playground -o site
  fuzzyarm playground -o site servo.frb --pyodide node_modules/pyodide
"""

from __future__ import annotations

import argparse
import sys
from importlib.util import find_spec
from pathlib import Path

from fuzzyarm.apps.cli.command import FORCE, argument, command, flag, say
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.extras import install, installing


def _run(arguments: argparse.Namespace) -> int:
    from fuzzyarm.apps.playground.folder import wasm_kernels, write_playground
    from fuzzyarm.apps.playground.memory import python_memory

    if find_spec("ziglang") is None and (arguments.install or _is_wanted()):
        say("ziglang is being installed")
        if trouble := install("platforms"):
            raise NotInstalledError(f"ziglang is not installed: {trouble}")
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
    """What was to be installed is not."""


def _is_wanted() -> bool:
    """Ask whether the compiler is to be installed, where somebody is there to answer."""
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        return False
    say("Runs in the page need the kernels as WebAssembly, made by ziglang, a C compiler of 90 MB.")
    return input("Install it into this Python? [y/N] ").strip().lower() in ("y", "yes")


COMMANDS = (
    command(
        "playground",
        __doc__,
        _run,
        argument("files FILE", "a .frb or .lut file that a visitor finds", nargs="*"),
        argument("-o --out DIR", "the folder", required=True),
        FORCE,
        flag("--install", "install the compiler of the kernels, where it is missing"),
        argument("--pyodide FOLDER", "a folder with Pyodide's files (default: npm fetches them)"),
    ),
)
"""The commands of this module."""
