"""Bounds of positions in an aggregate between two curves: bisector and maxima.

Let the aggregate lie between two curves, L ≤ f ≤ U. The bisector p has equal areas of f on both
sides, so ∫_{y<p} L ≤ ∫_{y>p} U and ∫_{y>p} L ≤ ∫_{y<p} U. In the first inequality the left side
rises with p and the right side falls, so it holds up to the largest possible p; the second one,
mirrored, bounds the smallest. Over samples and numbers integrals are sums.

If f is the maximum of some sets, each of them has its maxima on *humps*: intervals on which it
rises, then falls, with ends that move inward as the level of its cut rises. So the ends of a hump
have bounds, and so have the smallest, the largest, the mean of all positions and the one nearest
to 0: the mean of one hump is its midpoint, that of several the average of midpoints weighted by
lengths. If several sets may be the highest, the result is the hull over all of their humps.

Areas and heights that differ by 1e-12 count as equal here, as in inference.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.proof.map.centroid_bounds import (
    average_bounds,
    mirrored,
    sums_from_left,
    sums_from_right,
)

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

TIE = 1e-11
"""Relative tolerance of equal heights and areas: larger than that of inference."""

_STEPS = 60
"""Bisection steps inside a panel."""


# ── bisector ─────────────────────────────────────────────────────────────────────────


def bisector_bounds(edges: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Return the least and the greatest bisector of memberships between two curves.

    Edges and curves as in :func:`.centroid_bounds`; NaN if `upper` is 0 everywhere.
    """
    nothing = ~(upper > 0.0).any(axis=(-2, -1))
    least = -_furthest(*mirrored(edges, lower, upper))
    most = _furthest(edges, lower, upper)
    return np.where(nothing, np.nan, least), np.where(nothing, np.nan, most)


def _furthest(edges: Array, lower: Array, upper: Array) -> Array:
    """Return the largest position whose left area may still be at most its right area."""
    # Furthest right: least area on its left, most on its right.
    lower, upper = lower * (1.0 - TIE), upper * (1.0 + TIE)
    widths = np.diff(edges)
    left = sums_from_left(0.5 * widths * lower.sum(axis=-1))
    right = sums_from_right(0.5 * widths * upper.sum(axis=-1))
    panel = np.clip(((left <= right) & (right > 0.0)).sum(axis=-1) - 1, 0, len(edges) - 2)

    def pick(values: Array, step: int = 0) -> Array:
        return np.take_along_axis(values, panel[..., None] + step, axis=-1)[..., 0]

    start, end = edges[panel], edges[panel + 1]
    before, behind = pick(left), pick(right, 1)
    (a, b), (c, d) = ([pick(curve[..., side]) for side in (0, 1)] for curve in (lower, upper))
    # Inside that panel both sides are quadratic in the position: bisection, which needs no special
    # case for a slope near 0. The lower curve goes from a to b, the upper one from c to d.
    low, high = start, end
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        share = (middle - start) / (end - start)
        on_left = before + 0.5 * (middle - start) * (2.0 * a + share * (b - a))
        on_right = behind + 0.5 * (end - middle) * (c + share * (d - c) + d)
        reached = (on_left <= on_right) & (on_right > 0.0)
        low, high = np.where(reached, middle, low), np.where(reached, high, middle)
    return np.asarray(high + 1e-13 * (np.abs(start) + np.abs(end)))


def halving_bounds(
    least: Array, greatest: Array, lower: Array, upper: Array
) -> tuple[Array, Array]:
    """Return the least and the greatest number at which the running sum of weights is one half.

    Bounds have the shape (..., n), weights are not negative; NaN if all weights are 0.
    """

    def furthest(numbers: Array) -> Array:
        order = np.argsort(numbers, axis=-1, kind="stable")
        x, low, high = (np.take_along_axis(array, order, -1) for array in (numbers, lower, upper))
        # Least sum up to a number, its own weight included; largest sum beyond it.
        left = sums_from_left(low)[..., 1:] * (1.0 - TIE)
        right = sums_from_right(high)[..., 1:] * (1.0 + TIE)
        beyond = ((left <= right) & (right > 0.0)).sum(axis=-1, keepdims=True)
        return np.asarray(np.take_along_axis(x, beyond, -1)[..., 0])

    greatest, least = (np.broadcast_to(array, upper.shape) for array in (greatest, least))
    nothing = ~(upper > 0.0).any(axis=-1)
    low, high = -furthest(-least), furthest(greatest)
    return np.where(nothing, np.nan, low), np.where(nothing, np.nan, high)


