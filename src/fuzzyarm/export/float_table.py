"""A lookup table in floating point: its numbers as a machine holds them, and its arithmetic."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.export.errors import ExportError
from fuzzyarm.export.numbers import Precision, precision_named, rounded, rounded_down
from fuzzyarm.lut import LookupTable
from fuzzyarm.lut.axis import mode_named

MOST_AXES = 8
"""Interpolation over more inputs would take more than 256 corners."""

Reals = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class FloatTable:
    """A table whose inputs, cells and result are floating-point numbers.

    Attributes
    ----------
    table : LookupTable
        What it stands for.
    mode : str
        ``bins``, ``nearest`` or ``linear``.
    precision : Precision
        Types outside and inside.
    points : tuple of ndarray
        For each axis the thresholds between the cells, rounded down to the type (so that
        single precision decides as double precision does); with ``linear`` the levels.
    values : ndarray
        Flat, the last axis fastest.
    """

    table: LookupTable
    mode: str
    precision: Precision
    points: tuple[Reals, ...]
    values: Reals

    @property
    def linear(self) -> bool:
        """Whether it interpolates."""
        return self.mode == "linear"

    def evaluate(self, *inputs: Any) -> Reals:
        """Return what the exported function returns, bit for bit.

        Parameters
        ----------
        *inputs : array_like
            In the order of the axes; rounded to the outer type first.

        Returns
        -------
        ndarray
            Of the outer type. NaN counts as the lower border of its axis.
        """
        outside, inside = self.precision.outside, self.precision.inside
        with np.errstate(over="ignore"):
            given = np.broadcast_arrays(*(np.asarray(x, dtype=outside) for x in inputs))
        columns = [x.astype(inside) for x in given]
        result = self._interpolate(columns) if self.linear else self._pick(columns)
        return result.astype(outside)

    def _pick(self, columns: Sequence[Reals]) -> Reals:
        index = np.zeros(columns[0].shape, dtype=np.intp)
        for size, edges, x in zip(self.table.shape, self.points, columns, strict=True):
            # NaN is greater than no threshold.
            count = np.searchsorted(edges, np.where(np.isnan(x), -np.inf, x), side="left")
            index = index * size + count
        return np.asarray(self.values[index])

    def _interpolate(self, columns: Sequence[Reals]) -> Reals:
        base = np.zeros(columns[0].shape, dtype=np.intp)
        shares: list[Reals] = []
        steps: list[int] = []
        stride = self.values.size
        for levels, x in zip(self.points, columns, strict=True):
            stride //= levels.size
            if levels.size == 1:
                continue
            inside = np.where(x > levels[0], np.where(x < levels[-1], x, levels[-1]), levels[0])
            i = np.searchsorted(levels[1:-1], inside, side="right")
            shares.append((inside - levels[i]) / (levels[i + 1] - levels[i]))
            steps.append(stride)
            base = base + i * stride
        return self._blend(base, shares, steps)

    def _blend(self, index: NDArray[np.intp], shares: list[Reals], steps: list[int]) -> Reals:
        if not shares:
            return np.asarray(self.values[index])
        near = self._blend(index, shares[1:], steps[1:])
        far = self._blend(index + steps[0], shares[1:], steps[1:])
        one = self.precision.inside(1.0)
        return np.asarray((one - shares[0]) * near + shares[0] * far)


def float_table(
    table: LookupTable, mode: str | None = None, precision: str = "mixed"
) -> FloatTable:
    """Prepare a table for export in floating point.

    Parameters
    ----------
    table : LookupTable
        Any table.
    mode : str, optional
        The way to look up; the table's own by default.
    precision : str
        ``mixed``: float arguments and result, interpolation in double; ``float32``;
        ``float64``.

    Raises
    ------
    ExportError
        If a number is too large for the type, or levels coincide in it.
    """
    chosen = table.default_mode if mode is None else mode_named(mode)
    linear = chosen == "linear"
    if linear and len(table.axes) > MOST_AXES:
        raise ExportError(
            f"the table has {len(table.axes)} inputs; interpolation is exported for at most"
            f" {MOST_AXES}",
            hint="export it with --mode nearest",
        )
    types = precision_named(precision, arithmetic=linear)
    points = []
    for axis in table.axes:
        rounded((axis.levels[0], axis.levels[-1]), types.outside, f"axis '{axis.name}'")
        if linear:
            levels = rounded(axis.levels, types.inside, f"axis '{axis.name}'")
            _require_distinct(levels, axis.name)
            points.append(levels)
        else:
            edges = axis.thresholds(chosen)
            points.append(rounded_down(edges, types.inside, f"axis '{axis.name}'"))
    what = f"the table of '{table.output}'"
    rounded(table.values, types.outside, what)
    values = rounded(table.values.ravel(), types.inside, what)
    return FloatTable(table, chosen, types, tuple(points), values)


def _require_distinct(levels: Reals, name: str) -> None:
    for a, b in pairwise(levels.tolist()):
        if not a < b:
            raise ExportError(
                f"two levels of '{name}' are the same number ({a:g}) in single precision",
                hint="export with --precision mixed or float64",
            )
