"""The exact centroid of curved sets, and any exact bisector, as defuzzifiers of the kernel.

The adaptive quadrature of :mod:`fuzzyarm.inference.quadrature`, in a fixed order, so that compiled
and interpreted bits agree. Point by point: every point has panels of its own. A panel's eight nodes
are a row, over which each set is evaluated by the row function of its shape, cut, and folded into
the aggregate.

Behind the work rows, in the order of memory::

    nodes, degrees, cut, aggregate     eight each
    strengths                          of the members: only under `max` is there one for each
    edges                              of the panels, ascending
    panels                             a stack: x0, x1, area, moment, halvings left
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
    OPERANDS,
    OUTPUT,
    RULE_HEAD,
    WIDTH,
)
from fuzzyarm.inference.centroid_kernel import cut_in
from fuzzyarm.inference.envelope import insert
from fuzzyarm.inference.quadrature import HALVINGS, SAME_HALF
from fuzzyarm.inference.sets import BELOW_ONE
from fuzzyarm.symbolic.kernels import call, kernel

# Whole numbers of an output, from k[DETAIL] on: its constants in f, its number of members, the
# edges at which sets may bend (count, index in f), and the stretches over which two straight sets
# may cross (count, index in k).
CONSTANTS_AT, MEMBERS, EDGES, EDGES_AT, STRETCHES, STRETCHES_AT = range(6)

# Its constants: those of the quadrature, and whether rounding errors are independent of the
# strengths.
TOLERANCE, DEEPEST, MOST_PANELS, ROUNDING, SUBTRACTS, NODES = range(6)
WEIGHTS = NODES + 4
CONSTANTS = WEIGHTS + 4

# Whole numbers of a consequent: the row function of its set and its numbers; its implication; its
# member; sloping straight pieces; their clipping levels, as (offset, factor of the strength); the
# lines of an implied piece, four numbers each; its side: 0, or 1 for the lower set of an interval
# type-2 set; and, under an implication that leaves ones only, the stretches where the set is 1, two
# numbers each (-1: it leaves more).
CURVE, NUMBERS_AT, NUMBERS, IMPLICATION, MEMBER, PIECES, PIECES_AT = range(7)
CLIPS, CLIPS_AT, LINES, LINES_AT, SIDE, FLATS, FLATS_AT = range(7, 14)
LINE_NUMBERS = 4

# Whole numbers of a stretch: its two consequents, and the index in f of its six numbers.
STRETCH = 3

PANEL = 5
ROW = 8


@kernel
def integral_of_point(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return area and moment of the aggregate of a point."""
    area, torque, _, _ = integrate_all(k, f, scratch, heap, point, math.inf)
    return area, torque


