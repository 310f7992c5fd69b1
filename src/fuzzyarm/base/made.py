"""The mark of files written by fuzzyarm; commands replace other files only with ``--force``.

The mark is a comment near the beginning or the end, ``Written by fuzzyarm`` or ``made by
fuzzyarm``; in a table its origin; in a figure the program in the metadata; in journals and JSON
the first line; in recorded samples the heading. Archives (``.npz``, ``.fmu``), ``.gif`` and
``.mp4`` have it in the comment field of their format.
"""

from __future__ import annotations

import os
import re

__all__ = ["is_made", "is_made_file", "marked", "source_in"]

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
    """Return the file that an exported text was made of, as its head says; else nothing."""
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
