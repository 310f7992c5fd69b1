"""Samples to learn from and to judge by: CSV and Parquet files, data frames, arrays, tables.

A sample is a row: one value for each input, and the corresponding target. The faults of a file are
reported with line and column, all in one run.
"""

from __future__ import annotations

import csv
import io
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyarm.base.diagnostic import (
    MAX_INPUTS,
    NOWHERE,
    Diagnostic,
    RuleBaseError,
    Span,
    split_lines,
)
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.protected import note_source
from fuzzyarm.base.shown import one_line
from fuzzyarm.inference import infer
from fuzzyarm.language.reading import decoded

if TYPE_CHECKING:
    from fuzzyarm.language.model.rulebase import RuleBase
    from fuzzyarm.table import LookupTable

Array = NDArray[np.float64]

SUFFIXES = (".csv", ".tsv", ".txt", ".parquet")
"""Suffixes of sample files."""

MOST_FINDINGS = 20
"""Largest number of findings for a file; a column of the wrong type would have one in each line."""


class DataError(RuleBaseError):
    """Invalid samples; ``diagnostics`` have the faults with positions."""


class ColumnError(FuzzyarmError, LookupError):
    """An unknown column.

    Attributes
    ----------
    name : str
        The requested name.
    columns : tuple of str
        The existing columns.
    """

    def __init__(self, name: str, columns: Sequence[str]) -> None:
        hint, _ = near_hint(name, columns)
        listed = ", ".join(columns[:10])
        super().__init__(f"there is no column '{name}'", hint=hint or f"there are: {listed}")
        self.name, self.columns = name, tuple(columns)


@dataclass(frozen=True, eq=False, repr=False)
class Samples:
    """Rows of data: inputs and targets.

    Attributes
    ----------
    names : tuple of str
        Names of the inputs.
    inputs : ndarray of float64, shape (samples, inputs)
        Finite.
    target : str
        Name of the target.
    values : ndarray of float64, shape (samples,)
        The target; with `classes`, the index of each sample's class.
    classes : tuple of str
        Classes of a categorical target, in alphabetical order; empty for numbers.
    source : str
        Origin of the samples, for comments.
    notes : tuple of str
        Assumptions of the reader, a sentence each.
    """

    names: tuple[str, ...]
    inputs: Array
    target: str
    values: Array
    classes: tuple[str, ...] = ()
    source: str = ""
    notes: tuple[str, ...] = field(default=())

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        kind = f"{len(self.classes)} classes" if self.classes else "numbers"
        words = f"{len(self)} rows of {', '.join(self.names)} → {self.target}, {kind}"
        return one_line(self, words)

    @property
    def outputs(self) -> Array:
        """The outputs for a model, shape (samples, outputs): values, or 1 for the class."""
        if not self.classes:
            return self.values[:, None]
        return np.equal(self.values[:, None], np.arange(len(self.classes))).astype(float)

    def part(self, rows: NDArray[Any]) -> Samples:
        """Return some of the samples, by their indices."""
        return Samples(
            self.names, self.inputs[rows], self.target, self.values[rows], self.classes, self.source
        )

    def renamed(self, target: str) -> Samples:
        """Return the samples with another name of the target."""
        return replace(self, target=target)

    def in_classes(self, classes: tuple[str, ...]) -> Samples:
        """Return the samples with the classes of other ones; an error for a class not there."""
        if bool(classes) != bool(self.classes):
            kind = "words" if classes else "numbers"
            message = f"'{self.target}' must have {kind}, as in the samples of the model"
            raise _refused("wrong-target", message, self.source)
        unknown = [name for name in self.classes if name not in classes]
        if unknown:
            message = f"'{self.target}' has '{unknown[0]}', which the model does not know"
            raise _refused("unknown-class", message, self.source)
        turned = np.array([float(classes.index(name)) for name in self.classes])
        values = turned[self.values.astype(int)] if classes else self.values
        return replace(self, values=values, classes=classes)


@dataclass(frozen=True)
class Columns:
    """A selection of columns in a file.

    Attributes
    ----------
    target : str or None
        The target column; None: the last one.
    inputs : tuple of str or None
        None: all other columns.
    target_needed : bool
        Whether a file without the target is at fault; its values are NaN otherwise.
    """

    target: str | None = None
    inputs: tuple[str, ...] | None = None
    target_needed: bool = True


