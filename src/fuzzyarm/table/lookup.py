"""Look-up of a value in a table: definition and implementations.

The meaning is written once, for one input and for the walk over several (:class:`PreparedTable`).
Readings are a point, arrays, the numbers of a small machine (:mod:`fuzzyarm.exchange.export`), the
kernels of a closed loop and those for large arrays.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.symbolic.kernels import has_machine_code, in_threads, kernel, processors, routine
from fuzzyarm.table.axis import Axis, TableError

# --- The definition ---
#
# By bins and by the nearest level, the index of x along an input is the number of thresholds
# smaller than x (`Axis.thresholds`): an x equal to a threshold belongs to the lower cell, and
# a tie between two levels goes to the lower one.
#
# Linear: x is first clamped to the outer levels. Its lower neighbour is the last inner level that x
# has reached, else level 0, so the last level is the upper neighbour of the last cell; the fraction
# towards the upper neighbour is 0 to 1, both included. The corners of the cell are blended pairwise
# along one input after the other, the last one first.
#
# The exported C and Structured Text print the three functions below, too.


@kernel
def clamp(x: Any, low: Any, high: Any) -> Any:
    """Return x within low … high; low for NaN."""
    x = x if x > low else low  # noqa: FURB136 - low for NaN, and for -0.0 where low is 0.0
    return x if x < high else high  # noqa: FURB136 - as above


@kernel
def share_of_way(x: Any, lower: Any, upper: Any) -> Any:
    """Return the fraction of the interval from lower to upper neighbour that lies after x."""
    return (x - lower) / (upper - lower)


@kernel
def blend(near: Any, far: Any, share: Any) -> Any:
    """Return the value at a share of the way from near to far."""
    # Two products instead of near + share (far - near): exact at both ends.
    return (1.0 - share) * near + share * far


class LookupArithmetic(NamedTuple):
    """The operations of the definition for one kind of numbers."""

    # From sorted points and x to the number of points smaller than x, and to the number of those
    # not greater.
    smaller: Callable[[Any, Any], Any]
    reached: Callable[[Any, Any], Any]
    # As :func:`clamp`, :func:`share_of_way` and :func:`blend`.
    clamp: Callable[[Any, Any, Any], Any]
    share: Callable[[Any, Any, Any], Any]
    blend: Callable[[Any, Any, Any], Any]


def _clamp_arrays(x: Any, low: Any, high: Any) -> Any:
    return np.where(x > low, np.where(x < high, x, high), low)


AT_POINT = LookupArithmetic(bisect_left, bisect_right, clamp, share_of_way, blend)
"""Floats; the points are sequences."""

OVER_ARRAYS = LookupArithmetic(
    partial(np.searchsorted, side="left"),
    partial(np.searchsorted, side="right"),
    _clamp_arrays,
    share_of_way,
    blend,
)
"""Arrays of any floating-point type; none of them NaN."""


@dataclass(frozen=True, slots=True)
class PreparedTable:
    """A table prepared for one way to look up, in the numbers of one arithmetic."""

    strides: tuple[int, ...]  # cells from one index of an input to the next one
    # For each input the thresholds, or all levels for interpolation.
    points: tuple[Any, ...]
    inner: tuple[Any, ...]  # the levels except for the outer ones
    offsets: tuple[int, ...]  # for interpolation, see :func:`corner_offsets`
    values: Any  # flat, the last input fastest
    arithmetic: LookupArithmetic  # of points and values

    @classmethod
    def of(
        cls, shape: Sequence[int], points: Sequence[Any], values: Any, arithmetic: LookupArithmetic
    ) -> PreparedTable:
        """Prepare a table with so many levels in each input."""
        inner = tuple(point[1:-1] for point in points)
        strides = strides_of(shape)
        offsets = corner_offsets(shape)
        return cls(strides, tuple(points), inner, offsets, values, arithmetic)

    def pick(self, inputs: Sequence[Any]) -> Any:
        """Return the value of the cell of the inputs."""
        index = 0
        smaller = self.arithmetic.smaller
        for x, thresholds, stride in zip(inputs, self.points, self.strides, strict=True):
            index = index + smaller(thresholds, x) * stride
        return self.values[index]

    def interpolate(self, inputs: Sequence[Any]) -> Any:
        """Return the value between the corners around the inputs."""
        _, reached, clamp, share, blend = self.arithmetic
        index, shares = 0, []
        for k, (x, levels) in enumerate(zip(inputs, self.points, strict=True)):
            if len(levels) == 1:
                continue
            inside = clamp(x, levels[0], levels[-1])
            lower = reached(self.inner[k], inside)
            shares.append(share(inside, levels[lower], levels[lower + 1]))
            index = index + lower * self.strides[k]
        # Pairs of neighbouring corners are blended as soon as both are there: of 2^n values no
        # more than n + 1 exist at a time.
        waiting: list[Any] = []
        for corner, offset in enumerate(self.offsets):
            value = self.values[index + offset]
            axis, bits = len(shares), corner
            while bits & 1:
                axis -= 1
                bits >>= 1
                value = blend(waiting.pop(), value, shares[axis])
            waiting.append(value)
        return waiting.pop()


def strides_of(shape: Sequence[int]) -> tuple[int, ...]:
    """Return the stride of each input in cells."""
    return tuple(math.prod(shape[k + 1 :]) for k in range(len(shape)))


def corner_offsets(shape: Sequence[int]) -> tuple[int, ...]:
    """Return the offsets of a cell's corners from its lowest one, the last input fastest.

    An input with one level has no neighbour: it does not add corners.
    """
    steps = [(0, stride) for size, stride in zip(shape, strides_of(shape), strict=True) if size > 1]
    return tuple(map(sum, itertools.product(*steps)))


# --- Tables in the kernels of a closed loop, of any number of inputs ---
#
# A grid among the cells of a controller: the number of inputs, whether it interpolates, and for
# each input the number of levels, the thresholds between them (one less) with an infinity at either
# end, and the levels. A look-up reads a list of integers: the begin of the values, scratch (for
# blending, or for the last cell index along each input), and the cell of each input.

GRID_HEAD = 2
"""Numbers before the first input."""

VALUES, SCRATCH, INPUTS = range(3)

THRESHOLDS = 1
"""Offset of the thresholds of an input in a grid: the i-th one is the lower bound of index i."""


def pack_grid(axes: Sequence[Axis], mode: str) -> list[float]:
    """Write a grid down as :func:`cell_index` reads it."""
    numbers = [float(len(axes)), float(mode == "linear")]
    for axis in axes:
        thresholds = (-math.inf, *axis.thresholds(mode), math.inf)
        numbers += [len(axis.levels), *thresholds, *axis.levels]
    return numbers


@kernel
def levels_at(axis: int, count: int) -> int:
    """Return the begin of the levels of an input in a grid."""
    return axis + THRESHOLDS + count + 1


@kernel
def next_axis(axis: int, count: int) -> int:
    """Return the index of the next input of a grid."""
    return levels_at(axis, count) + count


@kernel
def cell_index(k: Any, s: Any, inputs: int, grid: int, last: int) -> int:
    """Return the index of the cell of the inputs, the last input fastest.

    At `last` are their indices in the last control period: initially arbitrary.
    """
    cell = 0
    axis = grid + GRID_HEAD
    for i in range(inputs, inputs + int(s[grid])):
        count = int(s[axis])
        x = s[k[i]]
        # From one control period to the next an input usually moves by one cell at most. Near a
        # threshold branch prediction would fail, so that move is counted without a branch. The only
        # branch tests whether one cell was enough, which it nearly always is.
        below = axis + THRESHOLDS  # lower bound of the first cell
        index = int(s[last])
        index = index + (x > s[below + index + 1]) - (x <= s[below + index])
        if not s[below + index] < x <= s[below + index + 1]:  # NaN is in none: the first one
            index = _count_smaller(s, below + 1, count - 1, x)
        s[last] = float(index)
        cell = cell * count + index
        axis = next_axis(axis, count)
        last += 1
    return cell


@kernel
def looked_up(k: Any, s: Any, at: int, grid: int) -> float:
    """Return the value of a table, by cell or between the neighbouring levels."""
    values = k[at + VALUES]
    if s[grid + 1] == 0.0:
        value: float = s[values + cell_index(k, s, at + INPUTS, grid, k[at + SCRATCH])]
    else:
        value = interpolated(k, s, at, grid)
    return value


@kernel
def interpolated(k: Any, s: Any, at: int, grid: int) -> float:
    """Blend the corners of the cell around the inputs pairwise, the last input first.

    Room: the share of the way along each input, then the corners.
    """
    inputs = int(s[grid])
    scratch = k[at + SCRATCH]
    corners = scratch + inputs
    # The corners' numbers are built up input by input: each doubles the list.
    s[corners] = 0.0
    found = 1
    axis = grid + GRID_HEAD
    for i in range(inputs):
        count = int(s[axis])
        lower, share = neighbour(s, levels_at(axis, count), count, s[k[at + INPUTS + i]])
        s[scratch + i] = share
        upper = lower + (1 if count > 1 else 0)
        # In place, from the last corner: 2j and 2j + 1 are never below an unread j. Afterwards the
        # lowest bit of a corner's position is its side along this input.
        for j in range(found - 1, -1, -1):
            cell = s[corners + j] * count
            s[corners + 2 * j] = cell + lower
            s[corners + 2 * j + 1] = cell + upper
        found *= 2
        axis = next_axis(axis, count)
    for j in range(found):
        s[corners + j] = s[k[at + VALUES] + int(s[corners + j])]
    # Along the last input corners 2j and 2j + 1 are neighbours: blending halves the list.
    for i in range(inputs - 1, -1, -1):
        found //= 2
        for j in range(found):
            s[corners + j] = blend(s[corners + 2 * j], s[corners + 2 * j + 1], s[scratch + i])
    value: float = s[corners]
    return value


@kernel
def neighbour(numbers: list[float], levels: int, count: int, x: float) -> tuple[int, float]:
    """Return the lower neighbour of x among some levels, and the share of the way to the upper."""
    if count == 1:
        return 0, 0.0
    inside = clamp(x, numbers[levels], numbers[levels + count - 1])
    inner, levels_inside = levels + 1, count - 2
    lower = _count_smaller(numbers, inner, levels_inside, inside)
    if lower < levels_inside and numbers[inner + lower] == inside:
        lower += 1  # on a level: it is the lower neighbour
    return lower, share_of_way(inside, numbers[levels + lower], numbers[levels + lower + 1])


@kernel
def _count_smaller(numbers: list[float], first: int, count: int, x: float) -> int:
    """Count the sorted numbers smaller than x by bisection; none for NaN."""
    low = 0
    high = count
    while low < high:
        middle = (low + high) >> 1
        if numbers[first + middle] < x:
            low = middle + 1
        else:
            high = middle
    return low


# --- Large arrays as machine code ---
#
# A number finds its index among the points of an axis without a search: the range is cut into even
# buckets, each with the number of points in lower buckets, and a comparison with the points in the
# same bucket (usually one) settles the rest. Rounding does no harm: the bucket of x is monotone in
# x, whatever is rounded, so a point in a lower bucket is a lower point. Even and uneven axes take
# the same time, nothing depends on branch prediction, and the result is that of bisection.
#
# One call for each axis and chunk: a short loop over plain arrays vectorises. The same over one
# flat array takes twice the time.

_Array = NDArray[np.float64]
_Cells = NDArray[np.int32]

WORTH_CALLING = 4_096
"""Points from which machine code is worth calling."""

WORTH_THREADS = 100_000
"""Points from which machine code runs on all processors."""

_MOST_BUCKETS = 4_096
_MOST_STEPS = 6


class BucketIndex(NamedTuple):
    """How numbers find their index among the points of one axis."""

    points: _Array  # increasing, with infinities after the last one
    start: _Cells  # number of points in lower buckets, by bucket
    edge: _Array  # for each bucket, the first point not in a lower bucket
    # The bucket of x is (x - low) × inverse, rounded down.
    low: float
    inverse: float
    steps: int  # points that share a bucket at most


def make_finder(points: Sequence[float]) -> BucketIndex | None:
    """Prepare the points of an axis; None if they are too uneven for buckets."""
    edges = np.array(points, dtype=np.float64)
    if edges.size < 2:
        return _finder(edges, np.zeros(1, np.int64), 0.0, 0.0, 1)
    low, span = float(edges[0]), float(edges[-1] - edges[0])
    count = 2 * edges.size
    best: BucketIndex | None = None
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
) -> BucketIndex:
    points = np.concatenate([edges, np.full(steps, np.inf)])
    return BucketIndex(points, start.astype(np.int32), points[start], low, inverse, steps)


@kernel
def _bucket_of(value: float, low: float, inverse: float, last: float) -> Any:
    """Return the bucket of a number; that of NaN is 0."""
    bucket = (value - low) * inverse
    bucket = bucket if bucket > 0.0 else 0.0  # noqa: FURB136 - 0 for NaN
    return np.int32(bucket if bucket < last else last)  # noqa: FURB136 - as above


# A finder enters a kernel as its three arrays, with its numbers among those of the axis. Indices
# are 32-bit.

LOW, INVERSE, STEPS, SIZE = range(4)
"""Numbers of an axis: of its finder, then its stride."""


@kernel
def add_cells(
    x: Any, points: Any, start: Any, edge: Any, axis: Any, index: Any, missing: Any
) -> None:
    """Make `index` one axis longer: the number of points smaller than x; count the NaN."""
    low, inverse, steps, size = axis[LOW], axis[INVERSE], int(axis[STEPS]), np.int32(axis[SIZE])
    last = start.size - 1.0
    bad = 0
    if steps == 1:  # separate, to vectorise
        for k in range(x.size):
            value = x[k]
            bad += value != value  # noqa: PLR0124 - true for NaN only
            bucket = _bucket_of(value, low, inverse, last)
            index[k] = index[k] * size + start[bucket] + np.int32(edge[bucket] < value)
    else:
        for k in range(x.size):
            value = x[k]
            bad += value != value  # noqa: PLR0124 - true for NaN only
            # Lower buckets count as a whole; the points of the own bucket are compared one by one.
            cell = start[_bucket_of(value, low, inverse, last)]
            for _ in range(steps):
                cell += np.int32(points[cell] < value)
            index[k] = index[k] * size + cell
    missing[0] += bad


@kernel
def add_neighbours(
    x: Any,
    points: Any,
    start: Any,
    edge: Any,
    levels: Any,
    axis: Any,
    index: Any,
    share: Any,
    missing: Any,
) -> None:
    """Add the lower neighbour of x to `index`, and set the share of the way to the upper one.

    The points are the inner levels. NaN are counted.
    """
    low, inverse, steps, stride = axis[LOW], axis[INVERSE], int(axis[STEPS]), np.int32(axis[SIZE])
    last = start.size - 1.0
    # As in `add_cells`, but with <=: a value on a level has it as its lower neighbour.
    first, final = levels[0], levels[levels.size - 1]
    bad = 0
    for k in range(x.size):
        value = x[k]
        bad += value != value  # noqa: PLR0124 - true for NaN only
        value = clamp(value, first, final)
        bucket = _bucket_of(value, low, inverse, last)
        cell = start[bucket] + np.int32(edge[bucket] <= value)
        for _ in range(steps - 1):
            cell += np.int32(points[cell] <= value)
        index[k] += cell * stride
        share[k] = share_of_way(value, levels[cell], levels[cell + 1])
    missing[0] += bad


@kernel
def gather(values: Any, index: Any, out: Any) -> None:
    """Fetch the values of cells."""
    for k in range(out.size):
        out[k] = values[index[k]]


@kernel
def blend_corners(values: Any, index: Any, shares: Any, offsets: Any, work: Any, out: Any) -> None:
    """Interpolate between the corners of cells, the last axis first.

    `shares` has a stretch as long as `out` for each axis, `offsets` is that of
    :func:`corner_offsets`; `work` has room for the corners.
    """
    points = out.size
    if offsets.size == 4:  # two axes
        one, two, three = offsets[1], offsets[2], offsets[3]
        for k in range(points):
            cell, s, t = index[k], shares[k], shares[points + k]
            near = blend(values[cell], values[cell + one], t)
            far = blend(values[cell + two], values[cell + three], t)
            out[k] = blend(near, far, s)
        return
    # Corners in binary order, the last axis fastest: each pass blends pairs and halves the list.
    axes = shares.size // max(points, 1)
    for k in range(points):
        origin, left = index[k], offsets.size
        for corner in range(left):
            work[corner] = values[origin + offsets[corner]]
        for axis in range(axes - 1, -1, -1):
            t = shares[axis * points + k]
            left //= 2
            for corner in range(left):
                work[corner] = blend(work[2 * corner], work[2 * corner + 1], t)
        out[k] = work[0]


ROOTS: tuple[tuple[Callable[..., None], str], ...] = (
    (add_cells, "ffsffsi"),
    (add_neighbours, "ffsfffsfi"),
    (gather, "fsf"),
    (blend_corners, "fsfiff"),
)
"""Kernels, and their arrays by the letters of :func:`fuzzyarm.symbolic.kernels.address_of`."""


@cache
def _machine(function: Callable[..., Any], *, compiled: bool) -> Callable[..., None]:
    return routine(function, dict(ROOTS)[function], compiled=compiled)


def worthwhile(points: int) -> bool:
    """Whether machine code pays off for so many points in this process."""
    return points >= WORTH_CALLING and has_machine_code()


Evaluate = Callable[[Sequence[_Array], _Array], bool]
"""Fills the last argument with values at columns of inputs; false if one is NaN."""


def picker(
    values: _Array, thresholds: Sequence[Sequence[float]], *, compiled: bool = True
) -> Evaluate | None:
    """Return a look-up of cells; None for thresholds too uneven for buckets.

    `compiled` chooses machine code, or the same kernels in plain Python.
    """
    finders = [make_finder(edges) for edges in thresholds]
    if any(finder is None for finder in finders):
        return None
    cells, fetch = _machine(add_cells, compiled=compiled), _machine(gather, compiled=compiled)
    flat = np.ascontiguousarray(values).ravel()
    axes = [
        _arrays_of(finder, size)
        for finder, size in zip(finders, values.shape, strict=True)
        if finder is not None
    ]

    def evaluate(columns: Sequence[_Array], out: _Array) -> bool:
        index = np.zeros(out.shape, dtype=np.int32)
        missing = np.zeros(1, dtype=np.int64)
        for (points, start, edge, numbers), x in zip(axes, columns, strict=True):
            cells(x, points, start, edge, numbers, index, missing)
        if missing[0]:
            return False
        fetch(flat, index, out)
        return True

    return evaluate


def _arrays_of(finder: BucketIndex, size: int) -> tuple[_Array, _Cells, _Array, _Array]:
    """Return a finder as arrays of the kernel, with strides."""
    numbers = np.array([finder.low, finder.inverse, finder.steps, size], dtype=np.float64)
    return finder.points, finder.start, finder.edge, numbers


def interpolator(
    values: _Array, levels: Sequence[Sequence[float]], *, compiled: bool = True
) -> Evaluate | None:
    """Return an interpolation; None for levels too uneven for buckets.

    `compiled` chooses machine code, or the same kernels in plain Python.
    """
    finders = [make_finder(points[1:-1]) for points in levels]
    if any(finder is None for finder in finders):
        return None
    neighbours = _machine(add_neighbours, compiled=compiled)
    mix = _machine(blend_corners, compiled=compiled)
    flat = np.ascontiguousarray(values).ravel()
    strides = strides_of(values.shape)
    offsets = np.array(corner_offsets(values.shape), dtype=np.int64)
    wide = [k for k, size in enumerate(values.shape) if size > 1]
    axes = [
        (k, np.array(levels[k], dtype=np.float64), *_arrays_of(finder, strides[k]))
        for k, finder in enumerate(finders)
        if finder is not None and k in wide
    ]

    def evaluate(columns: Sequence[_Array], out: _Array) -> bool:
        index = np.zeros(out.shape, dtype=np.int32)
        shares = np.empty((len(wide), out.size))
        missing = np.zeros(1, dtype=np.int64)
        for k, x in enumerate(columns):
            if k not in wide and np.isnan(x).any():
                return False
        for row, (k, points_of_axis, points, start, edge, numbers) in enumerate(axes):
            x = columns[k]
            neighbours(x, points, start, edge, points_of_axis, numbers, index, shares[row], missing)
        if missing[0]:
            return False
        mix(flat, index, shares.ravel(), offsets, np.empty(offsets.size), out)
        return True

    return evaluate


# --- Arrays of any size and shape, in chunks that stay in the cache ---

_CHUNK = 16_384
"""Points at a time: their arrays fit the second-level cache."""


def look_up_arrays(
    axes: Sequence[Axis],
    cells: NDArray[np.float64],
    inputs: Sequence[NDArray[np.float64]],
    mode: str,
) -> NDArray[np.float64]:
    """Return the values of a table at broadcast inputs; no temporary exceeds a chunk."""
    try:
        shape = np.broadcast_shapes(*(array.shape for array in inputs))
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in inputs)
        raise TableError(f"inputs of shapes {shapes} do not fit each other") from None
    values = np.empty(shape)
    evaluate = _machine_code(axes, cells, mode) if worthwhile(values.size) else None
    threads = 1
    if evaluate is None:
        evaluate = _plain(axes, cells, mode)
    elif values.size >= WORTH_THREADS:
        threads = processors()
    if threads == 1:
        _fill(axes, evaluate, inputs, values)
        return values
    full = [np.broadcast_to(array, shape) for array in inputs]
    axis = int(np.argmax(shape))
    edges = [shape[axis] * k // threads for k in range(threads + 1)]
    parts = [(slice(None),) * axis + (slice(*ends),) for ends in itertools.pairwise(edges)]

    def fill(some: Iterator[tuple[slice, ...]]) -> None:
        for part in some:
            _fill(axes, evaluate, [x[part] for x in full], values[part])

    in_threads(fill, parts, threads)
    return values


def _fill(
    axes: Sequence[Axis],
    evaluate: Evaluate,
    inputs: Sequence[NDArray[np.float64]],
    values: NDArray[np.float64],
) -> None:
    chunks = np.nditer(  # type: ignore[call-overload]
        [*inputs, values],
        flags=["external_loop", "buffered", "zerosize_ok"],
        op_flags=[*([["readonly", "contig"]] * len(inputs)), ["writeonly", "contig"]],
        buffersize=_CHUNK,
        order="C",
    )
    with chunks:
        for chunk in chunks:
            *columns, out = chunk
            if not evaluate(columns, out):
                bad = (a.name for a, x in zip(axes, columns, strict=True) if np.isnan(x).any())
                raise TableError(f"input '{next(bad)}' of the table is not a number (NaN)")


def _machine_code(axes: Sequence[Axis], cells: NDArray[np.float64], mode: str) -> Evaluate | None:
    """Return the reading in machine code; None where an axis is too uneven for it."""
    if mode == "linear":
        return interpolator(cells, [axis.levels for axis in axes])
    return picker(cells, [axis.thresholds(mode) for axis in axes])


def _plain(axes: Sequence[Axis], cells: NDArray[np.float64], mode: str) -> Evaluate:
    """Return the reading with NumPy."""
    linear = mode == "linear"
    points = [np.array(a.levels if linear else a.thresholds(mode)) for a in axes]
    grid = PreparedTable.of(cells.shape, points, cells.ravel(), OVER_ARRAYS)
    look_up = grid.interpolate if linear else grid.pick

    def evaluate(columns: Sequence[_Array], out: _Array) -> bool:
        if any(np.isnan(x).any() for x in columns):
            return False
        out[...] = look_up(columns)
        return True

    return evaluate
