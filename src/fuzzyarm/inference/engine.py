"""The kernel with the numbers of a rule base: the result of :func:`fuzzyarm.compiled`.

A rule base has a kernel for each of its stages (:mod:`.stages`), nearly always one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import ref

from fuzzyarm.inference.block import NotCoveredError
from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.inputs import bring_into_range, check_names, floats_of, holds_arrays
from fuzzyarm.inference.labelled import gathered
from fuzzyarm.inference.prepared import remembered
from fuzzyarm.inference.stage import Fallbacks, PointFunctions, Stage
from fuzzyarm.inference.stages import stages
from fuzzyarm.language.model.rulebase import AnyRuleBase, RuleBase, model_of
from fuzzyarm.symbolic.kernels import has_machine_code

if TYPE_CHECKING:
    from fuzzyarm.inference.sweeps import StagedSweeps


class Outcome(NamedTuple):
    """The outputs at a point, with or without a value of their own.

    Attributes
    ----------
    values : dict of str to float
        Inputs clamped to their ranges, and outputs.
    without_value : frozenset of str
        Outputs without a value of their own: no rule fires, or a formula is undefined.
    """

    values: dict[str, float]
    without_value: frozenset[str]


class Compiled:
    """A rule base ready to be evaluated fast; call it like :func:`fuzzyarm.infer`.

    A call takes the inputs in their order, or by name: floats, arrays that broadcast against each
    other, Series, DataArrays, or all of them in one mapping, DataFrame or Dataset; and `held`, the
    last values of outputs that hold where no rule fires. Results and errors are those of
    :func:`fuzzyarm.infer`.

    Parameters
    ----------
    rulebase : RuleBase
        Any model.
    interpreted : bool
        Whether to interpret the kernel, without machine code.

    Attributes
    ----------
    rulebase : RuleBase
        As given.
    kernel : str
        ``"machine code"``, or ``"python"``: the source of the kernel, interpreted.
    reason : str
        The part that machine code does not cover; empty if it covers everything.

    Raises
    ------
    InferenceError
        For a rule base that cannot be evaluated.
    """

    # Python finds the call on the instance: at a point it is machine code, without a frame.
    __slots__ = ("__call__", "__dict__", "__weakref__")

    if TYPE_CHECKING:

        def __call__(
            self, *values: Any, held: Mapping[str, float] | None = None, **named: Any
        ) -> Any:
            """Evaluate the rule base; see the class."""

    def __init__(self, rulebase: RuleBase, *, interpreted: bool = False) -> None:
        self.rulebase = rulebase
        self._interpreted = interpreted
        self._inputs = tuple(variable.name for variable in rulebase.inputs)
        self._outputs = tuple(output.name for output in rulebase.outputs)
        try:
            engine = partial(_engine, ref(self), rulebase)
            otherwise = Fallbacks(partial(_at, engine), partial(_call, engine))
            machine_code = not interpreted and has_machine_code()
            self._stages = [
                Stage(stage, len(self._inputs), otherwise, machine_code=machine_code)
                for stage in (stages(rulebase) if rulebase.outputs else ())
            ]
        except NotCoveredError as error:
            raise InferenceError(f"cannot evaluate {error}") from None
        self.reason = next((stage.reason for stage in self._stages if stage.reason), "")
        machine = all(stage.compiled for stage in self._stages)
        self.kernel = "machine code" if machine else "python"
        at, self.named_point, call = PointFunctions(self.at, self._named, otherwise.call)
        if len(self._stages) == 1:  # the fast path: no call in between
            at, self.named_point, call = self._stages[0].functions
            vars(self)["at"] = at
        type(self).__call__.__set__(self, call)  # type: ignore[attr-defined]

    def __reduce__(self) -> tuple[Any, ...]:
        # Another process lays its own numbers out.
        return partial(Compiled, interpreted=self._interpreted), (self.rulebase,)

    def __repr__(self) -> str:
        why = f": {self.reason}" if self.reason else ""
        return f"<compiled {self.rulebase.name!r}, kernel {self.kernel}{why}>"

    def at(self, *values: float) -> tuple[float, ...]:
        """Evaluate one point, on the fast path.

        Parameters
        ----------
        *values : float
            The inputs in their order.

        Returns
        -------
        tuple of float
            The outputs in their order.
        """
        return tuple(self.point(_by_name(self._inputs, values)).values())

    def general(self, *values: Any, held: Mapping[str, float] | None = None, **named: Any) -> Any:
        """Evaluate the rule base at arguments of any kind."""
        columns, labels = gathered(self._mapping(values), named, self.rulebase.inputs)
        results = self.evaluate(columns, held)
        return results if labels is None else labels.on(results)

    def _mapping(self, values: tuple[Any, ...]) -> Any:
        if len(values) == 1 and (values[0] is None or _is_by_name(values[0])):
            return values[0]
        return _by_name(self._inputs, values)

    def evaluate(
        self, inputs: Mapping[str, Any], held: Mapping[str, float] | None = None
    ) -> dict[str, Any]:
        """Return the outputs at a point, or over arrays, without labels."""
        if not holds_arrays(inputs):
            return self.point(inputs, held)
        if held:
            check_names(held, self._outputs, what="output")
        return dict(self._sweeps.many(inputs, held or {}))

    @cached_property
    def _sweeps(self) -> StagedSweeps:
        """The kernel over arrays."""
        from fuzzyarm.inference.sweeps import StagedSweeps

        return StagedSweeps(self.rulebase, self._stages)

    def point(
        self, inputs: Mapping[str, Any], held: Mapping[str, float] | None = None
    ) -> dict[str, float]:
        """Return the outputs at a point."""
        values = floats_of(self.rulebase, inputs)
        if held:
            check_names(held, self._outputs, what="output")
        outputs = self.named_point(values)
        if outputs is not None:
            return outputs
        all_values = self.outcome(values, held).values
        return {name: all_values[name] for name in self._outputs}

    def _named(self, arguments: Mapping[str, Any]) -> dict[str, float] | None:
        """Return the outputs at named inputs; None unless all are ordinary."""
        if arguments.keys() != set(self._inputs):
            return None
        values = dict(arguments)
        for stage in self._stages:
            outputs = stage.functions.named({name: values[name] for name in stage.inputs})
            if outputs is None:
                return None
            values |= outputs
        return {name: values[name] for name in self._outputs}

    def outcome(
        self, inputs: Mapping[str, Any], held: Mapping[str, float] | None = None
    ) -> Outcome:
        """Return the outputs at a point, and the names of those without a value of their own."""
        given = floats_of(self.rulebase, inputs)
        values = {v.name: bring_into_range(v, given[v.name]) for v in self.rulebase.inputs}
        if held:
            check_names(held, self._outputs, what="output")
        without_value = set[str]()
        for stage in self._stages:
            without_value |= stage.complete(values, held or {})
        return Outcome(values, frozenset(without_value))


def _by_name(names: tuple[str, ...], values: tuple[Any, ...]) -> dict[str, Any]:
    if len(values) > len(names):
        raise TypeError(f"{len(values)} inputs are given, there are {len(names)}")
    return dict(zip(names, values, strict=False))


def _is_by_name(value: Any) -> bool:
    """Whether a value has inputs by name: a mapping, a DataFrame, a Dataset."""
    return isinstance(value, Mapping) or (hasattr(value, "columns") and hasattr(value, "index"))


@remembered
def cached_engine(rulebase: RuleBase) -> Compiled:
    """Return a rule base laid out for the kernel; the last few are cached."""
    return Compiled(rulebase)


def _engine(engine: ref[Compiled], rulebase: RuleBase) -> Compiled:
    """Return an engine, or one like it when `at` outlives it."""
    return engine() or cached_engine(rulebase)


def _at(engine: Callable[[], Compiled], *values: Any) -> tuple[float, ...]:
    """Evaluate an extraordinary point."""
    return Compiled.at(engine(), *values)


def _call(engine: Callable[[], Compiled], *values: Any, **named: Any) -> Any:
    """Evaluate arguments of any kind."""
    return engine().general(*values, **named)


def compiled(rulebase: AnyRuleBase) -> Compiled:
    """Make a rule base ready to be evaluated fast.

    Parameters
    ----------
    rulebase : RuleBase
        Any model.

    Returns
    -------
    Compiled
        A callable with the inputs, results and errors of :func:`fuzzyarm.infer`; it can be pickled
        for other processes. Machine code does the work where it covers the model, see its `kernel`
        and `reason`.

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
