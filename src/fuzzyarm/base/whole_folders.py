"""Atomic writing of a generated folder, never over a person's files."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import demand_allowed

LIST = ".fuzzyarm.json"
"""Record in a folder: its files with the hashes of their written content."""

_MOST = 3
"""Largest number of names in a message."""


class ForeignFolderError(FuzzyarmError, ValueError):
    """A folder has files that would be lost.

    Attributes
    ----------
    folder : Path
        The folder.
    files : tuple of str
        The files in the way, relative to the folder.
    """

    def __init__(self, message: str, folder: Path, files: tuple[str, ...], *, hint: str) -> None:
        super().__init__(message, hint=hint)
        self.folder, self.files = folder, files


def demand_own(folder: str | Path) -> None:
    """Raise `ForeignFolderError` for changed or foreign files under names to be written.

    Other files may be there: they stay.
    """
    folder = Path(folder)
    if not os.path.lexists(folder):
        return
    if not folder.is_dir():
        words = f"{folder} is a file, not a folder"
        raise ForeignFolderError(words, folder, (), hint="name another one")
    present = sorted(path.name for path in folder.iterdir())
    if not present:
        return
    hashes = _hashes(folder)
    if hashes is None:
        words = f"{folder} is not empty, and not of fuzzyarm: it has {_named(present)}"
        raise ForeignFolderError(words, folder, tuple(present), hint="name a new folder")
    changed = [name for name, digest in hashes.items() if _changed(folder / name, digest)]
    if changed:
        words = f"{folder} has files that were changed since they were made: {_named(changed)}"
        hint = "move them away, or name another folder"
        raise ForeignFolderError(words, folder, tuple(changed), hint=hint)


def write_folder(folder: str | Path, files: Mapping[str, str]) -> None:
    """Write a folder so that a reader sees the old one or the new one."""
    target = Path(os.path.realpath(folder))
    demand_allowed(target)
    demand_own(target)
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".fuzzyarm-") as room:
        new_folder = Path(room) / "new"
        if target.is_dir():
            shutil.copytree(target, new_folder, symlinks=True)
            for name in _hashes(new_folder) or {}:
                (new_folder / name).unlink(missing_ok=True)
        hashes = {}
        for name, text in files.items():
            path = new_folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            data = text.encode()
            path.write_bytes(data)
            hashes[name] = hashlib.sha256(data).hexdigest()
        (new_folder / LIST).write_text(json.dumps(hashes, indent=1) + "\n", "utf-8")
        if target.is_dir():
            os.replace(target, Path(room) / "old")
        os.replace(new_folder, target)


def _hashes(folder: Path) -> dict[str, str] | None:
    """Return the hashes recorded in a folder; None for a folder of somebody else."""
    try:
        listed = json.loads((folder / LIST).read_text("utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(listed, dict):
        return None
    inside = (
        isinstance(name, str) and not Path(name).is_absolute() and ".." not in Path(name).parts
        for name in listed
    )
    return listed if all(inside) else None


def _changed(path: Path, digest: str) -> bool:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest() != digest
    except FileNotFoundError:
        return False
    except OSError:
        return True


def _named(names: list[str]) -> str:
    rest = len(names) - _MOST
    listing = ", ".join(names[:_MOST])
    return f"{listing} and {rest} more" if rest > 0 else listing
