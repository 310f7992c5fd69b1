"""What a table says of itself besides its values. No numpy, so that checking a file is quick."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from fuzzyarm.lut.axis import Axis, TableError, mode_named


@dataclass(frozen=True, eq=False)
class TableHeader:
    """The axes of a table, its output, and where it came from.

    Attributes
    ----------
    axes : tuple of Axis
        In the order of the indices: the last is the column of the grid in a file, the
        one before it the row, any others the pages.
    output : str
        The name of the output.
    low, high : float or None
        The range of the output, where it is known.
    description : str
        Free text on the output, with the unit.
    rounding : float or None
        The step that the values were rounded to.
    mode : str or None
        How the table wants to be looked up; None: by bins where it has bins, else nearest.
    provenance : tuple of (str, str)
        What is known of its making, in order: the source file, its hash, the options.
    """

    axes: tuple[Axis, ...]
    output: str
    low: float | None = field(default=None, kw_only=True)
    high: float | None = field(default=None, kw_only=True)
    description: str = field(default="", kw_only=True)
    rounding: float | None = field(default=None, kw_only=True)
    mode: str | None = field(default=None, kw_only=True)
    provenance: tuple[tuple[str, str], ...] = field(default=(), kw_only=True)

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
            raise TableError(f"the range of '{self.output}' has one end only")
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

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the axes, in order."""
        return tuple(axis.name for axis in self.axes)

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of levels of each axis."""
        return tuple(len(axis.levels) for axis in self.axes)

    @property
    def default_mode(self) -> str:
        """How `lookup` works where nothing else is asked for."""
        if self.mode is not None:
            return self.mode
        return "bins" if any(axis.bins is not None for axis in self.axes) else "nearest"

    def axis(self, name: str) -> Axis:
        """Return the axis called `name`; raise KeyError where there is none."""
        for axis in self.axes:
            if axis.name == name:
                return axis
        raise KeyError(name)

    def head(self) -> tuple[object, ...]:
        """Return everything but the values, to compare two tables."""
        return (
            self.axes,
            self.output,
            self.low,
            self.high,
            self.description,
            self.rounding,
            self.mode,
            self.provenance,
        )


@dataclass(frozen=True, eq=False)
class PlainTable(TableHeader):
    """A table as read from text: its values in one flat tuple, the last axis fastest."""

    values: tuple[float, ...] = field(kw_only=True)
