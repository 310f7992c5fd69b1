r"""From interval type-2 sets to a number, as defuzzifiers of the kernel.

The set comprises all memberships μ between a lower one L and an upper one U. Their centroids fill
an interval. Its right end belongs to the μ that is L on the left of some c and U on the right of
it, and c is that centroid (Karnik and Mendel). With

    φ(c) = (∫_{y<c} y L + ∫_{y>c} y U) / (∫_{y<c} L + ∫_{y>c} U)

no φ(c) exceeds the end, and for c below it φ(c) is nearer: c ← φ(c) converges monotonically and
quadratically (it is Newton's iteration for the root of F in :mod:`.centroid_bounds`, which has the
same bounds over arrays of panels, for proofs). The left end is the mirrored case. Over samples, and
over the values of Takagi and Sugeno, integrals are sums and the steps are finite. Nie and Tan take
the centroid of (L + U) / 2.

Where L is 0 everywhere, the ends are those of the support of U, the limit for a vanishing L.

The kernel has computed the strengths of both readings of the rules; each consequent has its side: 0
for the upper set, 1 for the lower one. Each side is represented as in the defuzzifiers of type 1:
samples, envelopes of straight sets, integrals of curved ones.

Every defuzzifier returns a number above 0 if there is a value, and the value: the end selected by
the last of the output's floats, -1 the left one, 1 the right one, 0 their combination. Nie and
Tan's return area and moment.

References
----------
N. N. Karnik, J. M. Mendel, *Centroid of a type-2 fuzzy set*, 2001.
M. Nie, W. W. Tan, *Towards an efficient type-reduction method for interval type-2 fuzzy logic
systems*, 2008.
"""

from __future__ import annotations

import math
from typing import Any

from fuzzyarm.inference.block import (
    CHOICE,
    DETAIL,
    FLOATS_AT,
    GROUP_HEAD,
    GROUPS,
    HEIGHTS,
    INPUT_ROWS,
    INPUTS,
    OPERANDS,
    OUTPUT,
    OUTPUT_RANGE,
    RULE_HEAD,
    WIDTH,
    WORK,
    WORK_ROWS,
    parts_of,
)
from fuzzyarm.inference.centroid_kernel import envelop, sample, summed_up
from fuzzyarm.inference.envelope import STEPS, add_up, reach_end
from fuzzyarm.inference.kernel import made_of
from fuzzyarm.inference.quadrature_kernel import integrate
from fuzzyarm.symbolic.kernels import kernel

# Whole numbers of an interval value: its pair, its side, and the indices in f of the lower and the
# upper value: constant, then a coefficient for each input.
PAIR, PAIR_SIDE, LEAST_AT, GREATEST_AT = range(4)

PAIR_ROWS = 4
"""Numbers of a pair in the heap, in rows: least values, greatest ones, lower and upper weights."""


# ── sums ───────────────────────────────────────────────────────────────────────────────


@kernel
def end_of_average(numbers: Any, lower: Any, upper: Any, count: int, sign: float) -> float:
    """Return the greatest (sign 1) or least (-1) average of numbers with interval weights.

    0 where all weights are 0. Plain enough for a compiler.
    """
    total = moment = 0.0
    for i in range(count):
        if upper[i] > 0.0:
            total += lower[i] + upper[i]
            moment += (lower[i] + upper[i]) * numbers[i]
    c = 0.0
    if total > 0.0:
        c = moment / total
    for _ in range(count + 2):
        total = moment = 0.0
        for i in range(count):
            if upper[i] > 0.0:
                weight = upper[i] if sign * (numbers[i] - c) > 0.0 else lower[i]
                total += weight
                moment += weight * numbers[i]
        # If all lower weights are 0 there is no weight beyond c: it is the last number.
        if not total > 0.0:
            break
        if not sign * (moment / total - c) > 0.0:
            break
        c = moment / total
    return c


# ── values ───────────────────────────────────────────────────────────────────────────


