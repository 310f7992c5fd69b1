"""Centroids of the aggregate by samples, and by the upper envelope of straight sets.

Two defuzzifiers of the kernel: one over samples of the aggregate, one exactly over its straight
pieces. With samples xᵢ, their quadrature weights wᵢ, and μ the union of the sets cut at their
heights,

    area = Σ wᵢ μ(xᵢ),  moment = Σ wᵢ μ(xᵢ) xᵢ,

both in the order of the samples. They work on the heap after the work rows, one point at a time:
its numbers fit into the level 1 cache.
"""

from __future__ import annotations

from typing import Any

from fuzzyarm.inference.block import (
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
    parts_of,
)
from fuzzyarm.inference.envelope import cut_pieces, envelope_of, whole_of
from fuzzyarm.inference.firing_strengths import join
from fuzzyarm.symbolic.kernels import kernel

AT_ONCE = 4
"""Sets of a point united and summed in one pass."""


@kernel
def sampled_centroid(block: Any) -> None:
    """Add up the samples of the aggregate, point by point.

    Here a consequent has a sixth number: 1 where its degrees are padded with zeros to all samples,
    it is clipped, and sets are united by the maximum. A few such sets are united in registers,
    sample by sample, without storing the aggregate: each set would have to wait for the stores of
    the one before.
    """
    k, f, scratch, total, moment = parts_of(block)
    width = k[WIDTH]
    samples = k[k[OUTPUT] + DETAIL]
    numbers = k[k[OUTPUT] + FLOATS_AT] + OUTPUT_RANGE
    positions = f[numbers : numbers + samples]
    weights = f[numbers + samples : numbers + 2 * samples]
    heap = scratch[(k[WORK] + WORK_ROWS) * width :]
    for point in range(total.shape[0]):
        count, first, last = _firing_sets(k, scratch, heap, point, numbers)
        if count <= AT_ONCE:
            height_0, height_1, height_2, height_3 = heap[0], heap[1], heap[2], heap[3]
            # Unused slots have the height 0, so that four sets are united without a branch.
            set_0, set_1, set_2, set_3 = int(heap[4]), int(heap[5]), int(heap[6]), int(heap[7])
            area = torque = 0.0
            for i in range(first, last):
                degree = max(0.0, min(height_0, f[set_0 + i]))
                degree = max(degree, min(height_1, f[set_1 + i]))
                degree = max(degree, min(height_2, f[set_2 + i]))
                degree = max(degree, min(height_3, f[set_3 + i]))
                part = weights[i] * degree
                area += part
                torque += part * positions[i]
            total[point] = area
            moment[point] = torque
        else:
            total[point], moment[point] = _summed(k, f, scratch, heap, point, positions, weights)


@kernel
def _firing_sets(k: Any, scratch: Any, heap: Any, point: int, numbers: int) -> tuple[int, int, int]:
    """List heights and degrees of the firing sets of a point; return their number and index.

    Where there are more than `AT_ONCE`, or one that is not united in registers, they are one more.
    """
    # Heights first, then the index in f of the (virtual) degree at sample 0. An empty slot has the
    # height 0; its degrees are any readable numbers.
    for i in range(AT_ONCE):
        heap[i], heap[AT_ONCE + i] = 0.0, float(numbers)
    width = k[WIDTH]
    count = 0
    first, last = k[k[OUTPUT] + DETAIL], 0
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        consequent = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        height = scratch[group * width + point]
        if height > 0.0:
            if count == AT_ONCE or k[consequent + 5] == 0:
                return AT_ONCE + 1, 0, 0
            begin = k[consequent]
            first, last = min(first, begin), max(last, k[consequent + 1])
            heap[count], heap[AT_ONCE + count] = height, float(k[consequent + 2] - begin)
            count += 1
    return count, first, last


@kernel
def _summed(
    k: Any, f: Any, scratch: Any, heap: Any, point: int, positions: Any, weights: Any
) -> tuple[float, float]:
    """Return area and moment of the samples of an aggregate of any sets."""
    samples = positions.shape[0]
    aggregate, cut = heap[:samples], heap[samples : 2 * samples]
    first, last = sample(k, f, scratch, point, 0, aggregate, cut)
    return summed_up(aggregate, positions, weights, first, last)


@kernel
def summed_up(
    aggregate: Any, positions: Any, weights: Any, first: int, last: int
) -> tuple[float, float]:
    """Return area and moment of samples, from the first to the last."""
    area = torque = 0.0  # in registers: a sum in memory waits for its own store
    for i in range(first, last):
        part = weights[i] * aggregate[i]
        area += part
        torque += part * positions[i]
    return area, torque


@kernel
def sample(
    k: Any, f: Any, scratch: Any, point: int, side: int, aggregate: Any, cut: Any
) -> tuple[int, int]:
    """Compute the samples of the aggregate at a point; return its nonzero stretch.

    Only of the sets of one side: those of type 1 are all on side 0. A consequent is: first and last
    nonzero sample, its degrees in f, its implication, its side.
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
        height = scratch[group * width + point]
        if height > 0.0 and k[consequent + 4] == side:
            begin, end = k[consequent], k[consequent + 1]
            first, last = min(first, begin), max(last, end)
            degrees = f[k[consequent + 2] : k[consequent + 2] + (end - begin)]
            implication = k[consequent + 3]
            so_far = aggregate[begin:end]
            cut_in(implication, fold, height, degrees, so_far, cut[: end - begin])
    return first, last


@kernel
def whole_envelope(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return area and moment below the upper envelope of cut or scaled sets, piece by piece.

    For straight sets without a closed form.
    """
    begin = k[k[OUTPUT] + DETAIL]
    return whole_of(heap, begin, envelop(k, f, scratch, point, 0, heap, begin))


@kernel
def envelop(k: Any, f: Any, scratch: Any, point: int, side: int, heap: Any, into: int) -> int:
    """Compute the upper envelope of the cut sets of one side; return its end in the heap.

    A consequent is: its pieces (number, index in f), whether its implication is the product instead
    of the minimum, its side. The heap has the lines first, then their ends (events of the sweep),
    and from `into` on the pieces of the envelope.
    """
    width = k[WIDTH]
    events = 0
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        consequent = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        height = scratch[group * width + point]
        pieces, begin = k[consequent], k[consequent + 1]
        if height > 0.0 and k[consequent + 3] == side:
            scaled = k[consequent + 2] != 0
            events = cut_pieces(f, begin, pieces, height, scaled, heap, events)
    return envelope_of(heap, events, into)


@kernel
def cut_in(implication: int, fold: int, height: float, degrees: Any, so_far: Any, cut: Any) -> None:
    """Cut a set at a height and fold it into the aggregate, over its own stretch of samples."""
    # Every sample is stored, the old height too (+ 0 keeps its bits): the vectoriser would turn a
    # store under a condition into a masked one, many times slower.
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
