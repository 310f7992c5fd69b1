"""S-norms over arrays: what *or* means, and how the sets of several rules become one.

Each takes two float arrays of degrees that broadcast; the names are those of
:data:`fuzzyarm.rulebase.model.DISJUNCTIONS`. ``sum`` may exceed 1: it is for aggregation.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Norm = Callable[[Any, Any], Array]


def probor(a: Array, b: Array) -> Array:
    """Return a + b − ab."""
    return a + b - np.multiply(a, b)


def bounded(a: Array, b: Array) -> Array:
    """Return min(1, a + b)."""
    return np.minimum(1.0, np.add(a, b))


def drastic(a: Array, b: Array) -> Array:
    """Return the larger where the other is 0, else 1."""
    return np.where(np.minimum(a, b) <= 0.0, np.maximum(a, b), 1.0)


def hamacher(a: Array, b: Array) -> Array:
    """Return (a + b − 2ab) / (1 − ab), 1 where both are 1."""
    product = np.multiply(a, b)
    return np.divide(
        a + b - 2.0 * product, 1.0 - product, out=np.ones_like(product), where=product < 1.0
    )


def einstein(a: Array, b: Array) -> Array:
    """Return (a + b) / (1 + ab)."""
    return np.divide(np.add(a, b), 1.0 + np.multiply(a, b))


def nilpotent(a: Array, b: Array) -> Array:
    """Return the larger where a + b < 1, else 1."""
    return np.where(a + b < 1.0, np.maximum(a, b), 1.0)


def normalized(a: Array, b: Array) -> Array:
    """Return (a + b) / max(1, a + b), taken pair by pair."""
    total = np.add(a, b)
    return np.divide(total, np.maximum(1.0, total))


SNORMS: dict[str, Norm] = {
    "max": np.maximum,
    "probor": probor,
    "bounded": bounded,
    "drastic": drastic,
    "hamacher": hamacher,
    "einstein": einstein,
    "nilpotent": nilpotent,
    "sum": np.add,
    "normalized": normalized,
}
"""Disjunctions and aggregations by name."""
