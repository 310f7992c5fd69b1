r"""Bounds of a centroid between two memberships, for proofs and for type-2 sets alike.

Let the membership lie between two curves, L ≤ μ ≤ U. Its centroid is greatest for μ = L on the
left of some c and μ = U on the right of it, and c is that centroid (Karnik and Mendel). So c is the
root of

    F(c) = ∫_{y<c} (y − c) L(y) dy + ∫_{y>c} (y − c) U(y) dy,

which falls. Curves are given as lines on panels; prefix sums of area and moment find the panel
where F changes its sign, and steps c ← M / A, kept between brackets, find c inside. The
iterates are inner bounds: the bracket outside is returned. The least centroid is that
of the mirrored curves. Sums over samples or numbers are the same with weights for lines;
there the greatest over all switch points is exact.

If L and U themselves lie between two curves, L₀ ≤ L ≤ L₁ and U₀ ≤ U ≤ U₁,
F rises with both: the right end lies between the roots of F for (L₁, U₀) and for (L₀, U₁). So
the ends of the centroid of an interval type-2 set have bounds from four curves.

References
----------
N. N. Karnik, J. M. Mendel, *Centroid of a type-2 fuzzy set*, 2001.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Interval = tuple[Array, Array]
"""Lower and upper bounds."""

_STEPS = 60
"""Most steps inside a panel; Newton takes five, else bisection takes over."""


def centroid_bounds(edges: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Return the least and the greatest centroid of memberships between two curves.

    Edges of panels, shape (n + 1,), increase. The curves, shape (..., n, 2), have their one-sided
    limits at the left and right end of each panel, and are linear between. Rounded outward by about
    1e-13 of the range. If `lower` is 0 everywhere: the ends of the support of `upper`; NaN if that
    is 0 too.
    """
    _, greatest = _brackets(edges, lower, upper)
    _, least = _brackets(*mirrored(edges, lower, upper))
    nothing = ~(upper > 0.0).any(axis=(-2, -1))
    return np.where(nothing, np.nan, -least), np.where(nothing, np.nan, greatest)


def ends_of_centroid_bounds(
    edges: Array, lower: Interval, upper: Interval
) -> tuple[Interval, Interval]:
    """Return bounds of both ends of the centroid of a set between two uncertain curves.

    Curves are bounds of those in :func:`centroid_bounds`. Returned are bounds of the left end and
    of the right end, rounded outward; NaN without any area.
    """

    def last(edges: Array, low: Interval, high: Interval) -> Interval:
        below, _ = _brackets(edges, low[1], high[0])
        _, above = _brackets(edges, low[0], high[1])
        return below, above

    nothing = ~(upper[1] > 0.0).any(axis=(-2, -1))

    def known(bound: Array) -> Array:
        return np.where(nothing, np.nan, bound)

    below, above = last(edges, lower, upper)
    turned, *curves = mirrored(edges, *lower, *upper)
    least, most = last(turned, (curves[0], curves[1]), (curves[2], curves[3]))
    return (known(-most), known(-least)), (known(below), known(above))


def mirrored(edges: Array, *curves: Array) -> tuple[Array, ...]:
    """Return panels and curves with left and right exchanged."""
    return (-edges[::-1], *(curve[..., ::-1, ::-1] for curve in curves))


def _brackets(edges: Array, lower: Array, upper: Array) -> Interval:
    """Return bounds of the last position with F > 0, for any two curves."""
    area_lower, moment_lower = _integrals(edges, lower)
    area_upper, moment_upper = _integrals(edges, upper)
    # Integrals left of each edge by the lower curve, right of it by the upper one.
    left_area, left_moment = sums_from_left(area_lower), sums_from_left(moment_lower)
    right_area, right_moment = sums_from_right(area_upper), sums_from_right(moment_upper)
    slope = left_moment - edges * left_area + right_moment - edges * right_area
    # F falls: the last edge with F > 0 is the left end of the panel.
    panel = np.clip((slope > 0.0).sum(axis=-1) - 1, 0, len(edges) - 2)

    def pick(values: Any) -> Array:
        return np.take_along_axis(values, panel[..., None], axis=-1)[..., 0]

    after = panel + 1
    base_area = pick(left_area) + np.take_along_axis(right_area, after[..., None], -1)[..., 0]
    base_moment = pick(left_moment) + np.take_along_axis(right_moment, after[..., None], -1)[..., 0]
    low, high = edges[panel], edges[after]
    ends = [pick(curve[..., side]) for curve in (lower, upper) for side in (0, 1)]
    return _root(low, high, base_area, base_moment, *ends)


def _root(
    left: Array,
    right: Array,
    area: Array,
    moment: Array,
    lower_left: Array,
    lower_right: Array,
    upper_left: Array,
    upper_right: Array,
) -> Interval:
    """Bracket the sign change of F inside a panel from both sides."""
    width = right - left
    low, high = left.copy(), right.copy()
    c = 0.5 * (low + high)
    slack = 1e-14 * (np.abs(left) + np.abs(right)) + 1e-300
    for _ in range(_STEPS):
        share = (c - left) / width
        lower_at = lower_left + share * (lower_right - lower_left)
        upper_at = upper_left + share * (upper_right - upper_left)
        a1, m1 = _trapezoid(left, c, lower_left, lower_at)
        a2, m2 = _trapezoid(c, right, upper_at, upper_right)
        whole, total = area + a1 + a2, moment + m1 + m2
        positive = total - c * whole > 0.0
        low, high = np.where(positive, c, low), np.where(positive, high, c)
        if np.all(high - low <= slack):
            break
        with np.errstate(all="ignore"):
            following = total / whole
        # A little beyond the step, so that both brackets close in.
        following = following + np.where(positive, 1.0, -1.0) * 0.25 * slack
        inside = (following > low) & (following < high)
        c = np.where(inside, following, 0.5 * (low + high))
    scale = np.abs(left) + np.abs(right) + width
    return np.asarray(low - 1e-13 * scale), np.asarray(high + 1e-13 * scale)


