"""Maxima, bisectors and joined samples, and computed values: defuzzifiers of the kernel.

Joined samples are scikit-fuzzy's sets: straight lines between N even samples. A set cut at the
strength of its rule gets another point where its line passes that strength; the union is taken at
all these points and joined again. Two sets that cross between two of them are cut off by a chord;
of the result the integrals are exact.

Each works point by point, by a function that :func:`.kernel.point_by_point` calls and that exported
programs contain as well (:mod:`fuzzyarm.exchange.export.walk`).

For a chosen position the row MOMENT holds the value itself, and the row TOTAL any positive number.
(0, 0) means that no rule fires; the caller substitutes the value for that. NaN comes only from an
undefined formula or inverse (strengths are from 0 to 1, divisors positive) and passes through to
:func:`.kernel.settled`.

Arguments of a function at a point:

===========  =================================================================================
``k``        the block as whole numbers: the groups that may fire here (from ``k[GROUPS]`` on),
             and the index of each one's consequent
``f``        its floats: positions and weights of samples, degrees, pieces of sets; positions in
             the unit of the output, degrees without one
``scratch``  the rows: that of a group has the height of its set, at ``point``
``heap``     room for the numbers of one point; each section describes its use
===========  =================================================================================
"""

from __future__ import annotations

import math
from typing import Any

from fuzzyarm.inference.block import (
    AGGREGATION,
    DETAIL,
    FLOATS_AT,
    GROUP_HEAD,
    GROUPS,
    HEIGHTS,
    INPUT_ROWS,
    INPUTS,
    MIN,
    OPERANDS,
    OUTPUT,
    OUTPUT_RANGE,
    RULE_HEAD,
    WIDTH,
    WORK,
    WORK_ROWS,
    parts_of,
)
from fuzzyarm.inference.centroid_kernel import cut_in, sample
from fuzzyarm.inference.envelope import insert
from fuzzyarm.inference.firing_strengths import join
from fuzzyarm.inference.kernel import made_of
from fuzzyarm.inference.maxima import SAME
from fuzzyarm.inference.quadrature import SAME_HALF
from fuzzyarm.inference.type_reduction_kernel import value_of
from fuzzyarm.symbolic.kernels import call, kernel

HALF, NEAREST_HALF, MEAN, FIRST, LAST, SEVERAL, CENTROID, NEAREST = range(8)
"""The requested position of a set: the last float of the output. A bisector of samples at
``midpoints`` is the sample nearest to half of the area; SEVERAL is a value from several positions
of the maximum; the centroid is that of joined samples; the nearest is that to 0. Those by area come
first, for comparisons with `NEAREST_HALF`."""

BISECTIONS = 80
"""Halvings in the search for the position of a level on a curved piece."""

# Whole numbers of a set with a level cut, or of a computed value: the row function of the set, the
# formula or the inverse; its numbers (index, count); pieces of the set (count, index; PIECE floats
# each).
FUNCTION, NUMBERS_AT, NUMBERS, PIECES, PIECES_AT = range(5)

# A set with a level cut also has its implication; the clipping levels (count, index: an offset and
# a factor of the strength each); the index of its greatest degree; and whether it is cut flat at
# the strength, not only above some level.
CUT, LEVELS, LEVELS_AT, TOP_AT, FLAT = range(5, 10)

# Of a value: its kind, and the index of its number: the factor of a formula, the height of the set,
# or the end of the range that a set does not reach.
SORT, OWN_AT = 5, 6
CONSTANT, LINEAR, FORMULA, INVERSE, LEVEL = range(5)

PIECE = 7
"""Floats of a piece: x and degree at its ends; for a curve the ends of its search, and 1 if it
rises or -1 if it falls between them; 0 for a straight piece."""


# ── a choice among positions with heights ────────────────────────────────────────────
#
# Positions ascend. Heights are strengths, samples of the aggregate, or their shares of its
# integral.