@kernel
def bisector_of_point(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return the area, and its bisector: the middle of a stretch without area.

    One pass over the panels for the area, one more for each end of that stretch, up to the panel
    where the sum reaches the share, which is then bisected.
    """
    area, _, _, _ = integrate_all(k, f, scratch, heap, point, math.inf)
    middle = 0.0
    if area > 0.0:
        middle = reach(k, f, scratch, heap, point, (0.5 - SAME_HALF) * area)
        middle = 0.5 * (middle + reach(k, f, scratch, heap, point, (0.5 + SAME_HALF) * area))
    return area, middle


@kernel
def reach(k: Any, f: Any, scratch: Any, heap: Any, point: int, wanted: float) -> float:
    """Return the position where the area from the left end reaches a number."""
    before, _, x_0, x_1 = integrate_all(k, f, scratch, heap, point, wanted)
    # The panel in which the sum reaches it, bisected: the aggregate has no formula.
    a, b = x_0, x_1
    if x_0 < x_1:
        for _ in range(HALVINGS):
            middle = 0.5 * (a + b)
            if integral(k, f, scratch, heap, point, 0, x_0, middle, 0.0)[0] < wanted - before:
                a = middle
            else:
                b = middle
    return 0.5 * (a + b)


@kernel
def integrate_all(
    k: Any, f: Any, scratch: Any, heap: Any, point: int, wanted: float
) -> tuple[float, float, float, float]:
    """Integrate a set of type 1, all on side 0, over the whole range."""
    return integrate(k, f, scratch, heap, point, 0, -math.inf, math.inf, wanted)


@kernel
def integrate(
    k: Any,
    f: Any,
    scratch: Any,
    heap: Any,
    point: int,
    side: int,
    start: float,
    end: float,
    wanted: float,
) -> tuple[float, float, float, float]:
    """Cut a stretch of the range into initial panels and halve them, see :func:`halve`.

    Of the sets of one side; moments are about the centre of the whole range.
    """
    head = k[OUTPUT]
    detail = k[head + DETAIL]
    members = k[detail + MEMBERS]
    low, high = f[k[head + FLOATS_AT]], f[k[head + FLOATS_AT] + 1]
    constants = f[k[detail + CONSTANTS_AT] : k[detail + CONSTANTS_AT] + CONSTANTS]
    strengths = heap[4 * ROW : 4 * ROW + members]
    edges = 4 * ROW + members
    count = k[detail + EDGES]
    for edge in range(count):
        heap[edges + edge] = f[k[detail + EDGES_AT] + edge]
    for member in range(members):
        strengths[member] = 0.0
    # At an edge a set or its cut is not smooth: a missed one costs fifty halvings.
    strongest = 0.0
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        consequent = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        height = scratch[group * k[WIDTH] + point]
        if height > 0.0 and k[consequent + SIDE] == side:
            strengths[k[consequent + MEMBER]] = height
            strongest = max(strongest, height)
            count = _clip_edges(k, f, consequent, height, heap, edges, count)
    begin = k[detail + STRETCHES_AT]
    for stretch in range(begin, begin + STRETCH * k[detail + STRETCHES], STRETCH):
        count = cross(k, f, stretch, strengths, heap, edges, count)
    noise = constants[ROUNDING]
    if constants[SUBTRACTS] == 0.0:
        noise *= min(1.0, strongest)
    centre = 0.5 * (low + high)
    if start > low or end < high:
        count = _clip_range(heap, edges, count, max(start, low), min(end, high))
    stack = edges + count
    area = 0.0
    for i in range(count - 1):  # the first panel on top
        panel = stack + PANEL * (count - 2 - i)
        x_0, x_1 = heap[edges + i], heap[edges + i + 1]
        heap[panel], heap[panel + 1] = x_0, x_1
        a, m = integral(k, f, scratch, heap, point, side, x_0, x_1, centre)
        heap[panel + 2], heap[panel + 3] = a, m
        heap[panel + 4] = constants[DEEPEST]
        area += heap[panel + 2]
    return halve(
        k, f, scratch, heap, point, side, stack, count - 1, centre, 0.5 * (high - low), area, noise,
        constants, wanted,
    )  # fmt: skip


@kernel
def _clip_range(heap: Any, edges: int, count: int, start: float, end: float) -> int:
    """Keep the edges inside a stretch, and its ends; return their number."""
    if not start < end:
        return 0
    # In place: the writing index never passes the reading index.
    heap[edges] = start
    kept = 1
    for edge in range(edges, edges + count):
        if start < heap[edge] < end:
            heap[edges + kept] = heap[edge]
            kept += 1
    heap[edges + kept] = end
    return kept + 1


@kernel
def _clip_edges(
    k: Any, f: Any, consequent: int, height: float, heap: Any, edges: int, count: int
) -> int:
    """Add the edges where an implication clips the straight pieces of a set."""
    clips, pieces = k[consequent + CLIPS_AT], k[consequent + PIECES_AT]
    for clip in range(clips, clips + 2 * k[consequent + CLIPS], 2):
        level = f[clip] + f[clip + 1] * height  # the clipping level of this implication
        for piece in range(pieces, pieces + 4 * k[consequent + PIECES], 4):
            x_0, y_0, x_1, y_1 = f[piece], f[piece + 1], f[piece + 2], f[piece + 3]
            if (y_0 - level) * (y_1 - level) < 0.0:
                x = x_0 + (x_1 - x_0) * ((level - y_0) / (y_1 - y_0))
                count = insert(heap, edges, count, x)
    return count


@kernel
def cross(k: Any, f: Any, stretch: int, strengths: Any, heap: Any, edges: int, count: int) -> int:
    """Add the edges where two cut straight sets cross: crossings of two of their lines."""
    one, other = k[stretch], k[stretch + 1]
    first, second = strengths[k[one + MEMBER]], strengths[k[other + MEMBER]]
    if first > 0.0 and second > 0.0:
        at = k[stretch + 2]
        start, end = f[at], f[at + 1]
        for i in range(k[one + LINES]):
            line = k[one + LINES_AT] + LINE_NUMBERS * i
            # An implied line is α + β y of its degree y; both sets have known degrees at the ends
            # of the stretch, and a change of sign of the difference is a crossing.
            alpha = f[line] + f[line + 1] * first
            beta = f[line + 2] + f[line + 3] * first
            for j in range(k[other + LINES]):
                line = k[other + LINES_AT] + LINE_NUMBERS * j
                gamma = f[line] + f[line + 1] * second
                delta = f[line + 2] + f[line + 3] * second
                before = alpha + beta * f[at + 2] - gamma - delta * f[at + 4]
                after = alpha + beta * f[at + 3] - gamma - delta * f[at + 5]
                if before * after < 0.0:
                    x = start + (end - start) * (before / (before - after))
                    count = insert(heap, edges, count, x)
    return count


@kernel
def halve(
    k: Any,
    f: Any,
    scratch: Any,
    heap: Any,
    point: int,
    side: int,
    stack: int,
    panels: int,
    centre: float,
    half_range: float,
    whole: float,
    noise: float,
    constants: Any,
    wanted: float,
) -> tuple[float, float, float, float]:
    """Halve panels until the halves agree with the whole; return area and moment of all.

    Only up to the panel in which the area reaches `wanted`: then the area before it, and its ends.
    Both are the end of the range if it is never reached.
    """
    budget = constants[MOST_PANELS]
    area = torque = x_1 = 0.0
    while panels > 0:
        panels -= 1
        panel = stack + PANEL * panels
        x_0, x_1, a, m = heap[panel], heap[panel + 1], heap[panel + 2], heap[panel + 3]
        depth = heap[panel + 4]
        middle = 0.5 * (x_0 + x_1)
        left_area, left_moment = integral(k, f, scratch, heap, point, side, x_0, middle, centre)
        right_area, right_moment = integral(k, f, scratch, heap, point, side, middle, x_1, centre)
        allowed = constants[TOLERANCE] * (whole + a) + noise * (x_1 - x_0)
        agree = abs(a - left_area - right_area) <= allowed
        if abs(m - left_moment - right_moment) > allowed * half_range:
            agree = False
        budget -= 1.0
        if agree or depth == 0.0 or budget < 0.0:
            if area + (left_area + right_area) >= wanted:
                return area, torque, x_0, x_1
            area += left_area + right_area
            torque += left_moment + right_moment
        else:
            # The left half on top of the stack: sums go from left to right.
            heap[panel], heap[panel + 1] = middle, x_1
            heap[panel + 2], heap[panel + 3] = right_area, right_moment
            heap[panel + 4] = depth - 1.0
            panel += PANEL
            heap[panel], heap[panel + 1] = x_0, middle
            heap[panel + 2], heap[panel + 3] = left_area, left_moment
            heap[panel + 4] = depth - 1.0
            panels += 2
    return area, torque, x_1, x_1


@kernel
def leave_out_peak(k: Any, f: Any, consequent: int, nodes: Any, degrees: Any) -> None:
    """Make a set 1 over stretches only: a peak has no area, but a node may lie on it."""
    for i in range(degrees.shape[0]):
        is_flat = 0
        for j in range(k[consequent + FLATS]):
            at = k[consequent + FLATS_AT] + 2 * j
            if f[at] <= nodes[i] <= f[at + 1]:
                is_flat = 1
        if is_flat == 0:
            degrees[i] = min(degrees[i], BELOW_ONE)


HALF_STEP = 2.0**-53 * (1.0 + 2.0**-52)
SMALLEST_FLOAT = 5e-324


@kernel
def next_float(x: float, way: float) -> float:
    """Return the next float above (way 1) or below (-1).

    S. M. Rump, P. Zimmermann, S. Boldo, G. Melquiond, *Computing predecessor and successor in
    rounding to nearest*, BIT 49 (2009), algorithm 1: arithmetic that every language has.
    """
    return x + way * (HALF_STEP * abs(x) + SMALLEST_FLOAT)


@kernel
def integral(
    k: Any,
    f: Any,
    scratch: Any,
    heap: Any,
    point: int,
    side: int,
    x_0: float,
    x_1: float,
    centre: float,
) -> tuple[float, float]:
    """Return area and moment of the aggregate of a point over one panel, of one side."""
    nodes, degrees = heap[:ROW], heap[ROW : 2 * ROW]
    cut, so_far = heap[2 * ROW : 3 * ROW], heap[3 * ROW : 4 * ROW]
    head = k[OUTPUT]
    constants = k[k[head + DETAIL] + CONSTANTS_AT]
    middle, half = 0.5 * (x_0 + x_1), 0.5 * (x_1 - x_0)
    # Gauss–Lobatto quadrature: six nodes inside, and both ends.
    for i in range(3):
        step = half * f[constants + NODES + i]
        nodes[2 * i], nodes[2 * i + 1] = middle - step, middle + step
    # The ends one float inside: the one-sided value at a vertical edge.
    nodes[6], nodes[7] = next_float(x_0, 1.0), next_float(x_1, -1.0)
    for i in range(ROW):
        so_far[i] = 0.0
    fold = k[head + AGGREGATION]
    width = k[WIDTH]
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        consequent = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        height = scratch[group * width + point]
        if height > 0.0 and k[consequent + SIDE] == side:
            begin = k[consequent + NUMBERS_AT]
            numbers = f[begin : begin + k[consequent + NUMBERS]]
            call(k[consequent + CURVE], nodes, numbers, degrees)
            if k[consequent + FLATS] >= 0:
                leave_out_peak(k, f, consequent, nodes, degrees)
            cut_in(k[consequent + IMPLICATION], fold, height, degrees, so_far, cut)
    area = torque = 0.0
    for i in range(4):
        step, weight = half * f[constants + NODES + i], f[constants + WEIGHTS + i]
        left, right = so_far[2 * i], so_far[2 * i + 1]
        area += weight * (left + right)
        torque += weight * step * (right - left)
    return half * area, half * (torque + (middle - centre) * area)
