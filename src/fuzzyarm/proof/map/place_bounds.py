"""Bounds of a position in an aggregate that is only known between two: bisector and maxima.

Let the aggregate lie between two curves, L ≤ f ≤ U. The position p that halves its area has as
much of f on its left as on its right, so ∫_{y<p} L ≤ ∫_{y>p} U and ∫_{y>p} L ≤ ∫_{y<p} U: the
left side of the first rises with p and its right side falls, so that it holds up to the furthest
position there can be; the second one, mirrored, has the first. Over samples and numbers integrals
are sums.

A maximum is where f reaches its greatest height. Where f is the largest of some sets, each of
them has its maximum on *humps*: stretches on which it rises, then falls, and whose ends move
inward as the level rises at which it is cut. So the ends of a hump have bounds, and so have the
smallest, the largest, the mean of all positions and that nearest to 0: the mean of one hump is its
middle, and that of several an average of their middles by their lengths. If it is open which of
several sets is the highest, it is one of their humps or some of them together: the hull of all.

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
"""Share by which heights, and areas, may differ and count as equal: more than inference allows."""

_STEPS = 60
"""Halvings inside a panel."""


# ── the position that halves an area ─────────────────────────────────────────────────


def bisector_bounds(edges: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Return the least and the greatest bisector of memberships between two curves.

    Edges and curves are as in :func:`.centroid_bounds`; NaN where `upper` is 0 everywhere.
    """
    nothing = ~(upper > 0.0).any(axis=(-2, -1))
    least = -_furthest(*mirrored(edges, lower, upper))
    most = _furthest(edges, lower, upper)
    return np.where(nothing, np.nan, least), np.where(nothing, np.nan, most)


def _furthest(edges: Array, lower: Array, upper: Array) -> Array:
    """Return up to where the area on the left need not be more than that on the right."""
    # As far to the right as it can be: least area on its left, most on its right.
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
    # Inside that panel both sides are quadratic in the position: halved, which needs no case for
    # a slope near 0. The lower curve goes from a to b, the upper one from c to d.
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

    Bounds have the shape (..., n), weights are not negative; NaN where all weights are 0.
    """

    def furthest(numbers: Array) -> Array:
        order = np.argsort(numbers, axis=-1, kind="stable")
        x, low, high = (np.take_along_axis(array, order, -1) for array in (numbers, lower, upper))
        # At least up to a number, its own weight with it; at most behind it.
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

    As in fuzzylite (sampling ``midpoints``). A sample in front of the half is nearest if it is as
    near as the next one: what is behind it, without one sample, is not more than what is up to it.
    One behind the half is if what is up to it, without one sample, is not more than the rest.
    Samples, shape (n,), increase; heights, shape (..., n), are not negative; NaN where all are 0.
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
    """Return for each number the largest of those behind it; 0 for the last."""
    largest = np.maximum.accumulate(values[..., ::-1], axis=-1)[..., ::-1]
    return np.concatenate([largest[..., 1:], np.zeros_like(largest[..., :1])], axis=-1)


# ── the positions at which it is greatest ────────────────────────────────────────────


class Humps(NamedTuple):
    """Stretches of maxima, of which one or more are there: arrays of one shape (..., n)."""

    left: Array  # left, right: the first and the last position there can be
    right: Array
    # latest_left, earliest_right: where it begins at the latest and ends at the earliest, if it is
    # there
    latest_left: Array
    earliest_right: Array
    can_be: Flags  # whether it may be there
    certain: Flags  # whether it is there in any case, and no hump of another set
    # shortest, longest: bounds of its length (or of how many samples it has), if it is there
    shortest: Array
    longest: Array
    inmost: Array  # the position nearest to 0 that it could have: 0, or one of its samples


def smallest_bounds(humps: Humps) -> tuple[Array, Array]:
    """Return bounds of the first position of all humps that are there."""
    least = np.where(humps.can_be, humps.left, np.inf).min(axis=-1)
    most = np.where(humps.can_be, humps.latest_left, -np.inf).max(axis=-1)
    # One that is there in any case: the first position is not behind its own.
    most = np.minimum(most, np.where(humps.certain, humps.latest_left, np.inf).min(axis=-1))
    return _or_nothing(humps, least, most)


def largest_bounds(humps: Humps) -> tuple[Array, Array]:
    """Return bounds of the last position of all humps that are there."""
    least = np.where(humps.can_be, humps.earliest_right, np.inf).min(axis=-1)
    least = np.maximum(least, np.where(humps.certain, humps.earliest_right, -np.inf).max(axis=-1))
    most = np.where(humps.can_be, humps.right, -np.inf).max(axis=-1)
    return _or_nothing(humps, least, most)


def mean_bounds(humps: Humps) -> tuple[Array, Array]:
    """Return bounds of the mean of all positions of the humps that are there."""

    def there(values: Array) -> Array:
        return np.where(humps.can_be, values, 0.0)

    # Lengths of 0 count where all are: the mean is then that of points, whatever their weights.
    longest = there(np.maximum(humps.longest, 1e-200))
    return average_bounds(
        there(0.5 * (humps.left + humps.earliest_right)),
        there(0.5 * (humps.latest_left + humps.right)),
        np.where(humps.certain, np.maximum(humps.shortest, 0.0), 0.0),
        longest,
    )


def nearest_bounds(humps: Humps) -> tuple[Array, Array]:
    """Return bounds of the position nearest to 0 of all humps that are there."""
    # Of a hump from a to b it is `inmost`, or the end that lies before it: max(a, min(b, inmost)),
    # which rises with both ends.
    low = np.maximum(humps.left, np.minimum(humps.earliest_right, humps.inmost))
    high = np.maximum(humps.latest_left, np.minimum(humps.right, humps.inmost))
    # The nearest of all is not farther away than that of a hump which is there in any case.
    far = np.where(humps.certain, np.maximum(np.abs(low), np.abs(high)), np.inf).min(axis=-1)
    can_be = humps.can_be & (np.maximum(low, -high) <= far[..., None])
    least = np.maximum(np.where(can_be, low, np.inf).min(axis=-1), -far)
    most = np.minimum(np.where(can_be, high, -np.inf).max(axis=-1), far)
    return _or_nothing(humps, least, most)


def _or_nothing(humps: Humps, least: Array, most: Array) -> tuple[Array, Array]:
    nothing = ~humps.can_be.any(axis=-1)
    return np.where(nothing, np.nan, least), np.where(nothing, np.nan, most)
