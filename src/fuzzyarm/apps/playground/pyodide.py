"""Pyodide's files: from a folder of them, or from the package registry of npm, by its client.

The core of Pyodide is Python compiled to WebAssembly with its standard library; that is all a
playground needs. Nothing of it is part of fuzzyarm.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import tarfile
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.extras import installed_program

VERSION = "314.0.7"
"""The archive that is fetched where no folder is named."""

OLDEST = (314, 0)
"""Its Python lends the memory of arrays that are written in Python, and can be stopped half-way."""

FILES = (
    "pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip", "pyodide-lock.json",
)  # fmt: skip
"""The files of it in a playground."""

PATIENCE = 600.0
"""Seconds that npm may take."""


class PyodideError(FuzzyarmError, OSError):
    """Pyodide is not available, or its version does not suit the playground."""


@contextmanager
def pyodide_folder(named: Path | None) -> Iterator[Path]:
    """Give a folder with Pyodide's files for as long as it is needed."""
    if named is not None:
        _demand_files(named)
        yield named
        return
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as room:
        yield _fetched(Path(room))


def _demand_files(folder: Path) -> None:
    inner = folder / "node_modules" / "pyodide"
    hint = (
        f"for instance {inner}"
        if inner.is_dir()
        else "npm install pyodide  makes node_modules/pyodide"
    )
    missing = [name for name in FILES if not (folder / name).is_file()]
    if missing:
        raise PyodideError(f"{folder} does not have {missing[0]} of Pyodide", hint=hint)
    version = _version_of(folder)
    if version < OLDEST:
        raise PyodideError(
            f"{folder} has Pyodide {'.'.join(map(str, version))}; at least"
            f" {'.'.join(map(str, OLDEST))} is needed",
            hint=f"npm install pyodide@{VERSION}",
        )


def _version_of(folder: Path) -> tuple[int, ...]:
    """Return the version of a Pyodide, from its package or its list of packages."""
    try:
        package = folder / "package.json"
        if package.is_file():
            text = str(json.loads(package.read_text(encoding="utf-8"))["version"])
        else:
            lock = json.loads((folder / "pyodide-lock.json").read_text(encoding="utf-8"))
            major, minor = str(lock["info"]["python"]).split(".")[:2]
            text = f"{major}{minor}.0"
    except (OSError, ValueError, KeyError, IndexError, TypeError):
        raise PyodideError(f"{folder} does not say which Pyodide it is") from None
    return tuple(map(int, re.findall(r"\d+", text)[:2]))


def _fetched(room: Path) -> Path:
    """Fetch the package by npm, and verify it by the registry's digest."""
    npm = installed_program("npm")
    if npm is None:
        raise PyodideError(
            "Pyodide is fetched by npm, which is not installed",
            hint="--install brings it, --pyodide FOLDER uses an existing copy",
        )
    # npm looks for node on the PATH; that of pip is beside it.
    path = f"{Path(npm).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    words = [npm, "pack", f"pyodide@{VERSION}", "--silent", "--pack-destination", str(room)]
    try:
        process = subprocess.run(
            words, cwd=room, capture_output=True, text=True, check=False, timeout=PATIENCE,
            env={**os.environ, "PATH": path},
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        raise PyodideError(f"npm could not fetch Pyodide: {error}") from None
    archives = sorted(room.glob("*.tgz"))
    if process.returncode or not archives:
        messages = (process.stderr or process.stdout).strip().splitlines()
        raise PyodideError(
            f"npm could not fetch Pyodide {VERSION}{': ' + messages[-1] if messages else ''}",
            hint="--pyodide FOLDER uses an existing copy",
        )
    with tarfile.open(archives[0]) as archive:
        for name in (*FILES, "package.json"):
            member = archive.extractfile(f"package/{name}")
            assert member is not None
            (room / name).write_bytes(member.read())
    return room
