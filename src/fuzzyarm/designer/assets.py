"""The files of the page: read from the package, the engine made from the kernel."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from fuzzyarm.export.javascript import engine_source, script_json
from fuzzyarm.version import __version__

PAGE = Path(__file__).parent / "page"

KINDS = {
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".md": "text/markdown; charset=utf-8",
}


@cache
def names() -> frozenset[str]:
    """Return the names of the files that a page may ask for."""
    paths = (path.relative_to(PAGE).as_posix() for path in PAGE.rglob("*") if path.is_file())
    return frozenset(name for name in paths if Path(name).suffix in KINDS)


@cache
def _engine() -> bytes:
    return f"{engine_source()}\nexport {{ Engine }};\n".encode()


def asset(name: str) -> tuple[bytes, str] | None:
    """Return the content and the type of a file of the page; None where it does not exist."""
    if name == "engine.js":
        return _engine(), KINDS[".js"]
    if name not in names():
        return None
    return (PAGE / name).read_bytes(), KINDS[Path(name).suffix]


def index_page(facts: Mapping[str, Any], nonce: str) -> str:
    """Return the page that talks to the server, with what it has to know at once."""
    page = (PAGE / "index.html").read_text(encoding="utf-8")
    start = {**facts, "nonce": nonce, "version": __version__}
    return page.replace("START", script_json(start))
