"""fuzzyarm as an archive for the Python of a page: its modules, its rule bases, no machine code."""

from __future__ import annotations

import io
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from fuzzyarm.base.shipped_files import shipped_folder

PACKAGE = Path(__file__).resolve().parents[2]

APART = frozenset(
    {
        "apps/cli",
        "apps/native",
        "apps/watch",
        "apps/notebook.py",
        "apps/estimators.py",
        "exchange/live",
        "apps/study",
        "apps/designer/page",
    }
)
"""Left out of a page: commands, compilers, other libraries, and the page's own files."""

LOADING = """
import sys
sys.path.insert(0, sys.argv[1])
from fuzzyarm.apps.playground.arrays.module import install
install()
from fuzzyarm.apps.playground import host
host.warm()
"""
"""The start of a page, in a Python with the standard library and the archive alone."""

WHEN = (1980, 1, 1, 0, 0, 0)
"""Of all files: the same sources make the same archive."""


def _members() -> Iterator[tuple[str, bytes]]:
    for path in sorted(PACKAGE.rglob("*")):
        inside = path.relative_to(PACKAGE).as_posix()
        parts = inside.split("/")
        homes = {"/".join(parts[:k]) for k in range(1, len(parts) + 1)}
        if homes & APART:
            continue
        if path.suffix in {".py", ".js", ".typed"} and "__pycache__" not in parts:
            yield f"fuzzyarm/{inside}", path.read_bytes()
    for path in sorted(shipped_folder().iterdir()):
        if path.suffix in {".frb", ".lut"}:
            yield f"fuzzyarm/shipped/{path.name}", path.read_bytes()


def archive() -> bytes:
    """Return the archive, as of a wheel of fuzzyarm without machine code."""
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in _members():
            file.writestr(zipfile.ZipInfo(name, WHEN), content, zipfile.ZIP_DEFLATED)
    return whole.getvalue()


@lru_cache(maxsize=1)
def why_it_does_not_load(content: bytes) -> str:
    """Return why a page could not load an archive: the error of a Python that has nothing else."""
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as folder:
        path = Path(folder) / "fuzzyarm.zip"
        path.write_bytes(content)
        words = [sys.executable, "-I", "-S", "-c", LOADING, str(path)]
        process = subprocess.run(words, capture_output=True, text=True, check=False)
    return process.stderr.strip().splitlines()[-1] if process.returncode else ""
