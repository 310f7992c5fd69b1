"""The axes of a lookup table and its header: everything but its values.

No numpy, so that checking a file is quick.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.folders import TABLES
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.shown import Drawn, Plotted, one_line
from fuzzyarm.base.value_kinds import TABLE, OfKind
from fuzzyarm.language.model.lookup_modes import LOOKUP_MODES

SUFFIXES = TABLES
"""File formats that restore an identical table."""

# --- An axis: levels, bins, and the cell of a number ---

MODES = LOOKUP_MODES
"""Ways to look up: by uneven thresholds, by the nearest level, by linear interpolation."""

_ALIASES = {"bilinear": "linear", "multilinear": "linear"}


class TableError(FuzzyarmError, ValueError):
    """A table is invalid, or a question to it is."""


def mode_named(name: str) -> str:
    """Return the mode called `name`; ``bilinear`` and ``multilinear`` are ``linear``."""
    mode = _ALIASES.get(name, name)
    if mode not in MODES:
        raise TableError(f"unknown lookup mode '{name}'", hint=f"choose from {', '.join(MODES)}")
    return mode


@json_properties("name low high description levels bins")
@dataclass(frozen=True, slots=True, repr=False)
class Axis:
    """The division of one input of a table.

    Attributes
    ----------
    name : str
        The input.
    levels : tuple of float
        The sample points, strictly increasing; one at least.
    bins : tuple of float or None
        Thresholds between neighbouring cells, strictly increasing, one fewer than levels.
        None: the cell of the nearest level.
    low, high : float
        The range of the input, for drawings and reports; the outer levels by default.
        Infinite where the input is unbounded.
    description : str
        Free text, with the unit.

    Raises
    ------
    TableError
        If the numbers are not finite, do not increase or do not match in number.
    """

    name: str
    levels: tuple[float, ...]
    bins: tuple[float, ...] | None = None
    low: float = math.nan
    high: float = math.nan
    description: str = ""

    def __repr__(self) -> str:
        ends = f"{self.levels[0]:g} .. {self.levels[-1]:g}" if self.levels else "no levels"
        bins = "" if self.bins is None else ", bins"
        return one_line(self, f"{self.name}: {len(self.levels)} levels {ends}{bins}")

    def __post_init__(self) -> None:
        levels = _clean(self.levels)
        if not levels:
            raise TableError(f"axis '{self.name}' has no levels")
        _require_increasing(levels, f"the levels of '{self.name}'")
        if not math.isfinite(levels[-1] - levels[0]):
            raise TableError(f"the levels of '{self.name}' are too far apart")
        object.__setattr__(self, "levels", levels)
        if self.bins is not None:
            bins = _clean(self.bins)
            _require_increasing(bins, f"the bins of '{self.name}'")
            if len(bins) != len(levels) - 1:
                raise TableError(
                    f"axis '{self.name}' has {len(levels)} levels and so needs "
                    f"{len(levels) - 1} bins, not {len(bins)}"
                )
            object.__setattr__(self, "bins", bins)
        low, high = float(self.low) + 0.0, float(self.high) + 0.0
        low = levels[0] if math.isnan(low) else low
        high = levels[-1] if math.isnan(high) else high
        if low > high:
            raise TableError(f"the range of '{self.name}' runs from {low:g} down to {high:g}")
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "high", high)

    @property
    def ends(self) -> tuple[float, float]:
        """The range of the input; where an end is infinite, the outermost level."""
        low = self.low if math.isfinite(self.low) else self.levels[0]
        high = self.high if math.isfinite(self.high) else self.levels[-1]
        return low, high

    def thresholds(self, mode: str) -> tuple[float, ...]:
        """Return the thresholds between the cells for ``bins`` or ``nearest``.

        The cell of x is the number of thresholds smaller than x, so an x equal to a
        threshold belongs to the lower cell. The thresholds of ``nearest`` are the
        midpoints between the levels: a tie goes to the lower level.
        """
        if mode == "bins" and self.bins is not None:
            return self.bins
        levels = self.levels
        # Halves first: the sum of two levels near the largest double would overflow.
        return tuple(0.5 * a + 0.5 * b for a, b in itertools.pairwise(levels))

    def cell(self, x: float, mode: str = "bins") -> int:
        """Return the index of the cell of `x` by ``bins`` or by ``nearest``."""
        return bisect_left(self.thresholds(mode), x)

    def cell_range(self, index: int, mode: str = "bins") -> tuple[float, float]:
        """Return the interval (from, to] of inputs in cell `index`."""
        edges = (-math.inf, *self.thresholds(mode), math.inf)
        return edges[index], edges[index + 1]


def _clean(numbers: Iterable[float]) -> tuple[float, ...]:
    # Adding zero turns -0.0 into 0.0: two spellings of one level would never compare equal as text.
    return tuple(float(x) + 0.0 for x in numbers)


def _require_increasing(numbers: tuple[float, ...], what: str) -> None:
    for x in numbers:
        if not math.isfinite(x):
            raise TableError(f"{what} must be finite, not {x}")
    for a, b in itertools.pairwise(numbers):
        if a >= b:
            raise TableError(f"{what} must increase, but {b:g} follows {a:g}")


# --- The header ---


@json_properties("*")
class TableOutput(NamedTuple):
    """The output of a table.

    Attributes
    ----------
    name : str
        Its name.
    low, high : float or None
        The range, if known.
    bounded : bool
        Whether it is.
    description : str
        Free text, with the unit.
    """

    name: str
    low: float | None
    high: float | None
    bounded: bool
    description: str


@json_properties("output=of index=names axes round=rounding mode provenance")
@dataclass(frozen=True, eq=False, repr=False)
class TableHeader(Plotted, Drawn, OfKind):
    """The axes of a table, its output, and its origin.

    Attributes
    ----------
    axes : tuple of Axis
        In the order of the indices: the last is the column of the grid in a file, the
        one before it the row, any others the pages.
    output : str
        The name of the output.
    low, high : float or None
        The range of the output, if known.
    description : str
        Free text on the output, with the unit.
    rounding : float or None
        Step of the rounded values.
    mode : str or None
        Preferred lookup mode; None: by bins if it has bins, else nearest.
    provenance : tuple of (str, str)
        Its making, in order: the source file, its hash, the options.
    """

    kind_of_value = TABLE

    axes: tuple[Axis, ...]
    output: str
    low: float | None = field(default=None, kw_only=True)
    high: float | None = field(default=None, kw_only=True)
    description: str = field(default="", kw_only=True)
    rounding: float | None = field(default=None, kw_only=True)
    mode: str | None = field(default=None, kw_only=True)
    provenance: tuple[tuple[str, str], ...] = field(default=(), kw_only=True)

    def called(self) -> str:
        """Return the name of the output, for a message."""
        return self.output

    def __post_init__(self) -> None:
        object.__setattr__(self, "axes", tuple(self.axes))
        if not self.axes:
            raise TableError("a table needs at least one axis")
        names = [axis.name for axis in self.axes]
        for i, name in enumerate(names):
            if name in names[:i]:
                raise TableError(f"two axes are called '{name}'")
        self._check_numbers()
        pairs = self.provenance
        if isinstance(pairs, Mapping):
            pairs = tuple(pairs.items())
        object.__setattr__(self, "provenance", tuple((str(k), str(v)) for k, v in pairs))
        if self.mode is not None:
            object.__setattr__(self, "mode", mode_named(self.mode))

    def _check_numbers(self) -> None:
        if (self.low is None) != (self.high is None):
            raise TableError(f"the range of '{self.output}' has only one end")
        if self.low is not None and self.high is not None:
            low, high = float(self.low) + 0.0, float(self.high) + 0.0
            if not low <= high:
                raise TableError(f"the range of '{self.output}' runs from {low:g} down to {high:g}")
            object.__setattr__(self, "low", low)
            object.__setattr__(self, "high", high)
        if self.rounding is not None:
            rounding = float(self.rounding)
            if not 0 < rounding < math.inf:
                raise TableError(f"values are rounded to a positive step, not to {rounding:g}")
            object.__setattr__(self, "rounding", rounding)

    def __repr__(self) -> str:
        sizes = " × ".join(f"{axis.name} {len(axis.levels)}" for axis in self.axes)
        return one_line(self, f"{self.output}: {sizes}, {self.default_mode}")

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the axes, in order."""
        return tuple(axis.name for axis in self.axes)

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of levels of each axis."""
        return tuple(len(axis.levels) for axis in self.axes)

    @property
    def cells(self) -> int:
        """The number of values."""
        return math.prod(self.shape)

    @property
    def default_mode(self) -> str:
        """The lookup mode by default."""
        if self.mode is not None:
            return self.mode
        return "bins" if any(axis.bins is not None for axis in self.axes) else "nearest"

    @property
    def of(self) -> TableOutput:
        """The output."""
        bounded = self.low is not None
        return TableOutput(self.output, self.low, self.high, bounded, self.description)

    def axis(self, name: str) -> Axis:
        """Return the axis `name`; raise KeyError if there is none."""
        for axis in self.axes:
            if axis.name == name:
                return axis
        raise KeyError(name)

    def head(self) -> dict[str, Any]:
        """Return everything but the values: to compare two tables, or to make another one."""
        return {name: getattr(self, name) for name in TableHeader.__dataclass_fields__}


@dataclass(frozen=True, eq=False, repr=False)
class PlainTable(TableHeader):
    """A table as read from text: its values in one flat tuple, the last axis fastest."""

    values: tuple[float, ...] = field(kw_only=True)
