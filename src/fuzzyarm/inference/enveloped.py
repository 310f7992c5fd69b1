"""Centroids of the aggregate by samples, and by the upper envelope of straight sets.

Defuzzifiers of the kernel, which add up area and moment: one over samples of the aggregate, one
exactly over its straight pieces. They work behind the work rows and on one point at a time, for
what is written down of one point fits into the nearest cache.
"""

from __future__ import annotations

import math
from typing import Any

from fuzzyarm.inference.kernel import (
    AGGREGATION,
    DETAIL,
    FLOATS_AT,
    GROUP_HEAD,
    GROUPS,
    HEIGHTS,
    MAX,
    MIN,
    OPERANDS,
    OUTPUT,
    OUTPUT_RANGE,
    PRODUCT,
    RULE_HEAD,
    WIDTH,
    WORK,
    WORK_ROWS,
    join,
    parts_of,
)
from fuzzyarm.kernels import kernel


@kernel
def sampled_centroid(block: Any) -> None:
    """Add up the samples of the aggregate, point by point."""
    add_samples(block, 1)


@kernel
def add_samples(block: Any, sides: int) -> None:
    """Add up the samples of the aggregates of so many sides, point by point."""
    k, f, room, total, moment = parts_of(block)
    width = k[WIDTH]
    samples = k[k[OUTPUT] + DETAIL]
    numbers = k[k[OUTPUT] + FLOATS_AT] + OUTPUT_RANGE
    positions = f[numbers : numbers + samples]
    weights = f[numbers + samples : numbers + 2 * samples]
    heap = room[(k[WORK] + WORK_ROWS) * width :]
    aggregate, cut = heap[:samples], heap[samples : 2 * samples]
    # Point by point: all samples of one point fit into the nearest cache, those of many do not.
    for point in range(total.shape[0]):
        area = torque = 0.0  # in registers: a sum in a row waits for its own store
        for side in range(sides):
            first, last = sample(k, f, room, point, side, aggregate, cut)
            for i in range(first, last):
                part = weights[i] * aggregate[i]
                area += part
                torque += part * positions[i]
        total[point] = area
        moment[point] = torque


@kernel
def sample(
    k: Any, f: Any, room: Any, point: int, side: int, aggregate: Any, cut: Any
) -> tuple[int, int]:
    """Write down the samples of the aggregate of a point; return where it is not zero.

    Only of the sets of one side: those of type 1 are all on side 0. A consequent is: first and
    last sample where the set is not zero, its degrees in f, its implication, its side.
    """
    width = k[WIDTH]
    fold = k[k[OUTPUT] + AGGREGATION]
    for i in range(aggregate.shape[0]):
        aggregate[i] = 0.0
    first, last = aggregate.shape[0], 0
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        consequent = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        height = room[group * width + point]
        if height > 0.0 and k[consequent + 4] == side:
            begin, end = k[consequent], k[consequent + 1]
            first, last = min(first, begin), max(last, end)
            degrees = f[k[consequent + 2] : k[consequent + 2] + (end - begin)]
            implication = k[consequent + 3]
            so_far = aggregate[begin:end]
            cut_in(implication, fold, height, degrees, so_far, cut[: end - begin])
    return first, last


PIECE = 4
"""Floats of a straight piece of a set: its two ends, x and height each."""

RUN_OF_LINE = 6
"""Floats of a piece of an envelope: its two ends, the heights there, its area and moment."""


@kernel
def enveloped_centroid(block: Any) -> None:
    """Integrate the upper envelope of cut or scaled sets, piece by piece, point by point.

    For straight sets without a closed form.
    """
    k, f, room, total, moment = parts_of(block)
    width = k[WIDTH]
    heap = room[(k[WORK] + WORK_ROWS) * width :]
    begin = k[k[OUTPUT] + DETAIL]
    for point in range(total.shape[0]):
        area = torque = 0.0
        for piece in range(begin, envelop(k, f, room, point, 0, heap, begin), RUN_OF_LINE):
            left, run_of = heap[piece], heap[piece + 1] - heap[piece]
            best, last, part = heap[piece + 2], heap[piece + 3], heap[piece + 4]
            area += part
            torque += left * part + run_of * run_of * (best + 2.0 * last) / 6.0
        total[point] = area
        moment[point] = torque