# All of Karnik and Mendel's below take the same steps at a point: compute the upper set (side 0)
# and the lower one (side 1), start at the centroid of both, iterate to the requested ends. An end
# costs up to five passes: no end is computed in vain.


@kernel
def karnik_mendel_values(block: Any) -> None:
    """Find the ends of the average of values with interval weights.

    ``k[DETAIL]`` is the number of pairs.
    """
    k, f, scratch, total, moment = parts_of(block)
    width = k[WIDTH]
    pairs = k[k[OUTPUT] + DETAIL]
    heap = scratch[(k[WORK] + WORK_ROWS) * width :]
    least, greatest = heap[:pairs], heap[pairs : 2 * pairs]
    lower, upper = heap[2 * pairs : 3 * pairs], heap[3 * pairs : 4 * pairs]
    for point in range(total.shape[0]):
        # A pair that does not fire keeps weights of 0; its values are then ignored.
        for pair in range(pairs):
            lower[pair] = 0.0
            upper[pair] = 0.0
        at = k[GROUPS] + 1  # k there: number of rules of a group, its consequent, its rules
        strongest = 0.0
        for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
            consequent = k[at + 1]
            at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
            height = scratch[group * width + point]
            pair = k[consequent + PAIR]
            if k[consequent + PAIR_SIDE] == 1:
                lower[pair] = height
            elif height > 0.0:
                upper[pair] = height
                strongest = max(strongest, height)
                # Coefficients are intervals: which bound is the lesser depends on the inputs.
                one = value_of(block, k, f, k[consequent + LEAST_AT], point)
                other = value_of(block, k, f, k[consequent + GREATEST_AT], point)
                least[pair], greatest[pair] = min(one, other), max(one, other)
        for pair in range(pairs):  # rounding may put it above
            lower[pair] = min(lower[pair], upper[pair])
        total[point] = strongest
        if strongest > 0.0:
            moment[point] = value_of_pairs(k, f, heap, pairs)


