"""Looking up many points at once, in chunks that stay in the cache.

Small arrays go through NumPy and bisection, which is the reference; large ones through the
machine code of :mod:`fuzzyarm.lut.compiled`, which gives the same bits.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.lut.axis import TableError
from fuzzyarm.lut.compiled import Evaluate, interpolator, picker, worthwhile

if TYPE_CHECKING:
    from fuzzyarm.lut.table import LookupTable

_Array = NDArray[np.float64]

_CHUNK = 16_384
"""Points at a time: their arrays fit the second-level cache."""


def look_up_arrays(
    table: LookupTable, inputs: Sequence[NDArray[np.float64]], mode: str
) -> NDArray[np.float64]:
    """Return the values of `table` at arrays of inputs.

    Parameters
    ----------
    table : LookupTable
        What to look up in.
    inputs : sequence of ndarray
        One for each axis, broadcast against each other.
    mode : str
        ``bins``, ``nearest`` or ``linear``.

    Returns
    -------
    ndarray of float64
        Of the broadcast shape. No temporary is larger than a chunk.

    Raises
    ------
    TableError
        If an input is NaN or the shapes do not fit each other.
    """
    try:
        shape = np.broadcast_shapes(*(array.shape for array in inputs))
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in inputs)
        raise TableError(f"inputs of shapes {shapes} do not fit each other") from None
    values = np.empty(shape)
    evaluate = _machine_code(table, mode) if worthwhile(values.size) else None
    if evaluate is None:
        evaluate = _plain(table, mode)
    chunks = np.nditer(  # type: ignore[call-overload]
        [*inputs, values],
        flags=["external_loop", "buffered", "zerosize_ok"],
        op_flags=[*([["readonly"]] * len(inputs)), ["writeonly"]],
        buffersize=_CHUNK,
        order="C",
    )
    with chunks:
        for chunk in chunks:
            *columns, out = chunk
            if not evaluate(columns, out):
                bad = (
                    a.name for a, x in zip(table.axes, columns, strict=True) if np.isnan(x).any()
                )
                raise TableError(f"input '{next(bad)}' of the table is not a number (NaN)")
    return values


def _machine_code(table: LookupTable, mode: str) -> Evaluate | None:
    """Return the twin in machine code; None where an axis is too uneven for it."""
    if mode == "linear":
        return interpolator(table.values, [axis.levels for axis in table.axes])
    return picker(table.values, [axis.thresholds(mode) for axis in table.axes])


def _plain(table: LookupTable, mode: str) -> Evaluate:
    """Return the reference: NumPy and bisection."""
    points = [np.array(a.levels if mode == "linear" else a.thresholds(mode)) for a in table.axes]
    values = _interpolate if mode == "linear" else _pick

    def evaluate(columns: Sequence[_Array], out: _Array) -> bool:
        if any(np.isnan(x).any() for x in columns):
            return False
        out[...] = values(table.values, points, columns)
        return True

    return evaluate


def _pick(
    values: NDArray[np.float64],
    thresholds: Sequence[NDArray[np.float64]],
    columns: Sequence[NDArray[np.float64]],
) -> NDArray[np.float64]:
    index = np.zeros(columns[0].shape, dtype=np.intp)
    for size, edges, x in zip(values.shape, thresholds, columns, strict=True):
        # side="left" counts the thresholds smaller than x: an equal one belongs to the lower cell.
        index *= size
        index += np.searchsorted(edges, x, side="left")
    return values.ravel()[index]


def _interpolate(
    values: NDArray[np.float64],
    levels: Sequence[NDArray[np.float64]],
    columns: Sequence[NDArray[np.float64]],
) -> NDArray[np.float64]:
    flat = values.ravel()
    lower = np.zeros(columns[0].shape, dtype=np.intp)
    shares: list[NDArray[np.float64]] = []
    steps: list[int] = []
    stride = values.size
    for size, points, x in zip(values.shape, levels, columns, strict=True):
        stride //= size
        if size == 1:
            continue
        inside = np.clip(x, points[0], points[-1])
        i = np.clip(np.searchsorted(points, inside, side="right") - 1, 0, size - 2)
        shares.append((inside - points[i]) / (points[i + 1] - points[i]))
        steps.append(stride)
        lower += i * stride
    return _blend(flat, lower, shares, steps)


def _blend(
    flat: NDArray[np.float64],
    index: NDArray[np.intp],
    shares: list[NDArray[np.float64]],
    steps: list[int],
) -> NDArray[np.float64]:
    if not shares:
        return flat[index]
    near = _blend(flat, index, shares[1:], steps[1:])
    far = _blend(flat, index + steps[0], shares[1:], steps[1:])
    # Two products rather than near + t (far - near): exact at both ends.
    return (1.0 - shares[0]) * near + shares[0] * far
