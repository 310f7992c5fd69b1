"""The callable that :func:`fuzzyarm.compiled` returns."""

from __future__ import annotations

import math
import os
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.arrays import blocks, infer_arrays, part_of, working_shape
from fuzzyarm.inference.block import Block, Layout, NotCoveredError, make_block
from fuzzyarm.inference.errors import NotANumberError
from fuzzyarm.inference.kernel import MISSING, evaluate, sweep
from fuzzyarm.inference.labelled import gathered
from fuzzyarm.inference.layout import lay_out
from fuzzyarm.inference.plan import plan, remembered
from fuzzyarm.inference.point import check_names, holds_arrays, number_of, prepare
from fuzzyarm.kernels import bound_routine, has_machine_code, in_threads
from fuzzyarm.model.rulebase import AnyRuleBase, RuleBase

CHUNK = 8192
"""Points that go through the kernel together: their inputs and outputs stay in the cache."""

POINTS_PER_PROGRAM = 32
"""Wanted in a chunk, as a mean, where there are many programs …"""

LONGEST_CHUNK = 1 << 17
"""… but no longer than this."""


MANY = 100_000
"""Points from which on all processors are used."""


def on_block(
    function: Callable[[Any], None], block: NDArray[np.float64], *, compiled: bool
) -> Callable[[], None]:
    """Return the shortest call of a kernel on a block, which the caller keeps."""
    if not compiled:
        quiet = np.errstate(divide="ignore", invalid="ignore", over="ignore")
        return partial(quiet(function), block)
    # One point takes less time than to free the GIL and to wait for it again.
    return bound_routine(function, "f", (block,), brief=function is evaluate)


_Point = Callable[[Iterable[float]], "tuple[float, ...] | None"]
"""From the inputs at a point to the outputs; None where one of them has no value."""


class Compiled:
    """A rule base ready to be evaluated fast; call it like :func:`fuzzyarm.infer`.

    Attributes
    ----------
    rulebase : RuleBase
        As given.
    kernel : str
        ``"machine code"``; ``"python"`` where there is none; ``"numpy"`` where the
        kernel does not cover the rule base, which then goes through :func:`infer`.
    reason : str
        What the kernel does not cover; empty where it does.
    """

    __slots__ = ("_engine", "_names", "_one", "_only", "_outputs", "kernel", "reason", "rulebase")

    def __init__(self, rulebase: RuleBase) -> None:
        self.rulebase = rulebase
        self.kernel = "machine code" if has_machine_code() else "python"
        self.reason = ""
        self._names = tuple(variable.name for variable in rulebase.inputs)
        self._outputs = tuple(output.name for output in rulebase.outputs)
        self._engine: _Engine | None = None
        self._one: _Point = lambda _: None
        self._only = self._outputs[0] if len(self._outputs) == 1 else None
        try:
            layout = lay_out(plan(rulebase), compiled=self.kernel == "machine code")
        except NotCoveredError as error:
            self.kernel, self.reason = "numpy", str(error)
        else:
            self._engine = _Engine(rulebase, layout, compiled=self.kernel == "machine code")
            self._one = self._engine.one

    def __reduce__(self) -> tuple[type[Compiled], tuple[RuleBase]]:
        # Machine code stays; another process takes its own from the disk.
        return type(self), (self.rulebase,)

    def __repr__(self) -> str:
        why = f": {self.reason}" if self.reason else ""
        return f"<compiled {self.rulebase.name!r}, kernel {self.kernel}{why}>"

    def at(self, *values: float) -> tuple[float, ...]:
        """Evaluate one point: the shortest way.

        Parameters
        ----------
        *values : float
            The inputs in their order.

        Returns
        -------
        tuple of float
            The outputs in their order.
        """
        if len(values) == len(self._names):
            try:
                found = self._one(values)
            except struct.error:  # one is not a number, which the engine for a point says
                found = None
            if found is not None:
                return found
        return tuple(prepare(self.rulebase).evaluate(self._by_name(values)).values())

    def __call__(
        self,
        *values: Any,
        held: Mapping[str, float] | None = None,
        **named: Any,
    ) -> Any:
        """Evaluate the rule base.

        Parameters
        ----------
        *values : float, array_like, mapping, DataFrame or Dataset
            The inputs in their order, or all of them by name in one.
        held : mapping of str to float, optional
            Last values of outputs that hold where no rule fires.
        **named : float, array_like, Series, DataFrame or DataArray
            Inputs by name. Arrays broadcast against each other.

        Returns
        -------
        dict of str to float or ndarray of float64
            What :func:`fuzzyarm.infer` returns, and it raises the same errors.
        """
        if not values and tuple(named) == self._names:  # the thin path
            for value in named.values():
                if type(value) is not float:
                    break
            else:
                found = self._one(named.values())
                if found is not None:
                    if self._only is not None:
                        return {self._only: found[0]}
                    return dict(zip(self._outputs, found, strict=True))
        given, labels = gathered(self._mapping(values), named, self.rulebase.inputs)
        general = self._general(given, held)
        return general if labels is None else labels.on(general)

    def _general(
        self, given: Mapping[str, Any], held: Mapping[str, float] | None
    ) -> dict[str, Any]:
        if self._engine is None or given.keys() != set(self._names):
            return self._plain(given, held)
        if held:
            check_names(held, self._outputs, what="output")
        if holds_arrays(given):
            return dict(self._engine.many(given, held))
        found = self.ordinary(given)
        return self._plain(given, held) if found is None else dict(found)

    def ordinary(self, given: Mapping[str, Any]) -> dict[str, float] | None:
        """Return the outputs at a point by the kernel; None where one is not ordinary."""
        if self._engine is None or given.keys() != set(self._names):
            return None
        try:
            found = self._one([number_of(name, given[name]) for name in self._names])
        except NotANumberError:
            return None  # the engine for a point says so
        return None if found is None else dict(zip(self._outputs, found, strict=True))

    def _plain(self, given: Mapping[str, Any], held: Mapping[str, float] | None) -> dict[str, Any]:
        """Evaluate without the kernel: what it does not cover, and what is wrong."""
        if holds_arrays(given):
            return dict(infer_arrays(self.rulebase, given, held))
        return dict(prepare(self.rulebase).evaluate(given, held))

    def _mapping(self, values: tuple[Any, ...]) -> Any:
        if len(values) == 1 and (values[0] is None or _is_by_name(values[0])):
            return values[0]
        return self._by_name(values)

    def _by_name(self, values: tuple[Any, ...]) -> dict[str, Any]:
        if len(values) > len(self._names):
            raise TypeError(f"{len(values)} inputs are given, there are {len(self._names)}")
        return dict(zip(self._names, values, strict=False))


