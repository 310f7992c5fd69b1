"""The engine for arrays: NumPy, no loop over points or samples.

The result is filled chunk by chunk; an input that is an axis of a grid keeps its own
small shape, so its memberships cost next to nothing. Terms that are zero all over a chunk
take their rules with them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.inference.aggregate_arrays import Strengths
from fuzzyarm.inference.defuzzify import defuzzify_over_arrays
from fuzzyarm.inference.errors import (
    MissingInputError,
    NoRuleFiredError,
    NotANumberError,
    NothingHeldError,
    OutsideRangeError,
)
from fuzzyarm.inference.plan import OutputPlan, Plan, PlannedRule, plan
from fuzzyarm.inference.point import check_names, stands_in_for_nan
from fuzzyarm.inference.sets import degrees as degrees_in
from fuzzyarm.inference.sets import hedged
from fuzzyarm.language.model.rulebase import (
    And,
    Expression,
    Hedge,
    Hedged,
    Is,
    Output,
    RuleBase,
    Variable,
)
from fuzzyarm.symbolic.kinds import SNORMS, TNORMS

# --- Cut the shape of a result into blocks that stay in the processor's cache ---

Block = tuple[slice, ...]


def blocks(shape: tuple[int, ...], most: int) -> Iterator[Block]:
    """Yield slices that cover an array of `shape`, each of at most `most` elements.

    Parameters
    ----------
    shape : tuple of int
        Of the whole; an empty one yields one empty block.
    most : int
        Elements, at least 1.

    Yields
    ------
    tuple of slice
        One for each axis, in the order of memory.
    """
    if prod(shape) <= most:
        yield tuple(slice(0, n) for n in shape)
        return
    inner = prod(shape[1:])
    rows = most // inner
    if rows >= 1:
        for start in range(0, shape[0], rows):
            rest = tuple(slice(0, n) for n in shape[1:])
            yield (slice(start, min(start + rows, shape[0])), *rest)
        return
    for row in range(shape[0]):
        for block in blocks(shape[1:], most):
            yield (slice(row, row + 1), *block)


# --- The engine for arrays: NumPy, no loop over points or samples ---

Array = NDArray[np.float64]

CHUNK = 16_384
"""Points evaluated together where nothing is sampled."""

SAMPLES_AT_ONCE = 1 << 19
"""Points times samples evaluated together where an output is sampled."""


def infer_arrays(
    rulebase: RuleBase,
    inputs: Mapping[str, Any],
    held: Mapping[str, float] | None = None,
) -> dict[str, Array]:
    """Evaluate a rule base at many points.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    inputs : mapping of str to array_like
        A value for every input; the arrays broadcast against each other.
    held : mapping of str to float, optional
        Last values of outputs that hold where no rule fires.

    Returns
    -------
    dict of str to ndarray of float64
        Every output, of the broadcast shape.

    Raises
    ------
    InferenceError
        For names that are unknown or missing, and values that are not numbers.
    NoRuleFiredError
        If no rule fires at some point for an output that has no value for that case.
    """
    prepared = plan(rulebase)
    arrays = _checked(rulebase, inputs)
    if held:
        check_names(held, prepared.outputs, what="output")
    shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    working = working_shape(arrays, shape)
    results = {name: np.empty(working) for name in prepared.outputs}
    if results and int(np.prod(working)):
        shared: Degrees = {}
        for block in blocks(working, _chunk_size(prepared)):
            chunk = _Chunk(prepared, arrays, working, block, held or {}, shared)
            for name, value in chunk.outputs().items():
                results[name][block] = value
    return {name: result.reshape(shape) for name, result in results.items()}


def firing_strengths(
    rulebase: RuleBase, inputs: Mapping[str, Any]
) -> tuple[Array, dict[str, Array]]:
    """Return how far every rule fires at many points, and the outputs there.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    inputs : mapping of str to array_like
        A value for every input; the arrays broadcast against each other.

    Returns
    -------
    strengths : ndarray of float64, shape (rules, *points)
        Truth of the antecedent times the weight, in the order of ``rulebase.rules``; the upper
        strength where it is of interval type 2.
    outputs : dict of str to ndarray of float64
        NaN where no rule fires, whatever the file says for that case.

    Raises
    ------
    InferenceError
        For names that are unknown or missing, and values that are not numbers.
    """
    silent = tuple(replace(output, no_rule=float("nan")) for output in rulebase.outputs)
    prepared = plan(replace(rulebase, outputs=silent))
    arrays = _checked(rulebase, inputs)
    shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    working = working_shape(arrays, shape)
    strengths = np.zeros((len(prepared.rules), *working))
    results = {name: np.empty(working) for name in prepared.outputs}
    if int(np.prod(working)):
        shared: Degrees = {}
        for block in blocks(working, _chunk_size(prepared)):
            chunk = _Chunk(prepared, arrays, working, block, {}, shared)
            for name, value in chunk.outputs(strengths[:, *block]).items():
                results[name][block] = value
    outputs = {name: result.reshape(shape) for name, result in results.items()}
    if rulebase.is_type2:
        strengths = strengths[[rows[0] for rows in prepared.readings]]
    return strengths.reshape(-1, *shape), outputs


def working_shape(arrays: dict[str, NDArray[Any]], shape: tuple[int, ...]) -> tuple[int, ...]:
    """Bring arrays to the number of axes of what they broadcast to, to one if that is enough.

    Returns
    -------
    tuple of int
        The shape to go through; `arrays` is changed to fit it.
    """
    size = int(np.prod(shape))
    # All are one number, or one for each point: a single axis will do. Else the axes stay, so that
    # an input along one of them keeps its own small shape.
    flat = all(array.size in {1, size} for array in arrays.values())
    for name, array in arrays.items():
        filled = (1,) * (len(shape) - array.ndim) + array.shape
        arrays[name] = array.reshape(-1 if flat else filled)
    return (size,) if flat else shape


def _checked(rulebase: RuleBase, inputs: Mapping[str, Any]) -> dict[str, Array]:
    names = [variable.name for variable in rulebase.inputs]
    check_names(inputs, names)
    missing = [name for name in names if name not in inputs]
    if missing:
        raise MissingInputError(missing)
    arrays = {}
    for variable in rulebase.inputs:
        array = _numbers(variable.name, inputs[variable.name])
        if np.isnan(array).any():
            raise NotANumberError(variable.name)
        arrays[variable.name] = _into_range(variable, array)
    try:
        np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise NotANumberError(names[0], f"does not fit the others: {shapes}") from None
    return arrays


def _numbers(name: str, values: Any) -> Array:
    """Return an input as floats; text is not a number, even of digits."""
    try:
        array = np.asarray(values)
        texts = array.dtype.kind == "O" and any(isinstance(x, str | bytes) for x in array.flat)
        if array.dtype.kind in "fiubO" and not texts:
            return array.astype(float, copy=False)
    except (TypeError, ValueError, OverflowError):
        pass
    kind = type(values).__name__
    raise NotANumberError(name, f"is not an array of numbers: {kind}")


def _into_range(variable: Variable, array: Array) -> Array:
    """Return `array` as `variable.outside` says: clamped, as it is, or an error."""
    if variable.outside == "clamp":
        return np.clip(array, variable.low, variable.high)
    outside = (array < variable.low) | (array > variable.high)
    if variable.outside == "error":
        if outside.any():
            worst = float(array[outside].flat[0])
            raise OutsideRangeError(variable.name, worst, variable.low, variable.high)
    elif np.isinf(array).any():
        raise NotANumberError(variable.name, "is infinite")
    return array


def _chunk_size(prepared: Plan) -> int:
    size = CHUNK
    for output in prepared.outputs.values():
        if output.discrete or output.closed is not None:
            continue
        resolution = output.output.defuzzifier.resolution
        # An adaptive integral looks at hundreds of positions, too.
        samples = resolution if resolution is not None else 512
        size = min(size, max(1, SAMPLES_AT_ONCE // samples))
    return size


Degrees = dict[tuple[str, str, tuple[Hedge, ...]], Array | None]
"""Memberships by variable, term and hedges; None where a term is 0 all over."""


class _Chunk:
    """One block of points on its way through the steps of a plan.

    `shared` goes from chunk to chunk: memberships of inputs of which every chunk needs
    the whole (the inner axis of a grid).
    """

    def __init__(
        self,
        prepared: Plan,
        arrays: Mapping[str, Array],
        working: tuple[int, ...],
        block: Block,
        held: Mapping[str, float],
        shared: Degrees,
    ) -> None:
        self.plan = prepared
        self.shape = tuple(part.stop - part.start for part in block)
        self.held = held
        self.values = {name: part_of(array, working, block) for name, array in arrays.items()}
        # Inputs of which this block has all: other blocks have the same numbers.
        whole = {name for name, array in arrays.items() if self.values[name].size == array.size}
        self._shared, self._whole = shared, whole
        self._degrees: Degrees = {}
        self._members: dict[int, list[tuple[str, int, int]]] = {}
        self._strengths: dict[str, Strengths] = {}
        for name, output in prepared.outputs.items():
            folded = output.output.aggregation == "max"
            self._strengths[name] = Strengths(self.shape, folded=folded)
            # For each rule what it concludes: output, number among its contributions, member.
            for number, (member, rule) in enumerate(output.contributions):
                self._members.setdefault(rule, []).append((name, number, member))

    def outputs(self, strengths: Array | None = None) -> dict[str, Array]:
        """Evaluate the chunk; note in `strengths`, where it is wanted, how far each rule fires."""
        for step in self.plan.steps:
            if isinstance(step, str):
                self.values[step] = self._conclude(self.plan.outputs[step])
                continue
            strength = self._fire(step, self.plan.rules[step])
            if strengths is not None and strength is not None:
                strengths[step] = strength
        return {name: self.values[name] for name in self.plan.outputs}

    def _fire(self, index: int, planned: PlannedRule) -> Array | None:
        """Add a rule to what it concludes, and return how far it fires; None: nowhere."""
        strength = self._truth(planned.rule.antecedent, planned)
        if strength is None or planned.rule.weight == 0.0:
            return None
        if planned.rule.weight != 1.0:
            strength = strength * planned.rule.weight
        if planned.threshold > 0.0:
            strength = np.where(strength > planned.threshold, strength, 0.0)
        for output, number, member in self._members.get(index, ()):
            self._strengths[output].add(number, member, strength)
        return strength

    def _truth(self, expression: Expression, planned: PlannedRule) -> Array | None:
        """Return the truth of an expression over the chunk; None where it is 0 all over."""
        if isinstance(expression, Is):
            return self._proposition(expression, planned)
        if isinstance(expression, Hedged):
            inner = self._truth(expression.operand, planned)
            return hedged(
                expression.hedges, np.zeros((1,) * len(self.shape)) if inner is None else inner
            )
        if isinstance(expression, And):
            return self._conjunction(expression, planned)
        norm = SNORMS[planned.disjunction].array
        truth: Array | None = None
        for operand in expression.operands:
            degree = self._truth(operand, planned)
            if degree is not None:
                truth = degree if truth is None else norm(truth, degree)
        return truth

    def _conjunction(self, expression: And, planned: PlannedRule) -> Array | None:
        degrees = []
        for operand in expression.operands:
            degree = self._truth(operand, planned)
            if degree is None:
                return None
            degrees.append(degree)
        norm = TNORMS[planned.conjunction].array
        truth = degrees[0]
        for degree in degrees[1:]:
            truth = norm(truth, degree)
        return truth

    def _proposition(self, part: Is, planned: PlannedRule) -> Array | None:
        if part.variable in planned.degrees:
            return self._degree_so_far(part)
        key = (part.variable, part.term, part.hedges)
        degrees = self._shared if part.variable in self._whole else self._degrees
        if key not in degrees:
            shape = self.plan.rulebase.variable(part.variable).term(part.term).shape
            value = self.values[part.variable]
            degree = degrees_in(shape, value, part.hedges)
            if part.variable in self.plan.outputs:  # an earlier output may be without a value
                degree = np.where(np.isnan(value), 0.0, degree)
            degrees[key] = degree if degree.any() else None
        return degrees[key]

    def _degree_so_far(self, part: Is) -> Array:
        """How far the rules so far assert a term of an output of the same block."""
        output = self.plan.outputs[part.variable]
        norm = SNORMS[output.output.aggregation].array
        total: Array = np.zeros((1,) * len(self.shape))
        for member, strength in self._strengths[part.variable]:
            if output.members[member].term.name == part.term:
                total = norm(total, strength)
        return hedged(part.hedges, np.minimum(1.0, total))  # a sum may exceed a degree

    def _conclude(self, output_plan: OutputPlan) -> Array:
        output = output_plan.output
        strengths = self._strengths[output.name]
        inputs = tuple(variable.name for variable in self.plan.rulebase.inputs)
        value, fired = defuzzify_over_arrays(output_plan, strengths, self.values, inputs)
        value = np.broadcast_to(value, self.shape)
        # What is stated for silence is not brought into the range: it may lie outside on purpose.
        if not fired.all():
            value = np.where(fired, value, self._no_rule(output, ~fired))
        if stands_in_for_nan(output):
            fired = fired & ~np.isnan(value)
            value = value if fired.all() else np.where(fired, value, self._no_rule(output, ~fired))
        elif np.isnan(value).any():
            where = np.unravel_index(int(np.isnan(value).argmax()), self.shape)
            point = ", ".join(f"{n} = {v:.6g}" for n, v in self._point(where).items())
            raise NotANumberError(output.name, f"has none at {point}")
        if fired.all():
            return _into_range(output, value)
        return np.where(fired, _into_range(output, np.where(fired, value, output.low)), value)

    def _no_rule(self, output: Output, silent: NDArray[np.bool_]) -> float:
        if isinstance(output.no_rule, float | int):
            return float(output.no_rule)
        if output.no_rule == "hold":
            if output.name not in self.held:
                raise NothingHeldError(output.name)
            return float(self.held[output.name])
        where = np.unravel_index(int(silent.argmax()), self.shape)
        raise NoRuleFiredError(output.name, self._point(where))

    def _point(self, where: tuple[Any, ...]) -> dict[str, float]:
        return {
            variable.name: float(np.broadcast_to(self.values[variable.name], self.shape)[where])
            for variable in self.plan.rulebase.inputs
        }


def part_of(array: NDArray[Any], working: tuple[int, ...], block: Block) -> NDArray[Any]:
    """Return the part of an input that a block needs; axes of length 1 stay."""
    if array.ndim != len(working):
        return array
    return array[
        tuple(slice(None) if n == 1 else part for n, part in zip(array.shape, block, strict=True))
    ]
