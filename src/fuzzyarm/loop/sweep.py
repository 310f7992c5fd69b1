"""Sweeps: ranges that span a grid or are drawn from, and the file that holds what came of them.

A file of a sweep begins with what was asked and the units, as JSON behind a ``#``; a heading
follows, and a line for each run in the order of the runs. So the file of a sweep that was
interrupted is the front of the whole one, and to go on means to write what is missing.
"""

from __future__ import annotations

import itertools
import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.loop.many import SweepError, Vector, metric_names
from fuzzyarm.text.files import write_atomically

# --- Ranges ---


@dataclass(frozen=True)
class Range:
    """Values of a name that differs from run to run.

    Parameters
    ----------
    name : str
        See :func:`fuzzyarm.loop.many.simulate_many`.
    low, high : float
        Both ends belong to it.
    count : int, optional
        Values on a grid; 0 where they are drawn.
    log : bool, optional
        Whether they are spaced, or drawn, evenly in the logarithm.
    """

    name: str
    low: float
    high: float
    count: int = 0
    log: bool = False

    def __post_init__(self) -> None:
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low <= self.high):
            message = f"the range of '{self.name}' does not go up: {self.low:g}..{self.high:g}"
            raise SweepError(message, name=self.name, hint="the smaller end first, as in 0..2")
        if self.log and not self.low > 0.0:
            message = f"a logarithmic range of '{self.name}' cannot begin at {self.low:g}"
            raise SweepError(message, name=self.name, hint="both ends are positive")

    def at(self, share: Vector) -> Vector:
        """Return the values at shares of the way, 0 to 1; exact at both ends."""
        if self.log:
            low, high = math.log(self.low), math.log(self.high)
            values = np.exp(low + (high - low) * share)
        else:
            values = self.low + (self.high - self.low) * share
        # An exponential of a logarithm may miss the end by its last bit.
        values = np.where(share >= 1.0, self.high, np.where(share <= 0.0, self.low, values))
        return np.clip(values, self.low, self.high)

    def values(self) -> Vector:
        """Return the values of a grid."""
        if self.count == 1:
            return np.array([self.low])
        return self.at(np.arange(self.count) / (self.count - 1))


MOST_VALUES = 1_000_000


def read_range(word: str) -> Range:
    """Read ``NAME=A..B:N``, ``NAME=A..B`` or ``NAME=A..B:N log``.

    Raises
    ------
    SweepError
        If it is none of these.
    """
    hint = "as in payload=0..2:21, G_e=100..3000:10 log, or J=0.01..0.03 where values are drawn"
    name, equals, text = word.strip().partition("=")
    text, log = text.strip(), text.strip().endswith("log")
    ends, colon, count = text.removesuffix("log").strip().partition(":")
    low, dots, high = ends.partition("..")
    try:
        if not (name.strip() and equals and dots):
            raise ValueError
        found = float(low), float(high), int(count) if colon else 0
        if colon and not 1 <= found[2] <= MOST_VALUES:
            raise ValueError
    except ValueError:
        raise SweepError(f"'{word}' is not a range", name=name.strip(), hint=hint) from None
    return Range(name.strip(), *found, log=log)


def grid(ranges: Sequence[Range]) -> dict[str, Vector]:
    """Return the runs of a grid as columns; the last range varies fastest.

    Raises
    ------
    SweepError
        If a name comes twice, or a range does not say how many values it has.
    """
    require_different(ranges)
    for interval in ranges:
        if not interval.count:
            words = f"{interval.name}={interval.low:g}..{interval.high:g}:10"
            hint = f"{words}, or --random N for values drawn"
            raise SweepError(
                f"'{interval.name}' has no number of values", name=interval.name, hint=hint
            )
    if not ranges:
        return {}
    columns = np.meshgrid(*(interval.values() for interval in ranges), indexing="ij")
    return {interval.name: column.ravel() for interval, column in zip(ranges, columns, strict=True)}


def drawn(ranges: Sequence[Range], count: int, seed: int) -> dict[str, Vector]:
    """Return runs drawn from ranges, evenly, as columns; more runs begin with the same ones.

    Raises
    ------
    SweepError
        If a name comes twice, or a range has a number of values.
    """
    require_different(ranges)
    for interval in ranges:
        if interval.count:
            message = f"'{interval.name}' has a number of values, and values are to be drawn"
            hint = f"{interval.name}={interval.low:g}..{interval.high:g}"
            raise SweepError(message, name=interval.name, hint=hint)
    shares = np.random.default_rng(seed).random((count, len(ranges)))
    return {interval.name: interval.at(shares[:, at]) for at, interval in enumerate(ranges)}


def require_different(ranges: Sequence[Range]) -> None:
    """Raise SweepError if a name comes twice."""
    names = [interval.name for interval in ranges]
    for name in names:
        if names.count(name) > 1:
            raise SweepError(f"'{name}' is swept twice", name=name)