def _is_by_name(value: Any) -> bool:
    """Whether a value has inputs by name: a mapping, a DataFrame, a Dataset."""
    return isinstance(value, Mapping) or (hasattr(value, "columns") and hasattr(value, "index"))


class _Engine:
    """The kernel with the numbers of one rule base."""

    def __init__(self, rulebase: RuleBase, layout: Layout, *, compiled: bool) -> None:
        self.rulebase = rulebase
        self._layout = layout
        self._compiled = compiled
        wanted = min(POINTS_PER_PROGRAM * layout.programs, LONGEST_CHUNK)
        self._chunk = max(CHUNK, wanted)
        self._free: list[tuple[Block, Callable[[], None]]] = []
        self.one = self._point_function(make_block(layout, 1))

    def _point_function(self, first: Block) -> _Point:
        """Make the function; evaluations in several threads at once take a block each."""
        start = first.numbers.ctypes.data
        pack = struct.Struct(f"={len(first.columns)}d").pack_into
        unpack = struct.Struct(f"={len(first.results)}d").unpack_from
        x_at, y_at = first.columns.ctypes.data - start, first.results.ctypes.data - start
        free: list[tuple[Callable[..., None], Callable[[], None], Callable[[], Any]]] = []
        take, give = free.pop, free.append
        isnan, several = math.isnan, len(first.results) > 1

        def one(values: Iterable[float]) -> tuple[float, ...] | None:
            try:
                calls = take()
            except IndexError:
                block = first.numbers.copy()
                room = memoryview(block).cast("B")  # type: ignore[arg-type]
                run_block = on_block(evaluate, block, compiled=self._compiled)
                calls = partial(pack, room, x_at), run_block, partial(unpack, room, y_at)
            write, run_block, read = calls
            write(*values)
            run_block()
            found: tuple[float, ...] = read()
            give(calls)
            if isnan(found[0]) or (several and any(map(isnan, found))):
                return None
            return found

        return one

    def many(
        self, given: Mapping[str, Any], held: Mapping[str, float] | None
    ) -> dict[str, NDArray[np.float64]]:
        """Evaluate arrays of points."""
        arrays = {each.name: np.asarray(given[each.name]) for each in self.rulebase.inputs}
        if any(array.dtype.kind not in "fiub" for array in arrays.values()):
            return infer_arrays(self.rulebase, given, held)  # which says what is wrong
        try:
            shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
        except ValueError:
            return infer_arrays(self.rulebase, given, held)
        working = working_shape(arrays, shape)
        size = math.prod(shape)
        results = np.empty((len(self.rulebase.outputs), *working))
        workers = (os.cpu_count() or 1) if size >= MANY and self._compiled else 1
        turns = max(1, math.ceil(size / (workers * self._chunk)))
        parts = blocks(working, math.ceil(size / (workers * turns))) if size else ()

        def fill(some: Iterator[tuple[slice, ...]]) -> int:
            return sum(self._fill(arrays, working, results, part) for part in some)

        missing = sum(in_threads(fill, parts, workers))
        if missing:
            self._complete(arrays, working, results, held)
        names = [output.name for output in self.rulebase.outputs]
        return {n: result.reshape(shape) for n, result in zip(names, results, strict=True)}

    def _fill(
        self,
        arrays: Mapping[str, NDArray[Any]],
        working: tuple[int, ...],
        results: NDArray[np.float64],
        part: tuple[slice, ...],
    ) -> int:
        """Evaluate one chunk of points; return how many outputs have no ordinary value."""
        try:
            block, run_block = self._free.pop()
        except IndexError:
            block = make_block(self._layout, self._chunk)
            run_block = on_block(sweep, block.numbers, compiled=self._compiled)
        shape = tuple(each.stop - each.start for each in part)
        count = math.prod(shape)
        block.points[0] = count
        for column, array in zip(block.columns, arrays.values(), strict=True):
            column[:count].reshape(shape)[...] = part_of(array, working, part)
        run_block()
        results[:, *part] = block.results[:, :count].reshape(-1, *shape)
        missing = int(block.numbers.view(np.int64)[MISSING])
        self._free.append((block, run_block))
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
        left = {name: np.broadcast_to(a, working)[where] for name, a in arrays.items()}
        found = infer_arrays(self.rulebase, left, held)
        for result, values in zip(results, found.values(), strict=True):
            result[where] = values


