"""Checks of a caller's inputs: names, numbers, ranges; and the output where no rule fires."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from fuzzyarm.inference.errors import (
    MissingInputError,
    NotANumberError,
    NothingHeldError,
    OutsideRangeError,
    UnknownNameError,
)
from fuzzyarm.language.model.rulebase import Output, RuleBase, Variable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def check_names(requested: Iterable[str], valid: Iterable[str], *, what: str = "input") -> None:
    """Raise UnknownNameError for the first name of `requested` that is not in `valid`."""
    names = tuple(valid)
    for name in requested:
        if name not in names:
            raise UnknownNameError(name, names, what=what)


def _demand_all(rulebase: RuleBase, inputs: Mapping[str, Any]) -> None:
    """Raise an error unless the names are exactly those of the inputs."""
    names = [variable.name for variable in rulebase.inputs]
    check_names(inputs, names)
    missing = [name for name in names if name not in inputs]
    if missing:
        raise MissingInputError(missing)


# ── at a point ───────────────────────────────────────────────────────────────────────


def floats_of(rulebase: RuleBase, inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return the inputs at a point, complete and in their order."""
    _demand_all(rulebase, inputs)
    return {v.name: number_of(v.name, inputs[v.name]) for v in rulebase.inputs}


def number_of(name: str, value: Any) -> float:
    """Return the value of an input; raise NotANumberError for anything but a number.

    Text is not a number, even if it is digits: input from a file or a form must be parsed first.
    """
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    if not isinstance(value, str | bytes | bytearray) and kind not in ("U", "S"):
        try:
            return float(value)
        except (TypeError, ValueError, OverflowError):
            pass
    raise NotANumberError(name, f"is not a number: {value!r}")


def bring_into_range(variable: Variable, value: float) -> float:
    """Return `value` clamped, unchanged, or an error: by ``variable.outside``."""
    if variable.low <= value <= variable.high:
        return value
    if math.isnan(value):
        raise NotANumberError(variable.name)
    if variable.outside == "clamp":
        return variable.low if value < variable.low else variable.high
    if variable.outside == "error":
        raise OutsideRangeError(variable.name, value, variable.low, variable.high)
    if math.isinf(value):
        raise NotANumberError(variable.name, f"is infinite ({value})")
    return value


# ── arrays ───────────────────────────────────────────────────────────────────────────


def holds_arrays(inputs: Mapping[str, Any]) -> bool:
    """Whether any input is an array."""
    return any(not isinstance(value, float | int) and _is_array(value) for value in inputs.values())


def _is_array(value: object) -> bool:
    return isinstance(value, list | tuple) or getattr(value, "ndim", 0) > 0


def arrays_of(
    rulebase: RuleBase, inputs: Mapping[str, Any]
) -> tuple[dict[str, NDArray[np.float64]], tuple[int, ...]]:
    """Return all inputs as floats, in their order, and their broadcast shape."""
    import numpy as np

    _demand_all(rulebase, inputs)
    arrays = {v.name: _numbers(v.name, inputs[v.name]) for v in rulebase.inputs}
    try:
        return arrays, np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        first = rulebase.inputs[0].name
        raise NotANumberError(first, f"does not fit the others: {shapes}") from None


def _numbers(name: str, values: Any) -> NDArray[np.float64]:
    """Return an input as floats; text is not a number, even of digits."""
    import numpy as np

    try:
        array = np.asarray(values)
        texts = array.dtype.kind == "O" and any(isinstance(x, str | bytes) for x in array.flat)
        if array.dtype.kind in "fiubO" and not texts:
            return array.astype(float, copy=False)
    except (TypeError, ValueError, OverflowError):
        pass
    kind = type(values).__name__
    raise NotANumberError(name, f"is not an array of numbers: {kind}")


def array_in_range(variable: Variable, array: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return an array clamped, unchanged, or an error: by ``variable.outside``."""
    import numpy as np

    if np.isnan(array).any():
        raise NotANumberError(variable.name)
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


# ── where no rule fires ────────────────────────────────────────────────────────────


def replaces_nan(output: Output) -> bool:
    """Whether the value for no rule also replaces that of a formula without one.

    So if it is held, or itself NaN: such an output may lack a value.
    """
    no_rule = output.no_rule
    return no_rule == "hold" or (isinstance(no_rule, float) and math.isnan(no_rule))


def held_value(output: Output, held: Mapping[str, float]) -> float:
    """Return the last value of an output."""
    if output.name not in held:
        raise NothingHeldError(output.name)
    return float(held[output.name])
