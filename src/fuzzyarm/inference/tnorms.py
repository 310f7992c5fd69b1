"""T-norms over arrays: what *and* means, and how a rule cuts its consequent.

Each takes two float arrays of degrees that broadcast and returns their conjunction; the
names are those of :data:`fuzzyarm.rulebase.model.CONJUNCTIONS`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Norm = Callable[[Any, Any], Array]


def bounded(a: Array, b: Array) -> Array:
    """Łukasiewicz: max(0, a + b − 1)."""
    return np.maximum(0.0, a + b - 1.0)


def drastic(a: Array, b: Array) -> Array:
    """Return the smaller where the other is 1, else 0."""
    return np.where(np.maximum(a, b) >= 1.0, np.minimum(a, b), 0.0)


def hamacher(a: Array, b: Array) -> Array:
    """Return ab / (a + b − ab), 0 where both are 0."""
    product = np.multiply(a, b)
    below = a + b - product
    return np.divide(product, below, out=np.zeros_like(product), where=product > 0.0)


def einstein(a: Array, b: Array) -> Array:
    """Return ab / (2 − (a + b − ab))."""
    product = np.multiply(a, b)
    return np.divide(product, 2.0 - (a + b - product))


def nilpotent(a: Array, b: Array) -> Array:
    """Return the smaller where a + b > 1, else 0."""
    return np.where(a + b > 1.0, np.minimum(a, b), 0.0)


TNORMS: dict[str, Norm] = {
    "min": np.minimum,
    "product": np.multiply,
    "bounded": bounded,
    "drastic": drastic,
    "hamacher": hamacher,
    "einstein": einstein,
    "nilpotent": nilpotent,
}
"""Conjunctions and implications by name."""
