"""The folder of a playground: its contents, and how it is written."""

from __future__ import annotations

import hashlib
import html
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

from fuzzyarm.apps.designer.assets import PAGE
from fuzzyarm.apps.designer.engine import engine_source
from fuzzyarm.apps.designer.folder import IMPORTS, LARGEST_IMPORT, SUFFIXES
from fuzzyarm.apps.designer.names import with_suffix
from fuzzyarm.apps.playground.memory import NoMemoryError, packed
from fuzzyarm.apps.playground.package import archive, why_it_does_not_load
from fuzzyarm.apps.playground.pyodide import FILES, pyodide_folder
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import write_atomically
from fuzzyarm.base.jsonable import script_json
from fuzzyarm.base.protected import is_made_file, sources_kept
from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.language import read_text
from fuzzyarm.version import __version__

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
    """A folder that is not written."""


@dataclass(frozen=True)
class Playground:
    """A folder that was written.

    Attributes
    ----------
    folder : Path
        Where.
    count, size : int
        How many files, and their bytes.
    kernels : bool
        Whether it has the kernels as WebAssembly.
    no_memory : str
        Why it has no memory of a Python that has loaded fuzzyarm; empty where it has.
    """

    folder: Path
    count: int
    size: int
    kernels: bool
    no_memory: str = ""


def _no_memory(_parts: Mapping[str, bytes]) -> bytes:
    raise NoMemoryError("no memory of Python was asked for")


def wasm_kernels() -> bytes | None:
    """Return the kernels as WebAssembly; None where the ``ziglang`` wheel is not installed."""
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
    """Return the texts that a visitor finds, by name."""
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
