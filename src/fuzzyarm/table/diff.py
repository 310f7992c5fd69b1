"""Differences between two tables, cell by cell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.table.table import LookupTable


@dataclass(frozen=True, slots=True)
class CellChange:
    """A cell with different values."""

    index: tuple[int, ...]  # in the order of the axes of the first table
    levels: tuple[float, ...]  # the level of each axis there
    # The two values.
    before: float
    after: float


@json_properties("same comparable transposed header=settings cells")
@dataclass(frozen=True, slots=True)
class TableDiff:
    """The differences between two tables.

    Attributes
    ----------
    before, after : LookupTable
        `after` with its axes in the order of `before`, if they have the same names.
    header : tuple of (str, str, str)
        Other differences: field, before, after.
    changes : tuple of CellChange
        In index order; empty if the axes do not match.
    comparable : bool
        Whether both have the same inputs and levels, so that cells correspond.
    transposed : bool
        Whether the axes of the second table were reordered.
    """

    before: LookupTable
    after: LookupTable
    header: tuple[tuple[str, str, str], ...]
    changes: tuple[CellChange, ...]
    comparable: bool
    transposed: bool

    @property
    def same(self) -> bool:
        """Whether nothing differs, provenance and descriptions aside."""
        return self.comparable and not self.changes and not self.header and not self.transposed

    @property
    def settings(self) -> list[dict[str, str]]:
        """Differences of the header: name, before, after."""
        return [dict(zip(("what", "before", "after"), row, strict=True)) for row in self.header]

    @property
    def cells(self) -> list[dict[str, Any]]:
        """Cells that differ: their inputs, the value before and after."""
        return [
            {
                "inputs": dict(zip(self.before.names, change.levels, strict=True)),
                "before": change.before,
                "after": change.after,
            }
            for change in self.changes
        ]


def compare_tables(before: LookupTable, after: LookupTable) -> TableDiff:
    """Return the differences from `before` to `after`.

    Cells are matched by the names of the inputs, never by bare position: a table with its axes in
    another order is transposed first, with a note. If the first table lacks an input of the second,
    it counts as constant along that input.

    Parameters
    ----------
    before, after : LookupTable
        Two versions.
    """
    before = _spread(before, after)
    transposed = before.names != after.names and sorted(before.names) == sorted(after.names)
    if transposed:
        order = [after.names.index(name) for name in before.names]
        turned = np.transpose(after.values, order)
        axes = tuple(after.axes[k] for k in order)
        after = LookupTable(**after.head() | {"axes": axes}, values=turned.copy())
    comparable = before.names == after.names and all(
        a.levels == b.levels for a, b in zip(before.axes, after.axes, strict=True)
    )
    changes: tuple[CellChange, ...] = ()
    if comparable:
        values = np.argwhere(before.values != after.values)
        changes = tuple(_change(before, after, tuple(map(int, index))) for index in values)
    return TableDiff(before, after, _header(before, after), changes, comparable, transposed)


def _spread(before: LookupTable, after: LookupTable) -> LookupTable:
    """Repeat `before` along the inputs that only `after` has, if it has them all."""
    if set(before.names) == set(after.names) or not set(before.names) <= set(after.names):
        return before
    mine = [name for name in after.names if name in before.names]
    turned = np.transpose(before.values, [before.names.index(name) for name in mine])
    shape = [len(a.levels) if a.name in mine else 1 for a in after.axes]
    if [len(before.axis(name).levels) for name in mine] != [
        s for s, a in zip(shape, after.axes, strict=True) if a.name in mine
    ]:
        return before
    axes = tuple(before.axis(a.name) if a.name in mine else a for a in after.axes)
    values = np.broadcast_to(turned.reshape(shape), after.shape).copy()
    return LookupTable(**before.head() | {"axes": axes}, values=values)


def _change(before: LookupTable, after: LookupTable, index: tuple[int, ...]) -> CellChange:
    levels = tuple(axis.levels[i] for axis, i in zip(before.axes, index, strict=True))
    return CellChange(index, levels, float(before.values[index]), float(after.values[index]))


def _header(before: LookupTable, after: LookupTable) -> tuple[tuple[str, str, str], ...]:
    from fuzzyarm.base.numbers import short_bins, short_levels
    from fuzzyarm.table.header import range_text

    rows: list[tuple[str, str, str]] = [
        ("output", before.output, after.output),
        ("inputs", ", ".join(before.names), ", ".join(after.names)),
        (
            "range",
            range_text(before.low, before.high) or "none",
            range_text(after.low, after.high) or "none",
        ),
        ("round", str(before.rounding or "none"), str(after.rounding or "none")),
        ("mode", before.default_mode, after.default_mode),
    ]
    for axis in before.axes:
        if axis.name in after.names:
            other = after.axis(axis.name)
            rows.append(
                (f"levels {axis.name}", short_levels(axis.levels), short_levels(other.levels))
            )
            ranges = [range_text(a.low, a.high) for a in (axis, other)]
            rows.append((f"range {axis.name}", ranges[0], ranges[1]))
            bins = [short_bins(a.bins) if a.bins else "none" for a in (axis, other)]
            rows.append((f"bins {axis.name}", bins[0], bins[1]))
    return tuple(row for row in rows if row[1] != row[2])
