"""The kernels: many points, or one, from their inputs to their outputs.

A rule base is data, and so is the room to work in: all stands in one array of floats, the
block, parts of which are read as whole numbers. :mod:`fuzzyarm.inference.kernel.layout`
writes it. (One array is also what costs least to hand over.) The kernels know the whole
numbers as `k`, the floats of the rule base as `f` and the rows to work in as `room`.

Every input finds its cell between the corners of its terms; the cells together name a
program, which lists the rules that can fire there and what to integrate. So nothing is
searched, and the cost grows with the rules that fire. Points are sorted by their program;
what a program does it does to all of its points in a row, which the processor takes
several at a time.

Where there is no ordinary value (not a number, outside a range that forbids it, no rule
fires and nothing is stated) the output is NaN; the caller asks another engine then.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fuzzyarm.kernels import kernel

# --- Norms as a kernel: T-norms and S-norms by number ---

CONJUNCTIONS = ("min", "product", "bounded", "drastic", "hamacher", "einstein", "nilpotent")
DISJUNCTIONS = (
    "max", "probor", "bounded", "drastic", "hamacher", "einstein", "nilpotent", "sum",
    "normalized",
)  # fmt: skip

CODES = {f"and {name}": i for i, name in enumerate(CONJUNCTIONS)} | {
    f"or {name}": len(CONJUNCTIONS) + i for i, name in enumerate(DISJUNCTIONS)
}
"""The number of each norm, T-norms first."""

(
    MIN, PRODUCT, BOTH_BOUNDED, BOTH_DRASTIC, BOTH_HAMACHER, BOTH_EINSTEIN, BOTH_NILPOTENT,
    MAX, PROBOR, BOUNDED, DRASTIC, HAMACHER, EINSTEIN, NILPOTENT, SUM, NORMALIZED,
) = range(len(CODES))  # fmt: skip


@kernel
def combine(code: int, a: float, b: float) -> float:
    """Return the norm with number `code` of two degrees."""
    if code == MIN:
        return min(a, b)
    if code == MAX:
        return max(a, b)
    if code == PRODUCT:
        return a * b
    if code == SUM:
        return a + b
    return rare(code, a, b)


@kernel
def rare(code: int, a: float, b: float) -> float:
    """Return one of the norms that few rule bases use."""
    if code in (BOTH_HAMACHER, HAMACHER, BOTH_EINSTEIN, EINSTEIN, PROBOR):
        return smooth(code, a, b, a * b)
    low, high, total = min(a, b), max(a, b), a + b
    found = total / max(1.0, total)  # normalized
    if code == BOTH_BOUNDED:
        found = max(0.0, total - 1.0)
    elif code == BOUNDED:
        found = min(1.0, total)
    elif code == BOTH_DRASTIC:
        found = low if high >= 1.0 else 0.0
    elif code == DRASTIC:
        found = high if low <= 0.0 else 1.0
    elif code == BOTH_NILPOTENT:
        found = low if total > 1.0 else 0.0
    elif code == NILPOTENT:
        found = high if total < 1.0 else 1.0
    return found


@kernel
def smooth(code: int, a: float, b: float, product: float) -> float:
    """Return one of the norms that are rational functions."""
    found = a + b - product  # probor
    if code == BOTH_HAMACHER:
        found = product / found if product > 0.0 else 0.0
    elif code == HAMACHER:
        found = (a + b - 2.0 * product) / (1.0 - product) if product < 1.0 else 1.0
    elif code == BOTH_EINSTEIN:
        found = product / (2.0 - found)
    elif code == EINSTEIN:
        found = (a + b) / (1.0 + product)
    return found


# --- The kernels ---

# The head of the whole numbers: counts, first rows, and places in the whole numbers …
INPUTS, OUTPUTS, OPERANDS, HEIGHTS, WORK, PROGRAMS_AT, OUTPUTS_AT, PROGRAMS = range(8)
# … points and length of rows; and places in the block.
POINTS, WIDTH, FLOATS, ROOM, COLUMNS, RESULTS, ORDERED, ORDER, ENDS, SIZE = range(8, 18)
HEAD = 18

# For each input from HEAD on.
CLAMPED, BUCKETS, STARTS_AT, EDGES_AT, STRIDE, SLOT, CELLS = range(7)
INPUT_HEAD = 7

# For each output from OUTPUTS_AT on.
KIND, FLOATS_AT, AGGREGATION, OUT_MODE, COUNT = range(5)
OUTPUT_HEAD = 5
CLOSED, WEIGHTED, WEIGHTED_SUM, SAMPLED = range(4)
CLAMP, EXTEND, ERROR = range(3)

LINE = 3
"""Floats of a straight line: y0, x0, slope."""

LAYER = 7
"""Floats of a layer of the closed form."""

ONES = 0
"""Row of ones; behind it one of zeros."""

STRENGTH, TOTAL, MOMENT = range(3)
"""Rows from WORK on, as many as the kernels need for themselves."""

WORK_ROWS = 3

FAILED = -1
"""The cell of a point that has no proper inputs."""


@kernel
def sweep(block: Any) -> int:
    """Evaluate the points in a block; return how many outputs are NaN.

    Parameters
    ----------
    block : ndarray of float64
        With inputs in its columns (brought into their ranges here); its results are filled.
    """
    k = block.view(np.int64)
    f = block[k[FLOATS] : k[ROOM]]
    room = block[k[ROOM] : k[COLUMNS]]
    points = k[POINTS]
    width = k[WIDTH]
    cells = k[k[ORDER] : k[ORDER] + points]
    origin = k[k[ORDER] + width : k[ORDER] + width + points]
    ends = k[k[ENDS] : k[ENDS] + k[PROGRAMS] + 2]
    for point in range(points):
        cells[point] = 0
        origin[point] = point
    for i in range(k[INPUTS]):
        begin = k[COLUMNS] + i * width
        locate(k, f, i, block[begin : begin + points], cells)
    first = 0
    last = k[PROGRAMS]
    ordered = k[COLUMNS]
    if points == 1:
        first = cells[0]
        last = first + 1
        ends[max(first, 0)] = 0
        ends[last] = 1
    else:
        sort(block, k, cells, origin, ends)
        ordered = k[ORDERED]
    begin = ends[first] if first >= 0 else 1
    missing = 0
    for place in range(begin):  # these have no cell
        for o in range(k[OUTPUTS]):
            block[k[RESULTS] + o * width + origin[place]] = math.nan
            missing += 1
    for program in range(max(first, 0), last):
        end = ends[program + 1]
        if end > begin:
            x = ordered + begin
            missing += run(block, k, f, room, x, k[k[PROGRAMS_AT] + program], origin[begin:end])
            begin = end
    return missing


@kernel
def sort(block: Any, k: Any, cells: Any, origin: Any, ends: Any) -> None:
    """Bring points of one program together; those without a cell go to the front.

    Afterwards the points of program p stand in front of ``ends[p + 1]``, behind those of
    the program before.
    """
    width = k[WIDTH]
    for program in range(ends.shape[0]):
        ends[program] = 0
    for point in range(cells.shape[0]):
        ends[cells[point] + 2] += 1
    for program in range(1, ends.shape[0]):
        ends[program] += ends[program - 1]
    for point in range(cells.shape[0]):
        place = ends[cells[point] + 1]
        ends[cells[point] + 1] = place + 1
        origin[place] = point
    for i in range(k[INPUTS]):
        begin = k[COLUMNS] + i * width
        column = block[begin : begin + cells.shape[0]]
        begin = k[ORDERED] + i * width
        ordered = block[begin : begin + cells.shape[0]]
        for place in range(cells.shape[0]):
            ordered[place] = column[origin[place]]


@kernel
def locate(k: Any, f: Any, i: int, x: Any, cells: Any) -> None:
    """Bring an input into its range; add its share to the numbers of the cells."""
    head = HEAD + INPUT_HEAD * i
    clamped = k[head + CLAMPED] != 0
    low, high, first, scale = f[4 * i], f[4 * i + 1], f[4 * i + 2], f[4 * i + 3]
    last = k[head + BUCKETS] - 1.0
    starts = k[k[head + STARTS_AT] : k[head + STARTS_AT] + k[head + BUCKETS]]
    edges = f[k[head + EDGES_AT] : k[head + EDGES_AT] + k[head + CELLS] + 1]
    stride = k[head + STRIDE]
    for point in range(cells.shape[0]):
        value = x[point]
        if clamped:
            value = min(max(value, low), high)
            x[point] = value
        if not low <= value <= high:
            cells[point] = FAILED
        elif cells[point] >= 0:
            bucket = int(min(max((value - first) * scale, 0.0), last))
            cell = starts[bucket]
            while value < edges[cell]:
                cell -= 1
            while value >= edges[cell + 1]:
                cell += 1
            cells[point] += cell * stride


@kernel
def run(block: Any, k: Any, f: Any, room: Any, x: int, place: int, whence: Any) -> int:
    """Run the program at `place` for points that share it; return how many outputs are NaN.

    Their inputs stand in the block from `x` on, in rows of the usual length; `whence` says
    where their results go.
    """
    count = whence.shape[0]
    width = k[WIDTH]
    for i in range(k[INPUTS]):
        slot = k[HEAD + INPUT_HEAD * i + SLOT]
        line = k[place]
        lines = k[place + 1]
        place += 2
        inputs = block[x + i * width :][:count]
        for j in range(slot, slot + lines):
            lay_line(room[j * width :][:count], inputs, f[line], f[line + 1], f[line + 2])
            line += LINE
    missing = 0
    head = k[OUTPUTS_AT]
    total = room[(k[WORK] + TOTAL) * width :][:count]
    moment = room[(k[WORK] + MOMENT) * width :][:count]
    for o in range(k[OUTPUTS]):
        kind = k[head + KIND]
        numbers = k[head + FLOATS_AT]
        for point in range(count):
            total[point] = 0.0
            moment[point] = 0.0
        top = place
        place = heights(k, f, room, place, k[head + AGGREGATION], count)
        if kind == CLOSED:
            place = closed_centroid(k, f, room, top, place, total, moment)
        elif kind == SAMPLED:
            sampled_centroid(k, f, room, top, head, total, moment)
        else:
            average(block, k, f, room, x, top, k[head + COUNT], total, moment)
        if kind != WEIGHTED_SUM:
            divide(moment, total, f[numbers + 3])
        results = block[k[RESULTS] + o * width :][: k[POINTS]]
        bounds = f[numbers:][:3]
        missing += settle(k[head + OUT_MODE], bounds, total, moment, results, whence)
        head += OUTPUT_HEAD
    return missing


@kernel
def lay_line(row: Any, x: Any, height: float, x_0: float, slope: float) -> None:
    """Write down the degrees along a straight line."""
    for point in range(row.shape[0]):
        row[point] = max(0.0, height + (x[point] - x_0) * slope)


@kernel
def divide(moment: Any, total: Any, centre: float) -> None:
    """Turn moments into centroids; where there is no area, into anything."""
    for point in range(moment.shape[0]):
        moment[point] = centre + moment[point] / total[point]


@kernel
def settle(mode: int, bounds: Any, total: Any, value: Any, result: Any, whence: Any) -> int:
    """Bring values into the range, say what holds where nothing fired; count the NaN."""
    low, high, silent = bounds[0], bounds[1], bounds[2]
    missing = 0
    for point in range(total.shape[0]):
        found = value[point]
        if total[point] > 0.0:
            if mode == CLAMP:
                found = min(max(found, low), high)
            elif mode == ERROR and not low <= found <= high:
                found = math.nan
            if not abs(found) < math.inf:
                found = math.nan
        else:
            found = silent
        result[whence[point]] = found
        if math.isnan(found):
            missing += 1
    return missing


@kernel
def fire(k: Any, f: Any, room: Any, rule: int, strength: Any) -> int:
    """Write down how far a rule fires: [norm, weight and threshold, operands …]."""
    count = strength.shape[0]
    width = k[WIDTH]
    operands: int = k[OPERANDS]
    code = k[rule]
    weight, threshold = f[k[rule + 1]], f[k[rule + 1] + 1]
    degrees = room[k[rule + 2] * width :][:count]
    for q in range(min(rule + 3, rule + 1 + operands), rule + 2 + operands):
        join(code, degrees, room[k[q] * width :][:count], strength)
        degrees = strength
    if weight != 1.0 or threshold > 0.0:
        for point in range(count):
            part = strength[point] * weight
            strength[point] = part if part > threshold else 0.0
    return rule + 2 + operands


@kernel
def join(code: int, a: Any, b: Any, into: Any) -> None:
    """Take the norm of two rows."""
    if code == MIN:
        for point in range(into.shape[0]):
            into[point] = min(a[point], b[point])
    elif code == PRODUCT:
        for point in range(into.shape[0]):
            into[point] = a[point] * b[point]
    elif code == MAX:
        for point in range(into.shape[0]):
            into[point] = max(a[point], b[point])
    else:
        for point in range(into.shape[0]):
            into[point] = combine(code, a[point], b[point])


@kernel
def heights(k: Any, f: Any, room: Any, place: int, fold: int, count: int) -> int:
    """Fold the strengths of the rules of each group; one row each. Return the place behind.

    A program has for every output: the number of groups; for each group the number of its
    rules, its member, its rules.
    """
    width = k[WIDTH]
    groups = k[place]
    place += 1
    strength = room[(k[WORK] + STRENGTH) * width :][:count]
    for g in range(k[HEIGHTS], k[HEIGHTS] + groups):
        folded = room[g * width :][:count]
        rules = k[place]
        place += 2
        for i in range(rules):
            place = fire(k, f, room, place, strength if i else folded)
            if i:
                join(fold, folded, strength, folded)
    return place


@kernel
def closed_centroid(
    k: Any, f: Any, room: Any, top: int, place: int, total: Any, moment: Any
) -> int:
    """Add up area and moment of the exact centroid; see :mod:`fuzzyarm.inference.overlap`."""
    count = total.shape[0]
    width = k[WIDTH]
    groups = k[top]
    first = k[HEIGHTS] * width
    unions = k[place]
    place += 1
    for u in range(groups, groups + unions):
        others = k[place]
        most = room[first + u * width :][:count]
        for point in range(count):
            most[point] = 0.0
        for other in range(place + 1, place + 1 + others):
            join(MAX, most, room[first + k[other] * width :][:count], most)
        place += 1 + others
    terms = k[place]
    place += 1
    for _ in range(terms):
        one = room[first + k[place] * width :][:count]
        other = room[first + k[place + 1] * width :][:count]
        add_layer(f[k[place + 2] :][:LAYER], one, other, total, moment)
        place += 3
    return place


@kernel
def add_layer(layer: Any, one: Any, other: Any, total: Any, moment: Any) -> None:
    """Add a layer of the closed form at the smaller of two heights."""
    start, depth, a1, a2 = layer[0], layer[1], layer[2], layer[3]
    b1, b2, b3 = layer[4], layer[5], layer[6]
    for point in range(total.shape[0]):
        x = min(max(min(one[point], other[point]) - start, 0.0), depth)
        total[point] += x * (a1 + a2 * x)
        moment[point] += x * (b1 + x * (b2 + b3 * x))


@kernel
def average(
    block: Any, k: Any, f: Any, room: Any, x: int, place: int, linear: int, total: Any, moment: Any
) -> None:
    """Add up strengths, and strengths times the values of the consequents."""
    count = total.shape[0]
    width = k[WIDTH]
    groups = k[place]
    place += 1
    value = room[(k[WORK] + STRENGTH) * width :][:count]
    for g in range(k[HEIGHTS], k[HEIGHTS] + groups):
        weight = room[g * width :][:count]
        values = k[place + 1]
        place += 2 + k[place] * (2 + k[OPERANDS])
        for point in range(count):
            value[point] = f[values]
        for i in range(linear):
            inputs = block[x + i * width :][:count]
            for point in range(count):
                value[point] += f[values + 1 + i] * inputs[point]
        for point in range(count):
            if weight[point] > 0.0:
                total[point] += weight[point]
                moment[point] += weight[point] * value[point]


@kernel
def sampled_centroid(
    k: Any, f: Any, room: Any, top: int, head: int, total: Any, moment: Any
) -> None:
    """Add up the samples of the aggregate, point by point."""
    fold = k[head + AGGREGATION]
    samples = k[head + COUNT]
    width = k[WIDTH]
    numbers = k[head + FLOATS_AT] + 4
    heap = room[(k[WORK] + WORK_ROWS) * width :][:samples]
    places, weights = f[numbers:][:samples], f[numbers + samples :][:samples]
    for point in range(total.shape[0]):
        for i in range(samples):
            heap[i] = 0.0
        group = top + 1
        first, last = samples, 0
        for g in range(k[HEIGHTS], k[HEIGHTS] + k[top]):
            member = k[group + 1]
            group += 2 + k[group] * (2 + k[OPERANDS])
            height = room[g * width + point]
            if height > 0.0:
                begin, end = k[member], k[member + 1]
                first, last = min(first, begin), max(last, end)
                degrees = f[k[member + 2] :][: end - begin]
                set_in(k[member + 3], fold, height, degrees, heap[begin:end])
        for i in range(first, last):
            total[point] += weights[i] * heap[i]
            moment[point] += weights[i] * heap[i] * places[i]


@kernel
def set_in(code: int, fold: int, top: float, degrees: Any, heap: Any) -> None:
    """Cut a set at a height and add it to the aggregate, over its own stretch of samples."""
    if code == MIN and fold == MAX:
        for i in range(heap.shape[0]):
            heap[i] = max(heap[i], min(top, degrees[i]))
    elif code == PRODUCT and fold == MAX:
        for i in range(heap.shape[0]):
            heap[i] = max(heap[i], top * degrees[i])
    else:
        for i in range(heap.shape[0]):
            heap[i] = combine(fold, heap[i], combine(code, top, degrees[i]))