@remembered
def _compiled(rulebase: RuleBase) -> Compiled:
    """Return a rule base laid out for the kernel; the last few are remembered."""
    return Compiled(rulebase)


def infer_many(
    rulebase: RuleBase, given: Mapping[str, Any], held: Mapping[str, float] | None = None
) -> dict[str, Any]:
    """Evaluate arrays of inputs: by the kernel, or by NumPy where there is no machine code.

    It does not show which was taken.

    Raises
    ------
    InferenceError, NoRuleFiredError
        As :func:`fuzzyarm.infer`.
    """
    if has_machine_code():
        found: dict[str, Any] = _compiled(rulebase)(dict(given), held=held)
        return found
    return dict(infer_arrays(rulebase, given, held))


def infer_one(rulebase: RuleBase, given: Mapping[str, Any]) -> dict[str, float] | None:
    """Evaluate a point by the kernel; None where it does not cover it, or says what is wrong."""
    if not has_machine_code():
        return None
    return _compiled(rulebase).ordinary(given)


def compiled(rulebase: AnyRuleBase) -> Compiled:
    """Make a rule base ready to be evaluated fast.

    Parameters
    ----------
    rulebase : RuleBase
        Any model.

    Returns
    -------
    Compiled
        A callable with the inputs, results and errors of :func:`fuzzyarm.infer`; it can be
        pickled, and so goes to other processes. Machine
        code does the work where it covers the model, see its `kernel` and `reason`. The
        machine code is the same for all models: it is made once, and kept on disk.

    Raises
    ------
    InferenceError
        For a model that cannot be evaluated.

    Examples
    --------
    >>> import numpy as np
    >>> from fuzzyarm import compiled, load, shipped
    >>> fast = compiled(load(shipped("pd7.frb")))
    >>> fast(e=1.3, ce=-2.2)
    {'u': -1.0677966101694918}
    >>> fast.at(1.3, -2.2)
    (-1.0677966101694918,)
    >>> axis = np.linspace(-6.0, 6.0, 5)
    >>> fast(e=axis[:, None], ce=axis[None, :])["u"].shape
    (5, 5)
    """
    return Compiled(rulebase.model)