LAST = Columns()
"""The last column is the target, all others are inputs."""


# --- From arrays and frames ---


def as_samples(
    inputs: ArrayLike,
    values: ArrayLike,
    names: Sequence[str] | None = None,
    target: str = "y",
    source: str = "",
) -> Samples:
    """Return samples in arrays.

    Parameters
    ----------
    inputs : array_like, shape (samples, inputs)
        A vector is one input.
    values : array_like, shape (samples,)
        Values of the target.
    names : sequence of str, optional
        Names of the inputs; x1, x2 … by default.
    target, source : str
        Name of the target, and origin of the samples.

    Raises
    ------
    DataError
        If the shapes do not fit or a value is not a finite number.
    """
    try:
        x = np.asarray(inputs, dtype=float)
        y = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise _refused("not-a-number", "samples must be numbers") from None
    x = x[:, None] if x.ndim == 1 else x
    if x.ndim != 2 or y.shape != x.shape[:1]:
        shapes = f"inputs have the shape {x.shape}, values {y.shape}"
        raise _refused("bad-shape", f"{shapes}: one row of inputs for each value is needed")
    input_names = tuple(f"x{k + 1}" for k in range(x.shape[1])) if names is None else tuple(names)
    if len(input_names) != x.shape[1]:
        raise _refused("bad-shape", f"{len(input_names)} names for {x.shape[1]} inputs")
    for name, column in (*zip(input_names, x.T, strict=True), (target, y)):
        if not np.isfinite(column).all():
            row = int(np.flatnonzero(~np.isfinite(column))[0])
            raise _refused("not-finite", f"'{name}' is not a finite number in sample {row + 1}")
    return _checked(Samples(input_names, x, target, y, source=source))


def frame_samples(frame: Any, columns: Columns = LAST, source: str = "") -> Samples:
    """Return samples in a data frame of pandas.

    Parameters
    ----------
    frame : DataFrame
        A row for each sample.
    columns : Columns, optional
        Which are inputs, which the target; by default the last is the target.
    source : str
        Origin, for comments.

    Raises
    ------
    DataError
        If a column does not consist of finite numbers; a target may consist of words.
    ColumnError
        If a column is unknown.
    """
    names = [str(name) for name in frame.columns]
    cells = [[_cell_text(cell) for cell in frame.iloc[:, k].tolist()] for k in range(len(names))]
    rows = [list(row) for row in zip(*cells, strict=True)]
    nowhere = (NOWHERE,) * len(names)
    return _Cells(names, rows, lambda _row: nowhere, source).samples(columns)


def _cell_text(cell: Any) -> str:
    missing = cell is None or (isinstance(cell, float) and math.isnan(cell))
    if missing or type(cell).__name__ in {"NAType", "NaTType"}:
        return ""
    return repr(float(cell)) if isinstance(cell, bool | int | float) else str(cell)


def table_samples(table: LookupTable, source: str = "") -> Samples:
    """Return every cell of a lookup table as a sample: its levels, and its value.

    Parameters
    ----------
    table : LookupTable
        The sampled table.
    source : str
        Origin, for comments.
    """
    mesh = np.meshgrid(*(np.array(axis.levels) for axis in table.axes), indexing="ij")
    inputs = np.stack([coordinate.ravel() for coordinate in mesh], axis=1)
    return as_samples(inputs, table.values.ravel(), table.names, table.output, source)


def rulebase_samples(
    rulebase: RuleBase,
    target: str | None = None,
    count: int = 4096,
    seed: int = 0,
    source: str = "",
) -> Samples:
    """Return samples of an output of a rule base, spread over the ranges of its inputs.

    Parameters
    ----------
    rulebase : RuleBase
        The sampled rule base.
    target : str, optional
        The output, if there are several.
    count : int
        Number of samples.
    seed : int
        Seed of their positions.
    source : str
        Origin, for comments.

    Raises
    ------
    ColumnError
        If the output is unknown.
    DataError
        If an input has no end.
    """
    names = [output.name for output in rulebase.outputs]
    target = names[0] if target is None and len(names) == 1 else target
    if target not in names:
        raise ColumnError(target or "--target", names)
    ranges = {variable.name: (variable.low, variable.high) for variable in rulebase.inputs}
    for name, ends in ranges.items():
        if not all(map(math.isfinite, ends)):
            raise _refused("unbounded-input", f"the range of '{name}' has no end", source)

    def value(**inputs: Array) -> ArrayLike:
        values: Array = infer(rulebase, inputs, outputs=(target,))[target]
        return values

    return replace(function_samples(value, ranges, count, target, seed), source=source)


