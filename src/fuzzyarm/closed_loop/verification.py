"""What a certificate proves, once the checker accepts it: the claim, and what else is known.

Whatever says *proved* of a loop goes through :func:`verified`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.closed_loop.certificate import Certificate
from fuzzyarm.closed_loop.checker import is_inside, refutation
from fuzzyarm.closed_loop.form import Form
from fuzzyarm.closed_loop.form_maker import FormMaker
from fuzzyarm.closed_loop.problem import LoopProofError

__all__ = ["power_up", "reach_of", "start_quadric", "start_vertices", "verified"]


def _plain(values: Mapping[str, Fraction]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items()}


def verified(
    maker: FormMaker, certificate: Certificate, *, form: Form | None = None
) -> tuple[str, dict[str, Any]]:
    """Return why a certificate does not prove its claim (empty: it does), and what it proves.

    Parameters
    ----------
    maker : FormMaker
        Of the loop.
    certificate : Certificate
        Which.
    form : Form, optional
        The loop's form under the certificate's choice, where it has been made already.
    """
    if form is None:
        form = maker.form(certificate.choice, continuous=certificate.continuous)
    if certificate.states != form.names:
        return "it is of other states", {}
    p = certificate.p
    against = refutation(form, p, certificate.multipliers, certificate.rate)
    if against:
        return against, {}
    level = Fraction(0)
    claim = certificate.claim
    if claim.start or claim.output:
        for vertex in start_vertices(maker, form):
            level = max(level, _value(p, vertex))
        if level > 1:
            return "its region does not hold the whole start", {}
    reach = reach_of(form, Fraction(1), p)
    facts: dict[str, Any] = {
        "region": {
            name: (float(form.rest[name]) - half, float(form.rest[name]) + half)
            for name, half in reach.items()
        },
        "start_region": _along_alone(maker, form, p),
        "rest": _plain(form.rest),
        "fall": float(certificate.rate),
        "continuous": certificate.continuous,
        "uncertain": form.words,
    }
    if claim.output:
        against = _outside(maker, form, certificate, level)
        if against:
            return against, facts
    return "", facts


def _value(p: Sequence[Sequence[Fraction]], z: Sequence[Fraction]) -> Fraction:
    return sum(
        (x * weight * y for x, row in zip(z, p, strict=True) if x
         for weight, y in zip(row, z, strict=True)),
        Fraction(0),
    )  # fmt: skip


def start_vertices(maker: FormMaker, form: Form) -> list[tuple[Fraction, ...]]:
    """Return the corners of the start, as deviations from rest; memory as the loop starts with it.

    Parameters
    ----------
    maker : FormMaker
        Of the loop.
    form : Form
        Of it.
    """
    problem = maker.problem
    ends = [
        tuple(
            dict.fromkeys((Fraction(problem.start[name].low), Fraction(problem.start[name].high)))
        )
        for name in problem.states
    ]
    if 2 ** sum(len(end) > 1 for end in ends) > 4096:
        raise LoopProofError("a start of more than 12 intervals")
    return [
        _with_memory(maker, form, dict(zip(problem.states, corner, strict=True)))
        for corner in product(*ends)
    ]


def _with_memory(
    maker: FormMaker, form: Form, states: Mapping[str, Fraction]
) -> tuple[Fraction, ...]:
    """Return z of the moment before the first period, of states of the plant."""
    begin = maker.begin
    found = []
    for name in form.names:
        if name in states:
            value = states[name]
        elif name in form.seeds:
            seed = form.seeds[name]
            value = seed.constant + sum(
                (w * (states[of] - form.rest[of]) for of, w in seed.parts.items()), Fraction(0)
            )
        else:
            value = Fraction(begin[name])
        found.append(value - form.rest[name])
    return tuple(found)


def start_quadric(
    maker: FormMaker, form: Form, p: Sequence[Sequence[Fraction]], states: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Return Q, l, c with V - 1 = xᵀQx + l x + c where some states start x away from rest.

    Parameters
    ----------
    maker : FormMaker
        Of the loop.
    form : Form
        Of it.
    p : rows of Fraction
        Of V.
    states : sequence of int
        Which states of the plant; the others begin at rest, the memory as it does.
    """
    names = maker.problem.states
    rest = {name: form.rest[name] for name in names}
    base = np.array([float(x) for x in _with_memory(maker, form, rest)])
    ways = []
    for k in states:
        moved = {**rest, names[k]: rest[names[k]] + 1}
        ways.append(np.array([float(x) for x in _with_memory(maker, form, moved)]) - base)
    way, plain = np.array(ways), np.array([[float(x) for x in row] for row in p])
    return way @ plain @ way.T, 2.0 * way @ plain @ base, float(base @ plain @ base) - 1.0


def _along_alone(maker: FormMaker, form: Form, p: Sequence[Sequence[Fraction]]) -> dict[str, float]:
    """Return how far the loop may start along each state, the memory as it is at the start."""
    values = {}
    for k, name in enumerate(maker.problem.states):
        quadratic, linear, c = start_quadric(maker, form, p, (k,))
        a, b = float(quadratic[0, 0]), float(linear[0])
        inside = b * b - 4.0 * a * c
        if c < 0.0 and inside >= 0.0:
            values[name] = min(
                (-b + math.sqrt(inside)) / (2 * a), (b + math.sqrt(inside)) / (2 * a)
            )
    return values


def reach_of(form: Form, level: Fraction, p: Sequence[Sequence[Fraction]]) -> dict[str, float]:
    """Return how far each state is from rest at most where V is at most a level."""
    inverse = np.linalg.inv(np.array([[float(x) for x in row] for row in p]))
    values = {}
    for k, name in enumerate(form.names):
        half = math.sqrt(float(level) * max(float(inverse[k, k]), 0.0))
        row = tuple(Fraction(int(i == k)) for i in range(form.size))
        for wider in (1.0 + 1e-9, 1.0 + 1e-6, 1.01, 2.0):
            if level and is_inside(p, row, Fraction(half * wider), level):
                half *= wider
                break
        else:
            half = 0.0 if not level else math.inf
        values[name] = half
    return values


def _outside(maker: FormMaker, form: Form, certificate: Certificate, level: Fraction) -> str:
    """Return why an output may leave the claimed interval in the claimed time; empty: it cannot."""
    claim = certificate.claim
    if certificate.continuous:
        return "a claim about an output is proved of the sampled loop"
    periods = int(Fraction(claim.begin) / Fraction(maker.problem.period)) if claim.begin else 0
    left = power_up(1 - certificate.rate, periods) * level
    reach = reach_of(form, left, certificate.p)
    if any(math.isinf(half) for half in reach.values()):
        return "its region has no bounds"
    low, high = maker.plant.output_between_samples(claim.output, reach)
    if claim.low <= low and high <= claim.high:
        return ""
    when = f" {claim.begin:g} s after the start" if claim.begin else ""
    return f"{claim.output} stays in {low:.6g} .. {high:.6g}{when}, as far as the region says"


def power_up(base: Fraction, exponent: int) -> Fraction:
    """Return a power, rounded up to 128 bits."""
    total, factor = Fraction(1), base
    while exponent:
        if exponent & 1:
            total = _up_to_bits(total * factor)
        factor = _up_to_bits(factor * factor)
        exponent >>= 1
    return total


def _up_to_bits(x: Fraction, bits: int = 128) -> Fraction:
    shift = bits - (x.numerator.bit_length() - x.denominator.bit_length())
    if shift <= 0:
        return x
    return Fraction(-((-x.numerator << shift) // x.denominator), 1 << shift)
