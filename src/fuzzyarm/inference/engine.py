"""The kernel with the numbers of a rule base: what :func:`fuzzyarm.compiled` returns."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

from fuzzyarm.inference.block import NotCoveredError, PointBlock, make_block
from fuzzyarm.inference.errors import NotANumberError
from fuzzyarm.inference.kernel import evaluate
from fuzzyarm.inference.labelled import gathered
from fuzzyarm.inference.layout import lay_out
from fuzzyarm.inference.plan import plan
from fuzzyarm.inference.point import check_names, holds_arrays, number_of, prepare
from fuzzyarm.inference.prepared import remembered
from fuzzyarm.inference.stages import stages
from fuzzyarm.language.model.rulebase import AnyRuleBase, RuleBase, model_of
from fuzzyarm.symbolic.kernels import bound_routine, has_machine_code, lock, point_routines

if TYPE_CHECKING:
    from fuzzyarm.inference.block import Layout
    from fuzzyarm.inference.sweeps import StagedSweeps, Sweeps

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
        self._engine: _Engine | _StagedEngine | None = None
        self.named_point: _ByName = lambda _: None
        try:
            engines = [_engine_of(stage, compiled=has_machine_code()) for stage in stages(rulebase)]
        except NotCoveredError as error:
            self.kernel, self.reason = "numpy", str(error)
        else:
            self._engine = engines[0] if len(engines) == 1 else _StagedEngine(rulebase, engines)
            self.named_point = self._engine.named
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
            result = self.named_point(named)
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
            return dict(self._engine.sweeps.many(inputs, held))
        values = self.ordinary(inputs)
        return self._plain(inputs, held) if values is None else dict(values)

    def ordinary(self, inputs: Mapping[str, Any]) -> dict[str, float] | None:
        """Return the outputs at a point by the kernel; None where one is not ordinary."""
        if self._engine is None or inputs.keys() != set(self._names):
            return None
        try:
            return self.named_point({name: number_of(name, inputs[name]) for name in self._names})
        except NotANumberError:
            return None  # the engine for a point says so

    def _plain(self, inputs: Mapping[str, Any], held: Mapping[str, float] | None) -> dict[str, Any]:
        """Evaluate without the kernel: what it does not cover, and what is wrong."""
        if holds_arrays(inputs):
            from fuzzyarm.inference.arrays import infer_arrays

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


def _is_by_name(value: Any) -> bool:
    """Whether a value has inputs by name: a mapping, a DataFrame, a Dataset."""
    return isinstance(value, Mapping) or (hasattr(value, "columns") and hasattr(value, "index"))


class _Engine:
    """The kernel with the numbers of one rule base."""

    def __init__(self, rulebase: RuleBase, layout: Layout, *, compiled: bool) -> None:
        self.rulebase = rulebase
        self._layout = layout
        self._compiled = compiled
        self.at, self.named = self._point_functions(make_block(layout, 1))

    @cached_property
    def sweeps(self) -> Sweeps:
        """The kernel over arrays."""
        from fuzzyarm.inference.sweeps import Sweeps

        return Sweeps(self.rulebase, self._layout, compiled=self._compiled)

    def _point_functions(
        self, block: PointBlock
    ) -> tuple[Callable[..., tuple[float, ...]], _ByName]:
        """Make the functions of one point, by position and by name."""
        inputs = tuple(variable.name for variable in self.rulebase.inputs)
        outputs = tuple(output.name for output in self.rulebase.outputs)
        otherwise = partial(_at_plainly, self.rulebase)
        if self._compiled:
            places = (block.columns, inputs), (block.results, outputs)
            with suppress(ValueError):  # more inputs than the machine code of a point has room for
                return point_routines(evaluate, block.numbers, *places, otherwise)
        columns = block.numbers[block.columns : block.columns + len(inputs)]
        results = block.numbers[block.results : block.results + len(outputs)]
        run = self._on(block)
        turn = lock()

        def ordinary(values: Iterable[Any]) -> list[float] | None:
            with turn:  # there is one block
                try:
                    for column, value in enumerate(values):
                        columns[column] = float(value)
                    run()
                except (TypeError, ValueError, ArithmeticError):  # no number, or none comes out
                    return None
                found = list(results)
            return None if any(map(math.isnan, found)) else found

        def at(*values: Any) -> tuple[float, ...]:
            found = ordinary(values) if len(values) == len(inputs) else None
            return otherwise(*values) if found is None else tuple(found)

        def named(arguments: Mapping[str, Any]) -> dict[str, float] | None:
            if arguments.keys() != set(inputs):
                return None
            values = [arguments[name] for name in inputs]
            plain = all(isinstance(value, int | float) for value in values)
            found = ordinary(values) if plain else None
            return None if found is None else dict(zip(outputs, found, strict=True))

        return at, named

    def _on(self, block: PointBlock) -> Callable[[], None]:
        """Return the shortest call of the kernel on a block with room for one point."""
        if self._compiled:
            # One point takes less time than to free the GIL and to wait for it again.
            return bound_routine(evaluate, "f", (block.numbers,), brief=True)
        return partial(evaluate, block.numbers)


def _engine_of(rulebase: RuleBase, *, compiled: bool) -> _Engine:
    return _Engine(rulebase, lay_out(plan(rulebase), compiled=compiled), compiled=compiled)


class _StagedEngine:
    """The kernel with the numbers of each stage of one rule base; see :mod:`.stages`."""

    def __init__(self, rulebase: RuleBase, engines: Sequence[_Engine]) -> None:
        self.rulebase = rulebase
        self._inputs = tuple(variable.name for variable in rulebase.inputs)
        self._outputs = tuple(output.name for output in rulebase.outputs)
        self._parts = [
            (engine.named, tuple(variable.name for variable in engine.rulebase.inputs))
            for engine in engines
        ]
        self._engines = engines

    @cached_property
    def sweeps(self) -> StagedSweeps:
        """The kernel over arrays."""
        from fuzzyarm.inference.sweeps import StagedSweeps

        return StagedSweeps(self.rulebase, [engine.sweeps for engine in self._engines])

    def named(self, arguments: Mapping[str, Any]) -> dict[str, float] | None:
        """Return the outputs at inputs by name; None for what is not ordinary."""
        if arguments.keys() != set(self._inputs):
            return None
        values = dict(arguments)
        for part, names in self._parts:
            found = part({name: values[name] for name in names})
            if found is None:
                return None
            values |= found
        return {name: values[name] for name in self._outputs}

    def at(self, *values: Any) -> tuple[float, ...]:
        """Return the outputs at inputs in their order."""
        found = None
        if len(values) == len(self._inputs):
            found = self.named(dict(zip(self._inputs, values, strict=True)))
        return _at_plainly(self.rulebase, *values) if found is None else tuple(found.values())


@remembered
def kept(rulebase: RuleBase) -> Compiled:
    """Return a rule base laid out for the kernel; the last few are remembered."""
    return Compiled(rulebase)


def infer_many(
    rulebase: RuleBase, inputs: Mapping[str, Any], held: Mapping[str, float] | None = None
) -> dict[str, Any]:
    """Evaluate arrays of inputs: by the kernel, or by NumPy where there is no machine code.

    It does not show which was taken.
    """
    if has_machine_code():
        outputs: dict[str, Any] = kept(rulebase)(dict(inputs), held=held)
        return outputs
    from fuzzyarm.inference.arrays import infer_arrays

    return dict(infer_arrays(rulebase, inputs, held))


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