def _trapezoid(a: Array, b: Array, ya: Array, yb: Array) -> tuple[Array, Array]:
    """Return area and moment below a straight line."""
    width = b - a
    area = 0.5 * width * (ya + yb)
    return area, width * (a * (2.0 * ya + yb) + b * (ya + 2.0 * yb)) / 6.0


def _integrals(edges: Array, curve: Array) -> tuple[Array, Array]:
    return _trapezoid(edges[:-1], edges[1:], curve[..., 0], curve[..., 1])


def sums_from_left(values: Array) -> Array:
    """Return the sums to the left of each edge."""
    total = np.cumsum(values, axis=-1)
    return np.concatenate([np.zeros_like(total[..., :1]), total], axis=-1)


def sums_from_right(values: Array) -> Array:
    """Return the sums to the right of each edge."""
    total = np.cumsum(values[..., ::-1], axis=-1)[..., ::-1]
    return np.concatenate([total, np.zeros_like(total[..., :1])], axis=-1)


def average_bounds(
    least: Array, greatest: Array, lower: Array, upper: Array
) -> tuple[Array, Array]:
    """Return the least and the greatest weighted average of numbers with weights between bounds.

    Bounds of numbers and of weights, none negative, have the shape (..., n). Exact up to rounding,
    then widened by 1e-13 of the numbers; NaN if all weights are 0.
    """

    def highest(numbers: Array) -> Array:
        order = np.argsort(numbers, axis=-1, kind="stable")
        x = np.take_along_axis(np.broadcast_to(numbers, upper.shape), order, -1)
        low = np.take_along_axis(lower, order, -1)
        high = np.take_along_axis(upper, order, -1)
        area = sums_from_left(low) + sums_from_right(high)
        moment = sums_from_left(low * x) + sums_from_right(high * x)
        with np.errstate(all="ignore"):
            quotients = np.where(area > 0.0, moment / area, -np.inf).max(axis=-1)
        return np.asarray(quotients + 1e-13 * np.abs(x).max(axis=-1))

    greatest, least = (np.broadcast_to(end, upper.shape) for end in (greatest, least))
    top, bottom = highest(greatest), -highest(-least)
    nothing = ~(upper > 0.0).any(axis=-1)
    return np.where(nothing, np.nan, bottom), np.where(nothing, np.nan, top)


def ends_of_average_bounds(
    least: Interval, greatest: Interval, lower: Interval, upper: Interval
) -> tuple[Interval, Interval]:
    """Return bounds of both ends of an average of numbers with weights between uncertain ends.

    Bounds of the ends of numbers and weights have the shape (..., n). Returned are bounds of the
    left end and of the right end, widened by 1e-13 of the numbers; NaN if all weights are 0.
    """
    first, last = average_bounds(least[0], greatest[1], lower[0], upper[1])
    can_count = upper[1] > 0.0
    nothing = ~can_count.any(axis=-1)

    def inner(numbers: Array) -> Array:
        """Return the position reached by the certain weights; the end lies beyond it."""
        whole = np.broadcast_to(numbers, can_count.shape)
        return np.where(nothing, np.nan, _last_above(whole, lower[1], upper[0], can_count))

    return (first, -inner(-least[1])), (inner(greatest[0]), last)


def _last_above(numbers: Array, left: Array, right: Array, can_count: Any) -> Array:
    """Return a lower bound of the root of F, from the weights to its left and to its right."""
    order = np.argsort(numbers, axis=-1, kind="stable")
    x, low, high, counts = (
        np.take_along_axis(array, order, -1) for array in (numbers, left, right, can_count)
    )
    scale = 1e-13 * np.abs(x).max(axis=-1)
    # Beyond number k: the weights to its left, its own included, and to its right.
    area = sums_from_left(low)[..., 1:] + sums_from_right(high)[..., 1:]
    moment = sums_from_left(low * x)[..., 1:] + sums_from_right(high * x)[..., 1:]
    above = moment - x * area > scale[..., None] * area
    k = above.sum(axis=-1, keepdims=True) - 1
    at = np.clip(k, 0, None)
    with np.errstate(all="ignore"):
        values = np.take_along_axis(moment, at, -1) / np.take_along_axis(area, at, -1)
    ends = [np.take_along_axis(x, np.clip(k + i, 0, x.shape[-1] - 1), -1) for i in (0, 1)]
    values = np.clip(np.where(np.isfinite(values), values, ends[0]), *ends)
    lowest = np.where(counts, x, np.inf).min(axis=-1)
    return np.asarray(np.where(k[..., 0] < 0, lowest, values[..., 0]) - scale)
