"""What looking a value up in a table means, in exact fractions: the oracle of every reading.

Written from docs/reference/tables.md and docs/reference/export.md, without the code under test.
Numbers are taken as the rational numbers that they are; nothing is rounded but where the definition
says so.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product


def by_bins(bins, x):
    """Every threshold that is smaller leads one cell up: an equal one does not."""
    return sum(1 for threshold in bins if Fraction(threshold) < Fraction(x))


def by_nearest(levels, x):
    """The level with the smallest distance; of two equally near ones the lower."""
    distances = [abs(Fraction(level) - Fraction(x)) for level in levels]
    return distances.index(min(distances))


def neighbours(levels, x):
    """The lower neighbour and the exact share of the way to the upper one."""
    exact = [Fraction(level) for level in levels]
    x = min(max(Fraction(x), exact[0]), exact[-1])
    if len(exact) == 1:
        return 0, Fraction(0)
    k = max(k for k in range(len(exact) - 1) if exact[k] <= x)
    return k, (x - exact[k]) / (exact[k + 1] - exact[k])


def picked(axes, values, point, mode):
    """The value of a cell; `axes` as tables have them, `values` nested or an array."""
    for axis, x in zip(axes, point, strict=True):
        binned = mode == "bins" and axis.bins is not None
        values = values[by_bins(axis.bins, x) if binned else by_nearest(axis.levels, x)]
    return values


def interpolated(axes, values, point):
    """The sum over the corners, each with the product of its shares."""
    found = [neighbours(axis.levels, x) for axis, x in zip(axes, point, strict=True)]
    total = Fraction(0)
    for corner in product((0, 1), repeat=len(axes)):
        weight, cell = Fraction(1), values
        for upper, (k, share) in zip(corner, found, strict=True):
            weight *= share if upper else 1 - share
            cell = None if cell is None or k + upper >= len(cell) else cell[k + upper]
        if weight:
            total += weight * Fraction(float(cell))
    return total


def half_away(x: Fraction) -> int:
    """The nearest whole number; of two equally near ones that farther from zero."""
    magnitude = abs(x)
    whole = magnitude.numerator // magnitude.denominator
    if magnitude - whole >= Fraction(1, 2):
        whole += 1
    return whole if x >= 0 else -whole


def in_fixed_point(levels, values, point):
    """Whole numbers: shares in steps of 2^-15, rounded down; each blend rounded half away."""
    found = []
    for each, x in zip(levels, point, strict=True):
        k, share = neighbours(each, x)
        found.append((k, share * 32768 // 1))

    def blended(cells, rest):
        if not rest:
            return int(cells)
        (k, share), *others = rest
        near = blended(cells[k], others)
        if len(cells) == 1:
            return near
        far = blended(cells[k + 1], others)
        return near + half_away(Fraction((far - near) * share, 32768))

    return blended(values, found)
