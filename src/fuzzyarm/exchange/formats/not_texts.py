"""Binary files with fuzzy systems: their kinds, and hints for the user."""

from __future__ import annotations

import os
from pathlib import Path

_MAT = "a MAT-file", "in MATLAB, writeFIS(fis, 'name') writes a variable of it as a .fis"
_PICKLE = (
    "a pickle",
    "only Python opens it: a script that loads it can be converted, fuzzyarm convert load.py",
)
_ARCHIVE = "an archive", "the files in it can be read one by one"

_SUFFIXES = {".mat": _MAT, ".zip": _ARCHIVE} | dict.fromkeys(
    (".pkl", ".pickle", ".joblib", ".dill", ".sav"), _PICKLE
)
_STARTS = {
    b"MATLAB 5.0 MAT-file": _MAT, b"MATLAB 7.3 MAT-file": _MAT, b"\x80\x02": _PICKLE,
    b"\x80\x03": _PICKLE, b"\x80\x04": _PICKLE, b"\x80\x05": _PICKLE, b"PK\x03\x04": _ARCHIVE,
}  # fmt: skip


def called(path: str | os.PathLike[str]) -> tuple[str, str] | None:
    """Return kind and hint for a file name, by its suffix; None if it may be a text."""
    return _SUFFIXES.get(Path(path).suffix.lower())


def started(data: bytes) -> tuple[str, str] | None:
    """Return kind and hint for the first bytes of a file, whatever its name; None if unknown."""
    return next((kind for start, kind in _STARTS.items() if data.startswith(start)), None)
