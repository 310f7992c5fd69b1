"""Looking up many points at once, with NumPy or as machine code.

Small arrays go through NumPy and bisection, which is the reference; large ones through the
machine code, which gives the same bits.
"""

from __future__ import annotations

import importlib.util
import math
import sys
from collections.abc import Callable, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.kernels import build, jit_wanted, kernel
from fuzzyarm.table.axis import TableError

if TYPE_CHECKING:
    from fuzzyarm.table.table import LookupTable


# --- Machine code for many points ---
#
# A number finds its place among the points of an axis without a search: the range is cut into
# even buckets, each of which knows how many points lie in buckets below, and a comparison with
# the points in the same bucket (as a rule one) settles the rest. Rounding does no harm: the
# bucket of x never falls while x rises, whatever is rounded, so a point in a lower bucket is a
# lower point. So even and uneven axes take the same time, nothing depends on the branch
# predictor, and the result is the one that bisection finds.
#
# The kernels are general: one call for each axis, any number of axes.

_Array = NDArray[np.float64]
_Cells = NDArray[np.int32]

ONCE_LOADED = 4_096
"""Points from which machine code is worth calling where numba is loaded already."""

WORTH_LOADING = 500_000
"""Points from which it is worth loading numba and the code."""

_MOST_BUCKETS = 4_096
_MOST_STEPS = 6


class Finder(NamedTuple):
    """How numbers find their place among the points of one axis.

    Attributes
    ----------
    points : ndarray
        Increasing, with infinities behind the last one.
    start : ndarray of int32
        For each bucket, how many points lie in lower buckets.
    edge : ndarray
        For each bucket, the first point that does not lie in a lower bucket.
    low, inverse : float
        The bucket of x is (x - low) × inverse, rounded down.
    steps : int
        Points that share a bucket at most.
    """

    points: _Array
    start: _Cells
    edge: _Array
    low: float
    inverse: float
    steps: int


def make_finder(points: Sequence[float]) -> Finder | None:
    """Prepare the points of an axis; None where they lie too unevenly for buckets."""
    edges = np.array(points, dtype=np.float64)
    if edges.size < 2:
        return _finder(edges, np.zeros(1, np.int64), 0.0, 0.0, 1)
    low, span = float(edges[0]), float(edges[-1] - edges[0])
    count = 2 * edges.size
    best: Finder | None = None
    while count <= _MOST_BUCKETS * edges.size and 0.0 < span < math.inf:
        inverse = count / span
        if not math.isfinite(inverse):
            break
        bucket = np.minimum(((edges - low) * inverse).astype(np.int64), count - 1)
        start = np.searchsorted(bucket, np.arange(count), side="left")
        steps = int(np.bincount(bucket).max())
        if best is None or steps < best.steps:
            best = _finder(edges, start, low, inverse, steps)
        if steps == 1 or count > _MOST_BUCKETS:
            break
        count *= 2
    return best if best is not None and best.steps <= _MOST_STEPS else None


def _finder(
    edges: _Array, start: NDArray[np.int64], low: float, inverse: float, steps: int
) -> Finder:
    points = np.concatenate([edges, np.full(steps, np.inf)])
    return Finder(points, start.astype(np.int32), points[start], low, inverse, steps)


@kernel
def bucket_of(value: float, low: float, inverse: float, last: float) -> Any:
    """Return the bucket of a number; that of NaN is 0."""
    place = (value - low) * inverse
    place = place if place > 0.0 else 0.0  # noqa: FURB136 - 0 for NaN
    return np.int32(place if place < last else last)  # noqa: FURB136 - as above


@kernel
def add_cells(
    x: Any,
    points: Any,
    start: Any,
    edge: Any,
    low: float,
    inverse: float,
    steps: int,
    size: Any,
    index: Any,
) -> bool:
    """Make `index` one axis longer: the number of points smaller than x; false for a NaN."""
    last = start.size - 1.0
    bad = 0
    if steps == 1:  # by itself, for the vector unit
        for k in range(x.size):
            value = x[k]
            bad += value != value  # noqa: PLR0124 - true for NaN only
            bucket = bucket_of(value, low, inverse, last)
            index[k] = index[k] * size + start[bucket] + np.int32(edge[bucket] < value)
        return bad == 0
    for k in range(x.size):
        value = x[k]
        bad += value != value  # noqa: PLR0124 - true for NaN only
        cell = start[bucket_of(value, low, inverse, last)]
        for _ in range(steps):
            cell += points[cell] < value
        index[k] = index[k] * size + cell
    return bad == 0


