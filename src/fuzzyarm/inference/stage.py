"""The kernel with the numbers of one stage of a rule base, at a point.

At an ordinary point the kernel alone computes the outputs. It writes NaN for an output without a
value, outside a range that forbids it, or without a firing rule; only then is the cause sought, and
the held value, or an error with the name of the output, takes its place.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from fuzzyarm.inference import block as at
from fuzzyarm.inference.block import NotCoveredError, PointBlock, make_block
from fuzzyarm.inference.errors import NoRuleFiredError, NotANumberError
from fuzzyarm.inference.inputs import bring_into_range, held_value, replaces_nan
from fuzzyarm.inference.kernel import bindings_for, evaluate
from fuzzyarm.inference.layout import lay_out
from fuzzyarm.inference.plan import plan
from fuzzyarm.inference.stages import without_values
from fuzzyarm.language.model.rulebase import Output, RuleBase
from fuzzyarm.symbolic.kernels import bound_routine, lock, point_functions

if TYPE_CHECKING:
    from fuzzyarm.inference.block import Layout

LARGEST = sys.float_info.max


class PointFunctions(NamedTuple):
    """Evaluators of one point."""

    at: Callable[..., tuple[float, ...]]  # from the inputs by position to a tuple of the outputs
    # From a dictionary to a dictionary; None for an extraordinary point: an input that is not a
    # float or int, an output without a value.
    named: Callable[[Any], dict[str, float] | None]
    # From arguments, by position or by name, to a dictionary of the outputs.
    call: Callable[..., Any]


class Fallbacks(NamedTuple):
    """Evaluators of an extraordinary point, or of arguments of any kind."""

    at: Callable[..., tuple[float, ...]]
    call: Callable[..., Any]


class Stage:
    """The kernel with the numbers of one stage of a rule base; see :mod:`.stages`.

    Parameters
    ----------
    rulebase : RuleBase
        The stage.
    own : int
        Number of its inputs, the first, that are inputs of the whole; the rest are earlier outputs.
    otherwise : Fallbacks
        What `at` and `call` of its functions give way to.
    machine_code : bool
        Whether to use machine code where available.

    Attributes
    ----------
    functions : PointFunctions
        The evaluators of one point.
    inputs : tuple of str
        Names.
    layout : Layout
        The numbers.
    compiled : bool
        Whether machine code reads them.
    reason : str
        The part that machine code does not cover, if the kernel is interpreted.
    found : callable
        Of the interpreted kernel: from the inputs in their order to the outputs, NaN without a
        value; None for inputs that are not numbers.
    """

    found: Callable[[Iterable[Any]], list[float] | None]

    def __init__(
        self,
        rulebase: RuleBase,
        own: int,
        otherwise: Fallbacks,
        *,
        machine_code: bool,
    ) -> None:
        self.rulebase = rulebase
        self.inputs = tuple(variable.name for variable in rulebase.inputs)
        self._own, self._otherwise = own, otherwise
        self._outputs = tuple(output.name for output in rulebase.outputs)
        self._without: dict[tuple[str, ...], Stage] = {}
        self.layout, self.compiled, self.reason = _laid_out(rulebase, machine_code=machine_code)
        self.functions = self._point_functions(make_block(self.layout, 1))

    def _point_functions(self, block: PointBlock) -> PointFunctions:
        inputs, outputs = self.inputs, self._outputs
        otherwise = self._otherwise
        if self.compiled:
            places = (block.columns, inputs), (block.results, outputs)
            with suppress(ValueError):  # more inputs than machine code of a point accepts
                bindings = bindings_for(block.numbers)
                return PointFunctions(
                    *point_functions(evaluate, bindings, block.numbers, *places, *otherwise)
                )
        columns = block.numbers[block.columns : block.columns + len(inputs)]
        results = block.numbers[block.results : block.results + len(outputs)]
        run = runner(block, compiled=self.compiled)
        turn = lock()

        def evaluated(values: Iterable[Any]) -> list[float] | None:
            with turn:  # one block for all threads
                try:
                    for column, value in enumerate(values):
                        columns[column] = float(value)
                except (TypeError, ValueError, OverflowError):  # not a number
                    return None
                run()
                return list(results)

        self.found = evaluated

        def ordinary(values: Iterable[Any]) -> list[float] | None:
            found = evaluated(values)
            return None if found is None or any(map(math.isnan, found)) else found

        def at(*values: Any) -> tuple[float, ...]:
            # `float` reads text, which is not a number here either.
            plain = len(values) == len(inputs) and not any(isinstance(x, str) for x in values)
            found = ordinary(values) if plain else None
            return otherwise.at(*values) if found is None else tuple(found)

        def named(arguments: Mapping[str, Any]) -> dict[str, float] | None:
            if arguments.keys() != set(inputs):
                return None
            values = [arguments[name] for name in inputs]
            plain = all(isinstance(value, int | float) for value in values)
            found = ordinary(values) if plain else None
            return None if found is None else dict(zip(outputs, found, strict=True))

        return PointFunctions(at, named, otherwise.call)

    def without(self, missing: tuple[str, ...]) -> Stage:
        """Return the stage where the earlier outputs in `missing` have no value; itself if none."""
        if not missing:
            return self
        if missing not in self._without:
            self._without[missing] = Stage(
                without_values(self.rulebase, missing),
                self._own,
                self._otherwise,
                machine_code=self.compiled,
            )
        return self._without[missing]

    def complete(self, values: dict[str, float], held: Mapping[str, float]) -> set[str]:
        """Add the outputs to the values of a point; return those without a value of their own.

        Raises
        ------
        InferenceError, NoRuleFiredError
            For an output without a value, or with a forbidden one.
        """
        missing = tuple(name for name in self.inputs if math.isnan(values[name]))
        columns = [0.0 if name in missing else values[name] for name in self.inputs]
        without_value = set[str]()
        outputs = self.rulebase.outputs
        for output, found in zip(outputs, self.without(missing)._judge.found(columns), strict=True):
            value = found
            if found is not None and math.isnan(found):
                if not replaces_nan(output):
                    where = ", ".join(f"{n} = {x:.6g}" for n, x in self.point_of(values).items())
                    raise NotANumberError(output.name, f"has none at {where}")
                value = None
            if value is None:
                without_value.add(output.name)
                values[output.name] = self._value_for_no_rule(output, values, held)
            else:
                values[output.name] = bring_into_range(output, value)
        return without_value

    def _value_for_no_rule(
        self, output: Output, values: Mapping[str, float], held: Mapping[str, float]
    ) -> float:
        """Return the value that an output states for no rule."""
        if output.no_rule == "hold":
            return held_value(output, held)
        if isinstance(output.no_rule, str):
            raise NoRuleFiredError(output.name, self.point_of(values))
        return float(output.no_rule)

    def point_of(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return the inputs of the whole rule base, for an error."""
        return {name: values[name] for name in self.inputs[: self._own]}

    @cached_property
    def _judge(self) -> _Judge:
        return _Judge(self)