@kernel
def chosen_among(
    k: Any, f: Any, heap: Any, positions: Any, heights: Any, count: int, next_to: int
) -> tuple[float, float]:
    """Return the greatest height (0: none) and the requested position.

    Samples are adjacent (1): there is no gap between two. Values are not (0).
    """
    way = way_of(k, f)
    if way == HALF:
        return half_of(positions, heights, count, next_to)
    if way == NEAREST_HALF:
        return nearest_half_of(positions, heights, count)
    return greatest_of(k, f, heap, positions, heights, count)


@kernel
def half_of(positions: Any, heights: Any, count: int, next_to: int) -> tuple[float, float]:
    """Return the total, and the position where the running sum of heights reaches half of it."""
    total = 0.0
    for i in range(count):
        total += heights[i]
    if not total > 0.0:
        return 0.0, 0.0
    # A running sum within rounding of half the total is half of it. If heights of zero follow, all
    # positions up to the next height halve the area, and the middle of that gap is taken; else
    # there is no gap.
    low, high = (0.5 - SAME_HALF) * total, (0.5 + SAME_HALF) * total
    running = 0.0
    first = -1
    for i in range(count):
        running += heights[i]
        if first < 0 and running >= low:
            first = i
        if running >= high:
            last = i - next_to if i == first + 1 else i
            return total, 0.5 * (positions[first] + positions[last])
    return total, positions[count - 1]


@kernel
def nearest_half_of(positions: Any, heights: Any, count: int) -> tuple[float, float]:
    """Return the total, and the position at which the running sum is nearest to half of it."""
    total = 0.0
    for i in range(count):
        total += heights[i]
    if not total > 0.0:
        return 0.0, 0.0
    # Two walks, since the least distance is known only after the first. The sums are formed again
    # in the same order: the same bits.
    nearest = 1.0
    running = 0.0
    for i in range(count):
        running += heights[i]
        nearest = min(nearest, abs(running / total - 0.5))
    # Positions with equal sums are equally near: their mean.
    moment = among = running = 0.0
    for i in range(count):
        running += heights[i]
        if abs(running / total - 0.5) <= nearest + SAME_HALF:
            moment += positions[i]
            among += 1.0
    return total, moment / among


@kernel
def greatest_of(
    k: Any, f: Any, heap: Any, positions: Any, heights: Any, count: int
) -> tuple[float, float]:
    """Return the greatest height, and the value from its positions."""
    greatest = 0.0
    for i in range(count):
        greatest = max(greatest, heights[i])
    # Heights of one plateau may differ in their last bits, as results of different rules.
    enough = greatest * (1.0 - SAME)
    if not enough > 0.0:
        return 0.0, 0.0
    first = last = nearest = moment = among = 0.0
    for i in range(count):
        if heights[i] >= enough:
            last = positions[i]
            if among == 0.0:
                first = nearest = last
                if way_of(k, f) == FIRST:  # the others are not requested
                    break
            if abs(last) < abs(nearest):
                nearest = last
            moment += last
            among += 1.0
    among = max(among, 1.0)
    return greatest, value_of_top(k, f, heap, first, last, moment / among, nearest)


@kernel
def value_of_top(
    k: Any, f: Any, heap: Any, first: float, last: float, mean: float, nearest: float
) -> float:
    """Return the requested value, from the positions of the maximum."""
    way = way_of(k, f)
    value = mean
    if way == FIRST:
        value = first
    elif way == LAST:
        value = last
    elif way == NEAREST:
        value = nearest
    elif way == SEVERAL:
        value = made_of(k, heap, first, last, mean, nearest)
    return value


@kernel
def way_of(k: Any, f: Any) -> int:
    """Return the code of the requested position."""
    return int(f[k[k[OUTPUT] + FLOATS_AT] + OUTPUT_RANGE - 1])


# ── samples ──────────────────────────────────────────────────────────────────────────


