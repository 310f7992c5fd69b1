"""Arrays of points through the kernel: copied into its block in chunks that stay in the cache.

Without machine code each point is evaluated by itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import compress
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.block import INPUTS, MISSING, OUTPUTS, POINTS, WIDTH, Layout, make_block
from fuzzyarm.inference.inputs import array_in_range, arrays_of, held_value, replaces_nan
from fuzzyarm.inference.kernel import sweep
from fuzzyarm.inference.stage import Stage
from fuzzyarm.language.model.rulebase import Output, RuleBase
from fuzzyarm.symbolic.kernels import bound_routine, in_threads, processors, sweep_routine

if TYPE_CHECKING:
    from collections.abc import Callable

    _Sweep = Callable[[tuple[Any, ...], int, int], int]
    """From arrays, the first element and the one behind the last to how many outputs are NaN."""

Array = NDArray[np.float64]

CHUNK = 8192
"""Points that go through the kernel together: their inputs and outputs stay in the cache."""

FEW = 512
"""Up to so many points get a small block of their own: a large one takes longer to make."""

POINTS_PER_PROGRAM = 32
"""Desired mean in a chunk, if there are many programs …"""

LONGEST_CHUNK = 1 << 17
"""… but no longer than this."""

MANY = 100_000
"""Points from which on all processors are used."""

SHARES = 4
"""Parts for each of them."""

MOST_COLUMNS = 64
"""Inputs, and outputs, for which the machine code over arrays has room."""


# ── blocks of points ─────────────────────────────────────────────────────────────────

Part = tuple[slice, ...]
"""Of an array, axis by axis."""


def parts_of(shape: tuple[int, ...], most: int) -> Iterator[Part]:
    """Yield parts of an array, each of at most `most` elements, in the order of memory."""
    if math.prod(shape) <= most:
        yield tuple(slice(0, n) for n in shape)
        return
    inner = math.prod(shape[1:])
    rows = most // inner
    if rows >= 1:
        for start in range(0, shape[0], rows):
            rest = tuple(slice(0, n) for n in shape[1:])
            yield (slice(start, min(start + rows, shape[0])), *rest)
        return
    for row in range(shape[0]):
        for part in parts_of(shape[1:], most):
            yield (slice(row, row + 1), *part)


def _working_shape(arrays: dict[str, Array], shape: tuple[int, ...]) -> tuple[int, ...]:
    """Return the shape of the work: that of the broadcast arrays, or one axis if that is enough."""
    size = math.prod(shape)
    # Scalars and full arrays need one axis. Otherwise the axes stay, so that an input along one of
    # them keeps its small shape.
    flat = all(array.size in {1, size} for array in arrays.values())
    for name, array in arrays.items():
        filled = (1,) * (len(shape) - array.ndim) + array.shape
        arrays[name] = array.reshape(-1 if flat else filled)
    return (size,) if flat else shape


def _part_of(array: Array, part: Part) -> Array:
    """Return a part of an input; axes of length 1 stay."""
    return array[
        tuple(slice(None) if n == 1 else some for n, some in zip(array.shape, part, strict=True))
    ]


# ── the machine code ─────────────────────────────────────────────────────────────────


class _Chunk:
    """A block with room for a chunk of points, and its kernel."""

    def __init__(self, layout: Layout, points: int) -> None:
        block = make_block(layout, points)
        self.run = bound_routine(sweep, "f", (block.numbers,))
        self.whole, width = block.whole, block.whole[WIDTH]
        self.columns, self.results = (
            np.asarray(block.numbers[begin : begin + rows * width]).reshape(rows, width)
            for begin, rows in (
                (block.columns, layout.whole[INPUTS]), (block.results, layout.whole[OUTPUTS])
            )
        )  # fmt: skip


class Sweeps:
    """The kernel over arrays, with the numbers of one stage."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._rulebase, self._layout = stage.rulebase, stage.layout
        length = min(POINTS_PER_PROGRAM * self._layout.programs, LONGEST_CHUNK)
        self._chunk = max(CHUNK, length)
        self._free: dict[int, list[_Chunk]] = {FEW: [], self._chunk: []}
        self._sweeps: dict[int, list[_Sweep]] = {FEW: [], self._chunk: []}

    def many(
        self, arrays: dict[str, Array], shape: tuple[int, ...], held: Mapping[str, float]
    ) -> dict[str, Array]:
        """Evaluate arrays of points, which broadcast to a shape."""
        working = _working_shape(arrays, shape)
        results = np.empty((len(self._rulebase.outputs), *working))
        if self._stage.compiled:
            missing = self._by_machine_code(arrays, working, results)
        else:
            missing = self._point_by_point(arrays, working, results)
        if missing:
            self._complete(arrays, working, results, held)
        names = [output.name for output in self._rulebase.outputs]
        return {n: result.reshape(shape) for n, result in zip(names, results, strict=True)}

    def _point_by_point(
        self, arrays: Mapping[str, Array], working: tuple[int, ...], results: Array
    ) -> int:
        """Interpret the kernel at each point; return the number of extraordinary results."""
        columns = [np.broadcast_to(array, working).ravel().tolist() for array in arrays.values()]
        rows = results.reshape(len(results), -1)
        for point, values in enumerate(zip(*columns, strict=True)):
            found = self._stage.found(values)
            rows[:, point] = math.nan if found is None else found
        return int(np.isnan(rows).sum())

    def _by_machine_code(
        self, arrays: Mapping[str, Array], working: tuple[int, ...], results: Array
    ) -> int:
        """Fill in the results; return the number of those without an ordinary value."""
        size = math.prod(working)
        workers = processors() if size >= MANY else 1
        few = max(len(arrays), len(results)) <= MOST_COLUMNS
        if few and all(_is_plain(array, working) for array in arrays.values()):
            return self._sweep((*arrays.values(), *results), size, workers)
        turns = max(1, math.ceil(size / (workers * self._chunk)))
        parts = parts_of(working, math.ceil(size / (workers * turns))) if size else ()

        def fill(some: Iterator[Part]) -> int:
            return sum(self._fill(arrays, results, part) for part in some)

        return sum(in_threads(fill, parts, workers))

    def _sweep(self, arrays: tuple[Array, ...], size: int, workers: int) -> int:
        """Evaluate plain arrays; return the number of outputs without an ordinary value."""
        # A few shares for each thread: another process may delay one of them.
        share = max(self._chunk, math.ceil(size / (SHARES * workers)))
        capacity = self._room(size)

        def fill(starts: Iterator[int]) -> int:
            try:
                sweep_arrays = self._sweeps[capacity].pop()
            except IndexError:
                sweep_arrays = self._sweeper(capacity)
            missing = sum(sweep_arrays(arrays, at, min(at + share, size)) for at in starts)
            self._sweeps[capacity].append(sweep_arrays)
            return missing

        return sum(in_threads(fill, range(0, size, share), workers))

    def _room(self, size: int) -> int:
        """Return the capacity in points of the block for `size` points."""
        return FEW if size <= FEW else self._chunk

    def _sweeper(self, points: int) -> _Sweep:
        block = make_block(self._layout, points)
        return sweep_routine(
            sweep,
            block.numbers,
            (points, block.whole[WIDTH]),
            (len(self._rulebase.inputs), block.columns),
            (len(self._rulebase.outputs), block.results),
            (POINTS, MISSING),
        )

    def _fill(self, arrays: Mapping[str, Array], results: Array, part: Part) -> int:
        """Evaluate one chunk of points; return the number of outputs without an ordinary value."""
        shape = tuple(extent.stop - extent.start for extent in part)
        count = math.prod(shape)
        capacity = self._room(count)
        try:
            chunk = self._free[capacity].pop()
        except IndexError:
            chunk = _Chunk(self._layout, capacity)
        chunk.whole[POINTS] = count
        for column, array in zip(chunk.columns, arrays.values(), strict=True):
            column[:count].reshape(shape)[...] = _part_of(array, part)
        chunk.run()
        results[:, *part] = chunk.results[:, :count].reshape(-1, *shape)
        missing = chunk.whole[MISSING]
        self._free[capacity].append(chunk)
        return missing

    # ── points without an ordinary value ─────────────────────────────────────────────

    def _complete(
        self,
        arrays: Mapping[str, Array],
        working: tuple[int, ...],
        results: Array,
        held: Mapping[str, float],
    ) -> None:
        """Fill in the values where an output has none, or raise an error."""
        inputs = self._rulebase.inputs
        valid = {v.name: array_in_range(v, arrays[v.name]) for v in inputs}
        endless = any(np.isinf(array).any() for array in valid.values())
        where = np.isnan(results).any(axis=0)
        if not endless and all(
            not np.isnan(result).any() or self._fill_gaps(output, result, held)
            for output, result in zip(self._rulebase.outputs, results, strict=True)
        ):
            return
        rows = [np.broadcast_to(array, working)[where].tolist() for array in valid.values()]
        settled = np.empty((int(where.sum()), len(results)))
        for point, numbers in enumerate(zip(*rows, strict=True)):
            values = dict(zip(valid, numbers, strict=True))
            self._stage.complete(values, held)
            settled[point] = [values[output.name] for output in self._rulebase.outputs]
        results[:, where] = settled.T

    def _fill_gaps(self, output: Output, result: Array, held: Mapping[str, float]) -> bool:
        """Fill in the held value, or NaN; return False if there may be another cause."""
        if output.outside != "clamp" or not replaces_nan(output):
            return False
        if output.no_rule == "hold":
            result[np.isnan(result)] = held_value(output, held)
        return True


