"""The upper envelope of straight sets, piece by piece: functions over a heap of numbers.

For straight sets without a closed form. One source for machine code and plain Python, so that the
bits are the same.

The heap holds the lines of the cut sets, PIECE numbers each; then their ends, sorted (events); and,
from an index chosen by the caller, the envelope, RUN_OF_LINE numbers for each piece.
"""

from __future__ import annotations

import math
from typing import Any

from fuzzyarm.symbolic.kernels import kernel

PIECE = 4
"""Floats of a straight piece of a set: its two ends, x and height each."""

RUN_OF_LINE = 6
"""Floats of a piece of an envelope: its two ends, the heights there, its area and moment."""

STEPS = 200
"""Most steps to an end of the centroid of interval type-2 sets.

Five suffice, except for a nearly empty lower set.
"""


def heap_size(pieces: int) -> tuple[int, int]:
    """Return the index of the envelope of so many `pieces`, and the greatest possible end.

    Cutting may split a piece in two, and each end is an event. The envelope of n lines has less
    than n log n pieces, usually few more than n.
    """
    begin = 2 * PIECE * pieces + 4 * pieces
    return begin, begin + RUN_OF_LINE * 2 * pieces * max(4, (4 * pieces).bit_length())


# ── lines, and the highest of them ───────────────────────────────────────────────────


@kernel
def cut_pieces(
    pieces: Any, first: int, count: int, height: float, scaled: bool, heap: Any, end: int
) -> int:
    """Append pieces of a set, cut at a height or scaled by it; return the new end of the lines."""
    for piece in range(first, first + PIECE * count, PIECE):
        x_0, y_0, x_1, y_1 = pieces[piece], pieces[piece + 1], pieces[piece + 2], pieces[piece + 3]
        if scaled:
            end = put(heap, end, x_0, height * y_0, x_1, height * y_1)
        elif max(y_0, y_1) <= height:
            end = put(heap, end, x_0, y_0, x_1, y_1)
        elif min(y_0, y_1) >= height:
            end = put(heap, end, x_0, height, x_1, height)
        else:
            # Cut at x: a flank on one side, level at the height on the other.
            x = x_0 + (height - y_0) * (x_1 - x_0) / (y_1 - y_0)
            end = put(heap, end, x_0, min(y_0, height), x, height)
            end = put(heap, end, x, height, x_1, min(y_1, height))
    return end


@kernel
def put(heap: Any, end: int, x_0: float, y_0: float, x_1: float, y_1: float) -> int:
    """Append a piece unless it has no width or no height; return the next index."""
    if x_1 <= x_0 or (y_0 <= 0.0 and y_1 <= 0.0):
        return end
    heap[end] = x_0
    heap[end + 1] = y_0
    heap[end + 2] = x_1
    heap[end + 3] = y_1
    return end + PIECE


@kernel
def insert(heap: Any, events: int, count: int, x: float) -> int:
    """Insert a number into the sorted ones unless it is there; return their number."""
    index = events + count
    while index > events and heap[index - 1] > x:
        index -= 1
    if index > events and heap[index - 1] == x:
        return count
    for other in range(events + count, index, -1):
        heap[other] = heap[other - 1]
    heap[index] = x
    return count + 1


@kernel
def highest(
    heap: Any, events: int, left: float, right: float, past: float
) -> tuple[float, float, float]:
    """Return height and slope of the envelope at `left`, and the end of that line in it.

    From crossing to crossing an upper envelope gets steeper: only lines steeper than `past` count,
    so that rounding at a crossing does not bring the old line back.
    """
    best = 0.0
    steep = 0.0
    for line in range(0, events, PIECE):
        if heap[line] <= left and heap[line + 2] >= right:
            slope = (heap[line + 3] - heap[line + 1]) / (heap[line + 2] - heap[line])
            y = heap[line + 1] + slope * (left - heap[line])
            if slope > past and (y > best or (y == best and slope > steep)):
                best = y
                steep = slope
    until = right
    # It holds until the first steeper line has caught up.
    for line in range(0, events, PIECE):
        if heap[line] <= left and heap[line + 2] >= right:
            slope = (heap[line + 3] - heap[line + 1]) / (heap[line + 2] - heap[line])
            if slope > steep:
                y = heap[line + 1] + slope * (left - heap[line])
                x = left + (best - y) / (slope - steep)
                # A steeper line above it by rounding: an empty piece, the next call takes the
                # steeper one.
                if left <= x < until:
                    until = x
    return best, steep, until


@kernel
def envelope_of(heap: Any, events: int, into: int) -> int:
    """Write the upper envelope of the lines before `events`; return its end in the heap."""
    # Events are the ends of lines: between two of them the same lines hold.
    count = 0
    for line in range(0, events, PIECE):
        count = insert(heap, events, count, heap[line])
        count = insert(heap, events, count, heap[line + 2])
    for event in range(events, events + count - 1):
        left = heap[event]
        slope = -math.inf
        while left < heap[event + 1]:
            best, slope, right = highest(heap, events, left, heap[event + 1], slope)
            run_of = right - left
            last = best + slope * run_of
            heap[into], heap[into + 1] = left, right
            heap[into + 2], heap[into + 3] = best, last
            heap[into + 4] = 0.5 * run_of * (best + last)
            into += RUN_OF_LINE
            left = right
    return into


