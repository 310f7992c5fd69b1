"""The folder of a playground: its contents, and their writing.

Its parts: fuzzyarm as an archive for the Python of the page (modules and rule bases, no machine
code), and Pyodide's files, from a folder or from the package registry of npm by its client.
"""

from __future__ import annotations

import hashlib
import html
import io
import json
import os
import re
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from fuzzyarm.apps.designer.assets import PAGE
from fuzzyarm.apps.designer.engine import engine_source
from fuzzyarm.apps.designer.folder import IMPORTS, LARGEST_IMPORT, SUFFIXES
from fuzzyarm.apps.designer.names import with_suffix
from fuzzyarm.apps.playground.memory import NoMemoryError, packed
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.extras import installed_program
from fuzzyarm.base.files import write_atomically
from fuzzyarm.base.jsonable import script_json
from fuzzyarm.base.protected import is_made_file, sources_kept
from fuzzyarm.base.shipped_files import shipped, shipped_folder
from fuzzyarm.language import read_text
from fuzzyarm.version import __version__

# ── Pyodide ──────────────────────────────────────────────────────────────────────────
#
# Its core is Python compiled to WebAssembly with the standard library; that is all a playground
# needs. Nothing of it is part of fuzzyarm.

VERSION = "314.0.7"
"""The archive fetched by default."""

OLDEST = (314, 0)
"""Oldest version whose Python lends the memory of Python arrays and can be interrupted."""

FILES = (
    "pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip", "pyodide-lock.json",
)  # fmt: skip
"""The files of it in a playground."""

PATIENCE = 600.0
"""Time limit of npm, s."""


class PyodideError(FuzzyarmError, OSError):
    """Pyodide is not available, or its version does not suit the playground."""


@contextmanager
def pyodide_folder(named: Path | None) -> Iterator[Path]:
    """Provide a folder with Pyodide's files, as long as needed."""
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
    """Return why a page could not load an archive: the error of a bare Python."""
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as folder:
        path = Path(folder) / "fuzzyarm.zip"
        path.write_bytes(content)
        words = [sys.executable, "-I", "-S", "-c", LOADING, str(path)]
        process = subprocess.run(words, capture_output=True, text=True, check=False)
    return process.stderr.strip().splitlines()[-1] if process.returncode else ""


BUNDLE = PAGE / "built/playground.js"
"""The modules of the page, which `make designer` puts together."""

STYLES = ("style.css", "files.css", "vendor/uplot.css", "run.css", "playground.css")

BEGIN_WITH = ("pd7.frb", "servo.frb", "tipper.frb")
"""The shipped files of a new visitor."""

POLICY = (
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self';"
    " connect-src 'self'; img-src 'self' data: blob:; style-src 'self' 'nonce-playground';"
    " base-uri 'none'; form-action 'none'"
)
"""Nothing is loaded from elsewhere, and no text is run. The nonce is of the editor's styles."""


class PlaygroundError(FuzzyarmError, OSError):
    """A playground that could not be written."""


@dataclass(frozen=True)
class Playground:
    """A written playground.

    Attributes
    ----------
    folder : Path
        Where.
    count, size : int
        How many files, and their bytes.
    kernels : bool
        Whether it has the kernels as WebAssembly.
    no_memory : str
        The reason for the lack of a Python's memory with fuzzyarm loaded; empty if present.
    """

    folder: Path
    count: int
    size: int
    kernels: bool
    no_memory: str = ""


def _no_memory(_parts: Mapping[str, bytes]) -> bytes:
    raise NoMemoryError("no memory of Python was asked for")


def wasm_kernels() -> bytes | None:
    """Return the kernels as WebAssembly; None without the ``ziglang`` wheel."""
    try:
        import ziglang  # noqa: F401
    except ImportError:
        return None
    from fuzzyarm.apps.native.build import build, zig

    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as room:
        return build(Path(room), zig("wasm32", "emscripten")).read_bytes()


