"""The theorem of a region, checked for a derived loop: V falls, and all bounds hold.

For a symmetric P, multipliers τₖ ≥ 0 and a rate ρ in [0, 1)

1. P > 0;
2. (1 − ρ) V(z) − V(A z + B w) − Σ τₖ (vₖ² − wₖ²) > 0 for all (z, w) ≠ 0; in continuous time
   −2 zᵀP(A z + B w) in place of the difference;
3. V ≤ 1 keeps |g z| ≤ limit for each row of the loop's bounds: [[P, g], [gᵀ, limit²]] > 0.

Then V ≤ 1 is invariant, and every motion from it converges to rest, V falling by a factor 1 − ρ
in each period: within the bounds the matrices describe the loop, and |wₖ| ≤ |vₖ| (S-procedure).

*Cones.* If rule bases have an edge at rest, the state space may be cut into parts by the signs of
some inputs eₖ z of rule bases, in all combinations. Part i has its own matrices Aᵢ z + Bᵢ w, from
slopes on its side alone, and a function Vᵢ = zᵀPᵢz. F stacks its eₖ z, with signs such that none
is negative there, and those of part j at the next sample. For a P, symmetric Nᵢⱼ without a
negative entry, τ ≥ 0 for each i and j, and a growth γ ≥ 1

1. Pᵢ > 0, and Pᵢ ≤ P ≤ γ Pᵢ;
2. (1 − ρ) Vᵢ(z) − Vⱼ(Aᵢ z + Bᵢ w) − Σ τₖ (vₖ² − wₖ²) − FᵀNᵢⱼF > 0 for all (z, w) ≠ 0, all i, j;
   where all Pᵢ are the same, F may be those of part i alone, with one inequality for all j;
3. Vᵢ ≤ 1 keeps |g z| ≤ limit for each row of the loop and of part i.

A run at z in part i is in some part j at the next sample; there |wₖ| ≤ |vₖ| and F ≥ 0, so that
FᵀNF ≥ 0 and Vⱼ < (1 − ρ) Vᵢ. From zᵀPz ≤ 1, where Vᵢ ≤ 1, the functions of all parts stay below
1, so that the bounds hold at all samples, and every motion converges to rest; k periods later zᵀPz
is at most γ (1 − ρ)ᵏ times its start. V need not be continuous where parts meet, since samples
step from one to the other. (M. Johansson and A. Rantzer, "Computation
of piecewise quadratic Lyapunov functions for hybrid systems", *IEEE Transactions on Automatic
Control* 43, 1998, in continuous time; G. Ferrari-Trecate, F. A. Cuzzola, D. Mignone and M. Morari,
"Analysis of discrete-time piecewise affine and hybrid systems", *Automatica* 38, 2002.)
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product as every
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq
from numpy.typing import NDArray

from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.check.certificate import Cone, Fall, RegionProof
from fuzzyarm.proof.check.loop import CheckedLoop, System, checked_loop
from fuzzyarm.proof.check.motion import output_between_samples
from fuzzyarm.proof.check.numbers import (
    ONE,
    ZERO,
    Matrix,
    Number,
    around,
    exact,
    float_above,
    float_below,
    greatest,
    is_positive_definite,
    is_zero,
    least,
    middle,
    precisely,
    product,
    transposed,
)
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in
from fuzzyarm.proof.stop import check_time

Rows = Sequence[Sequence[Number | Fraction]]

ROUNDED = 1e-7
"""Relative width up to which a rest counts as one point, found in floats."""


def _exact(rows: Rows) -> Matrix:
    return [[exact(x) if isinstance(x, Fraction) else x for x in row] for row in rows]


# ── V ────────────────────────────────────────────────────────────────────────────────


def refutation(
    system: System, p: Rows, multipliers: Sequence[Fraction], rate: Fraction = Fraction(0)
) -> str:
    """Return why V does not prove convergence of a system; empty if it does."""
    n, m = system.size, len(system.blocks)
    if len(p) != n or any(len(row) != n for row in p) or len(multipliers) != m:
        return "its matrices are not of the loop's size"
    if any(multiplier < 0 for multiplier in multipliers) or not 0 <= rate < 1:
        return "a multiplier or the rate is out of range"
    if not _is_positive(p):
        return "its matrix is not symmetric and positive definite"
    if not falls(system, p, multipliers, rate):
        return "its function does not fall"
    for row, limit, words in system.rows_within():
        if not is_inside(p, row, limit):
            return f"its region leaves the bounds of {words}"
    return ""


def is_inside(p: Rows, row: Sequence[Number], limit: Number, level: Number = ONE) -> bool:
    """Return whether zᵀPz ≤ level keeps |g z| below a limit."""
    if all(x == 0 for x in row):
        return bool(limit > 0)
    bordered = [*([*line, g] for line, g in zip(_exact(p), row, strict=True))]
    return is_positive_definite([*bordered, [*row, limit * limit / level]])


def falls(system: System, p: Rows, multipliers: Sequence[Fraction], rate: Fraction) -> bool:
    """Return whether V falls along a system, see 2. above."""
    if rate and not system.period:
        return False
    with ctx.workprec(300):
        return is_positive_definite(_fall(system, _exact(p), _exact(p), multipliers, rate))


def _fall(
    system: System, now: Matrix, then: Matrix, multipliers: Sequence[Fraction], rate: Fraction
) -> Matrix:
    """Return the quadratic form over z and w of 2. above, from one function to another."""
    size = system.size + len(system.blocks)
    carried = product(then, system.move)
    if system.period:
        total = product(transposed(system.move), carried)
        total = [[-x for x in row] for row in total]
        share = ONE - exact(rate)
    else:
        total = [[arb(0)] * size for _ in range(size)]
        share = ZERO
    for i in range(system.size):
        for j in range(size):
            if j < system.size:
                total[i][j] += now[i][j] * share
            if not system.period:
                total[i][j] -= carried[i][j]
                total[j][i] -= carried[i][j]
    # Less Σ τ (v² − w²): v is a row over z and w, w one coordinate.
    for k, tau in enumerate(map(exact, multipliers)):
        v = system.blocks[k]
        moved = [j for j in range(size) if not is_zero(v[j])]
        for i in moved:
            for j in moved:
                total[i][j] -= v[i] * v[j] * tau
        total[system.size + k][system.size + k] += tau
    return total


def _is_positive(p: Rows) -> bool:
    """Return whether a matrix is symmetric and positive definite."""
    matrix = _exact(p)
    size = range(len(matrix))
    symmetric = all(matrix[i][j] == matrix[j][i] for i in size for j in range(i))
    return bool(symmetric and is_positive_definite(matrix))


# ── V of cones ───────────────────────────────────────────────────────────────────────

Parts = Sequence[tuple[System, Cone]]
"""Cones with the loop in each."""


def refutation_of_cones(system: System, parts: Parts, region: RegionProof) -> str:
    """Return why the functions of cones do not prove convergence; empty if they do."""
    n, p = system.size, region.p
    square = all(len(m) == n and all(len(row) == n for row in m)
                 for m in (p, *(cone.p for _, cone in parts)))  # fmt: skip
    if not (square and system.period) or region.multipliers:
        return "its matrices are not of the loop's size, or the loop is in continuous time"
    if not 0 <= region.rate < 1 or region.growth < 1:
        return "its rate or its growth is out of range"
    if not _are_all([part for part, _ in parts]):
        return "its cones are not all of the states"
    if not all(map(_is_positive, (p, *(cone.p for _, cone in parts)))):
        return "its matrix is not symmetric and positive definite"
    against = (_outside_of_cone(system, part, cone, region) for part, cone in parts)
    first = next(filter(None, against), "")
    return first or ("" if fall_in_cones(parts, region.rate) else "its function does not fall")


def _outside_of_cone(system: System, part: System, cone: Cone, region: RegionProof) -> str:
    """Return the bound that the function of a cone does not keep; empty if it keeps all."""
    p, growth = region.p, exact(region.growth)
    if cone.p != p and not (_is_above(p, cone.p, ONE) and _is_above(cone.p, p, growth)):
        return "the function of a cone is not between its start and its growth"
    for row, limit, words in (*system.rows_within(), *part.rows_within()):
        if not is_inside(cone.p, row, limit):
            return f"its region leaves the bounds of {words}"
    return ""


def _is_above(larger: Rows, smaller: Rows, factor: Number) -> bool:
    """Return whether one function times a factor is above another."""
    pairs = zip(_exact(larger), _exact(smaller), strict=True)
    return is_positive_definite(
        [[x * factor - y for x, y in zip(*rows, strict=True)] for rows in pairs]
    )


def _are_all(cones: Sequence[System]) -> bool:
    """Return whether cones cover the state space: all combinations of signs."""
    signs_of_cones = []
    for cone in cones:
        signs: dict[tuple[Number, ...], bool] = {}
        for row in cone.sides:
            lead = next((x for x in row if x != 0), None)
            is_plain = all(isinstance(x, fmpq) for x in row) and not any(row[cone.size :])
            if lead is None or not is_plain:
                return False
            signal = tuple(x / lead for x in row[: cone.size])
            if signs.setdefault(signal, lead > 0) != (lead > 0):
                return False
        signs_of_cones.append(signs)
    signals = tuple(signs_of_cones[0]) if signs_of_cones else ()
    if not signs_of_cones or any(set(signs) != set(signals) for signs in signs_of_cones):
        return False
    distinct = {tuple(signs[x] for x in signals) for signs in signs_of_cones}
    return len(distinct) == 1 << len(signals)


def fall_in_cones(parts: Parts, rate: Fraction) -> bool:
    """Return whether V falls from each cone to each, see 2. above."""
    alike = all(cone.p == parts[0][1].p for _, cone in parts)
    for part, cone in parts:
        if len(cone.falls) == 1 and alike:
            goals: list[tuple[System | None, Cone]] = [(None, cone)]
        else:
            goals = list(parts)
        if len(cone.falls) != len(goals):
            return False
        for fall, (into, other) in zip(cone.falls, goals, strict=True):
            if not _falls_into(part, cone.p, into, other.p, fall, rate):
                return False
    return True


def _falls_into(
    part: System, now: Rows, into: System | None, then: Rows, fall: Fall, rate: Fraction
) -> bool:
    """Return whether V falls from a cone into another one, or into any."""
    sides = [list(row) for row in part.sides]
    with ctx.workprec(300):
        if into is not None:
            sides += product([row[: part.size] for row in into.sides], part.move)
        weights = fall.sides
        if len(weights) != len(sides) or any(len(row) != len(sides) for row in weights):
            return False
        symmetric = all(weights[i][j] == weights[j][i] for i in range(len(sides)) for j in range(i))
        signs = [*fall.multipliers, *(x for row in weights for x in row)]
        if len(fall.multipliers) != len(part.blocks) or not symmetric or min(signs, default=0) < 0:
            return False
        total = _fall(part, _exact(now), _exact(then), fall.multipliers, rate)
        more = product(transposed(sides), product(_exact(weights), sides)) if sides else []
        for i, row in enumerate(more):
            for j, x in enumerate(row):
                total[i][j] -= x
        return is_positive_definite(total)


def quadratic_at(p: Rows, z: Sequence[Number]) -> Number:
    """Return zᵀ P z."""
    matrix = _exact(p)
    terms = (x * weight * y for x, row in zip(z, matrix, strict=True)
             for weight, y in zip(row, z, strict=True))  # fmt: skip
    return sum(terms, ZERO)


def decay(rate: Fraction, periods: int) -> Number:
    """Return an upper bound of the factor on V over some periods."""
    return greatest(arb(ONE - exact(rate)) ** periods)


# ── starts ───────────────────────────────────────────────────────────────────────────


def start_vertices(problem: LoopProblem, loop: CheckedLoop) -> list[list[Number]]:
    """Return the corners of the start as deviations from rest, with the initial memory."""
    ends = [
        tuple(dict.fromkeys((exact(problem.start[name].low), exact(problem.start[name].high))))
        for name in problem.states
    ]
    # V is convex, so its maximum over a box of starts is at one of its 2ⁿ corners.
    if 2 ** sum(len(end) > 1 for end in ends) > 4096:
        raise LoopProofError("a start of more than 12 intervals")
    return [
        _with_memory(loop, dict(zip(problem.states, corner, strict=True)))
        for corner in every(*ends)
    ]


def _with_memory(loop: CheckedLoop, states: Mapping[str, Number]) -> list[Number]:
    """Return z just before the first period, from the plant's states."""
    return _first_z(loop, {name: x - loop.rest[name] for name, x in states.items()})


