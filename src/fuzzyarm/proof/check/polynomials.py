"""Polynomials on a simplex, homogeneous in its barycentric coordinates: signs and quotients.

A polynomial without negative coefficients is nowhere negative on its simplex; if the coefficients
show no sign the simplex is halved. A quotient lies between the least and the largest quotient of
coefficients (Bernstein form).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import combinations
from typing import Any

from flint import arb, fmpq, fmpq_mpoly_ctx

from fuzzyarm.proof.check.numbers import ONE, ZERO, Number, SpanError, between
from fuzzyarm.proof.stop import check_time

DEEPEST = 14
"""Most halvings of a simplex before a claim is given up."""

Vector = tuple[fmpq, ...]
Polynomial = Any
"""Of the type fmpq_mpoly."""


@lru_cache(maxsize=32)
def ring_of(size: int) -> tuple[Any, list[Polynomial]]:
    """Return the ring of polynomials in barycentric coordinates, and these."""
    ring = fmpq_mpoly_ctx.get([f"l{k}" for k in range(size)])
    return ring, list(ring.gens())


@lru_cache(maxsize=256)
def power_of_unit(size: int, power: int) -> Polynomial:
    """Return (λ₀ + … + λ_d)ⁿ, which is 1 on the simplex."""
    return sum(ring_of(size)[1]) ** power


def linear(values: Vector) -> Polynomial:
    """Return the linear polynomial with the given values at the corners."""
    ring, units = ring_of(len(values))
    return sum((x * unit for x, unit in zip(values, units, strict=True)), ring.constant(ZERO))


def level(p: Polynomial, q: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Return both with the same degree: multiplied by (λ₀ + … + λ_d)ⁿ = 1."""
    gap = p.total_degree() - q.total_degree()
    if p.is_zero() or q.is_zero() or not gap:
        return p, q
    unit = power_of_unit(p.context().nvars(), abs(gap))
    return (p, q * unit) if gap > 0 else (p * unit, q)


def plus(p: Polynomial, q: Polynomial, factor: fmpq) -> Polynomial:
    """Return ``p + factor q``."""
    p, q = level(p, q)
    return p + q * factor


def is_positive(p: Polynomial) -> bool:
    """Return whether a polynomial is proved positive on the whole simplex, corners included."""
    if not min(p.coeffs(), default=ZERO) > 0:
        return False
    degree = p.total_degree()
    corners = sum(max(powers) == degree for powers in p.monoms())
    return bool(corners == p.context().nvars())


def is_not_negative(p: Polynomial, depth: int = DEEPEST) -> bool:
    """Return whether a polynomial is proved at least 0 on its simplex, by halving."""
    if min(p.coeffs(), default=ZERO) >= 0:
        return True
    negative = {powers: x for powers, x in p.to_dict().items() if x < 0}
    degree = p.total_degree()
    if not depth or any(max(powers) == degree for powers in negative):
        return False  # negative at a corner
    check_time()
    units = ring_of(len(next(iter(negative))))[1]
    # The edge with the largest second difference of coefficients.
    i, j = max(
        combinations(range(len(units)), 2),
        key=lambda pair: sum(-x * (k[pair[0]] + k[pair[1]]) for k, x in negative.items()),
    )
    half = fmpq(1, 2)
    return all(is_not_negative(moved(p, a, b, half), depth - 1) for a, b in ((i, j), (j, i)))


def moved(p: Polynomial, stays: int, moves: int, share: fmpq) -> Polynomial:
    """Return p on the simplex with one corner moved to ``(1 - share) stays + share moves``."""
    units = list(ring_of(len(p.context().gens()))[1])
    units[stays] = units[stays] + units[moves] * (ONE - share)
    units[moves] = units[moves] * share
    return p.compose(*units)


def ratio(p: Polynomial, q: Polynomial) -> Number:
    """Return bounds of p/q for q > 0, at a degree with no zero coefficient of q."""
    size = q.context().nvars()
    unit = power_of_unit(size, 1)
    p, q = level(p, q)
    for _ in range(3):
        lower, upper = q.to_dict(), p.to_dict()
        whole = math.comb(q.total_degree() + size - 1, size - 1)
        if len(lower) == whole and all(x > 0 for x in lower.values()):
            ratios = [upper.get(powers, ZERO) / x for powers, x in lower.items()]
            return between(min(ratios), max(ratios))
        p, q = p * unit, q * unit
    raise SpanError("a rule base may have no value somewhere")


def coefficients(polynomial: Polynomial, degree: int) -> dict[tuple[int, ...], fmpq]:
    """Return the coefficients of a polynomial at its own or a higher degree."""
    if polynomial.is_zero():
        return {}
    missing = degree - int(polynomial.total_degree())
    raised = polynomial * power_of_unit(polynomial.context().nvars(), missing)
    return {tuple(int(k) for k in powers): x for powers, x in raised.to_dict().items()}


def first_coefficient(terms: Mapping[Any, fmpq]) -> fmpq:
    """Return the value of a polynomial at the first corner."""
    return next((x for powers, x in terms.items() if not any(powers[1:])), ZERO)


def bounds_of(terms: Any, shares: Sequence[tuple[Number, Number]]) -> Number:
    """Return bounds of a polynomial over numbers that are not negative, term by term."""
    low, high = arb(0), arb(0)
    for powers, x in terms:
        small = large = x
        for power, (a, b) in zip(powers, shares, strict=True):
            for _ in range(power):
                small, large = small * a, large * b
        low += small if x > 0 else large
        high += large if x > 0 else small
    return between(low.lower(), high.upper())


def dot(row: Vector, corner: Vector) -> fmpq:
    """Return the scalar product."""
    return sum((w * x for w, x in zip(row, corner, strict=True) if w), ZERO)