class StagedSweeps:
    """The kernel over arrays, stage by stage; see :mod:`.stages`."""

    def __init__(self, rulebase: RuleBase, stages: Sequence[Stage]) -> None:
        self._rulebase = rulebase
        self._stages = stages
        self._sweeps: dict[int, Sweeps] = {}

    def many(self, inputs: Mapping[str, Any], held: Mapping[str, float]) -> dict[str, Array]:
        """Evaluate arrays of points."""
        values, shape = arrays_of(self._rulebase, inputs)
        if len(self._stages) == 1:
            return self._sweeps_of(self._stages[0]).many(values, shape, held)
        for variable in self._rulebase.inputs:
            values[variable.name] = array_in_range(variable, values[variable.name])
        for stage in self._stages:
            arrays = {name: values[name] for name in stage.inputs}
            values |= self._of_stage(stage, arrays, shape, held)
        return {output.name: values[output.name] for output in self._rulebase.outputs}

    def _sweeps_of(self, stage: Stage) -> Sweeps:
        if id(stage) not in self._sweeps:  # kept alive by the stages
            self._sweeps[id(stage)] = Sweeps(stage)
        return self._sweeps[id(stage)]

    def _of_stage(
        self,
        stage: Stage,
        arrays: dict[str, Array],
        shape: tuple[int, ...],
        held: Mapping[str, float],
    ) -> dict[str, Array]:
        """Evaluate a stage: points that lack the same earlier outputs together."""
        gaps = {name: np.isnan(array) for name, array in arrays.items()}
        some = [name for name, gap in gaps.items() if gap.any()]
        if not some:
            return self._sweeps_of(stage).many(arrays, shape, held)
        columns = {name: np.broadcast_to(array, shape) for name, array in arrays.items()}
        patterns = np.zeros(shape, dtype=np.int64)
        for number, name in enumerate(some):
            patterns += np.broadcast_to(gaps[name], shape) * (1 << number)
        results = {output.name: np.empty(shape) for output in stage.rulebase.outputs}
        for pattern in np.unique(patterns).tolist():
            where = patterns == pattern
            missing = tuple(compress(some, (pattern >> n & 1 for n in range(len(some)))))
            part = {name: column[where] for name, column in columns.items()}
            part |= {name: np.zeros_like(part[name]) for name in missing}
            found = self._sweeps_of(stage.without(missing)).many(part, (int(where.sum()),), held)
            for name, column in found.items():
                results[name][where] = column
        return results


def _is_plain(array: Array, shape: tuple[int, ...]) -> bool:
    """Whether the machine code can read an array directly."""
    return array.shape == shape and array.flags.c_contiguous
