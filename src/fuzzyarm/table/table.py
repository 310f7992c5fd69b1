"""The lookup table: a grid of numbers that stands for a rule base at run time."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyarm.table.axis import Axis, PlainTable, TableError, TableHeader, mode_named
from fuzzyarm.table.lookup import look_up_arrays
from fuzzyarm.text.names import near_hint


@dataclass(frozen=True, eq=False)
class LookupTable(TableHeader):
    """A grid of values over one or more inputs, with its meaning and its origin.

    Two tables are equal when axes, values and everything they say of themselves are.

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

    values: NDArray[np.float64] = field(repr=False)

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

    def __hash__(self) -> int:
        return hash((self.head(), self.values.tobytes()))

    def lookup(self, *inputs: ArrayLike, mode: str | None = None, **named: ArrayLike) -> Any:
        """Return the value at the inputs.

        Parameters
        ----------
        *inputs : float or array_like
            In the order of the axes; arrays are broadcast against each other.
        mode : str, optional
            ``bins``, ``nearest`` or ``linear``; :attr:`default_mode` by default. With
            ``bins``, an axis without bins takes the nearest level.
        **named : float or array_like
            Inputs by name, instead of by order.

        Returns
        -------
        float or ndarray of float64
            A float if every input is a number, else an array of the broadcast shape.
            Inputs outside the levels take the value at the border.

        Raises
        ------
        TableError
            If an input is missing, unknown or NaN.
        """
        if named or len(inputs) != len(self.axes):
            inputs = self._in_order(inputs, named)
        chosen = self.default_mode if mode is None else mode_named(mode)
        for x in inputs:
            if not isinstance(x, (float, int)):
                break
        else:
            return self._look_up_scalar(inputs, chosen)  # type: ignore[arg-type]
        arrays = [np.asarray(x, dtype=np.float64) for x in inputs]
        if all(array.ndim == 0 for array in arrays):
            return self._look_up_scalar(tuple(array.item() for array in arrays), chosen)
        return look_up_arrays(self, arrays, chosen)

    def cell(self, *inputs: float, mode: str | None = None) -> tuple[int, ...]:
        """Return the index of the cell that `inputs` fall into, by bins or nearest level."""
        chosen = self.default_mode if mode is None else mode_named(mode)
        return tuple(axis.cell(x, chosen) for axis, x in zip(self.axes, inputs, strict=True))

    def with_values(
        self, values: ArrayLike, provenance: Mapping[str, str] | None = None
    ) -> LookupTable:
        """Return a table on the same axes with other values and, if given, another origin."""
        pairs = self.provenance if provenance is None else tuple(provenance.items())
        return replace(self, values=np.asarray(values, dtype=np.float64), provenance=pairs)

    def plain(self) -> PlainTable:
        """Return the same table without arrays, for the writers of text."""
        head = {name: getattr(self, name) for name in TableHeader.__dataclass_fields__}
        return PlainTable(**head, values=tuple(self.values.ravel().tolist()))

    @classmethod
    def from_plain(cls, plain: PlainTable) -> LookupTable:
        """Return the table of `plain`."""
        head = {name: getattr(plain, name) for name in TableHeader.__dataclass_fields__}
        values = np.array(plain.values, dtype=np.float64).reshape(plain.shape)
        return cls(**head, values=values)

    @cached_property
    def _strides(self) -> tuple[int, ...]:
        strides = [1]
        for size in self.shape[:0:-1]:
            strides.append(strides[-1] * size)
        return tuple(reversed(strides))

    @cached_property
    def _thresholds(self) -> dict[str, tuple[tuple[tuple[float, ...], int], ...]]:
        return {
            mode: tuple(
                (axis.thresholds(mode), stride)
                for axis, stride in zip(self.axes, self._strides, strict=True)
            )
            for mode in ("bins", "nearest")
        }

    def _look_up_scalar(self, inputs: tuple[float, ...], mode: str) -> float:
        if mode == "linear":
            return self._interpolate_scalar(inputs)
        index = 0
        for x, (thresholds, stride) in zip(inputs, self._thresholds[mode], strict=True):
            if x != x:  # noqa: PLR0124 - the quickest test for NaN
                raise TableError("an input of the table is not a number (NaN)")
            index += bisect_left(thresholds, x) * stride
        return self.values.item(index)

    def _interpolate_scalar(self, inputs: tuple[float, ...]) -> float:
        index, ways = 0, []
        for x, axis, stride in zip(inputs, self.axes, self._strides, strict=True):
            i, share = _place(axis, x)
            index += i * stride
            if len(axis.levels) > 1:
                ways.append((share, stride))
        return self._blend(index, ways)

    def _blend(self, index: int, ways: list[tuple[float, int]]) -> float:
        if not ways:
            return self.values.item(index)
        (share, stride), rest = ways[0], ways[1:]
        near, far = self._blend(index, rest), self._blend(index + stride, rest)
        return (1.0 - share) * near + share * far

    def _in_order(
        self, inputs: tuple[ArrayLike, ...], named: Mapping[str, ArrayLike]
    ) -> tuple[ArrayLike, ...]:
        names = self.names
        if len(inputs) > len(names):
            raise TableError(
                f"the table has {len(names)} inputs ({', '.join(names)}), not {len(inputs)}"
            )
        given: dict[str, ArrayLike] = dict(zip(names, inputs, strict=False))
        for name, value in named.items():
            if name not in names:
                hint = near_hint(name, names)[0] or f"it has {', '.join(names)}"
                raise TableError(f"the table has no input '{name}'", hint=hint)
            if name in given:
                raise TableError(f"input '{name}' is given twice")
            given[name] = value
        missing = [name for name in names if name not in given]
        if missing:
            raise TableError(f"no value for input '{missing[0]}' of the table")
        return tuple(given[name] for name in names)


def _place(axis: Axis, x: float) -> tuple[int, float]:
    """Return the level below `x` and the share of the way to the next one."""
    if x != x:  # noqa: PLR0124 - the quickest test for NaN
        raise TableError(f"input '{axis.name}' of the table is not a number (NaN)")
    levels = axis.levels
    inside = min(max(x, levels[0]), levels[-1])
    i = max(0, min(bisect_right(levels, inside) - 1, len(levels) - 2))
    return i, (inside - levels[i]) / (levels[i + 1] - levels[i]) if len(levels) > 1 else 0.0