@kernel
def envelop(k: Any, f: Any, room: Any, point: int, side: int, heap: Any, into: int) -> int:
    """Write down the upper envelope of the cut sets of one side; return where it ends.

    A consequent is: its pieces (how many, and where they are in f), whether its implication is
    the product rather than the minimum, and its side. In the heap stand the lines, behind them
    where they begin or end, and from `into` on the pieces of envelopes.
    """
    width = k[WIDTH]
    events = 0
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        consequent = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        height = room[group * width + point]
        begin = k[consequent + 1]
        pieces = f[begin : begin + PIECE * k[consequent]]
        if height > 0.0 and k[consequent + 3] == side:
            events = _cut_pieces(pieces, height, k[consequent + 2] != 0, heap, events)
    # Events are where a line begins or ends: between two of them the same lines hold.
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
def _cut_pieces(pieces: Any, height: float, scaled: bool, heap: Any, end: int) -> int:
    """Write the pieces of a set down, cut at a height or scaled by it; return their new end."""
    for piece in range(0, pieces.shape[0], PIECE):
        x_0, y_0, x_1, y_1 = pieces[piece], pieces[piece + 1], pieces[piece + 2], pieces[piece + 3]
        if scaled:
            end = put(heap, end, x_0, height * y_0, x_1, height * y_1)
        elif max(y_0, y_1) <= height:
            end = put(heap, end, x_0, y_0, x_1, y_1)
        elif min(y_0, y_1) >= height:
            end = put(heap, end, x_0, height, x_1, height)
        else:
            x = x_0 + (height - y_0) * (x_1 - x_0) / (y_1 - y_0)
            end = put(heap, end, x_0, min(y_0, height), x, height)
            end = put(heap, end, x, height, x_1, min(y_1, height))
    return end


@kernel
def put(heap: Any, end: int, x_0: float, y_0: float, x_1: float, y_1: float) -> int:
    """Append a piece unless it has no width or no height; return the index behind it."""
    if x_1 <= x_0 or (y_0 <= 0.0 and y_1 <= 0.0):
        return end
    heap[end] = x_0
    heap[end + 1] = y_0
    heap[end + 2] = x_1
    heap[end + 3] = y_1
    return end + PIECE


@kernel
def insert(heap: Any, events: int, count: int, x: float) -> int:
    """Insert a number into the sorted ones unless it is there; return how many there are."""
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
    """Return height and slope of the envelope from `left` on, and up to where they hold.

    From one crossing to the next an envelope of lines gets steeper: only lines steeper
    than `past` count, so that rounding at a crossing does not bring the old line back.
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
    # It holds until the first line that is steeper has caught up.
    for line in range(0, events, PIECE):
        if heap[line] <= left and heap[line + 2] >= right:
            slope = (heap[line + 3] - heap[line + 1]) / (heap[line + 2] - heap[line])
            if slope > steep:
                y = heap[line + 1] + slope * (left - heap[line])
                x = left + (best - y) / (slope - steep)
                # At once where the one above is all but zero: the next call takes the steeper.
                if left <= x < until:
                    until = x
    return best, steep, until


@kernel
def cut_in(implication: int, fold: int, height: float, degrees: Any, so_far: Any, cut: Any) -> None:
    """Cut a set at a height and fold it into the aggregate, over its own stretch of samples."""
    # Adding zero keeps the bits of a height, and has every sample stored: a store only where the
    # new set is higher is a masked one to the vectoriser, which takes many times as long.
    if implication == MIN and fold == MAX:
        for i in range(so_far.shape[0]):
            so_far[i] = max(so_far[i], min(height, degrees[i])) + 0.0
    elif implication == PRODUCT and fold == MAX:
        for i in range(so_far.shape[0]):
            so_far[i] = max(so_far[i], height * degrees[i]) + 0.0
    else:
        for i in range(cut.shape[0]):
            cut[i] = height
        join(implication, cut, degrees, cut)
        join(fold, so_far, cut, so_far)
