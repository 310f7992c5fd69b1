"""Files that a command must not overwrite: its sources, and files that fuzzyarm did not write."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterator

from fuzzyarm.base.errors import FuzzyarmError

_Identity = str | tuple[int, int]
"""A real path, or device and inode for files with several names."""


class _Notes:
    """Files read and to be written by a command; with `force` it may replace files of others."""

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


# --- The mark of files written by fuzzyarm ---
#
# A comment near the beginning or the end, ``Written by fuzzyarm`` or ``made by fuzzyarm``; in a
# table its origin; in a figure the program in the metadata; in journals and JSON the first line;
# in recorded samples the heading. Archives (``.npz``, ``.fmu``), ``.gif`` and ``.mp4`` have it in
# the comment field of their format.

MARK = "Written by fuzzyarm"

_ENDS = 16_384
"""Bytes at the beginning and at the end of a file searched for the mark."""

_MARKED = re.compile(
    rb"(?:written|made) by fuzzyarm\b"
    rb"|^(?:# )?origin +made\b|^% made:"  # tables
    rb'|\A\{\s*"format": "fuzzyarm-'
    rb"|\A# fuzzyarm \w+ 1$"  # journals
    rb"|\Atime \[s\],[^\n]* wanted \[|\Arun,time \[s\],"  # recorded samples
    rb"|Software\0fuzzyarm|Creator \(fuzzyarm\)|<dc:title>fuzzyarm<",
    re.IGNORECASE | re.MULTILINE,
)

_OWN = f"# {MARK}. Remove this line from a file that is to be kept.\n"

_ENDING = {
    **dict.fromkeys((".html", ".htm", ".xml", ".svg"), f"<!-- {MARK} -->\n"),
    ".tex": f"% {MARK}\n",
}


def is_made(data: bytes) -> bool:
    """Whether the content of a file has the mark."""
    return bool(_MARKED.search(data[:_ENDS]) or _MARKED.search(data[-_ENDS:]))


def source_in(data: bytes) -> str:
    """Return the source file named in the head of an exported text; else nothing."""
    found = re.search(rb"^\W*source: (.+)$", data[:_ENDS], re.MULTILINE)
    return found[1].decode(errors="replace").strip() if found else ""


def is_made_file(path: str | os.PathLike[str]) -> bool:
    """Whether a file has the mark, or is empty."""
    size = os.path.getsize(path)
    with open(path, "rb") as file:
        data = file.read(_ENDS)
        if size > _ENDS:
            file.seek(max(_ENDS, size - _ENDS))
            # Two parts, not one: a line at the start of the tail is not the start of the file.
            return is_made(data) or is_made(b"\n" + file.read())
    return not data or is_made(data)


def marked(path: str | os.PathLike[str], data: bytes) -> bytes:
    """Return the content with the mark, if it has none and its format allows one."""
    return data if is_made(data) else _with_mark(os.path.splitext(path)[1].lower(), data)


def _with_mark(suffix: str, data: bytes) -> bytes:
    mark = MARK.encode()
    if suffix == ".frb":
        data = _OWN.encode() + data
    elif suffix in {".lut", ".csv"} and data.startswith((b"fuzzyarm-table", b"# fuzzyarm-table")):
        first, rest = data.split(b"\n", 1)
        data = first + b"\n# " + mark + b"\n" + rest
    elif suffix in _ENDING:
        data += _ENDING[suffix].encode()
    elif data[-22:-18] == b"PK\5\6":  # an archive without a comment
        data = data[:-2] + len(mark).to_bytes(2, "little") + mark
    elif data[:4] == b"GIF8" and data[-1:] == b";":
        data = data[:-1] + b"!\xfe" + bytes([len(mark)]) + mark + b"\0;"
    elif data[4:8] == b"ftyp":
        data += (len(mark) + 8).to_bytes(4, "big") + b"free" + mark
    return data