def function_samples(
    function: Callable[..., ArrayLike],
    ranges: Mapping[str, tuple[float, float]],
    count: int = 2048,
    target: str = "y",
    seed: int = 0,
) -> Samples:
    """Return samples of a function, spread over its ranges by a scrambled Sobol sequence.

    Parameters
    ----------
    function : callable
        From an array for each input, by name, to an array.
    ranges : mapping of str to (float, float)
        The lowest and highest value of each input.
    count : int
        Samples; the next power of two is taken.
    target : str
        Name of the target.
    seed : int
        Seed of the scrambling.
    """
    from scipy.stats import qmc

    sobol = qmc.Sobol(len(ranges), rng=np.random.default_rng(seed))
    unit = sobol.random_base2(max(1, math.ceil(math.log2(count))))
    low, high = np.array(list(ranges.values()), dtype=float).T
    inputs = low + unit * (high - low)
    values = function(**dict(zip(ranges, inputs.T, strict=True)))
    values = np.broadcast_to(np.asarray(values, dtype=float), inputs.shape[:1])
    return as_samples(inputs, values, tuple(ranges), target, getattr(function, "__name__", ""))


# --- From files ---


def read_samples(path: str | os.PathLike[str], columns: Columns = LAST) -> Samples:
    """Return the samples in a file.

    Parameters
    ----------
    path : path-like
        CSV (``.csv``, ``.tsv``, ``.txt``: commas, semicolons, tabs or blanks between the
        cells, with or without a line of names) or Parquet (``.parquet``).
    columns : Columns
        The selected columns. A target of words has classes.

    Raises
    ------
    DataError
        If the file is at fault; it carries every finding, with line and column.
    ColumnError
        If a column is unknown.
    OSError
        If the file cannot be read.
    """
    name = os.fspath(path)
    note_source(path)
    if name.lower().endswith(".parquet"):
        return frame_samples(_frame(name), columns, name)
    with open(path, "rb") as file:
        text = decoded(file.read(), name)
    return parse_csv(text, name, columns)


def column_names(path: str | os.PathLike[str]) -> tuple[str, ...]:
    """Return the names of the columns of a file; errors as :func:`read_samples`."""
    name = os.fspath(path)
    if name.lower().endswith(".parquet"):
        return tuple(str(column) for column in _frame(name).columns)
    with open(path, "rb") as file:
        return tuple(_cells(decoded(file.read(), name), name)[0].names)


def read_columns(path: str | os.PathLike[str], names: Sequence[str]) -> dict[str, Array]:
    """Return columns of numbers of a CSV file by name; an empty cell is NaN.

    Errors as :func:`read_samples`.
    """
    name = os.fspath(path)
    with open(path, "rb") as file:
        cells, _ = _cells(decoded(file.read(), name), name)
    return cells.columns(names)


def _frame(name: str) -> Any:
    """Return the data frame in a Parquet file."""
    from importlib.util import find_spec

    from fuzzyarm.base.extras import installing

    if not (find_spec("pandas") and find_spec("pyarrow")):
        message = "a Parquet file needs pandas and pyarrow"
        raise _refused("missing-extra", message, name, installing("data"))
    import pandas

    try:
        return pandas.read_parquet(name)
    except OSError as error:
        if error.errno is not None:
            raise
        raise _refused("not-parquet", f"not a Parquet file: {error}", name) from None
    except Exception as error:  # readers raise anything
        raise _refused("not-parquet", f"not a Parquet file: {error}", name) from None


def parse_csv(text: str, path: str = "<text>", columns: Columns = LAST) -> Samples:
    """Return the samples in the text of a CSV file; errors as :func:`read_samples`."""
    cells, notes = _cells(text, path)
    return cells.samples(columns, notes)