@kernel
def add_places(
    x: Any,
    points: Any,
    start: Any,
    edge: Any,
    low: float,
    inverse: float,
    steps: int,
    levels: Any,
    stride: Any,
    index: Any,
    share: Any,
) -> bool:
    """Add the level below x to `index`, and set the share of the way to the next one.

    `points` are the inner levels.
    """
    last = start.size - 1.0
    first, final = levels[0], levels[levels.size - 1]
    bad = 0
    for k in range(x.size):
        value = x[k]
        bad += value != value  # noqa: PLR0124 - true for NaN only
        value = value if value > first else first  # noqa: FURB136 - the lower end for NaN
        value = value if value < final else final  # noqa: FURB136 - as above
        bucket = bucket_of(value, low, inverse, last)
        cell = start[bucket] + np.int32(edge[bucket] <= value)
        for _ in range(steps - 1):
            cell += points[cell] <= value
        index[k] += cell * stride
        share[k] = (value - levels[cell]) / (levels[cell + 1] - levels[cell])
    return bad == 0


@kernel
def gather(values: Any, index: Any, out: Any) -> None:
    """Fetch the values of cells."""
    for k in range(out.size):
        out[k] = values[index[k]]


@kernel
def blend(values: Any, index: Any, shares: Any, offsets: Any, work: Any, out: Any) -> None:
    """Interpolate between the corners of cells, the last axis first.

    `shares` has a row for each axis, `offsets` the places of the corners; `work` has room
    for them.
    """
    axes = shares.shape[0]
    if axes == 2:
        one, two, three = offsets[1], offsets[2], offsets[3]
        for k in range(out.size):
            cell, s, t = index[k], shares[0, k], shares[1, k]
            near = (1.0 - t) * values[cell] + t * values[cell + one]
            far = (1.0 - t) * values[cell + two] + t * values[cell + three]
            out[k] = (1.0 - s) * near + s * far
        return
    for k in range(out.size):
        cell, left = index[k], offsets.size
        for corner in range(left):
            work[corner] = values[cell + offsets[corner]]
        for axis in range(axes - 1, -1, -1):
            t = shares[axis, k]
            left //= 2
            for corner in range(left):
                work[corner] = (1.0 - t) * work[2 * corner] + t * work[2 * corner + 1]
        out[k] = work[0]


@cache
def _machine(function: Callable[..., Any]) -> Callable[..., Any]:
    return build(function, compiled=True)


def worthwhile(points: int) -> bool:
    """Whether so many points are to go through machine code, here and now."""
    if points < (ONCE_LOADED if "numba" in sys.modules else WORTH_LOADING):
        return False
    return jit_wanted() and importlib.util.find_spec("numba") is not None


Evaluate = Callable[[Sequence[_Array], _Array], bool]
"""Fills the last argument with values at columns of inputs; false where one is NaN."""


def picker(
    values: _Array, thresholds: Sequence[Sequence[float]], *, compiled: bool = True
) -> Evaluate | None:
    """Return how to look up cells; None where the thresholds are too uneven for this.

    Parameters
    ----------
    values : ndarray
        The table.
    thresholds : sequence of sequences of float
        For each axis.
    compiled : bool
        Machine code, or the same kernels in plain Python.
    """
    finders = [make_finder(edges) for edges in thresholds]
    if any(finder is None for finder in finders):
        return None
    cells, fetch = (_machine(add_cells), _machine(gather)) if compiled else (add_cells, gather)
    flat = values.ravel()

    def evaluate(columns: Sequence[_Array], out: _Array) -> bool:
        index = np.zeros(out.shape, dtype=np.int32)
        numbers = True
        for finder, size, x in zip(finders, values.shape, columns, strict=True):
            assert finder is not None
            numbers &= bool(cells(x, *finder, np.int32(size), index))
        if numbers:
            fetch(flat, index, out)
        return numbers

    return evaluate


def interpolator(
    values: _Array, levels: Sequence[Sequence[float]], *, compiled: bool = True
) -> Evaluate | None:
    """Return how to interpolate; None where the levels are too uneven for this.

    Parameters
    ----------
    values : ndarray
        The table.
    levels : sequence of sequences of float
        For each axis.
    compiled : bool
        Machine code, or the same kernels in plain Python.
    """
    finders = [make_finder(points[1:-1]) for points in levels]
    if any(finder is None for finder in finders):
        return None
    places, mix = (_machine(add_places), _machine(blend)) if compiled else (add_places, blend)
    flat = values.ravel()
    strides = [math.prod(values.shape[k + 1 :]) for k in range(values.ndim)]
    wide = [k for k, size in enumerate(values.shape) if size > 1]
    offsets = np.zeros(1, dtype=np.int64)
    for k in wide:
        offsets = (offsets[:, None] + np.array([0, strides[k]])).ravel()
    arrays = [np.array(points) for points in levels]

    def evaluate(columns: Sequence[_Array], out: _Array) -> bool:
        index = np.zeros(out.shape, dtype=np.int32)
        shares = np.empty((len(wide), out.size))
        for k, x in enumerate(columns):
            if k not in wide and np.isnan(x).any():
                return False
        for row, k in enumerate(wide):
            finder = finders[k]
            assert finder is not None
            if not places(columns[k], *finder, arrays[k], np.int32(strides[k]), index, shares[row]):
                return False
        mix(flat, index, shares, offsets, np.empty(offsets.size), out)
        return True

    return evaluate


# --- Looking up, in chunks that stay in the cache ---

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