@kernel
def whole_of(heap: Any, begin: int, end: int) -> tuple[float, float]:
    """Return area and moment about 0 of an envelope."""
    area = torque = 0.0
    for piece in range(begin, end, RUN_OF_LINE):
        left, run_of = heap[piece], heap[piece + 1] - heap[piece]
        best, last, part = heap[piece + 2], heap[piece + 3], heap[piece + 4]
        area += part
        torque += left * part + run_of * run_of * (best + 2.0 * last) / 6.0
    return area, torque


# ── area and moment below and above a position ───────────────────────────────────────
#
# An envelope is a list of pieces in the heap, each RUN_OF_LINE numbers: both ends, the degrees
# there, its area, and its moment about the centre of the range (`add_up`). Moments are about the
# centre, not about 0: far from 0 the difference of ends would cancel.


@kernel
def add_up(heap: Any, begin: int, end: int, centre: float) -> tuple[float, float]:
    """Store the moment of each piece about the centre; return area and moment of all."""
    area = torque = 0.0
    for piece in range(begin, end, RUN_OF_LINE):
        left, run_of = heap[piece], heap[piece + 1] - heap[piece]
        best, last, part = heap[piece + 2], heap[piece + 3], heap[piece + 4]
        # Of a trapezoid with degrees a, b over d from x: (x - c) A + d² (a + 2 b) / 6.
        heap[piece + 5] = (left - centre) * part + run_of * run_of * (best + 2.0 * last) / 6.0
        area += part
        torque += heap[piece + 5]
    return area, torque


@kernel
def reach_end(
    heap: Any,
    begin: int,
    middle: int,
    behind: int,
    start: float,
    centre: float,
    lower_area: float,
    sign: float,
) -> float:
    """Return an end of the centroid: the right one (sign 1) or the left one (-1).

    The upper set is from `begin` to `middle`, the lower one from there to `behind`.
    """
    if not lower_area > 0.0:
        return last_covered(heap, begin, middle, sign)
    # Left of c it is the lower set for the right end, the upper one for the left end.
    one, one_end, other, other_end = middle, behind, begin, middle
    if sign < 0.0:
        one, one_end, other, other_end = begin, middle, middle, behind
    c = start
    for _ in range(STEPS):
        area, torque = before(heap, one, one_end, c, centre)
        more, further = after(heap, other, other_end, c, centre)
        following = centre + (torque + further) / (area + more)  # φ(c)
        # Exact steps approach the end monotonically; one backwards is rounding, and the last.
        if not sign * (following - c) > 0.0:
            break
        c = following
    return c


@kernel
def last_covered(heap: Any, begin: int, end: int, sign: float) -> float:
    """Return the end of the support of a set."""
    # Pieces of height zero may lie on both sides; only an area counts.
    value = 0.0
    covered = False
    for piece in range(begin, end, RUN_OF_LINE):
        if heap[piece + 4] > 0.0:
            if sign > 0.0:
                value = heap[piece + 1]
            elif not covered:
                value = heap[piece]
            covered = True
    return value


# The part before c, and its mirror image. Two functions: each stops at c from its own side and adds
# the piece at c last, an order that fixes the bits.


@kernel
def before(heap: Any, begin: int, end: int, c: float, centre: float) -> tuple[float, float]:
    """Return area and moment of the pieces on the left of a position."""
    area = torque = 0.0
    for piece in range(begin, end, RUN_OF_LINE):
        left, right = heap[piece], heap[piece + 1]
        if left >= c:
            break
        if right <= c:
            area += heap[piece + 4]
            torque += heap[piece + 5]
        else:
            # The part of this piece before c.
            best, run_of = heap[piece + 2], c - left
            last = best + (heap[piece + 3] - best) * (run_of / (right - left))
            part = 0.5 * run_of * (best + last)
            area += part
            torque += (left - centre) * part + run_of * run_of * (best + 2.0 * last) / 6.0
    return area, torque


@kernel
def after(heap: Any, begin: int, end: int, c: float, centre: float) -> tuple[float, float]:
    """Return area and moment of the pieces on the right of a position."""
    area = torque = 0.0
    for piece in range(end - RUN_OF_LINE, begin - 1, -RUN_OF_LINE):
        left, right = heap[piece], heap[piece + 1]
        if right <= c:
            break
        if left >= c:
            area += heap[piece + 4]
            torque += heap[piece + 5]
        else:
            last, run_of = heap[piece + 3], right - c
            best = last + (heap[piece + 2] - last) * (run_of / (right - left))
            part = 0.5 * run_of * (best + last)
            area += part
            torque += (c - centre) * part + run_of * run_of * (best + 2.0 * last) / 6.0
    return area, torque
