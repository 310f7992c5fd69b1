"""The lookup table: a grid of numbers that replaces a rule base at run time."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyarm.base.names import near_hint
from fuzzyarm.table.axis import PlainTable, TableError, TableHeader, mode_named
from fuzzyarm.table.lookup import AT_POINT, PreparedTable, look_up_arrays


@dataclass(frozen=True, eq=False, repr=False)
class LookupTable(TableHeader):
    """A grid of values over one or more inputs, with its meaning and its origin.

    Two tables are equal if axes, values and descriptions are.

    Attributes
    ----------
    values : ndarray of float64, read-only
        Shape: the number of levels of each axis, in the order of `axes`; finite.

    Examples
    --------
    >>> from fuzzyarm.table import Axis, LookupTable
    >>> axes = (Axis("e", (-1, 0, 1)), Axis("ce", (0, 10)))
    >>> table = LookupTable(axes, "u", [[0, 1], [2, 3], [4, 5]])
    >>> table.lookup(0.1, 9), table.lookup(0.5, 5, mode="linear")
    (3.0, 3.5)
    """

    values: NDArray[np.float64]

    def __post_init__(self) -> None:
        super().__post_init__()
        values = np.asarray(self.values, dtype=np.float64)
        if values.shape != self.shape:
            raise TableError(
                f"the values have shape {values.shape}, the axes of '{self.output}' "
                f"({', '.join(self.names)}) ask for {self.shape}"
            )
        if not np.isfinite(values).all():
            where = tuple(int(i) for i in np.argwhere(~np.isfinite(values))[0])
            raise TableError(f"the value of '{self.output}' at index {where} is not finite")
        if values.flags.writeable or not values.flags.c_contiguous:
            values = values.copy()
            values.setflags(write=False)
        object.__setattr__(self, "values", values)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, LookupTable):
            return NotImplemented
        return self.head() == other.head() and np.array_equal(self.values, other.values)

    def __getstate__(self) -> dict[str, object]:
        return {**self.head(), "values": self.values}

    def __hash__(self) -> int:
        return hash((*self.head().values(), self.values.tobytes()))

    @property
    def reach(self) -> tuple[float, float]:
        """The range of the output; where an end is not stated or infinite, that of its values."""
        ends = (self.low, self.high)
        reached = (float(self.values.min()), float(self.values.max()))
        low, high = (
            limit if end is None or not math.isfinite(end) else end
            for end, limit in zip(ends, reached, strict=True)
        )
        return low, high

    def lookup(self, *inputs: ArrayLike, mode: str | None = None, **named: ArrayLike) -> Any:
        """Return the value at the inputs.

        Parameters
        ----------
        *inputs : float or array_like
            In the order of the axes; arrays are broadcast against each other.
        mode : str, optional
            ``bins``, ``nearest`` or ``linear``; :attr:`default_mode` by default. With ``bins``, an
            axis without bins uses the nearest level.
        **named : float or array_like
            Inputs by name, instead of by order.

        Returns
        -------
        float or ndarray of float64
            A float if every input is a number, else an array of the broadcast shape; a Series, a
            DataFrame or a DataArray where inputs are, with their labels.
            Inputs outside the levels have the value at the border.

        Raises
        ------
        TableError
            If an input is missing, unknown or NaN.
        """
        if named or len(inputs) != len(self.axes):
            inputs = self._in_order(inputs, named)
        lookup_mode = self.default_mode if mode is None else mode_named(mode)
        for x in inputs:
            if not isinstance(x, (float, int)):
                break
        else:
            return self._at_point(inputs, lookup_mode)  # type: ignore[arg-type]
        from fuzzyarm.inference.labelled import gathered

        values_by_name, labels = gathered(None, dict(zip(self.names, inputs, strict=True)), ())
        if labels is not None:
            values = self.lookup(*values_by_name.values(), mode=lookup_mode)
            return labels.on({self.output: values})[self.output]
        arrays = [np.asarray(x, dtype=np.float64) for x in inputs]
        if all(array.ndim == 0 for array in arrays):
            return self._at_point(tuple(array.item() for array in arrays), lookup_mode)
        return look_up_arrays(self.axes, self.values, arrays, lookup_mode)

    def cell(self, *inputs: float, mode: str | None = None) -> tuple[int, ...]:
        """Return the index of the cell that `inputs` fall into, by bins or nearest level."""
        lookup_mode = self.default_mode if mode is None else mode_named(mode)
        return tuple(axis.cell(x, lookup_mode) for axis, x in zip(self.axes, inputs, strict=True))

    def with_values(
        self, values: ArrayLike, provenance: Mapping[str, str] | None = None
    ) -> LookupTable:
        """Return a table on the same axes with other values and maybe another origin."""
        pairs = self.provenance if provenance is None else tuple(provenance.items())
        return replace(self, values=np.asarray(values, dtype=np.float64), provenance=pairs)

    def plain(self) -> PlainTable:
        """Return the same table without arrays, for the writers of text."""
        return PlainTable(**self.head(), values=tuple(self.values.ravel().tolist()))

    @classmethod
    def from_plain(cls, plain: PlainTable) -> LookupTable:
        """Return the table of `plain`."""
        values = np.array(plain.values, dtype=np.float64).reshape(plain.shape)
        return cls(**plain.head(), values=values)

    @cached_property
    def _grids(self) -> dict[str, PreparedTable]:
        """Return the table prepared for points, for each mode."""
        flat = self.values.ravel().data  # a memory view yields floats, fast
        points: dict[str, list[tuple[float, ...]]] = {
            mode: [axis.thresholds(mode) for axis in self.axes] for mode in ("bins", "nearest")
        }
        points["linear"] = [axis.levels for axis in self.axes]
        return {
            mode: PreparedTable.of(self.shape, point, flat, AT_POINT)
            for mode, point in points.items()
        }

    def _at_point(self, inputs: tuple[float, ...], mode: str) -> float:
        for axis, x in zip(self.axes, inputs, strict=True):
            if x != x:  # noqa: PLR0124 - the quickest test for NaN
                raise TableError(f"input '{axis.name}' of the table is not a number (NaN)")
        grid = self._grids[mode]
        value: float = grid.interpolate(inputs) if mode == "linear" else grid.pick(inputs)
        return value

    def _in_order(
        self, inputs: tuple[ArrayLike, ...], named: Mapping[str, ArrayLike]
    ) -> tuple[ArrayLike, ...]:
        names = self.names
        if len(inputs) > len(names):
            raise TableError(
                f"the table has {len(names)} inputs ({', '.join(names)}), not {len(inputs)}"
            )
        values_by_name: dict[str, ArrayLike] = dict(zip(names, inputs, strict=False))
        for name, value in named.items():
            if name not in names:
                hint = near_hint(name, names)[0] or f"it has {', '.join(names)}"
                raise TableError(f"the table has no input '{name}'", hint=hint)
            if name in values_by_name:
                raise TableError(f"input '{name}' is given twice")
            values_by_name[name] = value
        missing = [name for name in names if name not in values_by_name]
        if missing:
            raise TableError(f"no value for input '{missing[0]}' of the table")
        return tuple(values_by_name[name] for name in names)