def _laid_out(rulebase: RuleBase, *, machine_code: bool) -> tuple[Layout, bool, str]:
    """Return the layout of a rule base, whether machine code reads it, and why not."""
    laid = plan(rulebase)
    reason = ""
    if machine_code:
        try:
            return lay_out(laid, compiled=True), True, ""
        except NotCoveredError as error:
            reason = str(error)
    return lay_out(laid, plain=True), False, reason


def runner(block: PointBlock, *, compiled: bool) -> Callable[[], None]:
    """Return the fastest call of the kernel on a block with room for one point."""
    if compiled:
        # One point takes less time than releasing and reacquiring the GIL.
        return bound_routine(evaluate, "f", (block.numbers,), brief=True)

    def run() -> None:
        try:
            evaluate(block.numbers)
        except (ArithmeticError, ValueError):  # Python raises where machine code has NaN
            import numpy as np

            with np.errstate(all="ignore"):
                evaluate(np.asarray(block.numbers))

    return run


class _Judge:
    """The cause of a NaN of the kernel at a point, found with a block of its own."""

    def __init__(self, stage: Stage) -> None:
        self._block = make_block(stage.layout, 1)
        self._run = runner(self._block, compiled=stage.compiled)
        self._turn = lock()
        self._outputs = stage.rulebase.outputs

    def found(self, columns: Sequence[float]) -> list[float | None]:
        """Return the unclamped outputs: None where no rule fires, NaN without a value."""
        with self._turn:
            found: list[float | None] = [*self._evaluated(columns, at.EXTEND, math.nan)]
            if not any(math.isnan(value) for value in found if value is not None):
                return found
            clamped = self._evaluated(columns, at.CLAMP, math.nan)
            zeros = self._evaluated(columns, at.CLAMP, 0.0)
        for o, output in enumerate(self._outputs):
            if math.isnan(found[o] or 0.0):
                if not math.isnan(clamped[o]):  # infinite, clamped to an end of the range
                    found[o] = math.inf if clamped[o] >= output.high else -math.inf
                elif not math.isnan(zeros[o]):
                    found[o] = None
        return found

    def _evaluated(self, columns: Sequence[float], mode: int, no_rule: float) -> list[float]:
        """Run the kernel with other settings for outside values and for no rule."""
        numbers, k = self._block.numbers, self._block.whole
        for o in range(len(self._outputs)):
            head = k[at.OUTPUTS_AT] + at.OUTPUT_HEAD * o
            k[head + at.OUT_MODE] = mode
            bounds = k[at.FLOATS] + k[head + at.FLOATS_AT]
            for end in (bounds, bounds + 1):
                numbers[end] = min(max(numbers[end], -LARGEST), LARGEST)
            numbers[bounds + 2] = no_rule
        for column, value in enumerate(columns, self._block.columns):
            numbers[column] = min(max(value, -LARGEST), LARGEST)  # infinity is in no cell
        self._run()
        return list(numbers[self._block.results : self._block.results + len(self._outputs)])