def _cells(text: str, path: str) -> tuple[_Cells, tuple[str, ...]]:
    """Return the cells of a CSV file, and the assumptions made."""
    lines = split_lines(text.removeprefix("\ufeff"))
    filled = [(n, line) for n, line in enumerate(lines, 1) if line.strip() and line[0] != "#"]
    if not filled:
        raise _refused("no-samples", "the file has no samples", path)
    mark = _delimiter(filled[0][1])
    comma = mark != "," and any(re.search(r"\d,\d", line) for _, line in filled[:50])
    first = _split(filled[0][1], mark)
    notes: tuple[str, ...] = ()
    if all(_number(cell, comma=comma) is not None for cell in first):
        names = [*(f"x{k + 1}" for k in range(len(first) - 1)), "y"]
        notes = (f"the file has no line of names: the columns are called {_listed(names)}",)
    else:
        names = [cell or f"x{k + 1}" for k, cell in enumerate(first)]
        del filled[0]
    rows = [_split(line, mark) for _, line in filled]
    return _Cells(names, rows, lambda row: _spans(*filled[row], mark), path, comma=comma), notes


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names if len(names) < 6 else [*names[:2], "…", names[-1]])


def _delimiter(line: str) -> str:
    """Return the delimiter of a line; blanks if there is no other."""
    counts = {mark: line.count(mark) for mark in (";", "\t", ",")}
    best = max(counts, key=counts.__getitem__)
    if counts[";"]:  # semicolons and commas: decimal commas
        return ";"
    return best if counts[best] else " "


def _split(line: str, mark: str) -> list[str]:
    """Return the cells of a line."""
    if mark == " ":
        return line.split()
    if '"' in line:
        try:
            cells = next(csv.reader(io.StringIO(line), delimiter=mark, skipinitialspace=True))
            return [cell.strip() for cell in cells]
        except csv.Error:  # a cell beyond the limit of csv
            pass
    return [cell.strip() for cell in line.split(mark)]


def _spans(number: int, line: str, mark: str) -> tuple[Span, ...]:
    """Return the spans of the cells of a line."""
    spans, start = [], 0
    for cell in _split(line, mark):
        at = line.find(cell, start)
        at = start if at < 0 else at  # quotes within quotes are not as in the text
        spans.append(Span(number, at + 1, number, at + max(len(cell), 1) + 1))
        following = line.find(mark, at + len(cell))
        start = len(line) if following < 0 else following + 1
    return tuple(spans)


def _number(cell: str, *, comma: bool = False) -> float | None:
    """Return the number in a cell, possibly infinite or NaN; None if it is not a number."""
    try:
        return float(cell.replace(",", ".") if comma else cell)
    except ValueError:
        return None