def whole(columns: Mapping[str, Vector]) -> dict[str, Vector]:
    """Return columns with whole seeds."""
    return {
        name: np.floor(values) if name == "seed" else values for name, values in columns.items()
    }


# --- The file ---

HEAD = "# fuzzyarm sweep 1\n"


class SweepFileError(SweepError):
    """A file is not what the sweep would go on with."""


class SweepFile:
    """A file that grows by a line for each run.

    Parameters
    ----------
    path : path-like
        Of a CSV file.
    question : mapping
        What was asked: all that the results depend on, as JSON takes it.
    columns : mapping of str to ndarray
        What every line begins with, shape (runs,) each: what differs, and the seed.
    outputs : sequence of str
        What the metrics are of.
    units : mapping of str to str, optional
        Of columns, by their names; they stand beside the question, for a column is found by its
        name.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        question: Mapping[str, Any],
        columns: Mapping[str, NDArray[Any]],
        outputs: Sequence[str],
        units: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self.path = Path(path)
        self.columns = columns
        self.count = len(next(iter(columns.values())))
        self.names = ["run", *columns, "diverged", *metric_names(outputs)]
        head = {**question, "units": dict(units)} if units else question
        asked = json.dumps(head, sort_keys=True, ensure_ascii=False)
        self.head = f"{HEAD}# {asked}\n{','.join(map(quoted, self.names))}\n"

    def begin(self) -> None:
        """Write the head; what was there is gone.

        Raises
        ------
        SweepFileError
            If the file holds a part of the same sweep.
        """
        if self.path.is_file() and self.path.read_bytes().startswith(self.head.encode()):
            rows = len(self.resume())
            if 0 < rows < self.count:
                message = f"{self.path} has {rows} of the {self.count} runs"
                hint = "--resume goes on, or remove the file"
                raise SweepFileError(message, hint=hint)
        write_atomically(self.path, self.head)

    def resume(self) -> Vector:
        """Return the rows of the file: divergence and metrics; a line that is torn is cut off.

        Raises
        ------
        SweepFileError
            If something else was asked, or a line is damaged.
        OSError
            If the file cannot be read.
        """
        content = self.path.read_bytes()
        if not content.startswith(self.head.encode()):
            raise SweepFileError(f"{self.path} {self._difference(content)}", hint="give another -o")
        text = content[len(self.head.encode()) :]
        whole_lines = text[: text.rfind(b"\n") + 1]
        if len(whole_lines) < len(text):
            os.truncate(self.path, len(content) - len(text) + len(whole_lines))
        lines = whole_lines.decode("utf-8", errors="replace").splitlines()
        front = len(self.columns) + 1
        rows = np.full((len(lines), len(self.names) - front), np.nan)
        for at, line in enumerate(lines):
            words = line.split(",")
            expected = self._front(at) if at < self.count else []
            try:
                if words[:front] != expected or len(words) != len(self.names):
                    raise ValueError
                rows[at] = [float(word) if word else math.nan for word in words[front:]]
            except ValueError:
                message = f"{self.path}: line {at + 4} is not that of run {at}"
                raise SweepFileError(message, hint="remove what follows it, or the file") from None
        return rows

    def append(self, first: int, rows: Iterable[Vector]) -> None:
        """Write the rows of some runs, the first of which is the next that is missing."""
        with self.path.open("a", encoding="utf-8", newline="\n") as file:
            for at, row in enumerate(rows, first):
                words = ["" if math.isnan(value) else repr(float(value)) for value in row]
                file.write(",".join([*self._front(at), *words]) + "\n")

    def _front(self, at: int) -> list[str]:
        values = [column[at].item() for column in self.columns.values()]
        return [str(at), *("" if math.isnan(value) else repr(value) for value in values)]

    def _difference(self, content: bytes) -> str:
        """Say what the file asks that this sweep does not."""
        lines = content.decode("utf-8", errors="replace").splitlines()
        if not content.startswith(HEAD.encode()) or len(lines) < 2:
            return "is not a sweep file"
        try:
            theirs = json.loads(lines[1].removeprefix("# "))
            ours = json.loads(self.head.splitlines()[1].removeprefix("# "))
        except ValueError:
            return "is not a sweep file"
        names = [name for name in {**ours, **theirs} if ours.get(name) != theirs.get(name)]
        for name in names:
            asked, given = theirs.get(name), ours.get(name)
            if isinstance(asked, dict) and isinstance(given, dict):
                parts = itertools.chain(asked, given)
                changed = next(part for part in parts if asked.get(part) != given.get(part))
                return f"belongs to another sweep: {name} {changed} differs"
            return (
                f"belongs to another sweep: {name} was {json.dumps(asked)}, not {json.dumps(given)}"
            )
        return "belongs to another sweep: it has other columns"


def quoted(name: str) -> str:
    """Return a heading as CSV has it."""
    return '"' + name.replace('"', '""') + '"' if any(c in name for c in ',"') else name