def nearest_half_bounds(positions: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Return the first and the last sample whose running sum may be the nearest to one half.

    As in fuzzylite (sampling ``midpoints``). A sample before the half is nearest if it is as near
    as the next one: the sum beyond it, without one sample, is at most the sum up to it. One after
    the half is nearest if the sum up to it, without one sample, is at most the remainder. Samples,
    shape (n,), increase; heights, shape (..., n), are not negative; NaN if all are 0.
    """
    slack = TIE * upper.sum(axis=-1, keepdims=True)
    behind = sums_from_right(lower)[..., 1:] - _largest_behind(lower)
    first = (sums_from_left(upper)[..., 1:] + slack >= behind).argmax(axis=-1)
    up_to = sums_from_left(lower)[..., 1:] - np.maximum.accumulate(lower, axis=-1)
    last = (up_to <= sums_from_right(upper)[..., 1:] + slack).sum(axis=-1) - 1
    nothing = ~(upper > 0.0).any(axis=-1)
    return (
        np.where(nothing, np.nan, positions[first]),
        np.where(nothing, np.nan, positions[np.maximum(last, 0)]),
    )


def _largest_behind(values: Array) -> Array:
    """Return for each number the largest of those after it; 0 for the last."""
    largest = np.maximum.accumulate(values[..., ::-1], axis=-1)[..., ::-1]
    return np.concatenate([largest[..., 1:], np.zeros_like(largest[..., :1])], axis=-1)


# ── positions of the maximum ─────────────────────────────────────────────────────────


class Humps(NamedTuple):
    """Intervals of maxima, of which one or more exist: arrays of one shape (..., n)."""

    left: Array  # left, right: the outermost possible ends
    right: Array
    # latest_left, earliest_right: the innermost possible ends, if the hump exists
    latest_left: Array
    earliest_right: Array
    can_be: Flags  # whether it may exist
    certain: Flags  # whether it certainly exists, and no hump of another set
    # shortest, longest: bounds of its length (or number of samples), if it exists
    shortest: Array
    longest: Array
    inmost: Array  # its nearest possible position to 0: 0, or one of its samples


def smallest_bounds(humps: Humps) -> tuple[Array, Array]:
    """Return bounds of the first position of all existing humps."""
    least = np.where(humps.can_be, humps.left, np.inf).min(axis=-1)
    most = np.where(humps.can_be, humps.latest_left, -np.inf).max(axis=-1)
    # A certain hump: the first position of all is not after its own.
    most = np.minimum(most, np.where(humps.certain, humps.latest_left, np.inf).min(axis=-1))
    return _or_nothing(humps, least, most)


def largest_bounds(humps: Humps) -> tuple[Array, Array]:
    """Return bounds of the last position of all existing humps."""
    least = np.where(humps.can_be, humps.earliest_right, np.inf).min(axis=-1)
    least = np.maximum(least, np.where(humps.certain, humps.earliest_right, -np.inf).max(axis=-1))
    most = np.where(humps.can_be, humps.right, -np.inf).max(axis=-1)
    return _or_nothing(humps, least, most)


def mean_bounds(humps: Humps) -> tuple[Array, Array]:
    """Return bounds of the mean position of all existing humps."""

    def there(values: Array) -> Array:
        return np.where(humps.can_be, values, 0.0)

    # If all lengths are 0, the mean is that of points, whatever their weights.
    longest = there(np.maximum(humps.longest, 1e-200))
    return average_bounds(
        there(0.5 * (humps.left + humps.earliest_right)),
        there(0.5 * (humps.latest_left + humps.right)),
        np.where(humps.certain, np.maximum(humps.shortest, 0.0), 0.0),
        longest,
    )


def nearest_bounds(humps: Humps) -> tuple[Array, Array]:
    """Return bounds of the position nearest to 0 of all existing humps."""
    # On a hump [a, b] it is max(a, min(b, inmost)), which rises with both ends.
    low = np.maximum(humps.left, np.minimum(humps.earliest_right, humps.inmost))
    high = np.maximum(humps.latest_left, np.minimum(humps.right, humps.inmost))
    # The nearest of all is not farther away than that of a certain hump.
    far = np.where(humps.certain, np.maximum(np.abs(low), np.abs(high)), np.inf).min(axis=-1)
    can_be = humps.can_be & (np.maximum(low, -high) <= far[..., None])
    least = np.maximum(np.where(can_be, low, np.inf).min(axis=-1), -far)
    most = np.minimum(np.where(can_be, high, -np.inf).max(axis=-1), far)
    return _or_nothing(humps, least, most)


def _or_nothing(humps: Humps, least: Array, most: Array) -> tuple[Array, Array]:
    nothing = ~humps.can_be.any(axis=-1)
    return np.where(nothing, np.nan, least), np.where(nothing, np.nan, most)
