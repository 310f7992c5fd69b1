"""Looking up many points as machine code: the twin of :mod:`fuzzyarm.lut.arrays`.

A number finds its place among the points of an axis without a search: the range is cut into
even buckets, each of which knows how many points lie in buckets below, and a comparison with
the points in the same bucket (as a rule one) settles the rest. Rounding does no harm: the
bucket of x never falls while x rises, whatever is rounded, so a point in a lower bucket is a
lower point. So even and uneven axes take the same time, nothing depends on the branch
predictor, and the result is the one that bisection finds.

The kernels are general: one call for each axis, any number of axes.
"""

from __future__ import annotations

import importlib.util
import math
import sys
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.kernels import build, jit_wanted, kernel

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
