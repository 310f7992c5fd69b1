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
    if code in (BOTH_HAMACHER, HAMACHER, BOTH_EINSTEIN, EINSTEIN, PROBOR):
        return smooth(code, a, b, a * b)
    low, high, total = min(a, b), max(a, b), a + b
    found = total / max(1.0, total)  # normalized
    if code == BOTH_BOUNDED:
        found = max(0.0, total - 1.0)
    elif code == BOUNDED:
        found = min(1.0, total)
    elif code == BOTH_DRASTIC:
        found = low if high >= 1.0 else 0.0
    elif code == DRASTIC:
        found = high if low <= 0.0 else 1.0
    elif code == BOTH_NILPOTENT:
        found = low if total > 1.0 else 0.0
    elif code == NILPOTENT:
        found = high if total < 1.0 else 1.0
    return found


@kernel
def smooth(code: int, a: float, b: float, product: float) -> float:
    """Return one of the norms that are rational functions."""
    found = a + b - product  # probor
    if code == BOTH_HAMACHER:
        found = product / found if product > 0.0 else 0.0
    elif code == HAMACHER:
        found = (a + b - 2.0 * product) / (1.0 - product) if product < 1.0 else 1.0
    elif code == BOTH_EINSTEIN:
        found = product / (2.0 - found)
    elif code == EINSTEIN:
        found = (a + b) / (1.0 + product)
    return found
