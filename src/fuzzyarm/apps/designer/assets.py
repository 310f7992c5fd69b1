"""The files of the page: read from the package, the engine made from the kernel."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from posixpath import dirname, join, normpath
from typing import Any

from fuzzyarm.apps.designer.engine import engine_source
from fuzzyarm.base.jsonable import script_json
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
    """Return the names of the files available to a page."""
    paths = (path.relative_to(PAGE).as_posix() for path in PAGE.rglob("*") if path.is_file())
    return frozenset(name for name in paths if Path(name).suffix in KINDS)


@cache
def _engine() -> bytes:
    return f"{engine_source()}\nexport {{ Engine }};\n".encode()


def asset(name: str) -> tuple[bytes, str] | None:
    """Return content and type of a file of the page; None if it does not exist."""
    if name == "engine.js":
        return _engine(), KINDS[".js"]
    if name not in names():
        return None
    return (PAGE / name).read_bytes(), KINDS[Path(name).suffix]


@cache
def modules(first: str = "app.js") -> tuple[str, ...]:
    """Return a module and all its imports, each once."""
    names = [first]
    for name in names:  # which grows meanwhile
        content, _ = asset(name) or (b"", "")
        paths = re.findall(r'\bfrom "(\.[^"]+)";$', content.decode(), re.MULTILINE)
        imports = dict.fromkeys(normpath(join(dirname(name), path)) for path in paths)
        names += [module for module in imports if module not in names]
    return tuple(names)


def index_page(facts: Mapping[str, Any], nonce: str) -> str:
    """Return the page of the server, with its initial state."""
    page = (PAGE / "index.html").read_text(encoding="utf-8")
    start = {**facts, "nonce": nonce, "version": __version__}
    # A browser would learn of each module only when it has read the one that imports it.
    links = [f'<link rel="modulepreload" href="page/{name}">' for name in modules()]
    preloads = "\n".join(reversed(links))  # the largest ones last
    return page.replace("PRELOADS", preloads).replace("START", script_json(start))
