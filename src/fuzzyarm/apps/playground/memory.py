"""The memory of a Python with fuzzyarm loaded, made once: a page that adopts it is ready.

When the folder of a playground is written, node runs the Python of the page, loads all modules of a
page, and saves its memory. A page without it starts Python and loads 350 modules, which takes ten
times as long.
"""

from __future__ import annotations

import gzip
import tempfile
from collections.abc import Mapping
from pathlib import Path

from fuzzyarm.apps.designer.assets import PAGE
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.extras import installed_program
from fuzzyarm.exchange.export.avr import run_tool
from fuzzyarm.exchange.export.numbers import ExportError

SCRIPTS = ("start.js", "remember.js")

PATIENCE = 300.0
"""Time limit of node, s; it needs about ten."""


class NoMemoryError(FuzzyarmError, RuntimeError):
    """No snapshot of Python's memory is available: pages start one anew."""


def python_memory(parts: Mapping[str, bytes]) -> bytes:
    """Return the memory of a Python with all modules of a page loaded.

    Parameters
    ----------
    parts : mapping of str to bytes
        The files of the folder: Pyodide's, and fuzzyarm's archive.

    Raises
    ------
    NoMemoryError
        If there is no node, or it fails; and for a folder with NumPy, whose machine code is not in
        that memory.
    """
    if any(name.startswith("python/numpy-") for name in parts):
        raise NoMemoryError("a memory of Python cannot hold NumPy's machine code")
    node = installed_program("node")
    if node is None:
        raise NoMemoryError("node is not installed, which prepares the memory of Python")
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as room:
        folder = Path(room)
        (folder / "python").mkdir()
        for name, content in parts.items():
            if name.startswith("python/"):
                (folder / name).write_bytes(content)
        for name in SCRIPTS:
            (folder / name).write_bytes((PAGE / "playground" / name).read_bytes())
        (folder / "package.json").write_text('{"type": "module"}', encoding="utf-8")
        try:
            run_tool([node, "remember.js", "python/", "memory"], folder, PATIENCE)
            return (folder / "memory").read_bytes()
        except (ExportError, OSError) as error:
            raise NoMemoryError(f"the memory of Python was not prepared: {error}") from None


def packed(memory: bytes) -> bytes:
    """Return a memory as a page fetches it: by gzip, as all browsers inflate it."""
    return gzip.compress(memory, compresslevel=6, mtime=0)
