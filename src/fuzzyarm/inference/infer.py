"""Evaluate a rule base: one call for scalars and arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fuzzyarm.inference.errors import InferenceError
from fuzzyarm.inference.scalar import prepare
from fuzzyarm.rulebase.model import RuleBase

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def infer(
    rulebase: RuleBase,
    inputs: Mapping[str, Any] | None = None,
    /,
    *,
    held: Mapping[str, float] | None = None,
    **named: Any,
) -> dict[str, float | NDArray[np.float64]]:
    """Evaluate a rule base.

    Parameters
    ----------
    rulebase : RuleBase
        The model.
    inputs : mapping of str to float or array_like, optional
        Inputs by name; for names that are no identifiers.
    held : mapping of str to float, optional
        Last values of outputs that hold where no rule fires.
    **named : float or array_like
        Inputs by name. Arrays broadcast against each other.

    Returns
    -------
    dict of str to float or ndarray of float64
        Every output by name: floats where all inputs are scalars, else arrays of the
        broadcast shape. NaN only where the file states it (``no-rule nan``).

    Raises
    ------
    InferenceError
        For a model that cannot be evaluated; names that are unknown, missing or given
        twice; values that are no numbers or outside a range that forbids it.
    NoRuleFiredError
        If no rule fires for an output that has no value for that case.

    Examples
    --------
    >>> infer(rulebase, e=1.3, ce=-2.2)                        # doctest: +SKIP
    {'u': -0.7153}
    >>> infer(rulebase, e=axis[:, None], ce=axis[None, :])     # doctest: +SKIP
    """
    given = merged(inputs, named)
    if holds_arrays(given):
        from fuzzyarm.inference.engine import infer_arrays

        return dict(infer_arrays(rulebase, given, held))
    return dict(prepare(rulebase).evaluate(given, held))


def merged(inputs: Mapping[str, Any] | None, named: Mapping[str, Any]) -> dict[str, Any]:
    """Put inputs from both ways of giving them together."""
    given = dict(inputs or {})
    for name, value in named.items():
        if name in given:
            raise InferenceError(f"input '{name}' is given twice")
        given[name] = value
    return given


def holds_arrays(given: Mapping[str, Any]) -> bool:
    """Whether any input is an array."""
    return any(not isinstance(value, float | int) and is_array(value) for value in given.values())


def is_array(value: object) -> bool:
    """Whether an input is many values."""
    return isinstance(value, list | tuple) or getattr(value, "ndim", 0) > 0
