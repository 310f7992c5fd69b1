"""The files that a command has read: its results must not overwrite them."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator

from fuzzyarm.errors import FuzzyarmError

__all__ = ["SourceFileError", "demand_no_source", "note_source", "sources_kept"]

_notes: list[set[str]] = []
"""A stack of sets of real paths that commands have read; empty outside :func:`sources_kept`."""


class SourceFileError(FuzzyarmError, ValueError):
    """A result would overwrite a file that it was computed from.

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
    """Refuse to overwrite any file that is read within this context."""
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
