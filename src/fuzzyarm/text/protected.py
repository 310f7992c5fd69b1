"""Which files a command has read: its results may not be written over them."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator

from fuzzyarm.errors import FuzzyarmError

__all__ = ["SourceFileError", "demand_no_source", "note_source", "sources_kept"]

_notes: list[set[str]] = []
"""Real paths of the files that a command has read; nothing is noted where there is no set."""


class SourceFileError(FuzzyarmError, ValueError):
    """A result would be written over a file that it was computed from.

    Attributes
    ----------
    path : str
        The file.
    """

    def __init__(self, path: str) -> None:
        super().__init__(f"{path} is not written: this command reads it", hint="give another name")
        self.path = path


@contextlib.contextmanager
def sources_kept() -> Iterator[None]:
    """Have files that are read as long as this lasts refused where something is written."""
    _notes.append(set())
    try:
        yield
    finally:
        _notes.pop()


def note_source(path: str | os.PathLike[str]) -> None:
    """Note that a file is read."""
    for sources in _notes:
        sources.add(os.path.realpath(path))


def demand_no_source(path: str | os.PathLike[str]) -> None:
    """Raise SourceFileError where a file that was read would be written."""
    if any(os.path.realpath(path) in sources for sources in _notes):
        raise SourceFileError(os.fspath(path))
