"""Files that hold fuzzy systems and are not texts: what they are, and what helps."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["called", "started"]

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
    """Return what a file is by its suffix, and what helps; None of any other."""
    return _SUFFIXES.get(Path(path).suffix.lower())


def started(data: bytes) -> tuple[str, str] | None:
    """Return what a file is by its first bytes, whatever it is called, and what helps."""
    return next((what for start, what in _STARTS.items() if data.startswith(start)), None)
