"""Norms as a kernel: T-norms and S-norms by number."""

from __future__ import annotations

from fuzzyarm.kernels import kernel
from fuzzyarm.rulebase.model import CONJUNCTIONS, DISJUNCTIONS

CODES = {f"and {name}": i for i, name in enumerate(CONJUNCTIONS)} | {
    f"or {name}": len(CONJUNCTIONS) + i for i, name in enumerate(DISJUNCTIONS)
}
"""The number of each norm, T-norms first."""

(
    MIN, PRODUCT, BOTH_BOUNDED, BOTH_DRASTIC, BOTH_HAMACHER, BOTH_EINSTEIN, BOTH_NILPOTENT,
    MAX, PROBOR, BOUNDED, DRASTIC, HAMACHER, EINSTEIN, NILPOTENT, SUM, NORMALIZED,
) = range(len(CODES))  # fmt: skip


@kernel
def combine(code: int, a: float, b: float) -> float:
    """Return the norm with number `code` of two degrees."""
    if code == MIN:
        return min(a, b)
    if code == MAX:
        return max(a, b)
    if code == PRODUCT:
        return a * b
    if code == SUM:
        return a + b
    return rare(code, a, b)


@kernel
def rare(code: int, a: float, b: float) -> float:
    """Return one of the norms that few rule bases use."""
    product = a * b
    if code == PROBOR:
        return a + b - product
    if code == BOTH_BOUNDED:
        return max(0.0, a + b - 1.0)
    if code == BOUNDED:
        return min(1.0, a + b)
    if code == BOTH_DRASTIC:
        return min(a, b) if max(a, b) >= 1.0 else 0.0
    if code == DRASTIC:
        return max(a, b) if min(a, b) <= 0.0 else 1.0
    if code == BOTH_HAMACHER:
        return product / (a + b - product) if product > 0.0 else 0.0
    if code == HAMACHER:
        return (a + b - 2.0 * product) / (1.0 - product) if product < 1.0 else 1.0
    if code == BOTH_EINSTEIN:
        return product / (2.0 - (a + b - product))
    if code == EINSTEIN:
        return (a + b) / (1.0 + product)
    if code == BOTH_NILPOTENT:
        return min(a, b) if a + b > 1.0 else 0.0
    if code == NILPOTENT:
        return max(a, b) if a + b < 1.0 else 1.0
    return (a + b) / max(1.0, a + b)