def _first_z(loop: CheckedLoop, away: Mapping[str, Number]) -> list[Number]:
    """Return z just before the first period, from the deviations of the plant's states."""
    z = []
    for name in loop.names:
        if name in away:
            z.append(away[name])
        elif name in loop.seeds:
            constant, parts = loop.seeds[name]
            moved = sum((away[of] * w for of, w in parts.items()), ZERO)
            z.append(constant + moved - loop.rest[name])
        elif name in loop.begin:
            z.append(loop.begin[name] - loop.rest[name])
        else:
            raise LoopProofError(f"'{name}' has a start of its own")
    return z


def has_known_start(problem: LoopProblem, loop: CheckedLoop) -> bool:
    """Return whether the plant's states determine the initial memory.

    The first value of a `rate of` does not depend on them.
    """
    return not set(loop.names) - {*problem.states, *loop.seeds, *loop.begin}


def start_quadric(
    problem: LoopProblem, loop: CheckedLoop, p: Rows, states: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Return Q, l, c with V - 1 = xᵀQx + l x + c for starts of some states x away from rest.

    Other states of the plant begin at rest, the memory at its initial values. For pictures and
    words only.
    """
    names = problem.states
    rest = {name: middle(loop.rest[name]) for name in names}
    base = np.array(_floats(_with_memory(loop, rest)))
    columns = []
    for k in states:
        # The map from states to z is affine: one column for each unit step.
        shifted = {**rest, names[k]: rest[names[k]] + 1}
        columns.append(np.array(_floats(_with_memory(loop, shifted))) - base)
    map_, plain = np.array(columns), np.array([_floats(row) for row in p])
    return map_ @ plain @ map_.T, 2.0 * map_ @ plain @ base, float(base @ plain @ base) - 1.0


def _floats(values: Sequence[Number]) -> list[float]:
    return [float(x) for x in values]


@precisely
def _along_alone(problem: LoopProblem, loop: CheckedLoop, p: Rows) -> dict[str, float]:
    """Return a proved start along each state alone, nearly the largest, with the initial memory."""
    values: dict[str, float] = {}
    # Memory with a fixed initial value has another deviation from each rest.
    if not has_known_start(problem, loop) or set(loop.begin) & set(rests_of(loop)):
        return values
    for k, name in enumerate(problem.states):
        quadratic, linear, c = start_quadric(problem, loop, p, (k,))
        a, b = float(quadratic[0, 0]), float(linear[0])
        # V = 1 along one state is a quadratic; the smaller root bounds both directions.
        inside = b * b - 4.0 * a * c
        if c < 0.0 and inside >= 0.0:
            root = math.sqrt(inside)
            far = min((-b + root) / (2 * a), (b + root) / (2 * a))
            # In floats; a slightly smaller start is then checked exactly, the first that holds.
            starts = (far * share for share in (1.0, 1.0 - 1e-12, 1.0 - 1e-9, 1.0 - 1e-6, 0.99))
            proved = next((x for x in starts if _begins_inside(problem, loop, p, name, x)), 0.0)
            values |= {name: proved} if proved > 0.0 else {}
    return values


def _begins_inside(problem: LoopProblem, loop: CheckedLoop, p: Rows, name: str, far: float) -> bool:
    """Return whether starts up to `far` along a state alone are in the region."""
    at_rest = dict.fromkeys(problem.states, ZERO)
    return all(
        greatest(quadratic_at(p, _first_z(loop, {**at_rest, name: exact(end)}))) <= 1
        for end in (far, -far)
    )


# ── reach of a region ────────────────────────────────────────────────────────────────


def reach_of(loop: CheckedLoop, level: Number, p: Rows) -> dict[str, float]:
    """Return the largest deviation of each state on V ≤ level."""
    inverse = np.linalg.inv(np.array([_floats(row) for row in p]))
    rows = [[fmpq(int(i == k)) for i in range(loop.size)] for k in range(loop.size)]
    return {
        name: _farthest(p, inverse, row, level) for name, row in zip(loop.names, rows, strict=True)
    }


def _farthest(p: Rows, inverse: NDArray[np.float64], row: Sequence[Number], level: Number) -> float:
    """Return an upper bound of |g z| on V ≤ level; infinite if unknown."""
    if level == 0 or all(x == 0 for x in row):
        return 0.0
    g = np.array(_floats(row))
    # max |g z| on zᵀPz ≤ level is √(level gᵀP⁻¹g), here in floats; slightly larger bounds are then
    # checked exactly, and the first that holds is returned.
    half = math.sqrt(float(level) * max(float(g @ inverse @ g), 0.0))
    for wider in (1.0 + 1e-9, 1.0 + 1e-6, 1.01, 2.0) if math.isfinite(half) else ():
        if is_inside(p, row, exact(half * wider), level):
            return half * wider
    return math.inf


@precisely
def port_within(
    problem: LoopProblem, loop: CheckedLoop, p: Rows, level: Number, port: str
) -> tuple[Number, Number]:
    """Return the range of an output or drive, from a sample with V ≤ level to the next.

    LoopProofError if it has no bound there.
    """
    address = problem.site.interface.port(port)
    if address in loop.drives:
        return _drive_within(loop, p, level, address)
    reach = reach_of(loop, level, p)
    if any(math.isinf(half) for half in reach.values()):
        raise LoopProofError("its region has no bounds")
    states = {name: around(loop.rest[name], exact(reach[name])) for name in loop.names}
    span = output_between_samples(problem, states, port)
    return least(span), greatest(span)


@precisely
def claimed_within(
    problem: LoopProblem, loop: CheckedLoop, p: Rows, level: Number, claim: LoopClaim
) -> tuple[Number, Number]:
    """Return the range of the claimed output, error or drive, as `port_within`."""
    low, high = port_within(problem, loop, p, level, claim.output)
    if not claim.error:
        return low, high
    reference = exact(problem.set_point[problem.site.interface.port(claim.output)])
    return least(reference - high), greatest(reference - low)


def _drive_within(
    loop: CheckedLoop, p: Rows, level: Number, address: Address
) -> tuple[Number, Number]:
    """Return the range of a drive: held between samples, so its samples are all of its values."""
    inverse = np.linalg.inv(np.array([_floats(row) for row in p]))
    half = max(_farthest(p, inverse, row, level) for row in loop.rows_of_drive(address))
    if math.isinf(half):
        raise LoopProofError("its region has no bounds")
    line = loop.drives[address]
    span = around(line.rest, exact(half))
    low, high = least(span), greatest(span)
    low = line.low if line.low is not None and line.low >= low else low
    return low, line.high if line.high is not None and line.high <= high else high


# ── a certified region ───────────────────────────────────────────────────────────────


@precisely
def accepted(
    problem: LoopProblem, region: RegionProof, surfaces: RuleSurfaces | None = None
) -> CheckedLoop:
    """Return the loop around its rest for a proved region; LoopProofError for any other."""
    try:
        loop = checked_loop(
            problem, region.states, region.evidence,
            continuous=region.continuous, surfaces=surfaces,
        )  # fmt: skip
    except (KeyError, IndexError) as error:
        raise LoopProofError(f"it lacks {error}") from error
    against = region_refutation(problem, loop, region, surfaces)
    if against:
        raise LoopProofError(against)
    return loop


@precisely
def region_refutation(
    problem: LoopProblem, loop: CheckedLoop, region: RegionProof,
    surfaces: RuleSurfaces | None = None,
) -> str:  # fmt: skip
    """Return why a region of a derived loop is not proved; empty if it is."""
    if not region.cones:
        if region.growth != 1:
            return "it grows without cones"
        return refutation(loop, region.p, region.multipliers, region.rate)
    return refutation_of_cones(loop, parts_of(problem, region, surfaces), region)


@precisely
def parts_of(
    problem: LoopProblem, region: RegionProof, surfaces: RuleSurfaces | None = None
) -> Parts:
    """Return the loop in each cone of a region."""
    if region.continuous:
        raise LoopProofError("in continuous time there are no cones")
    return [
        (
            checked_loop(
                problem, region.states, replace(region.evidence, gains=cone.gains),
                surfaces=surfaces, in_cone=True,
            ),
            cone,
        )
        for cone in region.cones
    ]  # fmt: skip


@precisely
def verified(
    problem: LoopProblem, claim: LoopClaim, region: RegionProof,
    surfaces: RuleSurfaces | None = None,
) -> tuple[str, dict[str, Any], CheckedLoop | None]:  # fmt: skip
    """Return why a region does not prove a claim (empty: it does), facts of the verdict, loop."""
    try:
        loop = accepted(problem, region, surfaces)
        level = _level_of_starts(problem, loop, region.p) if claim.start or claim.output else ZERO
    except LoopProofError as error:
        return str(error), {}, None
    facts = region_facts(problem, loop, region)
    against = ""
    if claim.output:
        # A claim without starts covers all starts in the region, as the verdict says.
        against = outside(problem, loop, claim, region, level if claim.start else ONE)
    return against, facts, loop


def _level_of_starts(problem: LoopProblem, loop: CheckedLoop, p: Rows) -> Number:
    """Return the largest V at the starts; LoopProofError if the region misses some."""
    level = arb(0)
    for vertex in start_vertices(problem, loop):
        check_time()
        level = level.max(greatest(arb(quadratic_at(p, vertex)))).upper()
    if not level <= 1:
        raise LoopProofError("its region does not contain the whole start")
    return level


def region_facts(problem: LoopProblem, loop: CheckedLoop, region: RegionProof) -> dict[str, Any]:
    """Return the facts of a region for a verdict."""
    starts, rests = where_states_are(problem, loop, region, ONE), rests_of(loop)
    for name in set(starts) - set(rests):  # for all points of its ball
        low, high = starts[name]
        width = float_above(greatest(loop.rest[name]) - least(loop.rest[name]))
        starts[name] = low + width, high - width
    return {
        "region": starts,
        "start_region": _along_alone(problem, loop, region.p),
        "rest": {name: float(loop.rest[name]) for name in loop.names},
        "rests": rests,
        "fall": float(region.rate),
        "continuous": region.continuous,
        "uncertain": loop.words,
    }


def where_states_are(
    problem: LoopProblem, loop: CheckedLoop, region: RegionProof, level: Number
) -> dict[str, tuple[float, float]]:
    """Return bounds of the states for zᵀPz ≤ level; γ covers all runs from zᵀPz ≤ 1."""
    reach = {}
    for name, half in reach_of(loop, level, region.p).items():
        rest = loop.rest[name]
        low, high = _limits(problem, region.evidence.memory.get(name, ""))
        if math.isfinite(half):
            low = max(low, float_below(least(rest) - exact(half)))
            high = min(high, float_above(greatest(rest) + exact(half)))
        reach[name] = low, high
    return reach


def rests_of(loop: CheckedLoop) -> dict[str, tuple[float, float]]:
    """Return bounds of the rest, for states whose rest depends on parameters."""
    ends = {n: (float_below(x), float_above(x)) for n, x in loop.rest.items()}
    return {n: (a, b) for n, (a, b) in ends.items() if b - a > ROUNDED * max(abs(a), abs(b), 1.0)}


def _limits(problem: LoopProblem, memory: str) -> tuple[float, float]:
    """Return the limits of the actuator in front of a memory."""
    kind, _, cell = memory.partition(":")
    for address, port in problem.site.interface.inputs.items():
        if kind in ("pending", "driven") and ".".join(address) == cell.partition(":")[0]:
            return port.low, port.high
    return -math.inf, math.inf


@precisely
def outside(
    problem: LoopProblem, loop: CheckedLoop, claim: LoopClaim, region: RegionProof, level: Number,
    begun: int = 0,
) -> str:  # fmt: skip
    """Return why an output may leave the claimed interval in the claimed time; empty: it cannot.

    V is at most `level` after `begun` periods.
    """
    if region.continuous:
        return "a claim about an output is proved of the sampled loop"
    periods = max(claimed_in(problem, claim).first - begun, 0)
    try:
        level = greatest(arb(decay(region.rate, periods) * level * exact(region.growth)))
        span = claimed_within(problem, loop, region.p, level, claim)
    except LoopProofError as error:
        return str(error)
    low, high = span
    if exact(claim.low) <= low and high <= exact(claim.high):
        return ""
    when = f" {claim.begin:g} s after the start" if claim.begin else ""
    where = f"{float_below(low):.6g} .. {float_above(high):.6g}{when}"
    return f"{claim.subject} stays in {where}, as far as the region says"
