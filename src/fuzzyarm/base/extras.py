"""Installation of extras, as commands that can be typed in the terminal at hand.

fuzzyarm is on no index, so pip cannot find ``fuzzyarm[lsp]``. In a clone, or installed from one,
the command names the clone; elsewhere the requirements of the extra.
"""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, distribution, requires
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from urllib.parse import urlsplit
from urllib.request import url2pathname

UV = "uv pip"
"""The installer for environments without pip, such as those of uv."""


def installing(extra: str) -> str:
    """Return the command that installs an extra for the running Python."""
    pip = _pip()
    words = [pip, "install", *(["--python", _python()] if pip == UV else [])]
    clone, editable = _clone()
    if clone is not None:
        folder = "." if clone == Path.cwd() else clone
        return " ".join([*words, *["-e"] * editable, f'"{folder}[{extra}]"'])
    return " ".join([*words, *(f'"{need}"' for need in _requirements(extra))])


def install(requirements: Sequence[str]) -> str:
    """Install requirements for the running Python; return the error, or ''."""
    pip = _pip()
    by = [*shlex.split(UV), "install", "--python", sys.executable]
    words = by if pip == UV else [sys.executable, "-m", "pip", "install", "--quiet"]
    try:
        done = subprocess.run([*words, *requirements], capture_output=True, text=True, check=False)
    except OSError as error:
        return str(error)
    lines = done.stderr.strip().splitlines() or ["it failed"]
    return lines[-1] if done.returncode else ""


def installed_program(name: str) -> str | None:
    """Return the path of a program: that on the PATH, or one that pip put beside this Python."""
    return which(name) or which(name, path=str(Path(sys.executable).parent))


def _clone() -> tuple[Path | None, bool]:
    """Return the source folder, and whether it is installed in development mode (``pip -e``)."""
    source = Path(__file__).resolve().parents[3]
    if _has_project(source):
        return source, True
    try:
        record = distribution("fuzzyarm").read_text("direct_url.json")
    except PackageNotFoundError:
        return None, False
    origin = json.loads(record or "{}")
    if "dir_info" not in origin:
        return None, False
    source = Path(url2pathname(urlsplit(origin["url"]).path))
    return (source if _has_project(source) else None), False


def _has_project(folder: Path) -> bool:
    return (folder / "pyproject.toml").is_file() and (folder / "src" / "fuzzyarm").is_dir()


def _requirements(extra: str) -> list[str]:
    """Return the requirements of an extra, from the metadata of the installed package."""
    try:
        lines = requires("fuzzyarm") or []
    except PackageNotFoundError:
        lines = []
    pattern = re.compile(rf"extra\s*==\s*['\"]{re.escape(extra)}['\"]")
    parts = [line.partition(";") for line in lines]
    return [need.strip() for need, _, marker in parts if pattern.search(marker)] or [f".[{extra}]"]


def _pip() -> str:
    """Return pip as a shell command: by name, if it is the one of this Python."""
    python = Path(sys.executable)
    by_name = which("pip")
    if by_name is not None and Path(by_name).parent == python.parent:
        return "pip"
    if find_spec("pip") is None:
        return UV
    return f"{_python()} -m pip"


def _python() -> str:
    """Return this Python as a shell command."""
    python = Path(sys.executable)
    if python.parent != Path.cwd() and python.is_relative_to(Path.cwd()):
        python = python.relative_to(Path.cwd())
    return f'"{python}"' if " " in str(python) else str(python)