@kernel
def ends_of_values(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return the greatest weight of a point, and the requested end.

    Of each pair there are four rows: upper and lower weight, and two values.
    """
    pairs = k[k[OUTPUT] + DETAIL]
    lower, upper = heap[2 * pairs : 3 * pairs], heap[3 * pairs : 4 * pairs]
    strongest = value = 0.0
    for pair in range(pairs):
        row = (k[HEIGHTS] + PAIR_ROWS * pair) * k[WIDTH] + point
        high, low = scratch[row], scratch[row + k[WIDTH]]
        one, other = scratch[row + 2 * k[WIDTH]], scratch[row + 3 * k[WIDTH]]
        strongest = max(strongest, high)
        upper[pair], lower[pair] = high, min(low, high)
        heap[pair], heap[pairs + pair] = min(one, other), max(one, other)
    if strongest > 0.0:
        value = value_of_pairs(k, f, heap, pairs)
    return strongest, value


@kernel
def value_of_pairs(k: Any, f: Any, heap: Any, pairs: int) -> float:
    """Return the requested end of an average, from its pairs, see :data:`PAIR_ROWS`."""
    least, greatest = heap[:pairs], heap[pairs : 2 * pairs]
    lower, upper = heap[2 * pairs : 3 * pairs], heap[3 * pairs : 4 * pairs]
    wanted = wanted_end(k, f)
    left = right = 0.0
    if wanted <= 0.0:
        left = end_of_average(least, lower, upper, pairs, -1.0)
    if wanted >= 0.0:
        right = end_of_average(greatest, lower, upper, pairs, 1.0)
    return value_of_ends(k, f, heap, left, right)


@kernel
def wanted_end(k: Any, f: Any) -> float:
    """Return the requested end: -1 the left one, 1 the right one, 0 both."""
    end: float = f[k[k[OUTPUT] + FLOATS_AT] + OUTPUT_RANGE - 1]
    return end


@kernel
def value_of_ends(k: Any, f: Any, heap: Any, left: float, right: float) -> float:
    """Return the requested end, or the value from both: usually their midpoint."""
    end = wanted_end(k, f)
    value = left
    if end > 0.0:
        value = right
    elif end == 0.0:
        value = 0.5 * (left + right)
        if k[k[OUTPUT] + CHOICE] != 0:
            value = made_of(k, heap, left, right, 0.0, 0.0)
    return value


@kernel
def value_of(block: Any, k: Any, f: Any, at: int, point: int) -> float:
    """Return a constant, or a linear form of the inputs, at a point."""
    value: float = f[at]
    for i in range(k[INPUTS]):
        value += f[at + 1 + i] * block[k[INPUT_ROWS] + i * k[WIDTH] + point]
    return value


# ── samples ──────────────────────────────────────────────────────────────────────────


@kernel
def ends_of_samples(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return the greatest height of a point, and the requested end."""
    samples = k[k[OUTPUT] + DETAIL]
    numbers = k[k[OUTPUT] + FLOATS_AT] + OUTPUT_RANGE
    wanted = wanted_end(k, f)
    upper, lower = heap[:samples], heap[samples : 2 * samples]
    cut = heap[2 * samples : 3 * samples]
    first, last = samples, 0  # the nonzero stretch of either set
    for side in range(2):
        # Each side has a stretch of the heap of its own; `cut` is scratch.
        own = heap[side * samples : (side + 1) * samples]
        begin, behind = sample(k, f, scratch, point, side, own, cut)
        first, last = min(first, begin), max(last, behind)
    # A sample weighs as its share of the integral: ends may have half the weight.
    strongest = 0.0
    for i in range(first, last):
        strongest = max(strongest, upper[i])
        upper[i] *= f[numbers + samples + i]
        lower[i] *= f[numbers + samples + i]
    value = 0.0
    if strongest > 0.0:
        here = f[numbers + first : numbers + last]
        high, low = upper[first:last], lower[first:last]
        left = right = 0.0
        if wanted <= 0.0:
            left = end_of_average(here, low, high, last - first, -1.0)
        if wanted >= 0.0:
            right = end_of_average(here, low, high, last - first, 1.0)
        value = value_of_ends(k, f, heap, left, right)
    return strongest, value


@kernel
def nie_tan_samples(block: Any) -> None:
    """Add up the samples of both sets, point by point."""
    k, f, scratch, total, moment = parts_of(block)
    samples = k[k[OUTPUT] + DETAIL]
    numbers = k[k[OUTPUT] + FLOATS_AT] + OUTPUT_RANGE
    positions = f[numbers : numbers + samples]
    weights = f[numbers + samples : numbers + 2 * samples]
    heap = scratch[(k[WORK] + WORK_ROWS) * k[WIDTH] :]
    aggregate, cut = heap[:samples], heap[samples : 2 * samples]
    for point in range(total.shape[0]):
        total[point] = moment[point] = 0.0
        for side in range(2):
            first, last = sample(k, f, scratch, point, side, aggregate, cut)
            area, torque = summed_up(aggregate, positions, weights, first, last)
            total[point] += area
            moment[point] += torque


# ── envelopes of straight sets ───────────────────────────────────────────────────────


@kernel
def ends_of_envelopes(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return the area below both envelopes of a point, and the requested end."""
    numbers = k[k[OUTPUT] + FLOATS_AT]
    wanted = wanted_end(k, f)
    centre = 0.5 * (f[numbers] + f[numbers + 1])
    begin = k[k[OUTPUT] + DETAIL]
    # The upper envelope from `begin` to `middle`, then the lower one up to `behind`.
    middle = behind = begin
    area = torque = lower_area = value = 0.0
    for side in range(2):
        middle, behind = behind, envelop(k, f, scratch, point, side, heap, behind)
        lower_area, more = add_up(heap, middle, behind, centre)
        area, torque = area + lower_area, torque + more
    if area > 0.0:
        start = centre + torque / area  # Nie and Tan's value lies between the ends
        left = right = 0.0
        if wanted <= 0.0:
            left = reach_end(heap, begin, middle, behind, start, centre, lower_area, -1.0)
        if wanted >= 0.0:
            right = reach_end(heap, begin, middle, behind, start, centre, lower_area, 1.0)
        value = value_of_ends(k, f, heap, left, right)
    return area, value


@kernel
def sum_of_envelopes(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return area and moment below both envelopes of a point."""
    numbers = k[k[OUTPUT] + FLOATS_AT]
    centre = 0.5 * (f[numbers] + f[numbers + 1])
    begin = k[k[OUTPUT] + DETAIL]
    behind = begin
    for side in range(2):
        behind = envelop(k, f, scratch, point, side, heap, behind)
    return add_up(heap, begin, behind, centre)


# ── integrals of any sets ────────────────────────────────────────────────────────────


@kernel
def ends_of_integrals(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return the area of both sets of a point, and the requested end."""
    numbers = k[k[OUTPUT] + FLOATS_AT]
    wanted = wanted_end(k, f)
    centre = 0.5 * (f[numbers] + f[numbers + 1])
    infinity = math.inf
    area = torque = lower_area = value = 0.0
    # The upper set, then the lower one, whose area stays in `lower_area`.
    for side in range(2):
        lower_area, more, _, _ = integrate(
            k, f, scratch, heap, point, side, -infinity, infinity, infinity
        )
        area, torque = area + lower_area, torque + more
    if area > 0.0:
        start = centre + torque / area
        left = right = 0.0
        if wanted <= 0.0:
            left = reach_integral(k, f, scratch, heap, point, start, centre, lower_area, -1.0)
        if wanted >= 0.0:
            right = reach_integral(k, f, scratch, heap, point, start, centre, lower_area, 1.0)
        value = value_of_ends(k, f, heap, left, right)
    return area, value


@kernel
def sum_of_integrals(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return area and moment of both sets of a point."""
    # (U + L) / 2 has the centroid of U + L, whose area and moment are sums: no third set.
    infinity = math.inf
    area = torque = 0.0
    for side in range(2):
        a, m, _, _ = integrate(k, f, scratch, heap, point, side, -infinity, infinity, infinity)
        area, torque = area + a, torque + m
    return area, torque


@kernel
def reach_integral(
    k: Any,
    f: Any,
    scratch: Any,
    heap: Any,
    point: int,
    start: float,
    centre: float,
    lower_area: float,
    sign: float,
) -> float:
    """Return an end of the centroid, as :func:`reach_end`."""
    infinity = math.inf
    if not lower_area > 0.0:
        return last_integrated(k, f, scratch, heap, point, sign)
    c = start
    for _ in range(STEPS):
        area = torque = 0.0
        for i in range(2):  # left of c, then right of it
            side = 1 - i if sign > 0.0 else i
            begin, end = c, infinity
            if i == 0:
                begin, end = -infinity, c
            a, m, _, _ = integrate(k, f, scratch, heap, point, side, begin, end, infinity)
            area, torque = area + a, torque + m
        following = centre + torque / area
        if not sign * (following - c) > 0.0:
            break
        c = following
    return c


@kernel
def last_integrated(k: Any, f: Any, scratch: Any, heap: Any, point: int, sign: float) -> float:
    """Return the end of the support of the upper set: of the first or last panel with an area."""
    infinity = math.inf
    # Up to the first panel with an area; for the right end up to the panel where the area is
    # complete, and again from there on while some is left.
    last, wanted = -infinity, (5e-324 if sign < 0.0 else infinity)
    for _ in range(STEPS):
        area, _, x_0, x_1 = integrate(k, f, scratch, heap, point, 0, last, infinity, wanted)
        if sign < 0.0:
            return x_0
        if wanted < infinity:
            last, wanted = x_1, infinity
        elif area > 0.0:
            wanted = area
        else:
            break
    return last
