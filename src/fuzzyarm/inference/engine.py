"""The callable that :func:`fuzzyarm.compiled` returns."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import partial
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.arrays import blocks, infer_arrays, part_of, working_shape
from fuzzyarm.inference.block import (
    COLUMNS,
    MISSING,
    POINTS,
    RESULTS,
    WIDTH,
    Layout,
    NotCoveredError,
    PointBlock,
    make_block,
)
from fuzzyarm.inference.errors import NotANumberError
from fuzzyarm.inference.kernel import (
    evaluate,
    sweep,
)
from fuzzyarm.inference.labelled import gathered
from fuzzyarm.inference.layout import lay_out
from fuzzyarm.inference.plan import plan
from fuzzyarm.inference.point import check_names, holds_arrays, number_of, prepare
from fuzzyarm.inference.prepared import remembered
from fuzzyarm.kernels import (
    bound_routine,
    has_machine_code,
    in_threads,
    point_routines,
    processors,
    sweep_routine,
)
from fuzzyarm.model.rulebase import AnyRuleBase, RuleBase, model_of

CHUNK = 8192
"""Points that go through the kernel together: their inputs and outputs stay in the cache."""

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


def on_block(
    function: Callable[[Any], None], block: NDArray[np.float64], *, compiled: bool
) -> Callable[[], None]:
    """Return the shortest call of a kernel on a block, which the caller keeps."""
    if not compiled:
        quiet = np.errstate(divide="ignore", invalid="ignore", over="ignore")
        return partial(quiet(function), block)
    # One point takes less time than to free the GIL and to wait for it again.
    return bound_routine(function, "f", (block,), brief=function is evaluate)


_ByName = Callable[[Any], "dict[str, float] | None"]
"""From the inputs at a point to the outputs; None where one is not a number, or has no value."""


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

    def __init__(self, rulebase: RuleBase) -> None:
        self.rulebase = rulebase
        self.kernel = "machine code" if has_machine_code() else "python"
        self.reason = ""
        self._names = tuple(variable.name for variable in rulebase.inputs)
        self._outputs = tuple(output.name for output in rulebase.outputs)
        self._engine: _Engine | None = None
        self._ordinary: _ByName = lambda _: None
        try:
            layout = lay_out(plan(rulebase), compiled=self.kernel == "machine code")
        except NotCoveredError as error:
            self.kernel, self.reason = "numpy", str(error)
        else:
            self._engine = _Engine(rulebase, layout, compiled=self.kernel == "machine code")
            self._ordinary = self._engine.named
            vars(self)["at"] = self._engine.at  # the shortest way: without a call in between

    def __reduce__(self) -> tuple[type[Compiled], tuple[RuleBase]]:
        # Another process lays its own numbers out.
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
        return _at_plainly(self.rulebase, *values)

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
        if not values and held is None:  # the thin path
            result = self._ordinary(named)
            if result is not None:
                return result
        columns, labels = gathered(self._mapping(values), named, self.rulebase.inputs)
        general = self._general(columns, held)
        return general if labels is None else labels.on(general)

    def _general(
        self, inputs: Mapping[str, Any], held: Mapping[str, float] | None
    ) -> dict[str, Any]:
        if self._engine is None or inputs.keys() != set(self._names):
            return self._plain(inputs, held)
        if held:
            check_names(held, self._outputs, what="output")
        if holds_arrays(inputs):
            return dict(self._engine.many(inputs, held))
        values = self.ordinary(inputs)
        return self._plain(inputs, held) if values is None else dict(values)

    def ordinary(self, inputs: Mapping[str, Any]) -> dict[str, float] | None:
        """Return the outputs at a point by the kernel; None where one is not ordinary."""
        if self._engine is None or inputs.keys() != set(self._names):
            return None
        try:
            return self._ordinary({name: number_of(name, inputs[name]) for name in self._names})
        except NotANumberError:
            return None  # the engine for a point says so

    def _plain(self, inputs: Mapping[str, Any], held: Mapping[str, float] | None) -> dict[str, Any]:
        """Evaluate without the kernel: what it does not cover, and what is wrong."""
        if holds_arrays(inputs):
            return dict(infer_arrays(self.rulebase, inputs, held))
        return dict(prepare(self.rulebase).evaluate(inputs, held))

    def _mapping(self, values: tuple[Any, ...]) -> Any:
        if len(values) == 1 and (values[0] is None or _is_by_name(values[0])):
            return values[0]
        return _by_name(self._names, values)


def _by_name(names: tuple[str, ...], values: tuple[Any, ...]) -> dict[str, Any]:
    if len(values) > len(names):
        raise TypeError(f"{len(values)} inputs are given, there are {len(names)}")
    return dict(zip(names, values, strict=False))


def _at_plainly(rulebase: RuleBase, *values: Any) -> tuple[float, ...]:
    """Evaluate one point without the kernel: what it does not cover, and what is wrong."""
    names = tuple(variable.name for variable in rulebase.inputs)
    return tuple(prepare(rulebase).evaluate(_by_name(names, values)).values())


def _is_plain(array: NDArray[Any], shape: tuple[int, ...]) -> bool:
    """Whether the machine code can read an array as it is."""
    return array.dtype == np.float64 and array.shape == shape and array.flags.c_contiguous


def _is_by_name(value: Any) -> bool:
    """Whether a value has inputs by name: a mapping, a DataFrame, a Dataset."""
    return isinstance(value, Mapping) or (hasattr(value, "columns") and hasattr(value, "index"))


class _Engine:
    """The kernel with the numbers of one rule base."""

    def __init__(self, rulebase: RuleBase, layout: Layout, *, compiled: bool) -> None:
        self.rulebase = rulebase
        self._layout = layout
        self._compiled = compiled
        length = min(POINTS_PER_PROGRAM * layout.programs, LONGEST_CHUNK)
        self._chunk = max(CHUNK, length)
        self._free: list[tuple[PointBlock, Callable[[], None]]] = []
        self._sweeps: list[Callable[[tuple[Any, ...], int, int], int]] = []
        self.at, self.named = self._point_functions(make_block(layout, 1))

    def _point_functions(
        self, block: PointBlock
    ) -> tuple[Callable[..., tuple[float, ...]], _ByName]:
        """Make the functions of one point, by position and by name."""
        inputs = tuple(variable.name for variable in self.rulebase.inputs)
        outputs = tuple(output.name for output in self.rulebase.outputs)
        otherwise = partial(_at_plainly, self.rulebase)
        if self._compiled:
            whole = block.numbers.view(np.int64)
            x, y = int(whole[COLUMNS]), int(whole[RESULTS])
            with suppress(ValueError):  # more inputs than the machine code of a point has room for
                return point_routines(evaluate, block.numbers, (x, inputs), (y, outputs), otherwise)
        run_block = on_block(evaluate, block.numbers, compiled=self._compiled)
        turn = Lock()

        def ordinary(values: Iterable[Any]) -> list[float] | None:
            with turn:  # there is one block
                try:
                    block.columns[:, 0] = [float(value) for value in values]
                except (TypeError, ValueError, OverflowError):
                    return None
                run_block()
                results: list[float] = block.results[:, 0].tolist()
            return None if any(map(math.isnan, results)) else results

        def at(*values: Any) -> tuple[float, ...]:
            results = ordinary(values) if len(values) == len(inputs) else None
            return otherwise(*values) if results is None else tuple(results)

        def named(arguments: Mapping[str, Any]) -> dict[str, float] | None:
            if arguments.keys() != set(inputs):
                return None
            values = [arguments[name] for name in inputs]
            plain = all(isinstance(value, int | float) for value in values)
            results = ordinary(values) if plain else None
            return None if results is None else dict(zip(outputs, results, strict=True))

        return at, named

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

        def fill(starts: Iterator[int]) -> int:
            try:
                sweep_arrays = self._sweeps.pop()
            except IndexError:
                sweep_arrays = self._sweeper()
            missing = sum(sweep_arrays(arrays, at, min(at + share, size)) for at in starts)
            self._sweeps.append(sweep_arrays)
            return missing

        return sum(in_threads(fill, range(0, size, share), workers))

    def _sweeper(self) -> Callable[[tuple[Any, ...], int, int], int]:
        numbers = make_block(self._layout, self._chunk).numbers
        whole = numbers.view(np.int64)
        inputs, outputs = len(self.rulebase.inputs), len(self.rulebase.outputs)
        return sweep_routine(
            sweep,
            numbers,
            (self._chunk, int(whole[WIDTH])),
            (inputs, int(whole[COLUMNS])),
            (outputs, int(whole[RESULTS])),
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
        try:
            block, run_block = self._free.pop()
        except IndexError:
            block = make_block(self._layout, self._chunk)
            run_block = on_block(sweep, block.numbers, compiled=self._compiled)
        shape = tuple(extent.stop - extent.start for extent in part)
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
        remaining = {name: np.broadcast_to(a, working)[where] for name, a in arrays.items()}
        outputs = infer_arrays(self.rulebase, remaining, held)
        for result, values in zip(results, outputs.values(), strict=True):
            result[where] = values


@remembered
def _compiled(rulebase: RuleBase) -> Compiled:
    """Return a rule base laid out for the kernel; the last few are remembered."""
    return Compiled(rulebase)


def infer_many(
    rulebase: RuleBase, inputs: Mapping[str, Any], held: Mapping[str, float] | None = None
) -> dict[str, Any]:
    """Evaluate arrays of inputs: by the kernel, or by NumPy where there is no machine code.

    It does not show which was taken.
    """
    if has_machine_code():
        outputs: dict[str, Any] = _compiled(rulebase)(dict(inputs), held=held)
        return outputs
    return dict(infer_arrays(rulebase, inputs, held))


def infer_one(rulebase: RuleBase, inputs: Mapping[str, Any]) -> dict[str, float] | None:
    """Evaluate a point by the kernel; None where it does not cover it, or says what is wrong."""
    if not has_machine_code():
        return None
    return _compiled(rulebase).ordinary(inputs)


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
        code does the work where it covers the model, see its `kernel` and `reason`.

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
    return Compiled(model_of(rulebase))
