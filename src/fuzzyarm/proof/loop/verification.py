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

from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in
from fuzzyarm.proof.loop.certificate import Certificate
from fuzzyarm.proof.loop.checked_lines import PiecesOfRules
from fuzzyarm.proof.loop.checked_loop import CheckedLoop, checked_loop
from fuzzyarm.proof.loop.checked_motion import output_between_samples
from fuzzyarm.proof.loop.checker import is_inside, refutation
from fuzzyarm.proof.loop.outward import above, below
from fuzzyarm.proof.loop.spans import RationalInterval
from fuzzyarm.proof.stop import check_time

__all__ = [
    "has_known_start",
    "port_within",
    "power_up",
    "quadratic_at",
    "reach_of",
    "start_quadric",
    "start_vertices",
    "verified",
]


def _plain(values: Mapping[str, Fraction]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items()}


def verified(
    problem: LoopProblem, certificate: Certificate, pieces: PiecesOfRules | None = None
) -> tuple[str, dict[str, Any], CheckedLoop | None]:
    """Return why a certificate does not prove its claim (empty: it does), and what it proves.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    certificate : Certificate
        Which.
    pieces : PiecesOfRules, optional
        Of its rule bases, where they have been cut already.

    Returns
    -------
    against : str
        Empty where it is proved.
    facts : dict
        Of a verdict.
    loop : CheckedLoop or None
        As the checker derived it.
    """
    try:
        loop = checked_loop(
            problem, certificate.states, certificate.evidence,
            continuous=certificate.continuous, pieces=pieces,
        )  # fmt: skip
    except (LoopProofError, KeyError) as error:
        return (f"{error}" if isinstance(error, LoopProofError) else f"it lacks {error}"), {}, None
    p = certificate.p
    against = refutation(loop, p, certificate.multipliers, certificate.rate)
    if against:
        return against, {}, loop
    level = Fraction(0)
    claim = certificate.claim
    if claim.start or claim.output:
        try:
            level = max(_at_most(loop, p, vertex) for vertex in start_vertices(problem, loop))
        except LoopProofError as error:
            return str(error), {}, loop
        if level > 1:
            return "its region does not contain the whole start", {}, loop
    reach = reach_of(loop, Fraction(1), p)
    facts: dict[str, Any] = {
        "region": {
            name: (float(loop.rest[name]) - half, float(loop.rest[name]) + half)
            for name, half in reach.items()
        },
        "start_region": _along_alone(problem, loop, p),
        "rest": _plain(loop.rest),
        "fall": float(certificate.rate),
        "continuous": certificate.continuous,
        "uncertain": loop.words,
    }
    if claim.output:
        # Without its own starts a claim is of all starts in the region, as the verdict says.
        against = _outside(problem, loop, certificate, level if claim.start else Fraction(1))
    return against, facts, loop


def _at_most(loop: CheckedLoop, p: Sequence[Sequence[Fraction]], z: Sequence[Fraction]) -> Fraction:
    """Return V at most, where the rest is known except for its doubt."""
    check_time()
    doubt = [loop.doubt[name] for name in loop.names]
    total = quadratic_at(p, z)
    if any(doubt):
        # (z + d)ᵀ P (z + d) ≤ zᵀPz + 2 |Pz|ᵀ |d| + |d|ᵀ |P| |d|, with |d| at most the doubt.
        slope = [abs(sum((w * x for w, x in zip(row, z, strict=True)), Fraction(0))) for row in p]
        sizes = [[abs(w) for w in row] for row in p]
        total += 2 * sum((s * r for s, r in zip(slope, doubt, strict=True)), Fraction(0))
        total += quadratic_at(sizes, doubt)
    return total


def quadratic_at(p: Sequence[Sequence[Fraction]], z: Sequence[Fraction]) -> Fraction:
    """Return zᵀ P z."""
    return sum(
        (x * weight * y for x, row in zip(z, p, strict=True) if x
         for weight, y in zip(row, z, strict=True)),
        Fraction(0),
    )  # fmt: skip


def start_vertices(problem: LoopProblem, loop: CheckedLoop) -> list[tuple[Fraction, ...]]:
    """Return the corners of the start, as deviations from rest; memory as it is at the start."""
    ends = [
        tuple(
            dict.fromkeys((Fraction(problem.start[name].low), Fraction(problem.start[name].high)))
        )
        for name in problem.states
    ]
    # V is convex, so its largest value over a box of starts is at a corner; 2ⁿ of them are tried.
    if 2 ** sum(len(end) > 1 for end in ends) > 4096:
        raise LoopProofError("a start of more than 12 intervals")
    return [
        _with_memory(loop, dict(zip(problem.states, corner, strict=True)))
        for corner in product(*ends)
    ]


def _with_memory(loop: CheckedLoop, states: Mapping[str, Fraction]) -> tuple[Fraction, ...]:
    """Return z of the moment before the first period, of states of the plant."""
    values = []
    for name in loop.names:
        if name in states:
            value = states[name]
        elif name in loop.seeds:
            constant, parts = loop.seeds[name]
            value = constant + sum(
                (w * (states[of] - loop.rest[of]) for of, w in parts.items()), Fraction(0)
            )
        elif name in loop.begin:
            value = loop.begin[name]
        else:
            raise LoopProofError(f"'{name}' has a start of its own")
        values.append(value - loop.rest[name])
    return tuple(values)


def has_known_start(problem: LoopProblem, loop: CheckedLoop) -> bool:
    """Tell whether states of the plant say what all memory starts as.

    What a `rate of` holds before its first sample is not a function of them.
    """
    return not set(loop.names) - {*problem.states, *loop.seeds, *loop.begin}


