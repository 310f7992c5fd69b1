"""Mamdani inference as a kernel: from numbers of inputs to the crisp output.

A rule base is data, a stretch of a flat list that :mod:`fuzzyarm.control.fuzzy_numbers`
writes; another rule base is other data for the same machine code. Only the rules whose
first proposition holds are visited, and only the sets that fired are integrated.
"""

from __future__ import annotations

import math

from fuzzyarm.kernels import kernel

INPUTS, DEGREES, PRODUCT_AND, PRODUCT_THEN, MEMBERS, SAMPLES, SILENT = range(7)
INPUTS_AT, RULES_AT, OUTPUT_AT = range(7, 10)
HEAD = 10
"""Length of the head of a rule base; the places in it are named above."""

INPUT_HEAD = 4
"""Numbers per input: range, count of breaks, where its breaks are (behind them its pieces)."""

LINE = 4
"""Numbers of a straight piece: of an input term (degree, x0, y0, slope), of a set (two ends)."""


@kernel
def inferred(numbers: list[float], at: int, scratch: list[float], cell: int) -> float:
    """Return the crisp output of a rule base.

    Parameters
    ----------
    numbers : sequence of float
        Hold the rule base from index `at` on; all places in it are relative to `at`.
    at : int
        See `numbers`.
    scratch : sequence of float
        From index `cell` on the inputs, in order, and behind them room to work.
    cell : int
        See `scratch`.

    Returns
    -------
    float
        Where no rule fires the number that the rule base names (not a number for an error).
    """
    degrees = cell + int(numbers[at + INPUTS])
    strengths = degrees + int(numbers[at + DEGREES])
    members = int(numbers[at + MEMBERS])
    work = strengths + members
    for place in range(degrees, work):
        scratch[place] = 0.0
    fuzzify(numbers, at, scratch, cell, degrees)
    if not fire(numbers, at, scratch, degrees, strengths):
        return numbers[at + SILENT]
    if numbers[at + SAMPLES] > 0.0:
        return sampled_centroid(numbers, at, scratch, strengths, work)
    return exact_centroid(numbers, at, scratch, strengths, work)


@kernel
def fuzzify(numbers: list[float], at: int, scratch: list[float], cell: int, degrees: int) -> None:
    """Write down how far each term of each input holds; inputs are clamped to their range."""
    head = at + int(numbers[at + INPUTS_AT])
    for place in range(cell, degrees):
        value = scratch[place]
        value = min(max(value, numbers[head]), numbers[head + 1])
        count = int(numbers[head + 2])
        breaks = at + int(numbers[head + 3])
        below = 0
        while below < count - 1 and numbers[breaks + below] < value:
            below += 1
        # Pieces alternate: a break, the stretch up to the next, and so on.
        piece = 2 * below
        if numbers[breaks + below] != value and below > 0:
            piece -= 1
        entry = breaks + count + 2 * piece
        line = at + int(numbers[entry])
        for _ in range(int(numbers[entry + 1])):
            scratch[degrees + int(numbers[line])] = numbers[line + 2] + numbers[line + 3] * (
                value - numbers[line + 1]
            )
            line += LINE
        head += INPUT_HEAD


@kernel
def fire(numbers: list[float], at: int, scratch: list[float], degrees: int, strengths: int) -> bool:
    """Raise the strength of each consequent to that of its strongest rule."""
    product = numbers[at + PRODUCT_AND] != 0.0
    any_fired = False
    place = at + int(numbers[at + RULES_AT])
    groups = int(numbers[place])
    place += 1
    for _ in range(groups):
        first = scratch[degrees + int(numbers[place])]
        rules = int(numbers[place + 1])
        after = at + int(numbers[place + 2])
        if first > 0.0:
            rule = place + 3
            for _ in range(rules):
                more = int(numbers[rule])
                strength = first
                for other in range(rule + 4, rule + 4 + more):
                    degree = scratch[degrees + int(numbers[other])]
                    strength = strength * degree if product else min(strength, degree)
                strength *= numbers[rule + 1]
                if strength > numbers[rule + 2]:
                    any_fired = True
                    member = strengths + int(numbers[rule + 3])
                    scratch[member] = max(scratch[member], strength)
                rule += 4 + more
        place = after
    return any_fired


@kernel
def sampled_centroid(
    numbers: list[float], at: int, scratch: list[float], strengths: int, work: int
) -> float:
    """Return the centroid over equally spaced samples; sets are zero outside their stretch."""
    samples = int(numbers[at + SAMPLES])
    head = at + int(numbers[at + OUTPUT_AT])
    moments = at + int(numbers[head])
    weights = at + int(numbers[head + 1])
    product = numbers[at + PRODUCT_THEN] != 0.0
    begin = samples
    end = 0
    entry = head + 2
    for member in range(strengths, work):
        if scratch[member] > 0.0:
            begin = min(begin, int(numbers[entry]))
            end = max(end, int(numbers[entry + 1]))
        entry += 3
    for i in range(begin, end):
        scratch[work + i] = 0.0
    entry = head + 2
    for member in range(strengths, work):
        strength = scratch[member]
        if strength > 0.0:
            start = int(numbers[entry])
            values = at + int(numbers[entry + 2]) - start
            if product:
                for i in range(start, int(numbers[entry + 1])):
                    scratch[work + i] = max(scratch[work + i], strength * numbers[values + i])
            else:
                for i in range(start, int(numbers[entry + 1])):
                    scratch[work + i] = max(scratch[work + i], min(strength, numbers[values + i]))
        entry += 3
    moment = 0.0
    area = 0.0
    for i in range(begin, end):
        moment += numbers[moments + i] * scratch[work + i]
        area += numbers[weights + i] * scratch[work + i]
    return moment / area if area > 0.0 else numbers[at + SILENT]


