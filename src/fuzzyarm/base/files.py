"""Atomic replacement of files, stamps of their content, and confinement to folders."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.made import marked
from fuzzyarm.base.protected import demand_made, demand_no_source, is_in_command, note_result

_roots: list[Path] = []
"""Folders whose files this process may use; all files, if this is empty."""


class OutsideFolderError(FuzzyarmError, ValueError):
    """A text names a file outside the folders that it may use."""


@contextlib.contextmanager
def confined(*folders: str | Path) -> Iterator[None]:
    """Confine texts to files below some folders, in all threads, within this context.

    A process that takes texts from elsewhere is confined as a whole: what a text uses is read in
    many places (checked, hovered over, run, tuned, exported), and none of them can forget it.
    """
    _roots[:] = [real_path(folder) for folder in folders]
    try:
        yield
    finally:
        _roots.clear()


def real_path(path: str | Path) -> Path:
    """Return a path without links; one in a circle of links stays, and cannot be opened."""
    return Path(os.path.realpath(path))


def demand_allowed(path: str | Path) -> None:
    """Raise `OutsideFolderError` if a file, or the target of a link, may not be used."""
    resolved = real_path(path)
    if _roots and not any(resolved.is_relative_to(root) for root in _roots):
        raise OutsideFolderError("it is outside the folder that is open")


Stamp = tuple[int, int, int]
"""Changes whenever the file does: time, size and inode."""


def write_atomically(path: str | Path, content: str | bytes) -> Stamp:
    r"""Write `content` to `path` so that a reader sees the old file or the new one.

    Parameters
    ----------
    path : str or Path
        Where to write; the folder must exist. A symbolic link stays: the file that it leads
        to is written. A pipe, a device and a file of several names (hard links) stay as well:
        they are written through, since replacing would leave the other names behind.
    content : str or bytes
        Text is written as UTF-8 with ``\n`` line ends.

    Returns
    -------
    tuple of int
        The stamp of what was written: not that of the file by now, which somebody else may have
        written since.

    Raises
    ------
    OSError
        If the folder or the file cannot be written, or `path` is a folder; what is there is
        then untouched.
    SourceFileError
        If the command that writes has read the file.
    ForeignFileError
        If a command without ``--force`` would replace a file that fuzzyarm did not write.
    """
    _demand_leave(path)
    data = content.encode() if isinstance(content, str) else content
    if is_in_command():
        data = marked(path, data)
    with _named(path):
        if _stays(path):
            with open(path, "wb") as file:
                return _written(file, data)
        return _replace(real_path(path), data)


def demand_writable(path: str | Path) -> None:
    """Raise the OSError that :func:`write_atomically` would raise, as far as it can be foreseen.

    Called before long work whose result is written at its end; a full disk cannot be foreseen.
    """
    _demand_leave(path)
    if not _stays(path):
        with _named(path):
            handle, name = _part_in(real_path(path).parent)
            os.close(handle)
            os.unlink(name)
    note_result(path)


def same_file(one: str | Path, other: str | Path) -> bool:
    """Whether two paths lead to one file that is there."""
    return os.path.exists(one) and os.path.exists(other) and os.path.samefile(one, other)


class FileInUseError(FuzzyarmError, OSError):
    """Another process, or other work of this one, writes a file."""


def locked(path: str | Path) -> BinaryIO:
    """Open a file to append to it, alone: the lock is held until what is returned is closed.

    Raises
    ------
    FileInUseError
        If it is open like this already.
    OSError
        If it cannot be written.
    """
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
        file.close()  # it was replaced or removed in between


_IN_USE = (errno.EACCES, errno.EAGAIN, errno.EWOULDBLOCK, errno.EDEADLK)


def _lock(file: BinaryIO) -> None:
    """Lock a file; OSError where it is locked. File systems without locks take any number."""
    if sys.platform == "win32":
        import msvcrt

        file.seek(1 << 40)  # a byte that nobody reads: locks there hold for reading, too
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
    # Replacing a file does not need permission to write it, so that is checked here.
    if os.path.isdir(path):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if os.path.exists(path) and not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))


@contextlib.contextmanager
def _named(path: str | Path) -> Iterator[None]:
    """Let errors name the file itself, not its temporary part."""
    try:
        yield
    except OSError as error:
        if error.errno is None:
            raise
        raise type(error)(error.errno, error.strerror, str(path)) from None


def _stays(path: str | Path) -> bool:
    """Whether what is at `path` must be written in place: not a file, or one of several names."""
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
    """Return the stamp of a file as it is now; None without a file."""
    try:
        return _stamp(os.stat(path))
    except OSError:
        return None


def _stamp(status: os.stat_result) -> Stamp:
    return status.st_mtime_ns, status.st_size, status.st_ino
