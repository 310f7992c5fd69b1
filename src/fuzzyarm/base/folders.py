"""Files by suffix, and a person's own files in a folder, without those ignored by git."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

FOREIGN = (".fll", ".fcl", ".fis", ".fml")
"""Suffixes of foreign rule bases that can be written."""

SUFFIXES = (".frb", *FOREIGN)
"""Suffixes of rule bases that can be read and written."""

READABLE = (*SUFFIXES, ".t2fis", ".xml")
"""Suffixes of all readable rule bases; here to avoid an import of the readers."""

TABLES = (".lut", ".csv", ".npz", ".json")
"""Suffixes of lookup tables; here for the same reason."""

MODULES = (".py", ".mjs", ".js", ".rs")
"""Suffixes of single-file modules: MicroPython, JavaScript, Rust."""

NETWORK = ".onnx"
"""Suffix of a table as a network of rectifiers."""

EXPORTS = (".h", ".c", ".st", ".xml", ".scl", *MODULES, ".fmu", NETWORK)
"""Suffixes of exports: a header alone, a .c/.h pair, Structured Text as text and XML, SCL, modules,
FMUs, networks."""

PACKAGES = ("node_modules", "__pycache__", "site-packages")
"""Folders of installed packages."""


class _Pattern(NamedTuple):
    """A line of a ``.gitignore``: base folder, pattern, exclusion or inclusion."""

    base: str
    pattern: re.Pattern[str]
    taken_back: bool
    folders_only: bool


def own_files(folder: str) -> Iterator[str]:
    """Yield the files in a folder and in those below it, each level in order."""
    yield from _below(folder, _patterns_above(folder))


def _below(folder: str, patterns: tuple[_Pattern, ...]) -> Iterator[str]:
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError:
        return
    patterns += _patterns_in(folder)
    folders = []
    for entry in entries:
        if entry.name.startswith(".") or _left_out(entry, patterns):
            continue
        if not entry.is_dir():
            yield entry.path
        elif not entry.is_symlink() and not _is_of_packages(entry):
            folders.append(entry.path)
    for below in folders:
        yield from _below(below, patterns)


def _is_of_packages(entry: os.DirEntry[str]) -> bool:
    return entry.name in PACKAGES or os.path.exists(os.path.join(entry.path, "pyvenv.cfg"))


# --- .gitignore ---


def _patterns_above(folder: str) -> tuple[_Pattern, ...]:
    """Return the patterns of the folders above, up to the root of the repository."""
    from pathlib import Path

    above = []
    path = Path(os.path.realpath(folder))
    for ancestor in (path, *path.parents):
        if ancestor != path:
            above.append(ancestor)
        if (ancestor / ".git").exists():
            return tuple(p for parent in reversed(above) for p in _patterns_in(str(parent)))
    return ()


def _patterns_in(folder: str) -> tuple[_Pattern, ...]:
    try:
        with open(os.path.join(folder, ".gitignore"), encoding="utf-8", errors="replace") as file:
            lines = file.read().splitlines()
    except OSError:
        return ()
    base = os.path.abspath(folder)
    return tuple(p for line in lines if (p := _pattern(line, base)) is not None)


def _pattern(line: str, base: str) -> _Pattern | None:
    text = line.rstrip()
    if not text or text.startswith("#"):
        return None
    taken_back = text.startswith("!")
    text = text.removeprefix("!").removeprefix("\\")
    folders_only = text.endswith("/")
    text = text.rstrip("/")
    if not text:
        return None
    # With an inner slash a pattern is relative to its folder, else it matches a name at any depth.
    anchored = "/" in text
    return _Pattern(base, _matcher(text.lstrip("/"), anchored=anchored), taken_back, folders_only)


_WILD = {"**/": "(?:.*/)?", "/**": "/.*", "**": ".*", "*": "[^/]*", "?": "[^/]"}


@lru_cache(maxsize=1024)
def _matcher(text: str, *, anchored: bool) -> re.Pattern[str]:
    words = re.findall(r"\*\*/|/\*\*$|\*\*|\*|\?|\[[^\]]*\]|[^*?\[/]+|.", text)
    try:
        return re.compile(("" if anchored else "(?:.*/)?") + "".join(map(_as_regex, words)))
    except re.error:
        return re.compile(re.escape(text))


def _as_regex(word: str) -> str:
    if word in _WILD:
        return _WILD[word]
    if word.startswith("[") and len(word) > 1:
        return word.replace("[!", "[^", 1)
    return re.escape(word)


def _left_out(entry: os.DirEntry[str], patterns: Sequence[_Pattern]) -> bool:
    """Whether the last matching pattern excludes a file or a folder."""
    path = os.path.abspath(entry.path)
    for pattern in reversed(patterns):
        if pattern.folders_only and not entry.is_dir():
            continue
        relative = os.path.relpath(path, pattern.base).replace(os.sep, "/")
        if pattern.pattern.fullmatch(relative):
            return not pattern.taken_back
    return False
