"""Arrays of points through the kernel: copied into its block in chunks that stay in the cache."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.inference.arrays import blocks, infer_arrays, part_of, working_shape
from fuzzyarm.inference.block import (
    INPUTS,
    MISSING,
    OUTPUTS,
    POINTS,
    WIDTH,
    Layout,
    PointBlock,
    make_block,
)
from fuzzyarm.inference.kernel import sweep
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic.kernels import bound_routine, in_threads, processors, sweep_routine

CHUNK = 8192
"""Points that go through the kernel together: their inputs and outputs stay in the cache."""

FEW = 512
"""Up to so many points go through a block of their own: a large one takes longer to come by."""

POINTS_PER_PROGRAM = 32
"""Wanted in a chunk, as a mean, where there are many programs …"""

LONGEST_CHUNK = 1 << 17
"""… but no longer than this."""


MANY = 100_000
"""Points from which on all processors are used."""

SHARES = 4
"""Parts for each of them."""

MOST_COLUMNS = 64
"""Inputs, and outputs, for which the machine code over arrays has room."""


_Sweep = Callable[[tuple[Any, ...], int, int], int]
"""From arrays, the first element and the one behind the last to how many outputs have no value."""


def on_block(block: PointBlock, *, compiled: bool) -> Callable[[], None]:
    """Return the shortest call of the kernel on a block, which the caller keeps."""
    numbers = np.asarray(block.numbers)
    if not compiled:
        quiet = np.errstate(divide="ignore", invalid="ignore", over="ignore")
        return partial(quiet(sweep), numbers)
    return bound_routine(sweep, "f", (numbers,))


class _Chunk:
    """A block with room for a chunk of points, and its kernel."""

    def __init__(self, layout: Layout, points: int, *, compiled: bool) -> None:
        block = make_block(layout, points)
        self.run = on_block(block, compiled=compiled)
        self.whole, width = block.whole, block.whole[WIDTH]
        self.columns, self.results = (
            np.asarray(block.numbers[begin : begin + rows * width]).reshape(rows, width)
            for begin, rows in (
                (block.columns, layout.whole[INPUTS]), (block.results, layout.whole[OUTPUTS])
            )
        )  # fmt: skip


class Sweeps:
    """The kernel over arrays, with the numbers of one rule base."""

    def __init__(self, rulebase: RuleBase, layout: Layout, *, compiled: bool) -> None:
        self.rulebase = rulebase
        self._layout = layout
        self._compiled = compiled
        length = min(POINTS_PER_PROGRAM * layout.programs, LONGEST_CHUNK)
        self._chunk = max(CHUNK, length)
        self._free: dict[int, list[_Chunk]] = {FEW: [], self._chunk: []}
        self._sweeps: dict[int, list[_Sweep]] = {FEW: [], self._chunk: []}

    def many(
        self, inputs: Mapping[str, Any], held: Mapping[str, float] | None
    ) -> dict[str, NDArray[np.float64]]:
        """Evaluate arrays of points."""
        arrays = {
            variable.name: np.asarray(inputs[variable.name]) for variable in self.rulebase.inputs
        }
        if any(array.dtype.kind not in "fiub" for array in arrays.values()):
            return infer_arrays(self.rulebase, inputs, held)  # which says what is wrong
        try:
            shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
        except ValueError:
            return infer_arrays(self.rulebase, inputs, held)
        working = working_shape(arrays, shape)
        size = math.prod(shape)
        results = np.empty((len(self.rulebase.outputs), *working))
        workers = processors() if size >= MANY and self._compiled else 1
        few = max(len(arrays), len(results)) <= MOST_COLUMNS
        if (
            self._compiled
            and few
            and all(_is_plain(input_array, working) for input_array in arrays.values())
        ):
            missing = self._sweep((*arrays.values(), *results), size, workers)
        else:
            turns = max(1, math.ceil(size / (workers * self._chunk)))
            parts = blocks(working, math.ceil(size / (workers * turns))) if size else ()

            def fill(some: Iterator[tuple[slice, ...]]) -> int:
                return sum(self._fill(arrays, working, results, part) for part in some)

            missing = sum(in_threads(fill, parts, workers))
        if missing:
            self._complete(arrays, working, results, held)
        names = [output.name for output in self.rulebase.outputs]
        return {n: result.reshape(shape) for n, result in zip(names, results, strict=True)}

    def _sweep(self, arrays: tuple[NDArray[np.float64], ...], size: int, workers: int) -> int:
        """Evaluate plain arrays; return how many outputs have no ordinary value."""
        # A few shares for each thread: another process may hold one of them up.
        share = max(self._chunk, math.ceil(size / (SHARES * workers)))
        room = self._room(size)

        def fill(starts: Iterator[int]) -> int:
            try:
                sweep_arrays = self._sweeps[room].pop()
            except IndexError:
                sweep_arrays = self._sweeper(room)
            missing = sum(sweep_arrays(arrays, at, min(at + share, size)) for at in starts)
            self._sweeps[room].append(sweep_arrays)
            return missing

        return sum(in_threads(fill, range(0, size, share), workers))

    def _room(self, size: int) -> int:
        """Return the points for which the block of so many has room."""
        return FEW if size <= FEW else self._chunk

    def _sweeper(self, points: int) -> _Sweep:
        block = make_block(self._layout, points)
        return sweep_routine(
            sweep,
            block.numbers,
            (points, block.whole[WIDTH]),
            (len(self.rulebase.inputs), block.columns),
            (len(self.rulebase.outputs), block.results),
            (POINTS, MISSING),
        )

    def _fill(
        self,
        arrays: Mapping[str, NDArray[Any]],
        working: tuple[int, ...],
        results: NDArray[np.float64],
        part: tuple[slice, ...],
    ) -> int:
        """Evaluate one chunk of points; return how many outputs have no ordinary value."""
        shape = tuple(extent.stop - extent.start for extent in part)
        count = math.prod(shape)
        room = self._room(count)
        try:
            chunk = self._free[room].pop()
        except IndexError:
            chunk = _Chunk(self._layout, room, compiled=self._compiled)
        chunk.whole[POINTS] = count
        for column, array in zip(chunk.columns, arrays.values(), strict=True):
            column[:count].reshape(shape)[...] = part_of(array, working, part)
        chunk.run()
        results[:, *part] = chunk.results[:, :count].reshape(-1, *shape)
        missing = chunk.whole[MISSING]
        self._free[room].append(chunk)
        return missing

    def _complete(
        self,
        arrays: Mapping[str, NDArray[Any]],
        working: tuple[int, ...],
        results: NDArray[np.float64],
        held: Mapping[str, float] | None,
    ) -> None:
        """Let the engine for arrays settle points without an ordinary value."""
        where = np.isnan(results).any(axis=0)
        remaining = {name: np.broadcast_to(a, working)[where] for name, a in arrays.items()}
        outputs = infer_arrays(self.rulebase, remaining, held)
        for result, values in zip(results, outputs.values(), strict=True):
            result[where] = values


class StagedSweeps:
    """The kernel over arrays, stage by stage; see :mod:`.stages`."""

    def __init__(self, rulebase: RuleBase, parts: Sequence[Sweeps]) -> None:
        self.rulebase = rulebase
        self._parts = parts

    def many(
        self, inputs: Mapping[str, Any], held: Mapping[str, float] | None
    ) -> dict[str, NDArray[np.float64]]:
        """Evaluate arrays of points."""
        values = dict(inputs)
        results: dict[str, NDArray[np.float64]] = {}
        gaps = np.zeros((), dtype=bool)
        for part in self._parts:
            names = {output.name for output in part.rulebase.outputs}
            own_held = {name: value for name, value in (held or {}).items() if name in names}
            try:
                found = part.many(
                    {each.name: values[each.name] for each in part.rulebase.inputs}, own_held
                )
            except FuzzyarmError:
                return infer_arrays(self.rulebase, inputs, held)  # which knows the inputs
            results |= found
            for name, column in found.items():
                lost = np.isnan(column)
                gaps = gaps | lost
                values[name] = np.where(lost, 0.0, column) if lost.any() else column
        if gaps.any():  # rules that read no value do not hold
            self._complete(inputs, gaps, results, held)
        return {output.name: results[output.name] for output in self.rulebase.outputs}

    def _complete(
        self,
        inputs: Mapping[str, Any],
        gaps: NDArray[np.bool_],
        results: Mapping[str, NDArray[np.float64]],
        held: Mapping[str, float] | None,
    ) -> None:
        remaining = {name: np.broadcast_to(x, gaps.shape)[gaps] for name, x in inputs.items()}
        for name, values in infer_arrays(self.rulebase, remaining, held).items():
            results[name][gaps] = values


def _is_plain(array: NDArray[Any], shape: tuple[int, ...]) -> bool:
    """Whether the machine code can read an array as it is."""
    return array.dtype == np.float64 and array.shape == shape and array.flags.c_contiguous
