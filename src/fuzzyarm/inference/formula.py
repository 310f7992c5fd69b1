"""Formulas over arrays; the twin of :func:`fuzzyarm.rulebase.formula.evaluate`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.rulebase.formula import CONSTANTS, FormulaError, Name, Node, Number

FUNCTIONS: dict[str, Callable[..., Any]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "%": np.fmod,
    "^": np.power,
    "neg": np.negative,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "exp": np.exp,
    "log": np.log,
    "log10": np.log10,
    "sqrt": np.sqrt,
    "abs": np.abs,
    "floor": np.floor,
    "ceil": np.ceil,
    "round": np.round,
    "min": np.minimum,
    "max": np.maximum,
    "pow": np.power,
    "atan2": np.arctan2,
    "fmod": np.fmod,
}
"""The operators and functions of the language over arrays."""


def evaluate_arrays(node: Node, values: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the value of a formula over arrays that broadcast.

    Parameters
    ----------
    node : formula tree
        As from :func:`fuzzyarm.rulebase.formula.parse`.
    values : mapping of str to ndarray
        A value for every name.

    Returns
    -------
    ndarray of float64
        NaN or infinite where arithmetic is; without a warning.
    """
    with np.errstate(all="ignore"):
        return np.asarray(_value(node, values), dtype=float)


def _value(node: Node, values: Mapping[str, NDArray[np.float64]]) -> Any:
    if isinstance(node, Number):
        return np.float64(node.value)
    if isinstance(node, Name):
        if node.name in values:
            return values[node.name]
        if node.name in CONSTANTS:
            return np.float64(CONSTANTS[node.name])
        raise FormulaError(f"'{node.name}' is no variable", node.name, node.position)
    return FUNCTIONS[node.function](*(_value(part, values) for part in node.arguments))
