"""T-norms and s-norms of two floats; the array twins are in `fuzzyarm.inference`."""

from __future__ import annotations

from collections.abc import Callable

Norm = Callable[[float, float], float]


def _t_hamacher(a: float, b: float) -> float:
    return a * b / (a + b - a * b) if a > 0.0 and b > 0.0 else 0.0


def _t_drastic(a: float, b: float) -> float:
    return min(a, b) if max(a, b) >= 1.0 else 0.0


def _s_hamacher(a: float, b: float) -> float:
    return 1.0 if a * b >= 1.0 else (a + b - 2.0 * a * b) / (1.0 - a * b)


def _s_drastic(a: float, b: float) -> float:
    return max(a, b) if min(a, b) <= 0.0 else 1.0


TNORMS: dict[str, Norm] = {
    "min": min,
    "product": lambda a, b: a * b,
    "bounded": lambda a, b: max(0.0, a + b - 1.0),
    "drastic": _t_drastic,
    "hamacher": _t_hamacher,
    "einstein": lambda a, b: a * b / (2.0 - (a + b - a * b)),
    "nilpotent": lambda a, b: min(a, b) if a + b > 1.0 else 0.0,
}
"""Conjunctions and implications by name."""

SNORMS: dict[str, Norm] = {
    "max": max,
    "probor": lambda a, b: a + b - a * b,
    "bounded": lambda a, b: min(1.0, a + b),
    "drastic": _s_drastic,
    "hamacher": _s_hamacher,
    "einstein": lambda a, b: (a + b) / (1.0 + a * b),
    "nilpotent": lambda a, b: max(a, b) if a + b < 1.0 else 1.0,
    "sum": lambda a, b: a + b,
    "normalized": lambda a, b: (a + b) / max(1.0, a + b),
}
"""Disjunctions and aggregations by name."""