@kernel
def position_of_samples(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return the choice among the samples of one point."""
    samples = k[k[OUTPUT] + DETAIL]
    numbers = k[k[OUTPUT] + FLOATS_AT] + OUTPUT_RANGE
    aggregate, cut = heap[:samples], heap[samples : 2 * samples]
    sample(k, f, scratch, point, 0, aggregate, cut)
    if way_of(k, f) <= NEAREST_HALF:  # a sample weighs as its share of the integral
        for i in range(samples):
            aggregate[i] *= f[numbers + samples + i]
    return chosen_among(k, f, heap, f[numbers : numbers + samples], aggregate, samples, 1)


# ── joined samples ───────────────────────────────────────────────────────────────────
#
# The union of the cut sets, joined by straight lines between samples and the corners of cuts
# between them. The trapezoid from (x, y) to (b, z) has
#
#     area    (b - x) (y + z) / 2
#     moment  (b - x) (x (2 y + z) + b (y + 2 z)) / 6   about 0
#
# The heap has four rows of groups + 2 numbers: shares of the way to the next sample, degrees of a
# set there, its cut, heights of the union.


@kernel
def position_of_joined(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return area, and centroid or bisector, of the joined union of one point."""
    area, moment, position = along_joined(k, f, scratch, heap, point, math.inf)
    if not area > 0.0:
        return 0.0, 0.0
    if way_of(k, f) == CENTROID:
        return area, moment / 6.0 / area
    _, _, position = along_joined(k, f, scratch, heap, point, 0.5 * area)
    return area, position


@kernel
def along_joined(
    k: Any, f: Any, scratch: Any, heap: Any, point: int, wanted: float
) -> tuple[float, float, float]:
    """Integrate the joined union up to the area `wanted`; return area, moment, position.

    The moment is about 0 and six times too large.
    """
    samples = k[k[OUTPUT] + DETAIL]
    numbers = k[k[OUTPUT] + FLOATS_AT] + OUTPUT_RANGE
    most = k[k[GROUPS]] + 2
    area = torque = 0.0
    heap[0] = 0.0
    heights_between(k, f, scratch, heap, point, 0, 1, 0)
    x = f[numbers]
    y = heap[3 * most]
    for i in range(samples - 1):
        start, end = f[numbers + i], f[numbers + i + 1]
        inner = crossings_between(k, f, scratch, heap, point, i)
        heights_between(k, f, scratch, heap, point, i, inner + 1, 1)
        for j in range(inner + 1):
            b = end
            if j < inner:
                b = start + heap[j] * (end - start)
            z = heap[3 * most + j]
            part = 0.5 * (b - x) * (y + z)
            if area + part >= wanted:
                return area, torque, x + far_along(b - x, y, z, wanted - area)
            area += part
            torque += (b - x) * (x * (2.0 * y + z) + b * (y + 2.0 * z))
            x = b
            y = z
    return area, torque, x


@kernel
def far_along(width: float, y: float, z: float, area: float) -> float:
    """Return the width from y on, along a line from y to z, that covers an area."""
    if area <= 0.0:
        return 0.0
    slope = (z - y) / width  # a stretch of area has a width
    # The root of y t + slope t² / 2 = area, in the form that takes no difference of near numbers.
    root = math.sqrt(max(0.0, y * y + 2.0 * slope * area))
    return min(width, 2.0 * area / (y + root))


@kernel
def degree_at(k: Any, f: Any, consequent: int, index: int) -> float:
    """Return the degree of a set at a sample; only nonzero ones are stored."""
    degree = 0.0
    if k[consequent] <= index < k[consequent + 1]:
        degree = f[k[consequent + 2] + index - k[consequent]]
    return degree


@kernel
def crossings_between(k: Any, f: Any, scratch: Any, heap: Any, point: int, i: int) -> int:
    """Compute the shares of the way from a sample to the next where cuts have corners."""
    count = 0
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        consequent = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        height = scratch[group * k[WIDTH] + point]
        if height > 0.0 and k[consequent + 3] == MIN:
            y = degree_at(k, f, consequent, i)
            z = degree_at(k, f, consequent, i + 1)
            if (y >= height) != (z >= height):
                share = (height - y) / (z - y)
                if 0.0 < share < 1.0:
                    count = insert(heap, 0, count, share)
    return count


@kernel
def heights_between(
    k: Any, f: Any, scratch: Any, heap: Any, point: int, i: int, count: int, ends: int
) -> None:
    """Compute the heights of the union at shares of the way from a sample to the next.

    `ends`: whether the last of them is the next sample itself. The heap holds the shares, the
    degrees of a set, its cut, and the heights.
    """
    most = k[k[GROUPS]] + 2
    degrees, cut = heap[most : most + count], heap[2 * most : 2 * most + count]
    heights = heap[3 * most : 3 * most + count]
    for j in range(count):
        heights[j] = 0.0
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        consequent = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        height = scratch[group * k[WIDTH] + point]
        if height > 0.0:
            y = degree_at(k, f, consequent, i)
            z = degree_at(k, f, consequent, i + 1)
            for j in range(count):
                degrees[j] = y + heap[j] * (z - y)
            if ends != 0:
                degrees[count - 1] = z
            cut_in(k[consequent + 3], k[k[OUTPUT] + AGGREGATION], height, degrees, heights, cut)


# ── exact maxima ─────────────────────────────────────────────────────────────────────
#
# Two walks over the groups: the first finds the height of the union, the second the intervals of
# all sets of that height. They are few: sorted by insertion, then united in one walk.


HEAP = 2
"""Where intervals begin in the heap: start and end of each, in their order."""


@kernel
def position_of_maxima(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return the greatest height of one point, and the value from its positions."""
    greatest = 0.0
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        consequent = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        height = scratch[group * k[WIDTH] + point]
        if height > 0.0:
            greatest = max(greatest, reached(k, f, heap, consequent, height))
    if not greatest > 0.0:
        return 0.0, 0.0
    count = 0
    # The sets that reach this height, within rounding.
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        consequent = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        height = scratch[group * k[WIDTH] + point]
        if height > 0.0:
            high = reached(k, f, heap, consequent, height)
            if high >= greatest * (1.0 - SAME):
                level = level_of(k, f, consequent, height, high)
                count = cut_at_level(k, f, heap, consequent, level, count)
    if count == 0:
        return 0.0, 0.0
    return greatest, value_of_intervals(k, f, heap, count)


@kernel
def reached(k: Any, f: Any, heap: Any, consequent: int, strength: float) -> float:
    """Return the greatest degree of a set cut at a strength."""
    heap[0], heap[1] = strength, f[k[consequent + TOP_AT]]
    join(k[consequent + CUT], heap[0:1], heap[1:2], heap[0:1])
    height: float = heap[0]
    return height


@kernel
def level_of(k: Any, f: Any, consequent: int, strength: float, height: float) -> float:
    """Return the degree from which on a cut set is at its height."""
    # A set clipped by the strength is at its height from the clipping level on: the strength under
    # min, for other implications the greatest of some lines offset + factor strength. One that is
    # not clipped is so at its top only.
    top: float = f[k[consequent + TOP_AT]]
    level = top
    clips = k[consequent + FLAT] != 0 and height == strength and strength < top
    if clips and k[consequent + LEVELS] > 0:
        level = -math.inf
        for i in range(k[consequent + LEVELS]):
            at = k[consequent + LEVELS_AT] + 2 * i
            level = max(level, f[at] + f[at + 1] * strength)
    return level


@kernel
def cut_at_level(k: Any, f: Any, heap: Any, consequent: int, level: float, count: int) -> int:
    """Insert the intervals where a set is at least at a level; return the new count."""
    for i in range(k[consequent + PIECES]):
        piece = k[consequent + PIECES_AT] + PIECE * i
        left, right = f[piece + 1] >= level, f[piece + 3] >= level
        if left or right:
            start, end = f[piece], f[piece + 2]
            if not (left and right):
                x = passed(k, f, heap, consequent, piece, level)
                if left:
                    end = x
                else:
                    start = x
            count = insert_interval(heap, count, start, end)
    return count


@kernel
def insert_interval(heap: Any, count: int, start: float, end: float) -> int:
    """Insert an interval into the sorted ones; return the new count."""
    at = HEAP + 2 * count
    while at > HEAP and (heap[at - 2] > start or (heap[at - 2] == start and heap[at - 1] > end)):
        heap[at] = heap[at - 2]
        heap[at + 1] = heap[at - 1]
        at -= 2
    heap[at] = start
    heap[at + 1] = end
    return count + 1


@kernel
def passed(k: Any, f: Any, heap: Any, consequent: int, piece: int, level: float) -> float:
    """Return the position where a piece of a set passes a level between its ends."""
    x: float = 0.0
    if f[piece + 1] == level:
        x = f[piece]
    elif f[piece + 3] == level:
        x = f[piece + 2]
    elif f[piece + 6] == 0.0:
        share = (level - f[piece + 1]) / (f[piece + 3] - f[piece + 1])
        x = f[piece] + share * (f[piece + 2] - f[piece])
    else:
        x = passed_by_curve(k, f, heap, consequent, piece, level)
    return x


@kernel
def passed_by_curve(k: Any, f: Any, heap: Any, consequent: int, piece: int, level: float) -> float:
    """Return the position where a curved piece passes a level, by bisection."""
    a: float = f[piece + 4]
    b: float = f[piece + 5]
    rising = f[piece + 6]
    begin = k[consequent + NUMBERS_AT]
    numbers = f[begin : begin + k[consequent + NUMBERS]]
    for _ in range(BISECTIONS):
        middle = 0.5 * (a + b)
        if not a < middle < b:  # neighbouring floats: no nearer one exists
            break
        heap[0] = middle
        call(k[consequent + FUNCTION], heap[0:1], numbers, heap[1:2])
        if (heap[1] < level) == (rising > 0.0):
            a = middle
        else:
            b = middle
    return 0.5 * (a + b)


@kernel
def value_of_intervals(k: Any, f: Any, heap: Any, count: int) -> float:
    """Return the value from sorted intervals; the mean is that of points if all are points."""
    first: float = heap[HEAP]
    last: float = heap[HEAP + 1]
    # A shared stretch counts once: of each interval only the part beyond `reach`, the end of those
    # before it.
    reach = first
    length = moment = 0.0
    nearest = math.inf
    for i in range(count):
        begin = max(heap[HEAP + 2 * i], reach)
        end = heap[HEAP + 2 * i + 1]
        last = max(last, end)
        inner = 0.0  # the position of this interval nearest to 0
        if heap[HEAP + 2 * i] > 0.0:
            inner = heap[HEAP + 2 * i]
        elif end < 0.0:
            inner = end
        if abs(inner) < abs(nearest):
            nearest = inner
        if end > begin:
            length += end - begin
            moment += (end - begin) * 0.5 * (begin + end)
            reach = end
    if not length > 0.0:
        for i in range(count):
            if i == 0 or heap[HEAP + 2 * i] != heap[HEAP + 2 * i - 2]:
                moment += heap[HEAP + 2 * i]
                length += 1.0
    return value_of_top(k, f, heap, first, last, moment / length, nearest)


# ── computed values ──────────────────────────────────────────────────────────────────
#
# Each consequent has a value: a number, a linear or another function of the inputs, or (Tsukamoto)
# the position at which the degree of its set is the firing strength. Point by point, not row by
# row: the kind of value differs from group to group and may need a search.


@kernel
def weighted_values(block: Any) -> None:
    """Add up strengths, and strengths times computed values, point by point."""
    k, f, scratch, total, moment = parts_of(block)
    heap = scratch[(k[WORK] + WORK_ROWS) * k[WIDTH] :]
    for point in range(total.shape[0]):
        whole = turn = 0.0
        at = k[GROUPS] + 1
        for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
            consequent = k[at + 1]
            at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
            strength = scratch[group * k[WIDTH] + point]
            if strength > 0.0:
                whole += strength
                turn += strength * found_value(block, k, f, heap, consequent, strength, point)
        total[point], moment[point] = whole, turn


@kernel
def position_of_values(block: Any) -> None:
    """Choose among values by their strengths, point by point."""
    k, f, scratch, total, moment = parts_of(block)
    heap = scratch[(k[WORK] + WORK_ROWS) * k[WIDTH] :]
    groups = k[k[GROUPS]]
    begin = HEAP + k[INPUTS]
    values, heights = heap[begin : begin + groups], heap[begin + groups : begin + 2 * groups]
    for point in range(total.shape[0]):
        count = 0
        at = k[GROUPS] + 1
        for group in range(k[HEIGHTS], k[HEIGHTS] + groups):
            consequent = k[at + 1]
            at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
            strength = scratch[group * k[WIDTH] + point]
            if strength > 0.0:
                value = found_value(block, k, f, heap, consequent, strength, point)
                count = insert_value(values, heights, count, value, strength)
        total[point], moment[point] = chosen_among(k, f, heap, values, heights, count, 0)


@kernel
def choice_of_values(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return the choice among the values of a point: strength and value by turns."""
    groups = k[k[GROUPS]]
    values, heights = heap[:groups], heap[groups : 2 * groups]
    count = 0
    for group in range(groups):
        row = (k[HEIGHTS] + 2 * group) * k[WIDTH] + point
        if scratch[row] > 0.0:
            count = insert_value(values, heights, count, scratch[row + k[WIDTH]], scratch[row])
    return chosen_among(k, f, heap, values, heights, count, 0)


@kernel
def insert_value(values: Any, heights: Any, count: int, value: float, height: float) -> int:
    """Insert a value with its height, in ascending order; return the new count."""
    index = count
    while index > 0 and values[index - 1] > value:
        values[index] = values[index - 1]
        heights[index] = heights[index - 1]
        index -= 1
    values[index] = value
    heights[index] = height
    return count + 1


@kernel
def found_value(
    block: Any, k: Any, f: Any, heap: Any, consequent: int, strength: float, point: int
) -> float:
    """Return the representative number of a consequent at a point and a strength."""
    sort, own = k[consequent + SORT], k[consequent + OWN_AT]
    value: float = f[own]
    if sort == LINEAR:
        value = value_of(block, k, f, own, point)
    elif sort == FORMULA:
        inputs = heap[HEAP : HEAP + k[INPUTS]]
        for i in range(k[INPUTS]):
            inputs[i] = block[k[INPUT_ROWS] + i * k[WIDTH] + point]
        heap[0] = strength
        call(k[consequent + FUNCTION], heap[0:1], inputs, heap[1:2])
        value = value * heap[1]
    elif sort == INVERSE:
        begin = k[consequent + NUMBERS_AT]
        numbers = f[begin : begin + k[consequent + NUMBERS]]
        heap[0] = min(1.0, strength / value)  # its number is the height of the set
        call(k[consequent + FUNCTION], heap[0:1], numbers, heap[1:2])
        value = heap[1]
        if not abs(value) < math.inf:  # an end that the set only approaches
            range_at = k[k[OUTPUT] + FLOATS_AT]
            value = f[range_at + 1] if value > 0.0 else f[range_at]
    elif sort == LEVEL:
        value = position_at_level(k, f, heap, consequent, strength)
    return value


@kernel
def position_at_level(k: Any, f: Any, heap: Any, consequent: int, level: float) -> float:
    """Return the position where a monotone set reaches a level; its pieces rise."""
    # Without such a position: the end of the range that the set only approaches.
    position: float = f[k[consequent + OWN_AT]]
    for i in range(k[consequent + PIECES]):
        piece = k[consequent + PIECES_AT] + PIECE * i
        start, first, last = f[piece], f[piece + 1], f[piece + 3]
        if first >= level:
            position = start
            break
        if last >= level:
            if f[piece + 6] != 0.0:
                return passed_by_curve(k, f, heap, consequent, piece, level)
            position = start + (f[piece + 2] - start) * (level - first) / (last - first)
            break
    return position