def start_quadric(
    problem: LoopProblem, loop: CheckedLoop, p: Sequence[Sequence[Fraction]], states: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Return Q, l, c with V - 1 = xᵀQx + l x + c where some states start x away from rest.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    loop : CheckedLoop
        As the checker derived it.
    p : rows of Fraction
        Of V.
    states : sequence of int
        Which states of the plant; the others begin at rest, the memory as it does.
    """
    names = problem.states
    rest = {name: loop.rest[name] for name in names}
    base = np.array([float(x) for x in _with_memory(loop, rest)])
    ways = []
    for k in states:
        # The way from a state to z is affine: one column of it for each unit step.
        shifted = {**rest, names[k]: rest[names[k]] + 1}
        ways.append(np.array([float(x) for x in _with_memory(loop, shifted)]) - base)
    way, plain = np.array(ways), np.array([[float(x) for x in row] for row in p])
    return way @ plain @ way.T, 2.0 * way @ plain @ base, float(base @ plain @ base) - 1.0


def _along_alone(
    problem: LoopProblem, loop: CheckedLoop, p: Sequence[Sequence[Fraction]]
) -> dict[str, float]:
    """Return how far the loop may start along each state, the memory as it is at the start."""
    values: dict[str, float] = {}
    if not has_known_start(problem, loop):
        return values
    for k, name in enumerate(problem.states):
        quadratic, linear, c = start_quadric(problem, loop, p, (k,))
        a, b = float(quadratic[0, 0]), float(linear[0])
        # V = 1 along one state is a quadratic; the smaller root bounds both directions.
        inside = b * b - 4.0 * a * c
        if c < 0.0 and inside >= 0.0:
            values[name] = min(
                (-b + math.sqrt(inside)) / (2 * a), (b + math.sqrt(inside)) / (2 * a)
            )
    return values


def reach_of(
    loop: CheckedLoop, level: Fraction, p: Sequence[Sequence[Fraction]]
) -> dict[str, float]:
    """Return how far each state is from rest at most where V is at most a level."""
    inverse = np.linalg.inv(np.array([[float(x) for x in row] for row in p]))
    values = {}
    for k, name in enumerate(loop.names):
        row = tuple(Fraction(int(i == k)) for i in range(loop.size))
        values[name] = _farthest(p, inverse, row, level)
    return values


def _farthest(
    p: Sequence[Sequence[Fraction]],
    inverse: NDArray[np.float64],
    row: Sequence[Fraction],
    level: Fraction,
) -> float:
    """Return what |g z| cannot exceed where V is at most a level; infinite: that is not known."""
    if not level or not any(row):
        return 0.0
    g = np.array([float(x) for x in row])
    # max of |g z| where zᵀPz ≤ level, √(level gᵀP⁻¹g), in floats; a little more is then checked
    # exactly, and the first that holds is taken.
    half = math.sqrt(float(level) * max(float(g @ inverse @ g), 0.0))
    for wider in (1.0 + 1e-9, 1.0 + 1e-6, 1.01, 2.0) if math.isfinite(half) else ():
        if is_inside(p, row, Fraction(half * wider), level):
            return half * wider
    return math.inf


def port_within(
    problem: LoopProblem,
    loop: CheckedLoop,
    p: Sequence[Sequence[Fraction]],
    level: Fraction,
    port: str,
) -> RationalInterval:
    """Return where an output or a drive can be, from a sample with V at most a level to the next.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    loop : CheckedLoop
        As the checker derived it.
    p : rows of Fraction
        Of V.
    level : Fraction
        From 0 to 1.
    port : str
        Of the plant.

    Raises
    ------
    LoopProofError
        If it has no bound there.
    """
    address = problem.site.interface.port(port)
    if address in loop.drives:
        return _drive_within(loop, p, level, address)
    reach = reach_of(loop, level, p)
    if any(math.isinf(half) for half in reach.values()):
        raise LoopProofError("its region has no bounds")
    return output_between_samples(problem, loop.within(reach), port)


def _drive_within(
    loop: CheckedLoop, p: Sequence[Sequence[Fraction]], level: Fraction, address: Address
) -> RationalInterval:
    """Return where a drive can be: it is held between samples, so those are all of its values."""
    inverse = np.linalg.inv(np.array([[float(x) for x in row] for row in p]))
    half = max(_farthest(p, inverse, row, level) for row in loop.rows_of_drive(address))
    if math.isinf(half):
        raise LoopProofError("its region has no bounds")
    line, far = loop.drives[address], Fraction(half)
    low, high = line.rest.low - far, line.rest.high + far
    return RationalInterval(
        low if line.low is None else max(low, line.low),
        high if line.high is None else min(high, line.high),
    )


def _outside(
    problem: LoopProblem, loop: CheckedLoop, certificate: Certificate, level: Fraction
) -> str:
    """Return why an output may leave the claimed interval in the claimed time; empty: it cannot."""
    claim = certificate.claim
    if certificate.continuous:
        return "a claim about an output is proved of the sampled loop"
    periods = claimed_in(problem, claim).first
    remainder = power_up(1 - certificate.rate, periods) * level
    try:
        span = port_within(problem, loop, certificate.p, remainder, claim.output)
    except LoopProofError as error:
        return str(error)
    low, high = below(span.low), above(span.high)
    if Fraction(claim.low) <= span.low and span.high <= Fraction(claim.high):
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
