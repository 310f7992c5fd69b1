"""The files read by a command: its results must not overwrite them."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.made import is_made_file

__all__ = [
    "ForeignFileError", "SourceFileError", "demand_made", "demand_no_source", "is_in_command",
    "note_result", "note_source", "sources_kept",
]  # fmt: skip

_Identity = str | tuple[int, int]
"""A real path, or device and inode for files with several names."""


class _Notes:
    """Files read and files to be written by a command.

    `force`: whether it may replace files not written by fuzzyarm.
    """

    def __init__(self, *, force: bool) -> None:
        self.force = force
        self.sources: set[_Identity] = set()
        self.results: set[_Identity] = set()


_notes: list[_Notes] = []
"""One for each nested command."""


class SourceFileError(FuzzyarmError, ValueError):
    """A result would overwrite one of its sources.

    Attributes
    ----------
    path : str
        The file.
    """

    def __init__(self, path: str) -> None:
        super().__init__(f"{path} is not written: this command reads it", hint="give another name")
        self.path = path


class ForeignFileError(FuzzyarmError, ValueError):
    """A command would replace a file not written by fuzzyarm, or one made of another file.

    Attributes
    ----------
    path : str
        The file.
    """

    def __init__(self, path: str, why: str = "fuzzyarm did not write it") -> None:
        super().__init__(f"{path} is not replaced: {why}", hint="--force replaces it")
        self.path = path


@contextlib.contextmanager
def sources_kept(*, force: bool = True) -> Iterator[None]:
    """Refuse to overwrite files read within this context.

    Without `force` only files written by fuzzyarm are replaced.
    """
    _notes.append(_Notes(force=force))
    try:
        yield
    finally:
        _notes.pop()


def note_source(path: str | os.PathLike[str]) -> None:
    """Note that a file is read; SourceFileError if it is announced as a result."""
    identities = _identities(path)
    for notes in _notes:
        if notes.results & identities:
            raise SourceFileError(os.fspath(path))
        notes.sources |= identities


def note_result(path: str | os.PathLike[str]) -> None:
    """Announce an existing file as a result: reading it is then an error at once."""
    if os.path.exists(path):
        for notes in _notes:
            notes.results |= _identities(path)


def demand_no_source(path: str | os.PathLike[str]) -> None:
    """Raise SourceFileError if a file that was read would be written."""
    identities = _identities(path)
    for notes in _notes:
        if notes.sources & identities:
            raise SourceFileError(os.fspath(path))
        notes.results -= identities  # now a result, which may be read


def demand_made(path: str | os.PathLike[str]) -> None:
    """Raise ForeignFileError if a command would replace a file not written by fuzzyarm."""
    if keeps_foreign() and os.path.isfile(path) and not is_made_file(path):
        raise ForeignFileError(os.fspath(path))


def keeps_foreign() -> bool:
    """Whether the running command replaces only files written by fuzzyarm."""
    return bool(_notes) and not _notes[-1].force


def is_in_command() -> bool:
    """Whether a command is running, whose results are being written."""
    return bool(_notes)


def _identities(path: str | os.PathLike[str]) -> set[_Identity]:
    identities: set[_Identity] = {os.path.realpath(path)}
    with contextlib.suppress(OSError):
        status = os.stat(path)
        identities.add((status.st_dev, status.st_ino))
    return identities
