"""The files that a command has read: its results must not overwrite them."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.made import is_made_file

__all__ = [
    "ForeignFileError",
    "SourceFileError",
    "demand_made",
    "demand_no_source",
    "is_in_command",
    "note_result",
    "note_source",
    "sources_kept",
]

_Identity = str | tuple[int, int]
"""A real path, or device and inode: a file may have several names."""


class _Notes:
    """The files that a command has read, and those that it is going to write.

    `force`: whether it may replace files that fuzzyarm did not write.
    """

    def __init__(self, *, force: bool) -> None:
        self.force = force
        self.sources: set[_Identity] = set()
        self.results: set[_Identity] = set()


_notes: list[_Notes] = []
"""Those of each command that runs within another."""


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


class ForeignFileError(FuzzyarmError, ValueError):
    """A command would replace a file that fuzzyarm did not write.

    Attributes
    ----------
    path : str
        The file.
    """

    def __init__(self, path: str) -> None:
        super().__init__(
            f"{path} is not replaced: fuzzyarm did not write it", hint="--force replaces it"
        )
        self.path = path


@contextlib.contextmanager
def sources_kept(*, force: bool = True) -> Iterator[None]:
    """Refuse to overwrite files that are read within this context; without `force` others, too.

    Without `force` only files that fuzzyarm wrote are replaced.
    """
    _notes.append(_Notes(force=force))
    try:
        yield
    finally:
        _notes.pop()


def note_source(path: str | os.PathLike[str]) -> None:
    """Note that a file is read; SourceFileError where it was said that it will be written."""
    identities = _identities(path)
    for notes in _notes:
        if notes.results & identities:
            raise SourceFileError(os.fspath(path))
        notes.sources |= identities


def note_result(path: str | os.PathLike[str]) -> None:
    """Note that a file that is there will be written: to read it is then an error at once."""
    if os.path.exists(path):
        for notes in _notes:
            notes.results |= _identities(path)


def demand_no_source(path: str | os.PathLike[str]) -> None:
    """Raise SourceFileError where a file that was read would be written."""
    identities = _identities(path)
    for notes in _notes:
        if notes.sources & identities:
            raise SourceFileError(os.fspath(path))
        notes.results -= identities  # it is a result from now on, and may be read


def demand_made(path: str | os.PathLike[str]) -> None:
    """Raise ForeignFileError where a command would replace a file that fuzzyarm did not write."""
    if keeps_foreign() and os.path.isfile(path) and not is_made_file(path):
        raise ForeignFileError(os.fspath(path))


def keeps_foreign() -> bool:
    """Whether a command runs that replaces only files that fuzzyarm wrote."""
    return bool(_notes) and not _notes[-1].force


def is_in_command() -> bool:
    """Whether what is written now is the result of a command, apart from what it reads."""
    return bool(_notes)


def _identities(path: str | os.PathLike[str]) -> set[_Identity]:
    identities: set[_Identity] = {os.path.realpath(path)}
    with contextlib.suppress(OSError):
        status = os.stat(path)
        identities.add((status.st_dev, status.st_ino))
    return identities
