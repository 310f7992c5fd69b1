"""A journal: a file with a line for each piece of long work, which can be resumed.

It begins with the question as JSON after a ``#``; a heading and the lines of a CSV file follow.
So the file of interrupted work is a prefix of the complete one. A journal of another question is
refused, as is one whose unfinished work would be overwritten.
"""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any, BinaryIO

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import demand_writable, locked, naming

Row = Sequence[str]


class JournalError(FuzzyarmError, ValueError):
    """A journal of other work, a damaged one, or one whose work would be lost."""


class WorkJournal:
    """The journal of one task.

    Parameters
    ----------
    path : path-like
        Path of a CSV file.
    work : str
        Kind of work, one word, as in ``sweep``.
    question : mapping
        All inputs that determine the results, as JSON values.
    columns : sequence of str
        The heading.
    piece : str, optional
        Name of a line's subject.
    option : str, optional
        Option for the file name, for hints.
    sealed : bool, optional
        Whether a last cell, a digest of the line, reveals a changed line.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        work: str,
        question: Mapping[str, Any],
        columns: Sequence[str],
        *,
        piece: str = "run",
        option: str = "-o",
        sealed: bool = False,
    ) -> None:
        self.path, self.sealed = Path(path), sealed
        self.columns = (*columns, "seal") if sealed else tuple(columns)
        self.work, self.piece, self.option = work, piece, option
        self.first = f"# fuzzyarm {work} 1\n"
        # Sorted: equal questions give equal bytes.
        request_text = json.dumps(question, sort_keys=True, ensure_ascii=False)
        self.head = f"{self.first}# {request_text}\n{csv_line(self.columns)}"
        self._file: BinaryIO | None = None  # locked: one writer at a time

    def begin(self, total: int | None = None, *, may_replace: bool = True) -> None:
        """Write the head, replacing any old file."""
        self._demand_replaceable(total, may_replace=may_replace)
        demand_writable(self.path)
        file = self._held()
        self._demand_replaceable(total, may_replace=may_replace)  # locked since _held
        with naming(self.path):
            file.truncate(0)
        self._write(self.head)

    def _held(self) -> BinaryIO:
        """Return the file, locked from the first call until `close`."""
        if self._file is None:
            self._file = locked(self.path)
        return self._file

    def _demand_replaceable(self, total: int | None, *, may_replace: bool) -> None:
        if self.path.is_file() and self.path.stat().st_size:
            if self.path.read_bytes().startswith(self.head.encode()):
                count = len(self.rows())
                if count and count != total:
                    many = f"{count} {self.piece}s of this {self.work}"
                    if total is not None:
                        many = f"{count} of the {total} {self.piece}s"
                    hint = "--resume continues it, or remove the file"
                    raise JournalError(f"{self.path} has {many}", hint=hint)
            elif not may_replace:
                message = f"{self.path} exists and is not of this {self.work}"
                raise JournalError(message, hint=f"give another {self.option}")

    def resume(self) -> list[Row]:
        """Return the lines as cells; an incomplete last one is cut off."""
        self._demand_own(self.path.read_bytes())
        self._held()
        content = self.path.read_bytes()
        self._demand_own(content)
        # The writer was killed within a line: the next one must not continue it.
        if not content.endswith(b"\n"):
            os.truncate(self.path, content.rfind(b"\n") + 1)
        return self.rows()

    def _demand_own(self, content: bytes) -> None:
        head = self.head.encode()
        if not content.startswith(head):
            hint = f"give another {self.option}"
            raise JournalError(f"{self.path} {self._difference(content)}", hint=hint)

    def rows(self) -> list[Row]:
        """Return the complete lines after the head."""
        text = self.path.read_bytes()[len(self.head.encode()) :]
        whole = text[: text.rfind(b"\n") + 1].decode("utf-8", errors="replace")
        return list(csv.reader(io.StringIO(whole, newline="")))

    def read(self, line: Callable[[int, Row], Any]) -> list[Any]:
        """Apply `line` to each line, with its number from 0."""
        rows = []
        for number, row in enumerate(self.resume()):
            try:
                if len(row) != len(self.columns) or (self.sealed and row != self._sealed(row[:-1])):
                    raise ValueError
                rows.append(line(number, row[:-1] if self.sealed else row))
            except ValueError:
                # The head has three lines; people count from 1.
                message = f"{self.path}: line {number + 4} is not that of {self.piece} {number}"
                hint = "remove this line and those after it, or the file"
                raise JournalError(message, hint=hint) from None
        return rows

    def append(self, rows: Iterable[Row]) -> None:
        """Append the next lines."""
        self._write("".join(map(csv_line, map(self._sealed, rows) if self.sealed else rows)))

    def _sealed(self, row: Row) -> list[str]:
        """Return a line with a digest of it and of the question."""
        return [*row, sha256((self.head + csv_line(row)).encode()).hexdigest()[:12]]

    def close(self) -> None:
        """Release the file for other work."""
        if self._file is not None:
            file, self._file = self._file, None
            with naming(self.path):
                file.close()

    def _write(self, text: str) -> None:
        file = self._held()
        with naming(self.path):
            file.write(text.encode())
            file.flush()

    def _difference(self, content: bytes) -> str:
        """Return the difference between the file's question and this one, in words."""
        lines = content.decode("utf-8", errors="replace").splitlines()
        if not content.startswith(self.first.encode()) or len(lines) < 2:
            return f"is not a {self.work} file"
        try:
            theirs = json.loads(lines[1].removeprefix("# "))
            ours = json.loads(self.head.splitlines()[1].removeprefix("# "))
        except ValueError:
            return f"is not a {self.work} file"
        return difference_words(theirs, ours, self.work)


def csv_line(cells: Row) -> str:
    """Return cells as a line of a CSV file."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue()


def difference_words(theirs: Mapping[str, Any], ours: Mapping[str, Any], work: str) -> str:
    """Return the difference between two questions in words."""
    for name in {**ours, **theirs}:
        theirs_value, ours_value = theirs.get(name), ours.get(name)
        if theirs_value == ours_value:
            continue
        if isinstance(theirs_value, dict) and isinstance(ours_value, dict):
            changed = next(
                part
                for part in {**theirs_value, **ours_value}
                if theirs_value.get(part) != ours_value.get(part)
            )
            return f"belongs to another {work}: {name} {changed} differs"
        was, now = json.dumps(theirs_value), json.dumps(ours_value)
        return f"belongs to another {work}: {name} was {was}, not {now}"
    return f"belongs to another {work}: it has other columns"


# --- The question ---


def question_of(fields: Mapping[str, Any], files: Mapping[str, Path]) -> dict[str, Any]:
    """Return all inputs of the results: fields of a request, contents of files, version."""
    from fuzzyarm.version import __version__

    return {"fuzzyarm": __version__, "arguments": dict(fields), "files": digests_of(files)}


def digests_of(files: Mapping[str, Path]) -> dict[str, str]:
    """Return digests of the contents of existing files, by name."""
    return {
        name: sha256(path.read_bytes()).hexdigest()[:16]
        for name, path in sorted(files.items())
        if path.is_file()
    }