def write_playground(
    folder: Path,
    files: Sequence[Path] = (),
    pyodide: Path | None = None,
    kernels: Callable[[], bytes | None] = lambda: None,
    memory: Callable[[Mapping[str, bytes]], bytes] = _no_memory,
) -> Playground:
    """Write the folder; an earlier playground's files are replaced, others stay."""
    texts = _texts(files)
    if folder.exists() and not folder.is_dir():
        raise PlaygroundError(f"{folder} is not a folder")
    if not folder.exists():  # minutes before it is filled: can it be made?
        folder.mkdir(parents=True)
        folder.rmdir()
    with pyodide_folder(pyodide) as source:
        parts = {f"python/{name}": (source / name).read_bytes() for name in FILES}
        parts |= {f"python/{path.name}": path.read_bytes() for path in source.glob("numpy-*.whl")}
    parts["python/fuzzyarm.zip"] = own = archive()
    if why := why_it_does_not_load(own):
        raise PlaygroundError(f"the page could not load fuzzyarm: {why}")
    machine_code = kernels()
    if machine_code is not None:
        parts["python/_kernels.so"] = machine_code
    try:
        memory_of_python, no_memory = memory(parts), ""
        parts["python/memory.bin"] = packed(memory_of_python)
    except NoMemoryError as error:
        memory_of_python, no_memory = b"", str(error)
    parts |= _page(texts, parts, len(memory_of_python))
    page = folder / "index.html"
    # A folder whose page fuzzyarm wrote is made anew, Pyodide's files included.
    anew = page.is_file() and is_made_file(page)
    with sources_kept(force=True) if anew else nullcontext():
        for name, content in parts.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(path, content)
    size = sum(map(len, parts.values()))
    return Playground(folder, len(parts), size, machine_code is not None, no_memory)


def _texts(files: Sequence[Path]) -> dict[str, str]:
    """Return the texts for visitors, by name."""
    texts: dict[str, str] = {}
    for path in files or [shipped(name) for name in BEGIN_WITH]:
        if path.suffix.lower() not in SUFFIXES:
            raise PlaygroundError(f"{path} is neither a .frb nor a .lut file")
        name = with_suffix(path.name, path.suffix)
        if name in texts:
            raise PlaygroundError(f"two files are called {name}")
        texts[name] = read_text(path).replace("\r\n", "\n")
    return texts


def _page(texts: Mapping[str, str], python: Mapping[str, bytes], memory: int) -> dict[str, bytes]:
    """Return the files of the page itself; `memory` is the size of that of Python, or 0."""
    script = f"{engine_source()}\nglobalThis.fuzzyarm = {{ Engine }};\n" + BUNDLE.read_text("utf-8")
    parts = {
        "playground.js": script.encode(),
        "python.js": (PAGE / "playground/python.js").read_bytes(),
        "start.js": (PAGE / "playground/start.js").read_bytes(),
        "page.css": b"\n".join((PAGE / name).read_bytes() for name in STYLES),
        "LICENSES.md": (PAGE / "vendor/LICENSES.md").read_bytes(),
    }
    wheel = next((name for name in python if name.startswith("python/numpy-")), "")
    start = {
        "files": [],
        "first": next(iter(texts), ""),
        "only": False,
        "largest": LARGEST_IMPORT,
        "imports": IMPORTS,
        "nonce": "playground",
        "version": __version__,
        "texts": texts,
        "python": {
            "kernels": "python/_kernels.so" in python,
            "numpy": wheel,
            "memory": memory,
        },
    }
    page = (PAGE / "playground/index.html").read_text("utf-8")
    page = page.replace("POLICY", html.escape(POLICY)).replace("START", script_json(start))
    parts["index.html"] = page.encode()
    offline = (PAGE / "playground/offline.js").read_text("utf-8")
    names = ["./", *parts, *python]
    digest = f"{__version__}-{_digest({**parts, **python})}"
    offline = offline.replace('"FILES"', script_json(names)).replace('"DIGEST"', f'"{digest}"')
    parts["offline.js"] = offline.encode()
    return parts


def _digest(parts: Mapping[str, bytes]) -> str:
    """Return a digest that changes with any of the files."""
    whole = hashlib.sha256()
    for name in sorted(parts):
        whole.update(name.encode() + parts[name])
    return whole.hexdigest()[:16]
