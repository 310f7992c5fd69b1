"""Atomic writing of files and generated folders, stamps, and confinement to folders."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.protected import (
    ForeignFileError,
    demand_made,
    demand_no_source,
    is_in_command,
    is_made_file,
    keeps_foreign,
    marked,
    note_result,
    source_in,
)

_roots: list[Path] = []
"""Folders to which this process is confined; all files, if empty."""


class OutsideFolderError(FuzzyarmError, ValueError):
    """A text names a file outside its permitted folders."""


@contextlib.contextmanager
def confined(*folders: str | Path) -> Iterator[None]:
    """Confine file access of texts to some folders, in all threads, within this context.

    The whole process is confined: files named by a text are read in many places (check, hover, run,
    tuning, export), and none of them can forget the test.
    """
    _roots[:] = [real_path(folder) for folder in folders]
    try:
        yield
    finally:
        _roots.clear()


def real_path(path: str | Path) -> Path:
    """Return a path with links resolved; a circular link stays, and cannot be opened."""
    return Path(os.path.realpath(path))


def demand_allowed(path: str | Path) -> None:
    """Raise `OutsideFolderError` for a file, or the target of a link, outside these folders."""
    resolved = real_path(path)
    if _roots and not any(resolved.is_relative_to(root) for root in _roots):
        raise OutsideFolderError("it is outside the folder that is open")


Stamp = tuple[int, int, int]
"""Changes with the file: time, size and inode."""


def write_atomically(path: str | Path, content: str | bytes) -> Stamp:
    r"""Write `content` to `path` so that a reader sees the old file or the new one.

    Parameters
    ----------
    path : str or Path
        The file; its folder must exist. A symbolic link stays and its target is replaced. Pipes,
        devices and files with several names (hard links) are written in place: replacing would
        detach the other names.
    content : str or bytes
        Text is written as UTF-8 with ``\n`` line ends.

    Returns
    -------
    tuple of int
        The stamp of the written file, even if another program has changed it since.

    Raises
    ------
    OSError
        If the folder or the file cannot be written, or `path` is a folder; old content is then
        untouched.
    SourceFileError
        If the running command has read the file.
    ForeignFileError
        If a command without ``--force`` would replace a file that fuzzyarm did not write.
    """
    _demand_leave(path)
    data = content.encode() if isinstance(content, str) else content
    if is_in_command():
        data = marked(path, data)
    with naming(path):
        if _stays(path):
            with open(path, "wb") as file:
                return _written(file, data)
        return _replace(real_path(path), data)


def demand_writable(path: str | Path) -> None:
    """Raise the foreseeable OSErrors of :func:`write_atomically`.

    For long work with a result at its end; a full disk cannot be foreseen.
    """
    _demand_leave(path)
    if not _stays(path):
        with naming(path):
            handle, name = _part_in(real_path(path).parent)
            os.close(handle)
            os.unlink(name)
    note_result(path)


def demand_companion(path: Path, content: bytes, named: Path) -> None:
    """Raise ForeignFileError if a command would replace what was made of another file.

    For a file written beside the `named` one, where an earlier pair may exist.
    """
    if not keeps_foreign() or not path.is_file() or not is_made_file(path):
        return
    source = source_in(path.read_bytes())
    pair = named.is_file() and source_in(named.read_bytes()) == source
    if source and not pair and source_in(content) != source:
        raise ForeignFileError(str(path), f"it was made of {source}")


def same_file(one: str | Path, other: str | Path) -> bool:
    """Whether two paths lead to one existing file."""
    return os.path.exists(one) and os.path.exists(other) and os.path.samefile(one, other)


class FileInUseError(FuzzyarmError, OSError):
    """A file is locked by another process, or by other work of this one."""


def locked(path: str | Path) -> BinaryIO:
    """Open a file for appending under an exclusive lock, held until it is closed."""
    while True:
        file = open(path, "ab")  # noqa: SIM115
        try:
            _lock(file)
        except OSError as error:
            file.close()
            message = f"{path} is being written by other work"
            hint = "wait for its end, or give another name"
            if error.errno in _IN_USE:
                raise FileInUseError(message, hint=hint) from None
            raise
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(file.fileno()), os.stat(path)):
                return file
        file.close()  # replaced or removed before the lock


_IN_USE = (errno.EACCES, errno.EAGAIN, errno.EWOULDBLOCK, errno.EDEADLK)


def _lock(file: BinaryIO) -> None:
    """Lock a file; OSError if it is locked. File systems without locks admit everyone."""
    if sys.platform == "win32":
        import msvcrt

        file.seek(1 << 40)  # far beyond the end: Windows locks forbid reading, too
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        return
    with contextlib.suppress(ImportError):  # in a browser
        import fcntl

        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno in _IN_USE:
                raise


def _demand_leave(path: str | Path) -> None:
    demand_no_source(path)
    demand_made(path)
    # Replacing a file does not need write permission for it, so test that here.
    if os.path.isdir(path):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if os.path.exists(path) and not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))


@contextlib.contextmanager
def naming(path: str | Path) -> Iterator[None]:
    """Name the file in errors, not its temporary part."""
    try:
        yield
    except OSError as error:
        if error.errno is None:
            raise
        raise type(error)(error.errno, error.strerror, str(path)) from None


def _stays(path: str | Path) -> bool:
    """Whether `path` must be written in place: a special file, or one with several names."""
    if not os.path.exists(path):
        return False
    status = os.stat(path)
    return not stat.S_ISREG(status.st_mode) or status.st_nlink > 1


def _written(file: BinaryIO, data: bytes) -> Stamp:
    file.write(data)
    file.flush()
    return _stamp(os.fstat(file.fileno()))


def _replace(target: Path, data: bytes) -> Stamp:
    handle, name = _part_in(target.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            stamp = _written(file, data)
        mode = target.stat().st_mode if target.exists() else 0o666 & ~_umask()
        os.chmod(name, mode & 0o777)
        os.replace(name, target)
    except BaseException:
        os.unlink(name)
        raise
    return stamp


def _part_in(folder: Path) -> tuple[int, str]:
    return tempfile.mkstemp(dir=folder, prefix=".fuzzyarm-", suffix=".part")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def stamp_of(path: str | Path) -> Stamp | None:
    """Return the current stamp of a file; None without a file."""
    try:
        return _stamp(os.stat(path))
    except OSError:
        return None


def _stamp(status: os.stat_result) -> Stamp:
    return status.st_mtime_ns, status.st_size, status.st_ino


# --- Generated folders, written whole and never over a person's files ---

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
        words = f"{folder} is not empty, and not of fuzzyarm: it has {_listed(present)}"
        raise ForeignFolderError(words, folder, tuple(present), hint="name a new folder")
    changed = [name for name, digest in hashes.items() if _changed(folder / name, digest)]
    if changed:
        words = f"{folder} has files that were changed since they were made: {_listed(changed)}"
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
    """Return the hashes recorded in a folder; None for a foreign folder."""
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


def _listed(names: list[str]) -> str:
    rest = len(names) - _MOST
    listing = ", ".join(names[:_MOST])
    return f"{listing} and {rest} more" if rest > 0 else listing
