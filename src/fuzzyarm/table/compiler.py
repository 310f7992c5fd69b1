"""Sample a rule base on a grid of levels: the compile step."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base import above
from fuzzyarm.base.diagnostic import MAX_LEVELS
from fuzzyarm.base.keywords import wrong_argument
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.numbers import decimal, evenly, number_text
from fuzzyarm.base.value_kinds import OfKind
from fuzzyarm.language.model.rulebase import AnyRuleBase, Input, Output, RuleBase, model_of
from fuzzyarm.table.axis import Axis, TableError
from fuzzyarm.table.table import LookupTable
from fuzzyarm.version import __version__

if TYPE_CHECKING:
    from fuzzyarm.requests.making import CompileRequest

DEFAULT_LEVELS = 13
"""Even levels of an input without levels from file or caller."""

MAX_CELLS = 32_000_000
"""Most cells of a table: 256 MB."""

_LARGE = 1_000_000
"""Cells from which loading machine code pays off."""

Engine = Callable[[Any], Mapping[str, Any]]
"""From a mapping of inputs to a mapping of outputs."""

_SLAB = 262_144
"""Cells evaluated at a time."""

Levels = int | Sequence[float]
"""A number of even levels over the range of the input, or the levels themselves."""


def compile_table(
    rulebase: AnyRuleBase | CompileRequest,
    output: str | None = None,
    *,
    levels: Levels | Mapping[str, Levels] | None = None,
    rounding: float | None = None,
    mode: str | None = None,
    source: str | Path | None = None,
    date: str | None = None,
) -> LookupTable:
    """Sample one output of a rule base.

    Parameters
    ----------
    rulebase : RuleBase or CompileRequest
        A request alone holds all settings. Else the ``lookup`` settings of the rule base define
        levels, bins and rounding; an input without any gets 13 even levels over its range.
    output : str, optional
        The sampled output; may be omitted if there is only one.
    levels : int, sequence of float, or mapping of name to either, optional
        Levels instead of those of the file; their inputs lose the bins of the file.
    rounding : float, optional
        Round the values to multiples of this step, ties to the even multiple; the file's
        by default. 0 for none.
    mode : str, optional
        The intended lookup mode.
    source : str or Path, optional
        The file of the rule base; its name without the folder goes into the provenance.
    date : str, optional
        Goes into the provenance; left out by default so that compiling is reproducible.

    Returns
    -------
    LookupTable
        Its axes are the inputs on which the output depends, in the order of the rule base. It
        states the range of the output, if any.

    Raises
    ------
    TableError
        If the output is unknown or not named, an input is unbounded without levels, or the
        table would be larger than `MAX_CELLS`.
    FuzzyarmError
        Errors of the inference, for instance where no rule fires.
    """
    if not isinstance(rulebase, OfKind):
        from fuzzyarm.requests.making import CompileRequest

        if isinstance(rulebase, CompileRequest):
            table: LookupTable = above.function("table_of_request")(rulebase)
            return table
    rulebase = model_of(rulebase)
    target = choose_output(rulebase, output)
    axes = choose_axes(rulebase, levels, target.name)
    cells = math.prod(len(axis.levels) for axis in axes)
    if cells > MAX_CELLS:
        raise TableError(f"the table would have {cells:,} cells; at most {MAX_CELLS:,} are made")
    if rounding is None:
        rounding = rulebase.lookup.round if rulebase.lookup else None
    values = sample(rulebase, target.name, axes, rounding or None)
    values.setflags(write=False)
    has_range = math.isfinite(target.low) or math.isfinite(target.high)
    return LookupTable(
        axes,
        target.name,
        values,
        low=target.low if has_range else None,
        high=target.high if has_range else None,
        description=target.description,
        rounding=rounding or None,
        mode=mode,
        provenance=tuple(_describe(rulebase, target, axes, levels, source, date).items()),
    )


def choose_output(rulebase: RuleBase, name: str | None) -> Output:
    """Return the output called `name`, or the only one."""
    names = [output.name for output in rulebase.outputs]
    listed = ", ".join(names)
    if name is None:
        if len(names) == 1:
            return rulebase.outputs[0]
        raise TableError(
            f"'{rulebase.name}' has {len(names)} outputs: name one of {listed}"
            if names
            else f"'{rulebase.name}' has no outputs"
        )
    if name in names:
        return rulebase.output(name)
    hint, _ = near_hint(name, names)
    raise TableError(f"'{rulebase.name}' has no output '{name}'", hint=hint or f"it has {listed}")


def needed_inputs(rulebase: RuleBase, output: str) -> tuple[Input, ...]:
    """Return the inputs on which an output depends; the first input if there are none."""
    from fuzzyarm.inference.plan import part_for

    names = {variable.name for variable in part_for(rulebase, [output]).inputs}
    return tuple(variable for variable in rulebase.inputs if variable.name in names)


def over_inputs(table: LookupTable, inputs: Sequence[Input]) -> LookupTable:
    """Return a table over further inputs, on which its values do not depend.

    Those get two levels; it is `table` itself if it has them all.
    """
    axes_by_name = {axis.name: axis for axis in table.axes}
    if len(axes_by_name) == len(inputs):
        return table
    axes = [
        axes_by_name.get(variable.name)
        or Axis(variable.name, even_levels(variable, 2), low=variable.low, high=variable.high)
        for variable in inputs
    ]
    shape = [len(axis.levels) if axis.name in axes_by_name else 1 for axis in axes]
    # Existing axes in the order of the inputs, new ones of length 1, repeated by broadcasting.
    order = [table.names.index(axis.name) for axis in axes if axis.name in axes_by_name]
    whole = [len(axis.levels) for axis in axes]
    spread = np.broadcast_to(table.values.transpose(order).reshape(shape), whole)
    values = np.ascontiguousarray(spread)
    values.setflags(write=False)
    return replace(table, axes=tuple(axes), values=values)


def choose_axes(
    rulebase: RuleBase,
    levels: Levels | Mapping[str, Levels] | None = None,
    output: str | None = None,
) -> tuple[Axis, ...]:
    """Return one axis for each input: by `levels`, else by the file, else 13 even levels.

    With an `output`, only the inputs on which it depends.
    """
    if not rulebase.inputs:
        raise TableError(f"'{rulebase.name}' has no inputs")
    levels_by_name: Mapping[str, Levels]
    if isinstance(levels, Mapping):
        levels_by_name = levels
    else:
        levels_by_name = {} if levels is None else {v.name: levels for v in rulebase.inputs}
    names = [variable.name for variable in rulebase.inputs]
    listed = ", ".join(names)
    for name in levels_by_name:
        if name not in names:
            hint, _ = near_hint(name, names)
            raise TableError(
                f"'{rulebase.name}' has no input '{name}'",
                hint=hint or f"it has {listed}",
            )
    inputs = rulebase.inputs if output is None else needed_inputs(rulebase, output)
    return tuple(
        _axis(rulebase, variable, levels_by_name.get(variable.name)) for variable in inputs
    )


def _axis(rulebase: RuleBase, variable: Input, levels: Levels | None) -> Axis:
    # Bins belong to the levels of the file: other levels have none.
    bins = None
    if levels is None:
        for axis in rulebase.lookup.axes if rulebase.lookup else ():
            if axis.variable == variable.name:
                levels, bins = axis.levels, axis.bins
    if levels is None:
        levels = DEFAULT_LEVELS
    if isinstance(levels, int):
        levels = even_levels(variable, levels)
    return Axis(
        variable.name,
        _listed(levels),
        bins,
        low=variable.low,
        high=variable.high,
        description=variable.description,
    )


def _listed(levels: Any) -> tuple[float, ...]:
    """Return levels as a tuple, from any container."""
    if isinstance(levels, str) or not isinstance(levels, Iterable):
        raise wrong_argument("compile_table", "levels", "a whole number or a list", levels)
    return tuple(levels)


def even_levels(variable: Input, count: int) -> tuple[float, ...]:
    """Return `count` even levels over the range of `variable`, both ends included."""
    if not 2 <= count <= MAX_LEVELS:
        raise TableError(f"an input has 2 to {MAX_LEVELS:,} levels, not {count:,}")
    if not (math.isfinite(variable.low) and math.isfinite(variable.high)):
        raise TableError(f"input '{variable.name}' is unbounded and so needs its own levels")
    return evenly(variable.low, variable.high, count)


def sample(
    rulebase: RuleBase, output: str, axes: Sequence[Axis], rounding: float | None = None
) -> NDArray[np.float64]:
    """Return the inference at every combination of levels, rounded."""
    # In slabs of the first axis, to need little more memory than the table.
    levels = [np.array(axis.levels) for axis in axes]
    values = np.empty([array.size for array in levels])
    rows = max(1, _SLAB // max(1, values[0].size))
    engine = _engine(rulebase, output, values.size)
    for start in range(0, levels[0].size, rows):
        # `ix_` gives input i the shape (1, …, nᵢ, …, 1); broadcasting makes the grid.
        part = [levels[0][start : start + rows], *levels[1:]]
        slab = evaluate(rulebase, output, [a.name for a in axes], np.ix_(*part), engine)
        values[start : start + rows] = slab if rounding is None else round_to(slab, rounding)
    return values


def _engine(rulebase: RuleBase, output: str, cells: int) -> Engine:
    """Return the compiled engine for a table so large that its start pays, else the plain one."""
    from fuzzyarm.inference import compiled, infer
    from fuzzyarm.inference.plan import part_for

    if cells < _LARGE:
        return partial(infer, rulebase, outputs=[output])
    part = part_for(rulebase, [output])
    engine, names = compiled(part), {variable.name for variable in part.inputs}
    return lambda inputs: engine({name: x for name, x in inputs.items() if name in names})


def evaluate(
    rulebase: RuleBase,
    output: str,
    names: Sequence[str],
    points: Sequence[NDArray[np.float64]],
    engine: Engine | None = None,
) -> NDArray[np.float64]:
    """Return the inference at `points`, one array for each of `names`; they are broadcast.

    A TableError names the point where the output is NaN, which a file may state for no rule.
    """
    evaluator = engine or _engine(rulebase, output, 0)
    inputs: dict[str, NDArray[np.float64]] = dict(zip(names, points, strict=True))
    result = np.asarray(evaluator(inputs)[output], dtype=np.float64)
    values = np.broadcast_to(result, np.broadcast_shapes(*(array.shape for array in points)))
    if not np.isfinite(values).all():
        # The first point without a value, for the message.
        where = tuple(np.argwhere(~np.isfinite(values))[0])
        spread = np.broadcast_arrays(*points)
        coordinates = [(name, x[where]) for name, x in zip(names, spread, strict=True)]
        point = ", ".join(f"{name} = {number_text(float(x))}" for name, x in coordinates)
        raise TableError(
            f"output '{output}' has no value at {point}",
            hint="a table needs one in every cell: state in the file the value if no rule fires",
        )
    return values


def round_to(values: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Return `values` as multiples of `step`, each the float nearest to its decimal.

    The step is taken as the decimal it is written as: 3 steps of 0.1 are 0.3. Ties go to
    the even multiple; a zero has no sign.
    """
    if not (step > 0 and math.isfinite(step)):
        raise TableError(f"values are rounded to a positive step, not to {step:g}")
    # 0.1 as 1/10: multiples / 10 is the float nearest to the decimal, multiples · 0.1 is not.
    exact = decimal(step)
    with np.errstate(over="ignore", invalid="ignore"):
        multiples = np.rint(values / step)
        if exact.numerator < 2**20 and exact.denominator < 2**53:
            rounded = multiples * float(exact.numerator) / float(exact.denominator) + 0.0
        else:
            rounded = multiples * step + 0.0
    # A step far below the distance of neighbouring floats changes nothing.
    return np.asarray(np.where(np.isfinite(multiples), rounded, values))


def _describe(
    rulebase: RuleBase,
    output: Output,
    axes: Sequence[Axis],
    levels: object,
    source: str | Path | None,
    date: str | None,
) -> dict[str, str]:
    """Return the provenance of a compiled table."""
    from fuzzyarm.language import write

    axes_of_file = {axis.variable for axis in rulebase.lookup.axes} if rulebase.lookup else set()
    default = levels is None and not axes_of_file.issuperset(axis.name for axis in axes)
    words = "at the levels of the file" if levels is None else "at the levels asked for"
    provenance = {"made": "compiled", "rulebase": rulebase.name}
    if source is not None:
        provenance["source"] = Path(source).name
    provenance["sha256"] = hashlib.sha256(write(rulebase).encode()).hexdigest()
    provenance["engine"] = f"fuzzyarm {__version__}"
    provenance["defuzzifier"] = str(output.defuzzifier)
    provenance["sampled"] = f"at {DEFAULT_LEVELS} even levels by default" if default else words
    if date is not None:
        provenance["date"] = date
    return provenance
