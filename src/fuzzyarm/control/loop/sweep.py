"""Sweeps: ranges as grids or for random draws, and the file of their results.

The file of a sweep is a journal (`fuzzyarm.requests.journal`) with a line for each run, in order.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import UsageError
from fuzzyarm.control.loop.many import SweepError, Vector, metric_names
from fuzzyarm.requests.journal import WorkJournal

# --- Ranges ---


class RangeError(SweepError, UsageError):
    """An invalid range, or one with too many values."""


@dataclass(frozen=True)
class Range:
    """Values of a swept name.

    Parameters
    ----------
    name : str
        See :func:`fuzzyarm.control.loop.simulate_many`.
    low, high : float
        Both ends are included.
    count : int, optional
        Number of values on a grid; 0 for random draws.
    log : bool, optional
        Whether values are spaced, or drawn, evenly in the logarithm.
    """

    name: str
    low: float
    high: float
    count: int = 0
    log: bool = False

    def __post_init__(self) -> None:
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low <= self.high):
            message = f"the range of '{self.name}' does not go up: {self.low:g}..{self.high:g}"
            raise RangeError(message, name=self.name, hint="the smaller end first, as in 0..2")
        if self.log and not self.low > 0.0:
            message = f"a logarithmic range of '{self.name}' cannot begin at {self.low:g}"
            raise RangeError(message, name=self.name, hint="both ends are positive")

    def at(self, share: Vector) -> Vector:
        """Return the values at fractions 0 to 1 of the range; exact at both ends."""
        if self.log:
            low, high = math.log(self.low), math.log(self.high)
            values = np.exp(low + (high - low) * share)
        else:
            values = self.low + (self.high - self.low) * share
        # exp(log(end)) may miss the end by its last bit.
        values = np.where(share >= 1.0, self.high, np.where(share <= 0.0, self.low, values))
        return np.clip(values, self.low, self.high)

    def values(self) -> Vector:
        """Return the values of a grid."""
        if self.count == 1:
            return np.array([self.low])
        return self.at(np.arange(self.count) / (self.count - 1))


MOST_VALUES = 1_000_000


def read_range(word: str) -> Range:
    """Read ``NAME=A..B:N``, ``NAME=A..B`` or ``NAME=A..B:N log``."""
    hint = "as in payload=0..2:21, G_e=100..3000:10 log, or J=0.01..0.03 where values are drawn"
    name, equals, text = word.strip().partition("=")
    text, log = text.strip(), text.strip().endswith("log")
    ends, colon, count = text.removesuffix("log").strip().partition(":")
    low, dots, high = ends.partition("..")
    try:
        if not (name.strip() and equals and dots):
            raise ValueError
        numbers = float(low), float(high), int(count) if colon else 0
    except ValueError:
        raise RangeError(f"'{word}' is not a range", name=name.strip(), hint=hint) from None
    if colon and not 1 <= numbers[2] <= MOST_VALUES:
        message = f"a range of '{name.strip()}' has 1 to {MOST_VALUES:,} values, not {count}"
        raise RangeError(message, name=name.strip())
    return Range(name.strip(), *numbers, log=log)


def grid(ranges: Sequence[Range]) -> dict[str, Vector]:
    """Return the runs of a grid as columns; the last range varies fastest."""
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
    """Return uniform random runs as columns; a larger count begins with the same runs."""
    require_different(ranges)
    for interval in ranges:
        if interval.count:
            message = f"'{interval.name}' has a number of values, and values are to be drawn"
            hint = f"{interval.name}={interval.low:g}..{interval.high:g}"
            raise SweepError(message, name=interval.name, hint=hint)
    shares = np.random.default_rng(seed).random((count, len(ranges)))
    return {interval.name: interval.at(shares[:, at]) for at, interval in enumerate(ranges)}


def require_different(ranges: Sequence[Range]) -> None:
    """Raise SweepError for a duplicate name."""
    names = [interval.name for interval in ranges]
    for name in names:
        if names.count(name) > 1:
            raise SweepError(f"'{name}' is swept twice", name=name)


def whole(columns: Mapping[str, Vector]) -> dict[str, Vector]:
    """Return the columns with integer seeds."""
    return {
        name: np.floor(values) if name == "seed" else values for name, values in columns.items()
    }


# --- The file ---


class SweepFile:
    """The journal of a sweep: a CSV file with a line for each run.

    Parameters
    ----------
    path : path-like
        Path of a CSV file.
    question : mapping
        All settings that determine the results, as JSON values.
    columns : mapping of str to ndarray
        First columns of every line, shape (runs,) each: swept values and the seed.
    outputs : sequence of str
        Names of the measured quantities.
    units : mapping of str to str, optional
        Units of columns by name, stored beside the question: a column is found by its name.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        question: Mapping[str, Any],
        columns: Mapping[str, NDArray[Any]],
        outputs: Sequence[str],
        units: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self.columns = columns
        self.count = len(next(iter(columns.values())))
        names = ["run", *columns, "diverged", *metric_names(outputs)]
        head = {**question, "units": dict(units)} if units else question
        self.journal = WorkJournal(path, "sweep", head, names)
        self.path = self.journal.path

    def begin(self) -> None:
        """Write the head, replacing any old file."""
        self.journal.begin(self.count)

    def close(self) -> None:
        """Release the file for other processes."""
        self.journal.close()

    def resume(self) -> Vector:
        """Return the rows in the file: divergence and metrics; an incomplete line is cut off."""
        front = len(self.columns) + 1

        def values(run: int, cells: Sequence[str]) -> list[float]:
            if run >= self.count or list(cells[:front]) != self._front(run):
                raise ValueError
            return [float(cell) if cell else math.nan for cell in cells[front:]]

        rows = self.journal.read(values)
        return np.array(rows, dtype=float).reshape(len(rows), len(self.journal.columns) - front)

    def append(self, first: int, rows: Iterable[Vector]) -> None:
        """Append the rows of the next runs, starting with run `first`."""
        self.journal.append(
            [*self._front(run), *("" if math.isnan(value) else repr(float(value)) for value in row)]
            for run, row in enumerate(rows, first)
        )

    def _front(self, run: int) -> list[str]:
        values = [column[run].item() for column in self.columns.values()]
        return [str(run), *map(_cell, values)]


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else repr(value)
