"""Defuzzifiers of the kernel in closed form: the centroid of straight sets, and weighted values.

Each adds up, for the points of a program, the area (or the weight) of the output in the row TOTAL
and the moment about the centre in the row MOMENT. The heights of the groups are in the rows from
HEIGHTS on. The centroid is a sum over layers, whose area and moment are polynomials of the height
of the cut: see :mod:`fuzzyarm.inference.overlap`.
"""

from __future__ import annotations

from typing import Any

from fuzzyarm.inference.block import (
    COUNT,
    DETAIL,
    GROUP_HEAD,
    GROUPS,
    HEIGHTS,
    INPUT_ROWS,
    LAYER,
    NEXT,
    OPERANDS,
    OUTPUT,
    RULE_HEAD,
    STRENGTH,
    WIDTH,
    WORK,
    parts_of,
)
from fuzzyarm.symbolic.kernels import kernel


@kernel
def closed_centroid(block: Any) -> None:
    """Add up area and moment of straight sets; see :mod:`fuzzyarm.inference.overlap`.

    Reads from ``k[NEXT]`` on: unions of heights (their number; each a count and its rows), then
    terms (their number; each two rows, the smaller of which counts, and the index of its layer).
    """
    k, f, scratch, total, moment = parts_of(block)
    count, width = k[COUNT], k[WIDTH]
    groups = k[k[GROUPS]]
    first = k[HEIGHTS] * width
    # The rows of unions follow those of the groups; several overlaps may share one.
    at = k[NEXT]
    unions = k[at]
    at += 1
    for union in range(groups, groups + unions):
        others = k[at]
        begin = first + union * width
        most = scratch[begin : begin + count]
        for point in range(count):
            most[point] = 0.0
        for other in range(at + 1, at + 1 + others):
            begin = first + k[other] * width
            height = scratch[begin : begin + count]
            for point in range(count):
                most[point] = max(most[point], height[point])
        at += 1 + others
    # A term is F(hₖ), or −F(min(hₖ, Hₖ)) with its sign in the layer: the smaller of two rows
    # counts, for a set itself twice the same one.
    terms = k[at]
    at += 1
    for _ in range(terms):
        begin = first + k[at] * width
        one = scratch[begin : begin + count]
        begin = first + k[at + 1] * width
        second = scratch[begin : begin + count]
        _add_layer(f[k[at + 2] : k[at + 2] + LAYER], one, second, total, moment)
        at += 3
    k[NEXT] = at


@kernel
def _add_layer(layer: Any, one: Any, other: Any, total: Any, moment: Any) -> None:
    """Add a layer of the closed form at the smaller of two heights."""
    start, depth, a1, a2 = layer[0], layer[1], layer[2], layer[3]
    b1, b2, b3 = layer[4], layer[5], layer[6]
    for point in range(total.shape[0]):
        x = part_of_layer(one[point], other[point], start, depth)
        total[point] += layer_area(x, a1, a2)
        moment[point] += layer_moment(x, b1, b2, b3)


@kernel
def part_of_layer(one: float, other: float, start: float, depth: float) -> float:
    """Return x: the share of a layer below the smaller of two heights, degrees from 0 to 1."""
    return min(max(min(one, other) - start, 0.0), depth)


@kernel
def layer_area(x: float, a1: float, a2: float) -> float:
    """Return a1 x + a2 x², the area of a layer up to x; see :mod:`fuzzyarm.inference.overlap`."""
    return x * (a1 + a2 * x)


@kernel
def layer_moment(x: float, b1: float, b2: float, b3: float) -> float:
    """Return b1 x + b2 x² + b3 x³, the moment of a layer up to x about the middle of the range."""
    return x * (b1 + x * (b2 + b3 * x))


@kernel
def closed_centroid_of_point(
    k: Any, f: Any, heights: Any, groups: int, at: int
) -> tuple[float, float, int]:
    """Return area and moment at a point, and the next index; see :func:`closed_centroid`."""
    # Heights of unions follow those of the groups: the greatest of their sets.
    unions = k[at]
    at += 1
    for union in range(groups, groups + unions):
        others = k[at]
        most = 0.0
        for other in range(at + 1, at + 1 + others):
            most = max(most, heights[k[other]])
        heights[union] = most
        at += 1 + others
    total = 0.0
    moment = 0.0
    # A term is a layer up to the smaller of two heights: their rows, the index of the layer.
    terms = k[at]
    at += 1
    for _ in range(terms):
        layer = k[at + 2]
        x = part_of_layer(heights[k[at]], heights[k[at + 1]], f[layer], f[layer + 1])
        total += layer_area(x, f[layer + 2], f[layer + 3])
        moment += layer_moment(x, f[layer + 4], f[layer + 5], f[layer + 6])
        at += 3
    return total, moment, at


@kernel
def weighted(block: Any) -> None:
    """Add up the strengths, and their products with the values of the consequents.

    A value is linear in the first ``k[DETAIL]`` inputs: constant, then coefficients in f.
    """
    k, f, scratch, total, moment = parts_of(block)
    count, width = k[COUNT], k[WIDTH]
    begin = (k[WORK] + STRENGTH) * width
    value = scratch[begin : begin + count]
    linear = k[k[OUTPUT] + DETAIL]
    at = k[GROUPS] + 1
    for group in range(k[HEIGHTS], k[HEIGHTS] + k[k[GROUPS]]):
        begin = group * width
        weight = scratch[begin : begin + count]
        values = k[at + 1]
        at += GROUP_HEAD + k[at] * (RULE_HEAD + k[OPERANDS])
        for point in range(count):
            value[point] = f[values]
        for i in range(linear):
            begin = k[INPUT_ROWS] + i * width
            inputs = block[begin : begin + count]
            for point in range(count):
                value[point] += f[values + 1 + i] * inputs[point]
        # Not times 0: a linear value may be infinite where its rule does not fire.
        for point in range(count):
            if weight[point] > 0.0:
                total[point] += weight[point]
                moment[point] += weight[point] * value[point]