@kernel
def exact_centroid(
    numbers: list[float], at: int, scratch: list[float], strengths: int, work: int
) -> float:
    """Return the centroid of the upper envelope of the cut sets, integrated piece by piece."""
    lines = cut(numbers, at, scratch, strengths, work)
    events = work + LINE * lines
    count = 0
    for line in range(work, events, LINE):
        count = inserted(scratch, events, count, scratch[line])
        count = inserted(scratch, events, count, scratch[line + 2])
    moment = 0.0
    area = 0.0
    for k in range(events, events + count - 1):
        left = scratch[k]
        slope = -math.inf
        while left < scratch[k + 1]:
            best, slope, right = highest(scratch, work, events, left, scratch[k + 1], slope)
            width = right - left
            first = best
            last = best + slope * width
            part = 0.5 * width * (first + last)
            area += part
            moment += left * part + width * width * (first + 2.0 * last) / 6.0
            left = right
    return moment / area if area > 0.0 else numbers[at + SILENT]


@kernel
def cut(numbers: list[float], at: int, scratch: list[float], strengths: int, work: int) -> int:
    """Write down the straight pieces of all sets that fired, cut or scaled; return how many."""
    product = numbers[at + PRODUCT_THEN] != 0.0
    entry = at + int(numbers[at + OUTPUT_AT])
    place = work
    for member in range(strengths, work):
        strength = scratch[member]
        if strength > 0.0:
            piece = at + int(numbers[entry + 1])
            for _ in range(int(numbers[entry])):
                x_0, y_0 = numbers[piece], numbers[piece + 1]
                x_1, y_1 = numbers[piece + 2], numbers[piece + 3]
                piece += LINE
                if product:
                    place = put(scratch, place, x_0, strength * y_0, x_1, strength * y_1)
                elif max(y_0, y_1) <= strength:
                    place = put(scratch, place, x_0, y_0, x_1, y_1)
                elif min(y_0, y_1) >= strength:
                    place = put(scratch, place, x_0, strength, x_1, strength)
                else:
                    x = x_0 + (strength - y_0) * (x_1 - x_0) / (y_1 - y_0)
                    place = put(scratch, place, x_0, min(y_0, strength), x, strength)
                    place = put(scratch, place, x, strength, x_1, min(y_1, strength))
        entry += 2
    return (place - work) // LINE


@kernel
def put(scratch: list[float], place: int, x_0: float, y_0: float, x_1: float, y_1: float) -> int:
    """Append a piece unless it has no width or no height; return the place behind it."""
    if x_1 <= x_0 or (y_0 <= 0.0 and y_1 <= 0.0):
        return place
    scratch[place] = x_0
    scratch[place + 1] = y_0
    scratch[place + 2] = x_1
    scratch[place + 3] = y_1
    return place + LINE


@kernel
def inserted(scratch: list[float], events: int, count: int, x: float) -> int:
    """Insert a place into the sorted ones unless it is there; return how many there are."""
    k = events + count
    while k > events and scratch[k - 1] > x:
        k -= 1
    if k > events and scratch[k - 1] == x:
        return count
    for other in range(events + count, k, -1):
        scratch[other] = scratch[other - 1]
    scratch[k] = x
    return count + 1


@kernel
def highest(
    scratch: list[float], work: int, events: int, left: float, right: float, past: float
) -> tuple[float, float, float]:
    """Return height and slope of the envelope from `left` on, and up to where they hold.

    From one crossing to the next an envelope of lines gets steeper: only lines steeper
    than `past` count, so that rounding at a crossing does not bring the old line back.
    """
    best = 0.0
    steep = 0.0
    for line in range(work, events, LINE):
        if scratch[line] <= left and scratch[line + 2] >= right:
            slope = (scratch[line + 3] - scratch[line + 1]) / (scratch[line + 2] - scratch[line])
            y = scratch[line + 1] + slope * (left - scratch[line])
            if slope > past and (y > best or (y == best and slope > steep)):
                best = y
                steep = slope
    until = right
    for line in range(work, events, LINE):
        if scratch[line] <= left and scratch[line + 2] >= right:
            slope = (scratch[line + 3] - scratch[line + 1]) / (scratch[line + 2] - scratch[line])
            if slope > steep:
                y = scratch[line + 1] + slope * (left - scratch[line])
                x = left + (best - y) / (slope - steep)
                if left < x < until:
                    until = x
    return best, steep, until