@dataclass(frozen=True)
class _Cells:
    """A rectangle of texts with their positions, on its way to samples."""

    names: list[str]
    rows: list[list[str]]
    spans: Callable[[int], tuple[Span, ...]]  # of the cells of a row, by its index
    path: str
    comma: bool = False

    def samples(self, columns: Columns, notes: tuple[str, ...] = ()) -> Samples:
        """Return the samples; raise DataError with all faults."""
        self._check_names()
        wrong = self._wrong_lengths()
        target = self.names[-1] if columns.target is None else columns.target
        names_wanted = columns.inputs
        inputs = (
            [name for name in self.names if name != target]
            if names_wanted is None
            else names_wanted
        )
        column_names = [*inputs, *([target] if columns.target_needed else [])]
        for name in column_names:
            if name not in self.names:
                raise ColumnError(name, self.names)
        values, classes = self._target(target, wrong)
        columns_read = [self._column(self.names.index(name), wrong) for name in inputs]
        if wrong:
            raise _all_of(wrong)
        array = np.stack(columns_read, axis=1) if columns_read else np.empty((len(values), 0))
        return _checked(Samples(tuple(inputs), array, target, values, classes, self.path, notes))

    def columns(self, names: Sequence[str]) -> dict[str, Array]:
        """Return columns in which a value may be missing, infinite or NaN."""
        self._check_names()
        wrong = self._wrong_lengths()
        if not self.rows:
            raise _refused("no-samples", "there are no samples", self.path)
        read = {name: self._column(self.names.index(name), wrong, lost=True) for name in names}
        if wrong:
            raise _all_of(wrong)
        return read

    def _target(self, name: str, wrong: list[Diagnostic]) -> tuple[Array, tuple[str, ...]]:
        """Return the values of the target, and its classes if it has words."""
        if name not in self.names:
            return np.full(len(self.rows), math.nan), ()
        at = self.names.index(name)
        texts = [row[at] for row in self.rows if len(row) == len(self.names)]
        if any(not text or _number(text, comma=self.comma) is not None for text in texts):
            return self._column(at, wrong), ()
        classes = tuple(sorted(set(texts)))
        index = {word: float(k) for k, word in enumerate(classes)}
        return np.array([index[text] for text in texts]), classes

    def _check_names(self) -> None:
        twice = [name for k, name in enumerate(self.names) if name in self.names[:k]]
        if twice:
            message = f"two columns are called '{twice[0]}'"
            raise _refused("duplicate-column", message, self.path)
        if len(self.names) < 2:
            message = "only one column: an input and a target are needed"
            raise _refused("no-inputs", message, self.path)

    def _wrong_lengths(self) -> list[Diagnostic]:
        count = len(self.names)
        return [
            self._finding(
                "wrong-cell-count",
                f"{len(row)} cells, the first line has {count}",
                self.spans(k)[0].to(self.spans(k)[-1]),
            )
            for k, row in enumerate(self.rows)
            if len(row) != count
        ]

    def _column(self, at: int, wrong: list[Diagnostic], *, lost: bool = False) -> Array:
        values = np.empty(len(self.rows))
        name = self.names[at]
        for k, row in enumerate(self.rows):
            if len(row) != len(self.names):
                continue  # reported by its length
            number = _number(row[at] or ("nan" if lost else ""), comma=self.comma)
            if number is None or not (lost or math.isfinite(number)):
                if not row[at]:
                    message = f"no value of '{name}' in sample {k + 1}"
                    kind = "missing-value"
                else:
                    message = f"'{row[at]}' is not a finite number ('{name}', sample {k + 1})"
                    kind = "not-a-number"
                if len(wrong) < MAX_INPUTS * MOST_FINDINGS:
                    wrong.append(self._finding(kind, message, self.spans(k)[at]))
                number = math.nan
            values[k] = number
        return values

    def _finding(self, name: str, message: str, span: Span) -> Diagnostic:
        return Diagnostic(name, message, span, path=self.path)


def _checked(samples: Samples) -> Samples:
    """Return samples that something can be learned from."""
    if not len(samples):
        raise _refused("no-samples", "there are no samples", samples.source)
    if not samples.names:
        raise _refused("no-inputs", "there are no inputs", samples.source)
    if len(samples.names) > MAX_INPUTS:
        message = f"{len(samples.names)} inputs are too many: a rule base has at most {MAX_INPUTS}"
        raise _refused("too-many-inputs", message, samples.source, "leave out the least relevant")
    if samples.target in samples.names:
        raise _refused("duplicate-column", f"'{samples.target}' is an input too", samples.source)
    largest = max(np.abs(samples.inputs).max(), np.abs(np.nan_to_num(samples.values)).max())
    if largest > 1e50:
        message = f"values up to {largest:.1e} are too large: scale them"
        raise _refused("too-large", message, samples.source)
    return samples


def _all_of(wrong: Sequence[Diagnostic]) -> DataError:
    """Return the first findings of a file, in the order of its lines."""
    return DataError(sorted(wrong, key=lambda finding: finding.span)[:MOST_FINDINGS])


def _refused(name: str, message: str, path: str = "", hint: str = "") -> DataError:
    return DataError((Diagnostic(name, message, hint=hint, path=path),))


# --- Parts of the samples ---


def folds(
    count: int, parts: int, *, series: bool = False, seed: int = 0
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Yield (training, test) indices of a cross-validation.

    Parameters
    ----------
    count : int
        Samples.
    parts : int
        Number of parts; at most that of samples.
    series : bool
        Whether the samples are in order of time: the parts are then blocks, since interpolation
        between known samples is easier than prediction.
    seed : int
        Seed of the random partition otherwise.
    """
    order = np.arange(count)
    if not series:
        order = np.random.default_rng(seed).permutation(count)
    for part in np.array_split(order, min(parts, count)):
        yield np.setdiff1d(order, part), np.sort(part)
